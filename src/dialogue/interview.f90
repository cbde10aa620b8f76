!> A conversation without its words: the draft, the questions, the current question, and the order of the questions.
module mech9_interview
  use mech9_text, only: to_text
  use mech9_grammar, only: group_table, item_table, rows_of_group, for_forces
  use mech9_item_rows, only: find_item_rows
  use mech9_structure, only: structure_type
  use mech9_partition, only: partition_type
  use mech9_draft, only: draft_type, plain_name
  use mech9_draft_check, only: fault_type, read_draft_structure
  use mech9_topics, only: can_be_left_out
  use mech9_outline, only: outline_type, ways, new_outline, make_pairs, make_groups, drop_foreign, wants_forces
  use mech9_planar_links, only: settle_planar_pairs
  use mech9_seldom, only: is_seldom
  use mech9_questions, only: question_type, make_questions, label_of, find_question, entry_name, &
                             ask_item, check_structure, check_start, check_all
  use mech9_question_words, only: is_lacking
  implicit none
  private
  public :: interview_type, most_parts

  !> The largest number of links or coordinates about which a conversation asks one by one.
  integer, parameter :: most_parts = 1000

  type :: interview_type
    type(draft_type) :: draft
    type(outline_type) :: outline
    type(question_type), allocatable :: questions(:)
    integer :: at = 1                              !< number of the current question
    !> The label of the question to return to after a correction; empty: questions follow in order.
    character(len=:), allocatable :: return_to
    logical :: adding = .false.                    !< during a correction, all questions of one group are asked
    type(structure_type) :: structure              !< structure, if outline%structure_known
    type(partition_type) :: partition
    type(fault_type), allocatable :: faults(:)     !< errors of the structure
    character(len=:), allocatable :: dropped       !< names that the last answer made meaningless; empty: none
  contains
    procedure :: start
    procedure :: due
    procedure :: refresh
    procedure :: step
    procedure :: back
    procedure :: is_begun
    procedure :: leave_out
    procedure :: correct
    procedure :: miscount
    procedure :: note
    procedure :: unnote
    procedure :: bookmark
    procedure :: open_at
  end type interview_type

