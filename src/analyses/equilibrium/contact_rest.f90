!> Rest on rigid contacts of links without friction: gaps g >= 0 and normal forces f >= 0, one of both zero at each contact.
!>
!> Each contact presses with max(0, f - k g), and the mechanism balances under these forces. They become the next f, until gaps are zero
!> where contacts press: the method of multipliers (R. T. Rockafellar, Math. Programming 5 (1973)). The error falls by the ratio of the
!> mechanism's stiffness to k in each round, and the forces tell which contacts are closed. Within a round those that press may also pull, so
!> that Newton's method does not lose them.
module mech9_contact_rest
  use mech9_kinds, only: wp
  use mech9_rotation, only: cross
  use mech9_friction_cones, only: solve_least
  use mech9_error, only: error_type, exit_assembly, exit_interrupted
  use mech9_motion_view, only: link_motion_type
  use mech9_contact, only: contact_place_type
  use mech9_load, only: load_slot_type, append_loads
  use mech9_pressing_load, only: pressing_load_type
  use mech9_mechanism, only: mechanism_type
  use mech9_model, only: model_type
  use mech9_plan, only: plan_type
  use mech9_state, only: state_type, copy_state
  use mech9_frame_motion, only: link_motion
  use mech9_motion_variation, only: vary_position
  use mech9_linearisation, only: new_linearisation
  use mech9_posture, only: posture_type, new_posture
  use mech9_simulation, only: interruption_type
  use mech9_contact_motion, only: place_of_contact
  use mech9_resting_mechanism, only: resting_type, put_to_rest, stand_at, find_stiffness, try_step, copy_resting
  use mech9_same_position, only: is_same_position
  use mech9_linearised_equilibrium, only: equilibrium_type, linearise_in_place, let_follow, copy_equilibrium
  use mech9_equilibrium_search, only: raise_no_equilibrium
  use mech9_equilibria, only: find_equilibrium, find_equilibria
  implicit none
  private
  public :: has_rigid_contacts, find_rest_on_contacts, find_all_on_contacts, bearing_contact, close_gaps

  !> A mechanism whose rigid contacts press as springs with given forces.
  type :: pressed_type
    type(model_type) :: model                 !< with a load for each rigid contact, which stand last
    integer, allocatable :: contacts(:)       !< numbers of these contacts in the mechanism
    real(wp) :: stiffness = 0.0_wp            !< of the springs at first [N/m]
    real(wp) :: scale = 0.0_wp                !< of forces [N]
  end type pressed_type

  !> The springs are so many times stiffer than the mechanism, in the search and in the rounds that follow. Stiffer ones make rounds fewer,
  !> and round-off of forces larger.
  real(wp), parameter :: stiff = 1.0e2_wp, stiffer = 1.0e3_wp
  !> Most rounds. The error falls by some 1e-3 in each.
  integer, parameter :: most_rounds = 60
  !> A round that reduces the error to no less than this part has reached round-off, or the springs are too soft.
  real(wp), parameter :: least_contraction = 0.5_wp
  !> Gaps below the first part of the mechanism's length are closed; up to the second one round-off may keep them from it.
  real(wp), parameter :: closed_gap = 1.0e-14_wp, nearly_closed = 1.0e-11_wp
  !> Contacts with gaps below this part of the mechanism's length touch at the start.
  real(wp), parameter :: touching = 1.0e-3_wp
  !> Gaps beside a position of rest are closed up to this part of the mechanism's length, for pictures.
  real(wp), parameter :: closed_in_pictures = 1.0e-9_wp
  !> Most steps by which they are closed.
  integer, parameter :: most_steps = 10
  !> A contact bears where its force is above this part of all forces.
  real(wp), parameter :: bears = 1.0e-9_wp
  !> Rows of gaps below this part of the largest one depend on others.
  real(wp), parameter :: dependent = 1.0e-9_wp
  !> Entries within this part of the largest one are as good as it, and the last of them leads to a coordinate that follows.
  real(wp), parameter :: as_good = 1.0e-6_wp

