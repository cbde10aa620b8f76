!> The quantities of a run between its outputs: the rows that they need, and the pieces of time to which these rows belong.
module mech9_quantity_pieces
  use mech9_kinds, only: wp
  use mech9_chebyshev, only: chebyshev_type, new_chebyshev
  use mech9_model, only: model_type
  use mech9_tangent, only: tangent_type
  use mech9_smooth_pieces, only: smooth_piece_type, smooth_pieces_type
  use mech9_motion_event, only: motion_events_type
  use mech9_tracked_quantity, only: tracked_quantity_type
  implicit none
  private
  public :: quantity_pieces_type, points_between

  !> Points of the polynomial that follows a column in a piece, its ends included.
  integer, parameter :: points_between = 10

  type :: quantity_pieces_type
    type(chebyshev_type) :: rule                             !< points in a piece
    logical, private :: follows = .false.                    !< a quantity is followed between outputs
    logical, private :: inside = .false.                     !< values between outputs are needed
    integer, private :: events = 0                           !< how many there were where the present piece begins
    logical, private :: is_started = .false.                 !< an output was taken
    real(wp), private :: previous = 0.0_wp                   !< time of the output that was taken last [s]
    type(smooth_pieces_type), private :: visited             !< up to the output to which the motion goes
    type(smooth_pieces_type), private :: taken               !< up to the output whose rows are taken
    type(smooth_piece_type), allocatable, private :: list(:) !< of the interval whose rows are taken; not allocated before it
    integer, private :: current = 1                          !< number of the piece in which rows are taken
    real(wp), allocatable, private :: values(:, :)           !< (points_between,quantities) in this piece
    real(wp), allocatable, private :: changes(:, :, :)       !< (P,points_between,quantities) derivatives of these values
  contains
    procedure :: begin
    procedure :: times_before
    procedure :: take_between
    procedure :: take_output
    procedure :: is_followed
    procedure :: needs_inside
    procedure :: divide
    procedure :: point_in
    procedure :: first_jump
    procedure :: begin_part
    procedure :: take_point
    procedure :: close_part
    procedure :: leave_open
  end type quantity_pieces_type

