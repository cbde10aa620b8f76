"""Reference mechanisms (tests/reference/*.nml): the program's tables against values from extended precision (*.csv)."""
import os

import numpy as np
import pytest

import data_file
from mech9_cases import REFERENCE, read_csv, table_of, text_of, tolerance_of

MECHANISMS = ('fig1', 'fig1_driven_at_q1', 'slider_crank', 'spatial_slider_crank', 'bennett', 'general_7r')


def size_of(path):
    """The size of a mechanism: the farthest that a pair stands from the origin of one of its links."""
    groups = data_file.parse(text_of(path))
    return max(np.linalg.norm(items[name]) for group, items in groups if group == 'pair'
               for name in ('point', 'moving_point') if name in items)


@pytest.mark.parametrize('name', MECHANISMS)
def test_motion_against_extended_precision(checks, mech9k, name):
    data = os.path.join(REFERENCE, f'kinematics_{name}.nml')
    expected = read_csv(os.path.join(REFERENCE, f'kinematics_{name}.csv'))
    table = table_of(mech9k, data)

    rows = [int(np.argmin(np.abs(table['t'] - t))) for t in expected['t']]
    checks.near(table['t'][rows], expected['t'], 1e-15, 'the times of the reference are in the table')
    for column, values in expected.items():
        if checks.true(column in table, f'the table has the column {column}'):
            checks.near(table[column][rows], values, tolerance_of(column), f'{name}: {column}')
    checks.true('closure' in table and np.max(np.abs(table['closure'])) <= 1e-13 * size_of(data),
                'chains close to 1e-13 of the size in every row', np.max(np.abs(table.get('closure', np.nan))))
