!> The HDF5 file of --linear: the linearised equations of motion in both forms, at rest or along a motion.
module mech9_linear_layout
  use mech9_kinds, only: wp
  use mech9_text, only: string_type
  use mech9_model, only: model_type
  use mech9_columns, only: columns_type
  use mech9_data_set_store, only: data_set_store_type
  use mech9_linearised_equilibrium, only: equilibrium_type
  use mech9_linear_motion, only: linear_motion_type
  use mech9_linear_names, only: name_linear_system, linear_columns
  use mech9_state_space, only: state_space_type, find_state_space
  implicit none
  private
  public :: put_linear_system, put_linear_motion

contains

  !> Put M, C, K and A, B, C, D into an open storage. A matrix has its rows along the first dimension.
  subroutine put_linear_system(store, model, equilibrium)
    class(data_set_store_type), intent(inout) :: store     !< the open storage
    type(model_type), intent(in) :: model                  !< the model
    type(equilibrium_type), intent(inout) :: equilibrium   !< linearised
    type(columns_type) :: columns
    type(state_space_type) :: space

    columns = linear_columns(model%mechanism, model%request%output)
    associate (free => equilibrium%resting%free)
      call store%put('free', free, 'number of each free coordinate')
      call store%make_scale('free')
      call store%put('equilibrium', equilibrium%resting%state%q, 'coordinates in equilibrium, rad and m')
      call put_square(store, 'second_order/M', equilibrium%inertia, 'inertia: M x'''' + C x'' + K x = u, in SI units')
      call put_square(store, 'second_order/C', equilibrium%damping, 'damping, with gyroscopic terms, in SI units')
      call put_square(store, 'second_order/K', equilibrium%stiffness, 'stiffness, in SI units')
      call find_state_space(model%mechanism, columns%coordinates, columns%derivatives, equilibrium, space)
      call put_names(store, model, equilibrium, columns)
    end associate
    call put_matrix(store, 'state_space/A', space%a, 'x'' = A x + B u')
    call store%attach_scales('state_space/A', ['/state_space/state', '/state_space/state'])
    call put_matrix(store, 'state_space/B', space%b, 'x'' = A x + B u')
    call store%attach_scales('state_space/B', ['/state_space/state', '/state_space/input'])
    call put_matrix(store, 'state_space/C', space%c, 'y = C x + D u')
    call store%attach_scales('state_space/C', ['/state_space/output', '/state_space/state '])
    call put_matrix(store, 'state_space/D', space%d, 'y = C x + D u')
    call store%attach_scales('state_space/D', ['/state_space/output', '/state_space/input '])
  end subroutine put_linear_system

  !> Put M, C, K and A, B, C, D along a motion into an open storage, with the time as first dimension, and the motion itself.
  subroutine put_linear_motion(store, model, found)
    class(data_set_store_type), intent(inout) :: store   !< the open storage
    type(model_type), intent(in) :: model              !< the model
    type(linear_motion_type), intent(in) :: found      !< the matrices
    character(len=*), parameter :: square(2) = '/free'
    integer :: i

    call store%put('time', found%times%t, 'time', 's')
    call store%make_scale('time')
    call store%put('free', found%free, 'number of each free coordinate')
    call store%make_scale('free')
    call put_motion('q', 0, 'coordinates of the motion, rad and m')
    call put_motion('dq', 1, 'their rates, in SI units')
    call put_motion('ddq', 2, 'their accelerations, in SI units')
    associate (times => found%times)
      call put_matrices('second_order/M', [(times(i)%inertia, i=1, size(times))], shape(times(1)%inertia), square, &
                        'inertia: M x'''' + C x'' + K x = u for deviations x from the motion, in SI units')
      call put_matrices('second_order/C', [(times(i)%damping, i=1, size(times))], shape(times(1)%damping), square, &
                        'damping, with gyroscopic terms, in SI units')
      call put_matrices('second_order/K', [(times(i)%stiffness, i=1, size(times))], shape(times(1)%stiffness), square, &
                        'stiffness, with terms of inertia, in SI units')
      call put_state_names(store, found%states, found%inputs, found%outputs)
      call put_matrices('state_space/A', [(times(i)%space%a, i=1, size(times))], shape(times(1)%space%a), &
                        ['/state_space/state', '/state_space/state'], 'x'' = A x + B u')
      call put_matrices('state_space/B', [(times(i)%space%b, i=1, size(times))], shape(times(1)%space%b), &
                        ['/state_space/state', '/state_space/input'], 'x'' = A x + B u')
      call put_matrices('state_space/C', [(times(i)%space%c, i=1, size(times))], shape(times(1)%space%c), &
                        ['/state_space/output', '/state_space/state '], 'y = C x + D u')
      call put_matrices('state_space/D', [(times(i)%space%d, i=1, size(times))], shape(times(1)%space%d), &
                        ['/state_space/output', '/state_space/input '], 'y = C x + D u')
    end associate
  contains
    !> Put the motion of all coordinates, (times,coordinates) in the file.
    subroutine put_motion(name, order, long_name)
      character(len=*), intent(in) :: name          !< of the data set
      integer, intent(in) :: order                  !< of the derivative in time
      character(len=*), intent(in) :: long_name     !< its meaning
      real(wp), allocatable :: values(:, :)
      integer :: k

      allocate (values(size(model%mechanism%pairs), size(found%times)))
      do k = 1, size(found%times)
        select case (order)
        case (0)
          values(:, k) = found%times(k)%q
        case (1)
          values(:, k) = found%times(k)%dq
        case default
          values(:, k) = found%times(k)%ddq
        end select
      end do
      call store%put(name, values, long_name)
      call store%attach_scales(name, ['/time      ', '/coordinate'])
    end subroutine put_motion

    !> Put matrices at all times, (times,rows,columns) in the file.
    subroutine put_matrices(name, numbers, extents, scales, long_name)
      character(len=*), intent(in) :: name          !< path of the data set
      real(wp), intent(in) :: numbers(:)            !< of all matrices, each column by column
      integer, intent(in) :: extents(2)             !< rows and columns
      character(len=*), intent(in) :: scales(2)     !< of rows and columns
      character(len=*), intent(in) :: long_name     !< its meaning
      real(wp), allocatable :: matrices(:, :, :), stored(:, :, :)
      character(len=max(len(scales), 5)) :: all_scales(3)
      integer :: k

      matrices = reshape(numbers, [extents, size(found%times)])
      allocate (stored(extents(2), extents(1), size(found%times)))
      do k = 1, size(found%times)
        stored(:, :, k) = transpose(matrices(:, :, k))
      end do
      call store%put(name, stored, long_name)
      all_scales(1) = '/time'
      all_scales(2:) = scales
      call store%attach_scales(name, all_scales)
    end subroutine put_matrices
  end subroutine put_linear_motion

  !> Put a matrix of the free coordinates.
  subroutine put_square(store, name, matrix, long_name)
    class(data_set_store_type), intent(inout) :: store   !< the open storage
    character(len=*), intent(in) :: name             !< path of the data set
    real(wp), intent(in) :: matrix(:, :)             !< (n,n)
    character(len=*), intent(in) :: long_name        !< its meaning

    call put_matrix(store, name, matrix, long_name)
    call store%attach_scales(name, ['/free', '/free'])
  end subroutine put_square

  !> Put a matrix with its rows along the first dimension of the data set.
  subroutine put_matrix(store, name, matrix, long_name)
    class(data_set_store_type), intent(inout) :: store   !< the open storage
    character(len=*), intent(in) :: name             !< path of the data set
    real(wp), intent(in) :: matrix(:, :)             !< (m,n)
    character(len=*), intent(in) :: long_name        !< its meaning
    real(wp) :: stored(size(matrix, 2), size(matrix, 1))

    ! gfortran 14 passes a transposed argument to a contiguous one in the order of the matrix itself
    stored = transpose(matrix)
    call store%put(name, stored, long_name)
  end subroutine put_matrix

  !> Put the names of states, inputs and outputs as scales, and their units.
  subroutine put_names(store, model, equilibrium, columns)
    class(data_set_store_type), intent(inout) :: store   !< the open storage
    type(model_type), intent(in) :: model                !< the model
    type(equilibrium_type), intent(in) :: equilibrium    !< linearised
    type(columns_type), intent(in) :: columns            !< recorded ones, the time first
    type(columns_type) :: states, inputs

    call name_linear_system(model%mechanism, equilibrium, states, inputs)
    call put_state_names(store, states, inputs, columns)
  end subroutine put_names

  !> Put the names of states, inputs and outputs as scales, and their units, where these are known.
  subroutine put_state_names(store, states, inputs, columns)
    class(data_set_store_type), intent(inout) :: store   !< the open storage
    type(columns_type), intent(in) :: states             !< as columns
    type(columns_type), intent(in) :: inputs             !< as columns
    type(columns_type), intent(in) :: columns            !< recorded ones, the time first

    call put_scale(store, 'state', states%names(:states%count), states%units(:states%count), &
                   'deviations of coordinates, of their rates and of states of motors')
    call put_scale(store, 'input', inputs%names(:inputs%count), inputs%units(:inputs%count), &
                   'additional forces on the free coordinates, and voltages of motors')
    call put_scale(store, 'output', columns%names(2:columns%motion), columns%units(2:columns%motion), &
                   'deviations of the recorded columns')
  end subroutine put_state_names

  !> Put one scale of the state space and its units.
  subroutine put_scale(store, name, texts, units, long_name)
    class(data_set_store_type), intent(inout) :: store   !< the open storage
    character(len=*), intent(in) :: name          !< of the scale
    type(string_type), intent(in) :: texts(:)     !< names along the dimension
    type(string_type), intent(in) :: units(:)     !< their units
    character(len=*), intent(in) :: long_name     !< its meaning

    call store%put('state_space/'//name, texts, long_name)
    call store%make_scale('state_space/'//name)
    call store%put('state_space/'//name//'_unit', units, 'unit of each')
    call store%attach_scales('state_space/'//name//'_unit', ['/state_space/'//name])
  end subroutine put_scale
end module mech9_linear_layout
