!> Planar blocks of spatial mechanisms: they are found, and the motion in their planes is that in space, to round-off, for planes in
!> any direction, on links that move or stand still.
!>
!> Compares the program with itself: planar and spatial arithmetic.
module test_planar_blocks
  use mech9_kinds, only: wp
  use mech9_error, only: error_type
  use mech9_tracking_failures, only: failure_dead_point
  use mech9_random, only: random_type
  use mech9_random_geometry, only: random_rotation
  use mech9_model, only: model_type
  use mech9_plan, only: plan_type
  use mech9_state, only: state_type
  use mech9_planning, only: planning_settings_type, make_plan
  use mech9_requested, only: requested_type, leave_out_unrequested
  use mech9_driven_motion, only: driven_motion_type, start_driven_motion, advance
  use mech9_frame_motion, only: point_motion, link_motion, step_screw
  use mech9_mechanism_families, only: axis_type
  use mech9_mixed_mechanisms, only: mixed_axes, mixed_mechanism, mixed_planes, mixed_planar_blocks
  use mech9_testing, only: tester_type
  implicit none
  private
  public :: run

  !> The motion of a mechanism.
  type :: motion_type
    integer :: planes = 0                         !< planes of its plan
    integer :: planar_blocks = 0                  !< blocks in these planes
    real(wp) :: conditioning = 1.0_wp             !< the worst on the way
    integer :: kind = 0                           !< of the failure that ends it; 0: none
    real(wp) :: t = 0.0_wp                        !< time of that failure [s]
    real(wp), allocatable :: coordinates(:, :)    !< (3,M) q, dq, ddq at the end
    real(wp), allocatable :: points(:, :)         !< (9,N) motion of a point of each link at the end
    real(wp), allocatable :: links(:, :)          !< (18,N) rotation and motion of each link at the end
    real(wp), allocatable :: screws(:, :)         !< (9,M) screws of the steps at the end
    real(wp), allocatable :: requested(:, :)      !< (9,:) motion of points, computed without the rest
  end type motion_type

  !> Place of the point that is followed, in the system of its link [m].
  real(wp), parameter :: place(3) = [0.3_wp, -0.2_wp, 0.5_wp]

