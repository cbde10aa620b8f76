!> The list of changes of the independent coordinates of a free motion, and of the angles that are integrated.
module mech9_coordinate_changes
  use mech9_number_lists, only: same_numbers
  use mech9_integrated_motion, only: integrated_motion_type
  use mech9_simulation, only: coordinate_change_type
  implicit none
  private
  public :: add_change, same_replaced, same_independent

contains

  !> The coordinates of hinges whose angles are replaced. The angles of joints with several freedoms are the program's own matter.
  function replaced_hinges(motion) result(coordinates)
    type(integrated_motion_type), intent(in) :: motion   !< the motion
    integer, allocatable :: coordinates(:)
    logical, allocatable :: of_hinge(:)
    integer :: i

    coordinates = motion%angles%replaced_coordinates()
    allocate (of_hinge(size(coordinates)))
    do i = 1, size(coordinates)
      of_hinge(i) = motion%system%model%mechanism%structure%joint_of(coordinates(i)) == 0
    end do
    coordinates = pack(coordinates, of_hinge)
  end function replaced_hinges

  !> Whether the angles of the same hinges were replaced at the last change.
  logical function same_replaced(motion, changes)
    type(integrated_motion_type), intent(in) :: motion       !< the motion
    type(coordinate_change_type), intent(in) :: changes(:)   !< the changes so far
    integer, allocatable :: now(:)

    now = replaced_hinges(motion)
    same_replaced = size(now) == 0
    if (size(changes) == 0) return
    same_replaced = same_numbers(now, changes(size(changes))%replaced)
  end function same_replaced

  !> Whether the same coordinates were independent at the last change, or at the start, beside the angles of joints with several freedoms.
  logical function same_independent(motion, changes)
    type(integrated_motion_type), intent(in) :: motion       !< the motion
    type(coordinate_change_type), intent(in) :: changes(:)   !< the changes so far
    logical, dimension(motion%system%plan%n_coordinates) :: before, now
    integer :: k

    before = motion%system%model%problem%partition%independent()
    if (size(changes) > 0) then
      before = .false.
      before(changes(size(changes))%independent) = .true.
    end if
    now = .false.
    now(motion%system%plan%independent) = .true.
    same_independent = .true.
    do k = 1, size(now)
      if (motion%system%model%mechanism%structure%joint_of(k) == 0) &
        same_independent = same_independent .and. (now(k) .eqv. before(k))
    end do
  end function same_independent

  !> Add the present choice of coordinates. By hand: an array constructor of changes would leak (gfortran 12).
  subroutine add_change(motion, changes)
    type(integrated_motion_type), intent(in) :: motion                        !< the motion
    type(coordinate_change_type), allocatable, intent(inout) :: changes(:)    !< gets one more
    type(coordinate_change_type), allocatable :: grown(:)
    integer :: i, n

    n = size(changes)
    allocate (grown(n + 1))
    do i = 1, n
      grown(i)%t = changes(i)%t
      call move_alloc(changes(i)%independent, grown(i)%independent)
      call move_alloc(changes(i)%replaced, grown(i)%replaced)
    end do
    grown(n + 1)%t = motion%t
    grown(n + 1)%independent = motion%system%plan%independent
    grown(n + 1)%replaced = replaced_hinges(motion)
    call move_alloc(grown, changes)
  end subroutine add_change
end module mech9_coordinate_changes
