!> Contacts in a motion: where they are, the forces of those that are closed, and the accelerations under these forces.
!>
!> A rigid contact that is closed has a force that leaves the gap no acceleration; one that sticks has tangential forces that leave the slip
!> none. With the rows J of the independent coordinates for the normal and the tangents of each contact, these accelerations are
!> J M^-1 J^T f + J M^-1 (Q - h) + those that rates alone give. Friction of a contact that slides is the coefficient times the normal
!> force, against the slip. Positions and rates are corrected after each step, by the least change weighed by mass, since integration
!> of accelerations alone would let them drift.
module mech9_contact_motion
  use mech9_kinds, only: wp
  use mech9_masks, only: numbers_of
  use mech9_error, only: error_type, raise, exit_data, exit_integrator
  use mech9_dynamics_failures, only: failure_no_inertia
  use mech9_integration_failures, only: failure_contact_paradox
  use mech9_integration_tolerances, only: slip_of_errors
  use mech9_rotation, only: cross
  use mech9_cholesky, only: cholesky_factorize, cholesky_solve
  use mech9_friction_cones, only: solve_least
  use mech9_motion_view, only: link_motion_type
  use mech9_contact, only: contact_type, contact_place_type
  use mech9_mechanism, only: mechanism_type
  use mech9_plan, only: plan_type
  use mech9_state, only: state_type
  use mech9_frame_motion, only: link_motion, link_turning, point_motion, step_screw
  use mech9_lagrange_types, only: dynamics_plan_type, lagrange_work_type
  use mech9_jacobian, only: rates_by_independent
  use mech9_lagrange, only: find_equations
  implicit none
  private
  public :: contact_motion_type, contact_rows_type, begin_contact_motion, find_contact_motion, choose_contacts, &
    find_contact_rows, find_acting_rows, press, constrain, show_forces, place_of_contact, stretch_of_contact, &
    acceleration_of_contact, correct_positions, correct_rates, note_slip

  !> The equations of some contacts in the coordinates that move.
  type :: contact_rows_type
    integer, allocatable :: acting(:)              !< (contacts) numbers of the contacts
    integer, allocatable :: moving(:)              !< places among the independent coordinates of those that move
    real(wp), allocatable :: factors(:, :)         !< Cholesky factors of their mass matrix
    type(contact_place_type), allocatable :: places(:)   !< (contacts)
    real(wp), allocatable :: axes(:, :, :)         !< (3,3,contacts) normal and two tangents of each, fixed axes
    real(wp), allocatable :: rows(:, :, :)         !< (moving,3,contacts) slip along these axes per rate
    real(wp), allocatable :: answers(:, :, :)      !< (moving,3,contacts) accelerations by unit forces along them
    real(wp), allocatable :: speeds(:)             !< (contacts) sum of the speeds from which the slip comes [m/s]
    real(wp), allocatable :: given(:, :)           !< (3,contacts) accelerations along these axes that rates alone give [m/s^2]
  end type contact_rows_type

  !> How contacts act in a motion.
  type :: contact_motion_type
    logical, allocatable :: acts(:)                !< (contacts) a rigid one is closed, or a compliant one pressed
    logical, allocatable :: sticks(:)              !< (contacts) friction holds it
    real(wp), allocatable :: direction(:, :)       !< (3,contacts) in which it slid last, of length 1; fixed axes
    real(wp), allocatable :: forces(:, :)          !< (3,contacts) along the normal and two tangents [N]
  contains
    procedure :: any_acts
    procedure :: any_sticks
    procedure :: excess
  end type contact_motion_type

  !> Gaps count as closed up to this part of the mechanism's length: some times the round-off of positions.
  real(wp), parameter :: closed_part = 4.0_wp*epsilon(1.0_wp)

