!> Volumes and moments of solid shapes against integrals over their slices, and against each other in their limits.
module test_shapes
  use mech9_kinds, only: wp
  use mech9_shapes, only: solid_of, shape_names
  use mech9_xml_values, only: place_in
  use mech9_testing, only: tester_type
  implicit none
  private
  public :: run

  real(wp), parameter :: pi = acos(-1.0_wp)
  !> Sums of some twenty products, each rounded.
  real(wp), parameter :: tol = 1.0e-13_wp

contains

  !> Run the cases of this suite.
  subroutine run(tester)
    type(tester_type), intent(inout) :: tester   !< selects cases and counts their checks

    if (tester%runs('round_shapes')) call round_shapes(tester)
    if (tester%runs('ellipsoid_and_box')) call ellipsoid_and_box(tester)
    if (tester%runs('limits')) call limits(tester)
  end subroutine run

  subroutine solid(name, size, volume, moments)
    character(len=*), intent(in) :: name       !< name of the shape
    real(wp), intent(in) :: size(3)            !< its measures [m]
    real(wp), intent(out) :: volume            !< [m^3]
    real(wp), intent(out) :: moments(3)        !< for a mass of one [m^2]

    call solid_of(place_in(shape_names, name), size, volume, moments)
  end subroutine solid

  !> Add the slices of a body of revolution between two heights. The square of its radius is a polynomial of the second degree, so
  !> that the formula of Gauss with three points is exact.
  subroutine add_slices(from, to, square, sums)
    real(wp), intent(in) :: from            !< lower end [m]
    real(wp), intent(in) :: to              !< upper end [m]
    real(wp), intent(in) :: square(3)       !< coefficients of 1, z, z^2 in the square of the radius
    real(wp), intent(inout) :: sums(3)      !< gets volume, moment about x and about z for a density of one
    real(wp), parameter :: nodes(3) = [-sqrt(0.6_wp), 0.0_wp, sqrt(0.6_wp)], weights(3) = [5.0_wp, 8.0_wp, 5.0_wp]/18.0_wp
    real(wp) :: z, s
    integer :: i

    do i = 1, 3
      z = 0.5_wp*(from + to) + 0.5_wp*(to - from)*nodes(i)
      s = square(1) + square(2)*z + square(3)*z**2
      sums = sums + weights(i)*(to - from)*[pi*s, 0.25_wp*pi*s**2 + pi*s*z**2, 0.5_wp*pi*s**2]
    end do
  end subroutine add_slices

  subroutine round_shapes(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    real(wp), parameter :: r = 0.7_wp, h = 0.9_wp   ! radius, and half the height
    real(wp) :: sums(3)

    sums = 0.0_wp
    call add_slices(-r, r, [r**2, 0.0_wp, -1.0_wp], sums)
    call compare('sphere', [r, 0.0_wp, 0.0_wp], sums)
    sums = 0.0_wp
    call add_slices(-h, h, [r**2, 0.0_wp, 0.0_wp], sums)
    call compare('cylinder', [r, h, 0.0_wp], sums)
    call add_slices(h, h + r, [r**2 - h**2, 2.0_wp*h, -1.0_wp], sums)
    call add_slices(-h - r, -h, [r**2 - h**2, -2.0_wp*h, -1.0_wp], sums)
    call compare('capsule', [r, h, 0.0_wp], sums)
  contains
    subroutine compare(name, size, sums)
      character(len=*), intent(in) :: name   !< name of the shape
      real(wp), intent(in) :: size(3)        !< its measures [m]
      real(wp), intent(in) :: sums(3)        !< volume, moments about x and z, for a density of one
      real(wp) :: volume, moments(3)

      call solid(name, size, volume, moments)
      call tester%near(volume, sums(1), tol, 'volume of the '//name)
      call tester%near(moments(1), sums(2)/sums(1), tol, 'moment of the '//name//' about x')
      call tester%near(moments(2), sums(2)/sums(1), tol, 'moment of the '//name//' about y')
      call tester%near(moments(3), sums(3)/sums(1), tol, 'moment of the '//name//' about z')
    end subroutine compare
  end subroutine round_shapes

  !> The mean of x^2 over the mass is a^2/5 in an ellipsoid and a^2/3 in a box; a moment is the sum of two such means.
  subroutine ellipsoid_and_box(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    real(wp), parameter :: a(3) = [0.3_wp, 0.5_wp, 1.1_wp]
    real(wp) :: volume, moments(3)
    integer :: i, j, k

    do i = 1, 3
      j = modulo(i, 3) + 1
      k = modulo(j, 3) + 1
      call solid('ellipsoid', a, volume, moments)
      call tester%near(volume, 4.0_wp*pi/3.0_wp*a(1)*a(2)*a(3), tol, 'volume of the ellipsoid')
      call tester%near(moments(i), a(j)**2/5.0_wp + a(k)**2/5.0_wp, tol, 'moment of the ellipsoid')
      call solid('box', a, volume, moments)
      call tester%near(volume, 8.0_wp*a(1)*a(2)*a(3), tol, 'volume of the box')
      call tester%near(moments(i), a(j)**2/3.0_wp + a(k)**2/3.0_wp, tol, 'moment of the box')
    end do
  end subroutine ellipsoid_and_box

  !> A capsule without height and an ellipsoid with equal axes are spheres.
  subroutine limits(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    real(wp), parameter :: r = 1.3_wp
    real(wp) :: volume, moments(3), ball, same(3)
    integer :: i

    call solid('sphere', [r, 0.0_wp, 0.0_wp], ball, same)
    call solid('capsule', [r, 0.0_wp, 0.0_wp], volume, moments)
    call tester%near(volume, ball, tol, 'volume of a capsule without height')
    do i = 1, 3
      call tester%near(moments(i), same(i), tol, 'moments of a capsule without height')
    end do
    call solid('ellipsoid', [r, r, r], volume, moments)
    call tester%near(volume, ball, tol, 'volume of a round ellipsoid')
    do i = 1, 3
      call tester%near(moments(i), same(i), tol, 'moments of a round ellipsoid')
    end do
  end subroutine limits
end module test_shapes
