!> Forces and torques that loads exert, and the generalized forces Q_p (25) that result from them.
module mech9_generalized_forces
  use mech9_kinds, only: wp
  use mech9_error, only: error_type
  use mech9_mechanism, only: mechanism_type
  use mech9_call_fault, only: call_fault_type
  use mech9_motion_view, only: motion_view_type
  use mech9_force_sum, only: force_sum_type
  use mech9_plan, only: plan_type
  use mech9_state, only: state_type
  use mech9_lagrange_types, only: dynamics_plan_type, lagrange_work_type
  use mech9_frame_motion, only: link_motion
  implicit none
  private
  public :: collect_loads, sum_forces, sum_loads, collect_forces, add_generalized, show_state, show_links

contains

  !> Collect the forces and torques of the loads on links, and the generalized forces of loads and motors on coordinates, in work%sum.
  subroutine collect_loads(mechanism, plan, dynamics, state, work, err)
    type(mechanism_type), intent(in) :: mechanism       !< the mechanism
    type(plan_type), intent(in) :: plan                 !< the plan of the mechanism
    type(dynamics_plan_type), intent(in) :: dynamics    !< the plan of dynamics
    type(state_type), intent(in) :: state               !< position and motion of the mechanism
    type(lagrange_work_type), intent(inout) :: work     !< gets the loads' sums and the motion that they read
    type(error_type), allocatable, intent(out) :: err   !< allocated if a load failed

    if (size(dynamics%acting) == 0 .and. size(mechanism%motors) == 0) return
    if (dynamics%stops_alone .and. allocated(state%pressed)) then
      if (.not. any(state%pressed)) then
        if (work%sum%any_generalized) call work%sum%clear()
        return
      end if
    end if
    call sum_forces(mechanism, plan, dynamics%acting, dynamics%loaded, state, work%view, work%sum, err)
  end subroutine collect_loads

  !> The sums of loads and of all motors on links and coordinates, from the motion that they read.
  subroutine sum_forces(mechanism, plan, acting, loaded, state, view, sum, err)
    type(mechanism_type), intent(in) :: mechanism       !< the mechanism
    type(plan_type), intent(in) :: plan                 !< the plan of the mechanism
    integer, intent(in) :: acting(:)                    !< numbers of the loads
    integer, intent(in) :: loaded(:)                    !< links on whose motion they depend
    type(state_type), intent(in) :: state               !< position and motion of the mechanism
    type(motion_view_type), intent(inout) :: view       !< gets the motion that loads and motors read
    type(force_sum_type), intent(inout) :: sum          !< gets the sums
    type(error_type), allocatable, intent(out) :: err   !< allocated if a load or a motor failed
    integer :: i

    call sum_loads(mechanism, plan, acting, loaded, state, view, sum, err)
    do i = 1, size(mechanism%motors)
      if (allocated(err)) return
      call mechanism%motors(i)%motor%apply(view, sum, err)
    end do
  end subroutine sum_forces

  !> The sums of loads on links and coordinates, from the motion that they read.
  subroutine sum_loads(mechanism, plan, acting, loaded, state, view, sum, err)
    type(mechanism_type), intent(in) :: mechanism       !< the mechanism
    type(plan_type), intent(in) :: plan                 !< the plan of the mechanism
    integer, intent(in) :: acting(:)                    !< numbers of the loads
    integer, intent(in) :: loaded(:)                    !< links on whose motion they depend
    type(state_type), intent(in) :: state               !< position and motion of the mechanism
    type(motion_view_type), intent(inout) :: view       !< gets the motion that the loads read
    type(force_sum_type), intent(inout) :: sum          !< gets the sums
    type(error_type), allocatable, intent(out) :: err   !< allocated if a load failed
    type(call_fault_type), target :: fault
    integer :: i

    call show_links(plan, loaded, state, view)
    call sum%clear()
    call view%note_faults_in(fault)
    do i = 1, size(acting)
      call mechanism%loads(acting(i))%load%apply(view, sum, err)
      if (allocated(err)) exit
    end do
    call view%note_no_faults()
  end subroutine sum_loads

  !> Add the generalized forces Q_p (25) of the loads on links to work%forces, for one cluster on link 1.
  pure subroutine collect_forces(plan, dynamics, state, work)
    type(plan_type), intent(in) :: plan                !< the plan of the mechanism
    type(dynamics_plan_type), intent(in) :: dynamics   !< the plan of dynamics
    type(state_type), intent(in) :: state              !< position and motion of the mechanism
    type(lagrange_work_type), intent(inout) :: work    !< with the loads' sums and the Jacobian; gets `forces`
    integer :: i

    do i = 1, size(dynamics%loaded)
      call dynamics%arithmetics(1)%kind%add_link_force(plan, dynamics, state, dynamics%loaded(i), work)
    end do
  end subroutine collect_forces

  !> Add the generalized forces of the loads on coordinates to work%forces.
  pure subroutine add_generalized(plan, dynamics, work)
    type(plan_type), intent(in) :: plan                !< the plan of the mechanism
    type(dynamics_plan_type), intent(in) :: dynamics   !< the plan of dynamics
    type(lagrange_work_type), intent(inout) :: work    !< with the loads' sums and the Jacobian; gets `forces`
    integer :: i, e, p, s

    if (.not. work%sum%any_generalized) return
    do i = 1, plan%n_coordinates
      if (.not. abs(work%sum%generalized(i)) > 0.0_wp) cycle
      s = plan%step_of(i)
      do e = dynamics%first(s), dynamics%first(s + 1) - 1
        p = dynamics%column(e)
        work%forces(p) = work%forces(p) + work%jacobian%b(e)*work%sum%generalized(i)
      end do
    end do
  end subroutine add_generalized

  !> The state as loads read it: coordinates, and the motion of the links' own systems in that of link 1.
  pure subroutine show_state(plan, dynamics, state, view)
    type(plan_type), intent(in) :: plan                !< the plan of the mechanism
    type(dynamics_plan_type), intent(in) :: dynamics   !< the plan of dynamics
    type(state_type), intent(in) :: state              !< position and motion of the mechanism
    type(motion_view_type), intent(inout) :: view      !< gets time, coordinates and the links on which loads depend

    call show_links(plan, dynamics%loaded, state, view)
  end subroutine show_state

  !> The time, all coordinates and the motion of some links as loads read them.
  pure subroutine show_links(plan, links, state, view)
    type(plan_type), intent(in) :: plan             !< the plan of the mechanism
    integer, intent(in) :: links(:)                 !< numbers of the links
    type(state_type), intent(in) :: state           !< position and motion of the mechanism
    type(motion_view_type), intent(inout) :: view   !< gets time, coordinates and these links
    integer :: i, k

    view%t = state%t
    if (allocated(state%motor)) then
      view%motor = state%motor
      view%limited = state%limited
    else if (allocated(view%motor)) then
      deallocate (view%motor, view%limited)
    end if
    if (allocated(state%pressed)) then
      view%pressed = state%pressed
    else if (allocated(view%pressed)) then
      deallocate (view%pressed)
    end if
    if (allocated(state%friction)) then
      view%friction = state%friction
    else if (allocated(view%friction)) then
      deallocate (view%friction)
    end if
    if (allocated(state%contact_force)) then
      view%contact_force = state%contact_force
    else if (allocated(view%contact_force)) then
      deallocate (view%contact_force)
    end if
    if (allocated(state%stretch)) then
      view%stretch = state%stretch
    else if (allocated(view%stretch)) then
      deallocate (view%stretch)
    end if
    do i = 1, plan%n_coordinates
      view%q(i) = state%q(i)
      view%dq(i) = state%dq(i)
    end do
    do i = 1, size(links)
      k = links(i)
      call link_motion(plan, state, k, view%links(k)%r, view%links(k)%p, view%links(k)%omega, view%links(k)%v)
    end do
  end subroutine show_links
end module mech9_generalized_forces
