!> The search for a position of equilibrium, with the exact stiffness.
!>
!> A position near an equilibrium leads to it by Newton's method, whether it is stable or not. From other positions the mechanism
!> is first let go: it moves as its forces pull, by Newton's method with the magnitudes of the stiffness in all directions, until
!> a stable equilibrium is near. Where that finds none, as from random starts, the sum of the squared forces is reduced
!> (Levenberg and Marquardt in docs/reference/bibliography.md), which leads to stable and unstable ones.
module mech9_equilibrium_search
  use mech9_kinds, only: wp
  use mech9_error, only: error_type, raise, exit_assembly
  use mech9_equilibrium_failures, only: failure_no_equilibrium
  use mech9_lapack, only: dsyev
  use mech9_singular_values, only: decompose
  use mech9_result_units, only: unit_of, si_force
  use mech9_mechanism, only: mechanism_type
  use mech9_resting_mechanism, only: resting_type, find_stiffness, try_step, choose_coordinates, is_balanced, &
    is_zero_force, copy_resting
  implicit none
  private
  public :: find_from_start, find_any, raise_no_equilibrium, tell_forces

  !> Steps of Newton's method up to this lead to an equilibrium near by [rad, lengths of the mechanism].
  real(wp), parameter :: near_by = 0.3_wp
  !> Longest and shortest step [rad, lengths of the mechanism].
  real(wp), parameter :: longest_step = 0.5_wp, shortest_step = 1.0e-12_wp
  !> Longest part of a step along one shape of the stiffness, before the step is shortened [rad, lengths of the mechanism].
  real(wp), parameter :: longest_descent = 1.0e3_wp
  !> Stiffnesses below this part of the sum of their terms are zero.
  real(wp), parameter :: zero_stiffness = 1.0e-11_wp
  !> Largest number of steps of each kind.
  integer, parameter :: most_steps = 300
  !> A step of Newton's method that reduces the forces to no less than this part has reached round-off.
  real(wp), parameter :: least_contraction = 0.5_wp
  !> Part of the predicted reduction of the squared forces, or of the work, at which a step is accepted.
  real(wp), parameter :: least_success = 1.0e-4_wp
  !> Farthest way from the start [rad, lengths of the mechanism].
  real(wp), parameter :: farthest = 300.0_wp

