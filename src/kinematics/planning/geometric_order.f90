!> An order of links and pairs that follows from the geometry and from the start, and not from their numbers.
!>
!> Links are reached from link 1, each through the pairs of the link before. The pairs of a link are ordered by kinds and starts, by
!> distances and angles between them, which are the same in every place of the mechanism, and where these are equal, as in legs that
!> are alike, by the numbers of the data. Chains that are laid out in this order begin, meet and close at the same pairs however these
!> are numbered.
module mech9_geometric_order
  use mech9_kinds, only: wp, long
  use mech9_planning_tolerances, only: equal_features
  use mech9_pose, only: pose_type, inverse
  use mech9_pair, only: screw_factors_type
  use mech9_structure, only: structure_type
  use mech9_partition, only: partition_type, new_partition
  use mech9_mechanism, only: mechanism_type
  use mech9_plan, only: plan_type
  implicit none
  private
  public :: order_by_geometry

  !> Number of features of a pair that are the same in every place, and of those that are numbers of the data.
  integer, parameter :: n_features = 12, n_numbers = 24

  !> A pair as it is seen from one of its links.
  type :: view_type
    integer :: pair = 0                    !< its number
    integer :: link = 0                    !< the link at its other end
    integer(long) :: features(n_features)  !< kind, start, distances and angles, in parts of `equal_features`
    real(wp) :: numbers(n_numbers)         !< the places of its frames in the systems of both links
  end type view_type

  !> The numbers that links and pairs get.
  type :: order_type
    integer, allocatable :: link_at(:)     !< links in the new order, link 1 first
    integer, allocatable :: pair_at(:)     !< pairs in the new order
    integer, allocatable :: entry(:)       !< pair through which each link was reached; 0: link 1, or not reached yet
    integer :: links = 1                   !< number of links that are reached
    integer :: pairs = 0                   !< number of pairs that have a place
    type(pose_type), allocatable :: frame(:, :)   !< (2,M) frame of each pair in its reference link and in its moving link
    !> (5,M) features of each pair that are the same from both of its links: kind, start, turn, slide and offset
    real(wp), allocatable :: own(:, :)
    integer, allocatable :: first(:)       !< (N+1) place in `ends` of the first pair of each link
    integer, allocatable :: ends(:)        !< pairs, link by link
  end type order_type

