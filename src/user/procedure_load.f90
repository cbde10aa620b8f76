!> A load given by a user's procedure.
module mech9_procedure_load
  use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
  use mech9_kinds, only: wp
  use mech9_error, only: error_type, raise, exit_data, exit_integrator
  use mech9_text, only: to_text
  use mech9_differentiation, only: half_width, step_count, trial_step, length_along, best_slopes_type
  use mech9_call_fault, only: call_fault_type
  use mech9_motion_view, only: motion_view_type
  use mech9_force_sum, only: force_sum_type, new_force_sum
  use mech9_load, only: load_type
  use mech9_registered_procedures, only: registered_procedure_type
  use mech9_registered_calls, only: call_force
  use mech9_user_force, only: user_force
  implicit none
  private
  public :: procedure_load_type

  !> A load by a user's procedure.
  type, extends(load_type) :: procedure_load_type
    real(wp), allocatable :: parameters(:)   !< numbers for the user's procedure
    type(registered_procedure_type) :: registered   !< the procedure, where it is not linked
    integer :: n_links = huge(1)             !< links that the user knows, which are those of the data file
  contains
    procedure :: mark_links
    procedure :: mark_coordinates
    procedure :: may_follow_time
    procedure :: apply
    procedure :: potential
    procedure :: numbers
    procedure :: vary_by_numbers
  end type procedure_load_type

