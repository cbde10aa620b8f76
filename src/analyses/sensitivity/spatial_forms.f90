!> Columns of the openings of chains and of the shifts of points in space, with their derivatives in time, at several positions at once.
module mech9_spatial_forms
  use mech9_kinds, only: wp
  use mech9_batch_products, only: batch_size
  use mech9_plan, only: plan_type
  use mech9_spatial_batch, only: spatial_batch_type
  use mech9_linear_form, only: linear_form_type, keep_double
  use mech9_parameter_support, only: carried_constants_type, place_in_frame_type
  implicit none
  private
  public :: carry_in_space, fill_spatial_closure, fill_spatial_point

contains

  !> Twists of constants, seen from frame 0, and their derivatives in time.
  pure subroutine carry_in_space(n, apart, motion, highest, again, constants)
    integer, intent(in) :: n                                  !< number of positions
    logical, intent(in) :: apart(:)                           !< (constants) twists that were found for each position by itself
    type(spatial_batch_type), intent(in) :: motion            !< the motion of the frames, with the derivatives of their rotations
    integer, intent(in) :: highest                            !< order of the highest derivative
    logical, intent(in) :: again                              !< twists of the ground were carried already, for whole batches
    type(carried_constants_type), intent(inout) :: constants  !< get their twists up to this derivative
    integer :: i, order, all_or_n

    do i = 1, size(constants%list)
      if (apart(i)) cycle
      associate (k => constants%list(i)%frame, twist => constants%list(i)%twist)
        if (again .and. k == 0) cycle
        all_or_n = merge(batch_size, n, k == 0)
        do order = 0, highest
          call turn_vector(all_or_n, motion%r(1, 1, 1, order, k), twist(4:6), constants%series(1, 4, order, i))
        end do
        if (.not. any(abs(twist(1:3)) > 0.0_wp)) cycle
        do order = 0, highest
          call turn_vector(all_or_n, motion%r(1, 1, 1, order, k), twist(1:3), constants%series(1, 1, order, i))
        end do
        call shift_origin(all_or_n, motion%p(:, :, :, k), highest, constants%series(:, :, :, i))
      end associate
    end do
  end subroutine carry_in_space

  ! The procedures of one column take arrays of known shape, so that the compiler keeps their addresses in registers.

  !> A vector that is constant in a frame, in the axes of frame 0.
  pure subroutine turn_vector(n, r, vector, turned)
    integer, intent(in) :: n                             !< number of positions
    real(wp), intent(in) :: r(batch_size, 3, 3)          !< rotation of the frame, or a derivative in time
    real(wp), intent(in) :: vector(3)                    !< in the axes of the frame
    real(wp), intent(inout) :: turned(batch_size, 3)     !< in those of frame 0
    integer :: i

    do i = 1, n
      turned(i, 1) = r(i, 1, 1)*vector(1) + r(i, 1, 2)*vector(2) + r(i, 1, 3)*vector(3)
      turned(i, 2) = r(i, 2, 1)*vector(1) + r(i, 2, 2)*vector(2) + r(i, 2, 3)*vector(3)
      turned(i, 3) = r(i, 3, 1)*vector(1) + r(i, 3, 2)*vector(2) + r(i, 3, 3)*vector(3)
    end do
  end subroutine turn_vector

  !> Add the shift of the point at the origin of frame 0 by a rotation about the origin of a frame.
  pure subroutine shift_origin(n, p, highest, series)
    integer, intent(in) :: n                               !< number of positions
    real(wp), intent(in) :: p(batch_size, 3, 0:2)          !< origin of the frame with its derivatives in time [m]
    integer, intent(in) :: highest                         !< order of the highest derivative
    real(wp), intent(inout) :: series(batch_size, 6, 0:2)  !< the twist with its derivatives; gets more shift

    call add_cross(n, 1.0_wp, p(1, 1, 0), series(1, 1, 0), series(1, 4, 0))
    if (highest == 0) return
    call add_cross(n, 1.0_wp, p(1, 1, 0), series(1, 1, 1), series(1, 4, 1))
    call add_cross(n, 1.0_wp, p(1, 1, 1), series(1, 1, 0), series(1, 4, 1))
    if (highest == 1) return
    call add_cross(n, 1.0_wp, p(1, 1, 0), series(1, 1, 2), series(1, 4, 2))
    call add_cross(n, 2.0_wp, p(1, 1, 1), series(1, 1, 1), series(1, 4, 2))
    call add_cross(n, 1.0_wp, p(1, 1, 2), series(1, 1, 0), series(1, 4, 2))
  end subroutine shift_origin

  !> Add a multiple of a vector product.
  pure subroutine add_cross(n, factor, u, v, w)
    integer, intent(in) :: n                        !< number of positions
    real(wp), intent(in) :: factor                  !< of the product
    real(wp), intent(in) :: u(batch_size, 3)        !< left factor
    real(wp), intent(in) :: v(batch_size, 3)        !< right factor
    real(wp), intent(inout) :: w(batch_size, 3)     !< the sum
    integer :: i

    do i = 1, n
      w(i, 1) = w(i, 1) + factor*(u(i, 2)*v(i, 3) - u(i, 3)*v(i, 2))
      w(i, 2) = w(i, 2) + factor*(u(i, 3)*v(i, 1) - u(i, 1)*v(i, 3))
      w(i, 3) = w(i, 3) + factor*(u(i, 1)*v(i, 2) - u(i, 2)*v(i, 1))
    end do
  end subroutine add_cross

  !> Fill the form of a closed chain with all six components of its opening.
  pure subroutine fill_spatial_closure(n, plan, c, motion, highest, constants, form)
    integer, intent(in) :: n                                 !< number of positions
    type(plan_type), intent(in) :: plan                      !< the plan, in space
    integer, intent(in) :: c                                 !< number of the closure
    type(spatial_batch_type), intent(in) :: motion           !< the motion of the frames and steps
    integer, intent(in) :: highest                           !< order of the highest derivative
    type(carried_constants_type), intent(in) :: constants    !< the constants
    type(linear_form_type), intent(inout) :: form            !< gets its columns and shares
    integer :: i, all_or_n

    associate (p => motion%p(:, :, 0, plan%closures(c)%closing), per_length => 1.0_wp/plan%length)
      do i = 1, size(form%steps)
        call clear(n, 6, highest, form%columns(:, :, :, i))
        call shift_to_place(n, form%signs(i), per_length, p, motion%step(:, :, :, form%steps(i)), highest, form%columns(:, :, :, i))
      end do
      if (highest > 1) call keep_double(form, n)
      do i = 1, size(form%constants)
        if (form%keeps(i) .and. form%is_filled) cycle
        all_or_n = merge(batch_size, n, form%keeps(i))
        associate (k => form%constants(i), share => form%shares(:, :, :, form%slots(form%parameters(i))))
          if (form%is_first(i)) call clear(all_or_n, 6, highest, share)
          if (any(abs(constants%list(k)%twist(1:3)) > 0.0_wp) .or. constants%list(k)%by_pair) then
            call shift_to_place(all_or_n, form%constant_signs(i), per_length, p, constants%series(:, :, :, k), highest, share)
          else
            call add_shift(all_or_n, form%constant_signs(i)*per_length, constants%series(:, :, :, k), highest, share)
          end if
        end associate
      end do
    end associate
    form%is_filled = .true.
  end subroutine fill_spatial_closure

  !> Set numbers of a column and their derivatives to zero.
  pure subroutine clear(n, rows, highest, column)
    integer, intent(in) :: n                                    !< number of positions
    integer, intent(in) :: rows                                 !< of the column
    integer, intent(in) :: highest                              !< order of the highest derivative
    real(wp), intent(inout) :: column(batch_size, rows, 0:*)    !< the column
    integer :: order

    do order = 0, highest
      column(:n, :, order) = 0.0_wp
    end do
  end subroutine clear

  !> Add a twist and its derivatives at a place, with a factor, its shift in lengths of the mechanism.
  pure subroutine shift_to_place(n, factor, per_length, p, twist, highest, rows)
    integer, intent(in) :: n                               !< number of positions
    real(wp), intent(in) :: factor                         !< of the twist
    real(wp), intent(in) :: per_length                     !< one over the length of the mechanism [1/m]
    real(wp), intent(in) :: p(batch_size, 3)               !< the place [m]
    real(wp), intent(in) :: twist(batch_size, 6, 0:2)      !< rotation, and shift at the origin of frame 0
    integer, intent(in) :: highest                         !< order of the highest derivative
    real(wp), intent(inout) :: rows(batch_size, 6, 0:*)    !< the sum
    real(wp) :: scaled
    integer :: i, o

    scaled = factor*per_length
    do o = 0, highest
      do i = 1, n
        rows(i, 1, o) = rows(i, 1, o) + factor*twist(i, 1, o)
        rows(i, 2, o) = rows(i, 2, o) + factor*twist(i, 2, o)
        rows(i, 3, o) = rows(i, 3, o) + factor*twist(i, 3, o)
        rows(i, 4, o) = rows(i, 4, o) + scaled*(twist(i, 4, o) + twist(i, 2, o)*p(i, 3) - twist(i, 3, o)*p(i, 2))
        rows(i, 5, o) = rows(i, 5, o) + scaled*(twist(i, 5, o) + twist(i, 3, o)*p(i, 1) - twist(i, 1, o)*p(i, 3))
        rows(i, 6, o) = rows(i, 6, o) + scaled*(twist(i, 6, o) + twist(i, 1, o)*p(i, 2) - twist(i, 2, o)*p(i, 1))
      end do
    end do
  end subroutine shift_to_place

  !> Add a twist without rotation: its shift is the same everywhere.
  pure subroutine add_shift(n, factor, twist, highest, rows)
    integer, intent(in) :: n                               !< number of positions
    real(wp), intent(in) :: factor                         !< of the twist
    real(wp), intent(in) :: twist(batch_size, 6, 0:2)      !< rotation, which is zero, and shift
    integer, intent(in) :: highest                         !< order of the highest derivative
    real(wp), intent(inout) :: rows(batch_size, 6, 0:2)    !< the sum
    integer :: i, o, r

    do o = 0, highest
      do r = 4, 6
        do i = 1, n
          rows(i, r, o) = rows(i, r, o) + factor*twist(i, r, o)
        end do
      end do
    end do
  end subroutine add_shift

  !> Fill the form of the shift of a point.
  pure subroutine fill_spatial_point(n, point, motion, highest, constants, form)
    integer, intent(in) :: n                                 !< number of positions
    type(place_in_frame_type), intent(in) :: point           !< the point
    type(spatial_batch_type), intent(in) :: motion           !< the motion of the frames and steps
    integer, intent(in) :: highest                           !< order of the highest derivative
    type(carried_constants_type), intent(in) :: constants    !< the constants
    type(linear_form_type), intent(inout) :: form            !< gets its columns and shares
    real(wp) :: p(batch_size, 3, 0:2)
    integer :: i, order, all_or_n

    do order = 0, highest
      call turn_vector(n, motion%r(1, 1, 1, order, point%frame), point%place, p(1, 1, order))
      p(:n, :, order) = p(:n, :, order) + motion%p(:n, :, order, point%frame)
    end do
    do i = 1, size(form%steps)
      call clear(n, 3, highest, form%columns(:, :, :, i))
      call shift_point(n, .true., p, motion%step(:, :, :, form%steps(i)), highest, form%columns(:, :, :, i))
    end do
    if (highest > 1) call keep_double(form, n)
    do i = 1, size(form%constants)
      if (form%keeps(i) .and. form%is_filled) cycle
      all_or_n = merge(batch_size, n, form%keeps(i))
      associate (k => form%constants(i), share => form%shares(:, :, :, form%slots(form%parameters(i))))
        if (form%is_first(i)) call clear(all_or_n, 3, highest, share)
        call shift_point(all_or_n, any(abs(constants%list(k)%twist(1:3)) > 0.0_wp) .or. constants%list(k)%by_pair, p, &
                         constants%series(:, :, :, k), highest, share)
      end associate
    end do
    form%is_filled = .true.
  end subroutine fill_spatial_point

  !> Add the shift of a moving point by a twist with its derivatives in time.
  pure subroutine shift_point(n, turns, p, twist, highest, shift)
    integer, intent(in) :: n                               !< number of positions
    logical, intent(in) :: turns                           !< the twist has a rotation
    real(wp), intent(in) :: p(batch_size, 3, 0:2)          !< the point, its velocity and its acceleration [m, m/s, m/s^2]
    real(wp), intent(in) :: twist(batch_size, 6, 0:2)      !< the twist and its derivatives
    integer, intent(in) :: highest                         !< order of the highest derivative
    real(wp), intent(inout) :: shift(batch_size, 3, 0:*)   !< the sum [m]
    integer :: i, o, r

    do o = 0, highest
      do r = 1, 3
        do i = 1, n
          shift(i, r, o) = shift(i, r, o) + twist(i, 3 + r, o)
        end do
      end do
      if (turns) call add_cross(n, 1.0_wp, twist(1, 1, o), p(1, 1, 0), shift(1, 1, o))
    end do
    if (.not. turns .or. highest == 0) return
    call add_cross(n, 1.0_wp, twist(1, 1, 0), p(1, 1, 1), shift(1, 1, 1))
    if (highest == 1) return
    call add_cross(n, 2.0_wp, twist(1, 1, 1), p(1, 1, 1), shift(1, 1, 2))
    call add_cross(n, 1.0_wp, twist(1, 1, 0), p(1, 1, 2), shift(1, 1, 2))
  end subroutine shift_point
end module mech9_spatial_forms
