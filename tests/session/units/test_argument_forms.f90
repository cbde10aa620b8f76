!> Forms of the arguments of options, each with texts that have it and texts that nearly do.
module test_argument_forms
  use mech9_argument_forms, only: is_whole_number, is_assignment, is_part
  use mech9_cam_files, only: cam_file_type, read_cam_file
  use mech9_testing, only: tester_type
  implicit none
  private
  public :: run

contains

  !> Run the cases of this suite.
  subroutine run(tester)
    type(tester_type), intent(inout) :: tester   !< selects cases and counts their checks

    if (tester%runs('whole_numbers')) call whole_numbers(tester)
    if (tester%runs('parts')) call parts(tester)
    if (tester%runs('assignments')) call assignments(tester)
    if (tester%runs('cam_files')) call cam_files(tester)
  end subroutine run

  subroutine whole_numbers(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    character(len=12), parameter :: good(4) = [character(len=12) :: '1', '007', '2147483647', '12']
    character(len=12), parameter :: bad(9) = [character(len=12) :: '', '0', '-1', '+1', '1.0', '1e3', '2147483648', '1 2', 'x']
    integer :: i

    do i = 1, size(good)
      call tester%is_true(is_whole_number(trim(good(i))), 'a number: '//good(i))
    end do
    do i = 1, size(bad)
      call tester%is_true(.not. is_whole_number(trim(bad(i))), 'no number from 1 on: '//bad(i))
    end do
  end subroutine whole_numbers

  subroutine parts(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    character(len=8), parameter :: good(3) = [character(len=8) :: '1/1', '2/10', '10/10']
    character(len=8), parameter :: bad(9) = [character(len=8) :: '', '/', '1/', '/2', '3/2', '0/2', '1/0', '1/2/3', '1']
    integer :: i

    do i = 1, size(good)
      call tester%is_true(is_part(trim(good(i))), 'a part: '//good(i))
    end do
    do i = 1, size(bad)
      call tester%is_true(.not. is_part(trim(bad(i))), 'no part: '//bad(i))
    end do
  end subroutine parts

  subroutine assignments(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    character(len=16), parameter :: good(3) = [character(len=16) :: 'time.end=2', 'pair(2).dh(1)=', 'a.b=c=d']
    character(len=16), parameter :: bad(7) = [character(len=16) :: '', '=', '.=', 'time.=2', '.end=2', 'time.end', 'time=2.5']
    integer :: i

    do i = 1, size(good)
      call tester%is_true(is_assignment(trim(good(i))), 'an assignment: '//good(i))
    end do
    do i = 1, size(bad)
      call tester%is_true(.not. is_assignment(trim(bad(i))), 'no assignment: '//bad(i))
    end do
  end subroutine assignments

  !> Digits before a colon are the number of a cam; all else is the name of the file.
  subroutine cam_files(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks

    call is_read('cam.dat', 0, 'cam.dat', .false.)
    call is_read('2:cam.svg', 2, 'cam.svg', .true.)
    call is_read('12:-', 12, '-', .false.)
    call is_read(':cam.svg', 0, ':cam.svg', .true.)
    call is_read('2:', 0, '2:', .false.)
    call is_read('a:b.dat', 0, 'a:b.dat', .false.)
    call is_read('999999999:x', 999999999, 'x', .false.)
    call is_read('9999999999:x', 0, '9999999999:x', .false.)
  contains
    subroutine is_read(text, number, path, is_picture)
      character(len=*), intent(in) :: text    !< the argument
      integer, intent(in) :: number           !< of the cam
      character(len=*), intent(in) :: path    !< of the file
      logical, intent(in) :: is_picture       !< a drawing
      type(cam_file_type) :: file

      call read_cam_file(text, file)
      call tester%is_true(file%number == number .and. file%path == path .and. (file%is_picture .eqv. is_picture), &
                          'the argument of --cam: '//text)
    end subroutine is_read
  end subroutine cam_files
end module test_argument_forms
