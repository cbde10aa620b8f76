!> The smallest blocks of known mechanisms, and what any plan must hold. All of them are assembled where
!> every coordinate is zero, and have general dimensions: pivots and axes at random places.
module test_blocks
  use mech9_kinds, only: wp
  use mech9_error, only: error_type, exit_structure
  use mech9_random, only: random_type
  use mech9_model, only: model_type
  use mech9_plan, only: plan_type
  use mech9_state, only: state_type
  use mech9_planning, only: make_plan
  use mech9_sample_mechanisms, only: fig1
  use mech9_mechanism_families, only: axis_type, planar_axes, home_mechanism, class_three, class_four, &
    double_butterfly, ten_links, crank_row, lazy_tongs, stewart_platform
  use mech9_home_motions, only: loop_equations, rates_from
  use mech9_plan_checks, only: check_order, check_closed, check_smallest, block_sizes, rates_of
  use mech9_testing, only: tester_type
  implicit none
  private
  public :: run

contains

  !> Run the cases of this suite.
  subroutine run(test)
    type(tester_type), intent(inout) :: test   !< selects cases and counts their checks
    integer :: k

    if (test%runs('fig1_in_two_blocks')) call fig1_in_two_blocks(test)
    if (test%runs('class_three')) call all_drives(test, 'a group of the third class', class_three(), 3, [6, 6, 6, 0, 0, 0, 0])
    if (test%runs('class_four')) call all_drives(test, 'a group of the fourth class', class_four(), 0, [6, 6, 6, 6, 6, 6, 6])
    if (test%runs('double_butterfly')) call all_drives(test, 'double butterfly', double_butterfly(), 0, [(9, k=1, 10)])
    if (test%runs('ten_links')) call all_drives(test, 'ten links', ten_links(), 0, [(12, k=1, 13)])
    ! cranks of four-bars in a row: from wherever it is driven, one four-bar after the other
    if (test%runs('crank_row')) call all_drives(test, 'four-bars in a row', crank_row(4), 3, [(0, k=1, 13)])
    if (test%runs('tongs')) call tongs(test)
    if (test%runs('too_many_at_once')) call too_many_at_once(test)
    if (test%runs('platform')) call platform(test)
    if (test%runs('long_rows')) call long_rows(test)
  end subroutine run

  !> Pairs 4 to 7 are the first closed chain, a four-bar: driven in it, it goes first.
  subroutine fig1_in_two_blocks(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(model_type) :: model
    type(plan_type) :: plan
    type(state_type) :: state
    type(error_type), allocatable :: err
    real(wp), allocatable :: assembled(:)
    integer :: k
    type(random_type) :: random

    call fig1(5, model)
    call make_plan(model%mechanism, model%problem%partition, model%problem%initial%position, plan, state, err)
    assembled = state%q
    do k = 1, 7
      call fig1(k, model)
      model%problem%initial%position = assembled
      if (k < 4) call check(test, random, model, 'Fig. 1 driven in its second chain', [6])
      if (k >= 4) call check(test, random, model, 'Fig. 1 driven in its first chain', [3, 3])
    end do
  end subroutine fig1_in_two_blocks

  !> Tongs driven in their first crossing. Driven elsewhere, what lies below can only be closed together, because frames stand on
  !> frames.
  subroutine tongs(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(model_type) :: model
    integer :: k
    type(random_type) :: random

    call home_mechanism(42, lazy_tongs(20), planar_axes(61, 0, random), [1], model)
    call check(test, random, model, 'lazy tongs', [(3, k=1, 20)])
  end subroutine tongs

  !> Long tongs driven at their end.
  subroutine too_many_at_once(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(model_type) :: model
    type(plan_type) :: plan
    type(state_type) :: state
    type(error_type), allocatable :: err
    type(random_type) :: random

    call home_mechanism(2402, lazy_tongs(1200), planar_axes(3601, 0, random), [3601], model)
    call make_plan(model%mechanism, model%problem%partition, model%problem%initial%position, plan, state, err)
    call test%has_error(err, exit_structure, &
                        'a structure with too many coordinates that can only be solved for together is refused')
  end subroutine too_many_at_once

  subroutine platform(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(model_type) :: model
    type(random_type) :: random

    call stewart_platform(model)
    call check(test, random, model, 'Stewart platform', [30])
  end subroutine platform

  !> Ten times as many four-bars take about ten times as long; quadratic work would take a hundred times.
  subroutine long_rows(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    integer, parameter :: cells(2) = [1000, 10000]
    type(model_type) :: model
    type(plan_type) :: plan
    type(state_type) :: state
    type(error_type), allocatable :: err
    real(wp) :: before, after, seconds(2)
    integer :: i, driven
    type(random_type) :: random

    do driven = 1, 3*cells(1) + 1, 3*cells(1)
      do i = 1, 2
        call home_mechanism(2*cells(i) + 2, crank_row(cells(i)), planar_axes(3*cells(i) + 1, 0, random), &
                            [1 + (driven - 1)/cells(1)*cells(i)], model)
        call cpu_time(before)
        call make_plan(model%mechanism, model%problem%partition, model%problem%initial%position, plan, state, err)
        call cpu_time(after)
        call test%no_error(err, 'a long row has a plan')
        seconds(i) = after - before
        call test%is_true(size(plan%blocks) == cells(i) .and. all(plan%blocks%equations == 3), &
                          'a long row is divided into its four-bars')
      end do
      print '(2(a,f7.4),a)', 'plans of rows: ', seconds(1), ' s, ten times as long: ', seconds(2), ' s'
      call test%is_true(seconds(2) < 25.0_wp*seconds(1) + 0.05_wp, 'plans of long rows take a time that grows linearly')
    end do
  end subroutine long_rows

  !> A planar mechanism driven at each of its coordinates. Unknowns of its only block; 0: blocks of three.
  subroutine all_drives(test, name, links, three, unknowns)
    type(tester_type), intent(inout) :: test   !< counts the checks
    character(len=*), intent(in) :: name       !< of the mechanism, for the report of a failure
    integer, intent(in) :: links(:, :)         !< (2,M) reference and moving link of each pair
    integer, intent(in) :: three               !< unknowns of each block where there are several
    integer, intent(in) :: unknowns(:)         !< for each drive, those of its only block; 0: several blocks
    type(model_type) :: model
    type(axis_type) :: axes(size(links, 2))
    integer :: k, i
    type(random_type) :: random

    do k = 1, size(links, 2)
      axes = planar_axes(size(links, 2), 0, random)
      call home_mechanism(maxval(links), links, axes, [k], model)
      if (unknowns(k) > 0) then
        call check(test, random, model, name, [unknowns(k)])
      else
        call check(test, random, model, name, [(three, i=1, (size(links, 2) - 1)/3)])
      end if
      call check_rates(test, model, name, links, axes, k)
    end do
  end subroutine all_drives

  !> Assembled, in the blocks expected, from the guess and from another one.
  subroutine check(test, random, model, name, sizes)
    type(tester_type), intent(inout) :: test     !< counts the checks
    type(random_type), intent(inout) :: random   !< source of the numbers
    type(model_type), intent(in) :: model        !< the mechanism
    character(len=*), intent(in) :: name         !< its name, for the report of a failure
    integer, intent(in) :: sizes(:)              !< unknowns of the blocks
    type(plan_type) :: plan
    type(state_type) :: state
    type(error_type), allocatable :: err
    real(wp) :: start(size(model%mechanism%pairs))
    integer :: k

    call make_plan(model%mechanism, model%problem%partition, model%problem%initial%position, plan, state, err)
    call test%no_error(err, name//': there is a plan')
    if (allocated(err)) return
    if (size(block_sizes(plan)) == size(sizes)) then
      call test%is_true(all(block_sizes(plan) == sizes), name//': the blocks have the right numbers of unknowns')
    else
      call test%is_true(.false., name//': the number of blocks is right')
    end if
    call check_order(test, plan, name)
    call check_closed(test, plan, state, name)
    call check_smallest(test, plan, name)
    start = state%q
    do k = 1, size(start)
      if (.not. model%problem%partition%is_independent(k)) start(k) = start(k) + 0.1_wp*random%symmetric()
    end do
    call make_plan(model%mechanism, model%problem%partition, start, plan, state, err)
    call test%no_error(err, name//' is assembled from another guess')
    call check_closed(test, plan, state, name//' from another guess')
  end subroutine check

  !> Rates at home against those that the axes alone give.
  subroutine check_rates(test, model, name, links, axes, driven)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(model_type), intent(in) :: model      !< the mechanism
    character(len=*), intent(in) :: name       !< its name, for the report of a failure
    integer, intent(in) :: links(:, :)         !< (2,M) reference and moving link of each pair
    integer, intent(in) :: driven              !< number of the driven coordinate
    type(axis_type), intent(in) :: axes(:)     !< of each pair in the home position
    type(plan_type) :: plan
    type(state_type) :: state
    type(error_type), allocatable :: err
    real(wp), allocatable :: equations(:, :)
    real(wp) :: rates(size(axes)), expected(size(axes)), residual_norm
    integer :: k

    call make_plan(model%mechanism, model%problem%partition, model%problem%initial%position, plan, state, err)
    if (allocated(err)) return
    call loop_equations(maxval(links), links, axes, equations)
    expected = 0.0_wp
    expected(driven) = 1.0_wp
    rates = expected
    call rates_from(equations, [(k /= driven, k=1, size(axes))], expected, residual_norm)
    call rates_of(plan, state, rates)
    ! both solve some ten equations; random dimensions make them worse by some thousands at most
    call test%near(maxval(abs(rates - expected))/maxval(abs(expected)), 0.0_wp, 1.0e-11_wp, &
                   name//': the rates are those of the whole system')
  end subroutine check_rates
end module test_blocks
