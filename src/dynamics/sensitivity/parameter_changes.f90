!> All numbers of a mechanism that its parameters change, in short lists, and what these changes do to a required force.
module mech9_parameter_changes
  use mech9_kinds, only: wp
  use mech9_model, only: model_type
  use mech9_plan, only: plan_type
  use mech9_state, only: state_type
  use mech9_tangent, only: tangent_type
  use mech9_parameter_support, only: support_type, varied_constant_type, find_support
  use mech9_planar_support, only: put_in_plane
  use mech9_twists, only: frame_twists_type, carried
  use mech9_pair_changes, only: find_pair_change, carry_pair_change
  use mech9_gradient_arithmetic, only: gradient_arithmetic_type
  use mech9_gradient_rows, only: gradient_rows_type, row_of_coordinate, pairing
  implicit none
  private
  public :: parameter_changes_type, list_changes, list_bodies, find_series, by_constants, by_masses, by_couplings, by_drives, &
    by_held

  !> A body whose numbers a parameter changes.
  type :: changed_body_type
    integer :: parameter = 0                !< number of the parameter
    integer :: body = 0                     !< number of the body in the arithmetic
    integer :: frame = 0                    !< number of the frame in which it is fixed
    real(wp) :: numbers(13) = 0.0_wp        !< change in the form of the arithmetic
    real(wp) :: wrench(6) = 0.0_wp          !< the first d numbers: change of the wrench that the body needs, in the present motion
  end type changed_body_type

  !> A coupling or a drive whose numbers a parameter changes.
  type :: changed_law_type
    integer :: parameter = 0   !< number of the parameter
    integer :: number = 0      !< of the closure that is the coupling, or of the drive
  end type changed_law_type

  !> The lists.
  type :: parameter_changes_type
    logical :: in_plane = .false.                                  !< the constants keep the plane of the mechanism
    logical :: moves_links = .false.                               !< links move in their first frames
    type(varied_constant_type), allocatable :: constants(:)        !< twists of steps, of closing poses, and of links
    real(wp), allocatable, private :: series(:, :, :)              !< (d,0:2,constants) these twists, seen from frame 0
    !> (6,constants) changes of the steps' twists beside these, per unit rate: of pairs without a fixed axis, and of steps that
    !> advance more.
    real(wp), allocatable, private :: bends(:, :)
    logical, private :: is_carried = .false.                       !< twists of the ground are in `series`
    type(changed_body_type), allocatable, private :: bodies(:)     !< bodies
    integer, allocatable, private :: gravity(:)                    !< parameters that change gravity
    type(changed_law_type), allocatable, private :: couplings(:)   !< couplings, by their closures
    type(changed_law_type), allocatable, private :: drives(:)      !< drives
  end type parameter_changes_type

