!> Tests of mech9_command_line: the words are an array, so that any command line can be tried here.
module test_command_line
  use mech9_program_kind, only: kinematics, dynamics, belongs_to
  use mech9_error, only: error_type, exit_usage
  use mech9_text, only: string_type
  use mech9_options, only: options_table, option_names, find_option, needed_argument, whole_number, part_of_whole
  use mech9_command_line, only: command_line_type, parse_command_line
  use mech9_help_text, only: help_text
  use mech9_testing, only: tester_type
  implicit none
  private
  public :: run

contains

  !> Run the cases of this suite.
  subroutine run(tester)
    type(tester_type), intent(inout) :: tester   !< selects cases and counts their checks

    if (tester%runs('test_good_lines')) call test_good_lines(tester)
    if (tester%runs('test_every_option')) call test_every_option(tester)
    if (tester%runs('test_bad_lines')) call test_bad_lines(tester)
    if (tester%runs('test_line_for_shell')) call test_line_for_shell(tester)
    if (tester%runs('test_help')) call test_help(tester)
  end subroutine run

  !> Parse a line whose words are separated by `|`.
  subroutine parse(line, options, err, program)
    character(len=*), intent(in) :: line                     !< words with `|` between them
    integer, intent(in), optional :: program   !< mech9k unless given
    type(command_line_type), intent(out) :: options          !< options that it asks for
    type(error_type), allocatable, intent(out) :: err        !< allocated if it failed
    type(string_type), allocatable :: words(:)
    integer :: first, next, i

    allocate (words(count([(line(i:i) == '|', i=1, len(line))]) + merge(1, 0, len(line) > 0)))
    first = 1
    do i = 1, size(words)
      next = index(line(first:)//'|', '|') + first - 1
      words(i)%text = line(first:next - 1)
      first = next + 1
    end do
    if (present(program)) then
      call parse_command_line(words, program, options, err)
    else
      call parse_command_line(words, kinematics, options, err)
    end if
  end subroutine parse

  subroutine test_good_lines(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(command_line_type) :: options
    type(string_type), allocatable :: settings(:)
    type(error_type), allocatable :: err

    call parse('a.nml', options, err)
    call tester%no_error(err, 'a file alone is accepted')
    call tester%is_true(options%file == 'a.nml' .and. .not. options%has('check') .and. options%argument('table') == '' &
                        .and. .not. options%has('set'), 'a file alone asks for nothing else')
    call parse('--table=x y.dat|--check|a b.nml|--report|r=1.json', options, err)
    call tester%no_error(err, 'options before and after the file and blanks in names are accepted')
    call tester%is_true(options%argument('table') == 'x y.dat' .and. options%argument('report') == 'r=1.json' &
                        .and. options%has('check') .and. options%file == 'a b.nml', 'both forms of an argument are read')
    call parse('a.nml|--table|-', options, err)
    call tester%is_true(options%argument('table') == '-', 'a dash is standard output')
    call parse('--quiet|--|--check', options, err)
    call tester%is_true(options%file == '--check' .and. options%has('quiet') .and. .not. options%has('check'), &
                        'after two dashes everything is a file')
    call parse('a.nml|--set|time.end=2|--set=drive.coefficients=1,2|--set|mechanism.title=a=b', options, err)
    call tester%no_error(err, 'settings are accepted')
    call options%arguments('set', settings)
    call tester%is_true(size(settings) == 3, 'settings are gathered')
    call tester%is_true(settings(1)%text == 'time.end=2' .and. settings(2)%text == 'drive.coefficients=1,2' &
                        .and. settings(3)%text == 'mechanism.title=a=b', 'settings are read word by word')
    call parse('a.nml|--starts|12', options, err)
    call tester%is_true(options%number('starts', 5) == 12, 'a whole number is read')
    call parse('a.nml', options, err)
    call tester%is_true(options%number('starts', 5) == 5, 'a whole number that is not given has its default')
    call parse('--help-data', options, err)
    call tester%is_true(options%has('help-data') .and. options%argument('help-data') == '' .and. .not. allocated(err), &
                        'an optional argument may be left out, and no file is needed')
    call parse('--help-data|pair', options, err)
    call tester%is_true(options%has('help-data') .and. options%argument('help-data') == 'pair', 'an optional argument is read')
    call parse('--help-data|--quiet', options, err)
    call tester%is_true(options%argument('help-data') == '' .and. options%has('quiet'), &
                        'an option is not taken as an optional argument')
  end subroutine test_good_lines

  !> Each row of the table is understood and changes what is asked for.
  subroutine test_every_option(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(command_line_type) :: options
    type(error_type), allocatable :: err
    character(len=*), parameter :: argument = 'time.end=3'
    character(len=12) :: name
    character(len=40) :: word
    integer :: program
    type(string_type), allocatable :: given(:)
    integer :: i, of_both

    of_both = 0
    do i = 1, size(options_table)
      name = options_table(i)%name
      program = dynamics
      if (belongs_to(options_table(i)%program, kinematics)) then
        program = kinematics
        of_both = of_both + 1
      end if
      if (name == 'dakota' .or. name == 'merge') cycle   ! they take several files: tests/study
      word = '--'//name
      if (options_table(i)%form == whole_number) then
        word = trim(word)//'=7'
      else if (options_table(i)%form == part_of_whole) then
        word = trim(word)//'=2/7'
      else if (options_table(i)%takes == needed_argument) then
        word = trim(word)//'='//argument
      end if
      if (name == 'edit' .or. name == 'resume') then
        call parse(trim(word), options, err)       ! they name the file themselves
      else if (name == 'import') then
        call parse(trim(word), options, err)       ! it makes the data file
      else if (name == 'out') then
        call parse('--import|a.urdf|'//trim(word), options, err)
      else if (any(name == [character(len=8) :: 'part', 'threads', 'continue'])) then
        call parse('a.nml|--study|'//trim(word), options, err)
      else if (name == 'at') then
        call parse('a.nml|--linear|a.h5|'//trim(word), options, err, program)
      else if (name == 'mode') then
        call parse('a.nml|--modes|--animate|a.svg|'//trim(word), options, err, program)
      else
        call parse('a.nml|'//trim(word), options, err, program)
      end if
      call tester%no_error(err, trim(word))
      call options%arguments(name, given)
      call tester%is_true(options%has(name) .and. size(given) == 1, trim(word)//' is taken')
      if (options_table(i)%takes == needed_argument) &
        call tester%is_true(options%argument(name) == word(index(word, '=') + 1:), trim(word)//' keeps its argument')
      call tester%is_true(index(help_text(program), '--'//trim(name)//' ') > 0, trim(word)//' is in the help')
    end do
    call tester%is_true(size(option_names(kinematics)) == of_both .and. of_both < size(options_table) &
                        .and. find_option('range', kinematics) > 0 .and. find_option('range', dynamics) == 0, &
                        'options belong to programs')
  end subroutine test_every_option

  subroutine test_bad_lines(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks

    call refuse(tester, '--edit|a.nml|b.nml', 'more than one data file')
    call refuse(tester, '--edit|a.nml|--resume|b.nml', 'more than one data file')
    call refuse(tester, '--dialogue|a.nml|--set|time.end=2', 'this is a conversation; --set is for a data file alone')
    call refuse(tester, '--edit|a.nml|--check', 'this is a conversation; --check is for a data file alone')
    call refuse(tester, '--check', 'no data file')
    call refuse(tester, 'a.nml|--part|1/2', '--part K/N is a part of --study or --optimize')
    call refuse(tester, 'a.nml|--threads|2', '--threads N is the number of threads of --study')
    call refuse(tester, 'a.nml|--study|--part|3/2', '--part needs the number K of a part, from 1 to N')
    call refuse(tester, 'a.nml|--study|--check', 'leave --check out')
    call refuse(tester, 'a.nml|--range', 'only mech9k has it', dynamics)
    call refuse(tester, 'a.nml|--modes', 'only mech9d has it')
    call refuse(tester, 'a.nml|--modes|--equilibrium', 'different tables', dynamics)
    call refuse(tester, 'a.nml|--mode|2', 'give all three', dynamics)
    call refuse(tester, 'a.nml|--modes|--animate|a.svg', 'tell which by --mode K', dynamics)
    call refuse(tester, 'a.nml|--equilibrium|--animate|a.svg', '--animate shows a run', dynamics)
    call refuse_beside_rest(tester)
    call refuse(tester, 'a.nml|b.nml', "two data files are given, 'a.nml' and 'b.nml'")
    call refuse(tester, 'a.nml||', 'the name of the data file is empty')
    call refuse(tester, 'a.nml|--tabel|x', "unknown option '--tabel'; did you mean --table?")
    call refuse(tester, 'a.nml|--tabel=x', "'--tabel'; did you mean --table?")
    call refuse(tester, 'a.nml|-check', "'-check'; did you mean --check?")
    call refuse(tester, 'a.nml|--zzzzzzzz', "'--zzzzzzzz'; mech9k --help lists")
    call refuse(tester, 'a.nml|---', "unknown option '---'")
    call refuse(tester, 'a.nml|--=x', "unknown option '--'")
    call refuse(tester, 'a.nml|--netcdf|x', "unknown option '--netcdf'")
    call refuse(tester, 'a.nml|--table', '--table needs an argument: --table PATH')
    call refuse(tester, 'a.nml|--table|--quiet', '--table needs an argument')
    call refuse(tester, 'a.nml|--table=', '--table needs an argument')
    call refuse(tester, 'a.nml|--help-data=', '--help-data needs an argument: --help-data GROUP')
    call refuse(tester, 'a.nml|--table|a|--table|b', '--table is given more than once')
    call refuse(tester, 'a.nml|--check=yes', '--check takes no argument')
    call refuse(tester, 'a.nml|--set|end=2', "--set needs GROUP.NAME=VALUE")
    call refuse(tester, 'a.nml|--set|.end=2', "not '.end=2'")
    call refuse(tester, 'a.nml|--set|time.=2', "not 'time.=2'")
    call refuse(tester, 'a.nml|--set|time.end', "not 'time.end'")
    call refuse(tester, 'a.nml|--set|x=1.5', "not 'x=1.5'")
    call refuse(tester, 'a.nml|--starts|many', "--starts needs a whole number from 1 on, not 'many'")
    call refuse(tester, 'a.nml|--starts|0', "not '0'")
    call refuse(tester, 'a.nml|--starts|99999999999', "not '99999999999'")
    call refuse(tester, 'a.nml|--quiet|--verbose', 'contradict')
    call refuse(tester, 'a.nml|--no-write|--table=x', 'contradict')
    call refuse(tester, 'a.nml|--no-write|--hdf5=x', 'contradict')
  end subroutine test_bad_lines

  !> Options without meaning beside those about equilibrium are refused, and all others are taken.
  subroutine refuse_beside_rest(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    character(len=*), parameter :: of_rest(*) = [character(len=14) :: '--equilibrium', '--modes', '--linear|l.h5']
    character(len=*), parameter :: good(*) = [character(len=16) :: '--table|t.dat', '--hdf5|h.h5', '--report|r.json', &
                                              '--set|time.end=3', '--quiet', '--verbose']
    character(len=*), parameter :: answers(*) = [character(len=14) :: '--check', '--structure', '--plan', '--branches', &
                                                 '--graph|g.svg']
    type(command_line_type) :: options
    type(error_type), allocatable :: err
    character(len=:), allocatable :: start
    integer :: i, k

    do i = 1, size(of_rest)
      start = 'a.nml|'//trim(of_rest(i))//'|'
      do k = 1, size(good)
        call parse(start//trim(good(k)), options, err, dynamics)
        call tester%no_error(err, start//trim(good(k)))
      end do
      do k = 1, size(answers)
        call refuse(tester, start//trim(answers(k)), 'are two tasks', dynamics)
      end do
      call refuse(tester, start//'--plot|q1', '--plot shows a run', dynamics)
      call parse(start//'--sketch|s.svg|--view|xy', options, err, dynamics)
      call tester%no_error(err, start//'--sketch|s.svg|--view|xy')
      call refuse(tester, start//'--view|xy', 'none is drawn', dynamics)
      if (i > 1) call refuse(tester, start//'--starts|3', '--starts belongs to --equilibrium', dynamics)
    end do
    call refuse(tester, 'a.nml|--equilibrium|--starts|3|--linear|l.h5', '--linear is about one equilibrium', dynamics)
    call refuse(tester, 'a.nml|--linear|l.h5|--no-write', 'contradicts', dynamics)
    call refuse(tester, 'a.nml|--linear|l.h5|--animate|a.svg', '--animate shows a run', dynamics)
    call refuse(tester, 'a.nml|--equilibrium|--starts|-1', "--starts needs a whole number from 1 on, not '-1'", dynamics)
  end subroutine refuse_beside_rest

  !> The line is an error of usage whose message holds some words.
  subroutine refuse(tester, line, words, program)
    type(tester_type), intent(inout) :: tester               !< counts the checks
    character(len=*), intent(in) :: line                     !< words with `|` between them
    character(len=*), intent(in) :: words                    !< of the message
    integer, intent(in), optional :: program   !< mech9k unless given
    type(command_line_type) :: options
    type(error_type), allocatable :: err

    call parse(line, options, err, program)
    call tester%has_error(err, exit_usage, line)
    if (allocated(err)) call tester%is_true(index(err%message, words) > 0, &
                                            line//' is refused with the right part in the message: '//err%message)
  end subroutine refuse

  !> The help fits a terminal of 100 columns, and its lines end without blanks.
  !> All words as one line. A shell takes 'a'\''b' for a'b.
  subroutine test_line_for_shell(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(command_line_type) :: options
    type(error_type), allocatable :: err
    integer, parameter :: many = 3000000

    call parse("it's.nml|--set|pair(2).point=1,2|--table=a b|--quiet", options, err)
    call tester%is_true(options%line == "'it'\''s.nml' --set 'pair(2).point=1,2' '--table=a b' --quiet", &
                        'words with blanks and quotes are written in quotes')
    call parse('', options, err)
    call tester%is_true(options%line == '', 'an empty command line has no words')
    ! work that grew with the square of its length would take an hour
    call parse("a.nml|--set|user.parameters='"//repeat('1,', many), options, err)
    call tester%is_true(options%line == "a.nml --set 'user.parameters='\''"//repeat('1,', many)//"'", &
                        'a long word is written whole')
  end subroutine test_line_for_shell

  subroutine test_help(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    character(len=:), allocatable :: text
    integer :: first, next

    text = help_text(kinematics)//achar(10)
    call tester%is_true(index(text, 'usage: mech9k FILE [options]') == 1, 'the help begins with the usage')
    first = 1
    do while (first <= len(text))
      next = index(text(first:), achar(10)) + first - 1
      call tester%is_true(next - first <= 100, 'no line of the help is too long: '//text(first:next - 1))
      if (next > first) call tester%is_true(text(next - 1:next - 1) /= ' ', 'no line of the help ends with a blank')
      first = next + 1
    end do
  end subroutine test_help
end module test_command_line
