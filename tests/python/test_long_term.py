"""Sections, Lyapunov exponents and periodic motions in Python, against closed forms."""
import numpy as np
import pytest


@pytest.fixture
def oscillator(mech9):
    """x = 0.3 cos 2t + 0.2 sin 2t, without losses."""
    m = mech9.Mechanism(title='oscillator')
    m.add('structure', cq=1)
    m.add('pair', coordinate=1, links=(1, 2), kind='prismatic', axis=(1, 0, 0))
    m.add('body', link=2, mass=1.0)
    m.add('load', kind='coordinate', coordinate=1, stiffness=4.0)
    m.add('initial', coordinate=1, position=0.3, velocity=0.4)
    m.add('solver', relative_tolerance=1e-12, absolute_tolerance=1e-13)
    return m


def test_section(checks, mech9, oscillator):
    """The points of a run; a run without a section has none."""
    with pytest.raises(mech9.UsageError):
        _ = oscillator.dynamics(end=10).section
    oscillator.add('section', coordinate=1, value=0.1, direction=-1)
    section = oscillator.dynamics(end=20, intervals=3).section
    turn = np.arctan2(0.2, 0.3) + np.arccos(0.1 / np.hypot(0.3, 0.2))
    expected = (turn + 2 * np.pi * np.arange(10)) / 2
    # tolerance: three hundred steps of 1e-12
    checks.near(section.t, expected[expected < 20], 1e-10, 'times of the points', scale=20)
    # the last place of a time moves the value by 3e-15
    checks.near(section['q1'], 0.1, 5e-14, 'the value')
    checks.equal(section['point'].tolist(), list(range(1, len(section.t) + 1)), 'the points count from 1')
    checks.equal((section.names[:4], section.units['dq1']), (('point', 't', 'q1', 'dq1'), 'm/s'), 'names and units')
    checks.true(not section.table.flags.writeable, 'the points are read-only')


def test_exponents(checks, mech9, oscillator):
    """A damped oscillator with real roots; refusals are exceptions."""
    oscillator.add('load', kind='coordinate', coordinate=1, damping=5.0)
    oscillator.add('time', end=40)
    found = oscillator.exponents(2, transient=20)
    checks.near(found.values, [-1, -4], 1e-8, 'the roots', scale=1)
    checks.equal((found.history.shape, found.t[-1]), ((200, 2), 40.0), 'the running means')
    checks.near(found.history[-1], found.values, 1e-15, 'they end with the exponents')
    checks.near([found.divergence, *found.changes], [-5, 0, 0], 1e-8, 'the mean divergence, and changes in the second half', scale=1)
    alone = oscillator.exponents(transient=20, time=5)
    checks.near(alone.values, [-1], 1e-6, 'one exponent, over another time', scale=1)
    checks.true(np.isnan(alone.divergence), 'is not held against the divergence')
    oscillator.add('exponents', transient=20)
    oscillator.add('parameter', name='d', sets='load(2).damping', low=5, high=6, count=2)
    oscillator.add('study', kind='grid', exponents=2)
    study = oscillator.study(threads=2)
    checks.near(np.array([study['L1'], study['L2']]), np.transpose([[-1, -4], [-3 + 5**0.5, -3 - 5**0.5]]), 1e-7, 'those of a study', scale=1)
    with pytest.raises(mech9.UsageError):
        oscillator.exponents(3)


def test_periodic(checks, mech9, oscillator):
    """A damped oscillator under a force: the amplitude response; a free one has no period without a guess."""
    with pytest.raises(mech9.DataError):
        oscillator.periodic()
    oscillator.add('load', kind='coordinate', coordinate=1, damping=0.5)
    oscillator.add('load', kind='coordinate', coordinate=1, force=1.0, law='harmonic', amplitude=1.0, angular_frequency=3.0)
    found = oscillator.periodic(intervals=30, energies=False)
    period = 2 * np.pi / 3
    checks.near(found.period, period, 1e-15, 'the period')
    exact = np.exp(np.roots([1, 0.5, 4]) * period)
    checks.near([found.multipliers.real, np.abs(found.multipliers.imag)], [exact.real, np.abs(exact.imag)], 1e-10, 'multipliers', scale=1)
    response = 1 / (4 - 9 + 1.5j) * np.exp(3j * found.run.t)
    checks.near(found.run['q1'], response.imag, 1e-10, 'the results of a period', scale=1)
    checks.equal((found.stability, len(found.run.t), len(found.motions)), ('stable', 31, 1), 'stable, thirty intervals, one motion')
    checks.equal(len(oscillator.periodic(starts=2, period=2 * period).motions), 1, 'random starts lead to the same motion')
    with pytest.raises(mech9.DataError):
        oscillator.periodic(period=1.0)


def test_branches(checks, mech9):
    """Branches of an inverted pendulum: the pitchfork P l sin q = k q; words of &branch hold for one call."""
    m = mech9.read_text("&structure cq=1 /\n&pair coordinate=1, links=1,2, kind='revolute', axis=0,0,1 /\n"
                        "&body link=2, mass=1, centre=0,2,0 /\n&load kind='coordinate', coordinate=1, stiffness=7 /\n"
                        "&load kind='force', link=2, position=0,2,0, force=0,-1,0 /\n&initial coordinate=1, position=0 /\n"
                        "&parameter name='P', sets='load(2).force(2)', factors=-1, value=1, low=0, high=10 /\n")
    found = m.branch('P')
    checks.equal([(point['branch'], point['type']) for point in found.special_points], [(1, 2), (2, 2)], 'the branch point, on both branches')
    checks.near(found.special_points[0]['value'], 3.5, 1e-12, 'its load', scale=1)
    checks.near(2 * found['P'] * np.sin(found['q1']), 7 * found['q1'], 1e-11, 'both branches', scale=1)
    checks.equal((found.names, found.units['q1'], len(found.branches)), (('branch', 'point', 'P', 'q1', 'growth', 'type'), 'rad', 2), 'columns')
    checks.true(not found.table.flags.writeable, 'the points are read-only')
    few = m.branch('P', points=5, switch=False)
    checks.equal((len(few.table), few.branches[0]['ends']), (9, ['points', 'points']), 'words of &branch')
    checks.near(m.branch('P').table, found.table, 0, 'they hold for one call', scale=1)
    with pytest.raises(mech9.UsageError, match='there is no parameter'):
        m.branch('Q')
