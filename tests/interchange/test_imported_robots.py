"""Robots that are imported: positions of frames, forces of drives and energies against a recursion of Newton and Euler over all links of
the robot's own file, which is written here in numpy; closed chains against closed forms; joints with several freedoms against
falling and turning bodies; refusals with file, line and column; files that are cut, changed or hostile.
"""
import os
import re
import xml.etree.ElementTree as ElementTree

import numpy as np
import pytest

from imported import ASSEMBLY, DATA, DONE, FILE, ROUND_OFF, STRUCTURE, USAGE, about, rpy
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


def driven_arm(session):
    """The data file of the arm whose coordinates move by their laws."""
    data = session.imports(ARM, name='arm.urdf')
    for k, law in enumerate(LAWS, 1):
        data = data.replace(f"&drive coordinate={k}, kind='polynomial', coefficients=0 /",
                            f"&drive coordinate={k}, kind='polynomial', coefficients={', '.join(f'{c!r}' for c in law.tolist())} /")
    return data + '&time end=1, intervals=4 /\n&output drive_forces=.true. /\n'


def test_arm_by_newton_and_euler(session):
    """An open chain with fixed joints, a tool without mass, and general axes."""
    data = driven_arm(session)
    found = session.table(session.mech9d, data)
    for row, t in enumerate(found['t']):
        bodies, forces, kinetic, potential, dq = arm_by_newton_euler(t)
        for name, link in (('plate', 'plate'), ('tool_0', 'tool 0')):
            body = bodies[link]
            for prefix, vector in (('', body.p), ('v', body.v), ('a', body.a)):
                session.checks.near([found[f'{name}.{prefix}{c}'][row] for c in 'xyz'], vector, 10 * ROUND_OFF,
                                    f'{prefix or "p"} of {link} at t = {t}', scale=1.0)
        forces[0] += 0.3 * dq[0]
        session.checks.near([found[f'F{k}'][row] for k in (1, 2, 3)], forces, 100 * ROUND_OFF, f'forces of drives at t = {t}', scale=10.0)
        session.checks.near(found['E.kinetic'][row], kinetic, 100 * ROUND_OFF, f'kinetic energy at t = {t}')
    _, _, _, first, _ = arm_by_newton_euler(found['t'][0])
    _, _, _, last, _ = arm_by_newton_euler(found['t'][-1])
    session.checks.near(found['E.potential'][-1] - found['E.potential'][0], last - first, 100 * ROUND_OFF, 'potential energy', scale=10.0)


def test_notes_and_comments_of_the_arm(session):
    data = driven_arm(session)
    for note in ('arm.urdf:10: not taken over: <visual> of links', 'arm.urdf:38: not taken over: ranges of joints',
                 "the friction of joint 'shoulder'"):
        session.checks.true(note in session.said, f'told: {note}', session.said)
        session.checks.true(note.split('not taken over: ')[-1] in data, f'in the data file: {note}')
    for comment in ('! joint shoulder, range -1.5 to 1.5', '! Link 2: upper', "title='Arm ''ä'''"):
        session.checks.true(comment in data, comment, data)


def test_mech9d_gets_initial_values_and_no_drives(session):
    free = session.imports(ARM, program=session.mech9d)
    session.checks.true('&drive' not in free and free.count('&initial') == 3, 'mech9d: initial values and no drives', free)
    session.table(session.mech9d, free)


def with_second_parent():
    """The four-bar whose rocker is a link that has a parent."""
    moved = FOUR_BAR.replace('<child link="rocker"/><origin xyz="0.6 0 0"/>', '<child link="stub"/><origin xyz="0.6 0 0"/>')
    moved = moved.replace('<link name="rocker"/>', '<link name="rocker"/><link name="stub"/>')
    return moved.replace('LOOP', SECOND_PARENT + """<joint name="end" type="fixed"><parent link="rocker"/><child link="stub2"/>
      <origin xyz="-0.4 0 0"/></joint><link name="stub2"/>""").replace('child link="stub"', 'child link="stub2"').replace(
          '<link name="stub"/>', '')


@pytest.mark.parametrize('why, robot, loops', (
    ('in the file', FOUR_BAR.replace('LOOP', LOOP), None), ('beside the file', FOUR_BAR.replace('LOOP', ''), f'<loops>{LOOP}</loops>'),
    ('as a second parent', with_second_parent(), None)), ids=('in the file', 'beside the file', 'as a second parent'))
