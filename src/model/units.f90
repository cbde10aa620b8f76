!> The units of a data file and of its results. The program computes in m, rad, kg, s and N; readers and writers convert.
module mech9_units
  use mech9_kinds, only: wp, pi, radians_per_degree
  implicit none
  private
  public :: units_type, coordinate_units_type, units_of_words, longest_unit

  integer, parameter :: longest_unit = 24   !< letters of the name of a unit

  character, parameter :: blank = '_'   !< stands for a blank in a name that still grows

  real(wp), parameter :: inch = 0.0254_wp                    !< international inch [m]
  real(wp), parameter :: pound = 0.45359237_wp               !< avoirdupois pound [kg]
  real(wp), parameter :: pound_force = pound*9.80665_wp      !< weight of a pound in standard gravity [N]

  !> One unit of each kind in SI, and its name. All others follow from these and the second.
  type :: units_type
    real(wp) :: length = 1.0_wp                   !< [m]
    real(wp) :: force = 1.0_wp                    !< [N]
    real(wp) :: mass = 1.0_wp                     !< [kg]
    real(wp) :: angle = 1.0_wp                    !< [rad]
    real(wp) :: rate = 1.0_wp                     !< of angles in time [rad/s]
    character(len=2) :: length_name = 'm'
    logical :: names_length = .false.             !< the data file names the unit of lengths
    character(len=3) :: force_name = 'N'
    character(len=2) :: mass_name = 'kg'
    character(len=3) :: angle_name = 'rad'
    character(len=5) :: rate_name = 'rad/s'
  contains
    procedure :: are_si
    procedure :: has_joules
    procedure :: size_of
    procedure :: name_of
    procedure :: of_coordinate
  end type units_type

  !> Units of the numbers of a coordinate, in SI.
  type :: coordinate_units_type
    real(wp) :: position = 1.0_wp   !< [rad, m]; of accelerations, too
    real(wp) :: rate = 1.0_wp       !< [rad/s, m/s]
    real(wp) :: force = 1.0_wp      !< [N m, N]
    real(wp) :: slope = 1.0_wp      !< of stiffness and damping [N m/rad, N/m; by s]
  end type coordinate_units_type

