"""Laws of time: the motion laws of cam design as drives in both programs and as factors of loads, by the textbook's formulas and peaks,
by momentum and by motions that are integrated from joint to joint; jumps are told and passed by their impulse; mistakes in segments
have their places.
"""
import math
import os

import numpy as np
import pytest

from mech9_cases import run, table_of

TIGHT = '&solver relative_tolerance=1e-12, absolute_tolerance=1e-13 /\n'
# peaks of velocity and acceleration for a rise of 1 in a time of 1 (Norton, Cam Design and Manufacturing Handbook, table 2-2)
PEAKS = {'constant-velocity': (1, 0), 'harmonic': (1.5708, 4.9348), 'cycloidal': (2, 6.2832), 'polynomial345': (1.875, 5.7735),
         'polynomial4567': (2.1875, 7.5132), 'modified-sine': (1.7596, 5.528), 'modified-trapezoidal': (2, 4.888)}
SLIDE = """&structure cq=1 /
&pair coordinate=1, links=1,2, kind='prismatic', axis=1,0,0 /
&body link=2, mass=2 /
"""
PENDULUM = """&structure cq=1,2 /
&pair coordinate=1, links=1,2, kind='prismatic', axis=1,0,0 /
&pair coordinate=2, links=2,3, kind='revolute', axis=0,0,1 /
&initial coordinate=2, position=0.4, velocity=0.3 /
&body link=3, mass=1, centre=0,-0.5,0 /
&gravity acceleration=0,-9.81,0 /
"""


def write(folder, text, name='case.nml'):
    path = os.path.join(folder, name)
    with open(path, 'w', encoding='utf-8') as file:
        file.write(text)
    return path


def segments(times, values, laws, period=None):
    return (f"kind='segments', times={','.join(map(repr, times))}, values={','.join(map(repr, values))}, laws="
            + ','.join(f"'{law}'" for law in laws) + (f', period={period!r}' if period else ''))


# --- formulas of the textbook, over the whole rise -------------------------------------------------------------------

def modified_sine(x):
    """Displacement and its derivatives, in the three zones of the textbook."""
    c = 1 / (4 + math.pi)
    if x < 1 / 8:
        return (c * (math.pi * x - 0.25 * math.sin(4 * math.pi * x)), c * math.pi * (1 - math.cos(4 * math.pi * x)),
                4 * math.pi**2 * c * math.sin(4 * math.pi * x))
    if x < 7 / 8:
        angle = math.pi / 3 + 4 * math.pi * x / 3
        return (c * (2 + math.pi * x - 2.25 * math.sin(angle)), c * math.pi * (1 - 3 * math.cos(angle)),
                4 * math.pi**2 * c * math.sin(angle))
    return (c * (4 + math.pi * x - 0.25 * math.sin(4 * math.pi * x)), c * math.pi * (1 - math.cos(4 * math.pi * x)),
            4 * math.pi**2 * c * math.sin(4 * math.pi * x))


def modified_trapezoid_acceleration(x):
    a = 8 * math.pi / (2 + math.pi)
    if x < 1 / 8:
        return a * math.sin(4 * math.pi * x)
    if x < 3 / 8:
        return a
    if x < 5 / 8:
        return a * math.sin(4 * math.pi * (x - 0.25))
    if x < 7 / 8:
        return -a
    return a * math.sin(4 * math.pi * (x - 0.5))


def formula(law, x):
    """Displacement, velocity and acceleration of a rise of 1 in a time of 1."""
    w = 2 * math.pi
    if law == 'harmonic':
        return 0.5 * (1 - math.cos(math.pi * x)), 0.5 * math.pi * math.sin(math.pi * x), 0.5 * math.pi**2 * math.cos(math.pi * x)
    if law == 'cycloidal':
        return x - math.sin(w * x) / w, 1 - math.cos(w * x), w * math.sin(w * x)
    if law == 'polynomial345':
        return 10 * x**3 - 15 * x**4 + 6 * x**5, 30 * x**2 - 60 * x**3 + 30 * x**4, 60 * x - 180 * x**2 + 120 * x**3
    if law == 'polynomial4567':
        return (35 * x**4 - 84 * x**5 + 70 * x**6 - 20 * x**7, 140 * x**3 - 420 * x**4 + 420 * x**5 - 140 * x**6,
                420 * x**2 - 1680 * x**3 + 2100 * x**4 - 840 * x**5)
    if law == 'modified-sine':
        return modified_sine(x)
    return x, 1, 0


