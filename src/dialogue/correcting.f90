!> The correction of answers: showing errors with the numbers of their answers, and changing, removing or adding any
!> answer.
module mech9_correcting
  use mech9_text, only: string_type, to_text, lower
  use mech9_grammar, only: group_table, find_group_row
  use mech9_draft_check, only: fault_type
  use mech9_questions, only: label_of, find_question, ask_item
  use mech9_question_words, only: is_lacking
  use mech9_summary, only: number_of_entry, entry_meant, title_of
  use mech9_draft, only: draft_type
  use mech9_known_names, only: add_known_names, add_word
  use mech9_conversation, only: conversation_type, going
  use mech9_taking, only: take_answer, settle_units
  implicit none
  private
  public :: show_faults, offer_correction, change, correction_help, correction_words

  integer, parameter :: most_shown = 5
  character(len=*), parameter :: correction_help = &
    'Give the number of an answer (list shows them), or its name as in "pair 3 zero"; "time end = 2" gives the new '// &
    'answer at once. "add load" begins another load; "remove 12" takes an answer away, "remove load 2" a whole '// &
    'group. back goes to the question before, quit leaves (what was typed is kept).'

contains

  !> Show errors, each with its answer.
  subroutine show_faults(conversation, faults)
    class(conversation_type), intent(in) :: conversation  !< the conversation as it stands
    type(fault_type), intent(in) :: faults(:)             !< errors, each with its entry in the draft
    character(len=:), allocatable :: text
    integer :: i

    associate (draft => conversation%interview%draft)
      do i = 1, min(size(faults), most_shown)
        text = '- '
        if (faults(i)%group > 0) text = text//title_of(draft, faults(i)%group)
        if (faults(i)%entry > 0) text = text//', '//draft%groups(faults(i)%group)%entries(faults(i)%entry)%name
        if (faults(i)%group > 0) text = text//': '
        call conversation%say(text//faults(i)%message)
      end do
    end associate
    if (size(faults) > most_shown) call conversation%say('and '//to_text(size(faults) - most_shown)//' more')
  end subroutine show_faults

  !> Ask which answer to change after a check that failed. An empty answer takes the first answer that is wrong or
  !> missing; if there is none it takes the question with the label `otherwise`.
  subroutine offer_correction(conversation, faults, otherwise)
    class(conversation_type), intent(inout) :: conversation !< the conversation as it stands
    type(fault_type), intent(in) :: faults(:)         !< errors, each with its entry in the draft
    character(len=*), intent(in) :: otherwise         !< label of the question that Enter takes where no answer is known to be wrong
    type(string_type), allocatable :: words(:)
    character(len=:), allocatable :: line, proposal
    integer :: first, missing
    logical :: done

    words = correction_words('go', conversation%interview%draft)
    call find_first(conversation, faults, first, missing)
    proposal = otherwise(index(otherwise, '.') + 1:)
    if (missing > 0) proposal = label_of(conversation%interview%questions(missing))
    if (first > 0) proposal = 'answer '//to_text(first)
    conversation%shown = .true.
    call conversation%listen('  Enter for '//proposal//'; number of another answer; or go (on): ', words, line)
    if (conversation%state /= going) return
    select case (lower(line(:min(len(line), 8))))
    case ('?', 'help')
      call conversation%say(correction_help)
    case ('go')
      conversation%interview%return_to = ''
      call conversation%interview%step()
    case ('back')
      call conversation%interview%back(done)
    case ('')
      if (first > 0) then
        call change(conversation, to_text(first))
      else if (missing > 0) then
        call begin_correction(conversation, missing)
      else
        call take_otherwise(conversation, otherwise)
      end if
    case default
      call change(conversation, line)
    end select
  end subroutine offer_correction

  !> Go to the question with a label. After an answer about a name the conversation returns from there; from other
  !> questions it goes on in turn.
  subroutine take_otherwise(conversation, label)
    class(conversation_type), intent(inout) :: conversation !< the conversation as it stands
    character(len=*), intent(in) :: label             !< label of the question that Enter takes where no answer is known to be wrong
    integer :: number

    number = find_question(conversation%interview%questions, label)
    if (number == 0) then
      call conversation%say('Which one? list shows the numbers of the answers.')
    else if (number < conversation%interview%at .and. conversation%interview%questions(number)%kind /= ask_item) then
      conversation%interview%return_to = ''
      conversation%interview%at = number
    else
      call begin_correction(conversation, number)
    end if
  end subroutine take_otherwise

  !> The words that can be completed in a correction.
  pure function correction_words(first, draft) result(words)
    character(len=*), intent(in) :: first        !< a command beside those of all corrections; empty: none
    type(draft_type), intent(in) :: draft        !< the data file so far, whose names are offered, too
    type(string_type), allocatable :: words(:)
    character(len=6), parameter :: commands(5) = [character(len=6) :: 'add', 'remove', 'list', 'back', 'quit']
    integer :: i

    allocate (words(0))
    call add_word(first, words)
    do i = 1, size(commands)
      call add_word(trim(commands(i)), words)
    end do
    call add_known_names(draft, words)
  end function correction_words

  !> Find the first answer that is wrong, and the first question that lacks its answer; 0 if there is none.
  pure subroutine find_first(conversation, faults, first, missing)
    class(conversation_type), intent(in) :: conversation  !< the conversation as it stands
    type(fault_type), intent(in) :: faults(:)             !< errors, each with its entry in the draft
    integer, intent(out) :: first                         !< number of the first answer that is wrong; 0: none
    integer, intent(out) :: missing                       !< number of the first question that lacks its answer; 0: none
    integer :: i

    first = 0
    missing = 0
    associate (interview => conversation%interview)
      do i = 1, size(faults)
        first = number_of_entry(interview%draft, faults(i)%group, faults(i)%entry)
        if (first > 0) exit
      end do
      do missing = 1, interview%at - 1
        if (is_lacking(interview%questions(missing), interview%draft, interview%outline)) return
      end do
    end associate
    missing = 0
  end subroutine find_first

  !> Go to a question, and note that the conversation returns to the present one after it.
  subroutine begin_correction(conversation, number)
    class(conversation_type), intent(inout) :: conversation  !< the conversation as it stands
    integer, intent(in) :: number                            !< number of the question

    associate (interview => conversation%interview)
      if (interview%return_to == '') interview%return_to = label_of(interview%due())
      interview%at = number
    end associate
    conversation%heading = ''
  end subroutine begin_correction

  !> Carry out the request in a line. It changes an answer by its number or its name, at once if it has a value as in
  !> "time end = 2". It adds a group, or removes an answer or a group.
  subroutine change(conversation, line, done)
    class(conversation_type), intent(inout) :: conversation  !< the conversation as it stands
    character(len=*), intent(in) :: line                     !< the line that was typed
    logical, intent(out), optional :: done                   !< false where the line means none of these
    character(len=:), allocatable :: word
    logical :: found

    word = lower(line(:scan(line//' ', ' ') - 1))
    found = .true.
    if (word == 'add') then
      call add_group(conversation, trim(adjustl(line(len(word) + 1:))), found)
    else if (word == 'remove') then
      call remove(conversation, trim(adjustl(line(len(word) + 1:))), found)
    else if (line == word .and. word == 'change') then
      found = .false.
      call conversation%say('Say which answer: change time end = 2, or by its number, change 5; list shows them.')
    else if (word == 'change') then
      call change_answer(conversation, trim(adjustl(line(len(word) + 1:))), found)
    else
      call change_answer(conversation, line, found)
    end if
    ! the errors are not shown again if nothing was changed
    conversation%shown = .not. found
    if (present(done)) done = found
  end subroutine change

  !> Go to the question of a named answer, or note its new value at once.
  subroutine change_answer(conversation, line, found)
    class(conversation_type), intent(inout) :: conversation !< the conversation as it stands
    character(len=*), intent(in) :: line         !< number or name of the answer, with the value behind an equals sign or without it
    logical, intent(out) :: found                !< the line means an answer that can be changed
    character(len=:), allocatable :: group, name, which
    integer :: place, equals
    logical :: by_number

    found = .false.
    equals = index(line//'=', '=')
    which = trim(line(:equals - 1))
    conversation%heading = ''
    associate (interview => conversation%interview)
      call entry_meant(interview%draft, which, group, place, name, by_number)
      if (group /= '' .and. name /= '') call interview%correct(group, place, name, found)
    end associate
    if (found .and. equals < len(line)) then
      call take_answer(conversation, trim(adjustl(line(equals + 1:))))
    else if (by_number .and. .not. found) then
      call conversation%say('This program does not ask for that; "remove '//which//'" takes it away.')
    else if (.not. found) then
      call conversation%say('That is no answer that can be changed; list shows their numbers, ? tells more.')
    end if
  end subroutine change_answer

  !> Go to the first question of a new group.
  subroutine add_group(conversation, group, found)
    class(conversation_type), intent(inout) :: conversation  !< the conversation as it stands
    character(len=*), intent(in) :: group                    !< name of the group
    logical, intent(out) :: found                            !< such a group can be added
    integer :: i, row

    found = .true.
    row = find_group_row(group(:min(len(group), 20)))
    associate (interview => conversation%interview)
      if (lower(group(:min(len(group), 20))) == 'study' .and. interview%draft%count_of('parameter') == 0) then
        found = .false.
        call conversation%say('A study makes runs for values of parameters, and there are no parameters yet; begin with: '// &
                              'add parameter')
        return
      end if
      if (row > 0) then
        do i = 1, size(interview%questions)
          if (interview%questions(i)%group_row /= row .or. .not. interview%questions(i)%is_new) cycle
          call begin_correction(conversation, i)
          interview%adding = .true.
          return
        end do
      end if
    end associate
    found = .false.
    call conversation%say('What can be added: '//addable(conversation)//'; for example: add point')
  end subroutine add_group

  !> The names of the groups of which there can be any number.
  function addable(conversation) result(list)
    class(conversation_type), intent(in) :: conversation  !< the conversation as it stands
    character(len=:), allocatable :: list
    integer :: i

    list = ''
    do i = 1, size(conversation%interview%questions)
      associate (question => conversation%interview%questions(i))
        if (.not. question%is_new) cycle
        if (list /= '') list = list//', '
        list = list//trim(group_table(question%group_row)%name)
      end associate
    end do
  end function addable

  !> Remove an answer or a group.
  subroutine remove(conversation, what, found)
    class(conversation_type), intent(inout) :: conversation  !< the conversation as it stands
    character(len=*), intent(in) :: what                     !< number or name of the answer, or name and number of the group
    logical, intent(out) :: found                            !< there was something to remove
    type(draft_type) :: before
    character(len=:), allocatable :: group, name, here
    integer :: place

    associate (interview => conversation%interview)
      here = label_of(interview%due())
      call entry_meant(interview%draft, what, group, place, name)
      found = group /= ''
      if (found) found = interview%draft%find(group, place) > 0 .and. (name == '' .or. interview%draft%has(group, place, name))
      if (.not. found) then
        call conversation%say('There is no such answer to remove; list shows the numbers of the answers.')
        return
      end if
      before = interview%draft
      if (name == '') then
        call interview%draft%remove(group, place)
      else
        call interview%draft%take_away(group, place, name)
      end if
      if (interview%draft%count_of('mechanism') == 0) call interview%draft%add('mechanism')
      call interview%refresh(here)
      if (group == 'drive' .and. name == '') then
        ! without its drive a coordinate is free, and begins at a position and a rate that are asked for
        if (interview%return_to == '') interview%return_to = here
        call interview%step()
        interview%adding = interview%return_to /= ''
      end if
    end associate
    call conversation%keep()
    call conversation%say('Removed.')
    if (group == 'mechanism') call settle_units(conversation, before)
  end subroutine remove
end module mech9_correcting
