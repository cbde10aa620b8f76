!> Families of mechanisms for the tests of blocks, mobility and assembly, assembled where every coordinate is zero: each pair is
!> an axis that both of its links share there.
module mech9_mechanism_families
  use mech9_kinds, only: wp, pi
  use mech9_random, only: random_type
  use mech9_random_geometry, only: random_vector, random_unit
  use mech9_error, only: error_type
  use mech9_model, only: model_type
  use mech9_plan, only: plan_type
  use mech9_state, only: state_type
  use mech9_planning, only: make_plan
  use mech9_sample_mechanisms, only: new_mechanism, add_revolute, add_prismatic, frame
  implicit none
  private
  public :: axis_type, planar_axes, spatial_axes, spherical_axes, home_mechanism, plan_at_home
  public :: class_three, class_four, double_butterfly, ten_links, crank_row, lazy_tongs, random_links, stewart_platform

  !> An axis in the home position.
  type :: axis_type
    real(wp) :: point(3) = 0.0_wp
    real(wp) :: along(3) = [0.0_wp, 0.0_wp, 1.0_wp]
    logical :: slides = .false.
  end type axis_type

contains

  !> The mechanism with these links and axes of its pairs.
  subroutine home_mechanism(n_links, links, axes, cq, model)
    integer, intent(in) :: n_links                   !< links, the frame included
    integer, intent(in) :: links(:, :)               !< (2,M) reference and moving link of each pair
    integer, intent(in) :: cq(:)                     !< independent coordinates
    type(axis_type), intent(in) :: axes(:)           !< of each pair in the home position
    type(model_type), intent(out) :: model           !< the model
    integer :: k

    call new_mechanism(n_links, links, cq, model)
    do k = 1, size(axes)
      associate (f => frame(axes(k)%point, axes(k)%along))
        if (axes(k)%slides) then
          call add_prismatic(model, k, links(1, k), links(2, k), f, f)
        else
          call add_revolute(model, k, links(1, k), links(2, k), f, f)
        end if
      end associate
    end do
  end subroutine home_mechanism

  !> Whether the mechanism with these links and axes can be planned in its home position.
  subroutine plan_at_home(n_links, links, axes, cq, err)
    integer, intent(in) :: n_links                      !< links, the frame included
    integer, intent(in) :: links(:, :)                  !< (2,M) reference and moving link of each pair
    integer, intent(in) :: cq(:)                        !< independent coordinates
    type(axis_type), intent(in) :: axes(:)              !< of each pair in the home position
    type(error_type), allocatable, intent(out) :: err   !< allocated if it failed
    type(model_type) :: model
    type(plan_type) :: plan
    type(state_type) :: state

    call home_mechanism(n_links, links, axes, cq, model)
    call make_plan(model%mechanism, model%problem%partition, model%problem%initial%position, plan, state, err)
  end subroutine plan_at_home

  !> Pivots at random places of a plane; of every `slide_each` pairs one slides (0: none).
  function planar_axes(n, slide_each, random) result(axes)
    integer, intent(in) :: n                     !< pairs
    integer, intent(in) :: slide_each            !< of so many pairs one slides; 0: none
    type(random_type), intent(inout) :: random   !< source of the random numbers
    type(axis_type) :: axes(n)
    integer :: k

    do k = 1, n
      axes(k)%point = random_vector(random)
      axes(k)%point(3) = 0.0_wp
      if (slide_each == 0) cycle
      if (modulo(k, slide_each) /= 0) cycle
      axes(k)%slides = .true.
      axes(k)%along = random_unit(random)
      axes(k)%along(3) = 0.0_wp
    end do
  end function planar_axes

  !> Any axes in space; of every `slide_each` pairs one slides (0: none).
  function spatial_axes(n, slide_each, random) result(axes)
    integer, intent(in) :: n                     !< pairs
    integer, intent(in) :: slide_each            !< of so many pairs one slides; 0: none
    type(random_type), intent(inout) :: random   !< source of the random numbers
    type(axis_type) :: axes(n)
    integer :: k

    do k = 1, n
      axes(k)%point = random_vector(random)
      axes(k)%along = random_unit(random)
      if (slide_each > 0) axes(k)%slides = modulo(k, slide_each) == 0
    end do
  end function spatial_axes

  !> Revolutes whose axes meet in one point.
  function spherical_axes(n, random) result(axes)
    integer, intent(in) :: n                     !< pairs
    type(random_type), intent(inout) :: random   !< source of the random numbers
    type(axis_type) :: axes(n)
    integer :: k

    axes(1)%point = random_vector(random)
    do k = 1, n
      axes(k)%point = axes(1)%point
      axes(k)%along = random_unit(random)
    end do
  end function spherical_axes

  !> A crank (pair 1) and a group of the third class: a link held by three others.
  pure function class_three() result(links)
    integer, allocatable :: links(:, :)

    links = reshape([1, 2, 2, 4, 4, 3, 3, 5, 5, 1, 3, 6, 6, 1], [2, 7])
  end function class_three

  !> A crank (pair 1) and a group of the fourth class: two links held by a ring of four.
  pure function class_four() result(links)
    integer, allocatable :: links(:, :)

    links = reshape([1, 2, 2, 3, 3, 5, 5, 4, 4, 6, 6, 3, 4, 1], [2, 7])
  end function class_four

  !> The eight-link double butterfly: links 1 to 4 have three pairs each, and no loop has less than
  !> five links.
  pure function double_butterfly() result(links)
    integer, allocatable :: links(:, :)

    links = reshape([1, 2, 3, 4, 1, 5, 5, 3, 1, 6, 6, 4, 2, 7, 7, 3, 2, 8, 8, 4], [2, 10])
  end function double_butterfly

  !> Ten links, thirteen pairs: links 1, 2, 3 each joined with 4, 5, 6, some of them through another link.
  pure function ten_links() result(links)
    integer, allocatable :: links(:, :)

    links = reshape([1, 4, 2, 5, 3, 6, 1, 5, 2, 6, 1, 7, 7, 6, 2, 8, 8, 4, 3, 9, 9, 4, 3, 10, 10, 5], [2, 13])
  end function ten_links

  !> n four-bars in a row on the frame, each the crank of the next: crank pairs 1, 4, 7, ...
  pure function crank_row(n) result(links)
    integer, intent(in) :: n   !< four-bars
    integer, allocatable :: links(:, :)
    integer :: i

    allocate (links(2, 3*n + 1))
    links(:, 1) = [1, 2]
    do i = 1, n
      links(:, 3*i - 1) = [2*i, 2*i + 1]
      links(:, 3*i) = [2*i + 1, 2*i + 2]
      links(:, 3*i + 1) = [1, 2*i + 2]
    end do
  end function crank_row

  !> n four-bars one on top of the other, without the frame between: each coordinate of the first
  !> pair is that of the crossing pair below.
  pure function lazy_tongs(n) result(links)
    integer, intent(in) :: n   !< four-bars
    integer, allocatable :: links(:, :)
    integer :: i

    allocate (links(2, 3*n + 1))
    links(:, 1) = [1, 2]
    do i = 1, n
      links(:, 3*i - 1) = [2*i - 1, 2*i + 1]
      links(:, 3*i) = [2*i, 2*i + 2]
      links(:, 3*i + 1) = [2*i + 1, 2*i + 2]
    end do
  end function lazy_tongs

  !> A tree of links with `extra` pairs more at random places: that many loops.
  function random_links(n, extra, random) result(links)
    integer, intent(in) :: n                     !< links
    integer, intent(in) :: extra                 !< pairs beyond a tree
    type(random_type), intent(inout) :: random   !< source of the random numbers
    integer, allocatable :: links(:, :)
    integer :: k

    allocate (links(2, n - 1 + extra))
    do k = 2, n
      links(:, k - 1) = [any_of(max(1, k - 6), k - 1), k]
    end do
    do k = n, n - 1 + extra
      do
        links(1, k) = any_of(1, n)
        links(2, k) = any_of(max(1, links(1, k) - 12), min(n, links(1, k) + 12))
        if (links(1, k) /= links(2, k)) exit
      end do
    end do

  contains

    integer function any_of(low, high)
      integer, intent(in) :: low    !< least number
      integer, intent(in) :: high   !< greatest number

      any_of = low + min(high - low, int((high - low + 1)*0.5_wp*(1.0_wp + random%symmetric())))
    end function any_of
  end function random_links

  !> A platform (link 2) on six legs, each a universal joint on the frame, a slider, and a spherical joint, by
  !> links in between: 32 links, 36 pairs. The sliders are coordinates 3, 9, 15, ...
  subroutine stewart_platform(model)
    type(model_type), intent(out) :: model       !< the model
    type(axis_type) :: axes(36)
    integer :: links(2, 36), leg, i, k, first
    real(wp) :: low(3), high(3), along(3), across(3), angle

    do leg = 1, 6
      k = 6*(leg - 1)
      first = 5*(leg - 1) + 3
      links(:, k + 1) = [1, first]
      links(:, k + 2) = [first, first + 1]
      links(:, k + 3) = [first + 1, first + 2]
      links(:, k + 4) = [first + 2, first + 3]
      links(:, k + 5) = [first + 3, first + 4]
      links(:, k + 6) = [first + 4, 2]
      angle = 2.0_wp*pi*((leg - 1)/2)/3.0_wp
      low = [cos(angle + 0.2_wp*(-1)**leg), sin(angle + 0.2_wp*(-1)**leg), 0.0_wp]
      angle = angle + (-1)**leg*(pi/3.0_wp - 0.15_wp)
      high = [0.6_wp*cos(angle), 0.6_wp*sin(angle), 0.8_wp + 0.03_wp*leg]
      along = (high - low)/norm2(high - low)
      across = [along(2), -along(1), 0.0_wp]/norm2(along(:2))
      do i = 1, 6
        axes(k + i)%point = merge(low, high, i <= 3)
      end do
      axes(k + 1)%along = across
      axes(k + 2)%along = [across(2)*along(3), -across(1)*along(3), across(1)*along(2) - across(2)*along(1)]
      axes(k + 3)%along = along
      axes(k + 3)%slides = .true.
      axes(k + 4)%along = [1.0_wp, 0.0_wp, 0.0_wp]
      axes(k + 5)%along = [0.0_wp, 1.0_wp, 0.0_wp]
      axes(k + 6)%along = [0.0_wp, 0.0_wp, 1.0_wp]
    end do
    call home_mechanism(32, links, axes, [3, 9, 15, 21, 27, 33], model)
  end subroutine stewart_platform
end module mech9_mechanism_families
