!> First part of the plan: steps and frames from the structural vectors, with constant poses folded.
!> Uses kinds, error, pose, pair, structure, mechanism, plan.
module mech9_frames
  use mech9_kinds, only: wp
  use mech9_pose, only: pose_type, compose, inverse, identity_pose
  use mech9_pair, only: screw_factors_type
  use mech9_structural_vectors, only: structural_vectors_type
  use mech9_mechanism, only: mechanism_type
  use mech9_plan, only: plan_type, step_type, closure_type
  implicit none
  private
  public :: lay_out_frames

contains

  !> Steps, frames and closures (their ranks and rows are found later) in the order of the
  !> structural vectors; one provisional block is not made.
  subroutine lay_out_frames(mechanism, plan)
    type(mechanism_type), intent(in) :: mechanism
    type(plan_type), intent(out) :: plan
    type(pose_type) :: after
    logical :: known(mechanism%structure%n_links)
    integer :: i, s, n_closed, link, chain

    associate (vectors => mechanism%vectors, structure => mechanism%structure)
      plan%n_links = structure%n_links
      plan%n_coordinates = structure%n_coordinates
      plan%independent = pack([(i, i=1, structure%n_coordinates)], structure%independent)
      allocate (plan%steps(plan%n_coordinates), plan%step_of(plan%n_coordinates))
      allocate (plan%frame_of(plan%n_links), source=0)
      allocate (plan%link_in_frame(plan%n_links), plan%pairs(plan%n_coordinates))
      allocate (plan%closures(plan%n_coordinates - plan%n_links + 1))
      call find_size(mechanism, plan)
      call find_units(mechanism, plan)
      plan%link_in_frame(1)%p = -plan%origin
      known = .false.
      known(1) = .true.
      s = 0
      n_closed = 0
      chain = 0
      do i = 2, size(vectors%nrg)
        if (vectors%nws(i) == 0) cycle   ! a chain starts anew at a known link
        s = s + 1
        link = vectors%nrg(i)
        call make_step(mechanism, vectors%nrg(i - 1), link, vectors%nws(i), plan, plan%steps(s), after)
        plan%step_of(vectors%nws(i)) = s
        if (known(link)) then
          n_closed = n_closed + 1
          call make_closure(plan, n_closed, s, link, after, plan%closures(n_closed))
        else
          known(link) = .true.
          plan%frame_of(link) = s
          plan%link_in_frame(link) = after
        end if
      end do
    end associate
  end subroutine lay_out_frames

  !> The step from link `from` to link `to` through the pair of a coordinate; `after` is the arriving
  !> link's system in the new frame.
  subroutine make_step(mechanism, from, to, coordinate, plan, step, after)
    type(mechanism_type), intent(in) :: mechanism
    integer, intent(in) :: from, to, coordinate
    type(plan_type), intent(inout) :: plan
    type(step_type), intent(out) :: step
    type(pose_type), intent(out) :: after
    type(screw_factors_type) :: factors
    real(wp) :: direction

    associate (pair => mechanism%pairs(coordinate)%pair)
      step%parent = plan%frame_of(from)
      step%coordinate = coordinate
      step%link = to
      step%reversed = pair%reference /= from
      step%dependent = .not. mechanism%structure%independent(coordinate)
      call pair%as_screw(factors, step%is_screw)
      if (step%is_screw) then
        direction = merge(-1.0_wp, 1.0_wp, step%reversed)
        step%turn = direction*factors%turn
        step%slide = direction*factors%slide
        step%offset = factors%offset
        if (step%reversed) then
          step%before = compose(plan%link_in_frame(from), inverse(factors%after))
          after = inverse(factors%before)
        else
          step%before = compose(plan%link_in_frame(from), factors%before)
          after = factors%after
        end if
      else
        allocate (plan%pairs(coordinate)%pair, source=pair)
        step%before = plan%link_in_frame(from)
        after = identity_pose
      end if
    end associate
  end subroutine make_step

  !> The closure of the chain whose last step reaches a known link, and the loop it belongs to.
  subroutine make_closure(plan, number, closing, link, after, closure)
    type(plan_type), intent(in) :: plan
    integer, intent(in) :: number, closing, link
    type(pose_type), intent(in) :: after        !< the link's system in the closing frame
    type(closure_type), intent(out) :: closure
    integer :: up, down, n, loop(plan%n_coordinates)
    real(wp) :: signs(plan%n_coordinates)

    closure%chain = number
    closure%closing = closing
    closure%target = plan%frame_of(link)
    closure%in_target = compose(plan%link_in_frame(link), inverse(after))
    ! walk both ends back until they meet; frames are numbered outwards, so the larger number steps back
    up = closing
    down = closure%target
    n = 0
    do while (up /= down)
      n = n + 1
      if (up > down) then
        loop(n) = up
        signs(n) = 1.0_wp
        up = plan%steps(up)%parent
      else
        loop(n) = down
        signs(n) = -1.0_wp
        down = plan%steps(down)%parent
      end if
    end do
    closure%base = up
    closure%path%steps = loop(n:1:-1)
    closure%path%signs = signs(n:1:-1)
  end subroutine make_closure

  !> Size of the mechanism and a good origin: the middle of link 1's pairs.
  !> The size is the largest distance between two pairs of one link. Where all links have their pairs
  !> in one point, as in spherical mechanisms, it is the largest distance of a point or pair from the
  !> origin of its link, or 1 if that is nothing.
  subroutine find_size(mechanism, plan)
    type(mechanism_type), intent(in) :: mechanism
    type(plan_type), intent(inout) :: plan
    real(wp) :: low(3, mechanism%structure%n_links), high(3, mechanism%structure%n_links)
    type(screw_factors_type) :: factors
    type(pose_type) :: frame
    real(wp) :: reach
    logical :: is_screw
    integer :: k

    low = huge(low)
    high = -huge(high)
    do k = 1, plan%n_coordinates
      associate (pair => mechanism%pairs(k)%pair)
        call pair%as_screw(factors, is_screw)
        if (.not. is_screw) factors = screw_factors_type()
        frame = inverse(factors%after)
        low(:, pair%reference) = min(low(:, pair%reference), factors%before%p)
        high(:, pair%reference) = max(high(:, pair%reference), factors%before%p)
        low(:, pair%moving) = min(low(:, pair%moving), frame%p)
        high(:, pair%moving) = max(high(:, pair%moving), frame%p)
      end associate
    end do
    plan%origin = 0.5_wp*(low(:, 1) + high(:, 1))
    plan%length = 0.0_wp
    do k = 1, plan%n_links
      plan%length = max(plan%length, norm2(high(:, k) - low(:, k)))
    end do
    do k = 1, plan%n_coordinates
      if (.not. mechanism%pairs(k)%pair%angular) &
        plan%length = max(plan%length, abs(mechanism%initial_position(k)))
    end do
    reach = 0.0_wp
    do k = 1, plan%n_links
      reach = max(reach, maxval(abs(high(:, k))), maxval(abs(low(:, k))))
    end do
    do k = 1, size(mechanism%points)
      reach = max(reach, maxval(abs(mechanism%points(k)%position)))
    end do
    ! distances that are nothing but round-off are no size
    if (plan%length <= 1.0e-9_wp*reach) plan%length = reach
    if (plan%length <= 1.0e-14_wp) plan%length = 1.0_wp
  end subroutine find_size

  !> What counts as one in each coordinate.
  subroutine find_units(mechanism, plan)
    type(mechanism_type), intent(in) :: mechanism
    type(plan_type), intent(inout) :: plan
    type(screw_factors_type) :: factors
    logical :: is_screw
    integer :: k

    allocate (plan%unit_of(plan%n_coordinates), source=1.0_wp)
    do k = 1, plan%n_coordinates
      call mechanism%pairs(k)%pair%as_screw(factors, is_screw)
      if (is_screw .and. .not. mechanism%pairs(k)%pair%angular) plan%unit_of(k) = plan%length
    end do
  end subroutine find_units
end module mech9_frames
