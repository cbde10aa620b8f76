"""Ball joints whose angles pass their singular position, gimbal lock, in closed chains and open ones, driven and free.

The joint is not singular there, only its angles are. Compares the program with itself: the same mechanisms with another order of the
turns of the ball, whose angles stay far from their singular position. The rotations that both triples of angles give, their angular
velocities and accelerations must be equal; they are formed here.
"""
import numpy as np
import pytest

from ball_mechanisms import DRIVE, SLIDER
from mech9_cases import table_of

MASSES = """&body link=2, mass=2, centre=0,0,0.1, inertia=0.1,0.1,0.1,0,0,0 /
&body link=3, mass=1, centre=0.5,0.02,0.01, inertia=0.01,0.1,0.1,0,0,0 /
&body link=4, mass=1.5 /
&gravity acceleration=0,0,-9.81 /
"""
OTHER = ', axis=0,1,0, zero=0,0,1'       # the frame of the ball: z along the crank's axis, about which it turns on and on


def turn(axis, angle):
    """Rotation about a coordinate axis."""
    c, s = np.cos(angle), np.sin(angle)
    i, j = (axis + 1) % 3, (axis + 2) % 3
    r = np.eye(3)
    r[i, i], r[i, j], r[j, i], r[j, j] = c, -s, s, c
    return r


def motion_of(table, row, frame):
    """Rotation of the moving link in the reference link, its angular velocity and acceleration, by x, y', z'' in a frame."""
    q, dq, ddq = ([table[f'{d}q{k}'][row] for k in (2, 3, 4)] for d in ('', 'd', 'dd'))
    r, w, a = frame.copy(), np.zeros(3), np.zeros(3)
    for axis in range(3):
        e = r[:, axis]
        a = a + ddq[axis] * e + np.cross(w, e) * dq[axis]
        w = w + dq[axis] * e
        r = r @ turn(axis, q[axis])
    return r @ frame.T, w, a


def check_pair(checks, one, other, tolerance, why):
    """Equal columns but for the ball's own angles; equal rotations; angles that are continued."""
    frame = np.column_stack([[0, 0, 1.0], np.cross([0, 1.0, 0], [0, 0, 1.0]), [0, 1.0, 0]])
    for name in one:
        if name.lstrip('d') in ('q2', 'q3', 'q4') or name == 'closure':
            continue
        scale = max(1.0, float(np.max(np.abs(other[name]))))
        error = float(np.max(np.abs(one[name] - other[name])))
        checks.true(error <= tolerance * scale, f'{why}: {name} differs by {error:.3g}')
    # in gimbal lock, accelerations of angles are limits that lose half the digits, and the rates of angles are large near it
    worst = np.zeros(3)
    for row in range(len(one['t'])):
        for i, (a, b) in enumerate(zip(motion_of(one, row, np.eye(3)), motion_of(other, row, frame))):
            rates = 1.0 + max(abs(one[f'dq{k}'][row]) for k in (2, 3, 4)) ** 2
            worst[i] = max(worst[i], float(np.max(np.abs(a - b))) / (rates ** i))
    checks.true(worst[0] <= max(1e-12, tolerance), f'{why}: the rotation of the ball differs by {worst[0]:.3g}')
    checks.true(worst[1] <= max(1e-10, 10 * tolerance), f'{why}: its angular velocity differs by {worst[1]:.3g}')
    checks.true(worst[2] <= max(1e-7, 100 * tolerance), f'{why}: its angular acceleration differs by {worst[2]:.3g}')
    checks.true(float(np.max(one['closure'])) <= 1e-14, f'{why}: the chain is closed')


@pytest.fixture
def table(tmp_path):
    def table(program, text):
        path = tmp_path / 'case.nml'
        path.write_text(text, encoding='utf-8')
        return table_of(program, path)
    return table


# In the plane y = 0 the ball goes through gimbal lock itself; aside, it passes beside it, near or far.
WAYS = pytest.mark.parametrize('why, crank, guide', [
    ('through the lock', '0,1,0', '0,0,0'), ('very near the lock', '0,1,0', '0,1e-7,0'),
    ('near the lock', '0.01,1,0.02', '0,0.02,0'), ('beside the lock', '0.2,1,0.1', '0,0.1,0.05')],
    ids=['through', 'very_near', 'near', 'beside'])


@WAYS
@pytest.mark.parametrize('start', ['0.2', repr(0.5 * np.pi)])
def test_driven_slider_crank(checks, table, mech9k, why, crank, guide, start):
    tables = [table(mech9k, SLIDER.format(crank=crank, guide=guide, frame=frame) + DRIVE.format(start=start)
                    + MASSES + '&output reactions=.true., drive_forces=.true. /\n&time end=13, intervals=97 /\n')
              for frame in ('', OTHER)]
    # the wrench of the ball is along fixed axes, whatever its frame; round-off times the conditioning near the lock
    check_pair(checks, *tables, 1e-11, f'{why}, driven from {start}')
    middle = tables[0]['q3']
    if crank == '0,1,0':
        checks.true(float(np.max(np.abs(np.diff(middle)))) < 0.5 and np.ptp(middle) > 9.0 or guide == '0,1e-7,0',
                    f'{why}: the middle angle goes on beyond 90 degrees without jumps')


@WAYS
def test_free_slider_crank(checks, table, mech9d, why, crank, guide):
    tables = [table(mech9d, SLIDER.format(crank=crank, guide=guide, frame=frame) + MASSES
                    + '&initial coordinate=1, position=0.2, velocity=5 /\n&time end=3, intervals=30 /\n'
                    '&solver relative_tolerance=1e-11, absolute_tolerance=1e-12 /\n') for frame in ('', OTHER)]
    # thousand times the tolerance of the integration, for accelerations as well
    check_pair(checks, *tables, 1e-8, f'{why}, free')
    checks.true(float(np.ptp(tables[0]['E.total'])) <= 1e-8, f'{why}, free: the energy keeps')


def test_tumbling_body(checks, table, mech9d):
    """A body that tumbles on a ball passes gimbal lock twice a turn."""
    tumbling = table(mech9d, "&structure cq=1,2,3 /\n&pair coordinates=1,2,3, links=1,2, kind='spherical' /\n"
                     '&body link=2, mass=1, centre=0.01,0.02,0.03, inertia=0.02,0.03,0.045,0,0,0 /\n'
                     '&initial coordinate=1, position=0, velocity=0.2 /\n'
                     '&initial coordinate=2, position=0, velocity=20 /\n&initial coordinate=3, position=0, velocity=0.1 /\n'
                     '&gravity acceleration=0,0,-9.81 /\n'
                     '&solver relative_tolerance=1e-12, absolute_tolerance=1e-13 /\n&time end=30, intervals=10 /\n')
    energy = tumbling['E.total']
    checks.true(float(np.ptp(energy)) <= 1e-9 * float(np.max(tumbling['E.kinetic'])),
                f'a tumbling body keeps its energy over a hundred turns: {float(np.ptp(energy)):.2g} J')
