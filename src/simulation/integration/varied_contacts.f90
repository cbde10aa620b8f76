!> The derivatives of gaps and slips of contacts by parameters, and of the forces of rigid contacts that are closed and of friction, in a
!> motion whose variational equations are integrated.
!>
!> Seen from the link of the surface, the centre of the ball is at x, and its change by a parameter is the difference of the twists by which
!> both links move, at the centre. The second derivative of the gap g, n . x'' + x' . H x', changes by n . dx'' + 2 x' . H dx' +
!> x'' . H dx + (x' . dH x'). The slip is x' - r w x n, with the angular velocity w of the ball against the surface. A closed contact leaves
!> the second derivative of the gap no change, one that sticks the acceleration of the slip, too: with the rows J of these conditions and the
!> columns K of the unknown forces, whose derivatives are f', J M^-1 K^T f' = -(change under forces that are held). The friction of a contact
!> that slides follows its normal force, and turns with the slip. The normal force of a compliant contact follows from the motion.
module mech9_varied_contacts
  use mech9_kinds, only: wp
  use mech9_error, only: error_type, raise, exit_data
  use mech9_integration_failures, only: failure_shared_contact
  use mech9_integration_tolerances, only: slip_of_errors
  use mech9_rotation, only: cross, turn, turn_back
  use mech9_friction_cones, only: solve_least
  use mech9_motion_view, only: link_motion_type
  use mech9_contact, only: contact_type, contact_place_type
  use mech9_contact_change, only: gap_shape_type, contact_change_type, find_gap_shape, surface_change, vary_normal_force, &
    of_sliding
  use mech9_contact_load, only: contact_load_type
  use mech9_mechanism, only: mechanism_type
  use mech9_model, only: model_type
  use mech9_plan, only: plan_type
  use mech9_state, only: state_type
  use mech9_frame_motion, only: link_motion, link_turning, point_motion
  use mech9_twists, only: shift_at
  use mech9_tangent, only: tangent_type
  use mech9_lagrange_types, only: dynamics_plan_type, lagrange_work_type
  use mech9_varied_motion, only: varied_motion_type, link_twists
  use mech9_motion_sensitivity, only: motion_sensitivity_type
  use mech9_contact_motion, only: contact_motion_type, contact_rows_type, choose_contacts, find_contact_rows, place_of_contact, &
    stretch_of_contact
  implicit none
  private
  public :: contact_variation_type, vary_contact, varied_numbers, find_varied_contacts

  !> The derivatives of one contact by all parameters.
  type :: contact_variation_type
    real(wp), allocatable :: gaps(:, :)       !< (P,0:2) of the gap and its derivatives in time [m]
    real(wp), allocatable :: slips(:, :, :)   !< (P,3,0:1) of the slip and its derivative in time as seen from the surface, fixed axes [m/s]
    real(wp), allocatable :: turns(:, :)      !< (P,3) rotation of the surface, fixed axes [rad]
    real(wp), allocatable :: sliding(:)       !< (P) of the coefficient of sliding friction
    real(wp), allocatable :: past(:)          !< (P) of the way past the end of the stretch of its profile on which it stays [m]
    real(wp), allocatable :: normal_force(:)  !< (P) of the normal force of a compliant contact [N]
  end type contact_variation_type

  !> The motion of a ball's centre as seen from the link of the surface, and what its changes need; of links and centre along fixed axes.
  type :: relative_motion_type
    real(wp), dimension(3, 3) :: ball_r, r                  !< rotations of both links, of the surface in `r`
    real(wp), dimension(3) :: ball_omega, ball_alpha        !< turning of the ball's link [rad/s, rad/s^2]
    real(wp), dimension(3) :: omega, alpha                  !< turning of the surface's link [rad/s, rad/s^2]
    real(wp) :: centre(3, 0:2) = 0.0_wp                     !< position, velocity and acceleration of the centre [m]
    real(wp) :: x(3, 0:2) = 0.0_wp                          !< the same from the surface's `origin`, along the axes of its link [m]
    real(wp) :: spin(3, 0:1) = 0.0_wp                       !< turning of the ball's link as seen from it, along these axes [rad/s]
  contains
    procedure :: seen
  end type relative_motion_type

  !> A contact does not move along an axis where its mobility is this part of the largest: the square of round-off.
  real(wp), parameter :: least_mobility = epsilon(1.0_wp)**2

