!> A drawing of a structure as text: its chains of links and pairs, and its mobility by the count.
module mech9_structure_sketch
  use mech9_text, only: to_text
  use mech9_counted, only: counted
  use mech9_structure, only: structure_type
  use mech9_joint_expansion, only: shown_vectors
  use mech9_structural_vectors, only: structural_vectors_type, chain_type, chains_of
  use mech9_partition, only: partition_type
  implicit none
  private
  public :: print_sketch

  integer, parameter :: line_width = 78
  integer, parameter :: most_chains = 30      !< largest number of chains that are drawn

contains

  !> Draw the chains in the order of computation, each as links joined by pairs. In "1 =5= 2 -4- 3", =5= is an
  !> independent coordinate. A joint with several freedoms is one step with all its coordinates, as in "2 -5,6,7- 3".
  !> Where only some of them are independent, these stand as in "2 -5,=6=,7- 3". The mobility by the count follows.
  subroutine print_sketch(unit, structure, partition)
    integer, intent(in) :: unit                           !< number of the output unit
    type(structure_type), intent(in) :: structure         !< links of the pairs
    type(partition_type), intent(in) :: partition         !< kinds of the coordinates, and their order of computation
    type(chain_type), allocatable :: chains(:)
    type(structural_vectors_type) :: vectors
    integer :: i, loops

    vectors = shown_vectors(structure, partition%vectors)
    chains = chains_of(vectors)
    loops = count(chains%closed)
    write (unit, '(a)') '  The links are connected. Numbers between = = are independent coordinates:'
    do i = 1, min(size(chains), most_chains)
      call print_chain(unit, structure, partition%independent(), vectors, chains(i))
    end do
    if (size(chains) > most_chains) write (unit, '(a)') '  and '//counted(size(chains) - most_chains, 'more chain')
    if (loops == 0) then
      write (unit, '(a)') '  Open chains only: each coordinate moves by itself, the mobility is '// &
        to_text(structure%n_coordinates)//'.'
    else
      write (unit, '(a)') '  Mobility by the count: '//count_text(structure%n_coordinates, loops, 3)//' in a plane, '// &
        count_text(structure%n_coordinates, loops, 6)//' in space;'
      write (unit, '(a)') '  the geometry will tell which holds. Independent now: '// &
        to_text(count(partition%independent()))//'.'
    end if
  end subroutine print_sketch

  !> The mobility by the count, as in "1 = 7 - 2 x 3".
  pure function count_text(coordinates, loops, each) result(text)
    integer, intent(in) :: coordinates  !< number of coordinates
    integer, intent(in) :: loops        !< number of closed chains
    integer, intent(in) :: each         !< equations of each closed chain: 3 in a plane, 6 in space
    character(len=:), allocatable :: text

    text = to_text(coordinates - loops*each)//' = '//to_text(coordinates)//' - '//to_text(loops)//' x '//to_text(each)
  end function count_text

  !> Print one chain, on as many lines as it needs.
  subroutine print_chain(unit, structure, independent, vectors, chain)
    integer, intent(in) :: unit                           !< number of the output unit
    type(structure_type), intent(in) :: structure         !< links of the pairs
    logical, intent(in) :: independent(:)                 !< (M) which coordinates are independent
    type(structural_vectors_type), intent(in) :: vectors  !< the structure as the second set
    type(chain_type), intent(in) :: chain                 !< the chain
    character(len=:), allocatable :: line, step
    integer :: i

    step = ''
    line = '    '//to_text(chain%start)
    do i = chain%first, chain%last
      step = ' '//pair_text(structure, independent, vectors%nws(i))//' '//to_text(vectors%nrg(i))
      if (len(line) + len(step) > line_width) then
        write (unit, '(a)') line
        line = '     '
      end if
      line = line//step
    end do
    if (.not. chain%closed) line = line//'  (open)'
    write (unit, '(a)') line
  end subroutine print_chain

  !> The coordinates of a pair, or of the joint with several freedoms whose first coordinate is given.
  pure function pair_text(structure, independent, first) result(text)
    type(structure_type), intent(in) :: structure  !< links of the pairs
    logical, intent(in) :: independent(:)          !< (M) which coordinates are independent
    integer, intent(in) :: first                   !< number of the coordinate
    character(len=:), allocatable :: text
    integer, allocatable :: numbers(:)
    integer :: i, joint

    numbers = [first]
    joint = structure%joint_of(first)
    if (joint > 0) numbers = structure%joints(joint)%coordinates()
    text = ''
    do i = 1, size(numbers)
      if (i > 1) text = text//','
      if (independent(numbers(i)) .and. .not. all(independent(numbers))) then
        text = text//'='//to_text(numbers(i))//'='
      else
        text = text//to_text(numbers(i))
      end if
    end do
    text = merge('=', '-', all(independent(numbers)))//text//merge('=', '-', all(independent(numbers)))
  end function pair_text
end module mech9_structure_sketch
