!> Joints with several freedoms from the groups &pair of a checked document, and the chains of pairs that stand for them.
!>
!> With the frames F of the joint in its reference link and G in its moving link, and turns R and slides T along the axes of
!> these frames, the pose of the moving link in the reference link is
!>   spherical    F Rx(q1) Ry(q2) Rz(q3) G^-1
!>   cylindrical  F Rz(q1) Tz(q2) G^-1
!>   planar       F Tx(q1) Ty(q2) Rz(q3) G^-1
!>   free         F Tx(q1) Ty(q2) Tz(q3) Rx(q4) Ry(q5) Rz(q6) G^-1
!> A universal joint turns about an axis of its reference link, then about one of its moving link.
module mech9_joint_reader
  use mech9_kinds, only: wp
  use mech9_rotation, only: cross
  use mech9_pose, only: pose_type, compose, identity_pose, default_zero
  use mech9_three_turns, only: cyclic
  use mech9_compound_joint, only: compound_joint_type, is_compound
  use mech9_pair, only: pair_slot_type
  use mech9_screw_pair, only: screw_pair_type, revolute_pair, prismatic_pair
  use mech9_source, only: span_type
  use mech9_document, only: document_type, group_type
  use mech9_lookup, only: groups_named, get_integers, get_reals, get_text, has_name, span_of
  use mech9_axis_reader, only: read_axis_frames, make_frame, real_or, pair_words
  use mech9_diagnostics, only: diagnostics_type
  implicit none
  private
  public :: read_joints, joint_of_group, read_joint_pairs, coordinates_of, coordinate_span

  !> Axes of a universal joint are parallel below this sine of their angle.
  real(wp), parameter :: least_sine = 1.0e-6_wp

