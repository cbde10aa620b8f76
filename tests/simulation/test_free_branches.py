"""Branches of periodic motions with a period of their own over a parameter: van der Pol's equation, a fold, running motions and two coupled
sliders against independent integrations; Hopf points at which they end against eigenvalues; refusals."""
import json

import numpy as np
import pytest

import branch_cases
from branch_cases import follow
from mech9_cases import run

SLIDER = """&structure cq=1 /
&pair coordinate=1, links=1,2, kind='prismatic', axis=1,0,0 /
&initial coordinate=1, position=%r, velocity=0 /
&body link=2, mass=1 /
&load kind='coordinate', coordinate=1, stiffness=1 /
&load kind='coordinate', coordinate=1, force=1, law='polynomial', coefficients=0,1, over='dq1' /
&load kind='coordinate', coordinate=1, force=1, law='polynomial', coefficients=%s, over='dq1' /
&parameter name='m', sets='load(2).force', value=%r, low=%r, high=%r /
&branch parameter='m', of='periodic' /
&periodic period=6.5 /
&time end=1 /
"""


def shoot(rates, divergence, x, period, fixed=None, steps=600):
    """The motion x'' = rates(x, x') from a turning point, by shooting with the method of Runge and Kutta, extrapolated (Richardson): its
    start, its period and the integral of the divergence."""
    def cycle(n):
        def go(start, time):
            y, h = np.array([start, 0.0, 0.0]), time/n

            def slope(y):
                return np.array([y[1], rates(y[0], y[1]), divergence(y[0], y[1])])

            for _ in range(n):
                a = slope(y)
                b = slope(y + h/2*a)
                c = slope(y + h/2*b)
                y = y + h/6*(a + 2*b + 2*c + slope(y + h*c))
            return y

        start, time = x, period
        for _ in range(12):
            end = go(start, time)
            d = 1e-6
            by_start = (go(start + d, time) - go(start - d, time))/(2*d)
            matrix = np.array([[by_start[0] - 1, end[1]], [by_start[1], rates(end[0], end[1])]])
            change = np.linalg.solve(matrix, -np.array([end[0] - start, end[1]]))
            start, time = start + change[0], time + change[1]
            if np.abs(change).max() < 1e-11:
                break
        return np.array([start, time, go(start, time)[2]])

    coarse, fine = cycle(steps//2), cycle(steps)
    return fine + (fine - coarse)/15


def test_van_der_pol(checks, mech9d, tmp_path):
    """x'' - (m - x'^2) x' + x = 0 is van der Pol's equation for sqrt(3/m) x'. Its period at m = 1 is known to many digits; motions end at m = 0."""
    rows, branches, said = follow(mech9d, tmp_path, SLIDER % (1.2, '0,0,0,-1', 1.0, -0.5, 2.0), 'm')
    checks.equal([(branch['of'], branch['ends']) for branch in branches], [('periodic', ['Hopf point', 'high'])], 'one branch and its ends')
    at = np.argmin(np.abs(rows['m'] - 1))
    checks.near(rows['m'][at], 1, 1e-14, 'the start')
    checks.near(rows['period'][at], 6.6632868593231301896996820305, 1e-11, 'the period of van der Pol')
    for m in (1.0, 2.0):
        at = np.argmin(np.abs(rows['m'] - m))
        start, period, product = shoot(lambda x, v: (m - v*v)*v - x, lambda x, v: m - 3*v*v, rows['q1'][at], rows['period'][at])
        checks.near([rows['q1'][at], rows['period'][at]], [start, period], 3e-8, f'at m = {m}', scale=1)
        # steps of 0.01 s
        checks.near(rows['growth'][at], product/period, 3e-7, f'growth at m = {m}', scale=1)
    small = (rows['m'] > 0) & (rows['m'] < 0.2)
    m = rows['m'][small]
    # the next term of the series is of eighth order
    checks.near(rows['period'][small], 2*np.pi*(1 + m**2/16 - 5*m**4/3072 - 543*m**6/884736), 2e-8, 'the series', scale=1)
    checks.true(small.sum() > 1, 'small motions', rows['m'])
    last = branches[0]['special_points'][0]
    checks.equal([last['kind'], last['point'], rows['type'][0]], ['Hopf point', 1, 3], 'the end')
    checks.near([last['value'], last['q'][0], last['period'], last['growth']], [0, 0, 2*np.pi, 0], 1e-10, 'at m = 0', scale=1)
    checks.true('begins at a Hopf point' in said and 'period 6.28318530' in said, 'what is told', said)


def test_beside_rest(checks, mech9d, tmp_path):
    """Positions of rest have no period in the table; their Hopf point is that at which the motions end."""
    text = (SLIDER % (0.3, '0,0,0,-1', 0.2, -0.5, 0.3)).replace("&periodic", "&branch parameter='m', of='equilibrium' /\n&periodic")
    rows, branches, _ = follow(mech9d, tmp_path, text, 'm')
    checks.equal([branch['of'] for branch in branches], ['periodic', 'equilibrium'], 'both')
    checks.true(np.isnan(rows['period'][rows['branch'] == 2]).all() and (rows['period'][rows['branch'] == 1] > 6).all(), 'periods', rows['period'])
    points = [branch['special_points'][0] for branch in branches]
    checks.equal([(point['kind'], point['period'] is None) for point in points], [('Hopf point', False), ('Hopf point', True)], 'Hopf points')
    checks.near(points[0]['value'], points[1]['value'], 1e-10, 'they are one', scale=1)


def test_fold(checks, mech9d, tmp_path):
    """x'' - (m + x'^2 - x'^4) x' + x = 0: large stable motions turn back at a fold, and small unstable ones end at m = 0. At the fold the
    derivative of the return map, exp of the integral of the divergence, is 1."""
    rows, branches, _ = follow(mech9d, tmp_path, SLIDER % (1.1, '0,0,0,1,0,-1', 0.0, -0.5, 0.5), 'm')
    checks.equal([[point['kind'] for point in branch['special_points']] for branch in branches], [['Hopf point', 'fold']], 'special points')
    at = int(np.nonzero(rows['type'] == 1)[0][0])
    # along the branch the parameter has its least value at the fold, over the size of the motion
    sizes, values = rows['q1'][at - 3:at + 4], rows['m'][at - 3:at + 4]
    polynomial = np.polyfit(sizes - sizes[3], values, 6)
    turns = np.roots(np.polyder(polynomial))
    checks.near(np.polyval(polynomial, turns[np.argmin(np.abs(turns))].real), rows['m'][at], 1e-8, 'the least value', scale=1)
    checks.near(rows['growth'][at], 0, 1e-9, 'the growth at the fold', scale=1)
    for i in (1, len(rows['m']) - 1):
        m = rows['m'][i]
        start, period, integral = shoot(lambda x, v: (m + v*v - v**4)*v - x, lambda x, v: m + 3*v*v - 5*v**4, rows['q1'][i], rows['period'][i])
        checks.near([rows['q1'][i], rows['period'][i]], [start, period], 3e-8, f'row {i}', scale=1)
        checks.near(rows['growth'][i], integral/period, 1e-6, f'growth of row {i}', scale=1)
    large = np.arange(len(rows['m'])) > at
    checks.true((rows['growth'][large] < 0).all() and (rows['growth'][1:at] > 0).all(), 'stable beyond the fold', rows['growth'])
    checks.near([rows['m'][0], rows['period'][0]], [0, 2*np.pi], 1e-10, 'the Hopf point', scale=1)


def ziegler(load):
    """The eigenvalue of the straight position of Ziegler's pendulum whose real part is largest; angles of both rods, dampers 0.1."""
    turn = np.array([[1.0, 0.0], [1.0, 1.0]])   # absolute angles, in which the mass is simple
    mass, damping = turn.T @ np.array([[3.0, 1.0], [1.0, 1.0]]) @ turn, 0.1*np.eye(2)
    # the load turns with the second rod: its torque on the first one is -load q2
    stiffness = np.eye(2) + np.array([[0, load], [0, 0]])
    zero = np.zeros((2, 2))
    values = np.linalg.eigvals(np.block([[zero, np.eye(2)], [-np.linalg.solve(mass, stiffness), -np.linalg.solve(mass, damping)]]))
    return values[np.argmax(values.real + 1e-12*values.imag)]


def test_flutter(checks, mech9d, tmp_path):
    """The flutter of Ziegler's pendulum begins where its straight position has a pair of eigenvalues without growth."""
    text = branch_cases.ZIEGLER % (0.1, 0.1) + """&parameter name='P', sets='load(3).force(1)', factors=-1, value=1.6 /
&branch parameter='P', low=1.4, high=1.65, of='periodic', step=0.2 /
&initial coordinate=1, position=0 /
&initial coordinate=2, position=0.5 /
&periodic period=11 /
&time end=11, intervals=10 /
"""
    rows, branches, _ = follow(mech9d, tmp_path, text, 'P')
    low, high = 1.0, 2.0
    while high - low > 1e-14:
        middle = (low + high)/2
        low, high = (low, middle) if ziegler(middle).real > 1e-15 else (middle, high)
    last = branches[0]['special_points'][0]
    checks.equal([branch['ends'] for branch in branches], [['Hopf point', 'high']], 'ends')
    checks.near([last['value'], *last['q'], last['growth']], [low, 0, 0, 0], 1e-10, 'the Hopf point', scale=1)
    checks.near(last['period'], 2*np.pi/abs(ziegler(low).imag), 1e-9, 'its period')
    checks.true((rows['growth'][1:] < 0).all(), 'flutter is stable', rows['growth'])


def test_two_sliders(checks, mech9d, tmp_path):
    """A self-excited slider that carries another one: period, start and the largest multiplier beside 1, by Runge and Kutta's method."""
    text = '\n'.join(branch_cases.SLIDERS.split('\n')[:-2]) + """
&initial coordinate=1, position=-1.8 /
&initial coordinate=2, position=0 /
&parameter name='s', sets='load(2).force', value=1, low=0.95, high=1.05 /
&branch parameter='s', of='periodic', points=5 /
&periodic period=6 /
&time end=1 /
"""
    rows, _, _ = follow(mech9d, tmp_path, text, 's')
    at = np.argmin(np.abs(rows['s'] - 1))
    by_position = np.array([[-1.0, 0.5], [1.0, -1.75]])

    def rates(x):
        relative = 0.5*x[1] + 0.1*x[3]
        first = -x[0] + 0.3*x[2] - 0.1*x[2]**3 + relative
        return np.array([x[2], x[3], first, -2.5*relative - first])

    def slopes(x):
        falling = 0.3 - 0.3*x[2]**2
        return np.block([[np.zeros((2, 2)), np.eye(2)], [by_position, np.array([[falling, 0.1], [-falling, -0.35]])]])

    def cycle(x, period, steps):
        matrix, h = np.eye(4), period/steps
        for _ in range(steps):
            a, of_a = rates(x), slopes(x) @ matrix
            y = x + h/2*a
            b, of_b = rates(y), slopes(y) @ (matrix + h/2*of_a)
            y = x + h/2*b
            c, of_c = rates(y), slopes(y) @ (matrix + h/2*of_b)
            y = x + h*c
            d, of_d = rates(y), slopes(y) @ (matrix + h*of_c)
            x = x + h/6*(a + 2*b + 2*c + d)
            matrix = matrix + h/6*(of_a + 2*of_b + 2*of_c + of_d)
        return x, matrix

    def solve(steps):
        # the coordinate that moves most begins at its largest value
        x, period = start.copy(), rows['period'][at]
        for _ in range(8):
            end, matrix = cycle(x, period, steps)
            system = np.zeros((5, 5))
            system[:4, :4], system[:4, 4], system[4, most + 2] = matrix - np.eye(4), rates(end), 1
            change = np.linalg.solve(system, np.append(x - end, -x[most + 2]))
            x, period = x + change[:4], period + change[4]
        values = np.linalg.eigvals(cycle(x, period, steps)[1])
        beside = np.delete(values, np.argmin(np.abs(values - 1)))
        return np.array([x[0], x[1], period, np.log(np.abs(beside).max())/period])

    # rates at the start are not in the table: the motion goes on from a guess of them
    start = np.array([rows['q1'][at], rows['q2'][at], 0.0, 0.0])
    for most in (0, 1):
        coarse, fine = solve(300), solve(600)
        exact = fine + (fine - coarse)/15
        if abs(exact[0] - rows['q1'][at]) < 1e-6:
            break
    checks.near([rows['q1'][at], rows['q2'][at], rows['period'][at], rows['growth'][at]], exact, 1e-8, 'the motion', scale=1)


def test_running_motion(checks, mech9d, tmp_path):
    """A pendulum turns under a torque T with the damping 0.5: over its angle its rate has w w' = T - 0.5 w - sin q."""
    text = """&structure cq=1 /
&pair coordinate=1, links=1,2, kind='revolute', axis=0,0,1 /
&body link=2, mass=1, centre=0,-1,0 /
&gravity acceleration=0,-1,0 /
&initial coordinate=1, position=0.3, velocity=4.5 /
&load kind='coordinate', coordinate=1, damping=0.5 /
&load kind='coordinate', coordinate=1, force=2.5 /
&parameter name='T', sets='load(2).force', value=2.5, low=2, high=3 /
&branch parameter='T', of='periodic' /
&periodic period=1.3 /
&time end=1 /
"""
    rows, branches, _ = follow(mech9d, tmp_path, text, 'T')
    checks.equal([branch['ends'] for branch in branches], [['low', 'high']], 'the whole range')
    first = rows['q1'][0]
    checks.near(rows['q1'], first, 1e-12, 'the start stays')
    for torque, i in ((2.0, 0), (3.0, -1)):
        n, w, time = 400, 2*torque, 0.0
        h = 2*np.pi/n
        for turn in range(40):
            time = 0.0
            for k in range(n):
                q = first + k*h

                def slope(q, w):
                    return (torque - 0.5*w - np.sin(q))/w, 1/w

                a = slope(q, w)
                b = slope(q + h/2, w + h/2*a[0])
                c = slope(q + h/2, w + h/2*b[0])
                d = slope(q + h, w + h*c[0])
                w, time = w + h/6*(a[0] + 2*b[0] + 2*c[0] + d[0]), time + h/6*(a[1] + 2*b[1] + 2*c[1] + d[1])
        # the rate forgets its start by exp(-0.5 t); all deviations decay by the damping
        checks.near([rows['period'][i], rows['growth'][i]], [time, -0.5], 1e-7, f'at T = {torque}', scale=1)


SPRING = """&structure cq=1 /
&pair coordinate=1, links=1,2, kind='prismatic', axis=1,0,0 /
&initial coordinate=1, position=1 /
&body link=2, mass=1 /
&load kind='coordinate', coordinate=1, stiffness=1 /
&parameter name='k', sets='load(1).stiffness', low=0.5, high=2 /
&branch parameter='k', of='periodic' /
&time end=1 /
"""


@pytest.mark.parametrize('text, words', (
    (SPRING, 'give a guess for it by period='),
    (SPRING + '&periodic period=6 /\n', 'belongs to a family'),
    (SPRING.replace('stiffness=1 /', 'stiffness=1, damping=1 /') + '&periodic period=6 /\n', 'leads to a position of rest'),
    (SPRING.replace("'k'", "'period'") + '&periodic period=6 /\n', "has a column 'period'"),
), ids=('no guess', 'family', 'rest', 'name'))
def test_refusals(checks, mech9d, tmp_path, text, words):
    _, _, said = follow(mech9d, tmp_path, text, 'period' if "'period'" in text else 'k', 3)
    checks.true(words in said, words, said)


# the governor of examples/governor: its shaft turns on, and no force depends on its angle
GOVERNOR = """&structure cq=1,2 /
&pair coordinate=1, links=1,2, kind='revolute', axis=0,0,1 /
&pair coordinate=2, links=2,3, kind='revolute', axis=0,-1,0 /
&initial coordinate=1, position=0.2, velocity=6.118 /
&initial coordinate=2, position=2.1262 /
&body link=2, mass=1, inertia=0,0,4,0,0,0 /
&body link=3, mass=1, centre=0,0,-1 /
&gravity acceleration=0,0,-9.81 /
&load kind='coordinate', coordinate=1, force=1, law='polynomial', over='q2', coefficients=9.42477796076938,-9 /
&load kind='coordinate', coordinate=2, damping=0.3 /
&periodic period=1.44 /
&time end=10, intervals=10 /
&parameter name='b', sets='load(2).damping', low=0.28, high=0.5 /
&branch parameter='b', of='periodic' /
"""
STEADY = GOVERNOR.replace('velocity=6.118', 'velocity=4.5').replace('position=2.1262', 'position=1.05')
# b (J + m l^2 sin^2 + 4 m l^2 cos^2) w sin = 2 m l^2 k cos, Vyshnegradskii
CRITICAL = 9/((4.75 + 1)*np.sqrt(2*9.81)*np.sqrt(0.75))


def hunting(steps):
    """The limit cycle by shooting with the method of Runge and Kutta: the start where the arm is highest, the speed there, period, angle of the
    shaft, and the multipliers of arm and speed but for 1."""
    def rates(s):
        q, v, w, _ = s
        sine, cosine = np.sin(q), np.cos(q)
        return np.array([v, w**2*sine*cosine - 9.81*sine - 0.3*v, (-9*(q - np.pi/3) - 2*sine*cosine*w*v)/(4 + sine**2), w])

    def go(start, period):
        s, h = np.append(start, 0.0), period/steps
        for _ in range(steps):
            a = rates(s)
            b = rates(s + h/2*a)
            c = rates(s + h/2*b)
            s = s + h/6*(a + 2*b + 2*c + rates(s + h*c))
        return s

    def slopes(start, period):
        return np.column_stack([(go(start + e, period) - go(start - e, period))[:3]/2e-5 for e in 1e-5*np.eye(3)])

    start, period = np.array([2.126, 0.0, 6.118]), 1.4433
    for _ in range(6):
        end = go(start, period)
        system = np.zeros((4, 4))
        system[:3, :3], system[:3, 3], system[3, 1] = slopes(start, period) - np.eye(3), rates(end)[:3], 1
        change = np.linalg.solve(system, np.append(start - end[:3], -start[1]))
        start, period = start + change[:3], period + change[3]
    values = np.linalg.eigvals(slopes(start, period))
    pair = max(np.delete(values, np.argmin(np.abs(values - 1))), key=lambda value: value.imag)
    return np.array([start[0], start[2], period, go(start, period)[3], pair.real, pair.imag])


def test_hunting(checks, mech9d, tmp_path):
    """The limit cycle of the governor comes back but for the angle of its shaft; its branch ends where steady running becomes stable."""
    rows, branches, said = follow(mech9d, tmp_path, GOVERNOR, 'b')
    coarse, fine = hunting(200), hunting(400)
    exact = fine + (fine - coarse)/15
    at = np.argmin(np.abs(rows['b'] - 0.3))
    # differences of the reference over 1e-5
    checks.near([rows['q2'][at], rows['period'][at]], exact[[0, 2]], 1e-8, 'the motion at b = 0.3', scale=1)
    checks.near(rows['growth'][at], np.log(np.hypot(exact[4], exact[5]))/exact[2], 5e-7, 'its growth', scale=1)
    checks.equal(branches[0]['ends'], ['low', 'Hopf point'], 'ends')
    last = branches[0]['special_points'][-1]
    checks.near([last['value'], last['q'][1]], [CRITICAL, np.pi/3], 1e-9, 'the Hopf point', scale=1)
    # at the criterion the cubic equation of small deviations has a pair without real part
    speed, inertia = np.sqrt(2*9.81), 4.75
    a = np.array([[0, 1, 0], [-speed**2*0.75, -CRITICAL, speed*np.sqrt(0.75)], [-9/inertia, -speed*np.sqrt(0.75)/inertia, 0]])
    roots = np.linalg.eigvals(a)
    checks.near(last['period'], 2*np.pi/np.abs(roots.imag).max(), 1e-9, 'the period there')
    checks.near(roots.real[np.abs(roots.imag) > 1], 0, 1e-12, 'the reference', scale=1)

    path, report = tmp_path/'follow.nml', tmp_path/'motion.json'
    done = run(mech9d, path, '--periodic', '--report', report, '--no-write')
    found = json.loads(report.read_text())['periodic']
    checks.near([found['period'], abs(found['advance'][0])], exact[2:4], 1e-7, 'one period', scale=1)
    checks.near(sorted(np.abs([complex(*pair) for pair in found['multipliers']])), sorted([1, 1, *2*[np.hypot(exact[4], exact[5])]]), 1e-6,
                'multipliers', scale=1)
    checks.equal([found['stability'], found['turns'], found['advance'][1]], ['stable', [0, 0], 0], 'what is told')
    checks.true('coordinate 1 goes on by' in done.stderr, 'the words', done.stderr)


def test_steady_running(checks, mech9d, tmp_path):
    """Steady running is followed by whole turns of the shaft, and its point of change is a Hopf point."""
    rows, branches, _ = follow(mech9d, tmp_path, STEADY, 'b')
    checks.near([rows['q2'].min(), rows['q2'].max()], np.pi/3, 1e-12, 'the arm')
    checks.near(rows['period'], 2*np.pi/np.sqrt(2*9.81), 1e-12, 'a turn of the shaft')
    checks.equal([point['kind'] for point in branches[0]['special_points']], ['Hopf point'], 'one special point')
    checks.near(branches[0]['special_points'][0]['value'], CRITICAL, 1e-10, 'the criterion')


@pytest.mark.parametrize('before, after', (
    ('acceleration=0,0,-9.81', 'acceleration=0.01,0,-9.81'),
    ('&periodic', "&load kind='coordinate', coordinate=2, force=1e-6, law='harmonic', over='q1', amplitude=1, angular_frequency=1 /\n&periodic"),
), ids=('gravity', 'law'))
def test_an_angle_that_matters(checks, mech9d, tmp_path, before, after):
    """A shaft whose angle some force depends on has to come back but for whole turns."""
    path = tmp_path/'motion.nml'
    path.write_text(GOVERNOR.replace(before, after), encoding='utf-8')
    done = run(mech9d, path, '--periodic', '--no-write')
    checks.true('goes on by' not in done.stderr and done.returncode in (0, 5), 'no motion that goes on', done.stderr)
