!> A method of integration, one step at a time, and the outcomes of a step.
module mech9_stepper
  use mech9_kinds, only: wp, long
  implicit none
  private
  public :: stepper_type, stepper_counts_type, tolerances_type
  public :: stepped, evaluation_failed, too_inaccurate, not_convergent, too_accurate, out_of_memory, refused

  !> Outcomes of a step.
  integer, parameter :: stepped = 0             !< the step was made
  integer, parameter :: evaluation_failed = 1   !< the system failed, and keeps the failure
  integer, parameter :: too_inaccurate = 2      !< the error test failed again and again
  integer, parameter :: not_convergent = 3      !< the implicit equations could not be solved
  integer, parameter :: too_accurate = 4        !< the tolerances demand more digits than the numbers have
  integer, parameter :: out_of_memory = 5
  integer, parameter :: refused = 6            !< anything else

  !> Counts of a method from its creation on.
  type :: stepper_counts_type
    integer(long) :: error_test_failures = 0    !< steps made again because of their error
    integer(long) :: convergence_failures = 0   !< implicit steps made again because their equations were not solved
    integer(long) :: jacobian_evaluations = 0   !< of the system's own Jacobian, or of differences of its rate
    integer(long) :: implicit_steps = 0         !< accepted steps of the implicit one of several methods
    integer :: method_changes = 0               !< from one of several methods to another
    integer :: last_order = 0                   !< of the method in the last step
    real(wp) :: last_step = 0.0_wp              !< length of the last step [s]
  end type stepper_counts_type

  !> Errors that are allowed in a step.
  type :: tolerances_type
    real(wp) :: relative = 0.0_wp            !< of each variable
    real(wp), allocatable :: absolute(:)     !< of each variable, in its unit
  contains
    procedure :: times
  end type tolerances_type

  !> A method at work. It starts from the values given at its creation.
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
    !> One accepted step and its projection, at most to t_stop, which is met exactly. Without success t and y mean
    !> nothing, and the method must be restarted.
    subroutine advance_interface(self, t_stop, t, y, outcome)
      import :: stepper_type, wp
      class(stepper_type), intent(inout) :: self   !< the method at work
      real(wp), intent(in) :: t_stop               !< latest end of the step, on either side of the last step's end [s]
      real(wp), intent(out) :: t                   !< end of the step [s]
      real(wp), intent(out) :: y(:)                !< values there
      integer, intent(out) :: outcome              !< `stepped`, or why it failed
    end subroutine advance_interface

    !> The method's own approximation of y at a time within the last step; `found` is false where it has none that is
    !> as accurate as the ends of steps.
    subroutine interpolate_interface(self, t, y, found)
      import :: stepper_type, wp
      class(stepper_type), intent(inout) :: self   !< the method at work
      real(wp), intent(in) :: t                    !< a time within the last step [s]
      real(wp), intent(out) :: y(:)                !< values at t
      logical, intent(out) :: found                !< whether the method can compute them
    end subroutine interpolate_interface

    !> Go on from y, which differs little from the result of the last step.
    subroutine correct_interface(self, t, y, outcome)
      import :: stepper_type, wp
      class(stepper_type), intent(inout) :: self   !< the method at work
      real(wp), intent(in) :: t                    !< end of the last step [s]
      real(wp), intent(in) :: y(:)                 !< the corrected values there
      integer, intent(out) :: outcome              !< `stepped`, or why it failed
    end subroutine correct_interface

    !> Begin anew at (t, y) with a step of the given length, or of one to be found if it is 0.
    subroutine restart_interface(self, t, y, first_step, outcome)
      import :: stepper_type, wp
      class(stepper_type), intent(inout) :: self   !< the method at work
      real(wp), intent(in) :: t                    !< time of the beginning [s]
      real(wp), intent(in) :: y(:)                 !< values there
      real(wp), intent(in) :: first_step           !< length of the first step with its sign; 0: to be found [s]
      integer, intent(out) :: outcome              !< `stepped`, or why it failed
    end subroutine restart_interface

    !> Take no step longer than this; 0 for no limit.
    subroutine limit_interface(self, largest_step, outcome)
      import :: stepper_type, wp
      class(stepper_type), intent(inout) :: self   !< the method at work
      real(wp), intent(in) :: largest_step         !< length of the longest step; 0: no limit [s]
      integer, intent(out) :: outcome              !< `stepped`, or why it failed
    end subroutine limit_interface

    !> The step intended next, or the one last tried where a step has failed; with its sign [s].
    real(wp) function next_step_interface(self)
      import :: stepper_type, wp
      class(stepper_type), intent(inout) :: self   !< the method at work
    end function next_step_interface

    !> The counts so far.
    subroutine counts_interface(self, counts)
      import :: stepper_type, stepper_counts_type
      class(stepper_type), intent(inout) :: self         !< the method at work
      type(stepper_counts_type), intent(out) :: counts   !< the counts since the creation
    end subroutine counts_interface

    !> Free the memory of the method.
    subroutine close_interface(self)
      import :: stepper_type
      class(stepper_type), intent(inout) :: self   !< the method at work
    end subroutine close_interface
  end interface

contains

  !> A part of the tolerances.
  pure function times(self, share) result(tolerances)
    class(tolerances_type), intent(in) :: self   !< the tolerances
    real(wp), intent(in) :: share                !< the part
    type(tolerances_type) :: tolerances

    tolerances%relative = share*self%relative
    tolerances%absolute = share*self%absolute
  end function times
end module mech9_stepper
