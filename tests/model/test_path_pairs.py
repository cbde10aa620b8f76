"""Pairs along curves, against closed forms: lines, circles, ellipses, helices and cycloids; their forces, their ends, bad input.

Compares the program with itself in part: paths on lines, circles and helices against pairs with fixed axes, other numbers of
links and coordinates, a curve in the moving link; all else is closed forms and identities.
"""
import math
import os

import numpy as np
import pytest

from mech9_cases import run, table_of, text_of

DATA, SINGULAR, FILE = 3, 6, 8
GRAVITY = '&gravity acceleration=0,-9.81,0 /\n'


class Cases:
    def __init__(self, mech9k, mech9d, folder, checks):
        self.mech9k, self.mech9d, self.folder, self.checks = mech9k, mech9d, folder, checks

    def write(self, name, text):
        path = os.path.join(self.folder, name)
        with open(path, 'w', encoding='utf-8') as file:
            file.write(text)
        return path

    def curve(self, points, name='curve.dat'):
        self.write(name, '# a curve\n' + ''.join(' '.join(f'{float(x)!r}' for x in point) + '\n' for point in points))

    def table(self, text, program=None, options=()):
        return table_of(program or self.mech9k, self.write('case.nml', text), *options)

    def near(self, table, name, expected, tolerance, why):
        """Largest deviation of a column."""
        error = float(np.max(np.abs(table[name] - expected)))
        self.checks.true(error <= tolerance, f'{why}: {name} differs by {error:.3g}, and {tolerance:.3g} is allowed')
        return error


@pytest.fixture
def s(checks, mech9k, mech9d, tmp_path):
    return Cases(mech9k, mech9d, tmp_path, checks)


def closed(points):
    """The points, the last one equal to the first one."""
    points = np.array(points)
    points[-1] = points[0]
    return points


def agm(a, b):
    """Arithmetic-geometric mean, and the sum of the second kind (Abramowitz and Stegun, 17.6)."""
    total, power = 0.5 * (a * a - b * b), 0.5
    while abs(a - b) > 4e-16 * a:
        power *= 2
        total += power * (0.5 * (a - b)) ** 2
        a, b = 0.5 * (a + b), math.sqrt(a * b)
    return a, total


CRANK = """&structure cq=1 /
&pair coordinate=1, links=1,2, kind='revolute', axis=0,0,1 /
&pair coordinate=2, links=2,3, kind='revolute', axis=0,0,1, point=0.2,0,0 /
{guide}
&pair coordinate=4, links=4,3, kind='revolute', axis=0,0,1, point=0,0,0, moving_point=0.9,0,0 /
&drive coordinate=1, kind='polynomial', coefficients=0.3, 4 /
&initial coordinate=3, position=1 /
&point name='P', link=3, position=0.4,0.1,0 /
&time end=2, intervals=50 /
"""


def test_straight_line(s):
    """A slider-crank whose slide is a straight path through points at uneven distances, against one with a prismatic pair."""
    along = np.array([2.0, -1.0]) / math.sqrt(5.0)
    s.curve([d * along for d in (0.0, 0.13, 0.4, 0.5, 0.93, 1.3)])
    exact = s.table(CRANK.format(guide="&pair coordinate=3, links=1,4, kind='prismatic', axis=2,-1,0, moving_axis=1,0,0, zero=0,0,1, "
                                       "moving_zero=0,0,1 /"))
    for orientation in ('fixed', 'tangent'):
        # a fixed link system stays parallel to that of link 1, the other one has its x axis along the line
        table = s.table(CRANK.format(guide=f"&pair coordinate=3, links=1,4, kind='path', file='curve.dat', orientation='{orientation}' /"))
        for name in ('q1', 'q2', 'q3', 'P.x', 'P.y', 'dq3', 'P.vx'):
            s.near(table, name, exact[name], 1e-12, f'straight path, {orientation}')
        for name in ('ddq3', 'P.ax', 'P.ay'):
            s.near(table, name, exact[name], 1e-10, f'straight path, {orientation}')


