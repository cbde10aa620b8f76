!> A free motion from values set in code: the same four-bar swings under gravity. Time, coordinates, rates and energies.
program from_values
  use, intrinsic :: iso_fortran_env, only: error_unit
  use mech9, only: wp, design_type, mechanism_type, motion_type, error_type
  implicit none
  real(wp), parameter :: z(3) = [0.0_wp, 0.0_wp, 1.0_wp], o(3) = 0.0_wp
  type(design_type) :: design
  type(mechanism_type) :: mechanism
  type(motion_type) :: motion
  type(error_type), allocatable :: err
  real(wp) :: kinetic, potential
  integer :: i, k

  call design%independent([1])
  call design%pair(1, 'revolute', [1, 2], axis=z)
  call design%pair(2, 'revolute', [2, 3], axis=z, point=[0.3_wp, 0.0_wp, 0.0_wp], moving_point=o)
  call design%pair(3, 'revolute', [3, 4], axis=z, point=[0.8_wp, 0.0_wp, 0.0_wp], moving_point=o)
  call design%pair(4, 'revolute', [1, 4], axis=z, point=[0.9_wp, 0.0_wp, 0.0_wp], moving_point=[0.7_wp, 0.0_wp, 0.0_wp])
  call design%initial(1, 0.6_wp, velocity=5.0_wp)
  call design%initial(2, 0.5_wp)
  call design%initial(3, -2.0_wp)
  call design%body(3, 2.0_wp, centre=[0.4_wp, 0.0_wp, 0.0_wp], inertia=[0.0_wp, 0.1_wp, 0.1_wp, 0.0_wp, 0.0_wp, 0.0_wp])
  call design%gravity([0.0_wp, -9.81_wp, 0.0_wp])
  call design%finish(mechanism, err)
  if (.not. allocated(err)) call motion%start_dynamics(mechanism, err)
  do i = 0, 10
    if (.not. allocated(err)) call motion%advance(0.1_wp*i, err)
    if (allocated(err)) exit
    call motion%energies(kinetic, potential)
    print '(99es24.15)', motion%t(), (motion%q(k), motion%dq(k), k=1, motion%coordinates()), kinetic, potential
  end do
  call motion%close()
  if (allocated(err)) write (error_unit, '(a)') err%message
  if (allocated(err)) stop 1
end program from_values
