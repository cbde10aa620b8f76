!> A study, which is a run for each of many sets of parameter values.
module mech9_study
  use mech9_kinds, only: wp
  use mech9_error, only: place_type
  implicit none
  private
  public :: study_type

  type :: study_type
    character(len=6) :: kind = ''              !< grid, list, random, latin or sobol; empty: there is no study
    integer :: runs = 0                        !< how many runs there are
    integer :: sets = 0                        !< how many sets of values there are; as many as runs, or half as many
    character(len=9) :: carry = 'none'         !< a run begins where the one before ended: none, forwards, backwards or both
    integer :: seed = 1                        !< chooses the numbers of random, latin and sobol
    real(wp), allocatable :: list(:, :)        !< (parameters,runs) the values of a list, in the units of the file
    logical :: classes = .false.               !< runs are told apart by what their motions go to
    integer :: exponents = 0                   !< how many Lyapunov exponents of each motion are found
    type(place_type) :: place                  !< of its group in the data file
  contains
    procedure :: set_of
    procedure :: carries
  end type study_type

contains

  !> The number of the set of values with which a run is made. Runs that are carried on both ways go through all sets and back.
  pure integer function set_of(self, run)
    class(study_type), intent(in) :: self   !< the study
    integer, intent(in) :: run              !< number of the run, 1 to `runs`

    set_of = run
    if (self%carry == 'backwards' .or. (self%carry == 'both' .and. run > self%sets)) set_of = self%runs + 1 - run
  end function set_of

  !> Whether each run begins in the state in which the one before ended.
  pure logical function carries(self)
    class(study_type), intent(in) :: self   !< the study

    carries = self%carry /= 'none'
  end function carries
end module mech9_study
