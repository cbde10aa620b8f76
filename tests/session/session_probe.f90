!> A program that does one thing of the session's floor for test_session_behaviour.py, which looks from outside:
!> `exit CODE`, `wait` (until interrupted), `progress SECONDS [quiet]`, `table PATH ROWS`.
program session_probe
  use mech9_kinds, only: wp
  use mech9_clock, only: seconds
  use mech9_error, only: error_type, exit_interrupted
  use mech9_text, only: string_type, to_text
  use mech9_table, only: table_type
  use mech9_heading, only: new_heading
  use mech9_command_line, only: get_command_words
  use mech9_progress, only: progress_type
  use mech9_system, only: exit_program, catch_interrupts, interrupted
  implicit none
  call run_probe()
contains

  subroutine run_probe()
    type(string_type), allocatable :: words(:)
    integer :: number

    call get_command_words(words)
    call catch_interrupts()
    select case (words(1)%text)
    case ('exit')
      read (words(2)%text, *) number
      write (*, '(a)', advance='no') 'last words'
      call exit_program(number)
    case ('wait')
      call wait_for_interrupt()
    case ('progress')
      read (words(2)%text, *) number
      call show_progress(real(number, wp), size(words) > 2)
    case ('table')
      read (words(3)%text, *) number
      call write_table(words(2)%text, number)
    end select
  end subroutine run_probe

  subroutine wait_for_interrupt()
    print '(a)', 'ready'
    flush (6)
    ! a loop with nothing else in it, from which a careless compiler could take the question out
    do while (.not. interrupted())
    end do
    print '(a)', 'noted'
    flush (6)
    ! a program that does not end by itself now: for the second Ctrl-C
    do while (command_argument_count() > 1)
    end do
    call exit_program(exit_interrupted)
  end subroutine wait_for_interrupt

  subroutine show_progress(duration, quiet)
    real(wp), intent(in) :: duration   !< [s]
    logical, intent(in) :: quiet       !< the line is not wanted
    type(progress_type) :: progress
    real(wp) :: start

    start = seconds()
    call progress%start('probe', quiet)
    do while (seconds() - start < duration)
      call progress%update((seconds() - start)/duration)
    end do
    call progress%finish()
  end subroutine show_progress

  !> A table of i, 1/i, ... in 20 columns; ends as a program would, with the error's code.
  subroutine write_table(path, rows)
    character(len=*), intent(in) :: path   !< of the table
    integer, intent(in) :: rows            !< how many
    type(table_type) :: table
    type(error_type), allocatable :: err, close_error
    type(string_type) :: names(20), units(20)
    real(wp) :: row(20)
    integer :: i

    do i = 1, 20
      names(i)%text = 'q'//to_text(i)
      units(i)%text = 'm'
    end do
    call table%open(path, new_heading('Probe', names, units), 'probe', err)
    do i = 1, rows
      if (allocated(err)) exit
      row(1) = i
      row(2:) = 1.0_wp/i
      call table%write_row(row, err)
    end do
    call table%close(close_error)
    if (.not. allocated(err)) call move_alloc(close_error, err)
    if (.not. allocated(err)) call exit_program(0)
    write (0, '(a)') err%message
    call exit_program(err%code)
  end subroutine write_table
end program session_probe
