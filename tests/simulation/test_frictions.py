"""Frictions against closed forms, and one mechanism described in several ways: stick and slip, groups of pairs that move together,
bearings, faces, guides, threads; beside stops and drives; drive forces; paradox and self-locking; the smooth law; bad groups.

Compares the program with itself: drive forces of mech9k and the loads at which mech9d slips; one slider-crank by two coordinates and in
another frame; few and many outputs; Coulomb's law and the smooth one."""
import json
import re
from math import asin, atan, cos, exp, pi, radians, sin, sqrt, tan

import numpy as np
import pytest

from mech9_cases import read_table, run

G = 9.81
TIGHT = "&solver relative_tolerance=1e-10, absolute_tolerance=1e-12 /\n"
SLIDER = """&mechanism title='a slider' /
&structure cq=1 /
&pair coordinate=1, links=1,2, kind='prismatic', axis=1,0,0 /
&body link=2, mass=1 /
"""
CRANK = """&mechanism title='slider-crank with friction everywhere' /
&pair coordinate=1, links=1,2, kind='revolute', axis=0,0,1, point=0,0,0 /
&pair coordinate=2, links=2,3, kind='revolute', axis=0,0,1, point=0.1,0,0 /
&pair coordinate=3, links=3,4, kind='revolute', axis=0,0,1, point=0.4,0,0 /
&pair coordinate=4, links=4,1, kind='prismatic', axis=1,0,0, point=0.4,0,0 /
&body link=2, mass=1, centre=0,0,0, inertia=0,0,0.005,0,0,0 /
&body link=3, mass=0.5, centre=0.25,0,0, inertia=0,0,0.004,0,0,0 /
&body link=4, mass=0.7, centre=0.4,0,0 /
&gravity acceleration=0,-9.81,0 /
&friction coordinate=1, dynamic=0.1, static=0.12, radius=0.01 /
&friction coordinate=2, dynamic=0.1, static=0.12, radius=0.01 /
&friction coordinate=3, dynamic=0.1, static=0.12, radius=0.01 /
&friction coordinate=4, dynamic=0.15, static=0.2, arm=0.03 /
"""
LADDER = """&mechanism title='a ladder of 2 m, its foot with friction' /
&structure cq=2 /
&pair coordinate=1, links=1,2, kind='prismatic', axis=1,0,0, point=0,0,0 /
&pair coordinate=2, links=2,3, kind='revolute', axis=0,0,1, point=0,0,0 /
&pair coordinate=3, links=3,4, kind='revolute', axis=0,0,1, point=0,2,0 /
&pair coordinate=4, links=4,1, kind='prismatic', axis=0,1,0, point=0,2,0 /
&body link=3, mass=3, centre=0,1,0, inertia=1,0,1,0,0,0 /
&gravity acceleration=0,-9.81,0 /
"""


def go(program, folder, text, end, intervals=20, code=0, options=()):
    """Table, events and standard error of a run that ends with a code."""
    path, table, report = folder / 'rub.nml', folder / 'rub.dat', folder / 'rub.json'
    path.write_text(f'{text}&time end={end!r}, intervals={intervals} /\n', encoding='utf-8')
    done = run(program, path, '--table', table, '--report', report, *options)
    assert done.returncode == code, done.stderr
    columns = read_table(table.read_text()) if code == 0 else None
    return columns, json.loads(report.read_text()).get('events', []), done.stderr


def times(events, kind, number=1):
    return np.array([event['time'] for event in events if (event['kind'], event['group'], event['number']) == (kind, 'friction', number)])


def energy(table):
    """The energy of the motion, and the heat of all frictions."""
    return table['E.total'] + sum(table[name] for name in table if name.endswith('.heat'))


def test_dry_oscillator(checks, mech9d, tmp_path):
    """m = k = F = 1, from x = 12 and v = 6: half swings about +-1, until it rests."""
    text = SLIDER + TIGHT + """&initial coordinate=1, position=12, velocity=6 /
&load kind='coordinate', coordinate=1, stiffness=1 /
&friction coordinate=1, dynamic=1, preload=1 /
&output energies=.true. /
"""
    table, events, _ = go(mech9d, tmp_path, text, 30.0, 60)
    # tolerance: that of the integration, over 23 units of time
    checks.near(table['q1'][-1], 0.6821789367236468, 2e-9, 'it rests where the spring is weaker than the friction')
    checks.near(times(events, 'stick'), [22.42355635069909], 1e-9, 'after eight half swings', scale=22)
    checks.near(times(events, 'slip'), 22.42355635069909 - pi * np.arange(7, 0, -1), 1e-9, 'each of half a period', scale=22)
    checks.near(energy(table), 90.0, 3e-9, 'heat and energy together are kept', scale=90)
    checks.true(np.all(table['dq1'][-10:] == 0.0), 'it does not creep')
    checks.near(table['R1.friction'][-1], table['q1'][-1], 1e-12, 'and the friction is the force of the spring')
    few, many = (go(mech9d, tmp_path, text, 30.0, n)[1] for n in (1, 1000))
    checks.true(few == many == events, 'events do not depend on the outputs')


