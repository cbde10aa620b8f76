!> Frictions in a check and in reports.
module mech9_friction_text
  use mech9_named_words, only: with_names
  use mech9_kinds, only: wp
  use mech9_text, only: to_text
  use mech9_counted, only: counted
  use mech9_mechanism, only: mechanism_type
  use mech9_result_units, only: force_unit_name, si_force, length_text
  use mech9_driven_frictions, only: rest_range_type
  implicit none
  private
  public :: print_frictions, print_rest, print_left_out

contains

  !> Print all frictions; nothing where there are none.
  subroutine print_frictions(unit, mechanism)
    integer, intent(in) :: unit                        !< the output unit
    type(mechanism_type), intent(in) :: mechanism      !< the mechanism
    character(len=:), allocatable :: words
    integer :: i

    if (.not. mechanism%has_frictions()) return
    write (unit, '(a)') 'frictions:'
    do i = 1, size(mechanism%frictions)
      associate (friction => mechanism%frictions(i))
        words = 'friction '//to_text(i)//': coordinate '//to_text(friction%coordinate)//' '
        if (friction%is_helical()) then
          words = words//'on a thread of the mean radius '//trim(length_text(mechanism, friction%radius, 4))// &
                  '; from the coefficient '// &
                  to_text(abs(friction%lead)/friction%radius, 6)//' on it holds a force along its axis by itself'
        else if (friction%turns) then
          words = words//'turns in a bearing of the radius '//trim(length_text(mechanism, friction%radius, 4))
          if (friction%face_radius > 0.0) &
            words = words//', on a face of the mean radius '//trim(length_text(mechanism, friction%face_radius, 4))
        else
          words = words//'slides'
          if (friction%arm > 0.0) words = words//' in a guide of the half length '//trim(length_text(mechanism, friction%arm, 4))
        end if
        words = words//'; coefficients '//to_text(friction%static, 4)//' at rest, '//to_text(friction%dynamic, 4)//' in motion'
        if (friction%is_smooth) words = words//', smooth'
        write (unit, '(2x,a)') with_names(mechanism%names, words)
      end associate
    end do
  end subroutine print_frictions

  !> Print at how many outputs of a driven motion friction counts as zero, and the range of the drive's force at the first one.
  subroutine print_rest(unit, mechanism, rest)
    integer, intent(in) :: unit                        !< the output unit
    type(mechanism_type), intent(in) :: mechanism      !< the mechanism
    type(rest_range_type), intent(in) :: rest          !< outputs at rest
    character(len=:), allocatable :: words
    real(wp) :: of_force

    if (rest%outputs == 0) return
    of_force = 1.0_wp
    if (rest%coordinate > 0) &
      of_force = mechanism%units%size_of(trim(si_force(mechanism%pairs(rest%coordinate)%pair)))
    words = 'pairs are at rest at '//counted(rest%outputs, 'output')//', where their friction counts as 0'
    if (rest%coordinate > 0) words = words//'; at t = '//to_text(rest%t, 8)//' s the force of the drive of coordinate '// &
                                     to_text(rest%coordinate)// &
                                     ' lies between '//to_text(rest%force(1)/of_force, 6)//' and '// &
                                     to_text(rest%force(2)/of_force, 6)//' '// &
                                     trim(force_unit_name(mechanism, rest%coordinate))
    write (unit, '(a)') with_names(mechanism%names, words)
  end subroutine print_rest

  !> Say that the friction of pairs and contacts does not count in an equilibrium; nothing where there is none.
  subroutine print_left_out(unit, mechanism)
    integer, intent(in) :: unit                        !< the output unit
    type(mechanism_type), intent(in) :: mechanism      !< the mechanism
    integer :: i

    if (mechanism%has_frictions()) write (unit, '(a)') &
      'friction counts as 0: with it, the mechanism may rest in other positions near an equilibrium, too'
    if (.not. mechanism%has_contacts()) return
    if (any([(mechanism%contacts(i)%has_friction(), i=1, size(mechanism%contacts))])) write (unit, '(a)') &
      'friction of contacts counts as 0, and closed ones slide: with it, the mechanism may rest in other positions near an '// &
      'equilibrium, too, and may roll in place of sliding'
  end subroutine print_left_out
end module mech9_friction_text
