!> The positions of a run of a planar design, all closed together from coordinates near by: those of the run of a design beside it.
!>
!> Whether they lie on one branch is another question, see mech9_planar_branch.
module mech9_planar_run
  use mech9_kinds, only: wp
  use mech9_error, only: error_type
  use mech9_tolerances, only: last_correction
  use mech9_cofactors, only: invert_several
  use mech9_sine_cosine, only: cosines_and_sines
  use mech9_law, only: drive_slot_type
  use mech9_plan, only: plan_type
  use mech9_planar_numbers, only: planar_design_type
  use mech9_planar_loop, only: planar_loop_type, turn_on, place_frames, find_residual, find_column, multiply
  implicit none
  private
  public :: planar_run_type, planar_positions_type, new_planar_run, take_positions, find_turns, sort_positions, close_positions

  !> Positions of a run in the order of time.
  type :: planar_positions_type
    integer :: n = 0                           !< number of positions
    integer, allocatable :: target(:)          !< (room) the target that belongs to each; 0: none
    real(wp), allocatable :: t(:)              !< (room) their times [s]
    real(wp), allocatable :: q(:, :)           !< (room,M) coordinates [rad, m]
    real(wp), allocatable :: dq(:, :)          !< (room,M) their rates [rad/s, m/s]
    real(wp), allocatable :: angle(:, :)       !< (room,M) angle by which each step turns [rad]
    real(wp), allocatable :: turn(:, :, :)     !< (room,2,M) its cosine and sine
  end type planar_positions_type

  !> The parts of a plan that the run of a planar design needs, and scratch.
  type :: planar_run_type
    logical :: used = .false.                        !< the plan has only chains of this kind
    integer :: room = 0                              !< room for so many positions
    integer :: m = 0                                 !< number of steps
    real(wp) :: per_length = 1.0_wp                  !< one over the mechanism's size [1/m]
    real(wp), allocatable :: unit_of(:)              !< (M) units of the coordinates
    integer, allocatable :: driven(:)                !< steps of the driven coordinates
    type(planar_loop_type), allocatable :: loops(:)  !< one for each block
    real(wp), allocatable :: frames(:, :, :)         !< (room,6,0:M) the frames, see mech9_planar_loop
    real(wp), allocatable :: jacobian(:, :, :, :)    !< (room,3,3,loops) by the unknowns, each in its unit
    real(wp), allocatable :: inverse(:, :, :, :)     !< (room,3,3,loops) their inverses
    real(wp), allocatable :: pivot(:, :)             !< (room,loops) their least pivots
    real(wp), allocatable :: r(:, :), change(:, :), column(:, :), angle(:), work(:)   !< (room[,3]) scratch
    logical, allocatable :: splits(:)                !< (room) another position is needed after this one
  end type planar_run_type

  !> Largest change of an angle that a correction may make [rad].
  real(wp), parameter :: longest_correction = 0.25_wp
  !> After a correction by less than this the inverse of the Jacobian changes by no more than the same part, about.
  real(wp), parameter :: small_correction = 1.0e-5_wp
  !> A correction by less than this is round-off.
  real(wp), parameter :: round_off = 32.0_wp*epsilon(1.0_wp)
  !> Corrections by Newton's method.
  integer, parameter :: most_iterations = 8

