!> The division of a step into parts within which the gap of a contact changes smoothly.
!>
!> The gap to a curve with corners is no polynomial of time where another part of the curve becomes the nearest one. A step in which this
!> can happen is halved until it cannot, by a bound of Lipschitz: a distance changes no faster than the point moves.
module mech9_smooth_parts
  use mech9_kinds, only: wp
  use mech9_contact, only: contact_type, contact_place_type, is_beyond_reach, profile_surface
  implicit none
  private
  public :: gap_look_type, smooth_parts_type, begin_parts

  !> The gap of a contact at one time.
  type :: gap_look_type
    real(wp) :: t = 0.0_wp              !< the time [s]
    real(wp) :: gap = 0.0_wp            !< [rad, m]
    real(wp) :: rate = 0.0_wp           !< its derivative in time [rad/s, m/s]
    real(wp) :: acceleration = 0.0_wp   !< its second derivative [rad/s^2, m/s^2]
    type(contact_place_type) :: place   !< of a contact of links
  end type gap_look_type

  !> A step is halved no more often: a part of a curve that is passed in a shorter time than that is passed by.
  integer, parameter :: most_halvings = 10

  !> The parts of a step, from its start.
  type :: smooth_parts_type
    type(gap_look_type) :: first                       !< start of the first part that is left
    type(gap_look_type) :: last                        !< its end
    type(gap_look_type), private :: behind(most_halvings)   !< ends of the parts behind it, the nearest one last
    integer, private :: halvings(0:most_halvings) = 0  !< how often the step was halved for each of them, and for the first part
    integer, private :: n_behind = 0                   !< number of parts behind it
  contains
    procedure :: must_halve
    procedure :: halve
    procedure :: go_on
    procedure :: jumps
  end type smooth_parts_type

contains

  !> A step that is not divided yet.
  pure subroutine begin_parts(first, last, parts)
    type(gap_look_type), intent(in) :: first        !< the gap at its start
    type(gap_look_type), intent(in) :: last         !< the gap at its end
    type(smooth_parts_type), intent(out) :: parts   !< the step

    parts%first = first
    parts%last = last
  end subroutine begin_parts

  !> Whether the gap may not be smooth in the first part that is left, which can be halved.
  pure logical function must_halve(self, contact)
    class(smooth_parts_type), intent(in) :: self   !< the parts
    type(contact_type), intent(in) :: contact      !< the contact

    must_halve = self%halvings(self%n_behind) < most_halvings
    if (must_halve) must_halve = .not. contact%is_smooth_between(self%first%place, self%last%place, self%last%t - self%first%t)
  end function must_halve

  !> Halve the first part that is left.
  pure subroutine halve(self, middle)
    class(smooth_parts_type), intent(inout) :: self   !< the parts
    type(gap_look_type), intent(in) :: middle         !< the gap in its middle

    associate (n => self%n_behind)
      self%halvings(n) = self%halvings(n) + 1
      n = n + 1
      self%halvings(n) = self%halvings(n - 1)
      self%behind(n) = self%last
    end associate
    self%last = middle
  end subroutine halve

  !> Go on to the next part, if there is one.
  pure subroutine go_on(self, found)
    class(smooth_parts_type), intent(inout) :: self   !< the parts
    logical, intent(out) :: found                     !< there is one

    found = self%n_behind > 0
    if (.not. found) return
    self%first = self%last
    self%last = self%behind(self%n_behind)
    self%n_behind = self%n_behind - 1
  end subroutine go_on

  !> Whether the gap falls from one side of the contact to the other in the first part that is left, by more than the ball can move: it
  !> comes from behind the curve.
  pure logical function jumps(self, contact)
    class(smooth_parts_type), intent(in) :: self   !< the parts
    type(contact_type), intent(in) :: contact      !< the contact

    jumps = self%first%gap > 0.0_wp .and. self%last%gap < 0.0_wp .and. contact%surface == profile_surface
    if (jumps) jumps = .not. contact%profile%neighbours(self%first%place%part, self%last%place%part) .and. &
                       is_beyond_reach(self%first%place, self%last%place, self%last%t - self%first%t)
  end function jumps
end module mech9_smooth_parts
