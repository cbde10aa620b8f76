!> The work on a synthesis: a slider-crank that moves its slider as another one does, whose lengths are known. Starts are made in
!> threads, kept in a file, read back and told.
module test_synthesis_work
  use mech9_program_kind, only: kinematics
  use mech9_kinds, only: wp
  use mech9_best_design, only: text_of_best
  use mech9_design_motion, only: design_motion_type, new_design_motion
  use mech9_error, only: error_type, exit_file
  use mech9_explained_assembly, only: assemble_model
  use mech9_fit_panels, only: append_panels
  use mech9_fit_script, only: fit_panel_type, fit_script
  use mech9_hdf5_file, only: hdf5_file_type
  use mech9_hdf5_reading, only: open_existing, read_integer
  use mech9_hdf5_copying, only: extents_of
  use mech9_data_file, only: data_file_type
  use mech9_optimum_layout, only: write_optima
  use mech9_version, only: name_and_version
  use mech9_optimum_words, only: print_optimum
  use mech9_plan, only: plan_type
  use mech9_start_threads, only: make_in_threads
  use mech9_search_starts, only: all_handed_out
  use mech9_starts, only: starts_type
  use mech9_search_starts, only: start_type
  use mech9_starts_file, only: starts_layout_type, find_layout, read_starts
  use mech9_state, only: state_type
  use mech9_synthesis, only: synthesis_type, new_synthesis
  use mech9_checks, only: near_vector, has_message
  use mech9_small_models, only: slider_crank, eol
  use mech9_text_models, only: document_from_text, model_from_text
  use mech9_test_files, only: save_lines, remove_file, text_of_unit
  use mech9_testing, only: tester_type
  implicit none
  private
  public :: run

  character(len=*), parameter :: stem = 'test_synthesis_work'
  real(wp), parameter :: wanted(2) = [0.25_wp, 1.2_wp]   !< lengths of crank and rod of the other slider-crank [m]
  real(wp), parameter :: angles(4) = [0.3_wp, 0.9_wp, 1.7_wp, 2.6_wp]
  !> The targets are met to round-off, and lengths follow from them with a factor of about ten.
  real(wp), parameter :: tol = 1.0e-9_wp

