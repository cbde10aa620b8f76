!> Time and memory against the number of links: ladders of four-bars, and open chains.
!>
!> usage: bench_growth ladder|chain N FILE
!> Writes the data file of the mechanism, reads it again, and prints one row: N, links, seconds to read, seconds to plan,
!> microseconds a position (ladder only), microseconds an evaluation of the motion, megabytes of memory at most.
program bench_growth
  use, intrinsic :: iso_fortran_env, only: error_unit
  use mech9_program_kind, only: kinematics, dynamics
  use mech9_kinds, only: wp
  use mech9_error, only: error_type
  use mech9_text, only: to_text
  use mech9_clock, only: seconds
  use mech9_model, only: model_type
  use mech9_plan, only: plan_type
  use mech9_state, only: state_type
  use mech9_driven_motion, only: driven_motion_type, start_driven_motion, advance
  use mech9_driven_simulation, only: assemble_driven
  use mech9_free_start, only: assemble_free
  use mech9_bench_support, only: read_data_file, stop_at, time_evaluations, passes, peak_memory
  use mech9_bench_basics, only: median, argument
  implicit none

  call run()
contains

  subroutine run()
    type(model_type), target :: model
    type(plan_type) :: plan
    type(state_type) :: start
    type(error_type), allocatable :: err
    real(wp) :: clock, reading, planning, position, evaluation, memory
    integer :: n, status
    character(len=:), allocatable :: word

    word = argument(2)
    read (word, *, iostat=status) n
    if (status /= 0 .or. n < 1) then
      write (error_unit, '(a)') 'usage: bench_growth ladder|chain N FILE'
      stop 1
    end if
    if (argument(1) == 'ladder') then
      call write_ladder(argument(3), n)
    else
      call write_chain(argument(3), n)
    end if
    clock = seconds()
    call read_data_file(argument(3), merge(kinematics, dynamics, argument(1) == 'ladder'), model)
    reading = seconds() - clock
    clock = seconds()
    if (argument(1) == 'ladder') then
      call assemble_driven(model, plan, start, err)
    else
      call assemble_free(model, plan, start, err)
    end if
    planning = seconds() - clock
    call stop_at(err, argument(1))
    position = 0.0_wp
    if (argument(1) == 'ladder') then
      call time_positions(model, plan, start, position)
      start%dq(plan%independent) = model%problem%initial%velocity(plan%independent)
    end if
    call time_evaluations(model, plan, start, 0, evaluation, memory)
    print '(2i8,2f12.5,2f14.4,f10.1)', n, plan%n_links, reading, planning, position, evaluation, peak_memory()
  end subroutine run

  !> Parallelograms side by side: N + 1 uprights of 1 m, N couplers, the first upright driven.
  subroutine write_ladder(path, n)
    character(len=*), intent(in) :: path   !< of the data file
    integer, intent(in) :: n               !< parallelograms
    integer :: unit, i, status

    open (newunit=unit, file=path, action='write', status='replace', iostat=status)
    if (status /= 0) stop 1
    write (unit, '(a)') '&mechanism title=''ladder'', links='//to_text(2*n + 2)//', coordinates='//to_text(3*n + 1)//' /', &
      '&structure cq=1 /'
    do i = 0, n
      call write_pair(unit, i + 1, 1, i + 2, i, 0)
    end do
    do i = 1, n
      call write_pair(unit, n + 2*i, i + 1, n + 2 + i, i - 1, 1)
      call write_pair(unit, n + 2*i + 1, i + 2, n + 2 + i, i, 1)
    end do
    do i = 0, n
      write (unit, '(a)') '&body link='//to_text(i + 2)//', mass=1, centre='//to_text(i)// &
        ',0.5,0, inertia=0.08,0,0.08,0,0,0 /'
    end do
    write (unit, '(a)') '&drive coordinate=1, kind=''polynomial'', coefficients=0,-1 /', &
      '&initial coordinate=1, position=0, velocity=-1 /', '&gravity acceleration=0,-9.81,0 /', '&time end=1, intervals=100 /'
    close (unit)
  end subroutine write_ladder

  subroutine write_pair(unit, coordinate, reference, moving, x, y)
    integer, intent(in) :: unit         !< of the open data file
    integer, intent(in) :: coordinate   !< of the pair
    integer, intent(in) :: reference    !< number of its reference link
    integer, intent(in) :: moving       !< number of its moving link
    integer, intent(in) :: x            !< of the pair along the first axis in the home position [m]
    integer, intent(in) :: y            !< the same along the second axis [m]

    write (unit, '(a)') '&pair coordinate='//to_text(coordinate)//', links='//to_text(reference)//','//to_text(moving)// &
      ', kind=''revolute'', point='//to_text(x)//','//to_text(y)//',0, axis=0,0,1 /'
  end subroutine write_pair

  !> Links of 1 m and 1 kg in a row, with axes x and y in alternation.
  subroutine write_chain(path, n)
    character(len=*), intent(in) :: path   !< of the data file
    integer, intent(in) :: n               !< moving links
    integer :: unit, i, status
    character(len=5) :: axis

    open (newunit=unit, file=path, action='write', status='replace', iostat=status)
    if (status /= 0) stop 1
    write (unit, '(a)') '&mechanism title=''chain'', links='//to_text(n + 1)//', coordinates='//to_text(n)//' /', &
      '&structure cq='//to_text([(i, i=1, n)], ',')//' /'
    do i = 1, n
      axis = merge('1,0,0', '0,1,0', modulo(i, 2) == 1)
      write (unit, '(a)') '&pair coordinate='//to_text(i)//', links='//to_text(i)//','//to_text(i + 1)// &
        ', kind=''revolute'', point=0,0,'//to_text(i - 1)//', axis='//axis//' /', &
        '&initial coordinate='//to_text(i)//', position=0.1, velocity=0.1 /', &
        '&body link='//to_text(i + 1)//', mass=1, centre=0,0,'//to_text(i - 0.5_wp)//', inertia=0.08,0.08,0,0,0,0 /'
    end do
    write (unit, '(a)') '&gravity acceleration=0,0,-9.81 /', '&time end=1, intervals=100 /'
    close (unit)
  end subroutine write_chain

  !> Median time of a position with velocities and accelerations [us].
  subroutine time_positions(model, plan, start, time)
    type(model_type), intent(in), target :: model   !< a ladder
    type(plan_type), intent(in) :: plan             !< its plan
    type(state_type), intent(in) :: start           !< assembled position at the start
    real(wp), intent(out) :: time                   !< of a position, median of the passes [us]
    type(driven_motion_type) :: driven
    type(error_type), allocatable :: err
    real(wp) :: each(passes), begin
    integer :: pass, i, positions

    ! a few thousandths of a turn between positions, and work enough for the clock
    positions = max(20, min(300, 100000/plan%n_links))
    do pass = 1, passes
      call start_driven_motion(model%problem%drives, plan, start, 0.0_wp, driven, err)
      call stop_at(err, 'ladder')
      begin = seconds()
      do i = 1, positions
        call advance(model%problem%drives, plan, driven, 0.003_wp*i, err)
        if (allocated(err)) exit
      end do
      each(pass) = (seconds() - begin)/positions
      call stop_at(err, 'ladder')
    end do
    time = 1.0e6_wp*median(each)
  end subroutine time_positions
end program bench_growth
