!> The end of a conversation: the summary, in which any answer can be changed, and then saving and running.
module mech9_closing
  use, intrinsic :: iso_fortran_env, only: error_unit
  use mech9_program_kind, only: program_names
  use mech9_error, only: error_type
  use mech9_text, only: string_type, lower
  use mech9_path, only: folder_of
  use mech9_same_file, only: same_file
  use mech9_diagnostics, only: printable
  use mech9_data_file, only: data_file_type
  use mech9_answer, only: yes_or_no, wants_quotes
  use mech9_draft, only: draft_type, unquoted
  use mech9_draft_text, only: draft_text_type
  use mech9_draft_check, only: fault_type, read_draft, faults_of
  use mech9_draft_file, only: save_draft, delete_file, file_exists
  use mech9_outline, only: drop_empty_guesses
  use mech9_summary, only: print_summary
  use mech9_conversation, only: conversation_type, going, finished
  use mech9_correcting, only: show_faults, change, correction_help, correction_words
  implicit none
  private
  public :: close_conversation, write_data_file

  character(len=7), parameter :: ends(4) = [character(len=7) :: 'both', 'save', 'run', 'neither']
  character(len=*), parameter :: ends_help = &
    'Answer save, run, both or neither. save writes your answers as a data file, whose name is asked for, and ends. run '// &
    'computes the motion, and what you typed stays in its draft. both writes the data file and then runs it. neither ends, '// &
    'and what you typed stays in its draft. back returns to the summary.'

