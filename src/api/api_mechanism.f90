!> Mechanisms for C: handles that read, hold and change the groups of a data file (include/mech9.h).
module mech9_api_mechanism
  use, intrinsic :: iso_c_binding, only: c_int, c_double, c_ptr, c_funptr, c_null_ptr, c_null_funptr, c_f_pointer, c_loc
  use mech9, only: error_type, finding_type, mechanism_type, parse_file, parse_text, string_type, name_coordinates, kinematics, &
    dynamics
  use mech9_importing, only: import_as_text
  use mech9_same_file, only: same_file
  use mech9_api_handle, only: is_live, mechanism_mark, no_mark
  use mech9_api_text, only: c_text_type, read_c_text
  use mech9_api_interruption, only: progress_type
  use mech9_api_error, only: begin_call, end_call, refuse
  implicit none
  private
  public :: find_mechanism, find_progress

  type :: mechanism_handle_type
    integer(c_int) :: mark = mechanism_mark
    type(mechanism_type) :: mechanism
    type(c_funptr) :: progress = c_null_funptr   !< function that learns how far long calls are; null: none
    type(c_ptr) :: progress_data = c_null_ptr    !< is given to it
    type(c_text_type) :: text           !< as the caller asked for it last
    type(c_text_type) :: imported       !< of an imported robot: its data file
    type(c_text_type) :: messages       !< of an imported robot: lines of what is not taken over, and a summary
  end type mechanism_handle_type

