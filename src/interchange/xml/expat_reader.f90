!> XML files read by expat, a library in C that calls back at each element.
!>
!> Document type declarations are refused before they are read: they alone can define entities, which grow without bounds or
!> name other files. Files of unusual size and elements of unusual depth are refused too.
module mech9_expat_reader
  use, intrinsic :: iso_c_binding, only: c_int, c_size_t, c_signed_char, c_char, c_ptr, c_null_ptr, c_loc, c_funloc, &
                                         c_associated, c_f_pointer
  use mech9_error, only: error_type, raise, add_place, exit_data, exit_file
  use mech9_text, only: to_text
  use mech9_file_bytes, only: read_bytes
  use mech9_libexpat, only: parser_create, parser_free, set_user_data, set_element_handler, set_character_handler, &
                            set_doctype_handler, stop_parser, parse, error_code, error_string, current_line, current_column
  use mech9_xml_tree, only: xml_tree_type, deepest_element
  implicit none
  private
  public :: read_xml

  !> No robot has a larger description.
  integer, parameter :: largest_file = 50000000

  !> The data of the handlers: expat passes their address.
  type :: builder_type
    type(c_ptr) :: parser = c_null_ptr
    type(xml_tree_type), pointer :: tree => null()   !< the tree that grows
    integer :: open = 0                              !< number of the element that is open; 0: none
    integer :: depth = 0                             !< number of elements that are open
    character(len=:), allocatable :: refusal         !< the reason why a handler stopped the parser
  end type builder_type

  interface
    integer(c_size_t) function c_strlen(text) bind(c, name='strlen')
      import :: c_size_t, c_ptr
      type(c_ptr), value :: text  !< address of a text that ends with a byte of zero
    end function c_strlen
  end interface

