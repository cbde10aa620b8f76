!> The part of a conversation after a run: showing, plotting and comparing results, changing a value, and running again.
module mech9_after_run
  use, intrinsic :: iso_fortran_env, only: error_unit
  use mech9_program_kind, only: dynamics
  use mech9_error, only: error_type
  use mech9_text, only: string_type, lower, join
  use mech9_path, only: ending_of
  use mech9_diagnostics, only: printable
  use mech9_kept_rows, only: kept_rows_type
  use mech9_rows_text, only: rows_text, all_rows_text, head_of, columns_that_fit, all_digits
  use mech9_run_comparison, only: comparison_type, compare_runs, comparison_text
  use mech9_plot, only: plot_columns
  use mech9_part_names, only: number_columns
  use mech9_heading, only: new_heading
  use mech9_plot_request, only: is_picture
  use mech9_grammar, only: words_of
  use mech9_draft, only: draft_type, integer_of
  use mech9_known_names, only: add_known_names, add_word
  use mech9_conversation, only: conversation_type, going
  use mech9_correcting, only: change
  implicit none
  private
  public :: look_back, over, again, changing, answering

  !> The next step that the user wants: to end, to run again, to be asked for a value first, or an answer without a run.
  integer, parameter :: over = 0, again = 1, changing = 2, answering = 3

  !> The number of rows shown unless the user gives one, the largest such number, and the longest line that is read.
  integer, parameter :: usual_rows = 8, most_rows = 1000, longest_line = 500
  character(len=11), parameter :: commands(8) = [character(len=11) :: 'show', 'plot', 'compare', 'change', 'run', 'done', &
                                                 'equilibrium', 'modes']
  character(len=*), parameter :: help = &
    'show: the last rows of the table; "show 20 q1 P.x" shows twenty rows of these columns, "show P" of a point. '// &
    'plot: a plot here in the terminal; "plot q1,P.x", "plot P.x:P.y" (a path), "plot picture.svg:q1" (a file). '// &
    'compare: the largest differences from the run before. "change time end = 2" changes an answer; without the '// &
    'value you are asked for it; its number from list will do, too. run: run again. done ends.'
  character(len=*), parameter :: help_of_rest = &
    'equilibrium: the position in which the mechanism rests; "equilibrium 30" searches from 30 random positions, too. '// &
    'modes: frequencies, dampings and shapes of its small vibrations there. "equilibrium rest.svg" draws this position, too. '// &
    'show then gives all digits of the numbers; "show 8" shows rows of the run.'
  character(len=*), parameter :: help_of_study = &
    'study: the runs of the study of this file are made, and told in a summary. The option --study writes them to files.'

