!> Motors from the groups &motor of a checked document.
module mech9_motor_reader
  use mech9_kinds, only: wp
  use mech9_text, only: to_text
  use mech9_mechanism, only: mechanism_type
  use mech9_polynomial_law, only: polynomial_law_type
  use mech9_motor, only: motor_type, motor_slot_type
  use mech9_dc_motor, only: dc_motor_type
  use mech9_pid_motor, only: pid_motor_type
  use mech9_document, only: document_type, group_type
  use mech9_units, only: coordinate_units_type
  use mech9_lookup, only: groups_named, has_name, get_integer, get_real, get_text, span_of
  use mech9_drive_reader, only: read_law, read_law_over, is_over, units_of_coordinate
  use mech9_diagnostics, only: diagnostics_type
  use mech9_load_reader, only: check_coordinate
  implicit none
  private
  public :: read_motors

contains

  !> All motors, in the order of the file.
  subroutine read_motors(document, mechanism, motors, diagnostics)
    type(document_type), intent(in) :: document                     !< the data file as groups and items
    type(mechanism_type), intent(in) :: mechanism                   !< with its pairs and points; none where they are not known
    type(motor_slot_type), allocatable, intent(out) :: motors(:)    !< gets the motors
    type(diagnostics_type), intent(inout) :: diagnostics            !< gets the errors
    class(motor_type), allocatable :: motor
    integer, allocatable :: numbers(:)
    integer :: i

    numbers = groups_named(document, 'motor')
    allocate (motors(size(numbers)))
    do i = 1, size(motors)
      associate (group => document%groups(numbers(i)))
        call check_coordinate(group, size(mechanism%pairs), diagnostics)
        if (get_text(group, 'kind') == 'dc') then
          call read_dc_motor(document, group, mechanism, motor, diagnostics)
        else
          call read_pid_motor(document, group, mechanism, motor, diagnostics)
        end if
        motor%coordinate = get_integer(group, 'coordinate')
        motor%number = i
        motor%place = diagnostics%place(group%span)
        if (allocated(motor%law)) then
          motor%law%motor = i
          motor%law%place = motor%place
        end if
        if (allocated(motor%over)) then
          motor%over%law%motor = i
          motor%over%law%place = motor%place
        end if
        call move_alloc(motor, motors(i)%motor)
      end associate
    end do
    call check_integrals(document, numbers, motors, diagnostics)
  end subroutine read_motors

  !> Report two controllers with integral parts on one coordinate: neither would come to rest.
  subroutine check_integrals(document, numbers, motors, diagnostics)
    type(document_type), intent(in) :: document           !< the data file as groups and items
    integer, intent(in) :: numbers(:)                     !< groups of the motors
    type(motor_slot_type), intent(in) :: motors(:)        !< the motors
    type(diagnostics_type), intent(inout) :: diagnostics  !< gets the errors
    integer :: coordinates(size(motors)), i

    coordinates = 0
    do i = 1, size(motors)
      associate (motor => motors(i)%motor)
        if (.not. motor%holds_setpoint()) cycle
        if (any(coordinates(:i - 1) == motor%coordinate)) &
          call diagnostics%add(span_of(document%groups(numbers(i)), 'integral', 1), 'coordinate '//to_text(motor%coordinate)// &
                               ' has a controller with an integral part already, and two never come to rest; leave integral= out')
        coordinates(i) = motor%coordinate
      end associate
    end do
  end subroutine check_integrals

  !> A direct-current motor.
  subroutine read_dc_motor(document, group, mechanism, motor, diagnostics)
    type(document_type), intent(in) :: document               !< the data file as groups and items
    type(group_type), intent(in) :: group                     !< the group of the data file
    type(mechanism_type), intent(in) :: mechanism             !< with its pairs and points; none where they are not known
    class(motor_type), allocatable, intent(out) :: motor      !< the motor
    type(diagnostics_type), intent(inout) :: diagnostics      !< gets the errors
    type(dc_motor_type) :: dc
    type(coordinate_units_type) :: unit

    unit = units_of_coordinate(group, mechanism%pairs, mechanism%units)
    dc%voltage = 1.0_wp
    if (has_name(group, 'voltage')) dc%voltage = get_real(group, 'voltage')
    dc%resistance = get_real(group, 'resistance')
    dc%inductance = get_real(group, 'inductance')
    dc%constant = unit%force*get_real(group, 'constant')
    dc%gear_ratio = get_real(group, 'gear_ratio')
    if (is_over(group)) then
      call read_law_over(document, group, mechanism, coordinate_units_type(), dc%over, diagnostics, advances=.false.)
      call check_variable(group, dc, .false., diagnostics)
    else
      call read_law(document, group, get_text(group, 'law'), coordinate_units_type(), dc%law, diagnostics)
    end if
    if (.not. (has_law(group) .or. has_name(group, 'voltage'))) &
      call diagnostics%add(group%span, 'the motor has no voltage; give voltage= (0 for a short circuit), or law= and its names')
    if (.not. abs(dc%gear_ratio) > 0.0_wp) &
      call diagnostics%add(span_of(group, 'gear_ratio', 1), 'with gear_ratio=0 the motor moves nothing; give the turns of the '// &
                           'motor per turn of the coordinate')
    allocate (motor, source=dc)
  end subroutine read_dc_motor

  !> A motor that a PID controller sets.
  subroutine read_pid_motor(document, group, mechanism, motor, diagnostics)
    type(document_type), intent(in) :: document               !< the data file as groups and items
    type(group_type), intent(in) :: group                     !< the group of the data file
    type(mechanism_type), intent(in) :: mechanism             !< with its pairs and points; none where they are not known
    class(motor_type), allocatable, intent(out) :: motor      !< the motor
    type(diagnostics_type), intent(inout) :: diagnostics      !< gets the errors
    type(pid_motor_type) :: pid
    type(coordinate_units_type) :: unit
    type(polynomial_law_type) :: constant

    unit = units_of_coordinate(group, mechanism%pairs, mechanism%units)
    pid%proportional = unit%slope*get_real(group, 'proportional')
    pid%integral = unit%slope*get_real(group, 'integral')
    pid%derivative = unit%slope*get_real(group, 'derivative')
    if (has_name(group, 'limit')) pid%limit = unit%force*get_real(group, 'limit')
    if (has_law(group) .and. is_over(group)) then
      call read_law_over(document, group, mechanism, unit, pid%over, diagnostics, advances=.true.)
      call check_variable(group, pid, pid%derivative > 0.0_wp, diagnostics)
    else if (has_law(group)) then
      call read_law(document, group, get_text(group, 'law'), unit, pid%law, diagnostics)
    else if (has_name(group, 'setpoint')) then
      constant%coefficients = [unit%position*get_real(group, 'setpoint')]
      allocate (pid%law, source=constant)
    end if
    if (allocated(pid%law)) pid%law%coordinate = get_integer(group, 'coordinate')
    if (allocated(pid%over)) pid%over%law%coordinate = get_integer(group, 'coordinate')
    call check_pid_motor(group, pid, diagnostics)
    allocate (motor, source=pid)
  end subroutine read_pid_motor

  !> Report a setpoint over a rate or a velocity whose own rate, an acceleration, would count.
  subroutine check_variable(group, motor, needs_rate, diagnostics)
    type(group_type), intent(in) :: group                 !< the group of the data file
    class(motor_type), intent(in) :: motor                !< the motor
    logical, intent(in) :: needs_rate                     !< its force depends on the rate of its law
    type(diagnostics_type), intent(inout) :: diagnostics  !< gets the errors

    if (.not. allocated(motor%over)) return
    if (motor%over%is_rate .and. needs_rate) &
      call diagnostics%add(span_of(group, 'over', 1), 'the derivative part needs the rate of the setpoint, and over '// &
                           get_text(group, 'over')//' this is an acceleration; leave derivative= out, or give a coordinate '// &
                           'or the position of a point')
  end subroutine check_variable

  !> Whether a law is given that is not constant.
  pure logical function has_law(group)
    type(group_type), intent(in) :: group  !< the group of the data file

    has_law = has_name(group, 'law')
    if (has_law) has_law = get_text(group, 'law') /= 'constant'
  end function has_law

  !> Report a controller without setpoint, with two, without gains, or whose integral could not be led back at the limit.
  subroutine check_pid_motor(group, pid, diagnostics)
    type(group_type), intent(in) :: group                 !< the group of the data file
    type(pid_motor_type), intent(in) :: pid               !< the controller
    type(diagnostics_type), intent(inout) :: diagnostics  !< gets the errors

    if (.not. (has_law(group) .or. has_name(group, 'setpoint'))) &
      call diagnostics%add(group%span, 'the controller has no setpoint; give setpoint=, or law= and its names, for instance '// &
                           'law=''polynomial'', coefficients=0.5')
    if (has_law(group) .and. has_name(group, 'setpoint')) &
      call diagnostics%add(span_of(group, 'setpoint', 1), 'the setpoint is given twice, by setpoint= and by law=; leave one out')
    if (.not. max(pid%proportional, pid%integral, pid%derivative) > 0.0_wp) &
      call diagnostics%add(group%span, 'the controller has no gain; give proportional, integral or derivative')
    if (pid%has_limit() .and. pid%integral > 0.0_wp .and. .not. max(pid%proportional, pid%derivative) > 0.0_wp) &
      call diagnostics%add(span_of(group, 'limit', 1), 'a controller with an integral part alone cannot have a limit, because '// &
                           'the time in which the integral is led back follows from the other gains; give proportional='// &
                           ' or derivative= too')
  end subroutine check_pid_motor
end module mech9_motor_reader
