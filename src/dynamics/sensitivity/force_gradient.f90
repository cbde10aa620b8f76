!> The exact derivatives of the forces that a motion requires along its free coordinates, by these coordinates, their rates and
!> accelerations, and by all parameters, at a cost that hardly depends on the number of parameters.
!>
!> A required force is the power that the wrenches of all frames have in a virtual motion, in which one free coordinate alone has a
!> rate. The wrenches transmitted by the steps are found first. The derivatives of the power then go inward as rows (see
!> mech9_gradient_rows), the closed chains make the rows of dependent coordinates zero, and each parameter costs one product of a
!> row with the twist by which it moves a frame.
module mech9_force_gradient
  use mech9_kinds, only: wp
  use mech9_error, only: error_type
  use mech9_rotation, only: cross
  use mech9_model, only: model_type
  use mech9_plan, only: plan_type, new_state
  use mech9_state, only: state_type
  use mech9_arithmetics, only: set_in_space
  use mech9_placed_motion, only: place_motion
  use mech9_block_solver, only: block_work_type, new_block_work, factorize_block
  use mech9_coupling_constraint, only: bent_force
  use mech9_lagrange_types, only: dynamics_plan_type, lagrange_work_type
  use mech9_frame_variation, only: third_derivatives_type, new_third_derivatives, find_third_derivatives
  use mech9_twists, only: frame_twists_type
  use mech9_tangent, only: tangent_type
  use mech9_varied_motion, only: varied_motion_type
  use mech9_gradient_rows, only: gradient_rows_type, new_gradient_rows, clear_rows, sum_inward, sum_order_inward, &
    row_of_coordinate, eliminate_rows, subtract_crossed
  use mech9_gradient_arithmetic, only: gradient_arithmetic_type
  use mech9_planar_gradient, only: planar_gradient_type, new_planar_gradient
  use mech9_spatial_gradient, only: spatial_gradient_type, new_spatial_gradient
  use mech9_load_gradient, only: load_gradient_type, new_load_gradient, reads_motions, find_loads, add_load_rows, &
    vary_loads, by_loads
  use mech9_parameter_changes, only: parameter_changes_type, list_changes, list_bodies, find_series, by_constants, by_masses, &
    by_couplings, by_drives, by_held
  implicit none
  private
  public :: force_gradient_type, new_force_gradient, needs_motions, find_force_gradient

  !> The derivatives, and what finds them.
  type :: force_gradient_type
    real(wp), allocatable :: by_position(:, :)         !< (free,free) of each force, by each coordinate
    real(wp), allocatable :: by_rate(:, :)             !< (free,free) the same by the rates
    real(wp), allocatable :: by_acceleration(:, :)     !< (free,free) the same by the accelerations: the coefficients of motion
    real(wp), allocatable :: by_parameters(:, :)       !< (P,free) of each force, by each parameter
    real(wp), allocatable :: given(:)                  !< (M) forces on coordinates beside the loads; not allocated: none [N m, N]
    class(gradient_arithmetic_type), allocatable, private :: arithmetic   !< of a plane or of space
    integer, private :: d = 0                                             !< numbers of a twist
    class(plan_type), allocatable, private :: plan                        !< in this arithmetic
    logical, private :: places_frames = .false.        !< the frames are placed here, because others do not place them all in space
    class(state_type), allocatable, private :: state                      !< the motion, where the frames are placed here
    type(block_work_type), allocatable, private :: blocks(:)              !< factors of closed chains, where the frames are
    type(frame_twists_type), private :: twists                            !< of the motion
    type(third_derivatives_type), private :: third                        !< of pairs without a fixed axis, and of couplings
    real(wp), allocatable, private :: maps(:, :, :)                       !< (d,d,closures) wrenches of the multipliers
    integer, allocatable, private :: entries(:, :)                        !< (M,free) entry of each coordinate's rate in B; 0: none
    type(gradient_rows_type), private :: held                             !< wrenches that the motion needs, of order 2
    real(wp), allocatable, private :: link_wrenches(:, :)                 !< (d,0:M) those of the links alone
    real(wp), allocatable, private :: virtual(:, :)                       !< (d,0:M) twists of the frames in a virtual motion
    real(wp), allocatable, private :: rates(:)                            !< (M) rates of the coordinates in it
    type(gradient_rows_type), private :: rows                             !< of the force along one free coordinate
    real(wp), allocatable, private :: link_rows(:, :, :)                  !< (d,0:2,0:M) those of the links alone
    type(load_gradient_type), private :: loads                            !< loads
    type(parameter_changes_type), private :: changes                      !< numbers that parameters change
  end type force_gradient_type