def test_circle(s):
    """A four-bar whose rocker is a block on a circle: the errors fall with the sixth, fifth and fourth power of the distance."""
    four_bar = """&structure cq=1 /
&pair coordinate=1, links=1,2, kind='revolute', axis=0,0,1 /
&pair coordinate=2, links=2,3, kind='revolute', axis=0,0,1, point=0.1,0,0 /
{guide}
&drive coordinate=1, kind='polynomial', coefficients=0.3, 4 /
&initial coordinate=2, position=1 /
&initial coordinate=3, position={start} /
&point name='P', link=3, position=0.2,0.1,0 /
&time end=2, intervals=50 /
"""
    pin = "&pair coordinate=4, links=4,3, kind='revolute', axis=0,0,1, point={x},0,0, moving_point=0.5,0,0 /"
    exact = s.table(four_bar.format(guide="&pair coordinate=3, links=1,4, kind='revolute', axis=0,0,1, point=0.5,0,0, moving_point=0,0,0 /\n"
                                    + pin.format(x='0.3'), start=1.5))
    errors = []
    for n in (32, 64, 128):
        angle = 2 * math.pi * np.arange(n + 1) / n
        angle[:-1] += 0.25 * np.sin(angle[:-1]) + 0.15 * (np.arange(n) % 2) * 2 * math.pi / n   # at uneven distances
        s.curve(closed(np.c_[0.5 + 0.3 * np.cos(angle), 0.3 * np.sin(angle)]))
        table = s.table(four_bar.format(guide="&pair coordinate=3, links=1,4, kind='path', file='curve.dat' /\n" + pin.format(x='0'),
                                        start=0.45))
        errors.append([max(float(np.max(np.abs(table[name] - exact[name]))) for name in names)
                       for names in (('P.x', 'P.y'), ('P.vx', 'P.vy'), ('P.ax', 'P.ay'))])
    errors = np.array(errors)
    for i, (least, what) in enumerate(((40.0, 'positions'), (20.0, 'velocities'), (9.0, 'accelerations'))):
        s.checks.true(errors[1, i] / errors[2, i] > least, f'{what} on a circle converge: {errors[:, i]}')
    s.checks.true(errors[2, 0] < 1e-8, f'a circle of 128 points is nearly exact: {errors[2]}')


def test_ellipse(s):
    """A quarter of the length of an ellipse leads to its next vertex."""
    a, b, n = 0.8, 0.3, 400
    angle = 2 * math.pi * np.arange(n + 1) / n
    s.curve(closed(np.c_[a * np.cos(angle), b * np.sin(angle)]))
    mean, total = agm(a, b)
    quarter = 0.5 * math.pi * (a * a - total) / mean
    table = s.table(f"""&pair coordinate=1, links=1,2, kind='path', file='curve.dat', orientation='tangent' /
&structure cq=1 /
&drive coordinate=1, kind='polynomial', coefficients=0, {quarter!r} /
&point name='P', link=2 /
&point name='D', link=2, position=1,0,0 /
&time end=12, intervals=12 /
""")
    turn = 0.5 * math.pi * table['t']
    # twelve quarters: three turns of a closed curve
    s.near(table, 'P.x', a * np.cos(turn), 1e-11, 'vertices of an ellipse')
    s.near(table, 'P.y', b * np.sin(turn), 1e-11, 'vertices of an ellipse')
    table['D.x'] -= table['P.x']
    s.near(table, 'D.x', -np.sin(turn), 1e-11, 'tangents at the vertices of an ellipse')
    # the rate of a tangent is speed times curvature, b/a^2 and a/b^2 at the vertices
    curvature = np.where(np.arange(13) % 2 == 0, a / b ** 2, b / a ** 2)
    spin = table['D.vy'] - table['P.vy']
    spin = spin * np.cos(turn + 0.5 * math.pi) - (table['D.vx'] - table['P.vx']) * np.sin(turn + 0.5 * math.pi)
    s.checks.true(np.max(np.abs(spin - quarter * curvature)) < 1e-4,
                  f"a link that turns with an ellipse turns by its curvature: {np.abs(spin - quarter * curvature).max()}")


