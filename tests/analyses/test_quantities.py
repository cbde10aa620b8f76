"""Quantities: strokes, extremes between outputs, means and integrals against closed forms; values at times; wrong columns.
"""
import json
import math
import os
import tempfile

import numpy as np
import pytest

from mech9_cases import run, table_of

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
&time end=0.7, intervals=20 /
"""
# a slide that is driven by a sine, and the force of its drive
SINE = """&structure cq=1 /
&pair coordinate=1, links=1,2, kind='prismatic', axis=1,0,0 /
&drive coordinate=1, kind='harmonic', mean=0.2, amplitude=0.7, angular_frequency=3, phase=0.4 /
&body link=2, mass=2.5 /
&output drive_forces=.true. /
&time end={end!r}, intervals=20 /
"""
# a mass on a spring
OSCILLATOR = """&structure cq=1 /
&pair coordinate=1, links=1,2, kind='prismatic', axis=1,0,0 /
&initial coordinate=1, position=0.5 /
&body link=2, mass=2 /
&load kind='coordinate', coordinate=1, stiffness=18 /
&solver relative_tolerance=1e-12, absolute_tolerance=1e-13 /
&time end=2.2, intervals=23 /
"""


def quantity(number, of, take, more=''):
    return f"&quantity name='n{number}', of='{of}', take='{take}'{more} /\n"


def numbers_of(checks, program, text, wanted, why, code=DONE):
    """Values of quantities in the report and the HDF5 file, in their order; `wanted` holds (of, take, more)."""
    with tempfile.TemporaryDirectory() as folder:
        data, report, hdf5 = (os.path.join(folder, name) for name in ('case.nml', 'report.json', 'case.h5'))
        with open(data, 'w', encoding='utf-8') as file:
            file.write(text + ''.join(quantity(i, *one) for i, one in enumerate(wanted)))
        done = run(program, data, '--report', report, '--hdf5', hdf5)
        checks.true(done.returncode == code, f'{why}: ends with {code}', done.stderr)
        with open(report, encoding='utf-8') as file:
            told = json.load(file)['quantities']
        checks.true([one['name'] for one in told] == [f'n{i}' for i in range(len(wanted))], f'{why}: names', told)
        if code == DONE:
            checks.true(all(f"n{i} = " in done.stderr for i in range(len(wanted))), f'{why}: on the terminal', done.stderr)
            with h5py.File(hdf5) as file:
                kept = [file['quantities'][f'n{i}'][()] for i in range(len(wanted))]
            checks.true(kept == [one['value'] for one in told], f'{why}: the HDF5 file has the numbers of the report', kept)
        return [one['value'] for one in told], [one['unit'] for one in told]


def near(checks, found, expected, tolerance, why):
    checks.true(abs(found - expected) <= tolerance, why, f'{found!r} instead of {expected!r}')


@pytest.fixture(params=('mech9k', 'mech9d'))
def program(build, request):
    return build.program(request.param)


def test_strokes_and_dead_centres_of_slider_cranks(checks, program):
    """The stroke is twice the crank; the dead centres lie between outputs. Twenty outputs for 1.1 turns: the polynomials through
    four of them are exact to some 1e-10."""
    wanted = [('B.x', 'range'), ('B.x', 'min'), ('B.x', 'max'), ('q1', 'start'), ('q1', 'end'), ('B.vx', 'integral'),
              ('B.ax', 'integral'), ('B.x', 'at', ', at=0.123'), ('B.vx', 'peak')]
    values, units = numbers_of(checks, program, SLIDER_CRANK, wanted, f'{os.path.basename(program)}: slider-crank')

    def place(t):
        angle = 0.4 + 10 * t
        return CRANK * math.cos(angle) + math.sqrt(ROD**2 - (CRANK * math.sin(angle))**2)

    def rate(t):
        angle = 0.4 + 10 * t
        root = math.sqrt(ROD**2 - (CRANK * math.sin(angle))**2)
        return -10 * CRANK * math.sin(angle) * (1 + CRANK * math.cos(angle) / root)

    expected = [2 * CRANK, ROD - CRANK, ROD + CRANK, 0.4, 7.4, place(0.7) - place(0), rate(0.7) - rate(0), place(0.123),
                max(abs(rate(t)) for t in np.linspace(0, 0.7, 200001))]
    for i, (found, right) in enumerate(zip(values, expected)):
        near(checks, found, right, 1e-9 * max(1, abs(right)), f'{program}: {wanted[i]}')
    checks.true(units == ['m', 'm', 'm', 'rad', 'rad', 'm/s s', 'm/s^2 s', 'm', 'm/s'], f'{program}: units', units)


@pytest.mark.parametrize('end, why', ((2 * math.pi / 3, 'a period'), (1.7, 'a part of a period')), ids=('a period', 'a part of a period'))
def test_means_of_sines(checks, program, end, why):
    """Means and root mean squares of harmonics over whole and broken periods; of a force, which has no rate, too."""
    def phase(t):
        return 3 * t + 0.4

    mean = 0.2 + 0.7 * (math.cos(phase(0)) - math.cos(phase(end))) / 3 / end
    square = 0.49 * (end / 2 - (math.sin(2 * phase(end)) - math.sin(2 * phase(0))) / 12)      # of the sine, over time
    rms = math.sqrt(square / end + 2 * 0.2 * (mean - 0.2) + 0.04)
    values, _ = numbers_of(checks, program, SINE.format(end=end),
                           [('q1', 'mean'), ('q1', 'rms'), ('q1', 'integral'), ('F1', 'rms'), ('F1', 'max'), ('q1', 'peak')], why)
    expected = [mean, rms, mean * end, 2.5 * 9 * math.sqrt(square / end), 2.5 * 9 * 0.7, 0.9]
    for found, right, name in zip(values, expected, ('mean', 'rms', 'integral', 'rms of the force', 'largest force', 'peak')):
        near(checks, found, right, 1e-10 * max(1, abs(right)), f'{program}: {why}: {name}')


def test_amplitude_and_energy_of_an_oscillator(checks, mech9d):
    """A free motion: amplitude and energy of a mass on a spring; the motion's error is some 1e-10."""
    text = OSCILLATOR
    values, _ = numbers_of(checks, mech9d, text, [('q1', 'min'), ('dq1', 'peak'), ('E.kinetic', 'max'), ('E.total', 'range'),
                                                   ('E.kinetic', 'mean'), ('q1', 'at', ', at=1.0')], 'oscillator')
    mean = 2.25 * (0.5 - math.sin(6 * 2.2) / 12 / 2.2)
    for found, right, name in zip(values, (-0.5, 1.5, 2.25, 0, mean, 0.5 * math.cos(3)),
                                  ('least position', 'largest speed', 'largest energy', 'constant energy', 'mean energy', 'at')):
        near(checks, found, right, 3e-10 * max(1, abs(right)), f'oscillator: {name}')


