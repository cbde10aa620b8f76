!> The plan of a mechanism in other independent coordinates, made from an earlier plan.
!>
!> Frames, loops and the ranks of loops do not depend on the choice of independent coordinates and stay as they are. The blocks are
!> divided anew; a block that has the same unknowns and chains as before needs no check. Every other block must determine its
!> unknowns in the present position, which is closed. As many coordinates as before then can move at any rates: the mechanism has
!> as many degrees of freedom, and no motion leaves all of them at rest.
module mech9_replanning
  use mech9_kinds, only: wp
  use mech9_tolerances, only: rank_tolerance_for
  use mech9_error, only: error_type
  use mech9_partition, only: partition_type
  use mech9_plan, only: plan_type, new_state, copy_plan
  use mech9_state, only: state_type, copy_state
  use mech9_requested, only: requested_type, leave_out_unrequested
  use mech9_frame_motion, only: place_all
  use mech9_block_solver, only: block_work_type, new_block_work, factorize_block
  use mech9_arithmetics, only: set_in_space, set_in_plane
  use mech9_planar_layout, only: lay_out_in_plane
  use mech9_blocks, only: make_blocks
  use mech9_planning, only: plan_blocks_in_planes, find_constants
  implicit none
  private
  public :: replanning_type, wanted_type, replan

  !> A plan in other independent coordinates, whether it serves, and the parts that it has in common with the earlier one. Plan and
  !> state are polymorphic because these are copied and freed by calls, which keeps the code small.
  type :: replanning_type
    class(plan_type), allocatable :: plan      !< the plan, if it serves
    class(state_type), allocatable :: state    !< the same position for this plan, with frames in place
    logical :: serves = .false.            !< the plan was made; otherwise it must be made from the beginning
    logical :: rejected = .false.          !< a block is not conditioned as well as is wanted, so that the plan was not made
    integer, allocatable :: same_as(:)     !< (blocks) block of the earlier plan with the same unknowns; 0: planned anew
  end type replanning_type

  !> The purpose of a plan in other coordinates, and the conditioning for which it is worth making.
  type :: wanted_type
    type(requested_type) :: requested          !< requested quantities; blocks that do not serve them are left out
    logical :: from_known_only = .false.       !< no plan that is made from the beginning serves in place of this one
    real(wp) :: least = 0.0_wp                 !< least pivot ratio of every block
    real(wp), allocatable :: conditioning(:)   !< (blocks) pivot ratios of the blocks of the earlier plan; not allocated: not judged
  end type wanted_type