def test_helix(s):
    """A helix against a helical pair that moves a point beside its axis."""
    radius, pitch, n = 0.2, 0.3, 400
    rise = pitch / (2 * math.pi)
    speed = math.hypot(radius, rise)
    angle = np.linspace(-1.0, 4 * math.pi + 1.0, n + 1)
    s.curve(np.c_[radius * np.cos(angle), radius * np.sin(angle), rise * angle])
    ends = "&point name='P', link=2, position={x},0,0 /\n&time end=1.5, intervals=40 /\n&structure cq=1 /\n"
    drive = "&drive coordinate=1, kind='harmonic', mean={0}, amplitude={1}, angular_frequency=3, phase=0.4 /\n"
    exact = s.table("&pair coordinate=1, links=1,2, kind='helical', axis=0,0,1, pitch=0.3 /\n" + ends.format(x=radius)
                    + drive.format('6', '5'))
    table = s.table("&pair coordinate=1, links=1,2, kind='path', file='curve.dat' /\n" + ends.format(x=0)
                    + drive.format(repr(7 * speed), repr(5 * speed)))
    for name, tolerance in (('x', 1e-10), ('y', 1e-10), ('z', 1e-10), ('vx', 1e-8), ('vy', 1e-8), ('vz', 1e-8), ('ax', 1e-5),
                            ('ay', 1e-5), ('az', 1e-5)):
        s.near(table, f'P.{name}', exact[f'P.{name}'], tolerance, 'helix')


@pytest.mark.parametrize('start', [0.02, 0.2, 0.39])
@pytest.mark.parametrize('orientation', ['fixed', 'tangent'])
def test_tautochrone(s, orientation, start):
    """Beads on a cycloid swing harmonically about its lowest point, whatever their start: s'' = -g s/(4 a)."""
    a = 0.1
    angle = np.linspace(-0.9 * math.pi, 0.9 * math.pi, 241)
    s.curve(np.c_[a * (angle + np.sin(angle)), a * (1 - np.cos(angle))])
    middle = 4 * a * math.sin(0.45 * math.pi)     # arc length from the end to the lowest point
    frequency = math.sqrt(9.81 / (4 * a))
    # a body with inertia on a link that turns would swing otherwise
    table = s.table(f"""&pair coordinate=1, links=1,2, kind='path', file='curve.dat', orientation='{orientation}' /
&structure cq=1 /
&initial coordinate=1, position={start!r} /
&body link=2, mass=0.7 /
{GRAVITY}&time end=5, intervals=50 /
&solver relative_tolerance=1e-11, absolute_tolerance=1e-12 /
""", s.mech9d)
    # the frequency of a curve of 241 points differs by some 1e-9, over 25 rad
    s.near(table, 'q1', middle + (start - middle) * np.cos(frequency * table['t']), 2e-8, f'tautochrone from {start}')
    energy = table['E.total']
    s.checks.true(np.max(np.abs(energy - energy[0])) < 1e-9, f'a bead keeps its energy: {np.ptp(energy)}')


def trefoil(n=80):
    """A knot on a torus, whose tangent comes back turned about itself."""
    t = 2 * math.pi * np.arange(n + 1) / n
    return closed(np.c_[(2 + np.cos(3 * t)) * np.cos(2 * t), (2 + np.cos(3 * t)) * np.sin(2 * t), np.sin(3 * t)] * 0.1)


def test_body_on_a_knot(s):
    """A heavy body that turns with a closed curve in space: exact derivatives, energy, and the same motion with other numbers."""
    s.curve(trefoil())
    body = """&body link={link}, mass=1.3, centre=0.02,0.03,-0.01, inertia=0.01,0.02,0.015,0.001,0.002,-0.001 /
&gravity acceleration=1,-2,-9 /
&point name='P', link={link}, position=0.05,-0.02,0.07 /
&time end=6, intervals=120 /
&solver relative_tolerance=1e-11, absolute_tolerance=1e-12 /
"""
    table = s.table("&pair coordinate=1, links=1,2, kind='path', file='curve.dat', orientation='tangent' /\n&structure cq=1 /\n"
                    "&initial coordinate=1, position=0.3, velocity=2 /\n" + body.format(link=2), s.mech9d)
    length = 3.1898613119                       # of the exact knot times 0.1, by quadrature
    s.checks.true(table['q1'][-1] > 2 * length, 'the body runs round the knot more than once')
    energy = table['E.total']
    # the errors of 2600 steps add up, of 1e-11 of 6 J each: fifth derivatives of the curve jump at its points
    s.checks.true(np.max(np.abs(energy - energy[0])) < 1.5e-7, f'a body on a knot keeps its energy: {np.ptp(energy)}')
    # between two massless links that turn against each other by a drive at rest, with other numbers
    other = s.table("""&pair coordinate=3, links=1,4, kind='revolute', axis=1,2,3 /
&pair coordinate=1, links=4,2, kind='path', file='curve.dat', orientation='tangent' /
&pair coordinate=2, links=2,3, kind='prismatic', axis=0,1,0 /
&structure cq=1,2,3 /
&drive coordinate=3, kind='polynomial', coefficients=0 /
&drive coordinate=2, kind='polynomial', coefficients=0 /
&initial coordinate=1, position=0.3, velocity=2 /
""" + body.format(link=3), s.mech9d)
    # round-off and errors of integration of the same equations in another order
    for name in ('q1', 'P.x', 'P.y', 'P.z'):
        s.near(other, name, table[name], 1e-7, 'knot with other numbers')


