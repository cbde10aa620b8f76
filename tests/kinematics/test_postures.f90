!> Assemblies count postures: which links only form joints, and the forty positions of Dietmaier's platform.
module test_postures
  use mech9_kinds, only: wp
  use mech9_error, only: error_type
  use mech9_body, only: body_type
  use mech9_model, only: model_type
  use mech9_plan, only: plan_type
  use mech9_state, only: state_type
  use mech9_planning, only: make_plan
  use mech9_frame_motion, only: place_all, link_motion
  use mech9_joint_links, only: find_joint_links, posture_link, joint_link, rod_link
  use mech9_assemblies, only: assembly_list_type, find_assemblies
  use mech9_sample_mechanisms, only: new_mechanism, add_revolute, add_prismatic, frame, four_bar
  use mech9_testing, only: tester_type
  implicit none
  private
  public :: run

  real(wp), parameter :: x(3) = [1.0_wp, 0.0_wp, 0.0_wp], y(3) = [0.0_wp, 1.0_wp, 0.0_wp], z(3) = [0.0_wp, 0.0_wp, 1.0_wp]
  real(wp), parameter :: origin(3) = 0.0_wp, near = 1.0e-11_wp
  !> Centres of the joints on base and platform, and the lengths of the legs (Dietmaier in docs/reference/bibliography.md).
  real(wp), parameter :: base(3, 6) = reshape([0.0_wp, 0.0_wp, 0.0_wp, 1.107915_wp, 0.0_wp, 0.0_wp, 0.549094_wp, 0.756063_wp, &
    0.0_wp, 0.735077_wp, -0.223935_wp, 0.525991_wp, 0.514188_wp, -0.526063_wp, -0.368418_wp, 0.590473_wp, 0.094733_wp, &
    -0.205018_wp], [3, 6])
  real(wp), parameter :: plate(3, 6) = reshape([0.0_wp, 0.0_wp, 0.0_wp, 0.542805_wp, 0.0_wp, 0.0_wp, 0.956919_wp, -0.528915_wp, &
    0.0_wp, 0.665885_wp, -0.353482_wp, 1.402538_wp, 0.478359_wp, 1.158742_wp, 0.107672_wp, -0.137087_wp, -0.235121_wp, &
    0.353913_wp], [3, 6])
  real(wp), parameter :: legs(6) = [1.0_wp, 0.645275_wp, 1.086284_wp, 1.503439_wp, 1.281933_wp, 0.771071_wp]

