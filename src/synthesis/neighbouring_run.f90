!> The run of a planar design beside one whose run is known, and its derivatives at the targets: what a search needs most often, at a small
!> part of the cost of following a run from its start.
!>
!> All positions of the known run are closed at once for the new design, and are proved to lie on one branch. Where this fails the run is
!> in doubt, and must be followed.
module mech9_neighbouring_run
  use mech9_kinds, only: wp
  use mech9_plan, only: plan_type
  use mech9_objective, only: timing_given, timing_over, quantity_objective, assembles_limit
  use mech9_design_space, only: design_space_type, design_type
  use mech9_targets, only: target_type
  use mech9_planar_numbers, only: planar_design_type
  use mech9_planar_design, only: new_planar_design, place_planar_design
  use mech9_planar_loop, only: turn_on
  use mech9_planar_run, only: planar_run_type, planar_positions_type, new_planar_run, take_positions, find_turns, sort_positions, &
    close_positions
  use mech9_planar_branch, only: prove_branch
  use mech9_planar_slopes, only: planar_slopes_type, new_planar_slopes, find_coordinate_slopes, find_point_slopes
  implicit none
  private
  public :: neighbouring_run_type, new_neighbouring_run, record_position, find_neighbour, keep_run, find_slopes

  type :: neighbouring_run_type
    logical :: used = .false.              !< runs of these designs can be found in this way
    logical :: is_known = .false.          !< the run of a design is known
    logical :: is_neighbour = .false.      !< the last run was found beside another one
    type(planar_design_type) :: design
    type(planar_run_type) :: run
    type(planar_positions_type) :: known   !< the run from which others start
    type(planar_positions_type) :: trial   !< the last run that was found beside it
    type(planar_slopes_type) :: slopes
    integer :: recorded = 0                !< number of positions of a run that was followed
    integer, allocatable :: target(:)      !< (room) their targets; 0: none
    real(wp), allocatable :: t(:)          !< (room) their times [s]
    real(wp), allocatable :: q(:, :)       !< (M,room) their coordinates [rad, m]
  end type neighbouring_run_type

  !> Largest change of a coordinate with the time of a target, in its unit.
  real(wp), parameter :: longest_shift = 0.25_wp
  !> A run that has this many times the positions of the one that was followed last is followed anew.
  integer, parameter :: most_growth = 3

