!> Positions of a mechanism over one of its parameters, as a curve of solutions: positions of rest, or positions in which the independent
!> coordinates keep their values.
!>
!> The unknowns are independent coordinates that serve well in the position, and the parameter; the image has all coordinates. Where the
!> chosen coordinates come near a singular position, others take their places, so that a curve passes it. Forces and their derivatives
!> by coordinates and parameter are exact (mech9_linearisation, mech9_varied_forces).
module mech9_position_curve
  use, intrinsic :: ieee_arithmetic, only: ieee_value, ieee_quiet_nan
  use mech9_kinds, only: wp
  use mech9_error, only: error_type
  use mech9_partition, only: partition_type, free_coordinate, driven_coordinate
  use mech9_model, only: model_type
  use mech9_plan, only: plan_type
  use mech9_state, only: state_type
  use mech9_simulation, only: interruption_type
  use mech9_resting_plan, only: plan_by_geometry
  use mech9_motion_variation, only: vary_motion
  use mech9_linearisation, only: vary_forces
  use mech9_known_derivatives, only: check_known
  use mech9_varied_motion, only: varied_motion_type, new_varied_motion, find_varied_motion
  use mech9_varied_forces, only: varied_forces_type, new_varied_forces, find_varied_forces
  use mech9_resting_mechanism, only: resting_type, put_to_rest, choose_coordinates
  use mech9_linearised_equilibrium, only: equilibrium_type, linearise
  use mech9_curve, only: curve_type, curve_point_type, verdict_type
  use mech9_single_parameter, only: single_parameter_type
  implicit none
  private
  public :: position_curve_type, new_position_curve, begin_curve

  !> Parts are polymorphic, which keeps the code of copies small.
  type, extends(curve_type) :: position_curve_type
    type(single_parameter_type), pointer :: variable => null()   !< the model as a function of the parameter; not owned
    class(model_type), allocatable :: model                      !< at the last point
    class(resting_type), allocatable :: resting                  !< at the last point
    class(plan_type), allocatable :: plan                        !< at the start, for size and properties of loops
    type(partition_type) :: partition                            !< with all coordinates free that the curve may move
    real(wp), allocatable :: start(:)                            !< (M) position at the start [rad, m]
    integer, allocatable :: given(:)                             !< independent coordinates of the data file, where these keep their values
    real(wp) :: range = 1.0_wp                                   !< of the parameter, in the units of the data file
    real(wp) :: t = 0.0_wp                                       !< time at which drives are evaluated [s]
    logical :: at_rest = .true.                                  !< positions of rest; else independent coordinates keep their values
    type(curve_point_type) :: last                               !< the last point that was evaluated
    class(interruption_type), allocatable :: interruption        !< is asked whether the work shall stop
  contains
    procedure :: evaluate
    procedure :: change_unknowns
    procedure :: judge
    procedure :: gap
    procedure :: is_stopped
  end type position_curve_type

