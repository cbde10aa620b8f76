"""Robots in MJCF that are imported: orientations and places against numpy, masses of shapes against integrals of their sections, closed
chains by <connect> and <weld> against closed forms; refusals; files that are cut or changed.
"""
import math
import os
import re

import numpy as np
import pytest

from imported import DATA, DONE, FILE, ROUND_OFF, USAGE, about
from mech9_cases import run

# All ways to tell an orientation, classes of defaults, a frame, two joints in one body, references, shapes.
MJCF = """<mujoco model="shapes">
  <compiler angle="degree" eulerseq="zYx"/>
  <option gravity="0 0.5 -9.7" timestep="0.001"/>
  <default>
    <joint damping="0.2" axis="0 1 0"/>
    <geom density="800"/>
    <default class="heavy">
      <geom density="2500" type="box"/>
      <joint stiffness="3" springref="20"/>
      <default class="round"><geom type="cylinder" size="0.04 0.2"/></default>
    </default>
  </default>
  <worldbody>
    <light pos="0 0 3"/>
    <geom type="plane" size="1 1 0.1"/>
    <body name="base" pos="0.1 0.2 0.3" euler="20 -30 40">
      <geom type="box" size="0.1 0.1 0.1"/>
      <body name="upper" pos="0.1 0 0.2" quat="0.8 0.1 -0.3 0.5" childclass="heavy">
        <joint name="turn" pos="0.02 0.01 0" range="-90 90" ref="15"/>
        <joint name="slide" type="slide" axis="1 2 0.5" ref="0.05" damping="1.5"/>
        <geom size="0.05 0.1 0.2" pos="0.1 0 0.1" axisangle="1 1 0 30"/>
        <geom class="round" pos="0 0.1 0" zaxis="1 0.2 0.3"/>
        <geom type="capsule" size="0.03" fromto="0 0 0 0.2 0.3 0.1" mass="0.7"/>
        <site name="first" pos="0.1 0.2 0.3"/>
        <frame pos="0.1 0 0.4" euler="10 0 0">
          <body name="hand" pos="0 0.1 0" xyaxes="0 1 0 -1 0 0.2">
            <joint name="wrist" axis="0 0 1" frictionloss="0.1" armature="0.02"/>
            <inertial pos="0.05 0.02 0" mass="0.9" diaginertia="0.003 0.004 0.005" euler="5 10 15"/>
            <geom type="sphere" size="0.2"/>
            <body name="ball" pos="0.2 0 0">
              <joint name="ball" type="ball" pos="0.01 0 0"/>
              <geom type="ellipsoid" size="0.05 0.08 0.1" euler="30 0 60"/>
              <geom type="sphere" size="0.07" pos="0.1 0 0"/>
              <site name="tip" pos="0 0 0.2"/>
            </body>
          </body>
        </frame>
      </body>
    </body>
  </worldbody>
  <actuator><motor joint="turn"/></actuator>
</mujoco>
"""
MJCF_FOUR_BAR = """<mujoco model="four-bar">
  <compiler angle="radian"/>
  <worldbody>
    <body name="crank"><joint name="O"/><geom type="capsule" size="0.01" fromto="0 0 0 0.2 0 0"/>
      <body name="coupler" pos="0.2 0 0" euler="0 0 0.9351"><joint name="A"/><geom size="0.1"/></body>
    </body>
    <body name="rocker" pos="0.6 0 0" euler="0 0 1.7"><joint name="C"/><geom size="0.1"/></body>
  </worldbody>
  <equality>CLOSING</equality>
</mujoco>
"""


def moments_by_quadrature(inside, box, n=60):
    """Volume, centre and tensor for a density of one of a shape along z, by sums over cells that Gauss' rule makes fine."""
    x, w = np.polynomial.legendre.leggauss(n)
    z, dz = box * x, box * w
    total, moments = 0.0, np.zeros(3)
    for at, step in zip(z, dz):
        a, b = inside(at)                                      # half axes of the elliptic or rectangular section
        area = math.pi * a * b
        total += area * step
        moments += area * step * np.array([b * b / 4 + at * at, a * a / 4 + at * at, (a * a + b * b) / 4])
    return total, moments / total


