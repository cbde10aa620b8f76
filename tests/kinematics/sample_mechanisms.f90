!> Mechanisms built in code for the tests of the kinematics floor.
module mech9_sample_mechanisms
  use mech9_kinds, only: wp
  use mech9_pose, only: pose_type, pose_from_axis, default_zero
  use mech9_structure, only: structure_from_pairs
  use mech9_finding, only: finding_type
  use mech9_partition, only: new_partition
  use mech9_screw_pair, only: screw_pair_type, revolute_pair, prismatic_pair
  use mech9_polynomial_law, only: polynomial_law_type
  use mech9_model, only: model_type
  implicit none
  private
  public :: new_mechanism, add_revolute, add_prismatic, drive, frame, fig1, four_bar, general_loop

  real(wp), parameter :: z(3) = [0.0_wp, 0.0_wp, 1.0_wp]

contains

  !> Structure from the links of each pair and the independent coordinates; no geometry yet.
  subroutine new_mechanism(n_links, links, cq, model)
    integer, intent(in) :: n_links                   !< links, the frame included
    integer, intent(in) :: links(:, :)               !< (2,M) reference and moving link of each pair
    integer, intent(in) :: cq(:)                     !< independent coordinates
    type(model_type), intent(out) :: model           !< the model
    type(finding_type), allocatable :: findings(:)
    logical, allocatable :: independent(:)
    integer :: m

    call structure_from_pairs(n_links, links, cq, model%mechanism%structure, independent, findings)
    if (size(findings) > 0) error stop 'a sample mechanism has a bad structure'
    call new_partition(model%mechanism%structure, independent, model%problem%partition)
    m = size(links, 2)
    model%mechanism%title = 'sample'
    allocate (model%mechanism%pairs(m), model%mechanism%points(0), model%mechanism%bodies(0), model%mechanism%loads(0), &
              model%mechanism%motors(0), model%mechanism%stops(0))
    allocate (model%problem%drives(0))
    allocate (model%problem%initial%position(m), model%problem%initial%velocity(m), source=0.0_wp)
    allocate (model%problem%initial%position_given(m), model%problem%initial%velocity_given(m), source=.false.)
    allocate (model%mechanism%parameters(0))
  end subroutine new_mechanism

  !> A frame with its z along an axis through a point.
  function frame(point, axis)
    real(wp), intent(in) :: point(3)   !< on the axis [m]
    real(wp), intent(in) :: axis(3)    !< direction, of any length
    type(pose_type) :: frame
    logical :: ok

    call pose_from_axis(point, axis, default_zero(axis), frame, ok)
  end function frame

  subroutine add_pair(model, k, reference, moving, pair)
    type(model_type), intent(inout) :: model           !< the model
    integer, intent(in) :: k                           !< coordinate of the pair
    integer, intent(in) :: reference                   !< number of its reference link
    integer, intent(in) :: moving                      !< number of its moving link
    type(screw_pair_type), intent(in) :: pair          !< pair that is added

    allocate (model%mechanism%pairs(k)%pair, source=pair)
    model%mechanism%pairs(k)%pair%coordinate = k
    model%mechanism%pairs(k)%pair%reference = reference
    model%mechanism%pairs(k)%pair%moving = moving
  end subroutine add_pair

  subroutine add_revolute(model, k, reference, moving, in_reference, in_moving)
    type(model_type), intent(inout) :: model           !< the model
    integer, intent(in) :: k                           !< coordinate of the pair
    integer, intent(in) :: reference                   !< number of its reference link
    integer, intent(in) :: moving                      !< number of its moving link
    type(pose_type), intent(in) :: in_reference        !< frame of the pair in the reference link
    type(pose_type), intent(in) :: in_moving           !< frame of the pair in the moving link

    call add_pair(model, k, reference, moving, revolute_pair(in_reference, in_moving))
  end subroutine add_revolute

  subroutine add_prismatic(model, k, reference, moving, in_reference, in_moving)
    type(model_type), intent(inout) :: model           !< the model
    integer, intent(in) :: k                           !< coordinate of the pair
    integer, intent(in) :: reference                   !< number of its reference link
    integer, intent(in) :: moving                      !< number of its moving link
    type(pose_type), intent(in) :: in_reference        !< frame of the pair in the reference link
    type(pose_type), intent(in) :: in_moving           !< frame of the pair in the moving link

    call add_pair(model, k, reference, moving, prismatic_pair(in_reference, in_moving))
  end subroutine add_prismatic

  !> Drive a coordinate by c0 + c1 t + ...
  subroutine drive(model, k, coefficients)
    type(model_type), intent(inout) :: model           !< the model
    integer, intent(in) :: k                           !< the coordinate
    real(wp), intent(in) :: coefficients(:)            !< of 1, t, t^2, ...
    type(polynomial_law_type) :: polynomial

    polynomial%coordinate = k
    polynomial%coefficients = coefficients
    deallocate (model%problem%drives)
    allocate (model%problem%drives(1))
    allocate (model%problem%drives(1)%drive, source=polynomial)
  end subroutine drive

  !> The paper's Fig. 1 with dimensions; driven at the coordinate `driven`.
  subroutine fig1(driven, model)
    integer, intent(in) :: driven                    !< number of the driven coordinate
    type(model_type), intent(out) :: model           !< the model
    integer, parameter :: links(2, 7) = reshape([1, 6, 6, 5, 3, 5, 2, 3, 1, 2, 1, 4, 3, 4], [2, 7])
    real(wp), parameter :: at(2, 7) = reshape([-1.0_wp, 2.5_wp, 1.8_wp, 0.0_wp, 1.6_wp, 1.2_wp, 1.0_wp, 0.0_wp, &
                                               0.0_wp, 0.0_wp, 4.0_wp, 0.0_wp, 3.2_wp, 0.0_wp], [2, 7])
    real(wp), parameter :: moving_at(7) = [0.0_wp, 0.0_wp, 2.0_wp, 0.0_wp, 0.0_wp, 0.0_wp, 2.6_wp]
    integer :: k

    call new_mechanism(6, links, [driven], model)
    do k = 1, 7
      call add_revolute(model, k, links(1, k), links(2, k), frame([at(1, k), at(2, k), 0.0_wp], z), &
                        frame([moving_at(k), 0.0_wp, 0.0_wp], z))
    end do
    model%problem%initial%position = [-1.0_wp, 1.8_wp, 0.1_wp, 0.2_wp, 0.5_wp, 1.8_wp, 1.1_wp]
  end subroutine fig1

  !> A planar four-bar: ground, crank, coupler, rocker; coordinates crank, coupler, rocker-to-coupler, rocker.
  subroutine four_bar(ground, crank, coupler, rocker, guess, model)
    real(wp), intent(in) :: ground                   !< length [m]
    real(wp), intent(in) :: crank                    !< length [m]
    real(wp), intent(in) :: coupler                  !< length [m]
    real(wp), intent(in) :: rocker                   !< length [m]
    real(wp), intent(in) :: guess(4)                 !< of the coordinates [rad]
    type(model_type), intent(out) :: model           !< the model
    integer, parameter :: links(2, 4) = reshape([1, 2, 2, 3, 3, 4, 1, 4], [2, 4])
    real(wp), parameter :: origin(3) = 0.0_wp

    call new_mechanism(4, links, [1], model)
    call add_revolute(model, 1, 1, 2, frame(origin, z), frame(origin, z))
    call add_revolute(model, 2, 2, 3, frame([crank, 0.0_wp, 0.0_wp], z), frame(origin, z))
    call add_revolute(model, 3, 3, 4, frame([coupler, 0.0_wp, 0.0_wp], z), frame([rocker, 0.0_wp, 0.0_wp], z))
    call add_revolute(model, 4, 1, 4, frame([ground, 0.0_wp, 0.0_wp], z), frame(origin, z))
    model%problem%initial%position = guess
  end subroutine four_bar

  !> A general spatial loop of seven revolutes, assembled where every coordinate is zero.
  subroutine general_loop(model)
    type(model_type), intent(out) :: model       !< the model
    integer, parameter :: links(2, 7) = reshape([1, 2, 2, 3, 3, 4, 4, 5, 5, 6, 6, 7, 7, 1], [2, 7])
    real(wp), parameter :: at(3, 7) = reshape([ &
      -0.9_wp, 0.4_wp, -0.7_wp, 0.1_wp, -1.0_wp, -0.1_wp, 0.2_wp, 0.5_wp, -0.1_wp, -0.8_wp, 0.3_wp, 0.0_wp, &
      0.1_wp, 0.2_wp, -0.2_wp, -0.4_wp, 0.8_wp, 0.1_wp, 0.2_wp, 0.9_wp, 0.4_wp], [3, 7])
    real(wp), parameter :: along(3, 7) = reshape([ &
      -1.5_wp, 0.3_wp, 0.3_wp, -1.1_wp, -1.4_wp, 1.4_wp, 0.9_wp, 1.7_wp, 0.4_wp, -0.9_wp, 0.2_wp, -1.3_wp, &
      0.3_wp, 0.1_wp, 1.8_wp, -0.7_wp, 1.6_wp, 1.2_wp, 1.2_wp, 0.8_wp, 0.5_wp], [3, 7])
    integer :: k

    call new_mechanism(7, links, [1], model)
    do k = 1, 7
      call add_revolute(model, k, links(1, k), links(2, k), frame(at(:, k), along(:, k)), frame(at(:, k), along(:, k)))
    end do
  end subroutine general_loop
end module mech9_sample_mechanisms
