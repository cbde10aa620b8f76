!> The units of coordinates and of parameters in results and messages, which are those of the data file.
module mech9_result_units
  use mech9_kinds, only: wp
  use mech9_text, only: string_type, to_text
  use mech9_units, only: longest_unit
  use mech9_pair, only: pair_type
  use mech9_mechanism, only: mechanism_type
  use mech9_parameter, only: parameter_type, parameter_target_type
  implicit none
  private
  public :: si_unit, si_force, unit_of, unit_name, rate_unit_of, rate_unit_name, force_unit_name, unit_of_parameter, &
    name_parameters, length_text
  public :: longest_unit, impulse_unit_of, inertia_unit_of, inertia_unit_name

contains

  !> The SI unit of a coordinate: rad or m; '1' for a user's own pair, whose unit is not known.
  pure character(len=3) function si_unit(pair) result(unit)
    class(pair_type), intent(in) :: pair   !< the pair of the coordinate

    unit = merge('rad', 'm  ', pair%angular)
    if (pair%kind_name() == 'user') unit = '1'
  end function si_unit

  !> The SI unit of a generalized force on a coordinate: of a torque, whatever the unit of angles, or of a force; 'J' over the unit
  !> of a user's own pair.
  pure character(len=3) function si_force(pair) result(unit)
    class(pair_type), intent(in) :: pair   !< the pair of the coordinate

    unit = merge('N m', 'N  ', pair%angular)
    if (pair%kind_name() == 'user') unit = 'J'
  end function si_force

  !> One unit of coordinate k of the results, in rad or m.
  pure real(wp) function unit_of(mechanism, k)
    type(mechanism_type), intent(in) :: mechanism   !< the mechanism
    integer, intent(in) :: k                        !< number of the coordinate

    unit_of = mechanism%units%size_of(trim(si_unit(mechanism%pairs(k)%pair)))
  end function unit_of

  !> Name of the unit of coordinate k; '1' for a user's own pair, whose unit is not known.
  pure character(len=3) function unit_name(mechanism, k)
    type(mechanism_type), intent(in) :: mechanism   !< the mechanism
    integer, intent(in) :: k                        !< number of the coordinate
    character(len=longest_unit) :: full

    full = mechanism%units%name_of(trim(si_unit(mechanism%pairs(k)%pair)))
    unit_name = full(:len(unit_name))
  end function unit_name

  !> One unit of the rate of coordinate k in the results, in rad/s or m/s.
  pure real(wp) function rate_unit_of(mechanism, k) result(unit)
    type(mechanism_type), intent(in) :: mechanism   !< the mechanism
    integer, intent(in) :: k                        !< number of the coordinate

    unit = mechanism%units%size_of(trim(si_unit(mechanism%pairs(k)%pair))//'/s')
  end function rate_unit_of

  !> Name of the unit of the rate of coordinate k.
  pure character(len=5) function rate_unit_name(mechanism, k) result(name)
    type(mechanism_type), intent(in) :: mechanism   !< the mechanism
    integer, intent(in) :: k                        !< number of the coordinate
    character(len=longest_unit) :: full

    full = mechanism%units%name_of(trim(si_unit(mechanism%pairs(k)%pair))//'/s')
    name = full(:len(name))
  end function rate_unit_name

  !> A length with its unit.
  pure character(len=36) function length_text(mechanism, length, digits) result(text)
    type(mechanism_type), intent(in) :: mechanism   !< the mechanism
    real(wp), intent(in) :: length                  !< the length [m]
    integer, intent(in) :: digits                   !< of the number

    text = to_text(length/mechanism%units%length, digits)//' '//trim(mechanism%units%length_name)
  end function length_text

  !> Name of the unit of a generalized force on coordinate k; see si_force.
  pure character(len=longest_unit) function force_unit_name(mechanism, k)
    type(mechanism_type), intent(in) :: mechanism   !< the mechanism
    integer, intent(in) :: k                        !< number of the coordinate

    force_unit_name = mechanism%units%name_of(trim(si_force(mechanism%pairs(k)%pair)))
  end function force_unit_name

  !> One unit of a coefficient of motion in the results, in kg m^2, kg m or kg: mass times length squared between two turning coordinates,
  !> whatever the unit of angles.
  pure real(wp) function inertia_unit_of(mechanism, p, r) result(unit)
    type(mechanism_type), intent(in) :: mechanism   !< the mechanism
    integer, intent(in) :: p                        !< number of a coordinate
    integer, intent(in) :: r                        !< number of a coordinate

    unit = mechanism%units%size_of(trim(si_inertia(mechanism, p, r)))
  end function inertia_unit_of

  !> Name of the unit of a coefficient of motion in the results.
  pure character(len=longest_unit) function inertia_unit_name(mechanism, p, r) result(name)
    type(mechanism_type), intent(in) :: mechanism   !< the mechanism
    integer, intent(in) :: p                        !< number of a coordinate
    integer, intent(in) :: r                        !< number of a coordinate

    name = mechanism%units%name_of(trim(si_inertia(mechanism, p, r)))
  end function inertia_unit_name

  !> The SI unit of a coefficient of motion. A user's own pair, whose unit is not known, counts as one that turns.
  pure character(len=6) function si_inertia(mechanism, p, r) result(unit)
    type(mechanism_type), intent(in) :: mechanism   !< the mechanism
    integer, intent(in) :: p                        !< number of a coordinate
    integer, intent(in) :: r                        !< number of a coordinate
    character(len=6), parameter :: names(0:2) = ['kg    ', 'kg m  ', 'kg m^2']

    unit = names(count([si_force(mechanism%pairs(p)%pair), si_force(mechanism%pairs(r)%pair)] /= 'N'))
  end function si_inertia

  !> One unit of the impulse of a stop, a friction or a contact in the results, in N m s or N s.
  pure real(wp) function impulse_unit_of(mechanism, group, number) result(unit)
    type(mechanism_type), intent(in) :: mechanism   !< the mechanism
    character(len=*), intent(in) :: group           !< stop, friction or contact
    integer, intent(in) :: number                   !< of the group

    select case (group)
    case ('stop')
      unit = mechanism%units%size_of(trim(si_force(mechanism%pairs(mechanism%stops(number)%coordinate)%pair)))
    case ('friction')
      unit = mechanism%units%size_of(trim(si_force(mechanism%pairs(mechanism%frictions(number)%coordinate)%pair)))
    case default
      unit = mechanism%units%force
    end select
  end function impulse_unit_of

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

  !> Names and units of parameters, in their order.
  pure subroutine name_parameters(mechanism, parameters, names, units)
    type(mechanism_type), intent(in) :: mechanism               !< the mechanism
    type(parameter_type), intent(in) :: parameters(:)           !< the parameters
    type(string_type), allocatable, intent(out) :: names(:)     !< (parameters)
    type(string_type), allocatable, intent(out) :: units(:)     !< (parameters) empty where none is known
    integer :: i

    allocate (names(size(parameters)), units(size(parameters)))
    do i = 1, size(parameters)
      names(i)%text = parameters(i)%name
      units(i)%text = trim(unit_of_parameter(mechanism, parameters(i)))
    end do
  end subroutine name_parameters

  !> Name of the unit of a number of the data file; empty where it is not known.
  pure character(len=longest_unit) function unit_of_target(mechanism, target) result(unit)
    type(mechanism_type), intent(in) :: mechanism          !< the mechanism
    type(parameter_target_type), intent(in) :: target      !< the number
    integer :: k

    k = target%coordinate
    associate (units => mechanism%units)
      select case (target%unit)
      case ('')
        unit = merge('1', ' ', target%group /= 'user')
        ! the unit of a compliant end depends on its exponent
        if (any(target%group == ['stop   ', 'contact']) .and. any(target%item == ['stiffness', 'damping  ']) .and. &
            .not. units%has_joules()) unit = ''
      case ('angle')
        unit = units%angle_name
      case ('angle/s')
        unit = units%rate_name
      case ('m, angle')
        ! Denavit-Hartenberg parameters: a length, an angle, a length, an angle
        unit = units%length_name
        if (modulo(target%position, 2) == 0) unit = units%angle_name
      case ('1, 1/s, ...')
        unit = per_time('1', target%position - 1)
      case ('q, q/s, ...')
        unit = per_time(unit_name(mechanism, k), target%position - 1)
        if (target%position == 2) unit = rate_unit_name(mechanism, k)
      case ('q')
        unit = ''
        if (k > 0) unit = unit_name(mechanism, k)
      case ('q/s')
        unit = rate_unit_name(mechanism, k)
      case ('N m/rad/s')
        unit = ''
        if (mechanism%pairs(k)%pair%angular) unit = units%name_of(trim(target%unit))
      case ('N or N m')
        unit = force_unit_name(mechanism, k)
      case default
        ! a comma or a blank word stands between units among which the table does not choose
        unit = target%unit
        if (scan(unit, ',') > 0 .or. index(unit, ' or ') > 0 .or. index(unit, ' per ') > 0) unit = ''
        unit = units%name_of(trim(unit))
      end select
    end associate
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
