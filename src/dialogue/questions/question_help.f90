!> The texts about a question beyond its prompt: one line where a name comes up first, and the answer to `?`. The answer
!> to an empty line is here too, where the question has no default.
module mech9_question_help
  use mech9_kinds, only: wp
  use mech9_text, only: to_text
  use mech9_units, only: units_type, units_of_words
  use mech9_grammar, only: group_table, item_table, item_row_type
  use mech9_data_help, only: values_text, default_text
  use mech9_draft, only: draft_type, unquoted
  use mech9_topics, only: can_be_left_out
  use mech9_outline, only: outline_type
  use mech9_seldom, only: seldom_rows
  use mech9_questions, only: question_type, ask_item, ask_seldom, ask_way, ask_guesses, ask_joints, ask_geometry, ask_units
  use mech9_question_words, only: coordinate_kind, angle_unit, unit_here, is_needed, seldom_names, &
    si_units_here, units_of_draft
  use mech9_answer_units, only: part_length
  use mech9_explanations, only: find_explanation, explanations
  implicit none
  private
  public :: gist_of, help_of, refusal_of_enter

  character, parameter :: line_end = achar(10)

contains

  !> One line on the meaning of a question, with the words that it takes.
  pure function gist_of(question) result(text)
    type(question_type), intent(in) :: question  !< the question
    character(len=:), allocatable :: text

    if (question%kind == ask_units) then
      text = 'units in this file and its results: lengths in m, mm or in, angles in rad or deg; if you like, also forces in '// &
             'N, kN or lbf, masses in kg, g, t or lb, rates of angles in rad/s, deg/s or rpm. For example: mm deg'
      return
    end if
    associate (row => item_table(question%row))
      text = trim(row%name)//': '//trim(row%help)
      if (row%words /= '') text = text//' ('//words_allowed(values_text(row))//')'
    end associate
  end function gist_of

  !> The part of a description such as "text: fixed or link" that stands behind the colon.
  pure function words_allowed(values) result(words)
    character(len=*), intent(in) :: values  !< a description such as "text: fixed or link"
    character(len=:), allocatable :: words

    words = values(index(values, ': ') + 2:)
  end function words_allowed

  !> The answer to `?`.
  pure function help_of(question, draft, outline) result(text)
    type(question_type), intent(in) :: question  !< the question
    type(draft_type), intent(in) :: draft        !< groups and names with their values as text
    type(outline_type), intent(in) :: outline    !< facts known beside the draft
    character(len=:), allocatable :: text, names

    select case (question%kind)
    case (ask_way)
      text = 'The structure says which links are joined by which pairs. It can be given in three ways:'//line_end// &
             'pairs: you are asked, pair by pair, which two links it joins. For example: 1 2 (or 1-2).'//line_end// &
             'matrix: you are asked for the rows of the coincidence matrix C. For example: 0 1 0 4.'//line_end// &
             'vectors: you are asked for the second set: the lists nrg, nws, rdw and nrw.'//line_end// &
             'The first letter will do.'
    case (ask_seldom)
      names = seldom_names(question, outline)
      text = 'These names have defaults that mostly serve:'//line_end//list_of_seldom(question, outline)// &
             'Answer yes to be asked for all of them, or name those that you want to give.'//line_end//'For example: '// &
             names(:index(names//',', ',') - 1)
    case (ask_joints)
      text = 'Some joints have several freedoms: spherical (a ball joint) and planar have three coordinates, universal and '// &
             'cylindrical two, free six. Name each by its first coordinate and its kind, with commas between; the joint has '// &
             'the coordinates that follow, too. Its first coordinate stands for it in C and in nws.'//line_end// &
             'For example: 4 spherical, 7 universal (coordinates 4, 5, 6 and 7, 8)'
    case (ask_geometry)
      text = 'By lengths you say how far apart the pairs of each link are, in a system that the link has for itself. Where a '// &
             'pair does not lie on the line between the first two, give x and y there. By points you give the points and '// &
             'directions of all pairs by three numbers, in one position or in systems of your own.'
    case (ask_units)
      text = 'Numbers without a unit, in this file and in its results, are in these units. Name those that differ from the '// &
             'brackets, in any order, with blanks between. Torques and energies are force times length, moments of inertia '// &
             'mass times length^2, times are in s. Later answers may name other units, as 80 mm, 3000 rpm, 0.5 kg: they are '// &
             'converted.'//line_end//'For example: mm deg (also: mm deg kN rpm)'
    case (ask_guesses)
      text = 'The same links can be put together in several ways. Rough values of the dependent coordinates choose '// &
             'one; without them the search starts from zeros, the position in which the mechanism is described. '// &
             'Answer yes to be asked for them.'
    case default
      text = help_on_name(question, draft, outline)
    end select
    text = text//line_end//'Enter takes what stands in brackets. Also: back (to the question before), list (what is '// &
           'known), default (as if never answered), quit (what was typed is kept).'
    if (question%kind /= ask_item .or. question%is_new) return
    if (can_be_left_out(question%group_row, outline%program)) &
      text = text//' remove leaves out the '//trim(item_table(question%row)%group)// &
                                                    ' that is asked about.'
  end function help_of

  !> The rarely used names of a group, each with its meaning in a line.
  pure function list_of_seldom(question, outline) result(text)
    type(question_type), intent(in) :: question  !< the question
    type(outline_type), intent(in) :: outline    !< facts known beside the draft
    character(len=:), allocatable :: text
    integer, allocatable :: rows(:)
    integer :: i

    text = ''
    rows = seldom_rows(outline, question%group_row)
    do i = 1, size(rows)
      text = text//trim(item_table(rows(i))%name)//': '//trim(item_table(rows(i))%help)//line_end
    end do
  end function list_of_seldom

  !> The explanation of a name, the values it takes, and an example in the unit that is asked for.
  pure function help_on_name(question, draft, outline) result(text)
    type(question_type), intent(in) :: question  !< the question
    type(draft_type), intent(in) :: draft        !< groups and names with their values as text
    type(outline_type), intent(in) :: outline    !< facts known beside the draft
    character(len=:), allocatable :: text, unit, otherwise
    integer :: place

    associate (row => item_table(question%row))
      place = find_explanation(trim(row%group), trim(row%name), trim(row%kinds))
      text = gist_of(question)
      if (place > 0) text = trim(row%name)//': '//trim(explanations(place)%text)
      unit = unit_here(question, draft)
      if (unit /= '') unit = ' ('//unit//')'
      otherwise = 'if not given: '//default_text(row)
      if (is_needed(question, draft, outline) .or. row%needed) otherwise = 'must be given'
      if (question%is_new) otherwise = 'Enter where there is no more'
      if (question%is_new .and. .not. group_table(question%group_row)%repeats) otherwise = 'Enter where there is none'
      text = text//line_end//'Values: '//values_text(row)//unit//'; '//otherwise//'.'//line_end//'For example: '// &
             example_here(question, draft, example_of(row, place, coordinate_kind(question, draft), angle_unit(draft)))
    end associate
  end function help_on_name

  !> An example of an answer, in the unit of the coordinate that is meant.
  pure function example_of(row, place, kind, angle) result(text)
    type(item_row_type), intent(in) :: row  !< row of the table of names
    integer, intent(in) :: place            !< number of the explanation; 0: none
    character(len=*), intent(in) :: kind    !< kind of the pair whose coordinate is meant; empty: no coordinate is meant
    character(len=*), intent(in) :: angle   !< unit of angles, rad or deg
    character(len=:), allocatable :: text

    text = unquoted(trim(row%example))
    if (place == 0 .or. kind == 'user') return
    associate (explanation => explanations(place))
      text = trim(explanation%example)
      if (angle == 'deg' .and. explanation%degrees /= '') text = trim(explanation%degrees)
      if ((kind == 'prismatic' .or. kind == 'path') .and. explanation%length /= '') text = trim(explanation%length)
    end associate
  end function example_of

  !> An example with its numbers in the units of this data file. The words behind them name their units.
  pure function example_here(question, draft, example) result(text)
    type(question_type), intent(in) :: question  !< the question
    type(draft_type), intent(in) :: draft        !< groups and names with their values as text
    character(len=*), intent(in) :: example      !< numbers in m, N, kg, rad or deg, and words about them in brackets
    character(len=:), allocatable :: text
    character(len=part_length), allocatable :: wanted(:)
    type(units_type) :: of_example, units
    real(wp) :: number
    integer :: first, last, n, iostat

    text = example
    if (item_table(question%row)%type /= 'real') return
    of_example = units_of_words('m', angle_unit(draft), 'N', 'kg', '')
    units = units_of_draft(draft)
    call si_units_here(question, draft, wanted)
    text = ''
    first = 1
    n = 0
    do while (first <= len(example))
      last = first + scan(example(first:)//',', ',(') - 2
      read (example(first:last), *, iostat=iostat) number
      n = min(n + 1, size(wanted))
      if (iostat /= 0 .or. verify(trim(adjustl(example(first:last))), '0123456789.eE+-') > 0) exit
      number = number*(of_example%size_of(wanted(n))/units%size_of(wanted(n)))
      if (n > 1 .or. text /= '') text = text//', '
      text = text//to_text(number, 6)
      first = last + 2
      if (last + 1 > len(example)) return
      if (example(last + 1:last + 1) == ',') cycle
      text = text//' '//example(last + 1:)
      return
    end do
    text = example
  end function example_here

  !> The text for an empty answer to a question without a default.
  pure function refusal_of_enter(question) result(text)
    type(question_type), intent(in) :: question  !< the question
    character(len=:), allocatable :: text

    text = 'This must be given; ? explains it.'
    if (item_table(question%row)%group == 'gravity') &
      text = 'Gravity must be given: -y (9.81 m/s^2 against y), other components, or none; ? explains it.'
  end function refusal_of_enter
end module mech9_question_help
