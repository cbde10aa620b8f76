!> The command line: its words, the data file and the options.
module mech9_command_line
  use mech9_program_kind, only: kinematics, program_names, belongs_to
  use mech9_error, only: error_type, raise, exit_usage
  use mech9_text, only: string_type, nearest_name, starts_with
  use mech9_system, only: take_argument
  use mech9_options, only: option_type, options_table, option_names, find_option, &
                           no_argument, optional_argument, whole_number, assignment, part_of_whole
  use mech9_argument_forms, only: is_whole_number, is_assignment, is_part
  use mech9_option_conflicts, only: judge_options, answer_of, rest_of
  implicit none
  private
  public :: command_line_type, get_command_words, parse_command_line

  !> An option as it was given.
  type :: given_type
    character(len=len(options_table%name)) :: name = ''
    character(len=:), allocatable :: argument  !< its argument; empty where it has none
  end type given_type

  !> The content of a command line: a data file, and options by the names of the table of options.
  type :: command_line_type
    integer :: program = kinematics        !< or dynamics
    character(len=:), allocatable :: file  !< the data file; empty where none is given
    character(len=:), allocatable :: line  !< all words as a line for a shell
    type(given_type), allocatable, private :: given(:)
  contains
    procedure :: has
    procedure :: argument
    procedure :: arguments
    procedure :: number
    procedure :: part
    procedure :: converses
    procedure :: answer
    procedure :: rest
    procedure :: table_of_answer
  end type command_line_type

