!> Every name of the data file is asked for in the conversation of a program that uses it, whatever the table of
!> names holds; each question is told from the others by its label, and explained with the words of the table.
program test_questions
  use mech9_text, only: string_type
  use mech9_grammar, only: group_table, item_table, find_group_row
  use mech9_draft, only: draft_type
  use mech9_topics, only: topics, groups_of_topic, is_numbered
  use mech9_outline, only: ways
  use mech9_interview, only: interview_type
  use mech9_questions, only: question_type, label_of, find_question, ask_item, check_structure, check_start, check_all
  use mech9_question_words, only: default_of, prompt_of, help_of, words_for
  use mech9_testing, only: tester_type
  implicit none
  type(tester_type) :: tester

  call the_topics(tester)
  call all_names(tester)
  call tester%finish()

contains

  !> Each group belongs to one topic.
  subroutine the_topics(tester)
    type(tester_type), intent(inout) :: tester
    integer :: times(size(group_table)), i

    times = 0
    do i = 1, size(topics)
      times(groups_of_topic(i)) = times(groups_of_topic(i)) + 1
    end do
    call tester%is_true(all(times == 1), 'each group belongs to one topic')
  end subroutine the_topics

  !> Four-bars given in each way, with groups of every kind there is.
  subroutine all_names(tester)
    type(tester_type), intent(inout) :: tester
    type(interview_type) :: interview
    character(len=6), parameter :: programs(2) = ['mech9k', 'mech9d']
    character(len=10), parameter :: drives(4) = [character(len=10) :: 'polynomial', 'harmonic', 'table', 'user']
    logical :: asked(size(item_table))
    integer :: program, way, drive, row

    asked = .false.
    do program = 1, size(programs)
      do way = 1, size(ways)
        do drive = 1, size(drives)
          call begin(programs(program), trim(ways(way)), trim(drives(drive)), interview)
          call tester%is_true(interview%outline%structure_known, trim(ways(way))//': the structure is known')
          call look_at(tester, interview, asked)
        end do
      end do
    end do
    do row = 1, size(item_table)
      associate (item => item_table(row))
        if (item%name == 'coordinate' .and. is_numbered(find_group_row(item%group))) cycle   ! there is one for each
        call tester%is_true(asked(row), '&'//trim(item%group)//' '//trim(item%name)//' ('//trim(item%kinds)//') is asked for')
      end associate
    end do
  end subroutine all_names

  subroutine begin(program_name, way, drive, interview)
    character(len=*), intent(in) :: program_name, way, drive
    type(interview_type), intent(out) :: interview
    type(draft_type) :: draft
    character(len=10), parameter :: pairs(4) = [character(len=10) :: 'revolute', 'prismatic', 'helical', 'user']
    character(len=10), parameter :: loads(5) = [character(len=10) :: 'force', 'torque', 'spring', 'coordinate', 'user']
    character(len=6), parameter :: links(4) = ['1, 2', '2, 3', '3, 4', '4, 1']
    character(len=1) :: number
    integer :: i

    call draft%clear()
    call draft%give('mechanism', 1, 'links', '4')
    call draft%give('mechanism', 1, 'coordinates', '4')
    call structure_in(way, draft)
    do i = 1, 4
      write (number, '(i1)') i
      call draft%give('pair', i, 'coordinate', number)
      call draft%give('pair', i, 'kind', ''''//trim(pairs(i))//'''')
      if (way == 'pairs') call draft%give('pair', i, 'links', trim(links(i)))
    end do
    call draft%give('drive', 1, 'coordinate', '1')
    call draft%give('drive', 1, 'kind', ''''//drive//'''')
    do i = 1, size(loads)
      call draft%give('load', i, 'kind', ''''//trim(loads(i))//'''')
    end do
    call draft%give('point', 1, 'name', '''P''')
    call draft%give('body', 1, 'link', '2')
    call interview%start(program_name, draft)
    interview%outline%asked = .true.
    interview%outline%guesses = .true.
    call interview%refresh('')
  end subroutine begin

  !> The structure of a four-bar, driven at its first pair.
  subroutine structure_in(way, draft)
    character(len=*), intent(in) :: way
    type(draft_type), intent(inout) :: draft

    if (way == 'matrix') then
      call draft%give('structure', 1, 'c(1,:)', '0, 1, 0, 4')
      call draft%give('structure', 1, 'c(2,:)', '1, 0, 2, 0')
      call draft%give('structure', 1, 'c(3,:)', '0, 2, 0, 3')
      call draft%give('structure', 1, 'c(4,:)', '4, 0, 3, 0')
    else if (way == 'vectors') then
      call draft%give('structure', 1, 'nrg', '1, 2, 3, 4, 1')
      call draft%give('structure', 1, 'nws', '0, 1, 2, 3, 4')
      call draft%give('structure', 1, 'rdw', '1, 1, 0, 0, 0')
    end if
    if (way /= 'vectors') call draft%give('structure', 1, 'cq', '1')
  end subroutine structure_in

  !> Labels, prompts and help of all questions; the names that are asked for.
  subroutine look_at(tester, interview, asked)
    type(tester_type), intent(inout) :: tester
    type(interview_type), intent(in) :: interview
    logical, intent(inout) :: asked(:)
    type(string_type), allocatable :: words(:)
    type(question_type) :: question
    integer :: i

    do i = 1, size(interview%questions)
      question = interview%questions(i)
      call tester%is_true(find_question(interview%questions, label_of(question)) == i, label_of(question)//': one question')
      if (any(question%kind == [check_structure, check_start, check_all])) cycle
      call words_for(question, interview%outline, words)
      call tester%is_true(size(words) >= 4, label_of(question)//': words to complete')
      if (question%kind /= ask_item) cycle
      asked(question%row) = .true.
      associate (item => item_table(question%row))
        call tester%is_true(index(prompt_of(question, interview%draft, default_of(question, interview%draft, &
                                  interview%outline, 'x.dat')), trim(item%name)) > 0, label_of(question)//': named in its prompt')
        call tester%is_true(index(help_of(question, interview%draft, interview%outline), trim(item%help)) > 0, &
                            label_of(question)//': explained')
      end associate
    end do
  end subroutine look_at
end program test_questions
