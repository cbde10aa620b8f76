!> Structure and mobility in words, for --structure, --check and --plan.
module mech9_structure_text
  use mech9_kinds, only: wp
  use mech9_text, only: to_text, some_of
  use mech9_counted, only: counted
  use mech9_masks, only: numbers_of
  use mech9_structure, only: structure_type
  use mech9_mechanism, only: mechanism_type
  use mech9_part_names, only: part_names_type
  use mech9_named_words, only: with_names, named_list, named_number
  use mech9_structural_vectors, only: structural_vectors_type
  use mech9_joint_expansion, only: shown_vectors
  use mech9_plan, only: plan_type
  use mech9_partition, only: partition_type
  use mech9_model_motion, only: model_motion_type
  use mech9_document, only: document_type
  use mech9_diagnostics, only: diagnostics_type
  use mech9_reader, only: read_structure_only
  use mech9_mobility_report, only: mobility_report_type, idle_type, report_mobility
  use mech9_block_names, only: chain_names
  use mech9_joint_words, only: joint_name
  implicit none
  private
  public :: print_structure, print_structure_of, print_mobility, print_mobility_of, print_mobility_report, print_marked

  !> Most lines of one kind.
  integer, parameter :: most_lines = 40
  !> Most numbers that a list shows.
  integer, parameter :: longest_list = 24
  !> Rates below this part of a rate of one count as zero.
  real(wp), parameter :: least_share = 1.0e-9_wp

