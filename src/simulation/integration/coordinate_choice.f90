!> The choice of other independent coordinates near a singular position (Wehage and Haug in docs/reference/bibliography.md).
!>
!> QR with column pivoting of the equations of one block after the other finds which of the coordinates on which the block depends,
!> and of its own unknowns, are better determined by the others. The work grows with the number of blocks; a cluster of one block
!> is treated as by QR of all its closures.
module mech9_coordinate_choice
  use mech9_kinds, only: wp
  use mech9_integration_tolerances, only: worthwhile_improvement
  use mech9_error, only: error_type, raise, exit_structure, exit_assembly, exit_singular
  use mech9_integration_failures, only: failure_other_branch
  use mech9_lapack, only: dgeqp3
  use mech9_householder, only: householder
  use mech9_partition, only: partition_type
  use mech9_mechanism, only: mechanism_type
  use mech9_plan, only: plan_type, block_type
  use mech9_clusters, only: clusters_type, find_clusters
  use mech9_state, only: state_type
  use mech9_requested, only: requested_type
  use mech9_block_solver, only: block_work_type
  use mech9_planning, only: planning_settings_type, make_plan
  use mech9_replanning, only: replanning_type, wanted_type, replan
  implicit none
  private
  public :: best_independent, carry_over, worth_taking

  !> From this number of columns on LAPACK is called.
  integer, parameter :: lapack_from = 24

