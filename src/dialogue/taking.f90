!> Check answers to questions as the reader of data files does, and note them.
module mech9_taking
  use mech9_kinds, only: wp, radians_per_degree
  use mech9_text, only: string_type, to_text, lower, nearest_name
  use mech9_counted, only: counted
  use mech9_grammar, only: group_table, item_table, item_row_type, words_of
  use mech9_grammar_rows, only: refers_to, refers_to_link
  use mech9_diagnostics, only: printable
  use mech9_answer, only: read_answer, yes_or_no
  use mech9_short_answers, only: word_meant, full_form
  use mech9_units, only: units_type
  use mech9_answer_units, only: in_file_units, part_length
  use mech9_question_words, only: angle_unit, si_units_here, units_of_draft
  use mech9_draft, only: draft_type, integer_of
  use mech9_draft_check, only: problem_with, problem_with_joint
  use mech9_draft_joints, only: give_joints
  use mech9_outline, only: ways, drop_empty_guesses
  use mech9_interview, only: most_parts
  use mech9_seldom, only: seldom_rows
  use mech9_topics, only: topics
  use mech9_planar_links, only: is_placed, point_in_plane, gives_lengths, plane_so_far, point_of_plane
  use mech9_questions, only: question_type, entry_name, label_of, ask_item, ask_seldom, ask_way, ask_joints, ask_geometry, ask_units
  use mech9_unit_answer, only: is_unit_row, give_units
  use mech9_converted_numbers, only: convert_numbers, changed_units
  use mech9_conversation, only: conversation_type, going
  implicit none
  private
  public :: take_answer, keep_answer, move_on, settle_units

  character(len=*), parameter :: what_lengths_mean = &
    'Each link has a system of its own: the origin is in its pair of the lowest number, and x leads to its next pair. All axes '// &
    'of turns are z. A coordinate is the angle between the x axes of its two links. For a pair beside x, give x and y.'

