!> The names and units of the states and inputs of the linearised equations of motion.
module mech9_linear_names
  use mech9_text, only: to_text
  use mech9_mechanism, only: mechanism_type
  use mech9_result_units, only: unit_name
  use mech9_linearised_equilibrium, only: equilibrium_type
  use mech9_columns, only: columns_type
  implicit none
  private
  public :: name_linear_system

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
        call states%append('q'//to_text(free(i)), trim(unit_name(mechanism, free(i))))
        call inputs%append('Q'//to_text(free(i)), trim(merge('N m', 'N  ', mechanism%pairs(free(i))%pair%angular)))
      end do
      do i = 1, size(free)
        call states%append('dq'//to_text(free(i)), trim(unit_name(mechanism, free(i)))//'/s')
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
