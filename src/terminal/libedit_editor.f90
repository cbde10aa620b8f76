!> A line edited on a terminal by libedit: keys, history, completion.
!>
!> libedit calls procedures of this module for the prompt, for each key and for completion. Their data belong to the
!> editor as its client data: a box of plain Fortran variables. Ctrl-C is a key here and not a signal.
module mech9_libedit_editor
  use, intrinsic :: iso_c_binding, only: c_int, c_intptr_t, c_signed_char, c_char, c_ptr, c_null_ptr, c_null_char, c_loc, &
                                         c_funloc, c_funptr, c_f_pointer, c_associated
  use, intrinsic :: iso_fortran_env, only: error_unit
  use mech9_text, only: string_type
  use mech9_system, only: standard_input, standard_error
  use mech9_input_bytes, only: input_bytes_type, input_read, input_ended, input_interrupted
  use mech9_completion, only: find_completions, common_beginning, in_columns
  use mech9_wide_text, only: to_wide, to_bytes, code_point, unknown_character
  use mech9_libedit, only: el_init, el_end, el_wset, el_wget, el_wgets, el_wline, el_winsertstr, &
                           history_winit, history_wend, history_w, c_dup, c_fdopen, c_fclose, c_setlocale, &
                           history_event_type, line_info_type, wide, lc_ctype, el_prompt, el_editor, el_signal, el_bind, &
                           el_setty, el_addfn, el_hist, el_getcfn, el_clientdata, el_prep_term, el_refresh, h_setsize, h_enter, &
                           h_setunique, cc_refresh, cc_error, cc_redisplay
  implicit none
  private
  public :: line_editor_type

  integer(c_intptr_t), parameter :: nothing = 0
  !> Number of answers that the history keeps.
  integer(c_intptr_t), parameter :: history_size = 1000
  !> Most letters of a line, as many as the terminal itself accepts; libedit draws longer lines slowly.
  integer, parameter :: longest_line = 4095
  character, parameter :: ctrl_c = achar(3), bell = achar(7)
  !> Name of the function for completion, to which keys are bound.
  character(len=*), parameter :: completion_name = 'complete-word'

  !> Data for the functions that libedit calls.
  type :: box_type
    type(input_bytes_type) :: bytes
    integer :: status = input_read  !< input_read, or the reason why there are no more keys
    integer(wide), allocatable :: prompt(:)
    type(string_type), allocatable :: words(:)
    integer(wide), allocatable :: name(:)  !< name of the function for completion, whose address libedit keeps
  end type box_type

  !> One editor, on standard input and standard error.
  type :: line_editor_type
    private
    type(c_ptr) :: editor = c_null_ptr
    type(c_ptr) :: history = c_null_ptr
    type(c_ptr) :: input = c_null_ptr, output = c_null_ptr  !< streams of C
    type(history_event_type) :: event
    type(box_type), pointer :: box => null()
  contains
    procedure :: start
    procedure :: read_line
    procedure :: stop => stop_editor
  end type line_editor_type

