"""Robots that are imported: positions of frames, forces of drives and energies against a recursion of Newton and Euler over all links of
the robot's own file, which is written here in numpy; closed chains against closed forms; joints with several freedoms against
falling and turning bodies; refusals with file, line and column; files that are cut, changed or hostile.

usage: imported_robots.py MECH9K MECH9D
"""
import math
import os
import re
import sys
import tempfile
import xml.etree.ElementTree as ElementTree

import numpy as np

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), '..', 'scripts'))
from imported import ASSEMBLY, DATA, DONE, FILE, ROUND_OFF, STRUCTURE, USAGE, about, rpy, test_imports
from mech9_cases import TREE, run, text_of

GRAVITY = np.array([0.0, 0.0, -9.81])

ARM = """<?xml version="1.0" encoding="utf-8"?>
<robot name="Arm 'ä'">
  <link name="base"><inertial><mass value="5"/></inertial></link>
  <link name="upper">
    <inertial>
      <origin xyz="0.1 0.02 0.3" rpy="0.3 -0.2 0.5"/>
      <mass value="2.5"/>
      <inertia ixx="0.05" ixy="0.002" ixz="-0.003" iyy="0.06" iyz="0.001" izz="0.03"/>
    </inertial>
    <visual><geometry><box size="1 1 1"/></geometry></visual>
  </link>
  <link name="plate">
    <inertial>
      <origin xyz="0 0 0.05"/>
      <mass value="0.7"/>
      <inertia ixx="0.002" ixy="0" ixz="0" iyy="0.003" iyz="0" izz="0.004"/>
    </inertial>
  </link>
  <link name="slider">
    <inertial>
      <origin xyz="0 0.1 0"/>
      <mass value="1.2"/>
      <inertia ixx="0.02" ixy="0" ixz="0" iyy="0.01" iyz="0" izz="0.02"/>
    </inertial>
  </link>
  <link name="hand">
    <inertial>
      <origin xyz="0.05 0 0.02" rpy="0.1 0.2 0.3"/>
      <mass value="0.4"/>
      <inertia ixx="0.001" ixy="0" ixz="0" iyy="0.002" iyz="0" izz="0.0015"/>
    </inertial>
  </link>
  <link name="tool 0"/>
  <joint name="shoulder" type="revolute">
    <parent link="base"/><child link="upper"/>
    <origin xyz="0.1 0.2 0.3" rpy="0.4 0.5 0.6"/>
    <axis xyz="0.3 0.4 1.2"/>
    <limit lower="-1.5" upper="1.5" effort="30" velocity="2"/>
    <dynamics damping="0.3" friction="0.1"/>
  </joint>
  <joint name="flange" type="fixed">
    <parent link="upper"/><child link="plate"/>
    <origin xyz="0.1 0 0.6" rpy="0 1.0 0.2"/>
  </joint>
  <joint name="slide" type="prismatic">
    <parent link="plate"/><child link="slider"/>
    <origin xyz="0 0.1 0.1" rpy="1.5707963267948966 0 0"/>
    <axis xyz="0 1 0"/>
    <limit lower="0" upper="0.3" effort="1" velocity="1"/>
  </joint>
  <joint name="wrist" type="continuous">
    <parent link="slider"/><child link="hand"/>
    <origin xyz="0.2 0 0.1" rpy="-0.3 0.9 2.1"/>
  </joint>
  <joint name="tip" type="fixed">
    <parent link="hand"/><child link="tool 0"/>
    <origin xyz="0 0 0.15" rpy="0 0 1"/>
  </joint>
</robot>
"""
# Each coordinate moves as c0 + c1 t + c2 t^2.
LAWS = np.array([[0.1, 0.5, -0.4], [0.05, -0.2, 0.3], [-0.4, 0.9, 0.2]])

