!> What of a motion is asked for, and what need not be worked out for it.
module mech9_requested
  use mech9_mechanism, only: mechanism_type
  use mech9_plan, only: plan_type, block_type
  implicit none
  private
  public :: requested_type, requested_by_results, add_forces, needed_blocks, leave_out, stay_with

  !> What is asked for.
  type :: requested_type
    logical, allocatable :: coordinates(:)   !< (M)
    logical, allocatable :: links(:)         !< (N) those whose motion is asked for
    integer :: derivatives = 2               !< in time, at most
  end type requested_type

contains

  !> What the results of a run show: all, unless the data file asks for less.
  pure function requested_by_results(mechanism, pictures) result(requested)
    type(mechanism_type), intent(in) :: mechanism   !< the mechanism
    logical, intent(in), optional :: pictures   !< of the mechanism are wanted: they show all links; not unless given
    type(requested_type) :: requested
    logical :: whole

    requested%coordinates = mechanism%output%recorded(size(mechanism%pairs))
    whole = .false.
    if (present(pictures)) whole = pictures
    allocate (requested%links(mechanism%structure%n_links), source=whole .or. mechanism%output%poses)
    requested%links(mechanism%points%link) = .true.
    requested%derivatives = merge(2, mechanism%output%derivatives, whole)
  end function requested_by_results

  !> What else the equations of motion ask for: links with mass, and whatever loads depend on.
  pure subroutine add_forces(mechanism, requested)
    type(mechanism_type), intent(in) :: mechanism   !< the mechanism
    type(requested_type), intent(inout) :: requested
    integer :: i

    do i = 1, size(mechanism%bodies)
      if (mechanism%bodies(i)%has_inertia()) requested%links(mechanism%bodies(i)%link) = .true.
    end do
    do i = 1, size(mechanism%loads)
      if (mechanism%loads(i)%load%is_idle()) cycle
      call mechanism%loads(i)%load%mark_links(requested%links)
      call mechanism%loads(i)%load%mark_coordinates(requested%coordinates)
    end do
  end subroutine add_forces

  !> The blocks on which something that is asked for depends.
  pure function needed_blocks(plan, requested) result(needed)
    type(plan_type), intent(in) :: plan   !< the plan of the mechanism
    type(requested_type), intent(in) :: requested
    logical :: needed(size(plan%blocks))
    logical :: frames(0:plan%n_coordinates)
    integer :: b

    call mark_links(plan, requested%links, frames)
    do b = size(plan%blocks), 1, -1
      associate (block => plan%blocks(b))
        needed(b) = any(frames(block%first_step:block%last_step)) .or. any(requested%coordinates(block%coordinates))
        if (needed(b)) call mark_departures(plan, block, frames)
      end associate
    end do
  end function needed_blocks

  !> Leave out the blocks on which nothing depends that is asked for, and accelerations of frames that only serve their
  !> own block. The chains of such blocks are not followed: whether they could go on is not noticed.
  pure subroutine leave_out(plan, requested)
    type(plan_type), intent(inout) :: plan   !< the plan of the mechanism
    type(requested_type), intent(in) :: requested
    type(block_type), allocatable :: blocks(:)
    logical :: needed(size(plan%blocks)), frames(0:plan%n_coordinates)
    integer :: b, n

    needed = needed_blocks(plan, requested)
    allocate (blocks(count(needed)))
    n = 0
    do b = 1, size(needed)
      if (.not. needed(b)) cycle
      n = n + 1
      blocks(n) = plan%blocks(b)
    end do
    call move_alloc(blocks, plan%blocks)
    call mark_links(plan, requested%links .and. requested%derivatives > 0, frames)
    do b = size(plan%blocks), 1, -1
      associate (block => plan%blocks(b))
        block%last_moved = block%last_step
        do while (block%last_moved >= block%first_step)
          if (frames(block%last_moved)) exit
          block%last_moved = block%last_moved - 1
        end do
        call mark_departures(plan, block, frames)
      end associate
    end do
  end subroutine leave_out

  !> What a plan follows is asked for from now on, whatever coordinates become independent: were a chain left out
  !> for a while, its position would not be known when another plan needs it.
  pure subroutine stay_with(plan, requested)
    type(plan_type), intent(in) :: plan   !< the plan of the mechanism
    type(requested_type), intent(inout) :: requested
    integer :: b

    requested%coordinates(plan%independent) = .true.
    do b = 1, size(plan%blocks)
      requested%coordinates(plan%blocks(b)%coordinates) = .true.
    end do
  end subroutine stay_with

  !> The frames of some links.
  pure subroutine mark_links(plan, links, frames)
    type(plan_type), intent(in) :: plan   !< the plan of the mechanism
    logical, intent(in) :: links(:)
    logical, intent(out) :: frames(0:)
    integer :: i

    frames = .false.
    do i = 1, size(links)
      if (links(i)) frames(plan%frame_of(i)) = .true.
    end do
  end subroutine mark_links

  !> The frames of earlier blocks on which a block stands.
  pure subroutine mark_departures(plan, block, frames)
    type(plan_type), intent(in) :: plan   !< the plan of the mechanism
    type(block_type), intent(in) :: block   !< the block
    logical, intent(inout) :: frames(0:)
    integer :: s, c

    do s = block%first_step, block%last_step
      if (plan%steps(s)%parent < block%first_step) frames(plan%steps(s)%parent) = .true.
    end do
    do c = block%first_closure, block%last_closure
      if (plan%closures(c)%target < block%first_step) frames(plan%closures(c)%target) = .true.
      if (plan%closures(c)%base < block%first_step) frames(plan%closures(c)%base) = .true.
    end do
  end subroutine mark_departures
end module mech9_requested
