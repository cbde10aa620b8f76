"""Motions by Drake: joint coordinates. Chains are closed by ball constraints, which it has in discrete systems alone; open ones are continuous."""
from importlib.metadata import version

import numpy as np
from pydrake.math import RigidTransform
from pydrake.multibody.plant import MultibodyPlant
from pydrake.multibody.tree import (FixedOffsetFrame, LinearSpringDamper, PrismaticJoint, RevoluteJoint, SpatialInertia, UnitInertia)
from pydrake.systems.analysis import ResetIntegratorFromFlags, Simulator

NAME = 'Drake'
VERSION = version('drake')
WORDS = 'closed chains: discrete steps with ball constraints; open chains: continuous, implicit Euler method with error control'


def settings(mechanism, problem, end):
    if mechanism.closing:
        return [end / n for n in (1000, 3000, 10000, 30000, 100000)]
    return [10.0 ** -power for power in range(2, 8)]


class Run:
    """A plant with its state at the start."""

    def __init__(self, mechanism, problem, end, setting):
        self.mechanism, self.end = mechanism, end
        self.plant = plant = MultibodyPlant(time_step=setting if mechanism.closing else 0.0)
        plant.mutable_gravity_field().set_gravity_vector(np.array(mechanism.gravity))
        body = {1: plant.world_body()}
        for link, (mass, centre, inertia) in mechanism.bodies.items():
            moments = np.diag(inertia[:3]) / mass
            about = UnitInertia(*np.diag(moments)).ShiftFromCenterOfMass(centre)
            body[link] = plant.AddRigidBody(f'link{link}', SpatialInertia(mass, np.array(centre), about, skip_validity_check=True))
        self.joints = {}
        for k in mechanism.tree:
            pair = mechanism.pairs[k]
            frames = [plant.AddFrame(FixedOffsetFrame(f'{name}{k}', body[link].body_frame(), RigidTransform(point)))
                      for name, link, point in (('a', pair.reference, pair.point), ('b', pair.moving, pair.moving_point))]
            kind = RevoluteJoint if pair.turns else PrismaticJoint
            self.joints[k] = plant.AddJoint(kind(f'pair{k}', *frames, pair.axis))
        for ends in mechanism.closing_points():
            # the second body must not be the world
            (first, point), (second, other) = sorted((ends[:2], ends[2:]), key=lambda end: end[0])
            plant.AddBallConstraint(body_A=body[first], p_AP=np.array(point), body_B=body[second], p_BQ=np.array(other))
        for spring in mechanism.springs:
            ends = [body[int(link)] for link in spring['links']]
            plant.AddForceElement(LinearSpringDamper(ends[0], np.array(spring['position']), ends[1], np.array(spring['second_position']),
                                                     spring['free_length'][0], spring['stiffness'][0], spring.get('damping', [0.0])[0]))
        torques = [(self.joints[k], torque) for k, torque in enumerate(mechanism.torques_of_pairs()) if torque != 0.0]
        for joint, _ in torques:
            plant.AddJointActuator(f'motor{joint.name()}', joint)
        plant.Finalize()
        self.context = plant.CreateDefaultContext()
        if torques:
            plant.get_actuation_input_port().FixValue(self.context, [torque for _, torque in torques])
        for k, joint in self.joints.items():
            set_position, set_rate = (joint.set_angle, joint.set_angular_rate) if mechanism.pairs[k].turns else \
                (joint.set_translation, joint.set_translation_rate)
            set_position(self.context, mechanism.position[k])
            set_rate(self.context, mechanism.rate[k])
        self.simulator = Simulator(plant, self.context)
        if not mechanism.closing:
            ResetIntegratorFromFlags(self.simulator, 'implicit_euler', 0.1)
            self.simulator.get_mutable_integrator().set_target_accuracy(setting)
        self.simulator.Initialize()

    def go(self):
        self.simulator.AdvanceTo(self.end)
        if self.mechanism.closing:
            return round(self.end / self.plant.time_step())
        return self.simulator.get_integrator().get_num_steps_taken()

    def places(self):
        position = [0.0] * len(self.mechanism.pairs)
        for k, joint in self.joints.items():
            position[k] = joint.get_angle(self.context) if self.mechanism.pairs[k].turns else joint.get_translation(self.context)
        return self.mechanism.places(position)


prepare = Run
