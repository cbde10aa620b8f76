!> Tables of answers that are no runs: all rows are written at once.
module mech9_answer_files
  use mech9_kinds, only: wp
  use mech9_error, only: error_type
  use mech9_command_line, only: command_line_type
  use mech9_data_file, only: data_file_type
  use mech9_heading, only: heading_type
  use mech9_table, only: table_type
  use mech9_version, only: name_and_version
  implicit none
  private
  public :: save_table

contains

  !> Save a table.
  subroutine save_table(path, options, given, heading, rows, err)
    character(len=*), intent(in) :: path                !< of the file; '-' is standard output, and where it is empty there is no table
    type(command_line_type), intent(in) :: options      !< the command line
    type(data_file_type), intent(in) :: given           !< the data file
    type(heading_type), intent(in) :: heading           !< of the columns
    real(wp), intent(in), contiguous :: rows(:, :)      !< (columns, rows)
    type(error_type), allocatable, intent(out) :: err   !< allocated if the file cannot be written
    type(error_type), allocatable :: at_close
    type(heading_type) :: shown
    type(table_type) :: table

    if (path == '') return
    shown = heading
    if (options%has('names')) call shown%call_by_names(given%model%mechanism%names)
    call table%open(path, shown, name_and_version(given%model%program), err)
    if (allocated(err)) return
    call table%write_rows(rows, err)
    call table%close(at_close)
    if (.not. allocated(err)) call move_alloc(at_close, err)
  end subroutine save_table
end module mech9_answer_files
