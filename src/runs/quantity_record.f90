!> The quantities of a run: their columns, the times between outputs that they need, and their numbers at its end.
module mech9_quantity_record
  use, intrinsic :: ieee_arithmetic, only: ieee_value, ieee_quiet_nan
  use mech9_kinds, only: wp
  use mech9_error, only: error_type, raise, exit_data
  use mech9_quantity, only: quantity_type
  use mech9_model, only: model_type
  use mech9_tangent, only: tangent_type
  use mech9_tracked_quantity, only: tracked_quantity_type
  use mech9_smooth_pieces, only: smooth_piece_type
  use mech9_quantity_pieces, only: quantity_pieces_type
  use mech9_motion_event, only: motion_events_type
  use mech9_columns, only: columns_type
  use mech9_missing_column, only: find_remedy
  implicit none
  private
  public :: quantity_record_type

  character(len=*), parameter :: unit_of_exponents = '1/s'

  type :: quantity_record_type
    type(quantity_type), allocatable :: quantities(:)
    type(tracked_quantity_type), allocatable :: tracked(:)
    real(wp), allocatable :: numbers(:)                      !< NaN before the end of the run
    real(wp), allocatable :: gradient(:, :)                  !< (P,quantities) derivatives of the numbers by the parameters, if the
                                                             !< run has them; NaN before its end and where there is none
    integer :: exponents = 0                                 !< numbers behind them that a study adds as Lyapunov exponents
    logical :: is_finished = .false.                         !< the numbers are known
    type(columns_type) :: columns                            !< of the run
    type(quantity_pieces_type), private :: pieces            !< between outputs
  contains
    procedure :: begin
    procedure :: begin_pieces
    procedure :: is_empty
    procedure :: has_gradient
    procedure :: columns_with_gradients
    procedure :: times_before
    procedure :: take_between
    procedure :: take_output
    procedure :: has_parts
    procedure :: divide
    procedure :: next_asked
    procedure :: needs_inside
    procedure :: needs_strides
    procedure :: point_in
    procedure :: first_jump
    procedure :: begin_part
    procedure :: take_row
    procedure :: close_part
    procedure :: leave_open
    procedure :: finish
    procedure :: unit_of
  end type quantity_record_type

