!> A view: the direction from which a mechanism is seen in parallel projection.
module mech9_view
  use mech9_kinds, only: wp
  use mech9_error, only: error_type, raise
  use mech9_text, only: lower
  use mech9_rotation, only: cross, unit
  use mech9_numeral, only: numeral_type, read_numeral
  implicit none
  private
  public :: view_type, view_from, view_of_axes, read_view

  !> Directions of the picture in the axes of link 1, of unit length: right x up = towards the viewer.
  type :: view_type
    real(wp) :: right(3) = [1.0_wp, 0.0_wp, 0.0_wp]
    real(wp) :: up(3) = [0.0_wp, 1.0_wp, 0.0_wp]
    real(wp) :: toward(3) = [0.0_wp, 0.0_wp, 1.0_wp]
    logical :: along_normal = .false.   !< the mechanism is planar and seen along the normal of its plane
  contains
    procedure :: seen
  end type view_type

  character(len=*), parameter :: axes = 'xyz'

contains

  !> The components of a vector to the right, upwards, and towards the viewer.
  pure function seen(self, vector)
    class(view_type), intent(in) :: self  !< direction from which the mechanism is seen
    real(wp), intent(in) :: vector(3)     !< the vector, in the axes of link 1
    real(wp) :: seen(3)

    seen = [dot_product(self%right, vector), dot_product(self%up, vector), dot_product(self%toward, vector)]
  end function seen

  !> The view from a given direction; `upward` points up in the picture as far as possible.
  pure function view_from(direction, upward) result(view)
    real(wp), intent(in) :: direction(3)  !< direction from the mechanism to the viewer, in the axes of link 1, not zero
    real(wp), intent(in) :: upward(3)     !< direction that points up in the picture, in the axes of link 1, not zero
    type(view_type) :: view
    real(wp) :: helper(3)

    view%toward = unit(direction)
    helper = unit(upward)
    ! for a view along `upward` itself y points up, or z for a view along y
    if (norm2(cross(helper, view%toward)) < 1.0e-6_wp) helper = [0.0_wp, 1.0_wp, 0.0_wp]
    if (norm2(cross(helper, view%toward)) < 1.0e-6_wp) helper = [0.0_wp, 0.0_wp, 1.0_wp]
    view%right = unit(cross(helper, view%toward))
    view%up = cross(view%toward, view%right)
  end function view_from

  !> The view in which one axis of link 1 points to the right and another one up.
  pure function view_of_axes(right, up) result(view)
    integer, intent(in) :: right  !< number of the axis to the right: 1, 2 or 3
    integer, intent(in) :: up     !< number of the axis upwards, another one than `right`
    type(view_type) :: view

    view%right = 0.0_wp
    view%up = 0.0_wp
    view%right(right) = 1.0_wp
    view%up(up) = 1.0_wp
    view%toward = cross(view%right, view%up)
  end function view_of_axes

  !> Read a view from text. It is two axes, the first to the right and the second up (xy, xz, zy, and so on), or `iso`.
  !> It can be a direction towards the viewer as three numbers with commas. An error gets the exit code `code`.
  pure subroutine read_view(text, code, view, err)
    character(len=*), intent(in) :: text               !< the view as the user wrote it
    integer, intent(in) :: code                        !< exit code of the error, one of the exit_ codes
    type(view_type), intent(out) :: view               !< direction from which the mechanism is seen
    type(error_type), allocatable, intent(out) :: err  !< allocated if it failed
    character(len=:), allocatable :: word
    real(wp) :: direction(3)
    integer :: right, up
    logical :: known

    word = trim(adjustl(lower(text)))
    if (word == 'iso') then
      view = view_from([1.0_wp, -1.0_wp, 0.8_wp], [0.0_wp, 0.0_wp, 1.0_wp])
      return
    end if
    if (len(word) == 2) then
      right = index(axes, word(1:1))
      up = index(axes, word(2:2))
      if (right > 0 .and. up > 0 .and. right /= up) then
        view = view_of_axes(right, up)
        return
      end if
    end if
    call read_direction(word, direction, known)
    if (known) then
      view = view_from(direction, [0.0_wp, 0.0_wp, 1.0_wp])
      return
    end if
    call raise(err, code, "'"//text//"' is no view; give two axes, to the right and up, as in xy or xz, or iso, "// &
               'or the direction towards the viewer, as in 1,-2,0.5')
  end subroutine read_view

  !> Read a direction: three numbers with commas between them, not all zero.
  pure subroutine read_direction(text, direction, known)
    character(len=*), intent(in) :: text   !< the text, in small letters
    real(wp), intent(out) :: direction(3)  !< the direction, in the axes of link 1
    logical, intent(out) :: known          !< the text is a direction
    type(numeral_type) :: numeral
    integer :: i, first, last

    known = .false.
    direction = 0.0_wp
    first = 1
    do i = 1, 3
      last = len(text)
      if (i < 3) last = first + index(text(first:), ',') - 2
      if (last < first) return
      call read_numeral(trim(adjustl(text(first:last))), numeral)
      if (allocated(numeral%problem)) return
      direction(i) = numeral%number
      first = min(last + 2, len(text) + 1)
    end do
    known = maxval(abs(direction)) > 0.0_wp
  end subroutine read_direction
end module mech9_view
