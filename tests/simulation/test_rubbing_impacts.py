"""Derivatives by parameters through impacts on contacts with friction: against closed forms in complex numbers, whose derivatives are exact.

Compares the program with itself: derivatives of mechanisms with several coordinates against differences of runs."""
import cmath

import pytest

from contact_derivative_cases import BILLIARD, ROCKER, SKEW, SLIDER, against_complex, first_root
from event_derivative_cases import COLUMNS, against_differences, go, kinds

#: A ball that is thrown, spins about two axes and bounces on a plane.
THROWN = BILLIARD.replace('position=0, velocity=1 /', 'position=0, velocity=0.5 /', 1).replace('coordinate=3, position=0.2, velocity=0', 'coordinate=3, position=0.35, velocity=0.3').replace(
    'radius=0.2, friction=0.2', 'radius=0.2, friction=0.2, restitution=0.8').replace(
    "&parameter name='m'", "&parameter name='e', sets='contact(1).restitution' /\n&parameter name='z', sets='initial(3).position' /\n"
    "&parameter name='r', sets='contact(1).radius' /\n&parameter name='m'")


def thrown(end, v, w, e, z, r, m, mu, g):
    """Position and velocity of the ball: an impulse of friction against the slip that is left, or so large that none is left."""
    inertia = 0.032
    x, y, vx, vy, vz, wx, wy = 0, 0, v, 0.1, 0.3, w, 0
    t = 0
    while True:
        s = first_root(g / 2, vz, z - r)
        last = s is None or (t + s).real >= end
        s = end - t if last else s
        x, y, z, vz, t = x + vx * s, y + vy * s, z + vz * s + g * s * s / 2, vz + g * s, t + s
        if last:
            return x, vx, y, vy, z, vz
        if abs(vz) < 1e-6:
            return x + vx * (end - t), vx, y + vy * (end - t), vy, r, 0
        push = -(1 + e) * m * vz
        slip = [vx - r * wy, vy + r * wx]
        size = cmath.sqrt(slip[0]**2 + slip[1]**2)
        mobility = 1 / m + r * r / inertia
        # for a sphere the slip that is left keeps its direction
        rub = min(mu * push, size / mobility, key=lambda value: complex(value).real)
        px, py = -rub * slip[0] / size, -rub * slip[1] / size
        vx, vy, vz = vx + px / m, vy + py / m, -e * vz
        wx, wy = wx + r * py / inertia, wy - r * px / inertia


@pytest.mark.parametrize('mu', [0.05, 0.5], ids=['slides', 'sticks'])
@pytest.mark.parametrize('end, impacts', [(0.35, 1), (0.6, 2)])
def test_a_thrown_ball(checks, mech9d, tmp_path, mu, end, impacts):
    """By its velocities, height, radius, mass, restitution, friction and gravity."""
    at = {'v': 0.5, 'w': 1, 'e': 0.8, 'z': 0.35, 'r': 0.2, 'm': 2, 'mu': mu, 'g': -9.81}
    text = THROWN.replace('friction=0.2', f'friction={mu}')
    # tolerance: that of the integration, 1e-12, times the slopes of the motion over two impacts
    report = against_complex(checks, mech9d, tmp_path, text, thrown, at, end, 2e-9, ('q1', 'dq1', 'q2', 'dq2', 'q3', 'dq3'))
    checks.equal([event['kind'] for event in report['events']], ['impact'] * impacts, 'impacts alone')


def test_a_ball_that_comes_to_rest(checks, mech9d, tmp_path):
    """Endless impacts with friction, which has stopped the slip: the ball rolls in the end."""
    at = {'v': 0.5, 'w': 1, 'e': 0.3, 'z': 0.35, 'r': 0.2, 'm': 2, 'mu': 0.5, 'g': -9.81}
    text = THROWN.replace('friction=0.2', 'friction=0.5').replace('restitution=0.8', 'restitution=0.3')
    # tolerance: the impacts that are left out, which would lift the ball by 1e-12 m
    report = against_complex(checks, mech9d, tmp_path, text, thrown, at, 0.7, 2e-6, ('q1', 'dq1', 'q2', 'dq2', 'q3', 'dq3'))
    checks.true(('close', 1) in kinds(report), 'it comes to rest', kinds(report))


