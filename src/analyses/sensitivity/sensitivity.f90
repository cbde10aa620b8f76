!> Derivatives of a motion by parameters of the mechanism: of coordinates, rates, accelerations, and of points.
!>
!> A parameter that changes by dp moves each frame by a twist; the twist of a frame is the sum of those of the steps that lead to
!> it, of their coordinates and of their constants alike. A closed chain stays closed if the twist of its closing frame is that of
!> its target, in all orders of derivatives in time. The unknown derivatives of dependent coordinates follow from the factors of
!> the block, with one right-hand side for each parameter.
module mech9_sensitivity
  use mech9_kinds, only: wp
  use mech9_tolerances, only: singular_conditioning, opened_by_parameter, inexact_dimensions
  use mech9_error, only: error_type, raise, exit_data, exit_singular
  use mech9_failure, only: failure_singular_sensitivity, failure_opening_parameter
  use mech9_model, only: model_type
  use mech9_variable_model, only: variable_model_type
  use mech9_rotation, only: turn, cross
  use mech9_plan, only: plan_type, block_type, new_state
  use mech9_state, only: state_type
  use mech9_arithmetics, only: set_in_space
  use mech9_frame_motion, only: place_all, spread_all_velocities, spread_all_accelerations
  use mech9_block_solver, only: block_work_type, new_block_work, factorize_block
  use mech9_coupling_constraint, only: varied_coupling
  use mech9_frame_variation, only: third_derivatives_type, new_third_derivatives, find_third_derivatives
  use mech9_twists, only: frame_twists_type, new_frame_twists, find_frame_twists, carried, shift_at
  use mech9_tangent, only: tangent_type, find_tangent
  implicit none
  private
  public :: sensitivity_type, new_sensitivity, find_sensitivities, find_twists_of_frame

  !> The derivatives of a motion by all parameters, and what finds them. Each parameter counts in its unit in the data file.
  type :: sensitivity_type
    integer :: n_parameters = 0
    integer :: highest = 2                          !< order of the highest derivative in time that is found
    real(wp), allocatable :: q(:, :, :)             !< (P,0:2,M) of the coordinates and their derivatives in time [rad, m]
    real(wp), allocatable :: points(:, :, :, :)     !< (P,3,0:2,points) of the points of the mechanism [m]
    type(tangent_type), allocatable, private :: tangents(:)    !< (P) of the constants
    type(plan_type), private :: plan                           !< in space
    type(state_type), private :: state                         !< the motion, in space
    type(frame_twists_type), private :: motion                 !< twists of this motion
    type(third_derivatives_type), private :: third             !< of pairs without a fixed axis
    type(block_work_type), allocatable, private :: blocks(:)   !< scratch of the blocks
    real(wp), allocatable, private :: frames(:, :, :, :)       !< (6,P,0:2,0:M) twists of the frames by the parameters
  end type sensitivity_type

  !> Binomial coefficients of derivatives of a product: (part, order).
  integer, parameter :: binomial(0:2, 0:2) = reshape([1, 0, 0, 1, 1, 0, 1, 2, 1], [3, 3])

