!> The interruption of motions by the user of a program, the message on the place of a motion that takes long, and the line that tells how far
!> an answer is which needs many motions.
module mech9_signal_interruption
  use mech9_kinds, only: wp
  use mech9_text, only: to_text
  use mech9_clock, only: pacer_type
  use mech9_system, only: interrupted
  use mech9_simulation, only: simulation_type, interruption_type
  use mech9_waiting_words, only: waiting_words_type
  use mech9_progress, only: progress_type
  implicit none
  private
  public :: signal_interruption_type, answer_progress_type

  !> How far an answer is that needs motions.
  type :: answer_progress_type
    type(progress_type) :: line       !< on the terminal
    real(wp) :: share = 0.0_wp        !< part that is done, as far as it is known, from 0 to 1
    integer :: motions = 0            !< motions that were begun
  end type answer_progress_type

  !> A motion stops where the user interrupts the program, or for a pause.
  type, extends(interruption_type) :: signal_interruption_type
    type(pacer_type), pointer :: pause => null()   !< not owned; where it is associated, a motion stops when this is due
    type(waiting_words_type) :: words              !< tell of the motion; they say nothing unless they are started
    type(answer_progress_type), pointer :: progress => null()   !< not owned; where it is associated, its line is shown
  contains
    procedure :: is_wanted
    procedure :: begin_run
    procedure :: watch
    procedure :: tell
  end type signal_interruption_type

contains

  !> Whether the user has interrupted the program, or a pause is due.
  logical function is_wanted(self)
    class(signal_interruption_type), intent(in) :: self   !< asks the operating system

    is_wanted = interrupted()
    if (.not. is_wanted .and. associated(self%pause)) is_wanted = self%pause%due()
  end function is_wanted

  !> Let the words begin to wait for another run.
  subroutine begin_run(self, number)
    class(signal_interruption_type), intent(inout) :: self   !< the interruption
    integer, intent(in), optional :: number                  !< of the run in a study

    call self%words%begin_run(number)
  end subroutine begin_run

  !> Let the words tell where a motion stands.
  subroutine watch(self, simulation)
    class(signal_interruption_type), intent(inout) :: self  !< the interruption
    class(simulation_type), intent(inout) :: simulation     !< the motion

    call self%words%look(simulation)
    if (.not. associated(self%progress)) return
    associate (progress => self%progress)
      if (.not. simulation%started) progress%motions = progress%motions + 1
      if (progress%motions > 1) then
        call progress%line%update(progress%share, 'motion '//to_text(progress%motions))
      else
        call progress%line%update(progress%share)
      end if
    end associate
  end subroutine watch

  !> Note how far the answer is.
  subroutine tell(self, share)
    class(signal_interruption_type), intent(inout) :: self  !< the interruption
    real(wp), intent(in) :: share                           !< part that is done, from 0 to 1

    if (associated(self%progress)) self%progress%share = share
  end subroutine tell
end module mech9_signal_interruption
