!> Words about structure, mobility, plan and forces of a slider-crank, whose mobility and equations are known; and notes about
!> options without effect.
module test_structure_words
  use mech9_program_kind, only: kinematics, dynamics
  use mech9_command_line, only: command_line_type
  use mech9_error, only: error_type
  use mech9_force_text, only: print_uniqueness, print_undetermined, print_forceless
  use mech9_held_text, only: print_held
  use mech9_mobility_report, only: mobility_report_type, report_mobility
  use mech9_model, only: model_type
  use mech9_data_file, only: data_file_type
  use mech9_part_names, only: part_names_type
  use mech9_plan, only: plan_type
  use mech9_plan_text, only: print_plan
  use mech9_planning, only: make_plan
  use mech9_requested, only: requested_type
  use mech9_state, only: state_type
  use mech9_structure_text, only: print_structure, print_mobility, print_mobility_report, print_marked
  use mech9_uniqueness, only: uniqueness_type, component_names
  use mech9_unused_options, only: print_unused_options
  use mech9_small_models, only: slider_crank, eol
  use mech9_text_models, only: model_from_text
  use mech9_test_files, only: text_of_unit
  use mech9_testing, only: tester_type
  use option_words, only: options_of
  implicit none
  private
  public :: run

  character(len=*), parameter :: path = 'test_structure_words.txt'

