!> The command line: its words, and what they ask for.
!> Uses mech9_options (the table of options) and the base.
module mech9_command_line
  use mech9_error, only: error_type, raise, exit_usage
  use mech9_text, only: string_type, nearest_name, starts_with
  use mech9_options, only: option_type, options_table, option_names, find_option, &
                           no_argument, optional_argument
  implicit none
  private
  public :: command_line_type, get_command_words, parse_command_line, help_text

  !> What a command line asks for. A text that was not given is empty.
  type :: command_line_type
    character(len=:), allocatable :: file             !< the data file
    logical :: check = .false.
    logical :: structure = .false.
    logical :: plan = .false.
    logical :: range = .false.
    logical :: branches = .false.
    integer :: starts = 100                           !< guesses of --branches
    logical :: no_write = .false.
    logical :: quiet = .false.
    logical :: verbose = .false.
    logical :: help = .false.
    logical :: version = .false.
    logical :: help_data = .false.
    character(len=:), allocatable :: help_group       !< of --help-data; empty: all groups
    character(len=:), allocatable :: table            !< path
    character(len=:), allocatable :: report           !< path
    type(string_type), allocatable :: settings(:)     !< each GROUP.NAME=VALUE, in their order
  end type command_line_type

contains

  !> The words of this program's own command line, without the program's name.
  subroutine get_command_words(words)
    type(string_type), allocatable, intent(out) :: words(:)
    integer :: i, length

    allocate (words(command_argument_count()))
    do i = 1, size(words)
      call get_command_argument(i, length=length)
      allocate (character(len=length) :: words(i)%text)
      if (length > 0) call get_command_argument(i, words(i)%text)
    end do
  end subroutine get_command_words

  !> Read the words. An error is a wrong command line (exit_usage).
  pure subroutine parse_command_line(words, program_name, options, err)
    type(string_type), intent(in) :: words(:)      !< without the program's name
    character(len=*), intent(in) :: program_name   !< mech9k or mech9d: whose options count
    type(command_line_type), intent(out) :: options
    type(error_type), allocatable, intent(out) :: err
    integer :: times(size(options_table)), i
    logical :: only_files

    options%file = ''
    options%help_group = ''
    options%table = ''
    options%report = ''
    allocate (options%settings(0))
    times = 0
    only_files = .false.
    i = 1
    do while (i <= size(words))
      if (words(i)%text == '--' .and. .not. only_files) then
        only_files = .true.
        i = i + 1
      else if (is_option(words(i)%text) .and. .not. only_files) then
        call read_option(words, i, program_name, options, times, err)
      else
        call take_file(words(i)%text, options, err)
        i = i + 1
      end if
      if (allocated(err)) return
    end do
    call judge(program_name, options, err)
  end subroutine parse_command_line

  !> A single dash is not an option: it names standard input or output.
  pure logical function is_option(word)
    character(len=*), intent(in) :: word

    is_option = starts_with(word, '-') .and. len(word) > 1
  end function is_option

  pure subroutine take_file(word, options, err)
    character(len=*), intent(in) :: word
    type(command_line_type), intent(inout) :: options
    type(error_type), allocatable, intent(out) :: err

    if (word == '') then
      call raise(err, exit_usage, 'the name of the data file is empty')
    else if (options%file /= '') then
      call raise(err, exit_usage, "two data files are given, '"//options%file//"' and '"//word &
                 //"'; a run takes one")
    else
      options%file = word
    end if
  end subroutine take_file

  !> Read the option that begins at words(i), and step over it.
  pure subroutine read_option(words, i, program_name, options, times, err)
    type(string_type), intent(in) :: words(:)
    integer, intent(inout) :: i
    character(len=*), intent(in) :: program_name
    type(command_line_type), intent(inout) :: options
    integer, intent(inout) :: times(:)     !< how often each option was given
    type(error_type), allocatable, intent(out) :: err
    character(len=:), allocatable :: name, argument
    integer :: equals, place
    logical :: has_argument

    equals = index(words(i)%text, '=')
    has_argument = equals > 0
    name = words(i)%text
    argument = ''
    if (has_argument) then
      argument = name(equals + 1:)
      name = name(:equals - 1)
    end if
    place = 0
    if (starts_with(name, '--')) place = find_option(name(3:), program_name)
    if (place == 0) then
      call raise_unknown(name, program_name, err)
      return
    end if
    i = i + 1
    if (options_table(place)%takes /= no_argument .and. .not. has_argument .and. i <= size(words)) then
      has_argument = .not. is_option(words(i)%text)
      if (has_argument) then
        argument = words(i)%text
        i = i + 1
      end if
    end if
    times(place) = times(place) + 1
    call judge_argument(options_table(place), argument, has_argument, times(place), err)
    if (.not. allocated(err)) call take_option(options_table(place)%name, argument, options, err)
  end subroutine read_option

  pure subroutine raise_unknown(name, program_name, err)
    character(len=*), intent(in) :: name   !< with its dashes
    character(len=*), intent(in) :: program_name
    type(error_type), allocatable, intent(out) :: err
    character(len=:), allocatable :: nearest, hint

    nearest = nearest_name(name(verify(name//'x', '-'):), option_names(program_name))
    hint = program_name//' --help lists the options'
    if (nearest /= '') hint = 'did you mean --'//nearest//'?'
    call raise(err, exit_usage, "unknown option '"//name//"'; "//hint)
  end subroutine raise_unknown

  !> Whether an option may be given so: its argument and how often.
  pure subroutine judge_argument(option, argument, has_argument, times, err)
    type(option_type), intent(in) :: option
    character(len=*), intent(in) :: argument
    logical, intent(in) :: has_argument
    integer, intent(in) :: times
    type(error_type), allocatable, intent(out) :: err
    character(len=:), allocatable :: name

    name = '--'//trim(option%name)
    if (option%takes == no_argument) then
      if (has_argument) call raise(err, exit_usage, name//' takes no argument')
    else if (option%takes == optional_argument .and. .not. has_argument) then
      return
    else if (argument == '') then
      call raise(err, exit_usage, name//' needs an argument: '//name//' '//trim(option%argument))
    else if (times > 1 .and. .not. option%repeats) then
      call raise(err, exit_usage, name//' is given more than once')
    end if
  end subroutine judge_argument

  !> Keep what an option says.
  pure subroutine take_option(name, argument, options, err)
    character(len=*), intent(in) :: name
    character(len=*), intent(in) :: argument
    type(command_line_type), intent(inout) :: options
    type(error_type), allocatable, intent(out) :: err

    select case (name)
    case ('check')
      options%check = .true.
    case ('structure')
      options%structure = .true.
    case ('plan')
      options%plan = .true.
    case ('branches')
      options%branches = .true.
    case ('starts')
      call take_starts(argument, options, err)
    case ('range')
      options%range = .true.
    case ('no-write')
      options%no_write = .true.
    case ('quiet')
      options%quiet = .true.
    case ('verbose')
      options%verbose = .true.
    case ('help')
      options%help = .true.
    case ('version')
      options%version = .true.
    case ('help-data')
      options%help_data = .true.
      options%help_group = argument
    case ('table')
      options%table = argument
    case ('report')
      options%report = argument
    case ('set')
      call take_setting(argument, options, err)
    end select
  end subroutine take_option

  !> A number of guesses.
  pure subroutine take_starts(argument, options, err)
    character(len=*), intent(in) :: argument
    type(command_line_type), intent(inout) :: options
    type(error_type), allocatable, intent(out) :: err
    integer :: status

    status = verify(trim(argument), '0123456789')
    if (status == 0) read (argument, *, iostat=status) options%starts
    if (status /= 0 .or. options%starts < 1) &
      call raise(err, exit_usage, "--starts needs a whole number from 1 on, not '"//trim(argument)//"'")
  end subroutine take_starts

  !> Keep a setting. Here only its form is judged; the grammar of the data file knows the names.
  pure subroutine take_setting(setting, options, err)
    character(len=*), intent(in) :: setting
    type(command_line_type), intent(inout) :: options
    type(error_type), allocatable, intent(out) :: err
    integer :: equals, dot

    equals = index(setting, '=')
    dot = index(setting(:max(equals - 1, 0)), '.')
    if (dot < 2 .or. dot >= equals - 1) then
      call raise(err, exit_usage, "--set needs GROUP.NAME=VALUE, as in --set time.end=2; not '" &
                 //setting//"'")
      return
    end if
    call append(options%settings, setting)
  end subroutine take_setting

  !> One text more. An array constructor would be shorter, but gfortran 12 leaks what is in it.
  pure subroutine append(list, text)
    type(string_type), allocatable, intent(inout) :: list(:)
    character(len=*), intent(in) :: text
    type(string_type), allocatable :: longer(:)
    integer :: i

    allocate (longer(size(list) + 1))
    do i = 1, size(list)
      call move_alloc(list(i)%text, longer(i)%text)
    end do
    longer(size(longer))%text = text
    call move_alloc(longer, list)
  end subroutine append

  !> What the words mean together.
  pure subroutine judge(program_name, options, err)
    character(len=*), intent(in) :: program_name
    type(command_line_type), intent(in) :: options
    type(error_type), allocatable, intent(out) :: err

    if (options%help .or. options%version .or. options%help_data) return
    if (options%quiet .and. options%verbose) then
      call raise(err, exit_usage, '--quiet and --verbose contradict each other')
    else if (options%no_write .and. options%table /= '') then
      call raise(err, exit_usage, '--no-write and --table contradict each other')
    else if (options%file == '') then
      call raise(err, exit_usage, 'no data file is given; '//program_name//' FILE runs one, ' &
                 //program_name//' --help tells more')
    end if
  end subroutine judge

  !> The text of --help, of whole lines, the last one without its end.
  pure function help_text(program_name) result(text)
    character(len=*), intent(in) :: program_name
    character(len=:), allocatable :: text
    character(len=32) :: left
    integer :: i

    text = 'usage: '//program_name//' FILE [options]'//achar(10)// &
           '       runs the mechanism that the data file FILE describes'//achar(10)//achar(10)// &
           'options:'
    do i = 1, size(options_table)
      if (index(options_table(i)%programs, program_name) == 0) cycle
      left = option_form(options_table(i))
      text = text//achar(10)//'  '//left//trim(options_table(i)%help)
    end do
    text = text//achar(10)//achar(10)// &
           'Results go to files or standard output, talk to standard error.'//achar(10)// &
           'Exit codes: 0 done, 1 internal error, 2 usage, 3 data file, 4 structure or mobility,'//achar(10)// &
           '5 cannot be assembled, 6 singular position or branch, 7 integrator,'//achar(10)// &
           '8 file input or output, 130 interrupted.'
  end function help_text

  !> An option as it is written: "--table PATH", "--help-data [GROUP]".
  pure function option_form(option) result(form)
    type(option_type), intent(in) :: option
    character(len=:), allocatable :: form

    form = '--'//trim(option%name)
    if (option%takes == no_argument) return
    if (option%takes == optional_argument) then
      form = form//' ['//trim(option%argument)//']'
    else
      form = form//' '//trim(option%argument)
    end if
  end function option_form
end module mech9_command_line
