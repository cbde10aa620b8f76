"""Designs at the edge of those whose crank turns fully: the least value lies where Grashof's condition, or that of a slider-crank, holds
with equality, and has a closed form. Parameters of couplings, whose values are found again.
"""
import os

import numpy as np
import pytest

from mech9_cases import text_of
from synthesis_cases import FOUR_BAR, LENGTHS, Cases, gradient, is_optimal, is_recovered, targets, with_numbers

# A design at the edge keeps a least singular value of 1e-4 in the turn, of chains with lengths of about one. It is some 1e-8 from
# the edge, and some 1e-8 better or worse for it.
EDGE = 1e-7
# Points of the frame whose places are the lengths: goals of the lengths make a design the nearest one to given lengths.
NEAREST = """&point name='A', link=1, position=CRANK,0,0 /
&point name='C', link=1, position=COUPLER,0,0 /
&point name='R', link=1, position=ROCKER,0,0 /
&parameter name='crank', sets='pair(2).point(1)','point(2).position(1)', value=CRANK, low=0.2, high=1.5 /
&parameter name='coupler', sets='pair(3).point(1)','point(3).position(1)', value=COUPLER, low=1, high=3.5 /
&parameter name='rocker', sets='pair(3).moving_point(1)','point(4).position(1)', value=ROCKER, low=1, high=3 /
&quantity name='crank', of='A.x', take='end' /
&quantity name='coupler', of='C.x', take='end' /
&quantity name='rocker', of='R.x', take='end' /
&limit kind='crank', coordinate=1 /
&optimum starts=8 /
"""
SLIDER_CRANK = """&mechanism angle_unit='deg' /
&structure cq=1 /
&pair coordinate=1, links=1,2, kind='revolute', axis=0,0,1, point=0,0,0, moving_point=0,0,0 /
&pair coordinate=2, links=2,3, kind='revolute', axis=0,0,1, point=0.3,0,0, moving_point=0,0,0 /
&pair coordinate=3, links=3,4, kind='revolute', axis=0,0,1, point=1.5,0,0, moving_point=0,0,0 /
&pair coordinate=4, links=1,4, kind='prismatic', axis=1,0,0, zero=0,1,0, point=0,0.2,0, moving_point=0,0,0 /
&initial coordinate=4, position=1.6 /
&point name='A', link=1, position=0.3,0,0 /
&point name='C', link=1, position=1.5,0,0 /
&parameter name='crank', sets='pair(2).point(1)','point(1).position(1)', value=0.3, low=0.1, high=1.5 /
&parameter name='coupler', sets='pair(3).point(1)','point(2).position(1)', value=1.5, low=0.3, high=3 /
&quantity name='crank', of='A.x', take='end' /
&quantity name='coupler', of='C.x', take='end' /
&limit kind='crank', coordinate=1 /
&drive coordinate=1, kind='polynomial', coefficients=10, 30 /
&time end=1, intervals=6 /
&optimum starts=8 /
"""
GEARED = """&mechanism angle_unit='deg' /
&structure cq=1 /
&pair coordinate=1, links=1,2, kind='revolute', axis=0,0,1, point=0,0,0, moving_point=0,0,0 /
&pair coordinate=2, links=2,3, kind='revolute', axis=0,0,1, point=0.5,0,0, moving_point=0,0,0 /
&pair coordinate=3, links=3,4, kind='revolute', axis=0,0,1, point=2,0,0, moving_point=2,0,0 /
&pair coordinate=4, links=5,4, kind='revolute', axis=0,0,1, point=0.6,0,0, moving_point=0,0,0 /
&pair coordinate=5, links=1,5, kind='revolute', axis=0,0,1, point=1.5,0,0, moving_point=0,0,0 /
&initial coordinate=2, position=50 /
&initial coordinate=3, position=60 /
&initial coordinate=4, position=-100 /
&point name='P', link=3, position=2,0,0 /
&drive coordinate=1, kind='polynomial', coefficients=10, 30 /
&time end=6, intervals=24 /
"""


def goals(**lengths):
    return ''.join(f"&objective kind='quantity', of='{name}', goal={value!r} /\n" for name, value in lengths.items())


TURNING = with_numbers(FOUR_BAR.replace('2,0.1,0', '2,0,0').replace('end=12, intervals=24', 'end=1, intervals=6') + NEAREST,
                       CRANK=0.5, COUPLER=1.9, ROCKER=1.6)


@pytest.fixture
def cases(checks, tmp_path, mech9k):
    return Cases(checks, tmp_path, mech9k)


@pytest.mark.parametrize('why, base, wanted, sides, free', (
    ('crank and frame', TURNING, dict(crank=1.0, coupler=1.3, rocker=1.4), (1, -1, -1), 2.0),
    ('crank and coupler', TURNING, dict(crank=0.8, coupler=3.0, rocker=1.0), (1, 1, -1), -2.0),
    ('slider-crank', SLIDER_CRANK, dict(crank=1.0, coupler=0.9), (1, -1), 0.2)), ids=('crank and frame', 'crank and coupler', 'slider-crank'))
def test_nearest_design_whose_crank_turns(cases, why, base, wanted, sides, free):
    """The nearest design to lengths with which the crank does not turn. Grashof's condition and that of a slider-crank are linear, so
    that the nearest design is a projection; all starts lead to it."""
    lengths = np.array(list(wanted.values()))
    beyond = np.dot(sides, lengths) + free          # a condition: this sum is not positive
    expected = lengths - beyond*np.array(sides)/len(sides)
    designs, _, _ = cases.search(base + goals(**wanted), f'nearest: {why}')
    cases.checks.equal(len(designs['value']), 1, f'nearest: {why}: there is one design')
    cases.checks.equal(int(designs['starts'][0]), 8, f'nearest: {why}: all starts lead to it')
    cases.checks.near(designs['value'][0], beyond**2/len(sides), EDGE, f'nearest: {why}: the value of the closed form', scale=1)
    found = np.array([designs[name][0] for name in wanted])
    cases.checks.near(found, expected, EDGE, f'nearest: {why}: the lengths of the closed form', scale=1)
    cases.checks.true(np.dot(sides, found) + free < 0, f'nearest: {why}: the crank turns', str(found))