contains

  !> Show all answers and the remaining errors, and carry out corrections. When there is no error left, let the user
  !> decide to save or to run.
  subroutine close_conversation(conversation, run_path)
    class(conversation_type), intent(inout) :: conversation   !< the conversation as it stands
    character(len=:), allocatable, intent(inout) :: run_path  !< data file to be run then; empty: none
    type(string_type), allocatable :: words(:)
    character(len=:), allocatable :: line
    logical :: done

    call show_all(conversation)
    words = correction_words('', conversation%interview%draft)
    call conversation%listen('  number of an answer to change, Enter if all is right: ', words, line)
    if (conversation%state /= going) return
    select case (lower(line(:min(len(line), 8))))
    case ('')
      call finish(conversation, run_path)
    case ('?', 'help')
      call conversation%say(correction_help)
    case ('back')
      conversation%summed_up = .false.
      call conversation%interview%back(done)
    case default
      call change(conversation, line)
    end select
  end subroutine close_conversation

  !> Show the errors of the answers, and all answers when the end is reached first.
  subroutine show_all(conversation)
    class(conversation_type), intent(inout) :: conversation  !< the conversation as it stands
    class(data_file_type), allocatable :: given
    type(draft_text_type) :: written
    type(fault_type), allocatable :: faults(:)

    allocate (given)
    associate (draft => conversation%interview%draft)
      if (.not. conversation%summed_up) then
        write (error_unit, '(/,a)') '-- Summary --'
        call print_summary(error_unit, draft)
      end if
      conversation%summed_up = .true.
      conversation%topic = 0
      call read_draft(draft, conversation%draft_path, conversation%program, given, written)
    end associate
    call faults_of(given%diagnostics, written, faults)
    if (size(faults) == 0) return
    call conversation%say('Not right yet:')
    call show_faults(conversation, faults)
  end subroutine show_all

  !> Ask the user to save, to run, both or neither, and save the data file.
  subroutine finish(conversation, run_path)
    class(conversation_type), intent(inout) :: conversation   !< the conversation as it stands
    character(len=:), allocatable, intent(inout) :: run_path  !< data file to be run then; empty: none
    type(string_type) :: words(6)
    character(len=:), allocatable :: line
    integer :: i
    logical :: saved

    do i = 1, size(ends)
      words(i)%text = trim(ends(i))
    end do
    words(5)%text = 'back'
    words(6)%text = 'quit'
    do
      call conversation%listen('  save, run, both or neither [both]: ', words, line)
      if (conversation%state /= going) return
      line = lower(line(:min(len(line), 20)))
      if (line == '') line = 'both'
      if (line == 'back') return
      if (any(ends == line)) exit
      call conversation%say(ends_help)
    end do
    saved = .false.
    if (line == 'both' .or. line == 'save') then
      call save(conversation, saved)
      if (.not. saved) return
    else
      call conversation%keep()
      if (conversation%draft_path /= '' .and. .not. conversation%cannot_keep) &
        call conversation%say('What was typed is kept in '//conversation%draft_path//'.')
    end if
    conversation%state = finished
    run_path = ''
    if (line == 'both') run_path = conversation%data_path
    if (line == 'run') run_path = conversation%draft_path
  end subroutine finish

  !> Write the data file under a name for which the user is asked. `saved` is false if the user went back or left.
  subroutine save(conversation, saved)
    class(conversation_type), intent(inout) :: conversation  !< the conversation as it stands
    logical, intent(out) :: saved                            !< the data file was written
    type(error_type), allocatable :: err
    type(string_type) :: words(2)
    character(len=:), allocatable :: path
    logical :: agreed

    saved = .false.
    words(1)%text = 'back'
    words(2)%text = 'quit'
    call conversation%name_files()
    do
      call conversation%listen('  data file ['//conversation%data_path//']: ', words, path)
      if (conversation%state /= going .or. path == 'back') return
      if (path == '?') then
        call conversation%say('The name of the file that will hold these data; '//program_names(conversation%program)// &
                              ' FILE runs it again.')
        cycle
      end if
      if (wants_quotes(path)) then
        call conversation%say('A name of a file is asked for; write one that has blanks in quotes.')
        cycle
      end if
      path = unquoted(path)
      if (path == '') path = conversation%data_path
      if (path /= printable(path)) then
        call conversation%say('This is not the name of a file.')
        cycle
      end if
      if (is_read(conversation%interview%draft, path)) then
        call conversation%say(path//' holds numbers that this data file reads; give another name.')
        cycle
      end if
      call agree_to_overwrite(conversation, path, agreed)
      if (conversation%state /= going) return
      if (.not. agreed) cycle
      call write_data_file(conversation, path, err)
      if (.not. allocated(err)) exit
      call conversation%say(err%message)
    end do
    saved = .true.
    conversation%data_path = path
    call conversation%say('Saved in '//path//'; '//program_names(conversation%program)//' '//path//' runs it again.')
  end subroutine save

  !> Whether a data file of this name would be written over a table, a curve or a list that it names.
  logical function is_read(draft, path)
    type(draft_type), intent(in) :: draft  !< groups and names with their values as text
    character(len=*), intent(in) :: path   !< name of the data file
    character(len=:), allocatable :: table
    character(len=9), parameter :: groups(8) = [character(len=9) :: 'drive', 'load', 'motor', 'contact', 'pair', 'coupling', &
                                                'study', 'objective']
    integer :: g, i

    is_read = .true.
    do g = 1, size(groups)
      do i = 1, draft%count_of(trim(groups(g)))
        table = unquoted(draft%value(trim(groups(g)), i, 'file'))
        if (table == '') cycle
        ! the data file names its tables from its own folder on
        if (table(1:1) /= '/') table = folder_of(path)//table
        if (same_file(table, path)) return
      end do
    end do
    is_read = .false.
  end function is_read

  !> Write all answers as a finished data file. Then delete the file of the draft.
  subroutine write_data_file(conversation, path, err)
    class(conversation_type), intent(in) :: conversation  !< the conversation as it stands
    character(len=*), intent(in) :: path                  !< name of the data file
    type(error_type), allocatable, intent(out) :: err     !< allocated if it failed
    type(draft_type) :: draft

    draft = conversation%interview%draft
    call drop_empty_guesses(draft)
    if (draft%head == '') draft%head = '! A data file of '//program_names(conversation%program)//', from a conversation.'//achar(10)
    call save_draft(draft, path, '', conversation%program, err)
    if (allocated(err)) return
    if (conversation%draft_path == '') return
    if (.not. same_file(conversation%draft_path, path)) call delete_file(conversation%draft_path)
  end subroutine write_data_file

  !> Ask before an existing file other than the one being edited is overwritten.
  subroutine agree_to_overwrite(conversation, path, agreed)
    class(conversation_type), intent(inout) :: conversation  !< the conversation as it stands
    character(len=*), intent(in) :: path                     !< name of the data file
    logical, intent(out) :: agreed                           !< the file can be written
    type(string_type) :: words(2)
    character(len=:), allocatable :: line

    agreed = .not. file_exists(path) .or. path == conversation%draft_path .or. &
             (conversation%may_overwrite .and. path == conversation%data_path)
    if (agreed) return
    words(1)%text = 'yes'
    words(2)%text = 'no'
    do
      call conversation%listen('  '//path//' exists; overwrite it [no]: ', words, line)
      if (conversation%state /= going) return
      if (line /= '?') exit
      call conversation%say('yes puts your answers in the place of what stands in this file; no asks for another name.')
    end do
    agreed = yes_or_no(line) == 'yes'
  end subroutine agree_to_overwrite
end module mech9_closing
