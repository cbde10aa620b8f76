!> Lines about parameters: their values, and the settings of the command line that decide about them.
module mech9_parameter_text
  use mech9_text, only: to_text
  use mech9_model, only: model_type
  implicit none
  private
  public :: print_parameters, print_parameter_notes

contains

  !> Write each parameter with its value and the numbers of the data file that it sets.
  subroutine print_parameters(unit, model)
    integer, intent(in) :: unit              !< Fortran unit to write to
    type(model_type), intent(in) :: model    !< the model
    integer :: i, j

    if (.not. allocated(model%parameters)) return
    if (size(model%parameters) > 0) write (unit, '(a)') 'parameters:'
    do i = 1, size(model%parameters)
      associate (parameter => model%parameters(i))
        write (unit, '(2x,4a)', advance='no') parameter%name, ' = ', to_text(parameter%value, 12), ' sets'
        do j = 1, size(parameter%targets)
          write (unit, '(2a)', advance='no') trim(merge(', ', '  ', j > 1)), ' '//trim(parameter%targets(j)%name)
        end do
        write (unit, '(a)') ''
      end associate
    end do
  end subroutine print_parameters

  !> Write a line for each parameter about which it and settings of the command line do not agree.
  subroutine print_parameter_notes(unit, model)
    integer, intent(in) :: unit              !< Fortran unit to write to
    type(model_type), intent(in) :: model    !< the model
    integer :: i

    if (.not. allocated(model%parameters)) return
    do i = 1, size(model%parameters)
      if (model%parameters(i)%note /= '') write (unit, '(2a)') 'note: ', model%parameters(i)%note
    end do
  end subroutine print_parameter_notes
end module mech9_parameter_text
