!> Twists of frames: the bracket is that of a Lie algebra, a twist that is fixed in a moving frame has the derivatives of its motion,
!> and sums of products at several positions are those of one position after the other.
module test_twists
  use mech9_kinds, only: wp
  use mech9_error, only: error_type
  use mech9_random, only: random_type
  use mech9_rotation, only: cross
  use mech9_differentiation, only: half_width, derivatives_from_stencil
  use mech9_model, only: model_type
  use mech9_plan, only: plan_type
  use mech9_state, only: state_type
  use mech9_planning, only: make_plan
  use mech9_driven_motion, only: driven_motion_type, start_driven_motion, advance
  use mech9_twists, only: frame_twists_type, new_frame_twists, bracket, shift_at, find_frame_twists, carried
  use mech9_batch_products, only: batch_size, set_three, sum_three, add_three_to, add_to
  use mech9_sample_mechanisms, only: general_loop, drive
  use mech9_testing, only: tester_type
  implicit none
  private
  public :: run

contains

  !> Run the cases of this suite.
  subroutine run(tester)
    type(tester_type), intent(inout) :: tester   !< selects cases and counts their checks

    if (tester%runs('brackets')) call brackets(tester)
    if (tester%runs('shifts')) call shifts(tester)
    if (tester%runs('carried_twist')) call carried_twist(tester)
    if (tester%runs('products')) call products(tester)
  end subroutine run

  !> Six numbers between -1 and 1.
  function any_twist(random) result(twist)
    type(random_type), intent(inout) :: random   !< source of the numbers
    real(wp) :: twist(6)
    integer :: i

    do i = 1, 6
      twist(i) = random%symmetric()
    end do
  end function any_twist

  !> The bracket is antisymmetric and satisfies Jacobi's identity.
  subroutine brackets(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(random_type) :: random
    real(wp) :: a(6), b(6), c(6)
    integer :: trial

    do trial = 1, 20
      a = any_twist(random)
      b = any_twist(random)
      c = any_twist(random)
      call tester%near(maxval(abs(bracket(a, b) + bracket(b, a))), 0.0_wp, 1.0e-15_wp, 'the bracket is antisymmetric')
      ! sums of a dozen products of numbers below one
      call tester%near(maxval(abs(bracket(a, bracket(b, c)) + bracket(b, bracket(c, a)) + bracket(c, bracket(a, b)))), 0.0_wp, &
                       1.0e-14_wp, 'Jacobi''s identity')
    end do
  end subroutine brackets

  !> A rotation about an axis leaves its points in place, and the bracket is the commutator of the fields of shifts.
  subroutine shifts(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(random_type) :: random
    real(wp) :: a(6), b(6), place(3), point(3)
    integer :: trial

    do trial = 1, 20
      a = any_twist(random)
      b = any_twist(random)
      place = b(4:6)
      point = place + 0.7_wp*a(1:3)
      call tester%near(maxval(abs(shift_at([a(1:3), -cross(a(1:3), place)], point))), 0.0_wp, 1.0e-14_wp, &
                       'points of the axis stay in place')
      ! (a . grad) b - (b . grad) a, with grad b along a shift s being w_b x s
      point = any_point(random)
      call tester%near(maxval(abs(shift_at(bracket(a, b), point) - (cross(a(1:3), shift_at(b, point)) &
                                  - cross(b(1:3), shift_at(a, point))))), 0.0_wp, 1.0e-14_wp, &
                       'the bracket is the commutator of fields')
    end do
  end subroutine shifts

  !> Three numbers between -1 and 1.
  function any_point(random) result(point)
    type(random_type), intent(inout) :: random   !< source of the numbers
    real(wp) :: point(3), twist(6)

    twist = any_twist(random)
    point = twist(1:3)
  end function any_point

  !> A twist that is fixed in each frame of a spatial loop, against differences over time.
  subroutine carried_twist(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    real(wp), parameter :: h = 1.0_wp/256.0_wp
    type(model_type) :: model
    type(plan_type) :: plan
    type(state_type) :: state
    type(driven_motion_type) :: driven
    type(frame_twists_type) :: twists
    type(random_type) :: random
    type(error_type), allocatable :: err
    real(wp), allocatable :: fixed(:, :), series(:, :, :, :)
    real(wp) :: first, second, error
    integer :: i, k, f

    call general_loop(model)
    call drive(model, 1, [0.1_wp, 0.4_wp, 0.3_wp])
    model%problem%initial%position(1) = 0.1_wp - 0.4_wp*half_width*h + 0.3_wp*(half_width*h)**2
    call make_plan(model%mechanism, model%problem%partition, model%problem%initial%position, plan, state, err)
    if (.not. allocated(err)) call start_driven_motion(model%problem%drives, plan, state, -half_width*h, driven, err)
    call tester%no_error(err, 'the motion starts')
    allocate (fixed(6, plan%n_coordinates), series(6, 0:2, plan%n_coordinates, -half_width:half_width))
    twists = new_frame_twists(plan%n_coordinates)
    do f = 1, plan%n_coordinates
      fixed(:, f) = any_twist(random)
    end do
    do i = -half_width, half_width
      if (i > -half_width) call advance(model%problem%drives, plan, driven, i*h, err)
      call tester%no_error(err, 'the motion goes on')
      call find_frame_twists(driven%state, [(f, f=1, plan%n_coordinates)], 2, twists)
      do f = 1, plan%n_coordinates
        call carried(driven%state, twists, f, fixed(:, f), 2, series(:, :, f, i))
      end do
    end do
    do f = 1, plan%n_coordinates
      do k = 1, 6
        call derivatives_from_stencil(series(k, 0, f, :), h, first, second, error)
        ! positions are known to 1e-15 over a conditioning of 0.1; differences multiply it by 2/h = 5e2 and 8/h^2 = 5e5
        call tester%near(series(k, 1, f, 0), first, 1.0e-11_wp, 'the first derivative of a twist that a frame carries')
        call tester%near(series(k, 2, f, 0), second, 1.0e-8_wp, 'the second derivative')
      end do
    end do
  end subroutine carried_twist

  !> Sums of products at several positions, those beyond the number of positions left alone.
  subroutine products(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    integer, parameter :: n = batch_size - 1
    type(random_type) :: random
    real(wp) :: factors(batch_size, 3, 3), numbers(batch_size, 3), sums(batch_size, 3), expected(batch_size, 3)
    integer :: i, j, k
    logical :: anew

    do k = 1, 3
      do i = 1, batch_size
        numbers(i, k) = random%symmetric()
        expected(i, k) = random%symmetric()
        do j = 1, 3
          factors(i, j, k) = random%symmetric()
        end do
      end do
    end do
    do k = 0, 1
      anew = k == 1
      sums = expected
      if (anew) expected(:n, :) = 0.0_wp
      do j = 1, 3
        expected(:n, :) = expected(:n, :) + factors(:n, :, j)*spread(numbers(:n, j), 2, 3)
      end do
      if (anew) then
        call set_three(n, 3, factors, numbers, sums(:, 1), sums(:, 2), sums(:, 3))
      else
        call sum_three(n, 3, factors, numbers, sums(:, 1), sums(:, 2), sums(:, 3))
      end if
      call tester%near(maxval(abs(sums - expected)), 0.0_wp, 1.0e-15_wp, 'three sums of three products')
      expected = sums
    end do
    expected(:n, :) = expected(:n, :) + factors(:n, :, 1)*spread(numbers(:n, 1), 2, 3) &
                      + factors(:n, :, 2)*spread(numbers(:n, 2), 2, 3) + factors(:n, :, 3)*spread(numbers(:n, 3), 2, 3)
    call add_three_to(n, 3, factors(:, :, 1), factors(:, :, 2), factors(:, :, 3), numbers(:, 1), numbers(:, 2), numbers(:, 3), sums)
    call tester%near(maxval(abs(sums - expected)), 0.0_wp, 1.0e-15_wp, 'three products are added to each sum')
    expected(:n, :) = expected(:n, :) + factors(:n, :, 2)*spread(numbers(:n, 3), 2, 3)
    call add_to(n, 3, factors(:, :, 2), numbers(:, 3), sums)
    call tester%near(maxval(abs(sums - expected)), 0.0_wp, 1.0e-15_wp, 'one product is added to each sum')
  end subroutine products
end module test_twists
