!> The cause for which a free motion cannot begin or go on.
!>
!> A dead point of the drives differs from a position in which branches meet: other independent coordinates in place of driven ones
!> would serve there.
!>
!> In gimbal lock some coordinates can move together without moving any mass: the matrix of the coefficients of motion is
!> singular, although each coordinate has inertia. Its entries are divided by the roots of the diagonal ones, so that units do
!> not matter. Long chains have nearly singular matrices everywhere; so the least singular value counts against that of the
!> start.
!>
!> Short steps alone are no failure: an impact or a stiff spring needs them for some time. But a motion that does not leave them
!> while its closed chains are nearly singular, or while a ball joint is in gimbal lock in angles that cannot be replaced, does not leave
!> them at all: round-off over the distance from such a position decides about each step.
module mech9_stopped_motion
  use mech9_kinds, only: wp
  use mech9_simulation_tolerances, only: locked, locked_together, doubtful_conditioning, short_part, long_part, &
    many_short, nearly_singular, surely_singular, least_part, nearly_locked
  use mech9_error, only: error_type, raise, exit_singular, exit_integrator
  use mech9_ode_failures, only: failure_infinite_rate
  use mech9_dynamics_failures, only: failure_no_inertia, failure_singular_block
  use mech9_simulation_failures, only: failure_gimbal_lock, failure_singular_start_block, failure_driven_dead_point, &
    failure_loaded_lock, failure_singular_passing
  use mech9_masks, only: numbers_of
  use mech9_lapack, only: dgesvd
  use mech9_model, only: model_type
  use mech9_plan, only: plan_type
  use mech9_state, only: state_type
  use mech9_frame_motion, only: place_all
  use mech9_lagrange, only: find_equations
  use mech9_coordinate_choice, only: best_independent
  use mech9_integrated_vector, only: coordinate_of
  use mech9_motion_system, only: motion_system_type
  use mech9_held_rods, only: held_angle
  use mech9_rotation, only: cross
  use mech9_motion_coefficients, only: find_coefficients
  use mech9_integration_failures, only: failure_no_friction, failure_contact_paradox
  use mech9_friction_events, only: fail_in_paradox
  implicit none
  private
  public :: name_cause, name_cause_at_start, find_lock, stall_watch_type, name_singular_chains

  !> The steps of a motion.
  type :: stall_watch_type
    real(wp), private :: long = 0.0_wp      !< a long step of the motion [s]
    real(wp), private :: best = 0.0_wp      !< best conditioning of all steps
    integer, private :: n_short = 0         !< short steps in a row
  contains
    procedure :: note
    procedure :: forget
    procedure :: name_stall
  end type stall_watch_type

