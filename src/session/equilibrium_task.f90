!> The work of mech9d for --equilibrium, --modes and --linear: positions of equilibrium and vibrations about them.
module mech9_equilibrium_task
  use, intrinsic :: iso_fortran_env, only: error_unit
  use mech9_error, only: error_type, raise, exit_usage
  use mech9_text, only: to_text
  use mech9_command_line, only: command_line_type
  use mech9_data_file, only: data_file_type
  use mech9_start_way_text, only: print_start_way
  use mech9_heading, only: heading_of
  use mech9_kept_rows, only: kept_rows_type
  use mech9_answer_files, only: save_table
  use mech9_picture_requests, only: picture_requests_type, read_picture_requests
  use mech9_recorded_rest, only: rest_of_file_type
  use mech9_answer_record, only: save_rest, save_linear_rest
  use mech9_answer_report, only: save_rest_report
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
  subroutine find_rest(options, given, reported, kept)
    type(command_line_type), intent(in) :: options          !< the command line
    type(data_file_type), intent(inout) :: given            !< the data file; it gets the errors
    logical, intent(out) :: reported                        !< the report is written
    type(kept_rows_type), intent(inout), optional :: kept   !< gets the rows of the table, too
    class(rest_of_file_type), allocatable :: rest
    type(picture_requests_type) :: pictures
    type(error_type), allocatable :: err, interruption

    reported = .false.
    allocate (rest)
    allocate (rest%equilibria(0))
    if (options%has('animate') .or. options%has('sketch')) call read_picture_requests(options, given, pictures, err)
    if (.not. allocated(err)) call rest%assemble(given%model, err)
    if (.not. (allocated(err) .or. options%has('quiet'))) call print_start_way(error_unit, given%model%mechanism, rest%way)
    if (.not. allocated(err) .and. options%has('verbose')) call print_making(given, rest)
    if (.not. allocated(err)) call search(options, given, rest, err)
    if (rest%stops_by(err) .and. size(rest%equilibria) > 0) call move_alloc(err, interruption)
    if (.not. allocated(err)) then
      if (.not. options%has('quiet')) call print_findings(error_unit, given%model%mechanism, options%number('starts', 0), &
                                                          rest%equilibria, allocated(interruption))
      if (.not. options%has('quiet')) call print_left_out(error_unit, given%model%mechanism)
      if (.not. options%has('modes')) call judge_forces(options, given, rest)
      call write_results(options, given, rest, err, kept)
    end if
    call given%fail(interruption)
    if (.not. allocated(err) .and. options%has('sketch')) call sketch_rest(options, given, pictures, rest, err)
    if (.not. allocated(err) .and. options%has('mode')) call show_mode(options, given, pictures, rest, err)
    call given%fail(err)
    if (.not. options%has('report')) return
    call save_rest_report(options%argument('report'), given, options%table_of_answer(), rest, options%has('modes'), err)
    reported = .not. allocated(err)
    call given%fail(err)
  end subroutine find_rest

  !> Print the structural vectors and the plan.
  subroutine print_making(given, rest)
    type(data_file_type), intent(in) :: given     !< the data file
    type(rest_of_file_type), intent(in) :: rest   !< with its plan

    call print_structure(error_unit, given%model%mechanism%structure, given%model%problem%partition%vectors)
    call print_mobility(error_unit, given%model%mechanism, rest%plan)
    call print_plan_of_results(error_unit, given%model, rest%plan, .true.)
  end subroutine print_making

  !> Find one equilibrium, or those of many starts.
  subroutine search(options, given, rest, err)
    type(command_line_type), intent(in) :: options      !< the command line
    type(data_file_type), intent(in) :: given           !< the data file
    type(rest_of_file_type), intent(inout) :: rest      !< assembled; gets the equilibria
    type(error_type), allocatable, intent(out) :: err   !< allocated if there is none
    integer :: starts

    starts = 0
    if (options%has('starts') .and. options%has('equilibrium')) starts = options%number('starts', 1)
    call rest%find(given%model, starts, .not. options%has('equilibrium'), err, signal_interruption_type())
    if (allocated(err) .and. .not. options%has('quiet')) call print_left_out(error_unit, given%model%mechanism)
    if (allocated(err) .or. .not. options%has('mode')) return
    if (options%number('mode', 1) > rest%equilibria(1)%modes%count) &
      call raise(err, exit_usage, 'there is no mode '//options%argument('mode')//'; the modes are 1 to '// &
                 to_text(rest%equilibria(1)%modes%count))
  end subroutine search

  !> Find which components of the forces in pairs are unique, if any are recorded, and say how many are not.
  subroutine judge_forces(options, given, rest)
    type(command_line_type), intent(in) :: options         !< the command line
    type(data_file_type), intent(in) :: given              !< the data file
    type(rest_of_file_type), intent(inout) :: rest         !< the equilibria, of which the first one is judged

    call rest%judge_forces(given)
    if (options%has('quiet') .or. .not. given%model%request%output%with_forces()) return
    call print_forceless(error_unit, given%model%mechanism)
    if (allocated(rest%forces%unique)) &
      call print_undetermined(error_unit, given%reacting_pairs(), rest%forces%unique, given%model%request%output%reactions_in_links)
  end subroutine judge_forces

  !> Write table, HDF5 file, and file of matrices.
  subroutine write_results(options, given, rest, err, kept)
    type(command_line_type), intent(in) :: options          !< the command line
    type(data_file_type), intent(in) :: given               !< the data file
    type(rest_of_file_type), intent(inout) :: rest          !< the equilibria; the first one has the modes
    type(error_type), allocatable, intent(out) :: err       !< allocated if a file cannot be written
    type(kept_rows_type), intent(inout), optional :: kept   !< gets the rows of the table, too

    call rest%list_rows(given, options%has('modes'), err)
    if (allocated(err)) return
    if (present(kept)) then
      associate (columns => rest%columns)
        call kept%begin(given%model%mechanism%title, columns%names(:columns%count), columns%units(:columns%count), &
                        size(rest%rows, 2))
      end associate
      kept%parts = given%model%mechanism%names
      call kept%take(rest%rows)
    end if
    call save_table(options%table_of_answer(), options, given, heading_of(given%model%mechanism%title, rest%columns), &
                    rest%rows, err)
    if (.not. allocated(err) .and. options%has('hdf5')) &
      call save_rest(options%argument('hdf5'), given, rest, options%has('modes'), err)
    if (.not. allocated(err) .and. options%has('linear')) call save_linear_rest(options%argument('linear'), given, rest, err)
  end subroutine write_results

  !> Draw the position of rest.
  subroutine sketch_rest(options, given, pictures, rest, err)
    type(command_line_type), intent(in) :: options          !< the command line
    type(data_file_type), intent(in) :: given               !< the data file
    type(picture_requests_type), intent(in) :: pictures     !< the sketch
    type(rest_of_file_type), intent(in) :: rest             !< its first equilibrium is drawn
    type(error_type), allocatable, intent(out) :: err       !< allocated if the picture cannot be made

    associate (resting => rest%equilibria(1)%resting)
      call pictures%save_start(given%model, resting%plan, resting%state, err)
    end associate
    if (allocated(err) .or. options%has('quiet')) return
    write (error_unit, '(2a)') 'sketch of the position of rest: ', pictures%sketch
  end subroutine sketch_rest

  !> Draw one mode as a moving picture.
  subroutine show_mode(options, given, pictures, rest, err)
    type(command_line_type), intent(in) :: options          !< the command line
    type(data_file_type), intent(in) :: given               !< the data file
    type(picture_requests_type), intent(in) :: pictures     !< the moving picture
    type(rest_of_file_type), intent(inout) :: rest          !< with the modes of its first equilibrium
    type(error_type), allocatable, intent(out) :: err       !< allocated if the picture cannot be made
    type(picture_requests_type) :: animation

    call rest%take_film(given, options%number('mode', 1), err)
    if (allocated(err)) return
    animation = pictures
    animation%sketch = ''
    call animation%save(given%model, rest%film, err)
    if (.not. allocated(err) .and. .not. options%has('quiet')) call animation%print_words(error_unit)
  end subroutine show_mode
end module mech9_equilibrium_task
