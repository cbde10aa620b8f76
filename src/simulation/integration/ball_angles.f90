!> The angles of ball joints as in the data file, while others are integrated in their place near gimbal lock.
!>
!> The plan of the integrated motion differs from that of the data file in the steps of the joints whose angles are replaced.
!> The angles of the data file follow from the rotation of the joint and its history: of all angles that give the rotation,
!> those that continue the angles before. `continue_to` carries them on over ways that are short against the distance from the
!> lock, as `may_continue` finds.
module mech9_ball_angles
  use mech9_kinds, only: wp
  use mech9_tracking_tolerances, only: doubtful_margin
  use mech9_integration_tolerances, only: short_way
  use mech9_error, only: error_type
  use mech9_three_turns, only: swing_type, heading_type, three_turns_type
  use mech9_partition, only: partition_type
  use mech9_model, only: model_type
  use mech9_plan, only: plan_type, copy_plan
  use mech9_state, only: state_type, copy_state
  use mech9_frame_motion, only: place_all, spread_all_velocities, spread_all_accelerations
  use mech9_requested, only: requested_type
  use mech9_replanning, only: wanted_type
  use mech9_ball_joints, only: ball_joint_type, find_ball_joints
  use mech9_held_angles, only: held_angles_type
  implicit none
  private
  public :: ball_angles_type

  !> The angles. The plan and the state are polymorphic because these are copied by calls, which keeps the code of copies small.
  type :: ball_angles_type
    type(held_angles_type) :: held                    !< angles of rods that are held, and what they imply
    type(requested_type) :: requested                 !< the part of the motion that is worked out
    type(ball_joint_type), allocatable :: joints(:)   !< all whose angles may be replaced
    logical, allocatable :: replaced(:)               !< (joints) other angles are integrated
    class(plan_type), allocatable :: plan             !< with the angles of the data file; set where joints are found
    class(state_type), allocatable :: state           !< in these angles, as last shown
    real(wp) :: t = 0.0_wp                            !< time up to which the angles are continued [s]
    type(heading_type), allocatable, private :: headings(:)   !< (joints) at this time
    type(swing_type), allocatable, private :: swings(:)       !< (joints) motion at this time
    real(wp), private :: lock = 0.0_wp                !< distance from gimbal lock below which directions are not known [rad]
  contains
    procedure :: begin
    procedure :: restart
    procedure :: in_use
    procedure :: in_doubt
    procedure :: move_as
    procedure :: change
    procedure :: follow
    procedure :: may_continue
    procedure :: continue_to
    procedure :: in_lock
    procedure :: show
    procedure :: replaced_coordinates
    procedure :: longest_way
    procedure :: turns_in_use
    procedure :: give_same_wrenches
  end type ball_angles_type

