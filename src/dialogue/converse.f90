!> A whole conversation, from its first question to a run. It can be new, resumed, or about an existing data file.
module mech9_converse
  use, intrinsic :: iso_fortran_env, only: error_unit
  use mech9_program_kind, only: kinematics, program_names
  use mech9_error, only: exit_done, exit_usage, exit_interrupted
  use mech9_text, only: to_text
  use mech9_command_line, only: command_line_type
  use mech9_system, only: is_terminal, standard_input
  use mech9_diagnostics, only: diagnostics_type
  use mech9_draft, only: draft_type
  use mech9_draft_file, only: load_draft, path_without_draft, stem_of_path
  use mech9_interview, only: most_parts
  use mech9_conversation, only: conversation_type, going, left, finished
  use mech9_leading, only: lead
  use mech9_closing, only: close_conversation
  use mech9_running, only: run_by_turns
  implicit none
  private
  public :: converse

contains

  !> Hold a conversation, and carry out its decision to save or to run. `code` is the exit code of the program.
  subroutine converse(options, code)
    type(command_line_type), intent(in) :: options  !< options of the command line
    integer, intent(out) :: code                    !< exit code of the program
    type(conversation_type) :: conversation
    character(len=:), allocatable :: run_path

    call begin(conversation, options, code)
    if (code /= exit_done) return
    call conversation%input%open(program_names(options%program))
    run_path = ''
    do while (conversation%state == going)
      call lead(conversation)
      if (conversation%state == going) call close_conversation(conversation, run_path)
    end do
    if (run_path == '') then
      call take_leave(conversation, code)
    else
      call run_by_turns(conversation, options, run_path, code)
    end if
    call conversation%input%close()
  end subroutine converse

  !> Begin the conversation: read its files and greet the user.
  subroutine begin(conversation, options, code)
    type(conversation_type), intent(inout) :: conversation  !< the conversation as it stands
    type(command_line_type), intent(in) :: options          !< options of the command line
    integer, intent(out) :: code                            !< exit code of the program
    character(len=:), allocatable :: path, bookmark
    type(draft_type) :: draft
    type(diagnostics_type) :: diagnostics

    code = exit_done
    conversation%program = options%program
    conversation%draft_path = ''
    conversation%stem = ''
    conversation%data_path = ''
    conversation%heading = ''
    conversation%doubted = ''
    call draft%clear()
    bookmark = ''
    path = options%argument('resume')
    if (path == '') path = options%argument('edit')
    if (path == '') path = options%file
    if (path /= '') then
      call load_draft(path, most_parts, draft, bookmark, diagnostics)
      if (diagnostics%failed()) then
        call diagnostics%report(error_unit)
        code = diagnostics%code()
        return
      end if
      conversation%stem = stem_of_path(path)
      conversation%data_path = path_without_draft(path)
      conversation%may_overwrite = path == conversation%data_path
      ! a data file stays as it is until the end; the file of an interrupted conversation is continued
      if (bookmark /= '') conversation%draft_path = path
    end if
    call greet(conversation, options%program, path)
    if (draft%comments_left_out > 0) &
      call conversation%say('Comments inside and behind groups, '//to_text(draft%comments_left_out)// &
                            ' here, are not kept when it is saved.')
    call conversation%interview%start(options%program, draft)
    if (path /= '') then
      conversation%interview%at = size(conversation%interview%questions)
      call conversation%interview%open_at(bookmark)
    end if
  end subroutine begin

  !> Write the first words of a conversation.
  subroutine greet(conversation, program, path)
    type(conversation_type), intent(in) :: conversation  !< the conversation as it stands
    integer, intent(in) :: program                       !< kinematics or dynamics
    character(len=*), intent(in) :: path                 !< file that the conversation is about; empty: none
    character(len=*), parameter :: how = 'Enter takes what stands in brackets, ? explains, back returns, list shows all '// &
                                         'answers, quit leaves; what is typed is kept.'

    if (path /= '') then
      write (error_unit, '(a)') program_names(program)//': '//path//' in a conversation.'
    else if (program == kinematics) then
      write (error_unit, '(a)') program_names(program)//': kinematics of a mechanism, from your answers.'
    else
      write (error_unit, '(a)') program_names(program)//': dynamics of a mechanism, from your answers.'
    end if
    call conversation%say(how)
  end subroutine greet

  !> Write the last words of a conversation that does not end with a run, and find its exit code.
  subroutine take_leave(conversation, code)
    type(conversation_type), intent(inout) :: conversation  !< the conversation as it stands
    integer, intent(out) :: code                            !< exit code of the program
    character(len=:), allocatable :: missing

    code = exit_done
    if (conversation%state == finished) return
    if (conversation%state /= left) code = exit_interrupted
    if (conversation%draft_path /= '') then
      call conversation%keep()
      if (conversation%cannot_keep) then
        call conversation%say('What was typed could not be kept.')
      else
        call conversation%say('What was typed is kept in '//conversation%draft_path//'; '//program_names(conversation%program)// &
                              ' --resume '//conversation%draft_path//' goes on.')
      end if
    else if (code == exit_interrupted) then
      if (is_terminal(standard_input)) return
      missing = 'nothing was answered'
      if (conversation%data_path == '') missing = 'no data file is given and nothing was answered'
      write (error_unit, '(a)') program_names(conversation%program)//': '//missing//'; '//program_names(conversation%program)// &
        ' FILE runs a data file, '//program_names(conversation%program)//' --help tells more'
      code = exit_usage
    end if
  end subroutine take_leave
end module mech9_converse