contains

  !> Begin at the start of the run.
  subroutine begin(self, model, tracked, n_parameters, tangents)
    class(quantity_pieces_type), intent(inout) :: self           !< the pieces
    type(model_type), intent(in) :: model                        !< the model
    type(tracked_quantity_type), intent(in) :: tracked(:)        !< the quantities
    integer, intent(in) :: n_parameters                          !< number of parameters whose derivatives are followed
    type(tangent_type), allocatable, intent(in) :: tangents(:)   !< (P) of its constants, where the times of joints depend on them
    integer :: i

    call new_chebyshev(points_between, self%rule)
    allocate (self%values(points_between, size(tracked)), self%changes(n_parameters, points_between, size(tracked)), source=0.0_wp)
    self%follows = any([(tracked(i)%follows(), i=1, size(tracked))])
    self%inside = any([(tracked(i)%needs_piece(), i=1, size(tracked))])
    if (allocated(tangents)) then
      call self%taken%begin(model, n_parameters, tangents)
    else
      call self%taken%begin(model, n_parameters)
    end if
    self%visited = self%taken
  end subroutine begin

  !> The times between the output before and the next one at which rows are needed, in their order. To be called for all outputs
  !> behind the start.
  subroutine times_before(self, model, previous, t, times)
    class(quantity_pieces_type), intent(inout) :: self           !< the pieces
    type(model_type), intent(in) :: model                        !< the model
    real(wp), intent(in) :: previous                             !< time of the output before [s]
    real(wp), intent(in) :: t                                    !< time of the next output [s]
    real(wp), allocatable, intent(out) :: times(:)               !< between the two outputs [s]
    type(smooth_piece_type), allocatable :: list(:)
    real(wp) :: points(points_between)
    integer :: i, last

    allocate (times(0))
    if (.not. self%follows) return
    call self%visited%divide(model, previous, t, list)
    last = points_between
    do i = 1, size(list)
      points = points_in(self, list(i))
      if (list(i)%from_joint) times = [times, points(1)]
      if (self%inside) times = [times, points(2:last - 1)]
      if (list(i)%to_joint) times = [times, points(last)]
    end do
  end subroutine times_before

  !> Whether a quantity is followed between outputs.
  pure logical function is_followed(self)
    class(quantity_pieces_type), intent(in) :: self   !< the pieces

    is_followed = self%follows
  end function is_followed

  !> Whether values between outputs are needed.
  pure logical function needs_inside(self)
    class(quantity_pieces_type), intent(in) :: self   !< the pieces

    needs_inside = self%inside
  end function needs_inside

  !> The pieces between two outputs. To be called for all outputs behind the start, where the times before these are not asked for.
  subroutine divide(self, model, previous, t, list)
    class(quantity_pieces_type), intent(inout) :: self                !< the pieces
    type(model_type), intent(in) :: model                             !< the model
    real(wp), intent(in) :: previous                                  !< time of the output before [s]
    real(wp), intent(in) :: t                                         !< time of the output [s]
    type(smooth_piece_type), allocatable, intent(out) :: list(:)      !< in the order of time

    call self%visited%divide(model, previous, t, list)
  end subroutine divide

  !> The time of a point in a piece.
  pure real(wp) function point_in(self, piece, k) result(time)
    class(quantity_pieces_type), intent(in) :: self     !< the pieces
    type(smooth_piece_type), intent(in) :: piece        !< one of them
    integer, intent(in) :: k                            !< number of the point
    real(wp) :: times(points_between)

    times = points_in(self, piece)
    time = times(k)
  end function point_in

  !> The times of the points in a piece, its ends included.
  pure function points_in(self, piece) result(times)
    type(quantity_pieces_type), intent(in) :: self      !< the pieces
    type(smooth_piece_type), intent(in) :: piece        !< one of them
    real(wp) :: times(points_between)

    times = piece%from + 0.5_wp*(piece%to - piece%from)*(1.0_wp + self%rule%points)
    times(1) = piece%from
    times(points_between) = piece%to
  end function points_in

  !> Find the pieces up to the next output, unless they are known already.
  subroutine find_pieces(self, model, next)
    type(quantity_pieces_type), intent(inout) :: self   !< the pieces
    type(model_type), intent(in) :: model               !< the model
    real(wp), intent(in) :: next                        !< time of the next output [s]

    if (allocated(self%list)) return
    call self%taken%divide(model, self%previous, next, self%list)
    self%current = 1
  end subroutine find_pieces

  !> Take a row between the output before and the next one.
  subroutine take_between(self, model, tracked, row, next, events)
    class(quantity_pieces_type), intent(inout) :: self        !< the pieces, which have taken all rows before this one
    type(model_type), intent(in) :: model                     !< the model
    type(tracked_quantity_type), intent(inout) :: tracked(:)  !< the quantities
    real(wp), intent(in) :: row(:)                            !< numbers of the row, time first
    real(wp), intent(in) :: next                              !< time of the next output [s]
    type(motion_events_type), intent(in) :: events            !< of the motion so far
    integer :: k

    if (.not. self%follows) return
    call find_pieces(self, model, next)
    if (self%current > size(self%list)) return
    k = findloc(.not. abs(points_in(self, self%list(self%current)) - row(1)) > 0.0_wp, .true., dim=1)
    if (k == 1) then
      call self%begin_part(tracked, row, self%list(self%current)%from_rate, events)
    else if (k == points_between) then
      call end_piece(self, tracked, row, events)
      self%current = self%current + 1
    else if (k > 0) then
      call keep_values(self, tracked, k, row)
    end if
  end subroutine take_between

  !> Take the row of an output. One at a joint is no end of a piece: rows on both sides of the joint are.
  subroutine take_output(self, model, tracked, row, events)
    class(quantity_pieces_type), intent(inout) :: self        !< the pieces
    type(model_type), intent(in) :: model                     !< the model
    type(tracked_quantity_type), intent(inout) :: tracked(:)  !< the quantities
    real(wp), intent(in) :: row(:)                            !< numbers of the output, time first
    type(motion_events_type), intent(in) :: events            !< of the motion so far
    real(wp), allocatable :: no_joint(:)

    if (.not. self%follows) return
    if (self%is_started) then
      call find_pieces(self, model, row(1))
      if (self%current <= size(self%list)) then
        call end_piece(self, tracked, row, events)
      end if
      deallocate (self%list)
    else if (.not. self%taken%is_at_joint(row(1))) then
      call self%begin_part(tracked, row, no_joint, events)
    end if
    self%is_started = .true.
    self%previous = row(1)
  end subroutine take_output

  !> Keep the values of a row as those of a point of the piece.
  pure subroutine keep_values(self, tracked, k, row)
    type(quantity_pieces_type), intent(inout) :: self       !< the pieces
    type(tracked_quantity_type), intent(in) :: tracked(:)   !< the quantities
    integer, intent(in) :: k                                !< number of the point
    real(wp), intent(in) :: row(:)                          !< numbers of the row
    integer :: i

    do i = 1, size(tracked)
      self%values(k, i) = row(tracked(i)%column)
      if (allocated(tracked(i)%changes)) self%changes(:, k, i) = tracked(i)%changes_of(row)
    end do
  end subroutine keep_values

  !> Begin a piece of each quantity.
  pure subroutine begin_piece(self, tracked, row, rate)
    type(quantity_pieces_type), intent(inout) :: self         !< the pieces
    type(tracked_quantity_type), intent(inout) :: tracked(:)  !< the quantities
    real(wp), intent(in) :: row(:)                            !< numbers at its beginning
    real(wp), allocatable, intent(in) :: rate(:)              !< (P) derivatives of the time of its joint; not allocated at the start
    integer :: i

    do i = 1, size(tracked)
      call tracked(i)%begin_piece(row, rate)
    end do
    call keep_values(self, tracked, 1, row)
  end subroutine begin_piece

  !> End the present piece of each quantity.
  pure subroutine end_piece(self, tracked, row, events)
    type(quantity_pieces_type), intent(inout) :: self         !< the pieces
    type(tracked_quantity_type), intent(inout) :: tracked(:)  !< the quantities
    real(wp), intent(in) :: row(:)                            !< numbers at its end
    type(motion_events_type), intent(in) :: events            !< of the motion so far

    call self%close_part(tracked, row, self%list(self%current), self%first_jump(self%list(self%current), events), events)
  end subroutine end_piece

  !> The lowest derivative of positions that jumps within a piece, up to the present time: 1 rates, 2 accelerations, 3 none.
  pure integer function first_jump(self, piece, events) result(jump)
    class(quantity_pieces_type), intent(in) :: self           !< the pieces
    type(smooth_piece_type), intent(in) :: piece              !< the present one
    type(motion_events_type), intent(in) :: events            !< of the motion so far

    jump = 3
    if (events%count > self%events) jump = events%first_jump(piece%from, piece%to)
  end function first_jump

  !> Begin a part of a piece: at a joint of laws, or behind an event.
  pure subroutine begin_part(self, tracked, row, rate, events)
    class(quantity_pieces_type), intent(inout) :: self        !< the pieces
    type(tracked_quantity_type), intent(inout) :: tracked(:)  !< the quantities
    real(wp), intent(in) :: row(:)                            !< numbers at its beginning
    real(wp), allocatable, intent(in) :: rate(:)              !< (P) derivatives of the time of the joint by the parameters
    type(motion_events_type), intent(in) :: events            !< of the motion so far

    self%events = events%count
    call begin_piece(self, tracked, row, rate)
  end subroutine begin_part

  !> Take a point of a part.
  pure subroutine take_point(self, tracked, k, row)
    class(quantity_pieces_type), intent(inout) :: self      !< the pieces
    type(tracked_quantity_type), intent(in) :: tracked(:)   !< the quantities
    integer, intent(in) :: k                                !< number of the point
    real(wp), intent(in) :: row(:)                          !< numbers of the row

    call keep_values(self, tracked, k, row)
  end subroutine take_point

  !> End a part, and begin the next one with its last row.
  pure subroutine close_part(self, tracked, row, part, jump, events)
    class(quantity_pieces_type), intent(inout) :: self        !< the pieces
    type(tracked_quantity_type), intent(inout) :: tracked(:)  !< the quantities
    real(wp), intent(in) :: row(:)                            !< numbers at its end
    type(smooth_piece_type), intent(in) :: part               !< the part
    integer, intent(in) :: jump                               !< lowest derivative of positions that jumps within it; 3: none
    type(motion_events_type), intent(in) :: events            !< of the motion so far
    integer :: i

    call keep_values(self, tracked, points_between, row)
    do i = 1, size(tracked)
      call tracked(i)%end_piece(self%rule, part, jump, row, self%values(:, i), self%changes(:, :, i))
    end do
    call keep_values(self, tracked, 1, row)
    self%events = events%count
  end subroutine close_part

  !> Let the output that comes next end a part, or none.
  pure subroutine leave_open(self, parts)
    class(quantity_pieces_type), intent(inout) :: self                    !< the pieces
    type(smooth_piece_type), allocatable, intent(inout) :: parts(:)       !< one, or none

    self%current = 1
    call move_alloc(parts, self%list)
  end subroutine leave_open
end module mech9_quantity_pieces
