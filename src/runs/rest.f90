!> Equilibria of a model, from its assembly on: what --equilibrium, --modes and --linear find.
module mech9_rest
  use mech9_kinds, only: wp, pi
  use mech9_text, only: to_text
  use mech9_error, only: error_type, raise, add_place, exit_data, exit_assembly, exit_interrupted
  use mech9_dynamics_failures, only: failure_no_inertia
  use mech9_model, only: model_type
  use mech9_partition, only: free_coordinate, driven_coordinate
  use mech9_plan, only: plan_type
  use mech9_state, only: state_type
  use mech9_planning, only: planning_settings_type, make_plan
  use mech9_start_path, only: start_way_type
  use mech9_simulation, only: interruption_type
  use mech9_resting_mechanism, only: resting_type
  use mech9_linearised_equilibrium, only: equilibrium_type, copy_equilibrium
  use mech9_mode_shapes, only: displacement, position_in_vibration
  use mech9_film, only: film_type, new_film
  use mech9_equilibria, only: find_equilibrium, find_equilibria
  use mech9_contact_rest, only: has_rigid_contacts, find_rest_on_contacts, find_all_on_contacts, bearing_contact
  use mech9_explained_assembly, only: assemble_model
  use mech9_reactions, only: reactions_type
  use mech9_single_reactions, only: find_single_reactions
  use mech9_rest_on_stops, only: end_type, rigid_ends, hold_ends, next_choice
  implicit none
  private
  public :: rest_type, is_interruption

  !> Parts are polymorphic, which keeps the code of copies small.
  type :: rest_type
    class(plan_type), allocatable :: plan                !< of the mechanism, in space
    class(state_type), allocatable :: start              !< the closed position at the start, with the motion of the drives
    type(start_way_type) :: way                          !< how the start was reached from the drawn position
    type(equilibrium_type), allocatable :: equilibria(:) !< the one to which the start leads, or those of many starts
  contains
    procedure :: assemble
    procedure :: find
    procedure :: film_mode
  end type rest_type

  !> Pictures of one period of a mode, and the amplitude of the largest free coordinate in them [rad, lengths of the mechanism].
  integer, parameter :: pictures_of_period = 49
  real(wp), parameter :: shown_amplitude = 0.2_wp
  !> A position lies behind a stop by more than this in the unit of the coordinate: equilibria are found to 1e-9 and better.
  real(wp), parameter :: behind_stop = 1.0e-9_wp
  !> Choices of ends that are tried at most: all of seven ends.
  integer, parameter :: most_choices = 128

