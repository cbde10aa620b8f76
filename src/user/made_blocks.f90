!> The hook for the motion of closed chains that was made for one plan: `mech9-link --specialise` writes a submodule of this module.
!>
!> The submodule describes the plan for which it was made. The executor of plans asks it only for blocks of such a plan.
module mech9_made_blocks
  use mech9_kinds, only: wp
  implicit none
  private
  public :: made_course_type, describe_made_plan, move_made_block, describe_made_mechanism

  !> The course of Newton's method.
  type :: made_course_type
    integer :: iterations = 0            !< number of corrections
    real(wp) :: correction = 0.0_wp      !< sum of the largest change of a coordinate in each, in its unit
    real(wp) :: contraction = 0.0_wp     !< ratio of the second correction to the first; 0 where one was enough
    real(wp) :: pivots(3) = 0.0_wp       !< of the Jacobian at the closed position, not increasing
    integer :: sign_of_det = 1           !< of this Jacobian: -1 or 1
  end type made_course_type

  interface
    !> The plan for which blocks were made: its structure, the places of numbers that are constants of the made code, and their values
    !> (see mech9_made_plan). All are empty where none was made.
    pure module subroutine describe_made_plan(structure, places, values)
      integer, allocatable, intent(out) :: structure(:)   !< the structure of the plan, and the blocks
      integer, allocatable, intent(out) :: places(:)      !< of constants among the numbers of the plan
      real(wp), allocatable, intent(out) :: values(:)     !< (constants) values of these constants, SI units
    end subroutine describe_made_plan

    !> Close the chain of a block from a guess of its coordinates, and find its rates, accelerations, and the motion of its frames.
    pure module subroutine move_made_block(block, n, full, q, dq, ddq, f, slide, turn, v, a, jacobian, inverse, course, is_solved)
      integer, intent(in) :: block                      !< number of the block among those that were made
      real(wp), intent(in) :: n(*)                      !< numbers of the plan [rad, m]
      logical, intent(in) :: full                       !< find accelerations too
      real(wp), intent(inout) :: q(*)                   !< given coordinates and a guess of the others in; all out [rad, m]
      real(wp), intent(inout) :: dq(*)                  !< rates, the given ones in [rad/s, m/s]
      real(wp), intent(inout) :: ddq(*)                 !< accelerations, the given ones in [rad/s^2, m/s^2]
      real(wp), intent(inout) :: f(4, 0:*)              !< (cosine, sine, x, y) pose of each frame [m]
      real(wp), intent(inout) :: slide(2, *)            !< (2,M) velocity of each frame's origin per unit rate, the plane's axes [m/rad, 1]
      real(wp), intent(inout) :: turn(2, *)             !< (2,M) cosine and sine of the angle by which each step turns [1]
      real(wp), intent(inout) :: v(3, 0:*)              !< velocity of each frame [rad/s, m/s]
      real(wp), intent(inout) :: a(3, 0:*)              !< acceleration of each frame [rad/s^2, m/s^2]
      real(wp), intent(inout) :: jacobian(3, 3)         !< (3,3) derivatives of the three equations by the unknowns, at the closed position [1, m, m/rad]
      real(wp), intent(inout) :: inverse(3, 3)          !< (3,3) its inverse
      type(made_course_type), intent(out) :: course     !< the course of Newton's method
      logical, intent(out) :: is_solved                 !< else anything may have changed, and the general code is to begin anew
    end subroutine move_made_block

    !> The groups of the data file of the mechanism for which the program was made, and the file's name; empty: it is for any mechanism.
    pure module subroutine describe_made_mechanism(groups, name)
      character(len=:), allocatable, intent(out) :: groups   !< as mech9_fixed_groups forms them
      character(len=:), allocatable, intent(out) :: name     !< of the data file
    end subroutine describe_made_mechanism
  end interface
end module mech9_made_blocks
