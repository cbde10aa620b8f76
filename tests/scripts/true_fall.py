"""The free motion of a mechanism of revolute pairs in extended precision (80-bit numbers), by equations of its own.

usage: true_fall.py MECH9D FILE END STEPS EVERY POINT ... > tests/reference/NAME.csv
    END      of the motion [s]; STEPS of one size lead there
    EVERY    so many steps stands a row: the time, positions and velocities of the points [m, m/s]

Each body has its own place, turn, velocity and spin, and Newton's and Euler's equations; multipliers hold the pairs together. Equations
that others imply are left out by pivots at the start. Gragg's method with extrapolation integrates; nothing is projected, so that
gaps and energy tell the error, which the last comment of the file holds. Only the branch of the start is taken from the program.
"""
import sys

import numpy as np

import data_file
import true_motion
from mech9_cases import table_of, text_of
from true_motion import REAL, unit, vector

# Parts of a step in Gragg's method.
PARTS = tuple(range(2, 22, 2))


def cross(a, b):
    """The vector product, faster than numpy's with these numbers."""
    return np.stack([a[..., 1] * b[..., 2] - a[..., 2] * b[..., 1], a[..., 2] * b[..., 0] - a[..., 0] * b[..., 2],
                     a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0]], axis=-1)


def turned(turns, vectors):
    return (turns * vectors[..., None, :]).sum(axis=-1)