contains

  !> Run the cases of this suite.
  subroutine run(tester)
    type(tester_type), intent(inout) :: tester   !< selects cases and counts their checks

    if (tester%runs('vectors')) call vectors(tester)
    if (tester%runs('mobility')) call mobility(tester)
    if (tester%runs('plans')) call plans(tester)
    if (tester%runs('forces')) call forces(tester)
    if (tester%runs('forceless')) call forceless(tester)
    if (tester%runs('held_rods')) call held_rods(tester)
    if (tester%runs('unused_options')) call unused_options(tester)
  end subroutine run

  subroutine planned(tester, model, plan, state)
    type(tester_type), intent(inout) :: tester    !< counts the checks
    type(model_type), intent(out) :: model        !< the slider-crank
    type(plan_type), intent(out) :: plan          !< its plan
    type(state_type), intent(out) :: state        !< a closed position
    type(error_type), allocatable :: err

    call model_from_text(tester, slider_crank//'&initial coordinate=1, position=0.4 /'//eol, dynamics, model)
    call make_plan(model%mechanism, model%problem%partition, model%problem%initial%position, plan, state, err)
    call tester%no_error(err, 'a plan')
  end subroutine planned

  !> The chain starts on link 1, goes through all links, and closes.
  subroutine vectors(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(model_type) :: model
    type(plan_type) :: plan
    type(state_type) :: state
    character(len=:), allocatable :: text
    character(len=1), allocatable :: unnamed(:)
    integer :: unit, nrg(5), nws(5), status

    call planned(tester, model, plan, state)
    open (newunit=unit, file=path)
    call print_structure(unit, model%mechanism%structure, model%problem%partition%vectors)
    call print_marked(unit, [.true., .false., .true.], 'links ', unnamed, '.')
    call print_marked(unit, [.false.], 'nothing ', unnamed)
    call text_of_unit(tester, unit, text)
    read (text(index(text, 'nrg = ') + 6:index(text, 'nws') - 1), *, iostat=status) nrg
    call tester%is_true(status == 0 .and. nrg(1) == 1, 'links in the order of computation: '//text)
    read (text(index(text, 'nws = ') + 6:index(text, 'rdw') - 1), *, iostat=status) nws
    call tester%is_true(status == 0 .and. all([any(nws == 1), any(nws == 2), any(nws == 3), any(nws == 4)]), 'all coordinates')
    call tester%is_true(index(text, 'links 1, 3.'//eol) > 0 .and. index(text, 'nothing') == 0, 'marked numbers')
  end subroutine vectors

  !> 1 = 4 - 3: three equations of a plane chain, any coordinate may be the independent one.
  subroutine mobility(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(model_type) :: model
    type(plan_type) :: plan
    type(state_type) :: state
    type(mobility_report_type) :: report
    character(len=:), allocatable :: text
    integer :: unit

    call planned(tester, model, plan, state)
    call report_mobility(model%mechanism, plan, state, report)
    open (newunit=unit, file=path)
    call print_mobility(unit, model%mechanism, plan)
    call print_mobility_report(unit, model%mechanism, plan, report)
    call text_of_unit(tester, unit, text)
    call tester%is_true(index(text, '4 links, 4 coordinates, 1 closed chain'//eol//'independent: 1'//eol) == 1, 'counts: '//text)
    call tester%is_true(index(text, 'mobility 1 = 4 coordinates - rank 3'//eol) > 0, 'the mobility')
    call tester%is_true(index(text, 'mobility by the count: 1 = 4 coordinates - 3 dimensions') > 0, 'by the count')
    call tester%is_true(index(text, 'mobility by the rank: 1 = 4 coordinates - rank 3'//eol) > 0, 'by the rank')
    call tester%is_true(index(text, 'could be independent instead of 1: 2, 3, 4'//eol) > 0, 'other choices')
    call tester%is_true(index(text, 'redundant') == 0, 'no equation is redundant')
  end subroutine mobility

  subroutine plans(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(model_type) :: model
    type(plan_type) :: plan
    type(state_type) :: state
    type(requested_type) :: requested
    character(len=:), allocatable :: text
    integer :: unit

    call planned(tester, model, plan, state)
    allocate (requested%coordinates(4), source=.true.)
    allocate (requested%links(4), source=.false.)
    requested%derivatives = 0
    open (newunit=unit, file=path)
    call print_plan(unit, model%mechanism, plan, requested)
    call text_of_unit(tester, unit, text)
    call tester%is_true(index(text, 'planar arithmetic: all pairs turn about or slide across the direction (0, 0, ') == 1, &
                        'the plane: '//text)
    call tester%is_true(index(text, 'block 1: links ') > 0 .and. index(text, ' from 3 equations of rank 3'//eol) > 0, 'a block')
    call tester%is_true(index(text, 'its motions span 3 dimensions'//eol) > 0, 'the motions of its chain')
    call tester%is_true(index(text, 'accelerations left out') > 0, 'derivatives that are not recorded')
  end subroutine plans

  subroutine forces(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(uniqueness_type) :: unique
    type(part_names_type) :: unnamed
    logical :: recorded(3)
    character(len=:), allocatable :: text
    integer :: unit

    recorded = [.true., .false., .true.]
    allocate (unique%pairs(6, 3), unique%fixed(6, 3), unique%moving(6, 3), source=.true.)
    allocate (unique%couplings(0))
    open (newunit=unit, file=path)
    call print_uniqueness(unit, unnamed, recorded, unique, .false.)
    call print_undetermined(unit, recorded, unique, .false.)
    call text_of_unit(tester, unit, text)
    call tester%is_true(text == 'forces and moments in the pairs: equilibrium determines all components'//eol, 'all: '//text)
    unique%pairs(3:4, 3) = .false.
    unique%pairs(1, 2) = .false.
    unique%fixed(1:2, 3) = .false.
    unique%fixed(1, 2) = .false.
    unique%moving(6, 3) = .false.
    open (newunit=unit, file=path)
    call print_uniqueness(unit, unnamed, recorded, unique, .false.)
    call print_undetermined(unit, recorded, unique, .false.)
    call text_of_unit(tester, unit, text)
    call tester%is_true(index(text, '  pair 3: force along z, moment about x; columns R3.fx R3.fy'//eol) > 0, &
                        'two components: '//text)
    call tester%is_true(index(text, 'pair 2') == 0, 'a pair that is not recorded is not told: '//text)
    call tester%is_true(index(text, 'equilibrium does not determine 2 of the 12 components of forces and moments in the pairs: '// &
                              'R3.fx R3.fy; ') > 0, 'their columns: '//text)
    open (newunit=unit, file=path)
    call print_undetermined(unit, recorded, unique, .true.)
    call text_of_unit(tester, unit, text)
    call tester%is_true(index(text, 'in the pairs: R3.mz; ') > 0, 'along the axes of the moving link: '//text)
    call tester%is_true(all(component_names == ['fx', 'fy', 'fz', 'mx', 'my', 'mz']), 'names of components')
  end subroutine forces

  !> A mechanism without masses and loads has no forces; a mass on a moving link gives some.
  subroutine forceless(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks

    call judge('', .true.)
    call judge('&body link=1, mass=1 /'//eol, .true.)
    call judge('&body link=2, mass=1 /'//eol, .false.)
    call judge("&load kind='coordinate', coordinate=1, force=0 /"//eol, .true.)
    call judge("&load kind='coordinate', coordinate=1, force=1 /"//eol, .false.)
  contains
    subroutine judge(groups, noted)
      character(len=*), intent(in) :: groups   !< behind the slider-crank
      logical, intent(in) :: noted             !< there are no forces
      type(model_type) :: model
      character(len=:), allocatable :: text
      integer :: unit

      call model_from_text(tester, slider_crank//groups, dynamics, model)
      open (newunit=unit, file=path)
      call print_forceless(unit, model%mechanism)
      call text_of_unit(tester, unit, text)
      call tester%is_true((text /= '') .eqv. noted, 'forces of '//groups//': '//text)
    end subroutine judge
  end subroutine forceless

  !> A rod between two ball joints turns by itself; a slider-crank has none.
  subroutine held_rods(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    character(len=*), parameter :: rod = '&mechanism links=4, coordinates=8 /'//eol//'&structure cq=1 /'//eol// &
      "&pair coordinate=1, links=1,2, kind='revolute', axis=0,0,1 /"//eol// &
      "&pair coordinates=2,3,4, links=2,3, kind='spherical', point=0.3,0,0, moving_point=0,0,0 /"//eol// &
      "&pair coordinates=5,6,7, links=3,4, kind='spherical', point=1,0,0, moving_point=0,0,0 /"//eol// &
      "&pair coordinate=8, links=1,4, kind='prismatic', axis=1,0,0, point=0,0,0.2, moving_point=0,0,0 /"//eol// &
      '&initial coordinate=8, position=1.2 /'//eol//"&drive coordinate=1, kind='polynomial', coefficients=0.4, 1 /"//eol
    type(model_type) :: model
    character(len=:), allocatable :: text
    integer :: unit

    call model_from_text(tester, rod, kinematics, model)
    open (newunit=unit, file=path)
    call print_held(unit, model)
    call text_of_unit(tester, unit, text)
    call tester%is_true(index(text, 'note: link 3 can turn by itself between the spherical joint of coordinates 2, 3, 4 '// &
                              'and the spherical joint of coordinates 5, 6, 7') == 1, 'a rod: '//text)
    call tester%is_true(index(text, ' is held at ') > 0, 'one of its angles is held')
    call model_from_text(tester, slider_crank, dynamics, model)
    open (newunit=unit, file=path)
    call print_held(unit, model)
    call text_of_unit(tester, unit, text)
    call tester%is_true(text == '', 'a slider-crank')
  end subroutine held_rods

  subroutine unused_options(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks

    call says('a.nml --table t.dat', '')
    call says('a.nml --check --table t.dat --hdf5 h.h5', 'mech9d: without effect: --table, --hdf5; --check makes no run'//eol)
    call says('a.nml --starts 3', 'mech9d: without effect: --starts; it is the number of guesses of --branches'//eol)
    call says('a.nml --branches --starts 3', '')
    call says('a.nml --view xy', 'mech9d: without effect: --view; no picture of the mechanism is drawn'//eol)
    call says('a.nml --view xy --sketch s.svg', '')
    call says('a.nml --structure --check', 'mech9d: without effect: --check; --structure reads the structure alone'//eol)
  contains
    subroutine says(line, expected)
      character(len=*), intent(in) :: line       !< command line
      character(len=*), intent(in) :: expected   !< the right notes
      type(command_line_type) :: options
      type(data_file_type) :: given
      character(len=:), allocatable :: text
      integer :: unit

      call options_of(tester, line, options)
      call model_from_text(tester, slider_crank, dynamics, given%model)
      open (newunit=unit, file=path)
      call print_unused_options(unit, options, given)
      call text_of_unit(tester, unit, text)
      call tester%is_true(text == expected, 'notes on '//line//': '//text)
    end subroutine says
  end subroutine unused_options
end module test_structure_words
