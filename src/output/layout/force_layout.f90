!> The forces that equilibrium determines, as data sets.
module mech9_force_layout
  use mech9_text, only: string_type
  use mech9_columns, only: columns_type
  use mech9_force_record, only: force_record_type
  use mech9_uniqueness, only: component_names
  use mech9_data_set_store, only: data_set_store_type
  implicit none
  private
  public :: write_uniqueness

contains

  !> Write which components of the recorded wrenches equilibrium determines.
  subroutine write_uniqueness(store, columns, forces)
    class(data_set_store_type), intent(inout) :: store        !< the open storage
    type(columns_type), intent(in) :: columns          !< the columns, with the pairs whose wrenches are recorded
    type(force_record_type), intent(in) :: forces      !< with the components that are unique
    type(string_type) :: components(6)
    logical, allocatable :: unique_columns(:, :)
    integer :: i

    if (.not. allocated(forces%unique) .or. columns%forces() == 0) return
    if (size(columns%reacting) == 0) return
    unique_columns = forces%unique%shown(columns%in_links)
    unique_columns = unique_columns(:, columns%reacting)
    do i = 1, 6
      components(i)%text = component_names(i)
    end do
    call store%put('component', components, 'component in the axes of the pair''s frame in its moving link, z along its axis')
    call store%make_scale('component')
    call store%put('reaction_unique', merge(1, 0, forces%unique%pairs(:, columns%reacting)), &
                  '1 where equilibrium determines the component; elsewhere that of least norm is given')
    call store%attach_scales('reaction_unique', ['/pair     ', '/component'])
    call store%put('reaction_column_unique', merge(1, 0, unique_columns), &
                  '1 where equilibrium determines the component along the axes of reaction_force and reaction_moment')
    call store%attach_scales('reaction_column_unique', ['/pair     ', '/component'])
    if (columns%couplings == 0) return
    call store%put('coupling_unique', merge(1, 0, forces%unique%couplings), &
                  '1 where equilibrium determines the force of the coupling; elsewhere that of least norm is given')
    call store%attach_scales('coupling_unique', ['/coupling'])
  end subroutine write_uniqueness
end module mech9_force_layout
