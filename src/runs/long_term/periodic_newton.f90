!> The search for a periodic motion by Newton's method on the map over a period.
!>
!> A free motion has its period among the unknowns. Two more conditions then hold: the start moves across the flow, and where a family of
!> motions passes, as in motions that conserve energy, the correction is the least one in which the period is cheap. Steps are
!> damped by the natural test of monotonicity (P. Deuflhard, Newton Methods for Nonlinear Problems, Springer 2004).
module mech9_periodic_newton
  use mech9_kinds, only: wp
  use mech9_error, only: error_type, exit_interrupted
  use mech9_singular_values, only: decompose
  use mech9_period_map, only: period_map_type
  implicit none
  private
  public :: newton_type

  integer, parameter :: most_iterations = 60
  !> Largest change of a coordinate by one step [rad, lengths of the mechanism], and of the period, as part of it.
  real(wp), parameter :: longest_step = 1.0_wp, longest_stretch = 0.3_wp
  !> Least part of a step that is tried.
  real(wp), parameter :: least_part = 1.0_wp/512.0_wp
  !> Singular values below these belong to families of motions: of free motions, as those that conserve energy, whose numbers have errors of
  !> steps, and of driven ones, where a coordinate does not matter at all. Numbers of the matrix are about 1.
  real(wp), parameter :: singular_free = 1.0e-7_wp, singular_driven = 1.0e-13_wp
  !> The change of the period, as part of it, counts for this part of one of a coordinate.
  real(wp), parameter :: cheap_period = 1.0e-3_wp
  !> Corrections up to so many times the relative tolerance of the motion are errors of its steps.
  real(wp), parameter :: of_steps = 50.0_wp, of_residual = 0.1_wp
  !> Corrections that shrink by no more than this are those of errors; at a multiple root they shrink by 2/3.
  real(wp), parameter :: slowest = 0.75_wp
  !> A free motion whose period shrinks to this part of the guess is none.
  real(wp), parameter :: least_period = 0.02_wp
  real(wp), parameter :: turn = 8.0_wp*atan(1.0_wp)

  !> The search and where it stands.
  type :: newton_type
    logical :: is_free = .false.          !< the period is unknown
    real(wp) :: period = 0.0_wp           !< [s]
    real(wp) :: tolerance = 0.0_wp        !< corrections below it are small: of coordinates in their units, rates by period
    real(wp), allocatable :: x(:)         !< (states) the state at the start
    real(wp), allocatable :: scale(:)     !< (states) unit of each number of the state
    real(wp) :: correction = huge(1.0_wp) !< size of the last correction, in these units
    logical :: converged = .false.        !< it is small
    integer :: iterations = 0             !< corrections so far
    integer :: evaluations = 0            !< motions over a period so far
    real(wp) :: size_of_matrix = 1.0_wp   !< the largest number of the matrix of the last correction, 1 at least
    real(wp), allocatable, private :: u(:, :), s(:), v(:, :)   !< the matrix of the last correction, decomposed
  contains
    procedure :: begin
    procedure :: find
    procedure :: size_of_residual
    procedure, private :: evaluate
    procedure, private :: factorize
    procedure, private :: solve
    procedure, private :: damp
  end type newton_type

