"""Contacts with paths against closed forms: balls that slide on curves, roll about corners, rest in grooves, and lift off from cams; the
same surfaces as planes and spheres; curves that a ball cannot follow.

Compares the program with itself: a path and a plane, a sphere, a pair along the same path; a path in another frame."""
import json
import re
from math import acos, cos, hypot, pi, sin, sqrt

import numpy as np
import pytest

from mech9_cases import read_table, run

G = 9.81
TIGHT = '&solver relative_tolerance=1e-11, absolute_tolerance=1e-12 /\n'
# a particle that slides along x and y
PARTICLE = """&structure cq=1,2 /
&pair coordinate=1, links=1,2, kind='prismatic', axis=1,0,0 /
&pair coordinate=2, links=2,3, kind='prismatic', axis=0,1,0 /
&body link=3, mass=1 /
&point name='P', link=3 /
&gravity acceleration=0,-9.81,0 /
"""


def particle(x, y, vx=0.0, vy=0.0):
    return PARTICLE + f'&initial coordinate=1, position={x!r}, velocity={vx!r} /\n&initial coordinate=2, position={y!r}, velocity={vy!r} /\n'


def write_path(folder, points, name='path.dat'):
    """A file of points; None makes an empty line."""
    lines = ['' if point is None else f'{float(point[0])!r} {float(point[1])!r}' for point in points]
    (folder / name).write_text('\n'.join(lines) + '\n', encoding='utf-8')


def go(program, folder, text, end, intervals=20, code=0):
    """Table, events and standard error of a run that ends with a code."""
    path, table, report = folder / 'meet.nml', folder / 'meet.dat', folder / 'meet.json'
    path.write_text(f'{text}{TIGHT}&time end={end!r}, intervals={intervals} /\n', encoding='utf-8')
    done = run(program, path, '--table', table, '--report', report)
    assert done.returncode == code, done.stderr
    columns = read_table(table.read_text()) if code == 0 else None
    return columns, json.loads(report.read_text()).get('events', []), done.stderr


def integral(function, low, high):
    """By Gauss's rule, exact to round-off for smooth functions."""
    x, w = np.polynomial.legendre.leggauss(80)
    return (high - low)/2*np.sum(w*function(low + (high - low)*(x + 1)/2))


def circle_points(radius=1.0, centre=(0.0, 0.0), n=60, turn=1):
    """Points of a circle, the first one again at the end."""
    t = 2*pi*turn*np.arange(n + 1)/n
    points = np.column_stack([centre[0] + radius*np.cos(t), centre[1] + radius*np.sin(t)])
    points[-1] = points[0]
    return points


def ellipse(t):
    return np.array([2*np.cos(t), np.sin(t)])


def test_over_an_edge(checks, mech9d, tmp_path):
    """A ball without friction rolls about the corner of a table like a particle on a circle about it: with the speed v above the corner
    it leaves at cos = 2/3 + v^2/(3 g r)."""
    write_path(tmp_path, [(-1, 0), (0, 0), None, (0, -1)])
    v, r = 0.3, 0.1
    found, events, _ = go(mech9d, tmp_path, particle(-0.5, r, v) + "&contact point='P', kind='path', file='path.dat', side='left', radius=0.1 /\n", 2)
    angle = acos(2/3 + v**2/(3*G*r))
    time = 0.5/v + integral(lambda a: r/np.sqrt(v**2 + 2*G*r*(1 - np.cos(a))), 0, angle)
    checks.equal([event['kind'] for event in events], ['close', 'lift'], 'it touches, and leaves')
    # some ten tolerances of the integration
    checks.near(events[1]['time'], time, 1e-10, 'the time at which it leaves')
    speed, late = sqrt(v**2 + 2*G*r*(1 - cos(angle))), 2 - time
    checks.near([found['q1'][-1], found['q2'][-1]], [r*sin(angle) + speed*cos(angle)*late,
                                                     r*cos(angle) - speed*sin(angle)*late - G*late**2/2], 1e-9, 'its flight')
    checks.near(found['K1.gap'][:10], 0, 1e-15, 'the gap is closed on the table')


