!> The start of a motion as a mechanism that is held there: a model whose independent coordinates all have drives that stand still.
!>
!> Designs whose motions follow from forces are judged by runs. To a search they are mechanisms that are held at the start: so it finds
!> how their chains close, and keeps them closed, as parameters change dimensions, positions at the start or drives.
module mech9_held_start
  use mech9_kinds, only: wp
  use mech9_error, only: error_type
  use mech9_partition, only: driven_coordinate
  use mech9_law, only: drive_slot_type
  use mech9_polynomial_law, only: polynomial_law_type
  use mech9_model, only: model_type
  use mech9_variable_model, only: variable_model_type
  implicit none
  private
  public :: held_start_type, hold_start

  !> A model as a function of its parameters, held at the start.
  type, extends(variable_model_type) :: held_start_type
    class(variable_model_type), allocatable :: moving   !< the model that moves
  contains
    procedure :: at => held_model_at
    procedure :: along => held_model_along
  end type held_start_type

contains

  !> The held model with other values of its parameters.
  subroutine held_model_at(self, values, model, err)
    class(held_start_type), intent(inout) :: self       !< the model as a function; it keeps these values
    real(wp), intent(in) :: values(:)                   !< of all parameters, in their order, in the units of the data file
    type(model_type), intent(out) :: model              !< of use only where nothing failed
    type(error_type), allocatable, intent(out) :: err   !< allocated if it failed

    call self%moving%at(values, model, err)
    if (.not. allocated(err)) call hold_start(model, err)
  end subroutine held_model_at

  !> The held model where one parameter has a larger value, and formulas follow it along their tangents.
  subroutine held_model_along(self, values, number, distance, model, err)
    class(held_start_type), intent(inout) :: self       !< the model as a function; it keeps these values
    real(wp), intent(in) :: values(:)                   !< of all parameters, in their order, in the units of the data file
    integer, intent(in) :: number                       !< of the parameter
    real(wp), intent(in) :: distance                    !< by which its value is larger
    type(model_type), intent(out) :: model              !< of use only where nothing failed
    type(error_type), allocatable, intent(out) :: err   !< allocated if it failed

    call self%moving%along(values, number, distance, model, err)
    if (.not. allocated(err)) call hold_start(model, err)
  end subroutine held_model_along

  !> Replace all drives of a model by ones that stand still at the start of the run, and hold its free coordinates there.
  subroutine hold_start(model, err)
    type(model_type), intent(inout) :: model            !< the model
    type(error_type), allocatable, intent(out) :: err   !< allocated if a drive has no value at the start
    type(drive_slot_type), allocatable :: held(:)
    type(polynomial_law_type) :: standing
    real(wp) :: q(size(model%problem%partition%kind)), rate, acceleration
    integer, allocatable :: coordinates(:)
    integer :: i, k

    q = model%problem%initial%position
    do i = 1, size(model%problem%drives)
      k = model%problem%drives(i)%drive%coordinate
      call model%problem%drives(i)%drive%evaluate(model%request%time%start, q(k), rate, acceleration, err)
      if (allocated(err)) return
    end do
    coordinates = pack([(k, k=1, size(q))], model%problem%partition%independent())
    allocate (held(size(coordinates)))
    do i = 1, size(held)
      standing%coordinate = coordinates(i)
      standing%coefficients = [q(coordinates(i))]
      allocate (held(i)%drive, source=standing)
    end do
    call move_alloc(held, model%problem%drives)
    model%problem%partition%kind(coordinates) = driven_coordinate
  end subroutine hold_start
end module mech9_held_start
