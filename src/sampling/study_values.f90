!> The values of the parameters in each run of a study.
module mech9_study_values
  use mech9_kinds, only: wp
  use mech9_parameter, only: parameter_type
  use mech9_study, only: study_type
  use mech9_counted_random, only: uniform_at
  use mech9_latin_hypercube, only: latin_at
  use mech9_sobol, only: sobol_at
  use mech9_normal_quantile, only: normal_quantile
  implicit none
  private
  public :: values_of_run

contains

  !> The values of all parameters in a run. They depend on its number alone, not on other runs.
  pure subroutine values_of_run(study, parameters, run, values)
    type(study_type), intent(in) :: study                !< the study
    type(parameter_type), intent(in) :: parameters(:)    !< with ranges, or values and spreads
    integer, intent(in) :: run                           !< number of the run, 1 to study%runs
    real(wp), intent(out) :: values(:)                   !< (parameters) in the units of the file
    integer :: i, rest, set

    set = study%set_of(run)
    rest = set - 1
    do i = size(parameters), 1, -1
      select case (study%kind)
      case ('grid')
        ! the last parameter changes from run to run, the first one least often
        values(i) = on_grid(parameters(i), mod(rest, parameters(i)%count))
        rest = rest/parameters(i)%count
      case ('list')
        values(i) = study%list(i, set)
      case ('latin')
        values(i) = quantile(parameters(i), latin_at(study%seed, run, i, study%runs))
      case ('sobol')
        values(i) = quantile(parameters(i), sobol_at(study%seed, run, i))
      case default
        values(i) = quantile(parameters(i), uniform_at(study%seed, run, i))
      end select
    end do
  end subroutine values_of_run

  !> A value of the grid of a parameter.
  pure real(wp) function on_grid(parameter, number) result(value)
    type(parameter_type), intent(in) :: parameter   !< with a range and a count
    integer, intent(in) :: number                   !< from 0

    value = parameter%low
    if (number == 0) return
    value = parameter%low + (parameter%high - parameter%low)*number/(parameter%count - 1)
    if (number == parameter%count - 1) value = parameter%high
  end function on_grid

  !> The value that a parameter does not exceed with probability u: about its value by its spread, else between low and high.
  pure real(wp) function quantile(parameter, u) result(value)
    type(parameter_type), intent(in) :: parameter   !< with a spread or a range
    real(wp), intent(in) :: u                       !< probability, greater than 0 and less than 1

    if (.not. parameter%spread > 0.0_wp) then
      value = parameter%low + (parameter%high - parameter%low)*u
    else if (parameter%uniform) then
      value = parameter%value + parameter%spread*(2.0_wp*u - 1.0_wp)
    else
      value = parameter%value + parameter%spread*normal_quantile(u)
    end if
  end function quantile
end module mech9_study_values
