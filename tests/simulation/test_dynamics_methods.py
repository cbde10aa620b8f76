"""All methods of integration on one closed-chain mechanism: as the tolerance is tightened from 1e-4 to 1e-12 they
come to one motion, those of one step at their theoretical order.

Compares the program with itself: the ends of one motion by all methods of integration.

The order is that of the error against the number of steps, from the tolerance 1e-7 on: with the few dozen steps
of coarser ones the error is not yet a power of the step. Steps are chosen by tolerance, not halved, so that the error
lies above or below its trend as steps happen to end: three quarters of the order must be reached, and a steeper fall
is no fault. (test_integrator holds the methods to their orders with equal steps.)

adams and bdf, whose steps are many, must be as good as their tolerance promises with prince-dormand: three times its error
or a hundred tolerances at most, on the smooth, long and sensitive motions of bench/accuracy.md.

auto costs little more than the better one of prince-dormand and bdf, and tells which steps were made by bdf.
"""
import math
import os

import numpy as np
import pytest

import tolerance_factors
from mech9_cases import REFERENCE, table_and_report

ORDERS = {'merson': 4, 'dormand-prince': 5, 'verner': 6, 'fehlberg': 8, 'prince-dormand': 8}
TOLERANCES = [10.0 ** -k for k in range(4, 13)]
DATA = os.path.join(REFERENCE, 'dynamics_fig1.nml')
# those on which the errors of all steps add up most
HARD_MOTIONS = ('Andrews, 0.03 s', 'open spatial chain, 5 s', 'five-bar, whirling, 1 s', 'spatial slider-crank, 100 s')


def motion_of(mech9d, method, tolerance, intervals, *settings):
    """All coordinates and rates in one second, by rows, and the report."""
    settings = [f'solver.method={method}', f'solver.relative_tolerance={tolerance:g}', f'solver.absolute_tolerance={tolerance:g}',
                f'time.intervals={intervals}', *settings]
    table, report = table_and_report(mech9d, DATA, *(word for setting in settings for word in ('--set', setting)))
    names = [name for name in table if name.lstrip('d')[0] == 'q' and not name.startswith('ddq')]
    return np.array([table[name] for name in names]).T, report


def end_of(mech9d, method, tolerance):
    """All coordinates and rates after one second, the steps it took and the Jacobians."""
    rows, report = motion_of(mech9d, method, tolerance, 1)
    return rows[-1], report['steps'], report['jacobian_evaluations']


def growth(mech9d):
    """The largest error of any coordinate or rate within the second, over an error of the position or the rate at its start."""
    error = 1e-6
    rows, _ = motion_of(mech9d, 'prince-dormand', 1e-13, 100)
    largest = []
    for setting in (f'initial(7).position={0.5 + error!r}', f'initial(7).velocity={6.0 + error!r}'):
        others, _ = motion_of(mech9d, 'prince-dormand', 1e-13, 100, setting)
        largest.append(np.max(np.abs(others - rows) / np.maximum(1, np.abs(rows))) / error)
    return max(largest)


@pytest.mark.parametrize('name', HARD_MOTIONS)
def test_multistep_methods(checks, mech9d, name):
    """Errors of adams and bdf at the end of a motion, against those of prince-dormand at the same tolerance."""
    data, end = tolerance_factors.MOTIONS[name]
    truth = tolerance_factors.end_of(mech9d, data, end, 'prince-dormand', 1e-14)
    for tolerance in (1e-4, 1e-5, 1e-6, 1e-7):
        error = {method: tolerance_factors.error(tolerance_factors.end_of(mech9d, data, end, method, tolerance), truth)
                 for method in ('prince-dormand', 'adams', 'bdf')}
        print(f'{name}, {tolerance:g}:', {method: f'{number / tolerance:.2g} tolerances' for method, number in error.items()})
        for method in ('adams', 'bdf'):
            checks.true(error[method] <= max(3 * error['prince-dormand'], 100 * tolerance),
                        f'{name}, {method}, {tolerance:g}: the error is that of its tolerance', error)


