!> Words for numbers of failures: names of chains and joints, and sentences about choices, couplings, integrations and
!> derivatives.
module test_sentences
  use mech9_program_kind, only: dynamics
  use mech9_kinds, only: wp
  use mech9_block_names, only: chain_names, names_with_lines, words_of_block
  use mech9_choice_words, only: explain_choice
  use mech9_compound_joint, only: compound_joint_type
  use mech9_coupling_words, only: explain_coupling
  use mech9_failure, only: failure_type, integration_stop_type, failure_off_table
  use mech9_assembly_failures, only: failure_wrong_choice, failure_open_coupling, failure_open_chain
  use mech9_ode_failures, only: failure_many_steps, failure_relative_tolerance, failure_unknown_method
  use mech9_sensitivity_failures, only: failure_singular_sensitivity
  use mech9_integration_words, only: explain_settings, explain_step, explain_stop
  use mech9_joint_words, only: joint_name, pair_name, link_name
  use mech9_model, only: model_type
  use mech9_sensitivity_words, only: explain_sensitivity
  use mech9_small_models, only: eol
  use mech9_text_models, only: model_from_text
  use mech9_testing, only: tester_type
  implicit none
  private
  public :: run

contains

  !> Run the cases of this suite.
  subroutine run(tester)
    type(tester_type), intent(inout) :: tester   !< selects cases and counts their checks

    if (tester%runs('chains')) call chains(tester)
    if (tester%runs('lines')) call lines(tester)
    if (tester%runs('joints')) call joints(tester)
    if (tester%runs('choices')) call choices(tester)
    if (tester%runs('couplings')) call couplings(tester)
    if (tester%runs('integrations')) call integrations(tester)
    if (tester%runs('other_kinds')) call other_kinds(tester)
  end subroutine run

  subroutine says(tester, text, expected)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    character(len=*), intent(in) :: text         !< words
    character(len=*), intent(in) :: expected     !< the right ones

    call tester%is_true(text == expected .and. len(text) == len(expected), 'words: "'//text//'"')
  end subroutine says

  subroutine chains(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    integer :: none(0)

    call says(tester, chain_names(none), 'an open chain')
    call says(tester, trim(chain_names([2])), 'closed chain 2')
    call says(tester, trim(chain_names([1, 3])), 'closed chains 1, 3 together')
    call says(tester, trim(chain_names([-1])), 'coupling 1')
    call says(tester, trim(chain_names([-1, -4])), 'couplings 1, 4 together')
    call says(tester, trim(chain_names([2, -1])), 'closed chain 2 and coupling 1 together')
    call says(tester, trim(words_of_block([2], [7, 4, 6])), 'closed chain 2 (coordinates 4, 6, 7)')
  end subroutine chains

  !> Closed chains come before couplings, each by its number.
  subroutine lines(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    character(len=:), allocatable :: names

    call names_with_lines([-2, -1], [5, 4], names)
    call says(tester, names, 'couplings 1 (line 4) and 2 (line 5)')
    call names_with_lines([-2, 1], [7, 0], names)
    call says(tester, names, 'closed chain 1 and coupling 2 (line 7)')
    call names_with_lines([3, -1, 2], [0, 0, 0], names)
    call says(tester, names, 'closed chains 2, 3 and coupling 1')
    call names_with_lines([-3], [9], names)
    call says(tester, names, 'coupling 3 (line 9)')
  end subroutine lines

  !> Links that a joint has for itself are called by the name of the joint.
  subroutine joints(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(compound_joint_type) :: joint
    type(model_type) :: model

    joint%kind = 'universal'
    joint%freedoms = 2
    joint%numbers(:2) = [4, 5]
    call says(tester, trim(joint_name(joint)), 'universal joint of coordinates 4, 5')
    call model_from_text(tester, '&mechanism links=3, coordinates=4 /'//eol//'&structure cq=1,2,3,4 /'//eol// &
      "&pair coordinate=1, links=1,2, kind='revolute', axis=0,0,1 /"//eol// &
      "&pair coordinates=2,3,4, links=2,3, kind='spherical' /"//eol, dynamics, model)
    associate (structure => model%mechanism%structure)
      call says(tester, trim(pair_name(structure, 1)), 'pair 1')
      call says(tester, trim(pair_name(structure, 3)), 'the spherical joint of coordinates 2, 3, 4 between links 2 and 3')
      call says(tester, trim(link_name(structure, 3)), 'link 3')
      call says(tester, trim(link_name(structure, 4)), 'the spherical joint of coordinates 2, 3, 4 between links 2 and 3')
    end associate
  end subroutine joints

  !> A failure of the choice among four coordinates, of which one can be independent.
  subroutine choices(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks

    call choose([integer ::], 'the mobility is 1 (4 coordinates, rank 3), and no coordinate is independent; 1 more of the '// &
                'coordinates 1, 2, 3 must be independent (cq); cq = 1 would serve; instead of 1 also 2, 3; never: 4, which '// &
                'cannot move')
    call choose([1, 2], 'the mobility is 1 (4 coordinates, rank 3), and 2 coordinates are independent; take 1 of the '// &
                'coordinates 1, 2 off the independent ones (cq); cq = 1 would serve; instead of 1 also 2, 3; never: 4, which '// &
                'cannot move')
  contains
    subroutine choose(wanted, expected)
      integer, intent(in) :: wanted(:)           !< the independent coordinates of the data file
      character(len=*), intent(in) :: expected   !< the right sentence
      type(failure_type) :: failure
      character(len=:), allocatable :: text

      failure%kind = failure_wrong_choice
      failure%number = 4
      failure%coordinates = wanted
      failure%others = [1]
      failure%idle = [4]
      failure%replaces = reshape([.true., .true., .true., .false.], [4, 1])
      call explain_choice(failure, text)
      call says(tester, text, expected)
    end subroutine choose
  end subroutine choices

  subroutine couplings(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(failure_type) :: failure
    character(len=:), allocatable :: text

    failure%kind = failure_off_table
    failure%coordinates = [3]
    failure%chains = [-2]
    failure%lines = [12]
    failure%t = 0.5_wp
    failure%values = reshape([95.0_wp, 0.0_wp, 90.0_wp], [3, 1])
    failure%name = 'deg'
    call explain_coupling(failure, text)
    call tester%is_true(index(text, 'coordinate 3 comes to an end of the table of coupling 2 at t = 0.5 s: it would go on '// &
                              'to 95 deg, and the table leads from 0 to 90 deg. ') == 1, 'the end of a table: '//text)
    failure%kind = failure_open_coupling
    failure%chains = [-1, -2]
    failure%lines = [4, 5]
    call explain_coupling(failure, text)
    call tester%is_true(index(text, 'couplings 1 (line 4) and 2 (line 5) contradict each other') > 0, 'two couplings: '//text)
  end subroutine couplings

  subroutine integrations(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(failure_type) :: failure
    type(integration_stop_type) :: stopped
    character(len=:), allocatable :: text

    failure%kind = failure_many_steps
    failure%limit = 1000
    failure%t = 1.25_wp
    failure%t_stop = 2.0_wp
    failure%step = 1.0e-3_wp
    call explain_step(failure, text)
    call tester%is_true(index(text, 'the integration cannot go on from t = 1.25 s: 1000 steps were not enough to come to t = 2 s') &
                        == 1, 'many steps: '//text)
    failure%kind = failure_relative_tolerance
    failure%tolerance = 3.0_wp
    call explain_settings(failure, text)
    call says(tester, text, 'the relative tolerance must be between 0 and 1; it is 3')
    failure%kind = failure_unknown_method
    failure%name = 'bfd'
    call explain_settings(failure, text)
    call tester%is_true(index(text, "unknown method of integration 'bfd'; did you mean 'bdf'? There are: ") == 1, &
                        'a method: '//text)
    stopped%t = 1.0_wp
    stopped%t_failed = 1.5_wp
    text = 'the load is infinite'
    call explain_stop(stopped, text)
    call says(tester, text, 'the integration cannot go on from t = 1 s: at t = 1.5 s: the load is infinite')
  end subroutine integrations

  !> A procedure leaves a message as it is where the kind is not its own.
  subroutine other_kinds(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(failure_type) :: failure
    character(len=:), allocatable :: text

    failure%kind = failure_open_chain
    text = 'before'
    call explain_settings(failure, text)
    call explain_step(failure, text)
    call explain_coupling(failure, text)
    call explain_sensitivity(failure, text)
    call says(tester, text, 'before')
    failure%kind = failure_singular_sensitivity
    failure%chains = [1]
    failure%t = 0.1_wp
    call explain_sensitivity(failure, text)
    call tester%is_true(index(text, 'derivatives by the parameters do not exist at t = 0.1 s, in a singular position of closed '// &
                              'chain 1. ') == 1, 'derivatives: '//text)
  end subroutine other_kinds
end module test_sentences
