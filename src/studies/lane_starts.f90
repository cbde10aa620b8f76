!> Starts of designs that differ in numbers from a known one: its plan gets their numbers, and their chains are closed in it.
!>
!> A run alone finds frames, ranks and blocks of its design from the beginning. They are those of the known design where all axes stay
!> parallel and each block is regular at its start; then the numbers of the plan alone are found anew, and the start has the bits of a
!> run alone. A design whose start can't be found so is to be assembled as in such a run.
module mech9_lane_starts
  use mech9_kinds, only: wp
  use mech9_tolerances, only: rank_tolerance_for
  use mech9_planning_tolerances, only: near_guesses
  use mech9_error, only: error_type
  use mech9_model, only: model_type
  use mech9_plan, only: plan_type, new_state
  use mech9_state, only: state_type
  use mech9_scaling, only: find_size
  use mech9_spanning_tree, only: renew_frames
  use mech9_planar_layout, only: lay_out_in_plane
  use mech9_branch_stepping, only: set_inputs
  use mech9_block_solver, only: block_work_type, new_block_work, factorize_block
  use mech9_assembly, only: assemble_block, assembly_outcome_type
  use mech9_start_path, only: find_drawn
  implicit none
  private
  public :: lane_starts_type

  !> The plan of a known design, with the numbers of the design whose start was found last.
  type :: lane_starts_type
    type(plan_type) :: plan                                     !< the plan with all its blocks
    type(state_type) :: state                                   !< the closed position
    type(block_work_type), allocatable, private :: work(:)      !< (blocks) scratch
  contains
    procedure :: begin
    procedure :: find
  end type lane_starts_type

contains

  !> Prepare for designs of the structure of a known one.
  subroutine begin(self, plan)
    class(lane_starts_type), intent(out) :: self   !< prepared
    type(plan_type), intent(in) :: plan            !< of the known design, planar and with all its blocks
    integer :: b

    self%plan = plan
    self%state = new_state(plan)
    allocate (self%work(size(plan%blocks)))
    do b = 1, size(plan%blocks)
      self%work(b) = new_block_work(plan%blocks(b))
    end do
  end subroutine begin

  !> Find the plan and the start of a design. `found` is false where it is to be assembled from the beginning.
  subroutine find(self, model, found)
    class(lane_starts_type), intent(inout) :: self   !< gets plan and closed position
    type(model_type), intent(in) :: model            !< the model of the design, with drives for all independent coordinates
    logical, intent(out) :: found                    !< they are those of a run alone
    type(error_type), allocatable :: err
    real(wp), dimension(size(model%mechanism%pairs)) :: q, dq, ddq, drawn
    logical :: is_drawn
    integer :: b

    found = .false.
    q = model%problem%initial%position
    call set_inputs(model%problem%drives, model%request%time%start, q, dq, ddq, err)
    if (allocated(err)) return
    call renew_plan(model, q, self%plan)
    if (.not. self%plan%planar%used) return
    ! a run alone goes from the drawn position to its start
    call find_drawn(model, q, drawn, is_drawn, self%plan)
    if (is_drawn) return
    self%state%q = q
    do b = 1, size(self%plan%blocks)
      call close_block_near(self, b, found)
      if (.not. found) return
    end do
    found = .true.
  end subroutine find

  !> Give a plan the numbers of a design; it is not planar afterwards where the design is not.
  subroutine renew_plan(model, q, plan)
    type(model_type), intent(in) :: model      !< the model of the design
    real(wp), intent(in) :: q(:)               !< (M) guesses of its coordinates [rad, m]
    type(plan_type), intent(inout) :: plan     !< the plan
    integer :: k

    call find_size(model%mechanism, q, plan)
    do k = 1, plan%n_coordinates
      ! nothing but turns and slides moves in a plane
      if (.not. model%mechanism%pairs(k)%pair%angular) plan%unit_of(k) = plan%length
    end do
    call renew_frames(model%mechanism, plan)
    call lay_out_in_plane(plan)
  end subroutine renew_plan

  !> Close a block from the guesses. `closed` is false where a run alone would go on to search.
  subroutine close_block_near(self, number, closed)
    type(lane_starts_type), intent(inout) :: self    !< with the closed position of all blocks before
    integer, intent(in) :: number                    !< of the block
    logical, intent(out) :: closed                   !< it is closed near the guesses, at a regular position
    type(assembly_outcome_type) :: assembly
    type(error_type), allocatable :: err
    real(wp) :: guess(size(self%plan%blocks(number)%coordinates))

    associate (plan => self%plan, block => self%plan%blocks(number), work => self%work(number))
      guess = self%state%q(block%coordinates)
      call assemble_block(plan, block, self%state, work, .false., assembly, err)
      closed = assembly%closed .and. .not. allocated(err)
      if (closed) &
        closed = .not. any(abs(self%state%q(block%coordinates) - guess) > near_guesses*plan%unit_of(block%coordinates))
      if (.not. closed .or. size(block%unknowns) == 0) return
      call factorize_block(plan, block, self%state, work)
      closed = work%equations%rank(rank_tolerance_for(plan%data_tolerance)) == size(block%unknowns)
    end associate
  end subroutine close_block_near
end module mech9_lane_starts
