"""Contacts of links against closed forms, and one motion described in several ways: planes and spheres, impacts, rolling, sliding, lift-off,
contacts of moving links, closed chains, several contacts, compliant ones, paradox, driven motions, bad groups.

Compares the program with itself: a contact and a stop; one four-bar by two coordinates; few and many outputs; one motion in another frame."""
from math import asin, cos, hypot, pi, radians, sin, sqrt

import numpy as np
import pytest

from contact_cases import go, start
from mech9_cases import read_table, run

G = 9.81
TIGHT = '&solver relative_tolerance=1e-10, absolute_tolerance=1e-12 /\n'
WEIGHT = '&gravity acceleration=0,0,-9.81 /\n'
# the planar joint turns about -y, from x towards z
DISC = """&structure cq=1,2,3 /
&pair coordinates=1,2,3, links=1,2, kind='planar', axis=0,-1,0, zero=1,0,0 /
&body link=2, mass=1, inertia=0.004,0.004,0.004,0,0,0 /
&point name='C', link=2, position=0,0,0 /
"""
BALL = """&structure cq=1,2,3,4,5,6 /
&pair coordinates=1,2,3,4,5,6, links=1,2, kind='free' /
&body link=2, mass=1, inertia=0.004,0.004,0.004,0,0,0 /
&point name='C', link=2, position=0,0,0 /
"""
FOUR_BAR = """&pair coordinate=1, links=1,2, kind='revolute', axis=0,0,1, point=0,0,0 /
&pair coordinate=2, links=2,3, kind='revolute', axis=0,0,1, point=0.1,0,0, moving_point=0,0,0 /
&pair coordinate=3, links=3,4, kind='revolute', axis=0,0,1, point=0.3,0,0, moving_point=0.25,0,0 /
&pair coordinate=4, links=1,4, kind='revolute', axis=0,0,1, point=0.25,0,0, moving_point=0,0,0 /
&body link=2, mass=1, inertia=0.01,0.01,0.01,0,0,0, centre=0.05,0,0 /
&body link=3, mass=1, inertia=0.01,0.01,0.01,0,0,0, centre=0.15,0.05,0 /
&body link=4, mass=1, inertia=0.01,0.01,0.01,0,0,0, centre=0.1,0,0 /
&gravity acceleration=0,-9.81,0 /
&point name='P', link=3, position=0.15,0.2,0 /
"""
STARTS = ("&structure cq=1 /\n&initial coordinate=1, position=1.2, velocity=0 /\n&initial coordinate=2, position=-0.3 /\n"
          '&initial coordinate=3, position=1 /\n&initial coordinate=4, position=1.8 /\n')


def kinds(events):
    return [(event['kind'], event['number']) for event in events]


def test_a_ball_bounces_and_comes_to_rest(checks, mech9d, tmp_path):
    """Flights are parabolas; endless impacts end at t1 (1 + e)/(1 - e)."""
    e, first = 0.9, sqrt(2/G)
    motion, events, _ = go(mech9d, tmp_path, BALL + WEIGHT + TIGHT + start([0, 0, 1.1, 0, 0, 0], [0]*6) +
                           f"&contact point='C', radius=0.1, restitution={e} /\n", 10, 10)
    checks.near(motion['q3'][1], 0.1 + 0.7109491443330383, 1e-10, 'height at t = 1')
    checks.near(events[-1]['time'], first*(1 + e)/(1 - e), 1e-9, 'the end of the impacts: a sum of as many event times')
    checks.equal((events[-1]['kind'], events[-1]['group']), ('close', 'contact'), 'it touches then')
    checks.near(events[0]['impulse'], (1 + e)*sqrt(2*G), 1e-9, 'the first impulse')
    checks.near(motion['K1.fn'][-1], G, 1e-12, 'the weight presses')
    checks.near(motion['K1.gap'][-1], 0, 1e-15, 'the gap is closed')


