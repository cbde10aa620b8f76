!> Angles that the program holds because a rod between two ball joints can turn by itself, along a motion.
!>
!> A held angle counts like a dependent one: it gives way to another angle of the rod's joints where it would stop the motion
!> (mech9_held_rods). The rod stands still about itself at every such change, which moves nothing else.
module mech9_held_angles
  use mech9_error, only: error_type
  use mech9_law, only: drive_slot_type
  use mech9_polynomial_law, only: polynomial_law_type
  use mech9_partition, only: partition_type, dependent_coordinate
  use mech9_model, only: model_type
  use mech9_plan, only: plan_type, copy_plan
  use mech9_state, only: state_type, copy_state
  use mech9_requested, only: request_planned
  use mech9_replanning, only: replanning_type, wanted_type
  use mech9_frame_motion, only: place_all
  use mech9_held_rods, only: held_rod_type, find_held_rods, find_steps, best_angles, should_change, stop_turn, note_free
  use mech9_coordinate_choice, only: carry_over
  implicit none
  private
  public :: held_angles_type, copy_drives

  type :: held_angles_type
    type(partition_type) :: partition                 !< of the coordinates, with the angles that are held at present
    type(drive_slot_type), allocatable :: drives(:)   !< drives of the data file, and those that hold angles at present
    type(held_rod_type), allocatable :: rods(:)       !< rods that turn by themselves
  contains
    procedure :: begin
    procedure :: as_if_not_held
    procedure :: in_doubt
    procedure :: take_best
    procedure :: hold_positions
  end type held_angles_type

contains

  !> Begin with the angles that the model holds.
  subroutine begin(self, model, plan)
    class(held_angles_type), intent(inout) :: self      !< the angles
    type(model_type), intent(in) :: model               !< the model
    type(plan_type), intent(in) :: plan                 !< its plan

    self%partition = model%problem%partition
    call copy_drives(model%problem%drives, self%drives)
    call find_held_rods(model, plan, self%rods)
  end subroutine begin

  !> Copy drives one by one.
  subroutine copy_drives(drives, copies)
    type(drive_slot_type), intent(in) :: drives(:)                  !< any drives
    type(drive_slot_type), allocatable, intent(out) :: copies(:)    !< the same
    integer :: i

    allocate (copies(size(drives)))
    do i = 1, size(drives)
      allocate (copies(i)%drive, source=drives(i)%drive)
    end do
  end subroutine copy_drives

  !> The partition with dependent angles in place of those that are held.
  pure function as_if_not_held(self) result(partition)
    class(held_angles_type), intent(in) :: self   !< the angles
    type(partition_type) :: partition
    integer :: i

    partition = self%partition
    do i = 1, size(self%rods)
      if (.not. self%rods(i)%is_free) partition%kind(self%rods(i)%held) = dependent_coordinate
    end do
  end function as_if_not_held

  !> Whether another angle of any rod should be held.
  pure logical function in_doubt(self, state)
    class(held_angles_type), intent(in) :: self   !< the angles
    type(state_type), intent(in) :: state         !< of the integrated motion, frames in place
    integer :: i

    in_doubt = .false.
    do i = 1, size(self%rods)
      in_doubt = in_doubt .or. should_change(self%rods(i), state, .false.)
    end do
  end function in_doubt

  !> Hold other angles of rods where these serve clearly better, in the angles that move the joints.
  subroutine take_best(self, model, wanted, plan, state, changed, err)
    class(held_angles_type), intent(inout) :: self      !< the angles
    type(model_type), intent(in) :: model               !< the model
    type(wanted_type), intent(in) :: wanted             !< the part of the motion that is worked out
    type(plan_type), intent(inout) :: plan              !< with the angles that move the joints
    type(state_type), intent(inout) :: state            !< for this plan, with rates
    logical, intent(out) :: changed                     !< plan and state are those with other angles held
    type(error_type), allocatable, intent(out) :: err   !< allocated if a user pair has no pose
    type(wanted_type) :: whole
    type(error_type), allocatable :: failure
    type(partition_type) :: partition
    type(replanning_type) :: carried
    integer, dimension(size(self%rods)) :: before, held
    integer :: i, kind

    changed = .false.
    if (size(self%rods) == 0) return
    call note_free(self%partition, self%rods)
    call find_steps(plan, self%rods)
    before = [(self%rods(i)%held, i=1, size(before))]
    held = best_angles(self%rods, state)
    if (all(held == before)) return
    partition = self%partition
    do i = 1, size(held)
      if (held(i) == before(i)) cycle
      kind = partition%kind(before(i))
      partition%kind(before(i)) = dependent_coordinate
      partition%kind(held(i)) = kind
    end do
    whole = wanted
    call request_planned(plan, whole%requested)
    call carry_over(model%mechanism, partition, plan, state, whole, carried, failure)
    ! the present angles serve, too, if not as well
    if (allocated(failure)) return
    carried%state%ddq = state%ddq
    call copy_plan(carried%plan, plan)
    call copy_state(carried%state, state)
    self%partition = partition
    do i = 1, size(held)
      if (.not. self%rods(i)%is_free) call exchange_drive(before(i), held(i), self%drives)
      self%rods(i)%held = held(i)
    end do
    call find_steps(plan, self%rods)
    changed = .true.
    call place_all(plan, state, err)
  end subroutine take_best

  !> Let the drive that holds one coordinate hold another one.
  pure subroutine exchange_drive(from, to, drives)
    integer, intent(in) :: from                        !< number of the coordinate that was held
    integer, intent(in) :: to                          !< number of the coordinate to be held
    type(drive_slot_type), intent(inout) :: drives(:)  !< all drives
    integer :: i

    do i = 1, size(drives)
      if (drives(i)%drive%coordinate /= from) cycle
      drives(i)%drive%coordinate = to
      return
    end do
  end subroutine exchange_drive

  !> Let the drives of rods hold the angles where they are, at rest: the rods turn about themselves as slowly as that needs.
  subroutine hold_positions(self, plan, state)
    class(held_angles_type), intent(inout) :: self      !< the angles
    type(plan_type), intent(in) :: plan                 !< of the integrated motion
    type(state_type), intent(inout) :: state            !< for this plan, frames in place; gets the rates of the rods' angles
    integer :: i, j

    do j = 1, size(self%rods)
      if (self%rods(j)%is_free) cycle
      call stop_turn(self%rods(j), plan, state)
      do i = 1, size(self%drives)
        if (self%drives(i)%drive%coordinate /= self%rods(j)%held) cycle
        select type (still => self%drives(i)%drive)
        type is (polynomial_law_type)
          still%coefficients = [state%q(self%rods(j)%held)]
        end select
      end do
    end do
  end subroutine hold_positions
end module mech9_held_angles
