!> Branches over a parameter as the library's users find them.
module mech9_recorded_branches
  use mech9_kinds, only: wp
  use mech9_error, only: error_type
  use mech9_text, only: string_type, texts_of_one_length
  use mech9_json, only: json_type
  use mech9_columns, only: columns_type
  use mech9_model, only: model_type
  use mech9_simulation, only: interruption_type
  use mech9_explanation, only: explain
  use mech9_varied_document, only: varied_document_type
  use mech9_branches, only: branches_found_type, find_branches, columns_of_branches
  use mech9_branches_report, only: add_branches
  use mech9_data_file, only: data_file_type
  use mech9_checked_mechanism, only: checked_mechanism_type
  implicit none
  private
  public :: find_position_branches, list_columns, recorded_branches_type

  !> The branches over a parameter of a data file.
  type, extends(branches_found_type) :: recorded_branches_type
  contains
    procedure :: find
  end type recorded_branches_type

contains

  !> Find the branches of positions over a parameter: the rows of the table of --branch, and their part of a report. Fails as the option
  !> does; after an interruption there are the rows that were found before.
  subroutine find_position_branches(mechanism, program, parameter, names, units, rows, report, err, interruption)
    type(checked_mechanism_type), intent(in) :: mechanism            !< with the parameter
    integer, intent(in) :: program                                   !< kinematics or dynamics
    character(len=*), intent(in) :: parameter                        !< its name
    character(len=:), allocatable, intent(out) :: names(:)           !< (columns) of the table
    character(len=:), allocatable, intent(out) :: units(:)           !< (columns)
    real(wp), allocatable, intent(out) :: rows(:, :)                 !< (columns,rows)
    character(len=:), allocatable, intent(out) :: report             !< JSON; empty where there are no branches
    type(error_type), allocatable, intent(out) :: err                !< allocated if it failed
    class(interruption_type), intent(in), optional :: interruption   !< is asked whether the work shall stop
    type(model_type) :: model
    type(varied_document_type), target :: variable
    type(branches_found_type) :: found
    type(string_type), allocatable :: texts(:), of_units(:)
    type(json_type) :: json

    report = ''
    allocate (texts(0), of_units(0), rows(0, 0))
    call mechanism%take_request(program, model, err)
    if (.not. allocated(err)) then
      call mechanism%take_variable(program, variable)
      call find_branches(model, variable, parameter, found, err, interruption)
      if (found%count() > 0) then
        texts = found%columns%names(:found%columns%count)
        of_units = found%columns%units(:found%columns%count)
        rows = found%rows
        call json%begin_object()
        call add_branches(json, found)
        call json%end_object()
        call json%take_text(report)
      end if
    end if
    if (allocated(err)) call explain(err)
    call texts_of_one_length(texts, names)
    call texts_of_one_length(of_units, units)
    call mechanism%point_at(err)
  end subroutine find_position_branches

  !> Find the branches over a parameter of a data file. Fails as the option --branch does, with the branches that were found before.
  subroutine find(self, given, parameter, err, interruption)
    class(recorded_branches_type), intent(inout) :: self             !< new ones
    class(data_file_type), intent(inout), target :: given            !< the data file, with its variable model
    character(len=*), intent(in) :: parameter                        !< its name
    type(error_type), allocatable, intent(out) :: err                !< allocated if it failed
    class(interruption_type), intent(in), optional :: interruption   !< is asked whether the work shall stop

    call find_branches(given%model, given%variable, parameter, self%branches_found_type, err, interruption)
  end subroutine find

  !> List the names of all columns that the table of branches may have; none where there is no such parameter.
  subroutine list_columns(given, parameter, names)
    class(data_file_type), intent(in) :: given                 !< the data file
    character(len=*), intent(in) :: parameter                  !< name of the parameter
    type(string_type), allocatable, intent(out) :: names(:)    !< of the columns
    type(columns_type) :: columns
    integer :: i

    do i = 1, size(given%model%parameters)
      if (given%model%parameters(i)%name /= parameter) cycle
      columns = columns_of_branches(given%model, given%model%parameters(i), .true., .true.)
      names = columns%names(:columns%count)
      return
    end do
    allocate (names(0))
  end subroutine list_columns
end module mech9_recorded_branches
