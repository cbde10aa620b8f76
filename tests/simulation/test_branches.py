"""Branches of positions over a parameter against closed forms and against equations written in numpy: folds of an inclined spring and of a
truss, pitchforks, Hopf points of Ziegler's pendulum, closed branches, dead points of the chosen coordinate, stops; bad requests.

Compares the program with itself: a four-bar by two independent coordinates."""
import json
from math import acos, cos, pi, sin, sqrt

import numpy as np
import pytest

import branch_cases
from mech9_cases import read_table, run

# a spring of k=100, l0=1 from (0.8, 0) to a slider at (0, q1), pushed down by F
SPRING = """&structure cq=1 /
&pair coordinate=1, links=1,2, kind='prismatic', axis=0,1,0 /
&body link=2, mass=1 /
&load kind='spring', links=1,2, position=0.8,0,0, stiffness=100, free_length=1, damping=0.5 /
&load kind='force', link=2, force=0,0,0 /
&parameter name='F', sets='load(2).force(2)', factors=-1, value=0, low=-8, high=8 /
&initial coordinate=1, position=0.6 /
"""
FOLD = 5.139077831551
# half of a von Mises truss as a closed chain: a bar that slides along itself against a spring
TRUSS = """&structure cq=1 /
&pair coordinate=1, links=1,2, kind='revolute', axis=0,0,1, point=-0.8,0,0 /
&pair coordinate=2, links=2,3, kind='prismatic', axis=0.8,0.6,0, point=-0.4,0.3,0 /
&pair coordinate=3, links=3,4, kind='revolute', axis=0,0,1, point=0,0.6,0 /
&pair coordinate=4, links=1,4, kind='prismatic', axis=0,1,0 /
&body link=4, mass=1 /
&load kind='coordinate', coordinate=2, stiffness=100, damping=0.5 /
&load kind='force', link=4, position=0,0.6,0, force=0,0,0 /
&parameter name='F', sets='load(2).force(2)', factors=-1, value=0, low=-8, high=8 /
&initial coordinate=1, position=0 /
"""
# an inverted pendulum of length 2 with a torsion spring of 7 under a vertical load P
PITCHFORK = """&structure cq=1 /
&pair coordinate=1, links=1,2, kind='revolute', axis=0,0,1 /
&body link=2, mass=1, centre=0,2,0, inertia=0,0,0.1,0,0,0 /
&load kind='coordinate', coordinate=1, stiffness=7, damping=0.3 /
&load kind='force', link=2, position=0,2,0, force=0,-1,0 /
&parameter name='P', sets='load(2).force(2)', factors=-1, value=1, low=0, high=10 /
&initial coordinate=1, position=0 /
"""
ZIEGLER = branch_cases.ZIEGLER + """&parameter name='P', sets='load(3).force(1)', factors=-1, value=0.1, low=0, high=4 /
&initial coordinate=1, position=0 /
&initial coordinate=2, position=0 /
"""
GOVERNOR = """&structure cq=1,2 /
&pair coordinate=1, links=1,2, kind='revolute', axis=0,0,1 /
&pair coordinate=2, links=2,3, kind='revolute', axis=0,1,0 /
&body link=3, mass=2, centre=0,0,-0.5 /
&gravity acceleration=0,0,-9.81 /
&drive coordinate=1, kind='polynomial', coefficients=0,2 /
&load kind='coordinate', coordinate=2, damping=0.1 /
&parameter name='w', sets='drive(1).coefficients(2)', value=2, low=0, high=12 /
&initial coordinate=2, position=0 /
"""
TORQUE = """&structure cq=1 /
&pair coordinate=1, links=1,2, kind='revolute', axis=0,0,1 /
&body link=2, mass=2, centre=0,-0.5,0 /
&gravity acceleration=0,-9.81,0 /
&load kind='coordinate', coordinate=1, damping=0.1 /
&load kind='torque', link=2, torque=0,0,0 /
&parameter name='T', sets='load(2).torque(3)', value=1, low=-20, high=20 /
&initial coordinate=1, position=0 /
"""
FOUR_BAR = '&structure cq=1 /\n' + branch_cases.FOUR_BAR
# the same chain by its rocker: dead points where crank 0.2 and coupler 0.5 are in line
ROCKER = """&structure cq=4 /
&pair coordinate=1, links=1,2, kind='revolute', axis=0,0,1 /
&pair coordinate=2, links=2,3, kind='revolute', point=0.2,0,0, axis=0,0,1 /
&pair coordinate=3, links=3,4, kind='revolute', point=0.7,0,0, axis=0,0,1, moving_point=1,0,0 /
&pair coordinate=4, links=1,4, kind='revolute', point=0.6,0,0, axis=0,0,1 /
&initial coordinate=1, position=1 /
&drive coordinate=4, kind='polynomial', coefficients=2.1,1 /
&parameter name='angle', sets='drive(1).coefficients(1)', value=2.1, low=-4, high=4 /
"""