@pytest.mark.parametrize(('speed', 'mass', 'stiffness', 'static', 'dynamic'),
                         [(1.0, 3, 900, 0.6, 0.59), (0.5, 2, 100, 0.3, 0.299), (0.5, 2, 100, 0.3, 0.2)])
def test_a_block_on_a_belt_sticks_each_time(checks, mech9d, tmp_path, speed, mass, stiffness, static, dynamic):
    """A block on a belt that a spring holds slips and sticks in turn. With coefficients close to each other it rests on the belt for a
    small part of a step only; else it would go on to swing, which is another motion."""
    text = f"""&mechanism title='block on a belt' /
&structure cq=1,2 /
&pair coordinate=1, links=1,2, kind='prismatic', axis=1,0,0 /
&pair coordinate=2, links=2,3, kind='prismatic', axis=1,0,0 /
&drive coordinate=1, kind='polynomial', coefficients=0, {speed} /
&initial coordinate=2, position=0, velocity=0 /
&body link=3, mass={mass} /
&gravity acceleration=0,-9.81,0 /
&load kind='spring', links=1,3, position=-1,0,0, stiffness={stiffness}, free_length=1 /
&friction coordinate=2, static={static}, dynamic={dynamic} /
""" + TIGHT
    w, far, middle = sqrt(stiffness / mass), static*mass*G/stiffness, dynamic*mass*G/stiffness
    slip = 2*(pi - atan((far - middle)*w/speed))/w
    period = slip + 2*(far - middle)/speed
    _, events, _ = go(mech9d, tmp_path, text, far/speed + 3.5*period, 2)
    slips, sticks = (times(events, kind) for kind in ('slip', 'stick'))
    sticks = sticks[sticks > 0]
    checks.near(slips, far/speed + period*np.arange(4), 1e-8, 'it slips', scale=period)
    checks.near(sticks, far/speed + slip + period*np.arange(3), 1e-8, 'it sticks', scale=period)


def test_an_incline(checks, mech9d, tmp_path):
    """A slider on a slope of 30 degrees: it holds up to the tangent, and slides with g (sin - mu cos)."""
    a = radians(30)
    slope = SLIDER + f"&gravity acceleration={G * sin(a)!r},{-G * cos(a)!r},0 /\n&initial coordinate=1, position=0 /\n"
    for mu, holds in ((tan(a) * (1 + 1e-9), True), (tan(a) * (1 - 1e-9), False), (0.2, False)):
        table, events, _ = go(mech9d, tmp_path, slope + f'&friction coordinate=1, dynamic={min(mu, 0.5)!r}, static={mu!r} /\n', 2.0)
        t = table['t']
        expected = 0 * t if holds else 0.5 * G * (sin(a) - min(mu, 0.5) * cos(a)) * t**2
        checks.near(table['q1'], expected, 1e-11, f'mu = {mu}: the way', scale=10)
        checks.true(not events, f'mu = {mu}: nothing changes after the start')
        checks.near(table['R1.friction'], -G * (sin(a) if holds else min(mu, 0.5) * cos(a)), 1e-12, f'mu = {mu}: friction', scale=10)


def test_a_load_tears_off(checks, mech9d, tmp_path):
    """A force that grows with time tears a slider off at 0.3 m g, also within one output."""
    text = SLIDER + TIGHT + """&initial coordinate=1, position=0 /
&gravity acceleration=0,-9.81,0 /
&load kind='force', link=2, position=0,0,0, force=2,0,0, law='polynomial', coefficients=0,1 /
&friction coordinate=1, dynamic=0.2, static=0.3 /
"""
    for intervals in (1, 30):
        table, events, _ = go(mech9d, tmp_path, text, 3.0, intervals)
        off = 0.3 * G / 2
        checks.near(times(events, 'slip'), [off], 1e-11, f'{intervals} intervals: the time')
        since = np.maximum(0, table['t'] - off)
        checks.near(table['q1'], since**3 / 3 + 0.05 * G * since**2, 1e-10, f'{intervals} intervals: the way behind')


def test_a_load_that_swings(checks, mech9d, tmp_path):
    """A force of many periods in one output: the pair slips in each half period in which the force exceeds the bound."""
    text = SLIDER + """&initial coordinate=1, position=0 /
&gravity acceleration=0,-9.81,0 /
&load kind='force', link=2, position=0,0,0, force=3,0,0, law='harmonic', amplitude=1, angular_frequency=20 /
&friction coordinate=1, dynamic=0.3 /
"""
    table, events, _ = go(mech9d, tmp_path, text, 2.0, 1)
    first = asin(0.3 * G / 3) / 20
    slips = times(events, 'slip')
    checks.equal(len(slips), 13, 'a slip in each half period of 2 s')
    checks.near(slips, first + pi / 20 * np.arange(13), 1e-8, 'at the same force')
    checks.true(np.all(times(events, 'stick') > slips[:len(times(events, 'stick'))]), 'and it sticks after each')


