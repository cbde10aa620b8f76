!> Bodies and gravity from a checked document.
module mech9_body_reader
  use mech9_kinds, only: wp
  use mech9_text, only: to_text
  use mech9_structure, only: structure_type
  use mech9_pair, only: pair_slot_type
  use mech9_turning_direction, only: turning_search_type, new_turning_search
  use mech9_body, only: body_type
  use mech9_document, only: document_type, group_type
  use mech9_lookup, only: groups_named, get_integer, get_real, get_reals, span_of
  use mech9_motion_reader, only: check_link
  use mech9_joint_words, only: pair_name
  use mech9_diagnostics, only: diagnostics_type
  implicit none
  private
  public :: read_bodies, read_gravity

  !> Relative size below which a part of a tensor, or an angle of its axes [rad], counts as zero: data are often rounded to
  !> three digits.
  real(wp), parameter :: slack = 1.0e-3_wp

contains

  !> All groups &body: masses, centres and inertia tensors, checked.
  pure subroutine read_bodies(document, structure, pairs, bodies, diagnostics)
    type(document_type), intent(in) :: document             !< the data file as groups and items
    type(structure_type), intent(in) :: structure           !< the structure; without links where it is not known
    type(pair_slot_type), intent(in) :: pairs(:)            !< (M) pairs by coordinate; a slot is empty where its group has an error
    type(body_type), allocatable, intent(out) :: bodies(:)  !< one for each sound group, in their order
    type(diagnostics_type), intent(inout) :: diagnostics    !< gets the errors
    type(turning_search_type), allocatable :: search
    integer, allocatable :: numbers(:)
    real(wp) :: j(6)
    logical :: judged
    integer :: i

    numbers = groups_named(document, 'body')
    allocate (bodies(size(numbers)))
    judged = size(numbers) > 0 .and. structure%n_links > 0
    do i = 1, size(pairs)
      judged = judged .and. allocated(pairs(i)%pair)
    end do
    do i = 1, size(numbers)
      associate (group => document%groups(numbers(i)))
        bodies(i)%link = get_integer(group, 'link')
        bodies(i)%mass = get_real(group, 'mass')
        bodies(i)%centre = get_reals(group, 'centre')
        j = get_reals(group, 'inertia')
        bodies(i)%inertia = reshape([j(1), j(4), j(5), j(4), j(2), j(6), j(5), j(6), j(3)], [3, 3])
        bodies(i)%place = diagnostics%place(group%span)
        call check_link(group, 'link', 1, structure%shown_links(), diagnostics)
        call check_inertia(group, structure, pairs, bodies(i), judged .and. bodies(i)%link <= structure%shown_links(), search, &
                           diagnostics)
      end associate
    end do
  end subroutine read_bodies

  !> Report a tensor that no body has. For a link that can turn about one direction only, the moment about that direction
  !> is enough; the rest of its tensor may be zero.
  pure subroutine check_inertia(group, structure, pairs, body, judged, search, diagnostics)
    type(group_type), intent(in) :: group                 !< the group of the data file
    type(structure_type), intent(in) :: structure         !< links and joints
    type(pair_slot_type), intent(in) :: pairs(:)          !< (M) pairs by coordinate
    type(body_type), intent(in) :: body                   !< the body that the group describes
    logical, intent(in) :: judged                         !< whether it is known how the link can turn
    type(turning_search_type), allocatable, intent(inout) :: search   !< directions in which links turn; made when it is needed
    type(diagnostics_type), intent(inout) :: diagnostics  !< gets the errors
    character(len=:), allocatable :: problem
    real(wp) :: direction(3)
    logical :: has_one, is_enough
    integer :: at, barrier

    call judge_tensor(body%inertia, problem, at)
    if (.not. allocated(problem)) return
    call only_direction(body%inertia, direction, has_one)
    if (has_one) then
      if (.not. judged) return                               ! the structure or the pairs have errors, which were reported
      if (.not. allocated(search)) then
        allocate (search)
        call new_turning_search(structure, pairs, search)
      end if
      call search%turns_only_about(body%link, direction, slack, is_enough, barrier)
      if (is_enough) return
      problem = problem//'; one moment alone is enough where a link turns about the axis of that moment only'
      if (barrier > 0) problem = problem//', and '//trim(pair_name(structure, barrier))//' lets link '//to_text(body%link)// &
                                 ' turn otherwise'
      problem = problem//'; give all three moments'
    end if
    call diagnostics%add(span_of(group, 'inertia', at), problem)
  end subroutine check_inertia

  !> The direction of a tensor that has a moment about one direction and nothing else.
  pure subroutine only_direction(inertia, direction, has_one)
    real(wp), intent(in) :: inertia(3, 3)  !< tensor of inertia about the mass centre, in the axes of the link [kg m^2]
    real(wp), intent(out) :: direction(3)  !< direction of the moment, in the axes of the link, of length 1
    logical, intent(out) :: has_one        !< whether the tensor is of this form
    real(wp) :: moment
    integer :: i, k

    i = maxloc([(inertia(k, k), k=1, 3)], dim=1)
    direction = [0.0_wp, 0.0_wp, 1.0_wp]
    has_one = inertia(i, i) > 0.0_wp
    if (.not. has_one) return
    direction = inertia(:, i)/norm2(inertia(:, i))
    moment = dot_product(direction, matmul(inertia, direction))
    do k = 1, 3
      has_one = has_one .and. all(abs(inertia(:, k) - moment*direction*direction(k)) <= slack*moment)
    end do
  end subroutine only_direction

  !> Whether a body can have a tensor. Its second moments, half the trace of the tensor minus the tensor, form a
  !> matrix without negative eigenvalues; with it the tensor has none either, and no principal moment exceeds the sum
  !> of the two others. All principal minors of such a matrix are zero or positive.
  pure subroutine judge_tensor(inertia, problem, at)
    real(wp), intent(in) :: inertia(3, 3)  !< tensor of inertia about the mass centre, in the axes of the link [kg m^2]
    character(len=:), allocatable, intent(out) :: problem  !< the error in words; not allocated where there is none
    integer, intent(out) :: at                             !< position of the wrong number in the list of the data file
    real(wp) :: s(3, 3), scale
    integer :: i

    at = 1
    scale = maxval(abs(inertia))
    if (.not. scale > 0.0_wp) return
    s = -inertia/scale
    do i = 1, 3
      s(i, i) = s(i, i) + 0.5_wp*(inertia(1, 1) + inertia(2, 2) + inertia(3, 3))/scale
    end do
    do i = 1, 3
      if (s(i, i) >= -slack) cycle
      at = i
      problem = 'no body has this inertia: '//moment_name(i)//' exceeds the sum of the two others'
      return
    end do
    if (minor(s, 1, 2) >= -slack .and. minor(s, 1, 3) >= -slack .and. minor(s, 2, 3) >= -slack &
        .and. determinant(s) >= -slack) return
    at = 4
    problem = 'no body has this inertia: the products xy, xz, yz are too large for the moments xx, yy, zz '// &
              '(xy is minus the integral of x y dm)'
  end subroutine judge_tensor

  !> The name of a moment of inertia.
  pure function moment_name(i) result(name)
    integer, intent(in) :: i  !< number of the axis: 1, 2 or 3
    character(len=2) :: name
    character(len=2), parameter :: names(3) = ['xx', 'yy', 'zz']

    name = names(i)
  end function moment_name

  !> Determinant of two rows and the same two columns.
  pure real(wp) function minor(a, i, j)
    real(wp), intent(in) :: a(3, 3)  !< symmetric matrix
    integer, intent(in) :: i         !< number of the first row and column
    integer, intent(in) :: j         !< number of the second row and column

    minor = a(i, i)*a(j, j) - a(i, j)*a(j, i)
  end function minor

  !> Determinant of a matrix.
  pure real(wp) function determinant(a)
    real(wp), intent(in) :: a(3, 3)  !< symmetric matrix

    determinant = a(1, 1)*(a(2, 2)*a(3, 3) - a(2, 3)*a(3, 2)) - a(1, 2)*(a(2, 1)*a(3, 3) - a(2, 3)*a(3, 1)) &
                  + a(1, 3)*(a(2, 1)*a(3, 2) - a(2, 2)*a(3, 1))
  end function determinant

  !> The acceleration of gravity; zero where the file has none.
  pure function read_gravity(document) result(gravity)
    type(document_type), intent(in) :: document  !< the data file as groups and items
    real(wp) :: gravity(3)
    integer, allocatable :: numbers(:)

    gravity = 0.0_wp
    numbers = groups_named(document, 'gravity')
    if (size(numbers) > 0) gravity = get_reals(document%groups(numbers(1)), 'acceleration')
  end function read_gravity
end module mech9_body_reader
