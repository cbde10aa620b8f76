!> A periodic motion: its period, its multipliers, and what they say about its stability.
module mech9_periodic_motion
  use mech9_kinds, only: wp
  use mech9_lapack, only: dgeev
  implicit none
  private
  public :: periodic_motion_type, find_multipliers, judge_stability, same_motion, belongs_to_family
  public :: stable, unstable, neutral, lost_at_plus_one, lost_at_minus_one, lost_by_pair

  !> Stability: all multipliers lie within the unit circle, one lies outside, or none does and some lie on it within errors.
  integer, parameter :: stable = 1, unstable = 2, neutral = 3
  !> The largest multiplier outside: real above 1, real below -1, or one of a complex pair.
  integer, parameter :: lost_at_plus_one = 1, lost_at_minus_one = 2, lost_by_pair = 3
  !> Parts by which numbers of one motion may differ between two searches.
  real(wp), parameter :: of_signature = 1.0e-5_wp

  !> A periodic motion that was found.
  type :: periodic_motion_type
    real(wp) :: period = 0.0_wp                  !< [s]
    logical :: is_free = .false.                 !< nothing follows time: the period belongs to the motion
    logical :: is_trivial = .false.              !< nothing moves: an equilibrium
    real(wp) :: repeats_after = 0.0_wp           !< the motion is the same already after this time; 0: not earlier [s]
    complex(wp), allocatable :: multipliers(:)   !< (states) largest first
    integer :: stability = neutral               !< one of the numbers above
    integer :: lost = 0                          !< how it is lost, where it is unstable
    integer :: at_one = 0                        !< multipliers that are 1 within errors
    real(wp) :: product = 0.0_wp                 !< of all multipliers
    logical :: knows_volume = .false.            !< the next number is known
    real(wp) :: product_by_divergence = 0.0_wp   !< exp of the integral of the divergence
    real(wp), allocatable :: q(:)                !< (M) coordinates at the start [rad, m]
    real(wp), allocatable :: dq(:)               !< (M) their rates [rad/s, m/s]
    real(wp), allocatable :: motor(:)            !< (motors) their states
    integer :: cyclic = 0                        !< coordinates that do not come back, since the equations do not contain them
    real(wp), allocatable :: advance(:)          !< (M) ways of these in a period; 0: of others [rad]
    integer, allocatable :: turns(:)             !< (M) whole periods of coordinates by which both ends differ
    real(wp), allocatable :: residual(:)         !< (M) what coordinates differ by at both ends, but for turns [rad, m]
    real(wp), allocatable :: rate_residual(:)    !< (M) what their rates differ by [rad/s, m/s]
    real(wp), allocatable :: signature(:, :)     !< (3,M) means over the motion, whatever its start
    real(wp) :: growth = 1.0_wp                  !< largest number of the monodromy matrix in units of the state, 1 at least
    real(wp) :: start_error = 0.0_wp             !< of the state at the start, in units of coordinates and the period; at most
    integer :: iterations = 0                    !< corrections by Newton's method
    integer :: evaluations = 0                   !< motions over a period
    integer :: events = 0                        !< impacts and other events within it
    integer :: coordinate_changes = 0            !< of the independent coordinates within it
  end type periodic_motion_type

contains

  !> The eigenvalues of a monodromy matrix, largest first, of a pair the one with positive imaginary part first.
  subroutine find_multipliers(monodromy, multipliers)
    real(wp), intent(in) :: monodromy(:, :)                     !< (states,states)
    complex(wp), allocatable, intent(out) :: multipliers(:)     !< (states)
    real(wp) :: a(size(monodromy, 1), size(monodromy, 1)), re(size(monodromy, 1)), im(size(monodromy, 1))
    real(wp) :: no_left(1, 1), no_right(1, 1), work(8*size(monodromy, 1) + 8)
    logical :: waits(size(monodromy, 1))
    integer :: n, i, k, info

    n = size(monodromy, 1)
    a = monodromy
    call dgeev('N', 'N', n, a, n, re, im, no_left, 1, no_right, 1, work, size(work), info)
    allocate (multipliers(n))
    waits = .true.
    do i = 1, n
      k = maxloc(hypot(re, im), dim=1, mask=waits)
      ! of two that are conjugate the first one comes first, whatever round-off says
      if (im(k) < 0.0_wp) then
        if (waits(k - 1)) k = k - 1
      end if
      multipliers(i) = cmplx(re(k), im(k), wp)
      waits(k) = .false.
    end do
  end subroutine find_multipliers

  !> Judge the stability by the multipliers. One of a free motion is 1, along the motion, and one for each coordinate that the equations do
  !> not contain; further ones near 1, as of motions that conserve something, are known by the square root of the error.
  pure subroutine judge_stability(error, motion)
    real(wp), intent(in) :: error                          !< relative error of the multipliers
    type(periodic_motion_type), intent(inout) :: motion    !< with its multipliers; gets the judgement
    logical :: judged(size(motion%multipliers))
    real(wp) :: size_of(size(motion%multipliers)), largest
    integer :: k, i

    size_of = abs(motion%multipliers)
    judged = .true.
    motion%at_one = count(abs(motion%multipliers - 1.0_wp) <= sqrt(error))
    if (motion%is_free .and. .not. motion%is_trivial) then
      do i = 0, motion%cyclic
        judged(minloc(abs(motion%multipliers - 1.0_wp), dim=1, mask=judged)) = .false.
      end do
      ! a double one is split by errors
      if (belongs_to_family(motion)) judged = judged .and. abs(motion%multipliers - 1.0_wp) > sqrt(error)
    end if
    motion%lost = 0
    motion%stability = stable
    if (motion%is_free .and. belongs_to_family(motion) .and. .not. motion%is_trivial) motion%stability = neutral
    if (.not. any(judged)) return
    k = maxloc(size_of, dim=1, mask=judged)
    largest = size_of(k)
    if (largest > 1.0_wp + error) then
      motion%stability = unstable
      motion%lost = lost_by_pair
      associate (multiplier => motion%multipliers(k))
        if (.not. abs(aimag(multiplier)) > 0.0_wp) &
          motion%lost = merge(lost_at_plus_one, lost_at_minus_one, real(multiplier) > 0.0_wp)
      end associate
    else if (largest > 1.0_wp - error) then
      motion%stability = neutral
    end if
  end subroutine judge_stability

  !> Whether a free motion has more multipliers 1 than for its own way and for coordinates that do not come back.
  pure logical function belongs_to_family(motion)
    type(periodic_motion_type), intent(in) :: motion       !< with its multipliers

    belongs_to_family = motion%at_one > 1 + motion%cyclic
  end function belongs_to_family

  !> Whether two motions are one, perhaps from another point of it.
  pure logical function same_motion(a, b)
    type(periodic_motion_type), intent(in) :: a   !< a motion
    type(periodic_motion_type), intent(in) :: b   !< another one

    same_motion = abs(a%period - b%period) <= of_signature*a%period .and. (a%is_trivial .eqv. b%is_trivial)
    if (.not. same_motion) return
    same_motion = all(abs(a%signature - b%signature) <= of_signature*(1.0_wp + abs(a%signature)))
  end function same_motion
end module mech9_periodic_motion
