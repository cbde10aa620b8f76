!> The search for the best design of a model: from many starts to the distinct designs.
module mech9_search
  use mech9_program_kind, only: dynamics
  use mech9_kinds, only: wp
  use mech9_error, only: error_type, raise, exit_usage, exit_data, exit_assembly
  use mech9_explanation, only: explain
  use mech9_model, only: model_type
  use mech9_variable_model, only: variable_model_type
  use mech9_plan, only: plan_type
  use mech9_state, only: state_type
  use mech9_simulation, only: interruption_type
  use mech9_explained_assembly, only: assemble_model
  use mech9_held_start, only: held_start_type, hold_start
  use mech9_synthesis, only: synthesis_type, new_synthesis
  use mech9_search_check, only: check_synthesis
  use mech9_search_starts, only: search_starts_type
  use mech9_processes, only: processes_type
  use mech9_search_processes, only: lead_search, follow_search
  implicit none
  private
  public :: optimum_search_type, check_request

  integer, parameter :: most_threads = 1024   !< the system may refuse more

  !> It must not be copied.
  type :: optimum_search_type
    type(synthesis_type), allocatable :: synthesis                      !< with its optima once they are found
    type(state_type) :: start                                           !< the closed position of the data file
    type(held_start_type), allocatable, private :: held                 !< holds designs whose motions follow from forces
    class(variable_model_type), pointer, private :: searched => null()  !< the designs; not owned
  contains
    procedure :: prepare
    procedure :: make
    procedure :: follow
  end type optimum_search_type

contains

  !> Fail where a model asks for nothing that can be searched for.
  pure subroutine check_request(model, err)
    type(model_type), intent(in) :: model                 !< the model with the values of the data file
    type(error_type), allocatable, intent(out) :: err     !< allocated if no search can be made

    if (size(model%request%objectives) == 0) then
      call raise(err, exit_usage, '--optimize meets the groups &objective as well as possible, and this file has none')
    else if (.not. any(model%parameters%has_range)) then
      call raise(err, exit_data, 'no parameter is varied: give ''low'' and ''high'' in at least one &parameter', &
                 model%request%objectives(1)%place)
    else if (.not. abs(model%request%time%end - model%request%time%start) > 0.0_wp) then
      call raise(err, exit_data, 'the run has no length, so that no motion can meet the objective; change &time', &
                 model%request%objectives(1)%place)
    end if
  end subroutine check_request

  !> Assemble the mechanism, and judge whether the search can be made.
  subroutine prepare(self, variable, model, interruption, err)
    class(optimum_search_type), intent(inout), target :: self       !< the search
    class(variable_model_type), intent(inout), target :: variable   !< the model as a function of its parameters; outlives the search
    type(model_type), intent(in) :: model                           !< the model with the values of the data file
    class(interruption_type), intent(in) :: interruption            !< is asked whether a run for quantities shall stop
    type(error_type), allocatable, intent(out) :: err               !< allocated if no search can be made
    class(model_type), allocatable :: present
    class(plan_type), allocatable :: plan

    if (allocated(self%synthesis)) deallocate (self%synthesis)
    allocate (self%synthesis)
    self%searched => variable
    allocate (present, source=model)
    allocate (plan)
    if (model%program == dynamics) then
      ! runs follow from forces; the search itself knows the mechanism at their start
      if (.not. allocated(self%held)) allocate (self%held)
      allocate (self%held%moving, source=variable)
      self%searched => self%held
      call hold_start(present, err)
    end if
    if (.not. allocated(err)) call assemble_model(present, plan, self%start, err)
    if (.not. allocated(err)) call new_synthesis(self%searched, present, plan, self%synthesis, err)
    if (.not. allocated(err)) call check_synthesis(variable, model, self%start, interruption, self%synthesis, err)
    if (allocated(err)) call explain(err)
  end subroutine prepare

  !> Make all starts that are missing, and keep the designs that hold. Fails where no design is found, where the user interrupts and
  !> where the starts cannot be kept; the starts so far then count.
  subroutine make(self, model, processes, threads, starts, err)
    class(optimum_search_type), intent(inout) :: self        !< the search, prepared
    type(model_type), intent(in) :: model                    !< its model
    type(processes_type), intent(in) :: processes            !< those that make the starts together; this one is the first of them
    integer, intent(in) :: threads                           !< how many make the starts where there is one process
    class(search_starts_type), intent(inout) :: starts       !< begun
    type(error_type), allocatable, intent(out) :: err        !< allocated if it failed

    call lead_search(processes, self%searched, self%synthesis, model%request%optimum%seed, min(threads, most_threads), starts)
    call starts%finish(self%synthesis)
    if (allocated(starts%stopped)) err = starts%stopped
    call self%synthesis%keep_verified()
    if (size(self%synthesis%optima) > 0 .or. allocated(err)) return
    call raise(err, exit_assembly, 'no start led to a design that can be assembled and that moves through the whole run'// &
               trim(merge(' within all limits', '                  ', size(model%request%limits) > 0))// &
               '; give more starts in &optimum, or other ranges of the parameters'// &
               trim(merge(' and limits', '           ', size(model%request%limits) > 0)))
  end subroutine make

  !> Make the starts that the first process hands out.
  subroutine follow(self, model)
    class(optimum_search_type), intent(in) :: self           !< the search, prepared
    type(model_type), intent(in) :: model                    !< its model

    call follow_search(self%searched, self%synthesis, model%request%optimum%seed)
  end subroutine follow
end module mech9_search
