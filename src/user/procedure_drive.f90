!> A drive given by a user's procedure, in either form.
module mech9_procedure_drive
  use, intrinsic :: ieee_arithmetic, only: ieee_is_finite, ieee_value, ieee_quiet_nan
  use mech9_kinds, only: wp
  use mech9_error, only: error_type, raise, exit_data
  use mech9_text, only: to_text
  use mech9_taylor, only: taylor, variable
  use mech9_differentiation, only: half_width, beside, step_count, trial_step, best_slopes_type, best_derivatives_type, &
    length_along
  use mech9_law, only: law_type
  use mech9_registered_procedures, only: registered_procedure_type
  use mech9_registered_calls, only: call_function
  use mech9_not_linked, only: not_linked
  use mech9_user_drive, only: user_drive
  use mech9_user_drive_values, only: user_drive_values
  implicit none
  private
  public :: procedure_drive_type, make_procedure_drive

  !> A drive by a user's procedure.
  type, extends(law_type) :: procedure_drive_type
    real(wp), allocatable :: parameters(:)   !< numbers for the user's procedure
    type(registered_procedure_type) :: registered   !< the procedure, where it is not linked
    logical :: plain_values = .false.        !< it gives plain reals, not their derivatives
  contains
    procedure :: evaluate
    procedure :: constants
    procedure :: vary
  end type procedure_drive_type

