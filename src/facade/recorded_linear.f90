!> The linearised equations of motion as the library's users find them: matrices, and the names of their rows and columns.
module mech9_recorded_linear
  use mech9_program_kind, only: dynamics
  use mech9_kinds, only: wp
  use mech9_error, only: error_type
  use mech9_text, only: string_type, texts_of_one_length, to_text
  use mech9_model, only: model_type
  use mech9_columns, only: columns_type
  use mech9_result_units, only: unit_of, unit_name, rate_unit_of, rate_unit_name
  use mech9_simulation, only: interruption_type
  use mech9_explanation, only: explain
  use mech9_rest, only: rest_type
  use mech9_linear_motion, only: linear_motion_type, find_linear_motion
  use mech9_linear_names, only: name_linear_system, linear_columns
  use mech9_state_space, only: state_space_type, find_state_space
  use mech9_data_file, only: data_file_type
  use mech9_checked_mechanism, only: checked_mechanism_type
  implicit none
  private
  public :: linear_system_type, find_linear_system, linear_along_type, find_linear_along, recorded_linear_motion_type

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

  !> The same along a motion: deviations x from it go on by Inertia x'' + damping x' + stiffness x = u and x' = A x + B u, with matrices
  !> at each of its times. Rows have the time, then coordinates, rates and accelerations of the motion in the units of their columns.
  type :: linear_along_type
    type(linear_system_type), allocatable :: systems(:)   !< (times) `q` are the coordinates at the time
    character(len=:), allocatable :: columns(:)           !< names of the columns: t, q1 ..., dq1 ..., ddq1 ...
    character(len=:), allocatable :: column_units(:)
    real(wp), allocatable :: rows(:, :)                   !< (columns,times)
  end type linear_along_type

  !> The linearised equations of motion along the motion of a data file.
  type, extends(linear_motion_type) :: recorded_linear_motion_type
  contains
    procedure :: find
  end type recorded_linear_motion_type

contains

  !> Linearise the equations of motion along the motion of a data file. Fails as find_linear_along does; the error is not explained.
  subroutine find(self, given, times, err, interruption)
    class(recorded_linear_motion_type), intent(inout) :: self        !< new ones
    class(data_file_type), intent(in) :: given                       !< the data file
    real(wp), intent(in) :: times(:)                                 !< in the order of the motion [s]; none: all outputs of &time
    type(error_type), allocatable, intent(out) :: err                !< allocated if it failed
    class(interruption_type), intent(in), optional :: interruption   !< is asked whether the motion shall stop

    call find_linear_motion(given%model, times, self%linear_motion_type, err, interruption)
  end subroutine find

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
      call name_system(states, inputs, outputs, system)
    end if
    call mechanism%point_at(err)
  end subroutine find_linear_system

  !> Give a system the names and units of its states, inputs and outputs.
  subroutine name_system(states, inputs, outputs, system)
    type(columns_type), intent(in) :: states             !< as columns
    type(columns_type), intent(in) :: inputs             !< as columns
    type(columns_type), intent(in) :: outputs            !< as columns, the time first
    type(linear_system_type), intent(inout) :: system    !< gets them

    call texts_of_one_length(states%names(:states%count), system%states)
    call texts_of_one_length(states%units(:states%count), system%state_units)
    call texts_of_one_length(inputs%names(:inputs%count), system%inputs)
    call texts_of_one_length(inputs%units(:inputs%count), system%input_units)
    call texts_of_one_length(outputs%names(2:outputs%motion), system%outputs)
    call texts_of_one_length(outputs%units(2:outputs%motion), system%output_units)
  end subroutine name_system

  !> Linearise the equations of motion along the motion under forces. Fails with exit_data where nothing is free to move or pairs have
  !> friction, with exit_usage where times are not in order within the motion, with exit_singular where a stop or a contact holds, and as a
  !> run does.
  subroutine find_linear_along(mechanism, times, along, err, interruption)
    type(checked_mechanism_type), intent(in) :: mechanism            !< with free coordinates, bodies and loads
    real(wp), intent(in) :: times(:)                                 !< in the order of the motion [s]; none: all outputs of &time
    type(linear_along_type), intent(out) :: along                    !< of use only where nothing failed
    type(error_type), allocatable, intent(out) :: err                !< allocated if it failed
    class(interruption_type), intent(in), optional :: interruption   !< is asked whether the motion shall stop
    type(model_type) :: model
    type(linear_motion_type) :: found
    integer :: i

    call mechanism%take_request(dynamics, model, err)
    if (.not. allocated(err)) call find_linear_motion(model, times, found, err, interruption)
    if (.not. allocated(err)) then
      allocate (along%systems(size(found%times)))
      do i = 1, size(found%times)
        associate (here => found%times(i), system => along%systems(i))
          system%free = found%free
          system%q = here%q
          system%inertia = here%inertia
          system%damping = here%damping
          system%stiffness = here%stiffness
          system%space = here%space
          call name_system(found%states, found%inputs, found%outputs, system)
        end associate
      end do
      call list_motion(model, found, along)
    end if
    if (allocated(err)) call explain(err)
    call mechanism%point_at(err)
  end subroutine find_linear_along

  !> List the motion at the times as rows.
  subroutine list_motion(model, found, along)
    type(model_type), intent(in) :: model                 !< the model
    type(linear_motion_type), intent(in) :: found         !< with the motion
    type(linear_along_type), intent(inout) :: along       !< gets the rows with their names
    type(string_type), allocatable :: names(:), units(:)
    integer :: i, k, m

    m = size(model%mechanism%pairs)
    allocate (names(3*m + 1), units(3*m + 1), along%rows(3*m + 1, size(found%times)))
    names(1)%text = 't'
    units(1)%text = 's'
    along%rows(1, :) = found%times%t
    do k = 1, m
      names(1 + k)%text = 'q'//to_text(k)
      names(1 + m + k)%text = 'dq'//to_text(k)
      names(1 + 2*m + k)%text = 'ddq'//to_text(k)
      units(1 + k)%text = trim(unit_name(model%mechanism, k))
      units(1 + m + k)%text = trim(rate_unit_name(model%mechanism, k))
      units(1 + 2*m + k)%text = trim(unit_name(model%mechanism, k))//'/s^2'
      do i = 1, size(found%times)
        along%rows(1 + k, i) = found%times(i)%q(k)/unit_of(model%mechanism, k)
        along%rows(1 + m + k, i) = found%times(i)%dq(k)/rate_unit_of(model%mechanism, k)
        along%rows(1 + 2*m + k, i) = found%times(i)%ddq(k)/unit_of(model%mechanism, k)
      end do
    end do
    call texts_of_one_length(names, along%columns)
    call texts_of_one_length(units, along%column_units)
  end subroutine list_motion
end module mech9_recorded_linear
