!> The drawing of a plot by gnuplot, as a picture with its script beside it, or in the terminal.
module mech9_plot_drawing
  use, intrinsic :: iso_fortran_env, only: output_unit
  use mech9_error, only: error_type, raise, add_place, exit_file
  use mech9_path, only: folder_of, name_of, with_ending
  use mech9_text_file, only: save_text
  use mech9_gnuplot, only: run_gnuplot, gnuplot_package
  implicit none
  private
  public :: draw_picture, draw_in_terminal, script_of_plot

  character(len=*), parameter :: script_ending = 'gp'

contains

  !> Write the script of a picture, and let gnuplot draw the picture. Where gnuplot is not installed, keep the script
  !> all the same.
  subroutine draw_picture(picture, script, said, is_lacking, err)
    character(len=*), intent(in) :: picture              !< file of the picture
    character(len=*), intent(in) :: script               !< commands of gnuplot
    character(len=:), allocatable, intent(out) :: said   !< a line for the user
    logical, intent(out) :: is_lacking                   !< gnuplot is not here
    type(error_type), allocatable, intent(out) :: err    !< allocated if it failed
    character(len=:), allocatable :: script_path, folder
    logical :: found

    said = ''
    is_lacking = .false.
    script_path = script_of_plot(picture)
    folder = folder_of(picture)
    call save_text(script_path, script, err)
    call add_place(err, 'no plot '//picture//', and no whole script of it')
    if (allocated(err)) return
    if (folder == '') folder = '.'
    call run_gnuplot(script, found, err, folder, picture)
    call add_place(err, 'no plot '//picture)
    if (allocated(err)) return
    is_lacking = .not. found
    if (found) then
      said = 'plot: '//picture//', drawn by '//script_path
    else
      said = 'plot: gnuplot is not here; install '//gnuplot_package//' and run: gnuplot '//name_of(script_path)
      if (folder /= '.') said = said//' in '//folder
    end if
  end subroutine draw_picture

  !> Draw the plot in the terminal.
  subroutine draw_in_terminal(script, err)
    character(len=*), intent(in) :: script             !< commands of gnuplot
    type(error_type), allocatable, intent(out) :: err  !< allocated if it failed
    logical :: found

    ! gnuplot writes to the same standard output, so that earlier output must come before
    flush (output_unit)
    call run_gnuplot(script, found, err)
    if (.not. allocated(err) .and. .not. found) &
      call raise(err, exit_file, 'the terminal plot is drawn by gnuplot, which is not here; install '//gnuplot_package)
    call add_place(err, 'no plot in the terminal')
  end subroutine draw_in_terminal

  !> The file of the script that draws a picture; it stands beside the picture.
  pure function script_of_plot(picture) result(script)
    character(len=*), intent(in) :: picture  !< file of the picture
    character(len=:), allocatable :: script

    script = with_ending(picture, script_ending)
  end function script_of_plot
end module mech9_plot_drawing
