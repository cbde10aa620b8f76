"""Motors in dynamics: direct-current motors and PID controllers against closed forms, against linear systems solved by exponentials of
matrices, and on a four-bar linkage against an integration of its own; their work against the change of energy; their forces in
reactions and drive forces; refusals with place and remedy.

Compares the program with itself in part: a controller without an integral part is a spring with a damper; other numbers of
coordinates; other methods of integration.
"""
import math
import os

import numpy as np
import pytest

from mech9_cases import read_table, run, text_of

TIGHT = '&solver relative_tolerance=1e-11, absolute_tolerance=1e-12 /\n'
# Errors of steps at 1e-11 add up over some hundred steps of motions that do not enlarge them: 100 tolerances.
NEAR = 1e-9
METHODS = ('auto', 'verner', 'adams', 'bdf')
LINEAR_MOTOR = "&motor coordinate=1, kind='dc', voltage=10, resistance=2, inductance=0.1, constant=3 /\n"

FLYWHEEL = """&structure cq=1 /
&pair coordinate=1, links=1,2, kind='revolute', axis=0,0,1 /
&initial coordinate=1, position=0 /
&body link=2, mass=1, inertia=0,0,0.02,0,0,0 /
"""
SLIDE = """&structure cq=1 /
&pair coordinate=1, links=1,2, kind='prismatic', axis=1,0,0 /
&initial coordinate=1, position=0 /
&body link=2, mass=2 /
&load kind='coordinate', coordinate=1, stiffness=50, damping=1 /
"""
FOUR_BAR = """&structure cq={a} /
&pair coordinate={a}, links=1,2, kind='revolute', axis=0,0,1 /
&pair coordinate={b}, links=2,3, kind='revolute', point=0.2,0,0, axis=0,0,1 /
&pair coordinate={c}, links=3,4, kind='revolute', point=0.7,0,0, axis=0,0,1, moving_point=1,0,0 /
&pair coordinate={d}, links=1,4, kind='revolute', point=0.6,0,0, axis=0,0,1, moving_point=0.6,0,0 /
&initial coordinate={a}, position=0.3 /
&initial coordinate={b}, position=0.45 /
&initial coordinate={c}, position=0.93 /
&initial coordinate={d}, position=1.67 /
&body link=2, mass=1, centre=0.05,0.02,0, inertia=0.03,0.03,0.03,0,0,0 /
&body link=3, mass=0.5, centre=0.4,0.1,0, inertia=0.01,0.01,0.01,0,0,0 /
&body link=4, mass=0.8, centre=0.65,0.2,0, inertia=0.02,0.02,0.02,0,0,0 /
&gravity acceleration=0,-9.81,0 /
&motor coordinate={a}, kind='dc', voltage=12, resistance=0.8, inductance=0.02, constant=0.05, gear_ratio=20 /
"""
ARM = """&structure cq=1,2 /
&pair coordinate=1, links=1,2, kind='revolute', axis=0,0,1 /
&pair coordinate=2, links=2,3, kind='revolute', point=0.5,0,0, axis=0,0,1 /
&initial coordinate=2, position=0.4 /
&body link=2, mass=2, centre=0.25,0,0, inertia=0,0,0.05,0,0,0 /
&body link=3, mass=1, centre=0.8,0,0, inertia=0,0,0.03,0,0,0 /
&gravity acceleration=0,-9.81,0 /
&drive coordinate=1, kind='harmonic', amplitude=0.5, angular_frequency=3 /
"""


def time(end, intervals=100):
    return f'&time start=0, end={end!r}, intervals={intervals} /\n'


def exponential(a):
    """The exponential of a matrix: Taylor's series after halving, then squares."""
    halvings = max(0, math.ceil(math.log2(max(np.abs(a).max(), 1e-300)))) + 5
    x = a/2.0**halvings
    result, term = np.eye(len(a)), np.eye(len(a))
    for k in range(1, 20):
        term = term@x/k
        result = result + term
    for _ in range(halvings):
        result = result@result
    return result


class Runs:
    """Tables of data files in a folder of their own."""

    def __init__(self, checks, mech9k, mech9d, folder):
        self.checks, self.mech9k, self.mech9d, self.folder = checks, mech9k, mech9d, folder

    def path(self, text):
        path = os.path.join(self.folder, 'case.nml')
        with open(path, 'w', encoding='utf-8') as file:
            file.write(text)
        return path

    def table(self, text, *options, program=None):
        out = os.path.join(self.folder, 'case.dat')
        if os.path.exists(out):
            os.remove(out)
        done = run(program or self.mech9d, self.path(text), '--quiet', '--table', out, *options, folder=self.folder)
        if done.returncode != 0:
            raise RuntimeError(f'{text}\nended with {done.returncode}:\n{done.stderr}')
        return read_table(text_of(out))

    def refused(self, text, words, why, code=3):
        done = run(self.mech9d, self.path(text), '--check', folder=self.folder)
        self.checks.equal(done.returncode, code, f'{why}: the exit code')
        for word in words:
            self.checks.true(word in done.stderr, f'{why}: {word}', done.stderr)


