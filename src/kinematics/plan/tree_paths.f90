!> Paths in the spanning tree of the steps. Frames are numbered outwards: walking back to a common frame starts from the
!> frame with the larger number.
module mech9_tree_paths
  use mech9_kinds, only: wp
  use mech9_plan, only: plan_type, step_type, closure_type, block_type, loop_type
  implicit none
  private
  public :: find_loop, split_loops, distance_between, mark_path, ascending

contains

  !> The whole loop of a closure, and its base: both ends are walked back until they meet.
  pure subroutine find_loop(steps, closure)
    type(step_type), intent(in) :: steps(:)        !< (M)
    type(closure_type), intent(inout) :: closure   !< its frames `closing` and `target` are set
    integer :: n

    n = 0
    call walk_back(steps, closure, n)
    if (allocated(closure%loop%steps)) deallocate (closure%loop%steps, closure%loop%signs)
    allocate (closure%loop%steps(n), closure%loop%signs(n))
    call walk_back(steps, closure, n, closure%loop)
    closure%loop%stems = closure%base
  end subroutine find_loop

  !> Walk both ends of a loop back until they meet in its base, counting the steps, and on a second walk writing them down
  !> from the base outwards.
  pure subroutine walk_back(steps, closure, n, loop)
    type(step_type), intent(in) :: steps(:)            !< (M)
    type(closure_type), intent(inout) :: closure       !< gets its base
    integer, intent(inout) :: n                        !< steps of the loop
    type(loop_type), intent(inout), optional :: loop   !< of n steps
    integer :: up, down, taken

    up = closure%closing
    down = closure%target
    taken = 0
    do while (up /= down)
      taken = taken + 1
      if (present(loop)) then
        loop%steps(n - taken + 1) = max(up, down)
        loop%signs(n - taken + 1) = merge(1.0_wp, -1.0_wp, up > down)
      end if
      if (up > down) then
        up = steps(up)%parent
      else
        down = steps(down)%parent
      end if
    end do
    closure%base = up
    n = taken
  end subroutine walk_back

  !> Find the parts of the loops that consist of a block's own steps; earlier steps belong to other blocks.
  pure subroutine split_loops(block, plan)
    type(block_type), intent(in) :: block    !< the block
    type(plan_type), intent(inout) :: plan   !< its closures get their parts
    logical, allocatable :: in_block(:)
    integer :: c

    do c = block%first_closure, block%last_closure
      associate (closure => plan%closures(c))
        in_block = closure%loop%steps >= block%first_step
        closure%part%steps = pack(closure%loop%steps, in_block)
        closure%part%signs = pack(closure%loop%signs, in_block)
        if (closure%coupling > 0) cycle
        closure%part%stems = [frame_before(plan%steps, closure%closing, block%first_step, closure%base), &
                              frame_before(plan%steps, closure%target, block%first_step, closure%base)]
      end associate
    end do
  end subroutine split_loops

  !> The last frame before step `first` on the path to a frame, but not before the base of its loop.
  pure integer function frame_before(steps, frame, first, base) result(before)
    type(step_type), intent(in) :: steps(:)   !< (M)
    integer, intent(in) :: frame              !< number of the frame
    integer, intent(in) :: first              !< step
    integer, intent(in) :: base               !< frame

    before = frame
    do while (before >= first .and. before /= base)
      before = steps(before)%parent
    end do
  end function frame_before

  !> Number of steps between two frames, counted up to `most`.
  pure integer function distance_between(steps, frame_a, frame_b, most) result(distance)
    type(step_type), intent(in) :: steps(:)   !< (M)
    integer, intent(in) :: frame_a            !< one frame
    integer, intent(in) :: frame_b            !< the other frame
    integer, intent(in) :: most               !< the count ends here
    integer :: a, b

    a = frame_a
    b = frame_b
    distance = 0
    do while (a /= b .and. distance < most)
      distance = distance + 1
      if (a > b) then
        a = steps(a)%parent
      else
        b = steps(b)%parent
      end if
    end do
  end function distance_between

  !> A few numbers in ascending order.
  pure function ascending(numbers) result(sorted)
    integer, intent(in) :: numbers(:)   !< all different
    integer :: sorted(size(numbers))
    integer :: i

    do i = 1, size(numbers)
      sorted(count(numbers <= numbers(i))) = numbers(i)
    end do
  end function ascending

  !> Mark the steps that lead from frame 0 to a frame.
  pure subroutine mark_path(steps, frame, marked)
    type(step_type), intent(in) :: steps(:)   !< (M)
    integer, intent(in) :: frame              !< number of the frame
    logical, intent(inout) :: marked(:)       !< (M)
    integer :: s

    s = frame
    do while (s > 0)
      if (marked(s)) return
      marked(s) = .true.
      s = steps(s)%parent
    end do
  end subroutine mark_path
end module mech9_tree_paths
