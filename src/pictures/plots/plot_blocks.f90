!> Parts of the scripts of gnuplot for pictures with several panels: blocks of numbers, and the places of the panels.
module mech9_plot_blocks
  use mech9_kinds, only: wp
  use mech9_number_format, only: number_format_type, number_width
  implicit none
  private
  public :: block_of, find_layout

  character, parameter :: line_end = achar(10)
  character(len=*), parameter :: data_end = 'end_of_data'
  !> Sides of a picture with one panel, and of each panel of several [px].
  integer, parameter :: single(2) = [800, 540], one_of_many(2) = [560, 400]

contains

  !> Compute the places of the panels and the size of the picture.
  pure subroutine find_layout(panels, across, down, width, height)
    integer, intent(in) :: panels    !< how many there are
    integer, intent(out) :: across   !< panels in a row
    integer, intent(out) :: down     !< rows
    integer, intent(out) :: width    !< of the picture [px]
    integer, intent(out) :: height   !< of the picture [px]

    across = min(panels, 1 + merge(1, 0, panels > 1) + merge(1, 0, panels > 4))
    down = (panels + across - 1)/across
    width = merge(single(1), across*one_of_many(1), panels == 1)
    height = merge(single(2), 40 + down*one_of_many(2), panels == 1)
  end subroutine find_layout

  !> Numbers as a block of data of a script.
  pure function block_of(name, numbers) result(text)
    character(len=*), intent(in) :: name          !< of the block
    real(wp), intent(in) :: numbers(:, :)         !< (lines,numbers of a line)
    character(len=:), allocatable :: text, lines
    type(number_format_type) :: format
    integer :: i, j, at

    format = number_format_type()
    allocate (character(len=size(numbers, 1)*(size(numbers, 2)*number_width + 1)) :: lines)
    at = 0
    do j = 1, size(numbers, 1)
      do i = 1, size(numbers, 2)
        call format%put(numbers(j, i), lines(at + 1:at + number_width))
        at = at + number_width
      end do
      at = at + 1
      lines(at:at) = line_end
    end do
    text = name//' << '//data_end//line_end//lines//data_end//line_end
  end function block_of
end module mech9_plot_blocks
