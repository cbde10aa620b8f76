!> Following a driven motion in time, step by step, on one branch. Uses kinds, error, text,
!> mechanism, plan, state, solver, closure.
!>
!> Each block is predicted by its Taylor series, corrected by Newton's method, and accepted only if
!> the correction is small against the step and falls fast, and no determinant changed its sign;
!> otherwise the step is halved. So the branch is never changed silently.
module mech9_tracking
  use mech9_kinds, only: wp, long
  use mech9_error, only: error_type, raise, exit_singular
  use mech9_text, only: to_text
  use mech9_mechanism, only: mechanism_type
  use mech9_plan, only: plan_type, block_type
  use mech9_state, only: state_type, nothing_known, acceleration_known
  use mech9_solver, only: block_work_type, new_block_work, newton_outcome_type, close_block, factorize_block, &
    solve_rates, solve_accelerations
  use mech9_closure, only: closing_error
  use mech9_planning, only: chain_names
  implicit none
  private
  public :: tracker_type, start_tracking, advance, set_inputs, largest_closure

  !> A correction beyond this part of the predicted change is not trusted ...
  real(wp), parameter :: trusted_part = 0.2_wp
  !> ... unless it is smaller than this [rad, lengths of the mechanism].
  real(wp), parameter :: trusted_size = 1.0e-3_wp
  !> Newton must at least quarter its correction from the first to the second iteration.
  real(wp), parameter :: trusted_contraction = 0.25_wp
  !> Blocks whose least pivot is below this are at a singular position.
  real(wp), parameter :: singular = 1.0e-9_wp
  !> Steps below this part of the interval are given up.
  real(wp), parameter :: least_step = 1.0e-11_wp

  !> Where a step starts from.
  type :: departure_type
    real(wp) :: t = 0.0_wp
    real(wp), allocatable :: q(:), dq(:), ddq(:)
    real(wp), allocatable :: jerk(:)              !< third derivatives, from the last two positions
  end type departure_type

  !> What is followed, and counts for the report.
  type :: tracker_type
    type(state_type) :: state                     !< during a step the trial, then the accepted position
    type(departure_type) :: departure             !< the position accepted last
    type(block_work_type), allocatable :: work(:)
    integer, allocatable :: signs(:)              !< of the blocks' determinants
    integer(long) :: positions = 0                !< that were asked for
    integer(long) :: steps = 0                    !< taken
    integer(long) :: halvings = 0                 !< steps refused
    integer(long) :: iterations = 0               !< of Newton's method, all blocks
    real(wp) :: least_conditioning = 1.0_wp       !< smallest pivot ratio of any block
    real(wp) :: worst_closure = 0.0_wp            !< largest closure error of any position asked for [m]
  end type tracker_type

