!> How a study went, in words.
module mech9_study_words
  use mech9_kinds, only: wp
  use mech9_text, only: to_text
  use mech9_counted, only: counted
  use mech9_model, only: model_type
  use mech9_quantity_record, only: quantity_record_type
  use mech9_run_words, only: duration
  use mech9_study_report, only: is_class
  use mech9_study_runs, only: study_runs_type
  use mech9_study_sums, only: study_sums_type
  use mech9_study_propagation, only: propagation_type
  use mech9_study_statistics, only: study_statistics_type, shares_type, quantile_type, n_levels, quantile_levels
  implicit none
  private
  public :: print_study

contains

  !> Print how the study went: failed runs by code, and the quantities. For values that were drawn, print means and
  !> deviations.
  subroutine print_study(unit, model, quantities, runs, propagation, time)
    integer, intent(in) :: unit                            !< Fortran unit to write to
    type(model_type), intent(in) :: model                  !< the model
    type(quantity_record_type), intent(in) :: quantities   !< with their columns
    type(study_runs_type), intent(in) :: runs              !< their sums and statistics
    type(propagation_type), intent(in) :: propagation(:)   !< (quantities) their scatter to first order; none where it was not found
    real(wp), intent(in) :: time                           !< time that the study took [s]
    integer :: i

    associate (sums => runs%sums)
      write (unit, '(a)') counted(sums%made(), 'run')//': '//duration(time)
      do i = 1, sums%n_codes
        write (unit, '(a)') counted(sums%failed(i), 'run')//' failed with exit code '//to_text(sums%codes(i))// &
          ', the first one is run '//to_text(sums%first_failed(i))
      end do
      if (sums%done > 0) call print_quantities(unit, model, quantities, sums, runs%statistics, propagation)
    end associate
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
end module mech9_study_words
