"""Couplings of coordinates: gears, racks, belts and screws against closed forms, among them Willis' formula for planetary gears, of
which there are random trains, and the differential; a geared five-bar linkage against the same linkage without its gear, whose cranks
are both driven; a screw against a helical pair; reactions and modes against equations of motion of their own; energy; couplings that
repeat or contradict each other, these against all parts of them; refusals with place and remedy.

Compares the program with itself in part: other choices of independent coordinates give the same motion.
"""
import json
import re

import numpy as np
import pytest

from coupling_files import NEAR, TIGHT, TWO_WHEELS, output, table
from mech9_cases import run, text_of

# Round-off of a few operations on numbers of about one.
ROUND_OFF = 1e-13

# The carrier is link 2; sun, planet and ring turn on it. Teeth: 20, 16, 52.
PLANETARY = """&structure cq={cq} /
&pair coordinate=1, links=1,2, kind='revolute', axis=0,0,1 /
&pair coordinate=2, links=2,3, kind='revolute', axis=0,0,1 /
&pair coordinate=3, links=2,4, kind='revolute', point=0.09,0,0, axis=0,0,1 /
&pair coordinate=4, links=2,5, kind='revolute', axis=0,0,1 /
&coupling kind='gear', coordinates=2,3, ratio=-1.25 /
&coupling kind='gear', coordinates=3,4, ratio=0.3076923076923077 /
&body link=2, mass=1, centre=0.03,0,0, inertia=0,0,0.02,0,0,0 /
&body link=3, mass=0.5, inertia=0,0,0.001,0,0,0 /
&body link=4, mass=0.4, centre=0.09,0,0, inertia=0,0,0.0004,0,0,0 /
&body link=5, mass=2, inertia=0,0,0.03,0,0,0 /
"""

FIVE_BAR = """&structure cq={cq} /
&pair coordinate=1, links=1,2, kind='revolute', axis=0,0,1 /
&pair coordinate=2, links=1,3, kind='revolute', point=1,0,0, axis=0,0,1, moving_point=0,0,0 /
&pair coordinate=3, links=2,4, kind='revolute', point=0.2,0,0, axis=0,0,1, moving_point=0,0,0 /
&pair coordinate=4, links=3,5, kind='revolute', point=0.25,0,0, axis=0,0,1, moving_point=0,0,0 /
&pair coordinate=5, links=4,5, kind='revolute', point=0.8,0,0, axis=0,0,1, moving_point=0.8,0,0 /
&initial coordinate=1, position=0.3 /
&initial coordinate=2, position=1.1 /
&initial coordinate=3, position=0.4 /
&initial coordinate=4, position=0.9 /
&initial coordinate=5, position=-1 /
&body link=2, mass=1, centre=0.1,0.02,0, inertia=0,0,0.03,0,0,0 /
&body link=3, mass=1.3, centre=0.1,0,0, inertia=0,0,0.05,0,0,0 /
&body link=4, mass=0.5, centre=0.4,0.1,0, inertia=0,0,0.01,0,0,0 /
&body link=5, mass=0.6, centre=0.3,0,0, inertia=0,0,0.02,0,0,0 /
&gravity acceleration=0,-9.81,0 /
&point name='P', link=4, position=0.8,0,0 /
"""
PHASE_OF_CRANKS = 1.1 + 2 * 0.3
GEAR_OF_CRANKS = f"&coupling kind='gear', coordinates=1,2, ratio=-2, phase={PHASE_OF_CRANKS!r} /\n"


PARALLELOGRAM = """&structure cq=1 /
&pair coordinate=1, links=1,2, kind='revolute', axis=0,0,1 /
&pair coordinate=2, links=2,3, kind='revolute', point=0.3,0,0, axis=0,0,1, moving_point=0,0,0 /
&pair coordinate=3, links=3,4, kind='revolute', point=1,0,0, axis=0,0,1, moving_point=0.3,0,0 /
&pair coordinate=4, links=1,4, kind='revolute', point=1,0,0, axis=0,0,1, moving_point=0,0,0 /
&initial coordinate=1, position=0.7 /
&initial coordinate=2, position=-0.7 /
&initial coordinate=3, position=0.7 /
&initial coordinate=4, position=0.7 /
&body link=3, mass=1, centre=0.5,0,0, inertia=0.1,0.1,0.1,0,0,0 /
&gravity acceleration=0,-9.81,0 /
&drive coordinate=1, kind='polynomial', coefficients=0.7,1 /
"""


