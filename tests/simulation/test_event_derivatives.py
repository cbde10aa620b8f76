"""Derivatives by parameters and Lyapunov exponents through the events of motions that are not smooth: impacts on stops against closed forms
and identities, rest at stops, dependent coordinates of closed chains, drives beside them; frictions that slip, turn round and stick; what
has no derivatives.

Compares the program with itself: derivatives of mechanisms with several coordinates against differences of runs."""
import cmath
import json
import re
from math import log, sqrt

import numpy as np
import pytest

from event_derivative_cases import BOUNCING, COLUMNS, FOUR_BAR, OSCILLATOR, TIGHT, against_differences, go, kinds, \
    quantities_against_differences

FIVE_BAR = """&structure cq=1,2 /
&pair coordinate=1, links=1,2, kind='revolute', axis=0,0,1, point=0,0,0 /
&pair coordinate=2, links=2,3, kind='revolute', axis=0,0,1, point=0.1,0.5,0 /
&pair coordinate=3, links=3,4, kind='revolute', axis=0,0,1, point=0.5,0.9,0 /
&pair coordinate=4, links=4,5, kind='revolute', axis=0,0,1, point=0.9,0.55,0 /
&pair coordinate=5, links=1,5, kind='revolute', axis=0,0,1, point=1,0,0 /
&body link=2, mass=1, centre=0.05,0.25,0, inertia=0.02,0.02,0.03,0,0,0 /
&body link=3, mass=0.5, centre=0.3,0.7,0, inertia=0.02,0.02,0.02,0,0,0 /
&body link=4, mass=0.7, centre=0.7,0.7,0, inertia=0.02,0.02,0.02,0,0,0 /
&body link=5, mass=1.2, centre=0.95,0.3,0, inertia=0.02,0.02,0.04,0,0,0 /
&gravity acceleration=0,-9.81,0 /
&initial coordinate=2, position=0, velocity=0.5 /
&parameter name='m', sets='body(3).mass' /
&parameter name='x', sets='pair(3).point(1)' /
&parameter name='e', sets='stop(1).restitution' /
"""
FREE_CRANK = """&initial coordinate=1, position=0, velocity=-1 /
&stop coordinate=5, low=-0.2, restitution=0.7 /
&parameter name='low', sets='stop(1).low' /
"""
DRIVEN_CRANK = """&drive coordinate=1, kind='harmonic', amplitude=0.2, angular_frequency=6 /
&stop coordinate=5, high=1.5, restitution=0.7 /
&parameter name='w', sets='drive(1).angular_frequency' /
"""
CARRIAGE = """&structure cq=1,2,3 /
&pair coordinate=1, links=1,2, kind='prismatic', axis=1,0,0 /
&pair coordinate=2, links=2,3, kind='prismatic', axis=0,1,0 /
&pair coordinate=3, links=3,4, kind='revolute', axis=0,0,1 /
&body link=2, mass=1 /
&body link=3, mass=1 /
&body link=4, mass=0.6, centre=0.5,0,0, inertia=0,0,0.02,0,0,0 /
&gravity acceleration=0,-9.81,0 /
&drive coordinate=1, kind='harmonic', amplitude=0.3, angular_frequency=5, phase=0.4 /
&stop coordinate=2, low=-0.1, restitution=0.3 /
&stop coordinate=3, low=-1.2, restitution=0.6 /
&initial coordinate=2, position=0.1 /
&initial coordinate=3, position=0.5 /
&parameter name='A', sets='drive(1).amplitude' /
&parameter name='w', sets='drive(1).angular_frequency' /
&parameter name='c', sets='body(3).centre(1)' /
&parameter name='e', sets='stop(1).restitution' /
&parameter name='low', sets='stop(2).low' /
"""
DRY = """&structure cq=1 /
&pair coordinate=1, links=1,2, kind='prismatic', axis=1,0,0 /
&body link=2, mass=1 /
&load kind='coordinate', coordinate=1, stiffness=1 /
&friction coordinate=1, dynamic=1, preload=1 /
&initial coordinate=1, position=12, velocity=6 /
&parameter name='m', sets='body(1).mass' /
&parameter name='k', sets='load(1).stiffness' /
&parameter name='F', sets='friction(1).dynamic' /
&parameter name='x', sets='initial(1).position' /
&parameter name='v', sets='initial(1).velocity' /
"""
BELT = """&structure cq=1,2 /
&pair coordinate=1, links=1,2, kind='prismatic', axis=1,0,0 /
&pair coordinate=2, links=2,3, kind='prismatic', axis=1,0,0 /
&body link=3, mass=1 /
&gravity acceleration=0,0,-9.81 /
&drive coordinate=1, kind='polynomial', coefficients=0,0.5 /
&friction coordinate=2, dynamic=0.3 /
&load kind='spring', links=1,3, stiffness=10 /
&initial coordinate=2, position=0.1, velocity=-0.8 /
&parameter name='mu', sets='friction(1).dynamic' /
&parameter name='m', sets='body(1).mass' /
&parameter name='k', sets='load(1).stiffness' /
"""
TWO_BEARINGS = """&structure cq=1,2 /
&pair coordinate=1, links=1,2, kind='revolute', axis=0,0,1 /
&pair coordinate=2, links=2,3, kind='revolute', axis=0,0,1, point=0.5,0,0 /
&body link=2, mass=1, centre=0.25,0,0, inertia=0,0,0.03,0,0,0 /
&body link=3, mass=0.7, centre=0.8,0,0, inertia=0,0,0.02,0,0,0 /
&gravity acceleration=0,-9.81,0 /
&friction coordinate=1, dynamic=0.3, radius=0.03, preload=0.01 /
&friction coordinate=2, dynamic=0.9, radius=0.3, preload=0.01 /
&initial coordinate=1, position=0.2, velocity=1 /
&initial coordinate=2, position=0.4, velocity=-2 /
&parameter name='m', sets='body(2).mass' /
&parameter name='l', sets='pair(2).point(1)' /
&parameter name='r', sets='friction(2).radius' /
"""
SCREW = """&structure cq=1,2 /
&pair coordinates=1,2, links=1,2, kind='cylindrical', axis=0.3,0.2,1 /
&body link=2, mass=1, centre=0.2,0.1,0.3, inertia=0.03,0.04,0.05,0,0,0 /
&gravity acceleration=0,-9.81,-3 /
&friction coordinate=1, dynamic=0.2, radius=0.05 /
&friction coordinate=2, dynamic=0.15, arm=0.2 /
&initial coordinate=1, position=0.5, velocity=6 /
&initial coordinate=2, position=0, velocity=2 /
&parameter name='c', sets='body(1).centre(1)' /
&parameter name='ax', sets='pair(1).axis(1)' /
&parameter name='arm', sets='friction(2).arm' /
"""
RUBBING_BARS = FOUR_BAR.replace('&parameter', '''&friction coordinate=1, dynamic=0.2, radius=0.01 /
&friction coordinate=3, dynamic=0.2, radius=0.02 /
&friction coordinate=4, dynamic=0.2, radius=0.02 /
&parameter''', 1)
#: A bearing that sticks, and breaks loose at a larger coefficient than that of sliding.
LOOSE_BEARINGS = TWO_BEARINGS.replace('friction coordinate=2, dynamic=0.9', 'friction coordinate=2, static=1.1, dynamic=0.9') \
    + "&parameter name='s', sets='friction(2).static' /\n&parameter name='d', sets='friction(2).dynamic' /\n"
