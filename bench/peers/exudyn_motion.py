"""Motions by Exudyn: bodies with coordinates of their own, joints as constraints, generalised alpha method."""
import contextlib
import io

import numpy as np

with contextlib.redirect_stdout(io.StringIO()):
    import exudyn
    import exudyn.itemInterface as items
    from exudyn.rigidBodyUtilities import RigidBodyInertia

NAME = 'Exudyn'
VERSION = exudyn.__version__
WORDS = ('generalised alpha with spectral radius 0.9 (0.95 for windows, as in its own example), modified Newton method; '
         'bodies, joints and springs of the plane where all links move in planes')


def settings(mechanism, problem, end):
    return [end / n for n in (300, 1000, 3000, 10000, 30000, 100000, 300000)]


class Run:
    """A system with its bodies at the start."""

    def __init__(self, mechanism, problem, end, step):
        self.container = exudyn.SystemContainer()
        self.system = self.container.AddSystem()
        self.mechanism, self.end, self.step = mechanism, end, step
        self.body = {1: self.system.CreateGround()}
        start = mechanism.places()
        for link, (mass, centre, inertia) in mechanism.bodies.items():
            add = self.add_in_plane if mechanism.planar else self.add_in_space
            add(link, mass, np.array(centre), inertia, *start[link])
        for k in mechanism.tree:
            self.join(mechanism.pairs[k])
        for pair in mechanism.closing:
            self.join(pair)
        for spring in mechanism.springs:
            links = [int(link) for link in spring['links']]
            ends = [self.local(link, point) for link, point in zip(links, (spring['position'], spring['second_position']))]
            markers = [self.system.AddMarker(items.MarkerBodyPosition(bodyNumber=self.body[link], localPosition=list(point)))
                       for link, point in zip(links, ends)]
            self.system.AddObject(items.ObjectConnectorSpringDamper(
                markerNumbers=markers, referenceLength=spring['free_length'][0], stiffness=spring['stiffness'][0],
                damping=spring.get('damping', [0.0])[0]))
        for link, torque in mechanism.torques.items():
            marker = self.system.AddMarker(items.MarkerBodyRigid(bodyNumber=self.body[link]))
            self.system.AddLoad(items.LoadTorqueVector(markerNumber=marker, loadVector=torque))
        self.system.Assemble()

    def local(self, link, point):
        """A point of a link from its centre of mass, or of the frame."""
        return np.array(point) - (self.mechanism.bodies[link][1] if link != 1 else 0.0)

    def add_in_plane(self, link, mass, centre, inertia, turn, origin, spin, velocity):
        arm = turn @ centre
        place, speed = origin + arm, velocity + np.cross(spin, arm)
        node = self.system.AddNode(items.NodeRigidBody2D(
            referenceCoordinates=[place[0], place[1], np.arctan2(turn[1, 0], turn[0, 0])],
            initialVelocities=[speed[0], speed[1], spin[2]]))
        self.body[link] = self.system.AddObject(items.ObjectRigidBody2D(physicsMass=mass, physicsInertia=inertia[2], nodeNumber=node))
        if any(self.mechanism.gravity):
            marker = self.system.AddMarker(items.MarkerBodyMass(bodyNumber=self.body[link]))
            self.system.AddLoad(items.LoadMassProportional(markerNumber=marker, loadVector=self.mechanism.gravity))

    def add_in_space(self, link, mass, centre, inertia, turn, origin, spin, velocity):
        arm = turn @ centre
        self.body[link] = self.system.CreateRigidBody(
            inertia=RigidBodyInertia(mass=mass, inertiaTensor=np.diag(inertia[:3])), referencePosition=list(origin + arm),
            referenceRotationMatrix=turn, initialVelocity=list(velocity + np.cross(spin, arm)), initialAngularVelocity=list(spin),
            gravity=self.mechanism.gravity)

    def join(self, pair):
        links = pair.reference, pair.moving
        ends = [list(self.local(link, point)) for link, point in zip(links, (pair.point, pair.moving_point))]
        if self.mechanism.planar:
            markers = [self.system.AddMarker(items.MarkerBodyPosition(bodyNumber=self.body[link], localPosition=end))
                       for link, end in zip(links, ends)]
            self.system.AddObject(items.ObjectJointRevolute2D(markerNumbers=markers))
            return
        create = self.system.CreateRevoluteJoint if pair.turns else self.system.CreatePrismaticJoint
        create(bodyNumbers=[self.body[link] for link in links], position=ends[0], axis=pair.axis, useGlobalFrame=False)

    def go(self):
        chosen = exudyn.SimulationSettings()
        steps = round(self.end / self.step)
        time = chosen.timeIntegration
        time.numberOfSteps, time.endTime, time.verboseMode = steps, self.end, 0
        time.generalizedAlpha.spectralRadius = 0.95 if len(self.body) in (6, 82) and self.mechanism.planar else 0.9
        time.newton.useModifiedNewton = True
        chosen.solutionSettings.writeSolutionToFile = False
        chosen.displayComputationTime = False
        if len(self.body) > 20:
            chosen.linearSolverType = exudyn.LinearSolverType.EigenSparse
        if not self.mechanism.planar and self.mechanism.closing:
            # an overconstrained chain has a singular Jacobian
            chosen.linearSolverType = exudyn.LinearSolverType.EigenDense
            chosen.linearSolverSettings.ignoreSingularJacobian = True
        with contextlib.redirect_stdout(io.StringIO()):
            if not self.system.SolveDynamic(chosen):
                raise RuntimeError(f'no motion with steps of {self.step:g} s')
        return steps

    def places(self):
        found = {1: (np.eye(3), np.zeros(3))}
        for link, body in self.body.items():
            if link == 1:
                continue
            turn = np.array(self.system.GetObjectOutputBody(body, exudyn.OutputVariableType.RotationMatrix)).reshape(3, 3)
            centre = np.array(self.system.GetObjectOutputBody(body, exudyn.OutputVariableType.Position))
            found[link] = turn, centre - turn @ self.mechanism.bodies[link][1]
        return found


prepare = Run
