!> Drafts: what is given is found, taken away is gone; written as a data file and read again nothing is lost, and each
!> error is found at the entry that it is about.
module test_drafts
  use mech9_program_kind, only: dynamics
  use mech9_source, only: source_from_text
  use mech9_document, only: document_type
  use mech9_parser, only: parse_document
  use mech9_diagnostics, only: diagnostics_type
  use mech9_grammar, only: item_table
  use mech9_data_file, only: data_file_type
  use mech9_draft, only: draft_type, unquoted, integer_of
  use mech9_draft_text, only: draft_text_type, write_draft, locate
  use mech9_draft_source, only: draft_from_document
  use mech9_draft_check, only: fault_type, read_draft, faults_of
  use mech9_draft_file, only: stem_of_title, stem_of_path, path_without_draft, free_draft_path, delete_file, file_exists
  use mech9_answer, only: read_answer
  use mech9_testing, only: tester_type
  implicit none
  private
  public :: run

  character(len=*), parameter :: eol = achar(10)
  character(len=*), parameter :: slider_crank = &
    "! An offset slider-crank."//eol//eol// &
    "&mechanism title='It''s a slider/crank! & more', links=4, coordinates=4 /"//eol// &
    "&structure c(1,:)=0,1,0,4  c(2,:)=1,0,2,0  c(3,1)=0  c(3,2:4)=2,0,3  c(4,1:2)=4,0  c(4,3)=3  c(4,4)=0  cq=1 /"//eol// &
    "! the crank"//eol// &
    "&pair coordinate=1, links=1,2, kind='revolute', axis=2*0,1 /"//eol// &
    "&pair coordinate=2, links=2,3, kind='revolute', axis=0,0,1, point(1)=0.3, point(2:3)=0,0, moving_point=0,0,0 /"//eol

