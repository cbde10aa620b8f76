!> Names of the blocks of a plan: their chains and coordinates in words.
module mech9_block_names
  use mech9_text, only: to_text
  implicit none
  private
  public :: chain_names, words_of_block

contains

  ! Lengths of results: gfortran wants them before the functions that have them.

  !> Length of the names of chains.
  pure integer function chain_names_length(chains) result(length)
    integer, intent(in) :: chains(:)        !< numbers of the closed chains

    length = len('an open chain')
    if (size(chains) == 1) length = len('closed chain ') + len(to_text(chains))
    if (size(chains) > 1) length = len('closed chains  together') + len(to_text(chains))
  end function chain_names_length

  !> "closed chain 2" or "closed chains 1, 3 together".
  pure function chain_names(chains) result(names)
    integer, intent(in) :: chains(:)        !< numbers of the closed chains of a block
    character(len=chain_names_length(chains)) :: names

    if (size(chains) == 0) then
      names = 'an open chain'
    else if (size(chains) == 1) then
      names = 'closed chain '//to_text(chains)
    else
      names = 'closed chains '//to_text(chains)//' together'
    end if
  end function chain_names

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
    integer, intent(in) :: chains(:)        !< numbers of the closed chains
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