@pytest.fixture
def runs(checks, mech9k, mech9d, tmp_path):
    return Runs(checks, mech9k, mech9d, tmp_path)


def follow_linear(table, a, start, names, runs, why, tolerance=NEAR):
    """Compare columns with the motion x' = a x, of which they are the first numbers."""
    step = exponential(a*(table['t'][1] - table['t'][0]))
    x, states = np.array(start, float), []
    for _ in table['t']:
        states.append(x)
        x = step@x
    states = np.array(states)
    for i, name in enumerate(names):
        runs.checks.near(table[name], states[:, i], tolerance, f'{why}: {name}', scale=max(1.0, np.abs(states[:, i]).max()))


def dc_matrix(voltage, resistance, inductance, coupling, inertia, stiffness=0.0, damping=0.0):
    """Of q, q', the current, and 1."""
    return np.array([[0, 1, 0, 0],
                     [-stiffness/inertia, -damping/inertia, coupling/inertia, 0],
                     [0, -coupling/inductance, -resistance/inductance, voltage/inductance],
                     [0, 0, 0, 0]])


STATES = ['q1', 'dq1', 'M1.current']


@pytest.mark.parametrize('ratio', [1.0, -4.0])
@pytest.mark.parametrize('inductance', [0.001, 0.05])
def test_spinning_up_a_flywheel(runs, inductance, ratio):
    """With roots that are real or not; through a gear."""
    motor = (f"&motor coordinate=1, kind='dc', voltage=24, resistance=0.6, inductance={inductance!r}, constant=0.3, "
             f'gear_ratio={ratio!r} /\n')
    table = runs.table(FLYWHEEL + motor + TIGHT + time(1.0) + '&output reactions=.true. /\n')
    follow_linear(table, dc_matrix(24, 0.6, inductance, 0.3*ratio, 0.02), [0, 0, 0, 1], STATES, runs,
                  f'flywheel, L = {inductance}, gear {ratio}')
    runs.checks.near(table['M1.torque'], 0.3*ratio*table['M1.current'], 1e-14, 'torque by current')
    runs.checks.near(table['R1.mz'], table['M1.torque'], 1e-13, 'the reaction holds the torque of the motor',
                     scale=np.abs(table['M1.torque']).max())


def test_motor_beside_a_stop_that_is_never_met(runs):
    motor = "&motor coordinate=1, kind='dc', voltage=24, resistance=0.6, inductance=0.05, constant=0.3 /\n"
    table = runs.table(FLYWHEEL + motor + '&stop coordinate=1, low=-1, stiffness=100 /\n' + TIGHT + time(1.0))
    follow_linear(table, dc_matrix(24, 0.6, 0.05, 0.3, 0.02), [0, 0, 0, 1], STATES, runs, 'a flywheel beside a stop')


def test_linear_motor_against_a_spring(runs):
    table = runs.table(SLIDE + LINEAR_MOTOR + TIGHT + time(3.0))
    follow_linear(table, dc_matrix(10, 2, 0.1, 3, 2, 50, 1), [0, 0, 0, 1], STATES, runs, 'a linear motor against a spring')


def test_stall_torque_against_a_spring(runs):
    held = FLYWHEEL + "&load kind='coordinate', coordinate=1, stiffness=40, damping=0.8 /\n"
    motor = "&motor coordinate=1, kind='dc', voltage=24, resistance=0.6, inductance=0.01, constant=0.3 /\n"
    table = runs.table(held + motor + TIGHT + time(8.0))
    runs.checks.near(table['M1.torque'][-1], 0.3*24/0.6, 1e-8, 'stall torque against a spring')
    runs.checks.near(table['q1'][-1], 0.3*24/0.6/40, 1e-8, 'the spring holds the stall torque')


def test_motor_without_inductance(runs):
    """J w' = k (U - k w)/R."""
    motor = "&motor coordinate=1, kind='dc', voltage=24, resistance=0.6, constant=0.3 /\n"
    table = runs.table(FLYWHEEL + motor + TIGHT + time(1.0))
    rate = 0.3**2/0.6/0.02
    speed = 24/0.3*(1 - np.exp(-rate*table['t']))
    runs.checks.near(table['dq1'], speed, NEAR, 'without inductance: speed', scale=80)
    runs.checks.near(table['M1.current'], (24 - 0.3*speed)/0.6, NEAR, 'without inductance: current', scale=40)


