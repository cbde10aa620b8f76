!> A motion at one instant in the terms of mechanics: mass matrix, Jacobians of points and of dependent coordinates, and generalized
!> forces by their kinds, over the independent coordinates.
module mech9_instant
  use mech9_kinds, only: wp
  use mech9_error, only: error_type
  use mech9_rotation, only: turn, cross
  use mech9_pose, only: transformed
  use mech9_partition, only: partition_type, free_coordinate, driven_coordinate
  use mech9_mechanism, only: mechanism_type
  use mech9_model, only: model_type
  use mech9_plan, only: plan_type
  use mech9_state, only: state_type
  use mech9_motion_variation, only: vary_position
  use mech9_linearisation, only: linearisation_type, new_linearisation, find_forces, find_matrix, by_acceleration
  use mech9_motion_in_space, only: place_in_space, refuse_singular_chains
  use mech9_driven_frictions, only: driven_frictions_type, slip_directions
  use mech9_forces_by_kind, only: frame_rates_type, find_forces_by_kind, kind_names, by_drives
  implicit none
  private
  public :: instant_type, find_instant

  !> Numbers in SI units.
  type :: instant_type
    integer, allocatable :: independent(:)      !< (n) numbers of the independent coordinates, in the order of the data file
    integer, allocatable :: dependent(:)        !< (d) numbers of the dependent ones, ascending
    integer, allocatable :: moving(:)           !< (f) those of the mass matrix: the free ones; where all are driven, these
    real(wp), allocatable :: rates(:, :)        !< (d,n) derivatives of the dependent coordinates
    real(wp), allocatable :: points(:, :, :)    !< (3,n,points) derivatives of the points, fixed axes
    logical :: has_forces = .false.             !< there are bodies, loads or motors, and all of them have values: with what follows
    real(wp), allocatable :: inertia(:, :)      !< (f,f) mass matrix [kg m^2, kg m, kg]
    real(wp), allocatable :: bias(:)            !< (f) what the forces of drives are beside mass matrix times accelerations [N m, N]
    real(wp), allocatable :: forces(:, :)       !< (n,kinds) generalized forces, whose sum is zero [N m, N]
  end type instant_type

