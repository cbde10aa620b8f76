"""The turning of links (&output links=, poles=) and the forms of forces in pairs (reaction_magnitudes=, reaction_axes=): against Norton's
Design of Machinery, example 6-7, closed forms of the four-bar linkage, products of rotations in numpy and their differences in extended
precision, and identities.

Compares the program with itself in part: derivatives by parameters and differences of whole runs; one linkage by other numbers, in other
planes, with links drawn face down; forces along the axes of link 1 and of the moving links.
"""
import json
import os

import numpy as np
import pytest

from kinematic_derivatives import STEP, WEIGHTS, Case
from mech9_cases import TREE, read_table, run, text_of

A, B, C, D = 0.04, 0.12, 0.08, 0.1      # Norton, example 6-7: crank, coupler, rocker, ground [m]
SPEED = 25.0                            # [rad/s]
DEGREE = np.pi / 180

NORTON = """&mechanism title='Norton, example 6-7', angle_unit='deg' /
&structure cq=1 /
&pair coordinate=1, links=1,2, kind='revolute', axis=0,0,1 /
&pair coordinate=2, links=2,3, kind='revolute', axis=0,0,1, point=0.04,0,0, moving_point=0,0,0 /
&pair coordinate=3, links=3,4, kind='revolute', axis=0,0,1, point=0.12,0,0, moving_point=0.08,0,0 /
&pair coordinate=4, links=1,4, kind='revolute', axis=0,0,1, point=0.1,0,0, moving_point=0,0,0 /
&initial coordinate=2, position={guess} /
&initial coordinate=4, position=60 /
&drive coordinate=1, kind='polynomial', coefficients=40, 1432.3944878270580 /
&time start=0, end=0.7, intervals=140 /
&output links=2,3,4, poles=2,3 /
"""

SPATIAL = """&mechanism angle_unit='deg' /
&structure cq=1,2,3 /
&pair coordinate=1, links=1,2, kind='revolute', axis=0.2,-0.3,1, zero=1,0.5,0, moving_axis=0,1,0.3, moving_zero=1,0,0 /
&pair coordinate=2, links=3,2, kind='helical', pitch=0.05, axis=1,0.4,-0.2, point=0.1,0.2,0, moving_point=0,0,0.3 /
&pair coordinate=3, links=3,4, kind='revolute', axis=0,-1,0.7, point=0.4,0,0, moving_point=0.1,0,0, moving_axis=1,0,0 /
&drive coordinate=1, kind='polynomial', coefficients=20, 300, -40 /
&drive coordinate=2, kind='polynomial', coefficients=-70, 150, 90 /
&drive coordinate=3, kind='polynomial', coefficients=10, -420, 25, 8 /
&time start=0, end=4, intervals=80 /
&output links=4,2,3 /
"""
# tilted: a closed spatial chain of two shafts, with an open arm of masses for reactions
SHAFTS = """&structure cq=1,5 /
&pair coordinate=1, links=1,2, kind='revolute', axis=0,0,1 /
&pair coordinates=2,3, links=2,3, kind='universal', axis=1,0,0, moving_axis=0,1,0 /
&pair coordinate=4, links=1,3, kind='revolute', axis=0.5,0,1 /
&pair coordinate=5, links=3,4, kind='revolute', point=0.3,0.1,0, axis=0,1,0.2, moving_point=0,0,0 /
&drive coordinate=1, kind='polynomial', coefficients=0.3,2,0.5 /
&drive coordinate=5, kind='polynomial', coefficients=0.2,-1,0.7 /
&body link=4, mass=2, centre=0.2,0.1,0.05, inertia=0.02,0.03,0.03,0.001,0,0.002 /
&gravity acceleration=0,0,-9.81 /
&time end=1, intervals=8 /
"""


@pytest.fixture
def case(checks, tmp_path, mech9k, mech9d):
    return Case(checks, tmp_path, mech9k, mech9d)


def columns_of(case, text, *options, program=None):
    path = os.path.join(case.directory, 'a.nml')
    with open(path, 'w') as file:
        file.write(text)
    done = run(program or case.mech9k, path, '--quiet', '--table', '-', *options)
    if done.returncode != 0:
        raise RuntimeError(f'{text}{options} ended with {done.returncode}:\n{done.stderr}')
    return read_table(done.stdout)


