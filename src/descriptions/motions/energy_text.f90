!> Words for the change of the energies of a motion: the error of a motion that keeps its energy, or the work of what acts on it.
module mech9_energy_text
  use mech9_kinds, only: wp
  use mech9_force_load, only: force_load_type
  use mech9_coordinate_load, only: coordinate_load_type
  use mech9_spring_load, only: spring_load_type
  use mech9_model, only: model_type
  implicit none
  private
  public :: words_of_energy_change

contains

  !> The name of the largest change of the sum of energies: work where something does work, such as a drive or a damper.
  function words_of_energy_change(model) result(words)
    type(model_type), intent(in) :: model   !< the model
    character(len=:), allocatable :: words
    logical :: damped, loaded

    call judge_loads(model, damped, loaded)
    associate (mechanism => model%mechanism)
      loaded = loaded .or. size(mechanism%stops) > 0 .or. mechanism%has_frictions() .or. mechanism%has_contacts()
      damped = damped .or. any(model%problem%has_drive()) .or. size(mechanism%motors) > 0
    end associate
    if (damped .and. loaded) then
      words = 'work of drives, motors and dampers, of loads, impacts and friction up to'
    else if (damped) then
      words = 'work of drives, motors and dampers up to'
    else if (loaded) then
      words = 'work of loads, impacts and friction up to'
    else
      words = 'largest change of energy'
    end if
  end function words_of_energy_change

  !> Find which kinds of loads a mechanism has: dampers, and loads without a potential energy.
  subroutine judge_loads(model, damped, loaded)
    type(model_type), intent(in) :: model   !< the model
    logical, intent(out) :: damped          !< a spring or a load on a coordinate has damping
    logical, intent(out) :: loaded          !< there is a load without a potential energy
    integer :: i

    damped = .false.
    loaded = .false.
    do i = 1, size(model%mechanism%loads)
      select type (load => model%mechanism%loads(i)%load)
      class is (coordinate_load_type)
        damped = damped .or. abs(load%damping) > 0.0_wp
        loaded = loaded .or. .not. load%has_potential() .or. (abs(load%force) > 0.0_wp .and. .not. allocated(load%over))
      class is (spring_load_type)
        damped = damped .or. abs(load%damping) > 0.0_wp
        loaded = loaded .or. allocated(load%law) .or. allocated(load%over)
      class is (force_load_type)
        loaded = loaded .or. .not. load%is_idle()
      class default
        loaded = .true.
      end select
    end do
  end subroutine judge_loads
end module mech9_energy_text
