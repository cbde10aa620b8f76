!> A writer of JSON for reports: objects, arrays, numbers, texts, truth values.
!>
!>     call json%begin_object()
!>     call json%add('positions', 101)
!>     call json%begin_array('blocks')
!>     call json%add('4-bar')
!>     call json%end_array()
!>     call json%end_object()
!>     call json%save('report.json', err)
module mech9_json
  use mech9_kinds, only: wp, long
  use mech9_error, only: error_type, raise, exit_internal
  use mech9_text, only: to_text
  use mech9_printable, only: utf8_length
  use mech9_text_file, only: save_text
  use mech9_page, only: page_type
  implicit none
  private
  public :: json_type

  integer, parameter :: deepest = 32
  character, parameter :: line_end = achar(10)

  !> A document being composed in memory. Values in an object have names, values in an array have none;
  !> `save` refuses a document that breaks this rule.
  type :: json_type
    private
    type(page_type) :: page
    integer :: depth = 0
    character :: closing(deepest) = ' '   !< the bracket that ends the object or array at each depth
    logical :: empty = .true.   !< whether the innermost object or array has no element yet
    logical :: wrong = .false.  !< whether the calls do not compose a correct document
  contains
    procedure :: begin_object
    procedure :: end_object
    procedure :: begin_array
    procedure :: end_array
    procedure :: save => save_document
    procedure :: take_text
    procedure, private :: add_real, add_integer, add_long, add_logical, add_text, add_reals
    procedure, private :: item_real, item_integer, item_long, item_logical, item_text
    !> `add(name, value)` in an object, `add(value)` in an array.
    generic :: add => add_real, add_integer, add_long, add_logical, add_text, add_reals, &
      item_real, item_integer, item_long, item_logical, item_text
    procedure, private :: put_item, begin, finish
  end type json_type

