"""Forces in the pairs of a mechanism in absolute coordinates, worked out apart from the program.

Poses of links, their velocities and accelerations are series in time along a tree of links (true_motion). Each link must be in
balance, and the wrench of each pair whose coordinate is dependent does the work of the loads on this coordinate. The
wrenches of all pairs are the solution of least norm of these equations by singular values, as one full matrix: forces, and moments over
a length. Their null space tells the components that equilibrium does not determine.

Pairs: revolute, prismatic, helical; loads: force, torque, spring, coordinate.
"""
import numpy as np

from true_motion import Mechanism, Pair, compose, inverse, vector


def cross_matrix(v):
    return np.array([[0, -v[2], v[1]], [v[2], 0, -v[0]], [-v[1], v[0], 0]], float)


def without_dh(groups):
    """The groups with pairs by axes in place of those by Denavit-Hartenberg parameters, T = Rz(theta) Tz(d) Tx(a) Rx(alpha)."""
    unit = np.pi / 180 if any(items.get('angle_unit') == ['deg'] for _, items in groups) else 1.0
    changed = []
    for group, items in groups:
        if 'dh' in items:
            a, alpha, d, theta = (float(v) for v in items['dh'])
            c, s = np.cos(alpha * unit), np.sin(alpha * unit)
            items = {**items, 'axis': [0.0, 0.0, 1.0], 'point': [0.0, 0.0, d], 'zero': [np.cos(theta * unit), np.sin(theta * unit), 0.0],
                     'moving_axis': [0.0, s, c], 'moving_zero': [1.0, 0.0, 0.0], 'moving_point': [-a, 0.0, 0.0]}
        changed.append((group, items))
    return changed


