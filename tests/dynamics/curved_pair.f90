!> A pair without a fixed axis, in closed form: its origin runs along a curve while it turns unevenly.
module mech9_curved_pair
  use mech9_kinds, only: wp
  use mech9_error, only: error_type, raise, exit_data
  use mech9_rotation, only: about_axis
  use mech9_pair, only: pair_type, kind_name_length, pair_motion_type, screw_factors_type
  implicit none
  private
  public :: curved_pair_type

  !> At q = 0 both links coincide.
  type, extends(pair_type) :: curved_pair_type
    real(wp) :: axis(3) = [0.0_wp, 0.6_wp, 0.8_wp]   !< unit vector
    logical :: broken = .false.                      !< it has no value anywhere
  contains
    procedure :: evaluate
    procedure :: as_screw
    procedure :: kind_name
    procedure :: user_calls
  end type curved_pair_type

contains

  !> Turned by q + 0.2 sin q; origin at (0.3 sin q, 0.1 - 0.1 cos q, 0.1 q^2).
  subroutine evaluate(self, q, motion, err)
    class(curved_pair_type), intent(in) :: self         !< the pair
    real(wp), intent(in) :: q                           !< its coordinate
    type(pair_motion_type), intent(out) :: motion       !< of the moving link in the reference link
    type(error_type), allocatable, intent(out) :: err   !< allocated if it failed

    if (self%broken) then
      call raise(err, exit_data, 'this pair has no value')
      return
    end if
    motion%pose%r = about_axis(self%axis, q + 0.2_wp*sin(q))
    motion%pose%p = [0.3_wp*sin(q), 0.1_wp - 0.1_wp*cos(q), 0.1_wp*q**2]
    motion%w = (1.0_wp + 0.2_wp*cos(q))*self%axis
    motion%w_rate = -0.2_wp*sin(q)*self%axis
    motion%v = [0.3_wp*cos(q), 0.1_wp*sin(q), 0.2_wp*q]
    motion%v_rate = [-0.3_wp*sin(q), 0.1_wp*cos(q), 0.2_wp]
  end subroutine evaluate

  pure subroutine as_screw(self, factors, is_screw)
    class(curved_pair_type), intent(in) :: self        !< the pair
    type(screw_factors_type), intent(out) :: factors   !< not set
    logical, intent(out) :: is_screw                   !< false

    is_screw = .false.
  end subroutine as_screw

  pure function kind_name(self) result(name)
    class(curved_pair_type), intent(in) :: self   !< the pair
    character(len=kind_name_length) :: name

    name = 'curved'
  end function kind_name

  pure integer function user_calls(self)
    class(curved_pair_type), intent(in) :: self   !< the pair

    user_calls = 0
  end function user_calls
end module mech9_curved_pair
