!> Links that fixed joints join become one link each, with the masses of all.
module mech9_rigid_links
  use mech9_kinds, only: wp
  use mech9_error, only: error_type, raise, exit_data
  use mech9_rotation, only: identity, rotation_between
  use mech9_pose, only: pose_type, compose, inverse, transformed
  use mech9_inertia, only: inertia_in_axes
  use mech9_robot, only: robot_type, robot_link_type, robot_joint_type, fixed_joint
  implicit none
  private
  public :: join_rigid_links

  !> Fixed joints that close a chain agree within this part of its size, or this angle [rad]: files have few digits.
  real(wp), parameter :: agreement = 1.0e-3_wp

  !> The bodies that links belong to: the first link of each, and the poses in it.
  type :: bodies_type
    integer, allocatable :: first(:)             !< (links) first link of the body of each link; 0: not known yet
    type(pose_type), allocatable :: poses(:)     !< (links) of each link in the first one
  end type bodies_type

contains

  !> Join the links. Their frames become points to be recorded, and link 1 stays the frame.
  subroutine join_rigid_links(robot, err)
    type(robot_type), intent(inout) :: robot           !< with all lists cut to their parts in use
    type(error_type), allocatable, intent(out) :: err  !< allocated if fixed joints contradict each other
    type(bodies_type) :: bodies
    type(robot_link_type), allocatable :: links(:)
    integer :: number_of(size(robot%links)), i, n

    call find_bodies(robot, bodies, err)
    if (allocated(err)) return
    n = 0
    number_of = 0
    allocate (links(count(bodies%first == [(i, i=1, size(robot%links))])))
    do i = 1, size(robot%links)
      if (bodies%first(i) /= i) cycle
      n = n + 1
      number_of(i) = n
      call add_masses(robot, bodies, i, links(n))
    end do
    do i = 1, size(robot%links)
      if (bodies%first(i) /= i) call robot%add_point(robot%links(i)%name, i, [0.0_wp, 0.0_wp, 0.0_wp])
    end do
    do i = 1, robot%n_points
      associate (point => robot%points(i))
        point%position = transformed(bodies%poses(point%link), point%position)
        point%link = number_of(bodies%first(point%link))
      end associate
    end do
    call move_joints(robot, bodies, number_of)
    call move_alloc(links, robot%links)
    robot%n_links = n
    call robot%finish()
  end subroutine join_rigid_links

  !> Find the links that fixed joints join.
  subroutine find_bodies(robot, bodies, err)
    type(robot_type), intent(in) :: robot              !< the robot
    type(bodies_type), intent(out) :: bodies           !< the bodies
    type(error_type), allocatable, intent(out) :: err  !< allocated if fixed joints contradict each other
    logical :: grows
    integer :: i, k, a, b

    allocate (bodies%first(size(robot%links)), source=0)
    allocate (bodies%poses(size(robot%links)))
    do i = 1, size(robot%links)
      if (bodies%first(i) > 0) cycle
      bodies%first(i) = i
      grows = .true.
      do while (grows)
        grows = .false.
        do k = 1, size(robot%joints)
          if (robot%joints(k)%kind /= fixed_joint) cycle
          a = robot%joints(k)%links(1)
          b = robot%joints(k)%links(2)
          if ((bodies%first(a) == i) .eqv. (bodies%first(b) == i)) cycle
          grows = .true.
          if (bodies%first(a) == i) then
            bodies%first(b) = i
            bodies%poses(b) = compose(bodies%poses(a), pose_of_second(robot%joints(k)))
          else
            bodies%first(a) = i
            bodies%poses(a) = compose(bodies%poses(b), inverse(pose_of_second(robot%joints(k))))
          end if
        end do
      end do
    end do
    do k = 1, size(robot%joints)
      if (robot%joints(k)%kind == fixed_joint) call judge_fixed(robot%joints(k), bodies, err)
      if (allocated(err)) return
    end do
  end subroutine find_bodies

  !> Pose of the moving link in the reference link of a fixed joint.
  pure function pose_of_second(joint) result(pose)
    type(robot_joint_type), intent(in) :: joint  !< a fixed joint
    type(pose_type) :: pose

    pose = compose(joint%frames(1), inverse(joint%frames(2)))
  end function pose_of_second

  !> Fail where a fixed joint contradicts the others of its body.
  subroutine judge_fixed(joint, bodies, err)
    type(robot_joint_type), intent(in) :: joint        !< a fixed joint
    type(bodies_type), intent(in) :: bodies            !< the bodies
    type(error_type), allocatable, intent(out) :: err  !< allocated if it does
    type(pose_type) :: x, y

    x = compose(bodies%poses(joint%links(1)), pose_of_second(joint))
    y = bodies%poses(joint%links(2))
    if (norm2(x%p - y%p) <= agreement*(norm2(x%p) + norm2(y%p)) .and. norm2(rotation_between(x%r, y%r)) <= agreement) return
    call raise(err, exit_data, joint%place//": joint '"//joint%name//"' joins links rigidly that other fixed joints join in "// &
               'another position')
  end subroutine judge_fixed

  !> One link from all links of a body: mass, mass centre, and inertia about it by the theorem of parallel axes.
  subroutine add_masses(robot, bodies, first, link)
    type(robot_type), intent(in) :: robot        !< the robot
    type(bodies_type), intent(in) :: bodies      !< the bodies
    integer, intent(in) :: first                 !< number of the first link of the body
    type(robot_link_type), intent(out) :: link   !< the joined link, in the frame of the first one
    real(wp) :: centres(3, size(robot%links)), d(3)
    integer :: i, k

    link%name = robot%links(first)%name
    link%place = robot%links(first)%place
    do i = 1, size(robot%links)
      if (bodies%first(i) /= first) cycle
      centres(:, i) = transformed(bodies%poses(i), robot%links(i)%centre)
      link%mass = link%mass + robot%links(i)%mass
      link%centre = link%centre + robot%links(i)%mass*centres(:, i)
    end do
    if (link%mass > 0.0_wp) link%centre = link%centre/link%mass
    if (count(bodies%first == first) == 1) link%centre = robot%links(first)%centre
    do i = 1, size(robot%links)
      if (bodies%first(i) /= first) cycle
      d = centres(:, i) - link%centre
      link%inertia = link%inertia + inertia_in_axes(bodies%poses(i)%r, robot%links(i)%inertia)
      do k = 1, 3
        link%inertia(:, k) = link%inertia(:, k) + robot%links(i)%mass*(dot_product(d, d)*identity(:, k) - d*d(k))
      end do
    end do
  end subroutine add_masses

  !> The other joints join bodies. One whose two links are in the same body cannot move, and is left out with a note.
  subroutine move_joints(robot, bodies, number_of)
    type(robot_type), intent(inout) :: robot           !< loses its fixed joints
    type(bodies_type), intent(in) :: bodies            !< the bodies
    integer, intent(in) :: number_of(:)                !< new number of each first link
    integer :: i, k, n

    n = 0
    do k = 1, size(robot%joints)
      if (robot%joints(k)%kind == fixed_joint) cycle
      n = n + 1
      if (n < k) robot%joints(n) = robot%joints(k)
      associate (joint => robot%joints(n))
        do i = 1, 2
          joint%frames(i) = compose(bodies%poses(joint%links(i)), joint%frames(i))
          joint%links(i) = number_of(bodies%first(joint%links(i)))
        end do
        if (joint%links(1) == joint%links(2)) then
          call robot%note_at(joint%place, "joint '"//joint%name//"', since fixed joints make both its links one rigid body")
          n = n - 1
        end if
      end associate
    end do
    robot%n_joints = n
  end subroutine move_joints
end module mech9_rigid_links
