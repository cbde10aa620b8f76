!> Derivatives of driven motions by parameters: a slider-crank in closed form, and planar, spatial and coupled mechanisms against
!> differences of motions that start anew with other parameters.
module test_sensitivity
  use mech9_program_kind, only: kinematics
  use mech9_kinds, only: wp
  use mech9_error, only: error_type
  use mech9_differentiation, only: half_width, derivatives_from_stencil
  use mech9_varied_document, only: varied_document_type
  use mech9_model, only: model_type
  use mech9_plan, only: plan_type
  use mech9_state, only: state_type
  use mech9_frame_motion, only: point_motion
  use mech9_driven_motion, only: driven_motion_type, start_driven_motion, advance
  use mech9_driven_simulation, only: assemble_driven
  use mech9_motion_changes, only: place_of_coordinate, place_of_point
  use mech9_sensitivity, only: sensitivity_type, new_sensitivity, take_position, find_waiting
  use mech9_text_models, only: varied_from_text
  use mech9_testing, only: tester_type
  implicit none
  private
  public :: run

  !> Times of the positions whose derivatives are found together [s].
  real(wp), parameter :: times(3) = [0.0_wp, 0.3_wp, 0.8_wp]
  character(len=*), parameter :: harmonic = &
    '&drive coordinate=1, kind=''harmonic'', mean=0.7, amplitude=0.4, angular_frequency=2.5, phase=0.3 / &time end=1 / '
  character(len=*), parameter :: slider_crank = '&structure cq=1 / '// &
    '&pair coordinate=1, links=1,2, kind=''revolute'', axis=0,0,1 / '// &
    '&pair coordinate=2, links=2,3, kind=''revolute'', axis=0,0,1, point=0.3,0,0, moving_point=0,0,0 / '// &
    '&pair coordinate=3, links=3,4, kind=''revolute'', axis=0,0,1, point=1.1,0,0, moving_point=0,0,0 / '// &
    '&pair coordinate=4, links=1,4, kind=''prismatic'', axis=1,0,0, zero=0,1,0, moving_point=0,0,0 / '// &
    '&initial coordinate=4, position=1.2 / &point name=''B'', link=4 / '// &
    '&parameter name=''crank'', sets=''pair(2).point(1)'' / &parameter name=''rod'', sets=''pair(3).point(1)'' / '
  character(len=*), parameter :: four_bar = '&structure cq=1 / '// &
    '&pair coordinate=1, links=1,2, kind=''revolute'', axis=0,0,1 / '// &
    '&pair coordinate=2, links=2,3, kind=''revolute'', axis=0,0,1, point=0.4,0,0, moving_point=0,0,0 / '// &
    '&pair coordinate=3, links=3,4, kind=''revolute'', axis=0,0,1, point=1.9,0,0, moving_point=1.6,0,0 / '// &
    '&pair coordinate=4, links=1,4, kind=''revolute'', axis=0,0,1, point=2,0.1,0, moving_point=0,0,0 / '// &
    '&initial coordinate=2, position=0.9 / &initial coordinate=3, position=1 / &initial coordinate=4, position=1.7 / '// &
    '&point name=''P'', link=3, position=0.5,0.3,0 / '// &
    '&parameter name=''crank'', sets=''pair(2).point(1)'' / &parameter name=''height'', sets=''pair(4).point(2)'' / '// &
    '&parameter name=''place'', sets=''point(1).position(2)'' / '
  character(len=*), parameter :: screw = '&structure cq=1 / '// &
    '&pair coordinate=1, links=1,2, kind=''revolute'', axis=0,0,1, moving_point=0,0,0 / '// &
    '&pair coordinates=2,3,4, links=2,3, kind=''spherical'', point=0.2,0.15,0, moving_point=0,0,0 / '// &
    '&pair coordinates=5,6,7, links=3,4, kind=''spherical'', point=1.1,0,0, moving_point=0,0,0.6 / '// &
    '&pair coordinate=8, links=1,4, kind=''helical'', axis=0.1,1,0, point=1,0,0, moving_point=0,0,0, pitch=0.3 / '// &
    '&point name=''P'', link=4, position=0.5,0.3,0.1 / '// &
    '&parameter name=''rod'', sets=''pair(3).point(1)'' / &parameter name=''tilt'', sets=''pair(4).axis(1)'' / '// &
    '&parameter name=''pitch'', sets=''pair(4).pitch'' / '
  character(len=*), parameter :: geared = '&structure cq=1 / '// &
    '&pair coordinate=1, links=1,2, kind=''revolute'', axis=0,0,1 / '// &
    '&pair coordinate=2, links=2,3, kind=''revolute'', axis=0,0,1, point=0.5,0,0, moving_point=0,0,0 / '// &
    '&pair coordinate=3, links=3,4, kind=''revolute'', axis=0,0,1, point=2,0,0, moving_point=2,0,0 / '// &
    '&pair coordinate=4, links=5,4, kind=''revolute'', axis=0,0,1, point=0.6,0,0, moving_point=0,0,0 / '// &
    '&pair coordinate=5, links=1,5, kind=''revolute'', axis=0,0,1, point=1.5,0,0, moving_point=0,0,0 / '// &
    '&coupling kind=''gear'', coordinates=1,5, ratio=-1.8 / '// &
    '&initial coordinate=2, position=0.9 / &initial coordinate=3, position=1 / &initial coordinate=4, position=1.7 / '// &
    '&point name=''P'', link=3, position=0.5,0.3,0 / '// &
    '&parameter name=''ratio'', sets=''coupling(1).ratio'' / &parameter name=''rod'', sets=''pair(3).point(1)'' / '
  character(len=*), parameter :: law = '&parameter name=''swing'', sets=''drive(1).amplitude'' / '// &
    '&parameter name=''speed'', sets=''drive(1).angular_frequency'' / '

