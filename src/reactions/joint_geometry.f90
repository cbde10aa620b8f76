!> The places at which wrenches act, and the screws of the pairs, in one position.
module mech9_joint_geometry
  use mech9_kinds, only: wp
  use mech9_rotation, only: cross
  use mech9_plan, only: plan_type
  use mech9_state, only: state_type
  use mech9_frame_motion, only: link_motion, step_screw
  use mech9_reaction_plan, only: reaction_plan_type
  implicit none
  private
  public :: joint_geometry_type, new_joint_geometry, find_geometry

  !> Positions are from the origin of frame 0, in the axes of link 1. Screws are scaled: translation, then rotation times the
  !> mechanism's size; wrenches that work on them are force, then moment over this size.
  type :: joint_geometry_type
    real(wp), allocatable :: place(:, :)   !< (3,N) a place on each link, on the axis of one of its pairs [m]
    real(wp), allocatable :: reached(:, :) !< (3,M) origin of the frame that each step reaches [m]
    real(wp), allocatable :: spin(:, :)    !< (3,M) its angular velocity per unit of the coordinate
    real(wp), allocatable :: slide(:, :)   !< (3,M) velocity of this origin per unit of the coordinate [m per unit]
    real(wp), allocatable :: point(:, :)   !< (3,M) origin of each pair's frame in its moving link [m]
    real(wp), allocatable :: axis(:, :)    !< (6,M) motion of the moving link at this point in the reference link, of length 1
    real(wp), allocatable :: length(:)     !< (M) of this motion per unit of the coordinate [m per unit]
  end type joint_geometry_type

contains

  !> Room for the geometry of a mechanism.
  pure function new_joint_geometry(plan) result(geometry)
    type(plan_type), intent(in) :: plan   !< the plan of the mechanism
    type(joint_geometry_type) :: geometry

    allocate (geometry%place(3, plan%n_links), source=0.0_wp)
    associate (m => plan%n_coordinates)
      allocate (geometry%reached(3, m), geometry%spin(3, m), geometry%slide(3, m), geometry%point(3, m), source=0.0_wp)
      allocate (geometry%axis(6, m), geometry%length(m), source=0.0_wp)
    end associate
  end function new_joint_geometry

  !> The geometry of the position in `state`.
  pure subroutine find_geometry(plan, reactions, state, geometry)
    type(plan_type), intent(in) :: plan                     !< the plan of the mechanism
    type(reaction_plan_type), intent(in) :: reactions       !< the plan of inverse dynamics
    type(state_type), intent(in) :: state                   !< with the poses of the frames
    type(joint_geometry_type), intent(inout) :: geometry    !< the geometry
    real(wp) :: w(3), v(3), place(3), screw(6)
    integer :: s, k

    do s = 1, plan%n_coordinates
      k = plan%steps(s)%coordinate
      associate (pair => reactions%pairs(k), point => geometry%point(:, k))
        call step_screw(plan, state, s, w, v, place)
        geometry%reached(:, s) = place
        geometry%spin(:, s) = w
        geometry%slide(:, s) = v
        if (plan%frame_of(plan%steps(s)%link) == s) geometry%place(:, plan%steps(s)%link) = place
        point = place
        if (pair%direction < 0.0_wp) call move_to_start(plan, state, s, v, pair%frame%p, point)
        screw(1:3) = pair%direction*(v + cross(w, point - place))
        screw(4:6) = (pair%direction*reactions%length)*w
        geometry%length(k) = norm2(screw)
        geometry%axis(:, k) = 0.0_wp
        if (geometry%length(k) > 0.0_wp) geometry%axis(:, k) = screw/geometry%length(k)
      end associate
    end do
  end subroutine find_geometry

  !> The origin of the pair's frame in the moving link, from which a reversed step leads.
  pure subroutine move_to_start(plan, state, s, v, in_link, point)
    type(plan_type), intent(in) :: plan     !< the plan of the mechanism
    type(state_type), intent(in) :: state   !< with the poses of the frames
    integer, intent(in) :: s                !< number of the step
    real(wp), intent(in) :: v(3)            !< velocity of the new frame's origin per unit rate
    real(wp), intent(in) :: in_link(3)      !< origin of the pair's frame in the moving link [m]
    real(wp), intent(inout) :: point(3)     !< origin of the frame that the step reaches; the point [m]
    real(wp) :: r(3, 3), p(3), omega(3), v_link(3)
    integer :: link

    associate (step => plan%steps(s))
      if (step%is_screw) then
        point = point - (state%q(step%coordinate) + step%offset)*v
      else
        link = 1
        if (step%parent > 0) link = plan%steps(step%parent)%link
        call link_motion(plan, state, link, r, p, omega, v_link)
        point = p + matmul(r, in_link) - plan%origin
      end if
    end associate
  end subroutine move_to_start
end module mech9_joint_geometry