@pytest.mark.parametrize('v, code, slope', [(0.5, 6, None), (0.5 - 1e-6, 0, 0.0), (0.5 + 1e-6, 0, 1.0)])
def test_the_bound_of_friction(checks, mech9d, tmp_path, v, code, slope):
    """Beside the bound the slip is stopped, or keeps its change; at it there is no derivative."""
    text = SLIDER.replace('velocity=0.5 /', f'velocity={v!r} /')
    table, _, told = go(mech9d, tmp_path, text + COLUMNS, end=1.5, code=code)
    if code == 0:
        # tolerance: round-off
        checks.near(table['d(dq1)/d(v)'][-1], slope, 1e-12, 'the rate behind the impact', scale=1)
    else:
        checks.true('contact 1 is hit, and its friction just stops the slip' in told, 'it is told', told)


def rubbing(text, numbers):
    """A case with friction, by which derivatives are wanted, too."""
    return text.replace('restitution=', f'{numbers}, restitution=') + "&parameter name='mu', sets='contact(1).friction' /\n"


#: A ball that turns and falls on a larger one beside its top: the normal turns with the point of contact.
BALLS = """&structure cq=1,2,3 /
&pair coordinate=1, links=1,2, kind='prismatic', axis=1,0,0 /
&pair coordinate=2, links=2,3, kind='prismatic', axis=0,0,1 /
&pair coordinate=3, links=3,4, kind='revolute', axis=0,1,0 /
&body link=4, mass=2, inertia=0.02,0.03,0.02,0,0,0 /
&gravity acceleration=0,0,-9.81 /
&point name='F', link=4, position=0,0,0 /
&contact point='F', kind='sphere', origin=0.1,0,0, radius=0.1, other_radius=0.3, friction=0.9, restitution=0.6 /
&initial coordinate=1, position=0, velocity=0.3 /
&initial coordinate=2, position=0.6 /
&initial coordinate=3, position=0, velocity=1 /
&parameter name='m', sets='body(1).mass' /
&parameter name='x', sets='initial(1).position' /
&parameter name='R', sets='contact(1).other_radius' /
&parameter name='mu', sets='contact(1).friction' /
"""


@pytest.mark.parametrize('text, columns, end, found', [
    (rubbing(ROCKER, 'friction=0.1'), ('q1', 'dq1', 'q4', 'dq4'), 0.7, ('impact', 1)),
    (rubbing(ROCKER, 'friction=0.4'), ('q1', 'dq1', 'q4', 'dq4'), 0.7, ('impact', 1)),
    (rubbing(SKEW, 'friction=0.05'), ('q1', 'dq1', 'q2', 'dq2', 'q3', 'dq3'), 0.6, ('impact', 1)),
    (rubbing(SKEW, 'friction=0.8'), ('q1', 'dq1', 'q2', 'dq2', 'q3', 'dq3'), 0.6, ('impact', 1)),
    (BALLS, ('q1', 'dq1', 'q2', 'dq2', 'q3', 'dq3'), 0.4, ('impact', 1))],
    ids=['chain slides', 'chain sticks', 'space at 0.05', 'space at 0.8', 'ball on ball'])
def test_several_coordinates(checks, mech9d, tmp_path, text, columns, end, found):
    """A rocker of a closed chain that hits a ball, a double pendulum in space that hits a plane of a link that swings, and two balls."""
    # tolerance: the error of differences, which impacts make larger
    report = against_differences(checks, mech9d, tmp_path, text, columns, end, 6, tol=1e-6)
    checks.true(found in kinds(report), 'the event of the case', kinds(report))
