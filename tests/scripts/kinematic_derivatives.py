"""Derivatives of driven motions by parameters, as several tests of them need: mechanisms, runs that are compared with differences of runs,
and a four-bar linkage in closed form in extended precision."""
import os

import numpy as np

from mech9_cases import read_table, run

# Differences of runs in double precision at steps of 1/128 lose two digits, and the conditioning of the chains.
BY_RUNS = 1e-9
WEIGHTS = (4 / 5, -1 / 5, 4 / 105, -1 / 280)
STEP = 2.0**-7

FOUR_BAR = """&structure cq=1 /
&pair coordinate=1, links=1,2, kind='revolute', point=0.01,0.02,0, axis=0,0,1, moving_point=0,0,0 /
&pair coordinate=2, links=2,3, kind='revolute', point=0.3,0,0, axis=0,0,1, moving_point=0,0,0 /
&pair coordinate=3, links=3,4, kind='revolute', point=0.9,0,0, axis=0,0,1, moving_point=0.7,0,0 /
&pair coordinate=4, links=1,4, kind='revolute', point=1,0,0, axis=0,0,1, moving_point=0,0,0 /
&initial coordinate=2, position=0.5 /
&initial coordinate=4, position=1.0 /
&drive coordinate=1, kind='harmonic', mean=0.3, amplitude=1.4, angular_frequency=2, phase=0.2 /
&point name='P', link=3, position=0.4,0.2,0.1 /
&time end=2, intervals=20 /
&output sensitivities=.true. /
"""
# name, target and value; the closed form takes the values in this order
FOUR_BAR_PARAMETERS = (
    ('crank', 'pair(2).point(1)', 0.3), ('coupler', 'pair(3).point(1)', 0.9), ('rocker', 'pair(3).moving_point(1)', 0.7),
    ('base', 'pair(4).point(2)', 0.0), ('mean', 'drive.mean', 0.3), ('swing', 'drive.amplitude', 1.4),
    ('speed', 'drive.angular_frequency', 2.0), ('phase', 'drive.phase', 0.2), ('place', 'point.position(2)', 0.2))

PARALLELOGRAM_CHAIN = """&structure cq=1 /
&pair coordinate=1, links=1,2, kind='revolute', axis=0,0,1 /
&pair coordinate=2, links=2,3, kind='revolute', point=0.5,0,0, axis=0,0,1, moving_point=0,0,0 /
&pair coordinate=3, links=3,4, kind='revolute', point=1,0,0, axis=0,0,1, moving_point=0.5,0,0 /
&pair coordinate=4, links=1,4, kind='revolute', point=1,0,0, axis=0,0,1, moving_point=0,0,0 /
&initial coordinate=2, position=-1 /
&initial coordinate=4, position=1 /
&drive coordinate=1, kind='polynomial', coefficients=1,1 /
"""
PARALLELOGRAM = PARALLELOGRAM_CHAIN + """&point name='P', link=3, position=0.5,0.1,0 /
&parameter name='crank', sets='pair(2).point(1)' /
&time end={end}, intervals=4 /
&output sensitivities=.true. /
"""

GEARED = """&structure cq=1 /
&pair coordinate=1, links=1,2, kind='revolute', axis=0,0,1 /
&pair coordinate=2, links=1,3, kind='revolute', point=1,0,0, axis=0,0,1, moving_point=0,0,0 /
&pair coordinate=3, links=2,4, kind='revolute', point=0.2,0,0, axis=0,0,1, moving_point=0,0,0 /
&pair coordinate=4, links=3,5, kind='revolute', point=0.25,0,0, axis=0,0,1, moving_point=0,0,0 /
&pair coordinate=5, links=4,5, kind='revolute', point=0.8,0,0, axis=0,0,1, moving_point=0.8,0,0 /
&coupling kind='gear', coordinates=1,2, ratio=-1.5, phase=1.1 /
&initial coordinate=3, position=0.4 /
&initial coordinate=4, position=0.9 /
&initial coordinate=5, position=-1 /
&drive coordinate=1, kind='polynomial', coefficients=0.3,2 /
&point name='P', link=4, position=0.4,0.1,0 /
&time end=1, intervals=8 /
&output sensitivities=.true. /
"""


def of_motion(names):
    """The numbers of the columns that have derivatives, by kinds."""
    kinds = {}
    for i, name in enumerate(names):
        if name in ('t', 'closure', 'conditioning') or name.startswith('d('):
            continue
        kind = name.rstrip('0123456789') if '.' not in name else 'P.' + name.split('.')[1][:-1]
        kinds.setdefault(kind, []).append(i)
    return kinds


