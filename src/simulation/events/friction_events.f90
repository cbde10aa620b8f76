!> The choice of the pairs with friction that stick, and of those that slip, at one time of a motion.
!>
!> First all pairs at rest stick whose coordinates free coordinates move. They form groups that move by one freedom each. As long as a
!> group is used beyond what it holds, the group that is used most slips, against its friction.
module mech9_friction_events
  use mech9_kinds, only: wp
  use mech9_error, only: error_type, raise, add_place, exit_singular
  use mech9_event_failures, only: failure_paradox, failure_shared_sticking, failure_undecided_friction
  use mech9_event_tolerances, only: limit_of_sticking, at_rest, still, tied, round_off_of_sticking, &
    beyond_all_bounds
  use mech9_cholesky, only: cholesky_factorize, cholesky_solve
  use mech9_friction_balance, only: friction_modes_type, new_friction_modes
  use mech9_friction_motion, only: friction_motion_type, find_friction_balance
  use mech9_motion_event, only: motion_event_type, motion_events_type, event_stick, event_slip
  use mech9_motion_system, only: motion_system_type
  implicit none
  private
  public :: choose_modes, fail_in_paradox, fail_undecided

  !> The pairs at rest and the freedoms by which they move.
  type :: resting_pairs_type
    logical, allocatable :: rests(:)           !< (frictions) the pair is at rest, and free coordinates move it
    logical, allocatable :: turns(:)           !< (frictions) the pair is at rest for a moment, where it turns back while others move on
    integer, allocatable :: leaders(:)         !< frictions whose coordinates stand for all freedoms of these pairs
    real(wp), allocatable :: by_leaders(:, :)  !< (leaders,frictions) rates of the pairs by those of the leaders
  end type resting_pairs_type

  !> Most groups whose choices are all tried.
  integer, parameter :: most_enumerated = 5

