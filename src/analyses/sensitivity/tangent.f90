!> The derivatives of all constants of a mechanism by one of its parameters.
!>
!> The constants are smooth functions of one number that the readers of the data file evaluate. Most are linear functions of it,
!> which two differences over models with shifted values decide. The derivatives of others come from central differences of eighth
!> order, with a step at which truncation is below round-off. All that follows from the constants (positions, rates, accelerations)
!> is differentiated exactly elsewhere.
module mech9_tangent
  use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
  use mech9_kinds, only: wp
  use mech9_error, only: error_type, raise, exit_data
  use mech9_sensitivity_failures, only: failure_no_neighbours, failure_unknown_derivative
  use mech9_rotation, only: cross
  use mech9_pose, only: pose_type
  use mech9_parameter, only: parameter_type
  use mech9_model, only: model_type
  use mech9_variable_model, only: variable_model_type
  use mech9_plan, only: plan_type
  use mech9_mechanism_constants, only: renew_constants, align_axes, constants_of_coordinate, constants_of_pose, &
    constants_of_body, constants_of_stop, constants_of_friction
  implicit none
  private
  public :: tangent_type, law_tangent_type, find_tangent

  !> Derivatives of the numbers of a law or a coupling.
  type :: law_tangent_type
    logical :: varies = .false.           !< some of them are not zero
    real(wp), allocatable :: change(:)    !< of each number
  end type law_tangent_type

  !> Derivatives by one parameter, per unit of the parameter in the data file. Those of a pose are a twist: the rotation, then the
  !> shift of the point that coincides with the origin of the frame in which the pose is given.
  type :: tangent_type
    real(wp), allocatable :: before(:, :)      !< (6,M) of the pose of each coordinate's axis in the parent frame [rad, m]
    logical, allocatable :: moves(:)           !< (M) this twist is not zero
    real(wp), allocatable :: offset(:)         !< (M) of the offset of each coordinate [rad, m]
    real(wp), allocatable :: slide(:)          !< (M) of the advance per unit of the coordinate [m/rad]
    real(wp), allocatable :: in_target(:, :)   !< (6,M) of the pose of the closing frame of a coordinate's step in the target frame
    real(wp), allocatable :: link(:, :)        !< (6,N) of each link's own system in its first frame
    real(wp), allocatable :: points(:, :)      !< (3,P) of the positions of points in their links [m]
    type(law_tangent_type), allocatable :: drives(:)      !< in the order of the drives
    type(law_tangent_type), allocatable :: couplings(:)   !< in the order of the couplings
    type(law_tangent_type), allocatable :: pairs(:)       !< (M) of the sizes of curves, and of the numbers of users' procedures
    type(law_tangent_type), allocatable :: loads(:)       !< in the order of the loads
    type(law_tangent_type), allocatable :: motors(:)      !< in the order of the motors
    type(law_tangent_type), allocatable :: stops(:)       !< both ends and restitution, in the order of the stops
    type(law_tangent_type), allocatable :: frictions(:)   !< coefficients at rest and of sliding, radius, face radius, arm, preload, transition
    type(law_tangent_type), allocatable :: bodies(:)      !< mass, centre and inertia by columns, in the order of the bodies
    real(wp) :: gravity(3) = 0.0_wp            !< of gravity [m/s^2]
    real(wp), allocatable :: start(:, :)       !< (M,0:1) of positions and rates at the start [rad, m]
    !> Largest change of a constant, as a part of it, of the mechanism's size or of a rad: the inverse of the change of the
    !> parameter that matters.
    real(wp) :: size = 0.0_wp
    !> Round-off of the derivatives of poses: what two estimates differ by, and that of the differences [rad, parts of the mechanism's
    !> size].
    real(wp) :: round_off = 0.0_wp
  end type tangent_type

  integer, parameter :: half_width = 4
  !> Weights of f(x + i h) - f(x - i h) over h in the central difference of eighth order, and of sixth order.
  real(wp), parameter :: eighth(half_width) = [4.0_wp/5.0_wp, -1.0_wp/5.0_wp, 4.0_wp/105.0_wp, -1.0_wp/280.0_wp]
  real(wp), parameter :: sixth(half_width) = [3.0_wp/4.0_wp, -3.0_wp/20.0_wp, 1.0_wp/60.0_wp, 0.0_wp]
  !> The step is a power of two, near this part of the length over which the constants change: truncation of a function such as
  !> 1/x is then near 1e-15, and differences lose two digits of the sixteen that numbers have.
  real(wp), parameter :: step_part = 2.0_wp**(-7)
  !> This length is the value of the parameter, or one unit of it. The unit comes first where the value is below this, so that the step
  !> is not lost in the round-off of numbers to which the parameter is added.
  real(wp), parameter :: small_value = 1.0e-6_wp
  !> Factors of this length that are tried one after the other, until the two orders agree to `agreement` of the largest derivative.
  real(wp), parameter :: factors(7) = [1.0_wp, 2.0_wp**(-4), 2.0_wp**4, 2.0_wp**(-8), 2.0_wp**8, 2.0_wp**(-12), 2.0_wp**(-16)]
  real(wp), parameter :: agreement = 2.0e-12_wp
  !> All constants are linear functions where their slopes over one step and over four agree to so many units of round-off. Terms of
  !> third order would then change the slope by a fifteenth of that.
  real(wp), parameter :: linear_round_off = 4.0_wp*epsilon(1.0_wp)
  !> Constants that are smaller than this part of the largest one are zero but for round-off.
  real(wp), parameter :: zero_beside = 1.0e-12_wp

  !> Derivatives from differences at one step.
  type :: difference_type
    real(wp), allocatable :: change(:)      !< the derivatives
    real(wp) :: error = huge(1.0_wp)        !< estimated; huge where a model beside the present one does not exist
    real(wp) :: of_poses = 0.0_wp           !< error of the derivatives of poses [rad, parts of the mechanism's size]
  end type difference_type

contains

  !> The tangent of a model for one of its parameters. Fails where no model exists beside the present one, and where the parameter
  !> sets numbers whose derivatives are not known.
  subroutine find_tangent(variable, model, plan, number, tangent, err)
    class(variable_model_type), intent(inout) :: variable   !< the model as a function of its parameters
    type(model_type), intent(in) :: model                   !< the present model
    type(plan_type), intent(in) :: plan                     !< its plan
    integer, intent(in) :: number                           !< of the parameter
    type(tangent_type), intent(out) :: tangent              !< the derivatives
    type(error_type), allocatable, intent(out) :: err       !< allocated if it failed
    real(wp), allocatable :: change(:)
    real(wp) :: round_off

    if (.not. knows_derivatives(model, model%parameters(number))) then
      call raise(err, exit_data, failure_unknown_derivative)
    else
      call try_formulas(variable, model, number, err)
      if (allocated(err)) return
      call differentiate(variable, model, plan, number, change, round_off, err)
    end if
    if (allocated(err)) then
      err%failure%name = model%parameters(number)%name
      err%place = model%parameters(number)%place
      return
    end if
    call read_change(model, plan, change, tangent)
    tangent%round_off = round_off
  end subroutine find_tangent

  !> Fail where a formula in which a parameter has a part has no derivative, which then is the message.
  subroutine try_formulas(variable, model, number, err)
    class(variable_model_type), intent(inout) :: variable   !< the model as a function of its parameters
    type(model_type), intent(in) :: model                   !< the present model
    integer, intent(in) :: number                           !< of the parameter
    type(error_type), allocatable, intent(out) :: err       !< allocated if it failed
    class(model_type), allocatable :: unused

    if (.not. allocated(model%parameters(number)%through)) return
    allocate (unused)
    if (size(model%parameters(number)%through) > 0) call variable%along(values_of(model), number, 0.0_wp, unused, err)
  end subroutine try_formulas

  !> Whether the numbers that a parameter may set have known derivatives.
  pure logical function knows_derivatives(model, parameter) result(known)
    type(model_type), intent(in) :: model             !< the model
    type(parameter_type), intent(in) :: parameter     !< the parameter
    real(wp), allocatable :: values(:)
    integer :: i

    known = .not. (sets_any(parameter, [character(len=9) :: 'time']) .or. sets_scale(parameter))
    if (sets_any(parameter, [character(len=9) :: 'drive', 'user'])) then
      do i = 1, size(model%problem%drives)
        call model%problem%drives(i)%drive%constants(values)
        known = known .and. allocated(values)
      end do
    end if
    if (sets_any(parameter, [character(len=9) :: 'coupling', 'initial', 'user']) .and. allocated(model%mechanism%couplings)) then
      do i = 1, size(model%mechanism%couplings)
        call model%mechanism%couplings(i)%coupling%constants(values)
        known = known .and. allocated(values)
      end do
    end if
  end function knows_derivatives

  !> Whether a parameter sets a number of any of these groups, itself or by a formula in which it has a part.
  pure logical function sets_any(parameter, groups) result(sets)
    type(parameter_type), intent(in) :: parameter   !< the parameter
    character(len=9), intent(in) :: groups(:)       !< names of groups of the data file
    integer :: i

    sets = .false.
    do i = 1, size(parameter%targets)
      sets = sets .or. any(groups == parameter%targets(i)%group)
    end do
    if (.not. allocated(parameter%through)) return
    do i = 1, size(parameter%through)
      sets = sets .or. any(groups == parameter%through(i)%group)
    end do
  end function sets_any

  !> Whether a parameter sets the scale of the path of a contact, itself or by a formula in which it has a part.
  pure logical function sets_scale(parameter) result(sets)
    type(parameter_type), intent(in) :: parameter   !< the parameter

    sets = any(parameter%targets%group == 'contact' .and. parameter%targets%item == 'scale')
    if (allocated(parameter%through)) &
      sets = sets .or. any(parameter%through%group == 'contact' .and. parameter%through%item == 'scale')
  end function sets_scale

  !> The derivatives of all constants by one parameter.
  subroutine differentiate(variable, model, plan, number, change, round_off, err)
    class(variable_model_type), intent(inout) :: variable   !< the model as a function of its parameters
    type(model_type), intent(in) :: model                   !< the present model
    type(plan_type), intent(in) :: plan                     !< its plan
    integer, intent(in) :: number                           !< of the parameter
    real(wp), allocatable, intent(out) :: change(:)         !< the derivatives
    real(wp), intent(out) :: round_off                      !< of those of poses [rad, parts of the mechanism's size]
    type(error_type), allocatable, intent(out) :: err       !< allocated if it failed
    type(plan_type) :: renewed
    type(difference_type) :: trial
    real(wp), allocatable :: present(:)
    real(wp) :: lengths(2), best
    integer :: i, j

    renewed = plan
    call renew_constants(model, renewed, present)
    lengths = [abs(model%parameters(number)%value), 1.0_wp]
    if (lengths(1) < small_value) lengths = lengths(2:1:-1)
    best = huge(best)
    round_off = 0.0_wp
    do j = 1, 2
      if (.not. lengths(j) > 0.0_wp .or. best <= agreement) exit
      do i = 1, size(factors)
        call try_step(variable, model, number, step_part*2.0_wp**exponent(lengths(j))*factors(i), present, renewed, trial)
        if (trial%error < best) then
          best = trial%error
          round_off = trial%of_poses
          change = trial%change
        end if
        if (best <= agreement) exit
      end do
    end do
    if (.not. allocated(change)) call raise(err, exit_data, failure_no_neighbours)
  end subroutine differentiate

  !> The present values of all parameters.
  pure function values_of(model) result(values)
    type(model_type), intent(in) :: model   !< the present model
    real(wp) :: values(size(model%parameters))
    integer :: i

    values = [(model%parameters(i)%value, i=1, size(values))]
  end function values_of

  !> The derivatives from differences at one step, and an estimate of their error: what two orders or two steps differ by, and the
  !> round-off of the constants, as a part of the largest derivative.
  subroutine try_step(variable, model, number, h, present, plan, found)
    class(variable_model_type), intent(inout) :: variable   !< the model as a function of its parameters
    type(model_type), intent(in) :: model                   !< the present model
    integer, intent(in) :: number                           !< of the parameter
    real(wp), intent(in) :: h                               !< the step, in the unit of the parameter
    real(wp), intent(in) :: present(:)                      !< the present constants
    type(plan_type), intent(inout) :: plan                  !< scratch: the plan of the present model, with other numbers
    type(difference_type), intent(out) :: found             !< the derivatives
    real(wp) :: difference(size(present), half_width), round_off(size(present)), lower(size(present))
    integer, parameter :: order(half_width) = [1, half_width, 2, 3]
    integer :: i
    logical :: exists

    found%change = 0.0_wp*present
    do i = 1, half_width
      call find_difference(variable, model, number, order(i)*h, plan, difference(:, order(i)), exists)
      if (.not. exists) return
      if (i /= 2) cycle
      found%change = difference(:, half_width)/(2*half_width*h)
      lower = difference(:, 1)/(2.0_wp*h)
      if (all(abs(found%change - lower) <= linear_round_off*max(abs(present), min(1.0_wp, plan%length))/h)) exit
    end do
    if (i > half_width) then
      found%change = matmul(difference, eighth)/h
      lower = matmul(difference, sixth)/h
    else
      difference(:, 2:3) = 0.0_wp
    end if
    if (.not. all(ieee_is_finite(found%change))) return
    round_off = merge(2.0_wp*epsilon(h)*abs(present), 0.0_wp, any(abs(difference) > 0.0_wp, dim=2))
    associate (change => found%change)
      found%error = maxval(abs(change - lower) + round_off/h)
      if (found%error > 0.0_wp) found%error = found%error/max(maxval(abs(change)), tiny(h))
      found%of_poses = maxval(abs(change - lower), mask=is_of_pose(plan, size(change)))/min(1.0_wp, plan%length) &
                       + linear_round_off/h
    end associate
  end subroutine try_step

  !> Mark the constants that belong to poses of pairs and links: those before all others.
  pure function is_of_pose(plan, n)
    type(plan_type), intent(in) :: plan   !< the plan
    integer, intent(in) :: n              !< number of constants
    logical :: is_of_pose(n)

    is_of_pose = .false.
    is_of_pose(:constants_of_coordinate*plan%n_coordinates + constants_of_pose*plan%n_links) = .true.
  end function is_of_pose

  !> The difference of the constants at two values of a parameter, on both sides of the present one.
  subroutine find_difference(variable, model, number, distance, plan, difference, exists)
    class(variable_model_type), intent(inout) :: variable   !< the model as a function of its parameters
    type(model_type), intent(in) :: model                   !< the present model
    integer, intent(in) :: number                           !< of the parameter
    real(wp), intent(in) :: distance                        !< of each value from the present one
    type(plan_type), intent(inout) :: plan                  !< scratch: the plan of the present model, with other numbers
    real(wp), intent(out) :: difference(:)                  !< the difference
    logical, intent(out) :: exists                          !< there are models at both values
    real(wp), allocatable :: above(:), below(:)

    call constants_at(variable, model, number, distance, plan, above)
    exists = size(above) == size(difference)
    if (exists) call constants_at(variable, model, number, -distance, plan, below)
    if (exists) exists = size(below) == size(difference)
    difference = 0.0_wp
    if (exists) difference = above - below
  end subroutine find_difference

  !> The constants at another value of a parameter, along the tangents of formulas; none where there is no such model, or other coordinates are independent there.
  subroutine constants_at(variable, present, number, distance, plan, constants)
    class(variable_model_type), intent(inout) :: variable   !< the model as a function of its parameters
    type(model_type), intent(in) :: present                 !< the present model
    integer, intent(in) :: number                           !< of a parameter
    real(wp), intent(in) :: distance                        !< of its value from the present one
    type(plan_type), intent(inout) :: plan                  !< scratch: the plan of the present model, with other numbers
    real(wp), allocatable, intent(out) :: constants(:)      !< the constants
    class(model_type), allocatable :: model
    type(error_type), allocatable :: err

    allocate (model)
    call variable%along(values_of(present), number, distance, model, err)
    if (.not. allocated(err)) then
      if (all(model%problem%partition%kind == present%problem%partition%kind)) then
        call align_axes(present, model)
        call renew_constants(model, plan, constants)
      end if
    end if
    if (.not. allocated(constants)) allocate (constants(0))
  end subroutine constants_at

  !> The derivatives of the row of constants as twists and numbers of the parts of the mechanism.
  subroutine read_change(model, plan, change, tangent)
    type(model_type), intent(in) :: model         !< the present model
    type(plan_type), intent(in) :: plan           !< its plan
    real(wp), intent(in) :: change(:)             !< derivatives of the row
    type(tangent_type), intent(out) :: tangent    !< the same, by parts
    integer :: at, i, k, m

    m = plan%n_coordinates
    allocate (tangent%before(6, m), tangent%in_target(6, m), tangent%link(6, plan%n_links), tangent%offset(m), &
              tangent%slide(m), source=0.0_wp)
    do k = 1, m
      at = constants_of_coordinate*(k - 1)
      tangent%before(:, k) = twist_of(plan%steps(plan%step_of(k))%before, change(at + 1:at + 12))
      tangent%offset(k) = change(at + 13)
      tangent%slide(k) = change(at + 14)
    end do
    do i = 1, size(plan%closures)
      if (plan%closures(i)%coupling > 0) cycle
      k = plan%steps(plan%closures(i)%closing)%coordinate
      at = constants_of_coordinate*(k - 1) + 14
      tangent%in_target(:, k) = twist_of(plan%closures(i)%in_target, change(at + 1:at + 12))
    end do
    at = constants_of_coordinate*m
    do i = 1, plan%n_links
      tangent%link(:, i) = twist_of(plan%link_in_frame(i), change(at + 1:at + 12))
      at = at + constants_of_pose
    end do
    allocate (tangent%points(3, size(model%mechanism%points)))
    tangent%points = reshape(change(at + 1:at + size(tangent%points)), shape(tangent%points))
    at = at + size(tangent%points)
    tangent%moves = [(any(abs(tangent%before(:, k)) > 0.0_wp), k=1, m)]
    call read_laws(model, change(at + 1:), tangent)
    tangent%size = size_of_change(model, plan, change, tangent)
  end subroutine read_change

  !> The largest change of a constant, as a part of what it is itself, of the mechanism's size or of a rad.
  real(wp) function size_of_change(model, plan, change, tangent) result(largest)
    type(model_type), intent(in) :: model         !< the present model
    type(plan_type), intent(in) :: plan           !< its plan
    real(wp), intent(in) :: change(:)             !< derivatives of the row
    type(tangent_type), intent(in) :: tangent     !< the derivatives of its parts
    type(plan_type) :: renewed
    real(wp), allocatable :: present(:)
    real(wp) :: round_off
    integer :: i, k

    renewed = plan
    call renew_constants(model, renewed, present)
    largest = maxval([0.0_wp, abs(tangent%before(1:3, :)), abs(tangent%in_target(1:3, :)), abs(tangent%link(1:3, :)), &
                      abs(tangent%before(4:6, :))/plan%length, abs(tangent%in_target(4:6, :))/plan%length, &
                      abs(tangent%link(4:6, :))/plan%length, abs(tangent%offset)/plan%unit_of, abs(tangent%slide)/plan%length, &
                      (abs(tangent%start(k, :))/plan%unit_of(k), k=1, plan%n_coordinates)])
    round_off = zero_beside*maxval(abs(present))
    do i = constants_of_coordinate*plan%n_coordinates + constants_of_pose*plan%n_links + 1, size(change) - size(tangent%start)
      if (.not. abs(change(i)) > 0.0_wp) cycle
      largest = max(largest, abs(change(i))/merge(abs(present(i)), 1.0_wp, abs(present(i)) > round_off))
    end do
  end function size_of_change

  !> The derivatives of the numbers of drives, couplings, pairs without a fixed axis, loads and motors, stops and frictions, and of those of
  !> dynamics.
  subroutine read_laws(model, change, tangent)
    type(model_type), intent(in) :: model           !< the present model
    real(wp), intent(in) :: change(:)               !< the part of the row that belongs to them
    type(tangent_type), intent(inout) :: tangent    !< gets these derivatives
    real(wp), allocatable :: values(:)
    integer :: at, i, n

    n = 0
    if (allocated(model%mechanism%couplings)) n = size(model%mechanism%couplings)
    allocate (tangent%drives(size(model%problem%drives)), tangent%couplings(n), tangent%pairs(size(model%mechanism%pairs)))
    at = 0
    do i = 1, size(tangent%drives)
      call model%problem%drives(i)%drive%constants(values)
      call take_part(values, change, at, tangent%drives(i))
    end do
    do i = 1, n
      call model%mechanism%couplings(i)%coupling%constants(values)
      call take_part(values, change, at, tangent%couplings(i))
    end do
    do i = 1, size(tangent%pairs)
      call model%mechanism%pairs(i)%pair%constants(values)
      call take_part(values, change, at, tangent%pairs(i))
    end do
    allocate (tangent%loads(size(model%mechanism%loads)), tangent%motors(size(model%mechanism%motors)), &
              tangent%bodies(size(model%mechanism%bodies)))
    do i = 1, size(tangent%loads)
      call model%mechanism%loads(i)%load%constants(values)
      call take_part(values, change, at, tangent%loads(i))
    end do
    do i = 1, size(tangent%motors)
      call model%mechanism%motors(i)%motor%constants(values)
      call take_part(values, change, at, tangent%motors(i))
    end do
    n = 0
    if (model%mechanism%has_frictions()) n = size(model%mechanism%frictions)
    allocate (tangent%stops(size(model%mechanism%stops)), tangent%frictions(n))
    values = spread(0.0_wp, 1, constants_of_stop)
    do i = 1, size(tangent%stops)
      call take_part(values, change, at, tangent%stops(i))
    end do
    values = spread(0.0_wp, 1, constants_of_friction)
    do i = 1, size(tangent%frictions)
      call take_part(values, change, at, tangent%frictions(i))
    end do
    values = spread(0.0_wp, 1, constants_of_body)
    do i = 1, size(tangent%bodies)
      call take_part(values, change, at, tangent%bodies(i))
    end do
    tangent%gravity = change(at + 1:at + 3)
    n = size(model%problem%initial%position)
    allocate (tangent%start(n, 0:1))
    tangent%start = reshape(change(at + 4:at + 3 + 2*n), [n, 2])
  end subroutine read_laws

  !> Take the derivatives of the numbers of one law or coupling.
  pure subroutine take_part(values, change, at, part)
    real(wp), allocatable, intent(in) :: values(:)   !< its numbers; not allocated where they are not known
    real(wp), intent(in) :: change(:)                !< derivatives of the numbers of all
    integer, intent(inout) :: at                     !< number of constants taken so far; grows
    type(law_tangent_type), intent(out) :: part      !< gets the derivatives of this part

    if (.not. allocated(values)) return
    part%change = change(at + 1:at + size(values))
    part%varies = any(abs(part%change) > 0.0_wp)
    at = at + size(values)
  end subroutine take_part

  !> The twist by which a pose changes, from the derivatives of its numbers.
  pure function twist_of(pose, change) result(twist)
    type(pose_type), intent(in) :: pose       !< the pose
    real(wp), intent(in) :: change(12)        !< derivatives of its rotation, by columns, and of its origin
    real(wp) :: twist(6), spin(3, 3)

    spin = matmul(reshape(change(:9), [3, 3]), transpose(pose%r))
    twist(1:3) = 0.5_wp*[spin(3, 2) - spin(2, 3), spin(1, 3) - spin(3, 1), spin(2, 1) - spin(1, 2)]
    twist(4:6) = change(10:12) - cross(twist(1:3), pose%p)
  end function twist_of
end module mech9_tangent
