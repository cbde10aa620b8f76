!> The wheels that a linear coupling of turning pairs stands for. Pairs of one link are meshed wheels of that link. Other equations are those of
!> planetary gears: by the weights with which the angular velocities of links enter, one link is the carrier of the two others
!> (R. Willis, Principles of Mechanism, 1841).
module mech9_gear_meshes
  use mech9_kinds, only: wp
  use mech9_rotation, only: cross, turn_back
  use mech9_film, only: film_type
  use mech9_pair_axes, only: turning
  use mech9_skeleton, only: skeleton_type
  implicit none
  private
  public :: partner_type, find_partners, find_planetary

  !> A pair of a coupling, as it is seen from the link that both pairs of the coupling share.
  type :: partner_type
    integer :: link = 0                 !< the other link, a wheel or a rack
    integer :: side = 1                 !< 1: the common link is the reference link of the pair, 2: its moving link
    real(wp) :: point(3) = 0.0_wp       !< of the axis, in the common link [m]
    real(wp) :: axis(3) = 0.0_wp        !< its direction, in the common link, of unit length
    real(wp) :: own_point(3) = 0.0_wp   !< the point, in the other link [m]
    real(wp) :: own_axis(3) = 0.0_wp    !< the direction, in the other link
  end type partner_type

  !> Lengths below this part of the mechanism's size are zero, sines below the second number, and weights below this part of the
  !> largest one.
  real(wp), parameter :: same = 0.001_wp, parallel = 1.0e-6_wp, no_weight = 1.0e-9_wp
  integer, parameter :: most_links = 8    !< links of an equation, at most