FOUR_BAR = """<robot name="four-bar">
  <link name="ground"/>
  <link name="crank"/>
  <link name="coupler"/>
  <link name="rocker"/>
  <joint name="O" type="continuous"><parent link="ground"/><child link="crank"/><axis xyz="0 0 1"/></joint>
  <joint name="A" type="continuous"><parent link="crank"/><child link="coupler"/><origin xyz="0.2 0 0"/><axis xyz="0 0 1"/></joint>
  <joint name="C" type="continuous"><parent link="ground"/><child link="rocker"/><origin xyz="0.6 0 0"/><axis xyz="0 0 1"/></joint>
  LOOP
</robot>
"""
LOOP = """<loop name="B" type="continuous">
    <predecessor link="coupler"><origin xyz="0.5 0 0"/></predecessor>
    <successor link="rocker"><origin xyz="0.4 0 0"/></successor>
    <axis xyz="0 0 1"/>
  </loop>"""
# The same loop as a joint to a link that has a parent: the system of the rocker stands in its other end.
SECOND_PARENT = """<joint name="B" type="continuous">
    <parent link="coupler"/><child link="rocker"/><origin xyz="0.5 0 0" rpy="0 0 0"/><axis xyz="0 0 1"/>
  </joint>"""


def numbers(element, name, default):
    return np.array([float(word) for word in element.get(name, default).split()]) if element is not None else \
        np.array([float(word) for word in default.split()])


def origin_of(element):
    origin = element.find('origin')
    return rpy(numbers(origin, 'rpy', '0 0 0')), numbers(origin, 'xyz', '0 0 0')


class Body:
    """A link on the way from the base: pose, velocity and acceleration of its frame in the axes of the base."""

    def __init__(self, r=np.eye(3), p=np.zeros(3), w=np.zeros(3), v=np.zeros(3), dw=np.zeros(3), a=np.zeros(3)):
        self.r, self.p, self.w, self.v, self.dw, self.a = r, p, w, v, dw, a

    def carried(self, point):
        """Velocity and acceleration of a point that moves with it, given by its distance from the origin of the frame."""
        return self.v + np.cross(self.w, point), self.a + np.cross(self.dw, point) + np.cross(self.w, np.cross(self.w, point))


def arm_by_newton_euler(t):
    """Poses of all links, forces of the drives without the damper, kinetic and potential energy of ARM at a time."""
    robot = ElementTree.fromstring(ARM.encode())
    q = [np.polyval(law[::-1], t) for law in LAWS]
    dq = [law[1] + 2 * law[2] * t for law in LAWS]
    ddq = [2 * law[2] for law in LAWS]
    bodies, moving, over = {'base': Body()}, [], {'base': []}
    for joint in robot.findall('joint'):
        parent, child, kind = joint.find('parent').get('link'), joint.find('child').get('link'), joint.get('type')
        body, (r, p) = bodies[parent], origin_of(joint)
        arm = body.r @ p
        v, a = body.carried(arm)
        new = Body(body.r @ r, body.p + arm, body.w, v, body.dw, a)
        over[child] = list(over[parent])
        if kind != 'fixed':
            k = len(moving)
            axis = numbers(joint.find('axis'), 'xyz', '1 0 0')
            axis = new.r @ (axis / np.linalg.norm(axis))
            moving.append((kind, axis, None))
            over[child].append(k)
            if kind == 'prismatic':
                v, a = body.carried(arm + axis * q[k])
                new.p = new.p + axis * q[k]
                new.v = v + axis * dq[k]
                new.a = a + axis * ddq[k] + 2 * np.cross(body.w, axis * dq[k])
            else:
                new.r = about(axis, q[k]) @ new.r
                new.w = body.w + axis * dq[k]
                new.dw = body.dw + axis * ddq[k] + np.cross(body.w, axis * dq[k])
            moving[k] = (kind, axis, new.p)
        bodies[child] = new
    forces, kinetic, potential = np.zeros(3), 0.0, 0.0
    for link in robot.findall('link'):
        inertial, body = link.find('inertial'), bodies[link.get('name')]
        if inertial is None or link.get('name') == 'base':
            continue
        r, p = origin_of(inertial)
        i = {name: float(inertial.find('inertia').get(name)) for name in ('ixx', 'iyy', 'izz', 'ixy', 'ixz', 'iyz')}
        tensor = np.array([[i['ixx'], i['ixy'], i['ixz']], [i['ixy'], i['iyy'], i['iyz']], [i['ixz'], i['iyz'], i['izz']]])
        tensor = body.r @ r @ tensor @ r.T @ body.r.T
        mass, arm = float(inertial.find('mass').get('value')), body.r @ p
        v, a = body.carried(arm)
        force = mass * (a - GRAVITY)
        moment = tensor @ body.dw + np.cross(body.w, tensor @ body.w)
        for k in over[link.get('name')]:
            kind, axis, at = moving[k]
            forces[k] += axis @ force if kind == 'prismatic' else axis @ (moment + np.cross(body.p + arm - at, force))
        kinetic += 0.5 * (mass * v @ v + body.w @ tensor @ body.w)
        potential -= mass * GRAVITY @ (body.p + arm)
    return bodies, forces, kinetic, potential, dq


