!> The way from one assembly to others: with one independent coordinate set free, the closed positions are a curve, and each of its
!> positions with the given value of this coordinate is an assembly.
!>
!> The curve is followed by small steps along its tangent and Newton's method (Allgower and Georg in
!> docs/reference/bibliography.md). The coordinate that changes fastest leads: it is given in Newton's method, and all others
!> follow from it.
module mech9_released_curve
  use mech9_kinds, only: wp
  use mech9_error, only: error_type
  use mech9_plan, only: plan_type, block_type, without_periods
  use mech9_state, only: state_type
  use mech9_frame_motion, only: place_frames
  use mech9_block_equations, only: block_fronts
  use mech9_block_solver, only: block_work_type, new_block_work, newton_outcome_type, close_block, factorize_block
  use mech9_generic_position, only: free_block
  implicit none
  private
  public :: curve_type, begin_curve

  !> First and greatest length of a step, as change of the fastest coordinate in its unit, and that of the shortest.
  real(wp), parameter :: first_step = 0.05_wp, longest_step = 0.2_wp, shortest_step = 1.0e-4_wp
  !> Newton's method may correct this part of a step, and the tangent may turn by the angle with this cosine.
  real(wp), parameter :: trusted_correction = 0.2_wp, least_cosine = 0.9_wp
  !> Another coordinate leads where the present one is slower than this part of the fastest.
  real(wp), parameter :: slow_leader = 0.3_wp
  !> A slide that is so many lengths of the mechanism away from the assembly does not come back.
  real(wp), parameter :: far_away = 20.0_wp

  !> A place on the curve, and the way on.
  type :: curve_type
    logical :: goes_on = .false.                      !< the curve can be followed from here
    integer :: released = 0                           !< the coordinate that is set free
    type(state_type) :: state                         !< the position
    integer, private :: leader = 0                    !< the coordinate that is given
    real(wp), private :: target = 0.0_wp              !< value of the released coordinate in assemblies [rad, m]
    real(wp), private :: step = first_step            !< length of the next step
    logical, allocatable, private :: moves(:)         !< (M) the coordinate is a dependent one, or the released one
    real(wp), allocatable, private :: tangent(:)      !< (M) rates along the curve, the fastest 1, in units of the coordinates
    type(block_type), private :: block                !< all chains; all that move but the leader are unknowns
    type(block_work_type), private :: work            !< scratch of the block
  contains
    procedure :: advance
    procedure, private :: lead
    procedure, private :: find_tangent
  end type curve_type

