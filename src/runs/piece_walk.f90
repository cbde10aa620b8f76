!> The way of a motion with events through the times before an output at which quantities need rows.
!>
!> The time of an event is not known before. So a motion goes on by strides, over each of which it is known, and the pieces in which the
!> laws are smooth are divided where strides end at an event. Rows are taken on both sides of it. Where values between outputs are needed,
!> pieces end with every stride, since the motion cannot go back behind it.
module mech9_piece_walk
  use mech9_kinds, only: wp
  use mech9_model, only: model_type
  use mech9_smooth_pieces, only: smooth_piece_type
  use mech9_quantity_pieces, only: points_between
  use mech9_quantity_record, only: quantity_record_type
  use mech9_motion_event, only: motion_events_type
  implicit none
  private
  public :: piece_walk_type, walk_done, walk_look, walk_stride, walk_leave, walk_pass

  !> A part that ends with a stride is short below this part of the longest: chords are exact to its third power there. Behind an event,
  !> strides begin as short as that and grow.
  real(wp), parameter :: short_part = 1.0e-4_wp
  !> Actions that come next: nothing before the output, a row at a time, a stride, leaving what ended the last one without rows, or with them.
  integer, parameter :: walk_done = 0, walk_look = 1, walk_stride = 2, walk_leave = 3, walk_pass = 4

  type :: piece_walk_type
    logical :: is_needed = .false.                             !< the motion may have events, and quantities follow columns
    real(wp) :: time = 0.0_wp                                  !< of the next row [s]
    integer :: place = 0                                       !< number of its point in the part of a piece; 0: of none
    type(smooth_piece_type), allocatable, private :: list(:)   !< pieces up to the next output; not allocated before their interval
    integer, private :: current = 1                            !< number of the piece
    logical, private :: has_begun = .false.                    !< the row at the beginning of its present part is taken
    logical, private :: is_chosen = .false.                    !< the end of the present part is known
    logical, private :: is_open = .false.                      !< the part ends with the output
    type(smooth_piece_type), private :: part                   !< the present part
    integer, private :: next_place = 0                         !< number of its point that comes next
    real(wp), private :: longest = 0.0_wp                      !< longest part so far [s]
    real(wp), private :: end = 0.0_wp                          !< of the last stride [s]
    logical, private :: at_joint = .false.                     !< it ended where rates may jump
    integer, private :: events = 0                             !< how many there were when it began
    real(wp), private :: asked = 0.0_wp                        !< time up to which values at given times are taken [s]
    real(wp), allocatable, private :: rate(:)                  !< (P) derivatives of the time of an event at the output before by the
                                                               !< parameters; not allocated: there was none
  contains
    procedure :: choose
    procedure :: take
    procedure :: note_stride
    procedure :: note_leaving
    procedure :: note_passing
    procedure :: part_before
    procedure :: part_behind
    procedure :: open_part
    procedure :: reach_output
  end type piece_walk_type