contains

  !> The joints with several freedoms of all sound groups, without numbers of their own links.
  pure subroutine read_joints(document, joints)
    type(document_type), intent(in) :: document                        !< the data file as groups and items
    type(compound_joint_type), allocatable, intent(out) :: joints(:)   !< in the order of the file
    integer, allocatable :: numbers(:)
    logical, allocatable :: compound(:)
    integer :: i

    numbers = groups_named(document, 'pair')
    allocate (compound(size(numbers)))
    do i = 1, size(numbers)
      compound(i) = is_compound(get_text(document%groups(numbers(i)), 'kind'))
    end do
    numbers = pack(numbers, compound)
    allocate (joints(size(numbers)))
    do i = 1, size(numbers)
      joints(i) = joint_of_group(document%groups(numbers(i)))
    end do
  end subroutine read_joints

  !> The joint with several freedoms of a group, without numbers of its own links.
  pure function joint_of_group(group) result(joint)
    type(group_type), intent(in) :: group   !< the group &pair
    type(compound_joint_type) :: joint

    joint%kind = get_text(group, 'kind')
    joint%freedoms = size(coordinates_of(group))
    joint%numbers(:joint%freedoms) = coordinates_of(group)
    joint%ends = get_integers(group, 'links')
  end function joint_of_group

  !> The coordinates of a pair or of a joint with several freedoms.
  pure function coordinates_of(group) result(coordinates)
    type(group_type), intent(in) :: group  !< the group &pair
    integer, allocatable :: coordinates(:)

    coordinates = get_integers(group, trim(name_of_coordinates(group)))
  end function coordinates_of

  !> Place of one of these coordinates in the file.
  pure type(span_type) function coordinate_span(group, i) result(span)
    type(group_type), intent(in) :: group  !< the group &pair
    integer, intent(in) :: i               !< place in the list, from 1

    span = span_of(group, trim(name_of_coordinates(group)), i)
  end function coordinate_span

  !> The name under which a group gives its coordinates.
  pure character(len=11) function name_of_coordinates(group) result(name)
    type(group_type), intent(in) :: group  !< the group &pair

    name = 'coordinate'
    if (has_name(group, 'coordinates')) name = 'coordinates'
  end function name_of_coordinates

  !> The chain of pairs of a joint; it stays empty where something was reported.
  subroutine read_joint_pairs(group, joint, pairs, diagnostics)
    type(group_type), intent(in) :: group                      !< the group of the data file
    type(compound_joint_type), intent(in) :: joint             !< the joint, with the numbers of its own links
    type(pair_slot_type), allocatable, intent(out) :: pairs(:) !< in the order of the joint's coordinates
    type(diagnostics_type), intent(inout) :: diagnostics       !< gets the errors
    type(screw_pair_type) :: chain(joint%freedoms)
    type(pose_type) :: reference, moving
    integer :: found, i

    allocate (pairs(joint%freedoms))
    found = diagnostics%count
    if (joint%kind == 'universal') then
      call read_universal(group, chain, diagnostics)
    else
      call read_axis_frames(group, reference, moving, diagnostics)
      if (diagnostics%count == found) call make_chain(joint%kind, reference, moving, chain)
    end if
    if (diagnostics%count > found) return
    do i = 1, joint%freedoms
      chain(i)%coordinate = joint%numbers(i)
      associate (links => joint%links_of_pair(i))
        chain(i)%reference = links(1)
        chain(i)%moving = links(2)
      end associate
      chain(i)%place = diagnostics%place(group%span)
      allocate (pairs(i)%pair, source=chain(i))
    end do
  end subroutine read_joint_pairs

  !> The pairs of a joint between two frames.
  pure subroutine make_chain(kind, reference, moving, chain)
    character(len=*), intent(in) :: kind               !< spherical, cylindrical, planar or free
    type(pose_type), intent(in) :: reference           !< F, the joint's frame in the reference link
    type(pose_type), intent(in) :: moving              !< G, the joint's frame in the moving link
    type(screw_pair_type), intent(inout) :: chain(:)   !< gets the pairs
    type(pose_type) :: along(3), first
    integer :: n

    ! along(i) brings z to axis i of the frame
    along(1) = pose_type(cyclic, [0.0_wp, 0.0_wp, 0.0_wp])
    along(2) = pose_type(transpose(cyclic), [0.0_wp, 0.0_wp, 0.0_wp])
    along(3) = identity_pose
    n = size(chain)
    select case (kind)
    case ('spherical')
      chain(1) = revolute_pair(compose(reference, along(1)), along(1))
      chain(2) = revolute_pair(along(2), along(2))
    case ('cylindrical')
      chain(1) = revolute_pair(reference, along(3))
    case ('planar')
      chain(1) = prismatic_pair(compose(reference, along(1)), along(1))
      chain(2) = prismatic_pair(along(2), along(2))
    case ('free')
      first = compose(reference, along(1))
      chain(1) = prismatic_pair(first, along(1))
      chain(2) = prismatic_pair(along(2), along(2))
      chain(3) = prismatic_pair(along(3), along(3))
      chain(4) = revolute_pair(along(1), along(1))
      chain(5) = revolute_pair(along(2), along(2))
    end select
    if (kind == 'cylindrical') then
      chain(n) = prismatic_pair(along(3), moving)
    else
      chain(n) = revolute_pair(along(3), moving)
    end if
  end subroutine make_chain

  !> The pairs of a universal joint: at q = 0 the systems of its links are parallel, so both axes can be given in either.
  pure subroutine read_universal(group, chain, diagnostics)
    type(group_type), intent(in) :: group                 !< the group of the data file
    type(screw_pair_type), intent(inout) :: chain(:)      !< gets the two pairs
    type(diagnostics_type), intent(inout) :: diagnostics  !< gets the errors
    real(wp), parameter :: origin(3) = 0.0_wp
    type(pose_type) :: first, second
    real(wp) :: point(3), moving_point(3), axis(3)
    integer :: found

    found = diagnostics%count
    point = real_or(group, 'point', origin)
    moving_point = real_or(group, 'moving_point', point)
    axis = get_reals(group, 'axis')
    call make_frame(group, '', point, axis, default_zero(axis), first, diagnostics)
    axis = get_reals(group, 'moving_axis')
    call make_frame(group, 'moving_', origin, axis, default_zero(axis), second, diagnostics)
    if (diagnostics%count > found) return
    if (norm2(cross(first%r(:, 3), second%r(:, 3))) <= least_sine) then
      call diagnostics%add(span_of(group, 'moving_axis'), 'the two axes of '//trim(pair_words(group))// &
                           ' are parallel; give a moving_axis that points in another direction than axis')
      return
    end if
    chain(1) = revolute_pair(first, pose_type(first%r, origin))
    chain(2) = revolute_pair(second, pose_type(second%r, moving_point))
  end subroutine read_universal
end module mech9_joint_reader