BY_LAW = "&motor coordinate=1, kind='dc', {voltage} resistance=0.6, inductance=0.01, constant=0.3, {law} /\n"


@pytest.mark.parametrize('method', METHODS)
def test_harmonic_voltage(runs, method):
    omega, phase = 17.0, 0.4
    law = f"law='harmonic', mean=0.5, amplitude=1, angular_frequency={omega}, phase={phase}"
    a = np.zeros((6, 6))
    a[:4, :4] = dc_matrix(6, 0.6, 0.01, 0.3, 0.02)
    a[2, 4] = 12/0.01
    a[4, 5], a[5, 4] = omega, -omega
    start = [0, 0, 0, 1, math.sin(phase), math.cos(phase)]
    solver = TIGHT.replace('&solver', f"&solver method='{method}',")
    table = runs.table(FLYWHEEL + BY_LAW.format(voltage='voltage=12,', law=law) + solver + time(1.0))
    follow_linear(table, a, start, STATES, runs, f'harmonic voltage, {method}')


def test_voltage_in_segments(runs):
    """The law alone gives volts; pieces of constant velocity and dwells: a linear system in each."""
    law = ("law='segments', times=0,0.1,0.3,0.5,0.8, values=0,24,24,-5,0, "
           "laws='constant-velocity','dwell','constant-velocity','constant-velocity', period=0.8")
    pieces = [(0.1, 240.0), (0.2, 0.0), (0.2, -145.0), (0.3, 5/0.3)]
    table = runs.table(FLYWHEEL + BY_LAW.format(voltage='', law=law) + TIGHT + time(1.6, 160))
    b = np.zeros((5, 5))
    b[:4, :4] = dc_matrix(0, 0.6, 0.01, 0.3, 0.02)
    b[2, 4] = 1/0.01
    x, states = np.zeros(5), []
    x[3] = 1
    for duration, slope in 2*pieces:
        b[4, 3] = slope
        step = exponential(b*0.01)
        for _ in range(round(duration/0.01)):
            states.append(x)
            x = step@x
    states.append(x)
    states = np.array(states)
    for i, name in enumerate(STATES):
        runs.checks.near(table[name], states[:, i], NEAR, f'voltage in segments: {name}', scale=np.abs(states[:, i]).max())


def four_bar_angles(q):
    """Angles of coupler and rocker of FOUR_BAR over that of the crank, by the intersection of two circles."""
    bx, by = 0.2*math.cos(q), 0.2*math.sin(q)
    dx, dy = 0.6 - bx, -by
    far = math.hypot(dx, dy)
    along = (far**2 + 0.5**2 - 0.4**2)/(2*far)
    across = math.sqrt(0.5**2 - along**2)
    cx, cy = bx + (along*dx - across*dy)/far, by + (along*dy + across*dx)/far
    return math.atan2(cy - by, cx - bx), math.atan2(cy, cx - 0.6)


