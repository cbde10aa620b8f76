!> The layout of plots: the size of a picture, and the places of its panels, which leave room for numbers, labels and keys.
module mech9_plot_layout
  use mech9_kinds, only: wp
  use mech9_text, only: to_text
  use mech9_plot_request, only: curve_type
  use mech9_plot_data, only: plot_data_type
  use mech9_plot_panels, only: over_time
  use mech9_plot_style, only: digits_needed
  implicit none
  private
  public :: layout_type, find_plot_layout, picture_width, margins, equal_scales, ranges_of, curve_name

  character, parameter :: line_end = achar(10)

  !> Places on the page, from its lower left corner [px].
  type :: layout_type
    integer :: width = 960, height = 540
    integer, allocatable :: left(:), right(:), bottom(:), top(:)   !< (panels) sides of the area between the axes
  end type layout_type

  !> Usual size of a picture, height of each of several panels, longest one of a panel with equal scales, and longer side of such a
  !> panel alone [px].
  integer, parameter :: usual_width = 960, one_height = 440, panel_height = 195, highest = 620, longer_side = 700
  !> Room of a letter, one in a key, and a line, of the axis below with its label, the same between panels, above beside the title, between panels
  !> that share an axis, at the right side, and of the sample in a key [px]. gnuplot leaves out texts that have no room.
  integer, parameter :: letter = 9, key_letter = 10, line = 20, below = 78, between = 94, above = 32, shared = 32, beside = 36, &
                        sample = 54
  !> The sides of an area with equal scales differ at most by these factors: one that is wide, and one that is tall.
  real(wp), parameter :: flattest = 0.35_wp, slimmest = 0.6_wp
  !> Letters that the numbers of an upward axis take at least, with its label.
  integer, parameter :: fewest_letters = 12, label_letters = 7, longest_kind = 6

