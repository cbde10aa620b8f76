!> Descriptions of HDF5 files for ParaView show the rows at their times.
module test_xdmf
  use mech9_program_kind, only: kinematics
  use mech9_kinds, only: wp
  use mech9_error, only: error_type
  use mech9_model, only: model_type
  use mech9_poses, only: poses_type, poses_of
  use mech9_xdmf, only: xdmf_type, new_xdmf, xdmf_path
  use mech9_small_models, only: slider_crank, eol
  use mech9_text_models, only: model_from_text
  use mech9_test_files, only: remove_file, text_of_file, count_of
  use mech9_testing, only: tester_type
  implicit none
  private
  public :: run

  character(len=*), parameter :: title = 'a <b> & c'

contains

  !> Run the cases of this suite.
  subroutine run(tester)
    type(tester_type), intent(inout) :: tester   !< selects cases and counts their checks

    if (tester%runs('grids')) call grids(tester)
  end subroutine run

  !> One grid for each row, with its time; of many rows every second or third one.
  subroutine grids(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(model_type) :: model

    call model_from_text(tester, slider_crank//"&drive coordinate=1, kind='polynomial', coefficients=0, 1 /"//eol, &
                         kinematics, model)
    call tester%is_true(xdmf_path('d/a.h5') == 'd/a.xdmf', 'the file stands beside the other one')
    call describe(3, 3)
    call describe(2000, 2000)
    call describe(2001, 1001)
  contains
    subroutine describe(rows, shown)
      integer, intent(in) :: rows    !< of the results
      integer, intent(in) :: shown   !< how many of them are shown
      type(xdmf_type) :: sink
      type(poses_type) :: poses
      type(error_type), allocatable :: err
      character(len=:), allocatable :: text
      real(wp), allocatable :: numbers(:, :)
      integer :: i

      poses = poses_of(model%mechanism)
      sink = new_xdmf('test_xdmf.h5', title, [(2.0_wp + 2.0_wp*i/(rows - 1), i=0, rows - 1)], size(poses%vertex_link), &
                      size(poses%lines, 2))
      allocate (numbers(1, rows), source=0.0_wp)
      call sink%write_rows(numbers, err)
      call sink%close(err)
      call tester%no_error(err, 'a description')
      call text_of_file(tester, 'test_xdmf.xdmf', text)
      call tester%is_true(count_of('<Grid', text) == shown + 1 .and. count_of('</Grid>', text) == shown + 1, 'a grid for each row')
      call tester%is_true(index(text, '<Time Value="2"/>') > 0, 'the first time')
      if (shown == rows) call tester%is_true(index(text, '<Time Value="4"/>') > 0, 'the last time')
      call tester%is_true(index(text, 'test_xdmf.h5:/vertex') > 0 .and. index(text, 'a &lt;b&gt;') > 0, 'data set and title')
      call remove_file('test_xdmf.xdmf')
    end subroutine describe
  end subroutine grids
end module test_xdmf