class Forces:
    """The equations of balance of a data file, as data_file.parse gives it; `independent` are numbers from 1."""

    def __init__(self, groups, independent):
        self.unit = Mechanism(without_dh(groups)).unit
        self.pairs = sorted((Pair(items) for group, items in without_dh(groups) if group == 'pair'), key=lambda p: p.coordinate)
        self.independent = [k - 1 for k in independent]
        self.bodies = [items for group, items in groups if group == 'body']
        self.loads = [items for group, items in groups if group == 'load']
        self.gravity = next((np.array(items['acceleration'], float) for group, items in groups if group == 'gravity'), np.zeros(3))
        self.links = max(max(pair.links) for pair in self.pairs)
        ends = [(link, np.asarray(point, float)) for pair in self.pairs
                for link, point in zip(pair.links, (pair.fixed[1], pair.moving[1]))]
        # moments count over the largest distance between two pairs of one link
        self.length = max((np.linalg.norm(a - b) for link, a in ends for other, b in ends if link == other), default=0.0) or 1.0

    def poses(self, q):
        """Series of the pose of each link, for q (3 orders, M): value, rate, half the acceleration."""
        q = np.asarray(q, np.longdouble)[:, :, None]
        known = {1: (np.array([np.eye(3), np.zeros((3, 3)), np.zeros((3, 3))], np.longdouble)[:, None], np.zeros((3, 1, 3), np.longdouble))}
        left = list(self.pairs)
        while left:
            pair = next(p for p in left if set(p.links) & set(known))
            left.remove(pair)
            if set(pair.links) <= set(known):
                continue
            pose = pair.pose(q[:, pair.coordinate])
            if pair.links[0] in known:
                known[pair.links[1]] = compose(known[pair.links[0]], pose)
            else:
                known[pair.links[0]] = compose(known[pair.links[1]], inverse(pose))
        return {link: (turn[:, 0], shift[:, 0]) for link, (turn, shift) in known.items()}

    def required(self, poses):
        """The force that each link requires for inertia and weight, and its moment about the origin of link 1."""
        needed = np.zeros((self.links + 1, 6), np.longdouble)
        for body in self.bodies:
            (a, da, ha), (p, _, hp) = poses[body['link'][0]]
            mass = body.get('mass', [0])[0]
            c = vector(body.get('centre', [0, 0, 0]))
            xx, yy, zz, xy, xz, yz = body.get('inertia', [0] * 6)
            inertia = np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]], float)
            centre, force = p + a @ c, mass * (2 * (hp + ha @ c) - self.gravity)
            spin, turning = axial(da @ a.T), axial(2 * ha @ a.T)
            fixed = a @ inertia @ a.T
            moment = fixed @ turning + np.cross(spin, fixed @ spin) + np.cross(centre, force)
            needed[body['link'][0]] += np.concatenate([force, moment])
        return needed

    def loaded(self, poses, q):
        """The sums of the loads: on each link as `required`, and on each coordinate."""
        on_links, on_coordinates = np.zeros((self.links + 1, 6), np.longdouble), np.zeros(len(self.pairs), np.longdouble)

        def push(link, point, force):
            on_links[link] += np.concatenate([force, np.cross(point, force)])

        def place(link, point):
            (a, da, _), (p, dp, _) = poses[link]
            return p + a @ vector(point), dp + da @ vector(point)

        for load in self.loads:
            kind = load['kind'][0]
            if kind == 'coordinate':
                k = load['coordinate'][0] - 1
                # numbers per unit of angle
                unit = self.unit if self.pairs[k].kind != 'prismatic' else 1
                rest = load.get('rest', [0])[0] * unit
                on_coordinates[k] += (load.get('force', [0])[0] - load.get('stiffness', [0])[0] * (q[0][k] - rest)
                                      - load.get('damping', [0])[0] * q[1][k])
            elif kind == 'spring':
                (one, v_one), (two, v_two) = place(load['links'][0], load.get('position', [0, 0, 0])), place(
                    load['links'][1], load.get('second_position', [0, 0, 0]))
                length = np.sqrt(((two - one) ** 2).sum())
                along = (two - one) / length
                pull = (load.get('stiffness', [0])[0] * (length - load.get('free_length', [0])[0])
                        + load.get('damping', [0])[0] * ((v_two - v_one) * along).sum())
                push(load['links'][0], one, pull * along)
                push(load['links'][1], two, -pull * along)
            else:
                link = load['link'][0]
                turn = poses[link][0][0] if load.get('frame', ['fixed'])[0] == 'link' else np.eye(3)
                push(link, place(link, load.get('position', [0, 0, 0]))[0], turn @ vector(load.get('force', [0, 0, 0])))
                on_links[link][3:] += turn @ vector(load.get('torque', [0, 0, 0]))
        return on_links, on_coordinates

    def equations(self, poses):
        """(matrix, points, axes): rows of links 2 .. N, then of dependent coordinates; columns of pairs, moments over `length`."""
        free = [k for k in range(len(self.pairs)) if k not in self.independent]
        matrix = np.zeros((6 * (self.links - 1) + len(free), 6 * len(self.pairs)))
        points, axes = [], []
        for k, pair in enumerate(self.pairs):
            reference, moving = pair.links
            turn, shift = poses[moving][0][0], poses[moving][1][0]
            point = np.asarray(shift + turn @ pair.moving[1], float)
            z = np.asarray(turn @ pair.moving[0][:, 2], float)
            rise = 1.0 if pair.kind == 'prismatic' else float(pair.pitch) / (2 * np.pi)
            axis = np.concatenate([rise * z, np.zeros(3) if pair.kind == 'prismatic' else z / 1.0])
            onto = np.block([[np.eye(3), np.zeros((3, 3))], [cross_matrix(point), self.length * np.eye(3)]])
            for link, sign in ((moving, 1), (reference, -1)):
                if link > 1:
                    matrix[6 * (link - 2):6 * (link - 1), 6 * k:6 * k + 6] += sign * onto
            if k in free:
                matrix[6 * (self.links - 1) + free.index(k), 6 * k:6 * k + 6] = axis * ([1] * 3 + [self.length] * 3)
            points.append(point)
            axes.append(axis)
        return matrix, points, axes

    def solve(self, q):
        """(wrenches (M, 6), forces of independent coordinates, rows of the null space by pair, largest imbalance) at q (3 orders, M)."""
        poses = self.poses(q)
        needed = self.required(poses)
        on_links, on_coordinates = self.loaded(poses, q)
        matrix, _, axes = self.equations(poses)
        free = [k for k in range(len(self.pairs)) if k not in self.independent]
        right = np.concatenate([(needed - on_links)[2:].ravel(), on_coordinates[free]]).astype(float)
        u, s, v = np.linalg.svd(matrix)
        rank = int((s > 1e-9 * s[0]).sum())
        unknown = v[:rank].T @ ((u[:, :rank].T @ right) / s[:rank])
        unknown += v[:rank].T @ ((u[:, :rank].T @ (right - matrix @ unknown)) / s[:rank])
        wrenches = unknown.reshape(-1, 6) * ([1] * 3 + [self.length] * 3)
        drives = np.array([axes[k] @ wrenches[k] - float(on_coordinates[k]) for k in self.independent])
        null = v[rank:].reshape(-1, len(self.pairs), 6)
        rotated = np.zeros_like(null)
        for k, pair in enumerate(self.pairs):
            turn = np.asarray(poses[pair.links[1]][0][0] @ pair.moving[0], float)
            rotated[:, k, :3], rotated[:, k, 3:] = null[:, k, :3] @ turn, null[:, k, 3:] @ turn
        return wrenches, drives, np.sqrt((rotated ** 2).sum(axis=0))

    def imbalance(self, q, wrenches):
        """Largest force, or moment over the length, by which links and dependent coordinates are out of balance."""
        poses = self.poses(q)
        on_links, on_coordinates = self.loaded(poses, q)
        matrix, _, _ = self.equations(poses)
        free = [k for k in range(len(self.pairs)) if k not in self.independent]
        right = np.concatenate([(self.required(poses) - on_links)[2:].ravel(), on_coordinates[free]]).astype(float)
        scaled = (np.asarray(wrenches) / ([1] * 3 + [self.length] * 3)).ravel()
        return np.max(np.abs(matrix @ scaled - right) / np.concatenate([np.tile([1] * 3 + [self.length] * 3, self.links - 1), np.ones(len(free))]))


def axial(matrix):
    """The vector w of the skew part of a matrix."""
    return np.array([matrix[2, 1] - matrix[1, 2], matrix[0, 2] - matrix[2, 0], matrix[1, 0] - matrix[0, 1]]) / 2