contains

  !> Prepare the derivatives by all parameters of a model. Fails where the model does not exist beside the present values, and where
  !> a parameter sets numbers whose derivatives are not known.
  subroutine new_sensitivity(variable, model, plan, highest, sensitivity, err)
    class(variable_model_type), intent(inout) :: variable   !< the model as a function of its parameters
    type(model_type), intent(in) :: model                   !< the present model
    type(plan_type), intent(in) :: plan                     !< its plan
    integer, intent(in) :: highest                          !< order of the highest derivative in time
    type(sensitivity_type), intent(out) :: sensitivity      !< prepared
    type(error_type), allocatable, intent(out) :: err       !< allocated if it failed
    integer :: i, b, n, m

    n = size(model%parameters)
    m = plan%n_coordinates
    sensitivity%n_parameters = n
    sensitivity%highest = highest
    allocate (sensitivity%tangents(n))
    do i = 1, n
      call find_tangent(variable, model, plan, i, sensitivity%tangents(i), err)
      if (allocated(err)) return
    end do
    sensitivity%plan = plan
    sensitivity%plan%blocks%arithmetic = 1
    sensitivity%plan%blocks%is_shown = .false.
    call set_in_space(sensitivity%plan)
    sensitivity%state = new_state(sensitivity%plan)
    sensitivity%motion = new_frame_twists(m)
    sensitivity%third = new_third_derivatives(plan)
    allocate (sensitivity%blocks(size(plan%blocks)))
    do b = 1, size(plan%blocks)
      sensitivity%blocks(b) = new_block_work(sensitivity%plan%blocks(b))
    end do
    allocate (sensitivity%q(n, 0:2, m), sensitivity%frames(6, n, 0:2, 0:m), &
              sensitivity%points(n, 3, 0:2, size(model%mechanism%points)), source=0.0_wp)
  end subroutine new_sensitivity

  !> Find the derivatives of the present motion. Fails with exit_singular where closed chains are in a singular position, and with
  !> exit_data where a change of a parameter would open a closed chain.
  subroutine find_sensitivities(model, present, self, err)
    type(model_type), intent(in) :: model                 !< the present model
    type(state_type), intent(in) :: present               !< coordinates with as many derivatives in time as are asked for
    type(sensitivity_type), intent(inout) :: self         !< gets the derivatives
    type(error_type), allocatable, intent(out) :: err     !< allocated if it failed
    integer :: b, order, i

    call place_motion(present, self, err)
    if (allocated(err)) return
    do b = 1, size(self%plan%blocks)
      associate (block => self%plan%blocks(b), work => self%blocks(b))
        call find_frame_twists(self%plan, self%state, self%third, block%first_step, block%last_step, self%motion)
        if (block%equations == 0) cycle
        call factorize_block(self%plan, block, self%state, work)
        if (work%equations%conditioning() >= singular_conditioning) cycle
        call fail_with(failure_singular_sensitivity, exit_singular, block, self%state%t, err)
        return
      end associate
    end do
    self%q = 0.0_wp
    call vary_drives(model, self)
    do order = 0, self%highest
      do b = 1, size(self%plan%blocks)
        call vary_block(model, order, b, self, err)
        if (allocated(err)) return
      end do
    end do
    do i = 1, size(model%mechanism%points)
      call vary_point(model, i, self)
    end do
  end subroutine find_sensitivities

  !> The twists of a frame by all parameters, after `find_sensitivities`: rotation, then shift of the point that coincides with the
  !> origin of frame 0, in its axes, with the derivatives of these numbers in time. A link moves with its first frame and, in
  !> addition, with the constant twist of its own system in that frame.
  subroutine find_twists_of_frame(self, frame, twists)
    type(sensitivity_type), intent(in) :: self   !< with the derivatives of the present motion
    integer, intent(in) :: frame                 !< number of the frame
    real(wp), intent(out) :: twists(:, :, 0:)    !< (P,6,0:2) up to the order `highest` [rad, m per unit of the parameter]
    integer :: p, order

    do order = 0, self%highest
      do p = 1, self%n_parameters
        twists(p, :, order) = self%frames(:, p, order, frame)
      end do
    end do
  end subroutine find_twists_of_frame

  !> Place the frames of the present motion in space.
  subroutine place_motion(present, self, err)
    type(state_type), intent(in) :: present               !< the present motion
    type(sensitivity_type), intent(inout) :: self         !< gets its frames
    type(error_type), allocatable, intent(out) :: err     !< allocated if a pair has no pose

    self%state%t = present%t
    self%state%q = present%q
    if (self%highest > 0) self%state%dq = present%dq
    if (self%highest > 1) self%state%ddq = present%ddq
    call place_all(self%plan, self%state, err)
    if (allocated(err)) return
    call spread_all_velocities(self%plan, self%state)
    call spread_all_accelerations(self%plan, self%state)
    call find_third_derivatives(self%plan, self%state, self%third, err)
  end subroutine place_motion

  !> Fail because of the chains of a block.
  pure subroutine fail_with(kind, code, block, t, err)
    integer, intent(in) :: kind                           !< of the failure
    integer, intent(in) :: code                           !< exit code
    type(block_type), intent(in) :: block                 !< the block
    real(wp), intent(in) :: t                             !< time [s]
    type(error_type), allocatable, intent(out) :: err     !< the failure

    call raise(err, code, kind)
    err%failure%chains = block%chains
    err%failure%coordinates = block%coordinates
    err%failure%t = t
  end subroutine fail_with

  !> The derivatives of the driven coordinates, which their laws give.
  subroutine vary_drives(model, self)
    type(model_type), intent(in) :: model           !< the present model
    type(sensitivity_type), intent(inout) :: self   !< gets the derivatives
    real(wp) :: change(0:2)
    integer :: i, p

    do p = 1, self%n_parameters
      do i = 1, size(model%problem%drives)
        associate (part => self%tangents(p)%drives(i), drive => model%problem%drives(i)%drive)
          if (.not. part%varies) cycle
          call drive%vary(part%change, self%state%t, change(0), change(1), change(2))
          self%q(p, :, drive%coordinate) = change
        end associate
      end do
    end do
  end subroutine vary_drives

  !> The derivatives of one order in time of one block: first those that its unknowns do not give, then the unknowns that keep the
  !> chains closed.
  subroutine vary_block(model, order, b, self, err)
    type(model_type), intent(in) :: model                 !< the present model
    integer, intent(in) :: order                          !< of the derivative in time
    integer, intent(in) :: b                              !< number of the block
    type(sensitivity_type), intent(inout) :: self         !< with lower orders, and earlier blocks; gets the block
    type(error_type), allocatable, intent(out) :: err     !< allocated if it failed
    real(wp) :: openings(self%plan%blocks(b)%equations, self%n_parameters)
    integer :: p, i

    associate (block => self%plan%blocks(b), work => self%blocks(b))
      call vary_frames(order, block%first_step, block%last_step, self)
      if (size(block%unknowns) == 0) return
      call find_openings(model, order, block, self, openings)
      do p = 1, self%n_parameters
        work%right = -openings(:, p)
        call work%equations%solve(work%right, work%change)
        do i = 1, size(block%unknowns)
          self%q(p, order, block%coordinates(i)) = work%change(i)*self%plan%unit_of(block%coordinates(i))
        end do
      end do
      call vary_frames(order, block%first_step, block%last_step, self)
      if (order == 0) call check_closed(model, block, self, err)
    end associate
  end subroutine vary_block

  !> The twists of some frames, in one order of derivatives in time.
  subroutine vary_frames(order, first, last, self)
    integer, intent(in) :: order                    !< of the derivative in time
    integer, intent(in) :: first                    !< frames from this one
    integer, intent(in) :: last                     !< last one of these
    type(sensitivity_type), intent(inout) :: self   !< with the coordinates; gets the frames
    real(wp) :: amount
    integer :: s, j, p

    do s = first, last
      associate (step => self%plan%steps(s), frames => self%frames)
        frames(:, :, order, s) = frames(:, :, order, step%parent)
        do j = 0, order
          do p = 1, self%n_parameters
            amount = self%q(p, j, step%coordinate)
            if (j == 0) amount = amount + self%tangents(p)%offset(step%coordinate)
            frames(:, p, order, s) = frames(:, p, order, s) + binomial(j, order)*amount*self%motion%step(:, order - j, s)
          end do
        end do
        do p = 1, self%n_parameters
          call add_constants(self%tangents(p), self%plan, self%state, self%motion, s, order, frames(:, p, order, s))
        end do
      end associate
    end do
  end subroutine vary_frames

  !> Add the twist that the constants of a step give to its frame.
  pure subroutine add_constants(tangent, plan, state, motion, s, order, twist)
    type(tangent_type), intent(in) :: tangent       !< derivatives of the constants
    type(plan_type), intent(in) :: plan             !< the plan of the mechanism, in space
    type(state_type), intent(in) :: state           !< the motion
    type(frame_twists_type), intent(in) :: motion   !< its twists
    integer, intent(in) :: s                        !< the step
    integer, intent(in) :: order                    !< of the derivative in time
    real(wp), intent(inout) :: twist(6)             !< of the frame
    real(wp) :: series(6, 0:2), length(0:2), along(6)
    integer :: k, j

    k = plan%steps(s)%coordinate
    if (tangent%moves(k)) then
      series = carried(state, motion, plan%steps(s)%parent, tangent%before(:, k))
      twist = twist + series(:, order)
    end if
    if (.not. abs(tangent%slide(k)) > 0.0_wp) return
    along(1:3) = 0.0_wp
    along(4:6) = plan%steps(s)%before%r(:, 3)
    series = carried(state, motion, plan%steps(s)%parent, along)
    length = tangent%slide(k)*[state%q(k) + plan%steps(s)%offset, state%dq(k), state%ddq(k)]
    do j = 0, order
      twist = twist + binomial(j, order)*length(j)*series(:, order - j)
    end do
  end subroutine add_constants

  !> The twists by which the closed chains of a block open, as values of its equations.
  subroutine find_openings(model, order, block, self, openings)
    type(model_type), intent(in) :: model           !< the present model
    integer, intent(in) :: order                    !< of the derivative in time
    type(block_type), intent(in) :: block           !< the block
    type(sensitivity_type), intent(in) :: self      !< with the frames
    real(wp), intent(out) :: openings(:, :)         !< (equations,P) [rad, lengths of the mechanism]
    real(wp) :: opening(6), shift(3)
    integer :: c, p, row

    do p = 1, self%n_parameters
      row = 0
      do c = block%first_closure, block%last_closure
        associate (constraint => self%plan%constraints(c)%item, closing => self%plan%closures(c)%closing)
          if (self%plan%closures(c)%coupling > 0) then
            openings(row + 1, p) = coupling_opening(model, order, c, p, self)
          else
            call find_opening(order, c, p, self, opening)
            shift = shift_at(opening, self%state%p(:, closing))
            call constraint%opening(self%plan, self%state, opening(1:3), shift, openings(row + 1:row + constraint%equations, p))
          end if
          row = row + constraint%equations
        end associate
      end do
    end do
  end subroutine find_openings

  !> The twist of a closing frame relative to its target, by one parameter.
  pure subroutine find_opening(order, c, p, self, opening)
    integer, intent(in) :: order                    !< of the derivative in time
    integer, intent(in) :: c                        !< number of the closure
    integer, intent(in) :: p                        !< number of the parameter
    type(sensitivity_type), intent(in) :: self      !< with the frames
    real(wp), intent(out) :: opening(6)             !< the twist [rad, m]
    real(wp) :: series(6, 0:2)
    integer :: k

    associate (closure => self%plan%closures(c))
      k = self%plan%steps(closure%closing)%coordinate
      opening = self%frames(:, p, order, closure%closing) - self%frames(:, p, order, closure%target)
      if (.not. any(abs(self%tangents(p)%in_target(:, k)) > 0.0_wp)) return
      series = carried(self%state, self%motion, closure%target, self%tangents(p)%in_target(:, k))
      opening = opening - series(:, order)
    end associate
  end subroutine find_opening

  !> The size of a twist.
  pure real(wp) function size_of(twist, length)
    real(wp), intent(in) :: twist(6)   !< rotation [rad], and shift at the origin of frame 0 [m]
    real(wp), intent(in) :: length     !< the mechanism's size [m]

    size_of = max(maxval(abs(twist(1:3))), maxval(abs(twist(4:6)))/length)
  end function size_of

  !> The derivative of a coupling's equation by one parameter, or of its derivatives in time.
  real(wp) function coupling_opening(model, order, c, p, self) result(opening)
    type(model_type), intent(in) :: model           !< the present model
    integer, intent(in) :: order                    !< of the derivative in time
    integer, intent(in) :: c                        !< number of the closure that is the coupling
    integer, intent(in) :: p                        !< number of the parameter
    type(sensitivity_type), intent(in) :: self      !< with the coordinates
    real(wp) :: own
    integer :: i, k

    opening = varied_coupling(self%plan, c, self%state, self%third%couplings(self%plan%closures(c)%coupling), order, &
                              self%q(p, 0, :), self%q(p, 1, :), self%q(p, 2, :))
    associate (part => self%tangents(p)%couplings(self%plan%closures(c)%coupling), state => self%state, &
               coupling => model%mechanism%couplings(self%plan%closures(c)%coupling)%coupling)
      if (.not. part%varies) return
      own = 0.0_wp
      do i = 1, size(coupling%coordinates)
        k = coupling%coordinates(i)
        select case (order)
        case (0)
          own = own + coupling%varied_term(part%change, i, state%q(k), 0)
        case (1)
          own = own + coupling%varied_term(part%change, i, state%q(k), 1)*state%dq(k)
        case default
          own = own + coupling%varied_term(part%change, i, state%q(k), 1)*state%ddq(k) &
                + coupling%varied_term(part%change, i, state%q(k), 2)*state%dq(k)**2
        end select
      end do
      opening = opening + self%plan%closures(c)%weight*own
    end associate
  end function coupling_opening

  !> Fail where no change of the dependent coordinates keeps a chain closed: the equations of the block left it out because they do
  !> not change in any motion of the mechanism, but they change with the parameter.
  subroutine check_closed(model, block, self, err)
    type(model_type), intent(in) :: model                 !< the present model
    type(block_type), intent(in) :: block                 !< the block
    type(sensitivity_type), intent(in) :: self            !< with the frames
    type(error_type), allocatable, intent(out) :: err     !< allocated if it failed
    real(wp) :: opening(6), place(6), largest, gap
    integer :: c, p, i

    do p = 1, self%n_parameters
      do c = block%first_closure, block%last_closure
        largest = maxval(abs(self%q(p, 0, block%coordinates)/self%plan%unit_of(block%coordinates)))
        if (self%plan%closures(c)%coupling > 0) then
          gap = abs(coupling_opening(model, 0, c, p, self))
        else
          do i = 1, size(self%plan%closures(c)%loop%steps)
            largest = max(largest, size_of(self%frames(:, p, 0, self%plan%closures(c)%loop%steps(i)), self%plan%length))
          end do
          call find_opening(0, c, p, self, opening)
          place(1:3) = opening(1:3)
          place(4:6) = shift_at(opening, self%state%p(:, self%plan%closures(c)%closing))
          gap = size_of(place, self%plan%length)
        end if
        if (gap <= max(opened_by_parameter, inexact_dimensions*self%plan%data_tolerance)*largest) cycle
        call fail_with(failure_opening_parameter, exit_data, block, self%state%t, err)
        err%failure%number = p
        err%failure%name = model%parameters(p)%name
        err%place = model%parameters(p)%place
        return
      end do
    end do
  end subroutine check_closed

  !> The derivatives of a point, which moves with its frame and with the constants of its link.
  subroutine vary_point(model, number, self)
    type(model_type), intent(in) :: model           !< the present model
    integer, intent(in) :: number                   !< of the point
    type(sensitivity_type), intent(inout) :: self   !< with the frames; gets the derivatives
    real(wp) :: place(3), twist(6, 0:2), constant(6), velocity(3), acceleration(3), change(3, 0:2)
    integer :: f, p, order

    associate (point => model%mechanism%points(number), state => self%state)
      f = self%plan%frame_of(point%link)
      place = state%p(:, f) + turn(state%r(:, :, f), self%plan%link_in_frame(point%link)%p &
                                   + turn(self%plan%link_in_frame(point%link)%r, point%position))
      velocity = shift_at(self%motion%velocity(:, f), place)
      acceleration = shift_at(self%motion%acceleration(:, f), place) + cross(self%motion%velocity(1:3, f), velocity)
      do p = 1, self%n_parameters
        constant = self%tangents(p)%link(:, point%link)
        constant(4:6) = constant(4:6) + turn(self%plan%link_in_frame(point%link)%r, self%tangents(p)%points(:, number))
        twist = self%frames(:, p, :, f)
        if (any(abs(constant) > 0.0_wp)) twist = twist + carried(state, self%motion, f, constant)
        change(:, 0) = shift_at(twist(:, 0), place)
        change(:, 1) = shift_at(twist(:, 1), place) + cross(twist(1:3, 0), velocity)
        change(:, 2) = shift_at(twist(:, 2), place) + 2.0_wp*cross(twist(1:3, 1), velocity) + cross(twist(1:3, 0), acceleration)
        do order = 0, self%highest
          self%points(p, :, order, number) = change(:, order)
        end do
      end do
    end associate
  end subroutine vary_point
end module mech9_sensitivity
