!> The proof that the positions of a planar run lie on one branch.
!>
!> Positions that follow each other in time are judged as the branch stepper judges the ends of a step (mech9_branch_stepping): no matrix
!> between the two Jacobians is singular, no coordinate moves far, rates do not turn back, and the second position is where the rates of
!> both predict it by the trapezoidal rule. The correction of this prediction is measured by the least pivot, which shows how far away
!> other branches are (Kantorovich's theorem, see docs/reference/bibliography.md). Where two positions are too far apart for
!> this, another one is put between them. Where a position is near a singular one, or too many would be needed, the run is in doubt.
module mech9_planar_branch
  use mech9_kinds, only: wp
  use mech9_tolerances, only: longest_drive, longest_move, near_singular, trusted_change, trusted_correction, trusted_rate_change
  use mech9_law, only: drive_slot_type
  use mech9_planar_numbers, only: planar_design_type
  use mech9_planar_run, only: planar_run_type, planar_positions_type, find_turns, sort_positions, close_positions
  implicit none
  private
  public :: prove_branch

  integer, parameter :: most_passes = 6   !< times that positions are put between others
  !> Round-off of the distance that a drive moves.
  real(wp), parameter :: round_off = 1.0e-9_wp
  !> Positions are not put between two whose times differ by less than this part of the run.
  real(wp), parameter :: least_part = 1.0e-6_wp

contains

  !> Prove that closed positions lie on one branch, with more positions between them where this is needed.
  subroutine prove_branch(design, drives, run, positions, proved)
    type(planar_design_type), intent(in) :: design             !< placed
    type(drive_slot_type), intent(in) :: drives(:)             !< its drives
    type(planar_run_type), intent(inout) :: run                !< with the Jacobians of the positions
    type(planar_positions_type), intent(inout) :: positions    !< closed, with rates, in the order of time
    logical, intent(out) :: proved                             !< false: the run is in doubt
    integer :: pass

    do pass = 0, most_passes
      call judge_pairs(design, drives, run, positions, proved)
      if (.not. proved) return
      if (.not. any(run%splits(:positions%n - 1))) return
      call put_between(design, run, positions, proved)
      if (proved) call close_positions(design, drives, run, positions, proved)
      if (.not. proved) return
    end do
    proved = .false.
  end subroutine prove_branch

  !> Judge all pairs of neighbouring positions: `splits` marks where another one is needed.
  subroutine judge_pairs(design, drives, run, positions, regular)
    type(planar_design_type), intent(in) :: design           !< placed
    type(drive_slot_type), intent(in) :: drives(:)           !< its drives
    type(planar_run_type), intent(inout) :: run              !< with the Jacobians of the positions; gets the judgement
    type(planar_positions_type), intent(in) :: positions     !< closed, with rates
    logical, intent(out) :: regular                          !< no position is near a singular one
    real(wp) :: h
    integer :: b, i, k

    regular = .true.
    associate (n => positions%n)
      run%splits(:n) = .false.
      do i = 1, size(drives)
        k = drives(i)%drive%coordinate
        do b = 1, n - 1
          h = positions%t(b + 1) - positions%t(b)
          if (abs(h)*drives(i)%drive%greatest_rate(positions%t(b), h) > longest_drive*run%unit_of(k)*(1.0_wp + round_off)) &
            run%splits(b) = .true.
        end do
      end do
      do b = 1, size(run%loops)
        if (run%loops(b)%closure == 0) cycle
        if (minval(run%pivot(:n, b)) < near_singular*maxval(run%pivot(:n, b))) regular = .false.
        if (.not. regular) return
        call judge_loop(b, positions, run)
      end do
    end associate
  end subroutine judge_pairs

  !> Judge the pairs of neighbouring positions of one chain.
  subroutine judge_loop(b, positions, run)
    integer, intent(in) :: b                                !< number of the chain
    type(planar_positions_type), intent(in) :: positions    !< closed, with rates
    type(planar_run_type), intent(inout) :: run             !< with the Jacobians of the positions; gets the judgement
    real(wp) :: moves(positions%n, 3), change(positions%n), trusted
    integer :: i, j

    moves = 0.0_wp
    change = 0.0_wp
    do j = 1, 3
      associate (loop => run%loops(b), k => run%loops(b)%coordinates(j))
        call find_moves(positions%n, 1.0_wp/loop%units(j), positions%t, positions%q(:, k), positions%dq(:, k), moves)
      end associate
      call add_change(positions%n, run%room, run%jacobian(:, :, j, b), run%inverse(:, :, :, b), change)
    end do
    do i = 1, positions%n - 1
      trusted = trusted_correction*min(run%pivot(i, b), run%pivot(i + 1, b))
      associate (move => moves(i, 1), correction => moves(i, 2), rate_change => moves(i, 3))
        run%splits(i) = run%splits(i) .or. .not. (change(i) <= trusted_change**2 .and. move <= longest_move .and. &
                                                  correction <= trusted .and. &
                                                  rate_change <= trusted_rate_change*max(move, trusted))
      end associate
    end do
  end subroutine judge_loop

  ! The next two procedures take arrays of known shape, so that the compiler computes several positions at once.

  !> Raise the measures of all pairs to those of one coordinate, in its unit: distance, correction of the prediction by the
  !> trapezoidal rule, and change of the rate times the time between.
  pure subroutine find_moves(n, per_unit, t, q, dq, moves)
    integer, intent(in) :: n                    !< number of positions
    real(wp), intent(in) :: per_unit            !< one over the unit of the coordinate
    real(wp), intent(in) :: t(n)                !< times [s]
    real(wp), intent(in) :: q(n)                !< the coordinate [rad, m]
    real(wp), intent(in) :: dq(n)               !< its rates [rad/s, m/s]
    real(wp), intent(inout) :: moves(n, 3)      !< the measures
    real(wp) :: h
    integer :: i

    do i = 1, n - 1
      h = t(i + 1) - t(i)
      moves(i, 1) = max(moves(i, 1), per_unit*abs(q(i + 1) - q(i)))
      moves(i, 2) = max(moves(i, 2), per_unit*abs(q(i + 1) - q(i) - 0.5_wp*h*(dq(i + 1) + dq(i))))
      moves(i, 3) = max(moves(i, 3), per_unit*abs(h*(dq(i + 1) - dq(i))))
    end do
  end subroutine find_moves

  !> Add the squares of the change of one column of the Jacobian, times the inverse at the second position of each pair.
  pure subroutine add_change(n, room, column, inverse, change)
    integer, intent(in) :: n                            !< number of positions
    integer, intent(in) :: room                         !< room for so many positions
    real(wp), intent(in) :: column(room, 3)             !< column of the Jacobians
    real(wp), intent(in) :: inverse(room, 3, 3)         !< inverses of the Jacobians
    real(wp), intent(inout) :: change(n)                !< the sums
    real(wp) :: d2, d3
    integer :: i

    do i = 1, n - 1
      ! the first row of the Jacobian, of the angle, is constant
      d2 = column(i + 1, 2) - column(i, 2)
      d3 = column(i + 1, 3) - column(i, 3)
      change(i) = change(i) + (inverse(i + 1, 1, 2)*d2 + inverse(i + 1, 1, 3)*d3)**2 &
                  + (inverse(i + 1, 2, 2)*d2 + inverse(i + 1, 2, 3)*d3)**2 &
                  + (inverse(i + 1, 3, 2)*d2 + inverse(i + 1, 3, 3)*d3)**2
    end do
  end subroutine add_change

  !> Put positions between others, where the cubic through both and their rates leads.
  subroutine put_between(design, run, positions, done)
    type(planar_design_type), intent(in) :: design             !< placed
    type(planar_run_type), intent(in) :: run                   !< with the judgement
    type(planar_positions_type), intent(inout) :: positions    !< gets more positions
    logical, intent(out) :: done                               !< there is room, and the positions are not too near to each other
    real(wp) :: h, whole
    integer :: i, n

    n = positions%n
    whole = positions%t(n) - positions%t(1)
    done = n + count(run%splits(:n - 1)) <= run%room
    if (.not. done) return
    do i = 1, n - 1
      if (.not. run%splits(i)) cycle
      h = positions%t(i + 1) - positions%t(i)
      done = abs(h) > least_part*abs(whole)
      if (.not. done) return
      positions%n = positions%n + 1
      associate (new => positions%n)
        positions%target(new) = 0
        positions%t(new) = positions%t(i) + 0.5_wp*h
        positions%q(new, :) = 0.5_wp*(positions%q(i, :) + positions%q(i + 1, :)) &
                              + 0.125_wp*h*(positions%dq(i, :) - positions%dq(i + 1, :))
      end associate
    end do
    call find_turns(design, n + 1, positions)
    call sort_positions(sign(1.0_wp, whole), positions)
  end subroutine put_between
end module mech9_planar_branch
