!> Evaluations of the motion of mixed structures: open chains with a four-bar at the tip, in the middle or at the base, modules of a
!> revolute pair and a four-bar in series, and trees of such modules, in the plane and in space.
!>
!> usage: bench_structures chain|tip|middle|base|modules|tree|four_bar|file plane|space N FILE [EVALUATIONS]
!> Writes the data file of the mechanism, reads it again, and prints one row: structure, plane or space, N, links, independent
!> coordinates, seconds to plan, microseconds an evaluation of the motion, megabytes of memory for data. With EVALUATIONS just
!> this number is made, for counts of instructions. `four_bar` is the four-bar alone; with `file` the data file is taken as it is.
program bench_structures
  use, intrinsic :: iso_fortran_env, only: error_unit
  use mech9_program_kind, only: dynamics
  use mech9_kinds, only: wp
  use mech9_error, only: error_type
  use mech9_text, only: to_text
  use mech9_clock, only: seconds
  use mech9_model, only: model_type
  use mech9_plan, only: plan_type
  use mech9_state, only: state_type
  use mech9_free_start, only: assemble_free
  use mech9_bench_support, only: read_data_file, stop_at, time_evaluations
  use mech9_bench_basics, only: argument
  implicit none

  !> A data file under construction: its groups, and the numbers given so far.
  type :: draft_type
    logical :: is_planar = .true.                   !< all pairs turn about z; otherwise those of the chain about x and y
    integer :: links = 1                            !< number of links so far
    integer :: coordinates = 0                      !< number of coordinates so far
    character(len=:), allocatable :: independent    !< numbers of the independent ones
    integer :: unit = 0                             !< of a file for the groups that follow those of the structure
  end type draft_type

  call run()
