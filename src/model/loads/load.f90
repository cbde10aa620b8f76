!> A load pulls, pushes or turns links or coordinates; all kinds of loads have this interface.
module mech9_load
  use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
  use mech9_kinds, only: wp
  use mech9_error, only: error_type, place_type
  use mech9_differentiation, only: half_width, step_count, trial_step, derivatives_from_stencil
  use mech9_law, only: law_type
  use mech9_motion_view, only: motion_view_type
  use mech9_motion_change, only: motion_change_type
  use mech9_force_sum, only: force_sum_type, new_force_sum
  use mech9_law_over, only: law_over_type
  implicit none
  private
  public :: load_type, load_slot_type, append_loads

  !> A load of any kind.
  type, abstract :: load_type
    type(place_type) :: place       !< place of its group in the data file
    class(law_type), allocatable :: law   !< its forces are multiplied by this law of time, where there is one
    type(law_over_type), allocatable :: over   !< or by this law over another variable
  contains
    procedure(mark_interface), deferred :: mark_links
    procedure :: mark_coordinates
    procedure :: is_idle
    procedure :: may_follow_time
    procedure(apply_interface), deferred :: apply
    procedure(potential_interface), deferred :: potential
    procedure :: vary
    procedure :: knows_slopes
    procedure :: add_slopes
    procedure :: numbers => unknown_numbers
    procedure :: take_numbers => take_no_numbers
    procedure :: vary_by_numbers
    procedure :: varied_potential => unvaried_potential
    procedure, non_overridable :: constants
    procedure :: vary_numbers
  end type load_type

  !> One of several loads of different kinds.
  type :: load_slot_type
    class(load_type), allocatable :: load
  end type load_slot_type

  abstract interface
    !> Mark the links whose motion the load depends on or on which it acts.
    pure subroutine mark_interface(self, needed)
      import :: load_type
      class(load_type), intent(in) :: self   !< the load
      logical, intent(inout) :: needed(:)    !< (N) becomes true for these links; others stay
    end subroutine mark_interface

    !> Add the forces of the load in the present state. Fails where it has no value.
    subroutine apply_interface(self, state, sum, err)
      import :: load_type, motion_view_type, force_sum_type, error_type
      class(load_type), intent(in) :: self                !< the load
      type(motion_view_type), intent(in) :: state         !< present motion of links and coordinates
      type(force_sum_type), intent(inout) :: sum          !< forces so far; the load is added
      type(error_type), allocatable, intent(out) :: err   !< allocated if it failed
    end subroutine apply_interface

    !> Potential energy [J]: the energy of springs; zero for all loads whose work counts as put in, those with a law among them.
    pure real(wp) function potential_interface(self, state)
      import :: load_type, motion_view_type, wp
      class(load_type), intent(in) :: self          !< the load
      type(motion_view_type), intent(in) :: state   !< present motion of links and coordinates
    end function potential_interface
  end interface

