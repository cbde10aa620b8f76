!> The argument of --cam, [N:]FILE: a file for the profile of a cam, and which cam it is.
module mech9_cam_files
  use mech9_path, only: ending_of
  implicit none
  private
  public :: cam_file_type, read_cam_file

  !> One file.
  type :: cam_file_type
    integer :: number = 0                   !< of the cam, in the order of the data file; 0: not given
    character(len=:), allocatable :: path   !< '-' is standard output
    logical :: is_picture = .false.         !< a drawing; else a table
  end type cam_file_type

  integer, parameter :: most_digits = 9   !< of the number of a cam

contains

  !> Read the argument: digits before a colon are the number of the cam.
  pure subroutine read_cam_file(text, file)
    character(len=*), intent(in) :: text       !< the argument of --cam
    type(cam_file_type), intent(out) :: file   !< the file
    integer :: colon

    colon = index(text, ':')
    if (colon < 2 .or. colon > most_digits + 1 .or. colon == len(text)) then
      colon = 0
    else if (verify(text(:colon - 1), '0123456789') > 0) then
      colon = 0
    else
      read (text(:colon - 1), *) file%number
    end if
    file%path = text(colon + 1:)
    file%is_picture = ending_of(file%path) == 'svg'
  end subroutine read_cam_file
end module mech9_cam_files
