!> Bodies and gravity from a checked document. Uses kinds, body, document, lookup, motion_reader, diagnostics.
module mech9_body_reader
  use mech9_kinds, only: wp
  use mech9_body, only: body_type
  use mech9_document, only: document_type, group_type
  use mech9_lookup, only: groups_named, get_integer, get_real, get_reals, span_of
  use mech9_motion_reader, only: check_link
  use mech9_diagnostics, only: diagnostics_type
  implicit none
  private
  public :: read_bodies, read_gravity

contains

  !> All groups &body: masses, centres and inertia tensors, checked.
  pure subroutine read_bodies(document, n_links, bodies, diagnostics)
    type(document_type), intent(in) :: document
    integer, intent(in) :: n_links                           !< 0 where it is not known
    type(body_type), allocatable, intent(out) :: bodies(:)
    type(diagnostics_type), intent(inout) :: diagnostics
    integer, allocatable :: numbers(:)
    real(wp) :: j(6)
    integer :: i

    numbers = groups_named(document, 'body')
    allocate (bodies(size(numbers)))
    do i = 1, size(numbers)
      associate (group => document%groups(numbers(i)))
        bodies(i)%link = get_integer(group, 'link')
        bodies(i)%mass = get_real(group, 'mass')
        bodies(i)%centre = get_reals(group, 'centre')
        j = get_reals(group, 'inertia')
        bodies(i)%inertia = reshape([j(1), j(4), j(5), j(4), j(2), j(6), j(5), j(6), j(3)], [3, 3])
        bodies(i)%place = diagnostics%place(group%span)
        call check_link(group, 'link', 1, n_links, diagnostics)
        call check_inertia(group, bodies(i)%inertia, diagnostics)
      end associate
    end do
  end subroutine read_bodies

  !> A body's second moments, half the trace of the tensor minus the tensor, form a matrix without
  !> negative eigenvalues; with it the tensor has none either, and no principal moment exceeds the sum of
  !> the two others. All principal minors of such a matrix are zero or positive.
  pure subroutine check_inertia(group, inertia, diagnostics)
    type(group_type), intent(in) :: group
    real(wp), intent(in) :: inertia(3, 3)
    type(diagnostics_type), intent(inout) :: diagnostics
    real(wp), parameter :: slack = 1.0e-3_wp                 ! data are often rounded to three digits
    real(wp) :: s(3, 3), scale
    integer :: i

    scale = maxval(abs(inertia))
    if (.not. scale > 0.0_wp) return
    s = -inertia/scale
    do i = 1, 3
      s(i, i) = s(i, i) + 0.5_wp*(inertia(1, 1) + inertia(2, 2) + inertia(3, 3))/scale
    end do
    do i = 1, 3
      if (s(i, i) >= -slack) cycle
      call diagnostics%add(span_of(group, 'inertia', i), 'no body has this inertia: '//moment_name(i)//' exceeds the sum of '// &
                           'the two others; for planar motion give each of these half of it')
      return
    end do
    if (minor(s, 1, 2) >= -slack .and. minor(s, 1, 3) >= -slack .and. minor(s, 2, 3) >= -slack &
        .and. determinant(s) >= -slack) return
    call diagnostics%add(span_of(group, 'inertia', 4), 'no body has this inertia: the products xy, xz, yz are too '// &
                         'large for the moments xx, yy, zz (xy is minus the integral of x y dm)')
  end subroutine check_inertia

  pure function moment_name(i) result(name)
    integer, intent(in) :: i
    character(len=2) :: name
    character(len=2), parameter :: names(3) = ['xx', 'yy', 'zz']

    name = names(i)
  end function moment_name

  !> Determinant of two rows and columns.
  pure real(wp) function minor(a, i, j)
    real(wp), intent(in) :: a(3, 3)
    integer, intent(in) :: i, j

    minor = a(i, i)*a(j, j) - a(i, j)*a(j, i)
  end function minor

  pure real(wp) function determinant(a)
    real(wp), intent(in) :: a(3, 3)

    determinant = a(1, 1)*(a(2, 2)*a(3, 3) - a(2, 3)*a(3, 2)) - a(1, 2)*(a(2, 1)*a(3, 3) - a(2, 3)*a(3, 1)) &
                  + a(1, 3)*(a(2, 1)*a(3, 2) - a(2, 2)*a(3, 1))
  end function determinant

  !> The acceleration of gravity; zero where the file has none.
  pure function read_gravity(document) result(gravity)
    type(document_type), intent(in) :: document
    real(wp) :: gravity(3)
    integer, allocatable :: numbers(:)

    gravity = 0.0_wp
    numbers = groups_named(document, 'gravity')
    if (size(numbers) > 0) gravity = get_reals(document%groups(numbers(1)), 'acceleration')
  end function read_gravity
end module mech9_body_reader
