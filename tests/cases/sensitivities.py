"""Derivatives by parameters: of a four-bar linkage and of a helical pair against eighth-order differences of closed forms in extended
precision; of spatial chains, couplings and joints against differences of whole runs; identities; HDF5; what is refused, and why.

Compares the program with itself in part: differences of runs at other values of a parameter; planar with spatial arithmetic; the cost
with the cost of a run without derivatives.

usage: sensitivities.py MECH9K MECH9D
"""
import os
import resource
import sys
import tempfile

import numpy as np

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), '..', 'scripts'))
from mech9_cases import Checks, read_table, run, text_of

# The promise: of the largest derivative of each kind. Round-off is near 1e-13 in these mechanisms; differences of closed forms in
# extended precision lose 1e-17, where numpy has it.
EXACT = 1e-9
# Differences of runs in double precision at steps of 1/128 lose two digits, and the conditioning of the chains.
BY_RUNS = 1e-9
WEIGHTS = (4 / 5, -1 / 5, 4 / 105, -1 / 280)
STEP = 2.0**-7

FOUR_BAR = """&structure cq=1 /
&pair coordinate=1, links=1,2, kind='revolute', point=0.01,0.02,0, axis=0,0,1, moving_point=0,0,0 /
&pair coordinate=2, links=2,3, kind='revolute', point=0.3,0,0, axis=0,0,1, moving_point=0,0,0 /
&pair coordinate=3, links=3,4, kind='revolute', point=0.9,0,0, axis=0,0,1, moving_point=0.7,0,0 /
&pair coordinate=4, links=1,4, kind='revolute', point=1,0,0, axis=0,0,1, moving_point=0,0,0 /
&initial coordinate=2, position=0.5 /
&initial coordinate=4, position=1.0 /
&drive coordinate=1, kind='harmonic', mean=0.3, amplitude=1.4, angular_frequency=2, phase=0.2 /
&point name='P', link=3, position=0.4,0.2,0.1 /
&time end=2, intervals=20 /
&output sensitivities=.true. /
"""
# name, target and value; the closed form takes the values in this order
FOUR_BAR_PARAMETERS = (
    ('crank', 'pair(2).point(1)', 0.3), ('coupler', 'pair(3).point(1)', 0.9), ('rocker', 'pair(3).moving_point(1)', 0.7),
    ('base', 'pair(4).point(2)', 0.0), ('mean', 'drive.mean', 0.3), ('swing', 'drive.amplitude', 1.4),
    ('speed', 'drive.angular_frequency', 2.0), ('phase', 'drive.phase', 0.2), ('place', 'point.position(2)', 0.2))

HELICAL = """&structure cq=1 /
&pair coordinate=1, links=1,2, kind='helical', point=0.2,0.1,0.3, axis=0.1,0.2,1.1, pitch=0.4, moving_point=0.05,0,0.1 /
&drive coordinate=1, kind='polynomial', coefficients=0.2,1.5,-0.4,0.3 /
&point name='P', link=2, position=0.4,0.2,0.1 /
&time end=2, intervals=10 /
&output sensitivities=.true. /
"""
HELICAL_PARAMETERS = (('tilt', 'pair.axis(1)', 0.1), ('pitch', 'pair.pitch', 0.4), ('c2', 'drive.coefficients(3)', -0.4),
                      ('c1', 'drive.coefficients(2)', 1.5))

PARALLELOGRAM_CHAIN = """&structure cq=1 /
&pair coordinate=1, links=1,2, kind='revolute', axis=0,0,1 /
&pair coordinate=2, links=2,3, kind='revolute', point=0.5,0,0, axis=0,0,1, moving_point=0,0,0 /
&pair coordinate=3, links=3,4, kind='revolute', point=1,0,0, axis=0,0,1, moving_point=0.5,0,0 /
&pair coordinate=4, links=1,4, kind='revolute', point=1,0,0, axis=0,0,1, moving_point=0,0,0 /
&initial coordinate=2, position=-1 /
&initial coordinate=4, position=1 /
&drive coordinate=1, kind='polynomial', coefficients=1,1 /
"""
PARALLELOGRAM = PARALLELOGRAM_CHAIN + """&point name='P', link=3, position=0.5,0.1,0 /
&parameter name='crank', sets='pair(2).point(1)' /
&time end={end}, intervals=4 /
&output sensitivities=.true. /
"""

