!> The derivatives of coordinates and points of a planar design by the parameters that are varied and by time, at all targets at once. The
!> target is the fastest index and runs innermost.
!>
!> A change of a step's place shifts all that follows, one of its angle turns it about the step's origin; the coordinates of a chain then
!> change so that it stays closed. Numbers that a parameter does not change cost nothing.
module mech9_planar_slopes
  use mech9_kinds, only: wp
  use mech9_cofactors, only: invert_several
  use mech9_design_space, only: design_type, drive_changes
  use mech9_planar_numbers, only: planar_design_type, numbers_of_step, numbers_of_closure, numbers_of_point
  use mech9_planar_loop, only: planar_loop_type, find_column, multiply, place_frames
  use mech9_planar_run, only: planar_run_type, planar_positions_type
  implicit none
  private
  public :: planar_slopes_type, new_planar_slopes, find_coordinate_slopes, find_point_slopes

  !> The positions at the targets, and the derivatives of their coordinates.
  type :: planar_slopes_type
    integer :: n = 0                                  !< number of targets
    integer, allocatable :: at(:)                     !< (n) number of the position of each target
    logical, allocatable :: touched(:, :)             !< (M,P) coordinates that change with each parameter
    real(wp), allocatable :: q(:, :), dq(:, :)        !< (n,M) coordinates and their rates [rad, m; per s]
    real(wp), allocatable :: turn(:, :, :)            !< (n,2,M) cosine and sine of the angle by which each step turns
    real(wp), allocatable :: frames(:, :, :)          !< (n,6,0:M) the frames, see mech9_planar_loop
    real(wp), allocatable :: by_x(:, :, :)            !< (n,M,P) derivatives of the coordinates by the parameters
    real(wp), allocatable :: jacobian(:, :, :), inverse(:, :, :), columns(:, :, :)   !< scratch
    real(wp), allocatable :: pivots(:, :), rows(:, :), change(:, :)                  !< scratch
  end type planar_slopes_type

