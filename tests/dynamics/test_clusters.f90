!> Articulated bodies of closed clusters: on random trees of open links and loops, ladders and loops between loops, in the plane and
!> in space, with all kinds of loads and links without mass, accelerations are those of Lagrange's equations (19), which for some
!> are taken literally; planar and spatial arithmetic agree; a coordinate without inertia is named as by the coefficients; an
!> evaluation allocates nothing.
program test_clusters
  use mech9_kinds, only: wp
  use mech9_error, only: error_type, exit_data
  use mech9_random, only: random_type
  use mech9_cholesky, only: cholesky_factorize
  use mech9_model, only: model_type
  use mech9_plan, only: plan_type
  use mech9_state, only: state_type
  use mech9_planning, only: make_plan
  use mech9_lagrange_types, only: dynamics_plan_type, lagrange_work_type
  use mech9_dynamics_plan, only: make_dynamics_plan
  use mech9_lagrange_work, only: new_lagrange_work
  use mech9_lagrange, only: find_motion, find_equations, complete_accelerations
  use mech9_block_equations, only: block_rates
  use mech9_literal_lagrange, only: literal_type, literal_equations
  use mech9_mixed_structures, only: structure_type, random_structure, add_open_link, add_loop, add_ladder, finished
  use mech9_testing, only: tester_type
  use mech9_counted_memory, only: calls
  implicit none

  !> A mechanism and all that its motion needs.
  type :: case_type
    type(model_type) :: model
    type(plan_type) :: plan
    type(state_type) :: state
    type(dynamics_plan_type) :: dynamics
    type(lagrange_work_type) :: work
    real(wp) :: conditioning = 0.0_wp   !< the worst of all blocks
  end type case_type

  type(tester_type) :: test

  call random_structures()
  call series()
  call one_cluster()
  call without_inertia()
  call test%finish()

