!> Texts for gnuplot: harmless strings, blocks of numbers, axes, layouts, scripts, and the rows that a plot keeps.
module test_plot_texts
  use mech9_kinds, only: wp
  use mech9_text, only: string_type
  use mech9_gnuplot, only: quoted, quoted_lines, quoted_path
  use mech9_plot_blocks, only: block_of, find_layout
  use mech9_plot_data, only: plot_data_type, new_plot_data
  use mech9_plot_request, only: plot_request_type, read_plot_request
  use mech9_event_words, only: told_events_type
  use mech9_plot_script, only: picture_script
  use mech9_plot_drawing, only: script_of_plot
  use mech9_plot_axes, only: axis_step, axis_commands
  use mech9_plot_style, only: digits_needed, picture_terminal, picture_title
  use mech9_structure_graph, only: text_of_graph
  use mech9_error, only: error_type
  use mech9_testing, only: tester_type
  implicit none
  private
  public :: run

  character, parameter :: eol = achar(10)

contains

  !> Run the cases of this suite.
  subroutine run(tester)
    type(tester_type), intent(inout) :: tester   !< selects cases and counts their checks

    if (tester%runs('strings')) call strings(tester)
    if (tester%runs('blocks')) call blocks(tester)
    if (tester%runs('layouts')) call layouts(tester)
    if (tester%runs('axes')) call axes(tester)
    if (tester%runs('rows')) call rows(tester)
    if (tester%runs('scripts')) call scripts(tester)
  end subroutine run

  !> No string ends before its end, and none is more than one line.
  subroutine strings(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(string_type) :: lines(2)

    call tester%is_true(quoted('plain "a" \n `b`') == '''plain "a" \n `b`''', 'between single quotes nothing has a meaning')
    call tester%is_true(quoted('it''s "a" \ `') == '"it''s \042a\042 \134 \140"', 'a single quote: '//quoted('it''s "a" \ `'))
    call tester%is_true(index(quoted('a'//eol//'b'), eol) == 0, 'ends of lines')
    lines(1)%text = 'one'
    lines(2)%text = 'it''s "2"'
    call tester%is_true(quoted_lines(lines) == '"one\nit''s \0422\042"', 'two lines: '//quoted_lines(lines))
    call tester%is_true(quoted_lines(lines(:1)) == '''one''', 'one line')
    call tester%is_true(quoted_path('<a') == '''./<a''' .and. quoted_path('/b/|c') == '''/b/|c''', 'a path begins with a folder')
    call tester%is_true(quoted_path('a'//eol//'$') == '"./a\012\044"', 'bytes that cannot stand in a line')
  end subroutine strings

  subroutine blocks(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    character(len=:), allocatable :: text
    character(len=20) :: words(3)
    real(wp) :: back(2, 3)
    integer :: first, last

    text = block_of('$x', reshape([1.0_wp, 2.0_wp, 0.1_wp, -0.2_wp, 1.0e-20_wp, 3.0e20_wp], [2, 3]))
    first = index(text, eol)
    last = index(text, 'end_of_data', back=.true.)
    read (text(:first), *) words
    call tester%is_true(words(1) == '$x' .and. words(2) == '<<' .and. text(last:) == trim(words(3))//eol, &
                        'a block ends as it begins')
    text = text(first + 1:last - 1)
    call tester%is_true(count([(text(first:first) == eol, first=1, len(text))]) == 2, 'two lines')
    read (text, *) back(1, :), back(2, :)
    call tester%is_true(all(abs(back(1, :) - [1.0_wp, 0.1_wp, 1.0e-20_wp]) <= 1.0e-15_wp*abs(back(1, :))), 'the first line')
    call tester%is_true(all(abs(back(2, :) - [2.0_wp, -0.2_wp, 3.0e20_wp]) <= 1.0e-15_wp*abs(back(2, :))), 'the second line')
  end subroutine blocks

  !> All panels have a place, and no row is empty.
  subroutine layouts(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    integer :: n, across, down, width, height

    do n = 1, 12
      call find_layout(n, across, down, width, height)
      call tester%is_true(across*down >= n .and. across*(down - 1) < n, 'rows and columns of panels')
      call tester%is_true(width >= 400*across .and. height >= 300*down, 'panels are large enough')
    end do
  end subroutine layouts

  subroutine axes(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks

    call tester%is_true(digits_needed([0.0_wp, 1.0_wp]) == 6, 'six digits at least')
    call tester%is_true(digits_needed([1.0e8_wp - 1.0_wp, 1.0e8_wp]) == 10, 'as many as neighbours differ by')
    call tester%is_true(digits_needed([5.0_wp, 5.0_wp]) == 6, 'equal numbers')
    call tester%is_true(axis_step([0.0_wp, 10.0_wp], 600) == '1' .and. axis_step([0.0_wp, 10.0_wp], 200) == '2', &
                        'marks stand apart')
    ! six marks of three letters, each 9 px wide, with gaps of 14 px need 246 px, and three of them half as much
    call tester%is_true(axis_step([0.0_wp, 1.0_wp], 250) == '0.2' .and. axis_step([0.0_wp, 1.0_wp], 240) == '0.5', 'parts of one')
    call tester%is_true(axis_step([3.0_wp, 3.0_wp], 600) == '', 'equal ends have no marks')
    call tester%is_true(axis_step([0.0_wp, 360.0_wp], 600, 'deg') == '45' .and. axis_step([0.0_wp, 360.0_wp], 300, 'deg') == '90' &
                        .and. axis_step([0.0_wp, 50.0_wp], 300, 'deg') == '10', 'parts of a turn')
    call tester%is_true(axis_commands('y', [0.0_wp, 350.0_wp], 'deg', 195, .false.) == &
                        'set yrange [0:360]'//new_line('a')//'set ytics 90'//new_line('a'), 'the axis ends at a mark')
    call tester%is_true(index(axis_commands('x', [-1.0_wp, 6.0_wp], 'rad', 500, .false.), '/2'' 4.71238898') > 0, 'parts of pi')
    call tester%is_true(index(axis_commands('y', [1.0e300_wp, 2.0e300_wp], 'm', 195, .false.), 'set autoscale y') == 1, &
                        'huge values are left to gnuplot')
  end subroutine axes

  !> The columns of the curves, and one row of so many.
  subroutine rows(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(string_type) :: names(4), units(4)
    type(plot_request_type) :: request
    type(plot_data_type) :: data
    type(error_type), allocatable :: err
    integer :: i

    do i = 1, 4
      names(i)%text = achar(96 + i)
      units(i)%text = 'm'
    end do
    names(1)%text = 't'
    call read_plot_request('d,b:d', names, request, err)
    call tester%no_error(err, 'a request')
    data = new_plot_data(names, units, request%curves, 25000)
    do i = 1, 25000
      call data%take([1.0_wp*i, 2.0_wp*i, 3.0_wp*i, 4.0_wp*i])
    end do
    call tester%is_true(all(data%columns == [1, 2, 4]), 'columns that curves need')
    call tester%is_true(data%stride == 3 .and. data%count == 8334, 'every third row')
    call tester%is_true(all(abs(data%values(:, 2) - [4.0_wp, 8.0_wp, 16.0_wp]) <= 0.0_wp), 'the second row that is kept')
    call tester%is_true(data%place_of(4) == 3, 'the place of a column')
  end subroutine rows

  subroutine scripts(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(string_type) :: names(2), units(2)
    type(string_type), allocatable :: lines(:)
    type(plot_request_type) :: request
    type(plot_data_type) :: data
    type(error_type), allocatable :: err
    character(len=:), allocatable :: text
    integer :: i

    names(1)%text = 't'
    names(2)%text = 'x'
    units(1)%text = 's'
    units(2)%text = 'm'
    call read_plot_request('x', names, request, err)
    data = new_plot_data(names, units, request%curves, 3)
    do i = 1, 3
      call data%take([1.0_wp*i, 0.5_wp*i])
    end do
    text = picture_script('it''s', request%curves, data, 'p.svg', 'p.gp', '', told_events_type())
    call tester%is_true(index(text, '# gnuplot p.gp draws p.svg'//eol) == 1, 'the first line tells its use')
    call tester%is_true(index(text, 'set output ''./p.svg''') > 0 .and. index(text, 'set title "it''s"') > 0, 'output and title')
    call tester%is_true(index(text, '$data <<') > 0, 'the script holds the data')
    text = picture_script('x', request%curves, data, 'p.svg', 'p.gp', 'r.dat', told_events_type())
    call tester%is_true(index(text, '$data <<') == 0 .and. index(text, '''./r.dat''') > 0, 'or names the table')
    call tester%is_true(index(picture_terminal('a.png', 8, 6), 'pngcairo') > 0 .and. &
                        index(picture_terminal('a.pdf', 96, 192), 'size 1in,2in') > 0 .and. &
                        index(picture_terminal('a.svg', 8, 6), 'svg') > 0, 'terminals by endings')
    lines = picture_title('a ]]> b', 'a.svg', 800)
    call tester%is_true(index(lines(1)%text, ']]>') == 0, 'what ends a part of an SVG does not stand in its title')
    call tester%is_true(script_of_plot('d/a.svg') == 'd/a.gp', 'the script stands beside the picture')
    call tester%is_true(text_of_graph('a.svg') == 'a.dot' .and. text_of_graph('a.dot') == 'a.dot', 'and so does a graph')
  end subroutine scripts
end module test_plot_texts
