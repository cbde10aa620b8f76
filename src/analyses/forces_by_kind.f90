!> The generalized forces of a motion by their kinds: gravity, loads, springs, dampers and so on, and the inertial forces.
!>
!> A generalized force is the power of the forces per unit rate of an independent coordinate. Each kind is projected by the same derivatives
!> of frames and coordinates. A load with stiffness, damping and a force of its own is divided into these, each with its law.
module mech9_forces_by_kind
  use mech9_kinds, only: wp
  use mech9_error, only: error_type
  use mech9_rotation, only: turn, cross
  use mech9_call_fault, only: call_fault_type
  use mech9_load, only: load_type
  use mech9_coordinate_load, only: coordinate_load_type
  use mech9_spring_load, only: spring_load_type
  use mech9_stop_load, only: stop_load_type
  use mech9_contact_load, only: contact_load_type
  use mech9_friction_load, only: friction_load_type
  use mech9_mechanism, only: mechanism_type
  use mech9_plan, only: plan_type
  use mech9_state, only: state_type
  use mech9_lagrange_types, only: dynamics_plan_type
  use mech9_generalized_forces, only: show_state
  use mech9_tree_forces, only: tree_forces_type, add_body, add_loads
  implicit none
  private
  public :: frame_rates_type, find_forces_by_kind, kind_names
  public :: by_gravity, by_loads, by_springs, by_dampers, by_motors, by_stops, by_contacts, by_friction, by_drives, by_inertia

  integer, parameter :: by_gravity = 1    !< weights
  integer, parameter :: by_loads = 2      !< forces and torques, also those of springs' own actuators and of users' procedures
  integer, parameter :: by_springs = 3    !< stiffness of loads
  integer, parameter :: by_dampers = 4    !< damping of loads
  integer, parameter :: by_motors = 5     !< motors
  integer, parameter :: by_stops = 6      !< stops, rigid and compliant
  integer, parameter :: by_contacts = 7   !< contacts of links
  integer, parameter :: by_friction = 8   !< friction in pairs
  integer, parameter :: by_drives = 9     !< forces of drives
  integer, parameter :: by_inertia = 10   !< inertial forces, -m a and their like
  !> The kinds by name, in the order of their numbers.
  character(len=8), parameter :: kind_names(*) = &
    [character(len=8) :: 'gravity', 'loads', 'springs', 'dampers', 'motors', 'stops', 'contacts', 'friction', 'drives', 'inertia']

  !> Derivatives of coordinates and frames by the independent coordinates, in the axes of frame 0.
  type :: frame_rates_type
    real(wp), allocatable :: q(:, :)          !< (M,n) coordinates
    real(wp), allocatable :: turn(:, :, :)    !< (3,0:M,n) rotation of each frame
    real(wp), allocatable :: shift(:, :, :)   !< (3,0:M,n) shift of its origin
  end type frame_rates_type