contains

  !> The independent coordinates with the best conditioned dependent ones at a closed position, cluster by cluster. Chains that are
  !> left out stay dependent. Driven coordinates stay as they are, unless drives shall not count: then one that does not become
  !> independent drives its chains into a dead point.
  subroutine best_independent(plan, state, independent, without_drives)
    type(plan_type), intent(in) :: plan      !< the plan of the mechanism
    type(state_type), intent(in) :: state    !< frames in place
    logical, intent(out) :: independent(:)   !< (M)
    logical, intent(in), optional :: without_drives   !< driven coordinates are chosen like free ones; not unless given
    logical :: driven(plan%n_coordinates)
    type(clusters_type) :: clusters
    integer :: place(plan%n_coordinates), last(plan%n_coordinates), i, s
    integer, allocatable :: steps(:)

    independent = .false.
    independent(plan%independent) = .true.
    driven = plan%driven
    if (present(without_drives)) driven = driven .and. .not. without_drives
    clusters = find_clusters(plan)
    do s = 1, plan%n_coordinates
      if (clusters%of_step(s) > 0) last(clusters%of_step(s)) = s
    end do
    place = 0
    do s = 1, plan%n_coordinates
      if (clusters%of_step(s) /= s .or. .not. clusters%closed(s)) cycle
      steps = pack([(i, i=s, last(s))], clusters%of_step(s:last(s)) == s)
      place(steps) = [(i, i=1, size(steps))]
      call choose_in_cluster(plan, state, clusters, steps, place, driven, independent)
    end do
  end subroutine best_independent

  !> The choice in one closed cluster: each of its blocks in turn exchanges coordinates on which it depends for unknowns of its own,
  !> where these serve better. Driven coordinates stay as they are.
  subroutine choose_in_cluster(plan, state, clusters, steps, place, driven, independent)
    type(plan_type), intent(in) :: plan         !< the plan of the mechanism
    type(state_type), intent(in) :: state       !< frames in place
    type(clusters_type), intent(in) :: clusters !< clusters of the plan
    integer, intent(in) :: steps(:)             !< steps of the cluster, ascending
    integer, intent(in) :: place(:)             !< (M) place of a step in `steps`
    logical, intent(in) :: driven(:)            !< (M) the coordinate stays independent
    logical, intent(inout) :: independent(:)    !< (M) gets the choice for the cluster's coordinates
    integer, allocatable :: free(:)
    real(wp), allocatable :: rates(:, :)
    logical :: held(size(steps))
    integer :: b, i

    held = driven(plan%steps(steps)%coordinate)
    free = pack(steps, .not. (plan%steps(steps)%dependent .or. held))
    if (size(free) == 0) return
    allocate (rates(size(steps), size(free)), source=0.0_wp)
    do i = 1, size(free)
      rates(place(free(i)), i) = 1.0_wp
    end do
    do b = block_of(plan, steps(1)), block_of(plan, steps(size(steps)))
      if (size(plan%blocks(b)%unknowns) == 0) cycle
      if (clusters%of_step(plan%blocks(b)%unknowns(1)) /= steps(1)) cycle
      call exchange(plan, state, plan%blocks(b), place, free, rates)
    end do
    independent(plan%steps(steps)%coordinate) = held
    independent(plan%steps(free)%coordinate) = .true.
  end subroutine choose_in_cluster

  !> The block of a step, by bisection: blocks have the steps in ascending order, and some steps may be in none.
  pure integer function block_of(plan, step) result(b)
    type(plan_type), intent(in) :: plan   !< the plan of the mechanism
    integer, intent(in) :: step           !< number of a step that is in a block
    integer :: after, middle

    b = 1
    after = size(plan%blocks) + 1
    do while (after - b > 1)
      middle = (b + after)/2
      if (plan%blocks(middle)%first_step <= step) then
        b = middle
      else
        after = middle
      end if
    end do
  end function block_of

  !> Choose between the free coordinates on which a block depends and its unknowns, by QR with column pivoting of its equations. As
  !> many coordinates as before remain free, and the rates of all coordinates of earlier blocks follow from these.
  subroutine exchange(plan, state, block, place, free, rates)
    type(plan_type), intent(in) :: plan         !< the plan of the mechanism
    type(state_type), intent(in) :: state       !< frames in place
    type(block_type), intent(in) :: block       !< the block
    integer, intent(in) :: place(:)             !< (M) place of a step among those of the cluster
    integer, intent(inout) :: free(:)           !< (k) steps of the free coordinates
    real(wp), intent(inout) :: rates(:, :)      !< (steps of the cluster, k) rates per rate of the free coordinates, in their units
    real(wp) :: a(block%equations, size(free) + size(block%unknowns)), by_free(size(block%unknowns), size(free))
    integer :: pivot(size(a, 2)), candidates(size(a, 2)), i, j, k, n

    k = size(free)
    n = size(block%unknowns)
    candidates = [free, block%unknowns]
    call set_equations(plan, state, block, place, rates, a)
    call factorize_by_pivots(a, pivot)
    call divide(n, a, by_free)
    if (all(pivot(n + 1:) <= k)) then
      do i = 1, n
        do j = 1, k
          rates(place(candidates(pivot(i))), pivot(n + j)) = -by_free(i, j)
        end do
      end do
      return
    end if
    call exchange_rates(pivot, place(candidates), by_free, rates)
    free = candidates(pivot(n + 1:))
  end subroutine exchange

  !> QR with column pivoting: R in the upper triangle of the matrix, and the column of the matrix at each place.
  subroutine factorize_by_pivots(a, pivot)
    real(wp), intent(inout), contiguous :: a(:, :)   !< (m,n) the matrix; its factors afterwards
    integer, intent(out) :: pivot(:)                 !< (n)
    real(wp) :: tau(size(a, 2)), norms(size(a, 2)), work(2*size(a, 2) + (size(a, 2) + 1)*32)
    integer :: sign_of_det, info

    if (size(a, 2) < lapack_from) then
      call householder(size(a, 1), size(a, 2), a, pivot, tau, sign_of_det, norms)
    else
      pivot = 0
      call dgeqp3(size(a, 1), size(a, 2), a, size(a, 1), pivot, tau, work, size(work), info)
    end if
  end subroutine factorize_by_pivots

  !> Rates of all coordinates per rate of the free ones after an exchange.
  pure subroutine exchange_rates(pivot, places, by_free, rates)
    integer, intent(in) :: pivot(:)          !< (n + k) column of each candidate: n unknowns first, then k free coordinates
    integer, intent(in) :: places(:)         !< (k + n) of the candidates: k coordinates that were free, then n unknowns
    real(wp), intent(in) :: by_free(:, :)    !< (n, k) negative rates of the unknowns
    real(wp), intent(inout) :: rates(:, :)   !< (steps of the cluster, k) rates per rate of the free coordinates, in their units
    real(wp) :: old(size(rates, 1), size(rates, 2))
    integer :: i, j, k, n

    n = size(by_free, 1)
    k = size(by_free, 2)
    old = rates
    rates = 0.0_wp
    do i = 1, k
      if (pivot(n + i) <= k) rates(:, i) = old(:, pivot(n + i))
    end do
    do i = 1, n
      if (pivot(i) > k) then
        rates(places(pivot(i)), :) = -by_free(i, :)
      else
        do j = 1, k
          rates(:, j) = rates(:, j) - old(:, pivot(i))*by_free(i, j)
        end do
      end if
    end do
    do i = 1, k
      if (pivot(n + i) > k) rates(places(pivot(n + i)), i) = 1.0_wp
    end do
  end subroutine exchange_rates

  !> The equations of a block: derivatives by the free coordinates, then by its unknowns.
  subroutine set_equations(plan, state, block, place, rates, a)
    type(plan_type), intent(in) :: plan     !< the plan of the mechanism
    type(state_type), intent(in) :: state   !< frames in place
    type(block_type), intent(in) :: block   !< the block
    integer, intent(in) :: place(:)         !< (M) place of a step among those of the cluster
    real(wp), intent(in) :: rates(:, :)     !< (steps of the cluster, k) rates of earlier blocks per rate of the free coordinates
    real(wp), intent(out) :: a(:, :)        !< (equations, free coordinates and unknowns)
    real(wp) :: column(6)
    integer :: c, i, j, k, s, row, rank

    k = size(rates, 2)
    a = 0.0_wp
    row = 0
    do c = block%first_closure, block%last_closure
      rank = plan%closures(c)%rank
      associate (loop => plan%closures(c)%loop)
        do i = 1, size(loop%steps)
          s = loop%steps(i)
          call plan%constraints(c)%item%column(plan, s, loop%signs(i), state, column(:rank))
          j = findloc(block%unknowns, s, dim=1)
          if (j > 0) then
            a(row + 1:row + rank, k + j) = column(:rank)
          else
            do j = 1, k
              a(row + 1:row + rank, j) = a(row + 1:row + rank, j) + column(:rank)*rates(place(s), j)
            end do
          end if
        end do
      end associate
      row = row + rank
    end do
  end subroutine set_equations

  !> R11^-1 R12 from the factors of a matrix with n dependent columns. A row without a pivot beyond round-off stays zero.
  pure subroutine divide(n, a, quotient)
    integer, intent(in) :: n                  !< number of dependent columns
    real(wp), intent(in) :: a(:, :)           !< with R = (R11, R12) in its upper triangle
    real(wp), intent(out) :: quotient(:, :)   !< (n, other columns)
    integer :: i, j

    quotient = 0.0_wp
    do i = min(n, size(a, 1)), 1, -1
      if (abs(a(i, i)) <= 16.0_wp*size(a, 2)*epsilon(1.0_wp)*abs(a(1, 1))) cycle
      quotient(i, :) = a(i, n + 1:)
      do j = i + 1, n
        if (j <= size(a, 1)) quotient(i, :) = quotient(i, :) - a(i, j)*quotient(j, :)
      end do
      quotient(i, :) = quotient(i, :)/a(i, i)
    end do
  end subroutine divide

  !> The plan and the state in other independent coordinates. Blocks that do not change are copied; where that cannot be, the
  !> plan is made from the beginning, and `carried%serves` is false. Fails with exit_singular where these coordinates cannot serve
  !> or the state cannot be carried over, and with the code of the failure where a pair or the program itself fails. There is no
  !> plan where the change is rejected.
  subroutine carry_over(mechanism, partition, plan, state, wanted, carried, err)
    type(mechanism_type), intent(in) :: mechanism        !< the mechanism
    type(partition_type), intent(in) :: partition        !< with the other independent coordinates
    type(plan_type), intent(in) :: plan                  !< the present plan
    type(state_type), intent(in) :: state                !< closed, with rates of all coordinates
    type(wanted_type), intent(in) :: wanted              !< requested quantities, and conditioning that is worth the change
    type(replanning_type), intent(out) :: carried        !< the plan in the other coordinates, and the same motion for it
    type(error_type), allocatable, intent(out) :: err    !< allocated if it failed

    call replan(plan, state, partition, wanted, carried, err)
    if (allocated(err) .or. carried%rejected) return
    if (.not. carried%serves) then
      if (wanted%from_known_only) then
        call raise(err, exit_singular, failure_other_branch)
      else
        call plan_from_beginning(mechanism, partition, plan, state, wanted%requested, carried, err)
      end if
    end if
    if (allocated(err)) return
    carried%state%t = state%t
    carried%state%dq = state%dq
    if (allocated(state%pressed)) carried%state%pressed = state%pressed
    if (allocated(state%stretch)) carried%state%stretch = state%stretch
    if (allocated(state%friction)) then
      carried%state%friction = state%friction
      carried%state%heat = state%heat
    end if
    if (.not. allocated(state%motor)) return
    carried%state%motor = state%motor
    carried%state%motor_rate = state%motor_rate
    carried%state%limited = state%limited
  end subroutine carry_over

  !> The plan and the position in other independent coordinates, made from the beginning.
  subroutine plan_from_beginning(mechanism, partition, plan, state, requested, carried, err)
    type(mechanism_type), intent(in) :: mechanism        !< the mechanism
    type(partition_type), intent(in) :: partition        !< with the other independent coordinates
    type(plan_type), intent(in), target :: plan          !< the present plan
    type(state_type), intent(in) :: state                !< closed
    type(requested_type), intent(in) :: requested        !< requested quantities; blocks that do not serve them are left out
    type(replanning_type), intent(inout) :: carried      !< gets the plan in the other coordinates, and the same position for it
    type(error_type), allocatable, intent(out) :: err    !< allocated if it failed
    type(partition_type) :: ordered
    type(planning_settings_type) :: settings
    integer :: k

    call partition%with_independent(mechanism%structure, partition%independent(), ordered)
    settings%requested = requested
    settings%known => plan
    call make_plan(mechanism, ordered, state%q, carried%plan, carried%state, err, settings)
    if (allocated(err)) then
      if (err%code == exit_structure .or. err%code == exit_assembly) err%code = exit_singular
      return
    end if
    associate (q => carried%state%q, units => carried%plan%unit_of)
      ! chains that were left out so far close anywhere
      k = maxloc(abs(q - state%q)/units, dim=1, mask=requested%coordinates)
      if (abs(q(k) - state%q(k)) <= 1.0e-6_wp*units(k)) return
    end associate
    call raise(err, exit_singular, failure_other_branch)
    err%failure%coordinates = [k]
  end subroutine plan_from_beginning

  !> The conditioning for which other coordinates are worth taking, in the position for which the blocks are factorized.
  function worth_taking(present_conditioning, work) result(wanted)
    real(wp), intent(in) :: present_conditioning      !< pivot ratio of the worst block
    type(block_work_type), intent(inout) :: work(:)   !< scratch of the blocks, with their factors
    type(wanted_type) :: wanted
    integer :: b

    wanted%least = worthwhile_improvement*present_conditioning
    allocate (wanted%conditioning(size(work)))
    do b = 1, size(work)
      wanted%conditioning(b) = work(b)%equations%conditioning()
    end do
  end function worth_taking
end module mech9_coordinate_choice