class Fall:
    """Bodies, pairs and gravity of a data file, whose links are parallel at home."""

    def __init__(self, mech9d, path):
        groups = data_file.parse(text_of(path))
        bodies = sorted((items for group, items in groups if group == 'body'), key=lambda items: items['link'])
        pairs = [items for group, items in groups if group == 'pair']
        assert [items['link'][0] for items in bodies] == list(range(2, 2 + len(bodies))), 'every link but the frame is a body'
        self.gravity = next(vector(items['acceleration']) for group, items in groups if group == 'gravity')
        self.points = {items['name'][0]: (items['link'][0] - 2, vector(items['position'])) for group, items in groups if group == 'point'}
        self.mass = vector([items['mass'][0] for items in bodies])
        self.centre = np.stack([vector(items['centre']) for items in bodies])
        assert not any(any(items['inertia'][3:]) for items in bodies), 'moments about the axes of links alone'
        self.moments = np.stack([vector(items['inertia'][:3]) for items in bodies])
        # the frame is the last one of the bodies, and does not move
        self.n = len(bodies)
        self.first, self.second = ((np.array([items['links'][k] for items in pairs]) - 2) % (self.n + 1) for k in (0, 1))
        home = np.concatenate([self.centre, np.zeros((1, 3), REAL)])
        points = np.stack([vector(items['point']) for items in pairs])
        self.arm_first, self.arm_second = points - home[self.first], points - home[self.second]
        self.axis = np.stack([unit(vector(items['axis'])) for items in pairs])
        across = np.stack([unit(cross(axis, true_motion.default_zero(axis))) for axis in self.axis])
        # directions fixed in the first link: two across the axis, and the axis
        self.directions = np.stack([across, cross(self.axis, across), self.axis], axis=1)
        self.rows = slice(None)
        self.find_start(mech9d, path, groups)
        self.leave_out()

    def find_start(self, mech9d, path, groups):
        """Places and turns of the bodies at the start, at rest."""
        table = table_of(mech9d, path, '--set', 'time.end=1e-6', '--set', 'time.intervals=1')
        independent = next(items['cq'] for group, items in groups if group == 'structure')
        held = [(group, items) for group, items in groups if group != 'initial']
        for group, items in groups:
            if group == 'initial' and items['coordinate'][0] in independent:
                held.append(('drive', {'coordinate': items['coordinate'], 'kind': ['polynomial'], 'coefficients': items['position']}))
        mechanism = true_motion.Mechanism(held)
        near = np.array([table[f'q{k + 1}'][:1] for k in range(len(mechanism.pairs))])
        q, gap = mechanism.follow(np.zeros(1), near)
        assert gap < 1e-17, 'the start is closed'
        poses = mechanism.poses(q)
        turn = np.stack([poses[link][0][0, 0] for link in range(2, self.n + 2)])
        origin = np.stack([poses[link][1][0, 0] for link in range(2, self.n + 2)])
        self.start = (origin + turned(turn, self.centre), turn, np.zeros((self.n, 3), REAL), np.zeros((self.n, 3), REAL))

    def with_frame(self, x, turn, v, w):
        zero = np.zeros((1, 3), REAL)
        still = np.eye(3).astype(REAL)[None]
        return np.concatenate([x, zero]), np.concatenate([turn, still]), np.concatenate([v, zero]), np.concatenate([w, zero])

    def constraints(self, state):
        """Gaps of the pairs, their Jacobian by velocities and spins, and their second derivative without accelerations."""
        x, turn, v, w = self.with_frame(*state)
        a, b = self.first, self.second
        r_a, r_b = turned(turn[a], self.arm_first), turned(turn[b], self.arm_second)
        w_a, w_b = w[a], w[b]
        gap = x[a] + r_a - x[b] - r_b
        rate = v[a] + cross(w_a, r_a) - v[b] - cross(w_b, r_b)
        bend = cross(w_a, cross(w_a, r_a)) - cross(w_b, cross(w_b, r_b))
        jacobian = np.zeros((len(a), 5, self.n + 1, 6), REAL)
        gaps, second = np.zeros((len(a), 5), REAL), np.zeros((len(a), 5), REAL)
        pair = np.arange(len(a))
        u = turned(turn[b], self.axis)
        u_bend = cross(w_b, cross(w_b, u))
        for k in range(3):
            d = turned(turn[a], self.directions[:, k])
            d_rate = cross(w_a, d)
            d_bend = cross(w_a, d_rate)
            gaps[:, k] = (d * gap).sum(-1)
            jacobian[pair, k, a, :3] += d
            jacobian[pair, k, b, :3] -= d
            jacobian[pair, k, a, 3:] += cross(r_a, d) + cross(d, gap)
            jacobian[pair, k, b, 3:] -= cross(r_b, d)
            second[:, k] = (d * bend + 2 * d_rate * rate + d_bend * gap).sum(-1)
            if k < 2:
                gaps[:, 3 + k] = (d * u).sum(-1)
                jacobian[pair, 3 + k, a, 3:] += cross(d, u)
                jacobian[pair, 3 + k, b, 3:] -= cross(d, u)
                second[:, 3 + k] = (d_bend * u + 2 * d_rate * cross(w_b, u) + d * u_bend).sum(-1)
        return gaps.reshape(-1), jacobian[:, :, :self.n].reshape(5 * len(a), -1)[self.rows], second.reshape(-1)[self.rows]

    def leave_out(self):
        """Keep equations that are independent at the start."""
        matrix = self.constraints(self.start)[1].astype(float)
        rows, left, kept = np.arange(len(matrix)), matrix.copy(), []
        for _ in rows:
            sizes = np.linalg.norm(left, axis=1)
            k = int(np.argmax(sizes))
            if sizes[k] < 1e-8:
                break
            kept.append(k)
            direction = left[k] / sizes[k]
            left -= np.outer(left @ direction, direction)
            left[kept] = 0
        self.rows = np.sort(kept)
        self.freedoms = 6 * self.n - len(kept)

    def accelerations(self, state):
        _, turn, _, w = state
        _, jacobian, second = self.constraints(state)
        inertia = (turn * self.moments[:, None, :]) @ np.swapaxes(turn, 1, 2)
        inverse = (turn / self.moments[:, None, :]) @ np.swapaxes(turn, 1, 2)
        force = np.concatenate([self.mass[:, None] * self.gravity, -cross(w, turned(inertia, w))], axis=1)

        def divided(loads):
            loads = loads.reshape(self.n, 6)
            return np.concatenate([loads[:, :3] / self.mass[:, None], turned(inverse, loads[:, 3:])], axis=1).reshape(-1)

        rough = jacobian.astype(float).reshape(-1, self.n, 6)
        rough = np.concatenate([rough[..., :3] / self.mass.astype(float)[:, None],
                                np.einsum('kij,rkj->rki', inverse.astype(float), rough[..., 3:])], axis=-1).reshape(len(jacobian), -1)
        solve = np.linalg.inv(rough @ jacobian.astype(float).T)
        wanted = jacobian @ divided(force) + second
        forces = np.zeros(len(jacobian), REAL)
        # each turn wins some eight digits
        for _ in range(4):
            forces += solve @ (wanted - jacobian @ divided(jacobian.T @ forces))
        found = divided(force.reshape(-1) - jacobian.T @ forces).reshape(self.n, 6)
        return found[:, :3], found[:, 3:]

    def rate(self, y):
        state = self.unpacked(y)
        _, turn, v, w = state
        a, alpha = self.accelerations(state)
        # the columns of the turn go round with the spin
        turning = cross(w[:, None, :], np.swapaxes(turn, 1, 2)).swapaxes(1, 2)
        return self.packed(v, turning, a, alpha)

    def packed(self, x, turn, v, w):
        return np.concatenate([x.reshape(-1), turn.reshape(-1), v.reshape(-1), w.reshape(-1)])

    def unpacked(self, y):
        n = self.n
        return y[:3 * n].reshape(n, 3), y[3 * n:12 * n].reshape(n, 3, 3), y[12 * n:15 * n].reshape(n, 3), y[15 * n:].reshape(n, 3)

    def energy(self, y):
        x, turn, v, w = self.unpacked(y)
        spin = turned(np.swapaxes(turn, 1, 2), w)
        return (self.mass * ((v * v).sum(-1) / 2 - x @ self.gravity)).sum() + (self.moments * spin * spin).sum() / 2

    def row(self, y):
        """Positions of the points, then their velocities."""
        x, turn, v, w = self.unpacked(y)
        places, speeds = [], []
        for body, position in self.points.values():
            arm = turn[body] @ (position - self.centre[body])
            places.append(x[body] + arm)
            speeds.append(v[body] + cross(w[body], arm))
        return np.concatenate(places + speeds)


