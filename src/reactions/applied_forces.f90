!> The forces that act on links one by one, for pictures: those of loads, with the points at which they act, and weights.
!>
!> Forces on coordinates, of springs there, motors and drives, are part of the wrenches of their pairs (mech9_reactions). Those of
!> stops, contacts and friction are found by mech9_touching_forces.
module mech9_applied_forces
  use mech9_kinds, only: wp
  use mech9_error, only: error_type
  use mech9_rotation, only: turn, cross
  use mech9_mechanism, only: mechanism_type
  use mech9_load, only: load_type
  use mech9_force_load, only: force_load_type
  use mech9_spring_load, only: spring_load_type
  use mech9_procedure_load, only: procedure_load_type
  use mech9_motion_view, only: motion_view_type
  use mech9_force_sum, only: force_sum_type, new_force_sum
  use mech9_plan, only: plan_type
  use mech9_state, only: state_type
  use mech9_generalized_forces, only: sum_loads
  implicit none
  private
  public :: applied_force_type, applied_forces_type, new_applied_forces

  !> One force or torque on a link.
  type :: applied_force_type
    integer :: load = 0                 !< number of the load; 0: a weight
    logical :: is_torque = .false.      !< a torque [N m], no force [N]
    integer :: link = 1                 !< on which it acts
    real(wp) :: foot(3) = 0.0_wp        !< the point at which it acts, in the link's system [m]
  end type applied_force_type

  !> All of them, and scratch. They are listed whether they are zero or not.
  type :: applied_forces_type
    type(applied_force_type), allocatable :: items(:)
    integer, allocatable, private :: loaded(:)         !< links on whose motion loads depend
    type(motion_view_type), private :: view            !< the motion as loads read it
    type(force_sum_type), private :: sum               !< of one load
  contains
    procedure :: find
  end type applied_forces_type

contains

  !> List the forces on links: those of each load in the order of the data file, then the weights.
  subroutine new_applied_forces(mechanism, self)
    type(mechanism_type), intent(in) :: mechanism       !< the mechanism
    type(applied_forces_type), intent(out) :: self      !< gets the list
    logical :: loaded(mechanism%structure%n_links), marked(mechanism%structure%n_links)
    integer :: i, k

    allocate (self%items(0))
    loaded = .false.
    do i = 1, size(mechanism%loads)
      associate (load => mechanism%loads(i)%load)
        if (.not. acts_on_links(load)) cycle
        marked = .false.
        call load%mark_links(marked)
        loaded = loaded .or. marked
        do k = 2, mechanism%structure%shown_links()
          if (.not. marked(k)) cycle
          self%items = [self%items, applied_force_type(i, .false., k, foot_of(load, k)), &
                        applied_force_type(i, .true., k, foot_of(load, k))]
        end do
      end associate
    end do
    do i = 1, size(mechanism%bodies)
      if (mechanism%bodies(i)%link > 1) &
        self%items = [self%items, applied_force_type(0, .false., mechanism%bodies(i)%link, mechanism%bodies(i)%centre)]
    end do
    self%loaded = pack([(k, k=1, size(loaded))], loaded)
    associate (n => mechanism%structure%n_links, m => mechanism%structure%n_coordinates)
      allocate (self%view%links(n))
      allocate (self%view%q(m), self%view%dq(m), source=0.0_wp)
      self%sum = new_force_sum(n, m)
    end associate
  end subroutine new_applied_forces

  !> Whether a load is one of the data file that acts on links and may be other than zero.
  pure logical function acts_on_links(load)
    class(load_type), intent(in) :: load   !< any load

    acts_on_links = .false.
    select type (load)
    class is (force_load_type)
      acts_on_links = .not. load%is_idle()
    class is (spring_load_type)
      acts_on_links = .not. load%is_idle()
    class is (procedure_load_type)
      acts_on_links = .not. load%is_idle()
    end select
  end function acts_on_links

  !> The point of a link at which a load acts, in the link's system [m]; the origin for users' procedures, which do not tell it.
  pure function foot_of(load, link) result(foot)
    class(load_type), intent(in) :: load   !< the load
    integer, intent(in) :: link            !< number of a link that it marks
    real(wp) :: foot(3)

    foot = 0.0_wp
    select type (load)
    class is (force_load_type)
      if (load%link == link) foot = load%position
    class is (spring_load_type)
      if (load%links(1) == link) foot = load%positions(:, 1)
      if (load%links(2) == link) foot = load%positions(:, 2)
    end select
  end function foot_of

  !> The forces and torques in a state, in the axes of link 1. Fails where a load fails.
  subroutine find(self, mechanism, plan, state, vectors, err)
    class(applied_forces_type), intent(inout) :: self   !< the list
    type(mechanism_type), intent(in) :: mechanism       !< the mechanism
    type(plan_type), intent(in) :: plan                 !< its plan, with all blocks
    type(state_type), intent(in) :: state               !< positions and rates of coordinates and frames
    real(wp), intent(out) :: vectors(:, :)              !< (3,items) [N, N m]
    type(error_type), allocatable, intent(out) :: err   !< allocated if a load failed
    real(wp) :: arm(3)
    integer :: i, summed, k

    vectors = 0.0_wp
    summed = 0
    do i = 1, size(self%items)
      associate (item => self%items(i), sum => self%sum)
        if (item%load == 0) then
          k = findloc(mechanism%bodies%link, item%link, dim=1)
          vectors(:, i) = mechanism%bodies(k)%mass*mechanism%gravity
          cycle
        end if
        if (item%load /= summed) then
          call sum_loads(mechanism, plan, [item%load], self%loaded, state, self%view, sum, err)
          if (allocated(err)) return
          summed = item%load
        end if
        vectors(:, i) = sum%force(:, item%link)
        if (.not. item%is_torque) cycle
        ! the sum is about the origin of the link's system
        arm = turn(self%view%links(item%link)%r, item%foot)
        vectors(:, i) = sum%torque(:, item%link) - cross(arm, sum%force(:, item%link))
      end associate
    end do
  end subroutine find
end module mech9_applied_forces
