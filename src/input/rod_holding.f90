!> Rods between two ball joints that the user has left to turn about themselves: one angle of them becomes independent.
!>
!> It is held where it is, unless the rod resists such a turn and moves freely. The angle is one that changes as the rod turns: the
!> third turn of a joint whose z axis in the rod, its moving link, lies along the rod; the first turn of a joint whose x axis in
!> the rod, its reference link, does; else the angle that changes most at the guesses of the start.
module mech9_rod_holding
  use mech9_kinds, only: wp
  use mech9_rotation, only: cross, unit
  use mech9_pose, only: pose_type, inverse, compose
  use mech9_three_turns, only: cyclic
  use mech9_idle_rods, only: idle_rod_type, find_idle_rods
  use mech9_compound_joint, only: compound_joint_type
  use mech9_partition, only: free_coordinate, driven_coordinate, dependent_coordinate, new_partition
  use mech9_pair, only: screw_factors_type
  use mech9_law, only: drive_slot_type
  use mech9_polynomial_law, only: polynomial_law_type
  use mech9_mechanism, only: mechanism_type
  use mech9_model, only: model_type
  implicit none
  private
  public :: hold_idle_rods

  !> A rod whose moment of inertia about its line is below this part of the largest one does not resist a turn about it.
  real(wp), parameter :: slender = 1.0e-9_wp
  !> Angles that take less than this part of a turn of the rod are not held.
  real(wp), parameter :: least_part = 0.3_wp
  !> The rod lies along an axis where the cosine of their angle is above this.
  real(wp), parameter :: in_line = 0.9_wp

