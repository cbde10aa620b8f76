!> A spring and damper between points of two links.
module mech9_spring_load
  use mech9_kinds, only: wp
  use mech9_error, only: error_type, raise, exit_integrator
  use mech9_rotation, only: cross
  use mech9_motion_view, only: motion_view_type
  use mech9_motion_change, only: motion_change_type
  use mech9_force_sum, only: force_sum_type
  use mech9_factored_load, only: factored_load_type
  implicit none
  private
  public :: spring_load_type

  !> A spring that pulls its ends together with stiffness (length - free length) + damping d(length)/dt.
  type, extends(factored_load_type) :: spring_load_type
    integer :: links(2) = 0                !< numbers of the links of its ends
    real(wp) :: positions(3, 2) = 0.0_wp   !< of its ends, each in its link's system [m]
    real(wp) :: stiffness = 0.0_wp         !< [N/m]
    real(wp) :: free_length = 0.0_wp       !< [m]
    real(wp) :: damping = 0.0_wp           !< [N s/m]
  contains
    procedure :: mark_own_links
    procedure :: is_idle
    procedure :: apply_times
    procedure :: potential
    procedure :: vary_times
    procedure :: add_slopes_times
    procedure :: find_power
    procedure :: numbers
    procedure :: take_numbers
    procedure :: vary_by_numbers
    procedure :: varied_potential
    procedure, private, non_overridable :: span
    procedure, private, non_overridable :: span_rate
    procedure, private, non_overridable :: pull
  end type spring_load_type

