!> Frictions in the equations of motion: their forces by Coulomb's law, with the reactions that they and the accelerations cause.
!>
!> The accelerations and the wrenches of the pairs are linear in the forces. Those without frictions and those by a unit of each friction
!> make the equations of mech9_friction_balance; their solution gives the accelerations, without another evaluation. Contacts of links that
!> act in given modes have forces that are linear in the frictions, too: each of these accelerations and wrenches contains those of contacts.
module mech9_friction_motion
  use mech9_kinds, only: wp
  use mech9_error, only: error_type, raise, exit_integrator, exit_data
  use mech9_dynamics_failures, only: failure_no_inertia
  use mech9_integration_failures, only: failure_no_friction
  use mech9_integration_tolerances, only: blocked_part
  use mech9_cholesky, only: cholesky_factorize, cholesky_solve
  use mech9_mechanism, only: mechanism_type
  use mech9_plan, only: plan_type
  use mech9_state, only: state_type
  use mech9_lagrange_types, only: dynamics_plan_type, lagrange_work_type
  use mech9_jacobian, only: rates_by_independent
  use mech9_lagrange, only: find_equations, complete_accelerations
  use mech9_friction_wrenches, only: friction_wrenches_type, prepare_friction_wrenches
  use mech9_masks, only: numbers_of
  use mech9_contact_motion, only: contact_motion_type, contact_rows_type, choose_contacts, find_acting_rows, press, constrain, &
    show_forces
  use mech9_friction_balance, only: friction_balance_type, friction_modes_type, new_friction_balance, new_friction_modes
  implicit none
  private
  public :: friction_motion_type, begin_frictions, prepare_frictions, find_friction_balance, find_frictions, find_heat_rates

  !> The frictions of a motion in its present coordinates.
  type :: friction_motion_type
    type(friction_modes_type) :: modes                 !< how they act
    integer, allocatable :: held(:)                    !< coordinates that drives hold in place of sticking pairs
    type(friction_wrenches_type) :: wrenches
    type(friction_balance_type) :: balance
    logical, allocatable :: moves(:)                   !< (independent) no drive but those of sticking pairs moves the coordinate
    real(wp), allocatable :: rows(:, :)                !< (independent,frictions) rates of their coordinates by those of the independent ones
    real(wp), allocatable :: accelerations(:)          !< (independent) without frictions [rad/s^2, m/s^2]
    real(wp), allocatable :: by_force(:, :)            !< (independent,frictions) accelerations by the forces
    real(wp), allocatable :: by_impulse(:, :)          !< (independent,frictions) changes of rates by impulses, which contacts without friction allow
    real(wp), allocatable :: mobility(:, :)            !< (frictions,frictions) changes of the rates of their coordinates by these impulses
    real(wp), allocatable :: unbound(:)                !< (frictions) changes of the rate of each by its own impulse, if no contact were closed
    real(wp), allocatable :: pressed(:, :, :)          !< (3,contacts,0:frictions) forces of contacts without frictions and by each of them
    real(wp), allocatable :: heat_rate(:)              !< (frictions) power that they take [W]
    logical, allocatable :: released(:)                !< (frictions) the pair begins to slip at the present event, and does not stick again in it
    logical :: touches = .false.                       !< contacts of links act
    type(contact_rows_type) :: touching                !< their equations
  contains
    procedure :: take_held
  end type friction_motion_type

