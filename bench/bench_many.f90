!> Many motions of one mechanism under forces, advanced side by side in small steps: the time of a step of one motion.
!>
!> usage: bench_many FILE MOTIONS STEPS LENGTH      LENGTH is that of a step [s]; prints the time of a step [us]
program bench_many
  use, intrinsic :: iso_fortran_env, only: error_unit
  use mech9, only: wp, mechanism_type, motion_type, error_type, read_file
  use mech9_clock, only: seconds
  implicit none

  call measure()

contains

  !> Start the motions, advance all of them from time to time, and print the time.
  subroutine measure()
    type(mechanism_type) :: mechanism
    type(motion_type), allocatable :: motions(:)
    type(error_type), allocatable :: err
    character(len=1000) :: words(4)
    real(wp) :: length, began
    integer :: count, steps, i, k

    do i = 1, 4
      call get_command_argument(i, words(i))
    end do
    read (words(2), *) count
    read (words(3), *) steps
    read (words(4), *) length
    call read_file(trim(words(1)), mechanism, err)
    allocate (motions(count))
    do i = 1, count
      if (.not. allocated(err)) call motions(i)%start_dynamics(mechanism, err)
    end do
    began = seconds()
    do k = 1, steps
      do i = 1, count
        if (.not. allocated(err)) call motions(i)%advance(k*length, err)
      end do
    end do
    if (allocated(err)) then
      write (error_unit, '(a)') err%message
      error stop 1
    end if
    print '(f0.4)', 1.0e6_wp*(seconds() - began)/(real(count, wp)*steps)
  end subroutine measure
end program bench_many
