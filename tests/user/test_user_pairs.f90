!> Pairs by user procedures: both forms against each other, against a built-in pair, against differences.
!>
!> The promise to users: positions to 1e-12, first derivatives to 1e-11, second to 1e-10. Stencils of
!> sixteenth order reach it: round-off by 8/h^2 is 2e-12 at the second step, h = 1/32, and 3e-11 at the third.
module test_user_pairs
  use mech9_kinds, only: wp, pi
  use mech9_error, only: error_type, place_type, exit_data
  use mech9_random, only: random_type
  use mech9_differentiation, only: stencil_size
  use mech9_rotation, only: identity
  use mech9_pose, only: pose_type
  use mech9_pair, only: pair_motion_type, screw_factors_type
  use mech9_screw_pair, only: screw_pair_type, helical_pair
  use mech9_registered_procedures, only: registered_procedure_type
  use mech9_procedure_pair, only: procedure_pair_type, make_procedure_pair
  use mech9_random_geometry, only: random_pose
  use mech9_motion_check, only: check_derivatives, check_same_motion
  use mech9_testing, only: tester_type
  implicit none
  private
  public :: run

  real(wp), parameter :: promised(3) = [1.0e-12_wp, 1.0e-11_wp, 1.0e-10_wp]
  real(wp), parameter :: exact(3) = 2.0e-14_wp

