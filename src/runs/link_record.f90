!> The turning motion of links that a run records, from the present state of its simulation: an angle with its derivatives in a plane,
!> a quaternion with angular velocity and acceleration in space; and velocity poles in a plane.
!>
!> An angle is the sum of the coordinates on the way to the link, and a quaternion has the sign of their product along the way, so that
!> both go on over whole turns without jumps. At the first position an angle is between minus and plus half a turn, and
!> the first part of a quaternion that is not zero is positive.
module mech9_link_record
  use, intrinsic :: ieee_arithmetic, only: ieee_value, ieee_quiet_nan
  use mech9_kinds, only: wp, pi
  use mech9_text, only: to_text
  use mech9_rotation, only: cross, quaternion
  use mech9_mechanism, only: mechanism_type
  use mech9_request, only: output_settings_type
  use mech9_turning_plane, only: turning_plane_type, find_turning_plane
  use mech9_link_way, only: link_way_type, find_ways
  use mech9_plan, only: plan_type
  use mech9_state, only: state_type
  use mech9_frame_motion, only: link_motion, link_turning
  use mech9_twists, only: shift_at
  use mech9_varied_motion, only: varied_motion_type, link_twists
  use mech9_columns, only: columns_type
  implicit none
  private
  public :: link_record_type, pole_axes

  !> An angle this little above minus half a turn counts as plus half a turn, so that round-off does not choose between both [rad].
  real(wp), parameter :: half_turn = 1.0e-9_wp
  !> Parts of a quaternion below this are zero where its sign is chosen: round-off of some dozen products.
  real(wp), parameter :: zero_part = 1.0e-9_wp
  !> An angular velocity below this part of the rates of all turning pairs is round-off of rates in badly conditioned chains: the
  !> link does not turn, and its pole would be further away than a million million lengths.
  real(wp), parameter :: at_rest = 1.0e-12_wp
  !> A direction whose other parts are below this is an axis of link 1.
  real(wp), parameter :: along_axis = 1.0e-12_wp
  character, parameter :: directions(3) = ['x', 'y', 'z']

  type :: link_record_type
    logical :: wanted = .false.                              !< some links are recorded
    integer, private :: first = 0                            !< columns before those of links
    integer, private :: derivatives = 2                      !< highest derivative that is recorded
    type(turning_plane_type), private :: plane               !< the plane of the mechanism, if there is one
    type(link_way_type), allocatable, private :: ways(:)     !< to the links
    integer, allocatable, private :: poles(:)                !< links whose poles are recorded
    integer, allocatable, private :: axes(:)                 !< axes of link 1 along which poles have columns
    logical, private :: begun = .false.                      !< a position was taken
    real(wp), allocatable, private :: turned(:)              !< (links) whole turns taken off from each angle [rad]
    real(wp), allocatable, private :: signs(:)               !< (links) factors of the quaternions
    real(wp), allocatable, private :: last(:, :)             !< (4,links) quaternions of the last position
  contains
    procedure :: begin
    procedure :: fill
    procedure :: find_changes
  end type link_record_type

