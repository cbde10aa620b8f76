"""The samples of user_procs: their programs against closed forms, and the two forms of a procedure
against each other, however the programs are made.

Compares the program with itself in part: procedures in Taylor form and in plain reals, which are both held against
closed forms, too.
"""
import os
import re

import numpy as np
import pytest

from jets import Jet, arccos, arcsin, check_coordinate, check_point, cos, sin, sqrt
from mech9_cases import TREE, table_of, text_of, tolerance_of


def check_trammel(checks, table, why):
    """P on the ellipse; the slider S at the height 0.1 on a rod of length 0.8, ahead of P."""
    q = Jet(0.3 + 2.0 * table['t'], 2.0, 0.0)
    px, py = 0.3 * cos(q), 0.2 * sin(q)
    rod = arcsin((0.1 - py) / 0.8)             # angle of the rod against the x axis
    sx = px + 0.8 * cos(rod)
    check_coordinate(checks, table, 1, q, why)
    check_coordinate(checks, table, 2, rod + q - np.pi, why, turns=True)   # AB stands at pi - q
    check_coordinate(checks, table, 3, -1.0 * rod, why, turns=True)
    check_coordinate(checks, table, 4, sx, why)
    check_point(checks, table, 'P', (px, py, 0.0), why)
    check_point(checks, table, 'S', (sx, 0.1, 0.0), why)


def check_cam(checks, table, why):
    """E on the cam; N stands 0.05 outside of it, on the normal."""
    q = Jet(1.5 * table['t'], 1.5, 0.0)
    r = 0.1 + 0.01 * (1.0 - cos(3.0 * q))
    slope = 0.03 * sin(3.0 * q)                # dr/dq
    x, y = r * cos(q), r * sin(q)
    tx, ty = slope * cos(q) - r * sin(q), slope * sin(q) + r * cos(q)
    length = sqrt(tx * tx + ty * ty)
    check_coordinate(checks, table, 1, q, why)
    check_point(checks, table, 'E', (x, y, 0.0), why)
    check_point(checks, table, 'N', (x + 0.05 * ty / length, y - 0.05 * tx / length, 0.0), why)


def check_cycloid(checks, table, why):
    """The slider at 0.8 + q4, crank 0.3 and rod 1: the law of cosines gives the crank's angle."""
    share = Jet(table['t'] / 2.0, 0.5, 0.0)
    q4 = 0.4 * (share - sin(2 * np.pi * share) / (2 * np.pi))
    x = 0.8 + q4
    crank = arccos((x * x + (0.3 ** 2 - 1.0)) / (0.6 * x))
    rod = arcsin(-0.3 * sin(crank))
    check_coordinate(checks, table, 4, q4, why)
    check_coordinate(checks, table, 1, crank, why, turns=True)
    check_coordinate(checks, table, 2, rod - crank, why, turns=True)
    check_coordinate(checks, table, 3, -1.0 * rod, why, turns=True)
    check_point(checks, table, 'A', (0.3 * cos(crank), 0.3 * sin(crank), 0.0), why)


def check_cardan(checks, table, why):
    """The second shaft by the law of the universal joint."""
    q = Jet(0.3 + 2.0 * table['t'] + table['t'] ** 2, 2.0 + 2.0 * table['t'], 2.0)
    # the same law as an angle from the first shaft's, which stays within a quarter of a turn
    second = q + arcsin((1 - np.cos(0.3)) * sin(q) * cos(q) / sqrt(sin(q) * sin(q) + np.cos(0.3) ** 2 * cos(q) * cos(q)))
    check_coordinate(checks, table, 1, q, why)
    check_coordinate(checks, table, 2, second, why)


def check_air(checks, table, why):
    """The weight falls towards its final speed, the wheel runs out; what is lost is the work of the drag."""
    t = table['t']
    final = np.sqrt(2.0 * 9.81 / 0.10)
    slowing = 2 * 0.04 * 0.3 ** 3 / 0.05
    expected = {'q1': final ** 2 / 9.81 * np.log(np.cosh(9.81 * t / final)), 'dq1': final * np.tanh(9.81 * t / final),
                'q2': np.log(1 + 20 * slowing * t) / slowing, 'dq2': 20 / (1 + 20 * slowing * t)}
    for column, values in expected.items():
        # 50 outputs and some steps between them, each with an error of 1e-10, in a motion that damps errors
        checks.near(table[column], values, 1e-8, f'{why}: {column} by its closed form')
    lost = table['E.total'][0] - table['E.total']
    kinetic = 0.5 * 2.0 * expected['dq1'] ** 2 + 0.5 * 0.05 * expected['dq2'] ** 2
    work = 10.0 - kinetic + 2.0 * 9.81 * expected['q1']
    checks.near(lost, work, 1e-8, f'{why}: the energy falls by the work of the drag')