@pytest.mark.parametrize('begin', [0, 100, 1000])
def test_a_ball_comes_to_rest_on_a_moving_table_at_late_times(checks, mech9d, tmp_path, begin):
    """On a table that rises evenly, impacts end as on one that rests. On one that vibrates, the ball lifts off where the table falls as fast
    as the ball, A w^2 sin(w t) = g, in each period. Neither depends on the number of periods before, but for round-off of positions and
    phases: 2e-13 of 1000 m is a rebound of 2e-6 m/s, and the flight of such a rebound lasts 4e-7 s."""
    table = ("&structure cq=1,2 /\n&pair coordinate=1, links=1,2, kind='prismatic', axis=0,0,1 /\n"
             "&pair coordinate=2, links=1,3, kind='prismatic', axis=0,0,1 /\n&body link=2, mass=1 /\n&point name='C', link=2 /\n") + WEIGHT
    e, height = 0.6, 0.1
    _, events, _ = go(mech9d, tmp_path, table + f"&contact point='C', link=3, restitution={e} /\n" +
                      f"&drive coordinate=2, kind='polynomial', coefficients={-0.6*begin!r},0.6 /\n" +
                      f'&initial coordinate=1, position={height}, velocity=0.6 /\n', begin + 3, options=('--set', f'time.start={begin}'))
    first = sqrt(2*height/G)
    checks.equal([event['kind'] for event in events], ['impact']*(len(events) - 1) + ['close'], 'it touches for good')
    checks.near(events[0]['time'] - begin, first, 1e-11, 'the first impact')
    checks.near(events[-1]['time'] - begin, first*(1 + e)/(1 - e), 1e-6, 'the end of the impacts')
    w, size, e = 30.0, 0.02, 0.3
    late = 2*pi/w*round(begin*w/(2*pi))
    _, events, _ = go(mech9d, tmp_path, table + f"&contact point='C', link=3, restitution={e} /\n" +
                      f"&drive coordinate=2, kind='harmonic', amplitude={size}, angular_frequency={w} /\n" +
                      '&initial coordinate=1, position=0.01 /\n', late + 2, options=('--set', f'time.start={late!r}'))
    lifts = np.array([event['time'] for event in events if event['kind'] == 'lift'])
    checks.equal(len(lifts), 6, 'in six periods the impacts end')
    checks.near(np.mod(w*lifts, 2*pi), np.full(6, asin(G/(size*w**2))), 1e-9, 'phase of the lifts')


def test_a_ball_slides_and_then_rolls(checks, mech9d, tmp_path):
    """The slip u keeps its direction: it ends at 2 |u|/(7 mu g), and the velocity then is v - 2 u/7, whatever the spin."""
    v, spin, mu, radius = np.array([1, 0.5]), np.array([3, -2, 5]), 0.2, 0.1
    slip = v + radius*np.array([-spin[1], spin[0]])
    motion, events, _ = go(mech9d, tmp_path, BALL + WEIGHT + TIGHT + start([0, 0, radius, 0, 0, 0], [*v, 0, *spin]) +
                           f"&contact point='C', radius={radius}, friction={mu} /\n", 1)
    checks.equal(kinds(events), [('close', 1), ('stick', 1)], 'events')
    checks.near(events[1]['time'], 2*hypot(*slip)/(7*mu*G), 1e-10, 'it rolls from this time on')
    checks.near([motion['dq1'][-1], motion['dq2'][-1]], v - 2*slip/7, 1e-9, 'velocity of rolling')
    sliding = motion['t'] < events[1]['time']
    checks.near(motion['K1.ft'][sliding], mu*G, 1e-9, 'friction while it slides')
    checks.near(motion['K1.ft'][~sliding], 0, 1e-9, 'none while it rolls')
    checks.near(motion['K1.gap'], 0, 1e-14, 'it does not leave the plane')


def test_a_ball_rolls_on_a_turntable_in_a_circle(checks, mech9d, tmp_path):
    """A sphere that rolls on a table with the angular velocity w goes round with 2 w/7, wherever it begins."""
    speed, v, x, radius = 3, np.array([0.2, 0.1]), 0.3, 0.1
    text = BALL.replace('cq=1,2,3,4,5,6', 'cq=1,2,3,4,5,6,7') + WEIGHT + TIGHT + start(
        [x, 0, radius, 0, 0, 0], [*v, 0, (speed*x - v[1])/radius, v[0]/radius, 0.7])
    text += ("&pair coordinate=7, links=1,3, kind='revolute', axis=0,0,1 /\n"
             f"&drive coordinate=7, kind='polynomial', coefficients=0,{speed} /\n"
             f"&contact point='C', link=3, radius={radius}, friction=5 /\n")
    motion, events, _ = go(mech9d, tmp_path, text, 7*pi/speed, 8)
    checks.equal(kinds(events), [('close', 1), ('stick', 1)], 'it rolls')
    centre = np.array([x, 0]) + np.array([-v[1], v[0]])*7/(2*speed)
    distances = np.hypot(motion['C.x'] - centre[0], motion['C.y'] - centre[1])
    checks.near(distances, hypot(*v)*7/(2*speed), 1e-9, 'a circle')
    checks.near([motion['C.x'][-1], motion['C.y'][-1]], [x, 0], 1e-9, 'round once')


