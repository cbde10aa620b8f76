!> Damaged data files: thousands of right ones with bytes changed, lines shuffled, pieces cut out, doubled or put
!> in. Whatever they have become, they are read, or refused with a message and an exit code; never a crash.
module test_fuzz
  use mech9_kinds, only: wp
  use mech9_program_kind, only: kinematics, dynamics
  use mech9_error, only: exit_data, exit_structure, exit_file
  use mech9_random, only: random_type
  use mech9_source, only: source_from_text
  use mech9_document, only: document_type
  use mech9_diagnostics, only: diagnostics_type
  use mech9_parser, only: parse_document
  use mech9_setting, only: apply_setting
  use mech9_reader, only: read_model, read_structure_only
  use mech9_model, only: model_type
  use mech9_structure, only: structure_type
  use mech9_partition, only: partition_type
  use mech9_testing, only: tester_type
  use mech9_input_support, only: printed, slider_crank, eol
  implicit none
  private
  public :: run

  integer, parameter :: runs = 6000
  character(len=*), parameter :: everything = slider_crank// &
    "&user parameters=3*0.5, 7 / ! numbers"//eol// &
    "&body link=3, mass=2, centre=1,2,3, inertia=4,5,6,0.1,0.2,0.3 /"//eol// &
    "&gravity acceleration=0,-9.81,0 / &solver method='adams', relative_tolerance=1e-9, maximum_steps=77 /"//eol// &
    "&output table='a b.dat' hdf5='x.h5'/"//eol// &
    "&load kind='spring', links=1,3, position=0,0,0, second_position=3*1.0, stiffness=20, free_length=1, damping=.1 /"//eol// &
    "&load kind='force', link=2, force=1,2,3, frame='link' / &load kind='coordinate', coordinate=2, rest=1 /"//eol
  character(len=*), parameter :: second_set = "&mechanism angle_unit='deg' /"//eol// &
    "&structure nrg=1,2,3,1  nws=0,1,2,3  rdw=2*1,2*0  nrw=3*0,1 cq=1 /"//eol// &
    "&pair coordinate=1, links=1,2, kind='helical', axis=0,0,1, pitch=0.1, moving_axis=1,1,1 /"//eol// &
    "&pair coordinate=2, links=2,3, kind='revolute', dh=0.1, 90, 0, 30 /"//eol// &
    "&pair coordinate=3, links=3,1, kind='prismatic', axis(1)=1 axis(2:3)=0,0 /"//eol// &
    "&drive coordinate=1, kind='harmonic', mean=2, amplitude=3, angular_frequency=90, phase=30 /"//eol
  character(len=12), parameter :: pieces(24) = [character(len=12) :: '/', '&', "'", '"', ',', '=', '(', ')', '(:,', ':', &
    '999999999*', '1e308', '-', '1e-320', 'NaN', '&pair', '&structure', 'c(9,9)=1', 'cq=', '2147483647', &
    '99999999999', achar(0), char(255), 'axis(1)=']

