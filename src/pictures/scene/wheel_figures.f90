!> The figures of couplings in a picture: the pitch circles of gears and of pinions, racks, pulleys and belts.
!>
!> The data file gives no shape of a wheel. Its pitch circle follows from the ratio and from the places of both axes. It
!> goes through the line on which both wheels have the same velocity.
module mech9_wheel_figures
  use mech9_kinds, only: wp, pi
  use mech9_rotation, only: cross, unit
  use mech9_pose, only: default_zero
  use mech9_mechanism, only: mechanism_type
  use mech9_linear_coupling, only: linear_coupling_type
  use mech9_film, only: film_type
  use mech9_pair_axes, only: turning, sliding
  use mech9_skeleton, only: skeleton_type, append_figure, wheel_figure, belt_figure
  use mech9_gear_meshes, only: partner_type, find_partners, find_planetary
  implicit none
  private
  public :: find_figures

  integer, parameter :: corners = 72                !< of a circle
  !> Lengths below this part of the mechanism's size are zero, and sines below the second number.
  real(wp), parameter :: same = 0.001_wp, parallel = 1.0e-6_wp
  !> No wheel is drawn larger than this multiple of the mechanism's size.
  real(wp), parameter :: largest = 2.0_wp

contains

  !> Add the figures of all couplings between two pairs of one link, and of planetary gears, to a skeleton whose places are known.
  subroutine find_figures(mechanism, film, skeleton)
    type(mechanism_type), intent(in) :: mechanism   !< the mechanism
    type(film_type), intent(in) :: film             !< poses and values at the outputs of the run
    type(skeleton_type), intent(inout) :: skeleton  !< places at which the pairs are drawn
    type(partner_type) :: pair(2)
    integer :: i, common

    if (.not. allocated(mechanism%couplings)) return
    do i = 1, size(mechanism%couplings)
      select type (coupling => mechanism%couplings(i)%coupling)
      type is (linear_coupling_type)
        if (coupling%name == 'linear') call add_planetary(film, coupling%coordinates, coupling%coefficients, skeleton)
        if (size(coupling%coordinates) /= 2) cycle
        call find_partners(skeleton, coupling%coordinates, pair, common)
        if (common == 0) cycle
        associate (ratio => -coupling%coefficients(1)*(3 - 2*pair(1)%side)*(3 - 2*pair(2)%side), &
                   kinds => skeleton%places(coupling%coordinates)%kind)
          if (coupling%name == 'gear' .and. all(kinds == turning)) then
            call add_gears(pair, ratio, skeleton)
          else if (coupling%name == 'rack' .and. kinds(1) == turning .and. kinds(2) == sliding) then
            call add_rack(film, pair, common, ratio, skeleton)
          else if (coupling%name == 'belt' .and. all(kinds == turning) .and. allocated(coupling%radii)) then
            call add_belt(pair, common, coupling%radii, ratio*dot_product(pair(1)%axis, pair(2)%axis) < 0.0_wp, skeleton)
          end if
        end associate
      end select
    end do
  end subroutine find_figures

  !> Add the wheels of a linear equation of turning pairs that a planetary gear has.
  subroutine add_planetary(film, coordinates, coefficients, skeleton)
    type(film_type), intent(in) :: film             !< poses at the outputs of the run; the first one is used
    integer, intent(in) :: coordinates(:)           !< numbers of the pairs
    real(wp), intent(in) :: coefficients(:)         !< of their coordinates
    type(skeleton_type), intent(inout) :: skeleton  !< gets the circles
    type(partner_type) :: pair(2)
    integer :: carrier
    real(wp) :: ratio

    call find_planetary(film, skeleton, coordinates, coefficients, pair, carrier, ratio)
    if (carrier == 0) return
    if (norm2(cross(pair(1)%axis, pair(2)%point - pair(1)%point)) > same*skeleton%size) then
      call add_gears(pair, ratio, skeleton)
    else
      call add_epicyclic(pair, carrier, ratio, skeleton)
    end if
  end subroutine add_planetary

  !> Add sun and ring about one axis, and a planet between them that is no link. Only the ratio of their sizes is known.
  subroutine add_epicyclic(pair, carrier, ratio, skeleton)
    type(partner_type), intent(in) :: pair(2)       !< sun and ring, in any order
    integer, intent(in) :: carrier                  !< number of the link that carries the planets
    real(wp), intent(in) :: ratio                   !< turn of the second wheel per turn of the first one, negative
    type(skeleton_type), intent(inout) :: skeleton  !< gets the circles
    real(wp), parameter :: largest_part = 0.4_wp    ! radius of the ring in the mechanism's size
    type(partner_type) :: planet
    real(wp) :: radii(2), across(3), along
    integer :: ring

    radii = largest_part*skeleton%size*[1.0_wp, 1.0_wp]
    if (abs(ratio) < 1.0_wp) then
      radii(1) = abs(ratio)*radii(2)
      ring = 2
    else
      radii(2) = radii(1)/abs(ratio)
      ring = 1
    end if
    if (abs(radii(1) - radii(2)) <= same*skeleton%size) return
    along = dot_product(pair(1)%point - pair(2)%point, pair(2)%axis)
    call add_circle(pair(1), 0.0_wp, radii(1), ring == 1, skeleton)
    call add_circle(pair(2), along, radii(2), ring == 2, skeleton)
    across = default_zero(pair(1)%axis)
    across = unit(across - dot_product(across, pair(1)%axis)*pair(1)%axis)
    planet%link = carrier
    planet%own_point = pair(1)%point + 0.5_wp*sum(radii)*across
    planet%own_axis = pair(1)%axis
    call add_circle(planet, 0.0_wp, 0.5_wp*abs(radii(1) - radii(2)), .false., skeleton)
  end subroutine add_epicyclic

  !> Add the pitch circles of two gears, of parallel shafts or of shafts whose axes meet.
  subroutine add_gears(pair, ratio, skeleton)
    type(partner_type), intent(in) :: pair(2)       !< both gears
    real(wp), intent(in) :: ratio                   !< turn of the second one about its axis per turn of the first one
    type(skeleton_type), intent(inout) :: skeleton  !< gets the circles
    real(wp) :: apart(3), apex(3), line(3), part, reach(2), along

    apart = pair(2)%point - pair(1)%point
    if (norm2(cross(pair(1)%axis, pair(2)%axis)) <= parallel) then
      apart = apart - dot_product(apart, pair(1)%axis)*pair(1)%axis
      associate (same_way => ratio*sign(1.0_wp, dot_product(pair(1)%axis, pair(2)%axis)), distance => norm2(apart))
        if (abs(same_way - 1.0_wp)*largest*skeleton%size <= max(1.0_wp, abs(same_way))*distance) return
        if (distance <= same*skeleton%size) return
        ! this part of the way from the first axis to the second one is the place of equal velocities
        part = same_way/(same_way - 1.0_wp)
        call add_circle(pair(1), 0.0_wp, abs(part)*distance, part > 1.0_wp, skeleton)
        along = dot_product(pair(1)%point - pair(2)%point, pair(2)%axis)
        call add_circle(pair(2), along, abs(part - 1.0_wp)*distance, part < 0.0_wp, skeleton)
      end associate
      return
    end if
    call find_apex(pair, apex, reach)
    if (norm2(pair(2)%point + reach(2)*pair(2)%axis - apex) > same*skeleton%size) return
    ! both cones touch along this line through the apex
    line = unit(pair(1)%axis - ratio*pair(2)%axis)
    part = nearer_bearing(pair, line, reach, same*skeleton%size)
    if (abs(part) <= 0.0_wp) return
    call add_cone(pair(1), reach(1), part*line, skeleton)
    call add_cone(pair(2), reach(2), part*line, skeleton)
  end subroutine add_gears

  !> Find the point of the first axis that is nearest to the second axis, and the ways along both axes to the nearest
  !> points. The ways begin at the points of the pairs.
  pure subroutine find_apex(pair, apex, reach)
    type(partner_type), intent(in) :: pair(2)   !< two pairs whose axes are not parallel
    real(wp), intent(out) :: apex(3)            !< in the common link [m]
    real(wp), intent(out) :: reach(2)           !< along both axes [m]
    real(wp) :: apart(3), cosine

    apart = pair(2)%point - pair(1)%point
    cosine = dot_product(pair(1)%axis, pair(2)%axis)
    reach(1) = (dot_product(apart, pair(1)%axis) - cosine*dot_product(apart, pair(2)%axis))/(1.0_wp - cosine**2)
    reach(2) = cosine*reach(1) - dot_product(apart, pair(2)%axis)
    apex = pair(1)%point + reach(1)*pair(1)%axis
  end subroutine find_apex

  !> The length along the line of contact, with its sign, at which a wheel stands at the point of its pair. The wheel is
  !> that of the pair nearer to the apex. The length is 0 where both points are at the apex.
  pure real(wp) function nearer_bearing(pair, line, reach, least) result(length)
    type(partner_type), intent(in) :: pair(2)   !< both bevel gears
    real(wp), intent(in) :: line(3)             !< direction of the line on which they touch, of unit length
    real(wp), intent(in) :: reach(2)            !< ways along both axes from the points of the pairs to the apex [m]
    real(wp), intent(in) :: least               !< shorter ways are none [m]
    real(wp) :: along, candidate
    integer :: i

    length = 0.0_wp
    do i = 1, 2
      along = dot_product(line, pair(i)%axis)
      if (abs(reach(i)) <= least .or. abs(along) <= parallel) cycle
      candidate = -reach(i)/along
      if (abs(length) <= 0.0_wp .or. abs(candidate) < abs(length)) length = candidate
    end do
  end function nearer_bearing

  !> Add the circle of a bevel gear through the end of the line of contact.
  subroutine add_cone(gear, reach, line, skeleton)
    type(partner_type), intent(in) :: gear          !< the gear
    real(wp), intent(in) :: reach                   !< way along its axis from its point to the apex [m]
    real(wp), intent(in) :: line(3)                 !< from the apex to the end of the line of contact, in the common link [m]
    type(skeleton_type), intent(inout) :: skeleton  !< gets the circle
    real(wp) :: along

    along = dot_product(line, gear%axis)
    call add_circle(gear, reach + along, norm2(line - along*gear%axis), .false., skeleton)
  end subroutine add_cone

  !> Add a pinion, and the rack over the part that comes into mesh.
  subroutine add_rack(film, pair, common, travel, skeleton)
    type(film_type), intent(in) :: film             !< poses and values at the outputs of the run
    type(partner_type), intent(in) :: pair(2)       !< the pinion and the rack
    integer, intent(in) :: common                   !< number of the link that carries both
    real(wp), intent(in) :: travel                  !< of the rack along its axis per turn of the pinion [m/rad]
    type(skeleton_type), intent(inout) :: skeleton  !< gets the circle and the line
    real(wp) :: contact(3), at(3), first(3), low, high
    integer :: frame

    if (abs(dot_product(pair(1)%axis, pair(2)%axis)) > parallel) return
    if (abs(travel) <= same*skeleton%size .or. abs(travel) > largest*skeleton%size) return
    call add_circle(pair(1), 0.0_wp, abs(travel), .false., skeleton)
    contact = pair(1)%point + travel*cross(pair(2)%axis, pair(1)%axis)
    low = 0.0_wp
    high = 0.0_wp
    first = 0.0_wp
    do frame = 1, film%n_frames
      at = film%local(frame, pair(2)%link, film%position(frame, common, contact))
      if (frame == 1) first = at
      low = min(low, dot_product(at - first, pair(2)%own_axis))
      high = max(high, dot_product(at - first, pair(2)%own_axis))
    end do
    call append_figure(pair(2)%link, reshape([first + (low - abs(travel))*pair(2)%own_axis, &
                                              first + (high + abs(travel))*pair(2)%own_axis], [3, 2]), wheel_figure, skeleton)
  end subroutine add_rack

  !> Add two pulleys, and the straight parts of the belt, which stand still relative to the link that carries the
  !> pulleys.
  subroutine add_belt(pair, common, radii, crossed, skeleton)
    type(partner_type), intent(in) :: pair(2)       !< both pulleys
    integer, intent(in) :: common                   !< number of the link that carries both
    real(wp), intent(in) :: radii(2)                !< of the pulleys [m]
    logical, intent(in) :: crossed                  !< the belt is crossed
    type(skeleton_type), intent(inout) :: skeleton  !< gets the circles and the lines
    real(wp) :: apart(3), along(3), across(3), normal(3), sine, other
    integer :: side

    if (norm2(cross(pair(1)%axis, pair(2)%axis)) > parallel) return
    apart = pair(2)%point - pair(1)%point
    apart = apart - dot_product(apart, pair(1)%axis)*pair(1)%axis
    other = merge(-radii(2), radii(2), crossed)
    if (norm2(apart) <= abs(radii(1) - other) .or. maxval(radii) > largest*skeleton%size) return
    call add_circle(pair(1), 0.0_wp, radii(1), .false., skeleton)
    call add_circle(pair(2), dot_product(pair(1)%point - pair(2)%point, pair(2)%axis), radii(2), .false., skeleton)
    along = unit(apart)
    across = cross(pair(1)%axis, along)
    sine = (radii(1) - other)/norm2(apart)
    do side = -1, 1, 2
      normal = sine*along + side*sqrt(1.0_wp - sine**2)*across
      call append_figure(common, reshape([pair(1)%point + radii(1)*normal, pair(1)%point + apart + other*normal], [3, 2]), &
                         belt_figure, skeleton)
    end do
  end subroutine add_belt

  !> Add a circle of a wheel about its axis, with a spoke that shows how it turns. A wheel with inner teeth has a short
  !> mark outside. A wheel that meshes with several others is added once.
  subroutine add_circle(wheel, along, radius, inner, skeleton)
    type(partner_type), intent(in) :: wheel         !< pair and link of the wheel
    real(wp), intent(in) :: along                   !< place of its middle on its axis, from the point of the pair [m]
    real(wp), intent(in) :: radius                  !< of the pitch circle [m]
    logical, intent(in) :: inner                    !< its teeth are inside
    type(skeleton_type), intent(inout) :: skeleton  !< gets the circle
    real(wp) :: points(3, corners + 2), middle(3), first(3), second(3), angle
    integer :: i

    if (radius <= same*skeleton%size .or. radius > largest*skeleton%size) return
    middle = wheel%own_point + along*wheel%own_axis
    first = default_zero(wheel%own_axis)
    first = unit(first - dot_product(first, wheel%own_axis)*wheel%own_axis)
    second = cross(wheel%own_axis, first)
    points(:, 1) = middle + merge(1.12_wp, 0.0_wp, inner)*radius*first
    do i = 0, corners
      angle = 2.0_wp*pi*i/corners
      points(:, i + 2) = middle + radius*(cos(angle)*first + sin(angle)*second)
    end do
    do i = 1, size(skeleton%figures)
      associate (figure => skeleton%figures(i))
        if (figure%link /= wheel%link .or. size(figure%points, 2) /= size(points, 2)) cycle
        ! the same circle may run the other way round
        if (maxval(abs(figure%points(:, 2:) - points(:, 2:))) <= same*skeleton%size) return
        if (maxval(abs(figure%points(:, 2:) - points(:, size(points, 2):2:-1))) <= same*skeleton%size) return
      end associate
    end do
    call append_figure(wheel%link, points, wheel_figure, skeleton)
  end subroutine add_circle
end module mech9_wheel_figures
