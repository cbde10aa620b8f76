!> The interruption of motions by the user of a program, and the message on the place of a motion that takes long.
module mech9_signal_interruption
  use mech9_clock, only: pacer_type
  use mech9_system, only: interrupted
  use mech9_simulation, only: simulation_type, interruption_type
  use mech9_waiting_words, only: waiting_words_type
  implicit none
  private
  public :: signal_interruption_type

  !> A motion stops where the user interrupts the program, or for a pause.
  type, extends(interruption_type) :: signal_interruption_type
    type(pacer_type), pointer :: pause => null()   !< not owned; where it is associated, a motion stops when this is due
    type(waiting_words_type) :: words              !< tell of the motion; they say nothing unless they are started
  contains
    procedure :: is_wanted
    procedure :: begin_run
    procedure :: watch
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
  end subroutine watch
end module mech9_signal_interruption
