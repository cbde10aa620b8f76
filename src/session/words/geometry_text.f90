!> The geometry in words: the dimensions of links for --check, and oddities of chains that cannot close or move.
module mech9_geometry_text
  use mech9_kinds, only: wp, radians_per_degree
  use mech9_error, only: error_type, add_place, exit_structure, exit_assembly
  use mech9_explanation, only: explain
  use mech9_text, only: to_text
  use mech9_mechanism, only: mechanism_type
  use mech9_link_dimensions, only: link_dimension_type, link_dimensions
  use mech9_loop_geometry, only: oddity_type, find_oddity, none_found, bent_link, not_parallel, not_across, not_concurrent, &
                                 other_height, too_long
  implicit none
  private
  public :: print_dimensions, explain_geometry

  !> Most lines of the table.
  integer, parameter :: most_lines = 40
  !> Lengths below this part of the largest one, and angles below this [rad], are shown as zero: they are round-off.
  real(wp), parameter :: round_off = 1.0e-13_wp
  !> Significant digits of lengths and angles.
  integer, parameter :: digits = 6

contains

  !> Write the dimensions of the links, in which a wrong number of the data file is noticed.
  subroutine print_dimensions(unit, mechanism)
    integer, intent(in) :: unit                    !< Fortran unit to write to
    type(mechanism_type), intent(in) :: mechanism  !< the mechanism
    type(link_dimension_type), allocatable :: dimensions(:)
    character(len=3) :: angle_name
    real(wp) :: largest, shown(3)
    logical :: given(3)
    integer :: i

    call link_dimensions(mechanism, dimensions)
    if (size(dimensions) == 0) return
    angle_name = merge('rad', 'deg', abs(mechanism%angle_unit - 1.0_wp) <= 0.0_wp)
    largest = max(maxval(dimensions%distance), maxval(dimensions%between_points))
    write (unit, '(a)') 'dimensions of the links: distance and angle between the axes of two pairs, distance of their points'
    write (unit, '(2x,a6,2x,a12,3a16)') 'link', 'pairs       ', 'axes [m]', 'angle ['//angle_name//']', 'points [m]'
    do i = 1, min(size(dimensions), most_lines)
      associate (d => dimensions(i))
        given = [d%has_distance, d%has_angle, d%has_points]
        shown = [d%distance, d%angle/mechanism%angle_unit, d%between_points]
        where (abs(shown) <= round_off*[largest, 1.0_wp/mechanism%angle_unit, largest]) shown = 0.0_wp
        write (unit, '(2x,i6,2x,a12,3a16)') d%link, left(to_text(d%pairs(1))//' and '//to_text(d%pairs(2))), &
          right(shown(1), given(1)), right(shown(2), given(2)), right(shown(3), given(3))
      end associate
    end do
    if (size(dimensions) > most_lines) write (unit, '(a)') '  and '//to_text(size(dimensions) - most_lines)//' more lines'
  end subroutine print_dimensions

  !> A text at the left of a column.
  pure character(len=12) function left(text)
    character(len=*), intent(in) :: text  !< the text; of a longer one the beginning remains

    left = text
  end function left

  !> A number at the right of a column; a dash where there is none.
  pure character(len=16) function right(number, given)
    real(wp), intent(in) :: number  !< the number
    logical, intent(in) :: given    !< whether there is a number

    right = '-'
    if (given) right = to_text(number, digits)
    right = adjustr(right)
  end function right

  !> Add the oddity of a geometry to the error of a mechanism that cannot be assembled or cannot move: before the message, with
  !> the place of the pair that is probably wrong. Other errors, and those of mechanisms without oddities, do not change.
  subroutine explain_geometry(mechanism, err)
    type(mechanism_type), intent(in) :: mechanism        !< the mechanism
    type(error_type), allocatable, intent(inout) :: err  !< allocated if it failed
    type(oddity_type) :: oddity

    if (.not. allocated(err)) return
    if (err%code /= exit_structure .and. err%code /= exit_assembly) return
    call find_oddity(mechanism, oddity)
    if (oddity%kind == none_found) return
    call explain(err)
    err%message = words_of(oddity)//'; '//err%message
    if (size(oddity%odd) > 0) call add_place(err, place=mechanism%pairs(oddity%odd(1))%pair%place)
  end subroutine explain_geometry

  !> A sentence about an oddity.
  pure function words_of(oddity) result(words)
    type(oddity_type), intent(in) :: oddity  !< the oddity, with pairs, link, angle or distance by its kind
    character(len=:), allocatable :: words, chain, pairs

    chain = ' of the closed chain of pairs '//to_text(oddity%pairs)
    pairs = trim(merge('pairs', 'pair ', size(oddity%odd) > 1))//' '//to_text(oddity%odd)
    select case (oddity%kind)
    case (not_parallel)
      words = 'the axis of '//pairs//' is not parallel to the other axes'//chain//' (by '//degrees(oddity%angle)// &
              '), which could move in a plane'
    case (not_across)
      words = 'the slide of '//pairs//' is not at right angles to the other axes'//chain//' (by '//degrees(oddity%angle)// &
              '), which could move in a plane'
    case (not_concurrent)
      words = 'the axis of '//pairs//' misses the point in which the other axes'//chain//' meet by '// &
              to_text(oddity%distance, 3)//' m'
    case (other_height)
      words = 'the points of its pairs leave the closed chain of pairs '//to_text(oddity%pairs)//' open by '// &
              to_text(oddity%distance, 3)//' m along its parallel axes, wherever it moves'
      if (size(oddity%odd) > 0) words = words//': see point and moving_point of '//pairs
    case (too_long)
      words = 'link '//to_text(oddity%link)//' is '//to_text(oddity%distance, digits)//' m long from pair '// &
              to_text(oddity%odd(1))//' to pair '//to_text(oddity%odd(2))//', and the other links'//chain//' are '// &
              to_text(oddity%others, digits)//' m long together'
    case (bent_link)
      words = 'the axes of '//pairs//' are not parallel on link '//to_text(oddity%link)//' (by '//degrees(oddity%angle)// &
              '), as they are on all other links'//chain//': see axis and moving_axis of these pairs'
    case default
      words = ''
    end select
  end function words_of

  !> The angle in words: "5.71 degrees".
  pure function degrees(angle) result(words)
    real(wp), intent(in) :: angle  !< the angle [rad]
    character(len=:), allocatable :: words

    words = to_text(angle/radians_per_degree, 3)//' degrees'
  end function degrees
end module mech9_geometry_text
