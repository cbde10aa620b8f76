"""Couplings of coordinates: gears, racks, belts and screws against closed forms, among them Willis' formula for planetary gears, of
which there are random trains, and the differential; a geared five-bar linkage against the same linkage without its gear, whose cranks
are both driven; a screw against a helical pair; reactions and modes against equations of motion of their own; energy; tables with and
without ends; couplings that repeat or contradict each other, these against all parts of them; refusals with place and remedy.

Compares the program with itself in part: other choices of independent coordinates give the same motion.

usage: couplings.py MECH9K MECH9D
"""
import json
import os
import re
import sys
import tempfile

import numpy as np

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), '..', 'scripts'))
from mech9_cases import Checks, read_table, run, text_of

# Round-off of a few operations on numbers of about one.
ROUND_OFF = 1e-13
TIGHT = '&solver relative_tolerance=1e-11, absolute_tolerance=1e-12 /\n'
# Errors of steps at 1e-11 add up over some hundred steps of motions that do not enlarge them: 100 tolerances.
NEAR = 1e-9

TWO_WHEELS = """&mechanism angle_unit='{unit}' /
&structure cq=1 /
&pair coordinate=1, links=1,2, kind='revolute', axis=0,0,1 /
&pair coordinate=2, links=1,3, kind='{second}', point=0.3,0.1,0, axis={axis} /
&coupling coordinates=1,2, {words} /
&initial coordinate=1, position={first} /
&initial coordinate=2, position={other} /
&drive coordinate=1, kind='polynomial', coefficients={first},2,0.5 /
&time end=1, intervals=5 /
"""

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
GEAR_OF_CRANKS = "&coupling kind='gear', coordinates=1,2, ratio=-2, phase={phase!r} /\n"


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


def table(program, text, *options):
    """The table of a run of a data file with this text; an exception with the messages where the run fails."""
    with tempfile.TemporaryDirectory() as folder:
        path = os.path.join(folder, 'case.nml')
        with open(path, 'w', encoding='utf-8') as file:
            file.write(text)
        done = run(program, path, '--table', os.path.join(folder, 'table'), *options, folder=folder)
        if done.returncode != 0:
            raise RuntimeError(f'{text}\nended with {done.returncode}:\n{done.stderr}')
        return read_table(text_of(os.path.join(folder, 'table')))


def output(program, text, *options):
    """The finished run of a data file with this text."""
    with tempfile.TemporaryDirectory() as folder:
        path = os.path.join(folder, 'case.nml')
        with open(path, 'w', encoding='utf-8') as file:
            file.write(text)
        return run(program, path, *options, folder=folder)


def check_linear_kinds(checks, kinematics):
    """Two wheels, or a wheel and a slide: the second coordinate follows in position, rate and acceleration."""
    turn, slide = ('revolute', '0,0,1'), ('prismatic', '1,0,0')
    for unit in ('rad', 'deg'):
        per_radian = 1.0 if unit == 'rad' else np.pi / 180
        for words, (second, axis), slope in (
                ("kind='gear', ratio=-2.5", turn, -2.5), ("kind='belt', radii=0.05,0.1", turn, 0.5),
                ("kind='belt', radii=0.05,0.1, crossed=.true.", turn, -0.5),
                ("kind='rack', radius=0.02", slide, 0.02 * per_radian),
                ("kind='screw', pitch=0.005", slide, 0.005 * per_radian / (2 * np.pi)),
                ("kind='linear', coefficients=5,2, constant=0.7", turn, None)):
            for phase in ('', ', phase=0.25'):
                if slope is None and phase:
                    continue
                text = TWO_WHEELS.format(unit=unit, second=second, axis=axis, words=words + phase, first=0.4, other=0.9)
                result = table(kinematics, text)
                rate, constant = slope, 0.25 if phase else None
                if slope is None:
                    rate, constant = -2.5, 0.35
                elif constant is None:
                    constant = 0.9 - slope * 0.4
                checks.near(result['q2'], rate * result['q1'] + constant, ROUND_OFF, f'{words}{phase} in {unit}: position')
                checks.near(result['dq2'], rate * result['dq1'], ROUND_OFF, f'{words} in {unit}: rate')
                checks.near(result['ddq2'], rate * result['ddq1'], ROUND_OFF, f'{words} in {unit}: acceleration')


