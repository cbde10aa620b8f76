!> Tests of the text of the progress line, and of its pacer in a loop that slows down.
module test_progress
  use mech9_program_kind, only: kinematics
  use mech9_kinds, only: wp
  use mech9_clock, only: seconds, pacer_type
  use mech9_progress, only: progress_line
  use mech9_version, only: version, version_text
  use mech9_testing, only: tester_type
  implicit none
  private
  public :: run

contains

  !> Run the cases of this suite.
  subroutine run(tester)
    type(tester_type), intent(inout) :: tester   !< selects cases and counts their checks

    if (tester%runs('test_line')) call test_line(tester)
    if (tester%runs('test_slow_pacer')) call test_slow_pacer(tester)
    if (tester%runs('test_version')) call test_version(tester)
  end subroutine run

  subroutine test_version(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks

    call tester%is_true(index(version_text(kinematics), 'mech9k '//version) == 1, 'the version tells program and version')
  end subroutine test_version

  subroutine test_line(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    character(len=79) :: line

    line = progress_line('run', 0.25_wp, 60.0_wp)
    call tester%is_true(line == 'run  25 % [######..................]  3:00 left', &
                        'a quarter took a minute, three are left: '//line)
    line = progress_line('run', 0.5_wp, 12.5_wp)
    call tester%is_true(index(line, '12 s left') > 0, 'a time below a minute is shown in seconds')
    line = progress_line('run', 1.0_wp/3.0_wp, 3631.0_wp)
    call tester%is_true(index(line, '2:01:02 left') > 0, 'a time above an hour is shown in hours')
    line = progress_line('run', 0.0_wp, 5.0_wp)
    call tester%is_true(index(line, '  0 % [......') > 0 .and. index(line, 'left') == 0, &
                        'a run of which nothing is done has no time left to tell')
    line = progress_line(repeat('long name ', 20), 1.0e-5_wp, 1.0e300_wp)
    call tester%is_true(index(line, '2400:00:00 left') > 0, 'the longest line fits')
    line = progress_line('run', 2.0_wp, 5.0_wp)
    call tester%is_true(index(line, '100 %') > 0 .and. index(line, '0 s left') > 0, 'a run shows no more than 100 per cent')
    line = progress_line('run', 0.95_wp, 10.0_wp, found=0.9_wp)
    call tester%is_true(index(line, ' 95 % [') > 0 .and. index(line, '10 s left') > 0, 'what was done before takes no time')
    line = progress_line('run', 0.25_wp, 60.0_wp, 'failed 3 (code 6), 12 (code 5)')
    call tester%is_true(line == 'run  25 % [######..................]  3:00 left  failed 3 (code 6), 12 (code 5)', &
                        'a note stands at the end: '//line)
    line = progress_line('run', 0.0_wp, 5.0_wp, 'failed 3 (code 6)')
    call tester%is_true(index(line, ']  failed 3') > 0, 'a note without a time left')
    line = progress_line('run', 0.25_wp, 60.0_wp, repeat('many words ', 20))
    call tester%is_true(index(line, 'many words many words') > 0, 'the line ends where a note is too long')
  end subroutine test_line

  !> After a fast stretch, a loop that slows down is noticed at the next look, 64 calls away at most.
  subroutine test_slow_pacer(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(pacer_type) :: pacer
    real(wp) :: pause
    integer :: i, first

    call pacer%start(0.02_wp)
    do i = 1, 1000
      if (pacer%due()) exit
    end do
    first = 0
    do i = 1, 66
      pause = seconds() + 0.001_wp
      do while (seconds() < pause)
      end do
      if (first == 0) then
        if (pacer%due()) first = i
      end if
    end do
    call tester%is_true(first > 0, 'an interruption is noticed within 64 calls and one')
  end subroutine test_slow_pacer
end module test_progress
