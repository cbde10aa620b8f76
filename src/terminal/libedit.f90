!> Interfaces of the functions of libedit that this program calls, as declared in histedit.h.
!>
!> Some of them take a variable list of arguments, which Fortran cannot declare. They are declared with the largest
!> number of machine words that a call here needs. CMake allows libedit on processors that pass integers and addresses
!> to such a function as to any other. Arguments that it does not read do no harm.
module mech9_libedit
  use, intrinsic :: iso_c_binding, only: c_int, c_intptr_t, c_ptr, c_char
  implicit none
  private
  public :: el_init, el_end, el_wset, el_wget, el_wgets, el_wline, el_winsertstr
  public :: history_winit, history_wend, history_w, c_dup, c_fdopen, c_fclose, c_setlocale
  public :: history_event_type, line_info_type, wide
  public :: el_prompt, el_editor, el_signal, el_bind, el_setty, el_addfn, el_hist, el_getcfn, el_clientdata, &
            el_prep_term, el_refresh
  public :: h_setsize, h_enter, h_setunique, cc_refresh, cc_error, cc_redisplay, lc_ctype

  !> A wide character (wchar_t of Linux): a code point.
  integer, parameter :: wide = c_int

  ! Codes of operations of el_wset, history_w and setlocale.
  integer(c_int), parameter :: el_prompt = 0, el_editor = 2, el_signal = 3, el_bind = 4, el_setty = 8, &
                               el_addfn = 9, el_hist = 10, el_getcfn = 13, el_clientdata = 14, el_prep_term = 16, el_refresh = 20
  integer(c_int), parameter :: h_setsize = 1, h_enter = 10, h_setunique = 20
  integer(c_int), parameter :: lc_ctype = 0
  ! Answers of a function bound to a key.
  integer, parameter :: cc_refresh = 4, cc_error = 6, cc_redisplay = 8

  !> HistEventW: the answer of a call about the history.
  type, bind(c) :: history_event_type
    integer(c_int) :: number = 0
    integer(c_intptr_t) :: text = 0
  end type history_event_type

  !> LineInfoW: addresses of the line's first character, of the one at the cursor, and of the first one after the line.
  type, bind(c) :: line_info_type
    integer(c_intptr_t) :: first, cursor, behind
  end type line_info_type

  interface
    !> An editor on streams of C; null where there is none.
    type(c_ptr) function el_init(program_name, input, output, errors) bind(c)
      import :: c_ptr, c_char
      character(kind=c_char), intent(in) :: program_name(*)  !< name for the user's settings, ended by a zero
      type(c_ptr), value :: input                            !< stream of C that keys are read from
      type(c_ptr), value :: output                           !< stream of C that the line is drawn on
      type(c_ptr), value :: errors                           !< stream of C for errors
    end function el_init

    !> Free an editor.
    subroutine el_end(editor) bind(c)
      import :: c_ptr
      type(c_ptr), value :: editor  !< address of the editor
    end subroutine el_end

    !> Change a setting, which determines the meaning of the three arguments.
    integer(c_int) function el_wset(editor, what, first, second, third) bind(c)
      import :: c_ptr, c_int, c_intptr_t
      type(c_ptr), value :: editor          !< address of the editor
      integer(c_int), value :: what         !< the setting, one of the numbers above
      integer(c_intptr_t), value :: first   !< first argument, by the setting: number or address
      integer(c_intptr_t), value :: second  !< second argument; zero where unused
      integer(c_intptr_t), value :: third   !< third argument; zero where unused
    end function el_wset

    !> Read a setting; here one that is an address.
    integer(c_int) function el_wget(editor, what, answer) bind(c)
      import :: c_ptr, c_int
      type(c_ptr), value :: editor        !< address of the editor
      integer(c_int), value :: what       !< the setting, one of the numbers above
      type(c_ptr), intent(out) :: answer  !< the value of the setting
    end function el_wget

    !> Edit a line: the address of its characters with its end among them; null at the end of input.
    type(c_ptr) function el_wgets(editor, count) bind(c)
      import :: c_ptr, c_int
      type(c_ptr), value :: editor          !< address of the editor
      integer(c_int), intent(out) :: count  !< number of characters; -1 after an error
    end function el_wgets

    !> The address of the present line, a line_info_type.
    type(c_ptr) function el_wline(editor) bind(c)
      import :: c_ptr
      type(c_ptr), value :: editor  !< address of the editor
    end function el_wline

    !> Insert characters at the cursor; the answer is -1 where there is no room.
    integer(c_int) function el_winsertstr(editor, text) bind(c)
      import :: c_ptr, c_int
      type(c_ptr), value :: editor           !< address of the editor
      integer(c_int), intent(in) :: text(*)  !< code points, ended by a zero
    end function el_winsertstr

    !> An empty history.
    type(c_ptr) function history_winit() bind(c)
      import :: c_ptr
    end function history_winit

    !> Free a history.
    subroutine history_wend(history) bind(c)
      import :: c_ptr
      type(c_ptr), value :: history  !< address of the history
    end subroutine history_wend

    !> Perform an operation on a history.
    integer(c_int) function history_w(history, event, what, operand) bind(c)
      import :: c_ptr, c_int, c_intptr_t, history_event_type
      type(c_ptr), value :: history                     !< address of the history
      type(history_event_type), intent(inout) :: event  !< gets the answer
      integer(c_int), value :: what                     !< the operation, one of the numbers above
      integer(c_intptr_t), value :: operand             !< number or address of a text, by the operation
    end function history_w

    !> Duplicate the number of an open file.
    integer(c_int) function c_dup(descriptor) bind(c, name='dup')
      import :: c_int
      integer(c_int), value :: descriptor  !< number of the open file
    end function c_dup

    !> Open a stream of C on an open file.
    type(c_ptr) function c_fdopen(descriptor, mode) bind(c, name='fdopen')
      import :: c_ptr, c_int, c_char
      integer(c_int), value :: descriptor            !< number of the open file
      character(kind=c_char), intent(in) :: mode(*)  !< 'r' or 'w', ended by a zero
    end function c_fdopen

    !> Close a stream, and its file.
    integer(c_int) function c_fclose(file) bind(c, name='fclose')
      import :: c_ptr, c_int
      type(c_ptr), value :: file  !< the stream
    end function c_fclose

    !> Choose rules of a language; the empty name means those that the user has set.
    type(c_ptr) function c_setlocale(category, name) bind(c, name='setlocale')
      import :: c_ptr, c_int, c_char
      integer(c_int), value :: category              !< kind of rules, such as lc_ctype
      character(kind=c_char), intent(in) :: name(*)  !< name of the locale, ended by a zero
    end function c_setlocale
  end interface
end module mech9_libedit
