!> The runs of a study, or of a part of it: choosing the next one to be made, and keeping those that are made.
!>
!> A maker of runs asks for a number (`hand_out`) and gives the run back when it is made (`take`). Several may do so at
!> a time, threads or processes, and runs may come back in any order. Only the calls must come one after the other.
!> Results are written and added up in the order of the numbers, hence with the same bits in any case. Runs that are
!> made before their turn wait; so few numbers are handed out ahead that memory stays bounded.
module mech9_study_runs
  use mech9_kinds, only: wp
  use mech9_error, only: error_type, add_place, raise, exit_done, exit_interrupted
  use mech9_text, only: to_text
  use mech9_counted, only: counted
  use mech9_explanation, only: explain
  use mech9_model, only: model_type
  use mech9_simulation, only: interruption_type
  use mech9_run_maker, only: made_run_type
  use mech9_study_sink, only: study_sink_type
  use mech9_study_sums, only: study_sums_type
  use mech9_end_class, only: end_classes_type
  use mech9_study_statistics, only: study_statistics_type
  implicit none
  private
  public :: study_runs_type, all_handed_out, wait_for_others

  !> Answers in place of the number of a run: there are no more runs, or some must be taken before others are handed
  !> out.
  integer, parameter :: all_handed_out = 0, wait_for_others = -1

  type :: study_runs_type
    type(study_sums_type) :: values                        !< sums of the parameters over all runs
    type(study_sums_type) :: sums                          !< sums of the quantities over the runs that went to their end
    type(study_statistics_type) :: statistics              !< how their quantities scatter, with a sample of them
    type(error_type), allocatable :: first_failure         !< of the first run that failed, with the number of the run
    type(error_type), allocatable :: stopped               !< allocated where runs cannot be kept, or the user interrupts
    class(study_sink_type), pointer, private :: sink => null()           !< takes the runs; not owned
    class(interruption_type), allocatable, private :: interruption       !< is asked whether the study shall stop
    integer, private :: first = 1                          !< number of the first run of the part
    integer, private :: step = 1                           !< from one run of the part to the next
    integer, private :: total = 0                          !< runs of the part
    integer, private :: handed_out = 0                     !< runs of the part that were handed out, the first ones
    integer, private :: written = 0                        !< runs of the part that are written, the first ones
    integer, private :: found = 0                          !< how many of these were made before
    type(made_run_type), allocatable, private :: made(:)   !< runs that wait for their turn, each at its place in a ring
    type(end_classes_type), private :: classes             !< of the ends of the runs so far, where they are told apart
    logical, allocatable, private :: before(:)             !< such a run was made before, and is still to be read from the file
  contains
    procedure :: begin
    procedure :: hand_out
    procedure :: left
    procedure :: take
    procedure :: finish
  end type study_runs_type