TURN, SLIDE = ('revolute', '0,0,1'), ('prismatic', '1,0,0')
# Words of a coupling, the second pair, and the slope of the second coordinate over the first one, in radians and metres.
LINEAR_KINDS = [
    ("kind='gear', ratio=-2.5", TURN, -2.5), ("kind='belt', radii=0.05,0.1", TURN, 0.5),
    ("kind='belt', radii=0.05,0.1, crossed=.true.", TURN, -0.5),
    ("kind='rack', radius=0.02", SLIDE, 0.02),
    ("kind='screw', pitch=0.005", SLIDE, 0.005 / (2 * np.pi))]


def check_linear_motion(checks, mech9k, unit, words, second, rate, constant):
    text = TWO_WHEELS.format(unit=unit, second=second[0], axis=second[1], words=words, first=0.4, other=0.9)
    result = table(mech9k, text)
    checks.near(result['q2'], rate * result['q1'] + constant, ROUND_OFF, f'{words} in {unit}: position')
    checks.near(result['dq2'], rate * result['dq1'], ROUND_OFF, f'{words} in {unit}: rate')
    checks.near(result['ddq2'], rate * result['ddq1'], ROUND_OFF, f'{words} in {unit}: acceleration')


@pytest.mark.parametrize('phase', [None, 0.25])
@pytest.mark.parametrize('words, second, slope', LINEAR_KINDS, ids=['gear', 'belt', 'crossed_belt', 'rack', 'screw'])
@pytest.mark.parametrize('unit', ['rad', 'deg'])
def test_two_wheels(checks, mech9k, unit, words, second, slope, phase):
    """Two wheels, or a wheel and a slide: the second coordinate follows in position, rate and acceleration."""
    if unit == 'deg' and second is SLIDE:
        slope *= np.pi / 180
    if phase is None:
        check_linear_motion(checks, mech9k, unit, words, second, slope, 0.9 - slope * 0.4)
    else:
        check_linear_motion(checks, mech9k, unit, f'{words}, phase={phase}', second, slope, phase)


@pytest.mark.parametrize('unit', ['rad', 'deg'])
def test_linear_coupling(checks, mech9k, unit):
    check_linear_motion(checks, mech9k, unit, "kind='linear', coefficients=5,2, constant=0.7", TURN, -2.5, 0.35)


HELD_RING = "&coupling kind='linear', coordinates=1,4, coefficients=1,1 /\n"
DRIVE = "&drive coordinate={k}, kind='polynomial', coefficients=0,{rate} /\n&time end=2, intervals=4 /\n"


@pytest.mark.parametrize('k', [1, 2, 3, 4])
def test_planetary_gear_with_a_held_ring(checks, mech9k, k):
    """Willis: (sun - carrier) z_sun = -(ring - carrier) z_ring, whichever of them is driven."""
    result = table(mech9k, PLANETARY.format(cq=k) + HELD_RING + DRIVE.format(k=k, rate=3))
    carrier, sun, ring = result['q1'], result['q1'] + result['q2'], result['q1'] + result['q4']
    checks.near(ring, 0 * ring, 1e-12, f'coordinate {k} drives: the ring stands')
    checks.near(sun, carrier * (1 + 52 / 20), 1e-12, f'coordinate {k} drives: the sun turns 1 + 52/20 times as fast')


def test_planetary_gear_with_two_drives(checks, mech9k):
    two = DRIVE.format(k=1, rate=2) + DRIVE.split('\n')[0].format(k=2, rate=-1) + '\n'
    result = table(mech9k, PLANETARY.format(cq='1,2') + two)
    checks.near((result['dq1'] + result['dq2'] - result['dq1']) * 20, -(result['dq4']) * 52, 1e-12, 'two driven: Willis')


