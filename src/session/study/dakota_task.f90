!> One evaluation for Dakota: a run with the values of its variables, and the quantities that it asks for.
module mech9_dakota_task
  use, intrinsic :: iso_fortran_env, only: error_unit
  use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
  use mech9_program_kind, only: program_names
  use mech9_kinds, only: wp
  use mech9_error, only: error_type, raise, exit_data, exit_singular, exit_interrupted
  use mech9_text, only: string_type, nearest_name
  use mech9_command_line, only: command_line_type
  use mech9_data_file, only: data_file_type
  use mech9_evaluated_design, only: check_quantities, evaluate_design
  use mech9_signal_interruption, only: signal_interruption_type
  use mech9_dakota_file, only: dakota_request_type, read_dakota, write_dakota_failure, write_dakota_results
  implicit none
  private
  public :: work_for_dakota

  !> Bits of the active set vector.
  integer, parameter :: values = 1, gradients = 2, hessians = 4
  !> Letters of a name that are compared when the nearest name is looked for.
  integer, parameter :: longest_name = 64

contains

  !> Make the run that Dakota asks for, and write its quantities. A run that fails is reported to Dakota, and is no
  !> failure of the program. A request that cannot be understood is one, and leaves no results.
  subroutine work_for_dakota(options, given)
    type(command_line_type), intent(in) :: options          !< the command line, with --dakota
    type(data_file_type), intent(inout), target :: given    !< the data file; it gets the errors
    type(string_type), allocatable :: paths(:)
    type(dakota_request_type) :: request
    type(error_type), allocatable :: err
    integer, allocatable :: parameters(:), quantities(:)

    call options%arguments('dakota', paths)
    call check_quantities(given, err)
    if (.not. allocated(err)) call read_dakota(paths(1)%text, request, err)
    if (.not. allocated(err)) call match_names(given, paths(1)%text, request, parameters, quantities, err)
    if (.not. allocated(err)) call evaluate(given, request, parameters, quantities, paths(2)%text, &
                                            options%has('quiet'), err)
    call given%fail(err)
  end subroutine work_for_dakota

  !> Find the parameters and quantities that Dakota means, and refuse what it cannot have.
  subroutine match_names(given, path, request, parameters, quantities, err)
    type(data_file_type), intent(in) :: given               !< the data file
    character(len=*), intent(in) :: path                    !< of the parameters file
    type(dakota_request_type), intent(in) :: request        !< the evaluation
    integer, allocatable, intent(out) :: parameters(:)      !< (variables) number of the parameter of each
    integer, allocatable, intent(out) :: quantities(:)      !< (responses) number of the quantity of each
    type(error_type), allocatable, intent(out) :: err       !< allocated if it failed
    character(len=longest_name) :: of_parameters(size(given%model%parameters)), of_quantities(size(given%model%request%quantities))
    integer :: i

    do i = 1, size(of_parameters)
      of_parameters(i) = given%model%parameters(i)%name
    end do
    do i = 1, size(of_quantities)
      of_quantities(i) = given%model%request%quantities(i)%name
    end do
    call match(request%variables, of_parameters, path, 'variable', '&parameter', parameters, err)
    if (.not. allocated(err)) call match(request%responses, of_quantities, path, 'response', '&quantity', quantities, err)
    if (allocated(err)) return
    if (request%wants(hessians)) then
      call raise(err, exit_data, path//': second derivatives are asked for, and there are none; use no_hessians or '// &
                 'numerical_hessians')
    end if
  end subroutine match_names

  !> Find descriptors among names.
  subroutine match(descriptors, names, path, kind, group, numbers, err)
    type(string_type), intent(in) :: descriptors(:)      !< of Dakota
    character(len=*), intent(in) :: names(:)             !< in the data file
    character(len=*), intent(in) :: path                 !< of the parameters file
    character(len=*), intent(in) :: kind                 !< of the descriptors, for messages
    character(len=*), intent(in) :: group                !< of the names, for messages
    integer, allocatable, intent(out) :: numbers(:)      !< (descriptors) of the names
    type(error_type), allocatable, intent(out) :: err    !< allocated if one is unknown, or stands twice
    character(len=:), allocatable :: nearest, hint
    integer :: i

    allocate (numbers(size(descriptors)), source=0)
    do i = 1, size(descriptors)
      numbers(i) = findloc(names == descriptors(i)%text, .true., dim=1)
      if (numbers(i) == 0) then
        nearest = nearest_name(descriptors(i)%text, names)
        hint = ''
        if (nearest /= '') hint = "; did you mean '"//nearest//"'?"
        call raise(err, exit_data, path//': no '//group//" has the name of the "//kind//" '"//descriptors(i)%text//"'"//hint)
      else if (any(numbers(:i - 1) == numbers(i))) then
        call raise(err, exit_data, path//': the '//kind//" '"//descriptors(i)%text//"' stands there twice")
      end if
      if (allocated(err)) return
    end do
  end subroutine match

  !> Make the run and write its results, or that it failed.
  subroutine evaluate(given, request, parameters, quantities, path, quiet, err)
    type(data_file_type), intent(inout), target :: given    !< the data file
    type(dakota_request_type), intent(in) :: request        !< the evaluation
    integer, intent(in) :: parameters(:)                    !< (variables) number of the parameter of each
    integer, intent(in) :: quantities(:)                    !< (responses) number of the quantity of each
    character(len=*), intent(in) :: path                    !< of the results
    logical, intent(in) :: quiet                            !< a failure is not told
    type(error_type), allocatable, intent(out) :: err       !< allocated if the results cannot be written
    type(error_type), allocatable :: failure
    type(signal_interruption_type), target :: interruption
    real(wp) :: present(size(given%model%parameters)), numbers(size(given%model%request%quantities))
    real(wp) :: gradient(size(given%model%parameters), size(given%model%request%quantities))

    present = given%model%parameters%value
    present(parameters) = request%values
    call interruption%words%start(given%model%program, 'no result yet', 'the run', quiet, with_progress=.false.)
    call evaluate_design(given, present, request%wants(gradients), interruption, numbers, gradient, failure)
    if (.not. allocated(failure)) &
      call check_numbers(request, numbers(quantities), gradient(parameters(request%by), quantities), failure)
    if (allocated(failure)) then
      if (failure%code == exit_interrupted) then
        ! an evaluation that the user ends has no result; Dakota would take a failure for one
        call move_alloc(failure, err)
        return
      end if
      if (.not. quiet) write (error_unit, '(4a)') program_names(given%model%program), ': ', 'the run failed: ', failure%message
      call write_dakota_failure(path, failure%message, err)
    else
      call write_dakota_results(path, request, numbers(quantities), gradient(parameters(request%by), quantities), err)
    end if
  end subroutine evaluate

  !> Fail where a number that Dakota asks for does not exist.
  subroutine check_numbers(request, numbers, gradient, err)
    type(dakota_request_type), intent(in) :: request        !< the evaluation
    real(wp), intent(in) :: numbers(:)                      !< (responses)
    real(wp), intent(in) :: gradient(:, :)                  !< (derivative variables,responses)
    type(error_type), allocatable, intent(out) :: err       !< allocated if one does not exist
    integer :: i

    do i = 1, size(numbers)
      associate (active => request%active(i), name => request%responses(i)%text)
        if (iand(active, values) /= 0 .and. .not. ieee_is_finite(numbers(i))) then
          call raise(err, exit_singular, "quantity '"//name//"' is not a finite number")
        else if (iand(active, gradients) /= 0 .and. .not. all(ieee_is_finite(gradient(:, i)))) then
          call raise(err, exit_singular, "quantity '"//name//"' has no derivative here")
        end if
      end associate
      if (allocated(err)) return
    end do
  end subroutine check_numbers
end module mech9_dakota_task
