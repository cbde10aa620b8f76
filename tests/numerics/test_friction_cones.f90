!> Contacts with friction: Coulomb's laws decide whether a solution is one.
module test_friction_cones
  use mech9_kinds, only: wp
  use mech9_random, only: random_type
  use mech9_random_geometry, only: random_matrix
  use mech9_friction_cones, only: friction_cones_type, new_friction_cones, opens, slides, sticks, one_solution, no_solution, &
    several_solutions
  use mech9_testing, only: tester_type
  implicit none
  private
  public :: run

contains

  !> Run the cases of this suite.
  subroutine run(test)
    type(tester_type), intent(inout) :: test   !< selects cases and counts their checks

    if (test%runs('random_contacts')) call random_contacts(test)
    if (test%runs('one_contact')) call one_contact(test)
    if (test%runs('paradox')) call paradox(test)
  end subroutine run

  !> One to three contacts in as many dimensions as they have directions. With W near the unit matrix, as of round bodies, there is one
  !> solution.
  subroutine random_contacts(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(friction_cones_type) :: cones
    type(random_type) :: random
    real(wp), allocatable :: a(:, :), v(:)
    real(wp) :: passed, pulled, beyond, across, kept
    integer :: n, trial, i, found, n_solved, n_trials, modes(opens:sticks)

    passed = 0.0_wp
    pulled = 0.0_wp
    beyond = 0.0_wp
    across = 0.0_wp
    kept = 0.0_wp
    n_solved = 0
    n_trials = 0
    modes = 0
    do n = 1, 3
      do trial = 1, 100
        a = 0.2_wp*random_matrix(random, 3*n, 3*n)
        do i = 1, 3*n
          a(i, i) = a(i, i) + 1.0_wp
        end do
        cones = new_friction_cones(n)
        cones%w = matmul(a, transpose(a))
        do i = 1, n
          cones%sliding(i) = 0.3_wp + 0.3_wp*random%symmetric()
        end do
        cones%static = cones%sliding
        cones%round_off = 1.0e-13_wp
        do i = 1, 3*n
          cones%b(i) = random%symmetric()
        end do
        ! so that all modes occur
        cones%b = 0.4_wp*cones%b
        cones%b(1::3) = 2.0_wp*cones%b(1::3) - 0.5_wp
        call cones%solve(found)
        n_trials = n_trials + 1
        if (found /= one_solution) cycle
        n_solved = n_solved + 1
        v = cones%outcome()
        do i = 1, n
          associate (f => cones%force(3*i - 2:3*i), rate => v(3*i - 2:3*i), mu => cones%sliding(i))
            modes(cones%mode(i)) = modes(cones%mode(i)) + 1
            passed = max(passed, -rate(1))
            pulled = max(pulled, -f(1))
            kept = max(kept, abs(f(1)*rate(1)))
            beyond = max(beyond, norm2(f(2:3)) - mu*f(1))
            ! the friction is against the slip, and as large as it can be
            if (f(1) > 0.0_wp) across = max(across, maxval(abs(norm2(rate(2:3))*f(2:3) + mu*f(1)*rate(2:3))))
          end associate
        end do
      end do
    end do
    call test%is_true(n_solved == n_trials, 'all are solved')
    call test%is_true(minval(modes) > 50, 'all modes occur')
    ! solutions are as exact as the iteration of directions, 1e-13
    call test%near(passed, 0.0_wp, 1.0e-11_wp, 'no contact is passed')
    call test%near(pulled, 0.0_wp, 1.0e-11_wp, 'no force pulls')
    call test%near(kept, 0.0_wp, 1.0e-11_wp, 'a contact pushes or opens')
    call test%near(beyond, 0.0_wp, 1.0e-9_wp, 'forces lie in their cones, but for round-off of forces')
    call test%near(across, 0.0_wp, 1.0e-9_wp, 'friction is against the slip')
  end subroutine random_contacts

  !> A contact whose inertia differs along its tangents, just beyond the bound of sticking.
  subroutine one_contact(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(friction_cones_type) :: cones
    real(wp) :: v(3), needed
    integer :: found

    cones = new_friction_cones(1)
    cones%w(1, 1) = 1.0_wp
    cones%w(2, 2) = 1.0_wp
    cones%w(3, 3) = 5.0_wp
    cones%b = [-10.0_wp, -0.5_wp, -1.0_wp]
    needed = hypot(0.5_wp, 0.2_wp)/10.0_wp
    cones%sliding = needed*(1.0_wp + 1.0e-6_wp)
    cones%static = cones%sliding
    call cones%solve(found)
    call test%is_true(found == one_solution .and. cones%mode(1) == sticks, 'it sticks below its bound')
    cones%sliding = needed*(1.0_wp - 1.0e-6_wp)
    cones%static = cones%sliding
    call cones%solve(found)
    call test%is_true(found == one_solution .and. cones%mode(1) == slides, 'it slides beyond its bound')
    v = cones%outcome()
    call test%near(maxval(abs(norm2(v(2:3))*cones%force(2:3) + cones%sliding(1)*10.0_wp*v(2:3))), 0.0_wp, 1.0e-15_wp, &
                   'friction is against the slip')
  end subroutine one_contact

  !> A contact that slides and is drawn together by its friction: two solutions where it would open, none where it would close.
  subroutine paradox(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(friction_cones_type) :: cones
    integer :: found

    cones = new_friction_cones(1)
    cones%w(:2, 1) = [1.0_wp, 0.8_wp]
    cones%w(:2, 2) = [0.8_wp, 1.0_wp]
    cones%moves = .true.
    cones%direction(:, 1) = [1.0_wp, 0.0_wp]
    cones%sliding = 1.3_wp
    cones%static = cones%sliding
    cones%b = [1.0_wp, 0.0_wp, 0.0_wp]
    call cones%solve(found)
    call test%is_true(found == several_solutions, 'it may open or press')
    cones%b = [-1.0_wp, 0.0_wp, 0.0_wp]
    call cones%solve(found)
    call test%is_true(found == no_solution, 'it may do neither')
    cones%sliding = 1.2_wp
    cones%static = cones%sliding
    call cones%solve(found)
    call test%is_true(found == one_solution .and. cones%mode(1) == slides, 'less friction has one solution')
    call test%near(cones%force(1), 1.0_wp/(1.0_wp - 1.2_wp*0.8_wp), 1.0e-11_wp, 'its force')
  end subroutine paradox
end module test_friction_cones
