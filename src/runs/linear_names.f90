!> The names and units of the states and inputs of the linearised equations of motion.
module mech9_linear_names
  use mech9_text, only: to_text
  use mech9_request, only: output_settings_type
  use mech9_units, only: units_of_words
  use mech9_mechanism, only: mechanism_type
  use mech9_result_units, only: si_unit
  use mech9_linearised_equilibrium, only: equilibrium_type
  use mech9_columns, only: columns_type, kinematic_columns
  implicit none
  private
  public :: name_linear_system, linear_columns

contains

  !> Name the states, which are coordinates, their rates and the states of motors, and the inputs, which are additional forces on the
  !> coordinates and voltages of motors.
  subroutine name_linear_system(mechanism, equilibrium, states, inputs)
    type(mechanism_type), intent(in) :: mechanism        !< the mechanism
    type(equilibrium_type), intent(in) :: equilibrium    !< linearised
    type(columns_type), intent(out) :: states            !< as columns
    type(columns_type), intent(out) :: inputs            !< as columns
    integer :: i

    allocate (states%names(0), states%units(0), states%long_names(0), inputs%names(0), inputs%units(0), inputs%long_names(0))
    associate (free => equilibrium%resting%free)
      do i = 1, size(free)
        call states%append('q'//to_text(free(i)), trim(unit_of_state(mechanism, free(i))))
        call inputs%append('Q'//to_text(free(i)), trim(merge('N m', 'N  ', mechanism%pairs(free(i))%pair%angular)))
      end do
      do i = 1, size(free)
        call states%append('dq'//to_text(free(i)), trim(unit_of_state(mechanism, free(i)))//'/s')
      end do
      if (size(mechanism%motors) > 0) then
        do i = 1, size(equilibrium%motors%states)
          call append_motor_state(mechanism, equilibrium%motors%states(i), states)
        end do
        do i = 1, size(equilibrium%motors%inputs)
          call inputs%append('M'//to_text(equilibrium%motors%inputs(i))//'.voltage', 'V')
        end do
      end if
    end associate
  end subroutine name_linear_system

  !> The recorded columns in the units of the matrices: SI, with the angles of the data file.
  function linear_columns(mechanism, output) result(columns)
    type(mechanism_type), intent(in) :: mechanism       !< the mechanism
    type(output_settings_type), intent(in) :: output    !< settings of the results
    type(columns_type) :: columns

    columns = kinematic_columns(mechanism, output, units_of_words('m', mechanism%units%angle_name, 'N', 'kg', ''))
  end function linear_columns

  !> The unit of a coordinate in the matrices: that of angles, m, or 1 for a user's own pair.
  pure character(len=3) function unit_of_state(mechanism, k) result(unit)
    type(mechanism_type), intent(in) :: mechanism   !< the mechanism
    integer, intent(in) :: k                        !< number of the coordinate

    unit = si_unit(mechanism%pairs(k)%pair)
    if (unit == 'rad') unit = mechanism%units%angle_name
  end function unit_of_state

  !> Append the name of a motor's state, in SI units.
  subroutine append_motor_state(mechanism, i, states)
    type(mechanism_type), intent(in) :: mechanism   !< the mechanism
    integer, intent(in) :: i                        !< number of the motor
    type(columns_type), intent(inout) :: states     !< gets the name and the unit
    character(len=:), allocatable :: unit

    associate (k => mechanism%motors(i)%motor%coordinate, state => mechanism%motors(i)%motor%kind_of_state())
      unit = state%unit
      if (state%by_coordinate) unit = trim(merge('rad', 'm  ', mechanism%pairs(k)%pair%angular))//' '//state%unit
      call states%append('M'//to_text(i)//'.'//trim(state%name), unit)
    end associate
  end subroutine append_motor_state
end module mech9_linear_names
