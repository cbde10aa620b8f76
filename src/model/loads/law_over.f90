!> A law over a coordinate, a rate, or a component of a point's position or velocity, in place of time.
!>
!> The law counts in the units of the data file; forces count its slopes in SI units.
module mech9_law_over
  use mech9_kinds, only: wp
  use mech9_error, only: error_type
  use mech9_rotation, only: cross
  use mech9_law, only: law_type
  use mech9_motion_view, only: motion_view_type
  use mech9_motion_change, only: motion_change_type
  implicit none
  private
  public :: law_over_type

  !> A law with its variable.
  type :: law_over_type
    class(law_type), allocatable :: law     !< over the variable in units of the data file
    logical :: is_rate = .false.            !< the variable is a rate, or a velocity
    integer :: coordinate = 0               !< number of the coordinate; 0: the variable belongs to a point
    integer :: link = 0                     !< number of the point's link
    real(wp) :: position(3) = 0.0_wp        !< the point, in the link's system [m]
    real(wp) :: direction(3) = 0.0_wp       !< axis of its component, in the axes of link 1
    real(wp) :: unit = 1.0_wp               !< one unit of the variable in rad, m, rad/s, m/s
  contains
    procedure :: evaluate
    procedure :: variable
    procedure :: variable_change
    procedure :: add_slope
    procedure :: mark_links
    procedure :: mark_coordinates
    procedure :: is_over
    procedure :: constants
    procedure :: vary
    procedure :: find_motion
    procedure :: change_of_motion
    procedure :: change_by_shift
    procedure :: own_numbers
    procedure :: follow
    procedure :: follow_point
  end type law_over_type

  !> An acceleration that is left out.
  real(wp), parameter :: none(3) = 0.0_wp

