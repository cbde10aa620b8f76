!> Messages for users from the failures of numerics: every sentence about a failure in numbers is formed in this folder.
!>
!> Reports of the input (`add_error`) explain what they are given; others who show or complete the message of a failure that
!> may come from numerics call `explain` before.
module mech9_explanation
  use mech9_kinds, only: wp
  use mech9_error, only: error_type
  use mech9_text, only: to_text, some_of
  use mech9_counted, only: counted
  use mech9_failure, only: failure_type, failure_off_curve
  use mech9_spline_failures, only: failure_few_points, failure_points_order, failure_no_spline
  use mech9_curve_failures, only: failure_sharp_curve
  use mech9_assembly_failures, only: failure_wrong_choice, failure_undetermined_coordinates, failure_open_chain, &
    failure_nearly_closed_chain, failure_locked_chain, failure_nearly_moving_chain
  use mech9_planning_failures, only: failure_large_block, failure_undetermined_block, failure_contradictory_inputs, &
    failure_chain_dimensions, failure_nothing_turns, failure_pair_off_plane, failure_chain_off_plane, &
    failure_no_fixed_axis, failure_coupled
  use mech9_tracking_failures, only: failure_start_at_dead_point, failure_start_on_branches, failure_start_unclear, &
    failure_start_locked, failure_start_not_left, failure_escape, failure_dead_point, failure_lost_branch
  use mech9_ode_failures, only: failure_infinite_rate, failure_infinite_jacobian
  use mech9_dynamics_failures, only: failure_singular_block, failure_no_inertia
  use mech9_force_gradient_failures, only: failure_lost_inertia
  use mech9_integration_failures, only: failure_singular_step, failure_unclosed_step, failure_other_branch, &
    failure_drive_jumps
  use mech9_simulation_failures, only: failure_singular_start_block, failure_open_position, &
    failure_no_initial_position, failure_not_started, failure_backwards, failure_interrupted, failure_accuracy, &
    failure_gimbal_lock, failure_lost_angles, failure_driven_dead_point, failure_lost_link, failure_loaded_lock, &
    failure_singular_passing
  use mech9_reaction_failures, only: failure_unbalanced
  use mech9_equilibrium_failures, only: failure_no_equilibrium, failure_interrupted_starts, failure_moving_setpoint
  use mech9_length_words, only: length_in_words
  use mech9_block_names, only: chain_names, words_of_block
  use mech9_coupling_words, only: explain_coupling
  use mech9_choice_words, only: explain_choice, longest_list
  use mech9_sensitivity_words, only: explain_sensitivity
  use mech9_stop_words, only: explain_stop_failure
  use mech9_friction_words, only: explain_friction_failure
  use mech9_contact_words, only: explain_contact_failure
  use mech9_integration_words, only: explain_settings, explain_step, explain_stop
  implicit none
  private
  public :: explain, explain_failure, power_of_ten

