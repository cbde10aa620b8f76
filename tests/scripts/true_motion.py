"""The motion of a driven mechanism in extended precision (80-bit numbers, 19 digits), by a way of its own.

Coordinates are series in time (value, rate, half the acceleration) at each of many times. Poses are composed along a
tree of links; the pairs that are left over close the loops: all twelve numbers of both poses must agree. Newton's
iteration with the Jacobian of differences, held constant over the orders, makes value, rate and acceleration
right together. Starting values choose the branch; nothing else is taken from the program.

Pairs: revolute, prismatic, helical; drives: polynomial, harmonic.
"""
import numpy as np

REAL = np.longdouble
ORDERS = 3


def vector(values):
    return np.array([REAL(value) for value in values])


def unit(values):
    return values / np.sqrt((values * values).sum())


def default_zero(axis):
    """The first of the x, y, z axes that makes at least 45 degrees with the axis."""
    for i in range(3):
        if abs(axis[i]) <= np.sqrt(0.5):
            return vector(np.eye(3)[i])
    raise ValueError('no axis')


def frame(point, axis, zero):
    """Turn (columns x, y, z) and origin of a pair's system in its link."""
    z = unit(axis)
    x = unit(zero - z * (zero * z).sum())
    return np.stack([x, np.cross(z, x), z], axis=1), point


class Pair:
    def __init__(self, items):
        self.coordinate = items['coordinate'][0] - 1
        self.links = tuple(items['links'])
        self.kind = items['kind'][0]
        self.pitch = REAL(items.get('pitch', [0])[0])
        point = vector(items.get('point', [0, 0, 0]))
        axis = vector(items['axis'])
        zero = vector(items['zero']) if 'zero' in items else default_zero(unit(axis))
        moving_axis = vector(items['moving_axis']) if 'moving_axis' in items else axis
        if 'moving_zero' in items:
            moving_zero = vector(items['moving_zero'])
        else:
            moving_zero = default_zero(unit(moving_axis)) if 'moving_axis' in items else zero
        self.fixed = frame(point, axis, zero)
        self.moving = frame(vector(items.get('moving_point', point)), moving_axis, moving_zero)

    def pose(self, q):
        """Series of the pose of the moving link in the reference link, for series q (orders, times)."""
        count = q.shape[1]
        turn = np.zeros((ORDERS, count, 3, 3), REAL)
        shift = np.zeros((ORDERS, count, 3), REAL)
        if self.kind == 'prismatic':
            turn[0] = np.eye(3)
            shift[:, :, 2] = q
        else:
            c, s = np.cos(q[0]), np.sin(q[0])
            cosine = np.stack([c, -s * q[1], -s * q[2] - c * q[1] ** 2 / 2])
            sine = np.stack([s, c * q[1], c * q[2] - s * q[1] ** 2 / 2])
            turn[:, :, 0, 0], turn[:, :, 0, 1] = cosine, -sine
            turn[:, :, 1, 0], turn[:, :, 1, 1] = sine, cosine
            turn[0, :, 2, 2] = 1
            shift[:, :, 2] = q * self.pitch / (2 * REAL(np.pi)) if self.pitch else 0
        (f, f_origin), (g, g_origin) = self.fixed, self.moving
        turn = f @ turn @ g.T
        shift = shift @ f.T
        shift[0] += f_origin
        return turn, shift - turn @ g_origin


def product(a, b):
    """Series of a product, by Leibniz' rule; `a` and `b` are series of matrices or a matrix and a vector."""
    multiply = (lambda x, y: x @ y) if a.ndim == b.ndim else (lambda x, y: (x @ y[..., None])[..., 0])
    return np.stack([sum(multiply(a[i], b[k - i]) for i in range(k + 1)) for k in range(ORDERS)])


def compose(first, second):
    return product(first[0], second[0]), product(first[0], second[1]) + first[1]


def inverse(pose):
    turn = np.swapaxes(pose[0], -1, -2)
    return turn, -product(turn, pose[1])


