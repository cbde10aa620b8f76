"""Equilibria of mechanisms with ball joints, from random starts: each position of the links is one row.

The angles a, b, c of a ball joint about x, y, z give the same rotation as a + 180, 180 - b, c + 180 degrees, so that random starts find
both. The rotation matrices, worked out here, tell which positions are the same.
"""
import itertools
import json
import math

import numpy as np

from mech9_cases import run

# Positions are found to round-off times the conditioning of their stiffness; those that differ, differ by much more.
SAME = 1e-4

BALL = """
&mechanism links=2, coordinates=3 /
&structure cq=1, 2, 3 /
&pair coordinates=1, 2, 3, links=1,2, kind='spherical', point=0,0,0 /
&initial coordinate=1, position=0.2 /
&initial coordinate=2, position=0.1 /
&initial coordinate=3, position=0.3 /
"""
# the same ball as three hinges, with links that bear nothing
HINGES = """
&mechanism links=4, coordinates=3 /
&structure cq=1, 2, 3 /
&pair coordinate=1, links=1,3, kind='revolute', axis=1,0,0 /
&pair coordinate=2, links=3,4, kind='revolute', axis=0,1,0 /
&pair coordinate=3, links=4,2, kind='revolute', axis=0,0,1 /
&initial coordinate=1, position=0.2 /
&initial coordinate=2, position=0.1 /
&initial coordinate=3, position=0.3 /
"""
FREE = """
&mechanism links=2, coordinates=6 /
&structure cq=1, 2, 3, 4, 5, 6 /
&pair coordinates=1, 2, 3, 4, 5, 6, links=1,2, kind='free' /
&initial coordinate=1, position=0.1 /
&initial coordinate=2, position=0.1 /
&initial coordinate=3, position=0.1 /
&initial coordinate=4, position=0.2 /
&initial coordinate=5, position=0.1 /
&initial coordinate=6, position=0.3 /
&load kind='coordinate', coordinate=1, stiffness=50 /
&load kind='coordinate', coordinate=2, stiffness=60 /
&load kind='coordinate', coordinate=3, stiffness=70 /
"""
BODY = """
&body link=2, mass=1.3, centre=0.1,0.2,-0.15, inertia=0.1,0.12,0.09,0,0,0 /
&gravity acceleration=0,0,-9.81 /
&load kind='spring', links=1,2, position=0.5,0.2,0.1, second_position=0.3,0.1,0.2, stiffness=20, free_length=0.1 /
&load kind='spring', links=1,2, position=-0.3,0.4,0.2, second_position=-0.1,0.3,0.1, stiffness=15, free_length=0.2 /
&time start=0, end=1, intervals=1 /
"""


def about(axis, angle):
    i, j = (axis + 1) % 3, (axis + 2) % 3
    r = np.eye(3)
    r[i, i] = r[j, j] = math.cos(angle)
    r[i, j], r[j, i] = -math.sin(angle), math.sin(angle)
    return r


def rotation(angles):
    return about(0, angles[0]) @ about(1, angles[1]) @ about(2, angles[2])


def equilibria(program, folder, text, starts):
    (folder / 'case.nml').write_text(text, encoding='utf-8')
    done = run(program, folder / 'case.nml', '--equilibrium', '--starts', str(starts), '--report', folder / 'report.json', folder=folder)
    if done.returncode:
        raise RuntimeError(done.stderr)
    with open(folder / 'report.json', encoding='utf-8') as file:
        return json.load(file)['equilibria']


def check_rows(checks, rows, balls, starts, why):
    """No two rows are the same position, and all starts that led to one are counted there."""
    def apart(one, other):
        distance = 0.0
        inside = set(itertools.chain(*balls))
        for k, (a, b) in enumerate(zip(one, other)):
            if k not in inside:
                distance = max(distance, abs(a - b))
        for ball in balls:
            distance = max(distance, np.max(np.abs(rotation([one[k] for k in ball]) - rotation([other[k] for k in ball]))))
        return distance

    for one, other in itertools.combinations(range(len(rows)), 2):
        checks.true(apart(rows[one]['q'], rows[other]['q']) > SAME, f'{why}: rows {one + 1} and {other + 1} are two positions',
                    (rows[one]['q'], rows[other]['q']))
    checks.true(sum(row['starts'] for row in rows) <= starts + 1, f'{why}: each start leads to one row')
    return rows