contains

  !> Whether any contact acts.
  pure logical function any_acts(self)
    class(contact_motion_type), intent(in) :: self   !< the contacts

    any_acts = any(self%acts)
  end function any_acts

  !> Whether any contact sticks.
  pure logical function any_sticks(self)
    class(contact_motion_type), intent(in) :: self   !< the contacts

    any_sticks = any(self%acts .and. self%sticks)
  end function any_sticks

  !> How far the friction that a sticking contact needs is beyond what it has, in parts of its force: above zero where it should slide.
  pure real(wp) function excess(self, contact, i)
    class(contact_motion_type), intent(in) :: self   !< the contacts, with their forces
    type(contact_type), intent(in) :: contact        !< the contact
    integer, intent(in) :: i                         !< its number

    associate (f => self%forces(:, i))
      excess = (norm2(f(2:3)) - contact%static_friction*f(1))/max(norm2(f), tiny(1.0_wp))
    end associate
  end function excess

  !> Begin with open contacts.
  pure subroutine begin_contact_motion(mechanism, self)
    type(mechanism_type), intent(in) :: mechanism          !< the mechanism
    type(contact_motion_type), intent(inout) :: self       !< the contacts

    associate (n => size(mechanism%contacts))
      allocate (self%acts(n), self%sticks(n), source=.false.)
      allocate (self%direction(3, n), self%forces(3, n), source=0.0_wp)
    end associate
  end subroutine begin_contact_motion

  !> The place of a contact in a state with the velocities of its links.
  pure subroutine place_of_contact(contact, plan, state, place, ball, surface)
    type(contact_type), intent(in) :: contact             !< the contact
    type(plan_type), intent(in) :: plan                   !< the plan of the mechanism
    type(state_type), intent(in) :: state                 !< the state
    type(contact_place_type), intent(out) :: place        !< its place
    type(link_motion_type), intent(out) :: ball           !< motion of the ball's link
    type(link_motion_type), intent(out) :: surface        !< motion of the surface's link

    call link_motion(plan, state, contact%links(1), ball%r, ball%p, ball%omega, ball%v)
    call link_motion(plan, state, contact%links(2), surface%r, surface%p, surface%omega, surface%v)
    place = contact%find_place(ball, surface, stretch_of_contact(contact, state))
  end subroutine place_of_contact

  !> The stretch of its profile on which a contact stays; 0: the nearest foot counts.
  pure integer function stretch_of_contact(contact, state) result(stretch)
    type(contact_type), intent(in) :: contact             !< the contact
    type(state_type), intent(in) :: state                 !< the state

    stretch = 0
    if (allocated(state%stretch)) stretch = state%stretch(contact%slot)
  end function stretch_of_contact

  !> The derivative of the slip of a contact in a state with the accelerations of its links, fixed axes [m/s^2].
  pure function acceleration_of_contact(contact, plan, state) result(acceleration)
    type(contact_type), intent(in) :: contact             !< the contact
    type(plan_type), intent(in) :: plan                   !< the plan of the mechanism
    type(state_type), intent(in) :: state                 !< the state
    type(contact_place_type) :: place
    type(link_motion_type) :: ball, surface
    real(wp), dimension(3) :: acceleration, at, v, a_center, a_surface, alpha_ball, alpha_surface

    call place_of_contact(contact, plan, state, place, ball, surface)
    call point_motion(plan, state, contact%links(1), contact%center, at, v, a_center)
    call point_motion(plan, state, contact%links(2), [0.0_wp, 0.0_wp, 0.0_wp], at, v, a_surface)
    call link_turning(plan, state, contact%links(1), alpha_ball)
    call link_turning(plan, state, contact%links(2), alpha_surface)
    acceleration = contact%acceleration(place, ball, surface, a_center, alpha_ball, a_surface, alpha_surface)
  end function acceleration_of_contact

  !> Choose the contacts and the coordinates of equations, which are then found.
  pure subroutine choose_contacts(numbers, moves, equations)
    integer, intent(in) :: numbers(:)                     !< of the contacts
    logical, intent(in) :: moves(:)                       !< (independent) no drive moves the coordinate
    type(contact_rows_type), intent(out) :: equations     !< of these contacts, still without numbers

    equations%acting = numbers
    equations%moving = numbers_of(moves)
  end subroutine choose_contacts

  !> Find the equations of contacts that are chosen, in a state whose equations of motion are found.
  subroutine find_contact_rows(mechanism, plan, dynamics, state, work, equations, err)
    type(mechanism_type), intent(in) :: mechanism         !< the mechanism
    type(plan_type), intent(in) :: plan                   !< the plan of the mechanism
    type(dynamics_plan_type), intent(in) :: dynamics      !< its plan of dynamics
    type(state_type), intent(in) :: state                 !< the state, with the velocities of links
    type(lagrange_work_type), intent(in) :: work          !< with the coefficients of motion and the Jacobian
    type(contact_rows_type), intent(inout) :: equations   !< of the chosen contacts
    type(error_type), allocatable, intent(out) :: err     !< allocated if a coordinate has no inertia
    type(link_motion_type) :: ball, surface
    real(wp) :: all_rows(size(plan%independent), 3)
    integer :: i, j, n, failed_at

    n = size(equations%moving)
    allocate (equations%factors(n, n))
    do j = 1, n
      do i = 1, j
        equations%factors(j, i) = work%coefficients(max(equations%moving(i), equations%moving(j)), &
                                                    min(equations%moving(i), equations%moving(j)))
        equations%factors(i, j) = equations%factors(j, i)
      end do
    end do
    call cholesky_factorize(n, equations%factors, failed_at)
    if (failed_at > 0) then
      call raise(err, exit_data, failure_no_inertia)
      err%failure%coordinates = [plan%independent(equations%moving(failed_at))]
      return
    end if
    allocate (equations%places(size(equations%acting)), equations%axes(3, 3, size(equations%acting)), &
              equations%rows(n, 3, size(equations%acting)), equations%speeds(size(equations%acting)))
    do i = 1, size(equations%acting)
      associate (place => equations%places(i), axes => equations%axes(:, :, i), contact => mechanism%contacts(equations%acting(i)))
        call place_of_contact(contact, plan, state, place, ball, surface)
        axes(:, 1) = place%normal
        axes(:, 2:3) = place%tangents()
        all_rows = 0.0_wp
        call add_link(contact%links(1), 1.0_wp)
        call add_link(contact%links(2), -1.0_wp)
        equations%rows(:, :, i) = all_rows(equations%moving, :)
        ! a foot at rest has no speed, while those of the body and of its leg on the body cancel each other
        equations%speeds(i) = place%speed + sum(norm2(all_rows, dim=2)*abs(state%dq(plan%independent)))
      end associate
    end do
    equations%answers = equations%rows
    do i = 1, size(equations%acting)
      do j = 1, 3
        if (n > 0) call cholesky_solve(n, equations%factors, equations%answers(:, j, i))
      end do
    end do
  contains
    !> Add the motion of one link at the contact, by all steps that lead to it.
    subroutine add_link(link, sign)
      integer, intent(in) :: link      !< number of the link
      real(wp), intent(in) :: sign     !< 1 for the ball, -1 for the surface
      real(wp) :: w(3), v(3), origin(3), row(size(plan%independent))
      integer :: s, c

      s = plan%frame_of(link)
      do while (s > 0)
        call step_screw(plan, state, s, w, v, origin)
        v = v + cross(w, equations%places(i)%at - plan%origin - origin)
        call rates_by_independent(plan, dynamics, work%jacobian, plan%steps(s)%coordinate, row)
        do c = 1, 3
          all_rows(:, c) = all_rows(:, c) + sign*dot_product(equations%axes(:, c, i), v)*row
        end do
        s = plan%steps(s)%parent
      end do
    end subroutine add_link
  end subroutine find_contact_rows

  !> Find rates and accelerations under the forces of contacts, as find_motion does without them.
  subroutine find_contact_motion(mechanism, plan, dynamics, state, work, self, err)
    type(mechanism_type), intent(in) :: mechanism         !< the mechanism
    type(plan_type), intent(in) :: plan                   !< its plan
    type(dynamics_plan_type), intent(in) :: dynamics      !< its plan of dynamics
    type(state_type), intent(inout) :: state              !< the state, with placed frames and independent rates; gets the forces
    type(lagrange_work_type), intent(inout) :: work       !< scratch; gets `accelerations`, and `forces` with those of contacts
    type(contact_motion_type), intent(inout) :: self      !< the contacts, with their modes; get their forces
    type(error_type), allocatable, intent(out) :: err     !< allocated if it failed
    type(contact_rows_type) :: equations
    real(wp) :: free(size(plan%independent))

    state%contact_force = 0.0_wp
    self%forces = 0.0_wp
    call find_equations(mechanism, plan, dynamics, state, work, err)
    if (allocated(err)) return
    call choose_contacts(numbers_of(self%acts), .not. plan%driven(plan%independent), equations)
    call find_acting_rows(mechanism, plan, dynamics, state, work, equations, err)
    if (allocated(err)) return
    associate (moving => equations%moving)
      work%accelerations = 0.0_wp
      free(:size(moving)) = work%forces(moving) - work%velocity_terms(moving)
      if (size(moving) > 0) call cholesky_solve(size(moving), equations%factors, free(:size(moving)))
      work%accelerations(moving) = free(:size(moving))
    end associate
    call press(mechanism%contacts, equations, state, self, work%accelerations, err)
    if (.not. allocated(err)) call show_forces(equations, self, state, work%forces)
  end subroutine find_contact_motion

  !> Find the equations of chosen contacts that act, in a state whose equations of motion are found and that has no other accelerations than
  !> those by rates alone.
  subroutine find_acting_rows(mechanism, plan, dynamics, state, work, equations, err)
    type(mechanism_type), intent(in) :: mechanism         !< the mechanism
    type(plan_type), intent(in) :: plan                   !< its plan
    type(dynamics_plan_type), intent(in) :: dynamics      !< its plan of dynamics
    type(state_type), intent(in) :: state                 !< the state
    type(lagrange_work_type), intent(in) :: work          !< with the coefficients of motion and the Jacobian
    type(contact_rows_type), intent(inout) :: equations   !< of the chosen contacts
    type(error_type), allocatable, intent(out) :: err     !< allocated if a coordinate has no inertia
    integer :: i

    call find_contact_rows(mechanism, plan, dynamics, state, work, equations, err)
    if (allocated(err)) return
    allocate (equations%given(3, size(equations%acting)))
    do i = 1, size(equations%acting)
      equations%given(:, i) = matmul(acceleration_of_contact(mechanism%contacts(equations%acting(i)), plan, state), &
                                     equations%axes(:, :, i))
    end do
  end subroutine find_acting_rows

  !> Add to accelerations without contacts those by the forces of contacts, which they determine.
  subroutine press(contacts, equations, state, self, accelerations, err)
    type(contact_type), intent(in) :: contacts(:)         !< all contacts
    type(contact_rows_type), intent(in) :: equations      !< the equations of those that act
    type(state_type), intent(inout) :: state              !< the state; gets the forces
    type(contact_motion_type), intent(inout) :: self      !< all contacts; get their forces
    real(wp), intent(inout) :: accelerations(:)           !< (independent) of the independent coordinates [rad/s^2, m/s^2]
    type(error_type), allocatable, intent(out) :: err     !< allocated if friction draws a contact together
    real(wp) :: free(size(equations%moving))
    integer :: i

    state%contact_force = 0.0_wp
    self%forces = 0.0_wp
    free = accelerations(equations%moving)
    call find_forces(contacts, state%t, equations, free, self, equations%acting, err)
    if (allocated(err)) return
    do i = 1, size(equations%acting)
      associate (force => self%forces(:, equations%acting(i)))
        free = free + matmul(equations%answers(:, :, i), force)
        state%contact_force(:, equations%acting(i)) = matmul(equations%axes(:, :, i), force)
      end associate
    end do
    accelerations(equations%moving) = free
  end subroutine press

  !> Show the forces of contacts in a state, and add them to the generalized forces of other loads.
  pure subroutine show_forces(equations, self, state, forces)
    type(contact_rows_type), intent(in) :: equations      !< the equations of the contacts that act
    type(contact_motion_type), intent(in) :: self         !< all contacts, with their forces
    type(state_type), intent(inout) :: state              !< gets the forces
    real(wp), intent(inout) :: forces(:)                  !< (independent) on the independent coordinates [N m, N]
    integer :: i

    associate (moving => equations%moving)
      do i = 1, size(equations%acting)
        associate (force => self%forces(:, equations%acting(i)))
          state%contact_force(:, equations%acting(i)) = matmul(equations%axes(:, :, i), force)
          forces(moving) = forces(moving) + matmul(equations%rows(:, :, i), force)
        end associate
      end do
    end associate
  end subroutine show_forces

  !> Take from accelerations what rigid contacts that are closed do not allow: along their normals, and along the tangents of those that
  !> stick. Contacts that slide act without friction here.
  subroutine constrain(contacts, equations, self, accelerations)
    type(contact_type), intent(in) :: contacts(:)         !< all contacts
    type(contact_rows_type), intent(in) :: equations      !< the equations of those that act
    type(contact_motion_type), intent(in) :: self         !< all contacts, with their modes
    real(wp), intent(inout) :: accelerations(:)           !< (independent) of the independent coordinates
    integer, dimension(3*size(equations%acting)) :: of_contact, along
    real(wp), allocatable :: a(:, :), x(:), changes(:)
    integer :: m, i, j, c
    logical :: depends

    m = 0
    do i = 1, size(equations%acting)
      do c = 1, 3
        if (.not. merge(contacts(equations%acting(i))%is_rigid, self%sticks(equations%acting(i)), c == 1)) cycle
        m = m + 1
        of_contact(m) = i
        along(m) = c
      end do
    end do
    if (m == 0) return
    allocate (a(m, m), x(m), changes(m))
    associate (moving => equations%moving)
      do j = 1, m
        do i = 1, m
          a(i, j) = dot_product(equations%rows(:, along(i), of_contact(i)), equations%answers(:, along(j), of_contact(j)))
        end do
        x(j) = -dot_product(equations%rows(:, along(j), of_contact(j)), accelerations(moving))
      end do
      call solve_least(a, x, spread(1.0_wp, 1, m), changes, depends)
      do j = 1, m
        accelerations(moving) = accelerations(moving) + changes(j)*equations%answers(:, along(j), of_contact(j))
      end do
    end associate
  end subroutine constrain

  !> Find the forces of the contacts that act.
  subroutine find_forces(contacts, t, equations, free, self, acting, err)
    type(contact_type), intent(in) :: contacts(:)         !< all contacts
    real(wp), intent(in) :: t                             !< time, for a failure [s]
    type(contact_rows_type), intent(in) :: equations      !< their equations
    real(wp), intent(in) :: free(:)                       !< (moving) accelerations without contacts
    type(contact_motion_type), intent(inout) :: self      !< all contacts; get their forces
    integer, intent(in) :: acting(:)                      !< numbers of those that act
    type(error_type), allocatable, intent(out) :: err     !< allocated if friction draws a contact together
    integer :: of_contact(3*size(acting)), along(3*size(acting)), m, i, j
    real(wp) :: lines(3, 3*size(acting)), directions(2, size(acting)), needed(3, size(acting))
    real(wp), allocatable :: a(:, :), x(:), scale(:), forces(:)
    real(wp) :: answer(size(free))
    logical :: depends

    m = 0
    do i = 1, size(acting)
      associate (k => acting(i), force => self%forces(:, acting(i)))
        needed(:, i) = -equations%given(:, i) - matmul(free, equations%rows(:, :, i))
        directions(:, i) = slip_direction(contacts(acting(i)), equations%places(i), equations%axes(:, :, i), self%direction(:, k))
        if (contacts(acting(i))%is_rigid) then
          call add(1, [1.0_wp, 0.0_wp, 0.0_wp])
          if (.not. self%sticks(k)) lines(2:3, m) = -contacts(acting(i))%sliding_friction*directions(:, i)
        else
          force(1) = contacts(acting(i))%normal_force(equations%places(i))
          if (.not. self%sticks(k)) force(2:3) = -contacts(acting(i))%sliding_friction*force(1)*directions(:, i)
        end if
        if (.not. self%sticks(k)) cycle
        call add(2, [0.0_wp, 1.0_wp, 0.0_wp])
        call add(3, [0.0_wp, 0.0_wp, 1.0_wp])
      end associate
    end do
    if (m == 0) return
    ! accelerations by the forces that are known
    do i = 1, size(acting)
      if (.not. any(abs(self%forces(:, acting(i))) > 0.0_wp)) cycle
      answer = matmul(equations%answers(:, :, i), self%forces(:, acting(i)))
      do j = 1, size(acting)
        needed(:, j) = needed(:, j) - matmul(answer, equations%rows(:, :, j))
      end do
    end do
    allocate (a(m, m), x(m))
    do j = 1, m
      answer = matmul(equations%answers(:, :, of_contact(j)), lines(:, j))
      do i = 1, m
        a(i, j) = dot_product(equations%rows(:, along(i), of_contact(i)), answer)
      end do
      x(j) = needed(along(j), of_contact(j))
      if (along(j) > 1 .or. a(j, j) > 0.0_wp) cycle
      if (.not. dot_product(equations%rows(:, 1, of_contact(j)), equations%answers(:, 1, of_contact(j))) > 0.0_wp) cycle
      call raise(err, exit_integrator, failure_contact_paradox)
      err%failure%t = t
      associate (k => of_contact(j), contact => contacts(acting(of_contact(j))))
        err%failure%number = contact%number
        err%failure%values = reshape([contact%sliding_friction, &
                                      dot_product(equations%rows(:, 1, k), equations%answers(:, 1, k)) &
                                      /dot_product(equations%rows(:, 1, k), matmul(equations%answers(:, 2:3, k), &
                                                                                   directions(:, k)))], [1, 2])
        err%place = contact%place
      end associate
      return
    end do
    allocate (scale(m), forces(m), source=1.0_wp)
    call solve_least(a, x, scale, forces, depends)
    if (depends .and. any(self%sticks(acting))) then
      ! contacts that stick share their friction in parts of what each can hold
      do j = 1, m
        scale(j) = maxval(abs(forces))
        if (along(j) > 1) scale(j) = contacts(acting(of_contact(j)))%static_friction*max(normal_of(of_contact(j)), tiny(1.0_wp))
      end do
      call solve_least(a, x, scale, forces, depends)
    end if
    do j = 1, m
      self%forces(:, acting(of_contact(j))) = self%forces(:, acting(of_contact(j))) + forces(j)*lines(:, j)
    end do
  contains
    !> The normal force of a contact.
    pure real(wp) function normal_of(k) result(normal)
      integer, intent(in) :: k   !< its place among those that act

      normal = self%forces(1, acting(k)) + sum(forces, of_contact(:m) == k .and. along(:m) == 1)
    end function normal_of

    !> Add an unknown force, and the condition that the acceleration along the same axis vanishes.
    subroutine add(axis, line)
      integer, intent(in) :: axis       !< number of the axis
      real(wp), intent(in) :: line(3)   !< the force along all axes, per unit of the unknown

      m = m + 1
      of_contact(m) = i
      along(m) = axis
      lines(:, m) = line
    end subroutine add
  end subroutine find_forces

  !> The direction of slip along the tangents, on the side of an earlier direction: a contact that comes to rest within a step would turn back
  !> there otherwise. The earlier direction has a small part in it, so that it is smooth where the slip is an error of integration.
  pure function slip_direction(contact, place, axes, earlier) result(direction)
    type(contact_type), intent(in) :: contact         !< the contact
    type(contact_place_type), intent(in) :: place     !< its place
    real(wp), intent(in) :: axes(3, 3)                !< normal and tangents
    real(wp), intent(in) :: earlier(3)                !< of length 1, fixed axes
    real(wp) :: direction(2)
    real(wp) :: before(2)

    direction = 0.0_wp
    if (.not. contact%has_friction()) return
    before = matmul(earlier, axes(:, 2:3))
    if (norm2(before) > 0.0_wp) before = before/norm2(before)
    direction = matmul(place%slip, axes(:, 2:3))
    if (dot_product(direction, before) < 0.0_wp) direction = -direction
    direction = direction + slip_of_errors*place%speed*before
    if (.not. norm2(direction) > 0.0_wp) direction = before
    if (norm2(direction) > 0.0_wp) direction = direction/norm2(direction)
  end function slip_direction

  !> Note the directions in which contacts slide, where a step begins.
  pure subroutine note_slip(mechanism, plan, state, self)
    type(mechanism_type), intent(in) :: mechanism          !< the mechanism
    type(plan_type), intent(in) :: plan                    !< its plan
    type(state_type), intent(in) :: state                  !< the state, with the velocities of links
    type(contact_motion_type), intent(inout) :: self       !< the contacts; get directions
    type(contact_place_type) :: place
    type(link_motion_type) :: ball, surface
    real(wp) :: slip(3)
    integer :: i

    do i = 1, size(self%acts)
      associate (contact => mechanism%contacts(i))
        if (.not. self%acts(i) .or. self%sticks(i) .or. .not. contact%has_friction()) cycle
        call place_of_contact(contact, plan, state, place, ball, surface)
        slip = place%slip - place%gap_rate()*place%normal
        if (norm2(slip) <= slip_of_errors*place%speed .or. dot_product(slip, self%direction(:, i)) < 0.0_wp) cycle
        self%direction(:, i) = slip/norm2(slip)
      end associate
    end do
  end subroutine note_slip

  !> Correct the independent coordinates by one step of Newton's method, so that rigid contacts that are closed have no gap.
  subroutine correct_positions(mechanism, plan, dynamics, state, work, self, corrected, err)
    type(mechanism_type), intent(in) :: mechanism         !< the mechanism
    type(plan_type), intent(in) :: plan                   !< its plan
    type(dynamics_plan_type), intent(in) :: dynamics      !< its plan of dynamics
    type(state_type), intent(inout) :: state              !< the state, with placed frames and independent rates; coordinates change
    type(lagrange_work_type), intent(inout) :: work       !< scratch
    type(contact_motion_type), intent(in) :: self         !< the contacts, with their modes
    logical, intent(out) :: corrected                     !< there was a gap; chains are to be closed anew
    type(error_type), allocatable, intent(out) :: err     !< allocated if it failed
    type(contact_rows_type) :: equations
    real(wp), allocatable :: gaps(:), changes(:)
    integer, allocatable :: closed(:)
    integer :: i
    logical :: depends

    corrected = .false.
    closed = numbers_of(self%acts .and. mechanism%contacts%is_rigid)
    if (size(closed) == 0) return
    call find_equations(mechanism, plan, dynamics, state, work, err)
    if (allocated(err)) return
    call choose_contacts(closed, .not. plan%driven(plan%independent), equations)
    call find_contact_rows(mechanism, plan, dynamics, state, work, equations, err)
    if (allocated(err)) return
    gaps = equations%places%gap
    if (maxval(abs(gaps)) <= closed_part*plan%length) return
    corrected = .true.
    allocate (changes(size(gaps)))
    call solve_least(normal_matrix(equations), gaps, spread(1.0_wp, 1, size(gaps)), changes, depends)
    associate (moved => plan%independent(equations%moving))
      do i = 1, size(closed)
        state%q(moved) = state%q(moved) - changes(i)*equations%answers(:, 1, i)
      end do
    end associate
  end subroutine correct_positions

  !> The matrix J M^-1 J^T of the normals of some contacts.
  pure function normal_matrix(equations) result(matrix)
    type(contact_rows_type), intent(in) :: equations      !< their equations
    real(wp) :: matrix(size(equations%places), size(equations%places))

    matrix = matmul(transpose(equations%rows(:, 1, :)), equations%answers(:, 1, :))
  end function normal_matrix

  !> Correct the independent rates, so that gaps of rigid contacts that are closed have no rates, and contacts that stick no slip.
  subroutine correct_rates(mechanism, plan, dynamics, state, work, self, err)
    type(mechanism_type), intent(in) :: mechanism         !< the mechanism
    type(plan_type), intent(in) :: plan                   !< its plan
    type(dynamics_plan_type), intent(in) :: dynamics      !< its plan of dynamics
    type(state_type), intent(inout) :: state              !< the state, with placed frames and independent rates, which change
    type(lagrange_work_type), intent(inout) :: work       !< scratch
    type(contact_motion_type), intent(in) :: self         !< the contacts, with their modes
    type(error_type), allocatable, intent(out) :: err     !< allocated if it failed
    type(contact_rows_type) :: equations
    integer, allocatable :: acting(:)
    integer, dimension(3*size(self%acts)) :: of_contact, along
    real(wp), allocatable :: a(:, :), x(:), changes(:)
    integer :: i, j, m, c
    logical :: depends

    acting = numbers_of(self%acts .and. (mechanism%contacts%is_rigid .or. self%sticks))
    if (size(acting) == 0) return
    call find_equations(mechanism, plan, dynamics, state, work, err)
    if (allocated(err)) return
    call choose_contacts(acting, .not. plan%driven(plan%independent), equations)
    call find_contact_rows(mechanism, plan, dynamics, state, work, equations, err)
    if (allocated(err)) return
    m = 0
    do i = 1, size(acting)
      do c = 1, 3
        if (merge(mechanism%contacts(acting(i))%is_rigid, self%sticks(acting(i)), c == 1)) then
          m = m + 1
          of_contact(m) = i
          along(m) = c
        end if
      end do
    end do
    allocate (a(m, m), x(m), changes(m))
    do j = 1, m
      do i = 1, m
        a(i, j) = dot_product(equations%rows(:, along(i), of_contact(i)), equations%answers(:, along(j), of_contact(j)))
      end do
      x(j) = -dot_product(equations%axes(:, along(j), of_contact(j)), equations%places(of_contact(j))%slip)
    end do
    call solve_least(a, x, spread(1.0_wp, 1, m), changes, depends)
    associate (moved => plan%independent(equations%moving))
      do j = 1, m
        state%dq(moved) = state%dq(moved) + changes(j)*equations%answers(:, along(j), of_contact(j))
      end do
    end associate
  end subroutine correct_rates
end module mech9_contact_motion
