"""Imported trees of links: one robot written as MJCF, URDF and SDF is one mechanism, and in MJCF the one that MuJoCo's compiler makes.

Links of random trees have several children, before and behind their own parts. The three formats must give the same accelerations and the
same places of points: nested bodies in MJCF against links and joints that are named in the others. MuJoCo tells masses, inertias, places
and accelerations for the MJCF; that part needs the Python package mujoco.

Compares the program with itself in part: accelerations of one robot in three formats; places are held against numpy.
"""
import math
import re

import numpy as np
import pytest

from imported import about, rpy
from mech9_cases import read_table, run, text_of

# Some ten rotations are multiplied, and numbers are written with 17 digits. Accelerations are solved from mass matrices whose conditioning is
# some 1e4: links of 0.3 to 3 kg with arms of some 0.5 m.
PLACES, ACCELERATIONS = 1e-13, 1e-11
# MuJoCo keeps principal axes by a quaternion and diagonalises by Jacobi's method down to 1e-12; its mjMINVAL is 1e-15.
MUJOCO = 1e-9
GRAVITY = (0.4, -0.3, -9.7)
SEEDS = range(12)


class Link:
    """A link of a random tree, its frame in the parent, its joint, its mass and a mark on it."""

    def __init__(self, number, parent, random):
        self.name, self.parent, self.children = f'b{number}', parent, []
        self.place, self.angles = random.uniform(-0.5, 0.5, 3), random.uniform(-1, 1, 3)
        # the root hangs on a joint, so that each robot moves
        self.kind = random.choice(['hinge', 'hinge', 'slide', 'fixed']) if parent else 'hinge'
        axis = random.normal(size=3)
        self.axis = axis / np.linalg.norm(axis)
        self.q, self.dq = random.uniform(-1, 1, 2)
        self.mass, self.centre = random.uniform(0.3, 3), random.uniform(-0.2, 0.2, 3)
        # the tensor of some points has moments that a body may have
        points = random.uniform(-0.3, 0.3, (6, 3))
        self.tensor = self.mass / 6 * sum(p @ p * np.eye(3) - np.outer(p, p) for p in points)
        self.mark = random.uniform(-0.3, 0.3, 3)
        self.order = random.permutation(2)              # children before or behind the link's own parts
        if parent:
            parent.children.append(self)

    def all(self):
        return [self, *(link for child in self.children for link in child.all())]


def random_tree(seed):
    random = np.random.default_rng(seed)
    links = [Link(0, None, random)]
    for number in range(1, 8):
        # few parents, so that most have several children
        links.append(Link(number, links[random.integers(0, min(number, 4))], random))
    return links[0]


def words(numbers):
    return ' '.join(f'{float(x)!r}' for x in np.ravel(numbers))


def moments(tensor):
    return dict(zip(('ixx', 'iyy', 'izz', 'ixy', 'ixz', 'iyz'), tensor[[0, 1, 2, 0, 0, 1], [0, 1, 2, 1, 2, 2]]))


def mjcf(root):
    def body(link):
        joint = f'<joint name="j{link.name}" type="{link.kind}" axis="{words(link.axis)}"/>' if link.kind != 'fixed' else ''
        own = (f'{joint}<inertial pos="{words(link.centre)}" mass="{link.mass!r}" fullinertia="{words(list(moments(link.tensor).values()))}"/>'
               f'<site name="m{link.name}" pos="{words(link.mark)}"/>')
        inner = [''.join(body(child) for child in link.children), own]
        # eulerseq XYZ: roll, pitch and yaw about fixed axes
        return f'<body name="{link.name}" pos="{words(link.place)}" euler="{words(link.angles)}">{inner[link.order[0]]}{inner[link.order[1]]}</body>\n'
    return (f'<mujoco><compiler angle="radian" eulerseq="XYZ"/><option gravity="{words(GRAVITY)}"/>'
            f'<worldbody>{body(root)}</worldbody></mujoco>')