def test_planetary_gear_under_a_torque(checks, mech9d):
    """A torque on the sun alone: the torques on sun, carrier and ring must have no moment, and the power must be zero."""
    free = PLANETARY.format(cq='1,2') + "&load kind='torque', link=3, torque=0,0,0.7 /\n" \
        '&initial coordinate=1, position=0 /\n&initial coordinate=2, position=0 /\n&time end=1, intervals=4 /\n' + TIGHT
    result = table(mech9d, free + '&output reactions=.true. /\n')
    checks.near(np.ptp(result['E.kinetic'] - 0.7 * (result['q1'] + result['q2'])), 0, NEAR, 'work of the torque is the energy')
    spin = (0.02 + 0.03**2 + 0.4 * 0.09**2) * result['dq1'] + 0.001 * (result['dq1'] + result['dq2']) \
        + 0.0004 * (result['dq1'] + result['dq3']) + 0.03 * (result['dq1'] + result['dq4'])
    checks.near(spin, 0.7 * result['t'], NEAR, 'the moment of momentum grows by the torque')
    # The equations of single wheels, with C1 and C2 as torques from the carrier's gears.
    checks.near(result['C2'], 0.03 * (result['ddq1'] + result['ddq4']), NEAR, 'the second gear turns the ring')
    checks.near(result['C1'] - 16 / 52 * result['C2'], 0.0004 * (result['ddq1'] + result['ddq3']), NEAR, 'both gears turn the planet')
    checks.near(0.7 + 1.25 * result['C1'], 0.001 * (result['ddq1'] + result['ddq2']), NEAR, 'torque and first gear turn the sun')


def test_differential(checks, mech9d):
    """A bevel differential: the wheels' mean speed is the cage's, and equal torques go to both, whatever their loads."""
    text = """&structure cq=1,2 /
&pair coordinate=1, links=1,2, kind='revolute', axis=1,0,0 /
&pair coordinate=2, links=2,3, kind='revolute', axis=1,0,0 /
&pair coordinate=3, links=2,4, kind='revolute', axis=1,0,0 /
&pair coordinate=4, links=2,5, kind='revolute', axis=0,1,0 /
&coupling kind='gear', coordinates=2,4, ratio=1.5 /
&coupling kind='gear', coordinates=4,3, ratio=-0.66666666666666667 /
&body link=2, mass=1, inertia=0.02,0.02,0.02,0,0,0 /
&body link=3, mass=1, inertia=0.01,0,0,0,0,0 /
&body link=4, mass=1, inertia=0.03,0,0,0,0,0 /
&initial coordinate=1, position=0 /
&initial coordinate=2, position=0 /
&load kind='torque', link=2, torque=2,0,0 /
&load kind='torque', link=3, torque=-0.5,0,0 /
&time end=1, intervals=4 /
&output reactions=.true. /
"""
    result = table(mech9d, text + TIGHT)
    checks.near(result['dq2'] + result['dq3'], 0 * result['dq2'], 1e-12, 'the mean of both wheels is the cage')
    left, right = result['ddq1'] + result['ddq2'], result['ddq1'] + result['ddq3']
    checks.near(0.01 * left + 0.5, 0.03 * right, NEAR, 'both wheels get the same torque')
    checks.near(result['C2'], 0.03 * right, NEAR, 'which is that of the coupling')


