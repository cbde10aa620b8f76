!> The text of a check behind the mobility: what the data file gives, and the assembled start.
module mech9_check_text
  use mech9_model, only: model_type
  use mech9_part_names, only: name_in
  use mech9_result_units, only: unit_of
  use mech9_turning_plane, only: turning_plane_type, find_turning_plane
  use mech9_plan, only: plan_type
  use mech9_state, only: state_type
  use mech9_start_path, only: start_way_type
  use mech9_geometry_text, only: print_dimensions
  use mech9_held_text, only: print_held
  use mech9_parameter_text, only: print_parameters, print_parameter_notes
  use mech9_check_notes, only: print_notes
  use mech9_start_way_text, only: print_start_way
  use mech9_stop_text, only: print_stops
  use mech9_friction_text, only: print_frictions
  use mech9_contact_text, only: print_contacts
  use mech9_turning_text, only: print_turning
  use mech9_force_text, only: print_uniqueness, print_forceless, print_across
  use mech9_force_record, only: force_record_type, reacting_pairs
  implicit none
  private
  public :: print_given, print_start

contains

  !> Print the results of a check that need no assembly of the mechanism.
  subroutine print_given(unit, model, with_masses)
    integer, intent(in) :: unit                 !< the output unit
    type(model_type), intent(in) :: model       !< the model
    logical, intent(in) :: with_masses          !< bodies count in this program

    call print_held(unit, model)
    call print_parameter_notes(unit, model)
    call print_parameters(unit, model)
    call print_dimensions(unit, model%mechanism)
    call print_notes(unit, model, with_masses)
  end subroutine print_given

  !> Print the assembled start: how it was reached, its coordinates, and what is known about the forces that are requested.
  subroutine print_start(unit, model, plan, start, way)
    integer, intent(in) :: unit                 !< the output unit
    type(model_type), intent(in) :: model       !< the model
    type(plan_type), intent(in) :: plan         !< the plan of the mechanism
    type(state_type), intent(in) :: start       !< assembled position
    type(start_way_type), intent(in) :: way     !< how the start was reached from the drawn position
    character(len=16) :: name
    integer :: k

    call print_start_way(unit, model%mechanism, way)
    write (unit, '(a)') 'assembled at the start:'
    do k = 1, size(model%mechanism%pairs)
      write (name, '(a,i0)') 'q', k
      write (unit, '(2x,a8,es24.16,a)') name, start%q(k)/unit_of(model%mechanism, k), &
        behind(name_in(model%mechanism%names%coordinates, k))
    end do
    call print_stops(unit, model%mechanism, start)
    call print_frictions(unit, model%mechanism)
    call print_contacts(unit, model%mechanism, plan, start)
    call print_turning(unit, model)
    call print_forces(unit, model, plan, start)
  end subroutine print_start

  !> A name behind a number; empty where there is none.
  pure function behind(name) result(text)
    character(len=*), intent(in) :: name     !< of a coordinate; blank: none
    character(len=:), allocatable :: text

    text = ''
    if (name /= '') text = '  '//trim(name)
  end function behind

  !> Print what is known about the forces that the model requests.
  subroutine print_forces(unit, model, plan, start)
    integer, intent(in) :: unit             !< the output unit
    type(model_type), intent(in) :: model   !< the model
    type(plan_type), intent(in) :: plan     !< its plan
    type(state_type), intent(in) :: start   !< assembled position
    type(force_record_type) :: forces
    type(turning_plane_type) :: plane

    if (.not. model%request%output%with_forces()) return
    call print_forceless(unit, model%mechanism)
    call forces%judge(model, plan, start)
    if (.not. allocated(forces%unique)) return
    call print_uniqueness(unit, model%mechanism%names, reacting_pairs(model), forces%unique, &
                          model%request%output%reactions_in_links)
    call find_turning_plane(model%mechanism%structure, model%mechanism%pairs, plane)
    if (plane%found) call print_across(unit, plane%normal(:, 1), reacting_pairs(model), forces%unique)
  end subroutine print_forces
end module mech9_check_text
