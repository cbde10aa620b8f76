!> The part that every method of SUNDIALS has in common: its start, the making of a step, and the meaning of SUNDIALS' answers.
module mech9_sundials_stepper
  use, intrinsic :: iso_c_binding, only: c_ptr, c_null_ptr, c_associated, c_int, c_double
  use mech9_kinds, only: wp
  use mech9_integration_methods, only: integration_method_type
  use mech9_stepper, only: stepper_type, tolerances_type, stepped, evaluation_failed, too_inaccurate, not_convergent, &
    too_accurate, out_of_memory, refused
  use mech9_sundials, only: N_Vector, FN_VGetArrayPointer, FN_VDestroy, index_kind, open_context, close_context
  use mech9_sundials_system, only: system_box_type
  use fnvector_serial_mod, only: FN_VNew_Serial
  use farkode_mod, only: ARK_SUCCESS, ARK_TSTOP_RETURN, ARK_ERR_FAILURE, ARK_TOO_MUCH_ACC, ARK_RHSFUNC_FAIL, &
    ARK_FIRST_RHSFUNC_ERR, ARK_REPTD_RHSFUNC_ERR, ARK_UNREC_RHSFUNC_ERR, ARK_POSTPROCESS_STEP_FAIL, ARK_MEM_FAIL
  use fcvode_mod, only: CV_SUCCESS, CV_TSTOP_RETURN, CV_TOO_MUCH_ACC, CV_ERR_FAILURE, CV_CONV_FAILURE, CV_LSETUP_FAIL, &
    CV_LSOLVE_FAIL, CV_RHSFUNC_FAIL, CV_FIRST_RHSFUNC_ERR, CV_REPTD_RHSFUNC_ERR, CV_UNREC_RHSFUNC_ERR, CV_MEM_FAIL
  implicit none
  private
  public :: sundials_stepper_type, most_failures, meaning, answers_agree

  !> A step is given up after so many failures, of the error test or of a trial that went too far. Each failure makes the
  !> step a third at most.
  integer(c_int), parameter :: most_failures = 20

  !> Whether CVODE and ERKStep give the same answers for the same outcomes, so that `meaning` holds for both.
  logical, parameter :: answers_agree = all( &
    [CV_SUCCESS, CV_TSTOP_RETURN, CV_TOO_MUCH_ACC, CV_ERR_FAILURE, CV_RHSFUNC_FAIL, CV_FIRST_RHSFUNC_ERR, CV_REPTD_RHSFUNC_ERR, &
     CV_UNREC_RHSFUNC_ERR, CV_MEM_FAIL] == &
    [ARK_SUCCESS, ARK_TSTOP_RETURN, ARK_TOO_MUCH_ACC, ARK_ERR_FAILURE, ARK_RHSFUNC_FAIL, ARK_FIRST_RHSFUNC_ERR, &
     ARK_REPTD_RHSFUNC_ERR, ARK_UNREC_RHSFUNC_ERR, ARK_MEM_FAIL])

  !> A method of SUNDIALS at work.
  type, abstract, extends(stepper_type) :: sundials_stepper_type
    type(system_box_type), pointer :: box => null()   !< the system
    type(c_ptr) :: context = c_null_ptr               !< for this integration alone
    type(c_ptr) :: memory = c_null_ptr                !< of the method
    type(N_Vector), pointer :: vector => null()       !< y at the end of the last step
    real(c_double), pointer :: values(:) => null()    !< the numbers in this vector
    real(wp) :: t = 0.0_wp                            !< end of the last step [s]
    real(wp) :: last_step = 0.0_wp                    !< its length with its sign; 0 before the first one [s]
  contains
    procedure :: start
    procedure :: advance
    procedure :: restart
    procedure :: close => close_steps
    procedure :: finish_step
    procedure(open_interface), deferred :: open_method
    procedure(set_up_interface), deferred :: set_up
    procedure(time_interface), deferred :: stop_at
    procedure(time_interface), deferred :: turn_back
    procedure(step_interface), deferred :: make_step
    procedure(time_interface), deferred :: begin_anew
    procedure(free_interface), deferred :: free_method
  end type sundials_stepper_type

  abstract interface
    !> Open the method in SUNDIALS at the values in the vector of steps, without messages on the terminal.
    subroutine open_interface(self, method, flag)
      import :: sundials_stepper_type, integration_method_type, c_int
      class(sundials_stepper_type), intent(inout) :: self   !< the method
      type(integration_method_type), intent(in) :: method   !< its name and properties
      integer(c_int), intent(out) :: flag                   !< answer of SUNDIALS; 0 when all is well, of use where there is memory
    end subroutine open_interface

    !> Give the open method all that it needs.
    subroutine set_up_interface(self, method, relative, absolute, flag)
      import :: sundials_stepper_type, integration_method_type, N_Vector, wp, c_int
      class(sundials_stepper_type), intent(inout) :: self   !< the method
      type(integration_method_type), intent(in) :: method   !< its name and properties
      real(wp), intent(in) :: relative                      !< tolerance of each variable, in a step
      type(N_Vector), intent(inout) :: absolute             !< tolerances of the variables, each in its unit; destroyed afterwards
      integer(c_int), intent(out) :: flag                   !< answer of SUNDIALS; 0 when all is well
    end subroutine set_up_interface

    !> Let the next step end at a time at most (`stop_at`), also where this is against the direction of the last step (`turn_back`);
    !> or begin anew at the present time and values, with a first step of this length, 0: to be found (`begin_anew`).
    subroutine time_interface(self, time, flag)
      import :: sundials_stepper_type, wp, c_int
      class(sundials_stepper_type), intent(inout) :: self   !< the method at work
      real(wp), intent(in) :: time                          !< latest end of the step, or length with its sign [s]
      integer(c_int), intent(out) :: flag                   !< answer of SUNDIALS; 0 when all is well
    end subroutine time_interface

    !> Make one accepted step, which ends in the vector of steps.
    subroutine step_interface(self, t_stop, t_reached, flag)
      import :: sundials_stepper_type, wp, c_double, c_int
      class(sundials_stepper_type), intent(inout) :: self   !< the method at work
      real(wp), intent(in) :: t_stop                        !< latest end of the step [s]
      real(c_double), intent(out) :: t_reached(1)           !< end of the step [s]
      integer(c_int), intent(out) :: flag                   !< answer of SUNDIALS
    end subroutine step_interface

    !> Free the memory that is the method's own.
    subroutine free_interface(self)
      import :: sundials_stepper_type
      class(sundials_stepper_type), intent(inout) :: self   !< the method, perhaps not at work yet
    end subroutine free_interface
  end interface