contains

  !> Run the cases of this suite.
  subroutine run(test)
    type(tester_type), intent(inout) :: test   !< selects cases and counts their checks

    if (test%runs('as_built_in')) call as_built_in(test)
    if (test%runs('forms_agree')) call forms_agree(test)
    if (test%runs('end_of_domain')) call end_of_domain(test)
    if (test%runs('close_to_a_line')) call close_to_a_line(test)
    if (test%runs('refused')) call refused(test)
    if (test%runs('what_they_say')) call what_they_say(test)
  end subroutine run

  !> A pair in Taylor arithmetic, and the same by plain values.
  subroutine make_both(test, coordinate, parameters, exact_pair, plain_pair)
    type(tester_type), intent(inout) :: test               !< counts the checks
    integer, intent(in) :: coordinate                      !< selects the pair
    real(wp), intent(in) :: parameters(:)                  !< of the pair
    type(procedure_pair_type), intent(out) :: exact_pair   !< in Taylor arithmetic
    type(procedure_pair_type), intent(out) :: plain_pair   !< by plain values
    type(error_type), allocatable :: err

    call make_procedure_pair(coordinate, parameters, registered_procedure_type(), exact_pair, err)
    call test%no_error(err, 'a pair whose procedure is linked is accepted')
    call test%is_true(.not. exact_pair%plain_values, 'where both forms are linked Taylor arithmetic is taken')
    plain_pair = exact_pair
    plain_pair%plain_values = .true.
  end subroutine make_both

  !> A user's procedure for a screw does what the built-in helical pair does.
  subroutine as_built_in(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(random_type) :: random
    type(procedure_pair_type) :: exact_pair, plain_pair
    type(screw_pair_type) :: built_in
    type(pair_motion_type) :: motion, expected
    type(pose_type) :: frame, home
    type(error_type), allocatable :: err
    real(wp) :: q, advance
    integer :: i

    do i = 1, 20
      frame = random_pose(random)
      advance = random%symmetric()
      q = 3.0_wp*random%symmetric()
      built_in = helical_pair(frame, home, 2.0_wp*pi*advance)
      call built_in%evaluate(q, expected, err)
      call make_both(test, 1, [reshape(frame%r, [9]), frame%p, advance], exact_pair, plain_pair)
      call exact_pair%evaluate(q, motion, err)
      call test%no_error(err, 'a screw in Taylor arithmetic has a motion')
      call check_same_motion(test, motion, expected, exact, 'a screw in Taylor arithmetic')
      call plain_pair%evaluate(q, motion, err)
      call test%no_error(err, 'a screw in plain values has a motion')
      call check_same_motion(test, motion, expected, promised, 'a screw in plain values')
    end do
  end subroutine as_built_in

  subroutine forms_agree(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(random_type) :: random
    type(procedure_pair_type) :: exact_pair, plain_pair
    type(pair_motion_type) :: motion, expected
    type(error_type), allocatable :: err
    real(wp) :: q
    integer :: i, kind

    do kind = 2, 5, 3
      call make_both(test, kind, [real(wp) ::], exact_pair, plain_pair)
      do i = 1, 20
        q = 2.0_wp*random%symmetric()
        call exact_pair%evaluate(q, expected, err)
        call test%no_error(err, 'a curve in Taylor arithmetic has a motion')
        call plain_pair%evaluate(q, motion, err)
        call test%no_error(err, 'a curve in plain values has a motion')
        call check_same_motion(test, motion, expected, promised, 'a curve in both forms')
        if (kind == 2) call check_derivatives(test, exact_pair, q, 'a curve in Taylor arithmetic')
      end do
    end do
  end subroutine forms_agree

  !> Only narrow stencils fit near the end of the range in which a procedure has values.
  subroutine end_of_domain(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(procedure_pair_type) :: exact_pair, plain_pair
    type(pair_motion_type) :: motion, expected
    type(error_type), allocatable :: err
    real(wp) :: q
    integer :: i

    call make_both(test, 4, [real(wp) ::], exact_pair, plain_pair)
    do i = 0, 8
      q = -1.0_wp + 0.2_wp*i
      call exact_pair%evaluate(q, expected, err)
      call test%no_error(err, 'a root within its domain has a motion by Taylor arithmetic')
      call test%near(expected%v(1), -0.5_wp/sqrt(1.0_wp - q), 1.0e-15_wp, 'a root has its first derivative')
      call test%near(expected%v_rate(1), -0.25_wp/sqrt(1.0_wp - q)**3, 4.0e-15_wp, 'a root has its second derivative')
      call plain_pair%evaluate(q, motion, err)
      call test%no_error(err, 'a root within its domain has a motion by plain values')
      call check_same_motion(test, motion, expected, promised, 'close to the end of the domain')
    end do
  end subroutine end_of_domain

  !> A third point close to the line of the other two: the matrix is a rotation all the same.
  subroutine close_to_a_line(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(procedure_pair_type) :: exact_pair, plain_pair
    type(pair_motion_type) :: motion
    type(error_type), allocatable :: err
    integer :: k

    do k = 0, 6
      call make_both(test, 6, [10.0_wp**(-k)], exact_pair, plain_pair)
      call exact_pair%evaluate(0.4_wp, motion, err)
      call test%no_error(err, 'points close to a line give a motion')
      call test%near(maxval(abs(matmul(transpose(motion%pose%r), motion%pose%r) - identity)), 0.0_wp, 2.0e-15_wp, &
                     'the rotation of points close to a line satisfies R^T R = 1')
      call plain_pair%evaluate(0.4_wp, motion, err)
      call test%no_error(err, 'points close to a line give a motion by plain values')
      call test%near(maxval(abs(matmul(transpose(motion%pose%r), motion%pose%r) - identity)), 0.0_wp, 2.0e-15_wp, &
                     'the rotation of points close to a line by plain values satisfies R^T R = 1')
    end do
  end subroutine close_to_a_line

  !> Points in one line and numbers that are none, in both forms: what, where, at which value.
  subroutine refused(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(procedure_pair_type) :: pairs(2)
    type(pair_motion_type) :: motion
    type(error_type), allocatable :: err
    integer :: i

    call make_both(test, 3, [real(wp) ::], pairs(1), pairs(2))
    do i = 1, 2
      pairs(i)%place = place_type(8, 1)
      call pairs(i)%evaluate(0.625_wp, motion, err)
      call test%has_error(err, exit_data, 'points in one line are refused')
      call test%is_true(index(err%message, 'pair 3') > 0 .and. index(err%message, '0.625') > 0, &
                        'the message about points in one line names the pair and the value')
      call test%is_true(index(err%message, 'line') > 0 .and. err%place%line == 8, &
                        'the message about points in one line tells the reason and its place')
    end do
    call make_both(test, 4, [real(wp) ::], pairs(1), pairs(2))
    do i = 1, 2
      call pairs(i)%evaluate(1.5_wp, motion, err)
      call test%has_error(err, exit_data, 'numbers that are not finite are refused')
      call test%is_true(index(err%message, 'pair 4') > 0 .and. index(err%message, '1.5') > 0, &
                        'the message about numbers that are not finite names the pair and the value')
      call test%is_true(index(err%message, 'not finite') > 0, 'the message about numbers that are not finite tells the reason')
    end do
  end subroutine refused

  subroutine what_they_say(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(procedure_pair_type) :: exact_pair, plain_pair
    type(screw_factors_type) :: factors
    logical :: is_screw

    call make_both(test, 2, [1.0_wp], exact_pair, plain_pair)
    call exact_pair%as_screw(factors, is_screw)
    call test%is_true(.not. is_screw, 'a user''s pair has no fixed axis')
    call test%is_true(exact_pair%kind_name() == 'user', 'a user''s pair has the kind of users')
    call test%is_true(exact_pair%user_calls() == 1, 'Taylor arithmetic takes one call')
    call test%is_true(plain_pair%user_calls() == stencil_size, 'plain values take a stencil of calls')
    call test%is_true(.not. exact_pair%angular, 'a user''s coordinate is not turned into degrees')
  end subroutine what_they_say
end module test_user_pairs
