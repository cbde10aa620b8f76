"""Linearised equations of motion along a motion (--linear FILE.h5 --at TIMES): against closed forms (a pendulum on a moving pivot, a motor),
derivatives by complex steps of an independent formulation of the double pendulum, differences of accelerations and columns of runs that
start near by, and the differences of whole motions near by, which the transition matrix of x' = A(t) x gives.

Compares the program with itself in part: at rest, and along a motion that rests; degrees and radians.
"""
import os
import re

import numpy as np
import pytest

from mech9_cases import read_table, run

h5py = pytest.importorskip('h5py')

G = 9.81

PIVOT = """&mechanism {units} /
&structure cq=1,2 /
&pair coordinate=1, links=1,2, kind='prismatic', axis=0,1,0 /
&pair coordinate=2, links=2,3, kind='revolute', axis=0,0,1 /
&drive coordinate=1, kind='harmonic', amplitude=0.02, angular_frequency={omega}, phase={phase} /
&initial coordinate=2, position={q}, velocity={dq} /
&body link=3, mass=2, centre=0,-0.4,0, inertia=0,0,0.03,0,0,0 /
&gravity acceleration=0,-9.81,0 /
&load kind='coordinate', coordinate=2, damping={damping} /
&time start=0.5, end=2, intervals=30 /
&solver relative_tolerance=1e-12, absolute_tolerance=1e-12 /
"""

DOUBLE = """&structure cq=1,2 /
&pair coordinate=1, links=1,2, kind='revolute', axis=0,0,1 /
&pair coordinate=2, links=2,3, kind='revolute', axis=0,0,1, point=0.5,0,0, moving_point=0,0,0 /
&initial coordinate=1, position=0.4, velocity=3 /
&initial coordinate=2, position=-0.9, velocity=-5 /
&body link=2, mass=2, centre=0.3,0,0, inertia=0,0,0.03,0,0,0 /
&body link=3, mass=1.5, centre=0.2,0.1,0, inertia=0,0,0.02,0,0,0 /
&gravity acceleration=0,-9.81,0 /
&load kind='coordinate', coordinate=1, stiffness=3, damping=0.4 /
&load kind='spring', links=1,3, position=0.4,-0.8,0, second_position=0.3,0,0, stiffness=20, free_length=0.3, damping=0.5 /
&point name='tip', link=3, position=0.4,0,0 /
&time end=1, intervals=10 /
&solver relative_tolerance=1e-12, absolute_tolerance=1e-12 /
"""

FOUR_BAR = """&structure cq=1,4,6 /
&pair coordinate=1, links=1,2, kind='revolute', axis=0,0,1 /
&pair coordinate=2, links=2,3, kind='revolute', axis=0,0,1, point=0.3,0,0, moving_point=0,0,0 /
&pair coordinate=3, links=4,3, kind='revolute', axis=0,0,1, point=0.7,0,0, moving_point=0.9,0,0 /
&pair coordinate=5, links=1,4, kind='revolute', axis=0,0,1, point=0.8,0,0, moving_point=0,0,0 /
&pair coordinate=4, links=3,6, kind='prismatic', axis=1,0.3,0, point=0.4,0.2,0, moving_point=0,0,0 /
&pair coordinate=6, links=6,5, kind='revolute', axis=0,0,1, point=0.1,0,0, moving_point=0,0.1,0 /
&drive coordinate=6, kind='polynomial', coefficients=0.3,2,1 /
&initial coordinate=1, position=0.9, velocity=3 /
&initial coordinate=2, position=-0.4 /
&initial coordinate=5, position=1.2 /
&initial coordinate=4, position=0.2, velocity=-0.5 /
&body link=2, mass=1, centre=0.1,0.02,0, inertia=0,0,0.01,0,0,0 /
&body link=3, mass=2, centre=0.5,0.1,0, inertia=0,0,0.05,0,0,0 /
&body link=5, mass=0.5, centre=0.05,0,0, inertia=0,0,0.002,0,0,0 /
&gravity acceleration=1,-9.81,0 /
&load kind='spring', links=1,3, position=0.2,0.9,0, second_position=0.4,0.1,0, stiffness=80, free_length=0.5, damping=2 /
&load kind='coordinate', coordinate=4, stiffness=40, rest=0.1, damping=0.5 /
&load kind='force', link=5, position=0.1,0,0, force=3,-2,0, frame='link', law='harmonic', amplitude=1, angular_frequency=5 /
&point name='P', link=5, position=0.3,0.2,0 /
&time start=0.2, end=0.5, intervals=6 /
&solver relative_tolerance=1e-12, absolute_tolerance=1e-12 /
"""

