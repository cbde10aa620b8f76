!> Notes on drives whose rates or accelerations jump.
module mech9_law_notes
  use mech9_named_words, only: with_names
  use mech9_part_names, only: part_names_type
  use mech9_kinds, only: wp
  use mech9_error, only: error_type
  use mech9_text, only: to_text
  use mech9_counted, only: counted
  use mech9_law, only: law_type, from_inside
  use mech9_model, only: model_type
  implicit none
  private
  public :: print_jumps

  !> Times that a note shows, and joints that are looked at, at most.
  integer, parameter :: most_times = 6, most_joints = 1000
  !> A change is a jump where it exceeds this part of the greatest rate, or of the largest acceleration beside joints.
  real(wp), parameter :: least_jump = 1.0e-6_wp
  !> No drive jumps in a run that is shorter: rates over such a time have no place among the numbers [s].
  real(wp), parameter :: least_duration = sqrt(tiny(1.0_wp))

contains

  !> Write a line for each drive whose rate jumps in the time of the run, and for each whose acceleration does.
  subroutine print_jumps(unit, model)
    integer, intent(in) :: unit             !< Fortran unit to write to
    type(model_type), intent(in) :: model   !< the model
    integer :: i

    do i = 1, size(model%problem%drives)
      call print_jumps_of(unit, model%mechanism%names, model%problem%drives(i)%drive, model%request%time%start, &
                          model%request%time%end)
    end do
  end subroutine print_jumps

  !> Print the lines for one drive.
  subroutine print_jumps_of(unit, names, drive, start, end)
    integer, intent(in) :: unit             !< Fortran unit to write to
    type(part_names_type), intent(in) :: names   !< of links and pairs
    class(law_type), intent(in) :: drive    !< the drive
    real(wp), intent(in) :: start           !< time of the start [s]
    real(wp), intent(in) :: end             !< time of the end [s]
    real(wp) :: times(most_joints), before(3), behind(3), changes(2, most_joints), largest(2)
    real(wp) :: direction
    type(error_type), allocatable :: err, failure
    integer :: n

    if (abs(end - start) < least_duration) return
    direction = sign(1.0_wp, end - start)
    ! rates that differ by round-off do not jump
    largest(1) = drive%greatest_rate(start, end - start)
    largest(2) = largest(1)/abs(end - start)
    n = 0
    do while (n < most_joints)
      times(n + 1) = drive%next_joint(merge(start, times(max(n, 1)), n == 0), direction)
      if (.not. (end - times(n + 1))*direction >= 0.0_wp) exit
      call drive%evaluate(from_inside(times(n + 1), -direction), before(1), before(2), before(3), err)
      call drive%evaluate(from_inside(times(n + 1), direction), behind(1), behind(2), behind(3), failure)
      if (allocated(err) .or. allocated(failure)) exit
      n = n + 1
      changes(:, n) = abs(behind(2:) - before(2:))
      largest(2) = max(largest(2), abs(before(3)), abs(behind(3)))
    end do
    call print_times(unit, names, drive, 'rate', pack(times(:n), changes(1, :n) > least_jump*largest(1)))
    call print_times(unit, names, drive, 'acceleration', pack(times(:n), changes(2, :n) > least_jump*largest(2) .and. &
                                                              .not. changes(1, :n) > least_jump*largest(1)))
  end subroutine print_jumps_of

  !> Print one line with the times of jumps; none where there are none.
  subroutine print_times(unit, names, drive, name, times)
    integer, intent(in) :: unit             !< Fortran unit to write to
    type(part_names_type), intent(in) :: names   !< of links and pairs
    class(law_type), intent(in) :: drive    !< the drive
    character(len=*), intent(in) :: name    !< of the quantity that jumps
    real(wp), intent(in) :: times(:)        !< when it jumps [s]
    character(len=:), allocatable :: list
    integer :: i

    if (size(times) == 0) return
    list = to_text(times(1), 8)
    do i = 2, min(size(times), most_times)
      list = list//', '//to_text(times(i), 8)
    end do
    if (size(times) > most_times) list = list//' and '//counted(size(times) - most_times, 'later time')//','
    write (unit, '(a)') with_names(names, 'note: the '//name//' of the '//trim(drive%owner())//' jumps at t = '//list//' s')
  end subroutine print_times
end module mech9_law_notes
