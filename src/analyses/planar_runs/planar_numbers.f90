!> The numbers of planar designs in planar arithmetic, as affine functions of the parameters that are varied.
!>
!> The planar plans of designs whose parameters change lengths and places, and turn no axis, differ by numbers that are affine functions
!> of the parameters. A design then costs no plan, no model and no allocation. The slopes of these numbers are their derivatives, too.
module mech9_planar_numbers
  use mech9_kinds, only: wp
  use mech9_planar_plan, only: planar_step_type, planar_closure_type
  implicit none
  private
  public :: planar_design_type, place_numbers

  !> Numbers of a step: its place in the parent frame, and its angle.
  integer, parameter, public :: numbers_of_step = 3
  !> Numbers of a closure: its place in the target frame.
  integer, parameter, public :: numbers_of_closure = 2
  !> Numbers of a point: its place in the first frame of its link, and its height.
  integer, parameter, public :: numbers_of_point = 3

  !> The numbers of a design. Those of steps come first, then those of closures and of points.
  type :: planar_design_type
    logical :: used = .false.                               !< all designs are planar, and their numbers are affine
    type(planar_step_type), allocatable :: steps(:)         !< (M) the planar steps
    type(planar_closure_type), allocatable :: closures(:)   !< the planar closures
    real(wp), allocatable :: points(:, :)                   !< (3,points) of the points in the first frames of their links [m]
    real(wp), allocatable :: at(:)                          !< (varied) values of the parameters for which `base` holds
    real(wp), allocatable :: base(:)                        !< (numbers) the numbers for these values [m, rad]
    real(wp), allocatable :: slopes(:, :)                   !< (numbers,varied) their derivatives
    real(wp), allocatable :: numbers(:)                     !< (numbers) those of the design that was placed last
    logical :: moves_drives = .false.                       !< a parameter changes drives
  end type planar_design_type

contains

  !> Give a design the values of its parameters.
  pure subroutine place_numbers(x, design)
    real(wp), intent(in) :: x(:)                             !< (varied) values of the parameters
    type(planar_design_type), intent(inout) :: design        !< gets its numbers
    integer :: i, k, p

    design%numbers = design%base
    do p = 1, size(x)
      do i = 1, size(design%numbers)
        design%numbers(i) = design%numbers(i) + design%slopes(i, p)*(x(p) - design%at(p))
      end do
    end do
    k = 0
    do i = 1, size(design%steps)
      design%steps(i)%place(1) = design%numbers(k + 1)
      design%steps(i)%place(2) = design%numbers(k + 2)
      design%steps(i)%angle = design%numbers(k + 3)
      k = k + numbers_of_step
    end do
    do i = 1, size(design%closures)
      design%closures(i)%place(1) = design%numbers(k + 1)
      design%closures(i)%place(2) = design%numbers(k + 2)
      k = k + numbers_of_closure
    end do
    do i = 1, size(design%points, 2)
      design%points(:, i) = design%numbers(k + 1:k + numbers_of_point)
      k = k + numbers_of_point
    end do
  end subroutine place_numbers
end module mech9_planar_numbers
