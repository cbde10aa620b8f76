!> The equations of motion in other angles of ball joints, or with other angles of rods held.
module mech9_other_angles
  use mech9_kinds, only: wp
  use mech9_error, only: error_type, raise, exit_singular
  use mech9_integration_failures, only: failure_angles_sensitivity
  use mech9_log_determinant, only: log_determinant
  use mech9_model, only: model_type
  use mech9_plan, only: copy_plan
  use mech9_state, only: copy_state
  use mech9_motion_system, only: motion_system_type, set_motion_system
  use mech9_held_angles, only: copy_drives
  use mech9_ball_angles, only: ball_angles_type
  use mech9_third_derivatives, only: find_third_derivatives
  use mech9_partition, only: partition_type
  use mech9_variable_model, only: variable_model_type
  use mech9_varied_angles, only: carry_to_angles, carry_given_angles
  implicit none
  private
  public :: take_angles, show_in_angles, set_in_partition, refuse_angles, refuse_parameters, hand_on_sensitivity, take_shown, &
    take_shown_changes, set_shown_directions

contains

  !> Make the system in the angles that serve best, at the present state. It is not made where these are the present ones.
  subroutine take_angles(system, present_angles, angles, other, failure)
    class(motion_system_type), intent(in) :: system         !< the system in the present angles
    type(ball_angles_type), intent(in) :: present_angles    !< ball joints of the motion
    type(ball_angles_type), intent(inout) :: angles         !< the same; then those of the other system
    type(motion_system_type), intent(inout) :: other        !< gets the system
    type(error_type), allocatable, intent(out) :: failure   !< allocated if these angles cannot serve

    if (size(system%plan%closures) > 0) then
      if (angles%in_use()) then
        call copy_plan(angles%plan, other%plan)
        call copy_state(angles%state, other%state)
      else
        call copy_plan(system%plan, other%plan)
        call copy_state(system%state, other%state)
      end if
      call angles%restart(system%model, system%partition, other%plan, other%state, failure)
    else
      call angles%change(system%state, other%plan, other%state, failure)
    end if
    if (allocated(failure) .or. angles%move_as(present_angles)) return
    call copy_drives(angles%held%drives, other%drives)
    call system%hand_on_modes(other)
    call set_motion_system(system%model, angles%held%partition, other, failure)
  end subroutine take_angles

  !> Show the present state of a system in the angles of the data file, if others are integrated.
  subroutine show_in_angles(system, angles, err)
    class(motion_system_type), intent(inout) :: system      !< the system; its state stays
    type(ball_angles_type), intent(inout) :: angles         !< continued to the present state; get it
    type(error_type), allocatable, intent(out) :: err       !< allocated if it failed
    real(wp) :: dddq(system%plan%n_coordinates)

    if (.not. angles%in_use()) return
    call angles%continue_to(system%state)
    dddq = 0.0_wp
    if (angles%in_lock()) call find_third_derivatives(system, dddq, err)
    if (.not. allocated(err)) call angles%show(system%state, dddq, err)
    if (allocated(system%state%stop_force)) angles%state%stop_force = system%state%stop_force
    if (allocated(system%contact)) angles%state%contact_force = system%state%contact_force
    if (allocated(system%state%friction)) then
      angles%state%friction = system%state%friction
      angles%state%heat = system%state%heat
    end if
  end subroutine show_in_angles

  !> Make the system in other independent coordinates, from a plan and a state that were carried over to them. It is not made where
  !> these coordinates cannot serve: they may have no inertia in this position.
  subroutine set_in_partition(system, partition, serves, angles, other, made, failure)
    class(motion_system_type), intent(in) :: system         !< the system in the present coordinates
    type(partition_type), intent(in) :: partition           !< of the other coordinates
    logical, intent(in) :: serves                           !< the plan has the frames of the present one
    type(ball_angles_type), intent(inout) :: angles         !< those of the present system; then those of the other one
    type(motion_system_type), intent(inout) :: other        !< with plan and state; gets the system
    logical, intent(out) :: made                            !< it was made
    type(error_type), allocatable, intent(out) :: failure   !< allocated if the angles cannot be carried over
    type(error_type), allocatable :: unfit
    logical :: same_frames

    made = .false.
    if (angles%in_use()) then
      angles%held%partition = partition
      call angles%follow(system%model, other%plan, other%state, failure)
    else
      call angles%restart(system%model, partition, other%plan, other%state, failure)
    end if
    if (allocated(failure)) return
    same_frames = serves .and. .not. angles%in_use() .and. all(angles%held%partition%kind == partition%kind) &
                  .and. all(partition%driven() .eqv. system%plan%driven)
    call copy_drives(angles%held%drives, other%drives)
    call system%hand_on_modes(other)
    if (same_frames) then
      call set_motion_system(system%model, angles%held%partition, other, unfit, system)
    else
      call set_motion_system(system%model, angles%held%partition, other, unfit)
    end if
    made = .not. allocated(unfit)
  end subroutine set_in_partition

  !> Fail because derivatives by parameters are not known in other angles than those of the data file.
  subroutine refuse_angles(angles, t, err)
    type(ball_angles_type), intent(in) :: angles             !< of ball joints
    real(wp), intent(in) :: t                                !< time [s]
    type(error_type), allocatable, intent(out) :: err        !< allocated where there are other angles

    if (.not. angles%in_use()) return
    call raise(err, exit_singular, failure_angles_sensitivity)
    err%failure%t = t
  end subroutine refuse_angles

  !> Fail where derivatives by parameters are not known in other angles: they are known for directions alone, parameters that set no number,
  !> since those that do may move the axes of joints.
  subroutine refuse_parameters(model, angles, t, err)
    type(model_type), intent(in) :: model                    !< the model with its parameters
    type(ball_angles_type), intent(in) :: angles             !< of ball joints
    real(wp), intent(in) :: t                                !< time [s]
    type(error_type), allocatable, intent(out) :: err        !< allocated where there are other angles, and numbers are set
    integer :: i

    do i = 1, size(model%parameters)
      if (size(model%parameters(i)%targets) > 0) call refuse_angles(angles, t, err)
      if (allocated(err)) return
    end do
  end subroutine refuse_parameters

  !> Let another system go on with the derivatives by parameters.
  subroutine hand_on_sensitivity(system, present_angles, angles, variable, other, log_volume, err)
    class(motion_system_type), intent(inout) :: system           !< the system, with its motion
    type(ball_angles_type), intent(in) :: present_angles         !< of ball joints in it
    type(ball_angles_type), intent(in) :: angles                 !< of ball joints in the other system
    class(variable_model_type), intent(inout) :: variable        !< the model as a function of its parameters
    class(motion_system_type), intent(inout) :: other            !< in other coordinates, with its motion
    real(wp), intent(inout) :: log_volume                        !< gets what the volume of the directions is multiplied by, as logarithm
    type(error_type), allocatable, intent(out) :: err            !< allocated if it failed
    real(wp), allocatable :: changes(:, :, :)

    call refuse_parameters(system%model, angles, system%state%t, err)
    if (.not. allocated(err)) call system%show_sensitivity(err)
    if (allocated(err)) return
    allocate (changes(size(system%sensitivity%motion%q, 1), 0:2, size(system%sensitivity%motion%q, 3)), &
              source=system%sensitivity%motion%q)
    call carry_to_angles(present_angles, system%state, angles, other%state, changes)
    call other%begin_sensitivity(variable, err, changes, system%sensitivity%motors(:, :, 0), system%sensitivity%motion%held)
    if (.not. allocated(err)) log_volume = log_volume + log_volume_of(other) - log_volume_of(system)
  end subroutine hand_on_sensitivity

  !> The logarithm of the volume of the directions in the free coordinates, their rates, and the states of motors; zero where there are not
  !> as many directions.
  real(wp) function log_volume_of(system) result(log_volume)
    class(motion_system_type), intent(in) :: system   !< the system with its directions
    integer, allocatable :: motors(:)
    integer :: i

    associate (values => system%sensitivity%values, all => system%model%mechanism%motors)
      motors = pack([(i, i=1, size(all))], [(all(i)%motor%has_state(), i=1, size(all))])
      log_volume = 0.0_wp
      if (size(values, 1) /= 2*size(values, 2) + size(motors)) return
      log_volume = log_determinant(reshape([values(:, :, 0), values(:, :, 1), system%sensitivity%motors(:, motors, 0)], &
                                           [size(values, 1), size(values, 1)]))
    end associate
  end function log_volume_of

  !> Take the motion of all coordinates in the angles of the data file, in which it was shown last.
  pure subroutine take_shown(system, angles, q, dq, ddq)
    class(motion_system_type), intent(in) :: system      !< the system
    type(ball_angles_type), intent(in) :: angles         !< of its ball joints
    real(wp), intent(out) :: q(:)                        !< (M) coordinates [rad, m]
    real(wp), intent(out) :: dq(:)                       !< (M) rates [rad/s, m/s]
    real(wp), intent(out) :: ddq(:)                      !< (M) accelerations [rad/s^2, m/s^2]

    if (angles%in_use()) then
      q = angles%state%q
      dq = angles%state%dq
      ddq = angles%state%ddq
    else
      q = system%state%q
      dq = system%state%dq
      ddq = system%state%ddq
    end if
  end subroutine take_shown

  !> Take the derivatives of all coordinates and rates in these angles. Fails in gimbal lock, where they do not exist.
  subroutine take_shown_changes(system, angles, changes, err)
    class(motion_system_type), intent(in) :: system      !< the system, with its derivatives
    type(ball_angles_type), intent(in) :: angles         !< of its ball joints, continued to its state
    real(wp), intent(out) :: changes(:, 0:, :)           !< (P,0:2,M) the derivatives; those of accelerations as in the system
    type(error_type), allocatable, intent(out) :: err    !< allocated if it failed

    changes = system%sensitivity%motion%q
    if (.not. angles%in_use()) return
    if (angles%in_lock()) call refuse_angles(angles, system%state%t, err)
    if (.not. allocated(err)) call carry_given_angles(angles, system%state, .true., changes)
  end subroutine take_shown_changes

  !> Let each direction lie along one free coordinate of the data file, or along its rate; further ones stay. Fails where the start stands in
  !> gimbal lock, and where closed chains determine angles of a joint that moves by others.
  subroutine set_shown_directions(system, angles, err)
    class(motion_system_type), intent(inout) :: system   !< the system, whose directions lie along its own free coordinates
    type(ball_angles_type), intent(in) :: angles         !< of its ball joints, with the state in those of the data file
    type(error_type), allocatable, intent(out) :: err    !< allocated if it failed
    real(wp) :: changes(size(system%sensitivity%values, 1), 0:2, system%plan%n_coordinates)
    integer :: order

    if (.not. angles%in_use()) return
    if (angles%in_lock() .or. size(system%plan%closures) > 0) then
      call refuse_angles(angles, system%state%t, err)
      return
    end if
    changes = 0.0_wp
    associate (values => system%sensitivity%values, free => system%plan%free)
      do order = 0, 1
        changes(:, order, free) = values(:, :, order)
      end do
      call carry_given_angles(angles, system%state, .false., changes)
      do order = 0, 1
        values(:, :, order) = changes(:, order, free)
      end do
    end associate
  end subroutine set_shown_directions
end module mech9_other_angles
