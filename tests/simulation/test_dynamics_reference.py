"""Reference mechanisms of dynamics (tests/reference) at their starts: positions, rates, accelerations, coefficients of motion
and kinetic energy against values from extended precision. The data files are run as they stand.
"""
import os

import numpy as np
import pytest

from mech9_cases import ACCELERATION, REFERENCE, VELOCITY, read_csv, run, table_and_report, tolerance_of

MECHANISMS = ('fig1', 'fivebar', 'open_chain', 'spatial_slider_crank')


@pytest.mark.parametrize('name', MECHANISMS)
def test_start_against_extended_precision(checks, mech9d, name):
    data = os.path.join(REFERENCE, f'dynamics_{name}.nml')
    expected = read_csv(os.path.join(REFERENCE, f'dynamics_{name}.csv'))
    table, report = table_and_report(mech9d, data)
    coefficients = {f'a({c["p"]},{c["r"]})': c['value'] for c in report['coefficients']}

    checks.equal(table['t'][0], expected['t'][0], 'the first row is the start')
    checks.equal(len(table['t']), 101, 'all rows are there')
    for column, values in expected.items():
        if column.startswith('a('):
            if checks.true(column in coefficients, f'the report has {column}', coefficients):
                checks.near(coefficients[column], values[0], ACCELERATION, f'{name}: {column}')
        elif checks.true(column in table, f'the table has the column {column}'):
            # the energy is a square of velocities
            tolerance = VELOCITY if column == 'E.kinetic' else tolerance_of(column)
            checks.near(table[column][0], values[0], tolerance, f'{name}: {column}')
    checks.equal(len(coefficients), sum(column.startswith('a(') for column in expected),
                 'there is one coefficient for each two independent coordinates')
    checks.near(table['E.total'], table['E.kinetic'] + table['E.potential'], 1e-15, 'the total energy is the sum')
    checks.true(np.all(table['closure'] <= 1e-13 * report['size']), 'chains close to 1e-13 of the size in every row',
                np.max(table['closure']))


@pytest.mark.parametrize('name', MECHANISMS)
def test_check_shows_coefficients_of_motion(checks, mech9d, name):
    data = os.path.join(REFERENCE, f'dynamics_{name}.nml')
    _, report = table_and_report(mech9d, data)
    shown = run(mech9d, data, '--check')
    checks.equal(shown.returncode, 0, '--check ends well')
    for c in report['coefficients']:
        column, value = f'a({c["p"]},{c["r"]})', c['value']
        lines = [line for line in shown.stdout.splitlines() if line.strip().startswith(column)]
        checks.true(len(lines) == 1 and abs(float(lines[0].split('=')[1]) - value) <= 1e-15 * abs(value),
                    f'--check shows {column}', shown.stdout)
