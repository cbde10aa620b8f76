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
  use mech9_planar_loop, only: planar_loop_type
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
        call judge_loop(run%loops(b), n, run%room, run%m, positions%t, positions%q, positions%dq, run%jacobian(:, :, :, b), &
                        run%inverse(:, :, :, b), run%pivot(:, b), run%splits)
      end do
    end associate
  end subroutine judge_pairs

  !> Judge the pairs of neighbouring positions of one chain, from plain arrays.
  pure subroutine judge_loop(loop, n, room, m, t, q, dq, jacobian, inverse, pivot, splits)
    type(planar_loop_type), intent(in) :: loop          !< the chain
    integer, intent(in) :: n                            !< number of positions
    integer, intent(in) :: room                         !< room for so many positions
    integer, intent(in) :: m                            !< number of coordinates
    real(wp), intent(in) :: t(room)                     !< times [s]
    real(wp), intent(in) :: q(room, m)                  !< coordinates [rad, m]
    real(wp), intent(in) :: dq(room, m)                 !< their rates [rad/s, m/s]
    real(wp), intent(in) :: jacobian(room, 3, 3)        !< by the unknowns, each in its unit
    real(wp), intent(in) :: inverse(room, 3, 3)         !< their inverses
    real(wp), intent(in) :: pivot(room)                 !< their least pivots
    logical, intent(inout) :: splits(room)              !< set where another position is needed
    real(wp), dimension(room) :: move, correction, rate_change, change
    real(wp) :: h, per_unit, d2, d3, trusted
    integer :: i, j, k

    move = 0.0_wp
    correction = 0.0_wp
    rate_change = 0.0_wp
    change = 0.0_wp
    do j = 1, 3
      k = loop%coordinates(j)
      per_unit = 1.0_wp/loop%units(j)
      do i = 1, n - 1
        h = t(i + 1) - t(i)
        move(i) = max(move(i), per_unit*abs(q(i + 1, k) - q(i, k)))
        rate_change(i) = max(rate_change(i), per_unit*abs(h*(dq(i + 1, k) - dq(i, k))))
        correction(i) = max(correction(i), per_unit*abs(q(i + 1, k) - q(i, k) - 0.5_wp*h*(dq(i + 1, k) + dq(i, k))))
        ! the first row of the Jacobian, of the angle, is constant
        d2 = jacobian(i + 1, 2, j) - jacobian(i, 2, j)
        d3 = jacobian(i + 1, 3, j) - jacobian(i, 3, j)
        change(i) = change(i) + (inverse(i + 1, 1, 2)*d2 + inverse(i + 1, 1, 3)*d3)**2 &
                    + (inverse(i + 1, 2, 2)*d2 + inverse(i + 1, 2, 3)*d3)**2 &
                    + (inverse(i + 1, 3, 2)*d2 + inverse(i + 1, 3, 3)*d3)**2
      end do
    end do
    do i = 1, n - 1
      trusted = trusted_correction*min(pivot(i), pivot(i + 1))
      splits(i) = splits(i) .or. .not. (change(i) <= trusted_change**2 .and. move(i) <= longest_move .and. &
                                        correction(i) <= trusted .and. &
                                        rate_change(i) <= trusted_rate_change*max(move(i), trusted))
    end do
  end subroutine judge_loop

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
