"""Drives in dynamics: driven coordinates move as in mech9k, the others by closed forms, by all methods; with all coordinates driven
nothing is integrated; driven coordinates stay driven where others are exchanged; dead points, contradictions and drives of
dependent coordinates are told with place, time and remedy.

Compares the program with itself in part: driven chains in both programs, and one motion in several independent coordinates; all else is
closed forms.
"""
import math
import os
import re

import pytest

from mech9_cases import read_table, run, table_of, text_of

G = 9.81
TIGHT = '&solver relative_tolerance=1e-11, absolute_tolerance=1e-12 /\n'
METHODS = ('auto', 'prince-dormand', 'dormand-prince', 'verner', 'fehlberg', 'merson', 'adams', 'bdf')
WEIGHT = f'&gravity acceleration=0,-{G},0 /\n'

FOUR_BAR = """&pair coordinate=1, links=1,2, kind='revolute', axis=0,0,1 /
&pair coordinate=2, links=2,3, kind='revolute', point={crank},0,0, axis=0,0,1 /
&pair coordinate=3, links=4,3, kind='revolute', point=0.7,0.7,0, axis=0,0,1 /
&pair coordinate=4, links=1,4, kind='revolute', point=0.9,0,0, axis=0,0,1 /
&body link=2, mass=1, centre=0.1,0,0, inertia=0.02,0.02,0.02,0,0,0 /
&body link=3, mass=2, centre=0.5,0.3,0, inertia=0.1,0.1,0.1,0,0,0 /
&drive coordinate=1, kind='polynomial', coefficients={drive} /
"""
HANGING = """&pair coordinate=5, links=3,5, kind='revolute', point=0.5,0.4,0, axis={axis} /
&body link=5, mass=2, centre=0.5,0.1,0.2, inertia=0.1,0.1,0.1,0,0,0 /
&initial coordinate=5, position=0.4, velocity=0.1 /
"""
CRANK = {'crank': '0.3', 'drive': '0.2,6,0.3'}
TIME = '&time start=0, end=2, intervals=20 /\n'


class Files:
    """Data files in a folder of their own."""

    def __init__(self, folder):
        self.folder = folder

    def write(self, text, name='case.nml'):
        path = os.path.join(self.folder, name)
        with open(path, 'w', encoding='utf-8') as file:
            file.write(text)
        return path


@pytest.fixture
def files(tmp_path):
    return Files(tmp_path)


def mixed(axis='0,0,1', cq='1,5', crank=CRANK):
    return f'&structure cq={cq} /\n' + FOUR_BAR.format(**crank) + HANGING.format(axis=axis) + TIME + WEIGHT


def alone(crank=CRANK):
    return '&structure cq=1 /\n' + FOUR_BAR.format(**crank) + TIME + WEIGHT


def test_driven_four_bar(checks, files, mech9k, mech9d):
    """A driven four-bar, alone and with a free pendulum on its coupler, in the plane and across it. Positions close to round-off,
    and accelerations lose two digits."""
    expected = table_of(mech9k, files.write(alone()))
    inverse = table_of(mech9d, files.write(alone()))
    for name, values in expected.items():
        checks.equal(list(inverse[name]), list(values), f'{name} of a mechanism that is all driven is that of mech9k')
    checks.true({'E.kinetic', 'E.potential'} <= set(inverse), 'with all coordinates driven, mech9d records energies')
    for axis in ('0,0,1', '0.3,1,0.2'):
        found = table_of(mech9d, files.write(mixed(axis) + TIGHT))
        for name, values in expected.items():
            if name != 'closure':
                checks.near(found[name], values, 1e-11, f'{name} of a driven four-bar does not depend on what hangs on it ({axis})')


# --- closed forms ---------------------------------------------------------------------------------------------------

def lift(drive, position):
    """A pendulum, 1 kg at 0.5 m, on a slide along `axis`."""
    return f"""&structure cq=1,2 /
&pair coordinate=1, links=1,2, kind='prismatic', axis={{axis}} /
&pair coordinate=2, links=2,3, kind='revolute', axis=0,0,1 /
&drive coordinate=1, {drive} /
&initial coordinate=2, position={position}, velocity=0.3 /
&body link=3, mass=1, centre=0,-0.5,0 /
&time start=0, end=2, intervals=8 /
""" + WEIGHT


