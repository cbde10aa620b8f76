!> Checks between the questions: of the structure as soon as it is complete, and of the geometry by assembling the
!> mechanism.
module mech9_checking
  use, intrinsic :: iso_fortran_env, only: error_unit
  use mech9_error, only: error_type, exit_structure
  use mech9_text, only: to_text
  use mech9_data_file, only: data_file_type
  use mech9_result_units, only: unit_of
  use mech9_start_way_text, only: start_way_text
  use mech9_named_words, only: named_number
  use mech9_structure_text, only: print_mobility_of
  use mech9_draft_text, only: draft_text_type
  use mech9_draft_check, only: fault_type, read_draft, faults_of
  use mech9_questions, only: check_structure, question_type
  use mech9_structure_sketch, only: print_sketch
  use mech9_conversation, only: conversation_type
  use mech9_correcting, only: show_faults, offer_correction
  implicit none
  private
  public :: check

contains

  !> Carry out the current check. Go on to the next question if it finds no error; otherwise offer the user a
  !> correction.
  subroutine check(conversation)
    class(conversation_type), intent(inout) :: conversation  !< the conversation as it stands
    type(question_type) :: question

    question = conversation%interview%due()
    if (question%kind == check_structure) then
      call judge_structure(conversation)
    else
      call judge_start(conversation)
    end if
  end subroutine check

  !> Show the structure, or its errors.
  subroutine judge_structure(conversation)
    class(conversation_type), intent(inout) :: conversation  !< the conversation as it stands

    type(fault_type), allocatable :: faults(:)
    character(len=:), allocatable :: otherwise

    associate (interview => conversation%interview)
      otherwise = 'structure(1).cq'
      if (interview%outline%way == 'vectors') otherwise = 'structure(1).rdw'
      if (interview%outline%structure_known) then
        call print_sketch(error_unit, interview%structure, interview%partition)
        call interview%step()
      else
        if (.not. conversation%shown) call conversation%say('The structure is not complete or not right yet:')
        ! a correction makes other faults
        allocate (faults, source=interview%faults)
        if (.not. conversation%shown) call show_faults(conversation, faults)
        call offer_correction(conversation, faults, otherwise)
      end if
    end associate
  end subroutine judge_structure

  !> Assemble the mechanism at the start, and tell the user the result.
  subroutine judge_start(conversation)
    class(conversation_type), intent(inout) :: conversation  !< the conversation as it stands
    class(data_file_type), allocatable :: given
    type(draft_text_type) :: written
    type(fault_type), allocatable :: faults(:)
    type(error_type), allocatable :: err
    character(len=:), allocatable :: otherwise

    allocate (given)
    call read_draft(conversation%interview%draft, conversation%draft_path, conversation%program, given, written)
    otherwise = 'guesses'
    if (.not. given%failed()) then
      call given%assemble(err)
      if (.not. allocated(err)) then
        call tell_start(conversation, given)
        associate (way => given%run%motion%way)
          if (way%interrupted) call conversation%say('Note: '//start_way_text(given%model%mechanism, way)//'.')
        end associate
        call conversation%interview%step()
        return
      end if
      if (err%code == exit_structure) otherwise = 'structure(1).cq'
      call given%fail(err)
    end if
    call faults_of(given%diagnostics, written, faults)
    if (.not. conversation%shown) call conversation%say('The mechanism is not put together yet:')
    if (.not. conversation%shown) call show_faults(conversation, faults)
    call offer_correction(conversation, faults, otherwise)
  end subroutine judge_start

  !> Tell the user the positions of all coordinates, and the mobility by the geometry.
  subroutine tell_start(conversation, given)
    class(conversation_type), intent(in) :: conversation  !< the conversation as it stands
    type(data_file_type), intent(in) :: given             !< the mechanism, assembled
    character(len=:), allocatable :: text
    integer :: k

    text = 'Put together at the start with'
    associate (mechanism => given%model%mechanism, motion => given%run%motion)
      do k = 1, size(mechanism%pairs)
        text = text//' q'//named_number(mechanism%names%coordinates, k)//' = '//to_text(motion%start%q(k)/unit_of(mechanism, k))
        if (k < size(mechanism%pairs)) text = text//','
      end do
      text = text//'.'
      if (size(motion%plan%closures) > 0) text = text//' (Another assembly? Go back and give guesses.)'
      call conversation%say(text)
      call print_mobility_of(error_unit, mechanism, motion)
    end associate
  end subroutine tell_start
end module mech9_checking
