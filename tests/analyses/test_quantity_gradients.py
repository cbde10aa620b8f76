"""Derivatives of quantities by parameters: of strokes, extremes, means and integrals against closed forms; all kinds of quantities against
differences of whole runs; where there are none; report, HDF5 file, terminal, with recorded sensitivities and without.

Compares the program with itself in part: differences of runs at other values of a parameter.
"""
import json
import math
import os

import numpy as np
import pytest

from mech9_cases import run

h5py = pytest.importorskip('h5py', reason='h5py is not installed (Debian: python3-h5py)')

DONE, DATA = 0, 3
CRANK, ROD = 0.3, 1.1
SLIDER_CRANK = """&structure cq=1 /
&pair coordinate=1, links=1,2, kind='revolute', axis=0,0,1 /
&pair coordinate=2, links=2,3, kind='revolute', axis=0,0,1, point=0.3,0,0, moving_point=0,0,0 /
&pair coordinate=3, links=3,4, kind='revolute', axis=0,0,1, point=1.1,0,0, moving_point=0,0,0 /
&pair coordinate=4, links=1,4, kind='prismatic', axis=1,0,0, zero=0,1,0, moving_point=0,0,0 /
&initial coordinate=4, position=1.2 /
&drive coordinate=1, kind='polynomial', coefficients=0.4, 10 /
&point name='B', link=4 /
&body link=4, mass=2 /
&time end=0.7, intervals={intervals} /
&parameter name='crank', sets='pair(2).point(1)' /
&parameter name='rod', sets='pair(3).point(1)' /
&parameter name='angle', sets='drive.coefficients(1)' /
"""
# a slide that is driven by a sine, which is differentiated by all its numbers
SINE = """&structure cq=1 /
&pair coordinate=1, links=1,2, kind='prismatic', axis=1,0,0 /
&drive coordinate=1, kind='harmonic', mean=0.2, amplitude=0.7, angular_frequency=3, phase=0.4 /
&time end=1.7, intervals=20 /
&parameter name='middle', sets='drive.mean' /
&parameter name='swing', sets='drive.amplitude' /
&parameter name='speed', sets='drive.angular_frequency' /
&parameter name='phase', sets='drive.phase' /
"""
TAKES = ('start', 'end', 'min', 'max', 'peak', 'range', 'mean', 'rms', 'integral')
WEIGHTS = (4 / 5, -1 / 5, 4 / 105, -1 / 280)


class Case:
    """A directory for files, the program, and the checks."""

    def __init__(self, checks, directory, program):
        self.checks, self.directory, self.program = checks, directory, program

    def path(self, name):
        return os.path.join(self.directory, name)

    def run(self, text, *options):
        with open(self.path('case.nml'), 'w', encoding='utf-8') as file:
            file.write(text)
        return run(self.program, self.path('case.nml'), *options)

    def gradients(self, text, *options, request='gradients'):
        """Values of the quantities, and their derivatives as rows by parameters."""
        done = self.run(text + (f'&output {request}=.true. /\n' if request else ''), '--quiet', '--report', self.path('report.json'),
                        *options)
        if done.returncode != DONE:
            raise RuntimeError(f'{text}{options} ended with {done.returncode}:\n{done.stderr}')
        with open(self.path('report.json'), encoding='utf-8') as file:
            told = json.load(file)['quantities']
        values = np.array([math.nan if one['value'] is None else one['value'] for one in told])
        gradients = [[math.nan if by['value'] is None else by['value'] for by in one.get('gradient', [])] for one in told]
        return values, np.array(gradients)

    def near(self, found, expected, tolerance, why):
        self.checks.true(abs(found - expected) <= tolerance, why, f'{float(found)!r} instead of {float(expected)!r}')


@pytest.fixture
def case(checks, tmp_path, mech9k):
    return Case(checks, tmp_path, mech9k)


def quantities(wanted):
    return ''.join(f"&quantity name='n{i}', of='{one[0]}', take='{one[1]}'{one[2] if len(one) > 2 else ''} /\n"
                   for i, one in enumerate(wanted))


def test_strokes_and_dead_centres_of_a_slider_crank(case):
    """Dead centres between outputs: the stroke is twice the crank, whatever the rod, and it does not depend on where the motion
    begins. With 40 outputs for 1.1 turns the polynomials are exact to some 1e-12."""
    wanted = [('B.x', 'range'), ('B.x', 'max'), ('B.x', 'min'), ('B.x', 'at', ', at=0.123'), ('B.x', 'start'), ('B.x', 'end'),
              ('B.vx', 'integral'), ('q1', 'max')]
    _, found = case.gradients(SLIDER_CRANK.format(intervals=40) + quantities(wanted))

    def place(t):
        """Derivatives of the slide by crank, rod and angle."""
        angle = 0.4 + 10 * t
        root = math.sqrt(ROD**2 - (CRANK * math.sin(angle))**2)
        return np.array([math.cos(angle) - CRANK * math.sin(angle)**2 / root, ROD / root,
                         -CRANK * math.sin(angle) * (1 + CRANK * math.cos(angle) / root)])

    expected = [[2, 0, 0], [1, 1, 0], [-1, 1, 0], place(0.123), place(0), place(0.7), place(0.7) - place(0), [0, 0, 1]]
    for i, one in enumerate(wanted):
        for p, name in enumerate(('crank', 'rod', 'angle')):
            case.near(found[i][p], expected[i][p], 1e-9, f'slider-crank: {one} by {name}')


