!> Overconstrained mechanisms of known mobility: driven at each of their coordinates they are closed, move,
!> and are planned in blocks that their chains taken alone allow.
module test_overconstrained
  use mech9_kinds, only: wp, pi
  use mech9_error, only: error_type, exit_structure
  use mech9_pose, only: pose_type, compose, identity_pose
  use mech9_model, only: model_type
  use mech9_plan, only: plan_type
  use mech9_state, only: state_type
  use mech9_planning, only: make_plan
  use mech9_mechanism_families, only: axis_type, home_mechanism, plan_at_home
  use mech9_plan_checks, only: check_order, check_closed, block_sizes
  use mech9_testing, only: tester_type
  implicit none
  private
  public :: run

  integer, parameter :: four(2, 4) = reshape([1, 2, 2, 3, 3, 4, 4, 1], [2, 4])
  integer, parameter :: six(2, 6) = reshape([1, 2, 2, 3, 3, 4, 4, 5, 5, 6, 6, 1], [2, 6])
  !> Two loops of four with links 1 and 2, and the pair between these, in common.
  integer, parameter :: two_fours(2, 7) = reshape([1, 2, 2, 3, 3, 4, 4, 1, 2, 5, 5, 6, 6, 1], [2, 7])
  !> Three legs of three pairs between links 1 and 2.
  integer, parameter :: three_legs(2, 9) = reshape([1, 3, 3, 4, 4, 2, 1, 5, 5, 6, 6, 2, 1, 7, 7, 8, 8, 2], [2, 9])