class Case:
    """A directory for files, the programs, and the checks."""

    def __init__(self, checks, directory, mech9k, mech9d):
        self.checks, self.directory, self.mech9k, self.mech9d = checks, directory, mech9k, mech9d

    def table(self, text, *options):
        """Names of the columns and rows of a run."""
        path = os.path.join(self.directory, 'a.nml')
        with open(path, 'w') as file:
            file.write(text)
        done = run(self.mech9k, path, '--quiet', '--table', '-', *options)
        if done.returncode != 0:
            raise RuntimeError(f'{text}{options} ended with {done.returncode}:\n{done.stderr}')
        columns = read_table(done.stdout)
        return list(columns), np.array(list(columns.values())).T

    def refused(self, text, code, words, program=None):
        path = os.path.join(self.directory, 'a.nml')
        with open(path, 'w') as file:
            file.write(text)
        done = run(program or self.mech9k, path, '--quiet', '--table', os.path.join(self.directory, 'a.dat'))
        self.checks.equal(done.returncode, code, f'{words}: code {code}')
        self.checks.true(words in ' '.join(done.stderr.split()), f'the message says: {words}', done.stderr)

    def compare(self, names, rows, parameter, expected, tolerance, why):
        """Derivatives by one parameter against a table of expected ones with the columns of the motion."""
        for kind, columns in of_motion(names).items():
            mine = rows[:, [names.index(f'd({names[i]})/d({parameter})') for i in columns]]
            largest = np.abs(expected[:, columns]).max()
            error = np.abs(mine - expected[:, columns]).max()
            self.checks.true(error <= tolerance * max(float(largest), 1e-3), f'{why}: {kind} by {parameter}',
                             f'error {error:.2e}, largest {largest:.2e}')

    def against_runs(self, text, parameters, why, tolerance=BY_RUNS, relative_step=STEP):
        """Derivatives against differences of runs at other values of the parameters."""
        declared = ''.join(f"&parameter name='{name}', sets='{target}', value={value!r} /\n" for name, target, value in parameters)
        names, rows = self.table(text + declared)
        plain = text.replace('sensitivities=.true.', 'sensitivities=.false.') + declared
        for number, (name, _, value) in enumerate(parameters, 1):
            step = relative_step * (abs(value) or 1.0)
            expected = 0
            for i, weight in enumerate(WEIGHTS, 1):
                above, below = (self.table(plain, '--set', f'parameter({number}).value={value + sign * i * step!r}')[1]
                                for sign in (1, -1))
                expected = expected + weight * (above - below) / step
            self.compare(names, rows, name, expected, tolerance, why)


def differences(function, values, number):
    """The derivative of a closed form by one of its values, in extended precision."""
    step = np.longdouble(2.0**-9)
    total = 0
    for i, weight in enumerate(WEIGHTS, 1):
        weight = (np.longdouble(4) / 5, -np.longdouble(1) / 5, np.longdouble(4) / 105, -np.longdouble(1) / 280)[i - 1]
        above, below = (np.array([v + (sign * i * step if k == number else 0) for k, v in enumerate(values)]) for sign in (1, -1))
        total = total + weight * (function(above) - function(below)) / step
    return total


def vector(z):
    return [z.real, z.imag]


def four_bar_motion(values, t, upper):
    """q, dq, ddq of the four pairs and the motion of P, by columns, from the formulas of the four-bar linkage."""
    a, b, c, base, mean, swing, speed, phase, place = values
    j = np.clongdouble(1j)
    angle = speed * t + phase
    q1, w1, e1 = mean + swing * np.sin(angle), swing * speed * np.cos(angle), -swing * speed**2 * np.sin(angle)
    crank = a * np.exp(j * q1)
    start = np.clongdouble(complex(0.01, 0.02))
    reach = (1 + j * base) - start - crank
    length = np.abs(reach)
    theta = np.angle(reach) + upper * np.arccos((length**2 + b**2 - c**2) / (2 * b * length))
    coupler = b * np.exp(j * theta)
    rocker = coupler - reach
    q4 = np.angle(rocker)

    def solve(right):
        # i coupler x - i rocker y = right
        m11, m12, m21, m22 = -coupler.imag, rocker.imag, coupler.real, -rocker.real
        det = m11 * m22 - m12 * m21
        return (right.real * m22 - m12 * right.imag) / det, (m11 * right.imag - right.real * m21) / det

    w3, w4 = solve(-j * crank * w1)
    a3, a4 = solve(-(j * e1 - w1**2) * crank + w3**2 * coupler - w4**2 * rocker)
    arm = np.exp(j * theta) * (np.longdouble(0.4) + j * place)
    point = start + crank + arm
    velocity = j * w1 * crank + j * w3 * arm
    acceleration = (j * e1 - w1**2) * crank + (j * a3 - w3**2) * arm
    zero = 0 * t
    return np.array([t, q1, theta - q1, q4 - theta, q4, w1, w3 - w1, w4 - w3, w4, e1, a3 - e1, a4 - a3, a4,
                     *vector(point), zero + 0.1, *vector(velocity), zero, *vector(acceleration), zero])
