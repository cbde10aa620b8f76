!> Answers about the structure of a mechanism for the library's users: its mobility, its assemblies, and how far it can move.
module mech9_structure_answers
  use, intrinsic :: ieee_arithmetic, only: ieee_value, ieee_positive_inf
  use mech9_program_kind, only: dynamics
  use mech9_kinds, only: wp
  use mech9_error, only: error_type, raise, exit_interrupted
  use mech9_text, only: string_type, texts_of_one_length, to_text
  use mech9_part_names, only: name_in
  use mech9_model, only: model_type
  use mech9_result_units, only: unit_of, unit_name
  use mech9_plan, only: plan_type
  use mech9_state, only: state_type
  use mech9_simulation, only: interruption_type
  use mech9_explained_assembly, only: assemble_model
  use mech9_start_path, only: start_way_type
  use mech9_structure_text, only: print_mobility_report
  use mech9_range_text, only: put_limits_in_words
  use mech9_json, only: json_type
  use mech9_report_parts, only: add_part_names
  use mech9_check_text, only: print_given, print_start
  use mech9_printed_text, only: begin_text, end_text
  use mech9_mobility_report, only: mobility_report_type, report_mobility
  use mech9_assemblies, only: assembly_list_type, find_assemblies
  use mech9_motion_range, only: motion_range_type, end_type, find_range, ends_never, ends_round
  use mech9_checked_mechanism, only: checked_mechanism_type
  implicit none
  private
  public :: judge_mobility, list_assemblies, list_ranges, name_coordinates, report_parts