def urdf(root):
    kinds = {'hinge': 'continuous', 'slide': 'prismatic', 'fixed': 'fixed'}
    text = '<link name="world"/>'
    for link in root.all():
        inertia = ' '.join(f'{name}="{float(value)!r}"' for name, value in moments(link.tensor).items())
        text += (f'<link name="{link.name}"><inertial><origin xyz="{words(link.centre)}"/><mass value="{link.mass!r}"/><inertia {inertia}/>'
                 f'</inertial></link><link name="m{link.name}"/>'
                 f'<joint name="f{link.name}" type="fixed"><parent link="{link.name}"/><child link="m{link.name}"/>'
                 f'<origin xyz="{words(link.mark)}"/></joint>'
                 f'<joint name="j{link.name}" type="{kinds[link.kind]}"><parent link="{link.parent.name if link.parent else "world"}"/>'
                 f'<child link="{link.name}"/><origin xyz="{words(link.place)}" rpy="{words(link.angles)}"/><axis xyz="{words(link.axis)}"/></joint>\n')
    return f'<robot name="tree">{text}</robot>'


def sdf(root):
    kinds = {'hinge': 'revolute', 'slide': 'prismatic', 'fixed': 'fixed'}
    text = ''
    for link in root.all():
        inertia = ''.join(f'<{name}>{float(value)!r}</{name}>' for name, value in moments(link.tensor).items())
        parent = link.parent.name if link.parent else '__model__'
        none = '<inertial><mass>0</mass><inertia><ixx>0</ixx><iyy>0</iyy><izz>0</izz></inertia></inertial>'
        text += (f'<link name="{link.name}"><pose relative_to="{parent}">{words(link.place)} {words(link.angles)}</pose>'
                 f'<inertial><pose>{words(link.centre)} 0 0 0</pose><mass>{link.mass!r}</mass><inertia>{inertia}</inertia></inertial></link>'
                 f'<link name="m{link.name}"><pose relative_to="{link.name}">{words(link.mark)} 0 0 0</pose>{none}</link>'
                 f'<joint name="f{link.name}" type="fixed"><parent>{link.name}</parent><child>m{link.name}</child></joint>'
                 f'<joint name="j{link.name}" type="{kinds[link.kind]}"><parent>{link.parent.name if link.parent else "world"}</parent>'
                 f'<child>{link.name}</child><axis><xyz>{words(link.axis)}</xyz></axis></joint>\n')
    return (f'<sdf version="1.9"><world name="w"><gravity>{words(GRAVITY)}</gravity><model name="tree">{text}</model></world></sdf>')


def imported(checks, mech9d, folder, robot, why):
    (folder / 'robot.xml').write_text(robot, encoding='utf-8')
    done = run(mech9d, '--import', 'robot.xml', '--out', 'out.nml', folder=folder)
    checks.equal(done.returncode, 0, f'{why}: imported: {done.stderr}')
    return text_of(folder / 'out.nml')


def coordinates_of(data):
    """Numbers of the coordinates by the names of joints."""
    return {name: int(number) for name, number in re.findall(r'! joint (\w+)[^\n]*\n&pair\s+coordinate ?= ?(\d+)', data)}


def motion_of(checks, mech9d, folder, data, root, why):
    """Accelerations of joints, and places, velocities and accelerations of marks, from a run of the imported file."""
    numbers = coordinates_of(data)
    moving = [link for link in root.all() if link.kind != 'fixed']
    checks.equal(sorted(numbers), sorted(f'j{link.name}' for link in moving), f'{why}: the joints')
    data = re.sub(r'&initial[^\n]*\n', '', re.sub(r'&gravity[^\n]*\n', '', data))
    for link in moving:
        data += f'&initial coordinate={numbers["j" + link.name]}, position={float(link.q)!r}, velocity={float(link.dq)!r} /\n'
    data += f'&gravity acceleration={", ".join(map(repr, GRAVITY))} /\n&time end=0.001, intervals=1 /\n'
    (folder / 'run.nml').write_text(data, encoding='utf-8')
    done = run(mech9d, 'run.nml', '--table', '-', folder=folder)
    checks.equal(done.returncode, 0, f'{why}: a run: {done.stderr}')
    table = read_table(done.stdout)
    return (np.array([table[f'ddq{numbers["j" + link.name]}'][0] for link in moving]),
            np.array([[[table[f'm{link.name}.{order}{c}'][0] for c in 'xyz'] for order in ('', 'v', 'a')] for link in root.all()]))


