!> Rods between two ball joints that the user has left to turn about themselves: one angle of them becomes independent.
!>
!> It is held, unless the rod resists such a turn and moves freely. An angle that takes nearly the whole turn at the start is held
!> where it is: the rod can point in nearly all directions so. Where there is none, the angle is that of a turn about an axis of the
!> rod, which is the third turn of a joint whose moving link the rod is, or the first turn of one whose reference link it is. It is
!> held at the nearest position where the rod can point in all directions, so that chains close: there the middle axis is at a
!> right angle to the rod's line.
module mech9_rod_holding
  use mech9_program_kind, only: dynamics
  use mech9_kinds, only: wp, pi
  use mech9_rotation, only: cross, unit
  use mech9_error, only: error_type
  use mech9_pose, only: pose_type, inverse, compose, identity_pose
  use mech9_three_turns, only: cyclic
  use mech9_idle_rods, only: idle_rod_type, find_idle_rods
  use mech9_compound_joint, only: compound_joint_type
  use mech9_partition, only: free_coordinate, driven_coordinate, dependent_coordinate, new_partition
  use mech9_pair, only: pair_motion_type, screw_factors_type
  use mech9_law, only: drive_slot_type
  use mech9_polynomial_law, only: polynomial_law_type
  use mech9_mechanism, only: mechanism_type
  use mech9_model, only: model_type
  implicit none
  private
  public :: hold_idle_rods

  !> A rod does not resist a turn about its line where its moment of inertia about it is below this part of the largest one of the
  !> mechanism: the equation of such a turn is little more than round-off of the others, which makes steps ever shorter.
  real(wp), parameter :: slender = 1.0e-9_wp
  !> An angle takes nearly the whole turn of a rod about itself where its share is above this: about such an axis the rod
  !> can point in nearly all directions while the angle is held.
  real(wp), parameter :: nearly_whole = 0.9_wp
  !> A line is in a plane where its direction is that far from it.
  real(wp), parameter :: round_off = 1.0e-13_wp

