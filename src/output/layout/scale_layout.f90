!> The dimension scales of results: numbers and names of coordinates, points, forces and links, with what describes them.
!>
!> A scale stands in the group of the data sets that it scales, or above: readers that follow the rules of netCDF look for it
!> nowhere else.
module mech9_scale_layout
  use mech9_text, only: string_type
  use mech9_part_names, only: name_in
  use mech9_mechanism, only: mechanism_type
  use mech9_result_units, only: force_unit_name
  use mech9_poses, only: poses_type
  use mech9_columns, only: columns_type
  use mech9_data_set_store, only: data_set_store_type
  implicit none
  private
  public :: put_scales, put_force_scales, find_common_unit, names_of_scales

  !> Paths of all data sets that `put_scales` may write.
  character(len=18), parameter :: names_of_scales(*) = [character(len=18) :: &
    'coordinate', 'coordinate_unit', 'coordinate_kind', 'point', 'point_link', 'axis', 'driven', 'drive_force_unit', 'pair', &
    'coupling', 'link', 'link_axis', 'vertex_number', 'shape/vertex_link', 'shape/line_number', 'shape/line_end', 'shape/line', &
    'shape/line_link']

  character, parameter :: directions(3) = ['x', 'y', 'z']

contains

  !> Write all scales that the columns of a run need, but time and parameters.
  subroutine put_scales(store, mechanism, columns)
    class(data_set_store_type), intent(inout) :: store    !< the open storage
    type(mechanism_type), intent(in) :: mechanism  !< the mechanism
    type(columns_type), intent(in) :: columns      !< columns of the rows to come
    logical :: has_axes

    call put_coordinate_scales(store, mechanism, columns)
    has_axes = size(mechanism%points) > 0
    if (has_axes) call put_point_scales(store, mechanism)
    if (columns%forces() > 0) call put_force_scales(store, mechanism, columns, has_axes)
    if (columns%poses%n_links > 0) call put_pose_scales(store, columns%poses, has_axes)
  end subroutine put_scales

  !> Write the numbers of the pairs with forces and of the driven coordinates, and the unit of the force of each.
  subroutine put_force_scales(store, mechanism, columns, has_axes)
    class(data_set_store_type), intent(inout) :: store    !< the open storage
    type(mechanism_type), intent(in) :: mechanism  !< the mechanism
    type(columns_type), intent(in) :: columns      !< columns of the rows to come
    logical, intent(inout) :: has_axes             !< whether the axes of the fixed frame have been written
    type(string_type) :: units(size(columns%drives))
    integer :: i

    if (size(columns%drives) > 0) then
      do i = 1, size(units)
        units(i)%text = trim(force_unit_name(mechanism, columns%drives(i)))
      end do
      call store%put('driven', columns%drives, 'number of the driven coordinate')
      call store%make_scale('driven')
      call store%put('drive_force_unit', units, 'unit of the force of each drive')
      call store%attach_scales('drive_force_unit', ['/driven'])
    end if
    if (size(columns%reacting) == 0) return
    call store%put('pair', columns%reacting, 'number of the pair, which is that of its coordinate')
    call store%make_scale('pair')
    if (.not. has_axes) call put_axes(store, 'axis', 'axis of the fixed frame')
    has_axes = .true.
    if (columns%couplings == 0) return
    call store%put('coupling', [(i, i=1, columns%couplings)], 'number of the coupling, in the order of the data file')
    call store%make_scale('coupling')
  end subroutine put_force_scales

  !> Write scales of the poses, and to which links vertices and lines belong.
  subroutine put_pose_scales(store, poses, has_axes)
    class(data_set_store_type), intent(inout) :: store  !< the open storage
    type(poses_type), intent(in) :: poses        !< links, vertices and lines that are written
    logical, intent(in) :: has_axes              !< whether the axes of the fixed frame have been written already
    integer :: line_link(size(poses%lines, 2)), i

    line_link = poses%vertex_link(poses%lines(1, :))
    if (.not. has_axes) call put_axes(store, 'axis', 'axis of the fixed frame')
    call put_axes(store, 'link_axis', 'axis of the link')
    call store%put('link', [(i, i=1, poses%n_links)], 'number of the link; 1 is the frame')
    call store%make_scale('link')
    call store%put('vertex_number', [(i, i=0, size(poses%vertex_link) - 1)], 'number of the vertex, from 0')
    call store%make_scale('vertex_number')
    call store%put('shape/vertex_link', poses%vertex_link, 'link that the vertex belongs to')
    call store%attach_scales('shape/vertex_link', ['/vertex_number'])
    call store%put('shape/line_number', [(i, i=0, size(line_link) - 1)], 'number of the line, from 0')
    call store%make_scale('shape/line_number')
    call store%put('shape/line_end', [1, 2], 'end of the line')
    call store%make_scale('shape/line_end')
    call store%put('shape/line', poses%lines - 1, 'the two vertices that a line joins')
    call store%attach_scales('shape/line', ['/shape/line_number', '/shape/line_end   '])
    call store%put('shape/line_link', line_link, 'link that the line belongs to')
    call store%attach_scales('shape/line_link', ['/shape/line_number'])
  end subroutine put_pose_scales

  !> Write a scale with the names of the axes x, y, z.
  subroutine put_axes(store, name, long_name)
    class(data_set_store_type), intent(inout) :: store  !< the open storage
    character(len=*), intent(in) :: name         !< path of the data set
    character(len=*), intent(in) :: long_name    !< a few words that describe it
    type(string_type) :: axes(3)
    integer :: i

    do i = 1, 3
      axes(i)%text = directions(i)
    end do
    call store%put(name, axes, long_name)
    call store%make_scale(name)
  end subroutine put_axes

  !> Write the numbers, units and kinds of the coordinates.
  subroutine put_coordinate_scales(store, mechanism, columns)
    class(data_set_store_type), intent(inout) :: store    !< the open storage
    type(mechanism_type), intent(in) :: mechanism  !< the mechanism
    type(columns_type), intent(in) :: columns      !< columns of the rows to come
    type(string_type) :: kinds(size(columns%coordinates))
    integer :: i, j

    do i = 1, size(kinds)
      kinds(i)%text = trim(mechanism%pairs(columns%coordinates(i))%pair%kind_name())
      j = mechanism%structure%joint_of(columns%coordinates(i))
      if (j > 0) kinds(i)%text = trim(mechanism%structure%joints(j)%kind)
    end do
    call store%put('coordinate', columns%coordinates, 'number of the coordinate and of its pair')
    call store%make_scale('coordinate')
    call store%put('coordinate_unit', columns%units(2:1 + size(kinds)), 'unit of each coordinate')
    call store%attach_scales('coordinate_unit', ['/coordinate'])
    call store%put('coordinate_kind', kinds, 'kind of each pair')
    call store%attach_scales('coordinate_kind', ['/coordinate'])
    if (.not. allocated(mechanism%names%coordinates)) return
    do i = 1, size(kinds)
      kinds(i)%text = trim(name_in(mechanism%names%coordinates, columns%coordinates(i)))
    end do
    call store%put('coordinate_name', kinds, 'name of each pair; empty where it has none')
    call store%attach_scales('coordinate_name', ['/coordinate'])
  end subroutine put_coordinate_scales

  !> Write the names and links of the points, and the axes.
  subroutine put_point_scales(store, mechanism)
    class(data_set_store_type), intent(inout) :: store    !< the open storage
    type(mechanism_type), intent(in) :: mechanism  !< the mechanism
    type(string_type) :: names(size(mechanism%points))
    integer :: i

    do i = 1, size(names)
      names(i)%text = mechanism%points(i)%name
    end do
    call store%put('point', names, 'name of the point')
    call store%make_scale('point')
    call put_axes(store, 'axis', 'axis of the fixed frame')
    call store%put('point_link', mechanism%points%link, 'link that carries the point')
    call store%attach_scales('point_link', ['/point'])
  end subroutine put_point_scales

  !> Find the unit if it is the same for all; otherwise the list of units, and `coordinate_unit` tells that of each.
  pure subroutine find_common_unit(units, text)
    type(string_type), intent(in) :: units(:)            !< units of the coordinates
    character(len=:), allocatable, intent(out) :: text   !< the unit, or the list
    integer :: i, k

    text = ''
    do i = 1, size(units)
      if (any([(units(k)%text == units(i)%text, k=1, i - 1)])) cycle
      if (i > 1) text = text//' or '
      text = text//units(i)%text
    end do
  end subroutine find_common_unit
end module mech9_scale_layout