contains

  !> Find both pairs of a coupling, as seen from the link that they share; no link: 0.
  subroutine find_partners(skeleton, coordinates, pair, common)
    type(skeleton_type), intent(in) :: skeleton      !< places at which the pairs are drawn
    integer, intent(in) :: coordinates(2)            !< numbers of the pairs
    type(partner_type), intent(out) :: pair(2)       !< both pairs
    integer, intent(out) :: common                   !< number of the link that they share; 0: none, or both links
    integer :: i, j, shared

    common = 0
    shared = 0
    do i = 1, 2
      do j = 1, 2
        if (skeleton%places(coordinates(1))%links(i) /= skeleton%places(coordinates(2))%links(j)) cycle
        common = skeleton%places(coordinates(1))%links(i)
        shared = shared + 1
        pair(1)%side = i
        pair(2)%side = j
      end do
    end do
    if (shared /= 1) common = 0
    if (common == 0) return
    do i = 1, 2
      associate (place => skeleton%places(coordinates(i)), side => pair(i)%side)
        pair(i)%link = place%links(3 - side)
        pair(i)%point = place%points(:, side)
        pair(i)%axis = place%axes(:, side)
        pair(i)%own_point = place%points(:, 3 - side)
        pair(i)%own_axis = place%axes(:, 3 - side)
      end associate
    end do
  end subroutine find_partners

  !> Find the two wheels of a linear equation of turning pairs with parallel axes, and their carrier. Wheels about one axis have planets
  !> between them that are no links; they are then told apart from the carrier by the signs of the weights.
  subroutine find_planetary(film, skeleton, coordinates, coefficients, pair, carrier, ratio)
    type(film_type), intent(in) :: film              !< poses at the outputs of the run; the first one is used
    type(skeleton_type), intent(in) :: skeleton      !< places at which the pairs are drawn
    integer, intent(in) :: coordinates(:)            !< numbers of the pairs
    real(wp), intent(in) :: coefficients(:)          !< of their coordinates
    type(partner_type), intent(out) :: pair(2)       !< both wheels, their axes in one direction
    integer, intent(out) :: carrier                  !< number of the link that carries both; 0: the equation is that of no gear
    real(wp), intent(out) :: ratio                   !< turn of the second wheel per turn of the first one, seen from the carrier
    integer :: links(most_links), n, i, wheels(2)
    real(wp) :: weights(most_links)
    logical :: found, coaxial

    carrier = 0
    ratio = 0.0_wp
    call find_weights(film, skeleton, coordinates, coefficients, links, weights, n)
    if (n /= 3) return
    do i = 1, 3
      wheels = pack([1, 2, 3], [1, 2, 3] /= i)
      call find_axis(film, skeleton, links(wheels(1)), links(i), coordinates(1), pair(1), found)
      if (found) call find_axis(film, skeleton, links(wheels(2)), links(i), coordinates(1), pair(2), found)
      if (.not. found) cycle
      coaxial = norm2(cross(pair(1)%axis, pair(2)%point - pair(1)%point)) <= same*skeleton%size
      if (coaxial .and. weights(wheels(1))*weights(wheels(2)) < 0.0_wp) cycle
      carrier = links(i)
      ratio = -weights(wheels(1))/weights(wheels(2))
      if (.not. coaxial) return
    end do
    if (carrier == 0) return
    ! the last one that was found may belong to a later carrier
    i = findloc(links(:3), carrier, dim=1)
    wheels = pack([1, 2, 3], [1, 2, 3] /= i)
    call find_axis(film, skeleton, links(wheels(1)), carrier, coordinates(1), pair(1), found)
    call find_axis(film, skeleton, links(wheels(2)), carrier, coordinates(1), pair(2), found)
  end subroutine find_planetary

  !> Find the links whose angular velocities enter an equation, with their weights; none where axes are not parallel.
  subroutine find_weights(film, skeleton, coordinates, coefficients, links, weights, n)
    type(film_type), intent(in) :: film              !< poses at the outputs of the run; the first one is used
    type(skeleton_type), intent(in) :: skeleton      !< places at which the pairs are drawn
    integer, intent(in) :: coordinates(:)            !< numbers of the pairs
    real(wp), intent(in) :: coefficients(:)          !< of their coordinates
    integer, intent(out) :: links(most_links)        !< numbers of the links
    real(wp), intent(out) :: weights(most_links)     !< their weights, none of them zero
    integer, intent(out) :: n                        !< how many there are; 0: the equation is that of no gear
    real(wp) :: sum_of(size(film%p, 2)), first(3), axis(3), sense
    integer :: i

    n = 0
    links = 0
    weights = 0.0_wp
    sum_of = 0.0_wp
    first = axis_of(film, skeleton, coordinates(1))
    do i = 1, size(coordinates)
      if (skeleton%places(coordinates(i))%kind /= turning) return
      axis = axis_of(film, skeleton, coordinates(i))
      if (norm2(cross(first, axis)) > parallel) return
      sense = sign(coefficients(i), coefficients(i)*dot_product(first, axis))
      associate (pair_links => skeleton%places(coordinates(i))%links)
        sum_of(pair_links(2)) = sum_of(pair_links(2)) + sense
        sum_of(pair_links(1)) = sum_of(pair_links(1)) - sense
      end associate
    end do
    do i = 1, size(sum_of)
      if (abs(sum_of(i)) <= no_weight*maxval(abs(sum_of))) cycle
      n = n + 1
      if (n > most_links) exit
      links(n) = i
      weights(n) = sum_of(i)
    end do
    if (n > most_links) n = 0
  end subroutine find_weights

  !> The direction of a turning pair's axis in the first frame, in the axes of link 1.
  pure function axis_of(film, skeleton, k) result(axis)
    type(film_type), intent(in) :: film              !< poses at the outputs of the run
    type(skeleton_type), intent(in) :: skeleton      !< places at which the pairs are drawn
    integer, intent(in) :: k                         !< number of the pair
    real(wp) :: axis(3)

    axis = film%direction(1, skeleton%places(k)%links(1), skeleton%places(k)%axes(:, 1))
  end function axis_of

  !> Find the axis about which a wheel turns on a carrier: that of a pair between both, or of two pairs about one line that join them by
  !> a third link.
  subroutine find_axis(film, skeleton, wheel, carrier, like, pair, found)
    type(film_type), intent(in) :: film              !< poses at the outputs of the run; the first one is used
    type(skeleton_type), intent(in) :: skeleton      !< places at which the pairs are drawn
    integer, intent(in) :: wheel                     !< number of its link
    integer, intent(in) :: carrier                   !< number of its link
    integer, intent(in) :: like                      !< pair whose axis is parallel
    type(partner_type), intent(out) :: pair          !< the wheel, with its axis in the direction of that pair
    logical, intent(out) :: found                    !< there is such an axis
    real(wp) :: axis(3), at(3)
    integer :: i, j

    axis = axis_of(film, skeleton, like)
    found = .false.
    do i = 1, size(skeleton%places)
      if (.not. turns(i) .or. .not. any(skeleton%places(i)%links == wheel)) cycle
      at = film%position(1, skeleton%places(i)%links(1), skeleton%places(i)%points(:, 1))
      found = any(skeleton%places(i)%links == carrier)
      do j = 1, size(skeleton%places)
        if (found) exit
        if (.not. turns(j) .or. j == i .or. .not. any(skeleton%places(j)%links == carrier)) cycle
        if (.not. any(skeleton%places(j)%links == third(i))) cycle
        found = norm2(cross(axis, film%position(1, skeleton%places(j)%links(1), skeleton%places(j)%points(:, 1)) - at)) &
                <= same*skeleton%size
      end do
      if (found) exit
    end do
    if (.not. found) return
    pair%link = wheel
    pair%point = film%local(1, carrier, at)
    pair%axis = turn_back(film%r(:, :, carrier, 1), axis)
    pair%own_point = film%local(1, wheel, at)
    pair%own_axis = turn_back(film%r(:, :, wheel, 1), axis)

  contains

    !> Whether a pair turns about an axis of this direction.
    logical function turns(k)
      integer, intent(in) :: k   !< number of the pair

      turns = skeleton%places(k)%kind == turning
      if (turns) turns = norm2(cross(axis, axis_of(film, skeleton, k))) <= parallel
    end function turns

    !> The other link of a pair of the wheel.
    integer function third(k)
      integer, intent(in) :: k   !< number of the pair

      third = sum(skeleton%places(k)%links) - wheel
    end function third
  end subroutine find_axis
end module mech9_gear_meshes
