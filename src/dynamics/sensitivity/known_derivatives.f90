!> Whether the numbers that parameters set are among those by which forces, and motions that follow from forces, have known derivatives.
module mech9_known_derivatives
  use mech9_kinds, only: wp
  use mech9_error, only: error_type, raise, exit_data
  use mech9_failure, only: failure_unknown_derivative, failure_unknown_forces
  use mech9_law, only: law_type
  use mech9_model, only: model_type
  use mech9_tangent, only: tangent_type
  implicit none
  private
  public :: check_known

contains

  !> Fail with exit_data where a parameter sets numbers by which the forces of a motion have no known derivatives, or, where it is
  !> integrated, the motion itself.
  subroutine check_known(model, tangents, integrated, err)
    type(model_type), intent(in) :: model                 !< the model
    type(tangent_type), intent(in) :: tangents(:)         !< (P) derivatives of its constants
    logical, intent(in) :: integrated                     !< the motion follows from forces, and has derivatives at all times
    type(error_type), allocatable, intent(out) :: err     !< allocated if it failed
    integer :: i

    do i = 1, size(tangents)
      if (knows_forces(model, i)) then
        if (.not. integrated) cycle
        if (is_smooth(model, tangents(i))) cycle
      end if
      call raise(err, exit_data, merge(failure_unknown_derivative, failure_unknown_forces, integrated))
      err%failure%name = model%parameters(i)%name
      err%place = model%parameters(i)%place
      return
    end do
  end subroutine check_known

  !> Whether the derivatives of forces by a parameter are known: numbers of loads must be.
  pure logical function knows_forces(model, number) result(known)
    type(model_type), intent(in) :: model        !< the model
    integer, intent(in) :: number                !< of the parameter
    real(wp), allocatable :: values(:)
    logical :: sets_loads
    integer :: i

    known = .true.
    sets_loads = .false.
    do i = 1, size(model%parameters(number)%targets)
      associate (group => model%parameters(number)%targets(i)%group)
        sets_loads = sets_loads .or. group == 'load' .or. group == 'motor' .or. group == 'user'
      end associate
    end do
    if (.not. sets_loads) return
    do i = 1, size(model%mechanism%loads)
      call model%mechanism%loads(i)%load%constants(values)
      known = known .and. allocated(values)
    end do
  end function knows_forces

  !> Whether no law whose numbers vary has joints: the times of these may vary, and rates jump there.
  logical function is_smooth(model, tangent)
    type(model_type), intent(in) :: model        !< the model
    type(tangent_type), intent(in) :: tangent    !< derivatives by the parameter
    real(wp), allocatable :: values(:)
    integer :: i

    is_smooth = .true.
    do i = 1, size(model%mechanism%loads)
      associate (load => model%mechanism%loads(i)%load)
        if (.not. (tangent%loads(i)%varies .and. allocated(load%law))) cycle
        call load%numbers(values)
        if (any(abs(tangent%loads(i)%change(size(values) + 1:)) > 0.0_wp)) is_smooth = is_smooth .and. .not. has_joints(load%law)
      end associate
    end do
    do i = 1, size(model%problem%drives)
      if (tangent%drives(i)%varies) is_smooth = is_smooth .and. .not. has_joints(model%problem%drives(i)%drive)
    end do
  contains

    !> Whether the pieces of a law join at some time.
    pure logical function has_joints(law)
      class(law_type), intent(in) :: law   !< the law

      associate (t => model%request%time%start)
        has_joints = abs(law%next_joint(t, 1.0_wp)) < huge(t) .or. abs(law%next_joint(t, -1.0_wp)) < huge(t)
      end associate
    end function has_joints
  end function is_smooth
end module mech9_known_derivatives
