"""Stops against closed forms, and one mechanism described in several ways: rigid stops with restitution on independent and dependent
coordinates, endless impacts, contacts that close and open, several at once, beside drives; rest; compliant stops; bad ends.

Compares the program with itself: one four-bar by three independent coordinates; few and many outputs; rigid and stiff stops."""
import json
import re
from math import asin, cos, pi, sin, sqrt, tan

import numpy as np
import pytest

from mech9_cases import read_table, run

G = 9.81
SLIDER = """&mechanism title='a slider that falls' /
&structure cq=1 /
&pair coordinate=1, links=1,2, kind='prismatic', axis=0,0,1 /
&body link=2, mass=2 /
&gravity acceleration=0,0,-9.81 /
&initial coordinate=1, position=1 /
"""
FOUR_BAR = """&mechanism title='four-bar with a heavy crank' /
&pair coordinate=1, links=1,2, kind='revolute', axis=0,0,1, point=0.0, 0.0,0 /
&pair coordinate=2, links=2,3, kind='revolute', axis=0,0,1, point=0.0,-1.0,0 /
&pair coordinate=3, links=3,4, kind='revolute', axis=0,0,1, point=1.5,-3.0,0 /
&pair coordinate=4, links=1,4, kind='revolute', axis=0,0,1, point=2.7,-1.4,0 /
&body link=2, mass=20, centre=0.0,-1.0,0, inertia=0.5,0.5,0.5,0,0,0 /
&body link=3, mass=1, centre=0.75,-2.0,0, inertia=0.3,0.3,0.6,0,0,0 /
&body link=4, mass=1, centre=2.1,-2.2,0, inertia=0.2,0.2,0.4,0,0,0 /
&gravity acceleration=0,-9.81,0 /
"""
TIGHT = "&solver relative_tolerance=1e-11, absolute_tolerance=1e-11 /\n"


def go(program, folder, text, end, intervals=20, code=0):
    """Table, events and standard error of a run that ends with a code."""
    path, table, report = folder / 'stop.nml', folder / 'stop.dat', folder / 'stop.json'
    path.write_text(f'{text}&time end={end!r}, intervals={intervals} /\n', encoding='utf-8')
    done = run(program, path, '--table', table, '--report', report)
    assert done.returncode == code, done.stderr
    columns = read_table(table.read_text()) if table.exists() and code != 3 else None
    return columns, json.loads(report.read_text()).get('events', []), done.stderr


def times(events, kind):
    return np.array([event['time'] for event in events if event['kind'] == kind])


def test_a_slider_bounces_to_rest(checks, mech9d, tmp_path):
    """h = 1 m, e = 0.9: the impacts end at t1 (1 + e)/(1 - e)."""
    e, first = 0.9, sqrt(2 / G)
    table, events, _ = go(mech9d, tmp_path, SLIDER + "&stop coordinate=1, low=0, restitution=0.9 /\n", 10.0)
    hits = times(events, 'impact')
    n = np.arange(len(hits))
    checks.true(len(hits) > 100, 'it bounces more than a hundred times', len(hits))
    # tolerance: landings are exact to some 1e-13 m, which moves the time by that over the rate
    checks.near(hits, first + 2 * first * e * (1 - e**n) / (1 - e), 1e-10, 'times of the impacts', scale=10)
    checks.near([event['impulse'] for event in events if event['kind'] == 'impact'][:40], 2 * 1.9 * G * first * e**n[:40], 1e-8,
                'impulses are m (1 + e) u')
    checks.near(times(events, 'close'), [8.578949178728887], 1e-10, 'the impacts end', scale=10)
    checks.near(table['q1'][2], 0.7109491443330383, 1e-12, 'height after 1 s')
    checks.near(table['S1'][table['t'] > 8.6], 2 * G, 1e-12, 'the slider rests by its weight')
    checks.equal(np.max(np.abs(table['q1'][table['t'] > 8.6])), 0.0, 'on the stop')
    checks.equal(table['S1'][table['t'] < 8.5].tolist(), [0.0] * 17, 'there is no force in flight')


@pytest.mark.parametrize(('e', 'intervals'), [(0.9, 10), (0.99, 1), (0.99, 7)])
def test_every_impact_is_that_of_a_parabola(checks, mech9d, tmp_path, e, intervals):
    """Each impulse is e times the one before, wherever an impact lies between steps and outputs."""
    _, events, _ = go(mech9d, tmp_path, SLIDER + f"&stop coordinate=1, low=0, restitution={e} /\n", 100.0, intervals)
    impulses = np.array([event['impulse'] for event in events if event['kind'] == 'impact'])
    # tolerance: the round-off of times of 90 s, in parts of flights of 1 ms and more
    impulses = impulses[impulses > 0.01]
    checks.near(impulses[1:]/impulses[:-1], np.full(len(impulses) - 1, e), 1e-9, 'ratios')
    first = sqrt(2/G)
    checks.near(times(events, 'close'), [first*(1 + e)/(1 - e)], 1e-10, 'they end', scale=90)


