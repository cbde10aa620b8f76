!> The synthesis of a mechanism, which finds the designs that meet its objectives best, from many starts.
module mech9_synthesis
  use mech9_kinds, only: wp
  use mech9_error, only: error_type
  use mech9_system, only: interrupted
  use mech9_model, only: model_type
  use mech9_objective, only: crank_limit
  use mech9_variable_model, only: variable_model_type
  use mech9_plan, only: plan_type
  use mech9_state, only: state_type
  use mech9_planning, only: make_plan
  use mech9_design_space, only: design_space_type, design_type, new_design_space, new_design, fix_design_space
  use mech9_open_position, only: open_position_type, new_open_position
  use mech9_exact_fit, only: exact_fit_type, new_exact_fit
  use mech9_design_limits, only: design_limits_type, new_design_limits, find_limits
  use mech9_limited_fit, only: limited_fit_type, new_limited_fit, find_value
  use mech9_free_times, only: choose_pivots, gaps_of
  use mech9_closed_search, only: found_design_type
  use mech9_targets, only: target_type, gather_targets
  use mech9_planar_design, only: judge_plane
  use mech9_design_search, only: search_type, new_search, search_from
  implicit none
  private
  public :: synthesis_type, optimum_design_type, new_synthesis

  !> A distinct design to which starts led.
  type, extends(found_design_type) :: optimum_design_type
    integer :: starts = 0        !< number of starts that led to it
    integer :: last = 0          !< the last of them
  end type optimum_design_type

  !> A synthesis: its designs, its targets, and the optima so far, best first. It must not be copied.
  type :: synthesis_type
    type(design_space_type) :: space
    type(target_type), allocatable :: targets(:)
    type(optimum_design_type), allocatable :: optima(:)
    integer :: done = 0          !< number of starts that were made
    integer :: reached = 0       !< number of starts that led to a design that can move through the whole run
  contains
    procedure :: make_start
    procedure :: add
    procedure :: keep_verified
    procedure :: values_of
    procedure :: number_in_objective
  end type synthesis_type

  !> Designs are the same where their parameters differ by less than this part of their ranges,
  real(wp), parameter :: same_place = 1.0e-4_wp
  !> and their values by less than this part.
  real(wp), parameter :: same_value = 1.0e-5_wp
  !> Round-off of the sum of squares of differences of about one.
  real(wp), parameter :: round_off = 1.0e-20_wp