@pytest.mark.parametrize('more, why', (('', 'with rates'), ('derivatives=0, ', 'of values alone')), ids=('with rates', 'values alone'))
def test_means_and_extremes_of_a_sine(case, more, why):
    """Harmonics over a part of a period."""
    mean, swing, speed, phase, end = 0.2, 0.7, 3.0, 0.4, 1.7

    def numbers(values):
        mean, swing, speed, phase = values
        first, last = phase, speed * end + phase
        average = mean + swing * (np.cos(first) - np.cos(last)) / (speed * end)
        square = mean**2 + 2 * mean * (average - mean) + swing**2 * (0.5 - (np.sin(2 * last) - np.sin(2 * first)) / (4 * speed * end))
        return np.array([average, np.sqrt(square), average * end, mean + swing * np.sin(speed + phase)])

    point = np.array([mean, swing, speed, phase], dtype=complex)
    expected = np.array([numbers(point + 1e-30j * np.eye(4)[p]).imag / 1e-30 for p in range(4)]).T
    extremes = [[1, 1, 0, 0], [1, -1, 0, 0], [0, 2, 0, 0], [1, 1, 0, 0]]
    wanted = [('q1', 'mean'), ('q1', 'rms'), ('q1', 'integral'), ('q1', 'at', ', at=1'), ('q1', 'max'), ('q1', 'min'), ('q1', 'range'),
              ('q1', 'peak')]
    text = SINE + quantities(wanted) + f'&output {more}gradients=.true. /\n'
    _, found = case.gradients(text, request='')
    for i, one in enumerate(wanted):
        for p, name in enumerate(('middle', 'swing', 'speed', 'phase')):
            right = expected[i][p] if i < 4 else extremes[i - 4][p]
            case.near(found[i][p], right, 1e-9, f'sine {why}: {one} by {name}')


def test_an_extreme_at_the_end_of_the_time(case):
    """It stays there: the derivative of the column, not zero."""
    _, found = case.gradients(SINE.replace('end=1.7', 'end=0.2').replace('intervals=20', 'intervals=4')
                              + quantities([('q1', 'max'), ('q1', 'min'), ('dq1', 'min')]))
    last, first = 0.6 + 0.4, 0.4
    expected = [[1, math.sin(last), 0.7 * 0.2 * math.cos(last), 0.7 * math.cos(last)], [1, math.sin(first), 0, 0.7 * math.cos(first)],
                [0, 3 * math.cos(last), 0.7 * math.cos(last) - 2.1 * 0.2 * math.sin(last), -2.1 * math.sin(last)]]
    for row, right in zip(found, expected):
        for one, number in zip(row, right):
            case.near(one, number, 1e-12, 'extreme at an end of the time')


def test_every_kind_of_quantity_by_differences_of_runs(case):
    wanted = [(of, take) for of in ('B.x', 'B.vx', 'B.ax', 'q3', 'dq4') for take in TAKES] + [('B.ax', 'at', ', at=0.3')]
    # Small steps, and many outputs: else some of the runs follow an acceleration by polynomials of lower degree than others.
    text = SLIDER_CRANK.format(intervals=80) + quantities(wanted)
    _, found = case.gradients(text)
    for p, value in enumerate((CRANK, ROD, 0.4)):
        step, expected = value / 1024, 0
        for i, weight in enumerate(WEIGHTS, 1):
            above, below = (case.gradients(text, '--set', f'parameter({p + 1}).value={value + sign * i * step!r}', request='')[0]
                            for sign in (1, -1))
            expected = expected + weight * (above - below) / step
        for i, one in enumerate(wanted):
            # Between outputs an acceleration is the second derivative of a polynomial: round-off over the square of the outputs'
            # distance (1e-12), and over the step of the differences (1/2500).
            tolerance = 1e-7 if one[0] == 'B.ax' else 1e-9
            case.near(found[i][p], expected[i], tolerance * max(1, abs(expected[i])), f'{one} by parameter {p + 1}')


