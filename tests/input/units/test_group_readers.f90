!> Readers of single groups, each called with the mechanism that it needs: units, defaults, and order of numbers.
module test_group_readers
  use mech9_program_kind, only: dynamics
  use mech9_kinds, only: wp
  use mech9_axis_reader, only: read_axis_frames, real_or, pair_words
  use mech9_body, only: body_type
  use mech9_body_reader, only: read_bodies, read_gravity
  use mech9_checker, only: check_document
  use mech9_diagnostics, only: diagnostics_type
  use mech9_document, only: document_type
  use mech9_model, only: model_type
  use mech9_problem, only: initial_type
  use mech9_motion_reader, only: read_initial, read_points
  use mech9_output_reader, only: read_output
  use mech9_parameter, only: parameter_type
  use mech9_parameter_reader, only: read_parameters
  use mech9_parser, only: parse_document
  use mech9_point, only: point_type
  use mech9_pose, only: pose_type
  use mech9_quantity, only: quantity_type
  use mech9_quantity_reader, only: read_quantities
  use mech9_request, only: output_settings_type
  use mech9_source, only: source_from_text
  use mech9_study, only: study_type
  use mech9_units, only: units_of_words
  use mech9_study_reader, only: read_study
  use mech9_checks, only: near_vector, near_matrix
  use mech9_small_models, only: slider_crank, eol
  use mech9_text_models, only: model_from_text, checked_from_text
  use mech9_test_files, only: save_lines, remove_file
  use mech9_testing, only: tester_type
  implicit none
  private
  public :: run

