!> Structure and plan in words, for --structure, --check and --plan. Uses text, structure, mechanism, plan.
module mech9_plan_text
  use mech9_text, only: to_text
  use mech9_structural_vectors, only: structural_vectors_type
  use mech9_mechanism, only: mechanism_type
  use mech9_plan, only: plan_type, block_type
  implicit none
  private
  public :: print_structure, print_mobility, print_plan

contains

  !> The structural vectors, a line each: "nrg = 1 2 3 ...".
  subroutine print_structure(unit, vectors)
    integer, intent(in) :: unit
    type(structural_vectors_type), intent(in) :: vectors

    write (unit, '(2a)') 'nrg = ', to_text(vectors%nrg, ' ')
    write (unit, '(2a)') 'nws = ', to_text(vectors%nws, ' ')
    write (unit, '(2a)') 'rdw = ', to_text(vectors%rdw, ' ')
    write (unit, '(2a)') 'nrw = ', to_text(vectors%nrw, ' ')
  end subroutine print_structure

  !> Counts, mobility and redundancy.
  subroutine print_mobility(unit, plan)
    integer, intent(in) :: unit
    type(plan_type), intent(in) :: plan
    integer :: b, unknowns, equations

    unknowns = 0
    equations = 0
    do b = 1, size(plan%blocks)
      unknowns = unknowns + size(plan%blocks(b)%unknowns)
      equations = equations + plan%blocks(b)%equations
    end do
    write (unit, '(a)') to_text(plan%n_links)//' links, '//to_text(plan%n_coordinates)//' coordinates, '// &
      to_text(size(plan%closures))//' closed chains'
    write (unit, '(a)') 'independent: '//to_text(plan%independent)
    write (unit, '(a)') 'mobility '//to_text(plan%n_coordinates - unknowns)//' = '// &
      to_text(plan%n_coordinates)//' coordinates - rank '//to_text(unknowns)
    if (equations > unknowns) write (unit, '(a)') 'redundant equations: '//to_text(equations - unknowns)
  end subroutine print_mobility

  !> The blocks in order, each with its chains, unknowns, equations and rank.
  subroutine print_plan(unit, mechanism, plan)
    integer, intent(in) :: unit
    type(mechanism_type), intent(in) :: mechanism
    type(plan_type), intent(in) :: plan
    integer :: b, c, i

    do b = 1, size(plan%blocks)
      associate (block => plan%blocks(b))
        write (unit, '(a)') 'block '//to_text(b)//': links '// &
          to_text(plan%steps(block%first_step:block%last_step)%link)
        if (size(block%unknowns) > 0) then
          write (unit, '(a)') '  solved for: '// &
            to_text([(plan%steps(block%unknowns(i))%coordinate, i=1, size(block%unknowns))])//' from '// &
            to_text(block%equations)//' equations'
        else
          write (unit, '(a)') '  nothing to solve: an open chain'
        end if
        do c = block%first_closure, block%last_closure
          associate (closure => plan%closures(c))
            write (unit, '(a)') '  chain '//to_text(c)//' closes on link '// &
              to_text(plan%steps(closure%closing)%link)//' through coordinate '// &
              to_text(plan%steps(closure%closing)%coordinate)//'; its motions span '//to_text(closure%rank)// &
              ' dimensions'
          end associate
        end do
      end associate
    end do
    do i = 1, plan%n_coordinates
      if (mechanism%pairs(i)%pair%user_calls() > 1) write (unit, '(a)') 'pair '//to_text(i)// &
        ': the user procedure in plain values is called '//to_text(mechanism%pairs(i)%pair%user_calls())// &
        ' times a position or more, for its derivatives'
    end do
  end subroutine print_plan
end module mech9_plan_text
