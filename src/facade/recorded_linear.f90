!> The linearised equations of motion as the library's users find them: matrices, and the names of their rows and columns.
module mech9_recorded_linear
  use mech9_program_kind, only: dynamics
  use mech9_kinds, only: wp
  use mech9_error, only: error_type
  use mech9_text, only: texts_of_one_length
  use mech9_model, only: model_type
  use mech9_columns, only: columns_type
  use mech9_rest, only: rest_type
  use mech9_linear_names, only: name_linear_system, linear_columns
  use mech9_state_space, only: state_space_type, find_state_space
  use mech9_checked_mechanism, only: checked_mechanism_type
  implicit none
  private
  public :: linear_system_type, find_linear_system

  !> Inertia x'' + damping x' + stiffness x = u in SI units, over the n free coordinates, and x' = A x + B u, y = C x + D u, where x
  !> has the coordinates, their rates and the states of motors.
  type :: linear_system_type
    integer, allocatable :: free(:)                    !< (n) numbers of the free coordinates
    real(wp), allocatable :: q(:)                      !< (M) coordinates in equilibrium [rad, m]
    real(wp), allocatable :: inertia(:, :)             !< (n,n) M
    real(wp), allocatable :: damping(:, :)             !< (n,n) C
    real(wp), allocatable :: stiffness(:, :)           !< (n,n) K
    type(state_space_type) :: space                    !< A, B, C, D
    character(len=:), allocatable :: states(:)         !< names of x
    character(len=:), allocatable :: state_units(:)
    character(len=:), allocatable :: inputs(:)         !< names of u
    character(len=:), allocatable :: input_units(:)
    character(len=:), allocatable :: outputs(:)        !< names of y: the columns that &output requests
    character(len=:), allocatable :: output_units(:)
  end type linear_system_type

contains

  !> Linearise the equations of motion about the equilibrium to which the start leads. Fails with exit_data where nothing can come
  !> to rest, with exit_assembly where there is no equilibrium.
  subroutine find_linear_system(mechanism, system, err)
    type(checked_mechanism_type), intent(in) :: mechanism      !< with free coordinates, bodies and loads
    type(linear_system_type), intent(out) :: system            !< of use only where nothing failed
    type(error_type), allocatable, intent(out) :: err          !< allocated if it failed
    type(model_type) :: model
    type(rest_type) :: rest
    type(columns_type) :: outputs, states, inputs

    call mechanism%take_request(dynamics, model, err)
    if (.not. allocated(err)) call rest%assemble(model, err)
    if (.not. allocated(err)) call rest%find(model, 0, .true., err)
    if (.not. allocated(err)) then
      outputs = linear_columns(model%mechanism, model%request%output)
      associate (equilibrium => rest%equilibria(1))
        system%free = equilibrium%resting%free
        system%q = equilibrium%resting%state%q
        system%inertia = equilibrium%inertia
        system%damping = equilibrium%damping
        system%stiffness = equilibrium%stiffness
        call find_state_space(model%mechanism, outputs%coordinates, outputs%derivatives, equilibrium, system%space)
        call name_linear_system(model%mechanism, equilibrium, states, inputs)
      end associate
      call texts_of_one_length(states%names(:states%count), system%states)
      call texts_of_one_length(states%units(:states%count), system%state_units)
      call texts_of_one_length(inputs%names(:inputs%count), system%inputs)
      call texts_of_one_length(inputs%units(:inputs%count), system%input_units)
      call texts_of_one_length(outputs%names(2:outputs%motion), system%outputs)
      call texts_of_one_length(outputs%units(2:outputs%motion), system%output_units)
    end if
    call mechanism%point_at(err)
  end subroutine find_linear_system
end module mech9_recorded_linear