contains

  !> Run the cases of this suite.
  subroutine run(tester)
    type(tester_type), intent(inout) :: tester   !< selects cases and counts their checks

    if (tester%runs('bodies')) call bodies(tester)
    if (tester%runs('flat_tensors')) call flat_tensors(tester)
    if (tester%runs('starts')) call starts(tester)
    if (tester%runs('points')) call points(tester)
    if (tester%runs('axes')) call axes(tester)
    if (tester%runs('outputs')) call outputs(tester)
    if (tester%runs('parameters')) call parameters(tester)
    if (tester%runs('studies')) call studies(tester)
  end subroutine run

  !> A checked document, and the slider-crank as mechanism.
  subroutine checked(tester, groups, document, model, diagnostics)
    type(tester_type), intent(inout) :: tester            !< counts the checks
    character(len=*), intent(in) :: groups                !< behind those of the slider-crank
    type(document_type), intent(out) :: document          !< all groups
    type(model_type), intent(out) :: model                !< the slider-crank
    type(diagnostics_type), intent(out) :: diagnostics    !< gets the errors

    call model_from_text(tester, slider_crank, dynamics, model)
    call checked_from_text(tester, slider_crank//groups, document, diagnostics)
  end subroutine checked

  !> The order of an inertia is xx, yy, zz, xy, xz, yz, and a body without centre has it at its origin.
  subroutine bodies(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(document_type) :: document
    type(model_type) :: model
    type(diagnostics_type) :: diagnostics
    type(body_type), allocatable :: list(:)
    real(wp) :: gravity(3)

    call checked(tester, '&body link=3, mass=2, centre=0.5,0,0, inertia=4,5,6,0.1,0.2,0.3 /'//eol//'&body link=2, mass=1 /'//eol// &
                 '&gravity acceleration=0,-9.81,0 /'//eol, document, model, diagnostics)
    call read_bodies(document, model%mechanism%structure, model%mechanism%pairs, list, diagnostics)
    call tester%is_true(.not. diagnostics%failed() .and. size(list) == 2, 'two bodies')
    if (size(list) /= 2) return
    call near_matrix(tester, list(1)%inertia, reshape([4.0_wp, 0.1_wp, 0.2_wp, 0.1_wp, 5.0_wp, 0.3_wp, 0.2_wp, 0.3_wp, 6.0_wp], &
                                                      [3, 3]), 0.0_wp, 'the tensor')
    call near_vector(tester, [list(1)%mass, list(1)%centre, list(2)%centre], [2.0_wp, 0.5_wp, 0.0_wp, 0.0_wp, 0.0_wp, 0.0_wp, &
                                                                           0.0_wp], 0.0_wp, 'masses and centres')
    call tester%is_true(list(1)%link == 3 .and. list(2)%link == 2, 'in their order')
    gravity = read_gravity(document)
    call near_vector(tester, gravity, [0.0_wp, -9.81_wp, 0.0_wp], 0.0_wp, 'gravity')
    call checked(tester, '&body link=9, mass=2 /'//eol//'&body link=3, mass=1, inertia=1,1,9,0,0,0 /'//eol, document, model, &
                 diagnostics)
    call read_bodies(document, model%mechanism%structure, model%mechanism%pairs, list, diagnostics)
    call tester%is_true(diagnostics%count >= 2, 'a link that is not there, and an inertia that no body has')
  end subroutine bodies

  !> Tensors of flat bodies in the planes x y, x z and y z. The second moments along both axes of the plane are 1, and the mixed one
  !> is at most 1, where all mass lies on one line. Beyond that no body has the tensor.
  subroutine flat_tensors(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    character(len=*), parameter :: moments(3) = ['1,1,2', '1,2,1', '2,1,1']
    character(len=*), parameter :: products(3) = [character(len=9) :: '-one,0,0', '0,-one,0', '0,0,-one']
    character(len=*), parameter :: sizes(2) = ['0.99', '1.01']
    type(document_type) :: document
    type(model_type) :: model
    type(diagnostics_type) :: diagnostics
    type(body_type), allocatable :: list(:)
    integer :: plane, i, at

    do plane = 1, 3
      at = index(products(plane), 'one')
      do i = 1, 2
        call checked(tester, '&body link=3, mass=1, inertia='//moments(plane)//','//products(plane)(:at - 1)//sizes(i)// &
                     trim(products(plane)(at + 3:))//' /'//eol, document, model, diagnostics)
        call read_bodies(document, model%mechanism%structure, model%mechanism%pairs, list, diagnostics)
        call tester%is_true(diagnostics%failed() .eqv. i == 2, 'a flat body '//products(plane)//' with '//sizes(i))
      end do
    end do
  end subroutine flat_tensors

  !> Angles have the unit of the file, lengths are in metres.
  subroutine starts(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    real(wp), parameter :: degree = acos(-1.0_wp)/180.0_wp
    type(document_type) :: document
    type(model_type) :: model
    type(diagnostics_type) :: diagnostics
    type(initial_type) :: initial

    call checked(tester, '&initial coordinate=1, position=30, velocity=60 /'//eol, document, model, diagnostics)
    call read_initial(document, model%problem%partition, model%mechanism%pairs, units_of_words('m', 'deg', 'N', 'kg', ''), &
                      initial, diagnostics)
    call tester%is_true(.not. diagnostics%failed(), 'initial values')
    ! two roundings of numbers of order one
    call near_vector(tester, initial%position, [30.0_wp*degree, 0.0_wp, 0.0_wp, 1.2_wp], 4.0e-16_wp, 'positions')
    call near_vector(tester, initial%velocity, [60.0_wp*degree, 0.0_wp, 0.0_wp, 0.0_wp], 4.0e-16_wp, 'velocities')
  end subroutine starts

  subroutine points(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(document_type) :: document
    type(model_type) :: model
    type(diagnostics_type) :: diagnostics
    type(point_type), allocatable :: list(:)

    call checked(tester, "&point name='C', link=3, position=0.5,0.25,0 /"//eol, document, model, diagnostics)
    call read_points(document, 4, list, diagnostics)
    call tester%is_true(.not. diagnostics%failed() .and. size(list) == 2, 'two points')
    if (size(list) /= 2) return
    call tester%is_true(list(1)%name == 'B' .and. list(2)%name == 'C' .and. list(2)%link == 3, 'names and links')
    call near_vector(tester, list(2)%position, [0.5_wp, 0.25_wp, 0.0_wp], 0.0_wp, 'a position')
    call read_points(document, 2, list, diagnostics)
    call tester%is_true(diagnostics%count == 2, 'links that are not there')
  end subroutine points

  !> The frame of a pair: z along the axis, x near the direction of zero, and the moving one equal to it unless it is given.
  subroutine axes(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(document_type) :: document
    type(diagnostics_type) :: diagnostics
    type(pose_type) :: reference, moving

    call parse_document(source_from_text('a.nml', "&pair coordinate=5, links=1,2, kind='revolute', axis=0,0,2, point=1,2,3, "// &
      "zero=1,1,5, moving_point=0,0,7 /"//eol//"&pair coordinate=6, links=2,3, kind='revolute', axis=0,0,1, zero=0,0,3 /"//eol), &
      document, diagnostics)
    call check_document(document, diagnostics)
    call read_axis_frames(document%groups(1), reference, moving, diagnostics)
    call tester%is_true(.not. diagnostics%failed(), 'the frames of a pair')
    call near_vector(tester, reference%r(:, 3), [0.0_wp, 0.0_wp, 1.0_wp], 0.0_wp, 'z is along the axis')
    ! the direction loses its part along the axis and gets length one, with a few roundings
    call near_vector(tester, reference%r(:, 1), [sqrt(0.5_wp), sqrt(0.5_wp), 0.0_wp], 1.0e-15_wp, 'x is near zero')
    call near_vector(tester, [reference%p, moving%p], [1.0_wp, 2.0_wp, 3.0_wp, 0.0_wp, 0.0_wp, 7.0_wp], 0.0_wp, 'points')
    call near_matrix(tester, moving%r, reference%r, 0.0_wp, 'the moving frame has the same directions')
    call near_vector(tester, real_or(document%groups(1), 'moving_axis', [9.0_wp, 8.0_wp, 7.0_wp]), [9.0_wp, 8.0_wp, 7.0_wp], &
                     0.0_wp, 'other numbers where none are given')
    call tester%is_true(pair_words(document%groups(1)) == 'pair 5', 'the name of a pair')
    call read_axis_frames(document%groups(2), reference, moving, diagnostics)
    call tester%is_true(diagnostics%failed(), 'a direction of zero along the axis')
  end subroutine axes

  subroutine outputs(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(document_type) :: document
    type(model_type) :: model
    type(diagnostics_type) :: diagnostics
    type(output_settings_type) :: output

    call checked(tester, '', document, model, diagnostics)
    call read_output(document, model%mechanism%structure, output, diagnostics)
    call tester%is_true(output%table == '' .and. output%derivatives == 2 .and. all(output%recorded(4)), 'the defaults')
    call checked(tester, "&output table='a.dat', coordinates=4,1, derivatives=1, poses=.true. /"//eol, document, model, diagnostics)
    call read_output(document, model%mechanism%structure, output, diagnostics)
    call tester%is_true(output%table == 'a.dat' .and. output%derivatives == 1 .and. output%poses, 'settings')
    call tester%is_true(all(output%recorded(4) .eqv. [.true., .false., .false., .true.]), 'coordinates that are recorded')
    call checked(tester, '&output coordinates=5 /'//eol, document, model, diagnostics)
    call read_output(document, model%mechanism%structure, output, diagnostics)
    call tester%is_true(diagnostics%count == 1, 'a coordinate that is not there')
  end subroutine outputs

  !> The value of a parameter is that of its number unless it is given, and numbers are factor times value plus term.
  subroutine parameters(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(document_type) :: document
    type(model_type) :: model
    type(diagnostics_type) :: diagnostics
    type(parameter_type), allocatable :: list(:)
    integer :: i

    call checked(tester, "&parameter name='r', sets='pair(2).point(1)', factors=2, terms=0.1 /"//eol// &
                 "&parameter name='l', value=5, sets='pair(3).point(1)', 'pair(3).point(2)', factors=1, 0.5 /"//eol, document, &
                 model, diagnostics)
    call read_parameters(document, list, diagnostics)
    call tester%is_true(.not. diagnostics%failed() .and. size(list) == 2, 'two parameters')
    if (size(list) /= 2) return
    call tester%near(list(1)%value, 0.1_wp, 1.0e-16_wp, 'the value with which 2 v + 0.1 is 0.3')
    call tester%is_true(size(list(2)%targets) == 2, 'two numbers')
    associate (values => document%groups(list(2)%targets(1)%group_place)%items(list(2)%targets(1)%item_place)%values)
      call near_vector(tester, [(values(i)%number, i=1, 3)], [5.0_wp, 2.5_wp, 0.0_wp], 0.0_wp, 'the numbers that it sets')
    end associate
  end subroutine parameters

  subroutine studies(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    character(len=*), parameter :: path = 'test_group_readers.txt'
    character(len=*), parameter :: two = "&parameter name='r', sets='pair(2).point(1)', low=0.1, high=0.3, count=3 /"//eol// &
                                         "&parameter name='l', sets='pair(3).point(1)', low=1, high=2, count=4 /"//eol
    type(document_type) :: document
    type(model_type) :: model
    type(diagnostics_type) :: diagnostics
    type(parameter_type), allocatable :: list(:)
    type(quantity_type), allocatable :: quantities(:)
    type(study_type) :: study

    call checked(tester, two//"&study kind='grid' /"//eol//"&quantity name='s', of='q4', take='max' /"//eol, document, model, &
                 diagnostics)
    call read_parameters(document, list, diagnostics)
    call read_study(document, list, study, diagnostics)
    call tester%is_true(.not. diagnostics%failed() .and. study%kind == 'grid' .and. study%runs == 12, 'a grid of 3 times 4')
    call read_quantities(document, model%request%time, quantities, diagnostics)
    call tester%is_true(size(quantities) == 1 .and. quantities(1)%name == 's' .and. quantities(1)%column == 'q4', 'a quantity')
    call save_lines(tester, path, [character(len=10) :: 'r l', '0.1 1', '0.2 3'])
    call checked(tester, two//"&study kind='list', file='"//path//"' /"//eol, document, model, diagnostics)
    call read_parameters(document, list, diagnostics)
    call read_study(document, list, study, diagnostics)
    call remove_file(path)
    call tester%is_true(study%runs == 2, 'a list of two runs')
    if (study%runs == 2) call near_matrix(tester, study%list, reshape([0.1_wp, 1.0_wp, 0.2_wp, 3.0_wp], [2, 2]), 0.0_wp, 'values')
  end subroutine studies
end module test_group_readers
