!> Analyses for C: each takes a mechanism and gives results (include/mech9.h).
module mech9_api_analyses
  use, intrinsic :: iso_c_binding, only: c_int, c_ptr, c_null_ptr
  use, intrinsic :: ieee_arithmetic, only: ieee_value, ieee_quiet_nan
  use mech9, only: wp, error_type, finding_type, mechanism_type, run_type, rest_type, study_type, optimum_type, &
    exponents_found_type, find_motion_exponents, &
    judge_mobility, list_assemblies, list_ranges, name_coordinates, report_parts, find_cam, draw_sketch, &
    draw_film, exit_file, exit_data, exit_structure, exit_interrupted, kinematics, dynamics
  use mech9_api_text, only: c_text_type, read_c_text
  use mech9_api_error, only: begin_call, end_call
  use mech9_api_interruption, only: flag_interruption_type, progress_type, new_interruption, end_progress
  use mech9_api_mechanism, only: find_mechanism, find_progress
  use mech9_api_results, only: results_type, show_results, put_texts, put_matrix
  implicit none
  private
  public :: end_analysis, has_rows

contains

  !> Judge structure and assembly: the numbers mobility and redundant, and a report.
  integer(c_int) function check(mechanism, results, error) bind(c, name='mech9_check') result(code)
    type(c_ptr), value, intent(in) :: mechanism   !< the mechanism
    type(c_ptr), intent(out) :: results           !< the results; null after a failure
    type(c_ptr), value, intent(in) :: error       !< handle of errors, or null
    type(mechanism_type), pointer :: judged
    type(results_type), pointer :: found
    type(error_type), allocatable :: err
    character(len=:), allocatable :: text
    integer :: mobility, redundant

    call begin_call(error)
    results = c_null_ptr
    call find_mechanism(mechanism, judged, err)
    if (.not. allocated(err)) call judge_mobility(judged, mobility, redundant, err, text)
    if (.not. allocated(err)) then
      allocate (found)
      call put_texts([character(len=9) :: 'mobility', 'redundant'], found%number_names)
      call put_texts(['1', '1'], found%number_units)
      found%numbers = real([mobility, redundant], wp)
      call found%text%put(text)
      results = show_results(found)
    end if
    code = end_analysis(error, err, judged, dynamics)
  end function check

  !> Make a driven run over the outputs of &time.
  integer(c_int) function run_kinematics(mechanism, stop, results, error) bind(c, name='mech9_kinematics') result(code)
    type(c_ptr), value, intent(in) :: mechanism   !< the mechanism
    type(c_ptr), value, intent(in) :: stop        !< address of a number that stops the run once it is not 0, or null
    type(c_ptr), intent(out) :: results           !< rows and quantities, also those before a failure; null if there are none
    type(c_ptr), value, intent(in) :: error       !< handle of errors, or null

    code = make_run(mechanism, kinematics, .false., stop, results, error)
  end function run_kinematics

  !> Make a run under forces over the outputs of &time.
  integer(c_int) function run_dynamics(mechanism, stop, results, error) bind(c, name='mech9_dynamics') result(code)
    type(c_ptr), value, intent(in) :: mechanism   !< the mechanism
    type(c_ptr), value, intent(in) :: stop        !< address of a number that stops the run once it is not 0, or null
    type(c_ptr), intent(out) :: results           !< rows and quantities, also those before a failure; null if there are none
    type(c_ptr), value, intent(in) :: error       !< handle of errors, or null

    code = make_run(mechanism, dynamics, .false., stop, results, error)
  end function run_dynamics

  !> Find a periodic motion under forces, and make a run over one period of it.
  integer(c_int) function run_periodic(mechanism, stop, results, error) bind(c, name='mech9_periodic') result(code)
    type(c_ptr), value, intent(in) :: mechanism   !< the mechanism
    type(c_ptr), value, intent(in) :: stop        !< address of a number that stops search and run once it is not 0, or null
    type(c_ptr), intent(out) :: results           !< rows and quantities of the period; null if there are none
    type(c_ptr), value, intent(in) :: error       !< handle of errors, or null

    code = make_run(mechanism, dynamics, .true., stop, results, error)
  end function run_periodic

  !> Make a run of a program.
  integer(c_int) function make_run(mechanism, program, is_periodic, stop, results, error) result(code)
    type(c_ptr), intent(in) :: mechanism   !< the mechanism
    integer, intent(in) :: program         !< kinematics or dynamics
    logical, intent(in) :: is_periodic     !< of dynamics: a periodic motion is found first
    type(c_ptr), intent(in) :: stop        !< address of a number that stops the run once it is not 0, or null
    type(c_ptr), intent(out) :: results    !< rows and quantities; null if there are none
    type(c_ptr), intent(in) :: error       !< handle of errors, or null
    type(mechanism_type), pointer :: moved
    type(results_type), pointer :: found
    type(run_type), pointer :: run
    type(flag_interruption_type) :: interruption
    type(progress_type), target :: progress
    type(error_type), allocatable :: err

    call begin_call(error)
    results = c_null_ptr
    call find_progress(mechanism, progress)
    call new_interruption(stop, interruption, progress)
    allocate (run)
    call find_mechanism(mechanism, moved, err)
    if (.not. allocated(err)) then
      if (program == kinematics) then
        call run%begin_kinematics(moved, err, interruption)
      else if (is_periodic) then
        call run%begin_periodic(moved, err, interruption)
      else
        call run%begin_dynamics(moved, err, interruption)
      end if
    end if
    if (.not. allocated(err)) then
      allocate (found)
      call take_run(run, found, err)
      found%run => run
      results = show_results(found)
    else
      call run%close()
      deallocate (run)
    end if
    call end_progress(progress, err)
    code = end_analysis(error, err, moved, program)
  end function make_run

  !> Take the rows and quantities of a run.
  subroutine take_run(run, found, err)
    type(run_type), intent(inout) :: run                   !< the run, begun
    type(results_type), intent(inout) :: found             !< gets them
    type(error_type), allocatable, intent(out) :: err      !< allocated if it failed
    character(len=:), allocatable :: names(:), units(:)
    real(wp), allocatable :: points(:, :)
    integer :: status

    call run%columns(names, units)
    call put_texts(names, found%names)
    call put_texts(units, found%units)
    allocate (found%rows(size(names), run%outputs()), found%poses(run%pose_columns(), run%outputs()), stat=status)
    if (status /= 0) then
      allocate (err)
      err%code = exit_file
      err%message = 'there is not enough memory for all rows; ask for fewer outputs'
      return
    end if
    call run%take_rows(found%rows, found%count, err, found%poses)
    call run%quantities(names, found%numbers, units)
    call put_texts(names, found%number_names)
    call put_texts(units, found%number_units)
    call run%gradients(found%derivatives)
    call run%section(names, points, units)
    call put_section(names, points, units, found)
  end subroutine take_run

  !> Put the points of a section as a matrix, with the units of its columns. Its rows have no names.
  subroutine put_section(names, points, units, found)
    character(len=*), intent(in) :: names(:)               !< (columns) none without a section
    real(wp), intent(in) :: points(:, :)                   !< (columns,points)
    character(len=*), intent(in) :: units(:)               !< (columns)
    type(results_type), intent(inout) :: found             !< gets them
    character(len=1), allocatable :: nameless(:)

    if (size(names) == 0) return
    allocate (found%matrices(1), nameless(0))
    call put_matrix('section', transpose(points), nameless, nameless, names, units, found%matrices(1))
  end subroutine put_section

  !> Find the first Lyapunov exponents of a motion under forces.
  integer(c_int) function find_exponents(mechanism, count, stop, results, error) bind(c, name='mech9_exponents') result(code)
    type(c_ptr), value, intent(in) :: mechanism   !< the mechanism
    integer(c_int), value, intent(in) :: count    !< how many exponents are found
    type(c_ptr), value, intent(in) :: stop        !< address of a number that stops the motion once it is not 0, or null
    type(c_ptr), intent(out) :: results           !< a row for each time of the running means, the exponents; null after a failure,
                                                  !< but for an interruption after the transient
    type(c_ptr), value, intent(in) :: error       !< handle of errors, or null
    type(mechanism_type), pointer :: moved
    type(exponents_found_type) :: exponents
    type(results_type), pointer :: found
    type(flag_interruption_type) :: interruption
    type(error_type), allocatable :: err
    character(len=16), allocatable :: names(:)
    integer :: k, n

    call begin_call(error)
    results = c_null_ptr
    call new_interruption(stop, interruption)
    call find_mechanism(mechanism, moved, err)
    if (.not. allocated(err)) call find_motion_exponents(moved, int(count), exponents, err, interruption)
    ! an interrupted motion has the means up to there
    if (allocated(exponents%exponents)) then
      allocate (found)
      n = size(exponents%exponents)
      allocate (names(3*n + 1))
      do k = 1, n
        write (names(k), '(a,i0)') 'L', k
        names(n + k) = trim(names(k))//'.error'
        names(2*n + k) = trim(names(k))//'.change'
      end do
      names(3*n + 1) = 'divergence'
      call put_texts(names, found%number_names)
      call put_texts([('1/s', k=1, 3*n + 1)], found%number_units)
      if (.not. exponents%knows_divergence) exponents%divergence = ieee_value(1.0_wp, ieee_quiet_nan)
      found%numbers = [exponents%exponents, exponents%errors, exponents%changes, exponents%divergence]
      call put_texts(['t               ', names(:n)], found%names)
      call put_texts(['s  ', ('1/s', k=1, n)], found%units)
      found%count = size(exponents%times)
      allocate (found%rows(n + 1, found%count))
      found%rows(1, :) = exponents%times
      found%rows(2:, :) = exponents%history
      results = show_results(found)
    end if
    code = end_analysis(error, err, moved, dynamics)
  end function find_exponents

  !> Find the equilibrium to which the start leads, or those of many random starts.
  integer(c_int) function find_equilibria(mechanism, starts, stop, results, error) bind(c, name='mech9_equilibrium') result(code)
    type(c_ptr), value, intent(in) :: mechanism   !< the mechanism
    integer(c_int), value, intent(in) :: starts   !< number of random starts; 0: the start of the mechanism alone
    type(c_ptr), value, intent(in) :: stop        !< address of a number that stops the search once it is not 0, or null
    type(c_ptr), intent(out) :: results           !< a row for each equilibrium; null if there are none
    type(c_ptr), value, intent(in) :: error       !< handle of errors, or null
    type(mechanism_type), pointer :: resting
    type(rest_type) :: rest
    type(flag_interruption_type) :: interruption
    type(error_type), allocatable :: err

    call begin_call(error)
    results = c_null_ptr
    call new_interruption(stop, interruption)
    call find_mechanism(mechanism, resting, err)
    if (.not. allocated(err)) call rest%find_equilibria(resting, starts, err, interruption)
    if (has_rows(err)) results = table_of(rest, resting)
    code = end_analysis(error, err, resting, dynamics)
  end function find_equilibria

  !> Whether an answer has rows: it was found, or the search was stopped.
  pure logical function has_rows(err)
    type(error_type), allocatable, intent(in) :: err   !< the failure, if there is one

    has_rows = .not. allocated(err)
    if (allocated(err)) has_rows = err%code == exit_interrupted
  end function has_rows

  !> Find the modes of vibration about the equilibrium to which the start leads.
  integer(c_int) function find_modes(mechanism, results, error) bind(c, name='mech9_modes') result(code)
    type(c_ptr), value, intent(in) :: mechanism   !< the mechanism
    type(c_ptr), intent(out) :: results           !< a row for each mode; null after a failure
    type(c_ptr), value, intent(in) :: error       !< handle of errors, or null
    type(mechanism_type), pointer :: vibrating
    type(rest_type) :: rest
    type(error_type), allocatable :: err

    call begin_call(error)
    results = c_null_ptr
    call find_mechanism(mechanism, vibrating, err)
    if (.not. allocated(err)) call rest%find_modes(vibrating, err)
    if (.not. allocated(err)) results = table_of(rest, vibrating)
    code = end_analysis(error, err, vibrating, dynamics)
  end function find_modes

  !> Results with the rows of equilibria or modes.
  type(c_ptr) function table_of(rest, mechanism)
    type(rest_type), intent(in) :: rest               !< with its rows
    type(mechanism_type), intent(in) :: mechanism     !< the mechanism, for the names of its parts
    type(results_type), pointer :: found
    character(len=:), allocatable :: report

    allocate (found)
    call report_parts(mechanism, report)
    call found%text%put(report)
    call put_texts(rest%names, found%names)
    call put_texts(rest%units, found%units)
    allocate (found%rows, source=rest%rows)
    found%count = size(rest%rows, 2)
    table_of = show_results(found)
  end function table_of

  !> Find the assemblies with the independent coordinates of the start: a row of coordinates for each.
  integer(c_int) function find_assemblies(mechanism, starts, stop, results, error) bind(c, name='mech9_assemblies') result(code)
    type(c_ptr), value, intent(in) :: mechanism   !< the mechanism
    integer(c_int), value, intent(in) :: starts   !< number of random starts
    type(c_ptr), value, intent(in) :: stop        !< address of a number that stops the search once it is not 0, or null
    type(c_ptr), intent(out) :: results           !< the assemblies, that of the mechanism first; null if there are none
    type(c_ptr), value, intent(in) :: error       !< handle of errors, or null
    type(mechanism_type), pointer :: assembled
    type(results_type), pointer :: found
    type(flag_interruption_type) :: interruption
    type(error_type), allocatable :: err, unnamed
    character(len=:), allocatable :: names(:), units(:), report
    real(wp), allocatable :: q(:, :), sizes(:)
    integer :: i

    call begin_call(error)
    results = c_null_ptr
    call find_mechanism(mechanism, assembled, err)
    call new_interruption(stop, interruption)
    if (.not. allocated(err)) call list_assemblies(assembled, starts, q, err, interruption)
    if (has_rows(err)) then
      call name_coordinates(assembled, names, units, sizes, unnamed)
      allocate (found)
      call put_texts(names, found%names)
      call put_texts(units, found%units)
      call report_parts(assembled, report)
      call found%text%put(report)
      allocate (found%rows(size(q, 1), size(q, 2)))
      do i = 1, size(q, 2)
        found%rows(:, i) = q(:, i)/sizes
      end do
      found%count = size(q, 2)
      results = show_results(found)
    end if
    code = end_analysis(error, err, assembled, dynamics)
  end function find_assemblies

  !> Find how far each independent coordinate can go from the start while the others are held there: a row for each, with its number,
  !> its least and its greatest value in the unit of the data file.
  integer(c_int) function find_ranges(mechanism, stop, results, error) bind(c, name='mech9_range') result(code)
    type(c_ptr), value, intent(in) :: mechanism   !< the mechanism
    type(c_ptr), value, intent(in) :: stop        !< address of a number that stops the search once it is not 0, or null
    type(c_ptr), intent(out) :: results           !< the ranges; null after a failure
    type(c_ptr), value, intent(in) :: error       !< handle of errors, or null
    type(mechanism_type), pointer :: assembled
    type(results_type), pointer :: found
    type(flag_interruption_type) :: interruption
    type(error_type), allocatable :: err
    integer, allocatable :: coordinates(:)
    character(len=:), allocatable :: names(:), units(:), report
    character(len=8) :: of_columns(3)
    real(wp), allocatable :: lower(:), upper(:), sizes(:)
    integer :: i

    call begin_call(error)
    results = c_null_ptr
    call find_mechanism(mechanism, assembled, err)
    call new_interruption(stop, interruption)
    if (.not. allocated(err)) call list_ranges(assembled, coordinates, lower, upper, err, interruption, report)
    if (.not. allocated(err)) call name_coordinates(assembled, names, units, sizes, err)
    if (.not. allocated(err)) then
      allocate (found)
      call put_texts([character(len=10) :: 'coordinate', 'lower', 'upper'], found%names)
      ! turning and sliding coordinates have different units, which the report tells
      of_columns = ['1       ', '        ', '        ']
      do i = 1, size(coordinates)
        if (i == 1) of_columns(2:) = units(coordinates(i))
        if (units(coordinates(i)) /= of_columns(2)) of_columns(2:) = ''
      end do
      call put_texts(of_columns, found%units)
      call found%text%put(report)
      allocate (found%rows(3, size(coordinates)))
      found%rows(1, :) = coordinates
      found%rows(2, :) = lower/sizes(coordinates)
      found%rows(3, :) = upper/sizes(coordinates)
      found%count = size(coordinates)
      results = show_results(found)
    end if
    code = end_analysis(error, err, assembled, dynamics)
  end function find_ranges

  !> Find the profile of a cam: a row for each output.
  integer(c_int) function find_profile(mechanism, number, results, error) bind(c, name='mech9_cam') result(code)
    type(c_ptr), value, intent(in) :: mechanism   !< the mechanism
    integer(c_int), value, intent(in) :: number   !< of the cam, from 1
    type(c_ptr), intent(out) :: results           !< the profile; null after a failure
    type(c_ptr), value, intent(in) :: error       !< handle of errors, or null
    type(mechanism_type), pointer :: moved
    type(results_type), pointer :: found
    type(error_type), allocatable :: err
    character(len=:), allocatable :: names(:), units(:), report
    real(wp), allocatable :: rows(:, :)

    call begin_call(error)
    results = c_null_ptr
    call find_mechanism(mechanism, moved, err)
    if (.not. allocated(err)) call find_cam(moved, number, names, units, rows, report, err)
    if (.not. allocated(err)) then
      allocate (found)
      call put_texts(names, found%names)
      call put_texts(units, found%units)
      allocate (found%rows, source=rows)
      found%count = size(rows, 2)
      call found%text%put(report)
      results = show_results(found)
    end if
    code = end_analysis(error, err, moved, kinematics)
  end function find_profile

  !> Make all runs of &study: a row for each, with its number, the values of its parameters, its quantities and its exit code.
  integer(c_int) function make_study(mechanism, with_forces, threads, stop, results, error) bind(c, name='mech9_study') &
    result(code)
    type(c_ptr), value, intent(in) :: mechanism        !< the mechanism
    integer(c_int), value, intent(in) :: with_forces   !< 0: runs of driven motions; else of motions under forces
    integer(c_int), value, intent(in) :: threads       !< how many make the runs
    type(c_ptr), value, intent(in) :: stop             !< address of a number that stops the study once it is not 0, or null
    type(c_ptr), intent(out) :: results                !< the runs, also those before a stop; null after other failures
    type(c_ptr), value, intent(in) :: error            !< handle of errors, or null
    type(mechanism_type), pointer :: varied
    type(study_type), allocatable, target :: study
    type(flag_interruption_type) :: interruption
    type(progress_type), target :: progress
    type(error_type), allocatable :: err

    call begin_call(error)
    results = c_null_ptr
    call find_progress(mechanism, progress)
    call new_interruption(stop, interruption, progress)
    call find_mechanism(mechanism, varied, err)
    if (.not. allocated(err)) then
      allocate (study)
      if (with_forces == 0) then
        call study%make_kinematics(varied, threads, err, interruption)
      else
        call study%make_dynamics(varied, threads, err, interruption)
      end if
      if (has_rows(err)) results = runs_of(study)
    end if
    call end_progress(progress, err)
    code = end_analysis(error, err, varied, merge(kinematics, dynamics, with_forces == 0))
  end function make_study

  !> Results with the runs of a study.
  type(c_ptr) function runs_of(study)
    type(study_type), intent(in) :: study   !< the study
    type(results_type), pointer :: found
    type(c_text_type), allocatable :: parameters(:), quantities(:), ends(:), no_units(:), parameter_units(:), quantity_units(:)
    character(len=:), allocatable :: names(:), units(:)
    real(wp), allocatable :: points(:, :)
    integer :: i, n, m

    n = size(study%parameters, 1)
    m = size(study%quantities, 1)
    allocate (found)
    call put_texts(study%parameter_names, parameters)
    call put_texts(study%quantity_names, quantities)
    call put_texts([character(len=9) :: 'run', 'exit_code'], ends)
    found%names = [ends(1), parameters, quantities, ends(2)]
    call put_texts([character(len=1) :: ' ', ' '], no_units)
    call put_texts(study%parameter_units, parameter_units)
    call put_texts(study%quantity_units, quantity_units)
    found%units = [no_units(1), parameter_units, quantity_units, no_units(2)]
    found%count = size(study%exit_codes)
    allocate (found%rows(n + m + 2, found%count))
    do i = 1, found%count
      found%rows(:, i) = [real(i, wp), study%parameters(:, i), study%quantities(:, i), real(study%exit_codes(i), wp)]
    end do
    call study%section(names, points, units)
    call put_section(names, points, units, found)
    runs_of = show_results(found)
  end function runs_of

  !> Search for the best design: a row for each distinct design, best first, with its value, its parameters, its coordinates at the
  !> start, and the number of starts that led to it. The number made tells how many starts were made.
  integer(c_int) function optimize(mechanism, with_forces, threads, stop, results, error) bind(c, name='mech9_optimize') &
    result(code)
    type(c_ptr), value, intent(in) :: mechanism        !< the mechanism
    integer(c_int), value, intent(in) :: with_forces   !< 0: designs of driven motions; else of motions under forces
    integer(c_int), value, intent(in) :: threads       !< how many make the starts
    type(c_ptr), value, intent(in) :: stop             !< address of a number that stops the search once it is not 0, or null
    type(c_ptr), intent(out) :: results                !< the designs, also those before a stop; null if there are none
    type(c_ptr), value, intent(in) :: error            !< handle of errors, or null
    type(mechanism_type), pointer :: searched
    type(optimum_type) :: optimum
    type(flag_interruption_type) :: interruption
    type(progress_type), target :: progress
    type(error_type), allocatable :: err, unnamed
    character(len=:), allocatable :: names(:), units(:)
    real(wp), allocatable :: sizes(:)
    integer :: program

    call begin_call(error)
    results = c_null_ptr
    program = merge(kinematics, dynamics, with_forces == 0)
    call find_progress(mechanism, progress)
    call new_interruption(stop, interruption, progress)
    call find_mechanism(mechanism, searched, err)
    if (.not. allocated(err)) then
      call optimum%make(searched, program, threads, interruption, err)
      if (size(optimum%values) > 0) then
        call name_coordinates(searched, names, units, sizes, unnamed)
        results = designs_of(optimum, names, units, sizes)
      end if
    end if
    call end_progress(progress, err)
    code = end_analysis(error, err, searched, program)
  end function optimize

  !> Results with the designs of a search.
  type(c_ptr) function designs_of(optimum, names, units, sizes)
    type(optimum_type), intent(in) :: optimum       !< the designs
    character(len=*), intent(in) :: names(:)        !< (M) of the coordinates
    character(len=*), intent(in) :: units(:)        !< (M) of the coordinates
    real(wp), intent(in) :: sizes(:)                !< (M) of these units [rad, m]
    type(results_type), pointer :: found
    type(c_text_type), allocatable :: parameters(:), coordinates(:), others(:), coordinate_units(:), no_units(:), parameter_units(:)
    integer :: i

    allocate (found)
    call put_texts(optimum%parameter_names, parameters)
    call put_texts(names, coordinates)
    call put_texts(units, coordinate_units)
    call put_texts([character(len=6) :: 'value', 'starts'], others)
    call put_texts([character(len=1) :: ' ', ' '], no_units)
    call put_texts(optimum%parameter_units, parameter_units)
    found%names = [others(1), parameters, coordinates, others(2)]
    found%units = [no_units(1), parameter_units, coordinate_units, no_units(2)]
    found%count = size(optimum%values)
    allocate (found%rows(size(found%names), found%count))
    do i = 1, found%count
      found%rows(:, i) = [optimum%values(i), optimum%parameters(:, i), optimum%q(:, i)/sizes, real(optimum%starts(i), wp)]
    end do
    call put_texts(['made'], found%number_names)
    call put_texts(['1'], found%number_units)
    found%numbers = [real(optimum%made, wp)]
    designs_of = show_results(found)
  end function designs_of

  !> Draw the assembled start in a file that ends with .svg.
  integer(c_int) function sketch(mechanism, path, view, error) bind(c, name='mech9_sketch') result(code)
    type(c_ptr), value, intent(in) :: mechanism   !< the mechanism
    type(c_ptr), value, intent(in) :: path        !< of the picture
    type(c_ptr), value, intent(in) :: view        !< as for --view; null or empty: the best one
    type(c_ptr), value, intent(in) :: error       !< handle of errors, or null
    type(mechanism_type), pointer :: drawn
    character(len=:), allocatable :: file, direction
    type(error_type), allocatable :: err

    call begin_call(error)
    call read_c_text(path, file)
    call read_c_text(view, direction)
    call find_mechanism(mechanism, drawn, err)
    if (.not. allocated(err)) call draw_sketch(drawn, file, direction, err)
    code = end_analysis(error, err, drawn, dynamics)
  end function sketch

  !> Make a run over the outputs of &time, and draw it in a file that ends with .html, .svg, .gif or .mp4.
  integer(c_int) function animate(mechanism, with_forces, path, view, stop, error) bind(c, name='mech9_animate') result(code)
    type(c_ptr), value, intent(in) :: mechanism        !< the mechanism
    integer(c_int), value, intent(in) :: with_forces   !< 0: a driven motion; else a motion under forces
    type(c_ptr), value, intent(in) :: path             !< of the picture
    type(c_ptr), value, intent(in) :: view             !< as for --view; null or empty: the best one
    type(c_ptr), value, intent(in) :: stop             !< address of a number that stops the run once it is not 0, or null
    type(c_ptr), value, intent(in) :: error            !< handle of errors, or null
    type(mechanism_type), pointer :: drawn
    type(flag_interruption_type) :: interruption
    character(len=:), allocatable :: file, direction
    type(error_type), allocatable :: err

    call begin_call(error)
    call read_c_text(path, file)
    call read_c_text(view, direction)
    call new_interruption(stop, interruption)
    call find_mechanism(mechanism, drawn, err)
    if (.not. allocated(err)) &
      call draw_film(drawn, merge(kinematics, dynamics, with_forces == 0), file, direction, err, interruption)
    code = end_analysis(error, err, drawn, merge(kinematics, dynamics, with_forces == 0))
  end function animate

  !> End an analysis: tell its failure with all errors of the mechanism.
  integer(c_int) function end_analysis(error, err, mechanism, program) result(code)
    type(c_ptr), intent(in) :: error                        !< address of the caller's error handle, or null
    type(error_type), allocatable, intent(inout) :: err     !< the failure, if there is one
    type(mechanism_type), pointer, intent(in) :: mechanism  !< the mechanism; null where there is none
    integer, intent(in) :: program                          !< kinematics or dynamics
    type(finding_type), allocatable :: findings(:)

    if (allocated(err) .and. associated(mechanism)) then
      if (err%code == exit_data .or. err%code == exit_structure) then
        call mechanism%list_findings(program, findings)
        code = end_call(error, err, mechanism, findings)
      else
        code = end_call(error, err, mechanism)
      end if
    else
      code = end_call(error, err)
    end if
  end function end_analysis
end module mech9_api_analyses
