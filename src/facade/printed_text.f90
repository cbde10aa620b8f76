!> Texts that other floors print, as values: they are printed to a scratch file and read back.
module mech9_printed_text
  use mech9_error, only: error_type, raise, exit_file
  implicit none
  private
  public :: begin_text, end_text

contains

  !> Open a unit to print a text to. Fails with exit_file where no scratch file can be made.
  subroutine begin_text(unit, err)
    integer, intent(out) :: unit                        !< to print to
    type(error_type), allocatable, intent(out) :: err   !< allocated if it failed
    character(len=200) :: reason
    integer :: status

    open (newunit=unit, status='scratch', action='readwrite', access='stream', form='formatted', iostat=status, iomsg=reason)
    if (status /= 0) call raise(err, exit_file, 'a scratch file for a text cannot be made: '//trim(reason)// &
                                '; TMPDIR names the folder for such files')
  end subroutine begin_text

  !> Read the text that was printed, and close the unit.
  subroutine end_text(unit, text)
    integer, intent(in) :: unit                          !< the unit of begin_text
    character(len=:), allocatable, intent(out) :: text   !< its lines
    character(len=200) :: piece
    integer :: length, status

    rewind (unit)
    text = ''
    do
      read (unit, '(a)', advance='no', size=length, iostat=status) piece
      if (is_iostat_end(status)) exit
      text = text//piece(:length)
      if (is_iostat_eor(status)) text = text//new_line('a')
    end do
    close (unit)
  end subroutine end_text
end module mech9_printed_text