@pytest.mark.parametrize('law, peaks', PEAKS.items())
def test_rise_by_the_textbook(checks, tmp_path, mech9k, law, peaks):
    """A rise of 0.3 in 2 s from 0.1."""
    text = (SLIDE + f"&drive coordinate=1, {segments([0, 2], [0.1, 0.4], [law])} /\n&time start=0, end=2, intervals=2000 /\n")
    table = table_of(mech9k, write(tmp_path, text))
    q, dq, ddq = (table['q1'] - 0.1) / 0.3, table['dq1'] / 0.15, table['ddq1'] / 0.075
    x = table['t'] / 2
    checks.near([q[0], q[-1]], [0, 1], 1e-14, f'{law} goes from 0 to 1', scale=1)
    # a step of 1/2000 misses a peak by the square of that
    checks.near([max(dq), max(ddq)], peaks, 1e-4, f'peaks of {law} are those of the textbook', scale=1)
    if law == 'modified-trapezoidal':
        # a thousandth of the time is a step of Simpson's rule
        checks.near(ddq[1:-1], [modified_trapezoid_acceleration(v) for v in x[1:-1]], 1e-12, f'acceleration of {law}', scale=1)
        half = [dq[i] + (ddq[i] + 4 * ddq[i + 1] + ddq[i + 2]) / 6000 for i in range(0, 1999, 2)]
        checks.near(half, dq[2::2], 1e-8, f'the velocity of {law} is the integral of its acceleration', scale=1)
        half = [q[i] + (dq[i] + 4 * dq[i + 1] + dq[i + 2]) / 6000 for i in range(0, 1999, 2)]
        checks.near(half, q[2::2], 1e-8, f'{law} is the integral of its velocity', scale=1)
        return
    expected = np.array([formula(law, v) for v in x])
    # the last value is that of the end of the rise, which the formulas have, too; the textbook's polynomials lose two digits near it
    checks.near(q, expected[:, 0], 1e-13, f'{law} by the formula of the textbook', scale=1)
    checks.near(dq, expected[:, 1], 1e-13, f'velocity of {law}', scale=1)
    checks.near(ddq, expected[:, 2], 1e-12, f'acceleration of {law}', scale=1)


@pytest.mark.parametrize('advance', [0.0, 0.5])
def test_segments_repeat(checks, tmp_path, mech9k, advance):
    """Segments repeat; a drive that ends elsewhere than it begins goes on from there."""
    drive = segments([0.2, 0.7, 0.9, 1.2], [0.0, 0.3, 0.3, advance], ['modified-sine', 'dwell', 'cycloidal'], 1.0)
    text = SLIDE + f'&drive coordinate=1, {drive} /\n&time start=-2, end=3, intervals=50 /\n'
    table = table_of(mech9k, write(tmp_path, text))
    q = table['q1']
    checks.near(q[10:], q[:-10] + advance, 1e-13, f'a period later the coordinate is farther by {advance}', scale=1)
    # 0.4 s of a dwell: q = 0.3 from t = 0.7 to 0.9
    checks.near(q[28], 0.3, 1e-15, 'a dwell keeps the coordinate', scale=1)


# --- dynamics -------------------------------------------------------------------------------------------------------

def swing(y, start, end, acceleration, steps=4000):
    """The pendulum of PENDULUM by the classical method of Runge and Kutta, on a slide with a smooth acceleration."""
    h = (end - start) / steps

    def rate(t, y):
        return np.array([y[1], -(acceleration(t) * math.cos(y[0]) + 9.81 * math.sin(y[0])) / 0.5])
    for i in range(steps):
        t = start + i * h
        k1 = rate(t, y)
        k2 = rate(t + h / 2, y + h / 2 * k1)
        k3 = rate(t + h / 2, y + h / 2 * k2)
        k4 = rate(t + h, y + h * k3)
        y = y + h / 6 * (k1 + 2 * k2 + 2 * k3 + k4)
    return y


@pytest.mark.parametrize('method', ['auto', 'adams', 'bdf', 'merson'])
def test_accelerations_jump_at_joints(checks, tmp_path, mech9d, method):
    """Accelerations jump where harmonic segments join. Steps of 1/8000 s err by 1e-14."""
    times, values = [0, 0.5, 0.8, 1.6], [0, 0.4, 0.4, -0.1]
    text = PENDULUM + f"&drive coordinate=1, {segments(times, values, ['harmonic', 'dwell', 'harmonic'])} /\n"
    text += '&time start=0, end=1.6, intervals=16 /\n'

    def pieces():
        for i in range(3):
            span, rise = times[i + 1] - times[i], values[i + 1] - values[i]
            yield times[i], times[i + 1], lambda t, a=times[i], s=span, r=rise: r / s**2 * formula('harmonic', (t - a) / s)[2]
    y = np.array([0.4, 0.3])
    expected = {0: y}
    for start, end, acceleration in pieces():
        y = swing(y, start, end, acceleration)
        expected[round(end * 10)] = y
    table = table_of(mech9d, write(tmp_path, text + TIGHT.replace(' /', f", method='{method}' /")))
    checks.equal([f'{t:.17g}' for t in table['t'][:4]], [f'{1.6 * i / 16:.17g}' for i in range(4)], 'the times of rows at joints')
    checks.equal(table['t'][-1], 1.6, 'the time of the last row')
    for row, y in expected.items():
        # multistep methods err by up to a hundred tolerances in each of some thousand steps
        tolerance = 1e-9 if method in ('auto', 'merson') else 1e-7
        checks.near([table['q2'][row], table['dq2'][row]], y, tolerance, f'{method}: a pendulum over joints, row {row}', scale=1)