#: A four-bar whose crank rests in its bearing until a load that grows breaks it loose.
LOOSE_BARS = re.sub('&stop.*\n|.*stop.*\n', '', FOUR_BAR) + '''&friction coordinate=1, dynamic=0.2, static=0.3, radius=0.1 /
&load kind='coordinate', coordinate=1, force=8, law='harmonic', amplitude=1, angular_frequency=4 /
&parameter name='s', sets='friction(1).static' /
&parameter name='d', sets='friction(1).dynamic' /
&parameter name='F', sets='load(2).force' /
'''
def bounce(end, h, e, g):
    """Height and rate of a body that bounces, and their derivatives by the height of its fall, the restitution and gravity."""
    t, u = sqrt(2 * h / g), sqrt(2 * h * g)
    n = 1
    while t * (1 + 2 * sum(e**k for k in range(1, n + 1))) < end:
        n += 1
    flights = 1 + 2 * sum(e**k for k in range(1, n))
    s, up = end - t * flights, e**n * u
    by_e = 2 * sum(k * e**(k - 1) for k in range(1, n))
    slopes = {}
    for name, ds, dup, dg in (('h', -t / (2 * h) * flights, up / (2 * h), 0), ('e', -t * by_e, n * up / e, 0),
                              ('g', t / (2 * g) * flights, up / (2 * g), 1)):
        slopes[name] = (s * dup + (up - g * s) * ds - s**2 / 2 * dg, dup - g * ds - s * dg)
    return (up * s - g * s**2 / 2, up - g * s), slopes


