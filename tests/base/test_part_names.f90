!> Names of links and pairs: in names of columns, to numbers and back, and behind numbers in sentences.
module test_part_names
  use mech9_part_names, only: part_names_type, number_columns, name_column, add_names, coordinate_named, link_named, label_of
  use mech9_testing, only: tester_type
  implicit none
  private
  public :: run

contains

  !> Run the cases of this suite.
  subroutine run(tester)
    type(tester_type), intent(inout) :: tester   !< selects cases and counts their checks

    if (tester%runs('columns')) call columns(tester)
    if (tester%runs('sentences')) call sentences(tester)
    if (tester%runs('no names')) call none_given(tester)
  end subroutine run

  !> Link 2 is the crank; pair 1 is A, and joint J has coordinates 3 and 4.
  type(part_names_type) function some_names() result(names)
    allocate (names%links(3), names%coordinates(4))
    names%links = [character(len=40) :: '', 'crank', 'rod']
    names%coordinates = [character(len=43) :: 'A', '', 'J(1)', 'J(2)']
  end function some_names

  !> Names of columns go to numbers and back.
  subroutine columns(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks

    call pair_of_columns(tester, 'A.q', 'q1')
    call pair_of_columns(tester, 'A.dq', 'dq1')
    call pair_of_columns(tester, 'J(2).ddq', 'ddq4')
    call pair_of_columns(tester, 'A.drive', 'F1')
    call pair_of_columns(tester, 'A.fx', 'R1.fx')
    call pair_of_columns(tester, 'J.mz', 'R3.mz')
    call pair_of_columns(tester, 'A.friction', 'R1.friction')
    call pair_of_columns(tester, 'crank.phi', 'L2.phi')
    call pair_of_columns(tester, 'rod.pole.x', 'L3.pole.x')
    call pair_of_columns(tester, 'd(A.q)/d(a)', 'd(q1)/d(a)')
    call pair_of_columns(tester, 'P.x', 'P.x')
    call pair_of_columns(tester, 'q2', 'q2')
    call numbered(tester, 'A.q:J(2).q,P.x,a.q,crank.q,A.x,B.q', 'q1:q4,P.x,a.q,crank.q,A.x,B.q')
    call numbered(tester, 'J(1).fx', 'R3.fx')
    call numbered(tester, 'J.q', 'J.q')
    call numbered(tester, '', '')
    call numbered(tester, ',,.q,A.', ',,.q,A.')
  end subroutine columns

  !> Check a name of a column in both directions.
  subroutine pair_of_columns(tester, name, number)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    character(len=*), intent(in) :: name         !< with names
    character(len=*), intent(in) :: number       !< with numbers
    character(len=:), allocatable :: text

    call numbered(tester, name, number)
    text = number
    call name_column(some_names(), text)
    call tester%is_true(text == name, number//' is '//name//', not '//text)
  end subroutine pair_of_columns

  !> Check names of columns with numbers.
  subroutine numbered(tester, name, number)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    character(len=*), intent(in) :: name         !< with names
    character(len=*), intent(in) :: number       !< with numbers
    character(len=:), allocatable :: text

    text = name
    call number_columns(some_names(), text)
    call tester%is_true(text == number, name//' is '//number//', not '//text)
  end subroutine numbered

  !> Names stand behind the numbers of links, pairs and coordinates, once.
  subroutine sentences(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks

    call said(tester, 'link 2 is free', 'link 2 (crank) is free')
    call said(tester, 'links 1, 2 and 3', 'links 1, 2 (crank) and 3 (rod)')
    call said(tester, 'coordinate 1', 'coordinate 1 (A)')
    call said(tester, 'pair 2 and coordinates 3, 4.', 'pair 2 and coordinates 3 (J(1)), 4 (J(2)).')
    call said(tester, 'link 2 (crank)', 'link 2 (crank)')
    call said(tester, '4 links, link 20, link2, links 2.5', '4 links, link 20, link2, links 2.5')
    call said(tester, '&link 2, blink 2', '&link 2, blink 2')
    call said(tester, 'link', 'link')
    call said(tester, 'the pair 1', 'the pair 1 (A)')
  end subroutine sentences

  !> Check a sentence.
  subroutine said(tester, sentence, expected)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    character(len=*), intent(in) :: sentence     !< with numbers
    character(len=*), intent(in) :: expected     !< with names
    character(len=:), allocatable :: text

    text = sentence
    call add_names(some_names(), text)
    call tester%is_true(text == expected, sentence//' becomes '//expected//', not '//text)
  end subroutine said

  !> Without names nothing changes.
  subroutine none_given(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(part_names_type) :: names
    character(len=:), allocatable :: text

    text = 'A.q'
    call number_columns(names, text)
    call add_names(names, text)
    call name_column(names, text)
    call tester%is_true(text == 'A.q', 'no names change nothing')
    call tester%is_true(coordinate_named(names, 'A') == 0 .and. link_named(names, 'A') == 0, 'no name has a number')
    call tester%is_true(label_of(names%links, 3) == '3', 'a link without a name is called by its number')
    call tester%is_true(coordinate_named(some_names(), 'J(2)') == 4 .and. link_named(some_names(), 'Crank') == 0, &
                        'names are case-sensitive')
  end subroutine none_given
end module test_part_names