def solids():
    """Volume and moments by their mass of the shapes of MJCF, from integrals of their sections along z."""
    cylinder = moments_by_quadrature(lambda z: (0.04, 0.04), 0.2)
    ellipsoid = moments_by_quadrature(lambda z: (0.05 * math.sqrt(1 - (z / 0.1)**2), 0.08 * math.sqrt(1 - (z / 0.1)**2)), 0.1)
    sphere = moments_by_quadrature(lambda z: (math.sqrt(0.07**2 - z * z),) * 2, 0.07)
    half = math.sqrt(0.14) / 2                                 # the capsule in three parts: its section has two corners
    middle = moments_by_quadrature(lambda z: (0.03, 0.03), half)
    total, sums = middle[0], middle[0] * middle[1]
    x, w = np.polynomial.legendre.leggauss(40)
    for side in (-1, 1):
        for at, step in zip(0.015 + 0.015 * x, 0.015 * w):
            square, z = 0.03**2 - at * at, side * (half + at)
            total += math.pi * square * step
            sums = sums + math.pi * square * step * np.array([square / 4 + z * z, square / 4 + z * z, square / 2])
    box = (8 * 0.05 * 0.1 * 0.2, np.array([0.1**2 + 0.2**2, 0.05**2 + 0.2**2, 0.05**2 + 0.1**2]) / 3)
    return {'cylinder': cylinder, 'ellipsoid': ellipsoid, 'sphere': sphere, 'capsule': (total, sums / total), 'box': box}


def joined(parts):
    """Mass, centre and tensor of parts: (mass, centre, rotation, moments by mass)."""
    mass = sum(part[0] for part in parts)
    centre = sum(part[0] * np.asarray(part[1]) for part in parts) / mass
    tensor = np.zeros((3, 3))
    for m, c, r, moments in parts:
        d = np.asarray(c) - centre
        tensor += m * (r @ np.diag(moments) @ r.T + d @ d * np.eye(3) - np.outer(d, d))
    return mass, centre, tensor


def along(direction):
    """The shortest turn that takes z to a direction."""
    d = np.asarray(direction, float) / np.linalg.norm(direction)
    axis = np.cross([0, 0, 1], d)
    return about(axis / np.linalg.norm(axis), math.acos(d[2]))


def quaternion(w, x, y, z):
    n = w * w + x * x + y * y + z * z
    return np.array([[w*w + x*x - y*y - z*z, 2*(x*y - w*z), 2*(x*z + w*y)],
                     [2*(x*y + w*z), w*w - x*x + y*y - z*z, 2*(y*z - w*x)],
                     [2*(x*z - w*y), 2*(y*z + w*x), w*w - x*x - y*y + z*z]]) / n


def zyx(*angles):
    """eulerseq zYx: z, then Y about the fixed axis, then x about the turned one."""
    a, b, c = np.radians(angles)
    return about([0, 1, 0], b) @ about([0, 0, 1], a) @ about([1, 0, 0], c)


def value_in(data, group, name):
    """The numbers of a name in a group of the data file."""
    return np.array([float(word) for word in re.search(rf'\b{name} ?= ?([-+0-9.e, ]*)', group).group(1).strip(' ,').split(',')])


def check_bodies(session, data, expected):
    """Mass, centre and tensor of links by the comments over their bodies."""
    for name, (mass, centre, tensor) in expected.items():
        group = re.search(rf'! link {name}\n(&body.*?\n?/)', data, re.S).group(1)
        found = value_in(data, group, 'inertia')
        session.checks.near(value_in(data, group, 'mass'), mass, 10 * ROUND_OFF, f'mass of {name}')
        session.checks.near(value_in(data, group, 'centre'), centre, 10 * ROUND_OFF, f'centre of {name}', scale=0.1)
        session.checks.near(found, [tensor[0, 0], tensor[1, 1], tensor[2, 2], tensor[0, 1], tensor[0, 2], tensor[1, 2]], 10 * ROUND_OFF,
                            f'inertia of {name}', scale=abs(tensor).max())


