!> Random mechanisms of open links and closed chains that stand on each other, for tests of articulated bodies. They are drawn at
!> home, where all coordinates are zero and all links have one system.
module mech9_mixed_structures
  use mech9_kinds, only: wp
  use mech9_pose, only: pose_type
  use mech9_random, only: random_type
  use mech9_model, only: model_type
  use mech9_plan, only: plan_type
  use mech9_sample_mechanisms, only: new_mechanism, add_revolute, add_prismatic, frame
  use mech9_loaded_mechanisms, only: load_everything
  use mech9_random_geometry, only: random_vector, random_unit
  implicit none
  private
  public :: structure_type, add_open_link, add_loop, add_ladder, add_spatial_loop, random_structure, finished, below, exchange_some

  !> A mechanism under construction.
  type :: structure_type
    logical :: planar = .true.              !< all pairs turn about, or slide across, z
    integer :: n_links = 1                  !< number of links so far
    integer, allocatable :: links(:, :)     !< (2,m) reference and moving link of each pair
    integer, allocatable :: independent(:)  !< independent coordinates
    integer, allocatable :: light(:)        !< links without mass
    logical, allocatable :: slides(:)       !< (m) prismatic pairs; the others are revolute
    real(wp), allocatable :: points(:, :)   !< (3,m) a point of each axis [m]
    real(wp), allocatable :: axes(:, :)     !< (3,m) direction of each axis
  end type structure_type

