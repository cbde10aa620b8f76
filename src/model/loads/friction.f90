!> Dry friction in a pair, by the wrench that the pair passes on.
!>
!> Coulomb's law: the friction opposes the rate and is mu b, where the *bearing load* b is a force, or a torque about the axis, that the
!> wrench of the pair gives:
!>
!>   turning     radius |F across the axis| + face_radius |F along it| + preload
!>   sliding     |F across the axis| + |M across it|/arm + preload
!>   helical     (normal force on the thread + preload) times the way along the thread for each radian
!>
!> F and M are the wrench about the origin of the pair's frame in the moving link.
module mech9_friction
  use mech9_kinds, only: wp
  use mech9_error, only: place_type
  implicit none
  private
  public :: friction_type, bearing_terms

  !> A bearing load has at most this number of terms beside the preload; each is the length of a plane vector.
  integer, parameter :: bearing_terms = 2

  !> The friction of one coordinate.
  type :: friction_type
    type(place_type) :: place             !< place of its group in the data file
    integer :: coordinate = 0             !< number of the coordinate
    real(wp) :: static = 0.0_wp           !< coefficient at rest
    real(wp) :: dynamic = 0.0_wp          !< coefficient of sliding
    real(wp) :: radius = 0.0_wp           !< of the bearing, or mean one of the thread [m]
    real(wp) :: face_radius = 0.0_wp      !< mean radius of the face that takes forces along the axis [m]
    real(wp) :: arm = 0.0_wp              !< half length of the guide, by which moments press; 0: they do not count [m]
    real(wp) :: preload = 0.0_wp          !< bearing load without a wrench [N m, N]
    logical :: is_smooth = .false.        !< the force passes through zero with the rate
    real(wp) :: transition = 0.0_wp       !< of a smooth law: rate at which it has 76 % of its force [rad/s, m/s]
    logical :: turns = .true.             !< the pair turns
    real(wp) :: lead = 0.0_wp             !< way along the axis for each unit of the coordinate [m/rad, 1]
  contains
    procedure :: weights
    procedure :: terms
    procedure :: bearing_load
    procedure :: fixed_load
    procedure :: reads
    procedure :: is_helical
  end type friction_type

contains

  !> Whether the pair turns and slides at once.
  pure logical function is_helical(self)
    class(friction_type), intent(in) :: self   !< the friction

    is_helical = self%turns .and. abs(self%lead) > 0.0_wp
  end function is_helical

  !> By what each term of the bearing load is multiplied.
  pure function weights(self)
    class(friction_type), intent(in) :: self   !< the friction
    real(wp) :: weights(bearing_terms)

    weights = 0.0_wp
    if (self%is_helical()) then
      weights(1) = norm2([self%radius, self%lead])
    else if (self%turns) then
      weights = [self%radius, self%face_radius]
    else
      weights(1) = 1.0_wp
      if (self%arm > 0.0_wp) weights(2) = 1.0_wp/self%arm
    end if
  end function weights

  !> The vectors whose lengths are the terms. They are linear in the wrench.
  pure function terms(self, wrench)
    class(friction_type), intent(in) :: self   !< the friction
    real(wp), intent(in) :: wrench(6)          !< force and moment in the axes of the pair's frame, z along the axis [N, N m]
    real(wp) :: terms(2, bearing_terms)

    terms = 0.0_wp
    if (self%is_helical()) then
      ! the part across the thread: the part along it is the friction itself, and the force of a drive
      terms(1, 1) = (self%radius*wrench(3) - self%lead/self%radius*wrench(6))/norm2([self%radius, self%lead])
    else
      terms(:, 1) = wrench(1:2)
      if (self%turns) then
        terms(1, 2) = wrench(3)
      else
        terms(:, 2) = wrench(4:5)
      end if
    end if
  end function terms

  !> The bearing load without a wrench [N m, N].
  pure real(wp) function fixed_load(self)
    class(friction_type), intent(in) :: self   !< the friction

    fixed_load = self%preload
    if (self%is_helical()) fixed_load = self%preload*norm2([self%radius, self%lead])
  end function fixed_load

  !> The bearing load of given terms [N m, N].
  pure real(wp) function bearing_load(self, terms)
    class(friction_type), intent(in) :: self             !< the friction
    real(wp), intent(in) :: terms(2, bearing_terms)      !< its terms
    real(wp) :: by(bearing_terms)
    integer :: i

    by = self%weights()
    bearing_load = self%fixed_load()
    do i = 1, bearing_terms
      bearing_load = bearing_load + by(i)*norm2(terms(:, i))
    end do
  end function bearing_load

  !> The components of the wrench that the bearing load reads.
  pure function reads(self)
    class(friction_type), intent(in) :: self   !< the friction
    logical :: reads(6)

    reads = .false.
    if (self%is_helical()) then
      reads([3, 6]) = .true.
    else if (self%turns) then
      reads(1:2) = self%radius > 0.0_wp
      reads(3) = self%face_radius > 0.0_wp
    else
      reads(1:2) = .true.
      reads(4:5) = self%arm > 0.0_wp
    end if
  end function reads
end module mech9_friction
