!> First part of the plan: the spanning tree of steps and frames (Jain in docs/reference/bibliography.md), from the structural
!> vectors. Constant poses are combined.
!>
!> A closed chain joins two known links by links that are new. These are reached from both ends, so that every frame is as few
!> steps as possible from the frame of link 1; the last step reaches a link that is known already and makes a second frame of
!> it. A later chain may start from either frame of a link: the one is taken that makes the loop short.
module mech9_spanning_tree
  use mech9_kinds, only: wp, pi
  use mech9_pose, only: pose_type, compose, inverse, identity_pose
  use mech9_pair, only: screw_factors_type, pair_guide_type, pair_slot_type
  use mech9_structural_vectors, only: chain_type, chains_of
  use mech9_partition, only: partition_type
  use mech9_mechanism, only: mechanism_type
  use mech9_plan, only: plan_type, step_type, closure_type
  use mech9_tree_paths, only: find_loop, distance_between, ascending
  use mech9_scaling, only: find_size, find_units
  implicit none
  private
  public :: lay_out_frames, renew_frames

  !> Number of second frames of a link that are kept, the latest ones.
  integer, parameter :: most_remembered = 3

  !> The frames that are laid out so far.
  type :: layout_type
    integer :: steps = 0                               !< number of steps made so far
    integer :: closures = 0                            !< number of closures made so far
    integer, allocatable :: depth(:)                   !< (0:M) number of steps from frame 0
    type(pose_type), allocatable :: link_in(:)         !< (0:M) the link's own system in the frame
    integer, allocatable :: further(:, :)              !< (most_remembered,N) numbers of second frames of each link, 0 if none
  end type layout_type