def check_arm(s):
    """An open chain with fixed joints, a tool without mass, and general axes."""
    data = s.imports(ARM, name='arm.urdf')
    for k, law in enumerate(LAWS, 1):
        data = data.replace(f"&drive coordinate={k}, kind='polynomial', coefficients=0 /",
                            f"&drive coordinate={k}, kind='polynomial', coefficients={', '.join(f'{c!r}' for c in law.tolist())} /")
    data += '&time end=1, intervals=4 /\n&output drive_forces=.true. /\n'
    found = s.table(s.mech9d, data)
    for row, t in enumerate(found['t']):
        bodies, forces, kinetic, potential, dq = arm_by_newton_euler(t)
        for name, link in (('plate', 'plate'), ('tool_0', 'tool 0')):
            body = bodies[link]
            for prefix, vector in (('', body.p), ('v', body.v), ('a', body.a)):
                s.checks.near([found[f'{name}.{prefix}{c}'][row] for c in 'xyz'], vector, 10 * ROUND_OFF,
                              f'{prefix or "p"} of {link} at t = {t}', scale=1.0)
        forces[0] += 0.3 * dq[0]
        s.checks.near([found[f'F{k}'][row] for k in (1, 2, 3)], forces, 100 * ROUND_OFF, f'forces of drives at t = {t}', scale=10.0)
        s.checks.near(found['E.kinetic'][row], kinetic, 100 * ROUND_OFF, f'kinetic energy at t = {t}')
    _, _, _, first, _ = arm_by_newton_euler(found['t'][0])
    _, _, _, last, _ = arm_by_newton_euler(found['t'][-1])
    s.checks.near(found['E.potential'][-1] - found['E.potential'][0], last - first, 100 * ROUND_OFF, 'potential energy', scale=10.0)
    for note in ('arm.urdf:10: not taken over: <visual> of links', 'arm.urdf:38: not taken over: ranges of joints',
                 "the friction of joint 'shoulder'"):
        s.checks.true(note in s.said, f'told: {note}', s.said)
        s.checks.true(note.split('not taken over: ')[-1] in data, f'in the data file: {note}')
    for comment in ('! joint shoulder, range -1.5 to 1.5', '! Link 2: upper', "title='Arm ''ä'''"):
        s.checks.true(comment in data, comment, data)
    free = s.imports(ARM, program=s.mech9d)
    s.checks.true('&drive' not in free and free.count('&initial') == 3, 'mech9d: initial values and no drives', free)
    s.table(s.mech9d, free)