GEARED = """&structure cq=1 /
&pair coordinate=1, links=1,2, kind='revolute', axis=0,0,1 /
&pair coordinate=2, links=1,3, kind='revolute', point=1,0,0, axis=0,0,1, moving_point=0,0,0 /
&pair coordinate=3, links=2,4, kind='revolute', point=0.2,0,0, axis=0,0,1, moving_point=0,0,0 /
&pair coordinate=4, links=3,5, kind='revolute', point=0.25,0,0, axis=0,0,1, moving_point=0,0,0 /
&pair coordinate=5, links=4,5, kind='revolute', point=0.8,0,0, axis=0,0,1, moving_point=0.8,0,0 /
&coupling kind='gear', coordinates=1,2, ratio=-1.5, phase=1.1 /
&initial coordinate=3, position=0.4 /
&initial coordinate=4, position=0.9 /
&initial coordinate=5, position=-1 /
&drive coordinate=1, kind='polynomial', coefficients=0.3,2 /
&point name='P', link=4, position=0.4,0.1,0 /
&time end=1, intervals=8 /
&output sensitivities=.true. /
"""

SHAFTS = """&structure cq=1 /
&pair coordinate=1, links=1,2, kind='revolute', axis=0,0,1 /
&pair coordinates=2,3, links=2,3, kind='universal', axis=1,0,0, moving_axis=0,1,0 /
&pair coordinate=4, links=1,3, kind='revolute', axis=0.5,0,1 /
&drive coordinate=1, kind='polynomial', coefficients=0,2 /
&time end=1, intervals=8 /
&output sensitivities=.true. /
"""


SEGMENTS = """&structure cq=1,2 /
&pair coordinate=1, links=1,2, kind='prismatic', axis=1,0,0 /
&pair coordinate=2, links=2,3, kind='revolute', axis=0,0,1 /
&drive coordinate=1, kind='segments', times=0,0.31,0.52,0.83,1.1, values=0.1,0.5,0.5,-0.3,0.2, laws={} /
&drive coordinate=2, kind='segments', times=0.2,0.61,0.92, period=0.72, values=0.1,0.5,0.7, laws={} /
&point name='P', link=3, position=0.3,0,0 /
&time start={}, end={}, intervals=13 /
&output sensitivities=.true. /
"""
SEGMENTS_PARAMETERS = (('first', 'drive(1).values(2)', 0.5), ('last', 'drive(1).values(5)', 0.2), ('early', 'drive(1).times(2)', 0.31),
                       ('late', 'drive(1).times(4)', 0.83), ('turn', 'drive(2).values(2)', 0.5), ('gain', 'drive(2).values(3)', 0.7),
                       ('middle', 'drive(2).times(2)', 0.61))


def of_motion(names):
    """The numbers of the columns that have derivatives, by kinds."""
    kinds = {}
    for i, name in enumerate(names):
        if name in ('t', 'closure', 'conditioning') or name.startswith('d('):
            continue
        kind = name.rstrip('0123456789') if '.' not in name else 'P.' + name.split('.')[1][:-1]
        kinds.setdefault(kind, []).append(i)
    return kinds


class Case:
    """A directory for files, the programs, and the checks."""

    def __init__(self, checks, directory, mech9k, mech9d):
        self.checks, self.directory, self.mech9k, self.mech9d = checks, directory, mech9k, mech9d

    def table(self, text, *options):
        """Names of the columns and rows of a run."""
        path = os.path.join(self.directory, 'a.nml')
        with open(path, 'w') as file:
            file.write(text)
        done = run(self.mech9k, path, '--quiet', '--table', '-', *options)
        if done.returncode != 0:
            raise RuntimeError(f'{text}{options} ended with {done.returncode}:\n{done.stderr}')
        columns = read_table(done.stdout)
        return list(columns), np.array(list(columns.values())).T

    def refused(self, text, code, words, program=None):
        path = os.path.join(self.directory, 'a.nml')
        with open(path, 'w') as file:
            file.write(text)
        done = run(program or self.mech9k, path, '--quiet', '--table', os.path.join(self.directory, 'a.dat'))
        self.checks.equal(done.returncode, code, f'{words}: code {code}')
        self.checks.true(words in ' '.join(done.stderr.split()), f'the message says: {words}', done.stderr)

    def compare(self, names, rows, parameter, expected, tolerance, why):
        """Derivatives by one parameter against a table of expected ones with the columns of the motion."""
        for kind, columns in of_motion(names).items():
            mine = rows[:, [names.index(f'd({names[i]})/d({parameter})') for i in columns]]
            largest = np.abs(expected[:, columns]).max()
            error = np.abs(mine - expected[:, columns]).max()
            self.checks.true(error <= tolerance * max(float(largest), 1e-3), f'{why}: {kind} by {parameter}',
                             f'error {error:.2e}, largest {largest:.2e}')

    def against_runs(self, text, parameters, why, tolerance=BY_RUNS, relative_step=STEP):
        """Derivatives against differences of runs at other values of the parameters."""
        declared = ''.join(f"&parameter name='{name}', sets='{target}', value={value!r} /\n" for name, target, value in parameters)
        names, rows = self.table(text + declared)
        plain = text.replace('sensitivities=.true.', 'sensitivities=.false.') + declared
        for number, (name, _, value) in enumerate(parameters, 1):
            step = relative_step * (abs(value) or 1.0)
            expected = 0
            for i, weight in enumerate(WEIGHTS, 1):
                above, below = (self.table(plain, '--set', f'parameter({number}).value={value + sign * i * step!r}')[1]
                                for sign in (1, -1))
                expected = expected + weight * (above - below) / step
            self.compare(names, rows, name, expected, tolerance, why)


