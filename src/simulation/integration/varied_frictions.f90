!> The derivatives of frictions by parameters, in a motion whose variational equations are integrated.
!>
!> A pair that slips has f = -s mu b(w), with the bearing load b of its wrench w, which is linear in the forces of all frictions. With the
!> derivatives of the wrenches under frictions that are held, w0', those of the forces satisfy f' = -s (mu' b + mu (b_w (w0' + W f') + b')),
!> where W are the wrenches by the forces, and b' the derivative of b by its own numbers. Pairs that stick have no acceleration.
!> Contacts of links that act follow: w0' contains their derivatives under frictions that are held, W what frictions change of their forces.
module mech9_varied_frictions
  use mech9_kinds, only: wp
  use mech9_error, only: error_type, raise, exit_singular
  use mech9_integration_failures, only: failure_no_friction
  use mech9_lapack, only: dgetrf, dgetrs
  use mech9_rotation, only: cross, combine, turn_back
  use mech9_frame_motion, only: link_motion
  use mech9_model, only: model_type
  use mech9_plan, only: plan_type
  use mech9_state, only: state_type
  use mech9_friction, only: friction_type, bearing_terms
  use mech9_tangent, only: tangent_type
  use mech9_varied_motion, only: varied_motion_type
  use mech9_varied_forces, only: varied_forces_type, new_varied_forces, find_varied_forces
  use mech9_varied_reactions, only: varied_reactions_type, new_varied_reactions, find_varied_reactions
  use mech9_motion_sensitivity, only: motion_sensitivity_type
  use mech9_friction_motion, only: friction_motion_type
  implicit none
  private
  public :: varied_frictions_type, find_varied_frictions, vary_use

  !> Scratch for the derivatives: required forces, and reactions.
  type :: varied_frictions_type
    private
    logical :: is_ready = .false.
    type(varied_forces_type) :: forces
    type(varied_reactions_type) :: reactions
  end type varied_frictions_type

