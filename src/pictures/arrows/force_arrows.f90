!> The arrows of a film: of forces and moments in pairs, of loads and weights, of stops, frictions and contacts, and of velocities and
!> accelerations of points. The longest arrow of each measure in a film is a part of the mechanism's size. Velocity poles of links are
!> marks that move from frame to frame in the same way.
module mech9_force_arrows
  use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
  use mech9_kinds, only: wp
  use mech9_text, only: to_text
  use mech9_part_names, only: add_names
  use mech9_rotation, only: unit
  use mech9_mechanism, only: mechanism_type
  use mech9_pair_axes, only: pair_axes_type, pair_axes
  use mech9_film, only: film_type
  use mech9_touching_forces, only: from_stop, from_friction, from_contact
  use mech9_scene, only: in_force, in_moment, in_load, in_weight, in_touching, in_velocity, in_acceleration, as_pole
  use mech9_arrow, only: arrow_type, append_arrow, remove_arrow, double, ring, pole
  implicit none
  private
  public :: find_arrows, is_near

  !> Measures: arrows of the same one have one scale.
  integer, parameter :: of_acceleration = 1, of_velocity = 2, of_force = 3, of_torque = 4
  !> Their units, and none for those that have columns.
  character(len=3), parameter :: units(4) = [character(len=3) :: '', '', 'N', 'N m']

  !> Length of the longest arrow, as a part of the mechanism's size.
  real(wp), parameter, public :: longest = 0.22_wp
  !> Loads and moments below this part of the greatest force, or of this force times the mechanism's size, are round-off.
  real(wp), parameter :: negligible = 1.0e-9_wp
  !> A moment is drawn round its axis where the cosine between the axis and the view is at least this.
  real(wp), parameter :: along_view = 0.25_wp
  !> Poles farther away than this multiple of the mechanism's size are at infinity.
  real(wp), parameter :: farthest = 1.0e3_wp

