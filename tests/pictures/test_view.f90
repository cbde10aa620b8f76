!> Views: what they mean as directions, and words that are none.
module test_view
  use mech9_kinds, only: wp
  use mech9_error, only: error_type, exit_usage
  use mech9_random, only: random_type
  use mech9_rotation, only: identity, cross
  use mech9_random_geometry, only: random_unit
  use mech9_view, only: view_type, view_from, read_view
  use mech9_testing, only: tester_type
  implicit none
  private
  public :: run

  !> A few roundings of numbers up to one.
  real(wp), parameter :: round_off = 2.0e-15_wp

contains

  !> Run the cases of this suite.
  subroutine run(test)
    type(tester_type), intent(inout) :: test   !< selects cases and counts their checks

    if (test%runs('directions')) call directions(test)
    if (test%runs('words_for_axes')) call words_for_axes(test)
    if (test%runs('words_for_directions')) call words_for_directions(test)
    if (test%runs('no_views')) call no_views(test)
  end subroutine run

  !> From everywhere, also from straight above: three directions across each other, and up is up.
  subroutine directions(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(random_type) :: random
    type(view_type) :: view
    real(wp) :: toward(3), upward(3)
    integer :: i

    do i = 1, 100
      toward = random_unit(random)
      upward = random_unit(random)
      if (mod(i, 10) == 0) toward = upward
      if (mod(i, 20) == 0) toward = identity(:, 2)
      if (mod(i, 20) == 0) upward = identity(:, 2)
      view = view_from(3.0_wp*toward, 0.2_wp*upward)
      call test%near(maxval(abs(view%toward - toward)), 0.0_wp, round_off, 'the view is seen from the direction that is given')
      call test%near(maxval(abs(cross(view%right, view%up) - view%toward)), 0.0_wp, 4.0_wp*round_off, &
                     'the axes of the view are right-handed')
      call test%near(norm2(view%up), 1.0_wp, 4.0_wp*round_off, 'the upward axis of the view has length one')
      if (mod(i, 10) > 0) call test%is_true(dot_product(view%up, upward) > 0.0_wp, 'the upward axis of the view points up')
      call test%near(norm2(view%seen(upward)), 1.0_wp, 4.0_wp*round_off, 'a picture neither stretches nor shrinks')
    end do
  end subroutine directions

  !> Two axes: the first to the right, the second up.
  subroutine words_for_axes(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(view_type) :: view
    type(error_type), allocatable :: err
    character, parameter :: axes(3) = ['x', 'y', 'z']
    integer :: i, j

    do i = 1, 3
      do j = 1, 3
        if (i == j) cycle
        call read_view(axes(i)//axes(j), exit_usage, view, err)
        call test%no_error(err, axes(i)//axes(j)//' is a view')
        call test%near(maxval(abs(view%right - identity(:, i))), 0.0_wp, 0.0_wp, 'the first axis points to the right')
        call test%near(maxval(abs(view%up - identity(:, j))), 0.0_wp, 0.0_wp, 'the second axis points upwards')
        call test%near(maxval(abs(view%toward - cross(view%right, view%up))), 0.0_wp, 0.0_wp, 'the view is no mirror image')
      end do
    end do
  end subroutine words_for_axes

  subroutine words_for_directions(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(view_type) :: view
    type(error_type), allocatable :: err

    call read_view(' 3, -4,0 ', exit_usage, view, err)
    call test%no_error(err, 'three numbers are a view')
    call test%near(maxval(abs(view%toward - [0.6_wp, -0.8_wp, 0.0_wp])), 0.0_wp, round_off, &
                   'the direction to the viewer is the one that is given')
    call test%near(maxval(abs(view%up - identity(:, 3))), 0.0_wp, round_off, 'the z axis points upwards')
    call read_view('ISO', exit_usage, view, err)
    call test%no_error(err, 'iso is a view')
    call test%is_true(view%toward(1) > 0.0_wp .and. view%toward(2) < 0.0_wp .and. view%toward(3) > 0.0_wp, &
                      'iso is seen from the right, from before and from above')
  end subroutine words_for_directions

  subroutine no_views(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    character(len=12), parameter :: wrong(*) = [character(len=12) :: '', 'x', 'xx', 'xw', 'above', '1,2', '1,2,3,4', '0,0,0', &
                                                '1,2,z', '1 2 3', '1,,3', '1e999,0,0', '3*1', '1,2,3/', 'nan,1,1']
    type(view_type) :: view
    type(error_type), allocatable :: err
    integer :: i

    do i = 1, size(wrong)
      call read_view(trim(wrong(i)), exit_usage, view, err)
      call test%has_error(err, exit_usage, "'"//trim(wrong(i))//"' is refused")
    end do
  end subroutine no_views
end module test_view