def check_planetary(checks, kinematics, dynamics):
    """Willis: (sun - carrier) z_sun = -(ring - carrier) z_ring, whichever of the three is driven or held."""
    held_ring = "&coupling kind='linear', coordinates=1,4, coefficients=1,1 /\n"
    drive = "&drive coordinate={k}, kind='polynomial', coefficients=0,{rate} /\n&time end=2, intervals=4 /\n"
    for k in (1, 2, 3, 4):
        result = table(kinematics, PLANETARY.format(cq=k) + held_ring + drive.format(k=k, rate=3))
        carrier, sun, ring = result['q1'], result['q1'] + result['q2'], result['q1'] + result['q4']
        checks.near(ring, 0 * ring, 1e-12, f'coordinate {k} drives: the ring stands')
        checks.near(sun, carrier * (1 + 52 / 20), 1e-12, f'coordinate {k} drives: the sun turns 1 + 52/20 times as fast')
    two = drive.format(k=1, rate=2) + drive.split('\n')[0].format(k=2, rate=-1) + '\n'
    result = table(kinematics, PLANETARY.format(cq='1,2') + two)
    checks.near((result['dq1'] + result['dq2'] - result['dq1']) * 20, -(result['dq4']) * 52, 1e-12, 'two driven: Willis')
    # A torque on the sun alone: the torques on sun, carrier and ring must have no moment, and the power must be zero.
    free = PLANETARY.format(cq='1,2') + "&load kind='torque', link=3, torque=0,0,0.7 /\n" \
        '&initial coordinate=1, position=0 /\n&initial coordinate=2, position=0 /\n&time end=1, intervals=4 /\n' + TIGHT
    result = table(dynamics, free + '&output reactions=.true. /\n')
    checks.near(np.ptp(result['E.kinetic'] - 0.7 * (result['q1'] + result['q2'])), 0, NEAR, 'work of the torque is the energy')
    spin = (0.02 + 0.03**2 + 0.4 * 0.09**2) * result['dq1'] + 0.001 * (result['dq1'] + result['dq2']) \
        + 0.0004 * (result['dq1'] + result['dq3']) + 0.03 * (result['dq1'] + result['dq4'])
    checks.near(spin, 0.7 * result['t'], NEAR, 'the moment of momentum grows by the torque')
    # The equations of single wheels, with C1 and C2 as torques from the carrier's gears.
    checks.near(result['C2'], 0.03 * (result['ddq1'] + result['ddq4']), NEAR, 'the second gear turns the ring')
    checks.near(result['C1'] - 16 / 52 * result['C2'], 0.0004 * (result['ddq1'] + result['ddq3']), NEAR, 'both gears turn the planet')
    checks.near(0.7 + 1.25 * result['C1'], 0.001 * (result['ddq1'] + result['ddq2']), NEAR, 'torque and first gear turn the sun')


def check_differential(checks, dynamics):
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
    result = table(dynamics, text + TIGHT)
    checks.near(result['dq2'] + result['dq3'], 0 * result['dq2'], 1e-12, 'the mean of both wheels is the cage')
    left, right = result['ddq1'] + result['ddq2'], result['ddq1'] + result['ddq3']
    checks.near(0.01 * left + 0.5, 0.03 * right, NEAR, 'both wheels get the same torque')
    checks.near(result['C2'], 0.03 * right, NEAR, 'which is that of the coupling')


