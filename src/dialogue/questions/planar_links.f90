!> The geometry of a planar mechanism by the lengths of its links.
!>
!> Each link gets a system of its own. Its origin is in the pair with the lowest number on the link, and its x axis leads to the next
!> pair. Lengths, or x and y, place the other pairs on the link. All axes of turns are z.
module mech9_planar_links
  use mech9_kinds, only: wp
  use mech9_grammar, only: words_of
  use mech9_draft, only: draft_type
  use mech9_draft_joints, only: kind_in, number_in, has_joints
  use mech9_outline, only: outline_type
  implicit none
  private
  public :: gives_lengths, may_be_planar, settle_planar_pairs, is_settled, is_placed, origin_pair, link_of_point, point_in_plane
  public :: plane_so_far, point_of_plane

contains

  !> Whether the counts speak for a planar mechanism with closed chains: it can move in a plane, but not in space.
  pure logical function may_be_planar(draft, outline)
    type(draft_type), intent(in) :: draft      !< groups and names with their values as text
    type(outline_type), intent(in) :: outline  !< facts known beside the draft
    integer :: chains, coordinates

    may_be_planar = outline%structure_known .and. .not. has_joints(draft)
    if (.not. may_be_planar) return
    coordinates = size(outline%links, 2)
    chains = coordinates - maxval(outline%links) + 1
    may_be_planar = coordinates >= 3*chains + 1 .and. coordinates < 6*chains + 1
  end function may_be_planar

  !> Whether lengths are the way to give the geometry unless the user wants another: they were chosen, or no pair has points yet.
  pure logical function gives_lengths(draft, outline)
    type(draft_type), intent(in) :: draft      !< groups and names with their values as text
    type(outline_type), intent(in) :: outline  !< facts known beside the draft
    integer :: place

    gives_lengths = outline%lengths
    if (gives_lengths) return
    do place = 1, draft%count_of('pair')
      if (draft%has('pair', place, 'point') .or. draft%has('pair', place, 'axis')) return
    end do
    gives_lengths = .true.
  end function gives_lengths

  !> Give pairs the numbers that follow from the choice of the systems: the axes of turns, and the origins.
  pure subroutine settle_planar_pairs(draft, outline)
    type(draft_type), intent(inout) :: draft   !< groups and names with their values as text
    type(outline_type), intent(in) :: outline  !< facts known beside the draft
    integer :: place

    if (.not. (outline%lengths .and. outline%structure_known)) return
    do place = 1, draft%count_of('pair')
      if (is_settled(draft, outline, place, 'axis') .and. .not. draft%has('pair', place, 'axis')) &
        call draft%give('pair', place, 'axis', '0, 0, 1')
      if (is_settled(draft, outline, place, 'moving_point') .and. .not. draft%has('pair', place, 'moving_point')) &
        call draft%give('pair', place, 'moving_point', '0, 0, 0')
    end do
  end subroutine settle_planar_pairs

  !> Whether the choice of the systems settles a name of a pair, so that nobody is asked for it.
  pure logical function is_settled(draft, outline, place, name)
    type(draft_type), intent(in) :: draft      !< groups and names with their values as text
    type(outline_type), intent(in) :: outline  !< facts known beside the draft
    integer, intent(in) :: place               !< place of the pair among the pairs, from 1
    character(len=*), intent(in) :: name       !< name of the group &pair

    if (name == 'axis') then
      is_settled = outline%lengths .and. kind_in(draft, draft%find('pair', place)) == 'revolute'
    else
      is_settled = is_placed(draft, outline, place, name)
      if (is_settled) is_settled = origin_pair(draft, outline, place, name) == number_in(draft, 'pair', place)
    end if
  end function is_settled

  !> Whether a name is a point of a pair that lengths place.
  pure logical function is_placed(draft, outline, place, name)
    type(draft_type), intent(in) :: draft      !< groups and names with their values as text
    type(outline_type), intent(in) :: outline  !< facts known beside the draft
    integer, intent(in) :: place               !< place of the pair among the pairs, from 1
    character(len=*), intent(in) :: name       !< name of the group &pair
    character(len=:), allocatable :: kind

    is_placed = outline%lengths .and. outline%structure_known .and. (name == 'point' .or. name == 'moving_point')
    if (.not. is_placed) return
    kind = kind_in(draft, draft%find('pair', place))
    is_placed = kind == 'revolute' .or. kind == 'prismatic'
  end function is_placed

  !> The pair in which the system of the link has its origin, on which a point of a pair lies.
  pure integer function origin_pair(draft, outline, place, name)
    type(draft_type), intent(in) :: draft      !< groups and names with their values as text
    type(outline_type), intent(in) :: outline  !< facts known beside the draft
    integer, intent(in) :: place               !< place of the pair among the pairs, from 1
    character(len=*), intent(in) :: name       !< point, or moving_point
    integer :: link

    link = link_of_point(draft, outline, place, name)
    do origin_pair = 1, size(outline%links, 2)
      if (any(outline%links(:, origin_pair) == link)) return
    end do
  end function origin_pair

  !> The link in whose system a point of a pair is given.
  pure integer function link_of_point(draft, outline, place, name)
    type(draft_type), intent(in) :: draft      !< groups and names with their values as text
    type(outline_type), intent(in) :: outline  !< facts known beside the draft
    integer, intent(in) :: place               !< place of the pair among the pairs, from 1
    character(len=*), intent(in) :: name       !< point, or moving_point

    link_of_point = outline%links(merge(1, 2, name == 'point'), number_in(draft, 'pair', place))
  end function link_of_point

  !> A point from what is typed: a distance along x, or x and y. Other answers stay as they are.
  pure function point_in_plane(line) result(text)
    character(len=*), intent(in) :: line   !< the answer, without blanks around it
    character(len=:), allocatable :: text
    character(len=len(line)) :: plain
    integer, parameter :: longest_point = 80
    integer :: i

    text = line
    if (line == '' .or. len(line) > longest_point) return
    plain = line
    do i = 1, len(plain)
      if (plain(i:i) == ',') plain(i:i) = ' '
    end do
    if (verify(plain, '0123456789+-.eEdD ') > 0) return
    select case (size(words_of(plain)))
    case (1)
      text = line//', 0, 0'
    case (2)
      text = line//', 0'
    end select
  end function point_in_plane

  !> The number of the axis of link 1 that stands at right angles to the plane of a mechanism that is planar so far: all axes of turns
  !> are along it, and slides are across it; z while no pair has an axis. 0 where the mechanism is not planar.
  pure integer function plane_so_far(draft) result(normal)
    type(draft_type), intent(in) :: draft      !< groups and names with their values as text
    real(wp) :: axis(3)
    character(len=:), allocatable :: kind, text
    logical :: may_be(3), is_known
    integer :: place, iostat, i

    normal = 0
    may_be = .true.
    is_known = .false.
    if (has_joints(draft)) return
    do place = 1, draft%count_of('pair')
      if (.not. draft%has('pair', place, 'axis')) cycle
      kind = kind_in(draft, draft%find('pair', place))
      text = draft%value('pair', place, 'axis')
      read (text, *, iostat=iostat) axis
      if (iostat /= 0) return
      is_known = .true.
      do i = 1, 3
        if (kind == 'prismatic') then
          may_be(i) = may_be(i) .and. .not. abs(axis(i)) > 0.0_wp
        else
          may_be(i) = may_be(i) .and. kind == 'revolute' .and. .not. any(abs(pack(axis, [1, 2, 3] /= i)) > 0.0_wp)
        end if
      end do
    end do
    if (.not. is_known .or. may_be(3)) then
      normal = 3
    else if (count(may_be) == 1) then
      normal = findloc(may_be, .true., dim=1)
    end if
  end function plane_so_far

  !> A point from two numbers that are its coordinates in a plane. Other answers stay as they are.
  pure function point_of_plane(line, normal) result(text)
    character(len=*), intent(in) :: line   !< the answer, without blanks around it
    integer, intent(in) :: normal          !< number of the axis at right angles to the plane
    character(len=:), allocatable :: text
    character(len=len(line)), allocatable :: words(:)
    character(len=len(line)) :: plain
    integer :: i

    text = line
    ! a length alone is no point here
    if (point_in_plane(line) /= line//', 0') return
    plain = line
    do i = 1, len(plain)
      if (plain(i:i) == ',') plain(i:i) = ' '
    end do
    words = words_of(plain)
    select case (normal)
    case (1)
      text = '0, '//trim(words(1))//', '//trim(words(2))
    case (2)
      text = trim(words(1))//', 0, '//trim(words(2))
    case default
      text = trim(words(1))//', '//trim(words(2))//', 0'
    end select
  end function point_of_plane
end module mech9_planar_links
