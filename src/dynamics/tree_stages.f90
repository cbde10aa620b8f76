!> The order in which articulated bodies go through a mechanism: runs of open steps, and closed clusters. The steps of a run are
!> all free or all driven.
!>
!> A stage stands on frames of earlier stages only. A sweep inward goes through the stages from the last to the first, a sweep
!> outward from the first to the last.
module mech9_tree_stages
  use mech9_kinds, only: wp
  use mech9_plan, only: plan_type
  use mech9_clusters, only: clusters_type
  use mech9_articulated_bodies, only: rigid_body_type
  implicit none
  private
  public :: stage_type, plane_body_type, find_stages, find_plane

  !> Bodies that move with one frame of a cluster in a plane, in its planar frame.
  type :: plane_body_type
    integer :: frame = 0                !< number of the frame
    real(wp) :: height = 0.0_wp         !< of its origin above that of the plane [m]
    type(rigid_body_type) :: together   !< the bodies
  end type plane_body_type

  !> A run of open steps with successive numbers, each a cluster by itself, or one closed cluster.
  type :: stage_type
    logical :: closed = .false.         !< a closed cluster
    logical :: driven = .false.         !< a run of open steps whose coordinates are driven
    integer :: first_step = 0           !< first step
    integer :: last_step = 0            !< last step of the run, or of the cluster, between whose steps others may lie
    integer :: base = 0                 !< frame on which the cluster stands
    integer, allocatable :: steps(:)    !< steps of the cluster, ascending
    integer, allocatable :: coordinates(:)   !< coordinates of these steps
    integer, allocatable :: places(:)   !< places of the cluster's coordinates among the independent ones, ascending
    integer, allocatable :: held(:)     !< those of them that are driven, as their numbers in `places`
    integer, allocatable :: frames(:)   !< frames of the cluster with bodies or loads, or on which other stages stand
    integer, allocatable :: feet(:)     !< those on which other stages stand
    integer :: plane = 0                !< the plane in which all links of the cluster move; 0 for none
    integer :: place = 0                !< the number of its base in the plane, 0 for the base of the plane
    real(wp) :: height = 0.0_wp         !< of the base's origin above that of the plane [m]
    !> Frames of a cluster in a plane with nothing but bodies. These are not among `frames`.
    type(plane_body_type), allocatable :: flat(:)
  end type stage_type