def check_five_bar(checks, kinematics, dynamics):
    """A five-bar linkage whose cranks are geared: its forces are those of the linkage without gear whose cranks have two drives."""
    phase = 1.1 + 2 * 0.3
    gear = GEAR_OF_CRANKS.format(phase=phase)
    times = '&time end=0.5, intervals=10 /\n&output reactions=.true., drive_forces=.true. /\n'
    geared = table(kinematics, FIVE_BAR.format(cq=1) + gear + times
                   + "&drive coordinate=1, kind='polynomial', coefficients=0.3,1,2 /\n")
    free = table(kinematics, FIVE_BAR.format(cq='1,2') + times
                 + "&drive coordinate=1, kind='polynomial', coefficients=0.3,1,2 /\n"
                 + f"&drive coordinate=2, kind='polynomial', coefficients={phase - 0.6!r},-2,-4 /\n")
    for name in free:
        if name[0] in 'qdPR':
            # rates of the linkage are below ten times those of the cranks, and forces below some tens of newtons
            checks.near(geared[name], free[name], 1e-10, f'geared five-bar: {name} as with two drives')
    checks.near(geared['C1'], free['F2'], 1e-10, 'the force of the gear is that of the second drive')
    checks.near(geared['F1'], free['F1'] - 2 * free['F2'], 1e-10, 'the drive bears both cranks')
    # mech9d with several choices of the independent coordinate, merged blocks among them
    motions = []
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
        motions.append(table(dynamics, text))
        energy = motions[-1]['E.total']
        checks.near(energy, energy[0], NEAR, f'geared five-bar with cq={cq}: energy')
        for name in motions[0]:
            if name[0] in 'qdPRC':
                checks.near(motions[-1][name], motions[0][name], 1e-7, f'geared five-bar with cq={cq}: {name} as with cq=1')


def check_screw(checks, kinematics, dynamics):
    """A helical pair is a revolute and a prismatic pair on one axis with a screw coupling."""
    common = """&body link={last}, mass=1.2, centre=0.1,0.05,0.02, inertia=0.01,0.02,0.03,0.001,0,0 /
&point name='P', link={last}, position=0.2,0.1,0.3 /
&gravity acceleration=0,-3,-9.81 /
&output reactions=.true., drive_forces=.true. /
"""
    axis = 'point=0.1,0.2,0.3, axis=1,2,3'
    helical = "&structure cq=1 /\n&pair coordinate=1, links=1,2, kind='helical', " + axis + ', pitch=0.4 /\n' + common.format(last=2)
    coupled = "&structure cq=1 /\n&pair coordinate=1, links=1,2, kind='revolute', " + axis + ' /\n' \
        "&pair coordinate=2, links=2,3, kind='prismatic', " + axis + ' /\n' \
        "&coupling kind='screw', coordinates=1,2, pitch=0.4 /\n" + common.format(last=3)
    drive = "&drive coordinate=1, kind='polynomial', coefficients=0.2,3,-2 /\n&time end=1, intervals=5 /\n"
    one, other = table(kinematics, helical + drive), table(kinematics, coupled + drive)
    for name in one:
        if name[0] in 'qdPF':
            checks.near(other[name], one[name], 1e-12, f'screw coupling as a helical pair: {name}')
    coupled = coupled.replace('pitch=0.4 /', 'pitch=0.4, phase=0 /')
    start = '&initial coordinate=1, position=0.2, velocity=1 /\n&time end=1, intervals=5 /\n' + TIGHT
    one, other = table(dynamics, helical + start), table(dynamics, coupled + start)
    for name in ('q1', 'dq1', 'P.x', 'P.vz', 'E.total'):
        checks.near(other[name], one[name], NEAR, f'screw coupling as a helical pair in mech9d: {name}')


def check_pendulum(checks, dynamics):
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
    modes = table(dynamics, text, '--modes')
    checks.near(modes['frequency'], frequency, 1e-11, 'frequency of a geared pendulum')
    checks.near(modes['q2.re'] / modes['q1.re'], ratio, 1e-12, 'its mode turns the wheel')
    rest = table(dynamics, text, '--equilibrium')
    checks.near(rest['q1'], 0, 1e-10, 'it rests below')