def test_bodies_joints_and_shapes(session):
    """Places of sites, masses from shapes, springs."""
    data = session.imports(MJCF, program=session.mech9d, name='robot.xml')
    solid = solids()
    round_, box = about([1, 0, 0], 0), about(np.array([1, 1, 0]) / math.sqrt(2), math.radians(30))
    parts = [(2500 * solid['box'][0], (0.1, 0, 0.1), box, solid['box'][1]),
             (2500 * solid['cylinder'][0], (0, 0.1, 0), along((1, 0.2, 0.3)), solid['cylinder'][1]),
             (0.7, (0.1, 0.15, 0.05), along((0.2, 0.3, 0.1)), solid['capsule'][1])]
    turned = zyx(5, 10, 15)
    ball = [(2500 * solid['ellipsoid'][0], (0, 0, 0), zyx(30, 0, 60), solid['ellipsoid'][1]),
            (2500 * solid['sphere'][0], (0.1, 0, 0), round_, solid['sphere'][1])]
    check_bodies(session, data, {'upper': joined(parts), 'ball': joined(ball),
                                 'hand': (0.9, (0.05, 0.02, 0), turned @ np.diag([0.003, 0.004, 0.005]) @ turned.T)})
    y = np.array([-1, 0, 0.2]) / math.sqrt(1.04)
    hand = np.column_stack([(0, 1, 0), y, np.cross((0, 1, 0), y)])
    base = zyx(20, -30, 40), np.array([0.1, 0.2, 0.3])
    upper = base[0] @ quaternion(0.8, 0.1, -0.3, 0.5), base[1] + base[0] @ (0.1, 0, 0.2)
    inner = zyx(10, 0, 0)
    place = upper[1] + upper[0] @ (np.array([0.1, 0, 0.4]) + inner @ (0, 0.1, 0))
    wrist = upper[0] @ inner @ hand
    found = session.table(session.mech9d, data, '--set', 'time.end=0.1', '--set', 'time.intervals=1')
    for name, at in (('first', upper[1] + upper[0] @ (0.1, 0.2, 0.3)), ('tip', place + wrist @ (0.2, 0, 0.2))):
        session.checks.near([found[f'{name}.{c}'][0] for c in 'xyz'], at, 10 * ROUND_OFF, f'place of {name}', scale=1.0)
    session.checks.near([found['q1'][0], found['q2'][0]], [math.radians(15), 0.05], ROUND_OFF, 'references are coordinates')
    # turned back by its reference, the body is where its quaternion places it less 15 degrees about the axis of the joint
    back = session.table(session.mech9d, data.replace(re.search('coordinate=1, position=[0-9.]*', data).group(0), 'coordinate=1, position=0'),
                         '--set', 'time.end=0.1', '--set', 'time.intervals=1')
    arm = np.array([0.1, 0.2, 0.3]) - (0.02, 0.01, 0)
    at = upper[1] + upper[0] @ ((0.02, 0.01, 0) + about([0, 1, 0], -math.radians(15)) @ arm)
    session.checks.near([back[f'first.{c}'][0] for c in 'xyz'], at, 10 * ROUND_OFF, 'the turn about the axis through pos', scale=1.0)
    for piece in ('coordinate=1, stiffness=3, rest=0.3490658503988659, damping=0.2 /', 'coordinate=2, stiffness=3, rest=20, damping=1.5 /',
                  'acceleration=0, 0.5, -9.7 /', 'joint turn, range -1.5707963267948966 to 1.5707963267948966'):
        session.checks.true(piece in data, piece, data)
    for note in ('the armature', 'the friction', "spring and damper of joint 'ball'", '<light> of bodies', '<motor> of actuators'):
        session.checks.true(note in session.said, f'told: {note}', session.said)


