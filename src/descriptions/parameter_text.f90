!> Lines about parameters: their values, and the settings of the command line that decide about them.
module mech9_parameter_text
  use mech9_text, only: to_text
  use mech9_model, only: model_type
  use mech9_parameter, only: parameter_target_type
  implicit none
  private
  public :: print_parameters, print_parameter_notes

contains

  !> Write each parameter with its value and the numbers of the data file that it sets.
  subroutine print_parameters(unit, model)
    integer, intent(in) :: unit              !< Fortran unit to write to
    type(model_type), intent(in) :: model    !< the model
    integer :: i

    if (.not. allocated(model%parameters)) return
    if (size(model%parameters) > 0) write (unit, '(a)') 'parameters:'
    do i = 1, size(model%parameters)
      associate (parameter => model%parameters(i))
        write (unit, '(2x,3a)', advance='no') parameter%name, ' = ', to_text(parameter%value, 12)
        call print_targets(unit, parameter%targets)
      end associate
    end do
    if (.not. allocated(model%formulas)) return
    do i = 1, size(model%formulas)
      associate (formula => model%formulas(i))
        write (unit, '(2x,5a)', advance='no') formula%name, ' = ', formula%text, ' = ', to_text(formula%value, 12)
        call print_targets(unit, formula%targets)
      end associate
    end do
  end subroutine print_parameters

  !> Write the numbers that a parameter sets, and end the line.
  subroutine print_targets(unit, targets)
    integer, intent(in) :: unit                              !< Fortran unit to write to
    type(parameter_target_type), intent(in) :: targets(:)    !< the numbers
    integer :: j

    if (size(targets) > 0) write (unit, '(a)', advance='no') ' sets'
    do j = 1, size(targets)
      write (unit, '(2a)', advance='no') trim(merge(', ', '  ', j > 1)), ' '//trim(targets(j)%name)
    end do
    write (unit, '(a)') ''
  end subroutine print_targets

  !> Write a line for each parameter about which it and settings of the command line do not agree.
  subroutine print_parameter_notes(unit, model)
    integer, intent(in) :: unit              !< Fortran unit to write to
    type(model_type), intent(in) :: model    !< the model
    integer :: i

    if (.not. allocated(model%parameters)) return
    do i = 1, size(model%parameters)
      if (model%parameters(i)%note /= '') write (unit, '(2a)') 'note: ', model%parameters(i)%note
    end do
    if (.not. allocated(model%formulas)) return
    do i = 1, size(model%formulas)
      if (model%formulas(i)%note /= '') write (unit, '(2a)') 'note: ', model%formulas(i)%note
    end do
  end subroutine print_parameter_notes
end module mech9_parameter_text
