!> Derivatives of a motion by all parameters, from those of its free coordinates: of all coordinates, frames and points.
!>
!> The derivatives of driven motions are those of mech9_sensitivity. Here free coordinates have derivatives that are given, all frames
!> get the twists by which they move with a parameter, and closed chains may have any independent coordinates.
module mech9_varied_motion
  use mech9_kinds, only: wp
  use mech9_tolerances, only: singular_conditioning, inexact_dimensions
  use mech9_sensitivity_tolerances, only: opened_by_parameter, round_off_of_opening
  use mech9_error, only: error_type, raise, exit_data, exit_singular
  use mech9_sensitivity_failures, only: failure_singular_sensitivity, failure_opening_parameter
  use mech9_rotation, only: turn, cross
  use mech9_model, only: model_type
  use mech9_variable_model, only: variable_model_type
  use mech9_plan, only: plan_type, block_type, new_state
  use mech9_state, only: state_type
  use mech9_arithmetics, only: set_in_space
  use mech9_placed_motion, only: place_motion
  use mech9_block_solver, only: block_work_type, new_block_work, factorize_block
  use mech9_coupling_constraint, only: varied_coupling
  use mech9_frame_variation, only: third_derivatives_type, new_third_derivatives, find_third_derivatives
  use mech9_twists, only: frame_twists_type, new_frame_twists, find_frame_twists, find_step_twists, carried, shift_at
  use mech9_tangent, only: tangent_type, find_tangent
  use mech9_pair_changes, only: find_pair_change, carry_pair_change
  implicit none
  private
  public :: varied_motion_type, new_varied_motion, find_varied_motion, find_varied_points, link_twists, vary_drives

  !> A pair without a fixed axis that depends on numbers which a parameter changes.
  type :: varied_pair_type
    integer :: step = 0                      !< of the plan
    integer :: parameter = 0                 !< number of the parameter
    real(wp) :: twists(6, 0:2) = 0.0_wp      !< by which the frame of the step moves with the parameter, and derivatives in time
    real(wp) :: slope(6) = 0.0_wp            !< derivative of the first one in the coordinate, with the parent frame at rest
  end type varied_pair_type

  !> The derivatives and what finds them. The first index is the parameter, which counts in its unit in the data file.
  type :: varied_motion_type
    integer :: n_parameters = 0
    real(wp), allocatable :: q(:, :, :)             !< (P,0:2,M) of the coordinates and their derivatives in time [rad, m]
    real(wp), allocatable :: points(:, :, :, :)     !< (P,3,0:2,points) of the points of the mechanism [m]
    real(wp), allocatable :: given(:, :, :)         !< (P,0:2,free) of the free coordinates [rad, m]
    real(wp), allocatable :: motor(:, :)            !< (P,motors) given, too: of the states of the motors
    real(wp), allocatable :: held(:, :, :)          !< (P,0:2,M) given, too: of driven coordinates, beside those of their drives' numbers;
                                                    !< not allocated: none
    real(wp), allocatable :: friction(:, :)         !< (P,frictions) of their forces; not allocated: these are held [N m, N]
    real(wp), allocatable :: contact(:, :)          !< (P,3 contacts) of the forces of rigid contacts beside those that turn with them, fixed
                                                    !< axes; not allocated: these are held [N]
    real(wp), allocatable :: twists(:, :, :, :)     !< (P,6,0:2,0:M) of the frames
    type(tangent_type), allocatable :: tangents(:)  !< (P) of the constants
    class(plan_type), allocatable :: plan           !< in space
    class(state_type), allocatable :: state         !< the motion, in space
    type(frame_twists_type) :: motion               !< twists of this motion
    type(third_derivatives_type) :: third           !< of pairs without a fixed axis, and of couplings
    type(block_work_type), allocatable :: blocks(:) !< factors of the closed chains
    type(varied_pair_type), allocatable :: pairs(:) !< of the user, by each parameter that changes their numbers
    integer, allocatable, private :: numbers(:)     !< (M+1) of all frames, from 0 on
  end type varied_motion_type

  !> Binomial coefficients of derivatives of a product: (part, order).
  integer, parameter :: binomial(0:2, 0:2) = reshape([1, 0, 0, 1, 1, 0, 1, 2, 1], [3, 3])