@pytest.mark.parametrize(('frequency', 'excess'), [(1.0, 1.0001), (50.0, 1.001), (50.0, 1.01), (3.0, 1.1)])
def test_a_force_that_swings_opens_a_stop(checks, mech9d, tmp_path, frequency, excess):
    """A force that exceeds the weight for a small part of each of twenty periods opens the stop each time, in one output."""
    text = SLIDER.replace('position=1', 'position=0') + TIGHT + f"""&stop coordinate=1, low=0 /
&load kind='force', link=2, force=0,0,{excess*2*G!r}, law='harmonic', amplitude=1, angular_frequency={frequency!r} /
"""
    _, events, _ = go(mech9d, tmp_path, text, 40*pi/frequency, 1)
    expected = (asin(1/excess) + 2*pi*np.arange(20))/frequency
    # tolerance: near its top the force changes by round-off within 1e-8 of a period
    checks.near(times(events, 'open'), expected, 1e-9, 'times', scale=40*pi/frequency)


@pytest.mark.parametrize(('amplitude', 'frequency', 'intervals'), [(0.5, 10.0, 1), (0.5, 200.0, 7), (1e-3, 20.0, 1), (1e-5, 20.0, 3)])
def test_a_drive_that_swings_passes_a_stop(checks, mech9k, mech9d, tmp_path, amplitude, frequency, intervals):
    """The first passing is told however few outputs there are, and however small the drive is beside the mechanism."""
    text = f"""&mechanism title='a drive that swings' /
&structure cq=1 /
&pair coordinate=1, links=1,2, kind='prismatic', axis=1,0,0 /
&point name='P', link=2, position=1,0,0 /
&drive coordinate=1, kind='harmonic', amplitude={amplitude!r}, angular_frequency={frequency!r} /
&stop coordinate=1, high={0.999*amplitude!r} /
"""
    for program in (mech9k, mech9d):
        _, _, told = go(program, tmp_path, text, 3.0, intervals, code=6)
        time = float(re.search(r'stop 1 at .* m at t = (\S+) s: at', told)[1])
        checks.near(time, asin(0.999)/frequency, 1e-9, 'first passing', scale=1)


@pytest.mark.parametrize(('intervals', 'part'), [(1000, 0.99999), (1000, 0.6), (30000, 0.9999999)])
def test_a_drive_that_swings_passes_a_stop_between_dense_outputs(checks, mech9k, tmp_path, intervals, part):
    """An end at a part of the amplitude is passed at the first top, though no output lies behind it, and an end on the other side is clear until
    then; the rows before are kept. The motion is slow at first, where thousands of positions are far from both ends."""
    rate, first = 10.0, 0.5*pi
    text = f"""&mechanism title='a drive that swings' /
&structure cq=1 /
&pair coordinate=1, links=1,2, kind='prismatic', axis=1,0,0 /
&point name='P', link=2, position=1,0,0 /
&drive coordinate=1, kind='harmonic', amplitude=0.5, angular_frequency={rate!r}, phase={-first!r} /
&stop coordinate=1, low={-0.5 - 1e-3!r}, high={0.5*part!r} /
"""
    table, _, told = go(mech9k, tmp_path, text, 3.0, intervals, code=6)
    passed = (first + asin(part))/rate
    # tolerance: near the top a round-off of the coordinate moves the time by the square root of it
    checks.near(float(re.search(r'stop 1 at .* m at t = (\S+) s: at', told)[1]), passed, 1e-9, 'first passing')
    checks.equal(len(table['t']), 1 + int(passed/3.0*intervals), 'all rows before, and none behind')


def test_outputs_do_not_matter(checks, mech9d, tmp_path):
    """The same events, bit by bit, with 1 and with 1000 outputs."""
    stop = SLIDER + "&stop coordinate=1, low=0, restitution=0.8 /\n"
    few, many = (go(mech9d, tmp_path, stop, 6.0, n)[1] for n in (1, 1000))
    checks.true(len(few) > 40 and few == many, 'events do not depend on the outputs')


@pytest.mark.parametrize('e', [0.0, 0.5, 1.0])
def test_a_slider_between_two_ends(checks, mech9d, tmp_path, e):
    """Without gravity a slider runs between two ends; e = 1 keeps its energy."""
    text = SLIDER.replace('-9.81', '0').replace('position=1', 'position=0.25, velocity=2')
    table, events, _ = go(mech9d, tmp_path, text + f"&stop coordinate=1, low=0, high=1, restitution={e} /\n", 3.0, 30)
    if e == 0.0:
        checks.near(times(events, 'impact'), [0.375], 1e-13, 'it comes to the high end')
        checks.near(table['q1'][4:], 1.0, 0.0, 'and stays there')
        return
    rates, at, expected = 2.0, 0.375, []
    while at < 3.0:
        expected.append(at)
        rates *= e
        at += 1 / rates
    checks.near(times(events, 'impact'), expected, 1e-12, f'times of the impacts, e = {e}')
    signs = [np.sign(event['impulse']) for event in events]
    checks.equal(signs, [(-1.0)**(i + 1) for i in range(len(signs))], 'the high end pushes back, the low one forth')
    checks.equal([event['number'] for event in events], [1] * len(events), 'of the one stop')
    if e == 1.0:
        # tolerance: outputs within steps are as exact as the absolute tolerance, 1e-10
        checks.near(table['E.total'], 4.0, 1e-9, 'no energy is lost')


