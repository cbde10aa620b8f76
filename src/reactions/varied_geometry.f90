!> The changes of the points and screws of the pairs with all parameters, in one position.
module mech9_varied_geometry
  use mech9_kinds, only: wp
  use mech9_reaction_tolerances, only: equal_lengths
  use mech9_rotation, only: turn, cross
  use mech9_twists, only: shift_at
  use mech9_varied_motion, only: varied_motion_type, link_twists
  use mech9_varied_forces, only: vary_step, departing_twists
  use mech9_reaction_plan, only: reaction_plan_type
  use mech9_joint_geometry, only: joint_geometry_type
  implicit none
  private
  public :: varied_geometry_type, new_varied_geometry, find_varied_geometry

  !> Derivatives of the numbers of joint_geometry_type, and of the length by which moments are divided. Points are from the origin of
  !> frame 0, in its axes.
  type :: varied_geometry_type
    real(wp), allocatable :: point(:, :, :)         !< (P,3,M) of the points of the pairs [m per unit of the parameter]
    !> (6,M) Motion of the moving link in the reference link per unit of the coordinate: shift of the point of the joint's last pair,
    !> then rotation.
    real(wp), allocatable :: screw(:, :)
    real(wp), allocatable :: screw_change(:, :, :)  !< (P,6,M) its derivatives
    real(wp), allocatable :: length(:)              !< (P) of the length
    !> (P) The same; it differs from `length` where several distances are the largest, and their derivatives are different.
    real(wp), allocatable :: other_length(:)
    real(wp), allocatable, private :: ends(:, :)           !< (3,2M) origins of the pairs' frames in reference and moving links
    real(wp), allocatable, private :: end_change(:, :, :)  !< (P,3,2M) their derivatives
  end type varied_geometry_type