contains

  !> Note a step. `stalls` means that many steps in a row were short; they are counted anew then.
  pure subroutine note(self, step, duration, conditioning, stalls)
    class(stall_watch_type), intent(inout) :: self   !< the steps so far
    real(wp), intent(in) :: step                     !< length of the last one [s]
    real(wp), intent(in) :: duration                 !< of the whole motion [s]
    real(wp), intent(in) :: conditioning             !< of its closed chains at the end of the step
    logical, intent(out) :: stalls                   !< the cause should be looked for

    self%long = max(self%long, step, long_part*duration)
    self%best = max(self%best, conditioning)
    self%n_short = merge(self%n_short + 1, 0, step < short_part*self%long)
    stalls = self%n_short >= many_short
    if (stalls) self%n_short = 0
  end subroutine note

  !> Forget the short steps so far: they led to an event, behind which the motion goes on in another way.
  pure subroutine forget(self)
    class(stall_watch_type), intent(inout) :: self   !< the steps so far

    self%n_short = 0
  end subroutine forget

  !> Name the cause of many short steps; none is named where the steps may become longer again.
  subroutine name_stall(self, system, t, y, err)
    class(stall_watch_type), intent(in) :: self         !< the steps so far
    type(motion_system_type), intent(inout) :: system   !< the system; it is moved to the end of the last step
    real(wp), intent(in) :: t                           !< end of the last step [s]
    real(wp), intent(in) :: y(:)                        !< the vector there
    type(error_type), allocatable, intent(out) :: err   !< allocated where the motion cannot leave the position

    call system%move_to(t, y, err)
    if (allocated(err)) return
    call name_locked_joint(system, t, err)
    if (allocated(err)) return
    call name_singular_chains(system, t, max(surely_singular, min(nearly_singular, least_part*self%best)), err)
  end subroutine name_stall

  !> Fail where closed chains are nearly singular, by the worst conditioned block.
  subroutine name_singular_chains(system, t, least, err)
    type(motion_system_type), intent(inout) :: system         !< the system at the position
    real(wp), intent(in) :: t                                 !< the time [s]
    real(wp), intent(in) :: least                             !< conditioning below which they are
    type(error_type), allocatable, intent(inout) :: err       !< any; another one where chains are singular
    real(wp) :: conditioning(size(system%work%blocks))
    integer :: b

    if (size(conditioning) == 0) return
    conditioning = [(system%work%blocks(b)%equations%conditioning(), b=1, size(conditioning))]
    b = minloc(conditioning, dim=1)
    if (conditioning(b) > least) return
    call raise(err, exit_singular, failure_singular_passing)
    err%failure%chains = system%plan%blocks(b)%chains
    err%failure%coordinates = system%plan%blocks(b)%coordinates
    err%failure%t = t
  end subroutine name_singular_chains

  !> Fail where a ball joint is in gimbal lock in its present angles.
  subroutine name_locked_joint(system, t, err)
    type(motion_system_type), intent(in) :: system        !< the system at the position
    real(wp), intent(in) :: t                             !< the time [s]
    type(error_type), allocatable, intent(inout) :: err   !< stays as it is without gimbal lock
    logical :: loaded(system%plan%n_coordinates)
    integer :: j, k(3)

    if (.not. allocated(system%model%mechanism%structure%joints)) return
    do j = 1, size(system%model%mechanism%structure%joints)
      associate (joint => system%model%mechanism%structure%joints(j))
        if (joint%kind /= 'spherical') cycle
        k = joint%numbers(:3)
      end associate
      if (sine_between(system, k(1), k(3)) > nearly_locked) cycle
      loaded = .false.
      call system%model%mechanism%mark_loaded_coordinates(loaded)
      call raise(err, exit_singular, failure_loaded_lock)
      err%failure%coordinates = k
      err%failure%others = pack(k, loaded(k))
      err%failure%t = t
      return
    end do
  end subroutine name_locked_joint

  !> The sine of the angle between the axes of two coordinates.
  pure real(wp) function sine_between(system, a, b)
    type(motion_system_type), intent(in) :: system   !< the system, frames in place
    integer, intent(in) :: a                         !< number of a coordinate
    integer, intent(in) :: b                         !< number of the other one

    associate (axes => system%state%axis_w, plan => system%plan)
      sine_between = norm2(cross(axes(:, plan%step_of(a)), axes(:, plan%step_of(b))))
    end associate
  end function sine_between

  !> Complete the failure of an integration: the coordinate whose motion is not finite, gimbal lock, or singular chains, if that is its
  !> cause.
  subroutine name_cause(system, t, y, at_start, failure)
    type(motion_system_type), intent(inout) :: system             !< the system; it may be moved to the end of the last step
    real(wp), intent(in) :: t                                     !< end of the last step [s]
    real(wp), intent(in) :: y(:)                                  !< the vector there
    real(wp), intent(in) :: at_start(:, :)                        !< coefficients of motion at the start, lower triangle
    type(error_type), allocatable, intent(inout) :: failure       !< of the integration; perhaps another one afterwards
    type(error_type), allocatable :: err
    logical :: is_locked(size(system%plan%free))

    call name_coordinate(system, failure)
    if (is_of_kind(failure, failure_no_friction)) then
      call system%move_to(t, y, err)
      if (.not. allocated(err)) call fail_in_paradox(system, failure)
      return
    end if
    if (is_of_kind(failure, failure_contact_paradox)) then
      failure%code = exit_singular
      return
    end if
    call name_dead_point(system, t, y, failure)
    if (failure%code /= exit_integrator) return
    call system%move_to(t, y, err)
    if (allocated(err)) return
    call find_equations(system%model%mechanism, system%plan, system%dynamics, system%state, system%work, err)
    if (allocated(err)) return
    associate (places => system%plan%free_places)
      is_locked = find_lock(system%work%coefficients(places, places), at_start(places, places))
    end associate
    if (any(is_locked)) then
      call refuse_lock(pack(system%plan%free, is_locked), t, failure)
    else if (.not. is_of_kind(failure, failure_infinite_rate)) then
      call name_singular_chains(system, t, surely_singular, failure)
    end if
  end subroutine name_cause

  !> Complete the failure of a start: a singular block, or gimbal lock where it seems that a coordinate has no inertia. Open
  !> chains are in gimbal lock if they are not in another position.
  subroutine name_cause_at_start(model, plan, assembled, failure)
    type(model_type), intent(in) :: model                     !< the model
    type(plan_type), intent(in) :: plan                       !< its plan
    type(state_type), intent(in) :: assembled                 !< the start, with rates
    type(error_type), allocatable, intent(inout) :: failure   !< of the start; perhaps another one afterwards
    type(error_type), allocatable :: err
    type(state_type) :: elsewhere
    real(wp), allocatable :: at_start(:, :), others(:, :)
    logical :: is_locked(size(plan%free))
    integer :: i

    if (is_of_kind(failure, failure_singular_block)) failure%failure%kind = failure_singular_start_block
    if (.not. is_of_kind(failure, failure_no_inertia) .or. size(plan%closures) > 0) return
    call find_coefficients(model%mechanism, plan, assembled, at_start, err)
    if (allocated(err)) return
    elsewhere = assembled
    elsewhere%q = [(assembled%q(i) + plan%unit_of(i)*(0.4_wp + 0.3_wp*sin(real(i, wp))), i=1, plan%n_coordinates)]
    call place_all(plan, elsewhere, err)
    if (.not. allocated(err)) call find_coefficients(model%mechanism, plan, elsewhere, others, err)
    if (allocated(err)) return
    is_locked = find_lock(at_start(plan%free_places, plan%free_places), others(plan%free_places, plan%free_places))
    if (any(is_locked)) call refuse_lock(pack(plan%free, is_locked), assembled%t, failure)
  end subroutine name_cause_at_start

  !> Whether a failure is of a kind.
  pure logical function is_of_kind(failure, kind)
    type(error_type), intent(in) :: failure   !< the failure
    integer, intent(in) :: kind               !< one of the failure_ constants

    is_of_kind = .false.
    if (allocated(failure%failure)) is_of_kind = failure%failure%kind == kind
  end function is_of_kind

  !> Replace the failure of an integration by a dead point of the drives, if that is its cause: the worst conditioned block with the
  !> driven coordinates that would not be chosen if they were free. Angles of rods that the program holds are no drives of the user.
  subroutine name_dead_point(system, t, y, failure)
    type(motion_system_type), intent(inout) :: system         !< the system; it may be moved to the end of the last step
    real(wp), intent(in) :: t                                 !< end of the last step [s]
    real(wp), intent(in) :: y(:)                              !< the vector there
    type(error_type), allocatable, intent(inout) :: failure   !< of the integration; perhaps another one afterwards
    type(error_type), allocatable :: err
    logical :: chosen(system%plan%n_coordinates)
    real(wp) :: conditioning(size(system%work%blocks))
    integer, allocatable :: dead(:)
    integer :: b

    if (.not. any(system%plan%driven) .or. size(system%plan%closures) == 0) return
    if (failure%code /= exit_singular .and. failure%code /= exit_integrator) return
    call system%move_to(t, y, err)
    if (allocated(err)) return
    call best_independent(system%plan, system%state, chosen, without_drives=.true.)
    dead = numbers_of(system%plan%driven .and. .not. chosen .and. &
                      [(held_angle(system%model, [b]) == 0, b=1, system%plan%n_coordinates)])
    conditioning = [(system%work%blocks(b)%equations%conditioning(), b=1, size(conditioning))]
    b = minloc(conditioning, dim=1)
    if (size(dead) == 0 .or. conditioning(b) > doubtful_conditioning) return
    call raise(failure, exit_singular, failure_driven_dead_point)
    failure%failure%chains = system%plan%blocks(b)%chains
    failure%failure%coordinates = system%plan%blocks(b)%coordinates
    failure%failure%number = system%plan%blocks(b)%last_closure - system%plan%blocks(b)%first_closure + 1
    failure%failure%t = time_of_dead_point(system%state, system%plan%blocks(b)%coordinates)
    call system%move_to(failure%failure%t, y, err)
    failure%failure%others = dead
    failure%failure%values = reshape(system%state%q(dead)/system%plan%result_unit(dead), [size(dead), 1])
  end subroutine name_dead_point

  !> The time of the dead point t* that a block has nearly reached. Its coordinates approach their positions there as the root of
  !> t* - t, so that t* - t is half the rate over the acceleration.
  pure real(wp) function time_of_dead_point(state, coordinates) result(t)
    type(state_type), intent(in) :: state      !< near the dead point, with rates and accelerations
    integer, intent(in) :: coordinates(:)      !< the dependent coordinates of the block
    integer :: k

    k = coordinates(maxloc(abs(state%dq(coordinates)), dim=1))
    t = state%t
    if (abs(state%ddq(k)) > 0.0_wp) t = t + 0.5_wp*state%dq(k)/state%ddq(k)
  end function time_of_dead_point

  !> Replace a failure by gimbal lock.
  subroutine refuse_lock(coordinates, t, failure)
    integer, intent(in) :: coordinates(:)                     !< those that move together
    real(wp), intent(in) :: t                                 !< when [s]
    type(error_type), allocatable, intent(inout) :: failure   !< any; gimbal lock afterwards

    call raise(failure, exit_singular, failure_gimbal_lock)
    failure%failure%coordinates = coordinates
    failure%failure%t = t
  end subroutine refuse_lock

  !> Name the coordinate whose motion is not finite.
  pure subroutine name_coordinate(system, failure)
    type(motion_system_type), intent(in) :: system  !< the system
    type(error_type), intent(inout) :: failure      !< of an integration; gets the coordinate, if it is of this kind
    integer :: k

    if (.not. is_of_kind(failure, failure_infinite_rate)) return
    k = coordinate_of(system%plan, failure%failure%number)
    if (k < 0) k = system%model%mechanism%motors(-k)%motor%coordinate
    failure%failure%coordinates = [k]
  end subroutine name_coordinate

  !> The coordinates that can nearly move together without moving any mass; none where there is no gimbal lock.
  function find_lock(coefficients, at_start) result(is_locked)
    real(wp), intent(in) :: coefficients(:, :)   !< coefficients of motion, lower triangle
    real(wp), intent(in) :: at_start(:, :)       !< those of the start
    logical :: is_locked(size(coefficients, 1))
    real(wp) :: least, least_at_start, motion(size(coefficients, 1)), ignored(size(coefficients, 1))

    call find_least(coefficients, least, motion)
    call find_least(at_start, least_at_start, ignored)
    is_locked = least < locked*least_at_start .and. abs(motion) > locked_together*maxval(abs(motion))
  end function find_lock

  !> The least singular value of the coefficients of motion with ones in their diagonal, and its vector.
  subroutine find_least(coefficients, least, motion)
    real(wp), intent(in) :: coefficients(:, :)   !< lower triangle
    real(wp), intent(out) :: least               !< 0: singular, 1: best; 1 where a diagonal coefficient is not above zero
    real(wp), intent(out) :: motion(:)           !< the coordinates' parts in it, in units that give each the same inertia
    real(wp), dimension(size(motion), size(motion)) :: a, vectors
    real(wp) :: root(size(motion)), values(size(motion)), work(10*size(motion)), unused(1, 1)
    integer :: i, k, n, info

    n = size(motion)
    least = 1.0_wp
    motion = 0.0_wp
    do i = 1, n
      if (.not. coefficients(i, i) > 0.0_wp) return
      root(i) = sqrt(coefficients(i, i))
    end do
    do k = 1, n
      do i = k, n
        a(i, k) = coefficients(i, k)/(root(i)*root(k))
        a(k, i) = a(i, k)
      end do
    end do
    if (.not. all(abs(a) <= huge(a))) return
    call dgesvd('N', 'A', n, n, a, n, values, unused, 1, vectors, n, work, size(work), info)
    if (info /= 0) return
    least = values(n)
    motion = vectors(n, :)
  end subroutine find_least
end module mech9_stopped_motion