def test_impulse_of_a_jump(checks, tmp_path, mech9d):
    """A slide that begins to move at once gives the pendulum a rate: its moment of momentum about the pivot does not change,
    0.25 (change of dq) + 0.5 cos(q) (change of velocity) = 0. Afterwards its energy on the slide is constant."""
    drive = segments([0, 0.5, 1.5], [0, 0, 2.0], ['dwell', 'constant-velocity'])
    text = PENDULUM + f'&drive coordinate=1, {drive} /\n&time start=0, end=1.5, intervals=3 /\n' + TIGHT
    path = write(tmp_path, text)
    table = table_of(mech9d, path)
    before = swing(np.array([0.4, 0.3]), 0, 0.5, lambda t: 0.0)
    behind = before - np.array([0, 0.5 * math.cos(before[0]) * 2 / 0.25])
    checks.near([table['q2'][1], table['dq2'][1]], behind, 1e-9, 'the rate behind a jump', scale=1)
    checks.near(table['dq1'][1], 2.0, 1e-12, 'a row at a jump has the rate behind it')
    energy = 0.125 * table['dq2']**2 - 0.5 * 9.81 * np.cos(table['q2'])
    checks.near(energy[2:], energy[1], 1e-9, 'the energy on a steady slide', scale=1)
    done = run(mech9d, path, '--no-write', folder=tmp_path)
    checks.true('note: the rate of the drive of coordinate 1 jumps at t = 0.5 s' in done.stderr, 'the jump is told', done.stderr)


@pytest.mark.parametrize('law, jumps', [
    ('harmonic', 'note: the acceleration of the drive of coordinate 1 jumps at t = 0.5, 1 s'), ('cycloidal', None)],
    ids=['harmonic', 'cycloidal'])
def test_jumps_are_told(checks, tmp_path, mech9d, law, jumps):
    drive = segments([0, 0.5, 1, 1.5], [0, 0, 2.0, 2.0], ['dwell', law, 'dwell'])
    path = write(tmp_path, PENDULUM + f'&drive coordinate=1, {drive} /\n&time start=0, end=1.5, intervals=3 /\n')
    for options in (('--no-write',), ('--check',)):
        done = run(mech9d, path, *options, folder=tmp_path)
        checks.true(jumps in done.stdout + done.stderr if jumps else 'jumps' not in done.stdout + done.stderr,
                    f'jumps of {law} segments are told', done.stdout + done.stderr)


# A mass of 2 kg and a force of 6 N times a law: v = 3 times the integral of the law.
PUSHED = SLIDE + '&initial coordinate=1, position=0 /\n&time start=0, end=2, intervals=20 /\n' + TIGHT
LOADS = ("&load kind='force', link=2, force=6,0,0, ", "&load kind='coordinate', coordinate=1, force=6, ")
TIMES = np.linspace(0, 2, 21)
INTEGRALS = {"law='constant'": TIMES, "law='polynomial', coefficients=1,0,3": TIMES + TIMES**3,
             "law='harmonic', mean=1, amplitude=2, angular_frequency=3, phase=0.5":
                 TIMES + 2 / 3 * (math.cos(0.5) - np.cos(3 * TIMES + 0.5)),
             "law='table', file='cube.dat'": TIMES**4 / 4}
ON_LOADS = pytest.mark.parametrize('load', LOADS, ids=['force', 'coordinate'])


@ON_LOADS
@pytest.mark.parametrize('law, integral', INTEGRALS.items(), ids=['constant', 'polynomial', 'harmonic', 'table'])
def test_loads_by_laws(checks, tmp_path, mech9d, load, law, integral):
    write(tmp_path, ''.join(f'{t / 10:.1f} {(t / 10)**3:.12f}\n' for t in range(0, 21)), 'cube.dat')
    table = table_of(mech9d, write(tmp_path, PUSHED + load + law + ' /\n'))
    checks.near(table['dq1'], 3 * integral, 1e-10, f'{load} {law}', scale=1)


@ON_LOADS
@pytest.mark.parametrize('law', PEAKS)
def test_loads_by_segments(checks, tmp_path, mech9d, load, law):
    # a rise, a dwell and a fall of 0.5 s each; the integral of a symmetric rise is half of its time
    text = f"law={segments([0, 0.5, 1, 1.5, 2], [0, 1, 1, 0, 0], [law, 'dwell', law, 'dwell'])[5:]}"
    table = table_of(mech9d, write(tmp_path, PUSHED + load + text + ' /\n'))
    checks.near(table['dq1'][[5, 10, 15, 20]], [0.75, 2.25, 3, 3], 1e-10, f'{load} {law}', scale=1)


