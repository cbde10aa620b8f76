!> Words while no row can follow, since other runs of a motion come first: how far the present one is on a terminal, and a line after
!> ten seconds.
module mech9_waiting_words
  use, intrinsic :: iso_fortran_env, only: error_unit
  use mech9_kinds, only: wp
  use mech9_text, only: to_text
  use mech9_clock, only: seconds, pacer_type
  use mech9_progress, only: progress_type
  use mech9_simulation, only: simulation_type
  use mech9_standing_text, only: standing_text
  implicit none
  private
  public :: waiting_words_type, first_words_after

  !> Time without a new row after which the user is told where the motion stands [s]; the next time comes after twice as long.
  real(wp), parameter :: first_words_after = 10.0_wp
  !> Interval at which a run is looked at [s].
  real(wp), parameter :: look_every = 0.25_wp

  !> The words of one program on runs whose rows are not recorded.
  type :: waiting_words_type
    private
    character(len=:), allocatable :: label   !< name of the program
    character(len=:), allocatable :: reason  !< purpose of the runs, as: that tells the accuracy
    logical :: quiet = .false.               !< nothing is to be said
    real(wp) :: started = 0.0_wp             !< [s]
    real(wp) :: words_after = first_words_after   !< time from the start to the next line [s]
    type(pacer_type) :: pacer
    type(progress_type) :: progress
  contains
    procedure :: start
    procedure :: look
    procedure :: finish
  end type waiting_words_type

contains

  !> Begin to wait.
  subroutine start(self, label, reason, quiet)
    class(waiting_words_type), intent(inout) :: self   !< the words
    character(len=*), intent(in) :: label              !< name of the program
    character(len=*), intent(in) :: reason             !< purpose of the runs, as: that tells the accuracy
    logical, intent(in) :: quiet                       !< nothing is to be said

    self%label = label
    self%reason = reason
    self%quiet = quiet
    self%started = seconds()
    self%words_after = first_words_after
    call self%pacer%start(look_every)
    call self%progress%start(label, quiet)
  end subroutine start

  !> Look at a run before one of its steps; the call is cheap enough for each of them.
  subroutine look(self, simulation)
    class(waiting_words_type), intent(inout) :: self       !< the words
    class(simulation_type), intent(inout) :: simulation    !< the run
    real(wp) :: part, waited
    integer :: status

    if (self%quiet .or. .not. simulation%started) return
    if (.not. self%pacer%due()) return
    associate (standing => simulation%standing(), time => simulation%model%request%time)
      part = 0.0_wp
      if (abs(time%end - time%start) > 0.0_wp) part = (standing%t - time%start)/(time%end - time%start)
      call self%progress%update(part, 'of a run '//self%reason)
      waited = seconds() - self%started
      if (waited < self%words_after) return
      call self%progress%clear()
      write (error_unit, '(a)') self%label//': no row yet after '//to_text(int(waited))//' s: a run '//self%reason// &
        ' is at '//standing_text(simulation%model, standing)
      flush (error_unit, iostat=status)
      self%words_after = 2.0_wp*self%words_after
    end associate
  end subroutine look

  !> Rows follow, or nothing does.
  subroutine finish(self)
    class(waiting_words_type), intent(inout) :: self   !< the words

    call self%progress%finish()
  end subroutine finish
end module mech9_waiting_words
