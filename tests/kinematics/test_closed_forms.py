"""Mechanisms whose motion is known in closed form, through the whole program: each kind of pair and drive.

Compares the program with itself in part: a structure given by its matrix and by its structural vectors; all else is
closed forms.
"""
import os

import numpy as np
import pytest

import data_file
from jets import Jet, arctan, check_coordinate, check_point, cos, sin
from mech9_cases import POSITION, REFERENCE, run, table_of, text_of, tolerance_of

HARMONIC = "kind='harmonic', mean=0.2, amplitude=0.7, angular_frequency=3.0, phase=0.4"


def harmonic(t):
    """The motion of HARMONIC."""
    return 0.2 + 0.7 * sin(Jet(3.0 * t + 0.4, 3.0, 0.0))


class Cases:
    def __init__(self, program, folder, checks):
        self.program, self.folder, self.checks = program, folder, checks

    def write(self, name, text):
        path = os.path.join(self.folder, name)
        with open(path, 'w', encoding='utf-8') as file:
            file.write(text)
        return path

    def table(self, text):
        return table_of(self.program, self.write('case.nml', text))


@pytest.fixture
def s(checks, mech9k, tmp_path):
    return Cases(mech9k, tmp_path, checks)


def test_helical_pair(s):
    """A point beside the axis of a helical pair: it turns by q and advances by pitch q/(2 pi)."""
    table = s.table(f"""
&mechanism links=2, coordinates=1 /
&structure cq=1 /
&pair coordinate=1, links=1,2, kind='helical', point=0.1,0,0, axis=0,0,2, pitch=0.3 /
&point name='P', link=2, position=0.6,0,0.2 /
&drive coordinate=1, {HARMONIC} /
&time start=0, end=2, intervals=40 /
""")
    q = harmonic(table['t'])
    check_coordinate(s.checks, table, 1, q, 'helix')
    check_point(s.checks, table, 'P', (0.1 + 0.5 * cos(q), 0.5 * sin(q), 0.2 + 0.3 / (2 * np.pi) * q), 'helix')


def test_denavit_hartenberg(s):
    """Three pairs in Denavit-Hartenberg form, against the product of their matrices with jets as entries."""
    rows = [('revolute', (0.3, 0.5, 0.1, 0.2)), ('prismatic', (0.2, -1.1, 0.4, 0.7)), ('helical', (0.1, 0.3, 0.2, -0.4))]
    pairs = ''.join(f"&pair coordinate={k}, links={k},{k + 1}, kind='{kind}', dh={a},{alpha},{d},{theta}"
                    + (', pitch=0.25' if kind == 'helical' else '') + ' /\n'
                    for k, (kind, (a, alpha, d, theta)) in enumerate(rows, 1))
    table = s.table(f"""
&mechanism links=4, coordinates=3 /
&structure cq=1,2,3 /
{pairs}&point name='P', link=4, position=0.3,-0.2,0.1 /
&drive coordinate=1, {HARMONIC} /
&drive coordinate=2, kind='polynomial', coefficients=0.1, 0.3, -0.2 /
&drive coordinate=3, kind='polynomial', coefficients=0.5, -1.0 /
&time start=0, end=1, intervals=20 /
""")
    t = table['t']
    q = [harmonic(t), Jet(0.1 + 0.3 * t - 0.2 * t ** 2, 0.3 - 0.4 * t, -0.4), Jet(0.5 - t, -1.0, 0.0)]
    x, y, z = 0.3, -0.2, 0.1
    for (kind, (a, alpha, d, theta)), qk in list(zip(rows, q))[::-1]:
        angle = theta + qk if kind != 'prismatic' else Jet(theta)
        slide = {'revolute': d, 'prismatic': d + qk, 'helical': d + 0.25 / (2 * np.pi) * qk}[kind]
        # T = Rz(angle) Tz(slide) Tx(a) Rx(alpha)
        x, y, z = x + a, np.cos(alpha) * y - np.sin(alpha) * z, np.sin(alpha) * y + np.cos(alpha) * z
        x, y, z = x * cos(angle) - y * sin(angle), x * sin(angle) + y * cos(angle), z + slide
    for k in range(3):
        check_coordinate(s.checks, table, k + 1, q[k], 'Denavit-Hartenberg')
    check_point(s.checks, table, 'P', (x, y, z), 'Denavit-Hartenberg')


