"""Forward dynamics of the same mechanisms by hand, by MECH9 and by other programs, where they are installed: MuJoCo and Pinocchio.

usage: other_programs.py PROGRAMS MECH9D FOLDER full|quick
    PROGRAMS   folder of bench_structures and bench_by_hand
    MECH9D     the program mech9d, which closes the chains at the start and gives the accelerations that others are compared with
    FOLDER     for data files and tables
Prints a row for each mechanism and program: the mechanism, its N, the program with its procedure, microseconds an evaluation, and the largest
difference of accelerations from those of mech9d over the largest acceleration. A line `missing` names each program that is not
installed. A program that fails is told on standard error and left out. All programs get the links, pairs and bodies of one data file, and the closed position and rates of its start.
"""
import math
import os
import re
import statistics
import subprocess
import sys
import time

TREE = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))
# name, kind of bench_structures, plane or space, N
PROBLEMS = [('two_links', 'chain', 'plane', 2), ('four_bar', 'four_bar', 'plane', 1), ('andrews', 'file', 'plane', 1),
            ('chain', 'chain', 'space', 10), ('chain', 'chain', 'space', 50), ('chain', 'chain', 'space', 200),
            ('tip', 'tip', 'space', 10), ('tip', 'tip', 'space', 50), ('tip', 'tip', 'space', 100),
            ('modules', 'modules', 'space', 30)]


class Mechanism:
    """Links, pairs, bodies and loads of a data file with revolute pairs, whose link systems are parallel at home, and its start."""

    def __init__(self, path, columns):
        text = re.sub(r'!.*', '', open(path, encoding='utf-8').read())
        self.pairs, self.bodies, self.torques, self.springs = [], {}, {}, []
        self.gravity = [0.0, 0.0, 0.0]
        for name, body in re.findall(r"&(\w+)((?:'[^']*'|[^'/])*)/", text):
            values = dict(re.findall(r"(\w+)\s*=\s*('[^']*'|[^=]*?)(?=,?\s*\w+\s*=|$)", body.strip()))
            numbers = {key: [float(word) for word in value.strip(', \n').split(',')] for key, value in values.items()
                       if re.match(r'[-+.\d]', value)}
            if name == 'pair':
                self.pairs.append(Pair(values, numbers))
            elif name == 'body':
                self.bodies[int(numbers['link'][0])] = (numbers['mass'][0], numbers['centre'], numbers['inertia'])
            elif name == 'gravity':
                self.gravity = numbers['acceleration']
            elif name == 'load' and values['kind'] == "'torque'":
                self.torques[int(numbers['link'][0])] = numbers['torque']
            elif name == 'load':
                self.springs.append(numbers)
        self.position = [columns[f'q{pair.coordinate}'] for pair in self.pairs]
        self.rate = [columns[f'dq{pair.coordinate}'] for pair in self.pairs]
        self.acceleration = [columns[f'ddq{pair.coordinate}'] for pair in self.pairs]
        self.find_tree()

    def find_tree(self):
        """Sort the pairs into those of a spanning tree, parents first, and those that close chains."""
        known, rest = {1}, list(range(len(self.pairs)))
        self.tree = []
        while True:
            found = next((k for k in rest if self.pairs[k].reference in known and self.pairs[k].moving not in known), None)
            if found is None:
                break
            self.tree.append(found)
            known.add(self.pairs[found].moving)
            rest.remove(found)
        self.closing = [self.pairs[k] for k in rest]

    def forces(self):
        """Torques of loads on the coordinates of links that turn on the frame, by pair: those of springs at the start."""
        forces = [0.0] * len(self.pairs)
        for k, pair in enumerate(self.pairs):
            if pair.reference != 1 or k not in self.tree:
                continue
            forces[k] += sum(a * b for a, b in zip(self.torques.get(pair.moving, [0.0] * 3), pair.axis))
            for spring in self.springs:
                if spring['links'] != [1.0, pair.moving]:
                    continue
                c, s = math.cos(self.position[k]), math.sin(self.position[k])
                x, y = (spring['second_position'][i] - pair.moving_point[i] for i in (0, 1))
                arm = [c * x - s * y, s * x + c * y]
                line = [spring['position'][i] - pair.point[i] - arm[i] for i in (0, 1)]
                length = math.hypot(*line)
                tension = spring['stiffness'][0] * (length - spring['free_length'][0]) / length
                forces[k] += tension * (arm[0] * line[1] - arm[1] * line[0])
        return forces

    def error(self, accelerations):
        """Largest difference of the accelerations of the tree's coordinates over the largest one."""
        largest = max(abs(a) for a in self.acceleration)
        return max(abs(a - self.acceleration[k]) for a, k in zip(accelerations, self.tree)) / largest


