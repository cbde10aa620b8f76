!> The derivatives of all coordinates of a closed position by the parameters of a design and by time.
module mech9_closed_changes
  use mech9_kinds, only: wp
  use mech9_reflections, only: triangulate, solve_upper
  use mech9_design_space, only: design_type, drive_changes
  use mech9_open_position, only: open_position_type
  implicit none
  private
  public :: closed_changes_type, find_closed_changes

  type :: closed_changes_type
    real(wp), allocatable :: by_x(:, :)     !< (M,P) by the parameters, in the units of the coordinates
    real(wp), allocatable :: by_t(:)        !< (M) by time, in the units of the coordinates [1/s]
    real(wp), allocatable :: drives(:, :)   !< (P,M) of driven coordinates by the parameters at a given time [rad, m]
  contains
    procedure :: delay
  end type closed_changes_type

contains

  !> Find the derivatives.
  subroutine find_closed_changes(design, position, changes)
    type(design_type), intent(in) :: design             !< placed, with its tangents
    type(open_position_type), intent(in) :: position    !< closed, with the derivatives of its chains
    type(closed_changes_type), intent(out) :: changes   !< the derivatives
    real(wp), allocatable :: a(:, :), solution(:)
    integer, allocatable :: dependent(:)
    logical :: independent(design%in_space%n_coordinates)
    integer :: i, j, k, n, m

    n = size(design%x)
    associate (plan => design%in_space)
      allocate (changes%by_x(plan%n_coordinates, n), changes%by_t(plan%n_coordinates), changes%drives(n, plan%n_coordinates), &
                source=0.0_wp)
      independent = .false.
      independent(plan%independent) = .true.
      dependent = pack([(i, i=1, plan%n_coordinates)], .not. independent)
      m = size(dependent)
      do i = 1, size(design%drives)
        k = design%drives(i)%drive%coordinate
        call drive_changes(design, i, position%state%t, changes%drives(:, k))
        changes%by_x(k, :) = changes%drives(:, k)/plan%unit_of(k)
        changes%by_t(k) = position%state%dq(k)/plan%unit_of(k)
      end do
      allocate (a(position%equations, m + n + 1), solution(m))
      a(:, :m) = position%by_q(:, dependent)
      a(:, m + 1:m + n) = -position%by_x - matmul(position%by_q, changes%by_x)
      a(:, m + n + 1) = -matmul(position%by_q, changes%by_t)
      call triangulate(a, m)
      do j = 1, n
        call solve_upper(a(:m, :m), a(:m, m + j), solution)
        changes%by_x(dependent, j) = solution
      end do
      call solve_upper(a(:m, :m), a(:m, m + n + 1), solution)
      changes%by_t(dependent) = solution
    end associate
  end subroutine find_closed_changes

  !> The derivatives by the parameters of the time at which a driven coordinate has a certain value.
  pure function delay(self, coordinate, position)
    class(closed_changes_type), intent(in) :: self     !< the derivatives
    integer, intent(in) :: coordinate                  !< the driven coordinate
    type(open_position_type), intent(in) :: position   !< with the rate of this coordinate
    real(wp) :: delay(size(self%by_x, 2))

    delay = 0.0_wp
    if (abs(position%state%dq(coordinate)) > 0.0_wp) delay = -self%drives(:, coordinate)/position%state%dq(coordinate)
  end function delay
end module mech9_closed_changes
