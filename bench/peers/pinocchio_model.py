"""Mechanisms in the words of Pinocchio."""


class Model:
    """The model of the spanning tree, its constraints, and where its vectors have the coordinates of pairs."""

    def __init__(self, pin, numpy, mechanism, ends):
        self.model = model = pin.Model()
        model.gravity.linear = numpy.array(mechanism.gravity)
        joint, origin = {1: 0}, {1: numpy.zeros(3)}
        for k in mechanism.tree:
            pair = mechanism.pairs[k]
            # the system of a joint lies in its pair, not in the origin of the link's own system
            place = pin.SE3(numpy.eye(3), numpy.array(pair.point) - origin[pair.reference])
            joint[pair.moving] = model.addJoint(joint[pair.reference], joint_of(pin, numpy, pair), place, f'j{k}')
            origin[pair.moving] = numpy.array(pair.moving_point)
            mass, centre, inertia = mechanism.bodies[pair.moving]
            model.appendBodyToJoint(joint[pair.moving], pin.Inertia(mass, numpy.array(centre) - origin[pair.moving], numpy.diag(inertia[:3])),
                                    pin.SE3.Identity())
        self.data = model.createData()
        self.place_of = [model.joints[joint[mechanism.pairs[k].moving]].idx_v for k in mechanism.tree]
        self.constraints, self.of_constraints = pin.StdVec_RigidConstraintModel(), pin.StdVec_RigidConstraintData()
        for reference, point, moving, moving_point in ends:
            self.constraints.append(pin.RigidConstraintModel(
                pin.ContactType.CONTACT_3D, model, joint[reference], pin.SE3(numpy.eye(3), numpy.array(point) - origin[reference]),
                joint[moving], pin.SE3(numpy.eye(3), numpy.array(moving_point) - origin[moving]), pin.ReferenceFrame.LOCAL))
        for constraint in self.constraints:
            self.of_constraints.append(constraint.createData())


def joint_of(pin, numpy, pair):
    """The joint of a pair; those along axes of the system are faster."""
    index = [abs(component) for component in pair.axis].index(max(abs(component) for component in pair.axis))
    if [0.0] * index + [1.0] + [0.0] * (2 - index) == pair.axis:
        return getattr(pin, f'JointModel{"R" if pair.turns else "P"}{"XYZ"[index]}')()
    kind = pin.JointModelRevoluteUnaligned if pair.turns else pin.JointModelPrismaticUnaligned
    return kind(numpy.array(pair.axis))
