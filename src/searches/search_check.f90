!> The judgement before a search whether it can be made: by its methods, its quantities, its limits.
module mech9_search_check
  use mech9_program_kind, only: dynamics
  use mech9_kinds, only: wp
  use mech9_text, only: to_text
  use mech9_error, only: error_type, raise, exit_data
  use mech9_model, only: model_type
  use mech9_variable_model, only: variable_model_type
  use mech9_state, only: state_type
  use mech9_model_motion, only: model_motion_type
  use mech9_objective, only: quantity_objective, quantity_limit, transmission_limit, timing_over
  use mech9_result_units, only: unit_of
  use mech9_targets, only: time_at
  use mech9_limited_minimum, only: has_limited_minimum
  use mech9_quantity_record, only: quantity_record_type
  use mech9_design_run, only: find_quantities
  use mech9_synthesis, only: synthesis_type
  use mech9_closed_search, only: is_least_squares
  use mech9_transmission, only: has_transmission_angle
  use mech9_simulation, only: interruption_type
  use mech9_run_evaluator, only: new_run_evaluator, used_quantities
  implicit none
  private
  public :: check_synthesis

contains

  !> Report what no search can find, and prepare the runs for quantities.
  subroutine check_synthesis(variable, model, start, interruption, synthesis, err)
    class(variable_model_type), intent(in) :: variable      !< the model as a function of its parameters
    type(model_type), intent(in) :: model                   !< the model with the values of the data file
    type(state_type), intent(in) :: start                   !< its assembled position
    class(interruption_type), intent(in) :: interruption    !< is asked whether a run for quantities shall stop
    type(synthesis_type), intent(inout) :: synthesis        !< gets the runs
    type(error_type), allocatable, intent(out) :: err       !< allocated if no search can be made
    type(quantity_record_type) :: quantities
    type(model_type) :: asked

    if (model%program == dynamics) call check_forced(model, err)
    if (model%program == dynamics .and. .not. allocated(err)) call check_start(model, err)
    if (.not. allocated(err)) call check_method(model, err)
    if (.not. allocated(err)) call check_driven_values(model, synthesis, err)
    if (.not. allocated(err)) call check_transmissions(model, synthesis, start, err)
    if (allocated(err) .or. size(used_quantities(model)) == 0) return
    asked = model
    asked%request%quantities = model%request%quantities(used_quantities(model))
    call find_quantities(asked, quantities, err)
    if (allocated(err)) return
    allocate (synthesis%space%evaluator)
    call new_run_evaluator(variable, model, interruption, synthesis%space%evaluator)
  end subroutine check_synthesis

  !> Report objectives and limits that are about motions which drives alone determine.
  subroutine check_forced(model, err)
    type(model_type), intent(in) :: model                 !< the model
    type(error_type), allocatable, intent(out) :: err     !< allocated if there is one
    integer :: i

    do i = 1, size(model%request%objectives)
      if (model%request%objectives(i)%kind == quantity_objective) cycle
      call raise(err, exit_data, 'mech9d searches by quantities of its runs; give an &objective of kind ''quantity'', or '// &
                 'search with mech9k, in which drives determine the motion', model%request%objectives(i)%place)
      return
    end do
    do i = 1, size(model%request%limits)
      if (model%request%limits(i)%kind == quantity_limit) cycle
      call raise(err, exit_data, 'mech9d keeps limits of quantities of its runs; give a &limit of kind ''quantity'', or '// &
                 'search with mech9k, in which drives determine the motion', model%request%limits(i)%place)
      return
    end do
  end subroutine check_forced

  !> Report a motion under forces that cannot begin as the data file is written.
  subroutine check_start(model, err)
    type(model_type), intent(in) :: model                 !< the model with the values of the data file
    type(error_type), allocatable, intent(out) :: err     !< allocated if it cannot
    class(model_type), allocatable, target :: moving
    type(model_motion_type) :: motion

    if (model%is_driven()) return
    allocate (moving, source=model)
    call motion%assemble(moving, err)
    if (.not. allocated(err)) call motion%prepare(moving, err)
    call motion%close()
  end subroutine check_start

  !> Report a method that cannot find what is asked for, or that this build does not have.
  subroutine check_method(model, err)
    type(model_type), intent(in) :: model                 !< the model
    type(error_type), allocatable, intent(out) :: err     !< allocated if there is none

    associate (optimum => model%request%optimum)
      if (optimum%method == 'levenberg-marquardt' .and. .not. is_least_squares(model)) then
        call raise(err, exit_data, 'levenberg-marquardt finds the least sum of squares only, without limits but of kind '// &
                   '''assembles'', and without quantities that should be least or largest; leave ''method'' out', &
                   optimum%place)
      else if (.not. has_limited_minimum .and. (.not. is_least_squares(model) .or. &
               all(optimum%method /= [character(len=20) :: 'auto', 'levenberg-marquardt']))) then
        call raise(err, exit_data, 'this program was built without NLopt, the library that keeps limits and finds what is '// &
                   'not a sum of squares; install it (Debian: libnlopt-dev) and build the program again', &
                   model%request%objectives(1)%place)
      end if
    end associate
  end subroutine check_method

  !> Report values of a driven coordinate that no time of the run has, where no varied parameter changes the drive.
  subroutine check_driven_values(model, synthesis, err)
    type(model_type), intent(in) :: model                 !< the model
    type(synthesis_type), intent(in) :: synthesis         !< its designs and targets
    type(error_type), allocatable, intent(out) :: err     !< allocated if there is such a value
    real(wp) :: t
    logical :: found
    integer :: i

    associate (time => model%request%time, targets => synthesis%targets)
      do i = 1, size(targets)
        if (targets(i)%timing /= timing_over .or. synthesis%space%moves_drives()) cycle
        call time_at(model%problem%drives, targets(i)%over, targets(i)%at, min(time%start, time%end), max(time%start, time%end), &
                     t, found)
        if (found) cycle
        call raise(err, exit_data, 'the run never brings q'//to_text(targets(i)%over)//' to '// &
                   to_text(targets(i)%at/unit_of(model%mechanism, targets(i)%over), 8)//', where a target of this objective is'// &
                   '; change &time or the drive', model%request%objectives(targets(i)%objective)%place)
        return
      end do
    end associate
  end subroutine check_driven_values

  !> Report transmission angles that do not exist.
  subroutine check_transmissions(model, synthesis, start, err)
    type(model_type), intent(in) :: model                 !< the model
    type(synthesis_type), intent(in) :: synthesis         !< its designs
    type(state_type), intent(in) :: start                 !< the assembled position
    type(error_type), allocatable, intent(out) :: err     !< allocated if one does not
    integer :: i

    do i = 1, size(model%request%limits)
      associate (limit => model%request%limits(i))
        if (limit%kind /= transmission_limit) cycle
        if (has_transmission_angle(synthesis%space, start%q, limit%coordinate)) cycle
        call raise(err, exit_data, 'there is no transmission angle at q'//to_text(limit%coordinate)//': it is measured at a '// &
                   'turning pair, in a plane chain that gives three coordinates, of which at most one is a slide', limit%place)
        return
      end associate
    end do
  end subroutine check_transmissions
end module mech9_search_check
