!> Questions and checks of a conversation, one after the other.
module mech9_leading
  use mech9_questions, only: check_structure, check_start, check_all
  use mech9_conversation, only: conversation_type, going
  use mech9_asking, only: ask, announce_topic
  use mech9_checking, only: check
  implicit none
  private
  public :: lead

contains

  !> Ask questions and make checks until every question is answered or the user leaves.
  subroutine lead(conversation)
    class(conversation_type), intent(inout) :: conversation  !< the conversation as it stands

    do while (conversation%state == going)
      associate (question => conversation%interview%due())
        select case (question%kind)
        case (check_all)
          return
        case (check_structure, check_start)
          call announce_topic(conversation, question)
          call check(conversation)
        case default
          conversation%shown = .false.
          call ask(conversation)
        end select
      end associate
    end do
  end subroutine lead
end module mech9_leading
