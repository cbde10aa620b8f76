!> The motion of a model from its assembly on, driven or free. All who run a model begin here.
module mech9_model_motion
  use mech9_program_kind, only: dynamics
  use mech9_error, only: error_type
  use mech9_model, only: model_type
  use mech9_plan, only: plan_type
  use mech9_state, only: state_type
  use mech9_start_path, only: start_way_type
  use mech9_simulation, only: simulation_type, interruption_type
  use mech9_driven_simulation, only: driven_simulation_type, new_driven_simulation
  use mech9_still_contacts, only: refuse_still_contacts
  use mech9_free_simulation, only: free_simulation_type, new_free_simulation
  use mech9_accuracy, only: find_accuracy
  use mech9_explained_assembly, only: assemble_model
  implicit none
  private
  public :: model_motion_type

  !> Parts are polymorphic, which keeps the code of copies small. It must not be copied once its simulation is there.
  type :: model_motion_type
    class(plan_type), allocatable :: plan               !< of the mechanism
    class(state_type), allocatable :: start             !< the closed position at the start
    type(start_way_type) :: way                         !< how the start was reached from the drawn position
    class(simulation_type), allocatable :: simulation   !< to be started
  contains
    procedure :: assemble
    procedure :: prepare
    procedure :: find_tolerances
    procedure :: is_free
    procedure :: driven
    procedure :: free
    procedure :: close => close_motion
  end type model_motion_type

contains

  !> Make the plan and find the closed position at the start.
  subroutine assemble(self, model, err)
    class(model_motion_type), intent(inout) :: self     !< gets them
    type(model_type), intent(in) :: model               !< the model
    type(error_type), allocatable, intent(out) :: err   !< allocated if it failed

    call self%close()
    if (.not. allocated(self%plan)) allocate (self%plan, self%start)
    call assemble_model(model, self%plan, self%start, err, self%way)
  end subroutine assemble

  !> Make the simulation of an assembled motion, without its first position.
  subroutine prepare(self, model, err, pictures)
    class(model_motion_type), intent(inout) :: self     !< the motion; a simulation that it has is closed
    type(model_type), intent(in), target :: model       !< its model; it must outlive the simulation
    type(error_type), allocatable, intent(out) :: err   !< allocated if it failed
    logical, intent(in), optional :: pictures           !< the motion of all links is requested; not unless given
    type(driven_simulation_type), allocatable :: driven
    type(free_simulation_type), allocatable :: free

    call self%close()
    call refuse_still_contacts(model, self%plan, self%start, err)
    if (allocated(err)) return
    if (model%is_driven()) then
      allocate (driven)
      call new_driven_simulation(model, self%plan, self%start, driven, pictures, model%program == dynamics)
      call move_alloc(driven, self%simulation)
    else
      allocate (free)
      call new_free_simulation(model, self%plan, self%start, free, err, pictures)
      call move_alloc(free, self%simulation)
      if (allocated(err)) call self%close()
    end if
  end subroutine prepare

  !> Find the tolerances for an accuracy, where the model asks for one, and the errors of the simulation. Fails where the user
  !> interrupts.
  subroutine find_tolerances(self, model, err, pictures, interruption)
    class(model_motion_type), intent(inout) :: self     !< the motion, prepared
    type(model_type), intent(inout) :: model            !< its model; gets the tolerances
    type(error_type), allocatable, intent(out) :: err   !< allocated if it failed
    logical, intent(in), optional :: pictures           !< the motion of all links is requested; not unless given
    class(interruption_type), intent(inout), optional, target :: interruption   !< is asked whether the runs shall stop

    if (.not. self%simulation%with_error) return
    call find_accuracy(model, self%plan, self%start, self%simulation%errors, err, pictures, interruption)
  end subroutine find_tolerances

  !> Whether the motion is under forces.
  pure logical function is_free(self)
    class(model_motion_type), intent(in) :: self   !< the motion, prepared

    is_free = .false.
    select type (found => self%simulation)
    type is (free_simulation_type)
      is_free = .true.
    end select
  end function is_free

  !> The simulation of a driven motion.
  function driven(self) result(simulation)
    class(model_motion_type), intent(inout), target :: self     !< the motion, prepared
    type(driven_simulation_type), pointer :: simulation         !< null: the motion is free

    simulation => null()
    select type (found => self%simulation)
    type is (driven_simulation_type)
      simulation => found
    end select
  end function driven

  !> The simulation of a free motion.
  function free(self) result(simulation)
    class(model_motion_type), intent(inout), target :: self     !< the motion, prepared
    type(free_simulation_type), pointer :: simulation           !< null: the motion is driven

    simulation => null()
    select type (found => self%simulation)
    type is (free_simulation_type)
      simulation => found
    end select
  end function free

  !> End the simulation, if there is one.
  subroutine close_motion(self)
    class(model_motion_type), intent(inout) :: self   !< the motion

    if (.not. allocated(self%simulation)) return
    call self%simulation%close()
    deallocate (self%simulation)
  end subroutine close_motion
end module mech9_model_motion
