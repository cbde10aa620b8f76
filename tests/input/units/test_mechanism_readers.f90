!> Readers of pairs, drives, couplings, loads, motors, joints, limits, objectives and cams: what they make of the numbers is held
!> against the formulas of the data file's description, with angles in degrees.
module test_mechanism_readers
  use mech9_program_kind, only: kinematics, dynamics
  use mech9_kinds, only: wp
  use mech9_cam_reader, only: read_cams
  use mech9_checker, only: check_document
  use mech9_compound_joint, only: compound_joint_type
  use mech9_coordinate_load, only: coordinate_load_type
  use mech9_coupling_reader, only: read_couplings
  use mech9_dc_motor, only: dc_motor_type
  use mech9_diagnostics, only: diagnostics_type
  use mech9_document, only: document_type
  use mech9_drive_check, only: check_drives
  use mech9_drive_reader, only: read_drives, files_of_groups, units_of_coordinate
  use mech9_error, only: error_type
  use mech9_joint_reader, only: read_joints
  use mech9_law, only: drive_slot_type
  use mech9_limit_reader, only: read_limits
  use mech9_motor, only: motor_slot_type
  use mech9_load_reader, only: read_loads
  use mech9_model, only: model_type
  use mech9_motor_reader, only: read_motors
  use mech9_objective_reader, only: read_objectives
  use mech9_pair, only: pair_motion_type
  use mech9_units, only: units_type, coordinate_units_type
  use mech9_mechanism, only: mechanism_type
  use mech9_pair_reader, only: read_pairs
  use mech9_parser, only: parse_document
  use mech9_partition, only: partition_type
  use mech9_pid_motor, only: pid_motor_type
  use mech9_request, only: cam_request_type
  use mech9_source, only: source_from_text
  use mech9_spring_load, only: spring_load_type
  use mech9_structure, only: structure_type
  use mech9_structure_reader, only: read_structure
  use mech9_text, only: string_type
  use mech9_checks, only: near_vector
  use mech9_small_models, only: slider_crank, eol
  use mech9_text_models, only: model_from_text, checked_from_text
  use mech9_test_files, only: save_lines, remove_file
  use mech9_testing, only: tester_type
  implicit none
  private
  public :: run

  real(wp), parameter :: pi = acos(-1.0_wp), degree = pi/180.0_wp
  type(units_type), parameter :: degrees = units_type(angle=degree, rate=degree, angle_name='deg', rate_name='deg/s')
  real(wp), parameter :: tol = 1.0e-14_wp   ! a few roundings of numbers of order one
  character(len=*), parameter :: path = 'test_mechanism_readers.dat'

