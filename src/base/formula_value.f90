!> Values of formulas and their derivatives along a direction, in forward mode: each result carries its rate of change with it.
!>
!> Nothing here raises a floating-point exception: what has no value, or no finite one, is found before.
module mech9_formula_value
  use mech9_kinds, only: wp
  use mech9_text, only: to_text
  use mech9_formula, only: formula_type, formula_problem_type, parse_formula, largest_value, step_number, step_variable, step_add, &
    step_subtract, step_multiply, step_divide, step_power, step_negate, step_function, function_names, takes_two
  implicit none
  private
  public :: evaluate_formula, evaluate_number, looks_like_formula

  !> A result with its derivatives by its operands.
  type :: slope_type
    real(wp) :: value = 0.0_wp
    real(wp) :: by(2) = 0.0_wp             !< derivatives by both operands
    logical :: exists(2) = .true.          !< these derivatives exist
    character(len=80) :: problem = ''      !< why there is no value
  end type slope_type

contains

  !> Evaluate a formula. `problem%words` is allocated where it has no value, or, with `direction`, no derivative along it.
  pure subroutine evaluate_formula(formula, variables, angle_unit, value, problem, direction, slope)
    type(formula_type), intent(in) :: formula              !< without problems
    real(wp), intent(in) :: variables(:)                   !< values of its variables, in the order of `formula%names`
    real(wp), intent(in) :: angle_unit                     !< unit of the angles of sin, atan2 and so on [rad]
    real(wp), intent(out) :: value                         !< of the formula
    type(formula_problem_type), intent(out) :: problem     !< the first problem
    real(wp), intent(in), optional :: direction(:)         !< (variables) their rates of change
    real(wp), intent(out), optional :: slope               !< rate of change of the value
    real(wp) :: stack(formula%depth), rates(formula%depth), a, b
    type(slope_type) :: found
    integer :: i, n
    logical :: two

    value = 0.0_wp
    if (present(slope)) slope = 0.0_wp
    rates = 0.0_wp
    n = 0
    do i = 1, size(formula%steps)
      associate (step => formula%steps(i))
        if (step%kind == step_number .or. step%kind == step_variable) then
          n = n + 1
          stack(n) = step%number
          rates(n) = 0.0_wp
          if (step%kind == step_variable) then
            stack(n) = variables(step%which)
            if (present(direction)) rates(n) = direction(step%which)
          end if
          cycle
        end if
        two = step%kind /= step_negate
        if (step%kind == step_function) two = takes_two(step%which)
        if (two) n = n - 1
        a = stack(n)
        b = 0.0_wp
        if (two) b = stack(n + 1)
        call carry_out(step%kind, step%which, a, b, angle_unit, found)
        if (found%problem == '' .and. abs(found%value) > largest_value) found%problem = 'the result is too large'
        if (found%problem == '' .and. present(direction)) call chain(found, rates(n:merge(n + 1, n, two)))
        if (found%problem /= '') then
          problem%words = trim(found%problem)
          problem%first = step%first
          problem%last = step%last
          return
        end if
        stack(n) = found%value
      end associate
    end do
    value = stack(1)
    if (present(slope)) slope = rates(1)
  end subroutine evaluate_formula

  !> Whether a text that is no plain number is meant as a formula of numbers: it has operators or parentheses, or is pi.
  pure logical function looks_like_formula(text)
    character(len=*), intent(in) :: text     !< without blanks around it

    looks_like_formula = text == 'pi'
    ! a / at the end is that of a data file, and quotes belong to texts
    if (len(text) == 0 .or. scan(text, '''"&=') > 0) return
    if (text(len(text):) /= '/') looks_like_formula = looks_like_formula .or. scan(text, '+-*/^(') > 0
  end function looks_like_formula

  !> Evaluate a formula of numbers alone.
  pure subroutine evaluate_number(text, angle_unit, value, problem)
    character(len=*), intent(in) :: text                   !< the formula
    real(wp), intent(in) :: angle_unit                     !< unit of the angles of sin, atan2 and so on [rad]
    real(wp), intent(out) :: value                         !< of the formula
    type(formula_problem_type), intent(out) :: problem     !< the first problem
    type(formula_type) :: formula
    real(wp) :: none(0)

    value = 0.0_wp
    call parse_formula(text, formula, problem)
    if (allocated(problem%words)) return
    if (size(formula%names) > 0) then
      problem%words = 'a formula here is of numbers alone, and '''//trim(formula%names(1))//''' is none'
      problem%first = formula%name_first(1)
      problem%last = problem%first + len_trim(formula%names(1)) - 1
    else
      call evaluate_formula(formula, none, angle_unit, value, problem)
    end if
  end subroutine evaluate_number

  !> Combine the rates of the operands to that of a result, which replaces that of the first operand.
  pure subroutine chain(found, rates)
    type(slope_type), intent(inout) :: found     !< the result with its derivatives; gets a problem
    real(wp), intent(inout) :: rates(:)          !< of the one or two operands
    real(wp) :: total
    integer :: i

    total = 0.0_wp
    if (size(rates) == 2 .and. .not. any(found%exists)) then
      ! the derivative of min and max exists where both sides are equal and go on equally
      if (abs(rates(1) - rates(size(rates))) <= 0.0_wp) then
        found%exists = .true.
        found%by = 0.5_wp
      end if
    end if
    do i = 1, size(rates)
      if (.not. abs(rates(i)) > 0.0_wp) cycle
      if (.not. found%exists(i) .or. abs(found%by(i)) > largest_value .or. abs(rates(i)) > largest_value) then
        found%problem = 'it has no derivative here'
        return
      end if
      total = total + found%by(i)*rates(i)
    end do
    rates(1) = total
  end subroutine chain

  !> Carry out one step.
  pure subroutine carry_out(kind, which, a, b, angle_unit, found)
    integer, intent(in) :: kind                !< of the step
    integer, intent(in) :: which               !< number of the function
    real(wp), intent(in) :: a                  !< first operand, at most `largest_value`
    real(wp), intent(in) :: b                  !< second operand, at most `largest_value`
    real(wp), intent(in) :: angle_unit         !< unit of angles [rad]
    type(slope_type), intent(out) :: found     !< the result

    select case (kind)
    case (step_add)
      found = slope_type(a + b, [1.0_wp, 1.0_wp])
    case (step_subtract)
      found = slope_type(a - b, [1.0_wp, -1.0_wp])
    case (step_multiply)
      found = slope_type(a*b, [b, a])
    case (step_divide)
      call divide(a, b, found)
    case (step_power)
      call raise_to(a, b, found)
    case (step_negate)
      found = slope_type(-a, [-1.0_wp, 0.0_wp])
    case (step_function)
      if (takes_two(which)) then
        call find_of_two(trim(function_names(which)), a, b, angle_unit, found)
      else
        call find_function(trim(function_names(which)), a, angle_unit, found)
      end if
    end select
  end subroutine carry_out

  !> A quotient.
  pure subroutine divide(a, b, found)
    real(wp), intent(in) :: a                  !< first operand
    real(wp), intent(in) :: b                  !< second operand
    type(slope_type), intent(inout) :: found   !< the result

    if (.not. abs(b) > 0.0_wp) then
      found%problem = 'this divides by zero'
    else if (abs(b) < 1.0_wp/largest_value .or. abs(b)*largest_value < abs(a)) then
      found%problem = 'the result is too large'
    else
      found%value = a/b
      found%by = [1.0_wp/b, -(a/b)/b]
    end if
  end subroutine divide

  !> A power.
  pure subroutine raise_to(a, b, found)
    real(wp), intent(in) :: a                  !< first operand
    real(wp), intent(in) :: b                  !< second operand
    type(slope_type), intent(inout) :: found   !< the result

    if (a < 0.0_wp .and. abs(b - anint(b)) > 0.0_wp) then
      found%problem = 'a power with a broken exponent of a negative number, '//to_text(a)
    else if (.not. abs(a) > 0.0_wp) then
      if (b < 0.0_wp) then
        found%problem = 'this divides by zero'
        return
      end if
      if (.not. b > 0.0_wp) found%value = 1.0_wp
      if (abs(b - 1.0_wp) <= 0.0_wp) found%by(1) = 1.0_wp
      found%exists = [b >= 1.0_wp .or. .not. b > 0.0_wp, b > 0.0_wp]
    else if (b*log(abs(a)) > log(largest_value)) then
      found%problem = 'the result is too large'
    else
      found%value = a**b
      found%by(1) = b*(found%value/a)
      found%exists(1) = abs(a) > 1.0_wp/largest_value
      if (a > 0.0_wp) found%by(2) = found%value*log(a)
      found%exists(2) = a > 0.0_wp
    end if
  end subroutine raise_to

  !> A function of one operand.
  pure subroutine find_function(name, a, unit, found)
    character(len=*), intent(in) :: name       !< of the function
    real(wp), intent(in) :: a                  !< operand
    real(wp), intent(in) :: unit               !< unit of angles [rad]
    type(slope_type), intent(inout) :: found   !< the result

    select case (name)
    case ('sqrt')
      if (a < 0.0_wp) found%problem = 'the square root of a negative number, '//to_text(a)
      if (a < 0.0_wp) return
      found%value = sqrt(a)
      found%exists(1) = a > 0.0_wp
      if (a > 0.0_wp) found%by(1) = 0.5_wp/found%value
    case ('sin', 'cos', 'tan')
      call find_of_angle(name, a, unit, found)
    case ('asin', 'acos')
      if (abs(a) > 1.0_wp) found%problem = 'the '//name//' of a number beyond 1, '//to_text(a)
      if (abs(a) > 1.0_wp) return
      found%value = merge(asin(a), acos(a), name == 'asin')/unit
      found%exists(1) = abs(a) < 1.0_wp
      if (found%exists(1)) found%by(1) = merge(1.0_wp, -1.0_wp, name == 'asin')/(unit*sqrt((1.0_wp - a)*(1.0_wp + a)))
    case ('atan')
      found%value = atan(a)/unit
      found%by(1) = 1.0_wp/(unit*(1.0_wp + a*a))
    case ('exp')
      if (a > log(largest_value)) found%problem = 'the result is too large'
      if (a > log(largest_value)) return
      found%value = exp(a)
      found%by(1) = found%value
    case ('log')
      if (.not. a > 0.0_wp) found%problem = 'the logarithm of a number that is not positive, '//to_text(a)
      if (.not. a > 0.0_wp) return
      found%value = log(a)
      found%exists(1) = a > 1.0_wp/largest_value
      if (found%exists(1)) found%by(1) = 1.0_wp/a
    case ('abs')
      found%value = abs(a)
      found%by(1) = sign(1.0_wp, a)
      found%exists(1) = abs(a) > 0.0_wp
    end select
  end subroutine find_function

  !> A function of an angle.
  pure subroutine find_of_angle(name, a, unit, found)
    character(len=*), intent(in) :: name       !< of the function
    real(wp), intent(in) :: a                  !< operand
    real(wp), intent(in) :: unit               !< unit of angles [rad]
    type(slope_type), intent(inout) :: found   !< the result
    real(wp) :: s, c

    s = sin(a*unit)
    c = cos(a*unit)
    select case (name)
    case ('sin')
      found%value = s
      found%by(1) = c*unit
    case ('cos')
      found%value = c
      found%by(1) = -s*unit
    case default
      found%value = s/c        ! no number of floating point is a pole
      found%by(1) = unit*(1.0_wp + found%value**2)
    end select
  end subroutine find_of_angle

  !> A function of two operands.
  pure subroutine find_of_two(name, a, b, unit, found)
    character(len=*), intent(in) :: name       !< of the function
    real(wp), intent(in) :: a                  !< first operand
    real(wp), intent(in) :: b                  !< second operand
    real(wp), intent(in) :: unit               !< unit of angles [rad]
    type(slope_type), intent(inout) :: found   !< the result
    real(wp) :: largest

    select case (name)
    case ('atan2')
      largest = max(abs(a), abs(b))
      if (.not. largest > 0.0_wp) then
        found%problem = 'atan2(0, 0) is no angle'
        return
      end if
      found%value = atan2(a, b)/unit
      found%exists = largest > 1.0_wp/largest_value
      if (all(found%exists)) found%by = [b/largest, -(a/largest)]/(unit*largest*((a/largest)**2 + (b/largest)**2))
    case default
      found%value = merge(min(a, b), max(a, b), name == 'min')
      found%exists = abs(a - b) > 0.0_wp
      found%by = merge([1.0_wp, 0.0_wp], [0.0_wp, 1.0_wp], (a < b) .eqv. (name == 'min'))
    end select
  end subroutine find_of_two
end module mech9_formula_value
