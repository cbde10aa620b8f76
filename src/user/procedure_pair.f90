!> A pair given by a user's procedure, in either form.
module mech9_procedure_pair
  use, intrinsic :: ieee_arithmetic, only: ieee_is_finite, ieee_value, ieee_quiet_nan
  use mech9_kinds, only: wp
  use mech9_error, only: error_type, raise, exit_data
  use mech9_text, only: to_text
  use mech9_taylor, only: taylor, variable, sqrt, operator(+), operator(-), operator(*), operator(/)
  use mech9_differentiation, only: half_width, stencil_size, beside, step_count, trial_step, best_slopes_type, &
    best_derivatives_type, length_along
  use mech9_rotation, only: axial_vector, cross
  use mech9_pose, only: pose_type, pose_from_points
  use mech9_pair, only: pair_type, pair_motion_type, screw_factors_type, kind_name_length
  use mech9_registered_procedures, only: registered_procedure_type
  use mech9_registered_calls, only: call_pair
  use mech9_not_linked, only: not_linked
  use mech9_user_pair, only: user_pair
  use mech9_user_pair_values, only: user_pair_values
  implicit none
  private
  public :: procedure_pair_type, make_procedure_pair

  !> A pair by a user's procedure.
  type, extends(pair_type) :: procedure_pair_type
    real(wp), allocatable :: parameters(:)   !< numbers for the user's procedure
    type(registered_procedure_type) :: registered   !< the procedure, where it is not linked
    logical :: plain_values = .false.        !< it gives plain reals, not their derivatives
  contains
    procedure :: evaluate
    procedure :: as_screw
    procedure :: kind_name
    procedure :: user_calls
    procedure :: constants
    procedure :: vary
  end type procedure_pair_type

  !> Numbers of a motion: rotation by columns, origin, angular rate, rate, and their derivatives in the coordinate.
  integer, parameter :: numbers_of_motion = 24

