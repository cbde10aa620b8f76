!> Words while a run goes on without new rows: a line after ten seconds that tells the place of its motion.
module mech9_waiting_words
  use mech9_kinds, only: wp
  use mech9_text, only: to_text
  use mech9_clock, only: seconds, pacer_type
  use mech9_progress, only: progress_type
  use mech9_program_kind, only: program_names
  use mech9_simulation, only: simulation_type
  use mech9_standing_text, only: standing_text
  implicit none
  private
  public :: waiting_words_type, first_words_after

  !> Time without a new row after which the user is told where the motion stands [s]; the next time comes after twice as long.
  real(wp), parameter :: first_words_after = 10.0_wp
  !> Interval at which a run is looked at [s].
  real(wp), parameter :: look_every = 0.25_wp

  !> The words on runs whose rows are not recorded.
  type :: waiting_words_type
    private
    character(len=:), allocatable :: missing   !< the result that is missing, as: no row yet
    character(len=:), allocatable :: subject   !< the run, as: a run that tells the accuracy
    logical :: quiet = .true.                  !< nothing is to be said
    logical :: with_progress = .false.         !< a terminal shows how far the run is
    real(wp) :: started = 0.0_wp               !< [s]
    real(wp) :: words_after = first_words_after   !< time from the start to the next line [s]
    type(pacer_type) :: pacer
    type(progress_type) :: progress
  contains
    procedure :: start
    procedure :: begin_run
    procedure :: look
    procedure :: finish
  end type waiting_words_type

contains

  !> Begin to wait.
  subroutine start(self, program, missing, subject, quiet, with_progress)
    class(waiting_words_type), intent(inout) :: self   !< the words
    integer, intent(in) :: program                     !< kinematics or dynamics
    character(len=*), intent(in) :: missing            !< the result that is missing, as: no row yet
    character(len=*), intent(in) :: subject            !< the run, as: a run that tells the accuracy
    logical, intent(in) :: quiet                       !< nothing is to be said
    logical, intent(in) :: with_progress               !< a terminal shows how far the run is

    self%quiet = quiet
    if (quiet) return
    self%missing = missing
    self%subject = subject
    self%with_progress = with_progress
    call self%progress%start(program_names(program), .false.)
    call self%begin_run()
  end subroutine start

  !> Begin to wait for another run.
  subroutine begin_run(self, number)
    class(waiting_words_type), intent(inout) :: self   !< the words
    integer, intent(in), optional :: number            !< of the run in a study

    if (self%quiet) return
    if (present(number)) self%missing = 'no result of run '//to_text(number)
    self%started = seconds()
    self%words_after = first_words_after
    call self%pacer%start(look_every)
  end subroutine begin_run

  !> Look at a run before one of its steps; the call is cheap enough for each of them.
  subroutine look(self, simulation)
    class(waiting_words_type), intent(inout) :: self       !< the words
    class(simulation_type), intent(inout) :: simulation    !< the run
    real(wp) :: part, waited

    if (self%quiet .or. .not. simulation%started) return
    if (.not. self%pacer%due()) return
    associate (model => simulation%model, standing => simulation%standing())
      associate (time => model%request%time)
        part = 0.0_wp
        if (abs(time%end - time%start) > 0.0_wp) part = (standing%t - time%start)/(time%end - time%start)
      end associate
      if (self%with_progress) call self%progress%update(part, 'of '//self%subject)
      waited = seconds() - self%started
      if (waited < self%words_after) return
      call self%progress%say(program_names(model%program)//': '//self%missing//' after '//to_text(int(waited))//' s: '// &
                             self%subject//' is at '//standing_text(model, standing))
      self%words_after = 2.0_wp*self%words_after
    end associate
  end subroutine look

  !> End the waiting: the result is there, or there will be none.
  subroutine finish(self)
    class(waiting_words_type), intent(inout) :: self   !< the words

    call self%progress%finish()
  end subroutine finish
end module mech9_waiting_words
