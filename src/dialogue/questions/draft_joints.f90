!> The pairs of a draft by their coordinates. A joint with several freedoms is one group &pair with several coordinates, the first
!> of which is its number.
module mech9_draft_joints
  use mech9_text, only: to_text, lower
  use mech9_grammar, only: item_table, words_of
  use mech9_item_rows, only: item_row_for_kind
  use mech9_compound_joint, only: compound_kinds, is_compound
  use mech9_short_answers, only: full_form
  use mech9_draft, only: draft_type, integer_of, unquoted
  implicit none
  private
  public :: kind_in, numbers_in, coordinates_of_pair, pair_with, number_in, kind_of_coordinate
  public :: settle_joints, has_joints, joints_text, give_joints

contains

  !> The kind of a group, in lower case, and after a blank its law, as in law:harmonic; empty if it has none.
  pure function kind_in(draft, group) result(kind)
    type(draft_type), intent(in) :: draft  !< groups and names with their values as text
    integer, intent(in) :: group           !< index of the group in the draft
    character(len=:), allocatable :: kind
    integer :: i

    kind = ''
    associate (entries => draft%groups(group)%entries)
      do i = 1, size(entries)
        if (entries(i)%name == 'kind') kind = lower(unquoted(entries(i)%text))
      end do
      do i = 1, size(entries)
        if (entries(i)%name == 'law') kind = kind//' law:'//lower(unquoted(entries(i)%text))
      end do
    end associate
  end function kind_in

  !> The coordinates of a pair, one of a plain pair; none where they are not given yet.
  pure function coordinates_of_pair(draft, place) result(numbers)
    type(draft_type), intent(in) :: draft  !< groups and names with their values as text
    integer, intent(in) :: place           !< place of the pair among the pairs, from 1
    integer, allocatable :: numbers(:)
    character(len=:), allocatable :: text

    text = draft%value('pair', place, 'coordinates')
    if (text == '') text = draft%value('pair', place, 'coordinate')
    numbers = numbers_in(text)
  end function coordinates_of_pair

  !> The whole numbers of a value such as "4, 5, 6"; 0 for a word that is none.
  pure function numbers_in(text) result(numbers)
    character(len=*), intent(in) :: text  !< a value as a data file writes it
    integer, allocatable :: numbers(:)
    character(len=len(text)) :: plain
    integer :: i

    plain = text
    do i = 1, len(plain)
      if (plain(i:i) == ',') plain(i:i) = ' '
    end do
    associate (words => words_of(plain))
      numbers = [(integer_of(trim(words(i))), i=1, size(words))]
    end associate
  end function numbers_in

  !> The place of the pair that has a coordinate, among the pairs; 0 if there is none.
  pure integer function pair_with(draft, coordinate) result(place)
    type(draft_type), intent(in) :: draft  !< groups and names with their values as text
    integer, intent(in) :: coordinate      !< number of the coordinate

    do place = draft%count_of('pair'), 1, -1
      if (any(coordinates_of_pair(draft, place) == coordinate)) return
    end do
  end function pair_with

  !> The coordinate that a group names, of a joint with several freedoms the first; 0 if it names none.
  pure integer function number_in(draft, group, place) result(number)
    type(draft_type), intent(in) :: draft  !< groups and names with their values as text
    character(len=*), intent(in) :: group  !< name of the group
    integer, intent(in) :: place           !< place among the groups of that name, from 1

    number = draft%number(group, place, 'coordinate')
    if (group /= 'pair') return
    associate (numbers => coordinates_of_pair(draft, place))
      if (size(numbers) > 0) number = numbers(1)
    end associate
  end function number_in

  !> The number of coordinates of a kind of pairs: 1 of plain pairs and of unknown kinds.
  pure integer function freedoms_of(kind)
    character(len=*), intent(in) :: kind  !< kind in lower case; empty: unknown

    freedoms_of = 1
    if (is_compound(kind)) freedoms_of = item_table(item_row_for_kind('pair', 'coordinates', kind))%low
  end function freedoms_of

  !> Whether the draft has joints with several freedoms.
  pure logical function has_joints(draft)
    type(draft_type), intent(in) :: draft  !< groups and names with their values as text
    integer :: i

    has_joints = .false.
    do i = 1, draft%count_of('pair')
      has_joints = has_joints .or. is_compound(kind_in(draft, draft%find('pair', i)))
    end do
  end function has_joints

  !> The kind of motion of a coordinate: the kind of its pair, and prismatic or revolute in a joint with several
  !> freedoms. It is empty where it is not known.
  pure function kind_of_coordinate(draft, coordinate) result(kind)
    type(draft_type), intent(in) :: draft  !< groups and names with their values as text
    integer, intent(in) :: coordinate      !< number of the coordinate
    character(len=:), allocatable :: kind
    integer :: place, i
    logical :: slides

    kind = ''
    place = pair_with(draft, coordinate)
    if (place == 0 .or. coordinate == 0) return
    kind = kind_in(draft, draft%find('pair', place))
    if (.not. is_compound(kind)) return
    i = findloc(coordinates_of_pair(draft, place), coordinate, dim=1)
    slides = (kind == 'cylindrical' .and. i == 2) .or. (kind == 'planar' .and. i <= 2) .or. (kind == 'free' .and. i <= 3)
    kind = trim(merge('prismatic', 'revolute ', slides))
  end function kind_of_coordinate

  !> Give each pair as many coordinates as its kind has: where the kind has changed, the number of the pair and those
  !> after it. Remove plain pairs of coordinates that belong to such a joint.
  pure subroutine settle_joints(draft, dropped)
    type(draft_type), intent(inout) :: draft               !< groups and names with their values as text
    character(len=:), allocatable, intent(out) :: dropped  !< pairs with data that were removed, with commas between; empty: none
    character(len=:), allocatable :: kind
    integer, allocatable :: numbers(:)
    integer :: place, i

    dropped = ''
    do place = 1, draft%count_of('pair')
      kind = kind_in(draft, draft%find('pair', place))
      numbers = coordinates_of_pair(draft, place)
      if (size(numbers) == 0) cycle
      if (is_compound(kind)) then
        if (size(numbers) /= freedoms_of(kind)) then
          numbers = [(numbers(1) + i, i=0, freedoms_of(kind) - 1)]
          call draft%give('pair', place, 'coordinates', to_text(numbers))
        end if
        call draft%take_away('pair', place, 'coordinate')
      else if (draft%has('pair', place, 'coordinates')) then
        call draft%take_away('pair', place, 'coordinates')
        call draft%give('pair', place, 'coordinate', to_text(numbers(1)))
      end if
    end do
    if (has_joints(draft)) call remove_covered(draft, dropped)
  end subroutine settle_joints

  !> Remove plain pairs of coordinates that belong to a joint with several freedoms.
  pure subroutine remove_covered(draft, dropped)
    type(draft_type), intent(inout) :: draft                  !< groups and names with their values as text
    character(len=:), allocatable, intent(inout) :: dropped   !< gets the pairs with data that were removed, with commas between
    logical :: covered
    integer :: place, other, k, j

    do place = draft%count_of('pair'), 1, -1
      k = draft%number('pair', place, 'coordinate')
      if (k == 0 .or. draft%has('pair', place, 'coordinates')) cycle
      covered = .false.
      do other = 1, draft%count_of('pair')
        if (draft%has('pair', other, 'coordinates')) covered = covered .or. any(coordinates_of_pair(draft, other) == k)
      end do
      if (.not. covered) cycle
      associate (entries => draft%groups(draft%find('pair', place))%entries)
        if (any([(entries(j)%name /= 'coordinate' .and. entries(j)%name /= 'links', j=1, size(entries))])) then
          if (dropped /= '') dropped = ', '//dropped
          dropped = 'pair '//to_text(k)//dropped
        end if
      end associate
      call draft%remove('pair', place)
    end do
  end subroutine remove_covered

  !> The joints with several freedoms by their numbers and kinds, such as "4 spherical, 8 universal"; empty: there are none.
  pure function joints_text(draft) result(text)
    type(draft_type), intent(in) :: draft  !< groups and names with their values as text
    character(len=:), allocatable :: text
    character(len=:), allocatable :: kind
    integer :: place

    text = ''
    do place = 1, draft%count_of('pair')
      kind = kind_in(draft, draft%find('pair', place))
      if (.not. is_compound(kind)) cycle
      if (text /= '') text = text//', '
      text = text//to_text(number_in(draft, 'pair', place))//' '//kind
    end do
  end function joints_text

  !> Replace the joints with several freedoms by those of an answer such as "4 spherical, 8 universal". Others become
  !> plain pairs without a kind. A joint that stays as it was keeps its data.
  pure subroutine give_joints(draft, answer, problem)
    type(draft_type), intent(inout) :: draft               !< groups and names with their values as text
    character(len=*), intent(in) :: answer                 !< numbers and kinds in turn, with blanks or commas between; empty: none
    character(len=:), allocatable, intent(out) :: problem  !< the reason against the answer; empty: it is taken
    integer, allocatable :: firsts(:), kinds(:)
    character(len=:), allocatable :: kind, dropped
    integer :: place, i

    call read_joints(answer, draft%number('mechanism', 1, 'coordinates'), firsts, kinds, problem)
    if (problem /= '') return
    do place = 1, draft%count_of('pair')
      kind = kind_in(draft, draft%find('pair', place))
      if (.not. is_compound(kind)) cycle
      if (any(firsts == number_in(draft, 'pair', place) .and. compound_kinds(kinds) == kind)) cycle
      call draft%take_away('pair', place, 'kind')
    end do
    call settle_joints(draft, dropped)
    do i = 1, size(firsts)
      place = pair_with(draft, firsts(i))
      if (place == 0) then
        place = draft%count_of('pair') + 1
        call draft%give('pair', place, 'coordinate', to_text(firsts(i)))
      end if
      call draft%give('pair', place, 'kind', ''''//trim(compound_kinds(kinds(i)))//'''')
    end do
  end subroutine give_joints

  !> Read the numbers and kinds of joints.
  pure subroutine read_joints(answer, m, firsts, kinds, problem)
    character(len=*), intent(in) :: answer                 !< numbers and kinds in turn, with blanks or commas between
    integer, intent(in) :: m                               !< number of coordinates of the mechanism
    integer, allocatable, intent(out) :: firsts(:)         !< first coordinate of each joint
    integer, allocatable, intent(out) :: kinds(:)          !< kind of each joint, as a place in compound_kinds
    character(len=:), allocatable, intent(out) :: problem  !< the reason against the answer; empty: it is right
    integer, parameter :: longest = 4000
    character(len=:), allocatable :: plain, kind
    character(len=:), allocatable :: words(:)
    logical, allocatable :: taken(:)
    integer :: i, k, last

    problem = 'Answer none, or the first coordinate and the kind of each joint, such as: 4 spherical, 7 universal'
    allocate (firsts(0), kinds(0))
    allocate (taken(max(m, 0)), source=.false.)
    if (len(answer) > longest) return
    plain = answer
    do i = 1, len(plain)
      if (plain(i:i) == ',') plain(i:i) = ' '
    end do
    words = words_of(plain)
    if (mod(size(words), 2) /= 0) return
    do i = 1, size(words), 2
      k = integer_of(trim(words(i)))
      if (k < 1 .or. k > m) return
      kind = full_form(item_table(item_row_for_kind('pair', 'kind', '')), trim(words(i + 1)))
      if (.not. is_compound(kind)) return
      last = k + freedoms_of(kind) - 1
      if (last > m) then
        problem = 'The joint '//to_text(k)//' has the coordinates '//to_text(k)//' to '//to_text(last)//', and there are '// &
                  to_text(m)//'.'
        return
      else if (any(taken(k:last))) then
        problem = 'The joint '//to_text(k)//' has the coordinates '//to_text(k)//' to '//to_text(last)// &
                  ', and some of them belong to another joint.'
        return
      end if
      taken(k:last) = .true.
      firsts = [firsts, k]
      kinds = [kinds, findloc(compound_kinds == kind, .true., dim=1)]
    end do
    problem = ''
  end subroutine read_joints
end module mech9_draft_joints
