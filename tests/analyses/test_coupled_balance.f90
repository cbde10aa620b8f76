!> The balance of clusters with couplings: regular in all positions but the first, with the wrenches of least norm.
module test_coupled_balance
  use mech9_program_kind, only: kinematics
  use mech9_kinds, only: wp
  use mech9_error, only: error_type
  use mech9_source, only: source_from_text
  use mech9_document, only: document_type
  use mech9_diagnostics, only: diagnostics_type
  use mech9_parser, only: parse_document
  use mech9_reader, only: read_model
  use mech9_model, only: model_type
  use mech9_plan, only: plan_type
  use mech9_state, only: state_type
  use mech9_driven_simulation, only: driven_simulation_type, new_driven_simulation, assemble_driven
  use mech9_reaction_plan, only: reaction_plan_type, make_reaction_plan
  use mech9_reactions, only: reactions_type, new_reactions, find_reactions
  use mech9_testing, only: tester_type
  implicit none
  private
  public :: run

  !> A spatial chain that turns, slides and screws, between two balls; a gear and a rack move wheels beside it.
  character(len=*), parameter :: chain = &
    "&mechanism /"//new_line('a')// &
    "&structure cq=1 /"//new_line('a')// &
    "&pair coordinate=1, links=1,2, kind='revolute', axis=0,0,1 /"//new_line('a')// &
    "&pair coordinates=2,3,4, links=2,3, kind='spherical', point=0.2,0,0 /"//new_line('a')// &
    "&pair coordinates=5,6, links=3,4, kind='universal', point=0.9,0.3,0.5, axis=0,1,0.2, moving_axis=1,0,0 /"//new_line('a')// &
    "&pair coordinate=7, links=1,4, kind='prismatic', axis=1,0.3,0.2, point=0.9,0.3,0.5 /"//new_line('a')// &
    "&pair coordinate=8, links=1,5, kind='revolute', axis=0.2,1,0, point=0,1,0 /"//new_line('a')// &
    "&pair coordinate=9, links=5,6, kind='revolute', axis=0.7,1,0, point=0,1,0.4 /"//new_line('a')// &
    "&coupling kind='rack', coordinates=8,7, radius=0.05 /"//new_line('a')// &
    "&coupling kind='gear', coordinates=8,9, ratio=1.5 /"//new_line('a')// &
    "&drive coordinate=1, kind='polynomial', coefficients=0,1,0.4 /"//new_line('a')// &
    "&body link=3, mass=1.5, centre=0.5,0.1,0.2, inertia=0.1,0.2,0.3,0,0,0 /"//new_line('a')// &
    "&body link=6, mass=0.7, centre=0.1,1,0.5, inertia=0.1,0.2,0.3,0,0,0 /"//new_line('a')// &
    "&gravity acceleration=1,2,-9.81 /"//new_line('a')// &
    "&time end=1, intervals=20 /"//new_line('a')

contains

  !> Run the cases of this suite.
  subroutine run(tester)
    type(tester_type), intent(inout) :: tester   !< selects cases and counts their checks

    if (tester%runs('decided_once')) call decided_once(tester)
  end subroutine run

  !> The wrenches of two objects, one of which has not met any position before and takes singular values, are the same.
  subroutine decided_once(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(document_type) :: document
    type(diagnostics_type) :: diagnostics
    type(model_type), target :: model
    type(plan_type) :: first_plan
    type(state_type) :: start
    type(driven_simulation_type), target :: simulation
    type(plan_type), pointer :: plan
    type(state_type), pointer :: state
    type(reaction_plan_type) :: reaction_plan
    type(reactions_type) :: reactions, fresh
    type(error_type), allocatable :: err
    real(wp) :: scale
    integer :: i
    logical :: regular

    call parse_document(source_from_text('text', chain), document, diagnostics)
    call read_model(document, kinematics, model, diagnostics)
    call tester%is_true(.not. diagnostics%failed(), 'the text is sound')
    call assemble_driven(model, first_plan, start, err)
    call tester%no_error(err, 'the chain closes')
    if (allocated(err)) return
    call new_driven_simulation(model, first_plan, start, simulation, .true.)
    call simulation%start(err)
    call tester%no_error(err, 'the motion begins')
    call simulation%present(plan, state)
    call make_reaction_plan(model%mechanism, plan, reaction_plan)
    call tester%is_true(size(reaction_plan%clusters) == 1, 'couplings join all chains')
    reactions = new_reactions(plan, reaction_plan)
    do i = 0, model%request%time%intervals
      if (i > 0) call simulation%advance(model%request%time%time(i), err)
      call tester%no_error(err, 'the motion goes on')
      fresh = new_reactions(plan, reaction_plan)
      call find_reactions(model%mechanism, plan, reaction_plan, state, fresh, err)
      call tester%no_error(err, 'singular values give the forces')
      if (i > 0) then
        call reactions%balances(1)%set_position(reaction_plan%clusters(1), fresh%links%geometry, reaction_plan, &
                                                reaction_plan%length, regular)
        call tester%is_true(regular, 'the equations are regular after the first position')
      end if
      call find_reactions(model%mechanism, plan, reaction_plan, state, reactions, err)
      call tester%no_error(err, 'factors give the forces')
      call tester%is_true(count(reactions%balances(1)%stands) == 2, 'each coupling holds a coordinate')
      scale = max(maxval(abs(fresh%force)), maxval(abs(fresh%moment)))
      ! both leave round-off of the wrenches times the conditioning of the chain, some hundreds
      call tester%near(maxval(abs(reactions%force - fresh%force))/scale, 0.0_wp, 1.0e-12_wp, 'the forces have the least norm')
      call tester%near(maxval(abs(reactions%moment - fresh%moment))/scale, 0.0_wp, 1.0e-12_wp, 'and so have the moments')
    end do
    call simulation%close()
  end subroutine decided_once
end module test_coupled_balance
