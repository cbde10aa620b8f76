!> The passing of a joint of the laws of time, at which rates and derivatives may jump.
!>
!> Jumps d of the rates of driven coordinates change those of the free ones by the impulse of the drives, -a_ff^-1 a_fd d.
!> Derivatives s' of rates by parameters then change by the impulse that belongs to the jump of the driven s', and by the derivative of
!> the impulse itself. Accelerations that jump at a time which depends on a parameter let the driven s' jump as well, by their jump
!> times the derivative of the time; the free ones follow by the same equation. This is the jump condition (saltation) of R. I. Leine
!> and H. Nijmeijer, Dynamics and Bifurcations of Non-Smooth Mechanical Systems, Springer 2004.
module mech9_joint_passing
  use mech9_kinds, only: wp
  use mech9_integration_tolerances, only: round_off_of_jumps
  use mech9_error, only: error_type, raise, exit_singular
  use mech9_integration_failures, only: failure_jump_sensitivity
  use mech9_state, only: state_type, copy_state
  use mech9_lagrange, only: find_equations, complete_accelerations
  use mech9_frame_motion, only: place_all
  use mech9_drive_impulse, only: find_impulse
  use mech9_varied_motion, only: vary_drives
  use mech9_motion_system, only: motion_system_type
  implicit none
  private
  public :: pass_joint

