!> Plans for the search for equilibria, in space and in the order of the geometry: a search goes through better independent coordinates
!> where the present ones are near a singular position, and neither these nor the way shall depend on numbers.
module mech9_resting_plan
  use mech9_kinds, only: wp
  use mech9_error, only: error_type
  use mech9_mechanism, only: mechanism_type
  use mech9_partition, only: partition_type
  use mech9_plan, only: plan_type
  use mech9_state, only: state_type
  use mech9_geometric_order, only: order_by_geometry
  use mech9_planning, only: planning_settings_type, make_plan
  implicit none
  private
  public :: plan_by_geometry

contains

  !> Make the plan for a closed position. Fails as make_plan does.
  subroutine plan_by_geometry(mechanism, partition, present_plan, q, plan, position, err)
    type(mechanism_type), intent(in) :: mechanism       !< the mechanism
    type(partition_type), intent(in) :: partition       !< driven, free and dependent coordinates
    type(plan_type), intent(in), target :: present_plan !< another plan of it, for size and properties of loops
    real(wp), intent(in) :: q(:)                        !< (M) closed position [rad, m]
    type(plan_type), intent(out) :: plan                !< the plan
    type(state_type), intent(out) :: position           !< the closed position
    type(error_type), allocatable, intent(out) :: err   !< allocated if it failed
    type(partition_type) :: ordered
    type(planning_settings_type) :: settings

    call order_by_geometry(mechanism, partition, present_plan, q, ordered)
    settings%in_space = .true.
    settings%known => present_plan
    call make_plan(mechanism, ordered, q, plan, position, err, settings)
  end subroutine plan_by_geometry
end module mech9_resting_plan
