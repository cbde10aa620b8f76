!> Volume and inertia of solid shapes about their centres, in their own axes.
module mech9_shapes
  use mech9_kinds, only: wp
  implicit none
  private
  public :: solid_of, shape_names

  real(wp), parameter :: pi = acos(-1.0_wp)
  character(len=9), parameter :: shape_names(5) = [character(len=9) :: 'sphere', 'capsule', 'ellipsoid', 'cylinder', 'box']

contains

  !> Volume, and moments of inertia for a mass of one. Heights lie along z; that of a capsule is
  !> the height between its ends, which are half spheres.
  pure subroutine solid_of(shape, size, volume, moments)
    integer, intent(in) :: shape         !< place among the names of shapes
    real(wp), intent(in) :: size(3)      !< radius, and half the height; of ellipsoid and box half the extents along x, y, z [m]
    real(wp), intent(out) :: volume      !< [m^3]
    real(wp), intent(out) :: moments(3)  !< about x, y, z, divided by the mass [m^2]
    real(wp) :: r, h, share, squares(3)

    r = size(1)
    h = 2.0_wp*size(2)
    squares = size**2
    select case (shape_names(shape))
    case ('sphere')
      volume = 4.0_wp/3.0_wp*pi*r**3
      moments = 0.4_wp*r**2
    case ('capsule')
      volume = pi*r**2*(h + 4.0_wp/3.0_wp*r)
      share = 4.0_wp*r/max(4.0_wp*r + 3.0_wp*h, tiny(r))     ! of the two half spheres in the mass
      moments(1:2) = (1.0_wp - share)*(3.0_wp*r**2 + h**2)/12.0_wp + share*(0.4_wp*r**2 + h*(3.0_wp*r + 2.0_wp*h)/8.0_wp)
      moments(3) = (1.0_wp - share)*0.5_wp*r**2 + share*0.4_wp*r**2
    case ('cylinder')
      volume = pi*r**2*h
      moments = [(3.0_wp*r**2 + h**2)/12.0_wp, (3.0_wp*r**2 + h**2)/12.0_wp, 0.5_wp*r**2]
    case ('ellipsoid')
      volume = 4.0_wp/3.0_wp*pi*product(size)
      moments = (sum(squares) - squares)/5.0_wp
    case default
      volume = 8.0_wp*product(size)
      moments = (sum(squares) - squares)/3.0_wp
    end select
  end subroutine solid_of
end module mech9_shapes
