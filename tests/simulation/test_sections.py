"""Sections of motions against closed forms and an integration in many digits: points where a coordinate or a column has a value, or after
each period; in free and driven motions, through other independent coordinates and impacts; bad groups.

Compares the program with itself: few and many outputs; one four-bar by two independent coordinates; forwards and backwards in time."""
import json
from math import acos, atan2, hypot, pi, sqrt

import numpy as np
import pytest

import driven_pendulum
from four_bars import HEAVY_ROCKER
from mech9_cases import read_table, run

G = 9.81
OSCILLATOR = """&structure cq=1 /
&pair coordinate=1, links=1,2, kind='prismatic', axis=1,0,0 /
&body link=2, mass=1 /
&point name='P', link=2 /
&load kind='coordinate', coordinate=1, stiffness=4 /
&initial coordinate=1, position=0.3, velocity=0.4 /
&solver relative_tolerance=1e-12, absolute_tolerance=1e-14 /
"""
PENDULUM = """&structure cq=1 /
&pair coordinate=1, links=1,2, kind='revolute', axis=0,0,1 /
&body link=2, mass=1, centre=0,-1,0 /
&gravity acceleration=0,-1,0 /
&load kind='coordinate', coordinate=1, damping=0.5 /
&load kind='coordinate', coordinate=1, force=0.9, law='harmonic', amplitude=1, angular_frequency=0.6666666666666666,
      phase=1.5707963267948966 /
&initial coordinate=1, position=0.2 /
"""
CRANK = """&structure cq=1 /
&pair coordinate=1, links=1,2, kind='revolute', axis=0,0,1 /
&pair coordinate=2, links=2,3, kind='revolute', point=1,0,0, axis=0,0,1 /
&pair coordinate=3, links=3,4, kind='revolute', point=4,0,0, axis=0,0,1 /
&pair coordinate=4, links=1,4, kind='prismatic', point=4,0,0, axis=1,0,0 /
&drive coordinate=1, kind='polynomial', coefficients=0.1, 3 /
"""
FOUR_BAR = HEAVY_ROCKER + """&solver relative_tolerance=1e-11, absolute_tolerance=1e-12 /
"""


def go(program, folder, text, section, end, intervals=7, code=0, start=0.0):
    """The points of a section by their columns, the report, and standard error of a run that ends with a code."""
    path, table, points, report = (folder / name for name in ('motion.nml', 'motion.dat', 'points.dat', 'motion.json'))
    points.unlink(missing_ok=True)
    path.write_text(f"{text}&section {section}, table='{points}' /\n&time start={start!r}, end={end!r}, intervals={intervals} /\n",
                    encoding='utf-8')
    done = run(program, path, '--table', table, '--report', report)
    assert done.returncode == code, done.stderr
    rows = points.exists() and len(points.read_text().splitlines()) > 3
    return read_table(points.read_text()) if rows else None, json.loads(report.read_text()), done.stderr


def oscillator_times(x, end, direction):
    """Times at which 0.3 cos 2t + 0.2 sin 2t = x, while it grows or falls."""
    phase, angle = atan2(0.2, 0.3), acos(x / hypot(0.3, 0.2))
    times = [(phase - direction * angle + 2 * pi * n) / 2 for n in range(-2, int(end / pi) + 3)]
    return np.array([t for t in times if 0 < t <= end])


@pytest.mark.parametrize('direction', [1, -1, 0])
def test_an_oscillator(checks, mech9d, tmp_path, direction):
    """Points in closed form; they have the value itself, and are those with the sense of the direction."""
    points, report, _ = go(mech9d, tmp_path, OSCILLATOR, f'coordinate=1, value=0.1, direction={direction}', 50.0)
    expected = np.sort(np.concatenate([oscillator_times(0.1, 50.0, sense) for sense in (1, -1) if direction in (0, sense)]))
    checks.equal(points['point'].tolist(), list(range(1, len(expected) + 1)), 'the points count from 1')
    checks.equal(report['section']['points'], len(expected), 'the report has their number')
    # tolerance: some 600 steps of 1e-12
    checks.near(points['t'], expected, 1e-10, 'times', scale=50)
    # tolerance: the round-off of times up to 50 s
    checks.near(points['q1'], 0.1, 4e-14, 'the value')
    speed = sqrt(4 * (0.3**2 + 0.2**2 - 0.1**2))
    checks.near(np.abs(points['dq1']), speed, 1e-10, 'the rate')
    if direction:
        checks.true(np.all(direction * points['dq1'] > 0), 'the sense of the rate')


