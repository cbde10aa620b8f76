!> Requested pictures of the mechanism: a sketch, and a moving picture.
module mech9_picture_requests
  use mech9_program_kind, only: dynamics
  use mech9_error, only: error_type, raise, add_place, exit_usage, exit_data
  use mech9_text, only: string_type
  use mech9_data_file, only: data_file_type
  use mech9_plot_request, only: plot_request_type, take_target
  use mech9_mechanism_pictures, only: mechanism_pictures_type, kind_of_picture, is_moving_kind, moving_endings
  use mech9_command_line, only: command_line_type
  use mech9_written_files, only: result_paths_type, find_result_paths
  implicit none
  private
  public :: picture_requests_type, read_picture_requests

  !> The requested pictures.
  type, extends(mechanism_pictures_type) :: picture_requests_type
  contains
    procedure :: print_words
  end type picture_requests_type

contains

  !> Read the requests of the options, or those of the data file where the options have none. A wrong view and a wrong
  !> ending of a file's name are errors.
  subroutine read_picture_requests(options, given, requests, err)
    type(command_line_type), intent(in) :: options         !< the command line
    type(data_file_type), intent(in) :: given              !< the data file
    type(picture_requests_type), intent(out) :: requests   !< the pictures that are requested
    type(error_type), allocatable, intent(out) :: err      !< allocated if it failed
    type(result_paths_type) :: paths
    type(string_type), allocatable :: plots(:)
    type(plot_request_type) :: plot
    integer :: i, at

    call find_result_paths(options, paths, given)
    requests%sketch = paths%sketch
    requests%animations = paths%animations
    requests%with_masses = given%model%program == dynamics
    call options%arguments('plot', plots)
    if (size(plots) > 0 .and. .not. options%has('optimize')) then
      call take_target(plots(1)%text, plot, at)
      requests%plot = plots(1)%text(at:)
    end if
    if (requests%sketch /= '' .and. kind_of_picture(requests%sketch) /= 'svg') then
      call raise(err, merge(exit_usage, exit_data, options%has('sketch')), "'"//requests%sketch// &
                 "' is no name of a sketch; it must end in .svg")
      if (.not. options%has('sketch')) call add_place(err, place=given%model%request%output%sketch_place)
      return
    end if
    do i = 1, size(requests%animations)
      if (is_moving_kind(requests%animations(i)%text)) cycle
      call raise(err, merge(exit_usage, exit_data, options%has('animate')), "'"//requests%animations(i)%text// &
                 "' is no name of a moving picture; it must end in "//moving_endings)
      if (.not. options%has('animate')) call add_place(err, place=given%model%request%output%animation_place)
      return
    end do
    if (options%has('view')) then
      call requests%take_view(options%argument('view'), exit_usage, err)
    else if (given%model%request%output%view /= '') then
      call requests%take_view(given%model%request%output%view, exit_data, err)
      call add_place(err, place=given%model%request%output%view_place)
    end if
  end subroutine read_picture_requests

  !> Print which pictures were made.
  subroutine print_words(self, unit)
    class(picture_requests_type), intent(in) :: self   !< the picture requests
    integer, intent(in) :: unit                        !< the output unit
    integer :: i

    if (self%sketch /= '') write (unit, '(2a)') 'sketch: ', self%sketch
    do i = 1, size(self%animations)
      write (unit, '(2a)') 'animation: ', self%animations(i)%text
    end do
  end subroutine print_words
end module mech9_picture_requests