def motion(mech9d, name, method):
    data, end = tolerance_factors.MOTIONS[name]
    return table_and_report(mech9d, data, '--set', f'solver.method={method}', '--set', 'solver.relative_tolerance=1e-8',
                            '--set', 'solver.absolute_tolerance=1e-8', '--set', f'time.end={end!r}', '--set', 'time.intervals=50')


def test_automatic_method_of_a_motion_that_is_not_stiff(checks, mech9d):
    """It is prince-dormand."""
    explicit, _ = motion(mech9d, 'Andrews, 0.03 s', 'prince-dormand')
    table, report = motion(mech9d, 'Andrews, 0.03 s', 'auto')
    checks.true(all(np.array_equal(table[name], explicit[name]) for name in explicit), 'Andrews: auto is prince-dormand')
    checks.equal([report['method'], report['method_changes'], report['implicit_steps']], ['auto', 0, 0], 'Andrews: the report says so')


def test_automatic_method_of_a_stiff_motion(checks, mech9d):
    """It goes on by bdf."""
    implicit, report_of_bdf = motion(mech9d, 'flyball governor, 10 s', 'bdf')
    table, report = motion(mech9d, 'flyball governor, 10 s', 'auto')
    checks.true(report['evaluations'] <= 1.05 * report_of_bdf['evaluations'], 'governor: hardly more evaluations than bdf',
                (report['evaluations'], report_of_bdf['evaluations']))
    checks.equal(report['method_changes'], 1, 'governor: one change')
    checks.true(report['implicit_steps'] > 0.98 * report['steps'], 'governor: soon after the start', report)
    # both err by less than 100 tolerances
    error = max(np.max(np.abs(table[name] - implicit[name]) / np.maximum(1, np.abs(implicit[name]))) for name in table if name[0] in 'qd')
    checks.true(error < 200e-8, 'governor: the same motion', error)


@pytest.fixture(scope='module')
def step_error(mech9d):
    """An error in a step: its root of the mean square, over the one coordinate and its rate, is at most the tolerance."""
    return math.sqrt(2) * growth(mech9d)


@pytest.fixture(scope='module')
def truth(mech9d):
    """The motion itself is the end by the method of highest order."""
    return end_of(mech9d, 'prince-dormand', TOLERANCES[-1])[0]


@pytest.mark.parametrize('method', [*ORDERS, 'adams', 'bdf'])
def test_errors_follow_the_tolerance(checks, mech9d, step_error, truth, method):
    runs = [end_of(mech9d, method, tolerance) for tolerance in TOLERANCES]
    print(f'an error in a step is at most {step_error:.3g} tolerances in any coordinate or rate later on')
    errors = [float(np.max(np.abs(end - truth) / np.maximum(1, np.abs(truth)))) for end, _, _ in runs]
    steps = [count for _, count, _ in runs]
    print(method, ' '.join(f'{error:.1e}/{count}' for error, count in zip(errors, steps)))
    # the errors of all steps add up; with the least tolerance all methods end at one motion
    checks.true(all(error <= count * step_error * tolerance for error, count, tolerance in zip(errors, steps, TOLERANCES)),
                f'{method}: errors at the end are at most those of all steps', errors)
    checks.true(all((jacobians > 0) == (method == 'bdf') for _, _, jacobians in runs),
                f'{method}: Jacobians are counted where the method takes them', [run[2] for run in runs])
    if method in ORDERS:
        first = TOLERANCES.index(1e-7)
        # to the last error that stands out of round-off, 1e-13 of angles of some radians
        last = max(i for i, error in enumerate(errors) if error > 1e-12)
        slope = math.log(errors[first] / errors[last]) / math.log(steps[last] / steps[first])
        checks.true(slope >= 0.75 * ORDERS[method], f'{method} is of order {ORDERS[method]}', slope)