class Mechanism:
    """The parts of a data file (as data_file.parse gives it) that decide the motion."""

    def __init__(self, groups):
        self.pairs = sorted((Pair(items) for group, items in groups if group == 'pair'), key=lambda p: p.coordinate)
        self.drives = {items['coordinate'][0] - 1: items for group, items in groups if group == 'drive'}
        self.unit = REAL(1)
        for group, items in groups:
            if group == 'mechanism' and items.get('angle_unit', ['rad'])[0] == 'deg':
                self.unit = REAL(np.pi) / 180    # the program's own factor is right to its last digit
        self.dependent = [p.coordinate for p in self.pairs if p.coordinate not in self.drives]
        self.tree, self.loops = [], []
        known, left = {1}, list(self.pairs)
        while left:
            pair = next(p for p in left if set(p.links) & known)
            left.remove(pair)
            (self.loops if set(pair.links) <= known else self.tree).append(pair)
            known |= set(pair.links)

    def driven(self, t):
        """Series of all coordinates, the dependent ones zero."""
        q = np.zeros((ORDERS, len(self.pairs), len(t)), REAL)
        t = t.astype(REAL)
        for k, items in self.drives.items():
            scale = self.unit if self.pairs[k].kind != 'prismatic' else REAL(1)
            if items['kind'][0] == 'polynomial':
                for power, c in enumerate(items['coefficients']):
                    c = REAL(c) * scale
                    q[0, k] += c * t ** power
                    if power > 0:
                        q[1, k] += c * power * t ** (power - 1)
                    if power > 1:
                        q[2, k] += c * power * (power - 1) / 2 * t ** (power - 2)
            else:
                w = REAL(items['angular_frequency'][0])
                a = w * t + REAL(items.get('phase', [0])[0])
                amplitude = REAL(items['amplitude'][0]) * scale
                q[0, k] = REAL(items.get('mean', [0])[0]) * scale + amplitude * np.sin(a)
                q[1, k] = amplitude * w * np.cos(a)
                q[2, k] = -amplitude * w * w * np.sin(a) / 2
        return q

    def poses(self, q):
        """Series of the poses of all links in the frame, along the tree."""
        count = q.shape[2]
        home = np.zeros((ORDERS, count, 3, 3), REAL)
        home[0] = np.eye(3)
        pose = {1: (home, np.zeros((ORDERS, count, 3), REAL))}
        for pair in self.tree:
            a, b = pair.links
            motion = pair.pose(q[:, pair.coordinate])
            if a in pose:
                pose[b] = compose(pose[a], motion)
            else:
                pose[a] = compose(pose[b], inverse(motion))
        return pose

    def gaps(self, q):
        """The gaps of the loops: (orders, times, 12 loops)."""
        count, pose = q.shape[2], self.poses(q)
        open_by = []
        for pair in self.loops:
            turn, shift = compose(pose[pair.links[0]], pair.pose(q[:, pair.coordinate]))
            other = pose[pair.links[1]]
            open_by += [(turn - other[0]).reshape(ORDERS, count, 9), shift - other[1]]
        return np.concatenate(open_by, axis=2)

    def follow(self, t, near):
        """Coordinates, rates and accelerations (3, coordinates, times) at the times, where they are near those
        given (coordinates, times); and what the loops are open by at the end."""
        q = self.driven(t)
        q[0, self.dependent] = near[self.dependent]
        step = REAL(1e-9)     # the differences are right to 9 digits, so that each turn wins about 9
        jacobian = np.zeros((len(t), self.gaps(q).shape[2], len(self.dependent)))
        for i, k in enumerate(self.dependent):
            moved = q.copy()
            moved[0, k] += step
            back = q.copy()
            back[0, k] -= step
            jacobian[:, :, i] = ((self.gaps(moved)[0] - self.gaps(back)[0]) / (2 * step)).astype(float)
        solve = np.linalg.pinv(jacobian).astype(REAL)
        for _ in range(8):
            gaps = self.gaps(q)
            q[:, self.dependent] -= np.moveaxis((solve @ gaps[..., None])[..., 0], 2, 1)
        gaps = self.gaps(q)
        q[2] *= 2
        return q, np.abs(gaps).max()
