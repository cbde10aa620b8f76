!> Results as an HDF5 file; docs/results.md describes its content.
module mech9_hdf5_sink
  use mech9_kinds, only: wp
  use mech9_error, only: error_type
  use mech9_text, only: string_type
  use mech9_clock, only: pacer_type
  use mech9_request, only: request_type
  use mech9_mechanism, only: mechanism_type
  use mech9_result_units, only: force_unit_name
  use mech9_poses, only: poses_type
  use mech9_columns, only: columns_type
  use mech9_result_sink, only: result_sink_type
  use mech9_hdf5_file, only: hdf5_file_type
  use mech9_hdf5_series, only: hdf5_series_type
  use mech9_hdf5_sensitivities, only: quantities_of_sensitivity, add_sensitivities, &
    put_parameters
  implicit none
  private
  public :: hdf5_sink_type, put_force_scales, common_unit

  !> Longest time after which readers of the file see new rows [s].
  real(wp), parameter :: longest_wait = 1.0_wp
  !> Number of quantities: time, coordinates and points with their derivatives; poses; forces.
  integer, parameter :: quantities_of_motion = 7 + 3 + 3
  !> Number of events in a chunk of their data sets.
  integer, parameter :: most_events = 64
  character, parameter :: directions(3) = ['x', 'y', 'z']

  type, extends(result_sink_type) :: hdf5_sink_type
    type(hdf5_file_type) :: file
    type(hdf5_series_type), private :: series
    type(hdf5_series_type), private :: events
    logical, private :: begun = .false.  !< whether rows were written
    type(pacer_type), private :: pacer
    logical, private :: reported = .false.  !< whether the failure of the file was reported
  contains
    procedure :: open => open_sink
    procedure :: write_rows
    procedure :: flush => flush_sink
    procedure :: close => close_sink
    procedure :: words
    procedure :: begin_events
    procedure :: write_events
    procedure :: tell
  end type hdf5_sink_type