contains

  !> Find plan and closed position at the start, in space, with the motion of the driven coordinates. Fails with exit_data where
  !> every independent coordinate is driven.
  subroutine assemble(self, model, err)
    class(rest_type), intent(inout) :: self             !< gets them; without equilibria
    type(model_type), intent(in) :: model               !< the model
    type(error_type), allocatable, intent(out) :: err   !< allocated if it failed

    if (allocated(self%equilibria)) deallocate (self%equilibria)
    allocate (self%equilibria(0))
    if (.not. any(model%problem%partition%kind == free_coordinate)) then
      call raise(err, exit_data, 'every independent coordinate is driven, so that none can come to rest; leave out a &drive', &
                 model%problem%drives(1)%drive%place)
      return
    end if
    if (.not. allocated(self%plan)) allocate (self%plan, self%start)
    call assemble_at_rest(self, model, err)
  end subroutine assemble

  !> Find plan and closed position at the start, in space, with the motion of the driven coordinates.
  subroutine assemble_at_rest(self, model, err)
    class(rest_type), intent(inout) :: self             !< with room for plan and start; gets them
    type(model_type), intent(in) :: model               !< the model
    type(error_type), allocatable, intent(out) :: err   !< allocated if it failed
    class(plan_type), allocatable :: first_plan
    class(state_type), allocatable :: first_start
    integer :: i, k

    allocate (first_plan, first_start)
    call assemble_model(model, first_plan, first_start, err, self%way)
    if (.not. allocated(err)) &
      call make_plan(model%mechanism, model%problem%partition, first_start%q, self%plan, self%start, err, &
                     planning_settings_type(in_space=.true.))
    if (allocated(err)) return
    associate (start => self%start)
      start%t = model%request%time%start
      do i = 1, size(model%problem%drives)
        k = model%problem%drives(i)%drive%coordinate
        if (model%problem%partition%kind(k) /= driven_coordinate) cycle
        call model%problem%drives(i)%drive%evaluate(start%t, start%q(k), start%dq(k), start%ddq(k), err)
        if (allocated(err)) return
      end do
    end associate
  end subroutine assemble_at_rest

  !> Find the equilibrium to which the start leads, or those of many starts. Fails with exit_assembly where there is none, and with
  !> exit_interrupted where the search is stopped; the equilibria that were found before are then there.
  subroutine find(self, model, starts, with_modes, err, interruption)
    class(rest_type), intent(inout) :: self                          !< assembled; gets the equilibria
    type(model_type), intent(in) :: model                            !< the model
    integer, intent(in) :: starts                                    !< number of random starts; 0: the start of the model alone
    logical, intent(in) :: with_modes                                !< modes are needed, and so is inertia of every free coordinate
    type(error_type), allocatable, intent(out) :: err                !< allocated if it failed
    class(interruption_type), intent(in), optional :: interruption   !< is asked before each start
    type(equilibrium_type), allocatable :: found(:)

    if (starts > 0 .and. has_rigid_contacts(model%mechanism)) then
      call find_all_on_contacts(model, self%plan, self%start, starts, found, err, interruption)
    else if (starts > 0) then
      call find_equilibria(model, self%plan, self%start, starts, found, err, interruption)
    else
      allocate (found(1))
      call find_one(model, self%plan, self%start, found(1), err)
      if (allocated(err)) deallocate (found)
    end if
    if (model%mechanism%has_rigid_ends()) then
      if (allocated(err)) then
        if (err%code == exit_assembly .and. .not. allocated(found)) allocate (found(0))
      end if
      if (allocated(found)) call leave_out_behind_stops(model, found)
      if (allocated(found) .and. .not. is_interruption(err)) then
        if (starts > 0 .or. size(found) == 0) call find_on_stops(model, starts > 0, found)
        if (size(found) > 0 .and. allocated(err)) deallocate (err)
        if (size(found) == 0 .and. .not. allocated(err)) call raise(err, exit_assembly, 'the loads balance only behind rigid '// &
          'stops, and no position of rest against a stop was found from the initial position; give another initial position')
      end if
    end if
    if (.not. allocated(err)) call refuse_moving_drives(model, self%start, found, err)
    if (.not. allocated(err) .and. with_modes) call need_inertia(model, found(1), err)
    if (.not. allocated(err) .or. is_interruption(err)) call move_alloc(found, self%equilibria)
  end subroutine find

  !> Find the position of rest to which a position leads, on contacts where these bear.
  subroutine find_one(model, plan, start, found, err)
    type(model_type), intent(in) :: model               !< the model
    type(plan_type), intent(in) :: plan                 !< its plan, in space
    type(state_type), intent(in) :: start               !< closed, with the motion of the driven coordinates
    type(equilibrium_type), intent(out) :: found        !< the position of rest
    type(error_type), allocatable, intent(out) :: err   !< allocated if it failed

    if (has_rigid_contacts(model%mechanism)) then
      call find_rest_on_contacts(model, plan, start, found, err)
    else
      call find_equilibrium(model%mechanism, model%problem%partition, plan, start, found, err)
    end if
  end subroutine find_one

  !> Fail where a rigid contact bears while a drive moves: the gap would have to stay closed beside the drive.
  subroutine refuse_moving_drives(model, start, found, err)
    type(model_type), intent(in) :: model               !< the model
    type(state_type), intent(in) :: start               !< with the motion of the driven coordinates
    type(equilibrium_type), intent(in) :: found(:)      !< positions of rest
    type(error_type), allocatable, intent(out) :: err   !< allocated where one is refused
    integer :: i, k

    associate (is_driven => model%problem%partition%kind == driven_coordinate)
      k = findloc(is_driven .and. (abs(start%dq) > 0.0_wp .or. abs(start%ddq) > 0.0_wp), .true., dim=1)
    end associate
    if (k == 0) return
    do i = 1, size(found)
      associate (number => bearing_contact(model%mechanism, found(i)))
        if (number == 0) cycle
        call raise(err, exit_data, 'contact '//to_text(number)//' bears at rest while the drive of coordinate '//to_text(k)// &
                   ' moves; hold the drive, or make the contact compliant by stiffness=')
      end associate
      err%place = model%mechanism%contacts(findloc(model%mechanism%contacts%number, bearing_contact(model%mechanism, found(i)), &
                                                   dim=1))%place
      return
    end do
  end subroutine refuse_moving_drives

  !> Leave out positions of rest that lie behind rigid stops.
  subroutine leave_out_behind_stops(model, found)
    type(model_type), intent(in) :: model                              !< the model
    type(equilibrium_type), allocatable, intent(inout) :: found(:)     !< equilibria
    logical :: behind(size(found))
    integer :: i

    do i = 1, size(found)
      behind(i) = is_behind_stop(model, found(i)%resting)
    end do
    if (.not. any(behind)) return
    call take_places(pack([(i, i=1, size(found))], .not. behind), count(.not. behind), found)
  end subroutine leave_out_behind_stops

  !> Make a list of some of the equilibria of a list, with room for others behind them.
  subroutine take_places(places, n, list)
    integer, intent(in) :: places(:)                                 !< of those that stay, in their order
    integer, intent(in) :: n                                         !< length afterwards
    type(equilibrium_type), allocatable, intent(inout) :: list(:)    !< equilibria
    type(equilibrium_type), allocatable :: taken(:)
    integer :: i

    allocate (taken(n))
    do i = 1, size(places)
      call copy_equilibrium(list(places(i)), taken(i))
    end do
    call move_alloc(taken, list)
  end subroutine take_places

  !> Find rest against rigid stops, from the start of the model: the first choice of ends that serves, or all of them. The ends are tried
  !> one by one, then two together, and so on.
  subroutine find_on_stops(model, all_choices, found)
    type(model_type), intent(in) :: model                              !< the model
    logical, intent(in) :: all_choices                                 !< all that serve are wanted
    type(equilibrium_type), allocatable, intent(inout) :: found(:)     !< equilibria so far; gets more
    type(end_type), allocatable :: ends(:)
    class(equilibrium_type), allocatable :: candidate
    integer, allocatable :: choice(:)
    integer :: n_free, trial, i
    logical :: serves

    allocate (candidate)
    call rigid_ends(model, ends)
    n_free = count(model%problem%partition%kind == free_coordinate)
    choice = [1]
    do trial = 1, most_choices
      if (size(choice) > min(size(ends), n_free)) return
      call rest_on(model, ends(choice), candidate, serves)
      if (serves) then
        call take_places([(i, i=1, size(found))], size(found) + 1, found)
        call copy_equilibrium(candidate, found(size(found)))
        if (.not. all_choices) return
      end if
      call next_choice(size(ends), choice)
    end do
  end subroutine find_on_stops

  !> Find rest against some ends of stops. It does not serve where there is none, an end does not push, or another is passed.
  subroutine rest_on(model, ends, found, serves)
    type(model_type), intent(in) :: model              !< the model
    type(end_type), intent(in) :: ends(:)              !< the ends
    type(equilibrium_type), intent(out) :: found       !< the equilibrium, with the forces of the stops
    logical, intent(out) :: serves                     !< it was found
    class(rest_type), allocatable :: rest
    class(model_type), allocatable :: held
    type(error_type), allocatable :: err
    integer :: exchange

    serves = .false.
    allocate (rest, held)
    do exchange = 1, count(model%problem%partition%kind == free_coordinate)
      call hold_ends(model, ends, exchange, held, serves)
      if (.not. serves) return
      allocate (rest%plan, rest%start)
      call assemble_at_rest(rest, held, err)
      if (.not. allocated(err)) &
        call find_one(held, rest%plan, rest%start, found, err)
      serves = .not. allocated(err)
      if (serves) exit
      deallocate (rest%plan, rest%start)
    end do
    if (serves) serves = .not. is_behind_stop(model, found%resting)
    if (serves) call find_pushing(model, ends, found, serves)
  end subroutine rest_on

  !> Find the forces of the stops that hold coordinates, and whether all of them push.
  subroutine find_pushing(model, ends, found, push)
    type(model_type), intent(in) :: model                !< the model
    type(end_type), intent(in) :: ends(:)                !< the ends that hold
    type(equilibrium_type), intent(inout) :: found       !< the equilibrium; gets the forces
    logical, intent(out) :: push                         !< all of them push
    class(reactions_type), allocatable :: reactions
    type(error_type), allocatable :: err
    integer :: i

    push = .false.
    associate (state => found%resting%state)
      call find_single_reactions(model%mechanism, found%resting%plan, state, reactions, err)
      if (allocated(err)) return
      allocate (state%stop_force(size(model%mechanism%stops)), source=0.0_wp)
      push = .true.
      do i = 1, size(ends)
        associate (force => reactions%needed(model%mechanism%stops(ends(i)%stop)%coordinate))
          state%stop_force(ends(i)%stop) = force
          push = push .and. ends(i)%direction*force > 0.0_wp
        end associate
      end do
    end associate
  end subroutine find_pushing

  !> Whether a mechanism rests behind a rigid stop.
  pure logical function is_behind_stop(model, resting) result(is_behind)
    type(model_type), intent(in) :: model        !< the model
    type(resting_type), intent(in) :: resting    !< the mechanism at rest
    integer :: i, end

    is_behind = .true.
    do i = 1, size(model%mechanism%stops)
      associate (stop => model%mechanism%stops(i))
        if (.not. stop%is_rigid) cycle
        do end = 1, 2
          if (stop%gap(end, resting%state%q(stop%coordinate)) < -behind_stop*resting%plan%unit_of(stop%coordinate)) return
        end do
      end associate
    end do
    is_behind = .false.
  end function is_behind_stop

  !> Fail because modes and linearised equations of motion need the inertia of each free coordinate.
  subroutine need_inertia(model, equilibrium, err)
    type(model_type), intent(in) :: model               !< the model
    type(equilibrium_type), intent(in) :: equilibrium   !< the equilibrium
    type(error_type), allocatable, intent(out) :: err   !< allocated if one has none

    if (equilibrium%without_inertia == 0) return
    call raise(err, exit_data, failure_no_inertia)
    err%failure%coordinates = [equilibrium%without_inertia]
    call add_place(err, place=model%mechanism%pairs(equilibrium%without_inertia)%pair%place)
  end subroutine need_inertia

  !> Whether a failure is an interruption.
  pure logical function is_interruption(err)
    type(error_type), allocatable, intent(in) :: err   !< a failure, or none

    is_interruption = .false.
    if (allocated(err)) is_interruption = err%code == exit_interrupted
  end function is_interruption

  !> Film one period of a mode of the first equilibrium. Positions in which chains do not close are left out.
  subroutine film_mode(self, model, mode, film, err)
    class(rest_type), intent(in) :: self                    !< with the modes of its first equilibrium
    type(model_type), intent(in) :: model                   !< the model
    integer, intent(in) :: mode                             !< number of the mode
    type(film_type), intent(out) :: film                    !< the positions, each with its time
    type(error_type), allocatable, intent(out) :: err       !< allocated if it failed
    type(state_type) :: position
    real(wp) :: phase, period
    integer :: i
    logical :: found

    associate (equilibrium => self%equilibria(1))
      period = 1.0_wp
      if (abs(aimag(equilibrium%modes%roots(mode))) > 0.0_wp) period = 2.0_wp*pi/abs(aimag(equilibrium%modes%roots(mode)))
      film = new_film(model%mechanism, model%problem%partition%independent(), pictures_of_period)
      do i = 1, pictures_of_period
        phase = 2.0_wp*pi*(i - 1)/(pictures_of_period - 1)
        call position_in_vibration(model%mechanism, equilibrium, displacement(equilibrium, mode, shown_amplitude, phase), &
                                   position, found, err)
        if (allocated(err)) return
        if (.not. found) cycle
        position%t = period*(i - 1)/(pictures_of_period - 1)
        call film%take(model%mechanism, equilibrium%resting%plan, position, [position%t])
      end do
    end associate
  end subroutine film_mode
end module mech9_rest