contains

  !> Begin an object.
  subroutine begin_object(self, name)
    class(json_type), intent(inout) :: self         !< the document
    character(len=*), intent(in), optional :: name  !< name in the object around it; absent in an array and for the whole document

    call self%begin('{', '}', name)
  end subroutine begin_object

  !> End the innermost object.
  subroutine end_object(self)
    class(json_type), intent(inout) :: self  !< the document

    call self%finish('}')
  end subroutine end_object

  !> Begin an array.
  subroutine begin_array(self, name)
    class(json_type), intent(inout) :: self         !< the document
    character(len=*), intent(in), optional :: name  !< name in the object around it; absent in an array and for the whole document

    call self%begin('[', ']', name)
  end subroutine begin_array

  !> End the innermost array.
  subroutine end_array(self)
    class(json_type), intent(inout) :: self  !< the document

    call self%finish(']')
  end subroutine end_array

  !> Add a real number to an object.
  subroutine add_real(self, name, value)
    class(json_type), intent(inout) :: self  !< the document
    character(len=*), intent(in) :: name     !< name in the object
    real(wp), intent(in) :: value            !< the value to add

    call self%put_item(number_text(value), name)
  end subroutine add_real

  !> Add a whole number to an object.
  subroutine add_integer(self, name, value)
    class(json_type), intent(inout) :: self  !< the document
    character(len=*), intent(in) :: name     !< name in the object
    integer, intent(in) :: value             !< the value to add

    call self%put_item(to_text(value), name)
  end subroutine add_integer

  !> Add a whole number of long kind to an object.
  subroutine add_long(self, name, value)
    class(json_type), intent(inout) :: self  !< the document
    character(len=*), intent(in) :: name     !< name in the object
    integer(long), intent(in) :: value       !< the value to add

    call self%put_item(to_text(value), name)
  end subroutine add_long

  !> Add a truth value to an object.
  subroutine add_logical(self, name, value)
    class(json_type), intent(inout) :: self  !< the document
    character(len=*), intent(in) :: name     !< name in the object
    logical, intent(in) :: value             !< the value to add

    call self%put_item(trim(merge('true ', 'false', value)), name)
  end subroutine add_logical

  !> Add a text to an object.
  subroutine add_text(self, name, value)
    class(json_type), intent(inout) :: self  !< the document
    character(len=*), intent(in) :: name     !< name in the object
    character(len=*), intent(in) :: value    !< the value to add

    call self%put_item(quoted(value), name)
  end subroutine add_text

  !> Add an array of real numbers to an object.
  subroutine add_reals(self, name, values)
    class(json_type), intent(inout) :: self  !< the document
    character(len=*), intent(in) :: name     !< name in the object
    real(wp), intent(in) :: values(:)        !< the numbers
    integer :: i

    call self%begin_array(name)
    do i = 1, size(values)
      call self%put_item(number_text(values(i)))
    end do
    call self%end_array()
  end subroutine add_reals

  !> Add a real number to an array.
  subroutine item_real(self, value)
    class(json_type), intent(inout) :: self  !< the document
    real(wp), intent(in) :: value            !< the value to add

    call self%put_item(number_text(value))
  end subroutine item_real

  !> Add a whole number to an array.
  subroutine item_integer(self, value)
    class(json_type), intent(inout) :: self  !< the document
    integer, intent(in) :: value             !< the value to add

    call self%put_item(to_text(value))
  end subroutine item_integer

  !> Add a whole number of long kind to an array.
  subroutine item_long(self, value)
    class(json_type), intent(inout) :: self  !< the document
    integer(long), intent(in) :: value       !< the value to add

    call self%put_item(to_text(value))
  end subroutine item_long

  !> Add a truth value to an array.
  subroutine item_logical(self, value)
    class(json_type), intent(inout) :: self  !< the document
    logical, intent(in) :: value             !< the value to add

    call self%put_item(trim(merge('true ', 'false', value)))
  end subroutine item_logical

  !> Add a text to an array.
  subroutine item_text(self, value)
    class(json_type), intent(inout) :: self  !< the document
    character(len=*), intent(in) :: value    !< the value to add

    call self%put_item(quoted(value))
  end subroutine item_text

  !> The finished document; empty where the calls did not compose a whole one.
  pure subroutine take_text(self, text)
    class(json_type), intent(in) :: self                        !< the document
    character(len=:), allocatable, intent(out) :: text          !< gets it

    text = ''
    if (.not. (self%wrong .or. self%depth /= 0 .or. self%page%is_empty())) text = self%page%text()//line_end
  end subroutine take_text

  !> Write the finished document to a file.
  subroutine save_document(self, path, err)
    class(json_type), intent(in) :: self               !< the document
    character(len=*), intent(in) :: path               !< path of the file; '-' is standard output
    type(error_type), allocatable, intent(out) :: err  !< allocated if it failed
    character(len=:), allocatable :: text

    call self%take_text(text)
    if (text == '') then
      call raise(err, exit_internal, 'the report '//path//' was not composed as a whole document')
    else
      call save_text(path, text, err)
    end if
  end subroutine save_document

  !> Begin an object or array.
  subroutine begin(self, opening, closing, name)
    class(json_type), intent(inout) :: self         !< the document
    character, intent(in) :: opening                !< the bracket that opens it
    character, intent(in) :: closing                !< the bracket that will close it
    character(len=*), intent(in), optional :: name  !< name in the object around it; absent in an array and for the whole document

    call self%put_item(opening, name)
    if (self%depth == deepest) self%wrong = .true.
    if (self%wrong) return
    self%depth = self%depth + 1
    self%closing(self%depth) = closing
    self%empty = .true.
  end subroutine begin

  !> End the innermost object or array.
  subroutine finish(self, closing)
    class(json_type), intent(inout) :: self  !< the document
    character, intent(in) :: closing         !< the bracket that closes it

    if (self%depth == 0) self%wrong = .true.
    if (self%wrong) return
    if (self%closing(self%depth) /= closing) then
      self%wrong = .true.
      return
    end if
    self%depth = self%depth - 1
    if (.not. self%empty) call self%page%put(line_end//repeat('  ', self%depth))
    call self%page%put(closing)
    self%empty = .false.
  end subroutine finish

  !> Write a value that is JSON already, with its name, comma and indentation.
  subroutine put_item(self, value, name)
    class(json_type), intent(inout) :: self         !< the document
    character(len=*), intent(in) :: value           !< the value as JSON
    character(len=*), intent(in), optional :: name  !< name in the object; absent in an array
    logical :: in_object

    in_object = .false.
    if (self%depth > 0) in_object = self%closing(self%depth) == '}'
    if (in_object .neqv. present(name)) self%wrong = .true.
    if (self%depth == 0 .and. .not. self%page%is_empty()) self%wrong = .true.
    if (self%wrong) return
    if (.not. self%empty) call self%page%put(',')
    if (self%depth > 0) call self%page%put(line_end//repeat('  ', self%depth))
    if (present(name)) call self%page%put(quoted(name)//': ')
    call self%page%put(value)
    self%empty = .false.
  end subroutine put_item

  !> The number with the fewest digits, from 15 to 17, that reads back as the same number. JSON has no NaN and no
  !> infinity; they become null.
  pure function number_text(value) result(text)
    real(wp), intent(in) :: value  !< any number, also one that is not finite
    character(len=:), allocatable :: text
    real(wp) :: read_back
    integer :: digits, status

    text = 'null'
    if (.not. is_finite(value)) return
    ! the largest numbers, rounded to fewer digits, would overflow
    do digits = merge(15, 17, abs(value) < 1.0e308_wp), 17
      text = to_text(value, digits)
      read (text, *, iostat=status) read_back
      if (status == 0 .and. transfer(read_back, 0_long) == transfer(value, 0_long)) return
    end do
  end function number_text

  !> Whether a number is finite, by its bits: a comparison with NaN would stop a program that traps invalid operations.
  pure logical function is_finite(value)
    real(wp), intent(in) :: value  !< any number, also one that is not finite

    is_finite = ibits(transfer(value, 0_long), 52, 11) /= 2047
  end function is_finite

  !> A text as a JSON string; bytes that are not UTF-8 become the replacement character.
  pure function quoted(text) result(json)
    character(len=*), intent(in) :: text  !< any bytes
    character(len=:), allocatable :: json
    integer :: i, length

    json = '"'
    i = 1
    do while (i <= len(text))
      length = utf8_length(text, i)
      if (length == 0) then
        json = json//'\ufffd'
      else
        json = json//escaped(text(i:i + length - 1))
      end if
      i = i + max(length, 1)
    end do
    json = json//'"'
  end function quoted

  !> One character, escaped where JSON requires it.
  pure function escaped(letter) result(json)
    character(len=*), intent(in) :: letter  !< the bytes of one character
    character(len=:), allocatable :: json
    character(len=2) :: code

    json = letter
    if (len(letter) > 1) return
    select case (iachar(letter))
    case (34, 92)
      json = '\'//letter
    case (10)
      json = '\n'
    case (9)
      json = '\t'
    case (0:8, 11:31, 127)
      write (code, '(z2.2)') iachar(letter)
      json = '\u00'//code
    end select
  end function escaped
end module mech9_json