def test_a_contact_opens(checks, mech9d, tmp_path):
    """A slider on a stop under its weight and a growing force F t upward leaves it where F t = m g, with free flight behind."""
    text = SLIDER.replace('position=1', 'position=0') + """&stop coordinate=1, low=0 /
&load kind='force', link=2, position=0,0,0, force=0,0,10, law='polynomial', coefficients=0,1 /
"""
    table, events, _ = go(mech9d, tmp_path, text + TIGHT, 3.0, 30)
    leaves = 2 * G / 10
    checks.equal([event['kind'] for event in events], ['close', 'open'], 'it touches at the start, and leaves')
    checks.near(times(events, 'open'), leaves, 1e-11, 'where the force lifts the weight')
    t = table['t']
    checks.near(table['S1'], np.maximum(0.0, 2 * G - 10 * t), 1e-11, 'the stop bears the rest of the weight', scale=20)
    checks.near(table['q1'], np.where(t > leaves, 10 / 12 * (t - leaves)**3, 0.0), 1e-10, 'the flight is the third power of time')


def test_descriptions_agree(checks, mech9d, tmp_path):
    """A stop on the crank of a four-bar, described by the crank, by the rocker, and by the rocker with other coordinates on the way; a stop
    on the rocker, and one on the coupler."""
    starts = {1: "&structure cq=1 /\n&initial coordinate=1, position=-1.3 /\n&initial coordinate=4, position=-0.55 /\n"}
    base, _, _ = go(mech9d, tmp_path, FOUR_BAR + starts[1] + TIGHT, 0.05, 1)
    starts[4] = (f"&structure cq=4 /\n&initial coordinate=1, position=-1.3 /\n&initial coordinate=4, position={base['q4'][0]!r}, "
                 "velocity=0 /\n")
    starts[2] = (f"&structure cq=2 /\n&initial coordinate=1, position=-1.3 /\n&initial coordinate=2, position={base['q2'][0]!r}, "
                 "velocity=0 /\n&initial coordinate=4, position=-0.55 /\n")
    for stop in ("coordinate=1, high=0.5, restitution=0.5", "coordinate=4, high=-0.3, restitution=0.7", "coordinate=1, high=0.4, restitution=0.1",
                 "coordinate=2, low=-0.4, restitution=0.3", "coordinate=3, low=-0.9, high=-0.1, restitution=0.9"):
        results = {}
        for cq, start in starts.items():
            results[cq] = go(mech9d, tmp_path, FOUR_BAR + start + TIGHT + f"&stop {stop} /\n", 3.0, 30)
        table, events, _ = results[1]
        checks.true(len(events) > 0, f'{stop}: there are events')
        for cq in (2, 4):
            other, theirs, _ = results[cq]
            checks.equal([(a['kind'], a['number']) for a in theirs], [(a['kind'], a['number']) for a in events], f'{stop}, cq={cq}: events')
            # tolerance: that of the integration, 1e-11 a step, grows by some hundred steps and by the impacts
            checks.near([a['time'] for a in theirs], [a['time'] for a in events], 1e-8, f'{stop}, cq={cq}: times')
            checks.near([a['impulse'] or 0.0 for a in theirs], [a['impulse'] or 0.0 for a in events], 1e-7, f'{stop}, cq={cq}: impulses')
            for name in ('q1', 'q2', 'q3', 'q4', 'dq1', 'dq4', 'S1'):
                checks.near(other[name], table[name], 1e-6, f'{stop}, cq={cq}: {name}', scale=100 if name == 'S1' else 1)


def test_energy_and_impulse_of_a_four_bar(checks, mech9d, tmp_path):
    """Perfect impacts keep the energy; an impact takes (1 - e^2) of the energy that its impulse meets."""
    start = "&structure cq=1 /\n&initial coordinate=1, position=-1.3 /\n&initial coordinate=4, position=-0.55 /\n"
    table, events, _ = go(mech9d, tmp_path, FOUR_BAR + start + TIGHT + "&stop coordinate=4, high=-0.3, restitution=1 /\n", 5.0, 50)
    checks.true(len(events) >= 2, 'the rocker hits its stop', events)
    checks.near(table['E.total'], table['E.total'][0], 1e-9, 'no energy is lost', scale=100)
    table, events, _ = go(mech9d, tmp_path, FOUR_BAR + start + TIGHT + "&stop coordinate=4, high=-0.3, restitution=0.5 /\n", 2.0, 2000)
    first = events[0]
    before = np.searchsorted(table['t'], first['time']) - 1
    lost = table['E.total'][before] - table['E.total'][before + 1]
    # the impulse P changes the rate from u to -e u: it takes P (u - e u)/2
    u = table['dq4'][before] + table['ddq4'][before] * (first['time'] - table['t'][before])
    checks.near(lost, abs(first['impulse']) * abs(u) * (1 - 0.5) / 2, 1e-4, 'energy of the first impact')


def test_two_stops_close_together(checks, mech9d, tmp_path):
    """Two sliders of a cross fall onto their stops at once, and each rests by its part of the weight."""
    text = """&structure cq=1,2 /
&pair coordinate=1, links=1,2, kind='prismatic', axis=0,0,1 /
&pair coordinate=2, links=2,3, kind='prismatic', axis=0,0,1 /
&body link=2, mass=2 /
&body link=3, mass=3 /
&gravity acceleration=0,0,-9.81 /
&initial coordinate=1, position=1 /
&initial coordinate=2, position=0 /
&stop coordinate=1, low=0, restitution=0.5 /
&stop coordinate=2, low=0 /
"""
    table, events, _ = go(mech9d, tmp_path, text, 3.0, 30)
    first = sqrt(2 / G)
    checks.near(times(events, 'impact')[0], first, 1e-12, 'they fall together')
    checks.near(table['S2'][-1], 3 * G, 1e-12, 'the upper one presses by its weight')
    checks.near(table['S1'][-1], 5 * G, 1e-12, 'the lower one bears both')
    checks.near([table['q1'][-1], table['q2'][-1]], 0.0, 1e-15, 'both rest')
    closes = [event['time'] for event in events if event['kind'] == 'close' and event['number'] == 1]
    checks.near(closes[-1], first * 3, 1e-8, 'the impacts end at t1 (1 + e)/(1 - e)')


