!> Stops, which bound a coordinate: rigid ones, with impacts, or compliant ones, which push back by a law of Hunt and Crossley.
!>
!> The penetration d of a compliant stop gives the force d^exponent (stiffness + damping dd/dt), as long as it pushes: K. H. Hunt
!> and F. R. E. Crossley, Coefficient of Restitution Interpreted as Damping in Vibroimpact, J. Appl. Mech. 42 (1975).
module mech9_stop
  use mech9_kinds, only: wp
  use mech9_error, only: place_type
  implicit none
  private
  public :: stop_type

  !> A stop at one or both ends of the range of a coordinate. End 1 is the low one, end 2 the high one.
  type :: stop_type
    type(place_type) :: place                      !< place of its group in the data file
    integer :: coordinate = 0                      !< number of the coordinate, independent or not
    real(wp) :: ends(2) = [-huge(1.0_wp), huge(1.0_wp)]   !< least and greatest value of the coordinate; huge: no end [rad, m]
    logical :: is_rigid = .true.                   !< it cannot be pressed in
    real(wp) :: restitution = 0.0_wp               !< of a rigid one: rate after an impact over that before it, 0 to 1
    real(wp) :: stiffness = 0.0_wp                 !< of a compliant one [N m/rad^n, N/m^n]
    real(wp) :: damping = 0.0_wp                   !< of a compliant one, force per rate and power of the penetration
    real(wp) :: exponent = 1.0_wp                  !< n, of the penetration
  contains
    procedure :: has_end
    procedure :: gap
    procedure :: force
    procedure :: slopes
  end type stop_type

contains

  !> Whether the stop has an end.
  pure logical function has_end(self, end)
    class(stop_type), intent(in) :: self   !< the stop
    integer, intent(in) :: end             !< 1: the low one, 2: the high one

    has_end = abs(self%ends(end)) < huge(1.0_wp)
  end function has_end

  !> The gap that is left to an end of the stop; negative: the penetration [rad, m].
  pure real(wp) function gap(self, end, q)
    class(stop_type), intent(in) :: self   !< the stop
    integer, intent(in) :: end             !< 1: the low one, 2: the high one
    real(wp), intent(in) :: q              !< the coordinate [rad, m]

    gap = q - self%ends(1)
    if (end == 2) gap = self%ends(2) - q
  end function gap

  !> The force of a compliant stop on its coordinate, positive at the low end [N m, N]. Where it is known which ends push, others do not,
  !> wherever the coordinate is: the force is smooth in the steps of an integration that ends where an end is met or left.
  pure real(wp) function force(self, q, dq, pressed)
    class(stop_type), intent(in) :: self   !< the stop
    real(wp), intent(in) :: q              !< the coordinate [rad, m]
    real(wp), intent(in) :: dq             !< its rate [rad/s, m/s]
    logical, intent(in), optional :: pressed(2)   !< ends that push
    real(wp) :: depth
    integer :: end, direction

    force = 0.0_wp
    do end = 1, 2
      depth = -self%gap(end, q)
      if (.not. depth > 0.0_wp) cycle
      if (present(pressed)) then
        if (.not. pressed(end)) cycle
      end if
      direction = 3 - 2*end
      force = direction*max(0.0_wp, depth**self%exponent*(self%stiffness - direction*self%damping*dq))
    end do
  end function force

  !> The derivatives of the force of a compliant stop by the coordinate, its rate, and the numbers: both ends, stiffness, damping and
  !> exponent.
  pure function slopes(self, q, dq, pressed)
    class(stop_type), intent(in) :: self   !< the stop
    real(wp), intent(in) :: q              !< the coordinate [rad, m]
    real(wp), intent(in) :: dq             !< its rate [rad/s, m/s]
    logical, intent(in), optional :: pressed(2)   !< ends that push, where it is known
    real(wp) :: slopes(7)
    real(wp) :: depth, push, power
    integer :: end, direction

    slopes = 0.0_wp
    do end = 1, 2
      depth = -self%gap(end, q)
      direction = 3 - 2*end
      push = self%stiffness - direction*self%damping*dq
      if (.not. (depth > 0.0_wp .and. push > 0.0_wp)) cycle
      if (present(pressed)) then
        if (.not. pressed(end)) cycle
      end if
      power = depth**self%exponent
      slopes(1) = -self%exponent*depth**(self%exponent - 1.0_wp)*push
      slopes(2) = -power*self%damping
      slopes(2 + end) = -slopes(1)
      slopes(5) = direction*power
      slopes(6) = -power*dq
      slopes(7) = direction*power*log(depth)*push
    end do
  end function slopes
end module mech9_stop
