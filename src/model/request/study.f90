!> A study, which is a run for each of many sets of parameter values.
module mech9_study
  use mech9_kinds, only: wp
  use mech9_error, only: place_type
  implicit none
  private
  public :: study_type

  type :: study_type
    character(len=6) :: kind = ''              !< grid, list, random, latin or sobol; empty: there is no study
    integer :: runs = 0                        !< how many sets of values there are
    integer :: seed = 1                        !< chooses the numbers of random, latin and sobol
    real(wp), allocatable :: list(:, :)        !< (parameters,runs) the values of a list, in the units of the file
    type(place_type) :: place                  !< of its group in the data file
  end type study_type
end module mech9_study
