!> Mechanisms at random: planar, spherical and spatial, with several loops, up to some hundred
!> coordinates, with as many independent coordinates as the axes allow. Each is assembled at home and
!> away from it, and its rates are those that its axes give.
!>
!> Compares the program with itself in part: mechanisms in other units; rates are held against the axes.
module test_random_mechanisms
  use mech9_kinds, only: wp
  use mech9_error, only: error_type
  use mech9_random, only: random_type
  use mech9_model, only: model_type
  use mech9_plan, only: plan_type
  use mech9_state, only: state_type
  use mech9_planning, only: make_plan
  use mech9_mechanism_families, only: axis_type, planar_axes, spatial_axes, spherical_axes, home_mechanism, random_links
  use mech9_home_motions, only: loop_equations, choose_dependent, rates_from
  use mech9_plan_checks, only: check_order, check_closed, check_smallest, rates_of
  use mech9_testing, only: tester_type
  implicit none
  private
  public :: run

contains

  !> Run the cases of this suite.
  subroutine run(test)
    type(tester_type), intent(inout) :: test   !< selects cases and counts their checks

    if (test%runs('small_mechanisms')) call small_mechanisms(test)
    if (test%runs('large_planar')) call try(test, 'large planar', 250, 60, 1, 5)
    if (test%runs('large_spatial')) call try(test, 'large spatial', 300, 25, 3, 4)
  end subroutine run

  subroutine small_mechanisms(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    integer :: i, n

    do i = 1, 60
      n = 4 + modulo(7*i, 25)
      call try(test, 'planar, revolutes', n, 1 + n/6, 1, 0)
      call try(test, 'planar, some slide', n, 1 + n/6, 1, 4)
      call try(test, 'spherical', n, 1 + n/6, 2, 0)
      call try(test, 'spatial, revolutes', n + 8, 1 + n/12, 3, 0)
      call try(test, 'spatial, some slide', n + 8, 1 + n/12, 3, 3)
    end do
  end subroutine small_mechanisms

  subroutine try(test, name, n_links, loops, family, slide_each)
    type(tester_type), intent(inout) :: test   !< counts the checks
    character(len=*), intent(in) :: name       !< of the mechanism, for the report of a failure
    integer, intent(in) :: n_links             !< links, the frame included
    integer, intent(in) :: loops               !< closed chains
    integer, intent(in) :: family              !< 1 planar, 2 spherical, 3 spatial
    integer, intent(in) :: slide_each          !< of so many pairs one slides; 0: none
    integer, allocatable :: links(:, :)
    type(axis_type), allocatable :: axes(:)
    real(wp), allocatable :: equations(:, :)
    logical, allocatable :: dependent(:)
    type(model_type) :: model
    integer :: k
    type(random_type) :: random

    allocate (links, source=random_links(n_links, loops, random))
    if (family == 1) axes = planar_axes(size(links, 2), slide_each, random)
    if (family == 2) axes = spherical_axes(size(links, 2), random)
    if (family == 3) axes = spatial_axes(size(links, 2), slide_each, random)
    call loop_equations(n_links, links, axes, equations)
    allocate (dependent(size(axes)))
    call choose_dependent(equations, random, dependent)
    call home_mechanism(n_links, links, axes, pack([(k, k=1, size(axes))], .not. dependent), model)
    call check(test, random, name, model, equations, dependent)
    if (size(axes) < 60) call check_units(test, random, name, n_links, links, axes, model)
  end subroutine try

  !> The same mechanism in other units of length, over seven orders of magnitude: the same blocks, and the
  !> same position to the last digits from the same guess.
  subroutine check_units(test, random, name, n_links, links, axes, model)
    type(tester_type), intent(inout) :: test     !< counts the checks
    type(random_type), intent(inout) :: random   !< source of the numbers
    character(len=*), intent(in) :: name         !< of the mechanism, for the report of a failure
    integer, intent(in) :: n_links               !< links, the frame included
    integer, intent(in) :: links(:, :)           !< (2,M) reference and moving link of each pair
    type(axis_type), intent(in) :: axes(:)       !< of each pair in the home position
    type(model_type), intent(in) :: model        !< mechanism that is given in other units
    real(wp), parameter :: units(2) = [1.0e-4_wp, 1.0e3_wp]
    type(axis_type) :: scaled(size(axes))
    type(model_type) :: other
    type(plan_type) :: plan, other_plan
    type(state_type) :: state, other_state
    type(error_type), allocatable :: err
    real(wp) :: start(size(axes)), unit_of(size(axes))
    integer :: i, k

    do k = 1, size(axes)
      start(k) = 0.05_wp*random%symmetric()
    end do
    where (.not. model%problem%partition%independent()) start = 0.0_wp
    start = 0.02_wp*start
    call make_plan(model%mechanism, model%problem%partition, start, plan, state, err)
    if (allocated(err)) return       ! out of reach: no position to compare
    do i = 1, size(units)
      scaled = axes
      do k = 1, size(axes)
        scaled(k)%point = units(i)*axes(k)%point
      end do
      unit_of = merge(units(i), 1.0_wp, axes%slides)
      call home_mechanism(n_links, links, scaled, plan%independent, other)
      call make_plan(other%mechanism, other%problem%partition, start*unit_of, other_plan, other_state, err)
      call test%no_error(err, name//' has a plan in other units')
      if (allocated(err)) return
      call test%is_true(size(plan%blocks) == size(other_plan%blocks), name//' has as many blocks in other units')
      if (size(plan%blocks) == size(other_plan%blocks)) &
        call test%is_true(all(plan%blocks%last_step == other_plan%blocks%last_step), name//' has the same blocks in other units')
      ! round-off of the closures, times the condition of the equations
      call test%near(maxval(abs(other_state%q/unit_of - state%q)), 0.0_wp, 1.0e-9_wp, name//' has the same position in other units')
    end do
  end subroutine check_units

  subroutine check(test, random, name, model, equations, dependent)
    type(tester_type), intent(inout) :: test     !< counts the checks
    type(random_type), intent(inout) :: random   !< source of the numbers
    character(len=*), intent(in) :: name         !< of the mechanism, for the report of a failure
    type(model_type), intent(in) :: model        !< the model
    real(wp), intent(in) :: equations(:, :)      !< (6 loops,M) that the rates satisfy
    logical, intent(in) :: dependent(:)          !< (M) coordinates that follow from the others
    type(plan_type) :: plan
    type(state_type) :: state
    type(error_type), allocatable :: err
    real(wp) :: rates(size(dependent)), expected(size(dependent)), start(size(dependent)), residual_norm
    integer :: k

    call make_plan(model%mechanism, model%problem%partition, model%problem%initial%position, plan, state, err)
    call test%no_error(err, name//': there is a plan')
    if (allocated(err)) return
    call check_order(test, plan, name)
    call check_closed(test, plan, state, name)
    call check_smallest(test, plan, name)
    call test%near(maxval(abs(state%q)), 0.0_wp, 1.0e-12_wp, name//': the chains are closed at home')
    do k = 1, size(rates)
      expected(k) = random%symmetric()
    end do
    where (dependent) expected = 0.0_wp
    rates = expected
    call rates_from(equations, dependent, expected, residual_norm)
    call test%near(residual_norm/maxval(abs(expected)), 0.0_wp, 1.0e-9_wp, &
                   name//': the reference equations do not contradict themselves')
    call rates_of(plan, state, rates)
    ! the choice of coordinates is good, but some hundred at random have a condition of some thousands
    call test%near(maxval(abs(rates - expected))/maxval(abs(expected)), 0.0_wp, 1.0e-9_wp, &
                   name//': the rates are those of the reference equations')
    start = 1.0e-3_wp/maxval(abs(expected))*expected
    where (dependent) start = 0.0_wp
    call make_plan(model%mechanism, model%problem%partition, start, plan, state, err)
    call test%no_error(err, name//' is assembled beside home')
    if (allocated(err)) return
    call check_closed(test, plan, state, name//' beside home')
    ! the motion goes on with these rates but for what is of second order in 1e-3
    start = 1.0e-3_wp/maxval(abs(expected))*expected
    call test%near(maxval(abs(state%q - start)), 0.0_wp, 5.0e-4_wp, name//': the position beside home is that of the rates')
  end subroutine check
end module test_random_mechanisms
