!> The rate at which a pair that sticks comes to the bound of its friction.
module mech9_release_rate
  use mech9_kinds, only: wp
  use mech9_error, only: error_type
  use mech9_event_tolerances, only: known_use_rate
  use mech9_differentiation, only: half_width, step_count, trial_step, best_slopes_type
  use mech9_motion_system, only: motion_system_type
  implicit none
  private
  public :: find_use_rate

contains

  !> Find the rate at which a pair that sticks comes to its bound, by differences along the tangent of the motion, on which the system then
  !> stands again where it stood.
  subroutine find_use_rate(system, number, rate, found, err)
    class(motion_system_type), intent(inout) :: system     !< the system, with its motion
    integer, intent(in) :: number                          !< of the friction
    real(wp), intent(out) :: rate                          !< of the part of its bound that it needs [1/s]
    logical, intent(out) :: found                          !< it was found
    type(error_type), allocatable, intent(out) :: err      !< allocated if the system cannot stand there again
    type(best_slopes_type) :: best
    type(error_type), allocatable :: failure
    real(wp) :: y(system%size_of_vector()), ydot(system%size_of_vector()), values(1, -half_width:half_width), t, h, scale
    integer :: i, trial
    logical :: good

    t = system%state%t
    y = system%vector()
    call system%rate(t, y, ydot, err)
    if (allocated(err)) return
    associate (time => system%model%request%time, state => system%state, units => system%plan%unit_of)
      scale = 1.0_wp/max(maxval(abs(state%dq)/units), sqrt(maxval(abs(state%ddq)/units)), 1.0_wp/max(abs(time%end - time%start), &
                                                                                                   tiny(t)))
    end associate
    good = .false.
    do trial = 1, step_count
      h = trial_step(trial, scale)
      ! laws of time have other numbers beyond their joints
      if (.not. (is_inside(t - half_width*h) .and. is_inside(t + half_width*h))) cycle
      do i = -half_width, half_width
        call system%move_to(t + i*h, y + i*h*ydot, failure)
        if (allocated(failure)) exit
        values(1, i) = abs(system%friction%balance%utilization(number))
      end do
      if (allocated(failure)) cycle
      call best%offer(values, h, good)
      if (good) exit
    end do
    found = allocated(best%slopes)
    rate = 0.0_wp
    if (found) found = best%error <= known_use_rate*maxval(abs(best%slopes))
    if (allocated(best%slopes)) rate = best%slopes(1)
    call system%move_to(t, y, err)
  contains
    !> Whether a time lies within the interval in which laws of time are smooth.
    pure logical function is_inside(at)
      real(wp), intent(in) :: at   !< the time [s]

      is_inside = .not. abs(system%interval%time_inside(at) - at) > 0.0_wp
    end function is_inside
  end subroutine find_use_rate
end module mech9_release_rate
