!> Texts of data files of small mechanisms, which several suites use.
module mech9_small_models
  use mech9_kinds, only: wp
  implicit none
  private
  public :: slider_crank, crank, rod, eol, loaded_pendulum, loaded_four_bar, loaded_screw

  character, parameter :: eol = achar(10)
  real(wp), parameter :: crank = 0.3_wp, rod = 1.0_wp   !< lengths of the slider-crank [m]

  !> The slider-crank without drive and times: coordinates of crank, rod, slider and slide. The slide lies along x, and the
  !> crank turns about z; the point B is the slider.
  character(len=*), parameter :: slider_crank = &
    "&mechanism title='Slider-crank', links=4, coordinates=4 /"//eol// &
    "&structure cq=1 /"//eol// &
    "&pair coordinate=1, links=1,2, kind='revolute', axis=0,0,1 /"//eol// &
    "&pair coordinate=2, links=2,3, kind='revolute', axis=0,0,1, point=0.3,0,0, moving_point=0,0,0 /"//eol// &
    "&pair coordinate=3, links=3,4, kind='revolute', axis=0,0,1, point=1,0,0, moving_point=0,0,0 /"//eol// &
    "&pair coordinate=4, links=1,4, kind='prismatic', axis=1,0,0, zero=0,1,0 /"//eol// &
    "&initial coordinate=4, position=1.2 /"//eol// &
    "&point name='B', link=4 /"//eol

  !> A pendulum with a spring and a damper on its coordinate, and six parameters.
  character(len=*), parameter :: loaded_pendulum = '&structure cq=1 / '// &
    '&pair coordinate=1, links=1,2, kind=''revolute'', axis=0,0,1 / '// &
    '&body link=2, mass=2, centre=0,-0.8,0, inertia=0,0,0.3,0,0,0 / &gravity acceleration=0,-9.81,0 / '// &
    '&load kind=''coordinate'', coordinate=1, stiffness=5, damping=3 / &initial coordinate=1, position=0.6 / '// &
    '&parameter name=''mass'', sets=''body(1).mass'' / &parameter name=''inertia'', sets=''body(1).inertia(3)'' / '// &
    '&parameter name=''centre'', sets=''body(1).centre(2)'' / &parameter name=''stiffness'', sets=''load(1).stiffness'' / '// &
    '&parameter name=''damping'', sets=''load(1).damping'' / &parameter name=''gravity'', sets=''gravity.acceleration(2)'' / '

  !> A four-bar linkage with bodies, gravity and a spring, and six parameters of dimensions, bodies and loads.
  character(len=*), parameter :: loaded_four_bar = '&structure cq=1 / '// &
    '&pair coordinate=1, links=1,2, kind=''revolute'', axis=0,0,1 / '// &
    '&pair coordinate=2, links=2,3, kind=''revolute'', axis=0,0,1, point=0.4,0,0, moving_point=0,0,0 / '// &
    '&pair coordinate=3, links=3,4, kind=''revolute'', axis=0,0,1, point=1.9,0,0, moving_point=1.6,0,0 / '// &
    '&pair coordinate=4, links=1,4, kind=''revolute'', axis=0,0,1, point=2,0.1,0, moving_point=0,0,0 / '// &
    '&initial coordinate=1, position=0.8 / &initial coordinate=2, position=0.3 / &initial coordinate=3, position=1 / '// &
    '&initial coordinate=4, position=1.7 / &gravity acceleration=0,-9.81,0 / &point name=''P'', link=3, position=0.5,0.3,0 / '// &
    '&body link=3, mass=2, centre=0.9,0.2,0, inertia=0,0,0.3,0,0,0 / &body link=4, mass=1, centre=0.7,0,0 / '// &
    '&load kind=''spring'', links=1,3, position=0,1,0, second_position=0.5,0,0, stiffness=40, free_length=0.3, damping=2 / '// &
    '&parameter name=''crank'', sets=''pair(2).point(1)'' / &parameter name=''height'', sets=''pair(4).point(2)'' / '// &
    '&parameter name=''centre'', sets=''body(1).centre(1)'' / &parameter name=''length'', sets=''load(1).free_length'' / '// &
    '&parameter name=''place'', sets=''point(1).position(2)'' / &parameter name=''end'', sets=''load(1).position(1)'' / '

  !> A crank, a rod between a universal and a ball joint, and a screw, with bodies and a force, and four parameters.
  character(len=*), parameter :: loaded_screw = '&structure cq=1 / '// &
    '&pair coordinate=1, links=1,2, kind=''revolute'', axis=0,0,1, moving_point=0,0,0 / '// &
    '&pair coordinates=2,3, links=2,3, kind=''universal'', axis=0,0,1, moving_axis=0,1,0, point=0.2,0.15,0, '// &
    'moving_point=0,0,0 / '// &
    '&pair coordinates=4,5,6, links=3,4, kind=''spherical'', point=1.1,0,0, moving_point=0,0,0.6 / '// &
    '&pair coordinate=7, links=1,4, kind=''helical'', axis=0.1,1,0, point=1,0,0, moving_point=0,0,0, pitch=0.3 / '// &
    '&gravity acceleration=1,-9,3 / &point name=''P'', link=4, position=0.5,0.3,0.1 / &initial coordinate=1, position=0.4 / '// &
    '&body link=2, mass=2, centre=0.2,0.1,0.1, inertia=0.2,0.25,0.3,0.02,0.01,0.03 / '// &
    '&body link=4, mass=1, centre=0.1,0.2,0.3, inertia=0.3,0.2,0.25,0.01,0.02,0.03 / '// &
    '&load kind=''force'', link=4, position=0.1,0.5,0, force=3,1,2, frame=''link'' / '// &
    '&parameter name=''rod'', sets=''pair(3).point(1)'' / &parameter name=''tilt'', sets=''pair(4).axis(1)'' / '// &
    '&parameter name=''pitch'', sets=''pair(4).pitch'' / &parameter name=''force'', sets=''load(1).force(2)'' / '
end module mech9_small_models
