!> Derivatives by parameters in results: a group of data sets beside those of the motion.
module mech9_sensitivity_layout
  use mech9_columns, only: columns_type
  use mech9_data_set_store, only: data_set_store_type
  use mech9_column_sets, only: column_set_list_type, new_column_set
  use mech9_column_layout, only: identifier
  implicit none
  private
  public :: add_sensitivities, put_parameters

contains

  !> Add the derivatives of coordinates, points, forces, motors, energies and links. The parameter is the last dimension.
  subroutine add_sensitivities(list, columns)
    type(column_set_list_type), intent(inout) :: list   !< the data sets over the rows
    type(columns_type), intent(in) :: columns         !< columns of the rows to come
    character(len=3), parameter :: names(0:2) = ['q  ', 'dq ', 'ddq']
    character(len=12), parameter :: of_points(0:2) = ['position    ', 'velocity    ', 'acceleration']
    character(len=:), allocatable :: unit
    integer :: order, n, points, each, before, i, k, parameters

    n = size(columns%coordinates)
    parameters = size(columns%parameters)
    points = (columns%motion - 1)/(columns%derivatives + 1) - n
    call add_forces(list, columns)
    call add_scalars(list, columns)
    if (columns%varied_poses > 0) call add_poses(list, columns)
    do order = 0, columns%derivatives
      before = columns%count - columns%sensitivities + order*n*parameters
      call find_unit(columns, order*n + 2, n, unit)
      call list%add(new_column_set('sensitivity/'//trim(names(order)), [(before + i, i=1, parameters*n)], [parameters, n], &
                                   'derivatives of '//trim(names(order))//' by the parameters', &
                                   unit, ['/time      ', '/coordinate', '/parameter ']))
    end do
    if (points == 0) return
    each = 3*(columns%derivatives + 1)
    do order = 0, columns%derivatives
      before = columns%count - columns%sensitivities + ((columns%derivatives + 1)*n + 3*order)*parameters
      call find_unit(columns, (columns%derivatives + 1)*n + 3*order + 2, 1, unit)
      call list%add(new_column_set('sensitivity/'//trim(of_points(order)), &
                                   [((before + each*(i - 1)*parameters + k, k=1, 3*parameters), i=1, points/3)], &
                                   [parameters, 3, points/3], 'derivatives of '//trim(of_points(order))//' by the parameters', &
                                   unit, &
                                   ['/time     ', '/point    ', '/axis     ', '/parameter']))
    end do
  end subroutine add_sensitivities

  !> Add the derivatives of the forces of drives, of those in pairs, and of those of couplings.
  subroutine add_forces(list, columns)
    type(column_set_list_type), intent(inout) :: list   !< the data sets over the rows
    type(columns_type), intent(in) :: columns         !< columns of the rows to come
    character(len=:), allocatable :: unit
    integer :: n, parameters, at, i, k

    if (columns%forces() == 0) return
    parameters = size(columns%parameters)
    n = size(columns%drives)
    at = columns%motion
    call find_unit(columns, at + 1, n, unit)
    if (n > 0) call list%add(new_column_set('sensitivity/drive_force', [(places(columns, at + i), i=1, n)], [parameters, n], &
                                            'derivatives of drive_force by the parameters', unit, &
                                            ['/time     ', '/driven   ', '/parameter']))
    at = at + n
    n = size(columns%reacting)
    if (n == 0) return
    call find_unit(columns, at + 1, 1, unit)
    call list%add(new_column_set('sensitivity/reaction_force', [((places(columns, at + 6*(i - 1) + k), k=1, 3), i=1, n)], &
                                 [parameters, 3, n], 'derivatives of reaction_force by the parameters', &
                                 unit, ['/time     ', '/pair     ', '/axis     ', '/parameter']))
    call find_unit(columns, at + 4, 1, unit)
    call list%add(new_column_set('sensitivity/reaction_moment', [((places(columns, at + 6*(i - 1) + 3 + k), k=1, 3), i=1, n)], &
                                 [parameters, 3, n], 'derivatives of reaction_moment by the parameters', &
                                 unit, ['/time     ', '/pair     ', '/axis     ', '/parameter']))
    at = at + 6*n
    n = columns%couplings
    call find_unit(columns, at + 1, n, unit)
    if (n > 0) call list%add(new_column_set('sensitivity/coupling_force', [(places(columns, at + i), i=1, n)], [parameters, n], &
                                            'derivatives of coupling_force by the parameters', unit, &
                                            ['/time     ', '/coupling ', '/parameter']))
  end subroutine add_forces

  !> The columns of the derivatives of a column by each parameter.
  pure function places(columns, column)
    type(columns_type), intent(in) :: columns         !< the columns, with derivatives in the results
    integer, intent(in) :: column                     !< number of a column
    integer :: places(size(columns%parameters))

    places = columns%derivatives_of(column)
  end function places

  !> Add the derivatives of motors, energies, magnitudes and links.
  subroutine add_scalars(list, columns)
    type(column_set_list_type), intent(inout) :: list   !< the data sets over the rows
    type(columns_type), intent(in) :: columns         !< columns of the rows to come
    character(len=:), allocatable :: unit
    integer :: i

    do i = columns%motion + columns%forces() + 1, columns%varied + 1
      associate (name => columns%names(i)%text)
        call find_unit(columns, i, 1, unit)
        call list%add(new_column_set('sensitivity/'//identifier(name), places(columns, i), &
                                     [size(columns%parameters)], &
                                     'derivatives of the '//columns%long_names(i)%text//' by the parameters', &
                                     unit, ['/time     ', '/parameter']))
      end associate
    end do
  end subroutine add_scalars

  !> Add the derivatives of the poses of links.
  subroutine add_poses(list, columns)
    type(column_set_list_type), intent(inout) :: list   !< the data sets over the rows
    type(columns_type), intent(in) :: columns         !< columns of the rows to come
    character(len=*), parameter :: per_unit = ' per unit of the parameter in the data file'
    integer :: before, parameters, n, i

    before = columns%count + columns%poses%width()
    parameters = size(columns%parameters)
    n = columns%poses%n_links
    call list%add(new_column_set('sensitivity/origin', [(before + i, i=1, 3*n*parameters)], [parameters, 3, n], &
                                 'derivatives of origin by the parameters', trim(columns%system%length_name)//per_unit, &
                                 ['/time     ', '/link     ', '/axis     ', '/parameter']))
    before = before + 3*n*parameters
    call list%add(new_column_set('sensitivity/rotation', [(before + i, i=1, 9*n*parameters)], [parameters, 3, 3, n], &
                                 'derivatives of rotation by the parameters', '1'//per_unit, &
                                 ['/time     ', '/link     ', '/axis     ', '/link_axis', '/parameter']))
  end subroutine add_poses

  !> Find the unit of some columns, per unit of a parameter in the data file.
  pure subroutine find_unit(columns, first, n, text)
    type(columns_type), intent(in) :: columns            !< the columns
    integer, intent(in) :: first                         !< the first of them
    integer, intent(in) :: n                             !< their number
    character(len=:), allocatable, intent(out) :: text   !< the unit
    integer :: i

    text = ''
    do i = first, first + n - 1
      if (index(' '//text//' ', ' '//columns%units(i)%text//' ') > 0) cycle
      if (i > first) text = text//' or '
      text = text//columns%units(i)%text
    end do
    text = text//' per unit of the parameter in the data file'
  end subroutine find_unit

  !> Write the names of the parameters.
  subroutine put_parameters(store, columns)
    class(data_set_store_type), intent(inout) :: store   !< the open storage
    type(columns_type), intent(in) :: columns     !< with the names of the parameters

    call store%put('parameter', columns%parameters, 'name of the parameter')
    call store%make_scale('parameter')
  end subroutine put_parameters
end module mech9_sensitivity_layout