contains

  !> The procedure may use the motion of any link.
  pure subroutine mark_links(self, needed)
    class(procedure_load_type), intent(in) :: self   !< the procedure load
    logical, intent(inout) :: needed(:)              !< (N) all true afterwards

    needed = .true.
  end subroutine mark_links

  !> The procedure may use any coordinate.
  pure subroutine mark_coordinates(self, needed)
    class(procedure_load_type), intent(in) :: self   !< the procedure load
    logical, intent(inout) :: needed(:)              !< (M) all true afterwards

    needed = .true.
  end subroutine mark_coordinates

  !> The procedure may use the time.
  pure logical function may_follow_time(self)
    class(procedure_load_type), intent(in) :: self   !< the procedure load

    may_follow_time = .true.
  end function may_follow_time

  !> Call the procedure, which adds its forces. Fails where there is none, or its numbers are of no use.
  subroutine apply(self, state, sum, err)
    class(procedure_load_type), intent(in) :: self      !< the procedure load
    type(motion_view_type), intent(in) :: state         !< present motion of links and coordinates
    type(force_sum_type), intent(inout) :: sum          !< forces so far; the load is added
    type(error_type), allocatable, intent(out) :: err   !< allocated if it failed
    logical :: has_failed

    sum%fault%links = self%n_links
    if (associated(state%fault)) state%fault%links = self%n_links
    has_failed = .false.
    if (self%registered%exists()) then
      call call_force(self%registered, state, self%parameters, sum, has_failed)
    else
      call user_force(state%t, state, self%parameters, sum)
    end if
    if (associated(state%fault)) call must_exist(self, state%fault, err)
    if (.not. allocated(err)) call must_exist(self, sum%fault, err)
    if (allocated(err)) return
    if (sum%unanswered) then
      call raise(err, exit_data, 'a load asks for a user procedure, but none is linked; '// &
                 'see docs/how-to/user-procedures.md for how to write user_force and link or register it', self%place)
      return
    end if
    if (has_failed) then
      call raise(err, exit_data, 'the user procedure for forces says that it has no forces at t = '//to_text(state%t, 12)//' s', &
                 self%place)
      return
    end if
    if (.not. (all(ieee_is_finite(sum%force)) .and. all(ieee_is_finite(sum%torque)) .and. &
               all(ieee_is_finite(sum%generalized)))) &
      call raise(err, exit_integrator, 'the user procedure for forces gives numbers that are not finite at t = '// &
                 to_text(state%t, 12)//' s', self%place)
  end subroutine apply

  !> Fails where the procedure gave a number that no link or coordinate has.
  pure subroutine must_exist(self, fault, err)
    class(procedure_load_type), intent(in) :: self        !< the procedure load
    type(call_fault_type), intent(in) :: fault            !< a wrong number that was noted during the call, or none
    type(error_type), allocatable, intent(inout) :: err   !< allocated if it failed

    if (.not. fault%found) return
    call raise(err, exit_data, 'the user procedure for forces calls '//trim(fault%procedure)//' with '//trim(fault%counted)//' '// &
               to_text(fault%number)//', but the '//trim(fault%counted)//'s of this mechanism are 1 to '// &
               to_text(fault%greatest)//'; correct the number in the procedure', self%place)
  end subroutine must_exist

  !> Zero: the work of the procedure counts as put in.
  pure real(wp) function potential(self, state)
    class(procedure_load_type), intent(in) :: self   !< the procedure load
    type(motion_view_type), intent(in) :: state      !< present motion of links and coordinates

    potential = 0.0_wp
  end function potential

  !> The numbers that the procedure receives.
  pure subroutine numbers(self, values)
    class(procedure_load_type), intent(in) :: self      !< the procedure load
    real(wp), allocatable, intent(out) :: values(:)     !< numbers of the group &user

    values = self%parameters
  end subroutine numbers

  !> Add the derivatives of the forces by a parameter on which these numbers depend. The procedure knows nothing of derivatives:
  !> they come from differences over wide stencils, to near round-off. Fails where the procedure has no forces beside the present
  !> numbers.
  subroutine vary_by_numbers(self, change, factor, state, changes, err)
    class(procedure_load_type), intent(in) :: self      !< the procedure load
    real(wp), intent(in) :: change(:)                   !< derivatives of its numbers
    real(wp), intent(in) :: factor                      !< without meaning: these loads have no law
    type(motion_view_type), intent(in) :: state         !< present motion of links and coordinates
    type(force_sum_type), intent(inout) :: changes      !< derivatives of forces so far; those of the load are added
    type(error_type), allocatable, intent(out) :: err   !< allocated if it failed
    type(best_slopes_type) :: best
    real(wp) :: values(6*size(changes%force, 2) + size(changes%generalized), -half_width:half_width), h
    integer :: number, n
    logical :: good

    if (.not. any(abs(change) > 0.0_wp)) return
    do number = 1, step_count
      h = trial_step(number, length_along(self%parameters, change))
      call sample(self, change, h, state, changes, values, err)
      if (allocated(err)) cycle
      call best%offer(values, h, good)
      if (good) exit
    end do
    if (.not. allocated(best%slopes)) return
    if (allocated(err)) deallocate (err)
    n = size(changes%force, 2)
    changes%force = changes%force + reshape(best%slopes(:3*n), [3, n])
    changes%torque = changes%torque + reshape(best%slopes(3*n + 1:6*n), [3, n])
    changes%generalized = changes%generalized + best%slopes(6*n + 1:)
    changes%any_generalized = .true.
  end subroutine vary_by_numbers

  !> The forces of the procedure for numbers on both sides of the present ones. Fails where it has none.
  subroutine sample(load, change, h, state, changes, values, err)
    type(procedure_load_type), intent(in) :: load              !< the load
    real(wp), intent(in) :: change(:)                          !< derivatives of its numbers
    real(wp), intent(in) :: h                                  !< distance of neighbouring numbers, in units of the parameter
    type(motion_view_type), intent(in) :: state                !< present motion of links and coordinates
    type(force_sum_type), intent(in) :: changes                !< of the size of sums of forces
    real(wp), intent(out) :: values(:, -half_width:)           !< (forces, torques and generalized forces; numbers)
    type(error_type), allocatable, intent(out) :: err          !< allocated if it failed
    type(procedure_load_type) :: beside
    type(force_sum_type) :: sum
    integer :: i

    beside = load
    sum = new_force_sum(size(changes%force, 2), size(changes%generalized))
    do i = -half_width, half_width
      call sum%clear()
      beside%parameters = load%parameters + i*h*change
      call beside%apply(state, sum, err)
      if (allocated(err) .and. associated(state%fault)) state%fault%found = .false.
      if (allocated(err)) return
      values(:, i) = [sum%force, sum%torque, sum%generalized]
    end do
  end subroutine sample
end module mech9_procedure_load
