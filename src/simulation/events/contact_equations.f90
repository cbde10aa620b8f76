!> Impacts on contacts, and which contacts push, slide and stick afterwards, by the equations of motion in the present coordinates.
!>
!> With the mass matrix M of all coordinates that no drive of the data file moves, and the derivatives J of the gaps that are left to the
!> contacts by these coordinates, G = J M^-1 J^T. An impact has impulses L >= 0 with u' + e u >= 0, and one of both zero at each contact
!> (J. J. Moreau, Unilateral Contact and Dry Friction in Finite Freedom Dynamics, 1988; F. Pfeiffer and C. Glocker, Multibody Dynamics
!> with Unilateral Contacts, Wiley 1996): u and u' are the rates of the gaps before and after it, e is the restitution. Of several
!> impacts at once, which mechanics does not decide, this law is the one that is used. Forces of contacts at rest follow from the same
!> problem with accelerations in place of rates. Where contacts have friction, J has rows for the tangents, too, and impulses and forces
!> lie in the cones of Coulomb's law.
module mech9_contact_equations
  use mech9_kinds, only: wp
  use mech9_tolerances, only: round_off_of_rates
  use mech9_event_tolerances, only: round_off_of_impacts, at_rest, still, tied
  use mech9_error, only: error_type, raise, exit_singular
  use mech9_event_failures, only: failure_stop_violated, failure_singular_contact, failure_contact_violated, &
    failure_undecided_contact
  use mech9_result_units, only: unit_of, unit_name
  use mech9_cholesky, only: cholesky_solve
  use mech9_complementarity, only: solve_complementarity
  use mech9_friction_cones, only: friction_cones_type, new_friction_cones, opens, slides, sticks, one_solution, several_solutions
  use mech9_motion_view, only: link_motion_type
  use mech9_contact, only: contact_place_type
  use mech9_stop_contacts, only: stop_contact_type
  use mech9_contact_motion, only: contact_rows_type, choose_contacts, find_contact_rows, place_of_contact, &
    acceleration_of_contact
  use mech9_jacobian, only: rates_by_independent
  use mech9_lagrange, only: find_equations
  use mech9_motion_system, only: motion_system_type
  implicit none
  private
  public :: contact_equations_type, contact_outcome_type, shock_type, find_contact_equations, find_impact, find_pushing

  !> The equations of contacts in one position: of the gap of each, and of two tangents of contacts of links.
  type :: contact_equations_type
    integer, allocatable :: free(:)              !< places among the independent coordinates of those that no drive moves
    real(wp), allocatable :: factors(:, :)       !< Cholesky factors of their mass matrix
    real(wp), allocatable :: rows(:, :, :)       !< (free,3,contacts) J^T: derivatives of gap and slip
    real(wp), allocatable :: answers(:, :, :)    !< (free,3,contacts) M^-1 J^T: accelerations by unit forces
    real(wp), allocatable :: axes(:, :, :)       !< (3,3,contacts) normal and tangents of contacts of links, fixed axes
    real(wp), allocatable :: g(:, :)             !< G, of the gaps alone
    real(wp), allocatable :: rates(:)            !< (contacts) of the gaps [rad/s, m/s]
    real(wp), allocatable :: round_off(:)        !< (contacts) of these rates
    real(wp), allocatable :: slip(:, :)          !< (2,contacts) along the tangents [m/s]
    real(wp), allocatable :: still(:)            !< (contacts) slip up to which a contact of links is at rest [m/s]
    logical :: rubs = .false.                    !< a contact has friction, or is compliant and has a force of its own
  contains
    procedure :: allow_change
  end type contact_equations_type

  !> The modes of contacts after a meeting, and the impulses in it.
  type :: contact_outcome_type
    real(wp), allocatable :: accelerations(:)    !< (contacts) of the gaps under the forces of contacts [rad/s^2, m/s^2]
    logical, allocatable :: holds(:)             !< (contacts) it pushes, and no other that pushes implies it
    logical, allocatable :: sticks(:)            !< (contacts) friction holds it
    logical, allocatable :: stopped(:)           !< (contacts) friction left no slip in the impact
    real(wp), allocatable :: direction(:, :)     !< (3,contacts) in which it slides, of length 1; fixed axes
    real(wp), allocatable :: impulse(:, :)       !< (3,contacts) of an impact on the ball of a contact of links, fixed axes [N s]
  end type contact_outcome_type

  !> An impact on some contacts.
  type :: shock_type
    real(wp), allocatable :: impulses(:, :)      !< (3,contacts) along normal and tangents [N m s, N s]
    real(wp), allocatable :: rates(:)            !< (contacts) of the gaps after it [rad/s, m/s]
    logical, allocatable :: stopped(:)           !< (contacts) friction leaves no slip
  end type shock_type

