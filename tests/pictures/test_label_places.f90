!> Places of labels: beside bars, on the page, apart from each other, and with a leading line where all near is covered.
module test_label_places
  use mech9_kinds, only: wp, pi
  use mech9_text, only: to_text
  use mech9_label_places, only: obstacles_type, label_type, spots_around, place_labels
  use mech9_testing, only: tester_type
  implicit none
  private
  public :: run

  real(wp), parameter :: page(2) = [600.0_wp, 400.0_wp], at(2) = [300.0_wp, 200.0_wp]
  !> A joint and its name [px].
  real(wp), parameter :: ring = 6.0_wp, box(2) = [13.0_wp, 10.0_wp]
  !> Half the width of a bar [px].
  real(wp), parameter :: half = 4.7_wp

contains

  !> Run the cases of this suite.
  subroutine run(test)
    type(tester_type), intent(inout) :: test   !< selects cases and counts their checks

    if (test%runs('one_bar')) call one_bar(test)
    if (test%runs('two_bars')) call two_bars(test)
    if (test%runs('at_the_edge')) call at_the_edge(test)
    if (test%runs('several')) call several(test)
    if (test%runs('surrounded')) call surrounded(test)
    if (test%runs('own_link')) call own_link(test)
    if (test%runs('neighbours')) call neighbours(test)
  end subroutine run

  !> A bar from the joint in any direction: the name lies beside it, near its joint, without a leading line.
  subroutine one_bar(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(obstacles_type) :: obstacles
    type(label_type) :: labels(1)
    integer :: degrees

    do degrees = 0, 355, 5
      obstacles%n_lines = 0
      call add_bar(obstacles, degrees)
      labels(1) = named(at)
      call place_labels(obstacles, page, labels)
      call test%is_true(.not. any_covered(obstacles, labels(1)), 'a name covers no bar at '//to_text(degrees)//' degrees')
      call test%is_true(distance(labels(1)) < 25.0_wp .and. .not. leads(labels(1)), 'a name beside a bar stands near its joint')
    end do
    obstacles%n_lines = 0
    labels(1) = named(at)
    call place_labels(obstacles, page, labels)
    call test%is_true(labels(1)%chosen == 1, 'where nothing is in the way, the name stands at the spot that it likes best')
  end subroutine one_bar

  !> Two bars in any directions.
  subroutine two_bars(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(obstacles_type) :: obstacles
    type(label_type) :: labels(1)
    integer :: i, j
    logical :: free

    free = .true.
    do i = 0, 350, 10
      do j = 0, 350, 10
        obstacles%n_lines = 0
        call add_bar(obstacles, i)
        call add_bar(obstacles, j)
        labels(1) = named(at)
        call place_labels(obstacles, page, labels)
        free = free .and. .not. any_covered(obstacles, labels(1)) .and. distance(labels(1)) < 25.0_wp
      end do
    end do
    call test%is_true(free, 'a name beside two bars covers neither')
  end subroutine two_bars

  !> Near each corner of the page, the whole name is on it.
  subroutine at_the_edge(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(obstacles_type) :: obstacles
    type(label_type) :: labels(1)
    integer :: i

    do i = 0, 3
      labels(1) = named([merge(8.0_wp, 592.0_wp, i < 2), merge(8.0_wp, 392.0_wp, mod(i, 2) == 0)])
      call place_labels(obstacles, page, labels)
      associate (spot => labels(1)%spots(labels(1)%chosen))
        call test%is_true(all(spot%low >= 0.0_wp) .and. all(spot%high <= page), 'a name stands on the page')
      end associate
    end do
  end subroutine at_the_edge

  !> Six names at one joint: no two of them overlap.
  subroutine several(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(obstacles_type) :: obstacles
    type(label_type) :: labels(6)
    integer :: i, j

    call add_bar(obstacles, 90)
    do i = 1, size(labels)
      labels(i) = named(at)
    end do
    call place_labels(obstacles, page, labels)
    do i = 1, size(labels)
      do j = 1, i - 1
        associate (a => labels(i)%spots(labels(i)%chosen), b => labels(j)%spots(labels(j)%chosen))
          call test%is_true(any(a%low >= b%high) .or. any(b%low >= a%high), 'two names at one joint are apart')
        end associate
      end do
    end do
  end subroutine several

  !> A joint in a cage: its name stands outside, and a line leads there.
  subroutine surrounded(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(obstacles_type) :: obstacles
    type(label_type) :: labels(1)
    real(wp) :: from(2), to(2)
    integer :: i

    do i = 1, 12
      from = at + 15.0_wp*[cos(i*pi/6), sin(i*pi/6)]
      to = at + 15.0_wp*[cos((i + 1)*pi/6), sin((i + 1)*pi/6)]
      call obstacles%add(from, to, 8.0_wp, 1.0_wp)
    end do
    labels(1) = named(at)
    call place_labels(obstacles, page, labels)
    call test%is_true(leads(labels(1)), 'a line leads out of a cage of bars')
    call test%is_true(.not. any_covered(obstacles, labels(1)), 'a name outside the cage covers nothing')
  end subroutine surrounded

  !> The number of a link may stand on its own bar, that of another one not.
  subroutine own_link(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(obstacles_type) :: obstacles
    type(label_type) :: labels(1)
    integer :: owner

    call obstacles%add([0.0_wp, 190.0_wp], [600.0_wp, 190.0_wp], half, 1.0_wp, owner=3)
    do owner = 2, 3
      labels(1) = named(at)
      labels(1)%owner = owner
      call place_labels(obstacles, page, labels)
      call test%is_true(any_covered(obstacles, labels(1)) .eqv. owner == 3, 'a name may cover the bar of its own link alone')
    end do
  end subroutine own_link

  !> Two joints side by side, at any angle: each name stands nearer to its own joint than to the other one.
  subroutine neighbours(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(obstacles_type) :: obstacles
    type(label_type) :: labels(2)
    real(wp) :: middle(2)
    integer :: degrees, i

    do degrees = 0, 345, 15
      labels(1) = named(at)
      labels(2) = named(at + 22.0_wp*[cos(degrees*pi/180), sin(degrees*pi/180)])
      call place_labels(obstacles, page, labels)
      do i = 1, 2
        associate (spot => labels(i)%spots(labels(i)%chosen))
          middle = 0.5_wp*(spot%low + spot%high)
        end associate
        call test%is_true(norm2(middle - labels(i)%at) < norm2(middle - labels(3 - i)%at), &
                          'each of two names stands at its own joint, with the other joint at '//to_text(degrees)//' degrees')
      end do
    end do
  end subroutine neighbours

  !> A label with the spots of a name.
  function named(place) result(label)
    real(wp), intent(in) :: place(2)   !< the joint [px]
    type(label_type) :: label

    label%at = place
    label%spots = spots_around(place, ring, box, to_left=.true.)
  end function named

  subroutine add_bar(obstacles, degrees)
    type(obstacles_type), intent(inout) :: obstacles   !< the bar is added
    integer, intent(in) :: degrees                     !< its direction from the joint

    call obstacles%add(at, at + 150.0_wp*[cos(degrees*pi/180), sin(degrees*pi/180)], half, 1.0_wp)
  end subroutine add_bar

  pure real(wp) function distance(label)
    type(label_type), intent(in) :: label   !< placed

    distance = norm2(0.5_wp*(label%spots(label%chosen)%low + label%spots(label%chosen)%high) - at)
  end function distance

  pure logical function leads(label)
    type(label_type), intent(in) :: label   !< placed

    leads = norm2(label%spots(label%chosen)%to - label%spots(label%chosen)%from) > 0.0_wp
  end function leads

  !> Whether the middle line of an obstacle goes through a label, by points of it every half px.
  pure logical function any_covered(obstacles, label)
    type(obstacles_type), intent(in) :: obstacles   !< bars and joints
    type(label_type), intent(in) :: label           !< placed
    real(wp) :: point(2)
    integer :: i, k, n

    any_covered = .false.
    associate (spot => label%spots(label%chosen))
      do k = 1, obstacles%n_lines
        associate (ends => obstacles%ends(:, :, k))
          n = nint(2*norm2(ends(:, 2) - ends(:, 1)))
          do i = 0, n
            point = ends(:, 1) + i*(ends(:, 2) - ends(:, 1))/n
            any_covered = any_covered .or. (all(point > spot%low) .and. all(point < spot%high))
          end do
        end associate
      end do
    end associate
  end function any_covered
end module test_label_places
