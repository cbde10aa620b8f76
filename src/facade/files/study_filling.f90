!> The places for the runs of a study in its HDF5 file, filled before the first run.
module mech9_study_filling
  use, intrinsic :: ieee_arithmetic, only: ieee_value, ieee_quiet_nan
  use mech9_kinds, only: wp
  use mech9_error, only: raise, exit_interrupted
  use mech9_system, only: interrupted
  use mech9_hdf5_file, only: hdf5_file_type
  use mech9_hdf5_series, only: hdf5_series_type
  implicit none
  private
  public :: fill_rows

  !> Numbers that are written together.
  integer, parameter :: together = 131072

contains

  !> Fill all rows of data sets over runs with NaN. It is a failure of the file where the user interrupts the program.
  subroutine fill_rows(series, file, n_columns, runs, last, at_end)
    type(hdf5_series_type), intent(inout) :: series   !< the data sets, made and without numbers
    type(hdf5_file_type), intent(inout) :: file       !< the open file
    integer, intent(in) :: n_columns                  !< of a row
    integer, intent(in) :: runs                       !< how many rows there are
    integer, intent(in), optional :: last             !< number of the last column in place of NaN
    logical, intent(in), optional :: at_end           !< all runs are over: the user who interrupts means them
    logical :: may_stop
    real(wp), allocatable :: block(:, :)
    integer :: done, n

    n = max(1, min(runs, together/n_columns))
    allocate (block(n_columns, n), source=ieee_value(1.0_wp, ieee_quiet_nan))
    if (present(last)) block(n_columns, :) = last
    may_stop = .true.
    if (present(at_end)) may_stop = .not. at_end
    done = 0
    do while (done < runs .and. .not. allocated(file%failure))
      n = min(size(block, 2), runs - done)
      call series%append_rows(file, block(:, :n))
      done = done + n
      if (allocated(file%failure)) return
      if (.not. may_stop) cycle
      if (interrupted()) call raise(file%failure, exit_interrupted, 'interrupted before the first run')
    end do
    call series%hand_over(file)
  end subroutine fill_rows
end module mech9_study_filling
