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

  type, extends(load_type) :: procedure_load_type
    real(wp), allocatable :: parameters(:)   !< handed to the user's procedure
  contains
    procedure :: mark_links
    procedure :: mark_coordinates
    procedure :: apply
    procedure :: potential
  end type procedure_load_type

contains

  !> The procedure may ask for any link.
  pure subroutine mark_links(self, needed)
    class(procedure_load_type), intent(in) :: self   !< the procedure load
    logical, intent(inout) :: needed(:)

    needed = .true.
  end subroutine mark_links

  !> Or for any coordinate.
  pure subroutine mark_coordinates(self, needed)
    class(procedure_load_type), intent(in) :: self   !< the procedure load
    logical, intent(inout) :: needed(:)

    needed = .true.
  end subroutine mark_coordinates

  subroutine apply(self, state, sum, err)
    class(procedure_load_type), intent(in) :: self   !< the procedure load
    type(motion_view_type), intent(in) :: state
    type(force_sum_type), intent(inout) :: sum
    type(error_type), allocatable, intent(out) :: err   !< allocated if it failed

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
    class(procedure_load_type), intent(in) :: self   !< the procedure load
    type(call_fault_type), intent(in) :: fault                !< what was noted during the call
    type(error_type), allocatable, intent(inout) :: err   !< allocated if it failed

    if (.not. fault%found) return
    call raise(err, exit_data, 'user_force calls '//trim(fault%procedure)//' with '//trim(fault%counted)//' '// &
               to_text(fault%number)//', but the '//trim(fault%counted)//'s of this mechanism are 1 to '// &
               to_text(fault%greatest)//'; correct the number in the procedure', self%place)
  end subroutine must_exist

  !> None is known: its work counts as put in.
  pure real(wp) function potential(self, state)
    class(procedure_load_type), intent(in) :: self   !< the procedure load
    type(motion_view_type), intent(in) :: state

    potential = 0.0_wp
  end function potential
end module mech9_procedure_load