def test_a_redundant_stop(checks, mech9d, tmp_path):
    """Two stops hold the same freedom at the same time: one of them bears the force, and nothing is lost."""
    start = "&structure cq=1 /\n&initial coordinate=1, position=-1.3 /\n&initial coordinate=4, position=-0.55 /\n"
    table, _, _ = go(mech9d, tmp_path, FOUR_BAR + start + TIGHT + "&stop coordinate=1, high=-0.5 /\n", 2.0, 20)
    rest = f"&stop coordinate=1, high=-0.5 /\n&stop coordinate=4, high={table['q4'][-1]!r} /\n"
    both, events, _ = go(mech9d, tmp_path, FOUR_BAR + start + TIGHT + rest, 2.0, 20)
    checks.near(both['q4'], table['q4'], 1e-9, 'the motion is the same')
    checks.true(abs(both['S1'][-1]) + abs(both['S2'][-1]) > 1.0, 'a stop bears the force', (both['S1'][-1], both['S2'][-1]))
    checks.true(len(events) < 20, 'it comes to rest', len(events))


def test_a_stop_on_a_screw_and_a_driven_carriage(checks, mech9d, tmp_path):
    """A driven carriage carries a slider against its stop: the stop pushes by m a while the carriage speeds up."""
    text = """&structure cq=1,2 /
&pair coordinate=1, links=1,2, kind='prismatic', axis=1,0,0 /
&pair coordinate=2, links=2,3, kind='prismatic', axis=1,0,0 /
&body link=2, mass=1 /
&body link=3, mass=2 /
&drive coordinate=1, kind='polynomial', coefficients=0,0,1.5 /
&initial coordinate=2, position=0.24 /
&stop coordinate=2, low=0, restitution=0.2 /
"""
    table, events, _ = go(mech9d, tmp_path, text, 2.0, 20)
    first = sqrt(2 * 0.24 / 3)
    checks.near(times(events, 'impact')[0], first, 1e-12, 'the slider stays behind until its stop')
    checks.near(times(events, 'close'), first * 1.2 / 0.8, 1e-8, 'and then rests against it')
    checks.near(table['S1'][-5:], 6.0, 1e-12, 'by mass and acceleration')


def test_a_drive_forces_a_stop(checks, mech9d, mech9k, tmp_path):
    """A drive through a stop ends the run with code 6, and tells when, and by how much or how fast."""
    text = SLIDER.replace("&initial coordinate=1, position=1 /\n", "") + """&drive coordinate=1, kind='polynomial', coefficients=1,-1 /
&stop coordinate=1, low=0.5 /
"""
    for program in (mech9k, mech9d):
        table, _, told = go(program, tmp_path, text, 1.0, code=6)
        checks.true('passes the end of stop 1 at 0.5 m at t = 0.5 s: at t = 0.55 s it would be 0.45 m, 0.05 m beyond' in told,
                    'all is driven', told)
        checks.near(table['t'][-1], 0.5, 0.06, 'rows before are kept')
    between = text.replace('coefficients=1,-1', 'coefficients=0.54,-0.2,1')     # least 0.53 at 0.1 s, between two outputs
    go(mech9k, tmp_path, between.replace('low=0.5', 'low=0.5299'), 1.0, 1)
    _, _, told = go(mech9k, tmp_path, between.replace('low=0.5', 'low=0.5301'), 1.0, 1, code=6)
    checks.true('passes the end of stop 1' in told and 't = 0.09' in told, 'it turns back between two outputs', told)
    two = between.replace('coefficients=0.54,-0.2,1', 'coefficients=0.54,-0.2,2').replace('low=0.5', 'high=0.6') + \
        "&stop coordinate=1, low=0.537 /\n"      # below 0.537 m from 0.0184 s on, and above 0.6 m from 0.2303 s on
    _, _, told = go(mech9k, tmp_path, two, 1.0, 1, code=6)
    checks.true('passes the end of stop 2' in told and 't = 0.018377' in told, 'of two ends the first in time is told', told)
    beside = """&structure cq=1,2 /
&pair coordinate=1, links=1,2, kind='prismatic', axis=1,0,0 /
&pair coordinate=2, links=2,3, kind='prismatic', axis=0,1,0 /
&body link=2, mass=1 /
&body link=3, mass=2 /
&drive coordinate=1, kind='polynomial', coefficients=1,-1 /
&initial coordinate=2, position=0, velocity=1 /
&stop coordinate=1, low=0.5 /
"""
    # also where the drive moves no mass, so that the motion of the others does not depend on it
    idle = beside.replace('&body link=2, mass=1 /\n', '').replace('links=2,3', 'links=1,3')
    for text in (idle, idle + '&gravity acceleration=0,-9.81,0 /\n', beside):
        table, _, told = go(mech9d, tmp_path, text, 1.0, code=6)
        checks.true('beyond the end of stop 1 at 0.5 m from t = 0.5 s on, with the rate -1 m/s' in told, 'others are free', told)
        # round-off decides whether the row at t = 0.5 is one of those before
        checks.near(table['t'][-1], 0.475, 0.026/0.475, 'rows before are kept')