def test_report_file_and_terminal_tell_the_same(case):
    """The HDF5 file, the report and the terminal tell the same, whether sensitivities are recorded or not."""
    text = SLIDER_CRANK.format(intervals=20) + quantities([('B.x', 'range'), ('closure', 'max'), ('q2', 'rms')])
    hdf5 = case.path('case.h5')
    tables = []
    for request in ('gradients', 'sensitivities'):
        _, found = case.gradients(text, '--hdf5', hdf5, '--table', case.path('case.dat'), request=request)
        case.checks.true(bool(np.isnan(found[1]).all()) and not np.isnan(found[[0, 2]]).any(), f'{request}: the closure has none')
        with h5py.File(hdf5) as file:
            kept = file['quantities/gradient']
            case.checks.true(np.array_equal(kept[()], found, equal_nan=True), f'{request}: the HDF5 file has the numbers of the report')
            case.checks.equal([kept.dims[i][0].name for i in range(2)], ['/quantity', '/parameter'], f'{request}: scales')
            case.checks.equal([name.decode() for name in file['quantity'][()]], ['n0', 'n1', 'n2'], f'{request}: names')
            case.checks.equal([name.decode() for name in file['parameter'][()]], ['crank', 'rod', 'angle'], f'{request}: parameters')
            case.checks.equal('sensitivity' in file, request == 'sensitivities', f'{request}: recorded derivatives')
        with open(case.path('case.dat'), encoding='utf-8') as file:
            tables.append([line for line in file if line[0] != '#'])
    case.checks.true(len(tables[0][-1].split()) < len(tables[1][-1].split()), 'gradients alone have no columns')
    case.checks.true(all(long.startswith(short.rstrip()) for short, long in zip(*tables)), 'the other columns are the same')
    done = case.run(text + '&output gradients=.true. /\n')
    case.checks.true('n0 = 0.6 m\n  d(n0)/d(crank) = 2' in done.stderr and ' m/m\n' in done.stderr, 'on the terminal', done.stderr)
    case.checks.true('  d(n1)/d(rod) is not known\n' in done.stderr, 'what is not known', done.stderr)
    poses = text + '&output poses=.true., gradients=.true. /\n'
    again, _ = case.gradients(poses, '--hdf5', hdf5, request=''), None
    case.checks.true(np.allclose(again[1], found, rtol=1e-12, atol=1e-12, equal_nan=True), 'poses in the rows change nothing')


def test_a_run_that_stops_has_no_derivatives(case):
    """A run that does not come to its end."""
    text = SLIDER_CRANK.format(intervals=20).replace("sets='pair(3).point(1)'", "sets='pair(3).point(1)', value=0.25") \
        + quantities([('B.x', 'range')]) + '&output gradients=.true. /\n'
    done = case.run(text, '--quiet', '--report', case.path('report.json'), '--hdf5', case.path('case.h5'))
    case.checks.true(done.returncode not in (DONE, DATA), 'the rod is too short', done.stderr)
    if os.path.exists(case.path('case.h5')):
        with h5py.File(case.path('case.h5')) as file:
            case.checks.true(bool(np.isnan(file['quantities/gradient'][()]).all()), 'the HDF5 file has none')


ONE = "&quantity name='n0', of='B.x', take='range' /\n"
GRADIENTS = '&output gradients=.true. /\n'


@pytest.mark.parametrize('data, message', (
    ('\n'.join(line for line in SLIDER_CRANK.splitlines() if not line.startswith('&parameter')) + '\n' + ONE,
     'gradients are derivatives by the parameters, and there are none; give a group &parameter'),
    (SLIDER_CRANK, 'gradients are derivatives of the quantities, and there are none; give a group &quantity'),
    (SLIDER_CRANK + ONE.replace('n0', 'gradient'), "have the name 'gradient' in the HDF5 file; choose another name")),
    ids=('no parameters', 'no quantities', 'a wrong name'))
def test_refused(case, data, message):
    done = case.run(data.format(intervals=20) + GRADIENTS)
    case.checks.true(done.returncode == DATA and message in ' '.join(done.stderr.split()), message, done.stderr)


def test_a_study_records_no_gradients(case):
    data = SLIDER_CRANK.format(intervals=20) + ONE + "&study kind='grid' /\n"
    data = data.replace("sets='pair(2).point(1)'", "sets='pair(2).point(1)', low=0.2, high=0.3, count=2")
    data = data.replace("sets='pair(3).point(1)'", "sets='pair(3).point(1)', low=1, high=1.1, count=2")
    data = data.replace("sets='drive.coefficients(1)'", "sets='drive.coefficients(1)', low=0, high=0.1, count=2")
    message = 'a study records no gradients: leave out gradients in &output'
    done = case.run(data + GRADIENTS, '--study')
    case.checks.true(done.returncode == DATA and message in ' '.join(done.stderr.split()), message, done.stderr)


def test_mech9d_finds_gradients_of_driven_motions(checks, tmp_path, mech9d):
    done = Case(checks, tmp_path, mech9d).run(SLIDER_CRANK.format(intervals=20) + ONE + GRADIENTS)
    checks.equal(done.returncode, 0, 'mech9d finds gradients of driven motions')