contains

  !> Check and note an answer to the current question.
  subroutine take_answer(conversation, line)
    class(conversation_type), intent(inout) :: conversation  !< the conversation as it stands
    character(len=*), intent(in) :: line                     !< the answer, without blanks around it
    type(question_type) :: question
    type(draft_type) :: before

    question = conversation%interview%due()
    before = conversation%interview%draft
    select case (question%kind)
    case (ask_item)
      call take_item(conversation, question, line)
    case (ask_seldom)
      call take_seldom(conversation, question, line)
    case (ask_way)
      call take_way(conversation, line)
    case (ask_joints)
      call take_joints(conversation, line)
    case (ask_geometry)
      call take_geometry(conversation, line)
    case (ask_units)
      call take_units(conversation, line)
    case default
      call take_guesses(conversation, line)
    end select
    if (question%kind == ask_units) then
      call settle_units(conversation, before)
    else if (question%kind == ask_item) then
      if (is_unit_row(item_table(question%row))) call settle_units(conversation, before)
    end if
  end subroutine take_answer

  !> Ask whether the numbers are to be converted, or their digits are right as they stand, where a unit of the file has changed.
  subroutine settle_units(conversation, before)
    class(conversation_type), intent(inout) :: conversation  !< the conversation as it stands, with the new units
    type(draft_type), intent(in) :: before                   !< the answers with the units before
    type(draft_type) :: converted
    type(string_type) :: words(2)
    character(len=:), allocatable :: old, new, left, line
    integer :: count

    if (conversation%state /= going) return
    associate (draft => conversation%interview%draft)
      call changed_units(units_of_draft(before), units_of_draft(draft), old, new)
      if (old == '') return
      converted = draft
      call convert_numbers(units_of_draft(before), units_of_draft(draft), converted, count, left)
    end associate
    if (count == 0) return
    call conversation%say('The numbers so far are in '//old//'. They can be converted to '//new//', or keep their digits.')
    words(1)%text = 'convert'
    words(2)%text = 'keep'
    do
      call conversation%listen('  convert or keep [keep]: ', words, line)
      if (conversation%state /= going) then
        ! without an answer the numbers mean what they did
        call take_back_units(before, conversation%interview%draft)
        call conversation%keep()
        return
      end if
      line = lower(line(:min(len(line), 8)))
      if (line == '' .or. line == 'keep') then
        call conversation%say('The digits are kept: they are in '//new//' now.')
        return
      end if
      if (line == 'convert') exit
      call conversation%say('convert turns 80 mm into 0.08 m; keep leaves the digits 80, which then mean 80 of the new unit.')
    end do
    if (left == '') then
      conversation%interview%draft = converted
      call conversation%say('Converted: '//counted(count, 'answer')//'.')
    else
      call take_back_units(before, conversation%interview%draft)
      call conversation%say('The units of these numbers depend on others, or they stand in files: '//left//'. '// &
                            'Nothing is converted, and the units are '//old//' as before.')
    end if
    call conversation%interview%refresh(label_of(conversation%interview%due()))
    call conversation%keep()
  end subroutine settle_units

  !> Give a draft the units that another one has.
  pure subroutine take_back_units(before, draft)
    type(draft_type), intent(in) :: before        !< with the units
    type(draft_type), intent(inout) :: draft      !< gets them
    character(len=:), allocatable :: name
    integer :: i

    do i = 1, size(item_table)
      if (.not. is_unit_row(item_table(i))) cycle
      name = trim(item_table(i)%name)
      if (before%has('mechanism', 1, name)) then
        call draft%give('mechanism', 1, name, before%value('mechanism', 1, name))
      else
        call draft%take_away('mechanism', 1, name)
      end if
    end do
  end subroutine take_back_units

  !> Check and note the answer to a question about a name.
  subroutine take_item(conversation, question, line)
    class(conversation_type), intent(inout) :: conversation  !< the conversation as it stands
    type(question_type), intent(in) :: question              !< the question
    character(len=*), intent(in) :: line                     !< the answer, without blanks around it
    character(len=:), allocatable :: text, converted, problem

    if (lower(line(:min(len(line), 8))) == 'default') then
      call conversation%interview%unnote()
      call conversation%keep()
      return
    end if
    call convert_units(conversation, question, line, converted, problem)
    if (problem == '') &
      call read_answer(item_table(question%row), line_meant(conversation, question, converted), text, problem, &
                       merge(radians_per_degree, 1.0_wp, angle_unit(conversation%interview%draft) == 'deg'))
    if (problem == '') call doubt_length(conversation, question, line, text, problem)
    if (problem == '') call hold_against_rest(conversation, question, text, problem)
    if (problem == '') call count_independent(conversation, text, problem)
    if (problem == '') then
      call keep_answer(conversation, text, names_meant(conversation%interview%draft, item_table(question%row), converted))
    else
      call conversation%say(problem)
    end if
  end subroutine take_item

  !> Convert the units of an answer into those of the file. For gravity along an axis it is 9.81 m/s^2 in them.
  pure subroutine convert_units(conversation, question, line, converted, problem)
    class(conversation_type), intent(in) :: conversation      !< the conversation as it stands
    type(question_type), intent(in) :: question               !< the question
    character(len=*), intent(in) :: line                      !< the answer, without blanks around it
    character(len=:), allocatable, intent(out) :: converted   !< the answer in the units of the file
    character(len=:), allocatable, intent(out) :: problem     !< why a unit does not fit; empty: nothing is wrong
    character(len=part_length), allocatable :: wanted(:)
    character(len=:), allocatable :: full
    type(units_type) :: units

    converted = line
    problem = ''
    associate (row => item_table(question%row), draft => conversation%interview%draft)
      if (row%type /= 'real') return
      units = units_of_draft(draft)
      full = line
      if (row%group == 'gravity' .and. units%length_name /= 'm') then
        full = full_form(row, line)
        if (full /= line) full = full//' m/s^2'
      end if
      call si_units_here(question, draft, wanted)
      call in_file_units(full, wanted, units, converted, problem)
    end associate
  end subroutine convert_units

  !> A line in which a length, or two numbers, become a point where the lengths of planar links are asked for, and two numbers where
  !> the mechanism is planar so far.
  pure function line_meant(conversation, question, line) result(text)
    class(conversation_type), intent(in) :: conversation   !< the conversation as it stands
    type(question_type), intent(in) :: question            !< the question
    character(len=*), intent(in) :: line                   !< the answer, without blanks around it
    character(len=:), allocatable :: text

    text = numbers_meant(conversation%interview%draft, item_table(question%row), line)
    associate (row => item_table(question%row), draft => conversation%interview%draft)
      if (row%unit == 'm' .and. row%low == 3 .and. row%high == 3) then
        if (plane_so_far(draft) > 0) text = point_of_plane(line, plane_so_far(draft))
      end if
    end associate
    if (group_table(question%group_row)%name /= 'pair') return
    associate (interview => conversation%interview)
      if (is_placed(interview%draft, interview%outline, question%place, trim(item_table(question%row)%name))) &
        text = point_in_plane(line)
    end associate
  end function line_meant

  !> A line in which names of links and pairs that stand for numbers become these numbers.
  pure function numbers_meant(draft, row, line) result(text)
    type(draft_type), intent(in) :: draft        !< the data file so far
    type(item_row_type), intent(in) :: row       !< of the name that is asked for
    character(len=*), intent(in) :: line         !< the answer, without blanks around it
    character(len=:), allocatable :: text, word
    integer :: first, last, kind

    text = line
    kind = refers_to(trim(row%group), trim(row%name))
    if (kind == 0) return
    text = ''
    last = 0
    do while (last < len(line))
      first = last + 1
      last = first + scan(line(first:)//',', ' ,') - 2
      word = number_called(draft, kind, line(first:last))
      text = text//word
      last = last + 1
      if (last <= len(line)) text = text//line(last:last)
    end do
  end function numbers_meant

  !> The words of an answer, with quotes around the names of links and pairs that stand for numbers; empty for other answers.
  pure function names_meant(draft, row, line) result(text)
    type(draft_type), intent(in) :: draft        !< the data file so far
    type(item_row_type), intent(in) :: row       !< of the name that is asked for
    character(len=*), intent(in) :: line         !< the answer, without blanks around it
    character(len=:), allocatable :: text
    integer :: first, last, kind

    text = ''
    kind = refers_to(trim(row%group), trim(row%name))
    if (kind == 0) return
    last = 0
    do while (last < len(line))
      first = last + 1
      last = first + scan(line(first:)//',', ' ,') - 1
      if (last == first) cycle
      if (text /= '') text = text//', '
      if (number_called(draft, kind, line(first:last - 1)) == line(first:last - 1)) then
        text = text//line(first:last - 1)
      else
        text = text//''''//line(first:last - 1)//''''
      end if
    end do
  end function names_meant

  !> The number of the link or the coordinate that a word names, with quotes or without; the word itself where it names none.
  pure function number_called(draft, kind, word) result(number)
    type(draft_type), intent(in) :: draft        !< the data file so far
    integer, intent(in) :: kind                  !< refers_to_link or refers_to_coordinate
    character(len=*), intent(in) :: word         !< a word of an answer
    character(len=:), allocatable :: number, group, key, given, name
    integer :: i

    number = word
    name = word
    if (len(name) > 2 .and. scan(word, '''"') == 1) name = word(2:len(word) - 1)
    if (len(name) == 0) return
    group = 'pair'
    key = 'coordinate'
    if (kind == refers_to_link) group = 'link'
    if (kind == refers_to_link) key = 'number'
    do i = 1, draft%count_of(group)
      given = draft%value(group, i, 'name')
      if (len(given) < 3) cycle
      if (name /= given(2:len(given) - 1)) cycle
      if (draft%has(group, i, key)) number = draft%value(group, i, key)
    end do
  end function number_called

  !> Refuse a length once that is as long as if millimetres were meant, where neither the answer nor the file names a unit. All
  !> lengths are accepted after one was given again.
  subroutine doubt_length(conversation, question, line, text, problem)
    class(conversation_type), intent(inout) :: conversation  !< the conversation as it stands
    type(question_type), intent(in) :: question              !< the question
    character(len=*), intent(in) :: line                     !< the answer as it was typed
    character(len=*), intent(in) :: text                     !< the answer as a data file writes it
    character(len=:), allocatable, intent(inout) :: problem  !< the reason against the answer; empty: none
    real(wp), parameter :: doubtful = 20.0_wp                !< few mechanisms are longer [m]
    real(wp) :: numbers(3)
    integer :: iostat, n

    associate (row => item_table(question%row))
      if (conversation%is_large .or. row%unit /= 'm' .or. row%type /= 'real') return
      n = min(row%high, size(numbers))
    end associate
    if (conversation%interview%draft%has('mechanism', 1, 'length_unit')) return
    if (verify(line, '0123456789+-.,eEdD '//achar(9)) > 0) return
    read (text, *, iostat=iostat) numbers(:n)
    if (iostat /= 0) return
    if (all(abs(numbers(:n)) < doubtful)) return
    conversation%is_large = text == conversation%doubted
    conversation%doubted = text
    if (.not. conversation%is_large) &
      problem = 'Lengths are in m, and this one is '//to_text(maxval(abs(numbers(:n))))//' m. Name the unit if another one is '// &
                'meant, as in 120 mm. If it is so here, give the same answer again.'
  end subroutine doubt_length

  !> Check the number of coordinates that an answer makes independent. Refuse an answer that the structure hardly allows
  !> once, and accept it if it is given again.
  subroutine count_independent(conversation, text, problem)
    class(conversation_type), intent(inout) :: conversation  !< the conversation as it stands
    character(len=*), intent(in) :: text                     !< the answer as a data file writes it
    character(len=:), allocatable, intent(inout) :: problem  !< the reason against the answer; empty: none
    logical :: certain

    call conversation%interview%miscount(text, problem, certain)
    if (problem == '' .or. certain) return
    if (text == conversation%doubted) problem = ''
    if (problem /= '') problem = problem//' If it is so here, give the same answer again.'
    conversation%doubted = text
  end subroutine count_independent

  !> Note an answer, and go on to the next question.
  subroutine keep_answer(conversation, text, written)
    class(conversation_type), intent(inout) :: conversation  !< the conversation as it stands
    character(len=*), intent(in) :: text                     !< the answer as a data file writes it
    character(len=*), intent(in), optional :: written        !< with names of links and pairs in quotes, not numbers

    call conversation%interview%note(text, written)
    call tell_dropped(conversation)
    call move_on(conversation)
  end subroutine keep_answer

  !> Tell the names that the last answer made meaningless.
  subroutine tell_dropped(conversation)
    class(conversation_type), intent(inout) :: conversation  !< the conversation as it stands

    if (conversation%interview%dropped /= '') &
      call conversation%say('(dropped, as it has no meaning any more: '//conversation%interview%dropped//')')
  end subroutine tell_dropped

  !> Go on to the next question, and save the answers in the draft's file.
  subroutine move_on(conversation)
    class(conversation_type), intent(inout) :: conversation  !< the conversation as it stands

    call conversation%interview%step()
    call conversation%keep()
  end subroutine move_on

  !> Check an answer against the other answers, as the reader of data files would. Structural data that belong together
  !> are checked together when the structure is complete.
  subroutine hold_against_rest(conversation, question, text, problem)
    class(conversation_type), intent(in) :: conversation   !< the conversation as it stands
    type(question_type), intent(in) :: question            !< the question
    character(len=*), intent(in) :: text                   !< the answer as a data file writes it
    character(len=:), allocatable, intent(out) :: problem  !< messages, a line each; empty: nothing is wrong
    type(draft_type) :: trial
    character(len=:), allocatable :: group, name

    problem = ''
    group = trim(group_table(question%group_row)%name)
    name = entry_name(question)
    associate (interview => conversation%interview)
      if (group == 'mechanism') then
        if (item_table(question%row)%type == 'integer' .and. integer_of(text) > most_parts) &
          problem = 'more than '//to_text(most_parts)//' are too many to speak of one by one; write a data file'
        return
      end if
      if (group == 'structure') then
        if (interview%outline%way == 'vectors') return
        if (question%line > 0 .and. interview%draft%has(group, question%place, name)) return
      end if
      trial = interview%draft
      call trial%give(group, question%place, name, text)
      if (group == 'pair' .and. (name == 'kind' .or. name == 'coordinates')) then
        call problem_with_joint(trial, interview%outline, conversation%draft_path, question%place, problem)
      else
        call problem_with(trial, interview%outline, conversation%draft_path, group, question%place, name, problem)
      end if
    end associate
  end subroutine hold_against_rest

  !> Read the answer about the rarely used names of a group.
  subroutine take_seldom(conversation, question, line)
    class(conversation_type), intent(inout) :: conversation  !< the conversation as it stands
    type(question_type), intent(in) :: question              !< the question
    character(len=*), intent(in) :: line                     !< the answer, without blanks around it
    character(len=:), allocatable :: problem
    integer, allocatable :: rows(:)

    associate (interview => conversation%interview)
      rows = seldom_rows(interview%outline, question%group_row)
      problem = ''
      if (yes_or_no(line) == 'yes') then
        interview%outline%asked(rows) = .true.
      else if (line /= '' .and. yes_or_no(line) /= 'no') then
        call take_names(line, rows, interview%outline%asked, problem)
      end if
      if (problem /= '') then
        call conversation%say(problem)
        return
      end if
      call interview%refresh(label_of(question))
    end associate
    call move_on(conversation)
  end subroutine take_seldom

  !> Read names separated by blanks or commas.
  pure subroutine take_names(line, rows, asked, problem)
    character(len=*), intent(in) :: line                   !< the answer, without blanks around it
    integer, intent(in) :: rows(:)                         !< rows in item_table of the names that can be meant
    logical, intent(inout) :: asked(:)                     !< (rows of item_table) which rarely used names the user wants to give
    character(len=:), allocatable, intent(out) :: problem  !< the reason why a word is no name; empty: all are names
    character(len=:), allocatable :: plain, hint
    integer, parameter :: longest_list = 200
    integer :: i, k

    problem = 'answer yes, no, or some of the names'
    if (len(line) > longest_list) return
    plain = lower(line)
    do i = 1, len(plain)
      if (plain(i:i) == ',') plain(i:i) = ' '
    end do
    associate (words => words_of(plain))
      do i = 1, size(words)
        associate (meant => [(item_table(rows(k))%name == words(i), k=1, size(rows))])
          asked(pack(rows, meant)) = .true.
          if (any(meant)) cycle
        end associate
        hint = nearest_name(trim(words(i)), item_table(rows)%name)
        if (hint /= '') hint = '; did you mean '//hint//'?'
        problem = ''''//printable(trim(words(i)), 40)//''' is none of these names'//hint
        return
      end do
    end associate
    problem = ''
  end subroutine take_names

  !> Read the answer about the way of giving the structure. Data that were given in another way are removed.
  subroutine take_way(conversation, line)
    class(conversation_type), intent(inout) :: conversation  !< the conversation as it stands
    character(len=*), intent(in) :: line                     !< the answer, without blanks around it
    character(len=:), allocatable :: way

    way = word_meant(line(:min(len(line), 20)), ways)
    if (line == '') way = trim(conversation%interview%outline%way)
    if (way == '') then
      way = nearest_name(line(:min(len(line), 20)), ways)
      if (way /= '') way = '; did you mean '//way//'?'
      call conversation%say('Answer pairs, matrix or vectors'//way)
      return
    end if
    associate (interview => conversation%interview)
      if (way /= interview%outline%way) then
        call interview%draft%remove('structure', 1)
        interview%outline%way = way
        interview%outline%structure_known = .false.
        call interview%refresh('way of structure')
      end if
    end associate
    call move_on(conversation)
  end subroutine take_way

  !> Read the answer about joints with several freedoms.
  subroutine take_joints(conversation, line)
    class(conversation_type), intent(inout) :: conversation  !< the conversation as it stands
    character(len=*), intent(in) :: line                     !< the answer, without blanks around it
    character(len=:), allocatable :: joints, problem

    joints = lower(line)
    if (joints == 'none' .or. joints == 'no') joints = ''
    associate (interview => conversation%interview)
      if (line /= '') then
        call give_joints(interview%draft, joints, problem)
        if (problem /= '') then
          call conversation%say(problem)
          return
        end if
        call interview%refresh('joints')
      end if
    end associate
    if (line /= '') call tell_dropped(conversation)
    call move_on(conversation)
  end subroutine take_joints

  !> Read the answer whether lengths of planar links or points give the geometry.
  subroutine take_geometry(conversation, line)
    class(conversation_type), intent(inout) :: conversation  !< the conversation as it stands
    character(len=*), intent(in) :: line                     !< the answer, without blanks around it
    character(len=7), parameter :: ways_of_geometry(2) = [character(len=7) :: 'lengths', 'points']
    character(len=:), allocatable :: way

    way = word_meant(line(:min(len(line), 20)), ways_of_geometry)
    associate (interview => conversation%interview)
      if (line == '') then
        way = 'points'
        if (gives_lengths(interview%draft, interview%outline)) way = 'lengths'
      end if
      if (way == '') then
        call conversation%say('Answer lengths or points.')
        return
      end if
      interview%outline%lengths = way == 'lengths'
      call interview%refresh('geometry')
    end associate
    associate (topic => conversation%topic)
      if (way == 'lengths') then
        call conversation%say(what_lengths_mean)
      else if (.not. conversation%opened(topic)) then
        call conversation%say(trim(topics(topic)%opening))
        conversation%opened(topic) = .true.
      end if
    end associate
    call move_on(conversation)
  end subroutine take_geometry

  !> Read the answer about the units of the data file.
  subroutine take_units(conversation, line)
    class(conversation_type), intent(inout) :: conversation  !< the conversation as it stands
    character(len=*), intent(in) :: line                     !< the answer, without blanks around it
    character(len=:), allocatable :: problem

    associate (interview => conversation%interview)
      call give_units(line, interview%draft, problem)
      if (problem /= '') then
        call conversation%say(problem)
        return
      end if
      call interview%refresh('units')
    end associate
    call move_on(conversation)
  end subroutine take_units

  !> Read the answer about guesses of the dependent coordinates at the start.
  subroutine take_guesses(conversation, line)
    class(conversation_type), intent(inout) :: conversation  !< the conversation as it stands
    character(len=*), intent(in) :: line                     !< the answer, without blanks around it

    associate (interview => conversation%interview)
      select case (yes_or_no(line))
      case ('yes')
        interview%outline%guesses = .true.
      case ('no')
        interview%outline%guesses = .false.
        call drop_empty_guesses(interview%draft)
      case default
        if (line /= '') then
          call conversation%say('Answer yes or no.')
          return
        end if
      end select
      call interview%refresh('guesses')
    end associate
    call move_on(conversation)
  end subroutine take_guesses
end module mech9_taking
