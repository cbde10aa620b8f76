!> The motion of a design: its places at any times, and a film of it.
module mech9_design_motion
  use mech9_kinds, only: wp
  use mech9_error, only: error_type
  use mech9_model, only: model_type
  use mech9_variable_model, only: variable_model_type
  use mech9_plan, only: plan_type
  use mech9_state, only: state_type
  use mech9_frame_motion, only: point_motion
  use mech9_run, only: run_type
  use mech9_simulation, only: interruption_type
  use mech9_text, only: to_text
  use mech9_point, only: point_type
  use mech9_objective, only: function_objective
  use mech9_synthesis, only: synthesis_type
  use mech9_film, only: film_type, new_film
  implicit none
  private
  public :: design_motion_type, new_design_motion

  type :: design_motion_type
    class(model_type), allocatable :: model   !< with the values of the design, from the positions of its assembly
    class(model_type), allocatable :: shown   !< the same with targets of the search as points of link 1, for drawings
    class(run_type), allocatable :: run       !< with its motion assembled
    type(film_type) :: film                   !< of the run, once it is made
  contains
    procedure :: visit
    procedure :: show_targets
    procedure :: make_film
  end type design_motion_type

contains

  !> Assemble a design in its assembly.
  subroutine new_design_motion(variable, model, values, q, motion, err)
    class(variable_model_type), intent(inout) :: variable     !< the model as a function of its parameters
    type(model_type), intent(in) :: model                     !< with the values of the data file, and its objectives
    real(wp), intent(in) :: values(:)                         !< of all parameters
    real(wp), intent(in) :: q(:)                              !< (M) coordinates at the start of the run [rad, m]
    class(design_motion_type), intent(inout) :: motion        !< a new one; then about to begin
    type(error_type), allocatable, intent(out) :: err         !< allocated if it failed

    allocate (motion%model, motion%run)
    call variable%at(values, motion%model, err)
    if (allocated(err)) return
    motion%model%request = model%request
    ! of the rows a film takes the columns of the motion only
    motion%model%request%output%sensitivities = .false.
    motion%model%request%output%gradients = .false.
    if (allocated(motion%model%request%quantities)) deallocate (motion%model%request%quantities)
    motion%model%problem%initial%position = q
    motion%model%problem%initial%position_given = .true.
    call motion%run%motion%assemble(motion%model, err)
  end subroutine new_design_motion

  !> Compute the places of a point of a link, the direction of the x axis of the link, and the coordinates. The times
  !> stand in their order from the start of the run on.
  subroutine visit(self, times, link, point, places, directions, q, err)
    class(design_motion_type), intent(inout), target :: self  !< the motion
    real(wp), intent(in) :: times(:)                          !< (n) times [s]
    integer, intent(in) :: link                               !< number of the link
    real(wp), intent(in) :: point(3)                          !< the point, in the system of the link [m]
    real(wp), intent(out) :: places(:, :)                     !< (3,n) places of the point [m]
    real(wp), intent(out) :: directions(:, :)                 !< (3,n) directions of the x axis of the link
    real(wp), intent(out) :: q(:, :)                          !< (M,n) coordinates [rad, m]
    type(error_type), allocatable, intent(out) :: err         !< allocated if it failed
    type(plan_type), pointer :: plan
    type(state_type), pointer :: state
    real(wp) :: place(3), rate(3), rate2(3)
    real(wp), parameter :: along_x(3) = [1.0_wp, 0.0_wp, 0.0_wp]
    integer :: i

    call self%run%motion%prepare(self%model, err, pictures=.true.)
    if (.not. allocated(err)) call self%run%motion%simulation%start(err)
    do i = 1, size(times)
      if (.not. allocated(err)) call self%run%motion%simulation%advance(times(i), err)
      if (allocated(err)) return
      call self%run%motion%simulation%present(plan, state)
      call point_motion(plan, state, link, point, places(:, i), rate, rate2)
      call point_motion(plan, state, link, point + along_x, place, rate, rate2)
      directions(:, i) = place - places(:, i)
      q(:, i) = state%q
    end do
  end subroutine visit

  !> Add the places of targets to the model of drawings as points of link 1, named by their numbers within their objective.
  subroutine show_targets(self, synthesis, most)
    class(design_motion_type), intent(inout) :: self          !< the motion; it gets the model of drawings
    type(synthesis_type), intent(in) :: synthesis             !< with the targets
    integer, intent(in) :: most                               !< of more targets the first ones are shown
    type(point_type) :: point
    integer :: i

    if (allocated(self%shown)) deallocate (self%shown)
    allocate (self%shown, source=self%model)
    do i = 1, min(most, size(synthesis%targets))
      associate (target => synthesis%targets(i))
        if (self%model%request%objectives(target%objective)%kind == function_objective) cycle
        point%name = to_text(synthesis%number_in_objective(i))
        point%link = 1
        point%position = target%place
        self%shown%mechanism%points = [self%shown%mechanism%points, point]
      end associate
    end do
  end subroutine show_targets

  !> Make a film of the run, for drawings of the model with targets.
  subroutine make_film(self, interruption, err)
    class(design_motion_type), intent(inout), target :: self  !< the motion, with targets
    class(interruption_type), intent(inout), target :: interruption   !< is asked whether the run shall stop
    type(error_type), allocatable, intent(out) :: err         !< allocated if it failed
    type(plan_type), pointer :: plan
    type(state_type), pointer :: state
    real(wp), allocatable :: row(:)
    logical :: kept
    integer :: i

    call self%run%prepare(self%model, err, pictures=.true.)
    if (allocated(err)) return
    self%run%source%interruption => interruption
    allocate (row(self%run%source%columns%width()), source=0.0_wp)
    self%film = new_film(self%shown%mechanism, self%shown%problem%partition%independent(), self%shown%request%time%intervals + 1, &
                    self%run%source%columns)
    call self%run%keep_arrows(self%shown, self%film)
    do i = 0, self%shown%request%time%intervals
      call self%run%source%row_at(self%shown%request%time%time(i), row, err)
      if (allocated(err)) exit
      call self%run%motion%simulation%present(plan, state)
      kept = self%film%keeps_next()
      call self%film%take(self%shown%mechanism, plan, state, row)
      if (kept) call self%run%source%show_forces(self%film, err)
      if (allocated(err)) exit
    end do
    self%run%source%interruption => null()
  end subroutine make_film
end module mech9_design_motion