def test_groove(checks, mech9d, tmp_path):
    """A ball comes to rest in a groove of two sides at right angles, on both of which it presses with its weight over the root of 2."""
    write_path(tmp_path, [(-1, 1), (0, 0), None, (1, 1)])
    found, events, _ = go(mech9d, tmp_path, particle(0.2, 1) +
                          "&contact point='P', kind='path', file='path.dat', side='left', radius=0.1, restitution=0.5 /\n", 4)
    checks.near([found['q1'][-1], found['q2'][-1]], [0, 0.1*sqrt(2)], 1e-15, 'the centre at rest')
    checks.near(found['K1.fn'][-1], sqrt(2)*G, 1e-14, 'the forces on both sides together')
    checks.near(found['K1.gap'][-1], 0, 1e-15, 'one column for both sides')
    checks.equal({event['number'] for event in events}, {1}, 'both sides are contact 1')
    # on the right side first: falls from the height where this side is met
    fall = 1 - (0.2 + 0.1*sqrt(2))
    checks.near(events[0]['time'], sqrt(2*fall/G), 1e-12, 'the first impact')
    checks.near(events[0]['impulse'], 1.5*sqrt(2*G*fall)/sqrt(2), 1e-11, 'its impulse')


@pytest.mark.parametrize('turn, side', ((1, 'outside'), (-1, 'outside'), (1, 'right'), (-1, 'left')))
def test_circle(checks, mech9d, tmp_path, turn, side):
    """A path through 160 points of a circle is the sphere to some 1e-10, since its spline is of sixth order. Directions of the curve do not
    matter."""
    write_path(tmp_path, circle_points(n=160, turn=turn))
    text = particle(0.01, 1.1)
    sphere, there, _ = go(mech9d, tmp_path, text + "&contact point='P', kind='sphere', other_radius=1, radius=0.1 /\n", 1.2)
    path, here, _ = go(mech9d, tmp_path, text + f"&contact point='P', kind='path', file='path.dat', radius=0.1, side='{side}' /\n", 1.2)
    checks.equal([event['kind'] for event in here], [event['kind'] for event in there], 'the same events')
    checks.near([event['time'] for event in here], [event['time'] for event in there], 1e-7, 'at the same times')
    checks.near(path['q1'], sphere['q1'], 1e-7, 'the same motion')


BOX = [(-1, -1), (1, -1), None, (1, 1), None, (-1, 1), None, (-1, -1)]


def test_inside_a_box(checks, mech9d, tmp_path):
    """A ball bounces between four walls, which are four planes, or the four sides of a path whose corners stand in."""
    write_path(tmp_path, BOX)
    text = particle(0.2, 0.3, 3.0, 1.0)
    walls = ''.join(f"&contact point='P', radius=0.1, restitution=0.8, origin={-x},{-y},0, normal={x},{y},0 /\n"
                    for x, y in ((0, 1), (-1, 0), (0, -1), (1, 0)))
    planes, there, _ = go(mech9d, tmp_path, text + walls, 2)
    path, here, _ = go(mech9d, tmp_path, text + "&contact point='P', kind='path', file='path.dat', side='inside', radius=0.1, restitution=0.8 /\n", 2)
    checks.true(len(there) > 4 and len({event['number'] for event in there}) > 2, 'it meets several walls', there)
    checks.equal([event['kind'] for event in here], [event['kind'] for event in there], 'the same events')
    checks.near([event['time'] for event in here], [event['time'] for event in there], 1e-10, 'at the same times')
    checks.near(path['q1'], planes['q1'], 1e-9, 'the same motion')
    checks.near(path['K1.gap'], np.min([planes[f'K{k}.gap'] for k in (1, 2, 3, 4)], axis=0), 1e-9, 'the gap is that of the nearest side')


