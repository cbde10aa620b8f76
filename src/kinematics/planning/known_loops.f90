!> Loops that a new plan shares with an earlier one of the same mechanism: when other coordinates become independent, most loops
!> pass the same pairs as before, though often from another base and in the other direction. The dimension of the space of their
!> motions and the number of their independent equations depend on the pairs only; where base and direction are the same, too, so
!> are the rows.
module mech9_known_loops
  use mech9_kinds, only: wp
  use mech9_pose, only: pose_type
  use mech9_plan, only: plan_type, step_type, closure_type
  implicit none
  private
  public :: take_known_loops

  !> The closures in whose loops each coordinate occurs.
  type :: occurrences_type
    integer, allocatable :: first(:)      !< (M+1) coordinate k occurs in closures(first(k):first(k+1)-1)
    integer, allocatable :: closures(:)   !< numbers of the closures
  end type occurrences_type

contains

  !> Take rank and number of independent equations from another plan of the same mechanism and of the same size, for each loop that
  !> passes the same pairs there, and the rows where these are known, too.
  pure subroutine take_known_loops(known, plan, ranked, complete)
    type(plan_type), intent(in) :: known    !< the other plan, whole
    type(plan_type), intent(inout) :: plan  !< with its frames and loops; gets these properties of loops
    logical, intent(out) :: ranked(:)       !< (closures) rank and number of independent equations are known
    logical, intent(out) :: complete(:)     !< (closures) the rows are known, too
    type(occurrences_type) :: occurrences
    logical :: wanted(plan%n_coordinates)
    integer :: c, k

    occurrences = occurrences_in(known)
    wanted = .false.
    complete = .false.
    do c = 1, size(plan%closures)
      ranked(c) = plan%closures(c)%coupling > 0
      complete(c) = ranked(c)
      if (ranked(c)) cycle
      call find_closure(known, occurrences, coordinates_of(plan, plan%closures(c)), wanted, k)
      ranked(c) = k > 0
      if (k == 0) cycle
      plan%closures(c)%rank = known%closures(k)%rank
      plan%closures(c)%independent_equations = known%closures(k)%independent_equations
      ! six equations have no rows
      complete(c) = known%closures(k)%rank == 6
      if (.not. complete(c)) complete(c) = same_loop(known, known%closures(k), plan, plan%closures(c))
      if (complete(c)) plan%closures(c)%rows = known%closures(k)%rows
    end do
  end subroutine take_known_loops

  !> The coordinates of a loop.
  pure function coordinates_of(plan, closure) result(coordinates)
    type(plan_type), intent(in) :: plan         !< the plan of the mechanism
    type(closure_type), intent(in) :: closure   !< the closure of the loop
    integer :: coordinates(size(closure%loop%steps))

    coordinates = plan%steps(closure%loop%steps)%coordinate
  end function coordinates_of

  !> The closures in whose loops each coordinate of a plan occurs.
  pure function occurrences_in(plan) result(occurrences)
    type(plan_type), intent(in) :: plan   !< the plan of the mechanism
    type(occurrences_type) :: occurrences
    integer :: next(plan%n_coordinates), c, i, k

    allocate (occurrences%first(plan%n_coordinates + 1), source=0)
    do c = 1, size(plan%closures)
      do i = 1, size(plan%closures(c)%loop%steps)
        k = plan%steps(plan%closures(c)%loop%steps(i))%coordinate
        occurrences%first(k + 1) = occurrences%first(k + 1) + 1
      end do
    end do
    occurrences%first(1) = 1
    do k = 1, plan%n_coordinates
      occurrences%first(k + 1) = occurrences%first(k) + occurrences%first(k + 1)
    end do
    next = occurrences%first(:plan%n_coordinates)
    allocate (occurrences%closures(occurrences%first(plan%n_coordinates + 1) - 1))
    do c = 1, size(plan%closures)
      do i = 1, size(plan%closures(c)%loop%steps)
        k = plan%steps(plan%closures(c)%loop%steps(i))%coordinate
        occurrences%closures(next(k)) = c
        next(k) = next(k) + 1
      end do
    end do
  end function occurrences_in

  !> The closure whose loop has exactly these coordinates; 0: none.
  pure subroutine find_closure(plan, occurrences, coordinates, wanted, found)
    type(plan_type), intent(in) :: plan                       !< the plan of the mechanism
    type(occurrences_type), intent(in) :: occurrences         !< of its coordinates
    integer, intent(in) :: coordinates(:)                     !< coordinates of a loop
    logical, intent(inout) :: wanted(:)                       !< (M) scratch, all false before and after
    integer, intent(out) :: found                             !< number of the closure
    integer :: i, k

    wanted(coordinates) = .true.
    ! a coordinate that occurs in few loops leaves few to be compared
    k = coordinates(minloc(occurrences%first(coordinates + 1) - occurrences%first(coordinates), 1))
    do i = occurrences%first(k), occurrences%first(k + 1) - 1
      found = occurrences%closures(i)
      if (plan%closures(found)%coupling > 0) cycle
      if (size(plan%closures(found)%loop%steps) /= size(coordinates)) cycle
      if (all(wanted(coordinates_of(plan, plan%closures(found))))) exit
    end do
    if (i == occurrences%first(k + 1)) found = 0
    wanted(coordinates) = .false.
  end subroutine find_closure

  !> Whether two loops are built alike from their bases on: the same pairs, passed in the same directions, between the same poses.
  pure logical function same_loop(a_plan, a, b_plan, b) result(same)
    type(plan_type), intent(in) :: a_plan   !< plan of the first loop
    type(closure_type), intent(in) :: a     !< the first loop
    type(plan_type), intent(in) :: b_plan   !< plan of the second loop
    type(closure_type), intent(in) :: b     !< the second loop
    integer :: i

    same = size(a%loop%steps) == size(b%loop%steps)
    if (.not. same) return
    same = all(a%loop%signs*b%loop%signs > 0.0_wp) .and. place_of(a%target, a) == place_of(b%target, b) .and. &
           same_pose(a%in_target, b%in_target)
    do i = 1, size(a%loop%steps)
      if (.not. same) return
      same = same_step(a_plan%steps(a%loop%steps(i)), b_plan%steps(b%loop%steps(i))) .and. &
             place_of(a_plan%steps(a%loop%steps(i))%parent, a) == place_of(b_plan%steps(b%loop%steps(i))%parent, b)
    end do
  end function same_loop

  !> Whether two steps pass the same pair in the same direction, after the same constant pose.
  pure logical function same_step(a, b) result(same)
    type(step_type), intent(in) :: a   !< the first step
    type(step_type), intent(in) :: b   !< the second step

    same = a%coordinate == b%coordinate .and. (a%reversed .eqv. b%reversed) .and. (a%is_screw .eqv. b%is_screw) .and. &
           all(abs([a%turn - b%turn, a%slide - b%slide, a%offset - b%offset]) <= 0.0_wp) .and. same_pose(a%before, b%before)
  end function same_step

  !> Whether all numbers of two poses are equal.
  pure logical function same_pose(a, b)
    type(pose_type), intent(in) :: a   !< the first pose
    type(pose_type), intent(in) :: b   !< the second pose

    same_pose = all(abs(a%r - b%r) <= 0.0_wp) .and. all(abs(a%p - b%p) <= 0.0_wp)
  end function same_pose

  !> The place of a frame among those of a loop; 0 for its base.
  pure integer function place_of(frame, closure) result(place)
    integer, intent(in) :: frame                !< number of the frame
    type(closure_type), intent(in) :: closure   !< the closure of the loop

    do place = size(closure%loop%steps), 1, -1
      if (closure%loop%steps(place) == frame) return
    end do
  end function place_of
end module mech9_known_loops