contains

  !> The derivatives of the numbers of a contact by a parameter; of size 0 where all are zero.
  pure function varied_numbers(mechanism, tangent, number) result(changes)
    type(mechanism_type), intent(in) :: mechanism    !< the mechanism
    type(tangent_type), intent(in) :: tangent        !< derivatives of all constants by the parameter
    integer, intent(in) :: number                    !< of the contact
    real(wp), allocatable :: changes(:)
    integer :: i

    do i = 1, size(mechanism%loads)
      select type (load => mechanism%loads(i)%load)
      type is (contact_load_type)
        if (load%number == number .and. tangent%loads(i)%varies) changes = tangent%loads(i)%change
      end select
    end do
    if (.not. allocated(changes)) allocate (changes(0))
  end function varied_numbers

  !> The derivatives of a contact by all parameters. The second derivative of the gap, and that of the slip in time, need all
  !> accelerations and their derivatives.
  subroutine vary_contact(model, motion, number, variation)
    type(model_type), intent(in) :: model                        !< the model
    type(varied_motion_type), intent(in) :: motion               !< derivatives of the motion
    integer, intent(in) :: number                                !< of the contact
    type(contact_variation_type), intent(out) :: variation       !< the derivatives
    type(relative_motion_type) :: relative
    type(gap_shape_type) :: shape
    type(contact_place_type) :: place
    type(link_motion_type) :: seen_ball, seen_surface
    real(wp), dimension(motion%n_parameters, 6, 0:2) :: ball, surface
    real(wp), allocatable :: numbers(:)
    real(wp) :: moved(3, 0:2), twist(6), slips(3, 0:1)
    integer :: p

    associate (contact => model%mechanism%contacts(number), n => motion%n_parameters)
      allocate (variation%gaps(n, 0:2), variation%slips(n, 3, 0:1), variation%turns(n, 3), variation%sliding(n), &
                variation%normal_force(n), variation%past(n), source=0.0_wp)
      call find_relative(contact, motion%plan, motion%state, relative)
      call place_of_contact(contact, motion%plan, motion%state, place, seen_ball, seen_surface)
      shape = find_gap_shape(contact, relative%x(:, 0), stretch_of_contact(contact, motion%state))
      call link_twists(motion, contact%links(1), ball)
      call link_twists(motion, contact%links(2), surface)
      do p = 1, n
        numbers = varied_numbers(model%mechanism, motion%tangents(p), number)
        twist = surface_change(contact, numbers)
        call find_moved(contact, motion%plan, relative, ball(p, :, :) - surface(p, :, :), numbers, moved)
        associate (x => relative%x, bent => matmul(shape%bending, moved(:, 0)), gaps => variation%gaps)
          gaps(p, 0) = dot_product(shape%normal, moved(:, 0))
          variation%past(p) = dot_product(shape%past_slope, moved(:, 0))
          gaps(p, 1) = dot_product(shape%normal, moved(:, 1)) + dot_product(x(:, 1), bent)
          gaps(p, 2) = dot_product(shape%normal, moved(:, 2)) + 2.0_wp*dot_product(x(:, 1), matmul(shape%bending, moved(:, 1))) &
                       + dot_product(x(:, 2), bent) + shape%bent(x(:, 1), moved(:, 0))
        end associate
        if (size(numbers) > 0) then
          variation%gaps(p, 0) = variation%gaps(p, 0) - numbers(4) - numbers(17)
          variation%sliding(p) = numbers(of_sliding)
        end if
        if (.not. contact%is_rigid) variation%normal_force(p) = vary_normal_force(contact, place%gap, place%gap_rate(), &
          contact_change_type(gap=variation%gaps(p, 0), gap_rate=variation%gaps(p, 1)), numbers)
        variation%turns(p, :) = surface(p, 1:3, 0) + turn(relative%r, twist(1:3))
        if (.not. contact%has_friction()) cycle
        call vary_slip(contact, shape, relative, ball(p, 1:3, :) - surface(p, 1:3, :), numbers, moved, slips)
        variation%slips(p, :, 0) = turn(relative%r, slips(:, 0))
        variation%slips(p, :, 1) = turn(relative%r, slips(:, 1))
      end do
    end associate
  end subroutine vary_contact

  !> The changes of the slip and of its derivative in time by one parameter, as seen from the surface, which may turn in its link. The rate
  !> of the gap along the normal, which turns, is no part of the slip. Along the normal itself the changes have no meaning.
  pure subroutine vary_slip(contact, shape, relative, turns, numbers, moved, slips)
    type(contact_type), intent(in) :: contact                !< the contact
    type(gap_shape_type), intent(in) :: shape                !< its gap near the place
    type(relative_motion_type), intent(in) :: relative       !< the motion
    real(wp), intent(in) :: turns(3, 0:2)                    !< (3,0:2) rotation of the ball's link against the surface's, and derivatives in time, fixed axes [rad, per s]
    real(wp), intent(in) :: numbers(:)                       !< (numbers) derivatives of the contact's numbers by one parameter, SI units; of size 0: all are zero
    real(wp), intent(in) :: moved(3, 0:2)                    !< (3,0:2) change of the centre, and derivatives in time, axes of the surface's link [m, per s]
    real(wp), intent(out) :: slips(3, 0:1)                   !< the changes, in the axes of the surface's link [m/s]
    real(wp) :: turned(3, 0:2), spins(3, 0:1), twist(6), normals(3, 0:1), rate(3), gap_rate

    turned = relative%seen(turns)
    twist = surface_change(contact, numbers)
    turned(:, 0) = turned(:, 0) - twist(1:3)
    associate (spin => relative%spin, x => relative%x, h => shape%bending)
      spins(:, 0) = turned(:, 1) + cross(turned(:, 0), spin(:, 0))
      spins(:, 1) = turned(:, 2) + cross(turned(:, 1), spin(:, 0)) + cross(turned(:, 0), spin(:, 1))
      rate = matmul(h, x(:, 1))
      normals(:, 0) = matmul(h, moved(:, 0))
      normals(:, 1) = matmul(h, moved(:, 1)) + shape%bent_along(x(:, 1), moved(:, 0))
      gap_rate = dot_product(shape%normal, x(:, 1))
      slips(:, 0) = moved(:, 1) - contact%radius*(cross(spins(:, 0), shape%normal) + cross(spin(:, 0), normals(:, 0))) &
                    - gap_rate*normals(:, 0)
      slips(:, 1) = moved(:, 2) - contact%radius*(cross(spins(:, 1), shape%normal) + cross(spin(:, 1), normals(:, 0)) &
                                                  + cross(spins(:, 0), rate) + cross(spin(:, 0), normals(:, 1))) &
                    - (dot_product(shape%normal, x(:, 2)) + dot_product(x(:, 1), rate))*normals(:, 0) - gap_rate*normals(:, 1) &
                    - (dot_product(shape%normal, moved(:, 1)) + dot_product(x(:, 1), normals(:, 0)))*rate
      if (size(numbers) == 0) return
      slips(:, 0) = slips(:, 0) - numbers(4)*cross(spin(:, 0), shape%normal)
      slips(:, 1) = slips(:, 1) - numbers(4)*(cross(spin(:, 1), shape%normal) + cross(spin(:, 0), rate))
    end associate
  end subroutine vary_slip

  !> The motion of the ball's centre as seen from the surface.
  pure subroutine find_relative(contact, plan, state, relative)
    type(contact_type), intent(in) :: contact                !< the contact
    type(plan_type), intent(in) :: plan                      !< the plan
    type(state_type), intent(in) :: state                    !< the motion, with accelerations
    type(relative_motion_type), intent(out) :: relative      !< the motion
    real(wp) :: origin(3, 0:2), p(3), v(3)

    call link_motion(plan, state, contact%links(1), relative%ball_r, p, relative%ball_omega, v)
    call link_turning(plan, state, contact%links(1), relative%ball_alpha)
    call link_motion(plan, state, contact%links(2), relative%r, p, relative%omega, v)
    call link_turning(plan, state, contact%links(2), relative%alpha)
    associate (c => relative%centre)
      call point_motion(plan, state, contact%links(1), contact%center, c(:, 0), c(:, 1), c(:, 2))
      call point_motion(plan, state, contact%links(2), [0.0_wp, 0.0_wp, 0.0_wp], origin(:, 0), origin(:, 1), origin(:, 2))
      relative%x = relative%seen(c - origin)
      relative%x(:, 0) = relative%x(:, 0) - contact%origin
    end associate
    associate (turning => relative%ball_omega - relative%omega)
      relative%spin(:, 0) = turn_back(relative%r, turning)
      relative%spin(:, 1) = turn_back(relative%r, relative%ball_alpha - relative%alpha - cross(relative%omega, turning))
    end associate
  end subroutine find_relative

  !> A vector and its derivatives in time, along fixed axes, as seen from the link of the surface.
  pure function seen(self, vector)
    class(relative_motion_type), intent(in) :: self   !< the motion, with the turning of this link
    real(wp), intent(in) :: vector(3, 0:2)            !< (3,0:2) a vector and its derivatives in time, fixed axes
    real(wp) :: seen(3, 0:2), carried(3)

    carried = cross(self%omega, vector(:, 0))
    seen(:, 0) = turn_back(self%r, vector(:, 0))
    seen(:, 1) = turn_back(self%r, vector(:, 1) - carried)
    seen(:, 2) = turn_back(self%r, vector(:, 2) - cross(self%alpha, vector(:, 0)) + cross(self%omega, carried) &
                                   - 2.0_wp*cross(self%omega, vector(:, 1)))
  end function seen

  !> The change of the centre as seen from the surface by one parameter.
  pure subroutine find_moved(contact, plan, relative, twists, numbers, moved)
    type(contact_type), intent(in) :: contact                !< the contact
    type(plan_type), intent(in) :: plan                      !< the plan
    type(relative_motion_type), intent(in) :: relative       !< the motion
    real(wp), intent(in) :: twists(6, 0:2)                   !< (6,0:2) change of pose of the ball's link against the surface's, and derivatives in time, fixed axes [rad, m, per s]
    real(wp), intent(in) :: numbers(:)                       !< (numbers) derivatives of the contact's numbers by one parameter, SI units; of size 0: all are zero
    real(wp), intent(out) :: moved(3, 0:2)                   !< (3,0:2) change of the centre and its derivatives in time, axes of the surface's link [m, per s]
    real(wp) :: e(3, 0:2), own(3), turned(3), twist(6)
    integer :: order

    associate (c => relative%centre, w => relative%ball_omega, alpha => relative%ball_alpha)
      do order = 0, 2
        e(:, order) = shift_at(twists(:, order), c(:, 0) - plan%origin)
      end do
      e(:, 1) = e(:, 1) + cross(twists(1:3, 0), c(:, 1))
      e(:, 2) = e(:, 2) + 2.0_wp*cross(twists(1:3, 1), c(:, 1)) + cross(twists(1:3, 0), c(:, 2))
      if (size(numbers) > 0) then
        own = turn(relative%ball_r, numbers(1:3))
        turned = cross(w, own)
        e(:, 0) = e(:, 0) + own
        e(:, 1) = e(:, 1) + turned
        e(:, 2) = e(:, 2) + cross(alpha, own) + cross(w, turned)
      end if
    end associate
    moved = relative%seen(e)
    if (size(numbers) == 0) return
    twist = surface_change(contact, numbers)
    moved(:, 0) = moved(:, 0) - twist(4:6)
    do order = 0, 2
      moved(:, order) = moved(:, order) - cross(twist(1:3), relative%x(:, order))
    end do
  end subroutine find_moved

  !> Find the derivatives of the forces of rigid contacts that are closed, and of friction, after those of the accelerations with these held; these
  !> accelerations get what the forces add. Fails where equilibrium does not determine forces that matter.
  subroutine find_varied_contacts(model, plan, dynamics, state, work, contact, sensitivity, err)
    type(model_type), intent(in) :: model                         !< the model
    type(plan_type), intent(in) :: plan                           !< its plan
    type(dynamics_plan_type), intent(in) :: dynamics              !< its plan of dynamics
    type(state_type), intent(in) :: state                         !< the motion, with all accelerations
    type(lagrange_work_type), intent(in) :: work                  !< with the coefficients of motion and the Jacobian
    class(contact_motion_type), intent(in) :: contact             !< the contacts, with their modes and forces
    type(motion_sensitivity_type), intent(inout) :: sensitivity   !< the derivatives
    type(error_type), allocatable, intent(out) :: err             !< allocated if it failed
    type(contact_rows_type) :: equations
    type(contact_variation_type), allocatable :: variations(:)
    integer, allocatable :: acting(:)
    real(wp), allocatable :: a(:, :), x(:), right(:), known(:, :), answer(:)
    real(wp), allocatable :: lines(:, :), directions(:, :)
    real(wp), allocatable :: moved(:)
    integer, allocatable :: of_contact(:), along(:), chosen(:)
    integer :: i, j, k, m, n, p
    logical :: depends

    associate (motion => sensitivity%motion, contacts => model%mechanism%contacts)
      acting = pack([(i, i=1, size(contacts))], contact%acts .and. (contacts%is_rigid .or. contacts%static_friction > 0.0_wp))
      n = size(acting)
      if (.not. allocated(motion%contact)) allocate (motion%contact(motion%n_parameters, 3*size(contacts)))
      motion%contact = 0.0_wp
      if (n == 0) return
      call choose_contacts(acting, .not. plan%driven(plan%independent), equations)
      call find_contact_rows(model%mechanism, plan, dynamics, state, work, equations, err)
      if (.not. allocated(err)) call sensitivity%complete(model, state, err)
      if (allocated(err)) return
      allocate (variations(n), known(3, n), directions(2, n), lines(3, 3*n), of_contact(3*n), along(3*n))
      do k = 1, n
        call vary_contact(model, motion, acting(k), variations(k))
      end do
      do k = 1, n
        directions(:, k) = friction_direction(contact%forces(:, acting(k)), &
                                              matmul(contact%direction(:, acting(k)), equations%axes(:, 2:3, k)))
      end do
      call find_lines(contacts(acting), contact%sticks(acting), directions, m, of_contact, along, lines)
      ! no coordinate moves a planar mechanism out of its plane
      moved = [(dot_product(equations%rows(:, along(j), of_contact(j)), equations%answers(:, along(j), of_contact(j))), j=1, m)]
      chosen = pack([(j, j=1, m)], moved > least_mobility*maxval(moved))
      m = size(chosen)
      of_contact(:m) = of_contact(chosen)
      along(:m) = along(chosen)
      lines(:, :m) = lines(:, chosen)
      allocate (a(m, m), x(m), right(m))
      do j = 1, m
        answer = matmul(equations%answers(:, :, of_contact(j)), lines(:, j))
        do i = 1, m
          a(i, j) = dot_product(equations%rows(:, along(i), of_contact(i)), answer)
        end do
      end do
      do p = 1, motion%n_parameters
        answer = 0.0_wp*equations%answers(:, 1, 1)
        do k = 1, n
          known(:, k) = 0.0_wp
          if (.not. contact%sticks(acting(k))) known(:, k) = turned_friction(contacts(acting(k)), contact%forces(1, acting(k)), &
                                                                             directions(:, k), equations, k, variations(k), p)
          answer = answer + matmul(equations%answers(:, :, k), known(:, k))
        end do
        do j = 1, m
          associate (varied => variations(of_contact(j)), axes => equations%axes(:, :, of_contact(j)))
            if (along(j) == 1) then
              right(j) = -varied%gaps(p, 2)
            else
              right(j) = -dot_product(axes(:, along(j)), varied%slips(p, :, 1))
            end if
            right(j) = right(j) - dot_product(equations%rows(:, along(j), of_contact(j)), answer)
          end associate
        end do
        call solve_least(a, right, spread(1.0_wp, 1, m), x, depends)
        if (depends .and. (model%request%output%with_forces() .or. any(contacts(acting)%static_friction > 0.0_wp))) then
          call refuse(contacts(acting(1)), failure_shared_contact, state%t, err)
          return
        end if
        do j = 1, m
          known(:, of_contact(j)) = known(:, of_contact(j)) + x(j)*lines(:, j)
        end do
        do k = 1, n
          motion%contact(p, 3*acting(k) - 2:3*acting(k)) = matmul(equations%axes(:, :, k), known(:, k))
          do i = 1, size(plan%free)
            j = findloc(equations%moving, plan%free_places(i), dim=1)
            sensitivity%values(p, i, 2) = sensitivity%values(p, i, 2) + dot_product(equations%answers(j, :, k), known(:, k))
          end do
        end do
      end do
    end associate
  end subroutine find_varied_contacts

  !> The unknown forces of closed contacts, along normal and tangents: one of each rigid one, with its friction while it slides, and two
  !> beside it of each that sticks.
  pure subroutine find_lines(contacts, sticks, directions, m, of_contact, along, lines)
    type(contact_type), intent(in) :: contacts(:)     !< the contacts
    logical, intent(in) :: sticks(:)                  !< each is held by friction
    real(wp), intent(in) :: directions(:, :)          !< (2,contacts) of the friction, along the tangents; zero: there is none
    integer, intent(out) :: m                         !< how many unknowns there are
    integer, intent(out) :: of_contact(:)             !< the contact of each
    integer, intent(out) :: along(:)                  !< axis along which it leaves no acceleration
    real(wp), intent(out) :: lines(:, :)              !< (3,unknowns) forces per unit of it
    integer :: i, c

    m = 0
    lines = 0.0_wp
    do i = 1, size(contacts)
      do c = merge(1, 2, contacts(i)%is_rigid), merge(3, 1, sticks(i))
        m = m + 1
        of_contact(m) = i
        along(m) = c
        lines(c, m) = 1.0_wp
      end do
      if (contacts(i)%is_rigid .and. .not. sticks(i)) lines(2:3, m) = contacts(i)%sliding_friction*directions(:, i)
    end do
  end subroutine find_lines

  !> The direction of a friction: against the last slip where it is zero, as when a compliant contact closes.
  pure function friction_direction(force, slid) result(direction)
    real(wp), intent(in) :: force(3)   !< of the contact, along normal and tangents [N]
    real(wp), intent(in) :: slid(2)    !< direction in which it slid last, along the tangents
    real(wp) :: direction(2)

    direction = -slid
    if (norm2(force(2:3)) > 0.0_wp) direction = force(2:3)
    if (norm2(direction) > 0.0_wp) direction = direction/norm2(direction)
  end function friction_direction

  !> The change of the friction of a contact that slides, along normal and tangents, under a normal force that is held if the contact is rigid:
  !> by its coefficient, by the direction of the slip, and by the normal force of a compliant one.
  pure function turned_friction(contact, normal_force, against, equations, k, varied, p) result(change)
    type(contact_type), intent(in) :: contact                !< the contact
    real(wp), intent(in) :: normal_force                     !< its normal force [N]
    real(wp), intent(in) :: against(2)                       !< direction of its friction, along the tangents
    type(contact_rows_type), intent(in) :: equations         !< equations of the contacts
    integer, intent(in) :: k                                 !< its place among them
    type(contact_variation_type), intent(in) :: varied       !< its derivatives
    integer, intent(in) :: p                                 !< number of the parameter
    real(wp) :: change(3), direction(2), slip(2), aside(2), turning

    change = 0.0_wp
    if (.not. contact%has_friction()) return
    direction = -against
    change(2:3) = -(varied%sliding(p)*normal_force + contact%sliding_friction*varied%normal_force(p))*direction
    associate (axes => equations%axes(:, :, k), place => equations%places(k))
      slip = matmul(place%slip, axes(:, 2:3))
      aside = [-direction(2), direction(1)]
      turning = dot_product(varied%turns(p, :), axes(:, 1))
      ! a slip that errors of integration have left has no direction of its own
      if (norm2(slip) > slip_of_errors*place%speed) &
        turning = turning + dot_product(aside, matmul(varied%slips(p, :, 0), axes(:, 2:3)))/norm2(slip)
      change(2:3) = change(2:3) - contact%sliding_friction*normal_force*turning*aside
    end associate
  end function turned_friction

  !> Fail because of a closed contact. No shorter step helps: the failure is none after which the integrator tries again.
  subroutine refuse(contact, kind, t, err)
    type(contact_type), intent(in) :: contact           !< the contact
    integer, intent(in) :: kind                         !< of the failure
    real(wp), intent(in) :: t                           !< time [s]
    type(error_type), allocatable, intent(out) :: err   !< the failure

    call raise(err, exit_data, kind)
    err%failure%t = t
    err%failure%number = contact%number
    err%place = contact%place
  end subroutine refuse
end module mech9_varied_contacts
