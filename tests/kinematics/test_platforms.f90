!> Platforms on several legs, whose Jacobians are sparse: their motion by fronts against that by full matrices.
!>
!> Compares the program with itself: the factorization by fronts and that of the full matrix.
module test_platforms
  use mech9_kinds, only: wp
  use mech9_error, only: error_type
  use mech9_random, only: random_type
  use mech9_random_geometry, only: random_vector, random_unit
  use mech9_rotation, only: cross
  use mech9_model, only: model_type
  use mech9_plan, only: plan_type
  use mech9_state, only: state_type
  use mech9_front_plan, only: front_plan_type
  use mech9_planning, only: make_plan
  use mech9_block_equations, only: block_fronts
  use mech9_block_solver, only: block_work_type, new_block_work, factorize_block, solve_rates, solve_accelerations
  use mech9_mechanism_families, only: axis_type, home_mechanism, stewart_platform
  use mech9_testing, only: tester_type
  implicit none
  private
  public :: run

contains

  !> Run the cases of this suite.
  subroutine run(test)
    type(tester_type), intent(inout) :: test   !< selects cases and counts their checks

    if (test%runs('sample_platform')) call sample_platform(test)
    if (test%runs('random_platforms')) call random_platforms(test)
  end subroutine run

  subroutine sample_platform(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(model_type) :: model
    type(random_type) :: random

    call stewart_platform(model)
    call check_same_motion(test, random, model, .true., 'the sample platform')
  end subroutine sample_platform

  subroutine random_platforms(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(model_type) :: model
    integer :: trial, legs, exponent
    type(random_type) :: random

    do trial = 1, 5
      do legs = 3, 7
        call random_platform(random, legs, 1.0_wp, model)
        call check_same_motion(test, random, model, .true., 'a platform on legs at random')
      end do
      do exponent = 1, 4
        call random_platform(random, 6, 10.0_wp**(-exponent), model)
        call check_same_motion(test, random, model, .true., 'a platform on nearly parallel legs')
      end do
      call lifting_table(random, 4 + trial, model)
      call check_same_motion(test, random, model, .false., 'a table on legs of parallel hinges, whose chains are closed one by one')
      call planar_platform(random, 5, model)
      call check_same_motion(test, random, model, .false., 'a plane platform, whose six unknowns are a small full matrix')
    end do
  end subroutine random_platforms

  !> A platform (link 2) on legs of six pairs with axes at random, the third of which slides. Six coordinates are given: the
  !> slides, and first turns of as many legs as are missing to six.
  subroutine random_platform(random, legs, spread, model)
    type(random_type), intent(inout) :: random   !< source of the numbers
    integer, intent(in) :: legs                  !< number of legs
    real(wp), intent(in) :: spread               !< of the directions of the slides
    type(model_type), intent(out) :: model       !< the model
    type(axis_type) :: axes(6*legs)
    integer :: links(2, 6*legs), leg, i, k, cq(6)
    real(wp) :: low(3)

    do leg = 1, legs
      k = 6*(leg - 1)
      links(1, k + 1:k + 6) = [1, 5*leg - 2, 5*leg - 1, 5*leg, 5*leg + 1, 5*leg + 2]
      links(2, k + 1:k + 6) = [5*leg - 2, 5*leg - 1, 5*leg, 5*leg + 1, 5*leg + 2, 2]
      low = random_vector(random)
      do i = 1, 6
        axes(k + i)%point = low
        if (i > 3) axes(k + i)%point = low + [0.0_wp, 0.0_wp, 1.0_wp] + spread*0.5_wp*random_vector(random)
        axes(k + i)%along = random_unit(random)
      end do
      axes(k + 3)%along = axes(k + 4)%point - low
      axes(k + 3)%slides = .true.
    end do
    cq = [(merge(6*i - 3, 6*(i - legs) - 5, i <= legs), i=1, 6)]
    call home_mechanism(2 + 5*legs, links, axes, sorted(cq), model)
  end subroutine random_platform

  !> A table (link 2) that three or more legs of three parallel hinges each let move in one direction only. The first hinge is
  !> given.
  subroutine lifting_table(random, legs, model)
    type(random_type), intent(inout) :: random   !< source of the numbers
    integer, intent(in) :: legs                  !< number of legs
    type(model_type), intent(out) :: model       !< the model
    type(axis_type) :: axes(3*legs)
    integer :: links(2, 3*legs), leg, k
    real(wp) :: outwards(3), along(3), angle

    do leg = 1, legs
      k = 3*(leg - 1)
      links(1, k + 1:k + 3) = [1, 2*leg + 1, 2*leg + 2]
      links(2, k + 1:k + 3) = [2*leg + 1, 2*leg + 2, 2]
      angle = 2.0_wp*leg + 0.1_wp*random%symmetric()
      outwards = [cos(angle), sin(angle), 0.0_wp]
      along = cross([0.0_wp, 0.0_wp, 1.0_wp], outwards)
      axes(k + 1)%point = outwards
      axes(k + 2)%point = (1.5_wp + 0.2_wp*random%symmetric())*outwards + [0.0_wp, 0.0_wp, 0.5_wp + 0.1_wp*random%symmetric()]
      axes(k + 3)%point = 0.8_wp*outwards + [0.0_wp, 0.0_wp, 1.0_wp]
      axes(k + 1)%along = along
      axes(k + 2)%along = along
      axes(k + 3)%along = along
    end do
    call home_mechanism(2 + 2*legs, links, axes, [1], model)
  end subroutine lifting_table

  !> A platform (link 2) in a plane on legs of three hinges; the first hinges of three legs are given.
  subroutine planar_platform(random, legs, model)
    type(random_type), intent(inout) :: random   !< source of the numbers
    integer, intent(in) :: legs                  !< number of legs, at least 3
    type(model_type), intent(out) :: model       !< the model
    type(axis_type) :: axes(3*legs)
    integer :: links(2, 3*legs), leg, k, i

    do leg = 1, legs
      k = 3*(leg - 1)
      links(1, k + 1:k + 3) = [1, 2*leg + 1, 2*leg + 2]
      links(2, k + 1:k + 3) = [2*leg + 1, 2*leg + 2, 2]
      do i = 1, 3
        axes(k + i)%point = random_vector(random)
        axes(k + i)%point(3) = 0.0_wp
      end do
    end do
    call home_mechanism(2 + 2*legs, links, axes, [1, 4, 7], model)
  end subroutine planar_platform

  !> Numbers in ascending order.
  pure function sorted(numbers) result(ascending)
    integer, intent(in) :: numbers(:)   !< each once
    integer :: ascending(size(numbers)), i

    do i = 1, size(numbers)
      ascending(count(numbers <= numbers(i))) = numbers(i)
    end do
  end function sorted

  !> Rates, accelerations and measures of the block, at random ones of the independent coordinates.
  subroutine check_same_motion(test, random, model, sparse, name)
    type(tester_type), intent(inout) :: test     !< counts the checks
    type(random_type), intent(inout) :: random   !< source of the numbers
    type(model_type), intent(in) :: model        !< the model
    logical, intent(in) :: sparse                !< fronts are to be used
    character(len=*), intent(in) :: name         !< of the mechanism, for the report of a failure
    type(plan_type) :: plan
    type(state_type) :: state, other
    type(error_type), allocatable :: err
    type(block_work_type) :: full, by_fronts
    type(front_plan_type) :: fronts
    real(wp) :: allowed, remainder, expected
    integer :: b, i
    logical :: used

    call make_plan(model%mechanism, model%problem%partition, model%problem%initial%position, plan, state, err)
    call test%no_error(err, name)
    if (allocated(err)) return
    do i = 1, size(plan%independent)
      state%dq(plan%independent(i)) = 1.0_wp + random%symmetric()
      state%ddq(plan%independent(i)) = 2.0_wp*random%symmetric()
    end do
    other = state
    used = .false.
    allowed = 1.0e-13_wp
    do b = 1, size(plan%blocks)
      associate (block => plan%blocks(b))
        full = new_block_work(block)
        by_fronts = new_block_work(block, plan)
        fronts = block_fronts(plan, block, full%column_of)
        used = used .or. fronts%used
        call factorize_block(plan, block, state, full)
        call solve_rates(plan, block, state, full, expected)
        call solve_accelerations(plan, block, state, full)
        call factorize_block(plan, block, other, by_fronts)
        call solve_rates(plan, block, other, by_fronts, remainder)
        call solve_accelerations(plan, block, other, by_fronts)
        if (block%equations == 0) cycle
        call test%is_true(abs(remainder - expected) <= 1.0e-12_wp*norm2(state%dq), name//': the remainder is what no rates remove')
        call test%is_true(by_fronts%equations%determinant_sign() == full%equations%determinant_sign(), &
                          name//': the determinant has the same sign by both methods')
        associate (one => by_fronts%equations%least_singular_value(), two => full%equations%least_singular_value())
          call test%is_true(abs(one - two) <= 1.0e-5_wp*two, name//': the least singular value is the same by both methods')
        end associate
        ! round-off over the conditioning: once in rates, again in accelerations
        allowed = allowed*4.0_wp/min(1.0_wp, full%equations%conditioning())**2
      end associate
    end do
    call test%is_true(used .eqv. sparse, name//': fronts are used where they save work')
    call test%is_true(maxval(abs(other%dq - state%dq)) <= allowed*maxval(abs(state%dq)), name//': the rates are equal')
    call test%is_true(maxval(abs(other%ddq - state%ddq)) <= allowed*maxval(abs(state%ddq)), name//': the accelerations are equal')
  end subroutine check_same_motion
end module test_platforms
