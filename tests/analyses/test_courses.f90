!> Numbers along the motions of four-bar designs, with their derivatives by the lengths: transmission angles, angles of all links and
!> extreme values in closed form, and the regularity of the chain against its definition by differences.
module test_courses
  use mech9_program_kind, only: kinematics
  use mech9_kinds, only: wp, pi
  use mech9_error, only: error_type
  use mech9_differentiation, only: half_width, derivatives_from_stencil
  use mech9_source, only: source_from_text
  use mech9_document, only: document_type
  use mech9_diagnostics, only: diagnostics_type
  use mech9_parser, only: parse_document
  use mech9_reader, only: read_model
  use mech9_varied_document, only: varied_document_type, new_varied_document
  use mech9_model, only: model_type
  use mech9_plan, only: plan_type
  use mech9_state, only: state_type
  use mech9_driven_simulation, only: assemble_driven
  use mech9_design_space, only: design_space_type, design_type, new_design_space, new_design, place_design, find_tangents
  use mech9_open_position, only: open_position_type, new_open_position, place_at, find_derivatives
  use mech9_closed_changes, only: closed_changes_type, find_closed_changes
  use mech9_course_extreme, only: course_place_type, sample_course, find_least
  use mech9_transmission, only: transmission_type, find_transmission, has_transmission_angle
  use mech9_regularity, only: regularity_type
  use mech9_planar_mechanisms, only: four_bar_type, four_bar_guess
  use mech9_testing, only: tester_type
  implicit none
  private
  public :: run

  type(four_bar_type), parameter :: bar = four_bar_type(ground=1.0_wp, crank=0.4_wp, coupler=0.9_wp, rocker=0.7_wp)
  !> Angle of the crank at time zero [rad], and its rate [rad/s].
  real(wp), parameter :: start_angle = 0.3_wp, omega = 2.0_wp
  character(len=*), parameter :: text = '&structure cq=1 / '// &
    '&pair coordinate=1, links=1,2, kind=''revolute'', axis=0,0,1 / '// &
    '&pair coordinate=2, links=2,3, kind=''revolute'', axis=0,0,1, point=0.4,0,0, moving_point=0,0,0 / '// &
    '&pair coordinate=3, links=3,4, kind=''revolute'', axis=0,0,1, point=0.9,0,0, moving_point=0.7,0,0 / '// &
    '&pair coordinate=4, links=1,4, kind=''revolute'', axis=0,0,1, point=1,0,0, moving_point=0,0,0 / '// &
    '&initial coordinate=2, position=0.7 / &initial coordinate=3, position=0.9 / &initial coordinate=4, position=1.9 / '// &
    '&drive coordinate=1, kind=''polynomial'', coefficients=0.3,2 / &time end=3, intervals=10 / '// &
    '&parameter name=''ground'', sets=''pair(4).point(1)'', low=0.8, high=1.2 / '// &
    '&parameter name=''crank'', sets=''pair(2).point(1)'', low=0.3, high=0.5 / '// &
    '&parameter name=''coupler'', sets=''pair(3).point(1)'', low=0.8, high=1.1 / '// &
    '&parameter name=''rocker'', sets=''pair(3).moving_point(1)'', low=0.6, high=0.8 / '