contains

  !> The units by the words of a data file.
  pure type(units_type) function units_of_words(length, angle, force, mass, rate) result(units)
    character(len=*), intent(in) :: length   !< m, mm or in
    character(len=*), intent(in) :: angle    !< rad or deg
    character(len=*), intent(in) :: force    !< N, kN or lbf, in any case
    character(len=*), intent(in) :: mass     !< kg, g, t or lb
    character(len=*), intent(in) :: rate     !< rad/s, deg/s or rpm; empty: the unit of angles in a second

    select case (length)
    case ('mm')
      units%length = 1.0e-3_wp
      units%length_name = 'mm'
    case ('in')
      units%length = inch
      units%length_name = 'in'
    end select
    if (angle == 'deg') then
      units%angle = radians_per_degree
      units%angle_name = 'deg'
    end if
    select case (force)
    case ('kN', 'kn')
      units%force = 1000.0_wp
      units%force_name = 'kN'
    case ('lbf')
      units%force = pound_force
      units%force_name = 'lbf'
    end select
    select case (mass)
    case ('g')
      units%mass = 1.0e-3_wp
      units%mass_name = 'g'
    case ('t')
      units%mass = 1000.0_wp
      units%mass_name = 't'
    case ('lb')
      units%mass = pound
      units%mass_name = 'lb'
    end select
    units%rate = units%angle
    units%rate_name = units%angle_name//'/s'
    if (rate == '') return
    units%rate_name = rate
    units%rate = 1.0_wp
    if (rate == 'deg/s') units%rate = radians_per_degree
    if (rate == 'rpm') units%rate = pi/30.0_wp
  end function units_of_words

  !> Whether all units are those of the program: m, N, kg, rad and rad/s.
  pure logical function are_si(self)
    class(units_type), intent(in) :: self   !< the units

    are_si = self%has_joules() .and. self%mass_name == 'kg' .and. self%angle_name == 'rad' .and. self%rate_name == 'rad/s'
  end function are_si

  !> Whether energies are in J and powers in W: lengths are in m, forces in N.
  pure logical function has_joules(self)
    class(units_type), intent(in) :: self   !< the units

    has_joules = self%length_name == 'm' .and. self%force_name == 'N'
  end function has_joules

  !> One unit of the data file and of the results, in the SI unit of the same kind. Numbers per rad stay per rad.
  pure real(wp) function size_of(self, unit)
    class(units_type), intent(in) :: self       !< the units
    character(len=*), intent(in) :: unit        !< the SI unit: products of m, N, kg, J, W, rad, s, V, A and their powers, as N s/m
    character(len=longest_unit) :: name

    call convert(self, unit, name, size_of)
  end function size_of

  !> The name of a unit of the data file and of the results.
  pure character(len=longest_unit) function name_of(self, unit) result(name)
    class(units_type), intent(in) :: self       !< the units
    character(len=*), intent(in) :: unit        !< the SI unit of the same kind; see size_of
    real(wp) :: factor

    call convert(self, unit, name, factor)
  end function name_of

  !> The units of a coordinate. Stiffness and damping of angles are per rad, whatever the unit of angles.
  pure type(coordinate_units_type) function of_coordinate(self, unit) result(units)
    class(units_type), intent(in) :: self       !< the units
    character(len=*), intent(in) :: unit        !< rad, m, or 1 for a user's own pair, whose numbers are never converted

    select case (unit)
    case ('rad')
      units = coordinate_units_type(self%angle, self%rate, self%force*self%length, self%force*self%length)
    case ('m')
      units = coordinate_units_type(self%length, self%length, self%force, self%force/self%length)
    case default
      units = coordinate_units_type(force=self%force*self%length, slope=self%force*self%length)
    end select
  end function of_coordinate

  !> Find the unit of the data file that stands for an SI unit.
  pure subroutine convert(units, unit, name, factor)
    class(units_type), intent(in) :: units               !< the units
    character(len=*), intent(in) :: unit                 !< the SI unit
    character(len=longest_unit), intent(out) :: name     !< its name in the data file
    real(wp), intent(out) :: factor                      !< one unit of the data file in SI
    integer :: first, last, mark

    factor = 1.0_wp
    select case (unit)
    case ('rad/s')
      name = units%rate_name
      factor = units%rate
      return
    case ('')
      name = ''
      return
    end select
    name = ''
    first = 1
    do while (first <= len_trim(unit))
      last = scan(unit(first:)//' ', ' /') + first - 2
      mark = max(first - 1, 1)
      if (first > 1) name = trim(name)//merge('/', blank, unit(mark:mark) == '/')
      call convert_part(units, unit(first:last), unit(mark:mark) == '/' .and. first > 1, name, factor)
      first = last + 2
    end do
    do mark = 1, len_trim(name)
      if (name(mark:mark) == blank) name(mark:mark) = ' '
    end do
  end subroutine convert

  !> Append one part of a unit.
  pure subroutine convert_part(units, part, below, name, factor)
    class(units_type), intent(in) :: units                 !< the units
    character(len=*), intent(in) :: part                   !< a unit, and behind ^ its power
    logical, intent(in) :: below                           !< it is in the denominator
    character(len=longest_unit), intent(inout) :: name     !< gets its name
    real(wp), intent(inout) :: factor                      !< gets its factor
    character(len=9) :: word
    real(wp) :: one
    integer :: mark, power

    mark = index(part//'^', '^') - 1
    word = part(:mark)
    one = 1.0_wp
    power = 1
    if (len(part) == mark + 2) power = index('123456789', part(mark + 2:))
    select case (part(:mark))
    case ('m')
      word = units%length_name
      one = units%length
    case ('N')
      word = units%force_name
      one = units%force
    case ('kg')
      word = units%mass_name
      one = units%mass
    case ('rad')
      if (.not. below) word = units%angle_name
      if (.not. below) one = units%angle
    case ('J', 'W')
      if (.not. units%has_joules()) then
        one = units%force*units%length
        word = trim(units%force_name)//blank//units%length_name
        if (part == 'W') word = trim(word)//'/s'
      end if
    end select
    name = trim(name)//trim(word)//part(mark + 1:)
    if (below) then
      factor = factor/one**power
    else
      factor = factor*one**power
    end if
  end subroutine convert_part
end module mech9_units