@pytest.mark.parametrize('end', [1.0, 3.1, 8.3])
def test_a_slider_that_bounces(checks, mech9d, tmp_path, end):
    """After one impact, and after many: by the height, the restitution, gravity and the end of the stop; the mass does not matter."""
    table, _, _ = go(mech9d, tmp_path, BOUNCING + COLUMNS + TIGHT, end=end)
    values, slopes = bounce(end, 1.0, 0.9, 9.81)
    # the file has the acceleration -g; a stop further up is a lower fall from a place that stays
    expected = {'h': slopes['h'], 'e': slopes['e'], 'g': (-slopes['g'][0], -slopes['g'][1]), 'low': (1 - slopes['h'][0], -slopes['h'][1]),
                'm': (0, 0)}
    for column, value, by in zip(('q1', 'dq1'), values, range(2)):
        checks.near(table[column][-1], value, 1e-11, column, scale=max(1.0, abs(value)))
        for name, slope in expected.items():
            # tolerance: rates change by the errors of the times of many impacts
            checks.near(table[f'd({column})/d({name})'][-1], slope[by], 1e-9, f'{column} by {name}', scale=max(1.0, abs(slope[by])))


def test_rest_on_a_stop(checks, mech9d, tmp_path):
    """After endless impacts the slider is where the stop is; a load that lifts it lets it go again."""
    table, report, _ = go(mech9d, tmp_path, BOUNCING + COLUMNS, end=9.0)
    checks.equal(kinds(report)[-1], ('close', 1), 'it rests')
    checks.near([table[f'd({column})/d({name})'][-1] for name in ('h', 'e', 'g', 'low', 'm') for column in ('q1', 'dq1')],
                [0, 0, 0, 0, 0, 0, 1, 0, 0, 0], 1e-15, 'its place follows the stop alone')
    lifted = BOUNCING.replace('restitution=0.9', 'restitution=0.1') + "&load kind='coordinate', coordinate=1, force=30, law='harmonic', " \
        "amplitude=1, angular_frequency=0.6 /\n&parameter name='F', sets='load(1).force' /\n"
    report = against_differences(checks, mech9d, tmp_path, lifted, ('q1', 'dq1'), 2.0, 8)
    checks.true(('close', 1) in kinds(report) and ('open', 1) in kinds(report), 'it rests and goes on')


