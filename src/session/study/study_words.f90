!> How a study went: a summary for the terminal, and a report for programs.
module mech9_study_words
  use mech9_kinds, only: wp
  use mech9_text, only: to_text
  use mech9_counted, only: counted
  use mech9_error, only: error_type
  use mech9_diagnostics, only: diagnostics_type
  use mech9_model, only: model_type
  use mech9_json, only: json_type
  use mech9_quantity_record, only: quantity_record_type
  use mech9_run_words, only: duration
  use mech9_report_parts, only: begin_report
  use mech9_study_sums, only: study_sums_type
  use mech9_study_propagation, only: propagation_type
  use mech9_study_statistics, only: study_statistics_type, shares_type, quantile_type, n_levels, quantile_levels
  implicit none
  private
  public :: print_study, save_study_report

contains

  !> Print how the study went: failed runs by code, and the quantities. For values that were drawn, print means and
  !> deviations.
  subroutine print_study(unit, model, quantities, sums, statistics, propagation, time)
    integer, intent(in) :: unit                            !< Fortran unit to write to
    type(model_type), intent(in) :: model                  !< the model
    type(quantity_record_type), intent(in) :: quantities   !< with their columns
    type(study_sums_type), intent(in) :: sums              !< over the runs
    type(study_statistics_type), intent(in) :: statistics  !< of the same runs
    type(propagation_type), intent(in) :: propagation(:)   !< (quantities) their scatter to first order; none where it was not found
    real(wp), intent(in) :: time                           !< time that the study took [s]
    integer :: i

    write (unit, '(a)') counted(sums%made(), 'run')//': '//duration(time)
    do i = 1, sums%n_codes
      write (unit, '(a)') counted(sums%failed(i), 'run')//' failed with exit code '//to_text(sums%codes(i))// &
        ', the first one is run '//to_text(sums%first_failed(i))
    end do
    if (sums%done > 0) call print_quantities(unit, model, quantities, sums, statistics, propagation)
  end subroutine print_study

  !> Print the range of each quantity, and of values that were drawn its mean, deviation, quantiles, and the shares in its variance.
  subroutine print_quantities(unit, model, quantities, sums, statistics, propagation)
    integer, intent(in) :: unit                            !< Fortran unit to write to
    type(model_type), intent(in) :: model                  !< the model
    type(quantity_record_type), intent(in) :: quantities   !< with their columns
    type(study_sums_type), intent(in) :: sums              !< over the runs
    type(study_statistics_type), intent(in) :: statistics  !< of the same runs
    type(propagation_type), intent(in) :: propagation(:)   !< (quantities) their scatter to first order; none where it was not found
    type(shares_type), allocatable :: shares(:)
    integer :: i

    if (statistics%drawn) call statistics%shares(shares)
    do i = 1, size(model%request%quantities)
      associate (name => model%request%quantities(i)%name)
        if (statistics%drawn .and. sums%done > 1 .and. .not. is_class(model, i)) &
          call print_moments(unit, name, quantities%unit_of(i), sums, i)
        write (unit, '(a)') name//': '//to_text(sums%low(i), 8)//' to '//to_text(sums%high(i), 8)//' '//quantities%unit_of(i)
        if (is_class(model, i)) cycle
        if (statistics%drawn .and. sums%done > 1) call print_quantiles(unit, name, quantities%unit_of(i), statistics, i)
        if (statistics%drawn) call print_shares(unit, name, model, shares(i))
        if (i <= size(propagation)) call print_propagation(unit, name, quantities%unit_of(i), model, propagation(i))
      end associate
    end do
  end subroutine print_quantities

  !> Whether a quantity is the class of what a motion goes to, whose number has no mean.
  pure logical function is_class(model, i)
    type(model_type), intent(in) :: model       !< with its quantities
    integer, intent(in) :: i                    !< number of the quantity

    is_class = model%request%quantities(i)%take == 'class'
  end function is_class

  !> Print mean and deviation of a quantity, with their standard errors.
  subroutine print_moments(unit, name, unit_name, sums, i)
    integer, intent(in) :: unit                 !< Fortran unit to write to
    character(len=*), intent(in) :: name        !< of the quantity
    character(len=*), intent(in) :: unit_name   !< its unit
    type(study_sums_type), intent(in) :: sums   !< over the runs
    integer, intent(in) :: i                    !< number of the quantity
    real(wp), dimension(size(sums%mean)) :: deviation, of_mean, of_deviation

    deviation = sums%deviation()
    of_mean = sums%error_of_mean()
    of_deviation = sums%error_of_deviation()
    write (unit, '(a)') name//': mean '//to_text(sums%mean(i), 8)//' '//unit_name//' (standard error '//to_text(of_mean(i), 2)// &
      '), deviation '//to_text(deviation(i), 6)//' '//unit_name//' (standard error '//to_text(of_deviation(i), 2)//')'
  end subroutine print_moments

  !> Print the quantiles of a quantity, with their standard errors where the runs tell them.
  subroutine print_quantiles(unit, name, unit_name, statistics, i)
    integer, intent(in) :: unit                             !< Fortran unit to write to
    character(len=*), intent(in) :: name                    !< of the quantity
    character(len=*), intent(in) :: unit_name               !< its unit
    type(study_statistics_type), intent(in) :: statistics   !< of the runs
    integer, intent(in) :: i                                !< number of the quantity
    type(quantile_type) :: found(n_levels)
    character(len=:), allocatable :: line
    integer :: k

    call statistics%quantiles(i, found)
    line = name//': quantiles'
    do k = 1, n_levels
      line = line//' '//to_text(100.0_wp*quantile_levels(k), 3)//' % '//to_text(found(k)%value, 6)//' '//unit_name
      if (found(k)%known) line = line//' (standard error '//to_text(found(k)%error, 2)//')'
      if (k < n_levels) line = line//','
    end do
    write (unit, '(a)') line
  end subroutine print_quantiles

  !> Print the share of each parameter in the variance of a quantity.
  subroutine print_shares(unit, name, model, shares)
    integer, intent(in) :: unit                 !< Fortran unit to write to
    character(len=*), intent(in) :: name        !< of the quantity
    type(model_type), intent(in) :: model       !< with the parameters
    type(shares_type), intent(in) :: shares     !< of this quantity
    character(len=:), allocatable :: line
    integer :: k

    if (.not. shares%known) return
    line = name//': shares of first order in its variance:'
    do k = 1, size(shares%share)
      line = line//' '//model%parameters(k)%name//' '//to_text(shares%share(k), 3)// &
        ' (standard error '//to_text(shares%error(k), 2)//'),'
    end do
    write (unit, '(a)') line//' the rest '//to_text(shares%rest, 3)
  end subroutine print_shares

  !> Print how a quantity scatters to first order, by its derivatives.
  subroutine print_propagation(unit, name, unit_name, model, propagation)
    integer, intent(in) :: unit                            !< Fortran unit to write to
    character(len=*), intent(in) :: name                   !< of the quantity
    character(len=*), intent(in) :: unit_name              !< its unit
    type(model_type), intent(in) :: model                  !< with the parameters
    type(propagation_type), intent(in) :: propagation      !< of this quantity
    character(len=:), allocatable :: line
    integer :: k

    if (.not. propagation%known) then
      write (unit, '(a)') name//': no shares by derivatives, because it has none by the parameters'
    else if (propagation%varies) then
      line = name//': shares by its derivatives:'
      do k = 1, size(propagation%share)
        line = line//' '//model%parameters(k)%name//' '//to_text(propagation%share(k), 3)//','
      end do
      write (unit, '(a)') line//' and a deviation of '//to_text(propagation%deviation, 6)//' '//unit_name
    end if
  end subroutine print_propagation

  !> Write the report of a study as JSON: the runs, the failed ones by code, and the ranges of parameters and
  !> quantities. For values that were drawn it has the scatter of the quantities.
  subroutine save_study_report(path, model, quantities, values, sums, statistics, propagation, table_path, &
                               diagnostics, err)
    character(len=*), intent(in) :: path                   !< of the report
    type(model_type), intent(in) :: model                  !< the model
    type(quantity_record_type), intent(in) :: quantities   !< with their columns
    type(study_sums_type), intent(in) :: values            !< of the parameters, over all runs
    type(study_sums_type), intent(in) :: sums              !< of the quantities, over the runs
    type(study_statistics_type), intent(in) :: statistics  !< of the runs that did not fail
    type(propagation_type), intent(in) :: propagation(:)   !< (quantities) their scatter to first order; none where it was not found
    character(len=*), intent(in) :: table_path             !< path of the table; '-' is standard output; empty: no table
    type(diagnostics_type), intent(in) :: diagnostics      !< all errors, which determine the exit code
    type(error_type), allocatable, intent(out) :: err      !< allocated if it failed
    type(json_type) :: json
    type(shares_type), allocatable :: shares(:)
    integer :: i

    call begin_report(json, model, diagnostics, table_path)
    call json%add('study', trim(model%request%study%kind))
    call json%add('runs', sums%made())
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
      call add_range(json, values, i)
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
    call json%end_object()
    call json%save(path, err)
  end subroutine save_study_report

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
end module mech9_study_words
