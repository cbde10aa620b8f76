!> The run of mech9k: following the drives from output to output and writing what is found.
!> Uses the kinematics and output floors, clock, system, progress.
module mech9_kinematic_run
  use mech9_kinds, only: wp
  use mech9_error, only: error_type, raise, add_place, exit_interrupted
  use mech9_text, only: to_text, string_type
  use mech9_clock, only: seconds
  use mech9_mechanism, only: mechanism_type
  use mech9_plan, only: plan_type
  use mech9_state, only: state_type
  use mech9_planning, only: make_plan
  use mech9_tracking, only: tracker_type, start_tracking, advance, set_inputs, largest_closure
  use mech9_columns, only: columns_type, kinematic_columns
  use mech9_table, only: table_type
  use mech9_version, only: version
  use mech9_progress, only: progress_type
  use mech9_system, only: interrupted
  implicit none
  private
  public :: kinematic_outcome_type, assemble_start, run_kinematics

  !> Rows that are computed before they are written together, so that both can be timed without a
  !> clock in the inner loop.
  integer, parameter :: rows_together = 256

  !> What a run did, for its report.
  type :: kinematic_outcome_type
    type(tracker_type) :: tracker
    integer :: rows = 0                      !< computed
    real(wp) :: seconds_solving = 0.0_wp
    real(wp) :: seconds_writing = 0.0_wp
  end type kinematic_outcome_type

contains

  !> Plan and assembled position at the start of the motion.
  subroutine assemble_start(mechanism, plan, state, err)
    type(mechanism_type), intent(in) :: mechanism
    type(plan_type), intent(out) :: plan
    type(state_type), intent(out) :: state
    type(error_type), allocatable, intent(out) :: err
    real(wp), dimension(size(mechanism%pairs)) :: q, dq, ddq

    q = mechanism%initial_position
    call set_inputs(mechanism, mechanism%time%start, q, dq, ddq, err)
    if (allocated(err)) return
    call make_plan(mechanism, q, plan, state, err)
    state%t = mechanism%time%start
  end subroutine assemble_start

  !> Positions, velocities and accelerations at all output times; into the table, unless its path is
  !> empty. When the motion cannot go on, or the user interrupts, what was computed is written first.
  subroutine run_kinematics(mechanism, plan, start, table_path, quiet, outcome, err)
    type(mechanism_type), intent(in) :: mechanism
    type(plan_type), intent(in) :: plan
    type(state_type), intent(in) :: start
    character(len=*), intent(in) :: table_path     !< '-' is standard output; empty: nothing is written
    logical, intent(in) :: quiet
    type(kinematic_outcome_type), intent(out) :: outcome
    type(error_type), allocatable, intent(out) :: err
    type(error_type), allocatable :: stopped
    type(columns_type) :: columns
    type(table_type) :: table
    type(progress_type) :: progress
    real(wp), allocatable :: rows(:, :)
    real(wp) :: clock
    integer :: next, count

    columns = kinematic_columns(mechanism)
    call columns%append('closure', 'm')
    allocate (rows(columns%count, rows_together))
    clock = seconds()
    if (table_path /= '') then
      call table%open(table_path, mechanism%title, 'mech9k '//version, columns%names(:columns%count), &
                      columns%units(:columns%count), err)
      if (allocated(err)) return
    end if
    call progress%start('mech9k', quiet)
    next = 0
    do while (next <= mechanism%time%intervals .and. .not. allocated(stopped))
      call lap(clock, outcome%seconds_writing)
      call compute_rows(mechanism, plan, start, columns, next, outcome%tracker, rows, count, stopped)
      call lap(clock, outcome%seconds_solving)
      outcome%rows = outcome%rows + count
      if (table_path /= '') call write_rows(table, rows(:, :count), err)
      if (allocated(err)) exit
      call progress%update(real(next, wp)/max(1, mechanism%time%intervals))
    end do
    call progress%finish()
    if (table_path /= '') call close_table(table, err)
    call lap(clock, outcome%seconds_writing)
    if (.not. allocated(err)) call move_alloc(stopped, err)
  end subroutine run_kinematics

  !> The next rows, from output number `next` on; fewer than fit where the motion or the run ends.
  subroutine compute_rows(mechanism, plan, start, columns, next, tracker, rows, count, err)
    type(mechanism_type), intent(in) :: mechanism
    type(plan_type), intent(in) :: plan
    type(state_type), intent(in) :: start
    type(columns_type), intent(in) :: columns
    integer, intent(inout) :: next
    type(tracker_type), intent(inout) :: tracker
    real(wp), intent(inout) :: rows(:, :)
    integer, intent(out) :: count
    type(error_type), allocatable, intent(out) :: err
    integer :: used

    count = 0
    do while (count < size(rows, 2) .and. next <= mechanism%time%intervals)
      if (interrupted()) then
        call raise(err, exit_interrupted, 'interrupted before t = '//to_text(mechanism%time%time(next), 10)//' s')
        return
      end if
      if (next == 0) then
        call start_tracking(mechanism, plan, start, mechanism%time%time(next), tracker, err)
      else
        call advance(mechanism, plan, tracker, mechanism%time%time(next), err)
      end if
      if (allocated(err)) return
      count = count + 1
      next = next + 1
      call columns%fill(mechanism, plan, tracker%state, rows(:, count), used)
      rows(used + 1, count) = largest_closure(plan, tracker%state)
    end do
  end subroutine compute_rows

  subroutine write_rows(table, rows, err)
    type(table_type), intent(inout) :: table
    real(wp), intent(in) :: rows(:, :)
    type(error_type), allocatable, intent(out) :: err
    integer :: i

    do i = 1, size(rows, 2)
      call table%write_row(rows(:, i), err)
      if (allocated(err)) return
    end do
  end subroutine write_rows

  !> Close the table; an error that came before is kept.
  subroutine close_table(table, err)
    type(table_type), intent(inout) :: table
    type(error_type), allocatable, intent(inout) :: err
    type(error_type), allocatable :: at_close

    call table%close(at_close)
    if (.not. allocated(err)) call move_alloc(at_close, err)
  end subroutine close_table

  !> Add the time since `clock` to a sum and set the clock.
  subroutine lap(clock, sum)
    real(wp), intent(inout) :: clock, sum
    real(wp) :: now

    now = seconds()
    sum = sum + (now - clock)
    clock = now
  end subroutine lap
end module mech9_kinematic_run
