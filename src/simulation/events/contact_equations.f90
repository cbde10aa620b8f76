!> Impacts on contacts, and which contacts push afterwards, by the equations of motion in the present coordinates.
!>
!> With the mass matrix M of all coordinates that no drive of the data file moves, and the derivatives J of the gaps that are left to the
!> contacts by these coordinates, G = J M^-1 J^T. An impact has impulses L >= 0 with u' + e u >= 0, and one of both zero at each contact
!> (J. J. Moreau, Unilateral Contact and Dry Friction in Finite Freedom Dynamics, 1988; F. Pfeiffer and C. Glocker, Multibody Dynamics
!> with Unilateral Contacts, Wiley 1996): u and u' are the rates of the gaps before and after it, e is the restitution. Of several
!> impacts at once, which mechanics does not decide, this law is the one that is used. Forces of contacts at rest follow from the same
!> problem with accelerations in place of rates.
module mech9_contact_equations
  use mech9_kinds, only: wp
  use mech9_tolerances, only: round_off_of_rates
  use mech9_event_tolerances, only: round_off_of_impacts
  use mech9_error, only: error_type, raise, exit_singular
  use mech9_event_failures, only: failure_stop_violated, failure_singular_contact
  use mech9_result_units, only: unit_of, unit_name
  use mech9_cholesky, only: cholesky_factorize, cholesky_solve
  use mech9_complementarity, only: solve_complementarity
  use mech9_stop_contacts, only: stop_contact_type
  use mech9_jacobian, only: rates_by_independent
  use mech9_lagrange, only: find_equations
  use mech9_motion_system, only: motion_system_type
  implicit none
  private
  public :: contact_equations_type, find_contact_equations, find_impact, find_pushing

  !> The equations of contacts in one position.
  type :: contact_equations_type
    integer, allocatable :: free(:)              !< places among the independent coordinates of those that no drive moves
    real(wp), allocatable :: factors(:, :)       !< Cholesky factors of their mass matrix
    real(wp), allocatable :: gap_gradients(:, :) !< (free,contacts) J^T: derivatives of the gaps
    real(wp), allocatable :: answers(:, :)       !< (free,contacts) M^-1 J^T: accelerations by unit forces
    real(wp), allocatable :: g(:, :)             !< G
    real(wp), allocatable :: rates(:)            !< of the gaps [rad/s, m/s]
    real(wp), allocatable :: round_off(:)        !< of these rates
  end type contact_equations_type

