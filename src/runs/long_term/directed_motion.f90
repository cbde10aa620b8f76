!> Motions with directions beside them, by which neighbouring motions are known: which results they leave out, and why they may end early.
module mech9_directed_motion
  use mech9_kinds, only: wp
  use mech9_error, only: error_type, place_type, raise, exit_data, exit_singular
  use mech9_text, only: to_text
  use mech9_model, only: model_type
  use mech9_request, only: output_settings_type
  use mech9_event_failures, only: failure_event_sensitivity
  use mech9_integration_failures, only: failure_shared_contact, failure_angles_sensitivity
  use mech9_free_simulation, only: free_simulation_type
  use mech9_sensitivity_words, only: find_cause_at_event
  implicit none
  private
  public :: set_directions, set_unit_directions, keep_motion_alone, explain_refusal

contains

  !> Give a model parameters that set nothing, one for each direction, and no results but its motion.
  subroutine set_directions(count, model)
    integer, intent(in) :: count              !< how many directions there are
    type(model_type), intent(inout) :: model  !< the model
    integer :: i

    if (allocated(model%parameters)) deallocate (model%parameters)
    allocate (model%parameters(count))
    do i = 1, count
      model%parameters(i)%name = 'direction '//to_text(i)
      allocate (model%parameters(i)%targets(0))
    end do
    if (allocated(model%request%quantities)) deallocate (model%request%quantities)
    model%request%solver%accuracy = 0.0_wp
    call keep_motion_alone(model%request%output)
    model%request%output%sensitivities = .true.
  end subroutine set_directions

  !> Let each direction lie along one number of the state: a free coordinate, a rate, a state of a motor. Parameters change nothing.
  subroutine set_unit_directions(simulation, unit, motors)
    type(free_simulation_type), intent(inout) :: simulation   !< the motion, with room for directions
    real(wp), intent(in) :: unit(:)                           !< (n) units of the free coordinates, and of their rates [rad, m]
    integer, intent(in) :: motors(:)                          !< numbers of those that have a state
    integer :: i, n

    n = size(unit)
    associate (sensitivity => simulation%motion%system%sensitivity)
      sensitivity%values = 0.0_wp
      sensitivity%motors = 0.0_wp
      do i = 1, n
        sensitivity%values(i, i, 0) = unit(i)
        sensitivity%values(n + i, i, 1) = unit(i)
      end do
      do i = 1, size(motors)
        sensitivity%motors(2*n + i, motors(i), 0) = 1.0_wp
      end do
    end associate
  end subroutine set_unit_directions

  !> Leave out all results but the motion of all coordinates.
  pure subroutine keep_motion_alone(output)
    type(output_settings_type), intent(inout) :: output   !< the settings

    output%conditioning = .false.
    output%energies = .false.
    output%reactions = .false.
    output%drive_forces = .false.
    output%force_arrows = .false.
    output%poses = .false.
    output%gradients = .false.
    output%sensitivities = .false.
    output%coordinates = [integer ::]
    output%derivatives = 2
  end subroutine keep_motion_alone

  !> Say why a motion with directions ended where its events do not allow them. Other failures stay as they are.
  subroutine explain_refusal(err, missing, unknown)
    type(error_type), allocatable, intent(inout) :: err   !< the failure, if there is one
    character(len=*), intent(in) :: missing               !< the numbers that do not exist behind such an event
    character(len=*), intent(in) :: unknown               !< the results that are not known in other angles of a joint
    character(len=:), allocatable :: time, cause
    type(place_type) :: place

    if (.not. allocated(err)) return
    if (.not. allocated(err%failure)) return
    time = 'at t = '//to_text(err%failure%t, 8)//' s '
    if (err%failure%kind == failure_event_sensitivity) then
      call find_cause_at_event(err%failure, cause)
      call raise(err, exit_singular, time//cause//', where '//missing//' do not exist; change the start a little')
    else if (err%failure%kind == failure_angles_sensitivity) then
      call raise(err, exit_singular, time//'a ball joint comes near gimbal lock, and '//unknown//' are not known in other '// &
                 'angles; turn the axes of the joint by axis= and zero=')
    else if (err%failure%kind == failure_shared_contact) then
      place = err%place
      call raise(err, exit_data, time//'equilibrium does not determine the forces of closed contacts with friction, where '// &
                 unknown//' are not known; give fewer contacts', place)
    end if
  end subroutine explain_refusal
end module mech9_directed_motion