def four_bar(angle, speed=SPEED):
    """Angles of coupler and rocker of the open linkage, their rates and accelerations at constant speed of the crank, from its loop
    a exp(i t2) + b exp(i t3) = d + c exp(i t4)."""
    tip = A * np.exp(1j * angle)
    reach = D - tip
    inner = np.arccos((B**2 + np.abs(reach)**2 - C**2) / (2 * B * np.abs(reach)))
    coupler = np.angle(reach) + inner
    rocker = np.angle(tip + B * np.exp(1j * coupler) - D)
    u2, u3, u4 = (np.exp(1j * x) for x in (angle, coupler, rocker))

    def solve(right):
        """x, y with b u3 x - c u4 y = right, times i."""
        matrix = np.array([[B * u3.real, -C * u4.real], [B * u3.imag, -C * u4.imag]]).transpose(2, 0, 1)
        return np.linalg.solve(matrix, np.array([right.real, right.imag]).T[..., None])[..., 0].T
    rates = solve(-A * u2 * speed)
    accelerations = solve((A * u2 * speed**2 + B * u3 * rates[0]**2 - C * u4 * rates[1]**2) / 1j)
    return np.array([coupler, rocker]), rates, accelerations


def test_norton(case):
    """The numbers of the book, and the closed form over three turns, without jumps."""
    table = columns_of(case, NORTON.format(guess=-20))
    for name, value, places in (('L3.phi', 20.298, 3), ('L4.phi', 57.325, 3)):
        case.checks.equal(round(table[name][0], places), value, f'Norton: {name}')
    for name, value in (('L3.omega', -4.121), ('L4.omega', 6.998)):
        case.checks.equal(round(table[name][0] * DEGREE, 3), value, f'Norton: {name}')
    angles, rates, accelerations = four_bar(40 * DEGREE + SPEED * table['t'])
    case.checks.near(table['L2.phi'], 40 + SPEED / DEGREE * table['t'], 1e-12, 'the crank goes on over its turns')
    for i, link in enumerate((3, 4)):
        case.checks.near(table[f'L{link}.phi'] * DEGREE, angles[i], 1e-12, f'angle of link {link}')
        case.checks.near(table[f'L{link}.omega'] * DEGREE, rates[i], 1e-11, f'rate of link {link}', scale=np.abs(rates[i]).max())
        case.checks.near(table[f'L{link}.alpha'] * DEGREE, accelerations[i], 1e-10, f'acceleration of link {link}',
                         scale=np.abs(accelerations[i]).max())


def test_a_guess_a_turn_away_gives_the_same_angles(case):
    near, far = (columns_of(case, NORTON.format(guess=guess)) for guess in (-20, 340))
    for name in ('L2.phi', 'L3.phi', 'L4.phi'):
        case.checks.near(far[name], near[name], 1e-12, f'{name} by another guess')


def test_poles(case):
    """The lines of crank and rocker meet in the pole of the coupler (Kennedy); the crank turns about its pair."""
    table = columns_of(case, NORTON.format(guess=-20))
    crank = 40 * DEGREE + SPEED * table['t']
    rocker = four_bar(crank)[0][1]
    # s exp(i crank) = d + r exp(i rocker)
    s = D * np.sin(rocker) / np.sin(rocker - crank)
    distance = np.hypot(s * np.cos(crank), s * np.sin(crank))
    # the pole is at the distance v/omega, whose relative error is that of omega, a difference of rates near 1
    error = np.hypot(table['L3.pole.x'] - s * np.cos(crank), table['L3.pole.y'] - s * np.sin(crank))
    case.checks.true(np.all(error <= 1e-12 * (1 + distance / D)**2), 'the pole of the coupler', (error / distance).max())
    case.checks.near(np.hypot(table['L2.pole.x'], table['L2.pole.y']), 0, 1e-15, 'the pole of the crank')


@pytest.mark.parametrize('normal', [(0, 1, 0), (-1, 0, 0), (0, 0, -1), (1, 2, -2)])
def test_other_planes(case, normal):
    """Angles do not depend on the plane; poles are in the axes of link 1, the two of its plane or all three."""
    z = np.array(normal) / np.linalg.norm(normal)
    x = np.cross(z, (0.3, 0.5, 0.8))
    x /= np.linalg.norm(x)

    def place(px):
        return ','.join(repr(float(v)) for v in px * x)
    axis = f'axis={",".join(map(str, normal))}, zero={place(1)}'
    text = NORTON.format(guess=-20).replace('axis=0,0,1', axis)
    for px in (0.04, 0.12, 0.08, 0.1):
        text = text.replace(f'point={px},0,0', f'point={place(px)}')
    table, flat = columns_of(case, text), columns_of(case, NORTON.format(guess=-20))
    for name in ('L2.phi', 'L3.phi', 'L4.phi', 'L3.omega', 'L4.alpha'):
        case.checks.near(table[name], flat[name], 1e-10, f'{name} across {normal}', scale=np.abs(flat[name]).max())
    names = [name for name in table if name.startswith('L3.pole')]
    expected = {(0, 1, 0): 'xz', (-1, 0, 0): 'yz', (0, 0, -1): 'xy', (1, 2, -2): 'xyz'}[normal]
    case.checks.equal(''.join(name[-1] for name in names), expected, 'the axes of poles')
    y = np.cross(z, x)
    for name in names:
        i = 'xyz'.index(name[-1])
        case.checks.near(table[name], flat['L3.pole.x'] * x[i] + flat['L3.pole.y'] * y[i], 1e-9, f'{name} across {normal}')


