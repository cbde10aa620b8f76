!> The integral of the divergence of a flow along its motion: the logarithm of what a small volume of states grows by.
!>
!> The divergence is the trace of the derivatives of accelerations by rates, and of those of motors' states by themselves. It is found from
!> directions along single numbers of the state, apart from the directions that are integrated, so that the determinant of these can be
!> held against it (Liouville's formula). Steps are integrated by Gauss's formula: with four points on the motion itself, or with two on the
!> polynomial of fifth degree through both ends of the step, which costs much less.
!> A change of independent coordinates, or of the angles of a ball joint, or an event, multiplies the volume at once. This factor is the
!> determinant of the integrated directions behind it over the one before it; its logarithm is added.
module mech9_orbit_divergence
  use mech9_kinds, only: wp
  use mech9_error, only: error_type
  use mech9_log_determinant, only: log_determinant
  use mech9_other_angles, only: take_shown, take_shown_changes
  use mech9_hermite, only: hermite_type, build_hermite
  use mech9_expectation, only: expectation_type
  use mech9_free_simulation, only: free_simulation_type
  use mech9_directed_motion, only: set_unit_directions
  implicit none
  private
  public :: orbit_divergence_type

  !> Places and weights of Gauss's formulas with two and with four points in the interval from 0 to 1.
  real(wp), parameter :: two_places(2) = [0.21132486540518711775_wp, 0.78867513459481288225_wp]
  real(wp), parameter :: places(4) = [0.06943184420297371239_wp, 0.33000947820757186760_wp, 0.66999052179242813240_wp, &
                                      0.93056815579702628761_wp]
  real(wp), parameter :: weights(4) = [0.17392742256872692869_wp, 0.32607257743127307131_wp, 0.32607257743127307131_wp, &
                                       0.17392742256872692869_wp]

  !> Steps below so many units in the last place of the time do not count.
  real(wp), parameter :: shortest = 1.0e3_wp

  !> Integrals along a motion.
  type :: orbit_divergence_type
    logical :: is_known = .false.                    !< the integral was found up to the end
    real(wp) :: log_volume = 0.0_wp                  !< the integral
    logical :: takes_two = .false.                   !< of each step, by two points of a polynomial in place of four of the motion
    real(wp), allocatable :: largest_move(:)         !< (M) largest distance of each coordinate from its start [rad, m]
    real(wp), allocatable :: means(:, :)             !< (3,M) means that say which motion it is: of cosine and sine of angles, or of lengths
                                                     !< and their squares; then of squared rates times the squared time, all in units
    real(wp), allocatable, private :: first(:)       !< (M) coordinates at the start [rad, m]
    integer, allocatable, private :: motors(:)       !< those with a state
    integer, allocatable, private :: free(:)         !< free coordinates of the last step
    real(wp), allocatable, private :: changes(:, :, :)   !< (directions,0:1,M) of all coordinates at the end of the last step
    real(wp), allocatable, private :: of_motors(:, :)    !< (directions,motors) of the motors there
    integer, private :: plans = 0                        !< how often the plan had changed there
    real(wp), private :: log_changed = 0.0_wp            !< logarithm that these changes had added to the volume
    logical, allocatable, private :: replaced(:)         !< (ball joints) other angles moved them there
    real(wp), allocatable, private :: motion(:, :)       !< (M,0:2) coordinates, rates and accelerations there
    real(wp), allocatable, private :: states(:)          !< (motors) of motors there
  contains
    procedure :: follow
    procedure :: begin
    procedure :: add_step
    procedure :: pass
    procedure :: log_determinant_here
    procedure, private :: volume_in
  end type orbit_divergence_type

contains

  !> Follow a motion from its start to its end.
  subroutine follow(self, simulation, motors, err)
    class(orbit_divergence_type), intent(inout) :: self         !< gets the integral
    type(free_simulation_type), intent(inout) :: simulation     !< the motion, started, with as many directions as the state has numbers
    integer, intent(in) :: motors(:)                            !< numbers of the motors with a state
    type(error_type), allocatable, intent(out) :: err           !< allocated if the motion failed
    real(wp) :: from, to, end, at_start, at_end
    logical :: at_joint

    end = simulation%end
    to = simulation%motion%t
    at_start = 0.0_wp
    at_end = 0.0_wp
    call self%begin(simulation, motors, err)
    if (self%is_known .and. .not. allocated(err)) call find_shown_volume(self, simulation, at_start, err)
    do while (abs(end - to) > 0.0_wp .and. .not. allocated(err))
      call simulation%stride(end, from, to, at_joint, err)
      if (allocated(err)) return
      call self%add_step(simulation, from, to, err)
      if (at_joint .and. .not. allocated(err)) call self%pass(simulation, err)
    end do
    if (allocated(err)) return
    call simulation%advance(end, err)
    if (allocated(err)) return
    associate (time => simulation%model%request%time)
      self%means = self%means/(time%end - time%start)
      self%means(3, :) = self%means(3, :)*(time%end - time%start)**2
    end associate
    if (self%is_known) call find_shown_volume(self, simulation, at_end, err)
    self%log_volume = self%log_volume + at_end - at_start
  end subroutine follow

  !> The logarithm of the volume of the directions in the coordinates of the data file, less that in those of the motion.
  subroutine find_shown_volume(self, simulation, log_volume, err)
    class(orbit_divergence_type), intent(inout) :: self         !< with the directions; those in the angles of the data file on return
    type(free_simulation_type), intent(inout) :: simulation     !< the motion, shown in these angles
    real(wp), intent(out) :: log_volume                         !< the logarithm
    type(error_type), allocatable, intent(out) :: err           !< allocated in gimbal lock

    log_volume = -self%volume_in(self%free)
    call take_shown_changes(simulation%motion%system, simulation%motion%angles, self%changes, err)
    if (.not. allocated(err)) log_volume = log_volume + self%volume_in(simulation_free(simulation%model%problem%partition%kind))
  end subroutine find_shown_volume

  !> Begin at the present motion.
  subroutine begin(self, simulation, motors, err)
    class(orbit_divergence_type), intent(inout) :: self         !< begins anew
    type(free_simulation_type), intent(inout) :: simulation     !< the motion, started, with as many directions as the state has numbers
    integer, intent(in) :: motors(:)                            !< numbers of the motors with a state
    type(error_type), allocatable, intent(out) :: err           !< allocated if it failed

    self%is_known = .not. is_closed(simulation)
    self%log_volume = 0.0_wp
    self%motors = motors
    self%first = shown_position(simulation)
    self%log_changed = simulation%motion%log_volume
    self%largest_move = 0.0_wp*self%first
    self%free = simulation%motion%system%plan%free
    if (allocated(self%means)) deallocate (self%means)
    allocate (self%means(3, size(self%first)), source=0.0_wp)
    self%plans = simulation%plans()
    call keep(self, simulation, err)
  end subroutine begin

  !> Add the integral over a step, and stand at its end, before what ended it.
  subroutine add_step(self, simulation, from, to, err)
    class(orbit_divergence_type), intent(inout) :: self         !< gets it
    type(free_simulation_type), intent(inout) :: simulation     !< the motion, at the end of the step
    real(wp), intent(in) :: from                                !< start of the step [s]
    real(wp), intent(inout) :: to                               !< its end; an earlier one where the step is made anew [s]
    type(error_type), allocatable, intent(out) :: err           !< allocated if it failed

    if (simulation%plans() /= self%plans) call change_coordinates(self, simulation)
    self%plans = simulation%plans()
    if (self%is_known .and. self%takes_two .and. has_same_angles(self, simulation)) then
      call integrate_polynomial(self, simulation, from, to, err)
    else if (self%is_known) then
      call integrate(self, simulation, from, to, err)
    end if
    if (.not. allocated(err)) call simulation%stand_at_step(err)
    if (.not. allocated(err)) call keep(self, simulation, err)
  end subroutine add_step

  !> Whether the same angles move the ball joints as at the end of the last step.
  pure logical function has_same_angles(self, simulation)
    class(orbit_divergence_type), intent(in) :: self            !< with the motion there
    type(free_simulation_type), intent(in) :: simulation        !< the motion

    has_same_angles = size(self%replaced) == size(simulation%motion%angles%replaced)
    if (has_same_angles) has_same_angles = all(self%replaced .eqv. simulation%motion%angles%replaced)
  end function has_same_angles

  !> The logarithm of the volume of the directions in the free coordinates, their rates and the motors' states, at the present motion.
  subroutine log_determinant_here(self, simulation, log_volume, err)
    class(orbit_divergence_type), intent(inout) :: self         !< keeps the directions
    type(free_simulation_type), intent(inout) :: simulation     !< the motion, at the end of a step
    real(wp), intent(out) :: log_volume                         !< the logarithm
    type(error_type), allocatable, intent(out) :: err           !< allocated if it failed

    call keep(self, simulation, err)
    log_volume = 0.0_wp
    if (.not. allocated(err)) log_volume = self%volume_in(self%free)
  end subroutine log_determinant_here

  !> The numbers of the coordinates that are free.
  pure function simulation_free(kinds) result(free)
    use mech9_partition, only: free_coordinate
    integer, intent(in) :: kinds(:)       !< (M) of coordinates
    integer, allocatable :: free(:)
    integer :: k

    free = pack([(k, k=1, size(kinds))], kinds == free_coordinate)
  end function simulation_free

  !> Keep the directions of all coordinates at the end of a step, and the distance from the start.
  subroutine keep(self, simulation, err)
    class(orbit_divergence_type), intent(inout) :: self         !< gets them
    type(free_simulation_type), intent(inout) :: simulation     !< the motion, at the end of a step
    type(error_type), allocatable, intent(out) :: err           !< allocated if it failed

    call simulation%motion%system%show_sensitivity(err)
    if (allocated(err)) return
    associate (system => simulation%motion%system)
      self%changes = system%sensitivity%motion%q
      self%of_motors = system%sensitivity%motors(:, self%motors, 0)
      self%largest_move = max(self%largest_move, abs(shown_position(simulation) - self%first))
      self%free = system%plan%free
      self%replaced = simulation%motion%angles%replaced
      self%motion = reshape([system%state%q, system%state%dq, system%state%ddq], [size(system%state%q), 3])
      if (allocated(system%state%motor)) self%states = system%state%motor
    end associate
  end subroutine keep

  !> Let the volume stand in the coordinates in which the step was made that begins where the last one ended.
  subroutine change_coordinates(self, simulation)
    class(orbit_divergence_type), intent(inout) :: self         !< with the directions at the end of the step before
    type(free_simulation_type), intent(in) :: simulation        !< the motion, at the end of a step in other coordinates

    associate (motion => simulation%motion)
      if (size(motion%system%plan%free) /= size(self%free)) self%is_known = .false.
      self%log_volume = self%log_volume + motion%log_volume - self%log_changed
      self%log_changed = motion%log_volume
      self%free = motion%system%plan%free
    end associate
  end subroutine change_coordinates

  !> Pass what ended the step: the volume changes as the directions do.
  subroutine pass(self, simulation, err)
    class(orbit_divergence_type), intent(inout) :: self         !< with the directions before the joint
    type(free_simulation_type), intent(inout) :: simulation     !< the motion, at the end of a step that ends at a joint
    type(error_type), allocatable, intent(out) :: err           !< allocated if it failed
    real(wp) :: before
    integer :: n

    before = self%volume_in(self%free)
    n = size(self%free)
    call simulation%leave_joint(err)
    if (.not. allocated(err)) call keep(self, simulation, err)
    if (allocated(err)) return
    ! a stop that holds a coordinate leaves no volume, nor does a rigid contact that is closed
    if (size(self%free) /= n .or. is_closed(simulation)) self%is_known = .false.
    if (self%is_known) self%log_volume = self%log_volume + self%volume_in(self%free) - before
    self%plans = simulation%plans()
    self%log_changed = simulation%motion%log_volume
  end subroutine pass

  !> Whether a rigid contact of links is closed, or a stop or friction holds a coordinate.
  pure logical function is_closed(simulation)
    type(free_simulation_type), intent(in) :: simulation       !< the motion

    is_closed = .false.
    associate (system => simulation%motion%system)
      if (allocated(system%held)) is_closed = size(system%held) > 0
      if (allocated(system%contact) .and. .not. is_closed) &
        is_closed = any(system%contact%acts .and. system%model%mechanism%contacts%is_rigid)
    end associate
  end function is_closed

  !> The logarithm of the volume of the directions in some coordinates, their rates, and the motors' states.
  real(wp) function volume_in(self, free) result(log_volume)
    class(orbit_divergence_type), intent(in) :: self   !< with the directions
    integer, intent(in) :: free(:)                     !< numbers of the coordinates
    real(wp) :: a(2*size(free) + size(self%motors), 2*size(free) + size(self%motors))
    integer :: i, n

    n = size(free)
    log_volume = 0.0_wp
    if (size(a, 1) == 0 .or. size(self%changes, 1) < size(a, 1)) return
    do i = 1, size(a, 1)
      a(:n, i) = self%changes(i, 0, free)
      a(n + 1:2*n, i) = self%changes(i, 1, free)
      a(2*n + 1:, i) = self%of_motors(i, :)
    end do
    log_volume = log_determinant(a)
  end function volume_in

  !> Add the integral over the last step. Where the motion within it is not certain, the step is made anew, shorter.
  recursive subroutine integrate(self, simulation, from, to, err)
    class(orbit_divergence_type), intent(inout) :: self         !< gets it
    type(free_simulation_type), intent(inout) :: simulation     !< the motion, at the end of the step
    real(wp), intent(in) :: from                                !< start of the step [s]
    real(wp), intent(inout) :: to                               !< its end [s]
    type(error_type), allocatable, intent(out) :: err           !< allocated if it failed
    real(wp) :: trace, log_volume, means(3, size(self%first))
    integer :: i

    ! a step to a time that is met but for round-off has no inside
    if (abs(to - from) < shortest*spacing(max(abs(from), abs(to)))) return
    log_volume = self%log_volume
    means = self%means
    do i = 1, size(places)
      call simulation%look_at(from + places(i)*(to - from), err)
      if (allocated(err)) return
      if (abs(simulation%motion%t - to) > 0.0_wp) then
        self%log_volume = log_volume
        self%means = means
        self%is_known = abs(simulation%motion%t - to) < abs(to - from)
        to = simulation%motion%t
        if (self%is_known .and. abs(to - from) > 0.0_wp) call integrate(self, simulation, from, to, err)
        return
      end if
      self%largest_move = max(self%largest_move, abs(shown_position(simulation) - self%first))
      call add_means(simulation, weights(i)*(to - from), self%means)
      call find_trace(self, simulation, trace, err)
      if (allocated(err)) return
      self%log_volume = self%log_volume + weights(i)*(to - from)*trace
    end do
  end subroutine integrate

  !> Add the integral over the last step by the polynomial through its ends. It is not known where chains do not close there.
  subroutine integrate_polynomial(self, simulation, from, to, err)
    class(orbit_divergence_type), intent(inout) :: self         !< gets it; has the motion at the start of the step
    type(free_simulation_type), intent(inout) :: simulation     !< the motion, at the end of the step
    real(wp), intent(in) :: from                                !< start of the step [s]
    real(wp), intent(in) :: to                                  !< its end [s]
    type(error_type), allocatable, intent(out) :: err           !< allocated if the motion at the end failed
    type(error_type), allocatable :: failure
    type(expectation_type) :: expectation
    type(hermite_type) :: polynomial
    real(wp), dimension(size(self%first)) :: q, dq, ddq
    real(wp), allocatable :: motors(:)
    integer :: i, m
    logical :: closed

    if (abs(to - from) < shortest*spacing(max(abs(from), abs(to)))) return
    call simulation%stand_at_step(err)
    if (allocated(err)) return
    m = size(q)
    associate (system => simulation%motion%system, h => to - from)
      associate (state => system%state)
        call build_hermite([0.0_wp, 1.0_wp], reshape([self%motion(:, 1), state%q], [m, 2]), &
                           h*reshape([self%motion(:, 2), state%dq], [m, 2]), h**2*reshape([self%motion(:, 3), state%ddq], [m, 2]), &
                           polynomial)
        if (allocated(state%motor)) motors = state%motor
      end associate
      expectation = system%work%expectation
      do i = 1, size(two_places)
        call polynomial%evaluate(two_places(i), q, dq, ddq)
        system%state%q = q
        system%state%dq = dq/h
        if (allocated(motors)) system%state%motor = self%states + two_places(i)*(motors - self%states)
        call set_unit_directions(simulation, system%plan%unit_of(system%plan%free), self%motors)
        call system%close_near(from + two_places(i)*h, system%vector(), closed, failure)
        self%is_known = closed
        if (.not. closed) exit
        self%log_volume = self%log_volume + 0.5_wp*h*trace_of(self, simulation)
      end do
      call system%resume(expectation)
    end associate
  end subroutine integrate_polynomial

  !> Coordinates at the present motion, in the angles of the data file.
  pure function shown_position(simulation) result(q)
    type(free_simulation_type), intent(in) :: simulation   !< the motion
    real(wp) :: q(size(simulation%motion%system%state%q))  !< (M) [rad, m]
    real(wp), dimension(size(q)) :: dq, ddq

    call take_shown(simulation%motion%system, simulation%motion%angles, q, dq, ddq)
  end function shown_position

  !> Add a position to the means.
  subroutine add_means(simulation, weight, means)
    type(free_simulation_type), intent(in) :: simulation   !< the motion, which stands within its step
    real(wp), intent(in) :: weight                         !< of the position [s]
    real(wp), intent(inout) :: means(:, :)                 !< (3,M) gets it
    real(wp), dimension(size(means, 2)) :: position, dq, ddq
    integer :: k

    call take_shown(simulation%motion%system, simulation%motion%angles, position, dq, ddq)
    associate (plan => simulation%motion%system%plan)
      do k = 1, size(means, 2)
        associate (q => position(k)/plan%unit_of(k))
          if (simulation%model%mechanism%pairs(k)%pair%angular) then
            means(1:2, k) = means(1:2, k) + weight*[cos(q), sin(q)]
          else
            means(1:2, k) = means(1:2, k) + weight*[q, q**2]
          end if
        end associate
        means(3, k) = means(3, k) + weight*(dq(k)/plan%unit_of(k))**2
      end do
    end associate
  end subroutine add_means

  !> The divergence at the present motion. The integrated directions come back with the next step.
  subroutine find_trace(self, simulation, trace, err)
    class(orbit_divergence_type), intent(in) :: self            !< with the motors
    type(free_simulation_type), intent(inout) :: simulation     !< the motion, which stands within its step
    real(wp), intent(out) :: trace                              !< the divergence [1/s]
    type(error_type), allocatable, intent(out) :: err           !< allocated if it failed

    trace = 0.0_wp
    associate (system => simulation%motion%system)
      call set_unit_directions(simulation, system%plan%unit_of(system%plan%free), self%motors)
      call system%sensitivity%find_accelerations(simulation%model, system%state, system%work, err)
    end associate
    if (.not. allocated(err)) trace = trace_of(self, simulation)
  end subroutine find_trace

  !> The trace of the derivatives by these directions [1/s].
  pure real(wp) function trace_of(self, simulation) result(trace)
    class(orbit_divergence_type), intent(in) :: self         !< with the motors
    type(free_simulation_type), intent(in) :: simulation     !< the motion, with its derivatives
    integer :: i, n

    trace = 0.0_wp
    associate (plan => simulation%motion%system%plan, sensitivity => simulation%motion%system%sensitivity)
      n = size(plan%free)
      do i = 1, n
        trace = trace + sensitivity%values(n + i, i, 2)/plan%unit_of(plan%free(i))
      end do
      do i = 1, size(self%motors)
        trace = trace + sensitivity%motors(2*n + i, self%motors(i), 1)
      end do
    end associate
  end function trace_of
end module mech9_orbit_divergence
