"""Branches of periodic motions over a parameter: closed forms of a linear oscillator, the boundary of Kapitza's pendulum, symmetry breaking
and period doubling of the driven pendulum, against independent integrations; a ball that bounces on a table; refusals."""

import numpy as np
import pytest

import branch_cases
from branch_cases import follow

OSCILLATOR = """&structure cq=1 /
&pair coordinate=1, links=1,2, kind='prismatic', axis=1,0,0 /
&initial coordinate=1, position=0.3 /
&body link=2, mass=1 /
&load kind='coordinate', coordinate=1, stiffness=1, damping=0.4 /
&load kind='coordinate', coordinate=1, force=1, law='harmonic', amplitude=1, angular_frequency=0.5, phase=1.5707963267948966 /
&time end=1 /
"""
PENDULUM = """&structure cq=1 /
&pair coordinate=1, links=1,2, kind='revolute', axis=0,0,1 /
&initial coordinate=1, position=0.2, velocity=0 /
&body link=2, mass=1, centre=0,-1,0 /
&gravity acceleration=0,-1,0 /
&load kind='coordinate', coordinate=1, damping=0.5 /
&load kind='coordinate', coordinate=1, force=0.95, law='harmonic', amplitude=1, angular_frequency=0.6666666666666666, phase=1.5707963267948966 /
&parameter name='g', sets='load(2).force', low=0.95, high=1.07 /
&branch parameter='g', of='periodic' /
&time end=1 /
"""
KAPITZA = f"""&structure cq=1,2 /
&pair coordinate=1, links=1,2, kind='prismatic', axis=0,1,0 /
&pair coordinate=2, links=2,3, kind='revolute', axis=0,0,1 /
&drive coordinate=1, kind='harmonic', amplitude=0.1, angular_frequency=44, phase=1.5707963267948966 /
&body link=3, mass=1, centre=0,-1,0 /
&gravity acceleration=0,-9.81,0 /
&initial coordinate=2, position={np.pi!r} /
&parameter name='W', sets='drive.angular_frequency', low=43, high=46 /
&branch parameter='W', of='periodic' /
&time end=1 /
"""


def test_resonance(checks, mech9d, tmp_path):
    """The response of a linear oscillator over the frequency and over the damping; all deviations decay by half the damping."""
    text = OSCILLATOR + "&parameter name='w', sets='load(2).angular_frequency', low=0.3, high=2 /\n&branch parameter='w', of='periodic', step=0.3 /\n"
    rows, branches, _ = follow(mech9d, tmp_path, text, 'w')
    w = rows['w']
    checks.near([w.min(), w.max()], [0.3, 2.0], 1e-13, 'the whole range')
    # the derivative by the parameter has a part of the period, which changes with it
    checks.near(rows['q1'], (1 - w**2)/((1 - w**2)**2 + (0.4*w)**2), 1e-10, 'the place at the start of the period')
    checks.near(rows['growth'], -0.2, 1e-11, 'the growth')
    checks.equal([branch['of'] for branch in branches], ['periodic'], 'what is reported')
    checks.equal(set(rows['type']), {0.0}, 'no special points')
    text = OSCILLATOR + "&parameter name='c', sets='load(1).damping', low=0.2, high=2 /\n&branch parameter='c', of='periodic', step=0.3 /\n"
    rows, _, _ = follow(mech9d, tmp_path, text, 'c')
    checks.near(rows['q1'], 0.75/(0.75**2 + (0.5*rows['c'])**2), 1e-10, 'the place over the damping')


