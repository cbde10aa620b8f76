!> Positions of a mechanism for given values of its independent coordinates. Each position is the one to which the mechanism moves
!> from its assembled start when its independent coordinates move to their values along a straight line, so that no position depends
!> on others that are asked for.
module mech9_followed_positions
  use, intrinsic :: ieee_arithmetic, only: ieee_value, ieee_quiet_nan, ieee_is_finite
  use mech9_program_kind, only: kinematics
  use mech9_kinds, only: wp
  use mech9_tolerances, only: singular_conditioning
  use mech9_error, only: error_type, raise, exit_usage, exit_data, exit_singular, exit_interrupted
  use mech9_text, only: to_text
  use mech9_counted, only: counted
  use mech9_sorting, only: sort_by
  use mech9_model, only: model_type
  use mech9_partition, only: driven_coordinate
  use mech9_plan, only: plan_type
  use mech9_state, only: state_type, copy_state
  use mech9_lane_group, only: lanes, is_plain
  use mech9_lane_tolerances, only: closed
  use mech9_lane_path, only: lane_path_type
  use mech9_block_solver, only: block_work_type, new_block_work, factorize_block, solve_motion
  use mech9_straight_drives, only: straight_drives
  use mech9_closure_guard, only: closes_well
  use mech9_simulation, only: interruption_type
  use mech9_driven_simulation, only: driven_simulation_type
  use mech9_model_motion, only: model_motion_type
  use mech9_checked_mechanism, only: checked_mechanism_type
  implicit none
  private
  public :: followed_positions_type

  !> It must not be copied.
  type :: followed_positions_type
    private
    type(model_type), pointer :: model => null()       !< owned; its drives move the independent coordinates along a line
    type(model_motion_type) :: motion                  !< from the assembled start
    integer, allocatable :: moved(:)                   !< (I) the independent coordinates that the user moves, in the order of cq
    integer, allocatable :: driven(:)                  !< (D) these, and the angles that the program holds
    type(lane_path_type), allocatable :: beside        !< positions side by side; allocated once they are asked for
    integer, public :: most_bits = 512                    !< of the vector registers that are used
    integer, public :: found_beside = 0                   !< positions of the last call that were found side by side
  contains
    procedure :: begin
    procedure :: coordinates
    procedure :: independent
    procedure :: find
    procedure, private :: fits_lanes
    procedure :: close => close_positions
  end type followed_positions_type

  !> Positions on one side of the start from which on they are found side by side: with fewer, a lane would have too few.
  integer, parameter :: worth_lanes = 4*lanes
  !> Shortest way from the start, far below round-off [rad, m].
  real(wp), parameter :: least_way = 1.0e-30_wp
  !> Positions of each lane after which it is asked whether the search shall stop.
  integer, parameter :: positions_at_once = 256