contains

  !> Prepare the derivatives for a model.
  subroutine new_force_gradient(model, plan, dynamics, tangents, self)
    type(model_type), intent(in) :: model               !< the model
    type(plan_type), intent(in) :: plan                 !< its plan
    type(dynamics_plan_type), intent(in) :: dynamics    !< its plan of dynamics
    type(tangent_type), intent(in) :: tangents(:)       !< derivatives of the constants by each parameter
    type(force_gradient_type), intent(out) :: self      !< prepared
    integer, allocatable :: bodies(:)

    call list_changes(model, plan, tangents, self%changes)
    allocate (self%plan, source=plan)
    bodies = moved_bodies(model, tangents)
    if (self%changes%in_plane) then
      self%arithmetic = planar_arithmetic(model, plan, bodies)
    else
      self%places_frames = plan%planar%used .or. any(plan%blocks%arithmetic /= 1)
      if (self%places_frames) call place_in_space(self)
      self%arithmetic = spatial_arithmetic(model, self%plan, bodies)
    end if
    self%d = self%arithmetic%d
    call list_bodies(self%plan, tangents, bodies, self%arithmetic, self%changes)
    call new_load_gradient(model, plan, self%d, tangents, self%loads)
    self%third = new_third_derivatives(self%plan)
    call list_entries(plan, dynamics, self%entries)
    call make_room(size(tangents), self)
  end subroutine new_force_gradient

  !> The bodies that count: those with mass or inertia, or with numbers that a parameter changes.
  function moved_bodies(model, tangents) result(numbers)
    type(model_type), intent(in) :: model            !< the model
    type(tangent_type), intent(in) :: tangents(:)    !< derivatives of the constants by each parameter
    integer, allocatable :: numbers(:)
    logical :: counts
    integer :: i, p

    allocate (numbers(0))
    do i = 1, size(model%mechanism%bodies)
      counts = model%mechanism%bodies(i)%has_inertia()
      do p = 1, size(tangents)
        counts = counts .or. tangents(p)%bodies(i)%varies
      end do
      if (counts .and. model%mechanism%bodies(i)%link > 1) numbers = [numbers, i]
    end do
  end function moved_bodies

  !> The arithmetic of a plane.
  function planar_arithmetic(model, plan, bodies) result(arithmetic)
    type(model_type), intent(in) :: model       !< the model
    type(plan_type), intent(in) :: plan         !< its plan, planar
    integer, intent(in) :: bodies(:)            !< numbers of the bodies
    type(planar_gradient_type) :: arithmetic

    call new_planar_gradient(model%mechanism, plan, bodies, arithmetic)
  end function planar_arithmetic

  !> The arithmetic of space.
  function spatial_arithmetic(model, plan, bodies) result(arithmetic)
    type(model_type), intent(in) :: model       !< the model
    type(plan_type), intent(in) :: plan         !< its plan, in space
    integer, intent(in) :: bodies(:)            !< numbers of the bodies
    type(spatial_gradient_type) :: arithmetic

    call new_spatial_gradient(model%mechanism, plan, bodies, arithmetic)
  end function spatial_arithmetic

  !> Take the plan to space, with room for its motion.
  subroutine place_in_space(self)
    type(force_gradient_type), intent(inout) :: self   !< its plan changes
    integer :: b

    self%plan%blocks%arithmetic = 1
    self%plan%blocks%is_shown = .false.
    self%plan%blocks%last_moved = self%plan%blocks%last_step
    call set_in_space(self%plan)
    allocate (self%state, source=new_state(self%plan))
    allocate (self%blocks(size(self%plan%blocks)))
    do b = 1, size(self%blocks)
      self%blocks(b) = new_block_work(self%plan%blocks(b))
    end do
  end subroutine place_in_space

  !> List the places of the rates that coordinates have per unit rate of each free one, among the entries of the Jacobian.
  pure subroutine list_entries(plan, dynamics, entries)
    type(plan_type), intent(in) :: plan                  !< the plan
    type(dynamics_plan_type), intent(in) :: dynamics     !< the plan of dynamics
    integer, allocatable, intent(out) :: entries(:, :)   !< (M,free) by steps; 0: none
    integer :: s, e, i

    allocate (entries(plan%n_coordinates, size(plan%free)), source=0)
    do s = 1, plan%n_coordinates
      do e = dynamics%first(s), dynamics%first(s + 1) - 1
        do i = 1, size(plan%free)
          if (dynamics%column(e) == plan%free_places(i)) entries(s, i) = e
        end do
      end do
    end do
  end subroutine list_entries

  !> Room for one motion.
  subroutine make_room(n, self)
    integer, intent(in) :: n                           !< number of parameters
    type(force_gradient_type), intent(inout) :: self   !< gets the room

    associate (d => self%d, m => self%plan%n_coordinates, f => size(self%plan%free))
      allocate (self%by_position(f, f), self%by_rate(f, f), self%by_acceleration(f, f), self%by_parameters(n, f), source=0.0_wp)
      allocate (self%twists%velocity(d, 0:m), self%twists%acceleration(d, 0:m), self%twists%step(d, 0:2, m), source=0.0_wp)
      allocate (self%maps(d, d, size(self%plan%closures)), self%link_wrenches(d, 0:m), self%virtual(d, 0:m), self%rates(m), &
                self%link_rows(d, 0:2, 0:m), source=0.0_wp)
    end associate
    self%held = new_gradient_rows(self%plan, self%d)
    self%rows = new_gradient_rows(self%plan, self%d)
  end subroutine make_room

  !> Whether the derivatives of the whole motion by all parameters must be known, because loads of unknown kinds read it.
  pure logical function needs_motions(self)
    type(force_gradient_type), intent(in) :: self        !< the derivatives

    needs_motions = reads_motions(self%loads)
  end function needs_motions

  !> Find the derivatives in the present motion. Fails where a load does, or a pair has no pose. Where loads of unknown kinds read the
  !> motion, their share in `by_parameters` is that of the whole motion of each parameter.
  subroutine find_force_gradient(model, present, motion, work, self, err)
    type(model_type), intent(in) :: model                !< the model
    type(state_type), intent(in) :: present              !< the motion, with all accelerations, in the plan of the run
    type(varied_motion_type), intent(in) :: motion       !< derivatives of constants, and of the motion where they are needed
    type(lagrange_work_type), intent(inout) :: work      !< of the run, with B and the factors of the closed chains
    type(force_gradient_type), intent(inout) :: self     !< gets the derivatives
    type(error_type), allocatable, intent(out) :: err    !< allocated if it failed
    integer :: b

    if (self%places_frames) then
      call place_motion(present, self%plan, self%state, err)
      if (allocated(err)) return
      do b = 1, size(self%plan%blocks)
        if (self%plan%blocks(b)%equations > 0) call factorize_block(self%plan, self%plan%blocks(b), self%state, self%blocks(b))
      end do
      call find_from_frames(model, self%state, motion, work%jacobian%b, self%blocks, self, err)
    else
      call find_from_frames(model, present, motion, work%jacobian%b, work%blocks, self, err)
    end if
  end subroutine find_force_gradient

  !> Find the derivatives in a motion whose frames are in place.
  subroutine find_from_frames(model, state, motion, b, blocks, self, err)
    type(model_type), intent(in) :: model                 !< the model
    type(state_type), intent(in) :: state                 !< the motion, in the arithmetic of the derivatives
    type(varied_motion_type), intent(in) :: motion        !< derivatives of constants, and of the motion where they are needed
    real(wp), intent(in) :: b(:)                          !< entries of B, rates of coordinates per unit rate of an independent one
    type(block_work_type), intent(inout) :: blocks(:)     !< factors of the closed chains
    type(force_gradient_type), intent(inout) :: self      !< gets the derivatives
    type(error_type), allocatable, intent(out) :: err     !< allocated if it failed
    integer :: i

    call find_motion(state, self, err)
    if (.not. allocated(err)) call find_held(model, state, blocks, self, err)
    if (.not. allocated(err)) call vary_loads(model, self%arithmetic, motion, self%loads, err)
    if (allocated(err)) return
    call find_series(self%plan, state, self%twists, motion%tangents, self%arithmetic, self%changes)
    do i = 1, size(self%plan%free)
      call move_virtually(self%plan, self%d, self%entries(:, i), b, self%twists%step, self%rates, self%virtual)
      call find_rows(model, state, blocks, self, err)
      if (allocated(err)) return
      call read_rows(i, self)
      call vary_numbers(model, state, motion%tangents, self, self%by_parameters(:, i))
      if (allocated(motion%held)) call by_held(self%plan, motion%held, self%twists, self%d, self%rows, self%by_parameters(:, i))
    end do
  end subroutine find_from_frames

  !> The twists of frames and steps, and the wrenches of multipliers.
  subroutine find_motion(state, self, err)
    type(state_type), intent(in) :: state                 !< the motion
    type(force_gradient_type), intent(inout) :: self      !< gets the twists
    type(error_type), allocatable, intent(out) :: err     !< allocated if a pair has no pose near its present one
    integer :: c

    if (self%d == 6 .or. size(self%plan%couplings) > 0) call find_third_derivatives(self%plan, state, self%third, err)
    if (allocated(err)) return
    call self%arithmetic%find_twists(self%plan, state, self%third, self%twists)
    do c = 1, size(self%plan%closures)
      if (self%plan%closures(c)%coupling == 0) call self%arithmetic%find_map(self%plan, c, state, self%maps(:, :, c))
    end do
  end subroutine find_motion

  !> The wrenches that the motion needs, transmitted by the steps, and those of the closed chains.
  subroutine find_held(model, state, blocks, self, err)
    type(model_type), intent(in) :: model                 !< the model
    type(state_type), intent(in) :: state                 !< the motion
    type(block_work_type), intent(inout) :: blocks(:)     !< factors of the closed chains
    type(force_gradient_type), intent(inout) :: self      !< with the twists; gets the wrenches
    type(error_type), allocatable, intent(out) :: err     !< allocated if a load failed

    call clear_rows(self%held)
    call self%arithmetic%find_wrenches(state, self%held%frames(:, 2, :))
    call find_loads(model, self%plan, state, self%arithmetic, self%loads, self%held, err)
    if (allocated(err)) return
    if (allocated(self%given)) self%held%coordinates(2, :) = self%held%coordinates(2, :) - self%given
    if (self%changes%moves_links) self%link_wrenches = self%held%frames(:, 2, :)
    call sum_order_inward(self%plan, self%d, 2, self%held%frames)
    call eliminate_rows(self%plan, self%d, 2, state, self%twists%step, self%third%couplings, self%maps, blocks, self%held)
  end subroutine find_held

  !> The virtual motion in which one free coordinate has the rate 1, and the other independent ones rest.
  pure subroutine move_virtually(plan, d, entries, b, steps, rates, virtual)
    type(plan_type), intent(in) :: plan                               !< the plan
    integer, intent(in) :: d                                          !< numbers of a twist
    integer, intent(in) :: entries(plan%n_coordinates)                !< entry of each step in B; 0: it rests
    real(wp), intent(in) :: b(:)                                      !< entries of B
    real(wp), intent(in) :: steps(d, 0:2, plan%n_coordinates)         !< twists of the steps per unit rate
    real(wp), intent(out) :: rates(plan%n_coordinates)                !< of the coordinates
    real(wp), intent(inout) :: virtual(d, 0:plan%n_coordinates)       !< twists of the frames; that of frame 0 is zero
    real(wp) :: rate
    integer :: s, c

    do s = 1, plan%n_coordinates
      rate = 0.0_wp
      if (entries(s) > 0) rate = b(entries(s))
      rates(plan%steps(s)%coordinate) = rate
      do c = 1, d
        virtual(c, s) = virtual(c, plan%steps(s)%parent) + rate*steps(c, 0, s)
      end do
    end do
  end subroutine move_virtually

  !> The rows of the force along the coordinate of the virtual motion.
  subroutine find_rows(model, state, blocks, self, err)
    type(model_type), intent(in) :: model                 !< the model
    type(state_type), intent(in) :: state                 !< the motion
    type(block_work_type), intent(inout) :: blocks(:)     !< factors of the closed chains
    type(force_gradient_type), intent(inout) :: self      !< with the virtual motion; gets the rows
    type(error_type), allocatable, intent(out) :: err     !< allocated if a load failed

    call clear_rows(self%rows)
    call self%arithmetic%add_rows(self%virtual, self%rows%frames)
    call add_load_rows(model, self%plan, self%arithmetic, self%virtual, self%rates, self%loads, self%rows, err)
    if (allocated(err)) return
    if (self%changes%moves_links) call take_links(self%plan, self%d, self%virtual, self%link_wrenches, self%rows%frames, &
                                                  self%link_rows)
    call sum_inward(self%plan, 3*self%d, self%rows%frames)
    call turn_wrenches(self%plan, self%d, self%virtual, self%held%frames, self%rows%frames)
    call bend_steps(state, self)
    call eliminate_rows(self%plan, self%d, 0, state, self%twists%step, self%third%couplings, self%maps, blocks, self%rows)
    call turn_chains(self)
  end subroutine find_rows

  !> The rows of the links alone, with the bodies on them and their loads.
  pure subroutine take_links(plan, d, virtual, wrenches, rows, link_rows)
    type(plan_type), intent(in) :: plan                                   !< the plan
    integer, intent(in) :: d                                              !< numbers of a twist
    real(wp), intent(in) :: virtual(d, 0:plan%n_coordinates)              !< twists of the frames in the virtual motion
    real(wp), intent(in) :: wrenches(d, 0:plan%n_coordinates)             !< wrenches that the links need
    real(wp), intent(in) :: rows(d, 0:2, 0:plan%n_coordinates)            !< rows of each frame by itself
    real(wp), intent(inout) :: link_rows(d, 0:2, 0:plan%n_coordinates)    !< the rows
    integer :: k

    do k = 2, plan%n_links
      associate (f => plan%frame_of(k))
        link_rows(:, :, f) = rows(:, :, f)
        call subtract_crossed(d, virtual(1, f), wrenches(1, f), link_rows(1, 0, f))
      end associate
    end do
  end subroutine take_links

  !> Let the wrenches that steps transmit move with what follows the step: they do work in the virtual motion of its parent.
  pure subroutine turn_wrenches(plan, d, virtual, held, rows)
    type(plan_type), intent(in) :: plan                                  !< the plan
    integer, intent(in) :: d                                             !< numbers of a twist
    real(wp), intent(in) :: virtual(d, 0:plan%n_coordinates)             !< twists of the frames in the virtual motion
    real(wp), intent(in) :: held(d, 0:2, 0:plan%n_coordinates)           !< wrenches, of order 2
    real(wp), intent(inout) :: rows(d, 0:2, 0:plan%n_coordinates)        !< those of order 0 change
    integer :: s

    do s = 1, plan%n_coordinates
      associate (i => plan%steps(s)%parent)
        if (i > 0) call subtract_crossed(d, virtual(1, i), held(1, 2, s), rows(1, 0, s))
      end associate
    end do
  end subroutine turn_wrenches

  !> Add the rows of pairs without a fixed axis, and of couplings that are not linear, whose rates depend on their own coordinates.
  subroutine bend_steps(state, self)
    type(state_type), intent(in) :: state                 !< the motion
    type(force_gradient_type), intent(inout) :: self      !< with the virtual motion; its rows change
    real(wp) :: axis_rate(6)
    integer :: s, b, c

    do b = 1, size(self%plan%blocks)
      do c = self%plan%blocks(b)%first_closure, self%plan%blocks(b)%last_closure
        if (self%plan%closures(c)%coupling > 0) call bent_force(self%plan, c, state, -self%held%couplings(2, c), self%rates, &
                                                                self%rows%coordinates(0, :))
      end do
    end do
    if (self%d == 3) return
    do s = 1, self%plan%n_coordinates
      if (self%plan%steps(s)%is_screw) cycle
      axis_rate(1:3) = state%axis_w_rate(:, s)
      axis_rate(4:6) = state%axis_v_rate(:, s) - cross(axis_rate(1:3), state%p(:, s)) &
                       - cross(state%axis_w(:, s), state%axis_v(:, s))
      associate (k => self%plan%steps(s)%coordinate)
        self%rows%coordinates(0, k) = self%rows%coordinates(0, k) &
                                      + self%rates(k)*dot_product(axis_rate, self%held%frames(:, 2, s))
      end associate
    end do
  end subroutine bend_steps

  !> Let the wrenches of closed chains move with the closing frame on its target, too.
  subroutine turn_chains(self)
    type(force_gradient_type), intent(inout) :: self      !< with the virtual motion; its rows change
    integer :: c

    do c = 1, size(self%plan%closures)
      associate (closure => self%plan%closures(c))
        if (closure%coupling > 0) cycle
        call subtract_crossed(self%d, self%virtual(:, closure%target), self%held%chains(:, 2, c), self%rows%chains(:, 0, c))
      end associate
    end do
  end subroutine turn_chains

  !> Read the derivatives by the free coordinates from the rows.
  subroutine read_rows(i, self)
    integer, intent(in) :: i                              !< number of the force
    type(force_gradient_type), intent(inout) :: self      !< with the rows; gets the derivatives
    integer :: j, s

    do j = 1, size(self%plan%free)
      associate (k => self%plan%free(j))
        s = self%plan%step_of(k)
        associate (twist => self%twists%step(:, :, s), rows => self%rows%frames(:, :, s), direct => self%rows%coordinates(:, k))
          self%by_position(i, j) = row_of_coordinate(self%d, 0, twist, rows, direct)
          self%by_rate(i, j) = row_of_coordinate(self%d, 1, twist, rows, direct)
          self%by_acceleration(i, j) = row_of_coordinate(self%d, 2, twist, rows, direct)
        end associate
      end associate
    end do
  end subroutine read_rows

  !> The derivatives of the force by all parameters, the free coordinates held.
  subroutine vary_numbers(model, state, tangents, self, by_parameters)
    type(model_type), intent(in) :: model                 !< the model
    type(state_type), intent(in) :: state                 !< the motion
    type(tangent_type), intent(in) :: tangents(:)         !< derivatives of the constants by each parameter
    type(force_gradient_type), intent(in) :: self         !< with the rows
    real(wp), intent(out) :: by_parameters(:)             !< (P) the derivatives

    by_parameters = 0.0_wp
    call by_constants(self%plan, self%d, self%rates, self%held, self%rows, self%link_rows, self%changes, by_parameters)
    call by_masses(self%arithmetic, tangents, self%virtual, self%changes, by_parameters)
    call by_loads(self%plan, self%virtual, self%rates, self%loads, by_parameters)
    call by_couplings(model, self%plan, state, tangents, self%rates, self%held, self%rows, self%changes, by_parameters)
    call by_drives(model, self%plan, state, tangents, self%twists, self%d, self%rows, self%changes, by_parameters)
  end subroutine vary_numbers
end module mech9_force_gradient