contains

  !> Begin the runs of part K of N parts: K, K + N, K + 2 N and so on, so that each part has its share of long ones.
  subroutine begin(self, model, sink, ahead, with_sample, interruption)
    class(study_runs_type), intent(inout) :: self                !< the runs
    type(model_type), intent(in) :: model                        !< the model with the values of the data file
    class(study_sink_type), intent(inout), target :: sink        !< takes the runs, and knows the part; it must outlive them
    integer, intent(in) :: ahead                                 !< most runs that are handed out before the first of them is shown
    logical, intent(in) :: with_sample                           !< a sample of the runs is kept for plots
    class(interruption_type), intent(in) :: interruption         !< is asked whether the study shall stop
    integer :: i

    self%sink => sink
    allocate (self%interruption, source=interruption)
    call self%values%begin(size(model%parameters))
    call self%sums%begin(size(model%request%quantities))
    self%first = sink%part(1)
    self%step = sink%part(2)
    if (self%first <= model%request%study%runs) self%total = 1 + (model%request%study%runs - self%first)/self%step
    call self%statistics%begin(model, self%total, with_sample)
    allocate (self%made(0:ahead - 1))
    do i = 0, ahead - 1
      allocate (self%made(i)%values(size(model%parameters)), self%made(i)%quantities(size(model%request%quantities)))
    end do
    allocate (self%before(0:ahead - 1), source=.false.)
  end subroutine begin

  !> The number of a run to be made next; or all_handed_out, or wait_for_others: ask again when another run was taken. Runs that
  !> were made before are not handed out.
  integer function hand_out(self) result(number)
    class(study_runs_type), intent(inout) :: self   !< the runs

    do
      call write_ready(self)
      if (self%interruption%is_wanted()) call stop_here(self)
      number = all_handed_out
      if (allocated(self%stopped) .or. self%handed_out == self%total) return
      number = wait_for_others
      if (self%handed_out == self%written + size(self%made)) return
      self%handed_out = self%handed_out + 1
      number = self%first + (self%handed_out - 1)*self%step
      associate (before => self%before(modulo(self%handed_out, size(self%made))))
        before = self%sink%is_made(self%handed_out)
        if (.not. before) return
      end associate
    end do
  end function hand_out

  !> How many runs of the part were not handed out so far.
  pure integer function left(self)
    class(study_runs_type), intent(in) :: self   !< the runs

    left = self%total - self%handed_out
  end function left

  !> Take a run that is made.
  subroutine take(self, run)
    class(study_runs_type), intent(inout) :: self   !< the runs
    type(made_run_type), intent(in) :: run          !< the run
    integer :: place

    if (run%exit_code == exit_interrupted) call stop_here(self)
    if (allocated(self%stopped)) return
    place = 1 + (run%number - self%first)/self%step
    call keep(run, self%made(modulo(place, size(self%made))))
    call self%sink%write_run(place, run, self%stopped)
    call write_ready(self)
  end subroutine take

  !> Keep a run until its turn comes, without its rows, which may be large.
  subroutine keep(run, kept)
    type(made_run_type), intent(in) :: run         !< the run
    type(made_run_type), intent(inout) :: kept     !< its place; its arrays are allocated

    kept%number = run%number
    kept%values = run%values
    kept%quantities = run%quantities
    kept%exit_code = run%exit_code
    if (allocated(kept%points)) deallocate (kept%points)
    if (allocated(run%points)) kept%points = run%points
    if (allocated(kept%cycle)) deallocate (kept%cycle, kept%unit, kept%turns)
    if (allocated(run%cycle)) then
      kept%cycle = run%cycle
      kept%unit = run%unit
      kept%turns = run%turns
    end if
    kept%range = run%range
    if (allocated(kept%failure)) deallocate (kept%failure)
    if (allocated(run%failure)) kept%failure = run%failure
  end subroutine keep

  !> Show and add up the runs whose turn has come.
  subroutine write_ready(self)
    class(study_runs_type), intent(inout) :: self   !< the runs
    integer :: i

    do while (self%written < self%handed_out .and. .not. allocated(self%stopped))
      i = modulo(self%written + 1, size(self%made))
      if (self%before(i)) call self%sink%read_run(self%written + 1, self%made(i))
      if (self%made(i)%number /= self%first + self%written*self%step) exit
      associate (made => self%made(i))
        ! the numbers of classes follow the order of the runs
        if (allocated(made%cycle)) &
          made%quantities(size(made%quantities)) = self%classes%class_of(made%cycle, made%unit, made%turns)
      end associate
      call add_up(self, self%made(i))
      call self%sink%show_run(self%made(i), self%stopped)
      if (self%before(i)) self%found = self%found + 1
      self%before(i) = .false.
      self%written = self%written + 1
      call self%sink%tell_progress(real(self%written, wp)/self%total, real(self%found, wp)/self%total, self%sums)
    end do
  end subroutine write_ready

  !> Stop at the user's request.
  subroutine stop_here(self)
    type(study_runs_type), intent(inout) :: self   !< the runs

    if (allocated(self%stopped)) return
    call raise(self%stopped, exit_interrupted, 'interrupted: '//to_text(self%written)//' of '//counted(self%total, 'run')// &
               ' are finished')
  end subroutine stop_here

  !> Add a run to the sums.
  subroutine add_up(self, run)
    class(study_runs_type), intent(inout) :: self   !< the runs
    type(made_run_type), intent(in) :: run          !< the run

    call self%values%add(run%values)
    if (run%exit_code == exit_done) then
      call self%sums%add(run%quantities)
      call self%statistics%add(run%values, run%quantities)
      return
    end if
    call self%sums%add_failure(run%number, run%exit_code)
    if (allocated(self%first_failure)) return
    if (allocated(run%failure)) then
      self%first_failure = run%failure
      call explain(self%first_failure)
    else
      call raise(self%first_failure, run%exit_code, 'failed when the file was begun; a single run with its values tells why')
    end if
    call add_place(self%first_failure, 'run '//to_text(run%number))
  end subroutine add_up

  !> End, and close the sink.
  subroutine finish(self, err)
    class(study_runs_type), intent(inout) :: self        !< the runs
    type(error_type), allocatable, intent(out) :: err    !< allocated if the study was stopped, or its runs could not be kept
    type(error_type), allocatable :: at_close

    call write_ready(self)
    call self%sink%close(at_close)
    if (.not. allocated(self%stopped)) call move_alloc(at_close, self%stopped)
    if (allocated(self%stopped)) err = self%stopped
  end subroutine finish
end module mech9_study_runs