def test_teeth(checks, mech9d, tmp_path):
    """A ball outside a cross, whose corners stand in and out, touches only what it sees: arms on the other side do not count."""
    arm = [(3, 1), (1, 1), None, (1, 3), None, (-1, 3), None, (-1, 1), None, (-3, 1), None, (-3, -1), None, (-1, -1), None, (-1, -3), None,
           (1, -3), None, (1, -1), None, (3, -1), None, (3, 1)]
    write_path(tmp_path, arm[:2] + arm[2:])
    contact = "&contact point='P', kind='path', file='path.dat', radius=0.1 /\n"
    found, events, _ = go(mech9d, tmp_path, particle(2.0, 3.0) + contact, 1)
    checks.near(found['K1.gap'][0], 0.9, 1e-14, 'the nearest is a side of the upper arm')
    checks.near(events[0]['time'], sqrt(2*1.9/G), 1e-12, 'it falls onto the arm below')
    checks.near([found['q1'][-1], found['q2'][-1]], [2, 1.1], 1e-14, 'and rests there')
    # the arm on the left turns its back to this ball
    beside, events, _ = go(mech9d, tmp_path, particle(5.0, 0.0) + contact, 0.2)
    checks.equal(events, [], 'a ball beside the cross meets nothing')
    checks.near(beside['K1.gap'][0], 1.9, 1e-14, 'and sees the arm on its own side')
    _, _, said = go(mech9d, tmp_path, particle(0.5, 0.5) + contact, 1, code=3)
    checks.true('are 0.8071 m within each other at the start' in said, 'a start in the middle is told', said)


def test_check_lists_a_path_once(checks, mech9d, tmp_path):
    """A path with corners that stand in has several sides; a check names the contact once, with the gap to the nearest one."""
    write_path(tmp_path, [(-1, 0), (0, 0), None, (0, 1)])
    path = tmp_path / 'check.nml'
    path.write_text(particle(-0.5, 0.3) + "&contact point='P', kind='path', file='path.dat', side='left', radius=0.1 /\n", encoding='utf-8')
    lines = [line for line in run(mech9d, path, '--check').stdout.splitlines() if 'contact 1:' in line]
    checks.equal(len(lines), 1, f'one line: {lines}')
    checks.true('is 0.2 m from a path' in lines[0], 'the nearest side', lines)


@pytest.mark.parametrize('closed', [False, True])
def test_corner_at_the_first_point(checks, mech9d, tmp_path, closed):
    """An empty line may follow the first point of a curve: an end of an open one, a corner of a closed one. A ball that slides down the
    roof of a drop of straight sides with the slope 1 gets g/sqrt(2)."""
    drop = [(0, 1), None, (-1, 0), None, (0, -1), None, (1, 0), None, (0, 1)]
    write_path(tmp_path, drop if closed else [(0, 1), None, (-1, 0), None, (-1.5, -0.5)])
    r, along = 0.1, 0.2
    x, y = -along - r/sqrt(2), 1 - along + r/sqrt(2)
    found, _, _ = go(mech9d, tmp_path, particle(x, y) + f"&contact point='P', kind='path', file='path.dat', radius={r}" +
                     (" /\n" if closed else ", side='right' /\n"), 0.3)
    way = G/sqrt(2)*found['t']**2/2
    checks.near(found['q1'], x - way/sqrt(2), 1e-9, 'down the slope')
    checks.near(found['K1.fn'], G/sqrt(2), 1e-9, 'a part of the weight presses')


def test_straight_path_is_a_plane(checks, mech9d, tmp_path):
    """Impacts and sliding with friction on an incline, which is a path of two points in a frame of its own, or a plane."""
    write_path(tmp_path, [(-9, 0), (9, 0)])
    text = particle(0.0, 0.5, 1.0, 0.0)
    common = "&contact point='P', radius=0.1, restitution=0.4, friction=0.3"
    plane, there, _ = go(mech9d, tmp_path, text + common + f', normal={-sin(0.2)!r},{cos(0.2)!r},0 /\n', 2)
    path, here, _ = go(mech9d, tmp_path, text + common + f", kind='path', file='path.dat', side='left', axis=0,0,1, zero={cos(0.2)!r},{sin(0.2)!r},0 /\n", 2)
    checks.equal([event['kind'] for event in here], [event['kind'] for event in there], 'the same events')
    checks.near([event['time'] for event in here], [event['time'] for event in there], 1e-10, 'at the same times')
    for name in ('q1', 'q2', 'K1.gap', 'K1.fn', 'K1.ft'):
        checks.near(path[name], plane[name], 1e-9, f'the same {name}')


