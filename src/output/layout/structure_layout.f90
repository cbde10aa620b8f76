!> The structure of a mechanism as data sets.
module mech9_structure_layout
  use mech9_text, only: string_type
  use mech9_part_names, only: part_names_type, name_in
  use mech9_structural_vectors, only: structural_vectors_type
  use mech9_joint_expansion, only: shown_vectors
  use mech9_model, only: model_type
  use mech9_result_units, only: unit_name
  use mech9_data_set_store, only: data_set_store_type
  implicit none
  private
  public :: write_structure, write_coordinates, write_coordinates_in

  !> Most links with which the coincidence matrix is written; for more links it would be larger than the results.
  integer, parameter :: largest_matrix = 1000

contains

  !> Write the numbers and units of all coordinates, for files without rows over time.
  subroutine write_coordinates(store, model)
    class(data_set_store_type), intent(inout) :: store     !< the open storage
    type(model_type), intent(in) :: model           !< the model
    type(string_type) :: units(size(model%mechanism%pairs))
    integer :: k

    do k = 1, size(units)
      units(k)%text = trim(unit_name(model%mechanism, k))
    end do
    call write_coordinates_in(store, units)
  end subroutine write_coordinates

  !> Write the scale of the coordinates, and their units.
  subroutine write_coordinates_in(store, units)
    class(data_set_store_type), intent(inout) :: store     !< the open storage
    type(string_type), intent(in) :: units(:)              !< (M) of the coordinates
    integer :: k

    call store%put('coordinate', [(k, k=1, size(units))], 'number of the coordinate and of its pair')
    call store%make_scale('coordinate')
    call store%put('coordinate_unit', units, 'unit of each coordinate')
    call store%attach_scales('coordinate_unit', ['/coordinate'])
  end subroutine write_coordinates_in

  !> Write the first and the second set of structural data.
  subroutine write_structure(store, model)
    class(data_set_store_type), intent(inout) :: store     !< the open storage
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
      call store%put('structure/end', [1, 2], 'end of a pair: 1 the reference link, 2 the moving link')
      call store%make_scale('structure/end')
      call store%put('structure/links', links, 'links that each pair joins')
      call store%attach_scales('structure/links', ['/coordinate   ', '/structure/end'])
      call store%put('structure/independent', merge(1, 0, independent), '1 where the coordinate is independent')
      call store%attach_scales('structure/independent', ['/coordinate'])
      call write_matrix(store, structure%shown_links(), links, structure%stands_alone(), model%mechanism%names)
      call store%put('structure/position', [(k, k=1, size(vectors%nrg))], 'position in the structural vectors')
      call store%make_scale('structure/position')
      call write_vector(store, 'nrg', vectors%nrg, 'links in the order of the chains')
      call write_vector(store, 'nws', vectors%nws, 'coordinate that leads to the link; 0 where a chain begins')
      call write_vector(store, 'rdw', vectors%rdw, '1 where the coordinate is independent or a chain begins')
      call write_vector(store, 'nrw', vectors%nrw, 'closed chains that are complete')
    end associate
  end subroutine write_structure

  subroutine write_vector(store, name, values, long_name)
    class(data_set_store_type), intent(inout) :: store   !< the open storage
    character(len=*), intent(in) :: name          !< of the data set
    character(len=*), intent(in) :: long_name     !< its meaning in words
    integer, intent(in) :: values(:)              !< its numbers

    call store%put('structure/'//name, values, long_name)
    call store%attach_scales('structure/'//name, ['/structure/position'])
  end subroutine write_vector

  !> Write the coincidence matrix, unless it is very large or two pairs join the same two links, which it cannot show.
  subroutine write_matrix(store, n_links, links, in_matrix, names)
    class(data_set_store_type), intent(inout) :: store   !< the open storage
    integer, intent(in) :: n_links                !< number of links
    integer, intent(in) :: links(:, :)            !< (2,M) reference and moving link of each pair
    logical, intent(in) :: in_matrix(:)           !< (M) the coordinate stands in the matrix
    type(part_names_type), intent(in) :: names    !< of links
    type(string_type) :: texts(n_links)
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
    call store%put('structure/link', [(k, k=1, n_links)], 'number of the link; 1 is the frame')
    call store%make_scale('structure/link')
    call store%put('structure/other_link', [(k, k=1, n_links)], 'number of the link that it meets')
    call store%make_scale('structure/other_link')
    call store%put('structure/c', c, 'coincidence matrix: the coordinate of the pair that joins two links, or 0')
    call store%attach_scales('structure/c', ['/structure/link      ', '/structure/other_link'])
    if (.not. allocated(names%links)) return
    do k = 1, n_links
      texts(k)%text = trim(name_in(names%links, k))
    end do
    call store%put('structure/link_name', texts, 'name of the link; empty where it has none')
    call store%attach_scales('structure/link_name', ['/structure/link'])
  end subroutine write_matrix
end module mech9_structure_layout