contains

  !> Prepare the positions of rest, or positions of given independent coordinates, of a model.
  subroutine new_position_curve(variable, model, plan, state, at_rest, range, curve)
    type(single_parameter_type), intent(in), target :: variable   !< the model as a function of the parameter; outlives the curve
    type(model_type), intent(in) :: model                         !< the model at the start
    type(plan_type), intent(in) :: plan                           !< its plan, in space
    type(state_type), intent(in) :: state                         !< closed position at the start
    logical, intent(in) :: at_rest                                !< positions of rest
    real(wp), intent(in) :: range                                 !< of the parameter, in the units of the data file
    type(position_curve_type), intent(inout) :: curve             !< prepared
    integer :: k

    curve%variable => variable
    allocate (curve%model)
    allocate (curve%plan, source=plan)
    allocate (curve%resting)
    curve%partition = model%problem%partition
    curve%at_rest = at_rest
    curve%range = range
    curve%t = model%request%time%start
    curve%start = state%q
    curve%given = [integer ::]
    if (.not. at_rest) then
      curve%given = plan%independent
      curve%partition%kind(plan%independent) = free_coordinate
    end if
    curve%n = count(curve%partition%kind == free_coordinate)
    curve%m = plan%n_coordinates + 1
    allocate (curve%period(curve%m), source=0.0_wp)
    do k = 1, plan%n_coordinates
      if (plan%steps(plan%step_of(k))%period > 0.0_wp) curve%period(k) = plan%steps(plan%step_of(k))%period/plan%unit_of(k)
    end do
  end subroutine new_position_curve

  !> The start of the curve, in the independent coordinates that serve best. Fails where the forces have no derivatives.
  subroutine begin_curve(curve, q, value, point, err)
    class(position_curve_type), intent(inout) :: curve    !< the curve
    real(wp), intent(in) :: q(:)                          !< (M) closed position [rad, m]
    real(wp), intent(in) :: value                         !< of the parameter
    type(curve_point_type), intent(inout) :: point        !< the start
    type(error_type), allocatable, intent(out) :: err     !< allocated if it failed
    integer :: k

    call curve%evaluate([pack([(k, k=1, size(q))], curve%partition%kind == free_coordinate), curve%m], &
                        [q/curve%plan%unit_of, value/curve%range], point, err)
    if (.not. allocated(err)) call curve%change_unknowns(point, err)
  end subroutine begin_curve

  !> Forces, or independent coordinates less their values, at a point, with derivatives.
  subroutine evaluate(self, place, guess, point, err)
    class(position_curve_type), intent(inout) :: self     !< the curve
    integer, intent(in) :: place(:)                       !< (n+1) coordinates that are independent, and the parameter
    real(wp), intent(in) :: guess(:)                      !< (M+1) all coordinates and the parameter, in their units
    type(curve_point_type), intent(out) :: point          !< the point, without a tangent
    type(error_type), allocatable, intent(out) :: err     !< allocated if it failed
    type(varied_motion_type) :: motion

    self%last%z = [real(wp) ::]
    call self%variable%at([guess(self%m)*self%range], self%model, err)
    if (.not. allocated(err)) call stand_at(self, place(:self%n), guess(:self%m - 1)*self%plan%unit_of, err)
    if (.not. allocated(err)) call new_varied_motion(self%variable, self%model, self%resting%plan, motion, err)
    if (.not. allocated(err)) call check_known(self%model, motion%tangents, err)
    if (allocated(err)) return
    motion%given = 0.0_wp
    call find_varied_motion(self%model, self%resting%state, motion, err)
    if (allocated(err)) return
    allocate (point%residual(self%n), point%jacobian(self%n, self%n + 1), point%slopes(self%m, self%n + 1), source=0.0_wp)
    point%place = place
    point%z = [self%resting%state%q/self%plan%unit_of, guess(self%m)]
    point%slopes(self%m, self%n + 1) = 1.0_wp
    point%slopes(:self%m - 1, self%n + 1) = motion%q(1, 0, :)*self%range/self%plan%unit_of
    if (self%at_rest) then
      call find_forces(self, motion, point, err)
    else
      call find_distances(self, motion, point, err)
    end if
    if (.not. allocated(err)) self%last = point
  end subroutine evaluate

  !> Put the present model to rest in a position.
  subroutine stand_at(self, free, q, err)
    class(position_curve_type), intent(inout) :: self     !< the curve, with the model
    integer, intent(in) :: free(:)                        !< (n) coordinates that are independent beside the driven ones
    real(wp), intent(in) :: q(:)                          !< (M) their values, and guesses of the others [rad, m]
    type(error_type), allocatable, intent(out) :: err     !< allocated if it failed
    type(partition_type) :: partition
    class(plan_type), allocatable :: plan
    class(state_type), allocatable :: position
    real(wp) :: values(size(q)), rates(size(q)), accelerations(size(q))
    logical :: independent(size(q))
    integer :: i

    allocate (plan, position)
    independent = self%partition%kind == driven_coordinate
    independent(free) = .true.
    call self%partition%with_independent(self%model%mechanism%structure, independent, partition)
    values = q
    rates = 0.0_wp
    accelerations = 0.0_wp
    do i = 1, size(self%model%problem%drives)
      associate (drive => self%model%problem%drives(i)%drive)
        if (partition%kind(drive%coordinate) /= driven_coordinate) cycle
        call drive%evaluate(self%t, values(drive%coordinate), rates(drive%coordinate), accelerations(drive%coordinate), err)
        if (allocated(err)) return
      end associate
    end do
    call plan_by_geometry(self%model%mechanism, partition, self%plan, values, plan, position, err)
    if (allocated(err)) return
    position%t = self%t
    position%dq = rates
    position%ddq = accelerations
    call put_to_rest(self%model%mechanism, partition, plan, position, self%resting, err)
  end subroutine stand_at

  !> The forces that keep the mechanism in its position, and their derivatives.
  subroutine find_forces(self, motion, point, err)
    class(position_curve_type), intent(inout) :: self     !< the curve, with the mechanism at rest
    type(varied_motion_type), intent(inout) :: motion     !< derivatives of the position by the parameter
    type(curve_point_type), intent(inout) :: point        !< gets the forces
    type(error_type), allocatable, intent(out) :: err     !< allocated if a load failed
    type(varied_forces_type) :: forces
    integer :: j

    associate (resting => self%resting, free => self%resting%free, unit => self%plan%unit_of, n => self%n)
      do j = 1, n
        call clear_but(resting, free(j), unit(free(j)))
        call vary_forces(self%model%mechanism, resting%plan, resting%state, resting%linearisation, err)
        if (allocated(err)) return
        point%jacobian(:, j) = resting%linearisation%change(free)*unit(free)
        point%slopes(:self%m - 1, j) = resting%linearisation%variation%q/unit
      end do
      call new_varied_forces(self%model, motion, forces)
      call find_varied_forces(self%model, motion, forces, err)
      if (allocated(err)) return
      point%residual = resting%forces
      point%jacobian(:, n + 1) = forces%changes(1, free)*unit(free)*self%range
    end associate
  end subroutine find_forces

  !> Clear the variation of a mechanism at rest but for one coordinate.
  subroutine clear_but(resting, coordinate, change)
    class(resting_type), intent(inout) :: resting         !< the mechanism at rest
    integer, intent(in) :: coordinate                     !< number of the coordinate
    real(wp), intent(in) :: change                        !< of it [rad, m]

    call resting%linearisation%variation%clear()
    resting%linearisation%variation%q(coordinate) = change
  end subroutine clear_but

  !> The distances of the independent coordinates of the data file from their values, and the derivatives.
  subroutine find_distances(self, motion, point, err)
    class(position_curve_type), intent(inout) :: self     !< the curve, with the mechanism at rest
    type(varied_motion_type), intent(in) :: motion        !< derivatives of the position by the parameter
    type(curve_point_type), intent(inout) :: point        !< gets the distances
    type(error_type), allocatable, intent(out) :: err     !< allocated if a drive has no value
    real(wp) :: value, slope, change(0:2), unused(2)
    integer :: i, j, k

    associate (resting => self%resting, unit => self%plan%unit_of, n => self%n)
      do j = 1, n
        call clear_but(resting, resting%free(j), unit(resting%free(j)))
        call vary_motion(resting%plan, resting%state, resting%linearisation%motion, resting%linearisation%variation)
        point%slopes(:self%m - 1, j) = resting%linearisation%variation%q/unit
      end do
      do i = 1, n
        k = self%given(i)
        value = self%start(k)
        slope = 0.0_wp
        do j = 1, size(self%model%problem%drives)
          associate (drive => self%model%problem%drives(j)%drive, part => motion%tangents(1)%drives(j))
            if (drive%coordinate /= k) cycle
            call drive%evaluate(self%t, value, unused(1), unused(2), err)
            if (allocated(err)) return
            if (.not. part%varies) cycle
            call drive%vary(part%change, self%t, change(0), change(1), change(2))
            slope = change(0)
          end associate
        end do
        point%residual(i) = point%z(k) - value/unit(k)
        point%jacobian(i, :) = point%slopes(k, :)
        point%jacobian(i, n + 1) = point%jacobian(i, n + 1) - slope*self%range/unit(k)
      end do
    end associate
  end subroutine find_distances

  !> Take other independent coordinates near a singular position of the present ones.
  subroutine change_unknowns(self, point, err)
    class(position_curve_type), intent(inout) :: self     !< the curve
    type(curve_point_type), intent(inout) :: point        !< in the new coordinates afterwards
    type(error_type), allocatable, intent(out) :: err     !< allocated if it failed
    type(curve_point_type) :: other

    call return_to(self, point, err)
    if (.not. allocated(err)) call choose_coordinates(self%model%mechanism, self%resting, err)
    self%last%z = [real(wp) ::]
    if (allocated(err)) return
    if (all(self%resting%free == point%place(:self%n))) return
    call self%evaluate([self%resting%free, self%m], point%z, other, err)
    if (.not. allocated(err)) point = other
  end subroutine change_unknowns

  !> Evaluate a point again, unless it is the last one.
  subroutine return_to(self, point, err)
    class(position_curve_type), intent(inout) :: self     !< the curve
    type(curve_point_type), intent(in) :: point           !< any
    type(error_type), allocatable, intent(out) :: err     !< allocated if it failed
    type(curve_point_type) :: again

    if (size(self%last%z) == size(point%z)) then
      if (all(self%last%place == point%place) .and. all(abs(self%last%z - point%z) <= 0.0_wp)) return
    end if
    call self%evaluate(point%place, point%z, again, err)
  end subroutine return_to

  !> The stability of a position of rest, by the eigenvalues of the linearised equations of motion.
  subroutine judge(self, point, verdict)
    class(position_curve_type), intent(inout) :: self     !< the curve
    type(curve_point_type), intent(in) :: point           !< on the curve
    type(verdict_type), intent(out) :: verdict            !< stability; growth has no value where it is not known
    class(equilibrium_type), allocatable :: equilibrium
    type(error_type), allocatable :: err

    allocate (verdict%roots(0))
    verdict%growth = ieee_value(verdict%growth, ieee_quiet_nan)
    if (.not. self%at_rest) return
    verdict%is_stable = .false.
    call return_to(self, point, err)
    if (allocated(err)) return
    allocate (equilibrium)
    equilibrium%resting = self%resting
    call linearise(self%model%mechanism, self%model%problem%partition, equilibrium, err)
    if (allocated(err)) return
    verdict%is_stable = equilibrium%is_stable
    if (equilibrium%without_inertia > 0) return
    verdict%growth = equilibrium%modes%growth
    verdict%roots = equilibrium%modes%roots(:equilibrium%modes%count)
  end subroutine judge

  !> The room up to the nearest end of a rigid stop; below zero behind it. Without such stops it is 1.
  pure real(wp) function gap(self, point)
    class(position_curve_type), intent(in) :: self        !< the curve
    type(curve_point_type), intent(in) :: point           !< on the curve
    real(wp) :: unit
    integer :: i, end

    gap = 1.0_wp
    if (.not. allocated(self%model%mechanism%stops)) return
    do i = 1, size(self%model%mechanism%stops)
      associate (stop => self%model%mechanism%stops(i))
        if (.not. stop%is_rigid) cycle
        do end = 1, 2
          ! a stop without this end has a huge gap
          unit = self%plan%unit_of(stop%coordinate)
          gap = min(gap, min(stop%gap(end, point%z(stop%coordinate)*unit), unit)/unit)
        end do
      end associate
    end do
  end function gap

  !> Whether the work shall stop.
  logical function is_stopped(self) result(stopped)
    class(position_curve_type), intent(in) :: self        !< the curve

    stopped = .false.
    if (allocated(self%interruption)) stopped = self%interruption%is_wanted()
  end function is_stopped
end module mech9_position_curve