def test_inside_of_a_curve_is_a_pair_along_it(checks, mech9d, tmp_path):
    """A point that slides inside an ellipse, pressed outwards all the time, moves as a point that a pair leads along the same path."""
    t = 2*pi*np.arange(81)/80
    points = ellipse(t).T
    points[-1] = points[0]
    write_path(tmp_path, points)
    x, y = ellipse(-1.2)
    # the point of the file at this angle is none: the foot is sought
    pair = """&structure cq=1 /
&pair coordinate=1, links=1,2, kind='path', file='path.dat' /
&body link=2, mass=1 /
&point name='P', link=2 /
&gravity acceleration=0,-9.81,0 /
"""
    step = lambda a: np.hypot(2*np.sin(a), np.cos(a))
    start = integral(step, 0, 2*pi - 1.2)
    along, _, _ = go(mech9d, tmp_path, pair + f'&initial coordinate=1, position={start!r}, velocity=0 /\n', 3)
    sliding, events, _ = go(mech9d, tmp_path, particle(*along_start(along)) +
                            "&contact point='P', kind='path', file='path.dat', side='inside' /\n", 3)
    checks.equal([event['kind'] for event in events], ['close'], 'it touches all the time')
    checks.near(sliding['q1'], along['P.x'], 1e-8, 'x of both')
    checks.near(sliding['q2'], along['P.y'], 1e-8, 'y of both')
    checks.near(np.hypot(x - along['P.x'][0], y - along['P.y'][0]), 0, 1e-6, 'the start is where it should be')


def along_start(found):
    return float(found['P.x'][0]), float(found['P.y'][0])


def test_follower_lifts_off(checks, mech9d, tmp_path):
    """A roller of radius r on an eccentric, a circle of radius R about a point at the distance e from the shaft, which turns steadily: the
    follower's motion is y = e sin a + root((R + r)^2 - (e cos a)^2). It leaves where its acceleration is that of its weight and spring."""
    big, small, e, speed, stiffness = 0.05, 0.01, 0.02, 150.0, 900.0
    # the file's circle is about the shaft: the eccentricity is that of origin
    write_path(tmp_path, circle_points(big, n=400))
    start = -pi/2
    text = f"""&structure cq=1,2 /
&pair coordinate=1, links=1,2, kind='revolute', axis=0,0,1 /
&pair coordinate=2, links=1,3, kind='prismatic', axis=0,1,0 /
&drive coordinate=1, kind='polynomial', coefficients={start!r},{speed!r} /
&body link=3, mass=0.5 /
&point name='P', link=3 /
&gravity acceleration=0,-9.81,0 /
&load kind='coordinate', coordinate=2, stiffness={stiffness}, rest=-0.05 /
&initial coordinate=2, position={big + small - e!r}, velocity=0 /
&contact point='P', link=2, kind='path', file='path.dat', origin={e},0,0, radius={small} /
"""
    found, events, _ = go(mech9d, tmp_path, text, 0.06, 50)
    length = big + small

    def lift(a):
        root = sqrt(length**2 - (e*cos(a))**2)
        return e*sin(a) + root

    def acceleration(a):
        root = sqrt(length**2 - (e*cos(a))**2)
        first = e**2*cos(a)*sin(a)/root
        second = e**2*(cos(a)**2 - sin(a)**2)/root - first**2/root
        return speed**2*(-e*sin(a) + second)

    def force(a):
        return 0.5*(acceleration(a) + G) + stiffness*(lift(a) + 0.05)

    low, high = start, pi/2
    checks.true(force(low) > 0 > force(high), 'the follower leaves on its way up')
    for _ in range(200):
        middle = (low + high)/2
        low, high = (middle, high) if force(middle) > 0 else (low, middle)
    leaves = next(event['time'] for event in events if event['kind'] == 'lift')
    # the acceleration has the errors of the spline's second derivative, which are of the fourth order
    checks.near(leaves, (low - start)/speed, 1e-9, 'the time at which it leaves')
    closed = found['t'] < leaves
    checks.near(found['q2'][closed], [lift(start + speed*t) for t in found['t'][closed]], 1e-10, 'its motion before')
    upright = [sqrt(1 - (e*cos(start + speed*t)/length)**2) for t in found['t'][closed]]
    checks.near(found['K1.fn'][closed]*upright, [force(start + speed*t) for t in found['t'][closed]], 1e-8, 'the force before')
    checks.true(any(event['kind'] == 'impact' for event in events), 'it falls back')


