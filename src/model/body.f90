!> Inertia of a link.
module mech9_body
  use mech9_kinds, only: wp
  use mech9_error, only: place_type
  implicit none
  private
  public :: body_type

  !> Mass and inertia of one link.
  type :: body_type
    integer :: link = 0                  !< number of the link
    real(wp) :: mass = 0.0_wp            !< [kg]
    real(wp) :: centre(3) = 0.0_wp       !< mass centre in the link's system [m]
    real(wp) :: inertia(3, 3) = 0.0_wp   !< tensor about the centre, link axes [kg m^2]
    type(place_type) :: place            !< place of its group in the data file
  contains
    procedure :: has_inertia
  end type body_type

contains

  !> Whether the body resists any motion; a link may have inertia about its axis and no mass.
  pure logical function has_inertia(self)
    class(body_type), intent(in) :: self   !< the body

    has_inertia = self%mass > 0.0_wp .or. any(abs(self%inertia) > 0.0_wp)
  end function has_inertia
end module mech9_body