def test_four_bar(runs):
    """The motor on the crank of a four-bar linkage against an integration of the one equation J q'' + J' q'^2/2 = torques."""
    numbers = {'a': 1, 'b': 2, 'c': 3, 'd': 4}
    text = FOUR_BAR.format(**numbers)
    run_of = TIGHT + time(1.0, 50)
    table = runs.table(text + run_of)
    bodies = [(1.0, 0.05, 0.02, 0.03), (0.5, 0.2, 0.1, 0.01), (0.8, 0.05, 0.2, 0.02)]   # mass, centre from the pair, inertia

    def position(q):
        angles = (q, *four_bar_angles(q))
        origins = ((0, 0), (0.2*math.cos(q), 0.2*math.sin(q)), (0.6, 0))
        centres = []
        for (mass, x, y, _), angle, (ox, oy) in zip(bodies, angles, origins):
            centres.append((ox + x*math.cos(angle) - y*math.sin(angle), oy + x*math.sin(angle) + y*math.cos(angle)))
        return np.array([value for centre in centres for value in centre] + list(angles))

    weight = np.array([m for m, *_ in bodies for _ in (0, 1)] + [i for *_, i in bodies])

    def coefficients(q):
        h = 1e-3
        p = [position(q + k*h) for k in (-3, -2, -1, 0, 1, 2, 3)]
        # sixth order in first derivatives, fourth or better in second ones: errors about 1e-14/h^2 and h^6
        d1 = (-p[0] + 9*p[1] - 45*p[2] + 45*p[4] - 9*p[5] + p[6])/(60*h)
        d2 = (2*p[0] - 27*p[1] + 270*p[2] - 490*p[3] + 270*p[4] - 27*p[5] + 2*p[6])/(180*h*h)
        gravity = -9.81*sum(m*d1[2*i + 1] for i, (m, *_) in enumerate(bodies))
        return np.dot(weight, d1*d1), np.dot(weight, d1*d2), gravity

    def rate(y):
        q, w, i = y
        inertia, half, gravity = coefficients(q)
        return np.array([w, (i + gravity - half*w*w)/inertia, (12 - 0.8*i - w)/0.02])   # the coupling is 20 * 0.05 = 1

    y, n = np.array([0.3, 0.0, 0.0]), 20
    states = [y]
    h = 0.02/n
    for _ in range(50):
        for _ in range(n):
            k1 = rate(y)
            k2 = rate(y + h/2*k1)
            k3 = rate(y + h/2*k2)
            k4 = rate(y + h*k3)
            y = y + h/6*(k1 + 2*k2 + 2*k3 + k4)
        states.append(y)
    states = np.array(states)
    # Runge and Kutta's method with steps of 1 ms, where the fastest root is 40/s: (0.04)^4/120 of the numbers, 2e-8, adds up to
    # less than 1e-6
    for i, name in enumerate(STATES):
        runs.checks.near(table[name], states[:, i], 1e-6, f'motor on a four-bar: {name}', scale=np.abs(states[:, i]).max())
    others = {'a': 3, 'b': 1, 'c': 4, 'd': 2}
    other = runs.table(FOUR_BAR.format(**others) + run_of)
    for key, number in numbers.items():
        for kind in ('q', 'dq', 'ddq'):
            column = table[f'{kind}{number}']
            runs.checks.near(other[f'{kind}{others[key]}'], column, 1e-8, f'{kind}{number} with other numbers',
                             scale=max(1.0, np.abs(column).max()))
    runs.checks.near(other['M1.current'], table['M1.current'], 1e-8, 'current with other numbers', scale=15)


def test_work(runs):
    """The work of drives, motors and loads is the change of energy."""
    motor = "&motor coordinate=2, kind='dc', voltage=6, resistance=0.7, inductance=0.05, constant=0.4, law='harmonic', " \
            'amplitude=1, angular_frequency=5 /\n'
    load = "&load kind='coordinate', coordinate=2, damping=0.2 /\n&load kind='torque', link=3, torque=0,0,0.7 /\n"
    table = runs.table(ARM + motor + load + TIGHT + time(2.0, 4000) + '&output drive_forces=.true., reactions=.true. /\n')
    power = (table['F1']*table['dq1'] + table['M1.torque']*table['dq2'] - 0.2*table['dq2']**2
             + 0.7*(table['dq1'] + table['dq2']))
    # Boole's rule over intervals of 2 ms: its error is below (h w)^6, 1e-12, for w up to 40/s
    h = 4*(table['t'][1] - table['t'][0])
    added = h/90*(7*power[0:-1:4] + 32*power[1::4] + 12*power[2::4] + 32*power[3::4] + 7*power[4::4])
    energy = table['E.total'][::4]
    runs.checks.near(np.cumsum(added), energy[1:] - energy[0], 1e-8, 'work of drive, motor and loads', scale=np.abs(energy).max())
    # the pair passes motor and drive once: moments about the axes balance the links
    runs.checks.near(table['R1.mz'], table['F1'], 1e-11, 'the drive alone acts in pair 1', scale=np.abs(table['F1']).max())
    runs.checks.near(table['R2.mz'], table['M1.torque'] - 0.2*table['dq2'], 1e-11, 'motor and load act in pair 2',
                     scale=np.abs(table['M1.torque']).max())


@pytest.mark.parametrize('text, k', [(ARM, 2), (FOUR_BAR.format(a=1, b=2, c=3, d=4).split('&motor')[0], 1)], ids=['open', 'closed'])
def test_controller_as_a_spring(runs, text, k):
    """A controller without an integral part is a spring with a damper, in open and closed chains, with a drive beside it."""
    output = '&output drive_forces=.true., reactions=.true. /\n'
    motor = f"&motor coordinate={k}, kind='pid', proportional=30, derivative=0.6, setpoint=0.9 /\n"
    spring = f"&load kind='coordinate', coordinate={k}, stiffness=30, damping=0.6, rest=0.9 /\n"
    one = runs.table(text + motor + TIGHT + time(1.0, 50) + output)
    two = runs.table(text + spring + TIGHT + time(1.0, 50) + output)
    for name in two:
        if not name.startswith('E.') and name != 'closure':
            # both integrate the same equations; the state of the motor stays zero, so that steps are the same
            runs.checks.near(one[name], two[name], 1e-8, f'controller as a spring: {name}', scale=max(1.0, np.abs(two[name]).max()))
    expected = 30*(0.9 - one[f'q{k}']) - 0.6*one[f'dq{k}']
    runs.checks.near(one['M1.torque'], expected, 1e-12, 'force of the controller', scale=30)