def test_loop_of_a_four_bar(session, why, robot, loops):
    """A closed chain, its loop in the same file, beside it, or as a second parent: angles of a four-bar from its diagonal."""
    data = session.imports(robot, loops)
    session.checks.true('cq=1 ' in data, f'{why}: the crank is independent', data)
    found = session.table(session.mech9k, re.sub('coefficients=[^ ]*', 'coefficients=0.3, 6', data))
    rockers = [k for k in (1, 2, 3, 4) if f'coordinate={k}, links=1, 3,' in data or f'coordinate={k}, links=1, 4,' in data]
    crank, rocker = found['q1'], found[f'q{rockers[-1]}']
    # the distance of the ends of crank and rocker is the coupler
    gap = np.hypot(0.6 + 0.4 * np.cos(rocker) - 0.2 * np.cos(crank), 0.4 * np.sin(rocker) - 0.2 * np.sin(crank)) - 0.5
    session.checks.near(gap, 0.0, ROUND_OFF, f'{why}: the coupler keeps its length')


def test_the_file_chooses_the_independent_coordinate(session):
    data = session.imports(FOUR_BAR.replace('LOOP', LOOP).replace('name="C" type', 'name="C" independent="true" type'))
    session.checks.true('cq=2 ' in data, 'the file chooses the independent coordinate', data)


def test_a_start_beside_a_singularity(session):
    # a parallelogram that is straight at zero
    flat = FOUR_BAR.replace('LOOP', LOOP).replace('0.2 0 0', '0.4 0 0').replace('"0.5 0 0"', '"0.6 0 0"')
    data = session.imports(flat)
    session.checks.true("position is singular; the start lies beside it" in session.said and 'coefficients=0.3' in data, 'a start beside a singularity',
                        session.said)
    session.table(session.mech9k, re.sub('coefficients=[^ ]*', 'coefficients=0.3, 2', data))


def test_a_stroke_starts_in_its_range(session):
    lift = text_of(os.path.join(TREE, 'examples', 'hydraulic_lift', 'lift.urdf'))
    data = session.imports(lift)
    # a range without zero: its middle is the start
    session.checks.true('coefficients=0.85' in data, 'the stroke starts in its range', data)


# A body on a joint with several freedoms.
BODY = '<link name="w"/><link name="b"><inertial><mass value="2"/><inertia ixx="1" iyy="2" izz="2.5"/></inertial></link>'
JOINT = '<joint name="j" type="{}"><parent link="w"/><child link="b"/><origin xyz="0 0 1"/><axis xyz="0 0 1"/></joint>'


def test_a_floating_joint(session):
    """A body that is thrown and spins about a principal axis."""
    data = session.imports(f'<robot>{BODY}{JOINT.format("floating")}</robot>', program=session.mech9d)
    data = data.replace('&initial coordinate=1, position=0 /', '&initial coordinate=1, position=0, velocity=3 /')
    data = data.replace('&initial coordinate=6, position=0 /', '&initial coordinate=6, position=0, velocity=2 /')
    found = session.table(session.mech9d, data)
    t = found['t']
    session.checks.near(found['b.x'], 3 * t, 1e-8, 'floating: thrown')
    session.checks.near(found['b.z'], 1 - 4.905 * t**2, 1e-8, 'floating: it falls')
    session.checks.near(found['q6'], 2 * t, 1e-8, 'floating: it spins')


def test_a_planar_joint(session):
    data = session.imports(f'<robot>{BODY}{JOINT.format("planar")}</robot>', program=session.mech9d)
    found = session.table(session.mech9d, data)
    session.checks.true("'planar'" in data and data.count('&pair') == 1, 'planar: one pair', data)
    session.checks.near(found['b.z'], 1.0, ROUND_OFF, 'planar: it stays in its plane')


TOOL = '<link name="t"/><joint name="f" type="fixed"><parent link="b"/><child link="t"/><origin xyz="0.3 0.2 0.1"/></joint>'
LOOP_JOINT = ('<loop name="j" type="{}"><predecessor link="w"><origin xyz="0 0 1" rpy="0.3 0.4 0.5"/></predecessor><successor link="b">'
              '<origin xyz="0.1 0 0" rpy="{}"/></successor><axis xyz="0 0.6 0.8"/><axis2 xyz="1 0 0"/></loop>')
Q = [0.3, -0.4, 0.7, 0.2, 0.5, -0.6]


