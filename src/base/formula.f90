!> Formulas of numbers: text such as 'sqrt(a^2 + b^2)' as a list of steps, which mech9_formula_value carries out.
!>
!> The text is taken apart by recursive descent, one procedure for each level of binding: sums, products, signs, powers. Signs bind
!> less than powers, and powers are joined from the right: -2^2 is -4, and 2^3^2 is 2^9.
module mech9_formula
  use mech9_kinds, only: wp
  use mech9_text, only: to_text, lower
  implicit none
  private
  public :: formula_type, formula_problem_type, parse_formula, longest_variable, largest_value, no_operand
  public :: step_number, step_variable, step_add, step_subtract, step_multiply, step_divide, step_power, step_negate, &
    step_function, function_names, takes_two, number_of_function

  !> Kinds of steps. Those with two operands take the two last results, the others the last one.
  integer, parameter :: step_number = 1, step_variable = 2, step_add = 3, step_subtract = 4, step_multiply = 5, &
    step_divide = 6, step_power = 7, step_negate = 8, step_function = 9

  character(len=5), parameter :: function_names(13) = [character(len=5) :: 'sqrt', 'sin', 'cos', 'tan', 'asin', 'acos', 'atan', &
                                                      'exp', 'log', 'abs', 'atan2', 'min', 'max']
  integer, parameter :: first_of_two = 11             !< this function and those after it take two operands

  integer, parameter :: longest_variable = 40         !< letters of the name of a variable
  integer, parameter :: deepest = 100                 !< most parentheses, signs and powers within each other
  integer, parameter :: longest_number = 40           !< most digits of a number
  !> Values beyond it are too large: products of two smaller ones stay within the range of floating point.
  real(wp), parameter :: largest_value = 1.0e150_wp
  integer, parameter :: largest_exponent = 140        !< of a number that is written
  real(wp), parameter :: pi = 3.14159265358979323846_wp

  character(len=*), parameter :: digits = '0123456789'
  character(len=*), parameter :: letters = 'abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ_'
  character(len=*), parameter :: no_operand = 'a number or a name is missing here'

  !> A step: what it does, and the bytes of the text from which it comes.
  type :: step_type
    integer :: kind = 0
    integer :: which = 0             !< number of the variable or the function
    real(wp) :: number = 0.0_wp      !< of step_number
    integer :: first = 0             !< first byte
    integer :: last = 0              !< last byte
  end type step_type

  type :: formula_type
    type(step_type), allocatable :: steps(:)
    character(len=longest_variable), allocatable :: names(:)   !< of its variables, in the order in which they first stand there
    integer, allocatable :: name_first(:)                      !< first byte of each variable where it first stands
    integer :: depth = 0                                       !< most results that wait at a time
  end type formula_type

  !> A problem of a formula, and its place in the text.
  type :: formula_problem_type
    character(len=:), allocatable :: words   !< not allocated where nothing is wrong
    integer :: first = 0                     !< first byte
    integer :: last = 0                      !< last byte
  end type formula_problem_type

  !> A text that is taken apart.
  type :: reading_type
    integer :: at = 1          !< the next byte
    integer :: depth = 0       !< of parentheses, signs and powers
    integer :: waiting = 0     !< results that wait
    integer :: steps = 0       !< number of steps that are used
  end type reading_type

