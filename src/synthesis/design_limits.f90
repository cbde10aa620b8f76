!> The limits of a synthesis as numbers that are not negative where they are kept, with their derivatives.
module mech9_design_limits
  use mech9_kinds, only: wp
  use mech9_plan, only: plan_type
  use mech9_objective, only: limit_type, quantity_limit, crank_limit, transmission_limit
  use mech9_transmission, only: transmission_type, find_transmission, find_extremes
  use mech9_crank_limit, only: crank_limit_type, new_crank_limit, find_crank_numbers
  use mech9_exact_fit, only: exact_fit_type
  implicit none
  private
  public :: design_limits_type, new_design_limits, find_limits

  type :: design_limits_type
    integer :: n = 0                                           !< number of numbers
    type(limit_type), allocatable :: ranges(:)                 !< of quantities
    type(transmission_type), allocatable :: transmissions(:)
    type(crank_limit_type), allocatable :: cranks(:)
  end type design_limits_type

contains

  !> The limits of a plan that have numbers.
  pure subroutine new_design_limits(plan, all, limits)
    type(plan_type), intent(in) :: plan                   !< the plan of all designs
    type(limit_type), intent(in) :: all(:)                !< all limits of the model
    type(design_limits_type), intent(out) :: limits       !< those that have numbers
    type(limit_type), allocatable :: angles(:), turns(:)
    logical :: found
    integer :: i

    limits%ranges = pack(all, all%kind == quantity_limit)
    allocate (limits%transmissions(count(all%kind == transmission_limit)))
    angles = pack(all, all%kind == transmission_limit)
    do i = 1, size(angles)
      call find_transmission(plan, angles(i)%coordinate, limits%transmissions(i), found)
      limits%transmissions(i)%least = angles(i)%at_least
    end do
    turns = pack(all, all%kind == crank_limit)
    allocate (limits%cranks(size(turns)))
    do i = 1, size(turns)
      call new_crank_limit(plan, turns(i)%coordinate, limits%cranks(i))
    end do
    limits%n = 2*size(limits%ranges) + 2*size(limits%transmissions) + sum(limits%cranks%n)
  end subroutine new_design_limits

  !> The numbers of all limits of a design. Those of ranges without one end are 1.
  subroutine find_limits(limits, fit, numbers, slopes, found)
    type(design_limits_type), intent(in) :: limits      !< the limits
    class(exact_fit_type), intent(inout) :: fit         !< with a design that has a value and derivatives
    real(wp), intent(out) :: numbers(:)                 !< (n) not negative where a limit is kept
    real(wp), intent(out) :: slopes(:, :)               !< (unknowns,n) their derivatives
    logical, intent(out) :: found                       !< they exist
    real(wp) :: cosines(2), by_x(fit%varied, 2), scale
    integer :: i, k, p

    numbers = 1.0_wp
    slopes = 0.0_wp
    found = .true.
    do i = 1, size(limits%ranges)
      associate (range => limits%ranges(i))
        k = range%quantity
        scale = size_of_range(range)
        if (range%low > -huge(1.0_wp)) then
          numbers(2*i - 1) = (fit%quantities(k) - range%low)/scale
          slopes(:fit%varied, 2*i - 1) = fit%quantity_slopes(k)/scale
        end if
        if (range%high < huge(1.0_wp)) then
          numbers(2*i) = (range%high - fit%quantities(k))/scale
          slopes(:fit%varied, 2*i) = -fit%quantity_slopes(k)/scale
        end if
      end associate
    end do
    do i = 1, size(limits%transmissions)
      k = 2*size(limits%ranges) + 2*i
      call find_extremes(fit, limits%transmissions(i), cosines, by_x, found)
      if (.not. found) return
      numbers(k - 1:k) = cos(limits%transmissions(i)%least) + [cosines(1), -cosines(2)]
      slopes(:fit%varied, k - 1) = by_x(:, 1)*(fit%space%high - fit%space%low)
      slopes(:fit%varied, k) = -by_x(:, 2)*(fit%space%high - fit%space%low)
    end do
    k = 2*size(limits%ranges) + 2*size(limits%transmissions)
    do i = 1, size(limits%cranks)
      associate (n => limits%cranks(i)%n)
        call find_crank_numbers(fit, limits%cranks(i), numbers(k + 1:k + n), slopes(:fit%varied, k + 1:k + n), found)
        if (.not. found) return
        do p = 1, fit%varied
          slopes(p, k + 1:k + n) = slopes(p, k + 1:k + n)*(fit%space%high(p) - fit%space%low(p))
        end do
        k = k + n
      end associate
    end do
  end subroutine find_limits

  !> The number by which the distance of a quantity from an end of its range is divided.
  pure real(wp) function size_of_range(range) result(scale)
    type(limit_type), intent(in) :: range   !< the range

    scale = 0.0_wp
    if (range%low > -huge(1.0_wp)) scale = abs(range%low)
    if (range%high < huge(1.0_wp)) scale = max(scale, abs(range%high))
    if (.not. scale > 0.0_wp) scale = 1.0_wp
  end function size_of_range
end module mech9_design_limits
