!> All data sets over the outputs of a run, over its changes of coordinates, and over its events, with their scales.
module mech9_row_layout
  use, intrinsic :: ieee_arithmetic, only: ieee_value, ieee_quiet_nan
  use mech9_kinds, only: wp
  use mech9_text, only: string_type
  use mech9_units, only: units_type
  use mech9_mechanism, only: mechanism_type
  use mech9_result_units, only: impulse_unit_of, inertia_unit_of
  use mech9_columns, only: columns_type
  use mech9_plan, only: plan_type
  use mech9_free_simulation, only: free_simulation_type
  use mech9_data_set_store, only: data_set_store_type
  use mech9_column_sets, only: column_set_list_type, new_column_set
  use mech9_column_layout, only: column_layout_type
  use mech9_scale_layout, only: put_scales
  use mech9_sensitivity_layout, only: add_sensitivities, put_parameters
  implicit none
  private
  public :: list_row_sets, put_row_scales, list_change_sets, put_change_scales, take_changes, write_events, &
    write_coefficients, most_changes

  !> Number of changes of coordinates in a chunk of their data sets.
  integer, parameter :: most_changes = 64

contains

  !> List the data sets over the outputs of a run.
  subroutine list_row_sets(mechanism, columns, list)
    type(mechanism_type), intent(in) :: mechanism             !< the mechanism
    type(columns_type), intent(in) :: columns                 !< columns of the rows
    type(column_set_list_type), intent(out) :: list           !< the data sets
    type(column_layout_type) :: layout

    call list%add(new_column_set('time', [1], [integer ::], 'time', columns%units(1)%text, [character(len=5) ::]))
    call layout%add(list, mechanism, columns)
    if (columns%sensitivities > 0) call add_sensitivities(list, columns)
  end subroutine list_row_sets

  !> Write the scales of these data sets, which have been made, and attach them.
  subroutine put_row_scales(store, mechanism, columns, list)
    class(data_set_store_type), intent(inout) :: store        !< the open storage
    type(mechanism_type), intent(in) :: mechanism             !< the mechanism
    type(columns_type), intent(in) :: columns                 !< columns of the rows
    type(column_set_list_type), intent(in) :: list            !< the data sets over the outputs
    integer :: i

    call put_scales(store, mechanism, columns)
    if (columns%sensitivities > 0) call put_parameters(store, columns)
    do i = 1, list%count
      call list%sets(i)%attach_in(store)
    end do
  end subroutine put_row_scales

  !> List the data sets over the changes of coordinates of a free motion: times at which other coordinates became independent, and their numbers.
  subroutine list_change_sets(n_independent, list)
    integer, intent(in) :: n_independent                      !< how many coordinates are independent
    type(column_set_list_type), intent(out) :: list           !< the data sets
    character(len=27), parameter :: scales(2) = [character(len=27) :: '/coordinate_changes/time', '/coordinate_changes/freedom']
    integer :: i

    call list%add(new_column_set('coordinate_changes/time', [1], [integer ::], 'when other coordinates were taken', 's', &
                                 [character(len=5) ::]))
    call list%add(new_column_set('coordinate_changes/independent', [(1 + i, i=1, n_independent)], [n_independent], &
                                 'the independent coordinates from then on', '1', scales, whole=.true.))
    call list%add(new_column_set('coordinate_changes/replaced', [(1 + n_independent + i, i=1, n_independent)], [n_independent], &
                                 '1 where another angle is integrated in place of this coordinate, near gimbal lock', '1', &
                                 scales, whole=.true.))
  end subroutine list_change_sets

  !> Write the scale of these data sets, which have been made, and attach it.
  subroutine put_change_scales(store, n_independent, list)
    class(data_set_store_type), intent(inout) :: store        !< the open storage
    integer, intent(in) :: n_independent                      !< how many coordinates are independent
    type(column_set_list_type), intent(in) :: list            !< the data sets over the changes
    integer :: i

    call store%put('coordinate_changes/freedom', [(i, i=1, n_independent)], 'number of the degree of freedom')
    call store%make_scale('coordinate_changes/freedom')
    do i = 1, list%count
      call list%sets(i)%attach_in(store)
    end do
  end subroutine put_change_scales

  !> Take the rows of the changes of coordinates of a motion.
  pure subroutine take_changes(simulation, rows)
    type(free_simulation_type), intent(in) :: simulation      !< the motion, as far as it went
    real(wp), allocatable, intent(out) :: rows(:, :)          !< (columns, changes) time, independent coordinates, those replaced
    integer :: n, k, i

    n = size(simulation%motion%system%plan%independent)
    allocate (rows(1 + 2*n, size(simulation%coordinate_changes)), source=0.0_wp)
    do i = 1, size(simulation%coordinate_changes)
      associate (change => simulation%coordinate_changes(i))
        rows(1, i) = change%t
        rows(2:1 + n, i) = real(change%independent, wp)
        do k = 1, n
          if (any(change%replaced == change%independent(k))) rows(1 + n + k, i) = 1.0_wp
        end do
      end associate
    end do
  end subroutine take_changes

  !> Write the events of a motion that has stops; a file without events has none of these data sets.
  subroutine write_events(store, simulation)
    class(data_set_store_type), intent(inout) :: store        !< the open storage
    type(free_simulation_type), intent(in) :: simulation      !< the motion, as far as it went
    type(string_type), allocatable :: kinds(:), groups(:)
    real(wp), allocatable :: impulses(:)
    integer :: i, n

    n = simulation%events%count
    if (n == 0) return
    allocate (kinds(n), groups(n))
    associate (events => simulation%events%items(:n))
      do i = 1, n
        kinds(i)%text = trim(events(i)%kind)
        groups(i)%text = trim(events(i)%group)
      end do
      call store%put('events/time', events%t, 'time of the event', 's')
      call store%make_scale('events/time')
      call store%put('events/kind', kinds, 'impact, close or open')
      call store%put('events/group', groups, 'kind of the group of the data file that the event belongs to')
      call store%put('events/number', events%number, 'number of this group')
      impulses = [(events(i)%impulse/impulse_unit_of(simulation%model%mechanism, trim(events(i)%group), events(i)%number), i=1, n)]
      call store%put('events/impulse', merge(impulses, ieee_value(1.0_wp, ieee_quiet_nan), events%has_impulse), &
                     'impulse on the coordinate, positive while it grows; not a number where there is none', &
                     units_of_impulses(simulation%model%mechanism%units))
    end associate
    call store%attach_scales('events/kind', ['/events/time'])
    call store%attach_scales('events/group', ['/events/time'])
    call store%attach_scales('events/number', ['/events/time'])
    call store%attach_scales('events/impulse', ['/events/time'])
    if (allocated(simulation%impacts)) call write_pair_impulses(store, simulation)
  end subroutine write_events

  !> The units of impulses: N s, N m s.
  pure function units_of_impulses(units) result(text)
    type(units_type), intent(in) :: units   !< of the results
    character(len=len_trim(units%name_of('N s')) + 2 + len_trim(units%name_of('N m s'))) :: text

    text = trim(units%name_of('N s'))//', '//units%name_of('N m s')
  end function units_of_impulses

  !> Write the impulses of pairs at the events.
  subroutine write_pair_impulses(store, simulation)
    class(data_set_store_type), intent(inout) :: store        !< the open storage
    type(free_simulation_type), intent(in) :: simulation      !< the motion, with events
    integer, allocatable :: pairs(:), shown(:)
    real(wp), allocatable :: wrenches(:, :), all(:, :, :)
    integer :: i

    associate (events => simulation%events, units => simulation%model%mechanism%units)
      do i = 1, events%count
        call simulation%impacts%show(events%items(i)%t, shown, wrenches)
        if (size(shown) == 0) cycle
        if (.not. allocated(all)) then
          pairs = shown
          allocate (all(6, size(pairs), events%count), source=ieee_value(1.0_wp, ieee_quiet_nan))
        end if
        if (.not. events%items(i)%has_impulse) cycle
        all(:3, :, i) = wrenches(:3, :)/units%force
        all(4:, :, i) = wrenches(4:, :)/(units%force*units%length)
      end do
    end associate
    if (.not. allocated(all)) return
    call store%put('events/pair', pairs, 'pairs whose impulses are recorded, by their coordinates')
    call store%make_scale('events/pair')
    call store%put('events/pair_impulse', all, 'impulses of force and moment of the pairs; not a number but at impacts', &
                   units_of_impulses(simulation%model%mechanism%units))
    call store%attach_scales('events/pair_impulse', ['/events/time', '/events/pair'])
  end subroutine write_pair_impulses

  !> Write the coefficients of motion at the start.
  subroutine write_coefficients(store, plan, simulation)
    class(data_set_store_type), intent(inout) :: store        !< the open storage
    type(plan_type), intent(in) :: plan                       !< the plan of the mechanism
    type(free_simulation_type), intent(in) :: simulation      !< the motion
    real(wp) :: coefficients(size(plan%independent), size(plan%independent))
    integer :: p, r

    do p = 1, size(plan%independent)
      do r = p, size(plan%independent)
        coefficients(r, p) = simulation%coefficients(r, p) &
                             /inertia_unit_of(simulation%model%mechanism, plan%independent(p), plan%independent(r))
        coefficients(p, r) = coefficients(r, p)
      end do
    end do
    call store%put('dynamics/p', plan%independent, 'number of an independent coordinate at the start')
    call store%make_scale('dynamics/p')
    call store%put('dynamics/r', plan%independent, 'number of an independent coordinate at the start')
    call store%make_scale('dynamics/r')
    call store%put('dynamics/coefficients', coefficients, 'coefficients of motion a(p,r), the mass matrix, at the start')
    call store%attach_scales('dynamics/coefficients', ['/dynamics/p', '/dynamics/r'])
  end subroutine write_coefficients
end module mech9_row_layout
