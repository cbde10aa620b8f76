!> A robot as the draft of a data file: groups, their values, and numbers as text.
module test_robot_draft
  use mech9_kinds, only: wp
  use mech9_error, only: error_type
  use mech9_orientations, only: rotation_of_rpy
  use mech9_draft, only: draft_type
  use mech9_xml_tree, only: xml_tree_type
  use mech9_robot, only: robot_type, robot_joint_type, revolute_joint, prismatic_joint
  use mech9_pair_series, only: series_type, find_series
  use mech9_robot_draft, only: draft_of_robot, number_text
  use mech9_testing, only: tester_type
  implicit none
  private
  public :: run

contains

  !> Run the cases of this suite.
  subroutine run(tester)
    type(tester_type), intent(inout) :: tester   !< selects cases and counts their checks

    if (tester%runs('numbers')) call numbers(tester)
    if (tester%runs('pairs')) call pairs(tester)
    if (tester%runs('coupling_and_loads')) call coupling_and_loads(tester)
    if (tester%runs('starts')) call starts(tester)
    if (tester%runs('points')) call points(tester)
    if (tester%runs('bodies')) call bodies(tester)
  end subroutine run

  !> A frame, a turning link and a link that slides on it.
  subroutine small_robot(robot, series)
    type(robot_type), intent(out) :: robot     !< the robot
    type(series_type), intent(out) :: series   !< its pairs
    type(xml_tree_type) :: tree
    type(robot_joint_type) :: joint
    type(error_type), allocatable :: err

    call tree%begin('c.xml')
    call tree%add_element(0, 'robot', 1, 1)
    call robot%begin('URDF')
    call robot%add_link(tree, 1, 'base', err)
    call robot%add_link(tree, 1, 'arm', err)
    call robot%add_link(tree, 1, 'hand', err)
    robot%name = "it's"
    joint%name = 'turn'
    joint%kind = revolute_joint
    joint%links = [1, 2]
    joint%axis = [0.0_wp, 0.0_wp, 1.0_wp]
    joint%frames(1)%p = [0.5_wp, 0.0_wp, 0.0_wp]
    joint%has_range = .true.
    joint%range = [-1.0_wp, 2.0_wp]
    call robot%add_joint(tree, 1, joint, err)
    joint%name = 'slide'
    joint%kind = prismatic_joint
    joint%links = [2, 3]
    joint%frames(1)%r = rotation_of_rpy([0.0_wp, 2.0_wp*atan(1.0_wp), 0.0_wp])
    joint%has_range = .false.
    joint%leader = 'turn'
    joint%ratio = 0.25_wp
    joint%offset = -1.5_wp
    joint%stiffness = 4.0_wp
    joint%rest = 0.125_wp
    call robot%add_joint(tree, 1, joint, err)
    robot%links(3)%mass = 2.0_wp
    robot%links(3)%inertia = reshape([1.0_wp, 4.0_wp, 5.0_wp, 4.0_wp, 2.0_wp, 6.0_wp, 5.0_wp, 6.0_wp, 3.0_wp], [3, 3])
    call robot%add_point('tool tip', 3, [0.0_wp, 0.0_wp, 1.0_wp])
    call robot%add_point('tool.tip', 3, [0.0_wp, 0.0_wp, 2.0_wp])
    call robot%add_point('fixed', 1, [0.0_wp, 0.0_wp, 2.0_wp])
    call robot%finish()
    call find_series(robot, series, err)
  end subroutine small_robot

  !> A number is written with as few digits as read back to itself.
  subroutine numbers(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    real(wp), parameter :: some(7) = [0.1_wp, 1.0_wp/3.0_wp, -9.81_wp, 1.0e-99_wp, 1.0e99_wp, acos(-1.0_wp), 0.1_wp + 0.2_wp]
    character(len=:), allocatable :: text
    real(wp) :: back
    integer :: i, status

    do i = 1, size(some)
      text = number_text(some(i))
      read (text, *, iostat=status) back
      call tester%is_true(status == 0 .and. .not. abs(back - some(i)) > 0.0_wp, 'a number reads back: '//text)
    end do
    call tester%is_true(len(number_text(0.1_wp)) < 12, 'a short number is short: '//number_text(0.1_wp))
  end subroutine numbers

  subroutine pairs(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(robot_type) :: robot
    type(series_type) :: series
    type(draft_type) :: draft

    call small_robot(robot, series)
    call draft_of_robot(robot, series, [.true., .false.], [0.0_wp, 0.0_wp], .true., draft)
    call tester%is_true(draft%value('mechanism', 1, 'title') == "'it''s'", 'the title is quoted')
    call tester%is_true(draft%number('mechanism', 1, 'links') == 3, 'the number of links')
    call tester%is_true(draft%number('mechanism', 1, 'coordinates') == 2, 'the number of coordinates')
    call tester%is_true(draft%value('structure', 1, 'cq') == '1', 'the independent coordinate')
    call tester%is_true(draft%count_of('pair') == 2, 'two pairs')
    call tester%is_true(draft%value('pair', 1, 'kind') == "'revolute'" .and. draft%value('pair', 1, 'links') == '1, 2', 'a turn')
    call tester%is_true(same_numbers(draft%value('pair', 1, 'point'), [0.5_wp, 0.0_wp, 0.0_wp]), 'its place')
    call tester%is_true(same_numbers(draft%value('pair', 1, 'axis'), [0.0_wp, 0.0_wp, 1.0_wp]), 'its axis')
    call tester%is_true(.not. draft%has('pair', 1, 'moving_axis'), 'equal directions are given once')
    call tester%is_true(same_numbers(draft%value('pair', 2, 'axis'), [1.0_wp, 0.0_wp, 0.0_wp]), 'an axis without round-off')
    call tester%is_true(same_numbers(draft%value('pair', 2, 'moving_axis'), [0.0_wp, 0.0_wp, 1.0_wp]), 'the axis in the other link')
    call tester%is_true(draft%has('pair', 2, 'zero') .and. draft%has('pair', 2, 'moving_zero'), 'directions of zero in both links')
    call tester%is_true(index(draft%groups(draft%find('pair', 1))%comment, 'joint turn, range -1') > 0, 'the range is a comment')
  end subroutine pairs

  !> q2 - ratio q1 = offset.
  subroutine coupling_and_loads(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(robot_type) :: robot
    type(series_type) :: series
    type(draft_type) :: draft

    call small_robot(robot, series)
    call draft_of_robot(robot, series, [.true., .false.], [0.0_wp, 0.0_wp], .true., draft)
    call tester%is_true(draft%count_of('coupling') == 1 .and. draft%value('coupling', 1, 'coordinates') == '2, 1', 'a coupling')
    call tester%is_true(same_numbers(draft%value('coupling', 1, 'coefficients'), [1.0_wp, -0.25_wp]), 'its coefficients')
    call tester%is_true(same_numbers(draft%value('coupling', 1, 'constant'), [-1.5_wp]), 'its constant')
    call tester%is_true(draft%count_of('load') == 1 .and. draft%number('load', 1, 'coordinate') == 2, 'a load')
    call tester%is_true(same_numbers(draft%value('load', 1, 'stiffness'), [4.0_wp]), 'its stiffness')
    call tester%is_true(same_numbers(draft%value('load', 1, 'rest'), [0.125_wp]), 'its rest')
    call tester%is_true(.not. draft%has('load', 1, 'damping'), 'no damping')
  end subroutine coupling_and_loads

  !> Independent coordinates have drives or initial values, the others have guesses.
  subroutine starts(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(robot_type) :: robot
    type(series_type) :: series
    type(draft_type) :: draft

    call small_robot(robot, series)
    call draft_of_robot(robot, series, [.true., .false.], [0.75_wp, 3.0_wp], .true., draft)
    call tester%is_true(draft%count_of('drive') == 1 .and. draft%number('drive', 1, 'coordinate') == 1, 'a drive')
    call tester%is_true(same_numbers(draft%value('drive', 1, 'coefficients'), [0.75_wp]), 'it holds the start')
    call tester%is_true(draft%count_of('initial') == 1 .and. draft%number('initial', 1, 'coordinate') == 2, 'a guess')
    call draft_of_robot(robot, series, [.true., .false.], [0.75_wp, 3.0_wp], .false., draft)
    call tester%is_true(draft%count_of('drive') == 0 .and. draft%count_of('initial') == 2, 'initial values without drives')
    call tester%is_true(same_numbers(draft%value('initial', 2, 'position'), [3.0_wp]), 'the second position')
  end subroutine starts

  !> Names have letters that data files allow, and differ.
  subroutine points(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(robot_type) :: robot
    type(series_type) :: series
    type(draft_type) :: draft

    call small_robot(robot, series)
    call draft_of_robot(robot, series, [.true., .false.], [0.0_wp, 0.0_wp], .true., draft)
    call tester%is_true(draft%count_of('point') == 2, 'points of the frame are left out')
    call tester%is_true(draft%value('point', 1, 'name') == "'tool_tip'", 'a blank in a name')
    call tester%is_true(draft%value('point', 2, 'name') == "'tool_tip_2'", 'two names that would be equal')
    robot%n_points = 0
    call draft_of_robot(robot, series, [.true., .false.], [0.0_wp, 0.0_wp], .true., draft)
    call tester%is_true(draft%count_of('point') == 1 .and. draft%value('point', 1, 'name') == "'hand'", 'the end of an open chain')
  end subroutine points

  subroutine bodies(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(robot_type) :: robot
    type(series_type) :: series
    type(draft_type) :: draft

    call small_robot(robot, series)
    call draft_of_robot(robot, series, [.true., .false.], [0.0_wp, 0.0_wp], .true., draft)
    call tester%is_true(draft%count_of('body') == 1 .and. draft%number('body', 1, 'link') == 3, 'links without mass have no body')
    call tester%is_true(same_numbers(draft%value('body', 1, 'inertia'), [1.0_wp, 2.0_wp, 3.0_wp, 4.0_wp, 5.0_wp, 6.0_wp]), &
                        'the order of data files: xx, yy, zz, xy, xz, yz')
    call tester%is_true(same_numbers(draft%value('gravity', 1, 'acceleration'), [0.0_wp, 0.0_wp, -9.81_wp]), 'gravity')
  end subroutine bodies

  !> Whether a text holds these numbers.
  function same_numbers(text, numbers) result(same)
    character(len=*), intent(in) :: text   !< numbers with commas between them
    real(wp), intent(in) :: numbers(:)     !< the right numbers
    logical :: same
    real(wp) :: read_back(size(numbers))
    integer :: status

    read (text, *, iostat=status) read_back
    same = status == 0
    if (same) same = all(abs(read_back - numbers) <= 0.0_wp)
  end function same_numbers
end module test_robot_draft