contains

  !> Read commands about a finished run and carry them out, until one of them asks for more than a look at results.
  subroutine look_back(conversation, kept, earlier, found, changed, next, request)
    class(conversation_type), intent(inout) :: conversation  !< the conversation as it stands
    type(kept_rows_type), intent(in) :: kept                 !< results of the last run; none where it gave none
    type(kept_rows_type), intent(in) :: earlier              !< results of the run before the last one
    type(kept_rows_type), intent(in) :: found                !< rows of an equilibrium or of modes since the last run; or none
    logical, intent(in) :: changed                           !< an answer was changed since the last run, so that Enter runs again
    integer, intent(out) :: next                             !< over, again, changing or answering
    character(len=:), allocatable, intent(out) :: request    !< the answer that is wanted: options of the command line
    type(string_type), allocatable :: words(:)
    character(len=:), allocatable :: line, word, rest, prompt
    logical :: done, with_rest, with_study

    with_rest = conversation%program == dynamics
    with_study = conversation%interview%draft%count_of('study') > 0
    call words_here(kept, conversation%interview%draft, with_rest, words)
    prompt = '  show, plot, compare, change, run or done'
    if (with_rest) prompt = '  show, plot, compare, equilibrium, modes, change, run or done'
    if (with_study) prompt = prompt(:index(prompt, 'change') - 1)//'study, '//prompt(index(prompt, 'change'):)
    request = ''
    if (changed) prompt = prompt//' [run]'
    rest = ''
    next = over
    do
      call conversation%listen(prompt//': ', words, line)
      if (conversation%state /= going) return
      if (line == '' .and. changed) line = 'run'
      line = line(:min(len(line), longest_line))
      word = lower(line(:scan(line//' ', ' ') - 1))
      rest = trim(adjustl(line(len(word) + 1:)))
      if (word == 'show' .or. word == 'plot') rest = with_points(kept, rest)
      select case (word)
      case ('')
        call conversation%say('done ends; ? tells more.')
      case ('done')
        return
      case ('?', 'help')
        call conversation%say(help)
        if (with_rest) call conversation%say(help_of_rest)
        if (with_study) call conversation%say(help_of_study)
        call say_columns(conversation, kept)
      case ('show')
        if (rest == '' .and. found%count > 0) then
          write (error_unit, '(a)', advance='no') all_rows_text(found, all_digits)
        else
          call show(conversation, kept, rest)
        end if
      case ('plot')
        call plot(conversation, kept, rest)
      case ('compare')
        call compare(conversation, kept, earlier)
      case ('run')
        next = again
      case default
        if (with_rest .and. (word == 'equilibrium' .or. word == 'modes')) then
          call ask_for_rest(conversation, word, rest, request)
          if (request /= '') next = answering
        else if (with_study .and. word == 'study' .and. rest == '') then
          request = '--study --no-write'
          next = answering
        else
          call change(conversation, line, done)
          if (done) next = changing
        end if
      end select
      if (next /= over) return
    end do
  end subroutine look_back

  !> Form the options of the command line that give an answer about equilibrium; none where the line is no such request.
  subroutine ask_for_rest(conversation, word, more, request)
    class(conversation_type), intent(in) :: conversation     !< the conversation as it stands
    character(len=*), intent(in) :: word                     !< equilibrium or modes
    character(len=*), intent(in) :: more                     !< the text behind it: a number of random starts, a sketch, or nothing
    character(len=:), allocatable, intent(out) :: request    !< the options, with blanks between
    character(len=len(more)), allocatable :: words(:)
    character(len=:), allocatable :: starts, sketch
    integer :: i

    words = words_of(more)
    starts = ''
    sketch = ' --no-write'
    do i = 1, size(words)
      if (word == 'equilibrium' .and. starts == '' .and. verify(trim(words(i)), '0123456789') == 0) then
        starts = ' --starts '//trim(words(i))
      else if (ending_of(trim(words(i))) == 'svg') then
        sketch = ' --sketch '//trim(words(i))
      else
        request = ''
        call conversation%say(help_of_rest)
        return
      end if
    end do
    request = '--'//word//starts//sketch
  end subroutine ask_for_rest

  !> List the words that can be completed: the commands, the columns by numbers and by names, and the names of the data file.
  pure subroutine words_here(kept, draft, with_rest, words)
    type(kept_rows_type), intent(in) :: kept                 !< results of the last run
    type(draft_type), intent(in) :: draft                    !< the data file
    logical, intent(in) :: with_rest                         !< the program answers about equilibrium
    type(string_type), allocatable, intent(out) :: words(:)  !< the commands and the names of the columns
    integer :: i

    allocate (words(0))
    do i = 1, size(commands) - merge(0, 2, with_rest)
      call add_word(trim(commands(i)), words)
    end do
    if (kept%count > 0) then
      do i = 1, size(kept%names)
        call add_word(kept%names(i)%text, words)
        call add_word(head_of(kept, i), words)
      end do
    end if
    call add_known_names(draft, words)
  end subroutine words_here

  !> Tell the user the names of the columns.
  subroutine say_columns(conversation, kept)
    class(conversation_type), intent(in) :: conversation  !< the conversation as it stands
    type(kept_rows_type), intent(in) :: kept              !< results of the last run

    type(string_type), allocatable :: heads(:)
    integer :: i

    if (kept%count == 0) return
    allocate (heads(size(kept%names)))
    do i = 1, size(heads)
      heads(i)%text = head_of(kept, i)
    end do
    call conversation%say('The columns: '//join(heads, ' '))
  end subroutine say_columns

  !> Whether there are results to look at. If there are none, tell the user.
  logical function has_rows(conversation, kept)
    class(conversation_type), intent(in) :: conversation  !< the conversation as it stands
    type(kept_rows_type), intent(in) :: kept              !< results of the last run

    has_rows = kept%count > 0
    if (.not. has_rows) call conversation%say('The run has no results to look at.')
  end function has_rows

  !> Show the last rows of some columns, as a text such as "20 q1 P.x" asks for.
  subroutine show(conversation, kept, what)
    class(conversation_type), intent(in) :: conversation !< the conversation as it stands
    type(kept_rows_type), intent(in) :: kept    !< results of the last run
    character(len=*), intent(in) :: what        !< the text behind the command: a number of rows and names of columns, each optional
    character(len=len(what)), allocatable :: words(:)
    integer, allocatable :: columns(:)
    integer :: i, rows

    if (.not. has_rows(conversation, kept)) return
    words = words_of(with_blanks(what))
    rows = usual_rows
    if (size(words) > 0) then
      if (verify(trim(words(1)), '0123456789') == 0) then
        rows = max(1, min(integer_of(trim(words(1))), most_rows))
        words = words(2:)
      end if
    end if
    columns = [1]
    do i = 1, size(words)
      call append_column(conversation, kept, trim(words(i)), columns)
      if (size(columns) == 0) return
    end do
    if (size(columns) == 1) columns = [(i, i=1, min(columns_that_fit, size(kept%names)))]
    write (error_unit, '(a)', advance='no') rows_text(kept, columns, rows)
  end subroutine show

  !> Append the column with a name to a list. The list becomes empty if there is no such column.
  subroutine append_column(conversation, kept, name, columns)
    class(conversation_type), intent(in) :: conversation  !< the conversation as it stands
    type(kept_rows_type), intent(in) :: kept              !< results of the last run
    character(len=*), intent(in) :: name                  !< name of the column
    integer, allocatable, intent(inout) :: columns(:)     !< numbers of the columns; none after an unknown name
    character(len=:), allocatable :: meant
    integer :: number

    call kept%column(name, number, meant)
    if (number > 1) then
      columns = [columns, number]
    else if (number == 0) then
      if (meant /= '') meant = '; did you mean '//meant//'?'
      call conversation%say('There is no column '''//printable(name, 40)//''''//meant)
      call say_columns(conversation, kept)
      deallocate (columns)
      allocate (columns(0))
    end if
  end subroutine append_column

  !> Draw a plot in the terminal, or a picture if one is named.
  subroutine plot(conversation, kept, what)
    class(conversation_type), intent(in) :: conversation  !< the conversation as it stands
    type(kept_rows_type), intent(in) :: kept              !< results of the last run
    character(len=*), intent(in) :: what                  !< the argument of --plot, with blanks or commas between names
    type(error_type), allocatable :: err
    type(string_type), allocatable :: labels(:)
    character(len=:), allocatable :: request, target, said
    integer :: i

    if (.not. has_rows(conversation, kept)) return
    labels = kept%names
    do i = 1, size(labels)
      labels(i)%text = head_of(kept, i)
    end do
    request = what
    call number_columns(kept%parts, request)
    do i = 1, len(request)
      if (request(i:i) == ' ') request(i:i) = ','
    end do
    target = request(:index(request//':', ':') - 1)
    if (.not. is_picture(target) .and. target /= 'term') request = 'term:'//request
    call plot_columns(request, new_heading(kept%title, kept%names, kept%units), labels, kept%rows(:, :kept%count), &
                      kept%events, conversation%stem//'.svg', said, err)
    if (allocated(err)) said = err%message
    if (said /= '') call conversation%say(said)
  end subroutine plot

  !> Show the largest differences between the last run and the run before.
  subroutine compare(conversation, kept, earlier)
    class(conversation_type), intent(in) :: conversation  !< the conversation as it stands
    type(kept_rows_type), intent(in) :: kept              !< results of the last run
    type(kept_rows_type), intent(in) :: earlier           !< results of the run before the last one
    type(comparison_type) :: comparison

    if (.not. has_rows(conversation, kept)) return
    if (earlier%count == 0) then
      call conversation%say('There is no run before this one yet: change a value and run again.')
      return
    end if
    call compare_runs(earlier, kept, comparison)
    write (error_unit, '(a)', advance='no') comparison_text(comparison, kept)
  end subroutine compare

  !> A list of columns, in which the name of a point becomes its three coordinates: "q1, P" becomes "q1,P.x,P.y,P.z".
  pure function with_points(kept, list) result(text)
    type(kept_rows_type), intent(in) :: kept  !< results of the last run
    character(len=*), intent(in) :: list      !< the text behind the command
    character(len=:), allocatable :: text, word
    character(len=len(list)), allocatable :: words(:)
    integer :: i

    text = list
    if (kept%count == 0 .or. index(list, ':') > 0) return
    words = words_of(with_blanks(list))
    text = ''
    do i = 1, size(words)
      if (i > 1) text = text//','
      word = trim(words(i))
      if (.not. is_column(kept, word) .and. is_column(kept, word//'.x')) word = word//'.x,'//word//'.y,'//word//'.z'
      text = text//word
    end do
  end function with_points

  !> Whether the results have a column with this name.
  pure logical function is_column(kept, name)
    type(kept_rows_type), intent(in) :: kept  !< results of the last run
    character(len=*), intent(in) :: name      !< name that is looked for
    character(len=:), allocatable :: numbered
    integer :: i

    is_column = .true.
    numbered = name
    call number_columns(kept%parts, numbered)
    do i = 1, size(kept%names)
      if (kept%names(i)%text == numbered) return
    end do
    is_column = .false.
  end function is_column

  !> A text with blanks instead of its commas.
  pure function with_blanks(text) result(plain)
    character(len=*), intent(in) :: text  !< words with blanks or commas between
    character(len=len(text)) :: plain
    integer :: i

    plain = text
    do i = 1, len(text)
      if (text(i:i) == ',') plain(i:i) = ' '
    end do
  end function with_blanks
end module mech9_after_run