contains

  !> Run the cases of this suite.
  subroutine run(tester)
    type(tester_type), intent(inout) :: tester   !< selects cases and counts their checks

    if (tester%runs('search')) call search(tester)
  end subroutine run

  !> Prepare the synthesis. The targets are places of the other slider, l + r cos q in its closed form.
  subroutine prepare(tester, given, synthesis)
    type(tester_type), intent(inout) :: tester                     !< counts the checks
    type(data_file_type), intent(out), target :: given             !< the data file
    type(synthesis_type), intent(out) :: synthesis                 !< ready for starts
    type(plan_type) :: plan
    type(state_type) :: start
    type(error_type), allocatable :: err
    character(len=60) :: lines(4)
    character(len=:), allocatable :: text
    integer :: i, number

    do i = 1, 4
      write (lines(i), '(2es26.17)') angles(i), wanted(1)*cos(angles(i)) + sqrt(wanted(2)**2 - (wanted(1)*sin(angles(i)))**2)
    end do
    call save_lines(tester, stem//'.dat', lines)
    text = slider_crank//"&drive coordinate=1, kind='polynomial', coefficients=0.1, 3 /"//eol// &
      "&time end=1, intervals=10 /"//eol// &
      "&parameter name='r', value=0.3, low=0.1, high=0.5, sets='pair(2).point(1)' /"//eol// &
      "&parameter name='l', value=1, low=0.8, high=1.5, sets='pair(3).point(1)' /"//eol// &
      "&objective kind='function', of='q4', over='q1', file='"//stem//".dat' /"//eol//'&optimum starts=3, seed=5 /'//eol
    call document_from_text(tester, text, given%document)
    call model_from_text(tester, text, kinematics, given%model)
    call given%diagnostics%add_source(given%document%source, number)
    call given%prepare_variable()
    call assemble_model(given%model, plan, start, err)
    call tester%no_error(err, 'the start of the data file')
    call new_synthesis(given%variable, given%model, plan, synthesis, err)
    call tester%no_error(err, 'a synthesis')
    call remove_file(stem//'.dat')
  end subroutine prepare

  subroutine search(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(data_file_type), target :: given
    type(synthesis_type) :: synthesis
    type(starts_type) :: starts
    type(starts_layout_type) :: layout
    type(error_type), allocatable :: err
    integer :: i

    call prepare(tester, given, synthesis)
    allocate (starts%made(3))
    call find_layout(given, synthesis, 'a search', layout)
    call starts%file%create(stem//'.h5', given, layout, .false., err)
    call tester%no_error(err, 'a file for starts')
    call starts%file%publish(err)
    call starts%begin_shown(kinematics, .true.)
    call make_in_threads(given%variable, synthesis, 5, 2, starts)
    call tester%is_true(starts%hand_out() == all_handed_out, 'no start is left')
    call starts%finish(synthesis)
    call tester%is_true(.not. allocated(starts%stopped), 'all starts are made')
    call starts%file%close(err)
    call tester%no_error(err, 'the file is closed')
    call tester%is_true(synthesis%done == 3 .and. synthesis%reached >= 1 .and. size(synthesis%optima) >= 1, 'designs are found')
    if (size(synthesis%optima) == 0) return
    call near_vector(tester, synthesis%values_of(1), wanted, tol, 'the best one has the lengths of the other slider-crank')
    call tester%near(synthesis%optima(1)%value, 0.0_wp, tol**2, 'it meets all targets')
    call read_back(tester, given, synthesis, starts)
    call tell(tester, given, synthesis)
    call draw(tester, given, synthesis)
    do i = 1, 3
      call tester%is_true(allocated(starts%made(i)%found), 'each start has its designs')
    end do
  end subroutine search

  !> The file has the designs of all starts; another search is refused.
  subroutine read_back(tester, given, synthesis, starts)
    type(tester_type), intent(inout) :: tester         !< counts the checks
    type(data_file_type), intent(in) :: given          !< the data file
    type(synthesis_type), intent(in) :: synthesis      !< with its designs
    type(starts_type), intent(in) :: starts            !< all of them, made
    type(start_type) :: again(3), others(3)
    type(starts_layout_type) :: layout
    type(error_type), allocatable :: err
    integer :: i, k

    call find_layout(given, synthesis, 'a search', layout)
    call read_starts(stem//'.h5', layout, again, err)
    call tester%no_error(err, 'starts are read back')
    do i = 1, 3
      call tester%is_true(size(again(i)%found) == count(starts%made(i)%found%found), 'all designs of a start')
      do k = 1, min(size(again(i)%found), size(starts%made(i)%found))
        if (.not. all(starts%made(i)%found%found)) cycle
        call near_vector(tester, again(i)%found(k)%x, starts%made(i)%found(k)%x, 0.0_wp, 'values of a design')
        call near_vector(tester, again(i)%found(k)%q, starts%made(i)%found(k)%q, 0.0_wp, 'its position')
      end do
    end do
    layout%definition = 'another search'
    call read_starts(stem//'.h5', layout, others, err)
    call has_message(tester, err, exit_file, "it is of another search: there 'a search', here 'another search'", 'another search')
    call remove_file(stem//'.h5')
  end subroutine read_back

  !> A summary, comments and the group of an HDF5 file.
  subroutine tell(tester, given, synthesis)
    type(tester_type), intent(inout) :: tester         !< counts the checks
    type(data_file_type), intent(in) :: given          !< the data file
    type(synthesis_type), intent(in) :: synthesis      !< with its designs
    type(hdf5_file_type) :: file
    type(error_type), allocatable :: err
    character(len=:), allocatable :: text
    integer, allocatable :: extents(:)
    integer :: unit, number

    open (newunit=unit, file=stem//'.txt')
    call print_optimum(unit, given%model, synthesis, 2.5_wp)
    call text_of_unit(tester, unit, text)
    call tester%is_true(index(text, '3 starts: 2.5 s; ') == 1 .and. index(text, '  r = 0.25'//eol) > 0 .and. &
                        index(text, '  l = 1.2'//eol) > 0, 'a summary: '//text)
    call text_of_best(given%document, given%model, synthesis, text)
    call tester%is_true(index(text, '! The best design that '//name_and_version(given%model%program)// &
                                    ' found by --optimize from 3 starts, seed 5.'//eol) == 1, 'comments')
    call file%create(stem//'.h5', err)
    call file%put('coordinate', [1, 2, 3, 4], 'number of the coordinate')
    call file%make_scale('coordinate')
    call file%put('target', [1, 2, 3, 4], 'number of the target')
    call file%make_scale('target')
    call write_optima(file, given%model, synthesis)
    call file%flush()
    call tester%is_true(.not. allocated(file%failure), 'designs are written')
    call file%close()
    call open_existing(stem//'.h5', .false., file, err)
    call read_integer(file, 'optimum/made', number)
    call extents_of(file, 'optimum/coordinates', extents)
    call tester%is_true(number == 3 .and. all(extents == [4, size(synthesis%optima)]), 'starts and positions')
    call file%close()
    call remove_file(stem//'.h5')
  end subroutine tell

  !> The panels of the function: places at the targets lie on them, and the differences are round-off.
  subroutine draw(tester, given, synthesis)
    type(tester_type), intent(inout) :: tester                        !< counts the checks
    type(data_file_type), intent(inout), target :: given              !< the data file
    type(synthesis_type), intent(in) :: synthesis                     !< with its designs
    type(design_motion_type), target :: motion
    type(fit_panel_type), allocatable :: panels(:)
    type(error_type), allocatable :: err
    character(len=:), allocatable :: script

    call new_design_motion(given%variable, given%model, synthesis%values_of(1), synthesis%optima(1)%q, motion, err)
    call tester%no_error(err, 'the motion of the best design')
    allocate (panels(0))
    call append_panels(motion, synthesis, 1, 'q4', panels, err)
    call tester%no_error(err, 'panels')
    call tester%is_true(size(panels) == 2, 'the function and its differences')
    if (size(panels) /= 2) return
    call near_vector(tester, panels(1)%targets(:, 1), angles, 0.0_wp, 'targets stand over the crank')
    call near_vector(tester, panels(1)%reached(:, 2), panels(1)%targets(:, 2), tol, 'they are reached')
    call near_vector(tester, panels(1)%curve(:, 2), wanted(1)*cos(panels(1)%curve(:, 1)) + &
                     sqrt(wanted(2)**2 - (wanted(1)*sin(panels(1)%curve(:, 1)))**2), tol, 'the curve by its formula')
    call tester%is_true(panels(2)%is_error .and. maxval(abs(panels(2)%targets(:, 2))) < tol, 'differences are round-off')
    script = fit_script('a title', panels, 'fit.svg', 'fit.gp')
    call tester%is_true(index(script, '# gnuplot fit.gp draws fit.svg'//eol) == 1 .and. &
                        index(script, 'set multiplot layout 1,2') > 0, 'the script of two panels')
  end subroutine draw
end module test_synthesis_work
