!> Words about the geometry of chains that cannot close: the odd link or axis is named before the message, with its place.
module test_geometry
  use mech9_program_kind, only: dynamics
  use mech9_error, only: error_type, raise, exit_assembly, exit_data
  use mech9_geometry_words, only: explain_geometry
  use mech9_model, only: model_type
  use mech9_small_models, only: eol
  use mech9_text_models, only: model_from_text
  use mech9_testing, only: tester_type
  implicit none
  private
  public :: run

contains

  !> Run the cases of this suite.
  subroutine run(tester)
    type(tester_type), intent(inout) :: tester   !< selects cases and counts their checks

    if (tester%runs('long_link')) call long_link(tester)
    if (tester%runs('odd_axis')) call odd_axis(tester)
    if (tester%runs('nothing_odd')) call nothing_odd(tester)
  end subroutine run

  !> A four-bar of the lengths 1 (frame), 0.3, `coupler` and 0.8, whose last pair has an axis.
  subroutine explain(tester, coupler, axis, code, message)
    type(tester_type), intent(inout) :: tester               !< counts the checks
    character(len=*), intent(in) :: coupler                  !< its length [m]
    character(len=*), intent(in) :: axis                     !< of pair 4, in both of its links
    integer, intent(in) :: code                              !< of the error
    character(len=:), allocatable, intent(out) :: message    !< the message for users
    type(model_type) :: model
    type(error_type), allocatable :: err

    call model_from_text(tester, '&mechanism links=4, coordinates=4 /'//eol//'&structure cq=1 /'//eol// &
      "&pair coordinate=1, links=1,2, kind='revolute', axis=0,0,1 /"//eol// &
      "&pair coordinate=2, links=2,3, kind='revolute', axis=0,0,1, point=0.3,0,0, moving_point=0,0,0 /"//eol// &
      "&pair coordinate=3, links=3,4, kind='revolute', axis=0,0,1, point="//coupler//",0,0, moving_point=0.8,0,0 /"//eol// &
      "&pair coordinate=4, links=1,4, kind='revolute', axis="//axis//", point=1,0,0, moving_point=0,0,0 /"//eol// &
      "&initial coordinate=1, position=0 /"//eol, dynamics, model)
    call raise(err, code, 'it does not close')
    call explain_geometry(model%mechanism, err)
    message = err%message
  end subroutine explain

  subroutine long_link(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    character(len=:), allocatable :: message

    call explain(tester, '2.5', '0,0,1', exit_assembly, message)
    call tester%is_true(index(message, 'link 3 is 2.5 m long from pair 2 to pair 3, and the other links of the closed chain of '// &
                              'pairs') == 1, 'a link that is too long: '//message)
    call tester%is_true(index(message, ' are 2.1 m long together; it does not close') > 0, 'the others together')
  end subroutine long_link

  subroutine odd_axis(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    character(len=:), allocatable :: message

    call explain(tester, '0.9', '0,0.1,1', exit_assembly, message)
    call tester%is_true(index(message, 'the axis of pair 4 is not parallel to the other axes') == 1, 'an odd axis: '//message)
    ! the angle is atan(0.1)
    call tester%is_true(index(message, '(by 5.71 degrees)') > 0, 'by its angle')
    call tester%is_true(index(message, 'data_tolerance') == 0, 'no rounding makes so large an angle')
    call explain(tester, '0.9', '0,2e-8,1', exit_assembly, message)
    ! the next power of ten
    call tester%is_true(index(message, 'with &mechanism data_tolerance=1e-7; it does not close') > 0, 'a rounded axis: '//message)
  end subroutine odd_axis

  !> Nothing is said of chains that could close, or of other errors.
  subroutine nothing_odd(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    character(len=:), allocatable :: message

    call explain(tester, '0.9', '0,0,1', exit_assembly, message)
    call tester%is_true(message == 'it does not close', 'a chain that could close: '//message)
    call explain(tester, '2.5', '0,0,1', exit_data, message)
    call tester%is_true(message == 'it does not close', 'an error of another kind: '//message)
  end subroutine nothing_odd
end module test_geometry
