"""One reference mechanism of dynamics at its start: positions, rates, accelerations, coefficients of motion
and kinetic energy against values from extended precision. The data file is run as it stands.

usage: dynamics_reference.py MECH9D NAME      (tests/reference/NAME.nml and NAME.csv)
"""
import os
import sys

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), '..', 'scripts'))
import numpy as np

from mech9_cases import ACCELERATION, REFERENCE, VELOCITY, Checks, read_csv, run, table_and_report, tolerance_of


def main():
    mech9d, name = sys.argv[1:3]
    data = os.path.join(REFERENCE, name + '.nml')
    expected = read_csv(os.path.join(REFERENCE, name + '.csv'))
    table, report = table_and_report(mech9d, data)
    coefficients = {f'a({c["p"]},{c["r"]})': c['value'] for c in report['coefficients']}
    checks = Checks()

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

    shown = run(mech9d, data, '--check')
    checks.equal(shown.returncode, 0, '--check ends well')
    for column, value in coefficients.items():
        lines = [line for line in shown.stdout.splitlines() if line.strip().startswith(column)]
        checks.true(len(lines) == 1 and abs(float(lines[0].split('=')[1]) - value) <= 1e-15 * abs(value),
                    f'--check shows {column}', shown.stdout)
    checks.finish()


main()
