!> A load given by a user's procedure.
module mech9_procedure_load
  use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
  use mech9_kinds, only: wp
  use mech9_error, only: error_type, raise, exit_data, exit_integrator
  use mech9_text, only: to_text
  use mech9_call_fault, only: call_fault_type
  use mech9_motion_view, only: motion_view_type
  use mech9_force_sum, only: force_sum_type
  use mech9_load, only: load_type
  use mech9_user_force, only: user_force
  implicit none
  private
  public :: procedure_load_type

  !> A load by a user's procedure.
  type, extends(load_type) :: procedure_load_type
    real(wp), allocatable :: parameters(:)   !< numbers for the user's procedure
    integer :: n_links = huge(1)             !< links that the user knows, which are those of the data file
  contains
    procedure :: mark_links
    procedure :: mark_coordinates
    procedure :: apply
    procedure :: potential
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

  !> Call the procedure, which adds its forces. Fails where none is linked, or its numbers are of no use.
  subroutine apply(self, state, sum, err)
    class(procedure_load_type), intent(in) :: self      !< the procedure load
    type(motion_view_type), intent(in) :: state         !< present motion of links and coordinates
    type(force_sum_type), intent(inout) :: sum          !< forces so far; the load is added
    type(error_type), allocatable, intent(out) :: err   !< allocated if it failed

    sum%fault%links = self%n_links
    if (associated(state%fault)) state%fault%links = self%n_links
    call user_force(state%t, state, self%parameters, sum)
    if (associated(state%fault)) call must_exist(self, state%fault, err)
    if (.not. allocated(err)) call must_exist(self, sum%fault, err)
    if (allocated(err)) return
    if (sum%unanswered) then
      call raise(err, exit_data, 'a load asks for a user procedure, but none is linked; '// &
                 'see docs/user-procedures.md for how to write user_force and link it', self%place)
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
    call raise(err, exit_data, 'user_force calls '//trim(fault%procedure)//' with '//trim(fault%counted)//' '// &
               to_text(fault%number)//', but the '//trim(fault%counted)//'s of this mechanism are 1 to '// &
               to_text(fault%greatest)//'; correct the number in the procedure', self%place)
  end subroutine must_exist

  !> Zero: the work of the procedure counts as put in.
  pure real(wp) function potential(self, state)
    class(procedure_load_type), intent(in) :: self   !< the procedure load
    type(motion_view_type), intent(in) :: state      !< present motion of links and coordinates

    potential = 0.0_wp
  end function potential
end module mech9_procedure_load
