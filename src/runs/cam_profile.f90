!> The profile of a cam: its contacts with the follower at the outputs of a driven motion, and its extreme values.
module mech9_cam_profile
  use mech9_kinds, only: wp
  use mech9_error, only: error_type
  use mech9_pair_axes, only: pair_axes_type, pair_axes
  use mech9_request, only: cam_request_type
  use mech9_model, only: model_type
  use mech9_plan, only: plan_type
  use mech9_state, only: state_type
  use mech9_driven_simulation, only: driven_simulation_type, new_driven_simulation
  use mech9_cam_contact, only: cam_contact_type, find_contact
  implicit none
  private
  public :: cam_profile_type, find_profile

  !> The profile. Extreme values and ends of undercut ranges lie between outputs, too; they are numbers of `contacts`, 0 for none.
  type :: cam_profile_type
    type(cam_contact_type), allocatable :: contacts(:)   !< at the outputs and where extreme values lie between them, in order
    logical, allocatable :: at_output(:)                 !< whether each contact is one of an output
    logical :: has_pressure = .false.                    !< the pressure angles are known
    logical :: closed = .false.                          !< the last point of the profile is the first one
    integer :: pressure = 0                              !< contact with the greatest pressure angle
    integer :: convex = 0                                !< contact with the least radius where the cam is convex
    integer :: concave = 0                               !< contact with the least radius where the cam is concave
    integer, allocatable :: undercut(:, :)               !< (2,n) first and last contact of each range that is undercut
    integer :: resting = 0                               !< outputs at which the follower rests against the cam
    integer :: off_plane = 0                             !< contact that leaves the plane of the cam; 0: the motion keeps to it
    real(wp) :: deviation = 0.0_wp                       !< distance from the plane there [m]; 0: the flat face turns out of it
  end type cam_profile_type

  integer, parameter :: refinements = 2     !< times that the places of extreme values are looked at more closely
  integer, parameter :: parts = 40          !< parts into which an interval is divided each time
  integer, parameter :: most_ends = 60      !< ends of undercut ranges that are looked at, at most
  !> Part of the profile's size, or sine of an angle, by which digits of the data may make the motion leave the plane.
  real(wp), parameter :: plane_tolerance = 1.0e-6_wp
  !> The ends of a closed profile meet to this part of its size.
  real(wp), parameter :: ends_meet = 1.0e-9_wp