def test_five_bar_with_geared_cranks(checks, mech9k):
    """A five-bar linkage whose cranks are geared: its forces are those of the linkage without gear whose cranks have two drives."""
    phase, gear = PHASE_OF_CRANKS, GEAR_OF_CRANKS
    times = '&time end=0.5, intervals=10 /\n&output reactions=.true., drive_forces=.true. /\n'
    geared = table(mech9k, FIVE_BAR.format(cq=1) + gear + times
                   + "&drive coordinate=1, kind='polynomial', coefficients=0.3,1,2 /\n")
    free = table(mech9k, FIVE_BAR.format(cq='1,2') + times
                 + "&drive coordinate=1, kind='polynomial', coefficients=0.3,1,2 /\n"
                 + f"&drive coordinate=2, kind='polynomial', coefficients={phase - 0.6!r},-2,-4 /\n")
    for name in free:
        if name[0] in 'qdPR':
            # rates of the linkage are below ten times those of the cranks, and forces below some tens of newtons
            checks.near(geared[name], free[name], 1e-10, f'geared five-bar: {name} as with two drives')
    checks.near(geared['C1'], free['F2'], 1e-10, 'the force of the gear is that of the second drive')
    checks.near(geared['F1'], free['F1'] - 2 * free['F2'], 1e-10, 'the drive bears both cranks')


def test_five_bar_by_other_coordinates(checks, mech9d):
    """Several choices of the independent coordinate, merged blocks among them."""
    motions, gear = [], GEAR_OF_CRANKS
    for cq in (1, 2, 3, 5):
        text = FIVE_BAR.format(cq=cq) + gear + TIGHT + '&time end=0.6, intervals=6 /\n&output reactions=.true. /\n'
        if not motions:
            text = text.replace('&initial coordinate=1, position=0.3 /', '&initial coordinate=1, position=0.3, velocity=2 /')
        else:
            first = motions[0]
            for k in range(1, 6):
                text = text.replace(f'&initial coordinate={k}, position=', f'&initial coordinate={k}, ! position=')
                rate = f', velocity={float(first[f"dq{k}"][0])!r}' if k == cq else ''
                text += f'&initial coordinate={k}, position={float(first[f"q{k}"][0])!r}{rate} /\n'
            text = ''.join(line for line in text.splitlines(keepends=True) if '! position' not in line)
        motions.append(table(mech9d, text))
        energy = motions[-1]['E.total']
        checks.near(energy, energy[0], NEAR, f'geared five-bar with cq={cq}: energy')
        for name in motions[0]:
            if name[0] in 'qdPRC':
                checks.near(motions[-1][name], motions[0][name], 1e-7, f'geared five-bar with cq={cq}: {name} as with cq=1')


# A helical pair is a revolute and a prismatic pair on one axis with a screw coupling.
WITH_BODY = """&body link={last}, mass=1.2, centre=0.1,0.05,0.02, inertia=0.01,0.02,0.03,0.001,0,0 /
&point name='P', link={last}, position=0.2,0.1,0.3 /
&gravity acceleration=0,-3,-9.81 /
&output reactions=.true., drive_forces=.true. /
"""
ON_AXIS = 'point=0.1,0.2,0.3, axis=1,2,3'
HELICAL = "&structure cq=1 /\n&pair coordinate=1, links=1,2, kind='helical', " + ON_AXIS + ', pitch=0.4 /\n' + WITH_BODY.format(last=2)
COUPLED = "&structure cq=1 /\n&pair coordinate=1, links=1,2, kind='revolute', " + ON_AXIS + ' /\n' \
    "&pair coordinate=2, links=2,3, kind='prismatic', " + ON_AXIS + ' /\n' \
    "&coupling kind='screw', coordinates=1,2, pitch=0.4 /\n" + WITH_BODY.format(last=3)


def test_driven_screw(checks, mech9k):
    drive = "&drive coordinate=1, kind='polynomial', coefficients=0.2,3,-2 /\n&time end=1, intervals=5 /\n"
    one, other = table(mech9k, HELICAL + drive), table(mech9k, COUPLED + drive)
    for name in one:
        if name[0] in 'qdPF':
            checks.near(other[name], one[name], 1e-12, f'screw coupling as a helical pair: {name}')


def test_free_screw(checks, mech9d):
    coupled = COUPLED.replace('pitch=0.4 /', 'pitch=0.4, phase=0 /')
    start = '&initial coordinate=1, position=0.2, velocity=1 /\n&time end=1, intervals=5 /\n' + TIGHT
    one, other = table(mech9d, HELICAL + start), table(mech9d, coupled + start)
    for name in ('q1', 'dq1', 'P.x', 'P.vz', 'E.total'):
        checks.near(other[name], one[name], NEAR, f'screw coupling as a helical pair in mech9d: {name}')