contains

  !> Find the derivatives of the frictions in the present motion, after those of the accelerations with frictions held; these accelerations
  !> get what the frictions add. Fails where wrenches have no derivatives.
  subroutine find_varied_frictions(model, plan, state, friction, sensitivity, self, err)
    type(model_type), intent(in) :: model                            !< the model
    type(plan_type), intent(in) :: plan                              !< its plan
    type(state_type), intent(in) :: state                            !< the motion, with all accelerations
    class(friction_motion_type), intent(in) :: friction              !< the frictions, solved in this motion
    type(motion_sensitivity_type), intent(inout) :: sensitivity      !< the derivatives
    type(varied_frictions_type), intent(inout) :: self               !< scratch
    type(error_type), allocatable, intent(out) :: err                !< allocated if it failed
    real(wp) :: forces(size(model%mechanism%frictions), sensitivity%motion%n_parameters)
    integer :: i, n, p

    n = size(model%mechanism%frictions)
    associate (motion => sensitivity%motion)
      if (.not. allocated(motion%friction)) allocate (motion%friction(motion%n_parameters, n))
      motion%friction = 0.0_wp
      call sensitivity%complete(model, state, err)
      if (.not. (self%is_ready .or. allocated(err))) then
        call new_varied_forces(model, motion, self%forces, .true.)
        call new_varied_reactions(model, motion, self%reactions, err)
        self%is_ready = .not. allocated(err)
      end if
      if (.not. allocated(err)) call find_varied_forces(model, motion, self%forces, err)
      if (.not. allocated(err)) call find_varied_reactions(model, motion, self%forces%links, self%reactions, err)
      if (.not. allocated(err)) call find_forces(model, plan, state, friction, motion, self, forces, err)
      if (allocated(err)) return
      motion%friction = transpose(forces)
      do p = 1, motion%n_parameters
        do i = 1, size(plan%free)
          sensitivity%values(p, i, 2) = sensitivity%values(p, i, 2) + dot_product(friction%by_force(plan%free_places(i), :), &
                                                                                 forces(:, p))
        end do
      end do
      call add_to_contacts(friction, forces, motion)
      ! a coordinate that is held needs the force that its stuck pair gives
      do i = 1, n
        if (friction%modes%group(i) == 0) cycle
        associate (k => model%mechanism%frictions(i)%coordinate)
          if (plan%driven(k)) motion%friction(:, i) = motion%friction(:, i) + self%forces%changes(:, k)
        end associate
      end do
    end associate
  end subroutine find_varied_frictions

  !> Add to the derivatives of the forces of contacts what those of frictions change of them.
  pure subroutine add_to_contacts(friction, forces, motion)
    class(friction_motion_type), intent(in) :: friction        !< the frictions, solved in this motion
    real(wp), intent(in) :: forces(:, :)                       !< (frictions,P) the derivatives of frictions
    type(varied_motion_type), intent(inout) :: motion          !< with the derivatives of contacts, frictions held
    integer :: i, k, p

    if (.not. friction%touches) return
    associate (touching => friction%touching)
      do i = 1, size(touching%acting)
        k = touching%acting(i)
        do p = 1, size(forces, 2)
          motion%contact(p, 3*k - 2:3*k) = motion%contact(p, 3*k - 2:3*k) &
                                           + matmul(touching%axes(:, :, i), matmul(friction%pressed(:, k, 1:), forces(:, p)))
        end do
      end do
    end associate
  end subroutine add_to_contacts

  !> The derivatives of the utilization of a pair that sticks alone, without its sign, after find_varied_frictions with the pairs that
  !> stick: of the part of its bound that it needs. Fails where wrenches have no derivatives.
  subroutine vary_use(model, plan, state, friction, sensitivity, self, i, changes, err)
    type(model_type), intent(in) :: model                            !< the model
    type(plan_type), intent(in) :: plan                              !< its plan
    type(state_type), intent(in) :: state                            !< the motion, with all accelerations
    class(friction_motion_type), intent(in) :: friction              !< the frictions, solved in this motion
    type(motion_sensitivity_type), intent(inout) :: sensitivity      !< the derivatives
    type(varied_frictions_type), intent(inout) :: self               !< scratch, as find_varied_frictions left it
    integer, intent(in) :: i                                         !< number of the friction
    real(wp), intent(out) :: changes(:)                              !< (P) the derivatives
    type(error_type), allocatable, intent(out) :: err                !< allocated if it failed
    real(wp) :: wrench(6), change(6), load, part
    integer :: p

    changes = 0.0_wp
    call sensitivity%complete(model, state, err)
    associate (motion => sensitivity%motion, one => model%mechanism%frictions(i), balance => friction%balance)
      if (.not. allocated(err)) call find_varied_forces(model, motion, self%forces, err)
      if (.not. allocated(err)) call find_varied_reactions(model, motion, self%forces%links, self%reactions, err)
      if (allocated(err)) return
      wrench = balance%wrenches(:, i) + matmul(balance%by_force(:, i, :), balance%force)
      load = one%bearing_load(one%terms(wrench))
      do p = 1, size(changes)
        change = varied_wrench(plan, state, friction, i, one%coordinate, motion, self%reactions, wrench, p)
        associate (tangent => motion%tangents(p)%frictions(i))
          part = one%static*(dot_product(slopes_of(one, wrench), change) &
                             + varied_load(one, tangent%varies, tangent%change, motion%tangents(p)%slide(one%coordinate), wrench))
          if (tangent%varies) part = part + tangent%change(1)*load
          changes(p) = (sign(1.0_wp, balance%force(i))*motion%friction(p, i) - abs(balance%force(i))/(one%static*load)*part) &
                       /(one%static*load)
        end associate
      end do
    end associate
  end subroutine vary_use

  !> The derivatives of the forces of pairs that slip, and what these change of the forces of pairs that stick.
  subroutine find_forces(model, plan, state, friction, motion, self, forces, err)
    type(model_type), intent(in) :: model                            !< the model
    type(plan_type), intent(in) :: plan                              !< its plan
    type(state_type), intent(in) :: state                            !< the motion
    class(friction_motion_type), intent(in) :: friction              !< the frictions, solved in this motion
    type(varied_motion_type), intent(in) :: motion                   !< derivatives of the motion with frictions held
    type(varied_frictions_type), intent(in) :: self                  !< with those of the wrenches
    real(wp), intent(out), contiguous :: forces(:, :)                !< (frictions,P) the derivatives
    type(error_type), allocatable, intent(out) :: err                !< allocated if it failed
    real(wp) :: matrix(size(forces, 1), size(forces, 1)), by_wrench(6), wrench(6), change(6), factor
    integer :: pivots(size(forces, 1)), info, i, j, p, n

    n = size(forces, 1)
    matrix = 0.0_wp
    forces = 0.0_wp
    associate (frictions => model%mechanism%frictions, balance => friction%balance, modes => friction%modes)
      do i = 1, n
        matrix(i, i) = 1.0_wp
        if (modes%leads(i) .and. modes%any_slips()) then
          ! the accelerations that forces of others give it are taken by its own
          matrix(i, :) = balance%mobility(i, :)
        else if (modes%slips(i) .or. frictions(i)%is_smooth) then
          wrench = balance%wrenches(:, i) + matmul(balance%by_force(:, i, :), balance%force)
          by_wrench = slopes_of(frictions(i), wrench)
          factor = modes%direction(i)*frictions(i)%dynamic
          do j = 1, n
            matrix(i, j) = matrix(i, j) + factor*dot_product(by_wrench, balance%by_force(:, i, j))
          end do
          do p = 1, motion%n_parameters
            associate (k => frictions(i)%coordinate)
              change = varied_wrench(plan, state, friction, i, k, motion, self%reactions, wrench, p)
              forces(i, p) = own_change(motion%tangents(p), frictions(i), i, wrench, modes%direction(i), motion%q(p, 1, k), &
                                        state%dq(k)) - factor*dot_product(by_wrench, change)
            end associate
          end do
        end if
      end do
    end associate
    call dgetrf(n, n, matrix, n, pivots, info)
    if (info == 0) call dgetrs('N', n, size(forces, 2), matrix, n, pivots, forces, n, info)
    if (info == 0) return
    call raise(err, exit_singular, failure_no_friction)
    err%failure%coordinates = model%mechanism%frictions%coordinate
    err%failure%t = state%t
  end subroutine find_forces

  !> The derivatives of a bearing load by the wrench of its pair.
  pure function slopes_of(friction, wrench) result(slopes)
    type(friction_type), intent(in) :: friction      !< the friction
    real(wp), intent(in) :: wrench(6)                !< in the axes of the pair [N, N m]
    real(wp) :: slopes(6), terms(2, bearing_terms), by(2, bearing_terms), weights(bearing_terms), unit(6)
    integer :: c, t

    terms = friction%terms(wrench)
    weights = friction%weights()
    slopes = 0.0_wp
    do c = 1, 6
      unit = 0.0_wp
      unit(c) = 1.0_wp
      by = friction%terms(unit)
      do t = 1, bearing_terms
        if (norm2(terms(:, t)) > 0.0_wp) slopes(c) = slopes(c) + weights(t)*dot_product(terms(:, t), by(:, t))/norm2(terms(:, t))
      end do
    end do
  end function slopes_of

  !> The derivative of the force of a friction by its own numbers, by the advance of its pair, and by the rate of a smooth law.
  pure real(wp) function own_change(tangent, friction, number, wrench, direction, varied_rate, rate) result(change)
    type(tangent_type), intent(in) :: tangent        !< derivatives of all numbers
    type(friction_type), intent(in) :: friction      !< the friction
    integer, intent(in) :: number                    !< its number
    real(wp), intent(in) :: wrench(6)                !< in the axes of the pair [N, N m]
    real(wp), intent(in) :: direction                !< of slip; between -1 and 1 for a smooth law
    real(wp), intent(in) :: varied_rate              !< derivative of the rate
    real(wp), intent(in) :: rate                     !< the rate [rad/s, m/s]
    real(wp) :: load, turned

    associate (part => tangent%frictions(number))
      load = friction%bearing_load(friction%terms(wrench))
      turned = 0.0_wp
      if (friction%is_smooth) turned = (1.0_wp - direction**2)*varied_rate/friction%transition
      change = -direction*friction%dynamic*varied_load(friction, part%varies, part%change, &
                                                        tangent%slide(friction%coordinate), wrench)
      if (part%varies) then
        change = change - direction*part%change(2)*load
        if (friction%is_smooth) turned = turned - (1.0_wp - direction**2)*rate*part%change(7)/friction%transition**2
      end if
      change = change - turned*friction%dynamic*load
    end associate
  end function own_change

  !> The derivative of a bearing load by its numbers, the wrench held.
  pure real(wp) function varied_load(friction, varies, change, lead_change, wrench) result(load)
    type(friction_type), intent(in) :: friction      !< the friction
    logical, intent(in) :: varies                    !< its numbers vary
    real(wp), allocatable, intent(in) :: change(:)   !< derivatives of its numbers; not allocated: they are not known to vary
    real(wp), intent(in) :: lead_change              !< derivative of the way along the axis for each unit [m/rad]
    real(wp), intent(in) :: wrench(6)                !< in the axes of the pair [N, N m]
    real(wp) :: lengths(bearing_terms), way, across, by_radius, by_lead

    load = 0.0_wp
    lengths = norm2(friction%terms(wrench), 1)
    if (friction%is_helical()) then
      way = norm2([friction%radius, friction%lead])
      across = friction%radius*wrench(3) - friction%lead/friction%radius*wrench(6)
      by_radius = sign(1.0_wp, across)*(wrench(3) + friction%lead/friction%radius**2*wrench(6)) &
                  + friction%preload*friction%radius/way
      by_lead = -sign(1.0_wp, across)*wrench(6)/friction%radius + friction%preload*friction%lead/way
      load = by_lead*lead_change
      if (varies) load = load + by_radius*change(3) + way*change(6)
    else if (varies) then
      load = change(6)
      if (friction%turns) then
        load = load + change(3)*lengths(1) + change(4)*lengths(2)
      else if (friction%arm > 0.0_wp) then
        load = load - change(5)/friction%arm**2*lengths(2)
      end if
    end if
  end function varied_load

  !> The derivative of the wrench of a pair along its own axes, which turn.
  function varied_wrench(plan, state, friction, i, k, motion, reactions, wrench, p) result(change)
    type(plan_type), intent(in) :: plan                      !< the plan
    type(state_type), intent(in) :: state                    !< the motion
    class(friction_motion_type), intent(in) :: friction      !< the frictions
    integer, intent(in) :: i                                 !< number of the friction
    integer, intent(in) :: k                                 !< coordinate of the pair
    type(varied_motion_type), intent(in) :: motion           !< derivatives of the motion
    type(varied_reactions_type), intent(in) :: reactions     !< derivatives of wrenches, along fixed axes
    real(wp), intent(in) :: wrench(6)                        !< in the axes of the pair [N, N m]
    integer, intent(in) :: p                                 !< number of the parameter
    real(wp) :: change(6), r(3, 3), origin(3), omega(3), v(3), turned(3)

    associate (pair => friction%wrenches%plan%pairs(k))
      call link_motion(plan, state, pair%links(1), r, origin, omega, v)
      r = combine(r, pair%frame%r)
    end associate
    ! a turn about the axis itself does not change bearing loads
    turned = turn_back(r, motion%twists(p, 1:3, 0, motion%plan%step_of(k)))
    change(1:3) = turn_back(r, reactions%force(p, :, k)) - cross(turned, wrench(1:3))
    change(4:6) = turn_back(r, reactions%moment(p, :, k)) - cross(turned, wrench(4:6))
    ! components that equilibrium does not determine count as zero
    where (.not. friction%wrenches%unique(:, i)) change = 0.0_wp
  end function varied_wrench
end module mech9_varied_frictions
