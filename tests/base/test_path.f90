!> Tests of mech9_path by what a person calls the parts of a file's name.
module test_path
  use mech9_path, only: folder_of, name_of, ending_of, with_ending
  use mech9_testing, only: tester_type
  implicit none
  private
  public :: run

contains

  !> Run the cases of this suite.
  subroutine run(tester)
    type(tester_type), intent(inout) :: tester   !< selects cases and counts their checks

    if (tester%runs('parts_of_paths')) call parts_of_paths(tester)
  end subroutine run

  !> Folder, name and ending, and another ending.
  subroutine parts_of_paths(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks

    call check(tester, 'a/b/c.dat', 'a/b/', 'c.dat', 'dat', 'a/b/c.svg')
    call check(tester, 'c.tar.GZ', '', 'c.tar.GZ', 'gz', 'c.tar.svg')
    call check(tester, '/c', '/', 'c', '', '/c.svg')
    call check(tester, 'a.b/c', 'a.b/', 'c', '', 'a.b/c.svg')
    call check(tester, '.hidden', '', '.hidden', '', '.hidden.svg')
    call check(tester, 'a/.hidden.dat', 'a/', '.hidden.dat', 'dat', 'a/.hidden.svg')
    call check(tester, '', '', '', '', '.svg')
    call check(tester, 'c.', '', 'c.', '', 'c..svg')
    call tester%is_true(with_ending('a/c.dat', '') == 'a/c', 'a path with an empty ending has no dot')
  end subroutine parts_of_paths

  subroutine check(tester, path, folder, name, ending, changed)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    character(len=*), intent(in) :: path         !< the name that is taken apart
    character(len=*), intent(in) :: folder       !< its folder, with the slash at the end
    character(len=*), intent(in) :: name         !< its name without the folder
    character(len=*), intent(in) :: ending       !< its ending without the point, in small letters
    character(len=*), intent(in) :: changed      !< with the ending svg

    call tester%is_true(folder_of(path) == folder .and. len(folder_of(path)) == len(folder), path//': the folder is right')
    call tester%is_true(name_of(path) == name, path//': the name is right')
    call tester%is_true(ending_of(path) == ending, path//': the ending is right')
    call tester%is_true(with_ending(path, 'svg') == changed, path//': the ending is replaced')
  end subroutine check
end module test_path
