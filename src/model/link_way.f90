!> The shortest way from link 1 to a link over pairs, and the rotation of the link along it.
!>
!> Coordinates grow over whole turns, so that sums and products along a way go on without jumps: an angle in a plane, and a
!> quaternion, whose sign changes after each whole turn.
module mech9_link_way
  use mech9_kinds, only: wp
  use mech9_rotation, only: quaternion, axial_vector, combine, about_z, identity
  use mech9_structure, only: structure_type
  use mech9_link_graph, only: link_graph_type, graph_from_structure
  use mech9_pair, only: pair_slot_type, screw_factors_type
  use mech9_turning_plane, only: turning_plane_type, turn_onto
  implicit none
  private
  public :: link_way_type, find_ways

  !> One pair of a way.
  type :: way_pair_type
    integer :: coordinate = 0         !< number of its coordinate
    logical :: reversed = .false.     !< the way leads from its moving link to its reference link
    logical :: is_screw = .true.      !< its axis is fixed
    real(wp) :: before(4) = 0.0_wp    !< quaternion of the pair's frame in the reference link
    real(wp) :: after(4) = 0.0_wp     !< quaternion of the moving link in the pair's frame, at no turn
    real(wp) :: turn = 0.0_wp         !< rotation about the axis per unit of q
    real(wp) :: offset = 0.0_wp       !< added to q [rad, m]
  end type way_pair_type

  !> A way.
  type :: link_way_type
    integer :: link = 1                                  !< number of the link to which it leads
    type(way_pair_type), allocatable :: pairs(:)         !< from link 1 on
    real(wp), allocatable :: share(:)                    !< (pairs) angle about the normal of the plane per unit of each coordinate
    real(wp) :: angle = 0.0_wp                           !< angle of the link where all coordinates are zero [rad]
  contains
    procedure :: coordinates
    procedure :: angle_at
    procedure :: quaternion_at
    procedure :: has_fixed_axes
    procedure, private :: set_angle
  end type link_way_type

