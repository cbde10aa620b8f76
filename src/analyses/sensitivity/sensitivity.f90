!> Derivatives of a motion by parameters of the mechanism: of coordinates, rates, accelerations, and of points.
!>
!> A parameter that changes by dp moves each frame by a twist; the twist of a frame is the sum of those of the steps that lead to
!> it, of their coordinates and of their constants alike. A closed chain stays closed if the twist of its closing frame is that of
!> its target, in all orders of derivatives in time. The unknown derivatives of dependent coordinates follow from the factors of
!> the block, with one right-hand side for each parameter.
!>
!> The columns of these sums are the same for all parameters. Derivatives do not depend on those at other positions: the motion of the
!> frames is taken at one position after the other, and the derivatives at many positions are found together, with the position as the
!> innermost index. In a planar mechanism whose parameters leave its plane alone, a twist has three numbers; else it has six.
module mech9_sensitivity
  use mech9_kinds, only: wp
  use mech9_batch_products, only: batch_size
  use mech9_error, only: error_type, raise, exit_data, exit_singular
  use mech9_sensitivity_failures, only: failure_singular_sensitivity, failure_opening_parameter
  use mech9_model, only: model_type
  use mech9_variable_model, only: variable_model_type
  use mech9_plan, only: plan_type, block_type
  use mech9_state, only: state_type
  use mech9_frame_motion, only: place_all, spread_all_velocities, spread_all_accelerations
  use mech9_frame_variation, only: third_derivatives_type, find_third_derivatives
  use mech9_twists, only: frame_twists_type, find_frame_twists, find_step_twists
  use mech9_tangent, only: tangent_type, find_tangent
  use mech9_planar_batch, only: planar_batch_type, take_planar, find_spins
  use mech9_spatial_batch, only: spatial_batch_type, take_spatial, find_turning, find_twists
  use mech9_motion_changes, only: motion_changes_type, new_motion_changes, place_of_coordinate, place_of_point
  use mech9_parameter_support, only: support_type, carried_constants_type, place_in_frame_type, find_support
  use mech9_linear_form, only: linear_form_type, find_values
  use mech9_planar_forms, only: carry_in_plane, fill_planar_closure, fill_planar_point
  use mech9_spatial_forms, only: carry_in_space, fill_spatial_closure, fill_spatial_point
  use mech9_forms_at_position, only: find_twist, fill_reduced_columns, put_reduced_shares, fill_coupling_columns, &
    put_coupling_shares
  use mech9_varied_block, only: varied_block_type, solve_block
  implicit none
  private
  public :: sensitivity_type, new_sensitivity, new_given_sensitivity, take_position, find_waiting

  !> A drive whose numbers a parameter changes.
  type :: varied_drive_type
    integer :: parameter = 0   !< number of the parameter
    integer :: drive = 0       !< number of the drive
  end type varied_drive_type

  !> The derivatives of a motion by all parameters at several positions, and what finds them.
  type :: sensitivity_type
    integer :: highest = 2                          !< order of the highest derivative in time that is found
    integer :: at_once = 1                          !< most positions that may wait for their derivatives
    integer :: waiting = 0                          !< positions that were taken and wait for their derivatives
    type(motion_changes_type) :: changes            !< the derivatives at these positions, after `find_waiting`
    logical, private :: is_given = .false.          !< the derivatives are found elsewhere
    logical, private :: in_plane = .false.          !< twists have three numbers
    logical, private :: places_frames = .false.     !< the frames are placed here, because others do not place them all in space
    type(tangent_type), allocatable, private :: tangents(:)    !< (P) of the constants
    type(support_type), private :: support                     !< all that the parameters change
    type(varied_drive_type), allocatable, private :: drives(:) !< drives that they change
    type(varied_block_type), allocatable, private :: blocks(:) !< chains that they change
    type(linear_form_type), allocatable, private :: points_shift(:)   !< of all points
    type(place_in_frame_type), allocatable, private :: places(:)   !< of the points, in the first frames of their links
    logical, allocatable, private :: apart(:)                  !< (constants) found at each position by itself
    type(carried_constants_type), private :: constants         !< twists of constants, seen from frame 0
    logical, private :: is_carried = .false.                   !< twists of the ground were carried
    integer, allocatable, private :: steps(:)                  !< steps whose twists are found
    integer, allocatable, private :: slides(:)                 !< those of them that slide, in the plane
    integer, allocatable, private :: screws(:)                 !< those of them with axes that are fixed in their parent frames
    integer, allocatable, private :: others(:)                 !< those of them without
    logical, private :: by_position = .false.                  !< some twists and forms are found at each position by itself
    integer, allocatable, private :: parents(:)                !< frames whose motion is found as twists
    integer, allocatable, private :: frames(:)                 !< frames whose motion is taken, without frame 0
    integer, allocatable, private :: turned(:)                 !< frames the derivatives of whose rotation are found
    class(plan_type), allocatable, private :: plan             !< in the arithmetic of the derivatives
    class(state_type), allocatable, private :: state           !< the motion, where the frames are placed here
    type(frame_twists_type), private :: motion                 !< twists of the motion in space, at one position
    type(third_derivatives_type), private :: third             !< of pairs without a fixed axis
    real(wp), private :: times(batch_size) = 0.0_wp            !< of the positions [s]
    type(planar_batch_type), private :: plane                  !< motion of the frames in the plane
    type(spatial_batch_type), private :: space                 !< motion of frames and steps in space
  end type sensitivity_type

  interface
    !> Prepare all that is decided once for all positions: the arithmetic, the forms of chains and points, and the lists of frames and
    !> steps whose motion is needed.
    module subroutine prepare(model, plan, self)
      type(model_type), intent(in) :: model           !< the present model
      type(plan_type), intent(in) :: plan             !< its plan
      type(sensitivity_type), intent(inout) :: self   !< with the support
    end subroutine prepare
  end interface

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

    sensitivity%highest = highest
    allocate (sensitivity%tangents(size(model%parameters)))
    do i = 1, size(model%parameters)
      call find_tangent(variable, model, plan, i, sensitivity%tangents(i), err)
      if (allocated(err)) return
    end do
    sensitivity%changes = new_motion_changes(size(model%parameters), plan%n_coordinates, size(model%mechanism%points))
    call find_support(model, plan, sensitivity%tangents, sensitivity%support)
    call prepare(model, plan, sensitivity)
  end subroutine new_sensitivity

  !> Room for derivatives that are found elsewhere, at one position after the other.
  subroutine new_given_sensitivity(model, highest, sensitivity)
    type(model_type), intent(in) :: model                 !< the model
    integer, intent(in) :: highest                        !< order of the highest derivative in time
    type(sensitivity_type), intent(out) :: sensitivity    !< gets its room

    sensitivity%highest = highest
    sensitivity%is_given = .true.
    sensitivity%changes = new_motion_changes(size(model%parameters), size(model%mechanism%pairs), size(model%mechanism%points))
  end subroutine new_given_sensitivity

  !> Take the present motion as the next position whose derivatives are wanted. Fails if a pair has no pose beside the present one; then
  !> the position is not taken.
  subroutine take_position(model, present, self, err)
    type(model_type), intent(in) :: model                 !< the present model
    type(state_type), intent(in) :: present               !< the motion in the plan for which this was prepared, frames included
    type(sensitivity_type), intent(inout) :: self         !< with room for one more position; gets the motion
    type(error_type), allocatable, intent(out) :: err     !< allocated if it failed

    if (self%places_frames) then
      call place_motion(present, self, err)
      if (.not. allocated(err)) call take_frames(model, self%state, self, err)
    else
      call take_frames(model, present, self, err)
    end if
    if (.not. allocated(err)) self%waiting = self%waiting + 1
  end subroutine take_position

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

  !> Take the motion of the frames, and find what is found for each position by itself.
  subroutine take_frames(model, state, self, err)
    type(model_type), intent(in) :: model                 !< the present model
    type(state_type), intent(in) :: state                 !< the motion, with its frames in place
    type(sensitivity_type), intent(inout) :: self         !< gets the motion
    type(error_type), allocatable, intent(out) :: err     !< allocated if a pair has no pose beside the present one

    associate (position => self%waiting + 1)
      self%times(position) = state%t
      if (size(self%drives) > 0) call vary_drives(model, state%t, position, self)
      if (self%in_plane) then
        call take_planar(state%planar, self%frames, self%slides, position, self%highest, self%plane)
        return
      end if
      if (self%highest > 1) call find_third_derivatives(self%plan, state, self%third, err)
      if (allocated(err)) return
      call take_spatial(state, self%frames, self%screws, position, self%highest, self%space)
      if (self%by_position) call fill_at_position(model, state, position, self)
    end associate
  end subroutine take_frames

  !> The derivatives of the driven coordinates, which their laws give.
  subroutine vary_drives(model, t, position, self)
    type(model_type), intent(in) :: model           !< the present model
    real(wp), intent(in) :: t                       !< time [s]
    integer, intent(in) :: position                 !< number of the position in the batch
    type(sensitivity_type), intent(inout) :: self   !< gets the derivatives
    real(wp) :: change(0:2)
    integer :: i, order

    do i = 1, size(self%drives)
      associate (varied => self%drives(i), drive => model%problem%drives(self%drives(i)%drive)%drive)
        call drive%vary(self%tangents(varied%parameter)%drives(varied%drive)%change, t, change(0), change(1), change(2))
        do order = 0, 2
          self%changes%values(position, place_of_coordinate(drive%coordinate, order), varied%parameter) = change(order)
        end do
      end associate
    end do
  end subroutine vary_drives

  !> Find the twists of some constants and the forms of some closures in space, at one position.
  subroutine fill_at_position(model, state, position, self)
    type(model_type), intent(in) :: model           !< the present model
    type(state_type), intent(in) :: state           !< the motion
    integer, intent(in) :: position                 !< number of the position in the batch
    type(sensitivity_type), intent(inout) :: self   !< with the twists of the motion; gets those of constants and forms
    integer :: b, i, c, number

    call find_frame_twists(state, self%parents, self%highest, self%motion)
    call find_step_twists(self%plan, state, self%third, self%steps, self%highest, self%motion)
    do i = 1, size(self%others)
      self%space%step(position, :, :, self%others(i)) = self%motion%step(:, :, self%others(i))
    end do
    do i = 1, self%support%count
      if (.not. self%apart(i)) cycle
      associate (constant => self%support%constants(i))
        call find_twist(self%plan, constant, self%tangents(constant%parameter), state, self%motion, self%highest, &
                        self%constants%series(position, :, :, i))
      end associate
    end do
    do b = 1, size(self%blocks)
      associate (block => self%blocks(b))
        do i = 1, size(block%forms)
          c = block%first_closure + i - 1
          number = self%plan%closures(c)%coupling
          if (number > 0) then
            call fill_coupling_columns(self%plan, c, state, self%third%couplings(number), position, block%forms(i))
            call put_coupling_shares(model%mechanism%couplings(number)%coupling, self%plan%closures(c), state, self%tangents, &
                                     position, self%highest, block%forms(i))
          else if (block%forms(i)%rows < 6) then
            call fill_reduced_columns(self%plan, c, state, self%motion, position, self%highest, block%forms(i))
            call put_reduced_shares(self%plan, c, state, self%constants%series(position, :, :, :), position, self%highest, &
                                    block%forms(i))
          end if
        end do
      end associate
    end do
  end subroutine fill_at_position

  !> Find the derivatives at the positions that wait. Fails with exit_singular where closed chains are in a singular position, and with
  !> exit_data where a change of a parameter would open a closed chain.
  subroutine find_waiting(model, self, good, err)
    type(model_type), intent(in) :: model                 !< the present model
    type(sensitivity_type), intent(inout) :: self         !< gets the derivatives; no position waits any more
    integer, intent(out) :: good                          !< positions before the first one that failed, or all
    type(error_type), allocatable, intent(out) :: err     !< allocated if it failed

    good = self%waiting
    if (good > 0 .and. .not. self%is_given) call find_in_batch(model, self, good, err)
    self%waiting = 0
  end subroutine find_waiting

  !> Find the derivatives of a batch of positions.
  subroutine find_in_batch(model, self, n, err)
    type(model_type), intent(in) :: model                 !< the present model
    type(sensitivity_type), intent(inout) :: self         !< gets the derivatives
    integer, intent(inout) :: n                           !< number of positions; gets those before the first one that failed
    type(error_type), allocatable, intent(out) :: err     !< allocated if it failed
    integer :: b, i, good, parameter

    call find_series(n, self)
    do b = 1, size(self%blocks)
      call fill_block(n, self%blocks(b), self)
      call solve_block(n, self%plan, self%highest, self%blocks(b), self%changes, good, parameter)
      if (good == n) cycle
      ! an earlier position that fails in another block replaces this one
      n = good
      if (allocated(err)) deallocate (err)
      call fail_with(model, parameter, self%plan%blocks(self%blocks(b)%number), self%times(n + 1), err)
    end do
    do i = 1, size(self%points_shift)
      call vary_point(i, n, self)
    end do
  end subroutine find_in_batch

  !> Find the twists of constants with their derivatives in time.
  subroutine find_series(n, self)
    integer, intent(in) :: n                              !< number of positions
    type(sensitivity_type), intent(inout) :: self         !< with the motion of the frames; gets the twists

    if (self%in_plane) then
      call find_spins(n, self%turned, self%highest, self%plane)
      call carry_in_plane(n, self%plane, self%highest, self%is_carried, self%constants)
    else
      call find_turning(n, self%turned, self%highest, self%space)
      call find_twists(n, self%plan, self%parents, self%screws, self%highest, self%space)
      call carry_in_space(n, self%apart, self%space, self%highest, self%is_carried, self%constants)
    end if
    self%is_carried = .true.
  end subroutine find_series

  !> Fail because of the chains of a block.
  pure subroutine fail_with(model, parameter, block, t, err)
    type(model_type), intent(in) :: model                 !< the present model
    integer, intent(in) :: parameter                      !< the parameter that opens a chain; 0: the position is singular
    type(block_type), intent(in) :: block                 !< the block
    real(wp), intent(in) :: t                             !< time [s]
    type(error_type), allocatable, intent(out) :: err     !< the failure

    if (parameter == 0) then
      call raise(err, exit_singular, failure_singular_sensitivity)
    else
      call raise(err, exit_data, failure_opening_parameter)
      err%failure%number = parameter
      err%failure%name = model%parameters(parameter)%name
      err%place = model%parameters(parameter)%place
    end if
    err%failure%chains = block%chains
    err%failure%coordinates = block%coordinates
    err%failure%t = t
  end subroutine fail_with

  !> Fill the forms of a block.
  subroutine fill_block(n, block, self)
    integer, intent(in) :: n                           !< number of positions
    type(varied_block_type), intent(inout) :: block    !< gets its columns
    type(sensitivity_type), intent(in) :: self         !< with the twists of steps and constants
    integer :: i, c

    do i = 1, size(block%forms)
      c = block%first_closure + i - 1
      if (self%in_plane) then
        call fill_planar_closure(n, self%plan%planar, c, self%plane, self%highest, self%constants, block%forms(i))
      else if (self%plan%closures(c)%coupling == 0) then
        if (block%forms(i)%rows == 6) &
          call fill_spatial_closure(n, self%plan, c, self%space, self%highest, self%constants, block%forms(i))
        if (block%has_whole) call fill_spatial_closure(n, self%plan, c, self%space, 0, self%constants, block%whole(i))
      end if
    end do
  end subroutine fill_block

  !> The derivatives of a point.
  subroutine vary_point(number, n, self)
    integer, intent(in) :: number                   !< of the point
    integer, intent(in) :: n                        !< number of positions
    type(sensitivity_type), intent(inout) :: self   !< with the coordinates; gets the derivatives
    integer :: order, p
    logical :: again

    associate (form => self%points_shift(number), values => self%changes%values)
      again = form%is_filled
      if (all(form%is_still .or. .not. form%is_changed) .and. again) return
      if (self%in_plane) then
        call fill_planar_point(n, self%plan%planar, self%places(number), self%plane, self%highest, self%constants, form)
      else
        call fill_spatial_point(n, self%places(number), self%space, self%highest, self%constants, form)
      end if
      do p = 1, self%changes%n_parameters
        if (.not. form%is_changed(p) .or. form%is_still(p) .and. again) cycle
        do order = 0, self%highest
          call find_values(form, merge(batch_size, n, form%is_still(p)), p, order, .true., values(1, 1, p), &
                           values(1, place_of_point(self%plan%n_coordinates, number, order, 1), p))
        end do
      end do
    end associate
  end subroutine vary_point
end module mech9_sensitivity
