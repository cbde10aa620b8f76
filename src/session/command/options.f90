!> The one table of the options of the command line; reading and help both come from it.
module mech9_options
  use mech9_program_kind, only: kinematics, dynamics, both => both_programs, belongs_to
  implicit none
  private
  public :: option_type, options_table, option_names, find_option
  public :: no_argument, optional_argument, needed_argument, any_text, whole_number, assignment, part_of_whole

  integer, parameter :: no_argument = 0, optional_argument = 1, needed_argument = 2
  !> Forms of an argument: any text, a whole number from 1 on, GROUP.NAME=VALUE, K/N.
  integer, parameter :: any_text = 0, whole_number = 1, assignment = 2, part_of_whole = 3

  !> Arguments of an option that takes as many as there are.
  integer, parameter :: unlimited_arguments = huge(1)

  !> One option.
  type :: option_type
    character(len=12) :: name       !< name of the option, without the dashes
    integer :: takes = no_argument  !< whether it takes an argument
    character(len=18) :: argument = ''    !< the argument's name in the help
    integer :: form = any_text    !< the form of the argument
    logical :: repeats = .false.  !< whether it may be given more than once
    integer :: program = both     !< the program that has it
    character(len=72) :: help = ''        !< its explanation, in one line
    integer :: most = 1           !< largest number of its arguments
  end type option_type

  type(option_type), parameter :: options_table(*) = [ &
    option_type('check', no_argument, '', any_text, .false., both, &
                'read, check and assemble the mechanism without running it'), &
    option_type('structure', no_argument, '', any_text, .false., both, &
                'print the structural vectors nrg, nws, rdw, nrw'), &
    option_type('plan', no_argument, '', any_text, .false., both, &
                'print the computations in their order, and those that are left out'), &
    option_type('branches', no_argument, '', any_text, .false., both, &
                'list the assemblies of the start, from random guesses (no &branch)'), &
    option_type('starts', needed_argument, 'N', whole_number, .false., both, &
                'number of guesses for --branches (100), or --equilibrium (none)'), &
    option_type('equilibrium', no_argument, '', any_text, .false., dynamics, &
                'find where the mechanism rests near its initial position, or falls to'), &
    option_type('modes', no_argument, '', any_text, .false., dynamics, &
                'find frequencies, dampings and shapes of its small vibrations there'), &
    option_type('mode', needed_argument, 'K', whole_number, .false., dynamics, &
                'the mode of --modes that --animate shows'), &
    option_type('linear', needed_argument, 'FILE.h5', any_text, .false., dynamics, &
                'write the linearised equations of motion there as matrices'), &
    option_type('at', needed_argument, 'TIMES', any_text, .false., dynamics, &
                'times of --linear along the motion, not at rest: 0.1,0.3 or outputs'), &
    option_type('exponents', needed_argument, 'K', whole_number, .false., dynamics, &
                'find the K largest Lyapunov exponents of the motion'), &
    option_type('periodic', no_argument, '', any_text, .false., dynamics, &
                'find a periodic motion, stable or not, and record one period of it'), &
    option_type('branch', needed_argument, 'NAME', any_text, .false., both, &
                'find branches of positions of rest over the parameter NAME'), &
    option_type('range', no_argument, '', any_text, .false., kinematics, &
                'print how far each independent coordinate can go from the start'), &
    option_type('cam', needed_argument, '[N:]FILE', any_text, .true., kinematics, &
                'compute the profile of cam N: a table, or a drawing (.svg)'), &
    option_type('graph', needed_argument, 'FILE', any_text, .false., both, &
                'draw links, pairs and blocks as a graph: .dot, .svg, .png or .pdf'), &
    option_type('table', needed_argument, 'PATH', any_text, .false., both, &
                'write the table of results; - is standard output; .csv: with commas'), &
    option_type('hdf5', needed_argument, 'PATH', any_text, .false., both, &
                'write the results as an HDF5 file'), &
    option_type('plot', needed_argument, '[TARGET:]NAMES', any_text, .true., both, &
                'plot columns: q3,P.x or P.x:P.y or section:q1:q2; TARGET: file or term'), &
    option_type('names', no_argument, '', any_text, .false., both, &
                'call columns of tables by names of pairs and links: B.q'), &
    option_type('sketch', needed_argument, 'FILE.svg', any_text, .false., both, &
                'draw the mechanism at the start, or where it rests'), &
    option_type('animate', needed_argument, 'FILE', any_text, .true., both, &
                'draw the moving mechanism: a page (.html), .svg, .gif, or .mp4'), &
    option_type('view', needed_argument, 'VIEW', any_text, .false., both, &
                'view of both drawings: xy, xz, ... iso, or a direction as 1,-2,1'), &
    option_type('no-write', no_argument, '', any_text, .false., both, &
                'compute all results, but write none'), &
    option_type('report', needed_argument, 'FILE', any_text, .false., both, &
                'write exit code, errors, counts and times of the run as JSON'), &
    option_type('study', no_argument, '', any_text, .false., both, &
                'make the runs of the group &study; the table has a row for each'), &
    option_type('part', needed_argument, 'K/N', part_of_whole, .false., both, &
                'make part K of N parts of a study or search, for N jobs'), &
    option_type('threads', needed_argument, 'N', whole_number, .false., both, &
                'make a study or a search in N threads; without it one for each core'), &
    option_type('continue', needed_argument, 'FILE.h5', any_text, .false., both, &
                'make what the HDF5 file of a study or search does not have yet'), &
    option_type('merge', needed_argument, 'FILE FILE ...', any_text, .false., both, &
                'join HDF5 files of parts of a study or search to that of --hdf5', unlimited_arguments), &
    option_type('optimize', no_argument, '', any_text, .false., both, &
                'find the parameters with which the groups &objective are met best'), &
    option_type('dakota', needed_argument, 'PARAMS RESULTS', any_text, .false., both, &
                'make the run that a parameters file of Dakota asks for', 2), &
    option_type('set', needed_argument, 'GROUP.NAME=VALUE', assignment, .true., both, &
                'replace a value of the data file; may be repeated'), &
    option_type('dialogue', no_argument, '', any_text, .false., both, &
                'ask for the data in a conversation, as without any FILE'), &
    option_type('edit', needed_argument, 'FILE', any_text, .false., both, &
                'open a data file in the conversation'), &
    option_type('resume', needed_argument, 'FILE', any_text, .false., both, &
                'continue a conversation that was left or interrupted'), &
    option_type('import', needed_argument, 'FILE [LOOPS]', any_text, .false., both, &
                'make a data file of a robot (URDF, MJCF, SDF); LOOPS: closing joints', 2), &
    option_type('out', needed_argument, 'FILE.nml', any_text, .false., both, &
                'the data file that --import writes, or that of the best design'), &
    option_type('quiet', no_argument, '', any_text, .false., both, &
                'print only errors'), &
    option_type('verbose', no_argument, '', any_text, .false., both, &
                'print the structural vectors and the plan before the run, too'), &
    option_type('help', no_argument, '', any_text, .false., both, &
                'print this text'), &
    option_type('help-data', optional_argument, 'GROUP[.NAME]', any_text, .false., both, &
                'explain the data file, one group of it, or one name'), &
    option_type('version', no_argument, '', any_text, .false., both, &
                'print the version')]

contains

  !> Place of an option in the table; 0 where the program has none of that name.
  pure integer function find_option(name, program) result(place)
    character(len=*), intent(in) :: name          !< name of the option, without the dashes
    integer, intent(in) :: program                !< kinematics or dynamics

    do place = 1, size(options_table)
      if (options_table(place)%name == name .and. belongs_to(options_table(place)%program, program)) return
    end do
    place = 0
  end function find_option

  !> The names of all options of a program, without the dashes.
  pure function option_names(program) result(names)
    integer, intent(in) :: program                !< kinematics or dynamics
    character(len=len(options_table%name)), allocatable :: names(:)

    names = pack(options_table%name, belongs_to(options_table%program, program))
  end function option_names
end module mech9_options