def go(program, folder, text, name, groups='', code=0, more=()):
    """Report, table and standard error of --branch."""
    path, report, table = folder / 'branch.nml', folder / 'branch.json', folder / 'branch.dat'
    path.write_text(text + groups, encoding='utf-8')
    done = run(program, path, '--branch', name, '--report', report, '--table', table, *more)
    assert done.returncode == code, done.stderr
    return json.loads(report.read_text()), read_table(table.read_text()) if code == 0 else None, done.stderr


def points(report, branch=1):
    """(type, value) of the special points of a branch."""
    return [(point['type'], point['value']) for point in report['branches'][branch - 1]['special_points']]


def of_branch(table, number):
    """The rows of one branch."""
    return {name: column[table['branch'] == number] for name, column in table.items()}


def spring_force(y):
    """F that holds the inclined spring at a height."""
    length = np.sqrt(0.64 + y**2)
    return -100 * (length - 1) * y / length


def growth(mass, damping, stiffness):
    """Largest real part of the roots of mass x'' + damping x' + stiffness x = 0."""
    return np.max(np.real([np.roots([mass, c, k]) for c, k in zip(damping, stiffness)]), axis=1)


def test_inclined_spring(checks, mech9d, tmp_path):
    """The whole branch of an inclined spring: forces, growth, two folds, and both ends."""
    report, table, said = go(mech9d, tmp_path, SPRING, 'F')
    y, length = table['q1'], np.sqrt(0.64 + table['q1']**2)
    # tolerance: Newton's method to round-off, times forces of 100 N/m
    checks.near(table['F'], spring_force(y), 1e-12, 'forces', scale=100)
    checks.near(table['growth'], growth(1, 0.5 * (y / length)**2, 100 * (1 - 0.64 / length**3)), 1e-9, 'growth', scale=1)
    checks.equal([kind for kind, _ in points(report)], [1, 1], 'two folds')
    checks.near([value for _, value in points(report)], [FOLD, -FOLD], 1e-12, 'their forces', scale=1)
    checks.near([point['q'][0] for point in report['branches'][0]['special_points']], [sqrt(0.64**(2 / 3) - 0.64), -sqrt(0.64**(2 / 3) - 0.64)],
                1e-9, 'their heights')
    checks.equal((report['branches'][0]['ends'], report['branches'][0]['closed']), (['low', 'high'], False), 'ends')
    checks.near([table['F'][0], table['F'][-1]], [-8, 8], 0, 'limits are met exactly', scale=1)
    checks.equal(table['point'].tolist(), list(range(1, len(y) + 1)), 'points count from 1')
    checks.true('fold at F = 5.13907783155' in said and 'begins at low=-8' in said, 'words', said)
    checks.true(np.all(np.diff(y) < 0), 'points follow each other along the branch')


def test_truss(checks, mech9d, tmp_path):
    """The same in a closed chain: all coordinates in closed form; a range and a step of the group."""
    report, table, _ = go(mech9d, tmp_path, TRUSS, 'F', "&branch parameter='F', low=-6, high=7, step=0.03 /\n")
    y = table['q4'] + 0.6
    checks.near(table['F'], spring_force(y), 1e-11, 'forces', scale=100)
    checks.near(table['q2'], np.sqrt(0.64 + y**2) - 1, 1e-12, 'lengths', scale=1)
    checks.near(table['q1'], np.arctan2(y, 0.8) - np.arctan2(0.6, 0.8), 1e-12, 'angles', scale=1)
    checks.near([value for _, value in points(report)], [FOLD, -FOLD], 1e-11, 'folds', scale=1)
    checks.near([table['F'][0], table['F'][-1]], [-6, 7], 0, 'the range of the group', scale=1)
    coarse, _, _ = go(mech9d, tmp_path, TRUSS, 'F', "&branch parameter='F', low=-6, high=7, step=0.1 /\n")
    checks.true(coarse['branches'][0]['points'] < 0.6 * report['branches'][0]['points'], 'longer steps, fewer points')


