!> The numbers of a mechanism on which its motion depends, in one row: constant poses, offsets, points, laws of drives, couplings, pairs
!> without a fixed axis.
!>
!> The order of the row does not depend on the numbers, so that rows of mechanisms which differ in numbers only can be subtracted.
module mech9_mechanism_constants
  use mech9_kinds, only: wp
  use mech9_rotation, only: about_z
  use mech9_pose, only: pose_type, compose
  use mech9_screw_pair, only: screw_pair_type
  use mech9_model, only: model_type
  use mech9_plan, only: plan_type
  use mech9_spanning_tree, only: lay_out_frames, renew_frames
  implicit none
  private
  public :: gather_constants, renew_constants, align_axes, constants_of_coordinate, constants_of_pose, constants_of_body, &
    constants_of_stop, constants_of_friction

  !> Numbers of a coordinate: the pose of its axis, offset, advance per unit, and the pose of its closing frame in the target.
  integer, parameter :: constants_of_coordinate = 26
  !> Numbers of a pose: the rotation by columns, and the origin.
  integer, parameter :: constants_of_pose = 12
  !> Numbers of a body: mass, centre, inertia.
  integer, parameter :: constants_of_body = 13
  !> Numbers of a stop beside those of its load: both ends, and restitution.
  integer, parameter :: constants_of_stop = 3
  !> Numbers of a friction: coefficients at rest and of sliding, radius, face radius, arm, preload, transition.
  integer, parameter :: constants_of_friction = 7

