"""Closed chains in numpy, worked out apart from the program: many mechanisms of one structure at once.

A mechanism stands at home where every coordinate is zero and all link systems coincide, so that a pair's pose is
exp(twist q). Lengths are divided by the size of the mechanism. Arrays: B mechanisms, M pairs, L loops.
"""
import numpy as np


class Loops:
    """links (M, 2): reference and moving link of each pair; point, axis (B, M, 3); turns, slides (B, M): how far a pair
    turns and slides for each unit of its coordinate; inputs: indices of independent coordinates; rates (B, inputs)."""

    def __init__(self, links, point, axis, turns, slides, inputs, rates):
        self.links, self.inputs, self.rates = np.asarray(links), list(inputs), rates
        self.point, self.turns, self.slides = point, turns, slides
        self.axis = axis / np.linalg.norm(axis, axis=-1, keepdims=True)
        self.loops = fundamental_loops(self.links)

    def take(self, members):
        """The same for some of the mechanisms."""
        other = object.__new__(Loops)
        other.links, other.inputs, other.loops = self.links, self.inputs, self.loops
        for name in ('point', 'axis', 'turns', 'slides', 'rates'):
            setattr(other, name, getattr(self, name)[members])
        return other

    def around(self, q):
        """Pose (R, p) of each loop gone round once, and the twists (B, L, 6, M) of its coordinates, at q (B, M)."""
        b, m = q.shape
        rotation, shift, twists = [], [], np.zeros((b, len(self.loops), 6, m))
        for i, loop in enumerate(self.loops):
            r, p = np.broadcast_to(np.eye(3), (b, 3, 3)), np.zeros((b, 3))
            for k, sign in loop:
                axis = np.einsum('bij,bj->bi', r, self.axis[:, k])
                point = np.einsum('bij,bj->bi', r, self.point[:, k]) + p
                twists[:, i, :3, k] += sign * self.turns[:, k, None] * axis
                twists[:, i, 3:, k] += sign * (self.turns[:, k, None] * np.cross(point, axis) + self.slides[:, k, None] * axis)
                step = turned(self.axis[:, k], sign * self.turns[:, k] * q[:, k])
                along = (sign * self.slides[:, k] * q[:, k])[:, None] * self.axis[:, k]
                move = self.point[:, k] - np.einsum('bij,bj->bi', step, self.point[:, k]) + along
                p = np.einsum('bij,bj->bi', r, move) + p
                r = r @ step
            rotation.append(r)
            shift.append(p)
        return np.stack(rotation, 1), np.stack(shift, 1), twists

    def gap(self, q):
        """The largest gap of a loop: the largest entry of R - 1 and of p."""
        rotation, shift, _ = self.around(q)
        return np.maximum(np.max(np.abs(rotation - np.eye(3)), axis=(1, 2, 3)), np.max(np.abs(shift), axis=(1, 2)))

    def equations(self, z):
        """Closures and drives at z = (q, t), and their Jacobian: closures twist by twist, then q_i - rate_i t = 0."""
        b, m = z.shape[0], z.shape[1] - 1
        rotation, shift, twists = self.around(z[:, :m])
        skew = np.stack([rotation[..., 2, 1] - rotation[..., 1, 2], rotation[..., 0, 2] - rotation[..., 2, 0],
                         rotation[..., 1, 0] - rotation[..., 0, 1]], -1) / 2
        drive = z[:, self.inputs] - self.rates * z[:, m:]
        value = np.concatenate([np.concatenate([skew, shift], -1).reshape(b, -1), drive], 1)
        n = 6 * len(self.loops)
        jacobian = np.zeros((b, n + len(self.inputs), m + 1))
        jacobian[:, :n, :m] = twists.reshape(b, n, m)
        for row, k in enumerate(self.inputs):
            jacobian[:, n + row, k] = 1.0
        jacobian[:, n:, m] = -self.rates
        return value, jacobian

    def at_time(self, z, iterations=8):
        """Newton's method from z to a closed position with its t kept; the least singular value beside it."""
        z = z.copy()
        for _ in range(iterations):
            value, jacobian = self.equations(z)
            u, s, vt = np.linalg.svd(jacobian[:, :, :-1], full_matrices=False)
            change = np.einsum('bji,bj->bi', vt, np.einsum('bij,bi->bj', u, value) / np.maximum(s, 1e-12))
            z[:, :-1] -= change
        return z, s[:, -1]


def turned(axis, angle):
    """Rotations (B, 3, 3) about unit axes."""
    c, s = np.cos(angle)[:, None, None], np.sin(angle)[:, None, None]
    cross = np.zeros((len(angle), 3, 3))
    cross[:, 0, 1], cross[:, 0, 2], cross[:, 1, 2] = -axis[:, 2], axis[:, 1], -axis[:, 0]
    cross = cross - np.swapaxes(cross, 1, 2)
    return c * np.eye(3) + s * cross + (1 - c) * axis[:, :, None] * axis[:, None, :]


