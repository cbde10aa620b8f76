!> The part of a report that has a periodic motion, as JSON (docs/reference/results.md).
module mech9_periodic_report
  use, intrinsic :: ieee_arithmetic, only: ieee_value, ieee_quiet_nan
  use mech9_kinds, only: wp
  use mech9_mechanism, only: mechanism_type
  use mech9_result_units, only: unit_of, rate_unit_of
  use mech9_json, only: json_type
  use mech9_periodic_motion, only: periodic_motion_type, stable, unstable
  use mech9_periodic, only: periodic_found_type
  implicit none
  private
  public :: add_periodic

contains

  !> Add the motion that was recorded, "periodic": {"period": ..., "multipliers": [[re, im], ...], ...}, and, of several starts, all of
  !> them, "periodic_motions": [{...}, ...].
  subroutine add_periodic(json, mechanism, found)
    type(json_type), intent(inout) :: json               !< the report, inside its object
    type(mechanism_type), intent(in) :: mechanism        !< the mechanism
    type(periodic_found_type), intent(in) :: found       !< the motions; none after a failure
    integer :: i

    if (.not. allocated(found%motions)) return
    if (size(found%motions) == 0) return
    call json%begin_object('periodic')
    call add_motion(json, mechanism, found%motions(1))
    call json%end_object()
    if (found%starts < 2) return
    call json%begin_array('periodic_motions')
    do i = 1, size(found%motions)
      call json%begin_object()
      call add_motion(json, mechanism, found%motions(i))
      call json%end_object()
    end do
    call json%end_array()
  end subroutine add_periodic

  !> Add the numbers of a motion.
  subroutine add_motion(json, mechanism, motion)
    type(json_type), intent(inout) :: json               !< the report, inside the object of the motion
    type(mechanism_type), intent(in) :: mechanism        !< the mechanism
    type(periodic_motion_type), intent(in) :: motion     !< the motion
    real(wp) :: unknown
    integer :: k

    unknown = ieee_value(unknown, ieee_quiet_nan)
    call json%add('period', motion%period)
    call json%begin_array('multipliers')
    do k = 1, size(motion%multipliers)
      call json%begin_array()
      call json%add(real(motion%multipliers(k), wp))
      call json%add(aimag(motion%multipliers(k)))
      call json%end_array()
    end do
    call json%end_array()
    call json%add('stability', trim(merge('stable  ', merge('unstable', 'neutral ', motion%stability == unstable), &
                                          motion%stability == stable)))
    call json%add('product', motion%product)
    call json%add('product_by_divergence', merge(motion%product_by_divergence, unknown, motion%knows_volume))
    call json%add('trivial', motion%is_trivial)
    call json%add('repeats_after', merge(motion%repeats_after, motion%period, motion%repeats_after > 0.0_wp))
    call json%begin_array('turns')
    do k = 1, size(motion%turns)
      call json%add(motion%turns(k))
    end do
    call json%end_array()
    associate (units => [(unit_of(mechanism, k), k=1, size(motion%q))], &
               rates => [(rate_unit_of(mechanism, k), k=1, size(motion%q))])
      if (motion%cyclic > 0) call json%add('advance', motion%advance/units)
      call json%add('start', motion%q/units)
      call json%add('start_rates', motion%dq/rates)
      call json%add('residual', motion%residual/units)
      call json%add('rate_residual', motion%rate_residual/rates)
    end associate
    call json%add('start_error', motion%start_error)
    call json%add('iterations', motion%iterations)
  end subroutine add_motion
end module mech9_periodic_report