def test_a_shaft_runs_down(checks, mech9d, tmp_path):
    """A disc of 5 kg on an upright shaft: face and preload take a constant torque, a pin by an unbalance one that grows with the speed."""
    shaft = """&mechanism title='a shaft' /
&structure cq=1 /
&pair coordinate=1, links=1,2, kind='revolute', axis=0,0,1 /
&gravity acceleration=0,0,-9.81 /
&initial coordinate=1, position=0, velocity=40 /
"""
    text = shaft + TIGHT + """&body link=2, mass=5, centre=0,0,0, inertia=0.1,0.1,0.2,0,0,0 /
&friction coordinate=1, dynamic=0.1, face_radius=0.03, preload=0.5 /
"""
    torque = 0.1 * (0.03 * 5 * G + 0.5)
    table, events, _ = go(mech9d, tmp_path, text, 50.0, 50)
    checks.near(times(events, 'stick'), [40 * 0.2 / torque], 1e-9, 'it stands after w I/T', scale=40)
    checks.near(table['dq1'], np.maximum(0.0, 40 - torque / 0.2 * table['t']), 1e-9, 'and slows down evenly', scale=40)
    # the centre is 0.02 m off: the pin has m e w^2, and the friction of its tangential part m e dw/dt, at right angles
    text = shaft.replace('0,0,-9.81', '0,0,0') + TIGHT + """&body link=2, mass=5, centre=0.02,0,0, inertia=0.1,0.1,0.2,0,0,0 /
&friction coordinate=1, dynamic=0.1, radius=0.05 /
"""
    table, _, _ = go(mech9d, tmp_path, text, 10.0, 20)
    inertia, part = 0.2 + 5 * 0.02**2, 0.1 * 0.05 * 5 * 0.02
    slowing = part / sqrt(inertia**2 - part**2)
    # dw/dt = -k w^2 with I k = part sqrt(1 + k^2)
    checks.near(table['dq1'], 40 / (1 + 40 * slowing * table['t']), 1e-8, 'an unbalance slows by the square of the speed', scale=40)


def test_pairs_that_move_together(checks, mech9d, tmp_path):
    """All four pairs of a slider-crank rub: it runs down and rests, each pair used as much as the others."""
    text = CRANK + TIGHT + "&structure cq=1 /\n&initial coordinate=1, position=0.3, velocity=20 /\n&output energies=.true., reactions=.true. /\n"
    table, events, _ = go(mech9d, tmp_path, text, 2.0, 100)
    checks.near(energy(table), energy(table)[0], 1e-8, 'the power balance closes', scale=2)
    ends = times(events, 'stick')
    checks.equal([list(times(events, 'stick', n)) for n in (2, 3, 4)], [list(ends)] * 3, 'all pairs rest at one time')
    checks.true(np.all(table['dq1'][table['t'] > ends[0]] == 0.0), 'and stay at rest')
    used = []
    for n in (1, 2, 3, 4):
        f = np.array([table[f'R{n}.f{x}'] for x in 'xyz'])
        # the pair of the slider is across x; turning pairs are pressed by the whole force
        pressed = np.hypot(f[0], f[1]) * 0.01 * 0.12 if n < 4 else 0.2 * (abs(f[1]) + abs(table['R4.mz']) / 0.03)
        used.append((abs(table[f'R{n}.friction']) / pressed)[-1])
    checks.near(used, used[0], 1e-9, 'each is used to the same part of what it holds')
    checks.true(0.01 < used[0] < 1, 'which is less than all', used)
    moving = (table['t'] > 0.01) & (table['t'] < ends[0])
    for n in (1, 2, 3):
        f = np.hypot(table[f'R{n}.fx'], table[f'R{n}.fy'])[moving]
        checks.near(table[f'R{n}.friction'][moving], -np.sign(table[f'dq{n}'][moving]) * 0.1 * 0.01 * f, 1e-11, f'friction {n} in motion')
    f = 0.15 * (abs(table['R4.fy']) + abs(table['R4.mz']) / 0.03)[moving]
    checks.near(table['R4.friction'][moving], -np.sign(table['dq4'][moving]) * f, 1e-10, 'friction of the slider', scale=50)