def differences(function, values, number):
    """The derivative of a closed form by one of its values, in extended precision."""
    step = np.longdouble(2.0**-9)
    total = 0
    for i, weight in enumerate(WEIGHTS, 1):
        weight = (np.longdouble(4) / 5, -np.longdouble(1) / 5, np.longdouble(4) / 105, -np.longdouble(1) / 280)[i - 1]
        above, below = (np.array([v + (sign * i * step if k == number else 0) for k, v in enumerate(values)]) for sign in (1, -1))
        total = total + weight * (function(above) - function(below)) / step
    return total


def vector(z):
    return [z.real, z.imag]


def four_bar_motion(values, t, upper):
    """q, dq, ddq of the four pairs and the motion of P, by columns, from the formulas of the four-bar linkage."""
    a, b, c, base, mean, swing, speed, phase, place = values
    j = np.clongdouble(1j)
    angle = speed * t + phase
    q1, w1, e1 = mean + swing * np.sin(angle), swing * speed * np.cos(angle), -swing * speed**2 * np.sin(angle)
    crank = a * np.exp(j * q1)
    start = np.clongdouble(complex(0.01, 0.02))
    reach = (1 + j * base) - start - crank
    length = np.abs(reach)
    theta = np.angle(reach) + upper * np.arccos((length**2 + b**2 - c**2) / (2 * b * length))
    coupler = b * np.exp(j * theta)
    rocker = coupler - reach
    q4 = np.angle(rocker)

    def solve(right):
        # i coupler x - i rocker y = right
        m11, m12, m21, m22 = -coupler.imag, rocker.imag, coupler.real, -rocker.real
        det = m11 * m22 - m12 * m21
        return (right.real * m22 - m12 * right.imag) / det, (m11 * right.imag - right.real * m21) / det

    w3, w4 = solve(-j * crank * w1)
    a3, a4 = solve(-(j * e1 - w1**2) * crank + w3**2 * coupler - w4**2 * rocker)
    arm = np.exp(j * theta) * (np.longdouble(0.4) + j * place)
    point = start + crank + arm
    velocity = j * w1 * crank + j * w3 * arm
    acceleration = (j * e1 - w1**2) * crank + (j * a3 - w3**2) * arm
    zero = 0 * t
    return np.array([t, q1, theta - q1, q4 - theta, q4, w1, w3 - w1, w4 - w3, w4, e1, a3 - e1, a4 - a3, a4,
                     *vector(point), zero + 0.1, *vector(velocity), zero, *vector(acceleration), zero])


def check_four_bar(case):
    declared = ''.join(f"&parameter name='{name}', sets='{target}', value={value!r} /\n"
                       for name, target, value in FOUR_BAR_PARAMETERS)
    names, rows = case.table(FOUR_BAR + declared)
    t = rows[:, 0].astype(np.longdouble)
    values = np.array([value for _, _, value in FOUR_BAR_PARAMETERS], dtype=np.longdouble)
    px, py = names.index('P.x'), names.index('P.y')
    motions = [four_bar_motion(values, t, upper) for upper in (1, -1)]
    upper = (1, -1)[int(np.argmin([np.abs(m[13] - rows[:, px]).max() + np.abs(m[14] - rows[:, py]).max() for m in motions]))]
    case.checks.near(four_bar_motion(values, t, upper)[13:].T, rows[:, px:px + 9], 1e-11, 'the closed form is that of the run')
    case.checks.equal(names[names.index('closure') + 1], 'd(q1)/d(crank)',
                      'derivatives stand after all other columns')
    case.checks.equal(len(names), 1 + 21 + 1 + 21 * len(FOUR_BAR_PARAMETERS), 'every column of the motion has its derivatives')
    for number, (name, _, _) in enumerate(FOUR_BAR_PARAMETERS):
        expected = differences(lambda v: four_bar_motion(v, t, upper), values, number)
        case.compare(names, rows, name, np.asarray(expected.T, float), EXACT, 'four-bar linkage, closed form')
    place = [names.index(f'd({c})/d(place)') for c in ('q1', 'q2', 'q3', 'q4', 'dq2', 'ddq4', 'P.z')]
    case.checks.true(not rows[:, place].any(), 'what cannot matter has derivatives of exactly zero')


