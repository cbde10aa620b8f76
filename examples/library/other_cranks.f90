!> The four-bar with other cranks: a number is set by its name, and the rows of each run come as an array.
program other_cranks
  use, intrinsic :: iso_fortran_env, only: error_unit
  use mech9, only: wp, mechanism_type, run_type, error_type, read_file
  implicit none
  type(mechanism_type) :: mechanism
  type(run_type) :: run
  type(error_type), allocatable :: err
  character(len=:), allocatable :: names(:)
  real(wp), allocatable :: rows(:, :)
  integer :: i, count

  call read_file('four_bar.nml', mechanism, err)
  do i = 0, 2
    if (.not. allocated(err)) call mechanism%set('pair(2).point(1)', 0.3_wp - 0.05_wp*i, err)
    if (.not. allocated(err)) call run%begin_kinematics(mechanism, err)
    if (allocated(err)) exit
    call run%columns(names)
    if (.not. allocated(rows)) allocate (rows(size(names), run%outputs()))
    call run%take_rows(rows, count, err)
    if (.not. allocated(err)) print '(a, f5.2, a, f8.4)', 'crank', 0.3_wp - 0.05_wp*i, ' m: P.y is at most', &
      maxval(rows(findloc(names == 'P.y', .true., dim=1), :count))
  end do
  call run%close()
  if (.not. allocated(err)) stop
  write (error_unit, '(a)') err%message
  stop 1
end program other_cranks