def test_descriptions_agree(checks, mech9d, tmp_path):
    """The slider's coordinate in place of the crank's; another frame; degrees; links and pairs with other numbers."""
    start = "&initial coordinate=1, position=0.3, velocity=20 /\n"
    table, events, _ = go(mech9d, tmp_path, CRANK + TIGHT + "&structure cq=1 /\n" + start, 0.6, 30)
    found = {'slider': go(mech9d, tmp_path, CRANK + TIGHT + f"""&structure cq=4 /
&initial coordinate=4, position={table['q4'][0]!r}, velocity={table['dq4'][0]!r} /
&initial coordinate=1, position=0.3 /
&initial coordinate=2, position={table['q2'][0]!r} /
&initial coordinate=3, position={table['q3'][0]!r} /
""", 0.6, 30)}

    def turn(match):
        x, y, z = (float(number) for number in match.group(2).split(','))
        return f'{match.group(1)}={z!r},{x!r},{y!r}'
    other = re.sub(r'(axis|point|centre|acceleration)=([^ ,]*,[^ ,]*,[^ ,]*)', turn, CRANK)
    other = re.sub(r'inertia=0,0,([^,]*),0,0,0', r'inertia=\1,0,0,0,0,0', other)
    found['turned'] = go(mech9d, tmp_path, other + TIGHT + "&structure cq=1 /\n" + start, 0.6, 30)
    degrees = CRANK.replace("everywhere'", "everywhere', angle_unit='deg'")
    found['degrees'] = go(mech9d, tmp_path, degrees + TIGHT + f"&structure cq=1 /\n&initial coordinate=1, position={0.3 * 180 / pi!r}, "
                          f"velocity={20 * 180 / pi!r} /\n", 0.6, 30)
    for name, (there, others, _) in found.items():
        unit = 180 / pi if name == 'degrees' else 1.0
        checks.near(there['q1'] / unit, table['q1'], 1e-7, f'{name}: the motion', scale=10)
        checks.near(there['R4.friction'], table['R4.friction'], 1e-6, f'{name}: friction', scale=50)
        checks.equal([(e['kind'], e['number']) for e in others], [(e['kind'], e['number']) for e in events], f'{name}: events')
        checks.near([e['time'] for e in others], [e['time'] for e in events], 1e-8, f'{name}: their times')


def test_the_load_that_starts_a_mechanism(checks, mech9d, mech9k, tmp_path):
    """A torque that grows starts the slider-crank where mech9k's range of the drive force ends, in both directions."""
    drive = "&drive coordinate=1, kind='polynomial', coefficients=1.3 /\n"
    _, _, said = go(mech9k, tmp_path, CRANK + "&structure cq=1 /\n" + drive + "&output drive_forces=.true. /\n", 1.0, 1)
    low, high = (float(number) for number in re.search(r'lies between (\S+) and (\S+) N m', said).groups())
    checks.true(low < high, 'there is a range')
    for sign, bound in ((1, high), (-1, low)):
        # the drive's force holds the mechanism against its weights: the same as a torque; it begins in the middle of the range
        text = CRANK + TIGHT + f"""&structure cq=1 /
&initial coordinate=1, position=1.3, velocity=0 /
&load kind='coordinate', coordinate=1, force=1, law='polynomial', coefficients={0.5 * (low + high)!r},{sign * 0.1!r} /
"""
        expected = (bound - 0.5 * (low + high)) / (sign * 0.1)
        _, events, _ = go(mech9d, tmp_path, text, expected + 0.3, 1)
        # tolerance: the range is printed with six digits
        checks.near(times(events, 'slip')[0], expected, 2e-5, f'direction {sign}: the torque that starts it', scale=expected)


def test_threads(checks, mech9d, mech9k, tmp_path):
    """A nut on a screw: torques up and down; it holds its load from the tangent of the thread on, else it runs down."""
    h, r, load = 0.01 / (2 * pi), 0.015, 500.0
    jack = """&mechanism title='a jack' /
&pair coordinate=1, links=1,2, kind='revolute', axis=0,0,1 /
&pair coordinate=2, links=2,3, kind='helical', axis=0,0,1, pitch=0.01 /
&pair coordinate=3, links=1,3, kind='prismatic', axis=0,0,1 /
&load kind='force', link=3, position=0,0,0, force=0,0,-500 /
"""
    a = atan(h / r)
    for mu in (0.05, 0.3):
        for speed in (3, -3):
            table, _, _ = go(mech9k, tmp_path, jack + f"""&structure cq=1 /
&drive coordinate=1, kind='polynomial', coefficients=0,{speed} /
&friction coordinate=2, dynamic={mu}, radius=0.015 /
&output drive_forces=.true. /
""", 1.0, 4)
            b = atan(mu) * (1 if speed < 0 else -1)
            checks.near(table['F1'], -load * r * tan(a + b), 1e-11, f'mu = {mu}, speed = {speed}: torque', scale=load * r)
    _, _, said = go(mech9k, tmp_path, jack + """&structure cq=1 /
&drive coordinate=1, kind='polynomial', coefficients=0.5 /
&friction coordinate=2, dynamic=0.1, static=0.2, radius=0.015 /
&output drive_forces=.true. /
""", 1.0, 4)
    low, high = (float(number) for number in re.search(r'lies between (\S+) and (\S+) N m', said).groups())
    checks.near([low, high], [-load * r * tan(a + atan(0.2)), -load * r * tan(a - atan(0.2))], 1e-5, 'range at rest', scale=load * r)
    start = "&structure cq=1 /\n&initial coordinate=1, position=0, velocity=0 /\n&body link=2, mass=2, inertia=0,0,1e-3,0,0,0 /\n"
    for mu, holds in ((h / r * (1 + 1e-9), True), (h / r * (1 - 1e-9), False), (0.02, False)):
        table, _, _ = go(mech9d, tmp_path, jack + start + f"&friction coordinate=2, dynamic={mu!r}, radius=0.015 /\n", 0.1, 10)
        expected = 0.0 if holds else load * r * tan(a - atan(mu)) / 1e-3
        checks.near(table['ddq1'], expected, 1e-9, f'mu = {mu}: acceleration', scale=load * h / 1e-3)