def check_reports(checks, kinematics):
    """Structure, mobility and plan name couplings; redundant ones are told; contradictions are refused with their place."""
    wheels = TWO_WHEELS.format(unit='rad', second='revolute', axis='0,0,1', words="kind='gear', ratio=2", first=0.5, other=1)
    again = "&coupling kind='belt', coordinates=2,1, radii=1,2 /\n"
    done = output(kinematics, wheels + again, '--check')
    checks.true(done.returncode == 0 and '2 couplings' in done.stdout and 'redundant' in done.stdout,
                'a second gear with the same ratio is redundant', done.stdout + done.stderr)
    checks.true('coupling 1 (gear) of coordinates 1, 2' in output(kinematics, wheels, '--plan').stdout, 'the plan names the gear')
    with tempfile.TemporaryDirectory() as folder:
        with open(os.path.join(folder, 'case.nml'), 'w', encoding='utf-8') as file:
            file.write(wheels)
        run(kinematics, 'case.nml', '--graph', 'graph.dot', '--no-write', folder=folder)
        checks.true('2 -- 3 [style=dashed' in text_of(os.path.join(folder, 'graph.dot')), 'the graph has an edge for the gear')
    for more, code, words in (
            ("&coupling kind='gear', coordinates=1,3, ratio=2 /\n", (3,), 'there is no coordinate 3'),
            ("&coupling kind='gear', coordinates=1,1, ratio=2 /\n", (3,), 'named twice'),
            ("&coupling kind='gear', coordinates=1,2, ratio=0 /\n", (3,), 'would not move'),
            ("&coupling kind='rack', coordinates=1,2, radius=2 /\n", (3,), 'one that slides'),
            ("&coupling kind='linear', coordinates=1,2, coefficients=2,1,1 /\n", (3,), '3 coefficients for 2 coordinates'),
            ("&coupling kind='gear', coordinates=1,2 /\n", (3,), 'ratio')):
        done = output(kinematics, wheels + more)
        checks.true(done.returncode in code and words in done.stderr, f'refused: {more}', f'{done.returncode}: {done.stderr}')


def chain_of_wheels(n):
    """Wheels on the frame, each geared to the next one; the first one drives."""
    text = '&structure cq=1 /\n'
    for k in range(1, n + 1):
        text += f"&pair coordinate={k}, links=1,{k + 1}, kind='revolute', point={k},0,0, axis=0,0,1 /\n"
    return text + "&drive coordinate=1, kind='polynomial', coefficients=0,1 /\n" + ''.join(
        f"&coupling kind='gear', coordinates={k},{k + 1}, ratio=-2 /\n" for k in range(1, n))


def check_contradictions(checks, kinematics):
    """Of couplings that contradict each other, just those are named whose equations do, wherever others hang on them."""
    wheels = chain_of_wheels(6)
    line, first = wheels.count('\n') + 1, wheels.count('\n') - 4      # of a further coupling, and of coupling 1
    for more, code, words in (
            # a second gear of wheels 2 and 3; wheels 4 to 6 hang on them
            ("&coupling kind='gear', coordinates=2,3, ratio=3 /\n", 4, f'couplings 2 (line {first + 1}) and 6 (line {line})'),
            ("&coupling kind='gear', coordinates=2,3, ratio=-2, phase=0.3 /\n", 5, f'couplings 2 (line {first + 1}) and 6 (line {line})'),
            # a circle of three wheels, in which a third gear turns the last one the wrong way
            ("&coupling kind='gear', coordinates=4,2, ratio=-0.25 /\n", 4,
             f'couplings 2 (line {first + 1}), 3 (line {first + 2}) and 6 (line {line})'),
            ("&coupling kind='gear', coordinates=2,4, ratio=4, phase=1 /\n", 5,
             f'couplings 2 (line {first + 1}), 3 (line {first + 2}) and 6 (line {line})')):
        done = output(kinematics, wheels + more)
        checks.true(done.returncode == code and words + ' contradict each other' in done.stderr and f':{line}:1' in done.stderr,
                    f'named exactly: {more}', f'{done.returncode}: {done.stderr}')
    # a crank and a rocker cannot turn in a fixed ratio: the closed chain is named with the gear, and not the gear that hangs on it
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
    done = output(kinematics, bars)
    checks.true(done.returncode == 4 and 'closed chain 1 and coupling 2 (line 13) contradict each other' in done.stderr,
                'a gear that locks a four-bar linkage', f'{done.returncode}: {done.stderr}')