contains

  !> Whether any contact of links is rigid.
  pure logical function has_rigid_contacts(mechanism)
    type(mechanism_type), intent(in) :: mechanism   !< the mechanism

    has_rigid_contacts = .false.
    if (mechanism%has_contacts()) has_rigid_contacts = any(mechanism%contacts%is_rigid)
  end function has_rigid_contacts

  !> The number of a contact that bears a force in a position of rest; 0: none does.
  pure integer function bearing_contact(mechanism, found) result(number)
    type(mechanism_type), intent(in) :: mechanism   !< the mechanism
    type(equilibrium_type), intent(in) :: found     !< the position of rest
    integer :: i

    number = 0
    if (.not. allocated(found%resting%state)) return
    if (.not. allocated(found%resting%state%contact_force)) return
    do i = 1, size(mechanism%contacts)
      if (.not. mechanism%contacts(i)%is_rigid) cycle
      if (any(abs(found%resting%state%contact_force(:, i)) > 0.0_wp)) number = mechanism%contacts(i)%number
      if (number > 0) return
    end do
  end function bearing_contact

  !> The position of rest to which an assembled position leads, with the forces of contacts. Fails as find_equilibrium does.
  subroutine find_rest_on_contacts(model, plan, assembled, found, err)
    type(model_type), intent(in) :: model               !< the model
    type(plan_type), intent(in) :: plan                 !< its plan, in space
    type(state_type), intent(in) :: assembled           !< closed, with rates and accelerations of the driven coordinates
    type(equilibrium_type), intent(out) :: found        !< the position of rest
    type(error_type), allocatable, intent(out) :: err   !< allocated if it failed
    class(pressed_type), allocatable :: pressed
    real(wp), allocatable :: forces(:)
    type(error_type), allocatable :: failure
    integer :: trial

    allocate (pressed)
    call press(model, plan, assembled, pressed, err)
    if (allocated(err)) return
    ! contacts that touch press from the beginning: an unstable rest near by is found, too
    call place_at(assembled, forces)
    do trial = 1, 2
      call set_springs(pressed, forces, pressed%stiffness, .false.)
      call find_equilibrium(pressed%model%mechanism, model%problem%partition, plan, assembled, found, failure)
      if (.not. allocated(failure)) call close_contacts(model, pressed, forces, found, failure)
      if (.not. allocated(failure)) exit
      if (.not. allocated(err)) call move_alloc(failure, err)
      if (err%code /= exit_assembly) return
      forces = merge(0.0_wp, pressed%scale, any(forces > 0.0_wp))
    end do
    if (.not. allocated(failure) .and. allocated(err)) deallocate (err)
  contains
    !> The forces of contacts at first: those of all loads where the bodies touch.
    subroutine place_at(state, forces)
      type(state_type), intent(in) :: state                  !< the position at the start
      real(wp), allocatable, intent(out) :: forces(:)        !< (rigid contacts) [N]
      real(wp) :: gaps(size(pressed%contacts))

      gaps = gaps_of(model%mechanism, pressed%contacts, plan, state)
      allocate (forces(size(gaps)))
      forces = merge(pressed%scale, 0.0_wp, gaps <= touching*plan%length)
    end subroutine place_at
  end subroutine find_rest_on_contacts

  !> All positions of rest to which an assembled position and random ones lead. Fails as find_equilibria does.
  subroutine find_all_on_contacts(model, plan, assembled, n_starts, list, err, interruption)
    type(model_type), intent(in) :: model                             !< the model
    type(plan_type), intent(in) :: plan                               !< its plan, in space
    type(state_type), intent(in) :: assembled                         !< closed, with the motion of the driven coordinates
    integer, intent(in) :: n_starts                                   !< number of random positions
    type(equilibrium_type), allocatable, intent(out) :: list(:)       !< the positions of rest
    type(error_type), allocatable, intent(out) :: err                 !< allocated if it failed
    class(interruption_type), intent(in), optional :: interruption    !< is asked before each start whether the search shall stop
    type(equilibrium_type), allocatable :: near(:)
    class(pressed_type), allocatable :: pressed
    type(error_type), allocatable :: failure, first
    integer, allocatable :: kept(:)
    integer :: i

    allocate (pressed, list(0))
    call press(model, plan, assembled, pressed, err)
    if (allocated(err)) return
    ! open contacts have no forces that could become less
    call find_equilibria(pressed%model, plan, assembled, n_starts, near, err, interruption, falls=.true.)
    if (allocated(err)) then
      if (err%code /= exit_interrupted) return
    end if
    allocate (kept(0))
    do i = 1, size(near)
      call close_contacts(model, pressed, spread(0.0_wp, 1, size(pressed%contacts)), near(i), failure)
      if (.not. allocated(failure)) then
        call keep_new(model%mechanism, plan, near, i, kept)
      else if (.not. allocated(first)) then
        call move_alloc(failure, first)
      end if
    end do
    deallocate (list)
    allocate (list(size(kept)))
    do i = 1, size(kept)
      call copy_equilibrium(near(kept(i)), list(i))
    end do
    if (size(list) == 0 .and. allocated(first) .and. .not. allocated(err)) call move_alloc(first, err)
  end subroutine find_all_on_contacts

  !> Keep a position unless it is one of those that are kept; then its finds are counted.
  subroutine keep_new(mechanism, plan, near, i, kept)
    type(mechanism_type), intent(in) :: mechanism         !< the mechanism
    type(plan_type), intent(in) :: plan                   !< a plan of it
    type(equilibrium_type), intent(inout) :: near(:)      !< positions of rest
    integer, intent(in) :: i                              !< number of the position
    integer, allocatable, intent(inout) :: kept(:)        !< numbers of those that are kept
    type(posture_type) :: posture
    type(state_type) :: state
    real(wp), allocatable :: numbers(:), others(:)
    integer :: j

    posture = new_posture(mechanism, plan)
    call copy_state(near(i)%resting%state, state)
    numbers = posture%numbers(near(i)%resting%plan, state)
    do j = 1, size(kept)
      associate (known => near(kept(j)))
        call copy_state(known%resting%state, state)
        others = posture%numbers(known%resting%plan, state)
        if (.not. is_same_position(mechanism, posture, known%resting, near(i)%resting, others, numbers)) cycle
        known%found = known%found + near(i)%found
        return
      end associate
    end do
    kept = [kept, i]
  end subroutine keep_new

  !> Make the model whose rigid contacts press. Fails where a load has no value.
  subroutine press(model, plan, assembled, pressed, err)
    type(model_type), intent(in) :: model               !< the model
    type(plan_type), intent(in) :: plan                 !< its plan, in space
    type(state_type), intent(in) :: assembled           !< closed, with the motion of the driven coordinates
    type(pressed_type), intent(inout) :: pressed        !< gets the model and its stiffness
    type(error_type), allocatable, intent(out) :: err   !< allocated if it failed
    class(resting_type), allocatable :: resting
    type(load_slot_type), allocatable :: more(:)
    real(wp) :: energy
    integer :: i

    allocate (resting)
    call put_to_rest(model%mechanism, model%problem%partition, plan, assembled, resting, err)
    if (.not. allocated(err)) call find_stiffness(model%mechanism, resting, err)
    if (allocated(err)) return
    energy = max(resting%stiffness_magnitude, resting%linearisation%tree%magnitude)
    if (.not. energy > 0.0_wp) energy = 1.0_wp
    pressed%scale = energy/plan%length
    pressed%stiffness = stiff*energy/plan%length**2
    pressed%model = model
    associate (contacts => model%mechanism%contacts)
      pressed%contacts = pack([(i, i=1, size(contacts))], contacts%is_rigid)
      allocate (more(size(pressed%contacts)))
      do i = 1, size(more)
        allocate (pressing_load_type :: more(i)%load)
        select type (load => more(i)%load)
        type is (pressing_load_type)
          load%contact = contacts(pressed%contacts(i))
          load%place = contacts(pressed%contacts(i))%place
        end select
      end do
    end associate
    call append_loads(more, pressed%model%mechanism%loads)
    call set_springs(pressed, spread(0.0_wp, 1, size(pressed%contacts)), pressed%stiffness, .false.)
  end subroutine press

  !> Set the numbers of the springs.
  subroutine set_springs(pressed, forces, stiffness, pulls)
    type(pressed_type), intent(inout) :: pressed   !< the model
    real(wp), intent(in) :: forces(:)              !< (rigid contacts) without a gap [N]
    real(wp), intent(in) :: stiffness              !< of all [N/m]
    logical, intent(in) :: pulls                   !< those with forces may pull, too
    integer :: i, first

    first = size(pressed%model%mechanism%loads) - size(forces)
    do i = 1, size(forces)
      select type (load => pressed%model%mechanism%loads(first + i)%load)
      type is (pressing_load_type)
        load%preload = forces(i)
        load%stiffness = stiffness
        load%pulls = pulls .and. forces(i) > 0.0_wp
      end select
    end do
  end subroutine set_springs

  !> Go on from springs to rigid contacts: close the gaps of those that press, and linearise with the closed ones held. Fails where
  !> gaps do not close.
  subroutine close_contacts(model, pressed, first, found, err)
    type(model_type), intent(in) :: model               !< the model
    type(pressed_type), intent(inout) :: pressed        !< the same on springs
    real(wp), intent(in) :: first(:)                    !< (rigid contacts) forces of the springs without gaps [N]
    type(equilibrium_type), intent(inout) :: found      !< the position on these springs; then on rigid contacts
    type(error_type), allocatable, intent(out) :: err   !< allocated if it failed
    class(equilibrium_type), allocatable :: next
    real(wp), dimension(size(pressed%contacts)) :: forces, new
    real(wp) :: stiffness, error, before
    integer :: i, starts

    starts = found%found
    forces = first
    stiffness = pressed%stiffness
    before = huge(before)
    allocate (next)
    do i = 1, most_rounds
      new = max(0.0_wp, forces - stiffness*gaps_of(model%mechanism, pressed%contacts, found%resting%plan, found%resting%state))
      error = maxval(abs(new - forces))/stiffness/found%resting%plan%length
      forces = new
      if (error <= closed_gap .or. (error > least_contraction*before .and. error <= nearly_closed)) exit
      if (i == 1 .or. error > least_contraction*before) stiffness = min(10.0_wp*stiffness, stiffer*pressed%stiffness)
      before = error
      call set_springs(pressed, forces, stiffness, .true.)
      call find_equilibrium(pressed%model%mechanism, model%problem%partition, found%resting%plan, found%resting%state, next, err)
      if (allocated(err)) exit
      call copy_equilibrium(next, found)
    end do
    if (.not. allocated(err) .and. i > most_rounds) call raise_no_equilibrium(model%mechanism, found%resting, err)
    if (.not. allocated(err) .and. any(forces > bears*pressed%scale)) call rest_on(pressed, forces, found, err)
    if (.not. allocated(err)) call return_to(model%mechanism, found%resting, err)
    ! the next search begins without forces again
    call set_springs(pressed, 0.0_wp*forces, pressed%stiffness, .false.)
    found%found = starts
  end subroutine close_contacts

  !> The gaps of some contacts [m].
  pure function gaps_of(mechanism, numbers, plan, state) result(gaps)
    type(mechanism_type), intent(in) :: mechanism   !< the mechanism
    integer, intent(in) :: numbers(:)               !< of the contacts
    type(plan_type), intent(in) :: plan             !< a plan of it
    type(state_type), intent(in) :: state           !< its position
    real(wp) :: gaps(size(numbers))
    type(contact_place_type) :: place
    type(link_motion_type) :: ball, surface
    integer :: i

    do i = 1, size(numbers)
      call place_of_contact(mechanism%contacts(numbers(i)), plan, state, place, ball, surface)
      gaps(i) = place%gap
    end do
  end function gaps_of

  !> Linearise on closed contacts with constant forces, whose derivatives are those of the normals. Coordinates follow so that the gaps stay
  !> closed.
  subroutine rest_on(pressed, forces, found, err)
    type(pressed_type), intent(inout) :: pressed        !< the model
    real(wp), intent(in) :: forces(:)                   !< (rigid contacts) normal forces [N]
    type(equilibrium_type), intent(inout) :: found      !< the position of rest; gets all else
    type(error_type), allocatable, intent(out) :: err   !< allocated if it failed
    type(state_type) :: state
    real(wp), allocatable :: rows(:, :), follow(:, :)
    integer, allocatable :: followers(:), kept(:)
    integer :: i

    call set_springs(pressed, forces, 0.0_wp, .false.)
    associate (mechanism => pressed%model%mechanism, resting => found%resting)
      call copy_state(resting%state, state)
      call stand_at(mechanism, state, resting, err)
      if (.not. allocated(err)) call linearise_in_place(mechanism, found, err)
      if (allocated(err)) return
      call find_rows(mechanism, pack(pressed%contacts, forces > bears*pressed%scale), resting, rows)
      call eliminate(rows, followers, kept, follow)
      do i = 1, size(followers)
        follow(i, :) = follow(i, :)*resting%plan%unit_of(resting%free(followers(i)))/resting%plan%unit_of(resting%free(kept))
      end do
      call let_follow(kept, followers, follow, found)
      call show_forces(pressed, forces, found%resting%plan, found%resting%state)
    end associate
  end subroutine rest_on

  !> Return from the mechanism on springs to the one that was given, whose loads are fewer.
  subroutine return_to(mechanism, resting, err)
    type(mechanism_type), intent(in) :: mechanism       !< the mechanism
    type(resting_type), intent(inout) :: resting        !< at rest, with the forces of contacts
    type(error_type), allocatable, intent(out) :: err   !< allocated if a load failed
    type(state_type) :: state

    call new_linearisation(mechanism, resting%plan, resting%linearisation)
    call copy_state(resting%state, state)
    call stand_at(mechanism, state, resting, err)
  end subroutine return_to

  !> The derivatives of gaps by the free coordinates, in their units.
  subroutine find_rows(mechanism, numbers, resting, rows)
    type(mechanism_type), intent(in) :: mechanism        !< the mechanism
    integer, intent(in) :: numbers(:)                    !< of the contacts
    type(resting_type), intent(inout) :: resting         !< the mechanism at rest; its last variation changes
    real(wp), allocatable, intent(out) :: rows(:, :)     !< (contacts,n) [m]
    type(contact_place_type) :: place
    integer :: i, j

    allocate (rows(size(numbers), size(resting%free)))
    associate (variation => resting%linearisation%variation)
      do j = 1, size(resting%free)
        call variation%clear()
        variation%q(resting%free(j)) = resting%plan%unit_of(resting%free(j))
        call vary_position(resting%plan, resting%state, resting%linearisation%motion, variation)
        do i = 1, size(numbers)
          associate (contact => mechanism%contacts(numbers(i)))
            place = contact%find_place(varied_link(resting, contact%links(1)), varied_link(resting, contact%links(2)))
          end associate
          rows(i, j) = place%gap_rate()
        end do
      end do
    end associate
  end subroutine find_rows

  !> Move the coordinates that follow so that the contacts that bear in a position of rest are closed in a position beside it, too.
  !> `closed` is false where they cannot be.
  subroutine close_gaps(mechanism, rest, beside, closed, err)
    type(mechanism_type), intent(in) :: mechanism        !< the mechanism
    type(resting_type), intent(in) :: rest               !< the position of rest, with the forces of contacts
    type(resting_type), intent(inout) :: beside          !< the position beside it; the coordinates that follow change
    logical, intent(out) :: closed                       !< the gaps are closed
    type(error_type), allocatable, intent(out) :: err    !< allocated if a load failed
    class(resting_type), allocatable :: aside, next
    integer, allocatable :: numbers(:)
    real(wp), allocatable :: rows(:, :), gaps(:), changes(:)
    integer :: i
    logical :: depends

    closed = .true.
    if (.not. (allocated(rest%following) .and. allocated(rest%state%contact_force))) return
    associate (contacts => mechanism%contacts)
      numbers = pack([(i, i=1, size(contacts))], contacts%is_rigid .and. any(abs(rest%state%contact_force) > 0.0_wp, dim=1))
    end associate
    allocate (aside, next, changes(size(numbers)))
    call copy_resting(beside, aside)
    deallocate (aside%following, aside%follow)
    aside%free = rest%following
    do i = 1, most_steps
      gaps = gaps_of(mechanism, numbers, aside%plan, aside%state)
      closed = all(abs(gaps) <= closed_in_pictures*aside%plan%length)
      if (closed) exit
      call find_rows(mechanism, numbers, aside, rows)
      call solve_least(matmul(rows, transpose(rows)), gaps, spread(1.0_wp, 1, size(gaps)), changes, depends)
      call try_step(mechanism, aside, -matmul(changes, rows), next, closed, err)
      if (allocated(err) .or. .not. closed) return
      call copy_resting(next, aside)
    end do
    call copy_state(aside%state, beside%state)
  end subroutine close_gaps

  !> A link whose velocities are the derivatives of its position by the last variation.
  function varied_link(resting, link) result(moved)
    type(resting_type), intent(in) :: resting   !< the mechanism at rest
    integer, intent(in) :: link                 !< number of the link
    type(link_motion_type) :: moved

    call link_motion(resting%plan, resting%state, link, moved%r, moved%p, moved%omega, moved%v)
    associate (f => resting%plan%frame_of(link), variation => resting%linearisation%variation)
      moved%omega = variation%turn(:, f)
      moved%v = variation%shift(:, f) + cross(variation%turn(:, f), moved%p - resting%state%p(:, f))
    end associate
  end function varied_link

  !> Solve homogeneous equations for some unknowns by the others (Gauss and Jordan, with the largest entry as pivot).
  pure subroutine eliminate(given, followers, kept, follow)
    real(wp), intent(in) :: given(:, :)                    !< (m,n) the equations
    integer, allocatable, intent(out) :: followers(:)      !< (h) unknowns that are solved for, h the rank
    integer, allocatable, intent(out) :: kept(:)           !< (k) the others, ascending
    real(wp), allocatable, intent(out) :: follow(:, :)     !< (h,k) the first ones per unit of the others
    real(wp) :: a(size(given, 1), size(given, 2)), largest
    logical :: is_open(size(given, 2))
    integer :: row(size(given, 1)), rank, i, j, at, pivot

    a = given
    is_open = .true.
    rank = 0
    do i = 1, size(a, 1)
      largest = maxval(abs(a(i:, :)), mask=spread(is_open, 1, size(a, 1) - i + 1))
      if (.not. largest > dependent*maxval(abs(given))) exit
      pivot = 0
      at = i
      do j = 1, size(a, 2)
        if (.not. is_open(j)) cycle
        if (maxval(abs(a(i:, j))) < (1.0_wp - as_good)*largest) cycle
        pivot = j
        at = i - 1 + maxloc(abs(a(i:, j)), dim=1)
      end do
      a([i, at], :) = a([at, i], :)
      a(i, :) = a(i, :)/a(i, pivot)
      do j = 1, size(a, 1)
        if (j /= i) a(j, :) = a(j, :) - a(j, pivot)*a(i, :)
      end do
      is_open(pivot) = .false.
      rank = i
      row(i) = pivot
    end do
    followers = row(:rank)
    kept = pack([(j, j=1, size(a, 2))], is_open)
    follow = -a(:rank, kept)
  end subroutine eliminate

  !> Show the forces of all contacts in a state.
  subroutine show_forces(pressed, forces, plan, state)
    type(pressed_type), intent(in) :: pressed       !< the model
    real(wp), intent(in) :: forces(:)               !< (rigid contacts) normal forces [N]
    type(plan_type), intent(in) :: plan             !< its plan
    type(state_type), intent(inout) :: state        !< the position of rest; gets them
    type(contact_place_type) :: place
    type(link_motion_type) :: ball, surface
    real(wp) :: force
    integer :: i, k

    associate (contacts => pressed%model%mechanism%contacts)
      allocate (state%contact_force(3, size(contacts)), source=0.0_wp)
      do i = 1, size(contacts)
        call place_of_contact(contacts(i), plan, state, place, ball, surface)
        force = contacts(i)%normal_force(place)
        k = findloc(pressed%contacts, i, dim=1)
        if (k > 0) force = merge(forces(k), 0.0_wp, forces(k) > bears*pressed%scale)
        state%contact_force(:, i) = force*place%normal
      end do
    end associate
  end subroutine show_forces
end module mech9_contact_rest
