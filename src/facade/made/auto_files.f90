!> Files for AUTO-07p: the equations of motion as its subroutine FUNC, which calls the library, its constants, and a periodic motion as a
!> start (Doedel and Oldeman, AUTO-07p: continuation and bifurcation software for ordinary differential equations, 2012).
module mech9_auto_files
  use mech9_program_kind, only: dynamics
  use mech9_kinds, only: wp
  use mech9_error, only: error_type, raise, exit_data
  use mech9_text, only: to_text, in_apostrophes
  use mech9_printable, only: with_escapes
  use mech9_text_file, only: save_text
  use mech9_model, only: model_type
  use mech9_long_term, only: branch_request_type
  use mech9_law_periods, only: law_period_type, find_law_period
  use mech9_period_map, only: period_map_type
  use mech9_periodic, only: periodic_found_type, find_periodic
  use mech9_rest, only: rest_type
  use mech9_branches, only: first_request, begin_at_rest, refuse_family
  use mech9_state_rates, only: refuse_jumps
  use mech9_checked_mechanism, only: checked_mechanism_type
  use mech9_motion_equations, only: motion_equations_type
  implicit none
  private
  public :: write_auto_files

  !> AUTO keeps its own numbers in the parameters behind this one.
  integer, parameter :: most_parameters = 9
  !> Letters of a name in AUTO.
  integer, parameter :: longest_name = 13
  !> Times in a period at which the start is given.
  integer, parameter :: times_of_period = 400
  !> Geometric mean of the ranges that parameters have in AUTO.
  real(wp), parameter :: usual_range = 6.0_wp
  !> States count in tenths of a radian or of the mechanism's size. Parameters then change little from step to step, beside the states,
  !> where a branch folds: AUTO sees a fold only where directions of the branch turn by less than a right angle in a step.
  integer, parameter :: power_of_states = -1
  !> Longest step of AUTO in these units, per longest step of &branch.
  real(wp), parameter :: part_of_step = 4.0_wp
  real(wp), parameter :: turn = 8.0_wp*atan(1.0_wp)
  !> Number in AUTO of the period.
  integer, parameter :: number_of_period = 11
  character, parameter :: eol = achar(10)
  !> By this line mech9-link knows files that it may replace.
  character(len=*), parameter :: first_line = '! Equations of motion for AUTO-07p, written by mech9-link --auto from the data file'

  !> The start of a continuation and what is known about it.
  type :: start_type
    type(branch_request_type) :: request            !< the group &branch
    integer :: number = 0                           !< of its parameter
    logical :: is_periodic = .false.                !< periodic motions, else positions of rest
    logical :: has_clock = .false.                  !< drives or loads follow time
    real(wp) :: period = 0.0_wp                     !< of the motion [s]
    real(wp), allocatable :: q(:)                   !< (M) coordinates at the start [rad, m]
    real(wp), allocatable :: x(:)                   !< (states) the state at the start
    real(wp), allocatable :: times(:)               !< (T) from 0 to the period [s]
    real(wp), allocatable :: states(:, :)           !< (states,T) the motion
    integer, allocatable :: power(:)                !< (states) of ten that is one unit of AUTO
    integer, allocatable :: parameter_power(:)      !< (parameters) of ten, too
  end type start_type

