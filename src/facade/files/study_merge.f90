!> The files of parts of a study, joined to one file of the whole study.
module mech9_study_merge
  use, intrinsic :: ieee_arithmetic, only: ieee_value, ieee_quiet_nan
  use mech9_kinds, only: wp, long
  use mech9_text, only: string_type, to_text
  use mech9_error, only: error_type, raise, exit_done, exit_file
  use mech9_version, only: name_and_version
  use mech9_kept_files, only: kept_files_type
  use mech9_hdf5_record, only: copy_provenance
  use mech9_table, only: table_type
  use mech9_heading, only: new_heading
  use mech9_study_definition, only: tell_difference
  use mech9_study_file, only: study_file_type, not_made
  use mech9_study_layout, only: study_layout_type
  use mech9_study_sums, only: study_sums_type
  implicit none
  private
  public :: merge_studies, merged_study_type

  !> Runs that are joined at a time.
  integer, parameter :: runs_together = 1024

  !> Runs that more than one file has.
  type :: overlap_type
    integer :: runs = 0      !< how many there are
    integer :: first = 0     !< number of the first of them
    integer :: files(2) = 0  !< numbers of two files that have it
  end type overlap_type

  !> The runs of a study that stand in files of its parts.
  type :: merged_study_type
    integer :: runs = 0             !< of the whole study
    type(study_sums_type) :: sums   !< counts of the runs that are made
    type(overlap_type) :: overlap   !< runs that more than one file has
  end type merged_study_type