def rates_left(rows):
    """The greatest rate of each coordinate that linear equations between n of them leave."""
    _, singular, basis = np.linalg.svd(rows)
    return np.linalg.norm(basis[np.count_nonzero(singular > 1e-9):], axis=0)


def check_random_contradictions(checks, kinematics):
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
        done = output(kinematics, text)
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


def check_random_trains(checks, kinematics):
    """Planetary gears in series, of any size and direction, whose coordinates and couplings stand in any order: the rates are those of
    Willis' formula in each stage, and the power of the drive is the growth of the kinetic energy."""
    random = np.random.default_rng(8)
    for trial in range(12):
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
        found = table(kinematics, f'&structure cq={driven} /\n' + pairs + ''.join(f'&coupling {c} /\n' for c in couplings)
                      + f"&drive coordinate={driven}, kind='polynomial', coefficients=0.1,2,1.5 /\n&time end=1, intervals=2 /\n"
                      '&output drive_forces=.true. /\n')
        power = 0
        for s in range(stages):
            carrier, growth = found[f'dq{4 * s + 1}'], found[f'ddq{4 * s + 1}']
            sun = carrier + found[f'dq{4 * s + 2}']
            checks.near(carrier * ratios[s] / np.max(abs(sun)), sun / np.max(abs(sun)), 1e-12, f'train {trial}, stage {s}: Willis')
            for i in range(4):
                turning = (carrier, growth) if i == 0 else (carrier + found[f'dq{4 * s + 1 + i}'], growth + found[f'ddq{4 * s + 1 + i}'])
                power = power + inertias[4 * s + i] * turning[0] * turning[1]
        # the terms of the wheels cancel by about the ratios of the train, of which some are a hundred
        checks.near(found[f'F{driven}'] * found[f'dq{driven}'] / np.max(power), power / np.max(power), 1e-9, f'train {trial}: power')


def check_repetitions(checks, kinematics):
    """Couplings that repeat each other: told by name, with forces that are not unique, of least norm; all others keep theirs."""
    masses = ''.join(f'&body link={k}, mass=1, centre={k - 1},0,0, inertia=0,0,{0.1 * k},0,0,0 /\n' for k in range(2, 6))
    text = chain_of_wheels(4).replace('coefficients=0,1', 'coefficients=0,1,1') + masses + '&output reactions=.true. /\n'
    plain = table(kinematics, text + '&time end=1, intervals=2 /\n')
    twice = text + "&coupling kind='belt', coordinates=2,3, radii=2,1, crossed=.true. /\n&time end=1, intervals=2 /\n"
    found = table(kinematics, twice)
    for name in plain:
        if name != 'C2':
            checks.near(found[name], plain[name], 1e-12, f'a repeated gear: {name} as without it')
    checks.near(found['C2'] + found['C4'], plain['C2'], 1e-12, 'two couplings share the force')
    checks.near(found['C2'], found['C4'], 1e-12, 'in equal parts, which is the least norm')
    done = output(kinematics, twice, '--check')
    checks.true(done.returncode == 0 and 'coupling 4: redundant, it follows from coupling 2;' in done.stdout
                and 'does not determine those of couplings 2, 4,' in done.stdout, 'the check names both', done.stdout + done.stderr)
    done = output(kinematics, text, '--check')
    checks.true('not determine those of couplings' not in done.stdout, 'forces of single gears are unique', done.stdout)
    # a gear between the cranks of a parallelogram: its torque and a pair of forces along the coupler, which turns with link 3
    parallelogram = PARALLELOGRAM + '&output reactions=.true., drive_forces=.true. /\n&time end=1, intervals=2 /\n'
    geared = parallelogram + "&coupling kind='gear', coordinates=1,4, ratio=1 /\n"
    done = output(kinematics, geared, '--check')
    checks.true(all(line in done.stdout for line in (
        'coupling 1: redundant, it follows from closed chain 1;', '\n  R1: fx fy fz mx my mz\n', '\n  R2: fx fz mx my\n',
        '\n  R3: fx fy fz mx my\n', '\n  R4: fx fy fz mx my mz')), 'a geared parallelogram', done.stdout + done.stderr)
    plain, found = table(kinematics, parallelogram), table(kinematics, geared)
    for name in plain:
        checks.near(found[name], plain[name], 1e-12, f'geared parallelogram: {name} as without the gear, whose least force is none')
    with tempfile.TemporaryDirectory() as folder:
        with open(os.path.join(folder, 'case.nml'), 'w', encoding='utf-8') as file:
            file.write(twice)
        done = run(kinematics, 'case.nml', '--report', 'report.json', '--hdf5', 'case.h5', folder=folder)
        with open(os.path.join(folder, 'report.json'), encoding='utf-8') as file:
            report = json.load(file)
        checks.true([c['unique'] for c in report['couplings']] == [True, False, True, False], 'the report tells it', str(report))
        checks.true('those of couplings 2, 4,' in done.stderr, 'the run tells it', done.stderr)
        try:
            import h5py
        except ImportError:
            checks.left_out('h5py is not installed (Debian: python3-h5py)')
            return
        with h5py.File(os.path.join(folder, 'case.h5'), 'r') as file:
            checks.true(list(file['coupling_unique'][()]) == [1, 0, 1, 0], 'the HDF5 file tells it')


