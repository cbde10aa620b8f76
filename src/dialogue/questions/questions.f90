!> The questions of a conversation, made from the tables of topics, groups and names and from the answers so far.
!>
!> The list is made anew after each answer, since an answer may open or close other questions. A question is the same in
!> two lists if it has the same label.
module mech9_questions
  use mech9_program_kind, only: kinematics, dynamics, belongs_to
  use mech9_text, only: to_text
  use mech9_grammar, only: group_table, item_table, for_forces, rows_of_group, find_group_row
  use mech9_item_rows, only: takes_kind, find_item_rows
  use mech9_draft, only: draft_type
  use mech9_topics, only: topics, groups_of_topic, is_numbered, can_be_left_out, is_on_request
  use mech9_draft_joints, only: kind_in, has_joints
  use mech9_outline, only: outline_type, wants_forces
  use mech9_seldom, only: is_seldom, is_used
  use mech9_study_needs, only: is_for_study
  use mech9_unit_answer, only: is_unit_row
  use mech9_planar_links, only: may_be_planar, is_settled, is_placed
  implicit none
  private
  public :: question_type, make_questions, label_of, find_question, entry_name, is_open
  public :: ask_item, ask_seldom, ask_way, ask_guesses, ask_joints, ask_geometry, ask_units, check_structure, check_start, check_all

  !> The kinds of questions. Two are about a name of a group, and about the rarely used names of a group. Others are
  !> about the way in which the structure is given, joints with several freedoms, lengths or points of a planar mechanism,
  !> guesses of dependent coordinates, and the units of the data file together.
  !> Checks between the questions are kinds of their own.
  integer, parameter :: ask_item = 1, ask_seldom = 2, ask_way = 3, ask_guesses = 4, ask_joints = 5
  integer, parameter :: check_structure = 6, check_start = 7, check_all = 8, ask_geometry = 9, ask_units = 10

  !> One question.
  type :: question_type
    integer :: kind = ask_item
    integer :: topic = 0
    integer :: group_row = 0       !< row of the group in group_table
    integer :: place = 0           !< place of the group among those of its name; one more than there are: a new one
    integer :: row = 0             !< row of the name in item_table
    integer :: line = 0            !< row of the coincidence matrix; 0: none
    logical :: is_new = .false.    !< the answer begins a new group, or none
    logical :: on_request = .false.   !< the question is asked only where the user begins such a group by add, or names it
  end type question_type

  !> Names that give the place of a pair instead of the Denavit-Hartenberg parameters.
  character(len=*), parameter :: instead_of_dh = ' point axis zero moving_point moving_axis moving_zero '