def test_other_numbers_and_faces(case):
    """Links and coordinates with other numbers, pairs from the other side, and a coupler that is drawn face down."""
    text = """&mechanism angle_unit='deg' /
&structure cq=3 /
&pair coordinate=3, links=1,4, kind='revolute', axis=0,0,1 /
&pair coordinate=1, links=2,4, kind='revolute', axis=0,0,-1, zero=1,0,0, point=0,0,0, moving_point=0.04,0,0, moving_axis=0,0,1 /
&pair coordinate=4, links=2,3, kind='revolute', axis=0,0,-1, zero=1,0,0, point=0.12,0,0, moving_point=0.08,0,0, moving_axis=0,0,1 /
&pair coordinate=2, links=3,1, kind='revolute', axis=0,0,1, point=0,0,0, moving_point=0.1,0,0 /
&initial coordinate=1, position=20 /
&initial coordinate=4, position=37 /
&initial coordinate=2, position=-60 /
&drive coordinate=3, kind='polynomial', coefficients=40, 1432.3944878270580 /
&time start=0, end=0.7, intervals=140 /
&output links=4,2,3, poles=2 /
"""
    table, flat = columns_of(case, text), columns_of(case, NORTON.format(guess=-20))
    # the first turning pair by number is pair 1, whose axis in link 2 points down: so do the normals of all links
    for other, name in ((4, 'L2'), (3, 'L4')):
        for kind, tolerance in (('phi', 1e-12), ('omega', 1e-11), ('alpha', 1e-10)):
            values = flat[f'{name}.{kind}']
            case.checks.near(table[f'L{other}.{kind}'], values, tolerance, f'{kind} of {name} by another number', scale=max(1.0, np.abs(values).max()))
    # its x axis shows to the rocker and its z axis away from the viewer: half a turn about an axis of the plane came first
    turn = table['L2.phi'] - flat['L3.phi']
    case.checks.near(turn, turn[0], 1e-12, 'the coupler face down: the same angle but for a constant')
    for axis in 'xy':
        case.checks.near(table[f'L2.pole.{axis}'], flat[f'L3.pole.{axis}'], 1e-9, f'its pole along {axis}')


def frame(axis, zero):
    z = np.array(axis, np.longdouble) / np.sqrt(np.sum(np.array(axis, np.longdouble)**2))
    x = np.array(zero, np.longdouble) - np.dot(zero, z) * z
    x /= np.sqrt(np.sum(x**2))
    return np.array([x, np.cross(z, x), z]).T


def about_z(angle):
    c, s, o, i = np.cos(angle), np.sin(angle), np.zeros_like(angle), np.ones_like(angle)
    return np.array([[c, -s, o], [s, c, o], [o, o, i]]).transpose(2, 0, 1)


def spatial_rotations(t):
    """Rotations of links 2, 3 and 4 of SPATIAL, in extended precision."""
    degree = np.arccos(np.longdouble(-1)) / 180
    q1, q2, q3 = ((20 + 300 * t - 40 * t**2) * degree, (-70 + 150 * t + 90 * t**2) * degree,
                  (10 - 420 * t + 25 * t**2 + 8 * t**3) * degree)
    two = frame((0.2, -0.3, 1), (1, 0.5, 0)) @ about_z(q1) @ frame((0, 1, 0.3), (1, 0, 0)).T
    screw = frame((1, 0.4, -0.2), (0, 1, 0))
    three = two @ screw @ about_z(-q2) @ screw.T
    # axis (0,-1,0.7): x axis 1,0,0 by default; in the moving link, axis x: y by default
    four = three @ frame((0, -1, 0.7), (1, 0, 0)) @ about_z(q3) @ frame((1, 0, 0), (0, 1, 0)).T
    return {2: two, 3: three, 4: four}