def check_four_bar(s):
    """A closed chain, its loop in the same file, beside it, or as a second parent: angles of a four-bar from its diagonal."""
    moved = FOUR_BAR.replace('<child link="rocker"/><origin xyz="0.6 0 0"/>', '<child link="stub"/><origin xyz="0.6 0 0"/>')
    moved = moved.replace('<link name="rocker"/>', '<link name="rocker"/><link name="stub"/>')
    moved = moved.replace('LOOP', SECOND_PARENT + """<joint name="end" type="fixed"><parent link="rocker"/><child link="stub2"/>
      <origin xyz="-0.4 0 0"/></joint><link name="stub2"/>""").replace('child link="stub"', 'child link="stub2"').replace(
          '<link name="stub"/>', '')
    for why, robot, loops in (('in the file', FOUR_BAR.replace('LOOP', LOOP), None),
                              ('beside the file', FOUR_BAR.replace('LOOP', ''), f'<loops>{LOOP}</loops>'),
                              ('as a second parent', moved, None)):
        data = s.imports(robot, loops)
        s.checks.true('cq=1 ' in data, f'{why}: the crank is independent', data)
        found = s.table(s.mech9k, re.sub('coefficients=[^ ]*', 'coefficients=0.3, 6', data))
        rockers = [k for k in (1, 2, 3, 4) if f'coordinate={k}, links=1, 3,' in data or f'coordinate={k}, links=1, 4,' in data]
        crank, rocker = found['q1'], found[f'q{rockers[-1]}']
        # the distance of the ends of crank and rocker is the coupler
        gap = np.hypot(0.6 + 0.4 * np.cos(rocker) - 0.2 * np.cos(crank), 0.4 * np.sin(rocker) - 0.2 * np.sin(crank)) - 0.5
        s.checks.near(gap, 0.0, ROUND_OFF, f'{why}: the coupler keeps its length')
    data = s.imports(FOUR_BAR.replace('LOOP', LOOP).replace('name="C" type', 'name="C" independent="true" type'))
    s.checks.true('cq=2 ' in data, 'the file chooses the independent coordinate', data)
    # a parallelogram that is straight at zero
    flat = FOUR_BAR.replace('LOOP', LOOP).replace('0.2 0 0', '0.4 0 0').replace('"0.5 0 0"', '"0.6 0 0"')
    data = s.imports(flat)
    s.checks.true("position is singular; the start lies beside it" in s.said and 'coefficients=0.3' in data, 'a start beside a singularity',
                  s.said)
    s.table(s.mech9k, re.sub('coefficients=[^ ]*', 'coefficients=0.3, 2', data))
    lift = text_of(os.path.join(TREE, 'examples', 'hydraulic_lift', 'lift.urdf'))
    data = s.imports(lift)
    # a range without zero: its middle is the start
    s.checks.true('coefficients=0.85' in data, 'the stroke starts in its range', data)


def check_freedoms(s):
    """Joints with several freedoms: a body that is thrown and spins about a principal axis, one on a ball, one on a plane."""
    body = '<link name="w"/><link name="b"><inertial><mass value="2"/><inertia ixx="1" iyy="2" izz="2.5"/></inertial></link>'
    joint = '<joint name="j" type="{}"><parent link="w"/><child link="b"/><origin xyz="0 0 1"/><axis xyz="0 0 1"/></joint>'
    data = s.imports(f'<robot>{body}{joint.format("floating")}</robot>', program=s.mech9d)
    data = data.replace('&initial coordinate=1, position=0 /', '&initial coordinate=1, position=0, velocity=3 /')
    data = data.replace('&initial coordinate=6, position=0 /', '&initial coordinate=6, position=0, velocity=2 /')
    found = s.table(s.mech9d, data)
    t = found['t']
    s.checks.near(found['b.x'], 3 * t, 1e-8, 'floating: thrown')
    s.checks.near(found['b.z'], 1 - 4.905 * t**2, 1e-8, 'floating: it falls')
    s.checks.near(found['q6'], 2 * t, 1e-8, 'floating: it spins')
    data = s.imports(f'<robot>{body}{joint.format("planar")}</robot>', program=s.mech9d)
    found = s.table(s.mech9d, data)
    s.checks.true("'planar'" in data and data.count('&pair') == 1, 'planar: one pair', data)
    s.checks.near(found['b.z'], 1.0, ROUND_OFF, 'planar: it stays in its plane')
    # the place of a point of the body after all turns and slides of its joint, in general frames
    tool = '<link name="t"/><joint name="f" type="fixed"><parent link="b"/><child link="t"/><origin xyz="0.3 0.2 0.1"/></joint>'
    loop = ('<loop name="j" type="{}"><predecessor link="w"><origin xyz="0 0 1" rpy="0.3 0.4 0.5"/></predecessor><successor link="b">'
            '<origin xyz="0.1 0 0" rpy="{}"/></successor><axis xyz="0 0.6 0.8"/><axis2 xyz="1 0 0"/></loop>')
    q = [0.3, -0.4, 0.7, 0.2, 0.5, -0.6]
    axis, x, y, z = np.array([0, 0.6, 0.8]), *np.eye(3)
    sides = np.array([1.0, 0, 0]), np.array([0, 0.8, -0.6])
    for kind, r, p in (
            ('spherical', about(x, q[0]) @ about(y, q[1]) @ about(z, q[2]), 0 * x),
            ('universal', about(axis, q[0]) @ about(x, q[1]), 0 * x),
            ('cylindrical', about(axis, q[0]), q[1] * axis),
            ('planar', about(axis, q[2]), q[0] * sides[0] + q[1] * sides[1]),
            ('free', about(x, q[3]) @ about(y, q[4]) @ about(z, q[5]), np.array(q[:3]))):
        for turned in ('0 0 0.9', '0.3 0.4 0.5'):
            data = s.imports(f'<robot>{body}{tool}' + loop.format(kind, turned) + '</robot>')
            for k, value in enumerate(q, 1):
                data = data.replace(f"&drive coordinate={k}, kind='polynomial', coefficients=0 /",
                                    f"&drive coordinate={k}, kind='polynomial', coefficients={value} /")
            split = kind == 'universal' and turned == '0 0 0.9'
            s.checks.equal(data.count('&pair'), 2 if split else 1, f'{kind}: pairs')
            found = s.table(s.mech9k, data, '--set', 'time.intervals=1')
            inner = rpy([float(word) for word in turned.split()])
            point = inner.T @ (np.array([0.3, 0.2, 0.1]) - (0.1, 0, 0))
            s.checks.near([found[f't.{c}'][0] for c in 'xyz'], (0, 0, 1) + rpy((0.3, 0.4, 0.5)) @ (p + r @ point), 10 * ROUND_OFF,
                          f'{kind}: place of a point', scale=1.0)


