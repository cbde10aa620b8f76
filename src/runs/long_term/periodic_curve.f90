!> Periodic motions of a model over one of its parameters, as a curve of solutions. Where drives, loads or motors follow time, the period
!> is a multiple of that of their laws; else each motion has its own.
!>
!> The unknowns are the state at the start of a period and the parameter; the image has all coordinates at the start, then the rest of the
!> state. A period of its own is an unknown and part of the image, too, and the start lies in a plane (mech9_phase_plane). The state at the
!> end has exact derivatives by all of them (mech9_period_map). Real multipliers beyond -1 and pairs of them cross the unit circle where
!> their logarithms cross the imaginary axis: these are the roots of a motion. The multiplier 1 along a free motion is split off by its
!> exact eigenvector, the flow, so that one beside it is known where motions have a fold.
!>
!> A branch of free motions ends where they shrink to a position of rest. There the start crosses its plane without a rate. This Hopf
!> point is found apart: the position of rest by a map over a quarter of the period, whose multipliers tell where its vibration neither
!> grows nor decays.
module mech9_periodic_curve
  use mech9_kinds, only: wp
  use mech9_error, only: error_type, raise, exit_assembly
  use mech9_model, only: model_type
  use mech9_simulation, only: interruption_type
  use mech9_curve, only: curve_type, curve_point_type, verdict_type, regular, hopf, period_doubling, torus
  use mech9_curve_step, only: correction_type, correct
  use mech9_single_parameter, only: single_parameter_type
  use mech9_law_periods, only: law_period_type, find_law_period
  use mech9_period_map, only: period_map_type
  use mech9_phase_plane, only: phase_plane_type, choose_plane, plane_across, crosses_well
  use mech9_periodic_motion, only: periodic_motion_type, find_multipliers
  use mech9_monodromy_matrix, only: split_off, find_alternating, solve_square
  implicit none
  private
  public :: periodic_curve_type, begin_periodic_curve

  type, extends(curve_type) :: periodic_curve_type
    type(single_parameter_type), pointer :: variable => null()   !< the model as a function of the parameter; not owned
    type(period_map_type) :: map                                 !< of the last evaluation; to be closed
    real(wp), allocatable :: unit(:)                             !< (m-1) of the components of an image but for the parameter
    real(wp) :: range = 1.0_wp                                   !< of the parameter, in the units of the data file
    integer, allocatable :: multiples(:)                         !< periods of the laws in one of the motion, by the number of the equations
    logical :: is_free = .false.                                 !< the period belongs to the motion
    logical :: goes_on = .false.                                 !< cyclic coordinates do not come back
    integer :: states = 0                                        !< numbers of a state
    type(phase_plane_type), allocatable :: planes(:)             !< of the starts of free motions, by the number of the equations
    real(wp) :: period_of_motion = 0.0_wp                        !< at the last point [s]
    type(curve_point_type) :: last                               !< the last point that was evaluated
    class(interruption_type), allocatable :: interruption        !< is asked whether the work shall stop
  contains
    procedure :: evaluate
    procedure :: change_unknowns
    procedure :: judge
    procedure :: gap
    procedure :: meet_end
    procedure :: kind_of_crossing
    procedure :: double
    procedure :: halve
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
  !> A motion repeats after half its period where both ends of the half differ by less, in units of the curve.
  real(wp), parameter :: repeats = 1.0e-6_wp
  !> A free motion has shrunk to a position of rest where its start crosses the plane at a rate below this, in units of the state over the
  !> angle of the period. Motions as small as this are lost in errors of steps.
  real(wp), parameter :: at_rest = 1.0e-6_wp
  !> Rates below this, in the same units, are errors of a steady motion.
  real(wp), parameter :: steady = 1.0e-9_wp
  !> A free motion whose period shrinks to this part of the first one is none.
  real(wp), parameter :: least_period = 0.02_wp
  !> The search for a Hopf point moves the parameter by this part of its range first. It has ended at a move of the second one, or at one of
  !> the third one that no longer shrinks: round-off.
  real(wp), parameter :: first_move = 1.0e-5_wp, last_move = 1.0e-13_wp, stagnated_move = 1.0e-10_wp
  !> Steps of this search, and of that for a position of rest, whose correction is then below the tolerance.
  integer, parameter :: most_steps = 15
  real(wp), parameter :: rest_tolerance = 1.0e-11_wp
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
    real(wp), allocatable :: state(:), start(:)
    integer :: i, coordinates

    curve%variable => variable
    curve%range = range
    curve%is_free = motion%is_free
    curve%goes_on = motion%cyclic > 0
    call find_law_period(model, laws, err)
    if (.not. allocated(err)) call curve%map%begin(model, err)
    if (allocated(err)) return
    if (curve%goes_on) curve%map%goes_on = curve%map%may_go_on
    curve%period_of_motion = motion%period
    curve%multiples = [1]
    if (laws%is_known .and. .not. curve%is_free) curve%multiples = [max(1, nint(motion%period/laws%period))]
    associate (map => curve%map)
      coordinates = size(map%unit_of_coordinate)
      curve%states = map%states
      curve%n = map%states + merge(1, 0, curve%is_free)
      curve%m = coordinates + curve%n - size(map%free) + 1
      curve%unit = [map%unit_of_coordinate, map%unit_of(size(map%free) + 1:)]
      curve%unit(coordinates + 1:coordinates + size(map%free)) = &
        curve%unit(coordinates + 1:coordinates + size(map%free))*(turn/motion%period)
      if (curve%is_free) curve%unit = [curve%unit, motion%period]
      allocate (curve%period(curve%m), source=0.0_wp)
      curve%period(:coordinates) = map%period_of/map%unit_of_coordinate
      state = map%state_of(motion%q, motion%dq, motion%motor)
      allocate (curve%planes(1))
      if (curve%is_free) call choose_plane(map, state, motion%period, motion%turns(map%free) + merge(1, 0, map%goes_on), &
                                           curve%unit([map%free, (i, i=coordinates + 1, curve%m - 2)]), curve%planes(1), start, err)
      if (allocated(err)) return
      if (curve%is_free) state = start
      call curve%evaluate([map%free, [(i, i=coordinates + 1, curve%m)]], image(curve, motion, state, value/range), point, err)
    end associate
    if (.not. allocated(err)) call make_exact(curve, point)
  end subroutine begin_periodic_curve

  !> The image of a motion.
  function image(curve, motion, state, value) result(z)
    type(periodic_curve_type), intent(in) :: curve       !< the curve
    type(periodic_motion_type), intent(in) :: motion     !< the motion
    real(wp), intent(in) :: state(:)                     !< (states) at its start
    real(wp), intent(in) :: value                        !< of the parameter, as part of its range
    real(wp) :: z(curve%m)

    associate (map => curve%map, coordinates => size(motion%q), n => size(curve%map%free))
      z(:coordinates) = motion%q/map%unit_of_coordinate
      z(map%free) = state(:n)/map%unit_of_coordinate(map%free)
      z(coordinates + 1:coordinates + curve%states - n) = state(n + 1:)/curve%unit(coordinates + 1:coordinates + curve%states - n)
    end associate
    if (curve%is_free) z(curve%m - 1) = 1.0_wp
    z(curve%m) = value
  end function image

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

  !> The difference of both ends of a motion, with derivatives, and for a free one the distance of its start from the plane.
  subroutine evaluate(self, place, guess, point, err)
    class(periodic_curve_type), intent(inout) :: self     !< the curve
    integer, intent(in) :: place(:)                       !< (n+1) free coordinates, the rest of the state, a free period, the parameter
    real(wp), intent(in) :: guess(:)                      !< (m) image, in its units
    type(curve_point_type), intent(out) :: point          !< the point, without a tangent
    type(error_type), allocatable, intent(out) :: err     !< allocated if it failed
    real(wp), allocatable :: by_state(:, :), by_period(:)
    real(wp) :: slope, unit(self%n)
    integer :: i, j, coordinates

    self%last%z = [real(wp) ::]
    unit = self%unit(place(:self%n))
    if (self%is_free) self%period_of_motion = guess(self%m - 1)*unit(self%n)
    call begin_map(self, guess(self%m)*self%range, slope, err)
    if (.not. allocated(err)) call self%map%evaluate(guess(place(:self%states))*unit(:self%states), self%period_of_motion, err)
    if (allocated(err)) return
    allocate (point%jacobian(self%n, self%n + 1), point%slopes(self%m, self%n + 1), point%residual(self%n), source=0.0_wp)
    point%place = place
    coordinates = size(self%map%unit_of_coordinate)
    point%z = guess
    point%z(:coordinates) = self%map%start%q/self%map%unit_of_coordinate
    point%z(place) = guess(place)
    point%residual(:self%states) = self%map%residual()/unit(:self%states)
    call self%map%jacobian(by_state, by_period)
    do j = 1, self%n + 1
      point%slopes(place(j), j) = 1.0_wp
      do i = 1, self%states
        if (j <= self%states) then
          point%jacobian(i, j) = by_state(i, j)*(unit(j)/unit(i))
        else if (j <= self%n) then
          point%jacobian(i, j) = by_period(i)*(unit(j)/unit(i))
        else
          point%jacobian(i, j) = (self%map%by_parameters(i, 1) + by_period(i)*slope)*(self%range/unit(i))
        end if
      end do
    end do
    point%equations = self%equations
    if (self%is_free) call take_plane(self, self%equations, point)
    self%last = point
  end subroutine evaluate

  !> Let the start of a free motion lie in one of the planes: the last equation of a point.
  subroutine take_plane(self, number, point)
    class(periodic_curve_type), intent(in) :: self        !< the curve, evaluated at the point
    integer, intent(in) :: number                         !< of the plane
    type(curve_point_type), intent(inout) :: point        !< gets the equation

    associate (plane => self%planes(number), states => self%states)
      point%equations = number
      point%residual(self%n) = dot_product(plane%normal, point%z(point%place(:states)) - plane%origin)
      point%jacobian(self%n, :) = 0.0_wp
      point%jacobian(self%n, :states) = plane%normal
      point%room = dot_product(plane%normal, flow(self)) - at_rest
    end associate
  end subroutine take_plane

  !> The rates of the state at the start of a motion, in units of the curve over the angle of the period, without those of cyclic coordinates
  !> that do not come back.
  pure function flow(self)
    class(periodic_curve_type), intent(in) :: self        !< the curve, evaluated
    real(wp) :: flow(self%states)
    integer :: n

    n = size(self%map%free)
    associate (coordinates => size(self%map%unit_of_coordinate))
      flow(:n) = self%map%rate_at_start(:n)/self%map%unit_of(:n)
      flow(n + 1:) = self%map%rate_at_start(n + 1:)/self%unit(coordinates + 1:coordinates + self%states - n)
    end associate
    flow = flow*(self%period_of_motion/turn)
    where (self%map%goes_on) flow(:n) = 0.0_wp
  end function flow

  !> Begin the map at a value of the parameter, and find the period where it is that of laws.
  subroutine begin_map(self, value, slope, err)
    class(periodic_curve_type), intent(inout) :: self     !< the curve; gets the period
    real(wp), intent(in) :: value                         !< of the parameter, in the units of the data file
    real(wp), intent(out) :: slope                        !< derivative of the period, by the units of the data file
    type(error_type), allocatable, intent(out) :: err     !< allocated if it failed
    class(model_type), allocatable :: model

    slope = 0.0_wp
    allocate (model)
    call self%variable%at([value], model, err)
    if (allocated(err)) return
    if (self%is_free) then
      if (.not. self%period_of_motion > least_period*self%unit(self%m - 1)) &
        call raise(err, exit_assembly, 'the period of the motion would vanish')
    else
      call find_period(self, value, model, slope, err)
    end if
    if (allocated(err)) return
    associate (solver => model%request%solver)
      solver%relative_tolerance = min(solver%relative_tolerance, relative_tolerance)
      solver%absolute_tolerance = min(solver%absolute_tolerance, absolute_tolerance)
    end associate
    if (allocated(self%interruption)) then
      call self%map%begin(model, err, self%interruption, variable=self%variable)
    else
      call self%map%begin(model, err, variable=self%variable)
    end if
    if (self%goes_on .and. .not. allocated(err)) self%map%goes_on = self%map%may_go_on
  end subroutine begin_map

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
    self%period_of_motion = self%multiples(self%equations)*laws%period
    do side = 1, 2
      allocate (beside)
      call self%variable%at([value + (2*side - 3)*part_of_range*self%range], beside, err)
      if (.not. allocated(err)) call find_law_period(beside, laws, err)
      deallocate (beside)
      if (allocated(err)) return
      periods(side) = self%multiples(self%equations)*laws%period
    end do
    slope = (periods(2) - periods(1))/(2.0_wp*part_of_range*self%range)
    ! equal periods differ by round-off
    if (abs(periods(2) - periods(1)) <= 8.0_wp*spacing(periods(1))) slope = 0.0_wp
  end subroutine find_period

  !> The unknowns serve everywhere. A free motion that does not cross its plane well gets another one across itself.
  subroutine change_unknowns(self, point, err)
    class(periodic_curve_type), intent(inout) :: self     !< the curve
    type(curve_point_type), intent(inout) :: point        !< gets the number of the other plane
    type(error_type), allocatable, intent(out) :: err     !< allocated if the motion failed
    type(phase_plane_type), allocatable :: planes(:)
    integer :: i

    if (.not. self%is_free) return
    call stand_at(self, point, err)
    if (allocated(err)) return
    associate (plane => self%planes(point%equations))
      if (plane%is_of_coordinate .and. crosses_well(plane, flow(self))) return
    end associate
    allocate (planes(size(self%planes) + 1))
    do i = 1, size(self%planes)
      planes(i) = self%planes(i)
    end do
    call plane_across(point%z(point%place(:self%states)), flow(self), planes(size(planes)))
    call move_alloc(planes, self%planes)
    call take_plane(self, size(self%planes), point)
  end subroutine change_unknowns

  !> Let the last point that was evaluated be this one.
  subroutine stand_at(self, point, err)
    class(periodic_curve_type), intent(inout) :: self     !< the curve
    type(curve_point_type), intent(in) :: point           !< on the curve
    type(error_type), allocatable, intent(out) :: err     !< allocated if the motion failed
    type(curve_point_type) :: again
    logical :: is_last

    is_last = size(self%last%z) == size(point%z) .and. (self%is_free .or. self%last%equations == point%equations)
    if (is_last) is_last = all(abs(self%last%z - point%z) <= 0.0_wp)
    if (is_last) return
    self%equations = point%equations
    call self%evaluate(point%place, point%z, again, err)
  end subroutine stand_at

  !> The rate at which the start of a free motion crosses its plane: none where it shrinks to a position of rest.
  pure real(wp) function gap(self, point)
    class(periodic_curve_type), intent(in) :: self        !< the curve
    type(curve_point_type), intent(in) :: point           !< on the curve

    gap = point%room + 0.0_wp*self%n
  end function gap

  !> The Hopf point to which free motions shrink.
  subroutine meet_end(self, a, b, point, kind)
    class(periodic_curve_type), intent(inout) :: self     !< the curve
    type(curve_point_type), intent(in) :: a               !< a motion before it
    type(curve_point_type), intent(in) :: b               !< one behind it, which begins at the opposite point
    type(curve_point_type), intent(inout) :: point        !< the Hopf point, where it was found
    integer, intent(out) :: kind                          !< hopf or regular
    real(wp) :: part, values(2), growth(2), angle, move, before, x(self%states), unit(self%states), period
    logical :: found
    integer :: i

    kind = regular
    part = a%room/(a%room - b%room)
    point = a
    point%z = a%z + part*(b%z - a%z)
    unit = self%unit(a%place(:self%states))
    x = point%z(a%place(:self%states))*unit
    period = point%z(self%m - 1)*self%unit(self%m - 1)
    values(1) = point%z(self%m)
    call find_vibration(self, values(1), 0.25_wp*period, unit, x, growth(1), angle, found)
    if (.not. found) return
    values(2) = values(1) + first_move
    move = first_move
    do i = 1, most_steps
      call find_vibration(self, values(2), 0.25_wp*period, unit, x, growth(2), angle, found)
      if (.not. found .or. .not. abs(growth(2) - growth(1)) > 0.0_wp) return
      before = abs(move)
      move = -growth(2)*(values(2) - values(1))/(growth(2) - growth(1))
      found = abs(move) <= last_move .or. (abs(move) <= stagnated_move .and. 2.0_wp*abs(move) > before)
      if (found) exit
      values = [values(2), values(2) + move]
      growth(1) = growth(2)
    end do
    if (.not. found) return
    kind = hopf
    point%z(:size(self%map%start%q)) = self%map%start%q/self%map%unit_of_coordinate
    point%z(a%place(:self%states)) = x/unit
    point%z(self%m - 1) = 0.25_wp*period*(turn/angle)/self%unit(self%m - 1)
    point%z(self%m) = values(2)
    point%direction = a%direction
    point%tangent = a%tangent
  end subroutine meet_end

  !> Find the position of rest near a state, and its vibration of about a quarter of the period in a time.
  subroutine find_vibration(self, value, time, unit, x, growth, angle, found)
    class(periodic_curve_type), intent(inout) :: self     !< the curve; its map stands at the position of rest
    real(wp), intent(in) :: value                         !< of the parameter, as part of its range
    real(wp), intent(in) :: time                          !< about a quarter of a period [s]
    real(wp), intent(in) :: unit(:)                       !< (states)
    real(wp), intent(inout) :: x(:)                       !< (states) near the position; there
    real(wp), intent(out) :: growth                       !< logarithm of what the vibration grows by in this time
    real(wp), intent(out) :: angle                        !< by which it goes on [rad]
    logical, intent(out) :: found                         !< there is one
    type(error_type), allocatable :: err
    complex(wp), allocatable :: multipliers(:)
    real(wp), allocatable :: by_state(:, :), by_period(:)
    real(wp) :: step(size(x)), slope
    integer :: i, j

    self%last%z = [real(wp) ::]
    found = .false.
    call begin_map(self, value*self%range, slope, err)
    do i = 1, most_steps
      if (.not. allocated(err)) call self%map%evaluate(x, time, err)
      if (allocated(err)) return
      if (found) exit
      call self%map%jacobian(by_state, by_period)
      do j = 1, size(x)
        by_state(:, j) = by_state(:, j)*unit(j)/unit
      end do
      call solve_square(by_state, -self%map%residual()/unit, step, found)
      if (.not. found) return
      x = x + step*unit
      found = maxval(abs(step)) <= rest_tolerance
    end do
    if (.not. found) return
    call find_multipliers(self%map%monodromy, multipliers)
    i = minloc(abs(multipliers - cmplx(0.0_wp, 1.0_wp, wp)), dim=1)
    growth = log(abs(multipliers(i)))
    angle = atan2(aimag(multipliers(i)), real(multipliers(i), wp))
    found = angle > 0.125_wp*turn .and. angle < 0.375_wp*turn
  end subroutine find_vibration

  !> The stability of a periodic motion: the logarithms of its multipliers over the period.
  subroutine judge(self, point, verdict)
    class(periodic_curve_type), intent(inout) :: self     !< the curve
    type(curve_point_type), intent(in) :: point           !< on the curve
    type(verdict_type), intent(out) :: verdict            !< stability
    complex(wp), allocatable :: multipliers(:)
    real(wp), allocatable :: matrix(:, :), rates(:)
    integer, allocatable :: kept(:)
    type(error_type), allocatable :: err
    integer :: i

    allocate (verdict%roots(0))
    verdict%is_stable = .false.
    call stand_at(self, point, err)
    if (allocated(err)) return
    ! the multiplier 1 of a cyclic coordinate belongs to its own direction
    kept = kept_states(self)
    matrix = monodromy(self, point, kept)
    if (self%is_free) then
      rates = flow(self)
      if (norm2(rates(kept)) > at_rest) call split_off(rates(kept), matrix)
    end if
    call find_multipliers(matrix, multipliers)
    do i = 1, size(multipliers)
      if (aimag(multipliers(i)) < 0.0_wp) cycle
      verdict%roots = [verdict%roots, cmplx(log(max(abs(multipliers(i)), least_multiplier)), &
                                            atan2(aimag(multipliers(i)), real(multipliers(i), wp)), wp)/self%period_of_motion]
    end do
    if (size(verdict%roots) == 0) return
    verdict%growth = maxval(real(verdict%roots, wp))
    verdict%is_stable = .not. verdict%growth > 0.0_wp
  end subroutine judge

  !> The kind of a point at which a pair of roots crosses the imaginary axis: one whose multipliers are -1 doubles the period. Of a steady
  !> motion, in which cyclic coordinates alone change, it is a Hopf point.
  integer function kind_of_crossing(self, point) result(kind)
    class(periodic_curve_type), intent(inout) :: self     !< the curve
    type(curve_point_type), intent(in) :: point           !< on the curve
    type(verdict_type) :: verdict
    real(wp) :: rates(self%states)
    integer :: i

    call self%judge(point, verdict)
    i = minloc(abs(real(verdict%roots, wp)), dim=1, mask=abs(aimag(verdict%roots)) > 0.0_wp)
    kind = torus
    rates = flow(self)
    if (self%is_free .and. any(self%map%may_go_on)) then
      where (self%map%may_go_on) rates(:size(self%map%free)) = 0.0_wp
      if (all(abs(rates) <= steady)) kind = hopf
    end if
    if (i == 0 .or. kind == hopf) return
    if (abs(aimag(verdict%roots(i))*self%period_of_motion - 0.5_wp*turn) < half_turn) kind = period_doubling
  end function kind_of_crossing

  !> The motion with the doubled period where a multiplier is -1, with the direction of the branch that begins there: its start moves along the
  !> eigenvector, to one side after one period and to the other side after the next one.
  subroutine double(self, point, doubled, found)
    class(periodic_curve_type), intent(inout) :: self     !< the curve
    type(curve_point_type), intent(in) :: point           !< the point at which periods double
    type(curve_point_type), intent(inout) :: doubled      !< the same with the doubled period and a direction
    logical, intent(out) :: found                         !< a branch begins there
    type(error_type), allocatable :: err
    real(wp) :: move(self%states), along(self%states), z(self%m), direction(self%m)
    real(wp), allocatable :: vector(:)
    integer, allocatable :: kept(:)

    call stand_at(self, point, err)
    found = .not. allocated(err)
    if (.not. found) return
    kept = kept_states(self)
    allocate (vector(size(kept)))
    call find_alternating(monodromy(self, point, kept), vector, found)
    if (.not. found) return
    move = 0.0_wp
    move(kept) = vector
    z = point%z
    if (self%is_free) then
      ! the start stays in its plane
      associate (plane => self%planes(point%equations))
        along = flow(self)
        move = move - along*(dot_product(plane%normal, move)/dot_product(plane%normal, along))
      end associate
      z(self%m - 1) = 2.0_wp*z(self%m - 1)
      self%equations = point%equations
    else
      self%equations = equations_of(self, 2*self%multiples(point%equations))
    end if
    call self%evaluate(point%place, z, doubled, err)
    found = .not. allocated(err)
    if (.not. found) return
    direction = matmul(doubled%slopes(:, :self%states), move)
    doubled%direction = direction/norm2(direction)
    doubled%tangent = doubled%direction(doubled%place)
  end subroutine double

  !> The numbers of the states but for cyclic coordinates that go on.
  pure function kept_states(self) result(kept)
    class(periodic_curve_type), intent(in) :: self        !< the curve, evaluated
    integer, allocatable :: kept(:)
    integer :: i

    kept = pack([(i, i=1, self%states)], [.not. self%map%goes_on, (.true., i=size(self%map%free) + 1, self%states)])
  end function kept_states

  !> The monodromy matrix of some states, in units of the curve.
  function monodromy(self, point, kept) result(matrix)
    class(periodic_curve_type), intent(in) :: self        !< the curve, evaluated at the point
    type(curve_point_type), intent(in) :: point           !< the point
    integer, intent(in) :: kept(:)                        !< (n) numbers of the states
    real(wp) :: matrix(size(kept), size(kept))
    integer :: i, j

    do j = 1, size(kept)
      do i = 1, size(kept)
        matrix(i, j) = self%map%monodromy(kept(i), kept(j))*(self%unit(point%place(kept(j)))/self%unit(point%place(kept(i))))
      end do
    end do
  end function monodromy

  !> The number of the equations of driven motions with a multiple of the period of their laws.
  integer function equations_of(self, multiple) result(number)
    class(periodic_curve_type), intent(inout) :: self     !< the curve; gets a new number where there is none
    integer, intent(in) :: multiple                       !< of the period

    number = findloc(self%multiples, multiple, dim=1)
    if (number > 0) return
    self%multiples = [self%multiples, multiple]
    number = size(self%multiples)
  end function equations_of

  !> The motion with half the period, where it repeats already after half of it.
  subroutine halve(self, point, half, found)
    class(periodic_curve_type), intent(inout) :: self     !< the curve
    type(curve_point_type), intent(in) :: point           !< on the curve
    type(curve_point_type), intent(inout) :: half         !< the same with half the period, without a direction
    logical, intent(out) :: found                         !< it repeats
    type(error_type), allocatable :: err
    real(wp) :: z(self%m)

    half = point
    z = point%z
    found = self%is_free .or. mod(self%multiples(point%equations), 2) == 0
    if (.not. found) return
    if (self%is_free) then
      z(self%m - 1) = 0.5_wp*z(self%m - 1)
      self%equations = point%equations
    else
      self%equations = equations_of(self, self%multiples(point%equations)/2)
    end if
    call self%evaluate(point%place, z, half, err)
    found = .not. allocated(err)
    if (found) found = norm2(half%residual) <= repeats
    if (found) call make_exact(self, half)
  end subroutine halve

  !> Whether the work shall stop.
  logical function is_stopped(self) result(stopped)
    class(periodic_curve_type), intent(in) :: self        !< the curve

    stopped = .false.
    if (allocated(self%interruption)) stopped = self%interruption%is_wanted()
  end function is_stopped
end module mech9_periodic_curve
