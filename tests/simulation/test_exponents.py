"""Lyapunov exponents against closed forms, identities and an integration in extended precision: linear oscillators, the driven pendulum of
Baker and Gollub, pairs in conservative motions, sums and dissipation, zero exponents, other independent coordinates, motors; bad requests.

Compares the program with itself: a four-bar by two independent coordinates."""
import json
from math import sqrt

import numpy as np
import pytest

import driven_pendulum
from four_bars import HEAVY_ROCKER
from mech9_cases import read_table, run

SLIDER = """&structure cq=1 /
&pair coordinate=1, links=1,2, kind='prismatic', axis=1,0,0 /
&body link=2, mass=1 /
&initial coordinate=1, position=0.3, velocity=0.4 /
"""
PENDULUM = """&structure cq=1 /
&pair coordinate=1, links=1,2, kind='revolute', axis=0,0,1 /
&body link=2, mass=1, centre=0,-1,0 /
&gravity acceleration=0,-1,0 /
&load kind='coordinate', coordinate=1, damping=0.5 /
&load kind='coordinate', coordinate=1, force=1.5, law='harmonic', amplitude=1, angular_frequency=0.6666666666666666,
      phase=1.5707963267948966 /
&initial coordinate=1, position=0.2 /
"""
DOUBLE = """&structure cq=1,2 /
&pair coordinate=1, links=1,2, kind='revolute', axis=0,0,1 /
&pair coordinate=2, links=2,3, kind='revolute', axis=0,0,1, point=0,-1,0 /
&body link=2, mass=1, centre=0,-1,0 /
&body link=3, mass=1, centre=0,-2,0 /
&gravity acceleration=0,-9.81,0 /
&initial coordinate=1, position=2.2 /
&initial coordinate=2, position=0.4 /
"""
FOUR_BAR = HEAVY_ROCKER + """&load kind='coordinate', coordinate=1, damping=0.05 /
&solver relative_tolerance=1e-10, absolute_tolerance=1e-11 /
"""


def go(program, folder, text, count, end, settings='', code=0):
    """Report, table and standard error of --exponents."""
    path, report, table = folder / 'motion.nml', folder / 'motion.json', folder / 'motion.dat'
    group = f'&exponents {settings} /\n' if settings else ''
    path.write_text(f'{text}{group}&time end={end!r}, intervals=3 /\n', encoding='utf-8')
    done = run(program, path, '--exponents', str(count), '--report', report, '--table', table)
    assert done.returncode == code, done.stderr
    return json.loads(report.read_text()) if code != 2 else None, read_table(table.read_text()) if code == 0 else None, done.stderr


def test_linear_oscillators(checks, mech9d, tmp_path):
    """The exponents are the real parts of the roots: equal for weak damping, apart for strong damping; -d/m and 0 without a spring."""
    report, table, _ = go(mech9d, tmp_path, SLIDER + "&load kind='coordinate', coordinate=1, stiffness=4, damping=0.3 /\n", 2, 2000.0,
                          'transient=100')
    # tolerance: what lengths change within a turn, a half, over the time
    checks.near(report['exponents'], [-0.15, -0.15], 1 / 1900, 'weak damping', scale=1)
    checks.near(sum(report['exponents']), -0.3, 1e-7, 'their sum is that of the roots', scale=1)
    checks.true(report['exponents'][0] >= report['exponents'][1] and report['states'] == 2, 'the largest one comes first')
    checks.near([table['L1'][-1], table['L2'][-1]], report['exponents'], 1e-15, 'the table ends with them')
    checks.equal([row[0] for row in report['exponents_history']], table['t'].tolist(), 'the history is the table')
    report, _, _ = go(mech9d, tmp_path, SLIDER + "&load kind='coordinate', coordinate=1, stiffness=4, damping=5 /\n", 2, 60.0, 'transient=20')
    # tolerance: steps of 1e-8
    checks.near(report['exponents'], [-1, -4], 1e-6, 'strong damping', scale=1)
    report, _, _ = go(mech9d, tmp_path, SLIDER + "&load kind='coordinate', coordinate=1, damping=0.5 /\n", 2, 80.0, 'transient=40')
    checks.near(report['exponents'], [0, -0.5], 1e-6, 'a damper alone: a place that stays is a zero exponent', scale=1)
    report, _, _ = go(mech9d, tmp_path, SLIDER + "&load kind='coordinate', coordinate=1, stiffness=-1 /\n", 2, 30.0, 'transient=12')
    checks.near(report['exponents'], [1, -1], 1e-6, 'an unstable position', scale=1)
    report, _, _ = go(mech9d, tmp_path, SLIDER + "&load kind='coordinate', coordinate=1, stiffness=-1 /\n", 1, 30.0, 'transient=12')
    checks.near(report['exponents'], [1], 1e-6, 'one exponent alone', scale=1)


