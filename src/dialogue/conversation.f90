!> A conversation as it stands, and how it is led: what is said and heard, kept in a file, and common to all questions.
module mech9_conversation
  use, intrinsic :: iso_fortran_env, only: error_unit
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

  !> How a conversation ended: it goes on; the user left; its input ended or was interrupted; it came to
  !> its end.
  integer, parameter :: going = 0, left = 1, cut_off = 2, finished = 3

  type :: conversation_type
    character(len=6) :: program_name = ''
    type(interview_type) :: interview
    type(line_input_type) :: input
    integer :: state = going
    character(len=:), allocatable :: draft_path      !< where what is typed is kept; empty: nothing is yet
    character(len=:), allocatable :: stem            !< of the names of files; empty: made from the title
    character(len=:), allocatable :: data_path       !< of the finished data file; empty: made from the stem
    logical :: may_overwrite = .false.               !< that file is the one being edited
    logical :: cannot_keep = .false.                 !< the draft could not be written, and this was told
    integer :: topic = 0                             !< whose title was shown last
    logical :: opened(size(topics)) = .false.        !< topics that were explained already
    logical :: summed_up = .false.                   !< all answers were shown at the end
    logical :: shown = .false.                       !< what a check found wrong was shown, and nothing was changed since
    character(len=:), allocatable :: doubted         !< the answer that was refused unless it is given again; empty: none
    character(len=:), allocatable :: heading         !< shown last
    logical :: told(size(item_table)) = .false.      !< names that were explained already
  contains
    procedure :: say
    procedure :: listen
    procedure :: keep
    procedure :: name_files
  end type conversation_type

contains

  !> Say something, a paragraph two columns in.
  subroutine say(self, text)
    class(conversation_type), intent(in) :: self  !< the conversation
    character(len=*), intent(in) :: text          !< words, any number of lines

    call print_paragraph(error_unit, text, 2)
  end subroutine say

  !> Ask, and hear an answer without blanks around it. `list` is answered here; `quit`, and an input that
  !> ends, end the conversation: the line is of no use then.
  subroutine listen(self, prompt, words, line)
    class(conversation_type), intent(inout) :: self     !< the conversation
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

  !> Blanks and tabs off both ends.
  pure function without_blanks(line) result(text)
    character(len=*), intent(in) :: line  !< a line as it was typed
    character(len=:), allocatable :: text
    character(len=*), parameter :: blanks = ' '//achar(9)

    text = line(verify(line//'x', blanks):verify(line, blanks, back=.true.))
  end function without_blanks

  !> Keep what was typed so far. Where that fails it is told once.
  subroutine keep(self)
    class(conversation_type), intent(inout) :: self  !< the conversation
    type(error_type), allocatable :: err

    if (self%cannot_keep) return
    if (self%draft_path == '' .and. says_nothing(self%interview%draft)) return
    call self%name_files()
    if (self%draft_path == '') then
      self%draft_path = free_draft_path(self%stem)
      call self%say('(What you type is kept in '//self%draft_path//'.)')
    end if
    associate (interview => self%interview)
      call save_draft(interview%draft, self%draft_path, interview%bookmark(), self%program_name, err)
    end associate
    if (.not. allocated(err)) return
    self%cannot_keep = .true.
    call self%say('What you type cannot be kept: '//err%message)
  end subroutine keep

  pure logical function says_nothing(draft)
    type(draft_type), intent(in) :: draft  !< groups and names with their values as text
    integer :: i

    says_nothing = all([(size(draft%groups(i)%entries) == 0, i=1, size(draft%groups))])
  end function says_nothing

  !> Settle the names of files.
  subroutine name_files(self)
    class(conversation_type), intent(inout) :: self  !< the conversation

    if (self%stem == '') self%stem = stem_of_title(self%interview%draft%value('mechanism', 1, 'title'))
    if (self%data_path == '') self%data_path = self%stem//'.nml'
  end subroutine name_files
end module mech9_conversation
