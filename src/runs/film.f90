!> A film holds the poses of all links and the recorded columns at some of the outputs of a run, and the paths of the
!> points.
module mech9_film
  use mech9_kinds, only: wp
  use mech9_text, only: string_type
  use mech9_rotation, only: turn, turn_back
  use mech9_hermite, only: hermite_type, build_hermite
  use mech9_mechanism, only: mechanism_type
  use mech9_plan, only: plan_type
  use mech9_state, only: state_type
  use mech9_motion_event, only: motion_events_type
  use mech9_columns, only: columns_type
  use mech9_applied_forces, only: applied_force_type
  use mech9_touching_forces, only: touching_force_type
  use mech9_frame_motion, only: point_motion, link_motion
  implicit none
  private
  public :: film_type, new_film

  !> The number of frames is limited by what a viewer can distinguish. Mechanisms of many links get fewer frames, so that a
  !> film of a thousand links still fits into a few megabytes.
  integer, parameter :: most_frames = 300, most_poses = 60000
  !> The points of a path lie closer together than a line is wide. Where outputs are few, points are put in between them,
  !> except where a point travels more than `detour` times the straight distance, since the curve is then not known well
  !> enough.
  integer, parameter :: most_path_points = 1200, most_between = 8
  real(wp), parameter :: largest_arc_ratio = 2.5_wp

  !> Frames and paths are in the system of link 1. Outputs that are not kept are left out evenly.
  type :: film_type
    logical, allocatable :: independent(:)       !< (M) the coordinate is independent at the start
    integer :: n_frames = 0                      !< number taken so far
    integer :: n_path_points = 0                 !< number taken so far
    real(wp), allocatable :: times(:)            !< times of the frames [s]
    real(wp), allocatable :: r(:, :, :, :)       !< (3,3,N,frames) rotation of each link
    real(wp), allocatable :: p(:, :, :)          !< (3,N,frames) origin of each link [m]
    type(string_type), allocatable :: names(:)   !< names of the columns, without the time
    type(string_type), allocatable :: units(:)   !< units of the columns
    real(wp), allocatable :: values(:, :)        !< (columns,frames) values of the columns
    real(wp), allocatable :: paths(:, :, :)      !< (3,points,path points) places of the points [m]
    integer, allocatable :: force_pairs(:)       !< pairs whose forces are drawn, by their coordinates
    real(wp), allocatable :: forces(:, :, :)     !< (3,pairs,frames) these forces; not allocated where none are drawn [N]
    real(wp), allocatable :: moments(:, :, :)    !< (3,pairs,frames) their moments about the same points [N m]
    type(applied_force_type), allocatable :: applied(:)   !< loads and weights; not allocated where no forces are drawn
    real(wp), allocatable :: applied_vectors(:, :, :)     !< (3,applied,frames) their forces and torques [N, N m]
    type(touching_force_type), allocatable :: touching(:)   !< of stops, frictions and contacts, allocated as those are
    real(wp), allocatable :: touching_vectors(:, :, :)    !< (3,touching,frames) their forces and torques [N, N m]
    real(wp), allocatable :: touching_feet(:, :, :)       !< (3,touching,frames) where those of contacts begin [m]
    real(wp), allocatable :: velocities(:, :, :)      !< (3,points,frames) of the points; not allocated where none are drawn [m/s]
    real(wp), allocatable :: accelerations(:, :, :)   !< (3,points,frames) the same [m/s^2]
    logical, allocatable :: hit(:, :, :)         !< (2,stops,frames) the end of the stop was hit since the frame before
    integer, allocatable :: friction_coordinates(:)   !< numbers of the coordinates with friction
    real(wp), allocatable :: rates(:, :)         !< (frictions,frames) rates of these coordinates [rad/s, m/s]
    logical, allocatable, private :: hit_since(:, :)   !< (2,stops) the end was hit since the last frame
    integer, private :: events_seen = 0          !< number of events before the last output
    integer, private :: n_outputs = 0            !< number of outputs so far
    integer, private :: expected = 1             !< expected number of outputs
    integer, private :: frame_stride = 1, path_stride = 1
    integer, private :: between = 1              !< number of path points for each output
    real(wp), allocatable, private :: latest(:, :, :)   !< (3,points,3) position, velocity, acceleration at the latest output
    real(wp), private :: latest_time = 0.0_wp
  contains
    procedure :: keep_point_motion
    procedure :: keep_forces
    procedure :: note_contacts
    procedure :: keeps_next
    procedure :: take
    procedure :: take_forces
    procedure :: position
    procedure :: direction
    procedure :: local
  end type film_type

