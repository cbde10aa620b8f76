!> The columns of results as data sets: over time, as a run writes them, or over the runs of a study and time.
module mech9_column_layout
  use mech9_mechanism, only: mechanism_type
  use mech9_columns, only: columns_type
  use mech9_column_sets, only: column_set_type, column_set_list_type, new_column_set, scale_length
  use mech9_scale_layout, only: find_common_unit
  implicit none
  private
  public :: column_layout_type, identifier

  !> How columns become data sets.
  type :: column_layout_type
    integer :: times = 0   !< how many times a row of the list holds, one after the other: all those of a run; 0: a row is one time
  contains
    procedure :: add => add_all
    procedure, private :: add_one
    procedure, private :: add_of_coordinates, add_of_points, add_forces, add_poses
  end type column_layout_type

contains

  !> How many columns belong neither to a coordinate nor to a point, force or parameter.
  pure integer function scalars_of(columns)
    type(columns_type), intent(in) :: columns   !< of the rows to come

    scalars_of = columns%count - columns%motion - columns%forces() - columns%sensitivities
  end function scalars_of

  !> Add the data sets of all columns but time and sensitivities, each with a scale for every dimension.
  subroutine add_all(self, list, mechanism, columns)
    class(column_layout_type), intent(in) :: self       !< how columns become data sets
    type(column_set_list_type), intent(inout) :: list   !< gets the data sets
    type(mechanism_type), intent(in) :: mechanism     !< the mechanism
    type(columns_type), intent(in) :: columns         !< columns of the rows to come
    character(len=3), parameter :: names(0:2) = ['q  ', 'dq ', 'ddq']
    character(len=13), parameter :: words(0:2) = ['coordinates  ', 'rates        ', 'accelerations']
    character(len=12), parameter :: of_points(0:2) = ['position    ', 'velocity    ', 'acceleration']
    character(len=5), parameter :: point_units(0:2) = ['m    ', 'm/s  ', 'm/s^2']
    integer :: order, i, at

    do order = 0, columns%derivatives
      call self%add_of_coordinates(list, columns, trim(names(order)), trim(words(order))// &
                                   merge(' of the pairs      ', ' of the coordinates', order == 0), order)
    end do
    do order = 0, columns%derivatives
      if (size(mechanism%points) > 0) &
        call self%add_of_points(list, mechanism, columns, trim(of_points(order)), &
                                trim(columns%system%name_of(trim(point_units(order)))), order)
    end do
    if (columns%forces() > 0) call self%add_forces(list, columns)
    do i = 1, scalars_of(columns)
      at = columns%motion + columns%forces() + i
      call self%add_one(list, columns, new_column_set(identifier(columns%names(at)%text), [at], [integer ::], &
                                                      columns%long_names(at)%text, columns%units(at)%text, [character(len=1) ::]))
    end do
    if (columns%poses%n_links > 0) call self%add_poses(list, columns)
  end subroutine add_all

  !> Add one data set.
  subroutine add_one(self, list, columns, of_a_time)
    class(column_layout_type), intent(in) :: self       !< how columns become data sets
    type(column_set_list_type), intent(inout) :: list   !< gets the data set
    type(columns_type), intent(in) :: columns         !< columns of the rows to come
    type(column_set_type), intent(in) :: of_a_time    !< its part of one time, with the scales of its dimensions behind time
    type(column_set_type) :: quantity
    character(len=scale_length) :: before(2)
    integer :: i, k

    quantity = of_a_time
    before = [character(len=scale_length) :: '/run', '/time']
    if (self%times == 0) then
      quantity%scales = [before(2:), of_a_time%scales]
    else
      quantity%columns = [((of_a_time%columns(i) + (k - 1)*columns%width(), i=1, size(of_a_time%columns)), k=1, self%times)]
      quantity%extents = [of_a_time%extents, self%times]
      quantity%scales = [before, of_a_time%scales]
    end if
    call list%add(quantity)
  end subroutine add_one

  !> Add a quantity of all coordinates.
  subroutine add_of_coordinates(self, list, columns, name, long_name, order)
    class(column_layout_type), intent(in) :: self       !< how columns become data sets
    type(column_set_list_type), intent(inout) :: list   !< gets the data sets
    type(columns_type), intent(in) :: columns         !< columns of the rows to come
    character(len=*), intent(in) :: name              !< path of the data set
    character(len=*), intent(in) :: long_name     !< a few words that describe it
    integer, intent(in) :: order                      !< number of derivatives by time: 0, 1 or 2
    character(len=:), allocatable :: unit
    integer :: before, n, i

    n = size(columns%coordinates)
    before = 1 + order*n
    call find_common_unit(columns%units(before + 1:before + n), unit)
    call self%add_one(list, columns, new_column_set(name, [(before + i, i=1, n)], [n], trim(long_name), unit, &
                                                    ['/coordinate']))
  end subroutine add_of_coordinates

  !> Add a quantity of all points, with three components.
  subroutine add_of_points(self, list, mechanism, columns, name, unit, order)
    class(column_layout_type), intent(in) :: self       !< how columns become data sets
    type(column_set_list_type), intent(inout) :: list   !< gets the data sets
    type(mechanism_type), intent(in) :: mechanism     !< the mechanism
    type(columns_type), intent(in) :: columns         !< columns of the rows to come
    character(len=*), intent(in) :: name              !< path of the data set
    character(len=*), intent(in) :: unit              !< unit of its numbers
    integer, intent(in) :: order                      !< number of derivatives by time: 0, 1 or 2
    character(len=:), allocatable :: plural
    integer :: before, each, i, k

    plural = name//'s'
    if (name == 'velocity') plural = 'velocities'
    each = 3*(columns%derivatives + 1)
    before = 1 + (columns%derivatives + 1)*size(columns%coordinates) + 3*order
    call self%add_one(list, columns, new_column_set(name, [((before + each*(i - 1) + k, k=1, 3), i=1, size(mechanism%points))], &
                                                    [3, size(mechanism%points)], plural//' of the points in the fixed frame', &
                                                    unit, ['/point', '/axis ']))
  end subroutine add_of_points

  !> Add the forces of drives and the wrenches of pairs.
  subroutine add_forces(self, list, columns)
    class(column_layout_type), intent(in) :: self       !< how columns become data sets
    type(column_set_list_type), intent(inout) :: list   !< gets the data sets
    type(columns_type), intent(in) :: columns         !< columns of the rows to come
    character(len=:), allocatable :: unit
    character(len=:), allocatable :: axes
    integer :: n, at, i, k

    axes = 'the fixed frame'
    if (columns%in_links) axes = 'the axes of the moving links'
    n = size(columns%drives)
    at = columns%motion
    call find_common_unit(columns%units(at + 1:at + n), unit)
    if (n > 0) call self%add_one(list, columns, new_column_set('drive_force', [(at + i, i=1, n)], [n], &
                                                               'forces that the drives need', unit, ['/driven']))
    at = at + n
    n = size(columns%reacting)
    if (n == 0) return
    call self%add_one(list, columns, new_column_set('reaction_force', [((at + 6*(i - 1) + k, k=1, 3), i=1, n)], [3, n], &
                                                    'forces that the reference links pass to the moving links through the '// &
                                                    'pairs, in '//axes, trim(columns%system%force_name), &
                                                    ['/pair', '/axis']))
    call self%add_one(list, columns, new_column_set('reaction_moment', [((at + 6*(i - 1) + 3 + k, k=1, 3), i=1, n)], [3, n], &
                                                    'moments that they pass, about the origins of the pairs'' frames in the '// &
                                                    'moving links, in '//axes, trim(columns%system%name_of('N m')), &
                                                    ['/pair', '/axis']))
    at = at + 6*n
    n = columns%couplings
    call find_common_unit(columns%units(at + 1:at + n), unit)
    if (n > 0) call self%add_one(list, columns, new_column_set('coupling_force', [(at + i, i=1, n)], [n], &
                                                               'forces of the couplings on their second coordinates', &
                                                               unit, ['/coupling']))
  end subroutine add_forces

  !> Add poses of links, and the vertices of their drawing.
  subroutine add_poses(self, list, columns)
    class(column_layout_type), intent(in) :: self       !< how columns become data sets
    type(column_set_list_type), intent(inout) :: list   !< gets the data sets
    type(columns_type), intent(in) :: columns         !< columns of the rows to come
    integer :: n, vertices, i

    n = columns%poses%n_links
    vertices = size(columns%poses%vertex_link)
    call self%add_one(list, columns, new_column_set('origin', [(columns%count + i, i=1, 3*n)], [3, n], &
                                                    'origins U of the links in the fixed frame', &
                                                    trim(columns%system%length_name), ['/link', '/axis']))
    call self%add_one(list, columns, new_column_set('rotation', [(columns%count + 3*n + i, i=1, 9*n)], [3, 3, n], &
                                                    'rotations A of the links: X = A X'' + U', '1', &
                                                    ['/link     ', '/axis     ', '/link_axis']))
    call self%add_one(list, columns, new_column_set('vertex', [(columns%count + 12*n + i, i=1, 3*vertices)], [3, vertices], &
                                                    'vertices of the drawn links in the fixed frame', &
                                                    trim(columns%system%length_name), &
                                                    ['/vertex_number', '/axis         ']))
  end subroutine add_poses

  !> The name of a column as an identifier that programs accept: E_kinetic for E.kinetic.
  pure function identifier(name) result(text)
    character(len=*), intent(in) :: name  !< heading of a column
    character(len=len(name)) :: text
    integer :: i

    text = name
    do i = 1, len(name)
      if (name(i:i) == '.') text(i:i) = '_'
    end do
  end function identifier
end module mech9_column_layout