contains

  !> Independent coordinates and their derivatives at a time, from the drives.
  subroutine set_inputs(mechanism, t, q, dq, ddq, err)
    type(mechanism_type), intent(in) :: mechanism
    real(wp), intent(in) :: t
    real(wp), intent(inout) :: q(:), dq(:), ddq(:)   !< (M)
    type(error_type), allocatable, intent(out) :: err
    integer :: i, k

    do i = 1, size(mechanism%drives)
      k = mechanism%drives(i)%drive%coordinate
      call mechanism%drives(i)%drive%evaluate(t, q(k), dq(k), ddq(k), err)
      if (allocated(err)) return
    end do
  end subroutine set_inputs

  !> Begin at an assembled position: velocities and accelerations there.
  subroutine start_tracking(mechanism, plan, assembled, t, tracker, err)
    type(mechanism_type), intent(in) :: mechanism
    type(plan_type), intent(in) :: plan
    type(state_type), intent(in) :: assembled
    real(wp), intent(in) :: t
    type(tracker_type), intent(out) :: tracker
    type(error_type), allocatable, intent(out) :: err
    integer :: b

    tracker%state = assembled
    tracker%state%t = t
    allocate (tracker%work(size(plan%blocks)), tracker%signs(size(plan%blocks)))
    call set_inputs(mechanism, t, tracker%state%q, tracker%state%dq, tracker%state%ddq, err)
    if (allocated(err)) return
    do b = 1, size(plan%blocks)
      tracker%work(b) = new_block_work(plan%blocks(b))
      associate (block => plan%blocks(b), work => tracker%work(b))
        if (size(block%unknowns) > 0) call factorize_block(plan, block, tracker%state, work)
        tracker%signs(b) = work%equations%determinant_sign()
        call note_conditioning(work, tracker)
        if (work%equations%conditioning() < singular) then
          call raise(err, exit_singular, 'the mechanism starts in a singular position of '//chain_names(block)// &
                     ': rates are not determined there; start a little beside it')
          return
        end if
        call solve_rates(plan, block, tracker%state, work)
        call solve_accelerations(plan, block, tracker%state, work)
      end associate
    end do
    tracker%state%known = acceleration_known
    tracker%departure = departure_type(t, tracker%state%q, tracker%state%dq, tracker%state%ddq, &
                                       0.0_wp*tracker%state%q)
    call record(plan, tracker)
  end subroutine start_tracking

  !> Go on to a time: position, velocity and acceleration there, on the same branch. Fails with
  !> exit_singular where the motion cannot go on; the state is then the last one reached.
  subroutine advance(mechanism, plan, tracker, t, err)
    type(mechanism_type), intent(in) :: mechanism
    type(plan_type), intent(in) :: plan
    type(tracker_type), intent(inout) :: tracker
    real(wp), intent(in) :: t
    type(error_type), allocatable, intent(out) :: err
    real(wp) :: step, interval
    integer :: refused_by
    logical :: accepted

    interval = t - tracker%departure%t
    step = interval
    do while (abs(t - tracker%departure%t) > 0.0_wp)
      tracker%state%t = tracker%departure%t + step
      if (abs(step) >= abs(t - tracker%departure%t)) tracker%state%t = t
      call try_step(mechanism, plan, tracker, accepted, refused_by, err)
      if (allocated(err)) exit
      if (accepted) then
        call accept(tracker)
        step = 2.0_wp*step
      else
        tracker%halvings = tracker%halvings + 1
        step = 0.5_wp*(tracker%state%t - tracker%departure%t)
        if (abs(step) <= least_step*abs(interval)) then
          call refuse(mechanism, plan, tracker%departure, refused_by, err)
          exit
        end if
      end if
    end do
    if (allocated(err)) then
      call go_back(tracker)
    else
      call record(plan, tracker)
    end if
  end subroutine advance

  !> Predict, correct and judge one step of all blocks, from tracker%departure to tracker%state.
  subroutine try_step(mechanism, plan, tracker, accepted, refused_by, err)
    type(mechanism_type), intent(in) :: mechanism
    type(plan_type), intent(in) :: plan
    type(tracker_type), intent(inout) :: tracker
    logical, intent(out) :: accepted
    integer, intent(out) :: refused_by          !< number of the block
    type(error_type), allocatable, intent(out) :: err
    type(newton_outcome_type) :: newton
    real(wp) :: predicted
    integer :: b

    refused_by = 0
    accepted = .false.
    call set_inputs(mechanism, tracker%state%t, tracker%state%q, tracker%state%dq, tracker%state%ddq, err)
    if (allocated(err)) return
    do b = 1, size(plan%blocks)
      refused_by = b
      associate (block => plan%blocks(b), work => tracker%work(b))
        call predict(plan, block, tracker%departure, tracker%state, predicted)
        call close_block(plan, block, tracker%state, work, newton, err)
        if (allocated(err)) return
        tracker%iterations = tracker%iterations + newton%iterations
        if (.not. newton%converged) return
        if (newton%correction > max(trusted_size, trusted_part*predicted)) return
        if (newton%contraction > trusted_contraction .and. newton%correction > 1.0e-6_wp) return
        if (size(block%unknowns) > 0) then
          call factorize_block(plan, block, tracker%state, work)
          if (work%equations%conditioning() < singular) return
          if (work%equations%determinant_sign() /= tracker%signs(b)) return
        end if
        call solve_rates(plan, block, tracker%state, work)
        call solve_accelerations(plan, block, tracker%state, work)
      end associate
    end do
    accepted = .true.
  end subroutine try_step

  !> Taylor prediction of a block's dependent coordinates, and the largest change, in units of the coordinates.
  pure subroutine predict(plan, block, departure, state, largest)
    type(plan_type), intent(in) :: plan
    type(block_type), intent(in) :: block
    type(departure_type), intent(in) :: departure
    type(state_type), intent(inout) :: state
    real(wp), intent(out) :: largest
    real(wp) :: h, change
    integer :: i, k

    h = state%t - departure%t
    largest = 0.0_wp
    do i = 1, size(block%unknowns)
      k = plan%steps(block%unknowns(i))%coordinate
      change = h*(departure%dq(k) + h*(departure%ddq(k)/2.0_wp + h*departure%jerk(k)/6.0_wp))
      state%q(k) = departure%q(k) + change
      largest = max(largest, abs(change)/plan%unit_of(k))
    end do
  end subroutine predict

  !> The trial becomes the place of departure.
  pure subroutine accept(tracker)
    type(tracker_type), intent(inout) :: tracker

    tracker%steps = tracker%steps + 1
    tracker%state%known = acceleration_known
    associate (here => tracker%state, last => tracker%departure)
      last%jerk = (here%ddq - last%ddq)/(here%t - last%t)
      last%t = here%t
      last%q = here%q
      last%dq = here%dq
      last%ddq = here%ddq
    end associate
  end subroutine accept

  !> After a step that was given up: the coordinates of the last position again.
  pure subroutine go_back(tracker)
    type(tracker_type), intent(inout) :: tracker

    tracker%state%t = tracker%departure%t
    tracker%state%q = tracker%departure%q
    tracker%state%dq = tracker%departure%dq
    tracker%state%ddq = tracker%departure%ddq
    tracker%state%known = nothing_known
  end subroutine go_back

  !> Count a position that was asked for.
  subroutine record(plan, tracker)
    type(plan_type), intent(in) :: plan
    type(tracker_type), intent(inout) :: tracker
    integer :: b

    tracker%positions = tracker%positions + 1
    tracker%worst_closure = max(tracker%worst_closure, largest_closure(plan, tracker%state))
    do b = 1, size(tracker%work)
      call note_conditioning(tracker%work(b), tracker)
    end do
  end subroutine record

  pure subroutine note_conditioning(work, tracker)
    type(block_work_type), intent(in) :: work
    type(tracker_type), intent(inout) :: tracker

    tracker%least_conditioning = min(tracker%least_conditioning, work%equations%conditioning())
  end subroutine note_conditioning

  !> Largest closure error of a state: a length [m], rotations times the mechanism's size.
  pure real(wp) function largest_closure(plan, state) result(largest)
    type(plan_type), intent(in) :: plan
    type(state_type), intent(in) :: state
    integer :: c

    largest = 0.0_wp
    do c = 1, size(plan%closures)
      largest = max(largest, closing_error(plan, plan%closures(c), state))
    end do
  end function largest_closure

  !> Say where and why the motion cannot go on.
  subroutine refuse(mechanism, plan, departure, block, err)
    type(mechanism_type), intent(in) :: mechanism
    type(plan_type), intent(in) :: plan
    type(departure_type), intent(in) :: departure
    integer, intent(in) :: block
    type(error_type), allocatable, intent(out) :: err
    character(len=:), allocatable :: drives
    integer :: i, k

    drives = ''
    do i = 1, size(plan%independent)
      k = plan%independent(i)
      if (i > 1) drives = drives//', '
      drives = drives//'q'//to_text(k)//' = '// &
               to_text(departure%q(k)/merge(mechanism%angle_unit, 1.0_wp, mechanism%pairs(k)%pair%angular), 10)
    end do
    call raise(err, exit_singular, 'the motion cannot go on beyond t = '//to_text(departure%t, 10)//' s: '// &
               chain_names(plan%blocks(block))//' reaches a singular position there ('//drives//')')
  end subroutine refuse
end module mech9_tracking
