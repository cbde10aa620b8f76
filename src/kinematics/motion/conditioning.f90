!> The distance of closed chains from a singular position, measured by the least singular value of their Jacobians.
!>
!> Rotations are in rad, translations in lengths of the mechanism. The value is 1 where there is no closed chain.
module mech9_conditioning
  use mech9_kinds, only: wp
  use mech9_motion_tolerances, only: clearly_less, lower_pivot
  use mech9_block_solver, only: block_work_type
  implicit none
  private
  public :: conditioning_type


  !> The worst of several positions.
  type :: conditioning_type
    real(wp) :: least = 1.0_wp            !< least singular value of any block
    real(wp) :: t = 0.0_wp                !< time of that position [s]
    integer :: block = 0                  !< number of that block; 0: none yet
    real(wp) :: pivot = huge(1.0_wp)      !< least pivot when singular values were computed last
  contains
    procedure :: update_by_pivots
    procedure :: update
  end type conditioning_type

contains

  !> Take a position into account whose factorized Jacobians are in `work`. Singular values are computed only when the
  !> least pivot has become smaller than it was at their last computation.
  subroutine update_by_pivots(self, t, work)
    class(conditioning_type), intent(inout) :: self   !< the worst of the positions so far
    real(wp), intent(in) :: t                         !< time of the position [s]
    type(block_work_type), intent(inout) :: work(:)   !< scratch of all blocks, with the factors of their Jacobians
    real(wp) :: pivot, least
    integer :: b

    pivot = huge(pivot)
    do b = 1, size(work)
      if (work(b)%equations%n > 0) pivot = min(pivot, work(b)%equations%least_pivot())
    end do
    if (pivot >= lower_pivot*self%pivot) return
    self%pivot = pivot
    call self%update(t, work, least)
  end subroutine update_by_pivots

  !> Take a position into account whose factorized Jacobians are in `work`, and compute its singular values always.
  subroutine update(self, t, work, least)
    class(conditioning_type), intent(inout) :: self   !< the worst of the positions so far
    real(wp), intent(in) :: t                         !< time of the position [s]
    type(block_work_type), intent(inout) :: work(:)   !< scratch of all blocks, with the factors of their Jacobians
    real(wp), intent(out) :: least                    !< least singular value at this position; 1 where there is no closed chain
    integer :: block

    call find_conditioning(work, least, block)
    if (block == 0 .or. (least >= clearly_less*self%least .and. self%block > 0)) return
    self%least = least
    self%t = t
    self%block = block
  end subroutine update

  !> The least singular value of any block and the number of this block; 1 and 0 where there is no closed chain.
  subroutine find_conditioning(work, least, block)
    type(block_work_type), intent(inout) :: work(:)   !< scratch of all blocks, with the factors of their Jacobians
    real(wp), intent(out) :: least                    !< least singular value of any block
    integer, intent(out) :: block                     !< number of the block that has it; 0: none
    real(wp) :: value
    integer :: b

    least = 1.0_wp
    block = 0
    do b = 1, size(work)
      if (work(b)%equations%n == 0) cycle
      value = work(b)%equations%least_singular_value()
      if (block > 0 .and. value >= least) cycle
      least = value
      block = b
    end do
  end subroutine find_conditioning
end module mech9_conditioning
