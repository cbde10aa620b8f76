!> A method of integration, one step at a time, and what can become of a step.
module mech9_stepper
  use mech9_kinds, only: wp, long
  implicit none
  private
  public :: stepper_type, stepper_counts_type
  public :: stepped, evaluation_failed, too_inaccurate, not_convergent, too_accurate, out_of_memory, refused

  !> What became of a step.
  integer, parameter :: stepped = 0
  integer, parameter :: evaluation_failed = 1  !< the system failed; it knows why
  integer, parameter :: too_inaccurate = 2     !< the error test failed again and again
  integer, parameter :: not_convergent = 3     !< the implicit equations could not be solved
  integer, parameter :: too_accurate = 4       !< more is asked for than the numbers can hold
  integer, parameter :: out_of_memory = 5
  integer, parameter :: refused = 6            !< anything else

  !> What a method counted from its creation on.
  type :: stepper_counts_type
    integer(long) :: error_test_failures = 0
    integer(long) :: convergence_failures = 0
    integer(long) :: jacobian_evaluations = 0  !< of the system's own Jacobian, or of differences of its rate
    integer :: last_order = 0
    real(wp) :: last_step = 0.0_wp             !< [s]
  end type stepper_counts_type

  !> A method at work. It starts from the values it was created with.
  type, abstract :: stepper_type
  contains
    procedure(advance_interface), deferred :: advance
    procedure(interpolate_interface), deferred :: interpolate
    procedure(correct_interface), deferred :: correct
    procedure(restart_interface), deferred :: restart
    procedure(limit_interface), deferred :: limit
    procedure(next_step_interface), deferred :: next_step
    procedure(counts_interface), deferred :: counts
    procedure(close_interface), deferred :: close
  end type stepper_type

  abstract interface
    !> One accepted and settled step, at most to t_stop, which is met exactly. Without success t and y
    !> mean nothing, and the method must be restarted.
    subroutine advance_interface(self, t_stop, t, y, outcome)
      import :: stepper_type, wp
      class(stepper_type), intent(inout) :: self   !< the stepper
      real(wp), intent(in) :: t_stop           !< [s]
      real(wp), intent(out) :: t               !< [s]
      real(wp), intent(out) :: y(:)
      integer, intent(out) :: outcome
    end subroutine advance_interface

    !> What the method itself takes for y at a time within the last step; `found` is false where it has no way to
    !> tell it as accurately as the ends of steps.
    subroutine interpolate_interface(self, t, y, found)
      import :: stepper_type, wp
      class(stepper_type), intent(inout) :: self   !< the stepper
      real(wp), intent(in) :: t                !< [s]
      real(wp), intent(out) :: y(:)
      logical, intent(out) :: found
    end subroutine interpolate_interface

    !> Go on from y, changed a little, instead of what the last step gave.
    subroutine correct_interface(self, t, y, outcome)
      import :: stepper_type, wp
      class(stepper_type), intent(inout) :: self   !< the stepper
      real(wp), intent(in) :: t                !< of the last step [s]
      real(wp), intent(in) :: y(:)
      integer, intent(out) :: outcome
    end subroutine correct_interface

    !> Begin anew at (t, y) with a step of the given length, or of one to be found if it is 0.
    subroutine restart_interface(self, t, y, first_step, outcome)
      import :: stepper_type, wp
      class(stepper_type), intent(inout) :: self   !< the stepper
      real(wp), intent(in) :: t                !< [s]
      real(wp), intent(in) :: y(:)
      real(wp), intent(in) :: first_step       !< with its sign [s]
      integer, intent(out) :: outcome
    end subroutine restart_interface

    !> Take no step longer than this; 0 for no limit.
    subroutine limit_interface(self, largest_step, outcome)
      import :: stepper_type, wp
      class(stepper_type), intent(inout) :: self   !< the stepper
      real(wp), intent(in) :: largest_step     !< [s]
      integer, intent(out) :: outcome
    end subroutine limit_interface

    !> The step intended next, or the one last tried where a step has failed; with its sign [s].
    real(wp) function next_step_interface(self)
      import :: stepper_type, wp
      class(stepper_type), intent(inout) :: self   !< the stepper
    end function next_step_interface

    !> What was counted so far.
    subroutine counts_interface(self, counts)
      import :: stepper_type, stepper_counts_type
      class(stepper_type), intent(inout) :: self   !< the stepper
      type(stepper_counts_type), intent(out) :: counts
    end subroutine counts_interface

    !> Give back what the method holds.
    subroutine close_interface(self)
      import :: stepper_type
      class(stepper_type), intent(inout) :: self   !< the stepper
    end subroutine close_interface
  end interface
end module mech9_stepper
