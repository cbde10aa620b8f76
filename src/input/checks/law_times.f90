!> The check of laws of time at the times of a run, before it begins.
module mech9_law_times
  use mech9_error, only: error_type
  use mech9_law, only: law_type
  use mech9_model, only: model_type
  use mech9_diagnostics, only: diagnostics_type
  implicit none
  private
  public :: check_times_of_laws

contains

  !> Report the laws that have no value at the start or at the end of the run.
  subroutine check_times_of_laws(model, with_loads, diagnostics)
    type(model_type), intent(in) :: model                 !< the model
    logical, intent(in) :: with_loads                     !< loads and motors act in this run, too
    type(diagnostics_type), intent(inout) :: diagnostics  !< gets the errors
    integer :: i

    do i = 1, size(model%problem%drives)
      call check_law(model%problem%drives(i)%drive)
    end do
    if (.not. with_loads) return
    do i = 1, size(model%mechanism%loads)
      if (allocated(model%mechanism%loads(i)%load%law)) call check_law(model%mechanism%loads(i)%load%law)
    end do
    do i = 1, size(model%mechanism%motors)
      if (allocated(model%mechanism%motors(i)%motor%law)) call check_law(model%mechanism%motors(i)%motor%law)
    end do
  contains
    !> Report one law.
    subroutine check_law(law)
      class(law_type), intent(in) :: law   !< the law
      type(error_type), allocatable :: err

      call law%check_time(model%request%time%start, 'the run begins at', err)
      if (.not. allocated(err)) call law%check_time(model%request%time%end, 'the run goes on to', err)
      if (allocated(err)) call diagnostics%add_error(err)
    end subroutine check_law
  end subroutine check_times_of_laws
end module mech9_law_times
