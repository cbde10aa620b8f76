!> The words of questions: headings, prompts, defaults, and the words that can be completed, all from the table of
!> names.
module mech9_question_words
  use mech9_text, only: to_text, string_type
  use mech9_grammar, only: group_table, item_table, words_of
  use mech9_data_help, only: default_text
  use mech9_units, only: units_type, units_of_words
  use mech9_answer_units, only: part_length
  use mech9_draft, only: draft_type, unquoted
  use mech9_draft_names, only: names_in_draft, shown_text
  use mech9_known_names, only: add_names_for
  use mech9_topics, only: groups_of_topic, can_be_left_out
  use mech9_compound_joint, only: compound_kinds
  use mech9_draft_joints, only: kind_in, number_in, coordinates_of_pair, kind_of_coordinate
  use mech9_outline, only: outline_type
  use mech9_seldom, only: seldom_rows
  use mech9_study_needs, only: is_for_study
  use mech9_unit_answer, only: all_unit_words
  use mech9_planar_links, only: is_placed, is_settled, origin_pair, link_of_point
  use mech9_questions, only: question_type, entry_name, ask_item, ask_seldom, ask_way, &
                             ask_guesses, ask_joints, ask_geometry, ask_units
  implicit none
  private
  public :: default_type, default_of, prompt_of, heading_of, coordinate_kind, words_for
  public :: unit_here, si_units_here, units_of_draft, angle_unit, is_lacking, is_needed, seldom_names

  !> The answer that Enter gives.
  type :: default_type
    character(len=:), allocatable :: text       !< value as a data file writes it; empty: there is nothing to note
    character(len=:), allocatable :: shown      !< text in the brackets of the prompt; empty: no brackets
    logical :: noted = .false.                  !< the value is noted in the data file like an answer that was typed
  end type default_type

