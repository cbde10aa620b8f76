"""Derivatives by parameters: of a four-bar linkage and of a helical pair against eighth-order differences of closed forms in extended
precision; of spatial chains, couplings and joints against differences of whole runs; identities; HDF5; what is refused, and why.

Compares the program with itself in part: differences of runs at other values of a parameter; planar with spatial arithmetic; the cost
with the cost of a run without derivatives.
"""
import os
import resource

import numpy as np
import pytest

from kinematic_derivatives import FOUR_BAR, FOUR_BAR_PARAMETERS, GEARED, PARALLELOGRAM, Case, differences, four_bar_motion, of_motion
from mech9_cases import TREE, run, text_of

# The promise: of the largest derivative of each kind. Round-off is near 1e-13 in these mechanisms; differences of closed forms in
# extended precision lose 1e-17, where numpy has it.
EXACT = 1e-9
HELICAL = """&structure cq=1 /
&pair coordinate=1, links=1,2, kind='helical', point=0.2,0.1,0.3, axis=0.1,0.2,1.1, pitch=0.4, moving_point=0.05,0,0.1 /
&drive coordinate=1, kind='polynomial', coefficients=0.2,1.5,-0.4,0.3 /
&point name='P', link=2, position=0.4,0.2,0.1 /
&time end=2, intervals=10 /
&output sensitivities=.true. /
"""
HELICAL_PARAMETERS = (('tilt', 'pair.axis(1)', 0.1), ('pitch', 'pair.pitch', 0.4), ('c2', 'drive.coefficients(3)', -0.4),
                      ('c1', 'drive.coefficients(2)', 1.5))

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


@pytest.fixture
def case(checks, tmp_path, mech9k, mech9d):
    return Case(checks, tmp_path, mech9k, mech9d)


def test_four_bar_has_the_derivatives_of_its_closed_form(case):
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


def test_leg_has_the_derivatives_of_its_circles(case):
    """Three closed chains, one after the other: derivatives of all points by the bars, against circles in extended precision. Rates
    and accelerations are differences in time of these."""
    lines = text_of(os.path.join(TREE, 'examples', 'jansen_leg', 'jansen_leg.nml'))
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


def test_helical_pair_has_the_derivatives_of_its_closed_form(case):
    declared = ''.join(f"&parameter name='{name}', sets='{target}' /\n" for name, target, _ in HELICAL_PARAMETERS)
    names, rows = case.table(HELICAL + declared)
    t = rows[:, 0].astype(np.longdouble)
    values = np.array([value for _, _, value in HELICAL_PARAMETERS], dtype=np.longdouble)
    case.checks.near(helical_motion(values, t)[4:].T, rows[:, 4:13], 1e-11, 'the motion of the helical pair is that of its formula')
    for number, (name, _, _) in enumerate(HELICAL_PARAMETERS):
        expected = differences(lambda v: helical_motion(v, t), values, number)
        case.compare(names, rows, name, np.asarray(expected.T, float), EXACT, 'helical pair, closed form')


def rsur():
    text = text_of(os.path.join(TREE, 'examples', 'rsur', 'rsur.nml'))
    return text.replace('intervals=120', 'intervals=6').replace("&output table='rsur.dat' /", '&output sensitivities=.true. /')


@pytest.mark.parametrize('why, text, parameters', (
    ('geared five-bar linkage', GEARED, (('ratio', 'coupling.ratio', -1.5), ('turned', 'coupling.phase', 1.1), ('arm', 'pair(4).point(1)', 0.25))),
    ('shafts with a universal joint', SHAFTS, (('bend', 'pair(3).axis(1)', 0.5),)),
    ('spatial crank and rocker', rsur(), (('rod', 'pair(5).point(2)', 0.5), ('direction', 'pair(7).axis(2)', 0.0)))),
    ids=('geared five-bar', 'universal joint', 'spatial crank and rocker'))
def test_derivatives_are_differences_of_runs(case, why, text, parameters):
    case.against_runs(text, parameters, why)


CURVES = ('constant-velocity', 'harmonic', 'cycloidal', 'polynomial345', 'polynomial4567', 'modified-sine', 'modified-trapezoidal')


@pytest.mark.parametrize('curve', CURVES)
def test_laws_in_segments_that_repeat_and_advance(case, curve):
    """The small steps of the differences, which keep all outputs in their segments, cost three digits."""
    following = CURVES[(CURVES.index(curve) + 1) % 7]
    laws = ','.join(f"'{name}'" for name in (curve, 'constant-velocity', following, curve))
    text = SEGMENTS.format(laws, f"'{curve}'", 0.026, 1.058)
    if curve in ('harmonic', 'cycloidal'):
        text += '&mechanism angle_unit=\'deg\' /\n'
    case.against_runs(text, SEGMENTS_PARAMETERS, f'segments, {curve}', 1e-8, 2.0**-11)