@pytest.mark.parametrize('speed', [0.3, 70.856707984268])
def test_a_foot_stands_while_its_body_moves(checks, mech9d, tmp_path, speed):
    """A foot on a body that a drive moves comes to rest on the ground: the velocities of both cancel each other. It slides for the time
    u/(mu g), and the round-off of the velocity of the body is not a slip."""
    slip, mu = 0.1, 0.8
    text = ("&structure cq=1,2,3 /\n&pair coordinate=1, links=1,2, kind='prismatic', axis=1,0,0 /\n"
            "&pair coordinate=2, links=2,3, kind='prismatic', axis=1,0,0 /\n&pair coordinate=3, links=3,4, kind='prismatic', axis=0,0,1 /\n"
            f"&body link=4, mass=1.1 /\n&point name='P', link=4 /\n&drive coordinate=1, kind='polynomial', coefficients=0, {speed!r} /\n")
    motion, events, _ = go(mech9d, tmp_path, text + WEIGHT + TIGHT + f"&initial coordinate=2, position=0, velocity={slip - speed!r} /\n"
                           f"&initial coordinate=3, position=0 /\n&contact point='P', friction={mu} /\n", 1)
    checks.equal(kinds(events), [('close', 1), ('stick', 1)], 'events')
    # tolerance: that of the integration, of a velocity of 71 m/s
    checks.near(events[1]['time'], slip/(mu*G), 1e-8, 'it stands from this time on', scale=1)
    checks.near(motion['P.x'][-1], slip**2/(2*mu*G), 1e-8, 'and stays there', scale=1)


@pytest.mark.parametrize('friction', [0, 0.5, 2, 1000])
def test_a_ball_leaves_a_sphere(checks, mech9d, tmp_path, friction):
    """Without friction it leaves where the cosine is 2/3 of that at the start. A ball that rolls slips where its weight presses too little:
    where 17 cos - 10 cos(start) = 2 sin/mu. Just behind that, it leaves."""
    large, radius, tilt = 1, 0.1, 0.01
    text = BALL + WEIGHT + TIGHT + start([(large + radius)*sin(tilt), 0, (large + radius)*cos(tilt), 0, 0, 0], [0]*6)
    text += f"&contact point='C', kind='sphere', other_radius={large}, radius={radius}, friction={friction} /\n"
    _, events, _ = go(mech9d, tmp_path, text, 3)
    wanted = ['close', 'stick', 'slip', 'lift'] if friction else ['close', 'lift']
    checks.equal([event['kind'] for event in events], wanted, 'it leaves at last')
    motion, _, _ = go(mech9d, tmp_path, text, events[-2 if friction else -1]['time'], 1)
    x, z = motion['C.x'][-1], motion['C.z'][-1]
    cosine, sine = z/hypot(x, z), x/hypot(x, z)
    if friction:
        checks.near(17*cosine - 10*cos(tilt), 2*sine/friction, 1e-8, 'where it slips')
    else:
        checks.near(cosine, 2/3*cos(tilt), 1e-8, 'where it leaves')


@pytest.mark.parametrize('mu', [0.05, 0.5])
def test_an_impact_has_friction(checks, mech9d, tmp_path, mu):
    """The tangential impulse is mu times the normal one, or the one that ends the slip."""
    e, v, spin, radius, inertia = 0.5, 1, 20, 0.1, 0.004
    motion, events, _ = go(mech9d, tmp_path, DISC + WEIGHT + TIGHT + start([0, radius + 1, 0], [v, 0, spin]) +
                           f"&contact point='C', radius={radius}, restitution={e}, friction={mu} /\n", 0.5, 1)
    normal = (1 + e)*sqrt(2*G)
    along = min(mu*normal, (v + radius*spin)/(1 + radius**2/inertia))
    checks.near(events[0]['impulse'], normal, 1e-9, 'normal impulse')
    checks.near(motion['dq1'][-1], v - along, 1e-12, 'velocity afterwards')
    checks.near(motion['dq3'][-1], spin - along*radius/inertia, 1e-10, 'spin afterwards')


@pytest.mark.parametrize('slope, mu', [(0.3, 0.2), (0.3, 0.4), (0, 0.3)])
def test_a_box_slides_on_two_points(checks, mech9d, tmp_path, slope, mu):
    """Its acceleration is g (sin - mu cos); both feet come to rest at once and share their friction at rest."""
    text = DISC.replace('&body link=2, mass=1', '&body link=2, mass=2') + TIGHT
    text += f"&gravity acceleration={G*sin(slope)!r},0,{-G*cos(slope)!r} /\n" + start([0, 0.1, 0], [0.5, 0, 0])
    for name, x in (('A', -0.1), ('B', 0.1)):
        text += f"&point name='{name}', link=2, position={x},0,-0.1 /\n&contact point='{name}', friction={mu} /\n"
    motion, events, _ = go(mech9d, tmp_path, text, 1)
    gain = G*(sin(slope) - mu*cos(slope))
    way = 0.5 + gain/2 if gain > 0 else 0.125/-gain
    checks.near(motion['q1'][-1], way, 1e-10, 'way')
    checks.near(motion['K1.fn'] + motion['K2.fn'], 2*G*cos(slope), 1e-10, 'both press with the weight')
    stops = [event['time'] for event in events if event['kind'] == 'stick']
    checks.equal(len(stops), 2 if gain < 0 else 0, 'both come to rest, or none')
    if gain < 0:
        checks.near(stops, [0.5/-gain]*2, 1e-10, 'at once')
        checks.near(motion['K1.ft'][-1] + motion['K2.ft'][-1], 2*G*sin(slope), 1e-10, 'friction holds at rest')


