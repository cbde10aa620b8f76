!> The columns of kinematic results: names, units, and a row of numbers from a state of motion.
module mech9_columns
  use mech9_kinds, only: wp
  use mech9_error, only: error_type
  use mech9_text, only: string_type, to_text
  use mech9_request, only: output_settings_type
  use mech9_motor, only: motor_action_type
  use mech9_mechanism, only: mechanism_type
  use mech9_units, only: units_type
  use mech9_result_units, only: si_unit, si_force
  use mech9_plan, only: plan_type
  use mech9_state, only: state_type
  use mech9_motor_states, only: find_action
  use mech9_motion_changes, only: motion_changes_type
  use mech9_column_list, only: column_list_type
  use mech9_derivative_columns, only: derivative_columns_type, new_derivative_columns
  use mech9_poses, only: poses_type, poses_of
  use mech9_frame_motion, only: point_motion
  implicit none
  private
  public :: columns_type, kinematic_columns

  !> Time, the recorded coordinates, their rates, their accelerations, and columns for each point: as many
  !> derivatives as are recorded.
  type, extends(column_list_type) :: columns_type
    integer, allocatable :: coordinates(:)  !< numbers of the recorded ones, ascending
    integer :: derivatives = 2              !< highest derivative that is recorded
    integer :: motion = 0                   !< how many columns, the first ones, belong to time, coordinates and points
    integer, allocatable :: drives(:)       !< driven coordinates whose forces have columns, ascending
    integer, allocatable :: reacting(:)     !< pairs whose wrenches have columns, ascending
    integer :: couplings = 0                !< how many couplings have columns of their forces, after those of pairs
    integer :: motors = 0                   !< how many columns belong to motors, after those of forces
    integer :: energies = 0                 !< how many columns belong to energies, after those of motors
    integer :: magnitudes = 0               !< how many columns belong to magnitudes of wrenches, after those of energies
    integer :: links = 0                    !< how many columns belong to links, after those of magnitudes
    integer :: stops = 0                    !< how many columns belong to stops, after those of links
    logical :: in_links = .false.           !< wrenches of pairs are along the axes of the moving links; else of link 1
    integer :: frictions = 0                !< how many columns belong to frictions, after those of stops
    integer :: contacts = 0                 !< how many columns belong to contacts of links, after those of frictions
    integer :: varied = 0                   !< how many columns, from the second one on, have derivatives by parameters
    integer :: sensitivities = 0            !< how many columns, the last ones, are derivatives by parameters
    type(derivative_columns_type) :: derived    !< those of the motion
    type(string_type), allocatable :: parameters(:)   !< names of these parameters
    type(string_type), allocatable :: parameter_units(:)   !< their units; empty: not known, '1': plain numbers
    type(poses_type) :: poses               !< columns after the others, if they were requested
    integer :: varied_poses = 0             !< how many derivatives by parameters stand after the poses: of origins and rotations
    integer :: unrecorded = 0               !< how many derivatives by parameters stand after the poses, for quantities alone
  contains
    procedure :: convert
    procedure :: append_forces
    procedure :: forces
    procedure :: fill_forces
    procedure :: append_motors
    procedure :: fill_motors
    procedure :: before_stops
    procedure :: append_stops
    procedure :: fill_stops
    procedure :: append_frictions
    procedure :: fill_frictions
    procedure :: append_energies
    procedure :: append_sensitivities
    procedure :: find_unit_per
    procedure :: fill_sensitivities
    procedure :: fill_beyond_motion
    procedure :: fill_varied_poses
    procedure :: derivatives_of
    procedure :: order_in_table
    procedure :: width
    procedure :: family_of
    procedure :: fill
    procedure :: fill_poses
  end type columns_type

  character, parameter :: directions(3) = ['x', 'y', 'z']

