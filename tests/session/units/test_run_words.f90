!> Words of reports: times, parameters, jumps of drives, notes, ranges and assemblies of a mechanism whose motion is known.
module test_run_words
  use mech9_program_kind, only: kinematics
  use mech9_kinds, only: wp
  use mech9_error, only: error_type
  use mech9_model, only: model_type
  use mech9_plan, only: plan_type
  use mech9_state, only: state_type
  use mech9_planning, only: make_plan
  use mech9_run_words, only: duration, each
  use mech9_parameter_text, only: print_parameters
  use mech9_law_notes, only: print_jumps
  use mech9_check_notes, only: print_notes
  use mech9_geometry_text, only: print_dimensions
  use mech9_range_text, only: print_ranges
  use mech9_assemblies_text, only: print_assemblies
  use mech9_small_models, only: slider_crank, crank, rod, eol
  use mech9_text_models, only: model_from_text
  use mech9_test_files, only: text_of_unit
  use mech9_testing, only: tester_type
  implicit none
  private
  public :: run

  character(len=*), parameter :: path = 'test_run_words.txt'
  character(len=*), parameter :: drive = "&drive coordinate=1, kind='polynomial', coefficients=0.4, 1 /"//eol

contains

  !> Run the cases of this suite.
  subroutine run(tester)
    type(tester_type), intent(inout) :: tester   !< selects cases and counts their checks

    if (tester%runs('times')) call times(tester)
    if (tester%runs('parameters')) call parameters(tester)
    if (tester%runs('jumps')) call jumps(tester)
    if (tester%runs('notes')) call notes(tester)
    if (tester%runs('dimensions')) call dimensions(tester)
    if (tester%runs('ranges')) call ranges(tester)
    if (tester%runs('assemblies')) call assemblies(tester)
  end subroutine run

  !> Whether a text holds a line with these words, up to blanks between them.
  pure logical function holds(text, words)
    character(len=*), intent(in) :: text    !< several lines
    character(len=*), intent(in) :: words   !< with one blank between them
    character(len=:), allocatable :: tidy
    integer :: i

    tidy = ''
    do i = 1, len(text)
      if (text(i:i) == ' ' .and. index(text(i:)//'x', '  ') == 1) cycle
      tidy = tidy//text(i:i)
    end do
    holds = index(tidy, words) > 0
  end function holds

  subroutine times(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks

    call tester%is_true(duration(2.5e-6_wp) == '2.5 us' .and. duration(0.25_wp) == '250 ms' .and. duration(12.5_wp) == '12.5 s', &
                        'a time has a unit in which it is readable')
    call tester%is_true(each(2.0_wp, 4) == ', 500 ms each' .and. each(2.0_wp, 1) == '', 'the mean of several times')
  end subroutine times

  subroutine parameters(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(model_type) :: model
    character(len=:), allocatable :: text
    integer :: unit

    call model_from_text(tester, slider_crank//drive//"&time end=1 /"//eol// &
                  "&parameter name='a', value=0.25, sets='pair(2).point(1)', 'time.end' /"//eol, &
                  kinematics, model)
    open (newunit=unit, file=path)
    call print_parameters(unit, model)
    call text_of_unit(tester, unit, text)
    call tester%is_true(text == 'parameters:'//eol//'  a = 0.25 sets pair(2).point(1), time.end'//eol, 'parameters: '//text)
  end subroutine parameters

  !> A drive of two speeds has a rate that jumps where they meet; one at a constant speed does not jump.
  subroutine jumps(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(model_type) :: model
    character(len=:), allocatable :: text
    integer :: unit

    call model_from_text(tester, slider_crank//"&time end=3 /"//eol//"&drive coordinate=1, kind='segments', times=0, 1, 3, "// &
                  "values=0, 1, 5, laws='constant-velocity' /"//eol, kinematics, model)
    open (newunit=unit, file=path)
    call print_jumps(unit, model)
    call text_of_unit(tester, unit, text)
    call tester%is_true(index(text, 'note: the rate of the ') == 1 .and. index(text, 'jumps at t = 1') > 0, 'a jump: '//text)
    call model_from_text(tester, slider_crank//"&time end=3 /"//eol//drive, kinematics, model)
    open (newunit=unit, file=path)
    call print_jumps(unit, model)
    call text_of_unit(tester, unit, text)
    call tester%is_true(text == '', 'no jump')
  end subroutine jumps

  !> Angles of more than a turn, and rates that are round numbers of degrees.
  subroutine notes(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks

    call has_note('coefficients=90, 1', 'note: the drive of coordinate 1 has the angle 90 rad, more than a turn')
    call has_note('coefficients=0, 90', 'note: the drive of coordinate 1 has the rate 90 rad/s')
    call has_note('coefficients=0, 44.5', '')
    call has_note('coefficients=1, 6', '')
  contains
    subroutine has_note(coefficients, words)
      character(len=*), intent(in) :: coefficients   !< of the drive
      character(len=*), intent(in) :: words          !< beginning of the note; empty: there is none
      type(model_type) :: model
      character(len=:), allocatable :: text
      integer :: unit

      call model_from_text(tester, slider_crank//"&drive coordinate=1, kind='polynomial', "//coefficients//" /"//eol, &
                           kinematics, model)
      open (newunit=unit, file=path)
      call print_notes(unit, model, .false.)
      call text_of_unit(tester, unit, text)
      if (words == '') call tester%is_true(text == '', 'no note on '//coefficients//': '//text)
      if (words /= '') call tester%is_true(index(text, words) == 1, 'the note on '//coefficients//': '//text)
    end subroutine has_note
  end subroutine notes

  !> Crank and rod have parallel axes at the distances of the data file.
  subroutine dimensions(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(model_type) :: model
    character(len=:), allocatable :: text
    integer :: unit

    call model_from_text(tester, slider_crank//drive, kinematics, model)
    open (newunit=unit, file=path)
    call print_dimensions(unit, model%mechanism)
    call text_of_unit(tester, unit, text)
    call tester%is_true(holds(text, ' 2 1 and 2 0.3 0 0.3'//eol), 'the crank: '//text)
    call tester%is_true(holds(text, ' 3 2 and 3 1 0 1'//eol), 'the rod')
    call tester%is_true(index(text, 'angle [rad]') > 0, 'the unit of angles')
  end subroutine dimensions

  !> The crank turns fully; with the slide driven, this goes from rod - crank to rod + crank.
  subroutine ranges(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(model_type) :: model
    character(len=:), allocatable :: text
    character(len=3) :: name
    real(wp) :: numbers(3)
    integer :: status

    call print_of(slider_crank//drive)
    call tester%is_true(index(text, 'full turn') > 0, 'a crank that turns: '//text)
    call print_of(slider_crank(:index(slider_crank, 'cq=1') + 2)//'4'//slider_crank(index(slider_crank, 'cq=1') + 4:)// &
                  "&drive coordinate=4, kind='polynomial', coefficients=1.2 /"//eol//"&initial coordinate=1, position=0.8 /"//eol)
    read (text(index(text, 'q4'):), *, iostat=status) name, numbers
    call tester%is_true(status == 0, 'the range of the slide: '//text)
    if (status /= 0) return
    ! the ends are found to the tolerance of the search for them
    call tester%near(numbers(1), 1.2_wp, 1.0e-10_wp, 'the start')
    call tester%near(numbers(2), rod - crank, 1.0e-9_wp, 'the lower end')
    call tester%near(numbers(3), rod + crank, 1.0e-9_wp, 'the upper end')
  contains
    subroutine print_of(data)
      character(len=*), intent(in) :: data   !< data file
      type(plan_type) :: plan
      type(state_type) :: state
      type(error_type), allocatable :: err
      integer :: unit

      call model_from_text(tester, data, kinematics, model)
      associate (position => model%problem%initial%position)
        if (model%problem%drives(1)%drive%coordinate == 1) position(1) = 0.4_wp
        if (model%problem%drives(1)%drive%coordinate == 4) position(4) = 1.2_wp
        call make_plan(model%mechanism, model%problem%partition, position, plan, state, err)
      end associate
      call tester%no_error(err, 'a plan')
      open (newunit=unit, file=path)
      call print_ranges(unit, model, plan, state)
      call text_of_unit(tester, unit, text)
    end subroutine print_of
  end subroutine ranges

  !> A slider-crank has two assemblies: x = r cos q + l and r cos q - l along the slide, with the slider on either side.
  subroutine assemblies(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(model_type) :: model
    type(plan_type) :: plan
    type(state_type) :: state
    type(error_type), allocatable :: err
    character(len=:), allocatable :: text
    real(wp) :: x(2), q, expected
    integer :: unit, at, i, status

    q = 0.4_wp
    call model_from_text(tester, slider_crank//drive, kinematics, model)
    model%problem%initial%position(1) = q
    call make_plan(model%mechanism, model%problem%partition, model%problem%initial%position, plan, state, err)
    open (newunit=unit, file=path)
    call print_assemblies(unit, model%mechanism, plan, state, 40)
    call text_of_unit(tester, unit, text)
    call tester%is_true(index(text, '! 2 assemblies found from 40 starts') == 1, 'two assemblies: '//text)
    at = 1
    do i = 1, 2
      at = at + index(text(at:), 'coordinate=4, position=')
      read (text(at + len('coordinate=4, position=') - 1:), *, iostat=status) x(i)
    end do
    expected = sqrt(rod**2 - (crank*sin(q))**2)
    ! positions are closed to round-off, in units of the mechanism's size
    call tester%near(x(1), crank*cos(q) + expected, 1.0e-12_wp, 'the assembly of the data file')
    call tester%near(x(2), crank*cos(q) - expected, 1.0e-12_wp, 'the other one')
  end subroutine assemblies
end module test_run_words
