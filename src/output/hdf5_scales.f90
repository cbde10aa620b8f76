!> The dimension scales of results in HDF5 files: numbers and names of coordinates, points, forces and links, with what describes them.
!>
!> A scale stands in the group of the data sets that it scales, or above: readers that follow the rules of netCDF look for it
!> nowhere else.
module mech9_hdf5_scales
  use mech9_text, only: string_type
  use mech9_mechanism, only: mechanism_type
  use mech9_result_units, only: force_unit_name
  use mech9_poses, only: poses_type
  use mech9_columns, only: columns_type
  use mech9_hdf5_file, only: hdf5_file_type
  implicit none
  private
  public :: put_scales, put_force_scales, common_unit, names_of_scales

  !> Paths of all data sets that `put_scales` may write.
  character(len=18), parameter :: names_of_scales(*) = [character(len=18) :: &
    'coordinate', 'coordinate_unit', 'coordinate_kind', 'point', 'point_link', 'axis', 'driven', 'drive_force_unit', 'pair', &
    'coupling', 'link', 'link_axis', 'vertex_number', 'shape/vertex_link', 'shape/line_number', 'shape/line_end', 'shape/line', &
    'shape/line_link']

  character, parameter :: directions(3) = ['x', 'y', 'z']

contains

  !> Write all scales that the columns of a run need, but time and parameters.
  subroutine put_scales(file, mechanism, columns)
    type(hdf5_file_type), intent(inout) :: file    !< the open file
    type(mechanism_type), intent(in) :: mechanism  !< the mechanism
    type(columns_type), intent(in) :: columns      !< columns of the rows to come
    logical :: has_axes

    call put_coordinate_scales(file, mechanism, columns)
    has_axes = size(mechanism%points) > 0
    if (has_axes) call put_point_scales(file, mechanism)
    if (columns%forces() > 0) call put_force_scales(file, mechanism, columns, has_axes)
    if (columns%poses%n_links > 0) call put_pose_scales(file, columns%poses, has_axes)
  end subroutine put_scales

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

  !> Write scales of the poses, and to which links vertices and lines belong.
  subroutine put_pose_scales(file, poses, has_axes)
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
  end subroutine put_pose_scales

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
  subroutine put_coordinate_scales(file, mechanism, columns)
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
  end subroutine put_coordinate_scales

  !> Write the names and links of the points, and the axes.
  subroutine put_point_scales(file, mechanism)
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
  end subroutine put_point_scales

  !> The unit if it is the same for all; otherwise the list of units, and `coordinate_unit` tells that of each.
  pure function common_unit(units) result(text)
    type(string_type), intent(in) :: units(:)  !< units of the coordinates
    character(len=:), allocatable :: text
    integer :: i, k

    text = ''
    do i = 1, size(units)
      if (any([(units(k)%text == units(i)%text, k=1, i - 1)])) cycle
      if (i > 1) text = text//' or '
      text = text//units(i)%text
    end do
  end function common_unit
end module mech9_hdf5_scales
