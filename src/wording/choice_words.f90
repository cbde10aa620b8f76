!> Sentences about a choice of independent coordinates that cannot serve, and about the choices that would.
module mech9_choice_words
  use mech9_text, only: to_text, some_of
  use mech9_failure, only: failure_type
  use mech9_masks, only: numbers_of
  use mech9_coupling_words, only: explain_holding
  implicit none
  private
  public :: explain_choice, longest_list

  !> Numbers that a list in a message shows at most.
  integer, parameter :: longest_list = 24

contains

  !> The error in a choice of independent coordinates, and the choices that would serve.
  pure subroutine explain_choice(failure, text)
    type(failure_type), intent(in) :: failure           !< of the kind failure_wrong_choice
    character(len=:), allocatable, intent(out) :: text  !< the message
    logical, dimension(failure%number) :: wanted, chosen
    integer :: i, f, m

    m = failure%number
    f = size(failure%others)
    wanted = mask_of(failure%coordinates, m)
    chosen = mask_of(failure%others, m)
    text = 'the mobility is '//to_text(f)//' ('//to_text(m)//' coordinates, rank '//to_text(m - f)//'), and '
    select case (count(wanted))
    case (0)
      text = text//'no coordinate is independent'
    case (1)
      text = text//'1 coordinate is independent'
    case default
      text = text//to_text(count(wanted))//' coordinates are independent'
    end select
    if (f == 0) then
      text = text//'; the mechanism cannot move, no coordinate can be independent'
      call explain_holding(failure, text)
      return
    end if
    call explain_needed(failure, wanted, text)
    call explain_surplus(failure, wanted, chosen, text)
    text = text//'; cq = '//some_of(failure%others, longest_list)//' would serve'
    do i = 1, min(f, longest_list)
      associate (instead => failure%replaces(:, i) .and. .not. chosen)
        if (any(instead)) text = text//'; instead of '//to_text(failure%others(i))//' also '// &
                                 some_of(numbers_of(instead), longest_list)
      end associate
    end do
    if (size(failure%idle) > 0) text = text//'; never: '//some_of(failure%idle, longest_list)//', which cannot move'
    call explain_holding(failure, text)
  end subroutine explain_choice

  !> Append "; 1 more of the coordinates 2, 3 must be independent (cq)", or "; coordinate 2 must be independent, too (cq)", or
  !> nothing.
  pure subroutine explain_needed(failure, wanted, text)
    type(failure_type), intent(in) :: failure             !< of the kind failure_wrong_choice
    logical, intent(in) :: wanted(:)                      !< (M) the independent coordinates of the data file
    character(len=:), allocatable, intent(inout) :: text  !< the message so far
    logical :: could(size(wanted))
    integer :: i, missing

    could = .false.
    missing = 0
    do i = 1, size(failure%others)
      if (wanted(failure%others(i))) cycle
      missing = missing + 1
      could = could .or. (failure%replaces(:, i) .and. .not. wanted)
    end do
    if (missing == 0) return
    if (count(could) == 1) then
      text = text//'; coordinate '//to_text(numbers_of(could))//' must be independent'
      if (any(wanted)) text = text//', too'
      text = text//' (cq)'
    else
      text = text//'; '//to_text(missing)//' more of the coordinates '// &
             some_of(numbers_of(could), longest_list)//' must be independent (cq)'
    end if
  end subroutine explain_needed

  !> Append "; take 1 of the coordinates 1, 2 off the independent ones (cq)", or the same sentence about one coordinate, or nothing.
  pure subroutine explain_surplus(failure, wanted, chosen, text)
    type(failure_type), intent(in) :: failure             !< of the kind failure_wrong_choice
    logical, intent(in) :: wanted(:)                      !< (M) the independent coordinates of the data file
    logical, intent(in) :: chosen(:)                      !< (M) those that would serve
    character(len=:), allocatable, intent(inout) :: text  !< the message so far
    logical, dimension(size(wanted)) :: surplus, could
    integer :: i, k

    surplus = wanted .and. .not. chosen
    if (.not. any(surplus)) return
    could = surplus
    do i = 1, size(failure%others)
      k = failure%others(i)
      if (wanted(k) .and. any(surplus .and. failure%replaces(:, i))) could(k) = .true.
    end do
    if (count(could) == 1) then
      text = text//'; take coordinate '//to_text(numbers_of(could))
    else
      text = text//'; take '//to_text(count(surplus))//' of the coordinates '//some_of(numbers_of(could), longest_list)
    end if
    text = text//' off the independent ones (cq)'
  end subroutine explain_surplus

  !> Numbers as a mask.
  pure function mask_of(numbers, m) result(mask)
    integer, intent(in) :: numbers(:)     !< from 1 to m
    integer, intent(in) :: m              !< length of the mask
    logical :: mask(m)

    mask = .false.
    mask(numbers) = .true.
  end function mask_of
end module mech9_choice_words
