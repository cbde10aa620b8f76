!> The least value of a number along a part of a motion of a design, with its derivatives by the parameters.
!>
!> At a least value within the part the derivative in time is zero, and at an end of the part the time is fixed. So the derivatives of
!> the least value by the parameters are those of the number at its time (envelope theorem).
module mech9_course_extreme
  use mech9_kinds, only: wp
  use mech9_error, only: error_type
  use mech9_plan, only: new_state
  use mech9_state, only: state_type
  use mech9_driven_motion, only: driven_motion_type, start_driven_motion, advance
  use mech9_design_space, only: design_type
  use mech9_open_position, only: open_position_type
  use mech9_branch, only: close_near, follow
  implicit none
  private
  public :: course_number_type, course_place_type, sample_course, find_least

  !> A number at a time of a motion.
  type :: course_place_type
    real(wp) :: t = 0.0_wp                !< time [s]
    real(wp), allocatable :: q(:)         !< (M) coordinates [rad, m]
    real(wp) :: value = 0.0_wp            !< the number
    real(wp) :: by_t = 0.0_wp             !< its derivative by time [1/s]
    real(wp), allocatable :: by_x(:)      !< (P) its derivatives by the parameters at this time
  end type course_place_type

  !> A smooth number of a closed position.
  type, abstract :: course_number_type
  contains
    procedure(find_interface), deferred :: find
  end type course_number_type

  abstract interface
    !> The number at the time and the coordinates of a place, and its derivatives.
    subroutine find_interface(self, design, position, place, found)
      import :: course_number_type, design_type, open_position_type, course_place_type
      class(course_number_type), intent(in) :: self            !< the number
      type(design_type), intent(in) :: design                  !< placed, with its tangents
      type(open_position_type), intent(inout) :: position      !< scratch
      type(course_place_type), intent(inout) :: place          !< with time and coordinates; gets the number
      logical, intent(out) :: found                            !< it exists
    end subroutine find_interface
  end interface

  integer, parameter :: refinements = 20           !< most steps to an extreme
  real(wp), parameter :: stationary = 1.0e-10_wp   !< a derivative in time that is zero, as a part of those beside the extreme

contains

  !> The number at equal intervals of a motion.
  subroutine sample_course(number, design, position, q_start, times, places, found)
    class(course_number_type), intent(in) :: number          !< the number
    type(design_type), intent(in) :: design                  !< placed, with its tangents
    type(open_position_type), intent(inout) :: position      !< scratch
    real(wp), intent(in) :: q_start(:)                       !< (M) coordinates near the start [rad, m]
    real(wp), intent(in) :: times(2)                         !< of start and end [s]
    type(course_place_type), intent(inout) :: places(0:)     !< gets times, coordinates and numbers
    logical, intent(out) :: found                            !< the motion comes to its end
    type(driven_motion_type) :: driven
    type(state_type) :: state
    type(error_type), allocatable :: err
    integer :: i

    state = new_state(design%plan)
    state%q = q_start
    call close_near(design, times(1), state, found)
    if (.not. found) return
    call start_driven_motion(design%drives, design%plan, state, times(1), driven, err, derivatives=0)
    do i = 0, ubound(places, 1)
      places(i)%t = times(1) + (times(2) - times(1))*i/ubound(places, 1)
      if (i > 0 .and. .not. allocated(err)) call advance(design%drives, design%plan, driven, places(i)%t, err)
      found = .not. allocated(err)
      if (.not. found) return
      places(i)%q = driven%state%q
      call number%find(design, position, places(i), found)
      if (.not. found) return
    end do
  end subroutine sample_course

  !> The least value of the number, or of its negative, over samples of a part of a motion and between them.
  subroutine find_least(number, sign_of, design, position, places, least)
    class(course_number_type), intent(in) :: number          !< the number
    real(wp), intent(in) :: sign_of                          !< 1 for the least number, -1 for the largest
    type(design_type), intent(in) :: design                  !< placed, with its tangents
    type(open_position_type), intent(inout) :: position      !< scratch
    type(course_place_type), intent(in) :: places(:)         !< samples in their order in time
    type(course_place_type), intent(out) :: least            !< the place of the least value
    real(wp) :: downhill
    integer :: i

    i = minloc(sign_of*places%value, dim=1)
    least = places(i)
    ! the extreme lies towards the side to which the number still decreases
    downhill = -sign_of*places(i)%by_t*(places(size(places))%t - places(1)%t)
    if (downhill > 0.0_wp .and. i < size(places)) then
      call refine(number, sign_of, design, position, places(i), places(i + 1), least)
    else if (downhill < 0.0_wp .and. i > 1) then
      call refine(number, sign_of, design, position, places(i), places(i - 1), least)
    end if
  end subroutine find_least

  !> Find an extreme between two places by the zero of the derivative in time, which is kept between two places.
  subroutine refine(number, sign_of, design, position, first, last, least)
    class(course_number_type), intent(in) :: number          !< the number
    real(wp), intent(in) :: sign_of                          !< 1 for the least number, -1 for the largest
    type(design_type), intent(in) :: design                  !< placed, with its tangents
    type(open_position_type), intent(inout) :: position      !< scratch
    type(course_place_type), intent(in) :: first             !< a place from which the extreme lies towards the other one
    type(course_place_type), intent(in) :: last              !< the other one
    type(course_place_type), intent(inout) :: least          !< gets the extreme
    type(course_place_type) :: middle
    real(wp) :: ends(2), slopes(2), largest
    logical :: found
    integer :: i, kept

    ! the Illinois method (Dowell and Jarratt 1971): regula falsi, which counts half the value of an end that is kept twice
    ends = [first%t, last%t]
    slopes = [first%by_t, last%by_t]
    largest = maxval(abs(slopes))
    middle = first
    kept = 0
    do i = 1, refinements
      if (.not. slopes(1)*slopes(2) < 0.0_wp) exit
      if (i > 1) then
        if (abs(middle%by_t) <= stationary*largest) exit
      end if
      call go_to(ends(1) - slopes(1)*(ends(2) - ends(1))/(slopes(2) - slopes(1)))
      if (.not. found) exit
      if (sign_of*middle%value <= sign_of*first%value) least = middle
      if (middle%by_t*slopes(1) > 0.0_wp) then
        call keep_end(2)
      else
        call keep_end(1)
      end if
    end do
    if (sign_of*last%value < sign_of*least%value) least = last
  contains
    !> Go on to a time, and find the number there.
    subroutine go_to(t)
      real(wp), intent(in) :: t   !< the time [s]

      call follow(design, middle%t, t, middle%q, found)
      middle%t = t
      if (found) call number%find(design, position, middle, found)
    end subroutine go_to

    !> Replace one end by the place that was found last.
    subroutine keep_end(k)
      integer, intent(in) :: k    !< number of the end that is kept

      ends(3 - k) = middle%t
      slopes(3 - k) = middle%by_t
      if (kept == k) slopes(k) = 0.5_wp*slopes(k)
      kept = k
    end subroutine keep_end
  end subroutine refine
end module mech9_course_extreme