contains

  !> Prepare the derivatives by all parameters of a model. Fails where the model does not exist beside the present values, and where
  !> a parameter sets numbers by which no motion has known derivatives.
  subroutine new_varied_motion(variable, model, plan, self, err)
    class(variable_model_type), intent(inout) :: variable   !< the model as a function of its parameters
    type(model_type), intent(in) :: model                   !< the present model
    type(plan_type), intent(in) :: plan                     !< its plan
    type(varied_motion_type), intent(out) :: self           !< prepared
    type(error_type), allocatable, intent(out) :: err       !< allocated if it failed
    integer :: i, n, m

    n = size(model%parameters)
    m = plan%n_coordinates
    self%n_parameters = n
    allocate (self%tangents(n))
    do i = 1, n
      call find_tangent(variable, model, plan, i, self%tangents(i), err)
      if (allocated(err)) return
    end do
    allocate (self%plan, source=plan)
    self%plan%blocks%arithmetic = 1
    self%plan%blocks%is_shown = .false.
    self%plan%blocks%last_moved = self%plan%blocks%last_step
    call set_in_space(self%plan)
    allocate (self%state, source=new_state(self%plan))
    self%motion = new_frame_twists(m)
    self%third = new_third_derivatives(plan)
    allocate (self%blocks(size(plan%blocks)))
    do i = 1, size(plan%blocks)
      self%blocks(i) = new_block_work(self%plan%blocks(i))
    end do
    self%numbers = [(i, i=0, m)]
    call list_pairs(self)
    allocate (self%q(n, 0:2, m), self%twists(n, 6, 0:2, 0:m), self%points(n, 3, 0:2, size(model%mechanism%points)), &
              self%given(n, 0:2, size(plan%free)), self%motor(n, size(model%mechanism%motors)), source=0.0_wp)
  end subroutine new_varied_motion

  !> The pairs without a fixed axis whose numbers parameters change.
  subroutine list_pairs(self)
    type(varied_motion_type), intent(inout) :: self   !< with plan and tangents; gets the list
    integer :: s, p

    allocate (self%pairs(0))
    do p = 1, self%n_parameters
      do s = 1, self%plan%n_coordinates
        if (self%tangents(p)%pairs(self%plan%steps(s)%coordinate)%varies) self%pairs = [self%pairs, varied_pair_type(s, p)]
      end do
    end do
  end subroutine list_pairs

  !> Find the derivatives of the coordinates and frames of the present motion. Fails with exit_singular where closed chains are in a
  !> singular position, and with exit_data where a change of a parameter would open a closed chain.
  subroutine find_varied_motion(model, present, self, err)
    type(model_type), intent(in) :: model                 !< the present model
    type(state_type), intent(in) :: present               !< coordinates, rates and accelerations
    type(varied_motion_type), intent(inout) :: self       !< with `given`; gets the derivatives
    type(error_type), allocatable, intent(out) :: err     !< allocated if it failed
    integer :: b, order

    call find_twists(present, self, err)
    if (allocated(err)) return
    do b = 1, size(self%plan%blocks)
      if (self%plan%blocks(b)%equations == 0) cycle
      call factorize_block(self%plan, self%plan%blocks(b), self%state, self%blocks(b))
      if (self%blocks(b)%equations%conditioning() >= singular_conditioning) cycle
      call fail_with(failure_singular_sensitivity, exit_singular, self%plan%blocks(b), self%state%t, err)
      return
    end do
    call vary_drives(model, self, self%state%t, self%q)
    if (allocated(self%held)) self%q = self%q + self%held
    self%q(:, :, self%plan%free) = self%given
    do b = 1, size(self%plan%blocks)
      do order = 0, 2
        call vary_block(model, order, b, self, err)
        if (allocated(err)) return
      end do
    end do
  end subroutine find_varied_motion

  !> Find the derivatives of the points, after those of the frames.
  subroutine find_varied_points(model, self)
    type(model_type), intent(in) :: model                 !< the present model
    type(varied_motion_type), intent(inout) :: self       !< with the frames; gets the points
    integer :: i

    do i = 1, size(model%mechanism%points)
      call vary_point(model, i, self)
    end do
  end subroutine find_varied_points

  !> Place the frames of the present motion in space, with their twists and those by which pairs change.
  subroutine find_twists(present, self, err)
    type(state_type), intent(in) :: present               !< the present motion
    type(varied_motion_type), intent(inout) :: self       !< gets its frames
    type(error_type), allocatable, intent(out) :: err     !< allocated if a pair has no pose
    real(wp) :: change(6, 0:2)
    integer :: i

    call place_motion(present, self%plan, self%state, err)
    if (allocated(err)) return
    call find_third_derivatives(self%plan, self%state, self%third, err)
    if (allocated(err)) return
    call find_frame_twists(self%state, self%numbers, 2, self%motion)
    call find_step_twists(self%plan, self%state, self%third, self%numbers(2:), 2, self%motion)
    do i = 1, size(self%pairs)
      associate (pair => self%pairs(i))
        call find_pair_change(self%plan, self%state, self%tangents(pair%parameter), pair%step, change)
        call carry_pair_change(self%plan, self%state, self%motion, pair%step, change, 2, pair%twists)
        pair%slope = change(:, 1)
      end associate
    end do
  end subroutine find_twists

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

  !> The derivatives of the driven coordinates, which their laws give; those of all others are zero, also where a driven coordinate
  !> depends on others for the time being.
  subroutine vary_drives(model, self, t, q)
    type(model_type), intent(in) :: model             !< the present model
    type(varied_motion_type), intent(in) :: self      !< with the derivatives of constants
    real(wp), intent(in) :: t                         !< time [s]
    real(wp), intent(out) :: q(:, 0:, :)              !< (P,0:2,M) derivatives of the coordinates and of their derivatives in time
    real(wp) :: change(0:2)
    integer :: i, p

    q = 0.0_wp
    do p = 1, self%n_parameters
      do i = 1, size(model%problem%drives)
        associate (part => self%tangents(p)%drives(i), drive => model%problem%drives(i)%drive)
          if (.not. (part%varies .and. any(self%plan%independent == drive%coordinate))) cycle
          call drive%vary(part%change, t, change(0), change(1), change(2))
          q(p, :, drive%coordinate) = change
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
    type(varied_motion_type), intent(inout) :: self       !< with lower orders, and earlier blocks; gets the block
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
    integer, intent(in) :: order                      !< of the derivative in time
    integer, intent(in) :: first                      !< frames from this one
    integer, intent(in) :: last                       !< last one of these
    type(varied_motion_type), intent(inout) :: self   !< with the coordinates; gets the frames
    real(wp) :: amounts(self%n_parameters), factor
    integer :: s, i, j, c, k, p

    do s = first, last
      i = self%plan%steps(s)%parent
      k = self%plan%steps(s)%coordinate
      self%twists(:, :, order, s) = self%twists(:, :, order, i)
      do j = 0, order
        amounts = self%q(:, j, k)
        if (j == 0) then
          do p = 1, self%n_parameters
            amounts(p) = amounts(p) + self%tangents(p)%offset(k)
          end do
        end if
        do c = 1, 6
          factor = binomial(j, order)*self%motion%step(c, order - j, s)
          if (abs(factor) > 0.0_wp) self%twists(:, c, order, s) = self%twists(:, c, order, s) + factor*amounts
        end do
      end do
      do p = 1, self%n_parameters
        if (self%tangents(p)%moves(k) .or. abs(self%tangents(p)%slide(k)) > 0.0_wp) &
          call add_constants(self%tangents(p), self%plan, self%state, self%motion, s, order, p, self%twists(:, :, order, s))
      end do
      do p = 1, size(self%pairs)
        associate (pair => self%pairs(p))
          if (pair%step == s) self%twists(pair%parameter, :, order, s) = self%twists(pair%parameter, :, order, s) &
                                                                         + pair%twists(:, order)
        end associate
      end do
    end do
  end subroutine vary_frames

  !> Add the twist that the constants of a step give to its frame by one parameter.
  pure subroutine add_constants(tangent, plan, state, motion, s, order, p, twists)
    type(tangent_type), intent(in) :: tangent       !< derivatives of the constants
    type(plan_type), intent(in) :: plan             !< the plan of the mechanism, in space
    type(state_type), intent(in) :: state           !< the motion
    type(frame_twists_type), intent(in) :: motion   !< its twists
    integer, intent(in) :: s                        !< the step
    integer, intent(in) :: order                    !< of the derivative in time
    integer, intent(in) :: p                        !< number of the parameter
    real(wp), intent(inout) :: twists(:, :)         !< (P,6) of the frame
    real(wp) :: series(6, 0:2), length(0:2), along(6)
    integer :: k, j

    k = plan%steps(s)%coordinate
    if (tangent%moves(k)) then
      call carried(state, motion, plan%steps(s)%parent, tangent%before(:, k), order, series)
      twists(p, :) = twists(p, :) + series(:, order)
    end if
    if (.not. abs(tangent%slide(k)) > 0.0_wp) return
    along(1:3) = 0.0_wp
    along(4:6) = plan%steps(s)%before%r(:, 3)
    call carried(state, motion, plan%steps(s)%parent, along, order, series)
    length = tangent%slide(k)*[state%q(k) + plan%steps(s)%offset, state%dq(k), state%ddq(k)]
    do j = 0, order
      twists(p, :) = twists(p, :) + binomial(j, order)*length(j)*series(:, order - j)
    end do
  end subroutine add_constants

  !> The twists by which the closed chains of a block open, as values of its equations.
  subroutine find_openings(model, order, block, self, openings)
    type(model_type), intent(in) :: model             !< the present model
    integer, intent(in) :: order                      !< of the derivative in time
    type(block_type), intent(in) :: block             !< the block
    type(varied_motion_type), intent(in) :: self      !< with the frames
    real(wp), intent(out) :: openings(:, :)           !< (equations,P) [rad, lengths of the mechanism]
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
    integer, intent(in) :: order                      !< of the derivative in time
    integer, intent(in) :: c                          !< number of the closure
    integer, intent(in) :: p                          !< number of the parameter
    type(varied_motion_type), intent(in) :: self      !< with the frames
    real(wp), intent(out) :: opening(6)               !< the twist [rad, m]
    real(wp) :: series(6, 0:2)
    integer :: k

    associate (closure => self%plan%closures(c))
      k = self%plan%steps(closure%closing)%coordinate
      opening = self%twists(p, :, order, closure%closing) - self%twists(p, :, order, closure%target)
      if (.not. any(abs(self%tangents(p)%in_target(:, k)) > 0.0_wp)) return
      call carried(self%state, self%motion, closure%target, self%tangents(p)%in_target(:, k), order, series)
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
    type(model_type), intent(in) :: model             !< the present model
    integer, intent(in) :: order                      !< of the derivative in time
    integer, intent(in) :: c                          !< number of the closure that is the coupling
    integer, intent(in) :: p                          !< number of the parameter
    type(varied_motion_type), intent(in) :: self      !< with the coordinates
    real(wp) :: by_numbers
    integer :: i, k

    associate (number => self%plan%closures(c)%coupling)
      opening = varied_coupling(self%plan, c, self%state, self%third%couplings(number), order, &
                                self%q(p, :, self%plan%couplings(number)%coupling%coordinates))
    end associate
    associate (part => self%tangents(p)%couplings(self%plan%closures(c)%coupling), state => self%state, &
               coupling => model%mechanism%couplings(self%plan%closures(c)%coupling)%coupling)
      if (.not. part%varies) return
      by_numbers = 0.0_wp
      do i = 1, size(coupling%coordinates)
        k = coupling%coordinates(i)
        select case (order)
        case (0)
          by_numbers = by_numbers + coupling%varied_term(part%change, i, state%q(k), 0)
        case (1)
          by_numbers = by_numbers + coupling%varied_term(part%change, i, state%q(k), 1)*state%dq(k)
        case default
          by_numbers = by_numbers + coupling%varied_term(part%change, i, state%q(k), 1)*state%ddq(k) &
                       + coupling%varied_term(part%change, i, state%q(k), 2)*state%dq(k)**2
        end select
      end do
      opening = opening + self%plan%closures(c)%weight*by_numbers
    end associate
  end function coupling_opening

  !> Fail where no change of the dependent coordinates keeps a chain closed: the equations of the block left it out because they do
  !> not change in any motion of the mechanism, but they change with the parameter.
  subroutine check_closed(model, block, self, err)
    type(model_type), intent(in) :: model                 !< the present model
    type(block_type), intent(in) :: block                 !< the block
    type(varied_motion_type), intent(in) :: self          !< with the frames
    type(error_type), allocatable, intent(out) :: err     !< allocated if it failed
    real(wp) :: opening(6), place(6), twist(6), largest, gap
    integer :: c, p, i

    do p = 1, self%n_parameters
      do c = block%first_closure, block%last_closure
        largest = maxval(abs(self%q(p, 0, block%coordinates)/self%plan%unit_of(block%coordinates)))
        if (self%plan%closures(c)%coupling > 0) then
          gap = abs(coupling_opening(model, 0, c, p, self))
          largest = max(largest, maxval(abs(self%q(p, 0, :)/self%plan%unit_of)))
        else
          do i = 1, size(self%plan%closures(c)%loop%steps)
            twist = self%twists(p, :, 0, self%plan%closures(c)%loop%steps(i))
            largest = max(largest, size_of(twist, self%plan%length))
          end do
          call find_opening(0, c, p, self, opening)
          place(1:3) = opening(1:3)
          place(4:6) = shift_at(opening, self%state%p(:, self%plan%closures(c)%closing))
          gap = size_of(place, self%plan%length)
        end if
        if (gap <= max(opened_by_parameter, inexact_dimensions*self%plan%data_tolerance)*largest) cycle
        if (gap <= round_off_of_opening*self%tangents(p)%round_off) cycle
        call fail_with(failure_opening_parameter, exit_data, block, self%state%t, err)
        err%failure%number = p
        err%failure%name = model%parameters(p)%name
        err%place = model%parameters(p)%place
        return
      end do
    end do
  end subroutine check_closed

  !> The twists of a link's own system, which moves with its first frame and with the constants of the link.
  subroutine link_twists(self, link, twists)
    type(varied_motion_type), intent(in) :: self      !< with the frames
    integer, intent(in) :: link                       !< number of the link
    real(wp), intent(out) :: twists(:, :, 0:)         !< (P,6,0:2) of its own system
    real(wp) :: series(6, 0:2)
    integer :: f, p, order

    f = self%plan%frame_of(link)
    do order = 0, 2
      twists(:, :, order) = self%twists(:, :, order, f)
    end do
    do p = 1, self%n_parameters
      if (.not. any(abs(self%tangents(p)%link(:, link)) > 0.0_wp)) cycle
      call carried(self%state, self%motion, f, self%tangents(p)%link(:, link), 2, series)
      do order = 0, 2
        twists(p, :, order) = twists(p, :, order) + series(:, order)
      end do
    end do
  end subroutine link_twists

  !> The derivatives of a point, which moves with its frame and with the constants of its link.
  subroutine vary_point(model, number, self)
    type(model_type), intent(in) :: model             !< the present model
    integer, intent(in) :: number                     !< of the point
    type(varied_motion_type), intent(inout) :: self   !< with the frames; gets the derivatives
    real(wp) :: place(3), twist(6, 0:2), series(6, 0:2), constant(6), velocity(3), acceleration(3)
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
        do order = 0, 2
          twist(:, order) = self%twists(p, :, order, f)
        end do
        if (any(abs(constant) > 0.0_wp)) then
          call carried(state, self%motion, f, constant, 2, series)
          twist = twist + series
        end if
        self%points(p, :, 0, number) = shift_at(twist(:, 0), place)
        self%points(p, :, 1, number) = shift_at(twist(:, 1), place) + cross(twist(1:3, 0), velocity)
        self%points(p, :, 2, number) = shift_at(twist(:, 2), place) + 2.0_wp*cross(twist(1:3, 1), velocity) &
                                       + cross(twist(1:3, 0), acceleration)
      end do
    end associate
  end subroutine vary_point
end module mech9_varied_motion