contains

  !> The stages of a plan.
  pure function find_stages(plan, clusters, place_of, bears) result(stages)
    type(plan_type), intent(in) :: plan             !< the plan of the mechanism
    type(clusters_type), intent(in) :: clusters     !< its clusters
    integer, intent(in) :: place_of(:)              !< (M) place of a coordinate among the independent ones, or 0
    logical, intent(in) :: bears(0:)                !< (0:M) the frame has a body or a load
    type(stage_type), allocatable :: stages(:)
    logical :: is_foot(0:plan%n_coordinates)
    integer :: number(plan%n_coordinates), n, s

    is_foot = .false.
    number = 0
    n = 0
    do s = 1, plan%n_coordinates
      if (clusters%of_step(s) == 0) cycle
      is_foot(clusters%base(s)) = .true.
      if (clusters%of_step(s) /= s) then
        number(s) = number(clusters%of_step(s))
      else if (continues_run(plan, clusters, s)) then
        number(s) = n
      else
        n = n + 1
        number(s) = n
      end if
    end do
    allocate (stages(n))
    do s = plan%n_coordinates, 1, -1
      if (number(s) == 0) cycle
      associate (stage => stages(number(s)))
        if (stage%last_step == 0) stage%last_step = s
        stage%first_step = s
      end associate
    end do
    do n = 1, size(stages)
      if (clusters%closed(stages(n)%first_step)) then
        call list_cluster(plan, number, n, place_of, bears, is_foot, stages(n))
      else
        stages(n)%driven = is_driven(plan, stages(n)%first_step)
      end if
    end do
  end function find_stages

  !> Whether a step has a driven coordinate.
  pure logical function is_driven(plan, s)
    type(plan_type), intent(in) :: plan   !< the plan of the mechanism
    integer, intent(in) :: s              !< number of the step

    is_driven = plan%driven(plan%steps(s)%coordinate)
  end function is_driven

  !> Whether an open step continues the run of the open step before it.
  pure logical function continues_run(plan, clusters, s)
    type(plan_type), intent(in) :: plan           !< the plan of the mechanism
    type(clusters_type), intent(in) :: clusters   !< clusters of the plan
    integer, intent(in) :: s                      !< number of the step, the first of its cluster

    continues_run = s > 1 .and. .not. clusters%closed(s)
    if (continues_run) continues_run = clusters%of_step(s - 1) == s - 1 .and. .not. clusters%closed(s - 1) .and. &
                                       (is_driven(plan, s) .eqv. is_driven(plan, s - 1))
  end function continues_run

  !> The lists of a closed cluster.
  pure subroutine list_cluster(plan, number, n, place_of, bears, is_foot, stage)
    type(plan_type), intent(in) :: plan         !< the plan of the mechanism
    integer, intent(in) :: number(:)            !< (M) stage of each step
    integer, intent(in) :: n                    !< number of the cluster's stage
    integer, intent(in) :: place_of(:)          !< (M) place of a coordinate among the independent ones, or 0
    logical, intent(in) :: bears(0:)            !< (0:M) the frame has a body or a load
    logical, intent(in) :: is_foot(0:)          !< (0:M) another stage stands on the frame
    type(stage_type), intent(inout) :: stage    !< with its first and last step; gets the rest
    integer :: s

    stage%closed = .true.
    stage%base = plan%steps(stage%first_step)%parent
    stage%steps = pack([(s, s=stage%first_step, stage%last_step)], number(stage%first_step:stage%last_step) == n)
    stage%coordinates = plan%steps(stage%steps)%coordinate
    stage%frames = pack(stage%steps, bears(stage%steps) .or. is_foot(stage%steps))
    stage%feet = pack(stage%steps, is_foot(stage%steps))
    stage%places = sorted(place_of(pack(stage%coordinates, .not. plan%steps(stage%steps)%dependent)))
    stage%held = pack([(s, s=1, size(stage%places))], plan%driven(plan%independent(stage%places)))
  end subroutine list_cluster

  !> Find the plane of a closed cluster in a spatial mechanism, if there is one, and the frames that move in the plane only.
  pure subroutine find_plane(plan, loaded, stage)
    type(plan_type), intent(in) :: plan        !< the plan of the mechanism
    logical, intent(in) :: loaded(0:)          !< (0:M) loads depend on the frame
    type(stage_type), intent(inout) :: stage   !< with its lists; gets plane and `flat`
    integer :: i, plane

    associate (planar => plan%planar)
      plane = planar%plane_of(stage%first_step)
      if (plane == 0 .or. any(planar%plane_of(stage%steps) /= plane)) return
      if (stage%base /= planar%planes(plane)%base .and. planar%plane_of(stage%base) /= plane) return
      stage%plane = plane
      stage%place = merge(0, stage%base, stage%base == planar%planes(plane)%base)
      stage%height = planar%height(stage%place)
    end associate
    associate (outer => [(loaded(stage%frames(i)) .or. any(stage%feet == stage%frames(i)), i=1, size(stage%frames))])
      allocate (stage%flat(count(.not. outer)))
      stage%flat%frame = pack(stage%frames, .not. outer)
      stage%frames = pack(stage%frames, outer)
    end associate
    do i = 1, size(stage%flat)
      stage%flat(i)%height = plan%planar%height(stage%flat(i)%frame)
    end do
  end subroutine find_plane

  !> Numbers in ascending order.
  pure function sorted(numbers)
    integer, intent(in) :: numbers(:)   !< a few numbers, in any order
    integer :: sorted(size(numbers))
    integer :: i, j, number

    sorted = numbers
    do i = 2, size(numbers)
      number = sorted(i)
      do j = i - 1, 1, -1
        if (sorted(j) < number) exit
        sorted(j + 1) = sorted(j)
      end do
      sorted(j + 1) = number
    end do
  end function sorted
end module mech9_tree_stages
