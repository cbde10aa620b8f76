!> Cyclic coordinates, on which nothing depends: the angle of a vertical shaft with an arm, and what makes it count.
module test_cyclic_coordinates
  use mech9_program_kind, only: dynamics
  use mech9_model, only: model_type
  use mech9_cyclic_coordinates, only: find_cyclic
  use mech9_small_models, only: eol
  use mech9_text_models, only: model_from_text
  use mech9_testing, only: tester_type
  implicit none
  private
  public :: run

  !> A vertical shaft with an arm that swings, both free.
  character(len=*), parameter :: shaft = "&structure cq=1,2 /"//eol// &
    "&pair coordinate=1, links=1,2, kind='revolute', axis=0,0,1 /"//eol// &
    "&pair coordinate=2, links=2,3, kind='revolute', axis=0,1,0, point=0.1,0,0 /"//eol// &
    "&body link=2, mass=1, inertia=1,1,1,0,0,0 /"//eol// &
    "&body link=3, mass=1, centre=0.1,0,-0.5 /"//eol// &
    "&time end=1 /"//eol
  character(len=*), parameter :: gravity = "&gravity acceleration=0,0,-9.81 /"//eol

contains

  !> Run the cases of this suite.
  subroutine run(tester)
    type(tester_type), intent(inout) :: tester   !< selects cases and counts their checks

    if (tester%runs('shafts')) call shafts(tester)
    if (tester%runs('loads')) call loads(tester)
    if (tester%runs('other_parts')) call other_parts(tester)
    if (tester%runs('chains')) call chains(tester)
  end subroutine run

  subroutine shafts(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks

    call judge(tester, shaft//gravity, [.true., .false.], 'a vertical shaft')
    call judge(tester, shaft, [.true., .false.], 'a shaft without gravity')
    call judge(tester, shaft//"&gravity acceleration=0.01,0,-9.81 /"//eol, [.false., .false.], 'a shaft that leans')
  end subroutine shafts

  !> Damping and torques by the speed leave the angle out; springs, and forces along fixed axes behind it, do not.
  subroutine loads(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    character(len=*), parameter :: on_shaft = shaft//gravity//"&load kind='coordinate', coordinate=1, "
    character(len=*), parameter :: line = "force=2, law='polynomial', coefficients=1,1, over="

    call judge(tester, on_shaft//"force=2, damping=0.3 /"//eol, [.true., .false.], 'torque and damping')
    call judge(tester, on_shaft//line//"'dq1' /"//eol, [.true., .false.], &
               'a torque over the speed')
    call judge(tester, on_shaft//line//"'q2' /"//eol, [.true., .false.], &
               'a torque over the other angle')
    call judge(tester, on_shaft//"stiffness=2 /"//eol, [.false., .false.], 'a spring')
    call judge(tester, on_shaft//line//"'q1' /"//eol, [.false., .false.], &
               'a torque over its angle')
    call judge(tester, shaft//gravity//"&load kind='coordinate', coordinate=2, "//line//"'q1' /"//eol, [.false., .false.], &
               'a torque on the arm over the angle of the shaft')
    call judge(tester, shaft//gravity//"&load kind='force', link=3, position=0,0,0, force=1,0,0 /"//eol, [.false., .false.], &
               'a force along a fixed axis')
  end subroutine loads

  subroutine other_parts(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks

    call judge(tester, shaft//gravity//"&stop coordinate=1, low=-10 /"//eol, [.false., .false.], 'a stop')
    call judge(tester, shaft//gravity//"&stop coordinate=2, low=-2 /"//eol, [.true., .false.], 'a stop of the arm')
    call judge(tester, shaft//gravity//"&motor kind='pid', coordinate=1, proportional=1, setpoint=0 /"//eol, [.false., .false.], &
               'a motor')
    call judge(tester, shaft//gravity//"&pair coordinate=3, links=1,4, kind='prismatic', axis=0,0,1 /"//eol// &
               "&body link=4, mass=1 /"//eol//"&coupling kind='linear', coordinates=1,3, coefficients=1,-2 /"//eol, &
               [.false., .false., .false.], 'a screw by a coupling')
  end subroutine other_parts

  !> The inertia of a crank in a closed chain depends on its angle. A slide does not turn, and pairs on moving links do not
  !> count.
  subroutine chains(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    character(len=*), parameter :: bars = "&structure cq=1 /"//eol// &
      "&pair coordinate=1, links=1,2, kind='revolute', axis=0,0,1 /"//eol// &
      "&pair coordinate=2, links=2,3, kind='revolute', axis=0,0,1, point=0.3,0,0, moving_point=0,0,0 /"//eol// &
      "&pair coordinate=3, links=3,4, kind='revolute', axis=0,0,1, point=0.8,0,0, moving_point=0,0,0 /"//eol// &
      "&pair coordinate=4, links=1,4, kind='revolute', axis=0,0,1, point=0.9,0,0, moving_point=0.7,0,0 /"//eol// &
      "&body link=2, mass=1, inertia=0,0,0.1,0,0,0 /"//eol//"&body link=4, mass=1 /"//eol//"&time end=1 /"//eol
    character(len=*), parameter :: others = "&structure cq=1,2 /"//eol// &
      "&pair coordinate=1, links=1,2, kind='prismatic', axis=0,0,1 /"//eol// &
      "&pair coordinate=2, links=2,3, kind='revolute', axis=0,0,1, point=1,0,0 /"//eol// &
      "&body link=2, mass=1 /"//eol//"&body link=3, mass=1, centre=1.5,0,0 /"//eol//"&time end=1 /"//eol

    call judge(tester, bars//gravity, [.false., .false., .false., .false.], 'a crank in a closed chain')
    call judge(tester, others, [.false., .false.], 'a slide, and a joint behind it')
  end subroutine chains

  !> Compare the cyclic coordinates of a model with those that are expected.
  subroutine judge(tester, text, expected, why)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    character(len=*), intent(in) :: text         !< of the data file
    logical, intent(in) :: expected(:)           !< (M) which are cyclic
    character(len=*), intent(in) :: why          !< the case
    type(model_type) :: model
    logical, allocatable :: is_cyclic(:)

    call model_from_text(tester, text, dynamics, model)
    if (.not. allocated(model%mechanism%pairs)) return
    call find_cyclic(model, is_cyclic)
    call tester%is_true(size(is_cyclic) == size(expected), why//': all coordinates are judged')
    call tester%is_true(all(is_cyclic .eqv. expected), why)
  end subroutine judge
end module test_cyclic_coordinates
