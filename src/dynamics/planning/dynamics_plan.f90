!> The plan of dynamics: which links have inertia, and on which independent coordinates each frame depends.
module mech9_dynamics_plan
  use mech9_kinds, only: wp
  use mech9_rotation, only: turn
  use mech9_pose, only: transformed
  use mech9_inertia, only: inertia_in_axes
  use mech9_mechanism, only: mechanism_type
  use mech9_plan, only: plan_type, block_type
  use mech9_clusters, only: clusters_type, find_clusters
  use mech9_tree_stages, only: stage_type, find_stages, find_plane
  use mech9_moving_plane, only: add_to_plane
  use mech9_lagrange_types, only: dynamics_plan_type, frame_body_type
  use mech9_spatial_dynamics, only: new_spatial_dynamics
  use mech9_planar_dynamics, only: new_planar_dynamics
  use mech9_plane_block_dynamics, only: new_plane_block_dynamics
  implicit none
  private
  public :: make_dynamics_plan

contains

  !> Make the plan of dynamics; `plan` must have its blocks.
  subroutine make_dynamics_plan(mechanism, plan, dynamics)
    type(mechanism_type), intent(in) :: mechanism       !< the mechanism
    type(plan_type), intent(in) :: plan                 !< the plan of the mechanism
    type(dynamics_plan_type), intent(out) :: dynamics   !< the plan of dynamics
    type(clusters_type) :: clusters
    integer :: i

    dynamics%gravity = mechanism%gravity
    allocate (dynamics%place_of(plan%n_coordinates), source=0)
    do i = 1, size(plan%independent)
      dynamics%place_of(plan%independent(i)) = i
    end do
    dynamics%held = pack([(i, i=1, size(plan%independent))], plan%driven(plan%independent))
    allocate (dynamics%load_links(plan%n_links), source=.false.)
    dynamics%acting = pack([(i, i=1, size(mechanism%loads))], &
                           [(.not. mechanism%loads(i)%load%is_idle(), i=1, size(mechanism%loads))])
    do i = 1, size(dynamics%acting)
      call mechanism%loads(dynamics%acting(i))%load%mark_links(dynamics%load_links)
    end do
    dynamics%loaded = pack([(i, i=2, plan%n_links)], dynamics%load_links(2:))
    call find_bodies(mechanism, plan, dynamics)
    clusters = find_clusters(plan)
    dynamics%support = clusters%base
    call find_columns(plan, clusters, dynamics)
    call find_carriers(plan, dynamics)
    call find_tree(plan, clusters, dynamics)
    call find_planes(plan, dynamics)
    call set_arithmetics(mechanism, plan, dynamics)
  end subroutine make_dynamics_plan

  !> Bodies with mass or inertia, moved into the frames of their links.
  subroutine find_bodies(mechanism, plan, dynamics)
    type(mechanism_type), intent(in) :: mechanism         !< the mechanism
    type(plan_type), intent(in) :: plan                   !< the plan of the mechanism
    type(dynamics_plan_type), intent(inout) :: dynamics   !< gets the bodies
    integer :: i, n

    allocate (dynamics%bodies(size(mechanism%bodies)))
    n = 0
    do i = 1, size(mechanism%bodies)
      associate (body => mechanism%bodies(i))
        if (body%link == 1 .or. .not. body%has_inertia()) cycle
        n = n + 1
        dynamics%bodies(n)%link = body%link
        dynamics%bodies(n)%frame = plan%frame_of(body%link)
        dynamics%bodies(n)%mass = body%mass
        dynamics%bodies(n)%centre = transformed(plan%link_in_frame(body%link), body%centre)
        dynamics%bodies(n)%inertia = inertia_in_axes(plan%link_in_frame(body%link)%r, body%inertia)
        dynamics%bodies(n)%is_point = .not. any(abs(body%inertia) > 0.0_wp)
      end associate
    end do
    dynamics%bodies = dynamics%bodies(:n)
  end subroutine find_bodies

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
          call add_frame(plan, s, own_column(plan, dynamics, s), dynamics)
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
      columns = united(columns, own_column(plan, dynamics, s))
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
        call add_frame(plan, s, own_column(plan, dynamics, s), dynamics)
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
  pure function own_column(plan, dynamics, s) result(columns)
    type(plan_type), intent(in) :: plan                !< the plan of the mechanism
    type(dynamics_plan_type), intent(in) :: dynamics   !< with `place_of`
    integer, intent(in) :: s                           !< number of the step
    integer, allocatable :: columns(:)   !< place of the coordinate among the independent ones; empty for none

    columns = pack([dynamics%place_of(plan%steps(s)%coordinate)], [.not. plan%steps(s)%dependent])
  end function own_column

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

  !> Frames on which a mass, a load or a closed chain of a later block depends. The columns of the other frames of a closed
  !> chain are used only while the dependent rates of its block are found.
  subroutine find_carriers(plan, dynamics)
    type(plan_type), intent(in) :: plan                   !< the plan of the mechanism
    type(dynamics_plan_type), intent(inout) :: dynamics   !< with bodies and links of loads; gets `carries`
    integer :: b, i, s, c

    allocate (dynamics%carries(0:plan%n_coordinates), source=.false.)
    do i = 1, size(dynamics%bodies)
      dynamics%carries(dynamics%bodies(i)%frame) = .true.
    end do
    do i = 1, plan%n_links
      if (dynamics%load_links(i)) dynamics%carries(plan%frame_of(i)) = .true.
    end do
    do b = size(plan%blocks), 1, -1
      associate (block => plan%blocks(b))
        do s = block%last_step, block%first_step, -1
          if (dynamics%carries(s)) dynamics%carries(plan%steps(s)%parent) = .true.
          if (size(block%unknowns) > 0 .and. plan%steps(s)%parent < block%first_step) &
            dynamics%carries(plan%steps(s)%parent) = .true.
        end do
        do c = block%first_closure, block%last_closure
          if (plan%closures(c)%target < block%first_step) dynamics%carries(plan%closures(c)%target) = .true.
        end do
      end associate
    end do
  end subroutine find_carriers

  !> The stages of articulated bodies, and whether they serve: one closed cluster on link 1 has only one matrix in any case.
  pure subroutine find_tree(plan, clusters, dynamics)
    type(plan_type), intent(in) :: plan                   !< the plan of the mechanism
    type(clusters_type), intent(in) :: clusters           !< its clusters
    type(dynamics_plan_type), intent(inout) :: dynamics   !< with the entries and the frames that carry something
    logical :: bears(0:plan%n_coordinates)
    integer :: b, i, k, s

    allocate (dynamics%closed(0:plan%n_coordinates), dynamics%carries_columns(0:plan%n_coordinates), source=.false.)
    dynamics%closed(1:) = clusters%closed
    dynamics%carries_columns(:) = dynamics%closed .and. dynamics%carries
    bears = .false.
    bears(dynamics%bodies%frame) = .true.
    bears(plan%frame_of(dynamics%loaded)) = .true.
    dynamics%stages = find_stages(plan, clusters, dynamics%place_of, bears)
    allocate (dynamics%local(size(dynamics%column)), source=1)
    do i = 1, size(dynamics%stages)
      associate (stage => dynamics%stages(i))
        if (.not. stage%closed) cycle
        do k = 1, size(stage%steps)
          call find_local(stage%places, dynamics%first(stage%steps(k)), dynamics%first(stage%steps(k) + 1) - 1, dynamics)
        end do
      end associate
    end do
    allocate (dynamics%first_closed(size(plan%blocks)))
    do b = 1, size(plan%blocks)
      do s = plan%blocks(b)%first_step, plan%blocks(b)%last_step
        if (clusters%closed(s)) exit
      end do
      dynamics%first_closed(b) = s
    end do
    dynamics%articulated = size(dynamics%stages) /= 1
    if (.not. dynamics%articulated) dynamics%articulated = .not. dynamics%stages(1)%closed
  end subroutine find_tree

  !> The clusters of a spatial mechanism that move in planes, and the frames of which the sweeps use the motion in space.
  pure subroutine find_planes(plan, dynamics)
    type(plan_type), intent(in) :: plan                   !< the plan of the mechanism
    type(dynamics_plan_type), intent(inout) :: dynamics   !< with the stages; gets their planes
    logical :: loaded(0:plan%n_coordinates)
    integer :: stage_of(0:plan%n_coordinates), i

    allocate (dynamics%arithmetic_of(size(plan%blocks)), source=1)
    allocate (dynamics%in_space(0:plan%n_coordinates), source=.true.)
    if (.not. (allocated(plan%planar%planes) .and. dynamics%articulated)) return
    loaded = .false.
    loaded(plan%frame_of(dynamics%loaded)) = .true.
    stage_of = 0
    do i = 1, size(dynamics%stages)
      associate (stage => dynamics%stages(i))
        if (.not. stage%closed) cycle
        call find_plane(plan, loaded, stage)
        if (stage%plane == 0) cycle
        stage_of(stage%steps) = i
        dynamics%in_space(stage%steps) = .false.
        dynamics%in_space(stage%frames) = .true.
      end associate
    end do
    do i = 1, size(plan%blocks)
      if (size(plan%blocks(i)%unknowns) == 0) cycle
      if (stage_of(plan%blocks(i)%unknowns(1)) > 0) dynamics%arithmetic_of(i) = 2
    end do
    do i = 1, size(dynamics%bodies)
      if (stage_of(dynamics%bodies(i)%frame) > 0) &
        call add_body(plan, dynamics%bodies(i), dynamics%stages(stage_of(dynamics%bodies(i)%frame)))
    end do
  end subroutine find_planes

  !> Add a body to those of its cluster that move in the plane only, in its planar frame, if it is one of them.
  pure subroutine add_body(plan, body, stage)
    type(plan_type), intent(in) :: plan           !< the plan of the mechanism
    type(frame_body_type), intent(in) :: body     !< the body
    type(stage_type), intent(inout) :: stage      !< the cluster
    integer :: i

    associate (to_planar => plan%planar%to_planar(:, :, body%frame))
      do i = 1, size(stage%flat)
        if (stage%flat(i) == body%frame) call add_to_plane(stage%bodies(i), body%mass, turn(to_planar, body%centre), &
                                                           inertia_in_axes(to_planar, body%inertia))
      end do
    end associate
  end subroutine add_body

  !> The arithmetics in which the equations are formed.
  subroutine set_arithmetics(mechanism, plan, dynamics)
    type(mechanism_type), intent(in) :: mechanism         !< the mechanism
    type(plan_type), intent(in) :: plan                   !< the plan of the mechanism
    type(dynamics_plan_type), intent(inout) :: dynamics   !< the plan of dynamics; gets the arithmetics

    allocate (dynamics%arithmetics(maxval([1, dynamics%arithmetic_of])))
    if (plan%planar%used) then
      allocate (dynamics%arithmetics(1)%kind, source=new_planar_dynamics(mechanism, plan, dynamics))
    else
      allocate (dynamics%arithmetics(1)%kind, source=new_spatial_dynamics(plan, dynamics))
    end if
    if (size(dynamics%arithmetics) > 1) allocate (dynamics%arithmetics(2)%kind, source=new_plane_block_dynamics(plan, dynamics))
  end subroutine set_arithmetics

  !> The places of columns among those of their cluster.
  pure subroutine find_local(places, first, last, dynamics)
    integer, intent(in) :: places(:)                      !< those of the cluster's coordinates, ascending
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
end module mech9_dynamics_plan
