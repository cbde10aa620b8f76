!> The derivatives of forces, motors, energies, turning motions and poses of links by the parameters that a run records, from the
!> present state of its simulation.
module mech9_varied_record
  use, intrinsic :: ieee_arithmetic, only: ieee_value, ieee_quiet_nan
  use mech9_kinds, only: wp
  use mech9_error, only: error_type
  use mech9_rotation, only: cross, turn_back
  use mech9_model, only: model_type
  use mech9_frame_motion, only: link_motion
  use mech9_variable_model, only: variable_model_type
  use mech9_simulation, only: simulation_type
  use mech9_varied_motion, only: varied_motion_type, link_twists
  use mech9_varied_poses, only: find_varied_poses
  use mech9_varied_forces, only: varied_forces_type, new_varied_forces, find_varied_forces
  use mech9_motor, only: motor_change_type
  use mech9_varied_motors, only: find_varied_motors
  use mech9_varied_energy, only: varied_energy_type, new_varied_energy, find_varied_energy
  use mech9_varied_reactions, only: varied_reactions_type, new_varied_reactions, find_varied_reactions
  use mech9_columns, only: columns_type
  use mech9_force_record, only: force_record_type, moving_link
  use mech9_link_record, only: link_record_type
  implicit none
  private
  public :: varied_record_type

  type :: varied_record_type
    logical :: wanted = .false.                       !< some of these derivatives are recorded, or quantities need them
    real(wp), allocatable :: values(:, :)             !< (P,columns) derivatives of the columns beyond the motion
    real(wp), allocatable :: poses(:, :)              !< (P,12 links) of origins and rotations; of no size where they are not recorded
    logical, private :: with_forces = .false.         !< those of forces are wanted
    logical, private :: with_reactions = .false.      !< those of pairs and couplings, too
    logical, private :: with_motors = .false.         !< those of motors are wanted
    logical, private :: with_energies = .false.       !< those of energies are wanted
    logical, private :: with_links = .false.          !< those of the turning motions of links are wanted
    class(varied_forces_type), allocatable, private :: forces        !< of the present state
    class(varied_reactions_type), allocatable, private :: reactions  !< of the present state
    type(varied_energy_type), private :: energy       !< of the present state
    integer, private :: plans = -1                    !< plans of the simulation before the one for which room was made; -1: none was
  contains
    procedure :: begin
    procedure :: find
  end type varied_record_type