contains

  !> An open link on a link; one of three slides.
  subroutine add_open_link(random, on, structure)
    type(random_type), intent(inout) :: random           !< source of the random numbers
    integer, intent(in) :: on                            !< number of the link that carries it
    type(structure_type), intent(inout) :: structure     !< the mechanism
    real(wp) :: axis(3)
    logical :: slides

    slides = below(random, 3) == 0 .and. structure%n_links > 1
    axis = random_unit(random)
    if (structure%planar) axis = [0.0_wp, 0.0_wp, 1.0_wp]
    if (structure%planar .and. slides) axis = [random%symmetric(), 1.0_wp, 0.0_wp]
    structure%n_links = structure%n_links + 1
    call add_pair(random, on, structure%n_links, slides, random_vector(random), axis, .true., structure)
  end subroutine add_open_link

  !> A plane chain of links between two links that are one or neighbours: a loop of n pairs with parallel axes, in a plane of its
  !> own unless the mechanism is planar. All but three coordinates are independent.
  subroutine add_loop(random, from, to, n, structure)
    type(random_type), intent(inout) :: random         !< source of the random numbers
    integer, intent(in) :: from                        !< number of the link on which it begins
    integer, intent(in) :: to                          !< number of the link on which it ends
    integer, intent(in) :: n                           !< number of pairs
    type(structure_type), intent(inout) :: structure   !< the mechanism
    real(wp) :: e(3, 3), origin(3), angle
    integer :: i, first

    e = axes_of(structure, random)
    origin = random_vector(random)
    first = structure%n_links
    do i = 1, n
      angle = 6.28_wp*(i - 1)/n + 0.25_wp*random%symmetric()
      call add_pair(random, merge(from, first + i - 1, i == 1), merge(to, first + i, i == n), .false., &
                    origin + cos(angle)*e(:, 1) + sin(angle)*e(:, 2), e(:, 3), i <= n - 3, structure)
    end do
    structure%n_links = first + n - 1
    if (below(random, 3) == 0) structure%light = [structure%light, first + 2]
  end subroutine add_loop

  !> Windows side by side on a link, neighbours with a common upright: one degree of freedom.
  subroutine add_ladder(random, on, n, structure)
    type(random_type), intent(inout) :: random         !< source of the random numbers
    integer, intent(in) :: on                          !< number of the link that carries it
    integer, intent(in) :: n                           !< number of windows
    type(structure_type), intent(inout) :: structure   !< the mechanism
    real(wp) :: e(3, 3), origin(3), foot(3), top(3), next_foot(3), next_top(3)
    integer :: i, upright

    e = axes_of(structure, random)
    origin = random_vector(random)
    foot = origin
    top = origin + e(:, 2)
    upright = structure%n_links + 1
    structure%n_links = upright
    call add_pair(random, on, upright, .false., foot, e(:, 3), .true., structure)
    do i = 1, n
      next_foot = origin + (i + 0.1_wp*random%symmetric())*e(:, 1) + 0.1_wp*random%symmetric()*e(:, 2)
      next_top = origin + (i + 0.1_wp*random%symmetric())*e(:, 1) + (1.0_wp + 0.1_wp*random%symmetric())*e(:, 2)
      call add_pair(random, upright, structure%n_links + 2, .false., top, e(:, 3), .false., structure)
      call add_pair(random, on, structure%n_links + 1, .false., next_foot, e(:, 3), .false., structure)
      call add_pair(random, structure%n_links + 1, structure%n_links + 2, .false., next_top, e(:, 3), .false., structure)
      upright = structure%n_links + 1
      top = next_top
      structure%n_links = structure%n_links + 2
    end do
  end subroutine add_ladder

  !> A spatial loop of n revolute pairs on a link; all but six coordinates are independent.
  subroutine add_spatial_loop(random, on, n, structure)
    type(random_type), intent(inout) :: random         !< source of the random numbers
    integer, intent(in) :: on                          !< number of the link that carries it
    integer, intent(in) :: n                           !< number of pairs
    type(structure_type), intent(inout) :: structure   !< the mechanism
    integer :: i, first

    first = structure%n_links
    do i = 1, n
      call add_pair(random, merge(on, first + i - 1, i == 1), merge(on, first + i, i == n), .false., random_vector(random), &
                    random_unit(random), i <= n - 6, structure)
    end do
    structure%n_links = first + n - 1
  end subroutine add_spatial_loop

  !> Pieces of all kinds, each on a random link of the earlier ones.
  subroutine random_structure(random, planar, pieces, structure)
    type(random_type), intent(inout) :: random         !< source of the random numbers
    logical, intent(in) :: planar                      !< all in one plane
    integer, intent(in) :: pieces                      !< number of pieces
    type(structure_type), intent(out) :: structure     !< the mechanism
    integer :: i, on, on_loop

    call begin(planar, structure)
    do i = 1, pieces
      on = 1 + below(random, structure%n_links)
      select case (below(random, merge(6, 7, planar)))
      case (0, 1)
        call add_open_link(random, on, structure)
      case (2)
        call add_loop(random, on, on, 4, structure)
      case (3)
        call add_loop(random, on, on, 5, structure)
      case (4)
        call add_ladder(random, on, 2, structure)
      case (5)
        ! a second loop between two links of the first
        on_loop = structure%n_links + 2
        call add_loop(random, on, on, 5, structure)
        if (planar) call add_loop(random, on_loop, on_loop + 1, 4, structure)
      case default
        call add_spatial_loop(random, on, 7 + below(random, 2), structure)
      end select
    end do
  end subroutine random_structure

  !> An empty structure.
  subroutine begin(planar, structure)
    logical, intent(in) :: planar                    !< all in one plane
    type(structure_type), intent(out) :: structure   !< link 1 alone

    structure%planar = planar
    allocate (structure%links(2, 0), structure%independent(0), structure%light(0), structure%slides(0))
    allocate (structure%points(3, 0), structure%axes(3, 0))
  end subroutine begin

  !> The mechanism with all its pairs, bodies and loads.
  subroutine finished(random, structure, model)
    type(random_type), intent(inout) :: random         !< source of the random numbers
    type(structure_type), intent(in) :: structure      !< the mechanism under construction
    type(model_type), intent(out) :: model             !< the mechanism with its problem
    type(pose_type) :: at
    integer :: k, i

    call new_mechanism(structure%n_links, structure%links, structure%independent, model)
    do k = 1, size(structure%slides)
      at = frame(structure%points(:, k), structure%axes(:, k))
      if (structure%slides(k)) then
        call add_prismatic(model, k, structure%links(1, k), structure%links(2, k), at, at)
      else
        call add_revolute(model, k, structure%links(1, k), structure%links(2, k), at, at)
      end if
    end do
    call load_everything(random, model)
    do i = 1, size(model%mechanism%bodies)
      if (.not. any(structure%light == model%mechanism%bodies(i)%link)) cycle
      model%mechanism%bodies(i)%mass = 0.0_wp
      model%mechanism%bodies(i)%inertia = 0.0_wp
    end do
  end subroutine finished

  !> Add one pair, either way round.
  subroutine add_pair(random, reference, moving, slides, point, axis, is_independent, structure)
    type(random_type), intent(inout) :: random         !< source of the random numbers
    integer, intent(in) :: reference                   !< number of one link
    integer, intent(in) :: moving                      !< number of the other link
    logical, intent(in) :: slides                      !< a prismatic pair
    real(wp), intent(in) :: point(3)                   !< of the axis at home [m]
    real(wp), intent(in) :: axis(3)                    !< direction at home
    logical, intent(in) :: is_independent              !< its coordinate is independent
    type(structure_type), intent(inout) :: structure   !< the mechanism
    integer :: m, pair(2)
    real(wp) :: place(3)

    m = size(structure%slides) + 1
    pair = [reference, moving]
    if (below(random, 2) == 0) pair = [moving, reference]
    place = point
    if (structure%planar) place(3) = 0.0_wp
    structure%links = reshape([structure%links, pair], [2, m])
    structure%slides = [structure%slides, slides]
    structure%points = reshape([structure%points, place], [3, m])
    structure%axes = reshape([structure%axes, axis], [3, m])
    if (is_independent) structure%independent = [structure%independent, m]
  end subroutine add_pair

  !> Axes for a plane chain, the third one across the plane.
  function axes_of(structure, random) result(e)
    type(structure_type), intent(in) :: structure   !< the mechanism
    type(random_type), intent(inout) :: random      !< source of the random numbers
    real(wp) :: e(3, 3)
    type(pose_type) :: at

    at = frame([0.0_wp, 0.0_wp, 0.0_wp], random_unit(random))
    e = at%r
    if (structure%planar) e = reshape([1, 0, 0, 0, 1, 0, 0, 0, 1], [3, 3])
  end function axes_of

  !> A whole number from 0 to n - 1.
  integer function below(random, n)
    type(random_type), intent(inout) :: random   !< source of the random numbers
    integer, intent(in) :: n                     !< greater than the greatest number

    below = min(n - 1, int(0.5_wp*n*(1.0_wp + random%symmetric())))
  end function below

  !> The independent coordinates of a plan, where some blocks exchange the first one of their loops for an unknown of their own.
  subroutine exchange_some(random, plan, independent)
    type(random_type), intent(inout) :: random   !< source of the random numbers
    type(plan_type), intent(in) :: plan          !< the plan
    logical, intent(out) :: independent(:)       !< (M) the other choice
    integer :: b, i, k

    independent = .false.
    independent(plan%independent) = .true.
    do b = 1, size(plan%blocks)
      if (size(plan%blocks(b)%unknowns) == 0) cycle
      if (below(random, 2) == 0) cycle
      associate (steps => plan%closures(plan%blocks(b)%first_closure)%loop%steps)
        do i = 1, size(steps)
          k = plan%steps(steps(i))%coordinate
          if (.not. independent(k)) cycle
          independent(k) = .false.
          independent(plan%blocks(b)%coordinates(1 + below(random, size(plan%blocks(b)%coordinates)))) = .true.
          exit
        end do
      end associate
    end do
  end subroutine exchange_some
end module mech9_mixed_structures