contains

  !> List all but the bodies, and decide whether planar arithmetic serves.
  subroutine list_changes(model, plan, tangents, self)
    type(model_type), intent(in) :: model                !< the model
    type(plan_type), intent(in) :: plan                  !< its plan
    type(tangent_type), intent(in) :: tangents(:)        !< derivatives of the constants by each parameter
    type(parameter_changes_type), intent(out) :: self    !< the lists
    type(support_type) :: support
    integer :: p, c, i

    call find_support(model, plan, tangents, support)
    support%constants = pack(support%constants(:support%count), support%constants(:support%count)%point == 0)
    call add_links(plan, tangents, support%constants)
    support%count = size(support%constants)
    if (plan%planar%used .and. .not. any(support%constants%by_pair)) &
      call put_in_plane(plan, model%problem%initial%position, support, self%in_plane)
    self%constants = support%constants
    self%moves_links = any(self%constants%step == 0 .and. self%constants%closure == 0)
    allocate (self%series(merge(3, 6, self%in_plane), 0:2, support%count), self%bends(6, support%count), source=0.0_wp)
    self%gravity = pack([(p, p=1, size(tangents))], [(any(abs(tangents(p)%gravity) > 0.0_wp), p=1, size(tangents))])
    allocate (self%couplings(0), self%drives(0))
    do p = 1, size(tangents)
      do c = 1, size(plan%closures)
        if (plan%closures(c)%coupling == 0) cycle
        if (tangents(p)%couplings(plan%closures(c)%coupling)%varies) self%couplings = [self%couplings, changed_law_type(p, c)]
      end do
      do i = 1, size(model%problem%drives)
        if (tangents(p)%drives(i)%varies) self%drives = [self%drives, changed_law_type(p, i)]
      end do
    end do
  end subroutine list_changes

  !> Append the twists of links in their first frames.
  pure subroutine add_links(plan, tangents, constants)
    type(plan_type), intent(in) :: plan                                      !< the plan
    type(tangent_type), intent(in) :: tangents(:)                            !< derivatives of the constants by each parameter
    type(varied_constant_type), allocatable, intent(inout) :: constants(:)   !< the list that grows
    type(varied_constant_type) :: one
    integer :: p, k

    do p = 1, size(tangents)
      do k = 2, plan%n_links
        one = varied_constant_type(parameter=p, frame=plan%frame_of(k), twist=tangents(p)%link(:, k))
        one%size = max(maxval(abs(one%twist(1:3))), maxval(abs(one%twist(4:6)))/plan%length)
        if (one%size > 0.0_wp) constants = [constants, one]
      end do
    end do
  end subroutine add_links

  !> List the bodies whose numbers parameters change.
  subroutine list_bodies(plan, tangents, numbers, arithmetic, self)
    type(plan_type), intent(in) :: plan                          !< the plan, in the arithmetic
    type(tangent_type), intent(in) :: tangents(:)                !< derivatives of the constants by each parameter
    integer, intent(in) :: numbers(:)                            !< bodies of the arithmetic, by their numbers in the mechanism
    class(gradient_arithmetic_type), intent(in) :: arithmetic    !< the arithmetic
    type(parameter_changes_type), intent(inout) :: self          !< gets the list
    integer :: p, i

    allocate (self%bodies(0))
    do p = 1, size(tangents)
      do i = 1, size(numbers)
        associate (part => tangents(p)%bodies(numbers(i)))
          if (part%varies) self%bodies = [self%bodies, changed_body_type(p, i, arithmetic%body_frames(i), &
                                                                         arithmetic%flatten_body(plan, i, part%change))]
        end associate
      end do
    end do
  end subroutine list_bodies

  !> Find the twists of constants, and the wrenches that changed bodies need, in the present motion.
  subroutine find_series(plan, state, twists, tangents, arithmetic, self)
    type(plan_type), intent(in) :: plan                          !< the plan, in the arithmetic
    type(state_type), intent(in) :: state                        !< the motion
    type(frame_twists_type), intent(in) :: twists                !< of its frames
    type(tangent_type), intent(in) :: tangents(:)                !< derivatives of the constants by each parameter
    class(gradient_arithmetic_type), intent(in) :: arithmetic    !< the arithmetic
    type(parameter_changes_type), intent(inout) :: self          !< gets the twists and wrenches
    real(wp) :: along(6, 0:2), change(6, 0:2)
    integer :: i

    do i = 1, size(self%bodies)
      associate (one => self%bodies(i))
        call arithmetic%body_wrench(state, one%body, one%numbers, one%wrench(:arithmetic%d))
      end associate
    end do
    call arithmetic%carry(plan, state, twists, self%constants, self%is_carried, self%series)
    self%is_carried = .true.
    if (self%in_plane) return
    do i = 1, size(self%constants)
      associate (constant => self%constants(i))
        if (constant%by_pair) then
          call find_pair_change(plan, state, tangents(constant%parameter), constant%step, change)
          call carry_pair_change(plan, state, twists, constant%step, change, 2, self%series(:, :, i))
          self%bends(:, i) = change(:, 1)
        else if (constant%stretched_by > 0) then
          call carried(state, twists, constant%frame, constant%twist, 0, along)
          self%bends(:, i) = along(:, 0)
        end if
      end associate
    end do
  end subroutine find_series

  !> Add the changes of a force by constant poses: of steps, at which chains close, and of links in their frames.
  pure subroutine by_constants(plan, d, rates, held, rows, link_rows, self, by_parameters)
    type(plan_type), intent(in) :: plan                      !< the plan
    integer, intent(in) :: d                                 !< numbers of a twist
    real(wp), intent(in) :: rates(:)                         !< (M) rates of the coordinates in the virtual motion
    type(gradient_rows_type), intent(in) :: held             !< wrenches that the motion needs, of order 2
    type(gradient_rows_type), intent(in) :: rows             !< rows of the force
    real(wp), intent(in), contiguous :: link_rows(:, 0:, 0:) !< (d,0:2,0:M) rows of the links alone, by their first frames
    type(parameter_changes_type), intent(in) :: self         !< with the twists of constants
    real(wp), intent(inout) :: by_parameters(:)              !< (P) derivatives of the force by the parameters
    real(wp) :: change
    integer :: i

    do i = 1, size(self%constants)
      associate (constant => self%constants(i))
        if (constant%step > 0) then
          change = pairing(3*d, rows%frames(:, :, constant%step), self%series(:, :, i))
          if (.not. self%in_plane) &
            change = change + rates(plan%steps(constant%step)%coordinate)*pairing(6, held%frames(:, 2, constant%step), &
                                                                                 self%bends(:, i))
        else if (constant%closure > 0) then
          change = pairing(3*d, rows%chains(:, :, constant%closure), self%series(:, :, i))
        else
          change = pairing(3*d, link_rows(:, :, constant%frame), self%series(:, :, i))
        end if
        by_parameters(constant%parameter) = by_parameters(constant%parameter) + change
      end associate
    end do
  end subroutine by_constants

  !> Add the changes of a force by masses, mass centres, inertia and gravity.
  subroutine by_masses(arithmetic, tangents, virtual, self, by_parameters)
    class(gradient_arithmetic_type), intent(in) :: arithmetic    !< with the bodies
    type(tangent_type), intent(in) :: tangents(:)                !< derivatives of the constants by each parameter
    real(wp), intent(in), contiguous :: virtual(:, 0:)           !< (d,0:M) twists of the frames in the virtual motion
    type(parameter_changes_type), intent(in) :: self             !< with the wrenches of changed bodies
    real(wp), intent(inout) :: by_parameters(:)                  !< (P) derivatives of the force by the parameters
    integer :: i

    do i = 1, size(self%bodies)
      associate (one => self%bodies(i))
        by_parameters(one%parameter) = by_parameters(one%parameter) + pairing(arithmetic%d, one%wrench, virtual(:, one%frame))
      end associate
    end do
    do i = 1, size(self%gravity)
      associate (p => self%gravity(i))
        by_parameters(p) = by_parameters(p) + arithmetic%by_gravity(virtual, tangents(p)%gravity)
      end associate
    end do
  end subroutine by_masses

  !> Add the changes of a force by the numbers of couplings, whose multipliers act in the motion and in the rows.
  subroutine by_couplings(model, plan, state, tangents, rates, held, rows, self, by_parameters)
    type(model_type), intent(in) :: model              !< the model
    type(plan_type), intent(in) :: plan                !< the plan
    type(state_type), intent(in) :: state              !< the motion
    type(tangent_type), intent(in) :: tangents(:)      !< derivatives of the constants by each parameter
    real(wp), intent(in) :: rates(:)                   !< (M) rates of the coordinates in the virtual motion
    type(gradient_rows_type), intent(in) :: held       !< with the multipliers of the motion, of order 2
    type(gradient_rows_type), intent(in) :: rows       !< with the multipliers of the rows
    type(parameter_changes_type), intent(in) :: self   !< the lists
    real(wp), intent(inout) :: by_parameters(:)        !< (P) derivatives of the force by the parameters
    real(wp) :: value, slope, bend, change
    integer :: i, j, k

    do i = 1, size(self%couplings)
      associate (p => self%couplings(i)%parameter, c => self%couplings(i)%number)
        associate (coupling => model%mechanism%couplings(plan%closures(c)%coupling)%coupling, &
                   part => tangents(p)%couplings(plan%closures(c)%coupling)%change)
          change = 0.0_wp
          do j = 1, size(coupling%coordinates)
            k = coupling%coordinates(j)
            value = coupling%varied_term(part, j, state%q(k), 0)
            slope = coupling%varied_term(part, j, state%q(k), 1)
            bend = coupling%varied_term(part, j, state%q(k), 2)
            change = change + rows%couplings(0, c)*value + rows%couplings(1, c)*slope*state%dq(k) &
                     + rows%couplings(2, c)*(slope*state%ddq(k) + bend*state%dq(k)**2) + held%couplings(2, c)*rates(k)*slope
          end do
          by_parameters(p) = by_parameters(p) - plan%closures(c)%weight*change
        end associate
      end associate
    end do
  end subroutine by_couplings

  !> Add the changes of a force by the numbers of drives, which give the motion of their coordinates.
  subroutine by_drives(model, plan, state, tangents, twists, d, rows, self, by_parameters)
    type(model_type), intent(in) :: model              !< the model
    type(plan_type), intent(in) :: plan                !< the plan, in the arithmetic
    type(state_type), intent(in) :: state              !< the motion
    type(tangent_type), intent(in) :: tangents(:)      !< derivatives of the constants by each parameter
    type(frame_twists_type), intent(in) :: twists      !< of the steps
    integer, intent(in) :: d                           !< numbers of a twist
    type(gradient_rows_type), intent(in) :: rows       !< rows of the force
    type(parameter_changes_type), intent(in) :: self   !< the lists
    real(wp), intent(inout) :: by_parameters(:)        !< (P) derivatives of the force by the parameters
    real(wp) :: change(0:2)
    integer :: i, order, s, k

    do i = 1, size(self%drives)
      associate (p => self%drives(i)%parameter, number => self%drives(i)%number)
        associate (drive => model%problem%drives(number)%drive)
          call drive%vary(tangents(p)%drives(number)%change, state%t, change(0), change(1), change(2))
          k = drive%coordinate
        end associate
        s = plan%step_of(k)
        do order = 0, 2
          by_parameters(p) = by_parameters(p) + change(order)*row_of_coordinate(d, order, twists%step(:, :, s), &
                                                                               rows%frames(:, :, s), rows%coordinates(:, k))
        end do
      end associate
    end do
  end subroutine by_drives

  !> Add the changes of a force by driven coordinates that change with parameters beside their drives' numbers.
  subroutine by_held(plan, held, twists, d, rows, by_parameters)
    type(plan_type), intent(in) :: plan                !< the plan, in the arithmetic
    real(wp), intent(in) :: held(:, 0:, :)             !< (P,0:2,M) derivatives of the coordinates, and of their derivatives in time
    type(frame_twists_type), intent(in) :: twists      !< of the steps
    integer, intent(in) :: d                           !< numbers of a twist
    type(gradient_rows_type), intent(in) :: rows       !< rows of the force
    real(wp), intent(inout) :: by_parameters(:)        !< (P) derivatives of the force by the parameters
    integer :: order, s, k

    do k = 1, size(held, 3)
      if (.not. plan%driven(k)) cycle
      s = plan%step_of(k)
      do order = 0, 2
        by_parameters = by_parameters + held(:, order, k)*row_of_coordinate(d, order, twists%step(:, :, s), rows%frames(:, :, s), &
                                                                           rows%coordinates(:, k))
      end do
    end do
  end subroutine by_held
end module mech9_parameter_changes
