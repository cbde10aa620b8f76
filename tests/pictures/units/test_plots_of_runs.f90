!> Plots from their request to their script: a plot of a run, plots of a study, and the style sheet of pictures. The picture itself
!> is drawn only where gnuplot is there; the script is kept in any case.
module test_plots_of_runs
  use mech9_kinds, only: wp
  use mech9_error, only: error_type, exit_usage
  use mech9_picture_style, only: styles, style_sheet, colour_of, dark_colours, light_colours
  use mech9_plot, only: plot_type, picture_of_plot
  use mech9_heading, only: new_heading
  use mech9_scene, only: in_trace, in_plate, in_force, in_cam
  use mech9_study_request, only: study_request_type, read_study_request
  use mech9_study_script, only: study_script, study_terminal_script
  use mech9_text, only: string_type
  use mech9_checks, only: has_message
  use mech9_test_files, only: remove_file, text_of_file
  use mech9_testing, only: tester_type
  implicit none
  private
  public :: run

  character, parameter :: eol = achar(10)
  character(len=*), parameter :: stem = 'test_plots_of_runs'

contains

  !> Run the cases of this suite.
  subroutine run(tester)
    type(tester_type), intent(inout) :: tester   !< selects cases and counts their checks

    if (tester%runs('runs')) call plot_of_run(tester)
    if (tester%runs('names')) call names_of_pictures(tester)
    if (tester%runs('studies')) call plots_of_study(tester)
    if (tester%runs('styles')) call style_of_pictures(tester)
  end subroutine run

  subroutine named(words, list)
    character(len=*), intent(in) :: words(:)         !< names
    type(string_type), intent(out) :: list(:)        !< the same
    integer :: i

    do i = 1, size(words)
      list(i)%text = trim(words(i))
    end do
  end subroutine named

  !> A wrong name is refused before the run; the script of a right one holds the rows.
  subroutine plot_of_run(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(string_type) :: names(3), units(3)
    type(plot_type) :: plot, other
    type(error_type), allocatable :: err
    character(len=:), allocatable :: text
    real(wp) :: rows(3, 5)
    integer :: i

    call named(['t ', 'q1', 'q2'], names)
    call named(['s  ', 'rad', 'm  '], units)
    call other%open('q3', new_heading('a title', names, units), 5, stem//'.svg', '', err)
    call has_message(tester, err, exit_usage, 'q3', 'a wrong name')
    call plot%open('q1:q2', new_heading('a title', names, units), 5, stem//'.svg', '', err)
    call tester%no_error(err, 'a plot')
    rows = reshape([(1.0_wp*i, 0.25_wp*i, -0.5_wp*i, i=1, 5)], [3, 5])
    call plot%write_rows(rows, err)
    call plot%close(err)
    call tester%no_error(err, 'a plot is drawn, or its script is kept')
    call text_of_file(tester, stem//'.gp', text)
    call tester%is_true(index(text, '# gnuplot '//stem//'.gp draws '//stem//'.svg'//eol) == 1, 'the script tells its use')
    call tester%is_true(index(text, '1.25') > 0 .and. index(text, '-2.5') > 0, 'it holds the rows')
    call tester%is_true(index(plot%words(), stem) > 0 .or. index(plot%words(), 'gnuplot') > 0, 'its words: '//plot%words())
    call remove_file(stem//'.gp')
    call remove_file(stem//'.svg')
  end subroutine plot_of_run

  !> A picture has its own name, or one beside the table or the data file, with a number from the second one on.
  subroutine names_of_pictures(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    character(len=:), allocatable :: first, second

    call picture_of_plot('a.png:q1', '', 'd/m.nml', 1, first)
    call tester%is_true(first == 'a.png', 'a name that is given: '//first)
    call picture_of_plot('q1', '', 'd/m.nml', 1, first)
    call picture_of_plot('q1', '', 'd/m.nml', 2, second)
    call tester%is_true(first /= second .and. first /= '' .and. second /= '', 'two pictures: '//first//', '//second)
  end subroutine names_of_pictures

  !> A histogram, a scatter and a map in one picture, and the first two in letters.
  subroutine plots_of_study(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(string_type) :: names(3), units(3)
    type(study_request_type) :: request
    type(error_type), allocatable :: err
    character(len=:), allocatable :: text
    real(wp) :: rows(3, 20)
    integer :: i

    call named(['a', 'b', 's'], names)
    call named([' ', ' ', 'm'], units)
    rows = reshape([(real(mod(i, 4), wp), real(mod(i, 5), wp), real(i, wp), i=1, 20)], [3, 20])
    call read_study_request('s,a:s,a:b:s', names, 2, request, err)
    call tester%no_error(err, 'three plots')
    text = study_script('it''s', request%panels, names, units, rows, 'p.svg', 'p.gp')
    call tester%is_true(index(text, '# gnuplot p.gp draws p.svg'//eol) == 1 .and. index(text, '"it''s"') > 0, 'use and title')
    call tester%is_true(index(text, '$figure1') > 0 .and. index(text, '$figure2') > 0 .and. index(text, '$figure3') > 0, 'blocks')
    call tester%is_true(index(text, 'set multiplot') > 0 .and. index(text, 'unset multiplot'//eol//'unset output'//eol) > 0, &
                        'several panels')
    call tester%is_true(index(text, 'NaN') == 0 .and. index(text, '***') == 0, 'all numbers are numbers')
    text = study_terminal_script(request%panels(:2), names, units, rows, 70, 20)
    call tester%is_true(index(text, 'set terminal dumb mono noenhanced size 70,20'//eol) > 0, 'plots in letters')
  end subroutine plots_of_study

  !> Each style has a rule; colours come in turn from link 2 on.
  subroutine style_of_pictures(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    character(len=:), allocatable :: css
    integer :: i

    css = style_sheet(1.0_wp)
    do i = in_trace, in_cam
      call tester%is_true(index(css, '.mech9 .'//trim(styles(i)%name)//' path{') > 0, 'the rule of '//styles(i)%name)
    end do
    call tester%is_true(index(css, '.mech9 .'//trim(styles(in_force)%name)//' path{stroke-width:2.2') > 0, 'a line')
    ! a band of 7 px has an edge of 1.2 px on both sides; at half size the band is half as wide
    call tester%is_true(index(css, '.mech9 .plate path{stroke-width:9.4') > 0 .and. styles(in_plate)%has_edge, 'a band')
    call tester%is_true(index(style_sheet(0.5_wp), '.mech9 .plate path{stroke-width:5.9') > 0, 'a band at half size')
    call tester%is_true(size(dark_colours) == size(light_colours), 'colours come in twos')
    do i = 2, 30
      call tester%is_true(colour_of(i) >= 1 .and. colour_of(i) <= size(dark_colours) .and. &
                          colour_of(i + size(dark_colours)) == colour_of(i) .and. colour_of(i) /= colour_of(i + 1), 'colours')
    end do
  end subroutine style_of_pictures
end module test_plots_of_runs