def test_a_box_falls_on_its_edge_and_comes_to_rest(checks, mech9d, tmp_path):
    text = DISC + WEIGHT + TIGHT + start([0, 0.3, 0.3], [0, 0, 0])
    for name, x in (('A', -0.1), ('B', 0.1)):
        text += f"&point name='{name}', link=2, position={x},0,-0.1 /\n&contact point='{name}', friction=0.5, restitution=0.3 /\n"
    motion, _, _ = go(mech9d, tmp_path, text, 3, 60)
    checks.near([motion['q2'][-1], motion['q3'][-1]], [0.1, 0], 1e-12, 'it lies flat')
    checks.true(min(motion['K1.gap'].min(), motion['K2.gap'].min()) > -1e-12, 'it never enters the floor')
    energy = motion['E.total']
    checks.true((np.diff(energy) < 1e-9).all(), 'it gains no energy', energy)


def test_discs_in_a_box_keep_their_energy(checks, mech9d, tmp_path):
    """Elastic impacts of three discs with each other and with four walls; the walls are planes."""
    text = '&mechanism links=4, coordinates=9 /\n&structure cq=1,2,3,4,5,6,7,8,9 /\n' + TIGHT
    rates = [(1.3, -1.1, 3), (-0.7, 1.6, -4), (0.4, 0.9, 1)]
    for i, (vx, vz, turn) in enumerate(rates):
        c = 3*i
        text += (f"&pair coordinates={c + 1},{c + 2},{c + 3}, links=1,{i + 2}, kind='planar', axis=0,-1,0, zero=1,0,0 /\n"
                 f'&body link={i + 2}, mass={1 + 0.3*i}, inertia=0.004,0.004,0.004,0,0,0 /\n'
                 f"&point name='C{i}', link={i + 2}, position=0,0,0 /\n"
                 f'&initial coordinate={c + 1}, position={0.25 + 0.3*i}, velocity={vx} /\n'
                 f'&initial coordinate={c + 2}, position={0.2 + 0.23*i}, velocity={vz} /\n'
                 f'&initial coordinate={c + 3}, position=0, velocity={turn} /\n')
        for origin, normal in (('0,0,0', '1,0,0'), ('1.2,0,0', '-1,0,0'), ('0,0,0', '0,0,1'), ('0,0,1.2', '0,0,-1')):
            text += f"&contact point='C{i}', origin={origin}, normal={normal}, radius=0.1, restitution=1 /\n"
        for j in range(i):
            text += f"&contact point='C{i}', link={j + 2}, kind='sphere', radius=0.1, other_radius=0.1, restitution=1 /\n"
    motion, events, _ = go(mech9d, tmp_path, text, 3, 60)
    checks.true(len(events) > 15, 'there are many impacts', len(events))
    checks.near(motion['E.total'], motion['E.total'][0], 1e-9, 'energy')
    gaps = [motion[f'K{i}.gap'].min() for i in range(1, 16)]
    checks.true(min(gaps) > -1e-12, 'nothing passes', gaps)


def test_a_contact_is_a_stop(checks, mech9d, tmp_path):
    """A point on a slider above a plane, and a stop of the slider's coordinate."""
    text = ("&structure cq=1 /\n&pair coordinate=1, links=1,2, kind='prismatic', axis=0,0,1 /\n&body link=2, mass=1 /\n"
            "&point name='C', link=2, position=0,0,0 /\n&initial coordinate=1, position=1, velocity=0 /\n" + WEIGHT + TIGHT)
    by_contact, events, _ = go(mech9d, tmp_path, text + "&contact point='C', restitution=0.6 /\n", 3)
    by_stop, others, _ = go(mech9d, tmp_path, text + '&stop coordinate=1, low=0, restitution=0.6 /\n', 3)
    checks.equal([event['kind'] for event in events], [event['kind'] for event in others], 'the same events')
    checks.near([event['time'] for event in events], [event['time'] for event in others], 1e-10, 'at the same times')
    checks.near(by_contact['q1'], by_stop['q1'], 1e-10, 'the same motion')
    checks.near(by_contact['K1.fn'], by_stop['S1'], 1e-10, 'the same force')


