!> Runs of a study: handed out, taken in any order, made in threads, kept in files, continued and merged. The quantity is the place
!> of the slider of a stretched slider-crank, which is the sum of the two lengths.
module test_study_runs
  use mech9_program_kind, only: kinematics
  use mech9_kinds, only: wp
  use mech9_command_line, only: command_line_type
  use mech9_design_run, only: find_quantities
  use mech9_error, only: error_type, exit_done, exit_usage
  use mech9_data_file, only: data_file_type
  use mech9_run_evaluator, only: used_quantities
  use mech9_run_maker, only: run_maker_type, made_run_type
  use mech9_signal_interruption, only: signal_interruption_type
  use mech9_study_file, only: study_file_type
  use mech9_part_merge, only: merge_parts
  use mech9_written_files, only: find_kept_files
  use mech9_study_propagation, only: propagation_type, propagate
  use mech9_kept_files, only: kept_files_type
  use mech9_study_results, only: study_results_type
  use mech9_study_runs, only: study_runs_type, all_handed_out, wait_for_others
  use mech9_study_threads, only: make_in_threads, threads_of_machine
  use mech9_study_words, only: print_study
  use mech9_checks, only: near_vector
  use mech9_small_models, only: slider_crank, eol
  use mech9_text_models, only: document_from_text, model_from_text
  use mech9_test_files, only: remove_file, text_of_file, text_of_unit
  use mech9_testing, only: tester_type
  use option_words, only: options_of
  implicit none
  private
  public :: run

  character(len=*), parameter :: stem = 'test_study_runs'
  character(len=*), parameter :: grid = slider_crank//"&drive coordinate=1, kind='polynomial', coefficients=0, 1 /"//eol// &
    "&time end=0.5, intervals=1 /"//eol// &
    "&parameter name='r', value=0.3, low=0.1, high=0.3, count=3, sets='pair(2).point(1)' /"//eol// &
    "&parameter name='l', value=1, low=1, high=2, count=2, sets='pair(3).point(1)' /"//eol// &
    "&quantity name='x', of='q4', take='start' /"//eol//"&study kind='grid' /"//eol
  real(wp), parameter :: tol = 1.0e-12_wp   ! chains are closed to round-off

  !> All that the runs of a study need.
  type :: study_case_type
    type(data_file_type) :: given
  end type study_case_type

