!> Checks of drives that need the whole model: a drive of a dependent coordinate, and initial values that contradict a drive.
module mech9_drive_check
  use mech9_program_kind, only: kinematics
  use mech9_kinds, only: wp
  use mech9_error, only: error_type, place_words
  use mech9_text, only: to_text
  use mech9_mechanism, only: mechanism_type
  use mech9_model, only: model_type
  use mech9_pair, only: pair_guide_type
  use mech9_law, only: law_type
  use mech9_result_units, only: unit_of, rate_unit_of, length_text
  use mech9_independent_choice, only: find_choice
  use mech9_partition, only: partition_type
  use mech9_source, only: span_type
  use mech9_document, only: document_type, group_type
  use mech9_lookup, only: groups_named, has_name, has_unsound, get_integer, get_real, get_integers, span_of
  use mech9_diagnostics, only: diagnostics_type
  implicit none
  private
  public :: check_drives, check_motors, check_independent

  !> An initial value agrees with a drive where it differs by no more than this part of it, or by the second number [rad, m, ...].
  real(wp), parameter :: same_value = 1.0e-6_wp, same_zero = 1.0e-9_wp

contains

  !> Check all drives.
  subroutine check_drives(document, model, diagnostics)
    type(document_type), intent(in) :: document           !< the data file as groups and items
    type(model_type), intent(in) :: model                 !< all that was read; sound where there are no errors
    type(diagnostics_type), intent(inout) :: diagnostics  !< gets the errors
    integer, allocatable :: numbers(:)
    integer :: i
    logical :: sound

    sound = .not. diagnostics%failed()
    numbers = groups_named(document, 'drive')
    do i = 1, size(numbers)
      call check_independent(document%groups(numbers(i)), model, sound, 'be driven', &
                             'drive an independent one (see cq)', diagnostics)
    end do
    if (model%program == kinematics .and. .not. has_unsound(document, 'drive')) &
      call check_complete(document, model%problem%partition, diagnostics)
    numbers = groups_named(document, 'initial')
    do i = 1, size(numbers)
      call check_start(document%groups(numbers(i)), model, diagnostics)
    end do
    call check_curves(document, model, diagnostics)
  end subroutine check_drives

  !> Report coordinates that would start beyond the ends of their curves: by a drive, or by an initial position.
  subroutine check_curves(document, model, diagnostics)
    type(document_type), intent(in) :: document           !< the data file as groups and items
    type(model_type), intent(in) :: model                 !< all that was read
    type(diagnostics_type), intent(inout) :: diagnostics  !< gets the errors
    type(pair_guide_type) :: guide
    type(error_type), allocatable :: err
    integer, allocatable :: drives(:), initials(:)
    real(wp) :: q, dq, ddq
    integer :: i, k

    drives = groups_named(document, 'drive')
    initials = groups_named(document, 'initial')
    do k = 1, size(model%mechanism%pairs)
      if (.not. allocated(model%mechanism%pairs(k)%pair)) cycle
      call model%mechanism%pairs(k)%pair%guide(guide)
      if (guide%closed .or. .not. guide%length > 0.0_wp) cycle
      do i = 1, size(drives)
        if (get_integer(document%groups(drives(i)), 'coordinate') /= k .or. i > size(model%problem%drives)) cycle
        if (.not. allocated(model%problem%drives(i)%drive)) cycle
        if (model%problem%drives(i)%drive%coordinate /= k) cycle
        call model%problem%drives(i)%drive%evaluate(model%request%time%start, q, dq, ddq, err)
        if (.not. allocated(err)) call check_place(document%groups(drives(i))%span, model%mechanism, k, q, guide%length, &
                                                 diagnostics)
      end do
      do i = 1, size(initials)
        associate (group => document%groups(initials(i)))
          if (get_integer(group, 'coordinate') == k .and. has_name(group, 'position')) &
            call check_place(span_of(group, 'position', 1), model%mechanism, k, &
                             get_real(group, 'position')*unit_of(model%mechanism, k), guide%length, diagnostics)
        end associate
      end do
    end do
  end subroutine check_curves

  !> Report a place beyond the ends of a curve.
  pure subroutine check_place(span, mechanism, coordinate, q, length, diagnostics)
    type(span_type), intent(in) :: span                   !< place of the number in the data file
    type(mechanism_type), intent(in) :: mechanism         !< the mechanism
    integer, intent(in) :: coordinate                     !< number of the coordinate
    real(wp), intent(in) :: q                             !< its place at the start [m]
    real(wp), intent(in) :: length                        !< of the curve [m]
    type(diagnostics_type), intent(inout) :: diagnostics  !< gets the errors

    if (q >= -same_zero*length .and. q <= (1.0_wp + same_zero)*length) return
    call diagnostics%add(span, 'coordinate '//to_text(coordinate)//' would start at '// &
                         to_text(q/mechanism%units%length)//' '//trim(mechanism%units%length_name)// &
                         ', and its curve leads from 0 to '//trim(length_text(mechanism, length, 10))//'; start on the curve')
  end subroutine check_place

  !> Report motors on dependent coordinates, and on driven ones.
  subroutine check_motors(document, model, diagnostics)
    type(document_type), intent(in) :: document           !< the data file as groups and items
    type(model_type), intent(in) :: model                 !< all that was read; sound where there are no errors
    type(diagnostics_type), intent(inout) :: diagnostics  !< gets the errors
    integer, allocatable :: numbers(:)
    integer :: i, j, k
    logical :: sound

    sound = .not. diagnostics%failed()
    numbers = groups_named(document, 'motor')
    do i = 1, size(numbers)
      call check_independent(document%groups(numbers(i)), model, sound, 'have a motor', &
                             'put the motor on an independent one (see cq)', diagnostics)
      k = get_integer(document%groups(numbers(i)), 'coordinate')
      do j = 1, size(model%problem%drives)
        if (.not. allocated(model%problem%drives(j)%drive)) cycle
        if (model%problem%drives(j)%drive%coordinate /= k) cycle
        call diagnostics%add(span_of(document%groups(numbers(i)), 'coordinate', 1), 'coordinate '//to_text(k)//' has the drive '// &
                             'of '//trim(place_words(model%problem%drives(j)%drive%place))//', which sets its motion, so that '// &
                             'a motor has no effect; leave one of the two out')
        exit
      end do
    end do
  end subroutine check_motors

  !> Report independent coordinates without a drive.
  pure subroutine check_complete(document, partition, diagnostics)
    type(document_type), intent(in) :: document           !< the data file as groups and items
    type(partition_type), intent(in) :: partition         !< kinds of the coordinates; none where the structure is unknown
    type(diagnostics_type), intent(inout) :: diagnostics  !< gets the errors
    integer, allocatable :: numbers(:), cq(:)
    type(span_type) :: span
    logical :: driven(size(partition%kind))
    integer :: i, k

    driven = .false.
    numbers = groups_named(document, 'drive')
    do i = 1, size(numbers)
      k = get_integer(document%groups(numbers(i)), 'coordinate')
      if (k <= size(driven)) driven(k) = .true.
    end do
    numbers = groups_named(document, 'structure')
    do k = 1, size(partition%kind)
      if (driven(k) .or. .not. partition%is_independent(k)) cycle
      if (size(numbers) > 0) then
        cq = get_integers(document%groups(numbers(1)), 'cq')
        span = span_of(document%groups(numbers(1)), 'cq', findloc(cq, k, dim=1))
      end if
      call diagnostics%add(span, 'the independent coordinate '//to_text(k)//' has no drive; give it a &drive')
    end do
  end subroutine check_complete

  !> Report a group about a dependent coordinate that must be independent, with a choice that would serve where one is found.
  subroutine check_independent(group, model, sound, use, otherwise, diagnostics)
    type(group_type), intent(in) :: group                 !< a group with a name `coordinate`
    type(model_type), intent(in) :: model                 !< all that was read
    logical, intent(in) :: sound                          !< the model is sound apart from such groups
    character(len=*), intent(in) :: use                   !< the words for that of which it is incapable, for example 'be driven'
    character(len=*), intent(in) :: otherwise             !< the remedy where no choice is found
    type(diagnostics_type), intent(inout) :: diagnostics  !< gets the errors
    character(len=:), allocatable :: remedy
    integer, allocatable :: choice(:)
    integer :: k
    logical :: known

    k = get_integer(group, 'coordinate')
    if (k < 1 .or. k > size(model%problem%partition%kind)) return
    if (model%problem%partition%is_independent(k)) return
    remedy = otherwise
    known = .false.
    if (sound) call find_choice(model, k, known, choice)
    if (known) then
      if (size(choice) > 0) then
        remedy = 'cq = '//to_text(choice)//' would make it independent'
      else
        remedy = 'the coordinates that are driven determine it already'
      end if
    end if
    call diagnostics%add(span_of(group, 'coordinate', 1), 'coordinate '//to_text(k)//' is dependent and cannot '//use//'; '//remedy)
  end subroutine check_independent

  !> Report initial values of a driven coordinate that its drive does not have at the start.
  subroutine check_start(group, model, diagnostics)
    type(group_type), intent(in) :: group                 !< a group &initial
    type(model_type), intent(in) :: model                 !< all that was read
    type(diagnostics_type), intent(inout) :: diagnostics  !< gets the errors
    type(error_type), allocatable :: err
    real(wp) :: q, dq, ddq
    integer :: i, k

    k = get_integer(group, 'coordinate')
    do i = 1, size(model%problem%drives)
      if (.not. allocated(model%problem%drives(i)%drive)) cycle
      associate (drive => model%problem%drives(i)%drive, initial => model%problem%initial)
        if (drive%coordinate /= k .or. k > size(initial%position)) cycle
        if (.not. model%problem%partition%is_independent(k)) cycle
        if (.not. (initial%position_given(k) .or. initial%velocity_given(k))) cycle
        call drive%evaluate(model%request%time%start, q, dq, ddq, err)
        if (allocated(err)) cycle
        if (initial%position_given(k)) call compare(group, 'position', model, drive, initial%position(k), q, diagnostics)
        if (initial%velocity_given(k)) call compare(group, 'velocity', model, drive, initial%velocity(k), dq, diagnostics)
      end associate
    end do
  end subroutine check_start

  !> Report one initial value that is not that of the drive.
  subroutine compare(group, name, model, drive, given, driven, diagnostics)
    type(group_type), intent(in) :: group                 !< the group &initial
    character(len=*), intent(in) :: name                  !< 'position' or 'velocity'
    type(model_type), intent(in) :: model                 !< all that was read
    class(law_type), intent(in) :: drive                !< of the same coordinate
    real(wp), intent(in) :: given                         !< initial value [rad, m; per s]
    real(wp), intent(in) :: driven                        !< value of the drive at the start [rad, m; per s]
    type(diagnostics_type), intent(inout) :: diagnostics  !< gets the errors
    real(wp) :: unit

    if (abs(given - driven) <= same_value*max(abs(given), abs(driven)) + same_zero) return
    unit = 1.0_wp
    if (allocated(model%mechanism%pairs(drive%coordinate)%pair)) then
      unit = unit_of(model%mechanism, drive%coordinate)
      if (name == 'velocity') unit = rate_unit_of(model%mechanism, drive%coordinate)
    end if
    call diagnostics%add(span_of(group, name, 1), 'the '//name//' of coordinate '//to_text(drive%coordinate)// &
                         ' at the start is '//to_text(driven/unit)//' by its drive in '//trim(place_words(drive%place))// &
                         ', not '//to_text(given/unit)//'; leave the initial value out, or correct the drive')
  end subroutine compare
end module mech9_drive_check
