!> Places of labels: numbers of links on bars, and names of coordinates where no bar lies.
program test_label_places
  use mech9_kinds, only: wp, pi
  use mech9_text, only: to_text
  use mech9_random, only: random_type
  use mech9_random_geometry, only: random_vector
  use mech9_label_places, only: number_place, name_shift
  use mech9_testing, only: tester_type
  implicit none
  real(wp), parameter :: tolerance = 1.0e-6_wp
  !> A name of two letters, q1: wide, above and below its line [px].
  integer, parameter :: letters = 2
  real(wp), parameter :: wide = 12.0_wp, above = 8.0_wp, below = 2.0_wp
  type(tester_type) :: test

  call numbers(test)
  call one_bar(test)
  call two_bars(test)
  call on_the_frame(test)
  call test%finish()

contains

  !> On a bar between two points; on a straight link between the neighbours that are farthest apart, in whatever
  !> order its points are given; in the middle of a plate.
  subroutine numbers(test)
    type(tester_type), intent(inout) :: test
    type(random_type) :: random
    real(wp), parameter :: places(5) = [0.0_wp, 1.0_wp, 4.0_wp, 5.5_wp, 6.0_wp]
    integer, parameter :: orders(5, 3) = reshape([1, 2, 3, 4, 5, 5, 4, 3, 2, 1, 3, 1, 5, 2, 4], [5, 3])
    real(wp) :: from(3), along(3), place(3), points(3, 5), s
    integer :: i, k

    from = random_vector(random)
    along = random_vector(random)
    do k = 1, 3
      points = reshape([(from + places(orders(i, k))*along, i=1, 5)], [3, 5])
      place = number_place(points, tolerance)
      s = dot_product(place - from, along)/dot_product(along, along)
      call test%near(norm2(place - from - s*along), 0.0_wp, 1.0e-13_wp, 'on the line; round-off of numbers of the size 10')
      call test%is_true(s > 1.5_wp .and. s < 3.5_wp, 'in the widest gap, off its ends')
    end do
    points(:, 3) = from + [along(2), -along(1), 0.0_wp]
    place = number_place(points(:, :3), tolerance)
    call test%near(norm2(place - sum(points(:, :3), 2)/3), 0.0_wp, 1.0e-14_wp, 'in the middle of a plate')
  end subroutine numbers

  !> A bar from the joint in any direction: the name does not lie on it.
  subroutine one_bar(test)
    type(tester_type), intent(inout) :: test
    real(wp), parameter :: at(2) = [100.0_wp, 70.0_wp]
    real(wp) :: bars(2, 2, 1), shift(2)
    integer :: degrees

    do degrees = 0, 355, 5
      bars(:, 1, 1) = at
      bars(:, 2, 1) = at + 200.0_wp*[cos(degrees*pi/180), sin(degrees*pi/180)]
      shift = name_shift(at, letters, .false., .false., bars)
      call test%is_true(.not. lies_on(at + shift, bars(:, :, 1)), 'beside a bar at '//to_text(degrees)//' degrees')
      call test%is_true(norm2(shift) < 30.0_wp, 'and near its joint')
    end do
    shift = name_shift(at, letters, .false., .false., bars(:, :, :0))
    call test%is_true(all(shift < 0.0_wp), 'to the left and above where there is nothing')
  end subroutine one_bar

  !> Two bars in any directions: three places are enough to have one beside both.
  subroutine two_bars(test)
    type(tester_type), intent(inout) :: test
    real(wp), parameter :: at(2) = [0.0_wp, 0.0_wp]
    real(wp) :: bars(2, 2, 2), shift(2), angle
    integer :: i, j, k
    logical :: free

    free = .true.
    do i = 0, 350, 10
      do j = 0, 350, 10
        do k = 1, 2
          angle = merge(i, j, k == 1)*pi/180
          bars(:, 1, k) = at
          bars(:, 2, k) = 150.0_wp*[cos(angle), sin(angle)]
        end do
        shift = name_shift(at, letters, .false., .false., bars)
        free = free .and. .not. lies_on(at + shift, bars(:, :, 1)) .and. .not. lies_on(at + shift, bars(:, :, 2))
      end do
    end do
    call test%is_true(free, 'beside two bars')
  end subroutine two_bars

  !> The stand is on one side, the name on the other, wherever bars are.
  subroutine on_the_frame(test)
    type(tester_type), intent(inout) :: test
    real(wp), parameter :: bars(2, 2, 1) = reshape([0.0_wp, 0.0_wp, -100.0_wp, -70.0_wp], [2, 2, 1])
    real(wp) :: shift(2)

    shift = name_shift(bars(:, 1, 1), letters, .true., .false., bars)
    call test%is_true(shift(2) < 0.0_wp, 'above a stand')
    shift = name_shift(bars(:, 1, 1), letters, .true., .true., bars)
    call test%is_true(shift(2) > above, 'below one that hangs')
  end subroutine on_the_frame

  !> Whether the middle line of a bar goes through a name that ends here, by points of it every half px.
  pure logical function lies_on(last, bar)
    real(wp), intent(in) :: last(2)               !< of the name's line [px]
    real(wp), intent(in) :: bar(2, 2)
    real(wp) :: point(2)
    integer :: i, n

    n = nint(2*norm2(bar(:, 2) - bar(:, 1)))
    lies_on = .false.
    do i = 0, n
      point = bar(:, 1) + i*(bar(:, 2) - bar(:, 1))/n - last
      lies_on = lies_on .or. (point(1) > -wide .and. point(1) < 0.0_wp .and. point(2) > -above .and. point(2) < below)
    end do
  end function lies_on
end program test_label_places
