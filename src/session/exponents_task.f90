!> The work of mech9d for --exponents: Lyapunov exponents, with a table of their running means.
module mech9_exponents_task
  use, intrinsic :: iso_fortran_env, only: error_unit
  use mech9_kinds, only: wp
  use mech9_error, only: error_type
  use mech9_text, only: string_type, to_text
  use mech9_json, only: json_type
  use mech9_heading, only: new_heading
  use mech9_answer_files, only: save_table
  use mech9_command_line, only: command_line_type
  use mech9_diagnostics, only: diagnostics_type
  use mech9_model, only: model_type
  use mech9_law_times, only: check_times_of_laws
  use mech9_exponents, only: exponents_found_type, find_exponents
  use mech9_exponents_words, only: print_exponents
  use mech9_exponents_report, only: add_exponents
  use mech9_report_parts, only: begin_report
  use mech9_signal_interruption, only: signal_interruption_type
  implicit none
  private
  public :: work_on_exponents

contains

  !> Find the exponents that --exponents asks for, and write them.
  subroutine work_on_exponents(options, model, diagnostics, reported)
    type(command_line_type), intent(in) :: options          !< the command line
    type(model_type), intent(in) :: model                   !< the model
    type(diagnostics_type), intent(inout) :: diagnostics    !< gets the errors
    logical, intent(out) :: reported                        !< the report is written
    type(exponents_found_type) :: found
    type(error_type), allocatable :: err, of_table

    reported = .false.
    call check_times_of_laws(model, .true., diagnostics)
    if (diagnostics%failed()) return
    call find_exponents(model, options%number('exponents', 1), found, err, signal_interruption_type())
    if (allocated(found%exponents)) then
      if (.not. options%has('quiet')) call print_exponents(error_unit, model, found)
      call write_table(options, model, found, of_table)
      if (allocated(of_table)) call diagnostics%add_error(of_table)
    end if
    if (allocated(err)) call diagnostics%add_error(err)
    if (.not. options%has('report')) return
    call save_report(options, model, found, diagnostics, err)
    reported = .not. allocated(err)
    if (allocated(err)) call diagnostics%add_error(err)
  end subroutine work_on_exponents

  !> Write the table of running means: to the file that is named, or to standard output.
  subroutine write_table(options, model, found, err)
    type(command_line_type), intent(in) :: options       !< the command line
    type(model_type), intent(in) :: model                !< the model
    type(exponents_found_type), intent(in) :: found      !< the exponents
    type(error_type), allocatable, intent(out) :: err    !< allocated if the file cannot be written
    type(string_type), dimension(size(found%exponents) + 1) :: names, units
    real(wp), allocatable :: rows(:, :)
    integer :: k

    if (options%table_of_answer() == '') return
    names(1)%text = 't'
    units(1)%text = 's'
    do k = 1, size(found%exponents)
      names(k + 1)%text = 'L'//to_text(k)
      units(k + 1)%text = '1/s'
    end do
    allocate (rows(size(names), size(found%times)))
    rows(1, :) = found%times
    rows(2:, :) = found%history
    call save_table(options%table_of_answer(), options, model, new_heading(model%mechanism%title, names, units), rows, err)
  end subroutine write_table

  !> Save the report.
  subroutine save_report(options, model, found, diagnostics, err)
    type(command_line_type), intent(in) :: options          !< the command line
    type(model_type), intent(in) :: model                   !< the model
    type(exponents_found_type), intent(in) :: found         !< the exponents; without them after a failure
    type(diagnostics_type), intent(in) :: diagnostics       !< the errors
    type(error_type), allocatable, intent(out) :: err       !< allocated if it failed
    type(json_type) :: json

    call begin_report(json, model, diagnostics, options%table_of_answer())
    call add_exponents(json, found)
    call json%end_object()
    call json%save(options%argument('report'), err)
  end subroutine save_report
end module mech9_exponents_task
