!> Rows of results from a simulation: a row of numbers for each output time.
module mech9_row_source
  use mech9_kinds, only: wp
  use mech9_error, only: error_type
  use mech9_text, only: string_type
  use mech9_failure_units, only: tell_in_units
  use mech9_variable_model, only: variable_model_type
  use mech9_plan, only: plan_type
  use mech9_state, only: state_type
  use mech9_simulation, only: simulation_type, interruption_type, standing_type
  use mech9_batch_products, only: batch_size
  use mech9_tangent, only: tangent_type, find_tangent
  use mech9_smooth_pieces, only: have_joints
  use mech9_sensitivity, only: sensitivity_type, find_waiting
  use mech9_columns, only: columns_type
  use mech9_run_columns, only: find_columns, find_section
  use mech9_contact_columns, only: fill_contacts
  use mech9_result_units, only: name_parameters
  use mech9_applied_forces, only: applied_forces_type
  use mech9_touching_forces, only: touching_forces_type
  use mech9_film, only: film_type
  use mech9_masks, only: numbers_of
  use mech9_force_record, only: force_record_type, reacting_pairs
  use mech9_link_record, only: link_record_type
  use mech9_impact_record, only: impact_record_type, new_impact_record
  use mech9_varied_record, only: varied_record_type
  use mech9_quantity_record, only: quantity_record_type
  use mech9_piece_walk, only: piece_walk_type, walk_done, walk_look, walk_stride, walk_leave, walk_pass
  use mech9_smooth_pieces, only: smooth_piece_type
  use mech9_section_record, only: section_record_type, row_filler_type
  implicit none
  private
  public :: row_source_type, new_row_source

  type, extends(row_filler_type) :: row_source_type
    class(simulation_type), pointer, private :: simulation => null()   !< not owned
    type(columns_type) :: columns
    type(force_record_type) :: forces      !< computes the forces that are recorded
    type(link_record_type) :: links        !< computes the motion of links that is recorded
    class(sensitivity_type), allocatable :: sensitivity  !< finds derivatives by parameters, where it is allocated
    type(varied_record_type) :: varied     !< finds those of forces and energies
    type(film_type), allocatable :: film   !< takes the position of each row, where it is allocated
    type(applied_forces_type) :: applied   !< loads and weights, where the film keeps forces
    type(touching_forces_type) :: touching   !< forces of stops, frictions and contacts, where the film keeps forces
    type(quantity_record_type) :: quantities   !< of the whole run
    class(section_record_type), allocatable :: section   !< takes the points of a section, where it is allocated
    type(tangent_type), allocatable, private :: tangents(:)   !< (P) of the constants, where quantities need those of joints of laws
    class(interruption_type), pointer :: interruption => null()   !< stops the motion, which may go on then; not owned
    integer, private :: waiting = 0                !< rows that wait for their derivatives, in the order of time
    integer, private :: outputs = 0                !< how many of them are outputs
    logical, private :: is_output(batch_size) = .true.   !< each of them is an output, not a row between two outputs
    real(wp), private :: next_output(batch_size) = 0.0_wp   !< time of each output, or of the output after each row between [s]
    integer, private :: visited = 0                !< times after the last output that were visited
    real(wp), private :: last_output = 0.0_wp      !< time of the output that was reached last [s]
    real(wp), allocatable, private :: between(:, :)      !< (width,batch) rows between two outputs
    type(piece_walk_type), private :: walk               !< the way of quantities through a motion with events
    integer, allocatable, private :: wanted(:)           !< columns whose derivatives are wanted at outputs
    integer, allocatable, private :: wanted_between(:)   !< columns whose derivatives quantities need between outputs
  contains
    procedure :: begin_quantities
    procedure :: begin_section
    procedure :: fill_values
    procedure :: width => width_of_rows
    procedure :: add_row
    procedure :: complete
    procedure :: standing
    procedure :: row_at
    procedure :: go_through
    procedure :: add_sensitivities
    procedure :: show_forces
  end type row_source_type