def test_guides(checks, mech9d, tmp_path):
    """A slider that a force pulls beside its guide: the moment presses both ends, and the guide jams from mu = arm/(distance + arm) ..."""
    for distance, mu in ((0.0, 0.2), (0.05, 0.2), (0.2, 0.2)):
        text = SLIDER + f"""&initial coordinate=1, position=0 /
&load kind='force', link=2, position=0,{distance},0, force=10,0,0 /
&friction coordinate=1, dynamic={mu}, arm=0.04 /
"""
        table, _, _ = go(mech9d, tmp_path, text, 1.0, 10)
        force = 10 * (1 - mu * distance / 0.04)
        checks.near(table['ddq1'], max(0.0, force), 1e-12, f'a force {distance} m beside', scale=10)


def test_a_cylindrical_joint(checks, mech9d, tmp_path):
    """A rod turns and slides in a bush under its weight across: each of both motions has its friction."""
    text = """&mechanism title='a rod in a bush' /
&structure cq=1,2 /
&pair coordinates=1,2, links=1,2, kind='cylindrical', axis=1,0,0 /
&body link=2, mass=3, centre=0,0,0, inertia=0.02,0.1,0.1,0,0,0 /
&gravity acceleration=0,0,-9.81 /
&initial coordinate=1, position=0, velocity=30 /
&initial coordinate=2, position=0, velocity=1 /
&friction coordinate=1, dynamic=0.1, radius=0.02 /
&friction coordinate=2, dynamic=0.15 /
"""
    table, events, _ = go(mech9d, tmp_path, text + TIGHT, 15.0, 30)
    turning, sliding = 0.1 * 0.02 * 3 * G / 0.02, 0.15 * G
    checks.near(times(events, 'stick', 1), [30 / turning], 1e-10, 'it stops to turn', scale=10)
    checks.near(times(events, 'stick', 2), [1 / sliding], 1e-11, 'and to slide')
    checks.near(table['dq1'], np.maximum(0, 30 - turning * table['t']), 1e-9, 'the turn', scale=30)


def test_stops_and_friction(checks, mech9d, tmp_path):
    """A double pendulum between elastic stops: heat and energy keep their sum; a slider on its stop rubs on the way alone."""
    text = """&mechanism title='double pendulum' /
&structure cq=1,2 /
&pair coordinate=1, links=1,2, kind='revolute', axis=0,0,1, point=0,0,0 /
&pair coordinate=2, links=2,3, kind='revolute', axis=0,0,1, point=1,0,0 /
&initial coordinate=1, position=0.3, velocity=2 /
&initial coordinate=2, position=0.5, velocity=-1 /
&body link=2, mass=1, centre=0.5,0,0, inertia=0,0,0.083,0,0,0 /
&body link=3, mass=1, centre=1.5,0,0, inertia=0,0,0.083,0,0,0 /
&gravity acceleration=0,-9.81,0 /
&stop coordinate=2, low=-0.3, high=0.6, restitution=1 /
&stop coordinate=1, low=-1.2, high=0.6, restitution=1 /
&friction coordinate=1, dynamic=0.2, radius=0.1, static=0.3 /
&friction coordinate=2, dynamic=0.2, radius=0.08, static=0.4 /
&output energies=.true. /
"""
    table, events, _ = go(mech9d, tmp_path, text + TIGHT, 3.0, 100)
    checks.true(len([e for e in events if e['kind'] == 'impact']) > 10 and len(times(events, 'slip', 2)) > 10, 'both happen often')
    checks.near(energy(table), energy(table)[0], 2e-8, 'heat and energy', scale=30)
    text = SLIDER + TIGHT + """&initial coordinate=1, position=1, velocity=-3 /
&gravity acceleration=0,-9.81,0 /
&stop coordinate=1, low=0, restitution=0.5 /
&friction coordinate=1, dynamic=0.2 /
"""
    table, events, _ = go(mech9d, tmp_path, text, 3.0, 30)
    slowing = 0.2 * G
    rate = sqrt(9 - 2 * slowing)
    hit = (3 - rate) / slowing
    checks.near([e['time'] for e in events if e['kind'] == 'impact'], [hit], 1e-11, 'it hits its stop')
    checks.near(times(events, 'stick'), [hit + 0.5 * rate / slowing], 1e-10, 'and comes back half as fast, to rest')
    checks.near(table['q1'][-1], 0.125 * rate**2 / slowing, 1e-10, 'where its energy is used up')


