!> Loads in the derivatives of required forces: what they do to the wrenches that frames need, to the rows of a force in a virtual
!> motion, and to this force by numbers of their own.
!>
!> Kinds whose formula is not known, such as users' loads, have no rows. Their forces vary with the whole motion of each parameter, or,
!> where they act on free coordinates, as motors mostly do, with the motion of these alone.
module mech9_load_gradient
  use mech9_kinds, only: wp
  use mech9_error, only: error_type
  use mech9_rotation, only: cross
  use mech9_motion_view, only: motion_view_type
  use mech9_load, only: load_type
  use mech9_motion_change, only: motion_change_type, link_change_type, new_motion_change
  use mech9_force_sum, only: force_sum_type, new_force_sum
  use mech9_model, only: model_type
  use mech9_plan, only: plan_type
  use mech9_state, only: state_type
  use mech9_generalized_forces, only: sum_forces
  use mech9_tangent, only: tangent_type, law_tangent_type
  use mech9_twists, only: shift_at
  use mech9_varied_motion, only: varied_motion_type, link_twists
  use mech9_varied_forces, only: show_change
  use mech9_gradient_arithmetic, only: gradient_arithmetic_type
  use mech9_gradient_rows, only: gradient_rows_type, subtract_crossed, pairing
  implicit none
  private
  public :: load_gradient_type, new_load_gradient, reads_motions, find_loads, add_load_rows, vary_loads, by_loads

  !> A load or a motor whose forces change with a parameter, by numbers of its own or by the motion that it reads.
  type :: changed_load_type
    integer :: parameter = 0                       !< number of the parameter
    integer :: load = 0                            !< number of the load; 0: it is a motor
    integer :: motor = 0                           !< number of the motor; 0: it is a load
    logical :: by_motion = .false.                 !< they change with the motion
    logical :: by_free = .false.                   !< they change with the motion of free coordinates alone
    integer, allocatable :: links(:)               !< on which it acts, and whose motion it reads
    integer, allocatable :: coordinates(:)         !< on which it acts, and which it reads
    real(wp), allocatable :: wrenches(:, :)        !< (d,links) change of its forces on these links
    real(wp), allocatable :: generalized(:)        !< change of its forces on these coordinates
  end type changed_load_type

  !> The loads and motors of a mechanism.
  type :: load_gradient_type
    logical, private :: is_loaded = .false.                      !< there are loads that act, or motors
    integer, allocatable, private :: acting(:)                   !< numbers of the loads
    integer, allocatable, private :: links(:)                    !< links on which they act, and whose motion they read
    integer, allocatable, private :: coordinates(:)              !< coordinates alike
    type(changed_load_type), allocatable, private :: changed(:)  !< loads whose forces change beside the rows
    type(motion_view_type), private :: view                      !< the motion as loads read it
    type(motion_change_type), private :: moved                   !< its change by a parameter
    type(force_sum_type), private :: sum, change                 !< sums of all loads; the change of one of them
    type(motion_change_type), private :: virtual                 !< a virtual motion as loads read it
    type(motion_change_type), private :: slopes                  !< derivatives of the power of the loads in this motion
  end type load_gradient_type

