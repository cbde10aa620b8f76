!> The counts of a driven motion at one of its positions, to which the motion returns when positions after this one do not count.
module mech9_driven_counts
  use mech9_kinds, only: wp, long
  use mech9_conditioning, only: conditioning_type
  use mech9_block_solver, only: work_count_type
  use mech9_driven_motion, only: driven_motion_type
  implicit none
  private
  public :: driven_counts_type, keep_counts, return_to_counts

  !> The counts of a driven motion up to a position, for reports.
  type :: driven_counts_type
    private
    integer(long) :: steps = 0                        !< accepted steps
    integer(long) :: halvings = 0                     !< refused steps
    integer(long) :: iterations = 0                   !< of Newton's method in all blocks
    integer(long) :: crossings = 0                    !< singular positions that were passed
    real(wp) :: worst_closure = 0.0_wp                !< largest closure error at any output [m]
    type(conditioning_type) :: conditioning           !< worst conditioning of all outputs
    type(work_count_type), allocatable :: work(:)     !< (blocks) operations done
  end type driven_counts_type

contains

  !> Keep the counts of the present position.
  pure subroutine keep_counts(driven, counts)
    type(driven_motion_type), intent(in) :: driven         !< the driven motion
    type(driven_counts_type), intent(inout) :: counts      !< gets its counts

    counts%steps = driven%steps
    counts%halvings = driven%halvings
    counts%iterations = driven%iterations
    counts%crossings = driven%crossings
    counts%worst_closure = driven%worst_closure
    counts%conditioning = driven%conditioning
    counts%work = driven%work%count
  end subroutine keep_counts

  !> Return to the counts of an earlier position of the motion.
  pure subroutine return_to_counts(counts, driven)
    type(driven_counts_type), intent(in) :: counts         !< counts of this position
    type(driven_motion_type), intent(inout) :: driven      !< gets them; its position stays

    driven%steps = counts%steps
    driven%halvings = counts%halvings
    driven%iterations = counts%iterations
    driven%crossings = counts%crossings
    driven%worst_closure = counts%worst_closure
    driven%conditioning = counts%conditioning
    driven%work%count = counts%work
  end subroutine return_to_counts
end module mech9_driven_counts
