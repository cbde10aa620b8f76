"""An accuracy that is asked for: no coordinate and no point is wrong by more at any output, and the column `error` tells how
wrong they are. Where the accuracy cannot be had, the run ends with a message before the first row that would not have it.

Truth is a reference in extended precision, or a run at the least tolerance, whose own error is seen from a run by another method.
Estimates must be right to a factor of five where the error is above a hundred times this round-off.
"""
import os
import tempfile

import numpy as np
import pytest

from mech9_cases import REFERENCE, TREE, read_csv, read_table, run, table_and_report, table_of, text_of
from tolerance_factors import MOTIONS

EXAMPLES = os.path.join(TREE, 'examples')
# data file, reference, columns of both, method
REFERENCES = {
    'pendulum': ('pendulum/pendulum', 'a01_pendulum', {'P.x': 'x', 'P.y': 'y'}),
    'Andrews': ('andrews/andrews', 'a03_andrews_ivp',
                {'q1': 'beta', 'q2': 'theta', 'q3': 'gamma', 'q4': 'phi', 'q5': 'delta', 'q6': 'omega', 'q7': 'epsilon'}),
}
# motions with long tight runs: one accuracy, or none
STIFF, LONG = 'flyball governor, 10 s', 'spatial slider-crank, 100 s'


def check_rows(checks, why, table, report, accuracy, errors, noise):
    """Errors of all rows against the accuracy and against their estimates."""
    checks.true(np.max(errors) <= accuracy, f'{why}: the accuracy is kept', np.max(errors))
    checks.true(np.max(table['error']) <= accuracy, f'{why}: the estimate says so', np.max(table['error']))
    checks.near(report['error'], np.max(table['error']), 1e-15, f'{why}: the report tells the largest estimate')
    clear = errors > np.maximum(100 * noise, 1e-13)
    ratio = table['error'][clear] / errors[clear]
    print(f'{why}: largest error {np.max(errors):.1e}, tolerance {report["relative_tolerance"]:.1e}, '
          f'{report["other_runs"]} other runs' + (f', estimates {np.min(ratio):.2f} to {np.max(ratio):.2f} times the error'
                                                  if any(clear) else ''))
    checks.true(not any(clear) or (np.min(ratio) > 0.2 and np.max(ratio) < 5), f'{why}: estimates are right to a factor of five',
                (np.min(ratio), np.max(ratio)) if any(clear) else None)


@pytest.mark.parametrize('name, method, accuracies', [
    *[(name, 'prince-dormand', (1e-4, 1e-8)) for name in MOTIONS if name not in (STIFF, LONG)],
    (STIFF, 'auto', (1e-6,)), ('Fig. 1, 1 s', 'merson', (1e-6,)), ('Andrews, 0.03 s', 'adams', (1e-6,))])
def test_errors_within_the_accuracy(checks, mech9d, name, method, accuracies):
    data, end = MOTIONS[name]
    common = ['--set', f'time.end={float(end)!r}', '--set', 'time.intervals=40']

    def tight(by, tolerance):
        table = table_of(mech9d, data, *common, '--set', f'solver.method={by}', '--set', f'solver.relative_tolerance={tolerance}',
                         '--set', f'solver.absolute_tolerance={tolerance}')
        return np.array([column for heading, column in table.items() if heading[0] == 'q' or heading[-2:] in ('.x', '.y', '.z')])

    truth = tight('prince-dormand', 1e-14)
    noise = np.max(np.abs(tight('verner', 1e-13) - truth), axis=0)
    for accuracy in accuracies:
        table, report = table_and_report(mech9d, data, *common, '--set', f'solver.method={method}',
                                         '--set', f'solver.accuracy={accuracy}')
        places = np.array([column for heading, column in table.items() if heading[0] == 'q' or heading[-2:] in ('.x', '.y', '.z')])
        errors = np.max(np.abs(places - truth), axis=0)
        check_rows(checks, f'{name}, {method}, {accuracy:g}', table, report, accuracy, errors, noise)


@pytest.mark.parametrize('accuracy', [1e-5, 1e-8])
@pytest.mark.parametrize('name', REFERENCES)
def test_errors_against_references(checks, mech9d, name, accuracy):
    data, reference, columns = REFERENCES[name]
    expected = read_csv(os.path.join(REFERENCE, reference + '.csv'))
    table, report = table_and_report(mech9d, os.path.join(EXAMPLES, data + '.nml'), '--set', f'solver.accuracy={accuracy}')
    rows = [int(np.argmin(np.abs(table['t'] - t))) for t in expected['t']]
    same = np.abs(table['t'][rows] - expected['t']) < 1e-12
    rows = np.array(rows)[same]
    errors = np.max([np.abs(table[ours][rows] - expected[theirs][same]) for ours, theirs in columns.items()], axis=0)
    checks.true(len(rows) > 3 and np.max(errors) <= accuracy, f'{name}, {accuracy:g}: right against the reference',
                np.max(errors))
    largest = np.max(table['error'][rows])
    checks.true(0.2 * np.max(errors) < largest < 5 * np.max(errors), f'{name}, {accuracy:g}: so is the estimate',
                (largest, np.max(errors)))
    checks.equal(report['accuracy'], accuracy, f'{name}: the report tells what was asked for')