@pytest.mark.parametrize('seed', SEEDS)
def test_three_formats_are_one_robot(checks, mech9d, tmp_path, seed):
    root = random_tree(seed)
    found = {}
    for name, robot in (('MJCF', mjcf(root)), ('URDF', urdf(root)), ('SDF', sdf(root))):
        found[name] = motion_of(checks, mech9d, tmp_path, imported(checks, mech9d, tmp_path, robot, name), root, name)
    places = [place_of(link) for link in root.all()]
    for name, (accelerations, marks) in found.items():
        checks.near(marks[:, 0], places, PLACES, f'{name}: places of marks as the file tells them', scale=1.0)
        checks.near(accelerations, found['URDF'][0], ACCELERATIONS, f'{name}: accelerations of the joints', scale=abs(found['URDF'][0]).max())
        checks.near(marks, found['URDF'][1], ACCELERATIONS, f'{name}: motion of marks', scale=abs(found['URDF'][1]).max())


def place_of(link):
    """The place of the mark of a link, by numpy from the tree itself."""
    point = link.mark
    while link:
        if link.kind == 'hinge':
            point = about(link.axis, link.q) @ point
        elif link.kind == 'slide':
            point = link.q * link.axis + point
        point = link.place + rpy(link.angles) @ point
        link = link.parent
    return point


@pytest.mark.parametrize('seed', SEEDS)
def test_trees_are_those_of_mujoco(checks, mech9d, tmp_path, seed):
    mujoco = pytest.importorskip('mujoco', reason='the Python package mujoco is not installed (pip install mujoco)')
    root = random_tree(seed)
    data = imported(checks, mech9d, tmp_path, mjcf(root), 'MJCF')
    accelerations, marks = motion_of(checks, mech9d, tmp_path, data, root, 'MJCF')
    model = mujoco.MjModel.from_xml_string(mjcf(root))
    compare_bodies(checks, data, model, [link.name for link in root.all() if not any(child.kind == 'fixed' for child in link.children)
                                         and link.kind != 'fixed'])
    state = mujoco.MjData(model)
    moving = [link for link in root.all() if link.kind != 'fixed']
    for link in moving:
        state.joint(f'j{link.name}').qpos, state.joint(f'j{link.name}').qvel = link.q, link.dq
    mujoco.mj_forward(model, state)
    theirs = np.array([state.joint(f'j{link.name}').qacc[0] for link in moving])
    checks.near(accelerations, theirs, MUJOCO, 'accelerations of joints', scale=abs(theirs).max())
    checks.near(marks[:, 0], [state.site(f'm{link.name}').xpos for link in root.all()], PLACES, 'places of marks', scale=1.0)


def compare_bodies(checks, data, model, names):
    """Mass, mass centre and inertia of links against those of bodies of MuJoCo."""
    for name in names:
        group = re.search(rf'! link {name}\n&body\s([^/]*)/', data)
        if not checks.true(group, f'{name} has a body', data):
            continue
        values = {key: np.array([float(word) for word in text.split(',') if word.strip()])
                  for key, text in re.findall(r'(\w+) ?= ?([-+\d.e, ]*)', group.group(1))}
        body = model.body(name)
        checks.near(values['mass'], body.mass, PLACES, f'{name}: mass')
        checks.near(values['centre'], body.ipos, PLACES * 10, f'{name}: mass centre', scale=1.0)
        r = quaternion(body.iquat)
        theirs = r @ np.diag(body.inertia) @ r.T
        checks.near(values['inertia'], list(moments(theirs).values()), MUJOCO, f'{name}: inertia', scale=abs(theirs).max())


def quaternion(q):
    angle = 2 * math.atan2(np.linalg.norm(q[1:]), q[0])
    return about(q[1:] / np.linalg.norm(q[1:]), angle) if np.linalg.norm(q[1:]) > 0 else np.eye(3)