contains

  !> Make all questions in order. The last one is the check of everything.
  pure subroutine make_questions(draft, outline, questions)
    type(draft_type), intent(in) :: draft                          !< groups and names with their values as text
    type(outline_type), intent(in) :: outline                      !< facts known beside the draft
    type(question_type), allocatable, intent(out) :: questions(:)  !< all questions in order
    integer :: count, topic

    allocate (questions(64))
    count = 0
    do topic = 1, size(topics)
      call ask_about_topic(draft, outline, topic, outline%program == dynamics, questions, count)
      if (topics(topic)%groups == 'output' .and. outline%program == kinematics .and. wants_forces(draft)) &
        call ask_about_masses(draft, outline, questions, count)
    end do
    call append(questions, count, question_type(kind=check_all, topic=size(topics)))
    questions = questions(:count)
  end subroutine make_questions

  !> Append the questions about the groups of a topic that the program uses.
  pure subroutine ask_about_topic(draft, outline, topic, with_masses, questions, count)
    type(draft_type), intent(in) :: draft                            !< groups and names with their values as text
    type(outline_type), intent(in) :: outline                        !< facts known beside the draft
    integer, intent(in) :: topic                                     !< number of the topic
    logical, intent(in) :: with_masses                               !< groups that serve for forces are used, too
    type(question_type), allocatable, intent(inout) :: questions(:)  !< questions in order; the first `count` are in use
    integer, intent(inout) :: count                                  !< number of questions in use
    integer, allocatable :: rows(:)
    integer :: i

    rows = groups_of_topic(topic)
    do i = 1, size(rows)
      associate (program => group_table(rows(i))%program)
        if (program == for_forces .and. .not. with_masses) cycle
        if (.not. (program == for_forces .or. belongs_to(program, outline%program))) cycle
      end associate
      call ask_about_group(draft, outline, topic, rows(i), questions, count)
    end do
  end subroutine ask_about_topic

  !> Append the questions about bodies, gravity and loads. In mech9k they come after the results, which need them only
  !> where these hold forces.
  pure subroutine ask_about_masses(draft, outline, questions, count)
    type(draft_type), intent(in) :: draft                            !< groups and names with their values as text
    type(outline_type), intent(in) :: outline                        !< facts known beside the draft
    type(question_type), allocatable, intent(inout) :: questions(:)  !< questions in order; the first `count` are in use
    integer, intent(inout) :: count                                  !< number of questions in use
    integer, allocatable :: rows(:)
    integer :: topic

    do topic = 1, size(topics)
      rows = groups_of_topic(topic)
      if (any(group_table(rows)%program == for_forces)) call ask_about_topic(draft, outline, topic, .true., questions, count)
    end do
  end subroutine ask_about_masses

  !> Append the questions about all groups of a name.
  pure subroutine ask_about_group(draft, outline, topic, group_row, questions, count)
    type(draft_type), intent(in) :: draft                            !< groups and names with their values as text
    type(outline_type), intent(in) :: outline                        !< facts known beside the draft
    integer, intent(in) :: topic                                     !< number of the topic
    integer, intent(in) :: group_row                                 !< row of the group in group_table
    type(question_type), allocatable, intent(inout) :: questions(:)  !< questions in order; the first `count` are in use
    integer, intent(inout) :: count                                  !< number of questions in use
    character(len=:), allocatable :: group
    integer, allocatable :: rows(:)
    integer :: place
    logical :: may_begin

    group = trim(group_table(group_row)%name)
    rows = rows_of_group(group)
    if (group == 'structure') then
      call ask_about_structure(draft, outline, topic, group_row, questions, count)
      return
    end if
    if (group == 'user' .and. .not. has_procedures(draft)) return
    if (group == 'cam' .and. .not. may_have_cams(draft)) return
    if (group == 'coupling' .and. draft%number('mechanism', 1, 'coordinates') == 1) return
    if (group == 'pair' .and. may_be_planar(draft, outline)) &
      call append(questions, count, question_type(kind=ask_geometry, topic=topic, group_row=group_row))
    if (group == 'initial') then
      if (outline%program == kinematics .or. .not. all(outline%independent)) &
        call append(questions, count, question_type(kind=ask_guesses, topic=topic, group_row=group_row))
    else if (asks_for_seldom(draft, outline, group_row)) then
      call append(questions, count, question_type(kind=ask_seldom, topic=topic, group_row=group_row))
    end if
    may_begin = can_be_left_out(group_row, outline%program)
    do place = 1, merge(draft%count_of(group), 1, group_table(group_row)%repeats .or. may_begin)
      call ask_about_one(draft, outline, question_type(topic=topic, group_row=group_row, place=place), rows, questions, count)
    end do
    if (may_begin .and. (group_table(group_row)%repeats .or. draft%count_of(group) == 0)) &
      call append(questions, count, question_type(topic=topic, group_row=group_row, place=draft%count_of(group) + 1, &
                                                  row=rows(1), is_new=.true., on_request=is_on_request(group_row)))
    if (group == 'initial') call append(questions, count, question_type(kind=check_start, topic=topic))
  end subroutine ask_about_group

  !> Whether there is a question which rarely used names of a group the user wants to give. A conversation does not begin with such
  !> names. Those of mechanism and time, and of pairs with lengths, can be changed by their names. Those of loads, motors, cams,
  !> couplings and of groups that are begun on request are asked for in groups that exist.
  pure logical function asks_for_seldom(draft, outline, group_row)
    type(draft_type), intent(in) :: draft      !< groups and names with their values as text
    type(outline_type), intent(in) :: outline  !< facts known beside the draft
    integer, intent(in) :: group_row           !< row of the group in group_table
    character(len=:), allocatable :: group

    group = trim(group_table(group_row)%name)
    asks_for_seldom = any(item_table(rows_of_group(group))%seldom) .and. all(group /= ['mechanism', 'time     ']) .and. &
                      .not. (group == 'pair' .and. outline%lengths)
    if (draft%count_of(group) > 0) return
    asks_for_seldom = asks_for_seldom .and. .not. (is_on_request(group_row) .or. &
                                                   any(group == ['load    ', 'motor   ', 'cam     ', 'coupling']))
  end function asks_for_seldom

  !> Append the questions about the names of one group.
  pure subroutine ask_about_one(draft, outline, template, rows, questions, count)
    type(draft_type), intent(in) :: draft                            !< groups and names with their values as text
    type(outline_type), intent(in) :: outline                        !< facts known beside the draft
    type(question_type), intent(in) :: template                      !< question with the topic and the group
    integer, intent(in) :: rows(:)                                   !< rows of the group's names in item_table
    type(question_type), allocatable, intent(inout) :: questions(:)  !< questions in order; the first `count` are in use
    integer, intent(inout) :: count                                  !< number of questions in use
    type(question_type) :: question
    integer, allocatable :: order(:)
    integer :: i

    order = rows
    if (group_table(template%group_row)%name == 'pair') order = rows_of_pair(rows)
    do i = 1, size(order)
      question = template
      question%row = order(i)
      if (.not. is_open(draft, outline, question)) cycle
      if (item_table(order(i))%group == 'mechanism' .and. item_table(order(i))%name == 'angle_unit') &
        call append(questions, count, question_type(kind=ask_units, topic=question%topic, group_row=question%group_row, &
                                                    place=1, row=order(i)))
      ! units are asked for together, and one by one in corrections
      question%on_request = is_unit_row(item_table(order(i)))
      call append(questions, count, question)
    end do
  end subroutine ask_about_one

  !> The rows of a pair, in an order that has its kind before its coordinates, and the Denavit-Hartenberg parameters before the
  !> names that they replace.
  pure function rows_of_pair(rows) result(order)
    integer, intent(in) :: rows(:)  !< rows of the names of a pair in item_table
    integer, allocatable :: order(:)
    integer :: i

    order = [pack(rows, item_table(rows)%name == 'links'), pack(rows, item_table(rows)%name == 'kind'), pack(rows, &
             [(.not. replaced(item_table(rows(i))%name) .and. all(item_table(rows(i))%name /= ['links', 'kind ', 'dh   ']), &
               i=1, size(rows))]), &
             pack(rows, item_table(rows)%name == 'dh'), &
             pack(rows, [(replaced(item_table(rows(i))%name), i=1, size(rows))])]
  end function rows_of_pair

  !> Whether the Denavit-Hartenberg parameters replace a name of a pair.
  pure logical function replaced(name)
    character(len=*), intent(in) :: name  !< the name, without a subscript

    replaced = index(instead_of_dh, ' '//trim(name)//' ') > 0
  end function replaced

  !> Whether there is a question about a name in its group as it stands.
  pure logical function is_open(draft, outline, question)
    type(draft_type), intent(in) :: draft        !< groups and names with their values as text
    type(outline_type), intent(in) :: outline    !< facts known beside the draft
    type(question_type), intent(in) :: question  !< the question
    integer :: group
    character(len=:), allocatable :: kind, name
    logical :: is_wanted

    name = trim(group_table(question%group_row)%name)
    associate (row => item_table(question%row))
      is_open = .false.
      if (.not. is_used(outline, row)) return
      is_wanted = .false.
      if (name == 'parameter') is_wanted = is_for_study(draft, question%place, trim(row%name))
      group = draft%find(name, question%place)
      kind = ''
      if (group > 0) kind = kind_in(draft, group)
      if (is_numbered(question%group_row) .and. row%name == 'coordinate' .and. &
          .not. can_be_left_out(question%group_row, outline%program)) return
      if (row%kinds /= '' .and. (kind == '' .or. .not. takes_kind(row, kind))) return
      if (name == 'pair') then
        is_wanted = is_placed(draft, outline, question%place, trim(row%name))
        if (row%name == 'links' .and. outline%way == 'pairs') return
        if (is_settled(draft, outline, question%place, trim(row%name)) .and. .not. outline%asked(question%row)) return
      end if
      if (is_seldom(outline, row) .and. .not. (outline%asked(question%row) .or. is_wanted)) return
      if (replaced(row%name) .and. draft%has(name, question%place, 'dh') &
          .and. .not. draft%has(name, question%place, trim(row%name))) return
      is_open = name /= 'initial' .or. is_open_at_start(draft, outline, question)
    end associate
  end function is_open

  !> Whether there is a question about a value at the start. There is for free coordinates in mech9d, and for guesses of
  !> dependent ones.
  pure logical function is_open_at_start(draft, outline, question) result(open)
    type(draft_type), intent(in) :: draft        !< groups and names with their values as text
    type(outline_type), intent(in) :: outline    !< facts known beside the draft
    type(question_type), intent(in) :: question  !< the question
    integer :: k

    open = .false.
    if (.not. outline%structure_known) return
    k = draft%number('initial', question%place, 'coordinate')
    if (k < 1 .or. k > size(outline%independent)) return
    if (outline%independent(k)) then
      open = outline%program == dynamics .and. .not. is_driven(draft, k)
    else
      open = item_table(question%row)%name /= 'velocity'
    end if
  end function is_open_at_start

  !> Whether the draft drives a coordinate.
  pure logical function is_driven(draft, k)
    type(draft_type), intent(in) :: draft  !< groups and names with their values as text
    integer, intent(in) :: k               !< number of the coordinate
    integer :: place

    is_driven = .false.
    do place = 1, draft%count_of('drive')
      is_driven = is_driven .or. draft%number('drive', place, 'coordinate') == k
    end do
  end function is_driven

  !> Whether the draft uses procedures of the user.
  pure logical function has_procedures(draft)
    type(draft_type), intent(in) :: draft  !< groups and names with their values as text
    integer :: i

    has_procedures = draft%count_of('user') > 0
    do i = 1, size(draft%groups)
      has_procedures = has_procedures .or. kind_in(draft, i) == 'user'
    end do
  end function has_procedures

  !> Whether there is a cam, or a drive with the motion laws of cam design.
  pure logical function may_have_cams(draft)
    type(draft_type), intent(in) :: draft  !< groups and names with their values as text
    integer :: i

    may_have_cams = draft%count_of('cam') > 0
    do i = 1, draft%count_of('drive')
      may_have_cams = may_have_cams .or. kind_in(draft, draft%find('drive', i)) == 'segments'
    end do
  end function may_have_cams

  !> Append the questions about the structure: the way in which it is given, its data, the independent coordinates and
  !> the check.
  pure subroutine ask_about_structure(draft, outline, topic, group_row, questions, count)
    type(draft_type), intent(in) :: draft                            !< groups and names with their values as text
    type(outline_type), intent(in) :: outline                        !< facts known beside the draft
    integer, intent(in) :: topic                                     !< number of the topic
    integer, intent(in) :: group_row                                 !< row of the group in group_table
    type(question_type), allocatable, intent(inout) :: questions(:)  !< questions in order; the first `count` are in use
    integer, intent(inout) :: count                                  !< number of questions in use
    type(question_type) :: question
    integer, allocatable :: rows(:)
    integer :: i, pair_row

    question = question_type(topic=topic, group_row=group_row, place=1)
    call append(questions, count, question_type(kind=ask_way, topic=topic, group_row=group_row))
    if (draft%number('mechanism', 1, 'coordinates') > 1) &
      call append(questions, count, question_type(kind=ask_joints, topic=topic, group_row=group_row))
    if (outline%way == 'pairs') then
      rows = find_item_rows('pair', 'links')
      pair_row = find_group_row('pair')
      do i = 1, draft%count_of('pair')
        call append(questions, count, question_type(topic=topic, group_row=pair_row, place=i, row=rows(1)))
      end do
    end if
    rows = rows_of_group('structure')
    do i = 1, size(rows)
      question%row = rows(i)
      if (item_table(rows(i))%name == 'c') then
        if (outline%way == 'matrix') call ask_about_matrix(draft, question, questions, count)
      else if (has_place_in(outline%way, item_table(rows(i))%name, has_joints(draft)) &
               .or. draft%has('structure', 1, trim(item_table(rows(i))%name))) then
        call append(questions, count, question)
      end if
    end do
    call append(questions, count, question_type(kind=check_structure, topic=topic))
  end subroutine ask_about_structure

  !> Whether a structural name belongs to the way in which the structure is given. The second set takes the place of cq unless
  !> there are joints with several freedoms; other names belong to every way.
  pure logical function has_place_in(way, name, joints)
    character(len=*), intent(in) :: way   !< way in which the structure is given, one of `ways` of mech9_outline
    character(len=*), intent(in) :: name  !< the name, without a subscript
    logical, intent(in) :: joints         !< there are joints with several freedoms

    select case (name)
    case ('cq')
      has_place_in = way /= 'vectors' .or. joints
    case ('nrg', 'nws', 'rdw', 'nrw')
      has_place_in = way == 'vectors'
    case default
      has_place_in = .true.
    end select
  end function has_place_in

  !> Append the questions about the rows of the coincidence matrix.
  pure subroutine ask_about_matrix(draft, template, questions, count)
    type(draft_type), intent(in) :: draft                            !< groups and names with their values as text
    type(question_type), intent(in) :: template                      !< question about the coincidence matrix, without a row
    type(question_type), allocatable, intent(inout) :: questions(:)  !< questions in order; the first `count` are in use
    integer, intent(inout) :: count                                  !< number of questions in use
    type(question_type) :: question
    integer :: i

    question = template
    do i = 1, draft%number('mechanism', 1, 'links')
      question%line = i
      call append(questions, count, question)
    end do
  end subroutine ask_about_matrix

  !> Append a question to a list that grows when it is full.
  pure subroutine append(questions, count, question)
    type(question_type), allocatable, intent(inout) :: questions(:)  !< questions in order; the first `count` are in use
    integer, intent(inout) :: count                                  !< number of questions in use
    type(question_type), intent(in) :: question                      !< the question
    type(question_type), allocatable :: longer(:)

    if (count == size(questions)) then
      allocate (longer(2*count))
      longer(:count) = questions
      call move_alloc(longer, questions)
    end if
    count = count + 1
    questions(count) = question
  end subroutine append

  !> The name under which the draft keeps the answer.
  pure function entry_name(question) result(name)
    type(question_type), intent(in) :: question  !< the question
    character(len=:), allocatable :: name

    name = trim(item_table(question%row)%name)
    if (question%line > 0) name = name//'('//to_text(question%line)//',:)'
  end function entry_name

  !> The label that distinguishes a question from all others, such as "pair(3).axis".
  pure function label_of(question) result(label)
    type(question_type), intent(in) :: question  !< the question
    character(len=:), allocatable :: label

    select case (question%kind)
    case (ask_item)
      label = trim(group_table(question%group_row)%name)//'('//to_text(question%place)//').'//entry_name(question)
    case (ask_seldom)
      label = 'more of '//trim(group_table(question%group_row)%name)
    case (ask_way)
      label = 'way of structure'
    case (ask_joints)
      label = 'joints'
    case (ask_geometry)
      label = 'geometry'
    case (ask_guesses)
      label = 'guesses'
    case (ask_units)
      label = 'units'
    case (check_structure)
      label = 'structure'
    case (check_start)
      label = 'start'
    case default
      label = 'all'
    end select
  end function label_of

  !> The number of the question with a label; 0 if there is none.
  pure integer function find_question(questions, label) result(number)
    type(question_type), intent(in) :: questions(:)  !< all questions in order
    character(len=*), intent(in) :: label            !< the label that is looked for

    do number = size(questions), 1, -1
      if (label_of(questions(number)) == label) return
    end do
  end function find_question
end module mech9_questions