def fundamental_loops(links):
    """For each pair outside a spanning tree the loop it closes, as (pair, +1 or -1 against the pair's direction)."""
    way = {1: []}      # from link 1
    waiting = list(range(len(links)))
    closing = []
    while waiting:
        rest = []
        for k in waiting:
            reference, moving = links[k]
            if reference in way and moving in way:
                closing.append(k)
            elif reference in way:
                way[moving] = way[reference] + [(k, 1)]
            elif moving in way:
                way[reference] = way[moving] + [(k, -1)]
            else:
                rest.append(k)
        if len(rest) == len(waiting):
            raise ValueError('links apart')
        waiting = rest
    loops = []
    for k in closing:
        there, back = way[links[k][0]] + [(k, 1)], way[links[k][1]]
        while there and back and there[0] == back[0]:
            there, back = there[1:], back[1:]
        loops.append(there + [(pair, -sign) for pair, sign in reversed(back)])
    return loops


class Course:
    """The motion of one mechanism from home: positions z, unit tangents and arc lengths along its curve, and how it
    ends: 'end' (t = 1 is reached), 'dead' (t turns back at `limit`), 'special' (branches meet) or 'unknown'."""

    def __init__(self, z, tangent):
        self.z, self.tangent, self.length = [z], [tangent], [0.0]
        self.ending, self.limit, self.least = '', None, 1.0

    def guess(self, t):
        """The position at time t by the cubic between its neighbours."""
        times = np.array([z[-1] for z in self.z])
        i = max(1, min(int(np.searchsorted(times, t)), len(times) - 1))
        h = self.length[i] - self.length[i - 1]
        low, high = 0.0, 1.0
        for _ in range(50):
            x = (low + high) / 2
            z = ((1 + 2 * x) * (1 - x) ** 2 * self.z[i - 1] + x * x * (3 - 2 * x) * self.z[i]
                 + h * x * (1 - x) * ((1 - x) * self.tangent[i - 1] - x * self.tangent[i]))
            low, high = (x, high) if z[-1] < t else (low, x)
        z[-1] = t
        return z


def on_curve(loops, z, iterations=8):
    """Back onto the curve across its tangent: position, unit tangent, correction, error, next least singular value."""
    start = z.copy()
    z = z.copy()
    for _ in range(iterations):
        value, jacobian = loops.equations(z)
        u, s, vt = np.linalg.svd(jacobian, full_matrices=True)
        n = vt.shape[1] - 1                                # the last direction is that of the curve
        change = np.einsum('bji,bj->bi', vt[:, :n], np.einsum('bij,bi->bj', u[:, :, :n], value) / np.maximum(s[:, :n], 1e-9))
        z -= change
        if np.all(np.abs(change) < 1e-13):
            break
    value, jacobian = loops.equations(z)
    u, s, vt = np.linalg.svd(jacobian, full_matrices=True)
    return z, vt[:, -1], np.linalg.norm(z - start, axis=1), np.max(np.abs(value), axis=1), s[:, vt.shape[1] - 2]


def courses(loops, longest=0.08, most_steps=3000):
    """Continuation by arc length from home, in which dead points are turning points of t as any other place."""
    b, m = loops.point.shape[:2]
    z, tangent, _, error, least = on_curve(loops, np.zeros((b, m + 1)))
    tangent = tangent * np.where(tangent[:, -1:] < 0, -1.0, 1.0)
    found = [Course(z[i], tangent[i]) for i in range(b)]
    step = np.full(b, longest / 8)
    for i in np.flatnonzero((error > 1e-11) | (least < 1e-6)):
        found[i].ending = 'special'
    for _ in range(most_steps):
        active = np.array([i for i in range(b) if not found[i].ending], dtype=int)
        if not len(active):
            break
        some = loops.take(active)
        trial, along, correction, error, least = on_curve(some, z[active] + step[active, None] * tangent[active])
        cosine = np.sum(along * tangent[active], axis=1)
        along = along * np.sign(cosine)[:, None]
        good = (error < 1e-11) & (correction < 0.1 * step[active]) & (np.abs(cosine) > np.cos(0.15))
        for j, i in enumerate(active):
            course = found[i]
            if not good[j]:
                step[i] /= 2
                if step[i] < 1e-7:
                    course.ending = 'special'
                continue
            course.least = min(course.least, least[j])
            if along[j, -1] < 0:
                course.ending = 'dead'
                course.limit = turning_point(loops.take([i]), z[i], tangent[i], step[i])
            course.z.append(trial[j])
            course.tangent.append(along[j])
            course.length.append(course.length[-1] + step[i])
            z[i], tangent[i] = trial[j], along[j]
            if not course.ending and trial[j, -1] > 1.0:
                course.ending = 'end'
            if least[j] < 1e-4:
                course.ending = 'special'
            step[i] = min(1.3 * step[i], longest)
    for course in found:
        course.ending = course.ending or 'unknown'
    return found


def turning_point(loops, z, tangent, step):
    """The t at which it turns back, between z and a step farther: bisection and secant on its slope."""
    low, high, slope_low = 0.0, step, tangent[-1]
    slope_high = None
    for count in range(40):
        x = (low + high) / 2 if slope_high is None or count % 3 == 2 else low + (high - low) * slope_low / (slope_low - slope_high)
        there, along, _, _, _ = on_curve(loops, (z + x * tangent)[None])
        slope = along[0, -1] * np.sign(along[0] @ tangent)
        if slope >= 0:
            low, slope_low = x, slope
        else:
            high, slope_high = x, slope
        if abs(slope) < 1e-12:
            break
    return there[0, -1]