def test_masses_from_shapes_alone(session):
    world = session.imports(MJCF.replace('inertial pos', 'inertial name="x" pos').replace('<compiler', '<compiler inertiafromgeom="true"'))
    check_bodies(session, world, {'hand': (2500 * 4 / 3 * math.pi * 0.2**3, (0, 0, 0), 2500 * 4 / 3 * math.pi * 0.2**3 * 0.4 * 0.04 * np.eye(3))})


CONNECT = '<connect name="B" body1="coupler" body2="rocker" anchor="0.5 0 0"/>'


def test_connect_closes_a_four_bar(session):
    """A ball in a plane is a hinge."""
    data = session.imports(MJCF_FOUR_BAR.replace('CLOSING', CONNECT))
    session.checks.equal(data.count('&pair'), 4, 'a ball in a plane is a hinge')
    found = session.table(session.mech9k, re.sub('coefficients=[^ ]*', 'coefficients=0.3, 6', data))
    # the anchor in the rocker's frame follows from the places of both bodies
    turn = about([0, 0, 1], 1.7)[:2, :2]
    anchor = turn.T @ (np.array([0.2 + 0.5 * math.cos(0.9351), 0.5 * math.sin(0.9351)]) - (0.6, 0))
    rocker = found['q2'] + 1.7
    x = 0.6 + np.cos(rocker) * anchor[0] - np.sin(rocker) * anchor[1] - 0.2 * np.cos(found['q1'])
    y = np.sin(rocker) * anchor[0] + np.cos(rocker) * anchor[1] - 0.2 * np.sin(found['q1'])
    session.checks.near(np.hypot(x, y) - 0.5, 0, ROUND_OFF, 'connect: the coupler keeps its length')


def test_connect_of_two_sites(session):
    sites = MJCF_FOUR_BAR.replace('<joint name="A"/>', '<joint name="A"/><site name="a" pos="0.5 0 0"/>').replace(
        '<joint name="C"/>', '<joint name="C"/><site name="c" pos="0.3 0.1 0"/>')
    data = session.imports(sites.replace('CLOSING', '<connect site1="a" site2="c"/>'))
    found = session.table(session.mech9k, re.sub('coefficients=[^ ]*', 'coefficients=0.3, 6', data))
    session.checks.near([found['a.x'], found['a.y']], [found['c.x'], found['c.y']], ROUND_OFF, 'connect: two sites meet', scale=1.0)


def test_weld_makes_one_body_of_two(session):
    half = MJCF_FOUR_BAR.replace('<geom size="0.1"/></body>\n    </body>', """<geom size="0.1"/>
      <body name="end" pos="0.5 0 0"><joint name="B"/><geom size="0.1"/></body></body></body>""")
    data = session.imports(half.replace('CLOSING', '<weld body1="rocker" body2="end"/>'))
    session.checks.true(data.count('&pair') == 4 and data.count('&body') == 3, 'weld: two bodies become one', data)
    session.table(session.mech9k, re.sub('coefficients=[^ ]*', 'coefficients=0, 6', data))


def test_a_closing_that_is_not_active_is_told(session):
    session.imports(MJCF_FOUR_BAR.replace('CLOSING', CONNECT + '<connect active="false" body1="crank"/>'))
    session.checks.true('not active' in session.said, 'told', session.said)


def test_an_equality_of_joints(session):
    data = session.imports(MJCF_FOUR_BAR.replace('CLOSING', '<joint joint1="C" joint2="O" polycoef="0.2 -3 0 0 0"/>').replace(
        'joint name="O"', 'joint name="O" ref="0.1"'))
    found = session.table(session.mech9k, re.sub('(coordinate=1, .*)coefficients=[^ ]*', r'\1coefficients=0.1, 0.5', data))
    session.checks.near(found['q2'], 0.2 - 3 * (found['q1'] - 0.1), ROUND_OFF, 'an equality of joints')


def test_a_square_of_joints_is_told(session):
    session.imports(MJCF_FOUR_BAR.replace('CLOSING', '<joint joint1="C" joint2="O" polycoef="0 1 1 0 0"/>'))
    session.checks.true("joint 'C' and joint 'O', which is not linear" in session.said, 'a square is told', session.said)


