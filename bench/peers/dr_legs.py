"""Data files of the robot DR Legs from its published model, which is not part of this project.

usage: dr_legs.py MODEL step|fall      to standard output
    MODEL      dr_legs_no_meshes.usda of disneyresearch/dr_legs in the repository newton-physics/newton-assets

Its licence permits research and software development with benchmarks, and nothing else; so neither the model nor data files made from it
can be part of this project. bench/data has legs of the same structure with dimensions of our own.

The pelvis is link 1 and stands still. `step` drives the twelve servos within their limits; in `fall` they have no power, and the legs fall
from rest at home. Gains, friction and armatures of the servos are left out.
"""
import math
import re
import sys

import numpy as np

NUMBER = r'[-+.\d]+(?:[eE][-+]?\d+)?'


def numbers_of(text, name):
    """The numbers of an attribute: one, or a list in parentheses."""
    return np.array([float(word) for word in re.findall(rf'{NUMBER}|inf', re.search(rf'\b{name} = (.*)', text)[1])])


def rotation(quaternion):
    """The matrix of a quaternion, whose real part stands first; single precision leaves its length inexact."""
    w, x, y, z = quaternion / np.linalg.norm(quaternion)
    return np.array([[w * w + x * x - y * y - z * z, 2 * (x * y - w * z), 2 * (x * z + w * y)],
                     [2 * (x * y + w * z), w * w - x * x + y * y - z * z, 2 * (y * z - w * x)],
                     [2 * (x * z - w * y), 2 * (y * z + w * x), w * w - x * x - y * y + z * z]])


def items_of(text, kind):
    """[(name, text)] of the things of a kind."""
    parts = re.split(r'\bdef (\w+) "(\w+)"', text)
    return [(name, body) for found, name, body in zip(parts[1::3], parts[2::3], parts[3::3]) if found == kind and 'physics:' in body]


def words(values):
    return ','.join(repr(float(value)) for value in values)


def data_file(text, kind):
    bodies = items_of(text, 'Xform')
    link = {name: 1 + i for i, (name, _) in enumerate(bodies)}
    place = {}
    for name, body in bodies:
        assert not numbers_of(body, 'xformOp:rotateXYZ').any(), 'bodies are parallel at home'
        place[name] = numbers_of(body, 'xformOp:translate')
    pairs, servos = [], []
    for coordinate, (name, body) in enumerate(items_of(text, 'PhysicsRevoluteJoint'), 1):
        first, second = (re.search(rf'physics:body{k} = </dr_legs/(\w+)>', body)[1] for k in (0, 1))
        points = [place[side] + numbers_of(body, f'physics:localPos{k}') for k, side in enumerate((first, second))]
        assert abs(points[0] - points[1]).max() < 1e-8, 'home is closed in single precision'
        axis = rotation(numbers_of(body, 'physics:localRot0'))[:, 'XYZ'.index(re.search(r'physics:axis = "(\w)"', body)[1])]
        pairs.append(f"&pair coordinate={coordinate}, name='{name}', links={link[first]},{link[second]}, kind='revolute', "
                     f'point={words(points[0])}, axis={words(axis)} /')
        if 'PhysicsDriveAPI' in body:
            servos.append((coordinate, name, [math.radians(numbers_of(body, f'physics:{side}Limit')[0]) for side in ('lower', 'upper')]))
    lines = ['! The robot DR Legs, from its published model by bench/peers/dr_legs.py.',
             f"&mechanism title='DR Legs', links={len(bodies)}, coordinates={len(pairs)}, data_tolerance=1e-6 /",
             f'&structure cq={",".join(str(coordinate) for coordinate, _, _ in servos)} /', *pairs]
    for coordinate, name, (low, high) in servos:
        if kind == 'fall':
            lines.append(f'&initial coordinate={coordinate}, position=0, velocity=0 /')
            continue
        # a quarter of the range in all, to the side that bends the leg; rolls, whose range is symmetrical, to the side of the leg
        side = high + low if abs(high + low) > 1e-3 else (-1.0 if '_r_' in name else 1.0)
        phase = math.pi * ('_r_' in name) + 2.0 * name.startswith('j7')
        amplitude = math.copysign(high - low, side) / 8
        lines.append(f"&drive coordinate={coordinate}, kind='harmonic', mean={(low + high) / 2!r}, amplitude={amplitude!r}, "
                     f'angular_frequency={2 * math.pi!r}, phase={phase!r} /')
    for name, body in bodies[1:]:
        turn = rotation(numbers_of(body, 'physics:principalAxes'))
        inertia = turn @ np.diag(numbers_of(body, 'physics:diagonalInertia')) @ turn.T
        lines.append(f'&body link={link[name]}, mass={words(numbers_of(body, "physics:mass"))}, '
                     f'centre={words(place[name] + numbers_of(body, "physics:centerOfMass"))}, '
                     f'inertia={words([*np.diag(inertia), inertia[0, 1], inertia[0, 2], inertia[1, 2]])} /')
    lines += ['&gravity acceleration=0,0,-9.81 /',
              *(f"&point name='{name}', link={link[name]}, position={words(place[name])} /" for name in ('foot_l', 'foot_r')),
              f'&time start=0, end={1 if kind == "step" else 0.5}, intervals={200 if kind == "step" else 100} /',
              '&solver relative_tolerance=1e-10, absolute_tolerance=1e-10 /']
    return '\n'.join([*lines, f"&output table='dr_legs_{kind}.dat' /"]) + '\n'


if __name__ == '__main__':
    with open(sys.argv[1], encoding='utf-8') as file:
        sys.stdout.write(data_file(file.read(), sys.argv[2]))