contains

  !> Begin the frictions of a motion: none acts yet, and none has taken energy.
  pure subroutine begin_frictions(mechanism, state, self)
    type(mechanism_type), intent(in) :: mechanism                  !< the mechanism
    type(state_type), intent(inout) :: state                       !< gets frictions and energies
    type(friction_motion_type), intent(inout) :: self              !< the frictions

    associate (n => size(mechanism%frictions))
      if (.not. allocated(self%held)) then
        self%modes = new_friction_modes(n)
        allocate (self%held(0))
      end if
      if (allocated(state%friction)) return
      allocate (state%friction(n), state%heat(n), source=0.0_wp)
    end associate
  end subroutine begin_frictions

  !> Take other coordinates that drives hold.
  pure subroutine take_held(self, sticking, changes)
    class(friction_motion_type), intent(inout) :: self     !< the frictions
    integer, intent(in) :: sticking(:)                     !< the coordinates
    logical, intent(out) :: changes                        !< they are others than before
    integer :: i

    changes = size(sticking) /= size(self%held)
    if (.not. changes) changes = .not. all([(any(self%held == sticking(i)), i=1, size(sticking))])
    self%held = sticking
  end subroutine take_held

  !> Prepare the frictions in a plan.
  subroutine prepare_frictions(mechanism, plan, state, self)
    type(mechanism_type), intent(in) :: mechanism          !< the mechanism
    type(plan_type), intent(in) :: plan                    !< its plan, with all blocks
    type(state_type), intent(in) :: state                  !< an assembled position
    type(friction_motion_type), intent(inout) :: self      !< the frictions, with modes

    associate (n => size(mechanism%frictions), m => size(plan%independent))
      call prepare_friction_wrenches(mechanism, plan, state, self%wrenches)
      self%balance = new_friction_balance(n)
      self%balance%force = state%friction
      if (allocated(self%rows)) deallocate (self%rows, self%accelerations, self%by_force, self%by_impulse, self%mobility, &
                                            self%heat_rate)
      allocate (self%rows(m, n), self%accelerations(m), self%by_force(m, n), self%by_impulse(m, n), self%mobility(n, n), &
                self%heat_rate(n), source=0.0_wp)
    end associate
  end subroutine prepare_frictions

  !> Find the equations of the frictions in a state with placed frames and independent rates. The frictions of the state and
  !> work%accelerations are those of the last trial afterwards.
  subroutine find_friction_balance(mechanism, plan, dynamics, state, work, self, contact, err)
    type(mechanism_type), intent(in) :: mechanism         !< the mechanism
    type(plan_type), intent(in) :: plan                   !< its plan
    type(dynamics_plan_type), intent(in) :: dynamics      !< its plan of dynamics
    type(state_type), intent(inout) :: state              !< the state; gets rates, and accelerations that rates alone give
    type(lagrange_work_type), intent(inout) :: work       !< scratch; gets the equations of motion without frictions
    type(friction_motion_type), intent(inout) :: self     !< gets the equations
    class(contact_motion_type), allocatable, intent(inout) :: contact   !< contacts of links in their modes; not allocated: there are none
    type(error_type), allocatable, intent(out) :: err     !< allocated if it failed
    real(wp) :: by_rates(size(state%ddq)), factors(size(plan%independent), size(plan%independent))
    real(wp) :: probes(size(mechanism%frictions)), alone(size(plan%independent))
    integer :: i, j, n, failed_at
    integer, allocatable :: free(:)

    state%friction = 0.0_wp
    if (allocated(contact)) state%contact_force = 0.0_wp
    call find_equations(mechanism, plan, dynamics, state, work, err)
    if (allocated(err)) return
    by_rates = state%ddq
    self%moves = .not. plan%driven(plan%independent)
    do i = 1, size(self%held)
      if (dynamics%place_of(self%held(i)) > 0) self%moves(dynamics%place_of(self%held(i))) = .true.
    end do
    call begin_contacts(err)
    if (allocated(err)) return
    free = pack([(i, i=1, size(plan%independent))], self%moves)
    n = size(free)
    do j = 1, n
      do i = 1, j
        factors(j, i) = work%coefficients(max(free(i), free(j)), min(free(i), free(j)))
        factors(i, j) = factors(j, i)
      end do
    end do
    call factorize(factors(:n, :n), failed_at)
    if (failed_at > 0) then
      call raise(err, exit_data, failure_no_inertia)
      err%failure%coordinates = [plan%independent(free(failed_at))]
      return
    end if
    alone = 0.0_wp
    alone(free) = work%forces(free) - work%velocity_terms(free)
    call solve(alone)
    do i = 1, size(mechanism%frictions)
      call rates_by_independent(plan, dynamics, work%jacobian, mechanism%frictions(i)%coordinate, self%rows(:, i))
      self%by_force(:, i) = 0.0_wp
      self%by_force(free, i) = self%rows(free, i)
      call solve(self%by_force(:, i))
    end do
    self%accelerations = alone
    self%by_impulse = self%by_force
    self%unbound = sum(self%rows*self%by_force, dim=1)
    associate (balance => self%balance, frictions => mechanism%frictions)
      call add_contacts(self%accelerations, 0, err)
      if (.not. allocated(err)) call find_wrenches(self%accelerations, balance%wrenches, err)
      if (allocated(err)) return
      balance%accelerations = state%ddq(frictions%coordinate)
      probes = [(max(abs(balance%force(j)), self%wrenches%probe(frictions(j), balance%wrenches(:, j))), j=1, size(frictions))]
      do j = 1, size(frictions)
        if (self%touches) then
          call constrain(mechanism%contacts, self%touching, contact, self%by_impulse(:, j))
          work%accelerations = alone + probes(j)*self%by_force(:, j)
          call add_contacts(work%accelerations, j, err)
          if (allocated(err)) return
          self%by_force(:, j) = (work%accelerations - self%accelerations)/probes(j)
          self%pressed(:, :, j) = (self%pressed(:, :, j) - self%pressed(:, :, 0))/probes(j)
        end if
        balance%by_force(:, :, j) = 0.0_wp
        if (.not. frictions(j)%is_smooth .and. self%modes%group(j) == 0 .and. .not. abs(self%modes%direction(j)) > 0.0_wp) cycle
        state%friction(j) = probes(j)
        call find_wrenches(self%accelerations + probes(j)*self%by_force(:, j), balance%by_force(:, :, j), err)
        if (allocated(err)) return
        balance%by_force(:, :, j) = (balance%by_force(:, :, j) - balance%wrenches)/probes(j)
        state%friction(j) = 0.0_wp
      end do
      balance%mobility = matmul(transpose(self%rows), self%by_force)
      self%mobility = matmul(transpose(self%rows), self%by_impulse)
      if (self%touches) call leave_blocked(self, alone)
    end associate
    state%ddq = by_rates
  contains
    !> Find the equations of the contacts that act.
    subroutine begin_contacts(err)
      type(error_type), allocatable, intent(out) :: err     !< allocated if a coordinate has no inertia

      self%touches = .false.
      if (allocated(contact)) self%touches = contact%any_acts()
      if (.not. self%touches) return
      if (.not. allocated(self%pressed)) &
        allocate (self%pressed(3, size(mechanism%contacts), 0:size(mechanism%frictions)), source=0.0_wp)
      call choose_contacts(numbers_of(contact%acts), self%moves, self%touching)
      call find_acting_rows(mechanism, plan, dynamics, state, work, self%touching, err)
    end subroutine begin_contacts

    !> Add to accelerations without contacts those by their forces, and keep these forces.
    subroutine add_contacts(accelerations, place, err)
      real(wp), intent(inout) :: accelerations(:)           !< (independent) the accelerations
      integer, intent(in) :: place                          !< at which the forces are kept
      type(error_type), allocatable, intent(out) :: err     !< allocated if friction draws a contact together

      if (.not. self%touches) return
      call press(mechanism%contacts, self%touching, state, contact, accelerations, err)
      self%pressed(:, :, place) = contact%forces
    end subroutine add_contacts

    !> Factorize the coefficients of the coordinates that move.
    pure subroutine factorize(matrix, failed_at)
      real(wp), intent(inout), contiguous :: matrix(:, :)   !< the coefficients; then their factors
      integer, intent(out) :: failed_at                     !< place of one without inertia; 0: all have inertia

      call cholesky_factorize(n, matrix, failed_at)
    end subroutine factorize

    !> Turn forces on the coordinates that move into accelerations.
    subroutine solve(values)
      real(wp), intent(inout) :: values(:)   !< (independent) forces; then accelerations
      real(wp) :: right(n), matrix(n, n)

      if (n == 0) return
      right = values(free)
      matrix = factors(:n, :n)
      call cholesky_solve(n, matrix, right)
      values(free) = right
    end subroutine solve

    !> Find the wrenches under the present frictions, the forces of contacts, and accelerations of the independent coordinates.
    subroutine find_wrenches(accelerations, wrenches, err)
      real(wp), intent(in) :: accelerations(:)              !< (independent) the accelerations
      real(wp), intent(out) :: wrenches(:, :)               !< (6,frictions) the wrenches
      type(error_type), allocatable, intent(out) :: err     !< allocated if it failed

      work%accelerations = accelerations
      state%ddq = by_rates
      call complete_accelerations(plan, dynamics, work, state)
      call self%wrenches%find(mechanism, plan, state, wrenches, err)
    end subroutine find_wrenches
  end subroutine find_friction_balance

  !> Let pairs have no mobility whose coordinates closed contacts hold, as those that drives alone move: what round-off leaves of it would
  !> let them stick.
  pure subroutine leave_blocked(self, alone)
    type(friction_motion_type), intent(inout) :: self     !< the frictions, with their mobilities
    real(wp), intent(in) :: alone(:)                      !< (independent) accelerations without frictions and contacts [rad/s^2, m/s^2]
    integer :: i

    do i = 1, size(self%mobility, 1)
      if (self%mobility(i, i) > blocked_part*self%unbound(i)) cycle
      self%mobility(i, :) = 0.0_wp
      self%mobility(:, i) = 0.0_wp
      self%by_impulse(:, i) = 0.0_wp
      self%balance%mobility(i, :) = 0.0_wp
      if (abs(self%balance%accelerations(i)) <= blocked_part*sum(abs(self%rows(:, i)*alone))) self%balance%accelerations(i) = 0.0_wp
    end do
  end subroutine leave_blocked

  !> Find rates and accelerations under frictions, as find_motion does without them. Fails where the forces do not exist.
  subroutine find_frictions(mechanism, plan, dynamics, state, work, self, contact, err)
    type(mechanism_type), intent(in) :: mechanism         !< the mechanism
    type(plan_type), intent(in) :: plan                   !< its plan
    type(dynamics_plan_type), intent(in) :: dynamics      !< its plan of dynamics
    type(state_type), intent(inout) :: state              !< the state, with placed frames and independent rates; gets the frictions
    type(lagrange_work_type), intent(inout) :: work       !< scratch; gets `accelerations`, and `forces` with frictions
    type(friction_motion_type), intent(inout) :: self     !< the frictions, with their modes
    class(contact_motion_type), allocatable, intent(inout) :: contact   !< contacts of links in their modes; not allocated: there are none
    type(error_type), allocatable, intent(out) :: err     !< allocated if it failed
    integer :: i
    logical :: solved

    call find_friction_balance(mechanism, plan, dynamics, state, work, self, contact, err)
    if (allocated(err)) return
    do i = 1, size(mechanism%frictions)
      associate (friction => mechanism%frictions(i))
        if (friction%is_smooth) self%modes%direction(i) = tanh(state%dq(friction%coordinate)/friction%transition)
      end associate
    end do
    call self%balance%solve(mechanism%frictions, self%modes, solved)
    if (.not. solved) then
      call raise(err, exit_integrator, failure_no_friction)
      err%failure%coordinates = pack(mechanism%frictions%coordinate, [(self%modes%slips(i), i=1, size(mechanism%frictions))])
      err%failure%t = state%t
      return
    end if
    state%friction = self%balance%force
    work%accelerations = self%accelerations + matmul(self%by_force, state%friction)
    work%forces = work%forces + matmul(self%rows, state%friction)
    if (self%touches) then
      contact%forces = self%pressed(:, :, 0)
      do i = 1, size(mechanism%frictions)
        contact%forces = contact%forces + state%friction(i)*self%pressed(:, :, i)
      end do
      call show_forces(self%touching, contact, state, work%forces)
    end if
    ! at an event a drive may still hold a pair that slips from now on
    associate (sticking => mechanism%frictions(self%modes%leader)%coordinate)
      do i = 1, size(self%held)
        if (dynamics%place_of(self%held(i)) > 0 .and. any(sticking == self%held(i))) &
          work%accelerations(dynamics%place_of(self%held(i))) = 0.0_wp
      end do
    end associate
  end subroutine find_frictions

  !> Find the power that each friction takes, in a state with its frictions and all rates.
  pure subroutine find_heat_rates(mechanism, state, self)
    type(mechanism_type), intent(in) :: mechanism          !< the mechanism
    type(state_type), intent(in) :: state                  !< the state
    type(friction_motion_type), intent(inout) :: self      !< gets the powers

    self%heat_rate = -state%friction*state%dq(mechanism%frictions%coordinate)
  end subroutine find_heat_rates
end module mech9_friction_motion