SHAFTS = """&structure cq=1,5,6,7 /
&pair coordinate=1, links=1,2, kind='revolute', axis=0,0,1 /
&pair coordinates=2,3, links=2,3, kind='universal', axis=1,0,0, moving_axis=0,1,0 /
&pair coordinate=4, links=1,3, kind='revolute', axis=0.5,0,1 /
&pair coordinates=5,6,7, links=3,4, kind='spherical', point=0.3,0.1,0, moving_point=0,0,0 /
&initial coordinate=1, position=0.4, velocity=2 /
&initial coordinate=5, position=0.3, velocity=-1 /
&initial coordinate=6, position=-0.5, velocity=0.7 /
&initial coordinate=7, position=0.8, velocity=1.1 /
&body link=3, mass=3, centre=0.1,0,0.1, inertia=0.05,0.06,0.04,0.001,0,0.002 /
&body link=4, mass=2, centre=0.2,0.1,0.05, inertia=0.02,0.03,0.03,0.001,0,0.002 /
&gravity acceleration=0,1,-9.81 /
&load kind='coordinate', coordinate=4, stiffness=4, damping=0.2 /
&load kind='spring', links=1,4, position=0.5,0.9,0, second_position=0.1,0.1,0.2, stiffness=30, free_length=0.4, damping=1 /
&stop coordinate=6, low=-0.55, stiffness=200, damping=3, exponent=1.5 /
&point name='P', link=4, position=0.3,0.2,0.1 /
&time end=0.4, intervals=4 /
&solver relative_tolerance=1e-12, absolute_tolerance=1e-12 /
"""


class Linear:
    """The matrices in a file, with names."""

    def __init__(self, path):
        with h5py.File(path) as file:
            self.t = file['time'][()]
            self.q, self.dq, self.ddq = (file[name][()] for name in ('q', 'dq', 'ddq'))
            self.free = list(file['free'][()])
            self.M, self.K, self.damping = (file['second_order'][name][()] for name in 'MKC')
            self.A, self.B, self.C, self.D = (file['state_space'][name][()] for name in 'ABCD')
            self.states, self.inputs, self.outputs, self.units = (
                list(file['state_space'][name].asstr()[()]) for name in ('state', 'input', 'output', 'state_unit'))


@pytest.fixture
def program(tmp_path, build):
    class Program:
        def run(self, text, *options, name='mech9d'):
            path = os.path.join(tmp_path, 'a.nml')
            with open(path, 'w') as file:
                file.write(text)
            return run(os.path.join(build.bin, name), path, *options, folder=tmp_path)

        def linear(self, text, at, *options):
            file = os.path.join(tmp_path, 'linear.h5')
            done = self.run(text, '--quiet', '--linear', file, '--at', at, *options)
            if done.returncode != 0:
                raise RuntimeError(f'{text}{at} ended with {done.returncode}:\n{done.stderr}')
            return Linear(file)

        def table(self, text, *options):
            done = self.run(text, '--quiet', '--table', '-', *options)
            if done.returncode != 0:
                raise RuntimeError(f'{text} ended with {done.returncode}:\n{done.stderr}')
            return read_table(done.stdout)
    return Program()


