!> Frictions in a driven motion: by the reactions that they cause, in the directions of the rates.
!>
!> At rest a friction counts as zero: the drives could have any force in a range, which is found where all coordinates go with one drive.
module mech9_driven_frictions
  use mech9_kinds, only: wp
  use mech9_error, only: error_type, raise, add_place, exit_singular
  use mech9_event_tolerances, only: at_rest
  use mech9_integration_failures, only: failure_no_friction
  use mech9_driven_failures, only: failure_self_locking
  use mech9_friction, only: friction_type, bearing_terms
  use mech9_mechanism, only: mechanism_type
  use mech9_plan, only: plan_type
  use mech9_state, only: state_type
  use mech9_reaction_plan, only: is_made_for
  use mech9_friction_wrenches, only: friction_wrenches_type, prepare_friction_wrenches
  use mech9_friction_balance, only: friction_balance_type, friction_modes_type, new_friction_balance, &
    new_friction_modes
  implicit none
  private
  public :: driven_frictions_type, rest_range_type, slip_directions, any_turns_round

  !> The first output at which pairs with friction are at rest, and how many there are.
  type :: rest_range_type
    integer :: outputs = 0                   !< at which any pair with friction is at rest
    real(wp) :: t = 0.0_wp                   !< time of the first one [s]
    integer :: coordinate = 0                !< the coordinate of the only drive; 0: there are several, or the range is not known
    real(wp) :: force(2) = 0.0_wp            !< least and greatest force of this drive there [N m, N]
  end type rest_range_type

  !> The frictions of a driven motion.
  type :: driven_frictions_type
    type(friction_wrenches_type), private :: wrenches
    type(friction_balance_type), private :: balance
    real(wp), allocatable, private :: ratios(:)   !< (frictions) rates of their coordinates by that of the first drive
    type(rest_range_type) :: rest
    logical :: at_rest = .false.                  !< any pair with friction is at rest in the last position
  contains
    procedure :: find
    procedure :: bearing_terms_of
    procedure, private :: find_rest_range
  end type driven_frictions_type

  !> A term of a bearing load below this part of all its terms may be round-off.
  real(wp), parameter :: round_off_of_terms = 1.0e-10_wp

