!> Runs of a study side by side: the quantities of planar driven motions of several designs at once (mech9_lane_group).
!>
!> Each design is assembled as if it were alone. Its positions are then found beside those of others, from output to output. A design that
!> comes near a singular position, that would need a shorter step, or that has another structure than the rest is left out: its run is to
!> be made alone. The quantities are of coordinates and points, followed by the polynomials of mech9_tracked_quantity.
module mech9_lane_runs
  use mech9_kinds, only: wp
  use mech9_tolerances, only: longest_drive
  use mech9_error, only: error_type
  use mech9_processor, only: vector_bits
  use mech9_pose, only: transformed
  use mech9_law, only: law_type
  use mech9_model, only: model_type
  use mech9_program_kind, only: dynamics
  use mech9_plan, only: plan_type
  use mech9_state, only: state_type
  use mech9_requested, only: requested_type, requested_by_results, leave_out_unrequested
  use mech9_smooth_pieces, only: have_joints
  use mech9_chebyshev, only: chebyshev_type, new_chebyshev
  use mech9_closure_guard, only: closes_well
  use mech9_simulation, only: interruption_type
  use mech9_explained_assembly, only: assemble_model
  use mech9_tracked_quantity, only: tracked_quantity_type, outputs_about
  use mech9_quantity_record, only: quantity_record_type
  use mech9_quantity_pieces, only: points_between
  use mech9_design_run, only: find_quantities
  use mech9_lane_tolerances, only: closed
  use mech9_lane_group, only: lane_group_type, lanes, is_plain, new_lane_group, fits_lanes, fill_lane, renew_lane, copy_lane
  use mech9_lane_starts, only: lane_starts_type
  use mech9_lane_motion, only: begin_group, go_on_with_group, find_point, keep_column
  implicit none
  private
  public :: lane_runs_type, lane_failure_type

  !> The failure of a design that could not be assembled.
  type :: lane_failure_type
    type(error_type), allocatable :: err   !< not allocated: it did not fail in this way
  end type lane_failure_type

  !> The source of the column of a quantity.
  type :: column_source_type
    integer :: step = 0                    !< step whose coordinate it is of; 0: it is of a point
    integer :: coordinate = 0              !< this coordinate
    integer :: point = 0                   !< number of the point
    integer :: component = 0               !< 1, 2 or 3 of its position
    integer :: frame = 0                   !< first frame of its link
    real(wp) :: factors(0:2) = 1.0_wp      !< from the program's units to numbers whose derivatives by time are the next ones
    real(wp) :: place(lanes, 3) = 0.0_wp   !< the point in this frame [m]
    real(wp) :: axis(lanes, 3) = 0.0_wp    !< the direction of its component in the plane's axes
    real(wp) :: origin(lanes) = 0.0_wp     !< component of the origin of frame 0 [m]
  end type column_source_type

  !> All that groups of runs share, and room for one group.
  type :: lane_runs_type
    logical :: used = .false.                                        !< runs of this study can be made side by side
    integer :: bits = 128                                            !< of the vector registers
    integer :: made = 0                                              !< runs that were made
    type(model_type), allocatable, private :: model                  !< with the values of the data file
    type(lane_starts_type), private :: starts                        !< of designs with the plan of the data file's design
    type(requested_type), private :: requested                       !< the part of the motion that quantities need
    type(chebyshev_type), private :: rule                            !< points between outputs
    type(tracked_quantity_type), allocatable, private :: tracked(:)  !< the quantities, at their beginning
    type(column_source_type), allocatable, private :: sources(:)     !< (quantities) of their columns
    type(lane_group_type), private :: group                          !< the present group, of the structure of the data file's design
    real(wp), allocatable, private :: t(:)                           !< (0:intervals) times of the outputs [s]
    real(wp), allocatable, private :: drives(:, :, :)                !< (4,0:intervals,drives) motion of the data file's drives at the
                                                                     !< outputs, and a bound of the way in the step to them
    real(wp), allocatable, private :: series(:, :, :, :)             !< (lanes,0:2,0:intervals,quantities) columns of quantities
    real(wp), allocatable, private :: range(:, :, :)                 !< (lanes,2,quantities) least and largest number
    integer, allocatable, private :: turning(:, :, :)                !< (intervals,quantities,lanes) first intervals that may have
                                                                     !< turning points
    integer, allocatable, private :: turnings(:, :)                  !< (quantities,lanes) how many there are
  contains
    procedure :: begin
    procedure :: make
  end type lane_runs_type

  !> Numbers that are kept for a group at most: 32 megabytes.
  real(wp), parameter :: most_numbers = 2.0_wp**22
  !> Outputs after which it is asked whether the runs shall stop.
  integer, parameter :: outputs_at_once = 1000