def test_rates_on_a_knot(s):
    """They are the differences over 1e-4 s of a driven motion."""
    s.curve(trefoil())
    moved = s.table("""&pair coordinate=1, links=1,2, kind='path', file='curve.dat', orientation='tangent' /
&structure cq=1 /
&drive coordinate=1, kind='polynomial', coefficients=0.1, 1.5, 0.3 /
&point name='P', link=2, position=0.05,-0.02,0.07 /
&time end=2, intervals=20000 /
""")
    h = moved['t'][1] - moved['t'][0]
    for axis in 'xyz':
        rate = (moved[f'P.{axis}'][2:] - moved[f'P.{axis}'][:-2]) / (2 * h)
        # h^2/6 of derivatives that reach 1e4 and 4e5 at the end, where the radius is 0.1 m and the speed 2.7 m/s
        s.checks.true(np.max(np.abs(rate - moved[f'P.v{axis}'][1:-1])) < 2e-5, f'velocities on a knot are exact, {axis}')
        rate = (moved[f'P.v{axis}'][2:] - moved[f'P.v{axis}'][:-2]) / (2 * h)
        s.checks.true(np.max(np.abs(rate - moved[f'P.a{axis}'][1:-1])) < 1e-3, f'accelerations on a knot are exact, {axis}')


def test_curve_in_the_moving_link(s):
    """A curve in the moving link: the motion is the inverse one. A pin that is fixed in link 1 guides a slotted plate."""
    s.curve(trefoil())
    file = "kind='path', file='curve.dat', orientation='tangent'"
    rest = """&structure cq=1 /
&drive coordinate=1, kind='polynomial', coefficients=0.2, 1.3 /
&time end=3, intervals=30 /
"""
    forward = s.table(f"&pair coordinate=1, links=1,2, {file} /\n" + rest
                      + ''.join(f"&point name='{name}', link=2, position={place} /\n"
                                for name, place in (('O', '0,0,0'), ('X', '1,0,0'), ('Y', '0,1,0'), ('Z', '0,0,1'))))
    back = s.table(f"&pair coordinate=1, links=2,1, {file} /\n" + rest + "&point name='O', link=2 /\n")
    # the origin of link 2 in link 1 is -R^T p, and its velocity follows from differences of R and p
    place = np.array([forward[f'O.{x}'] for x in 'xyz'])
    turned = np.array([[forward[f'{axis}.{x}'] for x in 'xyz'] for axis in 'XYZ']) - place
    rate = np.array([forward[f'O.v{x}'] for x in 'xyz'])
    spun = np.array([[forward[f'{axis}.v{x}'] for x in 'xyz'] for axis in 'XYZ']) - rate
    bent = np.array([forward[f'O.a{x}'] for x in 'xyz'])
    spun_rate = np.array([[forward[f'{axis}.a{x}'] for x in 'xyz'] for axis in 'XYZ']) - bent
    for i, x in enumerate('xyz'):
        s.near(back, f'O.{x}', -np.sum(turned[i] * place, axis=0), 1e-13, 'inverse motion')
        s.near(back, f'O.v{x}', -np.sum(spun[i] * place + turned[i] * rate, axis=0), 1e-11, 'inverse motion')
        s.near(back, f'O.a{x}', -np.sum(spun_rate[i] * place + 2 * spun[i] * rate + turned[i] * bent, axis=0), 1e-9, 'inverse motion')