def check_mimic(s):
    """A joint that follows another one is coupled to it, and dependent."""
    robot = ARM.replace('<parent link="slider"/>', '<mimic joint="shoulder" multiplier="2" offset="0.3"/><parent link="slider"/>')
    data = s.imports(robot)
    s.checks.true("&coupling kind='linear', coordinates=3, 1, coefficients=1, -2, constant=0.3 /" in data, 'mimic is a coupling', data)
    s.checks.true('cq=1, 2 ' in data, 'the joint that follows is dependent', data)
    found = s.table(s.mech9k, re.sub('(coordinate=1, .*)coefficients=[^ ]*', r'\1coefficients=0.1, 0.5', data))
    s.checks.near(found['q3'], 2 * found['q1'] + 0.3, ROUND_OFF, 'it follows')
    s.refuses('a joint that follows itself', DATA, "joint 'wrist' follows itself", robot.replace('mimic joint="shoulder"', 'mimic joint="wrist"'))
    s.refuses('a joint that follows with 0', DATA, "joint 'wrist' follows joint 'shoulder' with the factor 0 and cannot move",
              robot.replace('multiplier="2"', 'multiplier="0"'))
    circle = robot.replace('<joint name="shoulder" type="revolute">', '<joint name="shoulder" type="revolute"><mimic joint="wrist" multiplier="3"/>')
    both = re.sub('<joint name="slide" type="prismatic">', '<joint name="slide" type="fixed">', circle)
    s.refuses('joints that hold each other', STRUCTURE, 'the robot cannot move: its closed chains and the joints that follow others', both)
    s.imports(robot.replace('mimic joint="shoulder"', 'mimic joint="flange"'))
    s.checks.true("the coupling of joint 'wrist' with joint 'flange'" in s.said, 'a joint that does not move leads none', s.said)


def check_inertia(s):
    """An inertia that no body has is left out and told; the rest is taken over."""
    data = s.imports(ARM.replace('iyy="0.002"', 'iyy="0.2"'))
    s.checks.true("the inertia of link 'hand'" in s.said and 'robot.xml:26' in s.said, 'an impossible inertia is told', s.said)
    s.checks.true('mass=0.4' in data.replace(' = ', '='), 'its mass is taken over', data)
    s.table(s.mech9k, data)


