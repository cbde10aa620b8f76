!> Whether the numbers that parameters set are among those by which integrated motions have known derivatives.
module mech9_known_derivatives
  use mech9_kinds, only: wp
  use mech9_error, only: error_type, raise, exit_data
  use mech9_force_gradient_failures, only: failure_jumping_force
  use mech9_law, only: law_type, from_inside
  use mech9_load, only: load_type
  use mech9_model, only: model_type
  use mech9_tangent, only: tangent_type, law_tangent_type
  implicit none
  private
  public :: check_known

contains

  !> Fail with exit_data where a parameter sets numbers by which an integrated motion has no known derivatives.
  subroutine check_known(model, tangents, err)
    type(model_type), intent(in) :: model                 !< the model
    type(tangent_type), intent(in) :: tangents(:)         !< (P) derivatives of its constants
    type(error_type), allocatable, intent(out) :: err     !< allocated if it failed
    integer :: i

    do i = 1, size(tangents)
      if (is_smooth(model, tangents(i))) cycle
      call raise(err, exit_data, failure_jumping_force)
      err%failure%name = model%parameters(i)%name
      err%place = model%parameters(i)%place
      return
    end do
  end subroutine check_known

  !> Whether no load or motor whose law's numbers vary has a force that jumps: the time of the jump may vary, which changes rates.
  !> Jumps in the rates of drives are found where they happen.
  logical function is_smooth(model, tangent)
    type(model_type), intent(in) :: model        !< the model
    type(tangent_type), intent(in) :: tangent    !< derivatives by the parameter
    integer :: i

    is_smooth = .true.
    do i = 1, size(model%mechanism%loads)
      if (moves_jump(model, model%mechanism%loads(i)%load, tangent%loads(i))) is_smooth = .false.
    end do
    do i = 1, size(model%mechanism%motors)
      if (moves_jump(model, model%mechanism%motors(i)%motor, tangent%motors(i))) is_smooth = .false.
    end do
  end function is_smooth

  !> Whether the numbers of a load's law vary, and its force jumps.
  logical function moves_jump(model, load, part)
    type(model_type), intent(in) :: model          !< the model
    class(load_type), intent(in) :: load           !< the load
    type(law_tangent_type), intent(in) :: part     !< derivatives of its numbers and of those of its law
    real(wp), allocatable :: values(:)

    moves_jump = .false.
    if (.not. (part%varies .and. allocated(load%law))) return
    call load%numbers(values)
    if (any(abs(part%change(size(values) + 1:)) > 0.0_wp)) moves_jump = jumps(model, load%law)
  end function moves_jump

  !> Whether the value of a law jumps at a joint in the time of the run, or for the setpoint of a motor its rate, too.
  logical function jumps(model, law)
    type(model_type), intent(in) :: model        !< the model
    class(law_type), intent(in) :: law           !< the law
    real(wp), parameter :: round_off = 1.0e-9_wp ! of values on both sides of a joint, which lie some units of round-off apart
    type(error_type), allocatable :: err
    real(wp), allocatable :: numbers(:)
    real(wp) :: before(3), behind(3), joint, direction, duration, largest
    integer :: i

    jumps = .false.
    call law%constants(numbers)
    if (.not. allocated(numbers)) return
    largest = maxval(abs(numbers))
    joint = model%request%time%start
    direction = sign(1.0_wp, model%request%time%end - joint)
    duration = abs(model%request%time%end - joint)
    ! all joints of one period have this many at most: those between segments, and four in each
    do i = 1, 3*size(numbers)
      joint = law%next_joint(joint, direction)
      if ((joint - model%request%time%end)*direction > 0.0_wp) return
      call law%evaluate(from_inside(joint, -direction), before(1), before(2), before(3), err)
      if (.not. allocated(err)) call law%evaluate(from_inside(joint, direction), behind(1), behind(2), behind(3), err)
      if (allocated(err)) cycle      ! the law ends here
      jumps = abs(behind(1) - before(1)) > round_off*largest
      if (law%coordinate > 0) jumps = jumps .or. abs(behind(2) - before(2)) > &
                                      round_off*max(abs(before(2)), abs(behind(2)), largest/duration)
      if (jumps) return
    end do
  end function jumps
end module mech9_known_derivatives