def test_a_block_bounces_on_a_slope(checks, mech9d, tmp_path):
    """Down and up a slope of 30 degrees against a stop: each flight is r times as fast as the one before, r = e sqrt(down/up)."""
    a, mu, e = radians(30), 0.3, 0.5
    down, up = G * (sin(a) - mu * cos(a)), G * (sin(a) + mu * cos(a))
    text = SLIDER + TIGHT + f"""&gravity acceleration={-G * sin(a)!r},{-G * cos(a)!r},0 /
&initial coordinate=1, position=1 /
&stop coordinate=1, low=0, restitution={e} /
&friction coordinate=1, dynamic={mu} /
"""
    first, rate, r = sqrt(2 / down), e * sqrt(2 * down), e * sqrt(down / up)
    flight = rate / up + rate / sqrt(down * up)
    end = first + flight / (1 - r)
    for until in (2.0, 2.75563, 5.0):
        table, events, _ = go(mech9d, tmp_path, text, until, 40)
        hits = np.array([event['time'] for event in events if event['kind'] == 'impact'])
        checks.near(hits[:8], first + flight * (1 - r**np.arange(8)) / (1 - r), 1e-9, f'until {until}: times of impacts')
        checks.true(np.all(table['R1.loss'] >= 0.0), f'until {until}: friction never drives')
        if until > end:
            checks.near(table['q1'][-1], 0.0, 1e-11, f'until {until}: it rests on the stop')
            checks.near([event['time'] for event in events if event['kind'] == 'close'], [end], 1e-6, f'until {until}: at the end of all flights')


STACK = """&mechanism title='a block on a block' /
&structure cq=1,2 /
&pair coordinate=1, links=1,2, kind='prismatic', axis=1,0,0 /
&pair coordinate=2, links=2,3, kind='prismatic', axis=1,0,0 /
&body link=3, mass=1 /
&initial coordinate=1, position=0, velocity=0 /
"""


def test_a_pair_that_sticks_stays(checks, mech9d, tmp_path):
    """The upper block comes to rest while the lower one sticks, whose friction at rest is six times that in motion."""
    text = STACK + """&body link=2, mass=1 /
&gravity acceleration=1.5,-10,0 /
&initial coordinate=2, position=0, velocity=-1 /
&friction coordinate=1, dynamic=0.1, static=0.6 /
&friction coordinate=2, dynamic=0.3, static=0.6 /
&load kind='coordinate', coordinate=2, stiffness=0.1, rest=1 /
"""
    table, events, _ = go(mech9d, tmp_path, text, 10.0, 10)
    checks.true(np.all(table['q1'] == 0.0), 'the lower block does not move')
    checks.equal([(e['kind'], e['number']) for e in events], [('stick', 2)], 'the upper one alone comes to rest')


def test_an_impact_while_a_pair_sticks(checks, mech9d, tmp_path):
    """An inelastic impact within the stack sets the lower block, 2 kg, in motion with the upper one; both slide to rest."""
    text = STACK + TIGHT + """&body link=2, mass=2 /
&gravity acceleration=0,-10,0 /
&initial coordinate=2, position=0, velocity=-2 /
&stop coordinate=2, low=-0.3, high=0.3, restitution=0 /
&friction coordinate=1, dynamic=0.15 /
&friction coordinate=2, dynamic=0.1 /
"""
    table, events, _ = go(mech9d, tmp_path, text, 3.0, 30)
    rate = sqrt(4 - 2 * 0.3) / 3
    checks.near(table['q1'][-1], -rate**2 / (2 * 0.15 * 10), 1e-9, 'momentum is kept, and the floor stops both')
    checks.near(table['q2'][-1], -0.3, 1e-11, 'at the stop')


def test_a_load_that_vibrates(checks, mech9d, tmp_path):
    """A load of 50 Hz on a slow one: the pair slips where both exceed its bound, however long the run is."""
    text = SLIDER + """&initial coordinate=1, position=0 /
&gravity acceleration=0,-10,0 /
&load kind='force', link=2, position=0,0,0, force=1,0,0, law='harmonic', amplitude=1, angular_frequency=314.1592653589793 /
&load kind='force', link=2, position=0,0,0, force=1,0,0, law='polynomial', coefficients=0,0.2 /
&friction coordinate=1, dynamic=0.29, static=0.3 /
"""
    # the first crest at which both are 3 N: before it, by bisection
    low, high = 10.0, 10.005
    for _ in range(60):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if 0.2 * middle + sin(100 * pi * middle) < 3.0 else (low, middle)
    for end in (12.0, 20.0, 40.0):
        _, events, _ = go(mech9d, tmp_path, text, end, 1)
        checks.near(times(events, 'slip')[0], low, 1e-8, f'end = {end}: the first slip', scale=10)


def test_let_go_from_rest(checks, mech9d, tmp_path):
    """A double pendulum whose lower pair sticks once the upper one slips, though it would slip first beside an upper one that sticks."""
    text = """&mechanism title='double pendulum let go' /
&structure cq=1,2 /
&pair coordinate=1, links=1,2, kind='revolute', axis=0,0,1, point=0,0,0 /
&pair coordinate=2, links=2,3, kind='revolute', axis=0,0,1, point=1,0,0 /
&initial coordinate=1, position=0, velocity=0 /
&initial coordinate=2, position=0, velocity=0 /
&body link=2, mass=1, centre=0.5,0,0, inertia=0,0,0.083,0,0,0 /
&body link=3, mass=1, centre=1.5,0,0, inertia=0,0,0.083,0,0,0 /
&gravity acceleration=0,-9.81,0 /
&friction coordinate=1, dynamic=1, preload=8 /
&friction coordinate=2, dynamic=1, preload=1.5 /
"""
    table, _, _ = go(mech9d, tmp_path, text, 0.1, 2)
    checks.true(table['R1.friction'][0] == 8.0 and abs(table['R2.friction'][0]) <= 1.5, 'one slips, and the other holds', table['R2.friction'])
    checks.near(table['ddq2'][0], 0.0, 1e-12, 'without an acceleration')


