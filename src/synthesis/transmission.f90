!> The transmission angle at a pair: between the lines that lead from its axis to those of the other two pairs by which its chain
!> moves. A slide counts as a pair far away, across its direction.
module mech9_transmission
  use mech9_kinds, only: wp
  use mech9_error, only: error_type
  use mech9_rotation, only: cross
  use mech9_plan, only: plan_type, step_type
  use mech9_state, only: state_type
  use mech9_design_space, only: design_space_type, design_type, new_design
  use mech9_open_position, only: open_position_type, new_open_position, place_at, find_openings, find_derivatives, &
    frame_derivatives
  use mech9_closed_changes, only: closed_changes_type, find_closed_changes
  use mech9_course_extreme, only: course_number_type, course_place_type, sample_course, find_least
  use mech9_exact_fit, only: exact_fit_type
  implicit none
  private
  public :: transmission_type, find_transmission, has_transmission_angle, find_extremes

  !> The steps of the plan between which the angle is measured. Its number is the cosine of the angle.
  type, extends(course_number_type) :: transmission_type
    integer :: middle = 0              !< step of the pair at which it is measured
    integer :: ends(2) = 0             !< steps of the other two pairs
    real(wp) :: least = 0.0_wp         !< least angle that is allowed [rad]
  contains
    procedure :: find => find_cosine
  end type transmission_type

  integer, parameter :: samples = 72            !< intervals of the run in which extremes are looked for
  real(wp), parameter :: parallel = 1.0e-6_wp   !< sine of the angle between axes that are parallel

