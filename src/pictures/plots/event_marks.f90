!> Marks of events in plots over the time: a thin line at each, and a symbol of its kind on the axis; of many events short ticks
!> alone. Events of one kind that are near each other share a mark.
!>
!> In an SVG each symbol tells its event to who points at it. gnuplot writes such texts for a script of its own, which the picture does
!> not have; they become titles, which every browser shows.
module mech9_event_marks
  use mech9_kinds, only: wp
  use mech9_counted, only: counted
  use mech9_error, only: error_type
  use mech9_text, only: to_text
  use mech9_file_bytes, only: read_bytes
  use mech9_text_file, only: replace_text
  use mech9_event_words, only: told_events_type
  use mech9_motion_event, only: motion_event_type, event_impact, event_close, event_open, &
    event_stick, event_slip, event_lift
  use mech9_gnuplot, only: quoted
  implicit none
  private
  public :: event_marks, event_key, no_marks, turn_hypertexts_into_titles

  character, parameter :: line_end = achar(10)
  !> The kinds of events, with the numbers of their symbols in gnuplot and the colours of these.
  character(len=*), parameter :: kinds(6) = [event_impact, event_close, event_open, event_lift, event_stick, event_slip]
  integer, parameter :: symbols(6) = [9, 5, 4, 8, 7, 6]
  character(len=7), parameter :: colours(6) = [character(len=7) :: '#d55e00', '#000000', '#000000', '#d55e00', '#0072b2', '#0072b2']
  character(len=*), parameter :: thin_line = '#aaaaaa'
  !> Of more events there are ticks alone. Marks of one kind are apart by this part of the axis.
  integer, parameter :: most_lines = 40
  real(wp), parameter :: least_apart = 1.0_wp/400
  !> The command that removes the marks before a panel that is not over the time.
  character(len=*), parameter :: no_marks = 'unset arrow; unset label'//line_end
  !> A text of gnuplot for the pointer, as an SVG has it.
  character(len=*), parameter :: before_text = '<g onmousemove="gnuplot_svg.showHypertext(evt,''', &
    behind_text = ''')" onmouseout="gnuplot_svg.hideHypertext()"><title> </title>'

contains

  !> The commands that mark the events within a range of the time. Each mark that stands for several events tells the first one.
  pure function event_marks(events, ends) result(text)
    type(told_events_type), intent(in) :: events     !< the events of the run
    real(wp), intent(in) :: ends(2)                  !< first and last time on the axis [s]
    character(len=:), allocatable :: text
    logical :: lines
    integer :: kind, i, first, more

    text = ''
    lines = count([(is_within(events%items(i), ends), i=1, events%count)]) <= most_lines
    do kind = 1, size(kinds)
      first = 0
      more = 0
      do i = 1, events%count
        if (events%items(i)%kind /= kinds(kind) .or. .not. is_within(events%items(i), ends)) cycle
        if (first > 0) then
          if (events%items(i)%t - events%items(first)%t < least_apart*(ends(2) - ends(1))) then
            more = more + 1
            cycle
          end if
        end if
        if (first > 0) text = text//mark(events%items(first), events%sentences(first)%text, more, kind, lines)
        first = i
        more = 0
      end do
      if (first > 0) text = text//mark(events%items(first), events%sentences(first)%text, more, kind, lines)
    end do
  end function event_marks

  !> Whether an event is on the axis.
  pure logical function is_within(event, ends)
    type(motion_event_type), intent(in) :: event   !< the event
    real(wp), intent(in) :: ends(2)                !< first and last time on the axis [s]

    is_within = event%t >= ends(1) .and. event%t <= ends(2)
  end function is_within

  !> The commands for one mark.
  pure function mark(event, sentence, more, kind, lines) result(text)
    type(motion_event_type), intent(in) :: event   !< the event
    character(len=*), intent(in) :: sentence       !< words about it
    integer, intent(in) :: more                    !< how many others the mark stands for
    integer, intent(in) :: kind                    !< number of its kind
    logical, intent(in) :: lines                   !< there is room for a line, else for a tick
    character(len=:), allocatable :: text, at, words, look
    character(len=3) :: size

    at = to_text(event%t, 10)//', graph '
    words = 't = '//to_text(event%t, 8)//' s: '//sentence
    if (more > 0) words = words//', and '//counted(more, 'more event')//' of this kind'
    if (lines) then
      look = '1 nohead back lc rgb '''//thin_line//''' lw 0.8 dt 2'
      size = '1.0'
    else
      look = '0.03 nohead front lc rgb '''//colours(kind)//''' lw 1.5'
      size = '0.4'
    end if
    text = 'set arrow from '//at//'0 to '//at//look//line_end// &
           'set label '//quoted(words)//' at '//at//'0 hypertext point pt '//to_text(symbols(kind))//' ps '//size// &
           ' lc rgb '''//colours(kind)//''' front'//line_end
  end function mark

  !> The parts of a plot command that explain the symbols of events in the key; each begins with a comma.
  pure function event_key(events, ends) result(text)
    type(told_events_type), intent(in) :: events     !< the events of the run
    real(wp), intent(in) :: ends(2)                  !< first and last time on the axis [s]
    character(len=:), allocatable :: text
    integer :: kind, i

    text = ''
    do kind = 1, size(kinds)
      if (.not. any([(events%items(i)%kind == kinds(kind) .and. is_within(events%items(i), ends), i=1, events%count)])) cycle
      text = text//', \'//line_end//'     NaN with points pt '//to_text(symbols(kind))//' ps 1 lc rgb '''//colours(kind)// &
             ''' title '''//trim(kinds(kind))//''''
    end do
  end function event_key

  !> Turn the texts for the pointer in an SVG of gnuplot into titles. Fails with exit_file.
  subroutine turn_hypertexts_into_titles(picture, err)
    character(len=*), intent(in) :: picture            !< file of the picture
    type(error_type), allocatable, intent(out) :: err  !< allocated if it failed
    character(len=:), allocatable :: text, titled
    integer :: at, from, length

    call read_bytes(picture, text, err)
    if (allocated(err)) return
    titled = ''
    from = 1
    do
      at = index(text(from:), before_text)
      if (at == 0) exit
      titled = titled//text(from:from + at - 2)//'<g><title>'
      from = from + at - 1 + len(before_text)
      length = index(text(from:), behind_text) - 1
      if (length < 0) return
      titled = titled//text(from:from + length - 1)//'</title>'
      from = from + length + len(behind_text)
    end do
    if (from > 1) call replace_text(picture, titled//text(from:), err)
  end subroutine turn_hypertexts_into_titles
end module mech9_event_marks
