!> Derivatives by which a search goes on, against differences of what they are derivatives of: of the limit that a crank turns fully,
!> and of the equations of open chains and couplings.
module test_design_derivatives
  use mech9_program_kind, only: kinematics
  use mech9_kinds, only: wp
  use mech9_error, only: error_type
  use mech9_source, only: source_from_text
  use mech9_document, only: document_type
  use mech9_diagnostics, only: diagnostics_type
  use mech9_parser, only: parse_document
  use mech9_reader, only: read_model
  use mech9_model, only: model_type
  use mech9_plan, only: plan_type, new_state
  use mech9_state, only: state_type
  use mech9_varied_document, only: varied_document_type, new_varied_document
  use mech9_explained_assembly, only: assemble_model
  use mech9_design_space, only: design_space_type, design_type, new_design_space, new_design, place_design, find_tangents
  use mech9_open_position, only: open_position_type, new_open_position, place_at, find_openings, find_derivatives
  use mech9_branch, only: close_near
  use mech9_targets, only: target_type
  use mech9_exact_fit, only: exact_fit_type, new_exact_fit
  use mech9_crank_limit, only: crank_limit_type, new_crank_limit, find_crank_numbers
  use mech9_testing, only: tester_type
  implicit none
  private
  public :: run

  character, parameter :: eol = new_line('a')
  character(len=*), parameter :: run_of_crank = &
    "&drive coordinate=1, kind='polynomial', coefficients=0.7,1 /"//eol//"&time end=1, intervals=4 /"//eol// &
    "&parameter name='begin', sets='drive(1).coefficients(1)', low=0.5, high=0.9 /"//eol
  character(len=*), parameter :: four_bar = &
    "&structure cq=1 /"//eol// &
    "&pair coordinate=1, links=1,2, kind='revolute', axis=0,0,1 /"//eol// &
    "&pair coordinate=2, links=2,3, kind='revolute', axis=0,0,1, point=0.4,0,0, moving_point=0,0,0 /"//eol// &
    "&pair coordinate=3, links=3,4, kind='revolute', axis=0,0,1, point=1.9,0,0, moving_point=1.6,0,0 /"//eol// &
    "&pair coordinate=4, links=1,4, kind='revolute', axis=0,0,1, point=2,0.1,0, moving_point=0,0,0 /"//eol// &
    "&initial coordinate=2, position=0.9 / &initial coordinate=3, position=1 / &initial coordinate=4, position=1.7 /"//eol// &
    "&parameter name='crank', sets='pair(2).point(1)', low=0.3, high=0.5 /"//eol// &
    "&parameter name='rod', sets='pair(3).point(1)', low=1.8, high=2 /"//eol// &
    "&parameter name='height', sets='pair(4).point(2)', low=0, high=0.2 /"//eol
  character(len=*), parameter :: screw = &
    "&structure cq=1 /"//eol// &
    "&pair coordinate=1, links=1,2, kind='revolute', axis=0,0,1, moving_point=0,0,0 /"//eol// &
    "&pair coordinates=2,3,4, links=2,3, kind='spherical', point=0.2,0.15,0, moving_point=0,0,0 /"//eol// &
    "&pair coordinates=5,6,7, links=3,4, kind='spherical', point=1.1,0,0, moving_point=0,0,0.6 /"//eol// &
    "&pair coordinate=8, links=1,4, kind='helical', axis=0.1,1,0, point=1,0,0, moving_point=0,0,0, pitch=0.3 /"//eol// &
    "&parameter name='rod', sets='pair(3).point(1)', low=1, high=1.2 /"//eol// &
    "&parameter name='tilt', sets='pair(4).axis(1)', value=0.1, low=0, high=0.2 /"//eol// &
    "&parameter name='pitch', sets='pair(4).pitch', low=0.2, high=0.4 /"//eol
  character(len=*), parameter :: geared = &
    "&structure cq=1 /"//eol// &
    "&pair coordinate=1, links=1,2, kind='revolute', axis=0,0,1 /"//eol// &
    "&pair coordinate=2, links=2,3, kind='revolute', axis=0,0,1, point=0.5,0,0, moving_point=0,0,0 /"//eol// &
    "&pair coordinate=3, links=3,4, kind='revolute', axis=0,0,1, point=2,0,0, moving_point=2,0,0 /"//eol// &
    "&pair coordinate=4, links=5,4, kind='revolute', axis=0,0,1, point=0.6,0,0, moving_point=0,0,0 /"//eol// &
    "&pair coordinate=5, links=1,5, kind='revolute', axis=0,0,1, point=1.5,0,0, moving_point=0,0,0 /"//eol// &
    "&coupling kind='gear', coordinates=1,5, ratio=-1.8 /"//eol// &
    "&initial coordinate=2, position=0.9 / &initial coordinate=3, position=1 / &initial coordinate=4, position=1.7 /"//eol// &
    "&parameter name='ratio', sets='coupling(1).ratio', low=-2, high=-1.5 /"//eol// &
    "&parameter name='rod', sets='pair(3).point(1)', low=1.8, high=2.2 /"//eol
  character(len=*), parameter :: guided = &
    "&structure cq=1 /"//eol// &
    "&pair coordinate=1, links=1,2, kind='revolute', axis=0,0,1 /"//eol// &
    "&pair coordinate=2, links=2,3, kind='revolute', axis=0,0,1, point=0.2,0,0, moving_point=0,0,0 /"//eol// &
    "&pair coordinate=3, links=1,4, kind='path', file='test_design_curve.dat', scale=1.1, orientation='fixed' /"//eol// &
    "&pair coordinate=4, links=4,3, kind='revolute', axis=0,0,1, moving_point=1,0,0 /"//eol// &
    "&initial coordinate=3, position=0.5 /"//eol// &
    "&parameter name='scale', sets='pair(3).scale', low=1, high=1.2 /"//eol// &
    "&parameter name='place', sets='pair(3).point(2)', value=0, low=-0.1, high=0.1 /"//eol

  real(wp), parameter :: step_part = 1.0e-3_wp   !< step of differences, as a part of the range of a parameter