def check_tables_with_ends(checks, kinematics, dynamics):
    """Tables over a slide, and over a part of a turn: they end with their points, where the motion stops with its time."""
    with tempfile.TemporaryDirectory() as folder:
        path = os.path.join(folder, 'law.dat')
        x = np.linspace(-0.2, 0.5, 71)
        np.savetxt(path, np.column_stack([x, 0.3 * np.sin(4 * x)]), fmt='%.17g')
        slides = f"""&structure cq={{cq}} /
&pair coordinate=1, links=1,2, kind='prismatic', axis=1,0,0 /
&pair coordinate=2, links=1,3, kind='prismatic', axis=0,1,0 /
&coupling kind='table', coordinates=1,2, file='{path}' /
&body link=2, mass=2 /
&body link=3, mass=1 /
&time end={{end}}, intervals=20 /
&output reactions=.true. /
"""
        drive = "&drive coordinate=1, kind='polynomial', coefficients=-0.2,0.7 /\n"
        found = table(kinematics, slides.format(cq=1, end=1) + drive)
        q = found['q1']
        # at the ends the spline has the derivatives of the polynomial through six points at steps of h = 0.01, which miss those of
        # the wave by parts of its sixth derivative, 0.3 4^6: h^5/6 of the first one, 2e-8, and about h^4/2 of the second one, 6e-6
        checks.near(found['q2'], 0.3 * np.sin(4 * q), 1e-11, 'a table over a slide')
        checks.near(found['dq2'], 1.2 * np.cos(4 * q) * 0.7, 5e-8, 'its rate')
        checks.near(found['ddq2'], -4.8 * np.sin(4 * q) * 0.49, 1e-5, 'its acceleration')
        done = output(kinematics, slides.format(cq=1, end=1.2) + drive)
        words = ('coordinate 1 comes to an end of the table of coupling 1', 'from -0.2 to 0.5 m', ':4:1')
        checks.true(done.returncode == 6 and all(word in done.stderr for word in words), 'the drive leaves the table',
                    f'{done.returncode}: {done.stderr}')
        # free: energy is kept until the slide comes to the end
        start = '&initial coordinate=1, position=0, velocity=0.5 /\n' + TIGHT
        found = table(dynamics, slides.format(cq=1, end=0.5) + start)
        checks.near(found['E.total'], found['E.total'][0], NEAR, 'energy on a table over a slide')
        done = output(dynamics, slides.format(cq=1, end=9) + start)
        checks.true(done.returncode == 6 and all(word in done.stderr for word in words), 'the motion leaves the table',
                    f'{done.returncode}: {done.stderr}')
        # degrees, and a wheel over a part of a turn
        path = os.path.join(folder, 'part.dat')
        x = np.linspace(-30, 60, 91)
        np.savetxt(path, np.column_stack([x, 20 * np.sin(np.radians(x))]), fmt='%.17g')
        wheels = TWO_WHEELS.format(unit='deg', second='revolute', axis='0,0,1', words=f"kind='table', file='{path}'", first=-30, other=-10)
        found = table(kinematics, wheels.replace('-30,2,0.5', '-30,90'))
        checks.near(found['q2'], 20 * np.sin(np.radians(found['q1'])), 1e-9, 'a table over a part of a turn, in degrees')
        done = output(kinematics, wheels.replace('-30,2,0.5', '-30,95'))
        checks.true(done.returncode == 6 and 'from -30 to 60 deg' in done.stderr, 'it does not repeat', f'{done.returncode}: {done.stderr}')