contains

  !> A new film with room for the frames of a run, and for the values of its columns if these are given.
  pure function new_film(mechanism, independent, outputs, columns) result(film)
    type(mechanism_type), intent(in) :: mechanism        !< the mechanism
    logical, intent(in) :: independent(:)                !< (M) the coordinate is independent
    integer, intent(in) :: outputs                       !< expected number of outputs
    type(columns_type), intent(in), optional :: columns  !< columns of the rows that are taken, the time first
    type(film_type) :: film
    integer :: n, frames, points

    n = mechanism%structure%n_links
    film%independent = independent
    film%expected = outputs
    frames = max(2, min(most_frames, most_poses/n))
    film%frame_stride = max(1, (outputs + frames - 2)/max(frames - 1, 1))
    film%path_stride = max(1, (outputs + most_path_points - 2)/(most_path_points - 1))
    film%between = max(1, min(most_between, most_path_points/max(outputs, 1)))
    frames = (max(outputs, 1) - 1)/film%frame_stride + 2
    points = film%between*((max(outputs, 1) - 1)/film%path_stride + 2)
    allocate (film%times(frames), source=0.0_wp)
    allocate (film%names(0), film%units(0))
    if (present(columns)) then
      film%names = columns%names(2:columns%count)
      film%units = columns%units(2:columns%count)
    end if
    allocate (film%values(size(film%names), frames), source=0.0_wp)
    allocate (film%hit(2, 0, frames), film%friction_coordinates(0), film%rates(0, frames), film%hit_since(2, 0))
    allocate (film%r(3, 3, n, frames), film%p(3, n, frames), source=0.0_wp)
    allocate (film%paths(3, size(mechanism%points), points), film%latest(3, size(mechanism%points), 3), source=0.0_wp)
  end function new_film

  !> Let a new film keep velocities and accelerations of the points.
  pure subroutine keep_point_motion(self, velocities, accelerations)
    class(film_type), intent(inout) :: self    !< a film without frames so far
    logical, intent(in) :: velocities          !< whether it keeps velocities
    logical, intent(in) :: accelerations       !< whether it keeps accelerations

    if (velocities) allocate (self%velocities(3, size(self%paths, 2), size(self%times)), source=0.0_wp)
    if (accelerations) allocate (self%accelerations(3, size(self%paths, 2), size(self%times)), source=0.0_wp)
  end subroutine keep_point_motion

  !> Let a new film keep the forces of pairs, loads and gravity, of stops, frictions and contacts.
  pure subroutine keep_forces(self, force_pairs, applied, touching)
    class(film_type), intent(inout) :: self              !< a film without frames so far
    integer, intent(in) :: force_pairs(:)                !< pairs whose forces are drawn, by their coordinates
    type(applied_force_type), intent(in) :: applied(:)   !< loads and weights
    type(touching_force_type), intent(in) :: touching(:) !< of stops, frictions and contacts

    self%force_pairs = force_pairs
    self%applied = applied
    self%touching = touching
    allocate (self%touching_vectors(3, size(touching), size(self%times)), source=0.0_wp)
    allocate (self%touching_feet(3, size(touching), size(self%times)), source=0.0_wp)
    allocate (self%forces(3, size(force_pairs), size(self%times)), source=0.0_wp)
    allocate (self%moments(3, size(force_pairs), size(self%times)), source=0.0_wp)
    allocate (self%applied_vectors(3, size(applied), size(self%times)), source=0.0_wp)
  end subroutine keep_forces

  !> Note the impacts on stops before the next output, of which no position shows anything, and keep the rates of pairs with friction.
  !> Without this a film has neither.
  pure subroutine note_contacts(self, mechanism, events, t)
    class(film_type), intent(inout) :: self           !< poses and values at the outputs of the run
    type(mechanism_type), intent(in) :: mechanism     !< the mechanism
    type(motion_events_type), intent(in) :: events    !< of the run so far, and those that are known to come
    real(wp), intent(in) :: t                         !< time of the next output [s]

    if (self%n_outputs == 0) then
      deallocate (self%hit, self%hit_since, self%rates)
      allocate (self%hit(2, size(mechanism%stops), size(self%times)), self%hit_since(2, size(mechanism%stops)), source=.false.)
      if (mechanism%has_frictions()) self%friction_coordinates = mechanism%frictions%coordinate
      allocate (self%rates(size(self%friction_coordinates), size(self%times)), source=0.0_wp)
    end if
    do while (self%events_seen < events%count)
      associate (event => events%items(self%events_seen + 1))
        if (event%t > t) exit
        if (event%group == 'stop' .and. event%has_impulse) &
          self%hit_since(merge(1, 2, event%impulse > 0.0_wp), event%number) = .true.
      end associate
      self%events_seen = self%events_seen + 1
    end do
  end subroutine note_contacts

  !> Whether the next output of the run becomes a frame: its turn has come, or it is the last one.
  pure logical function keeps_next(self)
    class(film_type), intent(in) :: self   !< the film

    keeps_next = self%n_frames < size(self%times) .and. &
                 (mod(self%n_outputs, self%frame_stride) == 0 .or. self%n_outputs + 1 == self%expected)
  end function keeps_next

  !> The next output of the run is kept if its turn has come or if it is the last one.
  pure subroutine take(self, mechanism, plan, state, row)
    class(film_type), intent(inout) :: self        !< poses and values at the outputs of the run
    type(mechanism_type), intent(in) :: mechanism  !< the mechanism
    type(plan_type), intent(in) :: plan            !< the plan of the mechanism
    type(state_type), intent(in) :: state          !< positions known
    real(wp), intent(in) :: row(:)                 !< the columns at this output, as far as the film has room for them

    if (mod(self%n_outputs, self%path_stride) == 0 .or. self%n_outputs + 1 == self%expected) &
      call take_points(self, mechanism, plan, state)
    if (self%keeps_next()) then
      call take_frame(self, plan, state, row)
      call take_point_motion(self, mechanism, plan, state)
    end if
    self%n_outputs = self%n_outputs + 1
  end subroutine take

  !> Keep the forces of the latest frame.
  pure subroutine take_forces(self, force, moment, applied, touching, feet)
    class(film_type), intent(inout) :: self   !< the film, which keeps forces
    real(wp), intent(in) :: force(:, :)       !< (3,M) in the pairs [N]
    real(wp), intent(in) :: moment(:, :)      !< (3,M) in the pairs [N m]
    real(wp), intent(in) :: applied(:, :)     !< (3,applied) of loads and gravity [N, N m]
    real(wp), intent(in) :: touching(:, :)    !< (3,touching) of stops, frictions and contacts [N, N m]
    real(wp), intent(in) :: feet(:, :)        !< (3,touching) where those of contacts begin [m]

    self%forces(:, :, self%n_frames) = force(:, self%force_pairs)
    self%moments(:, :, self%n_frames) = moment(:, self%force_pairs)
    self%applied_vectors(:, :, self%n_frames) = applied
    self%touching_vectors(:, :, self%n_frames) = touching
    self%touching_feet(:, :, self%n_frames) = feet
  end subroutine take_forces

  !> The paths of the points are continued to the present output.
  pure subroutine take_points(self, mechanism, plan, state)
    class(film_type), intent(inout) :: self        !< poses and values at the outputs of the run
    type(mechanism_type), intent(in) :: mechanism  !< the mechanism
    type(plan_type), intent(in) :: plan            !< the plan of the mechanism
    type(state_type), intent(in) :: state          !< position and motion of the mechanism
    real(wp) :: now(3, size(mechanism%points), 3)
    integer :: i, n, new

    do i = 1, size(mechanism%points)
      associate (point => mechanism%points(i))
        call point_motion(plan, state, point%link, point%position, now(:, i, 1), now(:, i, 2), now(:, i, 3))
      end associate
    end do
    new = self%between
    if (self%n_path_points == 0) new = 1
    if (self%n_path_points + new > size(self%paths, 3)) return
    n = self%n_path_points
    do i = 1, size(mechanism%points)
      if (new > 1) call curve_to(self%latest(:, i, :), now(:, i, :), state%t - self%latest_time, &
                                 self%paths(:, i, n + 1:n + new - 1))
      self%paths(:, i, n + new) = now(:, i, 1)
    end do
    self%n_path_points = n + new
    self%latest = now
    self%latest_time = state%t
  end subroutine take_points

  !> Points on the way from one output to the next, evenly spaced in time.
  pure subroutine curve_to(from, to, duration, way)
    real(wp), intent(in) :: from(3, 3)  !< position [m], velocity [m/s], acceleration [m/s^2] at the first output, by columns
    real(wp), intent(in) :: to(3, 3)    !< position [m], velocity [m/s], acceleration [m/s^2] at the second output, by columns
    real(wp), intent(in) :: duration    !< time between the two outputs [s]
    real(wp), intent(out) :: way(:, :)  !< (3,points) places between the two outputs, without these [m]
    type(hermite_type) :: hermite
    real(wp) :: chord(3), rate(3), rate2(3), part
    integer :: n

    chord = to(:, 1) - from(:, 1)
    if (max(norm2(from(:, 2)), norm2(to(:, 2)))*abs(duration) > largest_arc_ratio*norm2(chord)) then
      do n = 1, size(way, 2)
        way(:, n) = from(:, 1) + chord*n/(size(way, 2) + 1)
      end do
      return
    end if
    call build_hermite([0.0_wp, duration], reshape([from(:, 1), to(:, 1)], [3, 2]), &
                       reshape([from(:, 2), to(:, 2)], [3, 2]), reshape([from(:, 3), to(:, 3)], [3, 2]), hermite)
    do n = 1, size(way, 2)
      part = real(n, wp)/(size(way, 2) + 1)
      call hermite%evaluate(part*duration, way(:, n), rate, rate2)
    end do
  end subroutine curve_to

  !> The present position and the values of the columns are kept as a frame.
  pure subroutine take_frame(self, plan, state, row)
    class(film_type), intent(inout) :: self  !< poses and values at the outputs of the run
    type(plan_type), intent(in) :: plan      !< the plan of the mechanism
    type(state_type), intent(in) :: state    !< position and motion of the mechanism
    real(wp), intent(in) :: row(:)           !< (columns) values of the columns at this output, the time first
    real(wp) :: omega(3), v(3)
    integer :: i

    self%n_frames = self%n_frames + 1
    self%times(self%n_frames) = state%t
    self%values(:, self%n_frames) = row(2:size(self%names) + 1)
    self%hit(:, :, self%n_frames) = self%hit_since
    self%hit_since = .false.
    self%rates(:, self%n_frames) = state%dq(self%friction_coordinates)
    do i = 1, plan%n_links
      call link_motion(plan, state, i, self%r(:, :, i, self%n_frames), self%p(:, i, self%n_frames), omega, v)
    end do
  end subroutine take_frame

  !> The velocities and accelerations of the points are kept for the latest frame, where they are drawn.
  pure subroutine take_point_motion(self, mechanism, plan, state)
    class(film_type), intent(inout) :: self        !< poses and values at the outputs of the run
    type(mechanism_type), intent(in) :: mechanism  !< the mechanism
    type(plan_type), intent(in) :: plan            !< the plan of the mechanism
    type(state_type), intent(in) :: state          !< position and motion of the mechanism
    real(wp) :: at(3), velocity(3), acceleration(3)
    integer :: i

    if (.not. (allocated(self%velocities) .or. allocated(self%accelerations))) return
    do i = 1, size(mechanism%points)
      associate (point => mechanism%points(i))
        call point_motion(plan, state, point%link, point%position, at, velocity, acceleration)
      end associate
      if (allocated(self%velocities)) self%velocities(:, i, self%n_frames) = velocity
      if (allocated(self%accelerations)) self%accelerations(:, i, self%n_frames) = acceleration
    end do
  end subroutine take_point_motion

  !> The place of a point of a link in a frame of the film, in the system of link 1 [m].
  pure function position(self, frame, link, point)
    class(film_type), intent(in) :: self  !< poses and values at the outputs of the run
    integer, intent(in) :: frame          !< number of the frame in the film
    integer, intent(in) :: link           !< number of the link
    real(wp), intent(in) :: point(3)      !< the point, in the system of the link [m]
    real(wp) :: position(3)

    position = self%p(:, link, frame) + turn(self%r(:, :, link, frame), point)
  end function position

  !> A direction of a link in a frame of the film, in the axes of link 1.
  pure function direction(self, frame, link, vector)
    class(film_type), intent(in) :: self  !< poses and values at the outputs of the run
    integer, intent(in) :: frame          !< number of the frame in the film
    integer, intent(in) :: link           !< number of the link
    real(wp), intent(in) :: vector(3)     !< the direction, in the axes of the link
    real(wp) :: direction(3)

    direction = turn(self%r(:, :, link, frame), vector)
  end function direction

  !> The point of a link that is at a given place in a frame of the film, in the system of the link [m].
  pure function local(self, frame, link, place)
    class(film_type), intent(in) :: self  !< poses and values at the outputs of the run
    integer, intent(in) :: frame          !< number of the frame in the film
    integer, intent(in) :: link           !< number of the link
    real(wp), intent(in) :: place(3)      !< the place, in the system of link 1 [m]
    real(wp) :: local(3)

    local = turn_back(self%r(:, :, link, frame), place - self%p(:, link, frame))
  end function local
end module mech9_film
