!> What mech9k says at the end of a run: a few lines for a person, JSON for a program.
!> Uses text, json, plan, kinematic_run, version.
module mech9_kinematic_report
  use mech9_kinds, only: wp
  use mech9_error, only: error_type
  use mech9_text, only: to_text, string_type
  use mech9_json, only: json_type
  use mech9_mechanism, only: mechanism_type
  use mech9_plan, only: plan_type
  use mech9_kinematic_run, only: kinematic_outcome_type
  use mech9_version, only: version, revision, compiler
  implicit none
  private
  public :: print_kinematic_report, save_kinematic_report

contains

  !> The short report of a run.
  subroutine print_kinematic_report(unit, mechanism, table_path, outcome)
    integer, intent(in) :: unit
    type(mechanism_type), intent(in) :: mechanism
    character(len=*), intent(in) :: table_path
    type(kinematic_outcome_type), intent(in) :: outcome
    integer :: k, calls

    associate (tracker => outcome%tracker)
      write (unit, '(a)') to_text(outcome%rows)//' positions: '//duration(outcome%seconds_solving)//' to solve'// &
        each(outcome%seconds_solving, outcome%rows)//', '//duration(outcome%seconds_writing)//' to write'
      write (unit, '(a)') to_text(iterations_each(outcome), 3)//' Newton iterations a position; largest closure '// &
        to_text(tracker%worst_closure, 3)//' m'
      if (tracker%halvings > 0) write (unit, '(a)') to_text(tracker%steps)//' steps, '// &
        to_text(tracker%halvings)//' of them shortened to keep to the branch'
    end associate
    calls = 0
    do k = 1, size(mechanism%pairs)
      if (mechanism%pairs(k)%pair%user_calls() > 1) calls = calls + mechanism%pairs(k)%pair%user_calls()
    end do
    if (calls > 0) write (unit, '(a)') 'user pairs in plain values: '//to_text(calls)// &
      ' calls or more for each evaluation; in Taylor arithmetic it would be one a pair'
    if (table_path /= '' .and. table_path /= '-') write (unit, '(2a)') 'table: ', table_path
  end subroutine print_kinematic_report

  !> ", 1.2 us each".
  pure function each(total, count) result(text)
    real(wp), intent(in) :: total
    integer, intent(in) :: count
    character(len=:), allocatable :: text

    text = ''
    if (count > 1) text = ', '//duration(total/count)//' each'
  end function each

  pure real(wp) function iterations_each(outcome)
    type(kinematic_outcome_type), intent(in) :: outcome

    iterations_each = real(outcome%tracker%iterations, wp)/max(1, outcome%rows)
  end function iterations_each

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

  !> The same, and more, as JSON.
  subroutine save_kinematic_report(path, mechanism, plan, table_path, exit_code, outcome, err)
    character(len=*), intent(in) :: path
    type(mechanism_type), intent(in) :: mechanism
    type(plan_type), intent(in) :: plan
    character(len=*), intent(in) :: table_path
    integer, intent(in) :: exit_code               !< that the program is going to answer
    type(kinematic_outcome_type), intent(in) :: outcome
    type(error_type), allocatable, intent(out) :: err
    type(json_type) :: json

    call json%begin_object()
    call json%add('program', 'mech9k')
    call json%add('version', version)
    call json%add('revision', revision)
    call json%add('compiler', compiler())
    call json%add('title', mechanism%title)
    call json%add('exit_code', exit_code)
    call json%add('table', table_path)
    call json%add('positions', outcome%rows)
    call json%add('steps', outcome%tracker%steps)
    call json%add('halvings', outcome%tracker%halvings)
    call json%add('newton_iterations', outcome%tracker%iterations)
    call json%add('newton_iterations_per_position', iterations_each(outcome))
    call json%add('largest_closure', outcome%tracker%worst_closure)
    call json%add('size', plan%length)
    call json%add('least_conditioning', outcome%tracker%least_conditioning)
    call json%add('seconds_solving', outcome%seconds_solving)
    call json%add('seconds_writing', outcome%seconds_writing)
    call add_structure(json, mechanism, plan)
    call json%end_object()
    call json%save(path, err)
  end subroutine save_kinematic_report

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
                          [(plan%steps(block%unknowns(i))%coordinate, i=1, size(block%unknowns))])
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
end module mech9_kinematic_report
