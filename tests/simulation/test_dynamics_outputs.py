"""Outputs inside steps: the steps do not depend on how many outputs there are, and a row inside a step is as accurate as
the end of one.

Compares the program with itself: a row inside a step and the same row at the end of a run.

The oracle for a row of a Runge-Kutta method is a run that ends at its time: the last step of a run ends there exactly.
Both runs take the same steps but for the last two, whose errors are at most the tolerances, relative and absolute, of
each variable, in a mean over the n variables: a single one may have sqrt(n) times that. Two such errors and one tolerance
for what lies between the ends are allowed. (Multistep methods take other steps before an end, far back; test_integrator
holds them to closed forms.)
"""
import os

import numpy as np
import pytest

from mech9_cases import REFERENCE, TREE, table_and_report, table_of

EXAMPLES = os.path.join(TREE, 'examples')
# data file, independent coordinates, variables, end [s]
MOTIONS = {
    'andrews': (os.path.join(EXAMPLES, 'andrews', 'andrews.nml'), [1], 11, 0.03),
    'double_pendulum': (os.path.join(EXAMPLES, 'double_pendulum', 'double_pendulum.nml'), [1, 2], 4, 2.0),
    'fig1': (os.path.join(REFERENCE, 'dynamics_fig1.nml'), [5], 8, 1.0),
    'slider_crank': (os.path.join(REFERENCE, 'dynamics_spatial_slider_crank.nml'), [1], 8, 1.0),
    'governor': (os.path.join(EXAMPLES, 'flyball_governor', 'flyball_governor.nml'), [1, 2], 6, 0.5),
}
RUNS = [('andrews', 'prince-dormand', 1e-9), ('andrews', 'prince-dormand', 1e-5), ('andrews', 'merson', 1e-6),
        ('andrews', 'adams', 1e-8), ('double_pendulum', 'prince-dormand', 1e-10),
        ('double_pendulum', 'bdf', 1e-6), ('fig1', 'prince-dormand', 1e-7), ('fig1', 'dormand-prince', 1e-8),
        ('slider_crank', 'prince-dormand', 1e-8), ('slider_crank', 'verner', 1e-6), ('governor', 'bdf', 1e-6),
        ('governor', 'auto', 1e-6), ('fig1', 'auto', 1e-7)]


def settings(method, tolerance, end, intervals):
    words = {'solver.method': method, 'solver.relative_tolerance': tolerance, 'solver.absolute_tolerance': tolerance,
             'time.end': repr(end), 'time.intervals': intervals}
    return [word for name, value in words.items() for word in ('--set', f'{name}={value}')]


@pytest.mark.parametrize('name, method, tolerance', RUNS)
def test_outputs_inside_steps(checks, mech9d, name, method, tolerance):
    data, independent, variables, end = MOTIONS[name]
    why = f'{name}, {method}, {tolerance:g}'
    columns = [letter + str(k) for k in independent for letter in ('q', 'dq')]
    few, report = table_and_report(mech9d, data, *settings(method, tolerance, end, 10))
    many, report_of_many = table_and_report(mech9d, data, *settings(method, tolerance, end, 2000))
    checks.equal(report_of_many['steps'], report['steps'], f'{why}: the same steps with 10 and with 2000 outputs')
    if method in ('prince-dormand', 'adams', 'bdf'):
        checks.true(report_of_many['evaluations'] <= 3 * report['evaluations'],
                    f'{why}: 2000 outputs take few evaluations more', [report['evaluations'], report_of_many['evaluations']])
    allowed = 1 + 2 * variables ** 0.5
    checks.true(np.max(many['closure']) <= 1e-13 * report['size'], f'{why}: the chains are closed in every row', np.max(many['closure']))
    for column in columns:
        scale = allowed * tolerance * (1 + np.abs(few[column]))
        checks.true(np.all(np.abs(many[column][::200] - few[column]) <= scale),
                    f'{why}: {column} does not depend on the other outputs', list(many[column][::200] - few[column]))
    if method in ('adams', 'bdf') or (name, method) == ('governor', 'auto'):
        return
    worst = 0.0
    for row in range(137, 2000, 331):
        exact = table_of(mech9d, data, *settings(method, tolerance, end * row / 2000, 1))
        for column in columns:
            value = exact[column][-1]
            worst = max(worst, abs(many[column][row] - value) / (tolerance * (1 + abs(value))))
    print(f'{why}: {report["steps"]} steps, {report["evaluations"]} evaluations, with 2000 outputs '
          f'{report_of_many["evaluations"]}, error inside steps {worst:.2g} tolerances')
    checks.true(worst <= allowed, f'{why}: a row inside a step is as accurate as the end of one', worst)