contains

  !> Run the cases of this suite.
  subroutine run(test)
    type(tester_type), intent(inout) :: test   !< selects cases and counts their checks

    if (test%runs('single_loops')) call single_loops(test)
    if (test%runs('two_bennett_loops')) call two_bennett_loops(test)
    if (test%runs('three_legs_of_sarrus')) call three_legs_of_sarrus(test)
    if (test%runs('wrong_inputs')) call wrong_inputs(test)
    if (test%runs('locked')) call locked(test)
  end subroutine run

  subroutine single_loops(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    integer :: k

    do k = 1, 4
      call check(test, 'Bennett', 4, four, bennett(0.7_wp, 1.9_wp, 1.1_wp), k, [3])
    end do
    do k = 1, 6
      call check(test, 'Bricard', 6, six, bricard(), k, [5])
      call check(test, 'Sarrus', 6, six, [leg(0.0_wp), reversed(leg(0.5_wp*pi))], k, [5])
    end do
  end subroutine single_loops

  !> Whichever loop is driven goes first, though each has six dimensions to determine four coordinates with.
  subroutine two_bennett_loops(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(axis_type) :: first(4), second(4)
    integer :: k

    first = bennett(0.7_wp, 1.9_wp, 1.1_wp)
    second = bennett(0.5_wp, 1.2_wp, 0.8_wp)
    do k = 1, 7
      call check(test, 'two Bennett loops', 6, two_fours, [first, second(2:)], k, [3, 3])
    end do
    call fails(test, 'two Bennett loops with two inputs', 6, two_fours, [first, second(2:)], [3, 6])
  end subroutine two_bennett_loops

  !> The third leg only follows.
  subroutine three_legs_of_sarrus(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    integer :: k

    do k = 1, 9
      call check(test, 'Sarrus with three legs', 8, three_legs, [leg(0.0_wp), leg(0.5_wp*pi), leg(0.8_wp*pi)], k)
    end do
  end subroutine three_legs_of_sarrus

  subroutine wrong_inputs(test)
    type(tester_type), intent(inout) :: test   !< counts the checks

    call fails(test, 'Bennett with two inputs', 4, four, bennett(0.7_wp, 1.9_wp, 1.1_wp), [1, 2])
  end subroutine wrong_inputs

  !> Twists and lengths that do not fit: closed at home, it cannot move.
  subroutine locked(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(axis_type) :: axes(4)

    axes = bennett(0.7_wp, 1.9_wp, 1.1_wp)
    axes(3)%along = axes(3)%along + [0.0_wp, 0.1_wp, 0.2_wp]
    call fails(test, 'four revolutes at random', 4, four, axes, [1])
  end subroutine locked

  !> Bennett's loop in a position given by the angle at its first pair: opposite links alike, lengths as the
  !> sines of their twists, and tan(t1/2) tan(t2/2) = sin((b + a)/2)/sin((b - a)/2).
  pure function bennett(twist_a, twist_b, angle) result(axes)
    real(wp), intent(in) :: twist_a   !< of the first link [rad]
    real(wp), intent(in) :: twist_b   !< of the second link [rad]
    real(wp), intent(in) :: angle     !< at the first pair [rad]
    type(axis_type) :: axes(4)
    real(wp) :: angles(4), twists(4)
    type(pose_type) :: place
    integer :: i

    angles(1) = angle
    angles(2) = 2.0_wp*atan(sin(0.5_wp*(twist_b + twist_a))/sin(0.5_wp*(twist_b - twist_a))/tan(0.5_wp*angle))
    angles(3:4) = -angles(1:2)
    twists = [twist_a, twist_b, twist_a, twist_b]
    place = identity_pose
    do i = 1, 4
      axes(i)%point = place%p
      axes(i)%along = place%r(:, 3)
      place = compose(place, turned_and_gone(angles(i), sin(twists(i)), twists(i)))
    end do
  end function bennett

  !> A turn about z, a way along x, a twist about x.
  pure function turned_and_gone(angle, way, twist) result(pose)
    real(wp), intent(in) :: angle   !< about z [rad]
    real(wp), intent(in) :: way     !< along x [m]
    real(wp), intent(in) :: twist   !< about x [rad]
    type(pose_type) :: pose

    pose%r(:, 1) = [cos(angle), sin(angle), 0.0_wp]
    pose%r(:, 2) = [-sin(angle)*cos(twist), cos(angle)*cos(twist), sin(twist)]
    pose%r(:, 3) = [sin(angle)*sin(twist), -cos(angle)*sin(twist), cos(twist)]
    pose%p = way*pose%r(:, 1)
  end function turned_and_gone

  !> Bricard's loop along six edges of a cube, each axis normal to the two edges that meet on it.
  pure function bricard() result(axes)
    type(axis_type) :: axes(6)
    real(wp), parameter :: points(3, 6) = reshape(real([1, 0, 0, 1, -1, 0, 1, -1, 1, 0, -1, 1, 0, 0, 1, 0, 0, 0], wp), [3, 6])
    integer :: i

    do i = 1, 6
      axes(i)%point = points(:, i)
      axes(i)%along = 0.0_wp
      axes(i)%along(1 + modulo(i + 1, 3)) = 1.0_wp
    end do
  end function bricard

  !> Three parallel horizontal axes, one above the other but for the middle one, in a plane turned by an angle.
  pure function leg(angle) result(axes)
    real(wp), intent(in) :: angle   !< of its plane about the vertical [rad]
    type(axis_type) :: axes(3)
    real(wp), parameter :: out(3) = [1.0_wp, 1.6_wp, 1.2_wp], up(3) = [0.0_wp, 0.5_wp, 1.1_wp]
    integer :: i

    do i = 1, 3
      axes(i)%point = [out(i)*cos(angle), out(i)*sin(angle), up(i)]
      axes(i)%along = [-sin(angle), cos(angle), 0.0_wp]
    end do
  end function leg

  pure function reversed(axes) result(back)
    type(axis_type), intent(in) :: axes(:)   !< in order
    type(axis_type) :: back(size(axes))

    back = axes(size(axes):1:-1)
  end function reversed

  !> Mobility one: closed at home, and with the driven coordinate turned by a little.
  subroutine check(test, name, n_links, links, axes, driven, sizes)
    type(tester_type), intent(inout) :: test    !< counts the checks
    character(len=*), intent(in) :: name        !< of the mechanism, for the report of a failure
    integer, intent(in) :: n_links              !< links, the frame included
    integer, intent(in) :: links(:, :)          !< (2,M) reference and moving link of each pair
    integer, intent(in) :: driven               !< number of the driven coordinate
    type(axis_type), intent(in) :: axes(:)      !< of each pair in the home position
    integer, intent(in), optional :: sizes(:)   !< unknowns of the blocks
    type(model_type) :: model
    type(plan_type) :: plan
    type(state_type) :: state
    type(error_type), allocatable :: err
    integer, allocatable :: found(:)
    integer :: i

    call home_mechanism(n_links, links, axes, [driven], model)
    do i = 0, 4
      if (i > 0) model%problem%initial%position = state%q
      model%problem%initial%position(driven) = 0.03_wp*i
      call make_plan(model%mechanism, model%problem%partition, model%problem%initial%position, plan, state, err)
      call test%no_error(err, name//': the mechanism is assembled')
      if (allocated(err)) return
      call check_order(test, plan, name)
      call check_closed(test, plan, state, name)
    end do
    if (.not. present(sizes)) return
    found = block_sizes(plan)
    call test%is_true(size(found) == size(sizes), name//': the number of blocks is right')
    if (size(found) == size(sizes)) call test%is_true(all(found == sizes), name//': the blocks have the right numbers of unknowns')
  end subroutine check

  subroutine fails(test, name, n_links, links, axes, cq)
    type(tester_type), intent(inout) :: test   !< counts the checks
    character(len=*), intent(in) :: name       !< of the mechanism, for the report of a failure
    integer, intent(in) :: n_links             !< links, the frame included
    integer, intent(in) :: links(:, :)         !< (2,M) reference and moving link of each pair
    integer, intent(in) :: cq(:)               !< independent coordinates
    type(axis_type), intent(in) :: axes(:)     !< of each pair in the home position
    type(error_type), allocatable :: err

    call plan_at_home(n_links, links, axes, cq, err)
    call test%has_error(err, exit_structure, name//': the mechanism is refused')
  end subroutine fails
end module test_overconstrained
