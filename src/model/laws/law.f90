!> A law of time: an independent coordinate as a given function of time, the setpoint of a motor, or the factor by which a load is
!> multiplied. A load or a motor may have a law over another variable in place of time.
module mech9_law
  use mech9_kinds, only: wp
  use mech9_error, only: error_type, place_type, raise, exit_data, exit_integrator
  use mech9_text, only: to_text
  implicit none
  private
  public :: law_type, drive_slot_type, law_slot_type, from_inside, refuse_time, repetition_type
  public :: unknown_repetition, never_repeats, stands_still, moves_steadily, repeats_after

  !> Ways in which a law goes on for ever.
  integer, parameter :: unknown_repetition = 0   !< nothing is known about it
  integer, parameter :: never_repeats = 1        !< it never has the same course again
  integer, parameter :: stands_still = 2         !< its value is constant
  integer, parameter :: moves_steadily = 3       !< its rate is constant
  integer, parameter :: repeats_after = 4        !< its course is the same after each period, but for an advance

  !> How a law repeats.
  type :: repetition_type
    integer :: kind = unknown_repetition   !< one of the numbers above
    real(wp) :: period = 0.0_wp            !< least time after which the course is the same; 0 for other kinds [s]
    real(wp) :: advance = 0.0_wp           !< change of the value within a period [rad, m]
    real(wp) :: rate = 0.0_wp              !< rate of a steady law [rad/s, m/s]
  end type repetition_type

  !> A given function of time.
  type, abstract :: law_type
    integer :: coordinate = 0   !< number of the coordinate that it drives or leads; 0 for a factor
    integer :: motor = 0        !< number of the motor whose voltage or setpoint it gives; 0 for other laws
    integer :: load = 0         !< number of the load that it multiplies, where its variable is not the time; 0 for other laws
    character(len=80) :: variable = 't'       !< name of its variable
    character(len=8) :: variable_unit = 's'   !< unit of the variable
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
    procedure :: antiderivatives => no_antiderivatives
    procedure :: vary_antiderivatives => no_varied_antiderivatives
    procedure :: has_value_at
    procedure :: repetition => repetition_of_unknown
    procedure, non_overridable :: integrals
    procedure, non_overridable :: vary_integrals
    procedure, non_overridable :: wording_at
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

  !> Fail because a law has values from one value of its variable to another, and not outside. The numbers have as many digits as
  !> show the difference. A law of time fails with exit_data; one over another variable, which a motion leads there, with
  !> exit_integrator.
  subroutine refuse_time(self, name, first, last, t, demand, remedy, err)
    class(law_type), intent(in) :: self                 !< the law
    character(len=*), intent(in) :: name                !< of that which gives its values, in the singular
    real(wp), intent(in) :: first                       !< variable of the first value [s, or its unit]
    real(wp), intent(in) :: last                        !< variable of the last value
    real(wp), intent(in) :: t                           !< the variable outside
    character(len=*), intent(in) :: demand              !< the words before this time
    character(len=*), intent(in) :: remedy              !< in the imperative
    type(error_type), allocatable, intent(out) :: err   !< the failure
    real(wp) :: edge
    integer :: digits

    edge = merge(first, last, t < first)
    do digits = 6, 16
      if (to_text(edge, digits) /= to_text(t, digits)) exit
    end do
    if (self%variable == 't') then
      call raise(err, exit_data, 'the '//name//' of the '//trim(self%owner())//' has no value '// &
                 trim(merge('before', 'after ', t < first))//' t = '//to_text(edge, digits)//' s, and '//demand//' t = '// &
                 to_text(t, digits)//' s; '//remedy//' or shorten &time', self%place)
    else
      call raise(err, exit_integrator, 'the '//name//' of '//trim(self%owner())//' has values from '// &
                 trim(self%wording_at(first))//' to '//trim(self%wording_at(last))//' only, and the motion leads to '// &
                 trim(self%wording_at(t, digits))//'; '//remedy// &
                 ' or give period=', self%place)
    end if
  end subroutine refuse_time

  !> The variable of the law with a value, in words.
  pure function wording_at(self, x, digits) result(words)
    class(law_type), intent(in) :: self        !< the law
    real(wp), intent(in) :: x                  !< value of the variable
    integer, intent(in), optional :: digits    !< number of digits that are shown; 6 unless given
    character(len=80) :: words
    integer :: shown

    shown = 6
    if (present(digits)) shown = digits
    words = trim(self%variable)//' = '//to_text(x, shown)
    if (self%variable_unit /= '') words = trim(words)//' '//trim(self%variable_unit)
  end function wording_at

  !> The owner of the law in messages.
  pure function owner(self)
    class(law_type), intent(in) :: self     !< the law
    character(len=40) :: owner

    owner = 'load'
    if (self%load > 0) owner = 'load '//to_text(self%load)
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

  !> Whether the law has a value. This procedure, for laws that have values everywhere, answers that it has.
  pure logical function has_value_at(self, x)
    class(law_type), intent(in) :: self     !< the law
    real(wp), intent(in) :: x               !< its variable [s, or its unit]

    has_value_at = .true.
  end function has_value_at

  !> How the law repeats. This procedure, for laws whose formula is not known, does not know it.
  pure type(repetition_type) function repetition_of_unknown(self) result(found)
    class(law_type), intent(in) :: self     !< the law

    found%kind = unknown_repetition
  end function repetition_of_unknown

  !> The integral of the law from its first value, or from 0 where it has none, and the integral of this one. They give loads a
  !> potential. This procedure is for laws of drives, which need none.
  pure subroutine no_antiderivatives(self, x, value, first, second)
    class(law_type), intent(in) :: self     !< the law
    real(wp), intent(in) :: x               !< its variable [s, or its unit]
    real(wp), intent(out) :: value          !< the law
    real(wp), intent(out) :: first          !< its integral
    real(wp), intent(out) :: second         !< the integral of the integral

    value = 0.0_wp
    first = 0.0_wp
    second = 0.0_wp
  end subroutine no_antiderivatives

  !> The derivatives of both by one parameter, from those of the numbers of the law. This procedure is for laws without such
  !> numbers.
  pure subroutine no_varied_antiderivatives(self, change, x, first, second)
    class(law_type), intent(in) :: self     !< the law
    real(wp), intent(in) :: change(:)       !< derivatives of its numbers
    real(wp), intent(in) :: x               !< its variable [s, or its unit]
    real(wp), intent(out) :: first          !< derivative of the integral
    real(wp), intent(out) :: second         !< derivative of the integral of the integral

    first = 0.0_wp
    second = 0.0_wp
  end subroutine no_varied_antiderivatives

  !> The integral of the law from 0, and the integral of this one from 0. Where the law has no value at 0, both begin at its first
  !> value.
  pure subroutine integrals(self, x, value, first, second)
    class(law_type), intent(in) :: self     !< the law
    real(wp), intent(in) :: x               !< its variable [s, or its unit]
    real(wp), intent(out) :: value          !< the law
    real(wp), intent(out) :: first          !< its integral
    real(wp), intent(out) :: second         !< the integral of the integral
    real(wp) :: at_zero, first_at_zero, second_at_zero

    call self%antiderivatives(x, value, first, second)
    if (.not. self%has_value_at(0.0_wp)) return
    call self%antiderivatives(0.0_wp, at_zero, first_at_zero, second_at_zero)
    first = first - first_at_zero
    second = second - second_at_zero - first_at_zero*x
  end subroutine integrals

  !> The derivatives of both integrals by one parameter, from those of the numbers of the law.
  pure subroutine vary_integrals(self, change, x, first, second)
    class(law_type), intent(in) :: self     !< the law
    real(wp), intent(in) :: change(:)       !< derivatives of its numbers
    real(wp), intent(in) :: x               !< its variable [s, or its unit]
    real(wp), intent(out) :: first          !< derivative of the integral
    real(wp), intent(out) :: second         !< derivative of the integral of the integral
    real(wp) :: first_at_zero, second_at_zero

    call self%vary_antiderivatives(change, x, first, second)
    if (.not. self%has_value_at(0.0_wp)) return
    call self%vary_antiderivatives(change, 0.0_wp, first_at_zero, second_at_zero)
    first = first - first_at_zero
    second = second - second_at_zero - first_at_zero*x
  end subroutine vary_integrals

  !> A time at or near a joint, moved into the piece on one side of it by a little more than round-off.
  pure real(wp) function from_inside(t, direction)
    real(wp), intent(in) :: t           !< time [s]
    real(wp), intent(in) :: direction   !< +1 for the piece after it, -1 for the one before it

    from_inside = t + sign(16.0_wp*max(spacing(t), spacing(1.0e-6_wp)), direction)
  end function from_inside
end module mech9_law