@pytest.mark.parametrize('intervals', [1, 70, 7000])
def test_quantities_through_an_impact(checks, mech9d, tmp_path, intervals):
    """A ball falls and rebounds once: quantities are those of the motion, wherever outputs stand; accelerations have no impulse."""
    e, end, first, v = 0.8, 0.7, sqrt(2 / G), sqrt(2 * G)
    after, up = 0.7 - sqrt(2 / G), 0.8 * sqrt(2 * G)
    way = up * after - G * after**2 / 2
    square = (G**2 * first**3 / 3 + (up**3 - (up - G * after)**3) / (3 * G)) / end
    wanted = {'dq1 max': up, 'dq1 min': -v, 'P.vz max': up, 'E.kinetic max': 2 * G, 'E.kinetic mean': square, 'q1 min': 0,
              'dq1 mean': (way - 1) / end, 'dq1 rms': sqrt(square),
              'q1 mean': (first - G * first**3 / 6 + up * after**2 / 2 - G * after**3 / 6) / end,
              'E.total range': 2 * G * (1 - e**2), 'ddq1 rms': G, 'ddq1 max': -G, 'ddq1 integral': -G * end}
    text = SLIDER.replace('position=1', 'position=1, velocity=0') + TIGHT + f'&stop coordinate=1, low=0, restitution={e} /\n' + \
        "&point name='P', link=2 /\n" + ''.join(f"&quantity name='n{i}', of='{name.split()[0]}', take='{name.split()[1]}' /\n"
                                              for i, name in enumerate(wanted))
    path, report = tmp_path / 'ball.nml', tmp_path / 'ball.json'
    path.write_text(text + f'&time end={end}, intervals={intervals} /\n', encoding='utf-8')
    done = run(mech9d, path, '--no-write', '--report', report)
    assert done.returncode == 0, done.stderr
    for number, (name, value) in zip(json.loads(report.read_text())['quantities'], wanted.items()):
        # tolerance: that of the integration; accelerations are second derivatives of polynomials, or the ends of short intervals
        checks.near(number['value'], value, 1e-6 if name == 'ddq1 max' else 1e-9, name, scale=max(1.0, abs(value)))


def test_compliant_stops(checks, mech9d, tmp_path):
    """A slider swings on a compliant stop: half a period of pi sqrt(m/k) in contact, without gravity."""
    k = 200.0
    text = SLIDER.replace('-9.81', '0').replace('position=1', 'position=0.1, velocity=-1')
    table, events, _ = go(mech9d, tmp_path, text + TIGHT + f"&stop coordinate=1, low=0, stiffness={k} /\n", 1.0, 100)
    checks.equal([event['kind'] for event in events], ['close', 'open'], 'it is met and left')
    checks.near(times(events, 'close'), 0.1, 1e-11, 'where the gap ends')
    checks.near(times(events, 'open'), 0.1 + pi * sqrt(2 / k), 1e-9, 'after half a period')
    checks.near(table['E.total'], 1.0, 1e-9, 'it stores the energy')
    checks.near(table['dq1'][-1], 1.0, 1e-9, 'it goes back as fast as it came')
    checks.near(table['S1'], np.maximum(0.0, -k * table['q1']), 1e-12, 'its force is stiffness times penetration', scale=k)
    damped, events, _ = go(mech9d, tmp_path, text + TIGHT + f"&stop coordinate=1, low=0, stiffness={k}, damping=40, exponent=1.5 /\n",
                           2.0, 200)
    depth = np.maximum(0.0, -damped['q1'])
    checks.near(damped['S1'], np.maximum(0.0, depth**1.5 * (k - 40 * damped['dq1'])), 1e-12, 'Hunt and Crossley', scale=k)
    checks.true(damped['dq1'][-1] < 0.95, 'damping takes energy', damped['dq1'][-1])
    # restitution of Hunt and Crossley does not depend on the mass: a c u (1 + e) = ln((1 + a e u)/(1 - a u))... to first order 1 - 2 a u/3
    a = 40 / k
    soft, _, _ = go(mech9d, tmp_path, text.replace('velocity=-1', 'velocity=-0.01') + TIGHT +
                    f"&stop coordinate=1, low=0, stiffness={k}, damping=40, exponent=1.5 /\n", 60.0, 20)
    checks.near(soft['dq1'][-1] / 0.01, 1 - 2 / 3 * a * 0.01, 1e-5, 'restitution at a small rate')


def test_a_rigid_stop_is_the_limit_of_stiff_ones(checks, mech9d, tmp_path):
    start = "&structure cq=1 /\n&initial coordinate=1, position=-1.3 /\n&initial coordinate=4, position=-0.55 /\n"
    rigid, _, _ = go(mech9d, tmp_path, FOUR_BAR + start + "&stop coordinate=4, high=-0.3, restitution=1 /\n", 1.5, 15)
    errors = []
    for stiffness in (1e7, 1e9):
        soft, _, _ = go(mech9d, tmp_path, FOUR_BAR + start + f"&stop coordinate=4, high=-0.3, stiffness={stiffness} /\n", 1.5, 15)
        errors.append(np.max(np.abs(soft['q1'] - rigid['q1'])))
    # contact lasts pi sqrt(m/k): ten times shorter with a stiffness a hundred times greater
    checks.true(errors[0] < 0.1 and 0.07 < errors[1] / errors[0] < 0.14, 'the error goes with the root of the stiffness', errors)