def test_columns(checks, mech9d, tmp_path):
    """The rate of the coordinate, a point's velocity, an energy and an acceleration as values of the section."""
    turns = np.array([(atan2(0.2, 0.3) + pi * n) / 2 for n in range(1, 30) if (atan2(0.2, 0.3) + pi * n) / 2 <= 20])
    for column in ('dq1', 'P.vx'):
        points, _, _ = go(mech9d, tmp_path, OSCILLATOR, f"column='{column}', direction=0", 20.0)
        checks.near(points['t'], np.concatenate([[atan2(0.2, 0.3) / 2], turns]), 1e-9, f'{column} vanishes where the motion turns', scale=20)
    points, _, _ = go(mech9d, tmp_path, OSCILLATOR, "column='ddq1', value=-0.4", 20.0)
    checks.near(points['t'], oscillator_times(0.1, 20.0, -1), 1e-9, 'ddq1 grows where q1 falls', scale=20)
    # E = 2 (0.3^2 + 0.2^2); half of it is potential where x = R/sqrt(2)
    points, _, _ = go(mech9d, tmp_path, OSCILLATOR, "column='E.potential', value=0.13", 20.0)
    r = hypot(0.3, 0.2) / sqrt(2)
    expected = np.sort(np.concatenate([oscillator_times(r, 20.0, 1), oscillator_times(-r, 20.0, -1)]))
    checks.near(points['t'], expected, 1e-9, 'the potential energy grows away from the middle', scale=20)


def test_grazing(checks, mech9d, tmp_path):
    """A value close to the end of the range is met twice at each turn, within a step; one beyond it never."""
    r = hypot(0.3, 0.2)
    inside = r * (1 - 1e-7)
    points, _, _ = go(mech9d, tmp_path, OSCILLATOR, f'coordinate=1, value={inside!r}, direction=0', 20.0)
    expected = np.sort(np.concatenate([oscillator_times(inside, 20.0, sense) for sense in (1, -1)]))
    # tolerance: times depend on the square root of the distance, 4e-8, in which the motion is exact to 1e-11
    checks.near(points['t'], expected, 1e-6, 'two points at each turn', scale=1)
    points, report, said = go(mech9d, tmp_path, OSCILLATOR, f'coordinate=1, value={r * (1 + 1e-7)!r}, direction=0', 20.0)
    checks.true(report['section']['points'] == 0 and 'is never met; it went from -0.36' in said, 'never met', said)
    _, _, said = go(mech9d, tmp_path, OSCILLATOR, 'coordinate=1, value=0, transient=30', 20.0)
    checks.true('the motion ends before its transient' in said, 'the transient is too long', said)


def test_outputs_do_not_matter(checks, mech9d, tmp_path):
    """The same points, bit by bit, with 1 and with 1000 outputs."""
    for section in ("coordinate=1, value=0.1", "column='P.vx', value=0.2, direction=0", 'period=1.7'):
        few, many = (go(mech9d, tmp_path, OSCILLATOR, section, 20.0, n)[0] for n in (1, 1000))
        checks.true(len(few['t']) > 5, 'there are points', len(few['t']))
        for name in few:
            checks.equal(few[name].tolist(), many[name].tolist(), f'{section}: {name}')


