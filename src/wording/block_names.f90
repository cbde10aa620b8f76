!> Names of the blocks of a plan: their chains and coordinates in words.
module mech9_block_names
  use mech9_text, only: to_text
  implicit none
  private
  public :: chain_names, names_with_lines, words_of_block

contains

  ! Lengths of results: gfortran wants them before the functions that have them.

  !> Length of the words for several things.
  pure integer function several_length(word, numbers) result(length)
    character(len=*), intent(in) :: word    !< for one of them
    integer, intent(in) :: numbers(:)       !< their numbers

    length = 0
    if (size(numbers) > 0) length = len(word) + len(' ') + len(to_text(numbers))
    if (size(numbers) > 1) length = length + len('s')
  end function several_length

  !> "coupling 2", "couplings 1, 3", or nothing.
  pure function several(word, numbers) result(words)
    character(len=*), intent(in) :: word    !< for one of them
    integer, intent(in) :: numbers(:)       !< their numbers
    character(len=several_length(word, numbers)) :: words

    words = ''
    if (size(numbers) == 1) words = word//' '//to_text(numbers)
    if (size(numbers) > 1) words = word//'s '//to_text(numbers)
  end function several

  !> Length of the names of chains.
  pure integer function chain_names_length(chains) result(length)
    integer, intent(in) :: chains(:)        !< numbers of the closed chains, and of couplings, negative

    length = len('an open chain')
    if (size(chains) == 0) return
    length = len(several('closed chain', pack(chains, chains > 0))) + len(several('coupling', -pack(chains, chains < 0)))
    if (any(chains > 0) .and. any(chains < 0)) length = length + len(' and ')
    if (size(chains) > 1) length = length + len(' together')
  end function chain_names_length

  !> "closed chain 2", "closed chains 1, 3 together", "coupling 1" or "closed chain 2 and coupling 1 together".
  pure function chain_names(chains) result(names)
    integer, intent(in) :: chains(:)        !< numbers of the closed chains of a block, and of its couplings, negative
    character(len=chain_names_length(chains)) :: names

    names = 'an open chain'
    if (size(chains) == 0) return
    names = several('closed chain', pack(chains, chains > 0))//several('coupling', -pack(chains, chains < 0))
    if (any(chains > 0) .and. any(chains < 0)) &
      names = several('closed chain', pack(chains, chains > 0))//' and '//several('coupling', -pack(chains, chains < 0))
    if (size(chains) > 1) names = trim(names)//' together'
  end function chain_names

  !> "couplings 1 (line 4) and 2 (line 5)", "closed chain 1 and coupling 2 (line 7)".
  pure subroutine names_with_lines(chains, lines, names)
    integer, intent(in) :: chains(:)        !< numbers of closed chains, and of couplings, negative
    integer, intent(in) :: lines(:)         !< of the data file, on which each begins; 0: on none
    character(len=:), allocatable, intent(out) :: names   !< at least one
    integer :: order(size(chains)), i, k, n, couplings

    ! closed chains first, then couplings, by their numbers
    n = size(order)
    do i = 1, n
      k = count(chains > 0 .and. chains <= chains(i))
      if (chains(i) < 0) k = count(chains > 0) + count(chains < 0 .and. chains >= chains(i))
      order(k) = i
    end do
    couplings = count(chains < 0)
    names = ''
    do i = 1, n
      k = order(i)
      if (i > 1) names = names//trim(merge(' and', ',   ', i == n))//' '
      if (i == 1 .and. chains(k) > 0) names = names//'closed chain'//trim(merge('s', ' ', n - couplings > 1))//' '
      if (i == n - couplings + 1) names = names//'coupling'//trim(merge('s', ' ', couplings > 1))//' '
      names = names//to_text(abs(chains(k)))
      if (lines(k) > 0) names = names//' (line '//to_text(lines(k))//')'
    end do
  end subroutine names_with_lines

  !> The numbers in ascending order.
  pure function sorted(numbers)
    integer, intent(in) :: numbers(:)       !< all different
    integer :: sorted(size(numbers))
    integer :: i

    do i = 1, size(numbers)
      sorted(count(numbers <= numbers(i))) = numbers(i)
    end do
  end function sorted

  !> Length of the words of a block.
  pure integer function words_length(chains, coordinates) result(length)
    integer, intent(in) :: chains(:)        !< numbers of the closed chains, and of couplings, negative
    integer, intent(in) :: coordinates(:)   !< numbers of the coordinates

    length = len(chain_names(chains)) + len(' (coordinates )') + len(to_text(coordinates))
  end function words_length

  !> "closed chain 2 (coordinates 4, 6, 7)".
  pure function words_of_block(chains, coordinates) result(words)
    integer, intent(in) :: chains(:)        !< numbers of the closed chains of a block
    integer, intent(in) :: coordinates(:)   !< numbers of the coordinates that it determines, in any order
    character(len=words_length(chains, coordinates)) :: words

    words = chain_names(chains)//' (coordinates '//to_text(sorted(coordinates))//')'
  end function words_of_block
end module mech9_block_names
