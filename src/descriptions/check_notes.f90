!> Notes of --check on data that are allowed but often mistakes: angles in the other unit, bodies and links without effect.
module mech9_check_notes
  use mech9_named_words, only: with_names, named_list
  use mech9_kinds, only: wp, pi, radians_per_degree
  use mech9_error, only: error_type
  use mech9_text, only: to_text
  use mech9_masks, only: numbers_of
  use mech9_partition, only: free_coordinate
  use mech9_mechanism, only: mechanism_type
  use mech9_model, only: model_type
  use mech9_result_units, only: unit_of, rate_unit_of, rate_unit_name
  use mech9_law, only: law_type
  use mech9_harmonic_law, only: harmonic_law_type
  use mech9_law_notes, only: print_jumps
  use mech9_effect_notes, only: print_effects
  use mech9_link_dimensions, only: link_dimension_type, link_dimensions
  implicit none
  private
  public :: print_notes, print_run_notes

  !> Most numbers that a list shows.
  integer, parameter :: longest_list = 24
  !> A rate from `fast` on that is a multiple of `whole` [rad/s] was probably meant in degrees.
  real(wp), parameter :: fast = 45.0_wp, whole = 15.0_wp
  !> An angle or a rate in degrees may have a number that is so near, relatively, to that of a few quarters of a turn in radians.
  !> It was probably meant in radians: pi is often rounded to 3.14.
  real(wp), parameter :: rounded_pi = 1.0e-3_wp
  integer, parameter :: most_quarters = 8
  !> Links of this length [m] were probably meant in millimetres.
  real(wp), parameter :: very_long = 20.0_wp

