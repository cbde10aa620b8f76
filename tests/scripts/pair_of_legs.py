"""Writes the data files of a pair of legs with the structure of the robot DR Legs: 31 bodies, 36 revolute pairs, 6 closed chains.

usage: pair_of_legs.py step|fall      to standard output

The structure is that of Gim, Kim and Yamane (IROS 2018); all dimensions, masses and moments are our own. A leg has two chains from the
pelvis to the foot, an inner and an outer one. In each chain two servos of the hip move thigh and, by a horn and a rod, shank: five bodies
with parallel axes, a planar chain with two freedoms. Three pairs whose axes meet make the ankle. A leg has six freedoms.
At home the legs are straight; the bodies are boxes and rods along the axes of the hip, so that they have no products of inertia.
"""
import math
import sys

# Directions of a leg: forward, across the planes of its chains, and of the first two axes of the ankle (forward and up).
FORWARD, ACROSS = (0.96, 0.28), (0.28, -0.96)
ANKLE = ((-0.28, -0.96), (-0.96, 0.28))
# Points in the plane of a chain, forward and up from the pin of the thigh [m].
POINTS = {'hip': (-0.02, 0.0), 'thigh': (0.0, 0.0), 'knee': (0.0, -0.11), 'ankle': (0.0, -0.22), 'servo': (0.005, 0.03),
          'horn': (0.05, 0.03), 'rod': (0.05, -0.09)}
# Pairs of a chain: name, reference link, moving link, point, axis.
PAIRS = (('roll', 'pelvis', 'hip', 'hip', 'forward'), ('pitch', 'hip', 'thigh', 'thigh', 'across'), ('knee', 'thigh', 'shank', 'knee', 'across'),
         ('yaw', 'shank', 'ankle', 'ankle', 0), ('tilt', 'ankle', 'bracket', 'ankle', 1), ('foot', 'bracket', 'foot', 'ankle', 'across'),
         ('servo', 'hip', 'horn', 'servo', 'across'), ('crank', 'horn', 'rod', 'horn', 'across'), ('rod', 'rod', 'shank', 'rod', 'across'))
# Bodies of a chain: mass [kg], centre forward and up [m], moments about the axes [kg m^2]; those about x and y are equal.
BODIES = {'hip': (0.2, (0.0, 0.01), (8e-5, 8e-5, 6e-5)), 'thigh': (0.08, (0.0, -0.05), (9e-5, 9e-5, 2e-5)),
          'shank': (0.09, (0.01, -0.15), (1e-4, 1e-4, 3e-5)), 'ankle': (0.02, (0.0, -0.21), (4e-6, 4e-6, 4e-6)),
          'bracket': (0.01, (0.0, -0.22), (1e-6, 1e-6, 1e-6)), 'horn': (0.01, (0.0275, 0.03), (3e-6, 3e-6, 3e-6)),
          'rod': (0.02, (0.05, -0.03), (3e-5, 3e-5, 1e-6))}
FOOT = (0.15, (0.0, -0.235), (5e-5, 1.3e-4, 1.7e-4))
CHAINS = (('LI', 1, 0.035), ('LO', 1, 0.095), ('RI', -1, 0.035), ('RO', -1, 0.095))
# The servos of a leg and their motion in steps: mean, amplitude [rad], phase as a part of a turn. The others follow.
SERVOS = {('I', 'roll'): (0.02, 0.05, 0.25), ('I', 'pitch'): (0.4, 0.2, 0.0), ('I', 'servo'): (-0.45, 0.25, 0.6), ('I', 'foot'): (0.05, 0.1, 0.3),
          ('O', 'pitch'): (0.4, 0.17, 0.02), ('O', 'servo'): (-0.45, 0.22, 0.62)}


def links():
    """Numbers of the links: the pelvis 1, then those of each chain; the two chains of a leg share the foot."""
    numbers = {}
    for chain, _, _ in CHAINS:
        numbers[chain, 'pelvis'] = 1
        for body in BODIES:
            numbers[chain, body] = 2 + len(set(numbers.values()) - {1})
        if chain[1] == 'I':
            numbers[chain, 'foot'] = 2 + len(set(numbers.values()) - {1})
        else:
            numbers[chain, 'foot'] = numbers[chain[0] + 'I', 'foot']
    return numbers


