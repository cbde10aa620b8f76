!> Files that a run or an answer will write, and the refusal of those that would be written over.
module test_written_files
  use mech9_error, only: error_type, exit_usage
  use mech9_text, only: string_type
  use mech9_data_file, only: data_file_type
  use mech9_command_line, only: command_line_type
  use mech9_overwriting, only: refuse_overwriting
  use mech9_written_files, only: result_paths_type, written_file_type, find_result_paths, list_written_files
  use mech9_checks, only: has_message
  use mech9_test_files, only: save_lines, remove_file
  use mech9_testing, only: tester_type
  use option_words, only: options_of
  implicit none
  private
  public :: run

  character(len=*), parameter :: path = 'test_written_files.nml'

contains

  !> Run the cases of this suite.
  subroutine run(tester)
    type(tester_type), intent(inout) :: tester   !< selects cases and counts their checks

    if (tester%runs('paths')) call paths(tester)
    if (tester%runs('lists')) call lists(tester)
    if (tester%runs('overwriting')) call overwriting(tester)
  end subroutine run

  !> A data file that names results.
  subroutine give(table, hdf5, given)
    character(len=*), intent(in) :: table          !< its file; empty: none
    character(len=*), intent(in) :: hdf5           !< its file; empty: none
    type(data_file_type), intent(out) :: given     !< the data file

    associate (output => given%model%request%output)
      output%table = table
      output%hdf5 = hdf5
      output%sketch = ''
      output%animation = ''
    end associate
    given%model%request%section%table = ''
  end subroutine give

  !> The command line comes before the data file; without results the table goes to standard output.
  subroutine paths(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks

    call are('a.nml', '', '', '-', '')
    call are('a.nml', 't.dat', 'h.h5', 't.dat', 'h.h5')
    call are('a.nml --table u.dat', 't.dat', 'h.h5', 'u.dat', 'h.h5')
    call are('a.nml --hdf5 k.h5', '', '', '', 'k.h5')
    call are('a.nml --sketch s.svg', '', '', '', '')
    call are('a.nml --no-write', 't.dat', 'h.h5', '', '')
    call are('a.nml --study --continue c.h5', '', 'h.h5', '', 'c.h5')
  contains
    subroutine are(line, table_given, hdf5_given, table, hdf5)
      character(len=*), intent(in) :: line                  !< command line
      character(len=*), intent(in) :: table_given           !< the path of the table in the data file
      character(len=*), intent(in) :: hdf5_given            !< the path of the HDF5 file there
      character(len=*), intent(in) :: table                 !< the right path of the table
      character(len=*), intent(in) :: hdf5                  !< the right path of the HDF5 file
      type(command_line_type) :: options
      type(result_paths_type) :: found
      type(data_file_type) :: given

      call options_of(tester, line, options)
      call give(table_given, hdf5_given, given)
      call find_result_paths(options, found, given)
      call tester%is_true(found%table == table .and. found%hdf5 == hdf5, 'paths of the results of '//line)
    end subroutine are
  end subroutine paths

  subroutine lists(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks

    call are('a.nml', '-')
    call are('a.nml --table t.dat --report r.json', 't.dat r.json')
    call are('a.nml --hdf5 d/h.h5', 'd/h.h5 d/.h.h5.part')
    call are('a.nml --check', '-')
    call are('a.nml --equilibrium --table e.dat', 'e.dat')
    call are('a.nml --graph g.svg', 'g.svg g.dot')
    call are('a.nml --plot p.svg:q1 --table t.dat', 't.dat p.svg p.gp')
    call are('a.nml --animate m.html --sketch s.svg', 's.svg m.html')
  contains
    subroutine are(line, expected)
      character(len=*), intent(in) :: line       !< command line
      character(len=*), intent(in) :: expected   !< the right paths
      type(command_line_type) :: options
      type(written_file_type), allocatable :: files(:)
      character(len=:), allocatable :: names
      type(data_file_type) :: given
      integer :: i

      call options_of(tester, line, options)
      call give('', '', given)
      call list_written_files(options, files, given)
      names = ''
      do i = 1, size(files)
        if (i > 1) names = names//' '
        names = names//files(i)%path
      end do
      call tester%is_true(names == expected, 'files of '//line//': '//names)
    end subroutine are
  end subroutine lists

  subroutine overwriting(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks

    call save_lines(tester, path, ['&time /'])
    call refused('a.nml --table '//path, "--table '"//path//"' would overwrite '"//path//"', which is read")
    call refused('a.nml --table ./'//path, "--table './"//path//"' would overwrite")
    call refused('a.nml --hdf5 x.h5 --report x.h5', "--hdf5 and --report cannot both be 'x.h5'")
    call refused('a.nml --hdf5 x.h5 --report ./x.h5', "--hdf5 'x.h5' and --report './x.h5' are one file")
    call refused('a.nml --hdf5 x.h5 --report .x.h5.part', 'the beginning of the HDF5 file')
    call refused('a.nml --hdf5 x.h5 --report y.json', '')
    call refused('a.nml --table /dev/null --report /dev/null', '')
    call remove_file(path)
    call refused('a.nml --table '//path, '')
  contains
    subroutine refused(line, words)
      character(len=*), intent(in) :: line    !< command line
      character(len=*), intent(in) :: words   !< part of the message; empty: it is not refused
      type(command_line_type) :: options
      type(string_type) :: inputs(1)
      type(data_file_type) :: given
      type(error_type), allocatable :: err

      call options_of(tester, line, options)
      inputs(1)%text = path
      call give('', '', given)
      call refuse_overwriting(options, inputs, err, given)
      if (words == '') then
        call tester%no_error(err, 'files that differ: '//line)
      else
        call has_message(tester, err, exit_usage, words, line)
      end if
    end subroutine refused
  end subroutine overwriting
end module test_written_files