contains

  !> Form the message of an error from the numbers of its failure. An error that has its message stays as it is.
  pure subroutine explain(err)
    type(error_type), intent(inout) :: err    !< the failure

    if (allocated(err%failure)) then
      call explain_failure(err%failure, err%message)
      deallocate (err%failure)
    end if
    if (allocated(err%stopped)) then
      call explain_stop(err%stopped, err%message)
      deallocate (err%stopped)
    end if
  end subroutine explain

  !> The sentence about a failure. `text` stays as it is for an unknown kind.
  pure subroutine explain_failure(failure, text)
    type(failure_type), intent(in) :: failure             !< any kind
    character(len=:), allocatable, intent(inout) :: text  !< the message

    call explain_assembly(failure, text)
    call explain_start(failure, text)
    call explain_end(failure, text)
    call explain_equations(failure, text)
    call explain_simulation(failure, text)
    call explain_settings(failure, text)
    call explain_step(failure, text)
    call explain_points(failure, text)
    call explain_equilibrium(failure, text)
    call explain_no_plane(failure, text)
    call explain_coupling(failure, text)
    call explain_sensitivity(failure, text)
    call explain_stop_failure(failure, text)
    call explain_friction_failure(failure, text)
    call explain_contact_failure(failure, text)
  end subroutine explain_failure

  !> Chains that do not close or do not move, and independent coordinates that do not determine the others.
  pure subroutine explain_assembly(failure, text)
    type(failure_type), intent(in) :: failure             !< any kind
    character(len=:), allocatable, intent(inout) :: text  !< the message

    select case (failure%kind)
    case (failure_wrong_choice)
      call explain_choice(failure, text)
    case (failure_undetermined_coordinates)
      text = 'the independent coordinates cannot determine the others: '//to_text(size(failure%coordinates))// &
             ' more must be independent (cq); '//some_of(failure%coordinates, longest_list)//' would serve'
    case (failure_open_chain, failure_nearly_closed_chain)
      call explain_open_chain(failure, text)
    case (failure_locked_chain, failure_nearly_moving_chain)
      call explain_locked_chain(failure, text)
    case (failure_large_block)
      text = to_text(failure%number)//' coordinates could only be solved for together, and at most '// &
             to_text(failure%limit)//' can be; take independent coordinates (cq) nearer to link 1'
    case (failure_undetermined_block)
      text = chain_names(failure%chains)//' cannot determine all dependent coordinates from the independent ones near the '// &
             'start: it is singular there; take other independent coordinates (cq), or other guesses (&initial)'
    case (failure_contradictory_inputs)
      text = 'the independent coordinates cannot all move freely: '//chain_names(failure%chains)//' would not stay closed; '// &
             'take one of its coordinates off the independent ones (cq)'
    end select
  end subroutine explain_assembly

  !> " on link 4"; empty for a link that the user does not know.
  pure character(len=24) function on_link(link) result(words)
    integer, intent(in) :: link   !< number of the link; 0 for one that the user does not know

    words = ''
    if (link > 0) words = ' on link '//to_text(link)
  end function on_link

  !> A chain that does not close.
  pure subroutine explain_open_chain(failure, text)
    type(failure_type), intent(in) :: failure             !< of an open chain
    character(len=:), allocatable, intent(inout) :: text  !< the message

    text = 'the mechanism cannot be assembled: '//chain_names(failure%chains)// &
           ' (it closes'//trim(on_link(failure%link))//' through coordinate '//to_text(failure%coordinates)// &
           ') stays open by '//trim(length_in_words(failure, failure%gap, 3))//' at best; '
    if (failure%kind == failure_nearly_closed_chain) then
      text = text//'so small a gap comes from directions or points given with too few digits, '// &
             'for a chain that moves only when its geometry is exact; give more digits, or allow for their error with '// &
             '&mechanism data_tolerance='//trim(power_of_ten(failure%gap/failure%size))
    else
      text = text//'check its dimensions and the independent coordinates, or give better guesses with &initial'
    end if
  end subroutine explain_open_chain

  !> A chain whose equations are redundant at the start only.
  pure subroutine explain_locked_chain(failure, text)
    type(failure_type), intent(in) :: failure             !< of a locked chain
    character(len=:), allocatable, intent(inout) :: text  !< the message

    text = chain_names(failure%chains)//' does not move: '//to_text(failure%number)// &
           ' of its equations follow'//trim(merge('s', ' ', failure%number == 1))//' from the others at the start only; '// &
           'after a displacement of '//to_text(failure%displacement, 2)//' (rad, or parts of the mechanism''s size) it '// &
           'stays open by '//trim(length_in_words(failure, failure%gap, 3))//'; '
    if (failure%kind == failure_nearly_moving_chain) then
      text = text//'its dimensions are about '//to_text(failure%distance, 1)//' (rad, or parts of the size) from those of '// &
             'an overconstrained mechanism that moves: give points and directions with more digits, or allow for their '// &
             'error with &mechanism data_tolerance='//trim(power_of_ten(max(failure%distance, failure%gap/failure%size)))// &
             ', or use pairs with more freedom'
    else
      text = text//'check the points and directions of its pairs, or use pairs with more freedom'
    end if
  end subroutine explain_locked_chain

  !> The next power of ten, as a data file has it: "1e-6".
  pure function power_of_ten(value) result(text)
    real(wp), intent(in) :: value         !< above 0
    character(len=5) :: text

    write (text, '(a,i0)') '1e', ceiling(log10(max(value, 1.0e-15_wp)))
  end function power_of_ten

  !> Driven motions that cannot begin.
  pure subroutine explain_start(failure, text)
    type(failure_type), intent(in) :: failure             !< any kind
    character(len=:), allocatable, intent(inout) :: text  !< the message
    character(len=:), allocatable :: reason

    select case (failure%kind)
    case (failure_start_at_dead_point)
      reason = ', a dead point, where rates are not finite; start a little beside it'
    case (failure_start_on_branches)
      reason = ', where two branches meet: '
      call append_rates(failure, reason)
      reason = reason//'; start a little beside it, on the one that is meant'
    case (failure_start_unclear)
      reason = ', where it is not certain how it goes on; start a little beside it'
    case (failure_start_locked)
      reason = ', which it cannot leave as it is driven; drive it another way, or start a little beside it'
    case (failure_start_not_left)
      text = 'the mechanism starts in a singular position and cannot be followed off it with certainty; start a little '// &
             'beside it'
      return
    case default
      return
    end select
    text = 'the mechanism starts in a singular position of '//words_of_block(failure%chains, failure%coordinates)//reason
  end subroutine explain_start

  !> Append the rates by which it could go on: "dq2 = 1, dq3 = 0.5 or dq2 = 1, dq3 = -0.5 (rad/s, m/s)".
  pure subroutine append_rates(failure, text)
    type(failure_type), intent(in) :: failure             !< of the kind failure_start_on_branches
    character(len=:), allocatable, intent(inout) :: text  !< the message so far
    integer :: way, i

    do way = 1, size(failure%values, 2)
      if (way > 1) text = text//' or '
      do i = 1, size(failure%coordinates)
        if (i > 1) text = text//', '
        text = text//'dq'//to_text(failure%coordinates(i))//' = '//to_text(failure%values(i, way), 5)
      end do
    end do
    text = text//' ('//failure%name//')'
  end subroutine append_rates

  !> Driven motions that cannot go on.
  pure subroutine explain_end(failure, text)
    type(failure_type), intent(in) :: failure             !< any kind
    character(len=:), allocatable, intent(inout) :: text  !< the message
    character(len=:), allocatable :: place
    integer :: digits, i

    select case (failure%kind)
    case (failure_escape)
      ! the end is known less sharply than that at a dead point
      digits = 7
    case (failure_driven_dead_point)
      ! the last step ends a little before it
      digits = 8
    case (failure_dead_point, failure_lost_branch)
      digits = 13
    case default
      return
    end select
    place = ''
    do i = 1, size(failure%others)
      if (i > 1) place = place//', '
      place = place//'q'//to_text(failure%others(i))//' = '//to_text(failure%values(i, 1), digits)
    end do
    text = 'the motion cannot go on beyond t = '//to_text(failure%t, digits)//' s: '// &
           words_of_block(failure%chains, failure%coordinates)
    if (failure%kind == failure_escape) then
      text = text//' cannot follow up to '//place//', where coordinate '//to_text(failure%growing)//' grows beyond all bounds'
      return
    end if
    text = text//trim(merge(' reach  ', ' reaches', failure%number > 1))
    if (failure%kind == failure_dead_point .or. failure%kind == failure_driven_dead_point) then
      text = text//' a dead point at '//place//' and cannot follow farther'
    else
      text = text//' a singular position at '//place//', where it is not certain how the motion goes on'
    end if
  end subroutine explain_end

  !> Equations of motion that cannot be evaluated.
  pure subroutine explain_equations(failure, text)
    type(failure_type), intent(in) :: failure             !< any kind
    character(len=:), allocatable, intent(inout) :: text  !< the message

    select case (failure%kind)
    case (failure_singular_block, failure_singular_start_block)
      text = words_of_block(failure%chains, failure%coordinates)// &
             ' is in a singular position for these independent coordinates'
      if (failure%kind == failure_singular_start_block) then
        text = text//'; choose other independent coordinates, or start a little beside it'
      else
        text = text//'; others may pass it (cq), unless branches meet there'
      end if
    case (failure_no_inertia)
      text = 'independent coordinate '//to_text(failure%coordinates)//' has no inertia: no link with mass moves with it '// &
             '(apart from those that the independent coordinates before it move already); give a &body'
    case (failure_lost_inertia)
      text = 'independent coordinate '//to_text(failure%coordinates)//' has no inertia in the position there, although it had '// &
             'some at the start: no link with mass moves with it (apart from those that the independent coordinates before it '// &
             'move already); give the links that move with it a &body, or lower the tolerances'
    case (failure_singular_step)
      text = 'a singular position for these independent coordinates is too near; others may pass it (cq), or smaller tolerances'
    case (failure_unclosed_step)
      text = chain_names(failure%chains)//' cannot be closed near the position at t = '//to_text(failure%t, 10)// &
             ' s; lower the tolerances'
    case (failure_other_branch)
      text = 'with other independent coordinates the chains close on another branch: coordinate '// &
             to_text(failure%coordinates)//' would jump'
    case (failure_gimbal_lock)
      text = 'the motion comes to gimbal lock at t = '//to_text(failure%t, 10)//' s: there coordinates '// &
             to_text(failure%coordinates)//' can move together without moving any mass, so that the forces do not determine '// &
             'their accelerations. Turn about the axes in another order, or give the links between them inertia'
    case (failure_loaded_lock)
      call explain_loaded_lock(failure, text)
    case (failure_singular_passing)
      text = words_of_block(failure%chains, failure%coordinates)//trim(merge(' comes', ' come ', size(failure%chains) == 1))// &
             ' to a singular position at t = '// &
             to_text(failure%t, 10)//' s, in which some links can move in several ways, so that it is not certain how the '// &
             'motion goes on. End before this time, begin beside it, or change the dimensions'
    case (failure_lost_angles)
      text = 'coordinates '//to_text(failure%coordinates)//' cannot be continued through gimbal lock at t = '// &
             to_text(failure%t, 10)//' s; lower the tolerances, or turn about the axes in another order'
    case (failure_drive_jumps)
      text = 'the drive of coordinate '//to_text(failure%coordinates)//' jumps at t = '//to_text(failure%t, 7)//' s: its '// &
             'position is not where its rate has led; let it have a continuous position, over a short time if need be'
    case (failure_unbalanced)
      text = 'the closed chains of coordinates '//some_of(failure%coordinates, longest_list)// &
             ' are in a singular position at t = '//to_text(failure%t, 10)//' s, in which no finite forces in their pairs '// &
             'balance the links; choose times that leave it out, or record neither reactions nor drive_forces'
    case (failure_infinite_rate)
      if (allocated(failure%coordinates)) then
        text = 'the motion of coordinate '//to_text(failure%coordinates)
      else
        text = 'the rate of change of variable '//to_text(failure%number)
      end if
      text = text//' is not finite: this motion, or a force, grows beyond all bounds. Look for a spring, a damper or a force '// &
             'of your own that drives instead of holding back'
    case (failure_infinite_jacobian)
      text = 'entry '//to_text(failure%number)//' of the Jacobian, column by column, is not finite: the motion, or a force, '// &
             'grows beyond all bounds'
    end select
  end subroutine explain_equations

  !> A ball joint in gimbal lock whose angles cannot be replaced.
  pure subroutine explain_loaded_lock(failure, text)
    type(failure_type), intent(in) :: failure                 !< of this kind
    character(len=:), allocatable, intent(inout) :: text      !< the message

    text = 'the ball joint of coordinates '//to_text(failure%coordinates)//' comes to gimbal lock at t = '// &
           to_text(failure%t, 10)//' s: its first and its third axis are parallel there. '
    if (size(failure%others) > 0) then
      text = text//'A load on coordinate '//to_text(failure%others)//' determines no torque in this position. Let it act '// &
             'between links'
    else
      text = text//'Other angles cannot take their place, since a drive or a coupling needs these. Drive or couple other '// &
             'coordinates'
    end if
    text = text//', or turn about the axes in another order'
  end subroutine explain_loaded_lock

  !> Simulations that cannot begin or go on.
  pure subroutine explain_simulation(failure, text)
    type(failure_type), intent(in) :: failure             !< any kind
    character(len=:), allocatable, intent(inout) :: text  !< the message

    select case (failure%kind)
    case (failure_open_position)
      text = 'the closed chains are open by '//trim(length_in_words(failure, failure%gap, 3))//' at t = '// &
             to_text(failure%t, 7)//' s, and '//trim(length_in_words(failure, failure%tolerance, 3))//' is allowed ('// &
             to_text(failure%tolerance/failure%size, 1)//' of the mechanism''s size): its dimensions let it move near the '// &
             'start only; give points and directions with more digits, or a larger &mechanism data_tolerance'
    case (failure_lost_link)
      text = 'the closed chains are open by '//trim(length_in_words(failure, failure%gap, 3))//' at t = '// &
             to_text(failure%t, 7)//' s, by the round-off of lengths of '//trim(length_in_words(failure, failure%size, 3))// &
             ', and '//trim(length_in_words(failure, failure%tolerance, 3))//' is allowed beside link '// &
             to_text(failure%link)//', whose pairs are '//trim(length_in_words(failure, failure%distance, 3))//' apart: its '// &
             'motion is lost in this round-off; give lengths that differ less'
    case (failure_no_initial_position)
      text = 'the independent coordinate '//to_text(failure%coordinates)//' of this pair has no initial position; '// &
             'give &initial coordinate='//to_text(failure%coordinates)//', position=..., velocity=... /'
    case (failure_not_started)
      text = 'a motion must be started before it can advance'
    case (failure_backwards)
      text = 'the motion stands at t = '//to_text(failure%t, 10)//' s and cannot go back to t = '// &
             to_text(failure%t_stop, 10)//' s; start it anew'
    case (failure_interrupted)
      text = 'interrupted before t = '//to_text(failure%t, 10)//' s'
    case (failure_off_curve)
      text = 'coordinate '//to_text(failure%coordinates)//' comes to an end of its curve at t = '//to_text(failure%t, 10)// &
             ' s: it would go on to '//trim(length_in_words(failure, failure%values(1, 1), 10))//', and the curve leads '// &
             'from 0 to '//trim(length_in_words(failure, failure%values(2, 1), 10))//'. Start elsewhere on the '// &
             'curve, end the motion earlier, or give points of a longer curve'
    case (failure_accuracy)
      call explain_accuracy(failure, text)
    end select
  end subroutine explain_simulation

  !> An accuracy that no tolerances give, with the reason and the remedies.
  pure subroutine explain_accuracy(failure, text)
    type(failure_type), intent(in) :: failure                 !< of this kind
    character(len=:), allocatable, intent(inout) :: text      !< the message
    character(len=:), allocatable :: size

    size = 'is about '
    if (failure%limit > 0) size = 'may be '
    text = 'the motion is not as accurate as was asked for at t = '//to_text(failure%t, 10)//' s: with the least tolerances '// &
           'of '//failure%name//', '//to_text(failure%values(1, 1), 2)//', its error '//size//to_text(failure%deviation, 2)// &
           ', and '//to_text(failure%tolerance, 2)//' is allowed (in units of the file). Round-off makes such an error in '// &
           'many steps, or where the motion enlarges it: it may be chaotic. '
    if (failure%limit > 0) text = text//'The motion is stiff: prince-dormand, which has less round-off than bdf, would take '// &
                                  'more than '//to_text(failure%limit)//' times as many steps. '
    if (failure%name == 'auto' .or. failure%name == 'prince-dormand') then
      text = text//'End '
    else
      text = text//'Take the method ''auto'', which may have less round-off, end '
    end if
    text = text//'before this time, or ask for a larger accuracy'
  end subroutine explain_accuracy

  !> A search for equilibria that was interrupted, or finds none: the forces that are left, by coordinate.
  pure subroutine explain_equilibrium(failure, text)
    type(failure_type), intent(in) :: failure             !< any kind
    character(len=:), allocatable, intent(inout) :: text  !< the message
    character(len=:), allocatable :: forces
    integer :: i

    if (failure%kind == failure_interrupted_starts) text = 'interrupted after '//to_text(failure%number)//' of '// &
      counted(failure%limit, 'random start')
    if (failure%kind == failure_moving_setpoint) text = 'the setpoint of motor '//to_text(failure%number)//' follows '// &
      failure%name//', and with an integral part it has no position of rest that is known before; leave integral= out'
    if (failure%kind /= failure_no_equilibrium) return
    forces = ''
    do i = 1, size(failure%coordinates)
      if (i > 1) forces = forces//', '
      if (i > longest_list) then
        forces = forces//'...'
        exit
      end if
      forces = forces//to_text(-failure%values(i, 1), 4)//' on coordinate '//to_text(failure%coordinates(i))// &
               ' at '//to_text(failure%values(i, 2), 6)
    end do
    text = 'no position of equilibrium was found from the initial position; where the search ended, the loads still push '// &
           'with ('//failure%name//'): '//forces//'. Give another initial position, or --starts N for '// &
           'many, or look whether the loads can be balanced at all'
  end subroutine explain_equilibrium

  !> Points through which no spline can be laid.
  pure subroutine explain_points(failure, text)
    type(failure_type), intent(in) :: failure             !< any kind
    character(len=:), allocatable, intent(inout) :: text  !< the message

    select case (failure%kind)
    case (failure_few_points)
      text = 'a smooth curve needs at least 4 points, and there are '//to_text(failure%number)
    case (failure_points_order)
      text = 'points must have increasing abscissae; point '//to_text(failure%number + 1)// &
             ' does not come after point '//to_text(failure%number)
    case (failure_no_spline)
      text = 'no smooth curve runs through these points: some are too close together; leave those out'
    case (failure_sharp_curve)
      text = 'the smooth curve through these points turns back on itself after point '//to_text(failure%number)// &
             '; put the points there closer together, round a corner, or leave out a point that goes back'
    end select
  end subroutine explain_points

  !> Reasons why a mechanism is not planar.
  pure subroutine explain_no_plane(failure, text)
    type(failure_type), intent(in) :: failure             !< any kind
    character(len=:), allocatable, intent(inout) :: text  !< the sentence

    select case (failure%kind)
    case (failure_chain_dimensions)
      text = 'the motions of '//chain_names(failure%chains)//' have '//to_text(failure%number)//' dimensions, not 3'
    case (failure_nothing_turns)
      text = 'no pair turns'
    case (failure_pair_off_plane)
      text = 'pair '//to_text(failure%coordinates)//' neither turns about the plane''s normal nor slides across it'
    case (failure_no_fixed_axis)
      text = 'pair '//to_text(failure%coordinates)//' has no fixed axis'
    case (failure_chain_off_plane)
      text = chain_names(failure%chains)//' does not close in a plane'
    case (failure_coupled)
      text = 'coordinates are coupled'
    end select
  end subroutine explain_no_plane
end module mech9_explanation