@pytest.mark.parametrize('method', METHODS)
@pytest.mark.parametrize('ax, ay', [(3.0, 0.0), (0.0, 2.0), (-1.0, 4.0)])
def test_pendulum_on_an_accelerated_pivot(checks, files, mech9d, ax, ay, method):
    """On a slide with constant acceleration a pendulum swings as in another gravity: its energy there is constant."""
    length = math.hypot(ax, ay)
    text = lift(f"kind='polynomial', coefficients=0,1,{length / 2}", 0.4).format(axis=f'{ax},{ay},0')
    table = table_of(mech9d, files.write(text + TIGHT.replace(' /', f", method='{method}' /")))
    q, dq = table['q2'], table['dq2']
    energy = [0.125 * w * w + 0.5 * (ax * math.sin(p) - (G + ay) * math.cos(p)) for p, w in zip(q, dq)]
    # a step errs by the tolerance, some thousand steps by some thousand; adams and bdf by up to a hundred times as much
    checks.near(energy, energy[0], 1e-6 if method in ('adams', 'bdf') else 1e-8,
                f'energy of a pendulum on an accelerated slide, {method}')
    checks.near(table['ddq1'], length, 0, 'the slide has the acceleration of its drive')


SPIN, RADIUS = 7.0, 0.4
REST = math.acos(G / (SPIN**2 * RADIUS))


@pytest.mark.parametrize('position, velocity', [(0.3, 2.0), (REST, 0.0)], ids=['swinging', 'resting'])
def test_bead_on_a_turning_hoop(checks, files, mech9d, position, velocity):
    """A bead on a hoop of 0.4 m that turns steadily: w^2/2 - W^2 sin(p)^2/2 - g cos(p)/r is constant. It rests where
    cos(p) = g/(W^2 r)."""
    table = table_of(mech9d, files.write(f"""&structure cq=1,2 /
&pair coordinate=1, links=1,2, kind='revolute', axis=0,1,0 /
&pair coordinate=2, links=2,3, kind='revolute', axis=0,0,1 /
&drive coordinate=1, kind='polynomial', coefficients=0.1,{SPIN} /
&initial coordinate=2, position={position!r}, velocity={velocity} /
&body link=3, mass=2, centre=0,-{RADIUS},0 /
&time start=0, end=2, intervals=8 /
""" + WEIGHT + TIGHT))
    integral = [0.5 * w * w - 0.5 * (SPIN * math.sin(p))**2 - G / RADIUS * math.cos(p) for p, w in zip(table['q2'], table['dq2'])]
    checks.near(integral, integral[0], 1e-8, 'the integral of a bead on a turning hoop')
    if not velocity:
        # the rest is stable, so that the error of the position stays that of the start
        checks.near(table['q2'], REST, 1e-9, 'a bead at rest on a turning hoop stays there')


@pytest.mark.parametrize('frequency, stands', [(400.0, True), (60.0, False)])
def test_pendulum_upright_on_a_vibrating_pivot(checks, files, mech9d, frequency, stands):
    """Kapitza: a pendulum stands upright on a pivot that vibrates fast enough: (amplitude times angular frequency)^2 > 2 g l, by
    averaging, with a wide margin on both sides."""
    text = lift(f"kind='harmonic', amplitude=0.02, angular_frequency={frequency}", math.pi - 0.1).format(axis='0,1,0')
    table = table_of(mech9d, files.write(text.replace('velocity=0.3', 'velocity=0')))
    checks.equal(max(abs(table['q2'] - math.pi)) < 0.2, stands, f'upright at {frequency} rad/s: {stands}')


def test_accuracy_with_drives(checks, files, mech9d):
    """accuracy= holds with drives: against a run with tight tolerances."""
    text = lift("kind='harmonic', amplitude=0.3, angular_frequency=5", 0.4).format(axis='1,0,0')
    exact = table_of(mech9d, files.write(text + TIGHT.replace('1e-11', '1e-13').replace('1e-12', '1e-13')))
    table = table_of(mech9d, files.write(text + '&solver accuracy=1e-7 /\n'))
    checks.near(table['q2'], exact['q2'], 1e-7, 'an accuracy holds for the free coordinate', scale=1.0)
    checks.near(table['q1'], exact['q1'], 0, 'and the driven one is exact')


