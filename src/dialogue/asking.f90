!> Ask one question and read the answer.
module mech9_asking
  use, intrinsic :: iso_fortran_env, only: error_unit
  use mech9_text, only: string_type, lower
  use mech9_grammar, only: group_table, item_table
  use mech9_paragraph, only: print_paragraph
  use mech9_topics, only: topics
  use mech9_draft_joints, only: joints_text
  use mech9_questions, only: question_type, ask_item, ask_seldom, ask_way, ask_joints, ask_geometry, ask_units
  use mech9_planar_links, only: gives_lengths, is_placed
  use mech9_question_words, only: default_type, default_of, prompt_of, heading_of, words_for, seldom_names
  use mech9_unit_answer, only: prompt_of_units
  use mech9_question_help, only: gist_of, help_of, refusal_of_enter
  use mech9_conversation, only: conversation_type, going
  use mech9_taking, only: take_answer, keep_answer, move_on
  implicit none
  private
  public :: ask, announce_topic

  !> Answers that begin no further group, as an empty answer does.
  character(len=7), parameter :: no_more(3) = [character(len=7) :: 'none', 'no', 'no more']

contains

  !> Ask the current question, and check and note its answer.
  subroutine ask(conversation)
    class(conversation_type), intent(inout) :: conversation  !< the conversation as it stands
    type(question_type) :: question
    type(default_type) :: default
    type(string_type), allocatable :: words(:)
    character(len=:), allocatable :: line, prompt

    question = conversation%interview%due()
    call announce_topic(conversation, question)
    call introduce(conversation, question, default, prompt)
    call words_for(question, conversation%interview%draft, conversation%interview%outline, words)
    call conversation%listen(prompt, words, line)
    if (conversation%state /= going) return
    select case (lower(line(:min(len(line), 8))))
    case ('?', 'help')
      call conversation%say(help_of(question, conversation%interview%draft, conversation%interview%outline))
      return
    case ('back')
      call go_back(conversation)
      return
    case ('remove')
      call leave_out(conversation)
      return
    end select
    if (all(question%kind /= [ask_item, ask_units]) .and. lower(line(:min(len(line), 8))) == 'default') line = ''
    if (question%is_new .and. any(lower(line(:min(len(line), 8))) == no_more)) line = ''
    if (question%kind == ask_item .and. line == '') then
      call take_default(conversation, default)
    else
      call take_answer(conversation, line)
    end if
  end subroutine ask

  !> Go back to the question before. If the current one is the first of an incomplete group, leave out this group
  !> instead.
  subroutine go_back(conversation)
    class(conversation_type), intent(inout) :: conversation  !< the conversation as it stands
    logical :: done

    if (conversation%interview%is_begun()) then
      call leave_out(conversation)
      return
    end if
    call conversation%interview%back(done)
    conversation%heading = ''
    if (.not. done) call conversation%say('This is the first question.')
  end subroutine go_back

  !> Remove the load, point or body of the current question.
  subroutine leave_out(conversation)
    class(conversation_type), intent(inout) :: conversation  !< the conversation as it stands
    type(question_type) :: question
    character(len=:), allocatable :: name
    logical :: done

    associate (interview => conversation%interview)
      question = interview%due()
      name = heading_of(question, interview%draft)
      if (name == '') name = 'The group &'//trim(group_table(question%group_row)%name)
      call interview%leave_out(done)
    end associate
    conversation%heading = ''
    if (done) then
      call conversation%keep()
      call conversation%say(name//' is left out.')
    else
      call conversation%say('Nothing can be left out here; a body, a load, a motor or a point can, while it is asked about.')
    end if
  end subroutine leave_out

  !> Show the title of a topic where the topic begins.
  subroutine announce_topic(conversation, question)
    class(conversation_type), intent(inout) :: conversation  !< the conversation as it stands
    type(question_type), intent(in) :: question              !< the question

    if (question%topic == conversation%topic) return
    conversation%topic = question%topic
    conversation%heading = ''
    write (error_unit, '(/,a)') '-- '//trim(topics(question%topic)%title)//' --'
    ! the words about points come where these are wanted
    if (question%kind == ask_geometry .or. (topics(question%topic)%groups == 'pair' .and. conversation%interview%outline%lengths)) &
      return
    if (topics(question%topic)%opening /= '' .and. .not. conversation%opened(question%topic)) &
      call conversation%say(trim(topics(question%topic)%opening))
    conversation%opened(question%topic) = .true.
  end subroutine announce_topic

  !> Show the lines above the prompt, and form the prompt.
  subroutine introduce(conversation, question, default, prompt)
    class(conversation_type), intent(inout) :: conversation  !< the conversation as it stands
    type(question_type), intent(in) :: question              !< the question
    type(default_type), intent(out) :: default               !< the answer that Enter gives
    character(len=:), allocatable, intent(out) :: prompt     !< text in front of the answer
    character(len=:), allocatable :: heading
    logical :: explained

    associate (draft => conversation%interview%draft, outline => conversation%interview%outline)
      select case (question%kind)
      case (ask_item)
        heading = heading_of(question, draft)
        if (heading /= '' .and. heading /= conversation%heading) call conversation%say(heading)
        if (heading /= '') conversation%heading = heading
        explained = group_table(question%group_row)%name == 'pair'
        if (explained) explained = is_placed(draft, outline, question%place, trim(item_table(question%row)%name))
        if (.not. (explained .or. conversation%told(question%row))) call print_paragraph(error_unit, gist_of(question), 4)
        if (.not. explained) conversation%told(question%row) = .true.
        default = default_of(question, draft, outline, conversation%stem//'.dat')
        prompt = prompt_of(question, draft, outline, default)
      case (ask_seldom)
        prompt = '  asked for only if you want it: '//seldom_names(question, outline)//' [no]: '
        if (len(prompt) > 79) then
          call conversation%say('Asked for only if you want it: '//seldom_names(question, outline))
          prompt = '  which of them [no]: '
        end if
      case (ask_way)
        prompt = '  structure by pairs, matrix or vectors ['//trim(outline%way)//']: '
      case (ask_joints)
        heading = joints_text(draft)
        if (heading == '') heading = 'none'
        if (len(heading) > 40) heading = 'as now'
        prompt = '  joints with several freedoms ['//heading//']: '
      case (ask_geometry)
        prompt = '  by lengths of planar links, or by points [points]: '
        if (gives_lengths(draft, outline)) prompt = '  by lengths of planar links, or by points [lengths]: '
      case (ask_units)
        if (.not. conversation%told(question%row)) call print_paragraph(error_unit, gist_of(question), 4)
        conversation%told(question%row) = .true.
        prompt = '  '//prompt_of_units(draft)//': '
      case default
        prompt = '  guesses of the dependent coordinates, to choose an assembly [no]: '
        if (outline%guesses) prompt = prompt(:index(prompt, '[', back=.true.))//'yes]: '
      end select
    end associate
  end subroutine introduce

  !> Answer an empty line with the text in brackets.
  subroutine take_default(conversation, default)
    class(conversation_type), intent(inout) :: conversation  !< the conversation as it stands
    type(default_type), intent(in) :: default                !< the answer that Enter gives

    if (default%noted) then
      call keep_answer(conversation, default%text)
    else if (default%shown == '') then
      call conversation%say(refusal_of_enter(conversation%interview%due()))
    else
      call move_on(conversation)
    end if
  end subroutine take_default
end module mech9_asking