def test_geared_pendulum(checks, mech9d):
    """A pendulum that turns a flywheel by a gear: its frequency, its modes and its matrices in closed form."""
    ratio, inertia, arm, mass, wheel = -3.0, 0.05, 0.4, 1.5, 0.02
    text = f"""&structure cq=1 /
&pair coordinate=1, links=1,2, kind='revolute', axis=0,0,1 /
&pair coordinate=2, links=1,3, kind='revolute', point=1,0,0, axis=0,0,1 /
&coupling kind='gear', coordinates=1,2, ratio={ratio} /
&initial coordinate=1, position=0.1 /
&body link=2, mass={mass}, centre=0,{-arm},0, inertia=0,0,{inertia},0,0,0 /
&body link=3, mass=2, centre=1,0,0, inertia=0,0,{wheel},0,0,0 /
&gravity acceleration=0,-9.81,0 /
"""
    frequency = np.sqrt(mass * 9.81 * arm / (inertia + mass * arm**2 + ratio**2 * wheel)) / (2 * np.pi)
    modes = table(mech9d, text, '--modes')
    checks.near(modes['frequency'], frequency, 1e-11, 'frequency of a geared pendulum')
    checks.near(modes['q2.re'] / modes['q1.re'], ratio, 1e-12, 'its mode turns the wheel')
    rest = table(mech9d, text, '--equilibrium')
    checks.near(rest['q1'], 0, 1e-10, 'it rests below')


WHEELS = TWO_WHEELS.format(unit='rad', second='revolute', axis='0,0,1', words="kind='gear', ratio=2", first=0.5, other=1)


def test_reports_name_couplings(checks, mech9k, tmp_path):
    """Structure, mobility and plan name couplings; redundant ones are told."""
    again = "&coupling kind='belt', coordinates=2,1, radii=1,2 /\n"
    done = output(mech9k, WHEELS + again, '--check')
    checks.true(done.returncode == 0 and '2 couplings' in done.stdout and 'redundant' in done.stdout,
                'a second gear with the same ratio is redundant', done.stdout + done.stderr)
    checks.true('coupling 1 (gear) of coordinates 1, 2' in output(mech9k, WHEELS, '--plan').stdout, 'the plan names the gear')
    output(mech9k, WHEELS, '--graph', tmp_path / 'graph.dot', '--no-write')
    checks.true('2 -- 3 [style=dashed' in text_of(tmp_path / 'graph.dot'), 'the graph has an edge for the gear')


@pytest.mark.parametrize('more, words', [
    ("kind='gear', coordinates=1,3, ratio=2", 'there is no coordinate 3'),
    ("kind='gear', coordinates=1,1, ratio=2", 'named twice'),
    ("kind='gear', coordinates=1,2, ratio=0", 'would not move'),
    ("kind='rack', coordinates=1,2, radius=2", 'one that slides'),
    ("kind='linear', coordinates=1,2, coefficients=2,1,1", '3 coefficients for 2 coordinates'),
    ("kind='gear', coordinates=1,2", 'ratio')],
    ids=['no_such_coordinate', 'coordinate_twice', 'ratio_zero', 'rack_without_a_slide', 'too_many_coefficients', 'no_ratio'])
def test_couplings_that_are_refused(checks, mech9k, more, words):
    done = output(mech9k, WHEELS + f'&coupling {more} /\n')
    checks.true(done.returncode == 3 and words in done.stderr, f'refused: {more}', f'{done.returncode}: {done.stderr}')


def chain_of_wheels(n):
    """Wheels on the frame, each geared to the next one; the first one drives."""
    text = '&structure cq=1 /\n'
    for k in range(1, n + 1):
        text += f"&pair coordinate={k}, links=1,{k + 1}, kind='revolute', point={k},0,0, axis=0,0,1 /\n"
    return text + "&drive coordinate=1, kind='polynomial', coefficients=0,1 /\n" + ''.join(
        f"&coupling kind='gear', coordinates={k},{k + 1}, ratio=-2 /\n" for k in range(1, n))


