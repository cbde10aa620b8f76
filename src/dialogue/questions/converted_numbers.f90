!> The numbers of a draft in other units of the data file.
!>
!> Nothing is converted where the unit of one number is not known, as of a quantity, where a parameter sets numbers that change by
!> several factors, and where numbers stand in formulas or in files beside the data file.
module mech9_converted_numbers
  use mech9_kinds, only: wp
  use mech9_text, only: to_text
  use mech9_units, only: units_type
  use mech9_grammar, only: item_table
  use mech9_item_rows, only: item_row_for_kind
  use mech9_draft, only: draft_type, plain_name
  use mech9_draft_joints, only: kind_in
  use mech9_unit_factors, only: find_factors, is_same
  implicit none
  private
  public :: convert_numbers, changed_units

contains

  !> The units that differ, such as "m" and "mm", or "m, rad" and "mm, deg"; both are empty where none does.
  pure subroutine changed_units(before, after, old, new)
    type(units_type), intent(in) :: before                !< units of the data file
    type(units_type), intent(in) :: after                 !< the other ones
    character(len=:), allocatable, intent(out) :: old     !< those before
    character(len=:), allocatable, intent(out) :: new     !< those after

    old = ''
    new = ''
    call append(trim(before%length_name), trim(after%length_name), old, new)
    call append(trim(before%angle_name), trim(after%angle_name), old, new)
    call append(trim(before%force_name), trim(after%force_name), old, new)
    call append(trim(before%mass_name), trim(after%mass_name), old, new)
    call append(trim(before%rate_name), trim(after%rate_name), old, new)
    old = old(3:)
    new = new(3:)
  end subroutine changed_units

  !> Append the names of a unit to two lists where they differ.
  pure subroutine append(one, other, old, new)
    character(len=*), intent(in) :: one                       !< name before
    character(len=*), intent(in) :: other                     !< name after
    character(len=:), allocatable, intent(inout) :: old       !< names before, with commas between
    character(len=:), allocatable, intent(inout) :: new       !< names after

    if (one == other) return
    old = old//', '//one
    new = new//', '//other
  end subroutine append

  !> Convert all numbers of a draft. Where any cannot be, the draft stays as it is.
  pure subroutine convert_numbers(before, after, draft, count, left)
    type(units_type), intent(in) :: before                !< units in which the numbers are
    type(units_type), intent(in) :: after                 !< units in which they are to be
    type(draft_type), intent(inout) :: draft              !< groups and names with their values as text
    integer, intent(out) :: count                         !< how many answers have numbers that change, or that cannot be converted
    character(len=:), allocatable, intent(out) :: left    !< answers that cannot be converted, with commas between; empty: none
    type(draft_type) :: converted
    character(len=:), allocatable :: text
    logical :: is_known
    integer :: g, e

    count = 0
    left = ''
    converted = draft
    do g = 1, size(draft%groups)
      do e = 1, size(draft%groups(g)%entries)
        text = draft%groups(g)%entries(e)%text
        call convert_entry(draft, g, e, before, after, text, is_known)
        if (is_known .and. text == draft%groups(g)%entries(e)%text) cycle
        count = count + 1
        converted%groups(g)%entries(e)%text = text
        if (.not. is_known) left = left//', '//draft%groups(g)%name//' '//to_text(draft%place_of(g))//' '// &
                                   draft%groups(g)%entries(e)%name
      end do
    end do
    left = left(3:)
    if (left == '') draft = converted
  end subroutine convert_numbers

  !> Convert the numbers of one answer.
  pure subroutine convert_entry(draft, g, e, before, after, text, is_known)
    type(draft_type), intent(in) :: draft                    !< groups and names with their values as text
    integer, intent(in) :: g                                 !< index of the group
    integer, intent(in) :: e                                 !< number of the answer in it
    type(units_type), intent(in) :: before                   !< units in which the numbers are
    type(units_type), intent(in) :: after                    !< units in which they are to be
    character(len=:), allocatable, intent(inout) :: text     !< the answer; becomes the converted one
    logical, intent(out) :: is_known                         !< the units are known
    real(wp), allocatable :: factors(:)
    character(len=:), allocatable :: name
    integer :: row

    is_known = .true.
    name = plain_name(draft%groups(g)%entries(e)%name)
    row = item_row_for_kind(draft%groups(g)%name, name, kind_in(draft, g))
    if (row == 0) return
    if (item_table(row)%type == 'text') then
      if (name == 'file' .or. name == 'formula') is_known = all_stay(draft, before, after)
      return
    else if (item_table(row)%type /= 'real') then
      return
    end if
    call find_factors(draft, g, name, before, after, factors, is_known)
    if (.not. is_known) return
    ! an element of a list, as in point(2), has the unit of the list where this has one
    if (name /= draft%groups(g)%entries(e)%name) is_known = all(is_same(factors/factors(1)))
    if (is_known) call convert_list(factors, text, is_known)
  end subroutine convert_entry

  !> Whether the numbers in files and formulas stay as they are: no unit of lengths, angles, forces or rates changes, and no
  !> parameter has another one.
  pure logical function all_stay(draft, before, after)
    type(draft_type), intent(in) :: draft                    !< groups and names with their values as text
    type(units_type), intent(in) :: before                   !< units in which the numbers are
    type(units_type), intent(in) :: after                    !< units in which they are to be
    real(wp), allocatable :: factors(:)
    integer :: g

    all_stay = is_same(before%size_of('m')/after%size_of('m')) .and. is_same(before%size_of('rad')/after%size_of('rad')) .and. &
               is_same(before%size_of('N')/after%size_of('N')) .and. is_same(before%size_of('rad/s')/after%size_of('rad/s'))
    do g = 1, size(draft%groups)
      if (.not. all_stay) return
      if (draft%groups(g)%name /= 'parameter') cycle
      call find_factors(draft, g, 'value', before, after, factors, all_stay)
      if (all_stay) all_stay = is_same(factors(1))
    end do
  end function all_stay

  !> Convert the numbers of a list.
  pure subroutine convert_list(factors, text, is_known)
    real(wp), intent(in) :: factors(:)                       !< (n) factors of the numbers in turn, the last one of all further ones [1]
    character(len=:), allocatable, intent(inout) :: text     !< the numbers; become the converted ones
    logical, intent(out) :: is_known                         !< they are plain numbers
    character(len=:), allocatable :: new, word
    real(wp) :: factor, value
    integer :: at, last, i, iostat
    logical :: changes

    is_known = .true.
    changes = .false.
    new = ''
    at = 1
    i = 0
    do
      at = at - 1 + verify(text(at:)//'x', ' ,'//achar(9))
      if (at > len(text)) exit
      last = at - 2 + scan(text(at:)//' ', ' ,'//achar(9))
      word = text(at:last)
      i = i + 1
      factor = factors(min(i, size(factors)))
      if (.not. is_same(factor)) then
        read (word, *, iostat=iostat) value
        is_known = iostat == 0 .and. verify(word, '0123456789+-.eEdD') == 0
        if (.not. is_known) return
        changes = changes .or. abs(value) > 0.0_wp
        word = to_text(value*factor, 15)
      else if (index(word, '*') > 0) then
        ! 3*0.5 stands for three numbers, of which the units may differ
        is_known = all(is_same(factors))
        if (.not. is_known) return
      end if
      new = new//', '//word
      at = last + 1
    end do
    if (changes) text = new(3:)
  end subroutine convert_list
end module mech9_converted_numbers
