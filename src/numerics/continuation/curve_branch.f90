!> A branch of a curve as rows of points, with the reasons why it ends.
module mech9_curve_branch
  use mech9_kinds, only: wp
  use mech9_error, only: error_type
  use mech9_curve, only: curve_point_type, verdict_type
  implicit none
  private
  public :: curve_branch_type, branch_end_type, curve_settings_type, join_halves
  public :: ends_low, ends_high, ends_points, ends_closed, ends_range, ends_failed, ends_stopped, ends_special

  !> Why a branch ends: at the least or largest value of the parameter, after so many points, where it began, at the end of the range in
  !> which solutions have a meaning, because no further point was found, because the work was stopped, or at an end of this range which is a
  !> special point.
  integer, parameter :: ends_low = 1, ends_high = 2, ends_points = 3, ends_closed = 4, ends_range = 5, &
    ends_failed = 6, ends_stopped = 7, ends_special = 8

  !> The bounds of steps and branches. The parameter counts in parts of its range.
  type :: curve_settings_type
    real(wp) :: step = 0.05_wp                !< longest step, as an image
    integer :: points = 1000                  !< largest number of points of a branch in each direction
    real(wp) :: low = 0.0_wp                  !< least value of the parameter
    real(wp) :: high = 1.0_wp                 !< its largest value
    integer :: branches = 20                  !< largest number of branches
    integer :: doublings = 3                  !< periods of solutions that are followed double at most so often
  end type curve_settings_type

  !> One end of a branch.
  type :: branch_end_type
    integer :: reason = 0                     !< one of the constants above
    real(wp) :: last_step = 0.0_wp            !< length of the last step that was tried, where no further point was found
    type(error_type), allocatable :: err      !< why the equations had no value there, if this is the reason
    real(wp), allocatable :: turns(:)         !< (m) periods by which a closed branch comes back
  end type branch_end_type

  !> The points of a branch.
  type :: curve_branch_type
    integer :: count = 0                      !< number of points
    real(wp), allocatable :: z(:, :)          !< (m,count) their images; then room for more
    real(wp), allocatable :: growth(:)        !< (count) largest real parts of their roots [1/s]
    logical, allocatable :: stable(:)         !< (count) no small deviation grows
    integer, allocatable :: kind(:)           !< (count) kinds of points
    type(branch_end_type) :: ends(2)          !< at the first point and at the last one
    integer :: from = 0                       !< number of the branch point at which it begins; 0: the start
    integer :: start = 0                      !< number of the point at which it was begun
    integer :: doublings = 0                  !< times by which the period doubled on the way to it; -1: it was halved
  contains
    procedure :: add
  end type curve_branch_type

contains

  !> Add a point.
  pure subroutine add(self, point, verdict, kind)
    class(curve_branch_type), intent(inout) :: self    !< the branch
    type(curve_point_type), intent(in) :: point        !< the point
    type(verdict_type), intent(in) :: verdict          !< its stability
    integer, intent(in) :: kind                        !< its kind

    if (.not. allocated(self%z)) then
      allocate (self%z(size(point%z), 64), self%growth(64), self%stable(64), self%kind(64))
    else if (self%count == size(self%growth)) then
      call grow(self)
    end if
    self%count = self%count + 1
    self%z(:, self%count) = point%z
    self%growth(self%count) = verdict%growth
    self%stable(self%count) = verdict%is_stable
    self%kind(self%count) = kind
  end subroutine add

  !> Double the room.
  pure subroutine grow(self)
    class(curve_branch_type), intent(inout) :: self    !< the branch
    real(wp), allocatable :: z(:, :), growth(:)
    logical, allocatable :: stable(:)
    integer, allocatable :: kind(:)
    integer :: n

    n = self%count
    allocate (z(size(self%z, 1), 2*n), growth(2*n), stable(2*n), kind(2*n))
    z(:, :n) = self%z
    growth(:n) = self%growth
    stable(:n) = self%stable
    kind(:n) = self%kind
    call move_alloc(z, self%z)
    call move_alloc(growth, self%growth)
    call move_alloc(stable, self%stable)
    call move_alloc(kind, self%kind)
  end subroutine grow

  !> One branch from its parts in both directions, which begin at the same point.
  subroutine join_halves(backward, forward, branch)
    type(curve_branch_type), intent(in) :: backward    !< against the direction; of one point or more
    type(curve_branch_type), intent(in) :: forward     !< along it
    type(curve_branch_type), intent(inout) :: branch   !< gets the points from the end of the first to that of the second
    integer :: n, i

    n = backward%count
    branch%count = n + forward%count - 1
    branch%start = n
    branch%z = reshape([backward%z(:, [(i, i=n, 1, -1)]), forward%z(:, 2:forward%count)], [size(forward%z, 1), branch%count])
    branch%growth = [backward%growth(n:1:-1), forward%growth(2:forward%count)]
    branch%stable = [backward%stable(n:1:-1), forward%stable(2:forward%count)]
    branch%kind = [backward%kind(n:1:-1), forward%kind(2:forward%count)]
    branch%ends(1) = backward%ends(2)
    branch%ends(2) = forward%ends(2)
    branch%doublings = forward%doublings
  end subroutine join_halves
end module mech9_curve_branch