contains

  !> The numbers of a model, each link's poses in its frames included: 26 for each coordinate, 12 for each link, 3 for each point;
  !> then the numbers of the drives, couplings, pairs and loads that are known, and of stops and frictions; 13 for each body, gravity,
  !> and the start of each coordinate.
  subroutine gather_constants(model, length, origin, values)
    type(model_type), intent(in) :: model            !< the model
    real(wp), intent(in) :: length                   !< the mechanism's size, which is not varied [m]
    real(wp), intent(in) :: origin(3)                !< origin of frame 0 in link 1, which is not varied [m]
    real(wp), allocatable, intent(out) :: values(:)  !< the row
    class(plan_type), allocatable :: plan

    allocate (plan)
    call lay_out_frames(model%mechanism, model%problem%partition, model%problem%initial%position, plan, length, origin)
    call take_constants(model, plan, values)
  end subroutine gather_constants

  !> The same by the frames of a plan that was made for other numbers, which is faster.
  subroutine renew_constants(model, plan, values)
    type(model_type), intent(in) :: model            !< the model
    type(plan_type), intent(inout) :: plan           !< of a model that differs in numbers only; gets those of this one, but for
                                                     !< size and origin, which are not varied
    real(wp), allocatable, intent(out) :: values(:)  !< the row

    call renew_frames(model%mechanism, plan)
    call take_constants(model, plan, values)
  end subroutine renew_constants

  !> The row of numbers from the frames of a plan.
  subroutine take_constants(model, plan, values)
    type(model_type), intent(in) :: model            !< the model
    type(plan_type), intent(in) :: plan              !< with its frames laid out
    real(wp), allocatable, intent(out) :: values(:)  !< the row
    integer :: at, i, c, k

    allocate (values(constants_of_coordinate*plan%n_coordinates + constants_of_pose*plan%n_links &
                     + 3*size(model%mechanism%points)), source=0.0_wp)
    do i = 1, plan%n_coordinates
      at = constants_of_coordinate*(plan%steps(i)%coordinate - 1)
      values(at + 1:at + 12) = numbers_of_pose(plan%steps(i)%before)
      values(at + 13:at + 14) = [plan%steps(i)%offset, plan%steps(i)%slide]
    end do
    do c = 1, size(plan%closures)
      if (plan%closures(c)%coupling > 0) cycle
      k = plan%steps(plan%closures(c)%closing)%coordinate
      at = constants_of_coordinate*(k - 1) + 14
      values(at + 1:at + 12) = numbers_of_pose(plan%closures(c)%in_target)
    end do
    at = constants_of_coordinate*plan%n_coordinates
    do i = 1, plan%n_links
      values(at + 1:at + 12) = numbers_of_pose(plan%link_in_frame(i))
      at = at + constants_of_pose
    end do
    do i = 1, size(model%mechanism%points)
      values(at + 1:at + 3) = model%mechanism%points(i)%position
      at = at + 3
    end do
    call append_laws(model, values)
    call append_bounds(model, values)
    call append_masses(model, values)
  end subroutine take_constants

  !> Append the numbers of drives, couplings, pairs without a fixed axis, loads and motors, as far as they are known.
  subroutine append_laws(model, values)
    type(model_type), intent(in) :: model                !< the model
    real(wp), allocatable, intent(inout) :: values(:)    !< the row so far
    real(wp), allocatable :: more(:)
    integer :: i

    do i = 1, size(model%problem%drives)
      call model%problem%drives(i)%drive%constants(more)
      if (allocated(more)) values = [values, more]
    end do
    if (allocated(model%mechanism%couplings)) then
      do i = 1, size(model%mechanism%couplings)
        call model%mechanism%couplings(i)%coupling%constants(more)
        if (allocated(more)) values = [values, more]
      end do
    end if
    do i = 1, size(model%mechanism%pairs)
      call model%mechanism%pairs(i)%pair%constants(more)
      values = [values, more]
    end do
    do i = 1, size(model%mechanism%loads)
      call model%mechanism%loads(i)%load%constants(more)
      if (allocated(more)) values = [values, more]
    end do
    do i = 1, size(model%mechanism%motors)
      call model%mechanism%motors(i)%motor%constants(more)
      if (allocated(more)) values = [values, more]
    end do
  end subroutine append_laws

  !> Append the numbers of stops and frictions. An end that a stop does not have counts as zero.
  subroutine append_bounds(model, values)
    type(model_type), intent(in) :: model                !< the model
    real(wp), allocatable, intent(inout) :: values(:)    !< the row so far
    integer :: i, end

    do i = 1, size(model%mechanism%stops)
      associate (stop => model%mechanism%stops(i))
        values = [values, (merge(stop%ends(end), 0.0_wp, stop%has_end(end)), end=1, 2), stop%restitution]
      end associate
    end do
    if (.not. model%mechanism%has_frictions()) return
    do i = 1, size(model%mechanism%frictions)
      associate (friction => model%mechanism%frictions(i))
        values = [values, friction%static, friction%dynamic, friction%radius, friction%face_radius, friction%arm, &
                  friction%preload, friction%transition]
      end associate
    end do
  end subroutine append_bounds

  !> Append the numbers that matter in dynamics only: bodies, gravity, and positions and rates at the start.
  subroutine append_masses(model, values)
    type(model_type), intent(in) :: model                !< the model
    real(wp), allocatable, intent(inout) :: values(:)    !< the row so far
    integer :: i

    do i = 1, size(model%mechanism%bodies)
      associate (body => model%mechanism%bodies(i))
        values = [values, body%mass, body%centre, reshape(body%inertia, [9])]
      end associate
    end do
    values = [values, model%mechanism%gravity, model%problem%initial%position, model%problem%initial%velocity]
  end subroutine append_masses

  !> Turn both frames of each pair of a model about its axis, so that they are near those of another model with nearly the same
  !> numbers. The motion of the pair stays the same; but frames whose zero direction the program chooses may differ by a large angle.
  pure subroutine align_axes(other, model)
    type(model_type), intent(in) :: other      !< the other model
    type(model_type), intent(inout) :: model   !< the model
    integer :: k

    do k = 1, min(size(other%mechanism%pairs), size(model%mechanism%pairs))
      select type (near => other%mechanism%pairs(k)%pair)
      type is (screw_pair_type)
        select type (pair => model%mechanism%pairs(k)%pair)
        type is (screw_pair_type)
          call align_pair(near%factors%before, pair)
        end select
      end select
    end do
  end subroutine align_axes

  !> Turn both frames of a pair about its axis.
  pure subroutine align_pair(near, pair)
    type(pose_type), intent(in) :: near            !< pose of the axis of a pair with nearly the same numbers
    type(screw_pair_type), intent(inout) :: pair   !< the pair
    type(pose_type) :: turned
    real(wp) :: x(3)

    associate (before => pair%factors%before)
      x = near%r(:, 1) - dot_product(near%r(:, 1), before%r(:, 3))*before%r(:, 3)
      turned%r = about_z(atan2(dot_product(x, before%r(:, 2)), dot_product(x, before%r(:, 1))))
      before = compose(before, turned)
    end associate
    turned%r = transpose(turned%r)
    pair%factors%after = compose(turned, pair%factors%after)
  end subroutine align_pair

  !> The numbers of a pose.
  pure function numbers_of_pose(pose) result(numbers)
    type(pose_type), intent(in) :: pose   !< the pose
    real(wp) :: numbers(constants_of_pose)

    numbers(1:9) = reshape(pose%r, [9])
    numbers(10:12) = pose%p
  end function numbers_of_pose
end module mech9_mechanism_constants
