"""Closed chains with ball joints, of which several tests make data files."""
import math

import numpy as np

# a crank, a rod between a ball joint and a universal joint, and a slide; `frame` is the frame of the ball
SLIDER = """&structure cq=1 /
&pair coordinate=1, links=1,2, kind='revolute', point=0,0,0, axis={crank}, zero=0,0,1 /
&pair coordinates=2,3,4, links=2,3, kind='spherical', point=0,0,0.3, moving_point=0,0,0{frame} /
&pair coordinates=5,6, links=3,4, kind='universal', point=1.0,0,0, axis=0,0,1, moving_axis=0,1,0, moving_point=0,0,0 /
&pair coordinate=7, links=1,4, kind='prismatic', point={guide}, axis=1,0,0, moving_point=0,0,0 /
&initial coordinate=7, position=1 /
&point name='P', link=3, position=0.5,0.1,0.1 /
"""
DRIVE = "&drive coordinate=1, kind='polynomial', coefficients={start}, 1 /\n"


def direction(random):
    vector = random.normal(size=3)
    return vector / np.linalg.norm(vector)


def turned(axis, angle, vector):
    """Rodrigues: a vector turned about a unit axis by each of several angles."""
    angle = np.atleast_1d(angle)[:, None]
    return vector * np.cos(angle) + np.cross(axis, vector) * np.sin(angle) + axis * (axis @ vector) * (1 - np.cos(angle))


def triple(vector):
    return ','.join(f'{float(v)!r}' for v in vector)


class Rssr:
    """A crank and a rocker in any position in space, with a rod between two balls whose frames are at random."""

    def __init__(self, seed):
        random = np.random.default_rng(seed)
        while True:
            self.axes = [direction(random), direction(random)]
            self.origins = [np.zeros(3), random.uniform(-0.6, 0.6, 3)]
            self.arms = [self.arm(random, self.axes[0], 0.1, 0.3), self.arm(random, self.axes[1], 0.3, 0.7)]
            crank = self.ball(0, np.zeros(1))[0]
            rocker = self.ball(1, random.uniform(-3, 3, 1))[0]
            self.length = float(np.linalg.norm(crank - rocker))
            if self.length < 0.2:
                continue
            margin, _, _ = self.solve(np.linspace(0, 2 * math.pi, 361))
            if np.min(margin) > 0.1:
                break
        self.in_rod = self.length * direction(random)
        self.frames = [(direction(random), direction(random)) for _ in range(4)]
        self.point = random.uniform(-0.2, 0.2, 3)

    @staticmethod
    def arm(random, axis, low, high):
        arm = direction(random)
        return (arm - axis * (axis @ arm)) * random.uniform(low, high) + axis * random.uniform(-0.1, 0.1)

    def ball(self, link, angle):
        return self.origins[link] + turned(self.axes[link], angle, self.arms[link])

    def solve(self, theta):
        """How far from a dead point, 0 to 1, and the rocker's angles on both branches."""
        a, e = self.arms[1], self.axes[1]
        across = a - e * (e @ a)
        start = self.origins[1] + e * (e @ a) - self.ball(0, theta)
        # |start + across cos + (e x across) sin|^2 = length^2
        cosine, sine = 2 * start @ across, 2 * start @ np.cross(e, across)
        rest = self.length ** 2 - np.sum(start ** 2, axis=1) - across @ across
        size = np.hypot(cosine, sine)
        share = np.clip(rest / size, -1, 1)
        middle = np.unwrap(np.arctan2(sine, cosine))
        return 1 - np.abs(rest / size), middle + np.arccos(share), middle - np.arccos(share)

    def pairs(self, with_frames=True):
        text = '&structure cq=1 /\n'
        text += f"&pair coordinate=1, links=1,2, kind='revolute', axis={triple(self.axes[0])}, point=0,0,0 /\n"
        text += f"&pair coordinate=8, links=1,4, kind='revolute', axis={triple(self.axes[1])}, point={triple(self.origins[1])}, " \
            'moving_point=0,0,0 /\n'
        for i, (numbers, links, point, moving) in enumerate((('2,3,4', '2,3', self.arms[0], np.zeros(3)),
                                                              ('5,6,7', '3,4', self.in_rod, self.arms[1]))):
            frames = [] if not with_frames else [f'{name}={triple(vector)}' for name, vector in zip(
                ('axis', 'zero', 'moving_axis', 'moving_zero'), (*self.frames[2 * i], *self.frames[2 * i + 1]))]
            text += f"&pair coordinates={numbers}, links={links}, kind='spherical', " + ', '.join(
                [f'point={triple(point)}', f'moving_point={triple(moving)}', *frames]) + ' /\n'
        return text
