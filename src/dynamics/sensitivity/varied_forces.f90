!> The forces that a motion requires along the coordinates beyond its loads, and their exact derivatives by all parameters.
!>
!> With a parameter, a link moves by a twist. Seen by an observer who moves with it, the link's velocity changes by the derivative of
!> this twist in time, its inertia by the change of its own numbers only, and gravity turns. The forces of closed chains are held
!> in the frames in which their loops start: the rates that dependent coordinates have per unit rate of an independent one let these
!> forces do no work, before and after the change (see mech9_linearisation).
module mech9_varied_forces
  use mech9_kinds, only: wp
  use mech9_error, only: error_type
  use mech9_rotation, only: turn, cross
  use mech9_motion_view, only: motion_view_type
  use mech9_contact, only: contact_place_type
  use mech9_motion_change, only: motion_change_type, new_motion_change
  use mech9_force_sum, only: force_sum_type, new_force_sum
  use mech9_model, only: model_type
  use mech9_plan, only: plan_type
  use mech9_generalized_forces, only: sum_forces
  use mech9_tree_forces, only: loop_wrench_type
  use mech9_loop_forces, only: loop_forces_type, new_loop_forces, eliminate_dependent, loop_wrenches, vary_couplings
  use mech9_twists, only: bracket, carried, shift_at
  use mech9_varied_motion, only: varied_motion_type, link_twists
  use mech9_parameter_twists, only: inertia_type, momentum, momenta, crossed, add_bracket, add_turned_wrench
  use mech9_link_requirements, only: link_requirements_type, vary_coupling_numbers, keep_couplings, add_couplings
  use mech9_varied_bodies, only: place_body, change_of_body, change_of_momentum
  implicit none
  private
  public :: varied_forces_type, new_varied_forces, find_varied_forces, show_change, vary_step, departing_twists

  !> The forces and their derivatives. The first index of derivatives is the parameter.
  type :: varied_forces_type
    real(wp), allocatable :: forces(:)           !< (M) required along the independent coordinates; zero for others [N m, N]
    real(wp), allocatable :: changes(:, :)       !< (P,M) their derivatives
    type(link_requirements_type), allocatable :: links   !< kept where wrenches of pairs are wanted
    integer, allocatable, private :: acting(:)            !< numbers of the loads
    logical, private :: is_loaded = .false.               !< there are loads or motors
    integer, allocatable, private :: loaded(:)            !< links on which they act or whose motion they read
    type(motion_view_type), private :: view               !< the motion as loads read it
    type(motion_change_type), private :: change           !< its derivative by one parameter
    type(force_sum_type), private :: sum, sum_change      !< of the loads, and of their derivatives by one parameter
    type(loop_forces_type), private :: loops, loops_held  !< forces of the equations: scratch, and those of the motion
    type(loop_wrench_type), allocatable, private :: chains(:)   !< (closures) forces of the closed chains
    real(wp), allocatable, private :: wrench(:, :)        !< (6,0:M) that each frame must be given, with all beyond it
    real(wp), allocatable, private :: wrenches(:, :, :)   !< (P,6,0:M) derivatives
  end type varied_forces_type

