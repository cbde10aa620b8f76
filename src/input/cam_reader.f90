!> The groups &cam of a checked document: cams whose profiles are computed from the motion of their followers.
module mech9_cam_reader
  use mech9_kinds, only: wp
  use mech9_text, only: to_text
  use mech9_structure, only: structure_type
  use mech9_pair, only: pair_slot_type
  use mech9_pair_axes, only: pair_axes_type, pair_axes, turning, sliding
  use mech9_request, only: cam_request_type
  use mech9_document, only: document_type, group_type
  use mech9_lookup, only: groups_named, has_name, get_integer, get_real, get_reals, get_text, span_of
  use mech9_motion_reader, only: check_link
  use mech9_diagnostics, only: diagnostics_type
  implicit none
  private
  public :: read_cams

contains

  !> Read all cams, and find their axes and the pairs that guide their followers.
  pure subroutine read_cams(document, structure, pairs, cams, diagnostics)
    type(document_type), intent(in) :: document                   !< the data file as groups and items
    type(structure_type), intent(in) :: structure                 !< links and pairs; none where it is not known
    type(pair_slot_type), intent(in) :: pairs(:)                  !< (M) by coordinate; a slot is empty where its group has an error
    type(cam_request_type), allocatable, intent(out) :: cams(:)   !< in the order of the data file
    type(diagnostics_type), intent(inout) :: diagnostics          !< gets the errors
    type(pair_axes_type), allocatable :: axes(:)
    integer, allocatable :: numbers(:)
    integer :: i, found

    numbers = groups_named(document, 'cam')
    allocate (cams(size(numbers)))
    if (size(numbers) == 0) return
    axes = pair_axes(pairs)
    do i = 1, size(numbers)
      found = diagnostics%count
      associate (group => document%groups(numbers(i)))
        call read_cam(group, structure%shown_links(), cams(i), diagnostics)
        if (diagnostics%count > found .or. structure%n_links == 0) cycle
        cams(i)%place = diagnostics%place(group%span)
        call find_guide(group, structure, axes, cams(i), diagnostics)
        call find_axis(group, axes, cams(i), diagnostics)
      end associate
    end do
  end subroutine read_cams

  !> The numbers of one cam.
  pure subroutine read_cam(group, n_links, cam, diagnostics)
    type(group_type), intent(in) :: group                 !< the group of the data file
    integer, intent(in) :: n_links                        !< how many links there are; 0: unknown
    type(cam_request_type), intent(out) :: cam            !< its numbers
    type(diagnostics_type), intent(inout) :: diagnostics  !< gets the errors

    cam%link = get_integer(group, 'link')
    cam%follower = get_integer(group, 'follower')
    cam%point = get_reals(group, 'point')
    cam%roller = get_real(group, 'roller')
    cam%outer = get_text(group, 'side') == 'outer'
    cam%flat = has_name(group, 'face')
    if (cam%flat) cam%face = get_reals(group, 'face')
    call check_link(group, 'link', 1, n_links, diagnostics)
    call check_link(group, 'follower', 1, n_links, diagnostics)
    if (cam%link == cam%follower) &
      call diagnostics%add(span_of(group, 'follower', 1), 'a cam and its follower are two different links, not link '// &
                           to_text(cam%link)//' twice')
    if (cam%flat .and. has_name(group, 'roller')) &
      call diagnostics%add(span_of(group, 'roller'), 'a follower has a roller or a flat face; leave ''roller'' or ''face'' out')
    if (cam%flat .and. has_name(group, 'side')) &
      call diagnostics%add(span_of(group, 'side'), 'the normal of the flat face tells the side of the cam; leave ''side'' out')
    if (cam%flat .and. .not. any(abs(cam%face) > 0.0_wp)) &
      call diagnostics%add(span_of(group, 'face', 1), 'the normal of the flat face is zero; it must have a direction')
  end subroutine read_cam

  !> The pair that guides the follower: the one that is named, or the only one that turns or slides, or the only one of these with
  !> link 1; 0 where there is none.
  pure subroutine find_guide(group, structure, axes, cam, diagnostics)
    type(group_type), intent(in) :: group                 !< the group of the data file
    type(structure_type), intent(in) :: structure         !< links and pairs
    type(pair_axes_type), intent(in) :: axes(:)           !< (M) the axes of all pairs
    type(cam_request_type), intent(inout) :: cam          !< gets its guide
    type(diagnostics_type), intent(inout) :: diagnostics  !< gets the errors
    logical :: guides(size(axes)), with_frame(size(axes))
    integer :: k

    do k = 1, size(axes)
      guides(k) = structure%joint_of(k) == 0 .and. any(axes(k)%links == cam%follower) .and. .not. any(axes(k)%links == cam%link) &
                  .and. (axes(k)%kind == turning .or. axes(k)%kind == sliding)
      with_frame(k) = guides(k) .and. any(axes(k)%links == 1)
    end do
    if (has_name(group, 'guide')) then
      cam%guide = get_integer(group, 'guide')
      if (cam%guide <= size(axes)) then
        if (guides(cam%guide)) return
      end if
      call diagnostics%add(span_of(group, 'guide', 1), 'pair '//to_text(cam%guide)//' does not guide the follower: a guide '// &
                           'is a revolute or prismatic pair between link '//to_text(cam%follower)//' and a link other than the cam')
      cam%guide = 0
    else if (count(guides) == 1) then
      cam%guide = findloc_true(guides)
    else if (count(with_frame) == 1) then
      cam%guide = findloc_true(with_frame)
    end if
  end subroutine find_guide

  !> The normal of the cam's plane: the one that is given, or the axis about which the cam turns against the guide of its follower,
  !> against link 1, or against another link, or else its z axis.
  pure subroutine find_axis(group, axes, cam, diagnostics)
    type(group_type), intent(in) :: group                 !< the group of the data file
    type(pair_axes_type), intent(in) :: axes(:)           !< (M) the axes of all pairs
    type(cam_request_type), intent(inout) :: cam          !< gets its axis and its coordinate
    type(diagnostics_type), intent(inout) :: diagnostics  !< gets the errors
    integer :: k, rank, best

    best = 0
    do k = size(axes), 1, -1
      if (.not. any(axes(k)%links == cam%link)) cycle
      rank = 1
      if (axes(k)%kind == turning) rank = 2
      if (any(axes(k)%links == 1)) rank = rank + 2
      if (cam%guide > 0) then
        if (any(axes(k)%links == sum(axes(cam%guide)%links) - cam%follower)) rank = rank + 4
      end if
      if (rank < best) cycle
      best = rank
      cam%coordinate = k
    end do
    cam%axis = [0.0_wp, 0.0_wp, 1.0_wp]
    if (has_name(group, 'axis')) then
      cam%axis = get_reals(group, 'axis')
      if (.not. any(abs(cam%axis) > 0.0_wp)) then
        call diagnostics%add(span_of(group, 'axis', 1), 'the normal of the cam''s plane is zero; it must have a direction')
        return
      end if
    else if (cam%coordinate > 0) then
      associate (pair => axes(cam%coordinate))
        if (pair%kind == turning) cam%axis = pair%axes(:, merge(1, 2, pair%links(1) == cam%link))
      end associate
    end if
    cam%axis = cam%axis/norm2(cam%axis)
    if (cam%flat) cam%face = cam%face/norm2(cam%face)
  end subroutine find_axis

  !> The place of the first value that is true; 0 where none is.
  pure integer function findloc_true(values) result(place)
    logical, intent(in) :: values(:)   !< the values

    do place = 1, size(values)
      if (values(place)) return
    end do
    place = 0
  end function findloc_true
end module mech9_cam_reader
