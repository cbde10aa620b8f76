!> A position whose chains may be open, and its exact derivatives by coordinates and by the parameters of a design, each with all
!> others held: of the equations of the chains, and of points.
!>
!> At closed chains the derivatives of the dependent coordinates by the parameters follow from these.
module mech9_open_position
  use mech9_kinds, only: wp
  use mech9_error, only: error_type
  use mech9_rotation, only: turn, combine, cross
  use mech9_plan, only: plan_type, new_state
  use mech9_state, only: state_type
  use mech9_branch_stepping, only: set_inputs
  use mech9_frame_motion, only: place_all, point_motion
  use mech9_twists, only: shift_at
  use mech9_pair_changes, only: find_pair_change
  use mech9_design_space, only: design_type
  implicit none
  private
  public :: open_position_type, new_open_position, place_at, find_openings, find_derivatives, point_derivatives, &
    turn_derivatives, frame_derivatives

  type :: open_position_type
    class(state_type), allocatable :: state  !< the position, in space
    integer :: equations = 0                 !< of all chains and couplings
    real(wp), allocatable :: opening(:)      !< (equations) values of the equations [rad, lengths of the mechanism]
    real(wp), allocatable :: by_q(:, :)      !< (equations,M) derivatives by the coordinates, each in its unit
    real(wp), allocatable :: by_x(:, :)      !< (equations,P) derivatives by the parameters
    real(wp), allocatable :: frames(:, :, :) !< (6,P,0:M) twists of the frames by the parameters
  end type open_position_type