contains

  !> Room for the forces of a model and their derivatives.
  subroutine new_varied_forces(model, motion, self, with_links)
    type(model_type), intent(in) :: model               !< the model
    type(varied_motion_type), intent(in) :: motion      !< derivatives of its motion
    type(varied_forces_type), intent(out) :: self       !< gets its room
    logical, intent(in), optional :: with_links         !< wrenches that links require are kept; not unless given
    logical :: marked(motion%plan%n_links)
    integer :: i, m, n, links

    m = motion%plan%n_coordinates
    n = motion%n_parameters
    links = motion%plan%n_links
    self%acting = [(i, i=1, size(model%mechanism%loads))]
    marked = .false.
    self%is_loaded = size(model%mechanism%loads) > 0 .or. size(model%mechanism%motors) > 0
    do i = 1, size(self%acting)
      call model%mechanism%loads(i)%load%mark_links(marked)
    end do
    do i = 1, size(model%mechanism%motors)
      call model%mechanism%motors(i)%motor%mark_links(marked)
    end do
    self%loaded = pack([(i, i=2, links)], marked(2:))
    allocate (self%view%links(links), self%view%q(m), self%view%dq(m))
    self%change = new_motion_change(links, m)
    self%sum = new_force_sum(links, m)
    self%sum_change = new_force_sum(links, m)
    self%loops = new_loop_forces(motion%plan)
    allocate (self%chains(size(motion%plan%closures)))
    allocate (self%forces(m), self%changes(n, m), self%wrench(6, 0:m), self%wrenches(n, 6, 0:m), source=0.0_wp)
    if (.not. present(with_links)) return
    if (.not. with_links) return
    allocate (self%links)
    allocate (self%links%wrench(6, links), self%links%wrenches(n, 6, links), self%links%along(m), self%links%alongs(n, m), &
              self%links%largest(m), self%links%largest_changes(n, m), self%links%coupling(n, size(motion%plan%couplings)), &
              source=0.0_wp)
  end subroutine new_varied_forces

  !> The forces of the present motion and their derivatives, after find_varied_motion for this motion. Fails where a load does.
  subroutine find_varied_forces(model, motion, self, err)
    type(model_type), intent(in) :: model                  !< the model
    type(varied_motion_type), intent(inout) :: motion      !< derivatives of its motion; its blocks serve as scratch
    type(varied_forces_type), intent(inout) :: self        !< gets the forces
    type(error_type), allocatable, intent(out) :: err      !< allocated if it failed
    integer :: i

    self%wrench = 0.0_wp
    self%wrenches = 0.0_wp
    self%changes = 0.0_wp
    call add_bodies(model, motion, self)
    if (self%is_loaded) call add_loads(model, motion, self, err)
    if (allocated(err)) return
    if (allocated(motion%friction)) then
      do i = 1, size(motion%friction, 2)
        associate (k => model%mechanism%frictions(i)%coordinate)
          self%changes(:, k) = self%changes(:, k) - motion%friction(:, i)
        end associate
      end do
    end if
    if (allocated(self%links)) call keep_required(motion%plan, self)
    call find_forces(motion, self)
    call hold_chains(motion%plan, motion, self)
    call vary_required(motion%plan, motion, self)
    call eliminate_changes(model, motion%plan, motion, self)
  end subroutine find_varied_forces

  !> Keep what links require, and the loads on coordinates.
  subroutine keep_required(plan, self)
    type(plan_type), intent(in) :: plan                    !< the plan of the mechanism, in space
    type(varied_forces_type), intent(inout) :: self        !< with the wrenches of each frame
    integer :: i

    do i = 1, plan%n_links
      self%links%wrench(:, i) = self%wrench(:, plan%frame_of(i))
      self%links%wrenches(:, :, i) = self%wrenches(:, :, plan%frame_of(i))
    end do
    self%links%along = 0.0_wp
    if (self%is_loaded) self%links%along = self%sum%generalized
    self%links%alongs = -self%changes
    self%links%largest = 0.0_wp
    self%links%largest_changes = 0.0_wp
  end subroutine keep_required

  !> Add the inertial forces of all bodies, less their weights, and the derivatives.
  subroutine add_bodies(model, motion, self)
    type(model_type), intent(in) :: model               !< the model
    type(varied_motion_type), intent(in) :: motion      !< derivatives of its motion
    type(varied_forces_type), intent(inout) :: self     !< gets the forces
    real(wp) :: twists(motion%n_parameters, 6, 0:2)
    integer :: i

    do i = 1, size(model%mechanism%bodies)
      associate (body => model%mechanism%bodies(i))
        if (body%link == 1 .or. .not. body%has_inertia()) cycle
        call link_twists(motion, body%link, twists)
        call add_body(model, i, twists, motion, self)
      end associate
    end do
  end subroutine add_bodies

  !> Add the inertial force of one body, less its weight, and the derivatives.
  subroutine add_body(model, number, twists, motion, self)
    type(model_type), intent(in) :: model               !< the model
    integer, intent(in) :: number                       !< of the body
    real(wp), intent(in) :: twists(:, :, 0:)            !< (P,6,0:2) of its link
    type(varied_motion_type), intent(in) :: motion      !< derivatives of the motion
    type(varied_forces_type), intent(inout) :: self     !< gets the forces
    type(inertia_type) :: body, changed
    real(wp) :: r(3, 3), velocity(6), proper(6), h(6), wrench(6)
    real(wp), dimension(motion%n_parameters, 6) :: change, h_change, proper_change
    integer :: f, p

    f = motion%plan%frame_of(model%mechanism%bodies(number)%link)
    call place_body(model, number, motion, r, body)
    velocity = motion%motion%velocity(:, f)
    proper = motion%motion%acceleration(:, f)
    proper(4:6) = proper(4:6) - model%mechanism%gravity
    h = momentum(body, velocity)
    wrench = momentum(body, proper) + crossed(velocity, h)
    ! seen by an observer who moves with the link
    proper_change = twists(:, :, 2)
    call add_bracket(twists(:, :, 1), velocity, proper_change)
    call add_bracket(twists(:, :, 0), [0.0_wp, 0.0_wp, 0.0_wp, model%mechanism%gravity], proper_change)
    do p = 1, motion%n_parameters
      proper_change(p, 4:6) = proper_change(p, 4:6) - motion%tangents(p)%gravity
    end do
    call momenta(body, proper_change, change)
    call add_turned_wrench(twists(:, :, 1), h, change)
    call momenta(body, twists(:, :, 1), h_change)
    do p = 1, motion%n_parameters
      associate (part => motion%tangents(p)%bodies(number))
        if (part%varies) then
          changed = change_of_body(part%change, r)
          change(p, :) = change(p, :) + change_of_momentum(body, changed, proper)
          h_change(p, :) = h_change(p, :) + change_of_momentum(body, changed, velocity)
        end if
      end associate
      change(p, :) = change(p, :) + crossed(velocity, h_change(p, :))
    end do
    call add_turned_wrench(twists(:, :, 0), wrench, change)
    self%wrench(:, f) = self%wrench(:, f) + wrench
    self%wrenches(:, :, f) = self%wrenches(:, :, f) + change
  end subroutine add_body

  !> Subtract the loads and their derivatives.
  subroutine add_loads(model, motion, self, err)
    type(model_type), intent(in) :: model               !< the model
    type(varied_motion_type), intent(in) :: motion      !< derivatives of its motion
    type(varied_forces_type), intent(inout) :: self     !< gets the forces
    type(error_type), allocatable, intent(out) :: err   !< allocated if a load failed
    real(wp) :: twists(motion%n_parameters, 6, 0:2, size(self%loaded)), wrench(6), change(6), place(3)
    integer :: i, k, p, f

    call sum_forces(model%mechanism, motion%plan, self%acting, self%loaded, motion%state, self%view, self%sum, err)
    if (allocated(err)) return
    do i = 1, size(self%loaded)
      k = self%loaded(i)
      f = motion%plan%frame_of(k)
      call link_twists(motion, k, twists(:, :, :, i))
      place = self%view%links(k)%p - motion%plan%origin
      wrench = [self%sum%torque(:, k) + cross(place, self%sum%force(:, k)), self%sum%force(:, k)]
      self%wrench(:, f) = self%wrench(:, f) - wrench
    end do
    do p = 1, motion%n_parameters
      call show_change(p, twists, motion, self%loaded, self%view, self%change)
      call vary_loads(model, p, motion, self, err)
      if (allocated(err)) return
      if (allocated(motion%contact)) call add_contacts(model, reshape(motion%contact(p, :), [3, size(motion%contact, 2)/3]), self)
      do i = 1, size(self%loaded)
        k = self%loaded(i)
        f = motion%plan%frame_of(k)
        place = self%view%links(k)%p - motion%plan%origin
        associate (force => self%sum_change%force(:, k))
          change = [self%sum_change%torque(:, k) + cross(place, force) + cross(self%change%links(k)%shift, self%sum%force(:, k)), &
                    force]
        end associate
        self%wrenches(p, :, f) = self%wrenches(p, :, f) - change
      end do
      self%changes(p, :) = self%changes(p, :) - self%sum_change%generalized
    end do
  end subroutine add_loads

  !> The derivatives of all loads and motors by one parameter.
  subroutine vary_loads(model, p, motion, self, err)
    type(model_type), intent(in) :: model               !< the model
    integer, intent(in) :: p                            !< number of the parameter
    type(varied_motion_type), intent(in) :: motion      !< derivatives of its motion
    type(varied_forces_type), intent(inout) :: self     !< with the change of the motion; gets the sums
    type(error_type), allocatable, intent(out) :: err   !< allocated if a load failed
    integer :: i

    call self%sum_change%clear()
    do i = 1, size(self%acting)
      associate (load => model%mechanism%loads(i)%load, part => motion%tangents(p)%loads(i))
        call load%vary(self%view, self%change, self%sum_change, err)
        if (part%varies .and. .not. allocated(err)) call load%vary_numbers(part%change, self%view, self%sum_change, err)
      end associate
      if (allocated(err)) return
    end do
    do i = 1, size(model%mechanism%motors)
      associate (motor => model%mechanism%motors(i)%motor, part => motion%tangents(p)%motors(i))
        call motor%vary(self%view, self%change, self%sum_change, err)
        if (part%varies .and. .not. allocated(err)) call motor%vary_numbers(part%change, self%view, self%sum_change, err)
      end associate
      if (allocated(err)) return
    end do
  end subroutine vary_loads

  !> Add the derivatives of the forces of rigid contacts, which their loads hold.
  subroutine add_contacts(model, forces, self)
    type(model_type), intent(in) :: model               !< the model
    real(wp), intent(in) :: forces(:, :)                !< (3,contacts) derivatives by one parameter, fixed axes [N]
    type(varied_forces_type), intent(inout) :: self     !< with the motion as loads read it; its sums grow
    type(contact_place_type) :: place
    integer :: stretch(size(forces, 2))
    integer :: i, side

    stretch = 0
    if (allocated(self%view%stretch)) stretch = self%view%stretch
    do i = 1, size(forces, 2)
      if (.not. any(abs(forces(:, i)) > 0.0_wp)) cycle
      associate (contact => model%mechanism%contacts(i), links => self%view%links, sum => self%sum_change)
        place = contact%find_place(links(contact%links(1)), links(contact%links(2)), stretch(i))
        do side = 1, 2
          associate (k => contact%links(side), force => (3 - 2*side)*forces(:, i))
            sum%force(:, k) = sum%force(:, k) + force
            sum%torque(:, k) = sum%torque(:, k) + cross(place%at - links(k)%p, force)
          end associate
        end do
      end associate
    end do
  end subroutine add_contacts

  !> The change of the motion by one parameter, as loads read it.
  subroutine show_change(p, twists, motion, loaded, view, change)
    integer, intent(in) :: p                             !< number of the parameter
    real(wp), intent(in) :: twists(:, :, 0:, :)          !< (P,6,0:2,loaded) of the links
    type(varied_motion_type), intent(in) :: motion       !< derivatives of the motion
    integer, intent(in) :: loaded(:)                     !< links whose motion is read
    type(motion_view_type), intent(in) :: view           !< their motion
    type(motion_change_type), intent(inout) :: change    !< gets the change of coordinates and these links
    real(wp) :: place(3), twist(6), rate(6)
    integer :: i

    change%q = motion%q(p, 0, :)
    change%dq = motion%q(p, 1, :)
    change%motor = motion%motor(p, :)
    do i = 1, size(loaded)
      twist = twists(p, :, 0, i)
      rate = twists(p, :, 1, i)
      associate (link => view%links(loaded(i)), varied => change%links(loaded(i)))
        place = link%p - motion%plan%origin
        varied%turn = twist(1:3)
        varied%shift = shift_at(twist, place)
        varied%omega = rate(1:3) + cross(twist(1:3), link%omega)
        varied%v = shift_at(rate, place) + cross(twist(1:3), link%v)
      end associate
    end do
  end subroutine show_change

  !> The forces that the coordinates require, and those of the closed chains.
  subroutine find_forces(motion, self)
    type(varied_motion_type), intent(inout) :: motion      !< with the present motion; its blocks serve as scratch
    type(varied_forces_type), intent(inout) :: self        !< with the wrenches of each frame; gets the forces
    real(wp) :: sums(6, 0:motion%plan%n_coordinates)
    integer :: b, s, k

    associate (plan => motion%plan)
      sums = self%wrench
      self%forces = 0.0_wp
      do b = size(plan%blocks), 1, -1
        do s = plan%blocks(b)%last_step, plan%blocks(b)%first_step, -1
          k = plan%steps(s)%coordinate
          self%forces(k) = dot_product(motion%motion%step(:, 0, s), sums(:, s))
          if (self%is_loaded) self%forces(k) = self%forces(k) - self%sum%generalized(k)
          sums(:, plan%steps(s)%parent) = sums(:, plan%steps(s)%parent) + sums(:, s)
        end do
      end do
      call eliminate_dependent(plan, motion%state, motion%blocks, self%loops, self%forces)
      self%loops_held = self%loops
      call loop_wrenches(plan, motion%state, self%loops, self%chains)
    end associate
  end subroutine find_forces

  !> Subtract the forces of the closed chains from those of their frames, and their derivatives.
  subroutine hold_chains(plan, motion, self)
    type(plan_type), intent(in) :: plan                  !< the plan of the mechanism, in space
    type(varied_motion_type), intent(in) :: motion       !< with the present motion
    type(varied_forces_type), intent(inout) :: self      !< with the forces of the chains; its wrenches change
    real(wp) :: wrench(6)
    integer :: b, c

    do b = 1, size(plan%blocks)
      do c = plan%blocks(b)%first_closure, plan%blocks(b)%last_closure
        if (plan%closures(c)%coupling > 0) cycle
        associate (base => plan%closures(c)%base, closing => plan%closures(c)%closing, target => plan%closures(c)%target, &
                   state => motion%state)
          wrench(4:6) = turn(state%r(:, :, base), self%chains(c)%force)
          wrench(1:3) = turn(state%r(:, :, base), self%chains(c)%moment) + cross(state%p(:, base), wrench(4:6))
          self%wrench(:, closing) = self%wrench(:, closing) - wrench
          self%wrench(:, target) = self%wrench(:, target) + wrench
          call add_turned_wrench(motion%twists(:, :, 0, base), -wrench, self%wrenches(:, :, closing))
          call add_turned_wrench(motion%twists(:, :, 0, base), wrench, self%wrenches(:, :, target))
        end associate
      end do
    end do
  end subroutine hold_chains

  !> The derivatives of the forces that all coordinates require, with the forces of closed chains held.
  subroutine vary_required(plan, motion, self)
    type(plan_type), intent(in) :: plan                  !< the plan of the mechanism, in space
    type(varied_motion_type), intent(in) :: motion       !< derivatives of the motion
    type(varied_forces_type), intent(inout) :: self      !< with wrenches and derivatives of each frame; gets `changes`
    real(wp) :: step_changes(motion%n_parameters, 6)
    integer :: b, s, k, j

    do b = size(plan%blocks), 1, -1
      do s = plan%blocks(b)%last_step, plan%blocks(b)%first_step, -1
        k = plan%steps(s)%coordinate
        call vary_step(plan, motion, s, motion%twists(:, :, 0, plan%steps(s)%parent), step_changes)
        do j = 1, 6
          self%changes(:, k) = self%changes(:, k) + motion%motion%step(j, 0, s)*self%wrenches(:, j, s) &
                               + step_changes(:, j)*self%wrench(j, s)
        end do
        associate (i => plan%steps(s)%parent)
          self%wrench(:, i) = self%wrench(:, i) + self%wrench(:, s)
          self%wrenches(:, :, i) = self%wrenches(:, :, i) + self%wrenches(:, :, s)
        end associate
      end do
    end do
  end subroutine vary_required

  !> The derivatives of the twist of a step per unit rate.
  subroutine vary_step(plan, motion, s, parent_twists, changes)
    type(plan_type), intent(in) :: plan                  !< the plan of the mechanism, in space
    type(varied_motion_type), intent(in) :: motion       !< derivatives of the motion
    integer, intent(in) :: s                             !< the step
    real(wp), intent(in) :: parent_twists(:, :)          !< (P,6) of its parent frame
    real(wp), intent(out) :: changes(:, :)               !< (P,6)
    real(wp) :: departing(motion%n_parameters, 6), axis_rate(6)
    integer :: p, k

    k = plan%steps(s)%coordinate
    departing = departing_twists(plan, motion, s, parent_twists)
    changes = 0.0_wp
    call add_bracket(departing, motion%motion%step(:, 0, s), changes)
    associate (state => motion%state)
      do p = 1, motion%n_parameters
        changes(p, 4:6) = changes(p, 4:6) + motion%tangents(p)%slide(k)*state%r(:, 3, s)
      end do
      if (plan%steps(s)%is_screw) return
      axis_rate(1:3) = state%axis_w_rate(:, s)
      axis_rate(4:6) = state%axis_v_rate(:, s) - cross(axis_rate(1:3), state%p(:, s)) - cross(state%axis_w(:, s), state%axis_v(:, &
                                                                                                                               s))
      do p = 1, motion%n_parameters
        changes(p, :) = changes(p, :) + motion%q(p, 0, k)*axis_rate
      end do
    end associate
    do p = 1, size(motion%pairs)
      associate (pair => motion%pairs(p))
        if (pair%step == s) changes(pair%parameter, :) = changes(pair%parameter, :) + pair%slope &
                                                         + bracket(pair%twists(:, 0), motion%motion%step(:, 0, s))
      end associate
    end do
  end subroutine vary_step

  !> The twists of the frame from which a step departs, with the axis of its pair.
  function departing_twists(plan, motion, s, parent_twists) result(twists)
    type(plan_type), intent(in) :: plan                  !< the plan of the mechanism, in space
    type(varied_motion_type), intent(in) :: motion       !< derivatives of the motion
    integer, intent(in) :: s                             !< the step
    real(wp), intent(in) :: parent_twists(:, :)          !< (P,6) of its parent frame
    real(wp) :: twists(motion%n_parameters, 6), series(6, 0:2)
    integer :: p

    twists = parent_twists
    associate (step => plan%steps(s))
      do p = 1, motion%n_parameters
        if (.not. motion%tangents(p)%moves(step%coordinate)) cycle
        call carried(motion%state, motion%motion, step%parent, motion%tangents(p)%before(:, step%coordinate), 0, series)
        twists(p, :) = twists(p, :) + series(:, 0)
      end do
    end associate
  end function departing_twists

  !> Add the derivatives of the forces of couplings, and hand on those of dependent coordinates to the independent ones.
  subroutine eliminate_changes(model, plan, motion, self)
    type(model_type), intent(in) :: model                  !< the model
    type(plan_type), intent(in) :: plan                    !< the plan of the mechanism, in space
    type(varied_motion_type), intent(inout) :: motion      !< derivatives of the motion; its blocks serve as scratch
    type(varied_forces_type), intent(inout) :: self        !< with `changes` of all coordinates
    real(wp) :: forces(plan%n_coordinates), q(plan%n_coordinates)
    integer :: p

    if (size(plan%closures) == 0) return
    do p = 1, motion%n_parameters
      forces = self%changes(p, :)
      q = motion%q(p, 0, :)
      call vary_couplings(plan, motion%state, self%loops_held, q, forces)
      call vary_coupling_numbers(model, plan, motion, self%loops_held, p, forces)
      call eliminate_dependent(plan, motion%state, motion%blocks, self%loops, forces)
      self%changes(p, :) = forces
      if (allocated(self%links)) call keep_couplings(model, motion, p, self%loops_held, self%loops, self%links)
    end do
    if (allocated(self%links)) call add_couplings(plan, motion%state, self%loops_held, self%links)
  end subroutine eliminate_changes

end module mech9_varied_forces