# name, targets, value: bars of the leg in examples/jansen_leg, by Jansen's letters
JANSEN_PARAMETERS = (
    ('j', "'pair(6).moving_point(1)','point(1).position(1)'", 50.0), ('k', "'pair(7).moving_point(1)','point(2).position(1)'", 61.9),
    ('b', "'pair(6).point(1)'", 41.5), ('c', "'pair(7).point(1)','pair(8).point(1)'", 39.3),
    ('f', "'pair(10).point(1)','point(4).position(1)'", 39.4), ('g', "'pair(10).moving_point(1)'", 36.7),
    ('m', "'pair(2).point(1)','pair(3).point(1)'", 15.0), ('across', "'pair(4).point(2)','pair(5).point(2)'", -7.8))


def jansen_points(values, t):
    """J, K, D, F and the foot by intersections of circles, as complex numbers."""
    j, k, b, c, f, g, m, across = values
    unit = np.clongdouble(1j)
    turning = np.longdouble('6.283185307179586')
    pin = m * np.exp(unit * turning * t)
    fixed = np.longdouble(-38) + unit * across

    def meet(one, radius, other, radius_of_other, side):
        """The place at both distances, on the left of the way from one centre to the other where the side is 1."""
        way = other - one
        along = (radius**2 - radius_of_other**2 + abs(way)**2) / (2 * abs(way))
        return one + way / abs(way) * (along + side * unit * np.sqrt(radius**2 - along**2))

    upper = meet(pin, j, fixed, b, -1)
    lower = meet(pin, k, fixed, c, 1)
    edge = fixed + (upper - fixed) / b * (np.longdouble('2.6098795180722933') + unit * np.longdouble('40.01497880670621'))
    knee = meet(edge, f, lower, g, -1)
    foot = lower + (knee - lower) / g * (np.longdouble('-7.746594005449595') + unit * np.longdouble('48.38378118041967'))
    return upper, lower, edge, knee, foot


def check_jansen(case):
    """Three closed chains, one after the other: derivatives of all points by the bars, against circles in extended precision. Rates
    and accelerations are differences in time of these."""
    lines = text_of(os.path.join(os.path.dirname(os.path.abspath(__file__)), '..', '..', 'examples', 'jansen_leg', 'jansen_leg.nml'))
    text = '\n'.join(line for line in lines.splitlines() if not line.startswith('&output')).replace('intervals=120', 'intervals=12')
    text += '\n&output sensitivities=.true. /\n' + ''.join(
        f"&parameter name='{name}', sets={targets}, value={value!r} /\n" for name, targets, value in JANSEN_PARAMETERS)
    names, rows = case.table(text)
    t = rows[:, 0].astype(np.longdouble)
    values = np.array([value for _, _, value in JANSEN_PARAMETERS], dtype=np.longdouble)

    def points(values, times):
        return np.array(jansen_points(values, times))

    def moved(values, order):
        if order == 0:
            return points(values, t)
        # the clock is one more value; the leg changes faster with time than with its bars, so that a quarter of the step is taken
        still, quarter = np.zeros(1, np.longdouble), np.longdouble(0.25)

        def rate(later):
            return differences(lambda clock: points(values, t + later + quarter * clock[0]), still, 0) / quarter

        if order == 1:
            return rate(0)
        return differences(lambda clock: rate(quarter * clock[0]), still, 0) / quarter

    for order, kind in enumerate(('', 'v', 'a')):
        for number, (name, _, _) in enumerate(JANSEN_PARAMETERS):
            expected = differences(lambda values: moved(values, order), values, number)
            mine = np.array([[rows[:, names.index(f'd({point}.{kind}{axis})/d({name})')] for axis in 'xy'] for point in 'J K D F foot'.split()])
            wanted = np.stack([expected.real, expected.imag], axis=1)
            case.checks.near(mine, wanted.astype(float), 1e-9, f'leg: derivatives of order {order} in time by {name}',
                             scale=float(np.abs(wanted).max()))