contains

  !> Begin at an assembly, with a released coordinate that grows or decreases.
  subroutine begin_curve(plan, q, released, direction, curve)
    type(plan_type), intent(in) :: plan       !< the plan of the mechanism
    type(state_type), intent(in) :: q         !< the assembly
    integer, intent(in) :: released           !< number of the independent coordinate
    real(wp), intent(in) :: direction         !< 1: it grows at first, -1: it decreases
    type(curve_type), intent(out) :: curve    !< at this assembly
    type(error_type), allocatable :: err
    integer :: k

    curve%state = q
    curve%released = released
    curve%target = q%q(released)
    curve%moves = [(plan%steps(plan%step_of(k))%dependent .or. k == released, k=1, plan%n_coordinates)]
    allocate (curve%tangent(plan%n_coordinates), source=0.0_wp)
    curve%tangent(released) = direction
    call curve%lead(plan, released)
    call place_frames(plan, curve%block, curve%state, err)
    if (allocated(err)) return
    call curve%find_tangent(plan, curve%goes_on)
  end subroutine begin_curve

  !> Let a coordinate lead.
  subroutine lead(self, plan, leader)
    class(curve_type), intent(inout) :: self   !< the place on the curve
    type(plan_type), intent(in) :: plan        !< the plan of the mechanism
    integer, intent(in) :: leader              !< number of the coordinate
    integer :: s

    self%leader = leader
    self%block = free_block(plan, plan%n_coordinates, size(plan%closures))
    self%block%unknowns = pack([(s, s=1, plan%n_coordinates)], &
                               [(self%moves(plan%steps(s)%coordinate) .and. plan%steps(s)%coordinate /= leader, &
                                 s=1, plan%n_coordinates)])
    self%block%coordinates = plan%steps(self%block%unknowns)%coordinate
    self%work = new_block_work(self%block)
    call self%work%equations%create(self%block%equations, size(self%block%unknowns), &
                                    block_fronts(plan, self%block, self%work%column_of))
  end subroutine lead

  !> The tangent at the present position, in the direction of the one before, whose frames are in place. `found` is false where the
  !> leader does not determine the others, or moves nothing.
  subroutine find_tangent(self, plan, found)
    class(curve_type), intent(inout) :: self   !< the place on the curve
    type(plan_type), intent(in) :: plan        !< the plan of the mechanism
    logical, intent(out) :: found              !< there is a tangent
    real(wp) :: rates(plan%n_coordinates), values(6)
    integer :: c, i, n, row

    call factorize_block(plan, self%block, self%state, self%work)
    row = 0
    self%work%right = 0.0_wp
    do c = 1, size(plan%closures)
      n = plan%constraints(c)%item%equations
      associate (loop => plan%closures(c)%loop)
        i = findloc(loop%steps, plan%step_of(self%leader), dim=1)
        if (i > 0) then
          call plan%constraints(c)%item%column(plan, loop%steps(i), loop%signs(i), self%state, values(:n))
          self%work%right(row + 1:row + n) = -values(:n)
        end if
      end associate
      row = row + n
    end do
    call self%work%equations%solve(self%work%right, self%work%change)
    rates = 0.0_wp
    rates(self%leader) = 1.0_wp
    rates(self%block%coordinates) = self%work%change
    found = self%work%equations%rank() == size(self%block%unknowns) .and. maxval(abs(self%work%change)) > 1.0e-9_wp
    if (dot_product(rates, self%tangent) < 0.0_wp) rates = -rates
    self%tangent = rates/maxval(abs(rates))
  end subroutine find_tangent

  !> One step along the curve. `passed` is whether an assembly lies within it, which is then in `assembly`.
  subroutine advance(self, plan, passed, assembly)
    class(curve_type), intent(inout) :: self      !< the place on the curve, which goes on
    type(plan_type), intent(in) :: plan           !< the plan of the mechanism
    logical, intent(out) :: passed                !< there is an assembly within the step
    type(state_type), intent(inout) :: assembly   !< gets it
    real(wp), dimension(plan%n_coordinates) :: before, tangent
    type(newton_outcome_type) :: newton
    type(error_type), allocatable :: err
    logical :: ok

    passed = .false.
    before = self%state%q
    tangent = self%tangent
    if (abs(tangent(self%leader)) < slow_leader) call self%lead(plan, maxloc(abs(tangent), dim=1))
    do
      self%state%q = before + self%step*tangent*plan%unit_of
      call close_block(plan, self%block, self%state, self%work, newton, err)
      ok = .not. allocated(err) .and. newton%converged .and. newton%correction <= trusted_correction*self%step
      if (ok) call self%find_tangent(plan, ok)
      if (ok) ok = dot_product(self%tangent, tangent) > least_cosine*norm2(self%tangent)*norm2(tangent)
      if (ok) exit
      self%tangent = tangent
      self%step = 0.5_wp*self%step
      self%goes_on = self%step >= shortest_step
      if (.not. self%goes_on) return
    end do
    if (newton%correction < 0.25_wp*trusted_correction*self%step) self%step = min(longest_step, 1.5_wp*self%step)
    self%goes_on = maxval(abs(self%state%q - assembly%q)/plan%unit_of, mask=plan%steps(plan%step_of)%period <= 0.0_wp) < far_away
    call look_between(self, plan, before, passed, assembly)
  end subroutine advance

  !> Close the position within a step at which the released coordinate passes its given value, if it does.
  subroutine look_between(curve, plan, before, passed, assembly)
    class(curve_type), intent(in) :: curve        !< the place at the end of the step
    type(plan_type), intent(in) :: plan           !< the plan of the mechanism
    real(wp), intent(in) :: before(:)             !< (M) coordinates at the start of the step [rad, m]
    logical, intent(out) :: passed                !< there is such a position
    type(state_type), intent(inout) :: assembly   !< gets it
    type(curve_type) :: there
    type(newton_outcome_type) :: newton
    type(error_type), allocatable :: err
    real(wp) :: here, then

    associate (k => curve%released)
      then = without_periods(plan%steps(plan%step_of(k)), before(k) - curve%target)
      here = without_periods(plan%steps(plan%step_of(k)), curve%state%q(k) - curve%target)
      passed = (then*here < 0.0_wp .or. (abs(here) <= 0.0_wp .and. abs(then) > 0.0_wp)) .and. &
               max(abs(then), abs(here)) < plan%unit_of(k)
      if (.not. passed) return
      there%moves = curve%moves
      call there%lead(plan, k)
      there%state = curve%state
      there%state%q = before + then/(then - here)*(curve%state%q - before)
      there%state%q(k) = curve%target
    end associate
    call close_block(plan, there%block, there%state, there%work, newton, err)
    passed = .not. allocated(err) .and. newton%converged .and. newton%correction <= longest_step
    if (passed) assembly = there%state
  end subroutine look_between
end module mech9_released_curve
