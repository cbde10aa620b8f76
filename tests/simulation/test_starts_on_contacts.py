"""Periodic motions and exponents of motions that begin on closed contacts and stops, and of impacts on a plate that moves, against closed
forms of linear oscillators."""
import numpy as np

from event_derivative_cases import TIGHT, go

#: A spring, a damper and a force of the period pi/2 on coordinate 1.
SPRING = """&gravity acceleration=0,-9.81,0 /
&load kind='coordinate', coordinate=1, stiffness=30, damping=0.7 /
&load kind='coordinate', coordinate=1, force=2, law='harmonic', amplitude=1, angular_frequency=4 /
"""
#: A disc of the radius 0.2 m that rolls on a plane from the start on.
DISC = """&structure cq=1,2,3 /
&pair coordinates=1,2,3, links=1,2, kind='planar', axis=0,0,1 /
&initial coordinate=1, position=0.1, velocity=0 /
&initial coordinate=2, position=0.2, velocity=0 /
&initial coordinate=3, position=0, velocity=0 /
&body link=2, mass=2, inertia=0,0,0.04,0,0,0 /
&point name='C', link=2 /
&contact point='C', radius=0.2, normal=0,1,0, friction=0.9 /
""" + SPRING
#: A body slides along a stop, which bears it from the start on.
HELD = """&structure cq=1,2 /
&pair coordinate=1, links=1,2, kind='prismatic', axis=1,0,0 /
&pair coordinate=2, links=2,3, kind='prismatic', axis=0,1,0 /
&initial coordinate=1, position=0.1, velocity=0 /
&initial coordinate=2, position=0.2, velocity=0 /
&body link=3, mass=2 /
&stop coordinate=2, low=0.2 /
""" + SPRING
#: A ball on a plate that a drive moves by 5 mm.
PLATE = """&structure cq=1,2 /
&pair coordinate=1, links=1,2, kind='prismatic', axis=0,1,0 /
&pair coordinate=2, links=1,3, kind='prismatic', axis=0,1,0 /
&initial coordinate=1, position=0.0101, velocity=0.35 /
&body link=2, mass=0.3 /
&gravity acceleration=0,-9.81,0 /
&drive coordinate=2, kind='harmonic', amplitude=0.005, angular_frequency=60 /
&point name='P', link=2 /
&contact point='P', link=3, normal=0,1,0, restitution=0.5 /
"""


def run(program, folder, text, *options, end=1.0):
    return go(program, folder, text + (TIGHT if options[0] == '--periodic' else ''), *options, end=end, intervals=10)[1]


def multipliers_of(mass):
    """Multipliers and exponents of the oscillator with this inertia."""
    roots = np.roots([mass, 0.7, 30])
    return np.exp(roots * np.pi / 2), roots.real


def sizes(multipliers):
    return sorted(abs(complex(*m)) for m in multipliers)


def test_a_disc_that_rolls(checks, mech9d, tmp_path):
    """Its inertia counts 3/2 times along the plane. Its turn is free, with the multiplier 1; gap, rate of the gap and slip leave nothing of a
    deviation."""
    report = run(mech9d, tmp_path, DISC, '--periodic')
    multipliers, _ = multipliers_of(3)
    checks.near(sizes(report['periodic']['multipliers']), sorted([0, 0, 0, 1, *abs(multipliers)]), 1e-7, 'multipliers', scale=1)
    found = [complex(*m) for m in report['periodic']['multipliers']]
    checks.near(sum(found).real, 1 + sum(multipliers).real, 1e-7, 'and their sum', scale=1)


def test_a_disc_that_rolls_to_rest(checks, mech9d, tmp_path):
    """Exponents decay with the oscillator as long as the motion lasts, although errors across the contact do not decay."""
    text = DISC.rsplit('&load', 1)[0].replace('damping=0.7', 'damping=18')
    report = run(mech9d, tmp_path, text + '&exponents transient=16 /\n', '--exponents', '6', end=19.0)
    checks.equal(report['exponents'][3:], [None]*3, 'as many directions are lost')
    # tolerance: the sum is exact but for the ends of the time, where directions have other angles
    checks.near(sum(report['exponents'][:3]), -18 / 3, 0.05, 'the others have the sum of the oscillator', scale=1)


def test_a_body_on_a_stop(checks, mech9d, tmp_path):
    """A stop that bears a body from the start on leaves nothing of two deviations."""
    report = run(mech9d, tmp_path, HELD, '--periodic')
    multipliers, exponents = multipliers_of(2)
    checks.near(sizes(report['periodic']['multipliers']), sorted([0, 0, *abs(multipliers)]), 1e-7, 'multipliers', scale=1)
    checks.equal(report['periodic']['product_by_divergence'], None, 'no volume is left, whose divergence could be told')
    report = run(mech9d, tmp_path, HELD + '&exponents time=10 /\n', '--exponents', '4')
    checks.equal(report['exponents'][2:], [None]*2, 'two directions are lost')
    checks.near(sum(report['exponents'][:2]), sum(exponents), 1e-5, 'the others have the sum of the oscillator', scale=1)


def test_a_ball_on_a_plate_that_moves(checks, mech9d, tmp_path):
    """One impact in each period: the product of the multipliers is e^2, and their sum 1 + e^2 + (1 + e)^2 a/g, with the acceleration a of the
    plate where it has the speed g T (1 - e)/(2 (1 + e))."""
    report = run(mech9d, tmp_path, PLATE, '--periodic')['periodic']
    e, g, amplitude, frequency = 0.5, 9.81, 0.005, 60.0
    cosine = g * np.pi / frequency * (1 - e) / (1 + e) / (amplitude * frequency)
    multipliers = [m[0] for m in report['multipliers']]
    checks.near(np.prod(multipliers), e**2, 1e-9, 'their product')
    sums = [1 + e**2 + side * (1 + e)**2 * amplitude * frequency**2 * np.sqrt(1 - cosine**2) / g for side in (-1, 1)]
    checks.true(min(abs(sum(multipliers) - s) for s in sums) < 1e-7, 'their sum', (multipliers, sums))
