!> A run of a model: its motion, the rows of its outputs, its quantities, and the derivatives of both by the parameters.
module mech9_run
  use mech9_kinds, only: wp
  use mech9_error, only: error_type
  use mech9_model, only: model_type
  use mech9_variable_model, only: variable_model_type
  use mech9_simulation, only: interruption_type
  use mech9_model_motion, only: model_motion_type
  use mech9_driven_motion, only: set_inputs
  use mech9_film, only: film_type, new_film
  use mech9_masks, only: numbers_of
  use mech9_applied_forces, only: new_applied_forces
  use mech9_touching_forces, only: new_touching_forces
  use mech9_row_source, only: row_source_type, new_row_source
  implicit none
  private
  public :: run_type

  !> It must not be copied once it is prepared.
  type :: run_type
    type(model_motion_type) :: motion               !< assembled before the run is prepared
    type(row_source_type), allocatable :: source    !< computes the rows
  contains
    procedure :: prepare
    procedure :: record_film
    procedure :: keep_arrows
    procedure :: make
    procedure :: check
    procedure :: close => close_run
  end type run_type

contains

  !> Make the simulation of an assembled motion, and find the columns of its rows and of its quantities. Fails with exit_data where
  !> a quantity is not recorded, and where a derivative does not exist.
  subroutine prepare(self, model, err, variable, pictures)
    class(run_type), intent(inout), target :: self                            !< the run
    type(model_type), intent(in), target :: model                             !< its model; it must outlive the run
    type(error_type), allocatable, intent(out) :: err                         !< allocated if it failed
    class(variable_model_type), intent(inout), optional, target :: variable   !< the model as a function of its parameters, where
                                                                              !< derivatives are requested; it must outlive the run
    logical, intent(in), optional :: pictures                                 !< the motion of all links is requested
    class(row_source_type), allocatable :: former
    logical :: all_links

    all_links = model%request%output%with_derivatives() .and. .not. model%is_driven()
    if (present(pictures)) all_links = all_links .or. pictures
    call self%motion%prepare(model, err, all_links)
    if (allocated(err)) return
    if (allocated(self%source)) call move_alloc(self%source, former)
    allocate (self%source)
    call new_row_source(self%motion%simulation, self%source)
    if (model%request%output%with_derivatives()) call self%source%add_sensitivities(variable, err)
    if (.not. allocated(err)) call self%source%begin_quantities(err)
  end subroutine prepare

  !> Let a film take the position of each row, and the forces where they are drawn.
  subroutine record_film(self, model)
    class(run_type), intent(inout) :: self    !< the run, prepared for pictures
    type(model_type), intent(in) :: model     !< its model
    type(film_type), allocatable :: film

    film = new_film(model%mechanism, model%problem%partition%independent(), model%request%time%intervals + 1, self%source%columns)
    call self%keep_arrows(model, film)
    call move_alloc(film, self%source%film)
  end subroutine record_film

  !> Let a new film keep what its arrows show: forces, and velocities and accelerations of points.
  subroutine keep_arrows(self, model, film)
    class(run_type), intent(inout) :: self    !< the run, prepared; its rows can then show the film their forces
    type(model_type), intent(in) :: model     !< its model, or the same one with other points
    type(film_type), intent(inout) :: film    !< the film

    associate (output => model%request%output)
      call film%keep_point_motion(output%velocity_arrows, output%acceleration_arrows)
      if (.not. output%force_arrows) return
      call new_applied_forces(model%mechanism, self%source%applied)
      call new_touching_forces(model%mechanism, self%source%touching)
      call film%keep_forces(numbers_of(output%drawn_forces(size(model%mechanism%pairs)) .and. &
                                       model%mechanism%structure%stands_alone()), self%source%applied%items, &
                            self%source%touching%items)
    end associate
  end subroutine keep_arrows

  !> Go through all outputs, without any files, and finish the quantities.
  subroutine make(self, err, rows, interruption)
    class(run_type), intent(inout) :: self                !< the run, prepared
    type(error_type), allocatable, intent(out) :: err     !< allocated if it failed
    real(wp), allocatable, intent(inout), optional :: rows(:, :)   !< (columns,outputs) gets the columns of all outputs that are
                                                          !< reached, where it is allocated
    class(interruption_type), intent(inout), optional, target :: interruption   !< is asked whether the run shall stop

    if (present(interruption)) self%source%interruption => interruption
    call self%source%go_through(err, rows)
    self%source%interruption => null()
    if (.not. (allocated(err) .or. self%source%quantities%is_empty())) call self%source%quantities%finish()
  end subroutine make

  !> Fail where a run would fail: the motion cannot begin at the start, or drives have no values at the end of the time.
  subroutine check(self, model, err, variable)
    class(run_type), intent(inout), target :: self                            !< the run, with its motion assembled; its first row is computed
    type(model_type), intent(in), target :: model                             !< its model
    type(error_type), allocatable, intent(out) :: err                         !< allocated if it failed
    class(variable_model_type), intent(inout), optional, target :: variable   !< the model as a function of its parameters, where
                                                                              !< derivatives are requested
    real(wp), dimension(size(model%mechanism%pairs)) :: q, dq, ddq
    real(wp), allocatable :: row(:)

    call self%prepare(model, err, variable)
    if (.not. allocated(err)) call self%source%begin_section(err)
    if (allocated(err)) return
    allocate (row(self%source%columns%width()))
    call self%source%row_at(model%request%time%start, row, err)
    if (.not. allocated(err)) call set_inputs(model%problem%drives, model%request%time%end, q, dq, ddq, err)
  end subroutine check

  !> End the motion, if there is one. Rows and quantities stay.
  subroutine close_run(self)
    class(run_type), intent(inout) :: self   !< the run

    call self%motion%close()
  end subroutine close_run
end module mech9_run