def test_pendulum_on_a_moving_pivot(checks, program):
    """J x'' + c x' + m l (g + a(t)) cos q(t) x = 0: Mathieu's equation where it hangs."""
    omega, phase, damping, j = 40, 0.3, 0.2, 0.03 + 2 * 0.4**2
    for q, dq in ((0, 0), (1.2, 4)):
        found = program.linear(PIVOT.format(units='', omega=omega, phase=phase, damping=damping, q=q, dq=dq), 'outputs')
        checks.near(found.t, np.linspace(0.5, 2, 31), 1e-15, 'times of the results')
        a = -0.02 * omega**2 * np.sin(omega * found.t + phase)
        checks.near(found.ddq[:, 0], a, 1e-12, 'the pivot', scale=20)
        checks.equal((found.free, found.states, found.inputs), ([2], ['q2', 'dq2'], ['Q2']), 'names')
        k = 2 * 0.4 * (G + a) * np.cos(found.q[:, 1])
        checks.near(found.M[:, 0, 0], j, 1e-14, 'M')
        checks.near(found.damping[:, 0, 0], damping, 1e-14, 'C')
        checks.near(found.K[:, 0, 0], k, 1e-12, 'K', scale=20)
        checks.near(found.A[:, 1], np.array([-k / j, np.full(31, -damping / j)]).T, 1e-12, 'A', scale=50)
        checks.near(found.A[:, 0], np.broadcast_to([0.0, 1.0], (31, 2)), 0, 'rates')
    rpm = np.pi / 30
    units = "length_unit='mm', angle_unit='deg', rate_unit='rpm', mass_unit='g'"
    text = PIVOT.format(units=units, omega=omega / rpm, phase=phase * 180 / np.pi, damping=damping * 1e3, q=np.degrees(1.2), dq=4 / rpm)
    text = text.replace('amplitude=0.02', 'amplitude=20').replace('mass=2', 'mass=2000').replace('0,-0.4,0', '0,-400,0')
    text = text.replace('0,0,0.03', '0,0,3e7').replace('-9.81', '-9810')
    other = program.linear(text, 'outputs')
    checks.equal(other.units, ['deg', 'deg/s'], 'states in degrees')
    for name in ('M', 'K', 'damping', 'A'):
        checks.near(getattr(other, name), getattr(found, name), 1e-9, f'{name} in other units, which are SI', scale=50)
    checks.near(other.B * np.pi / 180, found.B, 1e-12, 'B in degrees per N m')


def double_pendulum(q, dq, ddq):
    """The forces that a motion of DOUBLE requires beyond its loads: of complex numbers, too. Positions of mass centres and of the spring's end
    are those of rotated arms, their accelerations those of fixed axes."""
    def turned(angle, x, y):
        return np.array([np.cos(angle) * x - np.sin(angle) * y, np.sin(angle) * x + np.cos(angle) * y])

    def across(v):
        return np.array([-v[1], v[0]])
    a1, a2 = q[0], q[0] + q[1]
    w1, w2, b1, b2 = dq[0], dq[0] + dq[1], ddq[0], ddq[0] + ddq[1]
    elbow, c1 = turned(a1, 0.5, 0), turned(a1, 0.3, 0)
    c2, end = turned(a2, 0.2, 0.1), turned(a2, 0.3, 0)
    gravity = np.array([0, -G])
    f1 = 2 * (across(c1) * b1 - c1 * w1**2 - gravity)
    f2 = 1.5 * (across(elbow) * b1 - elbow * w1**2 + across(c2) * b2 - c2 * w2**2 - gravity)
    span = elbow + end - np.array([0.4, -0.8])
    rate = across(elbow) * w1 + across(end) * w2
    length = np.sqrt(span @ span)
    pull = -(20 * (length - 0.3) + 0.5 * (span @ rate) / length) / length * span
    second = 0.02 * b2 + across(c2) @ f2 - across(end) @ pull
    first = 0.03 * b1 + across(c1) @ f1 + across(elbow) @ f2 - across(elbow) @ pull + second + 3 * q[0] + 0.4 * dq[0]
    return np.array([first, second])