contains

  !> Find the generalized forces of all kinds but drives, which are left zero. Fails where a load has no value.
  subroutine find_forces_by_kind(mechanism, plan, dynamics, state, rates, tree, forces, err)
    type(mechanism_type), intent(in) :: mechanism        !< the mechanism
    type(plan_type), intent(in) :: plan                  !< its plan, in space
    type(dynamics_plan_type), intent(in) :: dynamics     !< its plan of dynamics
    type(state_type), intent(in) :: state                !< the motion, with that of all frames
    type(frame_rates_type), intent(in) :: rates          !< derivatives by n independent coordinates
    type(tree_forces_type), intent(inout) :: tree        !< scratch
    real(wp), intent(out) :: forces(:, :)                !< (n,kinds) [N m, N]
    type(error_type), allocatable, intent(out) :: err    !< allocated if it failed
    real(wp), parameter :: none(3) = 0.0_wp
    integer :: i, kind

    call show_state(plan, dynamics, state, tree%loads%view)
    forces = 0.0_wp
    do kind = by_loads, by_friction
      call sum_kind(mechanism, dynamics, state, kind, tree, err)
      if (allocated(err)) return
      tree%force = 0.0_wp
      tree%moment = 0.0_wp
      call add_loads(plan, dynamics, state, tree)
      forces(:, kind) = matmul(tree%loads%sum%generalized, rates%q) - power_of_frames(tree, rates)
    end do
    tree%force = 0.0_wp
    tree%moment = 0.0_wp
    do i = 1, size(dynamics%bodies)
      call add_body(dynamics%bodies(i), none, state, plan%length, tree)
    end do
    forces(:, by_inertia) = -power_of_frames(tree, rates)
    tree%force = 0.0_wp
    tree%moment = 0.0_wp
    do i = 1, size(dynamics%bodies)
      associate (body => dynamics%bodies(i), f => dynamics%bodies(i)%frame)
        tree%force(:, f) = tree%force(:, f) + body%mass*dynamics%gravity
        tree%moment(:, f) = tree%moment(:, f) + cross(turn(state%r(:, :, f), body%centre), body%mass*dynamics%gravity)
      end associate
    end do
    forces(:, by_gravity) = power_of_frames(tree, rates)
  end subroutine find_forces_by_kind

  !> The power of forces at frames per unit rate of each independent coordinate.
  pure function power_of_frames(tree, rates) result(power)
    type(tree_forces_type), intent(in) :: tree       !< with forces and moments at the frames
    type(frame_rates_type), intent(in) :: rates      !< derivatives of the frames
    real(wp) :: power(size(rates%q, 2))
    integer :: j

    do j = 1, size(power)
      power(j) = sum(tree%force*rates%shift(:, :, j)) + sum(tree%moment*rates%turn(:, :, j))
    end do
  end function power_of_frames

  !> Sum the forces of one kind on links and coordinates.
  subroutine sum_kind(mechanism, dynamics, state, kind, tree, err)
    type(mechanism_type), intent(in) :: mechanism       !< the mechanism
    type(dynamics_plan_type), intent(in) :: dynamics    !< its plan of dynamics
    type(state_type), intent(in) :: state               !< the motion
    integer, intent(in) :: kind                         !< the kind
    type(tree_forces_type), intent(inout) :: tree       !< with the motion that loads read; gets the sums
    type(error_type), allocatable, intent(out) :: err   !< allocated if a load has no value
    type(call_fault_type), target :: fault
    class(load_type), allocatable :: part
    integer :: i

    associate (sum => tree%loads%sum, view => tree%loads%view)
      call sum%clear()
      call view%note_faults_in(fault)
      do i = 1, size(dynamics%acting)
        call take_part(mechanism%loads(dynamics%acting(i))%load, kind, part)
        if (allocated(part)) call part%apply(view, sum, err)
        if (allocated(err)) exit
      end do
      call view%note_no_faults()
      if (allocated(err)) return
      if (kind == by_motors) then
        do i = 1, size(mechanism%motors)
          call mechanism%motors(i)%motor%apply(view, sum, err)
          if (allocated(err)) return
        end do
      else if (kind == by_stops .and. allocated(state%stop_force)) then
        ! forces of rigid stops are no loads
        do i = 1, size(mechanism%stops)
          if (mechanism%stops(i)%is_rigid) call sum%add_generalized(mechanism%stops(i)%coordinate, state%stop_force(i))
        end do
      end if
    end associate
  end subroutine sum_kind

  !> Take the part of a load that is of one kind.
  subroutine take_part(load, kind, part)
    class(load_type), intent(in) :: load                      !< the load
    integer, intent(in) :: kind                               !< the kind
    class(load_type), allocatable, intent(out) :: part        !< the load with the numbers of this kind alone; not allocated: it has none
    integer :: whole

    whole = by_loads
    select type (load)
    class is (coordinate_load_type)
      whole = 0
      if (kind == by_loads .or. kind == by_springs .or. kind == by_dampers) whole = kind
    class is (spring_load_type)
      whole = 0
      if (kind == by_springs .or. kind == by_dampers) whole = kind
    class is (stop_load_type)
      whole = by_stops
    class is (contact_load_type)
      whole = by_contacts
    class is (friction_load_type)
      whole = by_friction
    end select
    if (whole /= kind) return
    allocate (part, source=load)
    select type (part)
    class is (coordinate_load_type)
      if (kind /= by_springs) part%stiffness = 0.0_wp
      if (kind /= by_dampers) part%damping = 0.0_wp
      if (kind /= by_loads) part%force = 0.0_wp
    class is (spring_load_type)
      if (kind /= by_springs) part%stiffness = 0.0_wp
      if (kind /= by_dampers) part%damping = 0.0_wp
    end select
  end subroutine take_part
end module mech9_forces_by_kind
