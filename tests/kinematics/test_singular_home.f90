!> Mobility where the home position is singular: links in one line, dead points, meeting branches. The
!> mobility of each is known from elementary geometry, and the ranks at home say something else.
module test_singular_home
  use mech9_kinds, only: wp
  use mech9_error, only: error_type, exit_structure
  use mech9_mechanism_families, only: axis_type, plan_at_home, crank_row
  use mech9_testing, only: tester_type
  implicit none
  private
  public :: run

  integer, parameter :: four(2, 4) = reshape([1, 2, 2, 3, 3, 4, 4, 1], [2, 4])
  integer, parameter :: three_cranks(2, 6) = reshape([1, 2, 2, 3, 3, 4, 4, 1, 3, 5, 5, 1], [2, 6])
  integer, parameter :: two_fours(2, 8) = reshape([1, 2, 2, 3, 3, 4, 4, 1, 1, 5, 5, 6, 6, 7, 7, 1], [2, 8])

contains

  !> Run the cases of this suite.
  subroutine run(test)
    type(tester_type), intent(inout) :: test   !< selects cases and counts their checks

    if (test%runs('one_loop')) call one_loop(test)
    if (test%runs('wrong_inputs')) call wrong_inputs(test)
    if (test%runs('three_parallel_cranks')) call three_parallel_cranks(test)
    if (test%runs('stretched_as_ground')) call stretched_as_ground(test)
    if (test%runs('two_dead_points')) call two_dead_points(test)
    if (test%runs('rows')) call rows(test)
  end subroutine run

  subroutine one_loop(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    integer :: k

    do k = 1, 4
      call serves(test, 'parallelogram in one line', 4, four, in_line([0.0_wp, 1.0_wp, 3.0_wp, 2.0_wp]), [k])
      call serves(test, 'crank and coupler in one line', 4, four, dead_point(0.0_wp), [k])
      call serves(test, 'slider-crank in one line', 4, four, slider_crank(), [k])
    end do
  end subroutine one_loop

  subroutine wrong_inputs(test)
    type(tester_type), intent(inout) :: test   !< counts the checks

    call fails(test, 'parallelogram with two inputs', 4, four, in_line([0.0_wp, 1.0_wp, 3.0_wp, 2.0_wp]), [1, 2])
    call fails(test, 'parallelogram with opposite inputs', 4, four, in_line([0.0_wp, 1.0_wp, 3.0_wp, 2.0_wp]), [1, 4])
    call fails(test, 'parallelogram without input', 4, four, in_line([0.0_wp, 1.0_wp, 3.0_wp, 2.0_wp]), [integer ::])
    call fails(test, 'four-bar with two inputs at its dead point', 4, four, dead_point(0.0_wp), [1, 4])
  end subroutine wrong_inputs

  !> The three cranks are parallel: a redundant chain, and only one of the branches that meet is possible. With other distances on
  !> the coupler than on the frame the cranks lock, though the rates at home do not show it.
  subroutine three_parallel_cranks(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    integer :: k

    do k = 1, 6
      call serves(test, 'three parallel cranks in one line', 5, three_cranks, &
                  in_line([0.0_wp, 1.0_wp, 3.0_wp, 2.0_wp, 6.0_wp, 5.0_wp]), [k])
    end do
    call fails(test, 'three cranks that lock', 5, three_cranks, &
               in_line([0.0_wp, 1.0_wp, 3.0_wp, 2.0_wp, 6.0_wp, 4.8_wp]), [1])
  end subroutine three_parallel_cranks

  subroutine stretched_as_ground(test)
    type(tester_type), intent(inout) :: test   !< counts the checks

    call fails(test, 'a stretched four-bar as long as its frame', 4, four, in_line([0.0_wp, 1.0_wp, 2.0_wp, 3.0_wp]), [1])
  end subroutine stretched_as_ground

  !> Two loops at dead points of both inputs: only a quarter of the trials can close.
  subroutine two_dead_points(test)
    type(tester_type), intent(inout) :: test   !< counts the checks

    call serves(test, 'two dead points', 7, two_fours, [dead_point(0.0_wp), dead_point(2.0_wp)], [4, 8])
  end subroutine two_dead_points

  subroutine rows(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    integer :: k

    do k = 10, 40, 10
      call serves(test, 'many four-bars in one line', 2*k + 2, crank_row(k), row_in_line(k), [1])
      call serves(test, 'many four-bars in one line, driven at the end', 2*k + 2, crank_row(k), row_in_line(k), [3*k + 1])
    end do
  end subroutine rows

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

  subroutine serves(test, name, n_links, links, axes, cq)
    type(tester_type), intent(inout) :: test   !< counts the checks
    character(len=*), intent(in) :: name       !< of the mechanism, for the report of a failure
    integer, intent(in) :: n_links             !< links, the frame included
    integer, intent(in) :: links(:, :)         !< (2,M) reference and moving link of each pair
    integer, intent(in) :: cq(:)               !< independent coordinates
    type(axis_type), intent(in) :: axes(:)     !< of each pair in the home position
    type(error_type), allocatable :: err

    call plan_at_home(n_links, links, axes, cq, err)
    call test%no_error(err, name//': the mechanism has a plan')
  end subroutine serves

  subroutine fails(test, name, n_links, links, axes, cq)
    type(tester_type), intent(inout) :: test   !< counts the checks
    character(len=*), intent(in) :: name       !< of the mechanism, for the report of a failure
    integer, intent(in) :: n_links             !< links, the frame included
    integer, intent(in) :: links(:, :)         !< (2,M) reference and moving link of each pair
    integer, intent(in) :: cq(:)               !< independent coordinates
    type(axis_type), intent(in) :: axes(:)     !< of each pair in the home position
    type(error_type), allocatable :: err

    call plan_at_home(n_links, links, axes, cq, err)
    call test%has_error(err, exit_structure, name//': the mechanism is refused')
  end subroutine fails
end module test_singular_home
