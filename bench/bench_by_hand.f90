!> Accelerations of mechanisms that are derived by hand, the limits of a general program.
!>
!> usage: bench_by_hand full|quick
!> Prints a row for each mechanism: its name, microseconds an evaluation, and the accelerations of its independent coordinates at
!> the start of its data file.
program bench_by_hand
  use mech9_kinds, only: wp
  use mech9_clock, only: seconds
  use mech9_closed_andrews, only: andrews_acceleration
  use mech9_closed_structures, only: two_link_accelerations, four_bar_acceleration
  use mech9_bench_basics, only: median, argument
  implicit none

  !> Angle of the crank at the start of Andrews' mechanism [rad].
  real(wp), parameter :: andrews_start = -0.0617138900142764496358948_wp
  !> Angles and rates of the structures of bench_structures at the start [rad, rad/s].
  real(wp), parameter :: start(2) = [0.1_wp, 0.1_wp]
  !> Distance of neighbouring evaluations, so that none can be saved [rad].
  real(wp), parameter :: apart = 1.0e-7_wp
  integer, parameter :: most_passes = 15

  call run()
contains

  subroutine run()
    real(wp) :: times(3, most_passes), begin, total
    integer :: passes, evaluations, pass, i

    passes = merge(3, most_passes, argument(1) == 'quick')
    evaluations = merge(1000, 100000, argument(1) == 'quick')
    total = 0.0_wp
    do pass = 1, passes
      begin = seconds()
      do i = 1, evaluations
        total = total + sum(two_link_accelerations(start + i*apart, start))
      end do
      times(1, pass) = seconds() - begin
      begin = seconds()
      do i = 1, evaluations
        total = total + four_bar_acceleration(start(1) + i*apart, start(2))
      end do
      times(2, pass) = seconds() - begin
      begin = seconds()
      do i = 1, evaluations
        total = total + andrews_acceleration(andrews_start + i*apart, 0.0_wp)
      end do
      times(3, pass) = seconds() - begin
    end do
    times(:, :passes) = times(:, :passes)/evaluations*1.0e6_wp
    ! the sum is used, so that the loops are not optimised away
    if (total > huge(total)) times = 0.0_wp
    print '(a,f12.5,2es25.16)', 'two_links', median(times(1, :passes)), two_link_accelerations(start, start)
    print '(a,f12.5,2es25.16)', 'four_bar', median(times(2, :passes)), four_bar_acceleration(start(1), start(2))
    print '(a,f12.5,2es25.16)', 'andrews', median(times(3, :passes)), andrews_acceleration(andrews_start, 0.0_wp)
  end subroutine run
end program bench_by_hand
