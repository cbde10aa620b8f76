!> The panels of a plot: the groups of curves that share axes, and the labels of the axes.
module mech9_plot_panels
  use mech9_text, only: string_type
  use mech9_plot_request, only: curve_type
  implicit none
  private
  public :: panels_of, axis_label, over_time

contains

  !> The number of the panel of each curve, from 1 in the order of their first curves. Curves with the same unit upwards
  !> share a panel if they are over the same column. They share it too if they are over columns of the same unit other
  !> than the time. The closure, a length near zero, stands alone.
  pure function panels_of(curves, names, units) result(panels)
    type(curve_type), intent(in) :: curves(:)  !< the curves, each with its two columns
    type(string_type), intent(in) :: names(:)  !< names of all columns of the results
    type(string_type), intent(in) :: units(:)  !< units of all columns of the results
    integer :: panels(size(curves))
    integer :: i, j, last

    panels = 0
    last = 0
    do i = 1, size(curves)
      do j = 1, i - 1
        if (units(curves(i)%y)%text /= units(curves(j)%y)%text) cycle
        if ((names(curves(i)%y)%text == 'closure') .neqv. (names(curves(j)%y)%text == 'closure')) cycle
        if (curves(i)%x /= curves(j)%x) then
          if (any([over_time(curves(i)), over_time(curves(j))])) cycle
          if (units(curves(i)%x)%text /= units(curves(j)%x)%text) cycle
        end if
        panels(i) = panels(j)
        exit
      end do
      if (panels(i) > 0) cycle
      last = last + 1
      panels(i) = last
    end do
  end function panels_of

  !> Whether a curve is drawn over the time, the first column.
  pure elemental logical function over_time(curve)
    type(curve_type), intent(in) :: curve  !< the curve with its two columns

    over_time = curve%x == 1
  end function over_time

  !> The label of an axis: the name of its column if there is only one, otherwise the quantity that its unit measures.
  pure function axis_label(columns, names, units) result(label)
    integer, intent(in) :: columns(:)          !< numbers of the columns on the axis, all of one unit
    type(string_type), intent(in) :: names(:)  !< names of all columns of the results
    type(string_type), intent(in) :: units(:)  !< units of all columns of the results
    character(len=:), allocatable :: label

    if (all(columns == columns(1))) then
      label = names(columns(1))%text
    else
      label = quantity(units(columns(1))%text)
    end if
    if (units(columns(1))%text /= '1' .and. units(columns(1))%text /= '') &
      label = trim(label//' ['//written(units(columns(1))%text)//']')
  end function axis_label

  !> The quantity that has a given unit in the results.
  pure function quantity(unit)
    character(len=*), intent(in) :: unit  !< the unit as the results name it
    character(len=:), allocatable :: quantity

    select case (unit)
    case ('rad', 'deg')
      quantity = 'angle'
    case ('rad/s', 'deg/s', 'rpm')
      quantity = 'angular velocity'
    case ('rad/s^2', 'deg/s^2')
      quantity = 'angular acceleration'
    case ('m', 'mm', 'in')
      quantity = 'position'
    case ('m/s', 'mm/s', 'in/s')
      quantity = 'velocity'
    case ('m/s^2', 'mm/s^2', 'in/s^2')
      quantity = 'acceleration'
    case ('J')
      quantity = 'energy'
    case default
      quantity = ''
    end select
  end function quantity

  !> A unit as it is written by hand, with a raised two.
  pure function written(unit)
    character(len=*), intent(in) :: unit  !< the unit as the results name it
    character(len=:), allocatable :: written
    character(len=*), parameter :: raised_two = char(194)//char(178)   ! in UTF-8
    integer :: i

    written = unit
    i = index(unit, '^2')
    if (i > 0) written = unit(:i - 1)//raised_two//unit(i + 2:)
  end function written
end module mech9_plot_panels