def test_start_and_transient(checks, mech9d, tmp_path):
    """A motion that begins at the value has no point there; points before the end of the transient are left out."""
    start = OSCILLATOR.replace('position=0.3', 'position=0')
    points, _, _ = go(mech9d, tmp_path, start, 'coordinate=1', 10.0)
    checks.near(points['t'], [pi, 2 * pi, 3 * pi], 1e-10, 'not at the start', scale=10)
    points, _, _ = go(mech9d, tmp_path, start, "column='P.x'", 10.0)
    checks.near(points['t'], [pi, 2 * pi, 3 * pi], 1e-10, 'nor with a column', scale=10)
    rest = OSCILLATOR.replace('velocity=0.4', 'velocity=0')
    points, _, _ = go(mech9d, tmp_path, rest, "column='P.vx', direction=-1", 10.0)
    checks.near(points['t'], [pi, 2 * pi, 3 * pi], 1e-10, 'nor with a velocity that is zero there', scale=10)
    points, _, said = go(mech9d, tmp_path, rest, "column='E.kinetic'", 10.0)
    checks.true(points is None and 'the section has no point' in said, 'nor with a column whose derivative is not known', said)
    points, _, _ = go(mech9d, tmp_path, start, 'coordinate=1, transient=4', 10.0)
    checks.near(points['t'], [2 * pi, 3 * pi], 1e-10, 'behind the transient', scale=10)
    points, _, said = go(mech9d, tmp_path, start, 'coordinate=1, transient=40', 10.0)
    checks.true(points is None and 'the section has no point' in said, 'a transient beyond the end', said)
    points, _, _ = go(mech9d, tmp_path, start, 'period=2.5', 10.0)
    checks.equal(points['t'].tolist(), [0, 2.5, 5, 7.5, 10], 'the points of a period begin at the start')
    checks.near(points['q1'], 0.2 * np.sin(2 * points['t']), 1e-10, 'their coordinate')
    points, _, _ = go(mech9d, tmp_path, start, 'period=2.5, transient=5', 10.0)
    checks.equal(points['t'].tolist(), [5, 7.5, 10], 'a period that ends with the transient')


def test_backwards(checks, mech9d, tmp_path):
    """Back in time the points are met in the other order; the direction is that in time, still."""
    there, _, _ = go(mech9d, tmp_path, OSCILLATOR, 'coordinate=1, value=0.1', 9.0)
    table = read_table((tmp_path / 'motion.dat').read_text())
    back = OSCILLATOR.replace('position=0.3, velocity=0.4', f"position={table['q1'][-1]!r}, velocity={table['dq1'][-1]!r}")
    points, _, _ = go(mech9d, tmp_path, back, 'coordinate=1, value=0.1', 0.0, start=9.0)
    checks.near(points['t'], there['t'][::-1], 1e-9, 'the same times, the last first', scale=9)


def test_a_driven_pendulum(checks, mech9d, tmp_path):
    """Ten periods of the damped driven pendulum of Baker and Gollub at g = 0.9, where it is regular, against Taylor series in extended precision."""
    period = 3 * pi
    points, _, _ = go(mech9d, tmp_path, PENDULUM + '&solver relative_tolerance=1e-12, absolute_tolerance=1e-13 /\n',
                      f'period={period!r}', 10 * period)
    exact = driven_pendulum.motion(0.9, 0.2, 0, 10).astype(float)
    checks.near(points['t'], period * np.arange(11), 1e-15, 'times of the points')
    # tolerance: a thousand steps of 1e-12; the motion damps errors
    checks.near(points['q1'], exact[:, 0], 1e-9, 'angles')
    checks.near(points['dq1'], exact[:, 1], 1e-9, 'rates')


