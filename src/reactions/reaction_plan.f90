!> The plan of inverse dynamics: everything about pairs, links and clusters that the wrenches of the pairs need and that does not
!> change with the motion.
!>
!> The *wrench* of a pair is the force and the moment that its reference link passes to its moving link, about the origin of the
!> pair's frame in the moving link. A cluster (mech9_clusters) that closed chains hold together is solved as a whole; links
!> outside are taken one after the other, from the ends of open chains inwards.
module mech9_reaction_plan
  use mech9_kinds, only: wp
  use mech9_tolerances, only: negligible_distance, planar_round_off
  use mech9_pose, only: inverse, pose_type, transformed
  use mech9_inertia, only: inertia_in_axes
  use mech9_pair, only: pair_type, screw_factors_type
  use mech9_mechanism, only: mechanism_type
  use mech9_planar_motion, only: to_plane
  use mech9_planar_articulated, only: planar_body_type, planar_body
  use mech9_clusters, only: clusters_type, find_clusters
  use mech9_plan, only: plan_type
  implicit none
  private
  public :: reaction_plan_type, joined_pair_type, joined_cluster_type, make_reaction_plan, is_made_for

  !> One pair, as inverse dynamics sees it.
  type :: joined_pair_type
    integer :: step = 0                 !< step of the plan
    integer :: links(2) = 0             !< moving link, reference link
    real(wp) :: direction = 1.0_wp      !< 1 if the step leads to the moving link, else -1
    logical :: dependent = .true.       !< its coordinate is dependent: no drive holds it
    !> Number of pairs in its joint with several freedoms, which pass on one wrench and count once for the least norm together; 1 for
    !> other pairs.
    integer :: in_joint = 1
    integer :: last = 0                 !< coordinate of the last pair of the joint, about whose point the wrench counts; else its own
    type(pose_type) :: frame            !< pose of the pair's frame in the moving link; its z is the axis
  end type joined_pair_type

  !> A cluster of closed chains.
  type :: joined_cluster_type
    integer, allocatable :: pairs(:)     !< coordinates of its pairs
    integer, allocatable :: links(:)     !< its links but the one on which it stands
    integer, allocatable :: nodes(:, :)  !< (2,pairs) place of moving and reference link among these; 0: the one on which it stands
    integer, allocatable :: blocks(:)    !< blocks of its closures, in the order of execution
    !> Equilibrium alone determines the wrenches of all pairs, in planar mechanisms those in the plane: there are as many equations
    !> of closed chains as loops can have, and all are independent.
    logical :: determined = .false.
    logical :: coupled = .false.         !< some of its closures are couplings
  end type joined_cluster_type

  !> The plan of inverse dynamics.
  type :: reaction_plan_type
    type(joined_pair_type), allocatable :: pairs(:)        !< (M)
    type(joined_cluster_type), allocatable :: clusters(:)  !< of closed chains
    integer, allocatable :: inwards(:)    !< steps that reach a link first, from the ends of chains towards link 1
    logical, allocatable :: alone(:)      !< (M) the step is in no cluster of closed chains
    logical, allocatable :: begins(:)     !< (M) the step leads from the link on which its cluster stands
    integer, allocatable :: bodies(:)     !< numbers of the bodies that move and have inertia
    integer, allocatable :: acting(:)     !< numbers of the loads that may move something
    integer, allocatable :: loaded(:)     !< links on which loads act or depend, without link 1
    real(wp) :: length = 1.0_wp           !< by which moments are divided to count beside forces [m]
    !> The mechanism is planar with its pairs at one height, inertia and weight act in this plane, and all clusters are determined.
    logical :: flat = .false.
    real(wp) :: height = 0.0_wp           !< of the pairs above frame 0, in a flat mechanism [m]
    real(wp) :: gravity(2) = 0.0_wp       !< acceleration of free fall in the plane's axes [m/s^2]
    type(planar_body_type), allocatable :: flat_bodies(:)   !< the moving bodies in the plane
  end type reaction_plan_type