def test_pitchfork(checks, mech9d, tmp_path):
    """An inverted pendulum: the branch that breaks the symmetry is P l sin q = k q; growth tells stability."""
    report, table, _ = go(mech9d, tmp_path, PITCHFORK, 'P')
    checks.equal(len(report['branches']), 2, 'two branches')
    checks.near([value for _, value in points(report)], [3.5], 1e-12, 'the branch point', scale=1)
    checks.equal([kind for kind, _ in points(report)], [2], 'its type')
    straight, bent = of_branch(table, 1), of_branch(table, 2)
    checks.near(straight['q1'], 0, 1e-15, 'the straight branch', scale=1)
    inertia = 4.1
    checks.near(straight['growth'], growth(inertia, 0 * straight['P'] + 0.3, 7 - 2 * straight['P']), 1e-7, 'its growth', scale=1)
    checks.near(2 * bent['P'] * np.sin(bent['q1']), 7 * bent['q1'], 1e-11, 'the bent branch', scale=1)
    checks.true(bent['q1'][0] * bent['q1'][-1] < 0 and abs(bent['q1']).max() > 2, 'both of its halves', bent['q1'])
    checks.near([bent['P'][0], bent['P'][-1]], [10, 10], 0, 'they end at high', scale=1)
    checks.true(np.all(bent['growth'][np.abs(bent['q1']) > 1e-3] < 0), 'the bent branch is stable')
    report, _, _ = go(mech9d, tmp_path, PITCHFORK, 'P', "&branch parameter='P', switch=.false. /\n")
    checks.equal((len(report['branches']), len(points(report))), (1, 1), 'without the other branch')


def test_governor(checks, mech9d, tmp_path):
    """A pendulum on a turning shaft: cos q = g/(w^2 l) over the speed of a drive."""
    report, table, _ = go(mech9d, tmp_path, GOVERNOR, 'w')
    checks.near([value for _, value in points(report)], [sqrt(9.81 / 0.5)], 1e-12, 'the speed at which it rises', scale=1)
    risen = of_branch(table, 2)
    checks.near(np.cos(risen['q2']), 9.81 / (0.5 * risen['w']**2), 1e-11, 'the angles', scale=1)


@pytest.mark.parametrize('c', [0.01, 0.1, 0.4])
def test_ziegler(checks, mech9d, tmp_path, c):
    """Ziegler's pendulum: flutter at P = 41/28 + c^2/2, far below that without damping."""
    report, table, _ = go(mech9d, tmp_path, ZIEGLER % (c, c), 'P')
    checks.equal([kind for kind, _ in points(report)], [3], 'one Hopf point')
    # tolerance: round-off of roots over their rate of change, which is slow for weak damping
    checks.near([value for _, value in points(report)], [41 / 28 + c**2 / 2], 1e-9, 'its load', scale=1)
    # in absolute angles
    inertia = np.array([[3.0, 1.0], [1.0, 1.0]])
    for load, value in zip(table['P'][::5], table['growth'][::5]):
        stiffness = np.array([[2 - load, load - 1], [-1, 1]])
        damping = c * np.array([[2, -1], [-1, 1]])
        a = np.block([[np.zeros((2, 2)), np.eye(2)], [-np.linalg.solve(inertia, stiffness), -np.linalg.solve(inertia, damping)]])
        checks.near([value], [np.linalg.eigvals(a).real.max()], 1e-6, f'growth at P = {load}', scale=1)


def test_flutter_without_damping(checks, mech9d, tmp_path):
    """Two frequencies meet at P = 7/2 - sqrt(2): the growth begins there."""
    critical = 3.5 - sqrt(2)
    # points of other steps lie on other sides of the place, by round-off
    for value in (1.6, 1.0, 0.7, 0.1):
        text = (ZIEGLER % (0.0, 0.0)).replace('value=0.1', f'value={value}')
        report, table, _ = go(mech9d, tmp_path, text, 'P')
        checks.near([at for _, at in points(report)][:1], [critical], 1e-9, f'the load, from {value} on', scale=1)
    checks.near(table['growth'][table['P'] < critical - 1e-6], 0, 1e-7, 'no growth before', scale=1)


