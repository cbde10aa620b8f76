!> Frames in the plane: places by complex numbers, velocities and accelerations against differences over time, small changes to second
!> order, and vectors in the plane and in space.
module test_planar_motion
  use mech9_kinds, only: wp, pi
  use mech9_random, only: random_type
  use mech9_rotation, only: about_axis
  use mech9_differentiation, only: half_width, derivatives_from_stencil
  use mech9_planar_plan, only: planar_plan_type
  use mech9_state, only: planar_motion_type
  use mech9_planar_motion, only: new_planar_motion, place_in_plane, change_in_plane, planar_velocities, planar_accelerations, &
    to_space, to_plane
  use mech9_testing, only: tester_type
  implicit none
  private
  public :: run

  integer, parameter :: m = 7   !< steps of the tree

contains

  !> Run the cases of this suite.
  subroutine run(test)
    type(tester_type), intent(inout) :: test   !< selects cases and counts their checks

    if (test%runs('places')) call places(test)
    if (test%runs('derivatives')) call derivatives(test)
    if (test%runs('small_changes')) call small_changes(test)
    if (test%runs('vectors')) call vectors(test)
  end subroutine run

  !> A tree of steps that turn, forwards or backwards, and slide, at random.
  subroutine random_tree(random, planar)
    type(random_type), intent(inout) :: random        !< source of the numbers
    type(planar_plan_type), intent(out) :: planar     !< the tree
    real(wp) :: angle
    integer :: s

    allocate (planar%steps(m))
    do s = 1, m
      associate (step => planar%steps(s))
        step%parent = int(0.5_wp*s*(1.0_wp + random%symmetric()))
        step%coordinate = m + 1 - s
        step%turns = random%symmetric() > -0.4_wp
        step%angle = merge(pi*random%symmetric(), 0.0_wp, step%turns)
        step%turn = merge(sign(1.0_wp, random%symmetric()), 0.0_wp, step%turns)
        step%place = [random%symmetric(), random%symmetric()]
        angle = pi*random%symmetric()
        step%slide = merge(0.0_wp, 1.0_wp, step%turns)*[cos(angle), sin(angle)]
      end associate
    end do
  end subroutine random_tree

  !> Numbers between -1 and 1.
  function any_numbers(random) result(numbers)
    type(random_type), intent(inout) :: random   !< source of the numbers
    real(wp) :: numbers(m)
    integer :: i

    do i = 1, m
      numbers(i) = random%symmetric()
    end do
  end function any_numbers

  !> Places and directions of frames as complex numbers.
  subroutine places(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(planar_plan_type) :: planar
    type(planar_motion_type) :: motion
    type(random_type) :: random
    complex(wp) :: place(0:m), direction(0:m)
    real(wp) :: q(m)
    integer :: trial, s

    motion = new_planar_motion(m)
    do trial = 1, 20
      call random_tree(random, planar)
      q = any_numbers(random)
      call place_in_plane(planar, 1, m, q, motion)
      place(0) = 0.0_wp
      direction(0) = 1.0_wp
      do s = 1, m
        associate (step => planar%steps(s), from => planar%steps(s)%parent, x => q(planar%steps(s)%coordinate))
          place(s) = place(from) + direction(from)*cmplx(step%place(1) + x*step%slide(1), step%place(2) + x*step%slide(2), wp)
          direction(s) = direction(from)*exp(cmplx(0.0_wp, step%angle + step%turn*x, wp))
        end associate
        ! sums and products of a few numbers of order one
        call test%near(abs(cmplx(motion%pose(1, s), motion%pose(2, s), wp) - direction(s)), 0.0_wp, 1.0e-14_wp, 'directions')
        call test%near(abs(cmplx(motion%pose(3, s), motion%pose(4, s), wp) - place(s)), 0.0_wp, 1.0e-14_wp, 'places')
      end do
    end do
  end subroutine places

  !> Velocities and accelerations against differences along q + dq t + ddq t^2/2.
  subroutine derivatives(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    real(wp), parameter :: h = 1.0_wp/64.0_wp
    type(planar_plan_type) :: planar
    type(planar_motion_type) :: motion, moved
    type(random_type) :: random
    real(wp), dimension(m) :: q, dq, ddq
    real(wp) :: numbers(3, m, -half_width:half_width), first, second, error
    integer :: trial, i, s, k

    motion = new_planar_motion(m)
    do trial = 1, 10
      call random_tree(random, planar)
      q = any_numbers(random)
      dq = any_numbers(random)
      ddq = any_numbers(random)
      do i = -half_width, half_width
        moved = new_planar_motion(m)
        call place_in_plane(planar, 1, m, q + i*h*(dq + 0.5_wp*i*h*ddq), moved)
        numbers(2:3, :, i) = moved%pose(3:4, 1:m)
        do s = 1, m
          numbers(1, s, i) = moved%angle(s)
          if (planar%steps(s)%parent > 0) numbers(1, s, i) = numbers(1, s, i) + numbers(1, planar%steps(s)%parent, i)
        end do
        if (i == 0) motion = moved
      end do
      call planar_velocities(planar, 1, m, dq, motion)
      call planar_accelerations(planar, 1, m, dq, ddq, motion)
      do s = 1, m
        do k = 1, 3
          call derivatives_from_stencil(numbers(k, s, :), h, first, second, error)
          ! round-off 2/h and 8/h^2 times that of places and angles up to ten
          call test%near(motion%velocity(k, s), first, 1.0e-12_wp, 'velocities')
          call test%near(motion%acceleration(k, s), second, 1.0e-10_wp, 'accelerations')
        end do
      end do
    end do
  end subroutine derivatives

  !> Poses after a small change differ from those placed anew by its third power.
  subroutine small_changes(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(planar_plan_type) :: planar
    type(planar_motion_type) :: motion, anew
    type(random_type) :: random
    real(wp) :: q(m), change(2), size_of_change
    integer :: trial, changed(2)

    do trial = 1, 20
      call random_tree(random, planar)
      q = any_numbers(random)
      motion = new_planar_motion(m)
      anew = new_planar_motion(m)
      call place_in_plane(planar, 1, m, q, motion)
      changed = [1 + mod(trial, 3), 4 + mod(trial, 4)]
      size_of_change = 10.0_wp**(-1 - mod(trial, 4))
      change = size_of_change*[random%symmetric(), random%symmetric()]
      q(planar%steps(changed)%coordinate) = q(planar%steps(changed)%coordinate) + change
      call change_in_plane(planar, 1, m, changed, change, q, motion)
      call place_in_plane(planar, 1, m, q, anew)
      ! cosines and sines miss change^3/6 at each of two joints, arms are up to some lengths; and round-off
      call test%near(maxval(abs(motion%pose - anew%pose)), 0.0_wp, 3.0_wp*size_of_change**3 + 1.0e-14_wp, &
                     'poses after a small change')
    end do
  end subroutine small_changes

  !> Vectors from the plane to space and back.
  subroutine vectors(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(planar_plan_type) :: planar
    real(wp), parameter :: axis(3) = [0.6_wp, 0.0_wp, 0.8_wp], vector(3) = [1.0_wp, -2.0_wp, 0.5_wp]
    real(wp) :: seen(3)

    planar%axes = about_axis(axis, 0.7_wp)
    planar%in_xy_plane = .false.
    seen = to_plane(planar, vector)
    call test%near(maxval(abs(seen - matmul(transpose(planar%axes), vector))), 0.0_wp, 1.0e-15_wp, 'a vector in the plane''s axes')
    call test%near(maxval(abs(to_space(planar, seen(1), seen(2), seen(3)) - vector)), 0.0_wp, 1.0e-15_wp, 'and back')
    planar = planar_plan_type()
    call test%near(maxval(abs(to_plane(planar, vector) - vector)), 0.0_wp, 0.0_wp, 'the plane of frame 0 needs no turn')
  end subroutine vectors
end module test_planar_motion