contains

  !> Find all for a motion in a closed position. Fails with exit_singular where closed chains stand in a singular position, and as a plan
  !> does. A load without a value, or a friction that does not exist, leaves out the forces.
  subroutine find_instant(model, partition, q, motion, instant, err)
    type(model_type), intent(in) :: model                !< the model
    type(partition_type), intent(in) :: partition        !< of its coordinates, with the angles that the motion holds
    real(wp), intent(in) :: q(:)                         !< (M) closed position [rad, m]
    type(state_type), intent(in) :: motion               !< the motion in this position, on any plan
    type(instant_type), intent(out) :: instant           !< gets all
    type(error_type), allocatable, intent(out) :: err    !< allocated if it failed
    class(plan_type), allocatable :: plan
    class(state_type), allocatable :: state
    class(linearisation_type), allocatable :: linearisation
    type(frame_rates_type) :: rates
    type(error_type), allocatable :: without_value

    allocate (plan, state, linearisation)
    call place_in_space(model%mechanism, partition, q, motion, plan, state, err)
    if (allocated(err)) return
    call new_linearisation(model%mechanism, plan, linearisation)
    call find_forces(model%mechanism, plan, state, linearisation, without_value)
    call refuse_singular_chains(plan, state, linearisation, err)
    if (allocated(err)) return
    instant%independent = model%problem%in_given_order()
    call find_jacobians(model%mechanism, plan, state, linearisation, instant, rates)
    if (size(linearisation%dynamics%bodies) == 0 .and. .not. model%mechanism%has_forces()) return
    if (.not. allocated(without_value)) call find_frictions(model%mechanism, plan, state, without_value)
    if (.not. allocated(without_value)) call find_dynamics(model, plan, state, rates, linearisation, instant, without_value)
    instant%has_forces = .not. allocated(without_value)
  end subroutine find_instant

  !> Find the derivatives of dependent coordinates and of points.
  subroutine find_jacobians(mechanism, plan, state, linearisation, instant, rates)
    type(mechanism_type), intent(in) :: mechanism                !< the mechanism
    type(plan_type), intent(in) :: plan                          !< its plan, in space
    type(state_type), intent(in) :: state                        !< the motion
    type(linearisation_type), intent(inout) :: linearisation     !< with the factors of the chains
    type(instant_type), intent(inout) :: instant                 !< with the independent coordinates; gets the derivatives
    type(frame_rates_type), intent(out) :: rates                 !< derivatives of all frames and coordinates
    real(wp) :: arm(3)
    integer :: i, j, m, f

    m = plan%n_coordinates
    associate (n => size(instant%independent), points => mechanism%points)
      allocate (rates%q(m, n), rates%turn(3, 0:m, n), rates%shift(3, 0:m, n), instant%points(3, n, size(points)))
      do j = 1, n
        call linearisation%variation%clear()
        linearisation%variation%q(instant%independent(j)) = 1.0_wp
        call vary_position(plan, state, linearisation%motion, linearisation%variation)
        rates%q(:, j) = linearisation%variation%q
        rates%turn(:, :, j) = linearisation%variation%turn
        rates%shift(:, :, j) = linearisation%variation%shift
        do i = 1, size(points)
          f = plan%frame_of(points(i)%link)
          arm = turn(state%r(:, :, f), transformed(plan%link_in_frame(points(i)%link), points(i)%position))
          instant%points(:, j, i) = rates%shift(:, f, j) + cross(rates%turn(:, f, j), arm)
        end do
      end do
      instant%dependent = pack([(i, i=1, m)], is_dependent(plan))
      instant%rates = rates%q(instant%dependent, :)
    end associate
  end subroutine find_jacobians

  !> Whether each coordinate depends on others.
  pure function is_dependent(plan)
    type(plan_type), intent(in) :: plan   !< the plan
    logical :: is_dependent(plan%n_coordinates)

    is_dependent = .true.
    is_dependent(plan%independent) = .false.
  end function is_dependent

  !> Find the frictions of a driven motion that was found without them.
  subroutine find_frictions(mechanism, plan, state, err)
    type(mechanism_type), intent(in) :: mechanism       !< the mechanism
    type(plan_type), intent(in) :: plan                 !< its plan, in space
    type(state_type), intent(inout) :: state            !< the motion; gets the frictions
    type(error_type), allocatable, intent(out) :: err   !< allocated where no drive force moves the mechanism this way
    type(driven_frictions_type) :: frictions

    if (.not. mechanism%has_frictions() .or. allocated(state%friction)) return
    call frictions%find(mechanism, plan, state, slip_directions(mechanism, plan, state), err)
  end subroutine find_frictions

  !> Find the mass matrix and the generalized forces.
  subroutine find_dynamics(model, plan, state, rates, linearisation, instant, err)
    type(model_type), intent(in) :: model                        !< the model
    type(plan_type), intent(in) :: plan                          !< its plan, in space
    type(state_type), intent(in) :: state                        !< the motion
    type(frame_rates_type), intent(in) :: rates                  !< derivatives of all frames and coordinates
    type(linearisation_type), intent(inout) :: linearisation     !< with the forces of the motion; its last variation changes
    type(instant_type), intent(inout) :: instant                 !< with the independent coordinates; gets the rest
    type(error_type), allocatable, intent(out) :: err            !< allocated if a load has no value
    real(wp) :: magnitude
    integer, allocatable :: places(:)
    integer :: i, k

    associate (n => size(instant%independent), kind => model%problem%partition%kind(instant%independent))
      places = pack([(i, i=1, n)], kind == free_coordinate)
      if (size(places) == 0) places = [(i, i=1, n)]
      instant%moving = instant%independent(places)
      allocate (instant%inertia(size(places), size(places)), instant%forces(n, size(kind_names)))
      call find_matrix(model%mechanism, plan, state, by_acceleration, instant%moving, linearisation, instant%inertia, magnitude, &
                       err)
      if (allocated(err)) return
      do k = 1, size(places)
        instant%inertia(:, k) = instant%inertia(:, k)/(plan%unit_of(instant%moving)*plan%unit_of(instant%moving(k)))
      end do
      instant%inertia = 0.5_wp*(instant%inertia + transpose(instant%inertia))
      call find_forces_by_kind(model%mechanism, plan, linearisation%dynamics, state, rates, linearisation%tree, instant%forces, err)
      if (allocated(err)) return
      where (kind == driven_coordinate) instant%forces(:, by_drives) = -sum(instant%forces, dim=2)
      instant%bias = -sum(instant%forces(places, :), dim=2) + instant%forces(places, by_drives) &
                     - matmul(instant%inertia, state%ddq(instant%moving))
    end associate
  end subroutine find_dynamics
end module mech9_instant