contains

  !> Make one angle of each idle rod independent, unless one is so already.
  subroutine hold_idle_rods(model)
    type(model_type), intent(inout) :: model    !< the model without errors
    type(idle_rod_type), allocatable :: rods(:)
    integer, allocatable :: kinds(:)
    logical :: changed, serves_there, turns_freely
    integer :: i, k

    call find_idle_rods(model%mechanism%structure, rods)
    kinds = model%problem%partition%kind
    changed = .false.
    do i = 1, size(rods)
      call choose_angle(model%mechanism, rods(i), kinds, model%problem%initial%position, k, serves_there)
      if (k == 0) cycle
      changed = .true.
      if (.not. (serves_there .or. model%problem%initial%position_given(k))) &
        call let_point_anywhere(model%mechanism, rods(i), k, model%problem%initial%position)
      turns_freely = model%program == dynamics
      if (turns_freely) turns_freely = resists(model%mechanism, rods(i), model%problem%initial%position)
      if (turns_freely) then
        kinds(k) = free_coordinate
        model%problem%initial%position_given(k) = .true.
      else
        kinds(k) = driven_coordinate
        call hold(k, model%problem%initial%position(k), model%problem%drives)
      end if
    end do
    if (.not. changed) return
    call new_partition(model%mechanism%structure, kinds /= dependent_coordinate, model%problem%partition)
    model%problem%partition%kind = kinds
  end subroutine hold_idle_rods

  !> The angle that changes more of the two about axes of the rod, unless another one of its joints takes nearly the whole turn of
  !> the rod about itself and they do not; 0 where an angle is independent already or coupled, or where the balls have one centre.
  subroutine choose_angle(mechanism, rod, kinds, q, angle, serves_there)
    type(mechanism_type), intent(in) :: mechanism   !< the mechanism
    type(idle_rod_type), intent(in) :: rod          !< the rod
    integer, intent(in) :: kinds(:)                 !< (M) driven, free or dependent
    real(wp), intent(in) :: q(:)                    !< (M) guesses of the coordinates [rad, m]
    integer, intent(out) :: angle                   !< number of its coordinate
    logical, intent(out) :: serves_there            !< this angle takes nearly the whole turn at the guesses
    real(wp) :: lines(3, 2), shares(3, 2)
    integer :: numbers(3, 2), i, at(2)
    logical :: about_rod(3, 2)

    angle = 0
    serves_there = .false.
    do i = 1, 2
      associate (joint => mechanism%structure%joints(rod%joints(i)))
        if (any(kinds(joint%coordinates()) /= dependent_coordinate) .or. is_coupled(mechanism, joint%coordinates())) return
        numbers(:, i) = joint%coordinates()
      end associate
    end do
    lines = lines_of(mechanism, rod, q)
    if (.not. norm2(lines) > 0.0_wp) return
    about_rod = .false.
    do i = 1, 2
      associate (k => turn_of_rod(mechanism, rod, i))
        about_rod(k, i) = .true.
        shares(:, i) = abs(shares_of(lines(:, i), k == 3, q(numbers(:, i))))
      end associate
    end do
    ! the share of a turn about an axis along the rod stays what it is, wherever the rod points
    at = maxloc(shares, mask=about_rod .or. (shares > nearly_whole .and. .not. any(about_rod .and. shares > nearly_whole)))
    serves_there = shares(at(1), at(2)) > nearly_whole
    angle = numbers(at(1), at(2))
  end subroutine choose_angle

  !> Directions of a rod's line in the frames of its two ball joints; 0 where the balls have one centre.
  function lines_of(mechanism, rod, q) result(lines)
    type(mechanism_type), intent(in) :: mechanism   !< the mechanism
    type(idle_rod_type), intent(in) :: rod          !< the rod
    real(wp), intent(in) :: q(:)                    !< (M) guesses of the coordinates [rad, m]
    real(wp) :: lines(3, 2), line(3)
    type(pose_type) :: frames(2), links(size(rod%links))
    integer :: i

    call place_links(mechanism, rod, q, links, frames)
    line = frames(2)%p - frames(1)%p
    if (norm2(line) > 0.0_wp) line = unit(line)
    do i = 1, 2
      lines(:, i) = matmul(line, frames(i)%r)
    end do
  end function lines_of

  !> The turn of one of a rod's two joints that is about an axis of the rod: the third one of its moving link, else the first one.
  pure integer function turn_of_rod(mechanism, rod, i) result(turn)
    type(mechanism_type), intent(in) :: mechanism   !< the mechanism
    type(idle_rod_type), intent(in) :: rod          !< the rod
    integer, intent(in) :: i                        !< 1 or 2

    associate (link => rod%links(merge(1, size(rod%links), i == 1)))
      turn = merge(3, 1, mechanism%structure%joints(rod%joints(i))%ends(2) == link)
    end associate
  end function turn_of_rod

  !> Change the guesses of a ball joint's angles so that the rod points as before, and can point in all directions while one of
  !> them is held.
  subroutine let_point_anywhere(mechanism, rod, held, q)
    type(mechanism_type), intent(in) :: mechanism   !< the mechanism
    type(idle_rod_type), intent(in) :: rod          !< the rod
    integer, intent(in) :: held                     !< number of the coordinate to be held
    real(wp), intent(inout) :: q(:)                 !< (M) guesses of the coordinates [rad, m]
    real(wp) :: lines(3, 2)
    integer :: i

    lines = lines_of(mechanism, rod, q)
    do i = 1, 2
      associate (k => mechanism%structure%joints(rod%joints(i))%numbers)
        if (k(3) == held) call turn_across(lines(:, i), q(k(1)), q(k(2)), q(k(3)))
        ! seen from the rod, the turns follow in the opposite order; a reflection that exchanges x and z restores it
        if (k(1) == held) call turn_across(lines(3:1:-1, i), q(k(3)), q(k(2)), q(k(1)))
      end associate
    end do
  end subroutine let_point_anywhere

  !> Change turns about x, y', z'' so that the third one brings a line into the plane of x and z, and that the line points as
  !> before.
  pure subroutine turn_across(line, first, second, third)
    real(wp), intent(in) :: line(3)       !< direction of the line in the moving frame
    real(wp), intent(inout) :: first      !< angle about x [rad]
    real(wp), intent(inout) :: second     !< angle about y' [rad]
    real(wp), intent(inout) :: third      !< angle about z'' [rad]
    real(wp) :: a(2), b(2), c(2), angle

    ! the line after each of the turns: x and y, x and z, y and z
    a = [cos(third)*line(1) - sin(third)*line(2), sin(third)*line(1) + cos(third)*line(2)]
    if (abs(a(2)) <= round_off) return
    b = [cos(second)*a(1) + sin(second)*line(3), cos(second)*line(3) - sin(second)*a(1)]
    c = [cos(first)*a(2) - sin(first)*b(2), sin(first)*a(2) + cos(first)*b(2)]
    angle = -atan2(line(2), line(1))
    third = angle + pi*anint((third - angle)/pi)
    angle = atan2(-c(1), c(2))
    first = angle + pi*anint((first - angle)/pi)
    angle = atan2(line(3), cos(third)*line(1) - sin(third)*line(2)) - atan2(cos(first)*c(2) - sin(first)*c(1), b(1))
    second = angle + 2.0_wp*pi*anint((second - angle)/(2.0_wp*pi))
  end subroutine turn_across

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

  !> The poses of a rod's links in its first one, and the frames of both ball joints there.
  subroutine place_links(mechanism, rod, q, links, frames)
    type(mechanism_type), intent(in) :: mechanism   !< the mechanism
    type(idle_rod_type), intent(in) :: rod          !< the rod
    real(wp), intent(in) :: q(:)                    !< (M) guesses of the coordinates [rad, m]
    type(pose_type), intent(out) :: links(:)        !< poses of the links
    type(pose_type), intent(out) :: frames(2)       !< poses of the joints' frames
    integer :: i, n

    n = size(links)
    links(1) = identity_pose
    do i = 2, n
      links(i) = compose(links(i - 1), pose_of_next(mechanism, rod%links(i - 1), rod%between(i - 1), q))
    end do
    frames(1) = frame_in(mechanism, mechanism%structure%joints(rod%joints(1)), rod%links(1))
    frames(2) = compose(links(n), frame_in(mechanism, mechanism%structure%joints(rod%joints(2)), rod%links(n)))
  end subroutine place_links

  !> The pose of the link beyond a pair or a joint in the link before it. Pairs whose pose is not that of a screw count as closed.
  function pose_of_next(mechanism, link, coordinate, q) result(pose)
    type(mechanism_type), intent(in) :: mechanism   !< the mechanism
    integer, intent(in) :: link                     !< number of the link before it
    integer, intent(in) :: coordinate               !< the pair's coordinate, or the first one of the joint
    real(wp), intent(in) :: q(:)                    !< (M) guesses of the coordinates [rad, m]
    type(pose_type) :: pose
    type(pair_motion_type) :: motion
    type(screw_factors_type) :: factors
    type(error_type), allocatable :: err
    integer, allocatable :: numbers(:)
    logical :: is_screw
    integer :: i, j

    j = mechanism%structure%joint_of(coordinate)
    numbers = [coordinate]
    if (j > 0) numbers = mechanism%structure%joints(j)%coordinates()
    pose = identity_pose
    do i = 1, size(numbers)
      associate (pair => mechanism%pairs(numbers(i))%pair)
        call pair%as_screw(factors, is_screw)
        if (.not. is_screw) cycle
        call pair%evaluate(q(numbers(i)), motion, err)
        if (.not. allocated(err)) pose = compose(pose, motion%pose)
      end associate
    end do
    if (j > 0) then
      if (mechanism%structure%joints(j)%ends(1) /= link) pose = inverse(pose)
    else if (mechanism%pairs(coordinate)%pair%reference /= link) then
      pose = inverse(pose)
    end if
  end function pose_of_next

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

  !> Shares of the turns about x, y', z'' in a turn of one of both links with a rate of one: their rates, times the cosine of the
  !> second angle, with which the rates become large near the singular position of the angles.
  pure function shares_of(line, moving, q) result(shares)
    real(wp), intent(in) :: line(3)   !< direction of the angular velocity, in the joint's frame in the link that turns
    logical, intent(in) :: moving     !< this is the moving link, else the reference link
    real(wp), intent(in) :: q(3)      !< the angles [rad]
    real(wp) :: shares(3), across

    if (moving) then
      across = line(1)*cos(q(3)) - line(2)*sin(q(3))
      shares = [across, (line(1)*sin(q(3)) + line(2)*cos(q(3)))*cos(q(2)), line(3)*cos(q(2)) - across*sin(q(2))]
    else
      across = line(3)*cos(q(1)) - line(2)*sin(q(1))
      shares = -[line(1)*cos(q(2)) - across*sin(q(2)), (line(3)*sin(q(1)) + line(2)*cos(q(1)))*cos(q(2)), across]
    end if
  end function shares_of

  !> Whether a rod has a moment of inertia about its line that counts.
  logical function resists(mechanism, rod, q)
    type(mechanism_type), intent(in) :: mechanism   !< the mechanism
    type(idle_rod_type), intent(in) :: rod          !< the rod
    real(wp), intent(in) :: q(:)                    !< (M) guesses of the coordinates [rad, m]
    type(pose_type) :: frames(2), links(size(rod%links))
    real(wp) :: line(3), of_link(3), from(3), arm(3), moment, largest
    integer :: i, n

    call place_links(mechanism, rod, q, links, frames)
    line = unit(frames(2)%p - frames(1)%p)
    moment = 0.0_wp
    largest = 0.0_wp
    do i = 1, size(mechanism%bodies)
      associate (body => mechanism%bodies(i))
        n = findloc(rod%links, body%link, dim=1)
        if (n == 0) then
          largest = max(largest, maxval(abs(body%inertia)) + body%mass*dot_product(body%centre, body%centre))
          cycle
        end if
        of_link = matmul(transpose(links(n)%r), line)
        from = body%centre - matmul(transpose(links(n)%r), frames(1)%p - links(n)%p)
        arm = cross(of_link, from)
        moment = moment + dot_product(of_link, matmul(body%inertia, of_link)) + body%mass*dot_product(arm, arm)
        largest = max(largest, maxval(abs(body%inertia)) + body%mass*dot_product(from, from))
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
