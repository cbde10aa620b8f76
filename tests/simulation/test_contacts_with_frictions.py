"""Contacts of links beside friction of pairs against closed forms: both slip, stick, and give way one after the other; impacts, power, and
Coulomb's laws in a mechanism of three pairs and two contacts."""
from math import cos, sin, sqrt

import numpy as np
import pytest

import contact_cases
from contact_cases import start

G = 9.81
TIGHT = '&solver relative_tolerance=1e-10, absolute_tolerance=1e-12 /\n'
WEIGHT = '&gravity acceleration=0,0,-9.81 /\n'
# block A in a guide along x, block B beside it without a guide force of its own, in the same line
TWO_BLOCKS = """&structure cq=1,2 /
&pair coordinate=1, links=1,2, kind='prismatic', axis=1,0,0 /
&pair coordinate=2, links=1,3, kind='prismatic', axis=1,0,0 /
&body link=2, mass=2 /
&body link=3, mass=3 /
&point name='B', link=3 /
"""
# block A in a guide along x, block B on it, which may slide and lift off
ON_TOP = """&structure cq=1,2,3 /
&pair coordinate=1, links=1,2, kind='prismatic', axis=1,0,0 /
&pair coordinate=2, links=1,3, kind='prismatic', axis=1,0,0 /
&pair coordinate=3, links=3,4, kind='prismatic', axis=0,0,1 /
&body link=2, mass=2 /
&body link=4, mass=3 /
&point name='B', link=4 /
"""


def go(program, folder, text, *request):
    """A run as of contact_cases, with tight tolerances."""
    return contact_cases.go(program, folder, text + TIGHT, *request)


def named(events):
    return [(event['kind'], event['group'], event['number']) for event in events]


@pytest.mark.parametrize('mu_pair, mu_contact', [(0.2, 0.0), (0.2, 0.15), (0.35, 0.3)])
def test_a_wedge_pushes_a_block(checks, mech9d, tmp_path, mu_pair, mu_contact):
    """A wedge goes down with the speed v and pushes a block along its guide. The friction of the guide takes what presses: weight, and the
    vertical parts of the force N and of the friction of the contact."""
    m, v, nx, nz = 2, 0.3, cos(0.5), sin(0.5)
    text = ("&structure cq=1,2 /\n&pair coordinate=1, links=1,2, kind='prismatic', axis=1,0,0 /\n"
            "&pair coordinate=2, links=1,3, kind='prismatic', axis=0,0,1 /\n&body link=2, mass=2 /\n&body link=3, mass=1 /\n"
            f"&point name='P', link=2 /\n&drive coordinate=2, kind='polynomial', coefficients=0, {-v!r} /\n" + WEIGHT +
            f"&contact point='P', link=3, normal={nx!r},0,{-nz!r}, friction={mu_contact} /\n&friction coordinate=1, dynamic={mu_pair} /\n")
    begin = f'&initial coordinate=1, position=0, velocity={v*nz/nx!r} /\n'
    motion, _, _ = go(mech9d, tmp_path, text + begin + '&output drive_forces=.true., reactions=.true. /\n', 1)
    normal = mu_pair*m*G/(nx - mu_contact*nz - mu_pair*(nz + mu_contact*nx))
    guide = m*G + normal*(nz + mu_contact*nx)
    checks.near(motion['K1.fn'], normal, 1e-10, 'normal force', scale=normal)
    checks.near(motion['K1.ft'], mu_contact*normal, 1e-10, 'friction of the contact', scale=normal)
    checks.near(motion['R1.friction'], -mu_pair*guide, 1e-10, 'friction of the guide', scale=guide)
    checks.near(motion['R1.fz'], guide, 1e-10, 'reaction of the guide', scale=guide)
    checks.near(motion['q1'], v*nz/nx*motion['t'], 1e-10, 'the block follows the wedge')
    slip = v*nz/nx*nz + v*nx
    checks.near(-v*motion['F2'], motion['R1.loss'] + mu_contact*normal*slip - v*G, 1e-9, 'power of the drive, weight and frictions',
                scale=normal)
    checks.near(motion['R1.heat'][-1], mu_pair*guide*v*nz/nx, 1e-9, 'heat of the guide', scale=1)