contains

  !> The answer that Enter gives to a question about a name: the earlier answer if there is one. Otherwise it is a
  !> likely value for a name that must be given, or the default of the table.
  pure function default_of(question, draft, outline, table_file) result(default)
    type(question_type), intent(in) :: question  !< the question
    type(draft_type), intent(in) :: draft        !< groups and names with their values as text
    type(outline_type), intent(in) :: outline    !< facts known beside the draft
    character(len=*), intent(in) :: table_file   !< name of a file for the table of results
    type(default_type) :: default
    character(len=:), allocatable :: group, name

    default%text = ''
    default%shown = ''
    group = trim(group_table(question%group_row)%name)
    name = entry_name(question)
    associate (row => item_table(question%row))
      if (question%is_new) then
        default%shown = 'no more'
        if (question%place == 1) default%shown = 'none'
      else if (draft%has(group, question%place, name)) then
        default%text = draft%value(group, question%place, name)
      else if (group == 'output' .and. name == 'table') then
        default%text = ''''//table_file//''''
      else if (is_needed(question, draft, outline)) then
        default%text = likely_value(question, draft, outline)
      else if (row%needed) then
        default%shown = ''             ! a data file may leave out the group, but here the value must be given
      else if (index(row%default, '(') /= 1 .and. row%default /= '''''') then
        default%shown = unquoted(trim(row%default))
      else
        default%shown = default_text(row)
      end if
      default%noted = default%text /= '' .and. .not. draft%has(group, question%place, name)
      if (default%text /= '') default%shown = unquoted(default%text)
      if (draft%has(group, question%place, name) .and. .not. question%is_new) then
        associate (entries => draft%groups(draft%find(group, question%place))%entries)
          default%shown = shown_text(group, entries(draft%find_entry(group, question%place, name)), names_in_draft(draft))
        end associate
      end if
      if (row%type == 'logical') default%shown = switch_word(default%shown)
    end associate
  end function default_of

  !> The word yes or no for a switch of a data file; another value stays as it is.
  pure function switch_word(text) result(word)
    character(len=*), intent(in) :: text  !< a value as a data file writes it
    character(len=:), allocatable :: word

    word = text
    if (text == '.true.') word = 'yes'
    if (text == '.false.') word = 'no'
  end function switch_word

  !> A likely value for a name that must be given. It is the axis of the revolute pair before, the first of the words
  !> allowed, or the default for a value at the start. It is empty if nothing is likely. A slide gives neither its kind
  !> nor its axis to the pair after it.
  pure function likely_value(question, draft, outline) result(text)
    type(question_type), intent(in) :: question  !< the question
    type(draft_type), intent(in) :: draft        !< groups and names with their values as text
    type(outline_type), intent(in) :: outline    !< facts known beside the draft
    character(len=:), allocatable :: text

    text = ''
    associate (row => item_table(question%row))
      if (row%group == 'initial') then
        text = trim(row%default)
      else if (row%group == 'pair' .and. row%name == 'axis') then
        text = axis_before(question%place, draft)
      else if (row%group == 'pair' .and. is_placed(draft, outline, question%place, trim(row%name))) then
        if (kind_in(draft, draft%find('pair', question%place)) == 'prismatic') text = '0, 0, 0'
      else if (group_table(question%group_row)%repeats .and. row%words /= '') then
        text = ''''//row%words(:index(row%words, ' ') - 1)//''''
      end if
    end associate
  end function likely_value

  !> For a revolute pair, the axis of the last revolute pair before it that has one; empty if there is none.
  pure function axis_before(place, draft) result(text)
    integer, intent(in) :: place           !< place of the pair among the pairs, from 1
    type(draft_type), intent(in) :: draft  !< groups and names with their values as text
    character(len=:), allocatable :: text
    integer :: i

    text = ''
    if (kind_in(draft, draft%find('pair', place)) /= 'revolute') return
    do i = place - 1, 1, -1
      if (kind_in(draft, draft%find('pair', i)) == 'revolute') text = draft%value('pair', i, 'axis')
      if (text /= '') return
    end do
  end function axis_before

  !> Whether a question about a name must be answered and is not answered yet.
  pure logical function is_lacking(question, draft, outline)
    type(question_type), intent(in) :: question  !< the question
    type(draft_type), intent(in) :: draft        !< groups and names with their values as text
    type(outline_type), intent(in) :: outline    !< facts known beside the draft

    is_lacking = .false.
    if (question%kind /= ask_item .or. question%is_new) return
    is_lacking = is_needed(question, draft, outline) .and. .not. &
                 draft%has(trim(group_table(question%group_row)%name), question%place, entry_name(question))
  end function is_lacking

  !> Whether a name must be given. Counts and structural data must be given here, though in a data file some of them can
  !> be left out. A group that is not repeated may be left out as a whole.
  pure logical function is_needed(question, draft, outline)
    type(question_type), intent(in) :: question  !< the question
    type(draft_type), intent(in) :: draft        !< groups and names with their values as text
    type(outline_type), intent(in) :: outline    !< facts known beside the draft

    associate (row => item_table(question%row))
      is_needed = row%needed .or. index(row%default, '(needed') == 1
      if (row%group == 'pair' .and. draft%has('pair', question%place, 'dh')) is_needed = is_needed .and. row%name /= 'axis'
      if (row%needed .and. .not. group_table(question%group_row)%repeats) &
        is_needed = draft%count_of(trim(row%group)) > 0
      select case (row%group)
      case ('mechanism')
        is_needed = is_needed .or. row%name == 'links' .or. row%name == 'coordinates'
      case ('structure')
        select case (row%name)
        case ('cq', 'c')
          is_needed = outline%way /= 'vectors'
        case ('nrg', 'nws', 'rdw')
          is_needed = outline%way == 'vectors'
        end select
      case ('pair')
        is_needed = is_needed .or. (is_placed(draft, outline, question%place, trim(row%name)) .and. .not. &
                                     is_settled(draft, outline, question%place, trim(row%name)))
      case ('parameter')
        is_needed = is_needed .or. is_for_study(draft, question%place, trim(row%name))
      case ('initial')
        ! a coordinate without a velocity starts at rest
        if (row%name == 'position' .and. outline%structure_known) &
          is_needed = is_independent(outline, draft%number('initial', question%place, 'coordinate'))
      end select
    end associate
  end function is_needed

  !> Whether a coordinate is independent by the structure.
  pure logical function is_independent(outline, coordinate)
    type(outline_type), intent(in) :: outline  !< facts known beside the draft
    integer, intent(in) :: coordinate          !< number of the coordinate

    is_independent = .false.
    if (coordinate >= 1 .and. coordinate <= size(outline%independent)) is_independent = outline%independent(coordinate)
  end function is_independent

  !> The heading of the questions of one group, such as "Pair 5, from link 1 to link 2". It is empty if there is only
  !> one group of this name.
  pure function heading_of(question, draft) result(text)
    type(question_type), intent(in) :: question  !< the question
    type(draft_type), intent(in) :: draft        !< groups and names with their values as text
    character(len=:), allocatable :: text
    character(len=:), allocatable :: group, links
    integer :: comma

    text = ''
    if (question%kind /= ask_item .or. question%is_new) return
    if (.not. group_table(question%group_row)%repeats) return
    group = trim(group_table(question%group_row)%name)
    select case (group)
    case ('pair')
      if (item_table(question%row)%name == 'links') return
      links = draft%value(group, question%place, 'links')
      comma = index(links, ',')
      text = 'Pair '//to_text(number_in(draft, group, question%place))
      if (size(coordinates_of_pair(draft, question%place)) > 1) &
        text = text//' (coordinates '//to_text(coordinates_of_pair(draft, question%place))//')'
      if (comma > 0) text = text//', from link '//links(:comma - 1)//' (reference) to link '// &
                            trim(adjustl(links(comma + 1:)))//' (moving)'
    case ('drive')
      text = 'Drive of coordinate '//draft%value(group, question%place, 'coordinate')
    case ('initial')
      text = 'Coordinate '//draft%value(group, question%place, 'coordinate')//' at the start'
    case default
      text = achar(iachar(group(1:1)) - 32)//group(2:)//' '//to_text(question%place)
    end select
  end function heading_of

  !> The prompt of a question: its name, its unit and its default.
  pure function prompt_of(question, draft, outline, default) result(text)
    type(question_type), intent(in) :: question  !< the question
    type(draft_type), intent(in) :: draft        !< groups and names with their values as text
    type(outline_type), intent(in) :: outline    !< facts known beside the draft
    type(default_type), intent(in) :: default    !< the answer that Enter gives
    character(len=:), allocatable :: text, unit

    associate (row => item_table(question%row))
      text = '  '//trim(row%name)
      if (.not. group_table(question%group_row)%repeats .and. size(groups_of_topic(question%topic)) > 1) &
        text = '  '//trim(row%group)//', '//trim(row%name)
      if (question%line > 0) text = '  row '//to_text(question%line)//' of c'
      if (row%group == 'pair' .and. row%name == 'links') &
        text = '  links of pair '//to_text(coordinates_of_pair(draft, question%place))
      if (row%group == 'pair') then
        if (is_placed(draft, outline, question%place, trim(row%name))) text = '  '//place_in_words(question, draft, outline)
      end if
      if (question%is_new) then
        text = '  '//trim(row%group)//', '//trim(row%name)
        if (group_table(question%group_row)%repeats) &
          text = '  '//trim(row%group)//' '//to_text(question%place)//', '//trim(row%name)
      end if
      unit = unit_here(question, draft)
      if (unit /= '') text = text//' ('//unit//')'
    end associate
    if (default%shown /= '') text = text//' ['//default%shown//']'
    text = text//': '
  end function prompt_of

  !> The question where a pair lies on a link of a planar mechanism.
  pure function place_in_words(question, draft, outline) result(text)
    type(question_type), intent(in) :: question  !< the question
    type(draft_type), intent(in) :: draft        !< groups and names with their values as text
    type(outline_type), intent(in) :: outline    !< facts known beside the draft
    character(len=:), allocatable :: text, name
    integer :: origin

    name = trim(item_table(question%row)%name)
    origin = origin_pair(draft, outline, question%place, name)
    text = 'on link '//to_text(link_of_point(draft, outline, question%place, name))//', the origin'
    if (origin /= number_in(draft, 'pair', question%place)) &
      text = text(:index(text, ',') + 1)//'length from pair '//to_text(origin)//', or x y'
  end function place_in_words

  !> The unit of a name in this data file. Angles are in rad or degrees; the units of coordinates, and of loads on them,
  !> follow from the kind of their pair.
  pure function unit_here(question, draft) result(unit)
    type(question_type), intent(in) :: question  !< the question
    type(draft_type), intent(in) :: draft        !< groups and names with their values as text
    character(len=:), allocatable :: unit

    unit = in_units_of(draft, unit_in_si(question, draft))
  end function unit_here

  !> The unit of a name in SI, with rad or m for the unit of a coordinate.
  pure function unit_in_si(question, draft) result(unit)
    type(question_type), intent(in) :: question  !< the question
    type(draft_type), intent(in) :: draft        !< groups and names with their values as text
    character(len=:), allocatable :: unit
    character(len=:), allocatable :: kind, q

    unit = trim(item_table(question%row)%unit)
    kind = coordinate_kind(question, draft)
    q = 'rad'
    if (kind == 'prismatic' .or. kind == 'path') q = 'm'
    if (kind == 'user') q = ''
    if (item_table(question%row)%group == 'load' .and. item_table(question%row)%kinds == 'coordinate') &
      unit = unit_of_load(unit, kind)
    call replace('angle', 'rad', unit)
    if (q == '' .and. has_word(unit, 'q')) unit = ''
    call replace('q', q, unit)
    call replace('q', q, unit)
  end function unit_in_si

  !> Name the units of a list in those of this data file.
  pure function in_units_of(draft, list) result(text)
    type(draft_type), intent(in) :: draft        !< groups and names with their values as text
    character(len=*), intent(in) :: list         !< SI units with commas or `or` between them
    character(len=:), allocatable :: text
    type(units_type) :: units
    integer :: first, last, gap

    units = units_of_draft(draft)
    text = ''
    first = 1
    do while (first <= len(list))
      last = index(list(first:), ', ')
      gap = 2
      if (index(list(first:), ' or ') > 0) then
        last = index(list(first:), ' or ')
        gap = 4
      end if
      if (last == 0) then
        text = text//trim(units%name_of(list(first:)))
        return
      end if
      last = first + last - 2
      text = text//trim(units%name_of(list(first:last)))//list(last + 1:last + gap)
      first = last + gap + 1
    end do
  end function in_units_of

  !> The SI units of the numbers of an answer, one for each place of the list, the last one for all further places; empty where a
  !> number is plain or its unit is not known.
  pure subroutine si_units_here(question, draft, list)
    type(question_type), intent(in) :: question                !< the question
    type(draft_type), intent(in) :: draft                      !< groups and names with their values as text
    character(len=part_length), allocatable, intent(out) :: list(:)   !< the units
    character(len=:), allocatable :: unit, kind, q
    integer :: power

    unit = unit_in_si(question, draft)
    kind = coordinate_kind(question, draft)
    q = 'rad'
    if (kind == 'prismatic' .or. kind == 'path') q = 'm'
    list = [character(len=part_length) :: unit]
    select case (item_table(question%row)%unit)
    case ('m, angle')
      list = [character(len=part_length) :: 'm', 'rad', 'm', 'rad']
    case ('q, q/s, ...')
      list = [character(len=part_length) :: q, q//'/s', (q//'/s^'//to_text(power), power=2, 9)]
      if (kind == '' .or. kind == 'user') list = [character(len=part_length) :: '']
    case default
      if (index(item_table(question%row)%unit, 'q') > 0 .and. kind == '') list = ''
      if (scan(unit, ',') > 0 .or. index(unit, ' or ') > 0 .or. index(unit, ' per ') > 0) list = ''
    end select
  end subroutine si_units_here

  !> The units of this data file.
  pure type(units_type) function units_of_draft(draft) result(units)
    type(draft_type), intent(in) :: draft  !< groups and names with their values as text

    units = units_of_words(unquoted(draft%value('mechanism', 1, 'length_unit')), angle_unit(draft), &
                           unquoted(draft%value('mechanism', 1, 'force_unit')), &
                           unquoted(draft%value('mechanism', 1, 'mass_unit')), &
                           unquoted(draft%value('mechanism', 1, 'rate_unit')))
  end function units_of_draft

  !> The unit that fits the kind of pair, out of those for a length and for an angle, such as "N or N m".
  pure function unit_of_load(both, kind) result(unit)
    character(len=*), intent(in) :: both  !< the two units, separated by a comma or `or`; a single unit stays as it is
    character(len=*), intent(in) :: kind  !< kind of the pair; empty: unknown
    character(len=:), allocatable :: unit
    integer :: gap, next

    unit = both
    gap = index(both, ', ')
    next = gap + 2
    if (gap == 0) then
      gap = index(both, ' or ')
      next = gap + 4
    end if
    if (gap == 0) return
    if (kind == 'prismatic' .or. kind == 'path') unit = both(:gap - 1)
    if (kind == 'revolute' .or. kind == 'helical') unit = both(next:)
  end function unit_of_load

  !> The kind of the pair whose coordinate the group of a question names; empty if it names none.
  pure function coordinate_kind(question, draft) result(kind)
    type(question_type), intent(in) :: question  !< the question
    type(draft_type), intent(in) :: draft        !< groups and names with their values as text
    character(len=:), allocatable :: kind

    kind = kind_of_coordinate(draft, number_in(draft, trim(group_table(question%group_row)%name), question%place))
  end function coordinate_kind

  !> The unit of angles in this data file.
  pure function angle_unit(draft) result(unit)
    type(draft_type), intent(in) :: draft  !< groups and names with their values as text
    character(len=3) :: unit

    unit = 'rad'
    if (unquoted(draft%value('mechanism', 1, 'angle_unit')) == 'deg') unit = 'deg'
  end function angle_unit

  !> Replace the first occurrence of a word by another word.
  pure subroutine replace(word, by, text)
    character(len=*), intent(in) :: word                  !< word to be replaced
    character(len=*), intent(in) :: by                    !< word that takes its place
    character(len=:), allocatable, intent(inout) :: text  !< words between blanks, commas and slashes
    integer :: at

    at = word_place(text, word)
    if (at > 0) text = text(:at - 1)//by//text(at + len(word):)
  end subroutine replace

  !> Whether a text has a word.
  pure logical function has_word(text, word)
    character(len=*), intent(in) :: text  !< words between blanks, commas and slashes
    character(len=*), intent(in) :: word  !< the word that is looked for

    has_word = word_place(text, word) > 0
  end function has_word

  !> The place of a word in a text of words, blanks, commas and slashes; 0 if it is not there.
  pure integer function word_place(text, word) result(at)
    character(len=*), intent(in) :: text  !< words between blanks, commas and slashes
    character(len=*), intent(in) :: word  !< the word that is looked for

    do at = 1, len(text) - len(word) + 1
      if (text(at:at + len(word) - 1) /= word) cycle
      if (at > 1) then
        if (scan(text(at - 1:at - 1), ' ,/') == 0) cycle
      end if
      if (at + len(word) > len(text)) return
      if (scan(text(at + len(word):at + len(word)), ' ,/') > 0) return
    end do
    at = 0
  end function word_place

  !> The rarely used names of a group, such as "zero, moving_point".
  pure function seldom_names(question, outline) result(text)
    type(question_type), intent(in) :: question  !< the question
    type(outline_type), intent(in) :: outline    !< facts known beside the draft
    character(len=:), allocatable :: text
    integer, allocatable :: rows(:)
    integer :: i

    text = ''
    rows = seldom_rows(outline, question%group_row)
    do i = 1, size(rows)
      if (index(', '//text//',', ', '//trim(item_table(rows(i))%name)//',') > 0) cycle
      if (text /= '') text = text//', '
      text = text//trim(item_table(rows(i))%name)
    end do
  end function seldom_names

  !> List the words that can be completed at a question: those that it takes, names of the draft, and the commands.
  pure subroutine words_for(question, draft, outline, words)
    type(question_type), intent(in) :: question              !< the question
    type(draft_type), intent(in) :: draft                    !< groups and names with their values as text
    type(outline_type), intent(in) :: outline                !< facts known beside the draft
    type(string_type), allocatable, intent(out) :: words(:)  !< words that can be completed
    character(len=:), allocatable :: list
    integer :: i

    select case (question%kind)
    case (ask_way)
      list = 'pairs matrix vectors '
    case (ask_seldom)
      list = seldom_names(question, outline)
      do i = 1, len(list)
        if (list(i:i) == ',') list(i:i) = ' '
      end do
      list = 'yes no '//list//' '
    case (ask_geometry)
      list = 'lengths points '
    case (ask_guesses)
      list = 'yes no '
    case (ask_units)
      list = all_unit_words()
    case (ask_joints)
      list = 'none'
      do i = 1, size(compound_kinds)
        list = list//' '//trim(compound_kinds(i))
      end do
      list = list//' '
    case default
      list = trim(item_table(question%row)%words)//' '
      if (question%is_new) list = list//'none '
      if (item_table(question%row)%type == 'logical') list = 'yes no '
      if (can_be_left_out(question%group_row, outline%program) .and. .not. question%is_new) list = list//'remove '
    end select
    associate (all_words => words_of(list//'back list default quit'))
      allocate (words(size(all_words)))
      do i = 1, size(words)
        words(i)%text = trim(all_words(i))
      end do
    end associate
    if (question%kind == ask_item) call add_names_for(item_table(question%row), draft, words)
  end subroutine words_for
end module mech9_question_words