def test_rolls_down_a_curve(checks, mech9d, tmp_path):
    """A disc rolls without slip inside a circle: the pendulum of the length (R - r)(1 + k), with k the radius of gyration squared over r^2."""
    big, small, inertia = 1.0, 0.2, 0.004
    write_path(tmp_path, circle_points(big, n=160))
    angle = 0.4
    text = f"""&structure cq=1,2,3 /
&pair coordinates=1,2,3, links=1,2, kind='planar', axis=0,0,1, zero=1,0,0 /
&body link=2, mass=1, inertia={inertia},{inertia},{inertia},0,0,0 /
&point name='P', link=2 /
&gravity acceleration=0,-9.81,0 /
&initial coordinate=1, position={(big - small)*sin(angle)!r} /
&initial coordinate=2, position={-(big - small)*cos(angle)!r} /
&initial coordinate=3, position=0 /
&contact point='P', kind='path', file='path.dat', side='inside', radius={small}, friction=0.9 /
"""
    found, events, _ = go(mech9d, tmp_path, text, 1.0, 40)
    checks.equal([event['kind'] for event in events], ['close', 'stick'], 'it rolls')
    swing = np.arctan2(found['q1'], -found['q2'])
    factor = 1 + inertia/small**2
    # conservation of energy of the pendulum
    checks.near(np.hypot(found['dq1'], found['dq2'])**2*factor/2, G*(big - small)*(np.cos(swing) - cos(angle)), 1e-8, 'the energy')
    checks.near(found['dq3']*small, -(found['dq1']*np.cos(swing) + found['dq2']*np.sin(swing)), 1e-9, 'no slip')
    checks.near(found['K1.fn'], G*np.cos(swing) + np.hypot(found['dq1'], found['dq2'])**2/(big - small), 1e-6, 'the normal force')


def test_moving_frame(checks, mech9d, tmp_path):
    """A path on a link, turned and moved with its group, gives the motion of the path that lies in the link's axes."""
    points = [(-1, 0.2), (-0.5, 0.02), (0.0, 0.0), (0.5, 0.05), (1.0, 0.3)]
    write_path(tmp_path, points)
    text = particle(-0.6, 0.2)
    straight, _, _ = go(mech9d, tmp_path, text + "&contact point='P', kind='path', file='path.dat', side='left', radius=0.02, friction=0.1 /\n", 1)
    a, origin = 0.7, np.array([0.3, -0.4])
    turned = [(cos(a)*x + sin(a)*y, -sin(a)*x + cos(a)*y) for x, y in np.array(points) - origin]
    write_path(tmp_path, [(1000*x, 1000*y) for x, y in turned])
    moved, _, _ = go(mech9d, tmp_path, text + "&contact point='P', kind='path', file='path.dat', side='left', radius=0.02, friction=0.1, "
                     f'scale=0.001, origin={origin[0]!r},{origin[1]!r},0.3, zero={cos(a)!r},{sin(a)!r},0 /\n', 1)
    for name in ('q1', 'q2', 'K1.fn', 'K1.ft'):
        checks.near(moved[name], straight[name], 1e-8, f'the same {name}')
    checks.true(np.ptp(straight['q1']) > 0.1, 'it moves')


def test_round_an_end(checks, mech9d, tmp_path):
    """A ball passes beyond an end of a path freely, and may not come behind it."""
    write_path(tmp_path, [(-1, 0), (0, 0), None, (0, -1)])
    contact = "&contact point='P', kind='path', file='path.dat', side='left', radius=0.1 /\n"
    found, events, _ = go(mech9d, tmp_path, particle(-0.15, -2, 0.0, 3.0) + contact, 0.5)
    checks.equal(events, [], 'no event below the end')
    checks.near(found['q2'], -2 + 3*found['t'] - G*found['t']**2/2, 1e-12, 'free flight')
    checks.near(found['K1.gap'][0], hypot(0.15, 1) - 0.1, 1e-15, 'the gap is the distance from the end')
    for x, speed, intervals in ((-0.2, 5.0, 1), (-0.3, 6.0, 200), (-0.9, 5.5, 7)):
        _, _, said = go(mech9d, tmp_path, particle(x, -2.0, 0.0, speed) + contact, 0.4, intervals, code=6)
        checks.true('comes behind its path' in said, f'at x = {x}, whatever the outputs', said)
    _, _, said = go(mech9d, tmp_path, particle(-0.15, -2, 0.0, 6.0) + contact, 1, code=6)
    checks.true('the ball of contact 1 comes behind its path at t = ' in said and 'round one of its ends: it is 0.25 m' in said, 'it is told', said)


