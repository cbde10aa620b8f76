!> Tables of equilibria and modes of a mass that hangs from a spring with a damper, by its formulas.
module test_equilibrium_rows
  use mech9_program_kind, only: dynamics
  use mech9_kinds, only: wp
  use mech9_columns, only: columns_type
  use mech9_equilibria, only: find_equilibrium
  use mech9_equilibrium_rows, only: columns_of_equilibria, rows_of_equilibria, columns_of_modes, rows_of_modes
  use mech9_error, only: error_type
  use mech9_explained_assembly, only: assemble_model
  use mech9_linearised_equilibrium, only: equilibrium_type
  use mech9_model, only: model_type
  use mech9_plan, only: plan_type
  use mech9_planning, only: planning_settings_type, make_plan
  use mech9_state, only: state_type
  use mech9_small_models, only: eol
  use mech9_text_models, only: model_from_text
  use mech9_testing, only: tester_type
  implicit none
  private
  public :: run

  real(wp), parameter :: pi = acos(-1.0_wp), tol = 1.0e-8_wp
  real(wp), parameter :: mass = 2.0_wp, stiffness = 50.0_wp, damping = 4.0_wp, rest = 0.3_wp, weight = -20.0_wp

  !> Pair 1 slides along z with the gravity of 10 m/s^2 against it.
  character(len=*), parameter :: data = "&mechanism title='Mass', links=2, coordinates=1 /"//eol//'&structure cq=1 /'//eol// &
    "&pair coordinate=1, links=1,2, kind='prismatic', axis=0,0,1 /"//eol//'&body link=2, mass=2 /'//eol// &
    '&gravity acceleration=0,0,-10 /'//eol// &
    "&load kind='coordinate', coordinate=1, stiffness=50, rest=0.3, damping=4 /"//eol// &
    '&initial coordinate=1, position=0.1, velocity=0 /'//eol//'&time end=1, intervals=10 /'//eol//'&output reactions=.true. /'//eol

contains

  !> Run the cases of this suite.
  subroutine run(tester)
    type(tester_type), intent(inout) :: tester   !< selects cases and counts their checks

    if (tester%runs('equilibria')) call equilibria(tester)
    if (tester%runs('modes')) call modes(tester)
  end subroutine run

  !> The mass at rest.
  subroutine find(tester, model, found)
    type(tester_type), intent(inout) :: tester       !< counts the checks
    type(model_type), intent(out) :: model           !< the mass
    type(equilibrium_type), intent(out) :: found     !< its equilibrium
    type(plan_type) :: own_plan, plan
    type(state_type) :: own_start, start
    type(error_type), allocatable :: err

    call model_from_text(tester, data, dynamics, model)
    call assemble_model(model, own_plan, own_start, err)
    call tester%no_error(err, 'the start')
    call make_plan(model%mechanism, model%problem%partition, own_start%q, plan, start, err, planning_settings_type(in_space=.true.))
    call tester%no_error(err, 'the plan in space')
    call find_equilibrium(model%mechanism, model%problem%partition, plan, start, found, err)
    call tester%no_error(err, 'the equilibrium')
  end subroutine find

  !> The number of a row under a heading.
  real(wp) function entry(columns, row, name)
    type(columns_type), intent(in) :: columns   !< of the table
    real(wp), intent(in) :: row(:)              !< (columns)
    character(len=*), intent(in) :: name        !< heading
    integer :: i

    entry = huge(entry)
    do i = 1, columns%count
      if (columns%names(i)%text == name) entry = row(i)
    end do
  end function entry

  !> The spring, whose force is part of that in the pair, carries the weight, and deviations shrink as the damper tells.
  subroutine equilibria(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(model_type) :: model
    type(equilibrium_type) :: found
    type(columns_type) :: columns
    type(error_type), allocatable :: err
    real(wp), allocatable :: rows(:, :)
    integer :: i

    call find(tester, model, found)
    columns = columns_of_equilibria(model)
    call rows_of_equilibria(model, columns, [found], rows, err)
    call tester%no_error(err, 'the rows')
    call tester%is_true(all(shape(rows) == [columns%count, 1]) .and. columns%forces() == 6, 'one row with six forces')
    call tester%near(entry(columns, rows(:, 1), 'equilibrium'), 1.0_wp, 0.0_wp, 'its number')
    call tester%near(entry(columns, rows(:, 1), 'q1'), rest + weight/stiffness, tol, 'the place of the mass')
    call tester%near(entry(columns, rows(:, 1), 'stable'), 1.0_wp, 0.0_wp, 'stable')
    call tester%near(entry(columns, rows(:, 1), 'growth'), -damping/(2.0_wp*mass), tol, 'the decay')
    do i = columns%motion + 1, columns%motion + 6
      call tester%near(rows(i, 1), merge(-weight, 0.0_wp, i == columns%motion + 3), tol, 'the pair passes the weight')
    end do
  end subroutine equilibria

  !> Two roots that are conjugate: their sum is -c/m, and their product k/m.
  subroutine modes(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    real(wp), parameter :: omega = sqrt(stiffness/mass), ratio = damping/(2.0_wp*sqrt(stiffness*mass))
    type(model_type) :: model
    type(equilibrium_type) :: found
    type(columns_type) :: columns
    real(wp), allocatable :: rows(:, :)
    complex(wp) :: root, amplitude

    call find(tester, model, found)
    call tester%near(found%inertia(1, 1), mass, tol, 'the inertia')
    call tester%near(found%damping(1, 1), damping, tol*stiffness, 'the damping')
    call tester%near(found%stiffness(1, 1), stiffness, tol*stiffness, 'the stiffness')
    columns = columns_of_modes(model%mechanism)
    call rows_of_modes(found, rows)
    call tester%is_true(all(shape(rows) == [columns%count, 1]), 'one mode of one mass')
    root = cmplx(entry(columns, rows(:, 1), 'eigenvalue.re'), entry(columns, rows(:, 1), 'eigenvalue.im'), wp)
    call tester%near(2.0_wp*real(root, wp), -damping/mass, tol, 'the sum of the roots')
    call tester%near(abs(root)**2, stiffness/mass, 10.0_wp*tol, 'their product')
    call tester%near(entry(columns, rows(:, 1), 'frequency'), omega*sqrt(1.0_wp - ratio**2)/(2.0_wp*pi), tol, 'the frequency')
    call tester%near(entry(columns, rows(:, 1), 'damping'), ratio, tol, 'a fifth of the critical damping')
    amplitude = cmplx(entry(columns, rows(:, 1), 'q1.re'), entry(columns, rows(:, 1), 'q1.im'), wp)
    call tester%near(abs(amplitude), 1.0_wp, tol, 'the amplitude of the largest coordinate is one')
  end subroutine modes
end module test_equilibrium_rows