# Shapes, defaults, frames, several joints in a body and references, each behind a first child with joints.
SHAPES = """<mujoco>
  <compiler angle="degree" eulerseq="zYx"/>
  <option gravity="0.4 -0.3 -9.7"><flag contact="disable"/></option>
  <default><joint axis="0 1 0"/><geom density="800"/>
    <default class="heavy"><geom density="2500" type="box" size="0.05 0.1 0.2"/><joint damping="0.4"/></default></default>
  <worldbody>
    <body name="left" pos="0.1 0.2 0.3" euler="20 -30 40">
      <joint name="l1" pos="0.02 0.01 0" ref="15"/>
      <body name="upper" pos="0.1 0 0.2" quat="0.8 0.1 -0.3 0.5" childclass="heavy">
        <joint name="u1" stiffness="3" springref="20"/>
        <joint name="u2" type="slide" axis="1 2 0.5" ref="0.05"/>
        <body name="tip" pos="0 0.3 0"><joint name="t1" axis="1 0 0"/><geom pos="0 0.1 0"/></body>
        <geom pos="0.1 0 0.1" axisangle="1 1 0 30"/>
        <site name="s1" pos="0.1 0.2 0.3"/>
      </body>
      <geom type="capsule" size="0.03" fromto="0 0 0 0.2 0.3 0.1" mass="0.7"/>
      <frame pos="0.1 0 0.4" euler="10 0 0">
        <body name="inner" pos="0 0.1 0" xyaxes="0 1 0 -1 0 0.2"><joint name="i1"/><geom type="cylinder" size="0.04 0.2"/>
          <body name="last" pos="0 0 0.3"><joint name="e1" axis="1 1 0"/><geom type="ellipsoid" size="0.05 0.08 0.1"/></body>
          <site name="s2" pos="0 0 0.2"/>
        </body>
        <geom type="sphere" size="0.1" pos="0 0.1 0"/>
      </frame>
      <site name="s3" pos="0.1 0.1 0"/>
    </body>
    <body name="told" pos="0.3 0.3 0"><joint name="d1" axis="1 0 0"/><inertial pos="0 0.2 0" mass="0.5" diaginertia="0.01 0.02 0.025"/>
      <frame pos="0.1 0 0"><geom size="0.1"/><frame pos="0 0.1 0" euler="0 0 30"><joint name="d2" pos="0 0 0.2" axis="1 0 0"/></frame><frame euler="0 20 0"><geom class="heavy"/></frame></frame>
    </body>
    <body name="framed" pos="0.3 -0.3 0"><frame pos="0.1 0 0" euler="10 20 30"><joint name="f1" type="slide" axis="0 1 0"/>
      <inertial pos="0 0.2 0" mass="0.5" diaginertia="0.01 0.02 0.025" euler="5 0 0"/></frame><geom size="0.2"/></body>
    <body name="right" pos="-0.4 0 0" zaxis="1 0.2 0.3">
      <body name="arm" pos="0 0 0.2"><joint name="a1"/><geom size="0.08"/></body>
      <joint name="r1" axis="0 0 1"/>
      <geom type="box" size="0.1 0.05 0.02" pos="0.1 0 0"/>
      <site name="s4" pos="0 0 0.1"/>
    </body>
  </worldbody>
</mujoco>
"""


def test_shapes_behind_children_are_those_of_mujoco(checks, mech9d, tmp_path):
    mujoco = pytest.importorskip('mujoco', reason='the Python package mujoco is not installed (pip install mujoco)')
    data = imported(checks, mech9d, tmp_path, SHAPES, 'shapes')
    model = mujoco.MjModel.from_xml_string(SHAPES)
    compare_bodies(checks, data, model, ['left', 'upper', 'tip', 'inner', 'last', 'told', 'framed', 'right', 'arm'])
    numbers = coordinates_of(data)
    state = mujoco.MjData(model)
    values = np.random.default_rng(1).uniform(-1, 1, (2, model.njnt))
    data = re.sub(r'&initial[^\n]*\n', '', data)
    for i in range(model.njnt):
        joint = model.joint(i)
        state.qpos[i], state.qvel[i] = values[:, i]
        data += f'&initial coordinate={numbers[joint.name]}, position={values[0, i]!r}, velocity={values[1, i]!r} /\n'
    mujoco.mj_forward(model, state)
    (tmp_path / 'run.nml').write_text(data + '&time end=0.001, intervals=1 /\n', encoding='utf-8')
    done = run(mech9d, 'run.nml', '--table', '-', folder=tmp_path)
    checks.equal(done.returncode, 0, f'a run: {done.stderr}')
    table = read_table(done.stdout)
    ours = [table[f'ddq{numbers[model.joint(i).name]}'][0] for i in range(model.njnt)]
    checks.near(ours, state.qacc, MUJOCO, 'accelerations', scale=abs(state.qacc).max())
    for i in range(model.nsite):
        name = model.site(i).name
        checks.near([table[f'{name}.{c}'][0] for c in 'xyz'], state.site(name).xpos, PLACES, f'place of {name}', scale=1.0)