contains

  !> Run the cases of this suite.
  subroutine run(tester)
    type(tester_type), intent(inout) :: tester   !< selects cases and counts their checks

    if (tester%runs('give_and_take')) call give_and_take(tester)
    if (tester%runs('there_and_back')) call there_and_back(tester)
    if (tester%runs('places')) call places(tester)
    if (tester%runs('answers')) call answers(tester)
    if (tester%runs('names_of_files')) call names_of_files(tester)
  end subroutine run

  subroutine give_and_take(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(draft_type) :: draft

    call draft%clear()
    call draft%give('time', 1, 'end', '2')
    call draft%give('pair', 1, 'kind', "'user'")
    call draft%give('pair', 2, 'coordinate', '7')
    call draft%give('pair', 1, 'coordinate', '4')
    call tester%is_true(draft%groups(1)%name == 'pair' .and. draft%groups(3)%name == 'time', &
                        'the groups of a draft stand in the order of the table')
    call tester%is_true(draft%groups(1)%entries(1)%name == 'coordinate', 'the names of a group stand in the order of the table')
    call tester%is_true(draft%with_number('pair', 'coordinate', 7) == 2 .and. draft%with_number('pair', 'coordinate', 1) == 0, &
                        'a pair is found by the number of its coordinate')
    call draft%give('time', 1, 'end', '3')
    call tester%is_true(draft%value('time', 1, 'end') == '3' .and. size(draft%groups(3)%entries) == 1, &
                        'a value that is given again replaces the first one')
    call draft%take_away('pair', 1, 'coordinate')
    call tester%is_true(.not. draft%has('pair', 1, 'coordinate') .and. draft%has('pair', 1, 'kind'), &
                        'an entry that is taken away is gone and the next one stays')
    call draft%remove('pair', 1)
    call tester%is_true(draft%number('pair', 1, 'coordinate') == 7 .and. draft%count_of('pair') == 1, &
                        'a group that is removed is gone and the next one stays')
    call draft%remove('pair', 9)
    call draft%take_away('load', 1, 'kind')
    call tester%is_true(size(draft%groups) == 2, 'taking away a group that is not there changes nothing')
    call tester%is_true(integer_of('12') == 12 .and. integer_of('1.5') == 0 .and. integer_of('x') == 0 .and. &
                        integer_of('99999999999') == 0, 'only whole numbers in range are read as whole numbers')
    call tester%is_true(unquoted("'dwell', 'it''s', 'harmonic'") == "dwell, it's, harmonic" .and. unquoted("''") == '', &
                        'a list of texts is shown without the quotes of each')
    call tester%is_true(unquoted("'it''s'") == "it's" .and. unquoted('1, 2') == '1, 2', &
                        'quotes come off a text and nothing comes off a list')
  end subroutine give_and_take

  subroutine read_text(text, draft)
    character(len=*), intent(in) :: text     !< of a data file
    type(draft_type), intent(out) :: draft   !< read from it
    type(document_type) :: document
    type(diagnostics_type) :: diagnostics

    call parse_document(source_from_text('a.nml', text), document, diagnostics)
    call draft_from_document(document, draft)
  end subroutine read_text

  !> A data file as a draft, written, and read again: the second writing is the first.
  subroutine there_and_back(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(draft_type) :: draft, again
    type(draft_text_type) :: first, second

    call read_text(slider_crank, draft)
    call tester%is_true(draft%value('structure', 1, 'c(3,:)') == '0, 2, 0, 3', 'a matrix in pieces becomes rows')
    call tester%is_true(draft%value('pair', 2, 'point') == '0.3, 0, 0', 'a list in pieces becomes one')
    call tester%is_true(draft%value('pair', 1, 'axis') == '0, 0, 1', 'repeats are written out')
    call tester%is_true(unquoted(draft%value('mechanism', 1, 'title')) == "It's a slider/crank! & more", &
                        'a text with marks of the language keeps them')
    call tester%is_true(draft%comments_left_out == 0, 'no comment is left out')
    call read_text(slider_crank//"&time end=1 ! 'the end' !"//eol//" ! no more"//eol//"/ ! so"//eol//"! behind"//eol, again)
    call tester%is_true(again%comments_left_out == 4, 'comments inside and behind groups are left out')
    call write_draft(draft, '', first)
    call tester%is_true(index(first%text, '! An offset slider-crank.'//eol) == 1, 'the first comment stays')
    call tester%is_true(index(first%text, '! the crank'//eol//'&pair coordinate=1') > 0, 'a comment above a group stays')
    call read_text(first%text, again)
    call write_draft(again, '', second)
    call tester%is_true(first%text == second%text .and. len(first%text) == len(second%text), 'nothing is lost or added')
  end subroutine there_and_back

  !> Bytes of the text belong to their entries, and errors to theirs.
  subroutine places(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(draft_type) :: draft
    type(draft_text_type) :: written
    type(data_file_type) :: given
    type(fault_type), allocatable :: faults(:)
    integer :: group, entry, i
    logical :: found

    call read_text(slider_crank, draft)
    call draft%give('pair', 2, 'kind', "'revolutte'")
    call write_draft(draft, '', written)
    call locate(written, index(written%text, 'moving_point') + 3, group, entry)
    call tester%is_true(draft%groups(group)%name == 'pair' .and. draft%place_of(group) == 2, &
                        'the group at a byte of the text is found')
    call tester%is_true(draft%groups(group)%entries(entry)%name == 'moving_point', 'the entry at a byte of the text is found')
    call locate(written, 1, group, entry)
    call tester%is_true(group == 0, 'a comment belongs to no group')
    call read_draft(draft, 'a.nml', dynamics, given, written)
    call faults_of(given%diagnostics, written, faults)
    found = .false.
    do i = 1, size(faults)
      if (index(faults(i)%message, 'revolutte') == 0) cycle
      found = draft%groups(faults(i)%group)%entries(faults(i)%entry)%name == 'kind'
    end do
    call tester%is_true(found, 'an error is found at its entry')
  end subroutine places

  !> The example and the default of each row are answers; texts do without quotes.
  subroutine answers(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    character(len=:), allocatable :: text, problem
    integer :: i

    do i = 1, size(item_table)
      associate (row => item_table(i))
        if (index(row%example, '=') == 0) then
          call read_answer(row, unquoted(trim(row%example)), text, problem)
          call tester%is_true(problem == '', &
                              trim(row%group)//' '//trim(row%name)//': the example of the table is accepted as an answer')
          call tester%is_true(text == trim(row%example) .or. row%type /= 'text', &
                              trim(row%group)//' '//trim(row%name)//': the example of the table is written as it stands there')
        end if
        call read_answer(row, '1 &pair', text, problem)
        call tester%is_true(problem /= '' .or. row%type == 'text', trim(row%name)//': a group is refused as an answer')
        call read_answer(row, 'a'//achar(7), text, problem)
        call tester%is_true(problem /= '', trim(row%name)//': a control character is refused as an answer')
        if (row%type /= 'integer') cycle
        call read_answer(row, 'many many', text, problem)
        call tester%is_true(problem /= '' .and. index(problem, 'none', back=.true.) == index(problem, 'none'), &
                            trim(row%name)//': a mistake that is made twice is told once')
      end associate
    end do
  end subroutine answers

  subroutine names_of_files(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    integer :: unit

    call tester%is_true(stem_of_title("'Fig. 1: two closed chains'") == 'fig_1', 'the stem of a title ends before its colon')
    call tester%is_true(stem_of_title("''") == 'mechanism' .and. stem_of_title("'../..'") == 'mechanism', &
                        'a title without letters gives the stem of a mechanism')
    call tester%is_true(stem_of_title("'/etc/passwd'") == 'etc_passwd', 'no path comes from a title')
    call tester%is_true(stem_of_path('a/b.nml') == 'a/b' .and. stem_of_path('b.draft.nml') == 'b', &
                        'the stem of a path has no ending')
    call tester%is_true(path_without_draft('b.draft.nml') == 'b.nml' .and. path_without_draft('b.dat') == 'b.dat', &
                        'the path of a draft becomes that of its data file')
    open (newunit=unit, file='kept.draft.nml', status='replace')
    close (unit)
    call tester%is_true(free_draft_path('kept') == 'kept_2.draft.nml', 'a draft that is on the disk is not written over')
    call delete_file('kept.draft.nml')
    call tester%is_true(.not. file_exists('kept.draft.nml'), 'a file that is deleted is gone from the disk')
    call tester%is_true(free_draft_path('kept') == 'kept.draft.nml', 'where no draft is on the disk the plain name is free')
  end subroutine names_of_files
end module test_drafts