@pytest.mark.parametrize('text, columns, end, found', ids=['impacts', 'rest', 'two free', 'one driven', 'carriage'], argvalues=[
    (FOUR_BAR, ('q1', 'dq1', 'q4', 'dq4'), 0.7, ('impact', 1)),
    (FOUR_BAR.replace('restitution=0.7', 'restitution=0.3'), ('q1', 'dq1', 'q4', 'dq4', 'ddq1'), 1.0, ('close', 1)),
    (FIVE_BAR + FREE_CRANK, ('q1', 'q2', 'q5', 'dq1', 'dq2', 'dq5'), 0.5, ('impact', 1)),
    (FIVE_BAR + DRIVEN_CRANK, ('q2', 'q5', 'dq2', 'dq5'), 0.5, ('impact', 1)),
    (CARRIAGE, ('q2', 'dq2', 'q3', 'dq3', 'F1', 'R2.fx', 'R2.fy', 'R2.mz', 'E.kinetic', 'E.total'), 0.9, ('impact', 2))])
def test_several_coordinates(checks, mech9d, tmp_path, text, columns, end, found):
    """A stop of a dependent coordinate in a closed chain, with impacts and at rest; a carriage that a drive moves, whose slide is hit while
    it rests on its stop."""
    output = COLUMNS.replace(' /', ', energies=.true., drive_forces=.true., reactions=.true. /') if 'F1' in columns else COLUMNS
    report = against_differences(checks, mech9d, tmp_path, text, columns, end, 6, output)
    checks.true(found in kinds(report), 'the event of the case', kinds(report))


def dry_oscillator(end, m, k, f, x, v):
    """Place and rate of a dry oscillator that goes forward at first, by its half swings; complex arguments give derivatives."""
    w = cmath.sqrt(k / m)
    centre = -f / k
    ahead = cmath.atan(v / w / (x - centre)) / w
    if end < ahead.real:
        phase = w * end
        return (centre + (x - centre) * cmath.cos(phase) + v / w * cmath.sin(phase),
                v * cmath.cos(phase) - (x - centre) * w * cmath.sin(phase))
    x = centre + cmath.sqrt((x - centre)**2 + (v / w)**2)
    t = ahead
    while abs(x) > abs(f / k):
        centre = f / k if x.real > 0 else -f / k
        if end < (t + cmath.pi / w).real:
            phase = w * (end - t)
            return centre + (x - centre) * cmath.cos(phase), -(x - centre) * w * cmath.sin(phase)
        x = 2 * centre - x
        t += cmath.pi / w
    return x, 0j


@pytest.mark.parametrize('end', [0.3, 2.0, 20.0, 25.0])
def test_a_dry_oscillator(checks, mech9d, tmp_path, end):
    """Before it turns round, after one half swing, after many, and at rest."""
    table, _, _ = go(mech9d, tmp_path, DRY + COLUMNS + TIGHT, end=end)
    at = [1.0, 1.0, 1.0, 12.0, 6.0]
    values = dry_oscillator(end, *at)
    step = 1e-30
    for column, value, by in zip(('q1', 'dq1'), values, range(2)):
        checks.near(table[column][-1], value.real, 1e-10, column, scale=10)
        for k, name in enumerate('m k F x v'.split()):
            slope = dry_oscillator(end, *[a + (step * 1j if i == k else 0) for i, a in enumerate(at)])[by].imag / step
            checks.near(table[f'd({column})/d({name})'][-1], slope, 1e-9, f'{column} by {name}', scale=max(1.0, abs(slope)))


@pytest.mark.parametrize('text, columns, end, found', ids=['belt', 'two bearings', 'cylindrical', 'four-bar', 'smooth', 'loose bearing', 'loose bar'], argvalues=[
    (BELT, ('q2', 'dq2'), 2.0, ('stick', 1)),
    (TWO_BEARINGS, ('q1', 'dq1', 'q2', 'dq2', 'R1.fx', 'R1.mz', 'R2.mz'), 1.6, ('stick', 2)),
    (SCREW, ('q1', 'dq1', 'q2', 'dq2', 'R1.fx'), 0.2, None),
    (RUBBING_BARS, ('q1', 'dq1', 'q4', 'dq4', 'R3.fx', 'R3.mz'), 0.5, ('impact', 1)),
    (BELT.replace('dynamic=0.3', "dynamic=0.3, law='smooth', transition=0.1"), ('q2', 'dq2', 'ddq2'), 2.0, None),
    (LOOSE_BEARINGS, ('q1', 'dq1', 'q2', 'dq2', 'R1.fx', 'R2.mz'), 2.4, ('slip', 2)),
    (LOOSE_BARS, ('q1', 'dq1', 'q4', 'dq4'), 1.5, ('slip', 1))])
