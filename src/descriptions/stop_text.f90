!> Stops in a check: their ends, and the gaps that are left to them at the start.
module mech9_stop_text
  use mech9_named_words, only: with_names
  use mech9_kinds, only: wp
  use mech9_text, only: to_text
  use mech9_mechanism, only: mechanism_type
  use mech9_result_units, only: unit_of, unit_name
  use mech9_state, only: state_type
  implicit none
  private
  public :: print_stops

contains

  !> Print all stops; nothing where there are none.
  subroutine print_stops(unit, mechanism, start)
    integer, intent(in) :: unit                        !< the output unit
    type(mechanism_type), intent(in) :: mechanism      !< the mechanism
    type(state_type), intent(in) :: start              !< assembled position
    character(len=4), parameter :: names(2) = ['low ', 'high']
    character(len=5), parameter :: sides(2) = ['above', 'below']
    character(len=:), allocatable :: words, of
    real(wp) :: gap, in_unit
    integer :: i, end

    if (size(mechanism%stops) == 0) return
    write (unit, '(a)') 'stops at the start:'
    do i = 1, size(mechanism%stops)
      associate (stop => mechanism%stops(i))
        in_unit = unit_of(mechanism, stop%coordinate)
        of = ' '//trim(unit_name(mechanism, stop%coordinate))
        words = ''
        do end = 1, 2
          if (.not. stop%has_end(end)) cycle
          gap = stop%gap(end, start%q(stop%coordinate))
          if (words /= '') words = words//' and '
          words = words//to_text(abs(gap)/in_unit, 6)//of//' '//trim(merge('beyond    ', sides(end)//'     ', gap < 0.0_wp))// &
                  ' its '//trim(names(end))//' end, '//to_text(stop%ends(end)/in_unit, 6)//of
        end do
        if (stop%is_rigid) then
          words = words//'; restitution '//to_text(stop%restitution, 4)
        else
          words = words//'; compliant'
        end if
        write (unit, '(2x,a)') with_names(mechanism%names, 'stop '//to_text(i)//': coordinate '//to_text(stop%coordinate)// &
                                                           ' is '//words)
      end associate
    end do
  end subroutine print_stops
end module mech9_stop_text
