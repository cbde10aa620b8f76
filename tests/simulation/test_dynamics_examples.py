"""The examples of dynamics against reference trajectories, at tolerances that fall."""
import os

import numpy as np
import pytest

import data_file
from mech9_cases import ACCELERATION, POSITION, REFERENCE, TREE, read_csv, table_and_report, text_of

ANGLES = ('beta', 'theta', 'gamma', 'phi', 'delta', 'omega', 'epsilon')
TOLERANCES = (1e-4, 1e-7, 1e-10, 1e-12)


class Problem:
    """A data file of examples/, its reference, the table's column for each of the reference's, and how errors grow:
    an integrator that errs by the tolerance in a step errs by at most tolerance times steps times sensitivity. What the motion
    keeps does not grow: it errs by at most tolerance times steps, energies by twice that, as they are squares of rates."""

    def __init__(self, example, reference, columns, growth, tolerances=TOLERANCES, also=None):
        self.data = os.path.join(TREE, 'examples', example + '.nml')
        self.expected = read_csv(os.path.join(REFERENCE, reference + '.csv'))
        self.columns, self.growth, self.tolerances, self.also = columns, growth, tolerances, also

    def error(self, table):
        """The largest error of any column at any time, over its value there or, where that is smaller, over 1 or the largest
        value of the column."""
        rows = len(table['t'])
        worst = 0.0
        for mine, theirs in self.columns:
            expected = self.expected[theirs][:rows]
            scale = np.maximum(min(1.0, np.max(np.abs(expected))), np.abs(expected))
            worst = max(worst, np.max(np.abs(table[mine] - expected) / scale))
        return worst


def check_pendulum(checks, table, kept, grown):
    checks.true(np.max(np.abs(table['E.total'])) <= 2 * kept * np.max(table['E.kinetic']), 'nothing is lost')


def check_andrews(checks, table, kept, grown):
    """Accelerations at the start, as published, and at the end; the work of the torque."""
    beta2, theta2 = 14222.4439199541138705911625887, -10666.8329399655854029433719415
    for k, value in enumerate((beta2, theta2, 0.0, 0.0, 0.0, 0.0, 0.0), 1):
        checks.near(table[f'ddq{k}'][0] / beta2, value / beta2, ACCELERATION, f'the acceleration {k} at the start')
    last = read_csv(os.path.join(REFERENCE, 'a03_andrews_t003.csv'))['ours']
    for k in range(1, 8):
        # accelerations grow with the square of rates, and with positions 30 times faster
        checks.near(table[f'ddq{k}'][-1], last[13 + k], 30 * grown, f'the acceleration {k} at t = 0.03 s')
    check_work(checks, table, kept, grown)


def check_work(checks, table, kept, grown):
    work = 0.033 * (table['q1'] - table['q1'][0])
    checks.near(table['E.total'] - table['E.total'][0], work, 2 * kept, 'the energy grows by the work of the torque')


def check_flyball(checks, table, kept, grown):
    """Both sides move alike, and the moment of momentum about the shaft is kept."""
    # both chains are closed to round-off
    checks.near(table['q3'], table['q4'], POSITION, 'both rods are at the same angle')
    mass, centre, along, across = 5.3, (0.3 * 0.5 + 5.0) / 5.3, 5e-6, 0.09575721698113208
    c, s = np.cos(table['q3']), np.sin(table['q3'])
    turning = 5e-6 + 0.005 + 2 * (mass * (0.05 + centre * c) ** 2 + across * c ** 2 + along * s ** 2)
    checks.near(turning * table['dq1'] / (turning[0] * 2 * np.pi), 1.0, kept, 'the moment of momentum is kept')
    checks.true(np.all(np.diff(table['E.total']) <= 2 * kept * np.max(table['E.kinetic'])), 'the dampers only take energy')


def check_slider_crank(checks, table, kept, grown):
    """Five digits are published at the end."""
    for column, value in (('q1', 1.2757), ('q4', 1.0236), ('q3', -0.49881)):
        checks.near(table[column][-1], value, 5e-5, f'{column} as published')