contains

  !> Begin with a draft, which is empty or was read from a file.
  pure subroutine start(self, program, draft)
    class(interview_type), intent(inout) :: self  !< draft, questions and the current question
    integer, intent(in) :: program                !< kinematics or dynamics
    type(draft_type), intent(in) :: draft         !< draft to begin with

    self%draft = draft
    if (self%draft%count_of('mechanism') == 0) call self%draft%add('mechanism')
    self%outline = new_outline(program, self%draft)
    self%return_to = ''
    self%at = 1
    call self%refresh('')
    if (.not. self%outline%structure_known) return
    ! counts that are not in the file are added
    if (self%draft%has('mechanism', 1, 'links') .and. self%draft%has('mechanism', 1, 'coordinates')) return
    call self%draft%give('mechanism', 1, 'links', to_text(self%structure%shown_links()))
    call self%draft%give('mechanism', 1, 'coordinates', to_text(self%structure%n_coordinates))
    call self%refresh('')
  end subroutine start

  !> The current question.
  pure type(question_type) function due(self)
    class(interview_type), intent(in) :: self  !< draft, questions and the current question

    due = self%questions(self%at)
  end function due

  !> Make anew the structure, groups and questions that follow from the draft. The question with this label becomes the
  !> current one; if there is none, the number of the question stays.
  pure subroutine refresh(self, label)
    class(interview_type), intent(inout) :: self  !< draft, questions and the current question
    character(len=*), intent(in) :: label         !< label of the question to go to; empty: the number of the question stays
    character(len=:), allocatable :: pairs
    integer :: found

    call make_pairs(self%draft, pairs)
    call read_draft_structure(self%draft, self%outline, self%structure, self%partition, self%faults)
    self%outline%structure_known = size(self%faults) == 0 .and. counts_agree(self)
    if (self%outline%structure_known) then
      self%outline%independent = self%partition%independent()
      self%outline%links = links_of_pairs(self%structure)
    end if
    call drop_foreign(self%draft, self%outline, self%dropped)
    if (pairs /= '' .and. self%dropped /= '') pairs = pairs//', '
    self%dropped = pairs//self%dropped
    call make_groups(self%draft, self%outline)
    call settle_planar_pairs(self%draft, self%outline)
    call make_questions(self%draft, self%outline, self%questions)
    found = 0
    if (label /= '') found = find_question(self%questions, label)
    if (found > 0) self%at = found
    self%at = max(1, min(self%at, size(self%questions)))
  end subroutine refresh

  !> The links of the pairs as the user knows them; the first coordinate of a joint with several freedoms has those of the joint.
  pure function links_of_pairs(structure) result(links)
    type(structure_type), intent(in) :: structure  !< links of the pairs, and the joints with several freedoms
    integer, allocatable :: links(:, :)
    integer :: j

    links = structure%links
    if (.not. allocated(structure%joints)) return
    do j = 1, size(structure%joints)
      links(:, structure%joints(j)%numbers(1)) = structure%joints(j)%ends
    end do
  end function links_of_pairs

  !> Whether the structure has so few parts that a conversation can ask about them one by one.
  pure logical function counts_agree(self)
    type(interview_type), intent(in) :: self  !< draft, questions and the current question

    counts_agree = .false.
    if (allocated(self%structure%links)) counts_agree = size(self%structure%links, 2) <= most_parts
  end function counts_agree

  !> Go to the next question. During a correction this is the first question that lacks its answer, and after these the
  !> question at which the correction began.
  pure subroutine step(self)
    class(interview_type), intent(inout) :: self  !< draft, questions and the current question
    integer :: i, goal

    if (self%return_to == '') then
      self%at = min(self%at + 1, size(self%questions))
      do while (self%questions(self%at)%on_request .and. self%at < size(self%questions))
        self%at = self%at + 1
      end do
      return
    end if
    goal = find_question(self%questions, self%return_to)
    if (goal == 0) goal = size(self%questions)
    if (self%adding .and. self%at < size(self%questions)) then
      if (same_group(self%questions(self%at), self%questions(self%at + 1))) then
        self%at = self%at + 1
        return
      end if
    end if
    self%adding = .false.
    do i = 1, goal - 1
      if (.not. is_lacking(self%questions(i), self%draft, self%outline)) cycle
      self%at = i
      return
    end do
    self%at = goal
    self%return_to = ''
  end subroutine step

  !> Whether two questions are about names of one group.
  pure logical function same_group(one, other)
    type(question_type), intent(in) :: one    !< the current question
    type(question_type), intent(in) :: other  !< the question after it

    same_group = one%kind == ask_item .and. other%kind == ask_item .and. one%group_row == other%group_row .and. &
                 one%place == other%place .and. .not. other%is_new
  end function same_group

  !> Go to the question before, except for checks and questions that begin groups on request. `done` is false at the
  !> first question.
  pure subroutine back(self, done)
    class(interview_type), intent(inout) :: self  !< draft, questions and the current question
    logical, intent(out) :: done                  !< false at the first question
    integer :: i

    done = .false.
    do i = self%at - 1, 1, -1
      if (any(self%questions(i)%kind == [check_structure, check_start, check_all]) .or. self%questions(i)%on_request) cycle
      self%at = i
      done = .true.
      return
    end do
  end subroutine back

  !> Whether the current question is the first of a group that can be left out and still lacks answers. Such a group may
  !> have been begun by mistake.
  pure logical function is_begun(self)
    class(interview_type), intent(in) :: self  !< draft, questions and the current question
    integer, allocatable :: rows(:)
    integer :: i

    is_begun = .false.
    associate (question => self%questions(self%at))
      if (question%kind /= ask_item .or. question%is_new) return
      if (.not. can_be_left_out(question%group_row, self%outline%program)) return
      rows = rows_of_group(group_table(question%group_row)%name)
      if (question%row /= rows(1)) return
      do i = self%at, size(self%questions)
        if (self%questions(i)%group_row /= question%group_row .or. self%questions(i)%place /= question%place) return
        is_begun = is_lacking(self%questions(i), self%draft, self%outline)
        if (is_begun) return
      end do
    end associate
  end function is_begun

  !> Remove the load, point or body of the current question. The next question is whether there is another one.
  pure subroutine leave_out(self, done)
    class(interview_type), intent(inout) :: self  !< draft, questions and the current question
    logical, intent(out) :: done                  !< false where the question belongs to no group that can be left out
    type(question_type) :: question
    character(len=:), allocatable :: group
    integer, allocatable :: rows(:)

    question = self%due()
    done = .false.
    if (question%kind /= ask_item .or. question%is_new) return
    done = can_be_left_out(question%group_row, self%outline%program)
    if (.not. done) return
    group = trim(group_table(question%group_row)%name)
    rows = rows_of_group(group)
    call self%draft%remove(group, question%place)
    call self%refresh(group//'('//to_text(question%place)//').'//trim(item_table(rows(1))%name))
  end subroutine leave_out

  !> Go to the question about an entry of the draft, and note that the conversation returns to the present question. The
  !> argument `found` is false if this program has no question about it.
  pure subroutine correct(self, group, place, name, found)
    class(interview_type), intent(inout) :: self  !< draft, questions and the current question
    character(len=*), intent(in) :: group         !< name of the group
    character(len=*), intent(in) :: name          !< name with its subscript
    integer, intent(in) :: place                  !< place among the groups of that name, from 1
    logical, intent(out) :: found                 !< false where the program has no question about it
    character(len=:), allocatable :: here
    integer, allocatable :: rows(:)
    integer :: number

    here = label_of(self%questions(self%at))
    rows = find_item_rows(group, plain_name(name))
    found = size(rows) > 0
    if (.not. found) return
    ! there must be a question about the name, even if it is a rarely used one
    self%outline%asked(rows) = .true.
    if (group == 'initial') self%outline%guesses = .true.
    call self%refresh(here)
    number = find_question(self%questions, group//'('//to_text(place)//').'//name)
    found = number > 0
    if (.not. found) return
    self%at = number
    if (self%return_to == '') self%return_to = here
  end subroutine correct

  !> Find the reason against an answer that makes too many coordinates independent, or too few in open chains; empty if
  !> there is none. Each closed chain makes at least one coordinate dependent, and at least three unless its pairs are
  !> of a special kind.
  pure subroutine miscount(self, answer, problem, certain)
    class(interview_type), intent(in) :: self              !< draft, questions and the current question
    character(len=*), intent(in) :: answer                 !< the answer as a data file writes it
    character(len=:), allocatable, intent(out) :: problem  !< the reason against the answer; empty: none
    logical, intent(out) :: certain                        !< the answer is wrong whatever the pairs are
    type(interview_type) :: trial
    integer :: chains, named, most, usual

    problem = ''
    certain = .false.
    if (group_table(self%questions(self%at)%group_row)%name /= 'structure') return
    trial = self
    call trial%note(answer)
    if (.not. trial%outline%structure_known) return
    associate (structure => trial%structure)
      chains = structure%n_coordinates - structure%n_links + 1
      named = count(trial%partition%independent())
      most = structure%n_coordinates - chains
      usual = max(1, structure%n_coordinates - 3*chains)
    end associate
    certain = named > most .or. (chains == 0 .and. named < most)
    if (chains == 0 .and. named < most) then
      problem = 'Too few coordinates are independent: no chain is closed, and so all '//to_text(most)//' are.'
    else if (certain) then
      problem = 'Too many coordinates are independent: '//to_text(named)//' are named, and '//to_text(most)//' can be at '// &
                'most, since each closed chain makes at least one coordinate depend on the others.'
    else if (named > usual) then
      problem = 'Too many coordinates are independent: '//to_text(named)//' are named, and by the count it should be '// &
                to_text(usual)//'. More can be only where a closed chain has slides alone, or turns and slides along one '// &
                'line alone.'
    end if
  end subroutine miscount

  !> Note an answer to the current question. Other questions may follow from it.
  pure subroutine note(self, text, written)
    class(interview_type), intent(inout) :: self  !< draft, questions and the current question
    character(len=*), intent(in) :: text          !< the answer as a data file writes it
    character(len=*), intent(in), optional :: written   !< with names of links and pairs in quotes, not numbers
    type(question_type) :: question
    logical :: with_forces, was_known

    question = self%due()
    with_forces = wants_forces(self%draft)
    was_known = self%outline%structure_known
    call self%draft%give(trim(group_table(question%group_row)%name), question%place, entry_name(question), text, written)
    call self%refresh(label_of(question))
    if (wants_forces(self%draft) .and. .not. with_forces) call go_on_with_masses(self)
    ! pairs that a joint leaves need their links before the conversation goes on
    if (group_table(question%group_row)%name == 'pair' .and. was_known .and. .not. self%outline%structure_known .and. &
        self%return_to == '') self%return_to = label_of(self%questions(min(self%at + 1, size(self%questions))))
  end subroutine note

  !> Go on to the questions about bodies, gravity and loads after a correction that asks for forces. This is done if
  !> these questions come only now, and none has its answer yet.
  pure subroutine go_on_with_masses(self)
    type(interview_type), intent(inout) :: self  !< draft, questions and the current question
    integer :: i

    if (self%return_to == '' .or. self%draft%count_of('body') > 0) return
    do i = self%at + 1, size(self%questions)
      if (self%questions(i)%group_row == 0) cycle
      if (group_table(self%questions(i)%group_row)%program /= for_forces) cycle
      self%return_to = label_of(self%questions(i))
      return
    end do
  end subroutine go_on_with_masses


  !> Remove the answer to the current question.
  pure subroutine unnote(self)
    class(interview_type), intent(inout) :: self  !< draft, questions and the current question
    type(question_type) :: question

    question = self%due()
    call self%draft%take_away(trim(group_table(question%group_row)%name), question%place, entry_name(question))
    call self%refresh(label_of(question))
  end subroutine unnote
  !> The facts that are needed beside the draft to resume a conversation. They are the current question, the way of
  !> giving the structure, and the rarely used names that the user wants. An example is "pair(1).axis; pairs; pair.zero
  !> pair.moving_point".
  pure function bookmark(self) result(text)
    class(interview_type), intent(in) :: self  !< draft, questions and the current question
    character(len=:), allocatable :: text
    integer :: row

    text = label_of(self%questions(self%at))//'; '//trim(self%outline%way)//';'
    if (self%outline%lengths) text = text//' lengths'
    do row = 1, size(item_table)
      if (is_seldom(self%outline, item_table(row)) .and. self%outline%asked(row)) &
        text = text//' '//trim(item_table(row)%group)//'.'//trim(item_table(row)%name)
    end do
  end function bookmark

  !> Resume at a bookmark. Unknown parts of a bookmark are ignored.
  pure subroutine open_at(self, text)
    class(interview_type), intent(inout) :: self  !< draft, questions and the current question
    character(len=*), intent(in) :: text          !< the bookmark, in the form of `bookmark`
    integer :: first, second, row

    first = index(text, ';')
    if (first == 0) return
    second = first + index(text(first + 1:)//';', ';')
    if (any(ways == adjustl(text(first + 1:second - 1)))) self%outline%way = adjustl(text(first + 1:second - 1))
    self%outline%lengths = index(text(second:)//' ', ' lengths ') > 0
    do row = 1, size(item_table)
      if (index(text(second:)//' ', ' '//trim(item_table(row)%group)//'.'//trim(item_table(row)%name)//' ') > 0) &
        self%outline%asked(row) = .true.
    end do
    if (self%outline%lengths) then
      ! the names in the draft count as asked for, also those that the systems of the links settled
      self%outline%asked([find_item_rows('pair', 'point'), find_item_rows('pair', 'axis'), &
                          find_item_rows('pair', 'moving_point')]) = .false.
    end if
    call self%refresh(text(:first - 1))
  end subroutine open_at
end module mech9_interview
