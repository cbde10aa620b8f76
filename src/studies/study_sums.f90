!> Sums over the runs of a study, one run after the other: means and deviations of quantities, and how many runs failed.
module mech9_study_sums
  use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
  use mech9_kinds, only: wp
  implicit none
  private
  public :: study_sums_type

  integer, parameter :: most_codes = 16   !< different exit codes that are counted apart

  type :: study_sums_type
    integer :: done = 0                              !< runs that went to their end
    real(wp), allocatable :: mean(:)                 !< (quantities) of these
    real(wp), allocatable :: low(:)                  !< (quantities) least one
    real(wp), allocatable :: high(:)                 !< (quantities) largest one
    integer, allocatable, private :: power(:)        !< (quantities) moments are those of the numbers over 2**power, at most 1 then
    real(wp), allocatable, private :: middle(:)      !< (quantities) mean, so scaled
    real(wp), allocatable, private :: second(:)      !< (quantities) sum of the squares of the deviations from the mean
    real(wp), allocatable, private :: third(:)       !< (quantities) sum of their third powers
    real(wp), allocatable, private :: fourth(:)      !< (quantities) sum of their fourth powers
    integer :: n_codes = 0                           !< exit codes of failed runs so far
    integer :: codes(most_codes) = 0                 !< different exit codes of failed runs, in the order in which they came
    integer :: failed(most_codes) = 0                !< how many runs ended with each of them
    integer :: first_failed(most_codes) = 0          !< number of the first of these runs
  contains
    procedure :: begin
    procedure :: add
    procedure :: add_failure
    procedure :: made
    procedure :: deviation
    procedure :: error_of_mean
    procedure :: error_of_deviation
    procedure, private :: rescale
  end type study_sums_type

contains

  !> Begin without runs.
  pure subroutine begin(self, n_quantities)
    class(study_sums_type), intent(inout) :: self   !< the sums
    integer, intent(in) :: n_quantities             !< how many quantities there are

    allocate (self%mean(n_quantities), self%low(n_quantities), self%high(n_quantities), source=0.0_wp)
    allocate (self%middle(n_quantities), self%second(n_quantities), self%third(n_quantities), self%fourth(n_quantities), &
              source=0.0_wp)
    allocate (self%power(n_quantities), source=minexponent(0.0_wp))
  end subroutine begin

  !> Add a run that went to its end. The moments are updated by Pébay's formulas, without loss of digits. They are those
  !> of scaled numbers, since fourth powers of large ones would be infinite.
  pure subroutine add(self, numbers)
    class(study_sums_type), intent(inout) :: self   !< the sums
    real(wp), intent(in) :: numbers(:)              !< (quantities) of the run
    real(wp), dimension(size(numbers)) :: step, part, square
    real(wp) :: n

    self%done = self%done + 1
    n = real(self%done, wp)
    if (self%done == 1) then
      self%low = numbers
      self%high = numbers
    end if
    self%low = min(self%low, numbers)
    self%high = max(self%high, numbers)
    call self%rescale(numbers)
    step = scale(numbers, -self%power) - self%middle
    part = step/n
    square = step*part*(n - 1.0_wp)
    self%middle = self%middle + part
    self%mean = scale(self%middle, self%power)
    self%fourth = self%fourth + square*part**2*(n**2 - 3.0_wp*n + 3.0_wp) + 6.0_wp*part**2*self%second - 4.0_wp*part*self%third
    self%third = self%third + square*part*(n - 2.0_wp) - 3.0_wp*part*self%second
    self%second = self%second + square
  end subroutine add

  !> Choose larger powers where numbers come that are larger than all before. Powers of two change no digit.
  pure subroutine rescale(self, numbers)
    class(study_sums_type), intent(inout) :: self   !< the sums
    real(wp), intent(in) :: numbers(:)              !< (quantities) of the next run
    integer :: i, more

    do i = 1, size(numbers)
      if (.not. (ieee_is_finite(numbers(i)) .and. abs(numbers(i)) > 0.0_wp)) cycle
      more = exponent(numbers(i)) - self%power(i)
      if (more <= 0) cycle
      self%power(i) = self%power(i) + more
      self%middle(i) = scale(self%middle(i), -more)
      self%second(i) = scale(self%second(i), -2*more)
      self%third(i) = scale(self%third(i), -3*more)
      self%fourth(i) = scale(self%fourth(i), -4*more)
    end do
  end subroutine rescale

  !> Add a run that failed.
  pure subroutine add_failure(self, run, code)
    class(study_sums_type), intent(inout) :: self   !< the sums
    integer, intent(in) :: run                      !< its number
    integer, intent(in) :: code                     !< its exit code
    integer :: i

    i = findloc(self%codes(:self%n_codes), code, dim=1)
    if (i == 0) then
      self%n_codes = min(self%n_codes + 1, most_codes)
      i = self%n_codes
      self%codes(i) = code
      self%first_failed(i) = run
    end if
    self%failed(i) = self%failed(i) + 1
  end subroutine add_failure

  !> How many runs there were.
  pure integer function made(self)
    class(study_sums_type), intent(in) :: self   !< the sums

    made = self%done + sum(self%failed)
  end function made

  !> The standard deviations of the quantities; 0 for fewer than two runs.
  pure function deviation(self)
    class(study_sums_type), intent(in) :: self   !< the sums
    real(wp) :: deviation(size(self%mean))

    deviation = scale(sqrt(max(0.0_wp, self%second/max(1, self%done - 1))), self%power)
  end function deviation

  !> The standard errors of the means of runs that are drawn independently.
  pure function error_of_mean(self) result(error)
    class(study_sums_type), intent(in) :: self   !< the sums
    real(wp) :: error(size(self%mean))

    error = self%deviation()/sqrt(real(max(1, self%done), wp))
  end function error_of_mean

  !> The standard errors of the standard deviations of runs that are drawn independently, from their fourth moments.
  pure function error_of_deviation(self) result(error)
    class(study_sums_type), intent(in) :: self   !< the sums
    real(wp) :: error(size(self%mean))
    real(wp) :: n, variance
    integer :: i

    n = real(max(2, self%done), wp)
    do i = 1, size(error)
      variance = self%second(i)/n
      error(i) = 0.0_wp
      if (variance > 0.0_wp) &
        error(i) = scale(sqrt(max(0.0_wp, (self%fourth(i)/n - variance**2)/n)/variance)/2.0_wp, self%power(i))
    end do
  end function error_of_deviation
end module mech9_study_sums