def check_refusals(s):
    """Files that are no robots, each with its place."""
    cases = [
        ('no XML', DATA, 'robot.xml:1:1: this is not well-formed XML', 'hello'),
        ('an empty file', DATA, 'robot.xml', ''),
        ('a wrong end', DATA, 'robot.xml:3:4: this is not well-formed XML: mismatched tag', '<robot>\n <link name="a">\n </robot>'),
        ('a cut file', DATA, 'this is not well-formed XML', ARM[:900]),
        ('another root', DATA, '<html> is no robot', '<html/>'),
        ('no link', DATA, 'robot.xml:1:1: the robot has no <link>', '<robot/>'),
        ('no joint', DATA, 'no joints that move', '<robot><link name="a"/></robot>'),
        ('two links of one name', DATA, "there are two links 'plate'", ARM.replace('name="hand"', 'name="plate"')),
        ('two joints of one name', DATA, "two joints 'slide'", ARM.replace('name="wrist"', 'name="slide"')),
        ('an unknown child', DATA, "there is no link 'hnd', which joint 'wrist' names", ARM.replace('child link="hand"', 'child link="hnd"')),
        ('an unknown leader', DATA, "there is no joint 'sholder', which joint 'wrist' follows",
         ARM.replace('<parent link="slider"/>', '<mimic joint="sholder"/><parent link="slider"/>')),
        ('no leader', DATA, "'joint'", ARM.replace('<parent link="slider"/>', '<mimic multiplier="2"/><parent link="slider"/>')),
        ('an unknown link', DATA, "there is no link 'hnd', which joint 'wrist' names", ARM.replace('parent link="slider"', 'parent link="hnd"')),
        ('two roots', DATA, 'only one link, the frame', ARM.replace('</robot>', '<link name="other"/></robot>')),
        ('a long word', DATA, "a joint; the types are fixed", ARM.replace('type="prismatic"', f'type="{1000000 * "q"}"')),
        ('an unknown type', DATA, "unknown type 'hinge' of a joint; the types are fixed, revolute, continuous,", ARM.replace('type="prismatic"', 'type="hinge"')),
        ('a wrong number', DATA, "robot.xml:6:7: 'xyz': '0.1m' is not a number", ARM.replace('"0.1 0.02 0.3"', '"0.1m 0.02 0.3"')),
        ('two numbers', DATA, "'xyz' must hold 3 numbers, not 2", ARM.replace('"0.1 0.02 0.3"', '"0.1 0.02"')),
        ('infinite', DATA, 'is not a finite number', ARM.replace('"0.1 0.02 0.3"', '"inf 0 0"')),
        ('too large', DATA, 'is too large', ARM.replace('"0.1 0.02 0.3"', '"1e200 0 0"')),
        ('no axis', DATA, 'the axis has no direction', ARM.replace('"0.3 0.4 1.2"', '"0 0 0"')),
        ('a negative mass', DATA, "the mass of link 'plate' is negative", ARM.replace('value="0.7"', 'value="-0.7"')),
        ('a joint with itself', DATA, 'joins a link with itself', ARM.replace('parent link="slider"', 'parent link="hand"')),
        ('xacro', DATA, 'expand it by xacro', ARM.replace('<link name="tool 0"/>', '<link name="tool 0"/><xacro:arm/>')),
        ('an open loop', ASSEMBLY, 'cannot be assembled', FOUR_BAR.replace('LOOP', LOOP.replace('0.5 0 0', '5 0 0'))),
        ('a loop that locks', STRUCTURE, 'cannot move', FOUR_BAR.replace('LOOP', LOOP).replace(
            '<joint name="A" type="continuous"', '<joint name="A" type="fixed"')),
        ('rigid contradiction', DATA, 'in another position', ARM.replace('</robot>', """<joint name="again" type="fixed">
            <parent link="upper"/><child link="plate"/></joint></robot>""")),
        ('entities', DATA, '<!DOCTYPE', '<!DOCTYPE r [<!ENTITY a "aaaaaaaaaa">' + ''.join(
            f'<!ENTITY {chr(98 + i)} "{10 * f"&{chr(97 + i)};"}">' for i in range(12)) + ']><robot>&m;</robot>'),
        ('another file', DATA, '<!DOCTYPE', '<!DOCTYPE r SYSTEM "/etc/passwd"><robot/>'),
        ('deep', DATA, 'nested more than 250 deep', '<a>' * 100000),
        ('many links', DATA, 'too many', '<robot>' + ''.join(f'<link name="l{i}"/>' for i in range(20000)) + '</robot>'),
    ]
    for why, code, says, robot in cases:
        s.refuses(why, code, says, robot)
    s.refuses('a universal joint with parallel axes', DATA, 'robot.xml:51:3: the two axes of joint \'wrist\' are parallel',
              ARM.replace('<joint name="wrist" type="continuous">', '<joint name="wrist" type="universal"><axis xyz="0 0 1"/>'
                          '<axis2 xyz="0 0 -2"/>'))
    s.write('large.xml', '<robot>' + ' ' * 50000000 + '</robot>')
    done = run(s.mech9k, '--import', 'large.xml', folder=s.folder)
    s.checks.true(done.returncode == DATA and 'too large' in done.stderr, 'a large file', done.stderr)
    os.remove(os.path.join(s.folder, 'large.xml'))
    done = run(s.mech9k, '--import', 'none.urdf', folder=s.folder)
    s.checks.true(done.returncode == FILE and 'none.urdf' in done.stderr, 'no file', done.stderr)


