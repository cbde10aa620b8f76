!> Coordinates that do not occur in the equations of motion, but for their rates: cyclic ones, as the angle of a shaft that no spring holds.
!>
!> This follows from the structure alone, so that it holds for all values. Cyclic is the angle of a revolute pair on link 1 which no closed
!> chain, coupling, stop, friction, contact or motor has, if gravity is parallel to its axis, and if no load depends on the places
!> of the links behind it, or on the angle itself. Where this is not certain, a coordinate does not count as cyclic.
module mech9_cyclic_coordinates
  use mech9_kinds, only: wp
  use mech9_partition, only: free_coordinate
  use mech9_mechanism, only: mechanism_type
  use mech9_coordinate_load, only: coordinate_load_type
  use mech9_pair, only: screw_factors_type
  use mech9_model, only: model_type
  implicit none
  private
  public :: find_cyclic

contains

  !> Find the cyclic coordinates among those that are free.
  subroutine find_cyclic(model, is_cyclic)
    type(model_type), intent(in) :: model                 !< the model
    logical, allocatable, intent(out) :: is_cyclic(:)     !< (M) the coordinate is cyclic
    integer :: k

    allocate (is_cyclic(size(model%mechanism%pairs)), source=.false.)
    if (model%mechanism%has_contacts()) return
    if (allocated(model%mechanism%couplings)) then
      if (size(model%mechanism%couplings) > 0) return
    end if
    do k = 1, size(is_cyclic)
      if (model%problem%partition%kind(k) == free_coordinate) call judge_coordinate(model%mechanism, k, is_cyclic(k))
    end do
  end subroutine find_cyclic

  !> Judge one coordinate.
  subroutine judge_coordinate(mechanism, k, is_cyclic)
    type(mechanism_type), intent(in) :: mechanism    !< the mechanism
    integer, intent(in) :: k                         !< number of the coordinate
    logical, intent(out) :: is_cyclic                !< it is cyclic
    logical :: behind(mechanism%structure%n_links), links(mechanism%structure%n_links), marked(mechanism%structure%n_coordinates)
    integer :: i

    call find_links_behind(mechanism, k, behind)
    is_cyclic = any(behind) .and. turns_about_gravity(mechanism, k)
    do i = 1, size(mechanism%stops)
      is_cyclic = is_cyclic .and. mechanism%stops(i)%coordinate /= k
    end do
    if (mechanism%has_frictions()) is_cyclic = is_cyclic .and. all(mechanism%frictions%coordinate /= k)
    marked = .false.
    links = .false.
    do i = 1, size(mechanism%motors)
      call mechanism%motors(i)%motor%mark_coordinates(marked)
      call mechanism%motors(i)%motor%mark_links(links)
    end do
    is_cyclic = is_cyclic .and. .not. (marked(k) .or. any(links .and. behind))
    do i = 1, size(mechanism%loads)
      if (is_cyclic) call judge_load(mechanism, i, k, behind, is_cyclic)
    end do
  end subroutine judge_coordinate

  !> Find the links that hang on link 1 by one pair alone; none where closed chains have the pair, or where it stands elsewhere.
  pure subroutine find_links_behind(mechanism, k, behind)
    type(mechanism_type), intent(in) :: mechanism    !< the mechanism
    integer, intent(in) :: k                         !< number of the pair
    logical, intent(out) :: behind(:)                !< (N) the links behind it
    logical :: before(size(behind))
    integer :: i, round

    behind = .false.
    associate (pair => mechanism%pairs(k)%pair)
      if (pair%reference /= 1) return
      before = .false.
      before(1) = .true.
      do round = 1, size(behind)
        do i = 1, size(mechanism%pairs)
          if (i == k) cycle
          associate (links => [mechanism%pairs(i)%pair%reference, mechanism%pairs(i)%pair%moving])
            if (any(before(links))) before(links) = .true.
          end associate
        end do
      end do
      if (.not. before(pair%moving)) behind = .not. before
    end associate
  end subroutine find_links_behind

  !> Whether a pair only turns, about an axis that is parallel to gravity.
  pure logical function turns_about_gravity(mechanism, k)
    type(mechanism_type), intent(in) :: mechanism    !< the mechanism
    integer, intent(in) :: k                         !< number of the pair
    type(screw_factors_type) :: factors
    logical :: is_screw

    turns_about_gravity = .false.
    call mechanism%pairs(k)%pair%as_screw(factors, is_screw)
    if (.not. is_screw) return
    if (abs(factors%slide) > 0.0_wp .or. .not. abs(factors%turn) > 0.0_wp) return
    associate (axis => factors%before%r(:, 3), gravity => mechanism%gravity)
      turns_about_gravity = norm2(gravity - axis*dot_product(axis, gravity)) <= 8.0_wp*epsilon(1.0_wp)*norm2(gravity)
    end associate
  end function turns_about_gravity

  !> Judge whether a load leaves a coordinate cyclic: it has nothing to do with links behind, and on the coordinate it depends on its rate
  !> alone.
  subroutine judge_load(mechanism, number, k, behind, leaves)
    type(mechanism_type), intent(in) :: mechanism    !< the mechanism
    integer, intent(in) :: number                    !< of the load
    integer, intent(in) :: k                         !< number of the coordinate
    logical, intent(in) :: behind(:)                 !< (N) links behind its pair
    logical, intent(out) :: leaves                   !< the coordinate stays cyclic
    logical :: links(size(behind)), coordinates(mechanism%structure%n_coordinates)

    leaves = .true.
    associate (load => mechanism%loads(number)%load)
      if (load%is_idle()) return
      links = .false.
      coordinates = .false.
      call load%mark_links(links)
      call load%mark_coordinates(coordinates)
      leaves = .not. any(links .and. behind)
      if (.not. leaves .or. .not. coordinates(k)) return
      leaves = .false.
      select type (load)
      type is (coordinate_load_type)
        leaves = load%coordinate /= k .or. .not. abs(load%stiffness) > 0.0_wp
        if (allocated(load%over)) leaves = leaves .and. (load%over%coordinate /= k .or. load%over%is_rate)
      end select
    end associate
  end subroutine judge_load
end module mech9_cyclic_coordinates
