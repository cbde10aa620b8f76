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
  use mech9_model, only: model_type
  use mech9_sample_mechanisms, only: new_mechanism, add_revolute, add_prismatic, frame, fig1, general_loop
  use mech9_random_geometry, only: random_vector, random_unit
  use mech9_curved_pair, only: curved_pair_type
  use mech9_testing, only: tester_type
  implicit none
  private
  public :: open_chain, loaded_fig1, five_bar, loaded_loop, two_loops, check_each_mechanism
  public :: without_loads, load_everything, add_body, add_load, add_point_masses

  !> Number of the mechanisms of known_mechanism.
  integer, parameter :: known_count = 7

  abstract interface
    !> Checks of one mechanism.
    subroutine check_interface(test, model, why)
      import :: tester_type, model_type
      type(tester_type), intent(inout) :: test   !< counts the checks
      type(model_type), intent(inout) :: model   !< the mechanism, which may be changed
      character(len=*), intent(in) :: why        !< its name, for the report of a failure
    end subroutine check_interface
  end interface

contains

  !> Make the checks for each known mechanism, which is a case of the suite under its name.
  subroutine check_each_mechanism(test, check)
    type(tester_type), intent(inout) :: test   !< counts the checks
    procedure(check_interface) :: check        !< the checks of one mechanism
    type(model_type) :: model
    character(len=:), allocatable :: name
    integer :: number

    do number = 1, known_count
      call known_mechanism(number, model, name)
      if (test%runs(name)) call check(test, model, name)
    end do
  end subroutine check_each_mechanism

  !> One of the mechanisms of this module, with all loads, and its name.
  subroutine known_mechanism(number, model, name)
    integer, intent(in) :: number                          !< from 1 to known_count
    type(model_type), intent(out) :: model                 !< the mechanism
    character(len=:), allocatable, intent(out) :: name     !< for the report of a failure

    select case (number)
    case (1)
      call open_chain(model)
      name = 'open chain'
    case (2)
      call loaded_fig1(5, model)
      name = 'Fig. 1'
    case (3)
      call loaded_fig1(1, model)
      name = 'Fig. 1 in its other coordinate, both chains solved together'
    case (4)
      call five_bar(model)
      name = 'five-bar'
    case (5)
      call loaded_loop(model)
      name = 'general loop'
    case (6)
      call two_loops([1, 5], model)
      name = 'two loops and a branch, with pairs that have no fixed axis'
    case default
      call two_loops([1, 11], model)
      name = 'two loops solved together, and a branch'
    end select
  end subroutine known_mechanism

  !> Three moving links: revolute, prismatic (its links given the other way round), helical; all loads.
  subroutine open_chain(model)
    type(model_type), intent(out) :: model       !< the model
    type(random_type) :: random
    type(pose_type) :: at
    type(screw_pair_type) :: helix

    call new_mechanism(4, reshape([1, 2, 3, 2, 3, 4], [2, 3]), [1, 2, 3], model)
    call add_revolute(model, 1, 1, 2, random_frame(random), random_frame(random))
    call add_prismatic(model, 2, 3, 2, random_frame(random), random_frame(random))
    at = random_frame(random)
    helix = helical_pair(at, random_frame(random), 0.4_wp)
    helix%coordinate = 3
    helix%reference = 3
    helix%moving = 4
    allocate (model%mechanism%pairs(3)%pair, source=helix)
    model%problem%initial%position = [0.4_wp, -0.3_wp, 0.8_wp]
    call load_everything(random, model)
  end subroutine open_chain

  !> The paper's Fig. 1 with the independent coordinate `driven`; all loads, also across the plane.
  subroutine loaded_fig1(driven, model)
    integer, intent(in) :: driven                    !< number of the independent coordinate
    type(model_type), intent(out) :: model           !< the model
    type(random_type) :: random

    call fig1(driven, model)
    ! far from the dead points of q1, which swings between -2.33 and -0.91
    model%problem%initial%position = [-1.69_wp, 2.53_wp, 0.44_wp, -2.25_wp, 2.65_wp, 2.41_wp, 2.01_wp]
    call load_everything(random, model)
  end subroutine loaded_fig1

  !> Five planar links, two degrees of freedom.
  subroutine five_bar(model)
    type(model_type), intent(out) :: model       !< the model
    type(random_type) :: random
    real(wp), parameter :: z(3) = [0.0_wp, 0.0_wp, 1.0_wp], origin(3) = 0.0_wp

    call new_mechanism(5, reshape([1, 2, 2, 3, 3, 4, 4, 5, 1, 5], [2, 5]), [1, 5], model)
    call add_revolute(model, 1, 1, 2, frame(origin, z), frame(origin, z))
    call add_revolute(model, 2, 2, 3, frame([0.8_wp, 0.0_wp, 0.0_wp], z), frame(origin, z))
    call add_revolute(model, 3, 3, 4, frame([1.2_wp, 0.0_wp, 0.0_wp], z), frame([1.3_wp, 0.0_wp, 0.0_wp], z))
    call add_revolute(model, 4, 4, 5, frame(origin, z), frame([0.9_wp, 0.0_wp, 0.0_wp], z))
    call add_revolute(model, 5, 1, 5, frame([1.0_wp, 0.0_wp, 0.0_wp], z), frame(origin, z))
    model%problem%initial%position = [2.1_wp, -1.3_wp, 1.7_wp, -1.5_wp, 1.0_wp]
    call load_everything(random, model)
  end subroutine five_bar

  !> The general spatial loop of seven revolutes, a little away from where it was drawn.
  subroutine loaded_loop(model)
    type(model_type), intent(out) :: model       !< the model
    type(random_type) :: random

    call general_loop(model)
    model%problem%initial%position(1) = -0.2_wp
    call load_everything(random, model)
  end subroutine loaded_loop

  !> Two spatial loops with common links and an open branch of two links that hangs on the second; four
  !> degrees of freedom. Pair 10 is curved and run through against its own direction, pair 15 is
  !> curved and ends in the open branch.
  !>   loop A   1-2-3-4-5-6-7-8-1               coordinates 1 to 8
  !>   loop B   3-9-10-11-12-13-5               coordinates 9 to 14, over links 3, 4, 5 of loop A
  !>   branch   11-14-15                        coordinates 15, 16
  subroutine two_loops(independent, model)
    integer, intent(in) :: independent(2)            !< those of the loops
    type(model_type), intent(out) :: model           !< the model
    integer, parameter :: links(2, 16) = reshape([1, 2, 2, 3, 3, 4, 4, 5, 5, 6, 6, 7, 7, 8, 8, 1, &
                                                  3, 9, 10, 9, 10, 11, 11, 12, 12, 13, 13, 5, 11, 14, 14, 15], [2, 16])
    type(random_type) :: random
    type(pose_type) :: at
    integer :: k

    ! of many geometries one whose loops move freely around the start
    random%seed = 942361_long
    call new_mechanism(15, links, [independent, 15, 16], model)
    do k = 1, 16
      at = random_frame(random)
      if (k == 10 .or. k == 15) then
        call add_curved(model, k, links(1, k), links(2, k))
      else if (k == 16) then
        call add_prismatic(model, k, links(1, k), links(2, k), at, at)
      else
        call add_revolute(model, k, links(1, k), links(2, k), at, at)
      end if
    end do
    model%problem%initial%position(independent) = [0.1_wp, -0.05_wp]
    model%problem%initial%position(15:16) = [0.7_wp, 0.2_wp]
    call load_everything(random, model)
  end subroutine two_loops

  subroutine add_curved(model, k, reference, moving)
    type(model_type), intent(inout) :: model           !< the model
    integer, intent(in) :: k                           !< coordinate of the pair
    integer, intent(in) :: reference                   !< number of its reference link
    integer, intent(in) :: moving                      !< number of its moving link
    type(curved_pair_type) :: pair

    pair%coordinate = k
    pair%reference = reference
    pair%moving = moving
    pair%angular = .false.
    allocate (model%mechanism%pairs(k)%pair, source=pair)
  end subroutine add_curved

  function random_frame(random) result(at)
    type(random_type), intent(inout) :: random   !< source of the random numbers
    type(pose_type) :: at
    real(wp) :: point(3)

    point = random_vector(random)
    at = frame(point, random_unit(random))
  end function random_frame

  !> No bodies, no loads, no gravity.
  subroutine without_loads(model)
    type(model_type), intent(inout) :: model       !< the model

    model%mechanism%gravity = 0.0_wp
    if (allocated(model%mechanism%bodies)) deallocate (model%mechanism%bodies)
    if (allocated(model%mechanism%loads)) deallocate (model%mechanism%loads)
    allocate (model%mechanism%bodies(0), model%mechanism%loads(0))
  end subroutine without_loads

  !> A body on every moving link, gravity, and loads of every kind on moving links, between them and to the
  !> frame, on every coordinate.
  subroutine load_everything(random, model)
    type(random_type), intent(inout) :: random         !< source of the random numbers
    type(model_type), intent(inout) :: model           !< the model
    integer :: i, k, last

    call without_loads(model)
    model%mechanism%gravity = [0.7_wp, -9.0_wp, 3.0_wp]
    last = model%mechanism%structure%n_links
    do i = 2, last
      call add_point_masses(model, i, random_masses(random), together=.true.)
    end do
    call add_load(model, force_load_type(link=last, position=random_vector(random), force=9.0_wp*random_unit(random)))
    call add_load(model, force_load_type(link=3, position=random_vector(random), force=7.0_wp*random_unit(random), &
                                             turns_with_link=.true.))
    call add_load(model, force_load_type(link=2, torque=5.0_wp*random_unit(random)))
    call add_load(model, force_load_type(link=last, torque=6.0_wp*random_unit(random), turns_with_link=.true.))
    call add_load(model, spring_load_type(links=[1, last], positions=ends(random), stiffness=11.0_wp, &
                                              free_length=0.4_wp, damping=2.0_wp))
    call add_load(model, spring_load_type(links=[last - 1, 2], positions=ends(random), stiffness=8.0_wp, &
                                              free_length=0.6_wp, damping=1.5_wp))
    do k = 1, model%mechanism%structure%n_coordinates
      call add_load(model, coordinate_load_type(coordinate=k, stiffness=1.0_wp + 0.2_wp*k, rest=0.3_wp*k, &
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
  subroutine add_point_masses(model, link, points, together)
    type(model_type), intent(inout) :: model           !< the model
    integer, intent(in) :: link                        !< link that carries the points
    real(wp), intent(in) :: points(:, :)               !< (4, n): x, y, z, mass
    logical, intent(in) :: together                    !< one body, not one for each point
    real(wp) :: mass, centre(3), inertia(3, 3), arm(3)
    integer :: i, j

    if (.not. together) then
      do i = 1, size(points, 2)
        call add_body(model, link, points(4, i), points(1:3, i), 0.0_wp*identity)
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
    call add_body(model, link, mass, centre, inertia)
  end subroutine add_point_masses

  subroutine add_body(model, link, mass, centre, inertia)
    type(model_type), intent(inout) :: model           !< the model
    integer, intent(in) :: link                        !< its number
    real(wp), intent(in) :: mass                       !< [kg]
    real(wp), intent(in) :: centre(3)                  !< mass centre in the link [m]
    real(wp), intent(in) :: inertia(3, 3)              !< about the mass centre [kg m^2]

    model%mechanism%bodies = [model%mechanism%bodies, body_type(link=link, mass=mass, centre=centre, inertia=inertia)]
  end subroutine add_body

  subroutine add_load(model, load)
    type(model_type), intent(inout) :: model           !< the model
    class(load_type), intent(in) :: load               !< load that is added
    type(load_slot_type), allocatable :: longer(:)
    integer :: i

    allocate (longer(size(model%mechanism%loads) + 1))
    do i = 1, size(model%mechanism%loads)
      call move_alloc(model%mechanism%loads(i)%load, longer(i)%load)
    end do
    allocate (longer(size(longer))%load, source=load)
    call move_alloc(longer, model%mechanism%loads)
  end subroutine add_load
end module mech9_loaded_mechanisms
