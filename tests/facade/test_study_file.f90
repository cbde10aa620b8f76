!> The file of a study: runs that are written are read back, others are not made, and files of other studies are refused.
module test_study_file
  use mech9_kinds, only: wp
  use mech9_error, only: error_type, exit_file
  use mech9_run_maker, only: made_run_type
  use mech9_study_file, only: study_file_type, not_made
  use mech9_study_layout, only: study_layout_type
  use mech9_checks, only: near_vector, has_message
  use mech9_test_files, only: save_lines, remove_file
  use mech9_testing, only: tester_type
  implicit none
  private
  public :: run

  character(len=*), parameter :: path = 'test_study_file.h5'

contains

  !> Run the cases of this suite.
  subroutine run(tester)
    type(tester_type), intent(inout) :: tester   !< selects cases and counts their checks

    if (tester%runs('parts')) call parts(tester)
    if (tester%runs('there_and_back')) call there_and_back(tester)
    if (tester%runs('continued')) call continued(tester)
    if (tester%runs('refusals')) call refusals(tester)
  end subroutine run

  !> A study of two parameters and one quantity.
  subroutine some_layout(runs, part, layout)
    integer, intent(in) :: runs                       !< of the whole study
    integer, intent(in) :: part(2)                    !< number of the part, and how many parts there are
    type(study_layout_type), intent(out) :: layout    !< the layout
    integer :: i

    layout%title = 'Two bars'
    layout%kind = 'grid'
    layout%definition = 'program mech9k'//achar(10)//'&study'//achar(10)
    layout%runs = runs
    layout%part = part
    allocate (layout%parameters(2), layout%parameter_units(2), layout%columns(0))
    allocate (layout%quantities(1), layout%units(1), layout%meanings(1))
    do i = 1, 2
      layout%parameters(i)%text = achar(96 + i)
      layout%parameter_units(i)%text = 'mm'
    end do
    layout%quantities(1)%text = 's'
    layout%units(1)%text = 'm'
    layout%meanings(1)%text = 'max of q4'
  end subroutine some_layout

  subroutine made_run(number, code, made)
    integer, intent(in) :: number               !< of the run
    integer, intent(in) :: code                 !< its exit code
    type(made_run_type), intent(out) :: made    !< the run

    made%number = number
    made%values = [0.5_wp*number, -1.0_wp*number]
    made%quantities = [real(number, wp)**2]
    made%exit_code = code
  end subroutine made_run

  !> Each run is in one part.
  subroutine parts(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(study_layout_type) :: layout
    integer :: runs, n, k, total

    do runs = 0, 7
      do n = 1, 9
        total = 0
        do k = 1, n
          call some_layout(runs, [k, n], layout)
          call tester%is_true(abs(layout%runs_of_part() - real(runs, wp)/n) < 1.0_wp, 'parts are equally large but for one run')
          total = total + layout%runs_of_part()
        end do
        call tester%is_true(total == runs, 'parts have all runs together')
      end do
    end do
  end subroutine parts

  !> Part 2 of 3 of ten runs has the runs 2, 5 and 8. They come out of order, and one does not come.
  subroutine there_and_back(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(study_layout_type) :: layout
    type(study_file_type) :: file
    type(made_run_type) :: made
    type(error_type), allocatable :: err
    real(wp) :: row(4)

    call some_layout(10, [2, 3], layout)
    call file%create(path, layout, err)
    call tester%no_error(err, 'the file is created')
    call file%publish(err)
    call made_run(8, 0, made)
    call file%write_run(3, made, err)
    call made_run(2, 6, made)
    call file%write_run(1, made, err)
    call tester%no_error(err, 'runs are written')
    call file%close(err)
    call tester%no_error(err, 'the file is closed')
    call file%open(path, .false., '', err)
    call tester%no_error(err, 'the file is opened')
    if (allocated(err)) return
    call tester%is_true(file%layout%title == 'Two bars' .and. file%layout%kind == 'grid' .and. file%layout%runs == 10, 'layout')
    call tester%is_true(all(file%layout%part == [2, 3]) .and. file%layout%parameters(2)%text == 'b', 'part and parameters')
    call tester%is_true(file%layout%units(1)%text == 'm' .and. file%layout%meanings(1)%text == 'max of q4', 'quantities')
    call tester%is_true(all([file%code_of(1), file%code_of(2), file%code_of(3)] == [6, not_made, 0]), 'exit codes')
    call file%read_run(3, made)
    call tester%is_true(made%number == 8 .and. made%exit_code == 0, 'the number of a run')
    call near_vector(tester, [made%values, made%quantities], [4.0_wp, -8.0_wp, 64.0_wp], 0.0_wp, 'its numbers')
    call file%read_row(1, row, err)
    call near_vector(tester, row, [1.0_wp, -2.0_wp, 4.0_wp, 6.0_wp], 0.0_wp, 'a row')
    call file%close(err)
    call remove_file(path)
  end subroutine there_and_back

  !> A file that is opened for writing keeps its runs and gets others.
  subroutine continued(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(study_layout_type) :: layout
    type(study_file_type) :: file
    type(made_run_type) :: made
    type(error_type), allocatable :: err
    integer :: i

    call some_layout(1500, [1, 1], layout)
    call file%create(path, layout, err)
    call file%publish(err)
    do i = 1, 700
      call made_run(i, 0, made)
      call file%write_run(i, made, err)
    end do
    call file%close(err)
    call file%open(path, .true., layout%definition, err)
    call tester%no_error(err, 'the file is continued')
    call tester%is_true(file%code_of(700) == 0, 'the last run that was made')
    call tester%is_true(file%code_of(701) == not_made, 'runs that are missing')
    do i = 701, 1500
      call made_run(i, 0, made)
      call file%write_run(i, made, err)
    end do
    call file%close(err)
    call file%open(path, .false., layout%definition, err)
    call tester%no_error(err, 'the file is opened again')
    call tester%is_true(all([(file%code_of(i) == 0, i=1, 1500)]), 'all runs are made')
    call file%read_run(1037, made)
    call near_vector(tester, [made%values, made%quantities], [518.5_wp, -1037.0_wp, 1037.0_wp**2], 0.0_wp, 'a run in the middle')
    call file%close(err)
    call remove_file(path)
  end subroutine continued

  subroutine refusals(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(study_layout_type) :: layout
    type(study_file_type) :: file
    type(error_type), allocatable :: err

    call some_layout(2, [1, 1], layout)
    call file%create(path, layout, err)
    call file%publish(err)
    call file%close(err)
    call file%open(path, .false., 'program mech9d'//achar(10), err)
    call has_message(tester, err, exit_file, "it is of another study: there 'program mech9k', here 'program mech9d'", 'another one')
    call remove_file(path)
    call save_lines(tester, path, ['no file of HDF5'])
    call file%open(path, .false., '', err)
    call tester%has_error(err, exit_file, 'a file of another kind')
    call remove_file(path)
    call file%open(path, .false., '', err)
    call tester%has_error(err, exit_file, 'a file that is not there')
    call tester%is_true(.not. file%is_open(), 'it is not open')
  end subroutine refusals
end module test_study_file
