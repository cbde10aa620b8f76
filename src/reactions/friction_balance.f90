!> The forces of frictions that satisfy Coulomb's law with the reactions that they cause.
!>
!> Wrenches and accelerations are linear in the forces f of the frictions. A pair that slips has f = -s mu b(f), with its direction s and
!> the bearing load b. Pairs that stick form groups: the pairs of a group move together, by one freedom, and their frictions are the same
!> part of what each can hold, f = -u d mu b(f), with the utilization u and the direction d of the pair's motion with this freedom. The
!> group's coordinate has no acceleration; where the magnitude of u passes 1, the group slips. Newton's method solves these equations.
!>
!> While pairs slip, f is unique for any load as long as the determinant of the equations, divided by that without friction, is positive
!> for all directions of the terms of the bearing loads (P. Painleve, Lecons sur le frottement, 1895; F. Genot and B. Brogliato, New
!> Results on Painleve Paradoxes, Eur. J. Mech. A 18, 1999). It is linear in each of these directions, so that its least value is found
!> direction by direction.
module mech9_friction_balance
  use mech9_kinds, only: wp
  use mech9_lapack, only: dgetrf, dgetrs
  use mech9_friction, only: friction_type, bearing_terms
  implicit none
  private
  public :: friction_balance_type, friction_modes_type, new_friction_balance, new_friction_modes

  !> How each friction acts.
  type :: friction_modes_type
    integer, allocatable :: group(:)           !< (frictions) number of the group in which the pair sticks; 0: it slips, or is at rest without one
    real(wp), allocatable :: direction(:)      !< (frictions) of a pair that slips or would do so: -1, 1, 0 for none; between for a smooth law
    integer, allocatable :: leader(:)          !< (groups) number of the friction whose coordinate stands for the group's freedom
  contains
    procedure :: slips
    procedure :: leads
    procedure :: any_slips
  end type friction_modes_type

  !> The equations of the frictions in one position.
  type :: friction_balance_type
    real(wp), allocatable :: wrenches(:, :)        !< (6,n) of the pairs without frictions
    real(wp), allocatable :: by_force(:, :, :)     !< (6,n,n) wrenches by the force of each friction, which comes last
    real(wp), allocatable :: accelerations(:)      !< (n) of their coordinates without frictions [rad/s^2, m/s^2]
    real(wp), allocatable :: mobility(:, :)        !< (n,n) accelerations by the forces
    real(wp), allocatable :: force(:)              !< (n) the forces [N m, N]
    real(wp), allocatable :: utilization(:)        !< (n) of its group, for a pair that sticks
  contains
    procedure :: solve
    procedure :: least_determinant
    procedure :: acceleration
    procedure :: bearing_terms_of
    procedure :: least_factor
    procedure :: grows
    procedure :: steepest
  end type friction_balance_type

  integer, parameter :: most_iterations = 300
  integer, parameter :: most_sweeps = 20
  !> Solutions end when no force changes by more than this part of the largest; then the equations hold to round-off.
  real(wp), parameter :: solved_part = 1.0e-14_wp, accepted_part = 1.0e-10_wp

