!> A user's forces on links and coordinates inside closed clusters, and arms with parallelograms in series: accelerations by
!> articulated bodies are those of Lagrange's equations (19), for some taken literally, and a user's procedure gives the
!> accelerations of the built-in loads that it imitates, in the plane and in space.
module test_cluster_loads
  use mech9_kinds, only: wp
  use mech9_random, only: random_type
  use mech9_model, only: model_type
  use mech9_procedure_load, only: procedure_load_type
  use mech9_force_load, only: force_load_type
  use mech9_spring_load, only: spring_load_type
  use mech9_coordinate_load, only: coordinate_load_type
  use mech9_cluster_case, only: cluster_case_type, prepare, check_motion, check_literally, check_memory
  use mech9_loaded_mechanisms, only: add_load
  use mech9_mixed_structures, only: structure_type, random_structure, add_open_link, add_loop, finished, below
  use mech9_random_geometry, only: random_vector
  use mech9_testing, only: tester_type
  implicit none
  private
  public :: run

contains

  !> Run the cases of this suite.
  subroutine run(test)
    type(tester_type), intent(inout) :: test   !< selects cases and counts their checks

    if (test%runs('random_structures')) call random_structures(test)
    if (test%runs('arm')) call arm(test)
    if (test%runs('arms_in_series')) call arms_in_series(test)
  end subroutine run

  !> Structures of 2 to 7 pieces, with four calls of a user's procedure. Positions with a badly conditioned loop are left out.
  subroutine random_structures(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(cluster_case_type) :: this
    type(model_type) :: twin
    type(random_type) :: random
    type(structure_type) :: structure
    integer :: trial, i, compared, literal
    logical :: planar, found, by_differences

    compared = 0
    literal = 0
    do trial = 1, 60
      planar = mod(trial, 2) == 0
      call random_structure(random, planar, mod(trial, 6), structure)
      ! a loop, so that no structure is open, which carries an open link
      call add_loop(random, structure%n_links, structure%n_links, 4, structure)
      call add_open_link(random, structure%n_links - 1, structure)
      call finished(random, structure, this%model)
      twin = this%model
      do i = 1, 4
        call add_user_load(random, this%model, twin)
      end do
      call prepare(this, .false., found)
      if (.not. found .or. this%conditioning < 0.02_wp) cycle
      compared = compared + 1
      call test%is_true(this%plan%planar%used .eqv. planar, 'forces in space leave a plane mechanism in planar arithmetic')
      call check_motion(test, this, 'a structure with a user''s forces')
      call check_memory(test, this)
      call check_twin(test, this, twin, .false.)
      if (planar) call check_twin(test, this, twin, .true.)
      if (size(this%plan%independent) > 4 .or. this%conditioning < 0.1_wp .or. literal == 8) cycle
      call check_literally(test, this, twin, 'a structure with a user''s forces', by_differences)
      if (by_differences) literal = literal + 1
    end do
    call test%is_true(compared > 30, 'most of the random positions are regular')
    call test%is_true(literal == 8, 'eight positions are compared with the literal equations')
  end subroutine random_structures

  !> The arm that stacks crates, at home and with other independent coordinates.
  subroutine arm(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(cluster_case_type) :: this
    type(model_type) :: twin
    type(random_type) :: random
    type(structure_type) :: structure
    integer :: trial, i
    logical :: found, compared

    do trial = 1, 3
      call random_structure(random, .false., 0, structure)
      call add_arm(1, [0.0_wp, 0.0_wp, 0.0_wp], structure)
      if (trial == 2) structure%independent = [1, 8, 12]
      if (trial == 3) structure%light = [6, 8, 10]
      call finished(random, structure, this%model)
      twin = this%model
      do i = 1, 3
        call add_user_load(random, this%model, twin)
      end do
      call prepare(this, .false., found)
      call test%is_true(found, 'the arm has a position')
      if (.not. found) return
      call check_motion(test, this, 'the arm')
      call check_twin(test, this, twin, .false.)
      call check_literally(test, this, twin, 'the arm', compared)
      call test%is_true(compared, 'the arm moves around home')
    end do
  end subroutine arm

  !> Three arms: the second stands on the gripper of the first, the third on its triangle; an open link and a loop end each.
  subroutine arms_in_series(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(cluster_case_type) :: this
    type(model_type) :: twin
    type(random_type) :: random
    type(structure_type) :: structure
    integer :: i
    logical :: found

    call random_structure(random, .false., 0, structure)
    call add_arm(1, [0.0_wp, 0.0_wp, 0.0_wp], structure)
    call add_arm(9, [1.4_wp, 0.0_wp, 1.3_wp], structure)
    call add_arm(7, [0.2_wp, 0.1_wp, 1.9_wp], structure)
    do i = 9, 27, 9
      call add_open_link(random, i, structure)
      call add_loop(random, structure%n_links, structure%n_links, 5, structure)
    end do
    call finished(random, structure, this%model)
    twin = this%model
    do i = 1, 10
      call add_user_load(random, this%model, twin)
    end do
    call prepare(this, .false., found)
    call test%is_true(found, 'arms in series have a position')
    if (.not. found) return
    call check_motion(test, this, 'arms in series')
    call check_twin(test, this, twin, .false.)
  end subroutine arms_in_series

  !> A palletising arm on a link: a column, a lower and an upper arm, a crank and a rod that move the upper arm, and two parallelograms
  !> in series that keep a gripper level. New links from the first on: column, lower arm, upper arm, crank, rod, triangle, rear bar,
  !> gripper, front bar.
  subroutine add_arm(on, foot, structure)
    integer, intent(in) :: on                          !< number of the link that carries it
    real(wp), intent(in) :: foot(3)                    !< place of its column at home [m]
    type(structure_type), intent(inout) :: structure   !< the mechanism
    ! links in each pair, where 1 is the carrier and 2 the first new link
    integer, parameter :: pairs(2, 12) = reshape([1, 2, 2, 3, 3, 4, 2, 5, 5, 6, 6, 4, &
                                                  3, 7, 2, 8, 8, 7, 4, 9, 7, 10, 10, 9], [2, 12])
    real(wp), parameter :: x(12) = [0.0_wp, 0.2_wp, 0.2_wp, 0.2_wp, -0.1_wp, -0.1_wp, 0.2_wp, 0.05_wp, 0.05_wp, 1.3_wp, &
                                    0.2_wp, 1.3_wp]
    real(wp), parameter :: z(12) = [0.0_wp, 0.6_wp, 1.5_wp, 0.6_wp, 0.6_wp, 1.5_wp, 1.5_wp, 0.75_wp, 1.65_wp, 1.5_wp, &
                                    1.75_wp, 1.75_wp]
    integer :: k, m, numbers(10)

    m = size(structure%slides)
    numbers = [on, (structure%n_links + k, k=1, 9)]
    structure%n_links = structure%n_links + 9
    structure%links = reshape([structure%links, [(numbers(pairs(:, k)), k=1, 12)]], [2, m + 12])
    structure%slides = [structure%slides, spread(.false., 1, 12)]
    structure%points = reshape([structure%points, [(foot + [x(k), 0.0_wp, z(k)], k=1, 12)]], [3, m + 12])
    structure%axes = reshape([structure%axes, [(merge([0.0_wp, 0.0_wp, 1.0_wp], [0.0_wp, 1.0_wp, 0.0_wp], k == 1), &
                                                k=1, 12)]], [3, m + 12])
    structure%independent = [structure%independent, m + 1, m + 2, m + 4]
  end subroutine add_arm

  !> Add the same load twice: by the user's procedure, and by loads of built-in kinds.
  subroutine add_user_load(random, model, twin)
    type(random_type), intent(inout) :: random   !< source of the random numbers
    type(model_type), intent(inout) :: model     !< gets a load by the user's procedure
    type(model_type), intent(inout) :: twin      !< gets built-in loads in its place
    integer :: links(2), k
    real(wp) :: points(3, 2), force(3), torque(3), spring(3), turn(3)

    associate (structure => model%mechanism%structure)
      ! two different moving links, and any coordinate
      links = 2 + below(random, structure%n_links - 1)
      links(2) = 2 + modulo(links(1) - 1 + below(random, structure%n_links - 2), structure%n_links - 1)
      k = 1 + below(random, structure%n_coordinates)
    end associate
    points(:, 1) = random_vector(random)
    points(:, 2) = random_vector(random)
    force = 8.0_wp*random_vector(random)
    torque = 6.0_wp*random_vector(random)
    spring = [9.0_wp, 0.5_wp, 1.2_wp]
    turn = [3.0_wp, 0.7_wp, 0.6_wp]
    call add_load(model, procedure_load_type(parameters=[real(wp) :: links, k, points, force, torque, spring, turn]))
    call add_load(twin, force_load_type(link=links(1), position=points(:, 1), force=force))
    call add_load(twin, force_load_type(link=links(2), torque=torque, turns_with_link=.true.))
    call add_load(twin, spring_load_type(links=links, positions=points, stiffness=spring(1), free_length=spring(2), &
                                         damping=spring(3)))
    call add_load(twin, coordinate_load_type(coordinate=k, stiffness=turn(1), rest=turn(2), damping=turn(3)))
  end subroutine add_user_load

  !> Built-in loads give the accelerations of the user's procedure, up to the round-off of the equations.
  subroutine check_twin(test, this, twin, in_space)
    type(tester_type), intent(inout) :: test      !< counts the checks
    type(cluster_case_type), intent(in) :: this   !< with the accelerations by the user's procedure
    type(model_type), intent(in) :: twin          !< the same mechanism with built-in loads
    logical, intent(in) :: in_space               !< spatial arithmetic for the built-in loads
    type(cluster_case_type) :: other
    logical :: found

    other%model = twin
    call prepare(other, in_space, found)
    call test%is_true(found, 'the mechanism with built-in loads has a position')
    if (.not. found) return
    call check_motion(test, other, 'built-in loads')
    call test%near(maxval(abs(other%work%accelerations - this%work%accelerations))/maxval(abs(this%work%accelerations)), &
                   0.0_wp, 1.0e-11_wp, 'a user''s procedure gives the accelerations of built-in loads')
  end subroutine check_twin
end module test_cluster_loads