def rotation_of(e):
    w, x, y, z = e
    return np.array([[w*w + x*x - y*y - z*z, 2*(x*y - w*z), 2*(x*z + w*y)], [2*(x*y + w*z), w*w - x*x + y*y - z*z, 2*(y*z - w*x)],
                     [2*(x*z - w*y), 2*(y*z + w*x), w*w - x*x - y*y + z*z]]).transpose(2, 0, 1)


def slopes(function, t):
    """First derivative in extended precision, by differences of eighth order."""
    h = np.longdouble(2.0**-9)
    weights = (np.longdouble(4) / 5, -np.longdouble(1) / 5, np.longdouble(4) / 105, -np.longdouble(1) / 280)
    return {k: sum(w * (function(t + i * h)[k] - function(t - i * h)[k]) / h for i, w in enumerate(weights, 1)) for k in function(t)}


def spin(t):
    """Angular velocities: the vectors of dR/dt R^T."""
    rotations, rates = spatial_rotations(t), slopes(spatial_rotations, t)
    skew = {k: rates[k] @ rotations[k].transpose(0, 2, 1) for k in rates}
    return {k: np.array([s[:, 2, 1] - s[:, 1, 2], s[:, 0, 2] - s[:, 2, 0], s[:, 1, 0] - s[:, 0, 1]]) / 2 for k, s in skew.items()}


def test_space(case):
    """Quaternions over several turns, angular velocities and accelerations in degrees."""
    table = columns_of(case, SPATIAL)
    t = table['t'].astype(np.longdouble)
    rotations, velocities, accelerations = spatial_rotations(t), spin(t), slopes(spin, t)
    for link in (2, 3, 4):
        e = np.array([table[f'L{link}.e{i}'] for i in range(4)])
        case.checks.near(np.sum(e**2, axis=0), 1, 1e-14, f'unit quaternion of link {link}')
        case.checks.near(rotation_of(e), rotations[link].astype(float), 1e-12, f'rotation of link {link}')
        case.checks.true(e[np.argmax(np.abs(e[:, 0]) > 1e-9), 0] > 0, f'link {link} begins with a positive part')
        for kind, values in (('w', velocities), ('alpha', accelerations)):
            mine = np.array([table[f'L{link}.{kind}{axis}'] for axis in 'xyz']) * DEGREE
            expected = values[link].astype(float)
            # second differences in extended precision lose 1e-19/h**2
            case.checks.near(mine, expected, 1e-11, f'{kind} of link {link}', scale=np.abs(expected).max())


def test_quaternions_have_no_jumps(case):
    """Between rows of 1/20000 s a link turns by less than a degree; e follows de/dt = (0, omega) e / 2, also where rows are whole turns
    apart."""
    fine = columns_of(case, SPATIAL.replace('intervals=80', 'intervals=80000'))
    coarse = columns_of(case, SPATIAL.replace('intervals=80', 'intervals=5'))
    for link in (2, 3, 4):
        e = np.array([fine[f'L{link}.e{i}'] for i in range(4)])
        case.checks.true(np.abs(np.diff(e)).max() < 1e-3, f'link {link}: the quaternion has no jumps')
        case.checks.true(e[0].min() < 0 < e[0].max(), f'link {link}: its sign changes with whole turns')
        for i in range(4):
            case.checks.near(coarse[f'L{link}.e{i}'], fine[f'L{link}.e{i}'][::16000], 1e-12, f'link {link}: e{i} in few rows')
        omega = np.array([fine[f'L{link}.w{axis}'] for axis in 'xyz']) * DEGREE
        rate = np.gradient(e, fine['t'], axis=1, edge_order=2)
        expected = np.array([-np.sum(omega * e[1:], axis=0), *(e[0] * omega + np.cross(omega.T, e[1:].T).T)]) / 2
        # central differences at 5e-5 s; rates change by up to 30 a second
        case.checks.near(rate, expected, 1e-5, f'link {link}: rates of the quaternion', scale=np.abs(expected).max())


def test_quaternions_pass_gimbal_lock(case):
    """The heavy top of the gallery falls through the gimbal lock of its hinges, whose angles jump there; its quaternion does not."""
    text = text_of(os.path.join(TREE, 'examples', 'heavy_top', 'heavy_top.nml')).replace('&output', '&output links=4,')
    table = columns_of(case, text, '--set', 'time.intervals=20000', program=case.mech9d)
    e = np.array([table[f'L4.e{i}'] for i in range(4)])
    omega = np.array([table[f'L4.w{axis}'] for axis in 'xyz'])
    # |de| <= |omega| dt/2
    bound = 0.5 * np.linalg.norm(omega, axis=0).max() * (table['t'][1] - table['t'][0])
    case.checks.true(np.linalg.norm(np.diff(e), axis=0).max() <= 1.1 * bound, 'no jumps', np.abs(np.diff(e)).max())