contains

  !> Run the cases of this suite.
  subroutine run(tester)
    type(tester_type), intent(inout) :: tester   !< selects cases and counts their checks

    if (tester%runs('closed_form')) call closed_form(tester)
    if (tester%runs('slider_crank')) call compare(tester, slider_crank//law//harmonic, 'slider-crank')
    if (tester%runs('four_bar')) call compare(tester, four_bar//harmonic, 'four-bar')
    if (tester%runs('screw')) call compare(tester, screw//harmonic, 'crank, rod and screw')
    if (tester%runs('geared')) call compare(tester, geared//law//harmonic, 'geared five-bar')
  end subroutine run

  !> All numbers of a motion at the times: coordinates and points, with two derivatives.
  subroutine follow(tester, model, numbers)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(model_type), intent(inout) :: model     !< the model
    real(wp), intent(out) :: numbers(:, :)       !< (numbers,times) in the order of their derivatives
    type(plan_type) :: plan
    type(state_type) :: start
    type(driven_motion_type) :: driven
    type(error_type), allocatable :: err
    integer :: i

    call assemble_driven(model, plan, start, err)
    if (.not. allocated(err)) call start_driven_motion(model%problem%drives, plan, start, 0.0_wp, driven, err)
    do i = 1, size(times)
      if (.not. allocated(err) .and. i > 1) call advance(model%problem%drives, plan, driven, times(i), err)
      if (allocated(err)) exit
      call gather(model, plan, driven%state, numbers(:, i))
    end do
    call tester%no_error(err, 'there is a motion')
  end subroutine follow

  !> The numbers of one position.
  subroutine gather(model, plan, state, numbers)
    type(model_type), intent(in) :: model        !< the model
    type(plan_type), intent(in) :: plan          !< its plan
    type(state_type), intent(in) :: state        !< its motion
    real(wp), intent(out) :: numbers(:)          !< coordinates and points with two derivatives
    real(wp) :: motion(3, 0:2)
    integer :: k, order, axis

    do k = 1, size(state%q)
      numbers([(place_of_coordinate(k, order), order=0, 2)]) = [state%q(k), state%dq(k), state%ddq(k)]
    end do
    do k = 1, size(model%mechanism%points)
      associate (point => model%mechanism%points(k))
        call point_motion(plan, state, point%link, point%position, motion(:, 0), motion(:, 1), motion(:, 2))
      end associate
      do order = 0, 2
        do axis = 1, 3
          numbers(place_of_point(size(state%q), k, order, axis)) = motion(axis, order)
        end do
      end do
    end do
  end subroutine gather

  !> The derivatives of all numbers at the times.
  subroutine find_changes(tester, varied, model, changes)
    type(tester_type), intent(inout) :: tester               !< counts the checks
    type(varied_document_type), intent(inout) :: varied      !< the model as a function of its parameters
    type(model_type), intent(inout) :: model                 !< the present model
    real(wp), allocatable, intent(out) :: changes(:, :, :)   !< (times,numbers,P)
    type(plan_type) :: plan
    type(state_type) :: start
    type(driven_motion_type) :: driven
    type(sensitivity_type) :: sensitivity
    type(error_type), allocatable :: err
    integer :: i, good

    call assemble_driven(model, plan, start, err)
    if (.not. allocated(err)) call start_driven_motion(model%problem%drives, plan, start, 0.0_wp, driven, err)
    if (.not. allocated(err)) call new_sensitivity(varied, model, plan, 2, sensitivity, err)
    do i = 1, size(times)
      if (.not. allocated(err) .and. i > 1) call advance(model%problem%drives, plan, driven, times(i), err)
      if (.not. allocated(err)) call take_position(model, driven%state, sensitivity, err)
    end do
    if (.not. allocated(err)) call find_waiting(model, sensitivity, good, err)
    call tester%no_error(err, 'there are derivatives')
    call tester%is_true(good == size(times) .and. sensitivity%waiting == 0, 'all positions have theirs')
    changes = sensitivity%changes%values(:size(times), :, :)
  end subroutine find_changes

  !> Compare all derivatives with differences of motions.
  subroutine compare(tester, text, name)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    character(len=*), intent(in) :: text         !< of a data file
    character(len=*), intent(in) :: name         !< of the mechanism, for the report of a failure
    real(wp), parameter :: h = 1.0_wp/1024.0_wp
    type(varied_document_type), target :: varied
    type(model_type) :: model, other
    type(error_type), allocatable :: err
    real(wp), allocatable :: changes(:, :, :), numbers(:, :, :), x(:)
    real(wp) :: slope, curvature, error
    integer :: p, k, i, number

    call varied_from_text(tester, text, kinematics, varied, model)
    call find_changes(tester, varied, model, changes)
    allocate (numbers(size(changes, 2), size(times), -half_width:half_width))
    do p = 1, size(model%parameters)
      do k = -half_width, half_width
        x = model%parameters%value
        x(p) = x(p) + k*h
        call varied%at(x, other, err)
        call tester%no_error(err, name//': there is a model nearby')
        if (allocated(err)) return
        call follow(tester, other, numbers(:, :, k))
      end do
      do i = 1, size(times)
        do number = 1, size(numbers, 1)
          call derivatives_from_stencil(numbers(number, i, :), h, slope, curvature, error)
          ! round-off of positions and accelerations, some 1e-14 over a conditioning of a tenth, times 2/h
          call tester%near(changes(i, number, p), slope, 1.0e-9_wp, name//': derivatives by '//trim(model%parameters(p)%name))
        end do
      end do
    end do
  end subroutine compare

  !> The slide is at x = r cos a + w with w = sqrt(l^2 - r^2 sin^2 a): dx/dr = cos a - r sin^2 a/w, dx/dl = l/w.
  subroutine closed_form(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    real(wp), parameter :: r = 0.3_wp, l = 1.1_wp
    type(varied_document_type), target :: varied
    type(model_type) :: model
    real(wp), allocatable :: changes(:, :, :)
    real(wp) :: a, w
    integer :: i

    call varied_from_text(tester, slider_crank//'&drive coordinate=1, kind=''polynomial'', coefficients=0.4,3 / &time end=1 /', &
                          kinematics, varied, model)
    call find_changes(tester, varied, model, changes)
    do i = 1, size(times)
      a = 0.4_wp + 3.0_wp*times(i)
      w = sqrt(l**2 - r**2*sin(a)**2)
      ! some operations on numbers of order one, over a conditioning of a tenth
      call tester%near(changes(i, place_of_coordinate(4, 0), 1), cos(a) - r*sin(a)**2/w, 1.0e-13_wp, 'the slide by the crank')
      call tester%near(changes(i, place_of_coordinate(4, 0), 2), l/w, 1.0e-13_wp, 'the slide by the rod')
      call tester%near(changes(i, place_of_coordinate(4, 1), 2), 3.0_wp*l*r**2*sin(a)*cos(a)/w**3, 1.0e-12_wp, &
                       'the velocity of the slide by the rod')
      call tester%near(changes(i, place_of_point(4, 1, 0, 1), 2), l/w, 1.0e-13_wp, 'the point on the slide by the rod')
      call tester%near(changes(i, place_of_coordinate(1, 0), 1), 0.0_wp, 0.0_wp, 'the driven angle does not change')
    end do
  end subroutine closed_form
end module test_sensitivity