contains

  !> Room for the positions of a design.
  subroutine new_open_position(design, position)
    type(design_type), intent(in) :: design               !< any design
    type(open_position_type), intent(out) :: position     !< not placed yet
    integer :: c, m, p

    m = design%in_space%n_coordinates
    p = size(design%x)
    allocate (position%state, source=new_state(design%in_space))
    do c = 1, size(design%in_space%closures)
      position%equations = position%equations + design%in_space%constraints(c)%item%equations
    end do
    allocate (position%opening(position%equations), position%by_q(position%equations, m), position%by_x(position%equations, p), &
              position%frames(6, p, 0:m), source=0.0_wp)
  end subroutine new_open_position

  !> Place the frames at a position of a design, with the rates of the driven coordinates.
  subroutine place_at(design, t, q, position, err)
    type(design_type), intent(in) :: design                 !< placed
    real(wp), intent(in) :: t                               !< time [s]
    real(wp), intent(in) :: q(:)                            !< (M) coordinates [rad, m]
    type(open_position_type), intent(inout) :: position     !< gets frames and rates
    type(error_type), allocatable, intent(out) :: err       !< allocated if a pair has no pose there
    real(wp) :: driven(size(q))

    position%state%t = t
    position%state%q = q
    driven = q
    call set_inputs(design%drives, t, driven, position%state%dq, position%state%ddq, err)
    if (.not. allocated(err)) call place_all(design%in_space, position%state, err)
  end subroutine place_at

  !> Place the frames at the coordinates in the state, and evaluate the equations of the chains.
  subroutine find_openings(design, position, err)
    type(design_type), intent(in) :: design                 !< placed
    type(open_position_type), intent(inout) :: position     !< with coordinates; gets the values of the equations
    type(error_type), allocatable, intent(out) :: err       !< allocated if a pair has no pose there
    integer :: c, row

    call place_all(design%in_space, position%state, err)
    if (allocated(err)) return
    row = 0
    do c = 1, size(design%in_space%closures)
      associate (constraint => design%in_space%constraints(c)%item)
        call constraint%residual(design%in_space, position%state, position%opening(row + 1:row + constraint%equations))
        row = row + constraint%equations
      end associate
    end do
  end subroutine find_openings

  !> Find the derivatives of the equations.
  subroutine find_derivatives(design, position)
    type(design_type), intent(in) :: design                 !< placed, with its tangents
    type(open_position_type), intent(inout) :: position     !< with its frames in place; gets the derivatives
    integer :: c, i, p, row

    call find_twists(design, position)
    position%by_q = 0.0_wp
    position%by_x = 0.0_wp
    row = 0
    do c = 1, size(design%in_space%closures)
      associate (plan => design%in_space, closure => design%in_space%closures(c), constraint => design%in_space%constraints(c)%item)
        do i = 1, size(closure%loop%steps)
          call constraint%column(plan, closure%loop%steps(i), closure%loop%signs(i), position%state, &
                                 position%by_q(row + 1:row + constraint%equations, plan%steps(closure%loop%steps(i))%coordinate))
        end do
        do p = 1, size(design%x)
          if (closure%coupling == 0) then
            call open_by_parameter(design, position, c, p, position%by_x(row + 1:row + constraint%equations, p))
          else
            position%by_x(row + 1, p) = coupling_by_parameter(design, position, c, p)
          end if
        end do
        row = row + constraint%equations
      end associate
    end do
  end subroutine find_derivatives

  !> The twists of all frames by the parameters, while the coordinates are held.
  subroutine find_twists(design, position)
    type(design_type), intent(in) :: design                 !< placed, with its tangents
    type(open_position_type), intent(inout) :: position     !< with its frames in place; gets the twists
    real(wp) :: about(6), along(6), by_coordinate(6, 0:2)
    integer :: s, p, k

    position%frames(:, :, 0) = 0.0_wp
    do s = 1, design%in_space%n_coordinates
      associate (step => design%in_space%steps(s), state => position%state)
        k = step%coordinate
        do p = 1, size(design%x)
          position%frames(:, p, s) = position%frames(:, p, step%parent)
          associate (tangent => design%tangents(p), twist => position%frames(:, p, s))
            if (tangent%moves(k)) twist = twist + carried(state, step%parent, tangent%before(:, k))
            if (abs(tangent%offset(k)) > 0.0_wp) then
              about = [state%axis_w(:, s), state%axis_v(:, s) - cross(state%axis_w(:, s), state%p(:, s))]
              twist = twist + tangent%offset(k)*about
            end if
            if (abs(tangent%slide(k)) > 0.0_wp) then
              along(1:3) = 0.0_wp
              along(4:6) = step%before%r(:, 3)*tangent%slide(k)*(state%q(k) + step%offset)
              twist = twist + carried(state, step%parent, along)
            end if
            if (tangent%pairs(k)%varies) then
              call find_pair_change(design%in_space, state, tangent, s, by_coordinate)
              twist = twist + by_coordinate(:, 0)
            end if
          end associate
        end do
      end associate
    end do
  end subroutine find_twists

  !> A twist that is constant in a frame, in the axes of frame 0 and at its origin.
  pure function carried(state, f, twist) result(seen)
    type(state_type), intent(in) :: state   !< with the poses of the frames
    integer, intent(in) :: f                !< the frame
    real(wp), intent(in) :: twist(6)        !< in the frame [rad, m]
    real(wp) :: seen(6)

    seen(1:3) = turn(state%r(:, :, f), twist(1:3))
    seen(4:6) = turn(state%r(:, :, f), twist(4:6)) + cross(state%p(:, f), seen(1:3))
  end function carried

  !> The derivative of a chain's equations by one parameter.
  subroutine open_by_parameter(design, position, c, p, values)
    type(design_type), intent(in) :: design                !< placed, with its tangents
    type(open_position_type), intent(in) :: position       !< with the twists of its frames
    integer, intent(in) :: c                               !< number of the closure
    integer, intent(in) :: p                               !< number of the parameter
    real(wp), intent(inout), contiguous :: values(:)       !< (equations) zero on entry
    real(wp) :: twist(6)

    associate (plan => design%in_space, closure => design%in_space%closures(c))
      twist = position%frames(:, p, closure%closing) - position%frames(:, p, closure%target)
      associate (of_target => design%tangents(p)%in_target(:, plan%steps(closure%closing)%coordinate))
        if (any(abs(of_target) > 0.0_wp)) twist = twist - carried(position%state, closure%target, of_target)
      end associate
      if (.not. any(abs(twist) > 0.0_wp)) return      ! the values are zero already
      call plan%constraints(c)%item%opening(plan, position%state, twist(1:3), &
                                            shift_at(twist, position%state%p(:, closure%closing)), values)
    end associate
  end subroutine open_by_parameter

  !> The derivative of the equation of a coupling by one parameter.
  real(wp) function coupling_by_parameter(design, position, c, p) result(value)
    type(design_type), intent(in) :: design                !< placed, with its tangents
    type(open_position_type), intent(in) :: position       !< with its coordinates
    integer, intent(in) :: c                               !< number of the closure that is the coupling
    integer, intent(in) :: p                               !< number of the parameter
    integer :: i

    value = 0.0_wp
    associate (number => design%in_space%closures(c)%coupling)
      associate (tangent => design%tangents(p)%couplings(number), coupling => design%in_space%couplings(number)%coupling)
        if (.not. tangent%varies) return
        do i = 1, size(coupling%coordinates)
          value = value + coupling%varied_term(tangent%change, i, position%state%q(coupling%coordinates(i)), 0)
        end do
      end associate
    end associate
    value = design%in_space%closures(c)%weight*value
  end function coupling_by_parameter

  !> A point and its derivatives by coordinates and parameters. Without a number it is the origin of the link.
  subroutine point_derivatives(design, position, number, link, place, by_q, by_x)
    type(design_type), intent(in) :: design                !< placed, with its tangents
    type(open_position_type), intent(in) :: position       !< with the twists of its frames
    integer, intent(in) :: number                          !< of the point; 0: the origin of the link
    integer, intent(in) :: link                            !< its link
    real(wp), intent(out) :: place(3)                      !< in the system of link 1 [m]
    real(wp), intent(out) :: by_q(:, :)                    !< (3,M) by the coordinates, each in its unit
    real(wp), intent(out) :: by_x(:, :)                    !< (3,P) by the parameters
    real(wp) :: constant(6), twist(6), arm(3)
    integer :: p

    associate (plan => design%in_space, state => position%state)
      if (number == 0) then
        call point_motion(plan, state, link, [0.0_wp, 0.0_wp, 0.0_wp], place)
      else
        call point_motion(plan, state, link, design%places(:, number), place)
      end if
      arm = place - plan%origin
      call shifts_by_steps(plan, state, plan%frame_of(link), arm, by_q)
      do p = 1, size(design%x)
        constant = design%tangents(p)%link(:, link)
        if (number > 0) &
          constant(4:6) = constant(4:6) + turn(plan%link_in_frame(link)%r, design%tangents(p)%points(:, number))
        twist = position%frames(:, p, plan%frame_of(link)) + carried(state, plan%frame_of(link), constant)
        by_x(:, p) = shift_at(twist, arm)
      end do
    end associate
  end subroutine point_derivatives

  !> The shifts of a point of a frame by unit changes of the coordinates.
  pure subroutine shifts_by_steps(plan, state, frame, arm, by_q)
    type(plan_type), intent(in) :: plan        !< the plan of the design, in space
    type(state_type), intent(in) :: state      !< with the poses of the frames and the screws of the steps
    integer, intent(in) :: frame               !< the frame
    real(wp), intent(in) :: arm(3)             !< the point, from the origin of frame 0 [m]
    real(wp), intent(out) :: by_q(:, :)        !< (3,M) by the coordinates, each in its unit
    integer :: s

    by_q = 0.0_wp
    s = frame
    do while (s > 0)
      by_q(:, plan%steps(s)%coordinate) = plan%unit_of(plan%steps(s)%coordinate) &
                                          *(state%axis_v(:, s) + cross(state%axis_w(:, s), arm - state%p(:, s)))
      s = plan%steps(s)%parent
    end do
  end subroutine shifts_by_steps

  !> The rotation of a link and its derivatives by coordinates and parameters, as small rotations in the axes of link 1.
  subroutine turn_derivatives(design, position, link, r, by_q, by_x)
    type(design_type), intent(in) :: design                !< placed, with its tangents
    type(open_position_type), intent(in) :: position       !< with the twists of its frames
    integer, intent(in) :: link                            !< number of the link
    real(wp), intent(out) :: r(3, 3)                       !< rotation from the link's axes to those of link 1
    real(wp), intent(out) :: by_q(:, :)                    !< (3,M) by the coordinates, each in its unit
    real(wp), intent(out) :: by_x(:, :)                    !< (3,P) by the parameters
    integer :: s, p

    associate (plan => design%in_space, state => position%state)
      r = combine(state%r(:, :, plan%frame_of(link)), plan%link_in_frame(link)%r)
      call turns_by_steps(plan, state, plan%frame_of(link), by_q)
      do p = 1, size(design%x)
        s = plan%frame_of(link)
        by_x(:, p) = position%frames(1:3, p, s) + turn(state%r(:, :, s), design%tangents(p)%link(1:3, link))
      end do
    end associate
  end subroutine turn_derivatives

  !> The rotations of a frame by unit changes of the coordinates.
  pure subroutine turns_by_steps(plan, state, frame, by_q)
    type(plan_type), intent(in) :: plan        !< the plan of the design, in space
    type(state_type), intent(in) :: state      !< with the screws of the steps
    integer, intent(in) :: frame               !< the frame
    real(wp), intent(out) :: by_q(:, :)        !< (3,M) by the coordinates, each in its unit
    integer :: s

    by_q = 0.0_wp
    s = frame
    do while (s > 0)
      by_q(:, plan%steps(s)%coordinate) = plan%unit_of(plan%steps(s)%coordinate)*state%axis_w(:, s)
      s = plan%steps(s)%parent
    end do
  end subroutine turns_by_steps

  !> The shift of a frame's origin and the rotation of the frame, by coordinates and parameters.
  subroutine frame_derivatives(design, position, s, shift_by_q, shift_by_x, turn_by_q, turn_by_x)
    type(design_type), intent(in) :: design                !< placed, with its tangents
    type(open_position_type), intent(in) :: position       !< with the twists of its frames
    integer, intent(in) :: s                               !< number of the frame
    real(wp), intent(out) :: shift_by_q(:, :)              !< (3,M) by the coordinates, each in its unit
    real(wp), intent(out) :: shift_by_x(:, :)              !< (3,P) by the parameters
    real(wp), intent(out) :: turn_by_q(:, :)               !< (3,M) by the coordinates, each in its unit
    real(wp), intent(out) :: turn_by_x(:, :)               !< (3,P) by the parameters
    integer :: p

    call shifts_by_steps(design%in_space, position%state, s, position%state%p(:, s), shift_by_q)
    call turns_by_steps(design%in_space, position%state, s, turn_by_q)
    do p = 1, size(design%x)
      shift_by_x(:, p) = shift_at(position%frames(:, p, s), position%state%p(:, s))
      turn_by_x(:, p) = position%frames(1:3, p, s)
    end do
  end subroutine frame_derivatives
end module mech9_open_position