def test_the_paradox(checks, mech9d, tmp_path):
    """A ladder whose foot alone rubs: mu sin 2a >= 4/3 has no solution downward and two upward; it begins there in a motion, too."""
    def start(angle, speed):
        return (f"&initial coordinate=2, position={angle!r}, velocity={speed!r} /\n&initial coordinate=1, position={2 * sin(angle)!r} /\n"
                f"&initial coordinate=4, position={2 - 2 * cos(angle)!r} /\n&initial coordinate=3, position={-angle!r} /\n")
    for angle in (0.6, 0.9):
        least = 4 / 3 / sin(2 * angle)
        for mu, speed, words in ((least * (1 + 1e-9), 0.3, 'no solution'), (least * (1 + 1e-9), -0.3, 'several solutions')):
            text = LADDER + start(angle, speed) + f'&friction coordinate=1, dynamic={mu!r} /\n'
            _, _, said = go(mech9d, tmp_path, text, 1.0, code=6)
            checks.true(f'has {words} from t = 0 s on (the paradox of Painleve)' in said, f'{angle}, {speed}: {words}', said)
            checks.true(f'and from {least:.7g}'[:15] in said, f'{angle}, {speed}: the least coefficient', said)
        text = LADDER + start(angle, 0.3) + f'&friction coordinate=1, dynamic={least * (1 - 1e-9)!r} /\n'
        go(mech9d, tmp_path, text, 1e-9, 1)
    # it slides upward, from a position without the paradox into one with it
    text = LADDER + start(1.1, -8.0) + '&friction coordinate=1, dynamic=1.5 /\n' + TIGHT
    _, _, said = go(mech9d, tmp_path, text, 1.0, code=6)
    t = float(re.search(r'from t = (\S+) s on', said).group(1))
    table, _, _ = go(mech9d, tmp_path, text, t * (1 - 1e-9), 1)
    checks.near(1.5 * sin(2 * table['q2'][-1]), 4 / 3, 1e-7, 'it ends where the paradox begins')


def test_self_locking(checks, mech9k, tmp_path):
    """A wedge that lifts a block: driven by the wedge it runs, driven by the block it locks from mu = tan(angle)/2 on, friction twice."""
    a = radians(20)
    wedge = f"""&mechanism title='a wedge' /
&pair coordinate=1, links=1,2, kind='prismatic', axis=1,0,0 /
&pair coordinate=2, links=2,3, kind='prismatic', axis={-cos(a)!r},{sin(a)!r},0 /
&pair coordinate=3, links=1,3, kind='prismatic', axis=0,1,0 /
&load kind='force', link=3, position=0,0,0, force=0,-100,0 /
&friction coordinate=2, dynamic=MU /
&output drive_forces=.true. /
"""
    for mu in (0.1, 0.5):
        table, _, _ = go(mech9k, tmp_path, wedge.replace('MU', repr(mu)) + "&structure cq=1 /\n&drive coordinate=1, kind='polynomial', "
                         "coefficients=0,0.1 /\n", 1.0, 2)
        checks.near(table['F1'], 100 * tan(a + atan(mu)), 1e-11, f'mu = {mu}: it lifts', scale=100)
    back = "&structure cq=3 /\n&drive coordinate=3, kind='polynomial', coefficients=0,-0.1 /\n&load kind='coordinate', coordinate=1, force=30 /\n"
    table, _, _ = go(mech9k, tmp_path, wedge.replace('MU', repr(tan(a) * (1 - 1e-6))) + back, 1.0, 2)
    checks.true(np.all(np.isfinite(table['F3'])), 'just below the tangent it runs')
    _, _, said = go(mech9k, tmp_path, wedge.replace('MU', repr(tan(a) * (1 + 1e-6))) + back, 1.0, 2, code=6)
    checks.true('coordinate 3 cannot be driven in the negative direction at t = 0 s: the mechanism locks itself by the friction of '
                f'coordinate 2' in said and f'from {tan(a):.6f}'[:12] in said and 'no force moves it' in said, 'above, it locks', said)


def test_the_smooth_law(checks, mech9d, tmp_path):
    """It comes to Coulomb's law with smaller transitions, and creeps where that sticks."""
    start = CRANK + TIGHT + "&structure cq=1 /\n&initial coordinate=1, position=0.3, velocity=20 /\n"
    table, _, _ = go(mech9d, tmp_path, start, 0.5, 20)
    errors = []
    for transition in (1e-2, 1e-3):
        smooth = re.sub(r'dynamic=([^,]*), static=[^,]*,', rf"dynamic=\1, law='smooth', transition={transition},", start)
        there, events, _ = go(mech9d, tmp_path, smooth, 0.5, 20)
        checks.true(not events, f'transition {transition}: no events')
        errors.append(np.max(np.abs(there['q1'] - table['q1'])))
    checks.true(errors[1] < 0.2 * errors[0] < 0.01, 'ten times as near', errors)
    slope = SLIDER + "&gravity acceleration=1,-10,0 /\n&initial coordinate=1, position=0 /\n" \
        "&friction coordinate=1, dynamic=0.2, law='smooth', transition=0.01 /\n"
    table, _, _ = go(mech9d, tmp_path, slope, 10.0, 10)
    checks.near(table['dq1'][-1], 0.01 * np.arctanh(0.5), 1e-9, 'it creeps down a slope on which it would hold')