@pytest.mark.parametrize('many', [7, 200])
@pytest.mark.parametrize('e', [0.0, 0.5])
def test_a_block_hits_another_in_its_guide(checks, mech9d, tmp_path, e, many):
    """Block B hits block A, which has friction. Without rebound both go on together, and A slows both down."""
    a, b, v, mu = 2, 3, 0.8, 0.25
    motion, events, _ = go(mech9d, tmp_path, TWO_BLOCKS + WEIGHT + start([0.5, 0.1], [0, v]) + '&friction coordinate=1, dynamic=0.25 /\n'
                           f"&contact point='B', link=2, normal=-1,0,0, restitution={e} /\n", 2, many)
    hit = 0.4/v
    fast = (1 + e)*b*v/(a + b)
    slow = v - (1 + e)*a*v/(a + b)
    checks.near(events[0]['time'], hit, 1e-12, 'time of the impact')
    checks.near(events[0]['impulse'], a*fast, 1e-10, 'its impulse: friction has no part in it')
    if e > 0:
        # A comes to rest before B catches up
        assert fast/(mu*G) < 2*(fast - slow)/(mu*G)
        again = hit + fast**2/(2*mu*G)/slow
        second = next(event for event in events if event['kind'] == 'impact' and event['time'] > hit + 1e-6)
        checks.near(second['time'], again, 1e-9, 'time of the second impact')
        return
    slowing = mu*a*G/(a + b)
    rest = hit + fast/slowing
    checks.near(max(event['time'] for event in events), rest, 1e-9, 'both come to rest')
    checks.near(motion['q1'][-1], 0.5 + fast**2/(2*slowing), 1e-9, 'there')
    during = (motion['t'] > hit + 1e-9) & (motion['t'] < rest - 1e-9)
    checks.near(motion['K1.fn'][during], b*slowing, 1e-9, 'B pushes', scale=10)
    checks.near(motion['R1.friction'][during], -mu*a*G, 1e-9, 'the whole friction', scale=10)
    after = motion['t'] > rest + 1e-9
    checks.near(motion['R1.friction'][after], 0, 1e-9, 'nothing is left to hold', scale=10)
    checks.near(motion['R1.heat'][-1], (a + b)*fast**2/2, 1e-9, 'the energy after the impact is heat', scale=1)


def test_a_block_is_pushed_until_it_slips(checks, mech9d, tmp_path):
    """A force that grows with time pushes B against A, which sticks up to its static friction and then slips with the dynamic one."""
    a, b = 2, 3
    motion, events, _ = go(mech9d, tmp_path, TWO_BLOCKS + WEIGHT + start([0.5, 0.5], [0, 0]) +
                           "&friction coordinate=1, dynamic=0.25, static=0.4 /\n&contact point='B', link=2, normal=-1,0,0 /\n"
                           "&load kind='coordinate', coordinate=2, force=5, law='polynomial', coefficients=0.1,1 /\n", 3, 30)
    slips = 0.4*a*G/5 - 0.1
    checks.equal(named(events), [('close', 'contact', 1), ('slip', 'friction', 1)], 'events')
    checks.near(events[-1]['time'], slips, 1e-10, 'it slips from this time on')
    t = motion['t']
    stuck = t < slips
    checks.near(motion['K1.fn'][stuck], 5*t[stuck] + 0.5, 1e-10, 'the contact passes the force on', scale=10)
    checks.near(motion['R1.friction'][stuck], -5*t[stuck] - 0.5, 1e-10, 'to the friction', scale=10)
    since = t[~stuck] - slips
    free = (0.4 - 0.25)*a*G
    checks.near(motion['q1'][~stuck], 0.5 + (free*since**2/2 + 5*since**3/6)/(a + b), 1e-9, 'both are accelerated')
    checks.near(motion['q2'], motion['q1'], 1e-12, 'together')


