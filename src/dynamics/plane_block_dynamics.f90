!> The planar arithmetic of those blocks of a spatial mechanism whose whole clusters move in one plane: rates, columns and
!> accelerations are found in the plane, relative to its base, and the frames that the sweeps use in space are shown there.
module mech9_plane_block_dynamics
  use mech9_kinds, only: wp
  use mech9_plan, only: plan_type, block_type
  use mech9_state, only: state_type
  use mech9_planar_view, only: plane_in_space, show_velocities, show_accelerations
  use mech9_planar_block, only: list_loops
  use mech9_planar_dynamics, only: planar_dynamics_type, take_blocks
  use mech9_frame_columns, only: jacobian_type
  use mech9_lagrange_types, only: dynamics_plan_type, lagrange_work_type
  implicit none
  private
  public :: plane_block_dynamics_type, begin_plane_block_dynamics

  !> The arithmetic of blocks in planes that move. Sweeps over stages belong to the arithmetic of space.
  type, extends(planar_dynamics_type) :: plane_block_dynamics_type
  contains
    procedure :: make_work
    procedure :: move_regular_block
    procedure :: spread_jacobian
  end type plane_block_dynamics_type

contains

  !> Begin the arithmetic for the blocks of a plan of dynamics that have number 2 in `arithmetic_of`.
  subroutine begin_plane_block_dynamics(plan, dynamics, unchanged, self, known)
    type(plan_type), intent(in) :: plan                       !< the plan of the mechanism, with planes
    type(dynamics_plan_type), intent(in) :: dynamics          !< the plan of dynamics
    logical, intent(in) :: unchanged(:)                       !< (blocks) the block is as in the plan of dynamics `known`
    type(plane_block_dynamics_type), intent(out) :: self      !< the arithmetic
    type(dynamics_plan_type), intent(in), optional :: known   !< the plan of dynamics in other coordinates
    logical :: kept(size(plan%blocks))
    integer :: b

    kept = .false.
    if (present(known)) then
      if (size(known%arithmetics) > 1) then
        kept = unchanged .and. known%arithmetic_of(:size(unchanged)) == 2
      end if
    end if
    if (any(kept)) then
      call take_blocks(known%arithmetics(2)%kind, kept, self)
    else
      allocate (self%bodies(0), self%blocks(size(plan%blocks)))
    end if
    do b = 1, size(plan%blocks)
      if (dynamics%arithmetic_of(b) == 2 .and. .not. kept(b)) &
        call list_loops(plan, b, dynamics%frame_entries_type, dynamics%place_of, self%blocks(b))
    end do
  end subroutine begin_plane_block_dynamics

  !> Room for the columns of frames.
  pure subroutine make_work(self, plan, dynamics, work)
    class(plane_block_dynamics_type), intent(in) :: self   !< the arithmetic
    type(plan_type), intent(in) :: plan                    !< the plan of the mechanism
    type(dynamics_plan_type), intent(in) :: dynamics       !< the plan of dynamics
    type(lagrange_work_type), intent(inout) :: work        !< gets the room

    allocate (work%jacobian%flat(3, size(dynamics%column)), source=0.0_wp)
  end subroutine make_work

  !> Rates, entries and accelerations from rates in the plane, and of the block's outer frames in space.
  subroutine move_regular_block(self, plan, dynamics, b, state, work, moved)
    class(plane_block_dynamics_type), intent(in) :: self   !< the arithmetic
    type(plan_type), intent(in) :: plan                    !< the plan of the mechanism
    type(dynamics_plan_type), intent(in) :: dynamics       !< the plan of dynamics
    integer, intent(in) :: b                               !< number of the block
    type(state_type), intent(inout) :: state               !< gets the motion of the block
    type(lagrange_work_type), intent(inout) :: work        !< with the block factorized; gets the entries
    logical, intent(out) :: moved                          !< true

    call self%planar_dynamics_type%move_regular_block(plan, dynamics, b, state, work, moved)
    associate (block => plan%blocks(b))
      call show_velocities(plan, dynamics%in_space, block%first_step, block%last_step, state)
      call show_accelerations(plan, dynamics%in_space, block%first_step, block%last_step, state)
      call show_columns(plan, dynamics, block, state, .false., work%jacobian)
    end associate
  end subroutine move_regular_block

  !> Outward recursion of the Jacobian's entries over the frames of a block that belong to its closed cluster.
  pure subroutine spread_jacobian(self, plan, dynamics, block, state, all_frames, jacobian)
    class(plane_block_dynamics_type), intent(in) :: self   !< the arithmetic
    type(plan_type), intent(in) :: plan                    !< the plan of the mechanism
    type(dynamics_plan_type), intent(in) :: dynamics       !< the plan of dynamics
    type(block_type), intent(in) :: block                  !< the block
    type(state_type), intent(in) :: state                  !< with the poses of the frames
    logical, intent(in) :: all_frames                      !< also frames of closed clusters that carry nothing
    type(jacobian_type), intent(inout) :: jacobian         !< with `b` of the block's steps

    call self%planar_dynamics_type%spread_jacobian(plan, dynamics, block, state, all_frames, jacobian)
    call show_columns(plan, dynamics, block, state, all_frames, jacobian)
  end subroutine spread_jacobian

  !> Columns in space of those frames of a block that the sweeps use there, or of all.
  pure subroutine show_columns(plan, dynamics, block, state, all_frames, jacobian)
    type(plan_type), intent(in) :: plan                !< the plan of the mechanism
    type(dynamics_plan_type), intent(in) :: dynamics   !< the plan of dynamics
    type(block_type), intent(in) :: block              !< the block
    type(state_type), intent(in) :: state              !< with the pose of the plane's base
    logical, intent(in) :: all_frames                  !< all frames of closed clusters
    type(jacobian_type), intent(inout) :: jacobian     !< with the columns in the plane; gets those in space
    real(wp) :: axes(3, 3)
    logical :: known
    integer :: s, e

    known = .false.
    do s = block%first_step, block%last_step
      if (.not. (dynamics%closed(s) .and. (all_frames .or. dynamics%in_space(s)))) cycle
      if (.not. known) axes = plane_in_space(plan, state, s)
      known = .true.
      do e = dynamics%first(s), dynamics%first(s + 1) - 1
        associate (column => jacobian%flat(:, e))
          jacobian%w(:, e) = column(1)*axes(:, 3)
          jacobian%v(:, e) = column(2)*axes(:, 1) + column(3)*axes(:, 2)
        end associate
      end do
    end do
  end subroutine show_columns
end module mech9_plane_block_dynamics
