!> Rods between two ball joints that can turn by themselves: one of their six angles is independent, which the program holds or which
!> is free.
!>
!> The other five angles are determined as long as the held one changes when the rod turns about itself. Its share in such a turn is
!> its rate times the sine of the angle between the first and the third axis of its joint: finite in gimbal lock, too. Where
!> the share becomes zero, the angle holds the rod in a position that the mechanism itself does not have, and another one must be
!> held.
module mech9_held_rods
  use mech9_kinds, only: wp
  use mech9_planning_tolerances, only: lesser_share, lesser_share_near
  use mech9_rotation, only: cross, unit
  use mech9_idle_rods, only: idle_rod_type, find_idle_rods
  use mech9_partition, only: partition_type, free_coordinate, dependent_coordinate
  use mech9_model, only: model_type
  use mech9_plan, only: plan_type
  use mech9_state, only: state_type
  implicit none
  private
  public :: held_rod_type, held_angle, find_held_rods, find_steps, best_angles, should_change, stop_turn, &
    note_free

  !> One rod. The first index is that of the angle in its joint, the second that of the joint.
  type :: held_rod_type
    integer :: coordinates(3, 2) = 0   !< of the angles
    integer :: ends(2) = 0             !< the rod's link at each joint
    integer :: steps(3, 2) = 0         !< steps of the plan that make them
    logical :: taken(3, 2) = .false.   !< the angle is an independent coordinate itself, so that it cannot be held
    integer :: held = 0                !< number of the coordinate that is held, or free; 0: a free one, if other angles are independent
    logical :: is_free = .false.       !< the angle moves freely
  end type held_rod_type

