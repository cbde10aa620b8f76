!> A coupling given by a user's procedure, in either form.
module mech9_procedure_coupling
  use, intrinsic :: ieee_arithmetic, only: ieee_is_finite, ieee_value, ieee_quiet_nan
  use mech9_kinds, only: wp
  use mech9_error, only: error_type, raise, exit_data
  use mech9_text, only: to_text
  use mech9_taylor, only: taylor, variable
  use mech9_differentiation, only: half_width, beside, step_count, trial_step, best_slopes_type, best_derivatives_type, &
    length_along
  use mech9_coupling, only: coupling_name_length, curve_order
  use mech9_function_coupling, only: function_coupling_type
  use mech9_registered_procedures, only: registered_procedure_type
  use mech9_registered_calls, only: call_function
  use mech9_not_linked, only: not_linked
  use mech9_user_coupling, only: user_coupling
  use mech9_user_coupling_values, only: user_coupling_values
  implicit none
  private
  public :: procedure_coupling_type, make_procedure_coupling

  !> A coupling by a user's procedure.
  type, extends(function_coupling_type) :: procedure_coupling_type
    integer :: number = 0                    !< of the coupling in the data file
    real(wp), allocatable :: parameters(:)   !< numbers for the user's procedure
    type(registered_procedure_type) :: registered   !< the procedure, where it is not linked
    logical :: plain_values = .false.        !< it gives plain reals, not their derivatives
  contains
    procedure :: find_curve
    procedure :: find_third
    procedure :: kind_name
    procedure :: constants
    procedure :: varied_term
  end type procedure_coupling_type

  ! Forms of a value, or of a second derivative, of which differences are taken
  integer, parameter :: of_value = 0, of_second = 2

