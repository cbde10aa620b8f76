!> Ways of drives: the ends of times within which no drive moves far.
module mech9_drive_ways
  use mech9_kinds, only: wp
  use mech9_law, only: drive_slot_type, repetition_type, unknown_repetition, repeats_after
  use mech9_plan, only: plan_type
  implicit none
  private
  public :: short_ways_type, end_of_way

  !> A time of the motion whose short parts are known to be short ways. It saves the search for the end of each of many equal steps.
  type :: short_ways_type
    real(wp) :: longest = 0.0_wp                             !< longest way of a drive, in the unit of its coordinate
    real(wp), private :: from = 0.0_wp, to = 0.0_wp          !< the time, in the direction of the motion [s]
    real(wp), private :: longest_step = 0.0_wp               !< parts of it that are no longer are short ways [s]
    integer, private :: until_search = 0                     !< so many ways are found by themselves before a time is looked for again
  contains
    procedure :: end_of_next
    procedure :: knows
  end type short_ways_type

  !> Halvings of a longer way.
  integer, parameter :: most_halvings = 60
  !> A way is at most this part of the period of a drive, which may be far smaller than the unit of its coordinate.
  real(wp), parameter :: part_of_period = 0.125_wp
  !> The time ahead that is looked at, in ways, and the number of ways behind a vain look.
  integer, parameter :: ways_ahead = 64

contains

  !> The end of the next way towards a time, as end_of_way finds it.
  real(wp) function end_of_next(self, drives, plan, from, t) result(next)
    class(short_ways_type), intent(inout) :: self    !< the known ways
    type(drive_slot_type), intent(in) :: drives(:)   !< (n) the drives
    type(plan_type), intent(in) :: plan              !< the plan of the mechanism
    real(wp), intent(in) :: from                     !< start of the way [s]
    real(wp), intent(in) :: t                        !< the time [s]

    next = t
    if (self%knows(from, t)) return
    next = end_of_way(drives, plan, self%longest, from, t)
    if (abs(t - next) > 0.0_wp) return
    self%until_search = self%until_search - 1
    if (self%until_search > 0) return
    self%until_search = ways_ahead
    self%from = from
    self%to = from + ways_ahead*(t - from)
    self%longest_step = longest_part(drives, plan, self%longest, self%from, self%to)
    if (self%knows(from, t)) self%until_search = 0
  end function end_of_next

  !> Whether a way lies within the known time and is short.
  pure logical function knows(self, from, t)
    class(short_ways_type), intent(in) :: self       !< the known ways
    real(wp), intent(in) :: from                     !< start of the way [s]
    real(wp), intent(in) :: t                        !< its end [s]

    knows = abs(t - from) <= self%longest_step .and. (from - self%from)*(self%to - from) >= 0.0_wp &
            .and. (t - self%from)*(self%to - t) >= 0.0_wp
  end function knows

  !> The end of a way towards a time, on which no drive moves farther than a given way, turns back twice, or passes a joint of its law.
  real(wp) function end_of_way(drives, plan, longest, from, t) result(next)
    type(drive_slot_type), intent(in) :: drives(:)   !< (n) the drives
    type(plan_type), intent(in) :: plan              !< the plan of the mechanism
    real(wp), intent(in) :: longest                  !< longest way of a drive, in the unit of its coordinate
    real(wp), intent(in) :: from                     !< start of the way [s]
    real(wp), intent(in) :: t                        !< the time [s]
    type(repetition_type) :: repetition
    real(wp) :: h, joint
    integer :: halving, i

    h = t - from
    next = t
    do i = 1, size(drives)
      associate (drive => drives(i)%drive)
        repetition = drive%repetition()
        if (repetition%kind == repeats_after) h = sign(min(abs(h), part_of_period*repetition%period), h)
        joint = drive%next_joint(from, sign(1.0_wp, h)) - from
        if (abs(joint) < abs(h)) h = joint
      end associate
    end do
    do halving = 1, most_halvings
      if (farthest_way(drives, plan, from, h) <= longest) exit
      h = 0.5_wp*h
    end do
    if (abs(h) < abs(t - from) .and. abs(from + h - from) > 0.0_wp) next = from + h
  end function end_of_way

  !> A length of parts of a time that are short ways wherever they lie in it; zero where a law has a joint within the time, or
  !> a formula that is not known [s].
  real(wp) function longest_part(drives, plan, longest, from, to)
    type(drive_slot_type), intent(in) :: drives(:)   !< (n) the drives
    type(plan_type), intent(in) :: plan              !< the plan of the mechanism
    real(wp), intent(in) :: longest                  !< longest way of a drive, in the unit of its coordinate
    real(wp), intent(in) :: from                     !< start of the time [s]
    real(wp), intent(in) :: to                       !< its end [s]
    type(repetition_type) :: repetition
    real(wp) :: h, way
    integer :: i

    h = to - from
    longest_part = abs(h)
    way = farthest_way(drives, plan, from, h)
    if (way > longest) longest_part = longest_part*(longest/way)
    do i = 1, size(drives)
      associate (drive => drives(i)%drive)
        repetition = drive%repetition()
        if (repetition%kind == repeats_after) longest_part = min(longest_part, part_of_period*repetition%period)
        if (repetition%kind == unknown_repetition .or. abs(drive%next_joint(from, sign(1.0_wp, h)) - from) < abs(h)) &
          longest_part = 0.0_wp
      end associate
    end do
  end function longest_part

  !> A bound of the way of all drives within a time, in the units of their coordinates.
  real(wp) function farthest_way(drives, plan, from, h) result(way)
    type(drive_slot_type), intent(in) :: drives(:)   !< (n) the drives
    type(plan_type), intent(in) :: plan              !< the plan of the mechanism
    real(wp), intent(in) :: from                     !< start of the time [s]
    real(wp), intent(in) :: h                        !< its length, with its sign [s]
    integer :: i

    way = 0.0_wp
    do i = 1, size(drives)
      associate (drive => drives(i)%drive)
        way = max(way, abs(h)*drive%greatest_rate(from, h)/plan%unit_of(drive%coordinate))
      end associate
    end do
  end function farthest_way
end module mech9_drive_ways
