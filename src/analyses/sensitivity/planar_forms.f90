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
  use mech9_parameter_support, only: varied_constant_type
  implicit none
  private
  public :: carry_in_plane, fill_planar_closure, fill_planar_point

contains

  !> Twists of constants, seen from frame 0, and their derivatives in time.
  pure subroutine carry_in_plane(n, count, constants, motion, highest, again, series)
    integer, intent(in) :: n                                   !< number of positions
    integer, intent(in) :: count                               !< number of twists
    type(varied_constant_type), intent(in) :: constants(count) !< rotation and shifts in twist(1:3), in the axes of the planar frames
    type(planar_batch_type), intent(in) :: motion              !< the motion of the frames, with the derivatives of their rotation
    integer, intent(in) :: highest                             !< order of the highest derivative
    logical, intent(in) :: again                               !< twists of the ground are in `series` already, for whole batches
    real(wp), intent(inout) :: series(batch_size, 3, 0:2, count)   !< gets the twists up to this derivative
    integer :: i

    do i = 1, count
      associate (k => constants(i)%frame, twist => constants(i)%twist)
        if (again .and. k == 0) cycle
        call shift_with_frame(merge(batch_size, n, k == 0), twist(2), twist(3), motion%spin(:, :, :, k), highest, &
                              series(:, :, :, i))
        if (abs(twist(1)) > 0.0_wp) &
          call turn_with_frame(merge(batch_size, n, k == 0), twist(1), motion%pose(:, :, k), motion%velocity(:, :, k), &
                               motion%acceleration(:, :, k), highest, series(:, :, :, i))
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
  pure subroutine turn_with_frame(n, angle, pose, velocity, acceleration, highest, series)
    integer, intent(in) :: n                               !< number of positions
    real(wp), intent(in) :: angle                          !< the rotation [rad]
    real(wp), intent(in) :: pose(batch_size, 4)            !< of the frame [m]
    real(wp), intent(in) :: velocity(batch_size, 3)        !< of the frame [rad/s, m/s]
    real(wp), intent(in) :: acceleration(batch_size, 3)    !< of the frame [rad/s^2, m/s^2]
    integer, intent(in) :: highest                         !< order of the highest derivative
    real(wp), intent(inout) :: series(batch_size, 3, 0:2)  !< gets the rotation, and more shift
    integer :: i

    do i = 1, n
      series(i, 1, 0) = angle
      series(i, 2, 0) = series(i, 2, 0) + angle*pose(i, 4)
      series(i, 3, 0) = series(i, 3, 0) - angle*pose(i, 3)
    end do
    if (highest == 0) return
    do i = 1, n
      series(i, 2, 1) = series(i, 2, 1) + angle*velocity(i, 3)
      series(i, 3, 1) = series(i, 3, 1) - angle*velocity(i, 2)
      series(i, 2, 2) = series(i, 2, 2) + angle*acceleration(i, 3)
      series(i, 3, 2) = series(i, 3, 2) - angle*acceleration(i, 2)
    end do
  end subroutine turn_with_frame

  !> Fill the form of a closed chain: its rotation, and its shift at the origin of its base frame in lengths of the mechanism.
  pure subroutine fill_planar_closure(n, planar, c, motion, highest, constants, series, form)
    integer, intent(in) :: n                                 !< number of positions
    type(planar_plan_type), intent(in) :: planar             !< the plan in planar arithmetic
    integer, intent(in) :: c                                 !< number of the closure
    type(planar_batch_type), intent(in) :: motion            !< the motion of the frames
    integer, intent(in) :: highest                           !< order of the highest derivative
    type(varied_constant_type), intent(in) :: constants(:)   !< the constants
    real(wp), intent(in), contiguous :: series(:, :, 0:, :)  !< (batch,3,0:2,constants) their twists
    type(linear_form_type), intent(inout) :: form            !< gets its columns and shares
    real(wp) :: per_length
    integer :: i, k, all_or_n

    per_length = 1.0_wp/planar%length
    associate (base => motion%pose(:, 3:4, planar%closures(c)%base))
      do i = 1, size(form%steps)
        k = form%steps(i)
        if (planar%steps(k)%turns) then
          call fill_turn(n, form%signs(i)*planar%steps(k)%turn, per_length, base, motion%pose(:, :, k), motion%velocity(:, :, k), &
                         motion%acceleration(:, :, k), highest, form%columns(:, :, :, i))
        else
          associate (parent => planar%steps(k)%parent)
            call fill_slide(n, form%signs(i)*per_length, motion%slide(:, :, k), motion%velocity(:, 1, parent), &
                            motion%acceleration(:, 1, parent), highest, form%columns(:, 2:3, 0, i), form%columns(:, 2:3, 1, i), &
                            form%columns(:, 2:3, 2, i))
          end associate
        end if
      end do
      if (highest > 1) call keep_double(form, n)
      do i = 1, size(form%constants)
        if (form%keeps(i) .and. form%is_filled) cycle
        all_or_n = merge(batch_size, n, form%keeps(i))
        associate (k => form%constants(i), share => form%shares(:, :, :, form%slots(form%parameters(i))))
          call put_opening(all_or_n, form%constant_signs(i), per_length, constants(k)%twist(1), base, series(:, :, :, k), &
                           form%is_first(i), highest, share)
        end associate
      end do
    end associate
    form%is_filled = .true.
  end subroutine fill_planar_closure

  !> The share of a constant in the opening of a chain.
  pure subroutine put_opening(n, sign, per_length, angle, base, series, is_first, highest, share)
    integer, intent(in) :: n                               !< number of positions
    real(wp), intent(in) :: sign                           !< of the constant
    real(wp), intent(in) :: per_length                     !< one over the length of the mechanism [1/m]
    real(wp), intent(in) :: angle                          !< its rotation [rad]
    real(wp), intent(in) :: base(batch_size, 2)            !< origin of the frame at which the opening is written [m]
    real(wp), intent(in) :: series(batch_size, 3, 0:2)     !< its twist with its derivatives in time
    logical, intent(in) :: is_first                        !< the shares of other constants of the parameter are overwritten
    integer, intent(in) :: highest                         !< order of the highest derivative
    real(wp), intent(inout) :: share(batch_size, 3, 0:2)   !< gets the share
    real(wp) :: factor
    integer :: i, order

    factor = sign*per_length
    if (is_first) then
      share(:n, 1, 0) = sign*angle
      do order = 0, highest
        do i = 1, n
          share(i, 2, order) = factor*series(i, 2, order)
          share(i, 3, order) = factor*series(i, 3, order)
        end do
      end do
    else
      share(:n, 1, 0) = share(:n, 1, 0) + sign*angle
      do order = 0, highest
        do i = 1, n
          share(i, 2, order) = share(i, 2, order) + factor*series(i, 2, order)
          share(i, 3, order) = share(i, 3, order) + factor*series(i, 3, order)
        end do
      end do
    end if
    if (.not. abs(angle) > 0.0_wp) return
    do i = 1, n
      share(i, 2, 0) = share(i, 2, 0) - factor*angle*base(i, 2)
      share(i, 3, 0) = share(i, 3, 0) + factor*angle*base(i, 1)
    end do
  end subroutine put_opening

  !> The column of a step that turns in the opening of a chain.
  pure subroutine fill_turn(n, turn, per_length, base, pose, velocity, acceleration, highest, column)
    integer, intent(in) :: n                                !< number of positions
    real(wp), intent(in) :: turn                            !< rotation per unit of the coordinate, with the sign of the step in the loop
    real(wp), intent(in) :: per_length                      !< one over the length of the mechanism [1/m]
    real(wp), intent(in) :: base(batch_size, 2)             !< origin of the frame at which the opening is written [m]
    real(wp), intent(in) :: pose(batch_size, 4)             !< of the step's frame [m]
    real(wp), intent(in) :: velocity(batch_size, 3)         !< of this frame [rad/s, m/s]
    real(wp), intent(in) :: acceleration(batch_size, 3)     !< of this frame [rad/s^2, m/s^2]
    integer, intent(in) :: highest                          !< order of the highest derivative
    real(wp), intent(inout) :: column(batch_size, 3, 0:3)   !< gets the column with its derivatives in time
    real(wp) :: w
    integer :: i

    w = turn*per_length
    do i = 1, n
      column(i, 1, 0) = turn
      column(i, 2, 0) = w*(pose(i, 4) - base(i, 2))
      column(i, 3, 0) = w*(base(i, 1) - pose(i, 3))
    end do
    if (highest == 0) return
    do i = 1, n
      column(i, 2, 1) = w*velocity(i, 3)
      column(i, 3, 1) = -w*velocity(i, 2)
      column(i, 2, 2) = w*acceleration(i, 3)
      column(i, 3, 2) = -w*acceleration(i, 2)
    end do
  end subroutine fill_turn

  !> The direction in which a step slides, with a factor, and its derivatives in time.
  pure subroutine fill_slide(n, factor, slide, w, alpha, highest, shift, first, second)
    integer, intent(in) :: n                            !< number of positions
    real(wp), intent(in) :: factor                      !< of the direction
    real(wp), intent(in) :: slide(batch_size, 2)        !< shift per unit of the coordinate
    real(wp), intent(in) :: w(batch_size)               !< angular velocity of the frame [rad/s]
    real(wp), intent(in) :: alpha(batch_size)           !< its angular acceleration [rad/s^2]
    integer, intent(in) :: highest                      !< order of the highest derivative
    real(wp), intent(inout) :: shift(batch_size, 2)     !< shift per unit of the coordinate
    real(wp), intent(inout) :: first(batch_size, 2)     !< its first derivative
    real(wp), intent(inout) :: second(batch_size, 2)    !< its second derivative
    integer :: i

    do i = 1, n
      shift(i, 1) = factor*slide(i, 1)
      shift(i, 2) = factor*slide(i, 2)
    end do
    if (highest == 0) return
    do i = 1, n
      first(i, 1) = -w(i)*shift(i, 2)
      first(i, 2) = w(i)*shift(i, 1)
      second(i, 1) = -alpha(i)*shift(i, 2) - w(i)**2*shift(i, 1)
      second(i, 2) = alpha(i)*shift(i, 1) - w(i)**2*shift(i, 2)
    end do
  end subroutine fill_slide

  !> Fill the form of a point: its shift in space, or in the plane where the plane's axes are those of frame 0.
  pure subroutine fill_planar_point(n, planar, frame, place, motion, highest, constants, series, form)
    integer, intent(in) :: n                                 !< number of positions
    type(planar_plan_type), intent(in) :: planar             !< the plan in planar arithmetic
    integer, intent(in) :: frame                             !< frame with which the point moves
    real(wp), intent(in) :: place(2)                         !< the point in the planar frame [m]
    type(planar_batch_type), intent(in) :: motion            !< the motion of the frames
    integer, intent(in) :: highest                           !< order of the highest derivative
    type(varied_constant_type), intent(in) :: constants(:)   !< the constants
    real(wp), intent(in), contiguous :: series(:, :, 0:, :)  !< (batch,3,0:2,constants) their twists
    type(linear_form_type), intent(inout) :: form            !< gets its columns and shares
    real(wp) :: p(batch_size, 2, 0:2), shift(batch_size, 2, 0:2)
    integer :: i, s

    call place_point(n, place, motion%pose(:, :, frame), motion%velocity(:, :, frame), motion%acceleration(:, :, frame), highest, p)
    do i = 1, size(form%steps)
      s = form%steps(i)
      if (planar%steps(s)%turns) then
        call turn_about(n, planar%steps(s)%turn, p, motion%pose(:, :, s), motion%velocity(:, :, s), motion%acceleration(:, :, s), &
                        highest, shift)
      else
        associate (k => planar%steps(s)%parent)
          call fill_slide(n, 1.0_wp, motion%slide(:, :, s), motion%velocity(:, 1, k), motion%acceleration(:, 1, k), highest, &
                          shift(:, :, 0), shift(:, :, 1), shift(:, :, 2))
        end associate
      end if
      call put(n, planar%in_xy_plane, planar%axes, .true., highest, shift, form%rows, form%columns(:, :, :, i))
    end do
    if (highest > 1) call keep_double(form, n)
    do i = 1, size(form%constants)
      if (form%keeps(i) .and. form%is_filled) cycle
      associate (constant => constants(form%constants(i)), slot => form%slots(form%parameters(i)), &
                 all_or_n => merge(batch_size, n, form%keeps(i)))
        call shift_point(all_or_n, constant%twist(1), series(:, :, :, form%constants(i)), p, highest, shift)
        call put(all_or_n, planar%in_xy_plane, planar%axes, form%is_first(i), highest, shift, form%rows, form%shares(:, :, :, slot))
        ! points alone may be shifted along the normal
        if (form%rows == 3 .and. constant%point > 0) call add_normal(all_or_n, constant%twist(4), planar%axes, &
                                                                     form%shares(:, :, 0, slot))
      end associate
    end do
    form%is_filled = .true.
  end subroutine fill_planar_point

  !> The motion of a point of a frame.
  pure subroutine place_point(n, place, pose, velocity, acceleration, highest, p)
    integer, intent(in) :: n                               !< number of positions
    real(wp), intent(in) :: place(2)                       !< the point in the frame [m]
    real(wp), intent(in) :: pose(batch_size, 4)            !< of the frame [m]
    real(wp), intent(in) :: velocity(batch_size, 3)        !< of the frame [rad/s, m/s]
    real(wp), intent(in) :: acceleration(batch_size, 3)    !< of the frame [rad/s^2, m/s^2]
    integer, intent(in) :: highest                         !< order of the highest derivative
    real(wp), intent(inout) :: p(batch_size, 2, 0:2)       !< the point, its velocity and acceleration [m, m/s, m/s^2]
    real(wp) :: x(batch_size), y(batch_size)
    integer :: i

    do i = 1, n
      x(i) = pose(i, 1)*place(1) - pose(i, 2)*place(2)
      y(i) = pose(i, 2)*place(1) + pose(i, 1)*place(2)
      p(i, 1, 0) = pose(i, 3) + x(i)
      p(i, 2, 0) = pose(i, 4) + y(i)
    end do
    if (highest == 0) return
    do i = 1, n
      p(i, 1, 1) = velocity(i, 2) - velocity(i, 1)*y(i)
      p(i, 2, 1) = velocity(i, 3) + velocity(i, 1)*x(i)
      p(i, 1, 2) = acceleration(i, 2) - acceleration(i, 1)*y(i) - velocity(i, 1)**2*x(i)
      p(i, 2, 2) = acceleration(i, 3) + acceleration(i, 1)*x(i) - velocity(i, 1)**2*y(i)
    end do
  end subroutine place_point

  !> The shift of a point by a turn about the origin of a frame, with its derivatives in time.
  pure subroutine turn_about(n, angle, p, pose, velocity, acceleration, highest, shift)
    integer, intent(in) :: n                               !< number of positions
    real(wp), intent(in) :: angle                          !< small angle [rad]
    real(wp), intent(in) :: p(batch_size, 2, 0:2)          !< the point, its velocity and acceleration [m, m/s, m/s^2]
    real(wp), intent(in) :: pose(batch_size, 4)            !< of the frame [m]
    real(wp), intent(in) :: velocity(batch_size, 3)        !< of the frame [rad/s, m/s]
    real(wp), intent(in) :: acceleration(batch_size, 3)    !< of the frame [rad/s^2, m/s^2]
    integer, intent(in) :: highest                         !< order of the highest derivative
    real(wp), intent(inout) :: shift(batch_size, 2, 0:2)   !< [m]
    integer :: i

    do i = 1, n
      shift(i, 1, 0) = angle*(pose(i, 4) - p(i, 2, 0))
      shift(i, 2, 0) = angle*(p(i, 1, 0) - pose(i, 3))
    end do
    if (highest == 0) return
    do i = 1, n
      shift(i, 1, 1) = angle*(velocity(i, 3) - p(i, 2, 1))
      shift(i, 2, 1) = angle*(p(i, 1, 1) - velocity(i, 2))
      shift(i, 1, 2) = angle*(acceleration(i, 3) - p(i, 2, 2))
      shift(i, 2, 2) = angle*(p(i, 1, 2) - acceleration(i, 2))
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

  !> Put a vector of the plane with its derivatives into a column, or add it.
  pure subroutine put(n, in_xy_plane, axes, is_first, highest, vector, rows, column)
    integer, intent(in) :: n                                    !< number of positions
    logical, intent(in) :: in_xy_plane                          !< the plane's axes are those of frame 0
    real(wp), intent(in) :: axes(3, 3)                          !< axes of the plane
    logical, intent(in) :: is_first                             !< numbers that stand there are overwritten
    integer, intent(in) :: highest                              !< order of the highest derivative
    real(wp), intent(in) :: vector(batch_size, 2, 0:2)          !< in the plane's axes
    integer, intent(in) :: rows                                 !< two in the plane's axes where these are those of frame 0, else three
    real(wp), intent(inout) :: column(batch_size, rows, 0:*)    !< gets the vector
    integer :: i, order, r

    do order = 0, highest
      if (is_first) column(:n, :, order) = 0.0_wp
      if (in_xy_plane) then
        do i = 1, n
          column(i, 1, order) = column(i, 1, order) + vector(i, 1, order)
          column(i, 2, order) = column(i, 2, order) + vector(i, 2, order)
        end do
      else
        do r = 1, 3
          do i = 1, n
            column(i, r, order) = column(i, r, order) + axes(r, 1)*vector(i, 1, order) + axes(r, 2)*vector(i, 2, order)
          end do
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
