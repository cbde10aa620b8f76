"""Examples of long-term motion against theory: bounds of the exponent of three rotators by the curvature of their surface, pairs of exponents
of the double pendulum, the graze of the impact oscillator, and the criterion of Vyshnegradskii for the governor."""
import json
import os

import numpy as np
import pytest

from mech9_cases import TREE, read_table, run


def example(name):
    return os.path.join(TREE, 'examples', name, f'{name}.nml')


def report_of(program, folder, name, *words):
    """The report of a program with an example."""
    path = folder / 'report.json'
    done = run(program, example(name), *words, '--no-write', '--report', path, folder=folder)
    assert done.returncode == 0, done.stderr
    return json.loads(path.read_text())


def mean_over_rotators(points=1000):
    """Area of the surface cos a + cos b + cos c = 0 in the space of three angles, its whole curvature, and the mean of the root of minus it.

    The curvature is that of a level of a function without mixed derivatives; c is taken where its sine is the largest of the three."""
    angles = (np.arange(points) + 0.5) * 2 * np.pi / points
    a, b = np.meshgrid(angles, angles)
    cos_a, cos_b = np.cos(a), np.cos(b)
    cos_c = -cos_a - cos_b
    squares = 1 - cos_a**2, 1 - cos_b**2, 1 - cos_c**2
    inside = (squares[2] > 0) & (squares[2] >= squares[0]) & (squares[2] >= squares[1])
    whole = sum(squares)
    curvature = (squares[0] * cos_b * cos_c + squares[1] * cos_a * cos_c + squares[2] * cos_a * cos_b) / whole**2
    # two signs of sin c, and three angles that may have the largest sine
    element = np.where(inside, 6 * np.sqrt(np.where(inside, whole / np.where(inside, squares[2], 1), 0)), 0) * (2 * np.pi / points)**2
    area = element.sum()
    return area, (element * curvature).sum(), (element * np.sqrt(np.maximum(-curvature, 0))).sum() / area


def test_rotators(checks, mech9d, tmp_path):
    """The exponent lies between the mean of the root of minus the curvature, and the root of the mean, times the speed; by Gauss and Bonnet
    the whole curvature of a surface of genus 3 is -8 pi. Exponents are pairs."""
    area, whole, mean_root = mean_over_rotators()
    # tolerance: the sum cuts cells at the border of a chart
    checks.near(whole, -8 * np.pi, 1e-3, 'the whole curvature')
    report = report_of(mech9d, tmp_path, 'rotators', '--exponents', '4', '--set', 'exponents.time=600')
    exponents, errors = np.array(report['exponents']), np.array(report['exponents_error'])
    speed = np.sqrt(0.8200230978141004)
    low, high = speed * mean_root, speed * np.sqrt(8 * np.pi / area)
    checks.true(low - 2 * errors[0] < exponents[0] < high + 2 * errors[0] and errors[0] < 0.05 * exponents[0], 'the largest exponent',
                (low, exponents, errors, high))
    checks.near(exponents + exponents[::-1], 0, 4e-3, 'pairs', scale=1)
    checks.true(0 <= exponents[1] < 0.02, 'two are zero', exponents)
    # tolerance: Gauss's formula of fourth order in steps of 0.3 s and less
    checks.near(report['divergence'], exponents.sum(), 1e-4, 'the mean divergence', scale=1)


def test_double_pendulum(checks, mech9d, tmp_path):
    """A motion without losses: two exponents are zero, as the energy stays, and the others a pair."""
    report = report_of(mech9d, tmp_path, 'double_pendulum', '--exponents', '4', '--set', 'exponents.time=200', '--set',
                       'solver.relative_tolerance=1e-10')
    exponents = np.array(report['exponents'])
    checks.true(exponents[0] > 0.5, 'the motion is chaotic', exponents)
    # tolerance: logarithms of what inertias, and lengths in regular motions, change by, over the time
    checks.near(exponents + exponents[::-1], 0, 0.02, 'pairs', scale=1)
    checks.true(abs(exponents[1]) < 0.1 * exponents[0], 'two are zero', exponents)
    checks.near(report['divergence'], exponents.sum(), 1e-5, 'the mean divergence', scale=1)


