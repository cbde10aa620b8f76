!> The kinds of numbers used everywhere.
module mech9_kinds
  use, intrinsic :: iso_fortran_env, only: real64, int64
  implicit none
  private
  public :: wp, long, pi, radians_per_degree

  !> Working precision of all real numbers.
  integer, parameter :: wp = real64
  !> Kind of integers for counts that may exceed two thousand million.
  integer, parameter :: long = int64

  real(wp), parameter :: pi = 3.14159265358979323846264338327950288_wp
  real(wp), parameter :: radians_per_degree = pi/180.0_wp
end module mech9_kinds
