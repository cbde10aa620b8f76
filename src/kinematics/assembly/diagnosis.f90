!> Why a choice of independent coordinates cannot serve, and which choices would: words for errors.
module mech9_diagnosis
  use mech9_kinds, only: wp
  use mech9_error, only: error_type, raise, exit_structure, exit_assembly
  use mech9_text, only: to_text, some_of
  use mech9_random, only: random_type
  use mech9_plan, only: plan_type
  use mech9_state, only: state_type
  use mech9_assembly, only: assembly_outcome_type
  use mech9_finite_motion, only: locked_chain_type
  use mech9_release, only: close_free, most_free_coordinates
  use mech9_mobility, only: find_motions, choose_coordinates, shares_of, moves_least
  implicit none
  private
  public :: judge_choice, refuse_open, refuse_undetermined, refuse_locked

  !> Numbers that a list in a message shows at most.
  integer, parameter :: longest_list = 24
  !> Coordinates that are this near the start again, in their units, after a change of all of them have
  !> come back. Round-off of a closure moves coordinates of a singular position by its root.
  real(wp), parameter :: comes_back = 1.0e-4_wp
  !> Part in the motions of length one from which a coordinate would not come back by chance.
  real(wp), parameter :: seems_to_move = 1.0e-2_wp

  !> Dimensions that are this near to those of a mechanism that moves were meant to be these.
  real(wp), parameter :: overconstrained_nearby = 1.0e-3_wp

