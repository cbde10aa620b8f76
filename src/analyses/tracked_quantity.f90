!> A quantity while a motion goes on: its column is followed between the outputs by polynomials.
!>
!> A column that comes with its rate and acceleration, or is one of these, is a polynomial through four neighbouring outputs with
!> two derivatives each. Others are polynomials through values at further times, which the motion must visit. No polynomial goes
!> across a joint of a law or an event: the motion visits both sides of it, which count as outputs here. Where a motion cannot stand at an
!> event, chords take the place of polynomials between two outputs, and there are no derivatives. Those of the column by parameters are
!> followed by polynomials of the same kind, so that they are those of the number that is found.
module mech9_tracked_quantity
  use mech9_kinds, only: wp
  use mech9_chebyshev, only: chebyshev_type
  use mech9_smooth_pieces, only: smooth_piece_type
  use mech9_hermite, only: hermite_type, build_hermite
  use mech9_interval_polynomials, only: polynomial, values_between, changes_between, changes_at, moved_with, &
    by_positions, best_known, value_between
  use mech9_quantity_sums, only: quantity_sums_type
  use mech9_quantity_gradient, only: quantity_gradient_type
  implicit none
  private
  public :: tracked_quantity_type, outputs_about

  integer, parameter :: most_outputs = 4   !< outputs through which a polynomial goes
  !> Largest difference of the polynomials through two and through all outputs, over the variation of the column, with which the
  !> motion counts as smooth there; else the polynomial goes through the two outputs alone.
  real(wp), parameter :: smooth_difference = 1.0e-3_wp
  !> Outputs nearer to each other than this part of an interval beside them take no part in its polynomial: they enlarge round-off by its
  !> fifth power.
  real(wp), parameter :: least_neighbour = 0.1_wp

  type :: tracked_quantity_type
    character(len=8) :: take = ''           !< start, end, min, max, peak, range, mean, rms, integral or at
    real(wp) :: at = 0.0_wp                 !< time of the value where `take` is at [s]
    integer :: column = 0                   !< number of its column
    integer :: family(0:2) = 0              !< columns of a position, its rate and its acceleration; 0 where they are not known
    integer :: order = 0                    !< of its column: 0 position, 1 rate, 2 acceleration
    real(wp) :: weights(0:2) = 1.0_wp       !< factors of the family to numbers whose derivatives by time are the next ones
    type(quantity_sums_type) :: sums
    integer, allocatable :: changes(:, :)   !< (P,0:2) columns of the derivatives of the family by parameters, or (P,0:0) of the
                                            !< column alone; not allocated where they are not followed
    type(quantity_gradient_type) :: gradient              !< of the number, where derivatives are followed
    real(wp), private :: value_at = 0.0_wp  !< value at the time `at`
    integer, private :: seen = 0            !< outputs so far
    logical, private :: has_extremes = .false.   !< a piece has begun
    logical, private :: at_joint(most_outputs) = .false.   !< each of the outputs kept is at a joint
    real(wp), allocatable, private :: rate(:, :) !< (P,most_outputs) derivatives of the times of these joints by parameters
    logical, private :: is_cut = .false.    !< a joint was reached, and no piece has begun since then
    real(wp), private :: value_before = 0.0_wp   !< value before this joint
    integer, private :: count = 0           !< outputs kept
    real(wp), private :: longest = 0.0_wp   !< longest interval between two of them so far [s]
    logical, private :: waits(2) = .false.  !< the least and the largest value are at a joint before short pieces, and move with its time
    real(wp), private :: joint_before = 0.0_wp   !< time of this joint [s]
    real(wp), allocatable, private :: rate_before(:)   !< (P) its derivatives by parameters
    integer, private :: done = 0            !< intervals between these that were taken into account
    real(wp), private :: t(most_outputs) = 0.0_wp
    real(wp), private :: y(0:2, most_outputs) = 0.0_wp    !< position, rate and acceleration at the kept outputs
    real(wp), allocatable, private :: dy(:, :, :)         !< (P,most_outputs,0:2) their derivatives by parameters
  contains
    procedure :: follow_changes
    procedure :: changes_of
    procedure :: needs_piece
    procedure :: follows
    procedure :: take_output
    procedure :: take_at
    procedure :: begin_piece
    procedure :: end_piece
    procedure :: counts_turns
    procedure :: begin_motion
    procedure :: take_interval
    procedure :: finish
    procedure :: number
    procedure :: find_gradient
  end type tracked_quantity_type