@pytest.mark.parametrize('mu_top', [0.1, 0.8])
def test_either_friction_gives_way(checks, mech9d, tmp_path, mu_top):
    """A force along B, which lies on A: B slides on A, or A slips in its guide with B at rest on it, and B slides later."""
    a, b, mu = 2, 3, 0.3
    motion, events, _ = go(mech9d, tmp_path, ON_TOP + WEIGHT + start([0, 0, 0], [0, 0, 0]) + f'&friction coordinate=1, dynamic={mu} /\n'
                           f"&contact point='B', link=2, friction={mu_top} /\n"
                           "&load kind='coordinate', coordinate=2, force=10, law='polynomial', coefficients=0,1 /\n", 6, 60)
    t, guide, top = motion['t'], mu*(a + b)*G, mu_top*b*G
    slips = [event for event in events if event['kind'] == 'slip']
    if top < guide:
        checks.equal([(event['group'], event['number']) for event in slips], [('contact', 1)], 'B slides alone')
        checks.near(slips[0]['time'], top/10, 1e-10, 'from this time on')
        checks.near(motion['q1'], 0, 1e-15, 'A does not move')
        since = np.maximum(t - top/10, 0)
        checks.near(motion['q2'], 10*since**3/(6*b), 1e-8, 'B is accelerated by what is left of the force', scale=10)
        checks.near(motion['R1.friction'], -np.minimum(10*t, top), 1e-9, 'A holds the friction of B', scale=10)
        return
    # A needs guide + a acceleration from B: B slides where this is its friction
    second = (guide + (top - guide)*(a + b)/a)/10
    checks.equal([(event['group'], event['number']) for event in slips], [('friction', 1), ('contact', 1)], 'A slips first')
    checks.near([event['time'] for event in slips], [guide/10, second], 1e-9, 'from these times on', scale=1)
    between = (t > guide/10) & (t < second)
    acceleration = (10*t[between] - guide)/(a + b)
    checks.near(motion['ddq1'][between], acceleration, 1e-9, 'both together', scale=1)
    checks.near(motion['ddq2'][between], acceleration, 1e-9, 'B too', scale=1)
    late = t > second
    checks.near(motion['ddq1'][late], (top - guide)/a, 1e-8, 'A under the friction of B alone', scale=1)
    checks.near(motion['ddq2'][late], (10*t[late] - top)/b, 1e-8, 'B under the rest', scale=1)


def test_a_jump_of_friction_lets_a_contact_slide(checks, mech9d, tmp_path):
    """A force along A grows until A slips. Its friction falls to the dynamic one, and B, which lies on A, would need more friction than it has
    from then on: it slides at the same time."""
    a, b, static, dynamic, top = 2, 3, 0.4, 0.1, 0.2
    motion, events, _ = go(mech9d, tmp_path, ON_TOP + WEIGHT + start([0, 0, 0], [0, 0, 0]) +
                           f'&friction coordinate=1, dynamic={dynamic}, static={static} /\n'
                           f"&contact point='B', link=2, friction={top} /\n"
                           "&load kind='coordinate', coordinate=1, force=10, law='polynomial', coefficients=0,1 /\n", 3, 60)
    slips, t = static*(a + b)*G/10, motion['t']
    assert (static - dynamic)*G*b > top*b*G
    both = [event for event in events if event['kind'] == 'slip']
    checks.equal(sorted((event['group'], event['number']) for event in both), [('contact', 1), ('friction', 1)], 'both slip')
    checks.near([event['time'] for event in both], slips, 1e-10, 'at one time', scale=1)
    late = t > slips
    checks.near(motion['ddq1'][late], (10*t[late] - dynamic*(a + b)*G - top*b*G)/a, 1e-9, 'A under force and both frictions', scale=1)
    checks.near(motion['ddq2'][late], top*G, 1e-9, 'B under its friction', scale=1)