def test_frictions(checks, mech9d, tmp_path, text, columns, end, found):
    """Frictions by reactions that parameters change: a block that sticks to a belt and slips again; two bearings of which one sticks while
    the other slips; a pair that turns and slides; three bearings of a closed chain, with an impact; a smooth law."""
    output = COLUMNS.replace(' /', ', reactions=.true. /') if any(name[0] == 'R' for name in columns) else COLUMNS
    report = against_differences(checks, mech9d, tmp_path, text, columns, end, 5, output)
    checks.true(found is None or found in kinds(report), 'the event of the case', kinds(report))


def test_exponents_with_friction(checks, mech9d, tmp_path):
    """A block on a belt sticks in each period of its limit cycle: a zero exponent along the cycle, and one of minus infinity."""
    belt = re.sub('&parameter.*\n', '', BELT)
    report = exponents(mech9d, tmp_path, belt, 2, 605.0, 'transient=5')
    # tolerance: lengths change by less than a factor of e^3 within a period
    checks.near(report['exponents'][0], 0, 3 / 600, 'along the cycle', scale=1)
    checks.equal(report['exponents'][1], None, 'across it')


def sticking_belt(end, s, d, m, k, v):
    """Place of a block on a belt of the speed v against the frame, and its rate, with the coefficients s at rest and d in motion."""
    w, g = cmath.sqrt(k / m), 9.81
    centre, x, u, t = d * m * g / k, 0.1, -0.8 + v, 0
    while True:
        # the block slips backwards on the belt until it has its speed
        def rate(h, x=x, u=u):
            return -(x - centre) * w * cmath.sin(w * h) + u * cmath.cos(w * h) - v

        ahead = next(i for i in range(3, 100000) if rate(i * 1e-4).real >= 0) * 1e-4
        for _ in range(60):
            ahead -= rate(ahead) / (-(x - centre) * w**2 * cmath.cos(w * ahead) - u * w * cmath.sin(w * ahead))
        h = min(ahead, end - t, key=lambda value: complex(value).real)
        place = centre + (x - centre) * cmath.cos(w * h) + u / w * cmath.sin(w * h)
        if complex(end - t).real <= ahead.real:
            return place, rate(h) + v
        t, rest = t + ahead, (s * m * g / k - place) / v
        if complex(end - t).real <= rest.real:
            return place + v * (end - t), v
        x, u, t = s * m * g / k, v, t + rest


@pytest.mark.parametrize('end', [0.3, 0.8, 1.9, 3.4])
def test_a_block_that_breaks_loose(checks, mech9d, tmp_path, end):
    """A coefficient at rest above that of sliding: while it slips and sticks for the first time, and after it broke loose."""
    text = BELT.replace('dynamic=0.3', 'dynamic=0.3, static=0.45') + "&parameter name='s', sets='friction(1).static' /\n" \
        "&parameter name='v', sets='drive(1).coefficients(2)' /\n"
    table, _, _ = go(mech9d, tmp_path, text + COLUMNS + TIGHT, end=end)
    at = {'s': 0.45, 'd': 0.3, 'm': 1.0, 'k': 10.0, 'v': 0.5}
    names = {'s': 's', 'd': 'mu', 'm': 'm', 'k': 'k', 'v': 'v'}
    place, rate = sticking_belt(end, **at)
    checks.near(table['q2'][-1] + 0.5 * end, complex(place).real, 1e-10, 'place', scale=1)
    checks.near(table['dq2'][-1] + 0.5, complex(rate).real, 1e-10, 'rate', scale=1)
    for key, name in names.items():
        moved = sticking_belt(end, **{**at, key: at[key] + 1e-30j})
        for column, value in zip(('q2', 'dq2'), moved):
            slope = complex(value).imag / 1e-30
            # the coordinate counts from the belt
            if key == 'v':
                slope -= end if column == 'q2' else 1
            # tolerance: the rate at which the bound is met, by differences
            checks.near(table[f'd({column})/d({name})'][-1], slope, 2e-9, f'{column} by {name}', scale=max(1.0, abs(slope)))


