!> The distinct designs of a synthesis as data sets: the group `optimum`.
module mech9_optimum_layout
  use mech9_kinds, only: wp
  use mech9_text, only: string_type
  use mech9_model, only: model_type
  use mech9_objective, only: function_objective
  use mech9_result_units, only: unit_of, unit_of_parameter
  use mech9_data_set_store, only: data_set_store_type
  use mech9_synthesis, only: synthesis_type
  implicit none
  private
  public :: write_optima

contains

  !> Write the distinct designs, best first, with how many starts were made. Failures are those of the storage.
  subroutine write_optima(store, model, synthesis)
    class(data_set_store_type), intent(inout) :: store   !< the open storage, with the scales of coordinates and targets
    type(model_type), intent(in) :: model              !< the model
    type(synthesis_type), intent(in) :: synthesis      !< with its optima, best first
    type(string_type) :: names(size(model%parameters))
    real(wp), allocatable :: values(:, :)
    integer :: i, n

    n = size(synthesis%optima)
    call store%put('optimum/made', synthesis%done, 'starts that were made')
    call store%put('optimum/reached', synthesis%reached, 'starts that led to a design')
    call write_targets(store, model, synthesis)
    call store%put('design', [(i, i=1, n)], 'number of the distinct design, the best one first')
    call store%make_scale('design')
    call put_over_designs('value', [(synthesis%optima(i)%value, i=1, n)], 'value of the objectives', '')
    call store%put('optimum/starts', [(synthesis%optima(i)%starts, i=1, n)], 'starts that led to the design')
    call store%attach_scales('optimum/starts', ['/design'])
    allocate (values(n, size(model%parameters)))
    do i = 1, n
      values(i, :) = synthesis%values_of(i)
    end do
    do i = 1, size(model%parameters)
      names(i)%text = model%parameters(i)%name
      call put_over_designs('parameters/'//model%parameters(i)%name, values(:, i), 'parameter '//model%parameters(i)%name, &
                            trim(unit_of_parameter(model%mechanism, model%parameters(i))))
    end do
    call store%put('parameter', names, 'names of the parameters in their order')
    call store%make_scale('parameter')
    call write_positions(store, model, synthesis)
  contains
    !> Write one number of each design.
    subroutine put_over_designs(name, numbers, long_name, unit)
      character(len=*), intent(in) :: name         !< in the group
      real(wp), intent(in) :: numbers(:)           !< (designs)
      character(len=*), intent(in) :: long_name    !< a few words that describe it
      character(len=*), intent(in) :: unit         !< its unit; empty: none is known

      call store%put('optimum/'//name, numbers, long_name, unit)
      call store%attach_scales('optimum/'//name, ['/design'])
    end subroutine put_over_designs
  end subroutine write_optima

  !> Write the coordinates of the designs at the start of the run, and the times of their targets.
  subroutine write_positions(store, model, synthesis)
    class(data_set_store_type), intent(inout) :: store   !< the open storage
    type(model_type), intent(in) :: model              !< the model
    type(synthesis_type), intent(in) :: synthesis      !< with its optima
    real(wp) :: q(synthesis%space%plan%n_coordinates, size(synthesis%optima))
    real(wp) :: times(size(synthesis%targets), size(synthesis%optima))
    integer :: i, k

    do i = 1, size(synthesis%optima)
      q(:, i) = synthesis%optima(i)%q/[(unit_of(model%mechanism, k), k=1, size(q, 1))]
      times(:, i) = synthesis%optima(i)%times
    end do
    call store%put('optimum/coordinates', q, 'coordinates of its assembly at the start of the run, each in its unit')
    call store%attach_scales('optimum/coordinates', ['/design    ', '/coordinate'])
    if (size(times, 1) == 0) return
    call store%put('optimum/times', times, 'times at which it meets its targets', 's')
    call store%attach_scales('optimum/times', ['/design', '/target'])
  end subroutine write_positions

  !> Write the targets, in the units of the data file.
  subroutine write_targets(store, model, synthesis)
    class(data_set_store_type), intent(inout) :: store   !< the open storage
    type(model_type), intent(in) :: model              !< the model
    type(synthesis_type), intent(in) :: synthesis      !< with its targets
    character(len=*), parameter :: axis_names = 'xyz'
    type(string_type) :: axes(3)
    real(wp) :: places(3, size(synthesis%targets))
    integer :: i

    if (size(synthesis%targets) == 0) return
    do i = 1, 3
      axes(i)%text = axis_names(i:i)
    end do
    call store%put('axis', axes, 'axis of the fixed frame')
    call store%make_scale('axis')
    do i = 1, size(synthesis%targets)
      associate (objective => model%request%objectives(synthesis%targets(i)%objective))
        places(:, i) = synthesis%targets(i)%place
        if (objective%kind == function_objective) then
          places(1, i) = places(1, i)/unit_of(model%mechanism, objective%coordinate)
        else
          places(:, i) = places(:, i)/model%mechanism%units%length
        end if
      end associate
    end do
    call store%put('targets/objective', [(synthesis%targets(i)%objective, i=1, size(synthesis%targets))], &
                  'number of the objective to which the target belongs')
    call store%attach_scales('targets/objective', ['/target'])
    call store%put('targets/place', places, 'place of the target, or its value of a function in the first number', &
                  model%mechanism%units%angle_name//','//trim(model%mechanism%units%length_name))
    call store%attach_scales('targets/place', ['/target', '/axis  '])
  end subroutine write_targets
end module mech9_optimum_layout
