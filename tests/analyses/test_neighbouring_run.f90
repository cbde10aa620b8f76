!> Runs of planar designs that are found beside a known run: their values and derivatives are those of runs that are followed from their
!> starts and of the derivatives of chains in space. A run that is found where the one that is followed does not come to its end would be
!> a design with a dead point that wins. The cost is bounded by the number of positions that are closed.
module test_neighbouring_run
  use mech9_program_kind, only: kinematics
  use mech9_kinds, only: wp
  use mech9_error, only: error_type
  use mech9_random, only: random_type
  use mech9_document, only: document_type
  use mech9_diagnostics, only: diagnostics_type
  use mech9_parser, only: read_document
  use mech9_reader, only: read_model
  use mech9_varied_document, only: varied_document_type, new_varied_document
  use mech9_model, only: model_type
  use mech9_plan, only: plan_type
  use mech9_state, only: state_type
  use mech9_driven_simulation, only: assemble_driven
  use mech9_bounded_least_squares, only: residual_values_type
  use mech9_synthesis, only: synthesis_type, new_synthesis
  use mech9_design_space, only: design_type, new_design
  use mech9_open_position, only: open_position_type, new_open_position
  use mech9_free_times, only: choose_pivots, gaps_of
  use mech9_exact_fit, only: exact_fit_type, new_exact_fit, begin_at
  use mech9_testing, only: tester_type
  implicit none
  private
  public :: run

