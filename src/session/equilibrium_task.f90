!> The work of mech9d for --equilibrium, --modes and --linear: positions of equilibrium and vibrations about them.
module mech9_equilibrium_task
  use, intrinsic :: iso_fortran_env, only: error_unit
  use mech9_kinds, only: wp, pi
  use mech9_error, only: error_type, raise, exit_usage
  use mech9_text, only: to_text
  use mech9_json, only: json_type
  use mech9_command_line, only: command_line_type
  use mech9_diagnostics, only: diagnostics_type
  use mech9_model, only: model_type
  use mech9_plan, only: plan_type
  use mech9_state, only: state_type
  use mech9_start_way_text, only: print_start_way
  use mech9_linearised_equilibrium, only: equilibrium_type
  use mech9_mode_shapes, only: displacement, position_in_vibration
  use mech9_film, only: film_type, new_film
  use mech9_columns, only: columns_type
  use mech9_table, only: table_type
  use mech9_heading, only: heading_type, heading_of
  use mech9_kept_rows, only: kept_rows_type
  use mech9_hdf5_file, only: hdf5_file_type
  use mech9_structure_layout, only: write_structure, write_coordinates
  use mech9_hdf5_record, only: write_provenance
  use mech9_picture_requests, only: picture_requests_type, read_picture_requests
  use mech9_rest, only: rest_type, is_interruption
  use mech9_equilibrium_rows, only: columns_of_equilibria, rows_of_equilibria, columns_of_modes, rows_of_modes
  use mech9_equilibrium_file, only: put_rows, put_forces, put_energy_shares
  use mech9_linear_file, only: put_linear_system
  use mech9_report_parts, only: begin_report, add_uniqueness
  use mech9_force_record, only: force_record_type, reacting_pairs
  use mech9_equilibrium_words, only: print_findings
  use mech9_friction_text, only: print_left_out
  use mech9_force_text, only: print_undetermined, print_forceless
  use mech9_signal_interruption, only: signal_interruption_type
  use mech9_requested, only: requested_by_results
  use mech9_structure_text, only: print_structure, print_mobility
  use mech9_plan_text, only: print_plan
  use mech9_version, only: version
  implicit none
  private
  public :: asks_for_equilibrium, find_rest, begin_file, end_file

  !> Pictures of one period, and the amplitude of the largest free coordinate in them [rad, lengths of the mechanism].
  integer, parameter :: pictures_of_period = 49
  real(wp), parameter :: shown_amplitude = 0.2_wp