CLOSED = (('trammel', check_trammel), ('trammel_values', check_trammel), ('cam_follower', check_cam), ('cycloidal_drive', check_cycloid),
          ('cycloidal_drive_values', check_cycloid), ('cardan_coupling', check_cardan), ('cardan_coupling_values', check_cardan))


def data_of(program):
    """The data file of a sample, which both forms of its procedure share."""
    name = program.replace('_values', '')
    return os.path.join(TREE, 'user_procs', name, name + '.nml')


@pytest.mark.parametrize('program, check', CLOSED, ids=[program for program, _ in CLOSED])
def test_closed_form(checks, programs, program, check):
    check(checks, table_of(os.path.join(programs, program + '_k'), data_of(program)), program)


def test_torque_of_a_coupling(checks, programs):
    forces = table_of(os.path.join(programs, 'cardan_coupling_k'), data_of('cardan_coupling'), '--set', 'output.reactions=.true.')
    checks.near(forces['C1'], 0.05 * forces['ddq2'], 1e-13, 'Cardan coupling: its torque turns the second shaft', scale=1.0)


def test_air_drag(checks, programs):
    check_air(checks, table_of(os.path.join(programs, 'air_drag_d'), data_of('air_drag')), 'air drag')


def test_forces_beside_air_drag(checks, programs, tmp_path):
    """Forces in pairs and of drives beside those of a user procedure, by hand: free, and driven."""
    program, data = os.path.join(programs, 'air_drag_d'), data_of('air_drag')
    settings = ('--set', 'output.reactions=.true.', '--set', 'output.drive_forces=.true.')
    free = table_of(program, data, *settings)
    zero = [free[f'R1.{c}'] for c in ('fx', 'fy', 'fz', 'mx', 'my', 'mz')] + [free[f'R2.{c}'] for c in ('fx', 'fy', 'mx', 'my', 'mz')]
    checks.near(zero, 0, 1e-12, 'air drag: what falls and turns freely needs no force along its axis', scale=20.0)
    checks.near(free['R2.fz'], 9.81, 1e-14, 'air drag: the wheel is carried')
    text = re.sub(r'&initial.*\n', '', text_of(data))
    text += "&drive coordinate=1, kind='polynomial', coefficients=0,1,0.5 /\n&drive coordinate=2, kind='polynomial', coefficients=0,20,-2 /\n"
    path = tmp_path / 'driven.nml'
    path.write_text(text, encoding='utf-8')
    table = table_of(program, path, *settings)
    drag, brake = 0.10 * table['dq1']**2, 2 * 0.04 * 0.3**3 * table['dq2'] * abs(table['dq2'])
    checks.near(table['F1'], 2.0 * (table['ddq1'] - 9.81) + drag, 1e-13, 'air drag: the force that drives the weight', scale=20.0)
    checks.near(table['R1.fz'], -table['F1'], 1e-14, 'air drag: it is that of the pair', scale=20.0)
    checks.near(table['F2'], 0.05 * table['ddq2'] + brake, 1e-13, 'air drag: the torque that drives the wheel', scale=1.0)
    checks.near(table['R2.mz'], table['F2'], 1e-14, 'air drag: it is that of the pair', scale=1.0)


@pytest.mark.parametrize('name', ('trammel', 'cycloidal_drive', 'cardan_coupling'))
def test_taylor_arithmetic_and_plain_values_agree(checks, programs, name):
    why = f'{name}: Taylor arithmetic and plain values agree'
    first, second = (table_of(os.path.join(programs, f'{name}{form}_k'), data_of(name)) for form in ('', '_values'))
    for column in first:
        if column != 'closure':
            checks.near(second[column], first[column], tolerance_of(column), f'{why}: {column}')
