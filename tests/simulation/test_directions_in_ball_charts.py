"""Periodic motions and exponents where ball joints pass gimbal lock, in open chains and in closed ones.

Multipliers do not depend on the angles of a joint. Compares the program with itself: one ball in several poses of its link, so that its
angles pass gimbal lock, begin near it, or stay far from it; a closed chain by other axes of its ball and other independent coordinates."""
import json

import numpy as np
import pytest

from ball_mechanisms import SLIDER
from mech9_cases import read_table, run

BALL = "&structure cq=1,2,3 /\n&pair coordinates=1,2,3, links=1,2, kind='spherical' /\n"
INERTIA = np.array([[0.3, 0.02, 0.0], [0.02, 0.25, 0.01], [0.0, 0.01, 0.1]])
SPRINGS = [((0.3, 0, -1), (1, 0.2, -1)), ((0, 0.3, -1), (0.1, 1, -1.2)), ((0.5, 0, 0), (0.5, 0.6, 0.4)),
           ((0, -0.4, -0.5), (0.2, -1, -0.3))]
TIGHT = '&solver relative_tolerance=1e-10, absolute_tolerance=1e-12 /\n'


def turned(q):
    """The rotation of a ball joint by its angles about x, y and z."""
    (a, b, c), (d, e, f) = np.cos(q), np.sin(q)
    x = np.array([[1, 0, 0], [0, a, -d], [0, d, a]])
    y = np.array([[b, 0, e], [0, 1, 0], [-e, 0, b]])
    z = np.array([[c, -f, 0], [f, c, 0], [0, 0, 1]])
    return x @ y @ z


def driven_ball(q, amplitude, frequency, more):
    """A damped body on a ball joint with a force in time: the same at each pose q of its link, whose numbers are turned back."""
    r = turned(np.array(q))

    def triple(v):
        return ','.join(repr(float(x)) for x in r.T @ np.array(v))

    i = r.T @ INERTIA @ r
    text = BALL + ''.join(f'&initial coordinate={k + 1}, position={float(q[k])!r} /\n' for k in range(3))
    text += (f'&body link=2, mass=1, centre={triple((0.1, 0, -1))}, inertia='
             + ','.join(repr(float(i[k])) for k in ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2))) + ' /\n')
    text += '&gravity acceleration=0,0,-9.81 /\n' + TIGHT
    for at, to in SPRINGS:
        text += (f"&load kind='spring', links=2,1, position={triple(at)}, second_position={to[0]},{to[1]},{to[2]}, stiffness=30, "
                 'free_length=0.5, damping=1 /\n')
    text += (f"&load kind='force', link=2, position={triple((0.2, 0.1, -1))}, force=1,0.7,0.2, law='harmonic', "
             f'amplitude={amplitude!r}, angular_frequency={frequency!r} /\n')
    return text + more


def go(program, folder, text, *options, code=0):
    """Report, table and standard error of a run."""
    path, report, table = folder / 'motion.nml', folder / 'motion.json', folder / 'motion.dat'
    path.write_text(text + ('' if '&time' in text else '&time end=5, intervals=200 /\n'), encoding='utf-8')
    done = run(program, path, *options, '--report', report, '--table', table)
    assert done.returncode == code, done.stderr
    return (json.loads(report.read_text()), read_table(table.read_text())) if code == 0 else (None, done.stderr)


def sorted_multipliers(found):
    return np.sort_complex(np.array([complex(*pair) for pair in found['multipliers']]))


@pytest.mark.parametrize('amplitude, frequency', [(6.0, 3.0), (25.0, 3.0), (40.0, 5.0)])
def test_multipliers_of_a_driven_ball(checks, mech9d, tmp_path, amplitude, frequency):
    """The largest force leads one of the poses to 0.02 rad from the lock."""
    nearest, poses = [], ((0, 0, 0), (0.2, 1.45, -0.3), (1.0, -1.4, 2.0), (-0.4, 1.0, 0.6))
    for q in poses:
        report, table = go(mech9d, tmp_path, driven_ball(q, amplitude, frequency, '&periodic /\n'), '--periodic')
        found = report['periodic']
        nearest.append(float(np.min(np.abs(np.cos(table['q2'])))))
        if q == poses[0]:
            wanted = sorted_multipliers(found)
        # tolerance: that of the motion, times derivatives of some tens
        checks.near(np.abs(sorted_multipliers(found) - wanted), 0.0, 1e-9, f'multipliers from the pose {q}', scale=1)
        checks.near(found['product'], found['product_by_divergence'], 1e-10, f'both products from the pose {q}', scale=1)
    checks.true(min(nearest[1:]) < 0.3 < max(nearest), 'other angles move the joint in some of them', nearest)