def test_a_stop_is_hit_beside_a_contact(checks, mech9d, tmp_path):
    """A disc that rolls against a stop slips back: the stop takes its velocity, and leaves its spin. It rolls again at v - 2 u/7."""
    motion, events, _ = go(mech9d, tmp_path, DISC + WEIGHT + TIGHT + start([0, 0.1, 0], [2, 0, 0]) +
                           "&contact point='C', radius=0.1, friction=0.2 /\n&stop coordinate=1, high=0.5, restitution=0.5 /\n", 2)
    checks.equal([(event['kind'], event['group']) for event in events],
                 [('close', 'contact'), ('stick', 'contact'), ('impact', 'stop'), ('slip', 'contact'), ('stick', 'contact')], 'events')
    rolls = 2*5/7
    back, slip = -rolls/2, -rolls/2 - rolls
    checks.near(motion['dq1'][-1], back - 2*slip/7, 1e-9, 'velocity of rolling back')
    checks.near(events[4]['time'] - events[3]['time'], 2*-slip/(7*0.2*G), 1e-9, 'it slips so long')


@pytest.mark.parametrize('friction', [0, 0.3])
def test_a_coupler_point_meets_a_plane(checks, mech9d, tmp_path, friction):
    """A four-bar by two independent coordinates; impulses of pairs and of the contact change its momentum."""
    plane = f"&contact point='P', origin=0,0.1,0, normal=0,1,0, restitution=0.5, friction={friction} /\n" + TIGHT
    text = FOUR_BAR + plane + '&output reactions=.true. /\n'
    first, events, _ = go(mech9d, tmp_path, text + STARTS, 1)
    checks.true(len(events) > 3, 'it bounces', kinds(events))
    checks.true(first['K1.gap'].min() > -1e-12, 'it does not pass', first['K1.gap'].min())
    rest = '\n'.join(line for line in STARTS.splitlines() if 'coordinate=1' not in line and 'coordinate=4' not in line)
    other = rest.replace('cq=1', 'cq=4') + (f"\n&initial coordinate=4, position={first['q4'][0]!r}, velocity=0 /\n"
                                            '&initial coordinate=1, position=1.2 /\n')
    second, others, _ = go(mech9d, tmp_path, text + other, 1)
    checks.near(second['q1'], first['q1'], 1e-10, 'the same motion')
    checks.near([event['time'] for event in others], [event['time'] for event in events], 1e-10, 'the same times')
    hit = events[0]
    before, _, _ = go(mech9d, tmp_path, text + STARTS, hit['time'] - 1e-9, 1)
    after, _, _ = go(mech9d, tmp_path, text + STARTS, hit['time'] + 1e-9, 1)
    centres = ((2, 0.05, 0), (3, 0.15, 0.05), (4, 0.1, 0))
    change = np.zeros(2)
    for motion, sign in ((before, -1), (after, 1)):
        at = motion['q1'][-1], motion['q1'][-1] + motion['q2'][-1], motion['q4'][-1]
        turns = motion['dq1'][-1], motion['dq1'][-1] + motion['dq2'][-1], motion['dq4'][-1]
        pin = 0.1*turns[0]*np.array([-sin(at[0]), cos(at[0])])
        for (_, x, y), angle, turn, carried in zip(centres, at, turns, (0, pin, 0)):
            change += sign*(carried + turn*np.array([-x*sin(angle) - y*cos(angle), x*cos(angle) - y*sin(angle)]))
    pairs = {pair['pair']: np.array(pair['force'][:2]) for pair in hit['pairs']}
    given = pairs[1] + pairs[4]
    checks.near(change[1] - given[1], hit['impulse'], 1e-6, 'the normal impulse is what pairs 1 and 4 leave: motion 1e-9 s aside')
    checks.true(abs(change[0] - given[0]) <= friction*hit['impulse'] + 1e-6, 'the tangential one is within the cone')


@pytest.mark.parametrize('exponent', [1, 1.5])
def test_a_compliant_contact_keeps_energy(checks, mech9d, tmp_path, exponent):
    motion, events, _ = go(mech9d, tmp_path, DISC + WEIGHT + TIGHT + start([0, 0.3, 0], [1, 0, 0]) +
                           f"&contact point='C', radius=0.1, stiffness=1e5, exponent={exponent} /\n", 2, 100)
    checks.equal(kinds(events)[:2], [('close', 1), ('lift', 1)], 'events')
    checks.near(motion['E.total'], motion['E.total'][0], 2e-9, 'energy')


