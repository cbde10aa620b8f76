!> The section of a motion in words.
module mech9_section_words
  use mech9_kinds, only: wp
  use mech9_text, only: to_text
  use mech9_counted, only: counted
  use mech9_part_names, only: part_names_type, add_names
  use mech9_section_record, only: section_record_type
  implicit none
  private
  public :: print_section

contains

  !> Print how many points there are; where there are none, the range of the value that was not met.
  subroutine print_section(unit, section, writes, names)
    integer, intent(in) :: unit                               !< Fortran unit to write to
    class(section_record_type), intent(in) :: section         !< the section
    logical, intent(in) :: writes                             !< files are written
    type(part_names_type), intent(in) :: names                !< of links and pairs
    character(len=:), allocatable :: words

    if (section%count > 0) then
      write (unit, '(a)') 'section: '//counted(section%count, 'point')
      if (writes .and. section%wanted%table /= '' .and. section%wanted%table /= '-') &
        write (unit, '(2a)') 'table of the section: ', section%wanted%table
    else if (section%range(1) > section%range(2) .and. .not. section%wanted%period > 0.0_wp) then
      write (unit, '(a)') 'the section has no point: the motion ends before its transient'
    else if (section%wanted%period > 0.0_wp) then
      write (unit, '(a)') 'the section has no point: the motion, or what follows the transient, is shorter than the period'
    else
      words = ' '//words_of_value(section)
      call add_names(names, words)
      write (unit, '(a)') 'the section has no point:'//words//' is never met'// &
        trim(merge(' in this direction', '                  ', section%wanted%direction /= 0))//'; it went from '// &
        to_text(section%wanted%value + section%range(1), 6)//' to '//to_text(section%wanted%value + section%range(2), 6)
    end if
  end subroutine print_section

  !> The value of a section in words.
  pure function words_of_value(section) result(words)
    class(section_record_type), intent(in) :: section         !< the section
    character(len=:), allocatable :: words

    if (section%wanted%coordinate > 0) then
      words = 'q'//to_text(section%wanted%coordinate)
    else
      words = section%wanted%column
    end if
    words = words//' = '//to_text(section%wanted%value, 6)
  end function words_of_value
end module mech9_section_words