# --- choices of coordinates -----------------------------------------------------------------------------------------

FIVE_BAR = """&pair coordinate=1, links=1,2, kind='revolute', axis=0,0,1 /
&pair coordinate=2, links=2,3, kind='revolute', point=0.3,0,0, moving_point=0,0,0, axis=0,0,1 /
&pair coordinate=3, links=3,4, kind='revolute', point=0.8,0,0, moving_point=0,0,0, axis=0,0,1 /
&pair coordinate=4, links=4,5, kind='revolute', point=0.7,0,0, moving_point=0.5,0,0, axis=0,0,1 /
&pair coordinate=5, links=1,5, kind='revolute', point=0.9,0,0, moving_point=0,0,0, axis=0,0,1 /
&drive coordinate=1, kind='harmonic', mean=1, amplitude=0.6, angular_frequency=3 /
&body link=2, mass=1, centre=0.1,0,0, inertia=0.02,0.02,0.02,0,0,0 /
&body link=3, mass=2, centre=0.5,0.3,0, inertia=0.1,0.1,0.1,0,0,0 /
&body link=5, mass=2, centre=0.25,0.1,0, inertia=0.1,0.1,0.1,0,0,0 /
&time start=0, end=4, intervals=10 /
""" + WEIGHT + TIGHT


def test_choices_of_the_free_coordinate(checks, files, mech9d):
    """A five-bar with one driven crank moves in the same way whichever coordinate is the other independent one. Some of these come to
    singular positions; coordinate 1 stays independent there."""
    guesses = '&initial coordinate=2, position=-0.5 /\n&initial coordinate=3, position=-1.5 /\n&initial coordinate=4, position=2 /\n'
    first = table_of(mech9d, files.write('&structure cq=1,5 /\n' + FIVE_BAR + guesses
                                         + '&initial coordinate=5, position=1.2, velocity=0.3 /\n'))
    changed = 0
    for free in (2, 3, 4):
        start = ''.join(f'&initial coordinate={k}, position={float(first[f"q{k}"][0])!r}'
                        + (f', velocity={float(first[f"dq{k}"][0])!r}' if k == free else '') + ' /\n' for k in range(2, 6))
        path = files.write(f'&structure cq=1,{free} /\n' + FIVE_BAR + start)
        done = run(mech9d, path, '--table', 'other.dat', folder=files.folder)
        if not checks.equal(done.returncode, 0, f'the five-bar moves with cq = 1, {free}'):
            continue
        other = read_table(text_of(os.path.join(files.folder, 'other.dat')))
        now = re.findall(r'independent coordinates are now (.*)', done.stderr)
        changed += len(now)
        checks.true(all(word.startswith('1, ') for word in now), 'the driven coordinate stays independent', done.stderr)
        for k in range(1, 6):
            # the motion is unstable: differences of 1e-11 grow a thousandfold
            checks.near(other[f'q{k}'], first[f'q{k}'], 1e-7, f'q{k} does not depend on the choice of coordinate {free}')
    checks.true(changed > 0, 'some of the choices are changed on the way')


# --- mistakes -------------------------------------------------------------------------------------------------------

def refused(checks, files, program, text, code, words, why, *options):
    done = run(program, files.write(text), '--no-write', *options, folder=files.folder)
    checks.equal(done.returncode, code, f'{why}: exit code')
    for word in words:
        checks.true(word in done.stderr, f'{why}: {word}', done.stderr)


LONG_CRANK = {'crank': '0.6', 'drive': '0,0.5'}


@pytest.mark.parametrize('text, name', [
    (mixed(crank=LONG_CRANK), 'mech9d'), (mixed('0.3,1,0.2', crank=LONG_CRANK), 'mech9d'), (alone(LONG_CRANK), 'mech9d'),
    (alone(LONG_CRANK), 'mech9k')], ids=['mixed', 'mixed_across', 'alone', 'kinematics'])