class Controlled:
    """A mass on a spring under a PID controller whose setpoint is mean + amplitude sin(omega t): linear where the force is not at
    its limit and where it is. The states are x, v, the integral, sin, cos, and 1."""
    mass, damping, stiffness = 2.0, 1.0, 50.0

    def __init__(self, p, i, d, limit, mean, amplitude, omega):
        self.limit, self.has_integral = limit, i > 0
        self.demand = np.array([-p, -d, i, p*amplitude, d*amplitude*omega, p*mean])
        self.per_excess = 1/(i*(math.sqrt(d/i) if d > 0 else p/i)) if i > 0 else 0.0
        self.deviation = np.array([-1, 0, 0, amplitude, 0, mean])
        self.omega = omega
        self.flows = {}

    def matrix(self, mode):
        a = np.zeros((6, 6))
        a[0, 1] = 1
        a[3, 4], a[4, 3] = self.omega, -self.omega
        a[1] = [-self.stiffness/self.mass, -self.damping/self.mass, 0, 0, 0, 0]
        limit = np.array([0, 0, 0, 0, 0, mode*self.limit])
        a[1] += (self.demand if mode == 0 else limit)/self.mass
        if self.has_integral:
            a[2] = self.deviation - (0 if mode == 0 else self.per_excess*(self.demand - limit))
        return a

    def flow(self, mode, y, h):
        if (mode, h) not in self.flows:
            self.flows[mode, h] = exponential(self.matrix(mode)*h)
        return self.flows[mode, h]@y

    def beyond(self, mode, y):
        demand = self.demand@y/self.limit
        return abs(demand) - 1 if mode == 0 else 1 - mode*demand

    def motion(self, times):
        """States at times, and how often the force reached or left its limit."""
        y, passings = np.array([0, 0, 0, 0, 1, 1.0]), 0
        mode = int(np.sign(self.demand@y)) if abs(self.demand@y) > self.limit else 0
        states = [y]
        for start, end in zip(times[:-1], times[1:]):
            rest = end - start
            while True:
                parts = [k*rest/16 for k in range(1, 17)]
                beyond = [self.beyond(mode, self.flow(mode, y, h)) > 1e-13 for h in parts]
                if not any(beyond):
                    y = self.flow(mode, y, rest)
                    break
                k = beyond.index(True)
                low, high = (parts[k - 1] if k else 0.0), parts[k]
                for _ in range(55):
                    middle = 0.5*(low + high)
                    if self.beyond(mode, exponential(self.matrix(mode)*middle)@y) > 0:
                        high = middle
                    else:
                        low = middle
                y = exponential(self.matrix(mode)*high)@y
                rest -= high
                mode = 0 if mode else int(np.sign(self.demand@y))
                passings += 1
            states.append(y)
        return np.array(states), passings


@pytest.mark.parametrize('numbers, least, why', [
    ((200, 300, 20, 1e9, 0.3, 0.0, 1.0), 0, 'no limit'),
    ((200, 300, 20, 25, 0.3, 0.0, 1.0), 1, 'limit at the start'),
    ((200, 300, 20, 25, -0.3, 0.0, 1.0), 1, 'lower limit at the start'),
    ((200, 300, 0, 12, 0.2, 0.3, 6.0), 8, 'PI at both limits'),
    ((300, 0, 5, 14, 0.1, 0.4, 5.0), 5, 'PD at both limits'),
    ((300, 900, 8, 15, 0.0, 0.4, 6.0), 5, 'PID at both limits')], ids=['free', 'limit_at_the_start', 'lower_limit', 'PI', 'PD', 'PID'])
def test_controllers(runs, numbers, least, why):
    """PID controllers with and without limit, by several methods."""
    p, i, d, limit, mean, amplitude, omega = numbers
    text = SLIDE + (f"&motor coordinate=1, kind='pid', proportional={p}, integral={i}, derivative={d}, "
                    + ('' if limit > 1e6 else f'limit={limit}, ')
                    + (f"law='harmonic', mean={mean}, amplitude={amplitude}, angular_frequency={omega} /\n" if amplitude
                       else f'setpoint={mean} /\n'))
    controlled = Controlled(*numbers)
    states = None
    for method in METHODS if least > 1 else METHODS[:1]:
        table = runs.table(text + TIGHT.replace('&solver', f"&solver method='{method}',") + time(4.0, 200))
        if states is None:
            states, passings = controlled.motion(table['t'])
            runs.checks.true(passings >= least, f'{why}: the limit is passed often enough', passings)
        for k, name in enumerate(['q1', 'dq1', 'M1.integral']):
            runs.checks.near(table[name], states[:, k], NEAR, f'{why}, {method}: {name}', scale=1.0)
        force = np.clip(states@controlled.demand, -limit, limit)
        # gains of some hundreds enlarge the errors of the state
        runs.checks.near(table['M1.torque'], force, 1e3*NEAR, f'{why}, {method}: the force', scale=1.0)