def test_folds_of_a_resonance(checks, mech9d, tmp_path):
    """The response of Duffing's hard spring turns back twice over the frequency. Points of a branch are exact, so that a polynomial through
    the neighbours of a fold has its extreme there; the derivative of the period by the frequency decides where the fold is found."""
    text = OSCILLATOR.replace('damping=0.4', 'damping=0.2').replace('force=1, law', 'force=0.7, law') + (
        "&load kind='coordinate', coordinate=1, force=-1, law='polynomial', coefficients=0,0,0,1, over='q1' /\n"
        "&parameter name='w', sets='load(2).angular_frequency', low=0.4, high=2.6 /\n&branch parameter='w', of='periodic', points=3000 /\n")
    rows, branches, _ = follow(mech9d, tmp_path, text, 'w')
    at = np.nonzero(rows['type'] == 1)[0]
    checks.equal(len(at), 2, 'two folds')
    checks.true(rows['w'][at[0]] - rows['w'][at[1]] > 0.3, 'the second one is at a lower frequency', rows['w'][at])
    for i in at:
        beside = [i - 2, i - 1, i + 1, i + 2]
        polynomial = np.polyfit(rows['q1'][beside] - rows['q1'][i], rows['w'][beside], 3)
        turns = np.roots(np.polyder(polynomial))
        # the term of fourth order at distances up to 0.05
        checks.near(np.polyval(polynomial, turns[np.argmin(np.abs(turns))].real), rows['w'][i], 1e-6, 'the fold', scale=1)


def test_kapitza(checks, mech9d, tmp_path):
    """The top of a pendulum with a vibrating pivot becomes stable at W = 44.39079478, where motions beside it begin."""
    rows, branches, _ = follow(mech9d, tmp_path, KAPITZA, 'W')
    points = [point for point in branches[0]['special_points']]
    checks.equal([point['kind'] for point in points], ['branch point'], 'one special point')
    # the digits of the reference
    checks.near(points[0]['value'], 44.39079478, 5e-9, 'where', scale=1)
    first = rows['branch'] == 1
    checks.near(rows['q2'][first], np.pi, 1e-12, 'the top')
    unstable = rows['W'] < 44.39
    checks.true((rows['growth'][first & unstable] > 1e-3).all(), 'unstable below', rows['growth'])
    checks.true((np.abs(rows['growth'][first & (rows['W'] > 44.4)]) < 1e-6).all(), 'neutral above', rows['growth'])


def test_a_ball_on_a_table(checks, mech9d, tmp_path):
    """A ball meets a table that vibrates once in each period T. With A the amplitude of the table, w its frequency and f the phase of the
    impact, A w^2 cos f = pi g (1 - e)/(1 + e). The period doubles where A w^2 sin f = 2 g (1 + e^2)/(1 + e)^2: the multipliers, whose
    product is e^2, are -1 and -e^2 there."""
    text = """&structure cq=1,2 /
&pair coordinate=1, links=1,2, kind='prismatic', axis=0,1,0 /
&pair coordinate=2, links=1,3, kind='prismatic', axis=0,1,0 /
&drive coordinate=1, kind='harmonic', amplitude=0.05, angular_frequency=20 /
&initial coordinate=2, position=0.14415, velocity=-1.1244 /
&body link=3, mass=1 /
&gravity acceleration=0,-9.81,0 /
&point name='C', link=3, position=0,0,0 /
&contact point='C', link=2, normal=0,1,0, radius=0.05, restitution=0.35 /
&parameter name='e', sets='contact.restitution', low=0.28, high=0.36 /
&branch parameter='e', of='periodic', switch=.false. /
&time end=1 /
"""
    rows, branches, _ = follow(mech9d, tmp_path, text, 'e')
    checks.near([rows['e'].min(), rows['e'].max()], [0.28, 0.36], 1e-13, 'the whole range')
    g, e = 9.81, rows['e']
    f = np.arccos(np.pi * g * (1 - e) / (20 * (1 + e)))
    t, v = f / 20, np.pi * g / 20
    checks.near(rows['q2'], 0.05 + 0.05 * np.sin(f) + v * t - g * t**2 / 2, 1e-8, 'the height at the start of the period')
    low, high = 0.28, 0.36
    for _ in range(60):
        e = (low + high) / 2
        sine = np.sqrt(1 - (np.pi * g * (1 - e) / (20 * (1 + e)))**2)
        low, high = (e, high) if 20 * sine < 2 * g * (1 + e**2) / (1 + e)**2 else (low, e)
    doubled = [point['value'] for point in branches[0]['special_points'] if point['kind'] == 'period doubling']
    checks.near(doubled, [low], 1e-9, 'the period doubles')