def test_a_compliant_contact_sticks(checks, mech9d, tmp_path):
    """A disc that bounces on a compliant floor rolls at last: a homogeneous sphere with 5/7 of its velocity."""
    motion, events, _ = go(mech9d, tmp_path, DISC + WEIGHT + TIGHT + start([0, 0.3, 0], [1, 0, 0]) +
                           "&contact point='C', radius=0.1, stiffness=1e5, exponent=1.5, damping=1e4, friction=0.2 /\n", 2, 40)
    checks.true(('stick', 1) in kinds(events), 'it sticks', kinds(events))
    checks.near(motion['dq1'][-1], 5/7, 1e-6, 'velocity of rolling: it sticks while the normal force changes')


def test_outputs_change_nothing(checks, mech9d, tmp_path):
    text = DISC + WEIGHT + TIGHT + start([0, 0.4, 0.2], [1, 0, 9]) + "&contact point='C', radius=0.1, restitution=0.4, friction=0.15 /\n"
    few, events, _ = go(mech9d, tmp_path, text, 1.5, 1)
    many, others, _ = go(mech9d, tmp_path, text, 1.5, 1000)
    checks.equal([event['time'] for event in events], [event['time'] for event in others], 'events at the same bits')
    checks.near(few['q1'][-1], many['q1'][-1], 1e-12, 'the same end')


def test_the_frame_does_not_matter(checks, mech9d, tmp_path):
    """A ball on a slope, and on a floor under a weight that is turned."""
    slope, turn = 0.4, radians(30)
    tilted = (f"&gravity acceleration={G*sin(slope)*cos(turn)!r},{G*sin(slope)*sin(turn)!r},{-G*cos(slope)!r} /\n")
    flat, events, _ = go(mech9d, tmp_path, BALL + tilted + TIGHT + start([0, 0, 0.1, 0, 0, 0], [0.5, -0.2, 0, 0, 0, 0]) +
                         "&contact point='C', radius=0.1, friction=0.1 /\n", 0.8)
    # turned about y: x' = x cos + z sin, z' = -x sin + z cos

    def turned(vector):
        x, y, z = vector
        return x*cos(0.7) + z*sin(0.7), y, -x*sin(0.7) + z*cos(0.7)
    weight = turned((G*sin(slope)*cos(turn), G*sin(slope)*sin(turn), -G*cos(slope)))
    text = BALL + f"&gravity acceleration={','.join(repr(w) for w in weight)} /\n" + TIGHT
    text += start([*turned((0, 0, 0.1)), 0, 0, 0], [*turned((0.5, -0.2, 0)), 0, 0, 0])
    text += f"&contact point='C', radius=0.1, friction=0.1, normal={','.join(repr(n) for n in turned((0, 0, 1)))} /\n"
    other, others, _ = go(mech9d, tmp_path, text, 0.8)
    checks.equal(kinds(events), kinds(others), 'the same events')
    checks.near(other['K1.ft'], flat['K1.ft'], 1e-9, 'the same friction')
    checks.near(np.array(turned((flat['C.x'], flat['C.y'], flat['C.z']))), np.array([other['C.x'], other['C.y'], other['C.z']]), 1e-10,
                'the same motion')


@pytest.mark.parametrize(('mu', 'e'), [(0.8, 0.0), (0.3, 0.0), (0.8, 0.5)])
def test_an_impact_that_brings_all_to_rest(checks, mech9d, tmp_path, mu, e):
    """A rod falls about its pin with its tip on a floor and rests there; the contact sticks, in whatever plane the rod turns. Its force holds the
    moment of the weight, F cos b + T sin b = m g cos(b)/2, with the least (F^2 + (T/mu)^2), for the rod at the angle b below the horizontal."""
    c, s = 0.8, 0.6
    normal = 0.5*3*G*c*c/(c*c + mu*mu*s*s)
    for turn in (0.0, 0.3, 1.0, 2.1, -0.7):
        # all is turned about x by the angle
        up, axis = f'0,{cos(turn)!r},{sin(turn)!r}', f'0,{-sin(turn)!r},{cos(turn)!r}'
        text = f"""&structure cq=1 /
&pair coordinate=1, links=1,2, kind='revolute', axis={axis}, zero=1,0,0 /
&body link=2, mass=3, centre=0.5,0,0, inertia=0,0.25,0.25,0,0,0 /
&gravity acceleration=0,{-G*cos(turn)!r},{-G*sin(turn)!r} /
&point name='P', link=2, position=1,0,0 /
&contact point='P', origin=0,{-s*cos(turn)!r},{-s*sin(turn)!r}, normal={up}, friction={mu}, restitution={e} /
""" + start([0.2], [0.0])
        table, events, _ = go(mech9d, tmp_path, text, 3.0, 1)
        checks.true('stick' in [event['kind'] for event in events], f'turned by {turn}: it sticks', events)
        checks.near([table['K1.fn'][-1], table['K1.ft'][-1]], [normal, normal*mu*mu*s/c], 1e-12, f'turned by {turn}: forces', scale=10)