def helical_motion(values, t):
    """q, dq, ddq, and P = point + Rot(axis, q) (position - moving_point) + pitch q/2 pi axis."""
    tilt, pitch, c2, c1 = values
    axis = np.array([tilt, np.longdouble(0.2), np.longdouble(1.1)])
    axis = axis / np.sqrt((axis**2).sum())
    q, dq, ddq = (np.longdouble(0.2) + c1 * t + c2 * t**2 + np.longdouble(0.3) * t**3,
                  c1 + 2 * c2 * t + 3 * np.longdouble(0.3) * t**2, 2 * c2 + 6 * np.longdouble(0.3) * t)
    arm = np.array([0.4, 0.2, 0.1], np.longdouble) - np.array([0.05, 0, 0.1], np.longdouble)
    along, across = axis * (axis @ arm), np.cross(axis, arm)
    side = arm - along
    lead = pitch / (8 * np.arctan(np.longdouble(1)))
    fixed = np.array([0.2, 0.1, 0.3], np.longdouble) + along
    cosine, sine = np.cos(q), np.sin(q)
    outer = np.outer
    position = fixed + outer(cosine, side) + outer(sine, across) + outer(lead * q, axis)
    slope = outer(-sine, side) + outer(cosine, across) + lead * axis
    bend = -outer(cosine, side) - outer(sine, across)
    velocity = slope * dq[:, None]
    acceleration = slope * ddq[:, None] + bend * (dq**2)[:, None]
    return np.concatenate([np.array([t, q, dq, ddq]), position.T, velocity.T, acceleration.T])


def check_helical(case):
    declared = ''.join(f"&parameter name='{name}', sets='{target}' /\n" for name, target, _ in HELICAL_PARAMETERS)
    names, rows = case.table(HELICAL + declared)
    t = rows[:, 0].astype(np.longdouble)
    values = np.array([value for _, _, value in HELICAL_PARAMETERS], dtype=np.longdouble)
    case.checks.near(helical_motion(values, t)[4:].T, rows[:, 4:13], 1e-11, 'the motion of the helical pair is that of its formula')
    for number, (name, _, _) in enumerate(HELICAL_PARAMETERS):
        expected = differences(lambda v: helical_motion(v, t), values, number)
        case.compare(names, rows, name, np.asarray(expected.T, float), EXACT, 'helical pair, closed form')


def check_against_runs(case):
    case.against_runs(GEARED, (('ratio', 'coupling.ratio', -1.5), ('turned', 'coupling.phase', 1.1),
                               ('arm', 'pair(4).point(1)', 0.25)), 'geared five-bar linkage')
    case.against_runs(SHAFTS, (('bend', 'pair(3).axis(1)', 0.5),), 'shafts with a universal joint')
    rsur = text_of(os.path.join(os.path.dirname(os.path.abspath(__file__)), '..', '..', 'examples', 'rsur', 'rsur.nml'))
    rsur = rsur.replace('intervals=120', 'intervals=6').replace("&output table='rsur.dat' /", '&output sensitivities=.true. /')
    case.against_runs(rsur, (('rod', 'pair(5).point(2)', 0.5), ('direction', 'pair(7).axis(2)', 0.0)), 'spatial crank and rocker')


def check_segments(case):
    """All motion laws, and a law that repeats and advances. The small steps of the differences, which keep all outputs in their
    segments, cost three digits."""
    curves = ('constant-velocity', 'harmonic', 'cycloidal', 'polynomial345', 'polynomial4567', 'modified-sine', 'modified-trapezoidal')
    for number, curve in enumerate(curves):
        laws = ','.join(f"'{name}'" for name in (curve, 'constant-velocity', curves[(number + 1) % 7], curve))
        text = SEGMENTS.format(laws, f"'{curve}'", 0.026, 1.058)
        if curve in ('harmonic', 'cycloidal'):
            text += '&mechanism angle_unit=\'deg\' /\n'
        case.against_runs(text, SEGMENTS_PARAMETERS, f'segments, {curve}', 1e-8, 2.0**-11)
    turn = "&parameter name='size', sets='drive(2).times(1)','drive(2).times(2)','drive(2).times(3)','drive(2).period', " \
        "factors=0.2,0.61,0.92,0.72, value=1 /\n"
    # all times of a law in proportion: q(t/p), so that the derivatives are -t dq, -dq - t ddq
    names, rows = case.table(SEGMENTS.format("'cycloidal'", "'cycloidal'", 0.3, 3.1).replace('times=0,0.31,0.52,0.83,1.1', 'times=0,1,2,3,4') + turn)
    t, dq, ddq = (rows[:, names.index(name)] for name in ('t', 'dq2', 'ddq2'))
    case.checks.near(rows[:, names.index('d(q2)/d(size)')], -t * dq, 1e-12, 'times in proportion: positions', scale=1.0)
    case.checks.near(rows[:, names.index('d(dq2)/d(size)')], -dq - t * ddq, 1e-11, 'times in proportion: rates', scale=1.0)


