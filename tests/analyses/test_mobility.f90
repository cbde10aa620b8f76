!> Reports on mobility against elementary geometry: four-bars, three parallel cranks, a rod between balls, repeated gears; and choices
!> of independent coordinates.
module test_mobility
  use mech9_program_kind, only: dynamics
  use mech9_kinds, only: wp
  use mech9_error, only: error_type
  use mech9_model, only: model_type
  use mech9_plan, only: plan_type
  use mech9_state, only: state_type
  use mech9_planning, only: make_plan
  use mech9_mobility_report, only: mobility_report_type, report_mobility
  use mech9_independent_choice, only: find_choice
  use mech9_sample_mechanisms, only: four_bar, general_loop, new_mechanism, add_revolute, frame
  use mech9_planar_mechanisms, only: four_bar_type, four_bar_guess
  use mech9_loaded_mechanisms, only: five_bar
  use mech9_text_models, only: model_from_text
  use mech9_testing, only: tester_type
  implicit none
  private
  public :: run

  type(four_bar_type), parameter :: bar = four_bar_type(ground=1.0_wp, crank=0.4_wp, coupler=0.9_wp, rocker=0.7_wp)

contains

  !> Run the cases of this suite.
  subroutine run(tester)
    type(tester_type), intent(inout) :: tester   !< selects cases and counts their checks

    if (tester%runs('planar_four_bar')) call planar_four_bar(tester)
    if (tester%runs('spatial_loop')) call spatial_loop(tester)
    if (tester%runs('parallel_cranks')) call parallel_cranks(tester)
    if (tester%runs('idle_rod')) call idle_rod(tester)
    if (tester%runs('repeated_gears')) call repeated_gears(tester)
    if (tester%runs('choices')) call choices(tester)
    if (tester%runs('driven_choice')) call driven_choice(tester)
  end subroutine run

  !> The report of a model at its start.
  subroutine judge(tester, model, plan, report)
    type(tester_type), intent(inout) :: tester            !< counts the checks
    type(model_type), intent(in) :: model                 !< the model
    type(plan_type), intent(out) :: plan                  !< its plan
    type(mobility_report_type), intent(out) :: report     !< the report
    type(state_type) :: state
    type(error_type), allocatable :: err

    call make_plan(model%mechanism, model%problem%partition, model%problem%initial%position, plan, state, err)
    call tester%no_error(err, 'there is a plan')
    if (.not. allocated(err)) call report_mobility(model%mechanism, plan, state, report)
    call tester%is_true(report%general, 'there is a general position')
  end subroutine judge

  !> One loop of three dimensions: 4 - 3. The rates of the angles of a four-bar add up to zero with the signs of its loop.
  subroutine planar_four_bar(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(model_type) :: model
    type(plan_type) :: plan
    type(mobility_report_type) :: report

    call four_bar(bar%ground, bar%crank, bar%coupler, bar%rocker, four_bar_guess(bar, 0.8_wp, 1), model)
    call judge(tester, model, plan, report)
    call tester%is_true(report%by_count == 1 .and. report%by_rank == 1, 'a four-bar has one freedom')
    call tester%is_true(sum(report%ranks) == 3 .and. all(report%dimensions == 3), 'its links move in three dimensions')
    call tester%is_true(all(report%moves) .and. all(report%redundant == 0) .and. size(report%idle) == 0, 'all its joints move')
    call tester%near(report%shares(1, 1), 1.0_wp, 0.0_wp, 'the crank turns as it does')
    ! rates of order one over a conditioning of some tenths
    call tester%near(report%shares(1, 1) + report%shares(2, 1) + report%shares(3, 1) - report%shares(4, 1), 0.0_wp, 1.0e-13_wp, &
                     'crank, coupler and joint make the angle of the rocker')
  end subroutine planar_four_bar

  !> Seven revolutes in space: 7 - 6.
  subroutine spatial_loop(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(model_type) :: model
    type(plan_type) :: plan
    type(mobility_report_type) :: report

    call general_loop(model)
    call judge(tester, model, plan, report)
    call tester%is_true(report%by_count == 1 .and. report%by_rank == 1 .and. all(report%dimensions == 6), &
                        'a loop of seven pairs in space has one freedom')
  end subroutine spatial_loop

  !> Three equal cranks carry a coupler: six pairs less two loops of three dimensions count none, but the third crank only follows, so
  !> that one equation of the second loop is redundant.
  subroutine parallel_cranks(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    integer, parameter :: links(2, 6) = reshape([1, 2, 2, 3, 3, 4, 4, 1, 3, 5, 5, 1], [2, 6])
    real(wp), parameter :: z(3) = [0.0_wp, 0.0_wp, 1.0_wp]
    real(wp), parameter :: at(2, 6) = reshape([0.0_wp, 0.0_wp, 0.3_wp, 0.5_wp, 1.3_wp, 0.5_wp, 1.0_wp, 0.0_wp, &
                                               2.3_wp, 0.5_wp, 2.0_wp, 0.0_wp], [2, 6])
    type(model_type) :: model
    type(plan_type) :: plan
    type(mobility_report_type) :: report
    integer :: k

    call new_mechanism(5, links, [1], model)
    do k = 1, 6
      call add_revolute(model, k, links(1, k), links(2, k), frame([at(:, k), 0.0_wp], z), frame([at(:, k), 0.0_wp], z))
    end do
    call judge(tester, model, plan, report)
    call tester%is_true(report%by_count == 0 .and. report%by_rank == 1, 'the count misses the freedom of three parallel cranks')
    call tester%is_true(sum(report%redundant) == 1, 'one equation is redundant')
    call tester%is_true(all(report%moves), 'all joints move')
    ! cranks are parallel, and the coupler stays so
    call tester%near(maxval(abs(abs(report%shares(:, 1)) - 1.0_wp)), 0.0_wp, 1.0e-12_wp, 'all angles turn by as much')
  end subroutine parallel_cranks

  !> A rod between two balls turns about its own axis while nothing else moves. The line between the balls is none of their axes, so
  !> that all six coordinates take part.
  subroutine idle_rod(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(model_type) :: model
    type(plan_type) :: plan
    type(mobility_report_type) :: report

    call model_from_text(tester, '&structure cq=1,2 / '// &
                         '&pair coordinate=1, links=1,2, kind=''revolute'', axis=0,0,1, moving_point=0,0,0 / '// &
                         '&pair coordinates=2,3,4, links=2,3, kind=''spherical'', point=0.2,0.15,0, moving_point=0,0,0 / '// &
                         '&pair coordinates=5,6,7, links=3,4, kind=''spherical'', point=1.1,0.2,0.1, moving_point=0,0,0.6 / '// &
                         '&pair coordinate=8, links=1,4, kind=''revolute'', axis=0.1,1,0, point=1,0,0, moving_point=0,0,0 /', &
                         dynamics, model)
    call judge(tester, model, plan, report)
    call tester%is_true(report%by_count == 2 .and. report%by_rank == 2, 'the crank and the turn of the rod are two freedoms')
    call tester%is_true(size(report%idle) == 1, 'one of them is idle')
    if (size(report%idle) /= 1) return
    call tester%is_true(size(report%idle(1)%coordinates) == 6, 'all coordinates of the balls take part')
    call tester%is_true(all(report%idle(1)%coordinates > 1 .and. report%idle(1)%coordinates < 8), 'and no others')
    call tester%is_true(minval(report%idle(1)%ends) == 2 .and. maxval(report%idle(1)%ends) == 4, &
                        'the links at its ends stand still')
  end subroutine idle_rod

  !> Of two gears with one ratio between the same wheels, one is redundant, and repeats the other.
  subroutine repeated_gears(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    character(len=*), parameter :: gear = '&coupling kind=''gear'', coordinates=1,2, ratio=-2.5 / '
    type(model_type) :: model
    type(plan_type) :: plan
    type(mobility_report_type) :: report
    integer :: c

    call model_from_text(tester, '&structure cq=1 / &pair coordinate=1, links=1,2, kind=''revolute'', axis=0,0,1 / '// &
                         '&pair coordinate=2, links=1,3, kind=''revolute'', axis=0,0,1, point=1,0,0 / '//gear//gear, &
                         dynamics, model)
    call judge(tester, model, plan, report)
    call tester%is_true(report%by_count == 0 .and. report%by_rank == 1, 'two wheels have one freedom')
    call tester%is_true(sum(report%redundant) == 1, 'one gear is redundant')
    c = findloc(report%redundant, 1, dim=1)
    call tester%is_true(allocated(report%repeating(c)%chains), 'it is told what it repeats')
    if (allocated(report%repeating(c)%chains)) &
      call tester%is_true(any(abs(report%repeating(c)%chains) == 1), 'it repeats the first gear')
    call tester%near(report%shares(2, 1), -2.5_wp, 1.0e-14_wp, 'the second wheel turns by the ratio')
  end subroutine repeated_gears

  !> A dependent coordinate in place of a free one: of a four-bar the only one, of a five-bar that which moves it most. The choice that
  !> is proposed serves.
  subroutine choices(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(model_type) :: model
    integer, allocatable :: choice(:)
    integer :: k
    logical :: known

    call four_bar(bar%ground, bar%crank, bar%coupler, bar%rocker, four_bar_guess(bar, 0.8_wp, 1), model)
    do k = 2, 4
      call find_choice(model, k, known, choice)
      call tester%is_true(known .and. size(choice) == 1, 'a four-bar has one independent coordinate')
      if (size(choice) == 1) call tester%is_true(choice(1) == k, 'any of its coordinates serves')
    end do
    call five_bar(model)
    do k = 2, 4
      call find_choice(model, k, known, choice)
      call tester%is_true(known .and. size(choice) == 2, 'a five-bar has two independent coordinates')
      if (size(choice) /= 2) cycle
      call tester%is_true(any(choice == k) .and. (any(choice == 1) .neqv. any(choice == 5)), 'one of them stays')
    end do
  end subroutine choices

  !> A coordinate that driven ones determine cannot become independent.
  subroutine driven_choice(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(model_type) :: model
    integer, allocatable :: choice(:)
    logical :: known

    call model_from_text(tester, '&structure cq=1 / &pair coordinate=1, links=1,2, kind=''revolute'', axis=0,0,1 / '// &
                         '&pair coordinate=2, links=1,3, kind=''revolute'', axis=0,0,1, point=1,0,0 / '// &
                         '&coupling kind=''gear'', coordinates=1,2, ratio=-2.5 / '// &
                         '&drive coordinate=1, kind=''polynomial'', coefficients=0,1 /', dynamics, model)
    call find_choice(model, 2, known, choice)
    call tester%is_true(known .and. size(choice) == 0, 'a wheel that is driven by gears cannot become independent')
  end subroutine driven_choice
end module test_mobility
