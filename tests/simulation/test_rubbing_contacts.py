"""Friction of compliant contacts at a dead point and on a plate that turns. Derivatives by parameters through friction of compliant contacts, and through frictions of pairs beside contacts: against independent
integrations in complex numbers, whose derivatives are exact.

Compares the program with itself: derivatives of mechanisms with several coordinates against differences of runs."""
import cmath
import re

import numpy as np
import pytest

from contact_derivative_cases import BILLIARD, FOOT, ROCKER, SKEW, SLIDER, against_complex, integrate
from event_derivative_cases import COLUMNS, against_differences, go, kinds

#: A ball that is thrown, spins about two axes and slides on a compliant plane before it rebounds.
SOFT = BILLIARD.replace('coordinate=3, position=0.2, velocity=0', 'coordinate=3, position=0.5, velocity=0.3').replace(
    'friction=0.2', 'friction=0.05, stiffness=4e5, damping=6e4, exponent=2') + """&parameter name='z', sets='initial(3).position' /
&parameter name='k', sets='contact(1).stiffness' /
&parameter name='d', sets='contact(1).damping' /
&parameter name='n', sets='contact(1).exponent' /
&parameter name='r', sets='contact(1).radius' /
"""


def soft(end, v, w, z, k, d, n, r, m, mu, g):
    """Position and velocity of the ball, which slides as long as it touches."""
    inertia = 0.032
    t = (0.3 + cmath.sqrt(0.09 - 2 * g * (z - r))) / -g

    def rates(state):
        x, y, height, vx, vy, vz, wx, wy = state
        depth = r - height
        press = depth**n * (k - d * vz) if complex(depth).real > 0 else 0
        slip = [vx - r * wy, vy + r * wx]
        size = cmath.sqrt(slip[0]**2 + slip[1]**2)
        px, py = -mu * press * slip[0] / size, -mu * press * slip[1] / size
        return [vx, vy, vz, px / m, py / m, press / m + g, r * py / inertia, -r * px / inertia]

    start = [v * t, 0.1 * t, r, v, 0.1, 0.3 + g * t, w, 0]
    state, left = integrate(rates, lambda s: r - s[2] + (1 if s[5].real < 0 else 0), start, end - t, 1e-4)
    x, y, height, vx, vy, vz, _, _ = state
    return x + vx * left, vx, y + vy * left, vy, height + vz * left + g * left**2 / 2, vz + g * left


@pytest.mark.parametrize('end', [0.305, 0.4])
def test_a_ball_on_a_soft_plane(checks, mech9d, tmp_path, end):
    """Friction follows the normal force of Hunt and Crossley, and turns with the slip: by all numbers of the contact and the start."""
    at = {'v': 1, 'w': 1, 'z': 0.5, 'k': 4e5, 'd': 6e4, 'n': 2, 'r': 0.2, 'm': 2, 'mu': 0.05, 'g': -9.81}
    # tolerance: that of the independent integration, whose steps are 1e-4 s
    report = against_complex(checks, mech9d, tmp_path, SOFT, soft, at, end, 1e-6, ('q1', 'dq1', 'q2', 'dq2', 'q3', 'dq3'))
    checks.equal(report['events'][0]['kind'], 'close', 'it is met')
    checks.true(('stick', 1) not in kinds(report), 'it slides', kinds(report))


SOFT_FOOT = FOOT.replace('friction=0.25', 'friction=0.25, stiffness=2e4, damping=2e5, exponent=1.5').replace(
    'coordinate=2, position=0.3', 'coordinate=2, position=0.31')
SOFT_ROCKER = ROCKER.replace('restitution=0.7', 'friction=0.2, stiffness=2e4, damping=50, exponent=1.5').replace(
    "&parameter name='e', sets='contact(1).restitution' /", "&parameter name='mu', sets='contact(1).friction' /")
SOFT_SKEW = SKEW.replace('restitution=0.3', 'friction=0.3, stiffness=3e3, damping=1e3, exponent=1.2') \
    + "&parameter name='mu', sets='contact(1).friction' /\n"


@pytest.mark.parametrize('text, columns, end, found', [
    (SOFT_FOOT, ('q1', 'dq1', 'q2', 'q3', 'dq3', 'R1.fz', 'R3.fx'), 1.0, ('stick', 1)),
    (SOFT_ROCKER, ('q1', 'dq1', 'q4', 'dq4', 'R4.fx'), 0.7, ('close', 1)),
    (SOFT_SKEW, ('q1', 'dq1', 'q2', 'dq2', 'q3', 'dq3', 'R3.fx'), 0.6, ('close', 1))], ids=['foot', 'chain', 'space'])
def test_soft_contacts(checks, mech9d, tmp_path, text, columns, end, found):
    """A foot that slides and sticks, a rocker of a closed chain on a ball, and a double pendulum in space on a plane that swings."""
    output = COLUMNS.replace(' /', ', reactions=.true. /')
    # tolerance: the error of differences, which stiff contacts make larger
    report = against_differences(checks, mech9d, tmp_path, text, columns, end, 6, output, tol=5e-6)
    checks.true(found in kinds(report), 'the event of the case', kinds(report))