contains

  !> Take the text of a formula apart. `problem%words` is allocated where it has none.
  pure subroutine parse_formula(text, formula, problem)
    character(len=*), intent(in) :: text                   !< the formula
    type(formula_type), intent(out) :: formula             !< its steps and variables; of use only without a problem
    type(formula_problem_type), intent(out) :: problem     !< the first problem
    type(reading_type) :: reading

    allocate (formula%steps(8), formula%names(0), formula%name_first(0))
    call read_sum(text, reading, formula, problem)
    call skip(text, reading%at)
    if (.not. allocated(problem%words) .and. reading%at <= len(text)) &
      call complain(problem, after_operand(text, reading%at), reading%at, word_end(text, reading%at))
    formula%steps = formula%steps(:reading%steps)
  end subroutine parse_formula

  !> Words for what stands where the formula should end or go on with an operator.
  pure function after_operand(text, at) result(words)
    character(len=*), intent(in) :: text     !< the formula
    integer, intent(in) :: at                !< number of the byte
    character(len=60) :: words

    if (text(at:at) == ')') then
      words = 'this parenthesis closes none'
    else if (text(at:at) == ',') then
      words = 'a comma stands only between operands of atan2, min and max'
    else
      words = 'an operator is missing before this'
    end if
  end function after_operand

  !> Sums and differences.
  pure recursive subroutine read_sum(text, reading, formula, problem)
    character(len=*), intent(in) :: text                     !< the formula
    type(reading_type), intent(inout) :: reading             !< place in the text
    type(formula_type), intent(inout) :: formula             !< gets the steps
    type(formula_problem_type), intent(inout) :: problem     !< gets the first problem
    integer :: at, kind

    call read_product(text, reading, formula, problem)
    do while (.not. allocated(problem%words))
      call skip(text, reading%at)
      at = reading%at
      if (at > len(text)) return
      if (scan(text(at:at), '+-') == 0) return
      kind = merge(step_add, step_subtract, text(at:at) == '+')
      reading%at = at + 1
      call read_product(text, reading, formula, problem)
      call add_step(formula, reading, step_type(kind=kind, first=at, last=at))
    end do
  end subroutine read_sum

  !> Products and quotients.
  pure recursive subroutine read_product(text, reading, formula, problem)
    character(len=*), intent(in) :: text                     !< the formula
    type(reading_type), intent(inout) :: reading             !< place in the text
    type(formula_type), intent(inout) :: formula             !< gets the steps
    type(formula_problem_type), intent(inout) :: problem     !< gets the first problem
    integer :: at, kind

    call read_sign(text, reading, formula, problem)
    do while (.not. allocated(problem%words))
      call skip(text, reading%at)
      at = reading%at
      if (at > len(text)) return
      if (scan(text(at:at), '*/') == 0) return
      kind = merge(step_multiply, step_divide, text(at:at) == '*')
      reading%at = at + 1
      call read_sign(text, reading, formula, problem)
      call add_step(formula, reading, step_type(kind=kind, first=at, last=at))
    end do
  end subroutine read_product

  !> Signs before a power.
  pure recursive subroutine read_sign(text, reading, formula, problem)
    character(len=*), intent(in) :: text                     !< the formula
    type(reading_type), intent(inout) :: reading             !< place in the text
    type(formula_type), intent(inout) :: formula             !< gets the steps
    type(formula_problem_type), intent(inout) :: problem     !< gets the first problem
    integer :: at

    call skip(text, reading%at)
    at = reading%at
    if (at <= len(text)) then
      if (scan(text(at:at), '+-') > 0) then
        call go_deeper(reading, at, problem)
        if (allocated(problem%words)) return
        reading%at = at + 1
        call read_sign(text, reading, formula, problem)
        if (text(at:at) == '-') call add_step(formula, reading, step_type(kind=step_negate, first=at, last=at))
        reading%depth = reading%depth - 1
        return
      end if
    end if
    call read_power(text, reading, formula, problem)
  end subroutine read_sign

  !> Powers, joined from the right. The exponent may have signs.
  pure recursive subroutine read_power(text, reading, formula, problem)
    character(len=*), intent(in) :: text                     !< the formula
    type(reading_type), intent(inout) :: reading             !< place in the text
    type(formula_type), intent(inout) :: formula             !< gets the steps
    type(formula_problem_type), intent(inout) :: problem     !< gets the first problem
    integer :: at

    call read_operand(text, reading, formula, problem)
    if (allocated(problem%words)) return
    call skip(text, reading%at)
    at = reading%at
    if (at > len(text)) return
    reading%at = at + 1
    if (text(at:at) == '*' .and. at < len(text)) then
      if (text(at + 1:at + 1) == '*') reading%at = at + 2      ! as in Fortran and Python
    end if
    if (text(at:at) /= '^' .and. reading%at == at + 1) then
      reading%at = at
      return
    end if
    call go_deeper(reading, at, problem)
    if (allocated(problem%words)) return
    call read_sign(text, reading, formula, problem)
    call add_step(formula, reading, step_type(kind=step_power, first=at, last=at))
    reading%depth = reading%depth - 1
  end subroutine read_power

  !> A number, a variable, a function of operands, or a sum in parentheses.
  pure recursive subroutine read_operand(text, reading, formula, problem)
    character(len=*), intent(in) :: text                     !< the formula
    type(reading_type), intent(inout) :: reading             !< place in the text
    type(formula_type), intent(inout) :: formula             !< gets the steps
    type(formula_problem_type), intent(inout) :: problem     !< gets the first problem
    integer :: first, last, next

    call skip(text, reading%at)
    first = reading%at
    if (first > len(text)) then
      call complain(problem, no_operand, max(1, len(text)), max(1, len(text)))
    else if (scan(text(first:first), digits//'.') > 0) then
      call read_number(text, reading, formula, problem)
    else if (scan(text(first:first), letters) > 0) then
      last = word_end(text, first)
      next = last + 1
      call skip(text, next)
      if (next <= len(text)) then
        if (text(next:next) == '(') then
          reading%at = next
          call read_function(text, first, last, reading, formula, problem)
          return
        end if
      end if
      reading%at = last + 1
      call add_name(text(first:last), first, reading, formula, problem)
    else if (text(first:first) == '(') then
      call go_deeper(reading, first, problem)
      if (allocated(problem%words)) return
      reading%at = first + 1
      call read_sum(text, reading, formula, problem)
      call close_parenthesis(text, first, reading, problem)
    else
      call complain(problem, no_operand, first, first)
    end if
  end subroutine read_operand

  !> The operands of a function, and its step.
  pure recursive subroutine read_function(text, first, last, reading, formula, problem)
    character(len=*), intent(in) :: text                     !< the formula
    integer, intent(in) :: first                             !< first byte of the name
    integer, intent(in) :: last                              !< last byte of the name
    type(reading_type), intent(inout) :: reading             !< place in the text: the parenthesis
    type(formula_type), intent(inout) :: formula             !< gets the steps
    type(formula_problem_type), intent(inout) :: problem     !< gets the first problem
    integer :: which, operands, open

    which = number_of_function(text(first:last))
    if (which == 0) then
      call complain(problem, 'there is no function '''//text(first:last)//'''; functions are '//list_of_functions(), first, last)
      return
    end if
    open = reading%at
    call go_deeper(reading, open, problem)
    if (allocated(problem%words)) return
    operands = 0
    do
      reading%at = reading%at + 1
      call read_sum(text, reading, formula, problem)
      if (allocated(problem%words)) return
      operands = operands + 1
      ! of three and more operands of min and max, two are taken at a time
      if (takes_two(which) .and. operands > 1) &
        call add_step(formula, reading, step_type(kind=step_function, which=which, first=first, last=last))
      call skip(text, reading%at)
      if (reading%at > len(text)) exit
      if (text(reading%at:reading%at) /= ',') exit
    end do
    if (takes_two(which)) then
      if (operands < 2 .or. (operands > 2 .and. which == first_of_two)) &
        call complain(problem, trim(function_names(which))//' takes two operands'// &
                      trim(merge('        ', ' or more', which == first_of_two)), first, last)
    else if (operands > 1) then
      call complain(problem, trim(function_names(which))//' takes one operand', first, last)
    else
      call add_step(formula, reading, step_type(kind=step_function, which=which, first=first, last=last))
    end if
    if (.not. allocated(problem%words)) call close_parenthesis(text, open, reading, problem)
  end subroutine read_function

  !> The parenthesis that closes one.
  pure subroutine close_parenthesis(text, open, reading, problem)
    character(len=*), intent(in) :: text                     !< the formula
    integer, intent(in) :: open                              !< number of the byte with the parenthesis that is closed
    type(reading_type), intent(inout) :: reading             !< place in the text
    type(formula_problem_type), intent(inout) :: problem     !< gets a problem

    if (allocated(problem%words)) return
    call skip(text, reading%at)
    if (reading%at > len(text)) then
      call complain(problem, 'this parenthesis is not closed', open, open)
    else if (text(reading%at:reading%at) /= ')') then
      call complain(problem, after_operand(text, reading%at), reading%at, word_end(text, reading%at))
    else
      reading%at = reading%at + 1
      reading%depth = reading%depth - 1
    end if
  end subroutine close_parenthesis

  !> A number: 12, .5, 3e-2, 1.0d0.
  pure subroutine read_number(text, reading, formula, problem)
    character(len=*), intent(in) :: text                     !< the formula
    type(reading_type), intent(inout) :: reading             !< place in the text
    type(formula_type), intent(inout) :: formula             !< gets the step
    type(formula_problem_type), intent(inout) :: problem     !< gets a problem
    character(len=longest_number + 8) :: plain
    integer :: first, mantissa, last, exponent, status
    real(wp) :: number

    first = reading%at
    mantissa = run_end(text, first, digits//'.')
    last = mantissa
    exponent = 0
    if (mantissa < len(text)) then
      if (scan(text(mantissa + 1:mantissa + 1), 'eEdD') > 0) call read_exponent(text, mantissa + 1, last, exponent)
    end if
    reading%at = last + 1
    if (.not. is_mantissa(text(first:mantissa))) then
      call complain(problem, 'this is not a number', first, last)
    else if (mantissa - first >= longest_number .or. abs(exponent) > largest_exponent) then
      call complain(problem, 'this number has too many digits, or is too large or too small', first, last)
    else
      plain = text(first:mantissa)//'e'//to_text(exponent)
      read (plain, *, iostat=status) number
      call add_step(formula, reading, step_type(kind=step_number, number=number, first=first, last=last))
    end if
  end subroutine read_number

  !> Whether digits and points are a number: there is a digit, and at most one point.
  pure logical function is_mantissa(text)
    character(len=*), intent(in) :: text     !< digits and points

    is_mantissa = scan(text, digits) > 0 .and. index(text, '.') == index(text, '.', back=.true.)
  end function is_mantissa

  !> The exponent of a number, where digits follow its letter.
  pure subroutine read_exponent(text, letter, last, exponent)
    character(len=*), intent(in) :: text       !< the formula
    integer, intent(in) :: letter              !< number of the byte with the letter
    integer, intent(inout) :: last             !< becomes the last byte of the exponent
    integer, intent(inout) :: exponent         !< becomes its value; a very large one becomes 1000
    integer :: first, end, i

    first = letter + 1
    if (first > len(text)) return
    if (scan(text(first:first), '+-') > 0) first = first + 1
    end = run_end(text, first, digits)
    if (end < first) return
    last = end
    do i = first, end
      exponent = min(1000, 10*exponent + index(digits, text(i:i)) - 1)
    end do
    if (text(letter + 1:letter + 1) == '-') exponent = -exponent
  end subroutine read_exponent

  !> The step of a name: pi, or a variable.
  pure subroutine add_name(name, first, reading, formula, problem)
    character(len=*), intent(in) :: name                     !< the name
    integer, intent(in) :: first                             !< its first byte
    type(reading_type), intent(inout) :: reading             !< place in the text
    type(formula_type), intent(inout) :: formula             !< gets the step
    type(formula_problem_type), intent(inout) :: problem     !< gets a problem
    integer :: which

    if (name == 'pi') then
      call add_step(formula, reading, step_type(kind=step_number, number=pi, first=first, last=first + 1))
      return
    else if (len(name) > longest_variable) then
      call complain(problem, 'this name is too long', first, first + len(name) - 1)
      return
    end if
    do which = 1, size(formula%names)
      if (formula%names(which) == name) exit
    end do
    if (which > size(formula%names)) then
      formula%names = [character(len=longest_variable) :: formula%names, name]
      formula%name_first = [formula%name_first, first]
    end if
    call add_step(formula, reading, step_type(kind=step_variable, which=which, first=first, last=first + len(name) - 1))
  end subroutine add_name

  !> Append a step, and count the results that wait.
  pure subroutine add_step(formula, reading, step)
    type(formula_type), intent(inout) :: formula      !< gets the step
    type(reading_type), intent(inout) :: reading      !< counts
    type(step_type), intent(in) :: step               !< the step
    type(step_type), allocatable :: grown(:)

    if (reading%steps == size(formula%steps)) then
      allocate (grown(2*size(formula%steps)))
      grown(:reading%steps) = formula%steps
      call move_alloc(grown, formula%steps)
    end if
    reading%steps = reading%steps + 1
    formula%steps(reading%steps) = step
    select case (step%kind)
    case (step_number, step_variable)
      reading%waiting = reading%waiting + 1
    case (step_add, step_subtract, step_multiply, step_divide, step_power)
      reading%waiting = reading%waiting - 1
    case (step_function)
      if (takes_two(step%which)) reading%waiting = reading%waiting - 1
    end select
    formula%depth = max(formula%depth, reading%waiting)
  end subroutine add_step

  !> Report a formula whose parts stand too deep within each other.
  pure subroutine go_deeper(reading, at, problem)
    type(reading_type), intent(inout) :: reading             !< place in the text
    integer, intent(in) :: at                                !< number of the byte
    type(formula_problem_type), intent(inout) :: problem     !< gets a problem

    reading%depth = reading%depth + 1
    if (reading%depth > deepest) call complain(problem, 'there are more than '//to_text(deepest)// &
                                               ' parentheses, signs and powers within each other', at, at)
  end subroutine go_deeper

  !> Keep a problem, if it is the first one.
  pure subroutine complain(problem, words, first, last)
    type(formula_problem_type), intent(inout) :: problem     !< gets the problem
    character(len=*), intent(in) :: words                    !< the problem in words
    integer, intent(in) :: first                             !< first byte
    integer, intent(in) :: last                              !< last byte

    if (allocated(problem%words)) return
    problem%words = trim(words)
    problem%first = first
    problem%last = max(first, last)
  end subroutine complain

  !> Number of a function by its name, in any case; 0 for others.
  pure integer function number_of_function(name) result(number)
    character(len=*), intent(in) :: name     !< any name

    do number = size(function_names), 1, -1
      if (function_names(number) == lower(name)) return
    end do
  end function number_of_function

  !> Whether a function takes two operands.
  pure logical function takes_two(which)
    integer, intent(in) :: which     !< number of the function

    takes_two = which >= first_of_two
  end function takes_two

  !> The functions in words.
  pure function list_of_functions() result(words)
    character(len=7*size(function_names)) :: words
    integer :: i

    words = function_names(1)
    do i = 2, size(function_names)
      words = trim(words)//trim(merge(' and ', ',    ', i == size(function_names)))//' '//function_names(i)
    end do
  end function list_of_functions

  !> Last byte of a word, or of a single character that is no letter.
  pure integer function word_end(text, first) result(last)
    character(len=*), intent(in) :: text     !< the formula
    integer, intent(in) :: first             !< first byte

    last = max(first, run_end(text, first, letters//digits))
  end function word_end

  !> Last byte of a run of some characters; the byte before `first` where there is none.
  pure integer function run_end(text, first, set) result(last)
    character(len=*), intent(in) :: text     !< the formula
    integer, intent(in) :: first             !< first byte
    character(len=*), intent(in) :: set      !< these characters

    last = first - 1
    if (first > len(text)) return
    last = verify(text(first:), set)
    last = merge(len(text), first + last - 2, last == 0)
  end function run_end

  !> Go on over blanks.
  pure subroutine skip(text, at)
    character(len=*), intent(in) :: text     !< the formula
    integer, intent(inout) :: at             !< number of the next byte

    do while (at <= len(text))
      if (text(at:at) /= ' ' .and. text(at:at) /= achar(9)) return
      at = at + 1
    end do
  end subroutine skip
end module mech9_formula
