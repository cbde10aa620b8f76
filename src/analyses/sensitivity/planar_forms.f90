!> Columns of the openings of chains and of the shifts of points in planar arithmetic, with their derivatives in time, at several
!> positions at once.
!>
!> A twist in the plane is a rotation about the normal and the shift of the point that coincides with the origin of frame 0.
module mech9_planar_forms
  use mech9_kinds, only: wp
  use mech9_batch_products, only: batch_size
  use mech9_planar_plan, only: planar_plan_type
  use mech9_planar_batch, only: planar_batch_type
  use mech9_linear_form, only: linear_form_type, keep_double
  use mech9_parameter_support, only: carried_constants_type, place_in_frame_type
  implicit none
  private
  public :: carry_in_plane, fill_planar_closure, fill_planar_point

contains

  !> Twists of constants, seen from frame 0, and their derivatives in time.
  pure subroutine carry_in_plane(n, motion, highest, again, constants)
    integer, intent(in) :: n                                   !< number of positions
    type(planar_batch_type), intent(in) :: motion              !< the motion of the frames, with the derivatives of their spins
    integer, intent(in) :: highest                             !< order of the highest derivative
    logical, intent(in) :: again                               !< twists of the ground were carried already, for whole batches
    type(carried_constants_type), intent(inout) :: constants   !< with rotation and shifts in twist(1:3), in the axes of the planar
                                                               !< frames; get their twists up to this derivative
    integer :: i, all_or_n

    do i = 1, size(constants%list)
      associate (k => constants%list(i)%frame, twist => constants%list(i)%twist)
        if (again .and. k == 0) cycle
        all_or_n = merge(batch_size, n, k == 0)
        call shift_with_frame(all_or_n, twist(2), twist(3), motion%spin(:, :, :, k), highest, constants%series(:, :, :, i))
        if (abs(twist(1)) > 0.0_wp) &
          call turn_with_frame(all_or_n, twist(1), motion%place(:, :, :, k), highest, constants%series(:, :, :, i))
      end associate
    end do
  end subroutine carry_in_plane

  ! The procedures of one column take arrays of known shape, so that the compiler keeps their addresses in registers.

  !> A shift that is constant in a frame.
  pure subroutine shift_with_frame(n, x, y, spin, highest, series)
    integer, intent(in) :: n                               !< number of positions
    real(wp), intent(in) :: x                              !< shift along the frame's first axis [m]
    real(wp), intent(in) :: y                              !< shift along its second axis [m]
    real(wp), intent(in) :: spin(batch_size, 2, 0:2)       !< cosine and sine of the frame with their derivatives in time
    integer, intent(in) :: highest                         !< order of the highest derivative
    real(wp), intent(inout) :: series(batch_size, 3, 0:2)  !< gets the shift with its derivatives
    integer :: i, order

    do order = 0, highest
      do i = 1, n
        series(i, 2, order) = spin(i, 1, order)*x - spin(i, 2, order)*y
        series(i, 3, order) = spin(i, 2, order)*x + spin(i, 1, order)*y
      end do
    end do
  end subroutine shift_with_frame

  !> Add a rotation about the origin of a frame.
  pure subroutine turn_with_frame(n, angle, place, highest, series)
    integer, intent(in) :: n                               !< number of positions
    real(wp), intent(in) :: angle                          !< the rotation [rad]
    real(wp), intent(in) :: place(batch_size, 2, 0:2)      !< origin of the frame with its derivatives in time [m]
    integer, intent(in) :: highest                         !< order of the highest derivative
    real(wp), intent(inout) :: series(batch_size, 3, 0:2)  !< gets the rotation, and more shift
    integer :: i

    do i = 1, n
      series(i, 1, 0) = angle
      series(i, 2, 0) = series(i, 2, 0) + angle*place(i, 2, 0)
      series(i, 3, 0) = series(i, 3, 0) - angle*place(i, 1, 0)
    end do
    if (highest == 0) return
    do i = 1, n
      series(i, 2, 1) = series(i, 2, 1) + angle*place(i, 2, 1)
      series(i, 3, 1) = series(i, 3, 1) - angle*place(i, 1, 1)
      series(i, 2, 2) = series(i, 2, 2) + angle*place(i, 2, 2)
      series(i, 3, 2) = series(i, 3, 2) - angle*place(i, 1, 2)
    end do
  end subroutine turn_with_frame

  !> Fill the form of a closed chain: its rotation, and its shift at the origin of its base frame in lengths of the mechanism.
  pure subroutine fill_planar_closure(n, planar, c, motion, highest, constants, form)
    integer, intent(in) :: n                                 !< number of positions
    type(planar_plan_type), intent(in) :: planar             !< the plan in planar arithmetic
    integer, intent(in) :: c                                 !< number of the closure
    type(planar_batch_type), intent(in) :: motion            !< the motion of the frames
    integer, intent(in) :: highest                           !< order of the highest derivative
    type(carried_constants_type), intent(in) :: constants    !< the constants
    type(linear_form_type), intent(inout) :: form            !< gets its columns and shares
    real(wp) :: per_length, factor, angle
    integer :: i, k, all_or_n

    per_length = 1.0_wp/planar%length
    associate (base => motion%place(:, :, 0, planar%closures(c)%base))
      do i = 1, size(form%steps)
        k = form%steps(i)
        if (planar%steps(k)%turns) then
          call fill_turn(n, form%signs(i)*planar%steps(k)%turn, per_length, base, motion%place(:, :, :, k), highest, &
                         form%columns(:, :, :, i))
        else
          call fill_slide(n, form%signs(i)*per_length, motion%slide(:, :, k), motion%turning(:, :, planar%steps(k)%parent), &
                          highest, 3, form%columns(:, :, :, i))
        end if
      end do
      if (highest > 1) call keep_double(form, n)
      do i = 1, size(form%constants)
        if (form%keeps(i) .and. form%is_filled) cycle
        all_or_n = merge(batch_size, n, form%keeps(i))
        factor = form%constant_signs(i)*per_length
        associate (k => form%constants(i), share => form%shares(:, :, :, form%slots(form%parameters(i))))
          angle = constants%list(k)%twist(1)
          call put_opening(all_or_n, factor, form%constant_signs(i)*angle, constants%series(:, :, :, k), form%is_first(i), &
                           highest, share)
          if (abs(angle) > 0.0_wp) call turn_at_base(all_or_n, factor*angle, base, share)
        end associate
      end do
    end associate
    form%is_filled = .true.
  end subroutine fill_planar_closure

  !> The share of a constant in the opening of a chain, at the origin of frame 0.
  pure subroutine put_opening(n, factor, angle, series, is_first, highest, share)
    integer, intent(in) :: n                               !< number of positions
    real(wp), intent(in) :: factor                         !< of the shift: sign of the constant, per length of the mechanism [1/m]
    real(wp), intent(in) :: angle                          !< rotation, with the sign of the constant [rad]
    real(wp), intent(in) :: series(batch_size, 3, 0:2)     !< its twist with its derivatives in time
    logical, intent(in) :: is_first                        !< the shares of other constants of the parameter are overwritten
    integer, intent(in) :: highest                         !< order of the highest derivative
    real(wp), intent(inout) :: share(batch_size, 3, 0:2)   !< gets the share
    integer :: i, order

    if (is_first) then
      share(:n, 1, 0) = angle
      do order = 0, highest
        do i = 1, n
          share(i, 2, order) = factor*series(i, 2, order)
          share(i, 3, order) = factor*series(i, 3, order)
        end do
      end do
    else
      share(:n, 1, 0) = share(:n, 1, 0) + angle
      do order = 0, highest
        do i = 1, n
          share(i, 2, order) = share(i, 2, order) + factor*series(i, 2, order)
          share(i, 3, order) = share(i, 3, order) + factor*series(i, 3, order)
        end do
      end do
    end if
  end subroutine put_opening

  !> Take off an opening the shift of the base by a rotation.
  pure subroutine turn_at_base(n, angle, base, share)
    integer, intent(in) :: n                               !< number of positions
    real(wp), intent(in) :: angle                          !< the rotation, over the length of the mechanism [rad/m]
    real(wp), intent(in) :: base(batch_size, 2)            !< origin of the frame at which the opening is written [m]
    real(wp), intent(inout) :: share(batch_size, 3)        !< the opening at the origin of frame 0; then at this frame
    integer :: i

    do i = 1, n
      share(i, 2) = share(i, 2) - angle*base(i, 2)
      share(i, 3) = share(i, 3) + angle*base(i, 1)
    end do
  end subroutine turn_at_base

  !> The column of a step that turns in the opening of a chain.
  pure subroutine fill_turn(n, turn, per_length, base, place, highest, column)
    integer, intent(in) :: n                                !< number of positions
    real(wp), intent(in) :: turn                            !< rotation per unit of the coordinate, with the sign of the step in the loop
    real(wp), intent(in) :: per_length                      !< one over the length of the mechanism [1/m]
    real(wp), intent(in) :: base(batch_size, 2)             !< origin of the frame at which the opening is written [m]
    real(wp), intent(in) :: place(batch_size, 2, 0:2)       !< origin of the step's frame with its derivatives in time [m]
    integer, intent(in) :: highest                          !< order of the highest derivative
    real(wp), intent(inout) :: column(batch_size, 3, 0:3)   !< gets the column with its derivatives in time
    real(wp) :: w
    integer :: i

    w = turn*per_length
    do i = 1, n
      column(i, 1, 0) = turn
      column(i, 2, 0) = w*(place(i, 2, 0) - base(i, 2))
      column(i, 3, 0) = w*(base(i, 1) - place(i, 1, 0))
    end do
    if (highest == 0) return
    do i = 1, n
      column(i, 2, 1) = w*place(i, 2, 1)
      column(i, 3, 1) = -w*place(i, 1, 1)
      column(i, 2, 2) = w*place(i, 2, 2)
      column(i, 3, 2) = -w*place(i, 1, 2)
    end do
  end subroutine fill_turn

  !> The direction in which a step slides, with a factor, and its derivatives in time, in the last two rows of a column.
  pure subroutine fill_slide(n, factor, slide, turning, highest, rows, column)
    integer, intent(in) :: n                                   !< number of positions
    real(wp), intent(in) :: factor                             !< of the direction
    real(wp), intent(in) :: slide(batch_size, 2)               !< shift per unit of the coordinate
    real(wp), intent(in) :: turning(batch_size, 2)             !< angular velocity and acceleration of the frame [rad/s, rad/s^2]
    integer, intent(in) :: highest                             !< order of the highest derivative
    integer, intent(in) :: rows                                !< of the column
    real(wp), intent(inout) :: column(batch_size, rows, 0:2)   !< gets the direction
    integer :: i

    associate (x => rows - 1, y => rows)
      do i = 1, n
        column(i, x, 0) = factor*slide(i, 1)
        column(i, y, 0) = factor*slide(i, 2)
      end do
      if (highest == 0) return
      do i = 1, n
        column(i, x, 1) = -turning(i, 1)*column(i, y, 0)
        column(i, y, 1) = turning(i, 1)*column(i, x, 0)
        column(i, x, 2) = -turning(i, 2)*column(i, y, 0) - turning(i, 1)**2*column(i, x, 0)
        column(i, y, 2) = turning(i, 2)*column(i, x, 0) - turning(i, 1)**2*column(i, y, 0)
      end do
    end associate
  end subroutine fill_slide

  !> Fill the form of a point: its shift in space, or in the plane where the plane's axes are those of frame 0.
  pure subroutine fill_planar_point(n, planar, point, motion, highest, constants, form)
    integer, intent(in) :: n                                 !< number of positions
    type(planar_plan_type), intent(in) :: planar             !< the plan in planar arithmetic
    type(place_in_frame_type), intent(in) :: point           !< the point
    type(planar_batch_type), intent(in) :: motion            !< the motion of the frames
    integer, intent(in) :: highest                           !< order of the highest derivative
    type(carried_constants_type), intent(in) :: constants    !< the constants
    type(linear_form_type), intent(inout) :: form            !< gets its columns and shares
    real(wp) :: p(batch_size, 2, 0:2), shift(batch_size, 2, 0:2)
    integer :: i, s

    call place_point(n, point%place, motion%spin(1, 1, 0, point%frame), motion%place(1, 1, 0, point%frame), &
                     motion%turning(1, 1, point%frame), highest, p)
    do i = 1, size(form%steps)
      s = form%steps(i)
      if (planar%steps(s)%turns) then
        call turn_about(n, planar%steps(s)%turn, p, motion%place(:, :, :, s), highest, shift)
      else
        call fill_slide(n, 1.0_wp, motion%slide(:, :, s), motion%turning(:, :, planar%steps(s)%parent), highest, 2, shift)
      end if
      call clear(n, form%rows, highest, form%columns(:, :, :, i))
      call put(n, planar, highest, shift, form%rows, form%columns(:, :, :, i))
    end do
    if (highest > 1) call keep_double(form, n)
    do i = 1, size(form%constants)
      if (form%keeps(i) .and. form%is_filled) cycle
      associate (constant => constants%list(form%constants(i)), slot => form%slots(form%parameters(i)), &
                 all_or_n => merge(batch_size, n, form%keeps(i)))
        call shift_point(all_or_n, constant%twist(1), constants%series(:, :, :, form%constants(i)), p, highest, shift)
        if (form%is_first(i)) call clear(all_or_n, form%rows, highest, form%shares(:, :, :, slot))
        call put(all_or_n, planar, highest, shift, form%rows, form%shares(:, :, :, slot))
        ! points alone may be shifted along the normal
        if (form%rows == 3 .and. constant%point > 0) call add_normal(all_or_n, constant%twist(4), planar%axes, &
                                                                     form%shares(:, :, 0, slot))
      end associate
    end do
    form%is_filled = .true.
  end subroutine fill_planar_point

  !> The motion of a point of a frame.
  pure subroutine place_point(n, point, spin, place, turning, highest, p)
    integer, intent(in) :: n                               !< number of positions
    real(wp), intent(in) :: point(2)                       !< in the frame [m]
    real(wp), intent(in) :: spin(batch_size, 2)            !< cosine and sine of the frame
    real(wp), intent(in) :: place(batch_size, 2, 0:2)      !< its origin with its derivatives in time [m]
    real(wp), intent(in) :: turning(batch_size, 2)         !< its angular velocity and acceleration [rad/s, rad/s^2]
    integer, intent(in) :: highest                         !< order of the highest derivative
    real(wp), intent(inout) :: p(batch_size, 2, 0:2)       !< the point, its velocity and acceleration [m, m/s, m/s^2]
    real(wp) :: x(batch_size), y(batch_size)
    integer :: i

    do i = 1, n
      x(i) = spin(i, 1)*point(1) - spin(i, 2)*point(2)
      y(i) = spin(i, 2)*point(1) + spin(i, 1)*point(2)
      p(i, 1, 0) = place(i, 1, 0) + x(i)
      p(i, 2, 0) = place(i, 2, 0) + y(i)
    end do
    if (highest == 0) return
    do i = 1, n
      p(i, 1, 1) = place(i, 1, 1) - turning(i, 1)*y(i)
      p(i, 2, 1) = place(i, 2, 1) + turning(i, 1)*x(i)
      p(i, 1, 2) = place(i, 1, 2) - turning(i, 2)*y(i) - turning(i, 1)**2*x(i)
      p(i, 2, 2) = place(i, 2, 2) + turning(i, 2)*x(i) - turning(i, 1)**2*y(i)
    end do
  end subroutine place_point

  !> The shift of a point by a turn about the origin of a frame, with its derivatives in time.
  pure subroutine turn_about(n, angle, p, place, highest, shift)
    integer, intent(in) :: n                               !< number of positions
    real(wp), intent(in) :: angle                          !< small angle [rad]
    real(wp), intent(in) :: p(batch_size, 2, 0:2)          !< the point, its velocity and acceleration [m, m/s, m/s^2]
    real(wp), intent(in) :: place(batch_size, 2, 0:2)      !< origin of the frame with its derivatives in time [m]
    integer, intent(in) :: highest                         !< order of the highest derivative
    real(wp), intent(inout) :: shift(batch_size, 2, 0:2)   !< [m]
    integer :: i, order

    do order = 0, merge(2, 0, highest > 0)
      do i = 1, n
        shift(i, 1, order) = angle*(place(i, 2, order) - p(i, 2, order))
        shift(i, 2, order) = angle*(p(i, 1, order) - place(i, 1, order))
      end do
    end do
  end subroutine turn_about

  !> The shift of a point by the twist of a constant, with its derivatives in time.
  pure subroutine shift_point(n, angle, series, p, highest, shift)
    integer, intent(in) :: n                               !< number of positions
    real(wp), intent(in) :: angle                          !< rotation of the twist [rad]
    real(wp), intent(in) :: series(batch_size, 3, 0:2)     !< the twist with its derivatives
    real(wp), intent(in) :: p(batch_size, 2, 0:2)          !< the point, its velocity and acceleration [m, m/s, m/s^2]
    integer, intent(in) :: highest                         !< order of the highest derivative
    real(wp), intent(inout) :: shift(batch_size, 2, 0:2)   !< [m]
    integer :: i, order

    do order = 0, highest
      do i = 1, n
        shift(i, 1, order) = series(i, 2, order)
        shift(i, 2, order) = series(i, 3, order)
      end do
      if (.not. abs(angle) > 0.0_wp) cycle
      do i = 1, n
        shift(i, 1, order) = shift(i, 1, order) - angle*p(i, 2, order)
        shift(i, 2, order) = shift(i, 2, order) + angle*p(i, 1, order)
      end do
    end do
  end subroutine shift_point

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

  !> Add a vector of the plane with its derivatives to a column.
  pure subroutine put(n, planar, highest, vector, rows, column)
    integer, intent(in) :: n                                    !< number of positions
    type(planar_plan_type), intent(in) :: planar                !< with the axes of the plane
    integer, intent(in) :: highest                              !< order of the highest derivative
    real(wp), intent(in) :: vector(batch_size, 2, 0:2)          !< in the plane's axes
    integer, intent(in) :: rows                                 !< two in the plane's axes where these are those of frame 0, else three
    real(wp), intent(inout) :: column(batch_size, rows, 0:*)    !< the sum
    integer :: i, order, r

    do order = 0, highest
      if (planar%in_xy_plane) then
        do i = 1, n
          column(i, 1, order) = column(i, 1, order) + vector(i, 1, order)
          column(i, 2, order) = column(i, 2, order) + vector(i, 2, order)
        end do
      else
        do r = 1, 3
          associate (x => planar%axes(r, 1), y => planar%axes(r, 2))
            do i = 1, n
              column(i, r, order) = column(i, r, order) + x*vector(i, 1, order) + y*vector(i, 2, order)
            end do
          end associate
        end do
      end if
    end do
  end subroutine put

  !> Add a shift along the normal.
  pure subroutine add_normal(n, distance, axes, shift)
    integer, intent(in) :: n                            !< number of positions
    real(wp), intent(in) :: distance                    !< along the normal [m]
    real(wp), intent(in) :: axes(3, 3)                  !< axes of the plane
    real(wp), intent(inout) :: shift(batch_size, 3)     !< the sum [m]
    integer :: r

    do r = 1, 3
      shift(:n, r) = shift(:n, r) + distance*axes(r, 3)
    end do
  end subroutine add_normal
end module mech9_planar_forms
