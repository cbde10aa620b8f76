"""Mechanisms that several tests of branches and of equations of motion share, as parts of data files; the runs of branches of periodic motions."""
import json

from mech9_cases import read_table, run

# half of a von Mises truss as a closed chain, in mm and degrees: a bar from (-800, 0) that slides along itself against a spring, and a slider
# of 1 kg on y; the parameter, the load, is load(2).force(2), downwards
TRUSS = """&mechanism length_unit='mm', angle_unit='deg' /
&structure cq=1 /
&pair coordinate=1, links=1,2, kind='revolute', axis=0,0,1, point=-800,0,0 /
&pair coordinate=2, links=2,3, kind='prismatic', axis=0.8,0.6,0, point=-400,300,0 /
&pair coordinate=3, links=3,4, kind='revolute', axis=0,0,1, point=0,600,0 /
&pair coordinate=4, links=1,4, kind='prismatic', axis=0,1,0 /
&body link=4, mass=1 /
&load kind='coordinate', coordinate=2, stiffness=0.1, damping=0.0005 /
&load kind='force', link=4, position=0,600,0, force=0,0,0 /
"""
# masses 2 and 1 at the ends of rods of length 1, torsion springs 1, dampers, a load along the second rod; the start is to be added
ZIEGLER = """&structure cq=1,2 /
&pair coordinate=1, links=1,2, kind='revolute', axis=0,0,1 /
&pair coordinate=2, links=2,3, kind='revolute', axis=0,0,1, point=1,0,0 /
&body link=2, mass=2, centre=1,0,0 /
&body link=3, mass=1, centre=2,0,0 /
&load kind='coordinate', coordinate=1, stiffness=1, damping=%r /
&load kind='coordinate', coordinate=2, stiffness=1, damping=%r /
&load kind='force', link=3, position=2,0,0, force=0,0,0, frame='link' /
"""
# crank 0.5 (q1), coupler 0.7 (q2 from the crank), rocker 0.6 about (1, 0.1); a torque T on q2 and a spring on q4; the structure is to be added
FOUR_BAR = """&pair coordinate=1, links=1,2, kind='revolute', axis=0,0,1 /
&pair coordinate=2, links=2,3, kind='revolute', point=0.5,0,0, axis=0,0,1 /
&pair coordinate=3, links=3,4, kind='revolute', point=1.2,0,0, axis=0,0,1, moving_point=1.6,0.1,0 /
&pair coordinate=4, links=1,4, kind='revolute', point=1,0.1,0, axis=0,0,1 /
&initial coordinate=1, position=0.5 /
&initial coordinate=2, position=0.3 /
&initial coordinate=4, position=2 /
&body link=2, mass=0.2, centre=0.1,0,0, inertia=0,0,0.001,0,0,0 /
&body link=3, mass=0.5, centre=0.85,0,0, inertia=0,0,0.01,0,0,0 /
&body link=4, mass=0.3, centre=1.3,0.1,0, inertia=0,0,0.03,0,0,0 /
&load kind='coordinate', coordinate=4, stiffness=10, rest=2, damping=0.2 /
&load kind='coordinate', coordinate=2, force=1 /
&parameter name='T', sets='load(2).force', value=0, low=-60, high=60 /
"""
# a slider of 1 kg on a spring, with friction that falls with speed at first, a second one of 0.4 kg on it by spring and damper, under a force of
# period 2 pi/1.4; the start and the parameter f, load(4).force, are to be added
SLIDERS = """&structure cq=1,2 /
&pair coordinate=1, links=1,2, kind='prismatic', axis=1,0,0 /
&pair coordinate=2, links=2,3, kind='prismatic', axis=1,0,0 /
&body link=2, mass=1 /
&body link=3, mass=0.4 /
&load kind='coordinate', coordinate=1, stiffness=1 /
&load kind='coordinate', coordinate=1, force=1, law='polynomial', coefficients=0,0.3,0,-0.1, over='dq1' /
&load kind='coordinate', coordinate=2, stiffness=0.5, damping=0.1 /
&load kind='coordinate', coordinate=1, force=1, law='harmonic', amplitude=1, angular_frequency=1.4 /
"""


def follow(program, folder, text, name, code=0):
    """Table, branches in the report, and standard error of --branch."""
    path, report, table = folder / 'follow.nml', folder / 'follow.json', folder / 'follow.dat'
    path.write_text(text, encoding='utf-8')
    done = run(program, path, '--branch', name, '--table', table, '--report', report)
    assert done.returncode == code, done.stderr
    if code:
        return None, None, done.stderr
    return read_table(table.read_text()), json.loads(report.read_text())['branches'], done.stderr
