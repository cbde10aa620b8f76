!> The interval of time in which the laws of a motion are smooth, its motors work as they do now, its stops stay closed or open, and its
!> pairs stick or slip.
!>
!> Laws of time have joints, where their derivatives may jump, the forces of motors have kinks at their limits, and rates jump at
!> stops. Steps of the integration end there, so that no step contains such a place.
module mech9_smooth_interval
  use mech9_kinds, only: wp
  use mech9_law, only: law_type, from_inside
  use mech9_model, only: model_type
  implicit none
  private
  public :: smooth_interval_type

  !> The interval around the present time.
  type :: smooth_interval_type
    logical :: ends = .false.     !< a law of time has a joint, or an event lies ahead
    real(wp) :: behind = 0.0_wp   !< beginning of the interval, which was passed last [s]
    real(wp) :: ahead = 0.0_wp    !< its end, which comes next; the largest number, with the direction's sign, if none comes [s]
    integer :: motor = 0          !< number of the motor that passes its limit at the end; 0: none does
    logical :: laws_end = .false.      !< a law of time has a joint
    real(wp) :: joint = 0.0_wp    !< the next joint of the laws of time; the largest number, with the direction's sign, if none comes [s]
    integer :: contact = 0        !< number of the end of a stop that is met or left at the end; 0: none is
    integer :: friction = 0       !< number of the friction whose pair comes to rest or begins to slip at the end; 0: none does
    integer :: rubbing = 0        !< number of the contact of links that comes to rest or begins to slide at the end; 0: none does
    integer :: corner = 0         !< number of the end of a contact whose ball comes to the end of a stretch of its profile; 0: none does
  contains
    procedure :: begin
    procedure :: time_inside
    procedure :: is_end
    procedure :: is_before_end
    procedure :: end_at_event
    procedure :: ends_at_event
    procedure :: is_joint
    procedure :: forget_event
  end type smooth_interval_type

contains

  !> Begin the interval at a time, up to the next joint of the laws of drives, loads and motors.
  subroutine begin(self, model, t)
    class(smooth_interval_type), intent(inout) :: self   !< gets its two ends
    type(model_type), intent(in) :: model                !< the model with the laws
    real(wp), intent(in) :: t                            !< time at which the interval begins [s]
    real(wp) :: direction
    integer :: i

    direction = sign(1.0_wp, model%request%time%end - model%request%time%start)
    self%behind = t
    self%ahead = sign(huge(t), direction)
    self%ends = .false.
    associate (drives => model%problem%drives, loads => model%mechanism%loads, motors => model%mechanism%motors)
      do i = 1, size(drives)
        call take_law(drives(i)%drive)
      end do
      do i = 1, size(loads)
        if (allocated(loads(i)%load%law)) call take_law(loads(i)%load%law)
      end do
      do i = 1, size(motors)
        if (allocated(motors(i)%motor%law)) call take_law(motors(i)%motor%law)
      end do
    end associate
    self%joint = self%ahead
    self%laws_end = self%ends
  contains
    !> Take the next joint of a law into account.
    subroutine take_law(law)
      class(law_type), intent(in) :: law   !< the law
      real(wp) :: joint

      joint = law%next_joint(t, direction)
      self%ends = self%ends .or. abs(joint) < huge(t) .or. abs(law%next_joint(t, -direction)) < huge(t)
      if ((self%ahead - joint)*direction > 0.0_wp) self%ahead = joint
    end subroutine take_law
  end subroutine begin

  !> A time at which laws have the derivatives of the interval: at its ends a little more than round-off inside. At the time of an event
  !> without a joint laws are smooth: times moved there would open a gap between what drives move and what moves freely.
  pure real(wp) function time_inside(self, t)
    class(smooth_interval_type), intent(in) :: self   !< the interval
    real(wp), intent(in) :: t                         !< time within the interval, or at one of its ends [s]
    real(wp) :: direction, first, last

    time_inside = t
    if (.not. self%ends) return
    direction = sign(1.0_wp, self%ahead - self%behind)
    first = from_inside(self%behind, direction)
    last = self%ahead
    if (self%is_joint(last)) last = from_inside(last, -direction)
    if ((t - first)*direction < 0.0_wp) time_inside = first
    if ((last - t)*direction < 0.0_wp) time_inside = last
  end function time_inside

  !> Whether the end of the interval is reached.
  pure logical function is_end(self, t)
    class(smooth_interval_type), intent(in) :: self   !< the interval
    real(wp), intent(in) :: t                         !< time [s]

    is_end = self%ends .and. abs(t - self%ahead) <= 64.0_wp*spacing(t)
  end function is_end

  !> Whether a time lies before the end of the interval, by half of the way at least by which times are moved inside.
  pure logical function is_before_end(self, t)
    class(smooth_interval_type), intent(in) :: self   !< the interval
    real(wp), intent(in) :: t                         !< time [s]
    real(wp) :: direction

    direction = sign(1.0_wp, self%ahead - self%behind)
    is_before_end = 0.5_wp*(from_inside(t, direction) - t)*direction <= (self%ahead - t)*direction
  end function is_before_end

  !> End the interval where a motor passes its limit, a contact is met or left, friction of a pair or of a contact changes, or a ball comes
  !> to the end of a stretch of its profile.
  pure subroutine end_at_event(self, t, motor, contact, friction, rubbing, corner)
    class(smooth_interval_type), intent(inout) :: self   !< the interval
    real(wp), intent(in) :: t                            !< time of the event, ahead [s]
    integer, intent(in) :: motor                         !< number of the motor; 0: none
    integer, intent(in) :: contact                       !< number of the end; 0: none
    integer, intent(in) :: friction                      !< number of the friction; 0: none
    integer, intent(in) :: rubbing                       !< number of the contact of links with friction; 0: none
    integer, intent(in) :: corner                        !< number of the end of the contact with the profile; 0: none

    self%ends = .true.
    self%ahead = t
    self%motor = motor
    self%contact = contact
    self%friction = friction
    self%rubbing = rubbing
    self%corner = corner
  end subroutine end_at_event

  !> Whether an event ends the interval, and not a joint of the laws alone.
  pure logical function ends_at_event(self)
    class(smooth_interval_type), intent(in) :: self   !< the interval

    ends_at_event = self%motor > 0 .or. self%contact > 0 .or. self%friction > 0 .or. self%rubbing > 0 .or. &
                    self%corner > 0
  end function ends_at_event

  !> Whether a joint of the laws lies at a time.
  pure logical function is_joint(self, t)
    class(smooth_interval_type), intent(in) :: self   !< the interval
    real(wp), intent(in) :: t                         !< time [s]

    is_joint = self%laws_end .and. abs(t - self%joint) <= 64.0_wp*spacing(t)
  end function is_joint

  !> Go on to the next joint of the laws, as if no event lay ahead.
  pure subroutine forget_event(self)
    class(smooth_interval_type), intent(inout) :: self   !< the interval

    self%ends = self%laws_end
    self%ahead = self%joint
    self%motor = 0
    self%contact = 0
    self%friction = 0
    self%rubbing = 0
    self%corner = 0
  end subroutine forget_event
end module mech9_smooth_interval
