!> The HDF5 file of a study. It has a place for every run of the part from the beginning. The place is NaN, with the
!> exit code -1, until the run is made. A program that is killed at any moment thus leaves a file whose runs are either
!> whole or not made. Columns of a run, where the file has them, are written before its exit code.
module mech9_study_file
  use mech9_kinds, only: wp
  use mech9_error, only: error_type, raise, exit_interrupted
  use mech9_system, only: interrupted
  use mech9_clock, only: pacer_type
  use mech9_data_file, only: data_file_type
  use mech9_hdf5_file, only: hdf5_file_type
  use mech9_column_sets, only: new_column_set
  use mech9_hdf5_series, only: hdf5_series_type
  use mech9_hdf5_reading, only: open_existing
  use mech9_run_maker, only: made_run_type
  use mech9_study_definition, only: digest_of, tell_difference
  use mech9_study_layout, only: study_layout_type, write_layout, read_layout
  use mech9_study_filling, only: fill_rows
  use mech9_study_columns, only: study_columns_type
  implicit none
  private
  public :: study_file_type, not_made

  !> The exit code of a run that is not made yet.
  integer, parameter :: not_made = -1
  !> Longest time after which readers of the file see new runs [s].
  real(wp), parameter :: longest_wait = 0.5_wp
  !> Runs that are read together.
  integer, parameter :: most_together = 1024

  type :: study_file_type
    type(hdf5_file_type) :: file
    type(study_layout_type) :: layout                      !< names and units of what it holds
    type(hdf5_series_type), private :: outcomes            !< parameters, quantities and exit code over the runs
    type(study_columns_type) :: columns                    !< of all runs over time, where the file has them
    type(pacer_type), private :: pacer
    real(wp), allocatable, private :: row(:)               !< parameters, quantities and exit code of a run
    real(wp), allocatable, private :: block(:, :)          !< (as `row`, runs) runs that were read
    integer, private :: block_first = 0                    !< place of the first one of these; 0: none were read
    logical, private :: reported = .false.                 !< whether the failure of the file was reported
  contains
    procedure :: create
    procedure :: create_columns
    procedure :: copy_columns
    procedure :: publish
    procedure :: open
    procedure :: open_columns
    procedure :: is_open
    procedure :: code_of
    procedure :: read_run
    procedure :: read_row
    procedure :: write_run
    procedure :: write_outcome
    procedure :: write_row
    procedure :: close => close_file
    procedure, private :: begin_outcomes
    procedure :: tell
  end type study_file_type