contains

  !> Lay out steps, frames and closures chain by chain. Ranks and rows of the closures, and the blocks, are found later.
  subroutine lay_out_frames(mechanism, partition, start, plan, length, origin)
    type(mechanism_type), intent(in) :: mechanism   !< the mechanism
    type(partition_type), intent(in) :: partition   !< driven, free and dependent coordinates, and the order of computation
    real(wp), intent(in) :: start(:)                !< (M) coordinates at the start [rad, m]
    type(plan_type), intent(out) :: plan   !< the plan of the mechanism
    real(wp), intent(in), optional :: length        !< the mechanism's size, where it is known from an earlier plan [m]
    real(wp), intent(in), optional :: origin(3)     !< origin of frame 0 in link 1, where it is known from an earlier plan [m]
    type(chain_type), allocatable :: chains(:)
    type(layout_type) :: layout
    integer :: i

    associate (structure => mechanism%structure)
      plan%n_links = structure%n_links
      plan%n_coordinates = structure%n_coordinates
      plan%independent = pack([(i, i=1, structure%n_coordinates)], partition%independent())
      plan%driven = partition%driven()
      plan%free_places = pack([(i, i=1, size(plan%independent))], .not. plan%driven(plan%independent))
      plan%free = plan%independent(plan%free_places)
    end associate
    plan%data_tolerance = mechanism%data_tolerance
    allocate (plan%steps(plan%n_coordinates), plan%step_of(plan%n_coordinates))
    allocate (plan%frame_of(plan%n_links), source=0)
    allocate (plan%link_in_frame(plan%n_links), plan%pairs(plan%n_coordinates))
    allocate (plan%couplings(0))
    if (allocated(mechanism%couplings)) plan%couplings = mechanism%couplings
    allocate (plan%closures(plan%n_coordinates - plan%n_links + 1 + size(plan%couplings)))
    call find_size(mechanism, start, plan)
    if (present(length)) plan%length = length
    if (present(origin)) plan%origin = origin
    call find_units(mechanism, plan)
    plan%link_in_frame(1)%p = -plan%origin
    allocate (layout%depth(0:plan%n_coordinates), source=0)
    allocate (layout%link_in(0:plan%n_coordinates))
    allocate (layout%further(most_remembered, plan%n_links), source=0)
    layout%link_in(0) = plan%link_in_frame(1)
    chains = chains_of(partition%vectors)
    do i = 1, size(chains)
      associate (nrg => partition%vectors%nrg(chains(i)%first - 1:chains(i)%last), &
                 nws => partition%vectors%nws(chains(i)%first:chains(i)%last))
        call lay_out_chain(mechanism, i, nrg, nws, chains(i)%closed, plan, layout)
      end associate
    end do
    associate (independent => partition%independent())
      plan%steps%dependent = .not. independent(plan%steps%coordinate)
    end associate
    do i = 1, size(plan%couplings)
      layout%closures = layout%closures + 1
      call make_coupling(i, plan, plan%closures(layout%closures))
    end do
  end subroutine lay_out_frames

  !> Give the frames of a plan the constant poses and offsets of another mechanism that differs in its numbers only. Size, origin,
  !> units, ranks and planes stay. The numbers are those of lay_out_frames, bit for bit.
  subroutine renew_frames(mechanism, plan)
    type(mechanism_type), intent(in) :: mechanism   !< the other mechanism
    type(plan_type), intent(inout) :: plan          !< its steps may be sorted by blocks; gets the numbers
    type(pose_type) :: link_in(0:plan%n_coordinates)
    integer :: s, c

    if (allocated(mechanism%couplings)) plan%couplings = mechanism%couplings
    plan%link_in_frame(1)%r = identity_pose%r
    plan%link_in_frame(1)%p = -plan%origin
    link_in(0) = plan%link_in_frame(1)
    do s = 1, plan%n_coordinates
      associate (step => plan%steps(s))
        call set_numbers(mechanism, link_in(step%parent), plan%pairs(step%coordinate), step, link_in(s))
        if (plan%frame_of(step%link) == s) plan%link_in_frame(step%link) = link_in(s)
      end associate
    end do
    do c = 1, size(plan%closures)
      associate (closure => plan%closures(c))
        if (closure%coupling > 0) cycle
        closure%in_target = compose(link_in(closure%target), inverse(link_in(closure%closing)))
      end associate
    end do
    do c = 1, size(plan%closures)
      if (plan%closures(c)%coupling > 0) call set_coupling_numbers(plan%closures(c)%coupling, plan, plan%closures(c))
    end do
  end subroutine renew_frames

  !> Lay out one chain. Open chains, and the stem of a chain that closes on itself, start at their known end.
  subroutine lay_out_chain(mechanism, chain, links, coordinates, closed, plan, layout)
    type(mechanism_type), intent(in) :: mechanism   !< the mechanism
    integer, intent(in) :: chain   !< number of the chain
    integer, intent(in) :: links(0:)   !< (0:) the known link at which the chain starts, then the link of each step
    integer, intent(in) :: coordinates(:)   !< number of the coordinate of each step
    logical, intent(in) :: closed   !< the chain is closed
    type(plan_type), intent(inout) :: plan   !< the plan of the mechanism
    type(layout_type), intent(inout) :: layout   !< the frames that are laid out so far
    integer :: i, n, stem, frame

    n = size(coordinates)
    stem = n
    if (closed) then
      do stem = n - 1, 1, -1
        if (links(stem) == links(n)) exit
      end do
    end if
    frame = plan%frame_of(links(0))
    do i = 1, stem
      call add_step(mechanism, step_type(parent=frame, coordinate=coordinates(i), link=links(i), chain=chain), plan, layout)
      frame = layout%steps
      call make_first(frame, plan, layout)
    end do
    if (closed) call lay_out_loop(mechanism, chain, links(stem:), coordinates(stem + 1:), plan, layout)
  end subroutine lay_out_chain

  !> Lay out new links between two known ones from both ends, and the closure where they meet.
  subroutine lay_out_loop(mechanism, chain, links, coordinates, plan, layout)
    type(mechanism_type), intent(in) :: mechanism   !< the mechanism
    integer, intent(in) :: chain   !< number of the chain
    integer, intent(in) :: links(0:)   !< (0:) a known link, the new links, a known link
    integer, intent(in) :: coordinates(:)   !< number of the coordinate of each step
    type(plan_type), intent(inout) :: plan   !< the plan of the mechanism
    type(layout_type), intent(inout) :: layout   !< the frames that are laid out so far
    integer :: n, here, there, from_here, i

    n = size(coordinates)
    call nearest_frames(plan, layout, links(0), links(n), here, there)
    from_here = (n + layout%depth(there) - layout%depth(here))/2
    from_here = max(0, min(n - 1, from_here))
    ! chains close on links that the user knows, not inside a joint with several freedoms: the last of them is one
    do while (mechanism%structure%joint_of_link(links(from_here + 1)) > 0)
      from_here = from_here + 1
    end do
    do i = 1, from_here
      call add_step(mechanism, step_type(parent=here, coordinate=coordinates(i), link=links(i), chain=chain), plan, layout)
      here = layout%steps
      call make_first(here, plan, layout)
    end do
    do i = n - 1, from_here + 1, -1
      call add_step(mechanism, step_type(parent=there, coordinate=coordinates(i + 1), link=links(i), chain=chain), plan, layout)
      there = layout%steps
      call make_first(there, plan, layout)
    end do
    i = from_here + 1
    call add_step(mechanism, step_type(parent=here, coordinate=coordinates(i), link=links(i), chain=chain), plan, layout)
    layout%closures = layout%closures + 1
    call make_closure(plan, layout, layout%steps, there, plan%closures(layout%closures))
    layout%further(:, links(i)) = [layout%steps, layout%further(:most_remembered - 1, links(i))]
  end subroutine lay_out_loop

  !> A frame of each of two links, chosen so that there are few steps from one to the other.
  pure subroutine nearest_frames(plan, layout, a, b, frame_a, frame_b)
    type(plan_type), intent(in) :: plan   !< the plan of the mechanism
    type(layout_type), intent(in) :: layout   !< the frames that are laid out so far
    integer, intent(in) :: a   !< number of the first link
    integer, intent(in) :: b   !< number of the second link
    integer, intent(out) :: frame_a   !< frame of the first link
    integer, intent(out) :: frame_b   !< frame of the second link
    integer :: frames_a(0:most_remembered), frames_b(0:most_remembered), i, j, most, distance, least

    frames_a = [plan%frame_of(a), layout%further(:, a)]
    frames_b = [plan%frame_of(b), layout%further(:, b)]
    ! short distances are tried first, because the search takes as many steps as the distance that it may find
    most = 8
    do
      least = most + 1
      do i = 0, most_remembered
        if (i > 0 .and. frames_a(i) == 0) exit
        do j = 0, most_remembered
          if (j > 0 .and. frames_b(j) == 0) exit
          distance = distance_between(plan%steps, frames_a(i), frames_b(j), least)
          if (distance >= least) cycle
          least = distance
          frame_a = frames_a(i)
          frame_b = frames_b(j)
        end do
      end do
      if (least <= most) return
      most = 8*most
    end do
  end subroutine nearest_frames

  !> Make a frame the first one of its link, which gives the link's position.
  pure subroutine make_first(frame, plan, layout)
    integer, intent(in) :: frame   !< number of the frame
    type(plan_type), intent(inout) :: plan   !< the plan of the mechanism
    type(layout_type), intent(in) :: layout   !< the frames that are laid out so far

    plan%frame_of(plan%steps(frame)%link) = frame
    plan%link_in_frame(plan%steps(frame)%link) = layout%link_in(frame)
  end subroutine make_first

  !> Add a step through a pair to a new frame, whose number is layout%steps then.
  subroutine add_step(mechanism, step, plan, layout)
    type(mechanism_type), intent(in) :: mechanism   !< the mechanism
    type(step_type), intent(in) :: step   !< the step, with its parent, coordinate, link and chain
    type(plan_type), intent(inout) :: plan   !< the plan of the mechanism
    type(layout_type), intent(inout) :: layout   !< the frames that are laid out so far
    integer :: from

    from = 1
    if (step%parent > 0) from = plan%steps(step%parent)%link
    layout%steps = layout%steps + 1
    layout%depth(layout%steps) = layout%depth(step%parent) + 1
    plan%step_of(step%coordinate) = layout%steps
    associate (new => plan%steps(layout%steps))
      new = step
      new%reversed = mechanism%pairs(step%coordinate)%pair%reference /= from
      call set_numbers(mechanism, layout%link_in(step%parent), plan%pairs(step%coordinate), new, layout%link_in(layout%steps))
    end associate
  end subroutine add_step

  !> The numbers of a step.
  subroutine set_numbers(mechanism, link_in_frame, slot, step, after)
    type(mechanism_type), intent(in) :: mechanism    !< the mechanism
    type(pose_type), intent(in) :: link_in_frame     !< system of the link where the step starts, in the frame where it starts
    type(pair_slot_type), intent(inout) :: slot      !< of the plan; gets the pair where it has no fixed axis
    type(step_type), intent(inout) :: step           !< with its coordinate and direction; gets the numbers
    type(pose_type), intent(out) :: after            !< the reached link's system in the new frame
    type(screw_factors_type) :: factors
    type(pair_guide_type) :: guide
    type(step_type), parameter :: anywhere = step_type()
    real(wp) :: direction

    step%period = anywhere%period
    step%range = anywhere%range
    associate (pair => mechanism%pairs(step%coordinate)%pair)
      call pair%as_screw(factors, step%is_screw)
      if (step%reversed) then
        step%before = compose(link_in_frame, inverse(factors%after))
        after = inverse(factors%before)
      else
        step%before = compose(link_in_frame, factors%before)
        after = factors%after
      end if
      if (step%is_screw) then
        direction = merge(-1.0_wp, 1.0_wp, step%reversed)
        step%turn = direction*factors%turn
        step%slide = direction*factors%slide
        step%offset = factors%offset
        if (abs(step%turn) > 0.0_wp .and. .not. abs(step%slide) > 0.0_wp) step%period = 2.0_wp*pi
      else
        if (allocated(slot%pair)) deallocate (slot%pair)
        allocate (slot%pair, source=pair)
        call pair%guide(guide)
        step%searchable = guide%length > 0.0_wp
        if (guide%closed) step%period = guide%length
        if (step%searchable .and. .not. guide%closed) step%range = [0.0_wp, guide%length]
      end if
    end associate
  end subroutine set_numbers

  !> The closure where two frames of a link must coincide, and the loop it belongs to.
  subroutine make_closure(plan, layout, closing, target, closure)
    type(plan_type), intent(in) :: plan   !< the plan of the mechanism
    type(layout_type), intent(in) :: layout   !< the frames that are laid out so far
    integer, intent(in) :: closing   !< number of the frame that the last step made
    integer, intent(in) :: target   !< number of the link's other frame, with which it must coincide
    type(closure_type), intent(out) :: closure   !< the closure, with its loop

    closure%chain = layout%closures
    closure%closing = closing
    closure%target = target
    closure%in_target = compose(layout%link_in(target), inverse(layout%link_in(closing)))
    call find_loop(plan%steps, closure)
  end subroutine make_closure

  !> The closure that is a coupling.
  pure subroutine make_coupling(number, plan, closure)
    integer, intent(in) :: number                !< of the coupling
    type(plan_type), intent(inout) :: plan       !< with its steps, which lose their periods
    type(closure_type), intent(inout) :: closure !< gets its equation; one of those of the plan

    closure%chain = -number
    closure%coupling = number
    closure%rank = 1
    closure%independent_equations = 1
    closure%loop%steps = ascending(plan%step_of(plan%couplings(number)%coupling%coordinates))
    allocate (closure%loop%signs(size(closure%loop%steps)), source=1.0_wp)
    call set_coupling_numbers(number, plan, closure)
  end subroutine make_coupling

  !> The numbers of a coupling's equation. Full turns of its coordinates count, so that these have no period.
  pure subroutine set_coupling_numbers(number, plan, closure)
    integer, intent(in) :: number                !< of the coupling
    type(plan_type), intent(inout) :: plan       !< with the numbers of its steps, which lose their periods
    type(closure_type), intent(inout) :: closure !< gets the numbers; one of those of the plan
    real(wp) :: ends(2)
    integer :: first

    associate (coupling => plan%couplings(number)%coupling)
      closure%weight = coupling%weight(plan%unit_of(coupling%coordinates))
    end associate
    plan%steps(closure%loop%steps)%period = 0.0_wp
    associate (coupling => plan%couplings(number)%coupling)
      if (coupling%is_linear()) return
      ends = coupling%ends()
      first = plan%step_of(coupling%coordinates(1))
    end associate
    plan%has_curves = .true.
    associate (step => plan%steps(first))
      step%range = [max(step%range(1), ends(1)), min(step%range(2), ends(2))]
    end associate
  end subroutine set_coupling_numbers
end module mech9_spanning_tree
