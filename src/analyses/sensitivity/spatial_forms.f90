!> Columns of the openings of chains, of couplings and of the shifts of points in space, with their derivatives in time.
module mech9_spatial_forms
  use mech9_kinds, only: wp
  use mech9_rotation, only: turn, cross
  use mech9_plan, only: plan_type, closure_type
  use mech9_state, only: state_type
  use mech9_spatial_closure, only: reduced_screw
  use mech9_coupling_constraint, only: coupling_factors
  use mech9_twists, only: frame_twists_type, carried, shift_at
  use mech9_parameter_support, only: varied_constant_type
  use mech9_linear_form, only: linear_form_type, put_constant
  implicit none
  private
  public :: carry_in_space, fill_spatial_closure, fill_whole_closure, fill_coupling, fill_spatial_point

contains

  !> Twists of constants, seen from frame 0, and their derivatives in time.
  pure subroutine carry_in_space(plan, n, constants, state, twists, highest, again, series)
    type(plan_type), intent(in) :: plan                     !< the plan, in space
    integer, intent(in) :: n                                !< number of twists
    type(varied_constant_type), intent(in) :: constants(n)  !< the twists
    type(state_type), intent(in) :: state                   !< the motion
    type(frame_twists_type), intent(in) :: twists           !< of its frames
    integer, intent(in) :: highest                          !< order of the highest derivative
    logical, intent(in) :: again                            !< twists of the ground are in `series` already
    real(wp), intent(inout) :: series(6, 0:2, n)            !< gets the twists up to this derivative
    real(wp) :: length(0:2)
    integer :: i

    do i = 1, n
      associate (constant => constants(i))
        if (again .and. constant%frame == 0 .and. constant%stretched_by == 0) cycle
        call carried(state, twists, constant%frame, constant%twist, highest, series(:, :, i))
        if (constant%stretched_by == 0) cycle
        length(0) = state%q(constant%stretched_by) + plan%steps(constant%step)%offset
        length(1) = state%dq(constant%stretched_by)
        length(2) = state%ddq(constant%stretched_by)
        series(:, 2, i) = length(2)*series(:, 0, i) + 2.0_wp*length(1)*series(:, 1, i) + length(0)*series(:, 2, i)
        series(:, 1, i) = length(1)*series(:, 0, i) + length(0)*series(:, 1, i)
        series(:, 0, i) = length(0)*series(:, 0, i)
      end associate
    end do
  end subroutine carry_in_space

  !> Fill the form of a closed chain: the independent components of its opening.
  pure subroutine fill_spatial_closure(plan, c, state, twists, highest, series, form)
    type(plan_type), intent(in) :: plan                  !< the plan, in space
    integer, intent(in) :: c                             !< number of the closure
    type(state_type), intent(in) :: state                !< the motion
    type(frame_twists_type), intent(in) :: twists        !< of its steps
    integer, intent(in) :: highest                       !< order of the highest derivative
    real(wp), intent(in) :: series(:, 0:, :)             !< (6,0:2,constants) twists of constants
    type(linear_form_type), intent(inout) :: form        !< gets its columns and shares
    real(wp) :: share(6, 0:2), few(18)
    integer :: i, order

    associate (closure => plan%closures(c), per_length => 1.0_wp/plan%length)
      if (closure%rank == 6) then
        do i = 1, size(form%steps)
          call shift_to_place(form%signs(i), per_length, state%p(:, closure%closing), twists%step(:, :, form%steps(i)), highest, &
                              form%columns(:, :, i))
        end do
        do i = 1, size(form%constants)
          call shift_to_place(form%constant_signs(i), per_length, state%p(:, closure%closing), series(:, :, form%constants(i)), &
                              highest, share)
          call put_constant(form, i, highest, share)
        end do
        return
      end if
      do i = 1, size(form%steps)
        do order = 0, highest
          call reduce(plan, closure, state, form%signs(i), twists%step(:, order, form%steps(i)), form%columns(:, order, i))
        end do
      end do
      do i = 1, size(form%constants)
        do order = 0, highest
          call reduce(plan, closure, state, form%constant_signs(i), series(:, order, form%constants(i)), &
                      few(order*form%rows + 1:(order + 1)*form%rows))
        end do
        call put_constant(form, i, highest, few)
      end do
    end associate
  end subroutine fill_spatial_closure

  !> The components of a twist in the equations of a closure.
  pure subroutine reduce(plan, closure, state, factor, twist, rows)
    type(plan_type), intent(in) :: plan            !< the plan, in space
    type(closure_type), intent(in) :: closure      !< the closure
    type(state_type), intent(in) :: state          !< with the poses of the frames
    real(wp), intent(in) :: factor                 !< of the twist
    real(wp), intent(in) :: twist(6)               !< rotation, and shift at the origin of frame 0
    real(wp), intent(inout) :: rows(:)             !< the components
    integer :: i

    call reduced_screw(plan, closure, state, twist(1:3), twist(4:6), [0.0_wp, 0.0_wp, 0.0_wp], rows)
    do i = 1, size(rows)
      rows(i) = factor*rows(i)
    end do
  end subroutine reduce

  !> A twist and its derivatives at a place, with a factor, its shift in lengths of the mechanism.
  pure subroutine shift_to_place(factor, per_length, p, twist, highest, rows)
    real(wp), intent(in) :: factor                 !< of the twist
    real(wp), intent(in) :: per_length             !< one over the length of the mechanism [1/m]
    real(wp), intent(in) :: p(3)                   !< the place [m]
    real(wp), intent(in) :: twist(6, 0:2)          !< rotation, and shift at the origin of frame 0
    integer, intent(in) :: highest                 !< order of the highest derivative
    real(wp), intent(inout) :: rows(6, 0:2)        !< the same at the place
    real(wp) :: scaled
    integer :: o

    scaled = factor*per_length
    do o = 0, highest
      rows(1, o) = factor*twist(1, o)
      rows(2, o) = factor*twist(2, o)
      rows(3, o) = factor*twist(3, o)
      rows(4, o) = scaled*(twist(4, o) + twist(2, o)*p(3) - twist(3, o)*p(2))
      rows(5, o) = scaled*(twist(5, o) + twist(3, o)*p(1) - twist(1, o)*p(3))
      rows(6, o) = scaled*(twist(6, o) + twist(1, o)*p(2) - twist(2, o)*p(1))
    end do
  end subroutine shift_to_place

  !> Fill the form of the whole opening of a closed chain, with the components that its equations leave out. Only the openings
  !> themselves are filled, not their derivatives in time.
  pure subroutine fill_whole_closure(plan, c, state, twists, series, form)
    type(plan_type), intent(in) :: plan                  !< the plan, in space
    integer, intent(in) :: c                             !< number of the closure
    type(state_type), intent(in) :: state                !< with the poses of the frames
    type(frame_twists_type), intent(in) :: twists        !< of the steps
    real(wp), intent(in) :: series(:, 0:, :)             !< (6,0:2,constants) twists of constants
    type(linear_form_type), intent(inout) :: form        !< six rows; gets its columns and shares
    real(wp) :: share(6, 0:2)
    integer :: i

    associate (p => state%p(:, plan%closures(c)%closing), per_length => 1.0_wp/plan%length)
      do i = 1, size(form%steps)
        call shift_to_place(form%signs(i), per_length, p, twists%step(:, :, form%steps(i)), 0, form%columns(:, :, i))
      end do
      do i = 1, size(form%constants)
        call shift_to_place(form%constant_signs(i), per_length, p, series(:, :, form%constants(i)), 0, share)
        call put_constant(form, i, 0, share)
      end do
    end associate
  end subroutine fill_whole_closure

  !> Fill the form of a coupling.
  pure subroutine fill_coupling(plan, c, state, third, form)
    type(plan_type), intent(in) :: plan                  !< the plan, in space
    integer, intent(in) :: c                             !< number of the closure that is the coupling
    type(state_type), intent(in) :: state                !< the motion
    real(wp), intent(in) :: third                        !< third derivative of the coupling's function
    type(linear_form_type), intent(inout) :: form        !< one row; gets its columns
    integer :: i

    associate (coupling => plan%couplings(plan%closures(c)%coupling)%coupling)
      do i = 1, size(form%steps)
        form%columns(1, :, i) = coupling_factors(plan, c, state, third, findloc(coupling%coordinates, form%coordinates(i), dim=1))
      end do
    end associate
  end subroutine fill_coupling

  !> Fill the form of the shift of a point.
  pure subroutine fill_spatial_point(frame, place, state, twists, highest, series, form)
    integer, intent(in) :: frame                         !< frame with which the point moves
    real(wp), intent(in) :: place(3)                     !< the point in this frame [m]
    type(state_type), intent(in) :: state                !< the motion
    type(frame_twists_type), intent(in) :: twists        !< of its steps
    integer, intent(in) :: highest                       !< order of the highest derivative
    real(wp), intent(in) :: series(:, 0:, :)             !< (6,0:2,constants) twists of constants
    type(linear_form_type), intent(inout) :: form        !< gets its columns and shares
    real(wp) :: arm(3), slip(3), p(3, 0:2), share(3, 0:2)
    integer :: i

    p = 0.0_wp
    arm = turn(state%r(:, :, frame), place)
    p(:, 0) = state%p(:, frame) + arm
    if (highest > 0) then
      slip = cross(state%omega(:, frame), arm)
      p(:, 1) = state%v(:, frame) + slip
    end if
    if (highest > 1) p(:, 2) = state%a(:, frame) + cross(state%alpha(:, frame), arm) + cross(state%omega(:, frame), slip)
    do i = 1, size(form%steps)
      call shift_point(p, twists%step(:, :, form%steps(i)), highest, form%columns(:, :, i))
    end do
    do i = 1, size(form%constants)
      call shift_point(p, series(:, :, form%constants(i)), highest, share)
      call put_constant(form, i, highest, share)
    end do
  end subroutine fill_spatial_point

  !> The shift of a moving point by a twist, and its derivatives in time.
  pure subroutine shift_point(p, twist, highest, shift)
    real(wp), intent(in) :: p(3, 0:2)            !< the point, its velocity and its acceleration [m]
    real(wp), intent(in) :: twist(6, 0:2)        !< the twist and its derivatives
    integer, intent(in) :: highest               !< order of the highest derivative
    real(wp), intent(inout) :: shift(3, 0:2)     !< of the point [m]

    shift(:, 0) = shift_at(twist(:, 0), p(:, 0))
    if (highest == 0) return
    shift(:, 1) = shift_at(twist(:, 1), p(:, 0)) + cross(twist(1:3, 0), p(:, 1))
    if (highest == 1) return
    shift(:, 2) = shift_at(twist(:, 2), p(:, 0)) + 2.0_wp*cross(twist(1:3, 1), p(:, 1)) + cross(twist(1:3, 0), p(:, 2))
  end subroutine shift_point
end module mech9_spatial_forms