contains

  !> Whether some loads vary with the whole motion of each parameter, beyond that of the free coordinates.
  pure logical function reads_motions(self)
    type(load_gradient_type), intent(in) :: self     !< the loads

    reads_motions = any(self%changed%by_motion .and. .not. self%changed%by_free)
  end function reads_motions

  !> Room for the loads of a model.
  subroutine new_load_gradient(model, plan, d, tangents, self)
    type(model_type), intent(in) :: model            !< the model
    type(plan_type), intent(in) :: plan              !< its plan
    integer, intent(in) :: d                         !< numbers of a wrench
    type(tangent_type), intent(in) :: tangents(:)    !< derivatives of the constants by each parameter
    type(load_gradient_type), intent(out) :: self    !< the loads
    logical :: acts(size(model%mechanism%loads)), varies(size(tangents))
    logical :: of_links(plan%n_links), of_coordinates(plan%n_coordinates)
    integer :: i, p

    allocate (self%changed(0))
    of_links = .false.
    of_coordinates = .false.
    do i = 1, size(acts)
      associate (load => model%mechanism%loads(i)%load)
        varies = [(tangents(p)%loads(i)%varies, p=1, size(tangents))]
        call append(load, plan, d, varies, changed_load_type(load=i), self%changed)
        acts(i) = any(varies) .or. .not. load%is_idle()
        if (acts(i)) call mark(load, of_links, of_coordinates)
      end associate
    end do
    do i = 1, size(model%mechanism%motors)
      associate (motor => model%mechanism%motors(i)%motor)
        varies = [(tangents(p)%motors(i)%varies, p=1, size(tangents))]
        call append(motor, plan, d, varies, changed_load_type(motor=i), self%changed)
        call mark(motor, of_links, of_coordinates)
      end associate
    end do
    self%acting = pack([(i, i=1, size(acts))], acts)
    self%is_loaded = size(self%acting) > 0 .or. size(model%mechanism%motors) > 0
    call list_marked(of_links, of_coordinates, self%links, self%coordinates)
    associate (n => plan%n_links, m => plan%n_coordinates)
      allocate (self%view%links(n), self%view%q(m), self%view%dq(m))
      self%sum = new_force_sum(n, m)
      self%change = new_force_sum(n, m)
      self%virtual = new_motion_change(n, m)
      self%slopes = new_motion_change(n, m)
      self%moved = new_motion_change(n, m)
    end associate
  end subroutine new_load_gradient

  !> Append a load to the list for each parameter by which its forces change: by its own numbers, and by the motion where its slopes
  !> are not known.
  subroutine append(load, plan, d, varies, one, list)
    class(load_type), intent(in) :: load                            !< the load
    type(plan_type), intent(in) :: plan                             !< its plan
    integer, intent(in) :: d                                        !< numbers of a wrench
    logical, intent(in) :: varies(:)                                !< (P) its own numbers vary with the parameter
    type(changed_load_type), intent(in) :: one                      !< with its number
    type(changed_load_type), allocatable, intent(inout) :: list(:)  !< the list that grows
    type(changed_load_type) :: whole
    logical :: of_links(plan%n_links), of_coordinates(plan%n_coordinates)
    integer :: i, p

    whole = one
    of_links = .false.
    of_coordinates = .false.
    call mark(load, of_links, of_coordinates)
    call list_marked(of_links, of_coordinates, whole%links, whole%coordinates)
    whole%by_free = size(whole%links) == 0
    do i = 1, size(whole%coordinates)
      whole%by_free = whole%by_free .and. any(plan%free == whole%coordinates(i))
    end do
    allocate (whole%wrenches(d, size(whole%links)), whole%generalized(size(whole%coordinates)), source=0.0_wp)
    do p = 1, size(varies)
      whole%parameter = p
      whole%by_motion = .false.
      if (varies(p)) list = [list, whole]
      whole%by_motion = .true.
      if (.not. load%knows_slopes()) list = [list, whole]
    end do
  end subroutine append

  !> Mark the links and coordinates on which a load depends or acts.
  pure subroutine mark(load, of_links, of_coordinates)
    class(load_type), intent(in) :: load              !< the load
    logical, intent(inout) :: of_links(:)             !< (N) becomes true for these links
    logical, intent(inout) :: of_coordinates(:)       !< (M) becomes true for these coordinates

    call load%mark_links(of_links)
    call load%mark_coordinates(of_coordinates)
  end subroutine mark

  !> List the marked links but link 1, and the marked coordinates.
  pure subroutine list_marked(of_links, of_coordinates, links, coordinates)
    logical, intent(in) :: of_links(:)                    !< (N) true for marked ones
    logical, intent(in) :: of_coordinates(:)              !< (M) true for marked ones
    integer, allocatable, intent(out) :: links(:)         !< numbers of the links
    integer, allocatable, intent(out) :: coordinates(:)   !< numbers of the coordinates
    integer :: i

    links = pack([(i, i=2, size(of_links))], of_links(2:))
    coordinates = pack([(i, i=1, size(of_coordinates))], of_coordinates)
  end subroutine list_marked

  !> Find the forces of all loads, and subtract them from what frames and coordinates need. Fails where a load does.
  subroutine find_loads(model, plan, state, arithmetic, self, held, err)
    type(model_type), intent(in) :: model                        !< the model
    type(plan_type), intent(in) :: plan                          !< the plan in which the motion is given
    type(state_type), intent(in) :: state                        !< the motion
    class(gradient_arithmetic_type), intent(in) :: arithmetic    !< of the wrenches
    type(load_gradient_type), intent(inout) :: self              !< gets the forces
    type(gradient_rows_type), intent(inout) :: held              !< of order 2: what frames and coordinates need
    type(error_type), allocatable, intent(out) :: err            !< allocated if it failed
    real(wp) :: wrench(size(held%frames, 1))
    integer :: i, k

    if (.not. self%is_loaded) return
    call sum_forces(model%mechanism, plan, self%acting, self%links, state, self%view, self%sum, err)
    if (allocated(err)) return
    do i = 1, size(self%links)
      k = self%links(i)
      call link_wrench(plan, arithmetic, self%view, self%sum, k, wrench)
      associate (f => plan%frame_of(k))
        held%frames(:, 2, f) = held%frames(:, 2, f) - wrench
      end associate
    end do
    do i = 1, size(self%coordinates)
      k = self%coordinates(i)
      held%coordinates(2, k) = held%coordinates(2, k) - self%sum%generalized(k)
    end do
  end subroutine find_loads

  !> The wrench of a sum of loads on a link, about the origin of frame 0.
  subroutine link_wrench(plan, arithmetic, view, sum, link, wrench)
    type(plan_type), intent(in) :: plan                          !< the plan
    class(gradient_arithmetic_type), intent(in) :: arithmetic    !< of the wrench
    type(motion_view_type), intent(in) :: view                   !< the motion as loads read it
    type(force_sum_type), intent(in) :: sum                      !< the loads
    integer, intent(in) :: link                                  !< number of the link
    real(wp), intent(out) :: wrench(:)                           !< (d) the wrench
    real(wp) :: whole(6)

    whole(1:3) = sum%torque(:, link) + cross(view%links(link)%p - plan%origin, sum%force(:, link))
    whole(4:6) = sum%force(:, link)
    call arithmetic%reduced_wrench(whole, wrench)
  end subroutine link_wrench

  !> Subtract the rows of the loads' power in a virtual motion from those of a force. Fails where a load does.
  subroutine add_load_rows(model, plan, arithmetic, virtual, rates, self, rows, err)
    type(model_type), intent(in) :: model                        !< the model
    type(plan_type), intent(in) :: plan                          !< the plan
    class(gradient_arithmetic_type), intent(in) :: arithmetic    !< of the rows
    real(wp), intent(in), contiguous :: virtual(:, 0:)           !< (d,0:M) twists of the frames in the virtual motion
    real(wp), intent(in) :: rates(:)                             !< (M) rates of the coordinates in it
    type(load_gradient_type), intent(inout) :: self              !< with the motion as loads read it
    type(gradient_rows_type), intent(inout) :: rows              !< gets the rows
    type(error_type), allocatable, intent(out) :: err            !< allocated if it failed
    integer :: i, k

    if (.not. self%is_loaded) return
    self%slopes%links(1) = link_change_type()
    do i = 1, size(self%links)
      k = self%links(i)
      self%virtual%links(k) = virtual_link(plan, arithmetic%twist_in_space(virtual(:, plan%frame_of(k))), self%view%links(k)%p)
      self%slopes%links(k) = link_change_type()
    end do
    do i = 1, size(self%coordinates)
      k = self%coordinates(i)
      self%virtual%q(k) = rates(k)
      self%slopes%q(k) = 0.0_wp
      self%slopes%dq(k) = 0.0_wp
    end do
    do i = 1, size(self%acting)
      call model%mechanism%loads(self%acting(i))%load%add_slopes(self%view, self%virtual, self%slopes, err)
      if (allocated(err)) return
    end do
    do i = 1, size(self%links)
      call subtract_slopes(plan, arithmetic, virtual, self%links(i), self, rows)
    end do
    do i = 1, size(self%coordinates)
      k = self%coordinates(i)
      rows%coordinates(0, k) = rows%coordinates(0, k) - self%slopes%q(k)
      rows%coordinates(1, k) = rows%coordinates(1, k) - self%slopes%dq(k)
    end do
  end subroutine add_load_rows

  !> The virtual motion of a link as loads read it.
  pure function virtual_link(plan, twist, origin) result(change)
    type(plan_type), intent(in) :: plan      !< the plan
    real(wp), intent(in) :: twist(6)         !< of the link
    real(wp), intent(in) :: origin(3)        !< of its own system, in the system of link 1 [m]
    type(link_change_type) :: change

    change%turn = twist(1:3)
    change%shift = shift_at(twist, origin - plan%origin)
  end function virtual_link

  !> Subtract the derivatives of the loads' power by the motion of one link from the rows of its frame. The wrench of the loads counts
  !> there as one that moves with the frame, which it does not.
  subroutine subtract_slopes(plan, arithmetic, virtual, link, self, rows)
    type(plan_type), intent(in) :: plan                          !< the plan
    class(gradient_arithmetic_type), intent(in) :: arithmetic    !< of the rows
    real(wp), intent(in), contiguous :: virtual(:, 0:)           !< (d,0:M) twists of the frames in the virtual motion
    integer, intent(in) :: link                                  !< number of the link
    type(load_gradient_type), intent(in) :: self                 !< with the slopes
    type(gradient_rows_type), intent(inout) :: rows              !< gets the rows
    real(wp) :: whole(6), shift(3), place(3), row(size(virtual, 1)), wrench(size(virtual, 1))
    integer :: f

    f = plan%frame_of(link)
    associate (slopes => self%slopes%links(link), moves => self%view%links(link))
      place = moves%p - plan%origin
      ! the point whose virtual shift does the work moves, too
      shift = slopes%shift + cross(self%sum%force(:, link), self%virtual%links(link)%turn)
      whole(1:3) = slopes%turn + cross(place, shift) + cross(moves%omega, slopes%omega) + cross(moves%v, slopes%v)
      whole(4:6) = shift
      call arithmetic%reduced_wrench(whole, row)
      call link_wrench(plan, arithmetic, self%view, self%sum, link, wrench)
      rows%frames(:, 0, f) = rows%frames(:, 0, f) - row
      call subtract_crossed(size(row), virtual(:, f), wrench, rows%frames(:, 0, f))
      whole(1:3) = slopes%omega + cross(place, slopes%v)
      whole(4:6) = slopes%v
      call arithmetic%reduced_wrench(whole, row)
      rows%frames(:, 1, f) = rows%frames(:, 1, f) - row
    end associate
  end subroutine subtract_slopes

  !> Find the changes of the loads' forces beside their rows: by their own numbers, and by the motion. Fails where a load does.
  subroutine vary_loads(model, arithmetic, motion, self, err)
    type(model_type), intent(in) :: model                        !< the model
    class(gradient_arithmetic_type), intent(in) :: arithmetic    !< of the wrenches
    type(varied_motion_type), intent(in) :: motion               !< derivatives of constants, and of the motion where loads read it
    type(load_gradient_type), intent(inout) :: self              !< with the motion as loads read it; gets the changes
    type(error_type), allocatable, intent(out) :: err            !< allocated if it failed
    real(wp) :: twists(merge(motion%n_parameters, 0, reads_motions(self)), 6, 0:2, size(self%links))
    integer :: i, j

    if (size(twists) > 0) then
      do j = 1, size(self%links)
        call link_twists(motion, self%links(j), twists(:, :, :, j))
      end do
    end if
    do i = 1, size(self%changed)
      associate (one => self%changed(i), tangent => motion%tangents(self%changed(i)%parameter))
        if (one%by_motion) call show_change(one%parameter, twists, motion, self%links(:merge(0, size(self%links), one%by_free)), &
                                            self%view, self%moved)
        if (one%motor > 0) then
          call find_change(model%mechanism%motors(one%motor)%motor, one%by_motion, tangent%motors(one%motor), self, err)
        else
          call find_change(model%mechanism%loads(one%load)%load, one%by_motion, tangent%loads(one%load), self, err)
        end if
        if (allocated(err)) return
        do j = 1, size(one%links)
          call link_wrench(motion%plan, arithmetic, self%view, self%change, one%links(j), one%wrenches(:, j))
        end do
        one%generalized = self%change%generalized(one%coordinates)
      end associate
    end do
  end subroutine vary_loads

  !> Find the change of the forces of one load. Fails where the load does.
  subroutine find_change(load, by_motion, part, self, err)
    class(load_type), intent(in) :: load                   !< the load
    logical, intent(in) :: by_motion                       !< by the change of the motion that is shown, not by its own numbers
    type(law_tangent_type), intent(in) :: part             !< change of its own numbers
    type(load_gradient_type), intent(inout) :: self        !< with the motion as loads read it; gets `change`
    type(error_type), allocatable, intent(out) :: err      !< allocated if it failed

    call self%change%clear()
    if (by_motion) then
      call load%vary(self%view, self%moved, self%change, err)
    else
      call load%vary_numbers(part%change, self%view, self%change, err)
    end if
  end subroutine find_change

  !> Subtract the changes of the loads' power in a virtual motion, beside the rows, from those of a force.
  pure subroutine by_loads(plan, virtual, rates, self, by_parameters)
    type(plan_type), intent(in) :: plan                  !< the plan
    real(wp), intent(in), contiguous :: virtual(:, 0:)   !< (d,0:M) twists of the frames in the virtual motion
    real(wp), intent(in) :: rates(:)                     !< (M) rates of the coordinates in it
    type(load_gradient_type), intent(in) :: self         !< with the changes
    real(wp), intent(inout) :: by_parameters(:)          !< (P) derivatives of the force by the parameters
    integer :: i, j

    do i = 1, size(self%changed)
      associate (one => self%changed(i))
        do j = 1, size(one%links)
          by_parameters(one%parameter) = by_parameters(one%parameter) &
                                         - pairing(size(virtual, 1), one%wrenches(:, j), virtual(:, plan%frame_of(one%links(j))))
        end do
        do j = 1, size(one%coordinates)
          by_parameters(one%parameter) = by_parameters(one%parameter) - one%generalized(j)*rates(one%coordinates(j))
        end do
      end associate
    end do
  end subroutine by_loads
end module mech9_load_gradient