contains

  !> Find the equations of some contacts at the present state of the system.
  subroutine find_contact_equations(system, held, contacts, equations, err)
    class(motion_system_type), intent(inout) :: system             !< the system, with placed frames and all independent rates
    logical, intent(in) :: held(:)                                 !< (M) a stop holds the coordinate
    type(stop_contact_type), intent(in) :: contacts(:)             !< the contacts that touch
    type(contact_equations_type), intent(out) :: equations         !< their equations
    type(error_type), allocatable, intent(out) :: err              !< allocated if a load fails, or a coordinate has no inertia
    type(contact_rows_type) :: of_links
    real(wp) :: row(size(system%plan%independent)), speed, duration
    integer, allocatable :: links(:)
    integer :: i, j, k, n
    logical :: may_move(system%plan%n_coordinates)

    if (allocated(system%contact)) system%state%contact_force = 0.0_wp
    call find_equations(system%model%mechanism, system%plan, system%dynamics, system%state, system%work, err)
    if (allocated(err)) return
    associate (plan => system%plan, state => system%state, time => system%model%request%time)
      may_move = .not. plan%driven .or. held
      ! pairs that stick do not resist impacts
      if (allocated(system%friction)) may_move(system%friction%held) = .true.
      links = pack([(i, i=1, size(contacts))], contacts%contact > 0)
      call choose_contacts(contacts(links)%contact, may_move(plan%independent), of_links)
      call find_contact_rows(system%model%mechanism, plan, system%dynamics, state, system%work, of_links, err)
      if (allocated(err)) then
        i = err%failure%coordinates(1)
        call raise(err, exit_singular, failure_singular_contact)
        err%failure%t = state%t
        err%failure%coordinates = [i]
        return
      end if
      call move_alloc(of_links%moving, equations%free)
      call move_alloc(of_links%factors, equations%factors)
      duration = max(abs(time%end - time%start), tiny(speed)/epsilon(speed))
      n = size(contacts)
      allocate (equations%rows(size(equations%free), 3, n), equations%axes(3, 3, n), equations%slip(2, n), equations%still(n), &
                equations%rates(n), equations%round_off(n), source=0.0_wp)
      do k = 1, size(links)
        i = links(k)
        equations%rows(:, :, i) = of_links%rows(:, :, k)
        equations%axes(:, :, i) = of_links%axes(:, :, k)
        associate (place => of_links%places(k), contact => system%model%mechanism%contacts(contacts(i)%contact))
          equations%rates(i) = place%gap_rate()
          equations%slip(:, i) = matmul(place%slip, equations%axes(:, 2:3, i))
          speed = of_links%speeds(k)
          equations%still(i) = at_rest*speed + epsilon(speed)*plan%length/duration
          equations%round_off(i) = round_off_of_rates*speed + epsilon(speed)*plan%length/duration
          ! the rate that integration leaves at a closed gap is no impact
          if (contacts(i)%held) equations%round_off(i) = equations%round_off(i) &
            + still*plan%length*maxval(abs(state%dq(plan%independent))/plan%unit_of(plan%independent))
          equations%rubs = equations%rubs .or. contact%has_friction() .or. .not. contact%is_rigid
        end associate
      end do
      do i = 1, n
        if (.not. contacts(i)%is_stop()) cycle
        call rates_by_independent(plan, system%dynamics, system%work%jacobian, contacts(i)%coordinate, row)
        equations%rows(:, 1, i) = contacts(i)%direction*row(equations%free)
        speed = sum(abs(row*state%dq(plan%independent)))
        equations%rates(i) = contacts(i)%direction*dot_product(row, state%dq(plan%independent))
        ! a coordinate that would move by round-off in the whole run rests
        equations%round_off(i) = round_off_of_rates*speed + epsilon(speed)*contacts(i)%unit(plan)/duration
      end do
      equations%answers = equations%rows
      do i = 1, n
        do j = 1, 3
          if (size(equations%free) > 0) call cholesky_solve(size(equations%free), equations%factors, equations%answers(:, j, i))
        end do
      end do
      allocate (equations%g(n, n))
      do i = 1, n
        do j = 1, i
          equations%g(i, j) = dot_product(equations%rows(:, 1, i), equations%answers(:, 1, j))
          equations%g(j, i) = equations%g(i, j)
        end do
      end do
    end associate
  end subroutine find_contact_equations

  !> Let contacts of links be at rest up to the round-off of an impact, too. A mechanism that an impact brings to rest has rates of this
  !> size alone, by which the slip could not be judged.
  pure subroutine allow_change(self, change)
    class(contact_equations_type), intent(inout) :: self   !< the equations after the impact
    real(wp), intent(in) :: change(:)                      !< (independent) what it has added to their rates [rad/s, m/s]
    integer :: i

    do i = 1, size(self%still)
      self%still(i) = self%still(i) + at_rest*sum(norm2(self%rows(:, :, i), dim=2)*abs(change(self%free)))
    end do
  end subroutine allow_change

  !> Find the impulses of an impact. Fails where drives move a coordinate beyond its stop, or links into each other.
  subroutine find_impact(system, contacts, equations, restitution, shock, err)
    class(motion_system_type), intent(inout) :: system         !< the system; its independent rates change
    type(stop_contact_type), intent(in) :: contacts(:)         !< the contacts that touch
    type(contact_equations_type), intent(in) :: equations      !< their equations, with the rates before the impact
    real(wp), intent(in) :: restitution(:)                     !< (contacts) of each
    type(shock_type), intent(out) :: shock                     !< the impact
    type(error_type), allocatable, intent(out) :: err          !< allocated if it failed
    type(friction_cones_type) :: cones
    real(wp) :: change(size(equations%free))
    logical :: holds(size(contacts)), solved
    integer :: i, found

    allocate (shock%impulses(3, size(contacts)), source=0.0_wp)
    allocate (shock%stopped(size(contacts)), source=.false.)
    shock%rates = equations%rates
    if (all(equations%rates >= -equations%round_off)) then
      shock%rates = merge(equations%rates, 0.0_wp, equations%rates > equations%round_off)
      return
    end if
    if (equations%rubs) then
      cones = cones_of(system, contacts, equations)
      ! all impacts have the friction of motion
      cones%static = cones%sliding
      cones%b(1::3) = (1.0_wp + restitution)*equations%rates
      cones%b(2::3) = equations%slip(1, :)
      cones%b(3::3) = equations%slip(2, :)
      cones%round_off = equations%round_off
      do i = 1, size(contacts)
        if (.not. contacts(i)%is_rigid) call leave_out(cones, i)
      end do
      call cones%solve(found)
      solved = found == one_solution
      if (found == several_solutions) then
        call fail_undecided(system, contacts, 2, err)
        return
      end if
      shock%impulses = reshape(cones%force, shape(shock%impulses))
      where (abs(shock%impulses) <= round_off_of_impacts*maxval(abs(shock%impulses))) shock%impulses = 0.0_wp
      holds = cones%mode /= opens .and. contacts%is_rigid
      shock%stopped = cones%mode == sticks
    else
      call solve_complementarity(size(contacts), equations%g, (1.0_wp + restitution)*equations%rates, equations%round_off, &
                                 shock%impulses(1, :), holds, solved)
    end if
    if (.not. solved) then
      call fail_unsolved(system, contacts, equations, err)
      return
    end if
    associate (changed => system%plan%independent(equations%free))
      do i = 1, size(contacts)
        change = matmul(equations%answers(:, :, i), shock%impulses(:, i))
        shock%rates = shock%rates + matmul(change, equations%rows(:, 1, :))
        system%state%dq(changed) = system%state%dq(changed) + change
      end do
    end associate
    where (holds) shock%rates = -restitution*equations%rates
    where (abs(shock%rates) <= equations%round_off .and. .not. holds) shock%rates = 0.0_wp
  end subroutine find_impact

  !> The friction cones of contacts, with W alone.
  function cones_of(system, contacts, equations) result(cones)
    class(motion_system_type), intent(in) :: system            !< the system
    type(stop_contact_type), intent(in) :: contacts(:)         !< the contacts
    type(contact_equations_type), intent(in) :: equations      !< their equations
    type(friction_cones_type) :: cones
    integer :: i, j

    cones = new_friction_cones(size(contacts))
    do i = 1, size(contacts)
      do j = 1, size(contacts)
        cones%w(3*i - 2:3*i, 3*j - 2:3*j) = matmul(transpose(equations%rows(:, :, i)), equations%answers(:, :, j))
      end do
      if (contacts(i)%is_stop()) cycle
      associate (contact => system%model%mechanism%contacts(contacts(i)%contact))
        cones%sliding(i) = contact%sliding_friction
        cones%static(i) = contact%static_friction
      end associate
    end do
  end function cones_of

  !> Leave out a contact that has no force.
  pure subroutine leave_out(cones, i)
    type(friction_cones_type), intent(inout) :: cones   !< the friction cones
    integer, intent(in) :: i                            !< number of the contact

    cones%given(i) = 0.0_wp
    cones%sliding(i) = 0.0_wp
    cones%static(i) = 0.0_wp
  end subroutine leave_out

  !> Find which of the contacts at rest push, and which of them slide and stick, for the present rates. Fails where drives press a coordinate
  !> beyond its stop or links into each other, and where friction does not allow one answer.
  subroutine find_pushing(system, contacts, equations, resting, slides_on, outcome, err)
    class(motion_system_type), intent(inout) :: system         !< the system, with the independent rates after an impact
    type(stop_contact_type), intent(in) :: contacts(:)         !< the contacts that touch
    type(contact_equations_type), intent(in) :: equations      !< their equations
    logical, intent(in) :: resting(:)                          !< (contacts) the gap has no rate
    integer, intent(in) :: slides_on                           !< number of the contact that can stick no longer; 0: none
    type(contact_outcome_type), intent(out) :: outcome         !< gets modes and directions of the contacts
    type(error_type), allocatable, intent(out) :: err          !< allocated if it failed
    type(friction_cones_type) :: cones
    real(wp) :: right(size(equations%free)), terms(3, size(contacts)), round_off(size(contacts))
    real(wp), allocatable :: force(:), g(:, :)
    logical, allocatable :: pushes(:)
    integer, allocatable :: judged(:)
    logical :: solved
    integer :: i

    associate (n => size(contacts))
      allocate (outcome%accelerations(n), outcome%direction(3, n), outcome%impulse(3, n), source=0.0_wp)
      allocate (outcome%holds(n), outcome%sticks(n), source=.false.)
    end associate
    call find_accelerations(system, contacts, equations, right, terms, round_off, err)
    if (allocated(err)) return
    outcome%accelerations = terms(1, :)
    if (equations%rubs) then
      call find_cones()
      return
    end if
    judged = pack([(i, i=1, size(contacts))], resting)
    if (size(judged) == 0) return
    allocate (force(size(judged)), pushes(size(judged)))
    allocate (g, source=equations%g(judged, judged))
    call solve_complementarity(size(judged), g, terms(1, judged), round_off(judged), force, pushes, solved)
    if (solved) then
      outcome%holds(judged) = pushes .and. force > 0.0_wp
      outcome%accelerations = outcome%accelerations + matmul(equations%g(:, judged), force)
    else
      call fail(system, contacts, equations, err)
    end if
  contains
    !> Find the outcome with friction.
    subroutine find_cones()
      real(wp) :: slip(2), v(3*size(contacts))
      integer :: found

      cones = cones_of(system, contacts, equations)
      cones%b = reshape(terms, [size(terms)])
      cones%round_off = round_off
      do i = 1, size(contacts)
        if (contacts(i)%is_stop()) then
          if (.not. resting(i)) call leave_out(cones, i)
          cycle
        end if
        associate (contact => system%model%mechanism%contacts(contacts(i)%contact))
          if (.not. (resting(i) .or. .not. contacts(i)%is_rigid)) call leave_out(cones, i)
          if (.not. contacts(i)%is_rigid) cones%given(i) = compliant_force(system, contacts(i)%contact)
          slip = equations%slip(:, i)
          cones%moves(i) = contact%has_friction() .and. norm2(slip) > equations%still(i) .and. i /= slides_on
          if (cones%moves(i)) cones%direction(:, i) = slip/norm2(slip)
          cones%must_slide(i) = i == slides_on .and. .not. cones%moves(i)
        end associate
      end do
      call cones%solve(found)
      if (found == several_solutions) call fail_undecided(system, contacts, 2, err)
      if (found /= one_solution .and. .not. allocated(err)) then
        call fail_unsolved(system, contacts, equations, err)
      end if
      if (allocated(err)) return
      v = cones%outcome()
      outcome%accelerations = v(1::3)
      do i = 1, size(contacts)
        outcome%holds(i) = cones%mode(i) /= opens .and. contacts(i)%is_rigid .and. resting(i) .and. &
                           (cones%force(3*i - 2) > 0.0_wp .or. cones%mode(i) == sticks)
        if (contacts(i)%is_stop()) cycle
        ! a contact at the bound of its friction that does not begin to slide sticks
        outcome%sticks(i) = cones%mode(i) == sticks .or. &
                            (cones%mode(i) == slides .and. cones%static(i) > 0.0_wp .and. &
                             .not. (cones%moves(i) .or. cones%must_slide(i)) .and. &
                             norm2(v(3*i - 1:3*i)) <= tied*sum(abs(cones%b)))
        outcome%direction(:, i) = matmul(equations%axes(:, 2:3, i), cones%direction(:, i))
      end do
    end subroutine find_cones
  end subroutine find_pushing

  !> Find the accelerations of gaps and slips without the forces of contacts.
  subroutine find_accelerations(system, contacts, equations, right, terms, round_off, err)
    class(motion_system_type), intent(inout) :: system         !< the system, with the independent rates after an impact
    type(stop_contact_type), intent(in) :: contacts(:)         !< the contacts that touch
    type(contact_equations_type), intent(in) :: equations      !< their equations
    real(wp), intent(out) :: right(:)                          !< (free) accelerations of the coordinates beside those by rates alone
    real(wp), intent(out) :: terms(:, :)                       !< (3,contacts) along normal and tangents [rad/s^2, m/s^2]
    real(wp), intent(out) :: round_off(:)                      !< (contacts) of those along the normals
    type(error_type), allocatable, intent(out) :: err          !< allocated if a load fails
    real(wp) :: given(3)
    integer :: i

    if (allocated(system%contact)) system%state%contact_force = 0.0_wp
    call find_equations(system%model%mechanism, system%plan, system%dynamics, system%state, system%work, err)
    if (allocated(err)) return
    right = system%work%forces(equations%free) - system%work%velocity_terms(equations%free)
    if (size(right) > 0) call cholesky_solve(size(right), equations%factors, right)
    do i = 1, size(contacts)
      if (contacts(i)%is_stop()) then
        given = [contacts(i)%direction*system%state%ddq(contacts(i)%coordinate), 0.0_wp, 0.0_wp]
      else
        given = matmul(acceleration_of_contact(system%model%mechanism%contacts(contacts(i)%contact), system%plan, system%state), &
                       equations%axes(:, :, i))
      end if
      terms(:, i) = given + matmul(right, equations%rows(:, :, i))
      round_off(i) = round_off_of_impacts*(abs(given(1)) + sum(abs(equations%rows(:, 1, i)*right)))
    end do
  end subroutine find_accelerations

  !> The normal force of a compliant contact in the present state [N].
  real(wp) function compliant_force(system, number) result(force)
    class(motion_system_type), intent(in) :: system            !< the system
    integer, intent(in) :: number                              !< of the contact
    type(contact_place_type) :: place
    type(link_motion_type) :: ball, surface

    associate (contact => system%model%mechanism%contacts(number))
      call place_of_contact(contact, system%plan, system%state, place, ball, surface)
      force = contact%normal_force(place)
    end associate
  end function compliant_force

  !> Fail because there are no impulses or forces: of drives that press, or of friction where free coordinates move all gaps.
  subroutine fail_unsolved(system, contacts, equations, err)
    class(motion_system_type), intent(in) :: system            !< the system
    type(stop_contact_type), intent(in) :: contacts(:)         !< the contacts that touch
    type(contact_equations_type), intent(in) :: equations      !< their equations
    type(error_type), allocatable, intent(out) :: err          !< the failure
    integer :: i

    if (equations%rubs .and. all([(equations%g(i, i) > 0.0_wp .or. .not. contacts(i)%is_rigid, i=1, size(contacts))])) then
      call fail_undecided(system, contacts, 1, err)
    else
      call fail(system, contacts, equations, err)
    end if
  end subroutine fail_unsolved

  !> Fail because contacts with friction have no solution, or several.
  subroutine fail_undecided(system, contacts, how, err)
    class(motion_system_type), intent(in) :: system            !< the system
    type(stop_contact_type), intent(in) :: contacts(:)         !< the contacts that touch
    integer, intent(in) :: how                                 !< 1: no solution, 2: several
    type(error_type), allocatable, intent(out) :: err          !< the failure
    integer :: i

    i = findloc(contacts%contact > 0, .true., dim=1)
    call raise(err, exit_singular, failure_undecided_contact)
    err%failure%t = system%state%t
    err%failure%number = contacts(i)%number()
    err%failure%limit = how
    err%place = system%model%mechanism%contacts(contacts(i)%contact)%place
  end subroutine fail_undecided

  !> Fail because drives move a coordinate beyond its stop, or links into each other: the contact that free coordinates move least, and that
  !> comes nearest.
  subroutine fail(system, contacts, equations, err)
    class(motion_system_type), intent(in) :: system            !< the system
    type(stop_contact_type), intent(in) :: contacts(:)         !< the contacts that touch
    type(contact_equations_type), intent(in) :: equations      !< their equations
    type(error_type), allocatable, intent(out) :: err          !< the failure
    integer :: i

    i = minloc(equations%rates, dim=1)
    if (any([(equations%g(i, i) <= 0.0_wp, i=1, size(contacts))])) &
      i = minloc([(equations%g(i, i), i=1, size(contacts))], dim=1)
    call raise(err, exit_singular, merge(failure_stop_violated, failure_contact_violated, contacts(i)%is_stop()))
    err%failure%t = system%state%t
    err%failure%number = contacts(i)%number()
    if (contacts(i)%is_stop()) then
      err%failure%coordinates = [contacts(i)%coordinate]
      err%failure%values = reshape([contacts(i)%limit, contacts(i)%direction*equations%rates(i)] &
                                   /unit_of(system%model%mechanism, contacts(i)%coordinate), [1, 2])
      err%failure%name = trim(unit_name(system%model%mechanism, contacts(i)%coordinate))
      err%place = system%model%mechanism%stops(contacts(i)%stop)%place
    else
      err%failure%values = reshape([equations%rates(i)], [1, 1])
      err%place = system%model%mechanism%contacts(contacts(i)%contact)%place
    end if
  end subroutine fail
end module mech9_contact_equations