def test_the_driven_pendulum(checks, mech9d, tmp_path):
    """Baker and Gollub: the largest exponent agrees with an integration in extended precision within the standard errors of both."""
    period = 3 * np.pi
    report, _, _ = go(mech9d, tmp_path, PENDULUM, 2, 2010 * period, f'transient={10 * period!r}')
    _, growth = driven_pendulum.walk(1.5, 0.3, 0.1, 210, steps=24, tangents=[(1, 0), (0, 1)])
    growth = growth[10:].astype(float) / float(driven_pendulum.PERIOD)
    blocks = growth[:, 0].reshape(20, 10).mean(axis=1)
    mean, error = blocks.mean(), blocks.std(ddof=1) / sqrt(20)
    both = sqrt(error**2 + report['exponents_error'][0]**2)
    checks.true(abs(report['exponents'][0] - mean) < 4 * both and both < 0.03, 'the largest exponent',
                (report['exponents'], report['exponents_error'], mean, error))
    checks.true(report['exponents'][0] > 10 * report['exponents_error'][0], 'the motion is chaotic')
    # tolerance: some steps of 1e-8 in each unit of time
    checks.near(sum(report['exponents']), -0.5, 1e-6, 'the sum is minus the damping over the inertia', scale=1)
    regular, _, _ = go(mech9d, tmp_path, PENDULUM.replace('force=1.5', 'force=0.9'), 2, 310 * period, f'transient={60 * period!r}')
    checks.near(regular['exponents'], [-0.25, -0.25], 0.002, 'a regular motion: both are half the damping', scale=1)
    points, logs = driven_pendulum.walk(0.9, 0.2, 0, 80, steps=24, tangents=[(1, 0), (0, 1)])
    checks.true(abs(logs[40:].astype(float).mean() / float(driven_pendulum.PERIOD) + 0.25) < 1e-6, 'as in extended precision')


def test_pairs(checks, mech9d, tmp_path):
    """The double pendulum without losses: l, 0, 0, -l."""
    report, _, _ = go(mech9d, tmp_path, DOUBLE, 4, 400.0, 'transient=20')
    exponents, errors = np.array(report['exponents']), np.array(report['exponents_error'])
    checks.true(exponents[0] > 0.5, 'the motion is chaotic', exponents)
    # tolerance: energies and volumes change by the errors of steps; the sum by the logarithm of the inertia at both ends over the time
    checks.near(exponents.sum(), 0, 5e-3, 'the volume stays', scale=1)
    checks.near(exponents[0] + exponents[3], 0, 0.02, 'the largest and the least are a pair', scale=1)
    checks.near(exponents[1] + exponents[2], 0, 0.02, 'those between too', scale=1)
    # a zero exponent falls as log(t)/t
    checks.true(abs(exponents[1]) < 0.1 * exponents[0], 'which are zero: the energy stays, and a motion may go on', (exponents, errors))


def test_other_coordinates(checks, mech9d, tmp_path):
    """A damped four-bar that comes to rest: by its crank, and by its rocker through a change of coordinates; the roots of its rest."""
    first = '&structure cq=1 /\n&initial coordinate=1, position=0.5, velocity=1 /\n&initial coordinate=4, position=1.7 /\n' + FOUR_BAR
    report, _, _ = go(mech9d, tmp_path, first, 2, 60.0, 'transient=30')
    modes = run(mech9d, tmp_path / 'motion.nml', '--modes', '--table', tmp_path / 'modes.dat')
    checks.true(modes.returncode == 0, 'modes', modes.stderr)
    checks.near(sum(report['exponents']), 2 * -decay(tmp_path), 1e-4, 'the sum is that of the roots', scale=1)
    other = ('&structure cq=4 /\n&initial coordinate=4, position=2.6179938779914944, velocity=0 /\n&initial coordinate=1, position=0.5 /\n'
             + FOUR_BAR)
    again, _, said = go(mech9d, tmp_path, other, 2, 60.0, 'transient=30')
    checks.near(again['exponents'], report['exponents'], 0.05, 'the same by the rocker', scale=1)
    checks.near(sum(again['exponents']), sum(report['exponents']), 1e-4, 'and their sum', scale=1)


def decay(folder):
    """The decay of the only mode of a table of --modes [1/s]."""
    return -float(read_table((folder / 'modes.dat').read_text())['eigenvalue.re'][0])


