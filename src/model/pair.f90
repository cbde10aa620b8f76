!> A pair is a joint of two links with one degree of freedom; all kinds of pairs have this interface.
!>
!> A pair is any one-parameter motion of a frame of its moving link in a frame of its reference link. Most pairs turn
!> about or slide along one fixed axis, or both in proportion: `as_screw` gives their axis,
!> and the plan then never calls `evaluate` for them. Others may lead the moving link along a curve: `guide` gives it.
!> A pair without a fixed axis may depend on numbers beside those of its frames: `constants` gives them, and `vary` the motion by a
!> change of them.
module mech9_pair
  use mech9_kinds, only: wp
  use mech9_error, only: error_type, place_type
  use mech9_pose, only: pose_type, inverse
  use mech9_rotation, only: turn, cross
  implicit none
  private
  public :: pair_type, pair_slot_type, pair_motion_type, pair_guide_type, pair_thirds_type, screw_factors_type
  public :: kind_name_length, reversed_motion, reversed_thirds

  integer, parameter :: kind_name_length = 9   !< letters of the longest name of a kind, prismatic

  !> The pose that a pair gives its frame in the moving link, seen from its frame in the reference link, at one value of q,
  !> and its derivatives in q. All vectors are in the axes of the frame in the reference link.
  type :: pair_motion_type
    type(pose_type) :: pose          !< of the moving frame in the reference frame
    real(wp) :: w(3) = 0.0_wp        !< angular rate: vee(A' A^T)
    real(wp) :: v(3) = 0.0_wp        !< rate of the moving frame's origin, U'
    real(wp) :: w_rate(3) = 0.0_wp   !< derivative of w in q
    real(wp) :: v_rate(3) = 0.0_wp   !< derivative of v in q, U''
  end type pair_motion_type

  !> Third derivatives of the pose that a pair gives, in the axes of the frame in the reference link.
  type :: pair_thirds_type
    logical :: known = .false.       !< the pair knows them; else they are found by differences
    real(wp) :: w(3) = 0.0_wp        !< second derivative in q of the angular rate
    real(wp) :: v(3) = 0.0_wp        !< second derivative in q of the rate of the moving frame's origin, U'''
  end type pair_thirds_type

  !> The frames of a pair, and the factors of one with a fixed axis: pose = before * (turn by `turn`*(q + offset) about z and
  !> slide by `slide`*(q + offset) along z) * after. Without a fixed axis, what `evaluate` gives stands between the frames.
  type :: screw_factors_type
    type(pose_type) :: before     !< pose of the axis (its z), or of the pair's frame, in the reference link
    type(pose_type) :: after      !< pose of the moving link in the frame of the axis where q + offset is zero, or in the pair's frame
    real(wp) :: turn = 0.0_wp     !< 1, or 0 for a prismatic pair
    real(wp) :: slide = 0.0_wp    !< length per unit of q [m/rad, 1]
    real(wp) :: offset = 0.0_wp   !< added to q [rad, m]
  end type screw_factors_type

  !> The curve along which a pair leads its moving link.
  type :: pair_guide_type
    logical :: closed = .false.             !< the pair repeats its poses after `length`; else q goes from 0 to `length`
    logical :: turns = .false.              !< the moving link turns with the tangent, which is the x axis of the moving frame
    real(wp) :: length = 0.0_wp             !< greatest q, or change of q after which poses repeat [m]; 0: there is no curve
    real(wp), allocatable :: points(:, :)   !< (3,n) places of the moving frame in the reference frame, for sizes and pictures [m]
  end type pair_guide_type

  !> A pair of any kind.
  type, abstract :: pair_type
    integer :: coordinate = 0     !< number k of its coordinate q_k
    integer :: reference = 0      !< the link in which its motion is described
    integer :: moving = 0         !< the link that moves
    logical :: angular = .true.   !< its coordinate is an angle [rad]; else a length or the user's own
    type(place_type) :: place     !< place of its group in the data file
  contains
    procedure(evaluate_interface), deferred :: evaluate
    procedure(as_screw_interface), deferred :: as_screw
    procedure(kind_name_interface), deferred :: kind_name
    procedure(calls_interface), deferred :: user_calls
    procedure :: guide => no_guide
    procedure :: thirds => unknown_thirds
    procedure :: constants => no_constants
    procedure :: vary => held
  end type pair_type

  !> One of several pairs of different kinds.
  type :: pair_slot_type
    class(pair_type), allocatable :: pair
  end type pair_slot_type

  abstract interface
    !> Motion of the moving frame in the reference frame at q, with two derivatives in q.
    !> Fails where the pair has no pose: collinear characteristic points, values that are not finite, an end of a curve.
    subroutine evaluate_interface(self, q, motion, err)
      import :: pair_type, pair_motion_type, error_type, wp
      class(pair_type), intent(in) :: self                !< the pair
      real(wp), intent(in) :: q                           !< value of the coordinate [rad, m, or the user's own unit]
      type(pair_motion_type), intent(out) :: motion       !< pose of the moving frame and its derivatives in q
      type(error_type), allocatable, intent(out) :: err   !< allocated if it failed
    end subroutine evaluate_interface

    !> The factors of a pair with a fixed axis; `is_screw` is false for any other pair, of which only the frames count.
    pure subroutine as_screw_interface(self, factors, is_screw)
      import :: pair_type, screw_factors_type
      class(pair_type), intent(in) :: self               !< the pair
      type(screw_factors_type), intent(out) :: factors   !< the factors of the pair
      logical, intent(out) :: is_screw                   !< whether the pair has a fixed axis
    end subroutine as_screw_interface

    !> The name of its kind as in the data file, for reports.
    pure function kind_name_interface(self) result(name)
      import :: pair_type, kind_name_length
      class(pair_type), intent(in) :: self   !< the pair
      character(len=kind_name_length) :: name
    end function kind_name_interface

    !> Number of calls of a user's procedure in one evaluation; 0 for built-in pairs.
    pure integer function calls_interface(self)
      import :: pair_type
      class(pair_type), intent(in) :: self   !< the pair
    end function calls_interface
  end interface

contains

  !> A pair without a curve along which it leads its moving link.
  pure subroutine no_guide(self, guide)
    class(pair_type), intent(in) :: self         !< the pair
    type(pair_guide_type), intent(out) :: guide  !< without points

    allocate (guide%points(3, 0))
  end subroutine no_guide

  !> Third derivatives that the pair does not know.
  pure subroutine unknown_thirds(self, q, thirds)
    class(pair_type), intent(in) :: self            !< the pair
    real(wp), intent(in) :: q                       !< value of the coordinate
    type(pair_thirds_type), intent(out) :: thirds   !< not known
  end subroutine unknown_thirds

  !> The numbers of a pair whose motion depends on its frames alone.
  pure subroutine no_constants(self, values)
    class(pair_type), intent(in) :: self               !< the pair
    real(wp), allocatable, intent(out) :: values(:)    !< none

    allocate (values(0))
  end subroutine no_constants

  !> The motion of such a pair by a change of its numbers: none.
  subroutine held(self, change, q, twist)
    class(pair_type), intent(in) :: self       !< the pair
    real(wp), intent(in) :: change(:)          !< derivatives of its numbers by a parameter
    real(wp), intent(in) :: q                  !< value of the coordinate
    real(wp), intent(out) :: twist(6, 0:2)     !< rotation, and shift of the origin, of the moving frame in the reference frame by the
                                               !< parameter [rad, m], and two derivatives in q

    twist = 0.0_wp
  end subroutine held

  !> The third derivatives of the motion of the reference link in the moving link.
  pure function reversed_thirds(motion, thirds) result(back)
    type(pair_motion_type), intent(in) :: motion    !< motion of the moving link in the reference link
    type(pair_thirds_type), intent(in) :: thirds    !< its third derivatives
    type(pair_thirds_type) :: back
    real(wp) :: r_back(3, 3), g(3), g_rate(3), g_second(3), slip(3), slip_rate(3)

    r_back = transpose(motion%pose%r)
    associate (w => motion%w, v => motion%v, w_rate => motion%w_rate, v_rate => motion%v_rate, p => motion%pose%p)
      g = v - cross(w, p)
      g_rate = v_rate - cross(w_rate, p) - cross(w, v)
      g_second = thirds%v - cross(thirds%w, p) - 2.0_wp*cross(w_rate, v) - cross(w, v_rate)
      ! the derivative of a vector that turns back with the moving link: x' - w x x
      slip = g_rate - cross(w, g)
      slip_rate = g_second - cross(w_rate, g) - cross(w, g_rate)
      back%w = -turn(r_back, thirds%w - cross(w, w_rate))
      back%v = -turn(r_back, slip_rate - cross(w, slip))
    end associate
    back%known = thirds%known
  end function reversed_thirds

  !> The motion of the reference link in the moving link, from that of the moving in the reference link.
  pure function reversed_motion(motion) result(back)
    type(pair_motion_type), intent(in) :: motion   !< motion of the moving link in the reference link
    type(pair_motion_type) :: back
    real(wp) :: g(3), r_back(3, 3)

    r_back = transpose(motion%pose%r)
    back%pose = inverse(motion%pose)
    g = motion%v - cross(motion%w, motion%pose%p)
    back%w = -turn(r_back, motion%w)
    back%v = -turn(r_back, g)
    back%w_rate = -turn(r_back, motion%w_rate)
    back%v_rate = turn(r_back, cross(motion%w, g) + cross(motion%w, motion%v) &
                         + cross(motion%w_rate, motion%pose%p) - motion%v_rate)
  end function reversed_motion
end module mech9_pair