contains

  !> Make the drive and find out which form of procedure there is. Fails where there is none.
  subroutine make_procedure_drive(coordinate, start, parameters, registered, drive, err)
    integer, intent(in) :: coordinate                   !< number of the coordinate that is driven
    real(wp), intent(in) :: start                       !< a time at which the procedure may be called [s]
    real(wp), intent(in) :: parameters(:)               !< numbers for the user's procedure
    type(registered_procedure_type), intent(in) :: registered   !< the procedure; the linked one where it does not exist
    type(procedure_drive_type), intent(out) :: drive    !< the drive
    type(error_type), allocatable, intent(out) :: err   !< allocated if it failed
    type(taylor) :: q
    real(wp) :: value

    drive%coordinate = coordinate
    drive%parameters = parameters
    drive%registered = registered
    call find_taylor(drive, start, q)
    if (registered%exists()) then
      drive%plain_values = .not. (ieee_is_finite(q%first) .and. ieee_is_finite(q%second))
      return
    end if
    drive%plain_values = q%value <= not_linked
    if (.not. drive%plain_values) return
    call user_drive_values(coordinate, start, parameters, value)
    if (value <= not_linked) &
      call raise(err, exit_data, 'the drive of coordinate '//to_text(coordinate)//' asks for a user procedure, '// &
                 'but none is linked; see docs/how-to/user-procedures.md for how to write user_drive and link or register it')
  end subroutine make_procedure_drive

  !> Value and derivatives from the form with derivatives. A procedure that is registered may leave derivatives out, which are then
  !> not numbers.
  subroutine find_taylor(self, t, x)
    type(procedure_drive_type), intent(in) :: self   !< the procedure drive
    real(wp), intent(in) :: t                        !< time [s]
    type(taylor), intent(out) :: x                   !< the coordinate with its derivatives in time

    if (self%registered%exists()) then
      call call_function(self%registered, self%coordinate, t, self%parameters, x)
    else
      call user_drive(self%coordinate, variable(t), self%parameters, x)
    end if
  end subroutine find_taylor

  !> The value from the form in plain reals.
  subroutine find_value(self, t, value)
    type(procedure_drive_type), intent(in) :: self   !< the procedure drive
    real(wp), intent(in) :: t                        !< time [s]
    real(wp), intent(out) :: value                   !< the coordinate [rad, m]
    type(taylor) :: x

    if (self%registered%exists()) then
      call call_function(self%registered, self%coordinate, t, self%parameters, x)
      value = x%value
    else
      call user_drive_values(self%coordinate, t, self%parameters, value)
    end if
  end subroutine find_value

  !> The procedure's value and derivatives. Fails where they are not finite.
  subroutine evaluate(self, t, q, dq, ddq, err)
    class(procedure_drive_type), intent(in) :: self     !< the procedure drive
    real(wp), intent(in) :: t                           !< time [s]
    real(wp), intent(out) :: q                          !< the coordinate [rad, m]
    real(wp), intent(out) :: dq                         !< its rate [rad/s, m/s]
    real(wp), intent(out) :: ddq                        !< its acceleration [rad/s^2, m/s^2]
    type(error_type), allocatable, intent(out) :: err   !< allocated if it failed
    type(best_derivatives_type) :: best
    type(taylor) :: x
    logical :: ok

    best%is_smooth = .true.
    if (self%plain_values) then
      call differentiate(self, t, best)
      x = taylor(best%value(1), best%first(1), best%second(1))
      ok = best%is_found
    else
      call find_taylor(self, t, x)
      ok = ieee_is_finite(x%value) .and. ieee_is_finite(x%first) .and. ieee_is_finite(x%second)
    end if
    q = x%value
    dq = x%first
    ddq = x%second
    if (.not. ok) &
      call raise(err, exit_data, 'the user procedure of the drive of coordinate '//to_text(self%coordinate)// &
                 ' gives numbers that are not finite at t = '//to_text(t, 12), self%place)
    if (ok .and. .not. best%is_smooth) &
      call raise(err, exit_data, 'the user procedure of the drive of coordinate '//to_text(self%coordinate)// &
                 ' is not smooth at t = '//to_text(t, 12)//', so that its values do not tell its derivatives; smooth it, '// &
                 'or let it return them', self%place)
  end subroutine evaluate

  !> The numbers for the user's procedure.
  pure subroutine constants(self, values)
    class(procedure_drive_type), intent(in) :: self  !< the procedure drive
    real(wp), allocatable, intent(out) :: values(:)  !< the numbers

    values = self%parameters
  end subroutine constants

  !> The derivatives by one parameter, from those of the numbers for the procedure: differences to near round-off. They are NaN where
  !> the procedure has no finite values beside the present numbers.
  subroutine vary(self, change, t, q, dq, ddq)
    class(procedure_drive_type), intent(in) :: self   !< the procedure drive
    real(wp), intent(in) :: change(:)                 !< derivatives of the numbers
    real(wp), intent(in) :: t                         !< time [s]
    real(wp), intent(out) :: q                        !< derivative of the coordinate [rad, m]
    real(wp), intent(out) :: dq                       !< derivative of its rate [rad/s, m/s]
    real(wp), intent(out) :: ddq                      !< derivative of its acceleration [rad/s^2, m/s^2]
    type(procedure_drive_type) :: beside
    type(best_slopes_type) :: best
    type(error_type), allocatable :: err
    real(wp) :: values(3, -half_width:half_width), h
    integer :: number, i
    logical :: good

    beside = self
    do number = 1, step_count
      h = trial_step(number, length_along(self%parameters, change))
      values = ieee_value(h, ieee_quiet_nan)
      do i = -half_width, half_width
        beside%parameters = self%parameters + i*h*change
        call beside%evaluate(t, values(1, i), values(2, i), values(3, i), err)
        if (allocated(err)) values(:, i) = ieee_value(h, ieee_quiet_nan)
      end do
      call best%offer(values, h, good)
      if (good) exit
    end do
    if (.not. allocated(best%slopes)) best%slopes = values(:, 0)
    q = best%slopes(1)
    dq = best%slopes(2)
    ddq = best%slopes(3)
  end subroutine vary

  !> Value and derivatives from the form in plain reals.
  subroutine differentiate(self, t, best)
    type(procedure_drive_type), intent(in) :: self         !< the procedure drive
    real(wp), intent(in) :: t                              !< time [s]
    type(best_derivatives_type), intent(out) :: best       !< the coordinate with its derivatives in time, if they are known
    real(wp) :: values(1, -half_width:half_width), between(1), h
    integer :: number, i
    logical :: good

    do number = 1, step_count
      h = trial_step(number, 1.0_wp)
      do i = -half_width, half_width
        call find_value(self, t + i*h, values(1, i))
      end do
      call find_value(self, t + beside*h, between(1))
      call best%offer(values, between, h, good)
      if (good) exit
    end do
  end subroutine differentiate
end module mech9_procedure_drive