contains

  !> Structures of 2 to 7 pieces. Positions with a badly conditioned loop are left out.
  subroutine random_structures()
    type(case_type) :: flat, space
    type(random_type) :: random
    type(structure_type) :: structure
    integer :: trial, compared, literal
    logical :: planar, found

    compared = 0
    literal = 0
    do trial = 1, 120
      planar = mod(trial, 2) == 0
      call random_structure(random, planar, 2 + mod(trial, 6), structure)
      call finished(random, structure, flat%model)
      call prepare(flat, .false., found)
      if (.not. found .or. flat%conditioning < 0.02_wp) cycle
      compared = compared + 1
      call check_motion(flat, 'a structure')
      call check_memory(flat)
      if (size(flat%plan%independent) <= 4 .and. flat%conditioning > 0.1_wp .and. literal < 12) then
        literal = literal + 1
        call check_literally(flat, 'a structure')
      end if
      if (.not. planar) cycle
      call test%is_true(flat%plan%planar%used, 'a structure in the plane takes planar arithmetic')
      space%model = flat%model
      call prepare(space, .true., found)
      call test%is_true(found, 'the same structure in space has a position')
      call check_motion(space, 'the same structure in space')
      call test%near(maxval(abs(space%work%accelerations - flat%work%accelerations)) &
                     /maxval(abs(flat%work%accelerations)), 0.0_wp, 1.0e-11_wp, &
                     'planar and spatial arithmetic give the same accelerations')
    end do
    call test%is_true(compared > 60, 'most of the random positions are regular')
    call test%is_true(literal == 12, 'twelve positions are compared with the literal equations')
  end subroutine random_structures

  !> Twenty modules of an open link and a four-bar in series, then a ladder, in the plane and in space.
  subroutine series()
    type(case_type) :: this
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
      if (found) call check_motion(this, 'modules in series')
    end do
  end subroutine series

  !> One closed cluster on link 1 has its accelerations from the coefficients; two have them by articulated bodies.
  subroutine one_cluster()
    type(case_type) :: this
    type(random_type) :: random
    type(structure_type) :: structure
    logical :: found

    call random_structure(random, .true., 0, structure)
    call add_ladder(random, 1, 3, structure)
    call finished(random, structure, this%model)
    call prepare(this, .false., found)
    call test%is_true(found, 'a ladder has a position')
    call test%is_true(.not. this%dynamics%articulated, 'a ladder on link 1 is one cluster')
    call check_motion(this, 'a ladder')
    call add_ladder(random, 1, 1, structure)
    call finished(random, structure, this%model)
    call prepare(this, .false., found)
    call test%is_true(this%dynamics%articulated, 'two ladders are two clusters')
    call check_motion(this, 'two ladders')
  end subroutine one_cluster

  !> A four-bar without mass at the tip of an open link: its coordinate is named.
  subroutine without_inertia()
    type(case_type) :: this
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

  !> Plan, and some rates.
  subroutine prepare(this, in_space, found)
    type(case_type), intent(inout) :: this   !< mechanism, plans, state and equations
    logical, intent(in) :: in_space          !< spatial arithmetic, also where the mechanism is planar
    logical, intent(out) :: found            !< the mechanism moves
    type(error_type), allocatable :: err
    integer :: i

    call make_plan(this%model%mechanism, this%model%problem%partition, this%model%problem%initial%position, this%plan, &
                   this%state, err, in_space=in_space)
    found = .not. allocated(err)
    if (.not. found) return
    call make_dynamics_plan(this%model%mechanism, this%plan, this%dynamics)
    this%work = new_lagrange_work(this%plan, this%dynamics)
    this%state%dq(this%plan%independent) = [(1.3_wp*cos(2.0_wp*i), i=1, size(this%plan%independent))]
    call find_equations(this%model%mechanism, this%plan, this%dynamics, this%state, this%work, err)
    found = .not. allocated(err)
    this%conditioning = 1.0_wp
    do i = 1, size(this%work%blocks)
      this%conditioning = min(this%conditioning, this%work%blocks(i)%equations%conditioning())
    end do
  end subroutine prepare

  !> The accelerations satisfy a ddq = Q - h, and those of the dependent coordinates the closures. Sums over all links along a chain
  !> lose some hundreds of units of round-off.
  subroutine check_motion(this, why)
    type(case_type), intent(inout) :: this   !< mechanism, plans, state and equations
    character(len=*), intent(in) :: why      !< the statement that is checked, printed where it is wrong
    type(error_type), allocatable :: err
    real(wp), allocatable :: a(:, :), left(:), right(:)
    real(wp) :: terms
    integer :: i, n

    call find_motion(this%model%mechanism, this%plan, this%dynamics, this%state, this%work, err)
    call test%no_error(err, why//': the motion is found')
    if (allocated(err)) return
    n = size(this%plan%independent)
    associate (ddq => this%work%accelerations)
      call find_equations(this%model%mechanism, this%plan, this%dynamics, this%state, this%work, err)
      call test%no_error(err, why//': the equations are found')
      a = this%work%coefficients
      do i = 1, n
        a(i, i + 1:) = a(i + 1:, i)
      end do
      left = matmul(a, ddq) - this%work%forces + this%work%velocity_terms
      terms = maxval(matmul(abs(a), abs(ddq)) + abs(this%work%forces) + abs(this%work%velocity_terms))
    end associate
    call test%is_true(terms > 1.0_wp, why//': there is something to compare')
    call test%near(maxval(abs(left))/terms, 0.0_wp, 1.0e-13_wp/this%conditioning, why//': Lagrange''s equations hold')
    call complete_accelerations(this%plan, this%dynamics, this%work, this%state)
    do i = 1, size(this%plan%blocks)
      if (this%plan%blocks(i)%equations == 0) cycle
      if (allocated(right)) deallocate (right)
      allocate (right(this%plan%blocks(i)%equations))
      call block_rates(this%plan, this%plan%blocks(i), 2, this%state, right)
      call test%near(maxval(abs(right))/(1.0_wp + maxval(abs(this%state%ddq))), 0.0_wp, 1.0e-12_wp/this%conditioning, &
                     why//': the closed chains stay closed')
    end do
  end subroutine check_motion

  !> Accelerations against (19), (21) and (25) by differences of closed positions, which lose 1e-9 of the largest number.
  subroutine check_literally(this, why)
    type(case_type), intent(inout) :: this   !< mechanism, plans, state and equations
    character(len=*), intent(in) :: why      !< the statement that is checked, printed where it is wrong
    type(literal_type) :: literal
    type(error_type), allocatable :: err
    real(wp), allocatable :: left(:)
    real(wp) :: terms

    call literal_equations(this%model, this%plan, this%state, literal, err)
    ! the neighbouring positions may be out of reach
    if (allocated(err)) return
    associate (ddq => this%work%accelerations)
      left = matmul(literal%coefficients, ddq) - literal%forces + literal%velocity_terms
      terms = maxval(matmul(abs(literal%coefficients), abs(ddq)) + abs(literal%forces) + abs(literal%velocity_terms))
    end associate
    call test%near(maxval(abs(left))/terms, 0.0_wp, 1.0e-8_wp, why//': equation (19) taken literally holds')
  end subroutine check_literally

  subroutine check_memory(this)
    type(case_type), intent(inout) :: this   !< mechanism, plans, state and equations
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
end program test_clusters
