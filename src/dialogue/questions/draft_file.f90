!> Files of drafts, in which a conversation keeps the answers and from which it can be resumed.
module mech9_draft_file
  use mech9_program_kind, only: program_names
  use mech9_error, only: error_type, exit_data
  use mech9_text, only: to_text, lower
  use mech9_source, only: span_type
  use mech9_document, only: document_type
  use mech9_parser, only: read_document
  use mech9_diagnostics, only: diagnostics_type
  use mech9_text_file, only: replace_text
  use mech9_draft, only: draft_type, unquoted
  use mech9_draft_text, only: draft_text_type, write_draft
  use mech9_draft_source, only: draft_from_document
  implicit none
  private
  public :: save_draft, load_draft, delete_file, file_exists, stem_of_title, free_draft_path, path_without_draft
  public :: stem_of_path

  character(len=*), parameter :: draft_ending = '.draft.nml', data_ending = '.nml'
  character(len=*), parameter :: mark = '! goes on at: '
  integer, parameter :: longest_stem = 24

contains

  !> Write a draft as a data file. With a bookmark the conversation can be resumed there. The former content of the file
  !> is kept until everything is written.
  subroutine save_draft(draft, path, bookmark, program, err)
    type(draft_type), intent(in) :: draft              !< groups and names with their values as text
    character(len=*), intent(in) :: path               !< name of the file
    character(len=*), intent(in) :: bookmark           !< the place where the conversation goes on; empty: the data file is finished
    integer, intent(in) :: program                     !< kinematics or dynamics
    type(error_type), allocatable, intent(out) :: err  !< allocated if it failed
    type(draft_text_type) :: written
    character(len=:), allocatable :: remark

    remark = ''
    if (bookmark /= '') remark = mark//bookmark//' ('//program_names(program)//' --resume '//path//')'
    call write_draft(draft, remark, written)
    call replace_text(path, written%text, err)
  end subroutine save_draft

  !> Read a data file as a draft with its bookmark, which is empty if there is none. Errors go to the diagnostics.
  subroutine load_draft(path, most_parts, draft, bookmark, diagnostics)
    character(len=*), intent(in) :: path                    !< name of the file
    integer, intent(in) :: most_parts                       !< largest number of links or coordinates in a conversation
    type(draft_type), intent(out) :: draft                  !< groups and names with their values as text
    character(len=:), allocatable, intent(out) :: bookmark  !< the place where the conversation goes on; empty: none
    type(diagnostics_type), intent(inout) :: diagnostics    !< gets the errors
    type(document_type) :: document
    integer :: first, last

    bookmark = ''
    call read_document(path, document, diagnostics)
    call draft_from_document(document, draft)
    if (max(draft%number('mechanism', 1, 'links'), draft%number('mechanism', 1, 'coordinates'), &
            draft%count_of('pair')) > most_parts) &
      call diagnostics%add(span_type(), 'more than '//to_text(most_parts)//' links or coordinates are too many to speak '// &
                           'of one by one; change the data file with an editor', exit_data)
    first = index(document%source%text, achar(10)//mark, back=.true.)
    if (first == 0) return
    first = first + len(mark) + 1
    last = index(document%source%text(first:), ' (')
    if (last == 0) return
    bookmark = document%source%text(first:first + last - 2)
    draft%comments_left_out = draft%comments_left_out - 1
  end subroutine load_draft

  !> Delete a file if it is there.
  subroutine delete_file(path)
    character(len=*), intent(in) :: path  !< name of the file
    integer :: unit, status

    open (newunit=unit, file=path, status='old', iostat=status)
    if (status == 0) close (unit, status='delete', iostat=status)
  end subroutine delete_file

  !> Whether there is a file, or anything else, of this name.
  logical function file_exists(path)
    character(len=*), intent(in) :: path  !< name of the file

    inquire (file=path, exist=file_exists)
  end function file_exists

  !> A name for files, of letters, digits and underscores, from the beginning of a title.
  pure function stem_of_title(title) result(stem)
    character(len=*), intent(in) :: title  !< title as a data file writes it
    character(len=:), allocatable :: stem
    character(len=:), allocatable :: plain
    integer :: i

    plain = lower(unquoted(title))
    stem = ''
    do i = 1, len(plain)
      if (len(stem) >= longest_stem .or. (scan(plain(i:i), ':;,(') > 0 .and. stem /= '')) exit
      if (verify(plain(i:i), 'abcdefghijklmnopqrstuvwxyz0123456789') == 0) then
        stem = stem//plain(i:i)
      else if (stem /= '' .and. stem(max(len(stem), 1):) /= '_') then
        stem = stem//'_'
      end if
    end do
    do while (len(stem) > 1 .and. stem(max(len(stem), 1):) == '_')
      stem = stem(:len(stem) - 1)
    end do
    if (stem == '' .or. stem == '_') stem = 'mechanism'
  end function stem_of_title

  !> A path for a draft, of a file that is not there yet.
  function free_draft_path(stem) result(path)
    character(len=*), intent(in) :: stem  !< path without its ending
    character(len=:), allocatable :: path
    integer :: i

    path = stem//draft_ending
    i = 1
    do while (file_exists(path))
      i = i + 1
      path = stem//'_'//to_text(i)//draft_ending
    end do
  end function free_draft_path

  !> The path of the finished data file that belongs to the path of a draft.
  pure function path_without_draft(path) result(plain)
    character(len=*), intent(in) :: path  !< name of the file
    character(len=:), allocatable :: plain

    plain = path
    if (ends_with(path, draft_ending)) plain = path(:len(path) - len(draft_ending))//data_ending
  end function path_without_draft

  !> A path without the ending of data files.
  pure function stem_of_path(path) result(stem)
    character(len=*), intent(in) :: path  !< name of the file
    character(len=:), allocatable :: stem

    stem = path_without_draft(path)
    if (ends_with(stem, data_ending)) stem = stem(:len(stem) - len(data_ending))
  end function stem_of_path

  !> Whether a text has a given ending and something before it.
  pure logical function ends_with(text, ending)
    character(len=*), intent(in) :: text    !< any text
    character(len=*), intent(in) :: ending  !< the ending that is looked for

    ends_with = .false.
    if (len(text) > len(ending)) ends_with = text(len(text) - len(ending) + 1:) == ending
  end function ends_with
end module mech9_draft_file