def test_times_between_outputs_change_no_rows(checks, tmp_path, mech9k):
    """They change nothing in the table but the last digits."""
    path = os.path.join(tmp_path, 'rows.nml')
    with open(path, 'w', encoding='utf-8') as file:
        file.write(SINE.format(end=1.0))
    plain = table_of(mech9k, path)
    with open(path, 'a', encoding='utf-8') as file:
        file.write(quantity(1, 'F1', 'rms'))
    visited = table_of(mech9k, path)
    checks.true(all(np.allclose(plain[name], visited[name], rtol=1e-13, atol=1e-13) for name in plain), 'the rows are the same')


@pytest.mark.parametrize('group, message', (
    (quantity(1, 'B.z1', 'max'), "11:25: quantity 'n1' is of column 'B.z1', which is not recorded; did you mean 'B.z'?"),
    (quantity(1, 'R4.fx', 'max'), "'R4.fx', which is not recorded; set reactions=.true. in &output"),
    (quantity(1, 'R4.fx', 'max') + '&output reaction_pairs=1 /\n', '; pair 4 is not among reaction_pairs in &output'),
    (quantity(1, 'F1', 'max'), "'F1', which is not recorded; set drive_forces=.true. in &output"),
    (quantity(1, 'F2', 'max'), "'F2', which is not recorded; coordinate 2 has no drive"),
    (quantity(1, 'dq1', 'max') + '&output derivatives=0 /\n', '; set derivatives=1 in &output'),
    (quantity(1, 'B.ax', 'max') + '&output derivatives=1 /\n', '; set derivatives=2 in &output'),
    (quantity(1, 'C1', 'max'), '; there are no couplings'),
    (quantity(1, 'conditioning', 'max'), '; set conditioning=.true. in &output'),
    (quantity(1, 'E.total', 'max'), '; mech9d alone records energies'),
    (quantity(1, 'B.x', 'maximum'), "unknown take 'maximum'"),
    (quantity(1, 'B.x', 'at'), "take='at' needs 'at': the time of the value"),
    (quantity(1, 'B.x', 'max', ', at=0.1'), "'at' gives the time for take='at'"),
    (quantity(1, 'B.x', 'at', ', at=0.8'), 'this time is not among those of the results, 0 to 0.7 s'),
    (quantity(1, 'B.x', 'max') + quantity(1, 'B.x', 'min'), "a second &quantity for name 'n1'")),
    ids=('B.z1', 'R4.fx', 'R4.fx, other pairs', 'F1', 'F2', 'dq1', 'B.ax', 'C1', 'conditioning', 'E.total', 'unknown take', 'no time',
         'a time too many', 'a time outside', 'a second one'))
