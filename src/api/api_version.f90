!> The version of the library for C (include/mech9.h).
module mech9_api_version
  use, intrinsic :: iso_c_binding, only: c_int
  use mech9_version, only: version_number
  implicit none
  private
  public :: version

contains

  !> 10000 times the major number, 100 times the minor number, and the patch.
  integer(c_int) function version() bind(c, name='mech9_version')
    version = version_number
  end function version
end module mech9_api_version