contains

  !> Begin with the angles of the data file: find the rods that are held, then as `restart`.
  subroutine begin(self, model, requested, plan, state, err)
    class(ball_angles_type), intent(inout) :: self      !< the angles
    type(model_type), intent(in) :: model               !< the model
    type(requested_type), intent(in) :: requested       !< the part of the motion that is worked out
    type(plan_type), intent(inout) :: plan              !< with the angles of the data file; then of the integrated motion
    type(state_type), intent(inout) :: state            !< for this plan, with rates
    type(error_type), allocatable, intent(out) :: err   !< allocated if a user pair has no pose

    if (.not. allocated(self%plan)) allocate (self%plan, self%state)
    self%requested = requested
    call self%held%begin(model, plan)
    call self%restart(model, model%problem%partition, plan, state, err)
  end subroutine begin

  !> Find the ball joints of a plan and replace the angles of those that are near gimbal lock. In the angles that move the joints then,
  !> hold or free other angles of rods where these serve clearly better.
  subroutine restart(self, model, partition, plan, state, err)
    class(ball_angles_type), intent(inout) :: self      !< the angles; gets the partition of the motion
    type(model_type), intent(in) :: model               !< the model
    type(partition_type), intent(in) :: partition       !< of the coordinates, with the angles that were held so far
    type(plan_type), intent(inout) :: plan              !< with the angles of the data file; then of the integrated motion
    type(state_type), intent(inout) :: state            !< for this plan, with rates
    type(error_type), allocatable, intent(out) :: err   !< allocated if a user pair has no pose
    type(wanted_type) :: wanted
    type(state_type) :: given
    logical :: changed

    self%held%partition = partition
    call find_joints(self, model, plan)
    self%lock = model%request%solver%absolute_tolerance + model%request%solver%relative_tolerance
    if (size(self%joints) > 0) then
      call copy_plan(plan, self%plan)
      if (any(self%in_doubt(state%q))) then
        call copy_state(state, given)
        call self%change(given, plan, state, err)
        if (allocated(err)) return
      end if
    end if
    wanted%requested = self%requested
    wanted%from_known_only = self%in_use()
    call self%held%take_best(model, wanted, plan, state, changed, err)
    if (.not. allocated(err) .and. changed) call self%follow(model, plan, state, err)
    if (.not. allocated(err)) call self%held%hold_positions(plan, state)
  end subroutine restart

  !> Follow the integrated motion to other independent coordinates, whose partition is known: the joints, and the plan and the state in
  !> the angles of the data file.
  subroutine follow(self, model, plan, state, err)
    class(ball_angles_type), intent(inout) :: self      !< the angles; get joints, plan and state
    type(model_type), intent(in) :: model               !< the model
    type(plan_type), intent(in) :: plan                 !< of the integrated motion from now on
    type(state_type), intent(inout) :: state            !< for this plan, with rates; gets its frames
    type(error_type), allocatable, intent(out) :: err   !< allocated if a user pair has no pose
    type(ball_angles_type) :: before
    type(plan_type) :: given
    integer :: i, j, s, old

    call place_all(plan, state, err)
    if (allocated(err)) return
    before%replaced = self%replaced
    before%joints = self%joints
    before%headings = self%headings
    before%swings = self%swings
    call copy_plan(plan, given)
    do i = 1, size(before%joints)
      do j = 1, 3
        associate (step => before%joints(i)%steps(j), k => before%joints(i)%coordinates(j))
          s = plan%step_of(k)
          given%steps(s)%before = self%plan%steps(step)%before
          given%steps(s)%turn = self%plan%steps(step)%turn
          given%steps(s)%offset = self%plan%steps(step)%offset
        end associate
      end do
    end do
    call find_joints(self, model, given)
    do i = 1, size(self%joints)
      do old = 1, size(before%joints)
        if (any(self%joints(i)%coordinates /= before%joints(old)%coordinates)) cycle
        self%replaced(i) = before%replaced(old)
        self%headings(i) = before%headings(old)
        self%swings(i) = before%swings(old)
      end do
    end do
    if (size(self%joints) == 0) return
    call copy_plan(given, self%plan)
    if (.not. self%in_use()) return
    call carry_given_angles(self, state, err)
  end subroutine follow

  !> Carry the angles of the data file over to a state of a plan with other frames, in another order.
  subroutine carry_given_angles(self, state, err)
    class(ball_angles_type), intent(inout) :: self      !< the angles, with joints and plan; get the state
    type(state_type), intent(in) :: state               !< of the integrated motion
    type(error_type), allocatable, intent(out) :: err   !< allocated if a user pair has no pose
    type(state_type) :: given
    integer :: i

    call copy_state(state, given)
    do i = 1, size(self%joints)
      if (.not. self%replaced(i)) cycle
      associate (k => self%joints(i)%coordinates)
        given%q(k) = self%state%q(k)
        given%dq(k) = self%state%dq(k)
        given%ddq(k) = self%state%ddq(k)
      end associate
    end do
    call copy_state(given, self%state)
    call place_all(self%plan, self%state, err)
  end subroutine carry_given_angles

  !> Find the ball joints of a plan, none of whose angles is replaced yet.
  subroutine find_joints(self, model, plan)
    class(ball_angles_type), intent(inout) :: self      !< the angles; gets the joints
    type(model_type), intent(in) :: model               !< the model
    type(plan_type), intent(in) :: plan                 !< with the angles of the data file

    call find_ball_joints(model%mechanism, self%held%as_if_not_held(), plan, self%joints)
    if (allocated(self%replaced)) deallocate (self%replaced, self%headings, self%swings)
    allocate (self%replaced(size(self%joints)), source=.false.)
    allocate (self%headings(size(self%joints)), self%swings(size(self%joints)))
  end subroutine find_joints

  !> Whether angles of any joint are replaced.
  pure logical function in_use(self)
    class(ball_angles_type), intent(in) :: self   !< the angles

    in_use = .false.
    if (allocated(self%replaced)) in_use = any(self%replaced)
  end function in_use

  !> Whether each joint should change its angles: the integrated ones are near gimbal lock.
  pure function in_doubt(self, q)
    class(ball_angles_type), intent(in) :: self   !< the angles
    real(wp), intent(in) :: q(:)                  !< (M) integrated coordinates [rad, m]
    logical :: in_doubt(size(self%joints))
    integer :: i

    do i = 1, size(self%joints)
      associate (joint => self%joints(i), second => q(self%joints(i)%coordinates(2)))
        if (self%replaced(i)) then
          in_doubt(i) = joint%substitute%margin(second) < doubtful_margin
        else
          in_doubt(i) = joint%given%margin(second) < doubtful_margin
        end if
      end associate
    end do
  end function in_doubt

  !> Whether the same angles move the joints, and the same coordinates are independent, as with others of the same mechanism.
  pure logical function move_as(self, other)
    class(ball_angles_type), intent(in) :: self   !< the angles
    class(ball_angles_type), intent(in) :: other  !< angles of the other motion

    move_as = size(self%replaced) == size(other%replaced)
    if (move_as) move_as = all(self%replaced .eqv. other%replaced)
    if (move_as) move_as = all(self%held%partition%kind == other%held%partition%kind)
  end function move_as

  !> Change the angles of the joints that are in doubt. The plan and the state of the integrated motion follow from those in the
  !> angles of the data file, which must be shown.
  subroutine change(self, state, plan, changed, err)
    class(ball_angles_type), intent(inout) :: self      !< the angles
    type(state_type), intent(in) :: state               !< of the integrated motion, with rates
    type(plan_type), intent(out) :: plan                !< of the integrated motion from now on
    type(state_type), intent(out) :: changed            !< for this plan: the same positions and rates
    type(error_type), allocatable, intent(out) :: err   !< allocated if a user pair has no pose
    logical :: doubt(size(self%joints))
    integer :: i

    doubt = self%in_doubt(state%q)
    if (.not. self%in_use()) call copy_state(state, self%state)
    call copy_plan(self%plan, plan)
    call copy_state(self%state, changed)
    self%t = state%t
    do i = 1, size(self%joints)
      associate (joint => self%joints(i), k => self%joints(i)%coordinates)
        if (doubt(i)) then
          self%replaced(i) = .not. self%replaced(i)
          if (self%replaced(i)) call leave_given_angles(joint, self%state, self%headings(i), self%swings(i), changed)
        else if (self%replaced(i)) then
          changed%q(k) = state%q(k)
          changed%dq(k) = state%dq(k)
        end if
        if (self%replaced(i)) plan%steps(joint%steps) = joint%replaced
      end associate
    end do
    call place_all(plan, changed, err)
  end subroutine change

  !> The substitute angles of a joint, and the heading in the angles of the data file.
  subroutine leave_given_angles(joint, given, heading, motion, changed)
    type(ball_joint_type), intent(in) :: joint        !< the joint
    type(state_type), intent(in) :: given             !< in the angles of the data file
    type(heading_type), intent(out) :: heading        !< in these angles
    type(swing_type), intent(out) :: motion           !< of the joint, in the substitute angles
    type(state_type), intent(inout) :: changed        !< gets the substitute angles and their rates
    type(heading_type) :: other
    real(wp) :: spin, q(3), dq(3), ddq(3)

    associate (k => joint%coordinates, turns => joint%given)
      motion = turns%swing(given%q(k), given%dq(k), given%ddq(k))
      spin = motion%spin(1)
      call joint%substitute%continue_heading(motion, 0.0_wp, other)
      call joint%substitute%coordinates(motion, other, 0.0_wp, q, dq, ddq)
      changed%q(k) = q
      changed%dq(k) = dq
      motion = joint%substitute%swing(q, dq, ddq)
      heading%first = turns%sign(1)*given%q(k(1)) + turns%shift(1)
      heading%second = turns%sign(2)*given%q(k(2)) + turns%shift(2)
      heading%lead = spin - motion%spin(1)
    end associate
  end subroutine leave_given_angles

  !> Whether the way of each joint since the last continuation is so short that its angles can be continued at once.
  pure logical function may_continue(self, state)
    class(ball_angles_type), intent(in) :: self   !< the angles
    type(state_type), intent(in) :: state         !< of the integrated motion
    type(swing_type) :: motion
    real(wp) :: way, far
    integer :: i

    may_continue = .true.
    do i = 1, size(self%joints)
      if (.not. self%replaced(i)) cycle
      motion = swing_of(self%joints(i), state)
      associate (turns => self%joints(i)%given)
        way = 2.0_wp*abs(state%t - self%t)*max(turns%speed(motion), turns%speed(self%swings(i)))
        far = max(turns%distance(motion), turns%distance(self%swings(i)))
      end associate
      may_continue = way <= max(self%lock, short_way*far)
      if (.not. may_continue) return
    end do
  end function may_continue

  !> The time in which the joints go ways over which their angles may be continued at once, at their present speed [s].
  pure real(wp) function longest_way(self) result(time)
    class(ball_angles_type), intent(in) :: self   !< the angles
    real(wp) :: speed
    integer :: i

    time = huge(time)
    do i = 1, size(self%joints)
      if (.not. self%replaced(i)) cycle
      associate (turns => self%joints(i)%given)
        speed = turns%speed(self%swings(i))
        if (speed > 0.0_wp) time = min(time, 0.5_wp*max(self%lock, short_way*turns%distance(self%swings(i)))/speed)
      end associate
    end do
  end function longest_way

  !> Whether other angles are in use, and the pairs of the joints pass on the same wrenches about the same points in these as in
  !> the angles of the data file.
  pure logical function give_same_wrenches(self)
    class(ball_angles_type), intent(in) :: self   !< the angles
    integer :: i

    give_same_wrenches = self%in_use()
    if (.not. give_same_wrenches) return
    do i = 1, size(self%joints)
      if (self%replaced(i)) give_same_wrenches = give_same_wrenches .and. self%joints(i)%centred
    end do
  end function give_same_wrenches

  !> The turns by which a joint moves at present.
  pure function turns_in_use(self, joint) result(turns)
    class(ball_angles_type), intent(in) :: self   !< the angles
    integer, intent(in) :: joint                  !< number of the joint
    type(three_turns_type) :: turns

    turns = self%joints(joint)%given
    if (self%replaced(joint)) turns = self%joints(joint)%substitute
  end function turns_in_use

  !> Continue the angles of the data file to a state.
  pure subroutine continue_to(self, state)
    class(ball_angles_type), intent(inout) :: self   !< the angles
    type(state_type), intent(in) :: state            !< of the integrated motion
    integer :: i

    do i = 1, size(self%joints)
      if (.not. self%replaced(i)) cycle
      self%swings(i) = swing_of(self%joints(i), state)
      call self%joints(i)%given%continue_heading(self%swings(i), self%lock, self%headings(i))
    end do
    self%t = state%t
  end subroutine continue_to

  !> The motion of a joint whose angles are replaced.
  pure function swing_of(joint, state) result(motion)
    type(ball_joint_type), intent(in) :: joint   !< the joint
    type(state_type), intent(in) :: state        !< of the integrated motion
    type(swing_type) :: motion

    associate (k => joint%coordinates)
      motion = joint%substitute%swing(state%q(k), state%dq(k), state%ddq(k))
    end associate
  end function swing_of

  !> Whether the angles of the data file are in gimbal lock, so that their accelerations depend on third derivatives.
  pure logical function in_lock(self)
    class(ball_angles_type), intent(in) :: self   !< the angles, continued to the state that is meant
    integer :: i

    in_lock = .false.
    do i = 1, size(self%joints)
      if (self%replaced(i)) in_lock = in_lock .or. self%joints(i)%given%in_lock(self%swings(i), self%lock)
    end do
  end function in_lock

  !> Show a state, to which the angles are continued, in the angles of the data file.
  subroutine show(self, state, dddq, err)
    class(ball_angles_type), intent(inout) :: self      !< the angles
    type(state_type), intent(in) :: state               !< of the integrated motion, with accelerations
    real(wp), intent(in) :: dddq(:)                     !< (M) third derivatives; used in gimbal lock [rad/s^3, m/s^3]
    type(error_type), allocatable, intent(out) :: err   !< allocated if a user pair has no pose
    real(wp) :: q(3), dq(3), ddq(3)
    integer :: i

    call copy_state(state, self%state)
    do i = 1, size(self%joints)
      if (.not. self%replaced(i)) cycle
      associate (joint => self%joints(i), k => self%joints(i)%coordinates)
        call joint%substitute%add_jerk(state%q(k), state%dq(k), state%ddq(k), dddq(k), self%swings(i))
        call joint%given%coordinates(self%swings(i), self%headings(i), self%lock, q, dq, ddq)
        self%state%q(k) = q
        self%state%dq(k) = dq
        self%state%ddq(k) = ddq
      end associate
    end do
    call place_all(self%plan, self%state, err)
    if (allocated(err)) return
    call spread_all_velocities(self%plan, self%state)
    call spread_all_accelerations(self%plan, self%state)
  end subroutine show

  !> The coordinates whose angles are replaced, ascending.
  pure function replaced_coordinates(self) result(coordinates)
    class(ball_angles_type), intent(in) :: self   !< the angles
    integer, allocatable :: coordinates(:)
    logical :: is_replaced(self%plan%n_coordinates)
    integer :: i

    is_replaced = .false.
    if (self%in_use()) then
      do i = 1, size(self%joints)
        if (self%replaced(i)) is_replaced(self%joints(i)%coordinates) = .true.
      end do
    end if
    coordinates = pack([(i, i=1, size(is_replaced))], is_replaced)
  end function replaced_coordinates
end module mech9_ball_angles
