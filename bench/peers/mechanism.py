"""Mechanisms of data files, as other programs are given them: links, pairs, bodies, loads, and the closed position and rates of the start.

Pairs are revolute or prismatic, the systems of all links are parallel at home, bodies have no products of inertia, and loads are torques
and springs.
"""
import math
import os
import re
import subprocess

try:
    import numpy as np
except ImportError:
    np = None     # only the places of links need it


class Pair:
    """A revolute or prismatic pair."""

    def __init__(self, values, numbers):
        self.kind = values['kind'].strip("'")
        assert self.kind in ('revolute', 'prismatic'), 'revolute and prismatic pairs only'
        self.turns = self.kind == 'revolute'
        self.coordinate = int(numbers['coordinate'][0])
        self.reference, self.moving = (int(number) for number in numbers['links'])
        self.axis = numbers['axis']
        self.point = numbers.get('point', [0.0] * 3)
        self.moving_point = numbers.get('moving_point', self.point)


class Mechanism:
    """Links, pairs, bodies and loads of a data file, and its start as mech9d finds it."""

    def __init__(self, path, columns):
        text = re.sub(r'!.*', '', open(path, encoding='utf-8').read())
        self.pairs, self.bodies, self.torques, self.springs, self.points = [], {}, {}, [], {}
        self.gravity = [0.0, 0.0, 0.0]
        for name, body in re.findall(r"&(\w+)((?:'(?:[^']|'')*'|[^'/])*)/", text):
            values = dict(re.findall(r"(\w+)\s*=\s*('(?:[^']|'')*'|[^=]*?)(?=,?\s*\w+\s*=|$)", body.strip()))
            numbers = {key: [float(word) for word in value.strip(', \n').split(',')] for key, value in values.items()
                       if re.match(r'[-+.\d]', value)}
            if name == 'pair':
                self.pairs.append(Pair(values, numbers))
            elif name == 'body':
                assert not any(numbers['inertia'][3:]), 'moments about the axes of links only'
                self.bodies[int(numbers['link'][0])] = (numbers['mass'][0], numbers.get('centre', [0.0] * 3), numbers['inertia'])
            elif name == 'gravity':
                self.gravity = numbers['acceleration']
            elif name == 'point':
                self.points[values['name'].strip("'")] = (int(numbers['link'][0]), numbers['position'])
            elif name == 'load' and values['kind'] == "'torque'":
                self.torques[int(numbers['link'][0])] = numbers['torque']
            elif name == 'load':
                self.springs.append(numbers)
        self.position = [columns[f'q{pair.coordinate}'] for pair in self.pairs]
        self.rate = [columns[f'dq{pair.coordinate}'] for pair in self.pairs]
        self.acceleration = [columns[f'ddq{pair.coordinate}'] for pair in self.pairs]
        self.find_tree()

    def find_tree(self):
        """Sort the pairs into those of a spanning tree, parents first, and those that close chains."""
        known, rest = {1}, list(range(len(self.pairs)))
        self.tree = []
        while True:
            found = next((k for k in rest if self.pairs[k].reference in known and self.pairs[k].moving not in known), None)
            if found is None:
                break
            self.tree.append(found)
            known.add(self.pairs[found].moving)
            rest.remove(found)
        self.closing = [self.pairs[k] for k in rest]

    def closing_points(self):
        """Points that meet where chains are closed, two on the axis of each pair, or one where the chain moves in a plane: link, point,
        link, point."""
        return [(pair.reference, [p + along * a for p, a in zip(pair.point, pair.axis)],
                 pair.moving, [p + along * a for p, a in zip(pair.moving_point, pair.axis)])
                for pair in self.closing for along in range(1 if self.in_plane(pair) else 2)]

    def in_plane(self, closing):
        """Whether the axes of the chain that a pair closes are those of a motion in a plane, at its start and so for ever."""
        way = {self.pairs[k].moving: k for k in self.tree}
        ways = []
        for link in (closing.reference, closing.moving):
            ways.append(set())
            while link != 1:
                ways[-1].add(way[link])
                link = self.pairs[way[link]].reference
        chain = [closing, *(self.pairs[k] for k in ways[0] ^ ways[1])]
        # the systems of the links are parallel at home, where axes stay parallel while they turn about each other
        normal = next(pair.axis for pair in chain if pair.turns)
        along = [abs(sum(a * b for a, b in zip(pair.axis, normal))) for pair in chain]
        return all(abs(cosine - pair.turns) < 1e-9 for pair, cosine in zip(chain, along))

    @property
    def planar(self):
        """Whether all links move in planes across z."""
        return all(pair.turns and pair.axis[:2] == [0.0, 0.0] for pair in self.pairs)

    def forces(self, position=None):
        """Torques of loads on the coordinates of links that turn on the frame, by pair, at the start unless positions are given."""
        position = self.position if position is None else position
        forces = self.torques_of_pairs()
        for k, pair in enumerate(self.pairs):
            if pair.reference != 1 or k not in self.tree:
                continue
            for spring in self.springs:
                if spring['links'] != [1.0, pair.moving]:
                    continue
                c, s = math.cos(position[k]), math.sin(position[k])
                x, y = (spring['second_position'][i] - pair.moving_point[i] for i in (0, 1))
                arm = [c * x - s * y, s * x + c * y]
                line = [spring['position'][i] - pair.point[i] - arm[i] for i in (0, 1)]
                length = math.hypot(*line)
                tension = spring['stiffness'][0] * (length - spring['free_length'][0]) / length
                forces[k] += tension * (arm[0] * line[1] - arm[1] * line[0])
        return forces

    def torques_of_pairs(self):
        """Constant torques of loads on the coordinates of links that turn on the frame, by pair."""
        forces = [0.0] * len(self.pairs)
        for k in self.tree:
            pair = self.pairs[k]
            if pair.reference == 1:
                forces[k] += sum(a * b for a, b in zip(self.torques.get(pair.moving, [0.0] * 3), pair.axis))
        return forces

    def error(self, accelerations):
        """Largest difference of the accelerations of the tree's coordinates over the largest one."""
        largest = max(abs(a) for a in self.acceleration)
        return max(abs(a - self.acceleration[k]) for a, k in zip(accelerations, self.tree)) / largest

    def places(self, position=None, rate=None):
        """{link: (rotation, origin, angular velocity, velocity of the origin)} in the frame, by coordinates and rates of the pairs."""
        position, rate = position or self.position, rate or self.rate
        found = {1: (np.eye(3), np.zeros(3), np.zeros(3), np.zeros(3))}
        for k in self.tree:
            pair = self.pairs[k]
            turn, origin, spin, velocity = found[pair.reference]
            axis, arm = turn @ pair.axis, turn @ pair.point
            here, speed = origin + arm, velocity + np.cross(spin, arm)
            if pair.turns:
                turn, spin = turn @ rotation(pair.axis, position[k]), spin + rate[k] * axis
            else:
                here = here + position[k] * axis
                speed = velocity + np.cross(spin, here - origin) + rate[k] * axis
            back = turn @ pair.moving_point
            found[pair.moving] = turn, here - back, spin, speed - np.cross(spin, back)
        return found

    def values(self, columns, places):
        """Coordinates qN, and components NAME.x of points, by the places of links; angles within half a turn."""
        found = []
        for column in columns:
            if column[0] == 'q':
                pair = next(pair for pair in self.pairs if pair.coordinate == int(column[1:]))
                (turn, origin), (turned, moved) = (places[link][:2] for link in (pair.reference, pair.moving))
                if pair.turns:
                    found.append(angle(pair.axis, turn.T @ turned))
                else:
                    start, end = origin + turn @ pair.point, moved + turned @ pair.moving_point
                    found.append((end - start) @ (turn @ pair.axis))
            else:
                name, component = column.split('.')
                link, point = self.points[name]
                found.append((places[link][1] + places[link][0] @ point)['xyz'.index(component)])
        return found


def rotation(axis, turn):
    """The matrix of a turn about a unit vector, by Rodrigues' formula."""
    x, y, z = axis
    cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    return np.eye(3) + math.sin(turn) * cross + (1 - math.cos(turn)) * cross @ cross


def angle(axis, matrix):
    """The angle of a turn about a unit vector, within half a turn."""
    across = np.array([matrix[2, 1] - matrix[1, 2], matrix[0, 2] - matrix[2, 0], matrix[1, 0] - matrix[0, 1]])
    return math.atan2(across @ axis / 2, (np.trace(matrix) - 1) / 2)


def output_of(*words):
    return subprocess.run([str(word) for word in words], capture_output=True, text=True, check=True).stdout


def first_row(mech9d, path, folder):
    """{name: value} of the results of a data file at its start."""
    table = os.path.join(folder, 'start.dat')
    output_of(mech9d, path, '--set', 'time.end=1e-9', '--set', 'time.intervals=1', '--table', table, '--quiet')
    with open(table, encoding='utf-8') as file:
        names, row = [line.split() for line in file if not line.startswith('#')][:2]
    return dict(zip(names, map(float, row)))