def test_universal_joint(s):
    """Cardan's joint, a spherical chain: tan q4 = cos(beta) tan q1 for shafts at the angle beta."""
    beta = 0.6
    c, n = float(np.cos(beta)), float(np.sin(beta))
    table = s.table(f"""
&mechanism links=4, coordinates=4 /
&structure cq=1 /
&pair coordinate=1, links=1,2, kind='revolute', point=0.2,0.1,0, axis=1,0,0 /
&pair coordinate=2, links=2,3, kind='revolute', point=0.2,0.1,0, axis=0,0,1 /
&pair coordinate=3, links=3,4, kind='revolute', point=0.2,0.1,0, axis={-n!r},{c!r},0 /
&pair coordinate=4, links=1,4, kind='revolute', point=0.2,0.1,0, axis={c!r},{n!r},0 /
&drive coordinate=1, kind='polynomial', coefficients=-1.2, 2.4 /
&time start=0, end=1, intervals=24 /
""")
    q = Jet(-1.2 + 2.4 * table['t'], 2.4, 0.0)
    check_coordinate(s.checks, table, 4, arctan(c * (sin(q) / cos(q))), 'universal joint')


# A drive by a table of few points.
TIMES = np.linspace(0.0, 2.0, 9)
VALUES = np.sin(1.7 * TIMES) + 0.1 * TIMES
BY_TABLE = """
&mechanism links=2, coordinates=1 /
&structure cq=1 /
&pair coordinate=1, links=1,2, kind='revolute', point=0,0,0, axis=0,0,1 /
&drive coordinate=1, kind='table', file='drive.txt' /
&time start={start!r}, end={end!r}, intervals={intervals} /
"""


@pytest.fixture
def by_table(s):
    """The motion by BY_TABLE, at some times."""
    s.write('drive.txt', '# t q\n' + ''.join(f'{t!r} {q!r}\n' for t, q in zip(TIMES.tolist(), VALUES.tolist())))
    return lambda start, end, intervals: s.table(BY_TABLE.format(start=start, end=end, intervals=intervals))


def test_table_drive_goes_through_its_points(s, by_table):
    table = by_table(0.0, 2.0, 8)
    s.checks.near(table['q1'], VALUES, POSITION, 'the table drive goes through its points')
    # with names above the points, as spreadsheets write them
    s.write('named.csv', '# measured\n\n"time [s]", angle  # in rad\n' + ''.join(f'{t!r},{q!r}\n' for t, q in zip(TIMES.tolist(), VALUES.tolist())))
    named = s.table(BY_TABLE.format(start=0.0, end=2.0, intervals=8).replace('drive.txt', 'named.csv'))
    s.checks.true(np.array_equal(named['q1'], table['q1']), 'a line of names before the points is skipped')


@pytest.mark.parametrize('knot', TIMES[1:-1].tolist())
def test_table_drive_is_smooth(s, by_table, knot):
    """Between rows close to a knot nothing jumps."""
    step = 1e-6
    near = by_table(knot - step, knot + step, 2)
    # a continuous piecewise linear ddq changes by slope*step; slopes of this curve are below 20
    s.checks.near(near['ddq1'], near['ddq1'][1], 20 * step, f'ddq1 is continuous at t = {knot}')
    s.checks.near((near['q1'][2] - near['q1'][0]) / (2 * step), near['dq1'][1], 1e-8,
                  f'dq1 is the slope of q1 at t = {knot}')   # differences: eps/step = 2e-10, curvature step^2


@pytest.mark.parametrize('name, vectors', [
    ('kinematics_slider_crank', 'nrg=1,2,3,4,1 nws=0,1,2,3,4 rdw=1,1,0,0,0 nrw=0,0,0,0,1'),
    ('kinematics_fig1', 'nrg=1,2,3,4,1,1,6,5,3 nws=0,5,4,7,6,0,1,2,3 rdw=1,1,0,0,0,1,0,0,0')], ids=['slider_crank', 'fig1'])
def test_structural_vectors_as_data(s, name, vectors):
    """The structural vectors given as data make the same motion as the coincidence matrix."""
    path = os.path.join(REFERENCE, name + '.nml')
    groups = data_file.parse(text_of(path))
    words = dict(item.split('=') for item in vectors.split())
    given = {key: [int(number) for number in value.split(',')] for key, value in words.items()}
    text = data_file.write([(group, given if group == 'structure' else items) for group, items in groups])
    first, second = table_of(s.program, path), s.table(text)
    for column in first:
        if column != 'closure':
            s.checks.near(second[column], first[column], tolerance_of(column), f'{name} by the second set: {column}')


def test_user_pair_without_a_procedure_is_refused(s):
    """A user pair without a user's procedure is a mistake that is explained."""
    path = s.write('user.nml', """
&mechanism links=2, coordinates=1 /
&structure cq=1 /
&pair coordinate=1, links=1,2, kind='user' /
&drive coordinate=1, kind='polynomial', coefficients=0.0, 1.0 /
""")
    done = run(s.program, path, '--no-write', folder=s.folder)
    s.checks.equal(done.returncode, 3, 'a user pair without a procedure: exit code 3')
    s.checks.true('none is linked' in done.stderr, 'the message says that none is linked', done.stderr)