contains

  !> Find the pairs of a transmission angle: a turning pair and the two others whose coordinates its chain gives, of which one may
  !> slide.
  pure subroutine find_transmission(plan, coordinate, transmission, found)
    type(plan_type), intent(in) :: plan                       !< the plan of the mechanism
    integer, intent(in) :: coordinate                         !< of the pair at which the angle is measured
    type(transmission_type), intent(inout) :: transmission    !< gets the steps
    logical, intent(out) :: found                             !< the angle is defined
    integer :: b, s
    integer, allocatable :: ends(:)

    found = .false.
    s = plan%step_of(coordinate)
    transmission%middle = s
    do b = 1, size(plan%blocks)
      associate (unknowns => plan%blocks(b)%unknowns)
        if (size(unknowns) /= 3 .or. .not. any(unknowns == s)) cycle
        ends = pack(unknowns, unknowns /= s)
        transmission%ends = ends
        found = turns(plan%steps(s)) .and. (turns(plan%steps(ends(1))) .or. turns(plan%steps(ends(2)))) .and. &
                all(turns(plan%steps(ends)) .or. slides(plan%steps(ends)))
      end associate
    end do
  end subroutine find_transmission

  !> Whether a step turns about its axis alone.
  elemental logical function turns(step)
    type(step_type), intent(in) :: step   !< the step

    turns = step%is_screw .and. abs(step%turn) > 0.0_wp .and. .not. abs(step%slide) > 0.0_wp
  end function turns

  !> Whether a step slides along its axis alone.
  elemental logical function slides(step)
    type(step_type), intent(in) :: step   !< the step

    slides = step%is_screw .and. abs(step%slide) > 0.0_wp .and. .not. abs(step%turn) > 0.0_wp
  end function slides

  !> Whether there is a transmission angle at a coordinate in a position of the design of the data file.
  logical function has_transmission_angle(space, q, coordinate) result(exists)
    type(design_space_type), intent(in) :: space    !< the designs
    real(wp), intent(in) :: q(:)                    !< (M) coordinates of the position [rad, m]
    integer, intent(in) :: coordinate               !< of the pair at which the angle is measured
    type(transmission_type) :: transmission
    type(design_type) :: design
    type(open_position_type) :: position
    type(error_type), allocatable :: err

    call find_transmission(space%plan, coordinate, transmission, exists)
    if (.not. exists) return
    call new_design(space, design)
    call new_open_position(design, position)
    position%state%q = q
    call find_openings(design, position, err)
    exists = .not. allocated(err)
    if (exists) exists = is_planar_at(design%in_space, position%state, transmission)
  end function has_transmission_angle

  !> Whether the pairs of a transmission angle move in parallel planes.
  pure logical function is_planar_at(plan, state, transmission)
    type(plan_type), intent(in) :: plan                       !< the plan of the mechanism
    type(state_type), intent(in) :: state                     !< with the screws of the steps, in space
    type(transmission_type), intent(in) :: transmission       !< the pairs
    real(wp) :: n(3)
    integer :: i

    n = state%axis_w(:, transmission%middle)
    is_planar_at = .true.
    do i = 1, 2
      associate (s => transmission%ends(i))
        if (slides(plan%steps(s))) then
          is_planar_at = is_planar_at .and. abs(dot_product(n, state%axis_v(:, s))) <= parallel*norm2(state%axis_v(:, s))
        else
          is_planar_at = is_planar_at .and. norm2(cross(n, state%axis_w(:, s))) <= parallel
        end if
      end associate
    end do
  end function is_planar_at

  !> The least and the largest cosine of the angle in the run of a design, with their derivatives by the parameters.
  subroutine find_extremes(fit, transmission, values, slopes, found)
    class(exact_fit_type), intent(inout) :: fit               !< with a design that has a value and its tangents
    type(transmission_type), intent(in) :: transmission       !< the pairs
    real(wp), intent(out) :: values(2)                        !< least and largest cosine
    real(wp), intent(out) :: slopes(:, :)                     !< (P,2) their derivatives
    logical, intent(out) :: found                             !< they exist
    type(course_place_type) :: cosines(0:samples), extreme
    integer :: k

    call sample_course(transmission, fit%design, fit%position, fit%q_start, [fit%start, fit%end], cosines, found)
    if (.not. found) return
    do k = 1, 2
      call find_least(transmission, merge(1.0_wp, -1.0_wp, k == 1), fit%design, fit%position, cosines, extreme)
      values(k) = extreme%value
      slopes(:, k) = extreme%by_x
    end do
  end subroutine find_extremes

  !> The cosine of the angle at a position, and its derivatives.
  subroutine find_cosine(self, design, position, place, found)
    class(transmission_type), intent(in) :: self              !< the pairs
    type(design_type), intent(in) :: design                   !< placed, with its tangents
    type(open_position_type), intent(inout) :: position       !< scratch
    type(course_place_type), intent(inout) :: place           !< with time and coordinates; gets the cosine
    logical, intent(out) :: found                             !< it exists
    type(closed_changes_type) :: changes
    type(error_type), allocatable :: err
    real(wp) :: line(3, 2), by_q(3, size(place%q), 2), by_x(3, size(design%x), 2), row(size(place%q)), part(size(design%x))
    real(wp) :: lengths(2)
    integer :: i

    call place_at(design, place%t, place%q, position, err)
    found = .not. allocated(err)
    if (.not. found) return
    call find_derivatives(design, position)
    call find_closed_changes(design, position, changes)
    do i = 1, 2
      call find_line(design, position, self, i, line(:, i), by_q(:, :, i), by_x(:, :, i))
      lengths(i) = norm2(line(:, i))
    end do
    found = all(lengths > 0.0_wp)
    if (.not. found) return
    place%value = dot_product(line(:, 1), line(:, 2))/product(lengths)
    row = 0.0_wp
    part = 0.0_wp
    do i = 1, 2
      ! only the change across the line turns it
      associate (across => (line(:, 3 - i)/lengths(3 - i) - place%value*line(:, i)/lengths(i))/lengths(i))
        row = row + matmul(across, by_q(:, :, i))
        part = part + matmul(across, by_x(:, :, i))
      end associate
    end do
    place%by_t = dot_product(row, changes%by_t)
    place%by_x = part + matmul(row, changes%by_x)
  end subroutine find_cosine

  !> The line from the axis of the middle pair to that of another one, or across its slide, in the plane of motion.
  subroutine find_line(design, position, transmission, number, line, by_q, by_x)
    type(design_type), intent(in) :: design                   !< placed, with its tangents
    type(open_position_type), intent(in) :: position          !< with the twists of its frames
    class(transmission_type), intent(in) :: transmission      !< the pairs
    integer, intent(in) :: number                             !< 1 or 2: of the other pair
    real(wp), intent(out) :: line(3)                          !< the line [m], or a direction
    real(wp), intent(out) :: by_q(:, :)                       !< (3,M) its derivatives by the coordinates, each in its unit
    real(wp), intent(out) :: by_x(:, :)                       !< (3,P) by the parameters
    real(wp), dimension(3, size(by_q, 2), 4) :: q
    real(wp), dimension(3, size(by_x, 2), 4) :: x
    real(wp) :: n(3), raw(3)
    integer :: i

    call frame_derivatives(design, position, transmission%middle, q(:, :, 1), x(:, :, 1), q(:, :, 2), x(:, :, 2))
    associate (s => transmission%ends(number), state => position%state)
      call frame_derivatives(design, position, s, q(:, :, 3), x(:, :, 3), q(:, :, 4), x(:, :, 4))
      n = state%axis_w(:, transmission%middle)
      if (slides(design%in_space%steps(s))) then
        raw = cross(n, state%axis_v(:, s))
        do i = 1, size(by_q, 2)
          by_q(:, i) = cross(cross(q(:, i, 2), n), state%axis_v(:, s)) + cross(n, cross(q(:, i, 4), state%axis_v(:, s)))
        end do
        do i = 1, size(by_x, 2)
          by_x(:, i) = cross(cross(x(:, i, 2), n), state%axis_v(:, s)) + cross(n, cross(x(:, i, 4), state%axis_v(:, s)))
        end do
        line = raw
      else
        raw = state%p(:, s) - state%p(:, transmission%middle)
        line = raw - dot_product(n, raw)*n
        do i = 1, size(by_q, 2)
          by_q(:, i) = in_plane(n, raw, q(:, i, 3) - q(:, i, 1), cross(q(:, i, 2), n))
        end do
        do i = 1, size(by_x, 2)
          by_x(:, i) = in_plane(n, raw, x(:, i, 3) - x(:, i, 1), cross(x(:, i, 2), n))
        end do
      end if
    end associate
  end subroutine find_line

  !> The change of the part of a vector that is across a unit normal.
  pure function in_plane(n, vector, change, change_of_normal) result(changed)
    real(wp), intent(in) :: n(3)                   !< unit normal
    real(wp), intent(in) :: vector(3)              !< the vector [m]
    real(wp), intent(in) :: change(3)              !< of the vector
    real(wp), intent(in) :: change_of_normal(3)    !< of the normal
    real(wp) :: changed(3)

    changed = change - dot_product(n, change)*n - dot_product(change_of_normal, vector)*n - dot_product(n, vector)*change_of_normal
  end function in_plane
end module mech9_transmission
