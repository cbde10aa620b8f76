!> The plan in words, for --plan and --verbose: the computations, and those left out with the reason.
module mech9_plan_text
  use mech9_named_words, only: with_names, named_list
  use mech9_kinds, only: wp
  use mech9_text, only: to_text
  use mech9_counted, only: counted
  use mech9_screw, only: split_space
  use mech9_mechanism, only: mechanism_type
  use mech9_model, only: model_type
  use mech9_part_names, only: part_names_type
  use mech9_explanation, only: explain_failure
  use mech9_structure, only: structure_type
  use mech9_plan, only: plan_type, block_type, closure_type, step_type
  use mech9_requested, only: requested_type, requested_blocks, requested_by_results
  use mech9_lagrange_types, only: dynamics_plan_type
  use mech9_dynamics_plan, only: make_dynamics_plan
  use mech9_structure_text, only: print_marked
  use mech9_joint_words, only: shown_of, link_name, joint_name
  implicit none
  private
  public :: print_plan_of_results, print_plan

  !> Significant digits of directions.
  integer, parameter :: digits_shown = 6

contains

  !> Write the blocks in order, each with its chains, unknowns, equations and rank, and the computations left out.
  subroutine print_plan(unit, mechanism, plan, requested)
    integer, intent(in) :: unit                    !< Fortran unit to write to
    type(mechanism_type), intent(in) :: mechanism  !< the mechanism
    type(plan_type), intent(in) :: plan            !< the plan of the whole mechanism
    type(requested_type), intent(in) :: requested  !< the quantities that the run records
    logical :: needed(size(plan%blocks))
    integer :: b, i

    call print_arithmetic(unit, mechanism%names, plan)
    needed = requested_blocks(plan, requested)
    do b = 1, size(plan%blocks)
      call print_block(unit, mechanism%structure, mechanism%names, plan, plan%blocks(b), b, needed(b))
    end do
    if (requested%derivatives == 1) write (unit, '(a)') 'accelerations left out: none are recorded'
    if (requested%derivatives == 0) write (unit, '(a)') &
      'accelerations left out: none are recorded, and rates only serve to keep to the branch'
    do i = 1, plan%n_coordinates
      if (mechanism%pairs(i)%pair%user_calls() > 1) write (unit, '(a)') with_names(mechanism%names, &
        'pair '//to_text(i)//': the user procedure in plain values is called '// &
        to_text(mechanism%pairs(i)%pair%user_calls())//' times a position or more, for its derivatives')
    end do
    if (size(mechanism%bodies) > 0) call print_dynamics_plan(unit, mechanism, plan)
  end subroutine print_plan

  !> Write the plan, as print_plan does, for the results that a model requests.
  subroutine print_plan_of_results(unit, model, plan, with_pictures)
    integer, intent(in) :: unit               !< Fortran unit to write to
    type(model_type), intent(in) :: model     !< the model
    type(plan_type), intent(in) :: plan       !< its plan
    logical, intent(in) :: with_pictures      !< the motion of all links is requested, too

    call print_plan(unit, model%mechanism, plan, requested_by_results(model%mechanism, model%request%output, with_pictures))
  end subroutine print_plan_of_results

  !> Write one block: its links, equations and chains.
  subroutine print_block(unit, structure, names, plan, block, number, is_needed)
    integer, intent(in) :: unit            !< Fortran unit to write to
    type(structure_type), intent(in) :: structure  !< links and joints
    type(part_names_type), intent(in) :: names     !< of links and pairs
    type(plan_type), intent(in) :: plan    !< the plan of the mechanism
    type(block_type), intent(in) :: block  !< the block
    integer, intent(in) :: number          !< number of the block
    logical, intent(in) :: is_needed       !< whether a result or load depends on the block
    integer :: c, i

    write (unit, '(a)') with_names(names, 'block '//to_text(number)//': links '// &
      to_text(shown_of(structure, pack(plan%steps(block%first_step:block%last_step)%link, &
                                       [(.not. any(plan%closures(block%first_closure:block%last_closure)%closing == i), &
                                         i=block%first_step, block%last_step)]))))
    if (.not. is_needed) write (unit, '(a)') '  left out: no result or load depends on it'
    if (size(block%unknowns) > 0) then
      write (unit, '(a)') '  solved for: '// &
        named_list(names%coordinates, block%coordinates(:size(block%unknowns)), size(block%unknowns))//' from '// &
        counted(block%equations, 'equation')//' of rank '//to_text(size(block%unknowns))
      if (block%is_constant) write (unit, '(a)') '  its Jacobian is constant, since nothing turns: factorized once'
    else
      write (unit, '(a)') '  nothing to solve: an open chain'
    end if
    if (block%arithmetic > 1) call print_plane(unit, structure, names, plan, block)
    do c = block%first_closure, block%last_closure
      associate (closure => plan%closures(c))
        if (closure%coupling > 0) then
          call print_coupling(unit, names, plan, closure%coupling)
          cycle
        end if
        write (unit, '(a)') with_names(names, '  chain '//to_text(closure%chain)//' closes '// &
          place_of_closing(structure, plan%steps(closure%closing))//'; its motions span '//counted(closure%rank, 'dimension'))
        call print_basis(unit, structure, names, plan, closure)
      end associate
    end do
  end subroutine print_block

  !> The place at which a chain closes: "on link 4 through coordinate 7", or "in the spherical joint of coordinates 4, 5, 6".
  pure function place_of_closing(structure, step) result(words)
    type(structure_type), intent(in) :: structure  !< links and joints
    type(step_type), intent(in) :: step            !< the last step of the chain
    character(len=:), allocatable :: words
    integer :: j

    j = structure%joint_of_link(step%link)
    if (j == 0) then
      words = 'on link '//to_text(step%link)//' through coordinate '//to_text(step%coordinate)
    else
      words = 'in the '//trim(joint_name(structure%joints(j)))
    end if
  end function place_of_closing

  !> Write the equation of a coupling in words.
  subroutine print_coupling(unit, names, plan, number)
    integer, intent(in) :: unit            !< Fortran unit to write to
    type(part_names_type), intent(in) :: names  !< of links and pairs
    type(plan_type), intent(in) :: plan    !< the plan of the mechanism
    integer, intent(in) :: number          !< of the coupling

    associate (coupling => plan%couplings(number)%coupling)
      write (unit, '(a)') with_names(names, '  coupling '//to_text(number)//' ('//trim(coupling%kind_name())// &
                                     ') of coordinates '//to_text(coupling%coordinates))
    end associate
  end subroutine print_coupling

  !> Write the plane of a planar block of a spatial mechanism.
  subroutine print_plane(unit, structure, names, plan, block)
    integer, intent(in) :: unit            !< Fortran unit to write to
    type(structure_type), intent(in) :: structure  !< links and joints
    type(part_names_type), intent(in) :: names     !< of links and pairs
    type(plan_type), intent(in) :: plan    !< the plan of the mechanism
    type(block_type), intent(in) :: block  !< the block
    integer :: link

    associate (plane => plan%planar%planes(plan%planar%plane_of(block%last_step)))
      link = 1
      if (plane%base > 0) link = plan%steps(plane%base)%link
      write (unit, '(a)') with_names(names, '  planar arithmetic: all its pairs turn about or slide across the direction '// &
        direction_in_words(matmul(plane%axes(:, 3), plan%link_in_frame(link)%r))//' of '//trim(link_name(structure, link)))
    end associate
  end subroutine print_plane

  !> Write the directions in which the links of a chain can move. An example is "turning about (0, 0, 1), sliding along
  !> (1, 0, 0), (0, 1, 0) of link 1". Write nothing where all six motions are possible.
  subroutine print_basis(unit, structure, names, plan, closure)
    integer, intent(in) :: unit                !< Fortran unit to write to
    type(structure_type), intent(in) :: structure  !< links and joints
    type(part_names_type), intent(in) :: names     !< of links and pairs
    type(plan_type), intent(in) :: plan        !< the plan of the mechanism
    type(closure_type), intent(in) :: closure  !< the closed chain
    character(len=:), allocatable :: turning, sliding
    real(wp) :: turns(3, 3), slides(3, 3), to_link(3, 3)
    integer :: n_turns, n_slides, link
    logical :: screws

    link = 1
    if (closure%base > 0) link = plan%steps(closure%base)%link
    ! directions are known in the axes of a link only for its first frame
    if (closure%rank == 6 .or. plan%frame_of(link) /= closure%base) return
    to_link = transpose(plan%link_in_frame(link)%r)
    call split_space(closure%rows(:, :closure%rank), turns, n_turns, slides, n_slides, screws)
    turning = ''
    if (n_turns > 0) turning = trim(merge('screwing', 'turning ', screws))//' about '// &
                               directions_in_words(matmul(to_link, turns(:, :n_turns)))
    sliding = ''
    if (n_slides > 0) sliding = 'sliding along '//directions_in_words(matmul(to_link, slides(:, :n_slides)))
    if (n_turns > 0 .and. n_slides > 0) turning = turning//', '
    write (unit, '(4x,a)') with_names(names, turning//sliding//' of '//trim(link_name(structure, link)))
  end subroutine print_basis

  !> Directions in words: "(1, 0, 0), (0, 1, 0)", or "all directions".
  pure function directions_in_words(directions) result(words)
    real(wp), intent(in) :: directions(:, :)  !< (3,n) directions of length 1, in the axes of a link
    character(len=:), allocatable :: words
    integer :: i

    words = ''
    do i = 1, size(directions, 2)
      if (i > 1) words = words//', '
      words = words//direction_in_words(directions(:, i))
    end do
    if (size(directions, 2) == 3) words = 'all directions'
  end function directions_in_words

  !> A direction in words: "(0, 0, 1)"; round-off is shown as zero.
  pure function direction_in_words(direction) result(words)
    real(wp), intent(in) :: direction(3)  !< direction in the axes of a link, of length 1
    character(len=:), allocatable :: words
    real(wp) :: clean(3)

    clean = merge(0.0_wp, direction, abs(direction) < 10.0_wp**(-digits_shown))
    words = '('//to_text(clean(1), digits_shown)//', '//to_text(clean(2), digits_shown)//', '// &
            to_text(clean(3), digits_shown)//')'
  end function direction_in_words

  !> Write whether the arithmetic is planar or spatial, and why.
  subroutine print_arithmetic(unit, names, plan)
    integer, intent(in) :: unit          !< Fortran unit to write to
    type(part_names_type), intent(in) :: names  !< of links and pairs
    type(plan_type), intent(in) :: plan  !< the plan of the mechanism
    character(len=:), allocatable :: reason

    if (plan%planar%used) then
      write (unit, '(a)') 'planar arithmetic: all pairs turn about or slide across the direction '// &
        direction_in_words(plan%planar%axes(:, 3))
    else if (allocated(plan%planar%why_not)) then
      reason = ''
      call explain_failure(plan%planar%why_not, reason)
      write (unit, '(a)') with_names(names, 'spatial arithmetic: '//reason)
    end if
  end subroutine print_arithmetic

  !> Write which terms Lagrange's equations leave out.
  subroutine print_dynamics_plan(unit, mechanism, plan)
    integer, intent(in) :: unit                    !< Fortran unit to write to
    type(mechanism_type), intent(in) :: mechanism  !< the mechanism
    type(plan_type), intent(in) :: plan            !< the plan of the mechanism
    type(dynamics_plan_type) :: dynamics
    character(len=1), allocatable :: unnamed(:)
    logical :: has_mass(plan%n_links), idle(plan%n_links), without_effect(size(mechanism%loads))
    integer :: i

    call make_dynamics_plan(mechanism, plan, dynamics)
    if (dynamics%articulated) write (unit, '(a)') &
      'accelerations by articulated bodies: coefficients of motion are found at the start only'
    has_mass = .false.
    do i = 1, size(dynamics%bodies)
      has_mass(dynamics%bodies(i)%link) = .true.
    end do
    ! link 1 is fixed and needs no mass
    has_mass(1) = .true.
    idle = .not. dynamics%carries(plan%frame_of)
    idle(1) = .false.
    has_mass(mechanism%structure%shown_links() + 1:) = .true.
    idle(mechanism%structure%shown_links() + 1:) = .false.
    call print_marked(unit, .not. has_mass, 'without mass, no terms of inertia: links ', mechanism%names%links)
    call print_marked(unit, idle, 'no mass, load or later chain depends on their motion, left out: links ', mechanism%names%links)
    without_effect = .true.
    without_effect(dynamics%acting) = .false.
    call print_marked(unit, without_effect, 'zero, or on link 1 alone, left out: loads ', unnamed)
  end subroutine print_dynamics_plan
end module mech9_plan_text
