!> Loads whose forces are multiplied by a factor, which follows a law of time, or a law over a coordinate, a rate or a point.
!>
!> Each kind gives its forces for a factor that is known. What the factor changes with the motion and with the numbers of its law is
!> the same for all kinds.
module mech9_factored_load
  use mech9_kinds, only: wp
  use mech9_error, only: error_type
  use mech9_motion_view, only: motion_view_type
  use mech9_motion_change, only: motion_change_type
  use mech9_force_sum, only: force_sum_type
  use mech9_load, only: load_type
  implicit none
  private
  public :: factored_load_type

  !> A load with a factor.
  type, abstract, extends(load_type) :: factored_load_type
  contains
    procedure(mark_interface), deferred :: mark_own_links
    procedure :: mark_own_coordinates
    procedure(apply_times_interface), deferred :: apply_times
    procedure(vary_times_interface), deferred :: vary_times
    procedure(slopes_times_interface), deferred :: add_slopes_times
    procedure(power_interface), deferred :: find_power
    procedure :: mark_links
    procedure :: mark_coordinates
    procedure :: apply
    procedure :: vary
    procedure :: knows_slopes
    procedure :: add_slopes
    procedure :: vary_numbers
    procedure :: find_factor
  end type factored_load_type

  abstract interface
    !> Mark the links whose motion the load depends on or on which it acts, whatever its factor is.
    pure subroutine mark_interface(self, needed)
      import :: factored_load_type
      class(factored_load_type), intent(in) :: self   !< the load
      logical, intent(inout) :: needed(:)             !< (N) becomes true for these links; others stay
    end subroutine mark_interface

    !> Add the forces of the load, times a factor. Fails where it has no value.
    subroutine apply_times_interface(self, factor, state, sum, err)
      import :: factored_load_type, motion_view_type, force_sum_type, error_type, wp
      class(factored_load_type), intent(in) :: self       !< the load
      real(wp), intent(in) :: factor                      !< by which its forces are multiplied
      type(motion_view_type), intent(in) :: state         !< present motion of links and coordinates
      type(force_sum_type), intent(inout) :: sum          !< forces so far; the load is added
      type(error_type), allocatable, intent(out) :: err   !< allocated if it failed
    end subroutine apply_times_interface

    !> Add the derivative of the forces by a parameter on which the motion depends, with the factor held. Fails where the load
    !> has no value.
    subroutine vary_times_interface(self, factor, state, change, changes, err)
      import :: factored_load_type, motion_view_type, motion_change_type, force_sum_type, error_type, wp
      class(factored_load_type), intent(in) :: self       !< the load
      real(wp), intent(in) :: factor                      !< by which its forces are multiplied
      type(motion_view_type), intent(in) :: state         !< present motion of links and coordinates
      type(motion_change_type), intent(in) :: change      !< derivative of the motion by the parameter
      type(force_sum_type), intent(inout) :: changes      !< derivatives of forces so far; those of the load are added
      type(error_type), allocatable, intent(out) :: err   !< allocated if it failed
    end subroutine vary_times_interface

    !> Add the derivatives of the power in a virtual motion, with the factor held. Fails where the load has no value.
    subroutine slopes_times_interface(self, factor, state, virtual, slopes, err)
      import :: factored_load_type, motion_view_type, motion_change_type, error_type, wp
      class(factored_load_type), intent(in) :: self       !< the load
      real(wp), intent(in) :: factor                      !< by which its forces are multiplied
      type(motion_view_type), intent(in) :: state         !< present motion of links and coordinates
      type(motion_change_type), intent(in) :: virtual     !< turns and shifts of links, and `q` of coordinates
      type(motion_change_type), intent(inout) :: slopes   !< derivatives so far, by the changes of the same names; the load is added
      type(error_type), allocatable, intent(out) :: err   !< allocated if it failed
    end subroutine slopes_times_interface

    !> The power of the forces with the factor 1 in a virtual motion. Fails where the load has no value.
    subroutine power_interface(self, state, virtual, power, err)
      import :: factored_load_type, motion_view_type, motion_change_type, error_type, wp
      class(factored_load_type), intent(in) :: self       !< the load
      type(motion_view_type), intent(in) :: state         !< present motion of links and coordinates
      type(motion_change_type), intent(in) :: virtual     !< turns and shifts of links, and `q` of coordinates
      real(wp), intent(out) :: power                      !< per unit of the motion [J]
      type(error_type), allocatable, intent(out) :: err   !< allocated if it failed
    end subroutine power_interface
  end interface

