!> The plan of dynamics: which links have inertia, and on which independent coordinates each frame depends.
module mech9_dynamics_plan
  use mech9_kinds, only: wp
  use mech9_rotation, only: turn
  use mech9_pose, only: transformed
  use mech9_inertia, only: inertia_in_axes
  use mech9_mechanism, only: mechanism_type
  use mech9_plan, only: plan_type
  use mech9_clusters, only: clusters_type, find_clusters
  use mech9_tree_stages, only: stage_type, find_stages, find_plane
  use mech9_articulated_bodies, only: add_to_rigid_body
  use mech9_lagrange_types, only: dynamics_plan_type, frame_body_type
  use mech9_spatial_dynamics, only: new_spatial_dynamics
  use mech9_frame_entries, only: find_columns, find_local
  use mech9_unchanged_blocks, only: unchanged_blocks
  use mech9_planar_dynamics, only: planar_dynamics_type, begin_planar_dynamics
  use mech9_plane_block_dynamics, only: plane_block_dynamics_type, begin_plane_block_dynamics
  implicit none
  private
  public :: make_dynamics_plan

contains

  !> Make the plan of dynamics; `plan` must have its blocks. From the plan of dynamics in other independent coordinates, whose plan
  !> has the same frames, bodies and loads are taken, and the parts of blocks that have not changed.
  subroutine make_dynamics_plan(mechanism, plan, dynamics, known_plan, known)
    type(mechanism_type), intent(in) :: mechanism              !< the mechanism
    type(plan_type), intent(in) :: plan                        !< the plan of the mechanism
    type(dynamics_plan_type), intent(out) :: dynamics          !< the plan of dynamics
    type(plan_type), intent(in), optional :: known_plan        !< the plan in other independent coordinates
    type(dynamics_plan_type), intent(in), optional :: known    !< its plan of dynamics
    type(clusters_type) :: clusters
    integer :: i

    allocate (dynamics%place_of(plan%n_coordinates), source=0)
    do i = 1, size(plan%independent)
      dynamics%place_of(plan%independent(i)) = i
    end do
    dynamics%held = pack([(i, i=1, size(plan%independent))], plan%driven(plan%independent))
    if (present(known)) then
      call take_bodies(plan, known, dynamics)
    else
      dynamics%gravity = mechanism%gravity
      call find_loads(mechanism, plan, dynamics)
      call find_bodies(mechanism, plan, dynamics)
    end if
    clusters = find_clusters(plan)
    dynamics%support = clusters%base
    call find_columns(plan, clusters, dynamics)
    call find_carriers(plan, dynamics)
    call find_tree(plan, clusters, dynamics)
    call find_planes(plan, dynamics)
    if (present(known)) then
      call set_arithmetics(mechanism, plan, dynamics, unchanged_blocks(known_plan, known, plan, dynamics), known)
    else
      call set_arithmetics(mechanism, plan, dynamics, spread(.false., 1, size(plan%blocks)))
    end if
  end subroutine make_dynamics_plan

  !> Take what does not depend on the choice of independent coordinates: gravity, loads, and bodies, which stay in their frames.
  pure subroutine take_bodies(plan, known, dynamics)
    type(plan_type), intent(in) :: plan                   !< the plan of the mechanism
    type(dynamics_plan_type), intent(in) :: known         !< the plan of dynamics in other coordinates
    type(dynamics_plan_type), intent(inout) :: dynamics   !< gets them, with the numbers of the frames in the present plan

    dynamics%gravity = known%gravity
    dynamics%acting = known%acting
    dynamics%stops_alone = known%stops_alone
    dynamics%load_links = known%load_links
    dynamics%loaded = known%loaded
    dynamics%bodies = known%bodies
    dynamics%bodies%frame = plan%frame_of(dynamics%bodies%link)
  end subroutine take_bodies

  !> Loads that are not idle, and the links on which they act or whose motion they read.
  subroutine find_loads(mechanism, plan, dynamics)
    type(mechanism_type), intent(in) :: mechanism         !< the mechanism
    type(plan_type), intent(in) :: plan                   !< the plan of the mechanism
    type(dynamics_plan_type), intent(inout) :: dynamics   !< gets the loads
    integer :: i

    allocate (dynamics%load_links(plan%n_links), source=.false.)
    dynamics%acting = mechanism%acting_loads()
    dynamics%stops_alone = size(mechanism%motors) == 0 .and. &
                           all(dynamics%acting > size(mechanism%loads) - count(.not. mechanism%stops%is_rigid))
    call mechanism%mark_loaded_links(dynamics%load_links)
    dynamics%loaded = pack([(i, i=2, plan%n_links)], dynamics%load_links(2:))
  end subroutine find_loads

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
        if (stage%flat(i)%frame == body%frame) call add_to_rigid_body(stage%flat(i)%together, body%mass, &
                                                                      turn(to_planar, body%centre), &
                                                                      inertia_in_axes(to_planar, body%inertia))
      end do
    end associate
  end subroutine add_body

  !> The arithmetics in which the equations are formed.
  subroutine set_arithmetics(mechanism, plan, dynamics, unchanged, known)
    type(mechanism_type), intent(in) :: mechanism             !< the mechanism
    type(plan_type), intent(in) :: plan                       !< the plan of the mechanism
    type(dynamics_plan_type), intent(inout) :: dynamics       !< the plan of dynamics; gets the arithmetics
    logical, intent(in) :: unchanged(:)                       !< (blocks) the block is as in the plan of dynamics `known`
    type(dynamics_plan_type), intent(in), optional :: known   !< the plan of dynamics in other coordinates
    type(planar_dynamics_type), allocatable :: planar
    type(plane_block_dynamics_type), allocatable :: in_planes

    allocate (dynamics%arithmetics(maxval([1, dynamics%arithmetic_of])))
    if (plan%planar%used) then
      allocate (planar)
      call begin_planar_dynamics(mechanism, plan, dynamics, unchanged, planar, known)
      call move_alloc(planar, dynamics%arithmetics(1)%kind)
    else
      allocate (dynamics%arithmetics(1)%kind, source=new_spatial_dynamics(plan, dynamics))
    end if
    if (size(dynamics%arithmetics) == 1) return
    allocate (in_planes)
    call begin_plane_block_dynamics(plan, dynamics, unchanged, in_planes, known)
    call move_alloc(in_planes, dynamics%arithmetics(2)%kind)
  end subroutine set_arithmetics

end module mech9_dynamics_plan