contains

  !> The law in a motion, and its slope. Fails where it has no value.
  subroutine evaluate(self, state, value, slope, err)
    class(law_over_type), intent(in) :: self            !< the law
    type(motion_view_type), intent(in) :: state         !< present motion of links and coordinates
    real(wp), intent(out) :: value                      !< the law
    real(wp), intent(out) :: slope                      !< its derivative by the variable [1/rad, 1/m, s/rad, s/m]
    type(error_type), allocatable, intent(out) :: err   !< allocated if it failed
    real(wp) :: bending

    call self%law%evaluate(self%variable(state), value, slope, bending, err)
    slope = slope/self%unit
  end subroutine evaluate

  !> The variable in a motion [unit of the data file].
  pure real(wp) function variable(self, state)
    class(law_over_type), intent(in) :: self       !< the law
    type(motion_view_type), intent(in) :: state    !< present motion of links and coordinates

    if (self%coordinate > 0) then
      if (self%is_rate) then
        variable = state%dq(self%coordinate)/self%unit
      else
        variable = state%q(self%coordinate)/self%unit
      end if
    else if (self%is_rate) then
      variable = dot_product(self%direction, state%links(self%link)%point_velocity(self%position))/self%unit
    else
      variable = dot_product(self%direction, state%links(self%link)%point_position(self%position))/self%unit
    end if
  end function variable

  !> The derivative of the variable by a parameter on which the motion depends [rad, m, rad/s, m/s].
  pure real(wp) function variable_change(self, state, change)
    class(law_over_type), intent(in) :: self         !< the law
    type(motion_view_type), intent(in) :: state      !< present motion of links and coordinates
    type(motion_change_type), intent(in) :: change   !< derivative of the motion by the parameter

    if (self%coordinate > 0) then
      if (self%is_rate) then
        variable_change = change%dq(self%coordinate)
      else
        variable_change = change%q(self%coordinate)
      end if
    else
      associate (link => state%links(self%link), of_link => change%links(self%link))
        if (self%is_rate) then
          variable_change = dot_product(self%direction, of_link%of_velocity(link, self%position))
        else
          variable_change = dot_product(self%direction, of_link%of_position(link, self%position))
        end if
      end associate
    end if
  end function variable_change

  !> Add a derivative by the variable to those by the motion.
  pure subroutine add_slope(self, state, slope, slopes)
    class(law_over_type), intent(in) :: self            !< the law
    type(motion_view_type), intent(in) :: state         !< present motion of links and coordinates
    real(wp), intent(in) :: slope                       !< derivative of any quantity by the variable, in its unit per rad, m, ...
    type(motion_change_type), intent(inout) :: slopes   !< derivatives by the motion so far; that of the variable is added

    if (self%coordinate > 0) then
      if (self%is_rate) then
        slopes%dq(self%coordinate) = slopes%dq(self%coordinate) + slope
      else
        slopes%q(self%coordinate) = slopes%q(self%coordinate) + slope
      end if
    else
      associate (link => state%links(self%link), by_link => slopes%links(self%link))
        if (self%is_rate) then
          call by_link%add_slope_of_velocity(link, self%position, slope*self%direction)
        else
          call by_link%add_slope_of_position(link, self%position, slope*self%direction)
        end if
      end associate
    end if
  end subroutine add_slope

  !> Mark the link on which the variable depends.
  pure subroutine mark_links(self, needed)
    class(law_over_type), intent(in) :: self   !< the law
    logical, intent(inout) :: needed(:)        !< (N) becomes true for the link; others stay

    if (self%link > 0) needed(self%link) = .true.
  end subroutine mark_links

  !> Mark the coordinate on which the variable depends.
  pure subroutine mark_coordinates(self, needed)
    class(law_over_type), intent(in) :: self   !< the law
    logical, intent(inout) :: needed(:)        !< (M) becomes true for the coordinate; others stay

    if (self%coordinate > 0) needed(self%coordinate) = .true.
  end subroutine mark_coordinates

  !> Whether the variable is a given coordinate, and not its rate.
  pure logical function is_over(self, coordinate)
    class(law_over_type), intent(in) :: self   !< the law
    integer, intent(in) :: coordinate          !< number of the coordinate

    is_over = self%coordinate == coordinate .and. .not. self%is_rate
  end function is_over

  !> The numbers on which the law depends smoothly, in a fixed order: the place of its point, where there is one, then its own.
  pure subroutine constants(self, values)
    class(law_over_type), intent(in) :: self          !< the law
    real(wp), allocatable, intent(out) :: values(:)   !< the numbers; not allocated where they are not known

    call self%law%constants(values)
    if (self%link > 0 .and. allocated(values)) values = [self%position, values]
  end subroutine constants

  !> The derivative of the law by a parameter on which its numbers depend, in the present motion. Fails where it has no value.
  subroutine vary(self, change, state, value, err)
    class(law_over_type), intent(in) :: self            !< the law
    real(wp), intent(in) :: change(:)                   !< (numbers) derivatives of its numbers by one parameter, as of `constants`
    type(motion_view_type), intent(in) :: state         !< present motion of links and coordinates
    real(wp), intent(out) :: value                      !< derivative of the law
    type(error_type), allocatable, intent(out) :: err   !< allocated if it failed
    real(wp) :: law, slope, rate, acceleration, shift(3)
    integer :: first

    first = self%own_numbers() + 1
    call self%law%vary(change(first:), self%variable(state), value, rate, acceleration)
    if (self%link == 0) return
    call self%evaluate(state, law, slope, err)
    if (allocated(err)) return
    associate (link => state%links(self%link))
      shift = link%fixed_components(change(1:3))
      if (self%is_rate) shift = cross(link%omega, shift)
    end associate
    value = value + slope*dot_product(self%direction, shift)
  end subroutine vary

  !> How many of the numbers stand before those of the law itself: the place of its point, where there is one.
  pure integer function own_numbers(self)
    class(law_over_type), intent(in) :: self   !< the law

    own_numbers = merge(3, 0, self%link > 0)
  end function own_numbers

  !> The variable in a motion, and its derivative in time. That of a rate or a velocity is an acceleration, and left out.
  pure subroutine find_motion(self, state, x, dx)
    class(law_over_type), intent(in) :: self       !< the law
    type(motion_view_type), intent(in) :: state    !< present motion of links and coordinates
    real(wp), intent(out) :: x                     !< the variable [unit of the data file]
    real(wp), intent(out) :: dx                    !< its derivative in time [unit of the variable/s]
    real(wp) :: unused

    if (self%link > 0) then
      associate (link => state%links(self%link))
        call self%follow_point(link%point_position(self%position), link%point_velocity(self%position), none, x, dx, unused)
      end associate
    else
      call self%follow(state%q, state%dq, [real(wp) ::], x, dx, unused)
    end if
  end subroutine find_motion

  !> The derivatives of the variable, and of its derivative in time, by a parameter on which the motion depends. That of an
  !> acceleration is left out.
  pure subroutine change_of_motion(self, state, change, x, dx)
    class(law_over_type), intent(in) :: self         !< the law
    type(motion_view_type), intent(in) :: state      !< present motion of links and coordinates
    type(motion_change_type), intent(in) :: change   !< derivative of the motion by the parameter
    real(wp), intent(out) :: x                       !< derivative of the variable [unit of the data file]
    real(wp), intent(out) :: dx                      !< derivative of its derivative in time [unit of the variable/s]
    real(wp) :: unused

    if (self%link > 0) then
      associate (link => state%links(self%link), of_link => change%links(self%link))
        call self%follow_point(of_link%of_position(link, self%position), of_link%of_velocity(link, self%position), none, x, dx, &
                               unused)
      end associate
    else
      call self%follow(change%q, change%dq, [real(wp) ::], x, dx, unused)
    end if
  end subroutine change_of_motion

  !> The derivatives of the variable, and of its derivative in time, by a parameter on which the place of its point depends: zero
  !> where it has none. That of an acceleration is left out.
  pure subroutine change_by_shift(self, state, change, x, dx)
    class(law_over_type), intent(in) :: self         !< the law
    type(motion_view_type), intent(in) :: state      !< present motion of links and coordinates
    real(wp), intent(in) :: change(:)                !< (numbers) derivatives of its numbers by one parameter, as of `constants`
    real(wp), intent(out) :: x                       !< derivative of the variable [unit of the data file]
    real(wp), intent(out) :: dx                      !< derivative of its derivative in time [unit of the variable/s]
    real(wp) :: shift(3), unused

    x = 0.0_wp
    dx = 0.0_wp
    if (self%link == 0) return
    associate (link => state%links(self%link))
      shift = link%fixed_components(change(1:3))
      call self%follow_point(shift, cross(link%omega, shift), none, x, dx, unused)
    end associate
  end subroutine change_by_shift

  !> The variable with its derivatives in time, where it belongs to a point. The second derivative of a velocity is left out.
  pure subroutine follow_point(self, position, velocity, acceleration, x, dx, ddx)
    class(law_over_type), intent(in) :: self      !< the law
    real(wp), intent(in) :: position(3)           !< of the point, in the system of link 1 [m]
    real(wp), intent(in) :: velocity(3)           !< in the axes of link 1 [m/s]
    real(wp), intent(in) :: acceleration(3)       !< in the axes of link 1; zero: it is left out [m/s^2]
    real(wp), intent(out) :: x                    !< the variable [unit of the data file]
    real(wp), intent(out) :: dx                   !< its derivative in time [unit of the variable/s]
    real(wp), intent(out) :: ddx                  !< its second derivative in time [unit of the variable/s^2]

    ddx = 0.0_wp
    if (self%is_rate) then
      x = dot_product(self%direction, velocity)/self%unit
      dx = dot_product(self%direction, acceleration)/self%unit
    else
      x = dot_product(self%direction, position)/self%unit
      dx = dot_product(self%direction, velocity)/self%unit
      ddx = dot_product(self%direction, acceleration)/self%unit
    end if
  end subroutine follow_point

  !> The variable with its derivatives in time, where it is a coordinate or a rate. The second derivative of a rate is left out.
  pure subroutine follow(self, q, dq, ddq, x, dx, ddx)
    class(law_over_type), intent(in) :: self   !< the law
    real(wp), intent(in) :: q(:)               !< (M) coordinates [rad, m]
    real(wp), intent(in) :: dq(:)              !< (M) their rates
    real(wp), intent(in) :: ddq(:)             !< (M) their accelerations; of size 0: they are left out, and count as zero
    real(wp), intent(out) :: x                 !< the variable [unit of the data file]
    real(wp), intent(out) :: dx                !< its derivative in time [unit of the variable/s]
    real(wp), intent(out) :: ddx               !< its second derivative in time [unit of the variable/s^2]
    real(wp) :: acceleration

    acceleration = 0.0_wp
    if (size(ddq) > 0) acceleration = ddq(self%coordinate)/self%unit
    ddx = 0.0_wp
    if (self%is_rate) then
      x = dq(self%coordinate)/self%unit
      dx = acceleration
    else
      x = q(self%coordinate)/self%unit
      dx = dq(self%coordinate)/self%unit
      ddx = acceleration
    end if
  end subroutine follow
end module mech9_law_over