contains

  !> The same partition with an order of computation that does not depend on the numbers of links and coordinates.
  subroutine order_by_geometry(mechanism, partition, plan, start, ordered)
    type(mechanism_type), intent(in) :: mechanism   !< the mechanism
    type(partition_type), intent(in) :: partition   !< driven, free and dependent coordinates
    type(plan_type), intent(in) :: plan             !< its plan in any order, for size and units
    real(wp), intent(in) :: start(:)                !< (M) values and guesses of the coordinates [rad, m]
    type(partition_type), intent(out) :: ordered    !< the partition in the other order
    type(order_type) :: order
    type(structure_type) :: structure
    integer :: new_link(plan%n_links), i

    call find_order(mechanism, partition, plan, start, order)
    new_link(order%link_at) = [(i, i=1, plan%n_links)]
    structure%n_links = plan%n_links
    structure%n_coordinates = plan%n_coordinates
    allocate (structure%links(2, plan%n_coordinates))
    do i = 1, plan%n_coordinates
      structure%links(:, i) = new_link(mechanism%structure%links(:, order%pair_at(i)))
    end do
    associate (independent => partition%independent())
      call new_partition(structure, independent(order%pair_at), ordered)
    end associate
    ordered%kind = partition%kind
    ordered%vectors%nrg = order%link_at(ordered%vectors%nrg)
    where (ordered%vectors%nws > 0) ordered%vectors%nws = order%pair_at(max(1, ordered%vectors%nws))
  end subroutine order_by_geometry

  !> Reach all links from link 1, and put the pairs of each in order.
  subroutine find_order(mechanism, partition, plan, start, order)
    type(mechanism_type), intent(in) :: mechanism   !< the mechanism
    type(partition_type), intent(in) :: partition   !< driven, free and dependent coordinates
    type(plan_type), intent(in) :: plan             !< its plan in any order
    real(wp), intent(in) :: start(:)                !< (M) values and guesses of the coordinates [rad, m]
    type(order_type), intent(out) :: order          !< the order of links and pairs
    type(view_type), allocatable :: views(:)
    logical :: placed(plan%n_coordinates), reached(plan%n_links)
    integer :: i, j

    call begin_order(mechanism, plan, order)
    order%own(1, :) = partition%kind
    order%own(2, :) = start/plan%unit_of
    placed = .false.
    reached = .false.
    reached(1) = .true.
    i = 0
    do while (i < order%links)
      i = i + 1
      associate (link => order%link_at(i))
        call view_pairs(mechanism, plan, order, link, placed, views)
      end associate
      do j = 1, size(views)
        order%pairs = order%pairs + 1
        order%pair_at(order%pairs) = views(j)%pair
        placed(views(j)%pair) = .true.
        if (reached(views(j)%link)) cycle
        reached(views(j)%link) = .true.
        order%entry(views(j)%link) = views(j)%pair
        order%links = order%links + 1
        order%link_at(order%links) = views(j)%link
      end do
    end do
  end subroutine find_order

  !> Collect the pairs of each link, their frames and their own features but for kind and start.
  subroutine begin_order(mechanism, plan, order)
    type(mechanism_type), intent(in) :: mechanism   !< the mechanism
    type(plan_type), intent(in) :: plan             !< its plan in any order
    type(order_type), intent(inout) :: order        !< gets the pairs of each link
    type(screw_factors_type) :: factors
    integer :: next(plan%n_links), k, i
    logical :: is_screw

    allocate (order%link_at(plan%n_links), order%pair_at(plan%n_coordinates), order%ends(2*plan%n_coordinates))
    allocate (order%entry(plan%n_links), order%first(plan%n_links + 1), source=0)
    allocate (order%frame(2, plan%n_coordinates), order%own(5, plan%n_coordinates))
    order%link_at(1) = 1
    order%first(1) = 1
    do k = 1, plan%n_coordinates
      associate (pair => mechanism%pairs(k)%pair)
        call pair%as_screw(factors, is_screw)
        order%frame(1, k) = factors%before
        order%frame(2, k) = inverse(factors%after)
        order%own(3:5, k) = [factors%turn, factors%slide*plan%unit_of(k)/plan%length, factors%offset/plan%unit_of(k)]
        order%first(pair%reference + 1) = order%first(pair%reference + 1) + 1
        order%first(pair%moving + 1) = order%first(pair%moving + 1) + 1
      end associate
    end do
    do i = 1, plan%n_links
      order%first(i + 1) = order%first(i + 1) + order%first(i)
    end do
    next = order%first(:plan%n_links)
    do k = 1, plan%n_coordinates
      associate (pair => mechanism%pairs(k)%pair)
        order%ends(next(pair%reference)) = k
        next(pair%reference) = next(pair%reference) + 1
        order%ends(next(pair%moving)) = k
        next(pair%moving) = next(pair%moving) + 1
      end associate
    end do
  end subroutine begin_order

  !> The pairs of a link that have no place yet, in their order.
  subroutine view_pairs(mechanism, plan, order, link, placed, views)
    type(mechanism_type), intent(in) :: mechanism          !< the mechanism
    type(plan_type), intent(in) :: plan                    !< its plan in any order
    type(order_type), intent(in) :: order                  !< the order so far
    integer, intent(in) :: link                            !< number of the link
    logical, intent(in) :: placed(:)                       !< (M) the pair has a place
    type(view_type), allocatable, intent(out) :: views(:)  !< the pairs
    type(view_type) :: view
    integer :: i, j, n

    allocate (views(order%first(link + 1) - order%first(link)))
    n = 0
    do i = order%first(link), order%first(link + 1) - 1
      if (placed(order%ends(i))) cycle
      call view_pair(mechanism, plan, order, link, order%ends(i), view)
      j = n
      do while (j > 0)
        if (.not. comes_before(view, views(j))) exit
        views(j + 1) = views(j)
        j = j - 1
      end do
      views(j + 1) = view
      n = n + 1
    end do
    views = views(:n)
  end subroutine view_pairs

  !> A pair as it is seen from one of its links.
  pure subroutine view_pair(mechanism, plan, order, link, pair, view)
    type(mechanism_type), intent(in) :: mechanism   !< the mechanism
    type(plan_type), intent(in) :: plan             !< its plan in any order
    type(order_type), intent(in) :: order           !< with the pairs of each link
    integer, intent(in) :: link                     !< number of the link
    integer, intent(in) :: pair                     !< number of the pair
    type(view_type), intent(out) :: view            !< gets the features and numbers
    integer :: here, there

    associate (item => mechanism%pairs(pair)%pair, own => order%own(:, pair))
      here = merge(1, 2, item%reference == link)
      there = 3 - here
      view%pair = pair
      view%link = merge(item%moving, item%reference, here == 1)
      view%features(:6) = whole([own(1:2), real(here, wp), own(3:5)])
      view%features(7:9) = relations(mechanism, plan, order, link, order%entry(link), pair)
      view%features(10:11) = relations_of_all(mechanism, plan, order, link, pair)
      view%features(12) = relation_of_other_end(mechanism, plan, order, view%link, pair)
      view%numbers = [order%frame(here, pair)%p, order%frame(here, pair)%r, order%frame(there, pair)%p, order%frame(there, pair)%r]
    end associate
  end subroutine view_pair

  !> Numbers in parts of the least difference that counts.
  pure elemental integer(long) function whole(number)
    real(wp), intent(in) :: number   !< a number that does not depend on units

    whole = nint(max(-1.0e9_wp, min(1.0e9_wp, number))/equal_features, long)
  end function whole

  !> Distance, angle between the axes and distance across these of two pairs of a link; zeros where there is no other pair.
  pure function relations(mechanism, plan, order, link, other, pair) result(features)
    type(mechanism_type), intent(in) :: mechanism   !< the mechanism
    type(plan_type), intent(in) :: plan             !< its plan in any order
    type(order_type), intent(in) :: order           !< with the frames of the pairs
    integer, intent(in) :: link                     !< number of the link
    integer, intent(in) :: other                    !< number of the other pair; 0: none
    integer, intent(in) :: pair                     !< number of the pair
    integer(long) :: features(3)
    type(pose_type) :: here, there
    real(wp) :: between(3)

    features = 0_long
    if (other == 0) return
    here = frame_in(mechanism, order, link, pair)
    there = frame_in(mechanism, order, link, other)
    between = here%p - there%p
    features = whole([norm2(between)/plan%length, dot_product(here%r(:, 3), there%r(:, 3)), &
                      norm2(between - there%r(:, 3)*dot_product(between, there%r(:, 3)))/plan%length])
  end function relations

  !> The sums of the distances and of the angles between a pair and all others of a link.
  pure function relations_of_all(mechanism, plan, order, link, pair) result(features)
    type(mechanism_type), intent(in) :: mechanism   !< the mechanism
    type(plan_type), intent(in) :: plan             !< its plan in any order
    type(order_type), intent(in) :: order           !< with the pairs of each link
    integer, intent(in) :: link                     !< number of the link
    integer, intent(in) :: pair                     !< number of the pair
    integer(long) :: features(2), found(3)
    integer :: i

    features = 0_long
    do i = order%first(link), order%first(link + 1) - 1
      found = relations(mechanism, plan, order, link, order%ends(i), pair)
      features = features + found(:2)
    end do
  end function relations_of_all

  !> The sum of the distances between a pair and the others of the link at its other end.
  pure integer(long) function relation_of_other_end(mechanism, plan, order, link, pair) result(feature)
    type(mechanism_type), intent(in) :: mechanism   !< the mechanism
    type(plan_type), intent(in) :: plan             !< its plan in any order
    type(order_type), intent(in) :: order           !< with the pairs of each link
    integer, intent(in) :: link                     !< the link at its other end
    integer, intent(in) :: pair                     !< number of the pair
    integer(long) :: features(2)

    features = relations_of_all(mechanism, plan, order, link, pair)
    feature = features(1)
  end function relation_of_other_end

  !> The frame of a pair in one of its links.
  pure type(pose_type) function frame_in(mechanism, order, link, pair)
    type(mechanism_type), intent(in) :: mechanism   !< the mechanism
    type(order_type), intent(in) :: order           !< with the frames of the pairs
    integer, intent(in) :: link                     !< number of the link
    integer, intent(in) :: pair                     !< number of the pair

    frame_in = order%frame(merge(1, 2, mechanism%pairs(pair)%pair%reference == link), pair)
  end function frame_in

  !> Whether a pair comes before another one. Pairs that are the same in all things keep the order of their numbers.
  pure logical function comes_before(a, b)
    type(view_type), intent(in) :: a   !< a pair
    type(view_type), intent(in) :: b   !< another pair
    integer :: i

    do i = 1, n_features
      comes_before = a%features(i) < b%features(i)
      if (a%features(i) /= b%features(i)) return
    end do
    do i = 1, n_numbers
      comes_before = a%numbers(i) < b%numbers(i)
      if (abs(a%numbers(i) - b%numbers(i)) > 0.0_wp) return
    end do
    comes_before = a%pair < b%pair
  end function comes_before
end module mech9_geometric_order