def test_closed_branch(checks, mech9d, tmp_path):
    """A pendulum under a torque: T = m g l sin q closes after a turn, with folds at both extremes."""
    report, table, said = go(mech9d, tmp_path, TORQUE, 'T')
    checks.equal((report['branches'][0]['closed'], report['branches'][0]['ends']), (True, ['closed', 'closed']), 'it is closed')
    checks.near(table['T'], 9.81 * np.sin(table['q1']), 1e-12, 'torques', scale=10)
    checks.near(sorted(value for _, value in points(report)), [-9.81, 9.81], 1e-12, 'folds', scale=10)
    checks.near([table['T'][-1], abs(table['q1'][-1] - table['q1'][0])], [table['T'][0], 2 * pi], 1e-14, 'it ends where it began', scale=1)
    checks.true('it is closed, q1 has turned 1 time' in said, 'words', said)


def four_bar_gaps(q):
    """Closure of FOUR_BAR, and its derivatives by q1, q2, q4."""
    a, b, d = q[0], q[0] + q[1], q[3]
    gap = [0.5 * cos(a) + 0.7 * cos(b) - 1 - 0.6 * cos(d), 0.5 * sin(a) + 0.7 * sin(b) - 0.1 - 0.6 * sin(d)]
    rows = [[-0.5 * sin(a) - 0.7 * sin(b), -0.7 * sin(b), 0.6 * sin(d)], [0.5 * cos(a) + 0.7 * cos(b), 0.7 * cos(b), -0.6 * cos(d)]]
    return gap, np.array(rows)


def test_dead_points_of_the_coordinate(checks, mech9d, tmp_path):
    """A four-bar passes dead points of its crank: closure and virtual work of each point, in numpy."""
    report, table, _ = go(mech9d, tmp_path, FOUR_BAR, 'T')
    main = of_branch(table, 1)
    worst, turned = 0.0, []
    for i in range(len(table['T'])):
        q = [table[f'q{k}'][i] for k in range(1, 5)]
        gap, rows = four_bar_gaps(q)
        # rates of q1, q2, q4 that keep the chain closed
        rates = np.cross(rows[0], rows[1])
        work = table['T'][i] * rates[1] - 10 * (q[3] - 2) * rates[2]
        worst = max(worst, abs(gap[0]), abs(gap[1]), abs(work))
        if table['branch'][i] == 1:
            turned.append(rates[0])
    checks.true(worst < 1e-10, 'closed, and in equilibrium', worst)
    checks.true(min(turned) * max(turned) < 0, 'the crank passes dead points', (min(turned), max(turned)))
    slopes = np.diff(main['T'])
    checks.equal(sum(kind == 1 for kind, _ in points(report)) > 0, bool(min(slopes) * max(slopes) < 0), 'folds where the torque turns back')
    other, again, _ = go(mech9d, tmp_path, FOUR_BAR.replace('cq=1', 'cq=4'), 'T')
    checks.near(sorted(value for _, value in points(other)), sorted(value for _, value in points(report)), 1e-9, 'by another coordinate')
    checks.true(len(again['T']) > 50, 'points')


def test_positions(checks, mech9k, tmp_path):
    """Positions of a chain over the angle of its drive: dead points are folds, and the branch is closed."""
    report, table, _ = go(mech9k, tmp_path, ROCKER, 'angle')
    checks.near(table['angle'], table['q4'], 1e-12, 'the parameter is the angle', scale=1)
    limits = sorted(acos((reach**2 - 0.52) / 0.48) for reach in (0.7, 0.3))
    checks.equal([kind for kind, _ in points(report)], [1, 1], 'two dead points')
    checks.near(sorted(value for _, value in points(report)), limits, 1e-11, 'their angles', scale=1)
    checks.true(report['branches'][0]['closed'] and report['branches'][0]['of'] == 'position', 'the branch is closed', report['branches'])
    x = 0.2 * np.cos(table['q1']) + 0.5 * np.cos(table['q1'] + table['q2']) - 0.6 - 0.4 * np.cos(table['q4'])
    y = 0.2 * np.sin(table['q1']) + 0.5 * np.sin(table['q1'] + table['q2']) - 0.4 * np.sin(table['q4'])
    checks.near(np.hypot(x, y), 0, 1e-11, 'the chain is closed', scale=1)
    checks.equal(list(table)[-1], 'type', 'no growth')


