!> Facts about a run in an HDF5 file.
module mech9_hdf5_facts
  use mech9_facts, only: facts_type, a_number, a_count, a_text
  use mech9_hdf5_file, only: hdf5_file_type
  implicit none
  private
  public :: put_facts

contains

  !> Write each fact as a data set of a group. The call before a run makes the data sets; the call after the run changes only
  !> numbers in their places, so that the file is whole whenever the run is killed. Texts stay as they were.
  subroutine put_facts(facts, file, group, again)
    type(facts_type), intent(in) :: facts        !< the facts
    type(hdf5_file_type), intent(inout) :: file  !< the open file
    character(len=*), intent(in) :: group        !< path of the group in the file
    logical, intent(in) :: again                 !< whether the data sets exist already, with other values
    integer :: i

    do i = 1, facts%count
      associate (item => facts%items(i))
        select case (item%kind)
        case (a_number)
          call file%put(group//'/'//item%name, item%number, item%long_name, item%unit)
        case (a_count)
          call file%put(group//'/'//item%name, item%whole, item%long_name)
        case (a_text)
          if (.not. again) call file%put(group//'/'//item%name, item%text, item%long_name)
        end select
      end associate
    end do
  end subroutine put_facts
end module mech9_hdf5_facts