def test_one_instant(case):
    """&time at= gives one row: that of a run which is there at this time. It counts before start, end and intervals."""
    whole = columns_of(case, NORTON.format(guess=-20).replace('end=0.7, intervals=140', 'end=0.02, intervals=1'))
    for text in (NORTON.format(guess=-20).replace('start=0, end=0.7, intervals=140', 'at=0.02'), NORTON.format(guess=-20)):
        one = columns_of(case, text, *(() if 'at=' in text else ('--set', 'time.at=0.02')))
        case.checks.equal(one['t'].tolist(), [0.02], 'one row')
        for name in ('q1', 'L3.phi', 'L3.omega', 'L4.alpha', 'L3.pole.x'):
            case.checks.near(one[name][0], whole[name][1], 1e-10, name, scale=abs(whole[name][1]))


def against_runs(case, text, parameters, program=None, tolerance=2e-9, prefixes=('L', 'R'), relative_step=STEP):
    """Derivatives of the columns of links and forces against differences of runs."""
    declared = ''.join(f"&parameter name='{name}', sets='{target}', value={value!r} /\n" for name, target, value in parameters)
    plain = text + declared
    table = columns_of(case, plain, '--set', 'output.sensitivities=.true.', program=program)
    names = [name for name in table if name.startswith(prefixes)]
    case.checks.true(len(names) > 3, 'columns to compare', names)
    for number, (name, _, value) in enumerate(parameters, 1):
        step = relative_step * (abs(value) or 0.1)
        expected = {column: 0 for column in names}
        for i, weight in enumerate(WEIGHTS, 1):
            above, below = (columns_of(case, plain, '--set', f'parameter({number}).value={value + sign * i * step!r}', program=program)
                            for sign in (1, -1))
            for column in names:
                expected[column] = expected[column] + weight * (above[column] - below[column]) / step
        for column in names:
            # parts of one vector count together: those across its plane are round-off
            alike = [other for other in names if other[0] == column[0] and other.split('.')[1].rstrip('xyz0123') == column.split('.')[1].rstrip('xyz0123')]
            largest = max(max(np.abs(expected[other]).max(), 1e-3 * np.abs(table[other]).max()) for other in alike)
            case.checks.near(table[f'd({column})/d({name})'], expected[column], tolerance, f'{column} by {name}', scale=largest)


def test_derivatives_in_the_plane(case):
    text = NORTON.format(guess=-20).replace('intervals=140', 'intervals=7').replace('end=0.7', 'end=0.2')
    against_runs(case, text, (('crank', 'pair(2).point(1)', 0.04), ('rocker', 'pair(3).moving_point(1)', 0.08), ('speed', 'drive.coefficients(2)', 1432.0),
                              ('base', 'pair(4).point(2)', 0.0)), relative_step=2.0**-11, tolerance=2e-8)


def test_derivatives_by_the_system_of_a_link(case):
    """A parameter turns the axes of the coupler, so that its angle changes and the motion does not."""
    text = NORTON.format(guess=-20).replace("axis=0,0,1, point=0.04,0,0", "axis=0,0,1, zero=1,0.1,0, moving_zero=1,0,0, point=0.04,0,0")
    table = columns_of(case, text + "&parameter name='x', sets='pair(2).zero(2)' /\n", '--set', 'output.sensitivities=.true.',
                       '--set', 'time.intervals=5')
    # q2 changes by the opposite of the angle of zero, the coupler not at all
    case.checks.near(table['d(L3.phi)/d(x)'], 0, 1e-10, 'the coupler stays')
    case.checks.near(table['d(q2)/d(x)'], -1 / 1.01 / DEGREE, 1e-12, 'its coordinate does not')


def test_derivatives_in_space(case):
    text = SHAFTS + '&output links=2,3,4, reactions=.true., reaction_magnitudes=.true. /\n'
    against_runs(case, text, (('tilt', 'pair(3).axis(1)', 0.5), ('arm', 'pair(4).point(1)', 0.3), ('cone', 'pair(4).axis(3)', 0.2),
                              ('mass', 'body.mass', 2.0)))
    turned = SHAFTS + "&output links=4, reactions=.true., reaction_magnitudes=.true., reaction_axes='link' /\n"
    against_runs(case, turned, (('tilt', 'pair(3).axis(1)', 0.5), ('cone', 'pair(4).axis(3)', 0.2)))


