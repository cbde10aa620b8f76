!> The state of a conversation, and the parts common to all questions: words to the user, answers, and the file that
!> keeps these.
module mech9_conversation
  use, intrinsic :: iso_fortran_env, only: error_unit
  use mech9_program_kind, only: kinematics
  use mech9_error, only: error_type
  use mech9_text, only: string_type, lower
  use mech9_grammar, only: item_table
  use mech9_line_input, only: line_input_type, line_read
  use mech9_draft, only: draft_type
  use mech9_topics, only: topics
  use mech9_interview, only: interview_type
  use mech9_draft_file, only: save_draft, stem_of_title, free_draft_path
  use mech9_paragraph, only: print_paragraph
  use mech9_summary, only: print_summary
  implicit none
  private
  public :: conversation_type, going, left, cut_off, finished

  !> The states of a conversation: it goes on; the user left; its input ended or was interrupted; it came to its end.
  integer, parameter :: going = 0, left = 1, cut_off = 2, finished = 3

  type :: conversation_type
    integer :: program = kinematics
    type(interview_type) :: interview
    type(line_input_type) :: input
    integer :: state = going
    character(len=:), allocatable :: draft_path      !< file in which the answers are kept; empty: none yet
    character(len=:), allocatable :: stem            !< beginning of the names of files; empty: to be made from the title
    character(len=:), allocatable :: data_path       !< name of the finished data file; empty: to be made from the stem
    logical :: may_overwrite = .false.               !< the finished data file is the one being edited
    logical :: cannot_keep = .false.                 !< the draft could not be written, and the user was told
    integer :: topic = 0                             !< topic whose title was shown last
    logical :: opened(size(topics)) = .false.        !< topics that were explained already
    logical :: summed_up = .false.                   !< all answers were shown at the end
    logical :: shown = .false.                       !< the errors of a check were shown, and nothing was changed since
    character(len=:), allocatable :: doubted         !< answer that was refused unless it is given again; empty: none
    logical :: is_large = .false.                    !< lengths of many metres are meant
    character(len=:), allocatable :: heading         !< heading that was shown last
    logical :: told(size(item_table)) = .false.      !< names that were explained already
  contains
    procedure :: say
    procedure :: listen
    procedure :: keep
    procedure :: name_files
  end type conversation_type

contains

  !> Write a paragraph to the user, indented by two columns.
  subroutine say(self, text)
    class(conversation_type), intent(in) :: self  !< the conversation as it stands
    character(len=*), intent(in) :: text          !< words, any number of lines

    call print_paragraph(error_unit, text, 2)
  end subroutine say

  !> Show a prompt, and read an answer without the blanks around it. Answer `list` here. The words `quit` and the end of
  !> the input end the conversation, and the line is then of no use.
  subroutine listen(self, prompt, words, line)
    class(conversation_type), intent(inout) :: self     !< the conversation as it stands
    character(len=*), intent(in) :: prompt              !< text in front of the answer
    type(string_type), intent(in) :: words(:)           !< words that can be completed
    character(len=:), allocatable, intent(out) :: line  !< the answer, without blanks around it
    integer :: status

    do
      call self%input%read_line(prompt, words, line, status)
      if (status /= line_read) then
        self%state = cut_off
        return
      end if
      line = without_blanks(line)
      select case (lower(line(:min(len(line), 8))))
      case ('quit')
        self%state = left
        return
      case ('list')
        call print_summary(error_unit, self%interview%draft)
      case default
        return
      end select
    end do
  end subroutine listen

  !> A line without the blanks and tabs at both ends.
  pure function without_blanks(line) result(text)
    character(len=*), intent(in) :: line  !< a line as it was typed
    character(len=:), allocatable :: text
    character(len=*), parameter :: blanks = ' '//achar(9)

    text = line(verify(line//'x', blanks):verify(line, blanks, back=.true.))
  end function without_blanks

  !> Save the answers so far in the file of the draft. If that fails, tell the user once.
  subroutine keep(self)
    class(conversation_type), intent(inout) :: self  !< the conversation as it stands
    type(error_type), allocatable :: err

    if (self%cannot_keep) return
    if (self%draft_path == '' .and. says_nothing(self%interview%draft)) return
    call self%name_files()
    if (self%draft_path == '') then
      self%draft_path = free_draft_path(self%stem)
      call self%say('(What you type is kept in '//self%draft_path//'.)')
    end if
    associate (interview => self%interview)
      call save_draft(interview%draft, self%draft_path, interview%bookmark(), self%program, err)
    end associate
    if (.not. allocated(err)) return
    self%cannot_keep = .true.
    call self%say('What you type cannot be kept: '//err%message)
  end subroutine keep

  !> Whether a draft has no entries.
  pure logical function says_nothing(draft)
    type(draft_type), intent(in) :: draft  !< groups and names with their values as text
    integer :: i

    says_nothing = all([(size(draft%groups(i)%entries) == 0, i=1, size(draft%groups))])
  end function says_nothing

  !> Choose the names of files that are not given.
  subroutine name_files(self)
    class(conversation_type), intent(inout) :: self  !< the conversation as it stands

    if (self%stem == '') self%stem = stem_of_title(self%interview%draft%value('mechanism', 1, 'title'))
    if (self%data_path == '') self%data_path = self%stem//'.nml'
  end subroutine name_files
end module mech9_conversation