def test_double_branch_point(checks, mech9d, tmp_path):
    """Equal springs in both directions: two roots cross at once, and the point is told, but no branch is followed."""
    text = ("&structure cq=1,2 /\n&pair coordinate=1, links=1,2, kind='revolute', axis=1,0,0 /\n"
            "&pair coordinate=2, links=2,3, kind='revolute', axis=0,0,1 /\n&body link=3, mass=1, centre=0,1,0 /\n"
            "&load kind='coordinate', coordinate=1, stiffness=3, damping=0.1 /\n&load kind='coordinate', coordinate=2, stiffness=%s, damping=0.1 /\n"
            "&load kind='force', link=3, position=0,1,0, force=0,0,0 /\n&initial coordinate=1, position=0 /\n&initial coordinate=2, position=0 /\n"
            "&parameter name='P', sets='load(3).force(2)', factors=-1, value=0.05, low=0, high=8 /\n")
    report, _, said = go(mech9d, tmp_path, text % 3, 'P')
    checks.equal([kind for kind, _ in points(report)], [2], 'one branch point')
    checks.near([value for _, value in points(report)], [3], 1e-9, 'its load', scale=1)
    checks.equal((len(report['branches']), report['branch_points_left_out']), (1, 1), 'no branch is followed')
    checks.true('no branch was followed from 1 branch point' in said, 'words', said)
    report, table, _ = go(mech9d, tmp_path, text % 4, 'P')
    checks.near([value for _, value in points(report)], [3, 4], 1e-11, 'apart, both are simple', scale=1)
    # beside the straight one, a turn about x under P sin q = 3 q, one about z under P sin q = 4 q, and those that join them
    checks.equal(len(report['branches']), 5, 'all branches')
    first = of_branch(table, 2)
    checks.near(first['P'] * np.sin(first['q1']), 3 * first['q1'], 1e-11, 'the first one', scale=1)


def test_ends(checks, mech9d, tmp_path):
    """Branches end at stops, after so many points, and where a number has no sense."""
    report, table, said = go(mech9d, tmp_path, SPRING, 'F', '&stop coordinate=1, low=0.4 /\n')
    checks.equal(report['branches'][0]['ends'], ['low', 'stop'], 'a rigid stop ends it')
    checks.near([table['q1'][-1]], [0.4], 1e-12, 'at the stop')
    checks.true('ends at a rigid stop' in said, 'words', said)
    report, table, _ = go(mech9d, tmp_path, SPRING, 'F', "&branch parameter='F', points=7 /\n")
    checks.equal((report['branches'][0]['ends'], len(table['F'])), (['points', 'points'], 13), 'points in each direction')
    # a spring of no negative stiffness
    report, _, said = go(mech9d, tmp_path, SPRING.replace("sets='load(2).force(2)', factors=-1, value=0", "sets='load(1).stiffness', value=50")
                             .replace('high=8', 'high=80'), 'F')
    checks.true(report['branches'][0]['ends'][0] == 'no convergence' and 'stiffness' in said, 'where the data file would be wrong', said)


def test_without_inertia(checks, mech9d, tmp_path):
    """Without masses growth has no value, and the branch is the same."""
    report, table, _ = go(mech9d, tmp_path, SPRING.replace('&body link=2, mass=1 /', ''), 'F')
    checks.near([value for _, value in points(report)], [FOLD, -FOLD], 1e-12, 'folds', scale=1)
    checks.true(np.all(np.isnan(table['growth'])), 'no growth')


