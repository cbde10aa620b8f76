!> Branches of positions and of periodic motions of a model over one of its parameters: what --branch finds.
module mech9_branches
  use, intrinsic :: ieee_arithmetic, only: ieee_value, ieee_quiet_nan
  use mech9_kinds, only: wp
  use mech9_error, only: error_type, raise, add_place, exit_usage, exit_data, exit_singular, exit_interrupted
  use mech9_text, only: to_text
  use mech9_parameter, only: parameter_type
  use mech9_long_term, only: branch_request_type
  use mech9_partition, only: free_coordinate, driven_coordinate
  use mech9_model, only: model_type
  use mech9_variable_model, only: variable_model_type
  use mech9_plan, only: plan_type
  use mech9_state, only: state_type
  use mech9_planning, only: planning_settings_type, make_plan
  use mech9_simulation, only: interruption_type
  use mech9_result_units, only: si_unit, unit_of_parameter
  use mech9_columns, only: columns_type
  use mech9_explained_assembly, only: assemble_model
  use mech9_rest, only: rest_type
  use mech9_curve, only: curve_type, curve_point_type
  use mech9_curve_step, only: first_direction
  use mech9_curve_branch, only: curve_branch_type, curve_settings_type, ends_stopped
  use mech9_curve_branches, only: find_curve_branches => find_branches
  use mech9_single_parameter, only: single_parameter_type, new_single_parameter
  use mech9_position_curve, only: position_curve_type, new_position_curve, begin_curve
  use mech9_periodic_motion, only: periodic_motion_type, belongs_to_family
  use mech9_periodic, only: periodic_found_type, find_periodic
  use mech9_law_periods, only: law_period_type, find_law_period
  use mech9_periodic_curve, only: periodic_curve_type, begin_periodic_curve
  implicit none
  private
  public :: branches_found_type, find_branches, columns_of_branches, first_request, begin_at_rest, refuse_family

  !> The branches of one or more groups &branch over the same parameter.
  type :: branches_found_type
    type(columns_type) :: columns                          !< of the table
    real(wp), allocatable :: rows(:, :)                    !< (columns, points) in the units of the results; not allocated after a
                                                           !< failure before the first branch
    logical, allocatable :: stable(:)                      !< (points) no small deviation grows
    type(curve_branch_type), allocatable :: branches(:)    !< in the order of the table
    integer, allocatable :: groups(:)                      !< (branches) number of the group among those of this parameter
    real(wp), allocatable :: low(:), high(:)               !< (groups) range of the parameter, in the units of the data file
    character(len=11), allocatable :: of(:)                !< (groups) equilibrium, position or periodic
    integer :: growth = 0, period = 0                      !< numbers of these columns; 0: the table has none
    integer :: left_out = 0                                !< branch points from which no branch was followed: they are not simple
    integer :: not_doubled = 0                             !< period doublings from which no branch was followed
    character(len=:), allocatable :: parameter             !< name of the parameter
  contains
    procedure :: count => count_branches
  end type branches_found_type

