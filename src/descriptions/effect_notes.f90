!> Notes on data without effect, which are allowed but often mistakes: gravity, forces and torques that move nothing in the plane of a
!> planar mechanism, gravity in another unit, lengths of very different size, and drives that stand still.
module mech9_effect_notes
  use mech9_named_words, only: with_names
  use mech9_kinds, only: wp
  use mech9_rotation, only: cross
  use mech9_text, only: to_text
  use mech9_partition, only: free_coordinate
  use mech9_force_load, only: force_load_type
  use mech9_pair_axes, only: pair_axes_type, pair_axes, turning, sliding
  use mech9_link_dimensions, only: link_dimension_type, link_dimensions
  use mech9_mechanism, only: mechanism_type
  use mech9_model, only: model_type
  use mech9_result_units, only: length_text
  implicit none
  private
  public :: print_effects

  !> Directions that differ by less are one, and parts of a vector below this part of it are zero.
  real(wp), parameter :: round_off = 1.0e-9_wp
  !> Gravity of the earth [m/s^2], the part of it that gravity elsewhere on it may differ, and its digits in other units.
  real(wp), parameter :: on_earth = 9.81_wp, variation = 0.01_wp, mistaken(4) = [1.0e-3_wp, 1.0e3_wp, 0.0254_wp, 1.0_wp/0.0254_wp]
  !> Lengths whose ratio is larger were probably given in several units.
  real(wp), parameter :: large_ratio = 1000.0_wp

