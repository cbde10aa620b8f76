!> Content of an HDF5 file of results besides the rows: their origin, and the structure of the mechanism.
module mech9_hdf5_record
  use mech9_program_kind, only: program_names
  use mech9_text, only: to_text, string_type
  use mech9_lapack, only: ilaver
  use mech9_structural_vectors, only: structural_vectors_type
  use mech9_joint_expansion, only: shown_vectors
  use mech9_model, only: model_type
  use mech9_result_units, only: unit_name
  use mech9_columns, only: columns_type
  use mech9_force_record, only: force_record_type
  use mech9_uniqueness, only: component_names
  use mech9_hdf5_file, only: hdf5_file_type, hdf5_version
  use mech9_command_line, only: command_line_type
  use mech9_version, only: name_and_version, version, revision, compiler, sundials_version
  implicit none
  private
  public :: write_provenance, write_structure, write_uniqueness, write_coordinates

  !> Most links with which the coincidence matrix is written; for more links it would be larger than the results.
  integer, parameter :: largest_matrix = 1000

contains

  !> Write the origin of the results, with all data that are needed to compute them again.
  subroutine write_provenance(file, options, model, data_text, created)
    type(hdf5_file_type), intent(inout) :: file      !< the open file
    type(command_line_type), intent(in) :: options   !< the command line
    type(model_type), intent(in) :: model        !< the model
    character(len=*), intent(in) :: data_text        !< of the data file, as it is
    character(len=*), intent(in), optional :: created   !< time when the run began; the present time unless it is given
    character(len=:), allocatable :: began

    began = present_time()
    if (present(created)) began = created
    call file%add_attribute('/', 'title', model%mechanism%title)
    call file%add_attribute('/', 'source', name_and_version(model%program))
    call file%put('provenance/program', program_names(model%program), 'program that wrote this file')
    call file%put('provenance/version', version, 'version of the program')
    call file%put('provenance/revision', revision, 'git revision of its sources; empty where unknown')
    call file%put('provenance/compiler', compiler, 'compiler that built it')
    call file%put('provenance/libraries', libraries(), 'libraries that it stands on')
    call file%put('provenance/created', began, 'when the run began')
    call file%put('provenance/command_line', program_names(model%program)//' '//options%line, 'command line of the run')
    call file%put('provenance/data_file', options%file, 'name of the data file')
    call file%put('provenance/data', data_text, 'text of the data file')
  end subroutine write_provenance

  function libraries() result(text)
    character(len=:), allocatable :: text
    integer :: major, minor, patch

    call ilaver(major, minor, patch)
    text = hdf5_version()//', SUNDIALS '//sundials_version//', LAPACK '//to_text(major)//'.'//to_text(minor)//'.'// &
           to_text(patch)
  end function libraries

  !> Date and time as 2026-01-31T12:00:00+01:00.
  function present_time() result(text)
    character(len=25) :: text
    character(len=10) :: date, time, zone

    call date_and_time(date, time, zone)
    text = date(1:4)//'-'//date(5:6)//'-'//date(7:8)//'T'//time(1:2)//':'//time(3:4)//':'//time(5:6)// &
           zone(1:3)//':'//zone(4:5)
  end function present_time

  !> Write the numbers and units of all coordinates, for files without rows over time.
  subroutine write_coordinates(file, model)
    type(hdf5_file_type), intent(inout) :: file     !< the open file
    type(model_type), intent(in) :: model           !< the model
    type(string_type) :: units(size(model%mechanism%pairs))
    integer :: k

    do k = 1, size(units)
      units(k)%text = trim(unit_name(model%mechanism, k))
    end do
    call file%put('coordinate', [(k, k=1, size(units))], 'number of the coordinate and of its pair')
    call file%make_scale('coordinate')
    call file%put('coordinate_unit', units, 'unit of each coordinate')
    call file%attach_scales('coordinate_unit', ['/coordinate'])
  end subroutine write_coordinates

  !> Write the first and the second set of structural data.
  subroutine write_structure(file, model)
    type(hdf5_file_type), intent(inout) :: file     !< the open file
    type(model_type), intent(in) :: model       !< the model
    type(structural_vectors_type) :: vectors
    integer :: links(2, size(model%mechanism%pairs)), j, k

    do k = 1, size(model%mechanism%pairs)
      links(:, k) = [model%mechanism%pairs(k)%pair%reference, model%mechanism%pairs(k)%pair%moving]
      j = model%mechanism%structure%joint_of(k)
      if (j > 0) links(:, k) = model%mechanism%structure%joints(j)%ends
    end do
    vectors = shown_vectors(model%mechanism%structure, model%problem%partition%vectors)
    associate (structure => model%mechanism%structure, independent => model%problem%partition%independent())
      call file%put('structure/end', [1, 2], 'end of a pair: 1 the reference link, 2 the moving link')
      call file%make_scale('structure/end')
      call file%put('structure/links', links, 'links that each pair joins')
      call file%attach_scales('structure/links', ['/coordinate   ', '/structure/end'])
      call file%put('structure/independent', merge(1, 0, independent), '1 where the coordinate is independent')
      call file%attach_scales('structure/independent', ['/coordinate'])
      call write_matrix(file, structure%shown_links(), links, structure%stands_alone())
      call file%put('structure/position', [(k, k=1, size(vectors%nrg))], 'position in the structural vectors')
      call file%make_scale('structure/position')
      call write_vector(file, 'nrg', vectors%nrg, 'links in the order of the chains')
      call write_vector(file, 'nws', vectors%nws, 'coordinate that leads to the link; 0 where a chain begins')
      call write_vector(file, 'rdw', vectors%rdw, '1 where the coordinate is independent or a chain begins')
      call write_vector(file, 'nrw', vectors%nrw, 'closed chains that are complete')
    end associate
  end subroutine write_structure

  !> Write which components of the recorded wrenches equilibrium determines.
  subroutine write_uniqueness(file, columns, forces)
    type(hdf5_file_type), intent(inout) :: file        !< the open file
    type(columns_type), intent(in) :: columns          !< the columns, with the pairs whose wrenches are recorded
    type(force_record_type), intent(in) :: forces      !< with the components that are unique
    type(string_type) :: components(6)
    integer :: i

    if (.not. allocated(forces%unique) .or. columns%forces() == 0) return
    if (size(columns%reacting) == 0) return
    do i = 1, 6
      components(i)%text = component_names(i)
    end do
    call file%put('component', components, 'component in the axes of the pair''s frame in its moving link, z along its axis')
    call file%make_scale('component')
    call file%put('reaction_unique', merge(1, 0, forces%unique%pairs(:, columns%reacting)), &
                  '1 where equilibrium determines the component; elsewhere that of least norm is given')
    call file%attach_scales('reaction_unique', ['/pair     ', '/component'])
    if (columns%couplings == 0) return
    call file%put('coupling_unique', merge(1, 0, forces%unique%couplings), &
                  '1 where equilibrium determines the force of the coupling; elsewhere that of least norm is given')
    call file%attach_scales('coupling_unique', ['/coupling'])
  end subroutine write_uniqueness

  subroutine write_vector(file, name, values, long_name)
    type(hdf5_file_type), intent(inout) :: file   !< the open file
    character(len=*), intent(in) :: name          !< of the data set
    character(len=*), intent(in) :: long_name     !< its meaning in words
    integer, intent(in) :: values(:)              !< its numbers

    call file%put('structure/'//name, values, long_name)
    call file%attach_scales('structure/'//name, ['/structure/position'])
  end subroutine write_vector

  !> Write the coincidence matrix, unless it is very large or two pairs join the same two links, which it cannot show.
  subroutine write_matrix(file, n_links, links, in_matrix)
    type(hdf5_file_type), intent(inout) :: file   !< the open file
    integer, intent(in) :: n_links                !< number of links
    integer, intent(in) :: links(:, :)            !< (2,M) reference and moving link of each pair
    logical, intent(in) :: in_matrix(:)           !< (M) the coordinate stands in the matrix
    integer, allocatable :: c(:, :)
    integer :: k

    if (n_links > largest_matrix) return
    allocate (c(n_links, n_links), source=0)
    do k = 1, size(links, 2)
      if (.not. in_matrix(k)) cycle
      if (c(links(1, k), links(2, k)) /= 0) return
      c(links(1, k), links(2, k)) = k
      c(links(2, k), links(1, k)) = k
    end do
    call file%put('structure/link', [(k, k=1, n_links)], 'number of the link; 1 is the frame')
    call file%make_scale('structure/link')
    call file%put('structure/other_link', [(k, k=1, n_links)], 'number of the link that it meets')
    call file%make_scale('structure/other_link')
    call file%put('structure/c', c, 'coincidence matrix: the coordinate of the pair that joins two links, or 0')
    call file%attach_scales('structure/c', ['/structure/link      ', '/structure/other_link'])
  end subroutine write_matrix
end module mech9_hdf5_record