contains

  !> Room for the changes.
  pure function new_varied_geometry(motion) result(self)
    type(varied_motion_type), intent(in) :: motion   !< derivatives of the motion
    type(varied_geometry_type) :: self

    associate (n => motion%n_parameters, m => motion%plan%n_coordinates)
      allocate (self%point(n, 3, m), self%screw(6, m), self%screw_change(n, 6, m), self%length(n), self%other_length(n), &
                self%ends(3, 2*m), self%end_change(n, 3, 2*m), source=0.0_wp)
    end associate
  end function new_varied_geometry

  !> Find the changes in the present motion.
  subroutine find_varied_geometry(motion, reactions, geometry, self)
    type(varied_motion_type), intent(in) :: motion            !< derivatives of the motion
    type(reaction_plan_type), intent(in) :: reactions         !< the plan of inverse dynamics
    type(joint_geometry_type), intent(in) :: geometry         !< of the position
    type(varied_geometry_type), intent(inout) :: self         !< gets the changes
    integer :: k

    do k = 1, motion%plan%n_coordinates
      call vary_ends(motion, k, reactions%pairs(k)%direction < 0.0_wp, self)
    end do
    do k = 1, motion%plan%n_coordinates
      self%point(:, :, k) = self%end_change(:, :, 2*k)
      call vary_screw(motion, reactions, geometry, k, self)
    end do
    if (size(reactions%clusters) > 0) call vary_length(motion, reactions, self)
  end subroutine find_varied_geometry

  !> The origins of a pair's frames in both links, and their changes. A step departs from the frame in one link and reaches that in
  !> the other.
  subroutine vary_ends(motion, k, reversed, self)
    type(varied_motion_type), intent(in) :: motion       !< derivatives of the motion
    integer, intent(in) :: k                             !< coordinate of the pair
    logical, intent(in) :: reversed                      !< the step departs from the moving link
    type(varied_geometry_type), intent(inout) :: self    !< gets the changes
    real(wp) :: departing(motion%n_parameters, 6)
    integer :: s, i, at, p

    associate (plan => motion%plan, state => motion%state)
      s = plan%step_of(k)
      i = plan%steps(s)%parent
      departing = departing_twists(plan, motion, s, motion%twists(:, :, 0, i))
      at = merge(2*k, 2*k - 1, reversed)
      self%ends(:, at) = state%p(:, i) + turn(state%r(:, :, i), plan%steps(s)%before%p)
      do p = 1, motion%n_parameters
        self%end_change(p, :, at) = shift_at(departing(p, :), self%ends(:, at))
      end do
      at = 4*k - 1 - at
      self%ends(:, at) = state%p(:, s)
      do p = 1, motion%n_parameters
        self%end_change(p, :, at) = shift_at(motion%twists(p, :, 0, s), self%ends(:, at))
      end do
    end associate
  end subroutine vary_ends

  !> The motion of a pair at the point of its joint's last pair, and its change.
  subroutine vary_screw(motion, reactions, geometry, k, self)
    type(varied_motion_type), intent(in) :: motion         !< derivatives of the motion
    type(reaction_plan_type), intent(in) :: reactions      !< the plan of inverse dynamics
    type(joint_geometry_type), intent(in) :: geometry      !< of the position
    integer, intent(in) :: k                               !< coordinate of the pair
    type(varied_geometry_type), intent(inout) :: self      !< with the changes of all ends; gets the screw
    real(wp) :: changes(motion%n_parameters, 6), spin(3)
    integer :: s, p, last

    s = motion%plan%step_of(k)
    last = reactions%pairs(k)%last
    call vary_step(motion%plan, motion, s, motion%twists(:, :, 0, motion%plan%steps(s)%parent), changes)
    associate (direction => reactions%pairs(k)%direction, twist => motion%motion%step(:, 0, s), point => geometry%point(:, last))
      self%screw(1:3, k) = direction*shift_at(twist, point)
      self%screw(4:6, k) = direction*twist(1:3)
      do p = 1, motion%n_parameters
        spin = changes(p, 1:3)
        self%screw_change(p, 1:3, k) = direction*(shift_at(changes(p, :), point) &
                                                  + cross(twist(1:3), self%end_change(p, :, 2*last)))
        self%screw_change(p, 4:6, k) = direction*spin
      end do
    end associate
  end subroutine vary_screw

  !> The change of the length by which moments are divided: that of the largest distance between two ends on one link. Where there is
  !> none, that of the largest distance of an end from the origin of its link.
  subroutine vary_length(motion, reactions, self)
    type(varied_motion_type), intent(in) :: motion         !< derivatives of the motion
    type(reaction_plan_type), intent(in) :: reactions      !< the plan of inverse dynamics
    type(varied_geometry_type), intent(inout) :: self      !< with the changes of all ends; gets that of the length
    real(wp) :: apart(3)
    integer :: a, b
    logical :: found

    found = .false.
    self%length = 0.0_wp
    self%other_length = 0.0_wp
    do a = 1, size(self%ends, 2)
      do b = 1, a - 1
        if (link_of(reactions, a) /= link_of(reactions, b)) cycle
        apart = self%ends(:, a) - self%ends(:, b)
        if (norm2(apart) < (1.0_wp - equal_lengths)*reactions%length) cycle
        call take_change(apart, self%end_change(:, :, a) - self%end_change(:, :, b), found, self)
      end do
    end do
    if (.not. found) call vary_reach(motion, reactions, self)
  end subroutine vary_length

  !> The change of the largest distance of an end from the origin of its link, where all ends on each link coincide. If a parameter
  !> moves them apart, the length jumps.
  subroutine vary_reach(motion, reactions, self)
    type(varied_motion_type), intent(in) :: motion         !< derivatives of the motion
    type(reaction_plan_type), intent(in) :: reactions      !< the plan of inverse dynamics
    type(varied_geometry_type), intent(inout) :: self      !< with the changes of all ends; gets that of the length
    real(wp) :: twists(motion%n_parameters, 6, 0:2), origin(3), apart(3), change(motion%n_parameters, 3)
    integer :: a, b, p, f, link
    logical :: found

    found = .false.
    do a = 1, size(self%ends, 2)
      link = link_of(reactions, a)
      f = motion%plan%frame_of(link)
      origin = motion%state%p(:, f) + turn(motion%state%r(:, :, f), motion%plan%link_in_frame(link)%p)
      apart = self%ends(:, a) - origin
      if (norm2(apart) < (1.0_wp - equal_lengths)*reactions%length .or. .not. norm2(apart) > 0.0_wp) cycle
      call link_twists(motion, link, twists)
      do p = 1, motion%n_parameters
        change(p, :) = self%end_change(p, :, a) - shift_at(twists(p, :, 0), origin)
      end do
      call take_change(apart, change, found, self)
    end do
    do a = 1, size(self%ends, 2)
      do b = 1, a - 1
        if (link_of(reactions, a) /= link_of(reactions, b)) cycle
        do p = 1, motion%n_parameters
          if (norm2(self%end_change(p, :, a) - self%end_change(p, :, b)) > equal_lengths*norm2(self%end_change(p, :, a))) &
            self%other_length(p) = self%length(p) + reactions%length
        end do
      end do
    end do
  end subroutine vary_reach

  !> Take the change of one of the largest distances.
  pure subroutine take_change(apart, change, found, self)
    real(wp), intent(in) :: apart(3)                       !< from one place to the other [m]
    real(wp), intent(in) :: change(:, :)                   !< (P,3) its derivatives
    logical, intent(inout) :: found                        !< there was one before
    type(varied_geometry_type), intent(inout) :: self      !< gets the least and the greatest change
    real(wp) :: rate(size(change, 1))

    rate = matmul(change, apart)/norm2(apart)
    if (found) then
      self%length = min(self%length, rate)
      self%other_length = max(self%other_length, rate)
    else
      self%length = rate
      self%other_length = rate
    end if
    found = .true.
  end subroutine take_change

  !> The link of an end.
  pure integer function link_of(reactions, number) result(link)
    type(reaction_plan_type), intent(in) :: reactions      !< the plan of inverse dynamics
    integer, intent(in) :: number                          !< of the end: 2k-1 and 2k are those of pair k

    link = reactions%pairs((number + 1)/2)%links(merge(1, 2, mod(number, 2) == 0))
  end function link_of
end module mech9_varied_geometry
