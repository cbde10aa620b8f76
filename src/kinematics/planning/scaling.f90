!> The scaling of a mechanism: its size, which is the unit of length, its origin, and the units of its coordinates.
module mech9_scaling
  use mech9_kinds, only: wp
  use mech9_tolerances, only: negligible_distance
  use mech9_planning_tolerances, only: one_point
  use mech9_pose, only: pose_type, inverse, transformed
  use mech9_pair, only: screw_factors_type, pair_guide_type
  use mech9_mechanism, only: mechanism_type
  use mech9_result_units, only: unit_of, rate_unit_of
  use mech9_plan, only: plan_type
  implicit none
  private
  public :: find_size, find_units


contains

  !> Size of the mechanism, and its origin, which is the centre of link 1's pairs.
  !> The size is the largest distance between two pairs of one link, curves included, or the largest initial slide. Where all
  !> links have their pairs in one point, as in spherical mechanisms, it is the largest distance of a point or pair from the
  !> origin of its link, or 1 m if that is zero. The shortest link is found, too.
  subroutine find_size(mechanism, start, plan)
    type(mechanism_type), intent(in) :: mechanism   !< the mechanism
    real(wp), intent(in) :: start(:)       !< (M) coordinates at the start [rad, m]
    type(plan_type), intent(inout) :: plan   !< the plan of the mechanism
    real(wp) :: low(3, mechanism%structure%n_links), high(3, mechanism%structure%n_links)
    type(screw_factors_type) :: factors
    type(pair_guide_type) :: guide
    type(pose_type) :: frame
    real(wp) :: reach, distance, place(3)
    logical :: is_screw
    integer :: k, i

    low = huge(low)
    high = -huge(high)
    do k = 1, plan%n_coordinates
      associate (pair => mechanism%pairs(k)%pair)
        call pair%as_screw(factors, is_screw)
        call pair%guide(guide)
        frame = inverse(factors%after)
        if (size(guide%points, 2) == 0) then
          low(:, pair%reference) = min(low(:, pair%reference), factors%before%p)
          high(:, pair%reference) = max(high(:, pair%reference), factors%before%p)
        end if
        do i = 1, size(guide%points, 2)
          place = transformed(factors%before, guide%points(:, i))
          low(:, pair%reference) = min(low(:, pair%reference), place)
          high(:, pair%reference) = max(high(:, pair%reference), place)
        end do
        low(:, pair%moving) = min(low(:, pair%moving), frame%p)
        high(:, pair%moving) = max(high(:, pair%moving), frame%p)
      end associate
    end do
    plan%origin = 0.5_wp*(low(:, 1) + high(:, 1))
    plan%length = 0.0_wp
    plan%least_length = huge(1.0_wp)
    plan%shortest_link = 0
    do k = 1, plan%n_links
      distance = norm2(high(:, k) - low(:, k))
      plan%length = max(plan%length, distance)
      if (distance < one_point .or. distance >= plan%least_length) cycle
      plan%least_length = distance
      plan%shortest_link = k
    end do
    do k = 1, plan%n_coordinates
      call mechanism%pairs(k)%pair%guide(guide)
      if (.not. mechanism%pairs(k)%pair%angular .and. .not. guide%length > 0.0_wp) &
        plan%length = max(plan%length, abs(start(k)))
    end do
    reach = 0.0_wp
    do k = 1, plan%n_links
      reach = max(reach, maxval(abs(high(:, k))), maxval(abs(low(:, k))))
    end do
    do k = 1, size(mechanism%points)
      reach = max(reach, maxval(abs(mechanism%points(k)%position)))
    end do
    if (plan%length <= negligible_distance*reach) plan%length = reach
    if (plan%length <= 1.0e-14_wp) plan%length = 1.0_wp
  end subroutine find_size

  !> The unit of each coordinate: the size of the mechanism for slides and along curves, 1 for all others; and its unit in results.
  subroutine find_units(mechanism, plan)
    type(mechanism_type), intent(in) :: mechanism   !< the mechanism
    type(plan_type), intent(inout) :: plan   !< the plan of the mechanism
    type(screw_factors_type) :: factors
    type(pair_guide_type) :: guide
    logical :: is_screw
    integer :: k

    allocate (plan%unit_of(plan%n_coordinates), source=1.0_wp)
    do k = 1, plan%n_coordinates
      call mechanism%pairs(k)%pair%as_screw(factors, is_screw)
      call mechanism%pairs(k)%pair%guide(guide)
      if ((is_screw .or. guide%length > 0.0_wp) .and. .not. mechanism%pairs(k)%pair%angular) plan%unit_of(k) = plan%length
    end do
    plan%rate_unit = [(rate_unit_of(mechanism, k), k=1, plan%n_coordinates)]
    plan%rate_names = trim(mechanism%units%rate_name)//', '//trim(mechanism%units%length_name)//'/s'
    plan%result_unit = [(unit_of(mechanism, k), k=1, plan%n_coordinates)]
  end subroutine find_units
end module mech9_scaling