def test_a_wheel_rolls_with_friction_in_its_axle(checks, mech9d, tmp_path):
    """A cart of mass c on a wheel of mass w that rolls. With the deceleration d the axle carries c sqrt(g^2 + d^2); its friction is
    d (I/R + (c + w) R)."""
    c, w, inertia, radius, pin, mu, v = 4, 1, 0.02, 0.2, 0.03, 0.3, 1.5
    text = ("&structure cq=1,2,3 /\n&pair coordinate=1, links=1,2, kind='prismatic', axis=1,0,0 /\n"
            "&pair coordinate=2, links=2,3, kind='prismatic', axis=0,0,1 /\n"
            "&pair coordinate=3, links=3,4, kind='revolute', axis=0,1,0 /\n"
            f"&body link=3, mass={c} /\n&body link=4, mass={w}, inertia=0.02,0.02,0.02,0,0,0 /\n&point name='C', link=4 /\n" + WEIGHT +
            f"&contact point='C', radius={radius}, friction=0.5 /\n&friction coordinate=3, dynamic={mu}, radius={pin} /\n")
    motion, events, _ = go(mech9d, tmp_path, text + start([0, radius, 0], [v, 0, v/radius]), 20, 100)
    k = mu*pin*c/(inertia/radius + (c + w)*radius)
    d = k*G/sqrt(1 - k**2)
    rest = v/d
    checks.equal(events[-1]['kind'], 'stick', 'it comes to rest')
    checks.near(events[-1]['time'], rest, 1e-8, 'then', scale=1)
    checks.near(motion['q1'][-1], v**2/(2*d), 1e-8, 'there', scale=1)
    rolls = motion['t'] < rest
    checks.near(motion['K1.ft'][rolls], (c + w)*d, 1e-9, 'friction of rolling', scale=1)
    checks.near(motion['R3.loss'][0], d*(inertia/radius**2 + c + w)*v, 1e-9, 'the axle takes the power', scale=1)
    energy = motion['E.kinetic'] + motion['R3.heat']
    checks.near(energy, energy[0], 1e-9, 'power balance', scale=1)


def test_a_spring_presses_a_block_against_a_wall(checks, mech9d, tmp_path):
    """A block in a guide hits a wall without rebound, is held there by its spring, and the wall bears the force alone: friction counts as
    zero where contacts hold a pair."""
    motion, events, _ = go(mech9d, tmp_path, TWO_BLOCKS + WEIGHT +
                           start([0, 5], [0, 0]) + '&friction coordinate=1, dynamic=0.25 /\n'
                           "&load kind='coordinate', coordinate=1, stiffness=80, rest=0.5 /\n&point name='A', link=2 /\n"
                           "&contact point='A', origin=0.3,0,0, normal=-1,0,0 /\n", 1)
    far, w = 0.5 - 0.25*G*2/80, sqrt(40)
    hit = np.arccos(1 - 0.3/far)/w
    checks.near([event['time'] for event in events if event['group'] == 'contact'], hit, 1e-10, 'impact, and the wall holds it')
    held = motion['t'] > hit
    checks.near(motion['K1.fn'][held], 80*0.2, 1e-10, 'the whole force of the spring', scale=10)
    checks.near(motion['R1.friction'][held], 0, 1e-10, 'no friction', scale=10)
    checks.near(motion['R1.heat'][-1], 0.25*2*G*0.3, 1e-10, 'heat of the way', scale=1)