contains

  !> Mark the coordinates that the load depends on or acts on, whatever its factor is. This procedure, for loads on links alone,
  !> marks none.
  pure subroutine mark_own_coordinates(self, needed)
    class(factored_load_type), intent(in) :: self   !< the load
    logical, intent(inout) :: needed(:)             !< (M) becomes true for these coordinates; others stay
  end subroutine mark_own_coordinates

  !> Mark the links of the load, and that on which its factor depends.
  pure subroutine mark_links(self, needed)
    class(factored_load_type), intent(in) :: self   !< the load
    logical, intent(inout) :: needed(:)             !< (N) becomes true for these links; others stay

    call self%mark_own_links(needed)
    if (allocated(self%over)) call self%over%mark_links(needed)
  end subroutine mark_links

  !> Mark the coordinates of the load, and that on which its factor depends.
  pure subroutine mark_coordinates(self, needed)
    class(factored_load_type), intent(in) :: self   !< the load
    logical, intent(inout) :: needed(:)             !< (M) becomes true for these coordinates; others stay

    call self%mark_own_coordinates(needed)
    if (allocated(self%over)) call self%over%mark_coordinates(needed)
  end subroutine mark_coordinates

  !> The factor in the present motion, 1 without a law, and its slope over its variable, 0 for a law of time. Fails where the law
  !> has no value.
  subroutine find_factor(self, state, factor, slope, err)
    class(factored_load_type), intent(in) :: self       !< the load
    type(motion_view_type), intent(in) :: state         !< present motion of links and coordinates
    real(wp), intent(out) :: factor                     !< by which its forces are multiplied
    real(wp), intent(out) :: slope                      !< derivative of the factor [1/rad, 1/m, s/rad, s/m]
    type(error_type), allocatable, intent(out) :: err   !< allocated if it failed
    real(wp) :: rate, acceleration

    factor = 1.0_wp
    slope = 0.0_wp
    if (allocated(self%law)) then
      call self%law%evaluate(state%t, factor, rate, acceleration, err)
    else if (allocated(self%over)) then
      call self%over%evaluate(state, factor, slope, err)
    end if
  end subroutine find_factor

  !> Add the forces of the load in the present motion. Fails where it has no value.
  subroutine apply(self, state, sum, err)
    class(factored_load_type), intent(in) :: self       !< the load
    type(motion_view_type), intent(in) :: state         !< present motion of links and coordinates
    type(force_sum_type), intent(inout) :: sum          !< forces so far; the load is added
    type(error_type), allocatable, intent(out) :: err   !< allocated if it failed
    real(wp) :: factor, slope

    factor = 1.0_wp
    if (allocated(self%law) .or. allocated(self%over)) call self%find_factor(state, factor, slope, err)
    if (.not. allocated(err)) call self%apply_times(factor, state, sum, err)
  end subroutine apply

  !> Add the derivative of the forces by a parameter on which the motion depends. Fails where the load has no value.
  subroutine vary(self, state, change, changes, err)
    class(factored_load_type), intent(in) :: self       !< the load
    type(motion_view_type), intent(in) :: state         !< present motion of links and coordinates
    type(motion_change_type), intent(in) :: change      !< derivative of the motion by the parameter
    type(force_sum_type), intent(inout) :: changes      !< derivatives of forces so far; those of the load are added
    type(error_type), allocatable, intent(out) :: err   !< allocated if it failed
    real(wp) :: factor, slope

    call self%find_factor(state, factor, slope, err)
    if (.not. allocated(err)) call self%vary_times(factor, state, change, changes, err)
    if (allocated(err) .or. .not. allocated(self%over)) return
    call self%apply_times(slope*self%over%variable_change(state, change), state, changes, err)
  end subroutine vary

  !> The derivatives of its power are known.
  pure logical function knows_slopes(self)
    class(factored_load_type), intent(in) :: self   !< the load

    knows_slopes = .true.
  end function knows_slopes

  !> Add the derivatives of the power in a virtual motion. Fails where the load has no value.
  subroutine add_slopes(self, state, virtual, slopes, err)
    class(factored_load_type), intent(in) :: self       !< the load
    type(motion_view_type), intent(in) :: state         !< present motion of links and coordinates
    type(motion_change_type), intent(in) :: virtual     !< the virtual motion
    type(motion_change_type), intent(inout) :: slopes   !< derivatives so far; those of the load are added
    type(error_type), allocatable, intent(out) :: err   !< allocated if it failed
    real(wp) :: factor, slope, power

    call self%find_factor(state, factor, slope, err)
    if (.not. allocated(err)) call self%add_slopes_times(factor, state, virtual, slopes, err)
    if (allocated(err) .or. .not. allocated(self%over)) return
    call self%find_power(state, virtual, power, err)
    if (.not. allocated(err)) call self%over%add_slope(state, power*slope, slopes)
  end subroutine add_slopes

  !> Add the derivatives of the forces by a parameter on which the numbers of the load or those of its law depend, for the present
  !> motion. Fails where the load has no value.
  subroutine vary_numbers(self, change, state, changes, err)
    class(factored_load_type), intent(in) :: self       !< the load
    real(wp), intent(in) :: change(:)                   !< derivatives of its numbers, then of those of its law
    type(motion_view_type), intent(in) :: state         !< present motion of links and coordinates
    type(force_sum_type), intent(inout) :: changes      !< derivatives of forces so far; those of the load are added
    type(error_type), allocatable, intent(out) :: err   !< allocated if it failed
    real(wp), allocatable :: own(:)
    real(wp) :: factor, slope, factor_change, rate, acceleration

    call self%numbers(own)
    call self%find_factor(state, factor, slope, err)
    if (.not. allocated(err)) call self%vary_by_numbers(change(:size(own)), factor, state, changes, err)
    if (allocated(err) .or. .not. any(abs(change(size(own) + 1:)) > 0.0_wp)) return
    if (allocated(self%law)) then
      call self%law%vary(change(size(own) + 1:), state%t, factor_change, rate, acceleration)
    else
      call self%over%vary(change(size(own) + 1:), state, factor_change, err)
      if (allocated(err)) return
    end if
    call self%apply_times(factor_change, state, changes, err)
  end subroutine vary_numbers
end module mech9_factored_load