@pytest.mark.parametrize('orientation', ['fixed', 'tangent'])
def test_forces_on_a_circle(s, orientation):
    """A body that is driven round a circle upright in gravity: force and moment of the guide, force of the drive."""
    n, radius, mass, speed = 256, 0.4, 2.5, 1.7
    angle = 2 * math.pi * np.arange(n + 1) / n
    s.curve(closed(np.c_[radius * np.cos(angle), radius * np.sin(angle)]))
    table = s.table(f"""&pair coordinate=1, links=1,2, kind='path', file='curve.dat', orientation='{orientation}' /
&structure cq=1 /
&drive coordinate=1, kind='polynomial', coefficients=0, {speed} /
&body link=2, mass={mass}, inertia=0.1,0.2,0.3,0,0,0 /
{GRAVITY}&output reactions=.true., drive_forces=.true. /
&time end=2, intervals=40 /
""")
    turn = speed * table['t'] / radius
    centripetal = mass * speed ** 2 / radius
    # curvatures of a circle of 256 points are known to 1e-8
    s.near(table, 'R1.fx', -centripetal * np.cos(turn), 1e-6, f'force on a circle, {orientation}')
    s.near(table, 'R1.fy', -centripetal * np.sin(turn) + mass * 9.81, 1e-6, f'force on a circle, {orientation}')
    for name in ('fz', 'mx', 'my', 'mz'):
        s.near(table, f'R1.{name}', 0.0, 1e-6, f'force on a circle, {orientation}')
    # power of the drive is that against gravity
    s.near(table, 'F1', mass * 9.81 * np.cos(turn), 1e-5, f'drive on a circle, {orientation}')


# a curve of 2 m with ends, and a link on it
WITH_ENDS = [(0.0, 0.0), (0.5, 0.0), (1.0, 0.0), (2.0, 0.0)]
ON_CURVE = "&pair coordinate=1, links=1,2, kind='path', file='curve.dat' /\n&structure cq=1 /\n&time end=3, intervals=30 /\n"


@pytest.mark.parametrize('motion, time', [
    ("&drive coordinate=1, kind='polynomial', coefficients=0.5, 1 /\n", 1.5),
    ("&drive coordinate=1, kind='polynomial', coefficients=0.5, -1 /\n", 0.5),
    ('&initial coordinate=1, position=0.5, velocity=1 /\n&body link=2, mass=1 /\n&gravity acceleration=0,0,0 /\n', 1.5)],
    ids=['driven', 'driven_backwards', 'free'])
def test_end_of_a_curve_ends_a_motion(s, motion, time):
    """The motion ends there, in both programs, with the time and the coordinate."""
    s.curve(WITH_ENDS)
    done = run(s.mech9k if 'drive' in motion else s.mech9d, s.write('case.nml', ON_CURVE + motion), '--table', os.path.join(s.folder, 'table.dat'))
    s.checks.equal(done.returncode, SINGULAR, f'the end of a curve ends a motion: {done.stderr}')
    s.checks.true('case.nml:1:1: coordinate 1 comes to an end of its curve at t = ' in done.stderr, done.stderr)
    told = float(done.stderr.split('curve at t = ')[1].split(' s')[0]) if 'curve at t = ' in done.stderr else math.nan
    # mech9k tells the first output beyond the end
    s.checks.true(abs(told - time) < 0.11, f'the end of a curve is reached at {time}, and told is {told}')
    last = text_of(os.path.join(s.folder, 'table.dat')).splitlines()[-1].split()
    s.checks.true(float(last[0]) <= time + 1e-9, 'nothing is recorded beyond the end')


def test_motion_from_end_to_end(s):
    s.curve(WITH_ENDS)
    exactly = s.table(ON_CURVE + "&drive coordinate=1, kind='polynomial', coefficients=0, 0.66666666666666663 /\n")
    s.near(exactly, 'q1', exactly['t'] * 2 / 3, 1e-15, 'from end to end')


@pytest.mark.parametrize('start, place', [
    ("&drive coordinate=1, kind='polynomial', coefficients=2.5, 1 /\n", 'case.nml:4:1'),
    ("&drive coordinate=1, kind='polynomial', coefficients=-0.1, 1 /\n", 'case.nml:4:1'),
    ('&initial coordinate=1, position=2.5 /\n&body link=2, mass=1 /\n', 'case.nml:4:33')],
    ids=['drive_beyond', 'drive_before', 'initial_beyond'])