contains

  !> Prepare the runs; `used` is false where the mechanism, the parameters or the targets are of another kind.
  subroutine new_neighbouring_run(space, design, targets, near)
    type(design_space_type), intent(inout) :: space          !< the designs
    type(design_type), intent(in) :: design                  !< any of them
    type(target_type), intent(in) :: targets(:)              !< the targets
    type(neighbouring_run_type), intent(out) :: near         !< prepared

    associate (request => space%model%request)
      if (size(targets) == 0 .or. any(targets%length > 0.0_wp) .or. any(targets%turned > 0)) return
      if (any(request%objectives%kind == quantity_objective) .or. any(request%limits%kind /= assembles_limit)) return
    end associate
    call new_planar_run(design%plan, design%drives, near%run)
    if (.not. near%run%used) return
    call new_planar_design(space, design, near%design)
    if (.not. near%design%used) return
    call new_planar_slopes(size(targets), near%design, design, near%run, near%slopes)
    allocate (near%target(0), near%t(0), near%q(near%run%m, 0))
    near%used = .true.
  end subroutine new_neighbouring_run

  !> Record a position of a run that is followed.
  pure subroutine record_position(t, target, q, near)
    real(wp), intent(in) :: t                            !< its time [s]
    integer, intent(in) :: target                        !< the target that belongs to it; 0: none
    real(wp), intent(in) :: q(:)                         !< (M) its coordinates [rad, m]
    type(neighbouring_run_type), intent(inout) :: near   !< gets it
    real(wp), allocatable :: room(:, :)
    integer :: n

    n = near%recorded + 1
    if (n > size(near%t)) then
      allocate (room(size(q), 2*n + 30))
      room(:, :n - 1) = near%q(:, :n - 1)
      call move_alloc(room, near%q)
      near%t = [near%t, spread(0.0_wp, 1, size(near%q, 2) - size(near%t))]
      near%target = [near%target, spread(0, 1, size(near%q, 2) - size(near%target))]
    end if
    near%t(n) = t
    near%target(n) = target
    near%q(:, n) = q
    near%recorded = n
  end subroutine record_position

  !> Find the run of the design that was placed last in planar numbers, beside the known one; its start is the first position of
  !> `near%trial`.
  subroutine find_neighbour(plan, targets, times, design, near, r, found)
    type(plan_type), intent(in) :: plan                    !< the plan of all designs
    type(target_type), intent(in) :: targets(:)            !< the targets
    real(wp), intent(in) :: times(:)                       !< (targets) their times [s]
    type(design_type), intent(in) :: design                !< with its drives
    type(neighbouring_run_type), intent(inout) :: near     !< gets the run
    real(wp), intent(inout) :: r(:, :)                     !< (rows,groups) gets the differences from the targets
    logical, intent(out) :: found                          !< the run was found, on one branch from its start to its end

    near%is_neighbour = .false.
    call copy_positions(near%known, near%trial)
    call move_times(near%design, targets, times, near%run, near%trial, found)
    if (found) call close_positions(near%design, design%drives, near%run, near%trial, found)
    if (found) call prove_branch(near%design, design%drives, near%run, near%trial, found)
    found = found .and. near%trial%n <= most_growth*near%recorded
    if (.not. found) return
    call find_differences(plan, targets, near, r)
    near%is_neighbour = .true.
  end subroutine find_neighbour

  !> Copy positions into room that is there already.
  pure subroutine copy_positions(from, to)
    type(planar_positions_type), intent(in) :: from     !< the positions
    type(planar_positions_type), intent(inout) :: to    !< the copy

    associate (n => from%n)
      to%n = n
      to%target(:n) = from%target(:n)
      to%t(:n) = from%t(:n)
      to%q(:n, :) = from%q(:n, :)
      to%dq(:n, :) = from%dq(:n, :)
      to%angle(:n, :) = from%angle(:n, :)
      to%turn(:n, :, :) = from%turn(:n, :, :)
    end associate
  end subroutine copy_positions

  !> Move positions to new times of their targets, and their coordinates by their rates.
  subroutine move_times(design, targets, times, run, positions, done)
    type(planar_design_type), intent(in) :: design             !< placed
    type(target_type), intent(in) :: targets(:)                !< the targets
    real(wp), intent(in) :: times(:)                           !< (targets) their new times [s]
    type(planar_run_type), intent(in) :: run                   !< of the positions
    type(planar_positions_type), intent(inout) :: positions    !< moved, in the order of time
    logical, intent(out) :: done                               !< no coordinate moves far
    real(wp) :: by, change(1)
    integer :: i, k, s

    done = .true.
    if (all(targets%timing == timing_given)) return
    do i = 1, positions%n
      if (positions%target(i) == 0) cycle
      by = times(positions%target(i)) - positions%t(i)
      positions%t(i) = times(positions%target(i))
      do s = 1, run%m
        k = design%steps(s)%coordinate
        done = done .and. abs(positions%dq(i, k)*by) <= longest_shift*run%unit_of(k)
        if (.not. done) return
        positions%q(i, k) = positions%q(i, k) + positions%dq(i, k)*by
        if (.not. design%steps(s)%turns) cycle
        change = design%steps(s)%turn*positions%dq(i, k)*by
        positions%angle(i, s) = positions%angle(i, s) + change(1)
        call turn_on(1, change, positions%turn(i:i, 1, s), positions%turn(i:i, 2, s))
      end do
    end do
    call sort_positions(sign(1.0_wp, positions%t(positions%n) - positions%t(1)), positions)
  end subroutine move_times

  !> The weighted differences from the targets.
  pure subroutine find_differences(plan, targets, near, r)
    type(plan_type), intent(in) :: plan                  !< the plan of all designs
    type(target_type), intent(in) :: targets(:)          !< the targets
    type(neighbouring_run_type), intent(in) :: near      !< with a run
    real(wp), intent(inout) :: r(:, :)                   !< (rows,groups) gets the differences
    real(wp) :: place(3)
    integer :: i, g, f

    do i = 1, near%trial%n
      g = near%trial%target(i)
      if (g == 0) cycle
      associate (target => targets(g), frames => near%run%frames)
        r(:, g) = 0.0_wp
        if (target%coordinate > 0) then
          r(1, g) = target%factor*(near%trial%q(i, target%coordinate) - target%place(1))
        else
          f = plan%frame_of(target%link)
          associate (point => near%design%points(:, target%point))
            place(1) = frames(i, 3, f) + frames(i, 1, f)*point(1) - frames(i, 2, f)*point(2)
            place(2) = frames(i, 4, f) + frames(i, 2, f)*point(1) + frames(i, 1, f)*point(2)
            place(3) = point(3)
          end associate
          if (.not. plan%planar%in_xy_plane) place = matmul(plan%planar%axes, place)
          r(:target%components, g) = target%factor*(place(:target%components) + plan%origin(:target%components) &
                                                    - target%place(:target%components))
        end if
      end associate
    end do
  end subroutine find_differences

  !> Know the run of the last design that has a value: the one that was found beside another one, or the one that was recorded.
  subroutine keep_run(space, design, near)
    type(design_space_type), intent(in) :: space           !< the designs
    type(design_type), intent(inout) :: design             !< the design, with its values
    type(neighbouring_run_type), intent(inout) :: near     !< gets the run
    integer :: n

    if (near%is_neighbour) then
      call copy_positions(near%trial, near%known)
      ! corrections of cosines and sines do not add up
      call find_turns(near%design, 1, near%known)
      return
    end if
    n = near%recorded
    near%is_known = n > 1
    if (.not. near%is_known) return
    call place_planar_design(space, (design%x), near%design, design)
    call take_positions(near%design, near%t(:n), near%target(:n), near%q(:, :n), near%run, near%known)
    call sort_positions(sign(1.0_wp, near%t(n) - near%t(1)), near%known)
    call close_positions(near%design, design%drives, near%run, near%known, near%is_known)
    if (near%is_known) call prove_branch(near%design, design%drives, near%run, near%known, near%is_known)
    if (near%is_known) near%trial = near%known
  end subroutine keep_run

  !> The derivatives of the weighted differences from the targets in the known run.
  subroutine find_slopes(plan, targets, design, near, by_x, by_t)
    type(plan_type), intent(in) :: plan                    !< the plan of all designs
    type(target_type), intent(in) :: targets(:)            !< the targets
    type(design_type), intent(in) :: design                !< the design, with its drives and tangents
    type(neighbouring_run_type), intent(inout) :: near     !< with the known run
    real(wp), intent(out) :: by_x(:, :, :)                 !< (rows,P,targets) by the parameters
    real(wp), intent(out) :: by_t(:, :)                    !< (rows,targets) by time [1/s]
    real(wp) :: place(size(targets), 3), of_x(size(targets), 3, size(by_x, 2)), of_t(size(targets), 3), rate
    integer :: g, i, p, last_link, last_point

    call find_coordinate_slopes(near%design, design, near%run, near%known, near%slopes)
    by_x = 0.0_wp
    by_t = 0.0_wp
    last_link = 0
    last_point = 0
    do g = 1, size(targets)
      associate (target => targets(g))
        if (target%coordinate > 0) then
          by_x(1, :, g) = target%factor*near%slopes%by_x(g, target%coordinate, :)
          by_t(1, g) = target%factor*near%slopes%dq(g, target%coordinate)
        else
          if (target%link /= last_link .or. target%point /= last_point) then
            call find_point_slopes(near%design, plan%frame_of(target%link), target%point, near%slopes, place, of_x, of_t)
            if (.not. plan%planar%in_xy_plane) call turn_from_plane(plan%planar%axes, of_x, of_t)
            last_link = target%link
            last_point = target%point
          end if
          do i = 1, target%components
            do p = 1, size(by_x, 2)
              by_x(i, p, g) = target%factor*of_x(g, i, p)
            end do
            by_t(i, g) = target%factor*of_t(g, i)
          end do
        end if
        if (target%timing /= timing_over) cycle
        ! the time at which the driven coordinate has the value changes with the parameters
        rate = near%slopes%dq(g, target%over)
        do p = 1, size(by_x, 2)
          if (abs(rate) > 0.0_wp) by_x(:, p, g) = by_x(:, p, g) - by_t(:, g)*near%slopes%by_x(g, target%over, p)/rate
        end do
      end associate
    end do
  end subroutine find_slopes

  !> Turn derivatives of points from the axes of the plane into those of frame 0.
  pure subroutine turn_from_plane(axes, of_x, of_t)
    real(wp), intent(in) :: axes(3, 3)             !< turns components in the plane's axes into those of frame 0
    real(wp), intent(inout) :: of_x(:, :, :)       !< (targets,3,P) by the parameters
    real(wp), intent(inout) :: of_t(:, :)          !< (targets,3) by time
    integer :: p

    do p = 1, size(of_x, 3)
      of_x(:, :, p) = matmul(of_x(:, :, p), transpose(axes))
    end do
    of_t = matmul(of_t, transpose(axes))
  end subroutine turn_from_plane
end module mech9_neighbouring_run