def test_angles_in_degrees(checks, mech9d, tmp_path):
    """The same pendulum in degrees and radians."""
    text = """&mechanism angle_unit='{unit}' /
&structure cq=1 /
&pair coordinate=1, links=1,2, kind='revolute', axis=0,0,1 /
&body link=2, mass=1, centre=0,-1,0 /
&gravity acceleration=0,-9.81,0 /
&initial coordinate=1, position={start!r} /
&stop coordinate=1, low={low!r}, restitution=0.6 /
"""
    rad, events, _ = go(mech9d, tmp_path, text.format(unit='rad', start=1.0, low=-0.25), 5.0, 50)
    deg, theirs, _ = go(mech9d, tmp_path, text.format(unit='deg', start=180 / pi, low=-0.25 * 180 / pi), 5.0, 50)
    checks.near(times(theirs, 'impact'), times(events, 'impact'), 1e-9, 'times')
    checks.near([e['impulse'] for e in theirs], [e['impulse'] for e in events], 1e-8, 'impulses are per radian in both')
    checks.near(deg['q1'] * pi / 180, rad['q1'], 1e-8, 'angles')
    u = sqrt(2 * G * (cos(0.25) - cos(1.0)))
    checks.near(events[0]['impulse'], 1.6 * u, 1e-7, 'of the first impact, by energy')


def test_grazing(checks, mech9d, tmp_path):
    """A pendulum whose turning point lies just before, or just behind a stop, also within one step: no event, or one gentle impact."""
    text = """&structure cq=1 /
&pair coordinate=1, links=1,2, kind='revolute', axis=0,0,1 /
&body link=2, mass=1, centre=0,-1,0 /
&gravity acceleration=0,-9.81,0 /
&initial coordinate=1, position=-0.5 /
"""
    for distance in (1e-3, 1e-5, 1e-7):
        _, events, _ = go(mech9d, tmp_path, text + TIGHT + f"&stop coordinate=1, high={0.5 + distance!r}, restitution=1 /\n", 1.8, 1)
        checks.equal(events, [], f'{distance:.0e} before the stop it turns by itself')
        _, events, _ = go(mech9d, tmp_path, text + TIGHT + f"&stop coordinate=1, high={0.5 - distance!r}, restitution=1 /\n", 1.8, 1)
        u = sqrt(2 * G * (cos(0.5 - distance) - cos(0.5)))
        checks.equal([event['kind'] for event in events], ['impact'], f'{distance:.0e} behind it, it hits')
        if events:
            # tolerance: an error of 1e-10 in the energy against the small rate
            checks.near(events[0]['impulse'], -2 * u, 1e-9 / u, 'as gently as energy says', scale=u)


@pytest.mark.parametrize('stop, words', [
    ("coordinate=1", 'the stop has no end'),
    ("coordinate=1, low=2, high=1", 'the high end is not above the low one'),
    ("coordinate=1, low=0, restitution=1.5", 'a restitution above 1'),
    ("coordinate=1, low=0, restitution=-0.5", 'restitution'),
    ("coordinate=1, low=0, restitution=0.5, stiffness=10", 'is compliant and has no restitution'),
    ("coordinate=1, low=0, damping=1", 'belongs to a compliant stop'),
    ("coordinate=2, low=0", 'there is no coordinate 2'),
    ("coordinate=1, low=1.25", 'starts beyond the end of stop 1: coordinate 1 is 1 m, 0.25 m beyond 1.25 m'),
    ("coordinate=1, low=0 /\n&stop coordinate=1, low=0.1", 'on this side already'),
    ("coordinate=1, high=0.5 /\n&stop coordinate=1, low=0.7", 'no common range'),
    ("coordinate=1, low=0, stiffness=0", 'stiffness'),
    ("coordinate=1, low=nan", 'low'),
    ("coordinate=1, low=0 /\n&time start=1, end=0, intervals=1 /\n&user", 'back in time'),
])
def test_bad_stops(checks, mech9d, tmp_path, stop, words):
    _, _, told = go(mech9d, tmp_path, SLIDER + f"&stop {stop} /\n", 1.0, code=3)
    checks.true(words in told, 'the message names the fault', told)
    checks.true('stop.nml' in told and '&stop' in told, 'and its place', told)


def test_a_chain_of_endless_impacts_makes_progress(checks, mech9d, tmp_path):
    """A ball in a wedge of two perfect stops that a slow drive closes: the events end with a message, or the run ends."""
    text = """&structure cq=1,2 /
&pair coordinate=1, links=1,2, kind='prismatic', axis=1,0,0 /
&pair coordinate=2, links=2,3, kind='prismatic', axis=1,0,0 /
&body link=2, mass=1 /
&body link=3, mass=1 /
&drive coordinate=1, kind='polynomial', coefficients=0 /
&initial coordinate=2, position=0.5, velocity=1 /
&stop coordinate=2, low=0.4999999, high=0.5000001, restitution=1 /
"""
    table, events, told = go(mech9d, tmp_path, text, 1e-3, 2)
    checks.near(len(events), 1e-3 / 2e-7, 2.0, 'five thousand impacts', scale=1.0)
    checks.near(np.abs(table['dq2']), 1.0, 1e-9, 'at the same rate')


