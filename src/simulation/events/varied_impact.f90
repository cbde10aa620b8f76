!> The derivatives of an impact by parameters, at a position and with rates before it whose derivatives are known.
!>
!> They follow from a(q) d = J(q)^T L, with the coefficients of motion a, the changes d of the free rates and the impulses L of stops and
!> contacts: a d' = -(a)' d + (J^T)' L + J^T L'. The first two terms are those of a mechanism at rest with the accelerations d under the
!> forces L; L' is what rates after the impact need. The rate of a gap is u' = -e u, a contact that friction stops has no slip, and the
!> impulse of one that slides is the coefficient times its normal part, against the slip v after the impact: it turns as v does.
module mech9_varied_impact
  use mech9_kinds, only: wp
  use mech9_error, only: error_type
  use mech9_event_failures, only: cause_several_impacts, cause_rubbing_impact
  use mech9_event_tolerances, only: round_off_of_sticking
  use mech9_friction_cones, only: solve_least
  use mech9_lagrange, only: find_equations, complete_accelerations
  use mech9_frame_motion, only: place_all
  use mech9_motion_system, only: motion_system_type
  use mech9_varied_contacts, only: contact_variation_type, vary_contact
  use mech9_stop_contacts, only: stop_contact_type
  use mech9_event_refusals, only: refuse_at
  use mech9_contact_equations, only: contact_equations_type
  implicit none
  private
  public :: impact_type, add_varied_impact, meet_targets

  !> An impact, as the motion had it.
  type :: impact_type
    integer, allocatable :: ends(:)          !< numbers of the ends of stops, and of contacts, with an impulse
    real(wp), allocatable :: impulse(:)      !< (ends) their impulses along the normals, which are above zero [N m s, N s]
    real(wp), allocatable :: restitution(:)  !< (ends) that was used: 0 where endless impacts are left out
    real(wp), allocatable :: whole(:, :)     !< (3,ends) the impulses of contacts on their balls, with friction, fixed axes [N s]
    logical, allocatable :: sticks(:)        !< (ends) friction leaves no slip
  end type impact_type

  !> Conditions of an impact, and as many unknown impulses.
  type :: conditions_type
    integer :: count = 0                     !< how many there are
    integer, allocatable :: end(:)           !< the end to which each belongs
    real(wp), allocatable :: axis(:, :)      !< (3,conditions) along which the rate behind the impact is known: normal and tangents
    real(wp), allocatable :: line(:, :)      !< (3,conditions) impulse per unit of the unknown
    real(wp), allocatable :: own(:)          !< (conditions) change of this rate that the direction of slip takes, per unit of it [1/kg]
  end type conditions_type

  !> An end does not move along an axis where its mobility is this part of the largest: the square of round-off.
  real(wp), parameter :: least_mobility = epsilon(1.0_wp)**2

