!> The facts that a conversation knows beside the draft, and the groups that follow from them. They are the way in which
!> the structure is given, the rarely used names that the user wants, and the independent coordinates.
module mech9_outline
  use mech9_program_kind, only: kinematics
  use mech9_text, only: to_text
  use mech9_grammar, only: item_table
  use mech9_item_rows, only: find_item_rows, item_row_for_kind
  use mech9_draft, only: draft_type, plain_name
  use mech9_draft_joints, only: kind_in, coordinates_of_pair, number_in, settle_joints
  implicit none
  private
  public :: outline_type, ways, new_outline, make_pairs, make_groups, drop_empty_guesses, drop_foreign, wants_forces

  !> The ways to give the structure: the links of each pair, the rows of the coincidence matrix, or the second set.
  character(len=7), parameter :: ways(3) = [character(len=7) :: 'pairs', 'matrix', 'vectors']

  !> The facts known beside the draft.
  type :: outline_type
    integer :: program = kinematics
    character(len=7) :: way = ways(1)                       !< way in which the structure is given, one of `ways`
    logical :: asked(size(item_table)) = .false.            !< rarely used names that the user wants to give
    logical :: lengths = .false.                            !< lengths of planar links give the geometry
    logical :: guesses = .false.                            !< guesses of the dependent coordinates at the start are wanted
    logical :: structure_known = .false.
    logical, allocatable :: independent(:)                  !< (M) which coordinates are independent, once the structure is known
    integer, allocatable :: links(:, :)                     !< (2,M) links of the pairs, of a joint at its first coordinate, once the structure is known
  end type outline_type

