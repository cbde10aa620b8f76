!> The formulas of planar motion: the contributions of one step to the motion of frames and to the equations of closures.
!>
!> A pose is (cosine, sine, x, y) in the plane's axes; a velocity is (angular velocity about the normal, velocity of an
!> origin), and an acceleration has the same three parts. The procedures are small, so that the compiler can put them into the
!> loops that use them. All but the last extent of an array of frames is known, so that its address stays in a register.
module mech9_planar_formulas
  use mech9_kinds, only: wp
  use mech9_planar_plan, only: planar_step_type, planar_closure_type
  implicit none
  private
  public :: step_column, step_velocity, step_acceleration, add_rate, add_bias, stem_difference, rows_at_base, closing_error
  public :: turn_in_plane, point_velocity, point_acceleration

contains

  !> The components in the plane's axes of a vector that is given in those of a frame.
  pure subroutine turn_in_plane(pose, vector, turned)
    real(wp), intent(in) :: pose(4)      !< pose of the frame [m]
    real(wp), intent(in) :: vector(2)    !< in the frame's axes, of any unit
    real(wp), intent(out) :: turned(2)   !< in the plane's axes

    turned(1) = pose(1)*vector(1) - pose(2)*vector(2)
    turned(2) = pose(2)*vector(1) + pose(1)*vector(2)
  end subroutine turn_in_plane

  !> Velocity of a point that moves with a frame.
  pure subroutine point_velocity(velocity, arm, v)
    real(wp), intent(in) :: velocity(3)   !< of the frame [rad/s, m/s]
    real(wp), intent(in) :: arm(2)        !< from the frame's origin to the point, in the plane's axes [m]
    real(wp), intent(out) :: v(2)         !< of the point, in the plane's axes [m/s]

    v(1) = velocity(2) - velocity(1)*arm(2)
    v(2) = velocity(3) + velocity(1)*arm(1)
  end subroutine point_velocity

  !> Acceleration of a point that moves with a frame.
  pure subroutine point_acceleration(w, acceleration, arm, a)
    real(wp), intent(in) :: w                 !< angular velocity of the frame [rad/s]
    real(wp), intent(in) :: acceleration(3)   !< of the frame [rad/s^2, m/s^2]
    real(wp), intent(in) :: arm(2)            !< from the frame's origin to the point, in the plane's axes [m]
    real(wp), intent(out) :: a(2)             !< of the point, in the plane's axes [m/s^2]

    a(1) = acceleration(2) - acceleration(1)*arm(2) - w**2*arm(1)
    a(2) = acceleration(3) + acceleration(1)*arm(1) - w**2*arm(2)
  end subroutine point_acceleration

  !> Derivatives of a closure's three equations with respect to the coordinate of a step of its loop.
  pure subroutine step_column(step, sign, pose, slide, base, per_length, column)
    type(planar_step_type), intent(in) :: step   !< the step
    real(wp), intent(in) :: sign                 !< of the step in the loop: 1 or -1
    real(wp), intent(in) :: pose(4)              !< pose of the step's frame [m]
    real(wp), intent(in) :: slide(2)             !< velocity of the frame's origin per unit rate
    real(wp), intent(in) :: base(2)              !< origin of the frame at which the closure is written [m]
    real(wp), intent(in) :: per_length           !< one over the mechanism's size [1/m]
    real(wp), intent(out) :: column(3)           !< per rad of a turn, or per length of the mechanism of a slide
    real(wp) :: w

    if (step%turns) then
      w = sign*step%turn
      column(1) = w
      w = w*per_length
      column(2) = w*(pose(4) - base(2))
      column(3) = w*(base(1) - pose(3))
    else
      column(1) = 0.0_wp
      column(2) = sign*slide(1)
      column(3) = sign*slide(2)
    end if
  end subroutine step_column

  !> Velocity of a step's frame from the velocity of its parent frame.
  pure subroutine step_velocity(step, rate, arm, slide, parent, v)
    type(planar_step_type), intent(in) :: step   !< the step
    real(wp), intent(in) :: rate                 !< of the step's coordinate [rad/s, m/s]
    real(wp), intent(in) :: arm(2)               !< from the parent's origin to the frame's [m]
    real(wp), intent(in) :: slide(2)             !< velocity of the frame's origin per unit rate
    real(wp), intent(in) :: parent(3)            !< velocity of the parent [rad/s, m/s]
    real(wp), intent(out) :: v(3)                !< velocity of the frame [rad/s, m/s]

    v(1) = parent(1) + step%turn*rate
    v(2) = parent(2) - parent(1)*arm(2)
    v(3) = parent(3) + parent(1)*arm(1)
    if (step%turns) return
    v(2) = v(2) + rate*slide(1)
    v(3) = v(3) + rate*slide(2)
  end subroutine step_velocity

  !> Acceleration of a step's frame from the acceleration of its parent frame.
  pure subroutine step_acceleration(step, rates, arm, slide, w, parent, a)
    type(planar_step_type), intent(in) :: step   !< the step
    real(wp), intent(in) :: rates(2)             !< rate and acceleration of the step's coordinate [rad/s, m/s; per s]
    real(wp), intent(in) :: arm(2)               !< from the parent's origin to the frame's [m]
    real(wp), intent(in) :: slide(2)             !< velocity of the frame's origin per unit rate
    real(wp), intent(in) :: w                    !< angular velocity of the parent [rad/s]
    real(wp), intent(in) :: parent(3)            !< acceleration of the parent [rad/s^2, m/s^2]
    real(wp), intent(out) :: a(3)                !< acceleration of the frame [rad/s^2, m/s^2]
    real(wp) :: coriolis

    a(1) = parent(1) + step%turn*rates(2)
    a(2) = parent(2) - parent(1)*arm(2) - w**2*arm(1)
    a(3) = parent(3) + parent(1)*arm(1) - w**2*arm(2)
    if (step%turns) return
    coriolis = 2.0_wp*w*rates(1)
    a(2) = a(2) + rates(2)*slide(1) - coriolis*slide(2)
    a(3) = a(3) + rates(2)*slide(2) + coriolis*slide(1)
  end subroutine step_acceleration

  !> Add the contribution of a step's coordinate to the relative motion of the ends of a loop, at a place.
  pure subroutine add_rate(step, rate, pose, slide, place, opening)
    type(planar_step_type), intent(in) :: step   !< the step
    real(wp), intent(in) :: rate                 !< rate or acceleration, with the sign of the step in the loop
    real(wp), intent(in) :: pose(4)              !< pose of the step's frame [m]
    real(wp), intent(in) :: slide(2)             !< velocity of the frame's origin per unit rate
    real(wp), intent(in) :: place(2)             !< the place [m]
    real(wp), intent(inout) :: opening(3)        !< motion of the closing frame relative to the target, at the place
    real(wp) :: w

    if (step%turns) then
      w = rate*step%turn
      opening(1) = opening(1) + w
      opening(2) = opening(2) - w*(place(2) - pose(4))
      opening(3) = opening(3) + w*(place(1) - pose(3))
    else
      opening(2) = opening(2) + rate*slide(1)
      opening(3) = opening(3) + rate*slide(2)
    end if
  end subroutine add_rate

  !> Add the contribution of a step to the bias acceleration of a loop: the centripetal and Coriolis terms, which depend on
  !> velocities only.
  pure subroutine add_bias(step, sign, rate, arm, slide, w, bias)
    type(planar_step_type), intent(in) :: step   !< the step
    real(wp), intent(in) :: sign                 !< of the step in the loop: 1 or -1; 0: not in it
    real(wp), intent(in) :: rate                 !< of the step's coordinate [rad/s, m/s]
    real(wp), intent(in) :: arm(2)               !< from the parent's origin to the frame's [m]
    real(wp), intent(in) :: slide(2)             !< velocity of the frame's origin per unit rate
    real(wp), intent(in) :: w                    !< angular velocity of the parent [rad/s]
    real(wp), intent(inout) :: bias(2)           !< acceleration of the closing frame relative to the target [m/s^2]
    real(wp) :: square, coriolis

    square = sign*w**2
    bias(1) = bias(1) - square*arm(1)
    bias(2) = bias(2) - square*arm(2)
    if (step%turns) return
    coriolis = 2.0_wp*sign*w*rate
    bias(1) = bias(1) - coriolis*slide(2)
    bias(2) = bias(2) + coriolis*slide(1)
  end subroutine add_bias

  !> Difference at a place between the motions of two bodies on which two frames are fixed: of the velocities, or of the
  !> accelerations without their centripetal terms.
  pure subroutine stem_difference(stems, place, f, v, difference)
    integer, intent(in) :: stems(2)          !< numbers of the two frames
    real(wp), intent(in) :: place(2)         !< the place [m]
    real(wp), intent(in) :: f(4, 0:*)        !< poses of the frames [m]
    real(wp), intent(in) :: v(3, 0:*)        !< velocities, or accelerations, of the frames
    real(wp), intent(out) :: difference(3)   !< motion of the first frame less that of the second: angular, and at the place
    integer :: i, k

    difference = 0.0_wp
    i = stems(1)
    k = stems(2)
    if (i == k) return
    difference(1) = v(1, i) - v(1, k)
    difference(2) = v(2, i) - v(1, i)*(place(2) - f(4, i)) - v(2, k) + v(1, k)*(place(2) - f(4, k))
    difference(3) = v(3, i) + v(1, i)*(place(1) - f(3, i)) - v(3, k) - v(1, k)*(place(1) - f(3, k))
  end subroutine stem_difference

  !> The three equations of a closure, from a motion that is given at the origin of its closing frame.
  pure subroutine rows_at_base(closure, per_length, f, motion, rows)
    type(planar_closure_type), intent(in) :: closure   !< the closure in planar arithmetic
    real(wp), intent(in) :: per_length                 !< one over the mechanism's size [1/m]
    real(wp), intent(in) :: f(4, 0:*)                  !< poses of the frames [m]
    real(wp), intent(in) :: motion(3)   !< angular and at that origin: displacement [rad, m], velocity or acceleration
    real(wp), intent(out) :: rows(3)   !< the same at the origin of the base frame, translations in lengths of the mechanism
    integer :: b, i

    b = closure%base
    i = closure%closing
    rows(1) = motion(1)
    rows(2) = (motion(2) - motion(1)*(f(4, b) - f(4, i)))*per_length
    rows(3) = (motion(3) + motion(1)*(f(3, b) - f(3, i)))*per_length
  end subroutine rows_at_base

  !> The angle and the displacement from the target pose to the closing frame.
  pure subroutine closing_error(closure, f, error)
    type(planar_closure_type), intent(in) :: closure   !< the closure in planar arithmetic
    real(wp), intent(in) :: f(4, 0:*)                  !< poses of the frames [m]
    real(wp), intent(out) :: error(3)                  !< from the target pose to the closing frame [rad, m, m]
    real(wp) :: c, s
    integer :: i, t

    i = closure%closing
    t = closure%target
    c = f(1, t)*closure%cosine - f(2, t)*closure%sine
    s = f(2, t)*closure%cosine + f(1, t)*closure%sine
    error(1) = angle_of(c*f(1, i) + s*f(2, i), c*f(2, i) - s*f(1, i))
    error(2) = f(3, i) - f(3, t) - (f(1, t)*closure%place(1) - f(2, t)*closure%place(2))
    error(3) = f(4, i) - f(4, t) - (f(2, t)*closure%place(1) + f(1, t)*closure%place(2))
  end subroutine closing_error

  !> The angle with a given cosine and sine; a small angle is found by the series of the arc sine.
  pure real(wp) function angle_of(c, s) result(angle)
    real(wp), intent(in) :: c   !< cosine
    real(wp), intent(in) :: s   !< sine

    if (c > 0.0_wp .and. abs(s) < 1.0e-2_wp) then
      angle = s*(1.0_wp + s**2*(1.0_wp/6.0_wp + s**2*(3.0_wp/40.0_wp + s**2*(5.0_wp/112.0_wp))))
    else
      angle = atan2(s, c)
    end if
  end function angle_of
end module mech9_planar_formulas
