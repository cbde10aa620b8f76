!> Fortran for the closed chains of one mechanism, a part of `mech9-link --specialise`: a module of straight-line code, and the submodule by
!> which the programs find it.
module mech9_made_code
  use mech9_program_kind, only: kinematics
  use mech9_kinds, only: wp
  use mech9_text, only: to_text, in_apostrophes
  use mech9_error, only: error_type
  use mech9_printable, only: with_escapes
  use mech9_text_file, only: save_text
  use mech9_tolerances, only: closed_to_round_off, last_correction
  use mech9_motion_tolerances, only: small_turn, unchanged_position
  use mech9_least_squares, only: nearly_dependent
  use mech9_counted, only: counted
  use mech9_model, only: model_type
  use mech9_plan, only: plan_type
  use mech9_state, only: state_type
  use mech9_made_motion, only: can_be_made, structure_of_plan, key_of_block, numbers_of_plan, per_step, per_closure
  use mech9_driven_simulation, only: assemble_driven
  use mech9_varied_document, only: varied_document_type
  use mech9_checked_mechanism, only: checked_mechanism_type
  use mech9_made_terms, only: lines_type, literal, full
  use mech9_made_procedures, only: write_procedures
  implicit none
  private
  public :: write_made_code

  character, parameter :: eol = achar(10)
  !> By this line mech9-link knows files that it may replace.
  character(len=*), parameter :: first_line = '! Motion of one mechanism, written by mech9-link --specialise from the data file '
  !> Change of a parameter that shows which numbers depend on it, in parts of its value.
  real(wp), parameter :: change = 1.0e-3_wp

