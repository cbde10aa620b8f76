!> The work of mech9d for --equilibrium, --modes and --linear: positions of equilibrium and vibrations about them.
module mech9_equilibrium_task
  use, intrinsic :: iso_fortran_env, only: error_unit
  use mech9_kinds, only: wp
  use mech9_error, only: error_type, raise, exit_usage
  use mech9_text, only: to_text
  use mech9_json, only: json_type
  use mech9_command_line, only: command_line_type
  use mech9_diagnostics, only: diagnostics_type
  use mech9_model, only: model_type
  use mech9_start_way_text, only: print_start_way
  use mech9_film, only: film_type
  use mech9_columns, only: columns_type
  use mech9_heading, only: heading_of
  use mech9_kept_rows, only: kept_rows_type
  use mech9_hdf5_file, only: hdf5_file_type
  use mech9_answer_files, only: save_table, begin_file, end_file
  use mech9_picture_requests, only: picture_requests_type, read_picture_requests
  use mech9_rest, only: rest_type, is_interruption
  use mech9_equilibrium_rows, only: columns_of_equilibria, rows_of_equilibria, columns_of_modes, rows_of_modes
  use mech9_equilibrium_layout, only: put_rows, put_forces, put_energy_shares
  use mech9_linear_layout, only: put_linear_system
  use mech9_report_parts, only: begin_report, add_uniqueness
  use mech9_equilibria_report, only: add_equilibria
  use mech9_force_record, only: force_record_type, reacting_pairs
  use mech9_equilibrium_words, only: print_findings
  use mech9_friction_text, only: print_left_out
  use mech9_force_text, only: print_undetermined, print_forceless
  use mech9_signal_interruption, only: signal_interruption_type
  use mech9_structure_text, only: print_structure, print_mobility
  use mech9_plan_text, only: print_plan_of_results
  implicit none
  private
  public :: find_rest

