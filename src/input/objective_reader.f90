!> The groups &objective and &optimum of a checked document: targets that a motion should meet, quantities that should be small, and
!> the search for the best design.
module mech9_objective_reader
  use mech9_kinds, only: wp
  use mech9_text, only: to_text
  use mech9_counted, only: counted
  use mech9_error, only: error_type
  use mech9_source, only: span_type
  use mech9_number_file, only: number_file_type, read_number_file
  use mech9_document, only: document_type, group_type
  use mech9_lookup, only: groups_named, group_or_empty, has_name, get_integer, get_real, get_text, span_of
  use mech9_diagnostics, only: diagnostics_type, printable
  use mech9_table_file, only: beside
  use mech9_model, only: model_type
  use mech9_result_units, only: unit_of
  use mech9_objective, only: objective_type, path_objective, function_objective, pose_objective, quantity_objective, &
    timing_given, timing_free, timing_over
  implicit none
  private
  public :: read_objectives, find_quantity

  !> Sums of fourth powers of larger numbers could be beyond all numbers.
  real(wp), parameter :: largest_number = 1.0e60_wp
  integer, parameter :: most_starts = 10**7   !< each takes memory until the search ends

contains

  !> Read all groups &objective and the group &optimum.
  subroutine read_objectives(document, model, diagnostics)
    type(document_type), intent(in) :: document           !< the data file as groups and items
    type(model_type), intent(inout) :: model              !< with mechanism and problem; gets the objectives
    type(diagnostics_type), intent(inout) :: diagnostics  !< gets the errors
    type(group_type) :: search
    integer, allocatable :: numbers(:)
    integer :: i

    numbers = groups_named(document, 'objective')
    allocate (model%request%objectives(size(numbers)))
    if (size(numbers) == 0) return
    search = group_or_empty(document, 'optimum')
    model%request%optimum%starts = get_integer(search, 'starts')
    if (model%request%optimum%starts > most_starts) &
      call diagnostics%add(span_of(search, 'starts', 1), 'one search makes at most '//to_text(most_starts)// &
                           ' starts; make several searches with other seeds')
    model%request%optimum%seed = get_integer(search, 'seed')
    if (has_name(search, 'method')) then
      model%request%optimum%method = get_text(search, 'method')
      model%request%optimum%place = diagnostics%place(span_of(search, 'method', 1))
    end if
    if (diagnostics%failed()) return             ! points and coordinates may not be known
    do i = 1, size(numbers)
      associate (group => document%groups(numbers(i)), objective => model%request%objectives(i))
        objective%place = diagnostics%place(group%span)
        objective%weight = get_real(group, 'weight')
        select case (get_text(group, 'kind'))
        case ('path')
          call read_path(document, group, model, objective, diagnostics)
        case ('function')
          call read_function(document, group, model, objective, diagnostics)
        case ('pose')
          call read_poses(document, group, model, objective, diagnostics)
        case ('quantity')
          call read_quantity(group, model, objective, diagnostics)
        end select
        if (.not. allocated(objective%targets)) allocate (objective%targets(3, 0), objective%at(0))
        if (.not. allocated(objective%turns)) allocate (objective%turns(3, size(objective%at)), source=0.0_wp)
      end associate
    end do
  end subroutine read_objectives

  !> Read the targets of a point.
  subroutine read_path(document, group, model, objective, diagnostics)
    type(document_type), intent(in) :: document           !< the data file as groups and items
    type(group_type), intent(in) :: group                 !< the group of the objective
    type(model_type), intent(in) :: model                 !< with the points
    type(objective_type), intent(inout) :: objective      !< gets the targets
    type(diagnostics_type), intent(inout) :: diagnostics  !< gets the errors
    character(len=40) :: names(size(model%mechanism%points))
    real(wp), allocatable :: rows(:, :)
    integer :: i, n

    objective%kind = path_objective
    objective%timing = merge(timing_given, timing_free, get_text(group, 'timing') == 'given')
    do i = 1, size(names)
      names(i) = model%mechanism%points(i)%name
    end do
    objective%point = findloc(names, get_text(group, 'point'), dim=1)
    if (objective%point == 0) then
      call refuse_name(group, 'point', 'there is no &point '''//get_text(group, 'point')//'''', names, diagnostics)
      return
    end if
    if (objective%timing == timing_free) then
      call read_rows(document, group, [2, 3], 'the coordinates x and y of a target, or x, y and z', rows, diagnostics)
    else
      call read_rows(document, group, [3, 4], 'the time of a target and its coordinates x and y, or x, y and z', rows, diagnostics)
    end if
    n = size(rows, 2)
    if (n == 0) return
    objective%components = size(rows, 1)
    if (objective%timing == timing_given) objective%components = size(rows, 1) - 1
    allocate (objective%targets(3, n), objective%at(n), source=0.0_wp)
    objective%targets(:objective%components, :) = model%mechanism%units%length*rows(size(rows, 1) - objective%components + 1:, :)
    if (objective%timing == timing_free) return
    objective%at = rows(1, :)
    call check_times(group, model, objective%at, diagnostics)
  end subroutine read_path

  !> Read the values of a function.
  subroutine read_function(document, group, model, objective, diagnostics)
    type(document_type), intent(in) :: document           !< the data file as groups and items
    type(group_type), intent(in) :: group                 !< the group of the objective
    type(model_type), intent(in) :: model                 !< with the coordinates and drives
    type(objective_type), intent(inout) :: objective      !< gets the targets
    type(diagnostics_type), intent(inout) :: diagnostics  !< gets the errors
    real(wp), allocatable :: rows(:, :)
    integer :: i, m
    character(len=40) :: names(size(model%mechanism%pairs))

    m = size(names)
    names = [(repeat(' ', 40), i=1, m)]
    do i = 1, m
      names(i) = 'q'//to_text(i)
    end do
    objective%kind = function_objective
    objective%components = 1
    objective%coordinate = findloc(names, get_text(group, 'of'), dim=1)
    if (objective%coordinate == 0) call refuse_name(group, 'of', 'there is no coordinate '''//get_text(group, 'of')//'''', names, &
                                                    diagnostics)
    objective%timing = timing_given
    if (get_text(group, 'over') /= 't' .and. get_text(group, 'over') /= '') then
      objective%timing = timing_over
      objective%over = findloc(names, get_text(group, 'over'), dim=1)
      if (objective%over == 0) then
        call refuse_name(group, 'over', 'there is no coordinate '''//get_text(group, 'over')//'''', names, diagnostics)
      else if (.not. any([(model%problem%drives(i)%drive%coordinate == objective%over, i=1, size(model%problem%drives))])) then
        call diagnostics%add(span_of(group, 'over', 1), 'the variable of the function must be t or a coordinate with a drive')
      end if
    end if
    call read_rows(document, group, [2], 'the variable and the value of the function', rows, diagnostics)
    if (size(rows, 2) == 0 .or. objective%coordinate == 0) return
    if (objective%timing == timing_over .and. objective%over == 0) return
    allocate (objective%targets(3, size(rows, 2)), objective%at(size(rows, 2)), source=0.0_wp)
    objective%targets(1, :) = rows(2, :)*unit_of(model%mechanism, objective%coordinate)
    objective%at = rows(1, :)
    if (objective%timing == timing_given) then
      call check_times(group, model, objective%at, diagnostics)
    else
      objective%at = objective%at*unit_of(model%mechanism, objective%over)
    end if
  end subroutine read_function

  !> Read the poses of a link. Angles are compared with distances by a length, which by default is the largest distance between two
  !> poses.
  subroutine read_poses(document, group, model, objective, diagnostics)
    type(document_type), intent(in) :: document           !< the data file as groups and items
    type(group_type), intent(in) :: group                 !< the group of the objective
    type(model_type), intent(in) :: model                 !< with the structure
    type(objective_type), intent(inout) :: objective      !< gets the targets
    type(diagnostics_type), intent(inout) :: diagnostics  !< gets the errors
    real(wp), allocatable :: rows(:, :)
    integer :: i, j, n, first

    objective%kind = pose_objective
    objective%timing = merge(timing_given, timing_free, get_text(group, 'timing') == 'given')
    objective%link = get_integer(group, 'link')
    associate (n_links => model%mechanism%structure%shown_links())
      if (objective%link > n_links) &
        call diagnostics%add(span_of(group, 'link', 1), 'there is no link '//to_text(objective%link)//'; the mechanism has '// &
                             counted(n_links, 'link'))
    end associate
    if (objective%link == 1) call diagnostics%add(span_of(group, 'link', 1), 'link 1 is the frame, whose pose never changes')
    if (objective%timing == timing_free) then
      call read_rows(document, group, [3, 6], 'a pose: x, y and an angle, or x, y, z and the three components of a rotation '// &
                     'vector', rows, diagnostics)
    else
      call read_rows(document, group, [4, 7], 'the time of a pose and the pose: x, y and an angle, or x, y, z and the three '// &
                     'components of a rotation vector', rows, diagnostics)
    end if
    n = size(rows, 2)
    if (n == 0) return
    first = merge(1, 0, objective%timing == timing_given)
    objective%components = (size(rows, 1) - first)/2 + modulo(size(rows, 1) - first, 2)
    allocate (objective%targets(3, n), objective%turns(3, n), objective%at(n), source=0.0_wp)
    objective%targets(:objective%components, :) = model%mechanism%units%length*rows(first + 1:first + objective%components, :)
    j = size(rows, 1) - first - objective%components
    objective%turns(4 - j:, :) = rows(size(rows, 1) - j + 1:, :)*model%mechanism%units%angle
    if (first == 1) objective%at = rows(1, :)
    if (first == 1) call check_times(group, model, objective%at, diagnostics)
    objective%length = 0.0_wp
    do i = 1, n
      do j = 1, i - 1
        objective%length = max(objective%length, norm2(objective%targets(:, i) - objective%targets(:, j)))
      end do
    end do
    if (has_name(group, 'length')) objective%length = get_real(group, 'length')
    if (.not. objective%length > 0.0_wp) &
      call diagnostics%add(span_of(group, 'file', 1), 'all poses are at one place, so that the weight of angles against '// &
                           'distances does not follow from them; give ''length'', the distance that counts as much as 1 rad')
  end subroutine read_poses

  !> Read what a quantity should be.
  pure subroutine read_quantity(group, model, objective, diagnostics)
    type(group_type), intent(in) :: group                 !< the group of the objective
    type(model_type), intent(in) :: model                 !< with the quantities
    type(objective_type), intent(inout) :: objective      !< gets the quantity
    type(diagnostics_type), intent(inout) :: diagnostics  !< gets the errors

    objective%kind = quantity_objective
    call find_quantity(group, model, objective%quantity, diagnostics)
    objective%has_goal = has_name(group, 'goal')
    if (objective%has_goal) objective%goal = get_real(group, 'goal')
    if (get_text(group, 'make') == 'largest') objective%direction = -1.0_wp
    if (objective%has_goal .and. has_name(group, 'make')) &
      call diagnostics%add(span_of(group, 'make', 1), '''make'' asks for the least or the largest value, and ''goal'' '// &
                           'for a value; leave one of them out')
  end subroutine read_quantity

  !> Find the quantity that a group names with `of`.
  pure subroutine find_quantity(group, model, number, diagnostics)
    type(group_type), intent(in) :: group                 !< the group of the objective or the limit
    type(model_type), intent(in) :: model                 !< with the quantities
    integer, intent(out) :: number                        !< of the quantity; 0: there is none
    type(diagnostics_type), intent(inout) :: diagnostics  !< gets the error
    character(len=40) :: names(size(model%request%quantities))
    integer :: i

    do i = 1, size(names)
      names(i) = model%request%quantities(i)%name
    end do
    number = findloc(names, get_text(group, 'of'), dim=1)
    if (number == 0) call refuse_name(group, 'of', 'there is no &quantity '''//get_text(group, 'of')//'''', names, diagnostics)
  end subroutine find_quantity

  !> Report a name that does not exist.
  pure subroutine refuse_name(group, item, sentence, names, diagnostics)
    type(group_type), intent(in) :: group                 !< the group of the objective
    character(len=*), intent(in) :: item                  !< the item with the name
    character(len=*), intent(in) :: sentence              !< the fault
    character(len=*), intent(in) :: names(:)              !< the names that there are
    type(diagnostics_type), intent(inout) :: diagnostics  !< gets the error

    if (size(names) == 0) then
      call diagnostics%add(span_of(group, item, 1), sentence)
    else if (size(names) == 1) then
      call diagnostics%add(span_of(group, item, 1), sentence//'; the only one is '//trim(names(1)))
    else if (size(names) <= 12) then
      call diagnostics%add(span_of(group, item, 1), sentence//'; there are '//trim(listed(names)))
    else
      call diagnostics%add(span_of(group, item, 1), sentence//'; there are '//trim(names(1))//' to '//trim(names(size(names))))
    end if
  end subroutine refuse_name

  !> Report times that lie outside the run.
  pure subroutine check_times(group, model, times, diagnostics)
    type(group_type), intent(in) :: group                 !< the group of the objective
    type(model_type), intent(in) :: model                 !< with the times of the run
    real(wp), intent(in) :: times(:)                      !< of the targets [s]
    type(diagnostics_type), intent(inout) :: diagnostics  !< gets the error
    integer :: i

    associate (time => model%request%time)
      do i = 1, size(times)
        if (times(i) < min(time%start, time%end) .or. times(i) > max(time%start, time%end)) then
          call diagnostics%add(span_of(group, 'file', 1), 'target '//to_text(i)//' is at t = '//to_text(times(i))// &
                               ' s, and the run goes from '//to_text(time%start)//' to '//to_text(time%end)//' s; change &time')
          return
        end if
      end do
    end associate
  end subroutine check_times

  !> Read the lines of the file that an objective names: as many numbers in each as in the first one.
  subroutine read_rows(document, group, columns, meaning, rows, diagnostics)
    type(document_type), intent(in) :: document           !< the data file as groups and items
    type(group_type), intent(in) :: group                 !< the group of the objective
    integer, intent(in) :: columns(:)                     !< numbers that a line may have, in increasing order
    character(len=*), intent(in) :: meaning               !< of the numbers, for messages
    real(wp), allocatable, intent(out) :: rows(:, :)      !< (columns,lines); no lines where errors are reported
    type(diagnostics_type), intent(inout) :: diagnostics  !< gets the errors
    type(number_file_type) :: lines
    type(error_type), allocatable :: err
    character(len=:), allocatable :: path
    integer :: i, found, width

    allocate (rows(columns(1), 0))
    found = diagnostics%count
    path = beside(document%source%name, get_text(group, 'file'))
    call read_number_file(path, columns(size(columns)), lines, diagnostics, err)
    if (allocated(err)) then
      call diagnostics%add(span_of(group, 'file', 1), 'the targets '''//printable(path)//''': '//err%message, err%code)
      return
    end if
    width = columns(1)
    if (size(lines%counts) > 0) width = lines%counts(1)
    if (.not. any(columns == width)) width = columns(1)
    do i = 1, size(lines%counts)
      if (lines%counts(i) /= width) then
        call diagnostics%add(lines%spans(i), 'each line holds '//meaning//'; this one has '//counted(lines%counts(i), 'number'))
      else if (any(abs(lines%numbers(:width, i)) > largest_number)) then
        call diagnostics%add(lines%spans(i), 'the squares of such numbers cannot be added; change the unit of the whole file')
      end if
    end do
    if (diagnostics%count == found .and. size(lines%counts) < 2) &
      call diagnostics%add(span_type(lines%source, 0, 0), &
                           'an objective needs at least two targets, and the file has '//to_text(size(lines%counts)))
    if (diagnostics%count == found) rows = lines%numbers(:width, :)
  end subroutine read_rows

  !> Names one behind the other, with commas between.
  pure function listed(names)
    character(len=*), intent(in) :: names(:)   !< the names
    character(len=(len(names) + 2)*size(names)) :: listed
    integer :: i

    listed = ''
    do i = 1, size(names)
      if (i > 1) listed = trim(listed)//','
      listed = trim(listed)//' '//names(i)
    end do
    listed = adjustl(listed)
  end function listed
end module mech9_objective_reader
