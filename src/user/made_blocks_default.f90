!> The default answers, where no code was made for a mechanism.
submodule (mech9_made_blocks) mech9_made_blocks_default
  implicit none

contains

  pure module subroutine describe_made_plan(structure, places, values)
    integer, allocatable, intent(out) :: structure(:)   !< empty
    integer, allocatable, intent(out) :: places(:)      !< empty
    real(wp), allocatable, intent(out) :: values(:)     !< empty

    allocate (structure(0), places(0), values(0))
  end subroutine describe_made_plan

  pure module subroutine move_made_block(block, n, full, q, dq, ddq, f, slide, turn, v, a, jacobian, inverse, course, is_solved)
    integer, intent(in) :: block                      !< unused
    real(wp), intent(in) :: n(*)                      !< unused
    logical, intent(in) :: full                       !< unused
    real(wp), intent(inout) :: q(*)                   !< unchanged
    real(wp), intent(inout) :: dq(*)                  !< unchanged
    real(wp), intent(inout) :: ddq(*)                 !< unchanged
    real(wp), intent(inout) :: f(4, 0:*)              !< unchanged
    real(wp), intent(inout) :: slide(2, *)            !< unchanged
    real(wp), intent(inout) :: turn(2, *)             !< unchanged
    real(wp), intent(inout) :: v(3, 0:*)              !< unchanged
    real(wp), intent(inout) :: a(3, 0:*)              !< unchanged
    real(wp), intent(inout) :: jacobian(3, 3)         !< unchanged
    real(wp), intent(inout) :: inverse(3, 3)          !< unchanged
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