contains

  !> Run the cases of this suite.
  subroutine run(test)
    type(tester_type), intent(inout) :: test   !< selects cases and counts their checks

    if (test%runs('random_mechanisms')) call random_mechanisms(test)
  end subroutine run

  !> Random mechanisms, each also turned as a whole.
  subroutine random_mechanisms(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    integer, parameter :: slides(5) = [0, 3, 4, 0, 5]
    type(random_type) :: random
    type(axis_type) :: axes(31)
    type(model_type) :: model
    type(motion_type) :: flat, space, turned
    real(wp) :: turn(3, 3), tolerance
    integer :: trial, k, compared, dead

    compared = 0
    dead = 0
    do trial = 1, 40
      axes = mixed_axes(slides(modulo(trial, 5) + 1), random)
      call mixed_mechanism(axes, model)
      call follow(test, model, .true., space)
      if (space%kind > 0 .and. space%kind /= failure_dead_point) cycle
      call follow(test, model, .false., flat)
      call test%is_true(flat%kind == space%kind, 'planes and space end alike')
      if (space%kind == failure_dead_point) then
        dead = dead + 1
        call test%near(flat%t, space%t, 1.0e-9_wp, 'time of a dead point')
        cycle
      end if
      call test%is_true(space%planes == 0, 'no planes in space')
      call test%is_true(flat%planes == mixed_planes, 'planes')
      call test%is_true(flat%planar_blocks == mixed_planar_blocks, 'planar blocks')
      ! near a singular position round-off decides
      if (space%conditioning < 1.0e-2_wp) cycle
      compared = compared + 1
      ! round-off over the conditioning, to its square for accelerations, in blocks that follow each other
      tolerance = 1.0e-14_wp/space%conditioning**3
      call compare(test, flat, space, tolerance, 'planes and space')
      turn = random_rotation(random)
      do k = 1, 31
        axes(k)%point = matmul(turn, axes(k)%point)
        axes(k)%along = matmul(turn, axes(k)%along)
      end do
      call mixed_mechanism(axes, model)
      call follow(test, model, .false., turned)
      call test%is_true(turned%planar_blocks == mixed_planar_blocks, 'planar blocks of the turned mechanism')
      call near(test, turned%coordinates, flat%coordinates, tolerance, 'coordinates of the turned mechanism')
    end do
    call test%is_true(compared >= 12, 'some mechanisms are compared')
    call test%is_true(dead >= 8, 'some mechanisms reach a dead point')
  end subroutine random_mechanisms

  !> Compare all numbers of two motions.
  subroutine compare(test, motion, expected, tolerance, why)
    type(tester_type), intent(inout) :: test    !< counts the checks
    type(motion_type), intent(in) :: motion     !< the motion
    type(motion_type), intent(in) :: expected   !< the right one
    real(wp), intent(in) :: tolerance           !< over the largest number of its sort
    character(len=*), intent(in) :: why         !< the statement that is checked, printed where it is wrong

    call near(test, motion%coordinates, expected%coordinates, tolerance, why//': coordinates')
    call near(test, motion%points, expected%points, tolerance, why//': points')
    call near(test, motion%links, expected%links, tolerance, why//': links')
    call near(test, motion%screws, expected%screws, tolerance, why//': screws')
    call near(test, motion%requested, expected%requested, tolerance, why//': requested point')
    call test%near(motion%conditioning, expected%conditioning, 1.0e-10_wp, why//': conditioning')
  end subroutine compare

  subroutine near(test, numbers, expected, tolerance, why)
    type(tester_type), intent(inout) :: test   !< counts the checks
    real(wp), intent(in) :: numbers(:, :)      !< numbers that are checked
    real(wp), intent(in) :: expected(:, :)     !< the right numbers
    real(wp), intent(in) :: tolerance          !< over the largest number
    character(len=*), intent(in) :: why        !< the statement that is checked, printed where it is wrong

    call test%near(maxval(abs(numbers - expected))/max(1.0_wp, maxval(abs(expected))), 0.0_wp, tolerance, why)
  end subroutine near

  !> Follow the motion, and find all numbers at its end.
  subroutine follow(test, model, in_space, motion)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(model_type), intent(in) :: model      !< the model
    logical, intent(in) :: in_space            !< in spatial arithmetic throughout
    type(motion_type), intent(out) :: motion   !< the motion
    type(plan_type) :: plan
    type(state_type) :: start, state
    type(error_type), allocatable :: err
    real(wp) :: rotation(3, 3)
    integer :: i

    call make_plan(model%mechanism, model%problem%partition, model%problem%initial%position, plan, start, err, &
                   planning_settings_type(in_space=in_space))
    call test%no_error(err, 'plan')
    if (allocated(err)) call test%finish()
    if (allocated(plan%planar%planes)) motion%planes = size(plan%planar%planes)
    motion%planar_blocks = count(plan%blocks%arithmetic > 1)
    call go(model, plan, start, state, motion)
    if (motion%kind > 0) return
    motion%coordinates = transpose(reshape([state%q, state%dq, state%ddq], [plan%n_coordinates, 3]))
    allocate (motion%points(9, plan%n_links), motion%links(18, plan%n_links), motion%screws(9, plan%n_coordinates))
    do i = 1, plan%n_links
      call point_motion(plan, state, i, place, motion%points(1:3, i), motion%points(4:6, i), motion%points(7:9, i))
      call link_motion(plan, state, i, rotation, motion%links(10:12, i), motion%links(13:15, i), motion%links(16:18, i))
      motion%links(1:9, i) = reshape(rotation, [9])
    end do
    do i = 1, plan%n_coordinates
      call step_screw(plan, state, plan%step_of(i), motion%screws(1:3, i), motion%screws(4:6, i), motion%screws(7:9, i))
    end do
    call follow_points(model, plan, start, motion)
  end subroutine follow

  !> Follow the motion of single points, without the computations on which these do not depend.
  subroutine follow_points(model, plan, start, motion)
    type(model_type), intent(in) :: model        !< the model
    type(plan_type), intent(in) :: plan          !< its plan
    type(state_type), intent(in) :: start        !< its start
    type(motion_type), intent(inout) :: motion   !< gets the motion of the points
    integer, parameter :: links(6) = [7, 8, 11, 15, 22, 25]
    type(plan_type) :: lean
    type(state_type) :: state
    type(requested_type) :: requested
    integer :: i, k, derivatives

    allocate (motion%requested(9, 3*size(links)), source=0.0_wp)
    allocate (requested%coordinates(plan%n_coordinates), source=.false.)
    do i = 1, size(links)
      do derivatives = 0, 2
        requested%links = [(k == links(i), k=1, plan%n_links)]
        requested%derivatives = derivatives
        lean = plan
        call leave_out_unrequested(lean, requested)
        call go(model, lean, start, state, motion)
        if (motion%kind > 0) return
        associate (values => motion%requested(:, 3*i - derivatives))
          call point_motion(lean, state, links(i), place, values(1:3))
          if (derivatives == 1) call point_motion(lean, state, links(i), place, values(1:3), values(4:6))
          if (derivatives == 2) call point_motion(lean, state, links(i), place, values(1:3), values(4:6), values(7:9))
        end associate
      end do
    end do
  end subroutine follow_points

  !> Follow the motion to its end, or to a failure.
  subroutine go(model, plan, start, state, motion)
    type(model_type), intent(in) :: model        !< the model
    type(plan_type), intent(in) :: plan          !< its plan
    type(state_type), intent(in) :: start        !< its start
    type(state_type), intent(out) :: state       !< at the end
    type(motion_type), intent(inout) :: motion   !< gets the conditioning, and a failure
    type(driven_motion_type) :: driven
    type(error_type), allocatable :: err
    integer :: i, b

    call start_driven_motion(model%problem%drives, plan, start, 0.0_wp, driven, err)
    do i = 1, 6
      if (allocated(err)) exit
      call advance(model%problem%drives, plan, driven, 0.05_wp*i, err)
      if (allocated(err)) exit
      do b = 1, size(plan%blocks)
        if (size(plan%blocks(b)%unknowns) > 0) &
          motion%conditioning = min(motion%conditioning, driven%work(b)%equations%conditioning())
      end do
    end do
    if (allocated(err)) then
      motion%kind = err%failure%kind
      motion%t = err%failure%t
    end if
    state = driven%state
  end subroutine go
end module test_planar_blocks
