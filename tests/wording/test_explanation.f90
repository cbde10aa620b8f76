!> Sentences from failures in numbers: each kind has one, and it is the one that users know.
module test_explanation
  use mech9_kinds, only: wp
  use mech9_error, only: error_type, raise, add_place, place_type, exit_data, exit_integrator, exit_interrupted, exit_singular, &
    exit_structure, exit_usage
  use mech9_failure, only: failure_type, last_shared_failure
  use mech9_spline_failures, only: last_spline_failure, failure_few_points, failure_points_order
  use mech9_curve_failures, only: last_curve_failure, failure_sharp_curve
  use mech9_assembly_failures, only: last_assembly_failure, failure_wrong_choice, failure_locked_chain, &
    failure_nearly_moving_chain, failure_undetermined_coordinates, failure_open_coupling
  use mech9_planning_failures, only: last_planning_failure, failure_large_block, failure_undetermined_block, &
    failure_contradictory_inputs
  use mech9_tracking_failures, only: last_tracking_failure, failure_start_on_branches, failure_start_unclear, &
    failure_start_locked, failure_start_not_left, failure_escape, failure_dead_point, failure_lost_branch
  use mech9_ode_failures, only: last_ode_failure, failure_no_jacobian, failure_step_memory, failure_step_settings, &
    failure_unknown_method, failure_relative_tolerance, failure_absolute_tolerance, failure_tolerance_count, &
    failure_infinite_rate, failure_infinite_jacobian
  use mech9_dynamics_failures, only: last_dynamics_failure, failure_singular_block, failure_no_inertia
  use mech9_sensitivity_failures, only: last_sensitivity_failure
  use mech9_force_gradient_failures, only: last_force_gradient_failure, failure_lost_inertia
  use mech9_driven_failures, only: last_driven_failure
  use mech9_integration_failures, only: last_integration_failure, failure_other_branch, failure_drive_jumps, &
    failure_no_friction, failure_contact_paradox
  use mech9_event_failures, only: last_event_failure, failure_undecided_friction
  use mech9_simulation_failures, only: last_simulation_failure, failure_singular_start_block, failure_not_started, &
    failure_backwards, failure_interrupted, failure_lost_angles, failure_unheld_stop
  use mech9_reaction_failures, only: last_reaction_failure
  use mech9_equilibrium_failures, only: last_equilibrium_failure, failure_interrupted_starts
  use mech9_integration_methods, only: integration_methods
  use mech9_explanation, only: explain
  use mech9_testing, only: tester_type, message_of
  implicit none
  private
  public :: run

