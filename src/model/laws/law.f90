!> A law of time: an independent coordinate as a given function of time, the setpoint of a motor, or the factor by which a load is
!> multiplied.
module mech9_law
  use mech9_kinds, only: wp
  use mech9_error, only: error_type, place_type, raise, exit_data
  use mech9_text, only: to_text
  implicit none
  private
  public :: law_type, drive_slot_type, law_slot_type, from_inside, refuse_time

  !> A given function of time.
  type, abstract :: law_type
    integer :: coordinate = 0   !< number of the coordinate that it drives or leads; 0 for a factor
    integer :: motor = 0        !< number of the motor whose voltage or setpoint it gives; 0 for other laws
    type(place_type) :: place   !< place of its group in the data file
  contains
    procedure(evaluate_interface), deferred :: evaluate
    procedure :: greatest_rate
    procedure :: next_joint
    procedure :: joint_rate
    procedure :: check_time
    procedure :: owner
    procedure :: constants => unknown_constants
    procedure :: vary => vary_nothing
  end type law_type

  !> One of several drives of different kinds.
  type :: drive_slot_type
    class(law_type), allocatable :: drive
  end type drive_slot_type

  !> One of several laws of different kinds.
  type :: law_slot_type
    class(law_type), allocatable :: law
  end type law_slot_type

  abstract interface
    !> q(t) and its first two derivatives in time; those beyond the time where a law is not smooth. Fails where the law has no
    !> value.
    subroutine evaluate_interface(self, t, q, dq, ddq, err)
      import :: law_type, error_type, wp
      class(law_type), intent(in) :: self                 !< the law
      real(wp), intent(in) :: t                           !< time [s]
      real(wp), intent(out) :: q                          !< the coordinate [rad, m]
      real(wp), intent(out) :: dq                         !< its rate [rad/s, m/s]
      real(wp), intent(out) :: ddq                        !< its acceleration [rad/s^2, m/s^2]
      type(error_type), allocatable, intent(out) :: err   !< allocated if it failed
    end subroutine evaluate_interface
  end interface

