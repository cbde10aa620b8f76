!> The default answers, where no code was made for a mechanism.
submodule (mech9_made_blocks) mech9_made_blocks_default
  implicit none

contains

  pure module subroutine describe_made_plan(structure, places, values)
    integer, allocatable, intent(out) :: structure(:)   !< empty
    integer, allocatable, intent(out) :: places(:)      !< empty
    real(wp), allocatable, intent(out) :: values(:)     !< (0) no values

    allocate (structure(0), places(0), values(0))
  end subroutine describe_made_plan

  pure module subroutine move_made_block(block, n, full, q, dq, ddq, f, slide, turn, v, a, jacobian, inverse, course, is_solved)
    integer, intent(in) :: block                      !< unused
    real(wp), intent(in) :: n(*)                      !< (numbers) numbers of the code, SI units; not used
    logical, intent(in) :: full                       !< unused
    real(wp), intent(inout) :: q(*)                   !< (M) coordinates, not changed [rad, m]
    real(wp), intent(inout) :: dq(*)                  !< (M) their rates, not changed [rad/s, m/s]
    real(wp), intent(inout) :: ddq(*)                 !< (M) their accelerations, not changed [rad/s^2, m/s^2]
    real(wp), intent(inout) :: f(4, 0:*)              !< (4,0:M) frames in the plane, not changed [1, m]
    real(wp), intent(inout) :: slide(2, *)            !< (2,M) velocities of origins per unit rate, not changed [m/rad, 1]
    real(wp), intent(inout) :: turn(2, *)             !< (2,M) cosines and sines of turns, not changed [1]
    real(wp), intent(inout) :: v(3, 0:*)              !< (3,0:M) velocities of frames, not changed [rad/s, m/s]
    real(wp), intent(inout) :: a(3, 0:*)              !< (3,0:M) accelerations of frames, not changed [rad/s^2, m/s^2]
    real(wp), intent(inout) :: jacobian(3, 3)         !< (3,3) Jacobian, not changed [1, m, m/rad]
    real(wp), intent(inout) :: inverse(3, 3)          !< (3,3) its inverse, not changed
    type(made_course_type), intent(out) :: course     !< no correction
    logical, intent(out) :: is_solved                 !< false

    is_solved = .false.
  end subroutine move_made_block

  pure module subroutine describe_made_mechanism(groups, name)
    character(len=:), allocatable, intent(out) :: groups   !< empty
    character(len=:), allocatable, intent(out) :: name     !< empty

    groups = ''
    name = ''
  end subroutine describe_made_mechanism
end submodule mech9_made_blocks_default
