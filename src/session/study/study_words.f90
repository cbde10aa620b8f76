!> How a study went: a summary for the terminal, and a report for programs.
module mech9_study_words
  use mech9_kinds, only: wp
  use mech9_text, only: to_text
  use mech9_counted, only: counted
  use mech9_error, only: error_type
  use mech9_diagnostics, only: diagnostics_type
  use mech9_model, only: model_type
  use mech9_json, only: json_type
  use mech9_quantity_record, only: quantity_record_type
  use mech9_run_words, only: duration, begin_report
  use mech9_study_sums, only: study_sums_type
  implicit none
  private
  public :: print_study, save_study_report

contains

  !> Print how the study went: failed runs by code, and the quantities. For values that were drawn, means and deviations are told.
  subroutine print_study(unit, model, quantities, sums, time)
    integer, intent(in) :: unit                            !< Fortran unit to write to
    type(model_type), intent(in) :: model                  !< the model
    type(quantity_record_type), intent(in) :: quantities   !< with their columns
    type(study_sums_type), intent(in) :: sums              !< over the runs
    real(wp), intent(in) :: time                           !< time that the study took [s]
    integer :: i

    write (unit, '(a)') counted(sums%made(), 'run')//': '//duration(time)
    do i = 1, sums%n_codes
      write (unit, '(a)') counted(sums%failed(i), 'run')//' failed with exit code '//to_text(sums%codes(i))// &
        ', the first one is run '//to_text(sums%first_failed(i))
    end do
    if (sums%done > 0) call print_quantities(unit, model, quantities, sums)
  end subroutine print_study

  !> Print the range of each quantity, and for values that were drawn its mean and deviation.
  subroutine print_quantities(unit, model, quantities, sums)
    integer, intent(in) :: unit                            !< Fortran unit to write to
    type(model_type), intent(in) :: model                  !< the model
    type(quantity_record_type), intent(in) :: quantities   !< with their columns
    type(study_sums_type), intent(in) :: sums              !< over the runs
    real(wp), dimension(size(model%request%quantities)) :: deviation, of_mean, of_deviation
    character(len=:), allocatable :: unit_name
    integer :: i
    logical :: drawn

    drawn = all(model%request%study%kind /= ['grid', 'list'])
    deviation = sums%deviation()
    of_mean = sums%error_of_mean()
    of_deviation = sums%error_of_deviation()
    do i = 1, size(deviation)
      unit_name = quantities%unit_of(i)
      associate (name => model%request%quantities(i)%name)
        if (drawn) write (unit, '(a)') name//': mean '//to_text(sums%mean(i), 8)//' '//unit_name//' (standard error '// &
          to_text(of_mean(i), 2)//'), deviation '//to_text(deviation(i), 6)//' '//unit_name//' (standard error '// &
          to_text(of_deviation(i), 2)//')'
        write (unit, '(a)') name//': '//to_text(sums%low(i), 8)//' to '//to_text(sums%high(i), 8)//' '//unit_name
      end associate
    end do
  end subroutine print_quantities

  !> Write the report of a study as JSON: the runs, the failed ones by code, and the ranges of parameters and quantities.
  subroutine save_study_report(path, program_name, model, quantities, values, sums, table_path, diagnostics, err)
    character(len=*), intent(in) :: path                   !< of the report
    character(len=*), intent(in) :: program_name           !< mech9k or mech9d
    type(model_type), intent(in) :: model                  !< the model
    type(quantity_record_type), intent(in) :: quantities   !< with their columns
    type(study_sums_type), intent(in) :: values            !< of the parameters, over all runs
    type(study_sums_type), intent(in) :: sums              !< of the quantities, over the runs
    character(len=*), intent(in) :: table_path             !< path of the table; '-' is standard output; empty: no table
    type(diagnostics_type), intent(in) :: diagnostics      !< all errors, which determine the exit code
    type(error_type), allocatable, intent(out) :: err      !< allocated if it failed
    type(json_type) :: json
    integer :: i

    call begin_report(json, program_name, model, diagnostics, table_path)
    call json%add('study', trim(model%request%study%kind))
    call json%add('runs', sums%made())
    call json%begin_array('failed_runs')
    do i = 1, sums%n_codes
      call json%begin_object()
      call json%add('exit_code', sums%codes(i))
      call json%add('runs', sums%failed(i))
      call json%add('first_run', sums%first_failed(i))
      call json%end_object()
    end do
    call json%end_array()
    call json%begin_array('parameters')
    do i = 1, size(model%parameters)
      call json%begin_object()
      call json%add('name', model%parameters(i)%name)
      call add_range(json, values, i)
    end do
    call json%end_array()
    call json%begin_array('quantities')
    do i = 1, size(model%request%quantities)
      call json%begin_object()
      call json%add('name', model%request%quantities(i)%name)
      call json%add('unit', quantities%unit_of(i))
      call add_range(json, sums, i)
    end do
    call json%end_array()
    call json%end_object()
    call json%save(path, err)
  end subroutine save_study_report

  !> Add the range and the mean of one number to its object, and end the object. Without runs it has none.
  subroutine add_range(json, sums, i)
    type(json_type), intent(inout) :: json      !< the report, inside the object of the number
    type(study_sums_type), intent(in) :: sums   !< over the runs
    integer, intent(in) :: i                    !< place of the number in the sums

    if (sums%done > 0) then
      call json%add('least', sums%low(i))
      call json%add('greatest', sums%high(i))
      call json%add('mean', sums%mean(i))
    end if
    call json%end_object()
  end subroutine add_range
end module mech9_study_words