contains

  !> Find the frictions in a state whose frames have their accelerations. Fails where no drive force moves the mechanism this way.
  subroutine find(self, mechanism, plan, state, directions, err)
    class(driven_frictions_type), intent(inout) :: self   !< the frictions
    type(mechanism_type), intent(in) :: mechanism         !< the mechanism
    type(plan_type), intent(in) :: plan                   !< its plan, with all blocks
    type(state_type), intent(inout) :: state              !< the state; gets the frictions
    real(wp), intent(in) :: directions(:)                 !< (frictions) in which pairs slide: -1, 1; 0: at rest, or smooth [1]
    type(error_type), allocatable, intent(out) :: err     !< allocated if it failed
    type(friction_modes_type) :: modes
    integer :: i
    logical :: solved, unique, prepared

    associate (frictions => mechanism%frictions, balance => self%balance)
      prepared = allocated(self%wrenches%plan)
      if (prepared) prepared = is_made_for(self%wrenches%plan, plan)
      if (.not. prepared) then
        call prepare_friction_wrenches(mechanism, plan, state, self%wrenches)
        self%balance = new_friction_balance(size(frictions))
      end if
      modes = new_friction_modes(size(frictions))
      modes%direction = directions
      do i = 1, size(frictions)
        if (frictions(i)%is_smooth) modes%direction(i) = tanh(state%dq(frictions(i)%coordinate)/frictions(i)%transition)
      end do
      call find_balance(self, mechanism, plan, state, err)
      if (allocated(err)) return
      self%at_rest = any(.not. (abs(modes%direction) > 0.0_wp .or. frictions%is_smooth))
      if (self%at_rest .and. self%rest%outputs == 0) call self%find_rest_range(mechanism, plan, state, err)
      if (allocated(err)) return
      call balance%solve(frictions, modes, solved)
      unique = solved
      if (solved) unique = balance%least_determinant(frictions, modes) > 0.0_wp
      if (unique) then
        state%friction = balance%force
      else
        call fail(self, frictions, modes, plan, state, solved, err)
      end if
    end associate
  end subroutine find

  !> The terms of the bearing loads of all pairs in the last position.
  pure subroutine bearing_terms_of(self, frictions, terms)
    class(driven_frictions_type), intent(in) :: self                     !< the frictions, found
    type(friction_type), intent(in) :: frictions(:)                      !< (n) the same in the mechanism
    real(wp), intent(out) :: terms(2, bearing_terms, size(frictions))    !< vectors whose magnitudes make a bearing load [N]
    integer :: i

    do i = 1, size(frictions)
      terms(:, :, i) = self%balance%bearing_terms_of(frictions(i), i, self%balance%force)
    end do
  end subroutine bearing_terms_of

  !> Whether a term of a bearing load turns round between two positions. Its magnitude, and friction with it, has a kink between them.
  pure logical function any_turns_round(before, behind)
    real(wp), intent(in) :: before(:, :, :)   !< (2,terms,frictions) vectors in the first position [N]
    real(wp), intent(in) :: behind(:, :, :)   !< (2,terms,frictions) in the second one [N]
    real(wp) :: least
    integer :: i, k

    any_turns_round = .false.
    do i = 1, size(before, 3)
      least = round_off_of_terms*max(norm2(before(:, :, i)), norm2(behind(:, :, i)))
      do k = 1, size(before, 2)
        if (min(norm2(before(:, k, i)), norm2(behind(:, k, i))) > least) &
          any_turns_round = any_turns_round .or. dot_product(before(:, k, i), behind(:, k, i)) < 0.0_wp
      end do
    end do
  end function any_turns_round

  !> Directions in which pairs slide, by their rates; 0 at rest, and where the friction is smooth.
  pure function slip_directions(mechanism, plan, state) result(directions)
    type(mechanism_type), intent(in) :: mechanism   !< the mechanism
    type(plan_type), intent(in) :: plan             !< its plan
    type(state_type), intent(in) :: state           !< the state
    real(wp) :: directions(size(mechanism%frictions))
    real(wp) :: fastest

    fastest = fastest_rate(plan, state)
    associate (frictions => mechanism%frictions, rates => state%dq(mechanism%frictions%coordinate))
      directions = 0.0_wp
      where (abs(rates)/plan%unit_of(frictions%coordinate) > at_rest*fastest .and. .not. frictions%is_smooth) &
        directions = sign(1.0_wp, rates)
    end associate
  end function slip_directions

  !> The rate by which rest is judged: the largest one of all coordinates in their units, or what their accelerations give in the time in
  !> which they move by their units [1/s].
  pure real(wp) function fastest_rate(plan, state)
    type(plan_type), intent(in) :: plan      !< the plan
    type(state_type), intent(in) :: state    !< the state

    fastest_rate = max(maxval(abs(state%dq)/plan%unit_of), sqrt(maxval(abs(state%ddq)/plan%unit_of)))
  end function fastest_rate

  !> Find the equations of the frictions: wrenches without them, and by a unit of each.
  subroutine find_balance(self, mechanism, plan, state, err)
    class(driven_frictions_type), intent(inout) :: self   !< gets the equations
    type(mechanism_type), intent(in) :: mechanism         !< the mechanism
    type(plan_type), intent(in) :: plan                   !< its plan, with all blocks
    type(state_type), intent(inout) :: state              !< the state; its frictions are zero afterwards
    type(error_type), allocatable, intent(out) :: err     !< allocated if it failed
    real(wp) :: probes(size(mechanism%frictions)), without
    integer :: j

    associate (frictions => mechanism%frictions, balance => self%balance)
      if (.not. allocated(state%friction)) allocate (state%friction(size(frictions)))
      state%friction = 0.0_wp
      call self%wrenches%find(mechanism, plan, state, balance%wrenches, err)
      if (allocated(err)) return
      without = self%wrenches%reactions%needed(plan%independent(1))
      if (.not. allocated(self%ratios)) allocate (self%ratios(size(frictions)))
      probes = [(self%wrenches%probe(frictions(j), balance%wrenches(:, j)), j=1, size(frictions))]
      do j = 1, size(frictions)
        state%friction(j) = probes(j)
        call self%wrenches%find(mechanism, plan, state, balance%by_force(:, :, j), err)
        if (allocated(err)) return
        ! virtual work: the drive takes the force of the coordinate times its rate
        self%ratios(j) = (without - self%wrenches%reactions%needed(plan%independent(1)))/probes(j)
        balance%by_force(:, :, j) = (balance%by_force(:, :, j) - balance%wrenches)/probes(j)
        state%friction(j) = 0.0_wp
      end do
    end associate
  end subroutine find_balance

  !> Find the range of the force of the only drive at rest, with which all coordinates go.
  subroutine find_rest_range(self, mechanism, plan, state, err)
    class(driven_frictions_type), intent(inout) :: self   !< with the equations; gets the range
    type(mechanism_type), intent(in) :: mechanism         !< the mechanism
    type(plan_type), intent(in) :: plan                   !< its plan
    type(state_type), intent(inout) :: state              !< the state; its frictions are zero afterwards
    type(error_type), allocatable, intent(out) :: err     !< allocated if it failed
    type(friction_modes_type) :: modes
    type(friction_type) :: at_bound(size(mechanism%frictions))
    real(wp) :: needed(2), wrenches(6, size(mechanism%frictions))
    integer :: i, side
    logical :: solved

    self%rest%t = state%t
    if (size(plan%independent) /= 1) return
    associate (frictions => mechanism%frictions, drive => plan%independent(1))
      if (any(abs(state%dq)/plan%unit_of > at_rest*max(fastest_rate(plan, state), tiny(1.0_wp)/at_rest))) return
      at_bound = frictions
      at_bound%dynamic = frictions%static
      modes = new_friction_modes(size(frictions))
      do side = 1, 2
        do i = 1, size(frictions)
          if (abs(self%ratios(i)) > at_rest .and. .not. frictions(i)%is_smooth) &
            modes%direction(i) = (2*side - 3)*sign(1.0_wp, self%ratios(i))
        end do
        call self%balance%solve(at_bound, modes, solved)
        if (.not. solved) return
        state%friction = self%balance%force
        call self%wrenches%find(mechanism, plan, state, wrenches, err)
        if (allocated(err)) return
        needed(side) = self%wrenches%reactions%needed(drive)
      end do
      state%friction = 0.0_wp
      self%rest%coordinate = drive
      self%rest%force = [minval(needed), maxval(needed)]
    end associate
  end subroutine find_rest_range

  !> Fail because the frictions lock the mechanism against its drives, or because they are not found.
  subroutine fail(self, frictions, modes, plan, state, solved, err)
    class(driven_frictions_type), intent(inout) :: self   !< with the equations
    type(friction_type), intent(in) :: frictions(:)       !< the frictions
    type(friction_modes_type), intent(in) :: modes        !< how they act
    type(plan_type), intent(in) :: plan                   !< the plan
    type(state_type), intent(in) :: state                 !< the state
    logical, intent(in) :: solved                         !< there are forces that move it this way
    type(error_type), allocatable, intent(out) :: err     !< the failure
    integer :: k, worst

    if (self%balance%least_determinant(frictions, modes) > 0.0_wp) then
      call raise(err, exit_singular, failure_no_friction)
      err%failure%coordinates = pack(frictions%coordinate, abs(modes%direction) > 0.0_wp)
    else
      k = plan%independent(maxloc(abs(state%dq(plan%independent))/plan%unit_of(plan%independent), dim=1))
      worst = self%balance%steepest(frictions, modes)
      call raise(err, exit_singular, failure_self_locking)
      err%failure%coordinates = [frictions(worst)%coordinate, k]
      err%failure%values = reshape(frictions(worst)%dynamic*[1.0_wp, self%balance%least_factor(frictions, modes)], [1, 2])
      err%failure%number = nint(sign(1.0_wp, state%dq(k)))
      err%failure%limit = merge(2, 1, solved)
      err%failure%growing = count(abs(modes%direction) > 0.0_wp)
      call add_place(err, place=frictions(worst)%place)
    end if
    err%failure%t = state%t
  end subroutine fail
end module mech9_driven_frictions