contains

  !> Write a line for each note.
  subroutine print_effects(unit, model, with_forces)
    integer, intent(in) :: unit             !< Fortran unit to write to
    type(model_type), intent(in) :: model   !< the model
    logical, intent(in) :: with_forces      !< bodies, gravity and loads count
    real(wp) :: normal(3)
    logical :: is_planar

    if (with_forces) then
      call find_plane(model%mechanism, normal, is_planar)
      if (is_planar) call print_across(unit, model%mechanism, normal)
      call print_gravity(unit, model%mechanism)
    end if
    call print_lengths(unit, model%mechanism)
    call print_standing(unit, model)
  end subroutine print_effects

  !> The normal of a mechanism in one plane, if it is in one: the axes about which it turns have one direction in all links, and those
  !> along which it slides are perpendicular to it. Link systems whose axes differ are not looked at.
  pure subroutine find_plane(mechanism, normal, is_planar)
    type(mechanism_type), intent(in) :: mechanism   !< the mechanism
    real(wp), intent(out) :: normal(3)              !< the direction, of length 1
    logical, intent(out) :: is_planar               !< there is one
    type(pair_axes_type), allocatable :: axes(:)
    integer :: i, side

    is_planar = .false.
    normal = 0.0_wp
    axes = pair_axes(mechanism%pairs)
    if (any(axes%kind /= turning .and. axes%kind /= sliding) .or. all(axes%kind /= turning)) return
    normal = axes(findloc(axes%kind, turning, dim=1))%axes(:, 1)
    do i = 1, size(axes)
      do side = 1, 2
        associate (axis => axes(i)%axes(:, side))
          if (axes(i)%kind == turning) then
            if (norm2(cross(axis, normal)) > round_off) return
          else
            if (abs(dot_product(axis, normal)) > round_off) return
          end if
        end associate
      end do
    end do
    is_planar = .true.
  end subroutine find_plane

  !> Note gravity across the plane, and loads without a part in it.
  subroutine print_across(unit, mechanism, normal)
    integer, intent(in) :: unit                     !< Fortran unit to write to
    type(mechanism_type), intent(in) :: mechanism   !< the mechanism
    real(wp), intent(in) :: normal(3)               !< of its plane
    integer :: i

    if (norm2(mechanism%gravity) > 0.0_wp .and. &
        norm2(cross(normal, mechanism%gravity)) <= round_off*norm2(mechanism%gravity)) write (unit, '(a)') &
      'note: gravity acts across the plane of the mechanism and moves nothing; where it should, give it a component in the plane'
    do i = 1, size(mechanism%loads)
      select type (load => mechanism%loads(i)%load)
      class is (force_load_type)
        if (load%is_idle()) cycle
        if (abs(dot_product(normal, load%torque)) > round_off*norm2(load%torque)) cycle
        if (norm2(cross(normal, load%force)) > round_off*norm2(load%force)) cycle
        if (any(abs(load%torque) > 0.0_wp)) then
          write (unit, '(a)') 'note: the torque of load '//to_text(i)//' is about an axis in the plane of the mechanism and '// &
            'moves nothing; one that turns links is about the normal of the plane'
        else
          write (unit, '(a)') 'note: the force of load '//to_text(i)//' acts across the plane of the mechanism and moves '// &
            'nothing; where it should, give it a component in the plane'
        end if
      end select
    end do
  end subroutine print_across

  !> Note gravity with the digits of another unit of lengths, such as 9.81 mm/s^2.
  subroutine print_gravity(unit, mechanism)
    integer, intent(in) :: unit                     !< Fortran unit to write to
    type(mechanism_type), intent(in) :: mechanism   !< the mechanism
    real(wp) :: size_in_file

    if (.not. any(abs(norm2(mechanism%gravity)/(on_earth*mistaken) - 1.0_wp) < variation)) return
    size_in_file = norm2(mechanism%gravity)/mechanism%units%length
    write (unit, '(a)') 'note: gravity is '//to_text(size_in_file, 5)//' '//trim(mechanism%units%name_of('m/s^2'))// &
      '; that of the earth is '//to_text(on_earth/mechanism%units%length, 4)//' '//trim(mechanism%units%name_of('m/s^2'))
  end subroutine print_gravity

  !> Note distances of axes of very different size.
  subroutine print_lengths(unit, mechanism)
    integer, intent(in) :: unit                     !< Fortran unit to write to
    type(mechanism_type), intent(in) :: mechanism   !< the mechanism
    type(link_dimension_type), allocatable :: dimensions(:)
    integer :: least, largest
    logical, allocatable :: counts(:)

    call link_dimensions(mechanism, dimensions)
    if (size(dimensions) == 0) return
    counts = dimensions%has_distance
    counts = counts .and. dimensions%distance > round_off*maxval(dimensions%distance, counts)
    if (count(counts) < 2) return
    least = minloc(dimensions%distance, dim=1, mask=counts)
    largest = maxloc(dimensions%distance, dim=1, mask=counts)
    if (.not. dimensions(largest)%distance > large_ratio*dimensions(least)%distance) return
    write (unit, '(a)') with_names(mechanism%names, &
      'note: axes are '//trim(length_text(mechanism, dimensions(largest)%distance, 6))//' apart in link '// &
      to_text(dimensions(largest)%link)//' and '//trim(length_text(mechanism, dimensions(least)%distance, 6))//' in link '// &
      to_text(dimensions(least)%link)//'; correct one where they were meant in different units')
  end subroutine print_lengths

  !> Note drives that all stand still in a run that lasts, where nothing else moves.
  subroutine print_standing(unit, model)
    integer, intent(in) :: unit             !< Fortran unit to write to
    type(model_type), intent(in) :: model   !< the model
    integer :: i

    associate (time => model%request%time, drives => model%problem%drives)
      if (size(drives) == 0 .or. .not. abs(time%end - time%start) > 0.0_wp) return
      if (any(model%problem%partition%kind == free_coordinate)) return
      do i = 1, size(drives)
        if (drives(i)%drive%greatest_rate(time%start, time%end - time%start) > 0.0_wp) return
      end do
      if (size(drives) == 1) then
        write (unit, '(a)') with_names(model%mechanism%names, 'note: the drive of coordinate '// &
          to_text(drives(1)%drive%coordinate)//' stands still, so that nothing moves')
      else
        write (unit, '(a)') 'note: all drives stand still, so that nothing moves'
      end if
    end associate
  end subroutine print_standing
end module mech9_effect_notes