def exponents(program, folder, text, count, end, settings):
    go(program, folder, text + f'&exponents {settings} /\n', '--exponents', str(count), end=end)
    return json.loads((folder / 'event.json').read_text())


def test_exponents_through_impacts(checks, mech9d, tmp_path):
    """One impact in each period of the force multiplies areas by e^2 exp(-0.2 T)."""
    _, report, _ = go(mech9d, tmp_path, OSCILLATOR + TIGHT, end=2000.0)
    times = np.array([event['time'] for event in report['events']])
    period = 2 * np.pi / 2.5
    checks.near(np.diff(times[-50:]), period, 1e-8, 'one impact in each period')
    report = exponents(mech9d, tmp_path, OSCILLATOR + TIGHT, 2, 500 + 600 * period, 'transient=500')
    # tolerance: the sum is exact over whole periods
    checks.near(sum(report['exponents']), -0.2 + 2 * log(0.8) / period, 1e-9, 'the sum', scale=1)
    checks.near(report['divergence'], -0.2 + 2 * log(0.8) / period, 1e-9, 'the mean divergence', scale=1)
    checks.near(report['exponents'], [-0.1 + log(0.8) / period] * 2, 2e-3, 'both are equal: the multipliers are complex', scale=1)


def test_lost_directions(checks, mech9d, tmp_path):
    """Neighbouring motions become the same where a stop holds a coordinate: exponents of minus infinity; those of another freedom stay."""
    plain = '\n'.join(line for line in BOUNCING.splitlines() if 'parameter' not in line) + '\n'
    report = exponents(mech9d, tmp_path, plain, 2, 12.0, 'transient=1')
    checks.equal(report['exponents'] + report['exponents_error'] + report['exponents_change'], [None] * 6, 'both are lost')
    checks.true('divergence' not in report, 'no divergence is known', report.keys())
    pushed = plain.replace('restitution=0.9', 'restitution=0') + "&load kind='coordinate', coordinate=1, stiffness=4, damping=5 /\n"
    report = exponents(mech9d, tmp_path, pushed, 2, 12.0, 'transient=0.1')
    checks.equal(report['exponents'], [None] * 2, 'also where round-off is left of a direction')
    beside = plain.replace('cq=1', 'cq=1,2') + """&pair coordinate=2, links=1,3, kind='prismatic', axis=1,0,0 /
&body link=3, mass=1 /
&load kind='coordinate', coordinate=2, stiffness=4, damping=0.3 /
&initial coordinate=2, position=0.1 /
"""
    report = exponents(mech9d, tmp_path, beside, 4, 400.0, 'transient=10')
    checks.near(report['exponents'][:2], [-0.15, -0.15], 1 / 390, 'an oscillator beside it', scale=1)
    checks.equal(report['exponents'][2:], [None] * 2, 'the others are lost')


@pytest.mark.parametrize('change, words', [
    (('&parameter', "&pair coordinate=2, links=1,3, kind='prismatic', axis=0,0,1 /\n&body link=3, mass=1 /\n&stop coordinate=2, low=0 /\n"
      '&initial coordinate=2, position=1 /\n&parameter'), 'stop 1 is hit together with another stop or contact'),
    (('position=1 ', 'position=0 '), 'the motion begins on stop 1, and parameters move it away or behind')])
def test_refusals(checks, mech9d, tmp_path, change, words):
    """Two impacts at once, a start on a stop."""
    text = BOUNCING.replace(*change, 1)
    if 'coordinate=2' in text:
        text = text.replace('cq=1', 'cq=1,2')
    _, _, told = go(mech9d, tmp_path, text + COLUMNS, code=6)
    checks.true(words in told, words, told)