contains

  !> Whether stiffness and damping are zero.
  pure logical function is_idle(self)
    class(spring_load_type), intent(in) :: self   !< the spring load

    is_idle = .not. (abs(self%stiffness) > 0.0_wp .or. abs(self%damping) > 0.0_wp)
  end function is_idle

  !> Mark the links of its ends.
  pure subroutine mark_own_links(self, needed)
    class(spring_load_type), intent(in) :: self   !< the spring load
    logical, intent(inout) :: needed(:)           !< (N) becomes true for the two links

    needed(self%links) = .true.
  end subroutine mark_own_links

  !> Vector from the first end to the second, fixed axes [m].
  pure function span(self, state)
    class(spring_load_type), intent(in) :: self   !< the spring load
    type(motion_view_type), intent(in) :: state   !< present motion of links and coordinates
    real(wp) :: span(3)

    span = state%links(self%links(2))%point_position(self%positions(:, 2)) &
           - state%links(self%links(1))%point_position(self%positions(:, 1))
  end function span

  !> Rate of this vector, fixed axes [m/s].
  pure function span_rate(self, state)
    class(spring_load_type), intent(in) :: self   !< the spring load
    type(motion_view_type), intent(in) :: state   !< present motion of links and coordinates
    real(wp) :: span_rate(3)

    span_rate = state%links(self%links(2))%point_velocity(self%positions(:, 2)) &
                - state%links(self%links(1))%point_velocity(self%positions(:, 1))
  end function span_rate

  !> The force on the first end, fixed axes [N]. Fails for a spring with a free length whose ends meet.
  subroutine pull(self, d, rate, force, err)
    class(spring_load_type), intent(in) :: self         !< the spring load
    real(wp), intent(in) :: d(3)                        !< from the first end to the second, fixed axes [m]
    real(wp), intent(in) :: rate(3)                     !< rate of this vector [m/s]
    real(wp), intent(out) :: force(3)                   !< fixed axes [N]
    type(error_type), allocatable, intent(out) :: err   !< allocated if it failed
    real(wp) :: length

    length = norm2(d)
    force = 0.0_wp
    if (length > 0.0_wp) then
      force = (self%stiffness*(length - self%free_length) + self%damping*dot_product(d, rate)/length)/length*d
    else if (abs(self%free_length) > 0.0_wp) then
      call raise(err, exit_integrator, 'a spring with a free length has shrunk to nothing, where its direction is '// &
                 'not defined', self%place)
    else
      force = self%damping*rate
    end if
  end subroutine pull

  !> Add the pull at both ends. Fails for a spring with a free length whose ends meet.
  subroutine apply_times(self, factor, state, sum, err)
    real(wp), intent(in) :: factor                      !< by which its forces are multiplied
    class(spring_load_type), intent(in) :: self         !< the spring load
    type(motion_view_type), intent(in) :: state         !< present motion of links and coordinates
    type(force_sum_type), intent(inout) :: sum          !< forces so far; the load is added
    type(error_type), allocatable, intent(out) :: err   !< allocated if it failed
    real(wp) :: d(3), rate(3), force(3)

    d = self%span(state)
    rate = 0.0_wp
    if (abs(self%damping) > 0.0_wp) rate = self%span_rate(state)
    call self%pull(d, rate, force, err)
    if (allocated(err)) return
    force = factor*force
    call sum%add_force(state, self%links(1), self%positions(:, 1), force)
    call sum%add_force(state, self%links(2), self%positions(:, 2), -force)
  end subroutine apply_times

  !> Add the derivative of the pull at both ends by a parameter. Fails for a spring with a free length whose ends meet.
  subroutine vary_times(self, factor, state, change, changes, err)
    real(wp), intent(in) :: factor                      !< by which its forces are multiplied
    class(spring_load_type), intent(in) :: self         !< the spring load
    type(motion_view_type), intent(in) :: state         !< present motion of links and coordinates
    type(motion_change_type), intent(in) :: change      !< derivative of the motion by the parameter
    type(force_sum_type), intent(inout) :: changes      !< derivatives of forces so far; those of the load are added
    type(error_type), allocatable, intent(out) :: err   !< allocated if it failed
    real(wp) :: d(3), rate(3), d_change(3), rate_change(3), force(3), force_change(3)

    d = self%span(state)
    rate = self%span_rate(state)
    call self%pull(d, rate, force, err)
    if (allocated(err)) return
    force = factor*force
    associate (i => self%links(1), k => self%links(2), at => self%positions)
      d_change = change%links(k)%of_position(state%links(k), at(:, 2)) - change%links(i)%of_position(state%links(i), at(:, 1))
      rate_change = change%links(k)%of_velocity(state%links(k), at(:, 2)) &
                    - change%links(i)%of_velocity(state%links(i), at(:, 1))
      force_change = factor*change_of_pull(self, d, rate, d_change, rate_change)
      call change%add_force(state, i, at(:, 1), force, force_change, changes)
      call change%add_force(state, k, at(:, 2), -force, -force_change, changes)
    end associate
  end subroutine vary_times

  !> Derivative of the pull. At length zero, a spring without free length has its stiffness in all directions, and its damper
  !> acts in all of them.
  pure function change_of_pull(spring, d, rate, d_change, rate_change) result(change)
    type(spring_load_type), intent(in) :: spring   !< the spring load
    real(wp), intent(in) :: d(3)                   !< from the first end to the second [m]
    real(wp), intent(in) :: rate(3)                !< rate of this vector [m/s]
    real(wp), intent(in) :: d_change(3)            !< derivative of the vector
    real(wp), intent(in) :: rate_change(3)         !< derivative of its rate
    real(wp) :: change(3), e(3), e_change(3), length, length_change, length_rate, tension

    length = norm2(d)
    if (.not. length > 0.0_wp) then
      change = spring%stiffness*d_change + spring%damping*rate_change
      return
    end if
    e = d/length
    length_change = dot_product(e, d_change)
    e_change = (d_change - length_change*e)/length
    length_rate = dot_product(e, rate)
    tension = spring%stiffness*(length - spring%free_length) + spring%damping*length_rate
    change = (spring%stiffness*length_change + spring%damping*(dot_product(e_change, rate) + dot_product(e, rate_change)))*e &
             + tension*e_change
  end function change_of_pull

  !> Add the derivatives of the power in a virtual motion, the pull times the approach of the ends. Fails for a spring with a free
  !> length whose ends meet.
  subroutine add_slopes_times(self, factor, state, virtual, slopes, err)
    real(wp), intent(in) :: factor                      !< by which its forces are multiplied
    class(spring_load_type), intent(in) :: self         !< the spring load
    type(motion_view_type), intent(in) :: state         !< present motion of links and coordinates
    type(motion_change_type), intent(in) :: virtual     !< the virtual motion
    type(motion_change_type), intent(inout) :: slopes   !< derivatives so far; those of the load are added
    type(error_type), allocatable, intent(out) :: err   !< allocated if it failed
    real(wp) :: d(3), rate(3), force(3), approach(3), by_span(3), by_rate(3), sign
    integer :: e

    d = self%span(state)
    rate = 0.0_wp
    if (abs(self%damping) > 0.0_wp) rate = self%span_rate(state)
    call self%pull(d, rate, force, err)
    if (allocated(err)) return
    associate (i => self%links(1), j => self%links(2), at => self%positions)
      approach = virtual%links(i)%of_position(state%links(i), at(:, 1)) - virtual%links(j)%of_position(state%links(j), at(:, 2))
    end associate
    call slopes_of_pull(self, d, rate, factor*approach, by_span, by_rate)
    force = factor*force
    do e = 1, 2
      sign = merge(-1.0_wp, 1.0_wp, e == 1)
      associate (k => self%links(e), at => self%positions(:, e))
        call slopes%links(k)%add_slope_of_position(state%links(k), at, sign*by_span)
        if (abs(self%damping) > 0.0_wp) call slopes%links(k)%add_slope_of_velocity(state%links(k), at, sign*by_rate)
        call slopes%links(k)%add_slope_of_arm(state%links(k), at, cross(virtual%links(k)%turn, sign*force))
      end associate
    end do
  end subroutine add_slopes_times

  !> The power in a virtual motion: the pull times the approach of the ends. Fails for a spring with a free length whose ends meet.
  subroutine find_power(self, state, virtual, power, err)
    class(spring_load_type), intent(in) :: self         !< the spring load
    type(motion_view_type), intent(in) :: state         !< present motion of links and coordinates
    type(motion_change_type), intent(in) :: virtual     !< the virtual motion
    real(wp), intent(out) :: power                      !< per unit of the motion [J]
    type(error_type), allocatable, intent(out) :: err   !< allocated if it failed
    real(wp) :: force(3)

    power = 0.0_wp
    call self%pull(self%span(state), self%span_rate(state), force, err)
    if (allocated(err)) return
    associate (i => self%links(1), j => self%links(2), at => self%positions)
      power = dot_product(force, virtual%links(i)%of_position(state%links(i), at(:, 1)) &
                          - virtual%links(j)%of_position(state%links(j), at(:, 2)))
    end associate
  end subroutine find_power

  !> Derivatives of the product of the pull with a vector, by the span and by its rate: change_of_pull transposed.
  pure subroutine slopes_of_pull(spring, d, rate, vector, by_span, by_rate)
    type(spring_load_type), intent(in) :: spring   !< the spring load
    real(wp), intent(in) :: d(3)                   !< from the first end to the second [m]
    real(wp), intent(in) :: rate(3)                !< rate of this vector [m/s]
    real(wp), intent(in) :: vector(3)              !< the vector
    real(wp), intent(out) :: by_span(3)            !< derivatives by d
    real(wp), intent(out) :: by_rate(3)            !< derivatives by its rate
    real(wp) :: e(3), length, along, length_rate, tension

    length = norm2(d)
    if (.not. length > 0.0_wp) then
      by_span = spring%stiffness*vector
      by_rate = spring%damping*vector
      return
    end if
    e = d/length
    along = dot_product(e, vector)
    length_rate = dot_product(e, rate)
    tension = spring%stiffness*(length - spring%free_length) + spring%damping*length_rate
    by_span = spring%stiffness*along*e + (spring%damping*along*(rate - length_rate*e) + tension*(vector - along*e))/length
    by_rate = spring%damping*along*e
  end subroutine slopes_of_pull

  !> The points of both ends, stiffness, free length and damping.
  pure subroutine numbers(self, values)
    class(spring_load_type), intent(in) :: self       !< the spring load
    real(wp), allocatable, intent(out) :: values(:)   !< (9) the numbers

    values = [self%positions(:, 1), self%positions(:, 2), self%stiffness, self%free_length, self%damping]
  end subroutine numbers

  !> Take other numbers.
  pure subroutine take_numbers(self, values, are_taken)
    class(spring_load_type), intent(inout) :: self   !< the spring load
    real(wp), intent(in) :: values(:)       !< (9) as of `numbers`
    logical, intent(out) :: are_taken       !< true

    self%positions(:, 1) = values(1:3)
    self%positions(:, 2) = values(4:6)
    self%stiffness = values(7)
    self%free_length = values(8)
    self%damping = values(9)
    are_taken = .true.
  end subroutine take_numbers

  !> Add the derivatives of the pull by a parameter on which the ends and the numbers of the spring depend. Fails for a spring with
  !> a free length whose ends meet.
  subroutine vary_by_numbers(self, change, factor, state, changes, err)
    class(spring_load_type), intent(in) :: self         !< the spring load
    real(wp), intent(in) :: change(:)                   !< (9) derivatives of the numbers
    real(wp), intent(in) :: factor                      !< of its law
    type(motion_view_type), intent(in) :: state         !< present motion of links and coordinates
    type(force_sum_type), intent(inout) :: changes      !< derivatives of forces so far; those of the load are added
    type(error_type), allocatable, intent(out) :: err   !< allocated if it failed
    type(spring_load_type) :: of_numbers
    real(wp) :: d(3), rate(3), shifts(3, 2), d_change(3), rate_change(3), force(3), force_change(3)
    integer :: i

    d = self%span(state)
    rate = self%span_rate(state)
    call self%pull(d, rate, force, err)
    if (allocated(err)) return
    do i = 1, 2
      shifts(:, i) = state%links(self%links(i))%fixed_components(change(3*i - 2:3*i))
    end do
    d_change = shifts(:, 2) - shifts(:, 1)
    rate_change = cross(state%links(self%links(2))%omega, shifts(:, 2)) - cross(state%links(self%links(1))%omega, shifts(:, 1))
    force_change = change_of_pull(self, d, rate, d_change, rate_change)
    ! the pull is linear in stiffness and damping; without a free length it has no direction of its own
    of_numbers%stiffness = change(7)
    of_numbers%damping = change(9)
    of_numbers%free_length = self%free_length
    if (norm2(d) > 0.0_wp) then
      force_change = force_change + pull_of(of_numbers, d, rate) - self%stiffness*change(8)/norm2(d)*d
    else
      force_change = force_change + change(9)*rate
    end if
    do i = 1, 2
      call changes%add_force(state, self%links(i), self%positions(:, i), factor*force_change)
      call changes%add_torque(self%links(i), cross(shifts(:, i), factor*force))
      force_change = -force_change
      force = -force
    end do
  end subroutine vary_by_numbers

  !> The pull of a spring whose ends do not meet.
  pure function pull_of(spring, d, rate) result(force)
    type(spring_load_type), intent(in) :: spring   !< the spring load
    real(wp), intent(in) :: d(3)                   !< from the first end to the second, fixed axes [m]
    real(wp), intent(in) :: rate(3)                !< rate of this vector [m/s]
    real(wp) :: force(3), length

    length = norm2(d)
    force = (spring%stiffness*(length - spring%free_length) + spring%damping*dot_product(d, rate)/length)/length*d
  end function pull_of

  !> The derivative of the energy by a parameter.
  pure real(wp) function varied_potential(self, state, change, derivatives) result(energy)
    class(spring_load_type), intent(in) :: self      !< the spring load
    type(motion_view_type), intent(in) :: state      !< present motion of links and coordinates
    type(motion_change_type), intent(in) :: change   !< derivative of the motion by the parameter
    real(wp), intent(in) :: derivatives(:)           !< derivatives of its numbers and those of its law; of size 0: all are zero
    real(wp) :: d(3), d_change(3), length, stretch, stretch_change

    energy = 0.0_wp
    if (allocated(self%law) .or. allocated(self%over)) return
    d = self%span(state)
    associate (i => self%links(1), k => self%links(2), at => self%positions)
      d_change = change%links(k)%of_position(state%links(k), at(:, 2)) - change%links(i)%of_position(state%links(i), at(:, 1))
      if (size(derivatives) > 0) d_change = d_change + state%links(k)%fixed_components(derivatives(4:6)) &
                                            - state%links(i)%fixed_components(derivatives(1:3))
    end associate
    length = norm2(d)
    stretch = length - self%free_length
    stretch_change = 0.0_wp
    if (length > 0.0_wp) stretch_change = dot_product(d, d_change)/length
    if (size(derivatives) > 0) then
      stretch_change = stretch_change - derivatives(8)
      energy = 0.5_wp*derivatives(7)*stretch**2
    end if
    energy = energy + self%stiffness*stretch*stretch_change
  end function varied_potential

  !> Energy of the spring [J]; the work of one that follows a law counts as put in.
  pure real(wp) function potential(self, state)
    class(spring_load_type), intent(in) :: self   !< the spring load
    type(motion_view_type), intent(in) :: state   !< present motion of links and coordinates

    potential = 0.0_wp
    if (allocated(self%law) .or. allocated(self%over)) return
    potential = 0.5_wp*self%stiffness*(norm2(self%span(state)) - self%free_length)**2
  end function potential
end module mech9_spring_load