contains

  !> Find the equilibrium near a position, or that to which the mechanism descends from it. Fails with exit_assembly where there is
  !> none.
  subroutine find_from_start(mechanism, resting, err)
    type(mechanism_type), intent(in) :: mechanism       !< the mechanism
    type(resting_type), intent(inout) :: resting        !< stands in the equilibrium afterwards
    type(error_type), allocatable, intent(out) :: err   !< allocated if there is none, or if a load failed
    type(resting_type) :: start
    logical :: found

    call copy_resting(resting, start)
    call descend(mechanism, resting, found, err)
    if (allocated(err) .or. found) return
    ! unstable equilibria, and those of forces that are not conservative
    call copy_resting(start, resting)
    call find_any(mechanism, resting, found, err)
    if (.not. allocated(err) .and. .not. found) call raise_no_equilibrium(mechanism, resting, err)
  end subroutine find_from_start

  !> Fail because no equilibrium was found, with the forces in the last position.
  subroutine raise_no_equilibrium(mechanism, resting, err)
    type(mechanism_type), intent(in) :: mechanism       !< the mechanism
    type(resting_type), intent(in) :: resting           !< the mechanism at the end of the search
    type(error_type), allocatable, intent(out) :: err   !< the failure

    call raise(err, exit_assembly, failure_no_equilibrium)
    call tell_forces(mechanism, resting%free, resting%forces/resting%plan%unit_of(resting%free), resting%state%q(resting%free), &
                     err)
  end subroutine raise_no_equilibrium

  !> Add forces on coordinates and the positions of these to a failure, in units of the data file.
  pure subroutine tell_forces(mechanism, coordinates, forces, positions, err)
    type(mechanism_type), intent(in) :: mechanism       !< the mechanism
    integer, intent(in) :: coordinates(:)               !< their numbers
    real(wp), intent(in) :: forces(:)                   !< on each of them [N m, N]
    real(wp), intent(in) :: positions(:)                !< of each of them [rad, m]
    type(error_type), intent(inout) :: err              !< gets them, with the names of the units of forces
    integer :: i

    err%failure%coordinates = coordinates
    allocate (err%failure%values(size(coordinates), 2))
    do i = 1, size(coordinates)
      associate (k => coordinates(i))
        err%failure%values(i, 1) = forces(i)/mechanism%units%size_of(trim(si_force(mechanism%pairs(k)%pair)))
        err%failure%values(i, 2) = positions(i)/unit_of(mechanism, k)
      end associate
    end do
    err%failure%name = trim(mechanism%units%name_of('N m'))//', '//trim(mechanism%units%name_of('N'))
  end subroutine tell_forces

  !> Descend from the position to a stable equilibrium. An equilibrium near by is taken as it is.
  subroutine descend(mechanism, resting, found, err)
    type(mechanism_type), intent(in) :: mechanism       !< the mechanism
    type(resting_type), intent(inout) :: resting        !< the mechanism at rest
    logical, intent(out) :: found                       !< an equilibrium was found
    type(error_type), allocatable, intent(out) :: err   !< allocated if a load failed
    type(resting_type) :: other
    real(wp) :: step(size(resting%free)), work, radius
    integer :: i
    logical :: is_stable, moved

    found = .false.
    radius = longest_step
    do i = 1, most_steps
      call choose_coordinates(mechanism, resting, err)
      if (allocated(err)) return
      call find_stiffness(mechanism, resting, err)
      if (allocated(err)) return
      call descent_step(resting, step, is_stable)
      if (i == 1 .or. is_stable) then
        call copy_resting(resting, other)
        call approach(mechanism, other, found, err)
        if (allocated(err)) return
        if (found) call copy_resting(other, resting)
        if (found) return
      end if
      do
        if (radius < shortest_step) return
        if (maxval(abs(step)) > radius) step = step*(radius/maxval(abs(step)))
        call try_step(mechanism, resting, step, other, moved, err)
        if (allocated(err)) return
        work = 1.0_wp
        if (moved) work = dot_product(resting%forces + other%forces, step)
        if (work <= least_success*2.0_wp*dot_product(resting%forces, step)) exit
        radius = 0.25_wp*min(radius, maxval(abs(step)))
      end do
      call copy_resting(other, resting)
      radius = min(longest_step, 2.0_wp*radius)
    end do
  end subroutine descend

  !> The descent along the forces: Newton's step with the magnitudes of the stiffness. The stiffness is
  !> stable where none of its values is negative.
  subroutine descent_step(resting, step, is_stable)
    type(resting_type), intent(in) :: resting   !< with its stiffness
    real(wp), intent(out) :: step(:)            !< (n) of the free coordinates, in their units
    logical, intent(out) :: is_stable           !< no direction is unstable
    real(wp) :: vectors(size(step), size(step)), values(size(step)), work(34*size(step)), least, force, resistance
    integer :: n, i, info

    n = size(step)
    vectors = 0.5_wp*(resting%stiffness + transpose(resting%stiffness))
    call dsyev('V', 'L', n, vectors, n, values, work, size(work), info)
    least = zero_stiffness*resting%stiffness_magnitude
    is_stable = all(values >= -least)
    step = 0.0_wp
    do i = 1, n
      force = dot_product(vectors(:, i), resting%forces)
      if (abs(values(i)) <= least .and. is_zero_force(resting, force)) cycle
      ! a force against no stiffness would give a step without bound
      resistance = max(abs(values(i)), least, abs(force)/longest_descent, tiny(1.0_wp))
      step = step - vectors(:, i)*(force/resistance)
    end do
  end subroutine descent_step

  !> Newton's method from a position near an equilibrium, down to round-off. `found` is false where none is near.
  subroutine approach(mechanism, resting, found, err)
    type(mechanism_type), intent(in) :: mechanism       !< the mechanism
    type(resting_type), intent(inout) :: resting        !< with its stiffness; stands in the equilibrium if it was found
    logical, intent(out) :: found                       !< an equilibrium was found
    type(error_type), allocatable, intent(out) :: err   !< allocated if a load failed
    type(resting_type) :: other
    real(wp) :: step(size(resting%free)), way
    integer :: i
    logical :: moved

    found = .false.
    way = 0.0_wp
    do i = 1, most_steps
      call newton_step(resting, step)
      way = way + maxval([abs(step), 0.0_wp])
      if (way > near_by) return
      found = is_balanced(resting)
      call try_step(mechanism, resting, step, other, moved, err)
      if (allocated(err)) return
      if (.not. moved) return
      if (norm2(other%forces) > least_contraction*norm2(resting%forces)) then
        if (norm2(other%forces) < norm2(resting%forces) .and. found) call copy_resting(other, resting)
        if (found .or. norm2(other%forces) >= norm2(resting%forces)) return
      end if
      call copy_resting(other, resting)
      if (.not. norm2(resting%forces) > 0.0_wp) then
        found = .true.
        return
      end if
      call find_stiffness(mechanism, resting, err)
      if (allocated(err)) return
    end do
  end subroutine approach

  !> Newton's step; directions without stiffness are left out.
  subroutine newton_step(resting, step)
    type(resting_type), intent(in) :: resting   !< with its stiffness
    real(wp), intent(out) :: step(:)            !< (n) of the free coordinates, in their units
    real(wp) :: u(size(step), size(step)), v(size(step), size(step)), s(size(step))

    call decompose(resting%stiffness, u, s, v)
    call damped_step(resting, u, s, v, 0.0_wp, step)
  end subroutine newton_step

  !> The step that makes the forces least, with damping; directions without stiffness are left out.
  pure subroutine damped_step(resting, u, s, v, damping, step)
    type(resting_type), intent(in) :: resting   !< with its forces
    real(wp), intent(in) :: u(:, :)             !< left singular vectors of the stiffness in columns
    real(wp), intent(in) :: s(:)                !< its singular values [J]
    real(wp), intent(in) :: v(:, :)             !< right singular vectors in columns
    real(wp), intent(in) :: damping             !< added to the squares of the singular values [J^2]
    real(wp), intent(out) :: step(:)            !< (n) of the free coordinates, in their units
    integer :: i

    step = 0.0_wp
    do i = 1, size(s)
      if (.not. s(i) > zero_stiffness*resting%stiffness_magnitude) cycle
      step = step - v(:, i)*(dot_product(u(:, i), resting%forces)*s(i)/(s(i)**2 + damping))
    end do
  end subroutine damped_step

  !> Reduce the squared forces until they are zero. `found` is false where they become least without being zero.
  subroutine find_any(mechanism, resting, found, err)
    type(mechanism_type), intent(in) :: mechanism       !< the mechanism
    type(resting_type), intent(inout) :: resting        !< stands in the equilibrium if it was found
    logical, intent(out) :: found                       !< an equilibrium was found
    type(error_type), allocatable, intent(out) :: err   !< allocated if a load failed
    type(resting_type) :: other
    real(wp) :: way, radius
    integer :: i
    logical :: moved

    found = .false.
    radius = longest_step
    way = 0.0_wp
    do i = 1, most_steps
      call choose_coordinates(mechanism, resting, err)
      if (allocated(err)) return
      call find_stiffness(mechanism, resting, err)
      if (allocated(err)) return
      call copy_resting(resting, other)
      call approach(mechanism, other, found, err)
      if (allocated(err)) return
      if (found) call copy_resting(other, resting)
      if (found .or. way > farthest) return
      call reduce_forces(mechanism, resting, radius, moved, err)
      if (allocated(err) .or. .not. moved) return
      way = way + radius
    end do
  end subroutine find_any

  !> One step that reduces the squared forces. `moved` is false where no step does.
  subroutine reduce_forces(mechanism, resting, radius, moved, err)
    type(mechanism_type), intent(in) :: mechanism       !< the mechanism
    type(resting_type), intent(inout) :: resting        !< with its stiffness; stands at the end of the step afterwards
    real(wp), intent(inout) :: radius                   !< longest step that is trusted [rad, lengths of the mechanism]
    logical, intent(out) :: moved                       !< a step was made
    type(error_type), allocatable, intent(out) :: err   !< allocated if a load failed
    type(resting_type) :: other
    real(wp), dimension(size(resting%free), size(resting%free)) :: u, v
    real(wp) :: s(size(resting%free)), step(size(resting%free)), before, predicted, success
    logical :: reached

    call decompose(resting%stiffness, u, s, v)
    before = norm2(resting%forces)**2
    do
      moved = .false.
      if (radius < shortest_step) return
      call step_within(resting, u, s, v, radius, step)
      predicted = before - norm2(resting%forces + matmul(resting%stiffness, step))**2
      if (.not. predicted > 1.0e-14_wp*before) return
      call try_step(mechanism, resting, step, other, reached, err)
      if (allocated(err)) return
      success = -1.0_wp
      if (reached) success = (before - norm2(other%forces)**2)/predicted
      if (success > 0.75_wp) radius = min(longest_step, 2.0_wp*radius)
      if (success < 0.25_wp) radius = 0.25_wp*maxval(abs(step))
      moved = success > least_success
      if (moved) exit
    end do
    call copy_resting(other, resting)
  end subroutine reduce_forces

  !> The step of least squared forces within a radius: damping is raised until it fits.
  pure subroutine step_within(resting, u, s, v, radius, step)
    type(resting_type), intent(in) :: resting   !< with its forces
    real(wp), intent(in) :: u(:, :)             !< left singular vectors of the stiffness in columns
    real(wp), intent(in) :: s(:)                !< its singular values [J]
    real(wp), intent(in) :: v(:, :)             !< right singular vectors in columns
    real(wp), intent(in) :: radius              !< longest step [rad, lengths of the mechanism]
    real(wp), intent(out) :: step(:)            !< (n) of the free coordinates, in their units
    real(wp) :: damping
    integer :: i

    call damped_step(resting, u, s, v, 0.0_wp, step)
    damping = 1.0e-12_wp*s(1)**2
    do i = 1, 100
      if (maxval(abs(step)) <= radius) return
      damping = 4.0_wp*damping
      call damped_step(resting, u, s, v, damping, step)
    end do
    step = step*(radius/maxval(abs(step)))
  end subroutine step_within
end module mech9_equilibrium_search