CONTACT = "&contact point='P', kind='path', file='path.dat', radius=0.1"
BAD = (
    ('no file', "&contact point='P', kind='path', radius=0.1 /\n", [(0, 0), (1, 0)], 'a path needs the file of its points; give file='),
    ('open without a side', CONTACT + ' /\n', [(0, 0), (1, 0)], "a path with ends has no outside; give side='left' or side='right'"),
    ('outside of an open one', CONTACT + ", side='outside' /\n", [(0, 0), (1, 0)], 'a path with ends has no outside'),
    ('three points', CONTACT + ", side='left' /\n", [(0, 0), (1, 0), (2, 1)], 'the side between two corners has 3 points here; give 2'),
    ('one point', CONTACT + ", side='left' /\n", [(0, 0)], 'a curve needs at least 2 points, and the file has 1; the group in line'),
    ('a repeated point', CONTACT + ", side='left' /\n", [(0, 0), (0, 0)], 'this point repeats the one before it'),
    ('a narrow valley', CONTACT + ", side='left' /\n", [(x/50, 20*(x/50)**2) for x in range(-20, 21)],
     'near this point the path bends more than the ball, which would touch it twice; make it a corner by an empty line'),
    ('a point on corners', "&contact point='P', kind='path', file='path.dat', side='left' /\n", [(-1, 0), (0, 0), None, (1, 1)],
     'a path with corners needs a ball, whose centre moves smoothly about them; give radius=, however small'),
    ('not closed', CONTACT + ', closed=.true. /\n', [(0, 0), (1, 0), (1, 1), (0, 1)], 'the ends of the curve are 1 m apart; repeat'),
    ('a normal', CONTACT + ", side='left', normal=0,1,0 /\n", [(0, 0), (1, 0)], "normal= belongs to kind='plane'; give that kind, or leave"),
    ('a file of a plane', "&contact point='P', file='path.dat' /\n", [(0, 0), (1, 0)], "file= belongs to kind='path'; give that kind, or leave"),
    ('no axis', CONTACT + ", side='left', axis=0,0,0 /\n", [(0, 0), (1, 0)], 'axis'))


@pytest.mark.parametrize('name, contact, points, words', BAD, ids=[case[0] for case in BAD])
def test_bad_paths(checks, mech9d, tmp_path, name, contact, points, words):
    write_path(tmp_path, points)
    _, _, said = go(mech9d, tmp_path, particle(0.0, 5.0) + contact, 1, code=3)
    checks.true(words in said, name, said)
    checks.true('meet.nml:' in said or 'path.dat' in said, 'with its place', said)


def test_a_curve_in_space(checks, mech9d, tmp_path):
    (tmp_path / 'path.dat').write_text('0 0 0\n1 0 0.5\n', encoding='utf-8')
    _, _, said = go(mech9d, tmp_path, particle(0.0, 5.0) + CONTACT + ", side='left' /\n", 1, code=3)
    checks.true('the path of a contact lies in a plane; give x and y in each line' in said, 'told', said)


FREE_FLIGHT = PARTICLE.split('&gravity')[0]


def fly(program, folder, start, velocity, contact, end):
    """Code, times of impacts or the time at which drives fail, and standard error, of a straight flight with two outputs."""
    if 'mech9k' in str(program):
        moves = ''.join(f"&drive coordinate={k + 1}, kind='polynomial', coefficients={start[k]!r},{velocity[k]!r} /\n" for k in (0, 1))
    else:
        moves = ''.join(f'&initial coordinate={k + 1}, position={start[k]!r}, velocity={velocity[k]!r} /\n' for k in (0, 1))
    path, report = folder / 'fly.nml', folder / 'fly.json'
    path.write_text(f"{FREE_FLIGHT}{moves}&contact point='P', kind='path', file='path.dat', {contact} /\n&time end={end!r}, intervals=1 /\n",
                    encoding='utf-8')
    done = run(program, path, '--table', folder / 'fly.dat', '--report', report)
    times = [event['time'] for event in json.loads(report.read_text()).get('events', [])]
    failed = re.search('(?:into each other|behind its path) at t = ([0-9.e+-]+) s', done.stderr)
    return done.returncode, times + [float(failed.group(1))] if failed else times, done.stderr