contains

  !> Make the plan of inverse dynamics. All blocks of the mechanism must be in `plan`.
  subroutine make_reaction_plan(mechanism, plan, reactions)
    type(mechanism_type), intent(in) :: mechanism         !< the mechanism
    type(plan_type), intent(in) :: plan                   !< its plan
    type(reaction_plan_type), intent(out) :: reactions    !< the plan of inverse dynamics
    type(clusters_type) :: clusters
    logical :: loaded(plan%n_links)
    integer :: i, s

    allocate (reactions%pairs(plan%n_coordinates))
    do i = 1, plan%n_coordinates
      reactions%pairs(i) = joined_pair(mechanism%pairs(i)%pair, plan, i)
    end do
    if (allocated(mechanism%structure%joints)) then
      do i = 1, size(mechanism%structure%joints)
        associate (joint => mechanism%structure%joints(i))
          reactions%pairs(joint%coordinates())%in_joint = joint%freedoms
          reactions%pairs(joint%coordinates())%last = joint%numbers(joint%freedoms)
        end associate
      end do
    end if
    clusters = find_clusters(plan)
    reactions%alone = .not. clusters%closed
    reactions%begins = plan%steps%parent == clusters%base
    reactions%inwards = pack([(s, s=plan%n_coordinates, 1, -1)], &
                             [(plan%frame_of(plan%steps(s)%link) == s, s=plan%n_coordinates, 1, -1)])
    call join_clusters(plan, clusters, reactions)
    reactions%length = weighing_length(mechanism, plan)
    reactions%bodies = pack([(i, i=1, size(mechanism%bodies))], mechanism%bodies%link /= 1)
    reactions%acting = mechanism%acting_loads()
    loaded = .false.
    call mechanism%mark_loaded_links(loaded)
    reactions%loaded = pack([(i, i=2, plan%n_links)], loaded(2:))
    allocate (reactions%flat_bodies(0))
    if (plan%planar%used .and. all(reactions%clusters%determined)) call lay_flat(mechanism, plan, reactions)
  end subroutine make_reaction_plan

  !> Whether a plan of inverse dynamics was made for a plan with the same independent coordinates and the same order of steps.
  pure logical function is_made_for(reactions, plan)
    type(reaction_plan_type), intent(in) :: reactions     !< the plan of inverse dynamics, perhaps not made yet
    type(plan_type), intent(in) :: plan                   !< the plan of the mechanism
    integer :: k

    is_made_for = allocated(reactions%pairs)
    if (.not. is_made_for) return
    do k = 1, size(reactions%pairs)
      associate (pair => reactions%pairs(k))
        is_made_for = is_made_for .and. plan%steps(pair%step)%coordinate == k &
                      .and. (plan%steps(pair%step)%dependent .eqv. pair%dependent)
      end associate
    end do
  end function is_made_for

  !> Whether inertia and weight act in the plane of a planar mechanism, and its bodies there.
  subroutine lay_flat(mechanism, plan, reactions)
    type(mechanism_type), intent(in) :: mechanism          !< the mechanism
    type(plan_type), intent(in) :: plan                    !< its plan
    type(reaction_plan_type), intent(inout) :: reactions   !< with length and bodies; gets those in the plane
    real(wp) :: centre(3), inertia(3, 3), gravity(3), across
    integer :: i

    gravity = to_plane(plan%planar, mechanism%gravity)
    reactions%gravity = gravity(1:2)
    reactions%height = plan%planar%height(1)
    reactions%flat = abs(gravity(3)) <= planar_round_off*norm2(gravity) .and. &
                     all(abs(plan%planar%height(1:) - reactions%height) <= planar_round_off*reactions%length)
    do i = 1, size(reactions%bodies)
      associate (body => mechanism%bodies(reactions%bodies(i)))
        centre = transformed(plan%planar%link_in_frame(body%link), body%centre)
        inertia = inertia_in_axes(plan%planar%link_in_frame(body%link)%r, body%inertia)
        across = max(abs(inertia(1, 3)), abs(inertia(2, 3)))
        if (body%mass > 0.0_wp) &
          across = max(across, body%mass*reactions%length*abs(centre(3) - reactions%height))
        reactions%flat = reactions%flat .and. &
                         across <= planar_round_off*(body%mass*reactions%length**2 + inertia(1, 1) + inertia(2, 2) + inertia(3, 3))
        reactions%flat_bodies = [reactions%flat_bodies, planar_body(plan, body)]
      end associate
    end do
  end subroutine lay_flat

  !> A pair as inverse dynamics sees it.
  function joined_pair(pair, plan, coordinate) result(joined)
    class(pair_type), intent(in) :: pair    !< the pair
    type(plan_type), intent(in) :: plan     !< the plan of the mechanism
    integer, intent(in) :: coordinate       !< number of its coordinate
    type(joined_pair_type) :: joined
    type(screw_factors_type) :: factors
    logical :: is_screw

    joined%step = plan%step_of(coordinate)
    joined%last = coordinate
    joined%links = [pair%moving, pair%reference]
    joined%direction = merge(-1.0_wp, 1.0_wp, plan%steps(joined%step)%reversed)
    joined%dependent = plan%steps(joined%step)%dependent
    call pair%as_screw(factors, is_screw)
    joined%frame = inverse(factors%after)
  end function joined_pair

  !> The length by which moments are divided: the largest distance between the points of two pairs on one link or, if that is zero,
  !> of a point from the origin of its link, or 1 m. It does not depend on axes, as the size by which the plan weighs does.
  pure real(wp) function weighing_length(mechanism, plan) result(length)
    type(mechanism_type), intent(in) :: mechanism   !< the mechanism
    type(plan_type), intent(in) :: plan             !< its plan
    type(screw_factors_type) :: factors
    type(pose_type) :: in_moving
    real(wp) :: points(3, 2*plan%n_coordinates), reach
    integer :: links(2*plan%n_coordinates), previous(2*plan%n_coordinates), last(plan%n_links), k, i
    logical :: is_screw

    do k = 1, plan%n_coordinates
      associate (pair => mechanism%pairs(k)%pair)
        links(2*k - 1:2*k) = [pair%reference, pair%moving]
        call pair%as_screw(factors, is_screw)
        in_moving = inverse(factors%after)
        points(:, 2*k - 1) = factors%before%p
        points(:, 2*k) = in_moving%p
      end associate
    end do
    length = 0.0_wp
    reach = 0.0_wp
    last = 0
    do k = 1, size(links)
      reach = max(reach, norm2(points(:, k)))
      previous(k) = last(links(k))
      last(links(k)) = k
      i = previous(k)
      do while (i > 0)
        length = max(length, norm2(points(:, k) - points(:, i)))
        i = previous(i)
      end do
    end do
    if (.not. length > negligible_distance*reach) length = reach
    if (.not. length > 0.0_wp) length = 1.0_wp
  end function weighing_length

  !> The clusters of closed chains, with their links and pairs.
  subroutine join_clusters(plan, clusters, reactions)
    type(plan_type), intent(in) :: plan                    !< the plan of the mechanism
    type(clusters_type), intent(in) :: clusters            !< its clusters
    type(reaction_plan_type), intent(inout) :: reactions   !< with its pairs; gets the clusters
    integer :: node(plan%n_links), members(plan%n_coordinates), s, i, n, c, last

    allocate (reactions%clusters(count([(clusters%closed(s) .and. clusters%of_step(s) == s, s=1, plan%n_coordinates)])))
    c = 0
    do s = 1, plan%n_coordinates
      if (.not. clusters%closed(s) .or. clusters%of_step(s) /= s) cycle
      c = c + 1
      n = 0
      last = 0
      node = 0
      do i = s, plan%n_coordinates
        if (clusters%of_step(i) /= s) cycle
        n = n + 1
        members(n) = i
        if (plan%frame_of(plan%steps(i)%link) /= i) cycle
        last = last + 1
        node(plan%steps(i)%link) = last
      end do
      associate (cluster => reactions%clusters(c), steps => members(:n))
        cluster%pairs = plan%steps(steps)%coordinate
        cluster%links = plan%steps(pack(steps, plan%frame_of(plan%steps(steps)%link) == steps))%link
        allocate (cluster%nodes(2, n))
        do i = 1, n
          cluster%nodes(:, i) = node(reactions%pairs(cluster%pairs(i))%links)
        end do
        call join_closures(plan, clusters, steps, reactions, cluster)
      end associate
    end do
  end subroutine join_clusters

  !> The closures of a cluster, and whether they determine its wrenches.
  pure subroutine join_closures(plan, clusters, steps, reactions, cluster)
    type(plan_type), intent(in) :: plan                  !< the plan of the mechanism
    type(clusters_type), intent(in) :: clusters          !< its clusters
    integer, intent(in) :: steps(:)                      !< those of the cluster
    type(reaction_plan_type), intent(in) :: reactions    !< with its pairs
    type(joined_cluster_type), intent(inout) :: cluster  !< with pairs and links; gets the results of closures
    integer :: b, closures, loops
    logical :: regular

    allocate (cluster%blocks(0))
    closures = 0
    regular = .true.
    do b = 1, size(plan%blocks)
      associate (block => plan%blocks(b))
        if (block%last_closure < block%first_closure) cycle
        if (clusters%of_step(plan%closures(block%first_closure)%loop%steps(1)) /= steps(1)) cycle
        cluster%blocks = [cluster%blocks, b]
        regular = regular .and. block%equations == size(block%unknowns)
        cluster%coupled = cluster%coupled .or. any(plan%closures(block%first_closure:block%last_closure)%coupling > 0)
        closures = closures + block%last_closure - block%first_closure + 1
      end associate
    end do
    loops = size(cluster%pairs) - size(cluster%links)
    cluster%determined = regular .and. count(reactions%pairs(cluster%pairs)%dependent) == merge(3, 6, plan%planar%used)*loops &
                         .and. closures == loops
  end subroutine join_closures
end module mech9_reaction_plan
