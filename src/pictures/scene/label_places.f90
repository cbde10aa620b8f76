!> The places of labels, chosen so that they can be read. Each label takes the one of its possible spots that covers
!> least of the drawing and of the other labels.
module mech9_label_places
  use mech9_kinds, only: wp
  implicit none
  private
  public :: obstacles_type, spot_type, label_type, spots_around, place_labels

  !> Obstacles that labels should not cover: lines with a width to both sides, and discs as lines without length.
  type :: obstacles_type
    integer :: n_lines = 0
    real(wp), allocatable :: ends(:, :, :)      !< (2,2,n) ends of the lines [px]
    real(wp), allocatable :: half(:)            !< (n) distance to which a line reaches on each side [px]
    real(wp), allocatable :: weight(:)          !< (n) cost of covering the line; 1 for a bar
    integer, allocatable :: owner(:)            !< (n) link whose number may stand on it; 0: none
  contains
    procedure :: add => add_obstacle
  end type obstacles_type

  !> A possible place for a label: a box, a leading line from the labelled thing to the box, and the cost of this place.
  !> The cost does not depend on the rest of the drawing.
  type :: spot_type
    real(wp) :: low(2) = 0.0_wp, high(2) = 0.0_wp     !< corners of the box [px]
    real(wp) :: from(2) = 0.0_wp, to(2) = 0.0_wp      !< ends of the leading line [px]; equal ends: no line
    real(wp) :: cost = 0.0_wp                         !< cost of the spot, in px of a covered bar
  end type spot_type

  !> A label with the spots where it can stand, in order of preference.
  type :: label_type
    type(spot_type), allocatable :: spots(:)
    integer :: owner = 0                              !< link whose own lines are no obstacles; 0: all lines are
    logical :: of_place = .true.                      !< the label names a place, and must not stand nearer to another one
    real(wp) :: at(2) = 0.0_wp                        !< the place that it names [px]
    integer :: chosen = 1                             !< number of the chosen spot
  end type label_type

  !> Room between labels [px], and the cost where two of them touch, in px of a covered bar.
  real(wp), parameter :: apart = 1.5_wp, clash = 60.0_wp
  !> The cost where a leading line runs over a label, and where two leading lines cross.
  real(wp), parameter :: overrun = 30.0_wp, branch_point = 10.0_wp
  !> The largest number of rounds in which every label is placed anew in view of the others.
  integer, parameter :: most_rounds = 6
  !> Larger numbers of labels cannot be read; each label then takes the spot that it prefers.
  integer, parameter :: most_labels = 150

