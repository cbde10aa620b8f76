!> The parts that the reports of all analyses share, as JSON.
module mech9_report_parts
  use mech9_program_kind, only: program_names
  use mech9_error, only: error_type, place_type
  use mech9_text, only: to_text
  use mech9_uniqueness, only: uniqueness_type, component_names
  use mech9_json, only: json_type
  use mech9_source, only: span_type
  use mech9_diagnostics, only: diagnostics_type
  use mech9_structural_vectors, only: structural_vectors_type
  use mech9_joint_expansion, only: shown_vectors
  use mech9_part_names, only: name_in
  use mech9_model, only: model_type
  use mech9_plan, only: plan_type
  use mech9_version, only: version, revision, compiler
  implicit none
  private
  public :: begin_report, add_structure, add_part_names, add_uniqueness, save_short_report

contains

  !> Write the beginning of a report: the program, the mechanism, the exit code and the errors.
  subroutine begin_report(json, model, diagnostics, table_path)
    type(json_type), intent(inout) :: json             !< the report, which is being composed
    type(model_type), intent(in) :: model              !< the model
    type(diagnostics_type), intent(in) :: diagnostics  !< all errors, which determine the exit code
    character(len=*), intent(in) :: table_path         !< path of the table; '-' is standard output; empty: no table

    call json%begin_object()
    call add_outcome(json, model, diagnostics%code())
    call json%add('table', table_path)
    call json%begin_array('errors')
    call add_errors(json, diagnostics)
    call json%end_array()
  end subroutine begin_report

  !> Write the report of a program that made no run, because of an option such as --check or because of an error.
  subroutine save_short_report(path, model, exit_code, choice, diagnostics, err)
    character(len=*), intent(in) :: path               !< path of the report
    type(model_type), intent(in) :: model              !< the model, as far as it was read
    integer, intent(in) :: exit_code                   !< exit code of the program
    type(diagnostics_type), intent(in) :: choice       !< errors of the choice of the independent coordinates
    type(diagnostics_type), intent(in) :: diagnostics  !< errors of the data file
    type(error_type), allocatable, intent(out) :: err  !< allocated if it failed
    type(json_type) :: json

    call json%begin_object()
    call add_outcome(json, model, exit_code)
    call json%begin_array('errors')
    call add_errors(json, choice)
    call add_errors(json, diagnostics)
    call json%end_array()
    call json%end_object()
    call json%save(path, err)
  end subroutine save_short_report

  !> Add the program with its version, and the exit code.
  subroutine add_outcome(json, model, exit_code)
    type(json_type), intent(inout) :: json         !< the report, which is being composed
    type(model_type), intent(in) :: model          !< the model
    integer, intent(in) :: exit_code               !< exit code of the program

    call json%add('program', program_names(model%program))
    call json%add('version', version)
    call json%add('revision', revision)
    call json%add('compiler', compiler)
    if (allocated(model%mechanism%title)) call json%add('title', model%mechanism%title)
    call json%add('exit_code', exit_code)
  end subroutine add_outcome

  !> Add each error: its message, and its place where it has one.
  subroutine add_errors(json, diagnostics)
    type(json_type), intent(inout) :: json             !< the report, which is being composed
    type(diagnostics_type), intent(in) :: diagnostics  !< gets the errors
    character(len=:), allocatable :: message
    type(span_type) :: span
    type(place_type) :: place
    integer :: i

    do i = 1, diagnostics%known()
      call diagnostics%get(i, message, span)
      call json%begin_object()
      call json%add('message', message)
      if (span%source > 0) then
        associate (source => diagnostics%sources(span%source))
          call json%add('file', source%name)
          if (source%is_file .and. span%first > 0) then
            place = source%place(span%first)
            call json%add('line', place%line)
            call json%add('column', place%column)
          end if
        end associate
      end if
      call json%end_object()
    end do
  end subroutine add_errors

  !> Add the structural vectors and the blocks.
  subroutine add_structure(json, model, plan)
    type(json_type), intent(inout) :: json         !< the report, which is being composed
    type(model_type), intent(in) :: model          !< the model
    type(plan_type), intent(in) :: plan            !< the plan of the mechanism
    type(structural_vectors_type) :: vectors
    integer :: b, i

    vectors = shown_vectors(model%mechanism%structure, model%problem%partition%vectors)
    call json%add('links', model%mechanism%structure%shown_links())
    call json%add('coordinates', plan%n_coordinates)
    call add_integers(json, 'independent', plan%independent)
    call add_integers(json, 'nrg', vectors%nrg)
    call add_integers(json, 'nws', vectors%nws)
    call add_integers(json, 'rdw', vectors%rdw)
    call add_integers(json, 'nrw', vectors%nrw)
    call add_part_names(json, model)
    call json%begin_array('blocks')
    do b = 1, size(plan%blocks)
      associate (block => plan%blocks(b))
        call json%begin_object()
        call add_integers(json, 'unknowns', &
                          [(block%coordinates(i), i=1, size(block%unknowns))])
        call json%add('equations', block%equations)
        call json%add('chains', block%last_closure - block%first_closure + 1)
        call json%end_object()
      end associate
    end do
    call json%end_array()
  end subroutine add_structure

  !> Add the names of links and of coordinates.
  subroutine add_part_names(json, model)
    type(json_type), intent(inout) :: json         !< the report, which is being composed
    type(model_type), intent(in) :: model          !< the model

    call add_names(json, 'link_names', model%mechanism%names%links, model%mechanism%structure%shown_links())
    call add_names(json, 'coordinate_names', model%mechanism%names%coordinates, model%mechanism%structure%n_coordinates)
  end subroutine add_part_names

  !> Add the names of links or coordinates in the order of their numbers, empty for those without one. There is no list where none has any.
  subroutine add_names(json, name, list, number)
    type(json_type), intent(inout) :: json                    !< the report, which is being composed
    character(len=*), intent(in) :: name                      !< of the list in the report
    character(len=*), allocatable, intent(in) :: list(:)      !< names by numbers
    integer, intent(in) :: number                             !< of links or coordinates
    integer :: i

    if (.not. allocated(list)) return
    call json%begin_array(name)
    do i = 1, number
      call json%add(trim(name_in(list, i)))
    end do
    call json%end_array()
  end subroutine add_names

  !> Add the components of the recorded wrenches that equilibrium determines, and the columns that it does not determine:
  !> [{"pair": 1, "unique": ["fx", ...], "undetermined_columns": ["R1.fz", ...]}, ...]
  subroutine add_uniqueness(json, recorded, unique, in_links)
    type(json_type), intent(inout) :: json  !< the report, inside its object
    logical, intent(in) :: recorded(:)      !< (M) pairs whose wrenches are recorded
    type(uniqueness_type), intent(in) :: unique  !< components and forces that it determines
    logical, intent(in) :: in_links         !< columns are along the axes of the moving links; else of link 1
    logical :: shown(6, size(recorded))
    integer :: i, k

    shown = unique%shown(in_links)
    call json%begin_array('reactions')
    do k = 1, size(recorded)
      if (.not. recorded(k)) cycle
      call json%begin_object()
      call json%add('pair', k)
      call json%begin_array('unique')
      do i = 1, 6
        if (unique%pairs(i, k)) call json%add(component_names(i))
      end do
      call json%end_array()
      call json%begin_array('undetermined_columns')
      do i = 1, 6
        if (.not. shown(i, k)) call json%add('R'//to_text(k)//'.'//component_names(i))
      end do
      call json%end_array()
      call json%end_object()
    end do
    call json%end_array()
    if (size(unique%couplings) == 0) return
    call json%begin_array('couplings')
    do k = 1, size(unique%couplings)
      call json%begin_object()
      call json%add('coupling', k)
      call json%add('unique', unique%couplings(k))
      call json%end_object()
    end do
    call json%end_array()
  end subroutine add_uniqueness

  !> Add an array of whole numbers.
  subroutine add_integers(json, name, numbers)
    type(json_type), intent(inout) :: json  !< the report, which is being composed
    character(len=*), intent(in) :: name    !< name of the list in the report
    integer, intent(in) :: numbers(:)       !< the numbers of the list
    integer :: i

    call json%begin_array(name)
    do i = 1, size(numbers)
      call json%add(numbers(i))
    end do
    call json%end_array()
  end subroutine add_integers
end module mech9_report_parts