contains

  !> Run the cases of this suite.
  subroutine run(tester)
    type(tester_type), intent(inout) :: tester   !< selects cases and counts their checks

    if (tester%runs('pairs')) call pairs(tester)
    if (tester%runs('structures')) call structures(tester)
    if (tester%runs('drives')) call drives(tester)
    if (tester%runs('checked_drives')) call checked_drives(tester)
    if (tester%runs('couplings')) call couplings(tester)
    if (tester%runs('loads')) call loads(tester)
    if (tester%runs('motors')) call motors(tester)
    if (tester%runs('limits')) call limits(tester)
    if (tester%runs('objectives')) call objectives(tester)
    if (tester%runs('cams')) call cams(tester)
  end subroutine run

  !> The checked groups of a slider-crank and others, and its model.
  subroutine checked(tester, groups, document, model, diagnostics, begin)
    type(tester_type), intent(inout) :: tester            !< counts the checks
    character(len=*), intent(in) :: groups                !< behind those of the slider-crank
    type(document_type), intent(out) :: document          !< all groups
    type(model_type), intent(out) :: model                !< the slider-crank
    type(diagnostics_type), intent(out) :: diagnostics    !< gets the errors
    character(len=*), intent(in), optional :: begin       !< of the text, with other units; absent: '&mechanism '

    call model_from_text(tester, slider_crank, dynamics, model)
    if (present(begin)) then
      call checked_from_text(tester, begin//slider_crank(len('&mechanism '):)//groups, document, diagnostics)
    else
      call checked_from_text(tester, slider_crank//groups, document, diagnostics)
    end if
  end subroutine checked

  !> A screw advances by its pitch in a turn; a slide moves along its axis; points and axes are those of the reference link.
  subroutine pairs(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(document_type) :: document
    type(diagnostics_type) :: diagnostics
    type(mechanism_type) :: mechanism
    type(partition_type) :: partition
    type(pair_motion_type) :: motion
    type(error_type), allocatable :: err
    logical :: known

    call parse_document(source_from_text('a.nml', '&mechanism links=4, coordinates=3 /'//eol//'&structure cq=1,2,3 /'//eol// &
      "&pair coordinate=1, links=1,2, kind='helical', axis=0,0,1, pitch=0.01 /"//eol// &
      "&pair coordinate=2, links=2,3, kind='prismatic', axis=0,3,4 /"//eol// &
      "&pair coordinate=3, links=3,4, kind='revolute', axis=0,0,1, point=1,0,0, moving_point=0,2,0 /"//eol), document, diagnostics)
    call check_document(document, diagnostics)
    call read_structure(document, mechanism%structure, partition, known, diagnostics)
    mechanism%units = degrees
    mechanism%parameters = [real(wp) ::]
    call read_pairs(document, mechanism, diagnostics)
    call tester%is_true(.not. diagnostics%failed() .and. known .and. size(mechanism%pairs) == 3, 'three pairs')
    if (size(mechanism%pairs) /= 3 .or. diagnostics%failed()) return
    call mechanism%pairs(1)%pair%evaluate(pi/2.0_wp, motion, err)
    call near_vector(tester, [motion%pose%p, motion%pose%r(:, 1)], [0.0_wp, 0.0_wp, 0.0025_wp, 0.0_wp, 1.0_wp, 0.0_wp], tol, &
                     'a quarter turn of the screw')
    call mechanism%pairs(2)%pair%evaluate(2.0_wp, motion, err)
    call near_vector(tester, motion%pose%p, [0.0_wp, 1.2_wp, 1.6_wp], tol, 'a slide')
    call mechanism%pairs(3)%pair%evaluate(pi, motion, err)
    call near_vector(tester, motion%pose%p, [1.0_wp, 2.0_wp, 0.0_wp], tol, 'half a turn about a point of both links')
    associate (list => mechanism%pairs)
      call tester%is_true(list(1)%pair%angular .and. .not. list(2)%pair%angular .and. all([list(3)%pair%reference, &
                          list(3)%pair%moving] == [3, 4]), 'angles, lengths and links')
    end associate
  end subroutine pairs

  !> Links of joints get numbers above those of the user.
  subroutine structures(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(document_type) :: document
    type(diagnostics_type) :: diagnostics
    type(compound_joint_type), allocatable :: joints(:)
    type(structure_type) :: structure
    type(partition_type) :: partition
    logical :: known

    call parse_document(source_from_text('a.nml', '&mechanism links=3, coordinates=4 /'//eol//'&structure cq=1,2,3,4 /'//eol// &
      "&pair coordinate=4, links=1,2, kind='revolute', axis=0,0,1 /"//eol//"&pair coordinates=3,1,2, links=2,3, "// &
      "kind='spherical' /"//eol), document, diagnostics)
    call check_document(document, diagnostics)
    call read_joints(document, joints)
    call tester%is_true(size(joints) == 1, 'a joint with several freedoms')
    if (size(joints) == 1) call tester%is_true(joints(1)%kind == 'spherical' .and. all(joints(1)%coordinates() == [3, 1, 2]) &
                                               .and. all(joints(1)%ends == [2, 3]), 'its coordinates and links')
    call read_structure(document, structure, partition, known, diagnostics)
    call tester%is_true(known .and. structure%n_links == 5 .and. structure%shown_links() == 3, 'two links of its own')
    call tester%is_true(all(structure%links(:, 4) == [1, 2]) .and. structure%links(1, 3) == 2 .and. structure%links(2, 2) == 3, &
                        'the chain of its pairs')
    call tester%is_true(all(partition%independent()), 'all coordinates are independent')
  end subroutine structures

  subroutine drives(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(document_type) :: document
    type(model_type) :: model
    type(diagnostics_type) :: diagnostics
    type(string_type), allocatable :: files(:)
    type(coordinate_units_type) :: unit

    call is_law("kind='polynomial', coefficients=30, 60, 90", 2.0_wp, [30.0_wp + 120.0_wp + 360.0_wp, 60.0_wp + 360.0_wp, 180.0_wp])
    ! mean + amplitude sin(frequency t + phase), the frequency and phase in degrees as well
    call is_law("kind='harmonic', mean=10, amplitude=20, angular_frequency=180, phase=30", 1.0_wp/3.0_wp, &
                [30.0_wp, 0.0_wp, -20.0_wp*pi**2])
    call is_law("kind='segments', times=0, 2, values=0, 90, laws='constant-velocity'", 0.5_wp, [22.5_wp, 45.0_wp, 0.0_wp])
    call save_lines(tester, path, ['0 0', '1 1', '2 2', '3 3'])
    call is_law("kind='table', file='"//path//"'", 1.5_wp, [1.5_wp, 1.0_wp, 0.0_wp])
    call checked(tester, "&drive coordinate=1, kind='table', file='"//path//"' /"//eol, document, model, diagnostics)
    call files_of_groups(document, files)
    call remove_file(path)
    call tester%is_true(size(files) == 1, 'one file is named')
    if (size(files) == 1) call tester%is_true(files(1)%text == path, 'its path')
    unit = units_of_coordinate(document%groups(size(document%groups)), model%mechanism%pairs, degrees)
    call near_vector(tester, [unit%position, unit%rate, unit%force, unit%slope], [degree, degree, 1.0_wp, 1.0_wp], 0.0_wp, &
                     'the units of an angle')
  contains
    !> The numbers of a law of coordinate 1, in degrees.
    subroutine is_law(items, t, expected)
      character(len=*), intent(in) :: items     !< of the drive
      real(wp), intent(in) :: t                 !< time [s]
      real(wp), intent(in) :: expected(3)       !< value and derivatives [deg, deg/s, deg/s^2]
      type(document_type) :: document
      type(model_type) :: model
      type(diagnostics_type) :: diagnostics
      type(drive_slot_type), allocatable :: list(:)
      type(error_type), allocatable :: err
      real(wp) :: found(3)

      call checked(tester, '&drive coordinate=1, '//items//' /'//eol, document, model, diagnostics, &
                   '&mechanism angle_unit=''deg'', ')
      model%mechanism%units = degrees
      call read_drives(document, model%mechanism, 0.0_wp, model%problem%partition, list, diagnostics)
      call tester%is_true(.not. diagnostics%failed() .and. size(list) == 1, 'a drive: '//items)
      if (size(list) /= 1) return
      call list(1)%drive%evaluate(t, found(1), found(2), found(3), err)
      call tester%no_error(err, 'its value')
      ! the harmonic law has a factor of a thousand in its second derivative
      call near_vector(tester, found/degree, expected, 1.0e-12_wp, items)
    end subroutine is_law
  end subroutine drives

  !> A dependent coordinate cannot be driven, and an independent one needs a drive.
  subroutine checked_drives(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks

    call judge("&drive coordinate=1, kind='polynomial', coefficients=1 /"//eol, .true.)
    call judge('', .false.)
  contains
    subroutine judge(groups, right)
      character(len=*), intent(in) :: groups   !< drives
      logical, intent(in) :: right             !< they are as they must be
      type(document_type) :: document
      type(model_type) :: model
      type(diagnostics_type) :: diagnostics
      type(drive_slot_type), allocatable :: list(:)

      call checked(tester, groups, document, model, diagnostics)
      model%mechanism%units = degrees
      call read_drives(document, model%mechanism, 0.0_wp, model%problem%partition, list, diagnostics)
      call move_alloc(list, model%problem%drives)
      model%program = kinematics
      call check_drives(document, model, diagnostics)
      call tester%is_true(diagnostics%failed() .neqv. right, 'drives: '//groups)
    end subroutine judge
  end subroutine checked_drives

  !> Each coupling is fulfilled where its description says so, and not beside.
  subroutine couplings(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks

    call holds("kind='gear', coordinates=1,2, ratio=-2, phase=30", 1, 2, 10.0_wp*degree, 10.0_wp*degree)
    call holds("kind='rack', coordinates=1,4, radius=0.02, phase=0.5", 1, 4, 2.0_wp, 0.54_wp)
    call holds("kind='belt', coordinates=1,2, radii=0.1,0.2, phase=0", 1, 2, 1.0_wp, 0.5_wp)
    call holds("kind='belt', coordinates=1,2, radii=0.1,0.2, phase=0, crossed=.true.", 1, 2, 1.0_wp, -0.5_wp)
    call holds("kind='screw', coordinates=1,4, pitch=0.005, phase=0", 1, 4, 4.0_wp*pi, 0.01_wp)
    call holds("kind='linear', coordinates=1,2, coefficients=2,1, constant=90", 1, 2, 30.0_wp*degree, 30.0_wp*degree)
  contains
    subroutine holds(items, first, second, q1, q2)
      character(len=*), intent(in) :: items   !< of the coupling
      integer, intent(in) :: first            !< number of its first coordinate
      integer, intent(in) :: second           !< number of its second coordinate
      real(wp), intent(in) :: q1              !< value of the first coordinate [rad]
      real(wp), intent(in) :: q2              !< value of the second one that fulfils it [rad, m]
      type(document_type) :: document
      type(model_type) :: model
      type(diagnostics_type) :: diagnostics
      real(wp), parameter :: no_curve(0:2) = 0.0_wp
      real(wp) :: at, beside

      call checked(tester, '&coupling '//items//' /'//eol, document, model, diagnostics)
      model%mechanism%units = degrees
      call read_couplings(document, [0.0_wp, 0.0_wp, 0.0_wp, 1.2_wp], model%mechanism, diagnostics)
      call tester%is_true(.not. diagnostics%failed() .and. size(model%mechanism%couplings) == 1, 'a coupling: '//items)
      if (size(model%mechanism%couplings) /= 1) return
      associate (coupling => model%mechanism%couplings(1)%coupling)
        call tester%is_true(all(coupling%coordinates == [first, second]), 'its coordinates')
        at = coupling%term(1, q1, no_curve, 0) + coupling%term(2, q2, no_curve, 0)
        beside = coupling%term(1, q1, no_curve, 0) + coupling%term(2, q2 + 0.1_wp, no_curve, 0)
      end associate
      ! a sum of degrees is of order one hundred
      call tester%near(at, 0.0_wp, 100.0_wp*tol, 'its equation: '//items)
      call tester%is_true(abs(beside) > 1.0e-3_wp, 'it does not hold beside')
    end subroutine holds
  end subroutine couplings

  !> Stiffness and damping count per radian, also where angles are in degrees; the rest is in degrees.
  subroutine loads(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(document_type) :: document
    type(model_type) :: model
    type(diagnostics_type) :: diagnostics
    real(wp) :: factor, rate, acceleration
    type(error_type), allocatable :: err

    call checked(tester, "&load kind='coordinate', coordinate=1, stiffness=5, rest=90, damping=2, force=3 /"//eol// &
                 "&load kind='spring', links=1,4, position=1,2,3, second_position=4,5,6, stiffness=7, free_length=0.5 /"//eol// &
                 "&load kind='coordinate', coordinate=4, force=1, law='polynomial', coefficients=1,2 /"//eol, document, model, &
                 diagnostics)
    model%mechanism%units = degrees
    call read_loads(document, model%mechanism, diagnostics)
    call tester%is_true(.not. diagnostics%failed() .and. size(model%mechanism%loads) == 3, 'three loads')
    if (size(model%mechanism%loads) /= 3) return
    select type (load => model%mechanism%loads(1)%load)
    type is (coordinate_load_type)
      call near_vector(tester, [load%stiffness, load%rest, load%damping, load%force], [5.0_wp, pi/2.0_wp, 2.0_wp, 3.0_wp], tol, &
                       'a load on a coordinate')
    class default
      call tester%is_true(.false., 'the kind of the first load')
    end select
    select type (load => model%mechanism%loads(2)%load)
    type is (spring_load_type)
      call tester%is_true(all(load%links == [1, 4]), 'the links of a spring')
      call near_vector(tester, [load%positions, [load%stiffness, load%free_length]], [1.0_wp, 2.0_wp, 3.0_wp, 4.0_wp, 5.0_wp, &
                                                                                  6.0_wp, 7.0_wp, 0.5_wp], 0.0_wp, 'a spring')
    class default
      call tester%is_true(.false., 'the kind of the second load')
    end select
    call model%mechanism%loads(3)%load%law%evaluate(3.0_wp, factor, rate, acceleration, err)
    call tester%near(factor, 7.0_wp, tol, 'a law of time')
  end subroutine loads

  subroutine motors(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(document_type) :: document
    type(model_type) :: model
    type(diagnostics_type) :: diagnostics
    type(motor_slot_type), allocatable :: list(:)
    type(error_type), allocatable :: err
    real(wp) :: q, dq, ddq

    call checked(tester, "&motor coordinate=1, kind='dc', voltage=24, resistance=0.5, constant=0.05, gear_ratio=20 /"//eol// &
                 "&motor coordinate=4, kind='pid', proportional=50, derivative=5, limit=8, setpoint=1.25 /"//eol// &
                 "&motor coordinate=1, kind='pid', proportional=50, setpoint=90 /"//eol, document, model, diagnostics)
    model%mechanism%units = degrees
    call read_motors(document, model%mechanism, list, diagnostics)
    call tester%is_true(.not. diagnostics%failed() .and. size(list) == 3, 'three motors')
    if (size(list) /= 3) return
    select type (motor => list(1)%motor)
    type is (dc_motor_type)
      call near_vector(tester, [motor%voltage, motor%resistance, motor%inductance, motor%constant, motor%gear_ratio], &
                       [24.0_wp, 0.5_wp, 0.0_wp, 0.05_wp, 20.0_wp], 0.0_wp, 'a motor of direct current')
    class default
      call tester%is_true(.false., 'the kind of the first motor')
    end select
    select type (motor => list(2)%motor)
    type is (pid_motor_type)
      call near_vector(tester, [motor%proportional, motor%integral, motor%derivative, motor%limit], &
                       [50.0_wp, 0.0_wp, 5.0_wp, 8.0_wp], 0.0_wp, 'a controller')
      call motor%law%evaluate(1.0_wp, q, dq, ddq, err)
      call tester%near(q, 1.25_wp, 0.0_wp, 'a setpoint in metres')
    class default
      call tester%is_true(.false., 'the kind of the second motor')
    end select
    call list(3)%motor%law%evaluate(1.0_wp, q, dq, ddq, err)
    call tester%near(q, pi/2.0_wp, tol, 'a setpoint in degrees')
    call checked(tester, "&motor coordinate=1, kind='dc', resistance=0.5, constant=0.05 /"//eol, document, model, diagnostics)
    call read_motors(document, model%mechanism, list, diagnostics)
    call tester%is_true(diagnostics%failed(), 'a motor without voltage')
  end subroutine motors

  subroutine limits(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(document_type) :: document
    type(model_type) :: model
    type(diagnostics_type) :: diagnostics

    call checked(tester, "&limit kind='transmission', coordinate=3, at_least=0.7 /"//eol//"&limit kind='crank', coordinate=1 /"// &
                 eol, document, model, diagnostics)
    deallocate (model%request%limits)
    call read_limits(document, model, diagnostics)
    call tester%is_true(size(model%request%limits) == 2, 'two limits')
    if (size(model%request%limits) /= 2) return
    call tester%is_true(all(model%request%limits%coordinate == [3, 1]), 'their coordinates')
    call tester%near(model%request%limits(1)%at_least, 0.7_wp, 0.0_wp, 'the least angle')
  end subroutine limits

  !> Targets of a path, with times or without.
  subroutine objectives(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(document_type) :: document
    type(model_type) :: model
    type(diagnostics_type) :: diagnostics

    call save_lines(tester, path, ['1 2  ', '3 4  ', '5 6  '])
    call checked(tester, "&objective kind='path', point='B', file='"//path//"', weight=3 /"//eol//'&optimum starts=7, seed=8 /'// &
                 eol, document, model, diagnostics)
    deallocate (model%request%objectives)
    call read_objectives(document, model, diagnostics)
    call remove_file(path)
    call tester%is_true(.not. diagnostics%failed() .and. size(model%request%objectives) == 1, 'an objective')
    if (size(model%request%objectives) /= 1) return
    associate (objective => model%request%objectives(1))
      call near_vector(tester, [objective%targets(:2, :)], [1.0_wp, 2.0_wp, 3.0_wp, 4.0_wp, 5.0_wp, 6.0_wp], 0.0_wp, 'targets')
      call tester%is_true(objective%components == 2 .and. objective%point == 1, 'in a plane, of point B')
      call tester%near(objective%weight, 3.0_wp, 0.0_wp, 'their weight')
    end associate
    call tester%is_true(model%request%optimum%starts == 7 .and. model%request%optimum%seed == 8, 'starts and seed')
  end subroutine objectives

  !> A roller at a point of the follower; the axis of the cam is that of its pair.
  subroutine cams(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(document_type) :: document
    type(model_type) :: model
    type(diagnostics_type) :: diagnostics
    type(cam_request_type), allocatable :: list(:)

    call checked(tester, '&cam link=2, follower=4, roller=0.01, point=0,0.05,0 /'//eol//'&cam link=2, follower=4, face=0,-2,0 /'// &
                 eol, document, model, diagnostics)
    call read_cams(document, model%mechanism%structure, model%mechanism%pairs, list, diagnostics)
    call tester%is_true(.not. diagnostics%failed() .and. size(list) == 2, 'two cams')
    if (size(list) /= 2) return
    call tester%is_true(list(1)%link == 2 .and. list(1)%follower == 4 .and. .not. (list(1)%flat .or. list(1)%outer), 'a cam')
    call near_vector(tester, [list(1)%roller, list(1)%point, abs(list(1)%axis)], [0.01_wp, 0.0_wp, 0.05_wp, 0.0_wp, 0.0_wp, &
                                                                               0.0_wp, 1.0_wp], tol, 'roller and axis')
    call tester%is_true(list(2)%flat .and. list(1)%guide == 4, 'a flat face, and the slide that guides')
    call near_vector(tester, list(2)%face, [0.0_wp, -1.0_wp, 0.0_wp], tol, 'the normal of a face has length one')
  end subroutine cams
end module test_mechanism_readers
