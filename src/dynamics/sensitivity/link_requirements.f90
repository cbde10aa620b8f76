!> Wrenches that the links of a motion require from their pairs, and the forces of its couplings, with the exact derivatives by all
!> parameters.
module mech9_link_requirements
  use mech9_kinds, only: wp
  use mech9_model, only: model_type
  use mech9_plan, only: plan_type
  use mech9_state, only: state_type
  use mech9_coupling_constraint, only: bent_force
  use mech9_loop_forces, only: loop_forces_type, coupling_force, coupling_multiplier
  use mech9_varied_motion, only: varied_motion_type
  implicit none
  private
  public :: link_requirements_type, vary_coupling_numbers, keep_couplings, add_couplings

  !> The wrenches that links require, and the forces of couplings, with their derivatives. Wrenches are moment, then force, about the
  !> origin of frame 0.
  type :: link_requirements_type
    real(wp), allocatable :: wrench(:, :)          !< (6,N) that each link requires from its pairs [N m, N]
    real(wp), allocatable :: wrenches(:, :, :)     !< (P,6,N) derivatives
    real(wp), allocatable :: along(:)              !< (M) loads on the coordinates, with the forces of couplings [N m, N]
    real(wp), allocatable :: alongs(:, :)          !< (P,M) derivatives
    !> (M) largest of the loads and forces of couplings whose sum acts on a coordinate; the sum has its round-off [N m, N]
    real(wp), allocatable :: largest(:)
    real(wp), allocatable :: largest_changes(:, :) !< (P,M) the same of the derivatives
    real(wp), allocatable :: coupling(:, :)        !< (P,couplings) derivatives of the force of each on its second coordinate
  end type link_requirements_type

contains

  !> Keep the derivatives of the forces of couplings by one parameter.
  subroutine keep_couplings(model, motion, p, held, loops, self)
    type(model_type), intent(in) :: model                  !< the model
    type(varied_motion_type), intent(in) :: motion         !< derivatives of the motion
    integer, intent(in) :: p                               !< number of the parameter
    type(loop_forces_type), intent(in) :: held             !< with the multipliers of the motion
    type(loop_forces_type), intent(in) :: loops            !< with their derivatives
    type(link_requirements_type), intent(inout) :: self    !< gets the derivatives of the forces
    real(wp) :: forces(motion%plan%n_coordinates)
    integer :: b, c, i, k

    associate (plan => motion%plan)
      do b = 1, size(plan%blocks)
        do c = plan%blocks(b)%first_closure, plan%blocks(b)%last_closure
          if (plan%closures(c)%coupling == 0) cycle
          associate (number => plan%closures(c)%coupling, multiplier => coupling_multiplier(plan, b, c, held), &
                     coordinates => plan%couplings(plan%closures(c)%coupling)%coupling%coordinates)
            forces = 0.0_wp
            call bent_force(plan, c, motion%state, multiplier, motion%q(p, 0, :), forces)
            call vary_own_numbers(model, plan, motion, c, p, multiplier, forces)
            do i = 1, size(coordinates)
              k = coordinates(i)
              forces(k) = forces(k) + coupling_force(plan, c, k, motion%state, coupling_multiplier(plan, b, c, loops))
              self%largest_changes(p, k) = max(self%largest_changes(p, k), abs(self%alongs(p, k)), abs(forces(k)))
              self%alongs(p, k) = self%alongs(p, k) + forces(k)
            end do
            self%coupling(p, number) = forces(coordinates(2))
          end associate
        end do
      end do
    end associate
  end subroutine keep_couplings

  !> Add the forces of couplings to the loads on the coordinates.
  subroutine add_couplings(plan, state, held, self)
    type(plan_type), intent(in) :: plan                    !< the plan of the mechanism, in space
    type(state_type), intent(in) :: state                  !< the motion
    type(loop_forces_type), intent(in) :: held             !< with the multipliers of the motion
    type(link_requirements_type), intent(inout) :: self    !< gets the forces
    real(wp) :: force
    integer :: b, c, i, k

    do b = 1, size(plan%blocks)
      do c = plan%blocks(b)%first_closure, plan%blocks(b)%last_closure
        if (plan%closures(c)%coupling == 0) cycle
        associate (coordinates => plan%couplings(plan%closures(c)%coupling)%coupling%coordinates)
          do i = 1, size(coordinates)
            k = coordinates(i)
            force = coupling_force(plan, c, k, state, coupling_multiplier(plan, b, c, held))
            self%largest(k) = max(self%largest(k), abs(self%along(k)), abs(force))
            self%along(k) = self%along(k) + force
          end do
        end associate
      end do
    end do
  end subroutine add_couplings

  !> Subtract the changes of the forces of couplings with their own numbers, by one parameter.
  subroutine vary_coupling_numbers(model, plan, motion, loops, p, forces)
    type(model_type), intent(in) :: model               !< the model
    type(plan_type), intent(in) :: plan                 !< the plan of the mechanism, in space
    type(varied_motion_type), intent(in) :: motion      !< derivatives of the motion
    type(loop_forces_type), intent(in) :: loops         !< with the multipliers of the motion
    integer, intent(in) :: p                            !< number of the parameter
    real(wp), intent(inout) :: forces(:)                !< (M) derivatives of the forces on the coordinates
    integer :: b, c

    do b = 1, size(plan%blocks)
      do c = plan%blocks(b)%first_closure, plan%blocks(b)%last_closure
        if (plan%closures(c)%coupling > 0) &
          call vary_own_numbers(model, plan, motion, c, p, -coupling_multiplier(plan, b, c, loops), forces)
      end do
    end do
  end subroutine vary_coupling_numbers

  !> Add the change of the force of a coupling with its own numbers, by one parameter.
  subroutine vary_own_numbers(model, plan, motion, c, p, multiplier, forces)
    type(model_type), intent(in) :: model               !< the model
    type(plan_type), intent(in) :: plan                 !< the plan of the mechanism, in space
    type(varied_motion_type), intent(in) :: motion      !< derivatives of the motion
    integer, intent(in) :: c                            !< number of the closure that is the coupling
    integer, intent(in) :: p                            !< number of the parameter
    real(wp), intent(in) :: multiplier                  !< of the weighed equation
    real(wp), intent(inout) :: forces(:)                !< (M) derivatives of the forces on the coordinates
    integer :: i, k

    associate (coupling => model%mechanism%couplings(plan%closures(c)%coupling)%coupling, &
               part => motion%tangents(p)%couplings(plan%closures(c)%coupling))
      if (.not. part%varies) return
      do i = 1, size(coupling%coordinates)
        k = coupling%coordinates(i)
        forces(k) = forces(k) + plan%closures(c)%weight*multiplier*coupling%varied_term(part%change, i, motion%state%q(k), 1)
      end do
    end associate
  end subroutine vary_own_numbers
end module mech9_link_requirements