def test_graze(checks, mech9d, tmp_path):
    """The swing of the impact oscillator without stop has the amplitude of the linear equation. It is there with the stop behind it, alone in
    each period; before it impacts come. On the way back they go on beyond."""
    amplitude = 1 / np.hypot(1 - 2.5**2, 0.2 * 2.5)
    points = tmp_path / 'points.dat'
    done = run(mech9d, example('impact_oscillator'), '--study', '--table', tmp_path / 'study.dat', '--set', f'section.table={points}',
               folder=tmp_path)
    checks.true(done.returncode == 0 and 'failed' not in done.stderr, 'the study', done.stderr)
    rows = read_table(points.read_text())
    forth = rows['run'] <= 13
    swing = np.abs(rows['dq1'] + 1.25 / 27.8125) < 1e-6
    for number in range(1, 14):
        of_run = rows['run'] == number
        free = -rows['stop'][of_run][0] > amplitude
        checks.equal(bool(swing[of_run].all()), bool(free), f"the stop at {rows['stop'][of_run][0]:.4g} m")
    back = ~forth & (-rows['stop'] > amplitude)
    checks.true(back.sum() > 50 and not swing[back].any(), 'impacts go on on the way back')
    for stop, hit in ((-amplitude - 1e-6, False), (-amplitude + 1e-6, True)):
        report = report_of(mech9d, tmp_path, 'impact_oscillator', '--set', f'stop.low={stop!r}', '--set', 'solver.relative_tolerance=1e-11',
                           '--set', 'solver.absolute_tolerance=1e-12', '--set', 'time.end=60')
        checks.equal(len(report['events']) > 0, hit, f'the stop at {stop}')


def multipliers(damping):
    """The multipliers of steady running: 1, and those of the cubic equation of small deviations, over one turn."""
    speed, sine, cosine = np.sqrt(2 * 9.81), np.sqrt(0.75), 0.5
    inertia = 4 + sine**2
    roots = np.roots([inertia, damping * inertia, speed**2 * sine**2 * (inertia + 4 * cosine**2), 2 * speed * sine * cosine * 9])
    return np.array(sorted([1, *np.exp(roots * 2 * np.pi / speed)], key=lambda m: (-abs(m), -m.imag)))


# b (J + m l^2 sin^2 + 4 m l^2 cos^2) w sin = 2 m l^2 k cos
CRITICAL = 9 / ((4.75 + 1) * np.sqrt(2 * 9.81) * np.sqrt(0.75))


@pytest.mark.parametrize('damping, stability', ((0.3, 'unstable'), (CRITICAL, 'neutral'), (0.5, 'stable')))
def test_governor(checks, mech9d, tmp_path, damping, stability):
    """Steady running of the governor: its multipliers are those of the cubic equation, and stability changes at the criterion."""
    words = ('--set', f'load(2).damping={damping!r}', '--set', 'solver.relative_tolerance=1e-12', '--set', 'solver.absolute_tolerance=1e-12')
    found = report_of(mech9d, tmp_path, 'governor', '--periodic', *words)['periodic']
    checks.near(found['period'], 2 * np.pi / np.sqrt(2 * 9.81), 1e-10, 'the period')
    checks.equal(found['turns'][0], 1, 'a turn of the shaft')
    checks.near(found['start'][1], np.pi / 3, 1e-10, 'the angle of the arm')
    given = np.array([complex(*pair) for pair in found['multipliers']])
    given = given[np.lexsort((-given.imag, -np.round(np.abs(given), 6)))]
    expected = multipliers(damping)
    expected = expected[np.lexsort((-expected.imag, -np.round(np.abs(expected), 6)))]
    checks.near(np.sort(given.real), np.sort(expected.real), 1e-8, 'multipliers', scale=1)
    checks.near(np.sort(given.imag), np.sort(expected.imag), 1e-8, 'and their imaginary parts', scale=1)
    checks.equal(found['stability'], stability, 'stability')


def test_hunting(checks, mech9d, tmp_path):
    """The governor goes to a limit cycle: its swing, by the method of Runge and Kutta; along it, and by the angle of the shaft, exponents
    are zero."""
    def rates(state):
        q, v, w = state
        sine, cosine = np.sin(q), np.cos(q)
        return np.array([v, w**2 * sine * cosine - 9.81 * sine - 0.3 * v,
                         (-9 * (q - np.pi / 3) - 2 * sine * cosine * w * v) / (4 + sine**2)])

    h, state, angles = 0.005, np.array([1.05, 0.0, 4.5]), []
    for _ in range(40000):
        a = rates(state)
        b = rates(state + h / 2 * a)
        c = rates(state + h / 2 * b)
        d = rates(state + h * c)
        state = state + h / 6 * (a + 2 * b + 2 * c + d)
        angles.append(state[0])
    swing = max(angles[-400:]) - min(angles[-400:])
    done = run(mech9d, example('governor'), '--table', tmp_path / 'run.dat', '--set', 'time.start=0', '--set', 'time.end=200', '--set',
               'time.intervals=20000')
    checks.true(done.returncode == 0, 'the run', done.stderr)
    last = read_table((tmp_path / 'run.dat').read_text())['q2'][-300:]
    # tolerance: rows and steps miss the turning points by 0.005 s at most
    checks.near(last.max() - last.min(), swing, 1e-3, 'the swing of the arm', scale=1)
    checks.true(swing > 0.1, 'the governor hunts', swing)
    report = report_of(mech9d, tmp_path, 'governor', '--exponents', '4')
    checks.near(report['exponents'][:2], 0, 0.02, 'two exponents are zero', scale=1)
    checks.true(report['exponents'][2] < -0.05, 'the others are below', report['exponents'])
    checks.near(sum(report['exponents']), report['divergence'], 1e-5, 'their sum is the mean divergence', scale=1)
