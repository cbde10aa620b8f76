!> One block of a plan in planar arithmetic as straight-line Fortran: the statements that close its chain and find its motion.
!>
!> The formulas are those of mech9_planar_formulas, mech9_planar_motion and mech9_planar_chain, written out for each step. Variables of a
!> frame i are ci, si, xi, yi (pose), wi, vxi, vyi (velocity), ei, axi, ayi (acceleration) and hxi, hyi (from its parent's origin).
module mech9_made_block_text
  use mech9_text, only: to_text
  use mech9_plan, only: plan_type, block_type
  use mech9_planar_chain, only: new_planar_chain
  use mech9_made_motion, only: per_step, per_closure
  use mech9_made_motion_text, only: writer_type, frame_text_type, index_length, axes, write_rows, write_velocities, &
    write_accelerations
  use mech9_made_terms, only: lines_type, sum_of, product_of, negative, literal, full, term_length
  use mech9_made_names, only: name_places, name_numbers, others_of
  implicit none
  private
  public :: write_statements

  integer, parameter :: l = term_length

contains

  !> The statements of a block, from its coordinates to the motion of its frames.
  subroutine write_statements(plan, block, is_fixed, is_shared, writer)
    type(plan_type), intent(in) :: plan            !< the plan
    type(block_type), intent(in) :: block          !< its block
    logical, intent(in) :: is_fixed(:)             !< (numbers of the plan) it is a constant
    logical, intent(in) :: is_shared               !< blocks of equal form share the statements: places and constants are arguments
    type(writer_type), intent(out) :: writer       !< gets the statements
    character(len=l) :: length

    if (block%last_closure >= block%first_closure) writer%chain = new_planar_chain(plan, block)
    call name_places(plan, block, is_shared, writer)
    call name_numbers(plan, block, is_fixed, is_shared, writer)
    call read_others(plan, block, writer)
    call write_turns(plan, block, writer)
    if (writer%chain%used) then
      length = writer%number(size(writer%number))
      if (writer%per_length == '') call writer%lines%keep('per_length', '1.0_wp/'//length, writer%per_length)
      call write_closing(plan, block, writer)
    else
      call write_poses(plan, block, writer)
    end if
    call write_pose_results(plan, block, writer)
    call write_velocities(plan, block, writer)
    call writer%lines%put('    is_solved = .true.')
    call writer%lines%put('    if (.not. full) return')
    call write_accelerations(plan, block, writer)
  end subroutine write_statements

  !> Read the motion of frames of other blocks at which steps of the block, or branches of its loop, begin.
  subroutine read_others(plan, block, writer)
    type(plan_type), intent(in) :: plan            !< the plan
    type(block_type), intent(in) :: block          !< its block
    type(writer_type), intent(inout) :: writer     !< of the block
    logical :: is_read(0:plan%n_coordinates)
    integer :: i, p
    character(len=index_length) :: k
    character(len=index_length + 3) :: at

    is_read = others_of(plan, block, writer)
    do i = 1, plan%n_coordinates
      if (.not. is_read(i)) cycle
      k = writer%name(i)
      at = ', '//trim(writer%place(i))//')'
      associate (frame => writer%frame(i))
        call writer%lines%keep('c'//trim(k), 'f(1'//at, frame%c)
        call writer%lines%keep('s'//trim(k), 'f(2'//at, frame%s)
        call writer%lines%keep('w'//trim(k), 'v(1'//at, frame%w)
        frame%e = 'a(1'//at
        do p = 1, 2
          call writer%lines%keep(axes(p)//trim(k), 'f('//to_text(p + 2)//at, frame%p(p))
          call writer%lines%keep('v'//axes(p)//trim(k), 'v('//to_text(p + 1)//at, frame%v(p))
          frame%a(p) = 'a('//to_text(p + 1)//at
        end do
      end associate
    end do
  end subroutine read_others

  !> Cosines and sines of the angles by which steps turn.
  subroutine write_turns(plan, block, writer)
    type(plan_type), intent(in) :: plan            !< the plan
    type(block_type), intent(in) :: block          !< its block
    type(writer_type), intent(inout) :: writer     !< of the block
    character(len=l) :: angle
    integer :: i, k

    k = 0
    do i = block%first_step, block%last_step
      associate (step => plan%planar%steps(i))
        if (.not. step%turns) cycle
        k = k + 1
        angle = product_of(literal(step%turn), 'q('//trim(writer%coordinate(i))//')')
        angle = sum_of(angle, writer%number(per_step*(i - 1) + 1))
        call writer%lines%set('angles('//to_text(k)//')', angle)
        writer%frame(i)%turn(1) = 'cs(1, '//to_text(k)//')'
        writer%frame(i)%turn(2) = 'cs(2, '//to_text(k)//')'
      end associate
    end do
    if (k > 0) call writer%lines%put(repeat(' ', writer%lines%depth)//'call find_turns('//to_text(k)//', angles, cs)')
  end subroutine write_turns

  !> Poses of the frames.
  subroutine write_poses(plan, block, writer)
    type(plan_type), intent(in) :: plan            !< the plan
    type(block_type), intent(in) :: block          !< its block
    type(writer_type), intent(inout) :: writer     !< of the block
    character(len=l) :: place(2)
    integer :: i, j
    character(len=index_length) :: k

    do i = block%first_step, block%last_step
      k = writer%name(i)
      associate (step => plan%planar%steps(i), frame => writer%frame(i), parent => writer%frame(plan%planar%steps(i)%parent), &
                 lines => writer%lines)
        place = writer%number(per_step*(i - 1) + 2:per_step*(i - 1) + 3)
        if (step%turns) then
          call lines%keep('c'//trim(k), sum_of(product_of(parent%c, frame%turn(1)), &
                                          negative(product_of(parent%s, frame%turn(2)))), frame%c)
          call lines%keep('s'//trim(k), sum_of(product_of(parent%s, frame%turn(1)), &
                                          product_of(parent%c, frame%turn(2))), frame%s)
        else
          frame%c = parent%c
          frame%s = parent%s
          do j = 1, 2
            call lines%keep('p'//axes(j)//trim(k), sum_of(place(j), &
                            product_of('q('//trim(writer%coordinate(i))//')', writer%number(per_step*(i - 1) + 3 + j))), place(j))
          end do
          call turned_vector(parent, writer%number(per_step*(i - 1) + 4:per_step*(i - 1) + 5), 's', trim(k), lines, frame%slide)
        end if
        call turned_vector(parent, place, 'h', trim(k), lines, frame%arm)
        do j = 1, 2
          call lines%keep(axes(j)//trim(k), sum_of(parent%p(j), frame%arm(j)), frame%p(j))
        end do
      end associate
    end do
  end subroutine write_poses

  !> The components in the plane's axes of a vector that is given in those of a frame.
  subroutine turned_vector(frame, vector, letter, k, lines, turned)
    type(frame_text_type), intent(in) :: frame           !< the frame
    character(len=l), intent(in) :: vector(2)            !< operands
    character(len=*), intent(in) :: letter               !< at the beginning of its name
    character(len=*), intent(in) :: k                    !< at the end of its name
    type(lines_type), intent(inout) :: lines             !< get statements
    character(len=l), intent(out) :: turned(2)           !< operands
    character(len=l) :: sums(2)
    integer :: j

    sums(1) = sum_of(product_of(frame%c, vector(1)), negative(product_of(frame%s, vector(2))))
    sums(2) = sum_of(product_of(frame%s, vector(1)), product_of(frame%c, vector(2)))
    do j = 1, 2
      call lines%keep(letter//axes(j)//k, sums(j), turned(j))
    end do
  end subroutine turned_vector

  !> Newton's method for the chain, up to the inverse and the pivots of the Jacobian at the closed position.
  subroutine write_closing(plan, block, writer)
    type(plan_type), intent(in) :: plan            !< the plan
    type(block_type), intent(in) :: block          !< its block
    type(writer_type), intent(inout) :: writer     !< of the block
    character(len=l) :: matrix(3, 3), cofactor(3, 3)

    associate (lines => writer%lines)
      call lines%put('    is_last = .false.')
      call lines%set('previous', '0')
      call lines%put('    do')
      lines%depth = 6
      call write_poses(plan, block, writer)
      call write_jacobian(plan, writer, matrix)
      call write_inverse(lines, matrix, cofactor)
      call lines%put('      if (is_last) exit')
      call write_residual(plan, block, writer)
      call lines%put('      if (largest <= closed .and. iterations > 0) exit')
      call lines%put('      if (iterations == most_iterations .or. .not. largest < 1.0_wp) return')
      call write_correction(plan, block, writer, cofactor)
      call lines%put('    end do')
      lines%depth = 4
      call write_factors(lines, matrix, cofactor)
    end associate
  end subroutine write_closing

  !> The residual of the three equations.
  subroutine write_residual(plan, block, writer)
    type(plan_type), intent(in) :: plan            !< the plan
    type(block_type), intent(in) :: block          !< its block
    type(writer_type), intent(inout) :: writer     !< of the block
    character(len=l) :: cosine, sine, place(2), goal(2), gap(3), angle(2)
    integer :: before, j

    before = per_step*size(plan%planar%steps) + per_closure*(block%first_closure - 1)
    cosine = writer%number(before + 1)
    sine = writer%number(before + 2)
    place = writer%number(before + 3:before + 4)
    associate (i => writer%frame(writer%chain%closure%closing), t => writer%frame(writer%chain%closure%target), &
               lines => writer%lines)
      call lines%keep('goal_c', sum_of(product_of(t%c, cosine), negative(product_of(t%s, sine))), goal(1))
      call lines%keep('goal_s', sum_of(product_of(t%s, cosine), product_of(t%c, sine)), goal(2))
      angle(1) = sum_of(product_of(goal(1), i%c), product_of(goal(2), i%s))
      angle(2) = sum_of(product_of(goal(1), i%s), negative(product_of(goal(2), i%c)))
      call lines%set('sine', angle(2))
      call lines%set('cosine', angle(1))
      call lines%set('gap1', 'sine*(1.0_wp + sine**2*(1.0_wp/6.0_wp + sine**2*(3.0_wp/40.0_wp + sine**2*(5.0_wp/112.0_wp))))')
      call lines%put('      if (.not. (cosine > 0.0_wp .and. abs(sine) < 1.0e-2_wp)) gap1 = atan2(sine, cosine)')
      call turned_vector(t, place, 'goal_', '', lines, goal)
      do j = 1, 2
        call lines%keep('gap'//to_text(j + 1), sum_of(i%p(j), negative(t%p(j)), negative(goal(j))), &
                        gap(j + 1))
      end do
      gap(1) = 'gap1'
      call write_rows(writer, gap, 'residual')
      call lines%set('largest', 'max(abs(residual1), abs(residual2), abs(residual3))')
    end associate
  end subroutine write_residual

  !> The Jacobian of the three equations.
  subroutine write_jacobian(plan, writer, matrix)
    type(plan_type), intent(in) :: plan            !< the plan
    type(writer_type), intent(inout) :: writer     !< of the block
    character(len=l), intent(out) :: matrix(3, 3)  !< operands
    character(len=l) :: factor, arm(2)
    integer :: j, s

    associate (lines => writer%lines, chain => writer%chain)
      associate (base => writer%frame(chain%closure%base), closing => writer%frame(chain%closure%closing))
        do j = 1, 2
          call lines%keep('base_'//axes(j), sum_of(base%p(j), negative(closing%p(j))), writer%base(j))
        end do
        do j = 1, 3
          s = chain%unknowns(j)
          associate (step => plan%planar%steps(s), frame => writer%frame(s), sign => literal(chain%signs(s)))
            if (step%turns) then
              matrix(1, j) = literal(chain%signs(s)*step%turn)
              factor = product_of(matrix(1, j), writer%per_length)
              call lines%keep('bx'//trim(writer%name(s)), sum_of(base%p(1), negative(frame%p(1))), arm(1))
              call lines%keep('by'//trim(writer%name(s)), sum_of(frame%p(2), negative(base%p(2))), arm(2))
              call lines%keep('j2'//to_text(j), product_of(factor, arm(2)), matrix(2, j))
              call lines%keep('j3'//to_text(j), product_of(factor, arm(1)), matrix(3, j))
            else
              matrix(1, j) = '0'
              matrix(2, j) = product_of(sign, frame%slide(1))
              matrix(3, j) = product_of(sign, frame%slide(2))
            end if
          end associate
        end do
      end associate
    end associate
  end subroutine write_jacobian

  !> Cofactors of the Jacobian, and its inverse.
  subroutine write_inverse(lines, matrix, cofactor)
    type(lines_type), intent(inout) :: lines           !< get statements
    character(len=l), intent(in) :: matrix(3, 3)       !< operands of the Jacobian
    character(len=l), intent(out) :: cofactor(3, 3)    !< operands of the cofactors: a row is the product of two columns
    integer, parameter :: next(3) = [2, 3, 1], second(3) = [3, 1, 2]
    integer :: i, j

    do j = 1, 3
      do i = 1, 3
        associate (u => matrix(:, next(j)), v => matrix(:, second(j)))
          call lines%keep('k'//to_text(j)//to_text(i), sum_of(product_of(u(next(i)), v(second(i))), &
                          negative(product_of(u(second(i)), v(next(i))))), cofactor(j, i))
        end associate
      end do
    end do
    call lines%set('volume', sum_of(product_of(matrix(1, 1), cofactor(1, 1)), &
                             product_of(matrix(2, 1), cofactor(1, 2)), product_of(matrix(3, 1), cofactor(1, 3))))
    call lines%put('      if (.not. abs(volume) > 0.0_wp) return')
    call lines%set('per_volume', '1.0_wp/volume')
  end subroutine write_inverse

  !> The change of the three coordinates that cancels the residual.
  subroutine write_correction(plan, block, writer, cofactor)
    type(plan_type), intent(in) :: plan              !< the plan
    type(block_type), intent(in) :: block            !< its block
    type(writer_type), intent(inout) :: writer       !< of the block
    character(len=l), intent(in) :: cofactor(3, 3)   !< operands of the cofactors of the Jacobian
    character(len=l) :: unit, coordinate
    integer :: j, k, s

    associate (lines => writer%lines)
      do j = 1, 3
        s = block%unknowns(j)
        unit = '1'
        if (.not. plan%planar%steps(s)%turns) unit = writer%number(size(writer%number))
        call lines%set('change'//to_text(j), sum_of(product_of(cofactor(j, 1), 'residual1'), &
                       product_of(cofactor(j, 2), 'residual2'), product_of(cofactor(j, 3), 'residual3')))
        call lines%set('change'//to_text(j), '-per_volume*change'//to_text(j))
        coordinate = 'q('//trim(writer%coordinate(s))//')'
        call lines%set(trim(coordinate), sum_of(coordinate, product_of(unit, 'change'//to_text(j))))
      end do
      call lines%set('largest', 'max(abs(change1), abs(change2), abs(change3))')
      call lines%put('      iterations = iterations + 1')
      call lines%put('      correction = correction + largest')
      call lines%put('      if (iterations == 2) contraction = largest/max(previous, tiny(previous))')
      call lines%set('previous', 'largest')
      call lines%put('      if (largest <= unchanged_position) exit')
      call lines%put('      is_last = largest <= last_correction')
      call lines%put('      if (largest <= small_turn) then')
      k = 0
      do s = block%first_step, block%last_step
        if (.not. plan%planar%steps(s)%turns) cycle
        k = k + 1
        do j = 1, 3
          if (block%unknowns(j) == s) &
            call lines%put('        call add_turn('//trim(product_of(literal(plan%planar%steps(s)%turn), 'change'//to_text(j)))// &
                           ', cs(:, '//to_text(k)//'))')
        end do
      end do
      call lines%put('      else')
      lines%depth = 8
      call write_turns(plan, block, writer)
      lines%depth = 6
      call lines%put('      end if')
    end associate
  end subroutine write_correction

  !> Pivots and inverse of the Jacobian.
  subroutine write_factors(lines, matrix, cofactor)
    type(lines_type), intent(inout) :: lines           !< get statements
    character(len=l), intent(in) :: matrix(3, 3)       !< operands of the Jacobian
    character(len=l), intent(in) :: cofactor(3, 3)     !< operands of its cofactors
    integer :: j

    do j = 1, 3
      call lines%put('    jacobian(:, '//to_text(j)//') = ['//trim(full(matrix(1, j)))//', '//trim(full(matrix(2, j)))//', '// &
                     trim(full(matrix(3, j)))//']')
      call lines%put('    inverse('//to_text(j)//', :) = ['//trim(full(cofactor(j, 1)))//', '//trim(full(cofactor(j, 2)))//', '// &
                     trim(full(cofactor(j, 3)))//']')
    end do
    call lines%put('    call find_pivots(jacobian, inverse, volume, pivots, sign_of_det, is_exact)')
    call lines%put('    if (.not. is_exact) return')
    call lines%put('    inverse = per_volume*inverse')
  end subroutine write_factors

  !> Poses, turns and slides into the arrays of frames.
  subroutine write_pose_results(plan, block, writer)
    type(plan_type), intent(in) :: plan            !< the plan
    type(block_type), intent(in) :: block          !< its block
    type(writer_type), intent(inout) :: writer     !< of the block
    integer :: i
    character(len=index_length) :: k

    do i = block%first_step, block%last_step
      k = writer%place(i)
      associate (frame => writer%frame(i), lines => writer%lines)
        call lines%put('    f(:, '//trim(k)//') = ['//trim(full(frame%c))//', '//trim(full(frame%s))//', '// &
                       trim(full(frame%p(1)))//', '//trim(full(frame%p(2)))//']')
        if (plan%planar%steps(i)%turns) then
          call lines%put('    turn(:, '//trim(k)//') = '//'cs(:, '//frame%turn(1)(7:))
        else
          call lines%put('    slide(:, '//trim(k)//') = ['//trim(full(frame%slide(1)))//', '//trim(full(frame%slide(2)))//']')
        end if
      end associate
    end do
  end subroutine write_pose_results
end module mech9_made_block_text