#: Frictions of pairs beside the contact of a foot: in the guides of its body, and in its hip.
GUIDED = FOOT.replace('&parameter', """&friction coordinate=1, dynamic=0.1, arm=0.2, preload=0.5 /
&friction coordinate=3, dynamic=0.3, radius=0.02 /
&parameter name='p', sets='friction(1).preload' /
&parameter name='a', sets='friction(1).arm' /
&parameter name='d', sets='friction(2).dynamic' /
&parameter""", 1)
SLIPPERY = GUIDED.replace('friction=0.25 /', 'friction=0 /').replace("&parameter name='mu', sets='contact(1).friction' /\n", '')
BOUND = GUIDED.replace('dynamic=0.3, radius=0.02', 'dynamic=0.3, static=0.4, radius=0.02')


@pytest.mark.parametrize('text, columns, end, found', [
    (GUIDED, ('q1', 'dq1', 'q2', 'q3', 'dq3', 'R1.fz', 'R3.fx'), 0.26, ('slip', 1)),
    (SLIPPERY, ('q1', 'dq1', 'q2', 'q3', 'dq3', 'R1.fz', 'R3.fx'), 0.3, ('slip', 2)),
    (BOUND, ('q1', 'dq1', 'q2', 'q3', 'dq3', 'R1.fz', 'R3.fx'), 0.26, ('slip', 2))], ids=['friction', 'none', 'bound'])
def test_frictions_of_pairs(checks, mech9d, tmp_path, text, columns, end, found):
    """A foot whose pairs slip and stick while it slides and sticks."""
    output = COLUMNS.replace(' /', ', reactions=.true. /')
    report = against_differences(checks, mech9d, tmp_path, text, columns, end, 3, output, tol=1e-6)
    checks.true(found in kinds(report), 'the event of the case', kinds(report))


@pytest.mark.parametrize('change', [
    ('friction=0.5', 'friction=0.5, stiffness=1e4'), ('position=1, velocity=-1', 'position=0, velocity=0')], ids=['soft', 'start'])
def test_refusals(checks, mech9d, tmp_path, change):
    """A contact that begins to act without a slip: a soft one that closes, and a rigid one on which the motion begins."""
    text = SLIDER.replace(*change).replace('velocity=0.5', 'velocity=0') + '&gravity acceleration=0,0,-9.81 /\n'
    _, _, told = go(mech9d, tmp_path, text + COLUMNS, code=6)
    checks.true('contact 1 begins to act without a slip, and parameters change its slip' in told, 'it is told', told)


def test_a_dead_point(checks, mech9d, tmp_path):
    """A rocker turns back while the crank goes on: its contact slides back from there on, and no rate jumps."""
    text = re.sub('&parameter.*\n', '', SOFT_ROCKER) + '&solver relative_tolerance=1e-10, absolute_tolerance=1e-11 /\n'
    table, report, _ = go(mech9d, tmp_path, text, end=0.6, intervals=6000)
    checks.equal(kinds(report), [('close', 1), ('slip', 1)], 'it turns back')
    # tolerance: the acceleration of the crank, at most some 500 rad/s^2, in 1e-4 s
    checks.true(np.abs(np.diff(table['dq1'])).max() < 0.1, 'the rate of the crank', np.abs(np.diff(table['dq1'])).max())
    after = np.searchsorted(table['t'], report['events'][1]['time'])
    checks.true(table['dq4'][after - 1] > 0 > table['dq4'][after], 'the rocker turns back', table['dq4'][after - 1:after + 1])


#: A mass point that is pressed into a plate, which turns at 2 rad/s, and sticks to it 0.3 m from its axis.
TURNTABLE = """&structure cq=1,2,3 /
&pair coordinate=1, links=1,2, kind='prismatic', axis=1,0,0 /
&pair coordinate=2, links=2,3, kind='prismatic', axis=0,1,0 /
&pair coordinate=3, links=1,4, kind='revolute', axis=0,0,1 /
&body link=3, mass=2 /
&drive coordinate=3, kind='polynomial', coefficients=0,2 /
&point name='C', link=3, position=0,0,0 /
&contact point='C', link=4, normal=0,1,0, stiffness=1e4, exponent=1, friction=3 /
&initial coordinate=1, position=0.3, velocity=0.04 /
&initial coordinate=2, position=-0.02, velocity=0.3 /
"""


def test_a_plate_that_turns(checks, mech9d, tmp_path):
    """Friction that holds a point gives it the acceleration of Coriolis, 2 w u, and that towards the axis."""
    table, report, _ = go(mech9d, tmp_path, TURNTABLE + '&output reactions=.true. /\n&solver relative_tolerance=1e-10 /\n', end=0.015,
                          intervals=15)
    checks.equal(kinds(report), [('stick', 1)], 'it sticks from the start on')
    turn = table['q3']
    along = table['q1'] * np.cos(turn) + table['q2'] * np.sin(turn)
    rate = -table['dq1'] * np.sin(turn) + table['dq2'] * np.cos(turn) - 2 * along
    # tolerance: that of the integration
    checks.near(along, 0.3 + 0 * along, 1e-9, 'it stays where it is', scale=1)
    checks.near(table['K1.ft'], np.abs(2 * (2 * 2 * rate + 4 * along)), 1e-7, 'friction', scale=1)
