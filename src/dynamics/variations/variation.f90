!> The variation of a motion: derivatives of coordinates and frames, of their rates and of their accelerations by one parameter.
module mech9_variation
  use mech9_kinds, only: wp
  use mech9_plan, only: plan_type
  implicit none
  private
  public :: variation_type, new_variation

  !> Derivatives by one parameter, in the axes of frame 0. Those of independent coordinates are given, those of dependent
  !> coordinates and of frames follow. `turn` and `shift` are the rotation of a frame and the shift of its origin.
  type :: variation_type
    real(wp), allocatable :: q(:)           !< (M) of the coordinates [rad, m]
    real(wp), allocatable :: dq(:)          !< (M) of the rates [rad/s, m/s]
    real(wp), allocatable :: ddq(:)         !< (M) of the accelerations [rad/s^2, m/s^2]
    real(wp), allocatable :: turn(:, :)     !< (3,0:M) [rad]
    real(wp), allocatable :: shift(:, :)    !< (3,0:M) [m]
    real(wp), allocatable :: axis_w(:, :)   !< (3,M) of the angular velocity that each step gives per unit rate
    real(wp), allocatable :: axis_v(:, :)   !< (3,M) of the velocity of the new origin per unit rate
    real(wp), allocatable :: omega(:, :)    !< (3,0:M) of the angular velocity [rad/s]
    real(wp), allocatable :: v(:, :)        !< (3,0:M) of the velocity of the origin [m/s]
    real(wp), allocatable :: alpha(:, :)    !< (3,0:M) of the angular acceleration [rad/s^2]
    real(wp), allocatable :: a(:, :)        !< (3,0:M) of the acceleration of the origin [m/s^2]
  contains
    procedure :: clear
  end type variation_type

contains

  !> A variation that is zero, with room for all frames of a plan.
  pure function new_variation(plan) result(variation)
    type(plan_type), intent(in) :: plan   !< the plan of the mechanism
    type(variation_type) :: variation
    integer :: m

    m = plan%n_coordinates
    allocate (variation%q(m), variation%dq(m), variation%ddq(m), source=0.0_wp)
    allocate (variation%turn(3, 0:m), variation%shift(3, 0:m), variation%omega(3, 0:m), variation%v(3, 0:m), &
              variation%alpha(3, 0:m), variation%a(3, 0:m), source=0.0_wp)
    allocate (variation%axis_w(3, m), variation%axis_v(3, m), source=0.0_wp)
  end function new_variation

  !> Make the derivatives of all coordinates, rates and accelerations zero. Those of frames become so with the next sweep.
  pure subroutine clear(self)
    class(variation_type), intent(inout) :: self   !< the variation

    self%q = 0.0_wp
    self%dq = 0.0_wp
    self%ddq = 0.0_wp
  end subroutine clear
end module mech9_variation
