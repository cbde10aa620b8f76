!> The part of a report that has Lyapunov exponents, as JSON (docs/reference/results.md).
module mech9_exponents_report
  use mech9_json, only: json_type
  use mech9_exponents, only: exponents_found_type
  implicit none
  private
  public :: add_exponents

contains

  !> Add the exponents, largest first, their standard errors, what they changed by in the second half of the time, the mean divergence
  !> and their running means: [[t, first, second, ...], ...].
  subroutine add_exponents(json, found)
    type(json_type), intent(inout) :: json               !< the report, inside its object
    type(exponents_found_type), intent(in) :: found      !< the exponents; not found after a failure
    integer :: i, k

    if (.not. allocated(found%exponents)) return
    call json%add('exponents', found%exponents)
    call json%add('exponents_error', found%errors)
    call json%add('exponents_change', found%changes)
    if (found%knows_divergence) call json%add('divergence', found%divergence)
    call json%begin_array('exponents_history')
    do i = 1, size(found%times)
      call json%begin_array()
      call json%add(found%times(i))
      do k = 1, size(found%exponents)
        call json%add(found%history(k, i))
      end do
      call json%end_array()
    end do
    call json%end_array()
    call json%add('exponents_from', found%from)
    call json%add('exponents_to', found%to)
    call json%add('states', found%states)
    call json%add('orthonormalised', found%orthonormalised)
  end subroutine add_exponents
end module mech9_exponents_report