class Pair:
    """A revolute pair."""

    def __init__(self, values, numbers):
        assert values['kind'] == "'revolute'", 'revolute pairs only'
        self.coordinate = int(numbers['coordinate'][0])
        self.reference, self.moving = (int(number) for number in numbers['links'])
        self.axis = numbers['axis']
        self.point = numbers.get('point', [0.0] * 3)
        self.moving_point = numbers.get('moving_point', self.point)


def output_of(*words):
    return subprocess.run([str(word) for word in words], capture_output=True, text=True, check=True).stdout


def first_row(mech9d, path, folder):
    """{name: value} of the results of a data file at its start."""
    table = os.path.join(folder, 'start.dat')
    output_of(mech9d, path, '--set', 'time.end=1e-9', '--set', 'time.intervals=1', '--table', table, '--quiet')
    with open(table, encoding='utf-8') as file:
        names, row = [line.split() for line in file if not line.startswith('#')][:2]
    return dict(zip(names, map(float, row)))


def time_of(call, quick):
    """Median time of a call [us]."""
    begin = time.perf_counter()
    call()
    once = time.perf_counter() - begin
    calls = max(3, int((0.002 if quick else 0.02) / max(once, 1e-6)))
    times = []
    for _ in range(3 if quick else 15):
        begin = time.perf_counter()
        for _ in range(calls):
            call()
        times.append((time.perf_counter() - begin) / calls)
    return 1e6 * statistics.median(times)


def with_mujoco(mujoco, numpy, mechanism, quick):
    """mj_forward without contacts. Closed chains are held by its soft constraints, as hard as it lets them be."""
    children, sites = {}, []
    for k in mechanism.tree:
        children.setdefault(mechanism.pairs[k].reference, []).append(k)
    for i, pair in enumerate(mechanism.closing):
        sites += [(pair.reference, f'a{i}', pair.point), (pair.moving, f'b{i}', pair.moving_point)]

    def words(numbers):
        return ' '.join(map(repr, numbers))

    # nested as the links are; without recursion, since chains are long
    text, stack = [], [('open', 1, None)]
    while stack:
        action, link, k = stack.pop()
        if action == 'close':
            text.append('</body>')
            continue
        if k is not None:
            pair = mechanism.pairs[k]
            text.append(f'<body pos="{words(p - m for p, m in zip(pair.point, pair.moving_point))}">'
                        f'<joint type="hinge" pos="{words(pair.moving_point)}" axis="{words(pair.axis)}"/>')
            mass, centre, inertia = mechanism.bodies[link]
            text.append(f'<inertial mass="{mass!r}" pos="{words(centre)}" diaginertia="{words(inertia[:3])}"/>')
            stack.append(('close', link, None))
        text += [f'<site name="{name}" pos="{words(point)}"/>' for on, name, point in sites if on == link]
        stack += [('open', mechanism.pairs[c].moving, c) for c in reversed(children.get(link, []))]
    model = mujoco.MjModel.from_xml_string(
        f'<mujoco><compiler angle="radian"/><option gravity="{words(mechanism.gravity)}"><flag contact="disable"/></option>'
        f'<worldbody>{"".join(text)}</worldbody><equality>'
        + ''.join(f'<connect site1="a{i}" site2="b{i}" solimp="0.9999 0.9999 0.001 0.5 2"/>' for i in range(len(mechanism.closing)))
        + '</equality></mujoco>')
    data = mujoco.MjData(model)
    # joints are numbered in the order of the text
    order = list(depth_first(mechanism, children))
    forces = mechanism.forces()
    data.qpos[:] = [mechanism.position[k] for k in order]
    data.qvel[:] = [mechanism.rate[k] for k in order]
    data.qfrc_applied[:] = [forces[k] for k in order]
    spent = time_of(lambda: mujoco.mj_forward(model, data), quick)
    found = dict(zip(order, data.qacc))
    yield 'MuJoCo, mj_forward', spent, mechanism.error([found[k] for k in mechanism.tree])


def depth_first(mechanism, children):
    """Pairs of the tree in the order in which nested text has them."""
    stack = list(reversed(children[1]))
    while stack:
        k = stack.pop()
        yield k
        stack += reversed(children.get(mechanism.pairs[k].moving, []))