def test_double_pendulum(checks, program):
    found = program.linear(DOUBLE, '0,0.1,0.35,0.35,1')
    checks.near(found.t, [0, 0.1, 0.35, 0.35, 1], 0, 'times')
    for i in range(5):
        motion = [found.q[i], found.dq[i], found.ddq[i]]
        checks.near(double_pendulum(*motion), 0, 1e-11, 'the motion satisfies the equations')
        for order, name in enumerate(('K', 'damping', 'M')):
            slopes = np.empty((2, 2))
            for k in range(2):
                moved = [x.astype(complex) for x in motion]
                moved[order][k] += 1e-30j
                slopes[:, k] = double_pendulum(*moved).imag / 1e-30
            checks.near(getattr(found, name)[i], slopes, 1e-12, f'{name} at {found.t[i]}', scale=np.abs(slopes).max())


@pytest.mark.parametrize('text', [DOUBLE, FOUR_BAR, SHAFTS], ids=['double', 'four-bar', 'shafts'])
def test_differences(checks, program, text):
    """Accelerations and columns of motions that start in neighbouring states of the free coordinates: A and C; of the same with a force more:
    B and D. A force depends on time in the four-bar, and a coordinate is driven with acceleration."""
    times = [float(word) for word in re.search('&time (?:start=([0-9.]*), )?end=([0-9.]*)', text).groups(default='0')]
    t = times[0] + 0.6 * (times[1] - times[0])
    found = program.linear(text, repr(t))
    free = found.free
    n = len(free)
    here = re.sub('&initial.*\n|&time.*\n', '', text)
    guesses = {k: q for k, q in enumerate(found.q[0], 1)}
    driven = [int(k) for k in re.findall('&drive coordinate=([0-9]+)', text)]

    def columns(state, more=''):
        starts = ''.join(f'&initial coordinate={k}, position={float(guesses[k])!r} /\n' for k in guesses if k not in free and k not in driven)
        starts += ''.join(f'&initial coordinate={k}, position={float(state[i])!r}, velocity={float(state[n + i])!r} /\n' for i, k in enumerate(free))
        table = program.table(f'{here}{starts}{more}&time at={t!r} /\n')
        return (np.array([table[f'ddq{k}'][0] for k in free]),
                np.array([table[name][0] for name in found.outputs]))
    state = np.concatenate([found.q[0, [k - 1 for k in free]], found.dq[0, [k - 1 for k in free]]])
    there, y = columns(state)
    checks.near(there, found.ddq[0, [k - 1 for k in free]], 1e-9, 'the same accelerations', scale=np.abs(there).max())
    scale, scale_y = np.abs(found.A).max(), np.abs(found.C).max()
    h = 1e-3    # truncation and round-off of fourth order are about 1e-10
    for i in range(2 * n):
        sides = [columns(state + step * h * np.eye(2 * n)[i]) for step in (-2, -1, 1, 2)]
        for which, matrix, size, name in ((0, found.A[0, n:, i], scale, 'A'), (1, found.C[0, :, i], scale_y, 'C')):
            a, b, c, d = (side[which] for side in sides)
            checks.near((a - 8 * b + 8 * c - d) / (12 * h), matrix, 1e-8, f'{name} by {found.states[i]}', scale=size)
    for i, k in enumerate(free):
        more = f"&load kind='coordinate', coordinate={k}, force=1 /\n"
        pushed, y_pushed = columns(state, more)
        checks.near(pushed - there, found.B[0, n:, i], 1e-10, f'B by Q{k}', scale=np.abs(there).max())
        checks.near(y_pushed - y, found.D[0, :, i], 1e-10, f'D by Q{k}', scale=np.abs(y).max())