def check_identities(case):
    """All lengths in proportion: angles stay, points move in proportion. A turn of a crank's zero is a change of its drive."""
    lengths = [('pair(1).point(1)', 0.01), ('pair(1).point(2)', 0.02), ('pair(2).point(1)', 0.3), ('pair(3).point(1)', 0.9),
               ('pair(3).moving_point(1)', 0.7), ('pair(4).point(1)', 1.0), ('point.position(1)', 0.4), ('point.position(2)', 0.2),
               ('point.position(3)', 0.1)]
    scaled = "&parameter name='size', value=1, sets={}, factors={} /\n".format(
        ','.join(f"'{name}'" for name, _ in lengths), ','.join(str(value) for _, value in lengths))
    names, rows = case.table(FOUR_BAR + scaled)
    for kind, columns in of_motion(names).items():
        derivatives = rows[:, [names.index(f'd({names[i]})/d(size)') for i in columns]]
        expected = rows[:, columns] if kind.startswith('P.') else 0 * derivatives
        case.checks.near(derivatives, expected, 1e-11, f'all lengths in proportion: {kind}', scale=1.0)
    numbered = FOUR_BAR.replace('&pair coordinate=2,', '&pair coordinate=9,').replace('&pair coordinate=3,', '&pair coordinate=2,') \
        .replace('&pair coordinate=9,', '&pair coordinate=3,').replace('&initial coordinate=2,', '&initial coordinate=3,')
    crank = "&parameter name='crank', sets='pair(2).point(1)' /\n"
    names, rows = case.table(FOUR_BAR + crank)
    names_of_other, rows_of_other = case.table(numbered + crank)
    for one, other in (('q2', 'q3'), ('ddq3', 'ddq2'), ('P.ax', 'P.ax')):
        case.checks.near(rows_of_other[:, names_of_other.index(f'd({other})/d(crank)')], rows[:, names.index(f'd({one})/d(crank)')],
                         1e-11, f'other numbers of pairs: {one}', scale=1.0)
    names, rows = case.table(FOUR_BAR.replace('sensitivities', 'derivatives=0, sensitivities') + crank)
    case.checks.equal(names[1:], [*names[1:9], *(f'd({n})/d(crank)' for n in names[1:8])], 'positions alone have derivatives alone')


def check_singular(case):
    names, rows = case.table(PARALLELOGRAM.format(end=2.0))
    case.checks.true(np.isfinite(rows).all(), 'beside a singular position derivatives are finite')
    flat = PARALLELOGRAM.replace('coefficients=1,1', 'coefficients=-2,1').replace('position=-1', 'position=2') \
        .replace('coordinate=4, position=1', 'coordinate=4, position=-2').format(end=4.0)
    case.refused(flat, 6, 'derivatives by the parameters do not exist at t = 2 s, in a singular position of closed chain 1')
    tilted = PARALLELOGRAM.format(end=2.0).replace("sets='pair(2).point(1)'", "sets='pair(2).axis(1)'")
    case.refused(tilted, 3, "derivatives by the parameter 'crank' do not exist: closed chain 1 would not stay closed")


def check_refusals(case):
    crank = "&parameter name='crank', sets='{}' /\n"
    case.refused(FOUR_BAR, 3, 'sensitivities are derivatives by the parameters, and there are none')
    case.refused(FOUR_BAR + crank.format('time.end'), 3, "derivatives by the parameter 'crank' are not computed")
    case.refused('&mechanism title=\'a\' /\n' + FOUR_BAR + crank.format('mechanism.data_tolerance'), 3, 'its value cannot be changed a little in both directions')


def check_hdf5(case):
    try:
        import h5py
    except ImportError:
        case.checks.left_out('h5py is not installed (Debian: python3-h5py)')
        return
    declared = ''.join(f"&parameter name='{name}', sets='{target}' /\n" for name, target, _ in FOUR_BAR_PARAMETERS[:2])
    path = os.path.join(case.directory, 'a.h5')
    names, rows = case.table(FOUR_BAR + declared, '--hdf5', path)
    with h5py.File(path) as file:
        group = file['sensitivity']
        case.checks.equal(group['q'].shape, (21, 4, 2), 'the dimension of parameters is the last one')
        case.checks.equal([bytes(name).decode() if isinstance(name, bytes) else name for name in file['parameter'][()]],
                          ['crank', 'coupler'], 'names of the parameters')
        case.checks.equal(group['ddq'].dims[2][0].name, '/parameter', 'the scale of the last dimension')
        for quantity, order in (('q', ''), ('dq', 'd'), ('ddq', 'dd')):
            for k in range(4):
                for p, name in enumerate(('crank', 'coupler')):
                    case.checks.true((group[quantity][:, k, p] == rows[:, names.index(f'd({order}q{k + 1})/d({name})')]).all(),
                                     f'{quantity} of pair {k + 1} by {name}')
        for quantity, letter in (('position', ''), ('velocity', 'v'), ('acceleration', 'a')):
            for axis in range(3):
                column = names.index(f'd(P.{letter}{"xyz"[axis]})/d(coupler)')
                case.checks.true((group[quantity][:, 0, axis, 1] == rows[:, column]).all(), f'{quantity} along {"xyz"[axis]}')


