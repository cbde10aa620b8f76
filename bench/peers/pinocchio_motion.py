"""Motions by Pinocchio's accelerations with CVODE of scikit-sundae. Chains are closed by constraints, whose drift Baumgarte's terms hold."""
import numpy as np
import pinocchio as pin
import sksundae
from sksundae.cvode import CVODE

from pinocchio_model import Model

NAME = 'Pinocchio'
VERSION = f'{pin.__version__} with scikit-sundae {sksundae.__version__}'
WORDS = ("constraintDynamics, which its lcaba does not match in accuracy; Baumgarte's terms with the rate of ten over the time of the "
         "motion; CVODE's Adams methods, called from Python")


def settings(mechanism, problem, end):
    if any(1.0 not in spring['links'] for spring in mechanism.springs):
        raise RuntimeError('springs between moving links are not among its forces')
    return [10.0 ** -power for power in range(3, 13)]


class Run:
    """Model and state at the start."""

    def __init__(self, mechanism, problem, end, tolerance):
        self.mechanism, self.end = mechanism, end
        ends = mechanism.closing_points()
        self.made = made = Model(pin, np, mechanism, ends)
        self.closed = bool(ends)
        # the scale of time: how fast errors of closure fade, against the length of the motion
        rate = 10.0 / end
        for constraint in made.constraints:
            if hasattr(constraint, 'corrector'):     # until version 3
                constraint.corrector.Kp[:], constraint.corrector.Kd[:] = rate ** 2, 2 * rate
            else:
                constraint.m_baumgarte_parameters.Kp, constraint.m_baumgarte_parameters.Kd = rate ** 2, 2 * rate
        if self.closed:
            try:
                pin.initConstraintDynamics(made.model, made.data, made.constraints, made.of_constraints)
            except TypeError:     # before version 4
                pin.initConstraintDynamics(made.model, made.data, made.constraints)
        self.proximal = pin.ProximalSettings(1e-12, 1e-10, 10)
        self.count = 0
        self.n = made.model.nv
        self.forces = np.zeros(self.n)
        self.solver = CVODE(self.derivative, method='Adams', rtol=tolerance, atol=tolerance, max_num_steps=10 ** 7)
        self.state = np.zeros(2 * self.n)
        for place, k in zip(made.place_of, mechanism.tree):
            self.state[place], self.state[self.n + place] = mechanism.position[k], mechanism.rate[k]
        self.find_forces(self.state[:self.n])

    def position(self, q):
        found = [0.0] * len(self.mechanism.pairs)
        for place, k in zip(self.made.place_of, self.mechanism.tree):
            found[k] = q[place]
        return found

    def find_forces(self, q):
        forces = self.mechanism.forces(self.position(q))
        for place, k in zip(self.made.place_of, self.mechanism.tree):
            self.forces[place] = forces[k]

    def derivative(self, t, y, yp):
        made, q, v = self.made, y[:self.n].copy(), y[self.n:].copy()
        self.count += 1
        if self.mechanism.springs:
            self.find_forces(q)
        yp[:self.n] = v
        if self.closed:
            yp[self.n:] = pin.constraintDynamics(made.model, made.data, q, v, self.forces, made.constraints, made.of_constraints, self.proximal)
        else:
            yp[self.n:] = pin.aba(made.model, made.data, q, v, self.forces)

    def go(self):
        self.solution = self.solver.solve([0.0, self.end], self.state)
        if not self.solution.success:
            raise RuntimeError(self.solution.message)
        return self.count

    def places(self):
        return self.mechanism.places(self.position(self.solution.y[-1][:self.n]))


prepare = Run