contains

  !> The columns that every kinematic run records.
  function kinematic_columns(mechanism, output, units) result(columns)
    type(mechanism_type), intent(in) :: mechanism       !< the mechanism
    type(output_settings_type), intent(in) :: output    !< settings of the results
    type(units_type), intent(in), optional :: units     !< of the results; absent: those of the data file
    type(columns_type) :: columns
    character(len=4), parameter :: orders(3) = ['q   ', 'dq  ', 'ddq ']
    character(len=5), parameter :: per_time(3) = ['     ', '/s   ', '/s^2 ']
    character(len=2), parameter :: point_orders(3) = ['  ', 'v ', 'a ']
    integer :: i, k, n, order

    n = size(mechanism%pairs)
    allocate (columns%coordinates, source=pack([(k, k=1, n)], output%recorded(n)))
    columns%derivatives = output%derivatives
    n = size(columns%coordinates)
    columns%motion = 1 + (columns%derivatives + 1)*(n + 3*size(mechanism%points))
    allocate (columns%names(columns%motion), columns%units(columns%motion), columns%long_names(columns%motion))
    allocate (columns%scales(columns%motion), source=1.0_wp)
    columns%system = mechanism%units
    if (present(units)) columns%system = units
    if (output%poses) columns%poses = poses_of(mechanism)
    call columns%append('t', 's')
    do order = 1, columns%derivatives + 1
      do i = 1, n
        k = columns%coordinates(i)
        call columns%append_in(trim(orders(order))//to_text(k), trim(si_unit(mechanism%pairs(k)%pair))//trim(per_time(order)))
      end do
    end do
    do i = 1, size(mechanism%points)
      do order = 1, columns%derivatives + 1
        do k = 1, 3
          call columns%append_in(mechanism%points(i)%name//'.'//trim(point_orders(order))//directions(k), &
                                 'm'//trim(per_time(order)))
        end do
      end do
    end do
    columns%derived = new_derivative_columns(columns%coordinates, columns%scales(2:columns%motion), columns%derivatives, &
                                             size(mechanism%pairs), size(mechanism%points))
  end function kinematic_columns

  !> Append the columns of forces: of drives, then of pairs and couplings.
  pure subroutine append_forces(self, mechanism, drives, reacting)
    class(columns_type), intent(inout) :: self     !< the columns
    type(mechanism_type), intent(in) :: mechanism  !< the mechanism
    integer, intent(in) :: drives(:)               !< driven coordinates, ascending
    integer, intent(in) :: reacting(:)             !< pairs, by their coordinates, ascending
    character(len=4), parameter :: kinds(2) = ['f   ', 'm   ']
    integer :: i, j, k

    self%drives = drives
    self%reacting = reacting
    do i = 1, size(drives)
      call self%append_in('F'//to_text(drives(i)), si_force(mechanism%pairs(drives(i))%pair), &
                          'force of the drive of coordinate '//to_text(drives(i)))
    end do
    do i = 1, size(reacting)
      do j = 1, 2
        do k = 1, 3
          call self%append_in('R'//to_text(reacting(i))//'.'//trim(kinds(j))//directions(k), trim(merge('N  ', 'N m', j == 1)))
        end do
      end do
    end do
    if (size(reacting) == 0 .or. .not. allocated(mechanism%couplings)) return
    self%couplings = size(mechanism%couplings)
    do i = 1, self%couplings
      k = mechanism%couplings(i)%coupling%coordinates(2)
      call self%append_in('C'//to_text(i), si_force(mechanism%pairs(k)%pair), &
                          'force of coupling '//to_text(i)//' on coordinate '//to_text(k))
    end do
  end subroutine append_forces

  !> How many columns belong to forces.
  pure integer function forces(self)
    class(columns_type), intent(in) :: self  !< the columns

    forces = 0
    if (allocated(self%drives)) forces = size(self%drives) + 6*size(self%reacting) + self%couplings
  end function forces

  !> Fill the columns of forces in a row.
  pure subroutine fill_forces(self, needed, force, moment, coupled, row)
    class(columns_type), intent(in) :: self  !< the columns, some of forces
    real(wp), intent(in) :: needed(:)        !< (M) forces of drives [N m, N]
    real(wp), intent(in) :: force(:, :)      !< (3,M) of each pair [N]
    real(wp), intent(in) :: moment(:, :)     !< (3,M) of each pair [N m]
    real(wp), intent(in) :: coupled(:)       !< (couplings) of each on its second coordinate [N m, N]
    real(wp), intent(inout) :: row(:)        !< numbers of one row, one for each column
    integer :: i, at

    at = self%motion
    do i = 1, size(self%drives)
      row(at + i) = needed(self%drives(i))
    end do
    at = at + size(self%drives)
    do i = 1, size(self%reacting)
      row(at + 1:at + 3) = force(:, self%reacting(i))
      row(at + 4:at + 6) = moment(:, self%reacting(i))
      at = at + 6
    end do
    row(at + 1:at + self%couplings) = coupled(:self%couplings)
  end subroutine fill_forces

  !> Append the columns of motors: state and force of each.
  subroutine append_motors(self, mechanism)
    class(columns_type), intent(inout) :: self     !< the columns
    type(mechanism_type), intent(in) :: mechanism  !< the mechanism
    character(len=:), allocatable :: unit
    integer :: i

    self%motors = 2*size(mechanism%motors)
    do i = 1, size(mechanism%motors)
      associate (k => mechanism%motors(i)%motor%coordinate, state => mechanism%motors(i)%motor%kind_of_state())
        unit = state%unit
        if (state%by_coordinate) unit = trim(si_unit(mechanism%pairs(k)%pair))//' '//state%unit
        call self%append_in('M'//to_text(i)//'.'//trim(state%name), unit, trim(state%meaning)//' of motor '//to_text(i))
        call self%append_in('M'//to_text(i)//'.torque', si_force(mechanism%pairs(k)%pair), &
                            'force of motor '//to_text(i)//' on coordinate '//to_text(k))
      end associate
    end do
  end subroutine append_motors

  !> Fill the columns of motors in a row. Fails where the law of a motor has no value.
  subroutine fill_motors(self, mechanism, plan, state, row, err)
    class(columns_type), intent(in) :: self             !< the columns
    type(mechanism_type), intent(in) :: mechanism       !< the mechanism
    type(plan_type), intent(in) :: plan                 !< the plan in which the motion is given
    type(state_type), intent(in) :: state               !< motion of the mechanism, with the states of the motors
    real(wp), intent(inout) :: row(:)                   !< numbers of one row, one for each column
    type(error_type), allocatable, intent(out) :: err   !< allocated if it failed
    type(motor_action_type) :: action
    integer :: at, i

    do i = 1, self%motors/2
      call find_action(mechanism, plan, i, state, action, err)
      if (allocated(err)) return
      at = self%motion + self%forces() + 2*i
      row(at - 1) = action%value
      row(at) = action%force
    end do
  end subroutine fill_motors

  !> How many columns stand before those of stops: those that may have derivatives by parameters, and time.
  pure integer function before_stops(self) result(before)
    class(columns_type), intent(in) :: self  !< the columns

    before = self%motion + self%forces() + self%motors + self%energies + self%magnitudes + self%links
  end function before_stops

  !> Append the columns of stops: the force of each.
  subroutine append_stops(self, mechanism)
    class(columns_type), intent(inout) :: self     !< the columns
    type(mechanism_type), intent(in) :: mechanism  !< the mechanism
    integer :: i

    self%stops = size(mechanism%stops)
    do i = 1, self%stops
      associate (k => mechanism%stops(i)%coordinate)
        call self%append_in('S'//to_text(i), si_force(mechanism%pairs(k)%pair), &
                            'force of stop '//to_text(i)//' on coordinate '//to_text(k))
      end associate
    end do
  end subroutine append_stops

  !> Fill the columns of stops in a row.
  pure subroutine fill_stops(self, mechanism, state, row)
    class(columns_type), intent(in) :: self             !< the columns
    type(mechanism_type), intent(in) :: mechanism       !< the mechanism
    type(state_type), intent(in) :: state               !< motion of the mechanism, with the forces of rigid stops
    real(wp), intent(inout) :: row(:)                   !< numbers of one row, one for each column
    integer :: at, i

    at = self%before_stops()
    do i = 1, self%stops
      associate (stop => mechanism%stops(i))
        row(at + i) = 0.0_wp
        if (allocated(state%pressed) .and. .not. stop%is_rigid) then
          row(at + i) = stop%force(state%q(stop%coordinate), state%dq(stop%coordinate), state%pressed(:, i))
        else if (.not. stop%is_rigid) then
          row(at + i) = stop%force(state%q(stop%coordinate), state%dq(stop%coordinate))
        else if (allocated(state%stop_force)) then
          row(at + i) = state%stop_force(i)
        end if
      end associate
    end do
  end subroutine fill_stops

  !> Append the columns of frictions: force, power and energy of each.
  subroutine append_frictions(self, mechanism, heats)
    class(columns_type), intent(inout) :: self     !< the columns
    type(mechanism_type), intent(in) :: mechanism  !< the mechanism
    logical, intent(in) :: heats                   !< the motion knows their energies
    integer :: i

    self%frictions = merge(3, 2, heats)*size(mechanism%frictions)
    do i = 1, size(mechanism%frictions)
      associate (k => mechanism%frictions(i)%coordinate)
        call self%append_in('R'//to_text(k)//'.friction', si_force(mechanism%pairs(k)%pair), &
                            'friction on coordinate '//to_text(k))
        call self%append_in('R'//to_text(k)//'.loss', 'W', 'power that the friction of coordinate '//to_text(k)//' takes')
        if (heats) call self%append_in('R'//to_text(k)//'.heat', 'J', &
                                       'energy that the friction of coordinate '//to_text(k)//' has taken')
      end associate
    end do
  end subroutine append_frictions

  !> Fill the columns of frictions in a row.
  pure subroutine fill_frictions(self, mechanism, state, row)
    class(columns_type), intent(in) :: self             !< the columns
    type(mechanism_type), intent(in) :: mechanism       !< the mechanism
    type(state_type), intent(in) :: state               !< motion of the mechanism, with the forces of frictions
    real(wp), intent(inout) :: row(:)                   !< numbers of one row, one for each column
    integer :: at, i

    at = self%before_stops() + self%stops
    row(at + 1:at + self%frictions) = 0.0_wp
    if (.not. allocated(state%friction)) return
    do i = 1, size(state%friction)
      row(at + 1) = state%friction(i)
      row(at + 2) = -state%friction(i)*state%dq(mechanism%frictions(i)%coordinate)
      at = at + 2
      if (.not. allocated(state%heat)) cycle
      at = at + 1
      row(at) = state%heat(i)
    end do
  end subroutine fill_frictions

  !> Append the columns of energies.
  pure subroutine append_energies(self)
    class(columns_type), intent(inout) :: self       !< the columns

    call self%append_in('E.kinetic', 'J', 'kinetic energy')
    call self%append_in('E.potential', 'J', 'potential energy of gravity and springs')
    call self%append_in('E.total', 'J', 'kinetic and potential energy')
    self%energies = 3
  end subroutine append_energies

  !> Append the derivatives of the columns of motion, forces, motors, energies and links, but for time: those of each column by all
  !> parameters side by side, as they stand in an HDF5 file. Those that are not recorded stand after the poses, without names.
  pure subroutine append_sensitivities(self, parameters, units, recorded)
    class(columns_type), intent(inout) :: self       !< the columns
    type(string_type), intent(in) :: parameters(:)   !< names of the parameters
    type(string_type), intent(in) :: units(:)        !< their units; empty: not known, '1': plain numbers
    logical, intent(in) :: recorded                  !< they are in the results
    character(len=:), allocatable :: name, unit, per_parameter
    integer :: p, i

    self%parameters = parameters
    self%parameter_units = units
    self%varied = self%before_stops() - 1
    if (.not. recorded) then
      self%unrecorded = size(parameters)*self%varied
      return
    end if
    self%sensitivities = size(parameters)*self%varied
    self%varied_poses = size(parameters)*12*self%poses%n_links
    do i = 2, self%varied + 1
      name = self%names(i)%text
      unit = self%units(i)%text
      do p = 1, size(parameters)
        call self%find_unit_per(unit, p, per_parameter)
        call self%append('d('//name//')/d('//parameters(p)%text//')', per_parameter, &
                         'derivative of '//name//' by '//parameters(p)%text)
      end do
    end do
  end subroutine append_sensitivities

  !> A unit per that of a parameter, or per the parameter where its unit is not known.
  pure subroutine find_unit_per(self, unit, parameter, text)
    class(columns_type), intent(in) :: self                !< the columns, with parameters
    character(len=*), intent(in) :: unit                   !< of what has the derivative
    integer, intent(in) :: parameter                       !< number of the parameter
    character(len=:), allocatable, intent(out) :: text     !< the unit of the derivative

    associate (of => self%parameter_units(parameter)%text)
      if (of == '') then
        text = unit//'/'//self%parameters(parameter)%text
      else if (of == '1') then
        text = unit
      else if (scan(of, ' /^') > 0) then
        text = unit//'/('//of//')'
      else
        text = unit//'/'//of
      end if
    end associate
  end subroutine find_unit_per

  !> The place in a row before the derivatives by parameters.
  pure integer function before_sensitivities(self) result(before)
    type(columns_type), intent(in) :: self   !< the columns

    before = self%count - self%sensitivities
    if (self%unrecorded > 0) before = self%count + self%poses%width()
  end function before_sensitivities

  !> The columns of the derivatives of a column by each parameter; 0 where it has none.
  pure function derivatives_of(self, column) result(columns)
    class(columns_type), intent(in) :: self   !< the columns, with derivatives
    integer, intent(in) :: column             !< number of a column
    integer :: columns(size(self%parameters))
    integer :: p

    columns = 0
    if (column < 2 .or. column > self%varied + 1) return
    columns = [(before_sensitivities(self) + (column - 2)*size(columns) + p, p=1, size(columns))]
  end function derivatives_of

  !> The columns in the order of a table: of the derivatives all those by the first parameter first.
  pure function order_in_table(self) result(order)
    class(columns_type), intent(in) :: self   !< the columns
    integer :: order(self%count)
    integer :: i, p

    associate (before => self%count - self%sensitivities)
      order(:before) = [(i, i=1, before)]
      if (self%sensitivities == 0) return
      associate (n => size(self%parameters))
        order(before + 1:) = [((before + (i - 1)*n + p, i=1, self%varied), p=1, n)]
      end associate
    end associate
  end function order_in_table

  !> Fill columns of the derivatives of the motion by parameters in rows that follow each other.
  pure subroutine fill_sensitivities(self, changes, first, n, list, rows)
    class(columns_type), intent(in) :: self               !< the columns
    type(motion_changes_type), intent(in) :: changes      !< the derivatives at several positions
    integer, intent(in) :: first                          !< number of the position of the first row
    integer, intent(in) :: n                              !< number of rows
    integer, intent(in) :: list(:)                        !< numbers of the columns whose derivatives are wanted
    real(wp), intent(inout), contiguous :: rows(:, :)     !< (columns,n) numbers of the rows

    call self%derived%fill(changes, first, n, list - 1, before_sensitivities(self), size(rows, 1), rows)
  end subroutine fill_sensitivities

  !> Fill the columns of the derivatives of forces, motors, energies and links by parameters in a row.
  pure subroutine fill_beyond_motion(self, values, row)
    class(columns_type), intent(in) :: self        !< the columns
    real(wp), intent(in) :: values(:, :)           !< (P,columns) derivatives, in the order of these columns
    real(wp), intent(inout) :: row(:)              !< numbers of one row, one for each column
    integer :: i

    associate (n => size(values, 1), before => before_sensitivities(self) + (self%motion - 1)*size(values, 1))
      do i = 1, size(values, 2)
        row(before + (i - 1)*n + 1:before + i*n) = values(:, i)*self%scales(self%motion + i)
      end do
    end associate
  end subroutine fill_beyond_motion

  !> Fill the derivatives of the links' poses by parameters in a row: by all parameters for each number in the order of the poses.
  pure subroutine fill_varied_poses(self, values, row)
    class(columns_type), intent(in) :: self        !< the columns
    real(wp), intent(in) :: values(:, :)           !< (P,12 links) derivatives of all origins, then of all rotations by rows
    real(wp), intent(inout) :: row(:)              !< numbers of one row, one for each column
    integer :: before, n

    before = self%count + self%poses%width()
    row(before + 1:before + self%varied_poses) = reshape(values, [self%varied_poses])
    n = size(values, 1)*3*self%poses%n_links
    if (self%converts) row(before + 1:before + n) = row(before + 1:before + n)/self%system%length
  end subroutine fill_varied_poses

  !> Convert a row into the units of the results, apart from its derivatives by parameters.
  pure subroutine convert(self, row)
    class(columns_type), intent(in) :: self   !< the columns
    real(wp), intent(inout) :: row(:)         !< numbers of one row, one for each column
    integer :: n, links

    if (.not. self%converts) return
    n = self%count - self%sensitivities
    row(:n) = row(:n)*self%scales(:n)
    n = self%count
    links = self%poses%n_links
    if (links == 0) return
    ! origins, rotations, vertices
    row(n + 1:n + 3*links) = row(n + 1:n + 3*links)/self%system%length
    row(n + 12*links + 1:n + self%poses%width()) = row(n + 12*links + 1:n + self%poses%width())/self%system%length
  end subroutine convert

  !> The number of columns, poses with their derivatives, and derivatives that are not recorded included.
  pure integer function width(self)
    class(columns_type), intent(in) :: self  !< the columns

    width = self%count + self%poses%width() + self%varied_poses + self%unrecorded
  end function width

  !> The columns of the position, the rate and the acceleration to which a column belongs, where all three are recorded.
  pure subroutine family_of(self, column, family, order)
    class(columns_type), intent(in) :: self  !< the columns
    integer, intent(in) :: column            !< number of a column
    integer, intent(out) :: family(0:2)      !< columns of the position and its first two derivatives; 0 where they are not recorded
    integer, intent(out) :: order            !< order of the derivative that the column is, 0 to 2
    integer :: n, at

    family = 0
    order = 0
    if (self%derivatives < 2 .or. column < 2 .or. column > self%motion) return
    n = size(self%coordinates)
    if (column <= 3*n + 1) then
      order = (column - 2)/n
      family = column - order*n + [0, n, 2*n]
    else
      at = column - 3*n - 2     ! points follow each other: nine columns each
      order = mod(at, 9)/3
      family = column - 3*order + [0, 3, 6]
    end if
  end subroutine family_of

  !> Fill the columns of the poses in a row, if there are any.
  pure subroutine fill_poses(self, plan, state, row)
    class(columns_type), intent(in) :: self  !< the columns
    type(plan_type), intent(in) :: plan      !< the plan of the mechanism
    type(state_type), intent(in) :: state    !< position and motion of the mechanism
    real(wp), intent(inout) :: row(:)        !< numbers of one row, one for each column

    if (self%poses%n_links > 0) call self%poses%fill(plan, state, row(self%count + 1:))
  end subroutine fill_poses

  !> Fill the columns of the motion in a row with those of a state, in the program's units.
  pure subroutine fill(self, mechanism, plan, state, row)
    class(columns_type), intent(in) :: self        !< the columns
    type(mechanism_type), intent(in) :: mechanism  !< the mechanism
    type(plan_type), intent(in) :: plan            !< the plan of the mechanism
    type(state_type), intent(in) :: state          !< position and motion of the mechanism
    real(wp), intent(inout), contiguous :: row(:)    !< numbers of one row, one for each column
    integer :: i, n, used

    n = size(self%coordinates)
    row(1) = state%t
    call take(n, self%coordinates, state%q, row(2:n + 1))
    if (self%derivatives > 0) call take(n, self%coordinates, state%dq, row(n + 2:2*n + 1))
    if (self%derivatives > 1) call take(n, self%coordinates, state%ddq, row(2*n + 2:3*n + 1))
    used = 1 + (self%derivatives + 1)*n
    do i = 1, size(mechanism%points)
      associate (point => mechanism%points(i))
        select case (self%derivatives)
        case (0)
          call point_motion(plan, state, point%link, point%position, row(used + 1:used + 3))
        case (1)
          call point_motion(plan, state, point%link, point%position, row(used + 1:used + 3), row(used + 4:used + 6))
        case default
          call point_motion(plan, state, point%link, point%position, row(used + 1:used + 3), row(used + 4:used + 6), &
                            row(used + 7:used + 9))
        end select
      end associate
      used = used + 3*(self%derivatives + 1)
    end do
  end subroutine fill

  !> Select the recorded coordinates.
  pure subroutine take(n, coordinates, values, columns)
    integer, intent(in) :: n               !< how many coordinates are recorded
    integer, intent(in) :: coordinates(n)  !< (n) numbers of the recorded coordinates
    real(wp), intent(in) :: values(*)      !< (M) values of all coordinates, rad or m or their rates
    real(wp), intent(inout) :: columns(n)  !< gets the recorded values
    integer :: i

    do i = 1, n
      columns(i) = values(coordinates(i))
    end do
  end subroutine take
end module mech9_columns