def motions():
    """Turn and place of the moving system of joints, by their kinds, at the coordinates Q."""
    axis, x, y, z = np.array([0, 0.6, 0.8]), *np.eye(3)
    sides = np.array([1.0, 0, 0]), np.array([0, 0.8, -0.6])
    return {
        'spherical': (about(x, Q[0]) @ about(y, Q[1]) @ about(z, Q[2]), 0 * x),
        'universal': (about(axis, Q[0]) @ about(x, Q[1]), 0 * x),
        'cylindrical': (about(axis, Q[0]), Q[1] * axis),
        'planar': (about(axis, Q[2]), Q[0] * sides[0] + Q[1] * sides[1]),
        'free': (about(x, Q[3]) @ about(y, Q[4]) @ about(z, Q[5]), np.array(Q[:3]))}


@pytest.mark.parametrize('turned', ('0 0 0.9', '0.3 0.4 0.5'))
@pytest.mark.parametrize('kind', ('spherical', 'universal', 'cylindrical', 'planar', 'free'))
def test_place_of_a_point_on_a_joint_with_several_freedoms(session, kind, turned):
    """The place of a point of the body after all turns and slides of its joint, in general frames."""
    r, p = motions()[kind]
    data = session.imports(f'<robot>{BODY}{TOOL}' + LOOP_JOINT.format(kind, turned) + '</robot>')
    for k, value in enumerate(Q, 1):
        data = data.replace(f"&drive coordinate={k}, kind='polynomial', coefficients=0 /",
                            f"&drive coordinate={k}, kind='polynomial', coefficients={value} /")
    split = kind == 'universal' and turned == '0 0 0.9'
    session.checks.equal(data.count('&pair'), 2 if split else 1, f'{kind}: pairs')
    found = session.table(session.mech9k, data, '--set', 'time.intervals=1')
    inner = rpy([float(word) for word in turned.split()])
    point = inner.T @ (np.array([0.3, 0.2, 0.1]) - (0.1, 0, 0))
    session.checks.near([found[f't.{c}'][0] for c in 'xyz'], (0, 0, 1) + rpy((0.3, 0.4, 0.5)) @ (p + r @ point), 10 * ROUND_OFF,
                        f'{kind}: place of a point', scale=1.0)


# The wrist follows the shoulder.
MIMIC = ARM.replace('<parent link="slider"/>', '<mimic joint="shoulder" multiplier="2" offset="0.3"/><parent link="slider"/>')


def test_a_joint_that_follows_another_one(session):
    """It is coupled to that one, and dependent."""
    data = session.imports(MIMIC)
    session.checks.true("&coupling kind='linear', coordinates=3, 1, coefficients=1, -2, constant=0.3 /" in data, 'mimic is a coupling', data)
    session.checks.true('cq=1, 2 ' in data, 'the joint that follows is dependent', data)
    found = session.table(session.mech9k, re.sub('(coordinate=1, .*)coefficients=[^ ]*', r'\1coefficients=0.1, 0.5', data))
    session.checks.near(found['q3'], 2 * found['q1'] + 0.3, ROUND_OFF, 'it follows')


@pytest.mark.parametrize('why, code, says, robot', (
    ('a joint that follows itself', DATA, "joint 'wrist' follows itself", MIMIC.replace('mimic joint="shoulder"', 'mimic joint="wrist"')),
    ('a joint that follows with 0', DATA, "joint 'wrist' follows joint 'shoulder' with the factor 0 and cannot move",
     MIMIC.replace('multiplier="2"', 'multiplier="0"')),
    ('joints that hold each other', STRUCTURE, 'the robot cannot move: its closed chains and the joints that follow others',
     MIMIC.replace('<joint name="shoulder" type="revolute">', '<joint name="shoulder" type="revolute"><mimic joint="wrist" multiplier="3"/>')
     .replace('<joint name="slide" type="prismatic">', '<joint name="slide" type="fixed">'))), ids=('itself', 'with 0', 'each other'))
def test_joints_that_cannot_follow(session, why, code, says, robot):
    session.refuses(why, code, says, robot)


def test_a_joint_that_does_not_move_leads_none(session):
    session.imports(MIMIC.replace('mimic joint="shoulder"', 'mimic joint="flange"'))
    session.checks.true("the coupling of joint 'wrist' with joint 'flange'" in session.said, 'a joint that does not move leads none', session.said)


