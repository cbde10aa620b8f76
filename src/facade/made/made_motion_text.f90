!> Velocities and accelerations of one block of a plan in planar arithmetic as straight-line Fortran (see mech9_made_block_text).
module mech9_made_motion_text
  use mech9_kinds, only: wp
  use mech9_text, only: to_text
  use mech9_plan, only: plan_type, block_type
  use mech9_planar_chain, only: planar_chain_type
  use mech9_made_terms, only: lines_type, sum_of, product_of, negative, literal, full, term_length
  implicit none
  private
  public :: writer_type, frame_text_type, index_length, axes, write_rows, write_velocities, write_accelerations

  integer, parameter :: l = term_length
  !> Letters of an index.
  integer, parameter :: index_length = 12
  character(len=*), parameter :: axes(2) = ['x', 'y']

  !> The operands of a frame and of the step that makes it.
  type :: frame_text_type
    character(len=l) :: c = '1'           !< cosine of its angle
    character(len=l) :: s = '0'           !< sine
    character(len=l) :: p(2) = '0'        !< origin
    character(len=l) :: arm(2) = '0'      !< from the origin of its parent
    character(len=l) :: slide(2) = '0'    !< velocity of the origin per unit rate
    character(len=l) :: turn(2) = '0'     !< cosine and sine of the angle by which its step turns
    character(len=l) :: w = '0'           !< angular velocity
    character(len=l) :: v(2) = '0'        !< velocity of the origin
    character(len=l) :: e = '0'           !< angular acceleration
    character(len=l) :: a(2) = '0'        !< acceleration of the origin
  end type frame_text_type

  !> A block while it is written.
  type :: writer_type
    type(lines_type) :: lines                          !< the statements
    type(frame_text_type), allocatable :: frame(:)     !< (0:M)
    type(planar_chain_type) :: chain                   !< of the block, if it closes one
    character(len=l), allocatable :: number(:)         !< numbers of the plan, as operands
    character(len=l) :: per_length = '1'               !< one over the mechanism's size
    character(len=l) :: base(2) = '0'                  !< from the closing frame's origin to that of the base
    character(len=l) :: opening(3) = '0'               !< relative motion of the ends of the loop without the unknown rates
    character(len=index_length), allocatable :: name(:)         !< (0:M) end of the names of a frame's variables
    character(len=index_length), allocatable :: place(:)        !< (0:M) index of a frame
    character(len=index_length), allocatable :: coordinate(:)   !< (M) index of the coordinate of a step
    integer, allocatable :: k(:)                       !< places, where the code is shared: frames, coordinates, numbers of the plan
    real(wp), allocatable :: z(:)                      !< constants, where the code is shared [rad, m]
  end type writer_type