def rod(mu, speed, turning=0.0):
    """A rod of 2 m at 60 degrees slides on its end. Its angle is that of the direction from the end upwards."""
    angle = radians(60)
    velocity = [speed - turning*sin(angle), turning*cos(angle), turning]
    return ("&structure cq=1,2,3 /\n&pair coordinates=1,2,3, links=1,2, kind='planar', axis=0,-1,0, zero=1,0,0 /\n"
            "&body link=2, mass=1, inertia=0.3333333333333333,0.3333333333333333,0.3333333333333333,0,0,0 /\n"
            "&point name='A', link=2, position=-1,0,0 /\n" + WEIGHT + start([0, sin(angle), angle], velocity) +
            f"&contact point='A', friction={mu} /\n")


def test_a_rod_has_the_paradox_of_painleve(checks, mech9d, tmp_path):
    """1 + 3 cos^2 - 3 mu sin cos is negative from mu = 1.3471506 on, where the friction draws the end into the floor.

    Without a force the end accelerates by turning^2 sin - g along the normal. A force makes this less, so that there is no solution
    where it is below zero, and two, with and without a force, where it is above."""
    bound = (1 + 3*0.25)/(3*sin(radians(60))*0.5)
    # the rod that falls comes nearer to the bound, so that a motion needs some distance from it
    for mu, code in ((bound*(1 - 1e-3), 0), (bound*(1 + 1e-9), 6)):
        _, _, message = go(mech9d, tmp_path, rod(mu, -1.0), 1e-7, 1, code=code)
        if code:
            checks.true('no solution there' in message, 'it is told', message)
    for factor, words in ((0.99, 'no solution there'), (1.01, 'several solutions there')):
        for sense in (-1, 1):
            turning = sense*sqrt(factor*G/sin(radians(60)))
            _, _, message = go(mech9d, tmp_path, rod(1.1*bound, -1.0, turning), 1e-7, 1, code=6)
            checks.true(words in message, f'turning with {turning:.6g} rad/s: {words}', message)
    _, events, _ = go(mech9d, tmp_path, rod(2*bound, 1.0), 0.05, 1)
    checks.equal(kinds(events)[0], ('close', 1), 'the other direction has no such bound')


def test_a_driven_link_must_not_pass(checks, mech9k, mech9d, tmp_path):
    text = ("&structure cq=1 /\n&pair coordinate=1, links=1,2, kind='revolute', axis=0,-1,0 /\n"
            "&drive coordinate=1, kind='polynomial', coefficients=0,-1 /\n&point name='P', link=2, position=1,0,0 /\n")
    path = tmp_path / 'driven.nml'
    path.write_text(text + "&contact point='P', origin=0,0,-0.5 /\n&time end=1, intervals=4 /\n", encoding='utf-8')
    done = run(mech9k, path)
    checks.equal(done.returncode, 6, 'mech9k')
    checks.true('move into each other at t = 0.5235987756 s' in done.stderr, 'when', done.stderr)
    path.write_text(text + "&body link=2, mass=1 /\n&contact point='P', origin=0,0,-0.5, stiffness=1000 /\n&output drive_forces=.true. /\n"
                    '&time end=1, intervals=4 /\n', encoding='utf-8')
    table = tmp_path / 'driven.dat'
    checks.equal(run(mech9k, path, '--table', table).returncode, 0, 'compliant')
    motion = read_table(table.read_text())
    depth = np.maximum(0, np.sin(motion['t']) - 0.5)
    checks.near(motion['K1.fn'], 1000*depth, 1e-9, 'its force')
    # the drive turns the crank by -t: the force on P at cos t turns it back
    checks.near(motion['F1'], -1000*depth*np.cos(motion['t']), 1e-9, 'the drive bears it')
    free = text.replace('cq=1', 'cq=1,2') + ("&pair coordinate=2, links=1,3, kind='prismatic', axis=0,1,0 /\n&body link=2, mass=1 /\n"
                                             '&body link=3, mass=1 /\n&initial coordinate=2, position=0, velocity=1 /\n'
                                             "&contact point='P', origin=0,0,-0.5 /\n")
    _, _, message = go(mech9d, tmp_path, free, 1, 4, code=6)
    checks.true(f'from t = {asin(0.5):.10g} s on' in message, 'mech9d', message)


def test_check_names_contacts(checks, mech9d, tmp_path):
    path = tmp_path / 'check.nml'
    path.write_text(DISC + start([0, 0.3, 0], [0, 0, 0]) + "&contact point='C', radius=0.1, friction=0.2 /\n"
                    "&contact point='C', kind='sphere', origin=0,0,-1, other_radius=0.5, stiffness=1e4 /\n", encoding='utf-8')
    done = run(mech9d, path, '--check')
    checks.true('contact 1: a ball of the radius 0.1 m of link 2 is 0.2 m from a plane of link 1; restitution 0; coefficients of '
                'friction 0.2 at rest, 0.2 in motion' in done.stdout, 'a plane', done.stdout)
    checks.true('contact 2: a point of link 2 is 0.8 m from a sphere of link 1; compliant' in done.stdout, 'a sphere', done.stdout)


