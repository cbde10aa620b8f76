!> The limit that a crank turns fully, as numbers with derivatives: how far the closed chains are from a singular position, in each of
!> some parts of the turn.
!>
!> A design at which the crank only just turns has a singular position in the turn. Each part of the turn has a number of its own,
!> because chains may come near to singular positions at several angles, of which a single least value would not be smooth.
module mech9_crank_limit
  use mech9_kinds, only: wp, pi
  use mech9_plan, only: plan_type
  use mech9_design_space, only: design_type, copy_design, drive_changes
  use mech9_branch, only: turning_drives
  use mech9_regularity, only: regularity_type
  use mech9_course_extreme, only: course_place_type, sample_course, find_least
  use mech9_exact_fit, only: exact_fit_type
  implicit none
  private
  public :: crank_limit_type, new_crank_limit, find_crank_numbers

  type :: crank_limit_type
    integer :: n = 0                      !< number of numbers
    integer :: coordinate = 0             !< the driven angle
    integer, allocatable :: blocks(:)     !< numbers of the blocks whose chains may become singular
  end type crank_limit_type

  integer, parameter :: parts = 4               !< parts of the turn
  integer, parameter :: samples_in_part = 18    !< intervals of each
  !> The least regularity of a design that turns. The least singular value is then 1e-4 or somewhat more, and a design is at most
  !> some 1e-8 of its size away from the edge.
  real(wp), parameter :: least_regularity = 1.0e-8_wp

contains

  !> The limit of one crank.
  pure subroutine new_crank_limit(plan, coordinate, crank)
    type(plan_type), intent(in) :: plan               !< the plan of all designs
    integer, intent(in) :: coordinate                 !< the driven angle
    type(crank_limit_type), intent(out) :: crank      !< the limit
    integer :: b

    crank%coordinate = coordinate
    crank%blocks = pack([(b, b=1, size(plan%blocks))], &
                        [(size(plan%blocks(b)%unknowns) > 0 .and. .not. plan%blocks(b)%is_linear, b=1, size(plan%blocks))])
    crank%n = parts*size(crank%blocks)
  end subroutine new_crank_limit

  !> The numbers of the present design of a fit: its regularity less the least that is allowed.
  subroutine find_crank_numbers(fit, crank, numbers, slopes, found)
    class(exact_fit_type), intent(inout) :: fit         !< with a design that has a value and its tangents
    type(crank_limit_type), intent(in) :: crank         !< the limit
    real(wp), intent(out) :: numbers(:)                 !< (n) not negative where it is kept
    real(wp), intent(out) :: slopes(:, :)               !< (P,n) their derivatives by the parameters
    logical, intent(out) :: found                       !< they exist
    type(design_type) :: turning
    type(regularity_type) :: regularity
    type(course_place_type) :: places(0:parts*samples_in_part), least
    integer :: b, i, n

    call make_turning(fit, crank%coordinate, turning)
    n = 0
    found = .true.
    do b = 1, size(crank%blocks)
      regularity%block = crank%blocks(b)
      call sample_course(regularity, turning, fit%position, fit%q_start, [0.0_wp, 2.0_wp*pi], places, found)
      if (.not. found) return
      do i = 1, parts
        n = n + 1
        call find_least(regularity, 1.0_wp, turning, fit%position, places((i - 1)*samples_in_part:i*samples_in_part), least)
        numbers(n) = least%value - least_regularity
        slopes(:, n) = least%by_x
      end do
    end do
  end subroutine find_crank_numbers

  !> The present design of a fit with drives that turn the crank, from the position at the start of the run.
  subroutine make_turning(fit, coordinate, turning)
    class(exact_fit_type), intent(in) :: fit            !< with a design that has a value and its tangents
    integer, intent(in) :: coordinate                   !< the driven angle
    type(design_type), intent(out) :: turning           !< the design
    real(wp) :: change(fit%varied)
    integer :: i, p

    call copy_design(fit%design, turning)
    call turning_drives(fit%design, fit%q_start, coordinate, turning%drives)
    do i = 1, size(turning%drives)
      call drive_changes(fit%design, i, fit%start, change)
      do p = 1, fit%varied
        turning%tangents(p)%drives(i)%change = [change(p), 0.0_wp]
        turning%tangents(p)%drives(i)%varies = abs(change(p)) > 0.0_wp
      end do
    end do
  end subroutine make_turning
end module mech9_crank_limit