def test_driven_dead_point(checks, files, build, text, name):
    """A crank of 0.6 m cannot turn fully: at its dead point the coupler and the rocker are in one line."""
    # at home the crank ends at (0.6, 0), and the coupler and the rocker meet at (0.7, 0.7)
    coupler, rocker = math.hypot(0.1, 0.7), math.hypot(0.2, 0.7)
    limit = math.acos((0.9**2 + 0.6**2 - (coupler + rocker)**2) / (2 * 0.9 * 0.6))
    longer = TIME.replace('end=2', 'end=9')
    done = run(build.program(name), files.write(text.replace(TIME, longer)), '--no-write', folder=files.folder)
    checks.equal(done.returncode, 6, 'a driven dead point ends the motion')
    found = re.search(r'cannot go on beyond t = (\S+) s: closed chain 1 \(coordinates 2, 3, 4\) reaches a dead point at '
                      r'q1 = (\S+) and cannot follow farther', done.stderr)
    if checks.true(found is not None, 'a driven dead point is told', done.stderr):
        # the last step ends where the distance from the dead point, or its root, cannot be halved any more
        checks.near(float(found[2]), limit, 1e-6, 'the position of the dead point')
        checks.near(float(found[1]), limit / 0.5, 1e-6, 'the time of the dead point')


# the line of the drive
LINE = 1 + [row.startswith('&drive') for row in mixed().splitlines()].index(True)


def test_starts_that_contradict_a_drive(checks, files, mech9d):
    text = mixed()
    refused(checks, files, mech9d, text + '&initial coordinate=1, position=0.25, velocity=6 /\n', 3,
            [f'the position of coordinate 1 at the start is 0.2 by its drive in line {LINE}, not 0.25', 'position=0.25'],
            'a position that contradicts a drive')
    refused(checks, files, mech9d, text + '&initial coordinate=1, position=0.2, velocity=5 /\n', 3,
            ['the velocity of coordinate 1 at the start is 6 by its drive'], 'a velocity that contradicts a drive', '--check')
    done = run(mech9d, files.write(text + '&initial coordinate=1, position=0.2, velocity=6 /\n'), '--no-write', folder=files.folder)
    checks.equal(done.returncode, 0, 'initial values that agree with the drive are allowed')


def test_free_coordinate_without_a_start(checks, files, mech9d):
    text = mixed()
    refused(checks, files, mech9d, text.replace('&initial coordinate=5, position=0.4, velocity=0.1 /\n', ''), 3,
            ['the independent coordinate 5 of this pair has no initial position'], 'a free coordinate without a start')


@pytest.mark.parametrize('cq', ['2,5', '3,5'])
def test_drive_of_a_dependent_coordinate(checks, files, mech9d, cq):
    refused(checks, files, mech9d, mixed(cq=cq), 3,
            [f'case.nml:{LINE}:19: coordinate 1 is dependent and cannot be driven; cq = 1, 5 would make it independent'],
            'a drive of a dependent coordinate')


def test_drive_of_a_dependent_coordinate_in_kinematics(checks, files, mech9k):
    refused(checks, files, mech9k, alone().replace('cq=1', 'cq=4'), 3,
            ['the independent coordinate 4 has no drive', 'cq = 1 would make it independent'], 'the same in kinematics')


def test_drive_of_a_coordinate_that_others_determine(checks, files, mech9d):
    second = "&drive coordinate=2, kind='polynomial', coefficients=0 /\n"
    refused(checks, files, mech9d, mixed() + second, 3,
            ['coordinate 2 is dependent and cannot be driven; the coordinates that are driven determine it already'],
            'a drive of a coordinate that the others determine')


def test_mech9k_needs_all_drives(checks, files, mech9k):
    refused(checks, files, mech9k, mixed(), 3, ['the independent coordinate 5 has no drive'], 'mech9k needs all drives')


def test_checks_without_a_run(checks, files, mech9d):
    checks.equal(run(mech9d, files.write(mixed()), '--check', folder=files.folder).returncode, 0, 'a check of a mixed motion')
    checks.equal(run(mech9d, files.write(alone()), '--check', folder=files.folder).returncode, 0, 'a check of inverse dynamics')
