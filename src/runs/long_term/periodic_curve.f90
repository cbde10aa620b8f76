!> Periodic motions of a model over one of its parameters, as a curve of solutions. Drives, loads or motors follow time, so that the period
!> is a multiple of that of their laws.
!>
!> The unknowns are the state at the start of a period and the parameter; the image has all coordinates at the start, then the rest of the
!> state. The state at the end has exact derivatives by both (mech9_period_map). Real multipliers beyond -1 and pairs of them cross the
!> unit circle where their logarithms cross the imaginary axis: these are the roots of a motion.
module mech9_periodic_curve
  use mech9_kinds, only: wp
  use mech9_error, only: error_type
  use mech9_model, only: model_type
  use mech9_simulation, only: interruption_type
  use mech9_curve, only: curve_type, curve_point_type, verdict_type, period_doubling, torus
  use mech9_curve_step, only: correction_type, correct
  use mech9_single_parameter, only: single_parameter_type
  use mech9_law_periods, only: law_period_type, find_law_period
  use mech9_period_map, only: period_map_type
  use mech9_periodic_motion, only: periodic_motion_type, find_multipliers
  implicit none
  private
  public :: periodic_curve_type, begin_periodic_curve

  type, extends(curve_type) :: periodic_curve_type
    type(single_parameter_type), pointer :: variable => null()   !< the model as a function of the parameter; not owned
    type(period_map_type) :: map                                 !< of the last evaluation; to be closed
    real(wp), allocatable :: unit(:)                             !< (m-1) of the components of an image but for the parameter
    real(wp) :: range = 1.0_wp                                   !< of the parameter, in the units of the data file
    integer :: multiple = 1                                      !< periods of the laws in one of the motion
    real(wp) :: period_of_motion = 0.0_wp                        !< at the last point [s]
    type(curve_point_type) :: last                               !< the last point that was evaluated
    class(interruption_type), allocatable :: interruption        !< is asked whether the work shall stop
  contains
    procedure :: evaluate
    procedure :: change_unknowns
    procedure :: judge
    procedure :: kind_of_crossing
    procedure :: is_stopped
  end type periodic_curve_type

  !> Tolerances of steps: what Newton's method corrects is above the errors that they leave.
  real(wp), parameter :: relative_tolerance = 1.0e-12_wp, absolute_tolerance = 1.0e-13_wp
  !> Part of the range of the parameter over which the period is differentiated: it changes little and smoothly.
  real(wp), parameter :: part_of_range = 1.0e-5_wp
  !> Multipliers below this are lost in round-off of the others.
  real(wp), parameter :: least_multiplier = 1.0e-14_wp
  !> A pair of multipliers is -1 where its angle is so near to half a turn, in parts of it.
  real(wp), parameter :: half_turn = 1.0e-3_wp
  real(wp), parameter :: turn = 8.0_wp*atan(1.0_wp)