contains

  !> Read a data file.
  integer(c_int) function read_file(path, mechanism, error) bind(c, name='mech9_read_file') result(code)
    type(c_ptr), value, intent(in) :: path        !< of the data file
    type(c_ptr), intent(out) :: mechanism         !< the handle; null after a failure
    type(c_ptr), value, intent(in) :: error       !< handle of errors, or null
    type(mechanism_handle_type), pointer :: handle
    character(len=:), allocatable :: text
    type(finding_type), allocatable :: findings(:)
    type(error_type), allocatable :: err

    call begin_call(error)
    call read_c_text(path, text)
    allocate (handle)
    call parse_file(text, handle%mechanism, err, findings)
    code = end_reading(handle, mechanism, error, err, findings)
  end function read_file

  !> Read a text that has the form of a data file. An empty text makes a mechanism to which groups can be added.
  integer(c_int) function read_text(text, mechanism, error) bind(c, name='mech9_read_text') result(code)
    type(c_ptr), value, intent(in) :: text        !< groups of the data file
    type(c_ptr), intent(out) :: mechanism         !< the handle; null after a failure
    type(c_ptr), value, intent(in) :: error       !< handle of errors, or null
    type(mechanism_handle_type), pointer :: handle
    character(len=:), allocatable :: given
    type(finding_type), allocatable :: findings(:)
    type(error_type), allocatable :: err

    call begin_call(error)
    call read_c_text(text, given)
    allocate (handle)
    call parse_text(given, handle%mechanism, err, findings)
    code = end_reading(handle, mechanism, error, err, findings)
  end function read_text

  !> Import a robot from a file in URDF, MJCF or SDF.
  integer(c_int) function import_file(path, loops, with_forces, mechanism, error) bind(c, name='mech9_import_file') result(code)
    type(c_ptr), value, intent(in) :: path             !< of the robot
    type(c_ptr), value, intent(in) :: loops            !< path of a file of loops for URDF; null or empty: there is none
    integer(c_int), value, intent(in) :: with_forces   !< 0: drives hold the independent coordinates; else there are no drives
    type(c_ptr), intent(out) :: mechanism              !< the handle; null after a failure
    type(c_ptr), value, intent(in) :: error            !< handle of errors, or null
    type(mechanism_handle_type), pointer :: handle
    type(string_type) :: inputs(2)
    type(string_type), allocatable :: messages(:)
    character(len=:), allocatable :: text, lines
    type(finding_type), allocatable :: findings(:)
    type(error_type), allocatable :: err
    integer :: n, i

    call begin_call(error)
    call read_c_text(path, inputs(1)%text)
    call read_c_text(loops, inputs(2)%text)
    allocate (handle, findings(0))
    n = merge(1, 2, inputs(2)%text == '')
    call import_as_text(merge(kinematics, dynamics, with_forces == 0), inputs(:n), text, messages, err)
    if (.not. allocated(err)) then
      call parse_text(text, handle%mechanism, err, findings)
      lines = messages(1)%text
      do i = 2, size(messages)
        lines = lines//new_line(lines)//messages(i)%text
      end do
      call handle%imported%put(text)
      call handle%messages%put(lines)
    end if
    code = end_reading(handle, mechanism, error, err, findings)
  end function import_file

  !> The data file of an imported robot, as it was imported; null for other mechanisms.
  type(c_ptr) function imported_text(mechanism) bind(c, name='mech9_mechanism_imported_text')
    type(c_ptr), value, intent(in) :: mechanism   !< the handle
    type(mechanism_handle_type), pointer :: handle
    type(error_type), allocatable :: err

    imported_text = c_null_ptr
    call find_handle(mechanism, handle, err)
    if (.not. allocated(err)) imported_text = handle%imported%address()
  end function imported_text

  !> The messages of an import, a line each; null for other mechanisms.
  type(c_ptr) function import_messages(mechanism) bind(c, name='mech9_mechanism_import_messages')
    type(c_ptr), value, intent(in) :: mechanism   !< the handle
    type(mechanism_handle_type), pointer :: handle
    type(error_type), allocatable :: err

    import_messages = c_null_ptr
    call find_handle(mechanism, handle, err)
    if (.not. allocated(err)) import_messages = handle%messages%address()
  end function import_messages

  !> Give a handle to the caller, or free it after a failure.
  integer(c_int) function end_reading(handle, mechanism, error, err, findings) result(code)
    type(mechanism_handle_type), pointer, intent(inout) :: handle   !< the handle
    type(c_ptr), intent(out) :: mechanism                           !< its address; null after a failure
    type(c_ptr), intent(in) :: error                                !< handle of errors, or null
    type(error_type), allocatable, intent(inout) :: err             !< the failure, if there is one
    type(finding_type), intent(in) :: findings(:)                   !< all errors

    mechanism = c_null_ptr
    if (.not. allocated(err)) mechanism = c_loc(handle)
    if (allocated(err)) then
      call handle%imported%clear()
      call handle%messages%clear()
      deallocate (handle)
    end if
    code = end_call(error, err, findings=findings)
  end function end_reading

  !> Copy a mechanism.
  integer(c_int) function copy(mechanism, copied, error) bind(c, name='mech9_mechanism_copy') result(code)
    type(c_ptr), value, intent(in) :: mechanism   !< the handle
    type(c_ptr), intent(out) :: copied            !< handle of the copy; null after a failure
    type(c_ptr), value, intent(in) :: error       !< handle of errors, or null
    type(mechanism_handle_type), pointer :: handle, new
    type(error_type), allocatable :: err

    call begin_call(error)
    copied = c_null_ptr
    call find_handle(mechanism, handle, err)
    if (.not. allocated(err)) then
      allocate (new)
      new%mechanism = handle%mechanism
      copied = c_loc(new)
    end if
    code = end_call(error, err)
  end function copy

  !> Free a mechanism. Its runs and simulations stay.
  subroutine destroy(mechanism) bind(c, name='mech9_mechanism_destroy')
    type(c_ptr), value, intent(in) :: mechanism   !< the handle, or null
    type(mechanism_handle_type), pointer :: handle
    type(error_type), allocatable :: err

    call find_handle(mechanism, handle, err)
    if (allocated(err)) return
    call handle%text%clear()
    call handle%imported%clear()
    call handle%messages%clear()
    handle%mark = no_mark
    deallocate (handle)
  end subroutine destroy

  !> Register a function that learns how far long calls with a mechanism are.
  integer(c_int) function use_progress(mechanism, function, data, error) bind(c, name='mech9_mechanism_use_progress') result(code)
    type(c_ptr), value, intent(in) :: mechanism   !< the handle
    type(c_funptr), value, intent(in) :: function !< address of the function; null takes it back
    type(c_ptr), value, intent(in) :: data        !< is given to each call
    type(c_ptr), value, intent(in) :: error       !< handle of errors, or null
    type(mechanism_handle_type), pointer :: handle
    type(error_type), allocatable :: err

    call begin_call(error)
    call find_handle(mechanism, handle, err)
    if (.not. allocated(err)) then
      handle%progress = function
      handle%progress_data = data
    end if
    code = end_call(error, err)
  end function use_progress

  !> The function that learns how far a long call is, if one is registered.
  subroutine find_progress(mechanism, progress)
    type(c_ptr), intent(in) :: mechanism            !< the handle
    type(progress_type), intent(out) :: progress    !< gets the function
    type(mechanism_handle_type), pointer :: handle
    type(error_type), allocatable :: err

    call find_handle(mechanism, handle, err)
    if (allocated(err)) return
    progress%function = handle%progress
    progress%data = handle%progress_data
  end subroutine find_progress

  !> Add groups, written as in a data file.
  integer(c_int) function add(mechanism, groups, error) bind(c, name='mech9_mechanism_add') result(code)
    type(c_ptr), value, intent(in) :: mechanism   !< the handle
    type(c_ptr), value, intent(in) :: groups      !< their text
    type(c_ptr), value, intent(in) :: error       !< handle of errors, or null
    type(mechanism_handle_type), pointer :: handle
    character(len=:), allocatable :: text
    type(finding_type), allocatable :: findings(:)
    type(error_type), allocatable :: err

    call begin_call(error)
    call read_c_text(groups, text)
    allocate (findings(0))
    call find_handle(mechanism, handle, err)
    if (.not. allocated(err)) call handle%mechanism%add(text, err, findings)
    code = end_call(error, err, findings=findings)
  end function add

  !> Remove all groups of a name; there may be none.
  integer(c_int) function remove(mechanism, name, error) bind(c, name='mech9_mechanism_remove') result(code)
    type(c_ptr), value, intent(in) :: mechanism   !< the handle
    type(c_ptr), value, intent(in) :: name        !< of the groups
    type(c_ptr), value, intent(in) :: error       !< handle of errors, or null
    type(mechanism_handle_type), pointer :: handle
    character(len=:), allocatable :: text
    type(error_type), allocatable :: err

    call begin_call(error)
    call read_c_text(name, text)
    call find_handle(mechanism, handle, err)
    if (.not. allocated(err)) call handle%mechanism%remove(text)
    code = end_call(error, err)
  end function remove

  !> Give names other values, as the option --set does.
  integer(c_int) function apply(mechanism, setting, error) bind(c, name='mech9_mechanism_apply') result(code)
    type(c_ptr), value, intent(in) :: mechanism   !< the handle
    type(c_ptr), value, intent(in) :: setting     !< group.name=value
    type(c_ptr), value, intent(in) :: error       !< handle of errors, or null
    type(mechanism_handle_type), pointer :: handle
    character(len=:), allocatable :: text
    type(finding_type), allocatable :: findings(:)
    type(error_type), allocatable :: err

    call begin_call(error)
    call read_c_text(setting, text)
    allocate (findings(0))
    call find_handle(mechanism, handle, err)
    if (.not. allocated(err)) call handle%mechanism%apply(text, err, findings)
    code = end_call(error, err, findings=findings)
  end function apply

  !> Give a number another value.
  integer(c_int) function set(mechanism, name, value, error) bind(c, name='mech9_mechanism_set') result(code)
    type(c_ptr), value, intent(in) :: mechanism   !< the handle
    type(c_ptr), value, intent(in) :: name        !< of the number, as for --set: pair(2).point(1)
    real(c_double), value, intent(in) :: value    !< in the unit of the data file
    type(c_ptr), value, intent(in) :: error       !< handle of errors, or null
    type(mechanism_handle_type), pointer :: handle
    character(len=:), allocatable :: text
    type(error_type), allocatable :: err

    call begin_call(error)
    call read_c_text(name, text)
    call find_handle(mechanism, handle, err)
    if (.not. allocated(err)) call handle%mechanism%set(text, value, err)
    code = end_call(error, err)
  end function set

  !> A number by its name.
  integer(c_int) function number(mechanism, name, value, error) bind(c, name='mech9_mechanism_number') result(code)
    type(c_ptr), value, intent(in) :: mechanism   !< the handle
    type(c_ptr), value, intent(in) :: name        !< of the number
    real(c_double), intent(out) :: value          !< in the unit of the data file; not a number after a failure
    type(c_ptr), value, intent(in) :: error       !< handle of errors, or null
    type(mechanism_handle_type), pointer :: handle
    character(len=:), allocatable :: text
    type(error_type), allocatable :: err

    call begin_call(error)
    call read_c_text(name, text)
    call find_handle(mechanism, handle, err)
    if (.not. allocated(err)) then
      call handle%mechanism%number(text, value, err)
    else
      value = 0.0_c_double
    end if
    code = end_call(error, err)
  end function number

  !> The mechanism as the text of a data file. The text holds until the next call with this handle; null after a failure.
  type(c_ptr) function text_of(mechanism) bind(c, name='mech9_mechanism_text')
    type(c_ptr), value, intent(in) :: mechanism   !< the handle
    type(mechanism_handle_type), pointer :: handle
    character(len=:), allocatable :: text
    type(error_type), allocatable :: err

    text_of = c_null_ptr
    call find_handle(mechanism, handle, err)
    if (allocated(err)) return
    call handle%mechanism%text(text)
    call handle%text%put(text)
    text_of = handle%text%address()
  end function text_of

  !> The file that a path means among those of a mechanism; null where the mechanism reads no such file.
  type(c_ptr) function file_read(mechanism, path) bind(c, name='mech9_mechanism_reads')
    type(c_ptr), value, intent(in) :: mechanism   !< the handle
    type(c_ptr), value, intent(in) :: path        !< any name of a file
    type(mechanism_handle_type), pointer :: handle
    character(len=:), allocatable :: name
    type(string_type), allocatable :: files(:)
    type(error_type), allocatable :: err
    integer :: i

    file_read = c_null_ptr
    call find_handle(mechanism, handle, err)
    if (allocated(err)) return
    call read_c_text(path, name)
    call handle%mechanism%list_files(files)
    do i = 1, size(files)
      if (files(i)%text == '') cycle
      if (.not. same_file(files(i)%text, name)) cycle
      call handle%text%put(files(i)%text)
      file_read = handle%text%address()
      return
    end do
  end function file_read

  !> Number of parameters.
  integer(c_int) function parameters(mechanism) bind(c, name='mech9_mechanism_parameters')
    type(c_ptr), value, intent(in) :: mechanism   !< the handle
    type(mechanism_handle_type), pointer :: handle
    type(string_type), allocatable :: names(:)
    type(error_type), allocatable :: err

    parameters = 0
    call find_handle(mechanism, handle, err)
    if (allocated(err)) return
    call handle%mechanism%list_parameters(names)
    parameters = size(names)
  end function parameters

  !> Name of a parameter; null where there is none. The text holds until the next call with this handle.
  type(c_ptr) function parameter_name(mechanism, i) bind(c, name='mech9_mechanism_parameter')
    type(c_ptr), value, intent(in) :: mechanism   !< the handle
    integer(c_int), value, intent(in) :: i        !< its position, from 0
    type(mechanism_handle_type), pointer :: handle
    type(string_type), allocatable :: names(:)
    type(error_type), allocatable :: err

    parameter_name = c_null_ptr
    call find_handle(mechanism, handle, err)
    if (allocated(err)) return
    call handle%mechanism%list_parameters(names)
    if (i < 0 .or. i >= size(names)) return
    call handle%text%put(names(i + 1)%text)
    parameter_name = handle%text%address()
  end function parameter_name

  !> Judge whether drives move all independent coordinates.
  integer(c_int) function judge_drives(mechanism, all_driven, error) bind(c, name='mech9_mechanism_is_driven') result(code)
    type(c_ptr), value, intent(in) :: mechanism    !< the handle
    integer(c_int), intent(out) :: all_driven      !< 1: nothing moves by forces; else 0
    type(c_ptr), value, intent(in) :: error        !< handle of errors, or null
    type(mechanism_handle_type), pointer :: handle
    type(finding_type), allocatable :: findings(:)
    type(error_type), allocatable :: err
    logical :: driven

    call begin_call(error)
    all_driven = 0
    allocate (findings(0))
    call find_handle(mechanism, handle, err)
    if (.not. allocated(err)) then
      call handle%mechanism%judge_drives(driven, err)
      if (allocated(err)) then
        call handle%mechanism%list_findings(dynamics, findings)
      else
        all_driven = merge(1, 0, driven)
      end if
    end if
    code = end_call(error, err, findings=findings)
  end function judge_drives

  !> The mechanism of a design: with other values of its parameters, and with the coordinates of an assembly at its start.
  integer(c_int) function take_design(mechanism, with_forces, parameters, q, design, error) &
    bind(c, name='mech9_mechanism_design') result(code)
    type(c_ptr), value, intent(in) :: mechanism        !< the handle
    integer(c_int), value, intent(in) :: with_forces   !< 0: driven motions; else motions under forces
    type(c_ptr), value, intent(in) :: parameters       !< values of all parameters [units of the data file]
    type(c_ptr), value, intent(in) :: q                !< (M) coordinates at the start [units of the data file]
    type(c_ptr), intent(out) :: design                 !< handle of the design; null after a failure
    type(c_ptr), value, intent(in) :: error            !< handle of errors, or null
    type(mechanism_handle_type), pointer :: handle, new
    type(string_type), allocatable :: of_parameters(:)
    character(len=:), allocatable :: names(:), units(:)
    real(c_double), allocatable :: sizes(:)
    real(c_double), pointer :: values(:), positions(:)
    type(error_type), allocatable :: err

    call begin_call(error)
    design = c_null_ptr
    call find_handle(mechanism, handle, err)
    if (.not. allocated(err)) call name_coordinates(handle%mechanism, names, units, sizes, err)
    if (.not. allocated(err)) then
      call handle%mechanism%list_parameters(of_parameters)
      call c_f_pointer(parameters, values, [size(of_parameters)])
      call c_f_pointer(q, positions, [size(names)])
      allocate (new)
      call handle%mechanism%take_design(merge(kinematics, dynamics, with_forces == 0), values, positions*sizes, new%mechanism, err)
      if (allocated(err)) deallocate (new)
    end if
    if (.not. allocated(err)) design = c_loc(new)
    code = end_call(error, err)
  end function take_design

  !> The mechanism of a handle. Fails with exit_usage where there is none.
  subroutine find_mechanism(address, mechanism, err)
    type(c_ptr), intent(in) :: address                          !< of the handle
    type(mechanism_type), pointer, intent(out) :: mechanism     !< the mechanism; null after a failure
    type(error_type), allocatable, intent(out) :: err           !< allocated if it failed
    type(mechanism_handle_type), pointer :: handle

    mechanism => null()
    call find_handle(address, handle, err)
    if (.not. allocated(err)) mechanism => handle%mechanism
  end subroutine find_mechanism

  !> The handle at an address. Fails with exit_usage where there is none.
  subroutine find_handle(address, handle, err)
    type(c_ptr), intent(in) :: address                              !< its address
    type(mechanism_handle_type), pointer, intent(out) :: handle     !< the handle
    type(error_type), allocatable, intent(out) :: err               !< allocated if it failed

    handle => null()
    if (is_live(address, mechanism_mark)) then
      call c_f_pointer(address, handle)
    else
      call refuse('this is no mechanism, or it was destroyed; read one first', err)
    end if
  end subroutine find_handle
end module mech9_api_mechanism