contains

  !> Find the equations of some contacts at the present state of the system.
  subroutine find_contact_equations(system, held, contacts, equations, err)
    class(motion_system_type), intent(inout) :: system             !< the system, with placed frames and all independent rates
    logical, intent(in) :: held(:)                                 !< (M) a contact holds the coordinate
    type(stop_contact_type), intent(in) :: contacts(:)             !< the contacts that touch
    type(contact_equations_type), intent(out) :: equations         !< their equations
    type(error_type), allocatable, intent(out) :: err              !< allocated if a load fails, or a coordinate has no inertia
    real(wp) :: a(size(system%plan%independent), size(system%plan%independent)), row(size(system%plan%independent)), speed
    integer :: failed_at, i, j, n
    logical :: may_move(system%plan%n_coordinates)

    call find_equations(system%model%mechanism, system%plan, system%dynamics, system%state, system%work, err)
    if (allocated(err)) return
    associate (plan => system%plan, state => system%state)
      may_move = .not. plan%driven .or. held
      ! pairs that stick do not resist impacts
      if (allocated(system%friction)) may_move(system%friction%held) = .true.
      equations%free = pack([(i, i=1, size(plan%independent))], may_move(plan%independent))
      n = size(equations%free)
      a = system%work%coefficients
      do i = 1, size(a, 1)
        a(i, i + 1:) = a(i + 1:, i)
      end do
      allocate (equations%factors, source=a(equations%free, equations%free))
      call cholesky_factorize(n, equations%factors, failed_at)
      if (failed_at > 0) then
        call raise(err, exit_singular, failure_singular_contact)
        err%failure%t = state%t
        err%failure%coordinates = [plan%independent(equations%free(failed_at))]
        return
      end if
      allocate (equations%gap_gradients(n, size(contacts)), equations%rates(size(contacts)), equations%round_off(size(contacts)))
      do i = 1, size(contacts)
        call rates_by_independent(plan, system%dynamics, system%work%jacobian, contacts(i)%coordinate, row)
        equations%gap_gradients(:, i) = contacts(i)%direction*row(equations%free)
        speed = sum(abs(row*state%dq(plan%independent)))
        equations%rates(i) = contacts(i)%direction*dot_product(row, state%dq(plan%independent))
        ! a coordinate that would move by round-off in the whole run rests
        associate (time => system%model%request%time)
          equations%round_off(i) = round_off_of_rates*speed + epsilon(speed)*plan%unit_of(contacts(i)%coordinate) &
                                                              /max(abs(time%end - time%start), tiny(speed)/epsilon(speed))
        end associate
      end do
      equations%answers = equations%gap_gradients
      do i = 1, size(contacts)
        call cholesky_solve(n, equations%factors, equations%answers(:, i))
      end do
      allocate (equations%g(size(contacts), size(contacts)))
      do i = 1, size(contacts)
        do j = 1, i
          equations%g(i, j) = dot_product(equations%gap_gradients(:, i), equations%answers(:, j))
          equations%g(j, i) = equations%g(i, j)
        end do
      end do
    end associate
  end subroutine find_contact_equations

  !> Find the impulses of an impact. Fails where drives move a coordinate beyond its stop.
  subroutine find_impact(system, contacts, equations, restitution, impulses, rates, err)
    class(motion_system_type), intent(inout) :: system         !< the system; its independent rates change
    type(stop_contact_type), intent(in) :: contacts(:)         !< the contacts that touch
    type(contact_equations_type), intent(in) :: equations      !< their equations, with the rates before the impact
    real(wp), intent(in) :: restitution(:)                     !< (contacts) of each
    real(wp), intent(out) :: impulses(:)                       !< (contacts) of each, positive or zero [N m s, N s]
    real(wp), intent(out) :: rates(:)                          !< (contacts) of the gaps after the impact [rad/s, m/s]
    type(error_type), allocatable, intent(out) :: err          !< allocated if it failed
    logical :: holds(size(contacts)), solved

    call solve_complementarity(size(contacts), equations%g, (1.0_wp + restitution)*equations%rates, equations%round_off, impulses, &
                               holds, solved)
    if (.not. solved) then
      call fail(system, contacts, equations, err)
      return
    end if
    rates = equations%rates + matmul(equations%g, impulses)
    where (holds) rates = -restitution*equations%rates
    where (abs(rates) <= equations%round_off .and. .not. holds) rates = 0.0_wp
    associate (changed => system%plan%independent(equations%free))
      system%state%dq(changed) = system%state%dq(changed) + matmul(equations%answers, impulses)
    end associate
  end subroutine find_impact

  !> Find which of the contacts at rest push, for the present rates. Fails where drives press a coordinate beyond its stop.
  subroutine find_pushing(system, contacts, equations, at_rest, accelerations, holds, err)
    class(motion_system_type), intent(inout) :: system         !< the system, with the independent rates after an impact
    type(stop_contact_type), intent(in) :: contacts(:)         !< the contacts that touch
    type(contact_equations_type), intent(in) :: equations      !< their equations
    logical, intent(in) :: at_rest(:)                          !< (contacts) the gap has no rate
    real(wp), intent(out) :: accelerations(:)                  !< (contacts) of the gaps under the forces of contacts at rest [rad/s^2, m/s^2]
    logical, intent(out) :: holds(:)                           !< (contacts) it pushes, and no other that pushes implies it
    type(error_type), allocatable, intent(out) :: err          !< allocated if it failed
    real(wp) :: right(size(equations%free)), round_off(size(contacts))
    real(wp), allocatable :: force(:), g(:, :)
    logical, allocatable :: pushes(:)
    integer, allocatable :: resting(:)
    logical :: solved
    integer :: i

    holds = .false.
    call find_equations(system%model%mechanism, system%plan, system%dynamics, system%state, system%work, err)
    if (allocated(err)) return
    right = system%work%forces(equations%free) - system%work%velocity_terms(equations%free)
    call cholesky_solve(size(right), equations%factors, right)
    do i = 1, size(contacts)
      associate (given => contacts(i)%direction*system%state%ddq(contacts(i)%coordinate))
        accelerations(i) = given + dot_product(equations%gap_gradients(:, i), right)
        round_off(i) = round_off_of_impacts*(abs(given) + sum(abs(equations%gap_gradients(:, i)*right)))
      end associate
    end do
    resting = pack([(i, i=1, size(contacts))], at_rest)
    if (size(resting) == 0) return
    allocate (force(size(resting)), pushes(size(resting)))
    allocate (g, source=equations%g(resting, resting))
    call solve_complementarity(size(resting), g, accelerations(resting), round_off(resting), force, pushes, solved)
    if (solved) then
      holds(resting) = pushes .and. force > 0.0_wp
      accelerations = accelerations + matmul(equations%g(:, resting), force)
    else
      call fail(system, contacts, equations, err)
    end if
  end subroutine find_pushing

  !> Fail because drives move a coordinate beyond its stop: the one that free coordinates move least, and that comes nearest.
  subroutine fail(system, contacts, equations, err)
    class(motion_system_type), intent(in) :: system            !< the system
    type(stop_contact_type), intent(in) :: contacts(:)         !< the contacts that touch
    type(contact_equations_type), intent(in) :: equations      !< their equations
    type(error_type), allocatable, intent(out) :: err          !< the failure
    integer :: i

    i = minloc(equations%rates, dim=1)
    if (any([(equations%g(i, i) <= 0.0_wp, i=1, size(contacts))])) &
      i = minloc([(equations%g(i, i), i=1, size(contacts))], dim=1)
    call raise(err, exit_singular, failure_stop_violated)
    err%failure%t = system%state%t
    err%failure%number = contacts(i)%stop
    err%failure%coordinates = [contacts(i)%coordinate]
    err%failure%values = reshape([contacts(i)%limit, contacts(i)%direction*equations%rates(i)] &
                                 /unit_of(system%model%mechanism, contacts(i)%coordinate), [1, 2])
    err%failure%name = trim(unit_name(system%model%mechanism, contacts(i)%coordinate))
    err%place = system%model%mechanism%stops(contacts(i)%stop)%place
  end subroutine fail
end module mech9_contact_equations