def rotation(random):
    """A random rotation of space."""
    q, r = np.linalg.qr(random.normal(size=(3, 3)))
    q = q * np.sign(np.diag(r))
    return q * np.sign(np.linalg.det(q))


def planar_mechanism(random, slides):
    """A crank with a coupler and a rocker, or a slider, in a random plane of space, and an arm on the coupler that a second drive turns.
    Its text, and the parameters that keep the plane."""
    turned = rotation(random)

    def place(*values):
        return ','.join(repr(float(x)) for x in turned @ np.array(values, float))

    crank, coupler, rocker, ground = random.uniform(0.2, 0.3), random.uniform(0.9, 1.1), random.uniform(0.7, 0.9), random.uniform(1, 1.1)
    height = random.uniform(-0.3, 0.3)
    if slides:
        end = f"""&pair coordinate=3, links=3,4, kind='revolute', point={place(coupler, 0, 0)}, axis={place(0, 0, 1)}, moving_point=0,0,0 /
&pair coordinate=4, links=1,4, kind='prismatic', point={place(0, -0.1, 0)}, axis={place(1, 0.1, 0)}, moving_point=0,0,0 /
&initial coordinate=4, position=1 /
"""
    else:
        end = f"""&pair coordinate=3, links=3,4, kind='revolute', point={place(coupler, 0, 0)}, axis={place(0, 0, 1)}, moving_point={place(rocker, 0, 0)} /
&pair coordinate=4, links=1,4, kind='revolute', point={place(ground, 0, 0)}, axis={place(0, 0, 1)}, moving_point=0,0,0 /
&initial coordinate=2, position=0.6 /
&initial coordinate=4, position=1.2 /
"""
    text = f"""&structure cq=1,5 /
&pair coordinate=1, links=1,2, kind='revolute', point={place(0.02, 0.01, height)}, axis={place(0, 0, 1)}, moving_point={place(0, 0, height)} /
&pair coordinate=2, links=2,3, kind='revolute', point={place(crank, 0, 0)}, axis={place(0, 0, 1)}, moving_point=0,0,0 /
{end}&pair coordinate=5, links=3,5, kind='revolute', point={place(0.3, 0.2, 0.1)}, axis={place(0, 0, 1)}, moving_point=0,0,0 /
&drive coordinate=1, kind='polynomial', coefficients=0.3,2,0.5 /
&drive coordinate=5, kind='harmonic', mean=0.2, amplitude=0.7, angular_frequency=3 /
&point name='P', link=3, position={place(0.4, 0.2, 0.1)} /
&point name='Q', link=5, position={place(0.3, -0.1, 0.2)} /
&time end=1.5, intervals=9 /
&output sensitivities=.true. /
"""

    def along(pair, name, direction, base):
        """A parameter that moves a point along a direction of the plane."""
        step = turned @ np.array(direction, float)
        targets = ','.join(f"'pair({pair}).{name}({i})'" for i in (1, 2, 3))
        return f"sets={targets}, value=0, factors={','.join(repr(float(x)) for x in step)}, " \
               f"terms={','.join(repr(float(x)) for x in turned @ np.array(base, float))}"

    parameters = [along(2, 'point', (1, 0.3, 0), (crank, 0, 0)), along(3, 'point', (0.1, 1, 0), (coupler, 0, 0)),
                  along(1, 'point', (1, 0.5, 0), (0.02, 0.01, height)),
                  along(4, 'point', (0.2, 1, 0), (0, -0.1, 0) if slides else (ground, 0, 0)),
                  along(5, 'point', (0.6, 0.7, 0), (0.3, 0.2, 0.1)), "sets='drive(1).coefficients(2)'",
                  "sets='drive(2).amplitude'", "sets='point(1).position(1)'"]
    tilt = ','.join(f"'pair(5).axis({i})'" for i in (1, 2, 3))
    axis, across = turned @ np.array([0, 0, 1.0]), turned @ np.array([1.0, 0, 0])
    tilted = f"sets={tilt}, value=0, factors={','.join(repr(float(x)) for x in across)}, " \
             f"terms={','.join(repr(float(x)) for x in axis)}"
    return text, parameters, tilted