def test_mean_divergence(checks, mech9d, tmp_path):
    """A damper whose force is cubic in the rate: the mean divergence is -3 c/m times the mean square of the rate, which a run tells; so it is in
    a closed chain, by its crank and by its rocker, where the sum of the exponents is that of the roots at rest."""
    text = PENDULUM.replace('force=1.5', 'force=0.6').replace('damping=0.5 /', "damping=0.1 /\n&load kind='coordinate', coordinate=1, force=-0.2, law='polynomial', "
                            "over='dq1', coefficients=0,0,0,1 /") + '&solver relative_tolerance=1e-11, absolute_tolerance=1e-11 /\n'
    report, table, _ = go(mech9d, tmp_path, text, 2, 300.0, 'transient=50')
    runs = {}
    for end in (50.0, 300.0):
        (tmp_path / 'run.nml').write_text(f"{text}&quantity name='rms', of='dq1', take='rms' /\n&time end={end}, intervals={60 * int(end)} /\n")
        done = run(mech9d, tmp_path / 'run.nml', '--no-write', '--report', tmp_path / 'run.json')
        checks.true(done.returncode == 0, 'the run', done.stderr)
        runs[end] = json.loads((tmp_path / 'run.json').read_text())['quantities'][0]['value']
    square = (300 * runs[300.0]**2 - 50 * runs[50.0]**2) / 250
    # tolerance: a hundred rows in each second; the motion is regular
    checks.near(report['divergence'], -0.1 - 0.6 * square, 1e-6, 'the mean divergence', scale=1)
    # tolerance: Gauss's formula of fourth order in steps of 0.2 s and less
    checks.near(sum(report['exponents']), report['divergence'], 1e-6, 'and the sum of the exponents', scale=1)
    checks.near(report['exponents_change'], [table[name][-1] - table[name][99] for name in ('L1', 'L2')], 1e-15, 'changes in the second half')
    report, _, _ = go(mech9d, tmp_path, text, 1, 300.0, 'transient=50')
    checks.true('divergence' not in report, 'one exponent alone is not held against it')
    for start in ('cq=1 /\n&initial coordinate=1, position=0.5, velocity=1 /\n&initial coordinate=4, position=1.7 /\n',
                  'cq=4 /\n&initial coordinate=4, position=2.6179938779914944, velocity=0 /\n&initial coordinate=1, position=0.5 /\n'):
        report, _, said = go(mech9d, tmp_path, '&structure ' + start + FOUR_BAR, 2, 60.0, 'transient=0.1')
        checks.near(sum(report['exponents']), report['divergence'], 1e-6, 'a closed chain', scale=1)
        checks.true('; mean divergence ' in said, 'is told', said)


def test_motors(checks, mech9d, tmp_path):
    """A motor with inductance: three exponents, the roots of its equations; the place of the slider is free."""
    text = SLIDER + "&motor coordinate=1, kind='dc', voltage=1, resistance=2, inductance=0.5, constant=1 /\n"
    report, _, _ = go(mech9d, tmp_path, text, 3, 60.0, 'transient=20')
    # v' = i, i' = (1 - 2 i - v)/0.5
    roots = sorted(np.roots([1, 4, 2]).real, reverse=True)
    checks.near(report['exponents'], [0, *roots], 1e-6, 'zero and both roots', scale=1)
    checks.equal(report['states'], 3, 'coordinate, rate and current')
    checks.near(report['divergence'], -4, 1e-9, 'the divergence, in which the current counts', scale=1)


@pytest.mark.parametrize('count, text, settings, code, message', [
    (3, SLIDER, '', 2, 'there are 2 exponents'),
    (1, SLIDER.replace('&initial coordinate=1, position=0.3, velocity=0.4 /', "&drive coordinate=1, kind='polynomial', coefficients=0,1 /"),
     '', 3, 'every independent coordinate is driven, so that no exponent exists'),
    (1, SLIDER, 'transient=20', 3, 'the transient of the exponents ends after the motion')])
def test_refusals(checks, mech9d, tmp_path, count, text, settings, code, message):
    """Refusals of what exponents do not carry, with a remedy."""
    _, _, said = go(mech9d, tmp_path, text, count, 10.0, settings, code)
    checks.true(message in said, message, said)


def test_options(checks, mech9d, mech9k, tmp_path):
    """Options without meaning beside --exponents are refused; mech9k has none."""
    (tmp_path / 'm.nml').write_text(SLIDER, encoding='utf-8')
    for option in (('--plot', 'q1'), ('--hdf5', 'm.h5'), ('--equilibrium',), ('--check',), ('--study',)):
        done = run(mech9d, 'm.nml', '--exponents', '1', *option, folder=tmp_path)
        checks.true(done.returncode == 2, option[0], done.stderr)
    checks.equal(run(mech9k, 'm.nml', '--exponents', '1', folder=tmp_path).returncode, 2, 'mech9k has no exponents')