contains

  !> Start the editor; `ready` is false where the terminal cannot be used.
  subroutine start(self, program_name, ready)
    class(line_editor_type), intent(inout) :: self  !< the line editor
    character(len=*), intent(in) :: program_name    !< name for the user's settings of libedit
    logical, intent(out) :: ready                   !< whether lines can be edited

    call take_letters_of_user()
    self%input = c_fdopen(c_dup(int(standard_input, c_int)), 'r'//c_null_char)
    self%output = c_fdopen(c_dup(int(standard_error, c_int)), 'w'//c_null_char)
    ready = c_associated(self%input) .and. c_associated(self%output)
    if (ready) then
      self%editor = el_init(program_name//c_null_char, self%input, self%output, self%output)
      self%history = history_winit()
      ready = c_associated(self%editor) .and. c_associated(self%history)
    end if
    if (ready) then
      allocate (self%box)
      call fill_box(self%box, '')
      call set_up(self)
    else
      call self%stop()
    end if
  end subroutine start

  !> Show letters by the user's locale; where the user has set none, show all letters of Unicode. The form of numbers
  !> does not change.
  subroutine take_letters_of_user()
    type(c_ptr) :: name
    character(kind=c_char), pointer :: letters(:)

    name = c_setlocale(lc_ctype, c_null_char)
    if (c_associated(name)) then
      call c_f_pointer(name, letters, [2])
      ! the user has chosen a locale other than C
      if (letters(1) /= 'C' .or. letters(2) /= c_null_char) return
    end if
    name = c_setlocale(lc_ctype, 'C.UTF-8'//c_null_char)
  end subroutine take_letters_of_user

  !> Change the settings of libedit that differ from its defaults.
  subroutine set_up(self)
    class(line_editor_type), intent(inout) :: self  !< the line editor
    integer(c_int) :: status

    status = history_w(self%history, self%event, h_setsize, history_size)
    status = history_w(self%history, self%event, h_setunique, 1_c_intptr_t)
    status = el_wset(self%editor, el_clientdata, word_of(c_loc(self%box)), nothing, nothing)
    call set_text(self%editor, el_editor, 'emacs')
    status = el_wset(self%editor, el_signal, 1_c_intptr_t, nothing, nothing)
    status = el_wset(self%editor, el_prompt, function_word(c_funloc(show_prompt)), nothing, nothing)
    status = el_wset(self%editor, el_getcfn, function_word(c_funloc(get_key)), nothing, nothing)
    status = el_wset(self%editor, el_hist, function_word(c_funloc(history_w)), word_of(self%history), nothing)
    status = el_wset(self%editor, el_addfn, word_of(c_loc(self%box%name)), word_of(c_loc(self%box%name)), &
                     function_word(c_funloc(complete_word)))
    call set_text(self%editor, el_bind, '^I', completion_name)
    call set_text(self%editor, el_bind, '^R', 'em-inc-search-prev')
    call set_text(self%editor, el_bind, '\e[3~', 'ed-delete-next-char')
    call set_text(self%editor, el_bind, '\e[1;5D', 'ed-prev-word')
    call set_text(self%editor, el_bind, '\e[1;5C', 'em-next-word')
    ! the editor's own command line is switched off
    call set_text(self%editor, el_bind, '\ex', 'ed-unassigned')
    call set_text(self%editor, el_bind, '\eX', 'ed-unassigned')
    ! while a line is edited, the terminal makes no signal of Ctrl-C
    call set_text(self%editor, el_setty, '-d', 'intr=')
  end subroutine set_up

  !> Store the data of a prompt. This is a procedure of its own because of gfortran 12. When a component is reached
  !> through a pointer in a polymorphic variable, that compiler does not allocate it on assignment.
  subroutine fill_box(box, prompt, words)
    type(box_type), intent(inout) :: box                 !< gets the data
    character(len=*), intent(in) :: prompt               !< text before the line
    type(string_type), intent(in), optional :: words(:)  !< words offered for completion; absent: none

    box%status = input_read
    box%prompt = to_wide(prompt)
    if (present(words)) then
      box%words = words
    else
      box%name = to_wide(completion_name)
    end if
  end subroutine fill_box

  !> Show the prompt and wait for a line.
  subroutine read_line(self, prompt, words, line, status)
    class(line_editor_type), intent(inout) :: self      !< the line editor
    character(len=*), intent(in) :: prompt              !< text before the line, without a line end
    type(string_type), intent(in) :: words(:)           !< words offered for completion
    character(len=:), allocatable, intent(out) :: line  !< the line without its end
    integer, intent(out) :: status                      !< see next_byte of mech9_input_bytes
    integer(wide), pointer :: points(:)
    integer(wide), allocatable, target :: remembered(:)
    type(c_ptr) :: address
    integer(c_int) :: count, ignored

    call fill_box(self%box, prompt, words)
    ! set before the prompt appears, or the terminal would show again the letters that are typed meanwhile
    ignored = el_wset(self%editor, el_prep_term, 1_c_intptr_t, nothing, nothing)
    address = el_wgets(self%editor, count)
    line = ''
    status = self%box%status
    if (.not. c_associated(address) .or. count <= 0) then
      if (status == input_read) status = input_ended   ! Ctrl-D
      return
    end if
    call c_f_pointer(address, points, [count])
    line = to_bytes(points)
    if (status /= input_read) return
    if (points(count) == iachar(new_line('a'))) line = line(:len(line) - 1)
    if (verify(line, ' ') == 0) return
    remembered = to_wide(line)
    ignored = history_w(self%history, self%event, h_enter, word_of(c_loc(remembered)))
  end subroutine read_line

  !> Free editor, history, streams and data.
  subroutine stop_editor(self)
    class(line_editor_type), intent(inout) :: self  !< the line editor
    integer(c_int) :: ignored

    if (c_associated(self%editor)) call el_end(self%editor)
    if (c_associated(self%history)) call history_wend(self%history)
    if (c_associated(self%input)) ignored = c_fclose(self%input)
    if (c_associated(self%output)) ignored = c_fclose(self%output)
    if (associated(self%box)) deallocate (self%box)
    self%editor = c_null_ptr
    self%history = c_null_ptr
    self%input = c_null_ptr
    self%output = c_null_ptr
  end subroutine stop_editor

  !> The prompt; libedit calls this function.
  type(c_ptr) function show_prompt(editor) bind(c)
    type(c_ptr), value :: editor  !< address of the editor
    type(box_type), pointer :: box

    box => box_of(editor)
    show_prompt = c_loc(box%prompt)
  end function show_prompt

  !> Read the next key, one code point, and return how many were read; libedit calls this function.
  integer(c_int) function get_key(editor, key) bind(c)
    type(c_ptr), value :: editor       !< address of the editor
    integer(wide), intent(out) :: key  !< code point of the key
    type(box_type), pointer :: box
    logical :: disturbed

    box => box_of(editor)
    do
      call read_character(box%bytes, key, box%status, disturbed)
      if (disturbed) then
        call draw_again(editor)
        cycle
      end if
      if (box%status /= input_read .or. .not. is_letter(key)) exit
      if (line_length(editor) < longest_line) exit
      write (error_unit, '(a)', advance='no') bell
    end do
    if (box%status == input_read .and. key == iachar(ctrl_c)) box%status = input_interrupted
    get_key = merge(1_c_int, 0_c_int, box%status == input_read)
  end function get_key

  !> Draw prompt and line again, from the beginning of the line that the cursor is in.
  subroutine draw_again(editor)
    type(c_ptr), intent(in) :: editor  !< address of the editor
    integer(c_int) :: ignored

    write (error_unit, '(a)', advance='no') achar(13)
    flush (error_unit)
    ignored = el_wset(editor, el_refresh, nothing, nothing, nothing)
  end subroutine draw_again

  !> Whether a key is a letter and not a command.
  pure logical function is_letter(key)
    integer(wide), intent(in) :: key  !< code point of the key

    is_letter = key >= 32 .and. key /= 127
  end function is_letter

  !> Number of letters of the present line.
  integer function line_length(editor)
    type(c_ptr), intent(in) :: editor  !< address of the editor
    type(line_info_type), pointer :: info

    call c_f_pointer(el_wline(editor), info)
    line_length = int((info%behind - info%first)/(storage_size(1_wide)/8))
  end function line_length

  !> Read one UTF-8 character; it is unknown_character where the bytes form none.
  subroutine read_character(bytes, point, status, disturbed)
    type(input_bytes_type), intent(inout) :: bytes  !< standard input
    integer(wide), intent(out) :: point             !< code point of the character
    integer, intent(out) :: status                  !< input_read, input_ended or input_interrupted
    logical, intent(out) :: disturbed               !< see next_byte of mech9_input_bytes
    character(len=4) :: letter
    integer :: length, i

    point = 0
    call bytes%next_byte(letter(1:1), status, disturbed)
    if (status /= input_read .or. disturbed) return
    ! the number of leading one bits is the number of bytes
    length = max(1, leadz(not(ishft(ichar(letter(1:1)), bit_size(1) - 8))))
    point = unknown_character
    if (length > 4) return
    do i = 2, length
      call bytes%next_byte(letter(i:i), status)
      if (status /= input_read) return
      if (ichar(letter(i:i)) >= 128 .and. ichar(letter(i:i)) < 192) cycle
      call bytes%step_back()
      return
    end do
    point = code_point(letter(:length))
  end subroutine read_character

  !> Insert the letters that all fitting words have in common, or list these words where there are none. libedit calls this
  !> function for the key Tab.
  integer(c_signed_char) function complete_word(editor, key) bind(c)
    type(c_ptr), value :: editor  !< address of the editor
    integer(c_int), value :: key  !< code of the key, not used
    type(box_type), pointer :: box
    type(string_type), allocatable :: found(:)
    character(len=:), allocatable :: common
    character :: ending
    integer :: answer, typed

    box => box_of(editor)
    call find_completions(line_to_cursor(editor), box%words, found, typed, ending)
    common = common_beginning(found)
    answer = cc_error
    if (size(found) == 1) common = common//ending
    if (len(common) > typed) then
      if (el_winsertstr(editor, to_wide(common(typed + 1:))) == 0) answer = cc_refresh
    else if (size(found) > 1) then
      write (error_unit, '(a)', advance='no') new_line('a')//in_columns(found, 79)
      flush (error_unit)
      answer = cc_redisplay
    end if
    complete_word = int(answer, c_signed_char)
  end function complete_word

  !> The text before the cursor.
  function line_to_cursor(editor) result(text)
    type(c_ptr), intent(in) :: editor  !< address of the editor
    character(len=:), allocatable :: text
    type(line_info_type), pointer :: info
    integer(wide), pointer :: points(:)

    call c_f_pointer(el_wline(editor), info)
    call c_f_pointer(transfer(info%first, c_null_ptr), points, &
                     [(info%cursor - info%first)/(storage_size(1_wide)/8)])
    text = to_bytes(points)
  end function line_to_cursor

  !> The data of an editor.
  function box_of(editor) result(box)
    type(c_ptr), intent(in) :: editor  !< address of the editor
    type(box_type), pointer :: box
    type(c_ptr) :: address

    if (el_wget(editor, el_clientdata, address) /= 0) address = c_null_ptr
    call c_f_pointer(address, box)
  end function box_of

  !> Change a setting that takes texts. libedit reads them only during this call.
  subroutine set_text(editor, what, first, second)
    type(c_ptr), intent(in) :: editor                 !< address of the editor
    integer(c_int), intent(in) :: what                !< number of the setting, such as el_bind
    character(len=*), intent(in) :: first             !< its first text
    character(len=*), intent(in), optional :: second  !< its second text; absent: none
    integer(wide), allocatable, target :: one(:), other(:)
    integer(c_int) :: ignored

    one = to_wide(first)
    if (present(second)) then
      other = to_wide(second)
      ignored = el_wset(editor, what, word_of(c_loc(one)), word_of(c_loc(other)), nothing)
    else
      ignored = el_wset(editor, what, word_of(c_loc(one)), nothing, nothing)
    end if
  end subroutine set_text

  !> An address as a machine word.
  pure integer(c_intptr_t) function word_of(address)
    type(c_ptr), intent(in) :: address  !< any address

    word_of = transfer(address, 0_c_intptr_t)
  end function word_of

  !> The address of a function as a machine word. The argument is passed by value: gfortran would otherwise place the address
  !> of a function of a shared library where the loader cannot set it.
  pure integer(c_intptr_t) function function_word(address)
    type(c_funptr), value :: address  !< address of the function

    function_word = transfer(address, 0_c_intptr_t)
  end function function_word
end module mech9_libedit_editor