contains

  !> Find the mobility of a mechanism and its redundant equations. Fails with exit_structure or exit_assembly where the mechanism
  !> cannot be put together, and, where the text is asked for, with exit_file.
  subroutine judge_mobility(mechanism, mobility, redundant, err, text)
    type(checked_mechanism_type), intent(in) :: mechanism                !< the mechanism
    integer, intent(out) :: mobility                                     !< coordinates less rank, in a general position; 0 after a failure
    integer, intent(out) :: redundant                                    !< equations of all chains that follow from others
    type(error_type), allocatable, intent(out) :: err                    !< allocated if it failed
    character(len=:), allocatable, intent(out), optional :: text         !< the text of mech9d --check
    type(model_type) :: model
    type(plan_type) :: plan
    type(state_type) :: start
    type(start_way_type) :: way
    type(mobility_report_type) :: report
    integer :: unit

    mobility = 0
    redundant = 0
    call assemble(mechanism, model, plan, start, err, way)
    if (allocated(err)) return
    call report_mobility(model%mechanism, plan, start, report)
    mobility = report%by_rank
    redundant = sum(report%redundant)
    if (.not. present(text)) return
    call begin_text(unit, err)
    if (allocated(err)) return
    call print_mobility_report(unit, model%mechanism, plan, report)
    call print_given(unit, model, .true.)
    call print_start(unit, model, plan, start, way)
    call end_text(unit, text)
  end subroutine judge_mobility

  !> Find the assemblies with the independent coordinates of the start, from random starts. The first one is that of the mechanism.
  !> Fails as judge_mobility does.
  subroutine list_assemblies(mechanism, starts, q, err, interruption)
    type(checked_mechanism_type), intent(in) :: mechanism      !< the mechanism
    integer, intent(in) :: starts                              !< number of random starts
    real(wp), allocatable, intent(out) :: q(:, :)              !< (M,assemblies) coordinates [rad, m]
    type(error_type), allocatable, intent(out) :: err          !< allocated if it failed
    class(interruption_type), intent(in), optional :: interruption   !< is asked whether the search shall stop
    type(model_type) :: model
    type(plan_type) :: plan
    type(state_type) :: start
    type(assembly_list_type) :: list

    call assemble(mechanism, model, plan, start, err)
    if (.not. allocated(err)) then
      call find_assemblies(model%mechanism, plan, start, starts, list, interruption)
      call fail_if_stopped(interruption, err)
      q = list%q(:, :size(list%found))
    else
      allocate (q(0, 0))
    end if
  end subroutine list_assemblies

  !> Find how far each independent coordinate can go from the start while the others are held there. Fails as judge_mobility does.
  subroutine list_ranges(mechanism, coordinates, lower, upper, err, interruption, report)
    type(checked_mechanism_type), intent(in) :: mechanism      !< the mechanism
    integer, allocatable, intent(out) :: coordinates(:)        !< (independent) their numbers
    real(wp), allocatable, intent(out) :: lower(:)             !< (independent) least values [rad, m]; -infinite: there is none
    real(wp), allocatable, intent(out) :: upper(:)             !< (independent) greatest values [rad, m]; infinite: none
    type(error_type), allocatable, intent(out) :: err          !< allocated if it failed
    class(interruption_type), intent(in), optional :: interruption   !< is asked whether the search shall stop
    character(len=:), allocatable, intent(out), optional :: report   !< names of links and coordinates, and what limits each range, as JSON
    type(model_type) :: model
    type(plan_type) :: plan
    type(state_type) :: start
    type(motion_range_type) :: range
    type(json_type) :: json
    character(len=:), allocatable :: limits
    integer :: i

    call assemble(mechanism, model, plan, start, err)
    if (allocated(err)) then
      allocate (coordinates(0), lower(0), upper(0))
      return
    end if
    coordinates = plan%independent
    allocate (lower(size(coordinates)), upper(size(coordinates)))
    call json%begin_object()
    call add_part_names(json, model)
    call json%begin_array('ranges')
    do i = 1, size(coordinates)
      call find_range(plan, start, coordinates(i), range, interruption)
      call fail_if_stopped(interruption, err)
      if (allocated(err)) return
      lower(i) = end_of(range%lower, -1.0_wp)
      upper(i) = end_of(range%upper, 1.0_wp)
      call json%begin_object()
      call json%add('coordinate', coordinates(i))
      call json%add('name', trim(name_in(model%mechanism%names%coordinates, coordinates(i))))
      call json%add('unit', trim(unit_name(model%mechanism, coordinates(i))))
      call put_limits_in_words(model, plan, coordinates(i), range, limits)
      call json%add('limited_by', limits)
      call json%end_object()
    end do
    call json%end_array()
    call json%end_object()
    if (present(report)) call json%take_text(report)
  end subroutine list_ranges

  !> Fail with exit_interrupted where a search was to stop.
  subroutine fail_if_stopped(interruption, err)
    class(interruption_type), intent(in), optional :: interruption   !< of the search, if it has one
    type(error_type), allocatable, intent(out) :: err                !< allocated if it was to stop

    if (.not. present(interruption)) return
    if (interruption%is_wanted()) call raise(err, exit_interrupted, 'interrupted before the answer was found')
  end subroutine fail_if_stopped

  !> Find the names of the coordinates and their units in the data file. Fails with exit_data or exit_structure.
  subroutine name_coordinates(mechanism, names, units, sizes, err)
    type(checked_mechanism_type), intent(in) :: mechanism               !< the mechanism
    character(len=:), allocatable, intent(out) :: names(:)              !< (M) q1, q2
    character(len=:), allocatable, intent(out) :: units(:)              !< (M) rad, deg or m
    real(wp), allocatable, intent(out) :: sizes(:)                      !< (M) of these units [rad, m]
    type(error_type), allocatable, intent(out) :: err                   !< allocated if it failed
    type(model_type) :: model
    type(string_type), allocatable :: texts(:), of_units(:)
    integer :: k, n

    call mechanism%take_request(dynamics, model, err)
    n = 0
    if (.not. allocated(err)) n = size(model%mechanism%pairs)
    allocate (texts(n), of_units(n), sizes(n))
    do k = 1, n
      texts(k)%text = 'q'//to_text(k)
      of_units(k)%text = trim(unit_name(model%mechanism, k))
      sizes(k) = unit_of(model%mechanism, k)
    end do
    call texts_of_one_length(texts, names)
    call texts_of_one_length(of_units, units)
  end subroutine name_coordinates

  !> Compose the report of an analysis that has no other one: names of links and coordinates, as JSON. There is none where the request
  !> of the mechanism cannot be taken.
  subroutine report_parts(mechanism, report)
    type(checked_mechanism_type), intent(in) :: mechanism        !< the mechanism
    character(len=:), allocatable, intent(out) :: report         !< the report; empty: none
    type(model_type) :: model
    type(json_type) :: json
    type(error_type), allocatable :: err

    report = ''
    call mechanism%take_request(dynamics, model, err)
    if (allocated(err)) return
    call json%begin_object()
    call add_part_names(json, model)
    call json%end_object()
    call json%take_text(report)
  end subroutine report_parts

  !> The value of an end; infinite where there is none.
  pure real(wp) function end_of(found, direction)
    type(end_type), intent(in) :: found       !< one end of a range
    real(wp), intent(in) :: direction         !< 1 for the upper end, -1 for the lower one

    end_of = found%value
    if (any(found%kind == [ends_never, ends_round])) end_of = direction*ieee_value(1.0_wp, ieee_positive_inf)
  end function end_of

  !> Find the plan and the closed position of a mechanism at its start. Drives need not be there.
  subroutine assemble(mechanism, model, plan, start, err, way)
    type(checked_mechanism_type), intent(in) :: mechanism      !< the mechanism
    type(model_type), intent(out) :: model                     !< of the mechanism
    type(plan_type), intent(out) :: plan                       !< its plan
    type(state_type), intent(out) :: start                     !< the closed position
    type(error_type), allocatable, intent(out) :: err          !< allocated if it failed
    type(start_way_type), intent(out), optional :: way         !< how the start was reached from the drawn position

    call mechanism%take_standing(model, err)
    if (.not. allocated(err)) call assemble_model(model, plan, start, err, way)
    call mechanism%point_at(err)
  end subroutine assemble
end module mech9_structure_answers
