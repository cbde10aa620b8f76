!> The check that no file to be written is a file of the input or another result, before any file is changed.
module mech9_overwriting
  use mech9_error, only: error_type, raise, exit_usage
  use mech9_text, only: string_type
  use mech9_same_file, only: file_place_type, find_place, find_open_place, same_place, is_fifo
  use mech9_data_file, only: data_file_type
  use mech9_command_line, only: command_line_type
  use mech9_written_files, only: written_file_type, list_written_files, standard_output_path
  implicit none
  private
  public :: refuse_overwriting

  integer, parameter :: standard_output = 1     !< its descriptor

contains

  !> Fail with exit_usage where a file of the input, or another result, would be written over.
  subroutine refuse_overwriting(options, inputs, err, given)
    type(command_line_type), intent(in) :: options               !< the command line
    type(string_type), intent(in) :: inputs(:)                   !< paths of the files that are read
    type(error_type), allocatable, intent(out) :: err            !< allocated if it failed
    class(data_file_type), intent(in), optional :: given         !< the data file, once it is understood
    type(written_file_type), allocatable :: files(:)
    type(file_place_type), allocatable :: places(:)
    integer :: i

    call list_written_files(options, files, given)
    allocate (places(size(files)))
    do i = 1, size(files)
      if (files(i)%path == standard_output_path) then
        call find_open_place(standard_output, places(i))
      else
        call find_place(files(i)%path, places(i))
      end if
      call refuse_input(files(i), places(i), inputs, err)
      if (allocated(err)) return
      call refuse_output(files(:i), places(:i), err)
      if (allocated(err)) return
    end do
  end subroutine refuse_overwriting

  !> Fail if a file is one of those that are read. A file that does not exist cannot be lost.
  subroutine refuse_input(file, place, inputs, err)
    type(written_file_type), intent(in) :: file         !< the file to be written
    type(file_place_type), intent(in) :: place          !< the place that its name means
    type(string_type), intent(in) :: inputs(:)          !< names of the files that are read
    type(error_type), allocatable, intent(out) :: err   !< allocated if it failed
    type(file_place_type) :: input
    integer :: i

    do i = 1, size(inputs)
      call find_place(inputs(i)%text, input)
      if (.not. (input%exists .and. same_place(place, input))) cycle
      call raise(err, exit_usage, words_for(file)//" would overwrite '"//inputs(i)%text// &
                 "', which is read; give it another name")
      return
    end do
  end subroutine refuse_input

  !> Fail if the last file of a list is one of those before it.
  subroutine refuse_output(files, places, err)
    type(written_file_type), intent(in) :: files(:)     !< files that are going to be written
    type(file_place_type), intent(in) :: places(:)      !< the places that their names mean
    type(error_type), allocatable, intent(out) :: err   !< allocated if it failed
    integer :: i, last

    last = size(files)
    do i = 1, last - 1
      if (.not. same_place(places(i), places(last)) .or. follow_each_other(files(i), files(last), places(i))) cycle
      if (files(i)%path == files(last)%path) then
        call raise(err, exit_usage, files(i)%what//' and '//files(last)%what//" cannot both be '"//files(i)%path//"'")
      else
        call raise(err, exit_usage, words_for(files(i))//' and '//words_for(files(last))// &
                   ' are one file; give one of them another name')
      end if
      return
    end do
  end subroutine refuse_output

  !> Whether two results of one place are written one after the other. They are on standard output itself; or in a pipe,
  !> which loses nothing, if one of them is written to standard output. There are two arguments because a list of them,
  !> made for the call, would leak (gfortran 12).
  pure logical function follow_each_other(first, second, place)
    type(written_file_type), intent(in) :: first    !< the result that is named first
    type(written_file_type), intent(in) :: second   !< the other result
    type(file_place_type), intent(in) :: place      !< the place of both
    logical :: on_standard_output(2)

    on_standard_output = [first%path == standard_output_path, second%path == standard_output_path]
    follow_each_other = all(on_standard_output) .or. (is_fifo(place) .and. any(on_standard_output))
  end function follow_each_other

  !> A file in a message.
  pure function words_for(file) result(words)
    type(written_file_type), intent(in) :: file   !< the file to be written
    character(len=:), allocatable :: words

    words = file%what//" '"//file%path//"'"
    if (file%path == standard_output_path) words = file%what//' on standard output'
  end function words_for
end module mech9_overwriting