def test_driven_motions(checks, mech9k, tmp_path):
    """A crank that turns evenly: every turn, with few and many outputs; the slide of a slider-crank in closed form; periods."""
    for intervals in (1, 500):
        points, _, _ = go(mech9k, tmp_path, CRANK, 'coordinate=1, every_turn=.true.', 20.0, intervals)
        checks.near(points['t'], (2 * pi * np.arange(1, 10) - 0.1) / 3, 1e-14, 'every turn', scale=20)
    points, _, _ = go(mech9k, tmp_path, CRANK, 'coordinate=1, value=1', 20.0)
    checks.near(points['t'], [0.3], 1e-15, 'a value that is met once')
    # x = cos a + sqrt(9 - sin^2 a) - 4 = -1: cos a = 0 gives sqrt(8) - 4 < -1; solve (x + 4 - cos a)^2 = 9 - sin^2 a
    cosine = ((-1 + 4)**2 + 1 - 9) / (2 * (-1 + 4))
    angles = [sense * acos(cosine) + 2 * pi * n for n in range(10) for sense in (1, -1)]
    expected = {sense: [(a - 0.1) / 3 for a in sorted(angles) if 0 < (a - 0.1) / 3 <= 20 and (np.sin(a) < 0) == (sense > 0)] for sense in (1, -1)}
    for sense in (1, -1):
        points, _, _ = go(mech9k, tmp_path, CRANK, f'coordinate=4, value=-1, direction={sense}', 20.0, 1)
        checks.near(points['t'], expected[sense], 1e-13, 'a dependent coordinate', scale=20)
        checks.near(points['q4'], -1, 1e-14, 'its value')
    points, _, _ = go(mech9k, tmp_path, CRANK, 'period=2', 20.0)
    checks.near(points['q1'], 0.1 + 6 * np.arange(11), 1e-14, 'a period in a driven motion')
    degrees = "&mechanism angle_unit='deg' /\n" + CRANK.replace('coefficients=0.1, 3', f'coefficients={np.degrees(0.1)!r}, {np.degrees(3.0)!r}')
    points, _, _ = go(mech9k, tmp_path, degrees, 'coordinate=1, value=90, every_turn=.true.', 20.0)
    checks.near(points['t'], (2 * pi * np.arange(len(points['t'])) + pi / 2 - 0.1) / 3, 1e-13, 'in degrees', scale=20)


@pytest.mark.parametrize('amplitude', [1, 1e-3, 1e-6])
def test_a_small_drive(checks, mech9k, tmp_path, amplitude):
    """A drive that swings by little beside the size of the mechanism: all points between two outputs."""
    text = f"""&structure cq=1 /
&pair coordinate=1, links=1,2, kind='prismatic', axis=1,0,0 /
&point name='P', link=2, position=1,0,0 /
&drive coordinate=1, kind='harmonic', amplitude={amplitude!r}, angular_frequency=20 /
"""
    points, _, _ = go(mech9k, tmp_path, text, f'coordinate=1, value={amplitude/2!r}', 10.0, 1)
    checks.near(points['t'], (pi / 6 + 2 * pi * np.arange(32)) / 20, 1e-12, 'times', scale=10)


def test_a_closed_chain_changes_its_coordinates(checks, mech9d, tmp_path):
    """A four-bar whose heavy rocker swings, integrated by its crank through dead points, and by its rocker: one section."""
    first = '&structure cq=1 /\n&initial coordinate=1, position=0.5, velocity=1 /\n&initial coordinate=4, position=1.7 /\n' + FOUR_BAR
    points, _, _ = go(mech9d, tmp_path, first, 'coordinate=4, value=2.2, direction=0', 6.0)
    table = read_table((tmp_path / 'motion.dat').read_text())
    other = (f"&structure cq=4 /\n&initial coordinate=4, position={table['q4'][0]!r}, velocity={table['dq4'][0]!r} /\n"
             f"&initial coordinate=1, position=0.5 /\n") + FOUR_BAR
    again, report, _ = go(mech9d, tmp_path, other, 'coordinate=4, value=2.2, direction=0', 6.0, 300)
    checks.true(len(report['coordinate_changes']) > 0 and len(points['t']) > 8, 'coordinates change between the points',
                (len(report['coordinate_changes']), len(points['t'])))
    # tolerance: some 2000 steps of 1e-11, which this motion lets grow by less than a thousand
    checks.near(again['t'], points['t'], 1e-6, 'the times do not depend on the coordinates', scale=1)
    checks.near(points['q4'], 2.2, 1e-13, 'the value')
    checks.true(np.all(points['closure'] < 1e-12), 'chains are closed at the points')


