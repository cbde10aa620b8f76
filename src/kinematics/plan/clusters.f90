!> Clusters are the parts of the spanning tree that closed chains hold together.
!>
!> Two steps belong to one cluster where a loop contains both, or where loops with common steps connect them. The steps of a
!> coupling, and those of the path between them, are in one cluster too. A step that is in no loop is a cluster by itself.
!> A cluster is a connected part of the tree and stands on one frame outside it, its base. So clusters form a tree again, and the
!> motion of a cluster relative to its base depends on coordinates of its own only.
module mech9_clusters
  use mech9_plan, only: plan_type
  implicit none
  private
  public :: clusters_type, find_clusters

  !> The clusters of a plan. The number of a cluster is that of its first step, so that each comes after the one it stands on.
  type :: clusters_type
    integer, allocatable :: of_step(:)   !< (M) cluster of each step; 0 for steps of blocks that were left out
    logical, allocatable :: closed(:)    !< (M) the step is in a loop
    integer, allocatable :: base(:)      !< (M) frame on which the cluster of each step stands
  end type clusters_type

contains

  !> The clusters of the blocks of a plan. All closures of a block belong to one cluster.
  pure function find_clusters(plan) result(clusters)
    type(plan_type), intent(in) :: plan   !< the plan of the mechanism
    type(clusters_type) :: clusters
    integer :: leader(plan%n_coordinates), s, b, c

    leader = [(s, s=1, plan%n_coordinates)]
    allocate (clusters%of_step(plan%n_coordinates), clusters%base(plan%n_coordinates), source=0)
    allocate (clusters%closed(plan%n_coordinates), source=.false.)
    do b = 1, size(plan%blocks)
      do c = plan%blocks(b)%first_closure, plan%blocks(b)%last_closure
        associate (steps => plan%closures(c)%loop%steps)
          if (plan%closures(c)%coupling > 0) then
            do s = 2, size(steps)
              call unite_all([steps(s - 1), steps(s), steps_between(plan, steps(s - 1), steps(s))], leader)
            end do
          else
            call unite_all(steps, leader)
          end if
          clusters%closed(steps) = .true.
          if (c == plan%blocks(b)%first_closure .or. size(steps) == 0) cycle
          ! loops of one block without a common step are joined through the steps between their bases
          associate (others => plan%closures(c - 1)%loop%steps)
            if (size(others) == 0) cycle
            if (leader_of(leader, steps(1)) == leader_of(leader, others(1))) cycle
            call unite_all([steps(1), others(1), steps_between(plan, steps(1), others(1))], leader)
          end associate
        end associate
      end do
    end do
    do b = 1, size(plan%blocks)
      do s = plan%blocks(b)%first_step, plan%blocks(b)%last_step
        clusters%of_step(s) = leader_of(leader, s)
      end do
    end do
    do s = 1, plan%n_coordinates
      if (clusters%of_step(s) == 0) cycle
      clusters%base(s) = plan%steps(clusters%of_step(s))%parent
      clusters%closed(clusters%of_step(s)) = clusters%closed(clusters%of_step(s)) .or. clusters%closed(s)
    end do
    do s = 1, plan%n_coordinates
      if (clusters%of_step(s) > 0) clusters%closed(s) = clusters%closed(clusters%of_step(s))
    end do
  end function find_clusters

  !> Put steps into one cluster, whose leader is the least of all their leaders.
  pure subroutine unite_all(steps, leader)
    integer, intent(in) :: steps(:)        !< numbers of the steps
    integer, intent(inout) :: leader(:)    !< (M) of each step: a step of the same cluster that leads to the least one
    integer :: i, a, b

    do i = 2, size(steps)
      a = leader_of(leader, steps(i - 1))
      b = leader_of(leader, steps(i))
      leader(max(a, b)) = min(a, b)
      leader(steps(i - 1)) = min(a, b)
      leader(steps(i)) = min(a, b)
    end do
  end subroutine unite_all

  !> The least step of the cluster of a step.
  pure integer function leader_of(leader, step)
    integer, intent(in) :: leader(:)   !< (M) of each step: a step of the same cluster that leads to the least one
    integer, intent(in) :: step        !< number of the step

    leader_of = step
    do while (leader(leader_of) /= leader_of)
      leader_of = leader(leader_of)
    end do
  end function leader_of

  !> The steps on the path between two frames.
  pure function steps_between(plan, one, other) result(steps)
    type(plan_type), intent(in) :: plan   !< the plan of the mechanism
    integer, intent(in) :: one            !< number of a frame
    integer, intent(in) :: other          !< number of another frame
    integer, allocatable :: steps(:)
    integer :: a, b

    allocate (steps(0))
    a = one
    b = other
    do while (a /= b)
      steps = [steps, max(a, b)]
      if (a > b) then
        a = plan%steps(a)%parent
      else
        b = plan%steps(b)%parent
      end if
    end do
  end function steps_between
end module mech9_clusters