def test_factor_of_a_load_returns(checks, tmp_path, mech9d):
    """It does so at the end of a period: 1, then at once 0 again."""
    text = LOADS[0] + "law='segments', times=0,1, values=0,1, laws='constant-velocity', period=1 /\n"
    table = table_of(mech9d, write(tmp_path, PUSHED + text))
    checks.near(table['dq1'][[10, 20]], [1.5, 3], 1e-10, 'a factor that jumps', scale=1)


def test_spring_that_is_switched_on(checks, tmp_path, mech9d):
    """A spring whose stiffness grows over half a second and stays: its amplitude is constant afterwards."""
    spring = "&load kind='spring', links=1,2, position=-1,0,0, stiffness=200, free_length=1.2, law='segments', times=0,0.5,5, "
    table = table_of(mech9d, write(tmp_path, PUSHED + spring + "values=0,1,1, laws='polynomial345','dwell' /\n"))
    energy = table['dq1']**2 + 100 * (table['q1'] - 0.2)**2
    checks.near(energy[6:], energy[5], 1e-9, 'energy of a spring behind its law', scale=1)
    checks.true(np.all(table['E.potential'] == 0), 'the work of a load with a law counts as put in')


# --- mistakes -------------------------------------------------------------------------------------------------------

def drive(*values):
    return f'&drive coordinate=1, {segments(*values)} /'


def refused(checks, folder, program, group, words, more=''):
    path = write(folder, SLIDE + group + '\n&time start=0, end=1, intervals=10 /\n' + more)
    done = run(program, path, '--no-write', folder=folder)
    checks.equal(done.returncode, 3, 'exit code')
    checks.true(words in done.stderr and 'case.nml:4' in done.stderr, words, done.stderr)


@pytest.mark.parametrize('group, words', [
    pytest.param(drive([0, 0.5, 0.4, 1], [0, 1, 1, 0], ['harmonic']),
                 'case.nml:4:51: times must increase, and 0.4 does not come after 0.5', id='times that do not increase'),
    pytest.param(drive([0, 0.5, 1], [0, 1], ['harmonic']), 'there are 2 values for 3 times', id='too few values'),
    pytest.param(drive([0, 0.5, 1], [0, 1, 0], ['harmonic'] * 3), 'there are 3 laws for 2 segments', id='too many laws'),
    pytest.param(drive([0, 0.5, 1], [0, 1, 0], ['harmonic', 'dwell']), 'segment 2 dwells, but its values differ: 1 and 0',
                 id='a false dwell'),
    pytest.param(drive([0, 0.5], [0, 0], ['dwell'], 1.0), 'the segments last 0.5 s, which leaves a gap in a period of 1 s', id='a gap'),
    pytest.param(drive([0, 0.5], [0, 0], ['dwell'], 0.2), 'the segments last 0.5 s, longer than a period of 0.2 s', id='a short period'),
    pytest.param(drive([0, 0.5], [0, 1], ['harmonik']), "did you mean 'harmonic'", id='an unknown law'),
    pytest.param(drive([0, 0.5], [0, 1], ['harmonic']), 'the law in segments of the drive of coordinate 1 has no value after t = 0.5 s, '
                 'and the run goes on to t = 1 s', id='segments that end too early')])
def test_drives_that_are_refused(checks, tmp_path, mech9k, group, words):
    refused(checks, tmp_path, mech9k, group, words)


@pytest.mark.parametrize('items, words', [
    pytest.param("kind='force', link=2, force=1,0,0, amplitude=2", "'amplitude' needs law='harmonic'", id='a name without its law'),
    pytest.param("kind='force', link=2, force=1,0,0, law='harmonic', amplitude=2", "&load needs 'angular_frequency'",
                 id='a law without a name that it needs'),
    pytest.param("kind='force', link=2, force=1,0,0, law='harmonic', amplitude=2, angular_frequency=1, times=0,1",
                 "'times' does not belong to loads of kind 'force' with law='harmonic'", id='a name of another law'),
    pytest.param("kind='user', law='constant'", "'law' does not belong to loads of kind 'user'", id='a law of a user load'),
    pytest.param("kind='force', link=2, force=1,0,0, law='segments', times=0,0.5, values=0,1, laws='harmonic'",
                 'the law in segments of the load has no value after t = 0.5 s', id='a load whose law ends too early')])
def test_loads_that_are_refused(checks, tmp_path, mech9d, items, words):
    refused(checks, tmp_path, mech9d, f'&load {items} /', words, '&initial coordinate=1, position=0 /\n')