FLAIL = """&structure cq=1,2,3 /
&pair coordinate=1, links=1,2, kind='prismatic', axis=1,0,0 /
&pair coordinate=2, links=2,3, kind='revolute', axis=0,0,1 /
&pair coordinate=3, links=3,4, kind='revolute', axis=0,0,1, point=1,0,0, moving_point=0,0,0 /
&body link=2, mass=1 /
&body link=3, mass=1, centre=0.5,0,0, inertia=0.1,0.1,0.1,0,0,0 /
&body link=4, mass=1, centre=0.5,0,0, inertia=0.1,0.1,0.1,0,0,0 /
&gravity acceleration=0,-9.81,0 /
&point name='P', link=4, position=1,0,0 /
&point name='Q', link=4, position=0,0,0 /
&contact point='P', origin=0,-0.02,0, normal=0,1,0, friction=0.3, restitution=0.4 /
&contact point='Q', origin=0,-0.02,0, normal=0,1,0, friction=0.3 /
&friction coordinate=1, dynamic=0.2 /
&friction coordinate=2, dynamic=0.2, radius=0.05 /
&friction coordinate=3, dynamic=0.2, radius=0.05, static=0.3 /
&output reactions=.true. /
"""


STOPS = '&stop coordinate=3, low=-0.05, high=1, restitution=0.2 /\n&stop coordinate=1, high=0.3, low=-0.2 /\n'


@pytest.mark.parametrize('stops, bent', [('', -1.5), (STOPS, 0.5)])
def test_coulomb_and_power_in_a_falling_chain(checks, mech9d, tmp_path, stops, bent):
    """Two bars fall from a slider onto the ground, without and with stops. In each row the frictions agree with the reactions and with the
    directions of the rates, and the energy falls by their powers."""
    d, events, _ = go(mech9d, tmp_path, FLAIL + stops + start([0, 0.9, bent], [0.5, 0, 0]), 3, 3000)
    checks.true(any(event['kind'] == 'stick' and event['group'] == 'contact' for event in events), 'a contact comes to rest')
    checks.true(any(event['kind'] == 'stick' and event['group'] == 'friction' for event in events), 'and a pair')
    bounds = [0.2*np.hypot(d['R1.fy'], d['R1.fz']), 0.01*np.hypot(d['R2.fx'], d['R2.fy']), 0.01*np.hypot(d['R3.fx'], d['R3.fy'])]
    power = 0
    for i, (bound, static) in enumerate(zip(bounds, (1, 1, 1.5)), 1):
        friction, rate = d[f'R{i}.friction'], d[f'dq{i}']
        moves = np.abs(rate) > 1e-6
        checks.near(friction[moves], -(bound*np.sign(rate))[moves], 1e-12, f'pair {i} slips against its friction', scale=1)
        checks.true(np.all(np.abs(friction) <= static*bound + 1e-10), f'pair {i} holds no more than it can')
        power = power + d[f'R{i}.loss']
    for i, point in enumerate('PQ', 1):
        slip, normal, along = np.abs(d[f'{point}.vx']), d[f'K{i}.fn'], d[f'K{i}.ft']
        checks.true(np.all(normal >= 0) and np.all(along <= 0.3*normal + 1e-10), f'contact {i} pushes, within its cone')
        slides = (slip > 1e-6) & (normal > 0)
        checks.true(np.all(np.abs(along - 0.3*normal)[slides] <= 1e-10), f'contact {i} slides against its friction')
        checks.near(d[f'K{i}.gap'][normal > 0], 0, 1e-14, f'contact {i} is closed while it pushes')
        power = power + along*slip
    t, energy = d['t'], d['E.total']
    times = np.array([event['time'] for event in events])
    quiet = [i for i in range(1, len(t) - 1) if not np.any((times >= t[i - 1] - 1e-9) & (times <= t[i + 1] + 1e-9))]
    lost = [(t[i + 1] - t[i - 1])/6*(power[i - 1] + 4*power[i] + power[i + 1]) for i in quiet]
    # tolerance: Simpson's rule over 2 ms
    checks.near([energy[i - 1] - energy[i + 1] for i in quiet], lost, 1e-8, 'power balance', scale=1)
