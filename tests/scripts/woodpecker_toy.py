"""The woodpecker toy by its own equations of motion (R.I. Leine, C. Glocker, D.H. van Campen, Nonlinear dynamics of the woodpecker toy,
ASME DETC 2001): a sleeve that slides and tilts on a pole, a bird on a spring, and three contacts of which one at most is closed.

Coordinates: height of the sleeve, angles a of the sleeve and b of the bird. Smooth parts are integrated by Gragg's extrapolation; times of
events are found by halving the last step."""
import numpy as np

SLEEVE, SLEEVE_INERTIA, BIRD, BIRD_INERTIA, SPRING, G = 3e-4, 5e-9, 4.5e-3, 7e-7, 0.0056, 9.81
POLE, R_SLEEVE, H_SLEEVE, TO_SPRING, TO_BIRD, H_BEAK, L_BEAK = 0.0025, 0.0031, 0.0058, 0.010, 0.015, 0.020, 0.0201
FRICTION, RESTITUTION = 0.3, (0.5, 0.0, 0.0)
STEP = 5e-4


def small_angles(q, _):
    """Mass matrix, forces, gaps, and their derivatives along normals and tangents, as published: for small angles."""
    a, b = q[1:]
    arm = np.array([1, TO_SPRING, TO_BIRD])
    mass = BIRD*np.outer(arm, arm) + np.diag([SLEEVE, SLEEVE_INERTIA, BIRD_INERTIA])
    force = np.array([-SLEEVE*G, SPRING*(b - a), SPRING*(a - b)]) - BIRD*G*arm
    gaps = np.array([TO_SPRING + TO_BIRD - L_BEAK - POLE - H_BEAK*b, R_SLEEVE - POLE + H_SLEEVE*a, R_SLEEVE - POLE - H_SLEEVE*a])
    normals = np.array([[0, 0, -H_BEAK], [0, H_SLEEVE, 0], [0, -H_SLEEVE, 0]])
    tangents = np.array([[1, TO_SPRING, TO_BIRD - L_BEAK], [1, R_SLEEVE, 0], [1, R_SLEEVE, 0]])
    return mass, force, gaps, normals, tangents


def any_angles(q, u):
    """The same without approximation."""
    sa, ca, sb, cb = np.sin(q[1]), np.cos(q[1]), np.sin(q[2]), np.cos(q[2])
    centre = np.array([[0, -TO_SPRING*sa, -TO_BIRD*sb], [1, TO_SPRING*ca, TO_BIRD*cb]])
    by_rates = -np.array([TO_SPRING*ca*u[1]**2 + TO_BIRD*cb*u[2]**2, TO_SPRING*sa*u[1]**2 + TO_BIRD*sb*u[2]**2])
    mass = BIRD*centre.T @ centre + np.diag([SLEEVE, SLEEVE_INERTIA, BIRD_INERTIA])
    force = np.array([-SLEEVE*G, SPRING*(q[2] - q[1]), SPRING*(q[1] - q[2])]) + BIRD*centre.T @ (np.array([0, -G]) - by_rates)
    beak = TO_BIRD - L_BEAK
    gaps = np.array([TO_SPRING*ca + beak*cb - H_BEAK*sb, R_SLEEVE*ca + H_SLEEVE*sa, R_SLEEVE*ca - H_SLEEVE*sa]) - POLE
    normals = np.array([[0, -TO_SPRING*sa, -beak*sb - H_BEAK*cb], [0, -R_SLEEVE*sa + H_SLEEVE*ca, 0],
                        [0, -R_SLEEVE*sa - H_SLEEVE*ca, 0]])
    tangents = np.array([[1, TO_SPRING*ca, beak*cb - H_BEAK*sb], [1, R_SLEEVE*ca + H_SLEEVE*sa, 0],
                         [1, R_SLEEVE*ca - H_SLEEVE*sa, 0]])
    return mass, force, gaps, normals, tangents


