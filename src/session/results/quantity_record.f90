!> The quantities of a run: their columns, the times between outputs that they need, and their numbers at its end.
module mech9_quantity_record
  use, intrinsic :: ieee_arithmetic, only: ieee_value, ieee_quiet_nan, ieee_is_nan
  use mech9_kinds, only: wp
  use mech9_text, only: to_text, string_type
  use mech9_error, only: error_type, raise, exit_data
  use mech9_quantity, only: quantity_type
  use mech9_model, only: model_type
  use mech9_tangent, only: tangent_type
  use mech9_tracked_quantity, only: tracked_quantity_type
  use mech9_quantity_pieces, only: quantity_pieces_type
  use mech9_columns, only: columns_type
  use mech9_missing_column, only: remedy_of_missing
  use mech9_facts, only: facts_type
  use mech9_json, only: json_type
  use mech9_hdf5_file, only: hdf5_file_type
  implicit none
  private
  public :: quantity_record_type

  type :: quantity_record_type
    type(quantity_type), allocatable :: quantities(:)
    type(tracked_quantity_type), allocatable :: tracked(:)
    real(wp), allocatable :: numbers(:)                      !< NaN before the end of the run
    real(wp), allocatable :: gradient(:, :)                  !< (P,quantities) derivatives of the numbers by the parameters, if the
                                                             !< run has them; NaN before its end and where there is none
    logical, private :: is_finished = .false.                !< the numbers are known
    type(columns_type), private :: columns
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
    procedure :: finish
    procedure :: unit_of
    procedure :: find_facts
    procedure :: print => print_quantities
    procedure :: to_json
    procedure :: to_hdf5
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
    do i = 1, n
      associate (quantity => self%quantities(i), tracked => self%tracked(i))
        tracked%take = quantity%take
        tracked%at = quantity%at
        call find_column(quantity, model, columns, tracked%column, err)
        if (allocated(err)) return
        call columns%family_of(tracked%column, tracked%family, tracked%order)
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
    call self%pieces%times_before(model, self%tracked, previous, t, times)
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
  subroutine take_between(self, model, row, next)
    class(quantity_record_type), intent(inout) :: self  !< the record, which has taken all rows before this one
    type(model_type), intent(in) :: model               !< the model
    real(wp), intent(in) :: row(:)                      !< numbers of the row, time first
    real(wp), intent(in) :: next                        !< time of the next output [s]

    call take_times(self, row)
    call self%pieces%take_between(model, self%tracked, row, next)
  end subroutine take_between

  !> Take the row of an output.
  subroutine take_output(self, model, row)
    class(quantity_record_type), intent(inout) :: self  !< the record
    type(model_type), intent(in) :: model               !< the model
    real(wp), intent(in) :: row(:)                      !< numbers of the output, time first
    integer :: i

    do i = 1, size(self%tracked)
      call self%tracked(i)%take_output(row)
    end do
    call take_times(self, row)
    call self%pieces%take_output(model, self%tracked, row)
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

  !> Write the quantities to the HDF5 file, with their derivatives by the parameters: before the run, when they are NaN, and again
  !> after it.
  subroutine to_hdf5(self, file, again)
    class(quantity_record_type), intent(in) :: self   !< the record
    type(hdf5_file_type), intent(inout) :: file       !< the open file
    logical, intent(in) :: again                      !< the file has them already, and they are written over
    type(facts_type) :: facts
    type(string_type) :: names(size(self%quantities))
    integer :: i

    call self%find_facts(facts)
    call facts%to_hdf5(file, 'quantities', again)
    if (.not. self%has_gradient()) return
    if (.not. again) then
      do i = 1, size(names)
        names(i)%text = self%quantities(i)%name
      end do
      call file%put('quantity', names, 'name of the quantity')
      call file%make_scale('quantity')
      if (self%columns%sensitivities == 0) then
        call file%put('parameter', self%columns%parameters, 'name of the parameter')
        call file%make_scale('parameter')
      end if
    end if
    call file%put('quantities/gradient', self%gradient, 'derivatives of the quantities by the parameters', &
                  'unit of the quantity per unit of the parameter in the data file')
    if (.not. again) call file%attach_scales('quantities/gradient', ['/quantity ', '/parameter'])
  end subroutine to_hdf5

  !> Print a line for each quantity, and for each of its derivatives, after a run that went to its end.
  subroutine print_quantities(self, unit)
    class(quantity_record_type), intent(in) :: self   !< the record
    integer, intent(in) :: unit                       !< Fortran unit to write to
    character(len=:), allocatable :: per_parameter
    integer :: i, p

    if (self%is_empty() .or. .not. self%is_finished) return
    do i = 1, size(self%tracked)
      associate (name => self%quantities(i)%name)
        write (unit, '(a)') name//' = '//to_text(self%numbers(i), 12)//' '//self%unit_of(i)
        do p = 1, size(self%gradient, 1)
          if (ieee_is_nan(self%gradient(p, i))) then
            write (unit, '(a)') '  d('//name//')/d('//self%columns%parameters(p)%text//') is not known'
          else
            call self%columns%find_unit_per(self%unit_of(i), p, per_parameter)
            write (unit, '(a)') '  d('//name//')/d('//self%columns%parameters(p)%text//') = '//to_text(self%gradient(p, i), 12)// &
              ' '//per_parameter
          end if
        end do
      end associate
    end do
  end subroutine print_quantities

  !> The quantities as a list in a report:
  !> [{"name": "stroke", "value": 0.6, "unit": "m", "gradient": [{"parameter": "crank", "value": 2.0}]}, ...]
  subroutine to_json(self, json)
    class(quantity_record_type), intent(in) :: self   !< the record
    type(json_type), intent(inout) :: json            !< the report, inside its object
    integer :: i, p

    if (self%is_empty()) return
    call json%begin_array('quantities')
    do i = 1, size(self%tracked)
      call json%begin_object()
      call json%add('name', self%quantities(i)%name)
      call json%add('value', self%numbers(i))
      call json%add('unit', self%unit_of(i))
      if (self%has_gradient()) call json%begin_array('gradient')
      do p = 1, size(self%gradient, 1)
        call json%begin_object()
        call json%add('parameter', self%columns%parameters(p)%text)
        call json%add('value', self%gradient(p, i))
        call json%end_object()
      end do
      if (self%has_gradient()) call json%end_array()
      call json%end_object()
    end do
    call json%end_array()
  end subroutine to_json
end module mech9_quantity_record
