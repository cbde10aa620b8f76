!> The derivatives of gaps of contacts by parameters, and of the forces of rigid contacts that are closed, in a motion whose variational
!> equations are integrated.
!>
!> Seen from the link of the surface, the centre of the ball is at x, and its change by a parameter is the difference of the twists by which
!> both links move, at the centre. The second derivative of the gap g, n . x'' + x' . H x', changes by n . dx'' + 2 x' . H dx' +
!> x'' . H dx + (x' . dH x'). A closed contact leaves it no change: with the rows J of the gaps, the derivatives of the normal forces
!> satisfy J M^-1 J^T f' = -(change under forces that are held).
module mech9_varied_contacts
  use mech9_kinds, only: wp
  use mech9_error, only: error_type, raise, exit_data
  use mech9_integration_failures, only: failure_cornered_contact
  use mech9_rotation, only: cross, turn, turn_back
  use mech9_friction_cones, only: solve_least
  use mech9_contact, only: contact_type
  use mech9_contact_change, only: gap_shape_type, find_gap_shape, surface_change
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
  use mech9_contact_motion, only: contact_motion_type, contact_rows_type, find_contact_rows
  implicit none
  private
  public :: vary_gap, varied_numbers, find_varied_contacts

  !> The motion of a ball's centre as seen from the link of the surface, and what its changes need; of links and centre along fixed axes.
  type :: relative_motion_type
    real(wp), dimension(3, 3) :: ball_r, r                  !< rotations of both links, of the surface in `r`
    real(wp), dimension(3) :: ball_omega, ball_alpha        !< turning of the ball's link [rad/s, rad/s^2]
    real(wp), dimension(3) :: omega, alpha                  !< turning of the surface's link [rad/s, rad/s^2]
    real(wp) :: centre(3, 0:2) = 0.0_wp                     !< position, velocity and acceleration of the centre [m]
    real(wp) :: x(3, 0:2) = 0.0_wp                          !< the same from the surface's `origin`, along the axes of its link [m]
  contains
    procedure :: seen
  end type relative_motion_type

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

  !> The derivatives of the gap of a contact, and of its derivatives in time, by all parameters. The second one needs all accelerations,
  !> and their derivatives.
  subroutine vary_gap(model, motion, number, changes)
    type(model_type), intent(in) :: model              !< the model
    type(varied_motion_type), intent(in) :: motion     !< derivatives of the motion
    integer, intent(in) :: number                      !< of the contact
    real(wp), intent(out) :: changes(:, 0:)            !< (P,0:2) the derivatives [m, m/s, m/s^2]
    type(relative_motion_type) :: relative
    type(gap_shape_type) :: shape
    real(wp), dimension(motion%n_parameters, 6, 0:2) :: ball, surface
    real(wp), allocatable :: numbers(:)
    real(wp) :: moved(3, 0:2)
    integer :: p

    associate (contact => model%mechanism%contacts(number))
      call find_relative(contact, motion%plan, motion%state, relative)
      shape = find_gap_shape(contact, relative%x(:, 0))
      call link_twists(motion, contact%links(1), ball)
      call link_twists(motion, contact%links(2), surface)
      do p = 1, motion%n_parameters
        numbers = varied_numbers(model%mechanism, motion%tangents(p), number)
        call find_moved(contact, motion%plan, relative, ball(p, :, :) - surface(p, :, :), numbers, moved)
        associate (x => relative%x, bent => matmul(shape%bending, moved(:, 0)))
          changes(p, 0) = dot_product(shape%normal, moved(:, 0))
          if (size(numbers) > 0) changes(p, 0) = changes(p, 0) - numbers(4) - numbers(17)
          changes(p, 1) = dot_product(shape%normal, moved(:, 1)) + dot_product(x(:, 1), bent)
          changes(p, 2) = dot_product(shape%normal, moved(:, 2)) + 2.0_wp*dot_product(x(:, 1), matmul(shape%bending, moved(:, 1))) &
                          + dot_product(x(:, 2), bent) + shape%bent(x(:, 1), moved(:, 0))
        end associate
      end do
    end associate
  end subroutine vary_gap

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
  end subroutine find_relative

  !> A vector and its derivatives in time, along fixed axes, as seen from the link of the surface.
  pure function seen(self, vector)
    class(relative_motion_type), intent(in) :: self   !< the motion, with the turning of this link
    real(wp), intent(in) :: vector(3, 0:2)            !< the vector
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
    real(wp), intent(in) :: twists(6, 0:2)                   !< of the ball's link against the surface's, and derivatives in time
    real(wp), intent(in) :: numbers(:)                       !< derivatives of the contact's numbers; of size 0: all are zero
    real(wp), intent(out) :: moved(3, 0:2)                   !< the change and its derivatives in time
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

  !> Find the derivatives of the forces of rigid contacts that are closed, after those of the accelerations with these forces held; these
  !> accelerations get what the forces add. Fails at a corner of a path, where accelerations jump.
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
    integer, allocatable :: acting(:)
    real(wp), allocatable :: changes(:, :, :), a(:, :), forces(:), right(:)
    integer :: i, j, k, n, p
    logical :: depends

    associate (motion => sensitivity%motion, contacts => model%mechanism%contacts)
      acting = pack([(i, i=1, size(contacts))], contact%acts .and. contacts%is_rigid)
      n = size(acting)
      if (.not. allocated(motion%contact)) allocate (motion%contact(motion%n_parameters, size(contacts)))
      motion%contact = 0.0_wp
      if (n == 0) return
      call find_contact_rows(model%mechanism, acting, plan, dynamics, state, work, .not. plan%driven(plan%independent), &
                             equations, err)
      if (.not. allocated(err)) call sensitivity%complete(model, state, err)
      if (allocated(err)) return
      allocate (changes(motion%n_parameters, 0:2, n), forces(n))
      do k = 1, n
        call check_path(contacts(acting(k)), equations%places(k)%part, state%t, err)
        if (allocated(err)) return
        call vary_gap(model, motion, acting(k), changes(:, :, k))
      end do
      a = matmul(transpose(equations%rows(:, 1, :)), equations%answers(:, 1, :))
      do p = 1, motion%n_parameters
        right = -changes(p, 2, :)
        call solve_least(a, right, spread(1.0_wp, 1, n), forces, depends)
        motion%contact(p, acting) = forces
        do i = 1, size(plan%free)
          j = findloc(equations%moving, plan%free_places(i), dim=1)
          sensitivity%values(p, i, 2) = sensitivity%values(p, i, 2) + dot_product(equations%answers(j, 1, :), forces)
        end do
      end do
    end associate
  end subroutine find_varied_contacts

  !> Fail where a closed contact may pass a corner or an end of its path: accelerations jump there.
  subroutine check_path(contact, part, t, err)
    type(contact_type), intent(in) :: contact           !< the contact
    integer, intent(in) :: part                         !< of its profile on which the ball is; negative: a corner or an end
    real(wp), intent(in) :: t                           !< time [s]
    type(error_type), allocatable, intent(out) :: err   !< allocated if it may

    if (.not. allocated(contact%profile)) return
    if (size(contact%profile%pieces) == 1 .and. part > 0) return
    ! no shorter step makes the path smooth: the failure is none that the integrator tries again
    call raise(err, exit_data, failure_cornered_contact)
    err%failure%t = t
    err%failure%number = contact%number
    err%place = contact%place
  end subroutine check_path
end module mech9_varied_contacts