def step(rate, y, size):
    """One step of Gragg's method, extrapolated to parts of no length."""
    table, first = [], rate(y)
    for k, parts in enumerate(PARTS):
        h = size / parts
        before, now = y, y + h * first
        for _ in range(parts - 1):
            before, now = now, before + 2 * h * rate(now)
        line = [(now + before + h * rate(now)) / 2]
        for j in range(1, k + 1):
            ratio = (REAL(PARTS[k]) / PARTS[k - j]) ** 2
            line.append(line[j - 1] + (line[j - 1] - table[j - 1]) / (ratio - 1))
        table = line
    return table[-1]


def main():
    mech9d, path, end, steps, every = sys.argv[1], sys.argv[2], REAL(sys.argv[3]), int(sys.argv[4]), int(sys.argv[5])
    fall = Fall(mech9d, path)
    fall.points = {name: fall.points[name] for name in sys.argv[6:]}
    y = fall.packed(*fall.start)
    energy = fall.energy(y)
    names = [f'{name}.{letter}' for letters in (('x', 'y', 'z'), ('vx', 'vy', 'vz')) for name in fall.points for letter in letters]
    print('# written by tests/scripts/true_fall.py: points of a mechanism that falls, by equations of each body with multipliers, 80-bit numbers')
    print('t,' + ','.join(names))
    for k in range(steps + 1):
        if k > 0:
            y = step(fall.rate, y, end / steps)
        if k % every == 0:
            # times are those of results in double precision
            print(repr(float(end * k / steps)), *(np.format_float_positional(value, 19, trim='0') for value in fall.row(y)), sep=',', flush=True)
    gaps = np.abs(fall.constraints(fall.unpacked(y))[0]).max()
    print(f'# {fall.freedoms} freedoms, {steps} steps; at the end the largest gap is {gaps:.1e}, '
          f'the change of energy {fall.energy(y) - energy:.1e} J')


if __name__ == '__main__':
    main()