def test_quantities_at_one_time(checks, mech9d, tmp_path):
    """Quantities at the end have the derivatives of their columns."""
    text = BOUNCING + "&quantity name='end', of='q1', take='end' /\n&output gradients=.true. /\n" + TIGHT
    _, report, _ = go(mech9d, tmp_path, text)
    found = {one['parameter']: one['value'] for one in report['quantities'][0]['gradient']}
    checks.near(found['h'], bounce(1.0, 1.0, 0.9, 9.81)[1]['h'][0], 1e-10, 'by the height', scale=1)


@pytest.mark.parametrize('intervals', [1, 30])
def test_quantities_through_impacts(checks, mech9d, tmp_path, intervals):
    """Extremes of rates are at the first impact: -sqrt(2 g h) before it, e sqrt(2 g h) behind; energies are lost there; the integral of the
    acceleration has no impulse, and does not change with the time of an impact."""
    h, e, g, end = 1.0, 0.9, 9.81, 2.0
    v = sqrt(2 * g * h)
    kept = e**6 * 2 * g * h
    wanted = {'dq1 max': (e * v, {'h': e * g / v, 'e': v, 'g': -e * h / v, 'low': -e * g / v, 'm': 0}),
              'dq1 min': (-v, {'h': -g / v, 'e': 0, 'g': h / v, 'low': g / v, 'm': 0}),
              'P.vz range': ((1 + e) * v, {'h': (1 + e) * g / v, 'e': v, 'g': -(1 + e) * h / v, 'low': -(1 + e) * g / v, 'm': 0}),
              'E.kinetic max': (2 * g * h, {'h': 2 * g, 'e': 0, 'g': -2 * h, 'low': -2 * g, 'm': g * h}),
              'E.total min': (kept, {'h': e**6 * 2 * g, 'e': 6 * kept / e, 'g': -kept / g, 'low': 2 * g * (1 - e**6), 'm': kept / 2}),
              'ddq1 integral': (-g * end, {'h': 0, 'e': 0, 'g': end, 'low': 0, 'm': 0}),
              'ddq1 rms': (g, {'h': 0, 'e': 0, 'g': -1, 'low': 0, 'm': 0})}
    asked = ''.join(f"&quantity name='n{i}', of='{name.split()[0]}', take='{name.split()[1]}' /\n" for i, name in enumerate(wanted))
    text = BOUNCING + "&point name='P', link=2 /\n" + asked + '&output gradients=.true., energies=.true. /\n' + TIGHT
    _, report, _ = go(mech9d, tmp_path, text, end=end, intervals=intervals)
    for found, (name, (value, slopes)) in zip(report['quantities'], wanted.items()):
        # tolerance: energies err by 1e-12 in each of some hundred steps, accelerations by round-off over the square of an interval
        checks.near(found['value'], value, 1e-8 if 'ddq' in name else 1e-10, name, scale=max(1.0, abs(value)))
        for one in found['gradient']:
            slope = slopes[one['parameter']]
            checks.near(one['value'], slope, 1e-8, f"{name} by {one['parameter']}", scale=max(1.0, abs(slope)))


@pytest.mark.parametrize('text, takes, end', [
    (OSCILLATOR + "&parameter name='e', sets='stop(1).restitution' /\n&parameter name='k', sets='load(1).stiffness' /\n",
     ['dq1 max', 'dq1 rms', 'ddq1 rms', 'ddq1 max', 'E.total mean'], 6.0),
    (FOUR_BAR, ['dq4 max', 'dq1 rms', 'ddq2 max', 'E.total range'], 1.5)], ids=['oscillator', 'four-bar'])
def test_gradients_through_impacts(checks, mech9d, tmp_path, text, takes, end):
    """Extremes and means between impacts, and in a closed chain, with hardly any outputs."""
    quantities_against_differences(checks, mech9d, tmp_path, text, takes, end, 7)
