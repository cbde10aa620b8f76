!> Mechanisms with bodies and loads, built in code for the tests of the dynamics floor.
module mech9_loaded_mechanisms
  use mech9_kinds, only: wp, long
  use mech9_rotation, only: identity
  use mech9_pose, only: pose_type
  use mech9_random, only: random_type
  use mech9_screw_pair, only: screw_pair_type, helical_pair
  use mech9_body, only: body_type
  use mech9_load, only: load_type, load_slot_type
  use mech9_force_load, only: force_load_type
  use mech9_spring_load, only: spring_load_type
  use mech9_coordinate_load, only: coordinate_load_type
  use mech9_mechanism, only: mechanism_type
  use mech9_sample_mechanisms, only: new_mechanism, add_revolute, add_prismatic, frame, fig1, general_loop
  use mech9_random_geometry, only: random_vector, random_unit
  use mech9_curved_pair, only: curved_pair_type
  implicit none
  private
  public :: open_chain, loaded_fig1, five_bar, loaded_loop, two_loops
  public :: without_loads, load_everything, add_body, add_load, add_point_masses

contains

  !> Three moving links: revolute, prismatic (its links given the other way round), helical; all loads.
  subroutine open_chain(mechanism)
    type(mechanism_type), intent(out) :: mechanism   !< the mechanism
    type(random_type) :: random
    type(pose_type) :: at
    type(screw_pair_type) :: helix

    call new_mechanism(4, reshape([1, 2, 3, 2, 3, 4], [2, 3]), [1, 2, 3], mechanism)
    call add_revolute(mechanism, 1, 1, 2, random_frame(random), random_frame(random))
    call add_prismatic(mechanism, 2, 3, 2, random_frame(random), random_frame(random))
    at = random_frame(random)
    helix = helical_pair(at, random_frame(random), 0.4_wp)
    helix%coordinate = 3
    helix%reference = 3
    helix%moving = 4
    allocate (mechanism%pairs(3)%pair, source=helix)
    mechanism%initial_position = [0.4_wp, -0.3_wp, 0.8_wp]
    call load_everything(random, mechanism)
  end subroutine open_chain

  !> The paper's Fig. 1 with the independent coordinate `driven`; all loads, also across the plane.
  subroutine loaded_fig1(driven, mechanism)
    integer, intent(in) :: driven                    !< number of the independent coordinate
    type(mechanism_type), intent(out) :: mechanism   !< the mechanism
    type(random_type) :: random

    call fig1(driven, mechanism)
    ! far from the dead points of q1, which swings between -2.33 and -0.91
    mechanism%initial_position = [-1.69_wp, 2.53_wp, 0.44_wp, -2.25_wp, 2.65_wp, 2.41_wp, 2.01_wp]
    call load_everything(random, mechanism)
  end subroutine loaded_fig1

  !> Five planar links, two degrees of freedom.
  subroutine five_bar(mechanism)
    type(mechanism_type), intent(out) :: mechanism   !< the mechanism
    type(random_type) :: random
    real(wp), parameter :: z(3) = [0.0_wp, 0.0_wp, 1.0_wp], origin(3) = 0.0_wp

    call new_mechanism(5, reshape([1, 2, 2, 3, 3, 4, 4, 5, 1, 5], [2, 5]), [1, 5], mechanism)
    call add_revolute(mechanism, 1, 1, 2, frame(origin, z), frame(origin, z))
    call add_revolute(mechanism, 2, 2, 3, frame([0.8_wp, 0.0_wp, 0.0_wp], z), frame(origin, z))
    call add_revolute(mechanism, 3, 3, 4, frame([1.2_wp, 0.0_wp, 0.0_wp], z), frame([1.3_wp, 0.0_wp, 0.0_wp], z))
    call add_revolute(mechanism, 4, 4, 5, frame(origin, z), frame([0.9_wp, 0.0_wp, 0.0_wp], z))
    call add_revolute(mechanism, 5, 1, 5, frame([1.0_wp, 0.0_wp, 0.0_wp], z), frame(origin, z))
    mechanism%initial_position = [2.1_wp, -1.3_wp, 1.7_wp, -1.5_wp, 1.0_wp]
    call load_everything(random, mechanism)
  end subroutine five_bar

  !> The general spatial loop of seven revolutes, a little away from where it was drawn.
  subroutine loaded_loop(mechanism)
    type(mechanism_type), intent(out) :: mechanism   !< the mechanism
    type(random_type) :: random

    call general_loop(mechanism)
    mechanism%initial_position(1) = -0.2_wp
    call load_everything(random, mechanism)
  end subroutine loaded_loop

  !> Two spatial loops with common links and an open branch of two links that hangs on the second; four
  !> degrees of freedom. Pair 10 is curved and run through against its own direction, pair 15 is
  !> curved and ends in the open branch.
  !>   loop A   1-2-3-4-5-6-7-8-1               coordinates 1 to 8
  !>   loop B   3-9-10-11-12-13-5               coordinates 9 to 14, over links 3, 4, 5 of loop A
  !>   branch   11-14-15                        coordinates 15, 16
  subroutine two_loops(independent, mechanism)
    integer, intent(in) :: independent(2)            !< those of the loops
    type(mechanism_type), intent(out) :: mechanism   !< the mechanism
    integer, parameter :: links(2, 16) = reshape([1, 2, 2, 3, 3, 4, 4, 5, 5, 6, 6, 7, 7, 8, 8, 1, &
                                                  3, 9, 10, 9, 10, 11, 11, 12, 12, 13, 13, 5, 11, 14, 14, 15], [2, 16])
    type(random_type) :: random
    type(pose_type) :: at
    integer :: k

    ! of many geometries one whose loops move freely around the start
    random%seed = 942361_long
    call new_mechanism(15, links, [independent, 15, 16], mechanism)
    do k = 1, 16
      at = random_frame(random)
      if (k == 10 .or. k == 15) then
        call add_curved(mechanism, k, links(1, k), links(2, k))
      else if (k == 16) then
        call add_prismatic(mechanism, k, links(1, k), links(2, k), at, at)
      else
        call add_revolute(mechanism, k, links(1, k), links(2, k), at, at)
      end if
    end do
    mechanism%initial_position(independent) = [0.1_wp, -0.05_wp]
    mechanism%initial_position(15:16) = [0.7_wp, 0.2_wp]
    call load_everything(random, mechanism)
  end subroutine two_loops

  subroutine add_curved(mechanism, k, reference, moving)
    type(mechanism_type), intent(inout) :: mechanism   !< the mechanism
    integer, intent(in) :: k                           !< coordinate of the pair
    integer, intent(in) :: reference                   !< number of its reference link
    integer, intent(in) :: moving                      !< number of its moving link
    type(curved_pair_type) :: pair

    pair%coordinate = k
    pair%reference = reference
    pair%moving = moving
    pair%angular = .false.
    allocate (mechanism%pairs(k)%pair, source=pair)
  end subroutine add_curved

  function random_frame(random) result(at)
    type(random_type), intent(inout) :: random   !< source of the random numbers
    type(pose_type) :: at
    real(wp) :: point(3)

    point = random_vector(random)
    at = frame(point, random_unit(random))
  end function random_frame

  !> No bodies, no loads, no gravity.
  subroutine without_loads(mechanism)
    type(mechanism_type), intent(inout) :: mechanism   !< the mechanism

    mechanism%gravity = 0.0_wp
    if (allocated(mechanism%bodies)) deallocate (mechanism%bodies)
    if (allocated(mechanism%loads)) deallocate (mechanism%loads)
    allocate (mechanism%bodies(0), mechanism%loads(0))
  end subroutine without_loads

  !> A body on every moving link, gravity, and loads of every kind on moving links, between them and to the
  !> frame, on every coordinate.
  subroutine load_everything(random, mechanism)
    type(random_type), intent(inout) :: random         !< source of the random numbers
    type(mechanism_type), intent(inout) :: mechanism   !< the mechanism
    integer :: i, k, last

    call without_loads(mechanism)
    mechanism%gravity = [0.7_wp, -9.0_wp, 3.0_wp]
    last = mechanism%structure%n_links
    do i = 2, last
      call add_point_masses(mechanism, i, random_masses(random), together=.true.)
    end do
    call add_load(mechanism, force_load_type(link=last, position=random_vector(random), force=9.0_wp*random_unit(random)))
    call add_load(mechanism, force_load_type(link=3, position=random_vector(random), force=7.0_wp*random_unit(random), &
                                             turns_with_link=.true.))
    call add_load(mechanism, force_load_type(link=2, torque=5.0_wp*random_unit(random)))
    call add_load(mechanism, force_load_type(link=last, torque=6.0_wp*random_unit(random), turns_with_link=.true.))
    call add_load(mechanism, spring_load_type(links=[1, last], positions=ends(random), stiffness=11.0_wp, &
                                              free_length=0.4_wp, damping=2.0_wp))
    call add_load(mechanism, spring_load_type(links=[last - 1, 2], positions=ends(random), stiffness=8.0_wp, &
                                              free_length=0.6_wp, damping=1.5_wp))
    do k = 1, mechanism%structure%n_coordinates
      call add_load(mechanism, coordinate_load_type(coordinate=k, stiffness=1.0_wp + 0.2_wp*k, rest=0.3_wp*k, &
                                                    damping=0.4_wp, force=2.0_wp - 0.5_wp*k))
    end do
  end subroutine load_everything

  function ends(random) result(positions)
    type(random_type), intent(inout) :: random   !< source of the random numbers
    real(wp) :: positions(3, 2)

    positions(:, 1) = random_vector(random)
    positions(:, 2) = random_vector(random)
  end function ends

  !> Five points (x, y, z, mass).
  function random_masses(random) result(points)
    type(random_type), intent(inout) :: random   !< source of the random numbers
    real(wp) :: points(4, 5)
    integer :: i

    do i = 1, 5
      points(1:3, i) = random_vector(random)
      points(4, i) = 0.3_wp + 0.2_wp*random%symmetric()
    end do
  end function random_masses

  !> Points with mass on a link: together as one body, by its mass, centre and tensor, or a body each.
  subroutine add_point_masses(mechanism, link, points, together)
    type(mechanism_type), intent(inout) :: mechanism   !< the mechanism
    integer, intent(in) :: link                        !< that carries the points
    real(wp), intent(in) :: points(:, :)               !< (4, n): x, y, z, mass
    logical, intent(in) :: together                    !< one body, not one for each point
    real(wp) :: mass, centre(3), inertia(3, 3), arm(3)
    integer :: i, j

    if (.not. together) then
      do i = 1, size(points, 2)
        call add_body(mechanism, link, points(4, i), points(1:3, i), 0.0_wp*identity)
      end do
      return
    end if
    mass = sum(points(4, :))
    centre = matmul(points(1:3, :), points(4, :))/mass
    inertia = 0.0_wp
    do i = 1, size(points, 2)
      arm = points(1:3, i) - centre
      do j = 1, 3
        inertia(:, j) = inertia(:, j) + points(4, i)*(dot_product(arm, arm)*identity(:, j) - arm*arm(j))
      end do
    end do
    call add_body(mechanism, link, mass, centre, inertia)
  end subroutine add_point_masses

  subroutine add_body(mechanism, link, mass, centre, inertia)
    type(mechanism_type), intent(inout) :: mechanism   !< the mechanism
    integer, intent(in) :: link                        !< its number
    real(wp), intent(in) :: mass                       !< [kg]
    real(wp), intent(in) :: centre(3)                  !< mass centre in the link [m]
    real(wp), intent(in) :: inertia(3, 3)              !< about the mass centre [kg m^2]

    mechanism%bodies = [mechanism%bodies, body_type(link=link, mass=mass, centre=centre, inertia=inertia)]
  end subroutine add_body

  subroutine add_load(mechanism, load)
    type(mechanism_type), intent(inout) :: mechanism   !< the mechanism
    class(load_type), intent(in) :: load               !< that is added
    type(load_slot_type), allocatable :: longer(:)
    integer :: i

    allocate (longer(size(mechanism%loads) + 1))
    do i = 1, size(mechanism%loads)
      call move_alloc(mechanism%loads(i)%load, longer(i)%load)
    end do
    allocate (longer(size(longer))%load, source=load)
    call move_alloc(longer, mechanism%loads)
  end subroutine add_load
end module mech9_loaded_mechanisms
