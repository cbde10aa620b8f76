!> Coefficients of Runge-Kutta methods that SUNDIALS does not bring. Uses kinds.
module mech9_butcher_tables
  use mech9_kinds, only: wp
  implicit none
  private
  public :: butcher_table_type, kutta_merson

  !> An explicit method with an embedded one for its error.
  type :: butcher_table_type
    integer :: stages, order, embedded_order
    real(wp), allocatable :: c(:)      !< times of the stages, as part of the step
    real(wp), allocatable :: a(:, :)   !< (stage, earlier stage)
    real(wp), allocatable :: b(:)      !< weights of the solution
    real(wp), allocatable :: d(:)      !< weights of the embedded solution
  end type butcher_table_type

contains

  !> Kutta-Merson, the MERSOL of 1995. The difference b - d is Merson's estimate of the error,
  !> (2 k1 - 9 k3 + 8 k4 - k5)/30. The embedded solution is of fifth order where the equations are linear
  !> with constant coefficients, and of third order in general: the step must be chosen by the third.
  pure function kutta_merson() result(table)
    type(butcher_table_type) :: table

    table%stages = 5
    table%order = 4
    table%embedded_order = 3
    table%c = [0.0_wp, 1.0_wp/3.0_wp, 1.0_wp/3.0_wp, 0.5_wp, 1.0_wp]
    allocate (table%a(5, 5), source=0.0_wp)
    table%a(2, 1) = 1.0_wp/3.0_wp
    table%a(3, 1:2) = 1.0_wp/6.0_wp
    table%a(4, 1:3) = [0.125_wp, 0.0_wp, 0.375_wp]
    table%a(5, 1:4) = [0.5_wp, 0.0_wp, -1.5_wp, 2.0_wp]
    table%b = [1.0_wp/6.0_wp, 0.0_wp, 0.0_wp, 2.0_wp/3.0_wp, 1.0_wp/6.0_wp]
    table%d = [0.1_wp, 0.0_wp, 0.3_wp, 0.4_wp, 0.2_wp]
  end function kutta_merson
end module mech9_butcher_tables
