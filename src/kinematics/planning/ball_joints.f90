!> Ball joints that are made of three revolute pairs, whose angles may be replaced by those of another triple of axes.
!>
!> The axes of the three pairs meet in one point, each at a right angle to the next. The two links between them have no
!> inertia, bear no load and carry no other link. The three angles are either all free, outside closed chains, or each of them is free
!> or determined by closed chains. Then nothing depends on them but the rotation that they give together. Another triple of axes with the same
!> rotation gives the same motion, and need not be singular where the angles of the data file are. Where the links between have
!> inertia, or neighbouring axes are not at right angles, the mechanism itself is another one beside such a position, and nothing
!> may be replaced.
module mech9_ball_joints
  use mech9_kinds, only: wp
  use mech9_tolerances, only: screw_tolerance
  use mech9_pose, only: pose_type
  use mech9_three_turns, only: three_turns_type, set_three_turns, substitute_turns, cyclic
  use mech9_mechanism, only: mechanism_type
  use mech9_partition, only: partition_type, free_coordinate, dependent_coordinate
  use mech9_plan, only: plan_type, step_type
  implicit none
  private
  public :: ball_joint_type, find_ball_joints

  !> A ball joint, with its angles as in the data file and with others.
  type :: ball_joint_type
    integer :: steps(3) = 0               !< the three steps of the plan
    integer :: coordinates(3) = 0         !< their coordinates
    type(three_turns_type) :: given       !< the turns as in the data file
    type(three_turns_type) :: substitute  !< the turns that may replace them
    type(step_type) :: replaced(3)        !< steps that make these turns, between the same frames
    logical :: centred = .false.          !< the origins of the frames between are in the joint's centre, for both triples
  end type ball_joint_type

