!> The work of mech9d for --linear with --at: the linearised equations of motion along a motion.
module mech9_linear_task
  use, intrinsic :: iso_fortran_env, only: error_unit
  use mech9_kinds, only: wp
  use mech9_error, only: error_type, raise, exit_usage
  use mech9_text, only: to_text
  use mech9_counted, only: counted
  use mech9_numeral, only: numeral_type, read_numeral
  use mech9_command_line, only: command_line_type
  use mech9_data_file, only: data_file_type
  use mech9_recorded_linear, only: recorded_linear_motion_type
  use mech9_answer_record, only: save_linear_motion
  use mech9_signal_interruption, only: signal_interruption_type
  implicit none
  private
  public :: work_on_linear_motion

  !> The word that stands for all times of the results.
  character(len=*), parameter :: all_outputs = 'outputs'

contains

  !> Follow the motion, and write the matrices at the times of --at.
  subroutine work_on_linear_motion(options, given)
    type(command_line_type), intent(in) :: options          !< the command line
    type(data_file_type), intent(inout) :: given            !< the data file; it gets the errors
    type(recorded_linear_motion_type) :: found
    type(error_type), allocatable :: err
    real(wp), allocatable :: times(:)

    call given%check_times(.true.)
    if (given%failed()) return
    call read_times(options%argument('at'), times, err)
    if (.not. allocated(err)) call found%find(given, times, err, signal_interruption_type())
    if (.not. allocated(err)) call save_linear_motion(options%argument('linear'), given, found, err)
    if (allocated(err)) then
      call given%fail(err)
    else if (.not. options%has('quiet')) then
      if (given%model%mechanism%title /= '') write (error_unit, '(a)') given%model%mechanism%title
      write (error_unit, '(a)') 'linearised equations of motion at '//counted(size(found%times), 'time')// &
        ' of the motion, from t = '//to_text(found%times(1)%t, 6)//' s to '// &
        to_text(found%times(size(found%times))%t, 6)//' s: '//options%argument('linear')
    end if
  end subroutine work_on_linear_motion

  !> Read the times of --at: numbers with commas, or the word for all results, for which none is listed.
  pure subroutine read_times(text, times, err)
    character(len=*), intent(in) :: text                !< the argument
    real(wp), allocatable, intent(out) :: times(:)      !< [s]
    type(error_type), allocatable, intent(out) :: err   !< allocated where it is something else
    type(numeral_type) :: numeral
    integer :: first, last

    allocate (times(0))
    if (text == all_outputs) return
    first = 1
    do while (first <= len(text) + 1)
      last = index(text(first:)//',', ',') + first - 2
      call read_numeral(trim(adjustl(text(first:last))), numeral)
      if (allocated(numeral%problem)) then
        call raise(err, exit_usage, '--at has times with commas, as 0.1,0.3, or the word '//all_outputs//'; '''//text// &
                   ''' is neither')
        return
      end if
      times = [times, numeral%number]
      first = last + 2
    end do
  end subroutine read_times
end module mech9_linear_task
