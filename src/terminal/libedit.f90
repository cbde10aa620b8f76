!> The functions of libedit that are needed, as they stand in histedit.h.
!>
!> Some of them take a variable list of arguments, which Fortran has no word for. They are declared with as
!> many machine words as any call of ours needs: on the processors for which CMake lets libedit in, whole numbers
!> and addresses are handed to such a function as to any other, and those that it does not look at do no harm.
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

  ! What el_wset, history_w and setlocale are asked for.
  integer(c_int), parameter :: el_prompt = 0, el_editor = 2, el_signal = 3, el_bind = 4, el_setty = 8, &
                               el_addfn = 9, el_hist = 10, el_getcfn = 13, el_clientdata = 14, el_prep_term = 16, el_refresh = 20
  integer(c_int), parameter :: h_setsize = 1, h_enter = 10, h_setunique = 20
  integer(c_int), parameter :: lc_ctype = 0
  ! What a function bound to a key answers.
  integer, parameter :: cc_refresh = 4, cc_error = 6, cc_redisplay = 8

  !> HistEventW: where the history puts its answers.
  type, bind(c) :: history_event_type
    integer(c_int) :: number = 0
    integer(c_intptr_t) :: text = 0
  end type history_event_type

  !> LineInfoW: addresses of the line's first character, of that at the cursor, and behind the last.
  type, bind(c) :: line_info_type
    integer(c_intptr_t) :: first, cursor, behind
  end type line_info_type

  interface
    !> An editor on streams of C; null where there is none.
    type(c_ptr) function el_init(program_name, input, output, errors) bind(c)
      import :: c_ptr, c_char
      character(kind=c_char), intent(in) :: program_name(*)
      type(c_ptr), value :: input, output, errors
    end function el_init

    !> Give an editor back.
    subroutine el_end(editor) bind(c)
      import :: c_ptr
      type(c_ptr), value :: editor
    end subroutine el_end

    !> Set something; what the words mean depends on it.
    integer(c_int) function el_wset(editor, what, first, second, third) bind(c)
      import :: c_ptr, c_int, c_intptr_t
      type(c_ptr), value :: editor
      integer(c_int), value :: what
      integer(c_intptr_t), value :: first, second, third
    end function el_wset

    !> Ask what was set; here for an address.
    integer(c_int) function el_wget(editor, what, answer) bind(c)
      import :: c_ptr, c_int
      type(c_ptr), value :: editor
      integer(c_int), value :: what
      type(c_ptr), intent(out) :: answer
    end function el_wget

    !> Edit a line: the address of its characters with its end among them; null at the end of input.
    type(c_ptr) function el_wgets(editor, count) bind(c)
      import :: c_ptr, c_int
      type(c_ptr), value :: editor
      integer(c_int), intent(out) :: count
    end function el_wgets

    !> The address of the line as it stands, a line_info_type.
    type(c_ptr) function el_wline(editor) bind(c)
      import :: c_ptr
      type(c_ptr), value :: editor
    end function el_wline

    !> Put characters in at the cursor; -1 where there is no room.
    integer(c_int) function el_winsertstr(editor, text) bind(c)
      import :: c_ptr, c_int
      type(c_ptr), value :: editor
      integer(c_int), intent(in) :: text(*)
    end function el_winsertstr

    !> An empty history.
    type(c_ptr) function history_winit() bind(c)
      import :: c_ptr
    end function history_winit

    !> Give a history back.
    subroutine history_wend(history) bind(c)
      import :: c_ptr
      type(c_ptr), value :: history
    end subroutine history_wend

    !> Ask something of a history.
    integer(c_int) function history_w(history, event, what, operand) bind(c)
      import :: c_ptr, c_int, c_intptr_t, history_event_type
      type(c_ptr), value :: history
      type(history_event_type), intent(inout) :: event
      integer(c_int), value :: what
      integer(c_intptr_t), value :: operand
    end function history_w

    !> One more number for an open file.
    integer(c_int) function c_dup(descriptor) bind(c, name='dup')
      import :: c_int
      integer(c_int), value :: descriptor
    end function c_dup

    !> A stream of C on an open file.
    type(c_ptr) function c_fdopen(descriptor, mode) bind(c, name='fdopen')
      import :: c_ptr, c_int, c_char
      integer(c_int), value :: descriptor
      character(kind=c_char), intent(in) :: mode(*)
    end function c_fdopen

    !> Close a stream, and its file.
    integer(c_int) function c_fclose(file) bind(c, name='fclose')
      import :: c_ptr, c_int
      type(c_ptr), value :: file
    end function c_fclose

    !> Choose how the system writes something; the empty name means the user's own way.
    type(c_ptr) function c_setlocale(category, name) bind(c, name='setlocale')
      import :: c_ptr, c_int, c_char
      integer(c_int), value :: category
      character(kind=c_char), intent(in) :: name(*)
    end function c_setlocale
  end interface
end module mech9_libedit
