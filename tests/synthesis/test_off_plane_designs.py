"""Parameters that move a planar mechanism out of its plane: the designs are searched in space.

An arm of two links lies in a plane, and one parameter tilts its second axis: closed forms tell the best design. A chain that closes in its plane
only has no design beside it.
"""
import math

import numpy as np

from imported import about
from mech9_cases import read_table, run, text_of

ARM = """
&mechanism title='arm', links=3, coordinates=2 /
&structure cq=1, 2 /
&pair coordinate=1, links=1,2, kind='revolute', axis=0,0,1, point=0,0,0, moving_point=0,0,0 /
&pair coordinate=2, links=2,3, kind='revolute', axis=0,0,1, point=1,0,0, moving_point=0,0,0 /
&point name='P', link=3, position=0.5,0,0 /
&drive coordinate=1, kind='polynomial', coefficients=0, 1 /
&drive coordinate=2, kind='polynomial', coefficients=0, 2 /
&time start=0, end=1, intervals=10 /
&parameter name='tilt', sets='pair(2).axis(1)', low=-0.5, high=0.5 /
&parameter name='l', sets='pair(2).point(1)', low=0.5, high=2 /
&optimum starts=8 /
&output table='designs.dat' /
"""
FOUR_BAR = """
&mechanism title='four-bar', links=4, coordinates=4 /
&structure cq=1 /
&pair coordinate=1, links=1,2, kind='revolute', axis=0,0,1, point=0,0,0, moving_point=0,0,0 /
&pair coordinate=2, links=2,3, kind='revolute', axis=0,0,1, point=2,0,0, moving_point=0,0,0 /
&pair coordinate=3, links=3,4, kind='revolute', axis=0,0,1, point=4,0,0, moving_point=3,0,0 /
&pair coordinate=4, links=1,4, kind='revolute', axis=0,0,1, point=4,0,0, moving_point=0,0,0 /
&initial coordinate=2, position=0 /
&initial coordinate=3, position=1 /
&initial coordinate=4, position=1.4 /
&point name='P', link=3, position=2,1,0 /
&drive coordinate=1, kind='polynomial', coefficients=0.5, 0.2 /
&time start=0, end=2, intervals=10 /
&parameter name='x', sets='pair(4).point(1)', low=3.5, high=4.5 /
&parameter name='z', sets='{}', low=-0.5, high=0.5 /
&objective kind='path', point='P', file='path.dat', timing='given' /
&optimum starts=3 /
"""
NO_DESIGN = 5
# a search ends where the sum of squares is that of round-off; the tilt enters it with a slope of about one
FOUND = 1e-8


def place(tilt, length, t):
    """The point P in closed form: it turns by 2 t about the tilted axis, and by t about the first one."""
    axis = np.array([tilt, 0, 1]) / math.hypot(tilt, 1)
    return about([0, 0, 1], t) @ ([length, 0, 0] + about(axis, 2 * t) @ [0.5, 0, 0])


def search(program, folder, data):
    (folder / 'case.nml').write_text(data, encoding='utf-8')
    return run(program, 'case.nml', '--optimize', '--out', 'best.nml', folder=folder)


def test_a_quantity_across_the_plane(checks, mech9k, tmp_path):
    done = search(mech9k, tmp_path, ARM + "&quantity name='top', take='peak', of='P.z' /\n&objective kind='quantity', of='top', goal=0.1 /\n")
    checks.equal(done.returncode, 0, f'a search: {done.stderr}')
    found = read_table(text_of(tmp_path / 'designs.dat'))
    # the height at the end is 0.25 sin(2 phi)(1 - cos 2) for the angle phi of the tilt
    tilt = math.tan(0.5 * math.asin(0.1 / (0.25 * (1 - math.cos(2)))))
    checks.near(abs(found['tilt'][0]), tilt, FOUND, 'the tilt that reaches the height')


def test_a_path_across_the_plane(checks, mech9k, tmp_path):
    times = np.linspace(0.1, 1, 5)
    (tmp_path / 'path.dat').write_text(''.join(f'{t!r} ' + ' '.join(f'{x!r}' for x in place(0.2, 1.3, t).tolist()) + '\n' for t in times.tolist()),
                                       encoding='utf-8')
    done = search(mech9k, tmp_path, ARM + "&objective kind='path', point='P', file='path.dat', timing='given' /\n")
    checks.equal(done.returncode, 0, f'a search: {done.stderr}')
    found = read_table(text_of(tmp_path / 'designs.dat'))
    checks.near([found['tilt'][0], found['l'][0]], [0.2, 1.3], FOUND, 'tilt and length of the targets')


def test_a_closed_chain_has_no_design_beside_its_plane(checks, mech9k, tmp_path):
    (tmp_path / 'path.dat').write_text('0.5 2 1\n1 2 1.2\n1.5 1.9 1.4\n', encoding='utf-8')
    for sets in ('pair(4).point(3)', 'pair(3).moving_axis(1)', 'pair(4).moving_point(3)'):
        data = FOUR_BAR.format(sets)
        if 'moving_axis' in sets:
            data = data.replace('moving_point=3,0,0', 'moving_point=3,0,0, moving_axis=0,0,1')
        done = search(mech9k, tmp_path, data)
        checks.true(done.returncode == NO_DESIGN and 'no start led to a design' in done.stderr, f'{sets}: no design', f'{done.returncode}: {done.stderr}')
    # tilted in both of its links, the axis leaves no other design than the one of the data file
    done = search(mech9k, tmp_path, FOUR_BAR.format('pair(2).axis(2)'))
    checks.true(done.returncode == 0 and '  z = 0\n' in done.stderr, 'the design in the plane', f'{done.returncode}: {done.stderr}')
