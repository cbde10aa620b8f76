"""Derivatives of free motions by parameters, as several tests of them need: mechanisms, and runs that are compared with differences of
runs."""
import os

import numpy as np

from mech9_cases import read_table, run

# The promise: derivatives within this many times the tolerance, of the largest of their kind.
TOLERANCES = 100
TOLERANCE = 1e-12
SOLVER = f'&solver relative_tolerance={TOLERANCE!r}, absolute_tolerance={TOLERANCE!r} /\n'
# Differences of runs that err by some 1e-12 of themselves, over steps of some thousandths, know eight digits.
BY_RUNS = 1e-7
WEIGHTS = (4 / 5, -1 / 5, 4 / 105, -1 / 280)


FOUR_BAR = """&structure cq=1 /
&pair coordinate=1, links=1,2, kind='revolute', point=0.01,0.02,0, axis=0,0,1, moving_point=0,0,0 /
&pair coordinate=2, links=2,3, kind='revolute', point=0.3,0,0, axis=0,0,1, moving_point=0,0,0 /
&pair coordinate=3, links=3,4, kind='revolute', point=0.9,0,0, axis=0,0,1, moving_point=0.7,0,0 /
&pair coordinate=4, links=1,4, kind='revolute', point=1,0,0, axis=0,0,1, moving_point=0,0,0 /
&initial coordinate=1, position=0.2, velocity=1.0 /
&initial coordinate=2, position=0.5 /
&initial coordinate=4, position=1.0 /
&body link=2, mass=2, centre=0.15,0,0, inertia=0.015,0.015,0.02,0,0,0 /
&body link=3, mass=1, centre=0.4,0.1,0, inertia=0.03,0.03,0.05,0,0,0 /
&body link=4, mass=1.5, centre=0.4,0,0, inertia=0.03,0.03,0.04,0,0,0 /
&gravity acceleration=0,-9.81,0 /
&load kind='coordinate', coordinate=4, stiffness=3, rest=0.5, damping=0.2 /
&load kind='force', link=3, position=0.4,0.2,0, force=1,2,0, law='harmonic', mean=1, amplitude=0.5, angular_frequency=3 /
&load kind='spring', links=1,3, position=0.2,0.9,0, second_position=0.4,0.1,0, stiffness=12, free_length=0.2, damping=0.3 /
&point name='P', link=3, position=0.4,0.2,0.1 /
&time end=0.6, intervals=4 /
"""
FOUR_BAR_PARAMETERS = (
    ('crank', 'pair(2).point(1)', 0.3), ('rocker', 'pair(3).moving_point(1)', 0.7), ('base', 'pair(4).point(2)', 0.0),
    ('mass', 'body(2).mass', 1.0), ('centre', 'body(2).centre(1)', 0.4), ('inertia', 'body(3).inertia(3)', 0.04),
    ('sideways', 'gravity.acceleration(1)', 0.0), ('first', 'initial(1).position', 0.2), ('rate', 'initial(1).velocity', 1.0),
    ('rest', 'load(1).rest', 0.5), ('damper', 'load(1).damping', 0.2), ('often', 'load(2).angular_frequency', 3.0),
    ('push', 'load(2).force(2)', 2.0), ('at', 'load(2).position(1)', 0.4), ('end', 'load(3).second_position(2)', 0.1),
    ('stiff', 'load(3).stiffness', 12.0), ('free', 'load(3).free_length', 0.2), ('slow', 'load(3).damping', 0.3))

# A pendulum of 20 kg swings a rocker through its dead points, so that the independent coordinates change.
PENDULUM_FOUR_BAR = """&structure cq=4 /
&pair coordinate=1, links=1,2, kind='revolute', axis=0,0,1, point=0.0, 0.0,0 /
&pair coordinate=2, links=2,3, kind='revolute', axis=0,0,1, point=0.0,-1.0,0 /
&pair coordinate=3, links=3,4, kind='revolute', axis=0,0,1, point=1.5,-3.0,0 /
&pair coordinate=4, links=1,4, kind='revolute', axis=0,0,1, point=2.7,-1.4,0 /
&initial coordinate=1, position=-1.3 /
&initial coordinate=4, position=-0.55, velocity=0 /
&body link=2, mass=20, centre=0.0,-1.0,0, inertia=0.5,0.5,0.5,0,0,0 /
&body link=3, mass=1, centre=0.75,-2.0,0, inertia=0.3,0.3,0.6,0,0,0 /
&body link=4, mass=1, centre=2.1,-2.2,0, inertia=0.2,0.2,0.4,0,0,0 /
&gravity acceleration=0,-9.81,0 /
&time end=3, intervals=6 /
"""

# A bead on a hoop that a drive turns: one coordinate is driven, one is free.
BEAD = """&structure cq=1,2 /
&pair coordinate=1, links=1,2, kind='revolute', axis=0,1,0 /
&pair coordinate=2, links=2,3, kind='revolute', axis=0,0,1 /
&drive coordinate=1, kind='{law}' /
&initial coordinate=2, position=0.8 /
&body link=3, mass=0.7, centre=0.0,-0.5,0.0 /
&gravity acceleration=0.0,-9.81,0.0 /
&point name='P', link=3, position=0.0,-0.5,0.0 /
&time end=2, intervals=5 /
"""
TURNING = BEAD.format(law="polynomial', coefficients=0.0,7.1,-0.3 / !")