def test_a_driven_pair(checks, mech9d, mech9k, tmp_path):
    """The friction of a pair that drives alone move goes with its rate, also where it turns back."""
    text = """&mechanism title='a driven slide' /
&structure cq=1,2 /
&pair coordinate=1, links=1,2, kind='prismatic', axis=1,0,0 /
&pair coordinate=2, links=2,3, kind='prismatic', axis=0,0,1 /
&body link=3, mass=2 /
&body link=2, mass=1 /
&gravity acceleration=0,0,-10 /
&initial coordinate=2, position=1, velocity=0 /
&drive coordinate=1, kind='table', file='way.dat' /
&load kind='coordinate', coordinate=2, stiffness=100, rest=1 /
&friction coordinate=1, dynamic=0.1 /
&output drive_forces=.true. /
"""
    (tmp_path / 'way.dat').write_text('\n'.join(f'{0.01 * i} {0.3 * sin(0.02 * pi * i)}' for i in range(401)))
    table, events, _ = go(mech9d, tmp_path, text, 4.0, 200)
    checks.near(times(events, 'slip'), 0.25 + 0.5 * np.arange(8), 1e-6, 'it turns back with the drive')
    away = np.abs(table['dq1']) > 0.05
    pressed = 10 * 1 + 2 * (10 + table['ddq2'])
    checks.near(table['R1.friction'][away], (-0.1 * np.sign(table['dq1']) * pressed)[away], 1e-9, 'friction of the driven pair', scale=5)


@pytest.mark.parametrize('friction, words', [
    ('coordinate=1, dynamic=-0.1', "'dynamic'"), ('coordinate=1', "needs 'dynamic'"), ('coordinate=9, dynamic=0.1', 'there is no coordinate 9'),
    ('coordinate=1, dynamic=0.2, static=0.1', 'static= is less than dynamic='), ('coordinate=1, dynamic=0.1, radius=0.1', 'radius= belongs to'),
    ('coordinate=1, dynamic=0.1, face_radius=0.1', 'face_radius= belongs to'), ('coordinate=2, dynamic=0.1', 'nothing presses'),
    ('coordinate=2, dynamic=0.1, arm=0.1', 'arm= belongs to a sliding pair'), ('coordinate=3, dynamic=0.1', 'mean radius of the thread'),
    ("coordinate=1, dynamic=0.1, law='smooth'", 'give transition='), ('coordinate=1, dynamic=0.1, transition=1', "belongs to law='smooth'"),
    ("coordinate=1, dynamic=0.1, static=0.2, law='smooth', transition=1", 'a pair never sticks'),
    ('coordinate=4, dynamic=0.1', 'friction is not available in a spherical joint')])
def test_bad_frictions(checks, mech9d, tmp_path, friction, words):
    text = """&mechanism title='a chain' /
&structure cq=1,2,3,4,5,6 /
&pair coordinate=1, links=1,2, kind='prismatic', axis=1,0,0 /
&pair coordinate=2, links=2,3, kind='revolute', axis=0,1,0 /
&pair coordinate=3, links=3,4, kind='helical', axis=0,0,1, pitch=0.01 /
&pair coordinates=4,5,6, links=4,5, kind='spherical' /
&body link=5, mass=1, inertia=1,1,1,0,0,0 /
""" + ''.join(f'&initial coordinate={k}, position=0.1 /\n' for k in range(1, 7))
    _, _, said = go(mech9d, tmp_path, text + f'&friction {friction} /\n', 1.0, code=3)
    checks.true(words in said and '&friction' in said, friction, said)


def test_refused(checks, mech9d, tmp_path):
    """A wrench that equilibrium does not determine; a motion back in time; two frictions of one coordinate."""
    crank = "&structure cq=1 /\n&initial coordinate=1, position=0.3, velocity=20 /\n"
    _, _, said = go(mech9d, tmp_path, CRANK.replace('acceleration=0,-9.81,0', 'acceleration=0,-9.81,1').replace('radius=0.01', 'face_radius=0.01')
                    + crank, 1.0, code=3)
    checks.true('depends on the component fz of the wrench' in said, 'forces across the plane are not determined', said)
    _, _, said = go(mech9d, tmp_path, CRANK + crank, -1.0, code=3)
    checks.true('friction does not allow a motion back in time' in said, 'back in time', said)
    _, _, said = go(mech9d, tmp_path, CRANK + crank + '&friction coordinate=1, dynamic=0.1, radius=1 /\n', 1.0, code=3)
    checks.true('coordinate 1' in said, 'two frictions of one coordinate', said)
