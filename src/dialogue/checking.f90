!> Checks between the questions: of the structure as soon as it is complete, and of the geometry by assembling the
!> mechanism.
module mech9_checking
  use, intrinsic :: iso_fortran_env, only: error_unit
  use mech9_error, only: error_type, exit_structure
  use mech9_text, only: to_text
  use mech9_diagnostics, only: diagnostics_type
  use mech9_model, only: model_type
  use mech9_result_units, only: unit_of
  use mech9_plan, only: plan_type
  use mech9_state, only: state_type
  use mech9_mobility_report, only: mobility_report_type, report_mobility
  use mech9_start_path, only: start_way_type
  use mech9_explained_assembly, only: assemble_model
  use mech9_start_way_text, only: start_way_text
  use mech9_named_words, only: named_number
  use mech9_structure_text, only: print_mobility_report
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
    type(model_type) :: model
    type(plan_type) :: plan
    type(state_type) :: start
    type(start_way_type) :: way
    type(draft_text_type) :: written
    type(diagnostics_type) :: diagnostics
    type(fault_type), allocatable :: faults(:)
    type(error_type), allocatable :: err
    character(len=:), allocatable :: otherwise

    call read_draft(conversation%interview%draft, conversation%draft_path, conversation%program, model, written, diagnostics)
    otherwise = 'guesses'
    if (.not. diagnostics%failed()) then
      call assemble_model(model, plan, start, err, way)
      if (.not. allocated(err)) then
        call tell_start(conversation, model, plan, start)
        if (way%interrupted) call conversation%say('Note: '//start_way_text(model%mechanism, way)//'.')
        call conversation%interview%step()
        return
      end if
      if (err%code == exit_structure) otherwise = 'structure(1).cq'
      call diagnostics%add_error(err)
    end if
    call faults_of(diagnostics, written, faults)
    if (.not. conversation%shown) call conversation%say('The mechanism is not put together yet:')
    if (.not. conversation%shown) call show_faults(conversation, faults)
    call offer_correction(conversation, faults, otherwise)
  end subroutine judge_start

  !> Tell the user the positions of all coordinates, and the mobility by the geometry.
  subroutine tell_start(conversation, model, plan, start)
    class(conversation_type), intent(in) :: conversation  !< the conversation as it stands
    type(model_type), intent(in) :: model                 !< the model
    type(plan_type), intent(in) :: plan                   !< the plan of the mechanism
    type(state_type), intent(in) :: start                 !< position at the start
    type(mobility_report_type) :: report
    character(len=:), allocatable :: text
    integer :: k

    text = 'Put together at the start with'
    do k = 1, size(model%mechanism%pairs)
      text = text//' q'//named_number(model%mechanism%names%coordinates, k)//' = '//to_text(start%q(k)/unit_of(model%mechanism, k))
      if (k < size(model%mechanism%pairs)) text = text//','
    end do
    text = text//'.'
    if (size(plan%closures) > 0) text = text//' (Another assembly? Go back and give guesses.)'
    call conversation%say(text)
    call report_mobility(model%mechanism, plan, start, report)
    call print_mobility_report(error_unit, model%mechanism, plan, report)
  end subroutine tell_start
end module mech9_checking