contains

  !> Room for the equations of some frictions.
  pure function new_friction_balance(n) result(self)
    integer, intent(in) :: n   !< how many there are
    type(friction_balance_type) :: self

    allocate (self%wrenches(6, n), self%by_force(6, n, n), self%accelerations(n), self%mobility(n, n), self%force(n), &
              self%utilization(n), source=0.0_wp)
  end function new_friction_balance

  !> The modes of some frictions of which none acts.
  pure function new_friction_modes(n) result(self)
    integer, intent(in) :: n   !< how many there are
    type(friction_modes_type) :: self

    allocate (self%group(n), source=0)
    allocate (self%direction(n), source=0.0_wp)
    allocate (self%leader(0))
  end function new_friction_modes

  !> Whether a pair slips.
  pure logical function slips(self, i)
    class(friction_modes_type), intent(in) :: self   !< the modes
    integer, intent(in) :: i                         !< number of the friction

    slips = self%group(i) == 0 .and. abs(self%direction(i)) > 0.0_wp
  end function slips

  !> Whether any pair slips.
  pure logical function any_slips(self)
    class(friction_modes_type), intent(in) :: self   !< the modes

    any_slips = any(self%group == 0 .and. abs(self%direction) > 0.0_wp)
  end function any_slips

  !> Whether the coordinate of a friction stands for the freedom of its group.
  pure logical function leads(self, i)
    class(friction_modes_type), intent(in) :: self   !< the modes
    integer, intent(in) :: i                         !< number of the friction

    leads = .false.
    if (self%group(i) > 0) leads = self%leader(self%group(i)) == i
  end function leads

  !> The terms of a bearing load under forces.
  pure function bearing_terms_of(self, friction, i, force) result(terms)
    class(friction_balance_type), intent(in) :: self   !< the equations
    type(friction_type), intent(in) :: friction        !< the friction
    integer, intent(in) :: i                           !< its number
    real(wp), intent(in) :: force(:)                   !< (n) of all frictions [N m, N]
    real(wp) :: terms(2, bearing_terms)

    terms = friction%terms(self%wrenches(:, i) + matmul(self%by_force(:, i, :), force))
  end function bearing_terms_of

  !> The acceleration of the coordinate of a friction under the present forces [rad/s^2, m/s^2].
  pure real(wp) function acceleration(self, i)
    class(friction_balance_type), intent(in) :: self   !< the equations
    integer, intent(in) :: i                           !< number of the friction

    acceleration = self%accelerations(i) + dot_product(self%mobility(i, :), self%force)
  end function acceleration

  !> Solve the equations from the present forces and utilizations on.
  subroutine solve(self, frictions, modes, solved)
    class(friction_balance_type), intent(inout) :: self   !< the equations; gets forces and utilizations
    type(friction_type), intent(in) :: frictions(:)       !< (n) the frictions
    type(friction_modes_type), intent(in) :: modes        !< how they act
    logical, intent(out) :: solved                        !< a solution was found
    real(wp), dimension(size(frictions) + size(modes%leader)) :: x, residual, change, sizes
    real(wp) :: matrix(size(frictions) + size(modes%leader), size(frictions) + size(modes%leader))
    real(wp) :: units(2, bearing_terms, size(frictions)), factor
    integer :: n, m, i, iteration
    logical :: regular

    n = size(frictions)
    m = size(modes%leader)
    x(:n) = self%force
    where (modes%group == 0 .and. .not. abs(modes%direction) > 0.0_wp) x(:n) = 0.0_wp
    x(n + 1:) = [(self%utilization(modes%leader(i)), i=1, m)]
    factor = 1.0_wp
    solved = .false.
    do iteration = 1, most_iterations
      call set_equations(self, frictions, modes, x, units, matrix, residual)
      change = residual
      call solve_linear(matrix, change, regular)
      if (.not. regular) exit
      x = x - factor*change
      solved = maxval(abs(change(:n))) <= solved_part*max(maxval(abs(x(:n))), tiny(factor))
      if (m > 0) solved = solved .and. maxval(abs(change(n + 1:))) <= solved_part*max(1.0_wp, maxval(abs(x(n + 1:))))
      if (solved) exit
      ! a kink of a bearing load may lead to and fro between its sides
      factor = merge(0.5_wp, 1.0_wp, iteration > most_iterations/2 .and. mod(iteration, 2) == 0)
    end do
    if (.not. solved .and. regular) then
      call set_equations(self, frictions, modes, x, units, matrix, residual)
      ! the terms of each equation: a solution that is large by a small determinant has their round-off
      sizes(:n) = abs(x(:n))
      sizes(n + 1:) = [(abs(self%accelerations(modes%leader(i))) + sum(abs(self%mobility(modes%leader(i), :)*x(:n))), i=1, m)]
      solved = all(abs(residual) <= accepted_part*sizes)
    end if
    if (.not. solved) return
    self%force = x(:n)
    self%utilization = 0.0_wp
    do i = 1, n
      if (modes%group(i) > 0) self%utilization(i) = x(n + modes%group(i))
    end do
    do i = 1, m
      associate (leader => modes%leader(i))
        ! any acceleration lets a group slip where nothing presses
        if (abs(self%utilization(leader)) > 0.0_wp) cycle
        if (abs(self%acceleration(leader)) <= accepted_part*(abs(self%accelerations(leader)) &
                                                             + sum(abs(self%mobility(leader, :)*self%force)))) cycle
        where (modes%group == i) self%utilization = sign(2.0_wp, self%acceleration(leader))
      end associate
    end do
  end subroutine solve

  !> The equations and their derivatives. Where a bearing load is known to point in other directions, these count in the derivatives.
  pure subroutine set_equations(self, frictions, modes, x, units, matrix, residual, given)
    type(friction_balance_type), intent(in) :: self         !< the equations
    type(friction_type), intent(in) :: frictions(:)         !< (n) the frictions
    type(friction_modes_type), intent(in) :: modes          !< how they act
    real(wp), intent(in) :: x(:)                            !< forces, then utilizations of groups
    real(wp), intent(inout) :: units(:, :, :)               !< (2,terms,n) directions of the terms
    real(wp), intent(out) :: matrix(:, :)                   !< derivatives of the residuals by x
    real(wp), intent(out) :: residual(:)                    !< of the equations
    logical, intent(in), optional :: given                  !< `units` are given; not unless present
    real(wp) :: terms(2, bearing_terms), weights(bearing_terms), coefficient, length
    integer :: n, i, j, t, g
    logical :: keeps

    n = size(frictions)
    keeps = present(given)
    matrix = 0.0_wp
    do i = 1, n
      g = modes%group(i)
      matrix(i, i) = 1.0_wp
      residual(i) = x(i)
      if (g == 0 .and. .not. abs(modes%direction(i)) > 0.0_wp) cycle
      coefficient = coefficient_of(frictions(i), modes, i, x)
      terms = self%bearing_terms_of(frictions(i), i, x(:n))
      weights = frictions(i)%weights()
      residual(i) = residual(i) + coefficient*frictions(i)%bearing_load(terms)
      if (g > 0) matrix(i, n + g) = modes%direction(i)*frictions(i)%static*frictions(i)%bearing_load(terms)
      do t = 1, bearing_terms
        if (.not. (keeps .and. g == 0)) then
          length = norm2(terms(:, t))
          units(:, t, i) = 0.0_wp
          if (length > 0.0_wp) units(:, t, i) = terms(:, t)/length
        end if
      end do
      do j = 1, n
        terms = frictions(i)%terms(self%by_force(:, i, j))
        do t = 1, bearing_terms
          matrix(i, j) = matrix(i, j) + coefficient*weights(t)*dot_product(units(:, t, i), terms(:, t))
        end do
      end do
    end do
    do g = 1, size(modes%leader)
      matrix(n + g, :n) = self%mobility(modes%leader(g), :)
      residual(n + g) = self%accelerations(modes%leader(g)) + dot_product(self%mobility(modes%leader(g), :), x(:n))
      ! nothing presses: the group holds nothing
      if (sum(abs(matrix(:n, n + g))) > 0.0_wp) cycle
      matrix(n + g, :) = 0.0_wp
      matrix(n + g, n + g) = 1.0_wp
      residual(n + g) = x(n + g)
    end do
  end subroutine set_equations

  !> By what the bearing load of a friction is multiplied, minus its force.
  pure real(wp) function coefficient_of(friction, modes, i, x) result(coefficient)
    type(friction_type), intent(in) :: friction         !< the friction
    type(friction_modes_type), intent(in) :: modes      !< how frictions act
    integer, intent(in) :: i                            !< its number
    real(wp), intent(in) :: x(:)                        !< forces, then utilizations of groups

    coefficient = modes%direction(i)*friction%dynamic
    if (modes%group(i) > 0) coefficient = x(size(modes%group) + modes%group(i))*modes%direction(i)*friction%static
  end function coefficient_of

  !> The least determinant for all directions of the terms of pairs that slip, divided by that of the equations without them.
  real(wp) function least_determinant(self, frictions, modes, scale) result(least)
    class(friction_balance_type), intent(in) :: self      !< the equations, solved
    type(friction_type), intent(in) :: frictions(:)       !< (n) the frictions
    type(friction_modes_type), intent(in) :: modes        !< how they act
    real(wp), intent(in), optional :: scale               !< by which all coefficients are multiplied; 1 unless given
    real(wp), dimension(size(frictions) + size(modes%leader)) :: x, residual
    real(wp), dimension(size(x), size(x)) :: matrix, without
    real(wp) :: units(2, bearing_terms, size(frictions)), reference, factor, previous
    type(friction_type) :: scaled(size(frictions))
    integer :: n, i, t, sweep
    integer, allocatable :: slipping(:)

    n = size(frictions)
    least = 1.0_wp
    if (.not. modes%any_slips()) return
    scaled = frictions
    if (present(scale)) scaled%dynamic = scale*scaled%dynamic
    slipping = pack([(i, i=1, n)], modes%group == 0 .and. abs(modes%direction) > 0.0_wp)
    x(:n) = self%force
    x(n + 1:) = [(self%utilization(modes%leader(i)), i=1, size(modes%leader))]
    units = 0.0_wp
    call set_equations(self, scaled, modes, x, units, matrix, residual)
    without = matrix
    do i = 1, size(slipping)
      without(slipping(i), :) = 0.0_wp
      without(slipping(i), slipping(i)) = 1.0_wp
    end do
    reference = determinant_of(without)
    if (.not. abs(reference) > 0.0_wp) return
    least = determinant_of(matrix)/reference
    do sweep = 1, most_sweeps
      previous = least
      do i = 1, size(slipping)
        do t = 1, bearing_terms
          call turn_term(slipping(i), t)
        end do
      end do
      if (least >= previous - accepted_part*max(1.0_wp, abs(previous))) exit
    end do
  contains
    !> Turn one term into the direction in which the determinant is least.
    subroutine turn_term(i, t)
      integer, intent(in) :: i   !< number of the friction
      integer, intent(in) :: t   !< number of the term
      real(wp) :: slope(2)
      integer :: k

      do k = 1, 2
        units(:, t, i) = 0.0_wp
        call set_equations(self, scaled, modes, x, units, matrix, residual, given=.true.)
        factor = determinant_of(matrix)
        units(k, t, i) = 1.0_wp
        call set_equations(self, scaled, modes, x, units, matrix, residual, given=.true.)
        slope(k) = (determinant_of(matrix) - factor)/reference
      end do
      units(:, t, i) = 0.0_wp
      if (norm2(slope) > 0.0_wp) units(:, t, i) = -slope/norm2(slope)
      least = factor/reference - norm2(slope)
    end subroutine turn_term
  end function least_determinant

  !> The least factor of all coefficients at which the determinant vanishes, where it is negative at the factor 1.
  real(wp) function least_factor(self, frictions, modes) result(factor)
    class(friction_balance_type), intent(in) :: self      !< the equations, solved
    type(friction_type), intent(in) :: frictions(:)       !< (n) the frictions
    type(friction_modes_type), intent(in) :: modes        !< how they act
    real(wp) :: low, high
    integer :: i

    low = 0.0_wp
    high = 1.0_wp
    do i = 1, digits(low)
      factor = 0.5_wp*(low + high)
      if (self%least_determinant(frictions, modes, factor) > 0.0_wp) then
        low = factor
      else
        high = factor
      end if
    end do
  end function least_factor

  !> Whether the bearing load of a friction grows with its force: then no force satisfies the equations behind the paradox.
  pure logical function grows(self, frictions, modes, i)
    class(friction_balance_type), intent(in) :: self      !< the equations, solved
    type(friction_type), intent(in) :: frictions(:)       !< (n) the frictions
    type(friction_modes_type), intent(in) :: modes        !< how they act
    integer, intent(in) :: i                              !< number of the friction
    real(wp) :: terms(2, bearing_terms), slopes(2, bearing_terms), weights(bearing_terms), slope
    integer :: t

    terms = self%bearing_terms_of(frictions(i), i, self%force)
    slopes = frictions(i)%terms(self%by_force(:, i, i))
    weights = frictions(i)%weights()
    slope = 0.0_wp
    do t = 1, bearing_terms
      if (norm2(terms(:, t)) > 0.0_wp) slope = slope + weights(t)*dot_product(terms(:, t), slopes(:, t))/norm2(terms(:, t))
    end do
    grows = -modes%direction(i)*slope > 0.0_wp
  end function grows

  !> The friction that slips and grows most with its own force.
  pure integer function steepest(self, frictions, modes) result(worst)
    class(friction_balance_type), intent(in) :: self      !< the equations
    type(friction_type), intent(in) :: frictions(:)       !< (n) the frictions
    type(friction_modes_type), intent(in) :: modes        !< how they act; one slips at least
    real(wp) :: slope, most
    integer :: i

    worst = 0
    most = -1.0_wp
    do i = 1, size(frictions)
      if (.not. modes%slips(i)) cycle
      slope = frictions(i)%dynamic*dot_product(frictions(i)%weights(), norm2(frictions(i)%terms(self%by_force(:, i, i)), 1))
      if (slope <= most) cycle
      most = slope
      worst = i
    end do
  end function steepest

  !> The determinant of a matrix.
  real(wp) function determinant_of(matrix) result(determinant)
    real(wp), intent(in) :: matrix(:, :)   !< the matrix
    real(wp) :: factors(size(matrix, 1), size(matrix, 1))
    integer :: pivots(size(matrix, 1)), info, i

    factors = matrix
    call dgetrf(size(pivots), size(pivots), factors, size(pivots), pivots, info)
    determinant = product([(merge(factors(i, i), -factors(i, i), pivots(i) == i), i=1, size(pivots))])
  end function determinant_of

  !> Solve linear equations.
  subroutine solve_linear(matrix, values, regular)
    real(wp), intent(inout), contiguous :: matrix(:, :)   !< the matrix; then its factors
    real(wp), intent(inout), contiguous :: values(:)      !< the right side; then the solution
    logical, intent(out) :: regular                       !< there is a solution
    integer :: pivots(size(values)), info

    call dgetrf(size(values), size(values), matrix, size(values), pivots, info)
    regular = info == 0
    if (regular) call dgetrs('N', size(values), 1, matrix, size(values), pivots, values, size(values), info)
  end subroutine solve_linear
end module mech9_friction_balance