def test_derivatives_through_a_compliant_stop(checks, mech9d, tmp_path):
    compliant = SLIDER + """&stop coordinate=1, low=0, stiffness=1e4, damping=10, exponent=1.5 /
&parameter name='h', sets='initial(1).position' /
&output sensitivities=.true. /
"""
    table, events, _ = go(mech9d, tmp_path, compliant + TIGHT, 0.8, 8)
    checks.true(len(events) >= 2, 'a compliant stop is met and left')
    h = 1e-5
    near = [go(mech9d, tmp_path, compliant.replace('sensitivities=.true.', '').replace('position=1 ', f'position={1 + d!r} ') + TIGHT,
               0.8, 8)[0] for d in (-h, h)]
    checks.near(table['d(q1)/d(h)'], (near[1]['q1'] - near[0]['q1']) / (2 * h), 1e-5, 'derivatives through it against differences')


@pytest.mark.parametrize('stop', ["coordinate=4, high=-0.3, restitution=0.7", "coordinate=1, high=0.5, restitution=0.5",
                                  "coordinate=3, low=-0.9, high=-0.1, restitution=0.9"])
def test_impulses_of_pairs(checks, mech9d, tmp_path, stop):
    """Link 1 passes to a four-bar at an impact the change of its momentum, also where a dependent coordinate hits its stop."""
    start = "&structure cq=1 /\n&initial coordinate=1, position=-1.3 /\n&initial coordinate=4, position=-0.55 /\n"
    points = ("&point name='A', link=2, position=0,-1,0 /\n&point name='B', link=3, position=0.75,-2,0 /\n"
              "&point name='C', link=4, position=2.1,-2.2,0 /\n&output reactions=.true. /\n")
    table, events, _ = go(mech9d, tmp_path, FOUR_BAR + start + points + TIGHT + f"&stop {stop} /\n", 1.5, 3000)
    first = events[0]
    pairs = {pair['pair']: pair for pair in first['pairs']}
    checks.equal(sorted(pairs), [1, 2, 3, 4], 'all pairs have impulses')
    after = np.searchsorted(table['t'], first['time'])
    change = np.zeros(3)
    for name, mass in (('A', 20.0), ('B', 1.0), ('C', 1.0)):
        for i, axis in enumerate('xyz'):
            v, a = table[f'{name}.v{axis}'], table[f'{name}.a{axis}']
            back, on = (v[k] + a[k] * (first['time'] - table['t'][k]) for k in (after - 1, after))
            change[i] += mass * (on - back)
    given = np.array(pairs[1]['force']) + np.array(pairs[4]['force'])
    # tolerance: rates are taken to the impact by their slopes over half a millisecond
    checks.near(given, change, 1e-4, 'impulses of link 1', scale=float(np.max(np.abs(change))))
    alone = [k for k in (1, 2, 3, 4) if f'coordinate={k},' not in stop]
    checks.near([pairs[k]['moment'][2] for k in alone], 0.0, 1e-9, 'pairs without a stop turn freely', scale=1.0)
    number = int(stop.split(',')[0][-1])
    checks.near(pairs[number]['moment'][2], first['impulse'], 1e-9, 'the other one passes on the impulse of the stop', scale=1.0)


def test_drives_that_jump(checks, mech9d, tmp_path):
    """A carriage whose rate jumps carries a slider of 2 kg, which touches its stop: the jump is an impact, or lets the slider go."""
    text = """&structure cq=1,2 /
&pair coordinate=1, links=1,2, kind='prismatic', axis=1,0,0 /
&pair coordinate=2, links=2,3, kind='prismatic', axis=1,0,0 /
&body link=2, mass=1 /
&body link=3, mass=2 /
&gravity acceleration={pull!r},0,0 /
&initial coordinate=2, position=0 /
&drive coordinate=1, kind='segments', times=0,1,2, values=0,0,{way!r}, laws='dwell','constant-velocity' /
&stop coordinate=2, low=0, high=0.5, restitution=0.3 /
"""
    for pull in (-0.01, 0.0):
        _, events, _ = go(mech9d, tmp_path, text.format(pull=pull, way=1.0), 1.4)
        hit = [event for event in events if event['kind'] == 'impact']
        checks.near([event['time'] for event in hit], 1.0, 1e-12, f'{pull}: it is hit where the rate jumps, once')
        checks.near([event['impulse'] for event in hit], 2 * 1.3, 1e-12, f'{pull}: impulse is m (1 + e) u')
        table, events, _ = go(mech9d, tmp_path, text.format(pull=pull, way=-1.0), 1.4, 140)
        checks.equal([event for event in events if event['kind'] == 'impact'], [], f'{pull}: the carriage leaves it behind')
        t = table['t'][101:]
        checks.near(table['q2'][101:], (t - 1) + pull * (t - 1)**2 / 2, 1e-9, f'{pull}: the slider keeps its rate')