contains

  !> Prepare for the runs of a study; `used` is false where they can't be made side by side.
  subroutine begin(self, model)
    class(lane_runs_type), intent(out) :: self    !< prepared
    type(model_type), intent(in) :: model         !< the model with the values of the data file
    type(quantity_record_type) :: record
    type(plan_type) :: plan
    type(state_type) :: state
    type(error_type), allocatable :: err
    integer :: i, k
    logical :: found

    if (.not. is_simple(model)) return
    call find_quantities(model, record, err)
    if (allocated(err)) return
    self%tracked = record%tracked
    allocate (self%sources(size(self%tracked)))
    do i = 1, size(self%tracked)
      call find_source(record, i, self%sources(i), found)
      if (.not. found) return
    end do
    allocate (self%model, source=model)
    self%requested = requested_by_results(model%mechanism, model%request%output)
    ! the structure of the data file's own design: which others are followed side by side must not depend on their order
    call assemble_model(model, plan, state, err)
    if (allocated(err)) return
    if (.not. plan%planar%used) return
    call self%starts%begin(plan)
    call leave_out_unrequested(plan, self%requested)
    if (.not. fits_lanes(plan)) return
    call new_lane_group(plan, self%group)
    call new_chebyshev(points_between, self%rule)
    associate (time => model%request%time)
      if (real(time%intervals, wp)*size(self%tracked)*3*lanes > most_numbers) return
      allocate (self%t(0:time%intervals), source=[(time%time(i), i=0, time%intervals)])
      allocate (self%series(lanes, 0:2, 0:time%intervals, size(self%tracked)), self%range(lanes, 2, size(self%tracked)), &
                source=0.0_wp)
      allocate (self%turning(time%intervals, size(self%tracked), lanes), self%turnings(size(self%tracked), lanes), source=0)
      allocate (self%drives(4, 0:time%intervals, size(model%problem%drives)))
    end associate
    do i = 1, size(model%problem%drives)
      do k = 0, size(self%t) - 1
        call move_drive(model%problem%drives(i)%drive, self%t(k), self%t(k) - self%t(max(0, k - 1)), self%drives(:, k, i))
      end do
    end do
    self%bits = vector_bits()
    self%used = .true.
  end subroutine begin

  !> Whether the runs of a model are driven motions with nothing beside them that could end them or be recorded.
  logical function is_simple(model) result(simple)
    type(model_type), intent(in) :: model   !< the model

    simple = .false.
    if (.not. model%is_driven() .or. size(model%request%quantities) == 0) return
    associate (mechanism => model%mechanism, output => model%request%output)
      if (output%derivatives < 2 .or. output%with_forces() .or. output%with_derivatives() .or. output%conditioning) return
      if (model%program == dynamics .and. output%energies) return
      if (model%request%solver%accuracy > 0.0_wp .or. .not. is_plain(mechanism)) return
    end associate
    if (model%request%time%intervals < 1 .or. .not. abs(model%request%time%end - model%request%time%start) > 0.0_wp) return
    simple = .not. have_joints(model)
  end function is_simple

  !> Find the source of the column of a quantity: a coordinate, or a point.
  subroutine find_source(record, number, source, found)
    type(quantity_record_type), intent(in) :: record   !< the quantities
    integer, intent(in) :: number                      !< of the quantity
    type(column_source_type), intent(out) :: source    !< gets it
    logical, intent(out) :: found                      !< the column is of one of these
    integer :: at, n

    found = .false.
    associate (tracked => record%tracked(number), columns => record%columns)
      if (tracked%take == 'at' .or. tracked%family(0) == 0) return
      found = .true.
      source%factors = columns%scales(tracked%family)*tracked%weights
      n = size(columns%coordinates)
      if (tracked%family(0) <= n + 1) then
        source%coordinate = columns%coordinates(tracked%family(0) - 1)
      else
        at = tracked%family(0) - 3*n - 2
        source%point = 1 + at/9
        source%component = 1 + mod(at, 9)
      end if
    end associate
  end subroutine find_source

  !> Make runs side by side, at most as many as there are lanes. A run that is neither `done` nor has a failure is to be made alone.
  subroutine make(self, models, numbers, done, failures, interruption)
    class(lane_runs_type), intent(inout) :: self        !< prepared
    type(model_type), intent(in), target :: models(:)   !< (runs) the models
    real(wp), intent(inout) :: numbers(:, :)            !< (quantities,runs) get the quantities of runs that are done
    logical, intent(inout) :: done(:)                   !< (runs) the model is of use in; the run is made out
    type(lane_failure_type), intent(out) :: failures(:) !< (runs) of designs that a run alone could not assemble either
    class(interruption_type), intent(inout), optional :: interruption   !< is asked whether the runs shall stop
    integer :: i, l

    do l = 1, size(models)
      if (done(l)) call assemble_lane(self, models(l), l, done(l), failures(l)%err)
    end do
    if (any(done)) call follow_group(self, models, done, interruption)
    do l = 1, size(models)
      if (.not. done(l)) cycle
      self%made = self%made + 1
      do i = 1, size(self%tracked)
        call find_number(self, i, l, numbers(i, l))
      end do
    end do
  end subroutine make

  !> Find a quantity of a run from its column.
  subroutine find_number(self, quantity, lane, number)
    type(lane_runs_type), intent(in) :: self     !< with the columns
    integer, intent(in) :: quantity              !< number of the quantity
    integer, intent(in) :: lane                  !< number of the lane
    real(wp), intent(out) :: number              !< gets it
    type(tracked_quantity_type) :: tracked
    integer :: k, n

    n = size(self%t)
    tracked = self%tracked(quantity)
    associate (series => self%series(lane, :, :, quantity), range => self%range(lane, :, quantity), order => tracked%order)
      call tracked%begin_motion(self%t(0), series(order + 1, 1))
      if (tracked%counts_turns()) then
        do k = 1, self%turnings(quantity, lane)
          call take(self%turning(k, quantity, lane))
        end do
        tracked%sums%low = min(tracked%sums%low, range(1))
        tracked%sums%high = max(tracked%sums%high, range(2))
      else if (tracked%follows()) then
        do k = 1, n - 1
          call take(k)
        end do
      end if
      tracked%sums%last = series(order + 1, n)
    end associate
    number = tracked%number()

  contains

    !> Take an interval into account.
    subroutine take(interval)
      integer, intent(in) :: interval   !< its number
      integer :: ends(2)

      ends = outputs_about(interval, n)
      call tracked%take_interval(self%rule, interval - ends(1) + 1, self%t(ends(1) - 1:ends(2) - 1), &
                                 self%series(lane, :, ends(1) - 1:ends(2) - 1, quantity))
    end subroutine take
  end subroutine find_number

  !> Assemble a design and give it to a lane.
  subroutine assemble_lane(self, model, lane, fits, err)
    type(lane_runs_type), intent(inout) :: self      !< prepared
    type(model_type), intent(in) :: model            !< the model of the design
    integer, intent(in) :: lane                      !< number of the lane
    logical, intent(out) :: fits                     !< the lane has the design
    type(error_type), allocatable, intent(out) :: err    !< allocated if it can't be assembled
    type(plan_type) :: plan
    type(state_type) :: state
    logical :: found

    fits = is_simple(model)
    if (.not. fits) return
    associate (time => model%request%time, base => self%model%request%time)
      fits = time%intervals == base%intervals .and. .not. max(abs(time%start - base%start), abs(time%end - base%end)) > 0.0_wp
    end associate
    if (.not. fits) return
    call self%starts%find(model, found)
    if (found) then
      fits = closes_well(self%starts%plan, closed)
      if (fits) call renew_lane(self%starts%plan, self%starts%state%q, lane, self%group, fits)
      if (fits) call place_sources(model, self%starts%plan, lane, self%sources)
      if (fits) return
    end if
    call assemble_model(model, plan, state, err)
    fits = .not. allocated(err)
    if (.not. fits) return
    call leave_out_unrequested(plan, self%requested)
    fits = fits_lanes(plan) .and. closes_well(plan, closed)
    if (fits) call fill_lane(plan, state%q, lane, self%group, fits)
    if (fits) call place_sources(model, plan, lane, self%sources)
  end subroutine assemble_lane

  !> Give a lane the numbers of the points of quantities.
  subroutine place_sources(model, plan, lane, sources)
    type(model_type), intent(in) :: model                !< the model of the design
    type(plan_type), intent(in) :: plan                  !< its plan
    integer, intent(in) :: lane                          !< number of the lane
    type(column_source_type), intent(inout) :: sources(:)   !< of the quantities; get the numbers
    integer :: i

    do i = 1, size(sources)
      call place_source(model, plan, lane, sources(i))
    end do
  end subroutine place_sources

  !> Give a lane the numbers of a point.
  subroutine place_source(model, plan, lane, source)
    type(model_type), intent(in) :: model                !< the model of the design
    type(plan_type), intent(in) :: plan                  !< its plan
    integer, intent(in) :: lane                          !< number of the lane
    type(column_source_type), intent(inout) :: source    !< gets the numbers

    if (source%coordinate > 0) then
      source%step = plan%step_of(source%coordinate)
      return
    end if
    associate (point => model%mechanism%points(source%point))
      source%frame = plan%frame_of(point%link)
      source%place(lane, :) = transformed(plan%planar%link_in_frame(point%link), point%position)
      source%axis(lane, :) = plan%planar%axes(source%component, :)
      source%origin(lane) = plan%origin(source%component)
    end associate
  end subroutine place_source

  !> Follow the designs from output to output.
  subroutine follow_group(self, models, done, interruption)
    type(lane_runs_type), intent(inout) :: self         !< with designs in lanes
    type(model_type), intent(in), target :: models(:)   !< (runs) their models
    logical, intent(inout) :: done(:)                   !< (runs) the lane has a design; false afterwards where it was left
    class(interruption_type), intent(inout), optional :: interruption   !< is asked whether the runs shall stop
    real(wp) :: h
    integer :: first, i, l
    logical :: same(size(models))

    first = findloc(done, .true., dim=1)
    do l = 1, lanes
      if (l <= size(done)) then
        if (done(l)) cycle
      end if
      call copy_lane(first, l, self%group)
      call copy_sources(first, l, self%sources)
    end do
    do l = 1, size(models)
      ! a model that could not be made has no drives
      same(l) = done(l)
      if (same(l)) same(l) = drives_are_same(models(l), self%model)
    end do
    do i = 0, size(self%t) - 1
      if (mod(i, outputs_at_once) == outputs_at_once - 1 .and. present(interruption)) then
        if (interruption%is_wanted()) done = .false.
      end if
      h = self%t(i) - self%t(max(0, i - 1))
      call drive_lanes(self, models, same, i, h, done)
      if (.not. any(done)) return
      if (i == 0) then
        call begin_group(self%bits, self%group)
      else
        call go_on_with_group(self%bits, spread(h, 1, lanes), self%group)
      end if
      if (any(self%group%refused > 0.0_wp)) call leave_refused(self%group, self%sources, done)
      if (.not. any(done)) return
      call keep_output(self, i, h)
    end do
  end subroutine follow_group

  !> Leave the lanes whose step was refused. The rest goes on; lanes that were left copy one of these.
  subroutine leave_refused(group, sources, done)
    type(lane_group_type), intent(inout) :: group               !< the designs
    type(column_source_type), intent(inout) :: sources(:)       !< of the quantities
    logical, intent(inout) :: done(:)                           !< (runs) the lane has a design
    integer :: first, l

    done = done .and. .not. group%refused(:size(done)) > 0.0_wp
    first = findloc(done, .true., dim=1)
    if (first == 0) return
    do l = 1, lanes
      if (.not. group%refused(l) > 0.0_wp) cycle
      call copy_lane(first, l, group)
      call copy_sources(first, l, sources)
    end do
  end subroutine leave_refused

  !> Copy the numbers of points from lane to lane.
  pure subroutine copy_sources(from, to, sources)
    integer, intent(in) :: from                             !< number of the lane
    integer, intent(in) :: to                               !< number of the other one
    type(column_source_type), intent(inout) :: sources(:)   !< of the quantities
    integer :: i

    do i = 1, size(sources)
      sources(i)%place(to, :) = sources(i)%place(from, :)
      sources(i)%axis(to, :) = sources(i)%axis(from, :)
      sources(i)%origin(to) = sources(i)%origin(from)
    end do
  end subroutine copy_sources

  !> Set the driven coordinates of all lanes at an output. A design whose drive has no value, or moves far in the step, is left.
  subroutine drive_lanes(self, models, same, output, h, done)
    type(lane_runs_type), intent(inout) :: self       !< with designs in lanes
    type(model_type), intent(in) :: models(:)         !< (runs) their models
    logical, intent(in) :: same(:)                    !< (runs) the drives are those of the data file
    integer, intent(in) :: output                     !< number of the output, from 0
    real(wp), intent(in) :: h                         !< length of the step to it [s]
    logical, intent(inout) :: done(:)                 !< (runs) the lane has a design
    real(wp) :: motion(4)
    integer :: first, i, l, s

    first = findloc(done, .true., dim=1)
    if (first == 0) return
    associate (group => self%group)
      do i = 1, size(self%drives, 3)
        ! the step of a coordinate is the same in all designs
        s = findloc(group%steps%coordinate, self%model%problem%drives(i)%drive%coordinate, dim=1)
        ! lanes without a design copy the first one
        call move(first)
        group%steps(s)%q = motion(1)
        group%steps(s)%dq = motion(2)
        group%steps(s)%ddq = motion(3)
        if (all(same .or. .not. done)) then
          if (motion(4) <= longest_drive*minval(group%steps(s)%unit)) cycle
        end if
        do l = 1, size(models)
          if (.not. done(l)) cycle
          call move(l)
          group%steps(s)%q(l) = motion(1)
          group%steps(s)%dq(l) = motion(2)
          group%steps(s)%ddq(l) = motion(3)
          done(l) = motion(4) <= longest_drive*group%steps(s)%unit(l)
        end do
      end do
    end associate

  contains

    !> Find the motion of the drive of a design.
    subroutine move(lane)
      integer, intent(in) :: lane   !< its lane

      if (same(lane)) then
        motion = self%drives(:, output, i)
      else
        call move_drive(models(lane)%problem%drives(i)%drive, self%t(output), h, motion)
      end if
    end subroutine move
  end subroutine drive_lanes

  !> The motion of a drive at a time, and a bound of its way in the step to it.
  subroutine move_drive(drive, t, h, motion)
    class(law_type), intent(in) :: drive    !< the drive
    real(wp), intent(in) :: t               !< the time [s]
    real(wp), intent(in) :: h               !< length of the step to it [s]
    real(wp), intent(out) :: motion(4)      !< coordinate, rate and acceleration, 0 where the drive has no value; the bound, which is
                                            !< then beyond all bounds
    type(error_type), allocatable :: err

    call drive%evaluate(t, motion(1), motion(2), motion(3), err)
    motion(4) = 0.0_wp
    if (.not. allocated(err) .and. abs(h) > 0.0_wp) motion(4) = abs(h)*drive%greatest_rate(t - h, h)
    if (.not. allocated(err)) return
    motion(:3) = 0.0_wp
    motion(4) = huge(h)
  end subroutine move_drive

  !> Whether two designs have the same drives.
  logical function drives_are_same(a, b) result(same)
    type(model_type), intent(in) :: a   !< model of a design
    type(model_type), intent(in) :: b   !< of another one
    real(wp), allocatable :: of_a(:), of_b(:)
    integer :: i

    same = size(a%problem%drives) == size(b%problem%drives)
    if (.not. same) return
    do i = 1, size(a%problem%drives)
      associate (drive => a%problem%drives(i)%drive, other => b%problem%drives(i)%drive)
        call drive%constants(of_a)
        call other%constants(of_b)
        same = same_type_as(drive, other) .and. drive%coordinate == other%coordinate .and. allocated(of_a) .and. allocated(of_b)
        if (same) same = size(of_a) == size(of_b)
        if (same) same = .not. any(abs(of_a - of_b) > 0.0_wp)
      end associate
      if (.not. same) return
    end do
  end function drives_are_same

  !> Keep the columns of the quantities at an output.
  subroutine keep_output(self, output, h)
    type(lane_runs_type), intent(inout) :: self    !< with the positions of the designs
    integer, intent(in) :: output                  !< its number, from 0
    real(wp), intent(in) :: h                      !< time from the output before [s]
    real(wp) :: motion(lanes, 0:2), turning(lanes), first(lanes, 0:2, 2)
    integer :: i, l

    first = 0.0_wp
    do i = 1, size(self%sources)
      associate (source => self%sources(i), group => self%group, series => self%series(:, :, :, i))
        if (source%step > 0) then
          motion(:, 0) = group%steps(source%step)%q
          motion(:, 1) = group%steps(source%step)%dq
          motion(:, 2) = group%steps(source%step)%ddq
        else
          call find_point(self%bits, group, source%frame, source%place, source%axis, source%origin, motion)
        end if
        if (output == 0) then
          self%range(:, 1, i) = huge(h)
          self%range(:, 2, i) = -huge(h)
          self%turnings(i, :) = 0
          call keep_column(self%bits, 1.0_wp, source%factors, motion, first, self%range(:, :, i), turning)
          series(:, :, 1) = first(:, :, 2)
          cycle
        end if
        call keep_column(self%bits, h, source%factors, motion, series(:, :, output:output + 1), self%range(:, :, i), turning)
        do l = 1, lanes
          if (.not. turning(l) > 0.0_wp) cycle
          self%turnings(i, l) = self%turnings(i, l) + 1
          self%turning(self%turnings(i, l), i, l) = output
        end do
      end associate
    end do
  end subroutine keep_output
end module mech9_lane_runs