def test_setpoint_in_degrees(runs):
    """A setpoint with joints: the same motion as in radians."""
    turned = FLYWHEEL + "&load kind='coordinate', coordinate=1, stiffness=3, damping=0.1 /\n"
    motor = "&motor coordinate=1, kind='pid', proportional=5, integral=9, derivative=0.4, limit=2, law='segments', {law} /\n"
    law = "times=0,0.5,1, values=0,{0},0, laws='cycloidal','harmonic', period=1"
    one = runs.table(turned + motor.format(law=law.format(1.2)) + TIGHT + time(3.0))
    two = runs.table("&mechanism angle_unit='deg' /\n" + turned + motor.format(law=law.format(repr(math.degrees(1.2)))) + TIGHT
                     + time(3.0))
    runs.checks.near(np.radians(two['q1']), one['q1'], NEAR, 'setpoint in degrees', scale=1.0)
    runs.checks.near(np.radians(two['M1.integral']), one['M1.integral'], NEAR, 'integral in degrees', scale=1.0)
    runs.checks.near(two['M1.torque'], one['M1.torque'], 100*NEAR, 'torque in N m', scale=1.0)
    runs.checks.true(np.abs(one['M1.torque']).max() == 2.0, 'the limit is reached exactly')


PENDULUM = """&structure cq=1 /
&pair coordinate=1, links=1,2, kind='revolute', axis=0,0,1 /
&initial coordinate=1, position=0.3 /
&body link=2, mass=2, centre=0.4,0,0, inertia=0,0,0.1,0,0,0 /
&gravity acceleration=0,-9.81,0 /
"""


def roots_of(table):
    """All roots of a table of modes, conjugate ones too."""
    roots = [complex(re, im) for re, im in zip(table['eigenvalue.re'], table['eigenvalue.im'])]
    roots += [root.conjugate() for root in roots if root.imag > 0]
    return np.array(sorted(roots, key=lambda z: (round(z.real, 6), z.imag)))


def same_roots(runs, table, matrix, why):
    roots = np.array(sorted(np.linalg.eigvals(matrix), key=lambda z: (round(z.real, 6), z.imag)))
    found = roots_of(table)
    if runs.checks.equal(len(found), len(roots), f'{why}: number of roots'):
        runs.checks.near(np.abs(found - roots), 0, 1e-9*np.abs(roots).max(), f'{why}: roots', scale=1.0)


# --- equilibria, modes and linearised equations of motion ---

def test_linear_motor_at_rest(runs):
    motor = LINEAR_MOTOR
    table = runs.table(SLIDE + motor, '--equilibrium')
    runs.checks.near([table['q1'][0], table['M1.current'][0], table['M1.torque'][0], table['stable'][0]], [0.3, 5, 15, 1], 1e-12,
                     'a linear motor against a spring')
    matrix = dc_matrix(10, 2, 0.1, 3, 2, 50, 1)[:3, :3]
    same_roots(runs, runs.table(SLIDE + motor, '--modes'), matrix, 'a linear motor against a spring')
    quasi = motor.replace('inductance=0.1, ', '')
    same_roots(runs, runs.table(SLIDE + quasi, '--modes'), [[0, 1], [-25, -(1 + 9/2)/2]], 'without inductance')


def test_flywheel_at_rest(runs):
    still = FLYWHEEL + "&motor coordinate=1, kind='dc', voltage=0, resistance=0.6, inductance=0.01, constant=0.3 /\n"
    table = runs.table(still, '--modes')
    same_roots(runs, table, dc_matrix(0, 0.6, 0.01, 0.3, 0.02)[:3, :3], 'a flywheel without voltage')
    runs.checks.true(0.0 in table['eigenvalue.re'], 'its place does not matter: a root is zero', table['eigenvalue.re'])
    runs.checks.equal(runs.table(still, '--equilibrium')['stable'][0], 1.0, 'it is stable, neutral included')
    done = run(runs.mech9d, runs.path(still.replace('voltage=0', 'voltage=24')), '--equilibrium', folder=runs.folder)
    runs.checks.equal(done.returncode, 5, 'a motor that nothing holds has no place of rest')