def with_pinocchio(pin, numpy, mechanism, quick):
    """Articulated bodies; with closed chains those with loops, or in versions without them a sparse factorization."""
    model = pin.Model()
    model.gravity.linear = numpy.array(mechanism.gravity)
    joint, origin = {1: 0}, {1: numpy.zeros(3)}
    kinds = {(1.0, 0.0, 0.0): pin.JointModelRX, (0.0, 1.0, 0.0): pin.JointModelRY, (0.0, 0.0, 1.0): pin.JointModelRZ}
    for k in mechanism.tree:
        pair = mechanism.pairs[k]
        # the system of a joint lies in its pair, not in the origin of the link's own system
        place = pin.SE3(numpy.eye(3), numpy.array(pair.point) - origin[pair.reference])
        joint[pair.moving] = model.addJoint(joint[pair.reference], kinds[tuple(pair.axis)](), place, f'j{k}')
        origin[pair.moving] = numpy.array(pair.moving_point)
        mass, centre, inertia = mechanism.bodies[pair.moving]
        model.appendBodyToJoint(joint[pair.moving],
                                pin.Inertia(mass, numpy.array(centre) - origin[pair.moving], numpy.diag(inertia[:3])),
                                pin.SE3.Identity())
    data = model.createData()
    place_of = [model.joints[joint[mechanism.pairs[k].moving]].idx_v for k in mechanism.tree]
    q, v, tau = numpy.zeros(model.nq), numpy.zeros(model.nv), numpy.zeros(model.nv)
    forces = mechanism.forces()
    for place, k in zip(place_of, mechanism.tree):
        q[place], v[place], tau[place] = mechanism.position[k], mechanism.rate[k], forces[k]

    def measured(words, call):
        spent = time_of(call, quick)
        return words, spent, mechanism.error(numpy.array(call())[place_of])

    if not mechanism.closing:
        yield measured('Pinocchio, aba', lambda: pin.aba(model, data, q, v, tau))
        return
    constraints = pin.StdVec_RigidConstraintModel()
    for pair in mechanism.closing:
        ends = [(joint[pair.reference], numpy.array(pair.point) - origin[pair.reference]),
                (joint[pair.moving], numpy.array(pair.moving_point) - origin[pair.moving])]
        constraints.append(pin.RigidConstraintModel(
            pin.ContactType.CONTACT_3D, model, ends[0][0], pin.SE3(numpy.eye(3), ends[0][1]), ends[1][0],
            pin.SE3(numpy.eye(3), ends[1][1]), pin.ReferenceFrame.LOCAL))
    of_constraints = pin.StdVec_RigidConstraintData()
    for constraint in constraints:
        of_constraints.append(constraint.createData())
    # one step with this weight leaves errors of 1e-7 to 1e-5 here; more steps take longer
    settings = pin.ProximalSettings(1e-12, 1e-6, 1)
    if hasattr(pin, 'lcaba'):
        pin.computeJointMinimalOrdering(model, data, constraints)
        yield measured('Pinocchio, lcaba', lambda: pin.lcaba(model, data, q, v, tau, constraints, of_constraints, settings))
        return
    pin.initConstraintDynamics(model, data, constraints)
    yield measured('Pinocchio, constraintDynamics',
                   lambda: pin.constraintDynamics(model, data, q, v, tau, constraints, of_constraints, settings))


def installed():
    """[(name, function, module, numpy)] of the other programs, and the names of those that are not here."""
    found, missing = [], []
    for words, name, function in (('MuJoCo', 'mujoco', with_mujoco), ('Pinocchio', 'pinocchio', with_pinocchio)):
        try:
            found.append((words, function, __import__(name), __import__('numpy')))
        except (ImportError, OSError):
            missing.append(words)
    return found, missing


def main():
    programs, mech9d, folder, mode = sys.argv[1:]
    quick = mode == 'quick'
    others, missing = installed()
    for words in missing:
        print('missing', words)
    by_hand = {}
    for line in output_of(os.path.join(programs, 'bench_by_hand'), mode).splitlines():
        name, spent, *accelerations = line.split()
        by_hand[name] = float(spent), [float(a) for a in accelerations]
    for name, kind, space, n in PROBLEMS:
        if quick and n > 50:
            continue
        path = os.path.join(folder, 'same.nml')
        if kind == 'file':
            path = os.path.join(TREE, 'examples', 'andrews', 'andrews.nml')
        row = output_of(os.path.join(programs, 'bench_structures'), kind, space, n, path).split()
        mechanism = Mechanism(path, first_row(mech9d, path, folder))
        rows = []
        if name in by_hand:
            spent, accelerations = by_hand[name]
            largest = max(map(abs, mechanism.acceleration))
            rows.append(('by hand', spent, max(abs(a - b) for a, b in zip(accelerations, mechanism.acceleration)) / largest))
        rows.append(('MECH9', float(row[6]), 0.0))
        for program, function, module, numpy in others:
            # a version that knows other names must not end the run
            try:
                rows += list(function(module, numpy, mechanism, quick))
            except Exception as failure:
                print(f'{program} fails on {name} {n}: {failure}', file=sys.stderr)
        for words, spent, error in rows:
            print(f'{name}\t{n}\t{words}\t{spent:.4f}\t{error:.1e}', flush=True)


if __name__ == '__main__':
    main()