contains

  !> Write FOLDER/NAME.f90 and c.NAME, for a periodic motion NAME.dat, too. Fails with exit_data where the data file has no &branch or where its
  !> equations are no smooth function of the state, as the search for the start does, and with exit_file where a file cannot be written.
  subroutine write_auto_files(mechanism, path, folder, name, files, err)
    type(checked_mechanism_type), intent(in) :: mechanism     !< with a group &branch
    character(len=*), intent(in) :: path                      !< of its data file, from the root of the file system
    character(len=*), intent(in) :: folder                    !< of the files
    character(len=*), intent(in) :: name                      !< the name that AUTO uses
    character(len=:), allocatable, intent(out) :: files       !< the files, as 'NAME.f90, c.NAME'
    type(error_type), allocatable, intent(out) :: err         !< allocated if it failed
    type(model_type) :: model
    type(start_type) :: start
    type(motion_equations_type) :: equations

    files = ''
    call mechanism%take_request(dynamics, model, err)
    if (.not. allocated(err)) call find_start(model, start, err)
    call mechanism%point_at(err)
    if (.not. allocated(err)) call begin_equations(mechanism, model, start, equations, err)
    if (.not. allocated(err)) call save(name//'.f90', equations_file(model, start, equations, path))
    if (.not. allocated(err)) call save('c.'//name, constants_file(model, start, equations, name))
    if (.not. allocated(err) .and. start%is_periodic) call save(name//'.dat', motion_file(start))
    if (.not. allocated(err)) files = files(3:)
    call equations%close()

  contains

    !> Save a file.
    subroutine save(file, text)
      character(len=*), intent(in) :: file     !< its name in the folder
      character(len=*), intent(in) :: text     !< its lines

      call save_text(folder//'/'//file, text, err)
      files = files//', '//file
    end subroutine save
  end subroutine write_auto_files

  !> Find the start. Fails where AUTO cannot follow what the data file asks for.
  subroutine find_start(model, start, err)
    type(model_type), intent(in) :: model                          !< the model
    type(start_type), intent(out) :: start                         !< the start
    type(error_type), allocatable, intent(out) :: err              !< allocated if it failed

    call first_request(model, start%request, start%number, err)
    if (.not. allocated(err)) call refuse_jumps(model, err)
    if (allocated(err)) return
    start%is_periodic = start%request%of == 'periodic'
    if (start%request%of == 'position') then
      call raise(err, exit_data, 'AUTO follows equations of motion, and of=''position'' has none; --branch follows such '// &
                 'positions', start%request%place)
    else if (size(model%parameters) > most_parameters) then
      call raise(err, exit_data, 'AUTO has room for '//to_text(most_parameters)//' parameters, and the data file has '// &
                 to_text(size(model%parameters))//'; leave some &parameter out', model%parameters(most_parameters + 1)%place)
    else if (start%is_periodic) then
      call find_periodic_start(model, start, err)
    else
      call find_rest_start(model, start, err)
    end if
  end subroutine find_start

  !> Begin the equations at the start.
  subroutine begin_equations(mechanism, model, start, equations, err)
    type(checked_mechanism_type), intent(in) :: mechanism          !< the mechanism
    type(model_type), intent(in) :: model                          !< its model
    type(start_type), intent(inout) :: start                       !< the start; gets state and units
    type(motion_equations_type), intent(inout) :: equations        !< begun at the start
    type(error_type), allocatable, intent(out) :: err              !< allocated if it failed
    real(wp), allocatable :: values(:), f(:), by_state(:, :), by_parameters(:, :)

    call equations%begin(mechanism, err, start%q, start%has_clock)
    if (allocated(err)) return
    call equations%start(start%x, values)
    if (start%is_periodic) then
      start%x = start%states(:, 1)
    else
      start%x(size(start%x)/2 + 1:) = 0.0_wp
    end if
    call choose_units(model, equations, start)
    ! AUTO shall not meet what fails everywhere: no inertia, unknown derivatives
    f = start%x
    allocate (by_state(size(f), size(f)), by_parameters(size(f), size(values)))
    call equations%find(start%x, values, f, err, by_state, by_parameters)
  end subroutine begin_equations

  !> Choose powers of ten as units, in which states and parameters have numbers near 1: the test functions of AUTO compare directions of a
  !> branch without weights.
  subroutine choose_units(model, equations, start)
    type(model_type), intent(in) :: model                          !< the model
    type(motion_equations_type), intent(in) :: equations           !< the equations
    type(start_type), intent(inout) :: start                       !< with the state; gets the units
    real(wp), allocatable :: sizes(:)
    real(wp) :: range
    integer :: i, n

    call equations%take_units(sizes)
    n = size(sizes)/2 - merge(1, 0, start%has_clock)
    if (start%is_periodic) sizes(n + 1:2*n) = sizes(n + 1:2*n)*(turn/start%period)
    start%power = nint(log10(sizes)) + power_of_states
    if (start%has_clock) start%power(2*n + 1:) = 0
    allocate (start%parameter_power(size(model%parameters)), source=0)
    do i = 1, size(model%parameters)
      associate (parameter => model%parameters(i))
        range = abs(parameter%value)
        if (parameter%has_range) range = parameter%high - parameter%low
        if (i == start%number) range = start%request%high - start%request%low
        if (range > 0.0_wp) start%parameter_power(i) = nint(log10(range/usual_range))
      end associate
    end do
  end subroutine choose_units

  !> Find the position of rest at which the branch begins.
  subroutine find_rest_start(model, start, err)
    type(model_type), intent(in) :: model                          !< the model
    type(start_type), intent(inout) :: start                       !< with the request; gets the position
    type(error_type), allocatable, intent(out) :: err              !< allocated if it failed
    type(rest_type), allocatable :: rest

    allocate (rest)
    call begin_at_rest(model, start%request, rest, err)
    if (.not. allocated(err)) start%q = rest%equilibria(1)%resting%state%q
  end subroutine find_rest_start

  !> Find the periodic motion at which the branch begins.
  subroutine find_periodic_start(model, start, err)
    type(model_type), intent(in) :: model                          !< the model
    type(start_type), intent(inout) :: start                       !< with the request; gets the motion
    type(error_type), allocatable, intent(out) :: err              !< allocated if it failed
    type(periodic_found_type) :: found
    type(law_period_type) :: laws
    type(period_map_type) :: map
    real(wp), allocatable :: rate(:), states(:, :)
    real(wp) :: clock
    integer :: i, n

    call find_periodic(model, found, err)
    if (.not. allocated(err)) call find_law_period(model, laws, err)
    if (allocated(err)) return
    associate (motion => found%motions(1))
      call refuse_turns(motion%turns /= 0 .or. abs(motion%advance) > 0.0_wp, start, err)
      if (.not. allocated(err)) call refuse_family(motion, 'AUTO follows', start%request, err)
      if (.not. allocated(err)) call map%begin(model, err)
      if (allocated(err)) return
      start%q = motion%q
      start%period = motion%period
      start%has_clock = laws%follows_time
      start%times = [(i*start%period/times_of_period, i=0, times_of_period)]
      n = map%states
      allocate (states(n, 0:times_of_period), rate(n))
      call map%sample(map%state_of(motion%q, motion%dq, motion%motor), start%times(2:), states(:, 1:), rate, err)
      states(:, 0) = map%state_of(motion%q, motion%dq, motion%motor)
      call map%close()
    end associate
    if (allocated(err)) return
    if (start%has_clock) then
      clock = start%period
      if (laws%is_known) clock = laws%period
      allocate (start%states(n + 2, times_of_period + 1))
      start%states(n + 1, :) = cos(start%times*(turn/clock))
      start%states(n + 2, :) = sin(start%times*(turn/clock))
    else
      allocate (start%states(n, times_of_period + 1))
    end if
    start%states(:n, :) = states
  end subroutine find_periodic_start

  !> Fail where a motion makes turns.
  subroutine refuse_turns(turns, start, err)
    logical, intent(in) :: turns(:)                        !< (M) the coordinate does not come back in a period
    type(start_type), intent(in) :: start                  !< with the request
    type(error_type), allocatable, intent(out) :: err      !< allocated where it is refused

    if (.not. any(turns)) return
    call raise(err, exit_data, 'coordinate '//to_text(findloc(turns, .true., dim=1))//' makes turns in a period, '// &
               'and AUTO knows no motions that come back but for turns; --branch does', start%request%place)
  end subroutine refuse_turns

  !> The file with FUNC and STPNT.
  function equations_file(model, start, equations, path) result(text)
    type(model_type), intent(in) :: model                          !< the model
    type(start_type), intent(in) :: start                          !< the start
    type(motion_equations_type), intent(in) :: equations           !< the equations
    character(len=*), intent(in) :: path                           !< of the data file
    character(len=:), allocatable :: text
    character(len=:), allocatable :: names(:), units(:)
    integer :: i, n

    call equations%name_all(names, units)
    n = equations%count_states()
    text = first_line//eol//'! '//with_escapes(path, '', [''])//eol// &
           '! FUNC reads it at its first call. The independent coordinates are those of this file all the time.'//eol//'!'//eol
    do i = 1, n
      text = text//'! U('//to_text(i)//')    '//trim(names(i))//unit_in_words(units(i), start%power(i))//eol
    end do
    do i = 1, size(model%parameters)
      text = text//'! PAR('//to_text(i)//')  '//trim(names(n + i))//unit_in_words(units(n + i), start%parameter_power(i))//eol
    end do
    text = text//module_text(start, path)//func_text(to_text(size(model%parameters)))//stpnt_text(model, start)
    do i = 1, 4
      text = text//eol//'subroutine '//unused_of(i)//'()'//eol//'end subroutine '//unused_of(i)//eol
    end do
  end function equations_file

  !> The unit of a number of AUTO in words.
  function unit_in_words(unit, power) result(text)
    character(len=*), intent(in) :: unit        !< of the library
    integer, intent(in) :: power                !< of ten
    character(len=:), allocatable :: text

    text = trim(unit)
    if (power /= 0) text = trim('1e'//to_text(power)//' '//text)
    if (text /= '') text = ' ['//text//']'
  end function unit_in_words

  !> The module with the equations.
  function module_text(start, path) result(text)
    type(start_type), intent(in) :: start                          !< the start
    character(len=*), intent(in) :: path                           !< of the data file
    character(len=:), allocatable :: text

    text = 'module mech9_equations_for_auto'//eol// &
           '  use mech9, only: wp, error_type, mechanism_type, equations_type, read_file'//eol// &
           '  implicit none'//eol//eol// &
           '  character(len=*), parameter :: data_file = &'//eol//literal(path)//eol// &
           '  ! all coordinates at the start, from which closed chains are followed [rad, m]'//eol// &
           '  real(wp), parameter :: start(*) = [ &'//eol//numbers(start%q)//']'//eol// &
           '  ! units of U and PAR, see above'//eol// &
           '  real(wp), parameter :: state_unit(*) = [ &'//eol//numbers(10.0_wp**start%power)//']'//eol// &
           '  real(wp), parameter :: parameter_unit(*) = [ &'//eol//numbers(10.0_wp**start%parameter_power)//']'//eol// &
           '  ! the phase of drives and loads is a part of the state'//eol// &
           '  logical, parameter :: with_clock = '//trim(merge('.true. ', '.false.', start%has_clock))//eol// &
           '  ! threads of AUTO call it one after the other'//eol// &
           '  type(equations_type), pointer, save :: equations => null()'//eol// &
           '  logical, save :: has_told = .false.'//eol// &
           'contains'//eol//eol// &
           '  subroutine begin()'//eol// &
           '    type(mechanism_type) :: mechanism'//eol// &
           '    type(error_type), allocatable :: err'//eol//eol// &
           '    allocate (equations)'//eol// &
           '    call read_file(data_file, mechanism, err)'//eol// &
           '    if (.not. allocated(err)) call equations%begin(mechanism, err, start, with_clock)'//eol// &
           '    if (.not. allocated(err)) return'//eol// &
           '    call tell(err)'//eol// &
           '    error stop 1'//eol// &
           '  end subroutine begin'//eol//eol// &
           '  ! AUTO takes a shorter step where the equations have no value, and ends where none is short enough.'//eol// &
           '  subroutine tell(err)'//eol// &
           '    type(error_type), intent(in) :: err'//eol//eol// &
           '    if (.not. has_told) write (0, ''(a)'') ''mech9: ''//err%message'//eol// &
           '    has_told = .true.'//eol// &
           '  end subroutine tell'//eol// &
           'end module mech9_equations_for_auto'//eol//eol
  end function module_text

  !> The subroutine FUNC.
  pure function func_text(count) result(text)
    character(len=*), intent(in) :: count                          !< number of parameters
    character(len=:), allocatable :: text

    text = 'subroutine func(ndim, u, icp, par, ijac, f, dfdu, dfdp)'//eol// &
           '  use, intrinsic :: ieee_arithmetic, only: ieee_value, ieee_quiet_nan'//eol// &
           '  use mech9_equations_for_auto, only: wp, error_type, equations, state_unit, parameter_unit, begin, tell'//eol// &
           '  implicit none'//eol// &
           '  integer, intent(in) :: ndim, icp(*), ijac'//eol// &
           '  real(wp), intent(in) :: u(ndim), par(*)'//eol// &
           '  real(wp), intent(out) :: f(ndim)'//eol// &
           '  real(wp), intent(inout) :: dfdu(ndim, ndim), dfdp(ndim, *)'//eol// &
           '  type(error_type), allocatable :: err'//eol// &
           '  integer :: i'//eol//eol// &
           '  !$omp critical (mech9_equations)'//eol// &
           '  if (.not. associated(equations)) call begin()'//eol// &
           '  associate (x => u*state_unit, p => par(:'//count//')*parameter_unit)'//eol// &
           '    if (ijac == 0) then'//eol// &
           '      call equations%find(x, p, f, err)'//eol// &
           '    else if (ijac == 1) then'//eol// &
           '      call equations%find(x, p, f, err, dfdu)'//eol// &
           '    else'//eol// &
           '      call equations%find(x, p, f, err, dfdu, dfdp(:, :'//count//'))'//eol// &
           '    end if'//eol// &
           '  end associate'//eol// &
           '  !$omp end critical (mech9_equations)'//eol// &
           '  f = f/state_unit'//eol// &
           '  if (ijac > 0) then'//eol// &
           '    do i = 1, ndim'//eol// &
           '      dfdu(:, i) = dfdu(:, i)*(state_unit(i)/state_unit)'//eol// &
           '    end do'//eol// &
           '  end if'//eol// &
           '  if (ijac > 1) then'//eol// &
           '    do i = 1, '//count//eol// &
           '      dfdp(:, i) = dfdp(:, i)*(parameter_unit(i)/state_unit)'//eol// &
           '    end do'//eol// &
           '  end if'//eol// &
           '  if (.not. allocated(err)) return'//eol// &
           '  call tell(err)'//eol// &
           '  f = ieee_value(1.0_wp, ieee_quiet_nan)'//eol// &
           'end subroutine func'//eol//eol
  end function func_text

  !> The subroutine STPNT.
  function stpnt_text(model, start) result(text)
    type(model_type), intent(in) :: model                          !< the model
    type(start_type), intent(in) :: start                          !< the start
    character(len=:), allocatable :: text
    integer :: i

    text = 'subroutine stpnt(ndim, u, par, t)'//eol// &
           '  use mech9_equations_for_auto, only: wp'//eol// &
           '  implicit none'//eol// &
           '  integer, intent(in) :: ndim'//eol// &
           '  real(wp), intent(inout) :: u(ndim), par(*)'//eol// &
           '  real(wp), intent(in) :: t'//eol//eol// &
           '  par(:'//to_text(size(model%parameters))//') = [real(wp) :: &'//eol// &
           numbers([(model%parameters(i)%value/10.0_wp**start%parameter_power(i), i=1, size(model%parameters))])//']'//eol// &
           '  u = [real(wp) :: &'//eol//numbers(start%x/10.0_wp**start%power)//']'//eol// &
           'end subroutine stpnt'//eol
  end function stpnt_text

  !> Name of a subroutine that AUTO needs and the equations do not.
  pure character(len=4) function unused_of(i) result(name)
    integer, intent(in) :: i   !< its number
    character(len=4), parameter :: names(4) = ['bcnd', 'icnd', 'fopt', 'pvls']

    name = names(i)
  end function unused_of

  !> A text as a constant of Fortran, in lines that are not too long.
  pure function literal(path) result(text)
    character(len=*), intent(in) :: path    !< the text
    character(len=:), allocatable :: text
    integer, parameter :: longest = 100
    integer :: from

    text = ''
    do from = 1, len(path), longest
      if (from > 1) text = text//'//&'//eol
      text = text//'    '//in_apostrophes(path(from:min(from + longest - 1, len(path))))
    end do
  end function literal

  !> Numbers as the inner part of a constant of Fortran, one a line.
  function numbers(values) result(text)
    real(wp), intent(in) :: values(:)         !< the numbers
    character(len=:), allocatable :: text
    integer :: i

    text = ''
    do i = 1, size(values)
      if (i > 1) text = text//', &'//eol
      text = text//'    '//trim(exact(values(i)))//'_wp'
    end do
  end function numbers

  !> A number with all its digits.
  character(len=24) function exact(value) result(text)
    real(wp), intent(in) :: value   !< the number

    write (text, '(es24.16e3)') value
    text = adjustl(text)
  end function exact

  !> The file of constants.
  function constants_file(model, start, equations, name) result(text)
    type(model_type), intent(in) :: model                          !< the model
    type(start_type), intent(in) :: start                          !< the start
    type(motion_equations_type), intent(in) :: equations           !< the equations
    character(len=*), intent(in) :: name                           !< the name that AUTO uses
    character(len=:), allocatable :: text
    character(len=:), allocatable :: names(:), units(:), parameters(:), p, weights
    real(wp) :: unit
    integer :: i, n

    call equations%name_all(names, units)
    n = equations%count_states()
    parameters = names(n + 1:)
    p = to_text(start%number)
    text = '# Constants for AUTO-07p, written by mech9-link --auto; the other direction: DS=''-'''//eol// &
           'e='//in_apostrophes(name)//eol
    if (start%is_periodic) text = text//'dat='//in_apostrophes(name)//eol
    text = text//'unames={'
    do i = 1, n
      text = text//to_text(i)//': '''//short_name(names(:n), i, start%power(i))//''''//trim(merge(', ', '} ', i < n))
      if (i < n) text = text//' '
    end do
    text = text//eol//'parnames={'
    do i = 1, size(model%parameters)
      text = text//to_text(i)//': '''//short_name(parameters, i, start%parameter_power(i))//''', '
    end do
    text = text(:len(text) - 2)
    if (start%is_periodic) text = text//', '//to_text(number_of_period)//': ''period'''
    weights = ''
    if (start%is_periodic) weights = to_text(number_of_period)//': 0.0'
    unit = 10.0_wp**start%parameter_power(start%number)
    text = text//'}'//eol// &
           'NDIM='//to_text(n)//', IPS='//trim(merge('2', '1', start%is_periodic))//', IRS=0, ILP=1'//eol// &
           'ICP=['//p//trim(merge(', '//to_text(number_of_period), '    ', start%is_periodic))//']'//eol// &
           'NTST=50, NCOL=4, IAD=3, ISP=2, ISW=1, IPLT=0, NBC=0, NINT=0'//eol// &
           'NMX='//to_text(2*start%request%points)//', NPR='//to_text(2*start%request%points)// &
           ', MXBF=10, IID=2, ITMX=20, ITNW=7, NWTN=5, JAC=1'//eol// &
           trim(merge('EPSL=1e-08, EPSU=1e-08, EPSS=1e-06', 'EPSL=1e-10, EPSU=1e-10, EPSS=1e-08', start%is_periodic))//eol// &
           'DS='//trim(exact(0.2_wp*part_of_step*start%request%step))//', DSMIN=1e-07, DSMAX='// &
           trim(exact(part_of_step*start%request%step))//', IADS=1'//eol// &
           'THL={'//weights//'}, THU={}'//eol// &
           'UZSTOP={'//p//': ['//trim(exact(start%request%low/unit))//', '//trim(exact(start%request%high/unit))//']}'//eol
  end function constants_file

  !> A name for AUTO: short, with a letter at its beginning, unlike the others, and with the power of ten that is the unit of its
  !> numbers: q1/1e-2.
  function short_name(names, i, power) result(name)
    character(len=*), intent(in) :: names(:)      !< of parameters, or of states
    integer, intent(in) :: i                      !< place of the name
    integer, intent(in) :: power                  !< of ten
    character(len=:), allocatable :: name
    character(len=:), allocatable :: ending
    integer :: k, room
    logical :: is_known

    ending = ''
    if (power /= 0) ending = '/1e'//to_text(power)
    room = longest_name - len(ending)
    name = trim(names(i))
    is_known = .true.
    do k = 1, size(names)
      if (k /= i) is_known = is_known .and. names(k)(:min(room, len(names))) /= name
      if (k /= i .and. len(name) > room) is_known = is_known .and. names(k)(:room) /= name(:room)
    end do
    if (scan(name(1:1), '0123456789_') > 0 .or. .not. is_known) name = 'p'//to_text(i)//'_'//name
    name = name(:min(room, len(name)))//ending
  end function short_name

  !> The file with the periodic motion: the time and the state, a line for each time.
  function motion_file(start) result(text)
    type(start_type), intent(in) :: start   !< the start
    character(len=:), allocatable :: text
    character(len=26*(size(start%states, 1) + 1)) :: line
    integer :: i

    text = ''
    do i = 1, size(start%times)
      write (line, '(*(es25.16e3, 1x))') start%times(i), start%states(:, i)/10.0_wp**start%power
      text = text//trim(line)//eol
    end do
  end function motion_file
end module mech9_auto_files
