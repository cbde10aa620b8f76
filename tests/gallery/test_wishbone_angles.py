"""The double wishbone suspension of the gallery against toe, camber and track computed from its points alone.

Here is no joint and no angle: a ball joint is a point at known distances from others. Three such distances are an
intersection of spheres, which Newton's method finds from the place in the row before.
"""

import numpy as np

from gallery_list import examples
from mech9_cases import table_and_report

# the points at home, as in the data file
HOME = {'LF': (0.13, 0.38, 0.2), 'LR': (-0.22, 0.39, 0.205), 'L': (0.01, 0.7, 0.19),
        'UF': (0.1, 0.47, 0.5), 'UR': (-0.16, 0.48, 0.495), 'U': (-0.02, 0.65, 0.51),
        'R': (-0.12, 0.41, 0.24), 'T': (-0.13, 0.68, 0.235),
        'W': (0.0, 0.76, 0.3), 'S': (0.0, 0.66, 0.3), 'C': (0.0, 0.76, 0.0)}
HOME = {name: np.array(place) for name, place in HOME.items()}


def at_distances(centres, distances, guess):
    """The point at three distances from three others, near a guess."""
    point = guess.copy()
    for _ in range(50):
        apart = point - centres
        step = np.linalg.solve(2 * apart, distances**2 - np.sum(apart**2, axis=1))
        point = point + step
        if np.max(np.abs(step)) < 1e-15:
            break
    return point


def turned(point, on_axis, axis, angle):
    """A point turned about an axis, by Rodrigues' formula."""
    n = axis / np.linalg.norm(axis)
    arm = point - on_axis
    return on_axis + np.cos(angle) * arm + np.sin(angle) * np.cross(n, arm) + (1 - np.cos(angle)) * n * (n @ arm)


def frame_of(a, b, c):
    """The axes of three points of a body, in columns."""
    first = (b - a) / np.linalg.norm(b - a)
    third = np.cross(first, c - a)
    third /= np.linalg.norm(third)
    return np.column_stack([first, np.cross(third, first), third])


def suspension(angle, rack, before):
    """All points for an angle of the lower wishbone and a travel of the rack."""
    def length(a, b):
        return np.linalg.norm(HOME[a] - HOME[b])

    now = {name: HOME[name] for name in ('LF', 'LR', 'UF', 'UR')}
    now['L'] = turned(HOME['L'], HOME['LF'], HOME['LR'] - HOME['LF'], angle)
    now['R'] = HOME['R'] + np.array([0.0, rack, 0.0])
    for name, others in (('U', ('UF', 'UR', 'L')), ('T', ('L', 'U', 'R'))):
        now[name] = at_distances(np.array([now[other] for other in others]),
                                 np.array([length(name, other) for other in others]), before[name])
    turn = frame_of(now['L'], now['U'], now['T']) @ frame_of(HOME['L'], HOME['U'], HOME['T']).T
    for name in ('W', 'S', 'C'):
        now[name] = now['L'] + turn @ (HOME[name] - HOME['L'])
    return now


def angles_of(points):
    """Toe (the front of the left wheel turned inwards) and camber (its top leaning outwards) [rad]."""
    axle = points['W'] - points['S']
    return np.arctan2(axle[0], axle[1]), -np.arcsin(axle[2] / np.linalg.norm(axle))


def test_toe_camber_and_track_are_those_of_the_points(checks, mech9k):
    example = next(example for example in examples() if example.name == 'double_wishbone')
    table, _ = table_and_report(mech9k, example.data)
    found = {name: np.column_stack([table[f'{name}.{axis}'] for axis in 'xyz']) for name in ('U', 'T', 'W', 'S', 'C')}
    points = HOME
    expected = []
    for angle, rack in zip(np.radians(table['q1']), table['q3']):
        points = suspension(angle, rack, points)
        expected.append(points)
    # both sides close distances of a metre to some units of round-off, which the upright's short sides enlarge
    tolerance = 1e-13
    for name, places in found.items():
        checks.near(places, np.array([row[name] for row in expected]), tolerance, f'places of {name}', scale=1.0)
    toe, camber = np.array([angles_of(row) for row in expected]).T
    rows = [{name: places[i] for name, places in found.items()} for i in range(len(toe))]
    toe_found, camber_found = np.array([angles_of(row) for row in rows]).T
    # angles over the axle's 0.1 m
    checks.near(toe_found, toe, 20 * tolerance, 'toe', scale=1.0)
    checks.near(camber_found, camber, 20 * tolerance, 'camber', scale=1.0)
    straight = table['t'] <= 4
    checks.true(np.ptp(found['W'][:, 2][straight]) > 0.15, 'the wheel travels by 15 cm')
    checks.true(np.max(np.abs(np.degrees(toe[straight]))) < 0.5, 'it hardly steers as it travels')
    checks.true(10 < np.degrees(np.max(toe)) < 20, 'and the rack steers it')