@pytest.mark.parametrize('text', [DOUBLE, FOUR_BAR], ids=['double', 'four-bar'])
def test_transition_matrix(checks, program, text):
    """x' = A(t) x, integrated in numpy by a method of order 4, against the differences of whole motions near by."""
    steps = 800
    text = re.sub('intervals=[0-9]+', f'intervals={2 * steps}', text)
    found = program.linear(text, 'outputs')
    n = len(found.free)
    h = 2 * (found.t[1] - found.t[0])
    phi = np.eye(2 * n)
    for i in range(steps):
        a0, a1, a2 = found.A[2 * i:2 * i + 3]
        k1 = a0 @ phi
        k2 = a1 @ (phi + h / 2 * k1)
        k3 = a1 @ (phi + h / 2 * k2)
        k4 = a2 @ (phi + h * k3)
        phi = phi + h / 6 * (k1 + 2 * k2 + 2 * k3 + k4)
    short = re.sub('intervals=[0-9]+', 'intervals=1', text)

    def end(which, change):
        word = ('position', 'velocity')[which // n]
        k = found.free[which % n]

        def moved(match):
            return f'{match[1]}{float(match[2]) + change!r}'
        table = program.table(re.sub(rf'(&initial coordinate={k}, .*{word}=)(-?[0-9.]+)', moved, short))
        return np.array([table[f'{kind}{k}'][-1] for kind in ('q', 'dq') for k in found.free])
    step = 1e-4
    for i in range(2 * n):
        a, b, c, d = (end(i, x * step) for x in (-2, -1, 1, 2))
        checks.near((a - 8 * b + 8 * c - d) / (12 * step), phi[:, i], 2e-7, f'column of {found.states[i]}', scale=np.abs(phi).max())


def test_motors(checks, program):
    """A motor with inductance on a shaft with a weight, and a controller with an integral, in motion: J x'' = k i - ..., L i' = u - R i - k x'."""
    text = """&structure cq=1,2 /
&pair coordinate=1, links=1,2, kind='revolute', axis=0,0,1 /
&pair coordinate=2, links=1,3, kind='prismatic', axis=1,0,0 /
&initial coordinate=1, position=0.3, velocity=2 /
&initial coordinate=2, position=0.1, velocity=1 /
&body link=2, mass=1, centre=0.2,0,0, inertia=0,0,0.05,0,0,0 /
&body link=3, mass=2 /
&gravity acceleration=0,-9.81,0 /
&motor coordinate=1, kind='dc', voltage=12, resistance=2, inductance=0.01, constant=0.4 /
&motor coordinate=2, kind='pid', proportional=50, integral=30, derivative=5, limit=20, law='polynomial', coefficients=0.1,1 /
&time end=1, intervals=10 /
"""
    found = program.linear(text, '0,0.02,0.5')
    j = 0.05 + 0.04
    checks.equal(found.states, ['q1', 'q2', 'dq1', 'dq2', 'M1.current', 'M2.integral'], 'states')
    checks.equal(found.inputs, ['Q1', 'Q2', 'M1.voltage'], 'inputs')
    for i in range(3):
        a = np.zeros((6, 6))
        a[0, 2] = a[1, 3] = 1
        a[2, 0] = 0.2 * G * np.sin(found.q[i, 0]) / j
        a[2, 4] = 0.4 / j
        a[3, 1], a[3, 3], a[3, 5] = -25, -2.5, 15
        a[4, 2], a[4, 4] = -40, -200
        a[5, 1] = -1
        checks.near(found.A[i], a, 1e-12, f'A at {found.t[i]}')
        b = np.zeros((6, 3))
        b[2, 0], b[3, 1], b[4, 2] = 1 / j, 0.5, 100
        checks.near(found.B[i], b, 1e-12, 'B')
    # at its limit the controller has no slope
    found = program.linear(text.replace('limit=20', 'limit=2').replace('position=0.1', 'position=0.7'), '0')
    checks.near(found.A[0, 3], 0, 1e-14, 'at its limit')


def test_at_rest(checks, program, tmp_path):
    """In equilibrium the matrices of --linear without --at."""
    text = re.sub('velocity=[-0-9.]+', 'velocity=0', DOUBLE)
    rest = program.run(text, '--equilibrium', '--quiet', '--linear', 'rest.h5')
    position = read_table(rest.stdout)
    for k in (1, 2):
        text = re.sub(f'coordinate={k}, position=[-0-9.]*, velo', f"coordinate={k}, position={float(position[f'q{k}'][0])!r}, velo", text)
    found = program.linear(text, '0')
    with h5py.File(os.path.join(tmp_path, 'rest.h5')) as file:
        for group, names in (('second_order', 'MCK'), ('state_space', 'ABCD')):
            for name in names:
                ours = found.damping if group + name == 'second_orderC' else getattr(found, name)
                theirs = file[group][name][()]
                checks.near(ours[0], theirs, 1e-7, f'{group}/{name}', scale=np.abs(theirs).max())
        for name in ('state', 'input', 'output', 'state_unit', 'output_unit'):
            with h5py.File(os.path.join(tmp_path, 'linear.h5')) as other:
                checks.equal(list(other['state_space'][name].asstr()[()]), list(file['state_space'][name].asstr()[()]), name)


def test_recorded_coordinates(checks, program):
    """Outputs are the recorded columns; the states do not depend on them."""
    few = program.linear(FOUR_BAR, '0.3', '--set', 'output.coordinates=5', '--set', 'output.derivatives=0')
    all_columns = program.linear(FOUR_BAR, '0.3')
    checks.equal(few.outputs, ['q5', 'P.x', 'P.y', 'P.z'], 'outputs')
    checks.near(few.A, all_columns.A, 1e-9, 'A', scale=np.abs(all_columns.A).max())
    checks.near(few.q, all_columns.q, 1e-10, 'the motion')
    rows = [all_columns.outputs.index(name) for name in few.outputs]
    checks.near(few.C[0], all_columns.C[0][rows], 1e-9, 'C')


def test_at_one_instant(checks, program):
    """&time at= with the word outputs: the state is that of the data file."""
    found = program.linear(re.sub('&time.*', '&time at=0.7 /', DOUBLE), 'outputs')
    checks.near(found.t, [0.7], 0, 'the instant')
    checks.near(np.concatenate([found.q[0], found.dq[0]]), [0.4, -0.9, 3, -5], 1e-15, 'the state of the data file')


REFUSED = [
    (DOUBLE, '2', 2, 't = 2 s is outside of the motion'),
    (DOUBLE, '1e3', 2, 'is outside of the motion'),
    (DOUBLE, '0.5,0.2', 2, 'give the times in the order of the motion'),
    (DOUBLE, 'often', 2, '--at has times with commas'),
    (DOUBLE, '0.1,,0.2', 2, '--at has times with commas'),
    (DOUBLE + '&friction coordinate=1, dynamic=0.2, radius=0.01 /\n', '0.5', 3, 'where pairs have friction'),
    (re.sub('&initial.*\n', '', DOUBLE) + "&drive coordinate=1, kind='polynomial', coefficients=0,1 /\n"
     "&drive coordinate=2, kind='polynomial', coefficients=0,1 /\n", '0.5', 3, 'every independent coordinate is driven'),
    (re.sub('&initial.*\n', '', DOUBLE) + '&initial coordinate=1, position=-1.5, velocity=0 /\n&initial coordinate=2, position=0, velocity=0 /\n'
     '&stop coordinate=2, low=0 /\n', '0', 6, 'stop 1 holds a coordinate'),
]


@pytest.mark.parametrize('text, at, code, message', REFUSED)
def test_refusals(checks, program, text, at, code, message):
    done = program.run(text, '--linear', 'linear.h5', '--at', at)
    checks.equal(done.returncode, code, done.stderr)
    checks.true(message in done.stderr, f'{message}', done.stderr)


def test_conflicts(checks, program):
    for options, code in ((('--at', '0'), 2), (('--linear', 'a.h5', '--at', '0', '--modes'), 2), (('--linear', 'a.h5', '--at', '0', '--plot', 'q1'), 2),
                          (('--linear', 'a.h5', '--at', '0', '--equilibrium'), 2), (('--linear', 'a.h5', '--at', '0', '--report', 'a.json'), 0)):
        done = program.run(DOUBLE, *options)
        checks.equal(done.returncode, code, f'{options}: {done.stderr}')
    checks.equal(program.run(DOUBLE, '--linear', 'a.h5', '--at', '0', name='mech9k').returncode, 2, 'mech9k has no such options')
