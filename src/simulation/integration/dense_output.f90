!> Dense output, that is, the motion between the ends of steps (Hairer, Norsett and Wanner in docs/reference/bibliography.md).
!>
!> Positions, rates and accelerations at the nearest points that are known, ends of steps and points inserted into the last
!> one, give a polynomial. Without the farthest of these points it is a worse one; where both agree within the
!> tolerance the better one is far inside it. Free coordinates are taken from there, the chains are closed by Newton's
!> method, and accelerations are worked out anew: every position is one of closed chains that satisfies (19).
module mech9_dense_output
  use mech9_kinds, only: wp
  use mech9_integration_tolerances, only: steepest_slope
  use mech9_error, only: error_type
  use mech9_hermite, only: hermite_type, build_hermite
  use mech9_motor, only: motor_action_type
  use mech9_motor_states, only: find_action
  use mech9_motion_system, only: motion_system_type
  implicit none
  private
  public :: dense_output_type

  !> Ends of steps that are kept, and points of a polynomial.
  integer, parameter :: most = 4
  !> Points inserted into a step.
  integer, parameter :: most_inserted = 3

  !> A point with closed chains: the end of a step, or inserted into one.
  type :: step_point_type
    real(wp) :: t = 0.0_wp                            !< time [s]
    real(wp), allocatable :: y(:)                     !< vector of the motion system
    integer, allocatable :: signs(:)                  !< signs of the determinants of the blocks' Jacobians
    logical :: is_known = .false.                     !< the following are known
    !> (M, motors, derivatives by parameters) coordinates, rates and accelerations; states of motors, derivatives by parameters, and
    !> their first and second derivatives in time
    real(wp), allocatable :: q(:), dq(:), ddq(:)
  end type step_point_type

  !> The ends of the last steps in the same independent coordinates, and the points inserted into the last step.
  type :: dense_output_type
    private
    type(step_point_type) :: points(most + most_inserted)   !< the ends in a ring, then the inserted points
    integer :: last = 0                               !< place of the end of the last step
    integer :: count = 0                              !< number of ends
    integer :: inserted = 0                           !< number of inserted points
    integer :: chosen(most) = 0                       !< places of the points of the polynomial, the nearest first
    type(hermite_type) :: polynomial                  !< all coordinates and states of motors over time
  contains
    procedure :: begin
    procedure :: add
    procedure :: insert
    procedure :: count_inserted
    procedure :: start_of_step
    procedure :: crosses
    procedure :: agrees
    procedure :: find
  end type dense_output_type