def test_start_beyond_an_end_is_refused(s, start, place):
    """It is no end of a motion: it is told with the place of its number."""
    s.curve(WITH_ENDS)
    done = run(s.mech9k if 'drive' in start else s.mech9d, s.write('case.nml', ON_CURVE + start), '--check')
    s.checks.equal(done.returncode, DATA, f'a start beyond an end is refused: {done.stderr}')
    s.checks.true(place in done.stderr and 'and its curve leads from 0 to 2 m; start on the curve' in done.stderr, done.stderr)


def test_closed_chain_at_the_end_of_a_curve(s):
    """The crank pulls the block beyond the end."""
    s.curve([(0.0, 0.0), (0.3, 0.0), (0.6, 0.0), (0.8, 0.0)])
    done = run(s.mech9k, s.write('case.nml', CRANK.format(guide="&pair coordinate=3, links=1,4, kind='path', file='curve.dat' /")
                                 .replace('coefficients=0.3, 4', 'coefficients=3, -4').replace('position=1 ', 'position=0.7 ')), '--no-write')
    s.checks.equal(done.returncode, SINGULAR, f'a chain at the end of a curve: {done.stderr}')
    s.checks.true('coordinate 3 comes to an end of its curve at t = ' in done.stderr, done.stderr)


ONE_PATH = ("&pair coordinate=1, links=1,2, kind='path', file='curve.dat'{} /\n&structure cq=1 /\n"
            "&drive coordinate=1, kind='polynomial', coefficients=0.5 /\n")
SQUARE = '0 0\n1 0\n1 1\n0 1\n'
FILES_OF_CURVES = [
    ('0 0\n1 0\n1 1\n', '', DATA, 'curve.dat: a curve needs at least 4 points, and the file has 3; the group in line 1 of'),
    ('0 0\n1 0\n1 1\n0 0\n', '', DATA, 'curve.dat:4:1: a smooth curve needs at least 4 different points, and this closed one has 3; add points'),
    ('', '', DATA, "curve.dat': the whole file is empty"),
    ('# nothing\n', '', DATA, 'curve.dat: a curve needs at least 4 points, and the file has 0'),
    ('0 0\n1 0\n1 0\n1 1\n0 1\n', '', DATA, 'curve.dat:3:1: this point repeats the one before it'),
    ('0 0\n1 0\n1 x\n0 1\n', '', DATA, "curve.dat:3:3: 'x' is not a number"),
    ('0 0\n1 nan\n1 1\n0 1\n', '', DATA, "curve.dat:2:3: 'nan'"),
    ('0 0\n1 0 0\n1 1\n0 1\n', '', DATA, 'this one has 3 numbers and those before it have 2'),
    ('0\n1\n2\n3\n', '', DATA, 'x and y in a plane or x, y and z in space; this one has 1 number'),
    ('0 0\n1 0\n1e200 1\n0 1\n', '', DATA, 'is too large or too small'),
    (SQUARE, ', closed=.true.', DATA, 'the ends of the curve are 1 m apart; repeat the first point at the end of its file'),
    (SQUARE + '0 0.001\n', '', DATA, 'curve.dat:5:1: the last point misses the first one by 0.001 m'),
    (SQUARE + '0 0.001\n', ', closed=.false.', 0, ''),
    (SQUARE + '0 0\n', '', 0, ''),
    (SQUARE + '0 0\n', ', closed=.false.', 0, ''),
    ('x y\n' + SQUARE, '', 0, ''),
    (SQUARE, ", orientation='along'", DATA, "unknown orientation 'along'; it is one of: fixed tangent"),
    (SQUARE, ', axis=0,0,0', DATA, 'the axis of pair 1 is zero'),
    (SQUARE, ', moving_axis=1,0,0, moving_zero=2,0,0', DATA, 'the moving_zero of pair 1 lies along the axis'),
    (SQUARE, ', pitch=0.1', DATA, 'pitch'),
    (SQUARE, ', dh=1,0,0,0', DATA, 'dh'),
    # a figure of eight touches itself
    ('0 0\n1 1\n2 0\n1 -1\n0 0\n-1 1\n-2 0\n-1 -1\n0 0\n', '', 0, '')]


@pytest.mark.parametrize('points, names, code, words', FILES_OF_CURVES, ids=[
    'three_points', 'closed_by_three', 'empty', 'comment_alone', 'repeated_point', 'no_number', 'nan', 'unequal_lines', 'one_column',
    'too_large', 'closed_but_apart', 'nearly_closed', 'nearly_closed_but_open', 'closed', 'ends_that_meet_but_open', 'line_of_names',
    'orientation', 'zero_axis', 'zero_along_the_axis', 'pitch', 'dh', 'figure_of_eight'])
