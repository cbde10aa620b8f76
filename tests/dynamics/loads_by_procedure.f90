!> A user's forces that do what built-in loads do, so that both can be compared.
!>
!> The parameters in their order: two links; a coordinate; a point of each link [m]; a force [N], in fixed axes, at the point of the
!> first link; a torque [N m], in the axes of the second link, on that link; of a spring with damper between the two points the
!> stiffness [N/m], the free length [m] and the damping [N s/m]; of one on the coordinate the stiffness, the position without force
!> and the damping [N m or N, by rad or m, and by rad/s or m/s].
submodule(mech9_user_force) loads_by_procedure
  implicit none
contains

  module subroutine user_force(t, state, parameters, loads)
    real(wp), intent(in) :: t                      !< time [s]
    type(motion_view_type), intent(in) :: state    !< links and coordinates
    real(wp), intent(in) :: parameters(:)          !< as above
    type(force_sum_type), intent(inout) :: loads   !< sums to which forces are added
    real(wp) :: along(3), length, rate, tension
    integer :: first, second, k

    first = nint(parameters(1))
    second = nint(parameters(2))
    k = nint(parameters(3))
    associate (p => parameters(4:6), q => parameters(7:9))
      call loads%add_force(state, first, p, parameters(10:12))
      call loads%add_torque(second, state%turned(second, parameters(13:15)))
      along = state%position(second, q) - state%position(first, p)
      length = norm2(along)
      along = along/length
      rate = dot_product(along, state%velocity(second, q) - state%velocity(first, p))
      tension = parameters(16)*(length - parameters(17)) + parameters(18)*rate
      call loads%add_force(state, first, p, tension*along)
      call loads%add_force(state, second, q, -tension*along)
    end associate
    call loads%add_generalized(k, -parameters(19)*(state%q(k) - parameters(20)) - parameters(21)*state%dq(k))
  end subroutine user_force
end submodule loads_by_procedure
