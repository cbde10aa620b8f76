!> Periodic motions in words: period, multipliers and stability.
module mech9_periodic_words
  use mech9_kinds, only: wp
  use mech9_text, only: to_text
  use mech9_part_names, only: add_names
  use mech9_counted, only: counted
  use mech9_mechanism, only: mechanism_type
  use mech9_model, only: model_type
  use mech9_result_units, only: unit_of, unit_name
  use mech9_periodic_motion, only: periodic_motion_type, belongs_to_family, stable, unstable, lost_at_plus_one, lost_at_minus_one
  use mech9_periodic, only: periodic_found_type
  implicit none
  private
  public :: print_periodic

contains

  !> Print the motions.
  subroutine print_periodic(unit, model, found, with_results)
    integer, intent(in) :: unit                          !< Fortran unit to write to
    type(model_type), intent(in) :: model                !< the model
    type(periodic_found_type), intent(in) :: found       !< the motions
    logical, intent(in) :: with_results                  !< a run records the first one
    integer :: i

    do i = 1, size(found%motions)
      if (size(found%motions) > 1) write (unit, '(a)') 'motion '//to_text(i)//' of '//to_text(size(found%motions))//':'
      call print_motion(unit, model%mechanism, found%motions(i))
    end do
    if (found%starts > 1) write (unit, '(a)') counted(size(found%motions), 'periodic motion')//' from '// &
      counted(found%starts, 'start')//'; '//to_text(found%failed)//' led to none'
    if (size(found%motions) > 1 .and. with_results) write (unit, '(a)') 'the results are those of motion 1'
  end subroutine print_periodic

  !> Print a motion.
  subroutine print_motion(unit, mechanism, motion)
    integer, intent(in) :: unit                          !< Fortran unit to write to
    type(mechanism_type), intent(in) :: mechanism        !< the mechanism
    type(periodic_motion_type), intent(in) :: motion     !< the motion
    character(len=:), allocatable :: words
    integer :: k

    if (motion%is_trivial) then
      write (unit, '(a)') 'equilibrium: nothing moves, and every time is a period; multipliers are those of '// &
        to_text(motion%period, 10)//' s'
    else
      words = 'period '//to_text(motion%period, 10)//' s'
      if (motion%repeats_after > 0.0_wp) &
        words = words//'; the motion repeats already after '//to_text(motion%repeats_after, 10)//' s'
      write (unit, '(a)') words
    end if
    do k = 1, size(motion%turns)
      if (motion%turns(k) == 0) cycle
      words = 'coordinate '//to_text(k)//' turns by '//counted(abs(motion%turns(k)), 'whole turn')//' in a period'
      if (motion%turns(k) < 0) words = words//', backwards'
      call add_names(mechanism%names, words)
      write (unit, '(a)') words
    end do
    do k = 1, size(motion%advance)
      if (.not. abs(motion%advance(k)) > 0.0_wp) cycle
      words = 'coordinate '//to_text(k)//' goes on by '//to_text(motion%advance(k)/unit_of(mechanism, k), 10)//' '// &
              trim(unit_name(mechanism, k))//' in a period; no force depends on it'
      call add_names(mechanism%names, words)
      write (unit, '(a)') words
    end do
    write (unit, '(a)') 'multipliers '//multiplier_words(motion)
    write (unit, '(a)') stability_words(motion)
    words = 'product of the multipliers '//to_text(motion%product, 6)
    if (motion%knows_volume) words = words//'; by the divergence along the motion '//to_text(motion%product_by_divergence, 6)
    write (unit, '(a)') words
    k = maxloc(abs(motion%residual), dim=1)
    write (unit, '(a)') counted(motion%iterations, 'correction')//' by Newton''s method; both ends differ by '// &
      to_text(abs(motion%residual(k))/unit_of(mechanism, k), 2)//' '//trim(unit_name(mechanism, k))//' at most, in coordinate '// &
      to_text(k)
  end subroutine print_motion

  !> The multipliers in words, of a pair both at once.
  function multiplier_words(motion) result(words)
    type(periodic_motion_type), intent(in) :: motion     !< the motion
    character(len=:), allocatable :: words
    integer :: k

    words = ''
    do k = 1, size(motion%multipliers)
      associate (multiplier => motion%multipliers(k))
        if (aimag(multiplier) < 0.0_wp) cycle
        if (words /= '') words = words//', '
        words = words//to_text(real(multiplier, wp), 6)
        if (aimag(multiplier) > 0.0_wp) words = words//' +- '//to_text(aimag(multiplier), 6)//' i'
      end associate
    end do
  end function multiplier_words

  !> The stability in words.
  function stability_words(motion) result(words)
    type(periodic_motion_type), intent(in) :: motion     !< the motion
    character(len=:), allocatable :: words

    if (motion%stability == stable) then
      words = 'stable'
    else if (motion%stability == unstable .and. motion%lost == lost_at_plus_one) then
      words = 'unstable: a multiplier lies beyond 1'
    else if (motion%stability == unstable .and. motion%lost == lost_at_minus_one) then
      words = 'unstable: a multiplier lies beyond -1, so that the motion alternates in each second period'
    else if (motion%stability == unstable) then
      words = 'unstable: a pair of multipliers lies outside the unit circle'
    else
      words = 'neither stable nor unstable by its multipliers, which lie on the unit circle within errors'
    end if
    if (motion%is_free .and. .not. motion%is_trivial) then
      words = words//'; one multiplier is 1, along the motion'
      if (motion%cyclic > 0) words = words//', and '//to_text(motion%cyclic)//' by what goes on'
      if (belongs_to_family(motion)) words = words//', and further ones belong to a family of motions'
    end if
  end function stability_words
end module mech9_periodic_words