def test_an_inertia_that_no_body_has(session):
    """It is left out and told; the rest is taken over."""
    data = session.imports(ARM.replace('iyy="0.002"', 'iyy="0.2"'))
    session.checks.true("the inertia of link 'hand'" in session.said and 'robot.xml:26' in session.said, 'an impossible inertia is told', session.said)
    session.checks.true('mass=0.4' in data.replace(' = ', '='), 'its mass is taken over', data)
    session.table(session.mech9k, data)


# Files that are no robots, each with its place.
REFUSED = (
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
    ('a universal joint with parallel axes', DATA, 'robot.xml:51:3: the two axes of joint \'wrist\' are parallel',
     ARM.replace('<joint name="wrist" type="continuous">', '<joint name="wrist" type="universal"><axis xyz="0 0 1"/>'
                 '<axis2 xyz="0 0 -2"/>')))


@pytest.mark.parametrize('why, code, says, robot', REFUSED, ids=[case[0] for case in REFUSED])
def test_refused(session, why, code, says, robot):
    session.refuses(why, code, says, robot)


def test_a_large_file(session):
    session.write('large.xml', '<robot>' + ' ' * 50000000 + '</robot>')
    done = run(session.mech9k, '--import', 'large.xml', folder=session.folder)
    session.checks.true(done.returncode == DATA and 'too large' in done.stderr, 'a large file', done.stderr)
    os.remove(os.path.join(session.folder, 'large.xml'))


def test_no_file(session):
    done = run(session.mech9k, '--import', 'none.urdf', folder=session.folder)
    session.checks.true(done.returncode == FILE and 'none.urdf' in done.stderr, 'no file', done.stderr)


def test_standard_output(session):
    session.write('robot.xml', ARM)
    done = run(session.mech9k, '--import', 'robot.xml', '--quiet', folder=session.folder)
    session.checks.true(done.returncode == DONE and done.stderr == '' and '&pair' in done.stdout, 'to standard output, quietly', done.stderr)
    again = run(session.mech9k, '--import=robot.xml', '--out', '-', folder=session.folder)
    session.checks.equal(again.stdout, done.stdout, '--out - is standard output')


@pytest.mark.parametrize('why, name, text', (
    ('a robot', 'robot.xml', ARM), ('a robot behind a mark of its encoding', 'robot.nml', '\ufeff\n ' + ARM)), ids=('plain', 'behind a mark'))
def test_a_robot_in_the_place_of_a_data_file(session, why, name, text):
    session.write(name, text)
    done = run(session.mech9k, name, folder=session.folder)
    session.checks.true(done.returncode == DATA and f'{name}: this is XML' in done.stderr and '--import FILE --out' in done.stderr,
                        f'{why} in the place of a data file is told', done.stderr)


def test_one_coordinate_is_told(session):
    session.imports('<robot><link name="a"/><link name="b"/><joint name="j" type="revolute"><parent link="a"/><child link="b"/></joint></robot>')
    session.checks.true('mech9k: 2 links, 1 coordinate, 0 closed chains; independent: 1' in session.said, 'one coordinate', session.said)


@pytest.mark.parametrize('why, words, says', (
    ('over its input', ['--import', 'robot.xml', '--out', './robot.xml'], 'would overwrite'),
    ('with a data file', ['x.nml', '--import', 'robot.xml'], 'a data file is given beside --import'),
    ('with a run', ['--import', 'robot.xml', '--table', 't.dat'], 'leave --table out'),
    ('--out alone', ['x.nml', '--out', 'y.nml'], 'give one of them, too'),
    ('three files', ['--import', 'robot.xml', 'a', 'b'], 'a data file is given beside --import'),
    ('no file', ['--import'], '--import needs an argument: --import FILE [LOOPS]'),
    ('twice', ['--import', 'robot.xml', '--import', 'robot.xml'], 'more than once')),
    ids=('over its input', 'with a data file', 'with a run', 'out alone', 'three files', 'no file', 'twice'))
def test_options_that_contradict_an_import(session, why, words, says):
    session.write('robot.xml', ARM)
    done = run(session.mech9k, *words, folder=session.folder)
    session.checks.true(done.returncode == USAGE and says in done.stderr, f'{why}: {says}', f'{done.returncode}: {done.stderr}')
    session.checks.equal(session.text('robot.xml'), ARM, 'the input is as it was')


def test_robots_that_are_damaged(session):
    session.survives([ARM, FOUR_BAR.replace('LOOP', LOOP)])