contains

  !> The one of some coordinates that the program holds: its drive has no place in the data file. 0: there is none.
  pure integer function held_angle(model, coordinates) result(k)
    type(model_type), intent(in) :: model        !< the model
    integer, intent(in) :: coordinates(:)        !< numbers of coordinates
    integer :: i

    k = 0
    do i = 1, size(model%problem%drives)
      associate (drive => model%problem%drives(i)%drive)
        if (drive%place%line == 0 .and. any(coordinates == drive%coordinate)) k = drive%coordinate
      end associate
    end do
  end function held_angle

  !> The rods that turn by themselves and whose positions the plan computes: those that the program holds, and those that move freely.
  subroutine find_held_rods(model, plan, rods)
    type(model_type), intent(in) :: model                        !< the model
    type(plan_type), intent(in) :: plan                          !< its plan
    type(held_rod_type), allocatable, intent(out) :: rods(:)     !< none where there is none
    type(idle_rod_type), allocatable :: idle(:)
    type(held_rod_type), allocatable :: found(:)
    logical :: planned(plan%n_coordinates)
    integer :: b, i, j, n

    call find_idle_rods(model%mechanism%structure, idle)
    allocate (found(size(idle)))
    n = 0
    if (size(idle) > 0 .and. .not. plan%planar%used) then
      planned = .false.
      do b = 1, size(plan%blocks)
        planned(plan%blocks(b)%coordinates) = .true.
      end do
      do i = 1, size(idle)
        do j = 1, 2
          found(n + 1)%coordinates(:, j) = model%mechanism%structure%joints(idle(i)%joints(j))%coordinates()
        end do
        associate (rod => found(n + 1))
          rod%ends = [idle(i)%links(1), idle(i)%links(size(idle(i)%links))]
          rod%held = held_angle(model, [rod%coordinates])
          rod%is_free = rod%held == 0 .and. any(model%problem%partition%kind([rod%coordinates]) == free_coordinate)
          if (.not. (rod%held > 0 .or. rod%is_free) .or. count(planned([rod%coordinates])) < 5) cycle
        end associate
        n = n + 1
      end do
    end if
    allocate (rods(n))
    rods = found(:n)
    call note_free(model%problem%partition, rods)
    call find_steps(plan, rods)
  end subroutine find_held_rods

  !> Note which angle of each free rod is independent; none where several are, or none, since other coordinates were chosen.
  pure subroutine note_free(partition, rods)
    type(partition_type), intent(in) :: partition    !< of the coordinates
    type(held_rod_type), intent(inout) :: rods(:)    !< get their free angles
    integer :: i, j, k

    do i = 1, size(rods)
      if (.not. rods(i)%is_free) cycle
      rods(i)%held = 0
      associate (kinds => reshape(partition%kind([rods(i)%coordinates]), [3, 2]))
        if (count(kinds /= dependent_coordinate) /= 1) cycle
        do j = 1, 2
          do k = 1, 3
            if (kinds(k, j) == free_coordinate) rods(i)%held = rods(i)%coordinates(k, j)
          end do
        end do
      end associate
    end do
  end subroutine note_free

  !> Find the steps that make the angles of rods in a plan, and those that are independent in it.
  pure subroutine find_steps(plan, rods)
    type(plan_type), intent(in) :: plan              !< the plan
    type(held_rod_type), intent(inout) :: rods(:)    !< get their steps
    integer :: i, j, step_of(plan%n_coordinates)

    if (size(rods) == 0) return
    step_of(plan%steps%coordinate) = [(i, i=1, size(step_of))]
    do i = 1, size(rods)
      rods(i)%steps = reshape(step_of([rods(i)%coordinates]), [3, 2])
      do j = 1, 2
        rods(i)%taken(:, j) = .not. (plan%steps(rods(i)%steps(:, j))%dependent .or. rods(i)%coordinates(:, j) == rods(i)%held)
      end do
    end do
  end subroutine find_steps

  !> Shares of the angles in a turn of a rod about itself, in the axes by which the joints move at present.
  pure function shares_of(rod, state) result(shares)
    type(held_rod_type), intent(in) :: rod     !< the rod
    type(state_type), intent(in) :: state      !< frames in place
    real(wp) :: shares(3, 2)
    integer :: j

    do j = 1, 2
      shares(:, j) = shares_about(state%axis_w(:, rod%steps(:, j)), line_of(rod, state))
    end do
  end function shares_of

  !> Direction from one ball to the other.
  pure function line_of(rod, state) result(line)
    type(held_rod_type), intent(in) :: rod     !< the rod
    type(state_type), intent(in) :: state      !< frames in place
    real(wp) :: line(3)

    line = state%p(:, rod%steps(3, 2)) - state%p(:, rod%steps(3, 1))
    if (norm2(line) > 0.0_wp) line = unit(line)
  end function line_of

  !> Shares of three turns in an angular velocity of one.
  pure function shares_about(axes, line) result(shares)
    real(wp), intent(in) :: axes(3, 3)   !< directions of the three turns
    real(wp), intent(in) :: line(3)      !< direction of the angular velocity
    real(wp) :: shares(3)

    shares = abs([dot_product(line, cross(axes(:, 2), axes(:, 3))), dot_product(line, cross(axes(:, 3), axes(:, 1))), &
                  dot_product(line, cross(axes(:, 1), axes(:, 2)))])
  end function shares_about

  !> Whether another angle of a rod should be held: it has a clearly greater share than the present one.
  pure logical function should_change(rod, state, is_near)
    type(held_rod_type), intent(in) :: rod     !< the rod
    type(state_type), intent(in) :: state      !< frames in place
    logical, intent(in) :: is_near             !< a closed chain is near a singular position, perhaps because of the held angle
    real(wp) :: shares(3, 2), share

    should_change = .false.
    if (rod%held == 0) return
    shares = shares_of(rod, state)
    share = maxval(shares, mask=rod%coordinates == rod%held)
    should_change = share < merge(lesser_share_near, lesser_share, is_near)*maxval(shares, mask=.not. rod%taken)
  end function should_change

  !> The angle of each rod to be held from now on: the present one, unless another one has a clearly greater share, which
  !> the greatest is then.
  function best_angles(rods, state) result(held)
    type(held_rod_type), intent(in) :: rods(:)          !< the rods, with their steps
    type(state_type), intent(in) :: state               !< in the angles that move the joints, frames in place
    integer :: held(size(rods))
    real(wp) :: shares(3, 2)
    integer :: i, at(2)

    do i = 1, size(rods)
      associate (rod => rods(i))
        held(i) = rod%held
        if (rod%held == 0) cycle
        shares = shares_of(rod, state)
        if (maxval(shares, mask=rod%coordinates == rod%held) >= &
            lesser_share_near*maxval(shares, mask=.not. rod%taken)) cycle
        at = maxloc(shares, mask=.not. rod%taken)
        held(i) = rod%coordinates(at(1), at(2))
      end associate
    end do
  end function best_angles

  !> Change the rates of a rod's six angles by those of a turn of the rod about itself so that the held one stands still. All other
  !> links move as before.
  pure subroutine stop_turn(rod, plan, state)
    type(held_rod_type), intent(in) :: rod       !< the rod
    type(plan_type), intent(in) :: plan          !< of the motion, with the angles that move the joints
    type(state_type), intent(inout) :: state     !< frames in place; gets the rates
    real(wp) :: rates(3, 2), line(3), volume, of_held
    integer :: j

    line = line_of(rod, state)
    do j = 1, 2
      associate (a => state%axis_w(:, rod%steps(:, j)))
        volume = dot_product(a(:, 1), cross(a(:, 2), a(:, 3)))
        if (.not. abs(volume) > 0.0_wp) return
        rates(:, j) = [dot_product(line, cross(a(:, 2), a(:, 3))), dot_product(line, cross(a(:, 3), a(:, 1))), &
                       dot_product(line, cross(a(:, 1), a(:, 2)))]/volume
      end associate
      ! the turns lead to the rod, or away from it
      if (plan%steps(maxval(rod%steps(:, j)))%link /= rod%ends(j)) rates(:, j) = -rates(:, j)
    end do
    of_held = sum(rates, mask=rod%coordinates == rod%held)
    if (abs(of_held) > 0.0_wp) then
      of_held = state%dq(rod%held)/of_held
      do j = 1, 2
        state%dq(rod%coordinates(:, j)) = state%dq(rod%coordinates(:, j)) - of_held*rates(:, j)
      end do
    end if
    state%dq(rod%held) = 0.0_wp
  end subroutine stop_turn
end module mech9_held_rods
