!> The pieces of the time between two outputs in which all laws are smooth.
!>
!> Laws of drives, loads and motors have joints, at which rates, accelerations and forces may jump. A piece ends a little more than
!> round-off before a joint, and the next one begins as much behind it, so that both have the values of their own side. Joints of
!> several laws that differ by round-off are one joint. Joints are passed in the order of time.
module mech9_smooth_pieces
  use, intrinsic :: ieee_arithmetic, only: ieee_value, ieee_quiet_nan
  use mech9_kinds, only: wp
  use mech9_law, only: law_type, from_inside
  use mech9_load, only: load_type
  use mech9_model, only: model_type
  use mech9_tangent, only: tangent_type, law_tangent_type
  implicit none
  private
  public :: smooth_piece_type, smooth_pieces_type, have_joints

  !> A piece. An end at a joint lies inside.
  type :: smooth_piece_type
    real(wp) :: from = 0.0_wp             !< its beginning [s]
    real(wp) :: to = 0.0_wp               !< its end [s]
    logical :: from_joint = .false.       !< it begins behind a joint
    logical :: to_joint = .false.         !< it ends before a joint
    logical :: is_short = .false.         !< a step of the integration ends it, and it is far shorter than others: nothing inside is known
    real(wp), allocatable :: from_rate(:) !< (P) derivatives of the time of the joint by the parameters; NaN where there is none
    real(wp), allocatable :: to_rate(:)   !< (P) those of the joint at its end
  end type smooth_piece_type

  !> Derivatives of the numbers of a law by the parameters; not allocated where they are not known.
  type :: law_change_type
    real(wp), allocatable :: by(:, :)     !< (numbers,P)
  end type law_change_type

  !> The laws of drives, then those of loads and of motors, with the joints that were passed so far.
  type :: smooth_pieces_type
    integer, private :: n_parameters = 0                         !< P
    real(wp), private :: direction = 1.0_wp                      !< of time
    real(wp), private :: tolerance = 0.0_wp                      !< joints that differ by less are one [s]
    real(wp), allocatable, private :: coming(:)                  !< the joint of each law that comes next [s]
    type(law_change_type), allocatable, private :: changes(:)    !< of each law
  contains
    procedure :: begin
    procedure :: is_at_joint
    procedure :: divide
    procedure, private :: take_joint
    procedure, private :: pass_joint
  end type smooth_pieces_type

  !> Joints that differ by less than this part of the duration of the run are one, and so are an output and a joint.
  real(wp), parameter :: same_time = 1.0e-11_wp
  !> Joints are passed from this part of the duration before the start on.
  real(wp), parameter :: part_before = 1.0e-2_wp
  !> Derivatives of joints that differ by no more than this part are equal.
  real(wp), parameter :: same_rate = 1.0e-9_wp

