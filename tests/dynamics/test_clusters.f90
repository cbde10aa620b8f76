!> Articulated bodies of closed clusters: on random trees of open links and loops, ladders and loops between loops, in the plane and
!> in space, with all kinds of loads and links without mass, accelerations are those of Lagrange's equations (19), which for some
!> are taken literally; planar and spatial arithmetic agree; a coordinate without inertia is named as by the coefficients; an
!> evaluation allocates nothing.
module test_clusters
  use mech9_kinds, only: wp
  use mech9_error, only: error_type, exit_data
  use mech9_random, only: random_type
  use mech9_cholesky, only: cholesky_factorize
  use mech9_lagrange, only: find_motion, find_equations
  use mech9_cluster_case, only: cluster_case_type, prepare, check_motion, check_literally, check_memory
  use mech9_mixed_structures, only: structure_type, random_structure, add_open_link, add_loop, add_ladder, finished
  use mech9_testing, only: tester_type
  implicit none
  private
  public :: run

contains

  !> Run the cases of this suite.
  subroutine run(test)
    type(tester_type), intent(inout) :: test   !< selects cases and counts their checks

    if (test%runs('random_structures')) call random_structures(test)
    if (test%runs('series')) call series(test)
    if (test%runs('one_cluster')) call one_cluster(test)
    if (test%runs('without_inertia')) call without_inertia(test)
  end subroutine run

  !> Structures of 2 to 7 pieces. Positions with a badly conditioned loop are left out.
  subroutine random_structures(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(cluster_case_type) :: flat, space
    type(random_type) :: random
    type(structure_type) :: structure
    integer :: trial, compared, literal, in_planes
    logical :: planar, found, by_differences

    compared = 0
    literal = 0
    in_planes = 0
    do trial = 1, 120
      planar = mod(trial, 2) == 0
      call random_structure(random, planar, 2 + mod(trial, 6), structure)
      call finished(random, structure, flat%model)
      call prepare(flat, .false., found)
      if (.not. found .or. flat%conditioning < 0.02_wp) cycle
      compared = compared + 1
      call check_motion(test, flat, 'a structure')
      call check_memory(test, flat)
      if (size(flat%plan%independent) <= 4 .and. flat%conditioning > 0.1_wp .and. literal < 12) then
        call check_literally(test, flat, flat%model, 'a structure', by_differences)
        if (by_differences) literal = literal + 1
      end if
      if (planar) call test%is_true(flat%plan%planar%used, 'a structure in the plane takes planar arithmetic')
      if (.not. planar) in_planes = in_planes + count(flat%dynamics%stages%plane > 0)
      space%model = flat%model
      call prepare(space, .true., found)
      call test%is_true(found, 'the same structure in space has a position')
      call check_motion(test, space, 'the same structure in space')
      call test%near(maxval(abs(space%work%accelerations - flat%work%accelerations)) &
                     /maxval(abs(flat%work%accelerations)), 0.0_wp, 1.0e-11_wp, &
                     'planar and spatial arithmetic give the same accelerations')
    end do
    call test%is_true(compared > 60, 'most of the random positions are regular')
    call test%is_true(in_planes > 40, 'many clusters of the spatial structures move in planes of their own')
    call test%is_true(literal == 12, 'twelve positions are compared with the literal equations')
  end subroutine random_structures

  !> Twenty modules of an open link and a four-bar in series, then a ladder, in the plane and in space.
  subroutine series(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(cluster_case_type) :: this
    type(random_type) :: random
    type(structure_type) :: structure
    integer :: i, trial, link
    logical :: found

    do trial = 1, 2
      call random_structure(random, trial == 1, 0, structure)
      do i = 1, 20
        link = max(1, structure%n_links - 1)
        call add_open_link(random, link, structure)
        link = structure%n_links
        call add_loop(random, link, link, 4, structure)
      end do
      link = structure%n_links
      call add_ladder(random, link, 3, structure)
      call finished(random, structure, this%model)
      call prepare(this, .false., found)
      call test%is_true(found, 'modules in series have a position')
      if (found) call check_motion(test, this, 'modules in series')
    end do
  end subroutine series

  !> One closed cluster on link 1 has its accelerations from the coefficients; two have them by articulated bodies.
  subroutine one_cluster(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(cluster_case_type) :: this
    type(random_type) :: random
    type(structure_type) :: structure
    logical :: found

    call random_structure(random, .true., 0, structure)
    call add_ladder(random, 1, 3, structure)
    call finished(random, structure, this%model)
    call prepare(this, .false., found)
    call test%is_true(found, 'a ladder has a position')
    call test%is_true(.not. this%dynamics%articulated, 'a ladder on link 1 is one cluster')
    call check_motion(test, this, 'a ladder')
    call add_ladder(random, 1, 1, structure)
    call finished(random, structure, this%model)
    call prepare(this, .false., found)
    call test%is_true(this%dynamics%articulated, 'two ladders are two clusters')
    call check_motion(test, this, 'two ladders')
  end subroutine one_cluster

  !> A four-bar without mass at the tip of an open link: its coordinate is named.
  subroutine without_inertia(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(cluster_case_type) :: this
    type(random_type) :: random
    type(structure_type) :: structure
    type(error_type), allocatable :: err
    integer :: failed_at
    logical :: found

    call random_structure(random, .false., 0, structure)
    call add_open_link(random, 1, structure)
    call add_loop(random, 2, 2, 4, structure)
    structure%light = [3, 4, 5]
    call finished(random, structure, this%model)
    call prepare(this, .false., found)
    call find_motion(this%model%mechanism, this%plan, this%dynamics, this%state, this%work, err)
    call test%has_error(err, exit_data, 'a four-bar without mass is refused')
    if (.not. allocated(err)) return
    call find_equations(this%model%mechanism, this%plan, this%dynamics, this%state, this%work, err)
    call test%no_error(err, 'the coefficients of a four-bar without mass are found')
    call cholesky_factorize(size(this%plan%independent), this%work%coefficients, failed_at)
    call test%is_true(failed_at > 0, 'the coefficients of a four-bar without mass are singular')
    call find_motion(this%model%mechanism, this%plan, this%dynamics, this%state, this%work, err)
    if (.not. allocated(err)) return
    call test%is_true(all(err%failure%coordinates == this%plan%independent(failed_at)), &
                      'the error names the coordinate of the singular coefficients')
  end subroutine without_inertia
end module test_clusters