# m l^2 + J = 0.42; held at 0.5 by the integral alone
HOLDING = "&motor coordinate=1, kind='pid', proportional=40, integral=30, derivative=6, limit={}, setpoint=0.5 /\n"


@pytest.mark.parametrize('more', ['', "&motor coordinate=1, kind='dc', voltage=3, resistance=0.6, inductance=0.02, constant=0.3 /\n"],
                         ids=['alone', 'with_a_motor'])
def test_pendulum_held_by_a_controller(runs, more):
    weight = 2*9.81*0.4
    held = weight*math.cos(0.5) - (0.3*3/0.6 if more else 0)
    table = runs.table(PENDULUM + HOLDING.format(50) + more, '--equilibrium')
    runs.checks.near([table['q1'][0], table['M1.torque'][0], table['M1.integral'][0]], [0.5, held, held/30], 1e-12,
                     'a controller holds a pendulum')
    matrix = np.zeros((4, 4))
    matrix[0, 1] = 1
    matrix[1] = np.array([weight*math.sin(0.5) - 40, -6, 30, 0.3])/0.42
    matrix[2, 0] = -1
    matrix[3] = [0, -0.3/0.02, 0, -0.6/0.02]
    n = 4 if more else 3
    same_roots(runs, runs.table(PENDULUM + HOLDING.format(50) + more, '--modes'), matrix[:n, :n], 'a held pendulum')


def test_controller_that_is_too_weak(runs):
    done = run(runs.mech9d, runs.path(PENDULUM + HOLDING.format(2)), '--equilibrium', folder=runs.folder)
    runs.checks.equal(done.returncode, 5, 'a controller that is too weak')


def test_motor_without_voltage_moves_no_place_of_rest(runs):
    text = FOUR_BAR.format(a=1, b=2, c=3, d=4).replace('voltage=12', 'voltage=0')
    one = runs.table(text, '--equilibrium')
    two = runs.table(text.split('&motor')[0], '--equilibrium')
    runs.checks.near(one['q1'], two['q1'], 1e-9, 'a motor without voltage does not move the place of rest')


def test_linearised_motion_with_a_motor(runs):
    try:
        import h5py
    except ImportError:
        runs.checks.left_out('h5py is not installed (Debian: python3-h5py)')
        return
    path = os.path.join(runs.folder, 'linear.h5')
    done = run(runs.mech9d, runs.path(SLIDE + LINEAR_MOTOR), '--linear', path, folder=runs.folder)
    runs.checks.equal(done.returncode, 0, '--linear with a motor')
    with h5py.File(path, 'r') as file:
        space = file['state_space']
        runs.checks.near(space['A'][:], dc_matrix(10, 2, 0.1, 3, 2, 50, 1)[:3, :3], 1e-12, 'A has the current')
        runs.checks.near(space['B'][:], [[0, 0], [0.5, 0], [0, 10]], 1e-12, 'B has the voltage')
        runs.checks.near(space['C'][:], [[1, 0, 0], [0, 1, 0], [-25, -0.5, 1.5]], 1e-12, 'C has the current')
        runs.checks.near(space['D'][:], [[0, 0], [0, 0], [0.5, 0]], 1e-12, 'D has the voltage')
        names = [name.decode() if hasattr(name, 'decode') else str(name) for name in space['state'][:]]
        runs.checks.equal(names, ['q1', 'dq1', 'M1.current'], 'names of the states')
        names = [name.decode() if hasattr(name, 'decode') else str(name) for name in space['input'][:]]
        runs.checks.equal(names, ['Q1', 'M1.voltage'], 'names of the inputs')


