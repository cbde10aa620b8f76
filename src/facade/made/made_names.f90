!> Names, indices and numbers in the code of a block (see mech9_made_block_text). Where blocks of equal form share their code, indices are
!> elements of an argument k, and constants elements of an argument z.
module mech9_made_names
  use mech9_kinds, only: wp
  use mech9_text, only: to_text
  use mech9_plan, only: plan_type, block_type
  use mech9_made_motion, only: numbers_of_plan, per_step, per_closure
  use mech9_made_motion_text, only: writer_type
  use mech9_made_terms, only: literal, term_length
  implicit none
  private
  public :: name_places, name_numbers, others_of

  integer, parameter :: l = term_length

contains

  !> The names and indices of frames and coordinates: their numbers, or elements of k in the order of the frames that are read, the
  !> frames that are made, and the coordinates of these.
  subroutine name_places(plan, block, is_shared, writer)
    type(plan_type), intent(in) :: plan            !< the plan
    type(block_type), intent(in) :: block          !< its block
    logical, intent(in) :: is_shared               !< places are arguments
    type(writer_type), intent(inout) :: writer     !< of the block
    logical :: is_used(0:plan%n_coordinates)
    integer :: i, m

    m = plan%n_coordinates
    allocate (writer%frame(0:m), writer%name(0:m), writer%place(0:m), writer%coordinate(m), writer%k(0))
    do i = 1, m
      writer%name(i) = to_text(i)
      writer%place(i) = to_text(i)
      writer%coordinate(i) = to_text(plan%planar%steps(i)%coordinate)
    end do
    if (.not. is_shared) return
    is_used = others_of(plan, block, writer)
    is_used(block%first_step:block%last_step) = .true.
    do i = 1, m
      if (.not. is_used(i)) cycle
      writer%k = [writer%k, i]
      writer%name(i) = to_text(size(writer%k))
      writer%place(i) = 'k('//to_text(size(writer%k))//')'
    end do
    do i = block%first_step, block%last_step
      writer%k = [writer%k, plan%planar%steps(i)%coordinate]
      writer%coordinate(i) = 'k('//to_text(size(writer%k))//')'
    end do
  end subroutine name_places

  !> The operands of the block's numbers: constants, elements of z where the code is shared, or elements of n where they can change.
  subroutine name_numbers(plan, block, is_fixed, is_shared, writer)
    type(plan_type), intent(in) :: plan            !< the plan
    type(block_type), intent(in) :: block          !< its block
    logical, intent(in) :: is_fixed(:)             !< (numbers of the plan) it is a constant
    logical, intent(in) :: is_shared               !< constants are arguments
    type(writer_type), intent(inout) :: writer     !< of the block
    real(wp), allocatable :: numbers(:)
    integer :: before, c, i

    call numbers_of_plan(plan, numbers)
    allocate (writer%number(size(numbers)), writer%z(0))
    writer%number = ''
    do i = per_step*(block%first_step - 1) + 1, per_step*block%last_step
      call name_number(i)
    end do
    do c = block%first_closure, block%last_closure
      before = per_step*size(plan%planar%steps) + per_closure*(c - 1)
      do i = before + 1, before + per_closure
        call name_number(i)
      end do
    end do
    i = size(numbers)
    call name_number(i)
    writer%per_length = ''
    if (is_fixed(i)) call name_constant(1.0_wp/numbers(i), writer%per_length)

  contains

    !> The operand of one number.
    subroutine name_number(i)
      integer, intent(in) :: i    !< its place among the numbers of the plan

      if (is_fixed(i)) then
        call name_constant(numbers(i), writer%number(i))
      else if (is_shared) then
        writer%k = [writer%k, i]
        writer%number(i) = 'n(k('//to_text(size(writer%k))//'))'
      else
        writer%number(i) = 'n('//to_text(i)//')'
      end if
    end subroutine name_number

    !> The operand of a constant. Those by which nothing need be multiplied are written out in any case.
    subroutine name_constant(value, operand)
      real(wp), intent(in) :: value              !< of any unit
      character(len=l), intent(out) :: operand   !< gets the operand

      operand = literal(value)
      if (.not. is_shared .or. scan(operand, '_') == 0) return
      writer%z = [writer%z, value]
      operand = 'z('//to_text(size(writer%z))//')'
    end subroutine name_constant
  end subroutine name_numbers

  !> The frames of other blocks at which steps of a block, or branches of its loop, begin, marked.
  pure function others_of(plan, block, writer) result(is_read)
    type(plan_type), intent(in) :: plan            !< the plan
    type(block_type), intent(in) :: block          !< its block
    type(writer_type), intent(in) :: writer        !< of the block, with its chain
    logical :: is_read(0:plan%n_coordinates)

    is_read = .false.
    is_read(plan%planar%steps(block%first_step:block%last_step)%parent) = .true.
    if (writer%chain%used) is_read([writer%chain%stems, writer%chain%closure%base, writer%chain%closure%target]) = .true.
    is_read(0) = .false.
    is_read(block%first_step:block%last_step) = .false.
  end function others_of
end module mech9_made_names