def check_command_line(s):
    """Standard output, files that are read, and options that contradict an import."""
    s.write('robot.xml', ARM)
    done = run(s.mech9k, '--import', 'robot.xml', '--quiet', folder=s.folder)
    s.checks.true(done.returncode == DONE and done.stderr == '' and '&pair' in done.stdout, 'to standard output, quietly', done.stderr)
    again = run(s.mech9k, '--import=robot.xml', '--out', '-', folder=s.folder)
    s.checks.equal(again.stdout, done.stdout, '--out - is standard output')
    s.write('robot.nml', '\ufeff\n ' + ARM)
    for why, name in (('a robot', 'robot.xml'), ('a robot behind a mark of its encoding', 'robot.nml')):
        done = run(s.mech9k, name, folder=s.folder)
        s.checks.true(done.returncode == DATA and f'{name}: this is XML' in done.stderr and '--import FILE --out' in done.stderr,
                      f'{why} in the place of a data file is told', done.stderr)
    s.imports('<robot><link name="a"/><link name="b"/><joint name="j" type="revolute"><parent link="a"/><child link="b"/></joint></robot>')
    s.checks.true('mech9k: 2 links, 1 coordinate, 0 closed chains; independent: 1' in s.said, 'one coordinate', s.said)
    s.write('robot.xml', ARM)
    for why, words, says in (
            ('over its input', ['--import', 'robot.xml', '--out', './robot.xml'], 'would overwrite'),
            ('with a data file', ['x.nml', '--import', 'robot.xml'], 'a data file is given beside --import'),
            ('with a run', ['--import', 'robot.xml', '--table', 't.dat'], 'leave --table out'),
            ('--out alone', ['x.nml', '--out', 'y.nml'], 'give one of them, too'),
            ('three files', ['--import', 'robot.xml', 'a', 'b'], 'a data file is given beside --import'),
            ('no file', ['--import'], '--import needs an argument: --import FILE [LOOPS]'),
            ('twice', ['--import', 'robot.xml', '--import', 'robot.xml'], 'more than once')):
        done = run(s.mech9k, *words, folder=s.folder)
        s.checks.true(done.returncode == USAGE and says in done.stderr, f'{why}: {says}', f'{done.returncode}: {done.stderr}')
    s.checks.equal(s.text('robot.xml'), ARM, 'the input is as it was')


if __name__ == '__main__':
    test_imports([check_arm, check_four_bar, check_freedoms, check_inertia, check_mimic, check_refusals, check_command_line],
                 [ARM, FOUR_BAR.replace('LOOP', LOOP)])
