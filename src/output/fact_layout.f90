!> Facts about a run as data sets.
module mech9_fact_layout
  use mech9_facts, only: facts_type, a_number, a_count, a_text
  use mech9_data_set_store, only: data_set_store_type
  implicit none
  private
  public :: put_facts, put_diagnostics

contains

  !> Write each fact as a data set of a group. The call before a run makes the data sets; the call after the run changes only
  !> numbers in their places, so that the file is whole whenever the run is killed. Texts stay as they were.
  subroutine put_facts(facts, store, group, again)
    type(facts_type), intent(in) :: facts        !< the facts
    class(data_set_store_type), intent(inout) :: store  !< the open storage
    character(len=*), intent(in) :: group        !< path of the group
    logical, intent(in) :: again                 !< whether the data sets exist already, with other values
    integer :: i

    do i = 1, facts%count
      associate (item => facts%items(i))
        select case (item%kind)
        case (a_number)
          call store%put(group//'/'//item%name, item%number, item%long_name, item%unit)
        case (a_count)
          call store%put(group//'/'//item%name, item%whole, item%long_name)
        case (a_text)
          if (.not. again) call store%put(group//'/'//item%name, item%text, item%long_name)
        end select
      end associate
    end do
  end subroutine put_facts

  !> Write the facts about a run in its group, before the run and again after it.
  subroutine put_diagnostics(facts, store, exit_code)
    type(facts_type), intent(in) :: facts                !< the facts
    class(data_set_store_type), intent(inout) :: store   !< the open storage
    integer, intent(in), optional :: exit_code           !< of the run; not given before its end is known
    integer :: code

    call put_facts(facts, store, 'diagnostics', again=present(exit_code))
    code = -1
    if (present(exit_code)) code = exit_code
    call store%put('diagnostics/exit_code', code, 'what the program answered to the shell; -1: the run did not end')
  end subroutine put_diagnostics
end module mech9_fact_layout