PROBLEMS = {
    # at most a thousand steps, and an error of energy turns into ten times that of phase in 10 s at 10 m/s^2
    'pendulum': lambda: Problem('pendulum/pendulum', 'a01_pendulum',
        [('P.x', 'x'), ('P.y', 'y'), ('P.vx', 'vx'), ('P.vy', 'vy')], growth=1e4, also=check_pendulum),
    # some 800 steps; the two published starts differ by 2.86e-4 in beta, and by 37 times that after 0.03 s
    'andrews': lambda: Problem('andrews/andrews', 'a03_andrews_ivp',
        [(f'q{k}', name) for k, name in enumerate(ANGLES, 1)]
        + [(f'dq{k}', name + '_dot') for k, name in enumerate(ANGLES, 1)], growth=3e4, also=check_andrews),
    'andrews_iftomm': lambda: Problem('andrews/andrews_iftomm', 'a03_andrews_iftomm',
        [('q1', 'beta'), ('dq1', 'beta_dot'), ('F.x', 'xF'), ('F.y', 'yF'), ('F.vx', 'vxF'), ('F.vy', 'vyF')],
        growth=3e4, also=check_work),
    # a multistep method: some thousand steps, of which those while the governor swings once, 0.9 s, add up; an error
    # of the shaft's speed turns it by ten times that in 10 s
    'flyball_governor': lambda: Problem('flyball_governor/flyball_governor', 'a05_flyball',
        [('q2', 's'), ('dq2', 's_dot'), ('q3', 'alpha'), ('q4', 'alpha'), ('dq3', 'alpha_dot'), ('dq4', 'alpha_dot'),
         ('q1', 'psi'), ('dq1', 'omega')], growth=3e3, tolerances=(1e-5, 1e-8, 1e-11, 1e-13), also=check_flyball),
    # the damper forgets errors within seconds: a few dozen steps count
    'slider_crank_sundials': lambda: Problem('slider_crank_sundials/slider_crank', 'sundials_slider_crank',
        [('q1', 'q'), ('q4', 'x'), ('q3', 'p'), ('dq1', 'q_dot'), ('dq4', 'x_dot'), ('dq3', 'p_dot')],
        growth=1e2, also=check_slider_crank),
}


@pytest.mark.parametrize('name', PROBLEMS)
def test_example_against_its_reference(checks, mech9d, name):
    problem = PROBLEMS[name]()
    errors = []
    for tolerance in problem.tolerances:
        table, report = table_and_report(mech9d, problem.data, '--set', f'solver.relative_tolerance={tolerance}',
                                         '--set', f'solver.absolute_tolerance={tolerance}')
        checks.near(table['t'], problem.expected['t'][:len(table['t'])], 1e-15, 'the times of the reference')
        errors.append(problem.error(table))
        checks.true(errors[-1] <= problem.growth * tolerance,
                    f'{name}: the error follows the tolerance {tolerance:.0e}', f'it is {errors[-1]:.3e}')
        # closure is round-off, whatever the tolerance
        checks.true(np.max(table['closure']) <= 1e-13 * report['size'], f'{name}: the chains are closed in every row')
    print(name, ' '.join(f'{tolerance:.0e}: {error:.2e}' for tolerance, error in zip(problem.tolerances, errors)))
    # coarse tolerances may all be met by steps from output to output; then the errors are alike
    checks.true(all(after <= 1.5 * before for before, after in zip(errors, errors[1:])), f'{name}: errors fall', errors)
    checks.true(errors[-1] <= max(1e-2 * errors[0], 1e-12), f'{name}: the last error is far below the first', errors)
    # nine digits are asked of the least tolerance, of which the references have more
    checks.true(errors[-1] <= 1e-9, f'{name}: the error falls below 1e-9', errors)
    problem.also(checks, table, report['steps'] * tolerance, problem.growth * tolerance)


@pytest.mark.parametrize('name', PROBLEMS)
def test_example_as_it_stands(checks, mech9d, name):
    """Right with the tolerance of its own data file."""
    problem = PROBLEMS[name]()
    own = dict(data_file.parse(text_of(problem.data)))['solver']['relative_tolerance'][0]
    as_it_stands, _ = table_and_report(mech9d, problem.data)
    checks.true(problem.error(as_it_stands) <= problem.growth * float(own),
                f'{name}: right with the tolerance of its own data file', problem.error(as_it_stands))