DC = "&motor coordinate={k}, kind='dc', voltage={u}, resistance={r}, inductance={l}, constant={c} /\n"
GOOD = {'k': 1, 'u': 12, 'r': 0.6, 'l': 0.01, 'c': 0.3}
PID = "&motor coordinate=1, kind='pid', {more} /\n"
REFUSED = {
    'no resistance': (DC.format(**{**GOOD, 'r': 0}), ["'resistance' must be >0"]),
    'negative resistance': (DC.format(**{**GOOD, 'r': -2}), ["'resistance' must be >0"]),
    'negative inductance': (DC.format(**{**GOOD, 'l': -1}), ["'inductance'"]),
    'no torque': (DC.format(**{**GOOD, 'c': 0}), ["'constant' must be >0"]),
    'no such coordinate': (DC.format(**{**GOOD, 'k': 3}), ['there is no coordinate 3; they are 1 to 1']),
    'no voltage': (DC.format(**GOOD).replace('voltage=12, ', ''), ['no voltage', 'voltage=', 'law=']),
    'no gear': (DC.format(**GOOD).replace(' /', ', gear_ratio=0 /'), ['gear_ratio=0']),
    'a gain of a motor': (DC.format(**GOOD).replace(' /', ', proportional=1 /'), ["does not belong to motors of kind 'dc'"]),
    'no setpoint': (PID.format(more='proportional=1'), ['no setpoint', 'setpoint=', 'law=']),
    'two setpoints': (PID.format(more="proportional=1, setpoint=1, law='polynomial', coefficients=1"), ['given twice']),
    'no gain': (PID.format(more='setpoint=1'), ['no gain']),
    'a negative gain': (PID.format(more='setpoint=1, proportional=-1'), ["'proportional'"]),
    'limit 0': (PID.format(more='setpoint=1, proportional=1, limit=0'), ["'limit' must be >0"]),
    'limit -3': (PID.format(more='setpoint=1, proportional=1, limit=-3'), ["'limit' must be >0"]),
    'two integral parts': (2*PID.format(more='setpoint=1, integral=1'), ['two never come to rest']),
    'integral part with limit': (PID.format(more='setpoint=1, integral=1, limit=3'), ['integral part alone'])}


@pytest.mark.parametrize('why', REFUSED)
def test_motors_that_are_refused(runs, why):
    motor, words = REFUSED[why]
    runs.refused(FLYWHEEL + motor, words, why)


def test_setpoint_that_ends_before_the_run(runs):
    motor = PID.format(more="proportional=1, law='segments', times=0,1, values=0,1, laws='harmonic'")
    done = run(runs.mech9d, runs.path(FLYWHEEL + motor + time(2.0)), '--no-write', folder=runs.folder)
    runs.checks.equal(done.returncode, 3, 'a setpoint that ends before the run')
    runs.checks.true('law in segments of the motor 1 has no value after t = 1 s, and the run goes on to' in done.stderr, 'named', done.stderr)


def test_motors_of_coordinates_that_are_not_free(runs):
    text = FOUR_BAR.format(a=1, b=2, c=3, d=4)
    runs.refused(text.replace('&motor coordinate=1', '&motor coordinate=3'),
                 ['coordinate 3 is dependent and cannot have a motor', 'cq = 3 would make it independent'], 'a dependent coordinate')
    runs.refused(ARM + DC.format(**GOOD), ['coordinate 1 has the drive of line 8', 'leave one of the two out'], 'a driven coordinate')


def test_check_of_a_motor(runs):
    done = run(runs.mech9d, runs.path(FLYWHEEL + DC.format(**GOOD)), '--check', folder=runs.folder)
    runs.checks.equal(done.returncode, 0, '--check of a motor')



MOTORS = ("&motor coordinate=2, kind='pid', proportional=30, integral=20, setpoint=0.9 /\n"
          "&motor coordinate=2, kind='dc', voltage=6, resistance=0.7, constant=0.4 /\n")


def test_columns_of_motors(runs):
    """In the table and in the HDF5 file."""
    text = ARM + MOTORS + time(1.0)
    path = os.path.join(runs.folder, 'case.h5')
    table = runs.table(text, '--hdf5', path)
    names = [name for name in table if name.startswith('M')]
    runs.checks.equal(names, ['M1.integral', 'M1.torque', 'M2.current', 'M2.torque'], 'columns in the order of the groups')
    try:
        import h5py
    except ImportError:
        runs.checks.left_out('h5py is not installed (Debian: python3-h5py)')
    else:
        with h5py.File(path, 'r') as file:
            for name in names:
                runs.checks.true(np.array_equal(file[name.replace('.', '_')][:], table[name]), f'{name} in the HDF5 file')
            runs.checks.equal(file['M2_current'].attrs['units'].decode() if hasattr(file['M2_current'].attrs['units'], 'decode')
                              else str(file['M2_current'].attrs['units']), 'A', 'unit of the current')


def test_mech9k_leaves_motors_out(runs):
    """There all is driven, and the drive shows the torque that the motor would have to give."""
    text = ARM.replace('&drive coordinate=1', "&drive coordinate=2, kind='polynomial', coefficients=0.4,1 /\n&drive coordinate=1")
    output = '&output drive_forces=.true. /\n'
    one = runs.table(text.replace('&initial coordinate=2, position=0.4 /\n', '') + time(1.0) + output, program=runs.mech9k)
    two = runs.table(text.replace('&initial coordinate=2, position=0.4 /\n', '') + MOTORS + time(1.0) + output, program=runs.mech9k)
    runs.checks.equal(sorted(one), sorted(two), 'mech9k has no columns of motors')
    runs.checks.true(all(np.array_equal(one[name], two[name]) for name in one), 'mech9k leaves motors out')