def check_arithmetics(case):
    """Planar and spatial arithmetic agree: a parameter that tilts an arm takes the whole mechanism out of planar arithmetic."""
    random = np.random.default_rng(9)
    for number in range(6):
        text, parameters, tilted = planar_mechanism(random, number % 2 == 1)
        declared = ''.join(f"&parameter name='p{i}', {body} /\n" for i, body in enumerate(parameters))
        names, rows = case.table(text + declared)
        names_in_space, rows_in_space = case.table(text + declared + f"&parameter name='tilt', {tilted} /\n")
        case.checks.equal(names_in_space[:len(names)], names, 'columns of the first parameters stand before those of the last one')
        case.checks.true(np.abs(rows_in_space[:, len(names):]).max() > 0.01, 'the tilt moves the arm')
        for kind, columns in of_motion(names).items():
            for i in range(len(parameters)):
                of_kind = [names.index(f'd({names[k]})/d(p{i})') for k in columns]
                # the constants of a tilted plane differ by round-off, which dead points and accelerations magnify
                case.checks.near(rows[:, of_kind], rows_in_space[:, of_kind], 1e-10, f'planar mechanism {number}: {kind} by {parameters[i]}')


UPRIGHT = """&structure cq=1 /
&pair coordinate=1, links=1,2, kind='revolute', axis=0,0,1, point=0,0,0, moving_point=0,0,0 /
&pair coordinate=2, links=2,3, kind='revolute', axis=0,0,1, point=0,0.3,0, moving_point=0,0,0 /
&pair coordinate=3, links=3,4, kind='revolute', axis=0,0,1, point=0,0.9,0, moving_point=0,0.7,0 /
&pair coordinate=4, links=1,4, kind='revolute', axis=0,0,1, point=0,1,0, moving_point=0,0,0 /
&initial coordinate=2, position=0.5 /
&initial coordinate=4, position=1.0 /
&drive coordinate=1, kind='polynomial', coefficients=0.4,2,1 /
&point name='P', link=3, position=0,0.2,0 /
&time end=2, intervals=10 /
&output sensitivities=.true. /
&parameter name='length', sets='pair(3).point(2)' /
"""


def check_turned_plane(case):
    """A parameter that tilts all axes alike turns the plane about the second axis: coordinates stay, and points turn with the plane."""
    names, planar = case.table(UPRIGHT)
    axes = ','.join(f"'pair({i}).axis(1)'" for i in range(1, 5))
    names, rows = case.table(UPRIGHT + f"&parameter name='tilt', sets={axes}, value=0 /\n")
    for kind, columns in of_motion(names).items():
        derivatives = rows[:, [names.index(f'd({names[i]})/d(tilt)') for i in columns]]
        expected = 0 * derivatives
        if kind.startswith('P.'):
            expected[:, 2] = -rows[:, columns[0]]
        case.checks.near(derivatives, expected, 1e-10, f'a plane that turns: {kind}', scale=1.0)
    case.checks.near(rows[:, :planar.shape[1]], planar, 1e-10, 'beside such a parameter, others have the same derivatives', scale=1.0)


# A run with ten parameters of a four-bar linkage takes 1.8 times the instructions of a run without derivatives (docs/measurements.md).
# Times are less certain. When the derivatives were found for each parameter by itself, in space, this was 20.
MOST_COST = 5.0


def check_cost(case):
    """Derivatives by ten parameters take a few times the time of a run without them. Both times are differences between runs of two
    lengths, so that reading and planning do not count."""
    targets = [f'pair({k}).{name}({i})' for k, name in ((2, 'point'), (3, 'point'), (3, 'moving_point'), (4, 'point'), (1, 'point'))
               for i in (1, 2)]
    declared = ''.join(f"&parameter name='p{i}', sets='{target}' /\n" for i, target in enumerate(targets))

    def seconds(sensitivities, intervals):
        path = os.path.join(case.directory, 'cost.nml')
        with open(path, 'w') as file:
            file.write(FOUR_BAR.replace('intervals=20', f'intervals={intervals}').replace('.true.', sensitivities) + declared)
        before = resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime
        done = run(case.mech9k, path, '--quiet', '--hdf5', os.path.join(case.directory, 'cost.h5'))
        case.checks.equal(done.returncode, 0, 'the run ends well')
        return resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime - before

    least = [min(seconds(wanted, 12000) for _ in range(3)) - min(seconds(wanted, 1000) for _ in range(3))
             for wanted in ('.false.', '.true.')]
    case.checks.true(least[1] <= MOST_COST * max(least[0], 0.015), 'ten parameters cost little',
                     f'{least[1]:.3f} s, against {least[0]:.3f} s without derivatives')


def main():
    checks = Checks()
    with tempfile.TemporaryDirectory() as directory:
        case = Case(checks, directory, *sys.argv[1:3])
        check_four_bar(case)
        check_helical(case)
        check_jansen(case)
        check_against_runs(case)
        check_segments(case)
        check_identities(case)
        check_singular(case)
        check_refusals(case)
        check_hdf5(case)
        check_arithmetics(case)
        check_turned_plane(case)
        check_cost(case)
    checks.finish()


if __name__ == '__main__':
    main()
