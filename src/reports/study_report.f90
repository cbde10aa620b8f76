!> Studies in reports: the runs, the failed ones by code, and the ranges and the scatter of quantities.
module mech9_study_report
  use mech9_kinds, only: wp
  use mech9_model, only: model_type
  use mech9_json, only: json_type
  use mech9_quantity_record, only: quantity_record_type
  use mech9_study_runs, only: study_runs_type
  use mech9_study_sums, only: study_sums_type
  use mech9_study_propagation, only: propagation_type
  use mech9_study_statistics, only: study_statistics_type, shares_type, quantile_type, n_levels, quantile_levels
  implicit none
  private
  public :: add_study, is_class

contains

  !> Whether a quantity is the class of what a motion goes to, whose number has no mean.
  pure logical function is_class(model, i)
    type(model_type), intent(in) :: model       !< with its quantities
    integer, intent(in) :: i                    !< number of the quantity

    is_class = model%request%quantities(i)%take == 'class'
  end function is_class

  !> Add the runs of a study, the failed ones by code, and the ranges of parameters and quantities. For values that were drawn, add the
  !> scatter of the quantities.
  subroutine add_study(json, model, quantities, runs, propagation)
    type(json_type), intent(inout) :: json                 !< the report, inside its object
    type(model_type), intent(in) :: model                  !< the model
    type(quantity_record_type), intent(in) :: quantities   !< with their columns
    type(study_runs_type), intent(in) :: runs              !< the runs
    type(propagation_type), intent(in) :: propagation(:)   !< (quantities) their scatter to first order; none where it was not found
    type(shares_type), allocatable :: shares(:)
    integer :: i

    call json%add('study', trim(model%request%study%kind))
    call json%add('runs', runs%sums%made())
    associate (sums => runs%sums, statistics => runs%statistics)
      call json%begin_array('failed_runs')
      do i = 1, sums%n_codes
        call json%begin_object()
        call json%add('exit_code', sums%codes(i))
        call json%add('runs', sums%failed(i))
        call json%add('first_run', sums%first_failed(i))
        call json%end_object()
      end do
      call json%end_array()
      call json%begin_array('parameters')
      do i = 1, size(model%parameters)
        call json%begin_object()
        call json%add('name', model%parameters(i)%name)
        call add_range(json, runs%values, i)
        call json%end_object()
      end do
      call json%end_array()
      call json%begin_array('quantities')
      if (statistics%drawn) call statistics%shares(shares)
      do i = 1, size(model%request%quantities)
        call json%begin_object()
        call json%add('name', model%request%quantities(i)%name)
        call json%add('unit', quantities%unit_of(i))
        call add_range(json, sums, i)
        if (statistics%drawn .and. sums%done > 1 .and. .not. is_class(model, i)) &
          call add_scatter(json, model, sums, statistics, shares(i), i)
        if (i <= size(propagation)) call add_propagation(json, model, propagation(i))
        call json%end_object()
      end do
      call json%end_array()
    end associate
  end subroutine add_study

  !> Add the range and the mean of one number to its object. Without runs it has none.
  subroutine add_range(json, sums, i)
    type(json_type), intent(inout) :: json      !< the report, inside the object of the number
    type(study_sums_type), intent(in) :: sums   !< over the runs
    integer, intent(in) :: i                    !< place of the number in the sums

    if (sums%done == 0) return
    call json%add('least', sums%low(i))
    call json%add('greatest', sums%high(i))
    call json%add('mean', sums%mean(i))
  end subroutine add_range

  !> Add to the object of a quantity how it scatters to first order.
  subroutine add_propagation(json, model, propagation)
    type(json_type), intent(inout) :: json                 !< the report, inside the object of the quantity
    type(model_type), intent(in) :: model                  !< with the parameters
    type(propagation_type), intent(in) :: propagation      !< of this quantity
    integer :: k

    if (.not. propagation%known) return
    call json%add('linear_deviation', propagation%deviation)
    call json%begin_array('linear_shares')
    do k = 1, size(propagation%share)
      call json%begin_object()
      call json%add('parameter', model%parameters(k)%name)
      call json%add('derivative', propagation%derivative(k))
      if (propagation%varies) call json%add('share', propagation%share(k))
      call json%end_object()
    end do
    call json%end_array()
  end subroutine add_propagation

  !> Add to the object of a quantity how it scatters.
  subroutine add_scatter(json, model, sums, statistics, shares, i)
    type(json_type), intent(inout) :: json                  !< the report, inside the object of the quantity
    type(model_type), intent(in) :: model                   !< with the parameters
    type(study_sums_type), intent(in) :: sums               !< over the runs
    type(study_statistics_type), intent(in) :: statistics   !< of the same runs
    type(shares_type), intent(in) :: shares                 !< of this quantity
    integer, intent(in) :: i                                !< its number
    real(wp), dimension(size(sums%mean)) :: of_mean, deviation, of_deviation
    type(quantile_type) :: found(n_levels)
    integer :: k

    of_mean = sums%error_of_mean()
    deviation = sums%deviation()
    of_deviation = sums%error_of_deviation()
    call json%add('mean_error', of_mean(i))
    call json%add('deviation', deviation(i))
    call json%add('deviation_error', of_deviation(i))
    call statistics%quantiles(i, found)
    call json%begin_array('quantiles')
    do k = 1, n_levels
      call json%begin_object()
      call json%add('share', quantile_levels(k))
      call json%add('value', found(k)%value)
      if (found(k)%known) call json%add('error', found(k)%error)
      call json%end_object()
    end do
    call json%end_array()
    if (.not. shares%known) return
    call json%begin_array('first_order_shares')
    do k = 1, size(shares%share)
      call json%begin_object()
      call json%add('parameter', model%parameters(k)%name)
      call json%add('share', shares%share(k))
      call json%add('error', shares%error(k))
      call json%end_object()
    end do
    call json%end_array()
    call json%add('share_of_rest', shares%rest)
  end subroutine add_scatter
end module mech9_study_report