@pytest.mark.parametrize('more, code, words', [
    # a second gear of wheels 2 and 3; wheels 4 to 6 hang on them
    ('coordinates=2,3, ratio=3', 4, 'couplings 2 (line {second}) and 6 (line {line})'),
    ('coordinates=2,3, ratio=-2, phase=0.3', 5, 'couplings 2 (line {second}) and 6 (line {line})'),
    # a circle of three wheels, in which a third gear turns the last one the wrong way
    ('coordinates=4,2, ratio=-0.25', 4, 'couplings 2 (line {second}), 3 (line {third}) and 6 (line {line})'),
    ('coordinates=2,4, ratio=4, phase=1', 5, 'couplings 2 (line {second}), 3 (line {third}) and 6 (line {line})')],
    ids=['second_gear', 'second_gear_in_phase', 'circle', 'circle_in_phase'])
def test_contradictions_of_wheels(checks, mech9k, more, code, words):
    """Of couplings that contradict each other, just those are named whose equations do, wherever others hang on them."""
    wheels = chain_of_wheels(6)
    line, first = wheels.count('\n') + 1, wheels.count('\n') - 4      # of a further coupling, and of coupling 1
    words = words.format(second=first + 1, third=first + 2, line=line)
    done = output(mech9k, wheels + f"&coupling kind='gear', {more} /\n")
    checks.true(done.returncode == code and words + ' contradict each other' in done.stderr and f':{line}:1' in done.stderr,
                f'named exactly: {more}', f'{done.returncode}: {done.stderr}')


def test_contradiction_of_a_closed_chain(checks, mech9k):
    """A crank and a rocker cannot turn in a fixed ratio: the closed chain is named with the gear, and not the gear that hangs on it."""
    bars = """&structure cq=1 /
&pair coordinate=1, links=1,2, kind='revolute', axis=0,0,1 /
&pair coordinate=2, links=2,3, kind='revolute', point=0.3,0,0, axis=0,0,1, moving_point=0,0,0 /
&pair coordinate=3, links=3,4, kind='revolute', point=1,0,0, axis=0,0,1, moving_point=0.8,0,0 /
&pair coordinate=4, links=1,4, kind='revolute', point=0.9,0,0, axis=0,0,1, moving_point=0,0,0 /
&pair coordinate=5, links=1,5, kind='revolute', point=2,0,0, axis=0,0,1 /
&initial coordinate=1, position=1 /
&initial coordinate=2, position=-0.4 /
&initial coordinate=3, position=0.9 /
&initial coordinate=4, position=1.3 /
&drive coordinate=1, kind='polynomial', coefficients=1,1 /
&coupling kind='gear', coordinates=4,5, ratio=-1 /
&coupling kind='linear', coordinates=1,4, coefficients=0.7,-1, constant=-0.3 /
"""
    done = output(mech9k, bars)
    checks.true(done.returncode == 4 and 'closed chain 1 and coupling 2 (line 13) contradict each other' in done.stderr,
                'a gear that locks a four-bar linkage', f'{done.returncode}: {done.stderr}')


def rates_left(rows):
    """The greatest rate of each coordinate that linear equations between n of them leave."""
    _, singular, basis = np.linalg.svd(rows)
    return np.linalg.norm(basis[np.count_nonzero(singular > 1e-9):], axis=0)


