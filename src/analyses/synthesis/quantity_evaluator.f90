!> The quantities of a design, as whoever makes runs finds them.
module mech9_quantity_evaluator
  use mech9_kinds, only: wp
  implicit none
  private
  public :: quantity_evaluator_type

  type, abstract :: quantity_evaluator_type
  contains
    procedure(evaluate_interface), deferred :: evaluate
  end type quantity_evaluator_type

  abstract interface
    !> The quantities of the model over a run that starts in an assembly, and their derivatives. Without `has_value` the run does not
    !> come to its end.
    subroutine evaluate_interface(self, values, q, with_gradient, numbers, gradient, has_value)
      import :: quantity_evaluator_type, wp
      class(quantity_evaluator_type), intent(inout) :: self   !< makes the run
      real(wp), intent(in) :: values(:)                       !< of all parameters, in the units of the data file
      real(wp), intent(in) :: q(:)                            !< (M) coordinates at the start of the run [rad, m]
      logical, intent(in) :: with_gradient                    !< derivatives are asked for
      real(wp), intent(out) :: numbers(:)                     !< (quantities) in the units of the results
      real(wp), intent(out) :: gradient(:, :)                 !< (parameters,quantities) their derivatives; zero where not asked for
      logical, intent(out) :: has_value                       !< all numbers and derivatives exist
    end subroutine evaluate_interface
  end interface
end module mech9_quantity_evaluator
