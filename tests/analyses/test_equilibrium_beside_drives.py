"""Positions of equilibrium beside a drive that moves: the free coordinates that rest are those of the data file.

Random five-bars have one driven and one free coordinate. mech9k, in which the free coordinate has a drive that holds it, gives the
force of this drive by inverse dynamics. In equilibrium it is zero, and its differences tell the roots of small free motions.
"""
import json
import math

import numpy as np

from mech9_cases import run, read_table, text_of

BARS = 60
# The search ends at round-off of the loads times the conditioning of the chain, which is 1e-4 or better where the coordinates are
# those of the data file; the position in the report has all digits.
BALANCE = 1e-9
# Central differences with a step of 1e-4: the error is some 1e-8 of the third derivative, which grows near dead points.
STEP = 1e-4

FIVE_BAR = """
&mechanism links=5, coordinates=5 /
&structure cq=1, {free} /
&pair coordinate=1, links=1,2, kind='revolute', axis=0,0,1, point=0,0,0 /
&pair coordinate=2, links=2,3, kind='revolute', axis=0,0,1, point={b[0]!r},{b[1]!r},0 /
&pair coordinate=3, links=3,4, kind='revolute', axis=0,0,1, point={c[0]!r},{c[1]!r},0 /
&pair coordinate=4, links=4,5, kind='revolute', axis=0,0,1, point={d[0]!r},{d[1]!r},0 /
&pair coordinate=5, links=1,5, kind='revolute', axis=0,0,1, point={e[0]!r},{e[1]!r},0 /
&gravity acceleration=0,-9.81,0 /
&load kind='coordinate', coordinate=3, stiffness={spring!r}, rest=0.2 /
&time start=0, end=1, intervals=1 /
"""


def five_bar(random):
    """The data file without its motion, its free coordinate, and the motion of its drive."""
    places = np.array([[0.0, 0.5], [0.6, 1.1], [1.3, 0.6], [1.2, 0.0]]) + random.uniform(-0.25, 0.25, (4, 2))
    b, c, d, e = places.tolist()
    free = int(random.integers(2, 6))
    text = FIVE_BAR.format(free=free, b=b, c=c, d=d, e=e, spring=float(random.uniform(0, 3)))
    for link in 2, 3, 4, 5:
        centre = random.uniform(0, 1, 2).tolist()
        text += f'&body link={link}, mass={random.uniform(0.2, 2)!r}, centre={centre[0]!r},{centre[1]!r},0, ' \
                f'inertia=0.1,0.1,{random.uniform(0.02, 0.1)!r},0,0,0 /\n'
    rate, acceleration = [(1, 0), (0, 2), (2, 1)][int(random.integers(3))]
    return text, free, f'0, {rate}, {0.5 * acceleration}'


def held_force(mech9k, folder, text, free, drive, q, position=0.0, rate=0.0, acceleration=0.0):
    """The force that holds the free coordinate beside a position, and the largest angle by which the mechanism is not there."""
    case = text + f"&drive coordinate=1, kind='polynomial', coefficients={drive} /\n"
    case += f"&drive coordinate={free}, kind='polynomial', coefficients={float(q[free - 1] + position)!r}, {rate!r}, {acceleration / 2!r} /\n"
    for k in range(2, 6):
        if k != free:
            case += f'&initial coordinate={k}, position={float(q[k - 1])!r} /\n'
    path = folder / 'held.nml'
    path.write_text(case.replace('end=1, intervals=1', 'end=0, intervals=0') + '&output drive_forces=.true. /\n', encoding='utf-8')
    done = run(mech9k, path, '--table', folder / 'held.dat', folder=folder)
    if done.returncode:
        return math.nan, math.inf
    table = read_table(text_of(folder / 'held.dat'))
    off = max(abs(math.remainder(table[f'q{k}'][0] - q[k - 1], 2 * math.pi)) for k in range(2, 6))
    return table[f'F{free}'][0], off


def test_free_coordinate_of_the_file_rests(checks, mech9k, mech9d, tmp_path):
    random = np.random.default_rng(20)
    found = stable = judged = 0
    for number in range(BARS):
        text, free, drive = five_bar(random)
        path = tmp_path / 'free.nml'
        path.write_text(text + f"&drive coordinate=1, kind='polynomial', coefficients={drive} /\n"
                        f'&initial coordinate={free}, position=0 /\n', encoding='utf-8')
        done = run(mech9d, path, '--equilibrium', '--report', tmp_path / 'report.json', '--quiet', folder=tmp_path)
        checks.true(done.returncode in (0, 5, 6), f'five-bar {number}: an equilibrium or none', done.stderr)
        if done.returncode:
            continue
        found += 1
        with open(tmp_path / 'report.json', encoding='utf-8') as file:
            equilibrium = json.load(file)['equilibria'][0]
        q = equilibrium['q']

        def force(*motion):
            return held_force(mech9k, tmp_path, text, free, drive, q, *motion)

        balance, off = force()
        mass = force(0.0, 0.0, 1.0)[0] - balance
        sides = [force(STEP)[0], force(-STEP)[0]]
        stiffness = (sides[0] - sides[1]) / (2 * STEP)
        damping = (force(0.0, STEP)[0] - force(0.0, -STEP)[0]) / (2 * STEP)
        if not checks.true(off < 1e-8, f'five-bar {number}: mech9k stands in the same position', off):
            continue
        # forces of the terms that cancel: weights of some newtons beside inertia forces, which the differences show
        scale = 10 + abs(stiffness) + abs(mass) if np.isfinite([stiffness, mass, damping]).all() else 10
        checks.near(balance, 0.0, BALANCE, f'five-bar {number}: no force on the free coordinate', scale=scale)
        if not np.isfinite([stiffness, mass, damping]).all():
            continue        # a dead point is nearer than the step
        roots = np.roots([mass, damping, stiffness])
        growth = max(roots.real)
        if abs(growth) > 1e-3 * max(abs(roots)):
            judged += 1
            checks.equal(equilibrium['stable'], bool(growth < 0), f'five-bar {number}: stability')
            checks.near(equilibrium['growth'], growth, 1e-4, f'five-bar {number}: growth', scale=max(abs(roots)))
        stable += equilibrium['stable']
    checks.true(found >= BARS // 3 and stable >= 5 and judged >= 5, 'enough of them have equilibria', (found, stable, judged))
