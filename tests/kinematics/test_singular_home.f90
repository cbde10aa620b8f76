!> Mobility where the home position is singular: links in one line, dead points, meeting branches. The
!> mobility of each is known from elementary geometry, and the ranks at home say something else.
program test_singular_home
  use mech9_kinds, only: wp
  use mech9_error, only: error_type, exit_structure
  use mech9_mechanism_families, only: axis_type, plan_at_home, crank_row
  use mech9_testing, only: tester_type
  implicit none
  type(tester_type) :: test
  integer, parameter :: four(2, 4) = reshape([1, 2, 2, 3, 3, 4, 4, 1], [2, 4])
  integer, parameter :: three_cranks(2, 6) = reshape([1, 2, 2, 3, 3, 4, 4, 1, 3, 5, 5, 1], [2, 6])
  integer, parameter :: two_fours(2, 8) = reshape([1, 2, 2, 3, 3, 4, 4, 1, 1, 5, 5, 6, 6, 7, 7, 1], [2, 8])
  integer :: k

  do k = 1, 4
    call serves('parallelogram in one line', 4, four, in_line([0.0_wp, 1.0_wp, 3.0_wp, 2.0_wp]), [k])
    call serves('crank and coupler in one line', 4, four, dead_point(0.0_wp), [k])
    call serves('slider-crank in one line', 4, four, slider_crank(), [k])
  end do
  call fails('parallelogram with two inputs', 4, four, in_line([0.0_wp, 1.0_wp, 3.0_wp, 2.0_wp]), [1, 2])
  call fails('parallelogram with opposite inputs', 4, four, in_line([0.0_wp, 1.0_wp, 3.0_wp, 2.0_wp]), [1, 4])
  call fails('parallelogram without input', 4, four, in_line([0.0_wp, 1.0_wp, 3.0_wp, 2.0_wp]), [integer ::])
  call fails('four-bar with two inputs at its dead point', 4, four, dead_point(0.0_wp), [1, 4])
  ! the three cranks are parallel: a redundant chain, and only one of the branches that meet is possible
  do k = 1, 6
    call serves('three parallel cranks in one line', 5, three_cranks, &
                in_line([0.0_wp, 1.0_wp, 3.0_wp, 2.0_wp, 6.0_wp, 5.0_wp]), [k])
  end do
  ! other distances on the coupler than on the frame: it is locked, though its rates at home are not
  call fails('three cranks that lock', 5, three_cranks, &
             in_line([0.0_wp, 1.0_wp, 3.0_wp, 2.0_wp, 6.0_wp, 4.8_wp]), [1])
  call fails('a stretched four-bar as long as its frame', 4, four, in_line([0.0_wp, 1.0_wp, 2.0_wp, 3.0_wp]), [1])
  ! two loops at dead points of both inputs: only a quarter of the trials can close
  call serves('two dead points', 7, two_fours, [dead_point(0.0_wp), dead_point(2.0_wp)], [4, 8])
  do k = 10, 40, 10
    call serves('many four-bars in one line', 2*k + 2, crank_row(k), row_in_line(k), [1])
    call serves('many four-bars in one line, driven at the end', 2*k + 2, crank_row(k), row_in_line(k), [3*k + 1])
  end do
  call test%finish()

contains

  !> Revolutes normal to a plane, at places on one line.
  pure function in_line(places) result(axes)
    real(wp), intent(in) :: places(:)   !< on the line [m]
    type(axis_type) :: axes(size(places))

    axes%point(1) = places
  end function in_line

  !> A four-bar whose first two links are stretched: its rocker, pair 4, can turn one way only.
  pure function dead_point(shift) result(axes)
    real(wp), intent(in) :: shift   !< of the rocker's pivot [m]
    type(axis_type) :: axes(4)

    axes%point(1) = shift + [0.0_wp, 1.0_wp, 3.0_wp, 2.5_wp]
    axes%point(2) = [0.0_wp, 0.0_wp, 0.0_wp, -1.2_wp]
  end function dead_point

  !> A slider-crank in its outer dead point.
  pure function slider_crank() result(axes)
    type(axis_type) :: axes(4)

    axes = in_line([0.0_wp, 1.0_wp, 3.0_wp, 3.0_wp])
    axes(4)%slides = .true.
    axes(4)%along = [1.0_wp, 0.0_wp, 0.0_wp]
  end function slider_crank

  !> n parallelograms in a row, their cranks lying on the frame.
  pure function row_in_line(n) result(axes)
    integer, intent(in) :: n   !< parallelograms
    type(axis_type) :: axes(3*n + 1)
    integer :: i

    do i = 1, n
      axes(3*i - 1)%point(1) = i
      axes(3*i)%point(1) = i + 1
      axes(3*i + 1)%point(1) = i
    end do
  end function row_in_line

  subroutine serves(name, n_links, links, axes, cq)
    character(len=*), intent(in) :: name     !< of the mechanism, for the report of a failure
    integer, intent(in) :: n_links           !< links, the frame included
    integer, intent(in) :: links(:, :)       !< (2,M) reference and moving link of each pair
    integer, intent(in) :: cq(:)             !< independent coordinates
    type(axis_type), intent(in) :: axes(:)   !< of each pair in the home position
    type(error_type), allocatable :: err

    call plan_at_home(n_links, links, axes, cq, err)
    call test%no_error(err, name//': the mechanism has a plan')
  end subroutine serves

  subroutine fails(name, n_links, links, axes, cq)
    character(len=*), intent(in) :: name     !< of the mechanism, for the report of a failure
    integer, intent(in) :: n_links           !< links, the frame included
    integer, intent(in) :: links(:, :)       !< (2,M) reference and moving link of each pair
    integer, intent(in) :: cq(:)             !< independent coordinates
    type(axis_type), intent(in) :: axes(:)   !< of each pair in the home position
    type(error_type), allocatable :: err

    call plan_at_home(n_links, links, axes, cq, err)
    call test%has_error(err, exit_structure, name//': the mechanism is refused')
  end subroutine fails
end program test_singular_home
