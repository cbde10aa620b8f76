!> The run at the end of a conversation, and what follows it: looking at results, changes, further runs.
module mech9_running
  use, intrinsic :: iso_fortran_env, only: error_unit
  use mech9_program_kind, only: program_names
  use mech9_error, only: error_type
  use mech9_text, only: string_type
  use mech9_grammar, only: words_of
  use mech9_command_line, only: command_line_type, parse_command_line
  use mech9_system, only: catch_interrupts, asked_to_end
  use mech9_kept_rows, only: kept_rows_type
  use mech9_rows_text, only: all_rows_text, digits_of_summary
  use mech9_kept_study, only: processes_type
  use mech9_session, only: run_file
  use mech9_conversation, only: conversation_type, going, finished
  use mech9_closing, only: write_data_file
  use mech9_leading, only: lead
  use mech9_after_run, only: look_back, over, changing, answering
  implicit none
  private
  public :: run_by_turns

contains

  !> Run a data file, and run it again as often as the user wants. `code` is that of the last run.
  subroutine run_by_turns(conversation, options, path, code)
    class(conversation_type), intent(inout) :: conversation  !< the conversation as it stands
    type(command_line_type), intent(in) :: options           !< options of the command line
    character(len=*), intent(in) :: path                     !< the data file of the conversation, or its draft
    integer, intent(out) :: code                             !< exit code of the last run
    type(kept_rows_type) :: kept, earlier, found
    type(processes_type) :: processes
    character(len=:), allocatable :: request
    integer :: next
    logical :: changed, saved_again

    changed = .false.
    saved_again = .false.
    do
      call run_file(options, path, processes, code, kept)
      found%count = 0
      if (asked_to_end()) exit
      ! Ctrl-C ends the run only, not the conversation
      call catch_interrupts()
      conversation%state = going
      do
        call look_back(conversation, kept, earlier, found, changed, next, request)
        if (next == answering) then
          call answer(conversation, path, changed, request, found)
          if (asked_to_end()) next = over
          if (next == over) exit
          call catch_interrupts()
          cycle
        end if
        if (next /= changing) exit
        changed = .true.
        call lead(conversation)
        if (conversation%state /= going) next = over
        if (next == over) exit
      end do
      if (next == over) exit
      saved_again = saved_again .or. changed
      call keep_changes(conversation, path, changed)
      if (kept%count > 0) call hand_over(kept, earlier)
    end do
    if (changed) call conversation%keep()
    call tell_what_is_kept(conversation, path, changed, saved_again)
    conversation%state = finished
  end subroutine run_by_turns

  !> Give an answer about the mechanism with the values that it has now. Changes since the last run are in the draft.
  subroutine answer(conversation, path, changed, request, found)
    class(conversation_type), intent(inout) :: conversation  !< the conversation as it stands
    character(len=*), intent(in) :: path                     !< name of the file that was run
    logical, intent(in) :: changed                           !< something was changed since the last run
    character(len=*), intent(in) :: request                  !< options of the command line
    type(kept_rows_type), intent(inout) :: found             !< gets the rows of the answer's table; none where it has none
    character(len=len(request)), allocatable :: options_given(:)
    type(string_type), allocatable :: words(:)
    type(command_line_type) :: options
    type(error_type), allocatable :: err
    type(processes_type) :: processes
    character(len=:), allocatable :: file
    integer :: i, code

    file = path
    if (changed) then
      call conversation%keep()
      file = conversation%draft_path
    end if
    options_given = words_of(request)
    allocate (words(size(options_given) + 1))
    do i = 1, size(options_given)
      words(i)%text = trim(options_given(i))
    end do
    words(size(words))%text = file
    call parse_command_line(words, conversation%program, options, err)
    if (allocated(err)) then
      call conversation%say(err%message)
    else
      found%count = 0
      call run_file(options, file, processes, code, found)
      if (found%count == 0) return
      write (error_unit, '(a)', advance='no') all_rows_text(found, digits_of_summary)
      call conversation%say('(to three digits; show gives all)')
    end if
  end subroutine answer

  !> Tell the user in which file the answers are, unless this was told when the data file was saved.
  subroutine tell_what_is_kept(conversation, path, changed, saved_again)
    class(conversation_type), intent(in) :: conversation  !< the conversation as it stands
    character(len=*), intent(in) :: path                  !< name of the file that was run
    logical, intent(in) :: changed                        !< something was changed since the last run
    logical, intent(in) :: saved_again                    !< changes were written to the data file before a further run
    character(len=:), allocatable :: draft, how

    draft = conversation%draft_path
    how = program_names(conversation%program)//' --resume '//draft//' goes on'
    if ((changed .or. path == draft) .and. conversation%cannot_keep) then
      call conversation%say('What was changed since the last run, or never saved, could not be kept.')
    else if (path == draft) then
      call conversation%say('No data file is saved; what was typed is kept in '//draft//', and '//how//' and can save it.')
    else if (changed) then
      call conversation%say('The changes since the last run are kept in '//draft//'; '//how//'.')
    else if (saved_again) then
      call conversation%say('The changes are saved in '//path//'.')
    end if
  end subroutine tell_what_is_kept

  !> Write the file that is run if something was changed.
  subroutine keep_changes(conversation, path, changed)
    class(conversation_type), intent(inout) :: conversation  !< the conversation as it stands
    character(len=*), intent(in) :: path                     !< name of the file that was run
    logical, intent(inout) :: changed                        !< there are changes that are not written yet
    type(error_type), allocatable :: err

    if (.not. changed) return
    if (path == conversation%draft_path) then
      call conversation%keep()
    else
      call write_data_file(conversation, path, err)
    end if
    changed = allocated(err)
    if (allocated(err)) call conversation%say(err%message)
  end subroutine keep_changes

  !> Make the results of the last run those of the run before.
  subroutine hand_over(kept, earlier)
    type(kept_rows_type), intent(inout) :: kept     !< results of the last run; empty afterwards
    type(kept_rows_type), intent(inout) :: earlier  !< receives them

    earlier%title = kept%title
    call move_alloc(kept%names, earlier%names)
    call move_alloc(kept%units, earlier%units)
    call move_alloc(kept%rows, earlier%rows)
    earlier%count = kept%count
    earlier%stride = kept%stride
    earlier%seen = kept%seen
    kept%count = 0
  end subroutine hand_over
end module mech9_running
