!> Errors for C: a handle that holds the last failure, with its place and all findings (include/mech9.h).
module mech9_api_error
  use, intrinsic :: iso_c_binding, only: c_int, c_ptr, c_null_ptr, c_f_pointer, c_loc
  use mech9, only: error_type, finding_type, mechanism_type, exit_usage
  use mech9_api_handle, only: is_live, error_mark, no_mark
  use mech9_api_text, only: c_text_type
  implicit none
  private
  public :: begin_call, end_call, refuse

  type :: shown_finding_type
    type(c_text_type) :: message
    type(c_text_type) :: file
    integer(c_int) :: line = 0
    integer(c_int) :: column = 0
  end type shown_finding_type

  type :: error_handle_type
    integer(c_int) :: mark = error_mark
    integer(c_int) :: code = 0
    type(c_text_type) :: message
    type(shown_finding_type), allocatable :: findings(:)
  end type error_handle_type

contains

  !> Make a handle without a failure.
  type(c_ptr) function create() bind(c, name='mech9_error_create')
    type(error_handle_type), pointer :: handle

    allocate (handle)
    allocate (handle%findings(0))
    call handle%message%put('')
    create = c_loc(handle)
  end function create

  !> Free a handle.
  subroutine destroy(error) bind(c, name='mech9_error_destroy')
    type(c_ptr), value, intent(in) :: error   !< the handle, or null
    type(error_handle_type), pointer :: handle

    call find_handle(error, handle)
    if (.not. associated(handle)) return
    call forget(handle)
    call handle%message%clear()
    handle%mark = no_mark
    deallocate (handle)
  end subroutine destroy

  !> Exit code of the last failure; 0: the last call was successful.
  integer(c_int) function code_of(error) bind(c, name='mech9_error_code')
    type(c_ptr), value, intent(in) :: error   !< the handle
    type(error_handle_type), pointer :: handle

    code_of = 0
    call find_handle(error, handle)
    if (associated(handle)) code_of = handle%code
  end function code_of

  !> Message of the last failure, as the programs print it.
  type(c_ptr) function message_of(error) bind(c, name='mech9_error_message')
    type(c_ptr), value, intent(in) :: error   !< the handle
    type(error_handle_type), pointer :: handle

    message_of = c_null_ptr
    call find_handle(error, handle)
    if (associated(handle)) message_of = handle%message%address()
  end function message_of

  !> Number of errors that were found together.
  integer(c_int) function findings_of(error) bind(c, name='mech9_error_findings')
    type(c_ptr), value, intent(in) :: error   !< the handle
    type(error_handle_type), pointer :: handle

    findings_of = 0
    call find_handle(error, handle)
    if (associated(handle)) findings_of = size(handle%findings)
  end function findings_of

  !> Message of one error, without its place; null where there is no such error.
  type(c_ptr) function finding_message(error, i) bind(c, name='mech9_error_finding_message')
    type(c_ptr), value, intent(in) :: error      !< the handle
    integer(c_int), value, intent(in) :: i       !< its number, from 0
    type(shown_finding_type), pointer :: finding

    finding_message = c_null_ptr
    call find_finding(error, i, finding)
    if (associated(finding)) finding_message = finding%message%address()
  end function finding_message

  !> Path of the file of one error; empty where it is in no file, null where there is no such error.
  type(c_ptr) function finding_file(error, i) bind(c, name='mech9_error_finding_file')
    type(c_ptr), value, intent(in) :: error      !< the handle
    integer(c_int), value, intent(in) :: i       !< its number, from 0
    type(shown_finding_type), pointer :: finding

    finding_file = c_null_ptr
    call find_finding(error, i, finding)
    if (associated(finding)) finding_file = finding%file%address()
  end function finding_file

  !> Line of one error in its file, from 1; 0 where none is known.
  integer(c_int) function finding_line(error, i) bind(c, name='mech9_error_finding_line')
    type(c_ptr), value, intent(in) :: error      !< the handle
    integer(c_int), value, intent(in) :: i       !< its number, from 0
    type(shown_finding_type), pointer :: finding

    finding_line = 0
    call find_finding(error, i, finding)
    if (associated(finding)) finding_line = finding%line
  end function finding_line

  !> Column of one error in its line, from 1; 0 where none is known.
  integer(c_int) function finding_column(error, i) bind(c, name='mech9_error_finding_column')
    type(c_ptr), value, intent(in) :: error      !< the handle
    integer(c_int), value, intent(in) :: i       !< its number, from 0
    type(shown_finding_type), pointer :: finding

    finding_column = 0
    call find_finding(error, i, finding)
    if (associated(finding)) finding_column = finding%column
  end function finding_column

  !> The handle at an address; null where there is none.
  subroutine find_handle(error, handle)
    type(c_ptr), intent(in) :: error                           !< its address
    type(error_handle_type), pointer, intent(out) :: handle    !< the handle

    handle => null()
    if (is_live(error, error_mark)) call c_f_pointer(error, handle)
  end subroutine find_handle

  !> One of the errors of a handle; null where there is none.
  subroutine find_finding(error, i, finding)
    type(c_ptr), intent(in) :: error                            !< address of the handle
    integer(c_int), intent(in) :: i                             !< its number, from 0
    type(shown_finding_type), pointer, intent(out) :: finding   !< the error
    type(error_handle_type), pointer :: handle

    finding => null()
    call find_handle(error, handle)
    if (.not. associated(handle)) return
    if (i >= 0 .and. i < size(handle%findings)) finding => handle%findings(i + 1)
  end subroutine find_finding

  !> Forget the failure of a handle.
  subroutine forget(handle)
    type(error_handle_type), intent(inout) :: handle   !< the handle
    integer :: i

    do i = 1, size(handle%findings)
      call handle%findings(i)%message%clear()
      call handle%findings(i)%file%clear()
    end do
    deallocate (handle%findings)
    allocate (handle%findings(0))
    handle%code = 0
    call handle%message%put('')
  end subroutine forget

  !> Begin a call: it has not failed.
  subroutine begin_call(error)
    type(c_ptr), intent(in) :: error   !< address of the caller's error handle, or null
    type(error_handle_type), pointer :: handle

    call find_handle(error, handle)
    if (associated(handle)) call forget(handle)
  end subroutine begin_call

  !> End a call with its exit code, and tell its failure, if there is one, to the caller's error handle.
  integer(c_int) function end_call(error, err, mechanism, findings) result(code)
    type(c_ptr), intent(in) :: error                               !< address of the caller's error handle, or null
    type(error_type), allocatable, intent(inout) :: err            !< the failure; not allocated: the call was successful
    type(mechanism_type), intent(in), optional :: mechanism        !< knows the file of a failure that has a place
    type(finding_type), intent(in), optional :: findings(:)        !< all errors, where there are several
    type(error_handle_type), pointer :: handle
    type(finding_type) :: only
    integer :: i

    code = 0
    if (.not. allocated(err)) return
    code = err%code
    call find_handle(error, handle)
    if (.not. associated(handle)) return
    call forget(handle)
    handle%code = err%code
    call handle%message%put(err%message)
    if (present(findings)) then
      if (size(findings) > 0) then
        deallocate (handle%findings)
        allocate (handle%findings(size(findings)))
        do i = 1, size(findings)
          call show(findings(i), handle%findings(i))
        end do
        return
      end if
    end if
    only%message = err%message
    only%file = ''
    if (present(mechanism)) call mechanism%find_error_place(err, only%file, only%line, only%column)
    deallocate (handle%findings)
    allocate (handle%findings(1))
    call show(only, handle%findings(1))
  end function end_call

  !> Show one error to C.
  subroutine show(finding, shown)
    type(finding_type), intent(in) :: finding            !< the error
    type(shown_finding_type), intent(inout) :: shown     !< gets its texts and place

    call shown%message%put(finding%message)
    call shown%file%put(finding%file)
    shown%line = finding%line
    shown%column = finding%column
  end subroutine show

  !> Refuse a call.
  subroutine refuse(message, err)
    character(len=*), intent(in) :: message             !< the reason and a remedy
    type(error_type), allocatable, intent(out) :: err   !< the failure

    allocate (err)
    err%code = exit_usage
    err%message = message
  end subroutine refuse
end module mech9_api_error
