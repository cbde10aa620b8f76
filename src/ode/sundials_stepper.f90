!> The part that every method of SUNDIALS has in common: a context, the vector in which steps end, and the place in time.
module mech9_sundials_stepper
  use, intrinsic :: iso_c_binding, only: c_ptr, c_null_ptr, c_associated, c_int, c_double
  use mech9_kinds, only: wp
  use mech9_stepper, only: stepper_type
  use mech9_sundials, only: N_Vector, FN_VGetArrayPointer, FN_VDestroy, index_kind, open_context, close_context
  use mech9_sundials_system, only: system_box_type
  use fnvector_serial_mod, only: FN_VNew_Serial
  implicit none
  private
  public :: sundials_stepper_type, most_failures

  !> A step is given up after so many failures, of the error test or of a trial that went too far. Each failure makes the
  !> step a third at most.
  integer(c_int), parameter :: most_failures = 20

  !> A method of SUNDIALS at work. Each method frees its own memory, then calls close_steps.
  type, abstract, extends(stepper_type) :: sundials_stepper_type
    type(system_box_type), pointer :: box => null()   !< the system
    type(c_ptr) :: context = c_null_ptr               !< for this integration alone
    type(c_ptr) :: memory = c_null_ptr                !< of the method
    type(N_Vector), pointer :: vector => null()       !< y at the end of the last step
    real(c_double), pointer :: values(:) => null()    !< the numbers in this vector
    real(wp) :: t = 0.0_wp                            !< end of the last step [s]
    real(wp) :: last_step = 0.0_wp                    !< its length with its sign; 0 before the first one [s]
  contains
    procedure :: open_steps
    procedure :: new_vector
    procedure :: note_step
    procedure :: close_steps
  end type sundials_stepper_type

contains

  !> Open a context, and in it the vector of steps, which gets the initial values.
  subroutine open_steps(self, box, t, y, opened)
    class(sundials_stepper_type), intent(inout) :: self   !< the method, not yet at work
    type(system_box_type), pointer, intent(in) :: box     !< holds the system; must outlive the method
    real(wp), intent(in) :: t                             !< [s]
    real(wp), intent(in) :: y(:)                          !< initial values
    logical, intent(out) :: opened                        !< false: there is not enough memory
    integer(c_int) :: flag

    opened = .false.
    self%box => box
    self%t = t
    call open_context(self%context, flag)
    if (flag /= 0) return
    self%vector => self%new_vector(y)
    if (.not. associated(self%vector)) return
    self%values => FN_VGetArrayPointer(self%vector)
    opened = .true.
  end subroutine open_steps

  !> A vector of SUNDIALS with the given numbers, or null when there is not enough memory.
  function new_vector(self, numbers) result(vector)
    class(sundials_stepper_type), intent(in) :: self   !< the method, whose context is open
    real(wp), intent(in) :: numbers(:)                 !< the parts of the vector
    type(N_Vector), pointer :: vector                  !< the vector; to be destroyed by FN_VDestroy
    real(c_double), pointer :: values(:)

    vector => FN_VNew_Serial(int(size(numbers), index_kind), self%context)
    if (.not. associated(vector)) return
    values => FN_VGetArrayPointer(vector)
    values = numbers
  end function new_vector

  !> Keep the end and the length of a step that SUNDIALS has made, and give its result out.
  subroutine note_step(self, t_reached, t, y)
    class(sundials_stepper_type), intent(inout) :: self   !< the method at work
    real(c_double), intent(in) :: t_reached               !< end of the step [s]
    real(wp), intent(out) :: t                            !< the same [s]
    real(wp), intent(out) :: y(:)                         !< values there

    t = t_reached
    y = self%values
    self%last_step = t - self%t
    self%t = t
  end subroutine note_step

  !> Destroy the vector of steps and close the context. The method's own memory must be free by then.
  subroutine close_steps(self)
    class(sundials_stepper_type), intent(inout) :: self   !< the method

    if (associated(self%vector)) call FN_VDestroy(self%vector)
    if (c_associated(self%context)) call close_context(self%context)
    self%memory = c_null_ptr
    self%context = c_null_ptr
    self%vector => null()
    self%values => null()
  end subroutine close_steps
end module mech9_sundials_stepper
