!> Last part of the plan: the planar blocks of a spatial mechanism, and their planes.
!>
!> A block is planar if its axes that turn are parallel to one normal, those that slide are perpendicular to it, and its chains
!> close in three dimensions. Its plane is fixed in its *base*, the last frame that the paths to all its loops have in common.
!> A later block lies in the same plane if its base is a frame of the plane, or the plane's base itself. Steps with given
!> coordinates that only carry the base become a block of their own, an open chain.
module mech9_planar_blocks
  use mech9_plan, only: plan_type, block_type
  use mech9_planar_plan, only: planar_plan_type, planar_closure_type, plane_type
  use mech9_planar_layout, only: planar_frame_type, lay_out_step, lay_out_closure, seen_from_plane, find_axes
  implicit none
  private
  public :: lay_out_planes

contains

  !> Lay out the planar blocks of a plan that is in space, in their planes. Its blocks must be final.
  pure subroutine lay_out_planes(plan)
    type(plan_type), intent(inout) :: plan   !< the plan of the mechanism
    type(planar_plan_type) :: planar
    type(planar_frame_type) :: frames(0:plan%n_coordinates)
    type(block_type), allocatable :: blocks(:)
    integer :: b, n, base, plane

    call make_room(plan, planar)
    allocate (blocks(2*size(plan%blocks)))
    n = 0
    do b = 1, size(plan%blocks)
      n = n + 1
      blocks(n) = plan%blocks(b)
      call find_base(plan, blocks(n), base)
      if (base < 0) cycle
      call find_plane(plan, blocks(n), base, planar, frames, plane)
      if (plane == 0) cycle
      if (base >= blocks(n)%first_step) then
        n = n + 1
        blocks(n) = blocks(n - 1)
        blocks(n)%first_step = base + 1
        blocks(n - 1) = open_block(blocks(n), plan%blocks(b)%first_step)
      end if
      call name_base_zero(planar%planes(plane)%base, blocks(n), plan)
    end do
    if (size(planar%planes) == 0) return
    plan%blocks = blocks(:n)
    call keep_frames(plan, frames, planar)
    call move_alloc(plan%planar%why_not, planar%why_not)
    plan%planar = planar
    do b = 1, n
      plan%blocks(b)%is_shown = planar%plane_of(blocks(b)%last_step) > 0
    end do
  end subroutine lay_out_planes

  !> Room for steps and closures, without planes.
  pure subroutine make_room(plan, planar)
    type(plan_type), intent(in) :: plan               !< the plan of the mechanism
    type(planar_plan_type), intent(inout) :: planar   !< gets the room

    planar%length = plan%length
    allocate (planar%steps(plan%n_coordinates), planar%closures(size(plan%closures)), planar%planes(0))
    allocate (planar%plane_of(0:plan%n_coordinates), source=0)
  end subroutine make_room

  !> The base of a block: the last frame that the paths from frame 0 to all its loops have in common.
  pure subroutine find_base(plan, block, base)
    type(plan_type), intent(in) :: plan     !< the plan of the mechanism
    type(block_type), intent(in) :: block   !< the block
    integer, intent(out) :: base            !< number of the frame; -1 where the block cannot be planar
    integer :: c, other

    base = -1
    if (block%last_closure < block%first_closure) return
    if (any(plan%closures(block%first_closure:block%last_closure)%rank /= 3)) return
    base = plan%closures(block%first_closure)%base
    do c = block%first_closure + 1, block%last_closure
      other = plan%closures(c)%base
      do while (base /= other)
        if (base > other) then
          base = plan%steps(base)%parent
        else
          other = plan%steps(other)%parent
        end if
      end do
    end do
    ! steps up to the base only carry it, so that their coordinates are given
    if (any(block%unknowns <= base)) base = -1
  end subroutine find_base

  !> Find a plane for a block: one of the planes to which its base belongs, or a new one.
  pure subroutine find_plane(plan, block, base, planar, frames, plane)
    type(plan_type), intent(in) :: plan                    !< the plan of the mechanism
    type(block_type), intent(in) :: block                  !< the block
    integer, intent(in) :: base                            !< its base
    type(planar_plan_type), intent(inout) :: planar        !< with the planes so far; gets the block's steps and closures
    type(planar_frame_type), intent(inout) :: frames(0:)   !< (0:M) frames of planar blocks; gets those of this block
    integer, intent(out) :: plane                          !< number of the plane; 0: the block is not planar
    type(plane_type) :: new
    logical :: fits, in_xy_plane

    do plane = 1, size(planar%planes)
      if (planar%planes(plane)%base /= base .and. planar%plane_of(base) /= plane) cycle
      call lay_out_block(plan, block, base, plane, planar, frames, fits)
      if (fits) return
    end do
    new%base = base
    call find_axes(plan%steps, base, max(block%first_step, base + 1), block%last_step, new%axes, in_xy_plane, fits)
    if (fits) then
      planar%planes = [planar%planes, new]
      plane = size(planar%planes)
      call lay_out_block(plan, block, base, plane, planar, frames, fits)
      if (fits) return
      planar%planes = planar%planes(:plane - 1)
    end if
    plane = 0
  end subroutine find_plane

  !> Lay out the steps and closures of a block in a plane.
  pure subroutine lay_out_block(plan, block, base, plane, planar, frames, fits)
    type(plan_type), intent(in) :: plan                    !< the plan of the mechanism
    type(block_type), intent(in) :: block                  !< the block
    integer, intent(in) :: base                            !< its base
    integer, intent(in) :: plane                           !< number of the plane
    type(planar_plan_type), intent(inout) :: planar        !< gets the steps and closures of the block where they fit
    type(planar_frame_type), intent(inout) :: frames(0:)   !< (0:M) frames of planar blocks; gets those of this block
    logical, intent(out) :: fits                           !< the block lies in the plane
    integer :: s, c, parent, first

    first = max(block%first_step, base + 1)
    fits = .true.
    do s = first, block%last_step
      parent = plan%steps(s)%parent
      fits = is_in_plane(planar, plane, parent)
      if (fits) call lay_out_step(plan%steps(s), planar_number(planar, plane, parent), &
                                  planar_frame(planar, plane, parent, frames), planar%steps(s), frames(s), fits)
      if (.not. fits) exit
      planar%plane_of(s) = plane
    end do
    do c = block%first_closure, block%last_closure
      if (.not. fits) exit
      associate (closure => plan%closures(c), flat => planar%closures(c))
        fits = is_in_plane(planar, plane, closure%target)
        if (.not. fits) exit
        flat = planar_closure_type(closing=closure%closing, target=planar_number(planar, plane, closure%target), &
                                   base=planar_number(planar, plane, closure%base))
        call lay_out_closure(closure%in_target, frames(closure%closing), planar_frame(planar, plane, closure%target, frames), &
                             plan%length, flat, fits)
      end associate
    end do
    if (.not. fits) planar%plane_of(first:block%last_step) = 0
  end subroutine lay_out_block

  !> Whether a frame belongs to a plane, or is its base.
  pure logical function is_in_plane(planar, plane, frame)
    type(planar_plan_type), intent(in) :: planar   !< with the planes
    integer, intent(in) :: plane                   !< number of the plane
    integer, intent(in) :: frame                   !< number of the frame

    is_in_plane = frame == planar%planes(plane)%base .or. planar%plane_of(frame) == plane
  end function is_in_plane

  !> The number of a frame in a plane: 0 for its base.
  pure integer function planar_number(planar, plane, frame)
    type(planar_plan_type), intent(in) :: planar   !< with the planes
    integer, intent(in) :: plane                   !< number of the plane
    integer, intent(in) :: frame                   !< number of the frame, which belongs to the plane or is its base

    planar_number = merge(0, frame, frame == planar%planes(plane)%base)
  end function planar_number

  !> The planar frame of a frame in a plane.
  pure function planar_frame(planar, plane, frame, frames) result(flat)
    type(planar_plan_type), intent(in) :: planar          !< with the planes
    integer, intent(in) :: plane                          !< number of the plane
    integer, intent(in) :: frame                          !< number of the frame, which belongs to the plane or is its base
    type(planar_frame_type), intent(in) :: frames(0:)     !< (0:M) frames of planar blocks
    type(planar_frame_type) :: flat

    if (frame == planar%planes(plane)%base) then
      flat%to_planar = transpose(planar%planes(plane)%axes)
    else
      flat = frames(frame)
    end if
  end function planar_frame

  !> The steps of a block before its own first one, as an open chain.
  pure function open_block(block, first_step) result(carrier)
    type(block_type), intent(in) :: block   !< the block
    integer, intent(in) :: first_step       !< first step of the open chain, which ends before the block
    type(block_type) :: carrier

    carrier%first_step = first_step
    carrier%last_step = block%first_step - 1
    carrier%first_closure = block%first_closure
    carrier%last_closure = block%first_closure - 1
    allocate (carrier%chains(0), carrier%unknowns(0), carrier%coordinates(0))
  end function open_block

  !> Let 0 stand for the base of the plane where parts of loops begin in it.
  pure subroutine name_base_zero(base, block, plan)
    integer, intent(in) :: base              !< base of the plane
    type(block_type), intent(in) :: block    !< a block in the plane
    type(plan_type), intent(inout) :: plan   !< its closures are changed
    integer :: c

    do c = block%first_closure, block%last_closure
      where (plan%closures(c)%part%stems == base) plan%closures(c)%part%stems = 0
    end do
  end subroutine name_base_zero

  !> Keep the frames, and the systems of links in them. All frames of planar blocks are shown.
  pure subroutine keep_frames(plan, frames, planar)
    type(plan_type), intent(in) :: plan                   !< the plan of the mechanism
    type(planar_frame_type), intent(in) :: frames(0:)     !< (0:M) frames of planar blocks
    type(planar_plan_type), intent(inout) :: planar       !< with the planes; gets the frames
    integer :: s, link

    allocate (planar%height(0:plan%n_coordinates), source=frames%height)
    allocate (planar%to_planar(3, 3, 0:plan%n_coordinates), planar%link_in_frame(plan%n_links))
    do s = 0, plan%n_coordinates
      planar%to_planar(:, :, s) = frames(s)%to_planar
    end do
    allocate (planar%shown(0:plan%n_coordinates), source=planar%plane_of > 0)
    do link = 1, plan%n_links
      if (planar%plane_of(plan%frame_of(link)) > 0) &
        planar%link_in_frame(link) = seen_from_plane(frames(plan%frame_of(link)), plan%link_in_frame(link))
    end do
  end subroutine keep_frames
end module mech9_planar_blocks