contains

  !> All ball joints of a plan whose angles may be replaced.
  subroutine find_ball_joints(mechanism, partition, plan, joints)
    type(mechanism_type), intent(in) :: mechanism                !< the mechanism
    type(partition_type), intent(in) :: partition                !< of its coordinates
    type(plan_type), intent(in) :: plan                          !< its plan
    type(ball_joint_type), allocatable, intent(out) :: joints(:) !< none where there is none
    type(ball_joint_type) :: found(plan%n_coordinates/3), joint
    logical :: passive(0:plan%n_coordinates), free(plan%n_coordinates), fits
    integer :: s, n

    n = 0
    if (.not. plan%planar%used) then
      passive = passive_frames(mechanism, plan)
      free = free_steps(mechanism, partition, plan)
      do s = 1, plan%n_coordinates
        call find_ending_at(plan, s, passive, free, joint, fits)
        if (.not. fits) cycle
        n = n + 1
        found(n) = joint
        free(joint%steps) = .false.
      end do
    end if
    allocate (joints(n))
    joints = found(:n)
  end subroutine find_ball_joints

  !> Frames from which one step leads on, and whose links have no inertia, bear no load and close no chain.
  function passive_frames(mechanism, plan) result(passive)
    type(mechanism_type), intent(in) :: mechanism   !< the mechanism
    type(plan_type), intent(in) :: plan             !< its plan
    logical :: passive(0:plan%n_coordinates), loaded(plan%n_links)
    integer :: i, leaving(0:plan%n_coordinates)

    leaving = 0
    do i = 1, plan%n_coordinates
      leaving(plan%steps(i)%parent) = leaving(plan%steps(i)%parent) + 1
    end do
    passive = leaving == 1
    passive(0) = .false.
    do i = 1, size(plan%closures)
      passive(plan%closures(i)%closing) = .false.
      passive(plan%closures(i)%target) = .false.
    end do
    loaded = .false.
    do i = 1, size(mechanism%bodies)
      if (mechanism%bodies(i)%has_inertia()) loaded(mechanism%bodies(i)%link) = .true.
    end do
    call mechanism%mark_loaded_links(loaded)
    do i = 2, plan%n_links
      if (loaded(i)) passive(plan%frame_of(i)) = .false.
    end do
  end function passive_frames

  !> Steps of revolute pairs that no load or coupling reads or moves, with free coordinates outside closed chains or with
  !> free or dependent ones inside. All steps of one kind are followed by others of the same kind in a joint, since its chain has no
  !> branches.
  function free_steps(mechanism, partition, plan) result(free)
    type(mechanism_type), intent(in) :: mechanism   !< the mechanism
    type(partition_type), intent(in) :: partition   !< of its coordinates
    type(plan_type), intent(in) :: plan             !< its plan
    logical :: free(plan%n_coordinates), loaded(plan%n_coordinates), in_loop(plan%n_coordinates)
    integer :: i

    loaded = .false.
    call mechanism%mark_loaded_coordinates(loaded)
    free = .false.
    do i = 1, size(plan%blocks)
      free(plan%blocks(i)%first_step:plan%blocks(i)%last_step) = .true.
    end do
    in_loop = .false.
    do i = 1, size(plan%closures)
      if (plan%closures(i)%coupling > 0) loaded(plan%couplings(plan%closures(i)%coupling)%coupling%coordinates) = .true.
      in_loop(plan%closures(i)%loop%steps) = .true.
    end do
    do i = 1, plan%n_coordinates
      associate (step => plan%steps(i))
        free(i) = free(i) .and. step%is_screw .and. abs(step%turn) > 0.0_wp .and. .not. abs(step%slide) > 0.0_wp &
                  .and. .not. loaded(step%coordinate) &
                  .and. (partition%kind(step%coordinate) == free_coordinate &
                         .or. in_loop(i) .and. partition%kind(step%coordinate) == dependent_coordinate)
      end associate
    end do
  end function free_steps

  !> The ball joint whose third step is s. `fits` is false if there is none.
  subroutine find_ending_at(plan, s, passive, free, joint, fits)
    type(plan_type), intent(in) :: plan                !< the plan of the mechanism
    integer, intent(in) :: s                           !< number of the step
    logical, intent(in) :: passive(0:)                 !< frames that may lie between the turns
    logical, intent(in) :: free(:)                     !< steps that may be turns of a ball joint
    type(ball_joint_type), intent(out) :: joint        !< the joint
    logical, intent(out) :: fits                       !< there is one
    real(wp) :: before(3, 3, 3)
    integer :: i, middle

    middle = plan%steps(s)%parent
    fits = passive(middle)
    if (fits) fits = passive(plan%steps(middle)%parent)
    if (.not. fits) return
    joint%steps = [plan%steps(middle)%parent, middle, s]
    fits = all(free(joint%steps))
    if (.not. fits) return
    do i = 1, 3
      before(:, :, i) = plan%steps(joint%steps(i))%before%r
      joint%coordinates(i) = plan%steps(joint%steps(i))%coordinate
    end do
    associate (steps => plan%steps(joint%steps))
      call set_three_turns(before, steps%turn, steps%offset, screw_tolerance, joint%given, fits)
    end associate
    if (fits) call replace_steps(plan, joint, fits)
  end subroutine find_ending_at

  !> Make the steps of the substitute turns, between the same frames. `fits` is false if the axes do not meet in one point.
  pure subroutine replace_steps(plan, joint, fits)
    type(plan_type), intent(in) :: plan              !< the plan of the mechanism
    type(ball_joint_type), intent(inout) :: joint    !< with its turns; gets the substitute
    logical, intent(out) :: fits                     !< the axes meet in one point
    real(wp) :: height(3), away(3)

    ! heights of the centre above the origins of the frames, along their axes; the second and the third axis are horizontal in
    ! the frames before them
    associate (second => plan%steps(joint%steps(2))%before, third => plan%steps(joint%steps(3))%before)
      height(1) = second%p(3)
      height(2) = -dot_product(second%p(1:2), second%r(1:2, 3))
      height(3) = -dot_product(third%p(1:2), third%r(1:2, 3))
      away(1) = second%p(1)*second%r(2, 3) - second%p(2)*second%r(1, 3)
      away(2) = third%p(3) - height(2)
      away(3) = third%p(1)*third%r(2, 3) - third%p(2)*third%r(1, 3)
    end associate
    fits = all(abs(away) <= screw_tolerance*plan%length)
    if (.not. fits) return
    joint%centred = all(abs(height) <= screw_tolerance*plan%length)
    joint%substitute = substitute_turns(joint%given)
    joint%replaced = plan%steps(joint%steps)
    joint%replaced%turn = 1.0_wp
    joint%replaced%offset = 0.0_wp
    associate (first => plan%steps(joint%steps(1))%before)
      joint%replaced(1)%before = pose_type(joint%substitute%base, first%p + height(1)*first%r(:, 3))
    end associate
    joint%replaced(2)%before = pose_type(cyclic, [0.0_wp, 0.0_wp, 0.0_wp])
    joint%replaced(3)%before = pose_type(cyclic, -height(3)*cyclic(:, 3))
  end subroutine replace_steps
end module mech9_ball_joints