contains

  !> Plan a mechanism in other independent coordinates at a closed position.
  subroutine replan(known, known_state, partition, wanted, replanning, err)
    type(plan_type), intent(in) :: known                !< the earlier plan, with its blocks
    type(state_type), intent(in) :: known_state         !< a closed position of this plan
    type(partition_type), intent(in) :: partition       !< with the coordinates that are independent from now on
    type(wanted_type), intent(in) :: wanted             !< its purpose, and conditioning for which the plan is worth making
    type(replanning_type), intent(out) :: replanning    !< the plan in these coordinates, if it serves
    type(error_type), allocatable, intent(out) :: err   !< allocated if a pair has no pose
    integer, allocatable :: undetermined(:)

    allocate (replanning%plan, replanning%state)
    if (count(partition%independent()) /= size(known%independent)) return
    call copy_plan(known, replanning%plan)
    associate (plan => replanning%plan, state => replanning%state)
      call set_coordinates(partition%independent(), partition%driven(), plan)
      deallocate (plan%blocks)
      call make_blocks(plan, undetermined)
      if (size(undetermined) > 0) return
      call set_in_space(plan)
      call leave_out_unrequested(plan, wanted%requested)
      call compare_blocks(known, plan, replanning%same_as, replanning%serves)
      if (replanning%serves) call judge_same_blocks(wanted, replanning)
      if (.not. replanning%serves .or. replanning%rejected) return
      if (known%planar%used) then
        call lay_out_in_plane(plan)
        call set_in_plane(plan)
      end if
      call copy_state(new_state(plan), state)
      state%q = known_state%q
      if (allocated(known%planar%planes)) then
        call plan_blocks_in_planes(plan, state, err)
        if (allocated(err)) return
        call leave_out_unrequested(plan, wanted%requested)
        call compare_blocks(known, plan, replanning%same_as, replanning%serves)
      end if
      call find_constants(plan)
      call place_all(plan, state, err)
    end associate
    if (.not. allocated(err)) call check_blocks(wanted%least, replanning)
  end subroutine replan

  !> Take other independent coordinates into a plan; its steps show which are dependent.
  pure subroutine set_coordinates(independent, driven, plan)
    logical, intent(in) :: independent(:)    !< (M) the coordinate is independent
    logical, intent(in) :: driven(:)         !< (M) a drive gives the motion of the coordinate
    type(plan_type), intent(inout) :: plan   !< the plan
    integer :: i

    plan%independent = pack([(i, i=1, plan%n_coordinates)], independent)
    plan%driven = driven
    plan%free_places = pack([(i, i=1, size(plan%independent))], .not. driven(plan%independent))
    plan%free = plan%independent(plan%free_places)
    plan%steps%dependent = .not. independent(plan%steps%coordinate)
  end subroutine set_coordinates

  !> Find the blocks that are the same as in the earlier plan. The plan does not serve where it needs the position of a chain
  !> that the earlier plan left out.
  pure subroutine compare_blocks(known, plan, same_as, serves)
    type(plan_type), intent(in) :: known                  !< the earlier plan
    type(plan_type), intent(in) :: plan                   !< the plan in other independent coordinates
    integer, allocatable, intent(out) :: same_as(:)       !< (blocks) block of the earlier plan with the same unknowns; 0: planned anew
    logical, intent(out) :: serves                        !< the plan needs no position of a chain that was left out
    integer :: block_of(plan%n_coordinates), b, k

    block_of = 0
    do b = 1, size(known%blocks)
      block_of(known%steps(known%blocks(b)%first_step:known%blocks(b)%last_step)%coordinate) = b
    end do
    allocate (same_as(size(plan%blocks)), source=0)
    serves = .true.
    do b = 1, size(plan%blocks)
      associate (block => plan%blocks(b))
        serves = serves .and. all(block_of(plan%steps(block%first_step:block%last_step)%coordinate) > 0)
        if (size(block%unknowns) == 0 .or. .not. serves) cycle
        k = block_of(block%coordinates(1))
        if (have_same_numbers(block%coordinates, known%blocks(k)%coordinates) .and. &
            have_same_numbers(block%chains, known%blocks(k)%chains)) same_as(b) = k
      end associate
    end do
  end subroutine compare_blocks

  !> Whether two lists have the same numbers, in any order. No number occurs twice in a list.
  pure logical function have_same_numbers(a, b) result(same)
    integer, intent(in) :: a(:)   !< the first list
    integer, intent(in) :: b(:)   !< the second list
    integer :: i

    same = size(a) == size(b)
    if (.not. same) return
    do i = 1, size(a)
      same = any(b == a(i))
      if (.not. same) return
    end do
  end function have_same_numbers

  !> Judge the blocks that are the same as before.
  pure subroutine judge_same_blocks(wanted, replanning)
    type(wanted_type), intent(in) :: wanted              !< with the conditioning of the earlier blocks
    type(replanning_type), intent(inout) :: replanning   !< with `same_as`; gets `rejected`
    integer :: b

    if (.not. allocated(wanted%conditioning)) return
    do b = 1, size(replanning%same_as)
      if (replanning%same_as(b) == 0) cycle
      if (wanted%conditioning(replanning%same_as(b)) < wanted%least) replanning%rejected = .true.
    end do
  end subroutine judge_same_blocks

  !> Find whether the blocks that are planned anew determine their unknowns in the present position, and are as well conditioned
  !> as is wanted.
  subroutine check_blocks(least, replanning)
    real(wp), intent(in) :: least                        !< least pivot ratio that is wanted
    type(replanning_type), intent(inout) :: replanning   !< with plan, state and `same_as`; gets `serves` and `rejected`
    type(block_work_type) :: work
    integer :: b

    do b = 1, size(replanning%same_as)
      associate (plan => replanning%plan, block => replanning%plan%blocks(b))
        if (size(block%unknowns) == 0 .or. replanning%same_as(b) > 0) cycle
        work = new_block_work(block)
        call factorize_block(plan, block, replanning%state, work)
        replanning%rejected = work%equations%conditioning() < least
        if (replanning%rejected) return
        replanning%serves = work%equations%rank(rank_tolerance_for(plan%data_tolerance)) == size(block%unknowns)
        if (.not. replanning%serves) return
      end associate
    end do
  end subroutine check_blocks
end module mech9_replanning