contains

  !> Run the cases of this suite.
  subroutine run(tester)
    type(tester_type), intent(inout) :: tester   !< selects cases and counts their checks

    if (tester%runs('coordinates')) call coordinates(tester)
    if (tester%runs('transmission_angle')) call transmission_angle(tester)
    if (tester%runs('extremes')) call extremes(tester)
    if (tester%runs('no_angle')) call no_angle(tester)
    if (tester%runs('regular_chain')) call regular_chain(tester)
  end subroutine run

  !> The designs of the four-bar, and the one of its text.
  subroutine prepare(tester, varied, space, design, position)
    type(tester_type), intent(inout) :: tester                        !< counts the checks
    type(varied_document_type), intent(out), target :: varied         !< the model as a function of its parameters
    type(design_space_type), intent(out) :: space                     !< the designs
    type(design_type), intent(out) :: design                          !< placed, with its tangents
    type(open_position_type), intent(out) :: position                 !< room for its positions
    type(document_type) :: document
    type(diagnostics_type) :: diagnostics
    type(model_type) :: model
    type(plan_type) :: plan
    type(state_type) :: start
    type(error_type), allocatable :: err

    call parse_document(source_from_text('test.nml', text), document, diagnostics)
    call read_model(document, kinematics, model, diagnostics)
    call tester%is_true(.not. diagnostics%failed(), 'there is a model')
    call new_varied_document(document, diagnostics%sources, kinematics, varied)
    call assemble_driven(model, plan, start, err)
    if (.not. allocated(err)) call new_design_space(varied, model, plan, space, err)
    call tester%no_error(err, 'there are designs')
    call new_design(space, design)
    call place(tester, space, bar, design)
    call new_open_position(design, position)
  end subroutine prepare

  !> Give a design its lengths.
  subroutine place(tester, space, lengths, design)
    type(tester_type), intent(inout) :: tester            !< counts the checks
    type(design_space_type), intent(inout) :: space       !< the designs
    type(four_bar_type), intent(in) :: lengths            !< of the four-bar
    type(design_type), intent(inout) :: design            !< gets its numbers and their derivatives
    type(error_type), allocatable :: err

    call place_design(space, [lengths%ground, lengths%crank, lengths%coupler, lengths%rocker], design, err)
    if (.not. allocated(err)) call find_tangents(space, design, err)
    call tester%no_error(err, 'there is a design')
  end subroutine place

  !> A four-bar of which one length differs.
  pure function changed(p, by) result(lengths)
    integer, intent(in) :: p      !< number of the length
    real(wp), intent(in) :: by    !< change [m]
    type(four_bar_type) :: lengths

    lengths = bar
    select case (p)
    case (1)
      lengths%ground = bar%ground + by
    case (2)
      lengths%crank = bar%crank + by
    case (3)
      lengths%coupler = bar%coupler + by
    case default
      lengths%rocker = bar%rocker + by
    end select
  end function changed

  !> Derivatives of all angles by the lengths and by time, against differences of the closed form.
  subroutine coordinates(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    real(wp), parameter :: h = 1.0_wp/256.0_wp
    type(varied_document_type), target :: varied
    type(design_space_type), target :: space
    type(design_type) :: design
    type(open_position_type) :: position
    type(closed_changes_type) :: changes
    type(error_type), allocatable :: err
    real(wp) :: q(4, -half_width:half_width), slope, curvature, error, t
    integer :: i, k, p, turn

    call prepare(tester, varied, space, design, position)
    do turn = 0, 5
      t = 0.5_wp*turn
      call place_at(design, t, four_bar_guess(bar, start_angle + omega*t, 1), position, err)
      call tester%no_error(err, 'there is a position')
      call find_derivatives(design, position)
      call find_closed_changes(design, position, changes)
      do p = 0, 4
        do i = -half_width, half_width
          if (p == 0) q(:, i) = four_bar_guess(bar, start_angle + omega*(t + i*h), 1)
          if (p > 0) q(:, i) = four_bar_guess(changed(p, i*h), start_angle + omega*t, 1)
          q(:, i) = modulo(q(:, i) - four_bar_guess(bar, start_angle + omega*t, 1) + pi, 2.0_wp*pi) - pi
        end do
        do k = 1, 4
          call derivatives_from_stencil(q(k, :), h, slope, curvature, error)
          call tester%is_true(error < 1.0e-8_wp, 'differences are exact')
          ! round-off 2/h of angles, and what the stencil says of its truncation
          if (p == 0) call tester%near(changes%by_t(k), slope, 1.0e-11_wp + error, 'rates')
          if (p > 0) call tester%near(changes%by_x(k, p), slope, 1.0e-11_wp + error, 'derivatives by a length')
        end do
      end do
    end do
  end subroutine coordinates

  !> The cosine of the transmission angle, (c^2 + r^2 - d^2)/(2 c r) with d^2 = g^2 + a^2 - 2 g a cos(angle of the crank), its derivatives
  !> by g, a, c and r, and the one by time.
  pure subroutine closed_form(angle, cosine, by_x, by_t)
    real(wp), intent(in) :: angle      !< of the crank [rad]
    real(wp), intent(out) :: cosine    !< the cosine
    real(wp), intent(out) :: by_x(4)   !< its derivatives by the lengths [1/m]
    real(wp), intent(out) :: by_t      !< by time [1/s]

    associate (g => bar%ground, a => bar%crank, c => bar%coupler, r => bar%rocker)
      cosine = (c**2 + r**2 - g**2 - a**2 + 2.0_wp*g*a*cos(angle))/(2.0_wp*c*r)
      by_x = [(a*cos(angle) - g)/(c*r), (g*cos(angle) - a)/(c*r), 1.0_wp/r - cosine/c, 1.0_wp/c - cosine/r]
      by_t = -omega*g*a*sin(angle)/(c*r)
    end associate
  end subroutine closed_form

  !> The transmission angle between coupler and rocker at several positions.
  subroutine transmission_angle(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(varied_document_type), target :: varied
    type(design_space_type), target :: space
    type(design_type) :: design
    type(open_position_type) :: position
    type(transmission_type) :: transmission
    type(course_place_type) :: course
    real(wp) :: cosine, by_x(4), by_t
    integer :: i
    logical :: found

    call prepare(tester, varied, space, design, position)
    call find_transmission(design%plan, 3, transmission, found)
    call tester%is_true(found, 'the angle is between coupler and rocker')
    do i = 0, 10
      course%t = 0.3_wp*i
      course%q = four_bar_guess(bar, start_angle + omega*course%t, 1)
      call transmission%find(design, position, course, found)
      call tester%is_true(found, 'it exists')
      call closed_form(start_angle + omega*course%t, cosine, by_x, by_t)
      ! some operations on numbers of order one, over a conditioning of some tenths
      call tester%near(course%value, cosine, 1.0e-14_wp, 'its cosine')
      call tester%near(course%by_t, by_t, 1.0e-13_wp, 'its derivative by time')
      call tester%near(maxval(abs(course%by_x - by_x)), 0.0_wp, 1.0e-13_wp, 'its derivatives by the lengths')
    end do
  end subroutine transmission_angle

  !> Over a turn the cosine is largest where the crank points along the ground, and least where it points away; derivatives of extreme
  !> values are those at their places.
  subroutine extremes(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(varied_document_type), target :: varied
    type(design_space_type), target :: space
    type(design_type) :: design
    type(open_position_type) :: position
    type(transmission_type) :: transmission
    type(course_place_type) :: places(0:24), least
    real(wp) :: cosine, by_x(4), by_t
    integer :: side
    logical :: found

    call prepare(tester, varied, space, design, position)
    call find_transmission(design%plan, 3, transmission, found)
    call sample_course(transmission, design, position, four_bar_guess(bar, start_angle, 1), [0.0_wp, 2.0_wp*pi/omega], places, &
                       found)
    call tester%is_true(found, 'the crank turns fully')
    do side = -1, 1, 2
      call find_least(transmission, real(side, wp), design, position, places, least)
      call closed_form(merge(pi, 0.0_wp, side > 0), cosine, by_x, by_t)
      ! the place is found to 1e-10 of the slopes beside it; the value is flat there, and derivatives change by as much
      call tester%near(least%value, cosine, 1.0e-14_wp, 'an extreme cosine')
      call tester%near(least%t, modulo(merge(pi, 0.0_wp, side > 0) - start_angle, 2.0_wp*pi)/omega, 1.0e-9_wp, 'its time')
      call tester%near(maxval(abs(least%by_x - by_x)), 0.0_wp, 1.0e-9_wp, 'its derivatives by the lengths')
    end do
    ! over a part without an extreme, the ends are extreme
    call sample_course(transmission, design, position, four_bar_guess(bar, start_angle, 1), [0.0_wp, 1.0_wp/omega], places, found)
    do side = -1, 1, 2
      call find_least(transmission, real(side, wp), design, position, places, least)
      call closed_form(start_angle + merge(1.0_wp, 0.0_wp, side > 0), cosine, by_x, by_t)
      call tester%near(least%value, cosine, 1.0e-14_wp, 'the cosine at an end')
      call tester%near(least%by_t, by_t, 1.0e-13_wp, 'it is not stationary')
    end do
  end subroutine extremes

  !> There is an angle at the three pairs that the chain determines, and none at the crank.
  subroutine no_angle(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(varied_document_type), target :: varied
    type(design_space_type), target :: space
    type(design_type) :: design
    type(open_position_type) :: position
    integer :: k

    call prepare(tester, varied, space, design, position)
    do k = 1, 4
      call tester%is_true(has_transmission_angle(space, four_bar_guess(bar, start_angle, 1), k) .eqv. k > 1, &
                          'an angle needs a coordinate that the chain determines')
    end do
  end subroutine no_angle

  !> The derivatives of the regularity by lengths and time against differences of its values at closed positions.
  subroutine regular_chain(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    real(wp), parameter :: h = 1.0_wp/256.0_wp
    type(varied_document_type), target :: varied
    type(design_space_type), target :: space
    type(design_type) :: design, other
    type(open_position_type) :: position
    type(regularity_type) :: regularity
    type(course_place_type) :: course, beside
    real(wp) :: values(-half_width:half_width), slope, curvature, error
    integer :: i, p, b
    logical :: found

    call prepare(tester, varied, space, design, position)
    regularity%block = findloc([(size(design%plan%blocks(b)%unknowns), b=1, size(design%plan%blocks))], 3, dim=1)
    course%t = 0.7_wp
    course%q = four_bar_guess(bar, start_angle + omega*course%t, 1)
    call regularity%find(design, position, course, found)
    call tester%is_true(found .and. course%value > 0.0_wp, 'the chain is regular')
    other = design
    do p = 0, 4
      do i = -half_width, half_width
        beside%t = course%t
        if (p == 0) beside%t = course%t + i*h
        if (p > 0) call place(tester, space, changed(p, i*h), other)
        beside%q = four_bar_guess(changed(p, merge(i*h, 0.0_wp, p > 0)), start_angle + omega*beside%t, 1)
        call regularity%find(other, position, beside, found)
        values(i) = beside%value
      end do
      call derivatives_from_stencil(values, h, slope, curvature, error)
      call tester%is_true(error < 1.0e-8_wp, 'differences are exact')
      ! round-off 2/h of a number of order one, and what the stencil says of its truncation
      if (p == 0) call tester%near(course%by_t, slope, 1.0e-11_wp + error, 'the derivative by time')
      if (p > 0) call tester%near(course%by_x(p), slope, 1.0e-11_wp + error, 'the derivative by a length')
    end do
  end subroutine regular_chain
end module test_courses
