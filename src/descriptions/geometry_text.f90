!> The dimensions of links and curves in words, for --check.
module mech9_geometry_text
  use mech9_named_words, only: named_number
  use mech9_kinds, only: wp
  use mech9_text, only: to_text
  use mech9_counted, only: counted
  use mech9_pair, only: pair_guide_type
  use mech9_part_names, only: part_names_type, name_in, label_of
  use mech9_mechanism, only: mechanism_type
  use mech9_result_units, only: length_text
  use mech9_link_dimensions, only: link_dimension_type, link_dimensions
  implicit none
  private
  public :: print_dimensions

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
    character(len=:), allocatable :: length_name
    real(wp) :: largest, shown(3)
    logical :: given(3)
    integer :: i

    call print_curves(unit, mechanism)
    call link_dimensions(mechanism, dimensions)
    if (size(dimensions) == 0) return
    angle_name = mechanism%units%angle_name
    length_name = '['//trim(mechanism%units%length_name)//']'
    largest = max(maxval(dimensions%distance), maxval(dimensions%between_points))
    write (unit, '(a)') 'dimensions of the links: distance and angle between the axes of two pairs, distance of their points'
    write (unit, '(2x,a6,2x,a12,3a16)') 'link', 'pairs       ', 'axes '//length_name, 'angle ['//angle_name//']', &
      'points '//length_name
    do i = 1, min(size(dimensions), most_lines)
      associate (d => dimensions(i), length => mechanism%units%length)
        given = [d%has_distance, d%has_angle, d%has_points]
        shown = [d%distance/length, d%angle/mechanism%units%angle, d%between_points/length]
        where (abs(shown) <= round_off*[largest/length, 1.0_wp/mechanism%units%angle, largest/length]) shown = 0.0_wp
        write (unit, '(2x,i6,2x,a12,2a16,a)') d%link, left(to_text(d%pairs(1))//' and '//to_text(d%pairs(2))), &
          right(shown(1), given(1)), right(shown(2), given(2)), right(shown(3), given(3))//names_of(mechanism%names, d)
      end associate
    end do
    if (size(dimensions) > most_lines) write (unit, '(a)') '  and '//counted(size(dimensions) - most_lines, 'more line')
  end subroutine print_dimensions

  !> The names of a link and its two pairs, behind their dimensions; empty where none has any.
  pure function names_of(names, dimension) result(text)
    type(part_names_type), intent(in) :: names             !< of links and pairs
    type(link_dimension_type), intent(in) :: dimension     !< of the link
    character(len=:), allocatable :: text
    integer :: i

    text = ''
    associate (pairs => dimension%pairs)
      if (name_in(names%links, dimension%link) == '' .and. &
          all([(name_in(names%coordinates, pairs(i)) == '', i=1, size(pairs))])) return
      text = '  '//trim(label_of(names%links, dimension%link))//': '//trim(label_of(names%coordinates, pairs(1)))//' and '// &
             trim(label_of(names%coordinates, pairs(2)))
    end associate
  end function names_of

  !> Write the length of each curve along which a pair leads its moving link.
  subroutine print_curves(unit, mechanism)
    integer, intent(in) :: unit                    !< Fortran unit to write to
    type(mechanism_type), intent(in) :: mechanism  !< the mechanism
    type(pair_guide_type) :: guide
    integer :: k

    do k = 1, size(mechanism%pairs)
      call mechanism%pairs(k)%pair%guide(guide)
      if (.not. guide%length > 0.0_wp) cycle
      write (unit, '(a)') 'curve of pair '//named_number(mechanism%names%coordinates, k)//': '// &
        trim(merge('closed', 'open  ', guide%closed))//', length '//trim(length_text(mechanism, guide%length, 10))
    end do
  end subroutine print_curves

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
end module mech9_geometry_text
