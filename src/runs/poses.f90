!> Poses of all links as columns after those of a table, with vertices and lines that show the links: each link is drawn
!> through its pairs and points.
module mech9_poses
  use mech9_kinds, only: wp
  use mech9_pose, only: pose_type, inverse
  use mech9_pair, only: screw_factors_type
  use mech9_mechanism, only: mechanism_type
  use mech9_plan, only: plan_type
  use mech9_state, only: state_type
  use mech9_frame_motion, only: link_motion
  implicit none
  private
  public :: poses_type, poses_of

  !> The columns: origins of the links, their rotations by rows, the vertices. Without links there are no columns.
  type :: poses_type
    integer :: n_links = 0
    integer, allocatable :: vertex_link(:)  !< (V) link that each vertex belongs to
    integer, allocatable :: carrier(:)      !< (V) link that each vertex moves with: another one for user pairs
    real(wp), allocatable :: local(:, :)    !< (3,V) position of the vertex in the frame of its carrier [m]
    integer, allocatable :: lines(:, :)     !< (2,L) vertices joined by a line
  contains
    procedure :: width
    procedure :: fill
  end type poses_type

contains

  !> Vertices and lines of all links.
  pure function poses_of(mechanism) result(poses)
    type(mechanism_type), intent(in) :: mechanism  !< the mechanism
    type(poses_type) :: poses
    type(screw_factors_type) :: factors
    type(pose_type) :: in_moving
    logical :: is_screw
    integer :: k, m

    m = size(mechanism%pairs)
    poses%n_links = mechanism%structure%shown_links()
    allocate (poses%vertex_link(2*m + size(mechanism%points)), source=0)
    allocate (poses%local(3, size(poses%vertex_link)), source=0.0_wp)
    do k = 1, m
      associate (pair => mechanism%pairs(k)%pair)
        poses%vertex_link(2*k - 1:2*k) = [pair%reference, pair%moving]
      end associate
    end do
    do k = 1, size(mechanism%points)
      poses%vertex_link(2*m + k) = mechanism%points(k)%link
      poses%local(:, 2*m + k) = mechanism%points(k)%position
    end do
    poses%carrier = poses%vertex_link
    do k = 1, m
      call mechanism%pairs(k)%pair%as_screw(factors, is_screw)
      in_moving = inverse(factors%after)
      poses%local(:, 2*k - 1) = factors%before%p
      poses%local(:, 2*k) = in_moving%p
      if (is_screw) cycle
      ! a pair of any motion has no axis: the point of the moving link that is led is its vertex for both links
      poses%carrier(2*k - 1) = poses%carrier(2*k)
      poses%local(:, 2*k - 1) = in_moving%p
    end do
    call keep_shown(poses)
    poses%lines = lines_through(poses%n_links, poses%vertex_link)
  end function poses_of

  !> Leave out the vertices of links that belong to joints: their numbers are above those of the links that the user knows.
  pure subroutine keep_shown(poses)
    type(poses_type), intent(inout) :: poses   !< the poses, with the vertices of all links
    logical :: kept(size(poses%vertex_link))
    integer :: i

    kept = poses%vertex_link <= poses%n_links
    if (all(kept)) return
    poses%local = poses%local(:, pack([(i, i=1, size(kept))], kept))
    poses%carrier = pack(poses%carrier, kept)
    poses%vertex_link = pack(poses%vertex_link, kept)
  end subroutine keep_shown

  !> Lines that join the vertices of each link in their order, and the last one with the first where there are three or more.
  pure function lines_through(n_links, vertex_link) result(lines)
    integer, intent(in) :: n_links         !< number of links
    integer, intent(in) :: vertex_link(:)  !< (V) link that each vertex belongs to
    integer, allocatable :: lines(:, :)
    integer, dimension(n_links) :: first, latest, number
    integer :: joined(2, 2*size(vertex_link)), n, i, link

    first = 0
    latest = 0
    number = 0
    n = 0
    do i = 1, size(vertex_link)
      link = vertex_link(i)
      if (first(link) == 0) first(link) = i
      if (latest(link) > 0) then
        n = n + 1
        joined(:, n) = [latest(link), i]
      end if
      latest(link) = i
      number(link) = number(link) + 1
    end do
    do link = 1, n_links
      if (number(link) < 3) cycle
      n = n + 1
      joined(:, n) = [latest(link), first(link)]
    end do
    lines = joined(:, :n)
  end function lines_through

  !> Number of columns.
  pure integer function width(self)
    class(poses_type), intent(in) :: self  !< the poses

    width = 12*self%n_links
    if (self%n_links > 0) width = width + 3*size(self%vertex_link)
  end function width

  !> Set the columns.
  pure subroutine fill(self, plan, state, columns)
    class(poses_type), intent(in) :: self  !< the poses
    type(plan_type), intent(in) :: plan    !< the plan of the mechanism
    type(state_type), intent(in) :: state  !< position and motion of the mechanism
    real(wp), intent(inout) :: columns(:)  !< gets origins [m], rotations by rows, and vertices [m], all in the fixed frame
    real(wp) :: r(3, 3, self%n_links), p(3, self%n_links), omega(3), v(3)
    integer :: i, at

    do i = 1, self%n_links
      call link_motion(plan, state, i, r(:, :, i), p(:, i), omega, v)
      columns(3*i - 2:3*i) = p(:, i)
      at = 3*self%n_links + 9*(i - 1)
      columns(at + 1:at + 9) = [r(1, :, i), r(2, :, i), r(3, :, i)]
    end do
    do i = 1, size(self%vertex_link)
      at = 12*self%n_links + 3*(i - 1)
      associate (link => self%carrier(i))
        columns(at + 1:at + 3) = p(:, link) + r(:, 1, link)*self%local(1, i) + r(:, 2, link)*self%local(2, i) &
                                 + r(:, 3, link)*self%local(3, i)
      end associate
    end do
  end subroutine fill
end module mech9_poses
