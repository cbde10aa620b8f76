!> A drive given by a user's procedure, in either form.
module mech9_procedure_drive
  use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
  use mech9_kinds, only: wp
  use mech9_error, only: error_type, raise, exit_data
  use mech9_text, only: to_text
  use mech9_taylor, only: taylor, variable
  use mech9_differentiation, only: half_width, step_count, trial_step, derivatives_from_stencil
  use mech9_drive, only: drive_type
  use mech9_not_linked, only: not_linked
  use mech9_user_drive, only: user_drive
  use mech9_user_drive_values, only: user_drive_values
  implicit none
  private
  public :: procedure_drive_type, make_procedure_drive

  type, extends(drive_type) :: procedure_drive_type
    real(wp), allocatable :: parameters(:)   !< handed to the user's procedure
    logical :: plain_values = .false.        !< the form in plain reals is linked, not the one in Taylor arithmetic
  contains
    procedure :: evaluate
  end type procedure_drive_type

contains

  !> Make the drive and find out which form of procedure is linked. Fails where none is.
  subroutine make_procedure_drive(coordinate, start, parameters, drive, err)
    integer, intent(in) :: coordinate
    real(wp), intent(in) :: start             !< a time at which the procedure may be called [s]
    real(wp), intent(in) :: parameters(:)
    type(procedure_drive_type), intent(out) :: drive
    type(error_type), allocatable, intent(out) :: err   !< allocated if it failed
    type(taylor) :: q
    real(wp) :: value

    drive%coordinate = coordinate
    drive%parameters = parameters
    call user_drive(coordinate, variable(start), parameters, q)
    drive%plain_values = q%value <= not_linked
    if (.not. drive%plain_values) return
    call user_drive_values(coordinate, start, parameters, value)
    if (value <= not_linked) &
      call raise(err, exit_data, 'the drive of coordinate '//to_text(coordinate)//' asks for a user procedure, '// &
                 'but none is linked; see docs/user-procedures.md for how to write user_drive and link it')
  end subroutine make_procedure_drive

  subroutine evaluate(self, t, q, dq, ddq, err)
    class(procedure_drive_type), intent(in) :: self   !< the procedure drive
    real(wp), intent(in) :: t
    real(wp), intent(out) :: q, dq, ddq
    type(error_type), allocatable, intent(out) :: err   !< allocated if it failed
    type(taylor) :: x
    logical :: ok

    if (self%plain_values) then
      call differentiate(self, t, x, ok)
    else
      call user_drive(self%coordinate, variable(t), self%parameters, x)
      ok = ieee_is_finite(x%value) .and. ieee_is_finite(x%first) .and. ieee_is_finite(x%second)
    end if
    q = x%value
    dq = x%first
    ddq = x%second
    if (.not. ok) &
      call raise(err, exit_data, 'the user procedure of the drive of coordinate '//to_text(self%coordinate)// &
                 ' gives numbers that are not finite at t = '//to_text(t, 12), self%place)
  end subroutine evaluate

  !> Value and derivatives from the form in plain reals: the widest stencil that is at round-off is
  !> taken, or the best of all. `ok` is false where no stencil has finite values.
  subroutine differentiate(self, t, x, ok)
    type(procedure_drive_type), intent(in) :: self   !< the procedure drive
    real(wp), intent(in) :: t
    type(taylor), intent(out) :: x
    logical, intent(out) :: ok
    real(wp) :: values(-half_width:half_width), h, first, second, error, best
    integer :: number, i

    best = huge(best)
    do number = 1, step_count
      h = trial_step(number, 1.0_wp)
      do i = -half_width, half_width
        call user_drive_values(self%coordinate, t + i*h, self%parameters, values(i))
      end do
      if (.not. all(ieee_is_finite(values))) cycle   ! too wide: outside the procedure's domain
      call derivatives_from_stencil(values, h, first, second, error)
      if (error < best) then
        best = error
        x = taylor(values(0), first, second)
      end if
      ! good enough, or truncation is below round-off, which only grows as steps get narrower
      if (error <= max(1.0e-12_wp, 16.0_wp*epsilon(h)/h**2)*maxval(abs(values))) exit
    end do
    ok = best < huge(best)
  end subroutine differentiate
end module mech9_procedure_drive