def test_exponents_of_a_driven_ball(checks, mech9d, tmp_path):
    """Over whole periods of a stable motion the sum is the logarithm of the product of its multipliers."""
    period = 2 * np.pi / 5
    report, _ = go(mech9d, tmp_path, driven_ball((0, 0, 0), 40.0, 5.0, '&periodic /\n'), '--periodic')
    wanted = np.log(report['periodic']['product']) / period
    more = f'&exponents transient={10 * period!r} /\n&time end={25 * period!r}, intervals=10 /\n'
    report, table = go(mech9d, tmp_path, driven_ball((1.0, -1.4, 2.0), 40.0, 5.0, more), '--exponents', '6')
    # tolerance: the motion comes to the periodic one as exp(-0.4 t)
    checks.near(sum(report['exponents']), wanted, 1e-2, 'the sum of the exponents')
    checks.near(sum(report['exponents']), report['divergence'], 1e-6, 'the mean divergence')


def test_pairs_of_a_free_ball(checks, mech9d, tmp_path):
    """A heavy body that turns through the lock again and again, without damping: exponents stand in pairs."""
    text = (BALL + '&initial coordinate=1, position=1.2, velocity=0.5 /\n&initial coordinate=2, position=0.3, velocity=2.5 /\n'
            '&initial coordinate=3, position=0.4, velocity=1 /\n'
            '&body link=2, mass=1, centre=0.1,0,-1, inertia=0.3,0.2,0.1,0,0,0 /\n'
            '&gravity acceleration=0,0,-9.81 /\n&exponents transient=0 /\n&time end=60, intervals=10 /\n')
    report, table = go(mech9d, tmp_path, text, '--exponents', '6')
    exponents = np.array(report['exponents'])
    # tolerance: the volume in angles differs at both ends, by a factor whose logarithm is about 1, over 60 s
    checks.near(exponents[:3] + exponents[:2:-1], 0.0, 0.1, 'pairs', scale=1)
    checks.true(exponents[0] > 0.3, 'it is chaotic', exponents)
    checks.near(sum(exponents), report['divergence'], 1e-5, 'the mean divergence', scale=1)


CLOSED = """&body link=2, mass=2, centre=0,0,0.1, inertia=0.1,0.1,0.1,0,0,0 /
&body link=3, mass=1, centre=0.5,0.02,0.01, inertia=0.01,0.1,0.1,0,0,0 /
&body link=4, mass=1.5 /
&gravity acceleration=0,0,-9.81 /
&load kind='coordinate', coordinate=1, force=12, law='harmonic', amplitude=1, angular_frequency=4 /
&load kind='coordinate', coordinate=1, damping=0.4 /
&load kind='coordinate', coordinate=7, stiffness=20, rest=1, damping=0.5 /
"""


def test_a_closed_chain(checks, mech9d, tmp_path):
    """An unstable motion by the crank, and by angles of the ball, in two orders of its turns."""
    wanted = None
    for frame, independent in (('', (1, 3)), (', axis=0,1,0, zero=0,0,1', (1, 4))):
        text = SLIDER.format(crank='0.2,1,0.1', guide='0,0.1,0.05', frame=frame) + '&initial coordinate=1, position=0.2 /\n'
        _, table = go(mech9d, tmp_path, text + '&body link=4, mass=1 /\n&time end=1e-3, intervals=1 /\n')
        start = ''.join(f"&initial coordinate={k}, position={float(table[f'q{k}'][0])!r} /\n" for k in range(2, 7))
        for coordinate in independent:
            report, _ = go(mech9d, tmp_path, text.replace('cq=1', f'cq={coordinate}') + start + CLOSED + TIGHT + '&periodic /\n',
                           '--periodic')
            found = sorted_multipliers(report['periodic'])
            wanted = found if wanted is None else wanted
            # tolerance: near a singular position of the ball's angles the start is known to some 1e-10
            checks.near(np.abs(found - wanted), 0.0, 1e-7, f'multipliers by coordinate {coordinate}', scale=1)
    checks.true(abs(wanted[0]) > 4, 'it is unstable', wanted)


def test_refusals(checks, mech9d, tmp_path):
    """Numbers that a parameter sets could move the axes of the joint."""
    more = ("&periodic /\n&parameter name='A', sets='load(5).amplitude', value=25, low=24, high=26 /\n"
            "&branch parameter='A', of='periodic' /\n")
    _, said = go(mech9d, tmp_path, driven_ball((0.2, 1.45, -0.3), 25.0, 3.0, more), '--branch', 'A', code=6)
    checks.true('in other angles of a ball joint' in said, 'a branch over a parameter', said)
