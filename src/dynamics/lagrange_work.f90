!> Scratch and results of one evaluation of Lagrange's equations.
module mech9_lagrange_work
  use mech9_kinds, only: wp
  use mech9_motion_view, only: motion_view_type
  use mech9_force_sum, only: force_sum_type, new_force_sum
  use mech9_plan, only: plan_type
  use mech9_block_solver, only: block_work_type, new_block_work
  use mech9_dynamics_plan, only: dynamics_plan_type
  use mech9_jacobian, only: jacobian_type, new_jacobian
  use mech9_expectation, only: expectation_type
  use mech9_articulated_bodies, only: articulated_work_type, new_articulated_work
  use mech9_planar_articulated, only: planar_work_type, new_planar_work
  implicit none
  private
  public :: lagrange_work_type, new_lagrange_work

  !> Sized once.
  type :: lagrange_work_type
    type(block_work_type), allocatable :: blocks(:)
    real(wp), allocatable :: sides(:, :)             !< right-hand sides for B; room for any block
    type(jacobian_type) :: jacobian
    !> What rates and accelerations are expected to be, by continuation from before: B, entry by entry, and
    !> the accelerations that rates alone give. They only count beside noise; zero will do.
    type(expectation_type) :: expectation
    logical :: expects = .false.                     !< the two below are those of this evaluation
    real(wp), allocatable :: expected_b(:)
    real(wp), allocatable :: expected_ddq(:)
    !> Of find_equations, and of find_motion where the plan does without articulated bodies.
    real(wp), allocatable :: coefficients(:, :)      !< a_pr, lower triangle
    real(wp), allocatable :: factors(:, :)
    real(wp), allocatable :: velocity_terms(:)       !< h_p
    real(wp), allocatable :: forces(:)               !< Q_p
    real(wp), allocatable :: accelerations(:)        !< of the independent coordinates
    type(motion_view_type) :: view
    type(force_sum_type) :: sum
    type(articulated_work_type) :: articulated       !< of open chains, or in the plane:
    type(planar_work_type) :: planar
  end type lagrange_work_type

contains

  !> Scratch for a mechanism with this plan.
  function new_lagrange_work(plan, dynamics) result(work)
    type(plan_type), intent(in) :: plan   !< the plan of the mechanism
    type(dynamics_plan_type), intent(in) :: dynamics
    type(lagrange_work_type) :: work
    integer :: b, n

    n = size(plan%independent)
    allocate (work%blocks(size(plan%blocks)))
    do b = 1, size(plan%blocks)
      work%blocks(b) = new_block_work(plan%blocks(b))
    end do
    allocate (work%sides(maxval([0, plan%blocks%equations]), n), source=0.0_wp)
    work%jacobian = new_jacobian(plan, dynamics)
    allocate (work%expected_b(size(dynamics%column)), work%expected_ddq(plan%n_coordinates), source=0.0_wp)
    allocate (work%coefficients(n, n), work%factors(n, n), source=0.0_wp)
    allocate (work%velocity_terms(n), work%forces(n), work%accelerations(n), source=0.0_wp)
    allocate (work%view%links(plan%n_links))
    allocate (work%view%q(plan%n_coordinates), work%view%dq(plan%n_coordinates), source=0.0_wp)
    work%sum = new_force_sum(plan%n_links, plan%n_coordinates)
    if (.not. dynamics%open_chains) return
    if (plan%planar%used) then
      work%planar = new_planar_work(plan%n_coordinates)
    else
      work%articulated = new_articulated_work(plan%n_coordinates)
    end if
  end function new_lagrange_work
end module mech9_lagrange_work