contains

  !> Prepare the derivatives, if any are wanted. Fails where they do not exist.
  subroutine begin(self, simulation, variable, columns, err)
    class(varied_record_type), intent(out) :: self                  !< the record
    class(simulation_type), intent(inout) :: simulation             !< the motion, after begin_sensitivity
    class(variable_model_type), intent(inout), target :: variable   !< the model as a function of its parameters; outlives the run
    type(columns_type), intent(in) :: columns                       !< with those of derivatives
    type(error_type), allocatable, intent(out) :: err               !< allocated if it failed

    allocate (self%forces, self%reactions)
    associate (first => columns%motion + 1, motors => columns%motion + columns%forces() + 1, last => columns%varied + 1)
      self%with_forces = motors > first
      self%with_motors = columns%motors > 0
      self%with_energies = columns%energies > 0
      self%with_links = columns%links > 0
      if (columns%sensitivities == 0) then
        self%with_motors = is_asked_for(motors, motors + columns%motors - 1)
        self%with_energies = is_asked_for(motors + columns%motors, last - columns%links - columns%magnitudes)
        self%with_links = is_asked_for(last - columns%links + 1, last)
        self%with_forces = is_asked_for(first, motors - 1) .or. &
                           is_asked_for(last - columns%links - columns%magnitudes + 1, last - columns%links)
      end if
      if (self%with_forces) self%with_reactions = size(columns%reacting) > 0
      self%wanted = self%with_forces .or. self%with_motors .or. self%with_energies .or. self%with_links .or. &
                    columns%varied_poses > 0
      if (.not. self%wanted) return
      allocate (self%values(size(columns%parameters), last - columns%motion), source=0.0_wp)
      allocate (self%poses(size(columns%parameters), columns%varied_poses/size(columns%parameters)), source=0.0_wp)
    end associate
    call simulation%begin_varied_motion(variable, err)
  contains

    !> Whether a quantity is of one of some columns.
    pure logical function is_asked_for(from, to) result(asked)
      integer, intent(in) :: from   !< the first one
      integer, intent(in) :: to     !< the last one
      integer :: i, j

      asked = .false.
      if (.not. allocated(simulation%model%request%quantities)) return
      do j = 1, size(simulation%model%request%quantities)
        do i = from, to
          asked = asked .or. columns%names(i)%text == simulation%model%request%quantities(j)%column
        end do
      end do
    end function is_asked_for
  end subroutine begin

  !> The derivatives in the present state of a simulation, after its show_sensitivity. Fails where they do not exist.
  subroutine find(self, simulation, columns, forces, links, err)
    class(varied_record_type), intent(inout) :: self              !< the record; gets the derivatives
    class(simulation_type), intent(inout), target :: simulation   !< the motion
    type(columns_type), intent(in) :: columns                     !< of the run
    type(force_record_type), intent(in) :: forces                 !< with the forces of this state, if they are recorded
    type(link_record_type), intent(in) :: links                   !< with the turning motions of this state
    type(error_type), allocatable, intent(out) :: err             !< allocated if it failed
    type(varied_motion_type), pointer :: motion
    integer :: at

    call simulation%show_varied_motion(motion, err)
    if (allocated(err)) return
    if (self%plans /= simulation%plans()) call make_room(self, simulation, motion, err)
    if (allocated(err)) return
    if (self%with_forces) then
      call find_varied_forces(simulation%model, motion, self%forces, err)
      if (self%with_reactions .and. .not. allocated(err)) &
        call find_varied_reactions(simulation%model, motion, self%forces%links, self%reactions, err)
      if (allocated(err)) return
      call put_forces(self, columns)
      if (self%with_reactions .and. (columns%in_links .or. columns%magnitudes > 0)) &
        call put_shown_wrenches(self, simulation%model, motion, columns, forces)
    end if
    if (size(self%poses) > 0) call find_varied_poses(motion, self%poses)
    if (self%with_motors) call put_motors(self, simulation, motion, columns, err)
    if (allocated(err)) return
    if (self%with_links) call links%find_changes(motion, self%values(:, size(self%values, 2) - columns%links + 1:))
    if (.not. self%with_energies) return
    call find_varied_energy(simulation%model, motion, self%energy)
    at = columns%forces() + columns%motors
    self%values(:, at + 1) = self%energy%kinetic
    self%values(:, at + 2) = self%energy%potential
    self%values(:, at + 3) = self%energy%kinetic + self%energy%potential
  end subroutine find

  !> Make room in the present coordinates of a simulation.
  subroutine make_room(self, simulation, motion, err)
    type(varied_record_type), intent(inout) :: self          !< the record
    class(simulation_type), intent(in) :: simulation         !< the motion
    type(varied_motion_type), intent(in) :: motion           !< its derivatives
    type(error_type), allocatable, intent(out) :: err        !< allocated where derivatives are not known

    if (self%with_energies) call new_varied_energy(simulation%model, motion, self%energy)
    if (self%with_forces) call new_varied_forces(simulation%model, motion, self%forces, self%with_reactions)
    if (self%with_reactions) call new_varied_reactions(simulation%model, motion, self%reactions, err)
    self%plans = simulation%plans()
  end subroutine make_room

  !> Put the derivatives of the motors' states and forces in the order of their columns.
  subroutine put_motors(self, simulation, motion, columns, err)
    type(varied_record_type), intent(inout) :: self          !< the record; gets the derivatives
    class(simulation_type), intent(in) :: simulation         !< the motion
    type(varied_motion_type), intent(in) :: motion           !< its derivatives
    type(columns_type), intent(in) :: columns                !< of the run
    type(error_type), allocatable, intent(out) :: err        !< allocated if the law of a motor has no value
    type(motor_change_type) :: changes(size(self%values, 1), columns%motors/2)
    integer :: at, i

    call find_varied_motors(simulation%model, motion, changes, err)
    do i = 1, size(changes, 2)
      at = columns%forces() + 2*i
      self%values(:, at - 1) = changes(:, i)%value
      self%values(:, at) = changes(:, i)%force
    end do
  end subroutine put_motors

  !> Put the derivatives of forces in the order of their columns.
  subroutine put_forces(self, columns)
    type(varied_record_type), intent(inout) :: self          !< the record, with the derivatives
    type(columns_type), intent(in) :: columns                !< of the run
    integer :: at, i, k

    at = size(columns%drives)
    self%values(:, :at) = self%forces%changes(:, columns%drives)
    do i = 1, size(columns%reacting)
      k = columns%reacting(i)
      self%values(:, at + 1:at + 3) = self%reactions%force(:, :, k)
      self%values(:, at + 4:at + 6) = self%reactions%moment(:, :, k)
      at = at + 6
    end do
    if (columns%couplings > 0) self%values(:, at + 1:at + columns%couplings) = self%forces%links%coupling
  end subroutine put_forces

  !> Put the derivatives of magnitudes, and of wrenches along the axes of the moving links, in the order of their columns. A wrench that
  !> turns with its link by w changes there by its own change less w x the wrench.
  subroutine put_shown_wrenches(self, model, motion, columns, forces)
    type(varied_record_type), intent(inout) :: self          !< the record, with the derivatives along the axes of link 1
    type(model_type), intent(in) :: model                    !< the model
    type(varied_motion_type), intent(in) :: motion           !< derivatives of the motion
    type(columns_type), intent(in) :: columns                !< of the run
    type(force_record_type), intent(in) :: forces            !< with the forces themselves
    real(wp) :: twists(motion%n_parameters, 6, 0:2), r(3, 3), place(3), omega(3), v(3), change(3)
    integer :: i, j, p, at, magnitude

    at = size(columns%drives)
    magnitude = columns%forces() + columns%motors + columns%energies
    do i = 1, size(columns%reacting)
      associate (k => columns%reacting(i), wrench => [forces%reactions%force(:, columns%reacting(i)), &
                                                      forces%reactions%moment(:, columns%reacting(i))])
        call link_twists(motion, moving_link(model%mechanism, k), twists)
        call link_motion(motion%plan, motion%state, moving_link(model%mechanism, k), r, place, omega, v)
        do j = 0, 1
          do p = 1, motion%n_parameters
            change = self%values(p, at + 3*j + 1:at + 3*j + 3)
            if (columns%magnitudes > 0) &
              self%values(p, magnitude + 2*i - 1 + j) = change_of_norm(wrench(3*j + 1:3*j + 3), change)
            if (columns%in_links) self%values(p, at + 3*j + 1:at + 3*j + 3) = &
              turn_back(r, change - cross(twists(p, 1:3, 0), wrench(3*j + 1:3*j + 3)))
          end do
        end do
      end associate
      at = at + 6
    end do
  end subroutine put_shown_wrenches

  !> The derivative of the length of a vector; not a number where a vector of no length grows.
  pure real(wp) function change_of_norm(vector, change)
    real(wp), intent(in) :: vector(3)   !< the vector
    real(wp), intent(in) :: change(3)   !< its derivative

    change_of_norm = 0.0_wp
    if (norm2(vector) > 0.0_wp) then
      change_of_norm = dot_product(vector, change)/norm2(vector)
    else if (norm2(change) > 0.0_wp) then
      change_of_norm = ieee_value(1.0_wp, ieee_quiet_nan)
    end if
  end function change_of_norm
end module mech9_varied_record