contains

  !> Add what the derivatives of position and parameters change of the impact, its impulses held. What the mechanism requires at rest
  !> without accelerations is no part of it, and is taken off.
  subroutine add_varied_impact(system, ends, impact, before, rates, err)
    class(motion_system_type), intent(inout) :: system     !< with these derivatives; those of the rates change
    type(stop_contact_type), intent(in) :: ends(:)         !< ends of stops and contacts with impulses
    type(impact_type), intent(in) :: impact                !< the impulses
    real(wp), intent(in) :: before(:)                      !< (M) rates before the impact [rad/s, m/s]
    real(wp), intent(in) :: rates(:)                       !< (M) behind the impact [rad/s, m/s]
    type(error_type), allocatable, intent(out) :: err      !< allocated if it failed
    real(wp) :: changes(size(system%sensitivity%values, 1), size(system%plan%free)), part
    integer :: i, j

    changes = 0.0_wp
    associate (sensitivity => system%sensitivity, plan => system%plan)
      allocate (sensitivity%gradient%given(plan%n_coordinates))
      do i = 0, 1
        part = real(i, wp)
        system%state%dq = 0.0_wp
        system%state%ddq = 0.0_wp
        call place_all(plan, system%state, err)
        if (.not. allocated(err)) &
          call find_equations(system%model%mechanism, plan, system%dynamics, system%state, system%work, err)
        if (allocated(err)) exit
        system%work%accelerations = merge(0.0_wp, part*(rates(plan%independent) - before(plan%independent)), &
                                          plan%driven(plan%independent))
        call complete_accelerations(plan, system%dynamics, system%work, system%state)
        sensitivity%gradient%given = 0.0_wp
        do j = 1, size(ends)
          if (ends(j)%is_stop()) then
            associate (force => sensitivity%gradient%given(ends(j)%coordinate))
              force = force + part*ends(j)%direction*impact%impulse(j)
            end associate
          else
            system%state%contact_force(:, ends(j)%contact) = part*impact%whole(:, j)
          end if
        end do
        call sensitivity%find_accelerations(system%model, system%state, system%work, err)
        if (allocated(err)) exit
        changes = changes + (2.0_wp*part - 1.0_wp)*sensitivity%values(:, :, 2)
      end do
      deallocate (sensitivity%gradient%given)
      if (allocated(system%contact)) system%state%contact_force = 0.0_wp
      sensitivity%values(:, :, 1) = sensitivity%values(:, :, 1) + changes
    end associate
  end subroutine add_varied_impact

  !> Add the derivatives of the impulses, by which rates behind the impact get theirs.
  subroutine meet_targets(system, ends, impact, equations, rates, target, err)
    class(motion_system_type), intent(inout) :: system         !< with the derivatives beside that; gets those of all coordinates
    type(stop_contact_type), intent(in) :: ends(:)             !< ends of stops and contacts with impulses
    type(impact_type), intent(in) :: impact                    !< the impulses
    type(contact_equations_type), intent(in) :: equations      !< their equations
    real(wp), intent(in) :: rates(:)                           !< (M) behind the impact [rad/s, m/s]
    real(wp), intent(in) :: target(:, :)                       !< (P,ends) derivatives of the rates of their gaps there
    type(error_type), allocatable, intent(out) :: err          !< allocated if it failed
    type(contact_variation_type) :: variations(size(ends))
    type(conditions_type) :: conditions
    real(wp) :: impulses(3, size(ends))
    integer :: i, j, k, p

    system%state%dq = rates
    system%state%ddq = 0.0_wp
    system%sensitivity%values(:, :, 2) = 0.0_wp
    call place_all(system%plan, system%state, err)
    if (.not. allocated(err)) call system%show_sensitivity(err)
    if (.not. allocated(err)) call find_conditions(system, ends, impact, equations, conditions, err)
    if (allocated(err)) return
    do k = 1, size(ends)
      if (.not. ends(k)%is_stop()) &
        call vary_contact(system%model, system%sensitivity%motion, ends(k)%contact, variations(k))
    end do
    associate (values => system%sensitivity%values, plan => system%plan)
      do p = 1, size(target, 1)
        do k = 1, size(ends)
          impulses(:, k) = turned_impulse(ends(k), impact%sticks(k), equations%axes(:, :, k), impact%whole(:, k), variations(k), p)
        end do
        call find_impulses(p, impulses, err)
        if (allocated(err)) return
        do i = 1, size(plan%free)
          j = findloc(equations%free, plan%free_places(i), dim=1)
          values(p, i, 1) = values(p, i, 1) + sum(equations%answers(j, :, :)*impulses)
        end do
      end do
    end associate
    call system%show_sensitivity(err)
  contains
    !> Find the derivatives of the impulses by one parameter, beside those that are known. Fails where ends depend on each other.
    subroutine find_impulses(p, impulses, err)
      integer, intent(in) :: p                               !< number of the parameter
      real(wp), intent(inout) :: impulses(:, :)              !< (3,ends) derivatives along normals and tangents; the known ones at first [N s]
      type(error_type), allocatable, intent(out) :: err      !< allocated if it failed
      real(wp), dimension(conditions%count, conditions%count) :: a
      real(wp), dimension(conditions%count) :: right, x
      real(wp) :: answer(size(equations%free)), row(size(equations%free))
      integer :: i, j
      logical :: depends

      answer = 0.0_wp
      do i = 1, size(ends)
        answer = answer + matmul(equations%answers(:, :, i), impulses(:, i))
      end do
      do i = 1, conditions%count
        associate (k => conditions%end(i), axis => conditions%axis(:, i))
          row = matmul(equations%rows(:, :, k), axis)
          do j = 1, conditions%count
            a(i, j) = dot_product(row, matmul(equations%answers(:, :, conditions%end(j)), conditions%line(:, j)))
          end do
          a(i, i) = a(i, i) + conditions%own(i)
          right(i) = -dot_product(row, answer)
          if (ends(k)%is_stop()) then
            right(i) = right(i) + target(p, k) - ends(k)%direction*system%sensitivity%motion%q(p, 1, ends(k)%coordinate)
          else if (abs(axis(1)) > 0.0_wp) then
            right(i) = right(i) + target(p, k) - variations(k)%gaps(p, 1)
          else
            right(i) = right(i) - dot_product(matmul(equations%axes(:, :, k), axis), variations(k)%slips(p, :, 0))
          end if
        end associate
      end do
      call solve_least(a, right, spread(1.0_wp, 1, size(x)), x, depends)
      if (depends) then
        call refuse_at(system, cause_several_impacts, ends(1), err)
        return
      end if
      do j = 1, conditions%count
        impulses(:, conditions%end(j)) = impulses(:, conditions%end(j)) + x(j)*conditions%line(:, j)
      end do
    end subroutine find_impulses
  end subroutine meet_targets

  !> Find the conditions of an impact. Fails where a contact slides that friction stops at its bound: it is stopped on one side of it alone.
  subroutine find_conditions(system, ends, impact, equations, conditions, err)
    class(motion_system_type), intent(in) :: system            !< the system
    type(stop_contact_type), intent(in) :: ends(:)             !< ends of stops and contacts with impulses
    type(impact_type), intent(in) :: impact                    !< the impulses
    type(contact_equations_type), intent(in) :: equations      !< their equations, with the slip behind the impact
    type(conditions_type), intent(out) :: conditions           !< the conditions
    type(error_type), allocatable, intent(out) :: err          !< allocated if derivatives do not exist
    real(wp) :: normal(3), direction(2), force(2), largest
    integer :: i

    associate (n => 3*size(ends))
      allocate (conditions%end(n), conditions%axis(3, n), conditions%line(3, n), conditions%own(n))
    end associate
    largest = 0.0_wp
    do i = 1, size(ends)
      largest = max(largest, maxval(sum(equations%rows(:, :, i)*equations%answers(:, :, i), dim=1)))
    end do
    normal = [1.0_wp, 0.0_wp, 0.0_wp]
    do i = 1, size(ends)
      call add(normal, normal, 0.0_wp)
      if (ends(i)%is_stop()) cycle
      associate (contact => system%model%mechanism%contacts(ends(i)%contact))
        if (.not. contact%has_friction()) cycle
        force = matmul(impact%whole(:, i), equations%axes(:, 2:3, i))
        if (impact%sticks(i)) then
          if (norm2(force) >= (1.0_wp - round_off_of_sticking)*contact%sliding_friction*impact%impulse(i)) exit
          call add([0.0_wp, 1.0_wp, 0.0_wp], [0.0_wp, 1.0_wp, 0.0_wp], 0.0_wp)
          call add([0.0_wp, 0.0_wp, 1.0_wp], [0.0_wp, 0.0_wp, 1.0_wp], 0.0_wp)
        else if (norm2(force) > 0.0_wp) then
          if (norm2(equations%slip(:, i)) <= equations%still(i)) exit
          direction = -force/norm2(force)
          conditions%line(2:3, conditions%count) = -contact%sliding_friction*direction
          associate (aside => [0.0_wp, -direction(2), direction(1)])
            call add(aside, aside, norm2(equations%slip(:, i))/norm2(force))
          end associate
        end if
      end associate
    end do
    if (i <= size(ends)) call refuse_at(system, cause_rubbing_impact, ends(i), err)
  contains
    !> Add a condition. No coordinate moves a planar mechanism out of its plane.
    subroutine add(axis, line, own)
      real(wp), intent(in) :: axis(3)   !< along which the rate is known
      real(wp), intent(in) :: line(3)   !< impulse per unit of the unknown
      real(wp), intent(in) :: own       !< change of the rate per unit of it [1/kg]

      if (.not. dot_product(matmul(equations%rows(:, :, i), axis), matmul(equations%answers(:, :, i), axis)) > &
          least_mobility*largest) return
      associate (n => conditions%count)
        n = n + 1
        conditions%end(n) = i
        conditions%axis(:, n) = axis
        conditions%line(:, n) = line
        conditions%own(n) = own
      end associate
    end subroutine add
  end subroutine find_conditions

  !> The derivative of the impulse of friction of a contact that slides, under a normal impulse and a slip that are held, along normal and
  !> tangents: by its coefficient, and by the turn of the surface.
  pure function turned_impulse(end, sticks, axes, whole, varied, p) result(change)
    type(stop_contact_type), intent(in) :: end               !< the end of a stop, or the contact
    logical, intent(in) :: sticks                            !< friction leaves no slip
    real(wp), intent(in) :: axes(3, 3)                       !< normal and tangents, fixed axes
    real(wp), intent(in) :: whole(3)                         !< its impulse, fixed axes [N s]
    type(contact_variation_type), intent(in) :: varied       !< its derivatives
    integer, intent(in) :: p                                 !< number of the parameter
    real(wp) :: change(3), impulse(3)

    change = 0.0_wp
    if (end%is_stop() .or. sticks) return
    impulse = matmul(whole, axes)
    if (.not. norm2(impulse(2:3)) > 0.0_wp) return
    change(2:3) = varied%sliding(p)*impulse(1)*impulse(2:3)/norm2(impulse(2:3)) &
                  + dot_product(varied%turns(p, :), axes(:, 1))*[-impulse(3), impulse(2)]
  end function turned_impulse
end module mech9_varied_impact
