!> The entries of the frames in the plan of dynamics: on which independent coordinates each frame depends.
module mech9_frame_entries
  use mech9_plan, only: plan_type, block_type
  use mech9_clusters, only: clusters_type
  use mech9_lagrange_types, only: dynamics_plan_type
  implicit none
  private
  public :: find_columns, find_local

contains

  !> The columns of all frames, block by block.
  subroutine find_columns(plan, clusters, dynamics)
    type(plan_type), intent(in) :: plan                   !< the plan of the mechanism
    type(clusters_type), intent(in) :: clusters           !< its clusters
    type(dynamics_plan_type), intent(inout) :: dynamics   !< with `place_of`; gets the lists of entries
    integer :: b, s, m, last

    m = plan%n_coordinates
    last = 0
    allocate (dynamics%first(0:m + 1), source=1)
    allocate (dynamics%column(m), dynamics%parent_entry(m), dynamics%target_entry(m), source=0)
    do b = 1, size(plan%blocks)
      ! frames of blocks that were left out have no columns
      dynamics%first(last + 1:plan%blocks(b)%first_step) = dynamics%first(last + 1)
      last = plan%blocks(b)%last_step
      if (size(plan%blocks(b)%unknowns) > 0) then
        call add_closed_block(plan, clusters, plan%blocks(b), dynamics)
      else
        do s = plan%blocks(b)%first_step, plan%blocks(b)%last_step
          call add_frame(plan, s, column_of_step(plan, dynamics, s), dynamics)
        end do
      end if
    end do
    dynamics%first(last + 1:) = dynamics%first(last + 1)
    call resize(dynamics%first(m + 1) - 1, dynamics)
  end subroutine find_columns

  !> Change the length of the lists of entries; the entries that they keep do not change, and new ones are zero.
  pure subroutine resize(n, dynamics)
    integer, intent(in) :: n                              !< number of entries from now on
    type(dynamics_plan_type), intent(inout) :: dynamics   !< with the lists of entries
    integer :: filler(max(0, n - size(dynamics%column)))

    filler = 0
    dynamics%column = [dynamics%column(:min(n, size(dynamics%column))), filler]
    dynamics%parent_entry = [dynamics%parent_entry(:min(n, size(dynamics%parent_entry))), filler]
    dynamics%target_entry = [dynamics%target_entry(:min(n, size(dynamics%target_entry))), filler]
  end subroutine resize

  !> The columns of the frames of a block with closed chains: every frame of the block's cluster has those of all its closures.
  subroutine add_closed_block(plan, clusters, block, dynamics)
    type(plan_type), intent(in) :: plan                   !< the plan of the mechanism
    type(clusters_type), intent(in) :: clusters           !< its clusters
    type(block_type), intent(in) :: block                 !< the block
    type(dynamics_plan_type), intent(inout) :: dynamics   !< with the entries of earlier blocks; gets those of this one
    integer, allocatable :: columns(:)
    integer :: s, c, cluster

    allocate (columns(0))
    cluster = clusters%of_step(block%unknowns(1))
    do s = block%first_step, block%last_step
      if (clusters%of_step(s) /= cluster) cycle
      columns = united(columns, column_of_step(plan, dynamics, s))
      call add_earlier(plan%steps(s)%parent)
    end do
    do c = block%first_closure, block%last_closure
      call add_earlier(plan%closures(c)%target)
      if (plan%closures(c)%coupling == 0) cycle
      do s = 1, size(plan%closures(c)%loop%steps)
        call add_earlier(plan%closures(c)%loop%steps(s))
      end do
    end do
    do s = block%first_step, block%last_step
      if (clusters%of_step(s) == cluster) then
        call add_frame(plan, s, columns, dynamics)
      else
        call add_frame(plan, s, column_of_step(plan, dynamics, s), dynamics)
      end if
    end do
    do c = block%first_closure, block%last_closure
      call find_target_entries(plan%closures(c)%closing, plan%closures(c)%target, dynamics)
    end do

  contains

    !> Unite the columns with those of a frame of an earlier block in the same cluster.
    subroutine add_earlier(frame)
      integer, intent(in) :: frame   !< number of a frame

      if (frame == 0 .or. frame >= block%first_step) return
      if (clusters%of_step(frame) == cluster) columns = united(columns, columns_of(dynamics, frame))
    end subroutine add_earlier
  end subroutine add_closed_block

  !> The entries of one frame. Frames are added in the order of their numbers.
  subroutine add_frame(plan, s, columns, dynamics)
    type(plan_type), intent(in) :: plan                   !< the plan of the mechanism
    integer, intent(in) :: s                              !< number of the frame
    integer, intent(in) :: columns(:)                     !< places of its coordinates among the independent ones, ascending
    type(dynamics_plan_type), intent(inout) :: dynamics   !< with the entries of earlier frames; gets those of this one
    integer :: i, e

    dynamics%first(s + 1) = dynamics%first(s) + size(columns)
    if (dynamics%first(s + 1) - 1 > size(dynamics%column)) &
      call resize(max(dynamics%first(s + 1) - 1, 2*size(dynamics%column)), dynamics)
    do i = 1, size(columns)
      e = dynamics%first(s) + i - 1
      dynamics%column(e) = columns(i)
      dynamics%parent_entry(e) = entry_of(dynamics, plan%steps(s)%parent, columns(i))
    end do
  end subroutine add_frame

  !> For each entry of a closing frame, the entry of its target frame with the same column.
  subroutine find_target_entries(closing, target, dynamics)
    integer, intent(in) :: closing                        !< number of the closing frame
    integer, intent(in) :: target                         !< number of the target frame
    type(dynamics_plan_type), intent(inout) :: dynamics   !< with the entries of both; gets `target_entry`
    integer :: e

    do e = dynamics%first(closing), dynamics%first(closing + 1) - 1
      dynamics%target_entry(e) = entry_of(dynamics, target, dynamics%column(e))
    end do
  end subroutine find_target_entries

  !> The entry of a column in a frame's list; 0 where the frame does not depend on it.
  pure integer function entry_of(dynamics, frame, column) result(e)
    type(dynamics_plan_type), intent(in) :: dynamics   !< with the entries of the frame
    integer, intent(in) :: frame                       !< number of the frame
    integer, intent(in) :: column                      !< place of a coordinate among the independent ones

    do e = dynamics%first(frame), dynamics%first(frame + 1) - 1
      if (dynamics%column(e) == column) return
    end do
    e = 0
  end function entry_of

  !> The columns of a frame.
  pure function columns_of(dynamics, frame) result(columns)
    type(dynamics_plan_type), intent(in) :: dynamics   !< with the entries of the frame
    integer, intent(in) :: frame                       !< number of the frame
    integer, allocatable :: columns(:)   !< places of its coordinates among the independent ones, ascending

    columns = dynamics%column(dynamics%first(frame):dynamics%first(frame + 1) - 1)
  end function columns_of

  !> The column of a step's own coordinate, or none where this coordinate is dependent.
  pure function column_of_step(plan, dynamics, s) result(columns)
    type(plan_type), intent(in) :: plan                !< the plan of the mechanism
    type(dynamics_plan_type), intent(in) :: dynamics   !< with `place_of`
    integer, intent(in) :: s                           !< number of the step
    integer, allocatable :: columns(:)   !< place of the coordinate among the independent ones; empty for none

    columns = pack([dynamics%place_of(plan%steps(s)%coordinate)], [.not. plan%steps(s)%dependent])
  end function column_of_step

  !> The union of two sets of numbers.
  pure function united(a, b) result(c)
    integer, intent(in) :: a(:)   !< one set, ascending
    integer, intent(in) :: b(:)   !< the other set, ascending
    integer, allocatable :: c(:)   !< the numbers that are in either, ascending
    integer :: buffer(size(a) + size(b)), i, j, n

    i = 1
    j = 1
    n = 0
    do while (i <= size(a) .or. j <= size(b))
      n = n + 1
      if (j > size(b)) then
        buffer(n) = a(i)
      else if (i > size(a)) then
        buffer(n) = b(j)
      else
        buffer(n) = min(a(i), b(j))
      end if
      if (i <= size(a)) then
        if (a(i) == buffer(n)) i = i + 1
      end if
      if (j <= size(b)) then
        if (b(j) == buffer(n)) j = j + 1
      end if
    end do
    c = buffer(:n)
  end function united

  !> The places of columns among those of their cluster.
  pure subroutine find_local(places, first, last, dynamics)
    integer, intent(in) :: places(:)                      !< places of the cluster's coordinates, ascending
    integer, intent(in) :: first                          !< first entry
    integer, intent(in) :: last                           !< last entry
    type(dynamics_plan_type), intent(inout) :: dynamics   !< with the entries; gets `local`
    integer :: e, i

    i = 1
    do e = first, last
      do while (places(i) < dynamics%column(e))
        i = i + 1
      end do
      dynamics%local(e) = i
    end do
  end subroutine find_local
end module mech9_frame_entries