contains

  !> Create the file with all its quantities, without rows.
  subroutine open_sink(self, path, mechanism, request, columns, err)
    class(hdf5_sink_type), intent(inout) :: self       !< the HDF5 sink
    character(len=*), intent(in) :: path               !< path of the file
    type(mechanism_type), intent(in) :: mechanism      !< the mechanism
    type(request_type), intent(in) :: request          !< the times of the rows, and the compression
    type(columns_type), intent(in) :: columns          !< columns of the rows to come
    type(error_type), allocatable, intent(out) :: err  !< allocated if it failed
    integer :: scalars
    logical :: has_axes

    call self%file%create(path, err)
    if (allocated(err)) return
    scalars = columns%count - columns%motion - columns%forces() - columns%sensitivities
    self%takes_poses = .true.
    call self%series%start(quantities_of_motion + scalars + quantities_of_sensitivity, columns%width(), &
                           request%time%intervals + 1, request%output%compression)
    call add_quantities(self, mechanism, columns, scalars)
    if (columns%sensitivities > 0) call add_sensitivities(self%series, columns)
    if (columns%poses%n_links > 0) call add_poses(self, columns)
    call self%series%create(self%file)
    call add_coordinate_scales(self%file, mechanism, columns)
    if (size(mechanism%points) > 0) call add_point_scales(self%file, mechanism)
    has_axes = size(mechanism%points) > 0
    if (columns%forces() > 0) call put_force_scales(self%file, mechanism, columns, has_axes)
    if (columns%poses%n_links > 0) call add_pose_scales(self%file, columns%poses, has_axes)
    if (columns%sensitivities > 0) call put_parameters(self%file, columns)
    call self%series%attach(self%file)
    call self%pacer%start(longest_wait)
    call self%tell(err)
  end subroutine open_sink

  !> Add the quantities over time, each with a scale for every dimension.
  subroutine add_quantities(self, mechanism, columns, scalars)
    class(hdf5_sink_type), intent(inout) :: self   !< the HDF5 sink
    type(mechanism_type), intent(in) :: mechanism  !< the mechanism
    type(columns_type), intent(in) :: columns      !< columns of the rows to come
    integer, intent(in) :: scalars                 !< how many columns belong neither to a coordinate nor to a point
    character(len=3), parameter :: names(0:2) = ['q  ', 'dq ', 'ddq']
    character(len=13), parameter :: words(0:2) = ['coordinates  ', 'rates        ', 'accelerations']
    character(len=12), parameter :: of_points(0:2) = ['position    ', 'velocity    ', 'acceleration']
    character(len=5), parameter :: point_units(0:2) = ['m    ', 'm/s  ', 'm/s^2']
    integer :: order, i, at

    call self%series%add('time', [1], [integer ::], 'time', columns%units(1)%text, [character(len=5) ::])
    do order = 0, columns%derivatives
      call add_of_coordinates(self, columns, trim(names(order)), trim(words(order))// &
                              merge(' of the pairs      ', ' of the coordinates', order == 0), order)
    end do
    do order = 0, columns%derivatives
      if (size(mechanism%points) > 0) &
        call add_of_points(self, mechanism, columns, trim(of_points(order)), trim(point_units(order)), order)
    end do
    if (columns%forces() > 0) call add_forces(self, columns)
    do i = 1, scalars
      at = columns%motion + columns%forces() + i
      call self%series%add(identifier(columns%names(at)%text), [at], [integer ::], &
                           columns%long_names(at)%text, columns%units(at)%text, ['/time'])
    end do
  end subroutine add_quantities

  !> Add a quantity of all coordinates.
  subroutine add_of_coordinates(self, columns, name, long_name, order)
    class(hdf5_sink_type), intent(inout) :: self  !< the HDF5 sink
    type(columns_type), intent(in) :: columns     !< columns of the rows to come
    character(len=*), intent(in) :: name          !< path of the data set
    character(len=*), intent(in) :: long_name     !< a few words that describe it
    integer, intent(in) :: order                  !< number of derivatives by time: 0, 1 or 2
    integer :: before, n, i

    n = size(columns%coordinates)
    before = 1 + order*n
    call self%series%add(name, [(before + i, i=1, n)], [n], trim(long_name), &
                         common_unit(columns%units(before + 1:before + n)), ['/time      ', '/coordinate'])
  end subroutine add_of_coordinates

  !> Add a quantity of all points, with three components.
  subroutine add_of_points(self, mechanism, columns, name, unit, order)
    class(hdf5_sink_type), intent(inout) :: self   !< the HDF5 sink
    type(mechanism_type), intent(in) :: mechanism  !< the mechanism
    type(columns_type), intent(in) :: columns      !< columns of the rows to come
    character(len=*), intent(in) :: name           !< path of the data set
    character(len=*), intent(in) :: unit           !< unit of its numbers
    integer, intent(in) :: order                   !< number of derivatives by time: 0, 1 or 2
    character(len=:), allocatable :: plural
    integer :: before, each, i, k

    plural = name//'s'
    if (name == 'velocity') plural = 'velocities'
    each = 3*(columns%derivatives + 1)
    before = 1 + (columns%derivatives + 1)*size(columns%coordinates) + 3*order
    call self%series%add(name, [((before + each*(i - 1) + k, k=1, 3), i=1, size(mechanism%points))], &
                         [3, size(mechanism%points)], plural//' of the points in the fixed frame', unit, &
                         ['/time ', '/point', '/axis '])
  end subroutine add_of_points

  !> Add the forces of drives and the wrenches of pairs.
  subroutine add_forces(self, columns)
    class(hdf5_sink_type), intent(inout) :: self  !< the HDF5 sink
    type(columns_type), intent(in) :: columns     !< columns of the rows to come
    integer :: n, at, i, k

    n = size(columns%drives)
    at = columns%motion
    if (n > 0) call self%series%add('drive_force', [(at + i, i=1, n)], [n], 'forces that the drives need', &
                                    common_unit(columns%units(at + 1:at + n)), ['/time  ', '/driven'])
    at = at + n
    n = size(columns%reacting)
    if (n == 0) return
    call self%series%add('reaction_force', [((at + 6*(i - 1) + k, k=1, 3), i=1, n)], [3, n], &
                         'forces that the reference links pass to the moving links through the pairs, in the fixed frame', 'N', &
                         ['/time', '/pair', '/axis'])
    call self%series%add('reaction_moment', [((at + 6*(i - 1) + 3 + k, k=1, 3), i=1, n)], [3, n], &
                         'moments that they pass, about the origins of the pairs'' frames in the moving links', 'N m', &
                         ['/time', '/pair', '/axis'])
    at = at + 6*n
    n = columns%couplings
    if (n > 0) call self%series%add('coupling_force', [(at + i, i=1, n)], [n], &
                                    'forces of the couplings on their second coordinates', &
                                    common_unit(columns%units(at + 1:at + n)), ['/time    ', '/coupling'])
  end subroutine add_forces

  !> Add poses of links, and the vertices of their drawing.
  subroutine add_poses(self, columns)
    class(hdf5_sink_type), intent(inout) :: self  !< the HDF5 sink
    type(columns_type), intent(in) :: columns     !< columns of the rows to come
    integer :: n, vertices, i

    n = columns%poses%n_links
    vertices = size(columns%poses%vertex_link)
    call self%series%add('origin', [(columns%count + i, i=1, 3*n)], [3, n], 'origins U of the links in the fixed frame', &
                         'm', ['/time', '/link', '/axis'])
    call self%series%add('rotation', [(columns%count + 3*n + i, i=1, 9*n)], [3, 3, n], &
                         'rotations A of the links: X = A X'' + U', '1', &
                         ['/time     ', '/link     ', '/axis     ', '/link_axis'])
    call self%series%add('vertex', [(columns%count + 12*n + i, i=1, 3*vertices)], [3, vertices], &
                         'vertices of the drawn links in the fixed frame', 'm', &
                         ['/time         ', '/vertex_number', '/axis         '])
  end subroutine add_poses

  !> Write the numbers of the pairs with forces and of the driven coordinates, and the unit of the force of each.
  subroutine put_force_scales(file, mechanism, columns, has_axes)
    type(hdf5_file_type), intent(inout) :: file    !< the open file
    type(mechanism_type), intent(in) :: mechanism  !< the mechanism
    type(columns_type), intent(in) :: columns      !< columns of the rows to come
    logical, intent(inout) :: has_axes             !< whether the axes of the fixed frame are in the file
    type(string_type) :: units(size(columns%drives))
    integer :: i

    if (size(columns%drives) > 0) then
      do i = 1, size(units)
        units(i)%text = trim(force_unit_name(mechanism, columns%drives(i)))
      end do
      call file%put('driven', columns%drives, 'number of the driven coordinate')
      call file%make_scale('driven')
      call file%put('drive_force_unit', units, 'unit of the force of each drive')
      call file%attach_scales('drive_force_unit', ['/driven'])
    end if
    if (size(columns%reacting) == 0) return
    call file%put('pair', columns%reacting, 'number of the pair, which is that of its coordinate')
    call file%make_scale('pair')
    if (.not. has_axes) call put_axes(file, 'axis', 'axis of the fixed frame')
    has_axes = .true.
    if (columns%couplings == 0) return
    call file%put('coupling', [(i, i=1, columns%couplings)], 'number of the coupling, in the order of the data file')
    call file%make_scale('coupling')
  end subroutine put_force_scales

  !> Write scales of the poses, and to which links vertices and lines belong. A scale stands in the group of the data set
  !> that it scales, or above: readers that follow the rules of netCDF look for it nowhere else.
  subroutine add_pose_scales(file, poses, has_axes)
    type(hdf5_file_type), intent(inout) :: file  !< the open file
    type(poses_type), intent(in) :: poses        !< links, vertices and lines that are written
    logical, intent(in) :: has_axes              !< whether the axes of the fixed frame are in the file already
    integer :: line_link(size(poses%lines, 2)), i

    line_link = poses%vertex_link(poses%lines(1, :))
    if (.not. has_axes) call put_axes(file, 'axis', 'axis of the fixed frame')
    call put_axes(file, 'link_axis', 'axis of the link')
    call file%put('link', [(i, i=1, poses%n_links)], 'number of the link; 1 is the frame')
    call file%make_scale('link')
    call file%put('vertex_number', [(i, i=0, size(poses%vertex_link) - 1)], 'number of the vertex, from 0')
    call file%make_scale('vertex_number')
    call file%put('shape/vertex_link', poses%vertex_link, 'link that the vertex belongs to')
    call file%attach_scales('shape/vertex_link', ['/vertex_number'])
    call file%put('shape/line_number', [(i, i=0, size(line_link) - 1)], 'number of the line, from 0')
    call file%make_scale('shape/line_number')
    call file%put('shape/line_end', [1, 2], 'end of the line')
    call file%make_scale('shape/line_end')
    call file%put('shape/line', poses%lines - 1, 'the two vertices that a line joins')
    call file%attach_scales('shape/line', ['/shape/line_number', '/shape/line_end   '])
    call file%put('shape/line_link', line_link, 'link that the line belongs to')
    call file%attach_scales('shape/line_link', ['/shape/line_number'])
  end subroutine add_pose_scales

  !> Write a scale with the names of the axes x, y, z.
  subroutine put_axes(file, name, long_name)
    type(hdf5_file_type), intent(inout) :: file  !< the open file
    character(len=*), intent(in) :: name         !< path of the data set
    character(len=*), intent(in) :: long_name    !< a few words that describe it
    type(string_type) :: axes(3)
    integer :: i

    do i = 1, 3
      axes(i)%text = directions(i)
    end do
    call file%put(name, axes, long_name)
    call file%make_scale(name)
  end subroutine put_axes

  !> Write the numbers, units and kinds of the coordinates.
  subroutine add_coordinate_scales(file, mechanism, columns)
    type(hdf5_file_type), intent(inout) :: file    !< the open file
    type(mechanism_type), intent(in) :: mechanism  !< the mechanism
    type(columns_type), intent(in) :: columns      !< columns of the rows to come
    type(string_type) :: kinds(size(columns%coordinates))
    integer :: i, j

    do i = 1, size(kinds)
      kinds(i)%text = trim(mechanism%pairs(columns%coordinates(i))%pair%kind_name())
      j = mechanism%structure%joint_of(columns%coordinates(i))
      if (j > 0) kinds(i)%text = trim(mechanism%structure%joints(j)%kind)
    end do
    call file%put('coordinate', columns%coordinates, 'number of the coordinate and of its pair')
    call file%make_scale('coordinate')
    call file%put('coordinate_unit', columns%units(2:1 + size(kinds)), 'unit of each coordinate')
    call file%attach_scales('coordinate_unit', ['/coordinate'])
    call file%put('coordinate_kind', kinds, 'kind of each pair')
    call file%attach_scales('coordinate_kind', ['/coordinate'])
  end subroutine add_coordinate_scales

  !> Write the names and links of the points, and the axes.
  subroutine add_point_scales(file, mechanism)
    type(hdf5_file_type), intent(inout) :: file    !< the open file
    type(mechanism_type), intent(in) :: mechanism  !< the mechanism
    type(string_type) :: names(size(mechanism%points))
    integer :: i

    do i = 1, size(names)
      names(i)%text = mechanism%points(i)%name
    end do
    call file%put('point', names, 'name of the point')
    call file%make_scale('point')
    call put_axes(file, 'axis', 'axis of the fixed frame')
    call file%put('point_link', mechanism%points%link, 'link that carries the point')
    call file%attach_scales('point_link', ['/point'])
  end subroutine add_point_scales

  !> The unit if it is the same for all; otherwise the list of units, and `coordinate_unit` tells that of each.
  pure function common_unit(units) result(text)
    type(string_type), intent(in) :: units(:)  !< units of the coordinates
    character(len=:), allocatable :: text
    integer :: i

    text = ''
    do i = 1, size(units)
      if (index(' '//text//' ', ' '//units(i)%text//' ') > 0) cycle
      if (i > 1) text = text//' or '
      text = text//units(i)%text
    end do
  end function common_unit

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

  !> Make data sets for the events of a run: the times at which other coordinates became independent, and their numbers.
  subroutine begin_events(self, n_independent)
    class(hdf5_sink_type), intent(inout) :: self  !< the HDF5 sink
    integer, intent(in) :: n_independent          !< how many coordinates are independent
    integer :: i

    call self%events%start(3, 1 + 2*n_independent, most_events, 0)
    call self%events%add('events/time', [1], [integer ::], 'when other coordinates were taken', 's', &
                         [character(len=5) ::])
    call self%events%add('events/independent', [(1 + i, i=1, n_independent)], [n_independent], &
                         'the independent coordinates from then on', '1', ['/events/time   ', '/events/freedom'], whole=.true.)
    call self%events%add('events/replaced', [(1 + n_independent + i, i=1, n_independent)], [n_independent], &
                         '1 where another angle is integrated in place of this coordinate, near gimbal lock', '1', &
                         ['/events/time   ', '/events/freedom'], whole=.true.)
    call self%events%create(self%file)
    call self%file%put('events/freedom', [(i, i=1, n_independent)], 'number of the degree of freedom')
    call self%file%make_scale('events/freedom')
    call self%events%attach(self%file)
  end subroutine begin_events

  !> Write the events of the run.
  subroutine write_events(self, times, independent, replaced)
    class(hdf5_sink_type), intent(inout) :: self  !< the HDF5 sink
    real(wp), intent(in) :: times(:)              !< times of the events [s]
    integer, intent(in) :: independent(:, :)      !< (degrees of freedom, events) numbers of the independent coordinates then
    logical, intent(in) :: replaced(:, :)         !< (degrees of freedom, events) another angle is integrated in its place
    real(wp) :: rows(1 + 2*size(independent, 1), size(times))
    integer :: n

    n = size(independent, 1)
    rows(1, :) = times
    rows(2:1 + n, :) = real(independent, wp)
    rows(2 + n:, :) = merge(1.0_wp, 0.0_wp, replaced)
    call self%events%append_rows(self%file, rows)
  end subroutine write_events

  !> Append rows. They are flushed about once a second, and the first ones at once, because the first flush
  !> determines where the later data stand in the file.
  subroutine write_rows(self, rows, err)
    class(hdf5_sink_type), intent(inout) :: self       !< the HDF5 sink
    real(wp), intent(in) :: rows(:, :)                 !< (columns, rows) numbers of the rows
    type(error_type), allocatable, intent(out) :: err  !< allocated if it failed

    call self%series%append_rows(self%file, rows)
    if (self%pacer%due() .or. .not. self%begun) then
      self%begun = .true.
      call self%series%hand_over(self%file)
      call self%file%flush()
    end if
    call self%tell(err)
  end subroutine write_rows

  !> Write all rows to the file.
  subroutine flush_sink(self, err)
    class(hdf5_sink_type), intent(inout) :: self       !< the HDF5 sink
    type(error_type), allocatable, intent(out) :: err  !< allocated if it failed

    call self%series%hand_over(self%file, at_end=.true.)
    call self%file%flush()
    call self%tell(err)
  end subroutine flush_sink

  !> Write all rows and close the file.
  subroutine close_sink(self, err)
    class(hdf5_sink_type), intent(inout) :: self       !< the HDF5 sink
    type(error_type), allocatable, intent(out) :: err  !< allocated if it failed

    if (.not. self%file%is_open()) return
    call self%series%close(self%file)
    call self%events%close(self%file)
    call self%file%close()
    call self%tell(err)
  end subroutine close_sink

  !> The path of the file in words.
  function words(self)
    class(hdf5_sink_type), intent(in) :: self  !< the HDF5 sink
    character(len=:), allocatable :: words

    words = 'HDF5 file: '//self%file%path
  end function words

  !> Return the first failure of the file, only once.
  subroutine tell(self, err)
    class(hdf5_sink_type), intent(inout) :: self       !< the HDF5 sink
    type(error_type), allocatable, intent(out) :: err  !< allocated if it failed

    if (self%reported .or. .not. allocated(self%file%failure)) return
    self%reported = .true.
    err = self%file%failure
  end subroutine tell
end module mech9_hdf5_sink
