!> The part of a report that has a motion at one instant in the terms of mechanics, as JSON (docs/reference/results.md).
module mech9_instant_report
  use mech9_kinds, only: wp
  use mech9_error, only: error_type
  use mech9_text, only: to_text
  use mech9_mechanism, only: mechanism_type
  use mech9_model, only: model_type
  use mech9_plan, only: plan_type
  use mech9_state, only: state_type
  use mech9_result_units, only: unit_of, si_force, force_unit_name, inertia_unit_of, inertia_unit_name
  use mech9_partition, only: partition_type
  use mech9_driven_simulation, only: driven_simulation_type
  use mech9_free_simulation, only: free_simulation_type
  use mech9_motion_in_space, only: partition_with_angles
  use mech9_instant, only: instant_type, find_instant
  use mech9_forces_by_kind, only: kind_names
  use mech9_run, only: run_type
  use mech9_explanation, only: explain
  use mech9_json, only: json_type
  implicit none
  private
  public :: add_instant, add_coefficients

contains

  !> Add mass matrix, Jacobians and generalized forces of a run at one instant. A run over time has none of them.
  subroutine add_instant(json, model, run)
    type(json_type), intent(inout) :: json     !< the report, inside its object
    type(model_type), intent(in) :: model      !< the model
    type(run_type), intent(in) :: run          !< the run, as far as it went
    type(plan_type), pointer :: plan
    type(state_type), pointer :: state
    type(partition_type) :: partition
    type(instant_type) :: instant
    type(error_type), allocatable :: err

    if (model%request%time%intervals > 0 .or. .not. allocated(run%motion%simulation)) return
    if (.not. run%motion%simulation%started) return
    call run%motion%simulation%present(plan, state)
    select type (simulation => run%motion%simulation)
    type is (driven_simulation_type)
      call partition_with_angles(model%problem, simulation%angles%held, partition)
    type is (free_simulation_type)
      call partition_with_angles(model%problem, simulation%motion%angles%held, partition)
    end select
    call find_instant(model, partition, run%motion%start%q, state, instant, err)
    if (allocated(err)) then
      call explain(err)
      call json%add('jacobian_error', err%message)
      return
    end if
    call add_jacobians(json, model%mechanism, instant)
    if (.not. instant%has_forces) return
    select type (simulation => run%motion%simulation)
    type is (driven_simulation_type)
      ! the report of a free motion has them at its start
      call add_coefficients(json, model%mechanism, instant%moving, instant%inertia)
    end select
    call add_dynamics(json, model%mechanism, instant)
  end subroutine add_instant

  !> Add the coefficients of motion: [{"p": 1, "r": 5, "value": ...}, ...]
  subroutine add_coefficients(json, mechanism, numbers, coefficients)
    type(json_type), intent(inout) :: json          !< the report, inside its object
    type(mechanism_type), intent(in) :: mechanism   !< the mechanism
    integer, intent(in) :: numbers(:)               !< (I) of the independent coordinates
    real(wp), intent(in) :: coefficients(:, :)      !< (I,I) a(p,r), in their order; the lower triangle counts
    integer :: p, r

    call json%begin_array('coefficients')
    do p = 1, size(numbers)
      do r = p, size(numbers)
        call json%begin_object()
        call json%add('p', numbers(p))
        call json%add('r', numbers(r))
        call json%add('value', coefficients(r, p)/inertia_unit_of(mechanism, numbers(p), numbers(r)))
        call json%end_object()
      end do
    end do
    call json%end_array()
  end subroutine add_coefficients

  !> Add the Jacobians, with the names of their rows and columns.
  subroutine add_jacobians(json, mechanism, instant)
    type(json_type), intent(inout) :: json             !< the report, inside its object
    type(mechanism_type), intent(in) :: mechanism      !< the mechanism
    type(instant_type), intent(in) :: instant          !< the motion at the instant
    real(wp) :: units(size(instant%independent)), rows(size(instant%dependent), size(instant%independent))
    integer :: i, k

    units = [(unit_of(mechanism, instant%independent(i)), i=1, size(units))]
    call add_coordinates(json, 'jacobian_coordinates', instant%independent)
    call add_coordinates(json, 'dependent_coordinates', instant%dependent)
    do i = 1, size(rows, 1)
      rows(i, :) = instant%rates(i, :)*units/unit_of(mechanism, instant%dependent(i))
    end do
    call add_rows(json, 'dependent_jacobian', rows)
    call json%begin_object('point_jacobians')
    do k = 1, size(mechanism%points)
      call add_rows(json, mechanism%points(k)%name, &
                    instant%points(:, :, k)*spread(units, 1, 3)/mechanism%units%length)
    end do
    call json%end_object()
  end subroutine add_jacobians

  !> Add the mass matrix and the generalized forces, with the coordinates to which they belong and their units.
  subroutine add_dynamics(json, mechanism, instant)
    type(json_type), intent(inout) :: json             !< the report, inside its object
    type(mechanism_type), intent(in) :: mechanism      !< the mechanism
    type(instant_type), intent(in) :: instant          !< the motion at the instant
    real(wp) :: matrix(size(instant%moving), size(instant%moving))
    integer :: i, j, kind

    associate (moving => instant%moving, independent => instant%independent)
      do j = 1, size(moving)
        do i = 1, size(moving)
          matrix(i, j) = instant%inertia(i, j)/inertia_unit_of(mechanism, moving(i), moving(j))
        end do
      end do
      call add_coordinates(json, 'mass_matrix_coordinates', moving)
      call add_rows(json, 'mass_matrix', matrix)
      call json%begin_array('mass_matrix_units')
      do i = 1, size(moving)
        call json%begin_array()
        do j = 1, size(moving)
          call json%add(trim(inertia_unit_name(mechanism, moving(i), moving(j))))
        end do
        call json%end_array()
      end do
      call json%end_array()
      call json%add('bias', instant%bias/[(force_unit(mechanism, moving(i)), i=1, size(moving))])
      call json%begin_object('generalized_forces')
      call add_coordinates(json, 'coordinates', independent)
      call json%begin_array('units')
      do i = 1, size(independent)
        call json%add(trim(force_unit_name(mechanism, independent(i))))
      end do
      call json%end_array()
      do kind = 1, size(kind_names)
        call json%add(trim(kind_names(kind)), &
                      instant%forces(:, kind)/[(force_unit(mechanism, independent(i)), i=1, size(independent))])
      end do
      call json%end_object()
    end associate
  end subroutine add_dynamics

  !> One unit of a generalized force in the results, in N m or N.
  pure real(wp) function force_unit(mechanism, k)
    type(mechanism_type), intent(in) :: mechanism   !< the mechanism
    integer, intent(in) :: k                        !< number of the coordinate

    force_unit = mechanism%units%size_of(trim(si_force(mechanism%pairs(k)%pair)))
  end function force_unit

  !> Add the names of coordinates, as columns have them.
  subroutine add_coordinates(json, name, numbers)
    type(json_type), intent(inout) :: json       !< the report, inside an object
    character(len=*), intent(in) :: name         !< of the list
    integer, intent(in) :: numbers(:)            !< of the coordinates
    integer :: i

    call json%begin_array(name)
    do i = 1, size(numbers)
      call json%add('q'//to_text(numbers(i)))
    end do
    call json%end_array()
  end subroutine add_coordinates

  !> Add a matrix as a list of its rows.
  subroutine add_rows(json, name, matrix)
    type(json_type), intent(inout) :: json       !< the report, inside an object
    character(len=*), intent(in) :: name         !< of the matrix
    real(wp), intent(in) :: matrix(:, :)         !< the matrix
    integer :: i, j

    call json%begin_array(name)
    do i = 1, size(matrix, 1)
      call json%begin_array()
      do j = 1, size(matrix, 2)
        call json%add(matrix(i, j))
      end do
      call json%end_array()
    end do
    call json%end_array()
  end subroutine add_rows
end module mech9_instant_report