contains

  !> The width of a picture, which does not depend on its title [px].
  pure integer function picture_width(curves, panels, data, with_events) result(width)
    type(curve_type), intent(in) :: curves(:)  !< the curves, each with its two columns
    integer, intent(in) :: panels(:)           !< number of the panel of each curve
    type(plot_data_type), intent(in) :: data   !< rows and columns that are plotted
    logical, intent(in) :: with_events         !< the key has the kinds of events
    real(wp) :: sides(2)

    width = usual_width
    if (maxval(panels) > 1) return
    if (.not. equal_scales(curves, data)) return
    sides = true_sides(curves, data)
    width = left_of(curves, panels, data) + nint(longer_side*sides(1)/maxval(sides)) + right_of(curves, panels, data, with_events)
  end function picture_width

  !> Find the places of all panels. Panels over time share the axis of the last one.
  pure subroutine find_plot_layout(curves, panels, data, with_events, title_lines, layout)
    type(curve_type), intent(in) :: curves(:)      !< the curves, each with its two columns
    integer, intent(in) :: panels(:)               !< number of the panel of each curve
    type(plot_data_type), intent(in) :: data       !< rows and columns that are plotted
    logical, intent(in) :: with_events             !< the key has the kinds of events
    integer, intent(in) :: title_lines             !< lines of the title
    type(layout_type), intent(out) :: layout       !< the places
    type(curve_type), allocatable :: own(:)
    integer :: heights(maxval(panels)), gaps(maxval(panels)), i, n, top

    n = maxval(panels)
    layout%width = picture_width(curves, panels, data, with_events)
    allocate (layout%left(n), source=left_of(curves, panels, data))
    allocate (layout%right(n), source=layout%width - right_of(curves, panels, data, with_events))
    allocate (layout%bottom(n), layout%top(n), source=0)
    gaps = between
    gaps(n) = below
    do i = 1, n
      own = pack(curves, panels == i)
      heights(i) = merge(one_height, panel_height, n == 1)
      if (equal_scales(own, data)) heights(i) = true_height(own, data, layout%right(i) - layout%left(i), n == 1)
      if (i < n .and. over_time(own(1))) gaps(i) = shared
    end do
    top = above + line*title_lines
    layout%height = top + sum(heights) + sum(gaps)
    top = layout%height - top
    do i = 1, n
      layout%top(i) = top
      layout%bottom(i) = top - heights(i)
      top = layout%bottom(i) - gaps(i)
    end do
  end subroutine find_plot_layout

  !> The commands for the margins of a panel.
  pure function margins(layout, i) result(text)
    type(layout_type), intent(in) :: layout   !< places of all panels
    integer, intent(in) :: i                  !< number of the panel
    character(len=:), allocatable :: text

    text = 'set lmargin at screen '//part(layout%left(i), layout%width)//line_end// &
           'set rmargin at screen '//part(layout%right(i), layout%width)//line_end// &
           'set bmargin at screen '//part(layout%bottom(i), layout%height)//line_end// &
           'set tmargin at screen '//part(layout%top(i), layout%height)//line_end
  end function margins

  !> A part of a length as text.
  pure function part(place, length) result(text)
    integer, intent(in) :: place    !< distance from its beginning [px]
    integer, intent(in) :: length   !< the length [px]
    character(len=:), allocatable :: text

    text = to_text(real(place, wp)/length, 6)
  end function part

  !> The room at the left side of the axes: that of the longest numbers of all panels [px].
  pure integer function left_of(curves, panels, data) result(room)
    type(curve_type), intent(in) :: curves(:)  !< the curves, each with its two columns
    integer, intent(in) :: panels(:)           !< number of the panel of each curve
    type(plot_data_type), intent(in) :: data   !< rows and columns that are plotted
    integer :: i, letters

    letters = fewest_letters
    do i = 1, maxval(panels)
      letters = max(letters, label_letters + letters_needed(data%extent(pack(curves%y, panels == i))))
    end do
    room = letter*letters
  end function left_of

  !> The room at the right side of the axes: that of the longest name of a curve in a key [px].
  pure integer function right_of(curves, panels, data, with_events) result(room)
    type(curve_type), intent(in) :: curves(:)  !< the curves, each with its two columns
    integer, intent(in) :: panels(:)           !< number of the panel of each curve
    type(plot_data_type), intent(in) :: data   !< rows and columns that are plotted
    logical, intent(in) :: with_events         !< the key has the kinds of events
    type(curve_type), allocatable :: own(:)
    integer :: i

    room = beside
    do i = 1, maxval(panels)
      own = pack(curves, panels == i)
      if (size(own) > 1) room = max(room, sample + key_letter*longest_name(own, data))
      if (with_events .and. over_time(own(1))) room = max(room, sample + key_letter*longest_kind)
    end do
  end function right_of

  !> Whether both axes show lengths, velocities or forces in one unit, so that the picture shows true shapes. Angles have no shape.
  pure logical function equal_scales(curves, data)
    type(curve_type), intent(in) :: curves(:)  !< the curves of one panel, each with its two columns
    type(plot_data_type), intent(in) :: data   !< rows and columns that are plotted

    associate (unit => data%units(curves(1)%x)%text)
      equal_scales = unit == data%units(curves(1)%y)%text .and. .not. over_time(curves(1)) &
                     .and. index(unit, 'deg') /= 1 .and. index(unit, 'rad') /= 1 .and. unit /= 'rpm'
    end associate
    if (equal_scales) equal_scales = maxval(spans_of(curves, data)) > tiny(1.0_wp)
  end function equal_scales

  !> The lengths of both ranges of values.
  pure function spans_of(curves, data) result(spans)
    type(curve_type), intent(in) :: curves(:)  !< the curves of one panel, each with its two columns
    type(plot_data_type), intent(in) :: data   !< rows and columns that are plotted
    real(wp) :: spans(2), ends(2)

    ends = data%extent(curves%x)
    spans(1) = ends(2) - ends(1)
    ends = data%extent(curves%y)
    spans(2) = ends(2) - ends(1)
  end function spans_of

  !> The sides of an area with equal scales. A slim or flat path gets more room at both sides.
  pure function true_sides(curves, data) result(sides)
    type(curve_type), intent(in) :: curves(:)  !< the curves of one panel, each with its two columns
    type(plot_data_type), intent(in) :: data   !< rows and columns that are plotted
    real(wp) :: sides(2), spans(2)

    spans = spans_of(curves, data)
    sides = max(spans, [slimmest, flattest]*maxval(spans))
  end function true_sides

  !> The height of an area with equal scales that has a given width [px].
  pure integer function true_height(curves, data, width, alone) result(height)
    type(curve_type), intent(in) :: curves(:)  !< the curves of one panel, each with its two columns
    type(plot_data_type), intent(in) :: data   !< rows and columns that are plotted
    integer, intent(in) :: width               !< of the area [px]
    logical, intent(in) :: alone               !< the picture has no other panel
    real(wp) :: sides(2)

    sides = true_sides(curves, data)
    height = nint(width*sides(2)/sides(1))
    if (.not. alone) height = max(panel_height, min(highest, height))
  end function true_height

  !> The ranges of both axes with equal scales, with margins around the values: they fill an area.
  pure function ranges_of(curves, data, width, height) result(ranges)
    type(curve_type), intent(in) :: curves(:)  !< the curves of one panel, each with its two columns
    type(plot_data_type), intent(in) :: data   !< rows and columns that are plotted
    integer, intent(in) :: width               !< of the area [px]
    integer, intent(in) :: height              !< of the area [px]
    real(wp) :: ranges(2, 2)                   !< least and greatest value, of the axis to the right and of that upwards
    real(wp), parameter :: half_with_margin = 0.55_wp
    real(wp) :: x(2), y(2), scale

    x = data%extent(curves%x)
    y = data%extent(curves%y)
    scale = half_with_margin*max((x(2) - x(1))/width, (y(2) - y(1))/height)
    ranges(:, 1) = 0.5_wp*(x(1) + x(2)) + scale*width*[-1.0_wp, 1.0_wp]
    ranges(:, 2) = 0.5_wp*(y(1) + y(2)) + scale*height*[-1.0_wp, 1.0_wp]
  end function ranges_of

  !> The number of letters of the longest name of a curve.
  pure integer function longest_name(curves, data)
    type(curve_type), intent(in) :: curves(:)  !< the curves, each with its two columns
    type(plot_data_type), intent(in) :: data   !< rows and columns that are plotted
    integer :: i

    longest_name = 0
    do i = 1, size(curves)
      longest_name = max(longest_name, len(curve_name(curves(i), data)))
    end do
  end function longest_name

  !> The name of a curve in the key.
  pure function curve_name(curve, data) result(name)
    type(curve_type), intent(in) :: curve     !< the curve with its two columns
    type(plot_data_type), intent(in) :: data  !< rows and columns that are plotted
    character(len=:), allocatable :: name

    name = data%labels(curve%y)%text
    if (.not. over_time(curve)) name = data%labels(curve%x)%text//':'//name
  end function curve_name

  !> The number of letters that the numbers of an axis take: their digits, and more for numbers like -3.5e-13 or -0.00035.
  pure integer function letters_needed(ends)
    real(wp), intent(in) :: ends(2)  !< least and greatest value on the axis
    real(wp), parameter :: smallest_short = 1e-2_wp, largest_short = 1e6_wp
    integer, parameter :: exponent = 4
    real(wp) :: size

    size = maxval(abs(ends))
    letters_needed = digits_needed(ends)
    if ((size > 0.0_wp .and. size < smallest_short) .or. size >= largest_short) letters_needed = letters_needed + exponent
  end function letters_needed
end module mech9_plot_layout