def test_a_weld_holds_a_joint(session):
    session.imports(MJCF_FOUR_BAR.replace('CLOSING', '<weld body1="rocker"/>'))
    session.checks.true("not taken over: joint 'C', since fixed joints make both its links one rigid body" in session.said, 'a weld holds a joint', session.said)


def test_a_ball_in_space_stays_a_ball(session):
    # a ball in a chain that does not move in a plane stays a ball
    spatial = MJCF_FOUR_BAR.replace('<joint name="C"/>', '<joint name="C" axis="0.1 0 1"/><joint name="D" axis="1 0 0"/><joint '
                                    'name="E" axis="0 1 0"/>')
    data = session.imports(spatial.replace('CLOSING', CONNECT))
    session.checks.true("'spherical'" in data and data.count('&pair') == 6, 'a ball in space stays a ball')
    session.table(session.mech9k, data)


# Parts of the model that stand in files of their own, and the model that includes them.
INNER = MJCF[MJCF.index('        <frame pos'):MJCF.index('        </frame>')] + '</frame>'
DEFAULTS = MJCF[MJCF.index('  <default>'):MJCF.index('  <worldbody>')]
OUTER = MJCF.replace(INNER[:-len('</frame>')] + '        </frame>', '<include file="parts/hand.xml"></include>').replace(
    DEFAULTS, '<include file="parts/defaults.xml"/>\n')
# the text of parts/hand.xml
HAND = f'<mujocoinclude>{INNER}</mujocoinclude>'


@pytest.fixture
def parts(session):
    """The session with the files that the model includes."""
    os.makedirs(os.path.join(session.folder, 'parts'), exist_ok=True)
    session.write('parts/hand.xml', HAND)
    # names of files are relative to the model, in included files too
    session.write('parts/defaults.xml', '<mujoco><include file="parts/empty.xml"/><include file="parts/more.xml"/></mujoco>')
    session.write('parts/more.xml', f'<mujoco>{DEFAULTS}</mujoco>')
    session.write('parts/empty.xml', '<mujoco/>')
    return session


def test_a_model_in_several_files_is_that_of_one_file(parts):
    expected = parts.imports(MJCF, program=parts.mech9d)
    parts.write('parts/hand.xml', f'<mujocoinclude>\n{INNER}</mujocoinclude>')
    parts.checks.equal(parts.imports(OUTER, program=parts.mech9d), expected, 'three files are one')
    parts.checks.true("parts/hand.xml:4: not taken over: the armature of joint 'wrist'" in parts.said, 'a note in an included file', parts.said)
    done = run(parts.mech9d, '--import', '../robot.xml', folder=os.path.join(parts.folder, 'parts'))
    parts.checks.equal((done.returncode, done.stdout), (DONE, expected), 'from another folder')


# why, code, message, model, included file that is written before and its text
INCLUDES = (
    ('a wrong number in an included file', DATA, "parts/hand.xml:4:13: 'mass': 'heavy' is not a number", OUTER,
     'parts/hand.xml', HAND.replace('mass="0.9"', 'mass="heavy"')),
    ('an included file that is cut', DATA, 'parts/hand.xml:13:9: this is not well-formed XML: no element found', OUTER,
     'parts/hand.xml', f'<mujocoinclude>{INNER}'),
    ('a circle', DATA, "parts/empty.xml:2:1: 'parts/../parts/defaults.xml' includes itself", OUTER,
     'parts/empty.xml', '<mujoco>\n<include file="parts/../parts/defaults.xml"/></mujoco>'),
    ('a file that includes itself', DATA, "robot.xml:1:9: 'robot.xml' includes itself", '<mujoco><include file="robot.xml"/></mujoco>', '', ''),
    ('a file twice', DATA, "parts/empty.xml:1:9: 'parts/more.xml' is included a second time", OUTER,
     'parts/empty.xml', '<mujoco><include file="parts/more.xml"/></mujoco>'),
    ('no name', DATA, "robot.xml:1:9: <include> needs 'file'", '<mujoco><include/></mujoco>', '', ''),
    ('an empty name', DATA, 'robot.xml:1:9: <include> names no file', '<mujoco><include file=""/></mujoco>', '', ''),
    ('a line end in a name', FILE, 'robot.xml:1:9:  : cannot be read', '<mujoco><include file="&#10;"/></mujoco>', '', ''),
    ('a folder', DATA, "'parts' is not a file that can be included", '<mujoco><include file="parts"/></mujoco>', '', ''),
    ('deep in two files', DATA, 'parts/deep.xml:1:303: elements are nested more than 250 deep', '<mujoco><include file="parts/empty.xml"/></mujoco>',
     'parts/empty.xml', '<mujoco>' + 200 * '<body>' + '<include file="parts/deep.xml"/>' + 200 * '</body>' + '</mujoco>'))


