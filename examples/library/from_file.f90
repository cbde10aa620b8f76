!> A driven motion from a data file: time, coordinates and a point of the coupler.
program from_file
  use, intrinsic :: iso_fortran_env, only: error_unit
  use mech9, only: wp, mechanism_type, motion_type, error_type, read_file
  implicit none
  type(mechanism_type) :: mechanism
  type(motion_type) :: motion
  type(error_type), allocatable :: err
  real(wp) :: p(3), v(3)
  integer :: i, k

  call read_file('four_bar.nml', mechanism, err)
  if (.not. allocated(err)) call motion%start_kinematics(mechanism, err)
  do i = 0, 12
    if (.not. allocated(err)) call motion%advance(0.1_wp*i, err)
    if (.not. allocated(err)) call motion%point('P', err, p, v)
    if (allocated(err)) exit
    print '(99es24.15)', motion%t(), (motion%q(k), k=1, motion%coordinates()), p(:2), v(:2)
  end do
  call motion%close()
  if (.not. allocated(err)) stop
  write (error_unit, '(a)') err%message
  stop 1
end program from_file