contains

  !> Write the structural vectors, one in each line: "nrg = 1 2 3 ...".
  subroutine print_structure(unit, structure, given)
    integer, intent(in) :: unit                         !< Fortran unit to write to
    type(structure_type), intent(in) :: structure       !< links and joints
    type(structural_vectors_type), intent(in) :: given  !< the structural vectors, with the chains of joints
    type(structural_vectors_type) :: vectors

    vectors = shown_vectors(structure, given)
    write (unit, '(2a)') 'nrg = ', to_text(vectors%nrg, ' ')
    write (unit, '(2a)') 'nws = ', to_text(vectors%nws, ' ')
    write (unit, '(2a)') 'rdw = ', to_text(vectors%rdw, ' ')
    write (unit, '(2a)') 'nrw = ', to_text(vectors%nrw, ' ')
  end subroutine print_structure

  !> Write the meaning of the structural vectors, one in each line, and the names of the links and pairs that they number.
  subroutine print_names_of_vectors(unit, names)
    integer, intent(in) :: unit                   !< Fortran unit to write to
    type(part_names_type), intent(in) :: names    !< of links and pairs

    write (unit, '(a)') 'The structural vectors, an element for each place in the order of computation:'
    write (unit, '(a)') '  nrg  number of the link that is reached; a chain that closes ends on a link that was reached before'
    write (unit, '(a)') '  nws  number of the coordinate of the pair that leads there; 0 where a chain starts'
    write (unit, '(a)') '  rdw  kind of that coordinate: 1 independent (and where a chain starts), 0 dependent'
    write (unit, '(a)') '  nrw  number of closed chains so far; it grows by one at the link on which a chain closes'
    call print_called(unit, 'links: ', names%links)
    call print_called(unit, 'coordinates: ', names%coordinates)
  end subroutine print_names_of_vectors

  !> Write the numbers that have names, with these; nothing where none has.
  subroutine print_called(unit, words, list)
    integer, intent(in) :: unit                               !< Fortran unit to write to
    character(len=*), intent(in) :: words                     !< text before the list
    character(len=*), allocatable, intent(in) :: list(:)      !< names by numbers; not allocated: none

    if (.not. allocated(list)) return
    write (unit, '(2a)') words, named_list(list, numbers_of(list /= ''), size(list))
  end subroutine print_called

  !> Write counts, mobility and redundancy.
  subroutine print_mobility(unit, mechanism, plan)
    integer, intent(in) :: unit                    !< Fortran unit to write to
    type(mechanism_type), intent(in) :: mechanism  !< the mechanism
    type(plan_type), intent(in) :: plan            !< the plan of the mechanism
    integer :: b, unknowns, equations

    unknowns = 0
    equations = 0
    do b = 1, size(plan%blocks)
      unknowns = unknowns + size(plan%blocks(b)%unknowns)
      equations = equations + plan%blocks(b)%equations
    end do
    call print_counts(unit, mechanism, plan)
    write (unit, '(a)') 'mobility '//to_text(plan%n_coordinates - unknowns)//' = '// &
      counted(plan%n_coordinates, 'coordinate')//' - rank '//to_text(unknowns)
    if (equations > unknowns) write (unit, '(a)') 'redundant equations: '//to_text(equations - unknowns)
  end subroutine print_mobility

  !> Write the numbers of links, coordinates and closed chains, and the independent coordinates.
  subroutine print_counts(unit, mechanism, plan)
    integer, intent(in) :: unit                    !< Fortran unit to write to
    type(mechanism_type), intent(in) :: mechanism  !< the mechanism
    type(plan_type), intent(in) :: plan            !< the plan of the mechanism

    write (unit, '(a)', advance='no') counted(mechanism%structure%shown_links(), 'link')//', '// &
      counted(plan%n_coordinates, 'coordinate')//', '//counted(size(plan%closures) - size(plan%couplings), 'closed chain')
    if (size(plan%couplings) > 0) write (unit, '(a)', advance='no') ', '//counted(size(plan%couplings), 'coupling')
    write (unit, '(a)') ''
    write (unit, '(a)') 'independent: '// &
      named_list(mechanism%names%coordinates, plan%independent, size(plan%independent))
  end subroutine print_counts

  !> Write counts, ranks, redundant equations, and which coordinates can be independent or cannot move.
  subroutine print_mobility_report(unit, mechanism, plan, report)
    integer, intent(in) :: unit                       !< Fortran unit to write to
    type(mechanism_type), intent(in) :: mechanism     !< the mechanism
    type(plan_type), intent(in) :: plan               !< the plan of the mechanism
    type(mobility_report_type), intent(in) :: report  !< mobility and ranks
    integer :: i, c

    call print_counts(unit, mechanism, plan)
    write (unit, '(a)') 'mobility by the count: '//to_text(report%by_count)//' = '//counted(plan%n_coordinates, 'coordinate')// &
      ' - '//counted(plan%n_coordinates - report%by_count - size(plan%couplings), 'dimension')//' of the chains'' motions'// &
      couplings_in_count(size(plan%couplings))
    write (unit, '(a)') 'mobility by the rank: '//to_text(report%by_rank)//' = '// &
      counted(plan%n_coordinates, 'coordinate')//' - rank '//to_text(plan%n_coordinates - report%by_rank)
    if (.not. report%general) write (unit, '(a)') 'the ranks are those of the start: no other closed position was found near it'
    call print_ranks(unit, plan, report)
    do c = 1, size(plan%closures)
      if (report%redundant(c) == 0) cycle
      if (plan%closures(c)%coupling > 0) then
        call print_repetition(unit, plan%closures(c)%chain, report%repeating(c)%chains)
      else
        write (unit, '(a)') 'closed chain '//to_text(plan%closures(c)%chain)//': '// &
          to_text(report%redundant(c))//' of its '//to_text(plan%closures(c)%rank)//' equations redundant'
      end if
    end do
    do i = 1, size(plan%independent)
      if (i <= most_lines) call print_alternatives(unit, mechanism%names, plan, report, i)
    end do
    call print_marked(unit, .not. report%moves, 'cannot move, hence not be independent: ', mechanism%names%coordinates, &
                      still_links(mechanism%structure, report%moves))
    call print_marked(unit, report%dimensions == 0, 'on no closed chain: ', mechanism%names%coordinates)
    do i = 1, size(report%idle)
      call print_idle(unit, mechanism%structure, mechanism%names, report%idle(i))
    end do
  end subroutine print_mobility_report

  !> Write mobility and ranks of an assembled motion, as print_mobility_report does.
  subroutine print_mobility_of(unit, mechanism, motion)
    integer, intent(in) :: unit                       !< Fortran unit to write to
    type(mechanism_type), intent(in) :: mechanism     !< the mechanism
    type(model_motion_type), intent(in) :: motion     !< its motion, assembled
    type(mobility_report_type) :: report

    call report_mobility(mechanism, motion%plan, motion%start, report)
    call print_mobility_report(unit, mechanism, motion%plan, report)
  end subroutine print_mobility_of

  !> Read the structure of a document, and write it; nothing where it has errors. The names of the vectors go to another unit.
  subroutine print_structure_of(unit, document, diagnostics, names_unit)
    integer, intent(in) :: unit                             !< Fortran unit to write to
    type(document_type), intent(in) :: document             !< the data file as groups and items
    type(diagnostics_type), intent(inout) :: diagnostics    !< gets the errors
    integer, intent(in), optional :: names_unit             !< Fortran unit for the names; they are not written unless it is given
    type(structure_type) :: structure
    type(partition_type) :: partition

    call read_structure_only(document, structure, partition, diagnostics)
    if (diagnostics%failed()) return
    if (present(names_unit)) call print_names_of_vectors(names_unit, diagnostics%names)
    call print_structure(unit, structure, partition%vectors)
  end subroutine print_structure_of

  !> Write that a coupling follows from others, or from closed chains.
  subroutine print_repetition(unit, coupling, chains)
    integer, intent(in) :: unit                         !< Fortran unit to write to
    integer, intent(in) :: coupling                     !< its number, negative
    integer, allocatable, intent(in) :: chains(:)       !< the closures that repeat each other, with it; not allocated: unknown

    if (.not. allocated(chains)) then
      write (unit, '(a)') chain_names([coupling])//': redundant, it follows from others'
    else
      write (unit, '(a)') chain_names([coupling])//': redundant, it follows from '// &
        chain_names(pack(chains, chains /= coupling))//'; the forces of couplings that repeat each other are not unique'
    end if
  end subroutine print_repetition

  !> The consequence of coordinates that cannot move for the links.
  pure function still_links(structure, moves) result(words)
    type(structure_type), intent(in) :: structure   !< links and joints
    logical, intent(in) :: moves(:)                 !< (M) the coordinate can move
    character(len=:), allocatable :: words
    integer :: k

    words = '; the links that these pairs join move as one body'
    if (count(.not. moves) == 1) words = '; the links that this pair joins move as one body'
    do k = 1, size(moves)
      if (moves(k) .or. structure%joint_of(k) == 0) cycle
      words = '; a joint moves its links against each other by its other coordinates, and not at all where it has none'
    end do
  end function still_links

  !> Write the coordinates of an idle freedom, and the joints with several freedoms to which they belong.
  subroutine print_idle(unit, structure, names, idle)
    integer, intent(in) :: unit                    !< Fortran unit to write to
    type(structure_type), intent(in) :: structure  !< links and joints
    type(part_names_type), intent(in) :: names     !< of links and pairs
    type(idle_type), intent(in) :: idle            !< the idle freedom
    character(len=:), allocatable :: joints
    integer :: i, j, before

    joints = ''
    before = 0
    do i = 1, size(idle%coordinates)
      j = structure%joint_of(idle%coordinates(i))
      if (j == 0 .or. j == before) cycle
      joints = joints//trim(merge(' (the', ', the', before == 0))//' '//trim(joint_name(structure%joints(j)))
      before = j
    end do
    if (before > 0) joints = joints//')'
    write (unit, '(a)') with_names(names, 'idle: coordinates '//some_of(idle%coordinates, longest_list)//joints// &
                                   ' can move while links '//to_text(outer_link(structure, idle, 1))//' and '// &
                                   to_text(outer_link(structure, idle, 2))//' stand still')
  end subroutine print_idle

  !> The link at one end of an idle freedom; where it belongs to a joint, the link at the end of the joint.
  pure integer function outer_link(structure, idle, side) result(link)
    type(structure_type), intent(in) :: structure  !< links and joints
    type(idle_type), intent(in) :: idle            !< the idle freedom
    integer, intent(in) :: side                    !< 1 or 2
    integer :: j

    link = idle%ends(side)
    j = structure%joint_of_link(link)
    if (j == 0) return
    associate (joint => structure%joints(j))
      ! the link stands between two pairs of the joint; the freedom goes through one of them
      if (any(idle%coordinates == joint%numbers(link - joint%before_inner + 1))) then
        link = joint%ends(1)
      else
        link = joint%ends(2)
      end if
    end associate
  end function outer_link

  !> " - 2 couplings" in the count of the mobility; nothing where there is none.
  pure function couplings_in_count(n) result(words)
    integer, intent(in) :: n                 !< number of couplings
    character(len=:), allocatable :: words

    words = ''
    if (n > 0) words = ' - '//counted(n, 'coupling')
  end function couplings_in_count

  !> Write equations and rank of each block; of many blocks only those that are singular at the start.
  subroutine print_ranks(unit, plan, report)
    integer, intent(in) :: unit                       !< Fortran unit to write to
    type(plan_type), intent(in) :: plan               !< the plan of the mechanism
    type(mobility_report_type), intent(in) :: report  !< mobility and ranks
    integer :: b, left_out

    left_out = 0
    do b = 1, size(plan%blocks)
      if (plan%blocks(b)%equations == 0) cycle
      if (b > most_lines .and. report%at_start(b) == report%ranks(b)) then
        left_out = left_out + 1
        cycle
      end if
      write (unit, '(a)', advance='no') 'block '//to_text(b)//': '//chain_names(plan%blocks(b)%chains)//', '// &
        counted(plan%blocks(b)%equations, 'equation')//', rank '//to_text(report%ranks(b))
      if (report%at_start(b) < report%ranks(b)) write (unit, '(a)', advance='no') &
        '; at the start only '//to_text(report%at_start(b))//': a singular position'
      write (unit, '(a)') ''
    end do
    if (left_out > 0) write (unit, '(a)') 'and '//counted(left_out, 'more block')
  end subroutine print_ranks

  !> Write which coordinates could be independent instead of one that is.
  subroutine print_alternatives(unit, names, plan, report, i)
    integer, intent(in) :: unit                       !< Fortran unit to write to
    type(part_names_type), intent(in) :: names        !< of links and pairs
    type(plan_type), intent(in) :: plan               !< the plan of the mechanism
    type(mobility_report_type), intent(in) :: report  !< mobility and ranks
    integer, intent(in) :: i                          !< position of the coordinate among the independent ones
    integer, allocatable :: others(:)

    others = numbers_of(abs(report%shares(:, i)) > least_share)
    others = pack(others, others /= plan%independent(i))
    if (size(others) > 0) then
      write (unit, '(a)') 'could be independent instead of '// &
        named_number(names%coordinates, plan%independent(i))//': '//named_list(names%coordinates, others, longest_list)
    else
      write (unit, '(a)') 'independent in any case: '//named_number(names%coordinates, plan%independent(i))
    end if
  end subroutine print_alternatives

  !> Write a text and the numbers that are marked; nothing where none is.
  subroutine print_marked(unit, mask, words, names, more)
    integer, intent(in) :: unit                     !< Fortran unit to write to
    logical, intent(in) :: mask(:)                  !< whether each number is in the list
    character(len=*), intent(in) :: words           !< text before the list
    character(len=*), allocatable, intent(in) :: names(:)   !< names behind the numbers; not allocated: none
    character(len=*), intent(in), optional :: more  !< text after the list

    if (.not. any(mask)) return
    write (unit, '(2a)', advance='no') words, named_list(names, numbers_of(mask), longest_list)
    if (present(more)) write (unit, '(a)', advance='no') more
    write (unit, '(a)') ''
  end subroutine print_marked
end module mech9_structure_text
