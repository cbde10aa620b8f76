!> Derivatives of a motion by parameters of the mechanism: of coordinates, rates, accelerations, and of points.
!>
!> A parameter that changes by dp moves each frame by a twist; the twist of a frame is the sum of those of the steps that lead to
!> it, of their coordinates and of their constants alike. A closed chain stays closed if the twist of its closing frame is that of
!> its target, in all orders of derivatives in time. The unknown derivatives of dependent coordinates follow from the factors of
!> the block, with one right-hand side for each parameter.
!>
!> The columns of these sums are the same for all parameters: they are found once for each position, from the motion of the frames,
!> and the innermost loops run over the parameters. In a planar mechanism whose parameters leave its plane alone, a twist has three
!> numbers; else it has six.
module mech9_sensitivity
  use mech9_kinds, only: wp
  use mech9_tolerances, only: singular_conditioning
  use mech9_error, only: error_type, raise, exit_data, exit_singular
  use mech9_failure, only: failure_singular_sensitivity, failure_opening_parameter
  use mech9_model, only: model_type
  use mech9_variable_model, only: variable_model_type
  use mech9_pose, only: transformed
  use mech9_plan, only: plan_type, block_type, new_state
  use mech9_state, only: state_type
  use mech9_arithmetics, only: set_in_space
  use mech9_frame_motion, only: place_all, spread_all_velocities, spread_all_accelerations
  use mech9_frame_variation, only: third_derivatives_type, new_third_derivatives, find_third_derivatives
  use mech9_twists, only: frame_twists_type, new_frame_twists, find_frame_twists, find_step_twists
  use mech9_tangent, only: tangent_type, find_tangent
  use mech9_pair_changes, only: find_pair_change
  use mech9_parameter_support, only: support_type, find_support, point_form, keep_static
  use mech9_linear_form, only: linear_form_type, find_values, add_motion
  use mech9_planar_forms, only: carry_in_plane, fill_planar_closure, fill_planar_point, planar_step_series
  use mech9_spatial_forms, only: carry_in_space, fill_spatial_closure, fill_whole_closure, fill_coupling, fill_spatial_point
  use mech9_planar_support, only: put_in_plane
  use mech9_varied_block, only: varied_block_type, new_varied_block, factorize, solve_block
  implicit none
  private
  public :: sensitivity_type, new_sensitivity, find_sensitivities, find_twists_of_frame

  !> A drive whose numbers a parameter changes.
  type :: varied_drive_type
    integer :: parameter = 0   !< number of the parameter
    integer :: drive = 0       !< number of the drive
  end type varied_drive_type

  !> The derivatives of a motion by all parameters, and what finds them. Each parameter counts in its unit in the data file.
  type :: sensitivity_type
    integer :: n_parameters = 0
    integer :: highest = 2                          !< order of the highest derivative in time that is found
    real(wp), allocatable :: q(:, :, :)             !< (P,0:2,M) of the coordinates and their derivatives in time [rad, m]
    real(wp), allocatable :: points(:, :, :, :)     !< (P,3,0:2,points) of the points of the mechanism [m]
    logical, private :: in_plane = .false.          !< twists have three numbers
    logical, private :: own_frames = .false.        !< the frames are placed here, because others do not place them all in space
    type(tangent_type), allocatable, private :: tangents(:)    !< (P) of the constants
    type(support_type), private :: support                     !< all that the parameters change
    type(varied_drive_type), allocatable, private :: drives(:) !< drives that they change
    type(varied_block_type), allocatable, private :: blocks(:) !< chains that they change
    type(linear_form_type), allocatable, private :: points_shift(:)   !< of all points
    real(wp), allocatable, private :: places(:, :)             !< (3,points) of the points in the first frames of their links [m]
    real(wp), allocatable, private :: series(:, :, :)          !< (3 or 6,0:2,constants) twists of constants
    logical, private :: is_carried = .false.                   !< twists of the ground are in `series`
    integer, allocatable, private :: steps(:)                  !< steps whose twists are found
    integer, allocatable, private :: frames(:)                 !< frames whose motion is found as twists
    type(plan_type), private :: plan                           !< in the arithmetic of the derivatives
    type(state_type), private :: state                         !< the motion, where the frames are placed here
    type(frame_twists_type), private :: motion                 !< twists of the motion in space
    type(third_derivatives_type), private :: third             !< of pairs without a fixed axis
  end type sensitivity_type

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
    integer :: i

    sensitivity%n_parameters = size(model%parameters)
    sensitivity%highest = highest
    allocate (sensitivity%tangents(sensitivity%n_parameters))
    do i = 1, sensitivity%n_parameters
      call find_tangent(variable, model, plan, i, sensitivity%tangents(i), err)
      if (allocated(err)) return
    end do
    call find_support(model, plan, sensitivity%tangents, sensitivity%support)
    call choose_arithmetic(model, plan, sensitivity)
    call make_forms(model, sensitivity)
  end subroutine new_sensitivity

  !> Choose planar arithmetic where neither the mechanism nor a parameter leaves the plane, and decide who places the frames.
  subroutine choose_arithmetic(model, plan, self)
    type(model_type), intent(in) :: model           !< the present model
    type(plan_type), intent(in) :: plan             !< its plan
    type(sensitivity_type), intent(inout) :: self   !< with the support; gets the plan and its arithmetic
    integer :: n, m

    n = self%n_parameters
    m = plan%n_coordinates
    allocate (self%q(n, 0:2, m), self%points(n, 3, 0:2, size(model%mechanism%points)), source=0.0_wp)
    self%plan = plan
    if (plan%planar%used .and. .not. any(self%support%constants%by_pair)) &
      call put_in_plane(plan, model%problem%initial%position, self%support, self%in_plane)
    if (self%in_plane) then
      self%own_frames = self%highest > 0 .and. any(plan%blocks%last_moved < plan%blocks%last_step)
    else
      self%own_frames = plan%planar%used .or. self%highest > 0 .and. any(plan%blocks%last_moved < plan%blocks%last_step)
      if (allocated(plan%planar%planes)) self%own_frames = self%own_frames .or. any(plan%planar%plane_of > 0 .and. &
                                                                                    .not. plan%planar%shown)
      self%plan%blocks%arithmetic = 1
      self%plan%blocks%is_shown = .false.
      call set_in_space(self%plan)
      self%motion = new_frame_twists(m)
      self%third = new_third_derivatives(plan)
    end if
    if (self%own_frames) self%state = new_state(self%plan)
    allocate (self%series(merge(3, 6, self%in_plane), 0:2, self%support%count), source=0.0_wp)
  end subroutine choose_arithmetic

  !> Make the forms of chains and points, and the lists of all that a position needs.
  subroutine make_forms(model, self)
    type(model_type), intent(in) :: model           !< the present model
    type(sensitivity_type), intent(inout) :: self   !< with support and plan; gets forms and lists
    logical :: steps(self%plan%n_coordinates), frames(0:self%plan%n_coordinates)
    logical :: varies(size(self%plan%blocks))
    integer, allocatable :: varied(:)
    integer :: b, i, p, n

    do b = 1, size(varies)
      associate (coordinates => self%plan%blocks(b)%coordinates)
        varies(b) = size(coordinates) > 0 .and. all(self%support%touched(coordinates))
      end associate
    end do
    varied = pack([(b, b=1, size(varies))], varies)
    n = self%n_parameters
    allocate (self%blocks(size(varied)), self%drives(0), self%points_shift(size(model%mechanism%points)))
    do b = 1, size(varied)
      self%blocks(b) = new_varied_block(self%plan, self%support, varied(b), n, self%in_plane, self%highest)
    end do
    do p = 1, n
      do i = 1, size(model%problem%drives)
        if (self%tangents(p)%drives(i)%varies) self%drives = [self%drives, varied_drive_type(p, i)]
      end do
    end do
    allocate (self%places(3, size(model%mechanism%points)))
    do i = 1, size(model%mechanism%points)
      call make_point(model, i, self)
    end do
    steps = self%support%touched(self%plan%steps%coordinate)
    self%steps = pack([(i, i=1, size(steps))], steps)
    frames = .false.
    frames(self%plan%steps(self%steps)%parent) = .true.
    frames(self%support%constants(:self%support%count)%frame) = .true.
    self%frames = pack([(i, i=0, size(steps))], frames)
  end subroutine make_forms

  !> Make the form of a point. The part of its shift that is normal to a plane never changes.
  subroutine make_point(model, number, self)
    type(model_type), intent(in) :: model           !< the present model
    integer, intent(in) :: number                   !< of the point
    type(sensitivity_type), intent(inout) :: self   !< with support and plan; gets the form
    integer :: rows, i

    rows = 3
    if (self%in_plane .and. self%plan%planar%in_xy_plane) rows = 2
    associate (point => model%mechanism%points(number), form => self%points_shift(number), planar => self%plan%planar)
      form = point_form(self%plan, self%support, number, self%plan%frame_of(point%link), self%n_parameters, rows)
      if (.not. self%in_plane) then
        self%places(:, number) = transformed(self%plan%link_in_frame(point%link), point%position)
        return
      end if
      call keep_static(self%support, .false., form)
      self%places(:, number) = transformed(planar%link_in_frame(point%link), point%position)
      ! beside a plane of the first two axes, the third row of the shift never changes
      do i = 1, self%support%count
        associate (constant => self%support%constants(i))
          if (constant%point == number) self%points(constant%parameter, 3, 0, number) = constant%twist(4)
        end associate
      end do
    end associate
  end subroutine make_point

  !> Find the derivatives of the present motion. Fails with exit_singular where closed chains are in a singular position, and with
  !> exit_data where a change of a parameter would open a closed chain.
  subroutine find_sensitivities(model, present, self, err)
    type(model_type), intent(in) :: model                 !< the present model
    type(state_type), intent(in) :: present               !< the motion in the plan for which this was prepared, frames included
    type(sensitivity_type), intent(inout) :: self         !< gets the derivatives
    type(error_type), allocatable, intent(out) :: err     !< allocated if it failed

    if (self%own_frames) then
      call place_motion(present, self, err)
      if (.not. allocated(err)) call find_from_frames(model, self%state, self, err)
    else
      call find_from_frames(model, present, self, err)
    end if
  end subroutine find_sensitivities

  !> Place the frames of the present motion.
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
    if (self%highest > 0) call spread_all_velocities(self%plan, self%state)
    if (self%highest > 1) call spread_all_accelerations(self%plan, self%state)
  end subroutine place_motion

  !> Find the derivatives of a motion whose frames are in place.
  subroutine find_from_frames(model, state, self, err)
    type(model_type), intent(in) :: model                 !< the present model
    type(state_type), intent(in) :: state                 !< the motion
    type(sensitivity_type), intent(inout) :: self         !< gets the derivatives
    type(error_type), allocatable, intent(out) :: err     !< allocated if it failed
    integer :: b, i, parameter

    call find_series(state, self, err)
    if (allocated(err)) return
    call vary_drives(model, state%t, self)
    do b = 1, size(self%blocks)
      associate (block => self%blocks(b))
        call fill_block(state, block, self)
        call factorize(block)
        if (.not. block%equations%conditioning() >= singular_conditioning) then
          call fail_with(failure_singular_sensitivity, exit_singular, self%plan%blocks(block%number), state%t, err)
          return
        end if
        call solve_block(model, self%plan, state, self%tangents, self%highest, self%n_parameters, &
                         self%plan%n_coordinates, block, self%q, parameter)
        if (parameter == 0) cycle
        call fail_with(failure_opening_parameter, exit_data, self%plan%blocks(block%number), state%t, err)
        err%failure%number = parameter
        err%failure%name = model%parameters(parameter)%name
        err%place = model%parameters(parameter)%place
        return
      end associate
    end do
    do i = 1, size(self%points_shift)
      call vary_point(model, i, state, self)
    end do
  end subroutine find_from_frames

  !> Find the twists of steps and constants with their derivatives in time.
  subroutine find_series(state, self, err)
    type(state_type), intent(in) :: state                 !< the motion
    type(sensitivity_type), intent(inout) :: self         !< gets the twists
    type(error_type), allocatable, intent(out) :: err     !< allocated if a pair has no pose beside the present one
    integer :: i

    associate (n => self%support%count)
      if (self%in_plane) then
        call carry_in_plane(n, self%support%constants, state%planar, self%highest, self%is_carried, self%series)
        self%is_carried = .true.
        return
      end if
      if (self%highest > 1) call find_third_derivatives(self%plan, state, self%third, err)
      if (allocated(err)) return
      call find_frame_twists(state, self%frames, self%highest, self%motion)
      call find_step_twists(self%plan, state, self%third, self%steps, self%highest, self%motion)
      call carry_in_space(self%plan, n, self%support%constants, state, self%motion, self%highest, self%is_carried, &
                          self%series)
      self%is_carried = .true.
      do i = 1, n
        associate (constant => self%support%constants(i))
          if (constant%by_pair) call find_pair_change(self%plan, state, self%motion, self%tangents(constant%parameter), &
                                                      constant%step, self%highest, self%series(:, :, i))
        end associate
      end do
    end associate
  end subroutine find_series

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
  subroutine vary_drives(model, t, self)
    type(model_type), intent(in) :: model           !< the present model
    real(wp), intent(in) :: t                       !< time [s]
    type(sensitivity_type), intent(inout) :: self   !< gets the derivatives
    real(wp) :: change(0:2)
    integer :: i

    do i = 1, size(self%drives)
      associate (varied => self%drives(i), drive => model%problem%drives(self%drives(i)%drive)%drive)
        call drive%vary(self%tangents(varied%parameter)%drives(varied%drive)%change, t, change(0), change(1), change(2))
        self%q(varied%parameter, :, drive%coordinate) = change
      end associate
    end do
  end subroutine vary_drives

  !> Fill the forms of a block for the present position.
  subroutine fill_block(state, block, self)
    type(state_type), intent(in) :: state              !< the motion
    type(varied_block_type), intent(inout) :: block    !< gets its columns
    type(sensitivity_type), intent(inout) :: self      !< with the twists of steps and constants
    integer :: i, c, number

    do i = 1, size(block%forms)
      c = block%first_closure + i - 1
      number = self%plan%closures(c)%coupling
      if (self%in_plane) then
        call fill_planar_closure(self%plan%planar, c, state%planar, self%highest, self%series, block%forms(i))
      else if (number > 0) then
        call fill_coupling(self%plan, c, state, self%third%couplings(number), block%forms(i))
      else
        call fill_spatial_closure(self%plan, c, state, self%motion, self%highest, self%series, block%forms(i))
        if (block%has_whole) call fill_whole_closure(self%plan, c, state, self%motion, self%series, block%whole(i))
      end if
    end do
  end subroutine fill_block

  !> The derivatives of a point.
  subroutine vary_point(model, number, state, self)
    type(model_type), intent(in) :: model           !< the present model
    integer, intent(in) :: number                   !< of the point
    type(state_type), intent(in) :: state           !< the motion
    type(sensitivity_type), intent(inout) :: self   !< with the coordinates; gets the derivatives
    integer :: f, order

    f = self%plan%frame_of(model%mechanism%points(number)%link)
    associate (form => self%points_shift(number))
      if (size(form%steps) == 0 .and. (form%is_filled .or. size(form%constants) == 0) .and. all(form%keeps)) return
      if (self%in_plane) then
        call fill_planar_point(self%plan%planar, f, self%places(1:2, number), state%planar, self%highest, &
                               self%support%constants, self%series, form)
      else
        call fill_spatial_point(f, self%places(:, number), state, self%motion, self%highest, self%series, form)
      end if
      do order = 0, self%highest
        call find_values(form, self%n_parameters, self%plan%n_coordinates, order, .true., self%q, &
                         self%points(1, 1, order, number))
      end do
    end associate
  end subroutine vary_point

  !> The twists of a frame by all parameters, after `find_sensitivities`: rotation, then shift of the point that coincides with the
  !> origin of frame 0, in its axes, with the derivatives of these numbers in time. A link moves with its first frame and, in
  !> addition, with the constant twist of its own system in that frame.
  subroutine find_twists_of_frame(self, present, frame, twists)
    type(sensitivity_type), intent(inout) :: self        !< with the derivatives of the present motion
    type(state_type), intent(in) :: present              !< this motion
    integer, intent(in) :: frame                         !< number of the frame
    real(wp), intent(out), contiguous :: twists(:, :, 0:)   !< (P,6,0:2) up to the order `highest` [rad, m per unit of parameter]
    real(wp) :: series(6, 0:2), planar_series(3, 0:2)
    integer :: s, i, order

    twists = 0.0_wp
    s = frame
    do while (s > 0)
      if (self%support%touched(self%plan%steps(s)%coordinate)) then
        if (.not. self%in_plane) then
          series = self%motion%step(:, :, s)
        else
          if (self%own_frames) then
            call planar_step_series(self%plan%planar, s, self%state%planar, self%highest, planar_series)
          else
            call planar_step_series(self%plan%planar, s, present%planar, self%highest, planar_series)
          end if
          series = in_space(self, planar_series)
        end if
        call add_motion(self%n_parameters, self%highest, series, self%q(:, :, self%plan%steps(s)%coordinate), twists)
      end if
      do i = 1, self%support%count
        associate (constant => self%support%constants(i))
          if (constant%step /= s) cycle
          if (self%in_plane) then
            series = in_space(self, self%series(:, :, i))
          else
            series = self%series(:, :, i)
          end if
          do order = 0, self%highest
            twists(constant%parameter, :, order) = twists(constant%parameter, :, order) + series(:, order)
          end do
        end associate
      end do
      s = self%plan%steps(s)%parent
    end do
  end subroutine find_twists_of_frame

  !> A twist in the plane as a twist in space.
  pure function in_space(self, twist) result(series)
    type(sensitivity_type), intent(in) :: self   !< with the plane
    real(wp), intent(in) :: twist(3, 0:2)        !< rotation about the normal, shift in the plane
    real(wp) :: series(6, 0:2)
    integer :: order

    associate (axes => self%plan%planar%axes)
      do order = 0, 2
        series(1:3, order) = axes(:, 3)*twist(1, order)
        series(4:6, order) = axes(:, 1)*twist(2, order) + axes(:, 2)*twist(3, order)
      end do
    end associate
  end function in_space
end module mech9_sensitivity