def test_times_of_a_law_in_proportion(case):
    turn = "&parameter name='size', sets='drive(2).times(1)','drive(2).times(2)','drive(2).times(3)','drive(2).period', " \
        "factors=0.2,0.61,0.92,0.72, value=1 /\n"
    # all times of a law in proportion: q(t/p), so that the derivatives are -t dq, -dq - t ddq
    names, rows = case.table(SEGMENTS.format("'cycloidal'", "'cycloidal'", 0.3, 3.1).replace('times=0,0.31,0.52,0.83,1.1', 'times=0,1,2,3,4') + turn)
    t, dq, ddq = (rows[:, names.index(name)] for name in ('t', 'dq2', 'ddq2'))
    case.checks.near(rows[:, names.index('d(q2)/d(size)')], -t * dq, 1e-12, 'times in proportion: positions', scale=1.0)
    case.checks.near(rows[:, names.index('d(dq2)/d(size)')], -dq - t * ddq, 1e-11, 'times in proportion: rates', scale=1.0)


def test_lengths_in_proportion(case):
    """Angles stay, and points move in proportion."""
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


CRANK = "&parameter name='crank', sets='pair(2).point(1)' /\n"


def test_other_numbers_of_pairs(case):
    numbered = FOUR_BAR.replace('&pair coordinate=2,', '&pair coordinate=9,').replace('&pair coordinate=3,', '&pair coordinate=2,') \
        .replace('&pair coordinate=9,', '&pair coordinate=3,').replace('&initial coordinate=2,', '&initial coordinate=3,')
    names, rows = case.table(FOUR_BAR + CRANK)
    names_of_other, rows_of_other = case.table(numbered + CRANK)
    for one, other in (('q2', 'q3'), ('ddq3', 'ddq2'), ('P.ax', 'P.ax')):
        case.checks.near(rows_of_other[:, names_of_other.index(f'd({other})/d(crank)')], rows[:, names.index(f'd({one})/d(crank)')],
                         1e-11, f'other numbers of pairs: {one}', scale=1.0)


def test_positions_alone_have_derivatives_alone(case):
    names, rows = case.table(FOUR_BAR.replace('sensitivities', 'derivatives=0, sensitivities') + CRANK)
    case.checks.equal(names[1:], [*names[1:9], *(f'd({n})/d(crank)' for n in names[1:8])], 'positions alone have derivatives alone')


def test_beside_a_singular_position_derivatives_are_finite(case):
    names, rows = case.table(PARALLELOGRAM.format(end=2.0))
    case.checks.true(np.isfinite(rows).all(), 'beside a singular position derivatives are finite')


def test_in_a_singular_position_there_are_no_derivatives(case):
    flat = PARALLELOGRAM.replace('coefficients=1,1', 'coefficients=-2,1').replace('position=-1', 'position=2') \
        .replace('coordinate=4, position=1', 'coordinate=4, position=-2').format(end=4.0)
    case.refused(flat, 6, 'derivatives by the parameters do not exist at t = 2 s, in a singular position of closed chain 1')


def test_a_parameter_that_opens_a_chain_has_no_derivatives(case):
    tilted = PARALLELOGRAM.format(end=2.0).replace("sets='pair(2).point(1)'", "sets='pair(2).axis(1)'")
    case.refused(tilted, 3, "derivatives by the parameter 'crank' do not exist: closed chain 1 would not stay closed")


@pytest.mark.parametrize('text, words', (
    (FOUR_BAR, 'sensitivities are derivatives by the parameters, and there are none'),
    (FOUR_BAR + "&parameter name='crank', sets='time.end' /\n", "derivatives by the parameter 'crank' are not computed"),
    ("&mechanism title='a' /\n" + FOUR_BAR + "&parameter name='crank', sets='mechanism.data_tolerance' /\n",
     'its value cannot be changed a little in both directions')), ids=('no parameter', 'a time', 'a tolerance'))
def test_refused(case, text, words):
    case.refused(text, 3, words)


def test_hdf5_file_has_the_derivatives_of_the_table(case):
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


def planar_mechanisms():
    random = np.random.default_rng(9)
    return [planar_mechanism(random, number % 2 == 1) for number in range(6)]


@pytest.mark.parametrize('number', range(6))
def test_planar_and_spatial_arithmetic_agree(case, number):
    """A parameter that tilts an arm takes the whole mechanism out of planar arithmetic."""
    text, parameters, tilted = planar_mechanisms()[number]
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


def test_axes_that_tilt_alike_turn_the_plane(case):
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


# A run with ten parameters of a four-bar linkage takes 1.8 times the instructions of a run without derivatives
# (bench/measurements.md). Times are less certain. When the derivatives were found for each parameter by itself, in space, this was 20.
MOST_COST = 5.0


def test_ten_parameters_cost_little(case):
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