def test_endless_impacts_of_a_stack(checks, mech9d, tmp_path):
    """Two sliders, one on the other: the impacts of both come to rest, whatever their restitutions are."""
    for low in (0.0, 0.5, 0.8):
        for high in (0.0, 0.1, 0.5, 0.9):
            text = f"""&structure cq=1,2 /
&pair coordinate=1, links=1,2, kind='prismatic', axis=0,0,1 /
&pair coordinate=2, links=2,3, kind='prismatic', axis=0,0,1 /
&body link=2, mass=1 /
&body link=3, mass=1 /
&gravity acceleration=0,0,-10 /
&initial coordinate=1, position=1 /
&initial coordinate=2, position=0.5 /
&stop coordinate=1, low=0, restitution={low} /
&stop coordinate=2, low=0, restitution={high} /
"""
            table, events, _ = go(mech9d, tmp_path, text, 20.0, 20)
            checks.true(len(events) < 2000, f'{low}, {high}: the impacts end', len(events))
            checks.near([table['q1'][-1], table['q2'][-1]], 0.0, 1e-12, f'{low}, {high}: both rest')
            checks.near([table['S1'][-1], table['S2'][-1]], [20.0, 10.0], 1e-9, f'{low}, {high}: by their weights')


def test_a_stop_opens_beside_a_stiff_spring(checks, mech9d, tmp_path):
    """The force of a closed stop passes zero while a spring of 8e5 N/m swings: the stop opens, and the motion goes on."""
    text = """&structure cq=1,2,3 /
&pair coordinate=1, links=1,2, kind='prismatic', axis=0,0,1 /
&pair coordinate=2, links=2,3, kind='prismatic', axis=0,0,1 /
&pair coordinate=3, links=3,4, kind='prismatic', axis=0,0,1 /
&body link=3, mass=1 /
&body link=4, mass=3 /
&gravity acceleration=0,0,-9.81 /
&drive coordinate=1, kind='harmonic', amplitude=0.2, angular_frequency=9 /
&initial coordinate=2, position=0.1 /
&initial coordinate=3, position=0.2 /
&load kind='coordinate', coordinate=3, stiffness=8e5, damping=100 /
&stop coordinate=2, low=0, restitution=0.3 /
"""
    table, events, _ = go(mech9d, tmp_path, text, 1.0, 200)
    checks.true(len(events) < 200, 'it does not chatter', len(events))
    checks.true(np.min(table['q2']) > -1e-9 and np.min(table['S1']) >= -1e-3, 'the stop keeps the slide and does not pull',
                (np.min(table['q2']), np.min(table['S1'])))


def rest(program, folder, text, *options):
    """The table of equilibria, and what the program says."""
    path = folder / 'rest.nml'
    path.write_text(text, encoding='utf-8')
    done = run(program, path, *options)
    assert done.returncode == 0, done.stderr
    return read_table(done.stdout), done.stderr


def test_rest_against_stops(checks, mech9d, tmp_path):
    """Positions of rest lie before stops or against them, where these push; modes are those in contact."""
    pendulums = """&structure cq=1,2 /
&pair coordinate=1, links=1,2, kind='revolute', axis=0,0,1 /
&pair coordinate=2, links=2,3, kind='revolute', axis=0,0,1, point=0,-1,0 /
&body link=2, mass=1, centre=0,-1,0 /
&body link=3, mass=1, centre=0,-2,0, inertia=0.1,0.1,0.1,0,0,0 /
&gravity acceleration=0,-9.81,0 /
&initial coordinate=1, position=0.9 /
&initial coordinate=2, position=0.2 /
&stop coordinate=1, low=0.5 /
"""
    table, told = rest(mech9d, tmp_path, pendulums, '--equilibrium')
    checks.near([table['q1'][0], table['q2'][0]], [0.5, -0.5], 1e-12, 'the lower pendulum hangs, the upper one leans on its stop')
    checks.near(table['S1'][0], 2 * G * sin(0.5), 1e-12, 'by the moment of both weights')
    checks.true('stop 1 bears 9.406' in told, 'the stop is named', told)
    modes, _ = rest(mech9d, tmp_path, pendulums, '--modes')
    checks.near(modes['eigenvalue.im'], [sqrt(G / 1.1)], 1e-9, 'the lower one swings alone')
    both = pendulums + "&stop coordinate=2, low=0 /\n"
    table, _ = rest(mech9d, tmp_path, both, '--equilibrium')
    checks.near([table['q1'][0], table['q2'][0]], [0.5, 0.0], 1e-12, 'two stops hold both')
    checks.near(table['S2'][0], G * sin(0.5), 1e-12, 'the lower one leans, too')
    away = pendulums.replace('low=0.5', 'high=0.5')
    table, _ = rest(mech9d, tmp_path, away, '--equilibrium')
    checks.near([table['q1'][0], table['q2'][0], table['S1'][0]], 0.0, 1e-9, 'a stop that is not reached does not count')
    table, _ = rest(mech9d, tmp_path, pendulums, '--equilibrium', '--starts', '60')
    checks.true(np.all(table['q1'] > 0.5 - 1e-9), 'no position lies behind the stop', table['q1'])
    checks.true(len(table['q1']) == 3 and np.sum(table['S1'] > 0) == 1, 'upside down, and against the stop', table)
    start = "&structure cq=1 /\n&initial coordinate=1, position=-1.3 /\n&initial coordinate=4, position=-0.55 /\n"
    stopped = FOUR_BAR + start + "&stop coordinate=4, high=-0.3 /\n"
    table, _ = rest(mech9d, tmp_path, stopped, '--equilibrium')
    settled, _, _ = go(mech9d, tmp_path, stopped + "&load kind='coordinate', coordinate=1, damping=30 /\n", 30.0, 1)
    for name in ('q1', 'q2', 'q3', 'q4', 'S1'):
        checks.near(table[name][0], settled[name][-1], 1e-8, f'{name} of a dependent coordinate against its stop, as the motion ends')