contains

  !> Find the branches over a parameter. Fails with exit_usage where there is no such parameter, with exit_data where it has no range,
  !> where its start lies outside, or where the forces have no known derivatives, and as the search for an equilibrium does. Fails with
  !> exit_interrupted where the work is stopped, with the branches that were found before.
  subroutine find_branches(model, variable, name, found, err, interruption)
    type(model_type), intent(in) :: model                            !< the model
    class(variable_model_type), intent(inout), target :: variable    !< the model as a function of its parameters
    character(len=*), intent(in) :: name                             !< of the parameter
    type(branches_found_type), intent(out) :: found                  !< the branches
    type(error_type), allocatable, intent(out) :: err                !< allocated if it failed
    class(interruption_type), intent(in), optional :: interruption   !< is asked whether the work shall stop
    type(branch_request_type), allocatable :: requests(:)
    integer :: number, i

    found%parameter = name
    allocate (found%branches(0), found%groups(0), found%low(0), found%high(0), found%of(0), found%stable(0))
    call find_parameter(model, name, number, err)
    if (allocated(err)) return
    call list_requests(model, model%parameters(number), requests)
    do i = 1, size(requests)
      call complete_request(model, model%parameters(number), requests(i), err)
      if (allocated(err)) return
    end do
    call find_columns(model, model%parameters(number), requests, found)
    allocate (found%rows(found%columns%count, 0))
    do i = 1, size(requests)
      call follow(model, variable, number, requests(i), found, err, interruption)
      if (allocated(err)) return
    end do
  end subroutine find_branches

  !> The number of branches that were found.
  pure integer function count_branches(self) result(number)
    class(branches_found_type), intent(in) :: self   !< the branches

    number = 0
    if (allocated(self%branches)) number = size(self%branches)
  end function count_branches

  !> The first group &branch of a data file, complete. Fails with exit_data where there is none, and as find_branches does.
  subroutine first_request(model, request, number, err)
    type(model_type), intent(in) :: model                     !< the model
    type(branch_request_type), intent(out) :: request         !< the group
    integer, intent(out) :: number                            !< of its parameter
    type(error_type), allocatable, intent(out) :: err         !< allocated if it failed

    number = 0
    if (allocated(model%request%branches)) then
      if (size(model%request%branches) > 0) request = model%request%branches(1)
    end if
    if (.not. allocated(request%parameter)) then
      call raise(err, exit_data, 'the data file has no group &branch, which names the parameter to follow; add one, such as '// &
                 '&branch parameter=''F'', low=0, high=1 /')
      return
    end if
    call find_parameter(model, request%parameter, number, err)
    if (.not. allocated(err)) call complete_request(model, model%parameters(number), request, err)
  end subroutine first_request

  !> The number of a parameter.
  subroutine find_parameter(model, name, number, err)
    type(model_type), intent(in) :: model               !< the model
    character(len=*), intent(in) :: name                !< of the parameter
    integer, intent(out) :: number                      !< its number
    type(error_type), allocatable, intent(out) :: err   !< allocated if there is none
    character(len=:), allocatable :: names
    integer :: i

    names = ''
    do number = 1, size(model%parameters)
      if (model%parameters(number)%name == name) return
      names = names//', '//model%parameters(number)%name
    end do
    if (names == '') then
      call raise(err, exit_usage, 'there is no parameter '''//name//''', since the data file has no &parameter; give one that '// &
                 'sets the number which shall change')
    else
      call raise(err, exit_usage, 'there is no parameter '''//name//'''; those of the data file are '//names(3:))
    end if
    if (.not. allocated(model%formulas)) return
    do i = 1, size(model%formulas)
      if (model%formulas(i)%name == name) &
        call raise(err, exit_usage, 'the value of '''//name//''' follows from a formula; give a parameter that stands in it')
    end do
  end subroutine find_parameter

  !> The groups &branch of a parameter; without any, one of defaults.
  subroutine list_requests(model, parameter, requests)
    type(model_type), intent(in) :: model                                  !< the model
    type(parameter_type), intent(in) :: parameter                          !< the parameter
    type(branch_request_type), allocatable, intent(out) :: requests(:)     !< the group
    logical, allocatable :: is_of(:)
    integer :: i, n

    allocate (is_of(0))
    if (allocated(model%request%branches)) &
      is_of = [(model%request%branches(i)%parameter == parameter%name, i=1, size(model%request%branches))]
    ! by hand: array constructors would leak (gfortran 12)
    allocate (requests(max(1, count(is_of))))
    n = 0
    do i = 1, size(is_of)
      if (.not. is_of(i)) cycle
      n = n + 1
      requests(n) = model%request%branches(i)
    end do
    if (n > 0) return
    requests(1)%parameter = parameter%name
    requests(1)%of = ''
    requests(1)%place = parameter%place
  end subroutine list_requests

  !> Complete what is asked for by the range of the parameter and by the kind of the coordinates. Fails where there is no range, or
  !> where such branches are not known.
  subroutine complete_request(model, parameter, request, err)
    type(model_type), intent(in) :: model                     !< the model
    type(parameter_type), intent(in) :: parameter             !< the parameter
    type(branch_request_type), intent(inout) :: request       !< the group
    type(error_type), allocatable, intent(out) :: err         !< allocated if it failed
    type(law_period_type) :: laws
    logical :: any_free

    if (is_heading(model, parameter%name)) call refuse_name(parameter, err)
    if (allocated(err)) return
    any_free = any(model%problem%partition%kind == free_coordinate)
    if (request%of == '') request%of = trim(merge('equilibrium', 'position   ', any_free))
    if (.not. request%has_low .and. parameter%has_range) request%low = parameter%low
    if (.not. request%has_high .and. parameter%has_range) request%high = parameter%high
    if (request%of /= 'position' .and. .not. any_free) then
      call raise(err, exit_data, 'every independent coordinate is driven, so that no motion is free; leave out a &drive, '// &
                 'or take of=''position''', request%place)
    else if (.not. parameter%has_range .and. .not. (request%has_low .and. request%has_high)) then
      call raise(err, exit_data, 'the parameter '''//parameter%name//''' has no range; give low and high in its &branch or '// &
                 'its &parameter', request%place)
    else if (.not. request%low < request%high) then
      call raise(err, exit_data, 'the range of '''//parameter%name//''', '//to_text(request%low)//' to '// &
                 to_text(request%high)//', needs high larger than low', request%place)
    else if (parameter%value < request%low .or. parameter%value > request%high) then
      call raise(err, exit_data, 'the branch begins at the value of '''//parameter%name//''', '//to_text(parameter%value)// &
                 ', which is outside its range, '//to_text(request%low)//' to '//to_text(request%high)// &
                 '; give value= in its &parameter within it', request%place)
    else if (request%of == 'equilibrium') then
      call refuse_parts(model, err)
    else if (request%of == 'periodic') then
      call find_law_period(model, laws, err)
      if (allocated(err) .or. laws%follows_time) return
      if (parameter%name == 'period') call refuse_name(parameter, err)
    end if
  end subroutine complete_request

  !> Fail because the name of a parameter is a heading of the table.
  subroutine refuse_name(parameter, err)
    type(parameter_type), intent(in) :: parameter             !< the parameter
    type(error_type), allocatable, intent(out) :: err         !< the failure

    call raise(err, exit_data, 'the table of branches has a column '''//parameter%name//''' of its own; give the parameter '// &
               'another name', parameter%place)
  end subroutine refuse_name

  !> Whether a name is a heading of all tables.
  pure logical function is_heading(model, name)
    type(model_type), intent(in) :: model               !< the model
    character(len=*), intent(in) :: name                !< the name
    integer :: k

    is_heading = any(name == [character(len=6) :: 'branch', 'point', 'growth', 'type']) .or. &
                 any([(name == 'q'//to_text(k), k=1, size(model%mechanism%pairs))])
  end function is_heading

  !> Fail where the mechanism has parts whose rest is not a smooth function of a parameter.
  subroutine refuse_parts(model, err)
    type(model_type), intent(in) :: model               !< the model
    type(error_type), allocatable, intent(out) :: err   !< allocated where it has some
    integer :: i

    do i = 1, size(model%mechanism%motors)
      associate (motor => model%mechanism%motors(i)%motor)
        if (.not. (motor%has_state() .or. motor%holds_setpoint())) cycle
        call raise(err, exit_data, 'branches of rest are not known with a motor that has a state of its own, a current or an '// &
                   'integral; use a &load in its place', motor%place)
        return
      end associate
    end do
    if (model%mechanism%has_contacts()) &
      call raise(err, exit_data, 'branches of rest are not known where links may touch each other; leave the group &contact out', &
                 model%mechanism%contacts(1)%place)
  end subroutine refuse_parts

  !> Follow the branches that one group asks for.
  subroutine follow(model, variable, number, request, found, err, interruption)
    type(model_type), intent(in) :: model                            !< the model
    class(variable_model_type), intent(inout), target :: variable    !< the model as a function of its parameters
    integer, intent(in) :: number                                    !< of the parameter
    type(branch_request_type), intent(in) :: request                 !< the group
    type(branches_found_type), intent(inout) :: found                !< gets the branches
    type(error_type), allocatable, intent(out) :: err                !< allocated if it failed
    class(interruption_type), intent(in), optional :: interruption   !< is asked whether the work shall stop
    type(position_curve_type), pointer :: positions
    type(periodic_curve_type), pointer :: motions
    type(single_parameter_type), pointer :: single
    type(curve_point_type) :: start

    allocate (single)
    call new_single_parameter(variable, model, number, single)
    if (request%of == 'periodic') then
      allocate (motions)
      if (present(interruption)) allocate (motions%interruption, source=interruption)
      call begin_motions(model, single, model%parameters(number)%value, request, motions, start, err)
      if (.not. allocated(err)) call trace(model, motions, motions%unit, start, request, found, err)
      call motions%map%close()
      deallocate (motions)
    else
      allocate (positions)
      call begin(model, single, model%parameters(number)%value, request, positions, start, err)
      if (.not. allocated(err)) then
        if (present(interruption)) allocate (positions%interruption, source=interruption)
        call trace(model, positions, positions%plan%unit_of, start, request, found, err)
      end if
      deallocate (positions)
    end if
    deallocate (single)
  end subroutine follow

  !> Trace the branches from a start. Fails where several begin there, and with exit_interrupted where the work is stopped.
  subroutine trace(model, curve, unit, start, request, found, err)
    type(model_type), intent(in) :: model                      !< the model
    class(curve_type), intent(inout) :: curve                  !< the problem
    real(wp), intent(in) :: unit(:)                            !< (M or more) of the coordinates [rad, m]
    type(curve_point_type), intent(inout) :: start             !< the first point
    type(branch_request_type), intent(in) :: request           !< the group
    type(branches_found_type), intent(inout) :: found          !< gets the branches
    type(error_type), allocatable, intent(out) :: err          !< allocated if it failed
    type(curve_settings_type) :: settings
    type(curve_branch_type), allocatable :: branches(:)
    integer :: left_out, not_doubled, directions

    call first_direction(start, directions)
    if (directions > 1) then
      call raise(err, exit_singular, 'at the start branches meet, or the mechanism can move without any force that holds it; '// &
                 'give another value= of the parameter, or a spring', request%place)
      return
    end if
    settings%step = request%step
    settings%points = request%points
    settings%low = request%low/(request%high - request%low)
    settings%high = request%high/(request%high - request%low)
    call find_curve_branches(curve, start, request%switch, settings, branches, left_out, not_doubled)
    found%left_out = found%left_out + left_out
    found%not_doubled = found%not_doubled + not_doubled
    found%low = [found%low, request%low]
    found%high = [found%high, request%high]
    found%of = [character(len=11) :: found%of, request%of]
    call put_rows(model, request, curve%m, unit, branches, found)
    found%groups = [found%groups, spread(size(found%of), 1, size(branches))]
    found%branches = [found%branches, branches]
    if (any([branches%ends(1)%reason, branches%ends(2)%reason] == ends_stopped)) &
      call raise(err, exit_interrupted, 'interrupted; the branches that were found until then are written')
  end subroutine trace

  !> Find the periodic motion at which branches begin. Fails where there is none.
  subroutine begin_motions(model, single, value, request, curve, start, err)
    type(model_type), intent(in) :: model                            !< the model
    type(single_parameter_type), intent(in), target :: single        !< the model as a function of the parameter
    real(wp), intent(in) :: value                                    !< of the parameter
    type(branch_request_type), intent(in) :: request                 !< the group
    type(periodic_curve_type), intent(inout) :: curve                !< gets the problem; whom it asks is known
    type(curve_point_type), intent(inout) :: start                   !< gets the first point
    type(error_type), allocatable, intent(out) :: err                !< allocated if it failed
    type(periodic_found_type) :: found

    call find_periodic(model, found, err, curve%interruption)
    if (.not. allocated(err)) call refuse_family(found%motions(1), 'the branch follows', request, err)
    if (.not. allocated(err)) &
      call begin_periodic_curve(single, model, found%motions(1), value, request%high - request%low, curve, start, err)
    if (allocated(err)) call add_place(err, place=request%place)
  end subroutine begin_motions

  !> Fail with exit_data where a free motion is none of its own at its value of the parameter.
  subroutine refuse_family(motion, follows, request, err)
    type(periodic_motion_type), intent(in) :: motion       !< the motion
    character(len=*), intent(in) :: follows                !< name and verb of a program that follows motions
    type(branch_request_type), intent(in) :: request       !< the group &branch
    type(error_type), allocatable, intent(out) :: err      !< allocated where it is refused

    if (.not. motion%is_free) return
    if (motion%is_trivial) then
      call raise(err, exit_data, 'the start leads to a position of rest; take of=''equilibrium'', whose Hopf points are ends '// &
                 'of branches of periodic motions, or begin nearer to a motion', request%place)
    else if (belongs_to_family(motion)) then
      call raise(err, exit_data, 'the motion conserves energy or something else, so that it belongs to a family at each value '// &
                 'of the parameter; '//follows//' single motions: add some damping and what feeds the motion', request%place)
    end if
  end subroutine refuse_family

  !> Find the start of the branches. Fails where there is none.
  subroutine begin(model, single, value, request, curve, start, err)
    type(model_type), intent(in) :: model                        !< the model
    type(single_parameter_type), intent(in), target :: single    !< the model as a function of the parameter
    real(wp), intent(in) :: value                                !< of the parameter
    type(branch_request_type), intent(in) :: request             !< the group
    type(position_curve_type), intent(inout) :: curve            !< gets the problem
    type(curve_point_type), intent(inout) :: start               !< gets the first point
    type(error_type), allocatable, intent(out) :: err            !< allocated if it failed
    class(rest_type), allocatable :: rest
    class(plan_type), allocatable :: first_plan, plan
    class(state_type), allocatable :: first_start, state

    if (request%of == 'position') then
      allocate (first_plan, first_start, plan, state)
      call assemble_model(model, first_plan, first_start, err)
      if (.not. allocated(err)) call make_plan(model%mechanism, model%problem%partition, first_start%q, plan, state, err, &
                                               planning_settings_type(in_space=.true.))
      if (allocated(err)) return
      call new_position_curve(single, model, plan, state, .false., request%high - request%low, curve)
      call begin_curve(curve, state%q, value, start, err)
      return
    end if
    allocate (rest)
    call begin_at_rest(model, request, rest, err)
    if (allocated(err)) return
    associate (resting => rest%equilibria(1)%resting)
      call new_position_curve(single, model, rest%plan, resting%state, .true., request%high - request%low, curve)
      curve%partition = resting%partition
      call begin_curve(curve, resting%state%q, value, start, err)
    end associate
    if (allocated(err)) call add_place(err, place=request%place)
  end subroutine begin

  !> Find the position of rest at which branches begin. Fails where there is none, or where it rests against a stop.
  subroutine begin_at_rest(model, request, rest, err)
    type(model_type), intent(in) :: model                        !< the model
    type(branch_request_type), intent(in) :: request             !< the group
    type(rest_type), intent(inout) :: rest                       !< gets the position
    type(error_type), allocatable, intent(out) :: err            !< allocated if it failed

    call rest%assemble(model, err)
    if (allocated(err)) return
    call rest%find(model, 0, .false., err)
    if (allocated(err)) then
      call add_place(err, place=request%place)
    else if (count(rest%equilibria(1)%resting%partition%kind == driven_coordinate) > &
             count(model%problem%partition%kind == driven_coordinate)) then
      call raise(err, exit_data, 'the start rests against a stop, and a branch begins at a position of rest without one; '// &
                 'give another initial position or another value of the parameter', request%place)
    end if
  end subroutine begin_at_rest

  !> Put the points of branches into rows of the table.
  subroutine put_rows(model, request, last, unit, branches, found)
    type(model_type), intent(in) :: model                  !< the model
    type(branch_request_type), intent(in) :: request       !< the group
    integer, intent(in) :: last                            !< component of an image that is the parameter
    real(wp), intent(in) :: unit(:)                        !< (M or more) of the coordinates [rad, m], ..., of a period of motions' own [s]
    type(curve_branch_type), intent(in) :: branches(:)     !< its branches
    type(branches_found_type), intent(inout) :: found      !< gets the rows
    real(wp) :: row(found%columns%count)
    real(wp), allocatable :: rows(:, :)
    integer :: b, i, m, n, at

    m = size(model%mechanism%pairs)
    n = size(found%rows, 2)
    allocate (rows(size(row), n + sum(branches%count)))
    rows(:, :n) = found%rows
    at = n
    do b = 1, size(branches)
      do i = 1, branches(b)%count
        row(1:2) = [real(size(found%branches) + b, wp), real(i, wp)]
        row(3) = branches(b)%z(last, i)*(request%high - request%low)
        row(4:3 + m) = branches(b)%z(:m, i)*unit(:m)
        if (found%growth > 0) row(found%growth) = branches(b)%growth(i)
        if (found%period > 0) row(found%period) = ieee_value(1.0_wp, ieee_quiet_nan)
        if (found%period > 0 .and. request%of == 'periodic') row(found%period) = branches(b)%z(last - 1, i)*unit(last - 1)
        row(size(row)) = branches(b)%kind(i)
        call found%columns%convert(row)
        at = at + 1
        rows(:, at) = row + 0.0_wp
      end do
      found%stable = [found%stable, branches(b)%stable(:branches(b)%count)]
    end do
    call move_alloc(rows, found%rows)
  end subroutine put_rows

  !> Find the columns of the table, and which of them have the growth and the period.
  subroutine find_columns(model, parameter, requests, found)
    type(model_type), intent(in) :: model                    !< the model
    type(parameter_type), intent(in) :: parameter            !< over which the branches are
    type(branch_request_type), intent(in) :: requests(:)     !< the groups, complete
    type(branches_found_type), intent(inout) :: found        !< gets the columns
    type(law_period_type) :: laws
    type(error_type), allocatable :: unused
    integer :: i
    logical :: with_growth, with_period

    with_growth = any([(requests(i)%of /= 'position', i=1, size(requests))])
    with_period = any([(requests(i)%of == 'periodic', i=1, size(requests))])
    if (with_period) then
      call find_law_period(model, laws, unused)
      with_period = .not. (allocated(unused) .or. laws%follows_time)
    end if
    found%columns = columns_of_branches(model, parameter, with_growth, with_period)
    if (with_growth) found%growth = found%columns%count - 1
    if (with_period) found%period = found%columns%count - 2
  end subroutine find_columns

  !> The columns of a table of branches.
  function columns_of_branches(model, parameter, with_growth, with_period) result(columns)
    type(model_type), intent(in) :: model               !< the model
    type(parameter_type), intent(in) :: parameter       !< over which the branches are
    logical, intent(in) :: with_growth                  !< some are of positions of rest or of motions
    logical, intent(in) :: with_period                  !< some are of motions with a period of their own
    type(columns_type) :: columns
    integer :: k

    allocate (columns%names(0), columns%units(0), columns%long_names(0))
    columns%system = model%mechanism%units
    call columns%append('branch', '', 'number of the branch')
    call columns%append('point', '', 'number of the point on its branch')
    call columns%append(parameter%name, trim(unit_of_parameter(model%mechanism, parameter)), 'the parameter')
    do k = 1, size(model%mechanism%pairs)
      call columns%append_in('q'//to_text(k), si_unit(model%mechanism%pairs(k)%pair))
    end do
    columns%motion = columns%count
    if (with_period) call columns%append('period', 's', 'period of the motion')
    if (with_growth) call columns%append('growth', '1/s', 'largest real part of the eigenvalues of the linearised equations of '// &
                                         'motion, or of the logarithms of multipliers over the period')
    call columns%append('type', '', '0 regular, 1 fold, 2 branch point, 3 Hopf, 4 period doubling, 5 torus')
  end function columns_of_branches
end module mech9_branches