contains

  !> Add the columns of the links that the request names.
  subroutine begin(self, mechanism, output, columns)
    class(link_record_type), intent(out) :: self           !< the record
    type(mechanism_type), intent(in) :: mechanism          !< the mechanism
    type(output_settings_type), intent(in) :: output       !< settings of the results
    type(columns_type), intent(inout) :: columns           !< those of all that has derivatives by parameters; gets those of links
    integer :: i, j

    if (.not. allocated(output%links)) return
    self%wanted = size(output%links) + size(output%poles) > 0
    if (.not. self%wanted) return
    self%first = columns%count
    self%derivatives = output%derivatives
    call find_turning_plane(mechanism%structure, mechanism%pairs, self%plane)
    call find_ways(mechanism%structure, mechanism%pairs, output%links, self%plane, self%ways)
    self%poles = output%poles
    self%axes = pole_axes(self%plane)
    allocate (self%turned(size(self%ways)), self%last(4, size(self%ways)), source=0.0_wp)
    allocate (self%signs(size(self%ways)), source=1.0_wp)
    do i = 1, size(output%links)
      if (self%plane%found) call append_angle(columns, output%links(i), self%derivatives, self%plane%pair)
      if (.not. self%plane%found) call append_quaternion(columns, output%links(i), self%derivatives)
    end do
    do i = 1, size(self%poles)
      do j = 1, size(self%axes)
        call columns%append_in('L'//to_text(self%poles(i))//'.pole.'//directions(self%axes(j)), 'm', &
                            'pole of link '//to_text(self%poles(i))//' against link 1, along '//directions(self%axes(j)))
      end do
    end do
    columns%links = columns%count - self%first
  end subroutine begin

  !> The axes of link 1 along which poles have columns: the two across the normal where it is one of them; else all three.
  pure function pole_axes(plane) result(axes)
    type(turning_plane_type), intent(in) :: plane   !< the plane of the mechanism, if there is one
    integer, allocatable :: axes(:)
    integer :: k

    axes = [1, 2, 3]
    if (.not. plane%found) return
    do k = 1, 3
      if (norm2(pack(plane%normal(:, 1), axes /= k)) > along_axis) cycle
      axes = pack(axes, axes /= k)
      return
    end do
  end function pole_axes

  !> Append the columns of a link in the plane.
  subroutine append_angle(columns, link, derivatives, pair)
    type(columns_type), intent(inout) :: columns   !< the columns
    integer, intent(in) :: link                    !< number of the link
    integer, intent(in) :: derivatives             !< highest derivative that is recorded
    integer, intent(in) :: pair                    !< number of the first turning pair
    character(len=:), allocatable :: about

    about = ' of link '//to_text(link)//' about the axis of pair '//to_text(pair)
    call columns%append_in('L'//to_text(link)//'.phi', 'rad', 'angle'//about)
    if (derivatives > 0) call columns%append_in('L'//to_text(link)//'.omega', 'rad/s', 'angular velocity'//about)
    if (derivatives > 1) call columns%append_in('L'//to_text(link)//'.alpha', 'rad/s^2', 'angular acceleration'//about)
  end subroutine append_angle

  !> Append the columns of a link in space.
  subroutine append_quaternion(columns, link, derivatives)
    type(columns_type), intent(inout) :: columns   !< the columns
    integer, intent(in) :: link                    !< number of the link
    integer, intent(in) :: derivatives             !< highest derivative that is recorded
    character(len=6), parameter :: names(2) = ['w    ', 'alpha']
    character(len=20), parameter :: words(2) = ['angular velocity    ', 'angular acceleration']
    character(len=4), parameter :: per_time(2) = ['/s  ', '/s^2']
    integer :: i, k

    do i = 0, 3
      call columns%append_in('L'//to_text(link)//'.e'//to_text(i), '1', &
                          'part '//to_text(i)//' of the quaternion of link '//to_text(link)//' in link 1')
    end do
    do i = 1, derivatives
      do k = 1, 3
        call columns%append_in('L'//to_text(link)//'.'//trim(names(i))//directions(k), 'rad'//trim(per_time(i)), &
                            trim(words(i))//' of link '//to_text(link)//' along '//directions(k)//' of link 1')
      end do
    end do
  end subroutine append_quaternion

  !> Fill the columns in a row with those of a state. Positions come in the order of time.
  subroutine fill(self, plan, state, row)
    class(link_record_type), intent(inout) :: self   !< the record; keeps the position
    type(plan_type), intent(in) :: plan              !< the plan of the mechanism
    type(state_type), intent(in) :: state            !< position and motion of the mechanism
    real(wp), intent(inout) :: row(:)                !< numbers of one row, one for each column
    real(wp) :: r(3, 3), p(3), omega(3), v(3), alpha(3)
    integer :: at, i

    if (.not. self%wanted) return
    at = self%first
    do i = 1, size(self%ways)
      call link_motion(plan, state, self%ways(i)%link, r, p, omega, v)
      alpha = 0.0_wp
      if (self%derivatives > 1) call link_turning(plan, state, self%ways(i)%link, alpha)
      if (self%plane%found) then
        row(at + 1) = angle_of(self, i, state%q)
        at = at + 1
        call put([dot_product(omega, self%plane%normal(:, 1))], [dot_product(alpha, self%plane%normal(:, 1))])
      else
        row(at + 1:at + 4) = quaternion_of(self, i, r, state%q)
        at = at + 4
        call put(omega, alpha)
      end if
    end do
    self%begun = .true.
    do i = 1, size(self%poles)
      call link_motion(plan, state, self%poles(i), r, p, omega, v)
      row(at + 1:at + size(self%axes)) = part_in_plane(self, pole_of(self, plan, state, p, omega, v))
      at = at + size(self%axes)
    end do
  contains

    !> Put an angular velocity and an angular acceleration, as far as they are recorded.
    subroutine put(velocity, acceleration)
      real(wp), intent(in) :: velocity(:)       !< [rad/s]
      real(wp), intent(in) :: acceleration(:)   !< [rad/s^2]

      associate (n => size(velocity))
        if (self%derivatives > 0) row(at + 1:at + n) = velocity
        if (self%derivatives > 1) row(at + n + 1:at + 2*n) = acceleration
        at = at + n*self%derivatives
      end associate
    end subroutine put
  end subroutine fill

  !> The angle of a link [rad].
  real(wp) function angle_of(self, i, q) result(angle)
    type(link_record_type), intent(inout) :: self   !< the record
    integer, intent(in) :: i                        !< number of the way
    real(wp), intent(in) :: q(:)                    !< (M) coordinates [rad, m]

    angle = self%ways(i)%angle_at(q)
    if (.not. self%begun) then
      self%turned(i) = 2.0_wp*pi*anint(angle/(2.0_wp*pi))
      if (angle - self%turned(i) <= -pi + half_turn) self%turned(i) = self%turned(i) - 2.0_wp*pi
      if (angle - self%turned(i) > pi + half_turn) self%turned(i) = self%turned(i) + 2.0_wp*pi
    end if
    angle = angle - self%turned(i)
  end function angle_of

  !> The quaternion of a link, whose sign is continuous. Where a pair on the way has no fixed axis, it is the one that is nearer to the
  !> last position.
  function quaternion_of(self, i, r, q) result(e)
    type(link_record_type), intent(inout) :: self   !< the record
    integer, intent(in) :: i                        !< number of the way
    real(wp), intent(in) :: r(3, 3)                 !< rotation of the link
    real(wp), intent(in) :: q(:)                    !< (M) coordinates [rad, m]
    real(wp) :: e(4)
    integer :: k

    e = quaternion(r)
    if (self%ways(i)%has_fixed_axes()) then
      e = sign(1.0_wp, dot_product(e, self%ways(i)%quaternion_at(q)))*e
    else if (self%begun) then
      e = sign(1.0_wp, dot_product(e, self%last(:, i)))*e
    end if
    if (.not. self%begun) then
      k = findloc(abs(e) > zero_part, .true., dim=1)
      self%signs(i) = sign(1.0_wp, e(k))
    end if
    if (self%ways(i)%has_fixed_axes() .or. .not. self%begun) e = self%signs(i)*e
    self%last(:, i) = e
  end function quaternion_of

  !> The velocity pole of a link against link 1, in the system of link 1 [m]; not a number where the link does not turn. The velocity of
  !> the link's points about it is that of a turn (instantaneous centre; Norton in docs/reference/bibliography.md).
  pure function pole_of(self, plan, state, p, omega, v) result(pole)
    type(link_record_type), intent(in) :: self     !< the record
    type(plan_type), intent(in) :: plan            !< the plan of the mechanism
    type(state_type), intent(in) :: state          !< motion of the mechanism
    real(wp), intent(in) :: p(3)                   !< origin of the link [m]
    real(wp), intent(in) :: omega(3)               !< angular velocity [rad/s]
    real(wp), intent(in) :: v(3)                   !< velocity of the origin [m/s]
    real(wp) :: pole(3), rate

    associate (normal => self%plane%normal(:, 1))
      rate = dot_product(omega, normal)
      if (turns(plan, state, rate)) then
        pole = p + cross(normal, v)/rate
      else
        pole = ieee_value(1.0_wp, ieee_quiet_nan)
      end if
    end associate
  end function pole_of

  !> Whether an angular velocity is more than round-off of the rates of all turning pairs.
  pure logical function turns(plan, state, rate)
    type(plan_type), intent(in) :: plan            !< the plan of the mechanism
    type(state_type), intent(in) :: state          !< motion of the mechanism
    real(wp), intent(in) :: rate                   !< angular velocity of a link [rad/s]
    integer :: s

    turns = abs(rate) > at_rest*maxval([(abs(plan%steps(s)%turn*state%dq(plan%steps(s)%coordinate)), s=1, size(plan%steps))])
  end function turns

  !> The recorded parts of a place in the plane, which goes through the origin of link 1.
  pure function part_in_plane(self, place) result(parts)
    type(link_record_type), intent(in) :: self   !< the record
    real(wp), intent(in) :: place(3)             !< in the system of link 1 [m]
    real(wp) :: parts(size(self%axes)), flat(3)

    flat = place - dot_product(place, self%plane%normal(:, 1))*self%plane%normal(:, 1)
    parts = flat(self%axes)
  end function part_in_plane

  !> Find the derivatives of the columns by all parameters. Seen from the twist by which a link moves with a
  !> parameter, with rotation w, the angular velocity changes by w' + w x omega.
  subroutine find_changes(self, motion, changes)
    class(link_record_type), intent(in) :: self        !< the record
    type(varied_motion_type), intent(in) :: motion     !< derivatives of the present motion
    real(wp), intent(out) :: changes(:, :)             !< (P,columns)
    real(wp) :: twists(motion%n_parameters, 6, 0:2), r(3, 3), p(3), omega(3), v(3), alpha(3), e(4)
    integer :: at, i, k, wide

    at = 0
    wide = merge(1 + self%derivatives, 4 + 3*self%derivatives, self%plane%found)
    do i = 1, size(self%ways)
      call link_twists(motion, self%ways(i)%link, twists)
      call link_motion(motion%plan, motion%state, self%ways(i)%link, r, p, omega, v)
      call link_turning(motion%plan, motion%state, self%ways(i)%link, alpha)
      e = self%last(:, i)
      do k = 1, motion%n_parameters
        call change_link(self, twists(k, 1:3, :), omega, alpha, e, changes(k, at + 1:at + wide))
      end do
      at = at + wide
    end do
    do i = 1, size(self%poles)
      call link_twists(motion, self%poles(i), twists)
      call link_motion(motion%plan, motion%state, self%poles(i), r, p, omega, v)
      do k = 1, motion%n_parameters
        call change_pole(self, motion, twists(k, :, :), p, omega, v, changes(k, at + 1:at + size(self%axes)))
      end do
      at = at + size(self%axes)
    end do
  end subroutine find_changes

  !> The derivatives of one link by one parameter.
  pure subroutine change_link(self, w, omega, alpha, e, changes)
    type(link_record_type), intent(in) :: self     !< the record
    real(wp), intent(in) :: w(3, 0:2)              !< rotation with the parameter [rad], and its derivatives in time
    real(wp), intent(in) :: omega(3)               !< angular velocity [rad/s]
    real(wp), intent(in) :: alpha(3)               !< angular acceleration [rad/s^2]
    real(wp), intent(in) :: e(4)                   !< quaternion, in space
    real(wp), intent(out) :: changes(:)            !< derivatives, of angles in rad
    real(wp) :: turning(3, 0:2)
    integer :: i

    turning(:, 0) = w(:, 0)
    turning(:, 1) = w(:, 1) + cross(w(:, 0), omega)
    turning(:, 2) = w(:, 2) + cross(w(:, 1), omega) + cross(w(:, 0), alpha)
    if (self%plane%found) then
      do i = 0, self%derivatives
        changes(1 + i) = dot_product(self%plane%normal(:, 1), turning(:, i))
      end do
      return
    end if
    changes(1) = -0.5_wp*dot_product(w(:, 0), e(2:4))
    changes(2:4) = 0.5_wp*(e(1)*w(:, 0) + cross(w(:, 0), e(2:4)))
    do i = 1, self%derivatives
      changes(2 + 3*i:4 + 3*i) = turning(:, i)
    end do
  end subroutine change_link

  !> The derivatives of one pole by one parameter.
  pure subroutine change_pole(self, motion, twist, p, omega, v, changes)
    type(link_record_type), intent(in) :: self       !< the record
    type(varied_motion_type), intent(in) :: motion   !< with the motion
    real(wp), intent(in) :: twist(6, 0:2)            !< of the link by the parameter, and its derivatives in time
    real(wp), intent(in) :: p(3)                     !< origin of the link [m]
    real(wp), intent(in) :: omega(3)                 !< angular velocity [rad/s]
    real(wp), intent(in) :: v(3)                     !< velocity of the origin [m/s]
    real(wp), intent(out) :: changes(:)              !< derivatives of its recorded parts
    real(wp) :: place(3), rate, change_of_rate, change_of_velocity(3)

    place = p - motion%plan%origin
    associate (normal => self%plane%normal(:, 1))
      rate = dot_product(normal, omega)
      if (.not. turns(motion%plan, motion%state, rate)) then
        changes = ieee_value(1.0_wp, ieee_quiet_nan)
        return
      end if
      change_of_rate = dot_product(normal, twist(1:3, 1))
      change_of_velocity = shift_at(twist(:, 1), place) + cross(twist(1:3, 0), v)
      changes = part_in_plane(self, shift_at(twist(:, 0), place) + cross(normal, change_of_velocity)/rate &
                                    - cross(normal, v)*(change_of_rate/rate**2))
    end associate
  end subroutine change_pole
end module mech9_link_record
