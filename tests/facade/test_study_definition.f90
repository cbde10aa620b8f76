!> The text by which studies are compared: blind to what changes no numbers, different for all else; and its digest.
module test_study_definition
  use mech9_error, only: error_type, exit_file
  use mech9_data_file, only: data_file_type
  use mech9_study_definition, only: define_study, tell_difference, digest_of
  use mech9_small_models, only: slider_crank, eol
  use mech9_text_models, only: document_from_text
  use mech9_test_files, only: save_lines, remove_file
  use mech9_testing, only: tester_type
  implicit none
  private
  public :: run

  character(len=*), parameter :: path = 'test_study_definition.dat'
  character(len=*), parameter :: drive = "&drive coordinate=1, kind='polynomial', coefficients=0, 1 /"//eol

contains

  !> Run the cases of this suite.
  subroutine run(tester)
    type(tester_type), intent(inout) :: tester   !< selects cases and counts their checks

    if (tester%runs('equal_studies')) call equal_studies(tester)
    if (tester%runs('different_studies')) call different_studies(tester)
    if (tester%runs('files')) call files(tester)
    if (tester%runs('differences')) call differences(tester)
    if (tester%runs('digests')) call digests(tester)
  end subroutine run

  subroutine define(tester, text, definition)
    type(tester_type), intent(inout) :: tester                 !< counts the checks
    character(len=*), intent(in) :: text                       !< of the data file
    character(len=:), allocatable, intent(out) :: definition   !< its definition
    type(data_file_type) :: given
    type(error_type), allocatable :: err

    call document_from_text(tester, text, given%document)
    call define_study(given, definition, err)
    call tester%no_error(err, 'a study is defined')
  end subroutine define

  subroutine equal_studies(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    character(len=:), allocatable :: one, other

    call define(tester, slider_crank//drive, one)
    call define(tester, '! a comment'//eol//slider_crank//eol//drive//"&output table='a.dat', hdf5='b.h5' /"//eol, other)
    call tester%is_true(one == other, 'comments and names of results do not matter')
    call define(tester, slider_crank//"&drive   coordinate = 1 kind='polynomial' coefficients=0 1 /"//eol, other)
    call tester%is_true(one == other, 'blanks and commas do not matter')
    call define(tester, slider_crank//drive//'&optimum starts=3, seed=4 /'//eol, one)
    call define(tester, slider_crank//drive//'&optimum starts=5, seed=4 /'//eol, other)
    call tester%is_true(one == other, 'the number of starts does not matter')
  end subroutine equal_studies

  subroutine different_studies(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    character(len=:), allocatable :: one

    call define(tester, slider_crank//drive, one)
    call differs("&drive coordinate=1, kind='polynomial', coefficients=0, 1.0000000000000002 /"//eol, 'the last bit of a number')
    call differs("&drive coordinate=1, kind='polynomial', coefficients=0, 1, 0 /"//eol, 'one more number')
    call differs("&drive coordinate=1, kind='Polynomial', coefficients=0, 1 /"//eol, 'a text in other letters')
    call differs(drive//"&output joints=.true. /"//eol, 'an item that is not about places')
    call differs(drive//"&optimum seed=2 /"//eol, 'the seed of a search')
    call differs(drive//"&time end=1 /"//eol, 'one more group')
  contains
    subroutine differs(tail, why)
      character(len=*), intent(in) :: tail   !< end of the data file
      character(len=*), intent(in) :: why    !< the difference in words
      character(len=:), allocatable :: other

      call define(tester, slider_crank//tail, other)
      call tester%is_true(one /= other, why//' matters')
    end subroutine differs
  end subroutine different_studies

  !> A file counts by its bytes, and not by its name.
  subroutine files(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    character(len=*), parameter :: text = slider_crank//"&drive coordinate=1, kind='table', file='"//path//"' /"//eol
    character(len=:), allocatable :: one, other
    type(data_file_type) :: given
    type(error_type), allocatable :: err

    call save_lines(tester, path, ['0 1', '1 2'])
    call define(tester, text, one)
    call save_lines(tester, path, ['0 1', '1 3'])
    call define(tester, text, other)
    call tester%is_true(one /= other, 'other bytes of a file matter')
    call save_lines(tester, path, ['0 1', '1 2'])
    call define(tester, text, other)
    call tester%is_true(one == other, 'the same bytes do not')
    call remove_file(path)
    call document_from_text(tester, text, given%document)
    call define_study(given, other, err)
    call tester%has_error(err, exit_file, 'a file that is not there')
  end subroutine files

  subroutine differences(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    character(len=:), allocatable :: words

    call tell_difference('a'//eol//'b'//eol, 'a'//eol//'b'//eol, words, 'there', 'here')
    call tester%is_true(words == '', 'equal definitions')
    call tell_difference('a'//eol//'bc'//eol//'d'//eol, 'a'//eol//'bx'//eol//'d'//eol, words, 'there', 'here')
    call tester%is_true(words == "there 'bc', here 'bx'", 'the first line that differs: '//words)
    call tell_difference('a'//eol, 'a'//eol//'b'//eol, words, 'there', 'here')
    call tester%is_true(words == "there nothing, here 'b'", 'a line that one does not have: '//words)
    call tell_difference('x '//repeat('1', 500)//'2'//repeat('3', 500), 'x '//repeat('1', 500)//'4'//repeat('3', 500), words, &
                         'there', 'here')
    call tester%is_true(len(words) < 300 .and. index(words, '1112333') > 0 .and. index(words, '1114333') > 0, &
                        'of long lines the letters around the difference: '//words)
  end subroutine differences

  !> The digest is the cyclic redundancy check CRC-64/XZ, whose catalogued value for the digits 1 to 9 is known.
  subroutine digests(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks

    call tester%is_true(digest_of('123456789') == '995DC9BBDF1939FA', 'the check of CRC-64/XZ: '//digest_of('123456789'))
    call tester%is_true(digest_of('') == '0000000000000000', 'no bytes')
    call tester%is_true(digest_of('ab') /= digest_of('ba') .and. digest_of('a') /= digest_of('a '), 'order and length matter')
  end subroutine digests
end module test_study_definition
