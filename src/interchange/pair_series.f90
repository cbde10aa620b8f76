!> The pairs of a robot: its joints, with the numbers of links and coordinates in the data file.
module mech9_pair_series
  use mech9_kinds, only: wp
  use mech9_error, only: error_type, raise, exit_structure
  use mech9_pose, only: pose_type, identity_pose
  use mech9_robot, only: robot_type, robot_joint_type, revolute_joint, cylindrical_joint, universal_joint, &
                         spherical_joint, planar_joint, free_joint
  implicit none
  private
  public :: series_type, single_pair_type, find_series

  !> A pair of the data file, by one of its coordinates.
  type :: single_pair_type
    integer :: kind = revolute_joint   !< one of the kinds of joints
    integer :: joint = 0               !< number of the joint that it belongs to
    integer :: freedoms = 0            !< number of coordinates of the pair; 0 at all of them but the first
    integer :: links(2) = 0            !< numbers in the data file of reference link and moving link
    type(pose_type) :: frames(2)       !< pose of the joint's frame in each of the two links
    real(wp) :: axis(3) = 0.0_wp       !< direction in the joint's frame, of length one
  end type single_pair_type

  !> Links and pairs in the order of the data file.
  type :: series_type
    integer :: n_links = 0                                 !< all links, with the massless ones of divided joints
    integer, allocatable :: number_of(:)                   !< (links of the robot) number in the data file
    type(single_pair_type), allocatable :: pairs(:)        !< by coordinates
    logical, allocatable :: closes(:)                      !< (joints of the robot) the joint closes a chain
  end type series_type

  !> Components of parallel directions differ by less: by round-off of sines and cosines.
  real(wp), parameter :: round_off = 1.0e-14_wp

contains

  !> Number links and coordinates from the frame outwards; joints that close chains come last.
  subroutine find_series(robot, series, err)
    type(robot_type), intent(in) :: robot              !< without fixed joints
    type(series_type), intent(out) :: series           !< its pairs
    type(error_type), allocatable, intent(out) :: err  !< allocated if a link hangs on no joint
    integer :: order(size(robot%links)), n, at, i, k, other, stage
    logical :: used(size(robot%joints))

    allocate (series%number_of(size(robot%links)), source=0)
    allocate (series%closes(size(robot%joints)), series%pairs(0))
    series%number_of(1) = 1
    series%n_links = 1
    order(1) = 1
    n = 1
    used = .false.
    ! loops that the file marks close chains unless nothing else reaches a link
    do stage = 1, 2
      at = 1
      do while (at <= n)
        do k = 1, size(robot%joints)
          if (used(k) .or. (robot%joints(k)%closes .and. stage == 1)) cycle
          if (all(robot%joints(k)%links /= order(at))) cycle
          other = sum(robot%joints(k)%links) - order(at)
          if (series%number_of(other) > 0) cycle
          used(k) = .true.
          call add_joint(robot%joints(k), k, other, series)
          n = n + 1
          order(n) = other
        end do
        at = at + 1
      end do
    end do
    series%closes = .not. used
    do k = 1, size(robot%joints)
      if (used(k)) cycle
      if (any(series%number_of(robot%joints(k)%links) == 0)) cycle
      call add_joint(robot%joints(k), k, 0, series)
    end do
    do i = 1, size(robot%links)
      if (series%number_of(i) > 0) cycle
      call raise(err, exit_structure, robot%links(i)%place//": no joints lead from the frame '"//robot%links(1)%name// &
                 "' to link '"//robot%links(i)%name//"'")
      return
    end do
  end subroutine find_series

  !> Add the pairs of a joint.
  subroutine add_joint(joint, k, new_link, series)
    type(robot_joint_type), intent(in) :: joint   !< the joint
    integer, intent(in) :: k                      !< its number in the robot
    integer, intent(in) :: new_link               !< number in the robot of the link that it leads to; 0: it closes a chain
    type(series_type), intent(inout) :: series    !< gets pairs and numbers of links
    type(single_pair_type), allocatable :: longer(:)
    integer :: i, n, m, between

    n = freedoms_of(joint%kind)
    between = 0
    if (joint%kind == universal_joint .and. .not. has_parallel_frames(joint)) between = series%n_links + 1
    if (between > 0) series%n_links = between
    if (new_link > 0) then
      series%n_links = series%n_links + 1
      series%number_of(new_link) = series%n_links
    end if
    m = size(series%pairs)
    allocate (longer(m + n))
    longer(:m) = series%pairs
    do i = m + 1, m + n
      longer(i) = single_pair_type(joint%kind, k, 0, series%number_of(joint%links), joint%frames, joint%axis)
    end do
    longer(m + 1)%freedoms = n
    if (between > 0) call split_universal(joint, between, longer(m + 1:m + 2))
    call move_alloc(longer, series%pairs)
  end subroutine add_joint

  !> Whether the systems of both links of a joint are parallel where its coordinates are zero, as universal pairs need it.
  pure logical function has_parallel_frames(joint)
    type(robot_joint_type), intent(in) :: joint  !< the joint

    has_parallel_frames = maxval(abs(joint%frames(1)%r - joint%frames(2)%r)) < round_off
  end function has_parallel_frames

  !> A universal joint as two pairs with a massless link between them.
  pure subroutine split_universal(joint, between, pairs)
    type(robot_joint_type), intent(in) :: joint          !< the joint
    integer, intent(in) :: between                       !< number of the massless link
    type(single_pair_type), intent(inout) :: pairs(2)    !< its two pairs

    pairs%kind = revolute_joint
    pairs%freedoms = 1
    pairs(1)%links(2) = between
    pairs(1)%frames(2) = identity_pose
    pairs(2)%links(1) = between
    pairs(2)%frames(1) = identity_pose
    pairs(2)%axis = joint%second
  end subroutine split_universal

  !> The number of freedoms of a kind of joints.
  pure integer function freedoms_of(kind)
    integer, intent(in) :: kind  !< one of the kinds

    select case (kind)
    case (cylindrical_joint, universal_joint)
      freedoms_of = 2
    case (spherical_joint, planar_joint)
      freedoms_of = 3
    case (free_joint)
      freedoms_of = 6
    case default
      freedoms_of = 1
    end select
  end function freedoms_of
end module mech9_pair_series
