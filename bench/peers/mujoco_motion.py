"""Motions by MuJoCo: joint coordinates, chains closed by soft constraints, steps of one size by the Runge-Kutta method of fourth order."""
import mujoco

from mujoco_model import model_of

NAME = 'MuJoCo'
VERSION = mujoco.__version__
WORDS = ("integrator RK4; implicit with springs that damp; chains closed by connect with time constants of two steps, the least that it "
         'takes, and solimp 0.9999; no contacts')


def settings(mechanism, problem, end):
    return [end / n for n in (300, 1000, 3000, 10000, 30000, 100000, 300000, 1000000)]


class Run:
    """Model and state at the start."""

    def __init__(self, mechanism, problem, end, step):
        self.mechanism, self.steps = mechanism, round(end / step)
        damped = any('damping' in spring for spring in mechanism.springs)
        self.model, self.order = model_of(
            mujoco, mechanism, mechanism.closing_points(), springs=True,
            option=f'timestep="{step!r}" integrator="{"implicit" if damped else "RK4"}" tolerance="1e-12"',
            closure=f'solref="{2 * step!r} 1"')
        self.data = mujoco.MjData(self.model)
        forces = mechanism.torques_of_pairs()
        self.data.qpos[:] = [mechanism.position[k] for k in self.order]
        self.data.qvel[:] = [mechanism.rate[k] for k in self.order]
        self.data.qfrc_applied[:] = [forces[k] for k in self.order]

    def go(self):
        mujoco.mj_step(self.model, self.data, self.steps)
        return self.steps

    def places(self):
        position = [0.0] * len(self.mechanism.pairs)
        for k, value in zip(self.order, self.data.qpos):
            position[k] = value
        return self.mechanism.places(position)


prepare = Run