contains

  !> The rows of a simulation, which must have the target attribute and outlive them.
  subroutine new_row_source(simulation, source)
    class(simulation_type), intent(inout), target :: simulation    !< made, and not started
    type(row_source_type), intent(out) :: source                   !< its rows
    type(impact_record_type) :: impacts

    source%simulation => simulation
    call find_columns(simulation%model, simulation%with_energies, simulation%with_error, source%columns, source%forces, &
                      source%links)
    associate (model => simulation%model)
      if (.not. (model%request%output%reactions .and. model%mechanism%has_rigid_ends())) return
      call new_impact_record(model, numbers_of(reacting_pairs(model)), impacts)
      allocate (simulation%impacts, source=impacts)
    end associate
  end subroutine new_row_source

  !> Add the derivatives of the motion by the parameters of the model, after all other columns: those of the results, or, where the
  !> gradients of quantities alone are requested, those that no file gets. Fails where they do not exist.
  subroutine add_sensitivities(self, variable, err)
    class(row_source_type), intent(inout) :: self                   !< the row source
    class(variable_model_type), intent(inout), target :: variable   !< the model as a function of its parameters; outlives the run
    type(error_type), allocatable, intent(out) :: err               !< allocated if it failed
    type(string_type), allocatable :: names(:), units(:)
    integer :: i

    associate (model => self%simulation%model)
      call name_parameters(model%mechanism, model%parameters, names, units)
    end associate
    allocate (self%sensitivity)
    call self%simulation%begin_sensitivity(variable, self%columns%derivatives, self%sensitivity, err)
    if (allocated(err)) return
    call self%columns%append_sensitivities(names, units, self%simulation%model%request%output%sensitivities)
    self%wanted = [(i, i=2, self%columns%motion)]
    call self%varied%begin(self%simulation, variable, self%columns, err)
    if (.not. allocated(err) .and. allocated(self%simulation%model%request%quantities)) call find_tangents(self, variable, err)
  end subroutine add_sensitivities

  !> Find the derivatives of the constants of the model, if laws have joints: the times of these may depend on parameters.
  subroutine find_tangents(self, variable, err)
    type(row_source_type), intent(inout) :: self              !< the row source
    class(variable_model_type), intent(inout) :: variable     !< the model as a function of its parameters
    type(error_type), allocatable, intent(out) :: err         !< allocated if it failed
    type(plan_type), pointer :: plan
    type(state_type), pointer :: state
    integer :: i

    if (.not. have_joints(self%simulation%model)) return
    call self%simulation%present(plan, state)
    allocate (self%tangents(size(self%simulation%model%parameters)))
    do i = 1, size(self%tangents)
      call find_tangent(variable, self%simulation%model, plan, i, self%tangents(i), err)
      if (allocated(err)) return
    end do
  end subroutine find_tangents

  !> Find the columns of the quantities that the model requests. Fails with exit_data where one is not recorded.
  subroutine begin_quantities(self, err)
    class(row_source_type), intent(inout) :: self       !< the row source
    type(error_type), allocatable, intent(out) :: err   !< allocated if it failed

    if (.not. allocated(self%simulation%model%request%quantities)) return
    call self%quantities%begin(self%simulation%model, self%columns, err)
    if (allocated(err)) return
    call self%quantities%begin_pieces(self%simulation%model, self%tangents)
    self%walk%is_needed = self%simulation%may_jump() .and. self%quantities%has_parts()
    allocate (self%between(self%columns%width(), batch_size), source=0.0_wp)
    associate (needed => self%quantities%columns_with_gradients())
      self%wanted_between = pack(needed, needed <= self%columns%motion)
    end associate
    if (self%columns%sensitivities == 0) self%wanted = self%wanted_between
  end subroutine begin_quantities

  !> Take the points of the section that the model requests, if it requests one. Fails with exit_data where its column is not recorded.
  subroutine begin_section(self, err)
    class(row_source_type), intent(inout) :: self       !< the row source, before the start
    type(error_type), allocatable, intent(out) :: err   !< allocated if it failed

    if (.not. self%simulation%model%request%section%is_wanted) return
    call find_section(self%simulation%model, self%columns, self%simulation%with_error, self%section, err)
  end subroutine begin_section

  !> Add the points of the section up to a time, or make one stride towards it.
  subroutine go_on_with_section(self, t, err, at_joint)
    type(row_source_type), intent(inout), target :: self      !< the row source
    real(wp), intent(in) :: t                                 !< the time [s]
    type(error_type), allocatable, intent(out) :: err         !< allocated if it failed
    logical, intent(out), optional :: at_joint                !< present: make one stride; rates may jump at its end
    class(section_record_type), allocatable :: section
    class(simulation_type), pointer :: simulation
    real(wp) :: from, to

    if (present(at_joint) .and. .not. allocated(self%section)) then
      to = self%simulation%end_of_stride(t)
      call self%simulation%stride(t, from, to, at_joint, err)
      call tell_in_units(err, self%simulation%model%mechanism)
    end if
    if (.not. allocated(self%section)) return
    ! the section and who fills its rows are two
    call move_alloc(self%section, section)
    simulation => self%simulation
    call section%go_on(simulation, self, t, err, at_joint)
    call move_alloc(section, self%section)
  end subroutine go_on_with_section

  !> Go on to output time t. Its row follows those that are complete, and those that wait for their derivatives: these are found for
  !> many rows at once. Output times come in order, the first one is the start. Quantities take what they need on the way. After a
  !> failure no row waits: those before the failure are complete. A pause is a failure after which the same output may be asked for again.
  subroutine add_row(self, t, rows, count, err)
    class(row_source_type), intent(inout) :: self             !< the row source
    real(wp), intent(in) :: t                                 !< output time [s]
    real(wp), intent(inout), contiguous :: rows(:, :)         !< (columns%width(),rows) in the units of the results
    integer, intent(inout) :: count                           !< number of complete rows; grows where rows become complete
    type(error_type), allocatable, intent(out) :: err         !< allocated if it failed
    type(error_type), allocatable :: earlier

    if (self%simulation%started) then
      if (self%walk%is_needed) then
        call visit_parts(self, t, err)
      else if (.not. self%quantities%is_empty()) then
        call visit_between(self, t, rows, count, err)
      end if
      if (.not. allocated(err)) call go_on_with_section(self, t, err)
      if (.not. allocated(err)) call self%simulation%advance(t, err)
    else if (associated(self%interruption)) then
      call self%simulation%start(err, self%interruption)
      if (.not. allocated(err)) call go_on_with_section(self, t, err)
    else
      call self%simulation%start(err)
      if (.not. allocated(err)) call go_on_with_section(self, t, err)
    end if
    if (.not. allocated(err)) call fill_row(self, rows(:, count + self%outputs + 1), err)
    if (.not. allocated(err) .and. allocated(self%film)) call film_row(self, rows(:, count + self%outputs + 1), err)
    if (.not. allocated(err)) then
      self%last_output = t
      self%visited = 0
      call self%walk%reach_output()
      if (.not. allocated(self%sensitivity) .and. self%quantities%is_empty()) then
        count = count + 1
        return
      end if
      self%outputs = self%outputs + 1
      call defer(self, .true., t, rows, count, err)
      return
    end if
    ! positions before this one may fail, too
    call self%complete(rows, count, earlier)
    if (allocated(earlier)) call move_alloc(earlier, err)
  end subroutine add_row

  !> The place of the motion.
  type(standing_type) function standing(self)
    class(row_source_type), intent(inout) :: self       !< the row source

    standing = self%simulation%standing()
  end function standing

  !> Go on to output time t and give its row.
  subroutine row_at(self, t, row, err)
    class(row_source_type), intent(inout) :: self       !< the row source; no row waits
    real(wp), intent(in) :: t                           !< output time [s]
    real(wp), intent(inout) :: row(:)                   !< (columns%width()) in the units of the results
    type(error_type), allocatable, intent(out) :: err   !< allocated if it failed
    real(wp), allocatable :: rows(:, :)
    integer :: count

    allocate (rows(size(row), 1))
    count = 0
    call self%add_row(t, rows, count, err)
    if (.not. allocated(err)) call self%complete(rows, count, err)
    row = rows(:, 1)
  end subroutine row_at

  !> Go through all outputs of the run, for its quantities, and for the numbers of its columns where these are wanted.
  subroutine go_through(self, err, numbers)
    class(row_source_type), intent(inout) :: self              !< the row source, before the start
    type(error_type), allocatable, intent(out) :: err          !< allocated if it failed
    real(wp), allocatable, intent(inout), optional :: numbers(:, :)   !< (columns,outputs) gets the columns of all outputs that
                                                               !< are reached, where it is allocated
    real(wp), allocatable :: rows(:, :)
    integer :: i, first, last, count
    logical :: wanted

    wanted = .false.
    if (present(numbers)) wanted = allocated(numbers)
    allocate (rows(self%columns%width(), batch_size))
    associate (time => self%simulation%model%request%time)
      do first = 0, time%intervals, batch_size
        count = 0
        last = min(first + batch_size - 1, time%intervals)
        do i = first, last
          call self%add_row(time%time(i), rows, count, err)
          if (allocated(err)) exit
        end do
        if (.not. allocated(err)) call self%complete(rows, count, err)
        if (wanted) then
          ! a parameter that sets the accuracy may add or take away the last column
          associate (n => min(size(rows, 1), size(numbers, 1)))
            numbers(:n, first + 1:first + count) = rows(:n, :count)
          end associate
        end if
        if (allocated(err)) return
      end do
    end associate
  end subroutine go_through

  !> Visit the times before an output at which quantities need rows.
  subroutine visit_between(self, t, rows, count, err)
    type(row_source_type), intent(inout) :: self              !< the row source
    real(wp), intent(in) :: t                                 !< time of the next output [s]
    real(wp), intent(inout), contiguous :: rows(:, :)         !< (columns%width(),rows) rows of outputs
    integer, intent(inout) :: count                           !< number of complete rows
    type(error_type), allocatable, intent(out) :: err         !< allocated if it failed
    real(wp), allocatable :: times(:)
    integer :: i

    call self%quantities%times_before(self%simulation%model, self%last_output, t, times)
    do i = self%visited + 1, size(times)
      call go_on_with_section(self, times(i), err)
      if (.not. allocated(err)) call self%simulation%visit(times(i), .false., err)
      if (.not. allocated(err)) self%visited = i
      if (.not. allocated(err)) call fill_row(self, self%between(:, self%waiting + 1), err)
      if (.not. allocated(err)) call defer(self, .false., t, rows, count, err)
      if (allocated(err)) return
    end do
  end subroutine visit_between

  !> Visit the times before an output at which quantities need rows in a motion with events: no row waits for its derivatives.
  subroutine visit_parts(self, t, err)
    type(row_source_type), intent(inout), target :: self      !< the row source
    real(wp), intent(in) :: t                                 !< time of the output [s]
    type(error_type), allocatable, intent(out) :: err         !< allocated if it failed
    type(smooth_piece_type), allocatable :: parts(:)
    integer :: action
    logical :: at_joint

    do
      call self%walk%choose(self%simulation%model, self%quantities, [self%last_output, t], &
                            self%simulation%end_of_stride(self%last_output), self%simulation%events%count, action)
      select case (action)
      case (walk_stride)
        call go_on_with_section(self, t, err, at_joint)
        if (.not. allocated(err)) call self%walk%note_stride(self%simulation%end_of_stride(self%last_output), at_joint, &
                                                             self%simulation%events%count)
      case (walk_leave)
        call self%simulation%leave_joint(err)
        if (.not. allocated(err)) call self%walk%note_leaving(self%simulation%events%count)
      case (walk_look)
        call self%simulation%visit(self%walk%time, .true., err)
        if (.not. allocated(err)) call fill_between(self, 1, err)
        if (.not. allocated(err)) call self%walk%take(self%quantities, self%between(:, 1), self%simulation%events)
      case (walk_pass)
        call pass_event(self, err)
      case (walk_done)
        exit
      end select
      if (allocated(err)) return
    end do
    call self%walk%open_part(parts)
    call self%quantities%leave_open(parts)
  end subroutine visit_parts

  !> Take rows on both sides of the event at which the motion stands.
  subroutine pass_event(self, err)
    type(row_source_type), intent(inout) :: self              !< the row source
    type(error_type), allocatable, intent(out) :: err         !< allocated if it failed
    type(smooth_piece_type) :: part
    integer :: jump

    associate (simulation => self%simulation, t => self%walk%time, before => self%between(:, 1), behind => self%between(:, 2))
      call simulation%look_at(t, err)
      if (.not. allocated(err)) call simulation%note_numbers()
      if (.not. allocated(err)) call fill_between(self, 1, err)
      if (allocated(err)) return
      call self%walk%part_before([(0.0_wp, jump=1, size(self%quantities%gradient, 1))], part)
      jump = self%quantities%first_jump(part, simulation%events)
      call go_on_with_section(self, t, err)
      if (.not. allocated(err)) call simulation%leave_joint(err)
      if (.not. allocated(err)) call simulation%look_at(t, err)
      if (.not. allocated(err)) call simulation%note_numbers()
      if (.not. allocated(err)) call fill_between(self, 2, err)
      if (allocated(err)) return
      if (allocated(simulation%events%time_rates)) part%to_rate = simulation%events%time_rates
      call self%quantities%close_part(before, part, jump, simulation%events)
      call self%quantities%begin_part(behind, part%to_rate, simulation%events)
      call self%walk%note_passing(simulation%events%count)
      call self%walk%part_behind(part%to_rate)
    end associate
  end subroutine pass_event

  !> Fill a row between two outputs with the numbers of the present position, and with its derivatives where quantities need them.
  subroutine fill_between(self, place, err)
    type(row_source_type), intent(inout) :: self              !< the row source; no row waits
    integer, intent(in) :: place                              !< number of the row
    type(error_type), allocatable, intent(out) :: err         !< allocated if it failed
    integer :: good

    call fill_row(self, self%between(:, place), err)
    if (allocated(err) .or. .not. allocated(self%sensitivity)) return
    call find_waiting(self%simulation%model, self%sensitivity, good, err)
    if (.not. allocated(err)) call self%columns%fill_sensitivities(self%sensitivity%changes, 1, 1, self%wanted_between, &
                                                                   self%between(:, place:place))
  end subroutine fill_between

  !> Let a row wait for its derivatives, until enough of them wait. Rows without derivatives do not wait.
  subroutine defer(self, is_output, t, rows, count, err)
    type(row_source_type), intent(inout) :: self              !< the row source
    logical, intent(in) :: is_output                          !< the row is an output
    real(wp), intent(in) :: t                                 !< time of this output, or of the next one [s]
    real(wp), intent(inout), contiguous :: rows(:, :)         !< (columns%width(),rows) rows of outputs
    integer, intent(inout) :: count                           !< number of complete rows; grows where rows become complete
    type(error_type), allocatable, intent(out) :: err         !< allocated if it failed

    self%waiting = self%waiting + 1
    self%is_output(self%waiting) = is_output
    self%next_output(self%waiting) = t
    if (allocated(self%sensitivity)) then
      if (self%waiting < self%sensitivity%at_once .and. .not. allocated(self%film)) return
    end if
    call self%complete(rows, count, err)
  end subroutine defer

  !> Complete all rows that wait for their derivatives, as far as these exist.
  subroutine complete(self, rows, count, err)
    class(row_source_type), intent(inout) :: self             !< the row source
    real(wp), intent(inout), contiguous :: rows(:, :)         !< (columns%width(),rows) rows of outputs
    integer, intent(inout) :: count                           !< number of complete rows; grows
    type(error_type), allocatable, intent(out) :: err         !< allocated if it failed
    integer :: good, first, last

    good = self%waiting
    if (allocated(self%sensitivity)) call find_waiting(self%simulation%model, self%sensitivity, good, err)
    if (allocated(err)) call self%simulation%return_to_counts(good + 1)
    ! a position whose row failed has derivatives of no use
    good = min(good, self%waiting)
    first = 1
    do while (first <= good)
      last = first
      if (self%is_output(first)) then
        do while (last < good)
          if (.not. self%is_output(last + 1)) exit
          last = last + 1
        end do
        call complete_outputs(self, first, rows(:, count + 1:count + last - first + 1))
        count = count + last - first + 1
      else
        if (allocated(self%sensitivity)) call self%columns%fill_sensitivities(self%sensitivity%changes, first, 1, &
                                                                              self%wanted_between, self%between(:, first:first))
        call self%quantities%take_between(self%simulation%model, self%between(:, first), self%next_output(first), &
                                          self%simulation%events)
      end if
      first = last + 1
    end do
    self%waiting = 0
    self%outputs = 0
  end subroutine complete

  !> Complete the rows of outputs that follow each other.
  subroutine complete_outputs(self, first, rows)
    type(row_source_type), intent(inout) :: self              !< the row source
    integer, intent(in) :: first                              !< number of the first of them among those that wait
    real(wp), intent(inout), contiguous :: rows(:, :)         !< (columns%width(),rows) these rows
    integer :: i

    if (allocated(self%sensitivity)) &
      call self%columns%fill_sensitivities(self%sensitivity%changes, first, size(rows, 2), self%wanted, rows)
    if (self%quantities%is_empty()) return
    do i = 1, size(rows, 2)
      call self%quantities%take_output(self%simulation%model, rows(:, i), self%simulation%events)
    end do
  end subroutine complete_outputs

  !> Number of columns of a row.
  integer function width_of_rows(self)
    class(row_source_type), intent(in) :: self   !< the row source

    width_of_rows = self%columns%width()
  end function width_of_rows

  !> Fill a row with the numbers of the present position, but for derivatives by parameters.
  subroutine fill_values(self, row, err)
    class(row_source_type), intent(inout) :: self       !< the row source
    real(wp), intent(inout), contiguous :: row(:)       !< (columns%width()) in the units of the results
    type(error_type), allocatable, intent(out) :: err   !< allocated if it failed
    type(plan_type), pointer :: plan, force_plan
    type(state_type), pointer :: state, force_state
    integer :: next

    call self%simulation%present(plan, state)
    call self%columns%fill(self%simulation%model%mechanism, plan, state, row)
    call self%columns%fill_poses(plan, state, row)
    if (self%forces%wanted) then
      call self%simulation%present_for_forces(force_plan, force_state)
      call self%forces%find(self%simulation, force_plan, force_state, err)
      if (allocated(err)) return
      call self%forces%fill(self%columns, self%simulation%model%mechanism, force_plan, force_state, row)
    end if
    call self%columns%fill_motors(self%simulation%model%mechanism, plan, state, row, err)
    if (allocated(err)) return
    next = self%columns%motion + self%columns%forces() + self%columns%motors
    associate (simulation => self%simulation)
      if (simulation%with_energies) then
        row(next + 1) = simulation%kinetic_energy
        row(next + 2) = simulation%potential_energy
        row(next + 3) = simulation%kinetic_energy + simulation%potential_energy
      end if
      call self%links%fill(plan, state, row)
      call self%columns%fill_stops(simulation%model%mechanism, state, row)
      call self%columns%fill_frictions(simulation%model%mechanism, state, row)
      call fill_contacts(self%columns, simulation%model%mechanism, plan, state, row)
      next = self%columns%before_stops() + self%columns%stops + self%columns%frictions + self%columns%contacts + 1
      row(next) = simulation%closure
      if (simulation%with_conditioning) then
        next = next + 1
        row(next) = simulation%least_conditioning
      end if
      if (simulation%with_error) row(next + 1) = simulation%error
    end associate
    call self%columns%convert(row)
  end subroutine fill_values

  !> Fill a row with the numbers of the present position; its derivatives by parameters may wait.
  subroutine fill_row(self, row, err)
    class(row_source_type), intent(inout) :: self       !< the row source
    real(wp), intent(inout), contiguous :: row(:)       !< (columns%width()) in the units of the results
    type(error_type), allocatable, intent(out) :: err   !< allocated if it failed

    call self%fill_values(row, err)
    if (allocated(err)) return
    if (allocated(self%sensitivity)) then
      call self%simulation%show_sensitivity(self%sensitivity, err)
      if (allocated(err)) return
      if (self%sensitivity%waiting > 0) call self%simulation%keep_counts(self%sensitivity%waiting)
      if (.not. self%varied%wanted) return
      call self%varied%find(self%simulation, self%columns, self%forces, self%links, err)
      if (allocated(err)) return
      call self%columns%fill_beyond_motion(self%varied%values, row)
      if (size(self%varied%poses) > 0) call self%columns%fill_varied_poses(self%varied%poses, row)
    end if
  end subroutine fill_row

  !> Show the film the present position, its row and its forces. Fails where a load fails.
  subroutine film_row(self, row, err)
    class(row_source_type), intent(inout) :: self       !< the row source, with a film
    real(wp), intent(in) :: row(:)                      !< numbers of the row
    type(error_type), allocatable, intent(out) :: err   !< allocated if it failed
    type(plan_type), pointer :: plan
    type(state_type), pointer :: state
    type(film_type), allocatable :: film
    logical :: kept

    ! the film and who shows it forces are two
    call move_alloc(self%film, film)
    call self%simulation%present(plan, state)
    associate (mechanism => self%simulation%model%mechanism)
      call film%note_contacts(mechanism, self%simulation%events, state%t)
      kept = film%keeps_next()
      call film%take(mechanism, plan, state, row)
    end associate
    if (kept) call self%show_forces(film, err)
    call move_alloc(film, self%film)
  end subroutine film_row

  !> Show a film the forces of the present position, which is its latest frame, if it keeps forces. Fails where a load fails.
  subroutine show_forces(self, film, err)
    class(row_source_type), intent(inout) :: self       !< the row source, with the forces of its latest row
    type(film_type), intent(inout) :: film              !< the film
    type(error_type), allocatable, intent(out) :: err   !< allocated if it failed
    type(plan_type), pointer :: plan
    type(state_type), pointer :: state
    real(wp), allocatable :: vectors(:, :), touching(:, :), feet(:, :)

    if (.not. allocated(film%forces)) return
    allocate (touching(3, size(film%touching)), feet(3, size(film%touching)))
    call self%simulation%present(plan, state)
    call self%touching%find(self%simulation%model%mechanism, plan, state, touching, feet)
    call self%simulation%present_for_forces(plan, state)
    allocate (vectors(3, size(film%applied)))
    call self%applied%find(self%simulation%model%mechanism, plan, state, vectors, err)
    if (.not. allocated(err)) &
      call film%take_forces(self%forces%reactions%force, self%forces%reactions%moment, vectors, touching, feet)
  end subroutine show_forces
end module mech9_row_source