def test_ball_with_springs(checks, mech9d, tmp_path):
    rows = check_rows(checks, equilibria(mech9d, tmp_path, BALL + BODY, 60), [(0, 1, 2)], 60, 'ball')
    # a function on the rotations has as many maxima and minima as Morse's inequalities ask for: 1, 1, 1, 1 critical points of each
    # index at least, and their alternating sum is zero
    checks.true(len(rows) >= 4 and len(rows) % 2 == 0, 'an even number of equilibria, four at least', len(rows))
    checks.true(sum(row['stable'] for row in rows) >= 1, 'one of them is stable')


def test_ball_of_three_hinges(checks, mech9d, tmp_path):
    rows = check_rows(checks, equilibria(mech9d, tmp_path, HINGES + BODY, 60), [(0, 1, 2)], 60, 'hinges')
    ball = equilibria(mech9d, tmp_path, BALL + BODY, 60)
    checks.equal(len(rows), len(ball), 'as many as of a ball')


def test_free_link_with_springs(checks, mech9d, tmp_path):
    rows = check_rows(checks, equilibria(mech9d, tmp_path, FREE + BODY, 40), [(3, 4, 5)], 40, 'free link')
    checks.true(len(rows) >= 2, 'there are equilibria', len(rows))


ROD = """
&mechanism links=4, coordinates=7 /
&structure cq=1 /
&pair coordinate=1, links=1,2, kind='revolute', axis=0,0,1, point=0,0,0 /
&pair coordinates=2, 3, links=2,3, kind='universal', axis=0,0,1, moving_axis=0.4,-0.5,0, point=0.4,0.1,0 /
&pair coordinates=4, 5, 6, links=3,4, kind='spherical', point=0.9,0.5,0.3 /
&pair coordinate=7, links=1,4, kind='revolute', axis=0.3,1,0, point=1.2,0.1,-0.1 /
&initial coordinate=1, position=0.2 /
&body link=2, mass=1, centre=0.2,0.1,0, inertia=0.01,0.01,0.01,0,0,0 /
&body link=4, mass=1, centre=1.0,0.3,0.2, inertia=0.01,0.01,0.01,0,0,0 /
&gravity acceleration=2,0,-9.81 /
&load kind='spring', links=1,4, position=0.5,0.2,0.6, second_position=0.9,0.5,0.3, stiffness=20, free_length=0.1 /
&time start=0, end=1, intervals=1 /
"""


def test_rod_between_ball_and_universal_joint(checks, mech9d, tmp_path):
    """The rod has no mass: whether it has turned about its line, nobody sees. A point beside the line, or a body, shows it."""
    plain = equilibria(mech9d, tmp_path, ROD, 60)
    rows = [(row['q'][0], row['q'][6]) for row in plain]
    for one, other in itertools.combinations(range(len(rows)), 2):
        apart = max(abs(math.remainder(a - b, 2 * math.pi)) for a, b in zip(rows[one], rows[other]))
        checks.true(apart > SAME, f'rows {one + 1} and {other + 1} have crank or rocker in another position', rows)
    for more in ("&point name='P', link=3, position=0.5,0.5,0.5 /\n",
                 "&body link=3, mass=1e-9, centre=0.5,0.5,0.5, inertia=1e-9,1e-9,1e-9,0,0,0 /\n"):
        marked = equilibria(mech9d, tmp_path, ROD + more, 60)
        checks.true(len(marked) > len(plain), 'a mark beside the line tells two settings apart', (len(marked), len(plain)))
    # the point on the line does not move
    marked = equilibria(mech9d, tmp_path, ROD + "&point name='P', link=3, position=0.65,0.3,0.15 /\n", 60)
    checks.equal(len(marked), len(plain), 'a mark on the line tells nothing')