contains

  !> Make one angle of each idle rod independent, unless one is so already.
  subroutine hold_idle_rods(all_driven, model)
    logical, intent(in) :: all_driven           !< every independent coordinate is driven, as in kinematics
    type(model_type), intent(inout) :: model    !< the model without errors
    type(idle_rod_type), allocatable :: rods(:)
    integer, allocatable :: kinds(:)
    logical :: changed
    integer :: i, k

    call find_idle_rods(model%mechanism%structure, rods)
    kinds = model%problem%partition%kind
    changed = .false.
    do i = 1, size(rods)
      call choose_angle(model%mechanism, rods(i), kinds, model%problem%initial%position, k)
      if (k == 0) cycle
      changed = .true.
      if (all_driven .or. .not. resists(model%mechanism, rods(i))) then
        kinds(k) = driven_coordinate
        call hold(k, model%problem%initial%position(k), model%problem%drives)
      else
        kinds(k) = free_coordinate
        model%problem%initial%position_given(k) = .true.
      end if
    end do
    if (.not. changed) return
    call new_partition(model%mechanism%structure, kinds /= dependent_coordinate, model%problem%partition)
    model%problem%partition%kind = kinds
  end subroutine hold_idle_rods

  !> The angle of a rod's joints that changes most as the rod turns about itself; 0 where an angle is independent already or
  !> coupled, where the balls have one centre, or where all change little.
  subroutine choose_angle(mechanism, rod, kinds, q, angle)
    type(mechanism_type), intent(in) :: mechanism   !< the mechanism
    type(idle_rod_type), intent(in) :: rod          !< the rod
    integer, intent(in) :: kinds(:)                 !< (M) driven, free or dependent
    real(wp), intent(in) :: q(:)                    !< (M) guesses of the coordinates [rad, m]
    integer, intent(out) :: angle                   !< number of its coordinate
    type(pose_type) :: frames(2)
    real(wp) :: line(3), rates(3), best
    integer :: i, k

    angle = 0
    best = least_part
    do i = 1, 2
      associate (joint => mechanism%structure%joints(rod%joints(i)))
        if (any(kinds(joint%coordinates()) /= dependent_coordinate) .or. is_coupled(mechanism, joint%coordinates())) return
        frames(i) = frame_in(mechanism, joint, rod%link)
      end associate
    end do
    line = frames(2)%p - frames(1)%p
    if (.not. norm2(line) > 0.0_wp) return
    line = unit(line)
    do i = 1, 2
      associate (joint => mechanism%structure%joints(rod%joints(i)), of_frame => matmul(transpose(frames(i)%r), line))
        ! the turns at the ends of the chain are about axes of the links: the part of the rod's turn that they take never changes
        if (joint%ends(2) == rod%link .and. abs(of_frame(3)) > in_line) angle = joint%numbers(3)
        if (joint%ends(1) == rod%link .and. abs(of_frame(1)) > in_line) angle = joint%numbers(1)
        if (angle > 0) return
      end associate
    end do
    do i = 1, 2
      associate (joint => mechanism%structure%joints(rod%joints(i)))
        rates = rates_of(matmul(transpose(frames(i)%r), line), joint%ends(2) == rod%link, q(joint%coordinates()))
        k = maxloc(abs(rates), dim=1)
        if (abs(rates(k)) <= best) cycle
        best = abs(rates(k))
        angle = joint%numbers(k)
      end associate
    end do
  end subroutine choose_angle

  !> Whether a coupling contains any of some coordinates.
  pure logical function is_coupled(mechanism, coordinates)
    type(mechanism_type), intent(in) :: mechanism   !< the mechanism
    integer, intent(in) :: coordinates(:)           !< their numbers
    integer :: c, i

    is_coupled = .false.
    if (.not. allocated(mechanism%couplings)) return
    do c = 1, size(mechanism%couplings)
      do i = 1, size(coordinates)
        is_coupled = is_coupled .or. any(mechanism%couplings(c)%coupling%coordinates == coordinates(i))
      end do
    end do
  end function is_coupled

  !> The frame of a spherical joint in one of its links.
  function frame_in(mechanism, joint, link) result(frame)
    type(mechanism_type), intent(in) :: mechanism       !< the mechanism
    type(compound_joint_type), intent(in) :: joint      !< the joint
    integer, intent(in) :: link                         !< its reference link or its moving link
    type(pose_type) :: frame
    type(screw_factors_type) :: factors
    logical :: is_screw

    if (link == joint%ends(2)) then
      call mechanism%pairs(joint%numbers(3))%pair%as_screw(factors, is_screw)
      frame = inverse(factors%after)
    else
      call mechanism%pairs(joint%numbers(1))%pair%as_screw(factors, is_screw)
      frame = compose(factors%before, pose_type(transpose(cyclic), [0.0_wp, 0.0_wp, 0.0_wp]))
    end if
  end function frame_in

  !> Rates of the turns about x, y', z'' as one of both links turns with a rate of one; less than those that are large where the
  !> angles are near their singular position.
  pure function rates_of(line, moving, q) result(rates)
    real(wp), intent(in) :: line(3)   !< direction of the angular velocity, in the joint's frame in the link that turns
    logical, intent(in) :: moving     !< this is the moving link, else the reference link
    real(wp), intent(in) :: q(3)      !< the angles [rad]
    real(wp) :: rates(3), across

    ! rates are multiplied by the cosine of the second angle
    if (moving) then
      across = line(1)*cos(q(3)) - line(2)*sin(q(3))
      rates = [across, (line(1)*sin(q(3)) + line(2)*cos(q(3)))*cos(q(2)), line(3)*cos(q(2)) - across*sin(q(2))]
    else
      across = line(3)*cos(q(1)) - line(2)*sin(q(1))
      rates = -[line(1)*cos(q(2)) - across*sin(q(2)), (line(3)*sin(q(1)) + line(2)*cos(q(1)))*cos(q(2)), across]
    end if
  end function rates_of

  !> Whether a rod has a moment of inertia about its line.
  logical function resists(mechanism, rod)
    type(mechanism_type), intent(in) :: mechanism   !< the mechanism
    type(idle_rod_type), intent(in) :: rod          !< the rod
    type(pose_type) :: frames(2)
    real(wp) :: line(3), arm(3), moment, largest
    integer :: i

    do i = 1, 2
      frames(i) = frame_in(mechanism, mechanism%structure%joints(rod%joints(i)), rod%link)
    end do
    line = unit(frames(2)%p - frames(1)%p)
    moment = 0.0_wp
    largest = 0.0_wp
    do i = 1, size(mechanism%bodies)
      associate (body => mechanism%bodies(i))
        if (body%link /= rod%link) cycle
        arm = cross(line, body%centre - frames(1)%p)
        moment = moment + dot_product(line, matmul(body%inertia, line)) + body%mass*dot_product(arm, arm)
        largest = largest + maxval(abs(body%inertia)) + body%mass*dot_product(body%centre - frames(1)%p, body%centre - frames(1)%p)
      end associate
    end do
    resists = moment > slender*largest
  end function resists

  !> Append a drive that holds a coordinate. It has no place in the data file.
  subroutine hold(coordinate, position, drives)
    integer, intent(in) :: coordinate                              !< number of the coordinate
    real(wp), intent(in) :: position                               !< its value there [rad]
    type(drive_slot_type), allocatable, intent(inout) :: drives(:) !< the drives, which get one more
    type(drive_slot_type), allocatable :: longer(:)
    type(polynomial_law_type) :: still
    integer :: i

    still%coefficients = [position]
    still%coordinate = coordinate
    allocate (longer(size(drives) + 1))
    do i = 1, size(drives)
      call move_alloc(drives(i)%drive, longer(i)%drive)
    end do
    allocate (longer(size(longer))%drive, source=still)
    call move_alloc(longer, drives)
  end subroutine hold
end module mech9_rod_holding