contains

  !> Run the cases of this suite.
  subroutine run(tester)
    type(tester_type), intent(inout) :: tester   !< selects cases and counts their checks

    if (tester%runs('damaged_files')) call damaged_files(tester)
    if (tester%runs('damaged_settings')) call damaged_settings(tester)
  end subroutine run

  subroutine damaged_files(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    character(len=:), allocatable :: text
    integer :: i
    type(random_type) :: random
    integer :: refused

    refused = 0
    do i = 1, runs
      text = everything
      if (mod(i, 3) == 0) text = second_set
      call damage(random, text)
      call try(tester, refused, text, i)
    end do
    call tester%is_true(refused > runs/2, 'most of the damaged files are refused')
    call tester%is_true(refused < runs, 'some of the damaged files are accepted')
  end subroutine damaged_files

  !> A whole number from 1 to n.
  integer function dice(random, n)
    type(random_type), intent(inout) :: random   !< source of the numbers
    integer, intent(in) :: n                     !< greatest number

    dice = min(n, 1 + int(0.5_wp*(random%symmetric() + 1.0_wp)*n))
  end function dice

  !> One to four changes.
  subroutine damage(random, text)
    type(random_type), intent(inout) :: random             !< source of the numbers
    character(len=:), allocatable, intent(inout) :: text   !< of a data file, changed
    integer :: i

    do i = 1, dice(random, 4)
      if (len(text) < 2) return
      select case (dice(random, 7))
      case (1)
        call change_byte(random, text)
      case (2)
        text = text(:dice(random, len(text)))
      case (3)
        call move_line(random, text)
      case (4)
        call cut_or_double(random, text, .false.)
      case (5)
        call cut_or_double(random, text, .true.)
      case default
        call put_piece(random, text)
      end select
    end do
  end subroutine damage

  subroutine change_byte(random, text)
    type(random_type), intent(inout) :: random   !< source of the numbers
    character(len=*), intent(inout) :: text      !< of a data file, changed
    integer :: at

    at = dice(random, len(text))
    text(at:at) = char(dice(random, 256) - 1)
  end subroutine change_byte

  subroutine put_piece(random, text)
    type(random_type), intent(inout) :: random             !< source of the numbers
    character(len=:), allocatable, intent(inout) :: text   !< of a data file, made longer
    integer :: at

    at = dice(random, len(text))
    text = text(:at)//trim(pieces(dice(random, size(pieces))))//text(at + 1:)
  end subroutine put_piece

  subroutine cut_or_double(random, text, double)
    type(random_type), intent(inout) :: random             !< source of the numbers
    character(len=:), allocatable, intent(inout) :: text   !< of a data file, changed
    logical, intent(in) :: double                          !< a part of it is doubled, not cut
    integer :: first, last

    first = dice(random, len(text))
    last = min(len(text), first + dice(random, 60))
    if (double) then
      text = text(:last)//text(first:)
    else
      text = text(:first - 1)//text(last + 1:)
    end if
  end subroutine cut_or_double

  !> Take the line around some place and put it before another one.
  subroutine move_line(random, text)
    type(random_type), intent(inout) :: random             !< source of the numbers
    character(len=:), allocatable, intent(inout) :: text   !< of a data file, changed
    character(len=:), allocatable :: line
    integer :: at, first, last

    at = dice(random, len(text))
    first = index(text(:at), eol, back=.true.) + 1
    last = min(len(text), first - 1 + index(text(first:)//eol, eol))
    line = text(first:last)
    text = text(:first - 1)//text(last + 1:)
    if (len(text) == 0) return
    at = dice(random, len(text))
    first = index(text(:at), eol, back=.true.) + 1
    text = text(:first - 1)//line//text(first:)
  end subroutine move_line

  subroutine try(tester, refused, text, number)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    integer, intent(inout) :: refused            !< files that were refused
    character(len=*), intent(in) :: text         !< of a damaged data file
    integer, intent(in) :: number                !< of the trial
    type(document_type) :: document
    type(diagnostics_type) :: diagnostics, again
    type(model_type) :: model
    type(structure_type) :: structure
    type(partition_type) :: partition

    call parse_document(source_from_text('test.nml', text), document, diagnostics)
    again = diagnostics
    call read_model(document, merge(kinematics, dynamics, mod(number, 2) == 0), model, diagnostics)
    call read_structure_only(document, structure, partition, again)
    if (diagnostics%failed()) refused = refused + 1
    call judge(tester, diagnostics, text)
    call judge(tester, again, text)
    if (.not. diagnostics%failed()) call tester%is_true(is_whole(model), 'a file that is accepted is whole:'//eol//text)
  end subroutine try

  subroutine forget(diagnostics)
    type(diagnostics_type), intent(out) :: diagnostics   !< emptied
  end subroutine forget

  !> Either nothing is wrong and nothing is printed, or there is a message and its code.
  subroutine judge(tester, diagnostics, text)
    type(tester_type), intent(inout) :: tester          !< counts the checks
    type(diagnostics_type), intent(in) :: diagnostics   !< of the damaged text
    character(len=*), intent(in) :: text                !< of the damaged data file
    character(len=:), allocatable :: answer

    answer = printed(diagnostics)
    if (diagnostics%failed()) then
      call tester%is_true(any(diagnostics%code() == [exit_data, exit_structure, exit_file]), &
                          'a refused file has one of the codes of bad input:'//eol//text)
      call tester%is_true(index(answer, ': ') > 0 .and. index(answer, achar(0)) == 0, 'a refused file has a message:'//eol//text)
    else
      call tester%is_true(answer == '' .and. diagnostics%code() == 0, 'an accepted file has no message and no code:'//eol//text)
    end if
  end subroutine judge

  logical function is_whole(model)
    type(model_type), intent(in) :: model   !< read without an error
    integer :: k

    is_whole = size(model%mechanism%pairs) == model%mechanism%structure%n_coordinates .and. &
               size(model%problem%partition%vectors%nrg) > 1
    do k = 1, size(model%mechanism%pairs)
      is_whole = is_whole .and. allocated(model%mechanism%pairs(k)%pair)
    end do
    do k = 1, size(model%problem%drives)
      is_whole = is_whole .and. allocated(model%problem%drives(k)%drive)
    end do
  end function is_whole

  !> Damaged settings on a right file.
  subroutine damaged_settings(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    character(len=*), parameter :: settings(4) = [character(len=24) :: 'time.intervals=7', 'pair(2).axis(1)=0.5', &
                                                 'structure.c(1,:)=0,1,0,4', "output.table='x.dat'"]
    character(len=:), allocatable :: text
    type(document_type) :: document
    type(diagnostics_type) :: diagnostics
    type(model_type) :: model
    integer :: i
    type(random_type) :: random

    do i = 1, runs/4
      text = trim(settings(1 + mod(i, 4)))
      call damage(random, text)
      call forget(diagnostics)
      call parse_document(source_from_text('test.nml', everything), document, diagnostics)
      call apply_setting(document, text, diagnostics)
      call read_model(document, kinematics, model, diagnostics)
      call judge(tester, diagnostics, text)
    end do
  end subroutine damaged_settings
end module test_fuzz
