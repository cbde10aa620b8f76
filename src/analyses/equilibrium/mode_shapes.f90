!> Modes as motions of all coordinates: shapes, shares of the kinetic energy, and positions of a vibration.
module mech9_mode_shapes
  use mech9_kinds, only: wp
  use mech9_error, only: error_type
  use mech9_mechanism, only: mechanism_type
  use mech9_state, only: state_type
  use mech9_motion_variation, only: vary_position
  use mech9_resting_mechanism, only: resting_type, try_step, move_along
  use mech9_linearised_equilibrium, only: equilibrium_type
  use mech9_contact_rest, only: close_gaps
  implicit none
  private
  public :: shape_of_mode, energy_shares, displacement, position_in_vibration

contains

  !> The shape of a mode by all coordinates, in the units of the results; its largest number is 1.
  subroutine shape_of_mode(equilibrium, mode, shape)
    type(equilibrium_type), intent(inout) :: equilibrium   !< with its modes; its last variation changes
    integer, intent(in) :: mode                            !< number of the mode
    complex(wp), intent(out) :: shape(:)                   !< (M) amplitudes
    integer :: i, largest

    shape = (0.0_wp, 0.0_wp)
    associate (resting => equilibrium%resting, variation => equilibrium%resting%linearisation%variation)
      do i = 1, size(resting%free)
        call variation%clear()
        call move_along(resting, i, variation%q)
        call vary_position(resting%plan, resting%state, resting%linearisation%motion, variation)
        shape = shape + equilibrium%modes%shapes(i, mode)*variation%q/resting%plan%result_unit
      end do
    end associate
    largest = maxloc(abs(shape), dim=1)
    ! the root of a motor that moves nothing
    if (.not. abs(shape(largest)) > 0.0_wp) return
    shape = shape/shape(largest)
    shape(largest) = (1.0_wp, 0.0_wp)
  end subroutine shape_of_mode

  !> The share of each free coordinate in the kinetic energy of a mode, over a period; the sum is 1. Other coordinates have none.
  pure subroutine energy_shares(equilibrium, mode, shares)
    type(equilibrium_type), intent(in) :: equilibrium   !< with its modes
    integer, intent(in) :: mode                         !< number of the mode
    real(wp), intent(out) :: shares(:)                  !< (M)
    complex(wp) :: momenta(size(equilibrium%resting%free))

    shares = 0.0_wp
    associate (x => equilibrium%modes%shapes(:, mode), free => equilibrium%resting%free)
      momenta = matmul(equilibrium%inertia, x)
      shares(free) = real(conjg(x)*momenta, wp)
      if (sum(shares(free)) > 0.0_wp) shares(free) = shares(free)/sum(shares(free))
    end associate
  end subroutine energy_shares

  !> The displacement of the free coordinates in a vibration.
  pure function displacement(equilibrium, mode, amplitude, phase)
    type(equilibrium_type), intent(in) :: equilibrium      !< with its modes
    integer, intent(in) :: mode                            !< number of the mode
    real(wp), intent(in) :: amplitude                      !< of the largest free coordinate [rad, lengths of the mechanism]
    real(wp), intent(in) :: phase                          !< [rad]
    real(wp) :: displacement(size(equilibrium%resting%free))
    complex(wp) :: step(size(equilibrium%resting%free))

    associate (resting => equilibrium%resting)
      step = equilibrium%modes%shapes(:, mode)/resting%plan%unit_of(resting%free)
      step = step*exp(cmplx(0.0_wp, phase, wp))*(amplitude/maxval(abs(step)))
      displacement = real(step, wp)
    end associate
  end function displacement

  !> A position beside an equilibrium, as in a vibration. `found` is false where the mechanism cannot go so far.
  subroutine position_in_vibration(mechanism, equilibrium, step, position, found, err)
    type(mechanism_type), intent(in) :: mechanism          !< the mechanism
    type(equilibrium_type), intent(in) :: equilibrium      !< the equilibrium
    real(wp), intent(in) :: step(:)                        !< (n) displacement of its free coordinates
    type(state_type), intent(out) :: position              !< closed
    logical, intent(out) :: found                          !< the position exists
    type(error_type), allocatable, intent(out) :: err      !< allocated if a load failed
    class(resting_type), allocatable :: other

    allocate (other)
    call try_step(mechanism, equilibrium%resting, step, other, found, err)
    if (found) call close_gaps(mechanism, equilibrium%resting, other, found, err)
    if (found) position = other%state
  end subroutine position_in_vibration
end module mech9_mode_shapes
