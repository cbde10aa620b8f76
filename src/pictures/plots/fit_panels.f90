!> The panels of a plot that show how a design meets the targets of an objective.
module mech9_fit_panels
  use mech9_kinds, only: wp
  use mech9_error, only: error_type
  use mech9_text, only: to_text
  use mech9_model, only: model_type
  use mech9_part_names, only: name_in
  use mech9_result_units, only: unit_of, unit_name
  use mech9_objective, only: path_objective, function_objective, pose_objective, timing_over
  use mech9_fit_script, only: fit_panel_type
  use mech9_synthesis, only: synthesis_type
  use mech9_design_motion, only: design_motion_type
  implicit none
  private
  public :: append_panels, name_of_objective

  !> Places of a curve.
  integer, parameter :: samples = 720

  !> The design on its way, and at the targets.
  type :: visited_type
    real(wp), allocatable :: times(:)               !< (n) [s]
    real(wp), allocatable :: places(:, :)           !< (3,n) [m]
    real(wp), allocatable :: directions(:, :)       !< (3,n) of the x axis of the link
    real(wp), allocatable :: q(:, :)                !< (M,n) [rad, m]
  end type visited_type

contains

  !> Append the panels of an objective. A path and poses have the plane, or the three planes; a function has its curve
  !> and the differences at the targets.
  subroutine append_panels(motion, synthesis, number, name, panels, err)
    type(design_motion_type), intent(inout), target :: motion        !< of the best design
    type(synthesis_type), intent(in) :: synthesis                    !< with its targets, and its optima, best first
    integer, intent(in) :: number                                    !< of the objective
    character(len=*), intent(in) :: name                             !< of the objective
    type(fit_panel_type), allocatable, intent(inout) :: panels(:)    !< gets them
    type(error_type), allocatable, intent(out) :: err                !< allocated if it failed
    type(visited_type) :: way, met
    integer, allocatable :: chosen(:)
    integer :: i

    chosen = pack([(i, i=1, size(synthesis%targets))], synthesis%targets%objective == number)
    associate (time => motion%model%request%time)
      call visit(motion, number, [(time%start + (time%end - time%start)*i/samples, i=0, samples)], way, err)
    end associate
    if (.not. allocated(err)) call visit_unordered(motion, number, synthesis%optima(1)%times(chosen), met, err)
    if (allocated(err)) return
    associate (objective => motion%model%request%objectives(number))
      if (objective%kind == function_objective) then
        call append_function(motion%model, number, way, met, panels)
      else
        call append_plane(motion%model, number, name, [1, 2], way, met, panels)
        if (objective%components < 3) return
        call append_plane(motion%model, number, name, [1, 3], way, met, panels)
        call append_plane(motion%model, number, name, [2, 3], way, met, panels)
      end if
    end associate
  end subroutine append_panels

  !> The name of an objective with targets; empty where it has none.
  function name_of_objective(model, number) result(name)
    type(model_type), intent(in) :: model    !< with its objectives
    integer, intent(in) :: number            !< of the objective
    character(len=:), allocatable :: name

    associate (objective => model%request%objectives(number))
      select case (objective%kind)
      case (path_objective)
        name = model%mechanism%points(objective%point)%name
      case (function_objective)
        name = 'q'//to_text(objective%coordinate)
      case (pose_objective)
        name = 'link'//to_text(objective%link)
      case default
        name = ''
      end select
    end associate
  end function name_of_objective

  !> Visit times in their order.
  subroutine visit(motion, number, times, visited, err)
    type(design_motion_type), intent(inout), target :: motion !< the motion
    integer, intent(in) :: number                             !< of the objective
    real(wp), intent(in) :: times(:)                          !< from the start of the run on [s]
    type(visited_type), intent(out) :: visited                !< the design at these times
    type(error_type), allocatable, intent(out) :: err         !< allocated if it failed
    integer :: link
    real(wp) :: point(3)

    link = 1
    point = 0.0_wp
    associate (objective => motion%model%request%objectives(number))
      if (objective%kind == pose_objective) link = objective%link
      if (objective%kind == path_objective) then
        link = motion%model%mechanism%points(objective%point)%link
        point = motion%model%mechanism%points(objective%point)%position
      end if
    end associate
    visited%times = times
    allocate (visited%places(3, size(times)), visited%directions(3, size(times)))
    allocate (visited%q(motion%run%motion%plan%n_coordinates, size(times)))
    call motion%visit(times, link, point, visited%places, visited%directions, visited%q, err)
  end subroutine visit

  !> Visit times in any order.
  subroutine visit_unordered(motion, number, times, visited, err)
    type(design_motion_type), intent(inout), target :: motion !< the motion
    integer, intent(in) :: number                             !< of the objective
    real(wp), intent(in) :: times(:)                          !< of its targets [s]
    type(visited_type), intent(out) :: visited                !< the design at these times, in their order
    type(error_type), allocatable, intent(out) :: err         !< allocated if it failed
    type(visited_type) :: sorted
    integer :: order(size(times)), i, j

    do i = 1, size(times)
      j = count((times - times(i))*(motion%model%request%time%end - motion%model%request%time%start) < 0.0_wp) &
          + count(abs(times(:i) - times(i)) <= 0.0_wp)
      order(j) = i
    end do
    call visit(motion, number, times(order), sorted, err)
    if (allocated(err)) return
    visited = sorted
    visited%times(order) = sorted%times
    visited%places(:, order) = sorted%places
    visited%directions(:, order) = sorted%directions
    visited%q(:, order) = sorted%q
  end subroutine visit_unordered

  !> Append the panel of two axes of space.
  subroutine append_plane(model, number, name, axes, way, met, panels)
    type(model_type), intent(in) :: model                            !< of the design
    integer, intent(in) :: number                                    !< of the objective
    character(len=*), intent(in) :: name                             !< of the objective
    integer, intent(in) :: axes(2)                                   !< numbers of the axes
    type(visited_type), intent(in) :: way                            !< the design on its way
    type(visited_type), intent(in) :: met                            !< the design at the targets
    type(fit_panel_type), allocatable, intent(inout) :: panels(:)    !< gets the panel
    character, parameter :: letters(3) = ['x', 'y', 'z']
    type(fit_panel_type) :: panel
    real(wp) :: direction(3)
    integer :: i

    associate (objective => model%request%objectives(number))
      panel%title = name//' and its '//to_text(size(met%times))//' targets'
      panel%x_label = name//'.'//letters(axes(1))//' ['//trim(model%mechanism%units%length_name)//']'
      panel%y_label = name//'.'//letters(axes(2))//' ['//trim(model%mechanism%units%length_name)//']'
      panel%equal_scales = .true.
      panel%curve = transpose(way%places(axes, :))
      allocate (panel%targets(size(met%times), 4), panel%reached(size(met%times), 4), source=0.0_wp)
      panel%targets(:, :2) = transpose(objective%targets(axes, :))
      panel%reached(:, :2) = transpose(met%places(axes, :))
      if (objective%kind == pose_objective) then
        do i = 1, size(met%times)
          direction = turned_x(objective%turns(:, i))
          panel%targets(i, 3:) = direction(axes)
        end do
        panel%reached(:, 3:) = transpose(met%directions(axes, :))
      end if
    end associate
    associate (unit => model%mechanism%units%length)
      panel%curve = panel%curve/unit
      panel%targets(:, :2) = panel%targets(:, :2)/unit
      panel%reached(:, :2) = panel%reached(:, :2)/unit
    end associate
    panels = [panels, panel]
  end subroutine append_plane

  !> The x axis, turned by a rotation vector.
  pure function turned_x(vector) result(direction)
    real(wp), intent(in) :: vector(3)    !< its length is the angle [rad]
    real(wp) :: direction(3), axis(3), angle

    direction = [1.0_wp, 0.0_wp, 0.0_wp]
    angle = norm2(vector)
    if (.not. angle > 0.0_wp) return
    axis = vector/angle
    direction = cos(angle)*direction + sin(angle)*[0.0_wp, axis(3), -axis(2)] + (1.0_wp - cos(angle))*axis(1)*axis
  end function turned_x

  !> The column of a coordinate, by the name of its pair where that has one: B.q.
  pure function column_of(model, coordinate) result(name)
    type(model_type), intent(in) :: model      !< of the design
    integer, intent(in) :: coordinate          !< number of the coordinate
    character(len=:), allocatable :: name

    name = 'q'//to_text(coordinate)
    if (name_in(model%mechanism%names%coordinates, coordinate) /= '') &
      name = trim(name_in(model%mechanism%names%coordinates, coordinate))//'.q'
  end function column_of

  !> Append the panels of a function: its curve with the targets, and the differences at the targets.
  subroutine append_function(model, number, way, met, panels)
    type(model_type), intent(in) :: model                            !< of the design
    integer, intent(in) :: number                                    !< of the objective
    type(visited_type), intent(in) :: way                            !< the design on its way
    type(visited_type), intent(in) :: met                            !< the design at the targets
    type(fit_panel_type), allocatable, intent(inout) :: panels(:)    !< gets the panels
    type(fit_panel_type) :: panel, errors
    character(len=:), allocatable :: name
    real(wp) :: x(size(way%times)), at(size(met%times)), unit
    integer :: n

    associate (objective => model%request%objectives(number))
      n = size(met%times)
      unit = unit_of(model%mechanism, objective%coordinate)
      name = column_of(model, objective%coordinate)
      x = way%times
      at = met%times
      panel%x_label = 't [s]'
      if (objective%timing == timing_over) then
        x = way%q(objective%over, :)/unit_of(model%mechanism, objective%over)
        at = objective%at/unit_of(model%mechanism, objective%over)
        panel%x_label = column_of(model, objective%over)//' ['//trim(unit_name(model%mechanism, objective%over))//']'
      end if
      panel%title = name//' and its '//to_text(n)//' targets'
      panel%y_label = name//' ['//trim(unit_name(model%mechanism, objective%coordinate))//']'
      panel%curve = reshape([x, way%q(objective%coordinate, :)/unit], [size(x), 2])
      allocate (panel%targets(n, 4), panel%reached(n, 4), source=0.0_wp)
      panel%targets(:, 1) = at
      panel%targets(:, 2) = objective%targets(1, :)/unit
      panel%reached(:, 1) = at
      panel%reached(:, 2) = met%q(objective%coordinate, :)/unit
    end associate
    errors = panel
    errors%is_error = .true.
    errors%title = 'differences at the targets'
    errors%targets(:, 2) = panel%reached(:, 2) - panel%targets(:, 2)
    panels = [panels, panel, errors]
  end subroutine append_function
end module mech9_fit_panels
