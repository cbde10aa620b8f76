!> The section of a run as data sets: a data set for each column over its points.
module mech9_section_layout
  use mech9_section_record, only: section_record_type
  use mech9_data_set_store, only: data_set_store_type
  implicit none
  private
  public :: write_section

contains

  !> Write the points of a section; one without points has no data sets.
  subroutine write_section(section, store)
    class(section_record_type), intent(in) :: section          !< the section
    class(data_set_store_type), intent(inout) :: store         !< the open storage
    character(len=:), allocatable :: name
    integer :: i, point

    if (section%count == 0) return
    ! columns before that of the point are those of a study
    do point = 1, size(section%names)
      if (section%names(point) == 'point') exit
    end do
    call store%put('section/point', nint(section%points(point, :section%count)), 'number of the point')
    call store%make_scale('section/point')
    do i = 1, size(section%names)
      if (i == point) cycle
      name = 'section/'//trim(section%names(i))
      call store%put(name, section%points(i, :section%count), 'column '//trim(section%names(i))//' at the points of the section', &
                     trim(section%units(i)))
      call store%attach_scales(name, ['/section/point'])
    end do
  end subroutine write_section
end module mech9_section_layout
