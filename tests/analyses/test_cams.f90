!> Profiles of cams that are circles: the crank of a slider-crank as the cam of its slide, and an eccentric circle under a flat face.
module test_cams
  use mech9_program_kind, only: kinematics
  use mech9_kinds, only: wp, pi
  use mech9_error, only: error_type
  use mech9_model, only: model_type
  use mech9_request, only: cam_request_type
  use mech9_plan, only: plan_type
  use mech9_state, only: state_type
  use mech9_planning, only: make_plan
  use mech9_driven_motion, only: driven_motion_type, start_driven_motion
  use mech9_driven_simulation, only: assemble_driven
  use mech9_pair_axes, only: pair_axes_type, pair_axes
  use mech9_cam_contact, only: cam_contact_type, find_contact
  use mech9_cam_profile, only: cam_profile_type, find_profile
  use mech9_planar_mechanisms, only: slider_crank
  use mech9_sample_mechanisms, only: drive
  use mech9_text_models, only: model_from_text
  use mech9_testing, only: tester_type
  implicit none
  private
  public :: run

  !> Eccentricity of the circle, its radius, and that of the roller [m].
  real(wp), parameter :: e = 0.3_wp, radius = 0.8_wp, roller = 0.25_wp
  !> Some operations on numbers of order one, over a conditioning of a tenth.
  real(wp), parameter :: round_off = 1.0e-13_wp

