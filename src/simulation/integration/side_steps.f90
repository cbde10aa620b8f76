!> Steps aside from the integration of a motion: from the start of its last step to a time within it, while it stays where it
!> is.
module mech9_side_steps
  use mech9_kinds, only: wp
  use mech9_error, only: error_type
  use mech9_expectation, only: expectation_type
  use mech9_motion_system, only: motion_system_type
  use mech9_integrator, only: integrator_type, integration_statistics_type
  implicit none
  private
  public :: side_steps_type, begin_integration

  type :: side_steps_type
    private
    type(integrator_type) :: integrator
    logical :: begun = .false.
    logical :: is_on_the_way = .false.                !< it stands on the motion of the last step
    real(wp), public :: t = 0.0_wp                    !< end of the last side step [s]
    real(wp), allocatable, public :: y(:)             !< there
  contains
    procedure :: reach
    procedure :: forget
    procedure :: statistics
    procedure :: close => close_side_steps
  end type side_steps_type

contains

  !> Make an integrator of the system from (t, y), with the method and the limits of its data file.
  subroutine begin_integration(integrator, system, t, y, err)
    type(integrator_type), intent(inout) :: integrator          !< of the system, at its start
    type(motion_system_type), intent(inout), target :: system   !< must outlive the integrator
    real(wp), intent(in) :: t                                   !< time of the start [s]
    real(wp), intent(in) :: y(:)   !< the vector: all coordinates, and the rates of the free ones
    type(error_type), allocatable, intent(out) :: err           !< allocated if it failed
    real(wp) :: absolute(size(y)), strict
    integer :: i, n

    associate (solver => system%model%request%solver)
      absolute = solver%absolute_tolerance
      strict = 1.0_wp
      if (allocated(system%sensitivity)) then
        ! the error of a step is a mean over the vector, in which the derivatives by parameters must not hide that of the motion
        n = system%size_of_motion()
        strict = sqrt(real(n, wp)/size(y))
        do i = n + 1, size(y)
          absolute(i) = absolute(i)*system%sensitivity%size_of(mod(i - n - 1, size(system%sensitivity%size_of)) + 1)
        end do
      end if
      call integrator%create(system, solver%method, strict*solver%relative_tolerance, strict*absolute, t, y, err)
      if (.not. allocated(err)) call integrator%limit(err, maximum_steps=solver%maximum_steps)
    end associate
  end subroutine begin_integration

  !> Integrate to time t, from (from, y), or from the end of earlier side steps if that lies between. Fails as the integration
  !> does.
  subroutine reach(self, system, from, y, t, err)
    class(side_steps_type), intent(inout) :: self               !< the side steps
    type(motion_system_type), intent(inout), target :: system   !< the same at each call, until closed
    real(wp), intent(in) :: from                                !< start of the last step [s]
    real(wp), intent(in) :: y(:)                                !< the vector there
    real(wp), intent(in) :: t                                   !< time that is wanted, within the last step [s]
    type(error_type), allocatable, intent(out) :: err           !< allocated if it failed
    type(expectation_type) :: expectation
    logical :: goes_on

    expectation = system%work%expectation
    goes_on = self%begun .and. self%is_on_the_way .and. (self%t - from)*(t - self%t) >= 0.0_wp
    if (.not. self%begun) call begin_integration(self%integrator, system, from, y, err)
    self%begun = .true.
    if (.not. (goes_on .or. allocated(err))) then
      call self%integrator%restart(from, y, err, first_step=t - from)
      self%t = from
      self%y = y
    end if
    self%is_on_the_way = .true.
    do while (.not. allocated(err) .and. abs(t - self%t) > 0.0_wp)
      call self%integrator%step(t, self%t, self%y, err)
    end do
    call system%resume(expectation)
  end subroutine reach

  !> Forget where earlier side steps ended: an event has changed the motion, which does not go on there.
  pure subroutine forget(self)
    class(side_steps_type), intent(inout) :: self   !< the side steps

    self%is_on_the_way = .false.
  end subroutine forget

  !> The statistics of the side steps.
  function statistics(self)
    class(side_steps_type), intent(inout) :: self   !< the side steps
    type(integration_statistics_type) :: statistics

    statistics = self%integrator%statistics()
  end function statistics

  !> Free the memory of the side steps.
  subroutine close_side_steps(self)
    class(side_steps_type), intent(inout) :: self   !< the side steps

    call self%integrator%destroy()
    self%begun = .false.
  end subroutine close_side_steps
end module mech9_side_steps