contains

  !> Whether the options ask for an equilibrium in place of a run.
  pure logical function asks_for_equilibrium(options)
    type(command_line_type), intent(in) :: options   !< the command line

    asks_for_equilibrium = options%rest() /= ''
  end function asks_for_equilibrium

  !> Find the equilibria, and write what is asked of them.
  subroutine find_rest(options, model, diagnostics, reported, kept)
    type(command_line_type), intent(in) :: options          !< the command line
    type(model_type), intent(in) :: model                   !< the model
    type(diagnostics_type), intent(inout) :: diagnostics    !< gets the errors
    logical, intent(out) :: reported                        !< the report is written
    type(kept_rows_type), intent(inout), optional :: kept   !< gets the rows of the table, too
    type(rest_type) :: rest
    type(picture_requests_type) :: pictures
    type(force_record_type) :: forces
    type(error_type), allocatable :: err, interruption

    reported = .false.
    allocate (rest%equilibria(0))
    if (options%has('animate') .or. options%has('sketch')) call read_picture_requests(options, model, pictures, err)
    if (.not. allocated(err)) call rest%assemble(model, err)
    if (.not. (allocated(err) .or. options%has('quiet'))) call print_start_way(error_unit, model%mechanism, rest%way)
    if (.not. allocated(err) .and. options%has('verbose')) call print_making(model, rest%plan)
    if (.not. allocated(err)) call search(options, model, rest, err)
    if (is_interruption(err) .and. size(rest%equilibria) > 0) call move_alloc(err, interruption)
    if (.not. allocated(err)) then
      if (.not. options%has('quiet')) call print_findings(error_unit, model%mechanism, options%number('starts', 0), &
                                                          rest%equilibria, allocated(interruption))
      if (.not. options%has('quiet')) call print_left_out(error_unit, model%mechanism)
      if (.not. options%has('modes')) call judge_forces(options, model, rest%equilibria(1), forces)
      call write_results(options, model, rest%equilibria, forces, diagnostics%sources(1)%text, err, kept)
    end if
    if (allocated(interruption)) call diagnostics%add_error(interruption)
    if (.not. allocated(err) .and. options%has('sketch')) call sketch_rest(options, model, pictures, rest%equilibria(1), err)
    if (.not. allocated(err) .and. options%has('mode')) call show_mode(options, model, pictures, rest%equilibria(1), err)
    if (allocated(err)) call diagnostics%add_error(err)
    if (.not. options%has('report')) return
    call save_report(options, model, rest%equilibria, forces, diagnostics, err)
    reported = .not. allocated(err)
    if (allocated(err)) call diagnostics%add_error(err)
  end subroutine find_rest

  !> Print the structural vectors and the plan.
  subroutine print_making(model, plan)
    type(model_type), intent(in) :: model   !< the model
    type(plan_type), intent(in) :: plan     !< its plan

    call print_structure(error_unit, model%mechanism%structure, model%problem%partition%vectors)
    call print_mobility(error_unit, model%mechanism, plan)
    call print_plan(error_unit, model%mechanism, plan, requested_by_results(model%mechanism, model%request%output, .true.))
  end subroutine print_making

  !> Find one equilibrium, or those of many starts.
  subroutine search(options, model, rest, err)
    type(command_line_type), intent(in) :: options      !< the command line
    type(model_type), intent(in) :: model               !< the model
    type(rest_type), intent(inout) :: rest              !< assembled; gets the equilibria
    type(error_type), allocatable, intent(out) :: err   !< allocated if there is none
    integer :: starts

    starts = 0
    if (options%has('starts') .and. options%has('equilibrium')) starts = options%number('starts', 1)
    call rest%find(model, starts, .not. options%has('equilibrium'), err, signal_interruption_type())
    if (allocated(err) .and. .not. options%has('quiet')) call print_left_out(error_unit, model%mechanism)
    if (allocated(err) .or. .not. options%has('mode')) return
    if (options%number('mode', 1) > rest%equilibria(1)%modes%count) &
      call raise(err, exit_usage, 'there is no mode '//options%argument('mode')//'; the modes are 1 to '// &
                 to_text(rest%equilibria(1)%modes%count))
  end subroutine search

  !> Find which components of the forces in pairs are unique, if any are recorded, and say how many are not.
  subroutine judge_forces(options, model, equilibrium, forces)
    type(command_line_type), intent(in) :: options         !< the command line
    type(model_type), intent(in) :: model                  !< the model
    type(equilibrium_type), intent(in) :: equilibrium      !< one equilibrium
    type(force_record_type), intent(inout) :: forces       !< gets the components that are unique

    call forces%judge(model, equilibrium%resting%plan, equilibrium%resting%state)
    if (options%has('quiet') .or. .not. model%request%output%with_forces()) return
    call print_forceless(error_unit, model%mechanism)
    if (allocated(forces%unique)) &
      call print_undetermined(error_unit, reacting_pairs(model), forces%unique, model%request%output%reactions_in_links)
  end subroutine judge_forces

  !> Write table, HDF5 file, and file of matrices.
  subroutine write_results(options, model, list, forces, data_text, err, kept)
    type(command_line_type), intent(in) :: options          !< the command line
    type(model_type), intent(in) :: model                   !< the model
    type(equilibrium_type), intent(inout) :: list(:)        !< the equilibria; the first one has the modes
    type(force_record_type), intent(in) :: forces           !< with the components that are unique
    character(len=*), intent(in) :: data_text               !< text of the data file
    type(error_type), allocatable, intent(out) :: err       !< allocated if a file cannot be written
    type(kept_rows_type), intent(inout), optional :: kept   !< gets the rows of the table, too
    type(columns_type) :: columns
    real(wp), allocatable :: rows(:, :)

    if (options%has('modes')) then
      columns = columns_of_modes(model%mechanism)
      call rows_of_modes(list(1), rows)
    else
      columns = columns_of_equilibria(model)
      call rows_of_equilibria(model, columns, list, rows, err)
    end if
    if (allocated(err)) return
    if (present(kept)) then
      call kept%begin(model%mechanism%title, columns%names(:columns%count), columns%units(:columns%count), size(rows, 2))
      kept%parts = model%mechanism%names
      call kept%take(rows)
    end if
    call write_table(options, model, columns, rows, err)
    if (.not. allocated(err) .and. options%has('hdf5')) &
      call write_hdf5(options, model, list, columns, rows, forces, data_text, err)
    if (.not. allocated(err) .and. options%has('linear')) call write_linear(options, model, list(1), data_text, err)
  end subroutine write_results

  !> Write the table: to the file that is named, or to standard output where no other result is asked for.
  subroutine write_table(options, model, columns, rows, err)
    type(command_line_type), intent(in) :: options      !< the command line
    type(model_type), intent(in) :: model               !< the model
    type(columns_type), intent(in) :: columns           !< names and units
    real(wp), intent(in) :: rows(:, :)                  !< (columns, rows)
    type(error_type), allocatable, intent(out) :: err   !< allocated if the file cannot be written
    type(error_type), allocatable :: at_close
    type(table_type) :: table
    type(heading_type) :: heading
    character(len=:), allocatable :: path

    path = options%table_of_answer()
    if (path == '') return
    heading = heading_of(model%mechanism%title, columns)
    if (options%has('names')) call heading%call_by_names(model%mechanism%names)
    call table%open(path, heading, 'mech9d '//version, err)
    if (allocated(err)) return
    call table%write_rows(rows, err)
    call table%close(at_close)
    if (.not. allocated(err)) call move_alloc(at_close, err)
  end subroutine write_table

  !> Write the rows as an HDF5 file.
  subroutine write_hdf5(options, model, list, columns, rows, forces, data_text, err)
    type(command_line_type), intent(in) :: options      !< the command line
    type(model_type), intent(in) :: model               !< the model
    type(equilibrium_type), intent(in) :: list(:)       !< the equilibria; the first one has the modes
    type(columns_type), intent(in) :: columns           !< names and units
    real(wp), intent(in) :: rows(:, :)                  !< (columns, rows)
    type(force_record_type), intent(in) :: forces       !< with the components that are unique
    character(len=*), intent(in) :: data_text           !< text of the data file
    type(error_type), allocatable, intent(out) :: err   !< allocated if the file cannot be written
    type(hdf5_file_type) :: file

    call begin_file(options%argument('hdf5'), options, model, data_text, file, err)
    if (allocated(err)) return
    if (options%has('modes')) then
      call put_rows(file, columns, rows, 6, size(model%mechanism%pairs), ['_re', '_im'])
      call put_energy_shares(file, list(1))
    else
      call put_rows(file, columns, rows, 2, size(model%mechanism%pairs), [''])
      call put_forces(file, model%mechanism, columns, rows, forces)
    end if
    call end_file(file, err)
  end subroutine write_hdf5

  !> Write the matrices of the linearised equations of motion.
  subroutine write_linear(options, model, equilibrium, data_text, err)
    type(command_line_type), intent(in) :: options          !< the command line
    type(model_type), intent(in) :: model                   !< the model
    type(equilibrium_type), intent(inout) :: equilibrium    !< linearised
    character(len=*), intent(in) :: data_text               !< text of the data file
    type(error_type), allocatable, intent(out) :: err       !< allocated if the file cannot be written
    type(hdf5_file_type) :: file

    call begin_file(options%argument('linear'), options, model, data_text, file, err)
    if (allocated(err)) return
    call put_linear_system(file, model, equilibrium)
    call end_file(file, err)
  end subroutine write_linear

  !> Create an HDF5 file with the origin of its numbers, the structure and the coordinates.
  subroutine begin_file(path, options, model, data_text, file, err)
    character(len=*), intent(in) :: path                !< of the file
    type(command_line_type), intent(in) :: options      !< the command line
    type(model_type), intent(in) :: model               !< the model
    character(len=*), intent(in) :: data_text           !< text of the data file
    type(hdf5_file_type), intent(inout) :: file         !< the open file
    type(error_type), allocatable, intent(out) :: err   !< allocated if the file cannot be written

    call file%create(path, err)
    if (allocated(err)) return
    call write_coordinates(file, model)
    call write_provenance(file, options, model, data_text)
    call write_structure(file, model)
  end subroutine begin_file

  !> Write all to the file and close it.
  subroutine end_file(file, err)
    type(hdf5_file_type), intent(inout) :: file         !< the open file
    type(error_type), allocatable, intent(out) :: err   !< the first failure of the file

    call file%flush()
    call file%close()
    if (allocated(file%failure)) err = file%failure
  end subroutine end_file

  !> Draw the position of rest.
  subroutine sketch_rest(options, model, pictures, equilibrium, err)
    type(command_line_type), intent(in) :: options          !< the command line
    type(model_type), intent(in) :: model                   !< the model
    type(picture_requests_type), intent(in) :: pictures     !< the sketch
    type(equilibrium_type), intent(in) :: equilibrium       !< the position
    type(error_type), allocatable, intent(out) :: err       !< allocated if the picture cannot be made

    call pictures%save_start(model, equilibrium%resting%plan, equilibrium%resting%state, err)
    if (allocated(err) .or. options%has('quiet')) return
    write (error_unit, '(2a)') 'sketch of the position of rest: ', pictures%sketch
  end subroutine sketch_rest

  !> Draw one mode as a moving picture.
  subroutine show_mode(options, model, pictures, equilibrium, err)
    type(command_line_type), intent(in) :: options          !< the command line
    type(model_type), intent(in) :: model                   !< the model
    type(picture_requests_type), intent(in) :: pictures     !< the moving picture
    type(equilibrium_type), intent(in) :: equilibrium       !< with its modes
    type(error_type), allocatable, intent(out) :: err       !< allocated if the picture cannot be made
    type(picture_requests_type) :: animation
    type(film_type) :: film
    type(state_type) :: position
    real(wp) :: phase, period
    integer :: i, mode
    logical :: found

    mode = options%number('mode', 1)
    period = 1.0_wp
    if (abs(aimag(equilibrium%modes%roots(mode))) > 0.0_wp) period = 2.0_wp*pi/abs(aimag(equilibrium%modes%roots(mode)))
    film = new_film(model%mechanism, model%problem%partition%independent(), pictures_of_period)
    do i = 1, pictures_of_period
      phase = 2.0_wp*pi*(i - 1)/(pictures_of_period - 1)
      call position_in_vibration(model%mechanism, equilibrium, displacement(equilibrium, mode, shown_amplitude, phase), position, &
                                 found, err)
      if (allocated(err)) return
      if (.not. found) cycle
      position%t = period*(i - 1)/(pictures_of_period - 1)
      call film%take(model%mechanism, equilibrium%resting%plan, position, [position%t])
    end do
    animation = pictures
    animation%sketch = ''
    call animation%save(model, film, err)
    if (.not. allocated(err) .and. .not. options%has('quiet')) call animation%print_words(error_unit)
  end subroutine show_mode

  !> Write the report as JSON.
  subroutine save_report(options, model, list, forces, diagnostics, err)
    type(command_line_type), intent(in) :: options       !< the command line
    type(model_type), intent(in) :: model                !< the model
    type(equilibrium_type), intent(in) :: list(:)        !< the equilibria; none after an error
    type(force_record_type), intent(in) :: forces        !< with the components that are unique
    type(diagnostics_type), intent(in) :: diagnostics    !< the errors
    type(error_type), allocatable, intent(out) :: err    !< allocated if the file cannot be written
    type(json_type) :: json
    integer :: i

    call begin_report(json, model, diagnostics, options%table_of_answer())
    call json%begin_array('equilibria')
    do i = 1, size(list)
      call json%begin_object()
      call json%add('q', list(i)%resting%state%q/list(i)%resting%plan%result_unit)
      call json%add('stable', list(i)%is_stable)
      call json%add('growth', list(i)%modes%growth)
      call json%add('starts', list(i)%found)
      call json%end_object()
    end do
    call json%end_array()
    if (options%has('modes') .and. size(list) > 0) call add_modes(json, list(1))
    if (allocated(forces%unique)) &
      call add_uniqueness(json, reacting_pairs(model), forces%unique, model%request%output%reactions_in_links)
    call json%end_object()
    call json%save(options%argument('report'), err)
  end subroutine save_report

  !> Add the eigenvalues of the modes.
  subroutine add_modes(json, equilibrium)
    type(json_type), intent(inout) :: json              !< the report, inside its object
    type(equilibrium_type), intent(in) :: equilibrium   !< with its modes
    integer :: i

    call json%begin_array('modes')
    do i = 1, equilibrium%modes%count
      call json%begin_object()
      call json%add('eigenvalue', [real(equilibrium%modes%roots(i), wp), aimag(equilibrium%modes%roots(i))])
      call json%add('frequency', abs(aimag(equilibrium%modes%roots(i)))/(2.0_wp*pi))
      call json%end_object()
    end do
    call json%end_array()
  end subroutine add_modes
end module mech9_equilibrium_task