@pytest.mark.parametrize('program', ('mech9d', 'mech9k'))
def test_flight_past_a_blade(checks, request, tmp_path, program):
    """A ball that crosses a thin blade within one step of the integration, or between two outputs, meets its side, or its edge, or passes
    by."""
    half, r = 0.005, 0.02
    write_path(tmp_path, [(-half, -1), (half, -1), None, (half, 1), None, (-half, 1), None, (-half, -1)])
    found = request.getfixturevalue(program)
    contact = f"side='outside', radius={r}"
    for x in (-2.2, -3, -5):
        _, times, _ = fly(found, tmp_path, (x, 0.1), (8.0, 0.3), contact, 2)
        checks.near(times[:1], [(-x - half - r)/8], 1e-12, f'the side, from {x}')
    _, times, _ = fly(found, tmp_path, (-3.0, 1.01), (8.0, 0.0), contact, 2)
    # drives fail with ten digits
    checks.near(times[:1], [(3 - half - sqrt(r**2 - 0.01**2))/8], 1e-9, 'the edge')
    code, times, _ = fly(found, tmp_path, (-3.0, 1.021), (8.0, 0.0), contact, 2)
    checks.equal([code, times], [0, []], 'it passes the edge')


@pytest.mark.parametrize('program', ('mech9d', 'mech9k'))
def test_flight_from_behind(checks, request, tmp_path, program):
    """A ball that comes through an open path from behind within one step, and is far in front of it at the end, is told."""
    write_path(tmp_path, [(-1, 0), (0, 0), None, (0, -1)])
    found = request.getfixturevalue(program)
    code, times, said = fly(found, tmp_path, (-0.3, -2.0), (0.0, 8.0), "side='left', radius=0.02", 2)
    checks.equal(code, 6, 'it is refused')
    # the end of the path is the nearest point up to y = -1
    # within a hundredth of the length of a step
    checks.near(times, [1/8], 1e-2, 'when')
    checks.true('it is 0.32 m within' in said or 'would be 0.32 m within' in said, 'how far', said)


def distance_from_side(p, a, b):
    """Distance of a point from a straight side."""
    along = np.subtract(b, a)
    u = np.clip(np.dot(np.subtract(p, a), along)/np.dot(along, along), 0, 1)
    return np.linalg.norm(np.subtract(p, a) - u*along)


def first_touch(corners, start, velocity, radius, end):
    """Time at which a ball first touches a polygon, by steps of its distance over its speed; None: not until the end."""
    t, speed = 0.0, np.linalg.norm(velocity)
    while t < end:
        p = np.add(start, np.multiply(t, velocity))
        gap = min(distance_from_side(p, corners[i - 1], corners[i]) for i in range(len(corners))) - radius
        if gap < 1e-13:
            return t
        t += gap/speed
    return None


@pytest.mark.parametrize('seed', range(30))
def test_flight_at_a_polygon(checks, request, tmp_path, seed):
    """A fast ball meets a polygon with narrow tips first where its distance from the sides is its radius, or nowhere."""
    draw = np.random.default_rng(seed)
    angles = 2*pi*(np.arange(7) + draw.uniform(0, 0.8, 7))/7
    corners = [tuple(float(x) for x in draw.choice([0.05, 0.3, 1])*np.array([cos(a), sin(a)])) for a in angles]
    middle = tuple(float(x) for x in np.add(corners[0], corners[-1])/2)
    points = [middle]
    for corner in corners:
        points += [corner, None]
    write_path(tmp_path, points + [middle])
    radius, speed, far, towards = float(draw.choice([0.01, 0.1])), float(draw.choice([1, 30])), draw.uniform(1.5, 6), draw.uniform(0, 2*pi)
    start = [far*cos(towards), far*sin(towards)]
    towards += pi + draw.uniform(-0.8, 0.8)/far
    velocity, end = [speed*cos(towards), speed*sin(towards)], 2.2*far/speed
    expected = first_touch(corners, start, velocity, radius, end)
    program = request.getfixturevalue('mech9k' if seed % 2 else 'mech9d')
    _, times, said = fly(program, tmp_path, start, velocity, f"side='outside', radius={radius}, restitution=1", end)
    if expected is None:
        checks.equal(times, [], 'it meets nothing')
    else:
        # drives fail with ten digits; the reference stops 1e-13 m before it touches
        checks.near(times[:1], [expected], 1e-8*end, 'when it meets the polygon' + said)
