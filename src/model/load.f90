!> A load: whatever pulls, pushes or turns, as all loads are seen from above.
module mech9_load
  use mech9_kinds, only: wp
  use mech9_error, only: error_type, place_type
  use mech9_motion_view, only: motion_view_type
  use mech9_force_sum, only: force_sum_type
  implicit none
  private
  public :: load_type, load_slot_type

  type, abstract :: load_type
    type(place_type) :: place       !< of its group in the data file
  contains
    procedure(mark_interface), deferred :: mark_links
    procedure :: mark_coordinates
    procedure :: is_idle
    procedure(apply_interface), deferred :: apply
    procedure(potential_interface), deferred :: potential
  end type load_type

  !> One of several loads of different kinds.
  type :: load_slot_type
    class(load_type), allocatable :: load
  end type load_slot_type

  abstract interface
    !> Mark the links whose motion the load asks for or on which it acts.
    pure subroutine mark_interface(self, needed)
      import :: load_type
      class(load_type), intent(in) :: self   !< the load
      logical, intent(inout) :: needed(:)      !< (N)
    end subroutine mark_interface

    !> Add what the load exerts in this state. Fails where it has no value.
    subroutine apply_interface(self, state, sum, err)
      import :: load_type, motion_view_type, force_sum_type, error_type
      class(load_type), intent(in) :: self   !< the load
      type(motion_view_type), intent(in) :: state
      type(force_sum_type), intent(inout) :: sum
      type(error_type), allocatable, intent(out) :: err   !< allocated if it failed
    end subroutine apply_interface

    !> Potential energy [J]: that of springs; zero for all loads whose work is counted as put in.
    pure real(wp) function potential_interface(self, state)
      import :: load_type, motion_view_type, wp
      class(load_type), intent(in) :: self   !< the load
      type(motion_view_type), intent(in) :: state
    end function potential_interface
  end interface

contains

  !> Mark the coordinates that the load asks for beside the motion of links: none, unless a kind says otherwise.
  pure subroutine mark_coordinates(self, needed)
    class(load_type), intent(in) :: self   !< the load
    logical, intent(inout) :: needed(:)      !< (M)
  end subroutine mark_coordinates

  !> Whether it never moves anything: it is zero, or acts on link 1 alone. Not, unless a kind says otherwise.
  pure logical function is_idle(self)
    class(load_type), intent(in) :: self   !< the load

    is_idle = .false.
  end function is_idle
end module mech9_load
