!> The least time after which all drives, and the laws of loads and motors, have the same course again.
module mech9_law_periods
  use mech9_kinds, only: wp
  use mech9_error, only: error_type, place_type, raise, exit_data
  use mech9_text, only: to_text
  use mech9_law, only: law_type, repetition_type, unknown_repetition, never_repeats, stands_still, moves_steadily
  use mech9_model, only: model_type
  implicit none
  private
  public :: law_period_type, find_law_period, fit_period

  !> Parts of a period by which ratios of periods may miss a fraction; by which a period that is given may miss a multiple.
  real(wp), parameter :: of_ratio = 1.0e-9_wp, of_given = 1.0e-6_wp
  !> Largest numbers of periods that are looked at for a common multiple.
  integer, parameter :: most_periods = 1000
  real(wp), parameter :: turn = 8.0_wp*atan(1.0_wp)

  !> How a model depends on time.
  type :: law_period_type
    logical :: follows_time = .false.             !< some law does
    logical :: is_known = .true.                  !< its period is known: no user procedure may follow time
    real(wp) :: period = 0.0_wp                   !< the least common period [s]
    character(len=:), allocatable :: owners       !< the laws in words, with their periods
    character(len=40) :: unknown = ''             !< owner of a law whose period is not known
  end type law_period_type

contains

  !> Find the common period of a model. Fails with exit_data where a law never repeats, and where periods have no common multiple.
  subroutine find_law_period(model, found, err)
    type(model_type), intent(in) :: model               !< the model
    type(law_period_type), intent(out) :: found         !< the period
    type(error_type), allocatable, intent(out) :: err   !< allocated if there is none
    integer :: i

    found%owners = ''
    do i = 1, size(model%problem%drives)
      associate (drive => model%problem%drives(i)%drive)
        call add_law(drive, trim(drive%owner()), turns(model, drive%coordinate), found, err)
        if (allocated(err)) return
      end associate
    end do
    do i = 1, size(model%mechanism%loads)
      associate (load => model%mechanism%loads(i)%load)
        if (allocated(load%law)) call add_law(load%law, 'load '//to_text(i), .false., found, err)
        if (load%may_follow_time()) call note_unknown('load '//to_text(i), found)
      end associate
      if (allocated(err)) return
    end do
    do i = 1, size(model%mechanism%motors)
      associate (motor => model%mechanism%motors(i)%motor)
        if (allocated(motor%law)) then
          if (motor%law%variable == 't') &
            call add_law(motor%law, 'motor '//to_text(i), turns(model, motor%coordinate), found, err)
        end if
      end associate
      if (allocated(err)) return
    end do
  end subroutine find_law_period

  !> Whether a coordinate is an angle.
  pure logical function turns(model, coordinate)
    type(model_type), intent(in) :: model    !< the model
    integer, intent(in) :: coordinate        !< its number

    turns = .false.
    if (coordinate > 0) turns = model%mechanism%pairs(coordinate)%pair%angular
  end function turns

  !> Note a law whose course is not known.
  subroutine note_unknown(owner, found)
    character(len=*), intent(in) :: owner               !< of the law
    type(law_period_type), intent(inout) :: found       !< gets it

    found%follows_time = .true.
    found%is_known = .false.
    found%unknown = owner
  end subroutine note_unknown

  !> Take a law into account.
  subroutine add_law(law, owner, is_angle, found, err)
    class(law_type), intent(in) :: law                  !< the law
    character(len=*), intent(in) :: owner               !< owner of the law
    logical, intent(in) :: is_angle                     !< whole turns of its values do not matter
    type(law_period_type), intent(inout) :: found       !< the period so far
    type(error_type), allocatable, intent(out) :: err   !< allocated if there is none
    type(repetition_type) :: repetition
    real(wp) :: period
    logical :: repeats
    integer :: n

    repetition = law%repetition()
    if (repetition%kind == stands_still) return
    if (repetition%kind == unknown_repetition) then
      call note_unknown(owner, found)
      return
    end if
    period = repetition%period
    repeats = repetition%kind /= never_repeats
    if (repetition%kind == moves_steadily) then
      repeats = is_angle
      if (repeats) period = turn/abs(repetition%rate)
    else if (abs(repetition%advance) > 0.0_wp .and. repeats) then
      repeats = is_angle
      if (repeats) call count_multiple(abs(repetition%advance)/turn, n)
      repeats = repeats .and. n > 0
      if (repeats) period = n*period
    end if
    if (.not. repeats) then
      call raise(err, exit_data, 'the law of the '//trim(owner)//' never has the same course again, so that no motion is '// &
                 'periodic; take a law that repeats', law%place)
      return
    end if
    call add_period(period, owner, law%place, found, err)
  end subroutine add_law

  !> The least number of times by which a ratio becomes a whole number; 0 where there is none.
  pure subroutine count_multiple(ratio, n)
    real(wp), intent(in) :: ratio   !< above 0
    integer, intent(out) :: n       !< the number of times
    integer :: i

    n = 0
    do i = 1, most_periods
      if (anint(i*ratio) < 0.5_wp .or. abs(i*ratio - anint(i*ratio)) > of_ratio*i*ratio) cycle
      n = i
      return
    end do
  end subroutine count_multiple

  !> Take another period into account.
  subroutine add_period(period, owner, place, found, err)
    real(wp), intent(in) :: period                      !< of a law [s]
    character(len=*), intent(in) :: owner               !< owner of the law
    type(place_type), intent(in) :: place               !< of its group
    type(law_period_type), intent(inout) :: found       !< the period so far
    type(error_type), allocatable, intent(out) :: err   !< allocated if there is no common multiple
    integer :: n

    if (found%owners /= '') found%owners = found%owners//', '
    found%owners = found%owners//trim(owner)//' ('//to_text(period, 10)//' s)'
    found%follows_time = .true.
    if (.not. found%period > 0.0_wp) then
      found%period = period
      return
    end if
    call count_multiple(found%period/period, n)
    if (n > 0) then
      found%period = n*found%period
    else
      call raise(err, exit_data, 'the periods of these have no common multiple: '//found%owners//'; no motion is periodic', place)
    end if
  end subroutine add_period

  !> The period of a motion that is driven: a multiple of that of its laws. Fails with exit_data where the given one is none.
  subroutine fit_period(laws, given, place, period, err)
    type(law_period_type), intent(in) :: laws           !< of the laws
    real(wp), intent(in) :: given                       !< by the user; 0: not given [s]
    type(place_type), intent(in) :: place               !< of the user's group
    real(wp), intent(out) :: period                     !< of the motion [s]
    type(error_type), allocatable, intent(out) :: err   !< allocated if there is none
    real(wp) :: times

    period = given
    if (.not. laws%is_known .and. .not. given > 0.0_wp) then
      call raise(err, exit_data, 'a user procedure gives the '//trim(laws%unknown)//', and its period is not known; give '// &
                 'period= in &periodic', place)
      return
    end if
    if (.not. laws%period > 0.0_wp) return
    period = laws%period
    if (.not. given > 0.0_wp) return
    ! the digits that were written may be fewer than those of the laws
    times = anint(given/laws%period)
    period = times*laws%period
    if (times > 0.5_wp .and. abs(given - period) <= of_given*given) return
    call raise(err, exit_data, 'the period '//to_text(given, 10)//' s is no multiple of the common period '// &
               to_text(laws%period, 10)//' s of these: '//laws%owners//'; leave period= out, or give a multiple', place)
  end subroutine fit_period
end module mech9_law_periods
