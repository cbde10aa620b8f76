!> Words and JSON that the reports of all runs share. Uses text, json, mechanism, plan, version.
module mech9_run_words
  use mech9_kinds, only: wp
  use mech9_text, only: to_text
  use mech9_json, only: json_type
  use mech9_mechanism, only: mechanism_type
  use mech9_plan, only: plan_type
  use mech9_version, only: version, revision, compiler
  implicit none
  private
  public :: duration, each, begin_report, add_structure

contains

  !> ", 1.2 us each".
  pure function each(total, count) result(text)
    real(wp), intent(in) :: total
    integer, intent(in) :: count
    character(len=:), allocatable :: text

    text = ''
    if (count > 1) text = ', '//duration(total/count)//' each'
  end function each

  !> A time span in a readable unit.
  pure function duration(seconds) result(text)
    real(wp), intent(in) :: seconds
    character(len=:), allocatable :: text

    if (seconds < 1.0e-3_wp) then
      text = to_text(1.0e6_wp*seconds, 3)//' us'
    else if (seconds < 1.0_wp) then
      text = to_text(1.0e3_wp*seconds, 3)//' ms'
    else
      text = to_text(seconds, 4)//' s'
    end if
  end function duration

  !> What a report begins with: which program this was, what it ran and what came of it.
  subroutine begin_report(json, program_name, mechanism, exit_code, table_path)
    type(json_type), intent(inout) :: json
    character(len=*), intent(in) :: program_name
    type(mechanism_type), intent(in) :: mechanism
    integer, intent(in) :: exit_code               !< that the program is going to answer
    character(len=*), intent(in) :: table_path     !< '-' is standard output; empty: no table

    call json%begin_object()
    call json%add('program', program_name)
    call json%add('version', version)
    call json%add('revision', revision)
    call json%add('compiler', compiler())
    call json%add('title', mechanism%title)
    call json%add('exit_code', exit_code)
    call json%add('table', table_path)
  end subroutine begin_report

  !> The structural vectors and the blocks.
  subroutine add_structure(json, mechanism, plan)
    type(json_type), intent(inout) :: json
    type(mechanism_type), intent(in) :: mechanism
    type(plan_type), intent(in) :: plan
    integer :: b, i

    call json%add('links', plan%n_links)
    call json%add('coordinates', plan%n_coordinates)
    call add_integers(json, 'independent', plan%independent)
    call add_integers(json, 'nrg', mechanism%vectors%nrg)
    call add_integers(json, 'nws', mechanism%vectors%nws)
    call add_integers(json, 'rdw', mechanism%vectors%rdw)
    call add_integers(json, 'nrw', mechanism%vectors%nrw)
    call json%begin_array('blocks')
    do b = 1, size(plan%blocks)
      associate (block => plan%blocks(b))
        call json%begin_object()
        call add_integers(json, 'unknowns', &
                          [(block%coordinates(i), i=1, size(block%unknowns))])
        call json%add('equations', block%equations)
        call json%add('chains', block%last_closure - block%first_closure + 1)
        call json%end_object()
      end associate
    end do
    call json%end_array()
  end subroutine add_structure

  subroutine add_integers(json, name, numbers)
    type(json_type), intent(inout) :: json
    character(len=*), intent(in) :: name
    integer, intent(in) :: numbers(:)
    integer :: i

    call json%begin_array(name)
    do i = 1, size(numbers)
      call json%add(numbers(i))
    end do
    call json%end_array()
  end subroutine add_integers
end module mech9_run_words
