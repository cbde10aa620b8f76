!> The coordinates and links whose motion is requested, and the blocks of a plan that can be left out.
module mech9_requested
  use mech9_kinds, only: wp
  use mech9_request, only: output_settings_type
  use mech9_long_term, only: section_type
  use mech9_mechanism, only: mechanism_type
  use mech9_turning_plane, only: turning_plane_type
  use mech9_link_way, only: link_way_type, find_ways
  use mech9_plan, only: plan_type, block_type
  implicit none
  private
  public :: requested_type, requested_by_results, add_forces, add_stops, add_section, requested_blocks, leave_out_unrequested, &
    request_planned

  !> The requested part of the motion.
  type :: requested_type
    logical, allocatable :: coordinates(:)   !< (M) coordinates that are requested
    logical, allocatable :: links(:)         !< (N) links whose motion is requested
    integer :: derivatives = 2               !< order of the highest derivative in time that is requested
    logical :: frames = .false.              !< all frames are read in space
    logical :: motions = .false.             !< the motion of all frames is read, up to the same order
  end type requested_type

contains

  !> The motion that the results of a run show: of all coordinates, unless the data file lists some; of links with points,
  !> or of all.
  pure function requested_by_results(mechanism, output, pictures) result(requested)
    type(mechanism_type), intent(in) :: mechanism   !< the mechanism
    type(output_settings_type), intent(in) :: output   !< the settings of the results
    logical, intent(in), optional :: pictures       !< there are pictures, which show all links; .false. unless given
    type(requested_type) :: requested
    logical :: whole

    requested%coordinates = output%recorded(size(mechanism%pairs))
    whole = .false.
    if (present(pictures)) whole = pictures
    allocate (requested%links(mechanism%structure%n_links), source=whole .or. output%poses)
    requested%links(mechanism%points%link) = .true.
    if (allocated(output%links)) call request_turning(mechanism, output, requested)
    requested%derivatives = merge(2, output%derivatives, whole)
    ! derivatives by parameters follow from the motion of all frames
    requested%motions = output%sensitivities
    requested%frames = output%sensitivities
    if (output%with_forces()) call request_all(requested)
  end function requested_by_results

  !> Request the links whose turning motion is recorded, and the coordinates on the ways to them, which count their whole turns.
  pure subroutine request_turning(mechanism, output, requested)
    type(mechanism_type), intent(in) :: mechanism      !< the mechanism
    type(output_settings_type), intent(in) :: output   !< the settings of the results
    type(requested_type), intent(inout) :: requested   !< the requested coordinates and links
    type(turning_plane_type) :: plane
    type(link_way_type), allocatable :: ways(:)
    integer :: i

    requested%links(output%links) = .true.
    requested%links(output%poles) = .true.
    allocate (plane%normal(3, 0))
    call find_ways(mechanism%structure, mechanism%pairs, output%links, plane, ways)
    do i = 1, size(ways)
      requested%coordinates(ways(i)%coordinates()) = .true.
    end do
  end subroutine request_turning

  !> Request the motion of all links and coordinates: a force may come from any of them.
  pure subroutine request_all(requested)
    type(requested_type), intent(inout) :: requested   !< the requested coordinates and links

    requested%coordinates = .true.
    requested%links = .true.
    requested%derivatives = 2
    requested%frames = .true.
  end subroutine request_all

  !> Request the motion that the equations of motion need: of links with mass, and of all links and coordinates that loads
  !> depend on.
  pure subroutine add_forces(mechanism, requested)
    type(mechanism_type), intent(in) :: mechanism      !< the mechanism
    type(requested_type), intent(inout) :: requested   !< the requested coordinates and links
    integer :: i

    requested%frames = .true.
    do i = 1, size(mechanism%bodies)
      if (mechanism%bodies(i)%has_inertia()) requested%links(mechanism%bodies(i)%link) = .true.
    end do
    call mechanism%mark_loaded_links(requested%links)
    call mechanism%mark_loaded_coordinates(requested%coordinates)
  end subroutine add_forces

  !> Request the coordinates that stops bound, with their rates.
  pure subroutine add_stops(mechanism, requested)
    type(mechanism_type), intent(in) :: mechanism      !< the mechanism
    type(requested_type), intent(inout) :: requested   !< the requested coordinates and links
    integer :: i

    do i = 1, size(mechanism%stops)
      requested%coordinates(mechanism%stops(i)%coordinate) = .true.
      requested%derivatives = max(1, requested%derivatives)
    end do
  end subroutine add_stops

  !> Request the coordinate of a section, with its rate and acceleration.
  pure subroutine add_section(section, requested)
    type(section_type), intent(in) :: section          !< the section
    type(requested_type), intent(inout) :: requested   !< the requested coordinates and links

    if (section%coordinate == 0) return
    requested%coordinates(section%coordinate) = .true.
    requested%derivatives = 2
  end subroutine add_section

  !> The blocks on which a requested coordinate or link depends.
  pure function requested_blocks(plan, requested) result(needed)
    type(plan_type), intent(in) :: plan             !< the plan of the mechanism
    type(requested_type), intent(in) :: requested   !< the requested coordinates and links
    logical :: needed(size(plan%blocks))
    logical :: frames(0:plan%n_coordinates)
    integer :: b

    call mark_links(plan, requested%links, frames)
    do b = size(plan%blocks), 1, -1
      associate (block => plan%blocks(b))
        needed(b) = any(frames(block%first_step:block%last_step)) .or. any(requested%coordinates(block%coordinates))
        ! a given coordinate must not leave its curve
        associate (steps => plan%steps(block%first_step:block%last_step))
          needed(b) = needed(b) .or. any(requested%coordinates(steps%coordinate) .and. steps%range(2) < huge(1.0_wp))
        end associate
        ! equations that determine nothing, because they are redundant, must hold all the same, and share forces with others
        needed(b) = needed(b) .or. (size(block%unknowns) == 0 .and. block%equations > 0)
        if (needed(b)) call mark_outer_frames(plan, block, frames)
      end associate
    end do
  end function requested_blocks

  !> Leave out the blocks on which no requested coordinate or link depends, and the accelerations of frames that are used
  !> in their own block only. The chains of blocks left out are not computed, so that their singular positions go unnoticed.
  pure subroutine leave_out_unrequested(plan, requested)
    type(plan_type), intent(inout) :: plan          !< the plan of the mechanism
    type(requested_type), intent(in) :: requested   !< the requested coordinates and links
    type(block_type), allocatable :: blocks(:)
    logical :: needed(size(plan%blocks)), frames(0:plan%n_coordinates)
    integer :: b, n

    needed = requested_blocks(plan, requested)
    allocate (blocks(count(needed)))
    n = 0
    do b = 1, size(needed)
      if (.not. needed(b)) cycle
      n = n + 1
      blocks(n) = plan%blocks(b)
    end do
    call move_alloc(blocks, plan%blocks)
    call mark_links(plan, requested%links .and. requested%derivatives > 0, frames)
    if (requested%motions) frames = requested%derivatives > 0
    do b = size(plan%blocks), 1, -1
      associate (block => plan%blocks(b))
        block%last_moved = block%last_step
        do while (block%last_moved >= block%first_step)
          if (frames(block%last_moved)) exit
          block%last_moved = block%last_moved - 1
        end do
        call mark_outer_frames(plan, block, frames)
      end associate
    end do
    if (allocated(plan%planar%planes) .and. .not. requested%frames) call show_outer_frames(plan)
  end subroutine leave_out_unrequested

  !> Show only those frames of planar blocks that blocks outside their plane use.
  pure subroutine show_outer_frames(plan)
    type(plan_type), intent(inout) :: plan   !< the plan of the mechanism
    integer :: b

    plan%planar%shown = .false.
    do b = 1, size(plan%blocks)
      associate (plane => plan%planar%plane_of(plan%blocks(b)%last_step))
        if (plane == 0) then
          call mark_outer_frames(plan, plan%blocks(b), plan%planar%shown)
        else
          plan%planar%shown(plan%planar%planes(plane)%base) = .true.
        end if
      end associate
    end do
    plan%planar%shown = plan%planar%shown .and. plan%planar%plane_of > 0
    do b = 1, size(plan%blocks)
      plan%blocks(b)%is_shown = any(plan%planar%shown(plan%blocks(b)%first_step:plan%blocks(b)%last_step))
    end do
  end subroutine show_outer_frames

  !> Request from now on all coordinates that a plan computes. When other coordinates become independent, another plan may
  !> need the position of a chain, which would be unknown if the chain had been left out before.
  pure subroutine request_planned(plan, requested)
    type(plan_type), intent(in) :: plan                !< the plan of the mechanism
    type(requested_type), intent(inout) :: requested   !< the requested coordinates and links
    integer :: b

    requested%coordinates(plan%independent) = .true.
    do b = 1, size(plan%blocks)
      requested%coordinates(plan%blocks(b)%coordinates) = .true.
    end do
  end subroutine request_planned

  !> Mark the frames of some links.
  pure subroutine mark_links(plan, links, frames)
    type(plan_type), intent(in) :: plan   !< the plan of the mechanism
    logical, intent(in) :: links(:)       !< (N) links whose frames are marked
    logical, intent(out) :: frames(0:)    !< (0:M) the frames of these links
    integer :: i

    frames = .false.
    do i = 1, size(links)
      if (links(i)) frames(plan%frame_of(i)) = .true.
    end do
  end subroutine mark_links

  !> Mark the frames of earlier blocks from which those of a block are computed.
  pure subroutine mark_outer_frames(plan, block, frames)
    type(plan_type), intent(in) :: plan     !< the plan of the mechanism
    type(block_type), intent(in) :: block   !< the block
    logical, intent(inout) :: frames(0:)    !< (0:M) becomes true for frames of earlier blocks that the block uses
    integer :: s, c

    do s = block%first_step, block%last_step
      if (plan%steps(s)%parent < block%first_step) frames(plan%steps(s)%parent) = .true.
    end do
    do c = block%first_closure, block%last_closure
      if (plan%closures(c)%target < block%first_step) frames(plan%closures(c)%target) = .true.
      if (plan%closures(c)%base < block%first_step) frames(plan%closures(c)%base) = .true.
      ! the coordinates of a coupling must be known, as if their frames were used
      if (plan%closures(c)%coupling > 0) frames(pack(plan%closures(c)%loop%steps, &
                                                     plan%closures(c)%loop%steps < block%first_step)) = .true.
    end do
  end subroutine mark_outer_frames
end module mech9_requested