contains

  !> Get the words of this program's own command line, without the program's name.
  subroutine get_command_words(words)
    type(string_type), allocatable, intent(out) :: words(:)  !< the words, without the program's name
    integer :: i

    allocate (words(command_argument_count()))
    do i = 1, size(words)
      call take_argument(i, words(i)%text)
    end do
  end subroutine get_command_words

  !> Read the words. An error is a wrong command line (exit_usage).
  pure subroutine parse_command_line(words, program, options, err)
    type(string_type), intent(in) :: words(:)          !< the words, without the program's name
    integer, intent(in) :: program                     !< kinematics or dynamics: whose options count
    type(command_line_type), intent(out) :: options    !< the data file and the options
    type(error_type), allocatable, intent(out) :: err  !< allocated if it failed
    integer :: i
    logical :: only_files

    options%program = program
    options%file = ''
    options%line = shell_line(words)
    allocate (options%given(0))
    only_files = .false.
    i = 1
    do while (i <= size(words))
      if (words(i)%text == '--' .and. .not. only_files) then
        only_files = .true.
        i = i + 1
      else if (is_option(words(i)%text) .and. .not. only_files) then
        call read_option(words, i, program, options, err)
      else
        call take_file(words(i)%text, options, err)
        i = i + 1
      end if
      if (allocated(err)) return
    end do
    call judge_options(program, options%given%name, options%file /= '', options%converses(), err)
  end subroutine parse_command_line

  !> Words as one line that a shell splits into the same words.
  pure function shell_line(words) result(line)
    type(string_type), intent(in) :: words(:)  !< the words as a program receives them
    character(len=:), allocatable :: line
    integer :: i, n, at

    n = max(size(words) - 1, 0)
    do i = 1, size(words)
      n = n + shell_length(words(i)%text)
    end do
    allocate (character(len=n) :: line)
    line(:) = ''
    at = 1
    do i = 1, size(words)
      n = shell_length(words(i)%text)
      call write_for_shell(words(i)%text, line(at:at + n - 1))
      at = at + n + 1
    end do
  end function shell_line

  !> Length of a word in the form for a shell, with its quotes.
  pure integer function shell_length(word)
    character(len=*), intent(in) :: word  !< one word of the command line
    integer :: i

    shell_length = len(word)
    if (is_harmless(word)) return
    shell_length = len(word) + 2
    do i = 1, len(word)
      if (word(i:i) == "'") shell_length = shell_length + 3
    end do
  end function shell_length

  !> Write a word in the form for a shell: in quotes where it holds letters with a meaning for the shell.
  pure subroutine write_for_shell(word, text)
    character(len=*), intent(in) :: word     !< one word of the command line
    character(len=*), intent(inout) :: text  !< the word for the shell, of length shell_length(word)
    character(len=*), parameter :: quote = "'\''"
    integer :: i, at

    text = word
    if (is_harmless(word)) return
    text(1:1) = "'"
    at = 2
    do i = 1, len(word)
      if (word(i:i) == "'") then
        text(at:at + len(quote) - 1) = quote
        at = at + len(quote)
      else
        text(at:at) = word(i:i)
        at = at + 1
      end if
    end do
    text(at:at) = "'"
  end subroutine write_for_shell

  !> Whether a word has only letters without a special meaning for a shell.
  pure logical function is_harmless(word)
    character(len=*), intent(in) :: word  !< one word of the command line
    character(len=*), parameter :: harmless = 'abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-./=,:+%@'

    is_harmless = word /= '' .and. verify(word, harmless) == 0
  end function is_harmless

  !> Whether a word is an option; a single dash is none: it means standard input or output.
  pure logical function is_option(word)
    character(len=*), intent(in) :: word  !< one word of the command line

    is_option = starts_with(word, '-') .and. len(word) > 1
  end function is_option

  !> Whether a word is a minus sign with digits behind it.
  pure logical function is_negative(word)
    character(len=*), intent(in) :: word  !< one word of the command line

    is_negative = starts_with(word, '-') .and. len(word) > 1 .and. verify(word(min(2, len(word) + 1):), '0123456789.') == 0
  end function is_negative

  !> Take a word as the data file.
  pure subroutine take_file(word, options, err)
    character(len=*), intent(in) :: word               !< the path of the data file
    type(command_line_type), intent(inout) :: options  !< gets the data file
    type(error_type), allocatable, intent(out) :: err  !< allocated if it failed

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
  pure subroutine read_option(words, i, program, options, err)
    type(string_type), intent(in) :: words(:)          !< the words of the command line
    integer, intent(inout) :: i                        !< position of the option; afterwards that of the next word
    integer, intent(in) :: program                     !< kinematics or dynamics
    type(command_line_type), intent(inout) :: options  !< gets the option
    type(error_type), allocatable, intent(out) :: err  !< allocated if it failed
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
    if (starts_with(name, '--')) place = find_option(name(3:), program)
    if (place == 0) then
      call raise_unknown(name, program, err)
      return
    end if
    i = i + 1
    if (options_table(place)%takes /= no_argument .and. .not. has_argument .and. i <= size(words)) then
      has_argument = .not. is_option(words(i)%text) .or. &
                     (options_table(place)%form == whole_number .and. is_negative(words(i)%text))
      if (has_argument) then
        argument = words(i)%text
        i = i + 1
      end if
    end if
    call judge_argument(options_table(place), argument, has_argument, options, err)
    if (allocated(err)) return
    call append(options%given, options_table(place)%name, argument)
    call take_further(words, i, options_table(place), options)
  end subroutine read_option

  !> Take the further arguments of an option that has several: words that follow it and are no options.
  pure subroutine take_further(words, i, option, options)
    type(string_type), intent(in) :: words(:)          !< the words of the command line
    integer, intent(inout) :: i                        !< position behind its first argument; afterwards that of the next word
    type(option_type), intent(in) :: option            !< the option, as a row of its table
    type(command_line_type), intent(inout) :: options  !< gets the arguments
    integer :: n

    do n = 2, option%most
      if (i > size(words)) return
      if (is_option(words(i)%text)) return
      call append(options%given, option%name, words(i)%text)
      i = i + 1
    end do
  end subroutine take_further

  !> Fail because of an unknown option, with the nearest known one.
  pure subroutine raise_unknown(name, program, err)
    character(len=*), intent(in) :: name               !< the option as it was given, with its dashes
    integer, intent(in) :: program                     !< kinematics or dynamics
    type(error_type), allocatable, intent(out) :: err  !< allocated if it failed
    character(len=:), allocatable :: nearest, hint
    integer :: i

    nearest = nearest_name(name(verify(name//'x', '-'):), option_names(program))
    hint = program_names(program)//' --help lists the options'
    if (nearest /= '') hint = 'did you mean --'//nearest//'?'
    do i = 1, size(options_table)
      associate (option => options_table(i))
        if ('--'//option%name == name .and. .not. belongs_to(option%program, program)) &
          hint = 'only '//program_names(option%program)//' has it'
      end associate
    end do
    call raise(err, exit_usage, "unknown option '"//name//"'; "//hint)
  end subroutine raise_unknown

  !> Check the argument of an option, and whether the option may be repeated.
  pure subroutine judge_argument(option, argument, has_argument, options, err)
    type(option_type), intent(in) :: option            !< the option, as a row of its table
    character(len=*), intent(in) :: argument           !< its argument; empty where it has none
    logical, intent(in) :: has_argument                !< whether an argument is given
    type(command_line_type), intent(in) :: options     !< the options given before
    type(error_type), allocatable, intent(out) :: err  !< allocated if it failed
    character(len=:), allocatable :: name

    name = '--'//trim(option%name)
    if (option%takes == no_argument) then
      if (has_argument) call raise(err, exit_usage, name//' takes no argument')
    else if (option%takes == optional_argument .and. .not. has_argument) then
      return
    else if (argument == '') then
      call raise(err, exit_usage, name//' needs an argument: '//name//' '//trim(option%argument))
    else if (options%has(option%name) .and. .not. option%repeats) then
      call raise(err, exit_usage, name//' is given more than once')
    else if (option%form == whole_number .and. .not. is_whole_number(argument)) then
      call raise(err, exit_usage, name//" needs a whole number from 1 on, not '"//argument//"'")
    else if (option%form == part_of_whole .and. .not. is_part(argument)) then
      call raise(err, exit_usage, name//" needs the number K of a part, from 1 to N, and how many parts N there are, as in "// &
                 name//" 3/8; not '"//argument//"'")
    else if (option%form == assignment .and. .not. is_assignment(argument)) then
      call raise(err, exit_usage, name//' needs '//trim(option%argument)//', as in '//name &
                 //" time.end=2; not '"//argument//"'")
    end if
  end subroutine judge_argument

  !> Append an option. An array constructor would be shorter, but gfortran 12 leaks its content.
  pure subroutine append(given, name, argument)
    type(given_type), allocatable, intent(inout) :: given(:)  !< the options given so far
    character(len=*), intent(in) :: name                      !< name of the option, without the dashes
    character(len=*), intent(in) :: argument                  !< its argument; empty where it has none
    type(given_type), allocatable :: longer(:)
    integer :: i

    allocate (longer(size(given) + 1))
    do i = 1, size(given)
      longer(i)%name = given(i)%name
      call move_alloc(given(i)%argument, longer(i)%argument)
    end do
    longer(size(longer))%name = name
    longer(size(longer))%argument = argument
    call move_alloc(longer, given)
  end subroutine append

  !> Whether an option is given.
  pure logical function has(self, name)
    class(command_line_type), intent(in) :: self  !< the command line
    character(len=*), intent(in) :: name          !< name of the option, without the dashes

    has = place_of(self, name) > 0
  end function has

  !> The argument of an option that is given at most once; empty where it, or the option, is not given.
  pure function argument(self, name) result(text)
    class(command_line_type), intent(in) :: self  !< the command line
    character(len=*), intent(in) :: name          !< name of the option, without the dashes
    character(len=:), allocatable :: text
    integer :: place

    place = place_of(self, name)
    text = ''
    if (place > 0) text = self%given(place)%argument
  end function argument

  !> List the arguments of an option that may be repeated, or has several, in their order.
  pure subroutine arguments(self, name, texts)
    class(command_line_type), intent(in) :: self             !< the command line
    character(len=*), intent(in) :: name                     !< name of the option, without the dashes
    type(string_type), allocatable, intent(out) :: texts(:)  !< the arguments, in their order
    integer :: i, n

    allocate (texts(count(self%given%name == name)))
    n = 0
    do i = 1, size(self%given)
      if (self%given(i)%name /= name) cycle
      n = n + 1
      texts(n)%text = self%given(i)%argument
    end do
  end subroutine arguments

  !> The argument of an option that takes a whole number; `default` where it is not given.
  pure integer function number(self, name, default)
    class(command_line_type), intent(in) :: self  !< the command line
    character(len=*), intent(in) :: name          !< name of the option, without the dashes
    integer, intent(in) :: default                !< the result where the option is not given
    integer :: place

    number = default
    place = place_of(self, name)
    if (place > 0) read (self%given(place)%argument, *) number   ! checked when it was read
  end function number

  !> The number of a part and how many parts there are, as --part gives them; 1 of 1 where it is not given.
  pure function part(self)
    class(command_line_type), intent(in) :: self  !< the command line
    integer :: part(2)
    character(len=:), allocatable :: text
    integer :: slash

    part = 1
    if (.not. self%has('part')) return
    text = self%argument('part')
    slash = index(text, '/')
    read (text(:slash - 1), *) part(1)
    read (text(slash + 1:), *) part(2)
  end function part

  !> Position of an option among the given ones; 0 where it is not given.
  pure integer function place_of(self, name)
    class(command_line_type), intent(in) :: self  !< the command line
    character(len=*), intent(in) :: name          !< name of the option, without the dashes

    do place_of = size(self%given), 1, -1
      if (self%given(place_of)%name == name) return
    end do
  end function place_of

  !> The option that replaces the run by an answer, the first one where there are several; empty where none is given.
  pure function answer(self) result(name)
    class(command_line_type), intent(in) :: self  !< the command line
    character(len=:), allocatable :: name

    name = answer_of(self%given%name)
  end function answer

  !> The option that asks for positions of equilibrium in place of a run: equilibrium, modes or linear; empty where none is given.
  pure function rest(self) result(name)
    class(command_line_type), intent(in) :: self  !< the command line
    character(len=:), allocatable :: name

    name = rest_of(self%given%name)
  end function rest

  !> The table of an equilibrium, of modes or of exponents: the file that is named, or standard output where no other result is
  !> requested. It is empty for none.
  pure function table_of_answer(self) result(path)
    class(command_line_type), intent(in) :: self  !< the command line
    character(len=:), allocatable :: path

    path = self%argument('table')
    if (path /= '' .or. self%has('hdf5') .or. self%has('animate') .or. self%has('sketch') .or. self%has('no-write')) &
      return
    if (self%has('equilibrium') .or. self%has('modes') .or. self%has('exponents')) path = '-'
  end function table_of_answer

  !> Whether the program holds a conversation instead of working on a data file.
  pure logical function converses(self)
    class(command_line_type), intent(in) :: self  !< the command line

    converses = (self%file == '' .and. .not. (self%has('import') .or. self%has('merge'))) .or. self%has('dialogue') .or. &
                self%has('edit') .or. self%has('resume')
  end function converses
end module mech9_command_line
