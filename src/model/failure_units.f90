!> The unit in which messages tell the lengths of a failure, which numerics know in m.
module mech9_failure_units
  use mech9_error, only: error_type
  use mech9_mechanism, only: mechanism_type
  implicit none
  private
  public :: tell_in_units

contains

  !> Let the message of a failure tell its lengths in the unit of the data file. Failures whose kind has another name, or that have a
  !> message already, stay as they are.
  pure subroutine tell_in_units(err, mechanism)
    type(error_type), allocatable, intent(inout) :: err   !< the failure; not allocated: nothing failed
    type(mechanism_type), intent(in) :: mechanism         !< the mechanism

    if (.not. allocated(err)) return
    if (.not. allocated(err%failure)) return
    if (allocated(err%failure%name)) return
    err%failure%name = trim(mechanism%units%length_name)
  end subroutine tell_in_units
end module mech9_failure_units