contains

  !> Run the cases of this suite.
  subroutine run(tester)
    type(tester_type), intent(inout) :: tester   !< selects cases and counts their checks

    if (tester%runs('four_bar')) call check(four_bar//run_of_crank, 'four-bar linkage', tester)
    if (tester%runs('screw')) call check(screw//run_of_crank, 'crank, rod and screw', tester)
    if (tester%runs('geared')) call check(geared//run_of_crank, 'geared five-bar linkage', tester)
    if (tester%runs('guided')) call check_guided(tester)
  end subroutine run

  !> A guide on a curve from a file.
  subroutine check_guided(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks

    call write_curve()
    call check(guided//run_of_crank, 'guide of another size', tester)
  end subroutine check_guided

  !> The file of a guide: a part of a large circle about (0.9, -2).
  subroutine write_curve()
    integer :: unit, i

    open (newunit=unit, file='test_design_curve.dat', action='write', status='replace')
    do i = 0, 40
      write (unit, '(2es24.16)') 0.9_wp + 2.0_wp*sin((i - 20)*0.025_wp), -2.0_wp + 2.0_wp*cos((i - 20)*0.025_wp)
    end do
    close (unit)
  end subroutine write_curve

  !> Compare all derivatives of a mechanism with differences.
  subroutine check(text, name, tester)
    character(len=*), intent(in) :: text         !< the data file
    character(len=*), intent(in) :: name         !< of the mechanism
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(document_type) :: document
    type(diagnostics_type) :: diagnostics
    type(varied_document_type), target :: varied
    type(model_type) :: model
    type(plan_type) :: plan
    type(state_type) :: start
    type(design_space_type), target :: space
    type(error_type), allocatable :: err

    call parse_document(source_from_text('f.nml', text), document, diagnostics)
    call read_model(document, kinematics, model, diagnostics)
    call tester%is_true(.not. diagnostics%failed(), name//': the data file is sound')
    if (diagnostics%failed()) return
    call new_varied_document(document, diagnostics%sources, kinematics, varied)
    call assemble_model(model, plan, start, err)
    if (.not. allocated(err)) call new_design_space(varied, model, plan, space, err)
    call tester%no_error(err, name//': there are designs')
    if (allocated(err)) return
    call check_openings(space, start, name, tester)
    call check_crank(space, start, name, tester)
  end subroutine check

  !> The derivatives of the equations of chains and couplings by the parameters, at the closed position.
  subroutine check_openings(space, start, name, tester)
    type(design_space_type), intent(inout) :: space   !< the designs
    type(state_type), intent(in) :: start             !< the closed position
    character(len=*), intent(in) :: name              !< of the mechanism
    type(tester_type), intent(inout) :: tester        !< counts the checks
    type(design_type) :: design
    type(open_position_type) :: position
    type(error_type), allocatable :: err
    real(wp), allocatable :: exact(:, :), values(:, :)
    real(wp) :: x(size(space%varied)), h
    integer :: p, k

    call new_design(space, design)
    call new_open_position(design, position)
    x = space%values(space%varied)
    call place_design(space, x, design, err)
    if (.not. allocated(err)) call find_tangents(space, design, err)
    if (.not. allocated(err)) call place_at(design, 0.0_wp, start%q, position, err)
    call tester%no_error(err, name//': the chains have a position')
    if (allocated(err)) return
    call find_derivatives(design, position)
    exact = position%by_x
    allocate (values(position%equations, -2:2))
    do p = 1, size(x)
      h = step_part*(space%high(p) - space%low(p))
      do k = -2, 2
        call place_design(space, moved(x, p, k*h), design, err)
        if (.not. allocated(err)) call place_at(design, 0.0_wp, start%q, position, err)
        if (.not. allocated(err)) call find_openings(design, position, err)
        if (allocated(err)) exit
        values(:, k) = position%opening
      end do
      call tester%no_error(err, name//': the chains have positions nearby')
      if (allocated(err)) return
      call compare(exact(:, p), difference(values, h), name//': equations by '//name_of(space, p), tester)
    end do
  end subroutine check_openings

  !> The derivatives of how far a design is from the edge of those whose crank turns.
  subroutine check_crank(space, start, name, tester)
    type(design_space_type), intent(inout), target :: space   !< the designs
    type(state_type), intent(in) :: start                     !< the closed position
    character(len=*), intent(in) :: name                      !< of the mechanism
    type(tester_type), intent(inout) :: tester                !< counts the checks
    type(design_type) :: design
    type(open_position_type) :: position
    type(exact_fit_type) :: fit
    type(crank_limit_type) :: crank
    type(target_type) :: targets(0)
    real(wp), allocatable :: exact(:, :), values(:, :), slopes(:, :)
    real(wp) :: x(size(space%varied)), h
    integer :: p, k
    logical :: found

    call new_design(space, design)
    call new_open_position(design, position)
    call new_exact_fit(space, design, position, targets, fit)
    call new_crank_limit(space%plan, 1, crank)
    allocate (values(crank%n, -2:2), slopes(fit%varied, crank%n))
    x = space%values(space%varied)
    call find_numbers(space, start, crank, x, fit, values(:, 0), slopes, found)
    call tester%is_true(found .and. all(values(:, 0) > 1.0e-4_wp), name//': the crank turns')
    if (.not. found) return
    exact = transpose(slopes)
    do p = 1, size(x)
      h = step_part*(space%high(p) - space%low(p))
      do k = -2, 2
        if (found) call find_numbers(space, start, crank, moved(x, p, k*h), fit, values(:, k), slopes, found)
      end do
      call tester%is_true(found, name//': the crank turns nearby')
      if (.not. found) return
      call compare(exact(:, p), difference(values, h), name//': crank by '//name_of(space, p), tester)
    end do
  end subroutine check_crank

  !> The numbers of the limit at a design, and their derivatives.
  subroutine find_numbers(space, start, crank, x, fit, numbers, slopes, found)
    type(design_space_type), intent(inout) :: space   !< the designs
    type(state_type), intent(in) :: start             !< a closed position
    type(crank_limit_type), intent(in) :: crank       !< the limit
    real(wp), intent(in) :: x(:)                      !< values of the parameters
    type(exact_fit_type), intent(inout) :: fit        !< gets the design
    real(wp), intent(out) :: numbers(:)               !< the numbers
    real(wp), intent(out) :: slopes(:, :)             !< their derivatives
    logical, intent(out) :: found                     !< they exist
    type(state_type) :: state
    type(error_type), allocatable :: err

    call place_design(space, x, fit%design, err)
    found = .not. allocated(err)
    if (.not. found) return
    state = new_state(fit%design%plan)
    state%q = start%q
    call close_near(fit%design, fit%start, state, found)
    if (found) call find_tangents(space, fit%design, err)
    found = found .and. .not. allocated(err)
    if (.not. found) return
    fit%q_start = state%q
    call find_crank_numbers(fit, crank, numbers, slopes, found)
  end subroutine find_numbers

  !> A place with one number changed.
  pure function moved(x, p, by) result(place)
    real(wp), intent(in) :: x(:)   !< the place
    integer, intent(in) :: p       !< of the number
    real(wp), intent(in) :: by     !< its change
    real(wp) :: place(size(x))

    place = x
    place(p) = x(p) + by
  end function moved

  !> Derivatives by central differences of fourth order.
  pure function difference(values, h) result(slope)
    real(wp), intent(in) :: values(:, -2:)   !< values at five places
    real(wp), intent(in) :: h                !< distance of neighbours
    real(wp) :: slope(size(values, 1))

    slope = (8.0_wp*(values(:, 1) - values(:, -1)) - (values(:, 2) - values(:, -2)))/(12.0_wp*h)
  end function difference

  !> The name of a varied parameter.
  pure function name_of(space, p) result(name)
    type(design_space_type), intent(in) :: space   !< the designs
    integer, intent(in) :: p                       !< of the varied parameter
    character(len=:), allocatable :: name

    name = space%model%parameters(space%varied(p))%name
  end function name_of

  !> Compare derivatives with differences. Steps of a thousandth of the range leave some 1e-10 of truncation and of round-off.
  subroutine compare(exact, slopes, why, tester)
    real(wp), intent(in) :: exact(:)             !< derivatives
    real(wp), intent(in) :: slopes(:)            !< differences
    character(len=*), intent(in) :: why          !< the derivatives that are compared
    type(tester_type), intent(inout) :: tester   !< counts the checks
    real(wp) :: largest
    integer :: i

    largest = max(maxval(abs(slopes)), 1.0e-3_wp)
    do i = 1, size(exact)
      call tester%near(exact(i)/largest, slopes(i)/largest, 1.0e-8_wp, why)
    end do
  end subroutine compare
end module test_design_derivatives