contains

  !> Mark the coordinates that the load depends on or acts on. This procedure, for loads on links alone, marks none.
  pure subroutine mark_coordinates(self, needed)
    class(load_type), intent(in) :: self   !< the load
    logical, intent(inout) :: needed(:)    !< (M) becomes true for these coordinates; others stay
  end subroutine mark_coordinates

  !> Whether the load never moves anything, because it is zero or acts on link 1 alone. This procedure, for kinds that do
  !> not give it, answers that it may.
  pure logical function is_idle(self)
    class(load_type), intent(in) :: self   !< the load

    is_idle = .false.
  end function is_idle

  !> Whether the forces may depend on the time beside the law by which they are multiplied. This procedure, for kinds whose formula is
  !> known, answers that they do not.
  pure logical function may_follow_time(self)
    class(load_type), intent(in) :: self   !< the load

    may_follow_time = .false.
  end function may_follow_time

  !> Add the derivative of the load's forces by a parameter on which the motion depends. Fails where the load has no value.
  !> This procedure, for kinds whose formula is not known, takes differences over a wide stencil of motions, of which the one
  !> with the least error counts; the motion must change by about its own size when the parameter changes by 1.
  subroutine vary(self, state, change, changes, err)
    class(load_type), intent(in) :: self                !< the load
    type(motion_view_type), intent(in) :: state         !< present motion of links and coordinates
    type(motion_change_type), intent(in) :: change      !< derivative of the motion by the parameter
    type(force_sum_type), intent(inout) :: changes      !< derivatives of forces so far; those of the load are added
    type(error_type), allocatable, intent(out) :: err   !< allocated if it failed
    real(wp) :: values(6*size(changes%force, 2) + size(changes%generalized), -half_width:half_width)
    real(wp) :: trial(size(values, 1)), derivative(size(values, 1)), h, worst, best, error, second
    integer :: number, i, n
    logical :: found

    best = huge(best)
    derivative = 0.0_wp
    do number = 1, step_count
      h = trial_step(number, 1.0_wp)
      call sample(self, state, change, h, values, found, err)
      if (.not. found) cycle
      worst = 0.0_wp
      do i = 1, size(values, 1)
        call derivatives_from_stencil(values(i, :), h, trial(i), second, error)
        worst = max(worst, h*error)
      end do
      if (worst < best) then
        best = worst
        derivative = trial
      end if
      ! the error is mere round-off, which only grows as stencils get narrower
      if (worst <= 64.0_wp*epsilon(h)*maxval(abs(values))/h) exit
    end do
    if (.not. best < huge(best)) return
    if (allocated(err)) deallocate (err)
    n = size(changes%force, 2)
    changes%force = changes%force + reshape(derivative(:3*n), [3, n])
    changes%torque = changes%torque + reshape(derivative(3*n + 1:6*n), [3, n])
    changes%generalized = changes%generalized + derivative(6*n + 1:)
    changes%any_generalized = .true.
  end subroutine vary

  !> Whether add_slopes gives the derivatives of the load's power. This procedure is for kinds whose formula is not known.
  pure logical function knows_slopes(self)
    class(load_type), intent(in) :: self   !< the load

    knows_slopes = .false.
  end function knows_slopes

  !> Add the derivatives of the power that the load's forces have in a virtual motion, by the motion on which these forces depend.
  !> The virtual turn and shift of each link are held. It says in one pass what `vary` says for the changes of all parameters.
  !> Fails where the load has no value. This procedure, for kinds whose formula is not known, adds nothing.
  subroutine add_slopes(self, state, virtual, slopes, err)
    class(load_type), intent(in) :: self                !< the load
    type(motion_view_type), intent(in) :: state         !< present motion of links and coordinates
    type(motion_change_type), intent(in) :: virtual     !< turns and shifts of links, and `q` of coordinates, per unit of the motion
    type(motion_change_type), intent(inout) :: slopes   !< derivatives so far, by the changes of the same names; the load is added
    type(error_type), allocatable, intent(out) :: err   !< allocated if it failed

  end subroutine add_slopes

  !> The numbers of the load on which its forces depend smoothly, in a fixed order, without those of its law. This procedure,
  !> for kinds whose numbers are not known, gives none.
  pure subroutine unknown_numbers(self, values)
    class(load_type), intent(in) :: self              !< the load
    real(wp), allocatable, intent(out) :: values(:)   !< its numbers; not allocated where they are not known

  end subroutine unknown_numbers

  !> Take other numbers in place of those of `numbers`. This procedure, for kinds that do not give it, takes none.
  pure subroutine take_no_numbers(self, values, are_taken)
    class(load_type), intent(inout) :: self   !< the load
    real(wp), intent(in) :: values(:)         !< as of `numbers`
    logical, intent(out) :: are_taken         !< false

    are_taken = .false.
  end subroutine take_no_numbers

  !> Add the derivatives of the load's forces by a parameter on which its own numbers depend, for the present motion. This
  !> procedure is for loads without such numbers.
  subroutine vary_by_numbers(self, change, factor, state, changes, err)
    class(load_type), intent(in) :: self                !< the load
    real(wp), intent(in) :: change(:)                   !< derivatives of its numbers
    real(wp), intent(in) :: factor                      !< of its law
    type(motion_view_type), intent(in) :: state         !< present motion of links and coordinates
    type(force_sum_type), intent(inout) :: changes      !< derivatives of forces so far; those of the load are added
    type(error_type), allocatable, intent(out) :: err   !< allocated if it failed

  end subroutine vary_by_numbers

  !> The derivative of the potential energy by a parameter on which the motion depends, and perhaps the load's own numbers. This
  !> procedure is for loads without potential energy.
  pure real(wp) function unvaried_potential(self, state, change, derivatives) result(energy)
    class(load_type), intent(in) :: self             !< the load
    type(motion_view_type), intent(in) :: state      !< present motion of links and coordinates
    type(motion_change_type), intent(in) :: change   !< derivative of the motion by the parameter
    real(wp), intent(in) :: derivatives(:)           !< derivatives of its numbers and those of its law; of size 0: all are zero

    energy = 0.0_wp
  end function unvaried_potential

  !> The numbers of the load, then those of its law.
  pure subroutine constants(self, values)
    class(load_type), intent(in) :: self              !< the load
    real(wp), allocatable, intent(out) :: values(:)   !< the numbers; not allocated where some are not known
    real(wp), allocatable :: of_law(:)

    call self%numbers(values)
    if (.not. (allocated(values) .and. (allocated(self%law) .or. allocated(self%over)))) return
    if (allocated(self%law)) then
      call self%law%constants(of_law)
    else
      call self%over%constants(of_law)
    end if
    if (allocated(of_law)) then
      values = [values, of_law]
    else
      deallocate (values)
    end if
  end subroutine constants

  !> Add the derivatives of the load's forces by a parameter on which its numbers depend, for the present motion. Fails where the
  !> load has no value. This procedure is for loads without a law.
  subroutine vary_numbers(self, change, state, changes, err)
    class(load_type), intent(in) :: self                !< the load
    real(wp), intent(in) :: change(:)                   !< derivatives of its numbers
    type(motion_view_type), intent(in) :: state         !< present motion of links and coordinates
    type(force_sum_type), intent(inout) :: changes      !< derivatives of forces so far; those of the load are added
    type(error_type), allocatable, intent(out) :: err   !< allocated if it failed

    call self%vary_by_numbers(change, 1.0_wp, state, changes, err)
  end subroutine vary_numbers

  !> The sums of a load's forces at motions on both sides of the present one. `found` is false where one of them is not finite,
  !> or the load fails.
  subroutine sample(load, state, change, h, values, found, err)
    class(load_type), intent(in) :: load                       !< the load
    type(motion_view_type), intent(in) :: state                !< present motion of links and coordinates
    type(motion_change_type), intent(in) :: change             !< derivative of the motion by the parameter
    real(wp), intent(in) :: h                                  !< distance of neighbouring motions, in units of the parameter
    real(wp), intent(out) :: values(:, -half_width:)           !< (forces, torques and generalized forces; motions)
    logical, intent(out) :: found                              !< all values are finite
    type(error_type), allocatable, intent(out) :: err          !< failure of the load
    type(motion_view_type) :: other
    type(force_sum_type) :: sum
    integer :: i

    found = .false.
    sum = new_force_sum(size(state%links), size(state%q))
    do i = -half_width, half_width
      call sum%clear()
      other = change%moved(state, i*h)
      call load%apply(other, sum, err)
      if (allocated(err)) return
      values(:, i) = [sum%force, sum%torque, sum%generalized]
    end do
    found = all(ieee_is_finite(values))
  end subroutine sample

  !> Append loads to others.
  subroutine append_loads(more, loads)
    type(load_slot_type), intent(inout) :: more(:)                 !< the loads; their slots are empty afterwards
    type(load_slot_type), allocatable, intent(inout) :: loads(:)   !< the others; then all
    type(load_slot_type), allocatable :: all(:)
    integer :: i

    if (size(more) == 0) return
    allocate (all(size(loads) + size(more)))
    do i = 1, size(loads)
      call move_alloc(loads(i)%load, all(i)%load)
    end do
    do i = 1, size(more)
      call move_alloc(more(i)%load, all(size(loads) + i)%load)
    end do
    call move_alloc(all, loads)
  end subroutine append_loads
end module mech9_load
