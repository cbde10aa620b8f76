!> The forces that a motion requires along the independent coordinates, and their exact derivatives by positions, rates and
!> accelerations of these coordinates: stiffness, damping and inertia of the linearised equations of motion.
!>
!> With the forces f that a motion requires beyond its loads, f(q, dq, ddq) = 0 are the equations of motion in the independent
!> coordinates. The derivatives hold the forces of closed chains and vary all else: B^T J = 0 for the rates B of all coordinates
!> per rate of an independent one, so that the changes of B enter only through these forces.
module mech9_linearisation
  use mech9_kinds, only: wp
  use mech9_error, only: error_type
  use mech9_mechanism, only: mechanism_type
  use mech9_plan, only: plan_type
  use mech9_state, only: state_type
  use mech9_block_solver, only: solve_rates, solve_accelerations
  use mech9_lagrange_types, only: dynamics_plan_type
  use mech9_dynamics_plan, only: make_dynamics_plan
  use mech9_variation, only: variation_type, new_variation
  use mech9_motion_variation, only: motion_variation_work_type, new_motion_variation_work, factorize_chains, &
    prepare_variations, vary_motion
  use mech9_tree_forces, only: tree_forces_type, new_tree_forces, find_tree_forces, vary_tree_forces, loop_wrench_type
  use mech9_loop_forces, only: loop_forces_type, new_loop_forces, eliminate_dependent, loop_wrenches, &
    vary_couplings
  implicit none
  private
  public :: linearisation_type, new_linearisation, find_forces, vary_forces, find_matrix
  public :: by_position, by_rate, by_acceleration

  integer, parameter :: by_position = 0       !< the parameter is an independent coordinate
  integer, parameter :: by_rate = 1           !< it is the rate of one
  integer, parameter :: by_acceleration = 2   !< it is the acceleration of one

  !> Plan of dynamics, scratch, and the forces at one motion.
  type :: linearisation_type
    type(dynamics_plan_type) :: dynamics
    type(motion_variation_work_type) :: motion
    type(tree_forces_type) :: tree
    type(loop_forces_type) :: loops         !< forces of the equations of blocks
    type(loop_forces_type) :: loops_held    !< those of the motion, while `loops` serves its variations
    type(loop_wrench_type), allocatable :: wrenches(:)   !< (closures) forces of the closed chains
    type(variation_type) :: variation                    !< by the last parameter
    real(wp), allocatable :: forces(:)    !< (M) required along the independent coordinates; zero for others [N m, N]
    real(wp), allocatable :: change(:)    !< (M) their derivatives by the last parameter
  end type linearisation_type

