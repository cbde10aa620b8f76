!> A load pulls, pushes or turns links or coordinates; all kinds of loads have this interface.
module mech9_load
  use mech9_kinds, only: wp
  use mech9_error, only: error_type, place_type
  use mech9_motion_view, only: motion_view_type
  use mech9_force_sum, only: force_sum_type
  implicit none
  private
  public :: load_type, load_slot_type

  !> A load of any kind.
  type, abstract :: load_type
    type(place_type) :: place       !< place of its group in the data file
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

    !> Potential energy [J]: the energy of springs; zero for all loads whose work counts as put in.
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
  !> not tell, answers that it may.
  pure logical function is_idle(self)
    class(load_type), intent(in) :: self   !< the load

    is_idle = .false.
  end function is_idle
end module mech9_load
