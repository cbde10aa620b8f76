!> The posture of a mechanism: the positions of its links, but for settings of joints that are made of several pairs.
!>
!> Links that only form a ball joint or a universal joint do not count, because their positions show only which of several values of
!> the angles describes the joint (mech9_joint_links). Of rods between such joints the points, the centres of mass and the slides
!> count, not the turn about their own line. A link that shall count gets a point.
module mech9_posture
  use mech9_kinds, only: wp
  use mech9_tolerances, only: screw_tolerance
  use mech9_assembly_tolerances, only: same_assembly
  use mech9_mechanism, only: mechanism_type
  use mech9_pair_axes, only: pair_axes_type, pair_axes, sliding
  use mech9_plan, only: plan_type
  use mech9_state, only: state_type
  use mech9_frame_motion, only: link_motion, show_all_frames
  use mech9_joint_links, only: find_joint_links, posture_link, rod_link
  implicit none
  private
  public :: posture_type, new_posture, is_same_posture

  !> The quantities that make the posture of a mechanism.
  type :: posture_type
    integer, allocatable :: links(:)       !< links whose poses count, ascending
    integer, allocatable :: unseen(:)      !< all others: links of joints, and rods between joints
    integer, allocatable :: carriers(:)    !< links of the places
    real(wp), allocatable :: places(:, :)  !< (3,n) points and centres of mass of rods, each in the system of its link [m]
    integer, allocatable :: slides(:)      !< coordinates of slides inside rods
  contains
    procedure :: numbers
  end type posture_type

contains

  !> Find what makes the posture of a mechanism.
  function new_posture(mechanism, plan) result(posture)
    type(mechanism_type), intent(in) :: mechanism   !< the mechanism
    type(plan_type), intent(in) :: plan             !< its plan
    type(posture_type) :: posture
    type(pair_axes_type), allocatable :: axes(:)
    integer :: roles(plan%n_links), i, n

    call find_joint_links(mechanism, screw_tolerance*plan%length, roles)
    posture%links = pack([(i, i=2, plan%n_links)], roles(2:) == posture_link)
    posture%unseen = pack([(i, i=2, plan%n_links)], roles(2:) /= posture_link)
    n = count(roles(mechanism%points%link) == rod_link) + count(roles(mechanism%bodies%link) == rod_link)
    allocate (posture%carriers(n), posture%places(3, n))
    n = 0
    do i = 1, size(mechanism%points)
      call add_place(mechanism%points(i)%link, mechanism%points(i)%position)
    end do
    do i = 1, size(mechanism%bodies)
      call add_place(mechanism%bodies(i)%link, mechanism%bodies(i)%centre)
    end do
    axes = pair_axes(mechanism%pairs)
    posture%slides = [integer ::]
    do i = 1, size(axes)
      if (axes(i)%kind /= sliding) cycle
      if (all(roles(axes(i)%links) == rod_link)) posture%slides = [posture%slides, i]
    end do

  contains

    !> Add a place where it is one of a rod.
    subroutine add_place(link, place)
      integer, intent(in) :: link       !< its link
      real(wp), intent(in) :: place(3)  !< in the system of the link [m]

      if (roles(link) /= rod_link) return
      n = n + 1
      posture%carriers(n) = link
      posture%places(:, n) = place
    end subroutine add_place
  end function new_posture

  !> The posture as numbers: components of rotations, and lengths in parts of the mechanism's size.
  function numbers(self, plan, state) result(values)
    class(posture_type), intent(in) :: self     !< the quantities that make a posture
    type(plan_type), intent(in) :: plan         !< the plan of the mechanism
    type(state_type), intent(inout) :: state    !< with frames in place, which are shown in space
    real(wp) :: values(12*size(self%links) + 3*size(self%carriers) + size(self%slides))
    real(wp) :: r(3, 3), p(3), omega(3), v(3)
    integer :: i, n

    call show_all_frames(plan, state)
    n = 0
    do i = 1, size(self%links)
      call link_motion(plan, state, self%links(i), r, p, omega, v)
      values(n + 1:n + 12) = [r, p/plan%length]
      n = n + 12
    end do
    do i = 1, size(self%carriers)
      call link_motion(plan, state, self%carriers(i), r, p, omega, v)
      values(n + 1:n + 3) = (p + matmul(r, self%places(:, i)))/plan%length
      n = n + 3
    end do
    values(n + 1:) = state%q(self%slides)/plan%length
  end function numbers

  !> Whether the numbers of two postures are the same.
  pure logical function is_same_posture(a, b) result(same)
    real(wp), intent(in) :: a(:)   !< the numbers of one posture
    real(wp), intent(in) :: b(:)   !< the numbers of the other
    integer :: i

    same = .false.
    do i = 1, size(a)
      if (abs(a(i) - b(i)) > same_assembly) return
    end do
    same = .true.
  end function is_same_posture
end module mech9_posture