contains

  !> Room for the derivatives at some targets.
  pure subroutine new_planar_slopes(n, design, space_design, run, slopes)
    integer, intent(in) :: n                              !< number of targets
    type(planar_design_type), intent(in) :: design        !< any design
    type(design_type), intent(in) :: space_design         !< the same, with tangents
    type(planar_run_type), intent(in) :: run              !< its chains
    type(planar_slopes_type), intent(out) :: slopes       !< the room
    integer :: i, m, p, b

    m = run%m
    slopes%n = n
    allocate (slopes%at(n), source=1)
    allocate (slopes%touched(m, size(design%at)), source=.false.)
    allocate (slopes%q(n, m), slopes%dq(n, m), slopes%turn(n, 2, m), slopes%frames(n, 6, 0:m), &
              slopes%by_x(n, m, size(design%at)), slopes%jacobian(n, 3, 3), slopes%inverse(n, 3, 3), slopes%columns(n, 3, m), &
              slopes%pivots(n, 2), slopes%rows(n, 3), slopes%change(n, 3), source=0.0_wp)
    slopes%frames(:, 1, 0) = 1.0_wp
    do p = 1, size(design%at)
      do i = 1, size(space_design%drives)
        slopes%touched(space_design%drives(i)%drive%coordinate, p) = space_design%tangents(p)%drives(i)%varies
      end do
      do b = 1, size(run%loops)
        if (run%loops(b)%closure > 0) &
          slopes%touched(run%loops(b)%coordinates, p) = opens(design, run%loops(b), slopes%touched(:, p), p)
      end do
    end do
  end subroutine new_planar_slopes

  !> Whether a parameter changes the coordinates of a chain.
  pure logical function opens(design, loop, touched, p)
    type(planar_design_type), intent(in) :: design    !< any design
    type(planar_loop_type), intent(in) :: loop        !< the chain
    logical, intent(in) :: touched(:)                 !< (M) coordinates that the parameter changes before
    integer, intent(in) :: p                          !< number of the parameter
    integer :: s

    opens = any(abs(closure_slopes(design, loop%closure, p)) > 0.0_wp)
    do s = 1, size(design%steps)
      if (abs(loop%signs(s)) > 0.0_wp) opens = opens .or. any(abs(step_slopes(design, s, p)) > 0.0_wp) .or. &
                                               touched(design%steps(s)%coordinate)
    end do
  end function opens

  !> Derivatives of a step's place and angle by a parameter.
  pure function step_slopes(design, s, p) result(slopes)
    type(planar_design_type), intent(in) :: design   !< any design
    integer, intent(in) :: s                         !< number of the step
    integer, intent(in) :: p                         !< number of the parameter
    real(wp) :: slopes(numbers_of_step)

    slopes = design%slopes(numbers_of_step*(s - 1) + 1:numbers_of_step*s, p)
  end function step_slopes

  !> Derivatives of a closure's place by a parameter.
  pure function closure_slopes(design, c, p) result(slopes)
    type(planar_design_type), intent(in) :: design   !< any design
    integer, intent(in) :: c                         !< number of the closure
    integer, intent(in) :: p                         !< number of the parameter
    real(wp) :: slopes(numbers_of_closure)
    integer :: at

    at = numbers_of_step*size(design%steps) + numbers_of_closure*(c - 1)
    slopes = design%slopes(at + 1:at + numbers_of_closure, p)
  end function closure_slopes

  !> Derivatives of a point's place in its frame by a parameter.
  pure function point_slopes(design, i, p) result(slopes)
    type(planar_design_type), intent(in) :: design   !< any design
    integer, intent(in) :: i                         !< number of the point
    integer, intent(in) :: p                         !< number of the parameter
    real(wp) :: slopes(numbers_of_point)
    integer :: at

    at = numbers_of_step*size(design%steps) + numbers_of_closure*size(design%closures) + numbers_of_point*(i - 1)
    slopes = design%slopes(at + 1:at + numbers_of_point, p)
  end function point_slopes

  !> Find the derivatives of all coordinates at the targets.
  subroutine find_coordinate_slopes(design, space_design, run, positions, slopes)
    type(planar_design_type), intent(in) :: design              !< placed
    type(design_type), intent(in) :: space_design               !< with its drives and tangents
    type(planar_run_type), intent(in) :: run                    !< its chains
    type(planar_positions_type), intent(in) :: positions        !< closed
    type(planar_slopes_type), intent(inout) :: slopes           !< gets the derivatives
    real(wp) :: change(size(design%at))
    integer :: b, i, g, k, s

    do i = 1, positions%n
      if (positions%target(i) > 0) slopes%at(positions%target(i)) = i
    end do
    do k = 1, run%m
      do g = 1, slopes%n
        slopes%q(g, k) = positions%q(slopes%at(g), k)
        slopes%dq(g, k) = positions%dq(slopes%at(g), k)
        slopes%turn(g, 1, k) = positions%turn(slopes%at(g), 1, k)
        slopes%turn(g, 2, k) = positions%turn(slopes%at(g), 2, k)
      end do
    end do
    call place_frames(slopes%n, design%steps, 1, run%m, slopes%q, slopes%turn, slopes%frames)
    do i = 1, size(space_design%drives)
      k = space_design%drives(i)%drive%coordinate
      if (.not. any(slopes%touched(k, :))) cycle
      do g = 1, slopes%n
        call drive_changes(space_design, i, positions%t(slopes%at(g)), change)
        slopes%by_x(g, k, :) = change
      end do
    end do
    do b = 1, size(run%loops)
      if (run%loops(b)%closure == 0) cycle
      associate (loop => run%loops(b), base => design%closures(run%loops(b)%closure)%base)
        do i = 1, 3
          s = loop%unknowns(i)
          call find_column(slopes%n, slopes%n, design%steps(s), loop%signs(s)*loop%units(i)*[1.0_wp, run%per_length], &
                           slopes%frames(:, :, s), slopes%frames(:, :, base), slopes%jacobian(:, :, i))
        end do
        call invert_several(slopes%n, slopes%n, 0.0_wp, slopes%jacobian, slopes%inverse, slopes%pivots(:, 1), slopes%pivots(:, 2))
        do i = 1, size(loop%given)
          s = loop%given(i)
          call find_column(slopes%n, slopes%n, design%steps(s), loop%signs(s)*[1.0_wp, run%per_length], &
                           slopes%frames(:, :, s), slopes%frames(:, :, base), slopes%columns(:, :, s))
        end do
        call find_rates(design, loop, slopes)
        do i = 1, size(design%at)
          if (slopes%touched(loop%coordinates(1), i)) call find_loop_slopes(design, loop, run%per_length, i, slopes)
        end do
      end associate
    end do
  end subroutine find_coordinate_slopes

  !> Find the rates of the three coordinates of a chain.
  subroutine find_rates(design, loop, slopes)
    type(planar_design_type), intent(in) :: design       !< placed
    type(planar_loop_type), intent(in) :: loop           !< the chain
    type(planar_slopes_type), intent(inout) :: slopes    !< with the inverse and the columns of given coordinates; gets the rates
    integer :: i, j

    slopes%rows = 0.0_wp
    do i = 1, size(loop%given)
      do j = 1, 3
        slopes%rows(:, j) = slopes%rows(:, j) + slopes%columns(:, j, loop%given(i)) &
                            *slopes%dq(:, design%steps(loop%given(i))%coordinate)
      end do
    end do
    call multiply(slopes%n, slopes%n, slopes%inverse, slopes%rows, slopes%change)
    do j = 1, 3
      slopes%dq(:, loop%coordinates(j)) = -loop%units(j)*slopes%change(:, j)
    end do
  end subroutine find_rates

  !> Find the derivatives of the three coordinates of a chain by one parameter.
  subroutine find_loop_slopes(design, loop, per_length, p, slopes)
    type(planar_design_type), intent(in) :: design       !< placed
    type(planar_loop_type), intent(in) :: loop           !< the chain
    real(wp), intent(in) :: per_length                   !< one over the mechanism's size [1/m]
    integer, intent(in) :: p                             !< number of the parameter
    type(planar_slopes_type), intent(inout) :: slopes    !< with the inverse; gets the derivatives
    real(wp) :: of_step(numbers_of_step), of_closure(numbers_of_closure), w
    integer :: i, j, s

    associate (rows => slopes%rows, n => slopes%n, closure => design%closures(loop%closure))
      rows = 0.0_wp
      do s = 1, size(design%steps)
        if (.not. abs(loop%signs(s)) > 0.0_wp) cycle
        of_step = step_slopes(design, s, p)
        if (any(abs(of_step(1:2)) > 0.0_wp)) call add_shift(n, loop%signs(s)*per_length*of_step(1:2), &
                                                            slopes%frames(:, :, design%steps(s)%parent), rows(:, 2), rows(:, 3))
        if (abs(of_step(3)) > 0.0_wp) then
          w = loop%signs(s)*of_step(3)
          rows(:, 1) = rows(:, 1) + w
          rows(:, 2) = rows(:, 2) + w*per_length*(slopes%frames(:, 4, s) - slopes%frames(:, 4, closure%base))
          rows(:, 3) = rows(:, 3) - w*per_length*(slopes%frames(:, 3, s) - slopes%frames(:, 3, closure%base))
        end if
      end do
      of_closure = closure_slopes(design, loop%closure, p)
      if (any(abs(of_closure) > 0.0_wp)) &
        call add_shift(n, -per_length*of_closure, slopes%frames(:, :, closure%target), rows(:, 2), rows(:, 3))
      do i = 1, size(loop%given)
        s = loop%given(i)
        if (.not. slopes%touched(design%steps(s)%coordinate, p)) cycle
        do j = 1, 3
          rows(:, j) = rows(:, j) + slopes%columns(:, j, s)*slopes%by_x(:, design%steps(s)%coordinate, p)
        end do
      end do
      call multiply(n, n, slopes%inverse, rows, slopes%change)
      do j = 1, 3
        slopes%by_x(:, loop%coordinates(j), p) = -loop%units(j)*slopes%change(:, j)
      end do
    end associate
  end subroutine find_loop_slopes

  !> Add a shift that is given in the axes of frames.
  pure subroutine add_shift(n, shift, pose, x, y)
    integer, intent(in) :: n               !< number of positions
    real(wp), intent(in) :: shift(2)       !< in the axes of the frames
    real(wp), intent(in) :: pose(n, 4)     !< of the frames [m]
    real(wp), intent(inout) :: x(n)        !< gets the component along the plane's first axis
    real(wp), intent(inout) :: y(n)        !< gets the component along its second axis
    integer :: i

    do i = 1, n
      x(i) = x(i) + (pose(i, 1)*shift(1) - pose(i, 2)*shift(2))
      y(i) = y(i) + (pose(i, 2)*shift(1) + pose(i, 1)*shift(2))
    end do
  end subroutine add_shift

  !> Add the shift of a point by a rotation about the origin of a frame.
  pure subroutine add_turn(n, angle, pose, place, x, y)
    integer, intent(in) :: n               !< number of positions
    real(wp), intent(in) :: angle(n)       !< the rotation [rad]
    real(wp), intent(in) :: pose(n, 4)     !< of the frames [m]
    real(wp), intent(in) :: place(n, 2)    !< the point [m]
    real(wp), intent(inout) :: x(n)        !< gets the component along the plane's first axis
    real(wp), intent(inout) :: y(n)        !< gets the component along its second axis
    integer :: i

    do i = 1, n
      x(i) = x(i) - angle(i)*(place(i, 2) - pose(i, 4))
      y(i) = y(i) + angle(i)*(place(i, 1) - pose(i, 3))
    end do
  end subroutine add_turn

  !> Find a point at all targets, and its derivatives by the parameters and by time, in the axes of the plane with its normal.
  subroutine find_point_slopes(design, frame, number, slopes, place, by_x, by_t)
    type(planar_design_type), intent(in) :: design       !< placed
    integer, intent(in) :: frame                         !< first frame of the point's link
    integer, intent(in) :: number                        !< of the point
    type(planar_slopes_type), intent(in) :: slopes       !< with the derivatives of the coordinates
    real(wp), intent(out) :: place(:, :)                 !< (n,3) from the origin of frame 0 [m]
    real(wp), intent(out) :: by_x(:, :, :)               !< (n,3,P) by the parameters
    real(wp), intent(out) :: by_t(:, :)                  !< (n,3) by time [m/s]
    real(wp) :: of_step(numbers_of_step), of_point(numbers_of_point)
    integer :: p, s, n

    n = slopes%n
    place(:, 1) = slopes%frames(:, 3, frame)
    place(:, 2) = slopes%frames(:, 4, frame)
    place(:, 3) = design%points(3, number)
    call add_shift(n, design%points(1:2, number), slopes%frames(:, :, frame), place(:, 1), place(:, 2))
    by_x = 0.0_wp
    by_t = 0.0_wp
    do p = 1, size(design%at)
      of_point = point_slopes(design, number, p)
      if (any(abs(of_point(1:2)) > 0.0_wp)) &
        call add_shift(n, of_point(1:2), slopes%frames(:, :, frame), by_x(:, 1, p), by_x(:, 2, p))
      by_x(:, 3, p) = of_point(3)
    end do
    s = frame
    do while (s > 0)
      associate (step => design%steps(s), k => design%steps(s)%coordinate)
        do p = 1, size(design%at)
          of_step = step_slopes(design, s, p)
          if (any(abs(of_step(1:2)) > 0.0_wp)) &
            call add_shift(n, of_step(1:2), slopes%frames(:, :, step%parent), by_x(:, 1, p), by_x(:, 2, p))
          if (abs(of_step(3)) > 0.0_wp) &
            call add_turn(n, spread(of_step(3), 1, n), slopes%frames(:, :, s), place(:, 1:2), by_x(:, 1, p), by_x(:, 2, p))
          if (slopes%touched(k, p)) call add_motion(slopes%by_x(:, k, p), by_x(:, :, p))
        end do
        call add_motion(slopes%dq(:, k), by_t)
        s = step%parent
      end associate
    end do
  contains
    !> Add the shift of the point by a change of the step's coordinate.
    subroutine add_motion(change, shift)
      real(wp), intent(in) :: change(:)        !< (n) of the coordinate [rad, m]
      real(wp), intent(inout) :: shift(:, :)   !< (n,3) gets the shift

      if (design%steps(s)%turns) then
        call add_turn(n, design%steps(s)%turn*change, slopes%frames(:, :, s), place(:, 1:2), shift(:, 1), shift(:, 2))
      else
        shift(:, 1) = shift(:, 1) + slopes%frames(:, 5, s)*change
        shift(:, 2) = shift(:, 2) + slopes%frames(:, 6, s)*change
      end if
    end subroutine add_motion
  end subroutine find_point_slopes
end module mech9_planar_slopes