def test_chaotic_motion_ends_in_time(checks, mech9d):
    """A double pendulum forgets its start within a minute: the rows that are written have the accuracy."""
    data, _ = MOTIONS['double pendulum, 5 s']
    words = ['--set', 'solver.accuracy=1e-6', '--set', 'time.end=60', '--set', 'time.intervals=600']
    with tempfile.TemporaryDirectory() as folder:
        path = os.path.join(folder, 'table.dat')
        done = run(mech9d, data, '--table', path, *words, folder=folder)
        rows = read_table(text_of(path))
    checks.equal(done.returncode, 7, 'a chaotic motion ends by the code of the integrator')
    checks.true('not as accurate as was asked for at t = ' in done.stderr and 'chaotic' in done.stderr, 'it says when, and why',
                done.stderr)
    last = rows['t'][-1]
    checks.true(10 < last < 40, 'it is kept for some time', last)
    checks.true(np.max(rows['error']) <= 1e-6, 'no row is worse', np.max(rows['error']))
    truth = table_of(mech9d, data, '--set', 'solver.relative_tolerance=1e-14', '--set', 'solver.absolute_tolerance=1e-14',
                     '--set', f'time.end={float(last)!r}', '--set', f'time.intervals={len(rows["t"]) - 1}')
    error = np.max([np.abs(truth[name] - rows[name]) for name in ('q1', 'q2')], axis=0)
    checks.true(np.max(error) <= 5e-6, 'no row is wrong', np.max(error))


# two slides on springs, of 1000 and 1 rad/s: x = cos(1000 t), y = cos(t); {} more of the first spring
SLIDES = """&structure cq=1,2 /
&pair coordinate=1, links=1,2, kind='prismatic', axis=1,0,0 /
&pair coordinate=2, links=1,3, kind='prismatic', axis=0,1,0 /
&body link=2, mass=1 /
&body link=3, mass=1 /
&load kind='coordinate', coordinate=1, stiffness=1e6 {}/
&load kind='coordinate', coordinate=2, stiffness=1 /
&initial coordinate=1, position=1, velocity=0 /
&initial coordinate=2, position=1, velocity=0 /
&time end={}, intervals={} /
"""


def test_accuracy_beyond_implicit_round_off(checks, mech9d, tmp_path):
    """A few steps of bdf do not set the least tolerances of a motion that prince-dormand can follow: 1e-8 in 3000 rad."""
    path = tmp_path / 'slides.nml'
    path.write_text(SLIDES.format('', 3, 30), encoding='utf-8')
    table = table_of(mech9d, path, '--set', 'solver.accuracy=1e-8')
    error = np.maximum(np.abs(table['q1'] - np.cos(1000 * table['t'])), np.abs(table['q2'] - np.cos(table['t'])))
    checks.equal(len(error), 31, 'all rows are there')
    checks.true(np.max(error) <= 1e-8, 'the accuracy is kept', np.max(error))
    checks.true(np.all(error <= table['error'] + 1e-12), 'no estimate is too small', np.max(error - table['error']))


def test_accuracy_near_the_round_off_of_bdf(checks, mech9d):
    """The stiff governor at 1e-10, which is what bdf loses by round-off on the way: prince-dormand tells it, or makes the steps.
    The truth is another method's, whose own error is a tenth of the accuracy."""
    data, _ = MOTIONS[STIFF]
    common = ['--set', 'time.end=5.0', '--set', 'time.intervals=100']
    names = 'q1', 'q2', 'q3', 'q4'
    truth = table_of(mech9d, data, *common, '--set', "solver.method='verner'", '--set', 'solver.relative_tolerance=1e-13',
                     '--set', 'solver.absolute_tolerance=1e-13')
    for method in 'auto', 'bdf':
        table = table_of(mech9d, data, *common, '--set', f"solver.method='{method}'", '--set', 'solver.accuracy=1e-10')
        errors = np.max([np.abs(table[name] - truth[name]) for name in names], axis=0)
        checks.true(np.max(errors) <= 1.1e-10, f'{method}: the accuracy is kept', np.max(errors))
        checks.true(np.max(errors - table['error']) <= 1e-11, f'{method}: no estimate is too small', np.max(errors - table['error']))


def test_accuracy_of_a_very_stiff_motion_is_refused_with_the_reason(checks, mech9d, tmp_path):
    """A damper that holds a slide by 1e6/s: prince-dormand would need a million steps a second."""
    path = tmp_path / 'stiff.nml'
    path.write_text(SLIDES.format(', damping=1e6', 2, 4), encoding='utf-8')
    done = run(mech9d, os.fspath(path), '--table', '-', '--set', 'solver.accuracy=1e-13')
    checks.equal(done.returncode, 7, 'it is refused by the code of the integrator')
    checks.true('its error may be ' in done.stderr and 'prince-dormand, which has less round-off than bdf, would take more than 30 '
                'times as many steps' in done.stderr, 'it names the stiffness', done.stderr)


PENDULUM = os.path.join(EXAMPLES, 'pendulum', 'pendulum.nml')


def test_accuracy_beyond_round_off_is_refused(checks, mech9d):
    done = run(mech9d, PENDULUM, '--table', '-', '--set', 'solver.accuracy=1e-17')
    checks.equal(done.returncode, 7, 'less than round-off is refused')
    checks.true('at t = 0 s' in done.stderr, 'at the start', done.stderr)


def test_a_method_that_loses_more_is_named(checks, mech9d):
    done = run(mech9d, PENDULUM, '--table', '-', '--set', 'solver.accuracy=1e-17', '--set', "solver.method='bdf'")
    checks.equal(done.returncode, 7, 'less than round-off is refused')
    checks.true("with the least tolerances of bdf, 3.3e-11, its error is about " in done.stderr
                and "Take the method 'auto', which may have less round-off, end before this time" in done.stderr, 'it names another method',
                done.stderr)


def test_negative_accuracy_is_refused(checks, mech9d):
    done = run(mech9d, PENDULUM, '--set', 'solver.accuracy=-1')
    checks.equal(done.returncode, 3, 'an accuracy is not negative')


def test_no_column_without_an_accuracy(checks, mech9d):
    table = table_of(mech9d, PENDULUM)
    checks.true('error' not in table, 'without an accuracy there is no such column', list(table))