def test_random_contradictions(checks, mech9k):
    """As many random equations as coordinates: those that are named hold a coordinate between them, and no part of them does."""
    random = np.random.default_rng(5)
    named = 0
    for trial in range(25):
        n = int(random.integers(3, 8))
        rows = np.zeros((n, n))
        text = chain_of_wheels(n).split('&coupling')[0]
        first = text.count('\n') + 1
        for row in rows:
            which = random.choice(n, size=2 + int(random.random() < 0.3), replace=False)
            row[which] = random.integers(1, 4, size=len(which)) * random.choice([-1, 1], size=len(which))
            text += f"&coupling kind='linear', coordinates={','.join(str(k + 1) for k in which)}, " \
                f"coefficients={','.join(str(int(c)) for c in row[which])} /\n"
        done = output(mech9k, text)
        held = rates_left(rows) < 1e-9
        if done.returncode == 0:
            checks.true(np.linalg.matrix_rank(rows) == n - 1 and not held[0], f'random equations {trial}: the first wheel moves', text)
            continue
        found = re.search(r'couplings ([^;:]*) contradict each other', done.stderr)
        named += found is not None
        numbers = [int(k) - 1 for k in re.findall(r'(\d+) \(line', found.group(1))] if found else []
        lines = [int(k) for k in re.findall(r'line (\d+)', found.group(1))] if found else []
        checks.true(done.returncode == 4 and lines == [first + k for k in numbers]
                    and (rates_left(rows[numbers]) < 1e-9)[held].any()
                    and not any((rates_left(rows[[k for k in numbers if k != out]]) < 1e-9)[held].any() for out in numbers),
                    f'random equations {trial}: a least set is named', done.stderr + text)
    checks.true(named > 10, 'most random equations contradict each other', str(named))


def random_trains(count):
    """Planetary gears in series, of any size and direction, whose coordinates and couplings stand in any order: data files, the driven
    coordinate, the ratio of each stage and the moments of inertia."""
    random = np.random.default_rng(8)
    for _ in range(count):
        stages, size = int(random.integers(1, 7)), 10.0 ** int(random.integers(-3, 4))
        axis = ','.join(repr(float(x)) for x in random.normal(size=3))
        pairs, couplings, ratios, inertias = '', [], [], random.uniform(0.1, 1, size=4 * stages) * size ** 2
        for s in range(stages):
            sun, planet = (float(10 ** random.uniform(0, 1.5)) for _ in range(2))
            ring = sun + 2 * planet
            ratios.append(1 + ring / sun)
            k, link = 4 * s + 1, 4 * s + 2
            for i, frame in enumerate((1, link, link, link)):
                pairs += f"&pair coordinate={k + i}, links={frame},{link + i}, kind='revolute', " \
                    f"point={(0.1 * s + 0.05 * (i == 2)) * size},0,0, axis={axis} /\n"
                moment = float(inertias[4 * s + i])
                pairs += f'&body link={link + i}, mass=1e-25, inertia={moment!r},{moment!r},{moment!r},0,0,0 /\n'
            couplings += [f"kind='gear', coordinates={k + 1},{k + 2}, ratio={-sun / planet!r}",
                          f"kind='gear', coordinates={k + 2},{k + 3}, ratio={planet / ring!r}",
                          f"kind='linear', coordinates={k},{k + 3}, coefficients=1,1"]
            if s > 0:
                couplings.append(f"kind='linear', coordinates={k - 4},{k},{k + 1}, coefficients=1,-1,-1")
        random.shuffle(couplings)
        driven = int(random.integers(1, 4 * stages + 1))
        yield (f'&structure cq={driven} /\n' + pairs + ''.join(f'&coupling {c} /\n' for c in couplings)
               + f"&drive coordinate={driven}, kind='polynomial', coefficients=0.1,2,1.5 /\n&time end=1, intervals=2 /\n"
               '&output drive_forces=.true. /\n', driven, ratios, inertias)


@pytest.mark.parametrize('text, driven, ratios, inertias', random_trains(12), ids=range(12))
def test_random_trains(checks, mech9k, text, driven, ratios, inertias):
    """The rates are those of Willis' formula in each stage, and the power of the drive is the growth of the kinetic energy."""
    found = table(mech9k, text)
    power = 0
    for s in range(len(ratios)):
        carrier, growth = found[f'dq{4 * s + 1}'], found[f'ddq{4 * s + 1}']
        sun = carrier + found[f'dq{4 * s + 2}']
        checks.near(carrier * ratios[s] / np.max(abs(sun)), sun / np.max(abs(sun)), 1e-12, f'stage {s}: Willis')
        for i in range(4):
            turning = (carrier, growth) if i == 0 else (carrier + found[f'dq{4 * s + 1 + i}'], growth + found[f'ddq{4 * s + 1 + i}'])
            power = power + inertias[4 * s + i] * turning[0] * turning[1]
    # the terms of the wheels cancel by about the ratios of the train, of which some are a hundred
    checks.near(found[f'F{driven}'] * found[f'dq{driven}'] / np.max(power), power / np.max(power), 1e-9, 'power')


