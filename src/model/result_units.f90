!> The units of coordinates and of parameters in results and messages, which are those of the data file.
module mech9_result_units
  use mech9_kinds, only: wp
  use mech9_mechanism, only: mechanism_type
  use mech9_parameter, only: parameter_type, parameter_target_type
  implicit none
  private
  public :: unit_of, unit_name, force_unit_name, unit_of_parameter, longest_unit

  integer, parameter :: longest_unit = 24   !< letters of the unit of a parameter

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

  !> Name of the unit of a parameter: that of the numbers that it sets, '1' for plain numbers; empty where they have several units,
  !> or where it is not known.
  pure character(len=longest_unit) function unit_of_parameter(mechanism, parameter) result(unit)
    type(mechanism_type), intent(in) :: mechanism   !< the mechanism
    type(parameter_type), intent(in) :: parameter   !< the parameter
    integer :: i

    unit = ''
    do i = 1, size(parameter%targets)
      if (i == 1) unit = unit_of_target(mechanism, parameter%targets(1))
      if (unit /= unit_of_target(mechanism, parameter%targets(i))) unit = ''
    end do
  end function unit_of_parameter

  !> Name of the unit of a number of the data file; empty where it is not known.
  pure character(len=longest_unit) function unit_of_target(mechanism, target) result(unit)
    type(mechanism_type), intent(in) :: mechanism          !< the mechanism
    type(parameter_target_type), intent(in) :: target      !< the number
    character(len=3) :: angle
    integer :: k

    angle = merge('rad', 'deg', abs(mechanism%angle_unit - 1.0_wp) <= 0.0_wp)
    k = target%coordinate
    select case (target%unit)
    case ('')
      unit = merge('1', ' ', target%group /= 'user')
    case ('angle')
      unit = angle
    case ('angle/s')
      unit = angle//'/s'
    case ('m, angle')
      ! Denavit-Hartenberg parameters: a length, an angle, a length, an angle
      unit = merge(angle, 'm  ', modulo(target%position, 2) == 0)
    case ('1, 1/s, ...')
      unit = per_time('1', target%position - 1)
    case ('q, q/s, ...')
      unit = per_time(unit_name(mechanism, k), target%position - 1)
    case ('q')
      unit = ''
      if (k > 0) unit = unit_name(mechanism, k)
    case ('q/s')
      unit = per_time(unit_name(mechanism, k), 1)
    case ('N m/rad/s')
      unit = ''
      if (mechanism%pairs(k)%pair%angular) unit = target%unit
    case ('N or N m')
      unit = force_unit_name(mechanism, k)
    case default
      ! a comma or a blank word stands between units among which the table does not choose
      unit = target%unit
      if (scan(unit, ',') > 0 .or. index(unit, ' or ') > 0 .or. index(unit, ' per ') > 0) unit = ''
    end select
  end function unit_of_target

  !> A unit per second, per second squared, and so on.
  pure character(len=longest_unit) function per_time(unit, power) result(text)
    character(len=*), intent(in) :: unit   !< the unit
    integer, intent(in) :: power           !< of time, from 0
    character(len=12) :: number

    text = unit
    if (power == 0) return
    write (number, '(i0)') power
    text = trim(unit)//'/s'
    if (power > 1) text = trim(unit)//'/s^'//number
  end function per_time
end module mech9_result_units