contains

  !> Find the ways to some links, with the fewest pairs. Where the mechanism has a plane, the ways know the angles of their links.
  pure subroutine find_ways(structure, pairs, links, plane, ways)
    type(structure_type), intent(in) :: structure               !< links and pairs
    type(pair_slot_type), intent(in) :: pairs(:)                !< (M)
    integer, intent(in) :: links(:)                             !< numbers of the links
    type(turning_plane_type), intent(in) :: plane               !< the plane of the mechanism, if there is one
    type(link_way_type), allocatable, intent(out) :: ways(:)    !< (links)
    type(link_graph_type) :: graph
    integer :: through(structure%n_links), queue(structure%n_links), n, next, i, to

    graph = graph_from_structure(structure)
    through = 0
    queue(1) = 1
    n = 1
    next = 1
    do while (next <= n)
      do i = graph%first(queue(next)), graph%first(queue(next) + 1) - 1
        to = graph%other_at(i)
        if (to == 1 .or. through(to) > 0) cycle
        through(to) = graph%pair_at(i)
        n = n + 1
        queue(n) = to
      end do
      next = next + 1
    end do
    allocate (ways(size(links)))
    do i = 1, size(links)
      call follow(graph, pairs, through, links(i), ways(i))
      if (plane%found) call ways(i)%set_angle(pairs, plane)
    end do
  end subroutine find_ways

  !> Follow the pairs by which links were reached back to link 1.
  pure subroutine follow(graph, pairs, through, link, way)
    type(link_graph_type), intent(in) :: graph          !< links and pairs
    type(pair_slot_type), intent(in) :: pairs(:)        !< (M)
    integer, intent(in) :: through(:)                   !< (N) pair by which each link was reached; 0 for link 1
    integer, intent(in) :: link                         !< number of the link
    type(link_way_type), intent(out) :: way             !< the way
    type(screw_factors_type) :: factors
    type(way_pair_type) :: step
    integer :: at

    way%link = link
    allocate (way%pairs(0))
    at = link
    do while (through(at) > 0)
      associate (k => through(at))
        step%coordinate = k
        step%reversed = graph%ends(1, k) == at
        call pairs(k)%pair%as_screw(factors, step%is_screw)
        step%before = quaternion(factors%before%r)
        step%after = quaternion(factors%after%r)
        step%turn = factors%turn
        step%offset = factors%offset
        at = sum(graph%ends(:, k)) - at
      end associate
      way%pairs = [step, way%pairs]
    end do
  end subroutine follow

  !> Set the share of each coordinate in the angle of the link, and the angle where all coordinates are zero, between minus and
  !> plus half a turn. The angle is zero where the systems of the link and of link 1 coincide; where the plane has another normal in
  !> the link, the smallest rotation that makes both agree comes first.
  pure subroutine set_angle(self, pairs, plane)
    class(link_way_type), intent(inout) :: self         !< the way
    type(pair_slot_type), intent(in) :: pairs(:)        !< (M)
    type(turning_plane_type), intent(in) :: plane       !< the plane
    type(screw_factors_type) :: factors
    real(wp) :: r(3, 3), step(3, 3), turned(3, 3)
    logical :: is_screw
    integer :: i

    allocate (self%share(size(self%pairs)))
    r = identity
    do i = 1, size(self%pairs)
      associate (pair => pairs(self%pairs(i)%coordinate)%pair, reversed => self%pairs(i)%reversed)
        call pair%as_screw(factors, is_screw)
        self%share(i) = 0.0_wp
        if (is_screw) self%share(i) = factors%turn*sign(1.0_wp, dot_product(factors%before%r(:, 3), &
                                                                            plane%normal(:, pair%reference)))
        if (reversed) self%share(i) = -self%share(i)
        step = combine(combine(factors%before%r, about_z(factors%turn*factors%offset)), factors%after%r)
        if (reversed) step = transpose(step)
      end associate
      r = combine(r, step)
    end do
    turned = combine(r, transpose(turn_onto(plane%normal(:, self%link), plane%normal(:, 1))))
    self%angle = atan2(2.0_wp*dot_product(axial_vector(turned), plane%normal(:, 1)), &
                       turned(1, 1) + turned(2, 2) + turned(3, 3) - 1.0_wp)
  end subroutine set_angle

  !> The coordinates of its pairs.
  pure function coordinates(self)
    class(link_way_type), intent(in) :: self   !< the way
    integer :: coordinates(size(self%pairs))

    coordinates = self%pairs%coordinate
  end function coordinates

  !> The angle of the link about the normal of the plane [rad].
  pure real(wp) function angle_at(self, q) result(angle)
    class(link_way_type), intent(in) :: self   !< the way, in a plane
    real(wp), intent(in) :: q(:)               !< (M) coordinates [rad, m]
    integer :: i

    angle = self%angle
    do i = 1, size(self%pairs)
      angle = angle + self%share(i)*q(self%pairs(i)%coordinate)
    end do
  end function angle_at

  !> Whether all pairs have fixed axes, so that the way knows the rotation of its link.
  pure logical function has_fixed_axes(self)
    class(link_way_type), intent(in) :: self   !< the way

    has_fixed_axes = all(self%pairs%is_screw)
  end function has_fixed_axes

  !> The quaternion (w, x, y, z) of the link in link 1.
  pure function quaternion_at(self, q) result(e)
    class(link_way_type), intent(in) :: self   !< the way, with fixed axes
    real(wp), intent(in) :: q(:)               !< (M) coordinates [rad, m]
    real(wp) :: e(4), step(4), half
    integer :: i

    e = [1.0_wp, 0.0_wp, 0.0_wp, 0.0_wp]
    do i = 1, size(self%pairs)
      associate (pair => self%pairs(i))
        half = 0.5_wp*pair%turn*(q(pair%coordinate) + pair%offset)
        step = product_of(product_of(pair%before, [cos(half), 0.0_wp, 0.0_wp, sin(half)]), pair%after)
        if (pair%reversed) step(2:4) = -step(2:4)
      end associate
      e = product_of(e, step)
    end do
  end function quaternion_at

  !> Product of two quaternions (w, x, y, z): that of their rotations.
  pure function product_of(a, b) result(c)
    real(wp), intent(in) :: a(4)   !< left factor
    real(wp), intent(in) :: b(4)   !< right factor
    real(wp) :: c(4)

    c(1) = a(1)*b(1) - a(2)*b(2) - a(3)*b(3) - a(4)*b(4)
    c(2) = a(1)*b(2) + a(2)*b(1) + a(3)*b(4) - a(4)*b(3)
    c(3) = a(1)*b(3) - a(2)*b(4) + a(3)*b(1) + a(4)*b(2)
    c(4) = a(1)*b(4) + a(2)*b(3) - a(3)*b(2) + a(4)*b(1)
  end function product_of
end module mech9_link_way