contains

  !> Run the cases of this suite.
  subroutine run(test)
    type(tester_type), intent(inout) :: test   !< selects cases and counts their checks

    if (test%runs('links_of_a_platform')) call links_of_a_platform(test)
    if (test%runs('links_of_chains')) call links_of_chains(test)
    if (test%runs('forty_postures')) call forty_postures(test)
    if (test%runs('rods_with_points')) call rods_with_points(test)
  end subroutine run

  !> The platform (link 2). Leg i has the links 5 i - 2 to 5 i + 2: one of a universal joint at the base, two parts that slide,
  !> and two of a ball joint at the platform.
  subroutine platform(n_legs, model)
    integer, intent(in) :: n_legs            !< number of legs; the first ones
    type(model_type), intent(out) :: model   !< the model, with the lengths of the legs
    integer :: links(2, 6*n_legs), i, k, l

    do i = 1, n_legs
      l = 5*i - 2
      links(:, 6*i - 5:6*i) = reshape([1, l, l, l + 1, l + 1, l + 2, l + 2, l + 3, l + 3, l + 4, l + 4, 2], [2, 6])
    end do
    call new_mechanism(2 + 5*n_legs, links, [(6*i - 3, i=1, n_legs)], model)
    do i = 1, n_legs
      k = 6*i - 5
      call add_revolute(model, k, links(1, k), links(2, k), frame(base(:, i), z), frame(origin, z))
      call add_revolute(model, k + 1, links(1, k + 1), links(2, k + 1), frame(origin, y), frame(origin, y))
      call add_prismatic(model, k + 2, links(1, k + 2), links(2, k + 2), frame(origin, x), frame(origin, x))
      call add_revolute(model, k + 3, links(1, k + 3), links(2, k + 3), frame(origin, x), frame(origin, x))
      call add_revolute(model, k + 4, links(1, k + 4), links(2, k + 4), frame(origin, y), frame(origin, y))
      call add_revolute(model, k + 5, links(1, k + 5), links(2, k + 5), frame(origin, z), frame(plate(:, i), z))
      model%problem%initial%position(k + 2) = legs(i)
    end do
  end subroutine platform

  !> The roles of a platform's links, bare and with a point or a body on some of them.
  subroutine links_of_a_platform(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(model_type) :: model
    integer, parameter :: leg(5) = [joint_link, rod_link, rod_link, joint_link, joint_link]
    integer :: roles(32), i

    call platform(6, model)
    call find_joint_links(model%mechanism, near, roles)
    call test%is_true(all(roles == [posture_link, posture_link, (leg, i=1, 6)]), &
                      'universal joints, ball joints and legs between them are found')
    call give_points(model, [4, 2])
    call find_joint_links(model%mechanism, near, roles)
    call test%is_true(all(roles(3:7) == leg), 'a point on a leg leaves it a leg')
    model%mechanism%points%link = 6
    call find_joint_links(model%mechanism, near, roles)
    call test%is_true(roles(6) == posture_link .and. all(roles(4:5) == posture_link), &
                      'a link with a point is none of a ball joint, and the leg has none any more')
    model%mechanism%points%link = 2
    model%mechanism%bodies = [body_type(link=7, mass=1.0_wp)]
    call find_joint_links(model%mechanism, near, roles)
    call test%is_true(all(roles(4:5) == posture_link) .and. roles(7) == posture_link, 'a link with mass is none of a ball joint')
    call test%is_true(all(roles(8:12) == leg), 'the other legs remain')
  end subroutine links_of_a_platform

  !> Links of planar and spherical chains have positions of their own.
  subroutine links_of_chains(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    integer, parameter :: links(2, 4) = reshape([1, 2, 2, 3, 3, 4, 1, 4], [2, 4])
    type(model_type) :: model
    integer :: roles(4)

    call four_bar(1.0_wp, 0.4_wp, 0.9_wp, 0.7_wp, [0.0_wp, 1.0_wp, 1.0_wp, 1.7_wp], model)
    call find_joint_links(model%mechanism, near, roles)
    call test%is_true(all(roles == posture_link), 'links of a planar four-bar')
    call new_mechanism(4, links, [1], model)
    call add_revolute(model, 1, 1, 2, frame(origin, x), frame(origin, x))
    call add_revolute(model, 2, 2, 3, frame(origin, y), frame(origin, y))
    call add_revolute(model, 3, 3, 4, frame(origin, z), frame(origin, z))
    call add_revolute(model, 4, 1, 4, frame(origin, x + y), frame(origin, y))
    call find_joint_links(model%mechanism, near, roles)
    call test%is_true(all(roles == posture_link), 'links of a spherical four-bar')
    call give_points(model, [2])
    call find_joint_links(model%mechanism, near, roles)
    call test%is_true(all(roles == posture_link), 'links of a spherical four-bar with a point')
  end subroutine links_of_chains

  !> Dietmaier's platform has forty positions, and each of them very many settings of its joints.
  subroutine forty_postures(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(model_type) :: model
    type(plan_type) :: plan
    type(state_type) :: state
    type(assembly_list_type) :: list
    type(error_type), allocatable :: err
    real(wp) :: worst
    integer :: i

    call platform(6, model)
    call make_plan(model%mechanism, model%problem%partition, model%problem%initial%position, plan, state, err)
    call test%no_error(err, 'the platform is assembled')
    if (allocated(err)) return
    call find_assemblies(model%mechanism, plan, state, 500, list)
    ! four of them are reached from one start in five hundred together
    call test%is_true(size(list%found) >= 34 .and. size(list%found) <= 40, &
                      'the platform has forty postures, most of which are found')
    worst = 0.0_wp
    do i = 1, size(list%found)
      state%q = list%q(:, i)
      call place_all(plan, state, err)
      worst = max(worst, leg_error(plan, state))
    end do
    ! angles of some radians are closed to some 1e-15, over the conditioning of these positions
    call test%near(worst, 0.0_wp, 1.0e-12_wp, 'the platform is as far from the base as the legs are long')
  end subroutine forty_postures

  !> The largest difference between the length of a leg and the distance of its ends, by the pose of the platform.
  real(wp) function leg_error(plan, state) result(worst)
    type(plan_type), intent(in) :: plan     !< the plan of the platform
    type(state_type), intent(in) :: state   !< with frames in place
    real(wp) :: r(3, 3), p(3), omega(3), v(3)
    integer :: i

    call link_motion(plan, state, 2, r, p, omega, v)
    worst = 0.0_wp
    do i = 1, 6
      worst = max(worst, abs(norm2(p + matmul(r, plate(:, i)) - base(:, i)) - legs(i)))
    end do
  end function leg_error

  !> A rod between a ball joint and a universal joint can be turned by half a turn. A point beside its line tells the two ways, and
  !> one on the line does not.
  subroutine rods_with_points(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(model_type) :: model
    type(plan_type) :: plan
    type(state_type) :: state
    type(assembly_list_type) :: list, others
    type(error_type), allocatable :: err
    integer :: i

    call crank_and_rocker(model)
    call make_plan(model%mechanism, model%problem%partition, model%problem%initial%position, plan, state, err)
    call test%no_error(err, 'a spatial crank and rocker is assembled')
    if (allocated(err)) return
    call find_assemblies(model%mechanism, plan, state, 60, list)
    call test%is_true(size(list%found) == 2, 'a rocker has two angles')
    do i = 0, 1
      call give_points(model, [5])
      model%mechanism%points(1)%position = 0.3_wp*x + 0.1_wp*i*y
      call find_assemblies(model%mechanism, plan, state, 60, others)
      call test%is_true(size(others%found) == 2 + 2*i, &
                        'a point beside the line of a rod tells how it is turned, one on it does not')
    end do
  end subroutine rods_with_points

  !> Crank (link 2), ball joint (3, 4), rod (5), universal joint (6), rocker (7); the crank is given. The rod's own system has its
  !> origin in the ball joint and its x axis along the line to the universal joint.
  subroutine crank_and_rocker(model)
    type(model_type), intent(out) :: model   !< the model
    integer, parameter :: links(2, 7) = reshape([1, 2, 2, 3, 3, 4, 4, 5, 5, 6, 6, 7, 1, 7], [2, 7])

    call new_mechanism(7, links, [1], model)
    call add_revolute(model, 1, 1, 2, frame(origin, z), frame(origin, z))
    call add_revolute(model, 2, 2, 3, frame(0.3_wp*x, z), frame(origin, z))
    call add_revolute(model, 3, 3, 4, frame(origin, y), frame(origin, y))
    call add_revolute(model, 4, 4, 5, frame(origin, x), frame(origin, x))
    call add_revolute(model, 5, 5, 6, frame(1.0_wp*x, y), frame(origin, y))
    call add_revolute(model, 6, 6, 7, frame(origin, z), frame(0.6_wp*y, z))
    call add_revolute(model, 7, 1, 7, frame(1.0_wp*x + 0.2_wp*z, x), frame(origin, x))
    model%problem%initial%position(1) = 0.4_wp
  end subroutine crank_and_rocker

  !> Give a mechanism points at the origins of some links, in place of those that it has.
  subroutine give_points(model, links)
    type(model_type), intent(inout) :: model   !< the model
    integer, intent(in) :: links(:)            !< numbers of the links
    integer :: i

    if (allocated(model%mechanism%points)) deallocate (model%mechanism%points)
    allocate (model%mechanism%points(size(links)))
    do i = 1, size(links)
      model%mechanism%points(i)%name = 'P'
      model%mechanism%points(i)%link = links(i)
      model%mechanism%points(i)%position = origin
    end do
  end subroutine give_points
end module test_postures
