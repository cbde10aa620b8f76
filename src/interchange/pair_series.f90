!> The pairs of a robot: joints with several freedoms become series of pairs with massless links between them, and links and
!> coordinates get their numbers in the data file.
module mech9_pair_series
  use mech9_kinds, only: wp
  use mech9_error, only: error_type, raise, exit_structure
  use mech9_rotation, only: cross, unit
  use mech9_pose, only: pose_type, identity_pose, default_zero
  use mech9_robot, only: robot_type, robot_joint_type, revolute_joint, prismatic_joint, helical_joint, cylindrical_joint, &
                         universal_joint, spherical_joint, planar_joint, free_joint
  implicit none
  private
  public :: series_type, single_pair_type, find_series

  !> A pair of the data file.
  type :: single_pair_type
    integer :: kind = revolute_joint   !< revolute, prismatic or helical
    integer :: joint = 0               !< number of the joint that it belongs to
    integer :: links(2) = 0            !< numbers in the data file of reference link and moving link
    type(pose_type) :: frames(2)       !< pose of the joint's frame in each of the two links
    real(wp) :: axis(3) = 0.0_wp       !< direction in the joint's frame, of length one
  end type single_pair_type

  !> Links and pairs in the order of the data file.
  type :: series_type
    integer :: n_links = 0                                 !< all links, the massless ones included
    integer, allocatable :: number_of(:)                   !< (links of the robot) number in the data file
    type(single_pair_type), allocatable :: pairs(:)        !< pair k has coordinate k
    logical, allocatable :: closes(:)                      !< (joints of the robot) the joint closes a chain
  end type series_type

  real(wp), parameter :: x(3) = [1.0_wp, 0.0_wp, 0.0_wp], y(3) = [0.0_wp, 1.0_wp, 0.0_wp], z(3) = [0.0_wp, 0.0_wp, 1.0_wp]

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

  !> Add the pairs of a joint and its massless links, which get the numbers before that of the link it leads to.
  subroutine add_joint(joint, k, new_link, series)
    type(robot_joint_type), intent(in) :: joint   !< the joint
    integer, intent(in) :: k                      !< its number in the robot
    integer, intent(in) :: new_link               !< number in the robot of the link that it leads to; 0: it closes a chain
    type(series_type), intent(inout) :: series    !< gets pairs and numbers of links
    type(single_pair_type), allocatable :: longer(:)
    real(wp) :: axes(3, 6)
    integer :: kinds(6), links(0:6), i, n, m

    call freedoms_of(joint, kinds, axes, n)
    m = size(series%pairs)
    allocate (longer(m + n))
    longer(:m) = series%pairs
    do i = 1, n - 1
      links(i) = series%n_links + i
    end do
    series%n_links = series%n_links + n - 1
    if (new_link > 0) then
      series%n_links = series%n_links + 1
      series%number_of(new_link) = series%n_links
    end if
    links(0) = series%number_of(joint%links(1))
    links(n) = series%number_of(joint%links(2))
    do i = 1, n
      longer(m + i) = single_pair_type(kinds(i), k, links(i - 1:i), [identity_pose, identity_pose], axes(:, i))
    end do
    longer(m + 1)%frames(1) = joint%frames(1)
    longer(m + n)%frames(2) = joint%frames(2)
    call move_alloc(longer, series%pairs)
  end subroutine add_joint

  !> The freedoms of a joint, one after the other.
  pure subroutine freedoms_of(joint, kinds, axes, n)
    type(robot_joint_type), intent(in) :: joint  !< the joint
    integer, intent(out) :: kinds(6)             !< revolute, prismatic or helical
    real(wp), intent(out) :: axes(3, 6)          !< directions in the joint's frame, of length one
    integer, intent(out) :: n                    !< number of freedoms

    kinds = revolute_joint
    axes = 0.0_wp
    n = 1
    axes(:, 1) = joint%axis
    select case (joint%kind)
    case (prismatic_joint, helical_joint)
      kinds(1) = joint%kind
    case (cylindrical_joint)
      n = 2
      kinds(2) = prismatic_joint
      axes(:, 2) = joint%axis
    case (universal_joint)
      n = 2
      axes(:, 2) = joint%second
    case (spherical_joint)
      n = 3
      axes(:, :3) = reshape([x, y, z], [3, 3])
    case (planar_joint)
      n = 3
      kinds(:2) = prismatic_joint
      axes(:, 1) = unit(default_zero(joint%axis) - dot_product(default_zero(joint%axis), joint%axis)*joint%axis)
      axes(:, 2) = cross(joint%axis, axes(:, 1))
      axes(:, 3) = joint%axis
    case (free_joint)
      n = 6
      kinds(:3) = prismatic_joint
      axes = reshape([x, y, z, x, y, z], [3, 6])
    end select
  end subroutine freedoms_of
end module mech9_pair_series
