!> Manual pages and completions name every option of their program, and none of the other alone; roff and bash read them as meant.
module test_pages
  use mech9_program_kind, only: kinematics, dynamics, program_names, belongs_to
  use mech9_grammar, only: group_table
  use mech9_options, only: options_table
  use mech9_manual_page, only: manual_page
  use mech9_bash_completion, only: bash_completion
  use mech9_testing, only: tester_type
  implicit none
  private
  public :: run

  character, parameter :: eol = achar(10)

contains

  !> Run the cases of this suite.
  subroutine run(tester)
    type(tester_type), intent(inout) :: tester   !< selects cases and counts their checks

    if (tester%runs('options')) call options(tester)
    if (tester%runs('groups')) call groups(tester)
    if (tester%runs('markup')) call markup(tester)
    if (tester%runs('values')) call values(tester)
  end subroutine run

  !> A name with the roff markup of its dashes.
  pure function in_roff(name) result(text)
    character(len=*), intent(in) :: name   !< of an option
    character(len=:), allocatable :: text
    integer :: i

    text = '\-\-'
    do i = 1, len_trim(name)
      if (name(i:i) == '-') text = text//'\'
      text = text//name(i:i)
    end do
  end function in_roff

  subroutine options(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    character(len=:), allocatable :: page, script, name
    logical :: has
    integer :: i, k

    do k = 1, 2
      page = manual_page(k)
      script = bash_completion(k)
      do i = 1, size(options_table)
        has = belongs_to(options_table(i)%program, k)
        name = trim(options_table(i)%name)
        call tester%is_true((index(page, '.B "'//in_roff(name)//'"') + index(page, '.B "'//in_roff(name)//' ') + &
                             index(page, '.B "'//in_roff(name)//'[') > 0) .eqv. has, &
                            'the page of '//program_names(k)//' on --'//name)
        call tester%is_true((index(script, ' --'//name//' ') + index(script, ' --'//name//'"') + &
                             index(script, '"--'//name//' ') > 0) .eqv. has, &
                            'the completion of '//program_names(k)//' on --'//name)
      end do
    end do
  end subroutine options

  subroutine groups(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    character(len=:), allocatable :: page
    integer :: i

    page = manual_page(kinematics)
    do i = 1, size(group_table)
      call tester%is_true(index(page, '.SS &'//trim(group_table(i)%name)//eol) > 0, 'the group '//group_table(i)%name)
    end do
  end subroutine groups

  !> Lines that begin with a point are commands of roff that are known; all lines end.
  subroutine markup(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    character(len=4), parameter :: commands(8) = [character(len=4) :: '.TH ', '.SH ', '.SS ', '.B', '.RI ', '.TP', '.PP', '.br']
    character(len=:), allocatable :: page
    integer :: first, last, i
    logical :: right

    page = manual_page(dynamics)
    call tester%is_true(page(len(page):) == eol, 'the last line ends')
    right = .true.
    first = 1
    do while (first <= len(page))
      last = first + index(page(first:), eol) - 2
      if (page(first:first) == '.') &
        right = right .and. any([(index(page(first:last), trim(commands(i))) == 1, i=1, size(commands))])
      if (page(first:first) == '''') right = .false.
      first = last + 2
    end do
    call tester%is_true(right, 'commands of roff are known')
    call tester%is_true(index(page, '.TH mech9d 1 ') == 1, 'the page has its title')
  end subroutine markup

  !> After a name that takes words bash offers these.
  subroutine values(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    character(len=:), allocatable :: script

    script = bash_completion(kinematics)
    call tester%is_true(index(script, 'yes:mechanism.angle_unit) COMPREPLY=($(compgen -W "rad deg" -- "$word"))') > 0, 'words')
    call tester%is_true(index(script, 'yes:output.reactions) COMPREPLY=($(compgen -W ".true. .false." -- "$word"))') > 0, &
                        'logicals')
    call tester%is_true(index(script, 'complete -F _mech9k mech9k'//eol) > 0, 'the function is bound to the program')
  end subroutine values
end module test_pages