contains

  !> Make the pair and find out which form of procedure there is. Fails where there is none.
  subroutine make_procedure_pair(coordinate, parameters, registered, pair, err)
    integer, intent(in) :: coordinate                   !< number of the pair and its coordinate
    real(wp), intent(in) :: parameters(:)               !< numbers for the user's procedure
    type(registered_procedure_type), intent(in) :: registered   !< the procedure; the linked one where it does not exist
    type(procedure_pair_type), intent(out) :: pair      !< the pair, without its links
    type(error_type), allocatable, intent(out) :: err   !< allocated if it failed
    type(taylor) :: r(3, 3)
    real(wp) :: v1(3), v2(3), v3(3)

    pair%coordinate = coordinate
    pair%angular = .false.
    pair%parameters = parameters
    pair%registered = registered
    call find_points(pair, 0.0_wp, r)
    if (registered%exists()) then
      pair%plain_values = .not. all(ieee_is_finite(r%first) .and. ieee_is_finite(r%second))
      return
    end if
    pair%plain_values = all(is_missing(r(:, 1)%value))
    if (.not. pair%plain_values) return
    call user_pair_values(coordinate, 0.0_wp, parameters, v1, v2, v3)
    if (all(is_missing(v1))) &
      call raise(err, exit_data, 'pair '//to_text(coordinate)//' asks for a user procedure, but none is linked; '// &
                 'see docs/how-to/user-procedures.md for how to write user_pair and link or register it')
  end subroutine make_procedure_pair

  !> Whether a number is the answer of a default procedure.
  elemental logical function is_missing(x)
    real(wp), intent(in) :: x   !< a number from a user's procedure

    is_missing = x <= not_linked
  end function is_missing

  !> The three points from the form with derivatives. A procedure that is registered may leave derivatives out, which are then not
  !> numbers.
  subroutine find_points(self, q, r)
    type(procedure_pair_type), intent(in) :: self   !< the procedure pair
    real(wp), intent(in) :: q                       !< value of the coordinate, in the user's unit
    type(taylor), intent(out) :: r(3, 3)            !< the three points by columns, with derivatives in q [m]

    if (self%registered%exists()) then
      call call_pair(self%registered, self%coordinate, q, self%parameters, r)
    else
      call user_pair(self%coordinate, variable(q), self%parameters, r(:, 1), r(:, 2), r(:, 3))
    end if
  end subroutine find_points

  !> The three points from the form in plain reals.
  subroutine find_plain_points(self, q, points)
    type(procedure_pair_type), intent(in) :: self   !< the procedure pair
    real(wp), intent(in) :: q                       !< value of the coordinate, in the user's unit
    real(wp), intent(out) :: points(3, 3)           !< the three points by columns [m]
    type(taylor) :: r(3, 3)

    if (self%registered%exists()) then
      call call_pair(self%registered, self%coordinate, q, self%parameters, r)
      points = r%value
    else
      call user_pair_values(self%coordinate, q, self%parameters, points(:, 1), points(:, 2), points(:, 3))
    end if
  end subroutine find_plain_points

  !> The motion from the procedure's three points. Fails where they are not finite, or lie on one line.
  subroutine evaluate(self, q, motion, err)
    class(procedure_pair_type), intent(in) :: self      !< the procedure pair
    real(wp), intent(in) :: q                           !< value of the coordinate, in the user's unit
    type(pair_motion_type), intent(out) :: motion       !< pose of the moving link and its derivatives in q
    type(error_type), allocatable, intent(out) :: err   !< allocated if it failed
    type(taylor) :: r(3, 3)
    type(pose_type) :: pose
    type(best_derivatives_type) :: best
    logical :: ok

    best%is_smooth = .true.
    if (self%plain_values) then
      call differentiate(self, q, best)
      r%value = reshape(best%value, [3, 3])
      r%first = reshape(best%first, [3, 3])
      r%second = reshape(best%second, [3, 3])
      ok = best%is_found
    else
      call find_points(self, q, r)
      ok = all(ieee_is_finite(r%value) .and. ieee_is_finite(r%first) .and. ieee_is_finite(r%second))
    end if
    if (.not. ok) then
      call raise(err, exit_data, 'the user procedure of pair '//to_text(self%coordinate)// &
                 ' gives numbers that are not finite at q = '//to_text(q, 12), self%place)
      return
    end if
    if (.not. best%is_smooth) then
      call raise(err, exit_data, 'the user procedure of pair '//to_text(self%coordinate)//' is not smooth at q = '// &
                 to_text(q, 12)//', so that its values do not tell its derivatives; smooth it, or let it return them', self%place)
      return
    end if
    call pose_from_points(r(:, 1)%value, r(:, 2)%value, r(:, 3)%value, pose, ok)
    if (.not. ok) then
      call raise(err, exit_data, 'the characteristic points of pair '//to_text(self%coordinate)// &
                 ' lie on one line at q = '//to_text(q, 12)//'; they must span a plane', self%place)
      return
    end if
    call motion_from_points(r, motion)
  end subroutine evaluate

  !> The pose by (3)-(6) with two derivatives in q, and the angular rates from them.
  pure subroutine motion_from_points(r, motion)
    type(taylor), intent(in) :: r(3, 3)             !< the three points by columns, with derivatives in q [m]
    type(pair_motion_type), intent(out) :: motion   !< pose of the moving link and its derivatives in q
    type(taylor) :: d(3), f(3), e(3, 3)
    real(wp) :: a(3, 3), a_first(3, 3), a_second(3, 3)

    d = r(:, 2) - r(:, 1)
    f = r(:, 3) - r(:, 1)
    e(:, 1) = unit_taylor(d)
    e(:, 2) = unit_taylor(cross_taylor(d, f))
    ! for points close to one line the product is perpendicular to d to few digits only
    e(:, 2) = unit_taylor(e(:, 2) - dot_taylor(e(:, 2), e(:, 1))*e(:, 1))
    e(:, 3) = cross_taylor(e(:, 1), e(:, 2))
    ! plain copies: gfortran 12 takes wrong strides in matmul with the transpose of a component of an array
    a = e%value
    a_first = e%first
    a_second = e%second
    motion%pose%r = a
    motion%pose%p = r(:, 1)%value
    motion%w = axial_vector(matmul(a_first, transpose(a)))
    motion%w_rate = axial_vector(matmul(a_second, transpose(a)))
    motion%v = r(:, 1)%first
    motion%v_rate = r(:, 1)%second
  end subroutine motion_from_points

  !> Vector product a x b.
  pure function cross_taylor(a, b) result(c)
    type(taylor), intent(in) :: a(3)   !< left factor
    type(taylor), intent(in) :: b(3)   !< right factor
    type(taylor) :: c(3)

    c(1) = a(2)*b(3) - a(3)*b(2)
    c(2) = a(3)*b(1) - a(1)*b(3)
    c(3) = a(1)*b(2) - a(2)*b(1)
  end function cross_taylor

  !> Scalar product of two vectors.
  pure type(taylor) function dot_taylor(a, b)
    type(taylor), intent(in) :: a(3)   !< one vector
    type(taylor), intent(in) :: b(3)   !< the other vector

    dot_taylor = a(1)*b(1) + a(2)*b(2) + a(3)*b(3)
  end function dot_taylor

  !> The vector at length one.
  pure function unit_taylor(a) result(e)
    type(taylor), intent(in) :: a(3)   !< a vector that is not zero
    type(taylor) :: e(3)

    e = a/sqrt(dot_taylor(a, a))
  end function unit_taylor

  !> Points and their derivatives from the form in plain reals.
  subroutine differentiate(self, q, best)
    type(procedure_pair_type), intent(in) :: self      !< the procedure pair
    real(wp), intent(in) :: q                          !< value of the coordinate, in the user's unit
    type(best_derivatives_type), intent(out) :: best   !< coordinates of the three points with derivatives in q, if they are known [m]
    real(wp) :: values(9, -half_width:half_width), between(9), points(3, 3), h
    integer :: number, i
    logical :: good

    do number = 1, step_count
      h = trial_step(number, 1.0_wp)
      do i = -half_width, half_width
        call find_plain_points(self, q + i*h, points)
        values(:, i) = reshape(points, [9])
      end do
      call find_plain_points(self, q + beside*h, points)
      between = reshape(points, [9])
      call best%offer(values, between, h, good)
      if (good) exit
    end do
  end subroutine differentiate

  !> A user's pair has no fixed axis that the program knows.
  pure subroutine as_screw(self, factors, is_screw)
    class(procedure_pair_type), intent(in) :: self     !< the procedure pair
    type(screw_factors_type), intent(out) :: factors   !< without meaning
    logical, intent(out) :: is_screw                   !< false

    is_screw = .false.
  end subroutine as_screw

  !> The name of the kind in the data file.
  pure function kind_name(self) result(name)
    class(procedure_pair_type), intent(in) :: self   !< the procedure pair
    character(len=kind_name_length) :: name

    name = 'user'
  end function kind_name

  !> One call, or those of a whole stencil.
  pure integer function user_calls(self)
    class(procedure_pair_type), intent(in) :: self   !< the procedure pair

    user_calls = merge(stencil_size, 1, self%plain_values)
  end function user_calls

  !> The numbers that the procedure receives.
  pure subroutine constants(self, values)
    class(procedure_pair_type), intent(in) :: self     !< the procedure pair
    real(wp), allocatable, intent(out) :: values(:)    !< numbers of the group &user

    values = self%parameters
  end subroutine constants

  !> The motion by a change of these numbers. The procedure knows nothing of derivatives by them: they come from differences over wide
  !> stencils, to near round-off. They are NaN where the procedure has no pose beside the present numbers.
  subroutine vary(self, change, q, twist)
    class(procedure_pair_type), intent(in) :: self   !< the procedure pair
    real(wp), intent(in) :: change(:)                !< derivatives of its numbers by a parameter
    real(wp), intent(in) :: q                        !< value of the coordinate, in the user's unit
    real(wp), intent(out) :: twist(6, 0:2)           !< rotation, and shift of the origin, of the moving link by the parameter [rad, m],
                                                     !< and two derivatives in q
    type(procedure_pair_type) :: beside
    type(pair_motion_type) :: motion
    type(best_slopes_type) :: best
    real(wp) :: values(numbers_of_motion, -half_width:half_width), h
    integer :: number, i
    logical :: good

    twist = ieee_value(q, ieee_quiet_nan)
    beside = self
    do number = 1, step_count
      h = trial_step(number, length_along(self%parameters, change))
      do i = -half_width, half_width
        beside%parameters = self%parameters + i*h*change
        call sample(beside, q, motion, values(:, i))
      end do
      call best%offer(values, h, good)
      if (good) exit
    end do
    if (.not. allocated(best%slopes)) return
    call sample(self, q, motion, values(:, 0))
    associate (slopes => best%slopes, p => motion%pose%p, w => motion%w, v => motion%v)
      twist(1:3, 0) = axial_vector(matmul(reshape(slopes(1:9), [3, 3]), transpose(motion%pose%r)))
      twist(1:3, 1) = slopes(13:15) + cross(w, twist(1:3, 0))
      twist(1:3, 2) = slopes(19:21) + cross(motion%w_rate, twist(1:3, 0)) + cross(w, twist(1:3, 1))
      twist(4:6, 0) = slopes(10:12) - cross(twist(1:3, 0), p)
      twist(4:6, 1) = slopes(16:18) - cross(twist(1:3, 1), p) - cross(twist(1:3, 0), v)
      twist(4:6, 2) = slopes(22:24) - cross(twist(1:3, 2), p) - 2.0_wp*cross(twist(1:3, 1), v) - cross(twist(1:3, 0), motion%v_rate)
    end associate
  end subroutine vary

  !> The motion of a pair, and its numbers in a row; NaN where there is none.
  subroutine sample(pair, q, motion, values)
    type(procedure_pair_type), intent(in) :: pair     !< the pair
    real(wp), intent(in) :: q                         !< its coordinate
    type(pair_motion_type), intent(out) :: motion     !< the motion
    real(wp), intent(out) :: values(:)                !< its numbers
    type(error_type), allocatable :: err

    call pair%evaluate(q, motion, err)
    values = [reshape(motion%pose%r, [9]), motion%pose%p, motion%w, motion%v, motion%w_rate, motion%v_rate]
    if (allocated(err)) values = ieee_value(q, ieee_quiet_nan)
  end subroutine sample
end module mech9_procedure_pair