def test_mistakes(checks, tmp_path, mech9k, group, message):
    path, table = (os.path.join(tmp_path, name) for name in ('wrong.nml', 'kept.dat'))
    with open(path, 'w', encoding='utf-8') as file:
        file.write(SLIDER_CRANK + group)
    with open(table, 'w', encoding='utf-8') as file:
        file.write('kept')
    for more in (('--table', table), ('--check',)):
        done = run(mech9k, path, *more)
        checks.true(done.returncode == DATA and message in done.stderr, f'{group.strip()} {more[0]}: {message}', done.stderr)
    with open(table, encoding='utf-8') as file:
        checks.true(file.read() == 'kept', f'{group.strip()}: nothing is written over')


SHAFTS = """&structure cq=1 /
&pair coordinate=1, links=1,2, kind='revolute', axis=0,0,1 /
&pair coordinate=2, links=1,3, kind='revolute', axis=0,0,1 /
&pair coordinate=3, links=1,4, kind='revolute', axis=0,0,1 /
&coupling kind='gear', coordinates=1,2, ratio=2 /
&coupling kind='gear', coordinates=2,3, ratio=2 /
&drive coordinate=1, kind='polynomial', coefficients=0,1 /
"""


@pytest.mark.parametrize('column, more, message', (
    ('C3', '', '; the columns are C1, C2, with reactions=.true. in &output'),
    ('C2', '', '; set reactions=.true. in &output'),
    ('C3', '&output reactions=.true. /\n', '; the columns are C1, C2')), ids=('C3', 'C2', 'C3 with reactions'))
def test_columns_of_couplings_are_told(checks, tmp_path, mech9k, column, more, message):
    """The columns of couplings are told where one is missing."""
    path = os.path.join(tmp_path, 'coupled.nml')
    with open(path, 'w', encoding='utf-8') as file:
        file.write(SHAFTS + more + quantity(1, column, 'max'))
    done = run(mech9k, path)
    checks.true(done.returncode == DATA and message + '\n' in done.stderr, f'{column}: {message}', done.stderr)
