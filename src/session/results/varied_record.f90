!> The derivatives of energies by the parameters that a run records, from the present state of its simulation.
module mech9_varied_record
  use mech9_kinds, only: wp
  use mech9_error, only: error_type
  use mech9_variable_model, only: variable_model_type
  use mech9_simulation, only: simulation_type
  use mech9_varied_motion, only: varied_motion_type
  use mech9_varied_energy, only: varied_energy_type, new_varied_energy, find_varied_energy
  use mech9_columns, only: columns_type
  implicit none
  private
  public :: varied_record_type

  type :: varied_record_type
    logical :: wanted = .false.                    !< some of these derivatives are recorded, or quantities need them
    real(wp), allocatable :: values(:, :)          !< (P,columns) derivatives of the columns beyond the motion
    type(varied_energy_type), private :: energy    !< of the present state
    integer, private :: events = -1                !< changes of coordinates of the simulation until room was made; -1: none was
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
    integer :: i

    if (columns%sensitivities > 0) self%wanted = columns%varied > columns%motion - 1
    if (allocated(simulation%model%request%quantities)) then
      do i = 1, size(simulation%model%request%quantities)
        self%wanted = self%wanted .or. is_beyond_motion(simulation%model%request%quantities(i)%column, columns)
      end do
    end if
    if (.not. self%wanted) return
    allocate (self%values(size(columns%parameters), columns%varied + 1 - columns%motion), source=0.0_wp)
    call simulation%begin_varied_motion(variable, err)
  end subroutine begin

  !> Whether a column with derivatives stands after those of the motion.
  pure logical function is_beyond_motion(name, columns) result(is_beyond)
    character(len=*), intent(in) :: name         !< heading of the column
    type(columns_type), intent(in) :: columns    !< the columns
    integer :: i

    is_beyond = .false.
    do i = columns%motion + 1, columns%varied + 1
      is_beyond = is_beyond .or. columns%names(i)%text == name
    end do
  end function is_beyond_motion

  !> The derivatives in the present state of a simulation, after its show_sensitivity.
  subroutine find(self, simulation, err)
    class(varied_record_type), intent(inout) :: self              !< the record; gets the derivatives
    class(simulation_type), intent(inout), target :: simulation   !< the motion
    type(error_type), allocatable, intent(out) :: err             !< allocated if it failed
    type(varied_motion_type), pointer :: motion
    integer :: n

    call simulation%show_varied_motion(motion, err)
    if (allocated(err)) return
    if (self%events /= size(simulation%events)) then
      call new_varied_energy(simulation%model, motion, self%energy)
      self%events = size(simulation%events)
    end if
    call find_varied_energy(simulation%model, motion, self%energy)
    n = size(self%values, 2)
    self%values(:, n - 2) = self%energy%kinetic
    self%values(:, n - 1) = self%energy%potential
    self%values(:, n) = self%energy%kinetic + self%energy%potential
  end subroutine find
end module mech9_varied_record