def test_impacts(checks, mech9d, tmp_path):
    """A bouncing slider passes a height; its rate jumps over zero at impacts; its stop itself is touched and not passed."""
    slider = """&structure cq=1 /
&pair coordinate=1, links=1,2, kind='prismatic', axis=0,0,1 /
&body link=2, mass=2 /
&gravity acceleration=0,0,-9.81 /
&initial coordinate=1, position=1 /
&stop coordinate=1, low=0, restitution=0.8 /
&solver relative_tolerance=1e-11, absolute_tolerance=1e-12 /
"""
    first, e, n = sqrt(2 / G), 0.8, np.arange(4)
    hits = first + 2 * first * e * (1 - e**n) / (1 - e)
    points, _, _ = go(mech9d, tmp_path, slider, 'coordinate=1, value=0.25', 2.5)
    speeds = G * first * e**(n + 1)
    rises = hits + (speeds - np.sqrt(np.maximum(speeds**2 - 2 * G * 0.25, 0))) / G
    checks.near(points['t'], rises[speeds**2 > 2 * G * 0.25], 1e-9, 'it rises past a height', scale=2.5)
    points, report, _ = go(mech9d, tmp_path, slider, "column='dq1', value=0", 2.5)
    checks.near(points['t'], hits[hits < 2.5], 1e-9, 'the rate jumps over zero at impacts', scale=2.5)
    checks.near(points['dq1'], (G * first * e**(n + 1))[hits < 2.5], 1e-9, 'points show the rate behind the impact')
    points, report, _ = go(mech9d, tmp_path, slider, 'coordinate=1, direction=0', 2.5)
    checks.equal(report['section']['points'], 0, 'a stop is touched and not passed')


def test_files(checks, mech9d, tmp_path):
    """The HDF5 file has the columns of the table; pictures show turns, or angles within one turn."""
    h5py = pytest.importorskip('h5py')
    chaotic = PENDULUM.replace('force=0.9', 'force=1.5')
    for reduced in ('.true.', '.false.'):
        (tmp_path / 'p.nml').write_text(f"{chaotic}&section period=9.42477796076938, table='points.dat', reduce_angles={reduced} /\n"
                                        '&time end=400, intervals=4 /\n', encoding='utf-8')
        done = run(mech9d, 'p.nml', '--table', 'p.dat', '--hdf5', 'p.h5', '--plot', 'p.svg:section:q1:dq1', folder=tmp_path)
        checks.true(done.returncode == 0, 'the run', done.stderr)
        points = read_table((tmp_path / 'points.dat').read_text())
        with h5py.File(tmp_path / 'p.h5') as file:
            checks.equal(sorted(file['section']), sorted(points), 'the data sets are the columns')
            for name in points:
                checks.equal(file['section'][name][:].tolist(), points[name].tolist(), f'data set {name}')
        script = (tmp_path / 'p.gp').read_text()
        block = script.split('end_of_data')[1].splitlines()[2:]
        angles = np.array([float(line.split()[0]) for line in block])
        if reduced == '.true.':
            checks.true(len(angles) == len(points['t']) and np.all(np.abs(angles) <= pi) and np.max(np.abs(points['q1'])) > 8,
                        'a picture with angles within one turn', len(angles))
        else:
            checks.near(angles, points['q1'], 1e-14, 'a picture with turns')
        checks.true('with points' in script, 'no line joins the points')


@pytest.mark.parametrize('section, message', [
    ('coordinate=3', '3:23: there is no coordinate 3'),
    ('value=1', "needs one of coordinate=, column= and period="),
    ("coordinate=1, column='q1'", "needs one of coordinate=, column= and period="),
    ("column='P.z9'", "which is not recorded"),
    ('coordinate=1, direction=2', 'direction is 1'),
    ('coordinate=1, every_turn=.true.', 'every_turn belongs to a coordinate that turns'),
    ('period=1, direction=1', 'the points of a period have no direction'),
    ('period=-1', 'period')])
def test_bad_groups(checks, mech9d, tmp_path, section, message):
    """Each wrong group is refused with its place and a remedy."""
    _, _, said = go(mech9d, tmp_path, OSCILLATOR, section, 20.0, code=3)
    checks.true(message.split(': ')[-1] in said, section, said)
