!> Mechanisms at random, planar, spherical and spatial, some with redundant equations, driven far: few outputs
!> and many give the same motion, and the same end where there is one.
!>
!> Compares the program with itself: motions with few and with many outputs.
module test_random_motion
  use mech9_kinds, only: wp
  use mech9_error, only: error_type, exit_singular
  use mech9_random, only: random_type
  use mech9_model, only: model_type
  use mech9_harmonic_law, only: harmonic_law_type
  use mech9_plan, only: plan_type
  use mech9_state, only: state_type
  use mech9_planning, only: make_plan
  use mech9_driven_motion, only: driven_motion_type, start_driven_motion, advance
  use mech9_mechanism_families, only: axis_type, planar_axes, spatial_axes, spherical_axes, home_mechanism, random_links
  use mech9_home_motions, only: loop_equations, choose_dependent
  use mech9_testing, only: tester_type, message_of
  implicit none
  private
  public :: run

contains

  !> Run the cases of this suite.
  subroutine run(test)
    type(tester_type), intent(inout) :: test   !< selects cases and counts their checks

    if (test%runs('random_mechanisms')) call random_mechanisms(test)
  end subroutine run

  subroutine random_mechanisms(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    integer :: i
    type(random_type) :: random
    integer :: ends
    integer :: goes_on

    ends = 0
    goes_on = 0
    do i = 1, 100
      call try(test, random, ends, goes_on, 'planar', 4 + modulo(3*i, 9), 1 + modulo(i, 3), 1)
      call try(test, random, ends, goes_on, 'spherical', 4 + modulo(3*i, 5), 1 + modulo(i, 2), 2)
      call try(test, random, ends, goes_on, 'spatial', 7 + modulo(3*i, 9), 1 + modulo(i, 2), 3)
    end do
    print '(i0,a,i0,a)', goes_on, ' motions to their end, ', ends, ' up to a singular position'
    call test%is_true(ends > 10 .and. goes_on > 10, 'motions that end and motions that go on are both among them')
  end subroutine random_mechanisms

  subroutine try(test, random, ends, goes_on, name, n_links, loops, family)
    type(tester_type), intent(inout) :: test     !< counts the checks
    type(random_type), intent(inout) :: random   !< source of the numbers
    integer, intent(inout) :: ends               !< motions that end at singular positions
    integer, intent(inout) :: goes_on            !< motions to their end
    character(len=*), intent(in) :: name         !< of the mechanism, for the report of a failure
    integer, intent(in) :: n_links               !< links, the frame included
    integer, intent(in) :: loops                 !< closed chains
    integer, intent(in) :: family                !< of the axes
    integer, allocatable :: links(:, :)
    type(axis_type), allocatable :: axes(:)
    real(wp), allocatable :: equations(:, :)
    logical, allocatable :: dependent(:)
    type(model_type) :: model
    integer :: k

    allocate (links, source=random_links(n_links, loops, random))
    if (family == 1) axes = planar_axes(size(links, 2), 5, random)
    if (family == 2) axes = spherical_axes(size(links, 2), random)
    if (family == 3) axes = spatial_axes(size(links, 2), 5, random)
    call loop_equations(n_links, links, axes, equations)
    allocate (dependent(size(axes)))
    call choose_dependent(equations, random, dependent)
    if (all(dependent)) return
    call home_mechanism(n_links, links, axes, pack([(k, k=1, size(axes))], .not. dependent), model)
    call compare(test, random, ends, goes_on, name, model)
  end subroutine try

  !> Swing all independent coordinates.
  subroutine compare(test, random, ends, goes_on, name, model)
    type(tester_type), intent(inout) :: test     !< counts the checks
    type(random_type), intent(inout) :: random   !< source of the numbers
    integer, intent(inout) :: ends               !< motions that end at singular positions
    integer, intent(inout) :: goes_on            !< motions to their end
    character(len=*), intent(in) :: name         !< of the mechanism, for the report of a failure
    type(model_type), intent(inout) :: model     !< the model
    type(plan_type) :: plan
    type(state_type) :: start
    type(driven_motion_type) :: few, many
    type(error_type), allocatable :: err, few_err, many_err
    type(harmonic_law_type) :: swing
    integer :: i

    call make_plan(model%mechanism, model%problem%partition, model%problem%initial%position, plan, start, err)
    call test%no_error(err, name//': there is a plan')
    if (allocated(err)) return
    deallocate (model%problem%drives)
    allocate (model%problem%drives(size(plan%independent)))
    do i = 1, size(plan%independent)
      swing%coordinate = plan%independent(i)
      swing%amplitude = 3.0_wp*plan%unit_of(swing%coordinate)*random%symmetric()
      swing%angular_frequency = 2.0_wp + random%symmetric()
      swing%mean = start%q(swing%coordinate)
      allocate (model%problem%drives(i)%drive, source=swing)
    end do
    call follow(model, plan, start, 2, few, few_err)
    call follow(model, plan, start, 1500, many, many_err)
    call test%is_true(allocated(few_err) .eqv. allocated(many_err), name//': both motions end or none')
    if (allocated(few_err) .neqv. allocated(many_err)) then
      if (allocated(few_err)) print '(2a)', '  few: ', message_of(few_err)
      if (allocated(many_err)) print '(2a)', '  many: ', message_of(many_err)
      return
    end if
    if (allocated(few_err)) then
      ends = ends + 1
      call test%has_error(few_err, exit_singular, name//': the motion ends at a singular position')
      call test%near(few%ahead%t, many%ahead%t, 1.0e-9_wp, name//': both motions end at one time')
    else
      goes_on = goes_on + 1
      ! round-off of positions over the least singular value
      call test%near(maxval(abs(few%state%q - many%state%q)/plan%unit_of), 0.0_wp, &
                     1.0e-13_wp/min(few%conditioning%least, many%conditioning%least), name//': both motions come to one position')
    end if
  end subroutine compare

  subroutine follow(model, plan, start, outputs, driven, err)
    type(model_type), intent(in) :: model               !< the model
    type(plan_type), intent(in) :: plan                 !< its plan
    type(state_type), intent(in) :: start               !< assembled position
    integer, intent(in) :: outputs                      !< how many
    type(driven_motion_type), intent(out) :: driven     !< at the last output
    type(error_type), allocatable, intent(out) :: err   !< allocated if it failed
    integer :: j

    call start_driven_motion(model%problem%drives, plan, start, 0.0_wp, driven, err)
    do j = 1, outputs
      if (allocated(err)) return
      call advance(model%problem%drives, plan, driven, 5.0_wp*j/outputs, err)
    end do
  end subroutine follow
end module test_random_motion