contains

  !> Room for the derivatives of a mechanism.
  subroutine new_linearisation(mechanism, plan, linearisation)
    type(mechanism_type), intent(in) :: mechanism             !< the mechanism
    type(plan_type), intent(in) :: plan                       !< its plan, in space
    type(linearisation_type), intent(out) :: linearisation    !< gets its room

    call make_dynamics_plan(mechanism, plan, linearisation%dynamics)
    linearisation%motion = new_motion_variation_work(plan)
    call new_tree_forces(plan, linearisation%dynamics, linearisation%tree)
    linearisation%loops = new_loop_forces(plan)
    linearisation%variation = new_variation(plan)
    allocate (linearisation%wrenches(size(plan%closures)))
    allocate (linearisation%forces(plan%n_coordinates), linearisation%change(plan%n_coordinates), source=0.0_wp)
  end subroutine new_linearisation

  !> The forces that a motion requires, and all that its variations have in common. The frames must be in place, and the
  !> rates and accelerations of the independent coordinates be set; the others are found. Fails where a load or a pair does.
  subroutine find_forces(mechanism, plan, state, self, err)
    type(mechanism_type), intent(in) :: mechanism       !< the mechanism
    type(plan_type), intent(in) :: plan                 !< its plan, in space
    type(state_type), intent(inout) :: state            !< the motion; gets that of dependent coordinates and of frames
    type(linearisation_type), intent(inout) :: self     !< gets the forces
    type(error_type), allocatable, intent(out) :: err   !< allocated if it failed
    integer :: b

    call factorize_chains(plan, state, self%motion)
    do b = 1, size(plan%blocks)
      call solve_rates(plan, plan%blocks(b), state, self%motion%blocks(b))
    end do
    do b = 1, size(plan%blocks)
      call solve_accelerations(plan, plan%blocks(b), state, self%motion%blocks(b))
    end do
    call prepare_variations(plan, state, self%motion, err)
    if (allocated(err)) return
    call find_tree_forces(mechanism, plan, self%dynamics, state, self%tree, err)
    if (allocated(err)) return
    self%forces = self%tree%required
    call eliminate_dependent(plan, state, self%motion%blocks, self%loops, self%forces)
    self%loops_held = self%loops
    call loop_wrenches(plan, state, self%loops, self%wrenches)
    call find_tree_forces(mechanism, plan, self%dynamics, state, self%tree, err, self%wrenches)
  end subroutine find_forces

  !> The derivatives of the forces by the parameter of `variation`, whose independent coordinates, rates and accelerations are
  !> set. To be called after find_forces for this motion. Fails where a load does.
  subroutine vary_forces(mechanism, plan, state, self, err)
    type(mechanism_type), intent(in) :: mechanism       !< the mechanism
    type(plan_type), intent(in) :: plan                 !< its plan, in space
    type(state_type), intent(in) :: state               !< the motion
    type(linearisation_type), intent(inout) :: self     !< with `variation`; gets `change`
    type(error_type), allocatable, intent(out) :: err   !< allocated if it failed

    call vary_motion(plan, state, self%motion, self%variation)
    call vary_tree_forces(mechanism, plan, self%dynamics, state, self%variation, self%tree, err, self%wrenches)
    if (allocated(err)) return
    self%change = self%tree%required_change
    call vary_couplings(plan, state, self%loops_held, self%variation%q, self%change)
    call eliminate_dependent(plan, state, self%motion%blocks, self%loops, self%change)
  end subroutine vary_forces

  !> Derivatives of the forces of some independent coordinates by these coordinates, by their rates, or by their accelerations.
  !> Forces and coordinates count in units of the plan (rad, or lengths of the mechanism), so that all derivatives are energies.
  subroutine find_matrix(mechanism, plan, state, by, coordinates, self, matrix, magnitude, err)
    type(mechanism_type), intent(in) :: mechanism       !< the mechanism
    type(plan_type), intent(in) :: plan                 !< its plan, in space
    type(state_type), intent(in) :: state               !< the motion
    integer, intent(in) :: by                           !< by_position, by_rate or by_acceleration
    integer, intent(in) :: coordinates(:)               !< (n) numbers of independent coordinates
    type(linearisation_type), intent(inout) :: self     !< with the forces at this motion
    real(wp), intent(out) :: matrix(:, :)               !< (n,n) derivatives, a column for each coordinate [J, J s, J s^2]
    real(wp), intent(out) :: magnitude                  !< largest sum of magnitudes of all terms of a column [J, J s, J s^2]
    type(error_type), allocatable, intent(out) :: err   !< allocated if it failed
    integer :: j, k

    magnitude = 0.0_wp
    do j = 1, size(coordinates)
      k = coordinates(j)
      call self%variation%clear()
      select case (by)
      case (by_position)
        self%variation%q(k) = plan%unit_of(k)
      case (by_rate)
        self%variation%dq(k) = plan%unit_of(k)
      case default
        self%variation%ddq(k) = plan%unit_of(k)
      end select
      call vary_forces(mechanism, plan, state, self, err)
      if (allocated(err)) return
      matrix(:, j) = self%change(coordinates)*plan%unit_of(coordinates)
      magnitude = max(magnitude, self%tree%magnitude_change)
    end do
  end subroutine find_matrix
end module mech9_linearisation
