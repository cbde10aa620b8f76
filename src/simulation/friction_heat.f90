!> The energies that frictions take in a motion.
module mech9_friction_heat
  use mech9_kinds, only: wp
  use mech9_simulation_tolerances, only: shortest_step
  use mech9_error, only: error_type
  use mech9_integrated_motion, only: integrated_motion_type
  implicit none
  private
  public :: take_heat, show_heat

contains

  !> Add the energies that frictions take in the last step.
  subroutine take_heat(motion, err)
    type(integrated_motion_type), intent(inout) :: motion   !< the motion at the end of a step; its system may stand elsewhere afterwards
    type(error_type), allocatable, intent(out) :: err      !< allocated if it failed
    real(wp) :: heat(size(motion%heat))

    motion%heat_before = motion%heat
    call find_heat(motion, motion%t, heat, err)
    if (.not. allocated(err)) motion%heat = heat
  end subroutine take_heat

  !> The energies that frictions have taken up to a time within the last step, by Gauss' formula with four points: as exact in the length
  !> of a step as its motion.
  subroutine find_heat(motion, t, heat, err)
    type(integrated_motion_type), intent(inout) :: motion   !< the motion; its system may stand elsewhere afterwards
    real(wp), intent(in) :: t                              !< the time [s]
    real(wp), intent(out) :: heat(:)                       !< (frictions) the energies [J]
    type(error_type), allocatable, intent(out) :: err      !< allocated if it failed
    real(wp), parameter :: places(2) = [0.33998104358485626_wp, 0.86113631159405258_wp]
    real(wp), parameter :: weights(2) = [0.65214515486254614_wp, 0.34785484513745386_wp]
    real(wp) :: from, y(size(motion%y))
    integer :: i, side
    logical :: found

    heat = motion%heat_before
    call motion%dense_output%start_of_step(from, y)
    if (.not. motion%system%friction%modes%any_slips() .and. .not. any(motion%system%model%mechanism%frictions%is_smooth)) return
    ! round-off hides the points within so short a step
    if (abs(t - from) < shortest_step*spacing(t)) then
      heat = heat + (t - from)*motion%system%friction%heat_rate
      return
    end if
    do i = 1, 2
      do side = -1, 1, 2
        call motion%look_between(from + 0.5_wp*(1.0_wp + side*places(i))*(t - from), found)
        if (.not. found) call motion%system%move_to(motion%t, motion%y, err)
        if (allocated(err)) return
        heat = heat + 0.5_wp*(t - from)*weights(i)*motion%system%friction%heat_rate
      end do
    end do
  end subroutine find_heat

  !> Let the state at a time within the last step show the energies that frictions have taken.
  subroutine show_heat(motion, t, found, err)
    type(integrated_motion_type), intent(inout) :: motion   !< the motion; its system stands at the time before and after
    real(wp), intent(in) :: t                               !< the time [s]
    logical, intent(out) :: found                           !< the motion there was found again
    type(error_type), allocatable, intent(out) :: err       !< allocated if it failed
    real(wp) :: heat(size(motion%heat))

    found = .false.
    call find_heat(motion, t, heat, err)
    if (allocated(err)) return
    call motion%look_between(t, found)
    motion%system%state%heat = heat
  end subroutine show_heat
end module mech9_friction_heat