contains

  !> Create the file with all its places. It gets its name with `publish`; a file of that name stays until then.
  subroutine create(self, path, layout, err)
    class(study_file_type), intent(out) :: self               !< the file
    character(len=*), intent(in) :: path                      !< of the file
    type(study_layout_type), intent(in) :: layout             !< names and units
    type(error_type), allocatable, intent(out) :: err         !< allocated if it failed
    type(hdf5_series_type) :: numbers

    self%layout = layout
    call self%file%create(path, err)
    if (allocated(err)) return
    call numbers%start_fixed(1, 1, layout%runs_of_part(), .false.)
    call numbers%add(new_column_set('run', [1], [integer ::], 'number of the run in the whole study', '1', [character(len=4) ::], &
                                    whole=.true.))
    call self%begin_outcomes(.false.)
    call numbers%create(self%file)
    call self%outcomes%create(self%file)
    call self%outcomes%attach(self%file)
    call write_numbers(self, numbers)
    call fill_rows(self%outcomes, self%file, size(self%row), layout%runs_of_part(), not_made)
    call write_layout(self%file, layout)
    call self%file%put('study/digest', digest_of(layout%definition), 'cyclic redundancy check of the definition')
    call self%pacer%start(longest_wait)
    call self%tell(err)
    if (allocated(err)) call self%file%close()
  end subroutine create

  !> Give a file that was created, and has no name yet, the columns of the runs of a model.
  subroutine create_columns(self, given, err)
    class(study_file_type), intent(inout) :: self             !< the file
    type(data_file_type), intent(in) :: given                 !< the data file
    type(error_type), allocatable, intent(out) :: err         !< allocated if it failed

    call self%columns%create(self%file, given, self%layout%runs_of_part())
    call self%tell(err)
  end subroutine create_columns

  !> Give a file that was created, and has no name yet, the columns that a part has.
  subroutine copy_columns(self, part, err)
    class(study_file_type), intent(inout) :: self             !< the file
    type(study_file_type), intent(inout) :: part              !< the open file of the part
    type(error_type), allocatable, intent(out) :: err         !< allocated if it failed

    call self%columns%create_like(self%file, part%layout%columns, part%file, self%layout%runs_of_part())
    call self%tell(err)
  end subroutine copy_columns

  !> Open the columns of a file that is continued. Fail with exit_file where they are not those of the runs of the
  !> model.
  subroutine open_columns(self, given, err)
    class(study_file_type), intent(inout) :: self             !< the file
    type(data_file_type), intent(in) :: given                 !< the data file
    type(error_type), allocatable, intent(out) :: err         !< allocated if it failed

    call self%columns%open(self%file, given, self%layout%runs_of_part())
    call self%tell(err)
  end subroutine open_columns

  !> Give a file that was created its name.
  subroutine publish(self, err)
    class(study_file_type), intent(inout) :: self             !< the file
    type(error_type), allocatable, intent(out) :: err         !< allocated if it failed

    call self%file%flush()
    call self%tell(err)
  end subroutine publish

  !> Add parameters, quantities and the exit code, which is written last.
  subroutine begin_outcomes(self, only_read)
    class(study_file_type), intent(inout) :: self   !< the file, with its layout
    logical, intent(in) :: only_read                !< nothing is going to be written
    integer :: i, n, columns

    associate (layout => self%layout)
      n = size(layout%parameters)
      columns = n + size(layout%quantities) + 1
      call self%outcomes%start_fixed(columns, columns, layout%runs_of_part(), only_read)
      do i = 1, n
        call self%outcomes%add(new_column_set('parameters/'//layout%parameters(i)%text, [i], [integer ::], &
                                              'parameter '//layout%parameters(i)%text, layout%parameter_units(i)%text, ['/run']))
      end do
      do i = 1, size(layout%quantities)
        call self%outcomes%add(new_column_set('quantities/'//layout%quantities(i)%text, [n + i], [integer ::], &
                                              layout%meanings(i)%text, layout%units(i)%text, ['/run']))
      end do
    end associate
    call self%outcomes%add(new_column_set('exit_code', [columns], [integer ::], &
                                          'exit code of a single run with these values; -1: not made yet', '1', ['/run'], &
                                          whole=.true.))
    allocate (self%row(columns), source=0.0_wp)
    allocate (self%block(columns, max(1, min(most_together, self%layout%runs_of_part()))), source=0.0_wp)
  end subroutine begin_outcomes

  !> Write the numbers of the runs.
  subroutine write_numbers(self, numbers)
    class(study_file_type), intent(inout) :: self          !< the file
    type(hdf5_series_type), intent(inout) :: numbers       !< the data set of the numbers; closed on return
    integer, parameter :: often = 1000   ! runs between two looks for an interruption
    integer :: i

    do i = 1, self%layout%runs_of_part()
      if (allocated(self%file%failure)) exit
      call numbers%write_row_at(self%file, i, [real(self%layout%part(1) + (i - 1)*self%layout%part(2), wp)])
      if (modulo(i, often) > 0 .or. allocated(self%file%failure)) cycle
      if (interrupted()) call raise(self%file%failure, exit_interrupted, 'interrupted before the first run')
    end do
    call numbers%close(self%file)
  end subroutine write_numbers

  !> Open an existing file, to make what is missing in it or to read it. Fail with exit_file where it is not the file of
  !> a study, or that of another study than the one that is defined.
  subroutine open(self, path, writable, definition, err)
    class(study_file_type), intent(out) :: self               !< the file
    character(len=*), intent(in) :: path                      !< of the file
    logical, intent(in) :: writable                           !< runs are going to be written
    character(len=*), intent(in) :: definition                !< text that determines the numbers of the study; empty: any study
    type(error_type), allocatable, intent(out) :: err         !< allocated if it failed
    character(len=:), allocatable :: difference

    call open_existing(path, writable, self%file, err)
    if (allocated(err)) return
    call read_layout(self%file, self%layout)
    if (.not. allocated(self%file%failure)) then
      difference = ''
      if (definition /= '') call tell_difference(self%layout%definition, definition, difference, 'there', 'here')
      if (difference /= '') call self%file%fail('it is of another study: '//difference//'; continue it with the data '// &
                                                  'file, the files that this names and the changes by --set that made it, '// &
                                                  'or make a new one by --hdf5')
    end if
    if (.not. allocated(self%file%failure)) then
      call self%begin_outcomes(.not. writable)
      call self%outcomes%open(self%file)
      if (.not. writable) call self%columns%open_unknown(self%file, self%layout%columns, self%layout%runs_of_part())
    end if
    call self%pacer%start(longest_wait)
    call self%tell(err)
    if (.not. allocated(err)) return
    call self%columns%close(self%file)
    call self%outcomes%close(self%file)
    call self%file%close()
  end subroutine open

  !> Whether there is a file.
  pure logical function is_open(self)
    class(study_file_type), intent(in) :: self   !< the file

    is_open = self%file%is_open()
  end function is_open

  !> The exit code of the run at a place; not_made where there is none. It is a failure of the file where it cannot be read.
  integer function code_of(self, place) result(code)
    class(study_file_type), intent(inout) :: self   !< the file
    integer, intent(in) :: place                    !< of the run in the part, from 1

    call go_to(self, place)
    code = not_made
    if (.not. allocated(self%file%failure)) code = nint(self%block(size(self%block, 1), place - self%block_first + 1))
  end function code_of

  !> Read a run that was made before; its message is not known.
  subroutine read_run(self, place, run)
    class(study_file_type), intent(inout) :: self     !< the file
    integer, intent(in) :: place                      !< of the run in the part, from 1
    type(made_run_type), intent(inout) :: run         !< gets its numbers; its arrays are allocated
    integer :: n

    call go_to(self, place)
    if (allocated(self%file%failure)) return
    n = size(run%values)
    associate (row => self%block(:, place - self%block_first + 1))
      run%number = self%layout%part(1) + (place - 1)*self%layout%part(2)
      run%values = row(:n)
      run%quantities = row(n + 1:size(row) - 1)
      run%exit_code = nint(row(size(row)))
    end associate
  end subroutine read_run

  !> Read the row of a run.
  subroutine read_row(self, place, row, err)
    class(study_file_type), intent(inout) :: self       !< the file
    integer, intent(in) :: place                        !< of the run in the part, from 1
    real(wp), intent(inout) :: row(:)                   !< parameters, quantities and exit code
    type(error_type), allocatable, intent(out) :: err   !< allocated if it cannot be read

    call go_to(self, place)
    call self%tell(err)
    if (.not. allocated(err)) row = self%block(:, place - self%block_first + 1)
  end subroutine read_row

  !> Read the block of runs that has a place.
  subroutine go_to(self, place)
    class(study_file_type), intent(inout) :: self     !< the file
    integer, intent(in) :: place                      !< of the run in the part, from 1
    integer :: first, n

    n = size(self%block, 2)
    first = 1 + (place - 1)/n*n
    if (first == self%block_first) return
    self%block_first = first
    call self%outcomes%read_rows(self%file, first, self%block(:, :min(n, self%layout%runs_of_part() - first + 1)))
  end subroutine go_to

  !> Write a run that is made, with its columns where the file has them.
  subroutine write_run(self, place, run, err)
    class(study_file_type), intent(inout) :: self       !< the file
    integer, intent(in) :: place                        !< of the run in the part, from 1
    type(made_run_type), intent(in) :: run              !< the run
    type(error_type), allocatable, intent(out) :: err   !< allocated if it cannot be written

    if (self%columns%are_there()) call self%columns%write_run(self%file, place, run%rows)
    call self%write_outcome(place, run, err)
  end subroutine write_run

  !> Write the numbers of a run at its place, without its columns over time.
  subroutine write_outcome(self, place, run, err)
    class(study_file_type), intent(inout) :: self       !< the file
    integer, intent(in) :: place                        !< of the run in the part, from 1
    type(made_run_type), intent(in) :: run              !< the run
    type(error_type), allocatable, intent(out) :: err   !< allocated if it cannot be written
    integer :: n

    n = size(run%values)
    self%row(:n) = run%values
    self%row(n + 1:n + size(run%quantities)) = run%quantities
    self%row(size(self%row)) = run%exit_code
    call self%write_row(place, self%row, err)
  end subroutine write_outcome

  !> Write the row of a run. Runs come mostly in order; the file has them after half a second at most.
  subroutine write_row(self, place, row, err)
    class(study_file_type), intent(inout) :: self       !< the file
    integer, intent(in) :: place                        !< of the run in the part, from 1
    real(wp), intent(in) :: row(:)                      !< parameters, quantities and exit code
    type(error_type), allocatable, intent(out) :: err   !< allocated if it cannot be written

    call self%outcomes%write_row_at(self%file, place, row)
    if (self%pacer%due()) call self%outcomes%hand_over(self%file)
    call self%tell(err)
  end subroutine write_row

  !> Write all runs and close the file. Do nothing to a file that is not open.
  subroutine close_file(self, err)
    class(study_file_type), intent(inout) :: self       !< the file
    type(error_type), allocatable, intent(out) :: err   !< allocated if it cannot be written

    if (.not. self%is_open()) return
    call self%columns%close(self%file)
    call self%outcomes%close(self%file)
    call self%file%close()
    call self%tell(err)
  end subroutine close_file

  !> Return the first failure of the file, only once.
  subroutine tell(self, err)
    class(study_file_type), intent(inout) :: self       !< the file
    type(error_type), allocatable, intent(out) :: err   !< the failure

    if (self%reported .or. .not. allocated(self%file%failure)) return
    self%reported = .true.
    err = self%file%failure
  end subroutine tell
end module mech9_study_file
