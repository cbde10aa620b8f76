!> Stand-ins for the tests of simulations: an interruption at a given question, and a motion whose chains are said to be open.
module simulation_doubles
  use mech9_kinds, only: wp
  use mech9_simulation, only: interruption_type
  use mech9_driven_simulation, only: driven_simulation_type
  implicit none
  private
  public :: countdown_type, open_chains_type

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

contains

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
