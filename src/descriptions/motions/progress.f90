!> A line on a terminal that tells how far a run is and how long it will take.
module mech9_progress
  use, intrinsic :: iso_fortran_env, only: error_unit
  use mech9_kinds, only: wp
  use mech9_text, only: to_text
  use mech9_clock, only: pacer_type, seconds
  use mech9_system, only: is_terminal, standard_error
  implicit none
  private
  public :: progress_type, progress_line

  !> Letters of the line; the last column of an 80-column terminal stays free, where some wrap.
  integer, parameter :: line_width = 79
  !> Time after which the progress of a run is shown, and the interval at which it is shown again [s].
  real(wp), parameter :: first_line_after = 1.0_wp, line_every = 0.25_wp

  !> The progress of one run.
  type :: progress_type
    private
    character(len=:), allocatable :: label
    real(wp) :: started = 0.0_wp       !< [s]
    logical :: active = .false.    !< whether progress is shown
    logical :: shown = .false.     !< whether a line stands on the terminal
    type(pacer_type) :: pacer
  contains
    procedure :: start
    procedure :: update
    procedure :: clear
    procedure :: say
    procedure :: finish
  end type progress_type

contains

  !> Begin. Nothing is shown if standard error is not a terminal, or with --quiet.
  subroutine start(self, label, quiet)
    class(progress_type), intent(inout) :: self   !< the progress
    character(len=*), intent(in) :: label         !< name of the run
    logical, intent(in) :: quiet                  !< nothing is to be shown

    self%label = label
    self%shown = .false.
    self%active = .false.
    if (.not. quiet) self%active = is_terminal(standard_error)
    if (.not. self%active) return
    self%started = seconds()
    call self%pacer%start(line_every)
  end subroutine start

  !> Show the progress; the call is cheap enough for each position.
  subroutine update(self, fraction, note, found)
    class(progress_type), intent(inout) :: self      !< the progress
    real(wp), intent(in) :: fraction                 !< 0 to 1
    character(len=*), intent(in), optional :: note   !< a few words behind the time left; none if absent
    real(wp), intent(in), optional :: found          !< part of the fraction that was done before; 0 if absent
    real(wp) :: elapsed
    integer :: status

    if (.not. self%active) return
    if (.not. self%pacer%due()) return
    elapsed = seconds() - self%started
    if (elapsed < first_line_after) return
    ! the cursor goes back to the beginning, so that the echo of Ctrl-C by the terminal does not begin another line
    write (error_unit, '(3a)', advance='no', iostat=status) achar(13), &
      progress_line(self%label, fraction, elapsed, note, found), achar(13)
    flush (error_unit, iostat=status)
    self%shown = .true.
  end subroutine update

  !> Remove the line until the next update; this is called before any other output on the terminal.
  subroutine clear(self)
    class(progress_type), intent(inout) :: self   !< the progress
    integer :: status

    if (self%shown) then
      write (error_unit, '(3a)', advance='no', iostat=status) achar(13), repeat(' ', line_width), achar(13)
      flush (error_unit, iostat=status)
    end if
    self%shown = .false.
  end subroutine clear

  !> Write a sentence in place of the line; the line may be that of another progress on the same terminal.
  subroutine say(self, sentence)
    class(progress_type), intent(inout) :: self   !< the progress
    character(len=*), intent(in) :: sentence      !< the sentence
    integer :: status

    self%shown = self%active
    call self%clear()
    write (error_unit, '(a)', iostat=status) sentence
    flush (error_unit, iostat=status)
  end subroutine say

  !> Remove the line for good.
  subroutine finish(self)
    class(progress_type), intent(inout) :: self   !< the progress

    call self%clear()
    self%active = .false.
  end subroutine finish

  !> The line: label, share done, a bar, the time left if the run goes on as it went so far, and a note.
  pure function progress_line(label, fraction, elapsed, note, found) result(line)
    character(len=*), intent(in) :: label            !< name of the run
    real(wp), intent(in) :: fraction                 !< 0 to 1; less or more is taken as that
    real(wp), intent(in) :: elapsed                  !< since the start [s]
    character(len=*), intent(in), optional :: note   !< a few words at the end; none if absent
    real(wp), intent(in), optional :: found          !< part of the fraction that was done before; 0 if absent
    character(len=line_width) :: line
    integer, parameter :: bar_width = 24
    character(len=:), allocatable :: left
    character(len=6) :: percent
    real(wp) :: share, done
    integer :: filled

    share = max(0.0_wp, min(1.0_wp, fraction))
    filled = nint(bar_width*share)
    done = share
    if (present(found)) done = share - found
    left = ''
    if (done > 1.0e-6_wp) left = time_text(elapsed*((1.0_wp - share)/done))//' left'
    if (present(note) .and. left /= '') left = left//'  '
    if (present(note)) left = left//note
    write (percent, '(i4,a)') int(100.0_wp*share), ' %'
    line = label(:min(len(label), 24))//percent//' ['//repeat('#', filled)//repeat('.', bar_width - filled)//']  '//left
  end function progress_line

  !> A time as `4 s`, `1:05` (minutes) or `2:01:05` (hours).
  pure function time_text(time) result(text)
    real(wp), intent(in) :: time   !< [s]
    character(len=:), allocatable :: text
    character(len=24) :: buffer
    integer :: whole, hours, minutes

    ! more than a hundred days are shown as a hundred, which fit into an integer
    whole = int(min(time, 8640000.0_wp))
    hours = whole/3600
    minutes = mod(whole, 3600)/60
    if (hours > 0) then
      write (buffer, '(i0,2(a,i2.2))') hours, ':', minutes, ':', mod(whole, 60)
    else if (minutes > 0) then
      write (buffer, '(i0,a,i2.2)') minutes, ':', mod(whole, 60)
    else
      buffer = to_text(whole)//' s'
    end if
    text = trim(buffer)
  end function time_text
end module mech9_progress