contains

  !> Join the runs of several files to one file and a table. Fail with exit_file where they are not of one study.
  subroutine merge_studies(program, paths, wanted, merged, err)
    integer, intent(in) :: program                        !< kinematics or dynamics
    type(string_type), intent(in) :: paths(:)             !< of the files
    type(kept_files_type), intent(in) :: wanted           !< the HDF5 file and the table of the whole study
    type(merged_study_type), intent(out) :: merged        !< the runs that the files have
    type(error_type), allocatable, intent(out) :: err     !< allocated if it failed
    type(study_file_type), allocatable :: files(:)
    type(error_type), allocatable :: at_close
    integer :: i

    allocate (files(size(paths)))
    call open_files(paths, files, err)
    if (.not. allocated(err)) call join(program, paths, files, wanted, merged, err)
    do i = 1, size(files)
      call files(i)%close(at_close)
    end do
  end subroutine merge_studies

  !> Open all files. Fail with exit_file where one is not of the study of the first one.
  subroutine open_files(paths, files, err)
    type(string_type), intent(in) :: paths(:)               !< of the files
    type(study_file_type), intent(inout) :: files(:)        !< the files
    type(error_type), allocatable, intent(out) :: err       !< allocated if it failed
    character(len=:), allocatable :: difference
    integer :: i

    do i = 1, size(files)
      call files(i)%open(paths(i)%text, .false., '', err)
      if (allocated(err)) return
      call tell_difference(files(1)%layout%definition, files(i)%layout%definition, difference, &
                           'in the first one', 'in the second one')
      if (difference == '' .and. files(i)%columns%numbers_of_run() /= files(1)%columns%numbers_of_run()) &
        difference = 'their columns are not the same'
      if (difference == '') cycle
      call raise(err, exit_file, "'"//paths(1)%text//"' and '"//paths(i)%text//"' are of different studies: "//difference// &
                 '; merge files that one data file made with the same changes by --set')
      return
    end do
  end subroutine open_files

  !> Join the runs of all files in the order of their numbers.
  subroutine join(program, paths, files, wanted, merged, err)
    integer, intent(in) :: program                          !< kinematics or dynamics
    type(string_type), intent(in) :: paths(:)               !< of the files
    type(study_file_type), intent(inout) :: files(:)        !< the files
    type(kept_files_type), intent(in) :: wanted             !< the files of the whole study
    type(merged_study_type), intent(inout) :: merged        !< gets the runs that the files have
    type(error_type), allocatable, intent(out) :: err       !< allocated if it failed
    type(study_file_type) :: whole
    type(table_type) :: table
    type(error_type), allocatable :: at_close
    real(wp), allocatable :: rows(:, :)
    integer :: source(runs_together), first, n, i

    call open_results(program, files(1), wanted, whole, table, err)
    if (allocated(err)) return
    merged%runs = files(1)%layout%runs
    allocate (rows(size(files(1)%layout%parameters) + size(files(1)%layout%quantities) + 1, runs_together))
    call merged%sums%begin(0)
    first = 1
    do while (first <= merged%runs .and. .not. allocated(err))
      n = min(runs_together, merged%runs - first + 1)
      call gather(paths, files, first, rows(:, :n), source(:n), merged%overlap, err)
      do i = 1, n
        if (allocated(err)) exit
        if (nint(rows(size(rows, 1), i)) == not_made) cycle
        call count_run(first + i - 1, nint(rows(size(rows, 1), i)), merged%sums)
        if (whole%is_open()) call write_whole(files(source(i)), whole, first + i - 1, rows(:, i), err)
        if (wanted%table /= '' .and. .not. allocated(err)) &
          call table%write_row([real(first + i - 1, wp), rows(:, i)], err)
      end do
      first = first + n
    end do
    if (.not. allocated(err) .and. whole%is_open()) call whole%publish(err)
    call whole%close(at_close)
    if (.not. allocated(err)) call move_alloc(at_close, err)
    call table%close(at_close)
    if (.not. allocated(err)) call move_alloc(at_close, err)
  end subroutine join

  !> Write a run to the HDF5 file of the whole study, with its columns where the parts have them.
  subroutine write_whole(part, whole, run, row, err)
    type(study_file_type), intent(inout) :: part            !< the file of a part that has the run
    type(study_file_type), intent(inout) :: whole           !< the file of the whole study
    integer, intent(in) :: run                              !< number of the run
    real(wp), intent(in) :: row(:)                          !< parameters, quantities and exit code
    type(error_type), allocatable, intent(out) :: err       !< allocated if it failed
    real(wp), allocatable :: numbers(:, :)

    if (whole%columns%are_there()) then
      call read_columns(part, run, numbers, err)
      if (allocated(err)) return
      call whole%columns%write_run(whole%file, run, numbers)
    end if
    call whole%write_row(run, row, err)
  end subroutine write_whole

  !> Read the columns of a run in the file of a part.
  subroutine read_columns(part, run, numbers, err)
    type(study_file_type), intent(inout) :: part              !< the file
    integer, intent(in) :: run                                !< number of the run in the whole study
    real(wp), allocatable, intent(out) :: numbers(:, :)       !< (numbers of a run,1)
    type(error_type), allocatable, intent(out) :: err         !< allocated if it failed

    allocate (numbers(part%columns%numbers_of_run(), 1), source=0.0_wp)
    call part%columns%read_run(part%file, 1 + (run - part%layout%part(1))/part%layout%part(2), numbers)
    call part%tell(err)
  end subroutine read_columns

  !> Create the files of the whole study. The HDF5 file gets its name when it is whole.
  subroutine open_results(program, part, wanted, whole, table, err)
    integer, intent(in) :: program                        !< kinematics or dynamics
    type(study_file_type), intent(inout) :: part          !< the first file of a part
    type(kept_files_type), intent(in) :: wanted           !< the files of the whole study
    type(study_file_type), intent(inout) :: whole         !< the HDF5 file, if one is wanted
    type(table_type), intent(inout) :: table              !< the table, if one is wanted
    type(error_type), allocatable, intent(out) :: err     !< allocated if it failed
    type(study_layout_type) :: layout
    type(error_type), allocatable :: at_close

    layout = part%layout
    layout%part = 1
    if (wanted%hdf5 /= '') then
      call whole%create(wanted%hdf5, layout, err)
      if (allocated(err)) return
      call copy_provenance(part%file, whole%file)
      if (size(layout%columns) > 0) call whole%copy_columns(part, err)
    end if
    if (wanted%table /= '' .and. .not. allocated(err)) call open_table(program, wanted%table, layout, table, err)
    if (allocated(err)) call whole%close(at_close)
  end subroutine open_results

  !> Open the table of the whole study.
  subroutine open_table(program, path, layout, table, err)
    integer, intent(in) :: program                        !< kinematics or dynamics
    character(len=*), intent(in) :: path                  !< of the table
    type(study_layout_type), intent(in) :: layout         !< names and units
    type(table_type), intent(inout) :: table              !< the table
    type(error_type), allocatable, intent(out) :: err     !< allocated if it failed
    type(string_type), allocatable :: names(:), units(:)
    integer :: i, n, m

    n = size(layout%parameters)
    m = size(layout%quantities)
    allocate (names(n + m + 2), units(n + m + 2))
    names(1)%text = 'run'
    do i = 1, n
      names(1 + i)%text = layout%parameters(i)%text
    end do
    do i = 1, m
      names(1 + n + i)%text = layout%quantities(i)%text
    end do
    names(n + m + 2)%text = 'exit_code'
    do i = 1, n + m + 2
      units(i)%text = ''
      if (i > 1 .and. i < n + 2) units(i)%text = layout%parameter_units(i - 1)%text
      if (i > n + 1 .and. i < n + m + 2) units(i)%text = layout%units(i - n - 1)%text
    end do
    call table%open(path, new_heading(layout%title, names, units), name_and_version(program), err)
  end subroutine open_table

  !> Gather runs that follow each other from the files; not made where none has them. Fail with exit_file where two
  !> files have different numbers for one run.
  subroutine gather(paths, files, first, rows, source, overlap, err)
    type(string_type), intent(in) :: paths(:)               !< of the files
    type(study_file_type), intent(inout) :: files(:)        !< the files
    integer, intent(in) :: first                            !< number of the first run
    real(wp), intent(out) :: rows(:, :)                     !< (parameters, quantities, exit code; runs)
    integer, intent(out) :: source(:)                       !< (runs) number of a file that has each; 0: none has
    type(overlap_type), intent(inout) :: overlap            !< runs that more than one file has
    type(error_type), allocatable, intent(out) :: err       !< allocated if it failed
    real(wp) :: row(size(rows, 1))
    integer(long) :: run
    integer :: i, j, place

    rows = ieee_value(1.0_wp, ieee_quiet_nan)
    rows(size(rows, 1), :) = not_made
    source = 0
    do i = 1, size(files)
      associate (part => files(i)%layout%part)
        ! the first run of the part that is not before these ones
        run = part(1)
        if (first > part(1)) run = part(1) + (1_long + (first - part(1) - 1)/part(2))*part(2)
        do while (run - first < size(rows, 2))
          place = 1 + int((run - part(1))/part(2))
          call files(i)%read_row(place, row, err)
          if (allocated(err)) return
          j = int(run - first) + 1
          if (nint(row(size(row))) /= not_made) call take_row(paths, files, i, int(run), row, rows(:, j), source(j), overlap, err)
          if (allocated(err)) return
          run = run + part(2)
        end do
      end associate
    end do
  end subroutine gather

  !> Take the row of a run, or compare it with that of another file.
  subroutine take_row(paths, files, file, run, row, taken, source, overlap, err)
    type(string_type), intent(in) :: paths(:)               !< of the files
    type(study_file_type), intent(inout) :: files(:)        !< the files
    integer, intent(in) :: file                             !< number of the file that has the row
    integer, intent(in) :: run                              !< number of the run
    real(wp), intent(in) :: row(:)                          !< the row
    real(wp), intent(inout) :: taken(:)                     !< gets the row, unless another file had it
    integer, intent(inout) :: source                        !< number of the file from which it is taken; 0: none yet
    type(overlap_type), intent(inout) :: overlap            !< runs that more than one file has
    type(error_type), allocatable, intent(out) :: err       !< allocated if it failed
    real(wp), allocatable :: one(:, :), other(:, :)
    logical :: same

    if (source == 0) then
      taken = row
      source = file
      return
    end if
    overlap%runs = overlap%runs + 1
    if (overlap%runs == 1) overlap%first = run
    if (overlap%runs == 1) overlap%files = [source, file]
    call read_columns(files(source), run, one, err)
    if (.not. allocated(err)) call read_columns(files(file), run, other, err)
    if (allocated(err)) return
    same = all(transfer(row, [0_long]) == transfer(taken, [0_long]))
    if (same) same = all(transfer(one, [0_long]) == transfer(other, [0_long]))
    if (same) return
    call raise(err, exit_file, "'"//paths(source)%text//"' and '"//paths(file)%text//"' have different numbers for run "// &
               to_text(run)//'; make it anew by the same version of the program')
  end subroutine take_row

  !> Count a run.
  subroutine count_run(run, code, sums)
    integer, intent(in) :: run                       !< its number
    integer, intent(in) :: code                      !< its exit code
    type(study_sums_type), intent(inout) :: sums     !< counts it
    real(wp) :: none(0)

    if (code == exit_done) then
      call sums%add(none)
    else
      call sums%add_failure(run, code)
    end if
  end subroutine count_run
end module mech9_study_merge
