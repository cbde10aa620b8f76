!> The parts of a mechanism that its parameters change: twists of constant poses, and the coordinates that change with some parameter.
module mech9_parameter_support
  use mech9_kinds, only: wp
  use mech9_rotation, only: turn, cross
  use mech9_pose, only: transformed
  use mech9_model, only: model_type
  use mech9_plan, only: plan_type, block_type
  use mech9_tangent, only: tangent_type
  use mech9_linear_form, only: linear_form_type, form_steps_type, form_constants_type, new_linear_form
  implicit none
  private
  public :: support_type, varied_constant_type, carried_constants_type, place_in_frame_type, find_support, closure_form, &
    point_form, keep_static

  !> A twist by which a constant of the mechanism changes with one parameter.
  type :: varied_constant_type
    integer :: parameter = 0            !< its number
    integer :: frame = 0                !< frame in which the twist is constant
    integer :: step = 0                 !< step whose frame and all that follows it move by the twist; 0: none
    integer :: closure = 0              !< closure whose target pose moves by the twist; 0: none
    integer :: point = 0                !< point of the mechanism that moves by the twist; 0: none
    integer :: stretched_by = 0         !< coordinate whose value, with its offset, multiplies the twist; 0: none
    logical :: by_pair = .false.        !< a pair without a fixed axis moves otherwise; its twist is found for each position
    real(wp) :: twist(6) = 0.0_wp       !< rotation, and shift of the point at the frame's origin, in its axes [rad, m]
    real(wp) :: size = 0.0_wp           !< its largest number [rad, lengths of the mechanism]
  end type varied_constant_type

  !> Twists of constants, seen from frame 0 at several positions.
  type :: carried_constants_type
    type(varied_constant_type), allocatable :: list(:)      !< the constants
    real(wp), allocatable :: series(:, :, :, :)             !< (batch,3 or 6,0:2,constants) their twists with derivatives in time
  end type carried_constants_type

  !> A point of a frame.
  type :: place_in_frame_type
    integer :: frame = 0                !< the frame
    real(wp) :: place(3) = 0.0_wp       !< in this frame, in its plane the first two numbers [m]
  end type place_in_frame_type

  !> All that the parameters of a mechanism change.
  type :: support_type
    integer :: count = 0                                      !< how many twists of constants
    type(varied_constant_type), allocatable :: constants(:)   !< they come first; the others are room for more
    logical, allocatable :: touched(:, :)                     !< (M,P) coordinates that change with each parameter
  end type support_type

