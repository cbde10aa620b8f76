"""Rods between two balls that turn about themselves, through gimbal lock of the balls' angles, in a delta robot that falls.

From rest at home the robot falls symmetrically: its rods do not turn about themselves, however large their inertia about their own axes
is. Their angles are then of no effect on the platform. Rods without this inertia, one angle of which the program holds, tell the motion.
The second angle of the first ball passes 90 degrees at 0.284 s.
"""
import numpy as np
import pytest

from free_delta import delta
from mech9_cases import table_of

# of the integration: 1e-10 a step, some hundred steps; rates of the platform up to 3 m/s and accelerations up to 100 m/s^2
TOLERANCE = 1e-8
COLUMNS = 'P.x', 'P.y', 'P.z', 'P.vx', 'P.vy', 'P.vz', 'Q.y', 'Q.z'
# the angle of the first ball about the rod's own axis, by drives and a gear
WHEEL = """&pair coordinate=40, links=1,12, kind='revolute', axis=0,0,1, point=1,1,1 /
&body link=12, mass=0.01, centre=1,1,1, inertia=1e-5,1e-5,1e-5,0,0,0 /
&coupling kind='gear', coordinates=6,40, ratio=1 /
&initial coordinate=40, position=0, velocity=0 /
"""
SETTINGS = {
    'free': ('1,2,3', ''),
    'free by the choice of the user': ('1,2,3,4,10,18,24,30,36', ''.join(f'&initial coordinate={k}, position={p} /\n' for k, p in
                                       ((4, 0), (10, 0), (18, 60), (24, 60), (30, -60), (36, -60)))),
    'driven': ('1,2,3,6', "&drive coordinate=6, kind='polynomial', coefficients=0 /\n"),
    'coupled': ('1,2,3,40', WHEEL),
    'loaded beside': ('1,2,3', "&load kind='coordinate', coordinate=1, damping=0.3 /\n"
                               "&load kind='coordinate', coordinate=2, damping=0.3 /\n"
                               "&load kind='coordinate', coordinate=3, damping=0.3 /\n"),
}


@pytest.fixture(scope='module')
def held(mech9d, tmp_path_factory):
    """The motion with rods that do not resist a turn about themselves, without loads and with."""
    tables = {}
    for name in 'free', 'loaded beside':
        path = tmp_path_factory.mktemp('held') / 'held.nml'
        path.write_text(delta(0.0, more=SETTINGS[name][1]), encoding='utf-8')
        tables[name] = table_of(mech9d, path)
    return tables


@pytest.mark.parametrize('setting', SETTINGS)
def test_the_platform_falls_as_with_rods_that_are_held(checks, mech9d, tmp_path, held, setting):
    path = tmp_path / 'case.nml'
    path.write_text(delta(2e-5, *SETTINGS[setting]), encoding='utf-8')
    table = table_of(mech9d, path)
    other = held[setting if setting in held else 'free']
    checks.equal(len(table['t']), 34, 'all rows are there')
    checks.true(abs(table['q5'][-1]) > 95, 'the first ball has passed gimbal lock', table['q5'][-1])
    for name in COLUMNS:
        checks.near(table[name], other[name], TOLERANCE, f'{setting}: {name}', scale=max(1, abs(other[name]).max()))
    if 'loaded' not in setting:
        total = table['E.kinetic'] + table['E.potential']
        checks.near(total, total[0], TOLERANCE, 'the energy stays', scale=10)


def test_a_rod_that_turns_about_itself_keeps_its_spin(checks, mech9d, tmp_path):
    # a rod between two fixed balls: nothing acts about its axis, so that it turns at one rate, through lock of each ball
    path = tmp_path / 'rod.nml'
    path.write_text("""&mechanism angle_unit='deg' /
&structure cq=1 /
&pair coordinates=1,2,3, links=1,2, kind='spherical', point=0,0,0 /
&pair coordinates=4,5,6, links=1,2, kind='spherical', point=0.7,0.6,0.2 /
&initial coordinate=1, position=0, velocity=200 /
&body link=2, mass=1, centre=0.35,0.3,0.1, inertia=0.1,0.1,0.1,0,0,0 /
&point name='A', link=2, position=0.3,-0.1,0.4 /
&time end=4, intervals=80 /
&solver relative_tolerance=1e-11, absolute_tolerance=1e-11 /
&output derivatives=1 /
""", encoding='utf-8')
    table = table_of(mech9d, path)
    axis = np.array([0.7, 0.6, 0.2]) / np.linalg.norm([0.7, 0.6, 0.2])
    place = np.array([table['A.x'], table['A.y'], table['A.z']]).T
    velocity = np.array([table['A.vx'], table['A.vy'], table['A.vz']]).T
    first = place[0] - axis * (axis @ place[0])
    rate = axis @ np.cross(first, velocity[0]) / (first @ first)
    turn = np.outer(rate * table['t'], np.ones(1))
    expected = axis * (axis @ place[0]) + np.cos(turn) * first + np.sin(turn) * np.cross(axis, first)
    checks.near(place, expected, TOLERANCE, 'the point goes around at one rate', scale=1)
    checks.near(np.linalg.norm(velocity, axis=1), np.linalg.norm(velocity[0]), TOLERANCE, 'at one speed', scale=1)
    checks.true(abs(turn[-1, 0]) > 6.3, 'by more than a turn', turn[-1])
