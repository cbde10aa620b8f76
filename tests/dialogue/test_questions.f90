!> Every name of the data file is asked for in the conversation of a program that uses it, whatever the table of
!> names holds; each question is told from the others by its label, and explained in whole sentences with an example in the
!> unit that is asked for. A group that was begun can be left out, and nothing is proposed that was meant for something else.
module test_questions
  use mech9_program_kind, only: kinematics, dynamics, program_names, belongs_to
  use mech9_text, only: string_type
  use mech9_grammar, only: group_table, item_table, find_group_row
  use mech9_item_rows, only: item_row_for_kind
  use mech9_compound_joint, only: compound_kinds
  use mech9_draft_joints, only: give_joints, joints_text
  use mech9_draft, only: draft_type
  use mech9_topics, only: topics, groups_of_topic, is_numbered
  use mech9_outline, only: ways
  use mech9_interview, only: interview_type
  use mech9_questions, only: question_type, label_of, find_question, ask_item, ask_seldom, ask_joints, &
                             check_structure, check_start, check_all
  use mech9_question_words, only: default_type, default_of, prompt_of, words_for, is_lacking
  use mech9_question_help, only: help_of
  use mech9_explanations, only: find_explanation, explanations
  use mech9_answer, only: read_answer
  use mech9_testing, only: tester_type
  implicit none
  private
  public :: run