BAD = [("radius=0.1", 'are 0.05 m within each other at the start'),
       ("point='X'", 'there is no point X'),
       ('link=2', 'which does not touch itself'),
       ('link=7', 'there is no link 7'),
       ('restitution=1.2', 'would add energy'),
       ('friction=-1', "'friction' must be >=0"),
       ('static_friction=0.1, friction=0.2', 'is less than friction='),
       ('static_friction=0.3', 'needs the coefficient in motion'),
       ('normal=0,0,0', 'has no length'),
       ("kind='sphere'", 'neither the ball nor the sphere has a radius'),
       ("kind='sphere', radius=1, normal=0,0,1", "normal= belongs to kind='plane'"),
       ('other_radius=1', "other_radius= belongs to kind='sphere'"),
       ('stiffness=10, restitution=0.1', 'is compliant and has no restitution'),
       ('damping=10', 'damping= belongs to a compliant contact'),
       ('exponent=2', 'exponent= belongs to a compliant contact')]


@pytest.mark.parametrize('items, message', BAD)
def test_bad_groups_are_told(checks, mech9d, tmp_path, items, message):
    point = '' if 'point=' in items else "point='C', "
    _, _, told = go(mech9d, tmp_path, DISC + WEIGHT + start([0, 0.05, 0], [0, 0, 0]) + f'&contact {point}{items} /\n', 1, code=3)
    checks.true(message in told, 'the message', told)


STILL = {'drive': ("&structure cq=1,2 /\n&drive coordinate=2, kind='polynomial', coefficients=0.1 /\n"
                   "&pair coordinate=1, links=1,2, kind='prismatic', axis=0,0,1 /\n"
                   "&pair coordinate=2, links=2,3, kind='prismatic', axis=0,0,1 /\n"
                   "&contact point='C', link=2, origin=0,0,-0.1 /\n"),
         'chain': ("&structure cq=1 /\n&pair coordinate=1, links=1,2, kind='revolute', axis=0,1,0 /\n"
                   "&pair coordinate=2, links=2,3, kind='revolute', axis=0,0,1, point=1,0,0 /\n"
                   "&pair coordinate=3, links=2,3, kind='revolute', axis=1,0,0, point=1,1,0 /\n"
                   "&contact point='C', link=2, origin=0,0,-0.1 /\n")}


@pytest.mark.parametrize('kind', STILL)
def test_links_that_never_move_against_each_other(checks, mech9d, tmp_path, kind):
    """A drive or a chain holds the pair between the links; the drive may move, or the surface belong to the frame."""
    text = STILL[kind] + "&initial coordinate=1, position=0, velocity=0 /\n&body link=3, mass=1, centre=0.2,0,0 /\n&point name='C', link=3, position=0,0,0 /\n" + WEIGHT
    _, _, told = go(mech9d, tmp_path, text, 0.05, code=3)
    checks.true('links of contact 1 never move against each other' in told, 'told', told)
    for old, new in (('link=2, origin=0,0,-0.1', 'origin=0,0,-9'), ('coefficients=0.1', 'coefficients=0.1,0.01')):
        if old in text:
            go(mech9d, tmp_path, text.replace(old, new), 0.05)


def test_a_dead_point_at_the_start(checks, mech9d, tmp_path):
    """The slider of a crank stands still at the dead point where the motion begins, and moves against its wall afterwards."""
    text = """&structure cq=1 /
&pair coordinate=1, links=1,2, kind='revolute', axis=0,0,1 /
&pair coordinate=2, links=2,3, kind='revolute', axis=0,0,1, point=0.2,0,0 /
&pair coordinate=3, links=3,4, kind='revolute', axis=0,0,1, point=0.7,0,0 /
&pair coordinate=4, links=1,4, kind='prismatic', axis=-1,0,0, point=0.7,0,0 /
&body link=2, mass=1, inertia=0.01,0.01,0.01,0,0,0 /
&point name='P', link=4, position=0.7,0,0 /
&contact point='P', normal=1,0,0, origin=0.35,0,0 /
""" + start([0, 0, 0, 0], [1])
    table, events, _ = go(mech9d, tmp_path, text, 4.0)
    checks.near(table['K1.gap'][0], 0.35, 1e-12, 'gap at the start')
    checks.equal(kinds(events)[:1], [('impact', 1)], 'the slider hits the wall')
