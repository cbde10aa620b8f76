"""Contacts of the gallery: the woodpecker toy against its own equations of motion and the published motion, walking legs and
a ratchet against circles and whole teeth."""
import json
from math import cos, hypot, pi, sin, sqrt

import numpy as np

from gallery_list import examples
from mech9_cases import read_table, run, table_and_report
from woodpecker_toy import Toy, any_angles, small_angles

PUBLISHED = ([0, -0.1036, -0.2788], [-0.3411, 0, -7.4583])


def example_of(name):
    return next(example for example in examples() if example.name == name)


def test_woodpecker(checks, mech9d):
    """All events and impulses, and the period."""
    toy = Toy(any_angles, [0, -0.1009009247206245, -0.2788], PUBLISHED[1])
    toy.run(0.6)
    _, report = table_and_report(mech9d, example_of('woodpecker').data)
    events = report['events']
    checks.equal([(event['kind'], event['number']) for event in events], [event[1:3] for event in toy.events], 'events in their order')
    # tolerance: the errors of all steps, which the free tilt of the light sleeve enlarges
    checks.near([event['time'] for event in events], [event[0] for event in toy.events], 1e-8, 'times', scale=1)
    checks.near([event['impulse'] or 0 for event in events], [event[3] for event in toy.events], 1e-8, 'impulses', scale=1e-3)
    pecks = np.array([event['time'] for event in report['events'] if (event['kind'], event['number']) == ('impact', 1)])
    checks.near(np.diff(pecks)[-1], np.diff(pecks)[-2], 1e-4, 'the motion becomes periodic', scale=1)


def test_published_woodpecker(checks):
    """The equations of motion for small angles come back to the published state: the bird at the same angle, after three periods."""
    toy = Toy(small_angles, *PUBLISHED)
    toy.run(0.41)
    while toy.closed is None or toy.state[2] > PUBLISHED[0][2]:
        toy.run(toy.t + 1e-5)
    # published to three or four digits, by another law of impacts
    checks.near(toy.state[1], PUBLISHED[0][1], 0.01, 'the sleeve is jammed')
    checks.near(toy.state[3], PUBLISHED[1][0], 0.01, 'velocity of the sleeve')
    checks.near(toy.state[5], PUBLISHED[1][2], 0.01, 'rate of the bird')


def meet(p, a, q, b, side):
    """The place where circles about p and q meet; side 1: left of the way from p to q."""
    apart = hypot(*(q - p))
    along = (apart**2 + a**2 - b**2)/(2*apart)
    x, y = (q - p)/apart
    return p + along*np.array([x, y]) + side*sqrt(a**2 - along**2)*np.array([-y, x])


def foot(crank):
    """The foot of Jansen's leg in its body."""
    pin, z = 15*np.array([cos(crank), sin(crank)]), np.array([-38, -7.8])
    j, k = meet(pin, 50, z, 41.5, -1), meet(pin, 61.9, z, 39.3, 1)
    return meet(meet(meet(j, 55.8, z, 40.1, -1), 39.4, k, 36.7, -1), 65.7, k, 49, -1)


def test_walker(checks, mech9d, tmp_path):
    """The body goes forward as the standing foot goes back on it; legs change where both feet are equally low."""
    low, high = 0.3, 0.6
    for _ in range(60):
        middle = (low + high)/2
        if foot(-pi*middle)[1] < foot(pi - pi*middle)[1]:
            low = middle
        else:
            high = middle
    step = foot(pi - pi*low)[0] - foot(-pi*low)[0]
    table, report = table_and_report(mech9d, example_of('jansen_walker').data)
    hits = [event for event in report['events'] if event['kind'] == 'impact']
    # tolerance: round-off of the chains, divided by the least rate of change of heights
    checks.near([event['time'] for event in hits], [low, low + 1, low + 2, low + 3], 1e-10, 'times of the changes', scale=1)
    checks.near(table['q1'][table['t'] % 1 < 1e-9], abs(step)*np.arange(5), 1e-9, 'steps', scale=100)
    checks.near([event['impulse'] for event in hits], [hits[0]['impulse']]*4, 1e-9, 'both legs are alike')
    checks.true(all(event['kind'] != 'slip' for event in report['events']), 'no foot slides')
    # from a body at rest the foot slides first; it comes to rest while body and leg move
    told = tmp_path / 'told.json'
    done = run(mech9d, example_of('jansen_walker').data, '--no-write', '--quiet', '--report', told, '--set', 'initial(19).velocity=0',
               '--set', 'initial(20).velocity=0')
    checks.equal(done.returncode, 0, done.stderr)
    later = [event for event in json.loads(told.read_text())['events'] if event['kind'] == 'impact'][-4:]
    checks.near([event['time'] for event in later], [event['time'] for event in hits], 1e-9, 'it walks in the same way then', scale=1)


def test_ratchet_with_large_torques(checks, mech9d, tmp_path):
    """Whatever the torque, the wheel rests in one of its twelve teeth while it is held."""
    data = example_of('ratchet').data
    for torque in (0.12, 0.3):
        table = tmp_path / f'{torque}.dat'
        done = run(mech9d, data, '--set', f'load(1).force={torque}', '--quiet', '--table', table)
        checks.equal(done.returncode, 0, done.stderr)
        columns = read_table(table.read_text())
        held = columns['q1'][np.isin(np.round(columns['t'], 9), (1.6, 1.9, 3.6, 3.9))]
        teeth = (held - held[0])/(pi/6)
        checks.near(teeth, np.round(teeth), 1e-12, 'whole teeth', scale=1)
        checks.true(abs(teeth[1]) < 1e-12 and teeth[2] > 0.5, 'it is held, and goes forwards alone')