contains

  subroutine run()
    type(model_type), target :: model
    type(plan_type) :: plan
    type(state_type) :: start
    type(error_type), allocatable :: err
    real(wp) :: clock, planning, evaluation, memory
    integer :: n, evaluations, status
    character(len=:), allocatable :: word, kind

    kind = argument(1)
    word = argument(3)
    read (word, *, iostat=status) n
    if (status /= 0 .or. n < 1 .or. index(' chain tip middle base modules tree four_bar file ', ' '//kind//' ') == 0) then
      write (error_unit, '(a)') &
        'usage: bench_structures chain|tip|middle|base|modules|tree|four_bar|file plane|space N FILE [EVALUATIONS]'
      stop 1
    end if
    evaluations = 0
    word = argument(5)
    if (word /= '') read (word, *, iostat=status) evaluations
    if (kind /= 'file') call write_structure(argument(4), kind, argument(2) == 'plane', n)
    call read_data_file(argument(4), dynamics, model)
    clock = seconds()
    call assemble_free(model, plan, start, err)
    planning = seconds() - clock
    call stop_at(err, kind)
    call time_evaluations(model, plan, start, evaluations, evaluation, memory)
    print '(a,1x,a,3i8,f12.5,f14.4,f10.3)', kind, argument(2), n, plan%n_links, size(plan%independent), planning, &
      evaluation, memory
  end subroutine run

  !> Write the data file of a structure. Links of the chain are 1 m long and have 1 kg.
  subroutine write_structure(path, kind, is_planar, n)
    character(len=*), intent(in) :: path   !< of the data file
    character(len=*), intent(in) :: kind   !< chain, tip, middle, base, modules, tree or four_bar
    logical, intent(in) :: is_planar       !< all pairs turn about one direction
    integer, intent(in) :: n               !< links of the chain, or modules
    type(draft_type) :: draft
    integer :: unit, status, at, crank

    draft%is_planar = is_planar
    draft%independent = ''
    open (newunit=draft%unit, status='scratch', action='readwrite', iostat=status)
    if (status /= 0) stop 1
    select case (kind)
    case ('modules')
      call add_modules(draft, n)
    case ('tree')
      call add_tree(draft, n)
    case ('four_bar')
      call add_four_bar(draft, 1, 0.0_wp, 0.0_wp, crank)
    case default
      at = n + 1
      if (kind == 'tip') at = n
      if (kind == 'middle') at = n/2
      if (kind == 'base') at = 0
      call add_chain(draft, n, at, kind == 'tip')
    end select
    open (newunit=unit, file=path, action='write', status='replace', iostat=status)
    if (status /= 0) stop 1
    write (unit, '(a)') '&mechanism title='''//kind//''', links='//to_text(draft%links)//', coordinates='// &
      to_text(draft%coordinates)//' /', '&structure cq='//draft%independent(2:)//' /'
    call copy_lines(draft%unit, unit)
    write (unit, '(a)') '&gravity acceleration=0,-9.81,-1 /', '&time end=1, intervals=100 /'
    close (unit)
    close (draft%unit)
  end subroutine write_structure

  !> Copy the lines of one file to another.
  subroutine copy_lines(from, to)
    integer, intent(in) :: from   !< unit of the file that is read from its start
    integer, intent(in) :: to     !< unit of the file that is written
    character(len=200) :: line
    integer :: status

    rewind (from)
    do
      read (from, '(a)', iostat=status) line
      if (status /= 0) exit
      write (to, '(a)') trim(line)
    end do
  end subroutine copy_lines

  !> A chain of n links with a four-bar before link at + 1.
  subroutine add_chain(draft, n, at, ends)
    type(draft_type), intent(inout) :: draft   !< the data file
    integer, intent(in) :: n                   !< links of the chain
    integer, intent(in) :: at                  !< links before the four-bar; more than n for none
    logical, intent(in) :: ends                !< nothing follows the four-bar
    integer :: i, from, link, crank
    real(wp) :: along

    link = 1
    along = 0.0_wp
    do i = 0, n
      if (i == at) then
        call add_four_bar(draft, link, along, 0.0_wp, crank)
        if (.not. ends) link = crank
        if (.not. ends) along = along + 0.4_wp
      end if
      if (i == n) exit
      from = link
      call add_open_link(draft, from, along, 0.0_wp, 0.5_wp, link)
      along = along + 1.0_wp
    end do
  end subroutine add_chain

  !> Modules in series: a revolute pair, then a four-bar, whose crank carries the next module.
  subroutine add_modules(draft, n)
    type(draft_type), intent(inout) :: draft   !< the data file
    integer, intent(in) :: n                   !< modules
    integer :: i, crank, link

    crank = 1
    do i = 0, n - 1
      call add_open_link(draft, crank, 0.8_wp*i, 0.0_wp, 0.2_wp, link)
      call add_four_bar(draft, link, 0.8_wp*i + 0.4_wp, 0.0_wp, crank)
    end do
  end subroutine add_modules

  !> A binary tree of modules: the crank of each carries two others.
  subroutine add_tree(draft, n)
    type(draft_type), intent(inout) :: draft   !< the data file
    integer, intent(in) :: n                   !< modules
    integer :: i, from, crank(0:n), link
    real(wp) :: along(0:n)

    crank(0) = 1
    along(0) = 0.0_wp
    do i = 1, n
      from = ishft(i, -1)
      along(i) = along(from) + 0.8_wp
      call add_open_link(draft, crank(from), along(from), 0.05_wp*modulo(i, 2), 0.2_wp, link)
      call add_four_bar(draft, link, along(from) + 0.4_wp, 0.05_wp*modulo(i, 2), crank(i))
    end do
  end subroutine add_tree

  !> A link that turns freely on another one.
  subroutine add_open_link(draft, from, along, across, centre, link)
    type(draft_type), intent(inout) :: draft   !< the data file
    integer, intent(in) :: from                !< number of the link that carries it
    real(wp), intent(in) :: along              !< place of the pair along the chain [m]
    real(wp), intent(in) :: across             !< the same across it [m]
    real(wp), intent(in) :: centre             !< distance of the mass centre from the pair [m]
    integer, intent(out) :: link               !< number of the new link

    draft%links = draft%links + 1
    link = draft%links
    call add_revolute(draft, from, link, along, across, .true., .false.)
    call add_body(draft, link, along + centre, across)
  end subroutine add_open_link

  !> A four-bar of three new links on a link: crank, coupler and rocker.
  subroutine add_four_bar(draft, base, along, across, crank)
    type(draft_type), intent(inout) :: draft   !< the data file
    integer, intent(in) :: base                !< number of the link that carries it
    real(wp), intent(in) :: along              !< place of the crank's pair along the chain [m]
    real(wp), intent(in) :: across             !< the same across it [m]
    integer, intent(out) :: crank              !< number of the crank

    crank = draft%links + 1
    draft%links = draft%links + 3
    call add_revolute(draft, base, crank, along, across, .true., .true.)
    call add_revolute(draft, crank, crank + 1, along + 0.4_wp, across + 0.05_wp, .false., .true.)
    call add_revolute(draft, base, crank + 2, along, across + 0.45_wp, .false., .true.)
    call add_revolute(draft, crank + 1, crank + 2, along + 0.45_wp, across + 0.5_wp, .false., .true.)
    call add_body(draft, crank, along + 0.2_wp, across)
    call add_body(draft, crank + 1, along + 0.42_wp, across + 0.3_wp)
    call add_body(draft, crank + 2, along + 0.2_wp, across + 0.47_wp)
  end subroutine add_four_bar

  !> A revolute pair. In space those of the chain turn about x and y in alternation, those of four-bars about y.
  subroutine add_revolute(draft, reference, moving, along, across, is_independent, is_closed)
    type(draft_type), intent(inout) :: draft   !< the data file
    integer, intent(in) :: reference           !< number of its reference link
    integer, intent(in) :: moving              !< number of its moving link
    real(wp), intent(in) :: along              !< place along the chain [m]
    real(wp), intent(in) :: across             !< place across the chain [m]
    logical, intent(in) :: is_independent      !< its coordinate is independent
    logical, intent(in) :: is_closed           !< it belongs to a four-bar
    character(len=:), allocatable :: number
    character(len=5) :: axis

    draft%coordinates = draft%coordinates + 1
    number = to_text(draft%coordinates)
    axis = '0,1,0'
    if (modulo(draft%coordinates, 2) == 1 .and. .not. is_closed) axis = '1,0,0'
    if (draft%is_planar) axis = '0,0,1'
    write (draft%unit, '(a)') '&pair coordinate='//number//', links='//to_text(reference)//','//to_text(moving)// &
      ', kind=''revolute'', point='//place(draft, along, across)//', axis='//axis//' /'
    if (.not. is_independent) return
    draft%independent = draft%independent//','//number
    write (draft%unit, '(a)') '&initial coordinate='//number//', position=0.1, velocity=0.1 /'
  end subroutine add_revolute

  !> A body of 1 kg.
  subroutine add_body(draft, link, along, across)
    type(draft_type), intent(inout) :: draft   !< the data file
    integer, intent(in) :: link                !< number of the link
    real(wp), intent(in) :: along              !< place of the mass centre along the chain [m]
    real(wp), intent(in) :: across             !< place of the mass centre across the chain [m]

    write (draft%unit, '(a)') '&body link='//to_text(link)//', mass=1, centre='//place(draft, along, across)// &
      ', inertia=0.08,0.08,0.08,0,0,0 /'
  end subroutine add_body

  !> A place in the data file: the chain leads along x in the plane, along z in space.
  function place(draft, along, across) result(text)
    type(draft_type), intent(in) :: draft   !< the data file
    real(wp), intent(in) :: along           !< along the chain [m]
    real(wp), intent(in) :: across          !< across the chain [m]
    character(len=:), allocatable :: text

    text = to_text(across)//',0,'//to_text(along)
    if (draft%is_planar) text = to_text(along)//','//to_text(across)//',0'
  end function place
end program bench_structures