def test_derivatives_in_dynamics(case):
    """A double pendulum, released; angles of its links are sums of its coordinates."""
    text = """&mechanism angle_unit='deg' /
&structure cq=1,2 /
&pair coordinate=1, links=1,2, kind='revolute', axis=0,0,1 /
&pair coordinate=2, links=2,3, kind='revolute', axis=0,0,1, point=1,0,0, moving_point=0,0,0 /
&initial coordinate=1, position=-20, velocity=30 /
&initial coordinate=2, position=200, velocity=-10 /
&body link=2, mass=1.2, centre=0.5,0,0, inertia=0,0,0.1,0,0,0 /
&body link=3, mass=0.7, centre=0.4,0,0, inertia=0,0,0.05,0,0,0 /
&gravity acceleration=0,-9.81,0 /
&time end=0.6, intervals=6 /
&solver method='prince-dormand', relative_tolerance=1e-12, absolute_tolerance=1e-13 /
&output links=2,3, poles=3 /
"""
    table = columns_of(case, text, program=case.mech9d)
    case.checks.near(table['L3.phi'], table['q1'] + table['q2'], 1e-12, 'the angle of the second link: it begins at 180, not at -180')
    case.checks.near(table['L3.alpha'], table['ddq1'] + table['ddq2'], 1e-12, 'its acceleration')
    against_runs(case, text, (('length', 'pair(2).point(1)', 1.0), ('mass', 'body(2).mass', 0.7)), program=case.mech9d, tolerance=1e-7,
                 prefixes='L')


def test_quantities(case, tmp_path):
    """The swing of the rocker and its greatest speed, with derivatives, against the closed form."""
    def extremes(crank):
        """Rocker angles of both dead points: crank and coupler in one line."""
        def rocker(reach):
            return np.pi - np.arccos((C**2 + D**2 - reach**2) / (2 * C * D))
        return (rocker(B + crank) - rocker(B - crank))
    text = NORTON.format(guess=-20) + """&quantity name='swing', of='L4.phi', take='range' /
&quantity name='turn', of='L2.phi', take='end' /
&quantity name='mean', of='L3.omega', take='mean' /
&parameter name='crank', sets='pair(2).point(1)' /
"""
    path = tmp_path / 'a.nml'
    path.write_text(text)
    report = tmp_path / 'report.json'
    done = run(case.mech9k, path, '--quiet', '--report', report, '--table', tmp_path / 'a.dat', '--set', 'output.gradients=.true.')
    case.checks.equal(done.returncode, 0, done.stderr)
    quantities = {q['name']: q for q in json.loads(report.read_text())['quantities']}
    swing = abs(extremes(A)) / DEGREE
    h = 1e-5
    slope = (abs(extremes(A + h)) - abs(extremes(A - h))) / (2 * h) / DEGREE
    case.checks.near(quantities['swing']['value'], swing, 1e-9, 'the swing of the rocker', scale=swing)
    case.checks.near(quantities['turn']['value'], 40 + 0.7 * SPEED / DEGREE, 1e-12, 'turns of the crank', scale=1000)
    gradient = {g['parameter']: g['value'] for g in quantities['swing']['gradient']}
    case.checks.near(gradient['crank'], slope, 1e-7, 'its derivative', scale=abs(slope))
    coupler = four_bar(40 * DEGREE + SPEED * np.array([0, 0.7]))[0][0]
    case.checks.near(quantities['mean']['value'], (coupler[1] - coupler[0]) / 0.7 / DEGREE, 1e-9, 'mean rate of the coupler', scale=100)


def test_other_units(case):
    """Angles and rates do not depend on the unit of length, poles are in it; rates have a unit of their own."""
    flat = columns_of(case, NORTON.format(guess=-20))
    text = NORTON.format(guess=-20).replace("angle_unit='deg'", "angle_unit='deg', length_unit='mm', rate_unit='rad/s'")
    for length in ('0.04', '0.12', '0.08', '0.1'):
        text = text.replace(f'point={length},', f'point={1000 * float(length)},')
    table = columns_of(case, text.replace('1432.3944878270580', '25'))
    case.checks.near(table['L3.pole.x'], 1000 * flat['L3.pole.x'], 1e-9, 'poles in mm', scale=np.abs(flat['L3.pole.x']).max())
    for name, factor in (('L3.phi', 1), ('L3.omega', DEGREE), ('L3.alpha', 1)):
        case.checks.near(table[name], factor * flat[name], 1e-10, name, scale=np.abs(factor * flat[name]).max())