def test_driven_pendulum(checks, mech9d, tmp_path):
    """The symmetric motion of the driven pendulum loses its symmetry, and both motions beside it double their period at
    g = 1.066372862455."""
    rows, branches, said = follow(mech9d, tmp_path, PENDULUM, 'g')
    checks.equal([branch['period_doublings'] for branch in branches], [0, 0, 1, 1], 'two branches, and both doubled ones')
    kinds = [[point['kind'] for point in branch['special_points']] for branch in branches[:2]]
    checks.equal(kinds, [['branch point'], ['period doubling', 'branch point', 'period doubling']], 'their special points')
    doublings = [point['value'] for point in branches[1]['special_points'] if point['kind'] == 'period doubling']
    checks.near(doublings, 1.066372862455, 1e-11, 'the period doubling')
    checks.true('period doubling at g = 1.06637286246' in said, 'what is told', said)
    breaking = branches[0]['special_points'][0]['value']

    # the symmetric motion is its own image after half a period: the multiplier of half a period is -1 at the symmetry breaking
    def half(state, g):
        """State after half a period, mirrored, by the method of Runge and Kutta."""
        def rates(t, x):
            return np.array([x[1], -np.sin(x[0]) - 0.5*x[1] + g*np.cos(2*t/3)])

        x, n = np.array(state, dtype=float), 2000
        h = 1.5*np.pi/n
        for i in range(n):
            t = i*h
            a = rates(t, x)
            b = rates(t + h/2, x + h/2*a)
            c = rates(t + h/2, x + h/2*b)
            d = rates(t + h, x + h*c)
            x = x + h/6*(a + 2*b + 2*c + d)
        return -x

    def slopes(state, g):
        return np.column_stack([(half(state + e, g) - half(state - e, g))/2e-5 for e in 1e-5*np.eye(2)])

    state = np.array([rows['q1'][rows['branch'] == 1][np.argmin(np.abs(rows['g'][rows['branch'] == 1] - breaking))], 1.9])
    for _ in range(8):
        state = state - np.linalg.solve(slopes(state, breaking) - np.eye(2), half(state, breaking) - state)
    checks.near(np.linalg.det(slopes(state, breaking) + np.eye(2)), 0, 1e-6, 'the multiplier -1 of half a period', scale=1)


@pytest.mark.parametrize('text, name, code, words', (
    (OSCILLATOR.replace("law='harmonic', amplitude=1, angular_frequency=0.5, phase=1.5707963267948966 ", '') +
     "&parameter name='c', sets='load(1).damping', low=0.2, high=2 /\n&branch parameter='c', of='periodic' /\n", 'c', 3,
     'give a guess for it by period='),
    (PENDULUM.replace("kind='revolute', axis=0,0,1 /", "kind='revolute', axis=0,0,1 /\n&drive coordinate=1, kind='harmonic', amplitude=1, "
                      "angular_frequency=1 /").replace('&initial coordinate=1, position=0.2, velocity=0 /\n', ''), 'g', 3,
     'every independent coordinate is driven'),
), ids=('free', 'driven'))
def test_refusals(checks, mech9d, tmp_path, text, name, code, words):
    _, _, said = follow(mech9d, tmp_path, text, name, code)
    checks.true(words in said, words, said)


COUPLED = branch_cases.SLIDERS + """&initial coordinate=1, position=-1.3, velocity=-0.06 /
&initial coordinate=2, position=2.9, velocity=-1.9 /
&parameter name='f', sets='load(4).force', value=1, low=0.3, high=1.2 /
&branch parameter='f', of='periodic' /
&time end=1 /
"""
PERIOD = 2*np.pi/1.4


