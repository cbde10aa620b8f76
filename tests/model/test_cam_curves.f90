!> Motion laws of cams: they lead from 0 to 1 symmetrically, their derivatives are those of their way, and their steepest slopes are
!> those of textbooks.
module test_cam_curves
  use mech9_kinds, only: wp, pi
  use mech9_differentiation, only: half_width, derivatives_from_stencil
  use mech9_cam_curves, only: curve_number, cam_curve, cam_third, steepest_slope_of, curve_names, find_inner_joints, &
    most_inner_joints
  use mech9_testing, only: tester_type
  implicit none
  private
  public :: run

contains

  !> Run the cases of this suite.
  subroutine run(test)
    type(tester_type), intent(inout) :: test   !< selects cases and counts their checks

    if (test%runs('names')) call names(test)
    if (test%runs('ends')) call ends(test)
    if (test%runs('derivatives')) call derivatives(test)
    if (test%runs('joints')) call joints(test)
    if (test%runs('slopes')) call slopes(test)
    if (test%runs('polynomials')) call polynomials(test)
  end subroutine run

  !> Each law is found under its name.
  subroutine names(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    integer :: k

    do k = 1, size(curve_names)
      call test%is_true(curve_number(curve_names(k)) == k, trim(curve_names(k))//' is found')
    end do
    call test%is_true(curve_number('spline') == 0, 'an unknown name has no number')
  end subroutine names

  !> Way 0 and 1 at the ends, half of it in the middle, s(1 - x) = 1 - s(x), and slopes alike. A dwell stays.
  subroutine ends(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    real(wp) :: s(2), ds(2), dds(2), x
    integer :: k, i

    do k = 1, size(curve_names)
      if (curve_names(k) == 'dwell') then
        call cam_curve(k, 0.7_wp, s(1), ds(1), dds(1))
        call test%near(maxval(abs([s(1), ds(1), dds(1)])), 0.0_wp, 0.0_wp, 'a dwell stays')
        cycle
      end if
      call cam_curve(k, 0.0_wp, s(1), ds(1), dds(1))
      call cam_curve(k, 1.0_wp, s(2), ds(2), dds(2))
      ! a few roundings of numbers of order one
      call test%near(s(1), 0.0_wp, 1.0e-15_wp, trim(curve_names(k))//' begins at 0')
      call test%near(s(2), 1.0_wp, 1.0e-15_wp, trim(curve_names(k))//' ends at 1')
      if (curve_names(k) /= 'constant-velocity') &
        call test%near(maxval(abs(ds)), 0.0_wp, 1.0e-14_wp, trim(curve_names(k))//' rests at its ends')
      do i = 1, 49
        x = 0.01_wp*i
        call cam_curve(k, x, s(1), ds(1), dds(1))
        call cam_curve(k, 1.0_wp - x, s(2), ds(2), dds(2))
        call test%near(s(1) + s(2), 1.0_wp, 1.0e-14_wp, trim(curve_names(k))//' is symmetric')
        call test%near(ds(1), ds(2), 1.0e-12_wp, trim(curve_names(k))//': slopes are')
        call test%near(dds(1), -dds(2), 1.0e-12_wp, trim(curve_names(k))//': curvatures are')
      end do
    end do
  end subroutine ends

  !> Derivatives against differences at places between the joints of the laws, which lie at multiples of 1/8.
  subroutine derivatives(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    real(wp), parameter :: h = 1.0_wp/256.0_wp
    real(wp) :: values(3, -half_width:half_width), first, second, third, error, x
    integer :: k, i, j

    do k = 1, size(curve_names)
      do j = 0, 7
        x = (j + 0.5_wp)/8.0_wp
        do i = -half_width, half_width
          call cam_curve(k, x + i*h, values(1, i), values(2, i), values(3, i))
        end do
        call derivatives_from_stencil(values(1, :), h, first, second, error)
        ! round-off 2/h and 8/h^2 of numbers up to ten
        call test%near(values(2, 0), first, 1.0e-12_wp, trim(curve_names(k))//': the slope')
        call test%near(values(3, 0), second, 1.0e-9_wp, trim(curve_names(k))//': the curvature')
        call derivatives_from_stencil(values(3, :), h, third, second, error)
        call test%near(cam_third(k, x), third, 1.0e-10_wp, trim(curve_names(k))//': the third derivative')
      end do
    end do
  end subroutine derivatives

  !> Fourth derivatives jump at the inner joints, and at no other multiple of 1/16 within the law.
  subroutine joints(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    real(wp), parameter :: h = 1.0e-5_wp
    real(wp) :: parts(most_inner_joints), x, jump
    integer :: k, i, n

    do k = 1, size(curve_names)
      call find_inner_joints(k, parts, n)
      do i = 1, 15
        x = i/16.0_wp
        jump = (cam_third(k, x + h) - 2.0_wp*cam_third(k, x) + cam_third(k, x - h))/h
        ! fourth derivatives are of order 1000, and change by h times the fifth ones elsewhere
        call test%is_true((abs(jump) > 10.0_wp) .eqv. any(abs(parts(:n) - x) < epsilon(x)), &
                          trim(curve_names(k))//': jumps of the fourth derivative')
      end do
    end do
  end subroutine joints

  !> The steepest slope is reached and not passed; textbooks give it: pi/2, 2, 15/8, 35/16, 1.76, 2.
  subroutine slopes(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    real(wp) :: s, ds, dds, largest
    integer :: k, i

    do k = 1, size(curve_names)
      largest = 0.0_wp
      do i = 0, 1000
        call cam_curve(k, 0.001_wp*i, s, ds, dds)
        largest = max(largest, abs(ds))
      end do
      ! the steepest place, in the middle, is one of these
      call test%near(steepest_slope_of(k), largest, 1.0e-12_wp, trim(curve_names(k))//': the steepest slope')
    end do
    call test%near(steepest_slope_of(curve_number('harmonic')), 0.5_wp*pi, 1.0e-14_wp, 'harmonic')
    call test%near(steepest_slope_of(curve_number('cycloidal')), 2.0_wp, 1.0e-14_wp, 'cycloidal')
    call test%near(steepest_slope_of(curve_number('polynomial345')), 1.875_wp, 1.0e-14_wp, 'polynomial345')
    call test%near(steepest_slope_of(curve_number('polynomial4567')), 2.1875_wp, 1.0e-14_wp, 'polynomial4567')
    call test%near(steepest_slope_of(curve_number('modified-sine')), 4.0_wp*pi/(4.0_wp + pi), 1.0e-14_wp, 'modified-sine')
    call test%near(steepest_slope_of(curve_number('modified-trapezoidal')), 2.0_wp, 1.0e-14_wp, 'modified-trapezoidal')
  end subroutine slopes

  !> Polynomials, the cycloid and the harmonic by their formulas.
  subroutine polynomials(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    real(wp) :: s, ds, dds, x
    integer :: i

    do i = 0, 20
      x = 0.05_wp*i
      ! a few roundings of terms up to some tens
      call cam_curve(curve_number('polynomial345'), x, s, ds, dds)
      call test%near(s, 10.0_wp*x**3 - 15.0_wp*x**4 + 6.0_wp*x**5, 1.0e-14_wp, 'polynomial345')
      call cam_curve(curve_number('polynomial4567'), x, s, ds, dds)
      call test%near(s, 35.0_wp*x**4 - 84.0_wp*x**5 + 70.0_wp*x**6 - 20.0_wp*x**7, 2.0e-14_wp, 'polynomial4567')
      call cam_curve(curve_number('cycloidal'), x, s, ds, dds)
      call test%near(s, x - sin(2.0_wp*pi*x)/(2.0_wp*pi), 1.0e-15_wp, 'cycloidal')
      call cam_curve(curve_number('harmonic'), x, s, ds, dds)
      call test%near(s, 0.5_wp*(1.0_wp - cos(pi*x)), 1.0e-15_wp, 'harmonic')
      call cam_curve(curve_number('constant-velocity'), x, s, ds, dds)
      call test%near(s, x, 1.0e-15_wp, 'constant-velocity')
    end do
  end subroutine polynomials
end module test_cam_curves
