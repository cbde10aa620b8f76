!> A text that determines the numbers of a study, by which two studies are compared.
module mech9_study_definition
  use mech9_program_kind, only: program_names
  use mech9_kinds, only: wp, long
  use mech9_text, only: string_type, to_text
  use mech9_error, only: error_type
  use mech9_file_bytes, only: read_bytes
  use mech9_data_file, only: data_file_type
  use mech9_document, only: group_type, value_type, value_integer, value_real, value_logical, &
                            value_text, value_word
  implicit none
  private
  public :: define_study, tell_difference, digest_of

  character, parameter :: line_end = achar(10)
  !> Names of &output that tell where and how results are kept, and change none of them.
  character(len=*), parameter :: places(*) = [character(len=19) :: 'table', 'hdf5', 'sketch', 'animation', 'view', 'compression', &
                                              'poses', 'force_arrows', 'velocity_arrows', 'acceleration_arrows']
  !> Groups that change no numbers where nothing else stands in them.
  character(len=*), parameter :: groups_of_places(*) = [character(len=7) :: 'output', 'optimum']
  !> The polynomial of the cyclic redundancy check of 64 bits (ECMA-182), its bits in reverse order, in two halves.
  integer(long), parameter :: polynomial = ior(shiftl(int(z'C96C5795', long), 32), int(z'D7870F42', long))

contains

  !> Form the definition. It has a line for the program, for each group of the data file with the changes by --set, and
  !> for each file that groups name. The line of a file is its digest. Blanks, comments, the files of the results and
  !> the number of starts do not matter. Fail with exit_file where a file cannot be read.
  subroutine define_study(given, text, err)
    class(data_file_type), intent(in) :: given               !< the data file, with the changes by --set
    character(len=:), allocatable, intent(out) :: text       !< the definition
    type(error_type), allocatable, intent(out) :: err        !< allocated if it failed
    type(string_type), allocatable :: files(:)
    character(len=:), allocatable :: bytes, line
    integer :: i

    text = 'program '//program_names(given%model%program)//line_end
    do i = 1, size(given%document%groups)
      call write_group(given%document%groups(i), line)
      text = text//line
    end do
    call given%list_files(files)
    do i = 1, size(files)
      call read_bytes(files(i)%text, bytes, err)
      if (allocated(err)) return
      text = text//'file '//to_text(i)//' '//digest_of(bytes)//line_end
    end do
  end subroutine define_study

  !> Write a group as a line; empty where nothing in it changes numbers.
  subroutine write_group(group, line)
    type(group_type), intent(in) :: group                    !< the group
    character(len=:), allocatable, intent(out) :: line       !< the line with its end
    integer :: i, j

    line = ''
    if (allocated(group%items)) then
      do i = 1, size(group%items)
        associate (item => group%items(i))
          if (group%name == 'output' .and. any(places == item%name)) cycle
          ! a search with more starts begins with the same ones
          if (group%name == 'optimum' .and. item%name == 'starts') cycle
          line = line//' '//item%name
          do j = 1, size(item%subscripts)
            line = line//'('//to_text(item%subscripts(j)%first)//':'//to_text(item%subscripts(j)%last)//')'
          end do
          line = line//'='
          do j = 1, size(item%values)
            call append_value(item%values(j), line)
          end do
        end associate
      end do
    end if
    if (line /= '' .or. all(groups_of_places /= group%name)) line = '&'//group%name//line//line_end
  end subroutine write_group

  !> Append a value to a line.
  subroutine append_value(value, line)
    type(value_type), intent(in) :: value                        !< the value
    character(len=:), allocatable, intent(inout) :: line         !< gets it, with a comma

    if (value%times > 1) line = line//to_text(value%times)//'*'
    select case (value%kind)
    case (value_integer)
      line = line//to_text(value%whole)
    case (value_real)
      line = line//trim(exact(value%number))
    case (value_logical)
      line = line//merge('T', 'F', value%truth)
    case (value_text)
      line = line//''''//value%text//''''
    case (value_word)
      line = line//value%text
    end select
    line = line//','
  end subroutine append_value

  !> A number with as few digits as give it back.
  function exact(number) result(text)
    real(wp), intent(in) :: number   !< the number
    character(len=40) :: text
    real(wp) :: again
    integer :: digits

    do digits = 15, 17
      text = to_text(number, digits)
      read (text, *) again
      if (.not. abs(again - number) > 0.0_wp) return
    end do
  end function exact

  !> Tell where two definitions differ: the first line of each that the other one does not have at its place; empty where they are
  !> equal.
  subroutine tell_difference(one, other, words, name_of_one, name_of_other)
    character(len=*), intent(in) :: one                      !< a definition
    character(len=*), intent(in) :: other                    !< another one
    character(len=:), allocatable, intent(out) :: words      !< a sentence, or empty
    character(len=*), intent(in) :: name_of_one              !< place of the first definition in words, as 'there'
    character(len=*), intent(in) :: name_of_other            !< place of the other one, as 'here'
    character(len=:), allocatable :: line, other_line
    integer :: first, i

    words = ''
    if (len(one) == len(other) .and. one == other) return
    first = 1
    do i = 1, min(len(one), len(other))
      if (one(i:i) /= other(i:i)) exit
      if (one(i:i) == line_end) first = i + 1
    end do
    call take_line(one, first, i, line)
    call take_line(other, first, i, other_line)
    words = name_of_one//' '//line//', '//name_of_other//' '//other_line
  end subroutine tell_difference

  !> Take the line of a text that begins at a place, in quotes; of a long line the letters around another place.
  subroutine take_line(text, first, middle, line)
    character(len=*), intent(in) :: text                     !< of several lines
    integer, intent(in) :: first                             !< place of the first letter of the line
    integer, intent(in) :: middle                            !< place in the line, or after it
    character(len=:), allocatable, intent(out) :: line       !< the line
    integer, parameter :: longest = 100
    integer :: from, to, last

    line = 'nothing'
    if (first > len(text)) return
    last = first + index(text(first:)//line_end, line_end) - 2
    from = first
    if (last - first + 1 > longest) from = max(first, min(middle - longest/2, last - longest + 1))
    to = min(last, from + longest - 1)
    line = text(from:to)
    if (from > first) line = '... '//line
    if (to < last) line = line//' ...'
    line = "'"//line//"'"
  end subroutine take_line

  !> A digest of a text, of 16 hexadecimal digits.
  pure function digest_of(text) result(digest)
    character(len=*), intent(in) :: text   !< any bytes
    character(len=16) :: digest
    integer(long) :: table(0:255), check
    integer :: i, j

    do i = 0, 255
      check = i
      do j = 1, 8
        if (btest(check, 0)) then
          check = ieor(shiftr(check, 1), polynomial)
        else
          check = shiftr(check, 1)
        end if
      end do
      table(i) = check
    end do
    check = not(0_long)
    do i = 1, len(text)
      check = ieor(shiftr(check, 8), table(int(iand(ieor(check, int(ichar(text(i:i)), long)), 255_long))))
    end do
    write (digest, '(z16.16)') not(check)
  end function digest_of
end module mech9_study_definition
