!> Wrong choices of independent coordinates: too many, too few, or such that depend on each other. They
!> must be refused, the right ones not, and the set that the message says would serve must serve.
module test_choice_of_inputs
  use mech9_kinds, only: wp
  use mech9_error, only: error_type, exit_structure
  use mech9_random, only: random_type
  use mech9_model, only: model_type
  use mech9_plan, only: plan_type
  use mech9_state, only: state_type
  use mech9_planning, only: make_plan
  use mech9_mechanism_families, only: axis_type, planar_axes, spatial_axes, home_mechanism, random_links
  use mech9_home_motions, only: loop_equations, choose_dependent
  use mech9_testing, only: tester_type, message_of
  implicit none
  private
  public :: run

contains

  !> Run the cases of this suite.
  subroutine run(test)
    type(tester_type), intent(inout) :: test   !< selects cases and counts their checks

    if (test%runs('random_mechanisms')) call random_mechanisms(test)
  end subroutine run

  subroutine random_mechanisms(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    integer :: i, n
    type(random_type) :: random
    integer :: refused
    integer :: accepted

    refused = 0
    accepted = 0
    do i = 1, 40
      n = 4 + modulo(7*i, 17)
      call try(test, random, refused, accepted, 'planar', n, 1 + n/5, .true.)
      call try(test, random, refused, accepted, 'spatial', n + 6, 1 + n/10, .false.)
    end do
    print '(2(i0,a))', refused, ' choices refused, ', accepted, ' accepted'
    call test%is_true(refused > 200 .and. accepted > 20, 'coordinates that can serve and that cannot serve both happened often')
  end subroutine random_mechanisms

  subroutine try(test, random, refused, accepted, name, n_links, loops, planar)
    type(tester_type), intent(inout) :: test     !< counts the checks
    type(random_type), intent(inout) :: random   !< source of the numbers
    integer, intent(inout) :: refused            !< choices that were refused
    integer, intent(inout) :: accepted           !< choices that were accepted
    character(len=*), intent(in) :: name         !< of the mechanism, for the report of a failure
    integer, intent(in) :: n_links               !< links, the frame included
    integer, intent(in) :: loops                 !< closed chains
    logical, intent(in) :: planar                !< all axes are parallel
    integer, allocatable :: links(:, :)
    type(axis_type), allocatable :: axes(:)
    real(wp), allocatable :: equations(:, :)
    logical, allocatable :: dependent(:), changed(:)
    type(model_type) :: model
    integer :: k, kind

    allocate (links, source=random_links(n_links, loops, random))
    if (planar) axes = planar_axes(size(links, 2), 0, random)
    if (.not. planar) axes = spatial_axes(size(links, 2), 4, random)
    call loop_equations(n_links, links, axes, equations)
    allocate (dependent(size(axes)))
    call choose_dependent(equations, random, dependent)
    do kind = 1, 6
      changed = dependent
      ! 1, 2: one too few; 3, 4: one too many; 5, 6: as many as before, but others
      if (any(kind == [1, 2, 5, 6])) call change_one(random, changed, .true.)
      if (any(kind == [3, 4, 5, 6])) call change_one(random, changed, .false.)
      call home_mechanism(n_links, links, axes, pack([(k, k=1, size(axes))], .not. changed), model)
      call check(test, random, refused, accepted, name, model, equations, count(dependent), changed)
    end do
  end subroutine try

  !> Make a coordinate, chosen at random among the others, dependent or independent.
  subroutine change_one(random, dependent, to)
    type(random_type), intent(inout) :: random   !< source of the numbers
    logical, intent(inout) :: dependent(:)       !< (M) coordinates that follow from the others
    logical, intent(in) :: to                    !< it becomes dependent
    integer :: k, trial

    do trial = 1, 1000
      k = 1 + int(0.4999_wp*(1.0_wp + random%symmetric())*size(dependent))
      if (dependent(k) .eqv. to) cycle
      dependent(k) = to
      return
    end do
  end subroutine change_one

  !> Whether these dependent coordinates follow from the others, by the rank of their columns.
  logical function serves(random, equations, rank, dependent)
    type(random_type), intent(inout) :: random   !< source of the numbers
    real(wp), intent(in) :: equations(:, :)      !< (6 loops,M) that the rates satisfy
    integer, intent(in) :: rank                  !< of the equations
    logical, intent(in) :: dependent(:)          !< (M) coordinates that follow from the others
    real(wp) :: columns(size(equations, 1), size(equations, 2))
    logical :: chosen(size(dependent))
    integer :: k

    columns = equations
    do k = 1, size(dependent)
      if (.not. dependent(k)) columns(:, k) = 0.0_wp
    end do
    call choose_dependent(columns, random, chosen)
    serves = count(dependent) == rank .and. count(chosen) == rank
  end function serves

  subroutine check(test, random, refused, accepted, name, model, equations, rank, dependent)
    type(tester_type), intent(inout) :: test     !< counts the checks
    type(random_type), intent(inout) :: random   !< source of the numbers
    integer, intent(inout) :: refused            !< choices that were refused
    integer, intent(inout) :: accepted           !< choices that were accepted
    character(len=*), intent(in) :: name         !< of the mechanism, for the report of a failure
    type(model_type), intent(in) :: model        !< the model
    real(wp), intent(in) :: equations(:, :)      !< (6 loops,M) that the rates satisfy
    integer, intent(in) :: rank                  !< of the equations
    logical, intent(in) :: dependent(:)          !< (M) coordinates that follow from the others
    type(plan_type) :: plan
    type(state_type) :: state
    type(error_type), allocatable :: err
    integer, allocatable :: proposed(:)
    integer :: k

    call make_plan(model%mechanism, model%problem%partition, model%problem%initial%position, plan, state, err)
    if (serves(random, equations, rank, dependent)) then
      accepted = accepted + 1
      call test%no_error(err, name//': coordinates that can serve are accepted')
      return
    end if
    refused = refused + 1
    call test%has_error(err, exit_structure, name//': coordinates that cannot serve are refused')
    if (.not. allocated(err)) return
    if (rank == size(dependent)) then
      call test%is_true(index(message_of(err), 'cannot move') > 0, name//': the message says that the mechanism cannot move')
      return
    end if
    proposed = numbers_after(message_of(err), 'cq = ')
    call test%is_true(size(proposed) == size(dependent) - rank, &
                      name//': as many coordinates are proposed as there are degrees of freedom')
    call test%is_true(serves(random, equations, rank, [(all(proposed /= k), k=1, size(dependent))]), &
                      name//': the proposed coordinates serve ('//message_of(err)//')')
  end subroutine check

  !> The numbers separated by commas that follow a mark.
  function numbers_after(text, mark) result(numbers)
    character(len=*), intent(in) :: text   !< of a message
    character(len=*), intent(in) :: mark   !< text before the numbers
    integer, allocatable :: numbers(:)
    character(len=:), allocatable :: list
    integer :: i, status

    list = text(index(text, mark) + len(mark):)
    list = list(:verify(list//'x', '0123456789, ') - 1)
    allocate (numbers(1 + count([(list(i:i) == ',', i=1, len(list))])))
    read (list, *, iostat=status) numbers
    if (status /= 0) numbers = 0
  end function numbers_after
end module test_choice_of_inputs