contains

  !> The outline that follows from the values in a draft.
  pure function new_outline(program, draft) result(outline)
    integer, intent(in) :: program                !< kinematics or dynamics
    type(draft_type), intent(in) :: draft         !< groups and names with their values as text
    type(outline_type) :: outline
    integer :: i, j, row

    outline%program = program
    allocate (outline%independent(0), outline%links(2, 0))
    do i = 1, size(draft%groups)
      associate (group => draft%groups(i))
        do j = 1, size(group%entries)
          row = item_row_for_kind(group%name, plain_name(group%entries(j)%name), kind_in(draft, i))
          if (row > 0) outline%asked(row) = .true.
          if (group%name /= 'structure') cycle
          if (plain_name(group%entries(j)%name) == 'c') outline%way = 'matrix'
          if (group%entries(j)%name == 'nrg') outline%way = 'vectors'
        end do
      end associate
    end do
  end function new_outline

  !> Whether the results of the draft hold forces, for which bodies, gravity and loads count in mech9k, too.
  pure logical function wants_forces(draft)
    type(draft_type), intent(in) :: draft  !< groups and names with their values as text
    character(len=12), parameter :: names(3) = [character(len=12) :: 'reactions', 'drive_forces', 'force_arrows']
    integer :: i

    wants_forces = draft%has('output', 1, 'reaction_pairs')
    do i = 1, size(names)
      if (draft%has('output', 1, trim(names(i)))) &
        wants_forces = wants_forces .or. scan(draft%value('output', 1, trim(names(i)))//' ', 'tT') > 0
    end do
  end function wants_forces

  !> Make pairs for the coordinates that have none, and give each pair as many coordinates as its kind has.
  pure subroutine make_pairs(draft, dropped)
    type(draft_type), intent(inout) :: draft               !< groups and names with their values as text
    character(len=:), allocatable, intent(out) :: dropped  !< pairs with data that were removed, with commas between; empty: none
    logical :: all(max(draft%number('mechanism', 1, 'coordinates'), 0))

    all = .true.
    call settle_joints(draft, dropped)
    call make_numbered(draft, 'pair', all)
  end subroutine make_pairs

  !> Make the groups that are needed beside the pairs. Each independent coordinate gets a drive or initial values (in
  !> mech9d initial values if it has no drive). Other coordinates get guesses if these are wanted.
  pure subroutine make_groups(draft, outline)
    type(draft_type), intent(inout) :: draft   !< groups and names with their values as text
    type(outline_type), intent(in) :: outline  !< facts known beside the draft

    if (.not. outline%structure_known) return
    if (outline%way /= 'pairs') call give_links(draft, outline%links)
    if (outline%program == kinematics) then
      call make_numbered(draft, 'drive', outline%independent)
    else
      call drop_driven_starts(draft)
      call make_numbered(draft, 'initial', outline%independent .and. .not. has_drive(draft, size(outline%independent)))
    end if
    if (outline%guesses) call make_numbered(draft, 'initial', .not. outline%independent)
  end subroutine make_groups

  !> Remove initial values of driven coordinates if they hold nothing but their coordinate: their drives give the
  !> values.
  pure subroutine drop_driven_starts(draft)
    type(draft_type), intent(inout) :: draft  !< groups and names with their values as text
    integer :: i, k, place

    do i = 1, draft%count_of('drive')
      k = draft%number('drive', i, 'coordinate')
      do place = draft%count_of('initial'), 1, -1
        if (draft%number('initial', place, 'coordinate') /= k) cycle
        if (size(draft%groups(draft%find('initial', place))%entries) < 2) call draft%remove('initial', place)
      end do
    end do
  end subroutine drop_driven_starts

  !> Whether the draft drives each coordinate.
  pure function has_drive(draft, m)
    type(draft_type), intent(in) :: draft  !< groups and names with their values as text
    integer, intent(in) :: m               !< number of coordinates
    logical :: has_drive(m)
    integer :: k, place

    has_drive = .false.
    do place = 1, draft%count_of('drive')
      k = draft%number('drive', place, 'coordinate')
      if (k >= 1 .and. k <= m) has_drive(k) = .true.
    end do
  end function has_drive

  !> Give the pairs their links from the structure, unless they have them already in either order.
  pure subroutine give_links(draft, links)
    type(draft_type), intent(inout) :: draft  !< groups and names with their values as text
    integer, intent(in) :: links(:, :)        !< (2,M) reference link and moving link of each pair; of a joint at its first coordinate
    integer :: k, place
    character(len=:), allocatable :: given

    do place = 1, draft%count_of('pair')
      k = number_in(draft, 'pair', place)
      if (k < 1 .or. k > size(links, 2)) cycle
      given = draft%value('pair', place, 'links')
      if (given == to_text(links(:, k)) .or. given == to_text(links(2:1:-1, k))) cycle
      call draft%give('pair', place, 'links', to_text(links(:, k)))
    end do
  end subroutine give_links

  !> Make a group for each wanted coordinate that has none yet.
  pure subroutine make_numbered(draft, group, wanted)
    type(draft_type), intent(inout) :: draft  !< groups and names with their values as text
    character(len=*), intent(in) :: group     !< name of the groups
    logical, intent(in) :: wanted(:)          !< (M) coordinates that need a group
    logical :: there(size(wanted))
    integer, allocatable :: numbers(:)
    integer :: k, place

    there = .false.
    do place = 1, draft%count_of(group)
      numbers = [draft%number(group, place, 'coordinate')]
      if (group == 'pair') numbers = coordinates_of_pair(draft, place)
      there(pack(numbers, numbers >= 1 .and. numbers <= size(there))) = .true.
    end do
    place = draft%count_of(group)
    do k = 1, size(wanted)
      if (there(k) .or. .not. wanted(k)) cycle
      place = place + 1
      call draft%give(group, place, 'coordinate', to_text(k))
    end do
  end subroutine make_numbered

  !> Remove initial values if they hold nothing but their coordinate.
  pure subroutine drop_empty_guesses(draft)
    type(draft_type), intent(inout) :: draft  !< groups and names with their values as text
    integer :: place

    do place = draft%count_of('initial'), 1, -1
      if (size(draft%groups(draft%find('initial', place))%entries) < 2) call draft%remove('initial', place)
    end do
  end subroutine drop_empty_guesses

  !> Remove names that do not belong to a group since its kind has changed. Remove also drives and velocities of
  !> coordinates that are no longer independent.
  pure subroutine drop_foreign(draft, outline, dropped)
    type(draft_type), intent(inout) :: draft               !< groups and names with their values as text
    type(outline_type), intent(in) :: outline              !< facts known beside the draft
    character(len=:), allocatable, intent(out) :: dropped  !< names that were removed, with commas between; empty: nothing
    character(len=:), allocatable :: name, entry_name
    integer :: i, j, k, place

    dropped = ''
    do i = size(draft%groups), 1, -1
      name = draft%groups(i)%name
      place = draft%place_of(i)
      do j = size(draft%groups(i)%entries), 1, -1
        entry_name = draft%groups(i)%entries(j)%name
        if (.not. is_foreign(draft, i, entry_name)) cycle
        call note(name//' '//entry_name, dropped)
        call draft%take_away(name, place, entry_name)
      end do
      if (.not. outline%structure_known) cycle
      k = draft%number(name, place, 'coordinate')
      if (k < 1 .or. k > size(outline%independent)) cycle
      if (outline%independent(k)) cycle
      if (name == 'drive') then
        ! a drive without values is removed without a message
        if (size(draft%groups(i)%entries) > 1) call note('drive '//to_text(k), dropped)
        call draft%remove(name, place)
      else if (name == 'initial' .and. draft%has(name, place, 'velocity')) then
        call note('velocity '//to_text(k), dropped)
        call draft%take_away(name, place, 'velocity')
      end if
    end do
  end subroutine drop_foreign

  !> Put a name in front of a list.
  pure subroutine note(what, list)
    character(len=*), intent(in) :: what                  !< name that is put in front
    character(len=:), allocatable, intent(inout) :: list  !< names with commas between

    if (list /= '') list = ', '//list
    list = what//list
  end subroutine note

  !> Whether a name of the grammar does not belong to the kind of its group.
  pure logical function is_foreign(draft, group, name)
    type(draft_type), intent(in) :: draft  !< groups and names with their values as text
    integer, intent(in) :: group           !< index of the group in the draft
    character(len=*), intent(in) :: name   !< name with its subscript
    character(len=:), allocatable :: kind

    is_foreign = .false.
    kind = kind_in(draft, group)
    if (kind == '' .or. name == 'kind') return
    if (size(find_item_rows(draft%groups(group)%name, plain_name(name))) == 0) return
    is_foreign = item_row_for_kind(draft%groups(group)%name, plain_name(name), kind) == 0
  end function is_foreign
end module mech9_outline
