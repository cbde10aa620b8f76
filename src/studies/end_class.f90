!> Classes of the ends of runs: what a motion goes to, among what the motions of a study go to.
!>
!> The states at the last points of a section repeat after one, two or more points where a motion is periodic. Runs belong to one class
!> where they go through the same states. Without a section a motion that has come to rest belongs to the class of its position.
module mech9_end_class
  use mech9_kinds, only: wp
  implicit none
  private
  public :: end_classes_type, find_cycle, find_rest

  !> States agree within a cycle, and between runs, up to these parts of their units: motions approach their ends, and never reach them.
  real(wp), parameter :: same_in_cycle = 1.0e-3_wp, same_class = 1.0e-2_wp
  !> A motion rests where it would go less than this part of the units in the time of the whole run.
  real(wp), parameter :: rests = 1.0e-2_wp
  !> Points in a cycle, and least number of comparisons that show one where there are so many points.
  integer, parameter :: longest_cycle = 32, enough_comparisons = 4

  !> The states of a cycle.
  type :: cycle_type
    real(wp), allocatable :: states(:, :)   !< (2 M,points) coordinates, then rates times the time between points [rad, m]
    real(wp), allocatable :: unit(:)        !< (2 M) that counts as one of them [rad, m]
  end type cycle_type

  !> The classes of the runs so far, in the order in which they came.
  type :: end_classes_type
    type(cycle_type), allocatable, private :: cycles(:)
  contains
    procedure :: class_of
  end type end_classes_type

contains

  !> Find the cycle at the end of states, one state at most where it is of period 1; it has no states where none is found.
  pure subroutine find_cycle(states, unit, turns, cycle)
    real(wp), intent(in) :: states(:, :)                   !< (2 M,points) [rad, m]
    real(wp), intent(in) :: unit(:)                        !< (2 M) that counts as one [rad, m]
    logical, intent(in) :: turns(:)                        !< (2 M) an angle, of which whole turns do not count
    real(wp), allocatable, intent(out) :: cycle(:, :)      !< (2 M,points of the cycle)
    real(wp) :: allowed(size(states, 1))
    integer :: n, k, j, m

    n = size(states, 2)
    allowed = same_in_cycle*max(unit, maxval(abs(states), dim=2))
    where (turns) allowed = same_in_cycle
    do k = 1, min(n/2, longest_cycle)
      m = min(max(k, enough_comparisons), n - k)
      if (all([(agree(states(:, n - j), states(:, n - j - k), turns, allowed), j=0, m - 1)])) then
        cycle = states(:, n - k + 1:)
        return
      end if
    end do
    allocate (cycle(size(states, 1), 0))
  end subroutine find_cycle

  !> Find the cycle of a motion that has come to rest; it has no states where the motion goes on.
  pure subroutine find_rest(q, way, unit, cycle)
    real(wp), intent(in) :: q(:)                           !< (M) coordinates [rad, m]
    real(wp), intent(in) :: way(:)                         !< (M) rates times the duration of the run [rad, m]
    real(wp), intent(in) :: unit(:)                        !< (M) that counts as one [rad, m]
    real(wp), allocatable, intent(out) :: cycle(:, :)      !< (2 M,1) or without states

    if (any(abs(way) > rests*unit)) then
      allocate (cycle(2*size(q), 0))
    else
      cycle = reshape([q, 0.0_wp*q], [2*size(q), 1])
    end if
  end subroutine find_rest

  !> The number of the class to which a motion belongs; 0: it has no cycle. A new one gets the next number.
  integer function class_of(self, states, unit, turns) result(number)
    class(end_classes_type), intent(inout) :: self   !< the classes so far
    real(wp), intent(in) :: states(:, :)             !< (2 M,points) of its cycle [rad, m]
    real(wp), intent(in) :: unit(:)                  !< (2 M) that counts as one [rad, m]
    logical, intent(in) :: turns(:)                  !< (2 M) an angle, of which whole turns do not count
    real(wp) :: allowed(size(states, 1))
    integer :: i, k

    number = 0
    k = size(states, 2)
    if (k == 0) return
    if (.not. allocated(self%cycles)) allocate (self%cycles(0))
    do number = 1, size(self%cycles)
      associate (known => self%cycles(number)%states, one => self%cycles(number)%unit)
        if (size(known, 2) /= k .or. size(known, 1) /= size(states, 1)) cycle
        allowed = same_class*max(one, maxval(abs(known), dim=2))
        where (turns) allowed = same_class
        if (any([(agree(states(:, k), known(:, i), turns, allowed), i=1, k)])) return
      end associate
    end do
    call append_cycle(states, unit, self%cycles)
  end function class_of

  !> Append a cycle. By hand: an array constructor would leak (gfortran 12).
  subroutine append_cycle(states, unit, cycles)
    real(wp), intent(in) :: states(:, :)                          !< (2 M,points) of the cycle [rad, m]
    real(wp), intent(in) :: unit(:)                               !< (2 M) that counts as one [rad, m]
    type(cycle_type), allocatable, intent(inout) :: cycles(:)     !< gets it
    type(cycle_type), allocatable :: all(:)
    integer :: i, n

    n = size(cycles)
    allocate (all(n + 1))
    do i = 1, n
      call move_alloc(cycles(i)%states, all(i)%states)
      call move_alloc(cycles(i)%unit, all(i)%unit)
    end do
    all(n + 1)%states = states
    all(n + 1)%unit = unit
    call move_alloc(all, cycles)
  end subroutine append_cycle

  !> Whether two states agree.
  pure logical function agree(a, b, turns, allowed)
    real(wp), intent(in) :: a(:)         !< (2 M) one state [rad, m]
    real(wp), intent(in) :: b(:)         !< (2 M) the other one [rad, m]
    logical, intent(in) :: turns(:)      !< (2 M) an angle, of which whole turns do not count
    real(wp), intent(in) :: allowed(:)   !< (2 M) how far they may differ [rad, m]
    real(wp), parameter :: turn = 8.0_wp*atan(1.0_wp)
    real(wp) :: difference(size(a))

    difference = a - b
    where (turns) difference = difference - turn*anint(difference/turn)
    agree = all(abs(difference) <= allowed)
  end function agree
end module mech9_end_class
