!> Options that contradict each other, and those that take the place of a run.
module mech9_option_conflicts
  use mech9_program_kind, only: program_names
  use mech9_error, only: error_type, raise, exit_usage
  implicit none
  private
  public :: judge_options, answer_of, rest_of

  !> The options that replace a run by an answer, the first ones before the others.
  character(len=*), parameter :: answers(*) = [character(len=11) :: 'structure', 'check', 'plan', 'branches', 'range', 'cam', &
                                               'graph', 'equilibrium', 'modes', 'linear', 'exponents', 'branch', 'dakota']
  !> Those of them that are about positions of equilibrium.
  character(len=*), parameter :: of_rest(*) = [character(len=11) :: 'equilibrium', 'modes', 'linear']
  !> Options that a conversation does not take.
  character(len=*), parameter :: of_files(*) = [character(len=11) :: 'check', 'structure', 'plan', 'branches', 'range', 'cam', &
                                                'equilibrium', 'modes', 'linear', 'at', 'exponents', 'periodic', 'branch', &
                                                'study', &
                                                'optimize', 'dakota', 'set']

contains

  !> The option that replaces the run by an answer, the first one where there are several; empty where none is given.
  pure function answer_of(given) result(name)
    character(len=*), intent(in) :: given(:)  !< names of the options that are given, without the dashes
    character(len=:), allocatable :: name

    name = first_of(answers, given)
  end function answer_of

  !> The option that asks for positions of equilibrium in place of a run, the first one where there are several; empty where none is
  !> given, and where --at asks for a motion.
  pure function rest_of(given) result(name)
    character(len=*), intent(in) :: given(:)  !< names of the options that are given, without the dashes
    character(len=:), allocatable :: name

    name = ''
    if (all(given /= 'at')) name = first_of(of_rest, given)
  end function rest_of

  !> The first one of some names that is given; empty where none is.
  pure function first_of(names, given) result(name)
    character(len=*), intent(in) :: names(:)  !< names of options, without the dashes
    character(len=*), intent(in) :: given(:)  !< names of the options that are given
    character(len=:), allocatable :: name
    integer :: i

    name = ''
    do i = size(names), 1, -1
      if (any(given == names(i))) name = trim(names(i))
    end do
  end function first_of

  !> Fail where options contradict each other (exit_usage).
  pure subroutine judge_options(program, given, has_file, converses, err)
    integer, intent(in) :: program                     !< kinematics or dynamics
    character(len=*), intent(in) :: given(:)           !< names of the options that are given, without the dashes
    logical, intent(in) :: has_file                    !< a data file is given
    logical, intent(in) :: converses                   !< the program holds a conversation
    type(error_type), allocatable, intent(out) :: err  !< allocated if they do

    if (has('help') .or. has('version') .or. has('help-data')) return
    if (has('import') .or. (has('out') .and. .not. has('optimize'))) then
      call judge_import(given, has_file, err)
    else if (has('merge')) then
      call judge_merge(given, has_file, err)
    else if (has('part') .and. .not. (has('study') .or. has('optimize'))) then
      call raise(err, exit_usage, '--part K/N is a part of --study or --optimize; give one of them, too')
    else if (has('threads') .and. .not. (has('study') .or. has('optimize'))) then
      call raise(err, exit_usage, '--threads N is the number of threads of --study or --optimize; give one of them, too')
    else if (has('continue') .and. .not. (has('study') .or. has('optimize'))) then
      call raise(err, exit_usage, '--continue FILE.h5 makes the runs of --study, or the starts of --optimize, that the '// &
                 'file does not have yet; give one of them, too')
    else if (has('continue') .and. (has('hdf5') .or. has('no-write'))) then
      call raise(err, exit_usage, '--continue FILE.h5 writes to its own file; leave --hdf5 and --no-write out')
    else if (has('quiet') .and. has('verbose')) then
      call raise(err, exit_usage, '--quiet and --verbose contradict each other')
    else if (has('no-write') .and. (has('table') .or. has('hdf5') .or. has('plot') .or. has('linear'))) then
      call raise(err, exit_usage, '--no-write contradicts --table, --hdf5, --plot and --linear')
    else if (has('at') .and. .not. has('linear')) then
      call raise(err, exit_usage, '--at gives the times of a motion at which --linear FILE.h5 linearises; give both')
    else if (has('mode') .neqv. (has('modes') .and. has('animate'))) then
      call judge_mode(has('mode'), err)
    else if (has('modes') .and. has('equilibrium')) then
      call raise(err, exit_usage, '--equilibrium and --modes write different tables; give one of them, --modes finds the '// &
                 'equilibrium, too')
    else if (converses) then
      call judge_conversation(program, given, has_file, err)
    else if (has('study') .and. has('optimize')) then
      call raise(err, exit_usage, '--study and --optimize are different tasks; give one of them')
    else if (has('dakota')) then
      call judge_dakota(given, err)
    else if (has('study')) then
      call judge_study(given, err)
    else if (has('optimize')) then
      call judge_optimum(given, err)
    else if (has('at')) then
      call judge_linear_motion(given, err)
    else if (has('exponents')) then
      call judge_exponents(given, err)
    else if (has('branch')) then
      call judge_branch(given, err)
    else if (has('periodic') .and. answer_of(given) /= '') then
      call raise(err, exit_usage, '--'//answer_of(given)//' and --periodic are two tasks; give one of them')
    else if (rest_of(given) /= '') then
      call judge_rest(given, err)
    else if (has('animate') .and. answer_of(given) /= '') then
      call raise(err, exit_usage, '--animate shows a run, and --'//answer_of(given)//' makes none; leave one of them out')
    end if
  contains
    !> Whether an option is given.
    pure logical function has(name)
      character(len=*), intent(in) :: name   !< its name, without the dashes

      has = any(given == name)
    end function has
  end subroutine judge_options

  !> Check the options of an import: it makes a data file of another file, and no run.
  pure subroutine judge_import(given, has_file, err)
    character(len=*), intent(in) :: given(:)           !< names of the options that are given, without the dashes
    logical, intent(in) :: has_file                    !< a data file is given beside the options
    type(error_type), allocatable, intent(out) :: err  !< allocated if they contradict it
    integer :: i

    if (.not. any(given == 'import')) then
      call raise(err, exit_usage, '--out names the data file that --import FILE or --optimize writes; give one of them, too')
    else if (has_file) then
      call raise(err, exit_usage, 'a data file is given beside --import, which makes one; leave it out, or write the file of '// &
                 'loops directly behind that of the robot')
    end if
    do i = 1, size(given)
      if (allocated(err)) return
      if (all(given(i) /= [character(len=6) :: 'import', 'out', 'quiet'])) &
        call raise(err, exit_usage, '--import makes a data file and no run; leave --'//trim(given(i))//' out')
    end do
  end subroutine judge_import

  !> Check the options of a merge: it makes one file of several, and no run.
  pure subroutine judge_merge(given, has_file, err)
    character(len=*), intent(in) :: given(:)           !< names of the options that are given, without the dashes
    logical, intent(in) :: has_file                    !< a data file is given beside the options
    type(error_type), allocatable, intent(out) :: err  !< allocated if they contradict it
    integer :: i

    if (has_file) then
      call raise(err, exit_usage, 'a data file is given beside --merge, which reads the files of parts alone; leave it out')
    else if (count(given == 'merge') < 2) then
      call raise(err, exit_usage, '--merge joins the files of parts of a study or search; give two of them or more')
    else if (.not. (any(given == 'hdf5') .or. any(given == 'table'))) then
      call raise(err, exit_usage, '--merge needs the file that it makes: give --hdf5 FILE.h5, or --table FILE')
    end if
    do i = 1, size(given)
      if (allocated(err)) return
      if (all(given(i) /= [character(len=5) :: 'merge', 'hdf5', 'table', 'quiet'])) &
        call raise(err, exit_usage, '--merge makes no run; leave --'//trim(given(i))//' out')
    end do
  end subroutine judge_merge

  !> Fail because of options that have no meaning beside --study.
  pure subroutine judge_study(given, err)
    character(len=*), intent(in) :: given(:)           !< names of the options that are given, without the dashes
    type(error_type), allocatable, intent(out) :: err  !< allocated if there is one
    character(len=:), allocatable :: other

    other = first_of([answers, [character(len=11) :: 'sketch', 'animate', 'view', 'verbose', 'periodic']], given)
    if (other /= '') call raise(err, exit_usage, '--study makes many runs and writes a table with a row for each; leave --'// &
                                other//' out')
  end subroutine judge_study

  !> Fail because of options that have no meaning beside --optimize.
  pure subroutine judge_optimum(given, err)
    character(len=*), intent(in) :: given(:)           !< names of the options that are given, without the dashes
    type(error_type), allocatable, intent(out) :: err  !< allocated if there is one
    character(len=:), allocatable :: other

    other = first_of([answers, [character(len=11) :: 'verbose', 'periodic']], given)
    if (other /= '') call raise(err, exit_usage, '--optimize searches for a design and writes a table with a row for each one '// &
                                'that it finds; leave --'//other//' out, and give it to a run of the design')
  end subroutine judge_optimum

  !> Check the options beside --dakota, which takes two files and writes nothing but results for Dakota and a report.
  pure subroutine judge_dakota(given, err)
    character(len=*), intent(in) :: given(:)           !< names of the options that are given, without the dashes
    type(error_type), allocatable, intent(out) :: err  !< allocated if they contradict it
    integer :: i

    if (count(given == 'dakota') < 2) call raise(err, exit_usage, '--dakota needs two files: --dakota PARAMS RESULTS')
    do i = 1, size(given)
      if (allocated(err)) return
      if (all(given(i) /= [character(len=6) :: 'dakota', 'set', 'quiet', 'report'])) &
        call raise(err, exit_usage, '--dakota makes one run for Dakota; leave --'//trim(given(i))//' out')
    end do
  end subroutine judge_dakota

  !> Fail because of --modes with --animate and without --mode, or the other way round.
  pure subroutine judge_mode(has_mode, err)
    logical, intent(in) :: has_mode                    !< --mode is given
    type(error_type), allocatable, intent(out) :: err  !< the failure

    if (has_mode) then
      call raise(err, exit_usage, '--mode tells which mode --modes --animate FILE shows; give all three')
    else
      call raise(err, exit_usage, '--modes --animate shows one mode; tell which by --mode K')
    end if
  end subroutine judge_mode

  !> Fail because of options that have no meaning beside --equilibrium, --modes and --linear.
  pure subroutine judge_rest(given, err)
    character(len=*), intent(in) :: given(:)           !< names of the options that are given, without the dashes
    type(error_type), allocatable, intent(out) :: err  !< allocated if there is one
    character(len=:), allocatable :: rest, other

    rest = '--'//rest_of(given)
    other = answer_of(given)
    if ('--'//other /= rest) then
      call raise(err, exit_usage, '--'//other//' and '//rest//' are two tasks; give one of them')
      return
    end if
    other = first_of(['plot'], given)
    if (other == '' .and. .not. any(given == 'modes')) other = first_of(['animate'], given)
    if (other /= '') then
      call raise(err, exit_usage, '--'//other//' shows a run, and '//rest//' makes none; leave one of them out')
    else if (any(given == 'view') .and. .not. (any(given == 'animate') .or. any(given == 'sketch'))) then
      call raise(err, exit_usage, '--view is the view of a picture of the mechanism, and none is drawn; leave it out, or give '// &
                 '--sketch')
    else if (any(given == 'starts') .and. rest /= '--equilibrium') then
      call raise(err, exit_usage, '--starts belongs to --equilibrium, and '//rest//' is about the equilibrium to which the '// &
                 'initial position leads; leave it out')
    else if (any(given == 'starts') .and. any(given == 'linear')) then
      call raise(err, exit_usage, '--linear is about one equilibrium, and --starts finds several; leave one of them out')
    end if
  end subroutine judge_rest

  !> Fail because of options that have no meaning beside --exponents.
  pure subroutine judge_exponents(given, err)
    character(len=*), intent(in) :: given(:)           !< names of the options that are given, without the dashes
    type(error_type), allocatable, intent(out) :: err  !< allocated if there are any
    character(len=*), parameter :: allowed(*) = [character(len=9) :: 'exponents', 'table', 'report', 'no-write', 'quiet', 'set']
    integer :: i

    do i = 1, size(given)
      if (any(given(i) == allowed)) cycle
      if (any(given(i) == answers)) then
        call raise(err, exit_usage, '--'//trim(given(i))//' and --exponents are two tasks; give one of them')
      else
        call raise(err, exit_usage, '--'//trim(given(i))//' has no meaning beside --exponents, which writes a table and a '// &
                   'report; leave one of them out')
      end if
      return
    end do
  end subroutine judge_exponents

  !> Fail because of options that have no meaning beside --branch.
  pure subroutine judge_branch(given, err)
    character(len=*), intent(in) :: given(:)           !< names of the options that are given, without the dashes
    type(error_type), allocatable, intent(out) :: err  !< allocated if there are any
    character(len=*), parameter :: allowed(*) = [character(len=8) :: 'branch', 'table', 'hdf5', 'plot', 'names', 'report', &
                                                 'no-write', 'quiet', 'set']
    integer :: i

    do i = 1, size(given)
      if (any(given(i) == allowed)) cycle
      if (given(i) == 'starts' .or. .not. any(given(i) == answers)) then
        call raise(err, exit_usage, '--'//trim(given(i))//' has no meaning beside --branch, which writes a table, plots and a '// &
                   'report; leave one of them out')
      else
        call raise(err, exit_usage, '--'//trim(given(i))//' and --branch are two tasks; give one of them')
      end if
      return
    end do
  end subroutine judge_branch

  !> Fail because of options that have no meaning beside --linear with --at.
  pure subroutine judge_linear_motion(given, err)
    character(len=*), intent(in) :: given(:)           !< names of the options that are given, without the dashes
    type(error_type), allocatable, intent(out) :: err  !< allocated if there are any
    character(len=*), parameter :: allowed(*) = [character(len=6) :: 'linear', 'at', 'report', 'quiet', 'set']
    integer :: i

    do i = 1, size(given)
      if (any(given(i) == allowed)) cycle
      if (any(given(i) == answers)) then
        call raise(err, exit_usage, '--'//trim(given(i))//' and --linear with --at are two tasks; give one of them')
      else
        call raise(err, exit_usage, '--'//trim(given(i))//' has no meaning beside --linear with --at, which writes matrices '// &
                   'alone; leave one of them out')
      end if
      return
    end do
  end subroutine judge_linear_motion

  !> Check the options of a conversation: it takes one data file or none, and no option that replaces the run by an answer.
  pure subroutine judge_conversation(program, given, has_file, err)
    integer, intent(in) :: program                     !< kinematics or dynamics
    character(len=*), intent(in) :: given(:)           !< names of the options that are given, without the dashes
    logical, intent(in) :: has_file                    !< a data file is given beside the options
    type(error_type), allocatable, intent(out) :: err  !< allocated if it failed
    character(len=:), allocatable :: missing, other

    other = first_of(of_files, given)
    if (other /= '') then
      missing = 'no data file is given'
      if (has_file .or. any(given == 'edit') .or. any(given == 'resume')) missing = 'this is a conversation'
      call raise(err, exit_usage, missing//'; --'//other//' is for a data file alone: '//program_names(program)//' FILE --'//other)
    else if (count([has_file, any(given == 'edit'), any(given == 'resume')]) > 1) then
      call raise(err, exit_usage, 'more than one data file is given; a conversation takes one')
    end if
  end subroutine judge_conversation
end module mech9_option_conflicts