contains

  !> Run the cases of this suite.
  subroutine run(tester)
    type(tester_type), intent(inout) :: tester   !< selects cases and counts their checks

    if (tester%runs('makers')) call makers(tester)
    if (tester%runs('order')) call order(tester)
    if (tester%runs('threads')) call threads(tester)
    if (tester%runs('parts')) call parts(tester)
    if (tester%runs('propagation')) call propagation(tester)
  end subroutine run

  subroutine prepare(tester, text, this)
    type(tester_type), intent(inout) :: tester       !< counts the checks
    character(len=*), intent(in) :: text             !< of the data file
    type(study_case_type), intent(out) :: this       !< its study
    type(error_type), allocatable :: err
    integer :: number

    call document_from_text(tester, text, this%given%document)
    call model_from_text(tester, text, kinematics, this%given%model)
    call this%given%diagnostics%add_source(this%given%document%source, number)
    call this%given%prepare_variable()
    call find_quantities(this%given%model, this%given%quantities, err)
    call tester%no_error(err, 'quantities of the study')
  end subroutine prepare

  !> Open the results of a command line, and begin its runs.
  subroutine begin(tester, this, line, ahead, results, runs)
    type(tester_type), intent(inout) :: tester        !< counts the checks
    type(study_case_type), intent(in) :: this         !< the study
    character(len=*), intent(in) :: line              !< command line
    integer, intent(in) :: ahead                      !< runs that may be handed out before the first of them is written
    type(study_results_type), intent(out), target :: results   !< open; they must outlive the runs
    type(study_runs_type), intent(out) :: runs        !< about to begin
    type(signal_interruption_type) :: interruption
    type(command_line_type) :: options
    type(kept_files_type) :: wanted
    type(error_type), allocatable :: err

    call options_of(tester, line, options)
    call find_kept_files(options, this%given, wanted)
    call results%open(wanted, this%given, err)
    call tester%no_error(err, 'results of '//line)
    call runs%begin(this%given%model, results, ahead, .false., interruption)
  end subroutine begin

  !> The last parameter changes from run to run; each run has the sum of its lengths.
  subroutine makers(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(study_case_type) :: this
    type(run_maker_type) :: maker
    type(made_run_type) :: made
    integer :: i

    call prepare(tester, grid, this)
    call tester%is_true(this%given%model%is_driven() .and. size(used_quantities(this%given%model)) == 0, 'a driven study')
    call maker%begin(this%given%model, this%given%variable)
    do i = 6, 1, -1
      call maker%make(i, made)
      call tester%is_true(made%number == i .and. made%exit_code == exit_done, 'a run that went to its end')
      call near_vector(tester, made%values, [0.1_wp*(1 + (i - 1)/2), 1.0_wp + mod(i - 1, 2)], 1.0e-15_wp, 'its values')
      call near_vector(tester, made%quantities, [sum(made%values)], tol, 'its quantity')
    end do
  end subroutine makers

  !> Runs are taken in any order; no more are handed out ahead than is agreed, and each one once.
  subroutine order(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(study_case_type) :: this
    type(study_results_type), target :: results
    type(study_runs_type) :: runs
    type(run_maker_type) :: maker
    type(made_run_type) :: made(6)
    type(error_type), allocatable :: err
    character(len=:), allocatable :: text
    real(wp) :: row(4)
    integer :: numbers(6), i, unit, at, status

    call prepare(tester, grid, this)
    call begin(tester, this, 'a.nml --study --table '//stem//'.dat', 3, results, runs)
    call maker%begin(this%given%model, this%given%variable)
    do i = 1, 6
      call maker%make(i, made(i))
    end do
    do i = 1, 3
      numbers(i) = runs%hand_out()
    end do
    call tester%is_true(all(numbers(:3) == [1, 2, 3]), 'the first three')
    call tester%is_true(runs%hand_out() == wait_for_others, 'no more before the first one is back')
    call runs%take(made(3))
    call runs%take(made(2))
    call tester%is_true(runs%hand_out() == wait_for_others, 'later ones do not count')
    call runs%take(made(1))
    do i = 4, 6
      numbers(i) = runs%hand_out()
    end do
    call tester%is_true(all(numbers(4:) == [4, 5, 6]), 'the others')
    call tester%is_true(runs%hand_out() == all_handed_out, 'and no more')
    do i = 6, 4, -1
      call runs%take(made(i))
    end do
    call tester%is_true(runs%sums%done == 6 .and. runs%values%done == 6, 'all are added up')
    call near_vector(tester, [runs%sums%mean, runs%sums%low, runs%sums%high], [1.7_wp, 1.1_wp, 2.3_wp], tol, 'mean and range')
    call runs%finish(err)
    call tester%no_error(err, 'the study ends')
    call text_of_file(tester, stem//'.dat', text)
    at = index(text, 'exit_code'//eol) + len('exit_code')
    row = 0.0_wp
    do i = 1, 6
      read (text(at + 1:), *, iostat=status) row
      call tester%is_true(status == 0 .and. nint(row(1)) == i, 'a row for each run, in order')
      if (status == 0) call tester%near(row(4), row(2) + row(3), tol, 'its numbers')
      at = at + index(text(at + 1:), eol)
    end do
    call remove_file(stem//'.dat')
    open (newunit=unit, file=stem//'.txt')
    call print_study(unit, this%given%model, this%given%quantities, runs, [propagation_type ::], 1.5_wp)
    call text_of_unit(tester, unit, text)
    call tester%is_true(index(text, '6 runs: 1.5 s'//eol) == 1 .and. index(text, 'x: 1.1 to 2.3 m'//eol) > 0, 'words: '//text)
  end subroutine order

  !> Any number of threads gives the same table.
  subroutine threads(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(study_case_type) :: this
    character(len=:), allocatable :: one, three

    call prepare(tester, grid, this)
    call make(1, one)
    call make(3, three)
    call tester%is_true(one == three .and. len(one) > 0, 'tables of one thread and of three')
    call tester%is_true(threads_of_machine() >= 1, 'a machine has a thread')
  contains
    subroutine make(n, text)
      integer, intent(in) :: n                             !< threads
      character(len=:), allocatable, intent(out) :: text   !< the table
      type(study_results_type), target :: results
      type(study_runs_type) :: runs
      type(signal_interruption_type) :: interruption
      type(error_type), allocatable :: err

      call begin(tester, this, 'a.nml --study --table '//stem//'.dat', 2*n, results, runs)
      call make_in_threads(this%given%model, this%given%variable, n, interruption, runs)
      call runs%finish(err)
      call tester%no_error(err, 'a study in threads')
      call text_of_file(tester, stem//'.dat', text)
      call remove_file(stem//'.dat')
    end subroutine make
  end subroutine threads

  !> Files of two parts are merged to one that has all runs; one part alone has gaps.
  subroutine parts(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(study_case_type) :: this
    type(study_results_type), target :: of_first, of_second
    type(study_runs_type) :: first, second
    type(signal_interruption_type) :: interruption
    type(study_file_type) :: file
    type(command_line_type) :: options
    type(error_type), allocatable :: err
    real(wp) :: row(4)
    integer :: i, code

    call prepare(tester, grid, this)
    call begin(tester, this, 'a.nml --study --part 1/2 --hdf5 '//stem//'_1.h5', 2, of_first, first)
    call make_in_threads(this%given%model, this%given%variable, 1, interruption, first)
    call first%finish(err)
    call begin(tester, this, 'a.nml --study --part 2/2 --hdf5 '//stem//'_2.h5', 2, of_second, second)
    call make_in_threads(this%given%model, this%given%variable, 1, interruption, second)
    call second%finish(err)
    call tester%is_true(first%sums%done == 3 .and. second%sums%done == 3, 'three runs each')
    call options_of(tester, '--merge '//stem//'_1.h5 '//stem//'_2.h5 --hdf5 '//stem//'.h5 --quiet', options)
    call merge_parts(options, code)
    call tester%is_true(code == exit_done, 'parts are merged')
    call file%open(stem//'.h5', .false., '', err)
    call tester%no_error(err, 'the merged file is opened')
    if (.not. allocated(err)) then
      do i = 1, 6
        call file%read_row(i, row, err)
        call near_vector(tester, row(3:), [row(1) + row(2), 0.0_wp], tol, 'each run has the sum of its lengths')
        call tester%near(row(2), 1.0_wp + mod(i - 1, 2), tol, 'in the order of the study')
      end do
      call file%close(err)
    end if
    call options_of(tester, '--merge '//stem//'_1.h5 '//stem//'_2.h5 --hdf5 '//stem//'_2.h5 --quiet', options)
    call merge_parts(options, code)
    call tester%is_true(code == exit_usage, 'a part is not written over')
    call remove_file(stem//'.h5')
    call remove_file(stem//'_1.h5')
    call remove_file(stem//'_2.h5')
  end subroutine parts

  !> x = r + l has derivatives of one; the variance is the sum of those of r and l.
  subroutine propagation(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(study_case_type) :: this
    type(propagation_type), allocatable :: found(:)
    type(signal_interruption_type), target :: interruption
    type(error_type), allocatable :: err

    call prepare(tester, slider_crank//"&drive coordinate=1, kind='polynomial', coefficients=0, 1 /"//eol// &
      "&time end=0.5, intervals=1 /"//eol//"&parameter name='r', value=0.3, spread=0.003, sets='pair(2).point(1)' /"//eol// &
      "&parameter name='l', value=1, spread=0.004, sets='pair(3).point(1)' /"//eol// &
      "&quantity name='x', of='q4', take='start' /"//eol//"&study kind='latin', runs=10 /"//eol, this)
    call propagate(this%given%model, this%given%variable, interruption, found, err)
    call tester%no_error(err, 'derivatives of the quantity')
    if (size(found) /= 1) return
    call tester%is_true(found(1)%known .and. found(1)%varies, 'they are known')
    ! derivatives are exact but for round-off
    call near_vector(tester, found(1)%derivative, [1.0_wp, 1.0_wp], 1.0e-9_wp, 'derivatives')
    call tester%near(found(1)%deviation/0.005_wp, 1.0_wp, 1.0e-9_wp, 'the deviation')
    call near_vector(tester, found(1)%share, [0.36_wp, 0.64_wp], 1.0e-9_wp, 'shares of the variance')
  end subroutine propagation
end module test_study_runs
