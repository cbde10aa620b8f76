!> Options that contradict each other, one case for each reason, and those that replace a run.
module test_option_conflicts
  use mech9_program_kind, only: kinematics, dynamics
  use mech9_error, only: error_type, exit_usage
  use mech9_options, only: options_table
  use mech9_option_conflicts, only: judge_options, answer_of, rest_of
  use mech9_checks, only: has_message
  use mech9_testing, only: tester_type
  implicit none
  private
  public :: run

  character(len=12), parameter :: none(0) = [character(len=12) ::]

contains

  !> Run the cases of this suite.
  subroutine run(tester)
    type(tester_type), intent(inout) :: tester   !< selects cases and counts their checks

    if (tester%runs('answers')) call answers(tester)
    if (tester%runs('good_options')) call good_options(tester)
    if (tester%runs('runs_and_studies')) call runs_and_studies(tester)
    if (tester%runs('imports_and_merges')) call imports_and_merges(tester)
    if (tester%runs('equilibria')) call equilibria(tester)
    if (tester%runs('conversations')) call conversations(tester)
    if (tester%runs('help_first')) call help_first(tester)
  end subroutine run

  !> Names of options from a text with blanks between them.
  pure function names_in(text) result(names)
    character(len=*), intent(in) :: text   !< the names
    character(len=12), allocatable :: names(:)
    integer :: first, last

    names = none
    first = 1
    do while (first <= len(text))
      last = first + index(text(first:)//' ', ' ') - 2
      names = [character(len=12) :: names, text(first:last)]
      first = last + 2
    end do
  end function names_in

  subroutine refused(tester, names, words)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    character(len=*), intent(in) :: names        !< of options beside a data file
    character(len=*), intent(in) :: words        !< part of the message
    type(error_type), allocatable :: err

    call judge_options(dynamics, names_in(names), .true., .false., err)
    call has_message(tester, err, exit_usage, words, 'a contradiction: '//names)
  end subroutine refused

  subroutine accepted(tester, names, has_file)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    character(len=*), intent(in) :: names        !< of options
    logical, intent(in) :: has_file              !< a data file is given
    type(error_type), allocatable :: err

    call judge_options(dynamics, names_in(names), has_file, .false., err)
    call tester%no_error(err, 'good options: '//names)
  end subroutine accepted

  subroutine answers(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks

    call tester%is_true(answer_of(none) == '' .and. rest_of(none) == '', 'no options')
    call tester%is_true(answer_of(names_in('table plan check')) == 'check', 'the first one of the answers, whatever the order')
    call tester%is_true(answer_of(names_in('modes structure')) == 'structure', 'the structure comes first')
    call tester%is_true(rest_of(names_in('linear modes')) == 'modes' .and. rest_of(names_in('check')) == '' &
                        .and. rest_of(names_in('linear at')) == '', 'rest')
  end subroutine answers

  !> Each option alone is good, but for those that belong to others.
  subroutine good_options(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    character(len=*), parameter :: partners(10) = [character(len=12) :: 'part', 'threads', 'continue', 'mode', 'at', 'out', &
                                                  'merge', 'dakota', 'import', 'edit']
    integer :: i

    do i = 1, size(options_table)
      if (any(partners == options_table(i)%name)) cycle
      call accepted(tester, trim(options_table(i)%name), .true.)
    end do
    call accepted(tester, 'study part threads continue table', .true.)
    call accepted(tester, 'modes mode animate view', .true.)
    call accepted(tester, 'equilibrium starts', .true.)
    call accepted(tester, 'linear at set quiet report', .true.)
    call accepted(tester, 'merge merge hdf5 table quiet', .false.)
    call accepted(tester, 'import out quiet', .false.)
    call accepted(tester, 'optimize out animate plot', .true.)
    call accepted(tester, 'dakota dakota set quiet report', .true.)
  end subroutine good_options

  subroutine runs_and_studies(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks

    call refused(tester, 'part', '--part K/N is a part of --study or --optimize')
    call refused(tester, 'threads', '--threads N is the number of threads of --study')
    call refused(tester, 'continue', '--continue FILE.h5 makes the runs of --study')
    call refused(tester, 'study continue hdf5', '--continue FILE.h5 writes to its own file')
    call refused(tester, 'quiet verbose', '--quiet and --verbose contradict each other')
    call refused(tester, 'no-write table', '--no-write contradicts --table')
    call refused(tester, 'study optimize', '--study and --optimize are different tasks')
    call refused(tester, 'study sketch', '--study makes many runs')
    call refused(tester, 'study check', 'leave --check out')
    call refused(tester, 'optimize verbose', '--optimize searches for a design')
    call refused(tester, 'animate plan', '--animate shows a run, and --plan makes none')
    call refused(tester, 'dakota', '--dakota needs two files')
    call refused(tester, 'dakota dakota table', '--dakota makes one run for Dakota; leave --table out')
  end subroutine runs_and_studies

  subroutine imports_and_merges(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks

    call refused(tester, 'out', '--out names the data file that --import FILE or --optimize writes')
    call refused(tester, 'import', 'a data file is given beside --import')
    call refused(tester, 'merge merge table', 'a data file is given beside --merge')
    call refused_without_file('import table', '--import makes a data file and no run; leave --table out')
    call refused_without_file('merge hdf5', '--merge joins the files of parts of a study or search; give two of them or more')
    call refused_without_file('merge merge', '--merge needs the file that it makes')
    call refused_without_file('merge merge hdf5 check', '--merge makes no run; leave --check out')
  contains
    subroutine refused_without_file(names, words)
      character(len=*), intent(in) :: names   !< of options
      character(len=*), intent(in) :: words   !< part of the message
      type(error_type), allocatable :: err

      call judge_options(dynamics, names_in(names), .false., .false., err)
      call has_message(tester, err, exit_usage, words, 'a contradiction: '//names)
    end subroutine refused_without_file
  end subroutine imports_and_merges

  subroutine equilibria(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks

    call refused(tester, 'mode', '--mode tells which mode --modes --animate FILE shows')
    call refused(tester, 'modes animate', 'tell which by --mode K')
    call refused(tester, 'at', '--at gives the times of a motion at which --linear FILE.h5 linearises; give both')
    call refused(tester, 'linear at modes', '--modes and --linear with --at are two tasks')
    call refused(tester, 'linear at table', '--table has no meaning beside --linear with --at')
    call refused(tester, 'modes equilibrium', '--equilibrium and --modes write different tables')
    call refused(tester, 'modes check', '--check and --modes are two tasks')
    call refused(tester, 'equilibrium plot', '--plot shows a run')
    call refused(tester, 'equilibrium animate', '--animate shows a run')
    call refused(tester, 'linear view', '--view is the view of a picture')
    call refused(tester, 'modes starts', '--starts belongs to --equilibrium')
    call refused(tester, 'equilibrium linear starts', '--linear is about one equilibrium')
  end subroutine equilibria

  subroutine conversations(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(error_type), allocatable :: err

    call judge_options(kinematics, names_in('check'), .false., .true., err)
    call has_message(tester, err, exit_usage, 'no data file is given; --check is for a data file alone: mech9k FILE --check', &
                     'an answer without a data file')
    call judge_options(kinematics, names_in('edit range'), .false., .true., err)
    call has_message(tester, err, exit_usage, 'this is a conversation; --range', 'an answer in a conversation')
    call judge_options(kinematics, names_in('edit'), .true., .true., err)
    call has_message(tester, err, exit_usage, 'more than one data file is given', 'two data files')
    call judge_options(kinematics, names_in('resume table'), .false., .true., err)
    call tester%no_error(err, 'a conversation with a table')
  end subroutine conversations

  !> Who asks for help gets it, whatever else is given.
  subroutine help_first(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks

    call accepted(tester, 'help quiet verbose', .true.)
    call accepted(tester, 'version merge', .true.)
    call accepted(tester, 'help-data part', .false.)
  end subroutine help_first
end module test_option_conflicts
