"""Turning and shifting a whole mechanism changes none of its coordinates.

The frame's side of every pair at link 1 is moved by a random rotation and shift; everything else in
the data file stays. Coordinates must stay the same and points must move with the frame.

Compares the program with itself: one mechanism with the system of link 1 in two places.
"""
import os

import numpy as np
import pytest

import data_file
from mech9_cases import ACCELERATION, POSITION, REFERENCE, VELOCITY, table_of, text_of

# of tests/reference
MECHANISMS = ('fig1', 'fig1_driven_at_q1', 'slider_crank', 'spatial_slider_crank', 'bennett', 'general_7r')


def default_zero(axis):
    """The first of the x, y, z axes that makes at least 45 degrees with the axis."""
    axis = np.asarray(axis, float) / np.linalg.norm(axis)
    for i in range(3):
        if abs(axis[i]) <= np.sqrt(0.5):
            return list(np.eye(3)[i])
    raise ValueError('no axis')


def make_explicit(pair):
    """Write out the defaults of a pair, as a change of the frame must not change what they stand for."""
    pair.setdefault('zero', default_zero(pair['axis']))
    if 'moving_axis' in pair:
        pair.setdefault('moving_zero', default_zero(pair['moving_axis']))
    for name in ('point', 'axis', 'zero'):
        pair.setdefault('moving_' + name, list(pair[name]))


def move_frame(groups, rotation, shift):
    """The same mechanism with link 1's own system turned and shifted: X_new = rotation X + shift."""
    for group, pair in groups:
        if group != 'pair':
            continue
        make_explicit(pair)
        for side, prefix in zip(pair['links'], ('', 'moving_')):
            if side == 1:
                pair[prefix + 'point'] = list(map(float, rotation @ pair[prefix + 'point'] + shift))
                for name in ('axis', 'zero'):
                    pair[prefix + name] = list(map(float, rotation @ pair[prefix + name]))


def random_rotation(generator):
    """Uniformly distributed over all rotations: from a random unit quaternion."""
    w, x, y, z = (lambda q: q / np.linalg.norm(q))(generator.standard_normal(4))
    return np.array([[1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
                     [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
                     [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)]])


def compare(checks, still, moved, rotation, shift, why):
    kinds = (('q', POSITION), ('dq', VELOCITY), ('ddq', ACCELERATION))
    for column in still:
        for start, tolerance in kinds:
            if column.startswith(start) and column[len(start):].isdigit():
                checks.near(moved[column], still[column], tolerance, f'{why}: {column} stays')
    for point in {column[:-2] for column in still if column.endswith('.x')}:
        for components, tolerance, offset in ((('.x', '.y', '.z'), POSITION, shift),
                                              (('.vx', '.vy', '.vz'), VELOCITY, 0.0),
                                              (('.ax', '.ay', '.az'), ACCELERATION, 0.0)):
            before = np.array([still[point + c] for c in components])
            after = np.array([moved[point + c] for c in components])
            checks.near(after.T, (rotation @ before).T + offset, tolerance,
                        f'{why}: {point}{components[0]} moves with the frame')


@pytest.fixture(scope='module', params=MECHANISMS)
def mechanism(request, mech9k):
    """Its name, its data file as text, and the table of its motion."""
    data = os.path.join(REFERENCE, f'kinematics_{request.param}.nml')
    return request.param, text_of(data), table_of(mech9k, data)


@pytest.mark.parametrize('seed', range(5))
def test_coordinates_do_not_depend_on_the_frame(checks, mech9k, tmp_path, mechanism, seed):
    name, text, still = mechanism
    generator = np.random.default_rng(seed)
    rotation, shift = random_rotation(generator), generator.uniform(-2.0, 2.0, 3)
    groups = data_file.parse(text)
    move_frame(groups, rotation, shift)
    path = tmp_path / 'moved.nml'
    path.write_text(data_file.write(groups), encoding='utf-8')
    compare(checks, still, table_of(mech9k, path), rotation, shift, f'{name}, seed {seed}')