contains

  !> Whether a law has a joint in the time of the run.
  logical function have_joints(model)
    type(model_type), intent(in) :: model   !< the model with the laws
    type(smooth_pieces_type) :: pieces

    call pieces%begin(model, 0)
    have_joints = any((model%request%time%end - pieces%coming)*pieces%direction >= -pieces%tolerance)
  end function have_joints

  !> Begin at the start of the run.
  subroutine begin(self, model, n_parameters, tangents)
    class(smooth_pieces_type), intent(out) :: self               !< the pieces, none of which was passed
    type(model_type), intent(in) :: model                        !< the model with the laws
    integer, intent(in) :: n_parameters                          !< P
    type(tangent_type), intent(in), optional :: tangents(:)      !< (P) by which the times of joints change; by nothing unless given
    real(wp) :: duration, before
    integer :: l

    associate (time => model%request%time)
      duration = abs(time%end - time%start)
      self%direction = sign(1.0_wp, time%end - time%start)
      self%tolerance = same_time*duration
      before = time%start - self%direction*part_before*duration
      allocate (self%coming(size(model%problem%drives) + size(model%mechanism%loads) + size(model%mechanism%motors)))
      do l = 1, size(self%coming)
        self%coming(l) = joint_after(model, l, before, self%direction)
        do while ((self%coming(l) - time%start)*self%direction < -self%tolerance)
          self%coming(l) = joint_after(model, l, self%coming(l), self%direction)
        end do
      end do
    end associate
    self%n_parameters = n_parameters
    allocate (self%changes(size(self%coming)))
    if (present(tangents)) call find_changes(model, tangents, self%changes)
  end subroutine begin

  !> The derivatives of the numbers of all laws by the parameters.
  subroutine find_changes(model, tangents, changes)
    type(model_type), intent(in) :: model                             !< the model with the laws
    type(tangent_type), intent(in) :: tangents(:)                     !< (P) derivatives by the parameters
    type(law_change_type), intent(inout) :: changes(:)                !< of each law, not known before
    integer :: i, p

    do p = 1, size(tangents)
      do i = 1, size(model%problem%drives)
        if (allocated(tangents(p)%drives(i)%change)) call take(i, tangents(p)%drives(i)%change)
      end do
      do i = 1, size(model%mechanism%loads)
        call take_load(size(model%problem%drives) + i, model%mechanism%loads(i)%load, tangents(p)%loads(i))
      end do
      do i = 1, size(model%mechanism%motors)
        call take_load(size(model%problem%drives) + size(model%mechanism%loads) + i, model%mechanism%motors(i)%motor, &
                       tangents(p)%motors(i))
      end do
    end do
  contains
    !> Take the derivatives of the law of one load by parameter p, if it has a law.
    subroutine take_load(law, load, part)
      integer, intent(in) :: law                   !< number of the law
      class(load_type), intent(in) :: load         !< the load
      type(law_tangent_type), intent(in) :: part   !< of its numbers, then of those of its law
      real(wp), allocatable :: own(:)

      if (.not. (allocated(load%law) .and. allocated(part%change))) return
      call load%numbers(own)
      call take(law, part%change(size(own) + 1:))
    end subroutine take_load

    !> Take the derivatives of one law by parameter p.
    subroutine take(law, change)
      integer, intent(in) :: law           !< number of the law
      real(wp), intent(in) :: change(:)    !< of its numbers

      if (.not. allocated(changes(law)%by)) allocate (changes(law)%by(size(change), size(tangents)), source=0.0_wp)
      changes(law)%by(:, p) = change
    end subroutine take
  end subroutine find_changes

  !> The next joint of a law behind a time; beyond all times where there is none.
  pure real(wp) function joint_after(model, l, t, direction) result(joint)
    type(model_type), intent(in) :: model    !< the model with the laws
    integer, intent(in) :: l                 !< number of the law
    real(wp), intent(in) :: t                !< time; a joint there does not count [s]
    real(wp), intent(in) :: direction        !< of time
    integer :: i, n

    i = l - size(model%problem%drives)
    n = size(model%mechanism%loads)
    if (i <= 0) then
      joint = model%problem%drives(l)%drive%next_joint(t, direction)
    else if (i <= n) then
      joint = joint_of_load(model%mechanism%loads(i)%load, t, direction)
    else
      joint = joint_of_load(model%mechanism%motors(i - n)%motor, t, direction)
    end if
  end function joint_after

  !> The next joint of a load's law behind a time; beyond all times where there is none.
  pure real(wp) function joint_of_load(load, t, direction) result(joint)
    class(load_type), intent(in) :: load     !< the load
    real(wp), intent(in) :: t                !< time; a joint there does not count [s]
    real(wp), intent(in) :: direction        !< of time

    joint = sign(huge(t), direction)
    if (allocated(load%law)) joint = load%law%next_joint(t, direction)
  end function joint_of_load

  !> Whether the joint that comes next is at a time.
  pure logical function is_at_joint(self, t)
    class(smooth_pieces_type), intent(in) :: self   !< the pieces, with what was passed so far
    real(wp), intent(in) :: t                       !< the time [s]

    is_at_joint = any(abs(self%coming - t) <= self%tolerance)
  end function is_at_joint

  !> Divide the time between two outputs. To be called for all outputs in their order.
  subroutine divide(self, model, previous, t, pieces)
    class(smooth_pieces_type), intent(inout) :: self                    !< the pieces, with what was passed so far
    type(model_type), intent(in) :: model                               !< the model with the laws
    real(wp), intent(in) :: previous                                    !< time of the first output [s]
    real(wp), intent(in) :: t                                           !< time of the second one [s]
    type(smooth_piece_type), allocatable, intent(out) :: pieces(:)      !< in the order of time
    type(smooth_piece_type) :: piece
    real(wp) :: first, last, rate(self%n_parameters)

    allocate (pieces(0))
    piece%from = previous
    do
      call self%take_joint(model, first, last, rate)
      if ((first - t)*self%direction > self%tolerance) exit
      if ((first - previous)*self%direction > self%tolerance) then
        piece%to = from_inside(first, -self%direction)
        piece%to_joint = .true.
        piece%to_rate = rate
        call append(piece)
        ! the next piece begins behind the second output
        if ((t - last)*self%direction <= self%tolerance) return
      end if
      piece%from = from_inside(last, self%direction)
      piece%from_joint = .true.
      piece%from_rate = rate
      call self%pass_joint(model, first)
    end do
    piece%to = t
    piece%to_joint = .false.
    if (allocated(piece%to_rate)) deallocate (piece%to_rate)
    call append(piece)
  contains
    !> Append a piece, unless it is empty.
    subroutine append(piece)
      type(smooth_piece_type), intent(in) :: piece   !< the piece

      if ((piece%to - piece%from)*self%direction > 0.0_wp) pieces = [pieces, piece]
    end subroutine append
  end subroutine divide

  !> The joint that comes next, and the derivatives of its time. Where it is at the start or end of the run, which are held, these
  !> are zero; where the joints of several laws move apart, there are none.
  subroutine take_joint(self, model, first, last, rate)
    class(smooth_pieces_type), intent(in) :: self   !< the pieces, with what was passed so far
    type(model_type), intent(in) :: model           !< the model with the laws
    real(wp), intent(out) :: first                  !< time of the joint, of that law that comes first [s]
    real(wp), intent(out) :: last                   !< and of that which comes last [s]
    real(wp), intent(out) :: rate(:)                !< (P) derivatives of this time by the parameters
    real(wp) :: other(size(rate))
    logical :: taken
    integer :: l

    first = sign(huge(first), self%direction)
    if (size(self%coming) > 0) first = self%coming(minloc(self%coming*self%direction, dim=1))
    last = first
    rate = 0.0_wp
    taken = .false.
    do l = 1, size(self%coming)
      if ((self%coming(l) - first)*self%direction > self%tolerance) cycle
      if ((self%coming(l) - last)*self%direction > 0.0_wp) last = self%coming(l)
      call find_rate(model, l, self%changes(l), self%coming(l), other)
      if (taken) where (abs(rate - other) > same_rate*max(abs(rate), abs(other))) other = ieee_value(0.0_wp, ieee_quiet_nan)
      taken = .true.
      rate = other
    end do
    associate (time => model%request%time)
      if (abs(first - time%start) <= self%tolerance .or. abs(last - time%end) <= self%tolerance) rate = 0.0_wp
    end associate
  end subroutine take_joint

  !> Pass the joint that comes next.
  subroutine pass_joint(self, model, first)
    class(smooth_pieces_type), intent(inout) :: self   !< the pieces, with what was passed so far
    type(model_type), intent(in) :: model              !< the model with the laws
    real(wp), intent(in) :: first                      !< time of the joint, of that law that comes first [s]
    integer :: l

    do l = 1, size(self%coming)
      if ((self%coming(l) - first)*self%direction <= self%tolerance) &
        self%coming(l) = joint_after(model, l, self%coming(l), self%direction)
    end do
  end subroutine pass_joint

  !> Derivatives of the time of a joint of one law.
  pure subroutine find_rate(model, l, change, joint, rate)
    type(model_type), intent(in) :: model           !< the model with the laws
    integer, intent(in) :: l                        !< number of the law
    type(law_change_type), intent(in) :: change     !< of its numbers
    real(wp), intent(in) :: joint                   !< time of the joint [s]
    real(wp), intent(out) :: rate(:)                !< (P) derivatives by the parameters
    integer :: i, n

    rate = 0.0_wp
    if (.not. allocated(change%by)) return
    i = l - size(model%problem%drives)
    n = size(model%mechanism%loads)
    if (i <= 0) then
      call find_law_rate(model%problem%drives(l)%drive, change, joint, rate)
    else if (i <= n) then
      call find_law_rate(model%mechanism%loads(i)%load%law, change, joint, rate)
    else
      call find_law_rate(model%mechanism%motors(i - n)%motor%law, change, joint, rate)
    end if
  end subroutine find_rate

  !> Derivatives of the time of a joint of a law.
  pure subroutine find_law_rate(law, change, joint, rate)
    class(law_type), intent(in) :: law              !< the law
    type(law_change_type), intent(in) :: change     !< of its numbers
    real(wp), intent(in) :: joint                   !< time of the joint [s]
    real(wp), intent(out) :: rate(:)                !< (P) derivatives by the parameters
    integer :: p

    do p = 1, size(rate)
      rate(p) = law%joint_rate(change%by(:, p), joint)
    end do
  end subroutine find_law_rate
end module mech9_smooth_pieces
