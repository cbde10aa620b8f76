!> Revolute, prismatic and helical pairs, which move along one fixed screw axis.
!>
!> T(q) = F * motion(q + offset) * G^-1, where F is the pose of the axis in the reference link, G that in the moving one,
!> and the motion turns about z, slides along z, or does both.
module mech9_screw_pair
  use mech9_kinds, only: wp, pi
  use mech9_error, only: error_type
  use mech9_rotation, only: cross
  use mech9_pose, only: pose_type, compose, inverse, pose_from_dh, identity_pose
  use mech9_pair, only: pair_type, pair_motion_type, screw_factors_type, kind_name_length
  implicit none
  private
  public :: screw_pair_type, revolute_pair, prismatic_pair, helical_pair
  public :: revolute_pair_dh, prismatic_pair_dh, helical_pair_dh

  !> A pair with a fixed axis by its factors.
  type, extends(pair_type) :: screw_pair_type
    type(screw_factors_type) :: factors
  contains
    procedure :: evaluate
    procedure :: as_screw
    procedure :: kind_name
    procedure :: user_calls
  end type screw_pair_type

contains

  !> A pair that turns by q [rad] about the common z axis of its two frames.
  pure function revolute_pair(frame_in_reference, frame_in_moving) result(pair)
    type(pose_type), intent(in) :: frame_in_reference   !< F, pose of the axis (its z) in the reference link
    type(pose_type), intent(in) :: frame_in_moving      !< G, pose of the axis (its z) in the moving link
    type(screw_pair_type) :: pair

    pair%angular = .true.
    pair%factors = screw_factors_type(before=frame_in_reference, after=inverse(frame_in_moving), turn=1.0_wp)
  end function revolute_pair

  !> A pair that slides by q [m] along the common z axis of its two frames.
  pure function prismatic_pair(frame_in_reference, frame_in_moving) result(pair)
    type(pose_type), intent(in) :: frame_in_reference   !< F, pose of the axis (its z) in the reference link
    type(pose_type), intent(in) :: frame_in_moving      !< G, pose of the axis (its z) in the moving link
    type(screw_pair_type) :: pair

    pair%angular = .false.
    pair%factors = screw_factors_type(before=frame_in_reference, after=inverse(frame_in_moving), slide=1.0_wp)
  end function prismatic_pair

  !> A pair that turns by q [rad] and advances by `pitch` [m] per turn.
  pure function helical_pair(frame_in_reference, frame_in_moving, pitch) result(pair)
    type(pose_type), intent(in) :: frame_in_reference   !< F, pose of the axis (its z) in the reference link
    type(pose_type), intent(in) :: frame_in_moving      !< G, pose of the axis (its z) in the moving link
    real(wp), intent(in) :: pitch                       !< advance per turn [m]
    type(screw_pair_type) :: pair

    pair%angular = .true.
    pair%factors = screw_factors_type(before=frame_in_reference, after=inverse(frame_in_moving), &
                                      turn=1.0_wp, slide=pitch/(2.0_wp*pi))
  end function helical_pair

  !> Revolute pair in Denavit-Hartenberg form, q added to theta.
  pure function revolute_pair_dh(a, alpha, d, theta) result(pair)
    real(wp), intent(in) :: a       !< length of the link [m]
    real(wp), intent(in) :: alpha   !< twist of the link [rad]
    real(wp), intent(in) :: d       !< offset of the joint [m]
    real(wp), intent(in) :: theta   !< angle of the joint at q = 0 [rad]
    type(screw_pair_type) :: pair

    pair%angular = .true.
    pair%factors = screw_factors_type(before=identity_pose, after=pose_from_dh(a, alpha, d, 0.0_wp), &
                                      turn=1.0_wp, offset=theta)
  end function revolute_pair_dh

  !> Prismatic pair in Denavit-Hartenberg form, q added to d.
  pure function prismatic_pair_dh(a, alpha, d, theta) result(pair)
    real(wp), intent(in) :: a       !< length of the link [m]
    real(wp), intent(in) :: alpha   !< twist of the link [rad]
    real(wp), intent(in) :: d       !< offset of the joint at q = 0 [m]
    real(wp), intent(in) :: theta   !< angle of the joint [rad]
    type(screw_pair_type) :: pair

    pair%angular = .false.
    pair%factors = screw_factors_type(before=identity_pose, after=pose_from_dh(a, alpha, 0.0_wp, theta), &
                                      slide=1.0_wp, offset=d)
  end function prismatic_pair_dh

  !> Helical pair in Denavit-Hartenberg form, q added to theta.
  pure function helical_pair_dh(a, alpha, d, theta, pitch) result(pair)
    real(wp), intent(in) :: a       !< length of the link [m]
    real(wp), intent(in) :: alpha   !< twist of the link [rad]
    real(wp), intent(in) :: d       !< offset of the joint at q = 0 [m]
    real(wp), intent(in) :: theta   !< angle of the joint at q = 0 [rad]
    real(wp), intent(in) :: pitch   !< advance per turn [m]
    type(screw_pair_type) :: pair

    pair%angular = .true.
    pair%factors = screw_factors_type(before=pose_from_dh(0.0_wp, 0.0_wp, d, theta), &
                                      after=pose_from_dh(a, alpha, 0.0_wp, 0.0_wp), &
                                      turn=1.0_wp, slide=pitch/(2.0_wp*pi))
  end function helical_pair_dh

  !> The motion along the axis; it has values for all q.
  subroutine evaluate(self, q, motion, err)
    class(screw_pair_type), intent(in) :: self          !< the screw pair
    real(wp), intent(in) :: q                           !< value of the coordinate [rad, m]
    type(pair_motion_type), intent(out) :: motion       !< pose of the moving link and its derivatives in q
    type(error_type), allocatable, intent(out) :: err   !< allocated if it failed
    type(pose_type) :: step
    real(wp) :: x, axis(3), arm(3)

    associate (f => self%factors)
      x = q + f%offset
      step = pose_from_dh(0.0_wp, 0.0_wp, f%slide*x, f%turn*x)
      motion%pose = compose(compose(f%before, step), f%after)
      axis = f%before%r(:, 3)
      arm = motion%pose%p - f%before%p
      motion%w = f%turn*axis
      motion%v = f%slide*axis + cross(motion%w, arm)
      motion%v_rate = cross(motion%w, motion%v)
    end associate
  end subroutine evaluate

  !> The pair is given by these factors.
  pure subroutine as_screw(self, factors, is_screw)
    class(screw_pair_type), intent(in) :: self         !< the screw pair
    type(screw_factors_type), intent(out) :: factors   !< the factors of the pair
    logical, intent(out) :: is_screw                   !< true

    factors = self%factors
    is_screw = .true.
  end subroutine as_screw

  !> The kind follows from the factors.
  pure function kind_name(self) result(name)
    class(screw_pair_type), intent(in) :: self   !< the screw pair
    character(len=kind_name_length) :: name

    if (.not. self%angular) then
      name = 'prismatic'
    else if (abs(self%factors%slide) <= 0.0_wp) then
      name = 'revolute'
    else
      name = 'helical'
    end if
  end function kind_name

  !> No user's procedure is called.
  pure integer function user_calls(self)
    class(screw_pair_type), intent(in) :: self   !< the screw pair

    user_calls = 0
  end function user_calls
end module mech9_screw_pair
