!> A model that follows changed numbers of its document: only the groups in which they stand are read again, and what depends on
!> them.
!>
!> The result has the same bits as reading the whole document. Groups on whose numbers more depends (times, tolerances, numbers of
!> the user, tables and the user's procedures) are not served here: with a change in one of them the whole document is read.
module mech9_changed_groups
  use mech9_document, only: document_type, group_type
  use mech9_lookup, only: groups_named, get_text, has_name
  use mech9_load, only: load_slot_type
  use mech9_coupling, only: coupling_slot_type
  use mech9_model, only: model_type
  use mech9_pair_reader, only: read_pair_group
  use mech9_motion_reader, only: read_initial, read_point
  use mech9_coupling_reader, only: read_coupling
  use mech9_drive_reader, only: read_drive_group
  use mech9_drive_check, only: check_drives
  use mech9_body_reader, only: read_bodies, read_gravity
  use mech9_load_reader, only: read_load
  use mech9_cam_reader, only: read_cams
  use mech9_diagnostics, only: diagnostics_type
  implicit none
  private
  public :: group_map_type, map_groups, read_changed

  !> The groups of a document, for reading some of them again.
  type :: group_map_type
    logical, allocatable :: is_alone(:)   !< (groups) it can be read again without the whole document
    integer, allocatable :: place(:)      !< (groups) its place among the groups of its name
  end type group_map_type

contains

  !> Find which groups can be read again alone. A group that is not sound never is.
  pure subroutine map_groups(document, map)
    type(document_type), intent(in) :: document   !< checked
    type(group_map_type), intent(out) :: map      !< of its groups
    integer, allocatable :: numbers(:)
    integer :: i, j

    allocate (map%is_alone(size(document%groups)), source=.false.)
    allocate (map%place(size(document%groups)), source=0)
    do i = 1, size(document%groups)
      if (.not. document%groups(i)%sound .or. map%place(i) > 0) cycle
      numbers = groups_named(document, document%groups(i)%name)
      map%place(numbers) = [(j, j=1, size(numbers))]
    end do
    do i = 1, size(document%groups)
      if (map%place(i) > 0) map%is_alone(i) = can_be_read_alone(document%groups(i))
    end do
    ! laws over points, and contacts, keep the places of these
    do i = 1, size(document%groups)
      if (document%groups(i)%name == 'point' .and. any(keeps_point(document%groups))) map%is_alone(i) = .false.
    end do
  end subroutine map_groups

  !> Whether what is read from a group keeps the place of a point.
  elemental logical function keeps_point(group)
    type(group_type), intent(in) :: group   !< a group

    keeps_point = group%name == 'contact'
    if ((group%name /= 'load' .and. group%name /= 'motor') .or. .not. group%sound) return
    if (has_name(group, 'over')) keeps_point = index(get_text(group, 'over'), '.') > 0
  end function keeps_point

  !> Whether a group can be read again without the whole document.
  pure logical function can_be_read_alone(group) result(alone)
    type(group_type), intent(in) :: group   !< a sound group

    select case (group%name)
    case ('initial', 'point', 'body', 'gravity', 'cam')
      alone = .true.
    case ('pair')
      alone = all(get_text(group, 'kind') /= ['path', 'user'])
    case ('drive', 'coupling')
      alone = all(get_text(group, 'kind') /= ['table', 'user '])
    case ('load')
      alone = get_text(group, 'kind') /= 'user'
      if (alone .and. has_name(group, 'law')) alone = get_text(group, 'law') /= 'table'
    case default
      alone = .false.
    end select
  end function can_be_read_alone

  !> Read groups again. The model is of use only where nothing is reported.
  subroutine read_changed(document, changed, map, model, diagnostics)
    type(document_type), intent(in) :: document           !< checked, with the new numbers
    logical, intent(in) :: changed(:)                     !< (groups) numbers of the group have changed; it can be read alone
    type(group_map_type), intent(in) :: map               !< of the groups
    type(model_type), intent(inout) :: model              !< with the numbers before, and without held rods; gets the new ones
    type(diagnostics_type), intent(inout) :: diagnostics  !< gets the errors
    type(load_slot_type) :: load
    logical :: pairs, initials, drives, bodies, cams
    integer :: i

    pairs = .false.
    initials = .false.
    drives = .false.
    bodies = .false.
    cams = .false.
    do i = 1, size(changed)
      if (.not. changed(i)) cycle
      associate (m => model%mechanism, at => map%place(i))
        select case (document%groups(i)%name)
        case ('pair')
          pairs = .true.
          call read_pair_group(document, i, m, diagnostics)
        case ('point')
          call read_point(document%groups(i), m%structure%shown_links(), m%points(at), diagnostics)
        case ('drive')
          drives = .true.
          call read_drive_group(document, i, m, model%request%time%start, model%problem%drives(at), diagnostics)
        case ('load')
          call read_load(document, i, m, load, diagnostics)
          call move_alloc(load%load, m%loads(at)%load)
        case ('gravity')
          m%gravity = read_gravity(document)
        case ('initial')
          initials = .true.
        case ('body')
          bodies = .true.
        case ('cam')
          cams = .true.
        end select
      end associate
    end do
    associate (m => model%mechanism, problem => model%problem)
      if (initials) call read_initial(document, problem%partition, m%pairs, m%units, problem%initial, diagnostics)
      call read_couplings_again(document, changed, initials, model, diagnostics)
      ! the axes of the pairs tell whether the tensor of a link is enough, and how cams turn
      if (bodies .or. (pairs .and. size(m%bodies) > 0)) call read_bodies(document, m%structure, m%pairs, m%bodies, diagnostics)
      if (cams .or. (pairs .and. size(model%request%cams) > 0)) &
        call read_cams(document, m%structure, m%pairs, model%request%cams, diagnostics)
      if (drives .or. initials) call check_drives(document, model, diagnostics)
    end associate
  end subroutine read_changed

  !> Read the couplings again whose numbers have changed, or whose constants follow from initial positions that have.
  subroutine read_couplings_again(document, changed, initials, model, diagnostics)
    type(document_type), intent(in) :: document           !< checked, with the new numbers
    logical, intent(in) :: changed(:)                     !< (groups) numbers of the group have changed
    logical, intent(in) :: initials                       !< initial positions have changed
    type(model_type), intent(inout) :: model              !< gets the couplings
    type(diagnostics_type), intent(inout) :: diagnostics  !< gets the errors
    type(coupling_slot_type) :: slot
    integer, allocatable :: numbers(:)
    integer :: i

    if (size(model%mechanism%couplings) == 0) return
    numbers = groups_named(document, 'coupling')
    do i = 1, size(numbers)
      if (.not. changed(numbers(i))) then
        if (.not. initials .or. get_text(document%groups(numbers(i)), 'kind') == 'table') cycle
      end if
      associate (m => model%mechanism)
        call read_coupling(document, numbers(i), i, model%problem%initial%position, m, slot, diagnostics)
        call move_alloc(slot%coupling, m%couplings(i)%coupling)
      end associate
    end do
  end subroutine read_couplings_again
end module mech9_changed_groups