contains

  !> Add one more line that labels should not cover.
  pure subroutine add_obstacle(self, from, to, half, weight, owner)
    class(obstacles_type), intent(inout) :: self  !< lines that labels should not cover
    real(wp), intent(in) :: from(2)               !< first end of the line [px]
    real(wp), intent(in) :: to(2)                 !< second end of the line [px]
    real(wp), intent(in) :: half                  !< distance to which it reaches on each side [px]
    real(wp), intent(in) :: weight                !< cost of covering the line; 1 for a bar
    integer, intent(in), optional :: owner        !< link whose number may stand on the line
    type(obstacles_type) :: grown

    if (.not. allocated(self%half)) &
      allocate (self%ends(2, 2, 256), self%half(256), self%weight(256), self%owner(256))
    if (self%n_lines == size(self%half)) then
      allocate (grown%ends(2, 2, 2*self%n_lines), grown%half(2*self%n_lines), grown%weight(2*self%n_lines), &
                grown%owner(2*self%n_lines))
      grown%ends(:, :, :self%n_lines) = self%ends
      grown%half(:self%n_lines) = self%half
      grown%weight(:self%n_lines) = self%weight
      grown%owner(:self%n_lines) = self%owner
      call move_alloc(grown%ends, self%ends)
      call move_alloc(grown%half, self%half)
      call move_alloc(grown%weight, self%weight)
      call move_alloc(grown%owner, self%owner)
    end if
    self%n_lines = self%n_lines + 1
    self%ends(:, 1, self%n_lines) = from
    self%ends(:, 2, self%n_lines) = to
    self%half(self%n_lines) = half
    self%weight(self%n_lines) = weight
    self%owner(self%n_lines) = 0
    if (present(owner)) self%owner(self%n_lines) = owner
  end subroutine add_obstacle

  !> Spots for a box around a place: on eight sides of it, then on rings farther away. The outer rings have leading lines.
  pure function spots_around(at, clear, size_of_box, to_left) result(spots)
    real(wp), intent(in) :: at(2)           !< the place [px]
    real(wp), intent(in) :: clear           !< radius of what is drawn there [px]
    real(wp), intent(in) :: size_of_box(2)  !< width and height of the label [px]
    logical, intent(in) :: to_left          !< the label stands preferably to the left and above, else to the right
    type(spot_type), allocatable :: spots(:)
    integer, parameter :: sides(2, 8) = reshape([1, -1, -1, -1, 1, 1, -1, 1, 0, -1, 0, 1, 1, 0, -1, 0], [2, 8])
    real(wp), parameter :: rings(4) = [7.0_wp, 20.0_wp, 36.0_wp, 56.0_wp], pi = acos(-1.0_wp)
    real(wp), parameter :: led = 6.0_wp
    real(wp) :: side(2), gap, angle
    integer :: i, j, n

    allocate (spots(size(sides, 2) + 16*size(rings)))
    do i = 1, size(sides, 2)
      side = real(sides(:, i), wp)
      if (to_left) side(1) = -side(1)
      ! the corner of a box may come nearer to a round joint than its side
      gap = clear + 1.5_wp
      if (all(sides(:, i) /= 0)) gap = 0.7_wp*clear + 0.5_wp
      spots(i) = box_at(at + side*(0.5_wp*size_of_box + gap), size_of_box, 0.8_wp*(i - 1))
    end do
    n = size(sides, 2)
    do i = 1, size(rings)
      do j = 0, 15
        angle = (2*j + 1)*pi/16
        side = [merge(-1.0_wp, 1.0_wp, to_left)*cos(angle), -sin(angle)]
        n = n + 1
        spots(n) = box_at(at + side*(clear + rings(i)) + sign(0.5_wp, side)*size_of_box, size_of_box, 4.0_wp + 0.5_wp*rings(i))
        if (i == 1) cycle
        spots(n)%cost = spots(n)%cost + led
        spots(n)%from = at + clear*side
        spots(n)%to = at + (clear + rings(i) - 1.0_wp)*side
      end do
    end do
  end function spots_around

  !> The spot whose box has its middle at a place, without a leading line.
  pure function box_at(centre, size_of_box, cost) result(spot)
    real(wp), intent(in) :: centre(2)       !< middle of the box [px]
    real(wp), intent(in) :: size_of_box(2)  !< width and height of the box [px]
    real(wp), intent(in) :: cost            !< cost of the spot, in px of a covered bar
    type(spot_type) :: spot

    spot%low = centre - 0.5_wp*size_of_box
    spot%high = centre + 0.5_wp*size_of_box
    spot%cost = cost
  end function box_at

  !> Choose a spot for every label: first for each label alone, then again in view of the others until none moves. The
  !> order of the labels decides where either of two could give way.
  pure subroutine place_labels(obstacles, page, labels)
    type(obstacles_type), intent(in) :: obstacles  !< lines that labels should not cover
    real(wp), intent(in) :: page(2)                !< width and height of the page [px]
    type(label_type), intent(inout) :: labels(:)   !< labels with their possible spots
    real(wp) :: cost, least
    integer :: round, i, j, best
    logical :: moved

    if (size(labels) > most_labels) return
    do i = 1, size(labels)
      do j = 1, size(labels(i)%spots)
        labels(i)%spots(j)%cost = labels(i)%spots(j)%cost + mistakable(labels, i, labels(i)%spots(j)) &
                                  + covered(obstacles, page, labels(i)%spots(j), labels(i)%owner)
      end do
      labels(i)%chosen = 0
    end do
    do round = 1, most_rounds
      moved = .false.
      do i = 1, size(labels)
        best = 0
        least = huge(least)
        do j = 1, size(labels(i)%spots)
          if (labels(i)%spots(j)%cost >= least) cycle
          cost = labels(i)%spots(j)%cost + clashes(labels, i, labels(i)%spots(j))
          ! costs that differ by less than 0.01 px count as equal, so that round-off does not choose
          if (cost > least - 0.01_wp) cycle
          least = cost
          best = j
        end do
        moved = moved .or. best /= labels(i)%chosen
        labels(i)%chosen = best
      end do
      if (.not. moved) exit
    end do
  end subroutine place_labels

  !> The cost of a spot where the label would be taken for that of another place, which is as near.
  pure real(wp) function mistakable(labels, own, spot)
    type(label_type), intent(in) :: labels(:)  !< labels with their possible spots
    integer, intent(in) :: own                 !< number of the label that would stand there
    type(spot_type), intent(in) :: spot        !< the spot that is judged
    real(wp), parameter :: mistaken = 16.0_wp, with_line = 4.0_wp, nearer = 4.0_wp, same = 3.0_wp
    integer :: i

    mistakable = 0.0_wp
    if (.not. labels(own)%of_place) return
    do i = 1, size(labels)
      if (i == own .or. .not. labels(i)%of_place) cycle
      if (norm2(labels(i)%at - labels(own)%at) < same) cycle
      if (distance(labels(i)%at, spot) > distance(labels(own)%at, spot) + nearer) cycle
      mistakable = merge(with_line, mistaken, leads(spot))
      return
    end do
  end function mistakable

  !> The distance of a place from a label [px].
  pure real(wp) function distance(place, spot)
    real(wp), intent(in) :: place(2)     !< place on the page [px]
    type(spot_type), intent(in) :: spot  !< box and leading line of the label

    distance = norm2(max(0.0_wp, spot%low - place, place - spot%high))
  end function distance

  !> The cost of what a spot covers, in px of a bar.
  pure real(wp) function covered(obstacles, page, spot, owner)
    type(obstacles_type), intent(in) :: obstacles  !< lines that labels should not cover
    real(wp), intent(in) :: page(2)                !< width and height of the page [px]
    type(spot_type), intent(in) :: spot            !< box and leading line of the label
    integer, intent(in) :: owner                   !< link whose own lines do not count; 0: all lines count
    real(wp), parameter :: outside = 50.0_wp
    real(wp) :: low(2), high(2), length
    logical :: meets
    integer :: i

    covered = outside*sum(max(0.0_wp, 4.0_wp - spot%low) + max(0.0_wp, spot%high - page + 4.0_wp))
    low = min(spot%low, spot%from, spot%to)
    high = max(spot%high, spot%from, spot%to)
    if (.not. leads(spot)) then
      low = spot%low
      high = spot%high
    end if
    do i = 1, obstacles%n_lines
      associate (from => obstacles%ends(:, 1, i), to => obstacles%ends(:, 2, i), half => obstacles%half(i))
        if (any(min(from, to) - half > high) .or. any(max(from, to) + half < low)) cycle
        if (owner > 0 .and. obstacles%owner(i) == owner) cycle
        call look_within(from, to, spot%low - half, spot%high + half, length, meets)
        if (meets) covered = covered + obstacles%weight(i)*(length + 2.0_wp*half)
        if (leads(spot)) then
          if (cross_each_other(spot%from, spot%to, from, to)) covered = covered + 4.0_wp*obstacles%weight(i)
        end if
      end associate
    end do
  end function covered

  !> The cost of the overlaps of a spot with other labels and their leading lines.
  pure real(wp) function clashes(labels, own, spot)
    type(label_type), intent(in) :: labels(:)  !< labels with their possible spots
    integer, intent(in) :: own                 !< number of the label that would stand there
    type(spot_type), intent(in) :: spot        !< the spot that is judged
    real(wp) :: overlap(2), length
    logical :: meets
    integer :: i

    clashes = 0.0_wp
    do i = 1, size(labels)
      if (i == own .or. labels(i)%chosen == 0) cycle
      associate (other => labels(i)%spots(labels(i)%chosen))
        overlap = min(spot%high, other%high) - max(spot%low, other%low) + apart
        if (all(overlap > 0.0_wp)) clashes = clashes + clash + product(overlap)
        if (leads(other)) then
          call look_within(other%from, other%to, spot%low, spot%high, length, meets)
          if (meets) clashes = clashes + overrun
        end if
        if (leads(spot)) then
          call look_within(spot%from, spot%to, other%low, other%high, length, meets)
          if (meets) clashes = clashes + overrun
          if (leads(other)) then
            if (cross_each_other(spot%from, spot%to, other%from, other%to)) clashes = clashes + branch_point
          end if
        end if
      end associate
    end do
  end function clashes

  !> Whether a spot has a leading line.
  pure logical function leads(spot)
    type(spot_type), intent(in) :: spot  !< box and leading line of the label

    leads = any(abs(spot%to - spot%from) > 0.0_wp)
  end function leads

  !> Compute the part of a line that lies within a box.
  pure subroutine look_within(from, to, low, high, length, meets)
    real(wp), intent(in) :: from(2)  !< first end of the line [px]
    real(wp), intent(in) :: to(2)    !< second end of the line [px]
    real(wp), intent(in) :: low(2)   !< corner of the box with the smallest coordinates [px]
    real(wp), intent(in) :: high(2)  !< corner of the box with the largest coordinates [px]
    real(wp), intent(out) :: length  !< length of the part of the line inside the box [px]
    logical, intent(out) :: meets    !< the line and the box have a point in common
    real(wp) :: first, last, ends(2)
    integer :: i

    length = 0.0_wp
    meets = .false.
    first = 0.0_wp
    last = 1.0_wp
    do i = 1, 2
      if (abs(to(i) - from(i)) > 1.0e-6_wp) then
        ends = [low(i) - from(i), high(i) - from(i)]/(to(i) - from(i))
        first = max(first, minval(ends))
        last = min(last, maxval(ends))
      else if (from(i) < low(i) .or. from(i) > high(i)) then
        return
      end if
    end do
    meets = last >= first
    if (meets) length = (last - first)*norm2(to - from)
  end subroutine look_within

  !> Whether two lines cross at a point that is not an end of either.
  pure logical function cross_each_other(a, b, c, d)
    real(wp), intent(in) :: a(2)  !< first end of the first line [px]
    real(wp), intent(in) :: b(2)  !< second end of the first line [px]
    real(wp), intent(in) :: c(2)  !< first end of the second line [px]
    real(wp), intent(in) :: d(2)  !< second end of the second line [px]

    cross_each_other = side(a, b, c)*side(a, b, d) < 0.0_wp .and. side(c, d, a)*side(c, d, b) < 0.0_wp
  end function cross_each_other

  !> A number whose sign shows on which side of a line a point lies.
  pure real(wp) function side(from, to, point)
    real(wp), intent(in) :: from(2)   !< first point of the line [px]
    real(wp), intent(in) :: to(2)     !< second point of the line [px]
    real(wp), intent(in) :: point(2)  !< the point [px]

    side = (to(1) - from(1))*(point(2) - from(2)) - (to(2) - from(2))*(point(1) - from(1))
  end function side
end module mech9_label_places