contains

  !> Letters of the unit of a quantity. It stands first: gfortran must see it before the function whose result has this length.
  pure integer function unit_length(self, i)
    class(quantity_record_type), intent(in) :: self   !< the record
    integer, intent(in) :: i                          !< number of the quantity

    unit_length = 0
    ! exponents and the class of a motion are of no column
    if (i > size(self%tracked)) then
      if (i <= size(self%tracked) + self%exponents) unit_length = len(unit_of_exponents)
      return
    end if
    associate (unit => self%columns%units(self%tracked(i)%column)%text)
      unit_length = len(unit)
      if (self%tracked(i)%take /= 'integral') return
      unit_length = merge(1, len(unit) + 2, unit == '1' .or. unit == '')
    end associate
  end function unit_length

  !> Find the columns of the quantities. Fails with exit_data at the place of a quantity whose column is not recorded.
  subroutine begin(self, model, columns, err)
    class(quantity_record_type), intent(out) :: self        !< the record
    type(model_type), intent(in) :: model                   !< the model, which requests quantities
    type(columns_type), intent(in) :: columns               !< of the run
    type(error_type), allocatable, intent(out) :: err       !< allocated if it failed
    integer :: i, n

    self%quantities = model%request%quantities
    n = size(self%quantities)
    self%columns = columns
    allocate (self%tracked(n))
    allocate (self%numbers(n), source=ieee_value(1.0_wp, ieee_quiet_nan))
    do i = 1, n
      associate (quantity => self%quantities(i), tracked => self%tracked(i))
        tracked%take = quantity%take
        tracked%at = quantity%at
        call find_column(quantity, model, columns, tracked%column, err)
        if (.not. allocated(err)) call check_pole(quantity, err)
        if (allocated(err)) return
        call columns%family_of(tracked%column, tracked%family, tracked%order)
        if (tracked%family(0) > 0) tracked%weights = columns%scales(tracked%column)/columns%scales(tracked%family)
      end associate
    end do
    n = 0
    if (allocated(columns%parameters)) n = size(columns%parameters)
    allocate (self%gradient(n, size(self%quantities)), source=ieee_value(1.0_wp, ieee_quiet_nan))
    if (.not. self%has_gradient()) return
    do i = 1, size(self%tracked)
      call follow_changes(columns, self%tracked(i))
    end do
  end subroutine begin

  !> Fail with exit_data where a quantity follows a velocity pole, which may go to infinity between outputs.
  pure subroutine check_pole(quantity, err)
    type(quantity_type), intent(in) :: quantity             !< the quantity
    type(error_type), allocatable, intent(out) :: err       !< allocated if it failed

    if (index(quantity%column, '.pole.') == 0 .or. any(quantity%take == [character(len=5) :: 'start', 'end', 'at'])) return
    call raise(err, exit_data, 'quantity '''//quantity%name//''' takes '''//quantity%take//''' of a velocity pole, which is at '// &
               'infinity where the link does not turn; take ''start'', ''end'' or ''at''', quantity%place)
  end subroutine check_pole

  !> Let a quantity follow the derivatives of its column by the parameters, where there are any.
  subroutine follow_changes(columns, tracked)
    type(columns_type), intent(in) :: columns              !< of the run
    type(tracked_quantity_type), intent(inout) :: tracked  !< the quantity
    integer :: family(size(columns%parameters), 0:2), order

    if (tracked%family(0) == 0) then
      family(:, 0) = columns%derivatives_of(tracked%column)
      if (all(family(:, 0) > 0)) call tracked%follow_changes(family(:, 0:0))
    else
      do order = 0, 2
        family(:, order) = columns%derivatives_of(tracked%family(order))
      end do
      if (all(family > 0)) call tracked%follow_changes(family)
    end if
  end subroutine follow_changes

  !> Find the column of a quantity.
  subroutine find_column(quantity, model, columns, column, err)
    type(quantity_type), intent(in) :: quantity             !< the quantity
    type(model_type), intent(in) :: model                   !< the model, which explains a column that is missing
    type(columns_type), intent(in) :: columns               !< of the run
    integer, intent(out) :: column                          !< its number
    type(error_type), allocatable, intent(out) :: err       !< allocated if it failed
    character(len=:), allocatable :: remedy

    do column = 1, columns%count
      if (columns%names(column)%text == quantity%column) return
    end do
    call find_remedy(quantity%column, model, columns, remedy)
    call raise(err, exit_data, 'quantity '''//quantity%name//''' is of column '''//quantity%column//''', which is not recorded'// &
               remedy, quantity%place)
  end subroutine find_column

  !> Whether there are no quantities.
  pure logical function is_empty(self)
    class(quantity_record_type), intent(in) :: self   !< the record

    is_empty = .true.
    if (allocated(self%tracked)) is_empty = size(self%tracked) == 0
  end function is_empty

  !> Whether the run has derivatives by parameters, and quantities.
  pure logical function has_gradient(self)
    class(quantity_record_type), intent(in) :: self   !< the record

    has_gradient = .false.
    if (allocated(self%gradient)) has_gradient = size(self%gradient) > 0
  end function has_gradient

  !> The columns whose derivatives by the parameters are needed for the quantities.
  pure function columns_with_gradients(self) result(columns)
    class(quantity_record_type), intent(in) :: self   !< the record
    integer, allocatable :: columns(:)
    logical :: needed(self%columns%count)
    integer :: i

    needed = .false.
    do i = 1, size(self%tracked)
      associate (tracked => self%tracked(i))
        if (.not. allocated(tracked%changes)) cycle
        needed(tracked%column) = .true.
        if (tracked%family(0) > 0) needed(tracked%family) = .true.
      end associate
    end do
    columns = pack([(i, i=1, size(needed))], needed)
  end function columns_with_gradients

  !> Begin with the pieces in which the laws are smooth, at the start of the run.
  subroutine begin_pieces(self, model, tangents)
    class(quantity_record_type), intent(inout) :: self           !< the record, begun
    type(model_type), intent(in) :: model                        !< the model
    type(tangent_type), allocatable, intent(in) :: tangents(:)   !< (P) of its constants, where the times of joints depend on them

    call self%pieces%begin(model, self%tracked, size(self%gradient, 1), tangents)
  end subroutine begin_pieces

  !> The times between the output before and the next one at which rows are needed, in their order. To be called for all outputs
  !> behind the start.
  subroutine times_before(self, model, previous, t, times)
    class(quantity_record_type), intent(inout) :: self  !< the record
    type(model_type), intent(in) :: model               !< the model
    real(wp), intent(in) :: previous                    !< time of the output before [s]
    real(wp), intent(in) :: t                           !< time of the next output [s]
    real(wp), allocatable, intent(out) :: times(:)      !< between the two outputs [s]
    integer :: i

    allocate (times(0))
    if (self%is_empty()) return
    call self%pieces%times_before(model, previous, t, times)
    do i = 1, size(self%tracked)
      associate (at => self%tracked(i)%at)
        if (self%tracked(i)%take /= 'at') cycle
        if (.not. (at - previous)*(t - at) > 0.0_wp .or. any(.not. abs(times - at) > 0.0_wp)) cycle
        ! the new time stands after those that are nearer to the output before
        times = [pack(times, abs(times - previous) < abs(at - previous)), at, &
                 pack(times, abs(times - previous) > abs(at - previous))]
      end associate
    end do
  end subroutine times_before

  !> Take a row between the output before and the next one.
  subroutine take_between(self, model, row, next, events)
    class(quantity_record_type), intent(inout) :: self  !< the record, which has taken all rows before this one
    type(model_type), intent(in) :: model               !< the model
    real(wp), intent(in) :: row(:)                      !< numbers of the row, time first
    real(wp), intent(in) :: next                        !< time of the next output [s]
    type(motion_events_type), intent(in) :: events      !< of the motion so far

    call take_times(self, row)
    call self%pieces%take_between(model, self%tracked, row, next, events)
  end subroutine take_between

  !> Whether quantities are followed between outputs, so that pieces are of use.
  pure logical function has_parts(self)
    class(quantity_record_type), intent(in) :: self   !< the record

    has_parts = .false.
    if (.not. self%is_empty()) has_parts = self%pieces%is_followed()
  end function has_parts

  !> The pieces between two outputs in which laws are smooth, in a motion with events. To be called for all outputs behind the start.
  subroutine divide(self, model, previous, t, list)
    class(quantity_record_type), intent(inout) :: self                !< the record
    type(model_type), intent(in) :: model                             !< the model
    real(wp), intent(in) :: previous                                  !< time of the output before [s]
    real(wp), intent(in) :: t                                         !< time of the output [s]
    type(smooth_piece_type), allocatable, intent(out) :: list(:)      !< in the order of time

    call self%pieces%divide(model, previous, t, list)
  end subroutine divide

  !> The next given time at which a value is wanted, behind one time and up to another; the former where there is none [s].
  pure real(wp) function next_asked(self, from, to) result(next)
    class(quantity_record_type), intent(in) :: self   !< the record
    real(wp), intent(in) :: from                      !< time behind which [s]
    real(wp), intent(in) :: to                        !< time up to which [s]
    integer :: i

    next = from
    do i = 1, size(self%tracked)
      associate (at => self%tracked(i)%at)
        if (self%tracked(i)%take /= 'at') cycle
        if (.not. (at - from)*(to - from) > 0.0_wp .or. abs(at - from) > abs(to - from)) cycle
        if (.not. abs(next - from) > 0.0_wp .or. abs(at - from) < abs(next - from)) next = at
      end associate
    end do
  end function next_asked

  !> Whether values between outputs are needed.
  pure logical function needs_inside(self)
    class(quantity_record_type), intent(in) :: self   !< the record

    needs_inside = self%pieces%needs_inside()
  end function needs_inside

  !> Whether the ends of strides of a motion with events count as outputs: between events there may be few of these.
  pure logical function needs_strides(self, events)
    class(quantity_record_type), intent(in) :: self   !< the record
    integer, intent(in) :: events                     !< how many there were so far

    needs_strides = self%pieces%needs_inside() .or. events > 0
  end function needs_strides

  !> The time of a point in a part of a piece.
  pure real(wp) function point_in(self, part, k) result(time)
    class(quantity_record_type), intent(in) :: self   !< the record
    type(smooth_piece_type), intent(in) :: part       !< the part
    integer, intent(in) :: k                          !< number of the point, up to `points_between`

    time = self%pieces%point_in(part, k)
  end function point_in

  !> The lowest derivative of positions that jumps within a part, up to the present time: 1 rates, 2 accelerations, 3 none.
  pure integer function first_jump(self, part, events) result(jump)
    class(quantity_record_type), intent(in) :: self     !< the record
    type(smooth_piece_type), intent(in) :: part         !< the part
    type(motion_events_type), intent(in) :: events      !< of the motion so far

    jump = self%pieces%first_jump(part, events)
  end function first_jump

  !> Begin a part: at a joint of laws, or behind an event.
  pure subroutine begin_part(self, row, rate, events)
    class(quantity_record_type), intent(inout) :: self  !< the record
    real(wp), intent(in) :: row(:)                      !< numbers at its beginning, time first
    real(wp), allocatable, intent(in) :: rate(:)        !< (P) derivatives of the time of the joint by the parameters
    type(motion_events_type), intent(in) :: events      !< of the motion so far

    call take_times(self, row)
    call self%pieces%begin_part(self%tracked, row, rate, events)
  end subroutine begin_part

  !> Take a row at a given time, or at a point of a part.
  pure subroutine take_row(self, k, row)
    class(quantity_record_type), intent(inout) :: self  !< the record
    integer, intent(in) :: k                            !< number of the point; 0: the time is given
    real(wp), intent(in) :: row(:)                      !< numbers of the row, time first

    call take_times(self, row)
    if (k > 0) call self%pieces%take_point(self%tracked, k, row)
  end subroutine take_row

  !> End a part, and begin the next one with its last row.
  pure subroutine close_part(self, row, part, jump, events)
    class(quantity_record_type), intent(inout) :: self  !< the record
    real(wp), intent(in) :: row(:)                      !< numbers at its end, time first
    type(smooth_piece_type), intent(in) :: part         !< the part
    integer, intent(in) :: jump                         !< lowest derivative of positions that jumps within it; 3: none
    type(motion_events_type), intent(in) :: events      !< of the motion so far

    call take_times(self, row)
    call self%pieces%close_part(self%tracked, row, part, jump, events)
  end subroutine close_part

  !> Let the output that comes next end a part, or none.
  pure subroutine leave_open(self, parts)
    class(quantity_record_type), intent(inout) :: self                    !< the record
    type(smooth_piece_type), allocatable, intent(inout) :: parts(:)       !< one, or none

    call self%pieces%leave_open(parts)
  end subroutine leave_open

  !> Take the row of an output.
  subroutine take_output(self, model, row, events)
    class(quantity_record_type), intent(inout) :: self  !< the record
    type(model_type), intent(in) :: model               !< the model
    real(wp), intent(in) :: row(:)                      !< numbers of the output, time first
    type(motion_events_type), intent(in) :: events      !< of the motion so far
    integer :: i

    do i = 1, size(self%tracked)
      call self%tracked(i)%take_output(row)
    end do
    call take_times(self, row)
    call self%pieces%take_output(model, self%tracked, row, events)
  end subroutine take_output

  !> Take a row for the quantities that are values at its time.
  pure subroutine take_times(self, row)
    type(quantity_record_type), intent(inout) :: self   !< the record
    real(wp), intent(in) :: row(:)                      !< numbers of a row
    integer :: i

    do i = 1, size(self%tracked)
      if (self%tracked(i)%take == 'at' .and. .not. abs(row(1) - self%tracked(i)%at) > 0.0_wp) call self%tracked(i)%take_at(row)
    end do
  end subroutine take_times

  !> Find the numbers, after the last output.
  pure subroutine finish(self)
    class(quantity_record_type), intent(inout) :: self  !< the record
    integer :: i

    do i = 1, size(self%tracked)
      call self%tracked(i)%finish(self%pieces%rule)
      self%numbers(i) = self%tracked(i)%number()
      if (allocated(self%tracked(i)%changes)) call self%tracked(i)%find_gradient(self%gradient(:, i))
    end do
    self%is_finished = .true.
  end subroutine finish

  !> Unit of a quantity.
  pure function unit_of(self, i) result(unit)
    class(quantity_record_type), intent(in) :: self   !< the record
    integer, intent(in) :: i                          !< number of the quantity
    character(len=unit_length(self, i)) :: unit

    unit = ''
    if (len(unit) > 0 .and. i > size(self%tracked)) unit = unit_of_exponents
    if (i > size(self%tracked)) return
    unit = self%columns%units(self%tracked(i)%column)%text
    if (self%tracked(i)%take == 'integral') unit(max(1, len(unit) - 1):) = trim(merge('s ', ' s', len(unit) == 1))
  end function unit_of
end module mech9_quantity_record
