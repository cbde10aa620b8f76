!> The search for the best design in a report.
module mech9_optimum_report
  use mech9_kinds, only: wp
  use mech9_json, only: json_type
  use mech9_model, only: model_type
  use mech9_synthesis, only: synthesis_type
  implicit none
  private
  public :: add_optimum

contains

  !> Add how many distinct designs there are, and the best one.
  subroutine add_optimum(json, model, synthesis)
    type(json_type), intent(inout) :: json                 !< the report
    type(model_type), intent(in) :: model                  !< the model
    type(synthesis_type), intent(in) :: synthesis          !< with its optima, best first
    real(wp), allocatable :: values(:)
    integer :: i

    call json%add('distinct', size(synthesis%optima))
    if (size(synthesis%optima) == 0) return
    values = synthesis%values_of(1)
    call json%begin_object('optimum')
    call json%add('value', synthesis%optima(1)%value)
    call json%begin_array('parameters')
    do i = 1, size(values)
      call json%begin_object()
      call json%add('name', model%parameters(i)%name)
      call json%add('value', values(i))
      call json%end_object()
    end do
    call json%end_array()
    call json%add('starts', synthesis%done)
    call json%add('reached', synthesis%optima(1)%starts)
    call json%end_object()
  end subroutine add_optimum
end module mech9_optimum_report