contains

  !> Run the cases of this suite.
  subroutine run(test)
    type(tester_type), intent(inout) :: test   !< selects cases and counts their checks

    if (test%runs('each_kind')) call each_kind(test)
    if (test%runs('choices')) call choices(test)
    if (test%runs('couplings')) call couplings(test)
    if (test%runs('blocks')) call blocks(test)
    if (test%runs('motions')) call motions(test)
    if (test%runs('stopped_integration')) call stopped_integration(test)
    if (test%runs('integrations')) call integrations(test)
    if (test%runs('uses_of_the_library')) call uses_of_the_library(test)
    if (test%runs('kept_message')) call kept_message(test)
  end subroutine run

  !> No kind keeps the message that `raise` gives it, and an explained error keeps its sentence.
  subroutine each_kind(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(error_type), allocatable :: err
    character(len=:), allocatable :: fallback
    !> The last kind of each module of kinds, whose numbers begin behind a multiple of 100.
    integer, parameter :: lasts(*) = [last_shared_failure, last_spline_failure, last_curve_failure, last_assembly_failure, &
      last_planning_failure, last_tracking_failure, last_ode_failure, last_dynamics_failure, last_sensitivity_failure, &
      last_force_gradient_failure, last_simulation_failure, last_reaction_failure, last_equilibrium_failure, &
      last_integration_failure, last_event_failure, last_driven_failure]
    integer :: i, kind

    do i = 1, size(lasts)
      do kind = lasts(i) - modulo(lasts(i), 100) + 1, lasts(i)
        call check_kind(test, kind)
      end do
      call raise(err, exit_structure, lasts(i) + 1)
      fallback = err%message
      call explain(err)
      call test%is_true(err%message == fallback, 'an unknown kind keeps the message that names it')
    end do
  end subroutine each_kind

  !> A kind has one sentence, and its error keeps its code.
  subroutine check_kind(test, kind)
    type(tester_type), intent(inout) :: test   !< counts the checks
    integer, intent(in) :: kind                !< one of the failure_ constants
    type(error_type), allocatable :: err
    character(len=:), allocatable :: fallback, sentence

    call raise(err, exit_structure, kind)
    call fill(err%failure)
    fallback = err%message
    call explain(err)
    sentence = err%message
    call test%is_true(sentence /= fallback .and. len(sentence) > 10, fallback//' has a sentence: '//sentence)
    call test%is_true(.not. allocated(err%failure), fallback//' is explained once')
    call explain(err)
    call test%is_true(err%message == sentence, fallback//' stays explained')
    call test%is_true(err%code == exit_structure, fallback//' keeps its code')
  end subroutine check_kind

  !> All numbers that any kind may need.
  subroutine fill(failure)
    type(failure_type), intent(inout) :: failure   !< of any kind

    failure%chains = [2]
    failure%lines = [0]
    failure%coordinates = [4, 6]
    failure%others = [1]
    allocate (failure%idle(0), failure%replaces(6, 1), failure%values(3, 2))
    failure%replaces = .false.
    failure%values = 1.5_wp
    failure%name = 'bdg'
    failure%link = 3
    failure%growing = 5
    failure%number = 6
    failure%limit = 7
    failure%gap = 1.0e-7_wp
    failure%distance = 1.0e-5_wp
    failure%tolerance = 1.0e-9_wp
  end subroutine fill

  !> Couplings and closed chains that contradict each other, by their numbers, with the lines of couplings.
  subroutine couplings(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    character(len=*), parameter :: begin = 'the mechanism cannot be assembled: ', &
      end = '. Leave one of them out, or mend its numbers; constants of gears follow from the positions in &initial, unless '// &
            'phase gives them'
    type(error_type), allocatable :: err

    call raise(err, exit_structure, failure_open_coupling)
    err%failure%coordinates = [1, 2]
    err%failure%chains = [-3, -12, 2, -1]
    err%failure%lines = [7, 20, 0, 5]
    call says(test, err, begin//'closed chain 2, couplings 1 (line 5), 3 (line 7) and 12 (line 20) contradict each other: no '// &
              'coordinates fulfil them together'//end)
    call raise(err, exit_structure, failure_open_coupling)
    err%failure%coordinates = [1, 2]
    err%failure%chains = [-2, 3, 1]
    err%failure%lines = [6, 0, 0]
    call says(test, err, begin//'closed chains 1, 3 and coupling 2 (line 6) contradict each other: no coordinates fulfil them '// &
              'together'//end)
  end subroutine couplings

  !> Choices of independent coordinates: too few, too many, none possible.
  subroutine choices(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(error_type), allocatable :: err

    call raise(err, exit_structure, failure_wrong_choice)
    err%failure%number = 4
    err%failure%coordinates = [integer ::]
    err%failure%others = [1]
    err%failure%idle = [4]
    err%failure%replaces = reshape([.true., .true., .true., .false.], [4, 1])
    call says(test, err, &
              'the mobility is 1 (4 coordinates, rank 3), and no coordinate is independent; 1 more of the coordinates '// &
              '1, 2, 3 must be independent (cq); cq = 1 would serve; instead of 1 also 2, 3; never: 4, which cannot move')
    err%failure%coordinates = [1, 2]
    err%failure%idle = [integer ::]
    call says(test, err, &
              'the mobility is 1 (4 coordinates, rank 3), and 2 coordinates are independent; take 1 of the coordinates '// &
              '1, 2 off the independent ones (cq); cq = 1 would serve; instead of 1 also 2, 3')
    err%failure%coordinates = [2]
    err%failure%others = [integer ::]
    call says(test, err, &
              'the mobility is 0 (4 coordinates, rank 4), and 1 coordinate is independent; the mechanism cannot move, '// &
              'no coordinate can be independent')
    call raise(err, exit_structure, failure_undetermined_coordinates)
    err%failure%coordinates = [3, 5]
    call says(test, err, &
              'the independent coordinates cannot determine the others: 2 more must be independent (cq); 3, 5 would serve')
  end subroutine choices

  !> Blocks that are too large, undetermined, contradictory or locked.
  subroutine blocks(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(error_type), allocatable :: err

    call raise(err, exit_structure, failure_large_block)
    err%failure%number = 3001
    err%failure%limit = 3000
    call says(test, err, '3001 coordinates could only be solved for together, and at most 3000 can be; take independent '// &
              'coordinates (cq) nearer to link 1')
    call raise(err, exit_structure, failure_undetermined_block)
    err%failure%chains = [1, 3]
    call says(test, err, &
              'closed chains 1, 3 together cannot determine all dependent coordinates from the independent ones near '// &
              'the start: it is singular there; take other independent coordinates (cq), or other guesses (&initial)')
    call raise(err, exit_structure, failure_contradictory_inputs)
    err%failure%chains = [2]
    call says(test, err, &
              'the independent coordinates cannot all move freely: closed chain 2 would not stay closed; take one of its '// &
              'coordinates off the independent ones (cq)')
    call raise(err, exit_structure, failure_locked_chain)
    err%failure%chains = [1]
    err%failure%number = 1
    err%failure%displacement = 0.3_wp
    err%failure%gap = 0.0123_wp
    call says(test, err, 'closed chain 1 does not move: 1 of its equations follows from the others at the start only; after a '// &
              'displacement of 0.3 (rad, or parts of the mechanism''s size) it stays open by 0.0123 m; check the points and '// &
              'directions of its pairs, or use pairs with more freedom')
    err%failure%kind = failure_nearly_moving_chain
    err%failure%number = 2
    err%failure%distance = 2.0e-6_wp
    err%failure%gap = 1.0e-6_wp
    call says(test, err, 'closed chain 1 does not move: 2 of its equations follow from the others at the start only; after a '// &
              'displacement of 0.3 (rad, or parts of the mechanism''s size) it stays open by 1e-6 m; its dimensions are about '// &
              '2e-6 (rad, or parts of the size) from those of an overconstrained mechanism that moves: give points and '// &
              'directions with more digits, or allow for their error with &mechanism data_tolerance=1e-5, or use pairs with '// &
              'more freedom')
  end subroutine blocks

  !> Driven motions that do not begin or end early. Coordinates of a block are named in ascending order.
  subroutine motions(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(error_type), allocatable :: err

    call raise(err, exit_singular, failure_start_on_branches)
    err%failure%chains = [1]
    err%failure%coordinates = [4, 2]
    err%failure%values = reshape([1.0_wp, 0.5_wp, -1.0_wp, -0.25_wp], [2, 2])
    err%failure%name = 'rad/s, m/s'
    call says(test, err, &
              'the mechanism starts in a singular position of closed chain 1 (coordinates 2, 4), where two branches meet: '// &
              'dq4 = 1, dq2 = 0.5 or dq4 = -1, dq2 = -0.25 (rad/s, m/s); start a little beside it, on the one that is meant')
    err%failure%kind = failure_start_unclear
    call says(test, err, &
              'the mechanism starts in a singular position of closed chain 1 (coordinates 2, 4), where it is not certain '// &
              'how it goes on; start a little beside it')
    err%failure%kind = failure_start_locked
    call says(test, err, &
              'the mechanism starts in a singular position of closed chain 1 (coordinates 2, 4), which it cannot leave '// &
              'as it is driven; drive it another way, or start a little beside it')
    err%failure%kind = failure_start_not_left
    call says(test, err, &
              'the mechanism starts in a singular position and cannot be followed off it with certainty; start a little '// &
              'beside it')
    err%failure%kind = failure_dead_point
    err%failure%t = 0.25_wp
    err%failure%others = [1, 3]
    err%failure%values = reshape([30.0_wp, 0.5_wp], [2, 1])
    err%failure%number = 1
    call says(test, err, 'the motion cannot go on beyond t = 0.25 s: closed chain 1 (coordinates 2, 4) reaches a dead point at '// &
              'q1 = 30, q3 = 0.5 and cannot follow farther')
    err%failure%kind = failure_lost_branch
    err%failure%number = 2
    err%failure%chains = [1, 2]
    call says(test, err, &
              'the motion cannot go on beyond t = 0.25 s: closed chains 1, 2 together (coordinates 2, 4) reach a singular '// &
              'position at q1 = 30, q3 = 0.5, where it is not certain how the motion goes on')
    err%failure%kind = failure_escape
    err%failure%growing = 4
    call says(test, err, &
              'the motion cannot go on beyond t = 0.25 s: closed chains 1, 2 together (coordinates 2, 4) cannot follow up '// &
              'to q1 = 30, q3 = 0.5, where coordinate 4 grows beyond all bounds')
  end subroutine motions

  !> The failure of a system is told with the times of the integration that it ended.
  subroutine stopped_integration(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(error_type), allocatable :: err

    call raise(err, exit_singular, failure_singular_block)
    err%failure%chains = [1]
    err%failure%coordinates = [3, 2]
    call says(test, err, &
              'closed chain 1 (coordinates 2, 3) is in a singular position for these independent coordinates; others may '// &
              'pass it (cq), unless branches meet there')
    allocate (err%stopped)
    err%stopped%t = 0.5_wp
    err%stopped%t_failed = 0.75_wp
    call says(test, err, &
              'the integration cannot go on from t = 0.5 s: at t = 0.75 s: closed chain 1 (coordinates 2, 3) is in a '// &
              'singular position for these independent coordinates; others may pass it (cq), unless branches meet there')
    deallocate (err%stopped)
    err%failure%kind = failure_singular_start_block
    call says(test, err, &
              'closed chain 1 (coordinates 2, 3) is in a singular position for these independent coordinates; choose '// &
              'other independent coordinates, or start a little beside it')
    call raise(err, exit_singular, failure_other_branch)
    err%failure%coordinates = [7]
    call says(test, err, 'with other independent coordinates the chains close on another branch: coordinate 7 would jump')
    ! a user's procedure has its own message
    call raise(err, exit_integrator, 'the force is not finite')
    allocate (err%stopped)
    err%stopped%t = 1.0_wp
    err%stopped%t_failed = 1.5_wp
    call says(test, err, 'the integration cannot go on from t = 1 s: at t = 1.5 s: the force is not finite')
  end subroutine stopped_integration

  !> Integrations that cannot begin or go on, for reasons that data files do not lead to.
  subroutine integrations(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(error_type), allocatable :: err

    call raise(err, exit_data, failure_unknown_method)
    err%failure%name = 'euler'
    call test%is_true(index(message_of(err), 'unknown method of integration ''euler''. There are: '// &
                            trim(integration_methods(1)%name)//', ') == 1, &
                            'the message about an unknown method names the methods: '//message_of(err))
    call raise(err, exit_data, failure_relative_tolerance)
    err%failure%tolerance = 1.5_wp
    call says(test, err, 'the relative tolerance must be between 0 and 1; it is 1.5')
    call raise(err, exit_data, failure_absolute_tolerance)
    call says(test, err, 'the absolute tolerance must be greater than 0')
    call raise(err, exit_integrator, failure_tolerance_count)
    call says(test, err, 'an integration needs one absolute tolerance for each of its variables')
    call raise(err, exit_integrator, failure_no_jacobian)
    call says(test, err, 'a system of equations without Jacobian was asked for it')
    call raise(err, exit_integrator, failure_step_memory)
    err%failure%t = 2.0_wp
    call says(test, err, 'the integration cannot go on from t = 2 s: there is not enough memory')
    call raise(err, exit_integrator, failure_step_settings)
    call says(test, err, 'the integration cannot go on from t = 0 s: its settings do not fit together')
    call raise(err, exit_integrator, failure_infinite_rate)
    err%failure%number = 2
    call says(test, err, &
              'the rate of change of variable 2 is not finite: this motion, or a force, grows beyond all bounds. Look for '// &
              'a spring, a damper or a force of your own that drives instead of holding back')
    call raise(err, exit_integrator, failure_infinite_jacobian)
    err%failure%number = 3
    call says(test, err, &
              'entry 3 of the Jacobian, column by column, is not finite: the motion, or a force, grows beyond all bounds')
    call raise(err, exit_integrator, failure_lost_inertia)
    err%failure%coordinates = [3]
    call says(test, err, &
              'independent coordinate 3 has no inertia in the position there, although it had some at the start: no link '// &
              'with mass moves with it (apart from those that the independent coordinates before it move already); give the '// &
              'links that move with it a &body, or lower the tolerances')
  end subroutine integrations

  !> Mistakes of programs that use the library, and requests of theirs.
  subroutine uses_of_the_library(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(error_type), allocatable :: err

    call raise(err, exit_data, failure_few_points)
    err%failure%number = 3
    call says(test, err, 'a smooth curve needs at least 4 points, and there are 3')
    call raise(err, exit_data, failure_points_order)
    err%failure%number = 2
    call says(test, err, 'points must have increasing abscissae; point 3 does not come after point 2')
    call raise(err, exit_data, failure_sharp_curve)
    err%failure%number = 2
    call says(test, err, &
              'the smooth curve through these points turns back on itself after point 2; put the points there closer '// &
              'together, round a corner, or leave out a point that goes back')
    call raise(err, exit_usage, failure_not_started)
    call says(test, err, 'a motion must be started before it can advance')
    call raise(err, exit_usage, failure_backwards)
    err%failure%t = 1.5_wp
    err%failure%t_stop = 1.0_wp
    call says(test, err, 'the motion stands at t = 1.5 s and cannot go back to t = 1 s; start it anew')
    call raise(err, exit_interrupted, failure_interrupted)
    err%failure%t = 0.25_wp
    call says(test, err, 'interrupted before t = 0.25 s')
    call raise(err, exit_interrupted, failure_interrupted_starts)
    err%failure%number = 17
    err%failure%limit = 100
    call says(test, err, 'interrupted after 17 of 100 random starts')
    call raise(err, exit_singular, failure_lost_angles)
    err%failure%coordinates = [1, 2, 3]
    err%failure%t = 0.25_wp
    call says(test, err, &
              'coordinates 1, 2, 3 cannot be continued through gimbal lock at t = 0.25 s; lower the tolerances, or turn '// &
              'about the axes in another order')
    call raise(err, exit_singular, failure_no_friction)
    err%failure%coordinates = [2, 4]
    err%failure%t = 0.25_wp
    call says(test, err, &
              'the frictions of coordinates 2, 4 have no solution at t = 0.25 s: they grow faster than what they resist. '// &
              'Lower the coefficients of friction')
    call raise(err, exit_singular, failure_contact_paradox)
    err%failure%number = 1
    err%failure%values = reshape([1.5_wp, 1.25_wp], [1, 2])
    err%failure%t = 0.25_wp
    call says(test, err, &
              'the friction of contact 1 has no solution from t = 0.25 s on (the paradox of Painleve): its coefficient is 1.5, '// &
              'and from 1.25 on friction draws the links together faster than they are pressed apart. Lower friction=, or end '// &
              'the motion before')
    call raise(err, exit_singular, failure_undecided_friction)
    err%failure%coordinates = [2, 4]
    err%failure%t = 0.25_wp
    call says(test, err, &
              'the motion ends at t = 0.25 s, because no choice of sticking and slipping pairs agrees with the friction of '// &
              'coordinates 2, 4. Lower the coefficients of friction, or give law=''smooth''')
    call raise(err, exit_singular, failure_unheld_stop)
    err%failure%coordinates = [2, 4]
    err%failure%t = 0.25_wp
    call says(test, err, &
              'the motion ends at t = 0.25 s, because no independent coordinates serve while stops and frictions hold '// &
              'coordinates 2, 4. Make one of these stops compliant by stiffness=, or the friction smooth by law=''smooth''')
    call raise(err, exit_singular, failure_drive_jumps)
    err%failure%coordinates = [2]
    err%failure%t = 0.25_wp
    call says(test, err, &
              'the drive of coordinate 2 jumps at t = 0.25 s: its position is not where its rate has led; let it have a '// &
              'continuous position, over a short time if need be')
  end subroutine uses_of_the_library

  !> An error with a message of its own stays as it is, and so do places.
  subroutine kept_message(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(error_type), allocatable :: err

    call raise(err, exit_structure, 'no axis', place_type(4, 5))
    call explain(err)
    call test%is_true(err%message == 'no axis' .and. err%place%line == 4, 'an error with a message keeps it')
    call raise(err, exit_structure, failure_no_inertia)
    err%failure%coordinates = [2]
    call add_place(err, place=place_type(7, 1))
    call explain(err)
    call test%is_true(err%place%line == 7, 'a place that was added to a failure in numbers is kept')
  end subroutine kept_message

  !> Check the sentence about a failure, which stays in numbers.
  subroutine says(test, err, sentence)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(error_type), intent(in) :: err        !< the failure
    character(len=*), intent(in) :: sentence   !< expected

    call test%is_true(message_of(err) == sentence, sentence//' is the sentence, not: '//message_of(err))
  end subroutine says
end module test_explanation