contains

  !> Begin at a state.
  subroutine begin(self, map, x, period, is_free)
    class(newton_type), intent(inout) :: self        !< the search
    type(period_map_type), intent(in) :: map         !< the map, begun
    real(wp), intent(in) :: x(:)                     !< (states) the state at the start
    real(wp), intent(in) :: period                   !< or its guess [s]
    logical, intent(in) :: is_free                   !< the period is unknown
    integer :: n

    n = size(map%free)
    self%is_free = is_free
    self%period = period
    self%x = x
    self%scale = map%unit_of
    self%scale(n + 1:2*n) = map%unit_of(n + 1:2*n)*turn/period
    self%tolerance = max(of_steps*map%model%request%solver%relative_tolerance, 64.0_wp*epsilon(1.0_wp))
    self%correction = huge(1.0_wp)
    self%converged = .false.
  end subroutine begin

  !> Search from the present state. Not converged where nothing failed but no periodic motion is near; a failure of the motion from the
  !> first state is handed on.
  subroutine find(self, map, err)
    class(newton_type), intent(inout) :: self           !< the search
    type(period_map_type), intent(inout) :: map         !< the map; evaluated at the last state
    type(error_type), allocatable, intent(out) :: err   !< allocated if the motion failed
    real(wp), allocatable :: step(:)
    real(wp) :: guess, before
    integer :: iteration
    logical :: moved

    guess = self%period
    before = huge(before)
    call self%evaluate(map, self%x, self%period, err)
    do iteration = 1, most_iterations
      if (allocated(err)) return
      call self%factorize(map)
      call self%solve(map, step)
      self%correction = maxval(abs(step))
      ! nothing corrects a residual along which the matrix is singular
      self%converged = self%correction <= self%tolerance .and. &
                       self%size_of_residual(map) <= 2.0_wp*size(step)*self%size_of_matrix*self%tolerance
      if (.not. self%correction < slowest*before) self%converged = self%converged .or. is_at_round_off(self, map)
      if (self%converged) exit
      before = self%correction
      call self%damp(map, step, moved, err)
      if (allocated(err)) return
      if (.not. moved) self%converged = is_at_round_off(self, map)
      if (.not. moved .or. self%period < least_period*guess) return
      self%iterations = self%iterations + 1
    end do
    if (.not. self%converged) return
    if (self%correction > self%tolerance) return
    ! the last correction is applied, too
    associate (n => size(self%x))
      self%x = self%x + step(:n)*self%scale
      if (self%is_free) self%period = self%period*(1.0_wp + step(n + 1))
    end associate
    self%iterations = self%iterations + 1
  end subroutine find

  !> Whether both ends agree within the errors of steps, though a small singular value makes the correction large.
  pure logical function is_at_round_off(self, map)
    class(newton_type), intent(in) :: self           !< the search
    type(period_map_type), intent(in) :: map         !< the map, evaluated

    is_at_round_off = self%size_of_residual(map) <= of_residual*self%tolerance*self%size_of_matrix
  end function is_at_round_off

  !> Evaluate the map.
  subroutine evaluate(self, map, x, period, err)
    class(newton_type), intent(inout) :: self           !< counts it
    type(period_map_type), intent(inout) :: map         !< the map
    real(wp), intent(in) :: x(:)                        !< (states) the state at the start
    real(wp), intent(in) :: period                      !< [s]
    type(error_type), allocatable, intent(out) :: err   !< allocated if the motion failed

    self%evaluations = self%evaluations + 1
    call map%evaluate(x, period, err)
  end subroutine evaluate

  !> Decompose the matrix of the correction at the present state.
  subroutine factorize(self, map)
    class(newton_type), intent(inout) :: self       !< gets it
    type(period_map_type), intent(in) :: map        !< the map, evaluated
    real(wp), allocatable :: by_state(:, :), by_period(:), a(:, :)
    real(wp) :: along(size(self%x))
    integer :: i, n, m

    n = size(self%x)
    m = n + merge(1, 0, self%is_free)
    call map%jacobian(by_state, by_period)
    allocate (a(m, m), source=0.0_wp)
    do i = 1, n
      a(:n, i) = by_state(:, i)*self%scale(i)/self%scale
    end do
    self%size_of_matrix = max(1.0_wp, maxval(abs(a(:n, :n))))
    if (self%is_free) then
      self%size_of_matrix = max(self%size_of_matrix, maxval(abs(by_period*self%period/self%scale)))
      a(:n, m) = by_period*self%period/self%scale/cheap_period
      along = map%rate_at_start*self%period/self%scale
      if (norm2(along) > 0.0_wp) a(m, :n) = along/norm2(along)
    end if
    if (allocated(self%s)) deallocate (self%u, self%s, self%v)
    allocate (self%u(m, m), self%s(m), self%v(m, m))
    call decompose(a, self%u, self%s, self%v)
  end subroutine factorize

  !> The correction for the residual of the map, by the matrix that was decomposed last.
  subroutine solve(self, map, step)
    class(newton_type), intent(in) :: self              !< the search
    type(period_map_type), intent(in) :: map            !< the map, evaluated
    real(wp), allocatable, intent(out) :: step(:)       !< of the state in its units, and of the period as part of it
    real(wp) :: right(size(self%s)), part
    integer :: i, n

    n = size(self%x)
    right = 0.0_wp
    right(:n) = -map%residual()/self%scale
    allocate (step(size(self%s)), source=0.0_wp)
    do i = 1, size(self%s)
      if (self%s(i) <= merge(singular_free, singular_driven, self%is_free)) cycle
      part = dot_product(self%u(:, i), right)/self%s(i)
      step = step + part*self%v(:, i)
    end do
    if (self%is_free) step(n + 1) = step(n + 1)/cheap_period
  end subroutine solve

  !> Make the largest part of a step after which the correction by the same matrix is smaller.
  subroutine damp(self, map, step, moved, err)
    class(newton_type), intent(inout) :: self           !< the search; moves
    type(period_map_type), intent(inout) :: map         !< the map; evaluated at the new state
    real(wp), intent(in) :: step(:)                     !< the whole step
    logical, intent(out) :: moved                       !< a part of it was made
    type(error_type), allocatable, intent(out) :: err   !< allocated if the motion was interrupted
    real(wp), allocatable :: next(:)
    real(wp) :: part, x(size(self%x)), period
    integer :: n

    n = size(self%x)
    moved = .false.
    part = min(1.0_wp, longest_step/max(maxval(abs(step(:n))), tiny(1.0_wp)))
    if (self%is_free) part = min(part, longest_stretch/max(abs(step(n + 1)), longest_stretch))
    do while (part >= least_part*min(1.0_wp, longest_step/max(maxval(abs(step(:n))), longest_step)))
      x = self%x + part*step(:n)*self%scale
      period = self%period
      if (self%is_free) period = period*(1.0_wp + part*step(n + 1))
      call self%evaluate(map, x, period, err)
      if (allocated(err)) then
        if (err%code == exit_interrupted) return
        deallocate (err)
      else
        call self%solve(map, next)
        moved = norm2(next) <= (1.0_wp - 0.25_wp*part)*norm2(step) .or. maxval(abs(next)) <= self%tolerance
        if (moved) exit
      end if
      part = 0.5_wp*part
    end do
    if (.not. moved) then
      ! the map is that of the last state again
      call self%evaluate(map, self%x, self%period, err)
      return
    end if
    self%x = x
    self%period = period
  end subroutine damp

  !> The largest number of the residual, in the units of the state.
  pure real(wp) function size_of_residual(self, map)
    class(newton_type), intent(in) :: self           !< the search
    type(period_map_type), intent(in) :: map         !< the map, evaluated

    size_of_residual = maxval(abs(map%residual()/self%scale))
  end function size_of_residual
end module mech9_periodic_newton
