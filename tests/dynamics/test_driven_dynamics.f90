!> Driven coordinates beside free ones: on random trees of open links, loops and ladders, in the plane and in space, the free
!> accelerations are those of a_ff ddq_f = Q_f - h_f - a_fd ddq_d with the coefficients of the mechanism without drives, which for
!> some are those of equation (19) taken literally; driven accelerations are those of the drives; an evaluation allocates nothing.
module test_driven_dynamics
  use mech9_kinds, only: wp
  use mech9_error, only: error_type
  use mech9_random, only: random_type
  use mech9_partition, only: driven_coordinate
  use mech9_lagrange, only: find_motion, complete_accelerations
  use mech9_block_equations, only: block_rates
  use mech9_literal_lagrange, only: literal_type, literal_equations
  use mech9_cluster_case, only: cluster_case_type, prepare
  use mech9_mixed_structures, only: structure_type, random_structure, add_ladder, finished, below
  use mech9_testing, only: tester_type
  use mech9_counted_memory, only: calls
  implicit none
  private
  public :: run

contains

  !> Run the cases of this suite.
  subroutine run(test)
    type(tester_type), intent(inout) :: test   !< selects cases and counts their checks

    if (test%runs('random_structures')) call random_structures(test)
    if (test%runs('one_cluster')) call one_cluster(test)
  end subroutine run

  !> Structures of 2 to 7 pieces, in each of which some independent coordinates are driven.
  subroutine random_structures(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(cluster_case_type) :: free
    type(random_type) :: random
    type(structure_type) :: structure
    integer :: trial, compared, literal
    logical :: planar, found

    compared = 0
    literal = 0
    do trial = 1, 120
      planar = mod(trial, 2) == 0
      call random_structure(random, planar, 2 + mod(trial, 6), structure)
      call finished(random, structure, free%model)
      call prepare(free, mod(trial, 4) == 0, found)
      if (.not. found .or. free%conditioning < 0.02_wp) cycle
      compared = compared + 1
      call compare(test, free, random, mod(trial, 4) == 0, 'a structure', literal)
    end do
    call test%is_true(compared > 60, 'most of the random positions are regular')
    call test%is_true(literal == 12, 'twelve positions are compared with the literal equations')
  end subroutine random_structures

  !> A ladder on link 1 has its accelerations from the coefficients.
  subroutine one_cluster(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(cluster_case_type) :: free
    type(random_type) :: random
    type(structure_type) :: structure
    integer :: trial, literal
    logical :: found

    literal = huge(1)
    do trial = 1, 10
      call random_structure(random, .true., 0, structure)
      call add_ladder(random, 1, 3, structure)
      call finished(random, structure, free%model)
      call prepare(free, trial > 5, found)
      if (.not. found) cycle
      call test%is_true(.not. free%dynamics%articulated, 'a ladder on link 1 is one cluster')
      call compare(test, free, random, trial > 5, 'a ladder', literal)
    end do
  end subroutine one_cluster

  !> Drive some of the independent coordinates, and compare with the equations of the mechanism without drives. Sums over all
  !> links along a chain lose some hundreds of units of round-off; literal equations lose 1e-9 of the largest number.
  subroutine compare(test, free, random, in_space, why, literal)
    type(tester_type), intent(inout) :: test         !< counts the checks
    type(cluster_case_type), intent(inout) :: free   !< without drives, with its equations
    type(random_type), intent(inout) :: random       !< source of the random numbers
    logical, intent(in) :: in_space                  !< spatial arithmetic
    character(len=*), intent(in) :: why              !< the statement that is checked, printed where it is wrong
    integer, intent(inout) :: literal                !< number of comparisons with literal equations so far
    type(cluster_case_type) :: driven
    type(literal_type) :: equations
    type(error_type), allocatable :: err
    real(wp), allocatable :: a(:, :), given(:)
    integer :: i, n
    logical :: found

    driven%model = free%model
    n = size(free%plan%independent)
    do i = 1, n
      if (below(random, 2) == 0) driven%model%problem%partition%kind(free%plan%independent(i)) = driven_coordinate
    end do
    call prepare(driven, in_space, found)
    call test%is_true(found, why//': the driven mechanism has a position')
    if (.not. found) return
    given = [(3.0_wp*random%symmetric(), i=1, driven%plan%n_coordinates)]
    where (driven%plan%driven) driven%state%ddq = given
    call find_motion(driven%model%mechanism, driven%plan, driven%dynamics, driven%state, driven%work, err)
    call test%no_error(err, why//': the motion is found')
    if (allocated(err)) return
    call check_memory(test, driven)
    call complete_accelerations(driven%plan, driven%dynamics, driven%work, driven%state)
    call test%is_true(all(abs(driven%state%ddq - given) <= 0.0_wp .or. .not. driven%plan%driven), &
                      why//': driven accelerations are those of the drives')
    a = free%work%coefficients
    do i = 1, n
      a(i, i + 1:) = a(i + 1:, i)
    end do
    call check_equations(test, driven, a, free%work%forces, free%work%velocity_terms, 1.0e-13_wp/free%conditioning, why)
    call check_chains(test, driven, free%conditioning, why)
    if (n > 4 .or. free%conditioning < 0.1_wp .or. literal >= 12) return
    call literal_equations(free%model, free%plan, free%state, equations, err)
    ! the neighbouring positions may be out of reach
    if (allocated(err)) return
    literal = literal + 1
    call check_equations(test, driven, equations%coefficients, equations%forces, equations%velocity_terms, 1.0e-8_wp, &
                         why//', by literal equations')
  end subroutine compare

  !> The equations of the free coordinates hold.
  subroutine check_equations(test, driven, a, forces, velocity_terms, tolerance, why)
    type(tester_type), intent(inout) :: test        !< counts the checks
    type(cluster_case_type), intent(in) :: driven   !< with all accelerations
    real(wp), intent(in) :: a(:, :)                 !< coefficients of motion [kg m^2, kg m, kg]
    real(wp), intent(in) :: forces(:)               !< generalized forces [N m, N]
    real(wp), intent(in) :: velocity_terms(:)       !< terms of the rates [N m, N]
    real(wp), intent(in) :: tolerance               !< part of the largest terms
    character(len=*), intent(in) :: why             !< the statement that is checked, printed where it is wrong
    real(wp), dimension(size(forces)) :: ddq, left, terms

    ddq = driven%state%ddq(driven%plan%independent)
    left = matmul(a, ddq) - forces + velocity_terms
    where (driven%plan%driven(driven%plan%independent)) left = 0.0_wp
    terms = matmul(abs(a), abs(ddq)) + abs(forces) + abs(velocity_terms)
    call test%near(maxval(abs(left))/maxval(terms), 0.0_wp, tolerance, why//': the equations of the free coordinates hold')
  end subroutine check_equations

  !> The accelerations keep the chains closed.
  subroutine check_chains(test, driven, conditioning, why)
    type(tester_type), intent(inout) :: test           !< counts the checks
    type(cluster_case_type), intent(inout) :: driven   !< with all accelerations
    real(wp), intent(in) :: conditioning               !< of the worst block
    character(len=*), intent(in) :: why                !< the statement that is checked, printed where it is wrong
    real(wp), allocatable :: right(:)
    integer :: i

    do i = 1, size(driven%plan%blocks)
      if (driven%plan%blocks(i)%equations == 0) cycle
      if (allocated(right)) deallocate (right)
      allocate (right(driven%plan%blocks(i)%equations))
      call block_rates(driven%plan, driven%plan%blocks(i), 2, driven%state, right)
      call test%near(maxval(abs(right))/(1.0_wp + maxval(abs(driven%state%ddq))), 0.0_wp, 1.0e-12_wp/conditioning, &
                     why//': the closed chains stay closed')
    end do
  end subroutine check_chains

  !> Evaluations with drives allocate nothing.
  subroutine check_memory(test, this)
    type(tester_type), intent(inout) :: test         !< counts the checks
    type(cluster_case_type), intent(inout) :: this   !< mechanism, plans, state and equations
    type(error_type), allocatable :: err
    integer :: i, before

    before = calls
    do i = 1, 10
      call find_motion(this%model%mechanism, this%plan, this%dynamics, this%state, this%work, err)
      if (allocated(err)) exit
    end do
    call test%is_true(calls == before, 'ten evaluations allocate nothing')
    call test%no_error(err, 'ten evaluations succeed')
  end subroutine check_memory
end module test_driven_dynamics
