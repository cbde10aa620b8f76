!> The quantities of a run: their columns, the times between outputs that they need, and their numbers at its end.
module mech9_quantity_record
  use, intrinsic :: ieee_arithmetic, only: ieee_value, ieee_quiet_nan
  use mech9_kinds, only: wp
  use mech9_text, only: to_text
  use mech9_error, only: error_type, raise, exit_data
  use mech9_quantity, only: quantity_type
  use mech9_model, only: model_type
  use mech9_chebyshev, only: chebyshev_type, new_chebyshev
  use mech9_tracked_quantity, only: tracked_quantity_type
  use mech9_columns, only: columns_type
  use mech9_missing_column, only: remedy_of_missing
  use mech9_facts, only: facts_type
  use mech9_json, only: json_type
  implicit none
  private
  public :: quantity_record_type

  !> Points of the polynomial that follows a column between two outputs, these included.
  integer, parameter :: points_between = 10

  type :: quantity_record_type
    type(quantity_type), allocatable :: quantities(:)
    type(tracked_quantity_type), allocatable :: tracked(:)
    real(wp), allocatable :: numbers(:)                      !< NaN before the end of the run
    logical, private :: is_finished = .false.                !< the numbers are known
    type(columns_type), private :: columns
    type(chebyshev_type), private :: rule
    real(wp), allocatable, private :: piece(:, :)            !< (points_between,quantities) values between two outputs
    real(wp), private :: times(points_between) = 0.0_wp      !< of the points between two outputs [s]
    real(wp), private :: previous = 0.0_wp                   !< time of the output before [s]
  contains
    procedure :: begin
    procedure :: is_empty
    procedure :: times_before
    procedure :: take_between
    procedure :: take_output
    procedure :: finish
    procedure :: unit_of
    procedure :: find_facts
    procedure :: print => print_quantities
    procedure :: to_json
  end type quantity_record_type

