!> A program that asks for lines until there are none, for test_line_input.py, which looks from outside. To standard
!> output: each line's bytes in hexadecimal, and in the end why there are no more.
program prompt_probe
  use mech9_error, only: exit_done, exit_interrupted
  use mech9_text, only: string_type, to_text
  use mech9_system, only: exit_program
  use mech9_text_file, only: text_file_type
  use mech9_error, only: error_type
  use mech9_line_input, only: line_input_type, line_read, line_interrupted
  implicit none
  call run_probe()
contains

  subroutine run_probe()
    type(line_input_type) :: input
    type(text_file_type) :: answers
    type(error_type), allocatable :: err
    type(string_type) :: words(4)
    character(len=:), allocatable :: line
    integer :: status, number

    words(1)%text = 'revolute'
    words(2)%text = 'prismatic'
    words(3)%text = 'prism'
    words(4)%text = 'back'
    call answers%open('-', err)
    call input%open('probe')
    status = line_read
    number = 0
    do while (status == line_read)
      number = number + 1
      call input%read_line('a word'//new_line('a')//to_text(number)//'> ', words, line, status)
      if (status == line_read) call answers%write(hexadecimal(line)//new_line('a'), err)
    end do
    call input%close()
    if (status == line_interrupted) then
      call answers%write('interrupted'//new_line('a'), err)
      call exit_program(exit_interrupted)
    else
      call answers%write('ended'//new_line('a'), err)
      call exit_program(exit_done)
    end if
  end subroutine run_probe

  pure function hexadecimal(bytes) result(text)
    character(len=*), intent(in) :: bytes   !< bytes that were read
    character(len=:), allocatable :: text
    integer :: i

    allocate (character(len=2*len(bytes)) :: text)
    do i = 1, len(bytes)
      write (text(2*i - 1:2*i), '(z2.2)') ichar(bytes(i:i))
    end do
  end function hexadecimal
end program prompt_probe
