"""One reference mechanism: the program's table against values from extended precision.

usage: reference.py MECH9K NAME      (tests/reference/NAME.nml and NAME.csv)
"""
import os
import sys

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), '..', 'scripts'))
import numpy as np

import data_file
from mech9_cases import REFERENCE, Checks, read_csv, table_of, text_of, tolerance_of


def size_of(path):
    """The size of a mechanism: the farthest that a pair stands from the origin of one of its links."""
    groups = data_file.parse(text_of(path))
    return max(np.linalg.norm(items[name]) for group, items in groups if group == 'pair'
               for name in ('point', 'moving_point') if name in items)


def main():
    mech9k, name = sys.argv[1:3]
    data = os.path.join(REFERENCE, name + '.nml')
    expected = read_csv(os.path.join(REFERENCE, name + '.csv'))
    table = table_of(mech9k, data)
    checks = Checks()

    rows = [int(np.argmin(np.abs(table['t'] - t))) for t in expected['t']]
    checks.near(table['t'][rows], expected['t'], 1e-15, 'the times of the reference are in the table')
    for column, values in expected.items():
        if checks.true(column in table, f'the table has the column {column}'):
            checks.near(table[column][rows], values, tolerance_of(column), f'{name}: {column}')
    checks.true('closure' in table and np.max(np.abs(table['closure'])) <= 1e-13 * size_of(data),
                'chains close to 1e-13 of the size in every row', np.max(np.abs(table.get('closure', np.nan))))
    checks.finish()


main()