def text_of(values):
    return ','.join(f'{round(value, 12) + 0.0:.12g}' for value in values)


def place(side, offset, point):
    """A point of a chain in the system of the pelvis."""
    forward, up = point
    return FORWARD[0] * forward, side * (offset + FORWARD[1] * forward), up


def direction(side, axis):
    if axis == 'forward':
        return FORWARD[0], side * FORWARD[1], 0.0
    if axis == 'across':
        return side * ACROSS[0], ACROSS[1], 0.0
    forward, up = ANKLE[axis]
    return FORWARD[0] * forward, side * FORWARD[1] * forward, up


def data_file(kind):
    numbers, independent, given, coordinate = links(), [], [], 0
    pairs = []
    for chain, side, offset in CHAINS:
        pairs += ['', f'! {"left" if side > 0 else "right"} leg, {"inner" if chain[1] == "I" else "outer"} chain']
        for name, reference, moving, point, axis in PAIRS:
            coordinate += 1
            pairs.append(f"&pair coordinate={coordinate}, name='{chain}_{name}', "
                         f"links={numbers[chain, reference]},{numbers[chain, moving]}, kind='revolute', point={text_of(place(side, offset, POINTS[point]))}, axis={text_of(direction(side, axis))} /")
            if (chain[1], name) in SERVOS:
                independent.append(coordinate)
                given.append((coordinate, side if name == 'roll' else 1, 0.0 if side > 0 else 0.5, SERVOS[chain[1], name]))
            elif name in GUESSES:
                given.append((coordinate, 1, 0.0, (GUESSES[name], None, None)))
    bodies = []
    for chain, side, offset in CHAINS:
        for body, (mass, centre, moments) in BODIES.items():
            bodies.append((numbers[chain, body], mass, place(side, offset, centre), moments))
        if chain[1] == 'I':
            bodies.append((numbers[chain, 'foot'], FOOT[0], place(side, 0.065, FOOT[1]), FOOT[2]))
    lines = [f'! A pair of legs with the structure of the robot DR Legs; {WORDS[kind]}',
             '! Link 1 is the pelvis. A leg has an inner and an outer chain, which share the foot. Written by tests/scripts/pair_of_legs.py.',
             '', f"&mechanism title='Pair of legs', links={1 + len(bodies)}, coordinates={coordinate} /",
             f'&structure cq={",".join(map(str, independent))} /', *pairs, '']
    for coordinate, sign, later, (mean, amplitude, phase) in given:
        if amplitude is None:
            lines.append(f'&initial coordinate={coordinate}, position={mean} /')
        elif kind == 'step':
            lines.append(f"&drive coordinate={coordinate}, kind='harmonic', mean={sign * mean}, amplitude={sign * amplitude}, "
                         f'angular_frequency={2 * math.pi!r}, phase={2 * math.pi * (phase + later)!r} /')
        else:
            start = mean + amplitude * math.sin(2 * math.pi * (phase + later))
            lines.append(f'&initial coordinate={coordinate}, position={round(sign * start, 4)}, velocity=0 /')
    lines += ['', *(f'&body link={link}, mass={mass}, centre={text_of(centre)}, inertia={",".join(map(repr, moments))},0,0,0 /'
                    for link, mass, centre, moments in bodies),
              '&gravity acceleration=0,0,-9.81 /',
              *(f"&point name='{name}', link={numbers[chain, 'foot']}, position={text_of((0.05, side * 0.065, -0.245))} /"
                for name, chain, side in (('left_toe', 'LI', 1), ('right_toe', 'RI', -1))), '']
    if kind == 'step':
        lines.append('&time start=0, end=1, intervals=200 /')
    else:
        lines += ['&time start=0, end=0.5, intervals=100 /', '&solver relative_tolerance=1e-10, absolute_tolerance=1e-10 /']
    return '\n'.join([*lines, f"&output table='legs_{kind}.dat' /"]) + '\n'


# Coordinates of the start that decide how the chains are assembled [rad].
GUESSES = {'knee': -0.85, 'crank': 0.85, 'rod': -0.85}
WORDS = {'step': 'its twelve servos make steps.', 'fall': 'hung by the pelvis, without power, it falls from rest in a step.'}

if __name__ == '__main__':
    sys.stdout.write(data_file(sys.argv[1]))
