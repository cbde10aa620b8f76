!> The units of coordinates in results and messages, which are those of the data file.
module mech9_result_units
  use mech9_kinds, only: wp
  use mech9_mechanism, only: mechanism_type
  implicit none
  private
  public :: unit_of, unit_name, force_unit_name

contains

  !> One unit of coordinate k of the results, in rad or m.
  pure real(wp) function unit_of(mechanism, k)
    type(mechanism_type), intent(in) :: mechanism   !< the mechanism
    integer, intent(in) :: k                        !< number of the coordinate

    unit_of = 1.0_wp
    if (mechanism%pairs(k)%pair%angular) unit_of = mechanism%angle_unit
  end function unit_of

  !> Name of the unit of coordinate k; '1' for a user's own pair, whose unit is not known.
  pure character(len=3) function unit_name(mechanism, k)
    type(mechanism_type), intent(in) :: mechanism   !< the mechanism
    integer, intent(in) :: k                        !< number of the coordinate

    if (mechanism%pairs(k)%pair%kind_name() == 'user') then
      unit_name = '1'
    else if (.not. mechanism%pairs(k)%pair%angular) then
      unit_name = 'm'
    else
      unit_name = merge('rad', 'deg', abs(mechanism%angle_unit - 1.0_wp) <= 0.0_wp)
    end if
  end function unit_name

  !> Name of the unit of a generalized force on coordinate k: of a torque, whatever the unit of angles, or of a force; 'J' over the
  !> unit of a user's own pair.
  pure character(len=3) function force_unit_name(mechanism, k)
    type(mechanism_type), intent(in) :: mechanism   !< the mechanism
    integer, intent(in) :: k                        !< number of the coordinate

    if (mechanism%pairs(k)%pair%kind_name() == 'user') then
      force_unit_name = 'J'
    else
      force_unit_name = merge('N m', 'N  ', mechanism%pairs(k)%pair%angular)
    end if
  end function force_unit_name
end module mech9_result_units
