!> Contacts with Coulomb's friction: the forces, and which contacts open, slide and stick.
!>
!> The outcome v = b + W f is a rate or an acceleration: along the normal of each contact, then along two tangents. Along the normal,
!> v >= 0 and f >= 0, and one of both is zero. The tangential force is at most the coefficient times the normal one. Where the tangential
!> outcome is not zero, the force is the coefficient in motion times the normal one, and against it; a contact that moves already has a
!> given direction. These are the laws of C. Glocker, Set-Valued Force Laws, Springer 2001. The solution need not exist, and need not be
!> unique: F. Genot and B. Brogliato, New Results on Painleve Paradoxes, Eur. J. Mech. A 18 (1999).
!>
!> Modes are guessed and the worst one is exchanged, from all contacts that stick on. Where that does not lead to a solution, or where
!> friction can draw a contact together that slides, all modes are tried. The direction of a contact that begins to slide is iterated.
module mech9_friction_cones
  use mech9_kinds, only: wp
  use mech9_singular_values, only: decompose
  implicit none
  private
  public :: friction_cones_type, new_friction_cones, solve_least
  public :: opens, slides, sticks, one_solution, no_solution, several_solutions

  !> Modes of a contact.
  integer, parameter :: opens = 0, slides = 1, sticks = 2
  !> Outcomes of a solution.
  integer, parameter :: one_solution = 1, no_solution = 2, several_solutions = 3

  !> The equations of n contacts, and their solution.
  type :: friction_cones_type
    integer :: n = 0
    real(wp), allocatable :: w(:, :)           !< (3n,3n) W, symmetric: normal, first and second tangent of each contact
    real(wp), allocatable :: b(:)              !< (3n) the outcome without forces
    real(wp), allocatable :: sliding(:)        !< (n) coefficients of friction in motion
    real(wp), allocatable :: static(:)         !< (n) coefficients of friction at rest
    real(wp), allocatable :: given(:)          !< (n) normal forces that are known; negative: to be found
    logical, allocatable :: moves(:)           !< (n) the contact slides already
    logical, allocatable :: must_slide(:)      !< (n) the contact is at rest and does not stick
    real(wp), allocatable :: direction(:, :)   !< (2,n) in which it slides, along the tangents; found for those that begin to slide
    real(wp), allocatable :: round_off(:)      !< (n) of the normal outcome
    real(wp), allocatable :: force(:)          !< (3n) the solution
    integer, allocatable :: mode(:)            !< (n) the mode of each contact in it
  contains
    procedure :: solve
    procedure :: outcome
    procedure, private :: try_modes
    procedure, private :: is_certain
  end type friction_cones_type

  !> Singular values below this part of the largest mean that contacts depend on each other: a hundred times the round-off of W.
  real(wp), parameter :: dependent_part = 1.0e-11_wp
  !> Equations of dependent contacts contradict each other where this part of their terms is left.
  real(wp), parameter :: contradiction = 1.0e-8_wp
  !> Forces may leave their cones by this part of all forces: round-off of the solution.
  real(wp), parameter :: round_off_of_forces = 1.0e-10_wp
  !> Directions are found where they change by less than this, in at most so many iterations.
  real(wp), parameter :: same_direction = 1.0e-13_wp
  integer, parameter :: most_iterations = 60
  !> Choices of modes that are tried at most: four contacts at rest have 256.
  integer, parameter :: most_choices = 1024