contains

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
    if (.not. allocated(err) .and. options%has('verbose')) call print_making(model, rest)
    if (.not. allocated(err)) call search(options, model, rest, err)
    if (is_interruption(err) .and. size(rest%equilibria) > 0) call move_alloc(err, interruption)
    if (.not. allocated(err)) then
      if (.not. options%has('quiet')) call print_findings(error_unit, model%mechanism, options%number('starts', 0), &
                                                          rest%equilibria, allocated(interruption))
      if (.not. options%has('quiet')) call print_left_out(error_unit, model%mechanism)
      if (.not. options%has('modes')) call judge_forces(options, model, rest, forces)
      call write_results(options, model, rest, forces, diagnostics%sources(1)%text, err, kept)
    end if
    if (allocated(interruption)) call diagnostics%add_error(interruption)
    if (.not. allocated(err) .and. options%has('sketch')) call sketch_rest(options, model, pictures, rest, err)
    if (.not. allocated(err) .and. options%has('mode')) call show_mode(options, model, pictures, rest, err)
    if (allocated(err)) call diagnostics%add_error(err)
    if (.not. options%has('report')) return
    call save_report(options, model, rest, forces, diagnostics, err)
    reported = .not. allocated(err)
    if (allocated(err)) call diagnostics%add_error(err)
  end subroutine find_rest

  !> Print the structural vectors and the plan.
  subroutine print_making(model, rest)
    type(model_type), intent(in) :: model   !< the model
    type(rest_type), intent(in) :: rest     !< with its plan

    call print_structure(error_unit, model%mechanism%structure, model%problem%partition%vectors)
    call print_mobility(error_unit, model%mechanism, rest%plan)
    call print_plan_of_results(error_unit, model, rest%plan, .true.)
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
  subroutine judge_forces(options, model, rest, forces)
    type(command_line_type), intent(in) :: options         !< the command line
    type(model_type), intent(in) :: model                  !< the model
    type(rest_type), intent(in) :: rest                    !< the equilibria, of which the first one is judged
    type(force_record_type), intent(inout) :: forces       !< gets the components that are unique

    associate (resting => rest%equilibria(1)%resting)
      call forces%judge(model, resting%plan, resting%state)
    end associate
    if (options%has('quiet') .or. .not. model%request%output%with_forces()) return
    call print_forceless(error_unit, model%mechanism)
    if (allocated(forces%unique)) &
      call print_undetermined(error_unit, reacting_pairs(model), forces%unique, model%request%output%reactions_in_links)
  end subroutine judge_forces

  !> Write table, HDF5 file, and file of matrices.
  subroutine write_results(options, model, rest, forces, data_text, err, kept)
    type(command_line_type), intent(in) :: options          !< the command line
    type(model_type), intent(in) :: model                   !< the model
    type(rest_type), intent(inout) :: rest                  !< the equilibria; the first one has the modes
    type(force_record_type), intent(in) :: forces           !< with the components that are unique
    character(len=*), intent(in) :: data_text               !< text of the data file
    type(error_type), allocatable, intent(out) :: err       !< allocated if a file cannot be written
    type(kept_rows_type), intent(inout), optional :: kept   !< gets the rows of the table, too
    type(columns_type) :: columns
    real(wp), allocatable :: rows(:, :)

    if (options%has('modes')) then
      columns = columns_of_modes(model%mechanism)
      call rows_of_modes(rest%equilibria(1), rows)
    else
      columns = columns_of_equilibria(model)
      call rows_of_equilibria(model, columns, rest%equilibria, rows, err)
    end if
    if (allocated(err)) return
    if (present(kept)) then
      call kept%begin(model%mechanism%title, columns%names(:columns%count), columns%units(:columns%count), size(rows, 2))
      kept%parts = model%mechanism%names
      call kept%take(rows)
    end if
    call save_table(options%table_of_answer(), options, model, heading_of(model%mechanism%title, columns), rows, err)
    if (.not. allocated(err) .and. options%has('hdf5')) &
      call write_hdf5(options, model, rest, columns, rows, forces, data_text, err)
    if (.not. allocated(err) .and. options%has('linear')) call write_linear(options, model, rest, data_text, err)
  end subroutine write_results

  !> Write the rows as an HDF5 file.
  subroutine write_hdf5(options, model, rest, columns, rows, forces, data_text, err)
    type(command_line_type), intent(in) :: options      !< the command line
    type(model_type), intent(in) :: model               !< the model
    type(rest_type), intent(in) :: rest                 !< the equilibria; the first one has the modes
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
      call put_energy_shares(file, rest%equilibria(1))
    else
      call put_rows(file, columns, rows, 2, size(model%mechanism%pairs), [''])
      call put_forces(file, model%mechanism, columns, rows, forces)
    end if
    call end_file(file, err)
  end subroutine write_hdf5

  !> Write the matrices of the linearised equations of motion.
  subroutine write_linear(options, model, rest, data_text, err)
    type(command_line_type), intent(in) :: options          !< the command line
    type(model_type), intent(in) :: model                   !< the model
    type(rest_type), intent(inout) :: rest                  !< its first equilibrium is linearised
    character(len=*), intent(in) :: data_text               !< text of the data file
    type(error_type), allocatable, intent(out) :: err       !< allocated if the file cannot be written
    type(hdf5_file_type) :: file

    call begin_file(options%argument('linear'), options, model, data_text, file, err)
    if (allocated(err)) return
    call put_linear_system(file, model, rest%equilibria(1))
    call end_file(file, err)
  end subroutine write_linear

  !> Draw the position of rest.
  subroutine sketch_rest(options, model, pictures, rest, err)
    type(command_line_type), intent(in) :: options          !< the command line
    type(model_type), intent(in) :: model                   !< the model
    type(picture_requests_type), intent(in) :: pictures     !< the sketch
    type(rest_type), intent(in) :: rest                     !< its first equilibrium is drawn
    type(error_type), allocatable, intent(out) :: err       !< allocated if the picture cannot be made

    associate (resting => rest%equilibria(1)%resting)
      call pictures%save_start(model, resting%plan, resting%state, err)
    end associate
    if (allocated(err) .or. options%has('quiet')) return
    write (error_unit, '(2a)') 'sketch of the position of rest: ', pictures%sketch
  end subroutine sketch_rest

  !> Draw one mode as a moving picture.
  subroutine show_mode(options, model, pictures, rest, err)
    type(command_line_type), intent(in) :: options          !< the command line
    type(model_type), intent(in) :: model                   !< the model
    type(picture_requests_type), intent(in) :: pictures     !< the moving picture
    type(rest_type), intent(in) :: rest                     !< with the modes of its first equilibrium
    type(error_type), allocatable, intent(out) :: err       !< allocated if the picture cannot be made
    type(picture_requests_type) :: animation
    type(film_type) :: film

    call rest%film_mode(model, options%number('mode', 1), film, err)
    if (allocated(err)) return
    animation = pictures
    animation%sketch = ''
    call animation%save(model, film, err)
    if (.not. allocated(err) .and. .not. options%has('quiet')) call animation%print_words(error_unit)
  end subroutine show_mode

  !> Write the report as JSON.
  subroutine save_report(options, model, rest, forces, diagnostics, err)
    type(command_line_type), intent(in) :: options       !< the command line
    type(model_type), intent(in) :: model                !< the model
    type(rest_type), intent(in) :: rest                  !< the equilibria; none after an error
    type(force_record_type), intent(in) :: forces        !< with the components that are unique
    type(diagnostics_type), intent(in) :: diagnostics    !< the errors
    type(error_type), allocatable, intent(out) :: err    !< allocated if the file cannot be written
    type(json_type) :: json

    call begin_report(json, model, diagnostics, options%table_of_answer())
    call add_equilibria(json, rest, options%has('modes'))
    if (allocated(forces%unique)) &
      call add_uniqueness(json, reacting_pairs(model), forces%unique, model%request%output%reactions_in_links)
    call json%end_object()
    call json%save(options%argument('report'), err)
  end subroutine save_report
end module mech9_equilibrium_task