contains

  !> Follow the motion and find the profile. Fails where the motion does.
  subroutine find_profile(model, plan, start, cam, profile, err)
    type(model_type), intent(in), target :: model              !< the model, whose independent coordinates are driven
    type(plan_type), intent(in) :: plan                        !< its plan
    type(state_type), intent(in) :: start                      !< its closed position at the start
    type(cam_request_type), intent(in) :: cam                  !< the cam and its follower
    type(cam_profile_type), intent(out) :: profile             !< the profile
    type(error_type), allocatable, intent(out) :: err          !< allocated if it failed
    type(pair_axes_type), allocatable :: axes(:)
    real(wp), allocatable :: times(:)
    integer :: i, pass

    axes = pair_axes(model%mechanism%pairs)
    axes = axes(cam%guide:cam%guide - merge(1, 0, cam%guide == 0))
    profile%has_pressure = size(axes) > 0
    associate (grid => model%request%time)
      times = [(grid%time(i), i=0, grid%intervals)]
      allocate (profile%at_output(size(times)), source=.true.)
    end associate
    do pass = 0, refinements
      if (pass > 0) call divide(profile, times)
      call follow(model, plan, start, cam, axes, times, profile%contacts, err)
      if (allocated(err)) return
      call find_extremes(profile)
    end do
    if (.not. profile%has_pressure) profile%pressure = 0
    ! at the ends of an undercut range the radius is zero, and nowhere is it least
    if (size(profile%undercut, 2) > 0) profile%convex = 0
    profile%resting = count(profile%at_output .and. .not. profile%contacts%known)
    call check_plane(profile)
    profile%closed = profile%resting == 0 .and. are_ends_together(profile%contacts)
  end subroutine find_profile

  !> The contacts at some times.
  subroutine follow(model, plan, start, cam, guides, times, contacts, err)
    type(model_type), intent(in), target :: model                        !< the model
    type(plan_type), intent(in) :: plan                                  !< its plan
    type(state_type), intent(in) :: start                                !< its closed position at the start
    type(cam_request_type), intent(in) :: cam                            !< the cam and its follower
    type(pair_axes_type), intent(in) :: guides(:)                        !< the pair that guides the follower, or none
    real(wp), intent(in) :: times(:)                                     !< from the start on, in order [s]
    type(cam_contact_type), allocatable, intent(out) :: contacts(:)      !< one for each time
    type(error_type), allocatable, intent(out) :: err                    !< allocated if it failed
    class(driven_simulation_type), allocatable, target :: simulation
    type(plan_type), pointer :: present_plan
    type(state_type), pointer :: state
    integer :: i

    allocate (simulation)
    call new_driven_simulation(model, plan, start, simulation, pictures=.true.)
    allocate (contacts(size(times)))
    do i = 1, size(times)
      if (i == 1) then
        call simulation%start(err)
      else
        call simulation%advance(times(i), err)
      end if
      if (allocated(err)) return
      call simulation%present(present_plan, state)
      call find_contact(cam, guides, present_plan, state, contacts(i))
    end do
  end subroutine follow

  !> Find the extreme values and the ranges of undercut among the contacts.
  pure subroutine find_extremes(profile)
    type(cam_profile_type), intent(inout) :: profile   !< with its contacts
    integer :: i, n
    integer, allocatable :: ranges(:, :)

    profile%pressure = 0
    profile%convex = 0
    profile%concave = 0
    n = 0
    allocate (ranges(2, size(profile%contacts)))
    associate (contacts => profile%contacts)
      do i = 1, size(contacts)
        if (.not. contacts(i)%known) cycle
        if (profile%pressure == 0) profile%pressure = i
        if (contacts(i)%pressure > contacts(profile%pressure)%pressure) profile%pressure = i
        if (contacts(i)%undercut) then
          if (n > 0) then
            if (ranges(2, n) == i - 1) then
              ranges(2, n) = i
              cycle
            end if
          end if
          n = n + 1
          ranges(:, n) = i
        else if (contacts(i)%radius > 0.0_wp) then
          if (profile%convex == 0) profile%convex = i
          if (contacts(i)%radius < contacts(profile%convex)%radius) profile%convex = i
        else
          if (profile%concave == 0) profile%concave = i
          if (contacts(i)%radius > contacts(profile%concave)%radius) profile%concave = i
        end if
      end do
    end associate
    profile%undercut = ranges(:, :n)
  end subroutine find_extremes

  !> Divide the intervals beside extreme values, and those in which an undercut begins or ends.
  pure subroutine divide(profile, times)
    type(cam_profile_type), intent(inout) :: profile       !< with its contacts; gets which of the new times are outputs
    real(wp), allocatable, intent(inout) :: times(:)       !< the times, in order; gets more of them [s]
    logical, allocatable :: divided(:)
    real(wp), allocatable :: finer(:)
    logical, allocatable :: at_output(:)
    integer :: i, k, n, at, ends

    allocate (divided(size(times)), source=.false.)   ! interval i ends at time i
    call mark(profile%pressure, divided)
    call mark(profile%convex, divided)
    call mark(profile%concave, divided)
    ends = 0
    do i = 2, size(times)
      if (profile%contacts(i)%undercut .eqv. profile%contacts(i - 1)%undercut) cycle
      divided(i) = .true.
      ends = ends + 1
      if (ends == most_ends) exit
    end do
    n = size(times) + (parts - 1)*count(divided)
    allocate (finer(n), at_output(n))
    at_output = .false.
    at = 0
    do i = 1, size(times)
      if (divided(i)) then
        do k = 1, parts - 1
          finer(at + k) = times(i - 1) + (times(i) - times(i - 1))*k/parts
        end do
        at = at + parts - 1
      end if
      at = at + 1
      finer(at) = times(i)
      at_output(at) = profile%at_output(i)
    end do
    call move_alloc(finer, times)
    call move_alloc(at_output, profile%at_output)
  end subroutine divide

  !> Mark the intervals beside a contact.
  pure subroutine mark(place, divided)
    integer, intent(in) :: place             !< number of the contact; 0: none
    logical, intent(inout) :: divided(:)     !< whether the interval that ends at each contact is divided

    if (place > 1) divided(place) = .true.
    if (place > 0 .and. place < size(divided)) divided(place + 1) = .true.
  end subroutine mark

  !> Find whether the follower leaves the plane of the cam, as no follower of a plane cam does.
  pure subroutine check_plane(profile)
    type(cam_profile_type), intent(inout) :: profile   !< with its contacts; gets the first one that leaves the plane
    real(wp) :: extent
    integer :: i

    extent = extent_of(profile%contacts)
    do i = 1, size(profile%contacts)
      associate (contact => profile%contacts(i))
        profile%deviation = abs(contact%height - profile%contacts(1)%height)
        if (profile%deviation <= plane_tolerance*extent .and. contact%tilt <= plane_tolerance) cycle
        if (contact%tilt > plane_tolerance) profile%deviation = 0.0_wp
      end associate
      profile%off_plane = i
      return
    end do
  end subroutine check_plane

  !> The size of the pitch curve: its diagonal, or its greatest distance from the cam's origin.
  pure real(wp) function extent_of(contacts) result(extent)
    type(cam_contact_type), intent(in) :: contacts(:)   !< the contacts
    integer :: i

    extent = 0.0_wp
    do i = 1, size(contacts)
      extent = max(extent, norm2(contacts(i)%pitch))
    end do
  end function extent_of

  !> Whether the profile comes back to its first point.
  pure logical function are_ends_together(contacts)
    type(cam_contact_type), intent(in) :: contacts(:)   !< all known
    integer :: n

    n = size(contacts)
    are_ends_together = n > 3 .and. norm2(contacts(n)%profile - contacts(1)%profile) <= ends_meet*extent_of(contacts)
  end function are_ends_together
end module mech9_cam_profile