def test_files_of_curves(s, points, names, code, words):
    """Bad files of curves are refused with their line and a remedy."""
    s.write('curve.dat', points)
    done = run(s.mech9k, s.write('case.nml', ONE_PATH.format(names)), '--check')
    s.checks.equal(done.returncode, code, f'{names} {points!r}: {done.stderr}')
    s.checks.true(words in done.stderr, f'said of {names} {points!r}: {words}', done.stderr)


def test_curve_that_does_not_exist(s):
    done = run(s.mech9k, s.write('case.nml', ONE_PATH.format('')), '--check')
    s.checks.equal(done.returncode, FILE, f'a curve that does not exist: {done.stderr}')
    s.checks.true("case.nml:1:50: the curve '" in done.stderr, done.stderr)


@pytest.mark.parametrize('links, orientation, symbol, curve', [
    ('1,3', 'tangent', 'block', 'curve'), ('1,3', 'fixed', 'plate sheet', 'curve'),
    ('2,3', 'tangent', 'block', 'cam'), ('2,3', 'fixed', 'plate sheet', 'cam')])
def test_symbols(s, links, orientation, symbol, curve):
    """A link that turns with its curve is a block on it, another one a square; a closed curve of a moving link is a cam."""
    angle = 2 * math.pi * np.arange(25) / 24
    s.curve(closed(np.c_[np.cos(angle), np.sin(angle)]))
    text = """&structure cq=1,2 /
&pair coordinate=1, links=1,2, kind='revolute', axis=0,0,1 /
&pair coordinate=2, links={links}, kind='path', file='curve.dat', orientation='{orientation}' /
&drive coordinate=1, kind='polynomial', coefficients=0, 1 /
&drive coordinate=2, kind='polynomial', coefficients=0, 1 /
"""
    picture = os.path.join(s.folder, 'path.svg')
    done = run(s.mech9k, s.write('case.nml', text.format(links=links, orientation=orientation)), '--no-write', '--sketch', picture)
    s.checks.equal(done.returncode, 0, f'a path is drawn: {done.stderr}')
    drawn = text_of(picture)
    other = {'block': 'plate sheet', 'plate sheet': 'block'}[symbol]
    s.checks.true(f'<g class="{symbol}' in drawn and f'<g class="{other}' not in drawn, f'{orientation}: the symbol is {symbol}')
    s.checks.true(f'<g class="{curve}' in drawn, f'links {links}: the curve is drawn as {curve}')


def test_mobility_anywhere_on_a_curve(s):
    """Ranks do not depend on where on its curve a pair stands: at an inflection, on a straight part, in a chain of slides."""
    x = np.linspace(-1.0, 1.0, 41)
    s.curve(np.c_[x, 0.2 * x ** 3])
    # a block between a curve with an inflection at the start and two slides: it moves in one way
    chain = """&pair coordinate=1, links=1,2, kind='path', file='curve.dat' /
&pair coordinate=2, links=1,3, kind='prismatic', axis=1,0,0 /
&pair coordinate=3, links=3,2, kind='prismatic', axis=0,1,0 /
&structure cq=2 /
&initial coordinate=1, position={start!r} /
&drive coordinate=2, kind='polynomial', coefficients=0, 0.5 /
&time end=1.5, intervals=30 /
"""
    half = float(np.sum(np.hypot(np.diff(np.linspace(-1, 0, 20001)), np.diff(0.2 * np.linspace(-1, 0, 20001) ** 3))))
    table = s.table(chain.format(start=half))
    s.near(table, 'q3', 0.2 * (0.5 * table['t']) ** 3, 1e-9, 'a block on a cubic')
    s.near(table, 'dq3', 0.6 * (0.5 * table['t']) ** 2 * 0.5, 1e-7, 'a block on a cubic')
    s.near(table, 'ddq3', 1.2 * (0.5 * table['t']) * 0.25, 1e-6, 'a block on a cubic')
    done = run(s.mech9k, s.write('case.nml', chain.format(start=half)), '--check')
    s.checks.true('rank 2' in done.stdout, f'the chain has two equations: {done.stdout}')
