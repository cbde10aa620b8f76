!> A curve of solutions: n equations in n+1 unknowns, of which the last is a parameter, as an abstract problem.
!>
!> A point has an image z, all quantities that describe it, each in its unit, with the parameter last. Some of its components are the
!> unknowns; the others follow from them. Lengths and angles are those of images, so that a curve does not depend on the choice of
!> unknowns, which may change from point to point.
module mech9_curve
  use mech9_kinds, only: wp
  use mech9_error, only: error_type
  implicit none
  private
  public :: curve_type, curve_point_type, verdict_type
  public :: regular, fold, branching, hopf, period_doubling, torus

  !> Kinds of points, as tables have them.
  integer, parameter :: regular = 0, fold = 1, branching = 2, hopf = 3, period_doubling = 4, torus = 5

  !> A point near a curve, with what is known of the equations there.
  type :: curve_point_type
    real(wp), allocatable :: z(:)              !< (m) image, in units of its components
    integer, allocatable :: place(:)           !< (n+1) the components that are unknowns; the last one is m
    real(wp), allocatable :: residual(:)       !< (n) values of the equations
    real(wp), allocatable :: jacobian(:, :)    !< (n,n+1) their derivatives by the unknowns
    real(wp), allocatable :: slopes(:, :)      !< (m,n+1) derivatives of the image by the unknowns
    real(wp), allocatable :: tangent(:)        !< (n+1) of the curve, in the unknowns; of length 1 as an image
    real(wp), allocatable :: direction(:)      !< (m) the same as an image
    integer :: equations = 1                   !< number of the equations that it solves, where a problem has several
    real(wp) :: room = 1.0_wp                  !< up to the end of the range in which solutions have a meaning, if it is found with them
  end type curve_point_type

  !> The stability of a solution, as the problem judges it.
  type :: verdict_type
    real(wp) :: growth = 0.0_wp                !< largest real part of the roots [1/s]; may have no value
    logical :: is_stable = .true.              !< no small deviation grows
    complex(wp), allocatable :: roots(:)       !< one of each conjugate pair [1/s]; none where they have no meaning
  end type verdict_type

  type, abstract :: curve_type
    integer :: n = 0                           !< number of equations
    integer :: m = 0                           !< number of components of an image
    real(wp) :: scale = 1.0_wp                 !< size of the derivatives of the equations, at the start
    real(wp), allocatable :: period(:)         !< (m) a component that differs by it is the same; 0: none, in its unit
    integer :: equations = 1                   !< number of the equations that are evaluated, where a problem has several
  contains
    procedure(evaluated), deferred :: evaluate
    procedure(changed), deferred :: change_unknowns
    procedure(judged), deferred :: judge
    procedure :: gap => no_gap
    procedure :: meet_end => no_exact_end
    procedure :: kind_of_crossing => always_hopf
    procedure :: double => not_doubled
    procedure :: halve => not_halved
    procedure :: is_stopped => never_stopped
  end type curve_type

  abstract interface
    !> The equations at a point. Fails where they have no value there.
    subroutine evaluated(self, place, guess, point, err)
      import :: curve_type, curve_point_type, wp, error_type
      class(curve_type), intent(inout) :: self            !< the problem
      integer, intent(in) :: place(:)                     !< (n+1) the components of the image that are unknowns
      real(wp), intent(in) :: guess(:)                    !< (m) image: exact in the unknowns, near in the others
      type(curve_point_type), intent(out) :: point        !< the point, without a tangent
      type(error_type), allocatable, intent(out) :: err   !< allocated if it failed
    end subroutine evaluated

    !> Choose other unknowns where they serve better. The point is then evaluated again.
    subroutine changed(self, point, err)
      import :: curve_type, curve_point_type, error_type
      class(curve_type), intent(inout) :: self            !< the problem
      type(curve_point_type), intent(inout) :: point      !< on the curve; its tangent has no meaning afterwards
      type(error_type), allocatable, intent(out) :: err   !< allocated if it failed
    end subroutine changed

    !> Judge a point on the curve. Never fails: what is not known has no value.
    subroutine judged(self, point, verdict)
      import :: curve_type, curve_point_type, verdict_type
      class(curve_type), intent(inout) :: self            !< the problem
      type(curve_point_type), intent(in) :: point         !< on the curve
      type(verdict_type), intent(out) :: verdict          !< stability
    end subroutine judged
  end interface

contains

  !> The solution of a point at which periods double, with the period doubled, and with the direction of the branch that begins there.
  subroutine not_doubled(self, point, doubled, found)
    class(curve_type), intent(inout) :: self            !< the problem
    type(curve_point_type), intent(in) :: point         !< the point at which periods double
    type(curve_point_type), intent(inout) :: doubled    !< the same with the doubled period and a direction
    logical, intent(out) :: found                       !< a branch begins there

    doubled = point
    found = .false.
    self%equations = point%equations
  end subroutine not_doubled

  !> The solution of a point with half the period, where it repeats already after half of it.
  subroutine not_halved(self, point, half, found)
    class(curve_type), intent(inout) :: self            !< the problem
    type(curve_point_type), intent(in) :: point         !< on the curve
    type(curve_point_type), intent(inout) :: half       !< the same with half the period, without a direction
    logical, intent(out) :: found                       !< it repeats

    half = point
    found = .false.
    self%equations = point%equations
  end subroutine not_halved

  !> The room up to the nearest end of the range in which solutions have a meaning; below zero beyond it. Without such ends it is 1.
  pure real(wp) function no_gap(self, point) result(gap)
    class(curve_type), intent(in) :: self               !< the problem
    type(curve_point_type), intent(in) :: point         !< on the curve

    gap = 1.0_wp + 0.0_wp*size(point%z)*self%n
  end function no_gap

  !> The exact end of the range in which solutions have a meaning, between a point within and one beyond it. Without one of its own a problem
  !> leaves it to a search for the zero of the room.
  subroutine no_exact_end(self, a, b, point, kind)
    class(curve_type), intent(inout) :: self            !< the problem
    type(curve_point_type), intent(in) :: a             !< within the range
    type(curve_point_type), intent(in) :: b             !< beyond it
    type(curve_point_type), intent(inout) :: point      !< the end, where there is one
    integer, intent(out) :: kind                        !< its kind; regular: it was not found

    kind = regular + 0*size(a%z)*size(b%z)*self%n
    point%room = 0.0_wp
  end subroutine no_exact_end

  !> The kind of a point at which a pair of roots crosses the imaginary axis.
  integer function always_hopf(self, point) result(kind)
    class(curve_type), intent(inout) :: self            !< the problem
    type(curve_point_type), intent(in) :: point         !< on the curve

    kind = hopf + 0*size(point%z)*self%n
  end function always_hopf

  !> Whether the work shall stop.
  logical function never_stopped(self) result(stopped)
    class(curve_type), intent(in) :: self   !< the problem

    stopped = self%n < 0
  end function never_stopped
end module mech9_curve