contains

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
    allocate (self%piece(points_between, n), source=0.0_wp)
    call new_chebyshev(points_between, self%rule)
    do i = 1, n
      associate (quantity => self%quantities(i), tracked => self%tracked(i))
        tracked%take = quantity%take
        tracked%at = quantity%at
        call find_column(quantity, model, columns, tracked%column, err)
        if (allocated(err)) return
        call columns%family_of(tracked%column, tracked%family, tracked%order)
      end associate
    end do
  end subroutine begin

  !> Find the column of a quantity.
  subroutine find_column(quantity, model, columns, column, err)
    type(quantity_type), intent(in) :: quantity             !< the quantity
    type(model_type), intent(in) :: model                   !< the model, which explains a column that is missing
    type(columns_type), intent(in) :: columns               !< of the run
    integer, intent(out) :: column                          !< its number
    type(error_type), allocatable, intent(out) :: err       !< allocated if it failed

    do column = 1, columns%count
      if (columns%names(column)%text == quantity%column) return
    end do
    call raise(err, exit_data, 'quantity '''//quantity%name//''' is of column '''//quantity%column//''', which is not recorded'// &
               remedy_of_missing(quantity%column, model, columns), quantity%place)
  end subroutine find_column

  !> Whether there are no quantities.
  pure logical function is_empty(self)
    class(quantity_record_type), intent(in) :: self   !< the record

    is_empty = .true.
    if (allocated(self%tracked)) is_empty = size(self%tracked) == 0
  end function is_empty

  !> The times between the output before and the next one at which rows are needed, in their order.
  subroutine times_before(self, t, times)
    class(quantity_record_type), intent(inout) :: self  !< the record; keeps the times of the points
    real(wp), intent(in) :: t                           !< time of the next output [s]
    real(wp), allocatable, intent(out) :: times(:)      !< between the two outputs [s]
    integer :: i

    allocate (times(0))
    if (self%is_empty()) return
    self%times = self%previous + 0.5_wp*(t - self%previous)*(1.0_wp + self%rule%points)
    if (needs_pieces(self)) times = self%times(2:self%rule%n - 1)
    do i = 1, size(self%tracked)
      associate (at => self%tracked(i)%at)
        if (self%tracked(i)%take /= 'at') cycle
        if (.not. (at - self%previous)*(t - at) > 0.0_wp .or. any(.not. abs(times - at) > 0.0_wp)) cycle
        ! the new time stands after those that are nearer to the output before
        times = [pack(times, abs(times - self%previous) < abs(at - self%previous)), at, &
                 pack(times, abs(times - self%previous) > abs(at - self%previous))]
      end associate
    end do
  end subroutine times_before

  !> Whether a quantity needs values at the points between outputs.
  pure logical function needs_pieces(self)
    type(quantity_record_type), intent(in) :: self   !< the record
    integer :: i

    needs_pieces = .false.
    do i = 1, size(self%tracked)
      needs_pieces = needs_pieces .or. self%tracked(i)%needs_piece()
    end do
  end function needs_pieces

  !> Take a row between the output before and the next one.
  pure subroutine take_between(self, row)
    class(quantity_record_type), intent(inout) :: self  !< the record
    real(wp), intent(in) :: row(:)                      !< numbers of the row, time first
    integer :: i, k

    do i = 1, size(self%tracked)
      associate (tracked => self%tracked(i))
        if (tracked%take == 'at' .and. .not. abs(row(1) - tracked%at) > 0.0_wp) call tracked%take_at(row(tracked%column))
        do k = 2, self%rule%n - 1
          if (.not. abs(row(1) - self%times(k)) > 0.0_wp) self%piece(k, i) = row(tracked%column)
        end do
      end associate
    end do
  end subroutine take_between

  !> Take the row of an output.
  pure subroutine take_output(self, row)
    class(quantity_record_type), intent(inout) :: self  !< the record
    real(wp), intent(in) :: row(:)                      !< numbers of the output, time first
    integer :: i, n
    logical :: is_first

    n = self%rule%n
    do i = 1, size(self%tracked)
      associate (tracked => self%tracked(i))
        is_first = tracked%is_at_start()
        call tracked%take_output(self%rule, row)
        if (tracked%take == 'at' .and. .not. abs(row(1) - tracked%at) > 0.0_wp) call tracked%take_at(row(tracked%column))
        self%piece(n, i) = row(tracked%column)
        if (tracked%needs_piece() .and. .not. is_first) &
          call tracked%take_piece(self%rule, self%previous, row(1), self%piece(:, i))
        self%piece(1, i) = row(tracked%column)
      end associate
    end do
    self%previous = row(1)
  end subroutine take_output

  !> Find the numbers, after the last output.
  pure subroutine finish(self)
    class(quantity_record_type), intent(inout) :: self  !< the record
    integer :: i

    do i = 1, size(self%tracked)
      call self%tracked(i)%finish(self%rule)
      self%numbers(i) = self%tracked(i)%number()
    end do
    self%is_finished = .true.
  end subroutine finish

  !> Unit of a quantity.
  pure function unit_of(self, i) result(unit)
    class(quantity_record_type), intent(in) :: self   !< the record
    integer, intent(in) :: i                          !< number of the quantity
    character(len=:), allocatable :: unit

    unit = self%columns%units(self%tracked(i)%column)%text
    if (self%tracked(i)%take /= 'integral') return
    if (unit == '1' .or. unit == '') then
      unit = 's'
    else
      unit = unit//' s'
    end if
  end function unit_of

  !> The quantities as facts, for the HDF5 file.
  subroutine find_facts(self, facts)
    class(quantity_record_type), intent(in) :: self   !< the record
    type(facts_type), intent(out) :: facts            !< the quantities; NaN before the end of the run
    integer :: i

    if (self%is_empty()) return
    do i = 1, size(self%tracked)
      call facts%add(self%quantities(i)%name, self%numbers(i), trim(self%quantities(i)%take)//' of '//self%quantities(i)%column, &
                     self%unit_of(i))
    end do
  end subroutine find_facts

  !> Print a line for each quantity, after a run that went to its end.
  subroutine print_quantities(self, unit)
    class(quantity_record_type), intent(in) :: self   !< the record
    integer, intent(in) :: unit                       !< Fortran unit to write to
    integer :: i

    if (self%is_empty()) return
    do i = 1, size(self%tracked)
      if (self%is_finished) write (unit, '(a)') self%quantities(i)%name//' = '//to_text(self%numbers(i), 12)//' '//self%unit_of(i)
    end do
  end subroutine print_quantities

  !> The quantities as a list in a report: [{"name": "stroke", "value": 0.6, "unit": "m"}, ...]
  subroutine to_json(self, json)
    class(quantity_record_type), intent(in) :: self   !< the record
    type(json_type), intent(inout) :: json            !< the report, inside its object
    integer :: i

    if (self%is_empty()) return
    call json%begin_array('quantities')
    do i = 1, size(self%tracked)
      call json%begin_object()
      call json%add('name', self%quantities(i)%name)
      call json%add('value', self%numbers(i))
      call json%add('unit', self%unit_of(i))
      call json%end_object()
    end do
    call json%end_array()
  end subroutine to_json
end module mech9_quantity_record