contains

  !> A bound of |dq/dt| between t and t + h, so that no movement between two times is overlooked. Laws
  !> whose formula is known give a proven bound. This procedure, for all others, evaluates the law at unevenly spaced
  !> times of the interval and adds a margin by the acceleration. Times at which the law has no value do not count.
  function greatest_rate(self, t, h) result(rate)
    class(law_type), intent(in) :: self     !< the law
    real(wp), intent(in) :: t               !< beginning of the interval [s]
    real(wp), intent(in) :: h               !< length of the interval [s]; may be negative
    real(wp) :: rate
    real(wp), parameter :: between(4) = [0.0_wp, 0.29_wp, 0.62_wp, 1.0_wp]
    type(error_type), allocatable :: err
    real(wp) :: q, dq, ddq
    integer :: i

    rate = 0.0_wp
    do i = 1, size(between)
      call self%evaluate(t + between(i)*h, q, dq, ddq, err)
      if (.not. allocated(err)) rate = max(rate, abs(dq) + 0.25_wp*abs(h*ddq))
    end do
  end function greatest_rate

  !> The next time at which pieces of the law join, where its derivatives may jump; beyond all times where there is none. This
  !> procedure, for smooth laws and those whose formula is not known, gives none.
  pure real(wp) function next_joint(self, t, direction)
    class(law_type), intent(in) :: self     !< the law
    real(wp), intent(in) :: t               !< time; a joint there does not count [s]
    real(wp), intent(in) :: direction       !< +1 for later times, -1 for earlier ones

    next_joint = sign(huge(t), direction)
  end function next_joint

  !> The derivative of the time of a joint by one parameter, from those of the numbers of the law. This procedure is for laws without
  !> joints.
  pure real(wp) function joint_rate(self, change, joint)
    class(law_type), intent(in) :: self     !< the law
    real(wp), intent(in) :: change(:)       !< derivatives of its numbers
    real(wp), intent(in) :: joint           !< time of the joint [s]

    joint_rate = 0.0_wp
  end function joint_rate

  !> Fail where the law has no value at a time. This procedure, for laws that have values at all times, never does.
  subroutine check_time(self, t, demand, err)
    class(law_type), intent(in) :: self                 !< the law
    real(wp), intent(in) :: t                           !< the time [s]
    character(len=*), intent(in) :: demand              !< the words before this time, for example 'the run goes on to'
    type(error_type), allocatable, intent(out) :: err   !< allocated if there is no value
  end subroutine check_time

  !> Fail because a law has values from one time to another, and not at a time that lies outside. The numbers have as many digits
  !> as show the difference.
  subroutine refuse_time(self, name, first, last, t, demand, remedy, err)
    class(law_type), intent(in) :: self                 !< the law
    character(len=*), intent(in) :: name                !< of that which gives its values, in the singular
    real(wp), intent(in) :: first                       !< time of the first value [s]
    real(wp), intent(in) :: last                        !< time of the last value [s]
    real(wp), intent(in) :: t                           !< the time outside [s]
    character(len=*), intent(in) :: demand              !< the words before this time
    character(len=*), intent(in) :: remedy              !< in the imperative
    type(error_type), allocatable, intent(out) :: err   !< the failure
    real(wp) :: edge
    integer :: digits

    edge = merge(first, last, t < first)
    do digits = 6, 16
      if (to_text(edge, digits) /= to_text(t, digits)) exit
    end do
    call raise(err, exit_data, 'the '//name//' of the '//trim(self%owner())//' has no value '// &
               trim(merge('before', 'after ', t < first))//' t = '//to_text(edge, digits)//' s, and '//demand//' t = '// &
               to_text(t, digits)//' s; '//remedy, self%place)
  end subroutine refuse_time

  !> The owner of the law in messages.
  pure function owner(self)
    class(law_type), intent(in) :: self     !< the law
    character(len=40) :: owner

    owner = 'load'
    if (self%motor > 0) owner = 'motor '//to_text(self%motor)
    if (self%coordinate > 0 .and. self%motor == 0) owner = 'drive of coordinate '//to_text(self%coordinate)
  end function owner

  !> The numbers on which the law depends smoothly, in a fixed order. This procedure, for laws whose numbers are not known,
  !> gives none.
  pure subroutine unknown_constants(self, values)
    class(law_type), intent(in) :: self              !< the law
    real(wp), allocatable, intent(out) :: values(:)  !< its numbers; not allocated where they are not known

  end subroutine unknown_constants

  !> The derivatives of q, dq and ddq by one parameter, from those of the numbers of the law. This procedure is for laws without
  !> such numbers.
  subroutine vary_nothing(self, change, t, q, dq, ddq)
    class(law_type), intent(in) :: self      !< the law
    real(wp), intent(in) :: change(:)        !< derivatives of its numbers
    real(wp), intent(in) :: t                !< time [s]
    real(wp), intent(out) :: q               !< derivative of the coordinate [rad, m]
    real(wp), intent(out) :: dq              !< derivative of its rate [rad/s, m/s]
    real(wp), intent(out) :: ddq             !< derivative of its acceleration [rad/s^2, m/s^2]

    q = 0.0_wp
    dq = 0.0_wp
    ddq = 0.0_wp
  end subroutine vary_nothing

  !> A time at or near a joint, moved into the piece on one side of it by a little more than round-off.
  pure real(wp) function from_inside(t, direction)
    real(wp), intent(in) :: t           !< time [s]
    real(wp), intent(in) :: direction   !< +1 for the piece after it, -1 for the one before it

    from_inside = t + sign(16.0_wp*max(spacing(t), spacing(1.0e-6_wp)), direction)
  end function from_inside
end module mech9_law