contains

  !> Forget all steps.
  pure subroutine begin(self)
    class(dense_output_type), intent(inout) :: self   !< the dense output

    self%count = 0
    self%inserted = 0
    self%chosen = 0
  end subroutine begin

  !> Add the end of a step, or the start of the first one; the last evaluation of the system must have been there.
  subroutine add(self, system, t, y)
    class(dense_output_type), intent(inout) :: self     !< the dense output
    type(motion_system_type), intent(inout) :: system   !< the system, evaluated at the end
    real(wp), intent(in) :: t                           !< time of the end [s]
    real(wp), intent(in) :: y(:)                        !< projected values

    self%last = mod(self%last, most) + 1
    self%count = min(self%count + 1, most)
    self%inserted = 0
    self%chosen = 0
    associate (here => self%points(self%last))
      here%t = t
      here%y = y
      here%is_known = .false.
      if (.not. allocated(here%signs)) allocate (here%signs(size(system%work%blocks)))
      if (size(here%signs) /= size(system%work%blocks)) then
        deallocate (here%signs)
        allocate (here%signs(size(system%work%blocks)))
      end if
      call system%signs(here%signs)
    end associate
  end subroutine add

  !> Insert a point with closed chains into the last step, unless enough are inserted.
  pure subroutine insert(self, t, y)
    class(dense_output_type), intent(inout) :: self   !< the dense output
    real(wp), intent(in) :: t                         !< time of the point [s]
    real(wp), intent(in) :: y(:)                      !< the vector there

    if (self%inserted == most_inserted) return
    self%inserted = self%inserted + 1
    self%chosen = 0
    associate (here => self%points(most + self%inserted))
      here%t = t
      here%y = y
      here%is_known = .false.
    end associate
  end subroutine insert

  !> Number of points that were inserted into the last step.
  pure integer function count_inserted(self)
    class(dense_output_type), intent(in) :: self   !< the dense output

    count_inserted = self%inserted
  end function count_inserted

  !> Time and vector at the start of the last step.
  pure subroutine start_of_step(self, t, y)
    class(dense_output_type), intent(in) :: self   !< with two ends at least
    real(wp), intent(out) :: t                     !< time of the start [s]
    real(wp), intent(out) :: y(:)                  !< the vector there
    integer :: before

    before = place(self, 2)
    t = self%points(before)%t
    y = self%points(before)%y
  end subroutine start_of_step

  !> Place of the i-th end of a step, counted from the last one.
  pure integer function place(self, i)
    class(dense_output_type), intent(in) :: self   !< the dense output
    integer, intent(in) :: i                       !< 0: the last end; 1: the end before it; ...

    place = modulo(self%last - i, most) + 1
  end function place

  !> Whether a singular position of the independent coordinates lies within the last step, which has different signs of a
  !> block's determinant at its ends.
  pure logical function crosses(self)
    class(dense_output_type), intent(in) :: self   !< the dense output

    crosses = any(self%points(place(self, 1))%signs /= self%points(place(self, 2))%signs)
  end function crosses

  !> Whether the blocks' Jacobians of the system's state have the signs that they have at the end of the last step.
  logical function agrees(self, system)
    class(dense_output_type), intent(in) :: self        !< the dense output
    type(motion_system_type), intent(inout) :: system   !< the system, at the state that is judged
    integer :: signs(size(system%work%blocks))

    call system%signs(signs)
    agrees = all(signs == self%points(self%last)%signs)
  end function agrees

  !> Find the vector at time t within the last step. `found` is false if it is not certain to be as accurate as the ends of the
  !> step. The system is left in another state. Fails as evaluations do.
  subroutine find(self, system, t, y, found, err)
    class(dense_output_type), intent(inout) :: self     !< the dense output
    type(motion_system_type), intent(inout) :: system   !< the system, which is evaluated
    real(wp), intent(in) :: t                           !< time within the last step [s]
    real(wp), intent(out) :: y(:)                       !< the vector at this time
    logical, intent(out) :: found                       !< the vector is certain to be accurate
    type(error_type), allocatable, intent(out) :: err   !< allocated if it failed
    real(wp), dimension(count_states(system)) :: q, dq, ddq, worse_q, worse_dq
    real(wp) :: change, change_of_rate, per_length
    integer :: i, k, m, n, varied

    y = 0.0_wp
    found = .false.
    if (self%count < 2) return
    call build(self, system, t, err)
    if (allocated(err)) return
    call self%polynomial%evaluate(t, worse_q, worse_dq, ddq, points=size(self%polynomial%x)/3 - 1)
    call self%polynomial%evaluate(t, q, dq, ddq)
    per_length = steepest_slope/abs(self%points(self%chosen(1))%t - self%points(self%chosen(2))%t)
    m = system%plan%n_coordinates
    n = m + size(system%plan%free)
    y(:m) = q(:m)
    varied = system%count_varied()
    y(n + 1:size(y) - varied) = q(m + 1:)
    y(size(y) - varied + 1:) = dq(size(q) - varied + 1:)
    found = .true.
    associate (solver => system%model%request%solver)
      do i = 1, size(system%plan%free)
        k = system%plan%free(i)
        y(m + i) = dq(k)
        ! a difference may vanish here by chance, but not together with its derivative
        change = abs(q(k) - worse_q(k))
        change_of_rate = abs(dq(k) - worse_dq(k))
        found = found .and. change + change_of_rate/per_length <= solver%relative_tolerance*abs(q(k)) &
                + solver%absolute_tolerance &
                .and. change_of_rate + change*per_length <= solver%relative_tolerance*abs(dq(k)) &
                + solver%absolute_tolerance
      end do
      do i = m + 1, size(q) - varied
        found = found .and. abs(q(i) - worse_q(i)) + abs(dq(i) - worse_dq(i))/per_length <= &
                solver%relative_tolerance*abs(q(i)) + solver%absolute_tolerance
      end do
      do i = size(q) - varied + 1, size(q)
        if (.not. found) exit
        k = mod(i - size(q) + varied - 1, size(system%sensitivity%size_of)) + 1
        change = abs(q(i) - worse_q(i))
        change_of_rate = abs(dq(i) - worse_dq(i))
        found = change + change_of_rate/per_length <= solver%relative_tolerance*abs(q(i)) &
                + solver%absolute_tolerance*system%sensitivity%size_of(k) &
                .and. change_of_rate + change*per_length <= solver%relative_tolerance*abs(dq(i)) &
                + solver%absolute_tolerance*system%sensitivity%size_of(k)
      end do
    end associate
  end subroutine find

  !> How many coordinates, states of motors and derivatives by parameters are interpolated.
  pure integer function count_states(system)
    type(motion_system_type), intent(in) :: system   !< the system

    count_states = system%plan%n_coordinates + size(system%model%mechanism%motors) + system%count_varied()
  end function count_states

  !> Build the polynomial through the points next to time t, unless the present one goes through them.
  subroutine build(self, system, t, err)
    class(dense_output_type), intent(inout) :: self     !< the dense output
    type(motion_system_type), intent(inout) :: system   !< the system, which is evaluated
    real(wp), intent(in) :: t                           !< time within the last step [s]
    type(error_type), allocatable, intent(out) :: err   !< allocated if it failed
    real(wp), dimension(count_states(system), most) :: q, dq, ddq
    real(wp) :: times(most)
    integer :: chosen(most), i, n

    chosen = points_next_to(self, t)
    if (all(chosen == self%chosen)) return
    n = count(chosen > 0)
    do i = 1, n
      associate (point => self%points(chosen(i)))
        if (.not. point%is_known) then
          call system%move_to(point%t, point%y, err)
          if (.not. allocated(err)) call take_motion(system, point, err)
          if (allocated(err)) return
        end if
        times(i) = point%t
        q(:, i) = point%q
        dq(:, i) = point%dq
        ddq(:, i) = point%ddq
      end associate
    end do
    call build_hermite(times(:n), q(:, :n), dq(:, :n), ddq(:, :n), self%polynomial)
    self%chosen = chosen
  end subroutine build

  !> Put the motion of the system's state into a point.
  subroutine take_motion(system, point, err)
    type(motion_system_type), intent(in) :: system      !< the system, moved to the point
    type(step_point_type), intent(inout) :: point       !< gets coordinates, states of motors, and their derivatives
    type(error_type), allocatable, intent(out) :: err   !< allocated if the law of a motor has no value
    type(motor_action_type) :: action
    integer :: i, n

    point%q = system%state%q
    point%dq = system%state%dq
    point%ddq = system%state%ddq
    do i = 1, size(system%model%mechanism%motors)
      call find_action(system%model%mechanism, system%plan, i, system%state, action, err)
      if (allocated(err)) return
      point%q = [point%q, system%state%motor(i)]
      point%dq = [point%dq, action%rate]
      point%ddq = [point%ddq, action%second]
    end do
    if (allocated(system%sensitivity)) then
      n = system%count_varied()
      point%q = [point%q, reshape(system%sensitivity%values(:, :, 0), [n])]
      point%dq = [point%dq, reshape(system%sensitivity%values(:, :, 1), [n])]
      point%ddq = [point%ddq, reshape(system%sensitivity%values(:, :, 2), [n])]
    end if
    point%is_known = .true.
  end subroutine take_motion

  !> Places of the points next to time t, the nearest first; 0 where there are no more.
  pure function points_next_to(self, t) result(chosen)
    class(dense_output_type), intent(in) :: self   !< the dense output
    real(wp), intent(in) :: t                      !< time within the last step [s]
    integer :: chosen(most), i, j
    logical :: is_left(size(self%points))

    is_left = .false.
    do i = 1, self%count
      is_left(place(self, i)) = .true.
    end do
    is_left(most + 1:most + self%inserted) = .true.
    chosen = 0
    do i = 1, min(most, count(is_left))
      do j = 1, size(is_left)
        if (.not. is_left(j)) cycle
        if (chosen(i) == 0) chosen(i) = j
        if (abs(self%points(j)%t - t) < abs(self%points(chosen(i))%t - t)) chosen(i) = j
      end do
      is_left(chosen(i)) = .false.
    end do
  end function points_next_to
end module mech9_dense_output
