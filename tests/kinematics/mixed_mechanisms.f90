!> Mechanisms with planar loops in several planes, joined by hinges across these planes, assembled where every coordinate is zero.
module mech9_mixed_mechanisms
  use mech9_kinds, only: wp
  use mech9_random, only: random_type
  use mech9_random_geometry, only: random_rotation
  use mech9_model, only: model_type
  use mech9_polynomial_law, only: polynomial_law_type
  use mech9_mechanism_families, only: axis_type, planar_axes, spatial_axes, home_mechanism
  implicit none
  private
  public :: mixed_links, mixed_inputs, mixed_axes, mixed_mechanism, mixed_planes, mixed_planar_blocks

  !> Independent coordinates: the hinges that carry a plane, a crank of each planar loop that needs one, and one of the spatial loop.
  integer, parameter :: mixed_inputs(7) = [1, 2, 9, 10, 14, 21, 25]
  !> Number of planes in which the planar loops lie, and of planar blocks: two planes have two blocks each.
  integer, parameter :: mixed_planes = 4, mixed_planar_blocks = 6

contains

  !> Reference and moving link of each pair.
  pure function mixed_links() result(links)
    integer, allocatable :: links(:, :)

    links = reshape([1, 2, & ! a hinge, which carries the first plane
                     2, 3, 3, 4, 4, 5, 5, 2, 4, 6, 6, 7, 7, 2, & ! a four-bar and a dyad in this plane
                     4, 8, & ! a hinge on the coupler, which carries the second plane
                     8, 9, 9, 10, 10, 11, 11, 8, & ! a four-bar in the second plane
                     6, 12, 12, 13, 13, 14, 14, 15, 15, 16, 16, 17, 17, 6, & ! a spatial loop on a link of the first plane
                     1, 18, 18, 19, 19, 20, 20, 1, & ! a four-bar in a third plane, fixed to link 1
                     19, 21, 21, 22, 22, 23, 23, 19, & ! a four-bar in a fourth plane, on the coupler of the third
                     19, 24, 24, 25, 25, 20], [2, 31]) ! a dyad in the third plane
  end function mixed_links

  !> Axes of the pairs in the home position; of every `slide_each` pairs of the planar loops one slides (0: none).
  function mixed_axes(slide_each, random) result(axes)
    integer, intent(in) :: slide_each            !< of so many planar pairs one slides; 0: none
    type(random_type), intent(inout) :: random   !< source of the random numbers
    type(axis_type) :: axes(31)

    axes = spatial_axes(31, 0, random)
    call put_in_plane([2, 3, 4, 5, 6, 7, 8], slide_each, random, axes)
    call put_in_plane([10, 11, 12, 13], slide_each, random, axes)
    call put_in_plane([21, 22, 23, 24, 29, 30, 31], slide_each, random, axes)
    call put_in_plane([25, 26, 27, 28], slide_each, random, axes)
  end function mixed_axes

  !> Put some pairs in one plane, whose direction is random, at different heights above it.
  subroutine put_in_plane(pairs, slide_each, random, axes)
    integer, intent(in) :: pairs(:)                !< numbers of the pairs
    integer, intent(in) :: slide_each              !< of so many pairs one slides; 0: none
    type(random_type), intent(inout) :: random     !< source of the random numbers
    type(axis_type), intent(inout) :: axes(:)      !< of all pairs
    real(wp) :: turn(3, 3)
    integer :: k

    axes(pairs) = planar_axes(size(pairs), slide_each, random)
    turn = random_rotation(random)
    do k = 1, size(pairs)
      axes(pairs(k))%point(3) = random%symmetric()
      axes(pairs(k))%point = matmul(turn, axes(pairs(k))%point)
      axes(pairs(k))%along = matmul(turn, axes(pairs(k))%along)
    end do
  end subroutine put_in_plane

  !> The mechanism with these axes; its independent coordinates are driven from zero at different rates.
  subroutine mixed_mechanism(axes, model)
    type(axis_type), intent(in) :: axes(:)     !< of each pair in the home position
    type(model_type), intent(out) :: model     !< the model
    type(polynomial_law_type) :: polynomial
    integer :: i

    call home_mechanism(25, mixed_links(), axes, mixed_inputs, model)
    deallocate (model%problem%drives)
    allocate (model%problem%drives(size(mixed_inputs)))
    do i = 1, size(mixed_inputs)
      polynomial%coordinate = mixed_inputs(i)
      polynomial%coefficients = [0.0_wp, 0.05_wp*i - 0.2_wp, 0.1_wp]
      allocate (model%problem%drives(i)%drive, source=polynomial)
    end do
  end subroutine mixed_mechanism
end module mech9_mixed_mechanisms