def check_tables(checks, kinematics, dynamics):
    """Couplings by tables: a cam with a harmonic law, a gear that is not round, and what is refused."""
    turn = np.linspace(0, 2 * np.pi, 361)
    # A quintic spline over steps of h misses sin by about h^6/1000 = 3e-14 (O(h^6) with a small constant), its slopes and curvatures by
    # h^5 and h^4 times as small constants: 1e-12 and 1e-10.
    near = {'q2': 1e-12, 'dq2': 1e-10, 'ddq2': 1e-8}
    with tempfile.TemporaryDirectory() as folder:
        def write(name, x, y):
            path = os.path.join(folder, name)
            np.savetxt(path, np.column_stack([x, y]), fmt='%.17g')
            return path

        # several turns of the cam, from before its table to beyond it
        cam = write('cam.dat', turn, 0.01 * (1 - np.cos(turn)))
        text = TWO_WHEELS.format(unit='rad', second='prismatic', axis='0,1,0', words=f"kind='table', file='{cam}'", first=-9, other=0)
        found = table(kinematics, text.replace('-9,2,0.5', '-9,20,0.5'), '--set', 'time.intervals=50')
        q, dq, ddq = found['q1'], found['dq1'], found['ddq1']
        true = {'q2': 0.01 * (1 - np.cos(q)), 'dq2': 0.01 * np.sin(q) * dq,
                'ddq2': 0.01 * (np.cos(q) * dq ** 2 + np.sin(q) * ddq)}
        for name, values in true.items():
            checks.near(found[name], values, near[name], f'cam by a table: {name}')

        # a wheel that turns twice as far as the first one, unevenly, in degrees
        wheel = write('wheel.dat', np.degrees(turn), np.degrees(2 * turn + 0.3 * np.sin(turn)))
        text = TWO_WHEELS.format(unit='deg', second='revolute', axis='0,0,1', words=f"kind='table', file='{wheel}'", first=700, other=1400)
        found = table(kinematics, text.replace('700,2,', '700,200,'), '--set', 'time.intervals=20')
        q = np.radians(found['q1'])
        checks.near(np.radians(found['q2']), 2 * q + 0.3 * np.sin(q), 1e-11, 'a gear that is not round')
        checks.near(np.radians(found['dq2']), (2 + 0.3 * np.cos(q)) * np.radians(found['dq1']), 1e-9, 'its rate')

        # a flywheel drives a sprung follower with mass through the cam: energy, and the law of the follower
        text = f"""&structure cq=1 /
&pair coordinate=1, links=1,2, kind='revolute', axis=0,0,1 /
&pair coordinate=2, links=1,3, kind='prismatic', axis=0,1,0, point=0,0.1,0 /
&coupling kind='table', coordinates=1,2, file='{cam}' /
&initial coordinate=1, position=0.4, velocity=5 /
&body link=2, mass=1, inertia=0,0,0.05,0,0,0 /
&body link=3, mass=0.5 /
&load kind='coordinate', coordinate=2, stiffness=40, rest=-0.01 /
&gravity acceleration=0,-9.81,0 /
&time end=5, intervals=100 /
&output reactions=.true. /
"""
        found = table(dynamics, text + TIGHT)
        q, dq, ddq = found['q1'], found['dq1'], found['ddq1']
        energy = found['E.total']
        checks.near(energy, np.full_like(energy, energy[0]), NEAR, 'the energy of a cam and its follower stays')
        checks.true(np.ptp(q) > 2 * np.pi, 'the cam turns more than once', str(np.ptp(q)))
        checks.near(found['q2'], 0.01 * (1 - np.cos(q)), 1e-12, 'the follower keeps its law in dynamics')
        # Newton's law of the follower: its acceleration by closed form, the forces of spring and weight, and that of the cam
        rise = 0.01 * (np.cos(q) * dq ** 2 + np.sin(q) * ddq)
        checks.near(found['C1'], 0.5 * rise + 0.5 * 9.81 + 40 * (found['q2'] + 0.01), 1e-8, 'the force of the cam on its follower')
        other = table(dynamics, text.replace('cq=1', 'cq=2').replace(
            '&initial coordinate=1, position=0.4, velocity=5 /',
            f'&initial coordinate=2, position={float(0.01 * (1 - np.cos(0.4)))!r}, velocity={float(0.05 * np.sin(0.4))!r} /\n'
            '&initial coordinate=1, position=0.4 /') + TIGHT)
        checks.near(other['q1'], q, 1e-7, 'the follower as the independent coordinate: through its dead points')

        # a torque holds the cam on its slope: V'' = S'' f + S'^2 k and M = J + m S'^2, with the force f of spring and weight
        rest = text.replace('velocity=5', 'velocity=0') + "&load kind='coordinate', coordinate=1, force=0.02 /\n"
        modes = table(dynamics, rest, '--modes')
        q = table(dynamics, rest, '--equilibrium')['q1'][0]
        slope, bend = 0.01 * np.sin(q), 0.01 * np.cos(q)
        force = 40 * (0.02 - 0.01 * np.cos(q)) + 0.5 * 9.81
        checks.near(slope * force, 0.02, 1e-12, 'the torque holds the cam')
        checks.near(modes['eigenvalue.im'][0] ** 2, (bend * force + 40 * slope ** 2) / (0.05 + 0.5 * slope ** 2), 1e-8,
                    'the frequency of the cam about its place of rest')

        broken = {'jump.dat': (turn, 0.1 * turn, 'would jump'),
                  'back.dat': (-turn, turn, 'q1 must increase')}
        for name, (x, y, words) in broken.items():
            text = TWO_WHEELS.format(unit='rad', second='prismatic', axis='0,1,0', words=f"kind='table', file='{write(name, x, y)}'",
                                     first=0, other=0)
            done = output(kinematics, text)
            checks.true(done.returncode == 3 and words in done.stderr, f'refused: {name}', f'{done.returncode}: {done.stderr}')
        text = TWO_WHEELS.format(unit='rad', second='prismatic', axis='0,1,0', words=f"kind='table', file='{cam}'", first=0, other=0)
        done = output(kinematics, text.replace(cam, 'missing.dat'))
        checks.true(done.returncode == 8 and 'missing.dat' in done.stderr, 'refused: no file', f'{done.returncode}: {done.stderr}')


def main(kinematics, dynamics):
    checks = Checks()
    check_linear_kinds(checks, kinematics)
    check_planetary(checks, kinematics, dynamics)
    check_differential(checks, dynamics)
    check_five_bar(checks, kinematics, dynamics)
    check_screw(checks, kinematics, dynamics)
    check_pendulum(checks, dynamics)
    check_reports(checks, kinematics)
    check_contradictions(checks, kinematics)
    check_random_contradictions(checks, kinematics)
    check_random_trains(checks, kinematics)
    check_repetitions(checks, kinematics)
    check_tables(checks, kinematics, dynamics)
    check_tables_with_ends(checks, kinematics, dynamics)
    checks.finish()


main(*sys.argv[1:])