def coupled(state, f, steps):
    """The state after a period, and its derivatives by the state, by the method of Runge and Kutta."""
    by_position = np.array([[-1.0, 0.5], [1.0, -1.75]])

    def rates(t, x):
        relative = 0.5*x[1] + 0.1*x[3]
        first = -x[0] + 0.3*x[2] - 0.1*x[2]**3 + relative + f*np.sin(1.4*t)
        return np.array([x[2], x[3], first, -2.5*relative - first])

    def slopes(x):
        falling = 0.3 - 0.3*x[2]**2
        return np.block([[np.zeros((2, 2)), np.eye(2)], [by_position, np.array([[falling, 0.1], [-falling, -0.35]])]])

    x, matrix, h = np.array(state, dtype=float), np.eye(4), PERIOD/steps
    for i in range(steps):
        t = i*h
        a, of_a = rates(t, x), slopes(x) @ matrix
        y = x + h/2*a
        b, of_b = rates(t + h/2, y), slopes(y) @ (matrix + h/2*of_a)
        y = x + h/2*b
        c, of_c = rates(t + h/2, y), slopes(y) @ (matrix + h/2*of_b)
        y = x + h*c
        d, of_d = rates(t + h, y), slopes(y) @ (matrix + h*of_c)
        x = x + h/6*(a + 2*b + 2*c + d)
        matrix = matrix + h/6*(of_a + 2*of_b + 2*of_c + of_d)
    return x, matrix


def torus_point(steps):
    """The force at which a pair of multipliers of the periodic motion leaves the unit circle, the start there, and the pair's angle: by
    shooting and the secant method."""
    x = np.array([-0.88, 1.97, -0.02, -1.32])

    def excess(f):
        nonlocal x
        for _ in range(20):
            end, matrix = coupled(x, f, steps)
            change = np.linalg.solve(matrix - np.eye(4), end - x)
            x = x - change
            if np.abs(change).max() < 1e-11:
                break
        pair = max(np.linalg.eigvals(coupled(x, f, steps)[1]), key=lambda value: (abs(value), value.imag))
        return abs(pair) - 1, np.angle(pair)

    low, high = 0.5, 0.55
    at_low, at_high = excess(low)[0], excess(high)[0]
    while abs(high - low) > 1e-11:
        low, high, at_low = high, high - at_high*(high - low)/(at_high - at_low), at_high
        at_high, angle = excess(high)
    return np.array([high, *x, angle])


def test_torus(checks, mech9d, tmp_path):
    """A self-excited oscillator under a strong force follows it; below a force a pair of multipliers leaves the unit circle, and the motion
    winds about a torus (Neimark and Sacker)."""
    rows, branches, said = follow(mech9d, tmp_path, COUPLED, 'f')
    coarse, fine = torus_point(400), torus_point(800)
    # errors of fourth order: Richardson's extrapolation leaves parts of 1e-10
    exact = fine + (fine - coarse)/15
    checks.true(np.abs(fine - coarse).max() < 1e-7, 'the reference converges', fine - coarse)
    checks.true(1 < abs(exact[5]) < 3, 'the multipliers are far from 1 and -1', exact)
    points = branches[0]['special_points']
    checks.equal([point['kind'] for point in points], ['torus'], 'one special point')
    checks.near(points[0]['value'], exact[0], 1e-9, 'the force', scale=1)
    at = np.nonzero(rows['type'] == 5)[0]
    checks.equal(len(at), 1, 'its row')
    checks.near([rows['q1'][at[0]], rows['q2'][at[0]]], exact[1:3], 1e-8, 'the start of the motion', scale=1)
    checks.near(rows['growth'][at[0]], 0, 1e-9, 'the growth there', scale=1)
    checks.true((rows['growth'][rows['f'] < exact[0] - 1e-6] > 0).all() and (rows['growth'][rows['f'] > exact[0] + 1e-6] < 0).all(),
                'unstable below, stable above', rows['growth'])
    checks.true('torus at f = 0.5' in said, 'what is told', said)