contains

  !> Write a file with the code for a mechanism. Fails as a run of mech9k would, and with exit_file where the file cannot be written.
  subroutine write_made_code(mechanism, data_file, path, told, err)
    type(checked_mechanism_type), intent(in) :: mechanism     !< the mechanism
    character(len=*), intent(in) :: data_file                 !< name of its data file
    character(len=*), intent(in) :: path                      !< of the file to write
    character(len=:), allocatable, intent(out) :: told        !< how much of it is made
    type(error_type), allocatable, intent(out) :: err         !< allocated if it failed
    type(model_type) :: model
    type(plan_type) :: plan
    type(state_type) :: state
    type(lines_type) :: lines
    character(len=:), allocatable :: groups
    logical, allocatable :: is_fixed(:)
    integer, allocatable :: made(:)
    integer :: b, i, steps

    call mechanism%take(kinematics, model, err)
    if (.not. allocated(err)) call assemble_driven(model, plan, state, err)
    call mechanism%point_at(err)
    if (allocated(err)) return
    allocate (made(0), is_fixed(0))
    do b = 1, size(plan%blocks)
      if (can_be_made(plan, plan%blocks(b))) made = [made, b]
    end do
    if (size(made) > 0) call find_fixed_numbers(mechanism, model, plan, is_fixed)
    steps = 0
    call lines%put(first_line//with_escapes(data_file, '', ['']))
    call write_module_head(size(made), lines)
    call write_procedures(plan, made, is_fixed, lines)
    do i = 1, size(made)
      steps = steps + plan%blocks(made(i))%last_step - plan%blocks(made(i))%first_step + 1
    end do
    call write_turn_procedures(lines)
    call lines%put('end module mech9_motion_of_one')
    call mechanism%text_of_fixed(groups)
    call write_submodule(plan, made, is_fixed, groups, data_file, lines)
    call save_text(path, lines%text, err)
    told = to_text(steps)//' of '//counted(plan%n_coordinates, 'pair')//' in '//to_text(size(made))//' of '// &
           counted(size(plan%blocks), 'block')
  end subroutine write_made_code

  !> Find the numbers of the plan that no parameter changes. Where a parameter cannot be changed, all count as variable.
  subroutine find_fixed_numbers(mechanism, model, plan, is_fixed)
    type(checked_mechanism_type), intent(in) :: mechanism      !< the mechanism
    type(model_type), intent(in) :: model                      !< its model
    type(plan_type), intent(in) :: plan                        !< its plan
    logical, allocatable, intent(out) :: is_fixed(:)           !< (numbers of the plan)
    type(varied_document_type) :: variable
    type(model_type) :: other
    type(plan_type) :: other_plan
    type(state_type) :: state
    type(error_type), allocatable :: err
    real(wp), allocatable :: numbers(:), others(:), values(:), shifted(:)
    integer :: i

    call numbers_of_plan(plan, numbers)
    allocate (is_fixed(size(numbers)), source=.true.)
    if (size(model%parameters) == 0) return
    call mechanism%take_variable(kinematics, variable)
    values = model%parameters%value
    do i = 1, size(values)
      shifted = values
      shifted(i) = values(i) + change*max(abs(values(i)), change)
      call variable%at(shifted, other, err)
      if (.not. allocated(err)) call assemble_driven(other, other_plan, state, err)
      if (.not. allocated(err)) call numbers_of_plan(other_plan, others)
      if (allocated(err)) exit
      if (size(others) /= size(numbers)) exit
      is_fixed = is_fixed .and. .not. abs(others - numbers) > 0.0_wp
    end do
    if (i <= size(values)) is_fixed = .false.
  end subroutine find_fixed_numbers

  !> The head of the module with the code.
  subroutine write_module_head(count, lines)
    integer, intent(in) :: count                !< number of blocks for which there is code
    type(lines_type), intent(inout) :: lines    !< get the head

    call lines%put('! move closes the chains one after the other, from a guess of the dependent coordinates by')
    call lines%put('! Newton''s method, and finds rates, accelerations and the motion of all frames. It needs nothing but Fortran.')
    call lines%put('module mech9_motion_of_one')
    call lines%put('  use, intrinsic :: iso_fortran_env, only: wp => real64')
    call lines%put('  implicit none')
    call lines%put('  private')
    if (count > 0) call lines%put('  public :: move')
    call lines%put('')
    call lines%put('  ! a closed chain; the last correction; round-off; turns that two terms add; singular matrices')
    call lines%put('  real(wp), parameter :: closed = '//trim(literal(closed_to_round_off)))
    call lines%put('  real(wp), parameter :: last_correction = '//trim(literal(last_correction)))
    call lines%put('  real(wp), parameter :: unchanged_position = '//trim(literal(unchanged_position)))
    call lines%put('  real(wp), parameter :: small_turn = '//trim(literal(small_turn)))
    call lines%put('  real(wp), parameter :: nearly_dependent = '//trim(literal(nearly_dependent)))
    call lines%put('  integer, parameter :: most_iterations = 8')
    call lines%put('contains')
  end subroutine write_module_head

  !> The procedures for cosines and sines, with the method of mech9_sine_cosine.
  subroutine write_turn_procedures(lines)
    type(lines_type), intent(inout) :: lines    !< get the procedures
    character(len=*), parameter :: text(*) = [character(len=120) :: &
      '', &
      '  ! Cosines and sines: whole quarter turns are subtracted, and the series are taken at the rest.', &
      '  pure subroutine find_turns(count, angles, cs)', &
      '    integer, intent(in) :: count             ! of angles', &
      '    real(wp), intent(in) :: angles(count)    ! [rad]', &
      '    real(wp), intent(out) :: cs(2, count)    ! cosine and sine of each', &
      '    real(wp), parameter :: quarter(3) = [1.57079632673412561417_wp, 6.07710050630396597660e-11_wp, &', &
      '                                         2.02226624879595063154e-21_wp]', &
      '    real(wp), parameter :: whole = 1.5_wp*2.0_wp**52', &
      '    real(wp) :: quarters, x, left, z, most, c, s', &
      '    integer :: i', &
      '', &
      '    if (.not. maxval(abs(angles)) <= 1.0e6_wp) then', &
      '      cs(1, :) = cos(angles)', &
      '      cs(2, :) = sin(angles)', &
      '      return', &
      '    end if', &
      '    do i = 1, count', &
      '      quarters = (angles(i)*0.636619772367581343076_wp + whole) - whole', &
      '      z = angles(i) - quarters*quarter(1)', &
      '      most = z - quarters*quarter(2)', &
      '      x = most - quarters*quarter(3)', &
      '      left = ((z - most) - quarters*quarter(2)) + ((most - x) - quarters*quarter(3))', &
      '      z = x**2', &
      '      s = z*(1.0_wp/6227020800.0_wp + z*(-1.0_wp/1307674368000.0_wp + z/355687428096000.0_wp))', &
      '      s = z*(-1.0_wp/39916800.0_wp + s)', &
      '      s = z*(-1.0_wp/6.0_wp + z*(1.0_wp/120.0_wp + z*(-1.0_wp/5040.0_wp + z*(1.0_wp/362880.0_wp + s))))', &
      '      s = x + (left*(1.0_wp - 0.5_wp*z) + x*s)', &
      '      most = 1.0_wp - 0.5_wp*z', &
      '      c = z*(1.0_wp/479001600.0_wp + z*(-1.0_wp/87178291200.0_wp + z/20922789888000.0_wp))', &
      '      c = z*(-1.0_wp/3628800.0_wp + c)', &
      '      c = z**2*(1.0_wp/24.0_wp + z*(-1.0_wp/720.0_wp + z*(1.0_wp/40320.0_wp + c)))', &
      '      c = most + (((1.0_wp - most) - 0.5_wp*z) - x*left + c)', &
      '      quarters = quarters - 4.0_wp*((0.25_wp*quarters + whole) - whole)', &
      '      x = merge(s, c, abs(abs(quarters) - 1.0_wp) < 0.5_wp)', &
      '      z = merge(c, s, abs(abs(quarters) - 1.0_wp) < 0.5_wp)', &
      '      cs(1, i) = merge(-x, x, quarters > 0.5_wp .or. quarters < -1.5_wp)', &
      '      cs(2, i) = merge(-z, z, quarters > 1.5_wp .or. quarters < -0.5_wp)', &
      '    end do', &
      '  end subroutine find_turns', &
      '', &
      '  ! Add a small angle.', &
      '  pure subroutine add_turn(small, cs)', &
      '    real(wp), intent(in) :: small      ! [rad]', &
      '    real(wp), intent(inout) :: cs(2)   ! cosine and sine', &
      '', &
      '    cs = [cs(1) - small*(cs(2) + 0.5_wp*small*cs(1)), cs(2) + small*(cs(1) - 0.5_wp*small*cs(2))]', &
      '  end subroutine add_turn', &
      '', &
      '  ! The pivots of a Jacobian: its longest column, the largest area that another one spans with it over that length,', &
      '  ! and the volume of all three over that area. The inverse is as exact as the columns are far apart about a pair of the', &
      '  ! chain, in lengths of the chain. These may be small in those of the mechanism, and the base may be far away.', &
      '  pure subroutine find_pivots(jacobian, cofactor, volume, pivots, sign_of_det, is_exact)', &
      '    real(wp), intent(in) :: jacobian(3, 3)   ! the matrix', &
      '    real(wp), intent(in) :: cofactor(3, 3)   ! the vector products of its columns, as rows', &
      '    real(wp), intent(in) :: volume           ! its determinant', &
      '    real(wp), intent(inout) :: pivots(3)     ! not increasing; zero where they cannot be found', &
      '    integer, intent(inout) :: sign_of_det    ! -1 or 1', &
      '    logical, intent(out) :: is_exact         ! the inverse by cofactors', &
      '    real(wp) :: lengths(3), areas(3), own(2, 3), place(2), area, scale', &
      '    integer :: turning', &
      '', &
      '    is_exact = .false.', &
      '    lengths = jacobian(1, :)**2 + jacobian(2, :)**2 + jacobian(3, :)**2', &
      '    areas = cofactor(:, 1)**2 + cofactor(:, 2)**2 + cofactor(:, 3)**2', &
      '    pivots(1) = max(lengths(1), lengths(2), lengths(3))', &
      '    if (lengths(1) >= pivots(1)) then', &
      '      area = max(areas(2), areas(3))', &
      '    else if (lengths(2) >= pivots(1)) then', &
      '      area = max(areas(1), areas(3))', &
      '    else', &
      '      area = max(areas(1), areas(2))', &
      '    end if', &
      '    pivots = [sqrt(pivots(1)), 0.0_wp, 0.0_wp]', &
      '    if (.not. area > 0.0_wp) return', &
      '    area = sqrt(area)', &
      '    pivots = [pivots(1), area/pivots(1), abs(volume)/area]', &
      '    sign_of_det = merge(-1, 1, volume < 0.0_wp)', &
      '    is_exact = pivots(3) > nearly_dependent*pivots(1)', &
      '    if (is_exact) return', &
      '    turning = maxloc(abs(jacobian(1, :)), dim=1)', &
      '    place = jacobian(2:3, turning)*jacobian(1, turning)', &
      '    own(1, :) = jacobian(2, :) - place(1)*jacobian(1, :)', &
      '    own(2, :) = jacobian(3, :) - place(2)*jacobian(1, :)', &
      '    scale = maxval(own**2)', &
      '    if (.not. scale > 0.0_wp) return', &
      '    lengths = jacobian(1, :)**2 + (own(1, :)**2 + own(2, :)**2)/scale', &
      '    areas = (cofactor(:, 1) + place(1)*cofactor(:, 2) + place(2)*cofactor(:, 3))**2/scale', &
      '    areas = (areas + cofactor(:, 2)**2 + cofactor(:, 3)**2)/scale', &
      '    is_exact = abs(volume)/scale > nearly_dependent*sqrt(maxval(lengths)*maxval(areas))', &
      '  end subroutine find_pivots']
    integer :: i

    do i = 1, size(text)
      call lines%put(text(i))
    end do
  end subroutine write_turn_procedures

  !> The submodule by which the programs find the code.
  subroutine write_submodule(plan, made, is_fixed, groups, data_file, lines)
    type(plan_type), intent(in) :: plan         !< the plan
    integer, intent(in) :: made(:)              !< blocks of the plan for which there is code
    logical, intent(in) :: is_fixed(:)          !< (numbers of the plan) it is a constant
    character(len=*), intent(in) :: groups      !< groups of the data file that must not change
    character(len=*), intent(in) :: data_file   !< name of the data file
    type(lines_type), intent(inout) :: lines    !< get the submodule
    integer, allocatable :: structure(:), places(:)
    real(wp), allocatable :: numbers(:)
    integer :: i

    allocate (structure(0), numbers(0))
    if (size(made) > 0) then
      call structure_of_plan(plan, structure)
      call numbers_of_plan(plan, numbers)
      do i = 1, size(made)
        structure = [structure, key_of_block(plan%blocks(made(i)))]
      end do
    end if
    places = pack([(i, i=1, size(numbers))], is_fixed .and. is_used_by(plan, made, size(numbers)))
    call lines%put('')
    call lines%put('! The way from the programs to the code above.')
    call lines%put('submodule (mech9_made_blocks) mech9_made_blocks_of_one')
    if (size(made) > 0) call lines%put('  use mech9_motion_of_one, only: move')
    call lines%put('  implicit none')
    call lines%put('contains')
    call lines%put('')
    call lines%put('  pure module subroutine describe_made_plan(structure, places, values)')
    call lines%put('    integer, allocatable, intent(out) :: structure(:)   ! steps, closures and blocks of the plan')
    call lines%put('    integer, allocatable, intent(out) :: places(:)      ! of constants among the numbers of the plan')
    call lines%put('    real(wp), allocatable, intent(out) :: values(:)     ! of these constants')
    call lines%put('')
    call lines%put('    allocate (structure('//to_text(size(structure))//'), places('//to_text(size(places))//'), values('// &
                   to_text(size(places))//'))')
    call write_integers('structure', structure, lines)
    call write_integers('places', places, lines)
    call write_values(numbers(places), lines)
    call lines%put('  end subroutine describe_made_plan')
    call write_dispatch(size(made), lines)
    call write_description(groups, data_file, lines)
    call lines%put('end submodule mech9_made_blocks_of_one')
  end subroutine write_submodule

  !> Numbers of a plan that belong to some of its blocks, marked.
  pure function is_used_by(plan, made, count) result(is_used)
    type(plan_type), intent(in) :: plan         !< the plan
    integer, intent(in) :: made(:)              !< its blocks for which there is code
    integer, intent(in) :: count                !< of the numbers
    logical :: is_used(count)
    integer :: before, i, m

    is_used = .false.
    if (count == 0) return
    is_used(count) = .true.
    m = per_step*size(plan%planar%steps)
    do i = 1, size(made)
      associate (block => plan%blocks(made(i)))
        is_used(per_step*(block%first_step - 1) + 1:per_step*block%last_step) = .true.
        before = m + per_closure*(block%first_closure - 1)
        if (block%last_closure >= block%first_closure) is_used(before + 1:before + per_closure) = .true.
      end associate
    end do
  end function is_used_by

  !> Assignments of integers to the elements of an array, some in a line.
  subroutine write_integers(name, values, lines)
    character(len=*), intent(in) :: name        !< of the array
    integer, intent(in) :: values(:)            !< its elements
    type(lines_type), intent(inout) :: lines    !< get the assignments
    integer, parameter :: some = 15
    character(len=132) :: line
    integer :: from, i, to

    do from = 1, size(values), some
      to = min(from + some - 1, size(values))
      line = '    '//name//'('//to_text(from)//':'//to_text(to)//') = ['//to_text(values(from))
      do i = from + 1, to
        line = trim(line)//', '//to_text(values(i))
      end do
      call lines%put(trim(line)//']')
    end do
  end subroutine write_integers

  !> Assignments of numbers to the array of constants, some in a line.
  subroutine write_values(values, lines)
    real(wp), intent(in) :: values(:)           !< (constants) SI units [m, rad, kg, s and their products]
    type(lines_type), intent(inout) :: lines    !< get the assignments
    integer, parameter :: longest = 80
    character(len=132) :: line
    integer :: from, i

    line = ''
    from = 1
    do i = 1, size(values)
      if (i > from) line = trim(line)//','
      line = trim(line)//' '//trim(full(literal(values(i))))
      if (len_trim(line) < longest .and. i < size(values)) cycle
      call lines%put('    values('//to_text(from)//':'//to_text(i)//') = ['//trim(adjustl(line))//']')
      line = ''
      from = i + 1
    end do
  end subroutine write_values

  !> The procedure of the submodule that calls the code.
  subroutine write_dispatch(count, lines)
    integer, intent(in) :: count                !< number of blocks with code
    type(lines_type), intent(inout) :: lines    !< get the procedure
    character(len=*), parameter :: head(*) = [character(len=132) :: &
      '', &
      '  pure module subroutine move_made_block(block, n, full, q, dq, ddq, f, slide, turn, v, a, jacobian, inverse, course, &', &
      '                                         is_solved)', &
      '    integer, intent(in) :: block                      ! number of the block among those with code', &
      '    real(wp), intent(in) :: n(*)                      ! numbers of the plan', &
      '    logical, intent(in) :: full                       ! accelerations are found, too', &
      '    real(wp), intent(inout) :: q(*)                   ! coordinates', &
      '    real(wp), intent(inout) :: dq(*)                  ! rates', &
      '    real(wp), intent(inout) :: ddq(*)                 ! accelerations', &
      '    real(wp), intent(inout) :: f(4, 0:*)              ! poses of frames', &
      '    real(wp), intent(inout) :: slide(2, *)            ! directions of slides', &
      '    real(wp), intent(inout) :: turn(2, *)             ! cosines and sines of turns', &
      '    real(wp), intent(inout) :: v(3, 0:*)              ! velocities of frames', &
      '    real(wp), intent(inout) :: a(3, 0:*)              ! accelerations of frames', &
      '    real(wp), intent(inout) :: jacobian(3, 3)         ! of the equations of the chain', &
      '    real(wp), intent(inout) :: inverse(3, 3)          ! of the Jacobian', &
      '    type(made_course_type), intent(out) :: course     ! of Newton''s method', &
      '    logical, intent(out) :: is_solved', &
      '', &
      '    is_solved = .false.']
    integer :: i

    do i = 1, size(head)
      call lines%put(head(i))
    end do
    if (count > 0) then
      call lines%put('    call move(block, n, full, q, dq, ddq, f, slide, turn, v, a, jacobian, inverse, course%iterations, &')
      call lines%put('              course%correction, course%contraction, course%pivots, course%sign_of_det, is_solved)')
    end if
    call lines%put('  end subroutine move_made_block')
  end subroutine write_dispatch

  !> The procedure of the submodule that tells the mechanism. Its text stands there with a letter in place of ends of lines.
  subroutine write_description(groups, data_file, lines)
    character(len=*), intent(in) :: groups      !< groups of the data file that must not change
    character(len=*), intent(in) :: data_file   !< name of the data file
    type(lines_type), intent(inout) :: lines    !< get the procedure
    integer, parameter :: longest = 100
    character(len=len(groups)) :: text
    character :: mark
    integer :: from, i, to

    mark = unused_letter(groups)
    text = groups
    do i = 1, len(text)
      if (text(i:i) == eol) text(i:i) = mark
    end do
    call lines%put('')
    call lines%put('  pure module subroutine describe_made_mechanism(groups, name)')
    call lines%put('    character(len=:), allocatable, intent(out) :: groups   ! of the data file that must not change')
    call lines%put('    character(len=:), allocatable, intent(out) :: name     ! of the data file')
    call lines%put('    integer :: i')
    call lines%put('')
    call lines%put('    name = '//in_apostrophes(data_file))
    call lines%put('    groups = ''''')
    from = 1
    do while (from <= len(text))
      ! no blank at the end of a line, where it would not be seen
      to = min(from + longest - 1, len(text))
      if (to < len(text) .and. text(to:to) == ' ') to = to - 1
      call lines%put('    groups = groups//'//in_apostrophes(text(from:to)))
      from = to + 1
    end do
    call lines%put('    do i = 1, len(groups)')
    call lines%put('      if (groups(i:i) == '//in_apostrophes(mark)//') groups(i:i) = achar(10)')
    call lines%put('    end do')
    call lines%put('  end subroutine describe_made_mechanism')
  end subroutine write_description

  !> A letter that does not occur in a text.
  pure character function unused_letter(text) result(letter)
    character(len=*), intent(in) :: text   !< any text
    character(len=*), parameter :: letters = '|~^`@?#$%;!{}[]<>_+*'
    integer :: i

    do i = 1, len(letters)
      letter = letters(i:i)
      if (index(text, letter) == 0) return
    end do
    ! data files hold no control characters
    letter = achar(1)
  end function unused_letter
end module mech9_made_code