contains

  !> Find the twists of constants and the coordinates that the parameters change.
  pure subroutine find_support(model, plan, tangents, support)
    type(model_type), intent(in) :: model              !< the present model
    type(plan_type), intent(in) :: plan                !< its plan
    type(tangent_type), intent(in) :: tangents(:)      !< derivatives of the constants by each parameter
    type(support_type), intent(out) :: support         !< the result
    integer :: p, i, b

    allocate (support%constants(size(tangents)*(5*plan%n_coordinates + size(model%mechanism%points))))
    allocate (support%touched(plan%n_coordinates, size(tangents)), source=.false.)
    do p = 1, size(tangents)
      call add_steps(plan, tangents(p), p, support)
      call add_targets(plan, tangents(p), p, support)
      call add_points(model, plan, tangents(p), p, support)
      do i = 1, size(model%problem%drives)
        if (tangents(p)%drives(i)%varies) support%touched(model%problem%drives(i)%drive%coordinate, p) = .true.
      end do
      do b = 1, size(plan%blocks)
        if (is_touched(plan, plan%blocks(b), tangents(p), p, support)) support%touched(plan%blocks(b)%coordinates, p) = .true.
      end do
    end do
  end subroutine find_support

  !> Append a twist, if it is not known to be zero.
  pure subroutine append(constant, length, support)
    type(varied_constant_type), intent(in) :: constant   !< the twist
    real(wp), intent(in) :: length                       !< the mechanism's size [m]
    type(support_type), intent(inout) :: support         !< gets the twist

    if (.not. (constant%by_pair .or. any(abs(constant%twist) > 0.0_wp))) return
    support%count = support%count + 1
    support%constants(support%count) = constant
    support%constants(support%count)%size = max(maxval(abs(constant%twist(1:3))), maxval(abs(constant%twist(4:6)))/length)
  end subroutine append

  !> Add the twists of steps: of the pose of the axis, of the offset of the coordinate, of the advance, and of pairs without a fixed axis.
  pure subroutine add_steps(plan, tangent, p, support)
    type(plan_type), intent(in) :: plan            !< the plan
    type(tangent_type), intent(in) :: tangent      !< derivatives of the constants by a parameter
    integer, intent(in) :: p                       !< number of the parameter
    type(support_type), intent(inout) :: support   !< gets the twists
    integer :: s, k
    real(wp) :: along(6)

    do s = 1, plan%n_coordinates
      associate (step => plan%steps(s))
        k = step%coordinate
        call append(varied_constant_type(parameter=p, frame=step%parent, step=s, twist=tangent%before(:, k)), &
                    plan%length, support)
        along = 0.0_wp
        along(3) = step%turn*tangent%offset(k)
        along(6) = step%slide*tangent%offset(k)
        call append(varied_constant_type(parameter=p, frame=s, step=s, twist=along), plan%length, support)
        along = 0.0_wp
        along(4:6) = tangent%slide(k)*step%before%r(:, 3)
        call append(varied_constant_type(parameter=p, frame=step%parent, step=s, stretched_by=k, twist=along), plan%length, &
                    support)
        if (tangent%pairs(k)%varies) call append(varied_constant_type(parameter=p, frame=step%parent, step=s, by_pair=.true.), &
                                                 plan%length, support)
      end associate
    end do
  end subroutine add_steps

  !> Add the twists of the poses at which chains close.
  pure subroutine add_targets(plan, tangent, p, support)
    type(plan_type), intent(in) :: plan            !< the plan
    type(tangent_type), intent(in) :: tangent      !< derivatives of the constants by a parameter
    integer, intent(in) :: p                       !< number of the parameter
    type(support_type), intent(inout) :: support   !< gets the twists
    integer :: c

    do c = 1, size(plan%closures)
      associate (closure => plan%closures(c))
        if (closure%coupling > 0) cycle
        call append(varied_constant_type(parameter=p, frame=closure%target, closure=c, &
                                         twist=tangent%in_target(:, plan%steps(closure%closing)%coordinate)), plan%length, support)
      end associate
    end do
  end subroutine add_targets

  !> Add the shifts of points in the first frames of their links.
  pure subroutine add_points(model, plan, tangent, p, support)
    type(model_type), intent(in) :: model          !< the model
    type(plan_type), intent(in) :: plan            !< its plan
    type(tangent_type), intent(in) :: tangent      !< derivatives of the constants by a parameter
    integer, intent(in) :: p                       !< number of the parameter
    type(support_type), intent(inout) :: support   !< gets the shifts
    real(wp) :: shift(6)
    integer :: i

    do i = 1, size(model%mechanism%points)
      associate (point => model%mechanism%points(i), in_frame => plan%link_in_frame(model%mechanism%points(i)%link))
        shift(1:3) = 0.0_wp
        shift(4:6) = turn(in_frame%r, tangent%points(:, i)) + tangent%link(4:6, point%link) &
                     + cross(tangent%link(1:3, point%link), transformed(in_frame, point%position))
        call append(varied_constant_type(parameter=p, frame=plan%frame_of(point%link), point=i, twist=shift), &
                    plan%length, support)
      end associate
    end do
  end subroutine add_points

  !> Whether a parameter changes the unknowns of a block: through constants of its loops, or through their coordinates.
  pure logical function is_touched(plan, block, tangent, p, support) result(touched)
    type(plan_type), intent(in) :: plan            !< the plan
    type(block_type), intent(in) :: block          !< the block
    type(tangent_type), intent(in) :: tangent      !< derivatives of the constants by the parameter
    integer, intent(in) :: p                       !< number of the parameter
    type(support_type), intent(in) :: support      !< with the constants and the coordinates of earlier blocks
    integer :: c, i

    touched = .true.
    do c = block%first_closure, block%last_closure
      associate (closure => plan%closures(c))
        if (any(support%touched(plan%steps(closure%loop%steps)%coordinate, p))) return
        do i = 1, support%count
          if (support%constants(i)%parameter == p .and. belongs_to(support%constants(i), plan, c)) return
        end do
        if (closure%coupling == 0) cycle
        if (tangent%couplings(closure%coupling)%varies) return
      end associate
    end do
    touched = .false.
  end function is_touched

  !> Whether a twist opens a closed chain.
  pure logical function belongs_to(constant, plan, c)
    type(varied_constant_type), intent(in) :: constant   !< the twist
    type(plan_type), intent(in) :: plan                  !< the plan
    integer, intent(in) :: c                             !< number of the closure

    belongs_to = constant%closure == c
    if (constant%step == 0 .or. plan%closures(c)%coupling > 0) return
    belongs_to = any(plan%closures(c)%loop%steps == constant%step)
  end function belongs_to

  !> The opening of a closed chain as a form: first the steps with given coordinates, then those with unknown ones. The form of a
  !> coupling has no twists of constants.
  pure function closure_form(plan, support, tangents, block, c, rows) result(form)
    type(plan_type), intent(in) :: plan            !< the plan
    type(support_type), intent(in) :: support      !< the support of the parameters
    type(tangent_type), intent(in) :: tangents(:)  !< derivatives of the constants by each parameter
    type(block_type), intent(in) :: block          !< the block that solves the chain
    integer, intent(in) :: c                       !< number of the closure
    integer, intent(in) :: rows                    !< number of equations
    type(linear_form_type) :: form
    integer, allocatable :: order(:), coordinates(:), used(:)
    type(form_constants_type) :: constants
    logical, allocatable :: unknown(:), given(:), takes(:)
    logical :: varies(size(tangents))
    integer :: i

    associate (loop => plan%closures(c)%loop, closure => plan%closures(c))
      coordinates = plan%steps(loop%steps)%coordinate
      allocate (unknown(size(coordinates)), given(size(coordinates)), takes(support%count))
      do i = 1, size(coordinates)
        unknown(i) = any(block%coordinates == coordinates(i))
        given(i) = any(support%touched(coordinates(i), :)) .and. .not. unknown(i)
      end do
      varies = .false.
      do i = 1, size(tangents)
        if (closure%coupling > 0) varies(i) = tangents(i)%couplings(closure%coupling)%varies
      end do
      do i = 1, support%count
        takes(i) = belongs_to(support%constants(i), plan, c)
      end do
      order = [(i, i=1, size(coordinates))]
      order = [pack(order, given), pack(order, unknown)]
      used = pack([(i, i=1, support%count)], takes)
      constants%numbers = used
      constants%parameters = support%constants(used)%parameter
      allocate (constants%signs(size(used)), source=-1.0_wp)
      do i = 1, size(used)
        if (support%constants(used(i))%step > 0) &
          constants%signs(i) = loop%signs(findloc(loop%steps, support%constants(used(i))%step, dim=1))
      end do
      form = new_linear_form(rows, form_steps_type(loop%steps(order), coordinates(order), loop%signs(order)), constants, &
                             support%touched, varies)
      form%n_given = count(given)
      do i = 1, size(used)
        associate (constant => support%constants(used(i)))
          form%constant_sizes(constant%parameter) = form%constant_sizes(constant%parameter) + constant%size
        end associate
      end do
      do i = form%n_given + 1, size(order)
        form%unknowns(i) = findloc(block%coordinates, form%coordinates(i), dim=1)
      end do
    end associate
  end function closure_form

  !> The shift of a point as a form of the steps that lead to its link.
  pure function point_form(plan, support, number, frame, rows) result(form)
    type(plan_type), intent(in) :: plan            !< the plan
    type(support_type), intent(in) :: support      !< the support of the parameters
    integer, intent(in) :: number                  !< number of the point
    integer, intent(in) :: frame                   !< first frame of its link
    integer, intent(in) :: rows                    !< number of components that change
    type(linear_form_type) :: form
    integer, allocatable :: path(:), used(:)
    logical :: takes(support%count)
    logical :: none(size(support%touched, 2))
    integer :: s, i

    allocate (path(0))
    s = frame
    do while (s > 0)
      path = [path, s]
      s = plan%steps(s)%parent
    end do
    do i = 1, support%count
      takes(i) = support%constants(i)%point == number
      if (support%constants(i)%step > 0) takes(i) = any(path == support%constants(i)%step)
    end do
    used = pack([(i, i=1, support%count)], takes)
    path = pack(path, any(support%touched(plan%steps(path)%coordinate, :), dim=2))
    none = .false.
    form = new_linear_form(rows, form_steps_type(path, plan%steps(path)%coordinate, [(1.0_wp, i=1, size(path))]), &
                           form_constants_type(used, [(1.0_wp, i=1, size(used))], support%constants(used)%parameter), &
                           support%touched, none)
    form%n_given = size(path)
  end function point_form

  !> Mark the twists of a form whose shares never change: those in frame 0, and only if they are pure shifts where the form is written
  !> at a place that moves. A parameter whose shares do not change and which changes none of the form's coordinates changes the form
  !> by what never changes.
  pure subroutine keep_static(support, angles, at_rest, form)
    type(support_type), intent(in) :: support        !< the support of the parameters
    integer, intent(in) :: angles                    !< numbers of a rotation in a twist: 1 in the plane, 3 in space
    logical, intent(in) :: at_rest                   !< the form is written at a place that does not move
    type(linear_form_type), intent(inout) :: form    !< the form
    logical :: static(size(form%constants))
    integer :: i, p

    do i = 1, size(form%constants)
      associate (constant => support%constants(form%constants(i)))
        static(i) = constant%frame == 0 .and. .not. constant%by_pair .and. constant%stretched_by == 0 .and. &
                    (at_rest .or. .not. any(abs(constant%twist(:angles)) > 0.0_wp))
      end associate
    end do
    do i = 1, size(form%constants)
      form%keeps(i) = all(static .or. form%parameters /= form%parameters(i))
    end do
    do p = 1, size(form%is_still)
      form%is_still(p) = form%is_changed(p) .and. all(form%keeps .or. form%parameters /= p) .and. &
                         .not. any(support%touched(form%coordinates, p))
    end do
  end subroutine keep_static
end module mech9_parameter_support
