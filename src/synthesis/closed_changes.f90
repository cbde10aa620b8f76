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
    integer, allocatable :: dependent(:)    !< numbers of the dependent coordinates
    real(wp), allocatable :: a(:, :)        !< scratch: the equations
    real(wp), allocatable :: solution(:)    !< scratch: a solution
    real(wp), allocatable :: drives(:, :)   !< (P,M) of driven coordinates by the parameters at a given time [rad, m]
  contains
    procedure :: delay
  end type closed_changes_type

contains

  !> Find the derivatives.
  subroutine find_closed_changes(design, position, changes)
    type(design_type), intent(in) :: design             !< placed, with its tangents
    type(open_position_type), intent(in) :: position    !< closed, with the derivatives of its chains
    type(closed_changes_type), intent(inout) :: changes !< the derivatives; its room serves again
    integer :: i, j, k, n, m

    n = size(design%x)
    if (.not. allocated(changes%a)) call make_room(design, position, changes)
    m = size(changes%dependent)
    changes%by_x = 0.0_wp
    changes%by_t = 0.0_wp
    associate (plan => design%in_space, a => changes%a, by_q => position%by_q)
      a(:, m + 1:m + n) = -position%by_x
      a(:, m + n + 1) = 0.0_wp
      do i = 1, size(design%drives)
        k = design%drives(i)%drive%coordinate
        call drive_changes(design, i, position%state%t, changes%drives(:, k))
        changes%by_x(k, :) = changes%drives(:, k)/plan%unit_of(k)
        changes%by_t(k) = position%state%dq(k)/plan%unit_of(k)
        a(:, m + n + 1) = a(:, m + n + 1) - by_q(:, k)*changes%by_t(k)
        do j = 1, n
          if (abs(changes%by_x(k, j)) > 0.0_wp) a(:, m + j) = a(:, m + j) - by_q(:, k)*changes%by_x(k, j)
        end do
      end do
      do j = 1, m
        a(:, j) = by_q(:, changes%dependent(j))
      end do
      call triangulate(a, m)
      do j = 1, n + 1
        call solve_upper(a(:m, :m), a(:m, m + j), changes%solution)
        if (j <= n) changes%by_x(changes%dependent, j) = changes%solution
      end do
      changes%by_t(changes%dependent) = changes%solution
    end associate
  end subroutine find_closed_changes

  !> Make room for the derivatives.
  subroutine make_room(design, position, changes)
    type(design_type), intent(in) :: design               !< any of the designs
    type(open_position_type), intent(in) :: position      !< any of their positions
    type(closed_changes_type), intent(inout) :: changes   !< gets the room
    logical :: independent(design%in_space%n_coordinates)
    integer :: i, m, n

    m = size(independent)
    n = size(design%x)
    independent = .false.
    independent(design%in_space%independent) = .true.
    changes%dependent = pack([(i, i=1, m)], .not. independent)
    allocate (changes%by_x(m, n), changes%by_t(m), changes%drives(n, m), changes%solution(size(changes%dependent)), &
              changes%a(position%equations, size(changes%dependent) + n + 1), source=0.0_wp)
  end subroutine make_room

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
