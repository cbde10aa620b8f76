!> Coordinates that rigid stops and sticking pairs hold like drives, and the forces of these stops.
module mech9_stop_forces
  use mech9_kinds, only: wp
  use mech9_error, only: error_type
  use mech9_mechanism, only: mechanism_type
  use mech9_plan, only: plan_type
  use mech9_state, only: state_type
  use mech9_lagrange_types, only: dynamics_plan_type, lagrange_work_type
  use mech9_lagrange, only: find_equations, complete_accelerations
  implicit none
  private
  public :: held_coordinate_type, find_stop_forces

  !> A coordinate that a rigid stop or friction holds.
  type :: held_coordinate_type
    integer :: stop = 0                  !< number of the stop; 0: friction holds it
    integer :: coordinate = 0            !< number of the coordinate, which is driven
    real(wp) :: size_of_terms = 0.0_wp   !< sum of the terms of its force, by which round-off is judged [N m, N]
  end type held_coordinate_type

contains

  !> Find the forces at a state whose whole motion is known: what the equations of motion leave for the held coordinates.
  subroutine find_stop_forces(mechanism, plan, dynamics, held, state, work, err)
    type(mechanism_type), intent(in) :: mechanism         !< the mechanism
    type(plan_type), intent(in) :: plan                   !< its plan
    type(dynamics_plan_type), intent(in) :: dynamics      !< its plan of dynamics
    type(held_coordinate_type), intent(inout) :: held(:)        !< the coordinates; get the size of terms
    type(state_type), intent(inout) :: state              !< the state, with all accelerations; gets the forces
    type(lagrange_work_type), intent(inout) :: work       !< with the accelerations of the independent coordinates
    type(error_type), allocatable, intent(out) :: err     !< allocated if a load fails
    real(wp) :: terms(size(plan%independent) + 2)
    integer :: i, j, p

    if (.not. allocated(state%stop_force)) allocate (state%stop_force(size(mechanism%stops)))
    state%stop_force = 0.0_wp
    if (dynamics%articulated) then
      ! articulated bodies give accelerations without the equations
      call find_equations(mechanism, plan, dynamics, state, work, err)
      if (allocated(err)) return
      call complete_accelerations(plan, dynamics, work, state)
    end if
    do i = 1, size(held)
      if (held(i)%stop == 0) cycle
      p = dynamics%place_of(held(i)%coordinate)
      do j = 1, size(plan%independent)
        terms(j) = work%coefficients(max(p, j), min(p, j))*work%accelerations(j)
      end do
      terms(size(terms) - 1:) = [work%velocity_terms(p), -work%forces(p)]
      state%stop_force(held(i)%stop) = sum(terms)
      held(i)%size_of_terms = sum(abs(terms))
    end do
  end subroutine find_stop_forces
end module mech9_stop_forces