contains

  !> Prepare a synthesis. Fails where a parameter has no derivatives.
  subroutine new_synthesis(variable, model, plan, synthesis, err)
    class(variable_model_type), intent(inout), target :: variable   !< the model as a function of its parameters
    type(model_type), intent(in) :: model                           !< with the values of the data file, and its objectives
    type(plan_type), intent(in) :: plan                             !< its plan
    type(synthesis_type), intent(out) :: synthesis                  !< ready for starts
    type(error_type), allocatable, intent(out) :: err               !< allocated if it failed

    call new_design_space(variable, model, plan, synthesis%space, err)
    if (allocated(err)) return
    call judge_plane(synthesis%space)
    call gather_targets(model, synthesis%targets)
    allocate (synthesis%optima(0))
  end subroutine new_synthesis

  !> Search from one start. The result depends on the seed and the number of the start alone.
  subroutine make_start(self, space, seed, start, found)
    class(synthesis_type), intent(in) :: self                          !< the synthesis
    type(design_space_type), intent(inout), target :: space            !< its designs, of the calling thread
    integer, intent(in) :: seed                                        !< another seed gives other starts
    integer, intent(in) :: start                                       !< number of the start, from 1
    type(found_design_type), allocatable, intent(out) :: found(:)      !< designs to which it led; not allocated where the
                                                                       !< user interrupted it
    class(search_type), allocatable :: search

    allocate (search)
    call new_search(space, self%targets, search)
    call search_from(space, search, seed, start, found)
  end subroutine make_start

  !> Add the designs to which a start led to the optima. Starts are added in the order of their numbers.
  subroutine add(self, start, found)
    class(synthesis_type), intent(inout) :: self             !< the synthesis
    integer, intent(in) :: start                             !< number of the start
    type(found_design_type), intent(in) :: found(:)          !< designs to which it led
    type(optimum_design_type) :: new
    integer :: i, k

    self%done = self%done + 1
    if (any(found%found)) self%reached = self%reached + 1
    do i = 1, size(found)
      if (.not. found(i)%found) cycle
      new%found_design_type = found(i)
      new%starts = 1
      new%last = start
      do k = 1, size(self%optima)
        if (.not. is_same(self%space, found(i), self%optima(k))) cycle
        new%starts = self%optima(k)%starts + merge(0, 1, self%optima(k)%last == start)
        if (self%optima(k)%value <= new%value) new%found_design_type = self%optima(k)%found_design_type
        self%optima = [self%optima(:k - 1), self%optima(k + 1:)]
        exit
      end do
      k = count(self%optima%value <= new%value)
      self%optima = [self%optima(:k), new, self%optima(k + 1:)]
    end do
  end subroutine add

  !> Keep the optima whose motion is the same where their data file is read, planned and assembled anew.
  subroutine keep_verified(self)
    class(synthesis_type), intent(inout) :: self   !< the synthesis
    logical :: holds(size(self%optima))
    integer :: i

    do i = 1, size(holds)
      call verify(self, self%optima(i), holds(i))
    end do
    self%optima = pack_optima(self%optima, holds)
  end subroutine keep_verified

  !> The values of all parameters of an optimum.
  pure function values_of(self, number) result(values)
    class(synthesis_type), intent(in) :: self      !< the synthesis
    integer, intent(in) :: number                  !< of the optimum, from 1, the best one
    real(wp) :: values(size(self%space%values))

    values = self%space%values
    values(self%space%varied) = self%optima(number)%x
  end function values_of

  !> The number of a target among those of its objective, from 1.
  pure integer function number_in_objective(self, target)
    class(synthesis_type), intent(in) :: self      !< the synthesis
    integer, intent(in) :: target                  !< its number among all

    number_in_objective = count(self%targets(:target)%objective == self%targets(target)%objective)
  end function number_in_objective

  !> The optima that hold.
  pure function pack_optima(optima, holds) result(kept)
    type(optimum_design_type), intent(in) :: optima(:)   !< all
    logical, intent(in) :: holds(:)                      !< whether each is kept
    type(optimum_design_type), allocatable :: kept(:)
    integer :: i, n

    allocate (kept(count(holds)))
    n = 0
    do i = 1, size(optima)
      if (.not. holds(i)) cycle
      n = n + 1
      kept(n) = optima(i)
    end do
  end function pack_optima

  !> Follow the motion of an optimum with a separate plan, and compare its value. The search knows the start and the times of the
  !> last design that it tried; those of the optimum itself are found here.
  subroutine verify(self, optimum, holds)
    class(synthesis_type), intent(inout) :: self             !< the synthesis
    type(optimum_design_type), intent(inout) :: optimum      !< the optimum; gets its coordinates at the start and its times
    logical, intent(out) :: holds                            !< its motion has the value that was found
    class(design_space_type), allocatable, target :: alone
    class(design_type), allocatable :: design
    class(open_position_type), allocatable :: position
    class(exact_fit_type), allocatable, target :: fit
    class(design_limits_type), allocatable :: limits
    class(limited_fit_type), allocatable :: limited
    class(state_type), allocatable :: start
    type(error_type), allocatable :: err
    real(wp), allocatable :: at(:), parts(:), numbers(:), slopes(:, :)
    real(wp) :: all(size(self%space%values)), value

    ! quantities come from runs that are made anew; none are made any more after an interruption
    holds = .false.
    if (allocated(self%space%evaluator)) holds = interrupted()
    if (holds) return
    all = self%space%values
    all(self%space%varied) = optimum%x
    allocate (alone, design, position, fit, limits, limited, start)
    allocate (alone%model, alone%plan)
    call self%space%variable%at(all, alone%model, err)
    if (allocated(err)) return
    call make_plan(alone%model%mechanism, alone%model%problem%partition, optimum%q, alone%plan, start, err)
    if (allocated(err)) return
    alone%model%request = self%space%model%request
    if (allocated(self%space%evaluator)) allocate (alone%evaluator, source=self%space%evaluator)
    alone%values = all
    alone%varied = self%space%varied
    alone%low = self%space%low
    alone%high = self%space%high
    alone%tangents = self%space%tangents
    call fix_design_space(alone)
    call new_design(alone, design)
    call new_open_position(design, position)
    call new_exact_fit(alone, design, position, self%targets, fit)
    fit%q_start = start%q
    fit%stops_on_interruption = .false.
    parts = (optimum%times(fit%free%target) - fit%start)/(fit%end - fit%start)
    call choose_pivots(parts, fit%free)
    at = [(optimum%x - alone%low)/(alone%high - alone%low), gaps_of(parts, fit%free)]
    ! the fit follows the turn of cranks; how near it comes to singular positions depends on the size of the plan
    associate (all_limits => alone%model%request%limits)
      call new_design_limits(alone%plan, pack(all_limits, all_limits%kind /= crank_limit), limits)
    end associate
    call new_limited_fit(fit, limits, limited)
    allocate (numbers(limits%n), slopes(fit%n, limits%n))
    call find_value(limited, at, value, holds)
    if (.not. holds) return
    optimum%q = fit%q_trial
    optimum%times = fit%times
    holds = abs(value - optimum%value) <= same_value*abs(optimum%value) + round_off*(abs(value) + 1.0_wp)
    if (.not. holds .or. limits%n == 0) return
    call find_limits(limits, fit, numbers, slopes, holds)
    if (holds) holds = .not. any(numbers < 0.0_wp)
  end subroutine verify

  !> Whether two designs are the same but for small differences.
  pure logical function is_same(space, a, b)
    type(design_space_type), intent(in) :: space      !< the designs
    type(found_design_type), intent(in) :: a          !< a design
    class(found_design_type), intent(in) :: b         !< another one

    is_same = all(abs(a%x - b%x) <= same_place*(space%high - space%low)) .and. &
              abs(a%value - b%value) <= same_value*max(abs(a%value), abs(b%value)) + round_off
  end function is_same
end module mech9_synthesis