contains

  !> Choose what comes next on the way to an output.
  subroutine choose(self, model, quantities, outputs, end, events, action)
    class(piece_walk_type), intent(inout) :: self               !< the way
    type(model_type), intent(in) :: model                       !< the model
    type(quantity_record_type), intent(inout) :: quantities     !< the quantities
    real(wp), intent(in) :: outputs(2)                          !< times of the output before and of this one [s]
    real(wp), intent(in) :: end                                 !< of the last stride, as it is now [s]
    integer, intent(in) :: events                               !< how many there were so far
    integer, intent(out) :: action                              !< one of the constants above
    real(wp) :: direction, t

    t = outputs(2)
    direction = sign(1.0_wp, t - outputs(1))
    if (.not. allocated(self%list)) call begin_interval(self, model, quantities, outputs(1), t, events)
    if (abs(end - self%end) > 0.0_wp) then
      ! the stride was made anew, up to a time within it
      self%end = end
      self%at_joint = .false.
    end if
    self%place = 0
    self%time = quantities%next_asked(self%asked, merge(self%end, t, (t - self%end)*direction > 0.0_wp))
    if (abs(self%time - self%asked) > 0.0_wp .and. abs(t - self%time) > 0.0_wp .and. &
        .not. (self%at_joint .and. .not. abs(self%time - self%end) > 0.0_wp)) then
      action = walk_look
      return
    end if
    action = walk_done
    if (self%current > size(self%list)) return
    associate (piece => self%list(self%current), part => self%part)
      if (.not. self%has_begun) then
        self%place = 1
        self%time = part%from
        call look_or_go(self, direction, action)
        return
      end if
      if (.not. self%is_chosen) then
        action = go_on(self)
        if ((self%end - part%from)*direction <= 0.0_wp) return
        part%to = piece%to
        if ((piece%to - self%end)*direction > 0.0_wp) part%to = self%end
        ! nothing is looked at between outputs but events
        if (abs(piece%to - part%to) > 0.0_wp .and. .not. (self%at_joint .or. quantities%needs_strides(events))) return
        self%is_chosen = .true.
        part%is_short = abs(piece%to - part%to) > 0.0_wp .and. .not. self%at_joint .and. &
                        abs(part%to - part%from) <= short_part*self%longest
        self%longest = max(self%longest, abs(part%to - part%from))
        self%next_place = merge(2, points_between, quantities%needs_inside() .and. .not. part%is_short)
      end if
      if (self%next_place < points_between) then
        self%place = self%next_place
        self%time = quantities%point_in(part, self%place)
        call look_or_go(self, direction, action)
      else if (self%at_joint .and. .not. abs(self%end - part%to) > 0.0_wp) then
        self%time = part%to
        action = walk_pass
      else if (abs(piece%to - part%to) > 0.0_wp .or. piece%to_joint) then
        self%place = self%next_place
        self%time = part%to
        call look_or_go(self, direction, action)
      else
        self%current = self%current + 1
        self%is_open = .true.
        action = walk_done
      end if
    end associate
  end subroutine choose

  !> Begin with the interval between two outputs.
  subroutine begin_interval(self, model, quantities, previous, t, events)
    type(piece_walk_type), intent(inout) :: self                !< the way
    type(model_type), intent(in) :: model                       !< the model
    type(quantity_record_type), intent(inout) :: quantities     !< the quantities
    real(wp), intent(in) :: previous                            !< time of the output before [s]
    real(wp), intent(in) :: t                                   !< time of the output [s]
    integer, intent(in) :: events                               !< how many there were so far

    call quantities%divide(model, previous, t, self%list)
    self%current = 1
    self%is_open = .false.
    self%asked = previous
    self%events = events
    if (size(self%list) > 0) call begin_piece(self)
    if (self%has_begun .and. allocated(self%rate)) self%part%from_rate = self%rate
    if (allocated(self%rate)) deallocate (self%rate)
  end subroutine begin_interval

  !> Begin with the next piece.
  pure subroutine begin_piece(self)
    type(piece_walk_type), intent(inout) :: self   !< the way

    self%is_chosen = .false.
    if (self%current > size(self%list)) return
    self%part = self%list(self%current)
    self%part%to_joint = .false.
    if (allocated(self%part%to_rate)) deallocate (self%part%to_rate)
    self%has_begun = .not. self%part%from_joint
  end subroutine begin_piece

  !> Look at the time that comes next if the motion is known there, or go on.
  pure subroutine look_or_go(self, direction, action)
    type(piece_walk_type), intent(in) :: self   !< the way
    real(wp), intent(in) :: direction           !< of time
    integer, intent(out) :: action              !< one of the constants above

    action = walk_look
    if ((self%time - self%end)*direction > 0.0_wp) action = go_on(self)
  end subroutine look_or_go

  !> How the motion goes on: behind what ended the last stride, or by another one.
  pure integer function go_on(self) result(action)
    type(piece_walk_type), intent(in) :: self   !< the way

    action = merge(walk_leave, walk_stride, self%at_joint)
  end function go_on

  !> Give quantities the row at the time that was chosen.
  subroutine take(self, quantities, row, events)
    class(piece_walk_type), intent(inout) :: self               !< the way
    type(quantity_record_type), intent(inout) :: quantities     !< the quantities
    real(wp), intent(in) :: row(:)                              !< numbers of the row, time first
    type(motion_events_type), intent(in) :: events              !< of the motion so far
    type(smooth_piece_type) :: part

    if (self%place == 0) then
      call quantities%take_row(0, row)
      self%asked = self%time
    else if (self%place == 1) then
      call quantities%begin_part(row, self%part%from_rate, events)
      self%has_begun = .true.
    else if (self%place < points_between) then
      call quantities%take_row(self%place, row)
      self%next_place = self%place + 1
    else
      part = self%part
      associate (piece => self%list(self%current))
        if (piece%to_joint .and. .not. abs(piece%to - part%to) > 0.0_wp) part = with_end_of(part, piece)
      end associate
      call quantities%close_part(row, part, quantities%first_jump(part, events), events)
      call go_behind(self)
    end if
  end subroutine take

  !> A part of a piece that ends with the piece.
  pure type(smooth_piece_type) function with_end_of(part, piece) result(last)
    type(smooth_piece_type), intent(in) :: part    !< the part
    type(smooth_piece_type), intent(in) :: piece   !< the piece, which ends at a joint

    last = part
    last%to_joint = .true.
    last%to_rate = piece%to_rate
  end function with_end_of

  !> Begin with the next part of a piece where the present one ends, or with the next piece.
  pure subroutine go_behind(self)
    type(piece_walk_type), intent(inout) :: self   !< the way

    if (.not. abs(self%list(self%current)%to - self%part%to) > 0.0_wp) then
      self%current = self%current + 1
      call begin_piece(self)
      return
    end if
    self%part%from = self%part%to
    self%part%from_joint = .false.
    if (allocated(self%part%from_rate)) deallocate (self%part%from_rate)
    self%is_chosen = .false.
    self%has_begun = .true.
  end subroutine go_behind

  !> Note a stride. Events before it, at the time where it begins, let the present part begin anew.
  pure subroutine note_stride(self, end, at_joint, events)
    class(piece_walk_type), intent(inout) :: self   !< the way
    real(wp), intent(in) :: end                     !< of the stride [s]
    logical, intent(in) :: at_joint                 !< it ended where rates may jump
    integer, intent(in) :: events                   !< how many there were so far

    self%end = end
    self%at_joint = at_joint
    if (events /= self%events .and. .not. self%is_chosen) self%has_begun = .false.
    self%events = events
  end subroutine note_stride

  !> Note that the motion stands behind what ended the last stride.
  pure subroutine note_leaving(self, events)
    class(piece_walk_type), intent(inout) :: self   !< the way
    integer, intent(in) :: events                   !< how many there were so far

    self%at_joint = .false.
    self%events = events
  end subroutine note_leaving

  !> Note that rows on both sides of an event were taken.
  pure subroutine note_passing(self, events)
    class(piece_walk_type), intent(inout) :: self   !< the way
    integer, intent(in) :: events                   !< how many there were so far

    call self%note_leaving(events)
    call go_behind(self)
  end subroutine note_passing

  !> The present part, before an event that ends it.
  pure subroutine part_before(self, rate, part)
    class(piece_walk_type), intent(in) :: self          !< the way
    real(wp), intent(in) :: rate(:)                     !< (P) derivatives of the time of the event by the parameters
    type(smooth_piece_type), intent(out) :: part        !< ends at the event

    part = self%part
    part%to_joint = .true.
    part%to_rate = rate
  end subroutine part_before

  !> Let the part that comes next begin behind an event.
  pure subroutine part_behind(self, rate)
    class(piece_walk_type), intent(inout) :: self       !< the way, after note_passing
    real(wp), intent(in) :: rate(:)                     !< (P) derivatives of the time of the event by the parameters

    if (self%current > size(self%list)) then
      self%rate = rate
    else
      self%part%from_rate = rate
    end if
  end subroutine part_behind

  !> The part that ends with the row that comes next, which may be the output; none where rows on both sides of a joint took its place.
  pure subroutine open_part(self, parts)
    class(piece_walk_type), intent(in) :: self                         !< the way
    type(smooth_piece_type), allocatable, intent(out) :: parts(:)      !< one, or none

    allocate (parts(merge(1, 0, self%is_open)), source=self%part)
  end subroutine open_part

  !> Note that the output was reached.
  pure subroutine reach_output(self)
    class(piece_walk_type), intent(inout) :: self   !< the way

    if (allocated(self%list)) deallocate (self%list)
  end subroutine reach_output
end module mech9_piece_walk
