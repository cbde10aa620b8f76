!> Directions beside a motion on closed contacts.
!>
!> A neighbouring start beside a contact falls onto it, and one that slides where friction holds it is stopped: both motions become the same.
!> A direction loses what leads there. It is moved onto the contacts by the least change, weighed by mass: along M^-1 J^T. Later on this
!> takes off what errors of integration leave, which would outlive directions that decay.
module mech9_held_directions
  use mech9_kinds, only: wp
  use mech9_error, only: error_type
  use mech9_state, only: state_type, copy_state
  use mech9_friction_cones, only: solve_least
  use mech9_motion_system, only: motion_system_type
  use mech9_varied_contacts, only: contact_variation_type, vary_contact
  use mech9_stop_contacts, only: stop_contact_type
  use mech9_contact_equations, only: contact_equations_type, find_contact_equations
  implicit none
  private
  public :: hold_directions

  !> Conditions of directions.
  type :: conditions_type
    integer, allocatable :: end(:)      !< the end to which each belongs
    integer, allocatable :: axis(:)     !< 1: the gap does not change; 2, 3: nor does the slip along a tangent
    integer, allocatable :: place(:)    !< (free) places of the free coordinates in the equations
  end type conditions_type

contains

  !> Take from all directions what closed ends of stops and contacts hold. Derivatives by parameters that set numbers stay as they are.
  subroutine hold_directions(system, ends, err)
    class(motion_system_type), intent(inout) :: system     !< the system, with the modes of contacts; its directions change
    type(stop_contact_type), intent(in) :: ends(:)         !< all ends, closed or open as they are from now on
    type(error_type), allocatable, intent(out) :: err      !< allocated if it failed
    type(contact_equations_type) :: equations
    type(conditions_type) :: conditions
    integer, allocatable :: closed(:)
    type(state_type) :: kept
    integer :: i, order

    closed = pack([(i, i=1, size(ends))], [(acts(ends(i)), i=1, size(ends))])
    if (size(closed) == 0) return
    call copy_state(system%state, kept)
    call find_contact_equations(system, [(.false., i=1, system%plan%n_coordinates)], ends(closed), equations, err)
    call copy_state(kept, system%state)
    if (allocated(err)) return
    associate (plan => system%plan)
      conditions%place = [(findloc(equations%free, plan%free_places(i), dim=1), i=1, size(plan%free))]
    end associate
    do order = 0, 1
      call choose_conditions(order)
      if (size(conditions%end) == 0) cycle
      call meet_conditions(system, ends(closed), equations, conditions, order)
      call system%show_sensitivity(err)
      if (allocated(err)) return
    end do
  contains
    !> Whether an end holds directions.
    pure logical function acts(end)
      type(stop_contact_type), intent(in) :: end   !< the end

      acts = end%is_rigid .and. end%closed
      if (.not. acts .and. end%contact > 0) acts = system%contact%acts(end%contact) .and. system%contact%sticks(end%contact)
    end function acts

    !> Choose the conditions of positions or of rates.
    subroutine choose_conditions(order)
      integer, intent(in) :: order   !< 0: of positions, 1: of rates
      integer :: k, c, first, last

      conditions%end = [integer ::]
      conditions%axis = [integer ::]
      do k = 1, size(closed)
        associate (end => ends(closed(k)))
          first = merge(1, 2, end%is_rigid)
          last = 1
          if (order == 1 .and. end%contact > 0) last = merge(3, 1, system%contact%sticks(end%contact))
          do c = first, last
            ! no coordinate moves a planar mechanism out of its plane
            if (.not. any(abs(equations%rows(:, c, k)) > 0.0_wp)) cycle
            conditions%end = [conditions%end, k]
            conditions%axis = [conditions%axis, c]
          end do
        end associate
      end do
    end subroutine choose_conditions
  end subroutine hold_directions

  !> Change all directions so that they meet conditions.
  subroutine meet_conditions(system, ends, equations, conditions, order)
    class(motion_system_type), intent(inout) :: system         !< the system; its directions change
    type(stop_contact_type), intent(in) :: ends(:)             !< the ends
    type(contact_equations_type), intent(in) :: equations      !< their equations
    type(conditions_type), intent(in) :: conditions            !< the conditions
    integer, intent(in) :: order                               !< 0: of positions, 1: of rates
    type(contact_variation_type) :: variations(size(ends))
    real(wp), dimension(size(conditions%end)) :: right, x
    real(wp) :: a(size(x), size(x)), change
    integer :: i, j, k, p
    logical :: depends

    do k = 1, size(ends)
      if (.not. ends(k)%is_stop()) call vary_contact(system%model, system%sensitivity%motion, ends(k)%contact, variations(k))
    end do
    do i = 1, size(x)
      do j = 1, size(x)
        a(i, j) = dot_product(equations%rows(:, conditions%axis(i), conditions%end(i)), &
                              equations%answers(:, conditions%axis(j), conditions%end(j)))
      end do
    end do
    associate (sensitivity => system%sensitivity, parameters => system%model%parameters)
      do p = 1, size(sensitivity%values, 1)
        if (size(parameters(p)%targets) > 0) cycle
        do i = 1, size(x)
          k = conditions%end(i)
          if (ends(k)%is_stop()) then
            right(i) = -ends(k)%direction*sensitivity%motion%q(p, order, ends(k)%coordinate)
          else if (conditions%axis(i) == 1) then
            right(i) = -variations(k)%gaps(p, order)
          else
            right(i) = -dot_product(equations%axes(:, conditions%axis(i), k), variations(k)%slips(p, :, 0))
          end if
        end do
        call solve_least(a, right, spread(1.0_wp, 1, size(x)), x, depends)
        do j = 1, size(conditions%place)
          change = 0.0_wp
          do i = 1, size(x)
            change = change + x(i)*equations%answers(conditions%place(j), conditions%axis(i), conditions%end(i))
          end do
          sensitivity%values(p, j, order) = sensitivity%values(p, j, order) + change
        end do
      end do
    end associate
  end subroutine meet_conditions
end module mech9_held_directions