contains

  !> The three equations for a motion of the ends of the loop at the closing frame's origin.
  subroutine write_rows(writer, motion, name)
    type(writer_type), intent(inout) :: writer             !< of the block
    character(len=l), intent(in) :: motion(3)              !< its operands
    character(len=*), intent(in) :: name                   !< of the three results, before 1, 2 or 3
    character(len=l) :: at_base

    associate (lines => writer%lines)
      call lines%set(name//'1', motion(1))
      call lines%keep('at_base', sum_of(motion(2), negative(product_of(name//'1', writer%base(2)))), at_base)
      call lines%set(name//'2', product_of(at_base, writer%per_length))
      call lines%keep('at_base', sum_of(motion(3), product_of(name//'1', writer%base(1))), at_base)
      call lines%set(name//'3', product_of(at_base, writer%per_length))
    end associate
  end subroutine write_rows

  !> Rates of the three coordinates, and velocities of the frames.
  subroutine write_velocities(plan, block, writer)
    type(plan_type), intent(in) :: plan            !< the plan
    type(block_type), intent(in) :: block          !< its block
    type(writer_type), intent(inout) :: writer     !< of the block
    character(len=l) :: sums(2), rate
    integer :: i, j
    character(len=index_length) :: k

    if (writer%chain%used) then
      call write_opening(plan, writer, .false.)
      call write_rates(plan, block, writer, 'dq')
    end if
    do i = block%first_step, block%last_step
      rate = 'dq('//trim(writer%coordinate(i))//')'
      k = writer%name(i)
      associate (step => plan%planar%steps(i), frame => writer%frame(i), parent => writer%frame(plan%planar%steps(i)%parent), &
                 lines => writer%lines)
        call lines%keep('w'//trim(k), sum_of(parent%w, product_of(literal(step%turn), rate)), frame%w)
        sums(1) = sum_of(parent%v(1), negative(product_of(parent%w, frame%arm(2))), &
                          product_of(rate, frame%slide(1)))
        sums(2) = sum_of(parent%v(2), product_of(parent%w, frame%arm(1)), product_of(rate, frame%slide(2)))
        do j = 1, 2
          call lines%keep('v'//axes(j)//trim(k), sums(j), frame%v(j))
        end do
        call lines%put('    v(:, '//trim(writer%place(i))//') = ['//trim(full(frame%w))//', '//trim(full(frame%v(1)))//', '// &
                       trim(full(frame%v(2)))//']')
      end associate
    end do
  end subroutine write_velocities

  !> Relative motion of the ends of the loop by the given coordinates and the frames at which it begins, at the closing frame.
  subroutine write_opening(plan, writer, of_accelerations)
    type(plan_type), intent(in) :: plan            !< the plan
    type(writer_type), intent(inout) :: writer     !< of the block
    logical, intent(in) :: of_accelerations        !< else of velocities
    character(len=l) :: turning, moving(2), rate, arm(2)
    character(len=3) :: name
    integer :: b, i, s

    writer%opening = '0'
    associate (chain => writer%chain)
      if (chain%stems(1) /= chain%stems(2)) then
        do b = 1, 2
          associate (stem => writer%frame(chain%stems(b)))
            turning = stem%w
            moving = stem%v
            if (of_accelerations) turning = stem%e
            if (of_accelerations) moving = stem%a
            call write_arm(writer, chain%stems(b), turning, arm)
          end associate
          if (b == 2) turning = negative(turning)
          if (b == 2) moving = [negative(moving(1)), negative(moving(2))]
          call add_to_opening(writer, 1, turning)
          call add_to_opening(writer, 2, moving(1), negative(product_of(turning, arm(2))))
          call add_to_opening(writer, 3, moving(2), product_of(turning, arm(1)))
        end do
      end if
      name = trim(merge('ddq', 'dq ', of_accelerations))
      do i = 1, size(chain%given)
        s = chain%given(i)
        rate = product_of(literal(chain%signs(s)), trim(name)//'('//trim(writer%coordinate(s))//')')
        if (plan%planar%steps(s)%turns) then
          rate = product_of(literal(plan%planar%steps(s)%turn), rate)
          call write_arm(writer, s, rate, arm)
          call add_to_opening(writer, 1, rate)
          call add_to_opening(writer, 2, negative(product_of(rate, arm(2))))
          call add_to_opening(writer, 3, product_of(rate, arm(1)))
        else
          call add_to_opening(writer, 2, product_of(rate, writer%frame(s)%slide(1)))
          call add_to_opening(writer, 3, product_of(rate, writer%frame(s)%slide(2)))
        end if
      end do
    end associate
  end subroutine write_opening

  !> The way from a frame's origin to that of the closing frame.
  subroutine write_arm(writer, i, turning, arm)
    type(writer_type), intent(inout) :: writer     !< of the block
    integer, intent(in) :: i                       !< number of the frame
    character(len=l), intent(in) :: turning        !< its turning; without any, no way is needed
    character(len=l), intent(out) :: arm(2)        !< operands [m]
    integer :: j

    arm = '0'
    if (turning == '0') return
    associate (closing => writer%frame(writer%chain%closure%closing), frame => writer%frame(i))
      do j = 1, 2
        call writer%lines%keep('arm'//axes(j), sum_of(closing%p(j), negative(frame%p(j))), arm(j))
      end do
    end associate
  end subroutine write_arm

  !> Add terms to one number of the opening of the loop.
  subroutine add_to_opening(writer, j, term, other)
    type(writer_type), intent(inout) :: writer           !< of the block
    integer, intent(in) :: j                             !< 1: angle, 2: x, 3: y
    character(len=*), intent(in) :: term                 !< an operand or a product
    character(len=*), intent(in), optional :: other      !< another one
    character(len=l) :: sum

    sum = term
    if (present(other)) sum = sum_of(term, other)
    if (sum == '0') return
    if (present(other)) then
      sum = sum_of(writer%opening(j), term, other)
    else
      sum = sum_of(writer%opening(j), term)
    end if
    writer%opening(j) = 'opening'//to_text(j)
    call writer%lines%set(trim(writer%opening(j)), sum)
  end subroutine add_to_opening

  !> The rates, or accelerations, of the three coordinates that cancel the opening of the loop.
  subroutine write_rates(plan, block, writer, name)
    type(plan_type), intent(in) :: plan            !< the plan
    type(block_type), intent(in) :: block          !< its block
    type(writer_type), intent(inout) :: writer     !< of the block
    character(len=*), intent(in) :: name           !< of the array of results
    character(len=l) :: unit
    integer :: j

    call write_rows(writer, writer%opening, 'row')
    do j = 1, 3
      unit = ''
      if (.not. plan%planar%steps(block%unknowns(j))%turns) unit = writer%number(size(writer%number))
      if (unit == '1') unit = ''
      if (unit /= '') unit = trim(unit)//'*'
      call writer%lines%set(name//'('//trim(writer%coordinate(block%unknowns(j)))//')', '-'//trim(unit)//'dot_product(inverse('// &
                            to_text(j)//', :), [row1, row2, row3])')
    end do
  end subroutine write_rates

  !> Accelerations of the three coordinates and of the frames.
  subroutine write_accelerations(plan, block, writer)
    type(plan_type), intent(in) :: plan            !< the plan
    type(block_type), intent(in) :: block          !< its block
    type(writer_type), intent(inout) :: writer     !< of the block
    character(len=l) :: square(0:plan%n_coordinates), coriolis(0:plan%n_coordinates), sum, rate
    integer :: i, j, p
    character(len=index_length) :: k

    associate (lines => writer%lines)
      square = '0'
      coriolis = '0'
      do i = block%first_step, block%last_step
        p = plan%planar%steps(i)%parent
        if (writer%frame(p)%w == '0') cycle
        if (square(p) == '0') then
          square(p) = 'square'//writer%name(p)
          call lines%set(square(p), trim(writer%frame(p)%w)//'**2')
        end if
        if (plan%planar%steps(i)%turns) cycle
        coriolis(i) = 'coriolis'//writer%name(i)
        rate = 'dq('//trim(writer%coordinate(i))//')'
        call lines%set(coriolis(i), '2.0_wp*'//trim(product_of(writer%frame(p)%w, rate)))
      end do
      if (writer%chain%used) then
        call write_opening(plan, writer, .true.)
        call write_bias(plan, block, writer, square, coriolis)
        call write_rates(plan, block, writer, 'ddq')
      end if
      do i = block%first_step, block%last_step
        p = plan%planar%steps(i)%parent
        rate = 'ddq('//trim(writer%coordinate(i))//')'
        k = writer%name(i)
        associate (step => plan%planar%steps(i), frame => writer%frame(i), parent => writer%frame(p))
          call lines%keep('e'//trim(k), sum_of(parent%e, product_of(literal(step%turn), rate)), frame%e)
          frame%a(1) = sum_of(parent%a(1), negative(product_of(parent%e, frame%arm(2))), &
                               negative(product_of(square(p), frame%arm(1))), product_of(rate, frame%slide(1)), &
                               negative(product_of(coriolis(i), frame%slide(2))))
          frame%a(2) = sum_of(parent%a(2), product_of(parent%e, frame%arm(1)), &
                               negative(product_of(square(p), frame%arm(2))), product_of(rate, frame%slide(2)), &
                               product_of(coriolis(i), frame%slide(1)))
          do j = 1, 2
            sum = frame%a(j)
            call lines%keep('a'//axes(j)//trim(k), sum, frame%a(j))
          end do
          call lines%put('    a(:, '//trim(writer%place(i))//') = ['//trim(full(frame%e))//', '//trim(full(frame%a(1)))//', '// &
                         trim(full(frame%a(2)))//']')
        end associate
      end do
    end associate
  end subroutine write_accelerations

  !> Add the centripetal and Coriolis terms to the opening of the loop.
  subroutine write_bias(plan, block, writer, square, coriolis)
    type(plan_type), intent(in) :: plan                 !< the plan
    type(block_type), intent(in) :: block               !< its block
    type(writer_type), intent(inout) :: writer          !< of the block
    character(len=l), intent(in) :: square(0:)          !< (0:M) of the angular velocity of each frame from which a step leads
    character(len=l), intent(in) :: coriolis(0:)        !< (0:M) twice the angular velocity times the rate of each slide
    character(len=l) :: arm(2), sign
    integer :: i, j

    associate (chain => writer%chain)
      do i = block%first_step, block%last_step
        if (.not. abs(chain%signs(i)) > 0.0_wp) cycle
        sign = literal(-chain%signs(i))
        associate (frame => writer%frame(i), whirl => square(plan%planar%steps(i)%parent))
          do j = 1, 2
            call add_to_opening(writer, j + 1, product_of(sign, product_of(whirl, frame%arm(j))))
          end do
          call add_to_opening(writer, 2, product_of(sign, product_of(coriolis(i), frame%slide(2))))
          call add_to_opening(writer, 3, negative(product_of(sign, product_of(coriolis(i), frame%slide(1)))))
        end associate
      end do
      ! the target's point at the closing frame's origin has a centripetal acceleration about the target's origin
      associate (target => writer%frame(chain%closure%target))
        call write_arm(writer, chain%closure%target, target%w, arm)
        if (target%w == '0') return
        do j = 1, 2
          call add_to_opening(writer, j + 1, product_of(trim(target%w)//'**2', arm(j)))
        end do
      end associate
    end associate
  end subroutine write_bias
end module mech9_made_motion_text
