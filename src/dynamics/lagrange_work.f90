!> Scratch and results of one evaluation of Lagrange's equations.
module mech9_lagrange_work
  use mech9_kinds, only: wp
  use mech9_force_sum, only: new_force_sum
  use mech9_plan, only: plan_type
  use mech9_block_solver, only: new_block_work
  use mech9_lagrange_types, only: dynamics_plan_type, lagrange_work_type
  use mech9_cluster_bodies, only: new_cluster_work
  use mech9_jacobian, only: start_jacobian
  implicit none
  private
  public :: new_lagrange_work

contains

  !> Scratch for the evaluations of a mechanism.
  function new_lagrange_work(plan, dynamics) result(work)
    type(plan_type), intent(in) :: plan                !< the plan of the mechanism
    type(dynamics_plan_type), intent(in) :: dynamics   !< the plan of dynamics
    type(lagrange_work_type) :: work
    integer :: b, n

    n = size(plan%independent)
    allocate (work%blocks(size(plan%blocks)))
    do b = 1, size(plan%blocks)
      work%blocks(b) = new_block_work(plan%blocks(b))
    end do
    allocate (work%sides(maxval([0, plan%blocks%equations]), n), source=0.0_wp)
    call start_jacobian(plan, dynamics, work%jacobian)
    allocate (work%expected_b(size(dynamics%column)), work%expected_ddq(plan%n_coordinates), source=0.0_wp)
    allocate (work%coefficients(n, n), source=0.0_wp)
    if (.not. dynamics%articulated) allocate (work%factors(n, n), source=0.0_wp)
    allocate (work%clusters(size(dynamics%stages)))
    do b = 1, size(dynamics%stages)
      if (dynamics%articulated .and. dynamics%stages(b)%closed) &
        work%clusters(b) = new_cluster_work(merge(3, 6, plan%planar%used), size(dynamics%stages(b)%places))
    end do
    allocate (work%velocity_terms(n), work%forces(n), work%accelerations(n), source=0.0_wp)
    allocate (work%view%links(plan%n_links))
    allocate (work%view%q(plan%n_coordinates), work%view%dq(plan%n_coordinates), source=0.0_wp)
    work%sum = new_force_sum(plan%n_links, plan%n_coordinates)
    do b = 1, size(dynamics%arithmetics)
      call dynamics%arithmetics(b)%kind%make_work(plan, dynamics, work)
    end do
  end function new_lagrange_work
end module mech9_lagrange_work
