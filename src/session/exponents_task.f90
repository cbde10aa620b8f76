!> The work of mech9d for --exponents: Lyapunov exponents, with a table of their running means.
module mech9_exponents_task
  use, intrinsic :: iso_fortran_env, only: error_unit
  use mech9_kinds, only: wp
  use mech9_program_kind, only: program_names
  use mech9_error, only: error_type
  use mech9_text, only: string_type
  use mech9_heading, only: new_heading
  use mech9_answer_files, only: save_table
  use mech9_command_line, only: command_line_type
  use mech9_data_file, only: data_file_type
  use mech9_recorded_exponents, only: recorded_exponents_type
  use mech9_exponents_words, only: print_exponents
  use mech9_answer_report, only: save_exponents_report
  use mech9_signal_interruption, only: signal_interruption_type, answer_progress_type
  implicit none
  private
  public :: work_on_exponents

contains

  !> Find the exponents that --exponents asks for, and write them.
  subroutine work_on_exponents(options, given, reported)
    type(command_line_type), intent(in) :: options          !< the command line
    type(data_file_type), intent(inout) :: given            !< the data file; it gets the errors
    logical, intent(out) :: reported                        !< the report is written
    type(recorded_exponents_type) :: found
    type(answer_progress_type), target :: progress
    type(signal_interruption_type) :: interruption
    type(error_type), allocatable :: err, of_table

    reported = .false.
    call given%check_times(.true.)
    if (given%failed()) return
    interruption%progress => progress
    call progress%line%start(program_names(given%model%program), options%has('quiet'))
    call found%find(given, options%number('exponents', 1), err, interruption)
    call progress%line%finish()
    if (allocated(found%exponents)) then
      if (.not. options%has('quiet')) call print_exponents(error_unit, given%model, found%exponents_found_type)
      call write_table(options, given, found, of_table)
      call given%fail(of_table)
    end if
    call given%fail(err)
    if (.not. options%has('report')) return
    call save_exponents_report(options%argument('report'), given, options%table_of_answer(), found, err)
    reported = .not. allocated(err)
    call given%fail(err)
  end subroutine work_on_exponents

  !> Write the table of running means: to the file that is named, or to standard output.
  subroutine write_table(options, given, found, err)
    type(command_line_type), intent(in) :: options       !< the command line
    type(data_file_type), intent(in) :: given            !< the data file
    type(recorded_exponents_type), intent(in) :: found      !< the exponents
    type(error_type), allocatable, intent(out) :: err    !< allocated if the file cannot be written
    type(string_type), allocatable :: names(:), units(:)
    real(wp), allocatable :: rows(:, :)

    if (options%table_of_answer() == '') return
    call found%list_rows(names, units, rows)
    call save_table(options%table_of_answer(), options, given, new_heading(given%model%mechanism%title, names, units), rows, err)
  end subroutine write_table
end module mech9_exponents_task
