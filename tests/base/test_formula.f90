!> Formulas of numbers: their values and derivatives against closed forms, the places of their errors, and numbers without derivatives.
module test_formula
  use mech9_kinds, only: wp, radians_per_degree
  use mech9_text, only: to_text
  use mech9_formula, only: formula_type, formula_problem_type, parse_formula
  use mech9_formula_value, only: evaluate_formula, evaluate_number
  use mech9_testing, only: tester_type
  implicit none
  private
  public :: run

  real(wp), parameter :: x = 0.7_wp, y = 1.9_wp
  real(wp), parameter :: round_off = 8.0_wp*epsilon(1.0_wp)    !< a few units of it in values of order one

contains

  !> Run the cases of this suite.
  subroutine run(tester)
    type(tester_type), intent(inout) :: tester   !< selects cases and counts their checks

    if (tester%runs('binding of operators')) call binding(tester)
    if (tester%runs('derivatives')) call derivatives(tester)
    if (tester%runs('angles in degrees')) call degrees(tester)
    if (tester%runs('places of errors')) call places(tester)
    if (tester%runs('no value')) call no_value(tester)
    if (tester%runs('no derivative')) call no_derivative(tester)
  end subroutine run

  !> Signs bind less than powers, powers are joined from the right, quotients from the left.
  subroutine binding(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks

    call number(tester, '-2^2', -4.0_wp)
    call number(tester, '2^3^2', 512.0_wp)
    call number(tester, '2^-2', 0.25_wp)
    call number(tester, '2**3', 8.0_wp)
    call number(tester, '8/4/2', 1.0_wp)
    call number(tester, '8-4-2', 2.0_wp)
    call number(tester, '2*-3', -6.0_wp)
    call number(tester, '--3', 3.0_wp)
    call number(tester, ' ( 1 + 2 ) * 3e0 ', 9.0_wp)
    call number(tester, 'min(3, 1, 2) + max(3,1,5)', 6.0_wp)
    call number(tester, '.5d1 + 5.E-1', 5.5_wp)
    call number(tester, 'atan2(1, -1)', 2.356194490192344928847_wp)
    call number(tester, 'Sqrt(4)*MAX(1, 2)', 4.0_wp)
    call number(tester, 'sqrt (16) + exp(0) + log(1) + abs(-3)', 8.0_wp)
  end subroutine binding

  !> Check the value of a formula of numbers.
  subroutine number(tester, text, expected)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    character(len=*), intent(in) :: text         !< the formula
    real(wp), intent(in) :: expected             !< its value
    type(formula_problem_type) :: problem
    real(wp) :: value

    call evaluate_number(text, 1.0_wp, value, problem)
    call tester%is_true(.not. allocated(problem%words), text//' has a value')
    call tester%near(value, expected, round_off, text)
  end subroutine number

  !> Derivatives by x and y.
  subroutine derivatives(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks

    call slopes(tester, 'x*y - x/y', y - 1.0_wp/y, x + x/y**2)
    call slopes(tester, '-x^y', -y*x**(y - 1.0_wp), -x**y*log(x))
    call slopes(tester, 'sqrt(x^2 + y^2)', x/hypot(x, y), y/hypot(x, y))
    call slopes(tester, 'sin(x)*cos(y) + tan(x)', cos(x)*cos(y) + 1.0_wp/cos(x)**2, -sin(x)*sin(y))
    call slopes(tester, 'asin(x) + acos(x/y) + atan(y)', 1.0_wp/sqrt(1.0_wp - x**2) - 1.0_wp/sqrt(y**2 - x**2), &
                x/(y*sqrt(y**2 - x**2)) + 1.0_wp/(1.0_wp + y**2))
    call slopes(tester, 'atan2(x, y)', y/(x**2 + y**2), -x/(x**2 + y**2))
    call slopes(tester, 'exp(x*y) + log(y)', y*exp(x*y), x*exp(x*y) + 1.0_wp/y)
    call slopes(tester, 'abs(x - y) + min(x, y) + max(2*x, y)', 0.0_wp, 2.0_wp)
    call slopes(tester, '(x - 0.7)^2 + 0*sqrt(x - x) + (y - 1.9)^1', 0.0_wp, 1.0_wp)
    call slopes(tester, 'min(x, x) + max(x + y, y + x)', 2.0_wp, 1.0_wp)
    call slopes(tester, '(-x)^3*0^0', -3.0_wp*x**2, 0.0_wp)
  end subroutine derivatives

  !> Check the derivatives of a formula by x and y, and that along a direction between them.
  subroutine slopes(tester, text, by_x, by_y)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    character(len=*), intent(in) :: text         !< the formula
    real(wp), intent(in) :: by_x                 !< its derivative by x
    real(wp), intent(in) :: by_y                 !< its derivative by y

    call tester%near(slope_of(text, [1.0_wp, 0.0_wp]), by_x, round_off, 'by x: '//text)
    call tester%near(slope_of(text, [0.0_wp, 1.0_wp]), by_y, round_off, 'by y: '//text)
    call tester%near(slope_of(text, [2.0_wp, -3.0_wp]), 2.0_wp*by_x - 3.0_wp*by_y, 2.0_wp*round_off, 'along both: '//text)
  end subroutine slopes

  !> The derivative of a formula of x and y along a direction; huge where it has none.
  real(wp) function slope_of(text, direction) result(slope)
    character(len=*), intent(in) :: text           !< the formula
    real(wp), intent(in) :: direction(2)           !< rates of x and y
    type(formula_type) :: formula
    type(formula_problem_type) :: problem
    real(wp) :: value
    integer :: i

    slope = huge(slope)
    call parse_formula(text, formula, problem)
    if (allocated(problem%words)) return
    call evaluate_formula(formula, [(merge(x, y, formula%names(i) == 'x'), i=1, size(formula%names))], 1.0_wp, value, problem, &
                          [(direction(merge(1, 2, formula%names(i) == 'x')), i=1, size(formula%names))], slope)
    if (allocated(problem%words)) slope = huge(slope)
  end function slope_of

  !> Angles are in the unit of the data file, in and out.
  subroutine degrees(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(formula_problem_type) :: problem
    type(formula_type) :: formula
    real(wp) :: value, slope

    call evaluate_number('sin(30) + acos(0.5) + atan2(-1, 0) + tan(45)', radians_per_degree, value, problem)
    call tester%near(value, 0.5_wp + 60.0_wp - 90.0_wp + 1.0_wp, 100.0_wp*round_off, 'angles in degrees')
    call parse_formula('asin(x) + cos(x)', formula, problem)
    call evaluate_formula(formula, [0.6_wp], radians_per_degree, value, problem, [1.0_wp], slope)
    call tester%near(slope, 1.25_wp/radians_per_degree - radians_per_degree*sin(0.6_wp*radians_per_degree), round_off, &
                     'derivatives by degrees')
  end subroutine degrees

  !> Errors stand at the first byte that is wrong.
  subroutine places(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    integer :: i

    call problem_at(tester, '', 1, 'is missing here')
    call problem_at(tester, '2*(3+', 5, 'is missing here')
    call problem_at(tester, '2*(3+4', 3, 'not closed')
    call problem_at(tester, '2)', 2, 'closes none')
    call problem_at(tester, '1, 2', 2, 'comma')
    call problem_at(tester, '1 2', 3, 'operator')
    call problem_at(tester, '1 + foo(2)', 5, 'no function ''foo''')
    call problem_at(tester, '3*atan2(1)', 3, 'two operands')
    call problem_at(tester, 'atan2(1,2,3)', 1, 'two operands')
    call problem_at(tester, 'sin(1, 2)', 1, 'one operand')
    call problem_at(tester, '1..2', 1, 'not a number')
    call problem_at(tester, '1 + 1e999', 5, 'too large')
    call problem_at(tester, '2 $ 3', 3, 'operator')
    call problem_at(tester, '* 3', 1, 'is missing here')
    call problem_at(tester, repeat('(', 300)//'1', 101, 'more than 100')
    call problem_at(tester, repeat('-', 300)//'1', 101, 'more than 100')
    call problem_at(tester, repeat('2^', 300)//'1', 202, 'more than 100')
    call number(tester, repeat('1+', 2000)//'1', 2001.0_wp)
    do i = 1, 255
      call problem_at(tester, '7'//achar(modulo(i, 128))//'(', 0, '')
    end do
  end subroutine places

  !> Check that a formula has a problem, at a byte; 0: anywhere.
  subroutine problem_at(tester, text, at, words)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    character(len=*), intent(in) :: text         !< the formula
    integer, intent(in) :: at                    !< first byte of the problem
    character(len=*), intent(in) :: words        !< a part of the message
    type(formula_problem_type) :: problem
    real(wp) :: value

    call evaluate_number(text, 1.0_wp, value, problem)
    call tester%is_true(allocated(problem%words), 'a problem is told: '//text)
    if (.not. allocated(problem%words)) return
    call tester%is_true(index(problem%words, words) > 0, text//' is told by: '//words)
    call tester%is_true(problem%first <= problem%last .and. problem%last <= max(1, len(text)), 'the place is in the text: '//text)
    if (at > 0) call tester%is_true(problem%first == at, text//' is wrong at byte '//to_text(at)//', not '//to_text(problem%first))
  end subroutine problem_at

  !> Formulas without a value, or without one of floating point, are told at the operator, without a trap.
  subroutine no_value(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks

    call problem_at(tester, '1 + sqrt(-3)', 5, 'square root of a negative number, -3')
    call problem_at(tester, '1/(2-2)', 2, 'divides by zero')
    call problem_at(tester, '0^-1', 2, 'divides by zero')
    call problem_at(tester, '(-8)^(1/3)', 5, 'broken exponent')
    call problem_at(tester, 'log(0)', 1, 'not positive')
    call problem_at(tester, 'log(-1)', 1, 'not positive')
    call problem_at(tester, 'asin(1.1)', 1, 'beyond 1')
    call problem_at(tester, 'acos(-1.1)', 1, 'beyond 1')
    call problem_at(tester, 'atan2(0, 0)', 1, 'no angle')
    call problem_at(tester, 'exp(1000)', 1, 'too large')
    call problem_at(tester, '10^100*10^100', 7, 'too large')
    call problem_at(tester, '10^200', 3, 'too large')
    call problem_at(tester, '1e140/1e-140', 6, 'too large')
    call problem_at(tester, '1/1e-140/1e-140', 9, 'too large')
  end subroutine no_value

  !> Kinks and vertical tangents are told, where the direction passes them.
  subroutine no_derivative(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    character(len=*), parameter :: texts(8) = [character(len=18) :: 'abs(x - 0.7)', 'min(x, 0.7)', 'max(x, y - 1.2)', &
      'sqrt(x - 0.7)', '(x - 0.7)^0.5', 'asin(x/0.7)', 'acos(-x/0.7)', '(-2)^(x + 1.3)']
    integer :: i

    do i = 1, size(texts)
      call tester%is_true(slope_of(trim(texts(i)), [1.0_wp, 0.0_wp]) > 1.0e300_wp, 'no derivative by x: '//trim(texts(i)))
      if (i /= 3) call tester%near(slope_of(trim(texts(i)), [0.0_wp, 1.0_wp]), 0.0_wp, 0.0_wp, 'but by y: '//trim(texts(i)))
    end do
  end subroutine no_derivative
end module test_formula
