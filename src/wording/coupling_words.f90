!> Sentences about couplings that cannot be fulfilled.
module mech9_coupling_words
  use mech9_text, only: to_text
  use mech9_failure, only: failure_type, failure_off_table
  use mech9_assembly_failures, only: failure_open_coupling
  use mech9_block_names, only: chain_names, names_with_lines
  implicit none
  private
  public :: explain_coupling, explain_holding

contains

  !> Couplings that contradict others, or whose tables end.
  pure subroutine explain_coupling(failure, text)
    type(failure_type), intent(in) :: failure             !< any kind
    character(len=:), allocatable, intent(inout) :: text  !< the message

    select case (failure%kind)
    case (failure_open_coupling)
      call explain_unfulfilled(failure, text)
    case (failure_off_table)
      text = 'coordinate '//to_text(failure%coordinates)//' comes to an end of the table of '//chain_names(failure%chains)// &
             ' at t = '//to_text(failure%t, 10)//' s: it would go on to '//to_text(failure%values(1, 1), 10)//' '//failure%name// &
             ', and the table leads from '//to_text(failure%values(2, 1), 10)//' to '//to_text(failure%values(3, 1), 10)//' '// &
             failure%name//'. Start elsewhere in the table, end the motion earlier, or give a longer table; only a table over '// &
             'exactly one full turn repeats'
    end select
  end subroutine explain_coupling

  !> Couplings, or a coupling and closed chains, that no coordinates fulfil together.
  pure subroutine explain_unfulfilled(failure, text)
    type(failure_type), intent(in) :: failure             !< of the kind failure_open_coupling
    character(len=:), allocatable, intent(inout) :: text  !< the message
    character(len=:), allocatable :: names

    call names_with_lines(failure%chains, failure%lines, names)
    text = 'the mechanism cannot be assembled: '//names
    if (size(failure%chains) > 1) then
      text = text//' contradict each other: no coordinates fulfil them together'
    else
      text = text//' of coordinates '//to_text(failure%coordinates)//' contradicts others, or closed chains'
    end if
    text = text//'. Leave one of them out, or mend its numbers; constants of gears follow from the positions in &initial, '// &
           'unless phase gives them'
  end subroutine explain_unfulfilled

  !> Append the couplings, and closed chains, that hold coordinates in place, or nothing.
  pure subroutine explain_holding(failure, text)
    type(failure_type), intent(in) :: failure             !< of the kind failure_wrong_choice
    character(len=:), allocatable, intent(inout) :: text  !< the message so far
    character(len=:), allocatable :: names

    if (.not. allocated(failure%chains)) return
    if (size(failure%chains) == 0) return
    call names_with_lines(failure%chains, failure%lines, names)
    text = text//'; '//names
    if (size(failure%chains) == 1) then
      text = text//' holds its coordinates in place'
    else
      text = text//' contradict each other: together they leave coordinates no motion. Leave one of them out, or mend its numbers'
    end if
  end subroutine explain_holding
end module mech9_coupling_words