contains

  !> Assemble the mechanism at its start. Drives need not be there. Fails with exit_data, exit_structure or exit_assembly where the
  !> mechanism cannot be put together.
  subroutine begin(self, mechanism, err)
    class(followed_positions_type), intent(inout) :: self            !< the positions
    type(checked_mechanism_type), intent(in) :: mechanism            !< the mechanism
    type(error_type), allocatable, intent(out) :: err                !< allocated if it failed
    integer :: k

    call self%close()
    allocate (self%model)
    call mechanism%take_standing(self%model, err)
    if (.not. allocated(err)) call self%motion%assemble(self%model, err)
    call mechanism%point_at(err)
    if (allocated(err)) then
      call self%close()
      return
    end if
    associate (model => self%model, kind => self%model%problem%partition%kind)
      self%driven = pack([(k, k=1, size(kind))], model%problem%partition%independent())
      self%moved = pack(self%driven, [(.not. is_held(model, self%driven(k)), k=1, size(self%driven))])
      call mechanism%order_as_given(self%moved)
      where (model%problem%partition%independent()) kind = driven_coordinate
      model%program = kinematics
      if (allocated(model%request%output%coordinates)) deallocate (model%request%output%coordinates)
      model%request%output%derivatives = 2
      model%request%time%start = 0.0_wp
      model%request%time%end = 1.0_wp
    end associate
  end subroutine begin

  !> Whether the program itself holds an independent coordinate, as the idle angle of a rod.
  pure logical function is_held(model, coordinate)
    type(model_type), intent(in) :: model    !< the model
    integer, intent(in) :: coordinate        !< number of the coordinate
    integer :: i

    is_held = .false.
    do i = 1, size(model%problem%drives)
      associate (drive => model%problem%drives(i)%drive)
        is_held = is_held .or. (drive%coordinate == coordinate .and. drive%place%line == 0)
      end associate
    end do
  end function is_held

  !> Number of coordinates; 0 where no mechanism is assembled.
  pure integer function coordinates(self)
    class(followed_positions_type), intent(in) :: self   !< the positions

    coordinates = 0
    if (associated(self%model)) coordinates = size(self%model%mechanism%pairs)
  end function coordinates

  !> The independent coordinates, in the order in which their values are given: that of cq in the data file.
  pure subroutine independent(self, numbers)
    class(followed_positions_type), intent(in) :: self   !< the positions
    integer, allocatable, intent(out) :: numbers(:)      !< (I) their numbers

    if (allocated(self%moved)) then
      numbers = self%moved
    else
      allocate (numbers(0))
    end if
  end subroutine independent

  !> Find positions, and rates and accelerations in them. A position that is not reached has the exit code of its failure, and is not
  !> a number; singular positions of several independent coordinates have exit_singular and no rates; one with a value that is not finite has exit_data. Fails with exit_usage where no mechanism is assembled or the arrays
  !> have other shapes, with exit_interrupted where the search is stopped.
  subroutine find(self, values, q, codes, err, interruption, rates, dq, accelerations, ddq)
    class(followed_positions_type), intent(inout) :: self           !< the positions
    real(wp), intent(in) :: values(:, :)                            !< (I,n) of the independent coordinates [unit of the data file]
    real(wp), intent(out) :: q(:, :)                                !< (M,n) all coordinates [unit of the data file]
    integer, intent(out) :: codes(:)                                !< (n) 0, or the exit code of the failure
    type(error_type), allocatable, intent(out) :: err               !< allocated if it failed
    class(interruption_type), intent(in), optional :: interruption  !< is asked whether the search shall stop
    real(wp), intent(in), optional :: rates(:, :)                   !< (I,n) of the independent coordinates [unit of the data file]
    real(wp), intent(out), optional :: dq(:, :)                     !< (M,n) rates of all coordinates [unit of the data file]
    real(wp), intent(in), optional :: accelerations(:, :)           !< (I,n) of the independent coordinates [unit/s^2]
    real(wp), intent(out), optional :: ddq(:, :)                    !< (M,n) second derivatives of all coordinates [unit/s^2]
    integer, allocatable :: places(:)
    logical :: found(size(codes))
    integer :: i, below

    found = .false.
    self%found_beside = 0
    q = ieee_value(1.0_wp, ieee_quiet_nan)
    codes = 0
    if (present(dq)) dq = ieee_value(1.0_wp, ieee_quiet_nan)
    if (present(ddq)) ddq = ieee_value(1.0_wp, ieee_quiet_nan)
    if (.not. associated(self%model)) then
      call raise(err, exit_usage, 'a mechanism must be assembled before its positions are asked for')
    else if (size(values, 1) /= size(self%moved)) then
      call raise(err, exit_usage, 'the mechanism has '//counted(size(self%moved), 'independent coordinate')// &
                 '; each position needs that many values, not '//to_text(size(values, 1)))
    end if
    if (allocated(err)) return
    codes = merge(0, exit_data, all(ieee_is_finite(values), dim=1))
    if (present(rates)) codes = merge(codes, exit_data, all(ieee_is_finite(rates), dim=1))
    if (present(accelerations)) codes = merge(codes, exit_data, all(ieee_is_finite(accelerations), dim=1))
    places = pack([(i, i=1, size(codes))], codes == 0)
    if (size(self%moved) == 1) then
      ! on a line all positions on one side of the start lie on one path
      call sort_by(values(1, :), places)
      below = count(values(1, places) < self%motion%start%q(self%moved(1))/unit(self, 1))
      call follow_side(self, places(below + 1:), 1.0_wp)
      call follow_side(self, places(below:1:-1), -1.0_wp)
    else
      call follow_lines(self, places)
      do i = 1, size(places)
        if (allocated(err)) return
        if (.not. found(places(i))) call follow_line(self, places(i))
      end do
    end if
    self%found_beside = count(found)

  contains

    !> Find positions of one independent coordinate on one side of the start: side by side as far as this is possible.
    subroutine follow_side(self, places, direction)
      class(followed_positions_type), intent(inout) :: self   !< the positions
      integer, intent(in) :: places(:)                        !< of the positions among all, in the order of the path
      real(wp), intent(in) :: direction                       !< 1 upwards, -1 downwards [1]

      if (allocated(err)) return
      if (size(places) >= worth_lanes) call follow_stretches(self, places, direction)
      call follow_path(self, pack(places, .not. found(places)), direction)
    end subroutine follow_side

    !> Find positions of one independent coordinate on one side of the start side by side: each lane follows a stretch of the path from
    !> its first position on. The motion goes to these first positions.
    subroutine follow_stretches(self, places, direction)
      class(followed_positions_type), intent(inout), target :: self   !< the positions
      integer, intent(in) :: places(:)                                !< of the positions among all, in the order of the path
      real(wp), intent(in) :: direction                               !< 1 upwards, -1 downwards [1]
      type(error_type), allocatable :: failure
      type(driven_simulation_type), pointer :: driven
      real(wp) :: x(size(places)), ways(size(self%driven)), goals(lanes)
      integer :: first(lanes + 1), j, l

      if (.not. self%fits_lanes()) return
      ways = merge(direction, 0.0_wp, self%driven == self%moved(1))
      x = [(way_to(self, places(j)), j=1, size(places))]
      first = [(1 + int(real(size(places), wp)*(l - 1)/lanes), l=1, lanes + 1)]
      call start_line(self, ways, failure, interruption)
      if (allocated(failure)) return
      driven => self%motion%driven()
      self%beside%goes_on = .false.
      do l = 1, lanes
        call self%motion%simulation%advance(x(first(l)), failure)
        if (allocated(failure)) exit
        call take_position(self, places(first(l)), failure, direction)
        found(places(first(l))) = .true.
        call self%beside%place(driven%plan, driven%driven%state%q, driven%driven%monitors%largest_pivot, l)
        call self%beside%lead(l, self%motion%start%q(self%driven), ways, x(first(l)))
      end do
      if (allocated(failure)) then
        if (failure%code == exit_interrupted) call move_alloc(failure, err)
      end if
      if (allocated(err) .or. .not. any(self%beside%goes_on)) return
      call self%beside%start()
      do j = 1, maxval(first(2:) - first(:lanes)) - 1
        call self%beside%leave(first(:lanes) + j >= first(2:))
        if (.not. any(self%beside%goes_on)) exit
        goals = x(min(first(:lanes) + j, size(x)))
        call self%beside%go_to(goals)
        call take_lanes(self, places(min(first(:lanes) + j, size(x))), direction)
        if (mod(j, positions_at_once) == 0) call self%motion%simulation%stop_if_interrupted(x(first(2)), err)
        if (allocated(err)) return
      end do
    end subroutine follow_stretches

    !> Find positions at the ends of lines from the start, several lines side by side.
    subroutine follow_lines(self, places)
      class(followed_positions_type), intent(inout), target :: self   !< the positions
      integer, intent(in) :: places(:)                                !< of the positions among all
      type(error_type), allocatable :: failure
      type(driven_simulation_type), pointer :: driven
      integer :: first, l
      real(wp) :: none(size(self%driven))

      if (.not. self%fits_lanes() .or. size(places) < 2) return
      none = 0.0_wp
      call start_line(self, none, failure, interruption)
      if (allocated(failure)) return
      driven => self%motion%driven()
      do first = 1, size(places), lanes
        self%beside%goes_on = .false.
        do l = 1, min(lanes, size(places) - first + 1)
          call self%beside%place(driven%plan, driven%driven%state%q, driven%driven%monitors%largest_pivot, l)
          call self%beside%lead(l, self%motion%start%q(self%driven), distances(self, places(first + l - 1)), 0.0_wp)
        end do
        if (any(self%beside%goes_on)) call self%beside%start()
        call self%beside%go_to([(1.0_wp, l=1, lanes)])
        call take_lanes(self, places([(min(first + l - 1, size(places)), l=1, lanes)]), 1.0_wp)
        call self%motion%simulation%stop_if_interrupted(1.0_wp, err)
        if (allocated(err)) return
      end do
    end subroutine follow_lines

    !> Take the present positions of all lanes that go on, with rates and accelerations.
    subroutine take_lanes(self, places, direction)
      class(followed_positions_type), intent(inout) :: self   !< the positions
      integer, intent(in) :: places(:)                        !< (lanes) of the positions among all
      real(wp), intent(in) :: direction                       !< of a single independent coordinate: 1 upwards, -1 downwards [1]
      real(wp) :: speeds(lanes, size(self%driven)), more(lanes, size(self%driven))
      integer :: i, k, l

      do l = 1, lanes
        if (self%beside%goes_on(l)) found(places(l)) = .true.
      end do
      call self%beside%take(0, self%motion%plan%result_unit, places, q)
      if (.not. present(dq)) return
      speeds = 0.0_wp
      more = 0.0_wp
      do i = 1, size(self%moved)
        k = findloc(self%driven, self%moved(i), dim=1)
        do l = 1, lanes
          if (.not. self%beside%goes_on(l)) cycle
          speeds(l, k) = rates(i, places(l))*self%motion%plan%rate_unit(self%moved(i))
          if (present(ddq)) more(l, k) = accelerations(i, places(l))*self%motion%plan%result_unit(self%moved(i))
        end do
      end do
      if (size(self%moved) == 1) then
        k = findloc(self%driven, self%moved(1), dim=1)
        call self%beside%change_speed(direction*speeds(:, k), direction*more(:, k))
      else
        call self%beside%renew_rates(speeds, more)
      end if
      call self%beside%take(1, self%motion%plan%rate_unit, places, dq)
      if (present(ddq)) call self%beside%take(2, self%motion%plan%result_unit, places, ddq)
    end subroutine take_lanes

    !> Find positions of one independent coordinate that follow each other on one side of the start.
    subroutine follow_path(self, places, direction)
      class(followed_positions_type), intent(inout) :: self   !< the positions
      integer, intent(in) :: places(:)                        !< of the positions among all, in the order of the path
      real(wp), intent(in) :: direction                       !< 1 upwards, -1 downwards [1]
      type(error_type), allocatable :: failure
      integer :: k

      if (allocated(err) .or. size(places) == 0) return
      call start_line(self, merge(direction, 0.0_wp, self%driven == self%moved(1)), failure, interruption)
      do k = 1, size(places)
        if (.not. allocated(failure)) &
          call self%motion%simulation%advance(way_to(self, places(k)), failure)
        call take_position(self, places(k), failure, direction)
        if (allocated(err)) return
      end do
    end subroutine follow_path

    !> Length of the way of a single independent coordinate from the start to a position.
    pure real(wp) function way_to(self, place)
      class(followed_positions_type), intent(in) :: self      !< the positions
      integer, intent(in) :: place                            !< of the position among all

      way_to = abs(values(1, place)*unit(self, 1) - self%motion%start%q(self%moved(1)))
      ! powers of shorter ways could be no numbers
      if (way_to < least_way) way_to = 0.0_wp
    end function way_to

    !> Find the position at the end of a line from the start.
    subroutine follow_line(self, place)
      class(followed_positions_type), intent(inout) :: self   !< the positions
      integer, intent(in) :: place                            !< of the position among all
      type(error_type), allocatable :: failure

      call start_line(self, distances(self, place), failure, interruption)
      if (.not. allocated(failure)) call self%motion%simulation%advance(1.0_wp, failure)
      call take_position(self, place, failure)
    end subroutine follow_line

    !> The way of the driven coordinates from the start to a position.
    pure function distances(self, place)
      class(followed_positions_type), intent(in) :: self      !< the positions
      integer, intent(in) :: place                            !< of the position among all
      real(wp) :: distances(size(self%driven))
      integer :: k

      distances = 0.0_wp
      do k = 1, size(self%moved)
        where (self%driven == self%moved(k)) &
          distances = values(k, place)*unit(self, k) - self%motion%start%q(self%moved(k))
      end do
    end function distances

    !> Take the present position, with rates and accelerations, or the code of a failure.
    subroutine take_position(self, place, failure, direction)
      class(followed_positions_type), intent(inout) :: self           !< the positions
      integer, intent(in) :: place                                    !< of the position among all
      type(error_type), allocatable, intent(inout) :: failure         !< the failure of this position, or of one before it
      real(wp), intent(in), optional :: direction                     !< of a single independent coordinate: 1 upwards, -1 downwards [1]
      type(plan_type), pointer :: plan
      type(state_type), pointer :: state
      type(state_type), allocatable :: moving
      logical :: regular

      if (allocated(failure)) then
        codes(place) = failure%code
        if (failure%code == exit_interrupted) call move_alloc(failure, err)
        return
      end if
      call self%motion%simulation%present(plan, state)
      q(:, place) = state%q/plan%result_unit
      if (.not. present(dq)) return
      if (present(direction)) then
        call take_speed(self, place, direction, plan, state)
        return
      end if
      allocate (moving)
      call copy_state(state, moving)
      if (present(ddq)) then
        call move(self, plan, rates(:, place), moving, regular, accelerations(:, place))
        if (regular) ddq(:, place) = moving%ddq/plan%result_unit
      else
        call move(self, plan, rates(:, place), moving, regular)
      end if
      if (regular) then
        dq(:, place) = moving%dq/plan%rate_unit
      else
        codes(place) = exit_singular
      end if
    end subroutine take_position

    !> Take rates and accelerations of the motion of a single independent coordinate, whose rate is 1 or -1 in the state, by the chain
    !> rule. It holds in singular positions, too, through which the motion goes.
    subroutine take_speed(self, place, direction, plan, state)
      class(followed_positions_type), intent(inout) :: self           !< the positions
      integer, intent(in) :: place                                    !< of the position among all
      real(wp), intent(in) :: direction                               !< 1 upwards, -1 downwards [1]
      type(plan_type), intent(in) :: plan                             !< the plan of the position
      type(state_type), intent(in) :: state                           !< the position
      real(wp) :: speed, acceleration

      speed = direction*rates(1, place)*plan%rate_unit(self%moved(1))
      dq(:, place) = state%dq*speed/plan%rate_unit
      if (.not. present(ddq)) return
      acceleration = direction*accelerations(1, place)*plan%result_unit(self%moved(1))
      ddq(:, place) = (state%ddq*speed**2 + state%dq*acceleration)/plan%result_unit
    end subroutine take_speed
  end subroutine find

  !> Whether positions can be found side by side.
  logical function fits_lanes(self)
    class(followed_positions_type), intent(inout) :: self   !< the positions

    if (.not. allocated(self%beside)) then
      allocate (self%beside)
      if (is_plain(self%model%mechanism) .and. closes_well(self%motion%plan, closed)) &
        call self%beside%begin(self%motion%plan, self%driven)
      self%beside%bits = min(self%beside%bits, self%most_bits)
    end if
    fits_lanes = self%beside%used
  end function fits_lanes

  !> Start a motion from the assembled start in which the independent coordinates move by given distances within 1 s.
  subroutine start_line(self, distances, err, interruption)
    type(followed_positions_type), intent(inout) :: self             !< the positions
    real(wp), intent(in) :: distances(:)                             !< (D) of the driven coordinates [rad, m]
    type(error_type), allocatable, intent(out) :: err                !< allocated if it failed
    class(interruption_type), intent(in), optional :: interruption   !< is asked whether the motion shall stop

    call straight_drives(self%driven, self%motion%start%q(self%driven), distances, self%model%problem%drives)
    call self%motion%prepare(self%model, err)
    if (.not. allocated(err)) call self%motion%simulation%start(err, interruption)
  end subroutine start_line

  !> Find rates and accelerations in a position, from those of the independent coordinates, which determine them where it is regular.
  subroutine move(self, plan, rates, state, regular, accelerations)
    type(followed_positions_type), intent(in) :: self           !< the positions
    type(plan_type), intent(in) :: plan                         !< the plan of the position
    real(wp), intent(in) :: rates(:)                            !< (I) [unit of the data file]
    type(state_type), intent(inout) :: state                    !< the position; gets rates and accelerations
    logical, intent(out) :: regular                             !< the position is not singular
    real(wp), intent(in), optional :: accelerations(:)          !< (I) [unit of the data file/s^2]; 0 unless given
    type(block_work_type) :: work
    integer :: b

    regular = .true.
    state%dq(self%driven) = 0.0_wp
    state%ddq(self%driven) = 0.0_wp
    state%dq(self%moved) = rates*plan%rate_unit(self%moved)
    if (present(accelerations)) state%ddq(self%moved) = accelerations*plan%result_unit(self%moved)
    do b = 1, size(plan%blocks)
      work = new_block_work(plan%blocks(b))
      call factorize_block(plan, plan%blocks(b), state, work)
      if (size(plan%blocks(b)%unknowns) > 0) regular = work%equations%conditioning() >= singular_conditioning
      if (.not. regular) return
      call solve_motion(plan, plan%blocks(b), state, work)
    end do
  end subroutine move

  !> Unit of the values of an independent coordinate in rad or m.
  pure real(wp) function unit(self, i)
    type(followed_positions_type), intent(in) :: self   !< the positions
    integer, intent(in) :: i                            !< number of the coordinate among those that the user moves

    unit = self%motion%plan%result_unit(self%moved(i))
  end function unit

  !> Free all memory. Another mechanism can then be assembled.
  subroutine close_positions(self)
    class(followed_positions_type), intent(inout) :: self   !< the positions

    call self%motion%close()
    if (associated(self%model)) deallocate (self%model)
    if (allocated(self%beside)) deallocate (self%beside)
    if (allocated(self%moved)) deallocate (self%moved, self%driven)
  end subroutine close_positions
end module mech9_followed_positions