@pytest.mark.parametrize('why, code, says, robot, name, text', INCLUDES, ids=[case[0] for case in INCLUDES])
def test_files_that_cannot_be_included(parts, why, code, says, robot, name, text):
    parts.write('parts/deep.xml', '<mujoco>' + 200 * '<body>' + 200 * '</body>' + '</mujoco>')
    if name:
        parts.write(name, text)
    parts.refuses(why, code, says, robot)


def test_a_missing_file_and_its_place(parts):
    os.remove(os.path.join(parts.folder, 'parts/hand.xml'))
    place = f'robot.xml:{OUTER[:OUTER.index("<include file=" + chr(34) + "parts/hand")].count(chr(10)) + 1}'
    parts.refuses('a missing file', FILE, 'parts/hand.xml: cannot be read: there is no such file', OUTER)
    parts.refuses('a missing file at its place', FILE, place, OUTER)


def test_an_included_file_is_not_written_over(parts):
    parts.write('robot.xml', OUTER)
    done = run(parts.mech9k, '--import', 'robot.xml', '--out', 'parts/hand.xml', folder=parts.folder)
    parts.checks.true(done.returncode == USAGE and "would overwrite 'parts/hand.xml'" in done.stderr, 'over an included file', done.stderr)
    parts.checks.equal(parts.text('parts/hand.xml'), HAND, 'it stays as it is')


# Models that are not known, each with its place.
REFUSED = (
    ('a model without joints', DATA, 'robot.xml: the robot has no joints that move', '<mujoco/>'),
    ('a copied body', DATA, 'robot.xml:1:20: <replicate> is not followed', '<mujoco><worldbody><replicate/></worldbody></mujoco>'),
    ('an unknown class', DATA, "no class 'light'", MJCF.replace('childclass="heavy"', 'childclass="light"')),
    ('an unknown body', DATA, "no body 'rod'", MJCF_FOUR_BAR.replace('CLOSING', '<connect body1="rod" anchor="0 0 0"/>')),
    ('global coordinates', DATA, "coordinate='global'", MJCF.replace('<compiler', '<compiler coordinate="global"')),
    ('wrong Euler angles', DATA, "'eulerseq' must be", MJCF.replace('zYx', 'zy')),
    ('an unknown joint of MJCF', DATA, "unknown type 'slip' of a joint; the types are hinge, slide, ball and free", MJCF.replace('type="slide"', 'type="slip"')),
    ('a shape without size', DATA, "'size' must hold", MJCF.replace(' size="0.07"', '')),
    ('no orientation', DATA, 'no direction', MJCF.replace('quat="0.8 0.1 -0.3 0.5"', 'quat="0 0 0 0"')))


@pytest.mark.parametrize('why, code, says, robot', REFUSED, ids=[case[0] for case in REFUSED])
def test_refused(session, why, code, says, robot):
    session.refuses(why, code, says, robot)


def test_models_that_are_damaged(session):
    session.survives([MJCF, MJCF_FOUR_BAR.replace('CLOSING', '<connect body1="coupler" body2="rocker" anchor="0.5 0 0"/>')])