def rocker_angle(x, theta):
    """Angle of the rocker [rad] of the four-bar linkage whose coupler is above."""
    crank, coupler, rocker = x
    line = np.array([crank*np.cos(theta) - 2, crank*np.sin(theta) - 0.1])
    length = np.hypot(*line)
    return np.arctan2(line[1], line[0]) - np.arccos((rocker**2 + length**2 - coupler**2)/(2*rocker*length))


def test_function_at_the_edge(cases):
    """A function whose best four-bar linkage has a crank that does not turn: with the limit, the slope of the sum of squares is a
    multiple of that of Grashof's condition."""
    made = cases.motion(with_numbers(FOUR_BAR, CRANK=0.5, COUPLER=1.8, ROCKER=1.5))
    angles, wanted = made['q1'][1:8:2], 50 + 0.8*made['q1'][1:8:2]
    targets(cases, [angles, wanted])
    text = with_numbers(FOUR_BAR, CRANK=0.4, COUPLER=2.2, ROCKER=1.9).replace('end=12, intervals=24', 'end=4, intervals=24') + LENGTHS
    text += "&objective kind='function', of='q4', over='q1', file='targets.dat' /\n&limit kind='crank', coordinate=1 /\n&optimum starts=6 /\n"
    designs, _, _ = cases.search(text, 'function at the edge')
    x = np.array([designs[name][0] for name in ('crank', 'coupler', 'rocker')])

    def value(x):
        return np.sum((np.array([rocker_angle(x, theta) for theta in np.radians(angles)]) % (2*np.pi) - np.radians(wanted))**2)
    cases.checks.near(value(x), designs['value'][0], 1e-9, 'function at the edge: the value of the closed form')
    frame = np.hypot(2, 0.1)
    conditions = [lambda x: x[1] + x[2] - x[0] - frame, lambda x: frame - x[0] - abs(x[1] - x[2])]
    margins = [condition(x) for condition in conditions]
    cases.checks.true(min(margins) > 0, 'function at the edge: the crank turns', str(margins))
    cases.checks.true(min(margins) < EDGE, 'function at the edge: it is at the edge', str(margins))
    walls = [gradient(condition, x) for condition, margin in zip(conditions, margins) if margin < EDGE]
    for i, (low, high) in enumerate(((0.2, 0.8), (1, 3), (1, 3))):
        if x[i] <= low + 1e-9:
            walls.append(np.eye(3)[i])
        if x[i] >= high - 1e-9:
            walls.append(-np.eye(3)[i])
    cases.checks.true(len(walls) < 3, 'function at the edge: it is not a corner', str(walls))
    is_optimal(cases.checks, gradient(value, x), walls, 'function at the edge', 1e-4)


def test_ratio_of_a_geared_five_bar_linkage(cases):
    """The ratio of a gear and a length are found again from the path of the middle joint."""
    coupling = "&coupling kind='gear', coordinates=1,5, ratio=RATIO /\n"
    made = cases.motion(with_numbers(GEARED + coupling, RATIO=-1.8))
    targets(cases, [made['t'][::3], made['P.x'][::3], made['P.y'][::3]])
    text = with_numbers(GEARED + coupling, RATIO=-1.2).replace('point=2,0,0, moving', 'point=2.2,0,0, moving')
    text += "&parameter name='ratio', sets='coupling(1).ratio', low=-2.5, high=-1 /\n"
    text += "&parameter name='rod', sets='pair(3).point(1)','point(1).position(1)', value=2.2, low=1.8, high=2.4 /\n"
    text += "&objective kind='path', point='P', file='targets.dat', timing='given' /\n&optimum starts=12 /\n"
    best = os.path.join(cases.folder, 'best.nml')
    designs, _, _ = cases.search(text, 'geared five-bar linkage', '--out', best)
    is_recovered(cases, designs, dict(ratio=-1.8, rod=2), 'geared five-bar linkage')
    repeated = cases.motion(text_of(best))
    cases.checks.near(repeated['P.x'][::3], made['P.x'][::3], 1e-9, 'geared five-bar linkage: the best file repeats the path')


def test_coefficients_of_a_linear_coupling(cases):
    """The same with a linear equation: q5 + 1.8 q1 = constant."""
    linear = "&coupling kind='linear', coordinates=1,5, coefficients=RATIO,1, constant=CONSTANT /\n"
    made = cases.motion(with_numbers(GEARED + linear, RATIO=1.8, CONSTANT=20))
    targets(cases, [made['t'][::3], made['P.x'][::3], made['P.y'][::3]])
    text = with_numbers(GEARED + linear, RATIO=1.6, CONSTANT=10)
    text += "&parameter name='ratio', sets='coupling(1).coefficients(1)', low=1.2, high=2.2 /\n"
    text += "&parameter name='constant', sets='coupling(1).constant', low=0, high=30 /\n"
    text += "&objective kind='path', point='P', file='targets.dat', timing='given' /\n&optimum starts=4 /\n"
    designs, _, _ = cases.search(text, 'linear coupling')
    is_recovered(cases, designs, dict(ratio=1.8, constant=20), 'linear coupling')
