"""The delta robot of the gallery without drives, which falls: its data file for tests of rods between two balls."""
import os
import re

import numpy as np

from mech9_cases import TREE, text_of

FALL = """&time end=0.33, intervals=33 /
&solver relative_tolerance=1e-10, absolute_tolerance=1e-10 /
&output energies=.true. /
"""


BALL = r"coordinates=(\d+,\d+,\d+), links=(\d+),(\d+), kind='spherical', point=(\S*) /"


def let_rods_hang(text):
    """Ball joints at the platform, link 5, vertically below those at the arms."""
    above = {}

    def move(ball):
        numbers, first, second, point = ball.groups()
        rod = max(int(first), int(second))
        if '5' in (first, second):
            point = ','.join([*above[rod].split(',')[:2], '-0.64'])
        else:
            above[rod] = point
        return f"coordinates={numbers}, links={first},{second}, kind='spherical', point={point} /"

    return re.sub(BALL, move, text)


def delta(spin, independent='1,2,3', more='', vertical=False):
    """The robot of the gallery without drives, with rods of 0.1 kg whose moment of inertia about their own axes is `spin`. With
    `vertical` the platform is so wide that all rods are vertical at home."""
    text = text_of(os.path.join(TREE, 'examples', 'delta_robot', 'delta_robot.nml'))
    text = re.sub(r'&(drive|time|output).*?/\n', '', text, flags=re.S).replace('cq=1,2,3', 'cq=' + independent)
    if 'coordinate=40' in more:
        text = text.replace('links=11, coordinates=39', 'links=12, coordinates=40')
    if vertical:
        text = let_rods_hang(text)
    ends = {}
    for _, first, second, point in re.findall(BALL, text):
        rod = max(int(first), int(second)) if max(int(first), int(second)) > 5 else None
        ends.setdefault(rod, []).append(np.array([float(x) for x in point.split(',')]))
    for rod, (a, b) in ends.items():
        length = np.linalg.norm(b - a)
        along = (b - a) / length
        inertia = 0.1 * length**2 / 12 * (np.eye(3) - np.outer(along, along)) + spin * np.outer(along, along)
        numbers = [*inertia.diagonal(), inertia[0, 1], inertia[0, 2], inertia[1, 2]]
        text += (f"&body link={rod}, mass=0.1, centre={','.join(repr(float(x)) for x in (a + b) / 2)}, "
                 f"inertia={','.join(repr(float(x)) for x in numbers)} /\n")
    for coordinate in 1, 2, 3:
        text += f'&initial coordinate={coordinate}, position=0, velocity=0 /\n'
    return text + more + FALL