HEAVY_WHEELS = chain_of_wheels(4).replace('coefficients=0,1', 'coefficients=0,1,1') + ''.join(
    f'&body link={k}, mass=1, centre={k - 1},0,0, inertia=0,0,{0.1 * k},0,0,0 /\n' for k in range(2, 6)) + '&output reactions=.true. /\n'
TWICE = HEAVY_WHEELS + "&coupling kind='belt', coordinates=2,3, radii=2,1, crossed=.true. /\n&time end=1, intervals=2 /\n"


def test_repeated_gear(checks, mech9k):
    """Couplings that repeat each other: told by name, with forces that are not unique, of least norm; all others keep theirs."""
    text, twice = HEAVY_WHEELS, TWICE
    plain = table(mech9k, text + '&time end=1, intervals=2 /\n')
    found = table(mech9k, twice)
    for name in plain:
        if name != 'C2':
            checks.near(found[name], plain[name], 1e-12, f'a repeated gear: {name} as without it')
    checks.near(found['C2'] + found['C4'], plain['C2'], 1e-12, 'two couplings share the force')
    checks.near(found['C2'], found['C4'], 1e-12, 'in equal parts, which is the least norm')
    done = output(mech9k, twice, '--check')
    checks.true(done.returncode == 0 and 'coupling 4: redundant, it follows from coupling 2;' in done.stdout
                and 'does not determine those of couplings 2, 4,' in done.stdout, 'the check names both', done.stdout + done.stderr)
    done = output(mech9k, text, '--check')
    checks.true('not determine those of couplings' not in done.stdout, 'forces of single gears are unique', done.stdout)


def test_geared_parallelogram(checks, mech9k):
    """A gear between the cranks: its torque and a pair of forces along the coupler, which turns with link 3, are not unique."""
    parallelogram = PARALLELOGRAM + '&output reactions=.true., drive_forces=.true. /\n&time end=1, intervals=2 /\n'
    geared = parallelogram + "&coupling kind='gear', coordinates=1,4, ratio=1 /\n"
    done = output(mech9k, geared, '--check')
    checks.true(all(line in done.stdout for line in (
        'coupling 1: redundant, it follows from closed chain 1;', '\n  pair 1: force along x y z, moment about x y z;', '\n  pair 2: force along x z, moment about x y;',
        '\n  pair 3: force along x y z, moment about x y;', '\n  pair 4: force along x y z, moment about x y z;')), 'a geared parallelogram', done.stdout + done.stderr)
    plain, found = table(mech9k, parallelogram), table(mech9k, geared)
    for name in plain:
        checks.near(found[name], plain[name], 1e-12, f'geared parallelogram: {name} as without the gear, whose least force is none')


def test_results_tell_repeated_couplings(checks, mech9k, tmp_path):
    (tmp_path / 'case.nml').write_text(TWICE, encoding='utf-8')
    done = run(mech9k, 'case.nml', '--report', 'report.json', '--hdf5', 'case.h5', folder=tmp_path)
    report = json.loads(text_of(tmp_path / 'report.json'))
    checks.true([c['unique'] for c in report['couplings']] == [True, False, True, False], 'the report tells it', str(report))
    checks.true('those of couplings 2, 4,' in done.stderr, 'the run tells it', done.stderr)
    try:
        import h5py
    except ImportError:
        checks.left_out('h5py is not installed (Debian: python3-h5py)')
        return
    with h5py.File(tmp_path / 'case.h5', 'r') as file:
        checks.true(list(file['coupling_unique'][()]) == [1, 0, 1, 0], 'the HDF5 file tells it')