contains

  !> Prepare runs of a plan; `used` is false where it has other chains than planar ones of three unknowns that turn, each in a block.
  pure subroutine new_planar_run(plan, drives, run)
    type(plan_type), intent(in) :: plan               !< the plan of all designs
    type(drive_slot_type), intent(in) :: drives(:)    !< the drives
    type(planar_run_type), intent(out) :: run         !< prepared
    integer :: b, i, s

    if (.not. plan%planar%used) return
    run%m = plan%n_coordinates
    run%per_length = 1.0_wp/plan%planar%length
    run%unit_of = plan%unit_of
    run%driven = [(plan%step_of(drives(i)%drive%coordinate), i=1, size(drives))]
    allocate (run%loops(size(plan%blocks)))
    do b = 1, size(plan%blocks)
      associate (block => plan%blocks(b), loop => run%loops(b))
        loop%first_step = block%first_step
        loop%last_step = block%last_step
        if (size(block%unknowns) == 0) cycle
        if (size(block%unknowns) /= 3 .or. block%equations /= 3 .or. block%first_closure /= block%last_closure .or. &
            block%whole_loops) return
        if (.not. all(plan%planar%steps(block%unknowns)%turns)) return
        loop%closure = block%first_closure
        loop%unknowns = block%unknowns
        loop%coordinates = block%coordinates
        loop%units = plan%unit_of(block%coordinates)
        allocate (loop%signs(run%m), source=0.0_wp)
        associate (whole => plan%closures(loop%closure)%loop)
          loop%signs(whole%steps) = whole%signs
          loop%given = pack(whole%steps, [(all(whole%steps(s) /= block%unknowns), s=1, size(whole%steps))])
        end associate
      end associate
    end do
    run%used = .true.
  end subroutine new_planar_run

  !> Make room for positions, and take their times, targets and coordinates, which may be of any order. Cosines and sines are found.
  subroutine take_positions(design, t, targets, q, run, positions)
    type(planar_design_type), intent(in) :: design             !< placed
    real(wp), intent(in) :: t(:)                               !< (n) times [s]
    integer, intent(in) :: targets(:)                          !< (n) their targets; 0: none
    real(wp), intent(in) :: q(:, :)                            !< (M,n) coordinates [rad, m]
    type(planar_run_type), intent(inout) :: run                !< gets room
    type(planar_positions_type), intent(inout) :: positions    !< gets the positions
    integer :: i, n, m

    n = size(t)
    m = run%m
    if (run%room < n + n/2) then
      run%room = 2*n + 16
      if (allocated(run%frames)) deallocate (run%frames, run%jacobian, run%inverse, run%pivot, run%r, run%change, &
                                           run%column, run%angle, run%work, run%splits)
      associate (room => run%room, loops => size(run%loops))
        allocate (run%frames(room, 6, 0:m), run%jacobian(room, 3, 3, loops), run%inverse(room, 3, 3, loops), &
                  run%pivot(room, loops), run%r(room, 3), run%change(room, 3), run%column(room, 3), run%angle(room), &
                  run%work(room), source=0.0_wp)
        allocate (run%splits(room), source=.false.)
      end associate
      run%frames(:, 1, 0) = 1.0_wp
    end if
    if (allocated(positions%t)) then
      if (size(positions%t) /= run%room) deallocate (positions%target, positions%t, positions%q, positions%dq, positions%angle, &
                                                     positions%turn)
    end if
    if (.not. allocated(positions%t)) then
      allocate (positions%target(run%room), source=0)
      allocate (positions%t(run%room), positions%q(run%room, m), positions%dq(run%room, m), positions%angle(run%room, m), &
                positions%turn(run%room, 2, m), source=0.0_wp)
    end if
    positions%n = n
    positions%t(:n) = t
    positions%target(:n) = targets
    do i = 1, n
      positions%q(i, :) = q(:, i)
    end do
    positions%dq = 0.0_wp
    call find_turns(design, 1, positions)
  end subroutine take_positions

  !> Find the angles of all steps, and their cosines and sines, of the positions from `first` on.
  subroutine find_turns(design, first, positions)
    type(planar_design_type), intent(in) :: design             !< placed
    integer, intent(in) :: first                               !< number of the first of these positions
    type(planar_positions_type), intent(inout) :: positions    !< gets the angles
    real(wp) :: turned(2, positions%n - first + 1)
    integer :: s

    do s = 1, size(design%steps)
      associate (step => design%steps(s), n => positions%n)
        if (.not. step%turns) cycle
        positions%angle(first:n, s) = step%turn*positions%q(first:n, step%coordinate) + step%angle
        call cosines_and_sines(n - first + 1, positions%angle(first:n, s), turned)
        positions%turn(first:n, 1, s) = turned(1, :)
        positions%turn(first:n, 2, s) = turned(2, :)
      end associate
    end do
  end subroutine find_turns

  !> Sort positions by their times, in the direction of the run.
  pure subroutine sort_positions(direction, positions)
    real(wp), intent(in) :: direction                          !< +1, or -1 for a run backwards in time
    type(planar_positions_type), intent(inout) :: positions    !< the positions
    integer :: order(positions%n), i, j, moved

    order = [(i, i=1, size(order))]
    do i = 2, size(order)
      moved = order(i)
      j = i - 1
      do while (j > 0)
        if ((positions%t(order(j)) - positions%t(moved))*direction <= 0.0_wp) exit
        order(j + 1) = order(j)
        j = j - 1
      end do
      order(j + 1) = moved
    end do
    if (all(order == [(i, i=1, size(order))])) return
    associate (n => positions%n)
      positions%target(:n) = positions%target(order)
      positions%t(:n) = positions%t(order)
      positions%q(:n, :) = positions%q(order, :)
      positions%dq(:n, :) = positions%dq(order, :)
      positions%angle(:n, :) = positions%angle(order, :)
      positions%turn(:n, :, :) = positions%turn(order, :, :)
    end associate
  end subroutine sort_positions

  !> Close all chains at all positions by Newton's method, and find the rates. `closed` is false where it does not converge, and
  !> where a coordinate would move far.
  subroutine close_positions(design, drives, run, positions, closed)
    type(planar_design_type), intent(in) :: design             !< placed
    type(drive_slot_type), intent(in) :: drives(:)             !< its drives
    type(planar_run_type), intent(inout) :: run                !< gets the frames, and the Jacobians with their inverses
    type(planar_positions_type), intent(inout) :: positions    !< with coordinates near by
    logical, intent(out) :: closed                             !< whether all are closed
    integer :: b

    call move_drives(design, drives, positions, closed)
    do b = 1, size(run%loops)
      if (.not. closed) return
      associate (loop => run%loops(b))
        if (loop%closure == 0) then
          call place_frames(positions%n, design%steps, loop%first_step, loop%last_step, positions%q, positions%turn, run%frames)
        else
          call close_loop(design, loop, b, run, positions, closed)
          if (closed) call find_rates(design, loop, b, run, positions)
        end if
      end associate
    end do
  end subroutine close_positions

  !> Set the driven coordinates, their rates, and the angles of all steps that are not corrected later.
  subroutine move_drives(design, drives, positions, done)
    type(planar_design_type), intent(in) :: design             !< placed
    type(drive_slot_type), intent(in) :: drives(:)             !< its drives
    type(planar_positions_type), intent(inout) :: positions    !< gets the coordinates
    logical, intent(out) :: done                               !< all drives have values, and none of them moves far
    type(error_type), allocatable :: err
    real(wp) :: change(positions%n), ddq
    integer :: i, s

    done = .true.
    do i = 1, size(drives)
      associate (k => drives(i)%drive%coordinate)
        do s = 1, positions%n
          call drives(i)%drive%evaluate(positions%t(s), positions%q(s, k), positions%dq(s, k), ddq, err)
          done = .not. allocated(err)
          if (.not. done) return
        end do
      end associate
    end do
    do s = 1, size(design%steps)
      associate (step => design%steps(s), n => positions%n)
        if (.not. step%turns) cycle
        change = step%turn*positions%q(:n, step%coordinate) + step%angle - positions%angle(:n, s)
        if (.not. any(abs(change) > 0.0_wp)) cycle
        done = all(abs(change) <= longest_correction)
        if (.not. done) return
        positions%angle(:n, s) = positions%angle(:n, s) + change
        call turn_on(n, change, positions%turn(:, 1, s), positions%turn(:, 2, s))
      end associate
    end do
  end subroutine move_drives

  !> Close one chain at all positions.
  subroutine close_loop(design, loop, b, run, positions, closed)
    type(planar_design_type), intent(in) :: design             !< placed
    type(planar_loop_type), intent(in) :: loop                 !< the chain
    integer, intent(in) :: b                                   !< its number
    type(planar_run_type), intent(inout) :: run                !< with the frames of earlier chains; gets those of this one
    type(planar_positions_type), intent(inout) :: positions    !< with coordinates near by
    logical, intent(out) :: closed                             !< whether it is closed at all positions
    real(wp) :: largest, before
    integer :: iteration, j

    associate (n => positions%n, closure => design%closures(loop%closure))
      call place_frames(n, design%steps, loop%first_step, loop%last_step, positions%q, positions%turn, run%frames)
      closed = .false.
      before = longest_correction
      do iteration = 1, most_iterations
        call find_residual(n, run%room, run%m, closure, run%per_length, run%frames, run%r)
        ! after a small correction the inverse serves once more
        if (before > small_correction) call find_inverses(design, loop, b, n, run)
        call multiply(n, run%room, run%inverse(:, :, :, b), run%r, run%change)
        largest = largest_of(n, run%room, run%change)
        ! a singular matrix has the inverse zero
        if (.not. largest <= longest_correction .or. .not. all(run%pivot(:n, b) > 0.0_wp)) return
        do j = 1, 3
          associate (s => loop%unknowns(j))
            call correct(n, loop%units(j), design%steps(s)%turn, run%change(:, j), positions%q(:, loop%coordinates(j)), &
                         positions%angle(:, s), run%angle)
            call turn_on(n, run%angle, positions%turn(:, 1, s), positions%turn(:, 2, s))
          end associate
        end do
        call place_frames(n, design%steps, minval(loop%unknowns), loop%last_step, positions%q, positions%turn, run%frames)
        ! corrections decrease by the same factor, or faster: the next one would be round-off
        closed = largest <= last_correction .and. largest**2 <= round_off*before
        if (closed) exit
        before = largest
      end do
    end associate
  end subroutine close_loop

  !> The Jacobians of a chain, and their inverses.
  subroutine find_inverses(design, loop, b, n, run)
    type(planar_design_type), intent(in) :: design       !< placed
    type(planar_loop_type), intent(in) :: loop           !< the chain
    integer, intent(in) :: b                             !< its number
    integer, intent(in) :: n                             !< number of positions
    type(planar_run_type), intent(inout) :: run          !< with the frames; gets the inverses
    integer :: j

    do j = 1, 3
      associate (s => loop%unknowns(j))
        call find_column(n, run%room, design%steps(s), loop%signs(s)*loop%units(j)*[1.0_wp, run%per_length], run%frames(:, :, s), &
                         run%frames(:, :, design%closures(loop%closure)%base), run%jacobian(:, :, j, b))
      end associate
    end do
    call invert_several(n, run%room, 0.0_wp, run%jacobian(:, :, :, b), run%inverse(:, :, :, b), run%work, run%pivot(:, b))
  end subroutine find_inverses

  !> The largest absolute value of three numbers at all positions.
  pure real(wp) function largest_of(n, lead, numbers)
    integer, intent(in) :: n                    !< number of positions
    integer, intent(in) :: lead                 !< room for so many positions
    real(wp), intent(in) :: numbers(lead, 3)    !< the numbers
    real(wp) :: largest(4)
    integer :: i, j

    ! four maxima, so that several comparisons can be made at once
    largest = 0.0_wp
    do j = 1, 3
      do i = 1, n - 3, 4
        largest = max(largest, abs(numbers(i:i + 3, j)))
      end do
      do i = n - modulo(n, 4) + 1, n
        largest(1) = max(largest(1), abs(numbers(i, j)))
      end do
    end do
    largest_of = maxval(largest)
    ! a number that is not finite is not lost in comparisons
    if (.not. all(abs(numbers(:n, :)) <= largest_of)) largest_of = huge(largest_of)
  end function largest_of

  !> Change a coordinate and the angle of its step.
  pure subroutine correct(n, unit, turn, change, q, angle, by)
    integer, intent(in) :: n               !< number of positions
    real(wp), intent(in) :: unit           !< of the coordinate
    real(wp), intent(in) :: turn           !< angle of the step per unit of the coordinate
    real(wp), intent(in) :: change(n)      !< to be taken away, in the unit
    real(wp), intent(inout) :: q(n)        !< the coordinate [rad]
    real(wp), intent(inout) :: angle(n)    !< the angle [rad]
    real(wp), intent(inout) :: by(n)       !< gets the change of the angle [rad]
    integer :: i

    do i = 1, n
      q(i) = q(i) - unit*change(i)
      by(i) = -turn*unit*change(i)
      angle(i) = angle(i) + by(i)
    end do
  end subroutine correct

  !> The rates by which a chain stays closed.
  subroutine find_rates(design, loop, b, run, positions)
    type(planar_design_type), intent(in) :: design             !< placed
    type(planar_loop_type), intent(in) :: loop                 !< the chain
    integer, intent(in) :: b                                   !< its number
    type(planar_run_type), intent(inout) :: run                !< with frames and inverses
    type(planar_positions_type), intent(inout) :: positions    !< gets the rates
    integer :: i, j, k

    associate (n => positions%n, base => design%closures(loop%closure)%base)
      run%r(:n, :) = 0.0_wp
      do i = 1, size(loop%given)
        associate (s => loop%given(i))
          k = design%steps(s)%coordinate
          call find_column(n, run%room, design%steps(s), loop%signs(s)*[1.0_wp, run%per_length], run%frames(:, :, s), &
                           run%frames(:, :, base), run%column)
          do j = 1, 3
            run%r(:n, j) = run%r(:n, j) + run%column(:n, j)*positions%dq(:n, k)
          end do
        end associate
      end do
      call multiply(n, run%room, run%inverse(:, :, :, b), run%r, run%change)
      do j = 1, 3
        positions%dq(:n, loop%coordinates(j)) = -loop%units(j)*run%change(:n, j)
      end do
    end associate
  end subroutine find_rates
end module mech9_planar_run