# Two crossed axes, a mass beside both: the mechanism is spatial, open, and has a prismatic and a helical pair.
SPATIAL = """&structure cq=1,2,3 /
&pair coordinate=1, links=1,2, kind='helical', pitch=0.3, axis=0.1,0.2,1, point=0.1,0,0 /
&pair coordinate=2, links=2,3, kind='revolute', axis=1,0.3,0, point=0.4,0.1,0.2 /
&pair coordinate=3, links=3,4, kind='prismatic', axis=0,1,0.5, point=0.1,0.2,0.3 /
&initial coordinate=1, position=0.2, velocity=1.5 /
&initial coordinate=2, position=0.4, velocity=-0.6 /
&initial coordinate=3, position=0.1, velocity=0.2 /
&body link=2, mass=2, centre=0.2,0.1,0, inertia=0.05,0.06,0.07,0.01,0,0 /
&body link=3, mass=1, centre=0.1,0.2,0.1, inertia=0.03,0.04,0.05,0,0.01,0 /
&body link=4, mass=1.5, centre=0.3,0,0.1, inertia=0.03,0.03,0.04,0,0,0.01 /
&gravity acceleration=0,0,-9.81 /
&load kind='coordinate', coordinate=3, stiffness=60, damping=0.5 /
&load kind='force', link=4, position=0.1,0.2,0, force=1,2,3, frame='link' /
&point name='P', link=4, position=0.4,0.2,0.1 /
&time end=1, intervals=4 /
"""
SPATIAL_PARAMETERS = (
    ('pitch', 'pair(1).pitch', 0.3), ('tilt', 'pair(2).axis(2)', 0.3), ('lift', 'pair(2).point(3)', 0.2),
    ('slant', 'pair(3).axis(3)', 0.5), ('centre', 'body(3).centre(3)', 0.1), ('product', 'body(1).inertia(4)', 0.01),
    ('force', 'load(2).force(3)', 3.0), ('mass', 'body(3).mass', 1.5), ('fast', 'initial(2).velocity', -0.6))


def declared(parameters):
    return ''.join(f"&parameter name='{name}', sets={target if target.startswith(chr(39)) else repr(target)}, value={value!r} /\n"
                   for name, target, value in parameters)


class Case:
    """A directory for files, the programs, and the checks."""

    def __init__(self, checks, directory, mech9k, mech9d):
        self.checks, self.directory, self.mech9k, self.mech9d = checks, directory, mech9k, mech9d

    def table(self, text, *options, program=None):
        """The columns of a run by name."""
        path = os.path.join(self.directory, 'a.nml')
        with open(path, 'w') as file:
            file.write(text)
        done = run(program or self.mech9d, path, '--quiet', '--table', '-', *options)
        if done.returncode != 0:
            raise RuntimeError(f'{text}{options} ended with {done.returncode}:\n{done.stderr}')
        return {name: np.array(column) for name, column in read_table(done.stdout).items()}

    def sensitivities(self, text, parameters, *options, program=None):
        return self.table(text + declared(parameters) + '&output sensitivities=.true. /\n', *options, program=program)

    def refused(self, text, code, words):
        path = os.path.join(self.directory, 'a.nml')
        with open(path, 'w') as file:
            file.write(text)
        done = run(self.mech9d, path, '--quiet', '--table', os.path.join(self.directory, 'a.dat'))
        self.checks.equal(done.returncode, code, f'{words}: code {code}')
        self.checks.true(words in ' '.join(done.stderr.split()), f'the message says: {words}', done.stderr)

    def close(self, mine, expected, tolerance, why):
        largest = max(float(np.abs(expected).max()), 1e-3)
        error = np.abs(mine - expected).max()
        self.checks.true(error <= tolerance * largest, why, f'error {error:.2e}, largest {largest:.2e}')

    def against_runs(self, text, parameters, why, part=2.0**-9):
        """Derivatives against differences of runs at other values of the parameters, in steps of a part of them."""
        found = self.sensitivities(text + SOLVER, parameters)
        for number, (name, _, value) in enumerate(parameters, 1):
            step = part * (1.0 if value == 0 else max(abs(value), 0.1))
            runs = [[self.table(text + SOLVER + declared(parameters), '--set', f'parameter({number}).value={value + sign * i * step!r}')
                     for sign in (1, -1)] for i in (1, 2, 3, 4)]
            for column in runs[0][0]:
                if f'd({column})/d({name})' not in found:
                    continue
                expected = sum(weight * (above[column] - below[column]) / step for weight, (above, below) in zip(WEIGHTS, runs))
                self.close(found[f'd({column})/d({name})'], expected, BY_RUNS, f'{why}: {column} by {name}')
