!> The documentation of the data file, docs/reference/data-file.md, is what the table of names says.
!>
!> The right text is left in `data-file.md` of the current folder, to be copied over an outdated one.
module test_data_help
  use mech9_error, only: error_type, exit_usage
  use mech9_source, only: source_type, read_source
  use mech9_grammar, only: group_table, item_table
  use mech9_data_help, only: write_data_help, write_data_tables
  use mech9_testing, only: tester_type
  use mech9_input_support, only: eol
  implicit none
  private
  public :: run

  character(len=*), parameter :: mark = '<!-- From here on made from the table of names; see tests/input. -->'

contains

  !> Run the cases of this suite.
  subroutine run(tester)
    type(tester_type), intent(inout) :: tester   !< selects cases and counts their checks

    if (tester%runs('the_document')) call the_document(tester)
    if (tester%runs('the_help')) call the_help(tester)
  end subroutine run

  subroutine the_document(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(source_type) :: found, expected
    type(error_type), allocatable :: err
    integer :: unit, at

    call read_source(tester%tree//'/docs/reference/data-file.md', found, err)
    call tester%no_error(err, 'the document can be read')
    at = index(found%text, mark//eol)
    call tester%is_true(at > 0, 'the document has its mark')
    open (newunit=unit, file='data-file.md', status='replace', action='write', access='stream', form='formatted')
    write (unit, '(2a)') found%text(:max(at - 1, 0)), mark
    call write_data_tables(unit)
    close (unit)
    call read_source('data-file.md', expected, err)
    call tester%is_true(found%text == expected%text, 'the document says what the table of names says; else copy data-file.md '// &
                        'of the test''s folder over it')
    call tester%is_true(len(found%text) == len(expected%text), 'the document is as long as the table of names makes it')
  end subroutine the_document

  !> Help names every group, and help on a group every name, with its default and its words.
  subroutine the_help(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(error_type), allocatable :: err
    character(len=:), allocatable :: text
    integer :: i

    call help_of('', text, err)
    call tester%no_error(err, 'help on all groups is given')
    do i = 1, size(group_table)
      call tester%is_true(index(text, '&'//trim(group_table(i)%name)) > 0, 'help on all groups names '//trim(group_table(i)%name))
    end do
    do i = 1, size(item_table)
      call help_of(trim(item_table(i)%group), text, err)
      call tester%no_error(err, 'help is given on '//trim(item_table(i)%group))
      call tester%is_true(index(text, eol//'  '//trim(item_table(i)%name)//' = ') > 0, &
                          'help on its group names '//trim(item_table(i)%name))
      call tester%is_true(index(text, trim(item_table(i)%help)) > 0, 'help on its group explains '//trim(item_table(i)%name))
    end do
    call help_of('&PAIR', text, err)
    call tester%no_error(err, 'a group may be written in capitals and with its &')
    call help_of('piar', text, err)
    call tester%has_error(err, exit_usage, 'help on a group that is not there is refused')
    if (allocated(err)) call tester%is_true(index(err%message, 'pair') > 0, &
                                            'the message about a group that is not there names the nearest one')
    call help_of('&', text, err)
    call tester%has_error(err, exit_usage, 'help on an empty name is refused')
    call help_of('Load.Stiffness', text, err)
    call tester%no_error(err, 'help on one name is given')
    call tester%is_true(index(text, 'spring') > 0 .and. index(text, 'coordinate') > 0, &
                        'help on one name tells both of its meanings')
    call tester%is_true(index(text, 'free_length = ') == 0, 'help on one name tells nothing of another name')
    call help_of('load.stifness', text, err)
    call tester%has_error(err, exit_usage, 'help on a name that is not there is refused')
    if (allocated(err)) call tester%is_true(index(err%message, 'stiffness') > 0, &
                                            'the message about a name that is not there names the nearest one')
    call help_of('laod.stiffness', text, err)
    call tester%has_error(err, exit_usage, 'help on a name of a group that is not there is refused')
    if (allocated(err)) call tester%is_true(index(err%message, 'load') > 0, &
                                            'the message about a name of a group that is not there names the nearest group')
    call help_of('load.', text, err)
    call tester%no_error(err, 'help on a name that is not typed yet is that on the whole group')
  end subroutine the_help

  subroutine help_of(group, text, err)
    character(len=*), intent(in) :: group                !< name of a group; empty: the list of groups
    character(len=:), allocatable, intent(out) :: text   !< the help
    type(error_type), allocatable, intent(out) :: err    !< allocated if it failed
    type(source_type) :: source
    type(error_type), allocatable :: trouble
    integer :: unit

    open (newunit=unit, file='test_data_help.txt', status='replace', action='write', access='stream', form='formatted')
    call write_data_help(unit, group, err)
    close (unit)
    call read_source('test_data_help.txt', source, trouble)
    text = source%text
  end subroutine help_of
end module test_data_help