def test_names_of_links(case):
    """Links are named by their names, also among numbers, in &output and in quantities."""
    text = NORTON.format(guess=-20).replace('links=2,3,4, poles=2,3', "links=2,'coupler',4, poles='coupler'") \
        + "&link number=3, name='coupler' /\n&quantity name='end', of='coupler.phi', take='end' /\n"
    table, flat = columns_of(case, text), columns_of(case, NORTON.format(guess=-20))
    case.checks.near(table['L3.phi'], flat['L3.phi'], 1e-15, 'the coupler by its name')
    case.checks.near(table['L3.pole.x'], flat['L3.pole.x'], 1e-15, 'its pole')


def test_translation_has_no_pole(case):
    """The coupler of a parallelogram never turns: its pole is not a number; its angle and rate are zero."""
    text = """&structure cq=1 /
&pair coordinate=1, links=1,2, kind='revolute', axis=0,0,1 /
&pair coordinate=2, links=2,3, kind='revolute', point=0.5,0,0, axis=0,0,1, moving_point=0,0,0 /
&pair coordinate=3, links=3,4, kind='revolute', point=1,0,0, axis=0,0,1, moving_point=0.5,0,0 /
&pair coordinate=4, links=1,4, kind='revolute', point=1,0,0, axis=0,0,1, moving_point=0,0,0 /
&initial coordinate=2, position=-1 /
&initial coordinate=4, position=1 /
&drive coordinate=1, kind='polynomial', coefficients=1,1 /
&time end=1, intervals=10 /
&output links=3, poles=3 /
"""
    table = columns_of(case, text)
    case.checks.near(table['L3.phi'], 0, 1e-13, 'the angle of the coupler')
    case.checks.near(table['L3.omega'], 0, 1e-12, 'its rate')
    case.checks.true(np.all(np.isnan(table['L3.pole.x'])), 'its pole does not exist', table['L3.pole.x'])


def test_fewer_derivatives(case):
    table = columns_of(case, NORTON.format(guess=-20).replace('poles=2,3', 'derivatives=1, coordinates=1'))
    case.checks.equal([name for name in table if name.startswith('L3')], ['L3.phi', 'L3.omega'], 'angles and rates')
    angles, rates, _ = four_bar(40 * DEGREE + SPEED * table['t'])
    case.checks.near(table['L3.phi'] * DEGREE, angles[0], 1e-12, 'where the coordinates of the coupler are not recorded')
    case.checks.near(table['L3.omega'] * DEGREE, rates[0], 1e-11, 'its rate', scale=np.abs(rates).max())


def test_forces_in_other_forms(case):
    """Components along the axes of the moving link are the others turned back by its angle; magnitudes do not depend on axes."""
    masses = ''.join(f'&body link={k}, mass={m}, centre={x},0.01,0, inertia=0,0,1e-4,0,0,0 /\n' for k, m, x in ((2, 1, 0.02), (3, 2, 0.06), (4, 1.5, 0.04)))
    text = NORTON.format(guess=-20) + masses + '&gravity acceleration=0,-9.81,0 /\n'
    fixed = columns_of(case, text, '--set', 'output.reactions=.true.', '--set', 'output.reaction_magnitudes=.true.')
    turned = columns_of(case, text, '--set', 'output.reactions=.true.', '--set', 'output.reaction_magnitudes=.true.', '--set', 'output.reaction_axes=link')
    for pair, link in ((1, 2), (2, 3), (3, 4), (4, 4)):
        force = fixed[f'R{pair}.fx'] + 1j * fixed[f'R{pair}.fy']
        expected = force * np.exp(-1j * DEGREE * fixed[f'L{link}.phi'])
        mine = turned[f'R{pair}.fx'] + 1j * turned[f'R{pair}.fy']
        case.checks.near(np.abs(mine - expected), 0, 1e-11 * np.abs(force).max(), f'pair {pair}: force along the axes of link {link}')
        for table in (fixed, turned):
            case.checks.near(table[f'R{pair}.f'], np.abs(force), 1e-12, f'pair {pair}: magnitude', scale=np.abs(force).max())
        case.checks.near(fixed[f'R{pair}.m'], np.abs(fixed[f'R{pair}.mz']), 1e-12, f'pair {pair}: moment')