contains

  !> List all arrows with their lengths on the mechanism's scale; none where a film keeps nothing to be shown by arrows.
  subroutine find_arrows(mechanism, film, size_drawn, toward, arrows)
    type(mechanism_type), intent(in) :: mechanism                !< the mechanism
    type(film_type), intent(in) :: film                          !< poses, values and forces at the outputs of the run
    real(wp), intent(in) :: size_drawn                           !< the mechanism's size [m]
    real(wp), intent(in) :: toward(3)                            !< direction towards the viewer, in the axes of link 1
    type(arrow_type), allocatable, intent(out) :: arrows(:)      !< in the order in which they are drawn; poles are the last
    integer :: measure

    allocate (arrows(0))
    if (allocated(film%accelerations)) call append_motions(mechanism, 'acceleration', in_acceleration, of_acceleration, &
                                                           film%accelerations(:, :, :film%n_frames), arrows)
    if (allocated(film%velocities)) call append_motions(mechanism, 'velocity', in_velocity, of_velocity, &
                                                        film%velocities(:, :, :film%n_frames), arrows)
    if (allocated(film%forces)) then
      call append_wrenches(mechanism, film, arrows)
      call append_applied(film, arrows)
      call append_touching(mechanism, film, arrows)
      call remove_negligible(size_drawn, arrows)
      call finish_texts(mechanism, arrows)
    end if
    do measure = of_acceleration, of_torque
      call scale_measure(measure, size_drawn, arrows)
    end do
    call choose_shapes(toward, arrows)
    call append_poles(mechanism, film, farthest*size_drawn, arrows)
  end subroutine find_arrows

  !> Append the arrows of the motion of all points but those of link 1.
  subroutine append_motions(mechanism, kind, style, measure, vectors, arrows)
    type(mechanism_type), intent(in) :: mechanism                !< the mechanism
    character(len=*), intent(in) :: kind                         !< velocity or acceleration
    integer, intent(in) :: style                                 !< style of its kind
    integer, intent(in) :: measure                               !< its measure
    real(wp), intent(in) :: vectors(:, :, :)                     !< (3,points,frames) [m/s, m/s^2]
    type(arrow_type), allocatable, intent(inout) :: arrows(:)    !< gets the arrows
    type(arrow_type) :: arrow
    integer :: i

    arrow%style = style
    arrow%measure = measure
    do i = 1, size(mechanism%points)
      associate (point => mechanism%points(i))
        if (point%link == 1) cycle
        arrow%text = kind//' of '//point%name
        arrow%link = point%link
        arrow%foot = point%position
        arrow%ways = vectors(:, i, :)
        call append_arrow(arrow, arrows)
      end associate
    end do
  end subroutine append_motions

  !> Append the forces and moments in pairs. Those of a joint with several freedoms are those of its last pair.
  subroutine append_wrenches(mechanism, film, arrows)
    type(mechanism_type), intent(in) :: mechanism                !< the mechanism
    type(film_type), intent(in) :: film                          !< with forces in pairs
    type(arrow_type), allocatable, intent(inout) :: arrows(:)    !< gets the arrows
    type(pair_axes_type), allocatable :: axes(:)
    type(arrow_type) :: arrow
    integer :: i, k, joint, last

    axes = pair_axes(mechanism%pairs)
    do i = 1, size(film%force_pairs)
      k = film%force_pairs(i)
      last = k
      joint = mechanism%structure%joint_of(k)
      if (joint > 0) last = mechanism%structure%joints(joint)%numbers(mechanism%structure%joints(joint)%freedoms)
      arrow%link = axes(last)%links(2)
      arrow%foot = axes(last)%points(:, 2)
      arrow%style = in_force
      arrow%measure = of_force
      arrow%text = 'force in pair '//to_text(k)
      arrow%ways = film%forces(:, i, :film%n_frames)
      call append_arrow(arrow, arrows)
      arrow%style = in_moment
      arrow%measure = of_torque
      arrow%text = 'moment in pair '//to_text(k)
      arrow%ways = film%moments(:, i, :film%n_frames)
      call append_arrow(arrow, arrows)
    end do
  end subroutine append_wrenches

  !> Append the loads on links and the weights.
  subroutine append_applied(film, arrows)
    type(film_type), intent(in) :: film                          !< with loads and weights
    type(arrow_type), allocatable, intent(inout) :: arrows(:)    !< gets the arrows
    type(arrow_type) :: arrow
    integer :: i

    do i = 1, size(film%applied)
      associate (item => film%applied(i))
        arrow%link = item%link
        arrow%foot = item%foot
        arrow%ways = film%applied_vectors(:, i, :film%n_frames)
        arrow%measure = merge(of_torque, of_force, item%is_torque)
        arrow%style = in_load
        if (item%load == 0) then
          arrow%style = in_weight
          arrow%text = 'weight of link '//to_text(item%link)
        else
          arrow%text = 'load '//to_text(item%load)//': '//trim(merge('torque', 'force ', item%is_torque))//' on link '// &
                       to_text(item%link)
        end if
        call append_arrow(arrow, arrows)
      end associate
    end do
  end subroutine append_applied

  !> Append the forces of stops, frictions and contacts.
  subroutine append_touching(mechanism, film, arrows)
    type(mechanism_type), intent(in) :: mechanism                !< the mechanism
    type(film_type), intent(in) :: film                          !< with these forces
    type(arrow_type), allocatable, intent(inout) :: arrows(:)    !< gets the arrows
    type(arrow_type) :: arrow
    character(len=:), allocatable :: what
    integer :: i

    do i = 1, size(film%touching)
      associate (item => film%touching(i))
        what = trim(merge('torque', 'force ', item%is_torque))
        arrow%style = in_touching
        arrow%link = item%link
        arrow%foot = item%foot
        arrow%ways = film%touching_vectors(:, i, :film%n_frames)
        arrow%measure = merge(of_torque, of_force, item%is_torque)
        select case (item%source)
        case (from_stop)
          arrow%text = 'stop '//to_text(item%number)//': '//what//' in pair '//to_text(mechanism%stops(item%number)%coordinate)
        case (from_friction)
          arrow%text = 'friction: '//what//' in pair '//to_text(mechanism%frictions(item%number)%coordinate)
        case (from_contact)
          arrow%text = 'contact '//to_text(mechanism%contacts(item%number)%number)//': '//what//' on link '//to_text(item%link)
          arrow%link = 1
          arrow%feet = film%touching_feet(:, i, :film%n_frames)
        end select
        call append_arrow(arrow, arrows)
      end associate
    end do
  end subroutine append_touching

  !> Remove loads, weights and moments that are zero in all frames. Forces in pairs stay, without their round-off.
  subroutine remove_negligible(size_drawn, arrows)
    real(wp), intent(in) :: size_drawn                           !< the mechanism's size [m]
    type(arrow_type), allocatable, intent(inout) :: arrows(:)    !< all arrows
    real(wp) :: force, torque
    integer :: i

    force = greatest_of(of_force, arrows)
    torque = max(greatest_of(of_torque, arrows), force*size_drawn)
    do i = size(arrows), 1, -1
      if (arrows(i)%measure < of_force) cycle
      if (arrows(i)%greatest() > negligible*merge(torque, force, arrows(i)%measure == of_torque)) cycle
      if (arrows(i)%style == in_force) then
        arrows(i)%ways = 0.0_wp
      else
        call remove_arrow(i, arrows)
      end if
    end do
  end subroutine remove_negligible

  !> The greatest length of the vectors of a measure.
  pure real(wp) function greatest_of(measure, arrows) result(greatest)
    integer, intent(in) :: measure               !< the measure
    type(arrow_type), intent(in) :: arrows(:)    !< all arrows
    integer :: i

    greatest = 0.0_wp
    do i = 1, size(arrows)
      if (arrows(i)%measure == measure) greatest = max(greatest, arrows(i)%greatest())
    end do
  end function greatest_of

  !> Add names of pairs and links, and the greatest size of forces and moments, to their texts.
  subroutine finish_texts(mechanism, arrows)
    type(mechanism_type), intent(in) :: mechanism      !< the mechanism
    type(arrow_type), intent(inout) :: arrows(:)       !< all arrows, with vectors in N and N m
    integer :: i

    do i = 1, size(arrows)
      associate (arrow => arrows(i))
        if (arrow%measure < of_force) cycle
        call add_names(mechanism%names, arrow%text)
        arrow%text = arrow%text//trim(merge(',        ', ', at most', arrow%style == in_weight))//' '// &
                     to_text(arrow%greatest()/mechanism%units%size_of(trim(units(arrow%measure))), 4)//' '// &
                     trim(mechanism%units%name_of(trim(units(arrow%measure))))
      end associate
    end do
  end subroutine finish_texts

  !> Scale the arrows of one measure so that the longest one is a part of the mechanism's size.
  subroutine scale_measure(measure, size_drawn, arrows)
    integer, intent(in) :: measure                   !< the measure
    real(wp), intent(in) :: size_drawn               !< the mechanism's size [m]
    type(arrow_type), intent(inout) :: arrows(:)     !< all arrows
    real(wp) :: greatest
    integer :: i

    greatest = greatest_of(measure, arrows)
    if (.not. greatest > 0.0_wp) return
    do i = 1, size(arrows)
      if (arrows(i)%measure == measure) arrows(i)%ways = (longest*size_drawn)*(arrows(i)%ways/greatest)
    end do
  end subroutine scale_measure

  !> Choose the shapes of moments by the direction that each has where it is greatest.
  subroutine choose_shapes(toward, arrows)
    real(wp), intent(in) :: toward(3)                !< direction towards the viewer
    type(arrow_type), intent(inout) :: arrows(:)     !< all arrows
    integer :: i, frame

    do i = 1, size(arrows)
      if (arrows(i)%measure /= of_torque) cycle
      frame = maxloc(sum(arrows(i)%ways**2, dim=1), dim=1)
      arrows(i)%shape = double
      if (abs(dot_product(unit(arrows(i)%ways(:, frame)), toward)) >= along_view) arrows(i)%shape = ring
    end do
  end subroutine choose_shapes

  !> Append the velocity poles that have columns. Axes without a column are those across the plane of the motion.
  subroutine append_poles(mechanism, film, most, arrows)
    type(mechanism_type), intent(in) :: mechanism                !< the mechanism
    type(film_type), intent(in) :: film                          !< with the columns
    real(wp), intent(in) :: most                                 !< largest distance from the origin of link 1 [m]
    type(arrow_type), allocatable, intent(inout) :: arrows(:)    !< gets the poles
    character(len=*), parameter :: middle = '.pole.'
    type(arrow_type) :: arrow
    real(wp) :: ways(3, film%n_frames)
    integer :: first, last, at, axis

    first = 1
    do while (first <= size(film%names))
      associate (name => film%names(first)%text)
        at = index(name, middle)
        ! derivatives of such columns have longer names
        if (at > 1) at = merge(at, 0, name(1:1) == 'L' .and. verify(name(2:at - 1), '0123456789') == 0)
        last = first
        if (at > 0) then
          ways = 0.0_wp
          do while (last <= size(film%names))
            if (index(film%names(last)%text, name(:at + len(middle) - 1)) /= 1) exit
            axis = index('xyz', film%names(last)%text(at + len(middle):))
            ways(axis, :) = film%values(last, :film%n_frames)
            last = last + 1
          end do
          where (ieee_is_finite(ways)) ways = ways*mechanism%units%length
          call mark_far(most, ways)
          arrow%style = as_pole
          arrow%shape = pole
          arrow%measure = 0
          arrow%text = 'velocity pole of link '//name(2:at - 1)
          call add_names(mechanism%names, arrow%text)
          arrow%link = 1
          arrow%ways = ways
          call append_arrow(arrow, arrows)
          last = last - 1
        end if
      end associate
      first = last + 1
    end do
  end subroutine append_poles

  !> Mark the frames in which a pole is too far away by a huge first component.
  subroutine mark_far(most, ways)
    real(wp), intent(in) :: most             !< largest distance from the origin of link 1 [m]
    real(wp), intent(inout) :: ways(:, :)    !< (3,frames) places, with infinite ones and ones that are no numbers
    integer :: frame

    do frame = 1, size(ways, 2)
      if (all(ieee_is_finite(ways(:, frame)))) then
        if (maxval(abs(ways(:, frame))) <= most) cycle
      end if
      ways(:, frame) = 0.0_wp
      ways(1, frame) = huge(1.0_wp)
    end do
  end subroutine mark_far

  !> Whether a pole is near enough in a frame.
  pure logical function is_near(way)
    real(wp), intent(in) :: way(3)   !< its place as mark_far leaves it

    is_near = way(1) < huge(1.0_wp)
  end function is_near
end module mech9_force_arrows
