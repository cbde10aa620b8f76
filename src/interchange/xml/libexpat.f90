!> Interfaces of the functions of expat that this program calls, as declared in expat.h.
module mech9_libexpat
  use, intrinsic :: iso_c_binding, only: c_int, c_long, c_signed_char, c_char, c_ptr, c_funptr
  implicit none
  private
  public :: parser_create, parser_free, set_user_data, set_element_handler, set_character_handler, set_doctype_handler
  public :: stop_parser, parse, error_code, error_string, current_line, current_column

  interface
    !> A new parser; null where there is no memory.
    type(c_ptr) function parser_create(encoding) bind(c, name='XML_ParserCreate')
      import :: c_ptr
      type(c_ptr), value :: encoding  !< name of the encoding; null: the file tells it
    end function parser_create

    !> Free a parser.
    subroutine parser_free(parser) bind(c, name='XML_ParserFree')
      import :: c_ptr
      type(c_ptr), value :: parser  !< address of the parser
    end subroutine parser_free

    !> Set the address that all handlers receive.
    subroutine set_user_data(parser, data) bind(c, name='XML_SetUserData')
      import :: c_ptr
      type(c_ptr), value :: parser  !< address of the parser
      type(c_ptr), value :: data    !< first argument of all handlers
    end subroutine set_user_data

    !> Set the handlers of the beginning and the end of elements.
    subroutine set_element_handler(parser, begins, ends) bind(c, name='XML_SetElementHandler')
      import :: c_ptr, c_funptr
      type(c_ptr), value :: parser     !< address of the parser
      type(c_funptr), value :: begins  !< called at the beginning of an element, with its name and attributes
      type(c_funptr), value :: ends    !< called at its end, with its name
    end subroutine set_element_handler

    !> Set the handler of text between elements.
    subroutine set_character_handler(parser, handler) bind(c, name='XML_SetCharacterDataHandler')
      import :: c_ptr, c_funptr
      type(c_ptr), value :: parser      !< address of the parser
      type(c_funptr), value :: handler  !< called with pieces of text
    end subroutine set_character_handler

    !> Set the handler of a document type declaration.
    subroutine set_doctype_handler(parser, handler) bind(c, name='XML_SetStartDoctypeDeclHandler')
      import :: c_ptr, c_funptr
      type(c_ptr), value :: parser      !< address of the parser
      type(c_funptr), value :: handler  !< called at the beginning of the declaration
    end subroutine set_doctype_handler

    !> Stop the parser from within a handler.
    integer(c_int) function stop_parser(parser, resumable) bind(c, name='XML_StopParser')
      import :: c_int, c_signed_char, c_ptr
      type(c_ptr), value :: parser                  !< address of the parser
      integer(c_signed_char), value :: resumable    !< 0: it does not go on
    end function stop_parser

    !> Parse a piece of a document; 0 where it failed.
    integer(c_int) function parse(parser, text, length, is_final) bind(c, name='XML_Parse')
      import :: c_int, c_char, c_ptr
      type(c_ptr), value :: parser                  !< address of the parser
      character(kind=c_char), intent(in) :: text(*) !< the bytes
      integer(c_int), value :: length               !< how many bytes
      integer(c_int), value :: is_final             !< 1: the document ends with them
    end function parse

    !> The number of the error.
    integer(c_int) function error_code(parser) bind(c, name='XML_GetErrorCode')
      import :: c_int, c_ptr
      type(c_ptr), value :: parser  !< address of the parser
    end function error_code

    !> The address of the words for an error; null where there are none.
    type(c_ptr) function error_string(code) bind(c, name='XML_ErrorString')
      import :: c_int, c_ptr
      integer(c_int), value :: code  !< number of the error
    end function error_string

    !> The line at which the parser stands, from 1 on.
    integer(c_long) function current_line(parser) bind(c, name='XML_GetCurrentLineNumber')
      import :: c_long, c_ptr
      type(c_ptr), value :: parser  !< address of the parser
    end function current_line

    !> The column at which the parser stands, from 0 on.
    integer(c_long) function current_column(parser) bind(c, name='XML_GetCurrentColumnNumber')
      import :: c_long, c_ptr
      type(c_ptr), value :: parser  !< address of the parser
    end function current_column
  end interface
end module mech9_libexpat