contains

  !> Run the cases of this suite.
  subroutine run(test)
    type(tester_type), intent(inout) :: test   !< selects cases and counts their checks

    ! eighteen targets at intervals of 20 degrees, and one position more in each interval, since drives move 0.25 rad at most
    if (test%runs('timed_path')) call check(test, 'timed_path', 200, 40)
    if (test%runs('five_timed_points')) call check(test, 'five_timed_points', 200)
    if (test%runs('straight_line')) call check(test, 'straight_line', 50)
    if (test%runs('log_function')) call check(test, 'log_function', 50)
    if (test%runs('dwell_six_bar')) call check(test, 'dwell_six_bar', 50)
  end subroutine run

  !> Compare runs of designs around that of a data file.
  subroutine check(test, name, trials, most_positions)
    type(tester_type), intent(inout) :: test          !< counts the checks
    character(len=*), intent(in) :: name              !< of the example
    integer, intent(in) :: trials                     !< designs of each distance
    integer, intent(in), optional :: most_positions   !< closed for a run beside a known one; not bounded unless given
    type(varied_document_type), target :: variable
    type(synthesis_type), target :: synthesis
    type(document_type) :: document
    type(diagnostics_type) :: diagnostics
    type(model_type) :: model
    type(plan_type) :: plan
    type(state_type) :: start
    type(error_type), allocatable :: err

    call read_document(test%tree//'/examples/'//name//'/'//name//'.nml', document, diagnostics)
    call read_model(document, kinematics, model, diagnostics)
    call test%is_true(.not. diagnostics%failed(), name//' is read')
    if (diagnostics%failed()) return
    call new_varied_document(document, diagnostics%sources, kinematics, variable)
    call assemble_driven(model, plan, start, err)
    if (.not. allocated(err)) call new_synthesis(variable, model, plan, synthesis, err)
    call test%no_error(err, name)
    if (allocated(err)) return
    call check_designs(test, name, synthesis, start%q, trials, most_positions)
  end subroutine check

  !> Compare runs of designs around the present one.
  subroutine check_designs(test, name, synthesis, q, trials, most_positions)
    type(tester_type), intent(inout) :: test                 !< counts the checks
    character(len=*), intent(in) :: name                     !< of the example
    type(synthesis_type), intent(in), target :: synthesis    !< prepared
    real(wp), intent(in) :: q(:)                             !< (M) coordinates at the start [rad, m]
    integer, intent(in) :: trials                            !< designs of each distance
    integer, intent(in), optional :: most_positions          !< closed for a run beside a known one; not bounded unless given
    !> Distances of designs, as parts of the parameters.
    real(wp), parameter :: distances(5) = [1.0e-6_wp, 1.0e-3_wp, 3.0e-2_wp, 0.2_wp, 1.0_wp]
    type(random_type) :: random
    type(design_type) :: design
    type(open_position_type) :: position
    type(exact_fit_type) :: near, followed
    type(residual_values_type) :: a, b
    real(wp), allocatable :: x(:), sizes(:), trial(:), y(:, :), parts(:)
    real(wp) :: largest
    logical :: has_near, has_followed
    integer :: i, k, p, found, refused, closed

    call new_design(synthesis%space, design)
    call new_open_position(design, position)
    call new_exact_fit(synthesis%space, design, position, synthesis%targets, near)
    call new_exact_fit(synthesis%space, design, position, synthesis%targets, followed)
    call test%is_true(near%near%used, name//': runs can be found beside others')
    parts = [(p/(near%free%n + 1.0_wp), p=1, near%free%n)]
    call choose_pivots(parts, near%free)
    call choose_pivots(parts, followed%free)
    allocate (y(0, near%groups), a%r(near%rows, near%groups), a%by_x(near%rows, near%n, near%groups), &
              a%by_y(near%rows, 0, near%groups), source=0.0_wp)
    b = a
    associate (space => synthesis%space)
      x = [(space%values(space%varied) - space%low)/(space%high - space%low), gaps_of(parts, near%free)]
      sizes = [abs(space%values(space%varied))/(space%high - space%low), gaps_of(parts, near%free)]
    end associate
    call begin_at(q, near)
    call near%evaluate(x, y, .false., a, has_near)
    call test%is_true(has_near, name//': the design of the file moves')
    if (.not. has_near) return
    call near%evaluate(x, y, .true., a, has_near)
    call test%is_true(near%near%is_known, name//': its run is known')
    followed%near%used = .false.
    found = 0
    refused = 0
    closed = 0
    do k = 1, size(distances)
      do i = 1, trials
        trial = x
        do p = 1, size(x)
          trial(p) = min(max(x(p) + distances(k)*sizes(p)*random%symmetric(), 0.0_wp), 1.0_wp)
        end do
        near%work = 0
        near%followed = 0
        call near%evaluate(trial, y, .false., a, has_near)
        followed%q_start = near%q_start
        followed%work = 0
        call followed%evaluate(trial, y, .false., b, has_followed)
        if (.not. has_followed) refused = refused + 1
        call test%is_true(has_near .eqv. has_followed, name//': a run comes to its end')
        if (near%followed > 0 .or. .not. has_followed) cycle
        found = found + 1
        if (k == 1) closed = max(closed, int(near%work))
        largest = max(1.0e-3_wp, maxval(abs(b%r)))
        ! corrections end at 1e-9, so that errors are their squares times the least pivot's reciprocal
        call test%near(maxval(abs(a%r - b%r)), 0.0_wp, 1.0e-10_wp*largest, name//': values')
        call test%near(maxval(abs(near%q_trial - followed%q_trial)), 0.0_wp, 1.0e-9_wp, name//': coordinates at the start')
        if (mod(i, 10) > 0) cycle
        call near%evaluate(trial, y, .true., a, has_near)
        call followed%evaluate(trial, y, .true., b, has_followed)
        largest = maxval(abs(b%by_x))
        call test%near(maxval(abs(a%by_x - b%by_x)), 0.0_wp, 1.0e-9_wp*largest, name//': derivatives')
        ! back to the first design
        call begin_at(q, near)
        call near%evaluate(x, y, .false., a, has_near)
        call near%evaluate(x, y, .true., a, has_near)
      end do
    end do
    call test%is_true(found > 2*trials, name//': runs of most designs that are near are found')
    call test%is_true(refused > trials/5, name//': many designs do not come to the end of the run')
    if (present(most_positions)) call test%is_true(closed <= most_positions, name//': a run needs few positions')
  end subroutine check_designs
end module test_neighbouring_run