contains

  !> Put the method to work on the system in the box, from (t, y). `outcome` is `stepped` when all is well.
  subroutine start(self, method, box, tolerances, t, y, outcome)
    class(sundials_stepper_type), intent(inout) :: self   !< gets to work
    type(integration_method_type), intent(in) :: method   !< a method of its family
    type(system_box_type), pointer, intent(in) :: box     !< holds the system; must outlive the method
    type(tolerances_type), intent(in) :: tolerances       !< of a step
    real(wp), intent(in) :: t                             !< [s]
    real(wp), intent(in) :: y(:)                          !< initial values
    integer, intent(out) :: outcome                       !< `stepped`, or why it failed
    type(N_Vector), pointer :: absolute
    integer(c_int) :: flag

    outcome = out_of_memory
    self%box => box
    self%t = t
    call open_context(self%context, flag)
    if (flag /= 0) return
    self%vector => new_vector(self%context, y)
    if (.not. associated(self%vector)) return
    self%values => FN_VGetArrayPointer(self%vector)
    call self%open_method(method, flag)
    if (.not. c_associated(self%memory)) return
    absolute => new_vector(self%context, tolerances%absolute)
    if (.not. associated(absolute)) return
    if (flag == 0) call self%set_up(method, tolerances%relative, absolute, flag)
    call FN_VDestroy(absolute)
    outcome = merge(stepped, refused, flag == 0)
  end subroutine start

  !> A vector of SUNDIALS with the given numbers, or null when there is not enough memory.
  function new_vector(context, numbers) result(vector)
    type(c_ptr), intent(in) :: context   !< the open context
    real(wp), intent(in) :: numbers(:)   !< the parts of the vector
    type(N_Vector), pointer :: vector    !< the vector; to be destroyed by FN_VDestroy
    real(c_double), pointer :: values(:)

    vector => FN_VNew_Serial(int(size(numbers), index_kind), context)
    if (.not. associated(vector)) return
    values => FN_VGetArrayPointer(vector)
    values = numbers
  end function new_vector

  !> A step against the direction of the last one needs preparations.
  subroutine advance(self, t_stop, t, y, outcome)
    class(sundials_stepper_type), intent(inout) :: self   !< the method at work
    real(wp), intent(in) :: t_stop                        !< latest end of the step [s]
    real(wp), intent(out) :: t                            !< end of the step [s]
    real(wp), intent(out) :: y(:)                         !< values there
    integer, intent(out) :: outcome                       !< `stepped`, or why it failed
    real(c_double) :: t_reached(1)
    integer(c_int) :: flag

    if ((t_stop - self%t)*self%last_step < 0.0_wp) then
      call self%turn_back(t_stop, flag)
    else
      call self%stop_at(t_stop, flag)
    end if
    if (flag == 0) call self%make_step(t_stop, t_reached, flag)
    outcome = meaning(flag)
    if (outcome /= stepped) return
    t = t_reached(1)
    y = self%values
    self%last_step = t - self%t
    self%t = t
    call self%finish_step(t, y, outcome)
  end subroutine advance

  !> Finish a step that SUNDIALS has accepted. This procedure is for methods of which SUNDIALS leaves nothing to do.
  subroutine finish_step(self, t, y, outcome)
    class(sundials_stepper_type), intent(inout) :: self   !< the method at work
    real(wp), intent(in) :: t                             !< end of the step [s]
    real(wp), intent(inout) :: y(:)                       !< values there
    integer, intent(out) :: outcome                       !< `stepped`, or why it failed

    outcome = stepped
  end subroutine finish_step

  !> The next step starts from the given values.
  subroutine restart(self, t, y, first_step, outcome)
    class(sundials_stepper_type), intent(inout) :: self   !< the method at work
    real(wp), intent(in) :: t                             !< time of the beginning [s]
    real(wp), intent(in) :: y(:)                          !< values there
    real(wp), intent(in) :: first_step                    !< its length with its sign; 0: to be found [s]
    integer, intent(out) :: outcome                       !< `stepped`, or why it failed
    integer(c_int) :: flag

    self%values = y
    self%t = t
    call self%begin_anew(first_step, flag)
    outcome = meaning(flag)
  end subroutine restart

  !> The outcome that an answer of SUNDIALS means. CVODE and ERKStep give the same answers, but for some that only one of them has.
  pure integer function meaning(flag)
    integer(c_int), intent(in) :: flag   !< answer of a function of SUNDIALS

    select case (flag)
    case (CV_SUCCESS, CV_TSTOP_RETURN)
      meaning = stepped
    case (CV_RHSFUNC_FAIL, CV_FIRST_RHSFUNC_ERR, CV_REPTD_RHSFUNC_ERR, CV_UNREC_RHSFUNC_ERR, CV_LSETUP_FAIL, &
          ARK_POSTPROCESS_STEP_FAIL)
      meaning = evaluation_failed
    case (CV_ERR_FAILURE)
      meaning = too_inaccurate
    case (CV_CONV_FAILURE, CV_LSOLVE_FAIL)
      meaning = not_convergent
    case (CV_TOO_MUCH_ACC)
      meaning = too_accurate
    case (CV_MEM_FAIL)
      meaning = out_of_memory
    case default
      meaning = refused
    end select
  end function meaning

  !> Free the memory of SUNDIALS.
  subroutine close_steps(self)
    class(sundials_stepper_type), intent(inout) :: self   !< the method

    call self%free_method()
    if (associated(self%vector)) call FN_VDestroy(self%vector)
    if (c_associated(self%context)) call close_context(self%context)
    self%memory = c_null_ptr
    self%context = c_null_ptr
    self%vector => null()
    self%values => null()
  end subroutine close_steps
end module mech9_sundials_stepper