contains

  !> Write a line for each note of a check: those of a run, and links without mass.
  subroutine print_notes(unit, model, with_masses)
    integer, intent(in) :: unit            !< Fortran unit to write to
    type(model_type), intent(in) :: model  !< the model
    logical, intent(in) :: with_masses     !< with notes for mech9d, on bodies and initial velocities

    call print_run_notes(unit, model, with_masses)
    if (with_masses) call note_massless(unit, model%mechanism)
  end subroutine print_notes

  !> Write a line for each note on data that are allowed but often mistakes.
  subroutine print_run_notes(unit, model, with_masses)
    integer, intent(in) :: unit            !< Fortran unit to write to
    type(model_type), intent(in) :: model  !< the model
    logical, intent(in) :: with_masses     !< with notes on bodies, loads and initial velocities
    type(error_type), allocatable :: err
    real(wp) :: q, dq, ddq
    integer :: i, k

    if (with_masses) then
      do k = 1, size(model%mechanism%pairs)
        if (model%problem%partition%kind(k) == free_coordinate) &
          call note_angle(unit, model%mechanism, k, 'the start', model%problem%initial%position(k), &
                          model%problem%initial%velocity(k))
      end do
      if (any(model%mechanism%bodies%link == 1)) call note_frame(unit, model%mechanism)
    end if
    do i = 1, size(model%problem%drives)
      k = model%problem%drives(i)%drive%coordinate
      call model%problem%drives(i)%drive%evaluate(model%request%time%start, q, dq, ddq, err)
      if (.not. allocated(err)) call note_angle(unit, model%mechanism, k, 'the drive', q, dq)
      call note_frequency(unit, model%mechanism, model%problem%drives(i)%drive)
    end do
    do i = 1, size(model%mechanism%loads)
      if (allocated(model%mechanism%loads(i)%load%law)) &
        call note_frequency(unit, model%mechanism, model%mechanism%loads(i)%load%law, 'load '//to_text(i))
    end do
    do i = 1, size(model%mechanism%motors)
      if (allocated(model%mechanism%motors(i)%motor%law)) &
        call note_frequency(unit, model%mechanism, model%mechanism%motors(i)%motor%law)
    end do
    call print_jumps(unit, model)
    call print_effects(unit, model, with_masses)
    call note_size(unit, model%mechanism)
  end subroutine print_run_notes

  !> Note dimensions in metres that are as large as if millimetres were meant, where the file names no unit of lengths.
  subroutine note_size(unit, mechanism)
    integer, intent(in) :: unit                    !< Fortran unit to write to
    type(mechanism_type), intent(in) :: mechanism  !< the mechanism
    type(link_dimension_type), allocatable :: dimensions(:)
    real(wp) :: largest

    if (mechanism%units%names_length) return
    call link_dimensions(mechanism, dimensions)
    largest = 0.0_wp
    if (size(dimensions) > 0) largest = max(maxval(dimensions%distance), maxval(dimensions%between_points))
    if (largest >= very_long) write (unit, '(a)') 'note: the longest link has '//to_text(largest, 4)//' m between two pairs; '// &
      'where millimetres are meant, give &mechanism length_unit=''mm'''
  end subroutine note_size

  !> Note an angle or a rate that seems to be in the other unit.
  subroutine note_angle(unit, mechanism, k, what, q, dq)
    integer, intent(in) :: unit                    !< Fortran unit to write to
    type(mechanism_type), intent(in) :: mechanism      !< the mechanism
    integer, intent(in) :: k                       !< number of the coordinate
    character(len=*), intent(in) :: what           !< 'the drive' or 'the start'
    real(wp), intent(in) :: q                      !< value of the coordinate [rad]
    real(wp), intent(in) :: dq                     !< its rate [rad/s]
    character(len=:), allocatable :: begin
    real(wp) :: rate

    if (.not. mechanism%pairs(k)%pair%angular .or. mechanism%pairs(k)%pair%user_calls() > 0) return
    begin = with_names(mechanism%names, 'note: '//what//' of coordinate '//to_text(k)//' has ')
    if (abs(unit_of(mechanism, k) - 1.0_wp) <= 0.0_wp) then
      if (abs(q) > 2.0_wp*pi) then
        write (unit, '(a)') begin//'the angle '//to_text(q)//' rad, more than a turn; where degrees are meant, give '// &
          '&mechanism angle_unit=''deg'''
      else if (abs(dq) >= fast .and. abs(dq - whole*anint(dq/whole)) <= 0.0_wp) then
        write (unit, '(a)') begin//'the rate '//to_text(dq)//' rad/s, '//to_text(abs(dq)/(2.0_wp*pi), 3)// &
          ' turns a second; where degrees are meant, give &mechanism angle_unit=''deg'''
      end if
      return
    end if
    rate = dq/rate_unit_of(mechanism, k)
    if (is_of_quarters(rate) .and. rate_unit_name(mechanism, k) == 'deg/s') then
      write (unit, '(a)') begin//'the rate '//to_text(rate)//' degrees a second; where radians are meant, leave out '// &
        'angle_unit=''deg'''
    else if (is_of_quarters(rate) .and. rate_unit_name(mechanism, k) == 'rpm') then
      write (unit, '(a)') begin//'the rate '//to_text(rate)//' rpm; where radians a second are meant, give rate_unit=''rad/s'''
    else if (is_of_quarters(q/radians_per_degree)) then
      write (unit, '(a)') begin//'the angle '//to_text(q/radians_per_degree)//' degrees; where radians are meant, leave out '// &
        'angle_unit=''deg'''
    end if
  end subroutine note_angle

  !> Note an angular frequency in degrees that seems to be in radians.
  subroutine note_frequency(unit, mechanism, law, owner)
    integer, intent(in) :: unit                        !< Fortran unit to write to
    type(mechanism_type), intent(in) :: mechanism      !< the mechanism
    class(law_type), intent(in) :: law                 !< a law of time
    character(len=*), intent(in), optional :: owner    !< of the law; what the law knows of it unless given
    character(len=:), allocatable :: name
    real(wp) :: frequency

    if (mechanism%units%rate_name /= 'deg/s') return
    name = with_names(mechanism%names, trim(law%owner()))
    if (present(owner)) name = owner
    select type (law)
    type is (harmonic_law_type)
      frequency = law%angular_frequency/mechanism%units%rate
      if (is_of_quarters(frequency)) write (unit, '(a)') 'note: the law of '//name//' has the angular frequency '// &
        to_text(frequency)//' degrees a second; where radians are meant, leave out angle_unit=''deg'''
    end select
  end subroutine note_frequency

  !> Whether a number of degrees is that of a few quarters of a turn in radians.
  pure logical function is_of_quarters(number)
    real(wp), intent(in) :: number   !< [degrees, degrees per second]
    real(wp) :: quarters

    quarters = number/(0.5_wp*pi)
    is_of_quarters = .false.
    if (nint(min(abs(quarters), 100.0_wp)) < 1 .or. abs(quarters) > most_quarters + 0.5_wp) return
    is_of_quarters = abs(quarters - anint(quarters)) <= rounded_pi*abs(quarters)
  end function is_of_quarters

  !> Note a body of the frame.
  subroutine note_frame(unit, mechanism)
    integer, intent(in) :: unit                    !< Fortran unit to write to
    type(mechanism_type), intent(in) :: mechanism  !< the mechanism, with a body of link 1
    integer :: i

    i = findloc(mechanism%bodies%link, 1, dim=1)
    if (mechanism%bodies(i)%has_inertia()) &
      write (unit, '(a)') 'note: link 1 is the frame, which does not move: its &body has no effect'
  end subroutine note_frame

  !> Note links without mass beside links with mass.
  subroutine note_massless(unit, mechanism)
    integer, intent(in) :: unit                    !< Fortran unit to write to
    type(mechanism_type), intent(in) :: mechanism  !< the mechanism
    type(link_dimension_type), allocatable :: dimensions(:)
    logical :: massless(mechanism%structure%n_links)
    integer :: i

    massless = .true.
    do i = 1, size(mechanism%bodies)
      if (mechanism%bodies(i)%has_inertia()) massless(mechanism%bodies(i)%link) = .false.
    end do
    massless(1) = .false.
    massless(mechanism%structure%shown_links() + 1:) = .false.
    if (count(massless) == mechanism%structure%shown_links() - 1) return
    ! a link between axes that meet is part of a ball or universal joint, which needs no mass
    call link_dimensions(mechanism, dimensions)
    do i = 1, size(dimensions)
      associate (d => dimensions(i))
        if (d%has_distance .and. d%has_points .and. .not. d%between_points > 0.0_wp) massless(d%link) = .false.
      end associate
    end do
    if (any(massless)) write (unit, '(a)') 'note: '//trim(merge('links', 'link ', count(massless) > 1))//' '// &
      named_list(mechanism%names%links, numbers_of(massless), longest_list)// &
      trim(merge(' have', ' has ', count(massless) > 1))//' no mass, while others have; give a &body where this is a mistake'
  end subroutine note_massless
end module mech9_check_notes