def test_plots(checks, mech9d, tmp_path):
    """A picture with stable and unstable positions and marks; a wrong name is found before the work."""
    picture = tmp_path / 'snap.svg'
    _, _, said = go(mech9d, tmp_path, SPRING, 'F', more=('--plot', f'{picture}:q1,F:growth'))
    checks.true('plot: ' in said, 'words', said)
    script = (tmp_path / 'snap.gp').read_text()
    for words in ('$stable_1', '$unstable_1', '$kind_1_1', "title 'fold'", 'dashtype 2', "set xlabel 'F [N]'", "set ylabel 'growth [1/s]'"):
        checks.true(words in script, words, script[:2000])
    checks.true('$kind_2' not in script, 'no marks of other points')
    _, _, said = go(mech9d, tmp_path, SPRING, 'F', code=2, more=('--plot', f'{picture}:q7'))
    checks.true('q7' in said, 'a wrong name', said)


def test_several_groups(checks, mech9d, tmp_path):
    """Two groups of one parameter are followed in one run; HDF5 has the rows."""
    h5py = pytest.importorskip('h5py')
    path = tmp_path / 'branch.h5'
    report, table, _ = go(mech9d, tmp_path, SPRING, 'F', "&branch parameter='F', high=3 /\n&branch parameter='F', of='position' /\n",
                          more=('--hdf5', str(path)))
    checks.equal([branch['of'] for branch in report['branches']], ['equilibrium', 'position'], 'branches of both groups')
    checks.near(of_branch(table, 2)['q1'], 0.6, 1e-15, 'the position does not depend on the force')
    with h5py.File(path) as file:
        checks.equal(sorted(file['branches']), sorted([*table, 'row']), 'data sets')
        checks.near(file['branches/F'][()], table['F'], 0, 'their numbers', scale=1)
        checks.equal(file['branches/F'].attrs['units'] if 'units' in file['branches/F'].attrs else 'N', 'N', 'units')


BAD = [
    (SPRING, 'G', '', 2, "there is no parameter 'G'; those of the data file are F"),
    (SPRING.replace(', low=-8, high=8', ''), 'F', '', 3, "the parameter 'F' has no range"),
    (SPRING.replace(', low=-8, high=8', ''), 'F', "&branch parameter='F', low=1 /\n", 3, "the parameter 'F' has no range"),
    (SPRING, 'F', "&branch parameter='F', low=1 /\n", 3, 'outside its range, 1 to 8'),
    (SPRING, 'F', "&branch parameter='F', low=9, high=1 /\n", 3, 'needs high larger than low'),
    (SPRING, 'F', "&branch parameter='F', of='periodic' /\n", 3, 'no drive, load or motor follows time'),
    (SPRING.replace("kind='spring', links=1,2, position=0.8,0,0, stiffness=100, free_length=1, damping=0.5", "kind='force', link=2, force=0,3,0"),
     'F', '', 5, 'no position of equilibrium was found'),
    (SPRING + "&drive coordinate=1, kind='polynomial', coefficients=0.6 /\n", 'F', "&branch parameter='F', of='equilibrium' /\n", 3,
     'every independent coordinate is driven'),
    (SPRING + "&motor coordinate=1, kind='dc', voltage=1, resistance=1, inductance=1, constant=1 /\n", 'F', '', 3, 'a state of its own'),
    (PITCHFORK.replace('value=1,', 'value=3.5,'), 'P', '', 6, 'at the start branches meet'),
    (SPRING.replace("name='F'", "name='growth'"), 'growth', '', 3, 'give the parameter another name'),
]


@pytest.mark.parametrize('case', BAD, ids=[case[4][:24] for case in BAD])
def test_bad_requests(checks, mech9d, tmp_path, case):
    """Each ends with its code, and a message that has a remedy."""
    text, name, groups, code, words = case
    _, _, said = go(mech9d, tmp_path, text, name, groups, code)
    checks.true(words in said, 'message', said)
    checks.true(code == 2 or 'branch.nml:' in said, 'place', said)


@pytest.mark.parametrize('option', [['--equilibrium'], ['--study'], ['--animate', 'a.gif'], ['--exponents', '1'], ['--starts', '3']])
def test_options(checks, mech9d, tmp_path, option):
    """Options that have no meaning beside --branch are refused."""
    path = tmp_path / 'spring.nml'
    path.write_text(SPRING, encoding='utf-8')
    done = run(mech9d, path, '--branch', 'F', *option)
    checks.true(done.returncode == 2 and '--branch' in done.stderr, option[0], done.stderr)