contains

  !> Run the cases of this suite.
  subroutine run(tester)
    type(tester_type), intent(inout) :: tester   !< selects cases and counts their checks

    if (tester%runs('roller')) call check_roller(tester)
    if (tester%runs('too_large_roller')) call too_large_roller(tester)
    if (tester%runs('flat_face')) call flat_face(tester)
    if (tester%runs('flat_face_undercut')) call flat_face_undercut(tester)
    if (tester%runs('whole_profile')) call whole_profile(tester)
  end subroutine run

  !> The contact of the slide of a slider-crank, as a roller, with the crank as its cam. The pitch curve is a circle about the crank's
  !> pin with the length of the rod.
  subroutine find_roller_contact(tester, angle, rod, r, outer, contact)
    type(tester_type), intent(inout) :: tester          !< counts the checks
    real(wp), intent(in) :: angle                       !< of the crank [rad]
    real(wp), intent(in) :: rod                         !< its length [m]
    real(wp), intent(in) :: r                           !< radius of the roller [m]
    logical, intent(in) :: outer                        !< the cam surrounds the path of the roller
    type(cam_contact_type), intent(out) :: contact      !< the contact
    type(model_type) :: model
    type(plan_type) :: plan
    type(state_type) :: state
    type(driven_motion_type) :: driven
    type(pair_axes_type), allocatable :: axes(:)
    type(cam_request_type) :: cam
    type(error_type), allocatable :: err

    call slider_crank(e, rod, 0.0_wp, angle, 1, model)
    call drive(model, 1, [angle, 2.0_wp])
    call make_plan(model%mechanism, model%problem%partition, model%problem%initial%position, plan, state, err)
    if (.not. allocated(err)) call start_driven_motion(model%problem%drives, plan, state, 0.0_wp, driven, err)
    call tester%no_error(err, 'the motion starts')
    cam = cam_request_type(link=2, follower=4, roller=r, outer=outer, axis=[0.0_wp, 0.0_wp, 1.0_wp], guide=4, coordinate=1)
    axes = pair_axes(model%mechanism%pairs)
    call find_contact(cam, axes(4:4), plan, driven%state, contact)
  end subroutine find_roller_contact

  !> The profile is a circle about the pin whose radius is the rod less the roller; the pressure angle is that of the rod.
  subroutine check_roller(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(cam_contact_type) :: contact
    real(wp), parameter :: pin(3) = [e, 0.0_wp, 0.0_wp]
    real(wp) :: angle
    integer :: i

    do i = 0, 11
      angle = 0.2_wp + i*pi/6.0_wp
      call find_roller_contact(tester, angle, radius + roller, roller, .false., contact)
      call tester%is_true(contact%known .and. .not. contact%undercut, 'the roller touches')
      call tester%near(norm2(contact%pitch - pin), radius + roller, round_off, 'the pitch curve')
      call tester%near(norm2(contact%profile - pin), radius, round_off, 'the profile')
      call tester%near(maxval(abs(contact%normal + (contact%profile - pin)/radius)), 0.0_wp, round_off, 'its normal points inwards')
      ! accelerations over squared speeds: two more divisions by numbers down to some tenths
      call tester%near(contact%radius, radius, 1.0e-11_wp, 'its radius of curvature')
      call tester%near(sin(contact%pressure), abs(e*sin(angle))/(radius + roller), round_off, 'the pressure angle')
      call find_roller_contact(tester, angle, radius - roller, roller, .true., contact)
      call tester%near(norm2(contact%profile - pin), radius, round_off, 'a cam that surrounds the roller')
      call tester%near(contact%radius, -radius, 1.0e-11_wp, 'it is concave')
    end do
  end subroutine check_roller

  !> A roller around the inner side of a smaller circle turns the profile back.
  subroutine too_large_roller(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(cam_contact_type) :: contact

    call find_roller_contact(tester, 0.7_wp, radius, 0.99_wp*radius, .false., contact)
    call tester%is_true(.not. contact%undercut, 'a roller smaller than its circle touches')
    call find_roller_contact(tester, 0.7_wp, radius, 1.01_wp*radius, .false., contact)
    call tester%is_true(contact%undercut, 'one that is larger undercuts the cam')
  end subroutine too_large_roller

  !> A face that rises by R + e sin a over a cam that turns by a: the profile is a circle of radius R whose centre is e away.
  subroutine face_contact(tester, angle, contact)
    type(tester_type), intent(inout) :: tester          !< counts the checks
    character(len=*), intent(in) :: angle               !< of the cam at time zero [rad]
    type(cam_contact_type), intent(out) :: contact      !< the contact
    type(model_type) :: model
    type(plan_type) :: plan
    type(state_type) :: start
    type(driven_motion_type) :: driven
    type(pair_axes_type), allocatable :: axes(:)
    type(cam_request_type) :: cam
    type(error_type), allocatable :: err

    call model_from_text(tester, '&structure cq=1,2 / &pair coordinate=1, links=1,2, kind=''revolute'', axis=0,0,1 / '// &
                         '&pair coordinate=2, links=1,3, kind=''prismatic'', axis=0,1,0, zero=1,0,0 / '// &
                         '&drive coordinate=1, kind=''polynomial'', coefficients='//angle//',2 / &drive coordinate=2, '// &
                         'kind=''harmonic'', mean=0.8, amplitude=0.3, angular_frequency=2, phase='//angle//' / &time end=1 /', &
                         kinematics, model)
    call assemble_driven(model, plan, start, err)
    if (.not. allocated(err)) call start_driven_motion(model%problem%drives, plan, start, 0.0_wp, driven, err)
    call tester%no_error(err, 'the motion starts')
    cam = cam_request_type(link=2, follower=3, flat=.true., face=[0.0_wp, -1.0_wp, 0.0_wp], axis=[0.0_wp, 0.0_wp, 1.0_wp], &
                           guide=2, coordinate=1)
    axes = pair_axes(model%mechanism%pairs)
    axes = axes(2:2)
    ! the face is that of the slide in link 3, which lies in its origin
    call find_contact(cam, axes, plan, driven%state, contact)
  end subroutine face_contact

  !> Points of the eccentric circle.
  subroutine flat_face(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(cam_contact_type) :: contact
    character(len=4) :: angle
    real(wp) :: a
    integer :: i

    do i = 0, 12
      a = 0.25_wp + 0.5_wp*i
      write (angle, '(f4.2)') a
      call face_contact(tester, angle, contact)
      call tester%is_true(contact%known .and. .not. contact%undercut, 'the face touches')
      call tester%near(norm2(contact%profile - [e, 0.0_wp, 0.0_wp]), radius, round_off, 'the profile is a circle')
      call tester%near(contact%radius, radius, 1.0e-12_wp, 'its radius of curvature')
      call tester%near(abs(contact%offset), abs(e*cos(a)), round_off, 'the place of the contact on the face')
      call tester%near(contact%pressure, 0.0_wp, round_off, 'the face has no pressure angle')
      call tester%near(contact%tilt, 0.0_wp, round_off, 'it does not tilt')
    end do
  end subroutine flat_face

  !> The curvature of the profile is the rise and its second derivative by the angle: R + e sin a - e sin a. A larger second derivative
  !> undercuts.
  subroutine flat_face_undercut(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(model_type) :: model
    type(plan_type) :: plan
    type(state_type) :: start
    type(driven_motion_type) :: driven
    type(pair_axes_type) :: no_axes(0)
    type(cam_request_type) :: cam
    type(cam_contact_type) :: contact
    type(error_type), allocatable :: err
    real(wp) :: rise, second
    integer :: i

    ! the rise 0.8 + 0.3 sin(2 a) has the radius 0.8 + 0.3 sin(2 a) - 1.2 sin(2 a)
    call model_from_text(tester, '&structure cq=1,2 / &pair coordinate=1, links=1,2, kind=''revolute'', axis=0,0,1 / '// &
                         '&pair coordinate=2, links=1,3, kind=''prismatic'', axis=0,1,0, zero=1,0,0 / '// &
                         '&drive coordinate=1, kind=''polynomial'', coefficients=0,1 / &drive coordinate=2, '// &
                         'kind=''harmonic'', mean=0.8, amplitude=0.3, angular_frequency=2 / &time end=4 /', kinematics, model)
    cam = cam_request_type(link=2, follower=3, flat=.true., face=[0.0_wp, -1.0_wp, 0.0_wp], axis=[0.0_wp, 0.0_wp, 1.0_wp], &
                           coordinate=1)
    do i = 0, 7
      model%request%time%start = 0.1_wp + 0.5_wp*i
      call assemble_driven(model, plan, start, err)
      if (.not. allocated(err)) call start_driven_motion(model%problem%drives, plan, start, model%request%time%start, driven, err)
      call tester%no_error(err, 'the motion starts')
      call find_contact(cam, no_axes, plan, driven%state, contact)
      rise = 0.3_wp*sin(2.0_wp*model%request%time%start)
      second = -4.0_wp*rise
      call tester%near(contact%radius, 0.8_wp + rise + second, 1.0e-12_wp, 'its radius of curvature')
      call tester%is_true(contact%undercut .eqv. 0.8_wp + rise + second <= 0.0_wp, 'it is undercut where this is negative')
    end do
  end subroutine flat_face_undercut

  !> A whole turn of the crank: a closed circle, whose greatest pressure angle lies between the outputs.
  subroutine whole_profile(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(model_type) :: model
    type(plan_type) :: plan
    type(state_type) :: start
    type(cam_request_type) :: cam
    type(cam_profile_type) :: profile
    type(error_type), allocatable :: err

    call slider_crank(e, radius + roller, 0.0_wp, 0.0_wp, 1, model)
    call drive(model, 1, [0.0_wp, 2.0_wp*pi])
    model%request%time%start = 0.0_wp
    model%request%time%end = 1.0_wp
    model%request%time%intervals = 30
    call assemble_driven(model, plan, start, err)
    call tester%no_error(err, 'the slider-crank is assembled')
    cam = cam_request_type(link=2, follower=4, roller=roller, axis=[0.0_wp, 0.0_wp, 1.0_wp], guide=4, coordinate=1)
    call find_profile(model, plan, start, cam, profile, err)
    call tester%no_error(err, 'there is a profile')
    if (allocated(err)) return
    call tester%is_true(count(profile%at_output) == 31, 'the outputs are kept')
    call tester%is_true(profile%closed .and. profile%has_pressure, 'it is closed')
    call tester%is_true(profile%resting == 0 .and. size(profile%undercut, 2) == 0 .and. profile%off_plane == 0, 'it is sound')
    ! places of extremes are refined until the value, flat there, is known to round-off of its square root
    call tester%near(sin(profile%contacts(profile%pressure)%pressure), e/(radius + roller), 1.0e-9_wp, &
                     'the greatest pressure angle')
    call tester%near(profile%contacts(profile%convex)%radius, radius, 1.0e-11_wp, 'the least radius')
    call tester%is_true(profile%concave == 0, 'it is convex throughout')
  end subroutine whole_profile
end module test_cams