contains

  !> Read a file. Fails with exit_file where it cannot be read, and with exit_data, line and column where it is not XML.
  subroutine read_xml(path, tree, err)
    character(len=*), intent(in) :: path               !< path of the file
    type(xml_tree_type), intent(out), target :: tree   !< its elements
    type(error_type), allocatable, intent(out) :: err  !< allocated if it failed
    type(builder_type), target :: builder
    character(len=:), allocatable :: text
    integer(c_int) :: status

    call tree%begin(path)
    call read_bytes(path, text, err)
    if (.not. allocated(err) .and. len(text) > largest_file) &
      call raise(err, exit_data, 'is too large for the description of a robot: '//to_text(len(text)/1000000)//' MB, and '// &
                 to_text(largest_file/1000000)//' MB are read at most')
    if (allocated(err)) then
      call add_place(err, path)
      return
    end if
    builder%parser = parser_create(c_null_ptr)
    if (.not. c_associated(builder%parser)) then
      call raise(err, exit_file, path//': cannot be read: no memory is left')
      return
    end if
    builder%tree => tree
    call set_user_data(builder%parser, c_loc(builder))
    call set_element_handler(builder%parser, c_funloc(begin_element), c_funloc(end_element))
    call set_character_handler(builder%parser, c_funloc(take_text))
    call set_doctype_handler(builder%parser, c_funloc(refuse_doctype))
    status = parse(builder%parser, text, len(text, c_int), 1_c_int)
    if (status == 0) call explain_failure(builder, err)
    call parser_free(builder%parser)
  end subroutine read_xml

  !> The failure of a parser, with line and column.
  subroutine explain_failure(builder, err)
    type(builder_type), intent(in) :: builder          !< parser and refusal
    type(error_type), allocatable, intent(out) :: err  !< always allocated
    character(len=:), allocatable :: reason

    if (allocated(builder%refusal)) then
      reason = builder%refusal
    else
      call take_string(error_string(error_code(builder%parser)), reason)
      reason = 'this is not well-formed XML: '//reason
    end if
    call raise(err, exit_data, builder%tree%files(1)%text//':'//to_text(int(current_line(builder%parser)))//':'// &
               to_text(int(current_column(builder%parser)) + 1)//': '//reason)
  end subroutine explain_failure

  !> Called at the beginning of an element.
  subroutine begin_element(data, name, attributes) bind(c)
    type(c_ptr), value :: data        !< address of the builder
    type(c_ptr), value :: name        !< address of the element's name
    type(c_ptr), value :: attributes  !< address of addresses: name, value, name, value, ..., null
    type(builder_type), pointer :: builder
    type(c_ptr), pointer :: strings(:)
    character(len=:), allocatable :: text, value
    integer :: i

    call c_f_pointer(data, builder)
    if (allocated(builder%refusal)) return
    call take_string(name, text)
    builder%depth = builder%depth + 1
    if (builder%depth > deepest_element) then
      call refuse(builder, 'elements are nested more than '//to_text(deepest_element)//' deep, which no robot needs')
      return
    end if
    call builder%tree%add_element(builder%open, text, int(current_line(builder%parser)), &
                                  int(current_column(builder%parser)) + 1)
    builder%open = builder%tree%count
    i = 0
    do
      call c_f_pointer(attributes, strings, [i + 2])
      if (.not. c_associated(strings(i + 1))) exit
      call take_string(strings(i + 1), text)
      call take_string(strings(i + 2), value)
      call builder%tree%add_attribute(text, value)
      i = i + 2
    end do
  end subroutine begin_element

  !> Called at the end of an element.
  subroutine end_element(data, name) bind(c)
    type(c_ptr), value :: data  !< address of the builder
    type(c_ptr), value :: name  !< address of the element's name
    type(builder_type), pointer :: builder

    call c_f_pointer(data, builder)
    if (allocated(builder%refusal)) return
    builder%depth = builder%depth - 1
    builder%open = builder%tree%parent(builder%open)
  end subroutine end_element

  !> Called with a piece of text.
  subroutine take_text(data, bytes, length) bind(c)
    type(c_ptr), value :: data        !< address of the builder
    type(c_ptr), value :: bytes       !< address of the text, without a byte of zero at its end
    integer(c_int), value :: length   !< how many bytes
    type(builder_type), pointer :: builder
    character(len=:), allocatable :: text

    call c_f_pointer(data, builder)
    if (allocated(builder%refusal) .or. builder%open == 0) return
    call take_bytes(bytes, int(length), text)
    call builder%tree%add_text(builder%open, text)
  end subroutine take_text

  !> Called at the beginning of a document type declaration.
  subroutine refuse_doctype(data, name, system, public, has_subset) bind(c)
    type(c_ptr), value :: data             !< address of the builder
    type(c_ptr), value :: name             !< address of its name
    type(c_ptr), value :: system           !< address of the name of a file with definitions; may be null
    type(c_ptr), value :: public           !< address of a public name of definitions; may be null
    integer(c_int), value :: has_subset    !< 1: definitions follow
    type(builder_type), pointer :: builder

    call c_f_pointer(data, builder)
    call refuse(builder, 'a document type declaration (<!DOCTYPE ...>) is refused, since it may define entities that grow '// &
                'without bounds or name other files; take it out')
  end subroutine refuse_doctype

  !> Stop the parser for a reason.
  subroutine refuse(builder, reason)
    type(builder_type), intent(inout) :: builder  !< parser and refusal
    character(len=*), intent(in) :: reason        !< the reason in words
    integer(c_int) :: status

    builder%refusal = reason
    status = stop_parser(builder%parser, 0_c_signed_char)
  end subroutine refuse

  !> A text of C as a Fortran text.
  subroutine take_string(address, text)
    type(c_ptr), intent(in) :: address                 !< address of a text that ends with a byte of zero; null: an empty text
    character(len=:), allocatable, intent(out) :: text !< the text

    if (c_associated(address)) then
      call take_bytes(address, int(c_strlen(address)), text)
    else
      text = ''
    end if
  end subroutine take_string

  !> Bytes at an address as a Fortran text.
  subroutine take_bytes(address, length, text)
    type(c_ptr), intent(in) :: address                 !< address of the first byte
    integer, intent(in) :: length                      !< how many bytes
    character(len=:), allocatable, intent(out) :: text !< the text
    character(kind=c_char), pointer :: bytes(:)
    integer :: i

    allocate (character(len=length) :: text)
    call c_f_pointer(address, bytes, [length])
    do i = 1, length
      text(i:i) = bytes(i)
    end do
  end subroutine take_bytes
end module mech9_expat_reader