contains

  !> Equations of n contacts without friction, with W and b zero.
  pure function new_friction_cones(n) result(self)
    integer, intent(in) :: n   !< how many contacts there are
    type(friction_cones_type) :: self

    self%n = n
    allocate (self%w(3*n, 3*n), self%b(3*n), self%force(3*n), self%direction(2, n), self%round_off(n), source=0.0_wp)
    allocate (self%sliding(n), self%static(n), source=0.0_wp)
    allocate (self%given(n), source=-1.0_wp)
    allocate (self%moves(n), self%must_slide(n), source=.false.)
    allocate (self%mode(n), source=opens)
  end function new_friction_cones

  !> The outcome under the forces of the solution.
  pure function outcome(self) result(v)
    class(friction_cones_type), intent(in) :: self   !< the contacts, solved
    real(wp) :: v(3*self%n)

    v = self%b + matmul(self%w, self%force)
  end function outcome

  !> Find forces and modes. Of several solutions that differ in what opens, none is chosen.
  subroutine solve(self, found)
    class(friction_cones_type), intent(inout) :: self   !< the contacts; get forces, modes and directions
    integer, intent(out) :: found                       !< one of the constants one_solution, no_solution, several_solutions
    logical :: agrees

    found = one_solution
    if (self%n == 0) return
    call exchange_worst(self, agrees)
    if (agrees .and. self%is_certain()) return
    call try_all(self, agrees, found)
  end subroutine solve

  !> Whether friction cannot draw any contact together that slides already: the force that closes it alone is then unique.
  pure logical function is_certain(self)
    class(friction_cones_type), intent(in) :: self   !< the contacts
    integer :: i

    is_certain = .true.
    do i = 1, self%n
      if (self%given(i) >= 0.0_wp .or. .not. self%moves(i)) cycle
      associate (row => self%w(3*i - 2, 3*i - 2:3*i))
        is_certain = is_certain .and. self%sliding(i)*dot_product(row(2:3), self%direction(:, i)) < &
                                      row(1)*(1.0_wp - round_off_of_forces)
      end associate
    end do
  end function is_certain

  !> Begin with all contacts closed and at rest, and exchange the mode that is violated most, until none is.
  subroutine exchange_worst(self, agrees)
    class(friction_cones_type), intent(inout) :: self   !< the contacts
    logical, intent(out) :: agrees                      !< a solution was found
    integer :: round, worst, wanted

    self%mode = sticks
    where (self%moves .or. self%must_slide .or. .not. self%static > 0.0_wp) self%mode = slides
    do round = 1, 8*self%n + 8
      call self%try_modes(worst, wanted)
      agrees = worst == 0
      if (agrees .or. wanted < 0) return
      self%mode(worst) = wanted
    end do
  end subroutine exchange_worst

  !> Try all modes. The solution in which most contacts stick is kept.
  subroutine try_all(self, agrees, found)
    class(friction_cones_type), intent(inout) :: self   !< the contacts
    logical, intent(out) :: agrees                      !< a solution was found
    integer, intent(out) :: found                       !< one of the constants of outcomes
    integer :: choices(self%n), choice, rest, i, worst, wanted, count_sticks, best_mode(self%n)
    real(wp) :: best_force(3*self%n), best_direction(2, self%n), given_direction(2, self%n), v(3*self%n), best_v(3*self%n), scale

    agrees = .false.
    found = no_solution
    choices = 3
    where (self%moves .or. self%must_slide .or. .not. self%static > 0.0_wp) choices = 2
    if (product(real(choices)) > real(most_choices)) then
      call exchange_worst(self, agrees)
      if (agrees) found = one_solution
      return
    end if
    given_direction = self%direction
    count_sticks = -1
    do choice = 0, product(choices) - 1
      rest = choice
      do i = 1, self%n
        self%mode(i) = mod(rest, choices(i))
        rest = rest/choices(i)
      end do
      if (any(self%mode == opens .and. self%given >= 0.0_wp)) cycle
      self%direction = given_direction
      call self%try_modes(worst, wanted)
      if (worst > 0) cycle
      v = self%outcome()
      if (agrees) then
        scale = sum(abs(self%b)) + maxval(abs(v)) + tiny(scale)
        if (any((self%mode == opens) .neqv. (best_mode == opens)) .and. maxval(abs(v - best_v)) > contradiction*scale) &
          found = several_solutions
      end if
      if (count(self%mode == sticks) <= count_sticks) cycle
      count_sticks = count(self%mode == sticks)
      best_mode = self%mode
      best_force = self%force
      best_direction = self%direction
      best_v = v
      if (.not. agrees) found = one_solution
      agrees = .true.
    end do
    if (.not. agrees) return
    self%mode = best_mode
    self%force = best_force
    self%direction = best_direction
  end subroutine try_all

  !> Find the forces for the present modes, and which contact contradicts its mode most.
  subroutine try_modes(self, worst, wanted)
    class(friction_cones_type), intent(inout) :: self   !< the contacts, with modes; get forces and directions
    integer, intent(out) :: worst                       !< number of the contact; 0: all agree
    integer, intent(out) :: wanted                      !< the mode that it should have; negative: there are no such forces
    real(wp) :: v(3*self%n), size_of_force, most, excess, tangential, change, turned
    integer :: i, iteration
    logical :: solved, opposed(self%n)

    worst = 0
    wanted = -1
    call find_directions(self)
    opposed = .false.
    do iteration = 1, most_iterations
      change = 0.0_wp
      do i = 1, self%n
        call find_forces(self, solved)
        if (.not. solved) then
          worst = 1
          return
        end if
        if (.not. begins_to_slide(self, i)) cycle
        call turn_direction(self, i, turned)
        change = max(change, turned)
      end do
      if (change > same_direction) cycle
      ! a contact that is drawn back may slide the other way
      v = self%outcome()
      do i = 1, self%n
        if (opposed(i) .or. .not. begins_to_slide(self, i)) cycle
        if (dot_product(v(3*i - 1:3*i), self%direction(:, i)) >= -round_off_of_forces*(sum(abs(self%b)) + maxval(abs(v)))) cycle
        opposed(i) = .true.
        self%direction(:, i) = -self%direction(:, i)
        change = 1.0_wp
      end do
      if (change <= same_direction) exit
    end do
    ! directions that were not found give no solution
    if (change > contradiction) then
      worst = 1
      return
    end if
    v = self%outcome()
    size_of_force = maxval(abs(self%force)) + tiny(size_of_force)
    most = 0.0_wp
    do i = 1, self%n
      associate (normal => self%force(3*i - 2), along => self%force(3*i - 1:3*i), rate => v(3*i - 2), turn => v(3*i - 1:3*i))
        select case (self%mode(i))
        case (opens)
          excess = -rate - self%round_off(i)
          ! in units of force
          if (excess > 0.0_wp) call take(excess/max(self%w(3*i - 2, 3*i - 2), tiny(excess)), &
                                         merge(sticks, slides, self%static(i) > 0.0_wp .and. .not. &
                                                              (self%moves(i) .or. self%must_slide(i))))
        case default
          excess = -normal - round_off_of_forces*size_of_force
          if (excess > 0.0_wp .and. self%given(i) < 0.0_wp) then
            call take(excess, opens)
            cycle
          end if
          if (self%mode(i) == sticks) then
            tangential = norm2(along)
            excess = tangential - self%static(i)*normal - round_off_of_forces*size_of_force
            if (excess > 0.0_wp) call take(excess, slides)
          else if (.not. self%moves(i) .and. self%sliding(i) > 0.0_wp) then
            excess = -dot_product(turn, self%direction(:, i)) - round_off_of_forces*(sum(abs(self%b)) + maxval(abs(v)))
            if (excess > 0.0_wp) then
              call take(excess/max(self%w(3*i - 1, 3*i - 1) + self%w(3*i, 3*i), tiny(excess)), &
                        merge(-1, sticks, self%must_slide(i)))
            end if
          end if
        end select
      end associate
    end do
  contains
    !> Keep the contact that contradicts its mode most.
    subroutine take(amount, other_mode)
      real(wp), intent(in) :: amount       !< how much it does, in units of force
      integer, intent(in) :: other_mode    !< the mode that it should have

      if (amount <= most) return
      most = amount
      worst = i
      wanted = other_mode
    end subroutine take
  end subroutine try_modes

  !> Whether a contact begins to slide in its mode, in a direction that is to be found.
  pure logical function begins_to_slide(self, i)
    class(friction_cones_type), intent(in) :: self   !< the contacts, with modes
    integer, intent(in) :: i                         !< number of the contact

    begins_to_slide = self%mode(i) == slides .and. .not. self%moves(i) .and. self%sliding(i) > 0.0_wp
  end function begins_to_slide

  !> Turn the direction of a contact that begins to slide, with the normal forces and the friction of others as they are. With the size F of
  !> its friction and the tangential outcome c without it, the direction d has (F W_tt + beta) d = c with beta >= 0 and the length 1; beta
  !> is the size of the outcome. Without such a beta the contact would not slide: the direction is then that of beta = 0.
  pure subroutine turn_direction(self, i, turned)
    class(friction_cones_type), intent(inout) :: self   !< the contacts, with their forces; gets the direction
    integer, intent(in) :: i                            !< number of the contact
    real(wp), intent(out) :: turned                     !< by how much it changed
    real(wp) :: m(2, 2), c(2), d(2), of_force, beta, slope, length, spread_of_m, mean, axes(2, 2), values(2), parts(2), angle
    integer :: iteration

    turned = 0.0_wp
    of_force = self%sliding(i)*self%force(3*i - 2)
    if (.not. of_force > 0.0_wp) return
    m = of_force*self%w(3*i - 1:3*i, 3*i - 1:3*i)
    c = self%b(3*i - 1:3*i) + matmul(self%w(3*i - 1:3*i, :), self%force) + matmul(m, self%direction(:, i))
    if (.not. norm2(c) > 0.0_wp) return
    ! principal axes of the matrix
    mean = 0.5_wp*(m(1, 1) + m(2, 2))
    spread_of_m = hypot(0.5_wp*(m(1, 1) - m(2, 2)), m(1, 2))
    angle = 0.0_wp
    if (spread_of_m > 0.0_wp) angle = 0.5_wp*atan2(m(1, 2), 0.5_wp*(m(1, 1) - m(2, 2)))
    axes = reshape([cos(angle), sin(angle), -sin(angle), cos(angle)], [2, 2])
    values = max([mean + spread_of_m, mean - spread_of_m], 0.0_wp)
    parts = matmul(c, axes)
    ! one over the length grows nearly evenly with beta, from below
    beta = 0.0_wp
    do iteration = 1, most_iterations
      d = 0.0_wp
      where (values + beta > 0.0_wp) d = parts/(values + beta)
      length = norm2(d)
      if (.not. length > 1.0_wp) exit
      slope = sum(d**2/(values + beta), mask=values + beta > 0.0_wp)/length**3
      if (.not. slope > 0.0_wp) exit
      if ((1.0_wp - 1.0_wp/length)/slope <= same_direction*beta) exit
      beta = beta + (1.0_wp - 1.0_wp/length)/slope
    end do
    if (.not. length > 0.0_wp) return
    d = matmul(axes, d/length)
    turned = maxval(abs(d - self%direction(:, i)))
    self%direction(:, i) = d
  end subroutine turn_direction

  !> Find directions for the contacts that begin to slide: against the forces that would keep them at rest, if the others act as now.
  subroutine find_directions(self)
    class(friction_cones_type), intent(inout) :: self   !< the contacts, with modes; get directions
    integer :: modes(self%n), i
    real(wp) :: along(2)
    logical :: solved

    modes = self%mode
    if (.not. any(begins())) return
    where (begins()) self%mode = sticks
    call find_forces(self, solved)
    self%mode = modes
    do i = 1, self%n
      if (modes(i) /= slides .or. self%moves(i) .or. .not. self%sliding(i) > 0.0_wp) cycle
      along = -self%force(3*i - 1:3*i)
      if (.not. (solved .and. norm2(along) > 0.0_wp)) along = self%b(3*i - 1:3*i)
      if (norm2(along) > 0.0_wp) self%direction(:, i) = along/norm2(along)
    end do
  contains
    !> Whether each contact begins to slide.
    function begins() result(yes)
      logical :: yes(self%n)

      yes = modes == slides .and. .not. self%moves .and. self%sliding > 0.0_wp
    end function begins
  end subroutine find_directions

  !> Find the forces of all contacts for their modes and directions. Where contacts depend on each other, forces have the least size, and
  !> those that stick share their friction in parts of what each can hold.
  subroutine find_forces(self, solved)
    class(friction_cones_type), intent(inout) :: self   !< the contacts; get forces
    logical, intent(out) :: solved                      !< there are such forces
    integer :: row(3*self%n), m, i, k
    real(wp) :: columns(3*self%n, 3*self%n), right(3*self%n)
    real(wp), allocatable :: a(:, :), x(:), left(:), scale(:)
    logical :: depends

    m = 0
    columns = 0.0_wp
    self%force = 0.0_wp
    do i = 1, self%n
      if (self%mode(i) == opens) cycle
      if (self%given(i) < 0.0_wp) then
        call add(3*i - 2)
        call slide(columns(:, m), 1.0_wp)
      else
        call slide(self%force, self%given(i))
      end if
      if (self%mode(i) /= sticks) cycle
      do k = 3*i - 1, 3*i
        call add(k)
        columns(k, m) = 1.0_wp
      end do
    end do
    solved = .true.
    if (m == 0) return
    right = -self%b - matmul(self%w, self%force)
    allocate (a(m, m), x(m), left(m), scale(m))
    a = matmul(self%w(row(:m), :), columns(:, :m))
    scale = 1.0_wp
    call solve_least(a, right(row(:m)), scale, x, depends)
    if (depends .and. any(self%mode == sticks)) then
      do i = 1, m
        k = (row(i) + 2)/3
        scale(i) = maxval(abs(x))
        if (row(i) /= 3*k - 2) scale(i) = self%static(k)*max(normal_of(k), round_off_of_forces*maxval(abs(x)))
      end do
      call solve_least(a, right(row(:m)), scale, x, depends)
    end if
    left = matmul(a, x) - right(row(:m))
    solved = maxval(abs(left)) <= contradiction*(maxval(abs(right)) + sum(abs(self%b)))
    self%force = self%force + matmul(columns(:, :m), x)
  contains
    !> The normal force of a contact.
    pure real(wp) function normal_of(k) result(normal)
      integer, intent(in) :: k   !< its number

      normal = self%given(k)
      if (normal < 0.0_wp) normal = dot_product(columns(3*k - 2, :m), x)
    end function normal_of

    !> Add an unknown force, and the equation of the same row.
    subroutine add(k)
      integer, intent(in) :: k   !< number of the row

      m = m + 1
      row(m) = k
    end subroutine add

    !> Add a normal force of a contact, with the friction of one that slides.
    subroutine slide(force, normal)
      real(wp), intent(inout) :: force(:)   !< (3n) all forces
      real(wp), intent(in) :: normal        !< the normal force

      force(3*i - 2) = normal
      if (self%mode(i) == slides) force(3*i - 1:3*i) = -self%sliding(i)*normal*self%direction(:, i)
    end subroutine slide
  end subroutine find_forces

  !> Find the solution of equations that may depend on each other, of least size in given scales.
  subroutine solve_least(a, right, scale, x, depends)
    real(wp), intent(in) :: a(:, :)        !< (m,m) the matrix
    real(wp), intent(in) :: right(:)       !< (m) right side
    real(wp), intent(in) :: scale(:)       !< (m) in which the unknowns count
    real(wp), intent(out) :: x(:)          !< (m) the solution
    logical, intent(out) :: depends        !< there are several solutions
    real(wp), dimension(size(x), size(x)) :: scaled, u, v
    real(wp) :: s(size(x))

    depends = .false.
    if (size(x) == 0) return
    scaled = a*spread(scale, 1, size(x))
    call decompose(scaled, u, s, v)
    x = matmul(right, u)
    depends = any(s <= dependent_part*s(1))
    where (s > dependent_part*s(1))
      x = x/s
    elsewhere
      x = 0.0_wp
    end where
    x = scale*matmul(v, x)
  end subroutine solve_least
end module mech9_friction_cones