contains

  !> Begin the curve at a periodic motion.
  subroutine begin_periodic_curve(variable, model, motion, value, range, curve, point, err)
    type(single_parameter_type), intent(in), target :: variable   !< the model as a function of the parameter; outlives the curve
    type(model_type), intent(in) :: model                         !< the model at the start
    type(periodic_motion_type), intent(in) :: motion              !< the periodic motion
    real(wp), intent(in) :: value                                 !< of the parameter, in the units of the data file
    real(wp), intent(in) :: range                                 !< of the parameter, above 0, in the units of the data file
    type(periodic_curve_type), intent(inout) :: curve             !< gets the problem
    type(curve_point_type), intent(inout) :: point                !< gets the start
    type(error_type), allocatable, intent(out) :: err             !< allocated if it failed
    type(law_period_type) :: laws
    real(wp), allocatable :: state(:)
    integer :: i, coordinates

    curve%variable => variable
    curve%range = range
    call find_law_period(model, laws, err)
    if (.not. allocated(err)) call curve%map%begin(model, err)
    if (allocated(err)) return
    curve%period_of_motion = motion%period
    if (laws%is_known) curve%multiple = max(1, nint(motion%period/laws%period))
    associate (map => curve%map)
      coordinates = size(map%unit_of_coordinate)
      curve%n = map%states
      curve%m = coordinates + map%states - size(map%free) + 1
      curve%unit = [map%unit_of_coordinate, map%unit_of(size(map%free) + 1:)]
      curve%unit(coordinates + 1:coordinates + size(map%free)) = &
        curve%unit(coordinates + 1:coordinates + size(map%free))*(turn/motion%period)
      allocate (curve%period(curve%m), source=0.0_wp)
      curve%period(:coordinates) = map%period_of/map%unit_of_coordinate
      state = map%state_of(motion%q, motion%dq, motion%motor)
      call curve%evaluate([map%free, [(i, i=coordinates + 1, curve%m)]], &
                          [motion%q/map%unit_of_coordinate, state(size(map%free) + 1:)/curve%unit(coordinates + 1:), value/range], &
                          point, err)
    end associate
    if (.not. allocated(err)) call make_exact(curve, point)
  end subroutine begin_periodic_curve

  !> Correct a motion that was found to larger tolerances, with the parameter held.
  subroutine make_exact(curve, point)
    type(periodic_curve_type), intent(inout) :: curve     !< the curve
    type(curve_point_type), intent(inout) :: point        !< the motion; as it is where the correction does not converge
    type(curve_point_type) :: exact
    type(correction_type) :: correction
    real(wp) :: normal(curve%n + 1)

    normal = 0.0_wp
    normal(curve%n + 1) = 1.0_wp
    call correct(curve, point, normal, 0.0_wp, 0.0_wp*normal, exact, correction)
    if (correction%done) point = exact
  end subroutine make_exact

  !> The difference of both ends of a motion, with derivatives.
  subroutine evaluate(self, place, guess, point, err)
    class(periodic_curve_type), intent(inout) :: self     !< the curve
    integer, intent(in) :: place(:)                       !< (n+1) free coordinates, the rest of the state, and the parameter
    real(wp), intent(in) :: guess(:)                      !< (m) image, in its units
    type(curve_point_type), intent(out) :: point          !< the point, without a tangent
    type(error_type), allocatable, intent(out) :: err     !< allocated if it failed
    class(model_type), allocatable :: model
    real(wp), allocatable :: by_state(:, :), by_period(:)
    real(wp) :: slope, unit(self%n)
    integer :: i, j, coordinates

    self%last%z = [real(wp) ::]
    allocate (model)
    call self%variable%at([guess(self%m)*self%range], model, err)
    if (.not. allocated(err)) call find_period(self, guess(self%m)*self%range, model, slope, err)
    if (allocated(err)) return
    associate (solver => model%request%solver)
      solver%relative_tolerance = min(solver%relative_tolerance, relative_tolerance)
      solver%absolute_tolerance = min(solver%absolute_tolerance, absolute_tolerance)
    end associate
    unit = self%unit(place(:self%n))
    if (allocated(self%interruption)) then
      call self%map%begin(model, err, self%interruption, variable=self%variable)
    else
      call self%map%begin(model, err, variable=self%variable)
    end if
    if (.not. allocated(err)) call self%map%evaluate(guess(place(:self%n))*unit, self%period_of_motion, err)
    if (allocated(err)) return
    allocate (point%jacobian(self%n, self%n + 1), point%slopes(self%m, self%n + 1), source=0.0_wp)
    point%place = place
    coordinates = size(self%map%unit_of_coordinate)
    point%z = guess
    point%z(:coordinates) = self%map%start%q/self%map%unit_of_coordinate
    point%z(place) = guess(place)
    point%residual = self%map%residual()/unit
    call self%map%jacobian(by_state, by_period)
    do j = 1, self%n + 1
      point%slopes(place(j), j) = 1.0_wp
      do i = 1, self%n
        if (j <= self%n) then
          point%jacobian(i, j) = by_state(i, j)*(unit(j)/unit(i))
        else
          point%jacobian(i, j) = (self%map%by_parameters(i, 1) + by_period(i)*slope)*(self%range/unit(i))
        end if
      end do
    end do
    self%last = point
  end subroutine evaluate

  !> Find the period of the motion, and its derivative by the parameter.
  subroutine find_period(self, value, model, slope, err)
    class(periodic_curve_type), intent(inout) :: self     !< the curve; gets the period
    real(wp), intent(in) :: value                         !< of the parameter, in the units of the data file
    class(model_type), intent(in) :: model                !< the model there
    real(wp), intent(out) :: slope                        !< derivative of the period, by the units of the data file
    type(error_type), allocatable, intent(out) :: err     !< allocated if the laws have no common period
    class(model_type), allocatable :: beside
    type(law_period_type) :: laws
    real(wp) :: periods(2)
    integer :: side

    slope = 0.0_wp
    call find_law_period(model, laws, err)
    if (allocated(err) .or. .not. laws%is_known) return
    self%period_of_motion = self%multiple*laws%period
    do side = 1, 2
      allocate (beside)
      call self%variable%at([value + (2*side - 3)*part_of_range*self%range], beside, err)
      if (.not. allocated(err)) call find_law_period(beside, laws, err)
      deallocate (beside)
      if (allocated(err)) return
      periods(side) = self%multiple*laws%period
    end do
    slope = (periods(2) - periods(1))/(2.0_wp*part_of_range*self%range)
    ! equal periods differ by round-off
    if (abs(periods(2) - periods(1)) <= 8.0_wp*spacing(periods(1))) slope = 0.0_wp
  end subroutine find_period

  !> The unknowns serve everywhere.
  subroutine change_unknowns(self, point, err)
    class(periodic_curve_type), intent(inout) :: self     !< the curve
    type(curve_point_type), intent(inout) :: point        !< unchanged
    type(error_type), allocatable, intent(out) :: err     !< never allocated
  end subroutine change_unknowns

  !> The stability of a periodic motion: the logarithms of its multipliers over the period.
  subroutine judge(self, point, verdict)
    class(periodic_curve_type), intent(inout) :: self     !< the curve
    type(curve_point_type), intent(in) :: point           !< on the curve
    type(verdict_type), intent(out) :: verdict            !< stability
    complex(wp), allocatable :: multipliers(:)
    type(curve_point_type) :: again
    type(error_type), allocatable :: err
    integer :: i
    logical :: is_last

    allocate (verdict%roots(0))
    verdict%is_stable = .false.
    is_last = size(self%last%z) == size(point%z)
    if (is_last) is_last = all(abs(self%last%z - point%z) <= 0.0_wp)
    if (.not. is_last) call self%evaluate(point%place, point%z, again, err)
    if (allocated(err)) return
    call find_multipliers(self%map%monodromy, multipliers)
    do i = 1, size(multipliers)
      if (aimag(multipliers(i)) < 0.0_wp) cycle
      verdict%roots = [verdict%roots, cmplx(log(max(abs(multipliers(i)), least_multiplier)), &
                                            atan2(aimag(multipliers(i)), real(multipliers(i), wp)), wp)/self%period_of_motion]
    end do
    verdict%growth = maxval(real(verdict%roots, wp))
    verdict%is_stable = .not. verdict%growth > 0.0_wp
  end subroutine judge

  !> The kind of a point at which a pair of roots crosses the imaginary axis: one whose multipliers are -1 doubles the period.
  integer function kind_of_crossing(self, point) result(kind)
    class(periodic_curve_type), intent(inout) :: self     !< the curve
    type(curve_point_type), intent(in) :: point           !< on the curve
    type(verdict_type) :: verdict
    integer :: i

    call self%judge(point, verdict)
    i = minloc(abs(real(verdict%roots, wp)), dim=1, mask=abs(aimag(verdict%roots)) > 0.0_wp)
    kind = torus
    if (i == 0) return
    if (abs(aimag(verdict%roots(i))*self%period_of_motion - 0.5_wp*turn) < half_turn) kind = period_doubling
  end function kind_of_crossing

  !> Whether the work shall stop.
  logical function is_stopped(self) result(stopped)
    class(periodic_curve_type), intent(in) :: self        !< the curve

    stopped = .false.
    if (allocated(self%interruption)) stopped = self%interruption%is_wanted()
  end function is_stopped
end module mech9_periodic_curve