contains

  !> Follow the derivatives of the column by parameters, too.
  pure subroutine follow_changes(self, columns)
    class(tracked_quantity_type), intent(inout) :: self   !< the quantity, with its columns
    integer, intent(in) :: columns(:, 0:)                 !< (P,0:2) of the derivatives of the family; (P,0:0) of the column alone

    allocate (self%changes(size(columns, 1), 0:ubound(columns, 2)), source=columns)
    allocate (self%rate(size(columns, 1), most_outputs), source=0.0_wp)
    if (self%family(0) > 0) allocate (self%dy(size(columns, 1), most_outputs, 0:2), source=0.0_wp)
  end subroutine follow_changes

  !> The derivatives of the column by the parameters in a row.
  pure function changes_of(self, row) result(changes)
    class(tracked_quantity_type), intent(in) :: self   !< the quantity, whose derivatives are followed
    real(wp), intent(in) :: row(:)                     !< numbers of the row
    real(wp) :: changes(size(self%changes, 1))

    changes = row(self%changes(:, self%order))
  end function changes_of

  !> Whether values at the rule's points between outputs are needed.
  pure logical function needs_piece(self)
    class(tracked_quantity_type), intent(in) :: self   !< the quantity

    needs_piece = self%family(0) == 0 .and. self%follows()
  end function needs_piece

  !> Whether the column is followed between outputs.
  pure logical function follows(self)
    class(tracked_quantity_type), intent(in) :: self   !< the quantity

    follows = all(self%take /= [character(len=8) :: 'start', 'end', 'at'])
  end function follows

  !> Take an output into account. The first one is the start.
  pure subroutine take_output(self, row)
    class(tracked_quantity_type), intent(inout) :: self   !< the quantity
    real(wp), intent(in) :: row(:)                        !< numbers of the output, time first

    if (self%seen == 0) call self%sums%begin(row(1), row(self%column))
    if (allocated(self%changes)) then
      if (self%seen == 0) call self%gradient%begin(self%changes_of(row))
      self%gradient%last = self%changes_of(row)
    end if
    self%seen = self%seen + 1
    self%sums%last = row(self%column)
  end subroutine take_output

  !> Begin a piece in which the laws are smooth: at the start, or behind a joint.
  pure subroutine begin_piece(self, row, rate)
    class(tracked_quantity_type), intent(inout) :: self   !< the quantity
    real(wp), intent(in) :: row(:)                        !< numbers at its beginning, time first
    real(wp), allocatable, intent(in) :: rate(:)          !< (P) derivatives of the time of the joint; not allocated at the start

    if (.not. self%follows()) return
    if (.not. self%has_extremes) then
      self%has_extremes = .true.
      call self%sums%begin_extremes(row(1), row(self%column))
      if (allocated(self%changes)) self%gradient%low = self%changes_of(row)
      if (allocated(self%changes)) self%gradient%high = self%gradient%low
    end if
    if (self%is_cut .and. allocated(self%changes) .and. allocated(rate)) &
      call self%gradient%add_jump(self%value_before, row(self%column), rate)
    self%is_cut = .false.
    self%count = 0
    self%done = 0
    if (self%family(0) > 0) call keep_output(self, row, rate)
  end subroutine begin_piece

  !> End an interval between outputs, or end a piece at a joint.
  pure subroutine end_piece(self, rule, piece, jump, row, values, changes)
    class(tracked_quantity_type), intent(inout) :: self   !< the quantity
    type(chebyshev_type), intent(in) :: rule              !< points in an interval
    type(smooth_piece_type), intent(in) :: piece          !< the interval
    integer, intent(in) :: jump                           !< lowest derivative of positions that jumps within it; 3: none
    real(wp), intent(in) :: row(:)                        !< numbers at its end, time first
    real(wp), intent(in) :: values(:)                     !< (rule%n) of its column, those at both ends included, if it needs them
    real(wp), intent(in) :: changes(:, :)                 !< (P,rule%n) its derivatives by parameters, where they are followed

    if (.not. self%follows()) return
    if (is_broken(self, jump) .and. allocated(self%changes)) self%gradient%is_lost = .true.
    if (piece%is_short) then
      if (self%family(0) == 0) call take_short(self, piece, row(1), values([1, rule%n]), changes(:, [1, rule%n]))
      return
    else if (is_broken(self, jump)) then
      call take_chords(self, rule, piece, row, values)
    else if (self%family(0) == 0) then
      call take_values(self, rule, piece, row(1), values, changes)
    else
      if (self%count == most_outputs) call forget_first(self)
      call keep_output(self, row, piece%to_rate)
      ! an interval between others is known best
      if (self%count > 2) call add_intervals(self, rule, self%count - 2)
    end if
    if (.not. allocated(piece%to_rate)) return
    if (self%family(0) > 0 .and. self%count > 1) call add_intervals(self, rule, self%count - 1)
    self%is_cut = .true.
    self%value_before = row(self%column)
  end subroutine end_piece

  !> Whether events within an interval leave no polynomial for the column there. Positions go on through an impact, so that their sums
  !> do, and those of rates are the ways.
  pure logical function is_broken(self, jump)
    type(tracked_quantity_type), intent(in) :: self       !< the quantity
    integer, intent(in) :: jump                           !< lowest derivative of positions that jumps in the interval; 3: none
    logical :: sums

    is_broken = jump <= 2
    if (self%family(0) == 0) return
    sums = any(self%take == [character(len=8) :: 'mean', 'integral'])
    if (self%order == 0) is_broken = is_broken .and. jump == 1 .and. .not. (sums .or. self%take == 'rms')
    if (self%order == 1) is_broken = is_broken .and. .not. sums
  end function is_broken

  !> Take an interval into account over which no polynomial goes. A new one begins at its end.
  pure subroutine take_chords(self, rule, piece, row, values)
    type(tracked_quantity_type), intent(inout) :: self    !< the quantity
    type(chebyshev_type), intent(in) :: rule              !< points in an interval
    type(smooth_piece_type), intent(in) :: piece          !< the interval
    real(wp), intent(in) :: row(:)                        !< numbers at its end, time first
    real(wp), intent(in) :: values(:)                     !< (rule%n) of its column, those at both ends included, if it needs them
    real(wp), allocatable :: no_joint(:)

    if (self%family(0) == 0) then
      call self%sums%add_chords(piece%from + 0.5_wp*(row(1) - piece%from)*(1.0_wp + rule%points), values)
      return
    end if
    if (self%count > 1) call add_intervals(self, rule, self%count - 1)
    call self%sums%add_chords([self%t(self%count), row(1)], [self%y(self%order, self%count), row(self%column)])
    self%count = 0
    self%done = 0
    call keep_output(self, row, no_joint)
  end subroutine take_chords

  !> Keep an output for polynomials.
  pure subroutine keep_output(self, row, rate)
    type(tracked_quantity_type), intent(inout) :: self    !< the quantity
    real(wp), intent(in) :: row(:)                        !< numbers of the output
    real(wp), allocatable, intent(in) :: rate(:)          !< (P) derivatives of the time of its joint, if it is at one
    integer :: order

    self%count = self%count + 1
    self%t(self%count) = row(1)
    self%y(:, self%count) = row(self%family)*self%weights
    self%at_joint(self%count) = allocated(rate)
    if (.not. allocated(self%changes)) return
    if (allocated(rate)) self%rate(:, self%count) = rate
    do order = 0, 2
      self%dy(:, self%count, order) = row(self%changes(:, order))*self%weights(order)
    end do
  end subroutine keep_output

  !> Forget the earliest of the outputs that are kept.
  pure subroutine forget_first(self)
    type(tracked_quantity_type), intent(inout) :: self   !< the quantity
    integer :: i

    do i = 1, self%count - 1
      self%t(i) = self%t(i + 1)
      self%y(:, i) = self%y(:, i + 1)
      self%at_joint(i) = self%at_joint(i + 1)
    end do
    if (allocated(self%changes)) then
      do i = 1, self%count - 1
        self%dy(:, i, :) = self%dy(:, i + 1, :)
        self%rate(:, i) = self%rate(:, i + 1)
      end do
    end if
    self%count = self%count - 1
    self%done = self%done - 1
  end subroutine forget_first

  !> Take the row at the time `at`.
  pure subroutine take_at(self, row)
    class(tracked_quantity_type), intent(inout) :: self   !< the quantity
    real(wp), intent(in) :: row(:)                        !< numbers of the row

    self%value_at = row(self%column)
    if (allocated(self%changes)) self%gradient%at = self%changes_of(row)
  end subroutine take_at

  !> Take the values at the points of an interval into account.
  pure subroutine take_values(self, rule, piece, to, values, changes)
    type(tracked_quantity_type), intent(inout) :: self    !< the quantity
    type(chebyshev_type), intent(in) :: rule              !< points in an interval
    type(smooth_piece_type), intent(in) :: piece          !< the interval
    real(wp), intent(in) :: to                            !< its end [s]
    real(wp), intent(in) :: values(:)                     !< (rule%n) of its column, those at both ends included
    real(wp), intent(in) :: changes(:, :)                 !< (P,rule%n) its derivatives by parameters, where they are followed
    type(quantity_sums_type) :: before

    before = self%sums
    call self%sums%add_piece(rule, piece%from, to, values)
    if (.not. allocated(self%changes)) return
    call self%gradient%add_piece(rule, piece%from, to, values, changes)
    call move_extremes(self, 2.0_wp*(self%joint_before - piece%from)/(to - piece%from) - 1.0_wp)
    if (self%sums%low < before%low) self%gradient%low = between(self%sums%time_low)
    if (self%sums%high > before%high) self%gradient%high = between(self%sums%time_high)

  contains

    !> Let extremes at a joint before short pieces move with its time. Their slope there is that of the polynomial behind these.
    pure subroutine move_extremes(self, x)
      type(tracked_quantity_type), intent(inout) :: self    !< the quantity
      real(wp), intent(in) :: x                             !< place of the joint, -1 at the beginning of the interval
      real(wp) :: slope

      if (.not. any(self%waits)) return
      slope = rule%value_at(2.0_wp/(to - piece%from)*matmul(rule%derivative, values), x)
      if (self%waits(1)) self%gradient%low = self%gradient%low + slope*self%rate_before
      if (self%waits(2)) self%gradient%high = self%gradient%high + slope*self%rate_before
      self%waits = .false.
    end subroutine move_extremes

    !> The derivatives at a time between the outputs, or of the value at a joint.
    pure function between(t)
      real(wp), intent(in) :: t   !< the time [s]
      real(wp) :: between(size(changes, 1)), slopes(rule%n)
      integer :: p

      do p = 1, size(between)
        between(p) = rule%value_at(changes(p, :), 2.0_wp*(t - piece%from)/(to - piece%from) - 1.0_wp)
      end do
      slopes = 2.0_wp/(to - piece%from)*matmul(rule%derivative, values)
      if (allocated(piece%from_rate)) between = between + moved_with(piece%from_rate, slopes(1), t, piece%from, to)
      if (allocated(piece%to_rate)) between = between + moved_with(piece%to_rate, slopes(rule%n), t, to, piece%from)
    end function between
  end subroutine take_values

  !> Take a short interval into account by its ends. An extreme at a joint where it begins moves with the time of the joint as soon as the
  !> slope is known there.
  pure subroutine take_short(self, piece, to, values, changes)
    type(tracked_quantity_type), intent(inout) :: self    !< the quantity
    type(smooth_piece_type), intent(in) :: piece          !< the interval
    real(wp), intent(in) :: to                            !< its end [s]
    real(wp), intent(in) :: values(2)                     !< of its column at both ends
    real(wp), intent(in) :: changes(:, :)                 !< (P,2) its derivatives by parameters, where they are followed
    type(quantity_sums_type) :: before
    real(wp) :: half
    integer :: i

    before = self%sums
    call self%sums%add_chords([piece%from, to], values)
    if (.not. allocated(self%changes)) return
    if (allocated(piece%from_rate)) then
      self%rate_before = piece%from_rate
      self%joint_before = piece%from
    end if
    half = 0.5_wp*(to - piece%from)
    self%gradient%integral = self%gradient%integral + half*(changes(:, 1) + changes(:, 2))
    self%gradient%product = self%gradient%product + half*(values(1)*changes(:, 1) + values(2)*changes(:, 2))
    if (self%sums%low < before%low) then
      i = merge(1, 2, values(1) <= values(2))
      self%gradient%low = changes(:, i)
      self%waits(1) = i == 1 .and. allocated(piece%from_rate)
    end if
    if (self%sums%high > before%high) then
      i = merge(1, 2, values(1) >= values(2))
      self%gradient%high = changes(:, i)
      self%waits(2) = i == 1 .and. allocated(piece%from_rate)
    end if
  end subroutine take_short

  !> Whether an interval matters where the rate of the polynomial through its ends does not keep its sign alone: an extreme of a
  !> position is sought.
  pure logical function counts_turns(self)
    class(tracked_quantity_type), intent(in) :: self   !< the quantity

    counts_turns = self%order == 0 .and. any(self%take == [character(len=8) :: 'min', 'max', 'peak', 'range'])
  end function counts_turns

  !> The outputs that are kept when an interval of a whole motion is taken into account: the first and the last of them.
  pure function outputs_about(interval, n) result(outputs)
    integer, intent(in) :: interval   !< its number, from 1
    integer, intent(in) :: n          !< number of outputs of the motion
    integer :: outputs(2)

    outputs = [max(1, interval - 1), min(n, interval + 2)]
    if (interval == 1) outputs(2) = min(n, most_outputs - 1)
    if (interval == n - 1) outputs(1) = max(1, n - most_outputs + 1)
  end function outputs_about

  !> Begin a whole motion without joints of laws, whose intervals are taken as the procedures above take them.
  pure subroutine begin_motion(self, t, value)
    class(tracked_quantity_type), intent(inout) :: self   !< the quantity, without any outputs, whose derivatives are not followed
    real(wp), intent(in) :: t                             !< its start [s]
    real(wp), intent(in) :: value                         !< of the column there

    call self%sums%begin(t, value)
    self%seen = 1
  end subroutine begin_motion

  !> Take an interval of a whole motion into account.
  pure subroutine take_interval(self, rule, number, t, y)
    class(tracked_quantity_type), intent(inout) :: self   !< the quantity
    type(chebyshev_type), intent(in) :: rule              !< points in an interval
    integer, intent(in) :: number                         !< of the interval among those between these outputs
    real(wp), intent(in) :: t(:)                          !< (outputs about it) their times [s]
    real(wp), intent(in) :: y(0:, :)                      !< (0:2,outputs about it) position, rate and acceleration, each the
                                                          !< derivative of the one before

    self%count = size(t)
    self%t(:self%count) = t
    self%y(:, :self%count) = y
    self%done = number - 1
    call add_intervals(self, rule, number)
  end subroutine take_interval

  !> End with the last output.
  pure subroutine finish(self, rule)
    class(tracked_quantity_type), intent(inout) :: self   !< the quantity
    type(chebyshev_type), intent(in) :: rule              !< points in an interval

    if (self%count > 1) call add_intervals(self, rule, self%count - 1)
  end subroutine finish

  !> Take the next intervals between kept outputs into account.
  pure subroutine add_intervals(self, rule, last)
    type(tracked_quantity_type), intent(inout) :: self    !< the quantity
    type(chebyshev_type), intent(in) :: rule              !< points in an interval
    integer, intent(in) :: last                           !< number of the last one
    type(quantity_sums_type) :: before
    type(hermite_type) :: local, wide
    real(wp), dimension(rule%n) :: values, wider
    integer :: i, j, outputs(2), known

    do j = self%done + 1, last
      outputs = [j, j + 1]
      known = by_positions
      before = self%sums
      values = 0.0_wp
      if (has_extremes_at_ends(self, j)) then
        call self%sums%add_value(self%t(j), self%y(0, j))
        call self%sums%add_value(self%t(j + 1), self%y(0, j + 1))
      else
        associate (a => self%t(j), b => self%t(j + 1))
          call polynomial(self%t(j:j + 1), self%y(:, j:j + 1), local)
          call values_between(local, a, b, rule, self%order, values)
          if (self%count > 2 .and. all(abs(self%t(2:self%count) - self%t(:self%count - 1)) >= least_neighbour*abs(b - a))) then
            call polynomial(self%t(:self%count), self%y(:, :self%count), wide)
            call values_between(wide, a, b, rule, self%order, wider)
            if (maxval(abs(wider - values)) <= smooth_difference*(maxval(values) - minval(values))) then
              values = wider
              outputs = [1, self%count]
            end if
          end if
          known = best_known(rule, self%t(j:j + 1), self%longest, self%order, self%y(:, j), self%y(:, j + 1), values)
          if (known /= by_positions) values = [(value_between(known, self%order, b - a, 0.5_wp*(1.0_wp + rule%points(i)), &
                                                              self%y(:, j), self%y(:, j + 1)), i=1, rule%n)]
          self%longest = max(self%longest, abs(b - a))
          call self%sums%add_piece(rule, a, b, values)
        end associate
      end if
      if (allocated(self%changes)) call add_changes(self, rule, j, outputs, known, before, values)
    end do
    self%done = last
  end subroutine add_intervals

  !> Take the derivatives by parameters in an interval into account, by polynomials through the same outputs as that of the column.
  pure subroutine add_changes(self, rule, j, outputs, known, before, values)
    type(tracked_quantity_type), intent(inout) :: self   !< the quantity
    type(chebyshev_type), intent(in) :: rule             !< points in an interval
    integer, intent(in) :: j                             !< number of the interval
    integer, intent(in) :: outputs(2)                    !< first and last kept output of the polynomial
    integer, intent(in) :: known                         !< from what the column is known between them
    type(quantity_sums_type), intent(in) :: before       !< the sums before this interval
    real(wp), intent(in) :: values(:)                    !< (rule%n) of the column at the points, where integrals are asked for
    type(hermite_type) :: hermite
    real(wp) :: changes(size(self%changes, 1), rule%n)
    logical :: summed
    integer :: i

    summed = any(self%take == [character(len=8) :: 'mean', 'rms', 'integral'])
    if (.not. (summed .or. self%sums%low < before%low .or. self%sums%high > before%high)) return
    associate (a => outputs(1), b => outputs(2), dy => self%dy)
      call build_hermite(self%t(a:b), dy(:, a:b, 0), dy(:, a:b, 1), dy(:, a:b, 2), hermite)
    end associate
    if (summed) then
      call changes_between(hermite, self%t(j), self%t(j + 1), rule, self%order, changes)
      if (known /= by_positions) then
        do i = 1, rule%n
          changes(:, i) = known_between(0.5_wp*(1.0_wp + rule%points(i)))
        end do
      end if
      call self%gradient%add_piece(rule, self%t(j), self%t(j + 1), values, changes)
    end if
    if (self%sums%low < before%low) self%gradient%low = of_extreme(self%sums%time_low)
    if (self%sums%high > before%high) self%gradient%high = of_extreme(self%sums%time_high)

  contains

    !> The derivatives in a part of the interval by rates or by accelerations.
    pure function known_between(x) result(gradient)
      real(wp), intent(in) :: x   !< part of the interval, 0 to 1
      real(wp) :: gradient(size(self%changes, 1))
      integer :: p

      do p = 1, size(gradient)
        gradient(p) = value_between(known, self%order, self%t(j + 1) - self%t(j), x, self%dy(p, j, :), self%dy(p, j + 1, :))
      end do
    end function known_between

    !> The derivatives of an extreme.
    pure function of_extreme(t) result(gradient)
      real(wp), intent(in) :: t   !< its time [s]
      real(wp) :: gradient(size(self%changes, 1)), slopes(2), steps(rule%n)

      call changes_at(hermite, t, self%order, gradient)
      if (known /= by_positions) gradient = known_between((t - self%t(j))/(self%t(j + 1) - self%t(j)))
      if (.not. any(self%at_joint(j:j + 1))) return
      associate (a => self%t(j), b => self%t(j + 1))
        steps = 2.0_wp/(b - a)*matmul(rule%derivative, values)
        slopes = steps([1, rule%n])
        if (self%order < 2) slopes = self%y(self%order + 1, j:j + 1)
        if (self%at_joint(j)) gradient = gradient + moved_with(self%rate(:, j), slopes(1), t, a, b)
        if (self%at_joint(j + 1)) gradient = gradient + moved_with(self%rate(:, j + 1), slopes(2), t, b, a)
      end associate
    end function of_extreme
  end subroutine add_changes

  !> Whether only the ends of an interval count: an extreme of a position is sought, and its rate keeps its sign in between. It
  !> does so where the coefficients in Bernstein's form of the rate of the polynomial of fifth degree have one sign.
  pure logical function has_extremes_at_ends(self, j) result(at_ends)
    type(tracked_quantity_type), intent(in) :: self   !< the quantity
    integer, intent(in) :: j                          !< number of the interval

    at_ends = self%counts_turns()
    if (.not. at_ends) return
    at_ends = rate_keeps_sign(self%t(j + 1) - self%t(j), self%y(:, j), self%y(:, j + 1))
  end function has_extremes_at_ends

  !> Whether the rate of the polynomial of fifth degree through two outputs keeps its sign between them.
  pure logical function rate_keeps_sign(h, a, b) result(keeps)
    real(wp), intent(in) :: h        !< time between the outputs [s]
    real(wp), intent(in) :: a(0:2)   !< position, rate and acceleration at the first
    real(wp), intent(in) :: b(0:2)   !< the same at the second
    real(wp) :: coefficients(5)

    coefficients(1) = a(1)
    coefficients(2) = a(1) + 0.25_wp*h*a(2)
    coefficients(3) = 5.0_wp*(b(0) - a(0))/h - 2.0_wp*(a(1) + b(1)) + 0.25_wp*h*(b(2) - a(2))
    coefficients(4) = b(1) - 0.25_wp*h*b(2)
    coefficients(5) = b(1)
    keeps = all(coefficients > 0.0_wp) .or. all(coefficients < 0.0_wp)
  end function rate_keeps_sign

  !> The number itself, after the last output.
  pure real(wp) function number(self)
    class(tracked_quantity_type), intent(in) :: self   !< the quantity

    number = self%sums%result_of(self%take)
    if (self%take == 'at') number = self%value_at
  end function number

  !> The derivatives of the number by the parameters, after the last output.
  pure subroutine find_gradient(self, gradient)
    class(tracked_quantity_type), intent(in) :: self   !< the quantity, whose derivatives are followed
    real(wp), intent(out) :: gradient(:)               !< (P); NaN where the number has no derivative

    call self%gradient%result_of(self%take, self%sums, gradient)
  end subroutine find_gradient
end module mech9_tracked_quantity
