!> The style of all plots: colours and lines, the size and the title of a picture, the numbers of axes.
module mech9_plot_style
  use mech9_kinds, only: wp
  use mech9_text, only: string_type, to_text
  use mech9_path, only: ending_of
  use mech9_gnuplot, only: quoted
  use mech9_title_lines, only: title_lines
  implicit none
  private
  public :: plot_style, picture_terminal, picture_title, axis_format, digits_needed, first_colour, second_colour

  character, parameter :: line_end = achar(10)
  !> Colours that people with any kind of colour vision can distinguish (Okabe and Ito), the dark ones first; they
  !> differ in grey as well.
  character(len=7), parameter :: colours(7) = &
    ['#0072b2', '#d55e00', '#009e73', '#cc79a7', '#e69f00', '#56b4e9', '#000000']
  character(len=*), parameter :: first_colour = '#0072b2', second_colour = '#d55e00'
  !> A space without width in UTF-8.
  character(len=*), parameter :: thin_space = char(226)//char(128)//char(139)

contains

  !> The commands that all pictures have in common.
  pure function plot_style() result(text)
    character(len=:), allocatable :: text
    integer :: i

    text = 'set border 3 lc rgb ''#606060'''//line_end//'set tics nomirror out'//line_end// &
           'set grid lc rgb ''#cccccc'' lw 0.8 dt 1'//line_end// &
           'set key outside right top Left reverse samplen 1.5'//line_end
    do i = 1, size(colours)
      text = text//'set linetype '//to_text(i)//' lw 2 pt 7 ps 0.4 lc rgb '''//colours(i)//''''//line_end
    end do
    text = text//'set linetype cycle '//to_text(size(colours))//line_end
  end function plot_style

  !> The terminal of gnuplot for the ending of a picture, with the size of the picture.
  pure function picture_terminal(picture, width, height) result(text)
    character(len=*), intent(in) :: picture    !< name of the file of the picture
    integer, intent(in) :: width               !< width of the picture [px]
    integer, intent(in) :: height              !< height of the picture [px]
    character(len=:), allocatable :: text

    select case (ending_of(picture))
    case ('png')
      text = 'set terminal pngcairo noenhanced font ''Sans,12'' size '//to_text(width)//','//to_text(height)
    case ('pdf')
      text = 'set terminal pdfcairo noenhanced font ''Sans,12'' size '//to_text(width/96.0_wp, 4)//'in,'// &
             to_text(height/96.0_wp, 4)//'in'
    case default
      text = 'set terminal svg noenhanced font ''sans-serif,15'' background ''#ffffff'' size '//to_text(width)//','// &
             to_text(height)
    end select
  end function picture_terminal

  !> The title in lines that fit above the plot. In an SVG `]]>` must not stand, which gnuplot would copy; a space
  !> without width is therefore put into it.
  pure function picture_title(title, picture, width) result(lines)
    character(len=*), intent(in) :: title      !< title of the mechanism
    character(len=*), intent(in) :: picture    !< name of the file of the picture
    integer, intent(in) :: width               !< width of the picture [px]
    type(string_type), allocatable :: lines(:)
    integer, parameter :: letter = 10, most = 3
    integer :: i, at

    lines = title_lines(title, width/letter, most)
    if (ending_of(picture) /= 'svg') return
    do i = 1, size(lines)
      do
        at = index(lines(i)%text, ']]>')
        if (at == 0) exit
        lines(i)%text = lines(i)%text(:at + 1)//thin_space//lines(i)%text(at + 2:)
      end do
    end do
  end function picture_title

  !> The format in which gnuplot writes the numbers of an axis.
  pure function axis_format(ends) result(text)
    real(wp), intent(in) :: ends(2)  !< least and greatest value on the axis
    character(len=:), allocatable :: text

    text = quoted('%.'//to_text(digits_needed(ends))//'g')
  end function axis_format

  !> The number of digits by which neighbouring marks of an axis differ, at least six.
  pure integer function digits_needed(ends)
    real(wp), intent(in) :: ends(2)  !< least and greatest value on the axis
    real(wp) :: size, span

    digits_needed = 6
    size = maxval(abs(ends))
    span = ends(2) - ends(1)
    if (span > epsilon(span)*size) digits_needed = max(6, min(15, 2 + ceiling(log10(size/span))))
  end function digits_needed
end module mech9_plot_style
