!> Notes about options without effect, which are no errors.
module mech9_unused_options
  use mech9_program_kind, only: program_names
  use mech9_command_line, only: command_line_type
  use mech9_data_file, only: data_file_type
  implicit none
  private
  public :: print_unused_options

  !> Options that have an effect only on a run, and those that need more of the mechanism than its structure.
  character(len=*), parameter :: of_runs(*) = [character(len=8) :: 'table', 'hdf5', 'plot', 'names', 'no-write']
  character(len=*), parameter :: of_mechanisms(*) = [character(len=8) :: 'check', 'plan', 'branches', 'range', 'cam', 'graph', &
                                                       'sketch']

contains

  !> Write a line for each reason why options are without effect.
  subroutine print_unused_options(unit, options, given)
    integer, intent(in) :: unit                     !< Fortran unit to write to
    type(command_line_type), intent(in) :: options  !< the command line
    class(data_file_type), intent(in) :: given      !< the data file, which may request pictures, too
    character(len=:), allocatable :: name, answer, names
    logical :: drawn

    name = program_names(options%program)
    answer = options%answer()
    ! options without effect are refused there
    if (options%rest() /= '' .or. options%has('exponents') .or. options%has('branch') .or. options%has('at')) then
      if (options%has('sketch') .or. options%has('animate')) call print_idle_arrows(unit, options, given)
      return
    end if
    if (answer /= '') then
      ! the table of a cam has names, too
      call list_given(options, pack(of_runs, of_runs /= 'names' .or. answer /= 'cam'), names)
      if (names /= '') write (unit, '(a)') name//': without effect: '//names//'; --'//answer//' makes no run'
    end if
    if (answer == 'structure') then
      call list_given(options, of_mechanisms, names)
      if (names /= '') write (unit, '(a)') name//': without effect: '//names//'; --structure reads the structure alone'
    end if
    if (options%has('starts') .and. (answer == 'structure' .or. .not. options%has('branches'))) &
      write (unit, '(a)') name//': without effect: --starts; it is the number of guesses of --branches'
    drawn = options%has('sketch')
    if (answer == '') drawn = drawn .or. options%has('animate') .or. pictures_of(given)
    if (options%has('sketch') .and. answer /= '' .and. answer /= 'structure') then
      call print_idle_arrows(unit, options, given)
    end if
    if (options%has('view') .and. (answer == 'structure' .or. .not. drawn)) &
      write (unit, '(a)') name//': without effect: --view; no picture of the mechanism is drawn'
  end subroutine print_unused_options

  !> Write a line if arrows are requested, but the answer that is drawn has none: it makes no run, or shows a mode.
  subroutine print_idle_arrows(unit, options, given)
    integer, intent(in) :: unit                     !< Fortran unit to write to
    type(command_line_type), intent(in) :: options  !< the command line, with an answer in place of a run
    class(data_file_type), intent(in) :: given      !< the data file, which may request pictures, too
    character(len=:), allocatable :: names, answer

    call list_arrows(given, names)
    if (names == '') return
    answer = options%answer()
    if (options%rest() /= '') answer = options%rest()
    names = program_names(options%program)//': without effect: '//names
    if (options%has('animate')) then
      write (unit, '(a)') names//'; the film of a mode has no arrows, since its amplitude may be any'
    else
      write (unit, '(a)') names//'; a run draws the arrows, and --'//answer//' makes none'
    end if
  end subroutine print_idle_arrows

  !> List the requested arrows of pictures: "force_arrows, velocity_arrows".
  pure subroutine list_arrows(given, list)
    class(data_file_type), intent(in) :: given          !< the data file, which may request pictures, too
    character(len=:), allocatable, intent(out) :: list  !< their names in the data file, with commas

    list = ''
    associate (output => given%model%request%output)
      if (output%force_arrows) list = list//', force_arrows'
      if (output%velocity_arrows) list = list//', velocity_arrows'
      if (output%acceleration_arrows) list = list//', acceleration_arrows'
    end associate
    list = list(min(3, len(list) + 1):)
  end subroutine list_arrows

  !> Whether the data file requests pictures of the mechanism.
  pure logical function pictures_of(given)
    class(data_file_type), intent(in) :: given   !< the data file, which may request pictures, too

    pictures_of = .false.
    if (allocated(given%model%request%output%sketch)) pictures_of = given%model%request%output%sketch /= ''
    if (allocated(given%model%request%output%animation)) pictures_of = pictures_of .or. given%model%request%output%animation /= ''
  end function pictures_of

  !> List the given ones of some options: "--table, --hdf5".
  pure subroutine list_given(options, names, list)
    type(command_line_type), intent(in) :: options      !< the command line
    character(len=*), intent(in) :: names(:)            !< names of options, without the dashes
    character(len=:), allocatable, intent(out) :: list  !< those that are given, with dashes and commas
    integer :: i

    list = ''
    do i = 1, size(names)
      if (.not. options%has(trim(names(i)))) cycle
      if (list /= '') list = list//', '
      list = list//'--'//trim(names(i))
    end do
  end subroutine list_given
end module mech9_unused_options