class Toy:
    """A motion: `events` gets (time, kind, contact from 1 on, impulse)."""

    def __init__(self, model, q, u):
        self.model, self.t, self.state = model, 0.0, np.array([*q, *u], dtype=float)
        self.closed, self.slips, self.events = None, 0, []
        touching = self.gaps().argmin()
        if abs(self.gaps()[touching]) < 1e-6:
            self.close(touching)

    def gaps(self):
        return self.model(self.state[:3], self.state[3:])[2]

    def forces(self, state, slips):
        """Normal and tangential force of the closed contact, and the accelerations. The sleeve does not turn while it touches, so
        that derivatives of the gap and of the slip do not change."""
        mass, force, _, normals, tangents = self.model(state[:3], state[3:])
        free = np.linalg.solve(mass, force)
        if self.closed is None:
            return 0.0, 0.0, free
        n, t = normals[self.closed], tangents[self.closed]
        rows = np.array([n, t])
        answers = np.linalg.solve(mass, rows.T)
        g = rows @ answers
        if slips:
            normal = -n @ free/(g[0, 0] - slips*FRICTION*g[0, 1])
            both = np.array([normal, -slips*FRICTION*normal])
        else:
            both = np.linalg.solve(g, -rows @ free)
        return both[0], both[1], free + answers @ both

    def close(self, contact):
        """Let a contact that has no velocity along its normal slide or stick, or lift off again."""
        self.closed = contact
        slip = self.model(self.state[:3], self.state[3:])[4][contact] @ self.state[3:]
        self.slips = int(np.sign(slip)) if abs(slip) > 1e-9 else 0
        if not self.slips:
            normal, tangential, _ = self.forces(self.state, 0)
            self.slips = 0 if abs(tangential) <= FRICTION*normal else -int(np.sign(tangential))
        if self.forces(self.state, self.slips)[0] <= 0:
            self.closed = None
        else:
            self.events.append((self.t, 'close', contact + 1, 0.0))

    def hit(self, contact):
        """Impact with friction: it ends the slip, or lies on the cone."""
        mass, _, _, normals, tangents = self.model(self.state[:3], self.state[3:])
        rows = np.array([normals[contact], tangents[contact]])
        answers = np.linalg.solve(mass, rows.T)
        g, before = rows @ answers, rows @ self.state[3:]
        wanted = -before - np.array([RESTITUTION[contact]*before[0], 0])
        both = np.linalg.solve(g, wanted)
        if abs(both[1]) > FRICTION*both[0]:
            side = np.sign(both[1])
            normal = wanted[0]/(g[0, 0] + side*FRICTION*g[0, 1])
            both = np.array([normal, side*FRICTION*normal])
        self.state[3:] += answers @ both
        self.events.append((self.t, 'impact', contact + 1, both[0]))
        self.closed = None
        if not RESTITUTION[contact]:
            self.close(contact)

    def watched(self, state):
        """Values that are positive until an event."""
        if self.closed is None:
            return self.model(state[:3], state[3:])[2]
        normal, tangential, _ = self.forces(state, self.slips)
        tangents = self.model(state[:3], state[3:])[4]
        second = self.slips*(tangents[self.closed] @ state[3:]) if self.slips else FRICTION*normal - abs(tangential)
        return np.array([normal, second, self.model(state[:3], state[3:])[2][0]])

    def step(self, h):
        """The state after a step: modified midpoint steps, extrapolated."""
        def rate(state):
            return np.concatenate([state[3:], self.forces(state, self.slips)[2]])
        rows = []
        for k in range(1, 9):
            n = 2*k
            before, now = self.state, self.state + h/n*rate(self.state)
            for _ in range(n - 1):
                before, now = now, before + 2*h/n*rate(now)
            row = [(before + now + h/n*rate(now))/2]
            for j in range(1, k):
                row.append(row[-1] + (row[-1] - rows[-1][j - 1])/((k/(k - j))**2 - 1))
            rows.append(row)
        return rows[-1][-1]

    def run(self, end):
        while self.t < end:
            h = min(STEP, end - self.t)
            after = self.step(h)
            at_start = self.watched(self.state) > 1e-12
            passed = np.flatnonzero((self.watched(after) < 0) & at_start)
            if not len(passed):
                self.t, self.state = self.t + h, after
                continue
            low, high = 0.0, h
            for _ in range(45):
                middle = (low + high)/2
                if np.any((self.watched(self.step(middle)) < 0) & at_start):
                    high = middle
                else:
                    low = middle
            self.state = self.step(high)
            which = int(np.argmin(np.where(at_start, self.watched(self.state), np.inf)))
            self.t += high
            self.meet(which)
        return self.state

    def meet(self, which):
        if self.closed is None:
            self.hit(which)
        elif which == 0:
            self.events.append((self.t, 'lift', self.closed + 1, 0.0))
            self.closed = None
        elif which == 2:
            self.hit(0)
        else:
            contact = self.closed
            if self.slips:
                self.slips = 0
                normal, tangential, _ = self.forces(self.state, 0)
                self.slips = 0 if abs(tangential) <= FRICTION*normal else -int(np.sign(tangential))
            else:
                self.slips = -int(np.sign(self.forces(self.state, 0)[1]))
            self.events.append((self.t, 'slip' if self.slips else 'stick', contact + 1, 0.0))
