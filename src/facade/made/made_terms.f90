!> Sums and products of Fortran as text, in which 0 and 1 leave no trace, and text that grows by lines.
!>
!> An operand is '0', '1', a number or a name, with a minus sign before it or not.
module mech9_made_terms
  use mech9_kinds, only: wp
  use mech9_text, only: to_text, exact_digits
  implicit none
  private
  public :: lines_type, sum_of, product_of, negative, literal, full, term_length

  !> Letters of an operand, of a product or of a sum.
  integer, parameter :: term_length = 120
  character, parameter :: eol = achar(10)

  !> A text that grows by lines.
  type :: lines_type
    character(len=:), allocatable :: text
    integer :: depth = 4                                !< blanks before a statement
    character(len=24), allocatable :: names(:)          !< variables that have got a value
  contains
    procedure :: put
    procedure :: set
    procedure :: keep
  end type lines_type

contains

  !> Append a line.
  pure subroutine put(self, line)
    class(lines_type), intent(inout) :: self   !< gets the line
    character(len=*), intent(in) :: line       !< without its end

    if (.not. allocated(self%text)) self%text = ''
    self%text = self%text//trim(line)//eol
  end subroutine put

  !> Append an assignment.
  pure subroutine set(self, name, value)
    class(lines_type), intent(inout) :: self   !< gets the assignment
    character(len=*), intent(in) :: name       !< of the variable
    character(len=*), intent(in) :: value      !< an operand, a product or a sum
    character(len=24), allocatable :: grown(:)

    if (.not. allocated(self%names)) allocate (self%names(0))
    if (index(name, '(') == 0 .and. .not. any(self%names == name)) then
      allocate (grown(size(self%names) + 1))
      grown(:size(self%names)) = self%names
      grown(size(grown)) = name
      call move_alloc(grown, self%names)
    end if
    call self%put(repeat(' ', self%depth)//trim(name)//' = '//trim(full(value)))
  end subroutine set

  !> Keep a value in a variable, and tell its name as an operand. A constant, or another name, needs none.
  pure subroutine keep(self, name, value, operand)
    class(lines_type), intent(inout) :: self             !< gets an assignment where there must be one
    character(len=*), intent(in) :: name                 !< of the variable
    character(len=*), intent(in) :: value                !< a product or a sum
    character(len=term_length), intent(out) :: operand   !< the value or the name

    operand = value
    if (scan(trim(value), ' *(') == 0) return
    call self%set(name, value)
    operand = name
  end subroutine keep

  !> A number as an operand.
  pure function literal(number) result(operand)
    real(wp), intent(in) :: number   !< number of any unit, of which code is written
    character(len=term_length) :: operand

    if (.not. abs(number) > 0.0_wp) then
      operand = '0'
    else if (.not. abs(abs(number) - 1.0_wp) > 0.0_wp) then
      operand = trim(merge('1 ', '-1', number > 0.0_wp))
    else
      operand = to_text(number, exact_digits(number))
      if (scan(operand, '.e') == 0) operand = trim(operand)//'.0'
      operand = trim(operand)//'_wp'
    end if
  end function literal

  !> An operand or a product with the other sign.
  pure function negative(operand) result(other)
    character(len=*), intent(in) :: operand   !< the operand
    character(len=term_length) :: other

    if (operand == '0') then
      other = operand
    else if (operand(1:1) == '-') then
      other = operand(2:)
    else
      other = '-'//operand
    end if
  end function negative

  !> The product of two operands.
  pure function product_of(one, other) result(product)
    character(len=*), intent(in) :: one     !< a factor
    character(len=*), intent(in) :: other   !< another one
    character(len=term_length) :: product, x, y
    logical :: is_negative

    x = adjustl(one)
    y = adjustl(other)
    is_negative = (x(1:1) == '-') .neqv. (y(1:1) == '-')
    if (x(1:1) == '-') x = x(2:)
    if (y(1:1) == '-') y = y(2:)
    if (x == '0' .or. y == '0') then
      product = '0'
      return
    else if (x == '1') then
      product = y
    else if (y == '1') then
      product = x
    else
      product = trim(x)//'*'//y
    end if
    if (is_negative) product = '-'//trim(product)
  end function product_of

  !> The sum of operands and products. The first that has a plus sign comes first.
  pure function sum_of(one, second, third, fourth, fifth) result(sum)
    character(len=*), intent(in) :: one                  !< a term
    character(len=*), intent(in) :: second               !< another one
    character(len=*), intent(in), optional :: third      !< another one
    character(len=*), intent(in), optional :: fourth     !< another one
    character(len=*), intent(in), optional :: fifth      !< another one
    character(len=term_length) :: sum, terms(5)
    integer :: i, first

    terms = '0'
    terms(1) = one
    terms(2) = second
    if (present(third)) terms(3) = third
    if (present(fourth)) terms(4) = fourth
    if (present(fifth)) terms(5) = fifth
    sum = '0'
    first = 0
    do i = 1, size(terms)
      if (terms(i) == '0' .or. terms(i)(1:1) == '-') cycle
      first = i
      exit
    end do
    if (first > 0) sum = terms(first)
    do i = 1, size(terms)
      if (i == first .or. terms(i) == '0') cycle
      if (sum == '0') then
        sum = full(terms(i))
      else if (terms(i)(1:1) == '-') then
        sum = trim(full(sum))//' - '//full(terms(i)(2:))
      else
        sum = trim(full(sum))//' + '//full(terms(i))
      end if
    end do
  end function sum_of

  !> An operand, where 0 and 1 are real numbers.
  pure function full(term) result(written)
    character(len=*), intent(in) :: term   !< of a sum
    character(len=term_length) :: written

    written = term
    if (term == '0' .or. term == '1' .or. term == '-1') written = trim(term)//'.0_wp'
  end function full
end module mech9_made_terms
