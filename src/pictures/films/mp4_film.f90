!> A film as an MP4 video. gnuplot draws the frames as PNG images, one after the other in a file, and ffmpeg makes the video of them.
module mech9_mp4_film
  use mech9_kinds, only: wp
  use mech9_error, only: error_type, raise, add_place, exit_file
  use mech9_text, only: string_type
  use mech9_printable, only: printable
  use mech9_child_process, only: child_outcome_type, run_child
  use mech9_film, only: film_type
  use mech9_film_clock, only: clock_decimals
  use mech9_projection, only: projection_type
  use mech9_scene, only: scene_type
  use mech9_svg_film, only: duration_of
  use mech9_gif_film, only: script_type, begin_script, put_frame
  use mech9_gnuplot, only: run_gnuplot, gnuplot_package
  use mech9_xml_text, only: decimal
  implicit none
  private
  public :: save_mp4_film, frames_of_video

  !> The number of dots for each px of other pictures.
  real(wp), parameter :: zoom = 1.5_wp
  !> Fewest frames of a video: players show no shorter ones.
  integer, parameter :: fewest = 2
  !> The package of ffmpeg, for messages.
  character(len=*), parameter :: ffmpeg_package = 'ffmpeg (Debian: apt-get install ffmpeg)'
  !> The remedy without these programs.
  character(len=*), parameter :: other_endings = ', or let the name end in .html or .svg'

contains

  !> Make the video. Errors are exit_file, also if gnuplot or ffmpeg is not installed.
  subroutine save_mp4_film(path, title, scene, film, projection, err)
    character(len=*), intent(in) :: path               !< name of the file
    character(len=*), intent(in) :: title              !< title of the mechanism, any text
    type(scene_type), intent(in) :: scene              !< nodes and items of the picture
    type(film_type), intent(in) :: film                !< poses and values at the outputs of the run
    type(projection_type), intent(in) :: projection    !< from space to the page
    type(error_type), allocatable, intent(out) :: err  !< allocated if it failed
    type(script_type) :: script
    logical :: found
    integer :: i, decimals

    call look_for_ffmpeg(err)
    if (.not. allocated(err)) then
      call begin_script('pngcairo', zoom, frames_of_video(path), projection, script)
      decimals = clock_decimals(film)
      do i = 1, max(film%n_frames, fewest)
        call put_frame(title, scene, film, projection, min(i, film%n_frames), decimals, script)
      end do
      call script%page%line('unset output')
      call run_gnuplot(script%page%text(), found, err, picture=frames_of_video(path))
      if (.not. allocated(err) .and. .not. found) &
        call raise(err, exit_file, 'the frames of an MP4 are drawn by gnuplot, which is not here; install '//gnuplot_package// &
                   other_endings)
      if (.not. allocated(err)) call encode(path, max(film%n_frames, fewest)/duration_of(film), err)
      call remove(frames_of_video(path))
    end if
    call add_place(err, 'no moving picture '//path)
  end subroutine save_mp4_film

  !> The file that holds the frames while the video is made.
  pure function frames_of_video(path) result(frames)
    character(len=*), intent(in) :: path  !< of the video
    character(len=:), allocatable :: frames

    frames = path//'.frames.png'
  end function frames_of_video

  !> Fail where ffmpeg is not installed, before the frames are drawn.
  subroutine look_for_ffmpeg(err)
    type(error_type), allocatable, intent(out) :: err  !< allocated if it is not there
    type(child_outcome_type) :: outcome
    type(string_type) :: words(2)

    words(1)%text = 'ffmpeg'
    words(2)%text = '-version'
    call run_child(words, '', outcome, err, drop_output=.true.)
    if (.not. allocated(err) .and. .not. outcome%found) &
      call raise(err, exit_file, 'an MP4 is made by ffmpeg, which is not here; install '//ffmpeg_package//other_endings)
  end subroutine look_for_ffmpeg

  !> Let ffmpeg make the video of the frames. Most players need an even number of dots along both sides.
  subroutine encode(path, rate, err)
    character(len=*), intent(in) :: path               !< of the video
    real(wp), intent(in) :: rate                       !< frames in a second
    type(error_type), allocatable, intent(out) :: err  !< allocated if it failed
    character(len=*), parameter :: even = 'pad=ceil(iw/2)*2:ceil(ih/2)*2:color=white', file = 'file:'
    type(child_outcome_type) :: outcome
    type(string_type), allocatable :: words(:)

    ! a name with a colon would be taken for a protocol
    words = [string_type('ffmpeg'), string_type('-nostdin'), string_type('-loglevel'), string_type('error'), string_type('-y'), &
             string_type('-f'), string_type('image2pipe'), string_type('-c:v'), string_type('png'), &
             string_type('-framerate'), string_type(decimal(rate)), string_type('-i'), string_type(file//frames_of_video(path)), &
             string_type('-vf'), string_type(even), string_type('-pix_fmt'), string_type('yuv420p'), &
             string_type('-movflags'), string_type('+faststart'), string_type('-f'), string_type('mp4'), string_type(file//path)]
    call run_child(words, '', outcome, err, drop_output=.true.)
    if (.not. allocated(err) .and. outcome%code /= 0) &
      call raise(err, exit_file, 'ffmpeg failed: '//trim(printable(outcome%error_output)))
  end subroutine encode

  !> Remove a file, if it is there.
  subroutine remove(path)
    character(len=*), intent(in) :: path  !< name of the file
    integer :: unit, status

    open (newunit=unit, file=path, status='old', iostat=status)
    if (status == 0) close (unit, status='delete', iostat=status)
  end subroutine remove
end module mech9_mp4_film
