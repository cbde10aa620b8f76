!> The procedures for all blocks that are made: one for each block, or one for several blocks of equal form, and the one that calls them.
module mech9_made_procedures
  use mech9_text, only: to_text
  use mech9_plan, only: plan_type, block_type
  use mech9_made_terms, only: lines_type, literal, full
  use mech9_made_motion_text, only: writer_type
  use mech9_made_block_text, only: write_statements
  implicit none
  private
  public :: write_procedures

  !> So many blocks of equal form have code each of their own; more of them share theirs.
  integer, parameter :: most_alike = 3

contains

  !> Write the procedures for blocks of a plan.
  subroutine write_procedures(plan, made, is_fixed, lines)
    type(plan_type), intent(in) :: plan            !< the plan
    integer, intent(in) :: made(:)                 !< its blocks for which there is code
    logical, intent(in) :: is_fixed(:)             !< (numbers of the plan) it is a constant
    type(lines_type), intent(inout) :: lines       !< get the procedures
    type(writer_type), allocatable :: shared(:)
    type(writer_type) :: writer
    type(lines_type) :: calls, procedures
    integer :: first(size(made)), i

    if (size(made) == 0) return
    allocate (shared(size(made)))
    do i = 1, size(made)
      call write_statements(plan, plan%blocks(made(i)), is_fixed, .true., shared(i))
      first(i) = first_of_form(shared, i)
    end do
    do i = 1, size(made)
      call calls%put('    case ('//to_text(i)//')')
      associate (block => plan%blocks(made(i)))
        if (count(first == first(i)) <= most_alike) then
          call write_statements(plan, block, is_fixed, .false., writer)
          call write_procedure(plan, block, 'move_'//to_text(i), writer, procedures)
          call calls%put('      call move_'//to_text(i)//'(n, full, q, dq, ddq, f, slide, turn, v, a, &')
        else
          if (first(i) == i) call write_procedure(plan, block, 'form_'//to_text(i), shared(i), procedures)
          call write_call(first(i), shared(i), calls)
        end if
      end associate
      call calls%put('        jacobian, inverse, iterations, correction, contraction, pivots, sign_of_det, is_solved)')
    end do
    call write_selection(calls, lines)
    lines%text = lines%text//procedures%text
  end subroutine write_procedures

  !> The number of the first block that has the statements of a block.
  pure integer function first_of_form(shared, i) result(first)
    type(writer_type), intent(in) :: shared(:)     !< the statements of blocks
    integer, intent(in) :: i                       !< number of the block

    do first = 1, i - 1
      if (shared(first)%lines%text == shared(i)%lines%text) return
    end do
    first = i
  end function first_of_form

  !> The call of a shared procedure, up to the arguments that all procedures have.
  subroutine write_call(form, writer, calls)
    integer, intent(in) :: form                    !< number of the procedure
    type(writer_type), intent(in) :: writer        !< of the block
    type(lines_type), intent(inout) :: calls       !< get the call
    integer, parameter :: longest = 110
    character(len=132) :: line
    integer :: i

    line = '      call form_'//to_text(form)//'([integer ::'
    do i = 1, size(writer%k)
      call add_element(to_text(writer%k(i)), i)
    end do
    line = trim(line)//'], [real(wp) ::'
    do i = 1, size(writer%z)
      call add_element(trim(full(literal(writer%z(i)))), i)
    end do
    call calls%put(trim(line)//'], &')
    call calls%put('        n, full, q, dq, ddq, f, slide, turn, v, a, &')

  contains

    !> Append an element of an array to the line, or to a new one.
    subroutine add_element(element, i)
      character(len=*), intent(in) :: element      !< the element
      integer, intent(in) :: i                     !< its number

      if (i > 1) line = trim(line)//','
      if (len_trim(line) + len(element) < longest) then
        line = trim(line)//' '//element
      else
        call calls%put(trim(line)//' &')
        line = repeat(' ', 8)//element
      end if
    end subroutine add_element
  end subroutine write_call

  !> The procedure that calls the one of a block.
  subroutine write_selection(calls, lines)
    type(lines_type), intent(in) :: calls          !< the cases
    type(lines_type), intent(inout) :: lines       !< get the procedure

    call lines%put('')
    call lines%put('  !> Close the chain of a block and find its motion.')
    call lines%put('  pure subroutine move(block, n, full, q, dq, ddq, f, slide, turn, v, a, jacobian, inverse, &')
    call lines%put('                       iterations, correction, contraction, pivots, sign_of_det, is_solved)')
    call lines%put('    integer, intent(in) :: block               ! 1, 2, ... in the order of motion')
    call write_arguments(.true., lines)
    call lines%put('')
    call lines%put('    is_solved = .false.')
    call lines%put('    iterations = 0')
    call lines%put('    correction = 0.0_wp')
    call lines%put('    contraction = 0.0_wp')
    call lines%put('    select case (block)')
    lines%text = lines%text//calls%text
    call lines%put('    end select')
    call lines%put('  end subroutine move')
  end subroutine write_selection

  !> Write a procedure with the statements of a block.
  subroutine write_procedure(plan, block, name, writer, lines)
    type(plan_type), intent(in) :: plan            !< the plan
    type(block_type), intent(in) :: block          !< its block
    character(len=*), intent(in) :: name           !< of the procedure
    type(writer_type), intent(in) :: writer        !< of the block, with the statements
    type(lines_type), intent(inout) :: lines       !< get the procedure

    call write_head(plan, block, name, writer, lines)
    lines%text = lines%text//writer%lines%text
    call lines%put('  end subroutine '//name)
  end subroutine write_procedure

  !> The head of the procedure, with the declarations of all variables.
  subroutine write_head(plan, block, name, writer, lines)
    type(plan_type), intent(in) :: plan            !< the plan
    type(block_type), intent(in) :: block          !< its block
    character(len=*), intent(in) :: name           !< of the procedure
    type(writer_type), intent(in) :: writer        !< of the block, with the statements
    type(lines_type), intent(inout) :: lines       !< get the head
    character(len=132) :: line
    integer :: i, turning

    turning = count(plan%planar%steps(block%first_step:block%last_step)%turns)
    call lines%put('')
    if (size(writer%k) > 0) then
      call lines%put('  !> Blocks of equal form, with numbers k of frames and coordinates, and constants z.')
      call lines%put('  pure subroutine '//name//'(k, z, n, full, q, dq, ddq, f, slide, turn, v, a, jacobian, inverse, &')
    else
      line = '  !> The steps of coordinates '//to_text(plan%planar%steps(block%first_step:block%last_step)%coordinate)//'.'
      call lines%put(line)
      if (size(block%unknowns) > 0) then
        line = '  !> The dependent ones are '//to_text(block%coordinates)//'.'
        call lines%put(line)
      end if
      call lines%put('  pure subroutine '//name//'(n, full, q, dq, ddq, f, slide, turn, v, a, jacobian, inverse, &')
    end if
    call lines%put('                         iterations, correction, contraction, pivots, sign_of_det, is_solved)')
    if (size(writer%k) > 0) then
      call lines%put('    integer, intent(in) :: k(*)                ! numbers of the frames and coordinates of this block')
      call lines%put('    real(wp), intent(in) :: z(*)               ! its constants, in their order [m, rad, 1]')
    end if
    call write_arguments(.false., lines)
    if (turning > 0) call lines%put('    real(wp) :: angles('//to_text(turning)//'), cs(2, '//to_text(turning)//')')
    line = '    real(wp) ::'
    do i = 1, size(writer%lines%names)
      if (len_trim(line) + len_trim(writer%lines%names(i)) > 110) then
        call lines%put(line)
        line = '    real(wp) ::'
      end if
      if (line /= '    real(wp) ::') line = trim(line)//','
      line = trim(line)//' '//trim(writer%lines%names(i))
    end do
    call lines%put(line)
    if (size(block%unknowns) > 0) call lines%put('    logical :: is_last, is_exact')
    call lines%put('')
    call lines%put('    is_solved = .false.')
    call lines%put('    iterations = 0')
    call lines%put('    correction = 0.0_wp')
    call lines%put('    contraction = 0.0_wp')
  end subroutine write_head

  !> The arguments that all procedures have, with or without their meanings.
  subroutine write_arguments(with_meanings, lines)
    logical, intent(in) :: with_meanings           !< the meanings are told
    type(lines_type), intent(inout) :: lines       !< get the declarations

    if (with_meanings) then
      call lines%put('    real(wp), intent(in) :: n(*)               ! (numbers) of the mechanism that are not constants here [SI]')
      call lines%put('    logical, intent(in) :: full                ! accelerations are found, too')
      call lines%put('    real(wp), intent(inout) :: q(*)            ! (M) coordinates: given ones, guesses of the others [rad, m]')
      call lines%put('    real(wp), intent(inout) :: dq(*), ddq(*)   ! (M) rates, accelerations; some given [rad, m, per s]')
      call lines%put('    real(wp), intent(inout) :: f(4, 0:*)       ! (4,0:M) cosine, sine, x, y of frames, in the plane [1, m]')
      call lines%put('    real(wp), intent(inout) :: slide(2, *)     ! (2,M) directions of slides, in the plane [1]')
      call lines%put('    real(wp), intent(inout) :: turn(2, *)      ! (2,M) cosine and sine of turns [1]')
      call lines%put('    real(wp), intent(inout) :: v(3, 0:*)       ! (3,0:M) velocities of frames [rad/s, m/s]')
      call lines%put('    real(wp), intent(inout) :: a(3, 0:*)       ! (3,0:M) accelerations of frames [rad/s^2, m/s^2]')
      call lines%put('    real(wp), intent(inout) :: jacobian(3, 3)  ! of the three equations of the chain [1, m]')
      call lines%put('    real(wp), intent(inout) :: inverse(3, 3)   ! of the Jacobian [1, 1/m]')
      call lines%put('    integer, intent(out) :: iterations         ! corrections of the guess')
      call lines%put('    real(wp), intent(out) :: correction        ! sum of the largest change of a coordinate in each [rad, m]')
      call lines%put('    real(wp), intent(out) :: contraction       ! second change over the first; 0: one was enough [1]')
      call lines%put('    real(wp), intent(inout) :: pivots(3)       ! of the Jacobian, not increasing [1]')
      call lines%put('    integer, intent(inout) :: sign_of_det      ! of the Jacobian')
      call lines%put('    logical, intent(out) :: is_solved')
    else
      call lines%put('    real(wp), intent(in) :: n(*)                                ! all as in move, with their units')
      call lines%put('    logical, intent(in) :: full')
      call lines%put('    real(wp), intent(inout) :: q(*), dq(*), ddq(*), f(4, 0:*), slide(2, *), turn(2, *), v(3, 0:*), a(3, 0:*)')
      call lines%put('    real(wp), intent(inout) :: jacobian(3, 3), inverse(3, 3), pivots(3)')
      call lines%put('    real(wp), intent(out) :: correction, contraction')
      call lines%put('    integer, intent(out) :: iterations')
      call lines%put('    integer, intent(inout) :: sign_of_det')
      call lines%put('    logical, intent(out) :: is_solved')
    end if
  end subroutine write_arguments
end module mech9_made_procedures
