"""The strut suspension of the gallery against toe, camber and places computed from the pose of its carrier alone.

Here is no joint, no coordinate and no quaternion. The carrier turns by the exponential of a vector, which Newton's method finds: the mount is on the
line of the strut, and the ends of the tie rod keep their distance.
"""
import numpy as np

from gallery_list import examples
from mech9_cases import table_and_report

# the points at the height of design, as in the data file [mm]
BUSHING, AXIS = np.array([150.0, 350.0, 200.0]), np.array([330.0, 0.0, -5.0]) / np.hypot(330, 5)
BALL, FOOT, MOUNT = np.array([5.0, 700.0, 185.0]), np.array([-5.0, 655.0, 330.0]), np.array([-20.0, 565.0, 850.0])
INNER, OUTER, WHEEL = np.array([-120.0, 330.0, 260.0]), np.array([-125.0, 690.0, 250.0]), np.array([0.0, 750.0, 300.0])


def turned(vector):
    """The matrix that turns by the length of a vector about its direction, by Rodrigues' formula."""
    angle = np.linalg.norm(vector)
    x, y, z = vector / angle if angle > 0 else np.zeros(3)
    cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    return np.eye(3) + np.sin(angle) * cross + (1 - np.cos(angle)) * cross @ cross


def gaps(vector, ball, inner):
    """How far the mount is from the line of the strut, in two directions, and by how much the tie rod is too long [mm]."""
    turn = turned(vector)
    along = MOUNT - FOOT
    first = np.cross(along, [1.0, 0.0, 0.0]) / np.linalg.norm(np.cross(along, [1.0, 0.0, 0.0]))
    second = np.cross(along / np.linalg.norm(along), first)
    aside = turn.T @ (MOUNT - ball) + BALL - FOOT
    rod = np.linalg.norm(ball + turn @ (OUTER - BALL) - inner)
    return np.array([aside @ first, aside @ second, rod - np.linalg.norm(OUTER - INNER)])


def carrier(angle, rack, guess):
    """The vector by which the carrier turns, and the place of the ball."""
    ball = BUSHING + turned(angle * AXIS) @ (BALL - BUSHING)
    inner = INNER + [0.0, rack, 0.0]
    vector, h = guess.copy(), 1e-5
    for _ in range(30):
        slopes = np.array([(gaps(vector + step, ball, inner) - gaps(vector - step, ball, inner)) / (2 * h) for step in h * np.eye(3)]).T
        step = np.linalg.solve(slopes, gaps(vector, ball, inner))
        vector = vector - step
        if np.abs(step).max() < 1e-14:
            break
    return vector, ball


def test_toe_and_camber_are_those_of_the_carrier(checks, mech9k):
    example = next(example for example in examples() if example.name == 'suspension')
    table, _ = table_and_report(mech9k, example.data)
    e0, e1, e2, e3 = (table[f'L3.e{i}'] for i in range(4))
    toe_found, camber_found = np.arctan2(2 * (e1 * e2 - e0 * e3), 1 - 2 * (e1**2 + e3**2)), -np.arcsin(2 * (e2 * e3 + e0 * e1))
    vector, axles, wheels = np.zeros(3), [], []
    for angle, rack in zip(np.radians(table['q1']), table['q9']):
        vector, ball = carrier(angle, rack, vector)
        axles.append(turned(vector) @ [0.0, 1.0, 0.0])
        wheels.append(ball + turned(vector) @ (WHEEL - BALL))
    axles, wheels = np.array(axles), np.array(wheels)
    # both close distances of a metre to some units of round-off, which the sides of the carrier, a tenth as long, enlarge
    tolerance = 1e-13 * 10
    checks.near(toe_found, np.arctan2(axles[:, 0], axles[:, 1]), 2 * tolerance, 'toe', scale=1.0)
    checks.near(camber_found, -np.arcsin(axles[:, 2]), 2 * tolerance, 'camber', scale=1.0)
    checks.near(np.column_stack([table[f'W.{axis}'] for axis in 'xyz']), wheels, tolerance, 'places of the wheel', scale=1000.0)
    straight = table['t'] <= 4
    checks.true(np.ptp(table['W.z'][straight]) > 120, 'the wheel travels by 12 cm')
    checks.true(np.abs(np.degrees(toe_found[straight])).max() < 0.1, 'it hardly steers as it travels')
    # the table of the README
    for height, toe, camber in ((61.6, -0.093, -0.746), (-61.8, -0.022, 1.439)):
        row = np.abs(table['W.z'][straight] - 300 - height).argmin()
        checks.near(np.degrees([toe_found[row], camber_found[row]]), [toe, camber], 6e-4, f'README: {height} mm', scale=1.0)
    checks.near(np.degrees(toe_found[table['t'] == 6]), [13.7422], 1e-4, 'README: the rack steers', scale=1.0)