def test_undetermined_columns_have_names(case, tmp_path):
    """Of a planar linkage in the plane of x and z: forces along y and moments about x and z are across the plane."""
    text = NORTON.format(guess=-20).replace('axis=0,0,1', 'axis=0,1,0, zero=1,0,0')
    path = tmp_path / 'a.nml'
    path.write_text(text)
    report = tmp_path / 'a.json'
    done = run(case.mech9k, path, '--set', 'output.reactions=.true.', '--table', tmp_path / 'a.dat', '--report', report)
    case.checks.true('12 of the 24 components' in done.stderr and ': R1.fy R1.mx R1.mz R2.fy' in done.stderr, 'a run names the columns',
                     done.stderr)
    reactions = json.loads(report.read_text())['reactions']
    case.checks.equal([one['undetermined_columns'] for one in reactions], [[f'R{k}.fy', f'R{k}.mx', f'R{k}.mz'] for k in range(1, 5)], 'the report')
    done = run(case.mech9k, path, '--set', 'output.reactions=.true.', '--check')
    case.checks.true('pair 3: force along z, moment about x y; columns R3.fy R3.mx R3.mz\n' in done.stdout, 'the check', done.stdout)
    case.checks.true('across the plane' in done.stdout, 'and says that they are across the plane', done.stdout)
    case.checks.true('links 2, 3, 4: angle phi about the axis of pair 1, which points along (0, 1, 0) in link 1' in done.stdout,
                     'the axis of angles', done.stdout)


def test_axes_of_forces_stand_in_heads(case, tmp_path):
    path = tmp_path / 'a.nml'
    path.write_text(NORTON.format(guess=-20))
    done = run(case.mech9k, path, '--quiet', '--set', 'output.reactions=.true.', '--set', 'output.reaction_axes=link', '--table', '-')
    case.checks.true('# forces and moments in pairs: along the axes of the moving links\n' in done.stdout, 'the head', done.stdout[:300])


@pytest.mark.parametrize('output, words', [
    ('links=1', 'link 1 is the frame'), ('links=9', 'there is no link 9; they are 1 to 4'), ('links=3,3', 'link 3 is there already'),
    ('poles=3, derivatives=0', 'poles follow from velocities'), ('reaction_magnitudes=.true.', 'set reactions=.true., too'),
    ("reaction_axes='link'", 'set reactions=.true., too'), ("reactions=.true., reaction_axes='other'", "'other'")])
def test_wrong_requests(case, output, words):
    case.refused(NORTON.format(guess=-20).replace('links=2,3,4, poles=2,3', output), 3, words)


def test_no_poles_in_space(case):
    case.refused(SPATIAL.replace('links=4,2,3', 'poles=3'), 3, 'pair 2 leaves the plane across the axis of pair 1')
    case.refused("&pair coordinate=1, links=1,2, kind='prismatic', axis=0,0,1 /\n&structure cq=1 /\n"
                 "&drive coordinate=1, kind='polynomial', coefficients=0,1 /\n&output poles=2 /\n", 3, 'no pair of this mechanism is revolute')


@pytest.mark.parametrize('column, words', [
    ('L3.e0', 'the mechanism is planar'), ('L4.phi', 'set links=4 in &output'), ('L9.phi', 'there is no link 9'),
    ('L3.pole.x', 'set poles=3 in &output'), ('L3.alpha', 'set derivatives=2 in &output'), ('R1.f', 'set reactions=.true.'),
    ('L2.pole.x', "take 'start', 'end' or 'at'")])
def test_columns_that_are_missing(case, column, words):
    text = NORTON.format(guess=-20).replace('links=2,3,4, poles=2,3', 'links=2,3, poles=2, derivatives=1')
    case.refused(text + f"&quantity name='one', of='{column}', take='max' /\n", 3, words)


def test_hdf5(case, tmp_path):
    h5py = pytest.importorskip('h5py')
    path = tmp_path / 'a.nml'
    path.write_text(NORTON.format(guess=-20) + "&parameter name='crank', sets='pair(2).point(1)' /\n")
    done = run(case.mech9k, path, '--quiet', '--hdf5', tmp_path / 'a.h5', '--table', tmp_path / 'a.dat', '--set', 'output.sensitivities=.true.')
    case.checks.equal(done.returncode, 0, done.stderr)
    table = read_table((tmp_path / 'a.dat').read_text())
    with h5py.File(tmp_path / 'a.h5') as file:
        for column in ('L3.phi', 'L3.pole.x'):
            name = column.replace('.', '_')
            case.checks.near(file[name][:], table[column], 1e-15, f'{name} in the file')
            case.checks.near(file['sensitivity/' + name][:, 0], table[f'd({column})/d(crank)'], 1e-15, f'its derivative')
        case.checks.equal(file['L3_phi'].attrs['units'] if isinstance(file['L3_phi'].attrs['units'], str)
                          else file['L3_phi'].attrs['units'].decode(), 'deg', 'its unit')