contains

  !> Judge the independent coordinates at closed positions in which all coordinates may give way. `err`
  !> tells what is wrong with them (exit_structure), or that the chains close nowhere (exit_assembly);
  !> not allocated: they can serve, or the mechanism is too large to be judged in one piece. `state` is
  !> then a closed position near the coordinates it came with, if `closed`.
  subroutine judge_choice(plan, state, closed, err)
    type(plan_type), intent(in) :: plan   !< the plan of the mechanism
    type(state_type), intent(inout) :: state   !< position and motion of the mechanism
    logical, intent(out) :: closed
    type(error_type), allocatable, intent(out) :: err   !< allocated if it failed
    type(assembly_outcome_type) :: outcome
    type(state_type) :: trial
    real(wp), allocatable :: motions(:, :), best(:, :), positions(:, :)
    logical, dimension(plan%n_coordinates) :: wanted, chosen, back, held
    character(len=:), allocatable :: text
    integer :: i, k

    closed = .false.
    if (plan%n_coordinates > most_free_coordinates) return
    wanted = .false.
    wanted(plan%independent) = .true.
    call close_free(plan, state, .true., outcome, err)
    if (allocated(err)) return
    if (.not. outcome%closed) then
      call refuse_open(plan, outcome, err)
      return
    end if
    closed = .true.
    call find_positions(plan, state, positions, back)
    trial = state
    do i = 1, size(positions, 2)
      trial%q = positions(:, i)
      ! closed already: this puts the frames in place
      call close_free(plan, trial, .false., outcome, err)
      if (allocated(err)) return
      held = .false.
      call find_motions(plan, trial, held, motions)
      held = back .and. [(norm2(motions(k, :)) > seems_to_move, k=1, size(held))]
      if (any(held)) call find_motions(plan, trial, held, motions)
      call choose_coordinates(motions, wanted, chosen)
      if (all(chosen .eqv. wanted)) return
      ! where branches of different mobility meet, a general position of the least mobile one
      if (.not. allocated(best)) best = motions
      if (size(motions, 2) < size(best, 2)) best = motions
    end do
    call explain_choice(best, wanted, text)
    call raise(err, exit_structure, text)
  end subroutine judge_choice

  !> General closed positions near one that may be special, and the coordinates that come back to it
  !> each time. Where the rates say that such a one moves, they are wrong: it is locked, and the position
  !> singular.
  subroutine find_positions(plan, state, positions, back)
    type(plan_type), intent(in) :: plan   !< the plan of the mechanism
    type(state_type), intent(in) :: state   !< position and motion of the mechanism
    real(wp), allocatable, intent(out) :: positions(:, :)   !< (M,n): the given one where no other closes
    logical, intent(out) :: back(:)
    real(wp), parameter :: amounts(6) = [0.3_wp, 0.1_wp, 0.03_wp, 0.3_wp, 0.1_wp, 0.03_wp]
    type(assembly_outcome_type) :: outcome
    type(error_type), allocatable :: err
    type(state_type) :: trial
    type(random_type) :: random
    real(wp) :: found(plan%n_coordinates, size(amounts))
    integer :: i, k, n

    n = 0
    back = plan%steps(plan%step_of)%is_screw
    trial = state
    do i = 1, size(amounts)
      trial%q = state%q
      do k = 1, plan%n_coordinates
        if (plan%steps(plan%step_of(k))%is_screw) &
          trial%q(k) = state%q(k) + amounts(i)*plan%unit_of(k)*random%symmetric()
      end do
      call close_free(plan, trial, .false., outcome, err)
      if (allocated(err)) cycle
      if (.not. outcome%closed) cycle
      n = n + 1
      found(:, n) = trial%q
      back = back .and. abs(trial%q - state%q) < comes_back*plan%unit_of
    end do
    if (n < 2) back = .false.
    if (n == 0) then
      n = 1
      found(:, 1) = state%q
    end if
    positions = found(:, :n)
  end subroutine find_positions

  !> What is wrong with a choice of independent coordinates, and what would serve.
  subroutine explain_choice(motions, wanted, text)
    real(wp), intent(in) :: motions(:, :)
    logical, intent(in) :: wanted(:)
    character(len=:), allocatable, intent(out) :: text
    logical :: chosen(size(wanted)), others(size(wanted))
    real(wp), allocatable :: shares(:, :)
    integer :: f, i, k, m

    m = size(wanted)
    f = size(motions, 2)
    text = 'the mobility is '//to_text(f)//' ('//to_text(m)//' coordinates, rank '//to_text(m - f)//'), and '
    select case (count(wanted))
    case (0)
      text = text//'no coordinate is independent'
    case (1)
      text = text//'1 coordinate is independent'
    case default
      text = text//to_text(count(wanted))//' coordinates are independent'
    end select
    if (f == 0) then
      text = text//'; the mechanism cannot move, no coordinate can be independent'
      return
    end if
    call choose_coordinates(motions, wanted, chosen)
    call shares_of(motions, chosen, shares)
    call explain_needed(shares, wanted, chosen, text)
    call explain_surplus(shares, wanted, chosen, text)
    text = text//'; cq = '//some_of(numbers_of(chosen), longest_list)//' would serve'
    i = 0
    do k = 1, m
      if (.not. chosen(k)) cycle
      i = i + 1
      others = abs(shares(:, i)) > moves_least .and. .not. chosen
      if (i <= longest_list .and. any(others)) &
        text = text//'; instead of '//to_text(k)//' also '//some_of(numbers_of(others), longest_list)
    end do
    others = [(norm2(motions(k, :)) <= moves_least, k=1, m)]
    if (any(others)) text = text//'; never: '//some_of(numbers_of(others), longest_list)//', which cannot move'
  end subroutine explain_choice

  !> Append "; 1 more of the coordinates 2, 3 must be independent (cq)", or nothing.
  pure subroutine explain_needed(shares, wanted, chosen, text)
    real(wp), intent(in) :: shares(:, :)
    logical, intent(in) :: wanted(:), chosen(:)
    character(len=:), allocatable, intent(inout) :: text
    logical :: could(size(wanted))
    integer :: i, k

    if (all(wanted .or. .not. chosen)) return
    could = .false.
    i = 0
    do k = 1, size(wanted)
      if (.not. chosen(k)) cycle
      i = i + 1
      if (.not. wanted(k)) could = could .or. (abs(shares(:, i)) > moves_least .and. .not. wanted)
    end do
    text = text//'; '//to_text(count(chosen .and. .not. wanted))//' more of the coordinates '// &
           some_of(numbers_of(could), longest_list)//' must be independent (cq)'
  end subroutine explain_needed

  !> Append "; take 1 of the coordinates 1, 2 off the independent ones (cq)", or nothing.
  pure subroutine explain_surplus(shares, wanted, chosen, text)
    real(wp), intent(in) :: shares(:, :)
    logical, intent(in) :: wanted(:), chosen(:)
    character(len=:), allocatable, intent(inout) :: text
    logical :: could(size(wanted))
    integer :: i, k, j

    if (all(chosen .or. .not. wanted)) return
    could = wanted .and. .not. chosen
    do j = 1, size(wanted)
      if (chosen(j) .or. .not. wanted(j)) cycle
      i = 0
      do k = 1, size(wanted)
        if (.not. chosen(k)) cycle
        i = i + 1
        if (wanted(k) .and. abs(shares(j, i)) > moves_least) could(k) = .true.
      end do
    end do
    text = text//'; take '//to_text(count(wanted .and. .not. chosen))//' of the coordinates '// &
           some_of(numbers_of(could), longest_list)//' off the independent ones (cq)'
  end subroutine explain_surplus

  !> Coordinates that no chain determines, of a mechanism too large to be judged in one piece.
  subroutine refuse_undetermined(undetermined, err)
    integer, intent(in) :: undetermined(:)
    type(error_type), allocatable, intent(out) :: err   !< allocated if it failed

    call raise(err, exit_structure, 'the independent coordinates cannot determine the others: '// &
               to_text(size(undetermined))//' more must be independent (cq); '//some_of(undetermined, longest_list)// &
               ' would serve')
  end subroutine refuse_undetermined

  !> Chains that do not close.
  subroutine refuse_open(plan, outcome, err)
    type(plan_type), intent(in) :: plan   !< the plan of the mechanism
    type(assembly_outcome_type), intent(in) :: outcome
    type(error_type), allocatable, intent(out) :: err   !< allocated if it failed
    character(len=:), allocatable :: text

    associate (closure => plan%closures(outcome%worst_closure))
      text = 'the mechanism cannot be assembled: closed chain '//to_text(closure%chain)// &
             ' (it closes on link '//to_text(plan%steps(closure%closing)%link)//' through coordinate '// &
             to_text(plan%steps(closure%closing)%coordinate)//') stays open by '//to_text(outcome%gap, 3)// &
             ' m at best; '
    end associate
    if (outcome%gap < 1.0e-5_wp*plan%length) then
      text = text//'so small a gap comes from directions or points given with too few digits, '// &
             'for a chain that moves only when its geometry is exact; give more digits, or allow for their error with '// &
             '&mechanism data_tolerance='//trim(power_of_ten(outcome%gap/plan%length))
    else
      text = text//'check its dimensions and the independent coordinates, or give better guesses with &initial'
    end if
    call raise(err, exit_assembly, text)
  end subroutine refuse_open

  !> A chain whose equations are redundant at the start only.
  subroutine refuse_locked(plan, locked, err)
    type(plan_type), intent(in) :: plan   !< the plan of the mechanism
    type(locked_chain_type), intent(in) :: locked
    type(error_type), allocatable, intent(out) :: err   !< allocated if it failed
    character(len=:), allocatable :: text

    text = 'closed chain '//to_text(plan%closures(locked%closure)%chain)//' does not move: '//to_text(locked%redundant)// &
           ' of its equations follow'//trim(merge('s', ' ', locked%redundant == 1))//' from the others at the start only; '// &
           'after a displacement of '//to_text(locked%displacement, 2)//' (rad, or parts of the mechanism''s size) it stays '// &
           'open by '//to_text(locked%gap, 3)//' m; '
    if (locked%distance <= overconstrained_nearby) then
      text = text//'its dimensions are about '//to_text(locked%distance, 1)//' (rad, or parts of the size) from those of '// &
             'an overconstrained mechanism that moves: give points and directions with more digits, or allow for their '// &
             'error with &mechanism data_tolerance='//trim(power_of_ten(max(locked%distance, locked%gap/plan%length)))// &
             ', or use pairs with more freedom'
    else
      text = text//'check the points and directions of its pairs, or use pairs with more freedom'
    end if
    call raise(err, exit_structure, text)
  end subroutine refuse_locked

  !> The next power of ten, as a data file has it: "1e-6".
  pure function power_of_ten(value) result(text)
    real(wp), intent(in) :: value         !< above 0
    character(len=5) :: text

    write (text, '(a,i0)') '1e', ceiling(log10(max(value, 1.0e-15_wp)))
  end function power_of_ten

  pure function numbers_of(mask) result(numbers)
    logical, intent(in) :: mask(:)
    integer, allocatable :: numbers(:)
    integer :: i

    numbers = pack([(i, i=1, size(mask))], mask)
  end function numbers_of

end module mech9_diagnosis
