!> Equilibria and modes in reports.
module mech9_equilibria_report
  use mech9_kinds, only: wp, pi
  use mech9_json, only: json_type
  use mech9_rest, only: rest_type
  implicit none
  private
  public :: add_equilibria

contains

  !> Add the equilibria, and the eigenvalues of the modes of the first one where they are wanted.
  subroutine add_equilibria(json, rest, with_modes)
    type(json_type), intent(inout) :: json    !< the report, inside its object
    type(rest_type), intent(in) :: rest       !< the equilibria; none after an error
    logical, intent(in) :: with_modes         !< modes are wanted
    integer :: i

    call json%begin_array('equilibria')
    do i = 1, size(rest%equilibria)
      associate (found => rest%equilibria(i))
        call json%begin_object()
        call json%add('q', found%resting%state%q/found%resting%plan%result_unit)
        call json%add('stable', found%is_stable)
        call json%add('growth', found%modes%growth)
        call json%add('starts', found%found)
        call json%end_object()
      end associate
    end do
    call json%end_array()
    if (.not. with_modes .or. size(rest%equilibria) == 0) return
    call json%begin_array('modes')
    associate (modes => rest%equilibria(1)%modes)
      do i = 1, modes%count
        call json%begin_object()
        call json%add('eigenvalue', [real(modes%roots(i), wp), aimag(modes%roots(i))])
        call json%add('frequency', abs(aimag(modes%roots(i)))/(2.0_wp*pi))
        call json%end_object()
      end do
    end associate
    call json%end_array()
  end subroutine add_equilibria
end module mech9_equilibria_report