contains

  !> Pass a joint of the laws. Fails where rates jump at a time that depends on a parameter by which derivatives are integrated.
  subroutine pass_joint(system, t, y, err, of_held)
    class(motion_system_type), intent(inout) :: system  !< the motion system, afterwards in the interval behind the joint
    real(wp), intent(in) :: t                           !< time of the joint [s]
    real(wp), intent(inout) :: y(:)                     !< the vector there; rates and derivatives may change
    type(error_type), allocatable, intent(out) :: err   !< allocated if it failed
    real(wp), intent(out) :: of_held(:)                 !< (M) jumps of coordinates that stops hold, as if nothing held them [rad/s, m/s]
    real(wp) :: jumps(system%plan%n_coordinates, 1)
    real(wp), allocatable :: varied(:, :, :)
    real(wp) :: duration
    logical :: rates_jump
    integer :: i

    call system%take_vector(t, y, err)
    if (allocated(err)) return
    duration = abs(system%model%request%time%end - system%model%request%time%start)
    jumps(:, 1) = -system%state%dq
    call vary_laws(system, varied)
    ! the interval begins at the joint, also where the last step ended a little before it
    call system%interval%begin(system%model, merge(system%interval%ahead, t, system%interval%is_before_end(t)))
    call system%take_vector(t, y, err)
    if (allocated(err)) return
    jumps(:, 1) = merge(jumps(:, 1) + system%state%dq, 0.0_wp, system%plan%driven)
    rates_jump = any(abs(jumps(:, 1))*duration > round_off_of_jumps*system%plan%unit_of)
    of_held = 0.0_wp
    if (maxval(abs(jumps)) > 0.0_wp) then
      if (allocated(system%held)) then
        call find_impulse(system%model, system%plan, system%dynamics, system%state, system%work, jumps, err, &
                          system%held%coordinate)
        do i = 1, size(system%held)
          ! round-off of laws without a jump of their rates must not loosen a pair that sticks
          associate (k => system%held(i)%coordinate, time => system%model%request%time)
            if (abs(jumps(k, 1))*abs(time%end - time%start) > round_off_of_jumps*system%plan%unit_of(k)) of_held(k) = jumps(k, 1)
          end associate
        end do
      else
        call find_impulse(system%model, system%plan, system%dynamics, system%state, system%work, jumps, err)
      end if
    end if
    if (.not. allocated(err)) call pass_varied(system, varied, jumps(:, 1), rates_jump, y, err)
    if (allocated(err)) return
    associate (n => system%plan%n_coordinates, free => system%plan%free)
      y(n + 1:n + size(free)) = y(n + 1:n + size(free)) + jumps(free, 1)
    end associate
    do i = 1, size(system%drives)
      associate (k => system%drives(i)%drive%coordinate)
        y(k) = system%state%q(k)
      end associate
    end do
  end subroutine pass_joint

  !> The derivatives of driven coordinates by parameters, which their laws give.
  subroutine vary_laws(system, varied)
    class(motion_system_type), intent(in) :: system          !< the motion system, at the time of its state
    real(wp), allocatable, intent(out) :: varied(:, :, :)    !< (P,0:2,M); not allocated where none are integrated

    if (.not. allocated(system%sensitivity)) return
    allocate (varied(system%sensitivity%motion%n_parameters, 0:2, system%plan%n_coordinates))
    call vary_drives(system%model, system%sensitivity%motion, system%state%t, varied)
  end subroutine vary_laws

  !> Change the derivatives of the free rates. Does nothing where none are integrated.
  subroutine pass_varied(system, before, jump, rates_jump, y, err)
    class(motion_system_type), intent(inout) :: system       !< the motion system, behind a joint, with its frames
    real(wp), allocatable, intent(in) :: before(:, :, :)     !< (P,0:2,M) derivatives of the driven coordinates before it
    real(wp), intent(in) :: jump(:)                          !< (M) of the independent rates
    logical, intent(in) :: rates_jump                        !< the jump is more than round-off
    real(wp), intent(inout) :: y(:)                          !< the vector; its derivatives change
    type(error_type), allocatable, intent(out) :: err        !< allocated if it failed
    real(wp), allocatable :: behind(:, :, :), jumps(:, :), changes(:, :)
    integer :: p

    if (.not. allocated(before)) return
    call vary_laws(system, behind)
    do p = 1, size(behind, 1)
      if (.not. rates_jump) exit
      if (all(abs(behind(p, 0, :) - before(p, 0, :)) <= &
              round_off_of_jumps*system%sensitivity%size_of(p)*system%plan%unit_of)) cycle
      call raise(err, exit_singular, failure_jump_sensitivity)
      err%failure%t = system%state%t
      err%failure%name = system%model%parameters(p)%name
      err%place = system%model%parameters(p)%place
      return
    end do
    jumps = transpose(behind(:, 1, :) - before(:, 1, :))
    changes = 0.0_wp*system%sensitivity%values(:, :, 1)
    if (any(abs(jumps) > 0.0_wp)) then
      call find_impulse(system%model, system%plan, system%dynamics, system%state, system%work, jumps, err)
      if (allocated(err)) return
      changes = transpose(jumps(system%plan%free, :))
    end if
    if (rates_jump) call add_varied_impulse(system, jump, changes, err)
    if (allocated(err)) return
    system%sensitivity%values(:, :, 1) = system%sensitivity%values(:, :, 1) + changes
    call system%sensitivity%pack(y(system%size_of_motion() + 1:))
  end subroutine pass_varied

  !> Add the derivatives of the impulse by position and parameters. The forces that the links require are those of the impulse
  !> where the mechanism rests and its accelerations have the values of the jump; what they require without accelerations is no part of
  !> them, and is taken off.
  subroutine add_varied_impulse(system, jump, changes, err)
    class(motion_system_type), intent(inout) :: system       !< the motion system, behind a joint; its state stays
    real(wp), intent(in) :: jump(:)                          !< (M) of the independent rates
    real(wp), intent(inout) :: changes(:, :)                 !< (P,free) of the derivatives of the free rates
    type(error_type), allocatable, intent(out) :: err        !< allocated if it failed
    type(state_type) :: present
    real(wp) :: part
    integer :: i

    call copy_state(system%state, present)
    do i = 0, 1
      part = real(i, wp)
      system%state%dq = 0.0_wp
      system%state%ddq = merge(part*jump, 0.0_wp, system%plan%driven)
      call place_all(system%plan, system%state, err)
      if (.not. allocated(err)) &
        call find_equations(system%model%mechanism, system%plan, system%dynamics, system%state, system%work, err)
      if (allocated(err)) exit
      system%work%accelerations = merge(0.0_wp, part*jump(system%plan%independent), system%plan%driven(system%plan%independent))
      call complete_accelerations(system%plan, system%dynamics, system%work, system%state)
      call system%sensitivity%find_accelerations(system%model, system%state, system%work, err)
      if (allocated(err)) exit
      changes = changes + (2.0_wp*part - 1.0_wp)*system%sensitivity%values(:, :, 2)
    end do
    call copy_state(present, system%state)
  end subroutine add_varied_impulse
end module mech9_joint_passing