contains

  !> Make the coupling and find out which form of procedure there is. Fails where there is none, and where it gives no numbers.
  subroutine make_procedure_coupling(number, start, parameters, registered, coupling, err)
    integer, intent(in) :: number                           !< of the coupling in the data file
    real(wp), intent(in) :: start                           !< a first coordinate for which the procedure may be called [rad, m]
    real(wp), intent(in) :: parameters(:)                   !< numbers for the user's procedure
    type(registered_procedure_type), intent(in) :: registered   !< the procedure; the linked one where it does not exist
    type(procedure_coupling_type), intent(out) :: coupling  !< the coupling, without its coordinates
    type(error_type), allocatable, intent(out) :: err       !< allocated if it failed
    type(taylor) :: second
    real(wp) :: value, curve(0:curve_order)

    coupling%number = number
    coupling%parameters = parameters
    coupling%registered = registered
    call find_taylor(coupling, start, second)
    if (registered%exists()) then
      coupling%plain_values = .not. (ieee_is_finite(second%first) .and. ieee_is_finite(second%second))
    else
      coupling%plain_values = second%value <= not_linked
    end if
    if (coupling%plain_values .and. .not. registered%exists()) then
      call user_coupling_values(number, start, parameters, value)
      if (value <= not_linked) then
        call raise(err, exit_data, 'coupling '//to_text(number)//' asks for a user procedure, but none is linked; '// &
                   'see docs/how-to/user-procedures.md for how to write user_coupling and link or register it')
        return
      end if
    end if
    call coupling%find_curve(start, curve, err)
    coupling%steepest = abs(curve(1))
  end subroutine make_procedure_coupling

  !> Value and derivatives from the form with derivatives. A procedure that is registered may leave derivatives out, which are then
  !> not numbers.
  subroutine find_taylor(self, q, second)
    class(procedure_coupling_type), intent(in) :: self   !< the coupling
    real(wp), intent(in) :: q                            !< the first coordinate [rad, m]
    type(taylor), intent(out) :: second                  !< the second coordinate with its derivatives by the first one [rad, m]

    if (self%registered%exists()) then
      call call_function(self%registered, self%number, q, self%parameters, second)
    else
      call user_coupling(self%number, variable(q), self%parameters, second)
    end if
  end subroutine find_taylor

  !> The value from the form in plain reals.
  subroutine find_value(self, q, value)
    class(procedure_coupling_type), intent(in) :: self   !< the coupling
    real(wp), intent(in) :: q                            !< the first coordinate [rad, m]
    real(wp), intent(out) :: value                       !< the second coordinate [rad, m]
    type(taylor) :: second

    if (self%registered%exists()) then
      call call_function(self%registered, self%number, q, self%parameters, second)
      value = second%value
    else
      call user_coupling_values(self%number, q, self%parameters, value)
    end if
  end subroutine find_value

  !> The procedure's value and derivatives. Fails where they are not finite.
  subroutine find_curve(self, q, curve, err)
    class(procedure_coupling_type), intent(in) :: self   !< the coupling
    real(wp), intent(in) :: q                            !< the first coordinate [rad, m]
    real(wp), intent(out) :: curve(0:curve_order)        !< value and derivatives
    type(error_type), allocatable, intent(out) :: err    !< allocated if it failed
    type(taylor) :: second
    type(best_derivatives_type) :: best
    logical :: ok

    best%is_smooth = .true.
    if (self%plain_values) then
      call differentiate(self, q, of_value, best)
      curve = [best%value(1), best%first(1), best%second(1)]
      ok = best%is_found
    else
      call find_taylor(self, q, second)
      curve = [second%value, second%first, second%second]
      ok = all(ieee_is_finite(curve))
    end if
    if (ok .and. best%is_smooth) return
    curve = 0.0_wp
    call refuse(self, q, ok, err)
  end subroutine find_curve

  !> The third derivative, by differences of the second one. Fails where there are no finite numbers.
  subroutine find_third(self, q, third, err)
    class(procedure_coupling_type), intent(in) :: self   !< the coupling
    real(wp), intent(in) :: q                            !< the first coordinate [rad, m]
    real(wp), intent(out) :: third                       !< third derivative
    type(error_type), allocatable, intent(out) :: err    !< allocated if it failed
    type(best_derivatives_type) :: best

    call differentiate(self, q, of_second, best)
    third = best%first(1)
    if (.not. best%is_smooth) call refuse(self, q, best%is_found, err)
  end subroutine find_third

  !> The failure of a procedure whose numbers are not finite, or whose derivatives are not known.
  subroutine refuse(self, q, is_finite, err)
    class(procedure_coupling_type), intent(in) :: self   !< the coupling
    real(wp), intent(in) :: q                            !< the first coordinate [rad, m]
    logical, intent(in) :: is_finite                     !< all numbers are finite
    type(error_type), allocatable, intent(out) :: err    !< always allocated
    character(len=:), allocatable :: place

    place = ' where its first coordinate is '//to_text(q, 12)//' (rad, m)'
    if (is_finite) then
      call raise(err, exit_data, 'the user procedure of coupling '//to_text(self%number)//' is not smooth'//place// &
                 ', so that its values do not tell its derivatives; smooth it, or let it return them', self%place)
    else
      call raise(err, exit_data, 'the user procedure of coupling '//to_text(self%number)//' gives numbers that are not finite'// &
                 place, self%place)
    end if
  end subroutine refuse

  !> The value or the second derivative, with two derivatives from differences.
  recursive subroutine differentiate(self, q, form, best)
    class(procedure_coupling_type), intent(in) :: self   !< the coupling
    real(wp), intent(in) :: q                            !< the first coordinate [rad, m]
    integer, intent(in) :: form                          !< of_value or of_second
    type(best_derivatives_type), intent(out) :: best     !< value of the function and its derivatives, if they are known
    real(wp) :: values(1, -half_width:half_width), between(1), h
    integer :: number, i
    logical :: good

    do number = 1, step_count
      h = trial_step(number, 1.0_wp)
      do i = -half_width, half_width
        values(1, i) = sample(self, q + i*h, form)
      end do
      between = sample(self, q + beside*h, form)
      call best%offer(values, between, h, good)
      if (good) exit
    end do
  end subroutine differentiate

  !> The procedure's value or its second derivative at one place.
  recursive real(wp) function sample(self, q, form)
    class(procedure_coupling_type), intent(in) :: self   !< the coupling
    real(wp), intent(in) :: q                            !< the first coordinate [rad, m]
    integer, intent(in) :: form                          !< of_value or of_second
    type(taylor) :: second
    type(best_derivatives_type) :: best

    if (.not. self%plain_values) then
      call find_taylor(self, q, second)
      sample = merge(second%value, second%second, form == of_value)
    else if (form == of_value) then
      call find_value(self, q, sample)
    else
      call differentiate(self, q, of_value, best)
      sample = merge(best%second(1), huge(sample), best%is_found)
    end if
  end function sample

  !> The numbers for the user's procedure.
  pure subroutine constants(self, values)
    class(procedure_coupling_type), intent(in) :: self   !< the coupling
    real(wp), allocatable, intent(out) :: values(:)      !< the numbers

    values = self%parameters
  end subroutine constants

  !> The derivative of a term, or of its derivative by its coordinate, by one parameter while the coordinate is held: differences to
  !> near round-off. It is NaN where the procedure has no finite values beside the present numbers.
  real(wp) function varied_term(self, change, i, q, order)
    class(procedure_coupling_type), intent(in) :: self   !< the coupling
    real(wp), intent(in) :: change(:)                    !< derivatives of the numbers
    integer, intent(in) :: i                             !< number of the term, 1 or 2
    real(wp), intent(in) :: q                            !< its coordinate [rad, m]
    integer, intent(in) :: order                         !< 0: of the term; 1, 2: of a derivative
    type(procedure_coupling_type) :: beside
    type(best_slopes_type) :: best
    type(error_type), allocatable :: err
    real(wp) :: values(1, -half_width:half_width), curve(0:curve_order), h
    integer :: number, j
    logical :: good

    varied_term = 0.0_wp
    if (i > 1) return
    beside = self
    do number = 1, step_count
      h = trial_step(number, length_along(self%parameters, change))
      do j = -half_width, half_width
        beside%parameters = self%parameters + j*h*change
        call beside%find_curve(q, curve, err)
        values(1, j) = -curve(order)
        if (allocated(err)) values(1, j) = ieee_value(h, ieee_quiet_nan)
      end do
      call best%offer(values, h, good)
      if (good) exit
    end do
    varied_term = ieee_value(h, ieee_quiet_nan)
    if (allocated(best%slopes)) varied_term = best%slopes(1)
  end function varied_term

  !> The name of the kind in the data file.
  pure function kind_name(self) result(name)
    class(procedure_coupling_type), intent(in) :: self   !< the coupling
    character(len=coupling_name_length) :: name

    name = 'user'
  end function kind_name
end module mech9_procedure_coupling
