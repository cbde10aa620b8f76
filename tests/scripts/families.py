"""Families of mechanisms for the stress test, a batch of random ones of each structure. All stand at home, where every
coordinate is zero; sizes are one or so, and the caller gives them their unit of length.

A family is a function of a generator and a number B that gives links (pairs of link numbers), pairs and inputs; `pairs` is a
Pairs with arrays (B, M, ...), `inputs` are numbers of coordinates from 1.
"""
import numpy as np

Z = np.array([0.0, 0.0, 1.0])


class Pairs:
    """Lines in the home position, and how far a pair turns and slides for each unit of its coordinate."""

    def __init__(self, point, axis, turns=None, slides=None):
        b, m = point.shape[:2]
        self.point, self.axis = point, axis / np.linalg.norm(axis, axis=-1, keepdims=True)
        self.turns = np.ones((b, m)) if turns is None else turns
        self.slides = np.zeros((b, m)) if slides is None else slides

    def slide(self, k):
        """Make pair k (from 0) a prismatic one."""
        self.turns[:, k], self.slides[:, k] = 0.0, 1.0
        return self


def unit(vectors):
    return vectors / np.linalg.norm(vectors, axis=-1, keepdims=True)


def rotations(rng, b):
    """Uniform over all rotations, by random unit quaternions."""
    w, x, y, z = unit(rng.standard_normal((b, 4))).T
    return np.array([[1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
                     [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
                     [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)]]).transpose(2, 0, 1)


def moved(rng, pairs):
    """The same turned and shifted at random: planar chains in any plane."""
    r = rotations(rng, len(pairs.point))
    shift = rng.uniform(-1, 1, (len(r), 1, 3))
    pairs.point = np.einsum('bij,bmj->bmi', r, pairs.point) + shift
    pairs.axis = np.einsum('bij,bmj->bmi', r, pairs.axis)
    return pairs


def planar(points):
    """Revolutes at points (B, M, 2) of a plane."""
    b, m = points.shape[:2]
    return Pairs(np.concatenate([points, np.zeros((b, m, 1))], -1), np.broadcast_to(Z, (b, m, 3)).copy())


def ring(m):
    """Links of one loop of m pairs; one pair against the direction of the others."""
    links = [(i, i + 1) for i in range(1, m)] + [(1, m)]
    return links


def four_bar(cq):
    return lambda rng, b: (ring(4), moved(rng, planar(rng.uniform(-1, 1, (b, 4, 2)))), [cq])


def slider_crank(cq):
    def make(rng, b):
        pairs = planar(rng.uniform(-1, 1, (b, 4, 2))).slide(3)
        angle = rng.uniform(0, 2 * np.pi, b)
        pairs.axis[:, 3] = np.stack([np.cos(angle), np.sin(angle), 0 * angle], -1)
        return ring(4), moved(rng, pairs), [cq]
    return make


def five_bar(cq):
    return lambda rng, b: (ring(5), moved(rng, planar(rng.uniform(-1, 1, (b, 5, 2)))), list(cq))


WATT = [(1, 2), (2, 3), (3, 4), (1, 4), (3, 5), (5, 6), (4, 6)]
STEPHENSON = [(1, 2), (2, 3), (3, 4), (1, 4), (3, 5), (6, 5), (1, 6)]


def six_bar(links, cq):
    return lambda rng, b: (links, moved(rng, planar(rng.uniform(-1, 1, (b, 7, 2)))), [cq])


def row_of_four_bars(n, cq=1):
    """Each rocker is the crank of the next."""
    links, link, crank = [], 2, 2
    links.append((1, 2))
    for _ in range(n):
        links += [(crank, link + 1), (link + 1, link + 2), (1, link + 2)]
        crank, link = link + 2, link + 2
    return lambda rng, b: (links, moved(rng, planar(rng.uniform(-1, 1, (b, len(links), 2)))), [cq])


def platform(rng, b):
    """Three legs of three revolutes each, the first of each leg given: 3-RRR."""
    links = [(1, 2), (2, 3), (3, 8), (1, 4), (4, 5), (5, 8), (1, 6), (6, 7), (7, 8)]
    return links, moved(rng, planar(rng.uniform(-1, 1, (b, 9, 2)))), [1, 4, 7]


def spherical(cq):
    def make(rng, b):
        return ring(4), Pairs(np.repeat(rng.uniform(-1, 1, (b, 1, 3)), 4, 1), rng.standard_normal((b, 4, 3))), [cq]
    return make


def seven(kinds, cq=1):
    """A loop of seven pairs with any axes; kinds of letters R, P, H."""
    def make(rng, b):
        pairs = Pairs(rng.uniform(-1, 1, (b, 7, 3)), rng.standard_normal((b, 7, 3)))
        for k, kind in enumerate(kinds):
            if kind == 'P':
                pairs.slide(k)
            elif kind == 'H':
                pairs.slides[:, k] = rng.uniform(-0.3, 0.3, b)
        return ring(7), pairs, [cq]
    return make


def rssr(rng, b):
    """A crank and a rocker with any axes, joined by a rod between spherical joints, each of three revolutes. The rod's
    turn about itself is the second freedom."""
    point, axis = rng.uniform(-1, 1, (b, 8, 3)), rng.standard_normal((b, 8, 3))
    point[:, 2] = point[:, 3] = point[:, 1]
    point[:, 5] = point[:, 6] = point[:, 4]
    axis[:, 3] = point[:, 4] - point[:, 1]      # along the rod: given, and at rest
    return ring(8), Pairs(point, axis), [1, 4]


def rccc(rng, b):
    """Three cylindrical joints, each a revolute and a prismatic pair on one axis, and a revolute."""
    point, axis = rng.uniform(-1, 1, (b, 7, 3)), rng.standard_normal((b, 7, 3))
    for k in (1, 3, 5):
        point[:, k + 1], axis[:, k + 1] = point[:, k], axis[:, k]
    pairs = Pairs(point, axis)
    for k in (2, 4, 6):
        pairs.slide(k)
    return ring(7), pairs, [1]


def two_spatial_loops(cq):
    """Two loops of seven pairs, the second between links 3 and 6 of the first, any axes."""
    links = ring(7) + [(3, 8), (8, 9), (10, 9), (10, 11), (11, 12), (12, 6)]
    return lambda rng, b: (links, Pairs(rng.uniform(-1, 1, (b, 13, 3)), rng.standard_normal((b, 13, 3))), [cq])


# --- overconstrained ----------------------------------------------------------------------------------------------

def bennett(rng, b):
    """Bennett's: twists alpha, beta and lengths in the ratio of their sines; any position of it is taken as home."""
    alpha, beta = rng.uniform(0.3, 1.2, b), rng.uniform(1.4, 2.8, b)
    length = [np.sin(alpha), np.sin(beta)] * 2
    theta = rng.uniform(0.4, 2.7, b)
    other = 2 * np.arctan(np.sin((beta + alpha) / 2) / np.sin((beta - alpha) / 2) / np.tan(theta / 2))
    point, axis = np.zeros((b, 4, 3)), np.zeros((b, 4, 3))
    r, p = np.broadcast_to(np.eye(3), (b, 3, 3)), np.zeros((b, 3))
    for k, (angle, twist) in enumerate(zip((theta, other, -theta, -other), (alpha, beta, alpha, beta))):
        point[:, k], axis[:, k] = p, r[:, :, 2]
        c, s, o = np.cos(angle), np.sin(angle), np.zeros(b)
        turn = np.array([[c, -s, o], [s, c, o], [o, o, o + 1]]).transpose(2, 0, 1)
        c, s = np.cos(twist), np.sin(twist)
        lean = np.array([[o + 1, o, o], [o, c, -s], [o, s, c]]).transpose(2, 0, 1)
        p = p + length[k][:, None] * np.einsum('bij,bj->bi', r @ turn, np.broadcast_to([1.0, 0, 0], (b, 3)))
        r = r @ turn @ lean
    if max(np.max(np.abs(r - np.eye(3))), np.max(np.abs(p))) > 1e-12:
        raise ValueError('the Bennett loop is not closed')
    # in a loop 1-2-3-4-1 pair k joins link k to link k + 1
    return ring(4), moved(rng, Pairs(point, axis)), [1]


def sarrus(rng, b):
    """Two sets of three parallel revolutes: a straight line."""
    axis = np.repeat(rng.standard_normal((b, 2, 3)), 3, 1)
    return ring(6), Pairs(rng.uniform(-1, 1, (b, 6, 3)), axis), [1]


def bricard_of_a_line(rng, b):
    """Bricard's line-symmetric loop: three axes and the same three turned by half a turn about a line."""
    point, axis = rng.uniform(-1, 1, (b, 6, 3)), rng.standard_normal((b, 6, 3))
    point[:, 3:], axis[:, 3:] = point[:, :3] * [-1, -1, 1], axis[:, :3] * [-1, -1, 1]
    return ring(6), moved(rng, Pairs(point, axis)), [1]


def bricard_of_a_plane(rng, b):
    """Bricard's plane-symmetric loop: axes 1 and 4 in the plane, 6 and 5 the images of 2 and 3."""
    point, axis = rng.uniform(-1, 1, (b, 6, 3)), rng.standard_normal((b, 6, 3))
    for k in (0, 3):
        point[:, k, 2], axis[:, k, 2] = 0.0, 0.0
    for k, image in ((1, 5), (2, 4)):
        point[:, image], axis[:, image] = point[:, k] * [1, 1, -1], axis[:, k] * [1, 1, -1]
    return ring(6), moved(rng, Pairs(point, axis)), [1]


def parallel_cranks(n):
    """n + 1 parallel equal cranks on one coupler: a parallelogram with cranks too many. Home is not flat."""
    links = [(1, 2), (2, 3), (1, 4), (4, 3)]
    for i in range(n - 1):
        links += [(1, 5 + i), (5 + i, 3)]

    def make(rng, b):
        foot = rng.uniform(-1, 1, (b, n + 1, 2))
        crank = rng.uniform(0.3, 1.0, (b, 1)) * unit(rng.standard_normal((b, 2)))
        points = np.stack([foot, foot + crank[:, None]], 2).reshape(b, 2 * n + 2, 2)
        return links, moved(rng, planar(points)), [1]
    return make


# --- near-singular starts -----------------------------------------------------------------------------------------

def near_dead_point(rng, b):
    """Four-bars whose coupler and rocker are in line but for 1e-7 to 1e-1."""
    points = rng.uniform(-1, 1, (b, 4, 2))
    along = points[:, 3] - points[:, 1]
    beside = 10.0 ** rng.uniform(-7, -1, b)
    points[:, 2] = (points[:, 1] + rng.uniform(0.2, 1.6, b)[:, None] * along
                    + beside[:, None] * np.stack([-along[:, 1], along[:, 0]], -1))
    return ring(4), moved(rng, planar(points)), [1]


def near_dead_point_six(rng, b):
    """The same with the second loop of a six-bar."""
    points = rng.uniform(-1, 1, (b, 7, 2))
    along = points[:, 6] - points[:, 4]
    beside = 10.0 ** rng.uniform(-7, -1, b)
    points[:, 5] = (points[:, 4] + rng.uniform(0.2, 1.6, b)[:, None] * along
                    + beside[:, None] * np.stack([-along[:, 1], along[:, 0]], -1))
    return STEPHENSON, moved(rng, planar(points)), [1]


def near_dead_point_sphere(rng, b):
    """Spherical four-bars with axes 2, 3 and 4 nearly in one plane."""
    axis = unit(rng.standard_normal((b, 4, 3)))
    beside = 10.0 ** rng.uniform(-7, -1, b)
    axis[:, 2] = axis[:, 1] + rng.uniform(0.3, 2.0, b)[:, None] * axis[:, 3] + beside[:, None] * np.cross(axis[:, 1], axis[:, 3])
    return ring(4), Pairs(np.repeat(rng.uniform(-1, 1, (b, 1, 3)), 4, 1), axis), [1]


MOVING = {
    'planar four-bars': [four_bar(1), four_bar(2), four_bar(4)],
    'slider-cranks': [slider_crank(1), slider_crank(4)],
    'five-bars, two inputs': [five_bar((1, 5)), five_bar((1, 2)), five_bar((2, 4))],
    'six-bars of Watt': [six_bar(WATT, 1), six_bar(WATT, 6)],
    'six-bars of Stephenson': [six_bar(STEPHENSON, 1), six_bar(STEPHENSON, 7), six_bar(STEPHENSON, 5),
                               six_bar(STEPHENSON, 6)],    # at 7 a group of class III is left, at 6 one of class IV
    'rows of four-bars': [row_of_four_bars(3), row_of_four_bars(10), row_of_four_bars(4, 13)],
    '3-RRR platforms': [platform],
    'spherical four-bars': [spherical(1), spherical(3)],
    'loops of seven revolutes': [seven('RRRRRRR'), seven('RRRRRRR', 4)],
    'loops of R, P and H': [seven('RHRPRHR'), seven('PRRRRPR'), seven('HRHRHRP', 3), seven('HHHHHHH')],
    'RSSR by revolutes': [rssr],
    'RCCC by R and P': [rccc],
    'two spatial loops': [two_spatial_loops(1), two_spatial_loops(10)],
    'loops of Bennett': [bennett],
    'loops of Sarrus': [sarrus],
    'loops of Bricard, of a line': [bricard_of_a_line],
    'loops of Bricard, of a plane': [bricard_of_a_plane],
    'parallel cranks': [parallel_cranks(1), parallel_cranks(3)],
    'near-singular four-bars': [near_dead_point],
    'near-singular six-bars': [near_dead_point_six],
    'near-singular spherical': [near_dead_point_sphere],
}


# --- those that cannot serve --------------------------------------------------------------------------------------

def any_loop(n, cq):
    """n revolutes with any axes in one loop: n - 6 freedoms."""
    return lambda rng, b: (ring(n), Pairs(rng.uniform(-1, 1, (b, n, 3)), rng.standard_normal((b, n, 3))), list(cq))


def locked(rng, b):
    """A four-bar with a fifth axis across it: that pair cannot turn, and it is the input."""
    pairs = planar(rng.uniform(-1, 1, (b, 5, 2)))
    pairs.axis[:, 4] = unit(rng.standard_normal((b, 3)))
    return ring(5), moved(rng, pairs), [5]


def disturbed(variant, what):
    """A family that moves only by its exact dimensions, with one point moved across its axis, or one axis turned, by 1e-1 to
    1e-8: closed at home, and locked."""
    def make(rng, b):
        links, pairs, inputs = variant(rng, b)
        k, error = rng.integers(0, pairs.point.shape[1], b), 10.0 ** rng.uniform(-8, -1, b)
        axis = pairs.axis[np.arange(b), k]
        across = unit(np.cross(axis, rng.standard_normal((b, 3)))) * error[:, None]
        if what == 'point':
            extent = np.max(np.linalg.norm(pairs.point, axis=-1), axis=1)
            pairs.point[np.arange(b), k] += across * extent[:, None]
        else:
            pairs.axis[np.arange(b), k] = unit(axis + across)
        pairs.error = error
        return links, pairs, inputs
    return make


#: Planar chains stay planar where a point is moved, and Sarrus' loop has points anywhere: there axes are turned.
DISTURBED = {
    'disturbed four-bars': [disturbed(four_bar(1), 'axis')],
    'disturbed spherical': [disturbed(spherical(1), 'point')],
    'disturbed Bennett': [disturbed(bennett, 'axis'), disturbed(bennett, 'point')],
    'disturbed Sarrus': [disturbed(sarrus, 'axis')],
    'disturbed Bricard, of a line': [disturbed(bricard_of_a_line, 'axis'), disturbed(bricard_of_a_line, 'point')],
    'disturbed Bricard, of a plane': [disturbed(bricard_of_a_plane, 'axis'), disturbed(bricard_of_a_plane, 'point')],
    'disturbed cranks': [disturbed(parallel_cranks(3), 'axis')],
}

WRONG = {
    'too many inputs': [lambda rng, b: (*four_bar(1)(rng, b)[:2], [1, 3]), lambda rng, b: (*bennett(rng, b)[:2], [1, 2])],
    'too few inputs': [lambda rng, b: (*five_bar((1, 5))(rng, b)[:2], [1]), lambda rng, b: (*rssr(rng, b)[:2], [1])],
    'structures without freedom': [any_loop(3, [1]), any_loop(5, [1]), any_loop(6, [1])],
    'inputs that cannot move': [locked],
}