contains

  !> Run the cases of this suite.
  subroutine run(tester)
    type(tester_type), intent(inout) :: tester   !< selects cases and counts their checks

    if (tester%runs('the_topics')) call the_topics(tester)
    if (tester%runs('all_names')) call all_names(tester)
    if (tester%runs('explained_names')) call explained_names(tester)
    if (tester%runs('units_of_examples')) call units_of_examples(tester)
    if (tester%runs('leaving_out')) call leaving_out(tester)
    if (tester%runs('studies')) call studies(tester)
    if (tester%runs('proposals')) call proposals(tester)
    if (tester%runs('dropped_drives')) call dropped_drives(tester)
    if (tester%runs('changed_joints')) call changed_joints(tester)
  end subroutine run

  !> Each group belongs to one topic.
  subroutine the_topics(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    integer :: times(size(group_table)), i

    times = 0
    do i = 1, size(topics)
      times(groups_of_topic(i)) = times(groups_of_topic(i)) + 1
    end do
    call tester%is_true(all(times == 1), 'each group belongs to one topic')
  end subroutine the_topics

  !> Four-bars given in each way, with groups of every kind there is.
  subroutine all_names(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(interview_type) :: interview
      character(len=10), parameter :: drives(5) = [character(len=10) :: 'polynomial', 'harmonic', 'table', 'segments', 'user']
    logical :: asked(size(item_table))
    integer :: program, way, drive, row

    asked = .false.
    do program = 1, size(program_names)
      do way = 1, size(ways)
        do drive = 1, size(drives)
          call begin(program, trim(ways(way)), trim(drives(drive)), interview)
          call tester%is_true(interview%outline%structure_known, trim(ways(way))//': the structure is known')
          call look_at(tester, interview, asked)
        end do
      end do
    end do
    do way = 1, size(compound_kinds)
      call begin_joint(trim(compound_kinds(way)), interview)
      call tester%is_true(interview%outline%structure_known, trim(compound_kinds(way))//': the structure is known')
      call look_at(tester, interview, asked)
    end do
    do row = 1, size(item_table)
      associate (item => item_table(row))
        if (item%name == 'coordinate' .and. is_numbered(find_group_row(item%group))) cycle   ! there is one for each
        call tester%is_true(asked(row), '&'//trim(item%group)//' '//trim(item%name)//' ('//trim(item%kinds)//') is asked for')
      end associate
    end do
  end subroutine all_names

  subroutine begin(program, way, drive, interview)
    integer, intent(in) :: program        !< mech9k or mech9d
    character(len=*), intent(in) :: way              !< in which the structure is given
    character(len=*), intent(in) :: drive            !< kind of the drive
    type(interview_type), intent(out) :: interview   !< about to ask its first question
    type(draft_type) :: draft
    character(len=10), parameter :: pairs(4) = [character(len=10) :: 'revolute', 'prismatic', 'helical', 'user']
    character(len=10), parameter :: loads(5) = [character(len=10) :: 'force', 'torque', 'spring', 'coordinate', 'user']
    character(len=6), parameter :: couplings(7) = [character(len=6) :: 'gear', 'rack', 'belt', 'screw', 'linear', 'table', 'user']
    character(len=8), parameter :: objectives(4) = [character(len=8) :: 'path', 'function', 'pose', 'quantity']
    character(len=12), parameter :: limits(4) = [character(len=12) :: 'quantity', 'assembles', 'crank', 'transmission']
    character(len=6), parameter :: links(4) = ['1, 2', '2, 3', '3, 4', '4, 1']
    character(len=1) :: number
    integer :: i

    call draft%clear()
    call draft%give('mechanism', 1, 'links', '4')
    call draft%give('mechanism', 1, 'coordinates', '4')
    call structure_in(way, draft)
    do i = 1, 4
      write (number, '(i1)') i
      call draft%give('pair', i, 'coordinate', number)
      call draft%give('pair', i, 'kind', ''''//trim(pairs(i))//'''')
      ! there are more kinds of pairs than pairs in a four-bar
      if (i == 2 .and. drive == 'table') call draft%give('pair', i, 'kind', '''path''')
      if (way == 'pairs') call draft%give('pair', i, 'links', trim(links(i)))
    end do
    if (program == kinematics) then
      call draft%give('drive', 1, 'coordinate', '1')
      call draft%give('drive', 1, 'kind', ''''//drive//'''')
      call draft%give('cam', 1, 'link', '2')
    end if
    do i = 1, size(couplings)
      call draft%give('coupling', i, 'kind', ''''//trim(couplings(i))//'''')
    end do
    do i = 1, size(loads)
      call draft%give('load', i, 'kind', ''''//trim(loads(i))//'''')
    end do
    if (program == dynamics) then
      call draft%give('motor', 1, 'coordinate', '1')
      call draft%give('motor', 1, 'kind', '''dc''')
      call draft%give('motor', 2, 'coordinate', '1')
      call draft%give('motor', 2, 'kind', '''pid''')
      call draft%give('link', 1, 'number', '2')
      call draft%give('stop', 1, 'coordinate', '1')
      call draft%give('friction', 1, 'coordinate', '1')
      call draft%give('contact', 1, 'point', '''P''')
      call draft%give('section', 1, 'coordinate', '1')
      call draft%give('exponents', 1, 'transient', '10')
      call draft%give('periodic', 1, 'starts', '5')
      call draft%give('branch', 1, 'parameter', '''crank''')
      if (drive /= 'user') call draft%give('motor', 1, 'law', ''''//drive//'''')
    end if
    ! drives and loads have the same laws of time
    if (drive /= 'user') call draft%give('load', 1, 'law', ''''//drive//'''')
    call draft%give('point', 1, 'name', '''P''')
    call draft%give('body', 1, 'link', '2')
    call draft%give('parameter', 1, 'name', '''crank''')
    call draft%give('quantity', 1, 'name', '''stroke''')
    if (program == kinematics) then
      do i = 1, size(objectives)
        call draft%give('objective', i, 'kind', ''''//trim(objectives(i))//'''')
      end do
      do i = 1, size(limits)
        call draft%give('limit', i, 'kind', ''''//trim(limits(i))//'''')
      end do
      call draft%give('optimum', 1, 'starts', '10')
    end if
    call draft%give('study', 1, 'kind', trim(merge('''list''  ', '''random''', drive == 'table')))
    call interview%start(program, draft)
    interview%outline%asked = .true.
    interview%outline%guesses = .true.
    call interview%refresh('')
  end subroutine begin

  !> A bar on a joint with several freedoms, all of which are independent.
  subroutine begin_joint(kind, interview)
    character(len=*), intent(in) :: kind             !< kind of the joint
    type(interview_type), intent(out) :: interview   !< gets all questions about the bar
    type(draft_type) :: draft
    character(len=:), allocatable :: coordinates

    call draft%clear()
    coordinates = '1, 2, 3, 4, 5, 6'
    coordinates = coordinates(:3*item_table(item_row_for_kind('pair', 'coordinates', kind))%low - 2)
    call draft%give('mechanism', 1, 'links', '2')
    call draft%give('mechanism', 1, 'coordinates', coordinates(len(coordinates):))
    call draft%give('structure', 1, 'cq', coordinates)
    call draft%give('pair', 1, 'coordinate', '1')
    call draft%give('pair', 1, 'kind', ''''//kind//'''')
    call draft%give('pair', 1, 'links', '1, 2')
    call interview%start(dynamics, draft)
    interview%outline%asked = .true.
    call interview%refresh('')
  end subroutine begin_joint

  !> The structure of a four-bar, driven at its first pair.
  subroutine structure_in(way, draft)
    character(len=*), intent(in) :: way        !< in which the structure is given
    type(draft_type), intent(inout) :: draft   !< gets the structure

    if (way == 'matrix') then
      call draft%give('structure', 1, 'c(1,:)', '0, 1, 0, 4')
      call draft%give('structure', 1, 'c(2,:)', '1, 0, 2, 0')
      call draft%give('structure', 1, 'c(3,:)', '0, 2, 0, 3')
      call draft%give('structure', 1, 'c(4,:)', '4, 0, 3, 0')
    else if (way == 'vectors') then
      call draft%give('structure', 1, 'nrg', '1, 2, 3, 4, 1')
      call draft%give('structure', 1, 'nws', '0, 1, 2, 3, 4')
      call draft%give('structure', 1, 'rdw', '1, 1, 0, 0, 0')
    end if
    if (way /= 'vectors') call draft%give('structure', 1, 'cq', '1')
  end subroutine structure_in

  !> Labels, prompts and help of all questions; the names that are asked for.
  subroutine look_at(tester, interview, asked)
    type(tester_type), intent(inout) :: tester      !< counts the checks
    type(interview_type), intent(in) :: interview   !< with all its questions
    logical, intent(inout) :: asked(:)              !< of each row of the grammar: a question asks for it
    type(string_type), allocatable :: words(:)
    type(question_type) :: question
    integer :: i

    do i = 1, size(interview%questions)
      question = interview%questions(i)
      call tester%is_true(find_question(interview%questions, label_of(question)) == i, &
                          label_of(question)//': the label belongs to one question')
      if (any(question%kind == [check_structure, check_start, check_all])) cycle
      call words_for(question, interview%draft, interview%outline, words)
      call tester%is_true(size(words) >= 4, label_of(question)//': there are words to complete an answer')
      if (question%kind == ask_seldom .and. group_table(question%group_row)%name == 'output') &
        call tester%is_true(index(help_of(question, interview%draft, interview%outline), 'view: axes of both pictures') > 0, &
                            'seldom names are explained one by one')
      if (question%kind == ask_joints) &
        call tester%is_true(index(help_of(question, interview%draft, interview%outline), 'spherical') > 0, &
                            'the help about joints with several freedoms names them')
      if (question%kind /= ask_item) cycle
      asked(question%row) = .true.
      associate (item => item_table(question%row))
        call tester%is_true(index(prompt_of(question, interview%draft, interview%outline, default_of(question, interview%draft, &
                                  interview%outline, 'x.dat')), trim(item%name)) > 0, &
                                  label_of(question)//': the prompt names the item')
        call tester%is_true(index(help_of(question, interview%draft, interview%outline), 'For example: ') > 0, &
                            label_of(question)//': the help gives an example')
        call tester%is_true(belongs_to(item%program, interview%outline%program), &
                            label_of(question)//': the question is used by the program that asks')
      end associate
    end do
  end subroutine look_at

  !> Each row of the grammar has an explanation, and each explanation a row; they are sentences, and their examples answers.
  subroutine explained_names(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    integer :: row, place, times(size(explanations))

    times = 0
    do row = 1, size(item_table)
      associate (item => item_table(row))
        place = find_explanation(trim(item%group), trim(item%name), trim(item%kinds))
        call tester%is_true(place > 0, '&'//trim(item%group)//' '//trim(item%name)//' ('//trim(item%kinds)// &
                            ') has an explanation in src/dialogue/questions/explanations.f90')
        if (place == 0) cycle
        times(place) = times(place) + 1
        call tester%is_true(ends_sentence(trim(explanations(place)%text)), &
                            trim(item%name)//': the explanation consists of whole sentences')
        call is_answer(tester, row, trim(explanations(place)%example))
        if (explanations(place)%degrees /= '') call is_answer(tester, row, trim(explanations(place)%degrees))
        if (explanations(place)%length /= '') call is_answer(tester, row, trim(explanations(place)%length))
      end associate
    end do
    call tester%is_true(all(times == 1), 'each explanation belongs to one name')
  end subroutine explained_names

  !> Whether a text begins with a capital and ends with a full stop.
  pure logical function ends_sentence(text)
    character(len=*), intent(in) :: text   !< of an explanation

    ends_sentence = text(1:1) >= 'A' .and. text(1:1) <= 'Z' .and. text(len(text):) == '.'
  end function ends_sentence

  !> The text before the parenthesis of an example can be typed.
  subroutine is_answer(tester, row, example)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    integer, intent(in) :: row                   !< in item_table
    character(len=*), intent(in) :: example      !< of an explanation
    character(len=:), allocatable :: text, problem

    call read_answer(item_table(row), example(:index(example//' (', ' (') - 1), text, problem)
    call tester%is_true(problem == '', trim(item_table(row)%group)//' '//trim(item_table(row)%name)//': '//example// &
                        ' is an answer')
  end subroutine is_answer

  !> A constant rate is explained in degrees, in rad and in m, as the coordinate that is asked about has it: a turn a second
  !> is 360 degrees or 2 pi rad in a second.
  subroutine units_of_examples(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks

    call tester%is_true(index(help_on('drive(1).coefficients', 'revolute', 'rad'), '6.2832 (begins at 0 rad') > 0, &
                        'the help of a polynomial of an angle in radians has its numbers in radians')
    call tester%is_true(index(help_on('drive(1).coefficients', 'revolute', 'deg'), '360 (begins at 0 deg') > 0, &
                        'the help of a polynomial of an angle in degrees has its numbers in degrees')
    call tester%is_true(index(help_on('drive(1).coefficients', 'prismatic', 'deg'), '(begins at 0.1 m') > 0, &
                        'the help of a polynomial of a length has its numbers in metres')
    call tester%is_true(index(help_on('load(4).damping', 'revolute', 'deg'), '(N m s)') > 0, &
                        'the help of a damping of an angle names N m s')
    call tester%is_true(index(help_on('load(4).damping', 'prismatic', 'deg'), '(N s/m)') > 0, &
                        'the help of a damping of a length names N s/m')
    call tester%is_true(index(help_on('load(4).rest', 'revolute', 'deg'), '30 (a twelfth of a turn)') > 0, &
                        'the help of a rest of a spring in degrees has its number in degrees')
  end subroutine units_of_examples

  !> The help on a question in a four-bar whose first pair is of this kind.
  function help_on(label, kind, angle_unit) result(text)
    character(len=*), intent(in) :: label        !< of the question
    character(len=*), intent(in) :: kind         !< of the first pair
    character(len=*), intent(in) :: angle_unit   !< rad or deg
    character(len=:), allocatable :: text
    type(interview_type) :: interview
    integer :: number

    if (label(:4) == 'load') then
      call begin(dynamics, 'pairs', 'polynomial', interview)
    else
      call begin(kinematics, 'pairs', 'polynomial', interview)
    end if
    call interview%draft%give('mechanism', 1, 'angle_unit', "'"//angle_unit//"'")
    call interview%draft%give('pair', 1, 'kind', "'"//kind//"'")
    if (label(:4) == 'load') call interview%draft%give('load', 4, 'coordinate', '1')
    call interview%refresh('')
    number = find_question(interview%questions, label)
    text = ''
    if (number > 0) text = help_of(interview%questions(number), interview%draft, interview%outline)
  end function help_on

  !> A load that was begun is left by going back before its first question, a complete one is not; any is by `leave_out`.
  subroutine leaving_out(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(interview_type) :: interview
    logical :: done

    call begin(dynamics, 'pairs', 'polynomial', interview)
    interview%at = find_question(interview%questions, 'load(1).kind')
    call tester%is_true(interview%is_begun(), 'a force without its link and its components is begun')
    interview%at = find_question(interview%questions, 'load(5).kind')
    call tester%is_true(.not. interview%is_begun(), 'a load of a user is complete')
    interview%at = find_question(interview%questions, 'load(6).kind')
    call interview%leave_out(done)
    call tester%is_true(.not. done, 'a load that is not begun cannot be left out')
    interview%at = find_question(interview%questions, 'pair(1).kind')
    call interview%leave_out(done)
    call tester%is_true(.not. done .and. interview%draft%count_of('pair') == 4, 'a pair cannot be left out')
    interview%at = find_question(interview%questions, 'load(5).kind')
    call interview%leave_out(done)
    call tester%is_true(done .and. interview%draft%count_of('load') == 4, 'a load of a user is left out')
    call tester%is_true(label_of(interview%due()) == 'load(5).kind' .and. interview%questions(interview%at)%is_new, &
                        'another load is asked for in the place of the one that was left out')
  end subroutine leaving_out

  !> A study is begun on request, once, and decides which names of the parameters must be given.
  subroutine studies(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(interview_type) :: interview
    integer :: number
    logical :: done

    call begin(dynamics, 'pairs', 'polynomial', interview)
    interview%outline%asked = .false.
    interview%at = find_question(interview%questions, 'study(1).kind')
    call tester%is_true(.not. interview%questions(interview%at)%is_new .and. &
                        find_question(interview%questions, 'study(2).kind') == 0, 'there is one study')
    call interview%leave_out(done)
    number = find_question(interview%questions, 'study(1).kind')
    call tester%is_true(done .and. interview%draft%count_of('study') == 0, 'a study is left out')
    call tester%is_true(interview%questions(number)%is_new .and. interview%questions(number)%on_request, &
                        'a study is begun on request')
    call needs(tester, interview, '''grid''', .false., [.true., .true., .true., .false.])
    call needs(tester, interview, '''latin''', .false., [.false., .false., .false., .true.])
    call needs(tester, interview, '''sobol''', .true., [.false., .true., .false., .false.])
    call needs(tester, interview, '''list''', .false., [.false., .false., .false., .false.])
  end subroutine studies

  !> Hold what a study needs of its parameter against what it should need.
  subroutine needs(tester, interview, kind, has_low, expected)
    type(tester_type), intent(inout) :: tester         !< counts the checks
    type(interview_type), intent(inout) :: interview   !< with a parameter
    character(len=*), intent(in) :: kind               !< of the study
    logical, intent(in) :: has_low                     !< the parameter has its least value
    logical, intent(in) :: expected(4)                 !< low, high, count and spread must be given
    character(len=6), parameter :: names(4) = [character(len=6) :: 'low', 'high', 'count', 'spread']
    integer :: i, at
    logical :: lacks

    call interview%draft%take_away('parameter', 1, 'low')
    if (has_low) call interview%draft%give('parameter', 1, 'low', '0.2')
    call interview%draft%give('study', 1, 'kind', kind)
    call interview%refresh('')
    do i = 1, size(names)
      at = find_question(interview%questions, 'parameter(1).'//trim(names(i)))
      lacks = at > 0
      if (lacks) lacks = is_lacking(interview%questions(at), interview%draft, interview%outline)
      call tester%is_true(lacks .eqv. expected(i), kind//': whether '//trim(names(i))//' is asked for')
    end do
  end subroutine needs

  !> After a slide neither its kind nor its axis is proposed; after a hinge its axis is, also over a slide between.
  !> Gravity has no proposal.
  subroutine proposals(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(interview_type) :: interview
    integer :: i

    call begin(dynamics, 'pairs', 'polynomial', interview)
    do i = 1, 4
      call interview%draft%take_away('pair', i, 'kind')
    end do
    call interview%draft%give('pair', 1, 'kind', "'revolute'")
    call interview%draft%give('pair', 1, 'axis', '0, 1, 0')
    call interview%draft%give('pair', 2, 'kind', "'prismatic'")
    call interview%refresh('')
    call tester%is_true(proposal(interview, 'pair(2).axis') == '', 'no axis is proposed for a slide that follows a hinge')
    call interview%draft%give('pair', 2, 'axis', '1, 0, 0')
    call interview%refresh('')
    call tester%is_true(proposal(interview, 'pair(3).kind') == "'revolute'", 'a hinge is proposed after a slide')
    call interview%draft%give('pair', 3, 'kind', "'revolute'")
    call interview%refresh('')
    call tester%is_true(proposal(interview, 'pair(3).axis') == '0, 1, 0', &
                        'the axis of the hinge before a slide is proposed after the slide')
    call tester%is_true(proposal(interview, 'gravity(1).acceleration') == '', 'no gravity is proposed')
    call interview%draft%give('body', 1, 'mass', '2.0')
    call interview%draft%give('body', 2, 'link', '3')
    call interview%refresh('')
    call tester%is_true(proposal(interview, 'body(2).mass') == '', 'the mass of the body before is not proposed')
  end subroutine proposals

  !> The answer that Enter gives to a question, as a data file writes it; empty: none.
  function proposal(interview, label) result(text)
    type(interview_type), intent(in) :: interview   !< at the question
    character(len=*), intent(in) :: label           !< of the question
    character(len=:), allocatable :: text
    type(default_type) :: default

    default = default_of(interview%questions(find_question(interview%questions, label)), interview%draft, &
                         interview%outline, 'x.dat')
    text = default%text
  end function proposal

  !> A drive of which something was entered is named as dropped when other coordinates become independent; others are not.
  subroutine dropped_drives(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(interview_type) :: interview

    call begin(kinematics, 'pairs', 'polynomial', interview)
    call interview%draft%give('structure', 1, 'cq', '1, 2')
    call interview%refresh('')
    call tester%is_true(interview%draft%count_of('drive') == 2, 'a drive of coordinate 2 is asked for')
    call interview%draft%give('structure', 1, 'cq', '1')
    call interview%refresh('')
    call tester%is_true(interview%draft%count_of('drive') == 1 .and. interview%dropped == '', &
                        'a drive without an answer is dropped without a word')
    call interview%draft%give('structure', 1, 'cq', '2')
    call interview%refresh('')
    call tester%is_true(interview%dropped == 'drive 1', 'a drive with a kind is named when it is dropped')
  end subroutine dropped_drives

  !> A joint takes the pairs of its coordinates; they come back when it becomes a hinge, and the structure is asked for first.
  subroutine changed_joints(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(interview_type) :: interview
    character(len=:), allocatable :: problem

    call begin(kinematics, 'pairs', 'polynomial', interview)
    call give_joints(interview%draft, '3 universal', problem)
    call tester%is_true(problem == '', 'pair 3 becomes a universal joint')
    call interview%refresh('')
    call tester%is_true(interview%draft%count_of('pair') == 3 .and. interview%dropped == 'pair 4', &
                        'pair 4 with its data is named when a joint takes its coordinate')
    call tester%is_true(interview%draft%value('pair', 3, 'coordinates') == '3, 4' .and. &
                        .not. interview%draft%has('pair', 3, 'coordinate'), 'the joint has the coordinates 3 and 4')
    call tester%is_true(joints_text(interview%draft) == '3 universal', 'the joint is listed by its number and kind')
    call give_joints(interview%draft, '3 spherical', problem)
    call tester%is_true(index(problem, '3 to 5') > 0, 'a joint cannot have more coordinates than there are')
    call give_joints(interview%draft, '2 universal, 3 cylindrical', problem)
    call tester%is_true(index(problem, 'another joint') > 0, 'two joints cannot have the same coordinate')
    call give_joints(interview%draft, '3', problem)
    call tester%is_true(index(problem, 'such as') > 0, 'a joint without a kind is refused')
    call interview%refresh('')
    call interview%draft%give('mechanism', 1, 'links', '3')
    call interview%draft%give('pair', 3, 'links', '3, 1')
    call interview%refresh('')
    call tester%is_true(interview%outline%structure_known, 'the structure with the joint is known')
    interview%at = find_question(interview%questions, 'pair(3).kind')
    call interview%note("'revolute'")
    call tester%is_true(interview%draft%count_of('pair') == 4 .and. interview%draft%value('pair', 3, 'coordinate') == '3' &
                        .and. .not. interview%draft%has('pair', 3, 'coordinates'), 'the hinge has one coordinate again')
    call interview%step()
    call tester%is_true(label_of(interview%due()) == 'pair(4).links', 'the links of the pair that came back are asked for')
  end subroutine changed_joints
end module test_questions