contains

  !> Choose how the frictions act in the present state of the system, which has all rates. The modes of the system change; those that
  !> drives hold in its plan do not, before the partition changes. Contacts may change the answer, which is then asked for again.
  subroutine choose_modes(system, changes, round, at_start, sticking, events, err)
    class(motion_system_type), intent(inout) :: system         !< the system, moved to the time
    integer, intent(in) :: changes                             !< number of the friction that comes to rest or to its bound; 0: none
    integer, intent(in) :: round                               !< how often it was asked for at this event
    logical, intent(in) :: at_start                            !< there were no modes before
    integer, allocatable, intent(out) :: sticking(:)           !< coordinates that are to be held
    type(motion_events_type), intent(inout) :: events          !< gets the pairs that stick and slip from now on
    type(error_type), allocatable, intent(out) :: err          !< allocated if it failed
    type(friction_modes_type) :: before, modes
    type(resting_pairs_type) :: resting
    integer :: i, comes_to_rest, met

    before = system%friction%modes
    met = merge(changes, 0, round == 0)
    call note_released(system%friction, changes, round)
    associate (mechanism => system%model%mechanism)
      ! the forces of all pairs are needed, in whatever way they act
      system%friction%modes%group = 1
      call find_friction_balance(mechanism, system%plan, system%dynamics, system%state, system%work, system%friction, &
                                 system%contact, err)
      if (allocated(err)) return
      if (met > 0) then
        if (before%slips(met) .and. .not. turns_back(system, met)) then
          call bring_to_rest(system, met)
          call find_friction_balance(mechanism, system%plan, system%dynamics, system%state, system%work, system%friction, &
                                 system%contact, err)
          if (allocated(err)) return
        end if
      end if
      comes_to_rest = 0
      if (met > 0) comes_to_rest = merge(met, 0, before%slips(met) .or. before%group(met) > 0)
      call find_directions(system, comes_to_rest, before%group > 0, modes, resting%rests)
      call find_freedoms(system, modes, resting)
      call release(system, before, met, modes, resting, err)
      if (allocated(err)) return
      system%friction%modes = modes
      system%state%friction = system%friction%balance%force
      if (system%friction%balance%least_determinant(mechanism%frictions, modes) <= 0.0_wp) then
        call fail_in_paradox(system, err)
        return
      end if
      sticking = mechanism%frictions(modes%leader)%coordinate
      if (at_start) return
      do i = 1, size(mechanism%frictions)
        if (mechanism%frictions(i)%is_smooth) cycle
        if (modes%slips(i) .and. .not. (before%slips(i) .and. before%direction(i)*modes%direction(i) > 0.0_wp)) &
          call events%add(motion_event_type(system%state%t, event_slip, 'friction', i))
        if (before%slips(i) .and. .not. modes%slips(i)) &
          call events%add(motion_event_type(system%state%t, event_stick, 'friction', i))
      end do
    end associate
  end subroutine choose_modes

  !> Note the pairs that slip at the present event whatever contacts do: the one that comes to its bound, and after some rounds all that have
  !> begun to slip, lest pairs and contacts change in turn.
  pure subroutine note_released(friction, changes, round)
    class(friction_motion_type), intent(inout) :: friction     !< the frictions, with the modes of the last round
    integer, intent(in) :: changes                             !< number of the friction that comes to rest or to its bound; 0: none
    integer, intent(in) :: round                               !< number of the round, from 0 on
    integer, parameter :: free_rounds = 2
    integer :: i

    if (round == 0) then
      friction%released = spread(.false., 1, size(friction%modes%group))
      if (changes > 0) friction%released(changes) = friction%modes%group(changes) > 0
    else if (round > free_rounds) then
      friction%released = friction%released .or. [(friction%modes%slips(i), i=1, size(friction%released))]
    end if
  end subroutine note_released

  !> Find the directions of pairs that slip, and the pairs at rest.
  subroutine find_directions(system, comes_to_rest, stuck, modes, rests)
    class(motion_system_type), intent(in) :: system            !< the system, with all rates
    integer, intent(in) :: comes_to_rest                       !< number of the friction that comes to rest; 0: none
    logical, intent(in) :: stuck(:)                            !< (frictions) the pair sticks up to now
    type(friction_modes_type), intent(out) :: modes            !< gets the directions
    logical, allocatable, intent(out) :: rests(:)              !< (frictions) the pair is at rest
    real(wp) :: speed, duration
    integer :: i

    associate (time => system%model%request%time)
      duration = max(abs(time%end - time%start), tiny(1.0_wp)/epsilon(1.0_wp))
    end associate
    associate (frictions => system%model%mechanism%frictions, state => system%state, plan => system%plan)
      modes = new_friction_modes(size(frictions))
      allocate (rests(size(frictions)))
      do i = 1, size(frictions)
        associate (rate => state%dq(frictions(i)%coordinate))
          rests(i) = .not. frictions(i)%is_smooth
          if (.not. rests(i)) modes%direction(i) = tanh(rate/frictions(i)%transition)
          if (.not. rests(i)) cycle
          speed = sum(abs(system%friction%rows(:, i)*state%dq(plan%independent)))
          rests(i) = i == comes_to_rest .or. abs(rate) <= at_rest*speed &
                     .or. abs(rate) <= epsilon(rate)*plan%unit_of(frictions(i)%coordinate)/duration
          ! a pair that sticks keeps at rest while errors are taken from the rate of another one
          if (stuck(i)) rests(i) = rests(i) .or. abs(rate) <= &
            still*plan%unit_of(frictions(i)%coordinate)*maxval(abs(state%dq)/plan%unit_of)
          if (.not. rests(i)) modes%direction(i) = sign(1.0_wp, rate)
        end associate
      end do
    end associate
  end subroutine find_directions

  !> Whether a pair with the rate zero does not stick, but turns back while others move on, as the slider of a crank does at its dead point
  !> where it has hardly any mobility; also whether drives alone move it.
  pure logical function turns_back(system, i)
    class(motion_system_type), intent(in) :: system            !< the system, with the equations of all frictions
    integer, intent(in) :: i                                   !< number of the friction
    real(wp) :: most

    associate (balance => system%friction%balance, mobility => system%friction%mobility(i, i), &
               friction => system%model%mechanism%frictions(i))
      most = friction%static*friction%bearing_load(friction%terms(balance%wrenches(:, i)))*mobility
      turns_back = .not. mobility > 0.0_wp .or. abs(balance%accelerations(i)) > beyond_all_bounds*most
    end associate
  end function turns_back

  !> Take the rate that errors of integration have left from a pair that comes to rest, by the least change of kinetic energy. All pairs
  !> that move with it come to rest, too.
  subroutine bring_to_rest(system, i)
    class(motion_system_type), intent(inout) :: system         !< the system; its independent rates change
    integer, intent(in) :: i                                   !< number of the friction
    real(wp) :: held(size(system%friction%held))

    associate (friction => system%friction, state => system%state, independent => system%plan%independent)
      held = state%dq(friction%held)
      state%dq(independent) = state%dq(independent) - friction%by_impulse(:, i) &
                              *(dot_product(friction%rows(:, i), state%dq(independent))/friction%mobility(i, i))
      state%dq(friction%held) = held
    end associate
  end subroutine bring_to_rest

  !> Find the freedoms of the pairs at rest. One that no free coordinate moves does not stick: it goes with its drives.
  subroutine find_freedoms(system, modes, resting)
    class(motion_system_type), intent(in) :: system                !< the system, with the equations of all frictions
    type(friction_modes_type), intent(inout) :: modes              !< gets directions of pairs that drives move
    type(resting_pairs_type), intent(inout) :: resting             !< gets its freedoms
    real(wp), allocatable :: left(:, :), scales(:)
    real(wp) :: acceleration
    integer, allocatable :: order(:)
    integer :: i, j, l, n

    associate (balance => system%friction%balance, mobility => system%friction%mobility, &
               frictions => system%model%mechanism%frictions)
      n = size(frictions)
      left = mobility
      scales = [(mobility(i, i), i=1, n)]
      allocate (resting%turns(n), source=.false.)
      do i = 1, n
        acceleration = balance%accelerations(i)
        if (.not. resting%rests(i)) cycle
        if (.not. turns_back(system, i)) cycle
        resting%rests(i) = .false.
        resting%turns(i) = scales(i) > 0.0_wp
        if (abs(acceleration) > 0.0_wp) modes%direction(i) = sign(1.0_wp, acceleration)
      end do
      ! coordinates that are held already stay so, and independent ones come before others
      order = [pack([(i, i=1, n)], [(is_held(i), i=1, n)]), &
               pack([(i, i=1, n)], [(.not. is_held(i) .and. is_independent(i), i=1, n)]), &
               pack([(i, i=1, n)], [(.not. (is_held(i) .or. is_independent(i)), i=1, n)])]
      allocate (resting%leaders(0))
      do j = 1, n
        l = order(j)
        if (.not. resting%rests(l)) cycle
        if (.not. left(l, l) > tied*scales(l)) cycle
        resting%leaders = [resting%leaders, l]
        left = left - spread(left(:, l), 2, n)*spread(left(l, :), 1, n)/left(l, l)
      end do
      allocate (resting%by_leaders(size(resting%leaders), n), source=0.0_wp)
      call find_rates(mobility, resting%leaders, resting%by_leaders)
    end associate
  contains
    !> Whether a drive holds the coordinate in place of the sticking pair.
    logical function is_held(i)
      integer, intent(in) :: i   !< number of the friction

      is_held = any(system%friction%held == system%model%mechanism%frictions(i)%coordinate)
    end function is_held

    !> Whether the coordinate is independent now.
    logical function is_independent(i)
      integer, intent(in) :: i   !< number of the friction

      is_independent = any(system%plan%independent == system%model%mechanism%frictions(i)%coordinate)
    end function is_independent
  end subroutine find_freedoms

  !> The rates of all pairs by those of the leaders, from the mobilities: of least kinetic energy.
  pure subroutine find_rates(mobility, leaders, by_leaders)
    real(wp), intent(in) :: mobility(:, :)        !< (n,n) accelerations by forces
    integer, intent(in) :: leaders(:)             !< numbers of the leaders
    real(wp), intent(out) :: by_leaders(:, :)     !< (leaders,n) the rates
    real(wp) :: factors(size(leaders), size(leaders)), rates(size(leaders))
    integer :: i, failed_at

    factors = mobility(leaders, leaders)
    ! leaders are independent of each other, so that this does not fail
    call cholesky_factorize(size(leaders), factors, failed_at)
    do i = 1, size(mobility, 2)
      rates = mobility(leaders, i)
      call cholesky_solve(size(leaders), factors, rates)
      by_leaders(:, i) = rates
    end do
  end subroutine find_rates

  !> Let groups slip that cannot hold, one after the other. Where that does not lead to modes that agree with themselves, all are tried.
  subroutine release(system, before, met, modes, resting, err)
    class(motion_system_type), intent(inout) :: system         !< the system, with the equations of all frictions
    type(friction_modes_type), intent(in) :: before            !< how frictions acted before
    integer, intent(in) :: met                                 !< number of the friction that comes to rest or to its bound; 0: none
    type(friction_modes_type), intent(inout) :: modes          !< the modes, with the directions of pairs that slip; complete
    type(resting_pairs_type), intent(in) :: resting            !< the pairs at rest
    type(error_type), allocatable, intent(out) :: err          !< allocated if it failed
    real(wp) :: direction(size(resting%leaders))
    integer :: at_bound, l
    logical :: slips(size(resting%leaders)), agrees

    slips = .false.
    direction = 0.0_wp
    at_bound = 0
    if (met > 0) then
      if (before%group(met) > 0) at_bound = met
    end if
    ! in a later round contacts are others
    if (met == 0) then
      slips = system%friction%released(resting%leaders) .and. [(before%slips(resting%leaders(l)), l=1, size(slips))]
      where (slips) direction = before%direction(resting%leaders)
    end if
    call release_worst(err)
    if (agrees .or. allocated(err)) return
    if (size(slips) <= most_enumerated) call try_all(err)
    if (.not. (agrees .or. allocated(err))) call fail()
  contains
    !> Let the group slip that is used most, until the rest holds.
    subroutine release_worst(err)
      type(error_type), allocatable, intent(out) :: err   !< allocated if a pair would stick with several groups
      real(wp) :: used, most
      integer :: round, l, worst

      associate (balance => system%friction%balance, frictions => system%model%mechanism%frictions)
        do round = 0, size(resting%leaders)
          call join(err)
          if (allocated(err)) return
          call balance%solve(frictions, modes, agrees)
          if (.not. agrees) return
          worst = 0
          most = limit_of_sticking
          do l = 1, size(slips)
            if (slips(l)) cycle
            used = abs(balance%utilization(resting%leaders(l)))
            if (at_bound > 0) then
              if (modes%group(at_bound) == modes%group(resting%leaders(l)) .and. used > 1.0_wp - round_off_of_sticking) &
                used = max(used, 2.0_wp)
            end if
            if (used <= most) cycle
            most = used
            worst = l
          end do
          if (worst == 0) exit
          slips(worst) = .true.
          direction(worst) = sign(1.0_wp, balance%utilization(resting%leaders(worst)))
        end do
      end associate
      call check_directions()
    end subroutine release_worst

    !> Check that pairs that begin to slip have accelerations in their directions. Where other frictions decide where a pair turns to, its
    !> direction changes.
    subroutine check_directions()
      integer :: l

      associate (balance => system%friction%balance, frictions => system%model%mechanism%frictions)
        do l = 1, size(frictions)
          if (.not. ((resting%rests(l) .or. resting%turns(l)) .and. modes%slips(l))) cycle
          if (modes%direction(l)*balance%acceleration(l) >= -tied*(abs(balance%accelerations(l)) &
                                                                  + sum(abs(balance%mobility(l, :)*balance%force)))) cycle
          agrees = resting%turns(l)
          if (agrees) then
            modes%direction(l) = -modes%direction(l)
            call balance%solve(frictions, modes, agrees)
          end if
          if (.not. agrees) return
        end do
      end associate
    end subroutine check_directions

    !> Try all choices of groups that stick or slip in either direction, until one agrees with itself.
    subroutine try_all(err)
      type(error_type), allocatable, intent(out) :: err   !< never allocated
      type(error_type), allocatable :: unused
      integer :: choice, l, way

      do choice = 0, 3**size(slips) - 1
        do l = 1, size(slips)
          way = mod(choice/3**(l - 1), 3)
          slips(l) = way > 0
          direction(l) = real(merge(1, merge(-1, 0, way == 2), way == 1), wp)
        end do
        agrees = .false.
        call join(unused)
        if (allocated(unused)) cycle
        call system%friction%balance%solve(system%model%mechanism%frictions, modes, agrees)
        if (.not. agrees) cycle
        do l = 1, size(slips)
          if (slips(l)) cycle
          agrees = agrees .and. abs(system%friction%balance%utilization(resting%leaders(l))) <= limit_of_sticking
        end do
        if (agrees) call check_directions()
        if (agrees) return
      end do
    end subroutine try_all

    !> Join the pairs at rest in groups. A pair moves with the leaders on whose rates it depends.
    subroutine join(err)
      type(error_type), allocatable, intent(out) :: err   !< allocated if a pair would stick with several groups
      real(wp) :: part
      integer :: i, k, stuck

      modes%leader = pack(resting%leaders, .not. slips)
      do i = 1, size(modes%group)
        if (.not. resting%rests(i)) cycle
        modes%group(i) = 0
        modes%direction(i) = 0.0_wp
        part = 0.0_wp
        stuck = 0
        do k = 1, size(slips)
          if (abs(resting%by_leaders(k, i))*sqrt(system%friction%mobility(resting%leaders(k), resting%leaders(k))) <= &
              tied*sqrt(system%friction%mobility(i, i))) cycle
          if (slips(k)) then
            part = part + resting%by_leaders(k, i)*direction(k)
          else
            stuck = stuck + 1
            modes%group(i) = k - count(slips(:k))
            modes%direction(i) = sign(1.0_wp, resting%by_leaders(k, i))
          end if
        end do
        if (abs(part) > 0.0_wp) then
          modes%group(i) = 0
          modes%direction(i) = sign(1.0_wp, part)
        else if (stuck > 1) then
          call raise(err, exit_singular, failure_shared_sticking)
          err%failure%t = system%state%t
          associate (frictions => system%model%mechanism%frictions)
            err%failure%coordinates = [frictions(i)%coordinate, frictions(modes%leader)%coordinate]
          end associate
          return
        end if
      end do
    end subroutine join

    !> Fail because it was not found which pairs stick.
    subroutine fail()
      if (system%friction%balance%least_determinant(system%model%mechanism%frictions, modes) <= 0.0_wp) then
        system%friction%modes = modes
        call fail_in_paradox(system, err)
        return
      end if
      call raise(err, exit_singular, failure_undecided_friction)
      err%failure%t = system%state%t
      err%failure%coordinates = pack(system%model%mechanism%frictions%coordinate, resting%rests)
    end subroutine fail
  end subroutine release

  !> Fail because frictions of pairs and contacts of links were not found to agree.
  subroutine fail_undecided(system, err)
    class(motion_system_type), intent(in) :: system            !< the system
    type(error_type), allocatable, intent(out) :: err          !< the failure

    call raise(err, exit_singular, failure_undecided_friction)
    err%failure%t = system%state%t
    err%failure%coordinates = system%model%mechanism%frictions%coordinate
  end subroutine fail_undecided

  !> Fail because frictions have no solution or several in the present state of the system.
  subroutine fail_in_paradox(system, err)
    class(motion_system_type), intent(in) :: system            !< the system, with the equations of its frictions
    type(error_type), allocatable, intent(out) :: err          !< the failure
    integer :: worst

    call raise(err, exit_singular, failure_paradox)
    associate (frictions => system%model%mechanism%frictions, modes => system%friction%modes, balance => system%friction%balance)
      worst = balance%steepest(frictions, modes)
      if (worst == 0) then
        call fail_undecided(system, err)
        return
      end if
      err%failure%t = system%state%t
      err%failure%coordinates = [frictions(worst)%coordinate]
      err%failure%values = reshape(frictions(worst)%dynamic*[1.0_wp, balance%least_factor(frictions, modes)], [1, 2])
      err%failure%number = merge(1, 2, balance%grows(frictions, modes, worst))
      err%failure%growing = count(modes%group == 0 .and. abs(modes%direction) > 0.0_wp)
      call add_place(err, place=frictions(worst)%place)
    end associate
  end subroutine fail_in_paradox
end module mech9_friction_events
