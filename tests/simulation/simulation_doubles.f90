!> Stand-ins for the tests of simulations: an interruption at a given question, a motion whose chains are said to be open, and a
!> drive that jumps.
module simulation_doubles
  use mech9_kinds, only: wp
  use mech9_error, only: error_type
  use mech9_law, only: law_type
  use mech9_simulation, only: interruption_type
  use mech9_driven_simulation, only: driven_simulation_type
  implicit none
  private
  public :: countdown_type, open_chains_type, jumping_drive_type

  !> Interrupts once, when the count of questions comes down to zero.
  type, extends(interruption_type) :: countdown_type
    integer, pointer :: left => null()   !< questions until then
  contains
    procedure :: is_wanted
  end type countdown_type

  !> A driven motion with a closure error of its own.
  type, extends(driven_simulation_type) :: open_chains_type
    real(wp) :: gap = 0.0_wp             !< [m]
  contains
    procedure :: present_closure
  end type open_chains_type

  !> A drive with a constant rate, and a jump of its position.
  type, extends(law_type) :: jumping_drive_type
    real(wp) :: rate = 0.0_wp            !< [rad/s, m/s]
    real(wp) :: t = 0.0_wp               !< of the jump [s]
    real(wp) :: height = 0.0_wp          !< of the jump [rad, m]
  contains
    procedure :: evaluate
  end type jumping_drive_type

contains

  !> The position with its jump.
  subroutine evaluate(self, t, q, dq, ddq, err)
    class(jumping_drive_type), intent(in) :: self       !< the drive
    real(wp), intent(in) :: t                           !< time [s]
    real(wp), intent(out) :: q                          !< the coordinate [rad, m]
    real(wp), intent(out) :: dq                         !< its rate [rad/s, m/s]
    real(wp), intent(out) :: ddq                        !< its acceleration [rad/s^2, m/s^2]
    type(error_type), allocatable, intent(out) :: err   !< never allocated

    q = self%rate*t + merge(self%height, 0.0_wp, t > self%t)
    dq = self%rate
    ddq = 0.0_wp
  end subroutine evaluate

  !> Whether this is the question that is answered with yes.
  logical function is_wanted(self)
    class(countdown_type), intent(in) :: self   !< counts its questions

    self%left = self%left - 1
    is_wanted = self%left == 0
  end function is_wanted

  !> The closure error that was set.
  real(wp) function present_closure(self)
    class(open_chains_type), intent(in) :: self   !< the simulation

    present_closure = self%gap
  end function present_closure
end module simulation_doubles
