"""Robots in MJCF that are imported: orientations and places against numpy, masses of shapes against integrals of their sections, closed
chains by <connect> and <weld> against closed forms; refusals; files that are cut or changed.

usage: imported_mjcf.py MECH9K MECH9D
"""
import math
import os
import re
import sys

import numpy as np

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), '..', 'scripts'))
from imported import DATA, DONE, FILE, ROUND_OFF, USAGE, about, test_imports
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


def check_bodies(s, data, expected):
    """Mass, centre and tensor of links by the comments over their bodies."""
    for name, (mass, centre, tensor) in expected.items():
        group = re.search(rf'! link {name}\n(&body.*?\n?/)', data, re.S).group(1)
        found = value_in(data, group, 'inertia')
        s.checks.near(value_in(data, group, 'mass'), mass, 10 * ROUND_OFF, f'mass of {name}')
        s.checks.near(value_in(data, group, 'centre'), centre, 10 * ROUND_OFF, f'centre of {name}', scale=0.1)
        s.checks.near(found, [tensor[0, 0], tensor[1, 1], tensor[2, 2], tensor[0, 1], tensor[0, 2], tensor[1, 2]], 10 * ROUND_OFF,
                      f'inertia of {name}', scale=abs(tensor).max())


def check_mjcf(s):
    """Bodies, joints and shapes of MJCF: places of sites, masses from shapes, springs."""
    data = s.imports(MJCF, program=s.mech9d, name='robot.xml')
    solid = solids()
    round_, box = about([1, 0, 0], 0), about(np.array([1, 1, 0]) / math.sqrt(2), math.radians(30))
    parts = [(2500 * solid['box'][0], (0.1, 0, 0.1), box, solid['box'][1]),
             (2500 * solid['cylinder'][0], (0, 0.1, 0), along((1, 0.2, 0.3)), solid['cylinder'][1]),
             (0.7, (0.1, 0.15, 0.05), along((0.2, 0.3, 0.1)), solid['capsule'][1])]
    turned = zyx(5, 10, 15)
    ball = [(2500 * solid['ellipsoid'][0], (0, 0, 0), zyx(30, 0, 60), solid['ellipsoid'][1]),
            (2500 * solid['sphere'][0], (0.1, 0, 0), round_, solid['sphere'][1])]
    check_bodies(s, data, {'upper': joined(parts), 'ball': joined(ball),
                           'hand': (0.9, (0.05, 0.02, 0), turned @ np.diag([0.003, 0.004, 0.005]) @ turned.T)})
    y = np.array([-1, 0, 0.2]) / math.sqrt(1.04)
    hand = np.column_stack([(0, 1, 0), y, np.cross((0, 1, 0), y)])
    base = zyx(20, -30, 40), np.array([0.1, 0.2, 0.3])
    upper = base[0] @ quaternion(0.8, 0.1, -0.3, 0.5), base[1] + base[0] @ (0.1, 0, 0.2)
    inner = zyx(10, 0, 0)
    place = upper[1] + upper[0] @ (np.array([0.1, 0, 0.4]) + inner @ (0, 0.1, 0))
    wrist = upper[0] @ inner @ hand
    found = s.table(s.mech9d, data, '--set', 'time.end=0.1', '--set', 'time.intervals=1')
    for name, at in (('first', upper[1] + upper[0] @ (0.1, 0.2, 0.3)), ('tip', place + wrist @ (0.2, 0, 0.2))):
        s.checks.near([found[f'{name}.{c}'][0] for c in 'xyz'], at, 10 * ROUND_OFF, f'place of {name}', scale=1.0)
    s.checks.near([found['q1'][0], found['q2'][0]], [math.radians(15), 0.05], ROUND_OFF, 'references are coordinates')
    # turned back by its reference, the body is where its quaternion places it less 15 degrees about the axis of the joint
    back = s.table(s.mech9d, data.replace(re.search('coordinate=1, position=[0-9.]*', data).group(0), 'coordinate=1, position=0'),
                   '--set', 'time.end=0.1', '--set', 'time.intervals=1')
    arm = np.array([0.1, 0.2, 0.3]) - (0.02, 0.01, 0)
    at = upper[1] + upper[0] @ ((0.02, 0.01, 0) + about([0, 1, 0], -math.radians(15)) @ arm)
    s.checks.near([back[f'first.{c}'][0] for c in 'xyz'], at, 10 * ROUND_OFF, 'the turn about the axis through pos', scale=1.0)
    for piece in ('coordinate=1, stiffness=3, rest=0.3490658503988659, damping=0.2 /', 'coordinate=2, stiffness=3, rest=20, damping=1.5 /',
                  'acceleration=0, 0.5, -9.7 /', 'joint turn, range -1.5707963267948966 to 1.5707963267948966'):
        s.checks.true(piece in data, piece, data)
    for note in ('the armature', 'the friction', "spring and damper of joint 'ball'", '<light> of bodies', '<motor> of actuators'):
        s.checks.true(note in s.said, f'told: {note}', s.said)
    world = s.imports(MJCF.replace('inertial pos', 'inertial name="x" pos').replace('<compiler', '<compiler inertiafromgeom="true"'))
    check_bodies(s, world, {'hand': (2500 * 4 / 3 * math.pi * 0.2**3, (0, 0, 0), 2500 * 4 / 3 * math.pi * 0.2**3 * 0.4 * 0.04 * np.eye(3))})


def check_mjcf_loops(s):
    """A four-bar that <connect> closes, one whose rocker <weld> makes of two bodies, and others that are told only."""
    connect = '<connect name="B" body1="coupler" body2="rocker" anchor="0.5 0 0"/>'
    data = s.imports(MJCF_FOUR_BAR.replace('CLOSING', connect))
    s.checks.equal(data.count('&pair'), 4, 'a ball in a plane is a hinge')
    found = s.table(s.mech9k, re.sub('coefficients=[^ ]*', 'coefficients=0.3, 6', data))
    # the anchor in the rocker's frame follows from the places of both bodies
    turn = about([0, 0, 1], 1.7)[:2, :2]
    anchor = turn.T @ (np.array([0.2 + 0.5 * math.cos(0.9351), 0.5 * math.sin(0.9351)]) - (0.6, 0))
    rocker = found['q2'] + 1.7
    x = 0.6 + np.cos(rocker) * anchor[0] - np.sin(rocker) * anchor[1] - 0.2 * np.cos(found['q1'])
    y = np.sin(rocker) * anchor[0] + np.cos(rocker) * anchor[1] - 0.2 * np.sin(found['q1'])
    s.checks.near(np.hypot(x, y) - 0.5, 0, ROUND_OFF, 'connect: the coupler keeps its length')
    sites = MJCF_FOUR_BAR.replace('<joint name="A"/>', '<joint name="A"/><site name="a" pos="0.5 0 0"/>').replace(
        '<joint name="C"/>', '<joint name="C"/><site name="c" pos="0.3 0.1 0"/>')
    data = s.imports(sites.replace('CLOSING', '<connect site1="a" site2="c"/>'))
    found = s.table(s.mech9k, re.sub('coefficients=[^ ]*', 'coefficients=0.3, 6', data))
    s.checks.near([found['a.x'], found['a.y']], [found['c.x'], found['c.y']], ROUND_OFF, 'connect: two sites meet', scale=1.0)
    half = MJCF_FOUR_BAR.replace('<geom size="0.1"/></body>\n    </body>', """<geom size="0.1"/>
      <body name="end" pos="0.5 0 0"><joint name="B"/><geom size="0.1"/></body></body></body>""")
    data = s.imports(half.replace('CLOSING', '<weld body1="rocker" body2="end"/>'))
    s.checks.true(data.count('&pair') == 4 and data.count('&body') == 3, 'weld: two bodies become one', data)
    s.table(s.mech9k, re.sub('coefficients=[^ ]*', 'coefficients=0, 6', data))
    s.imports(MJCF_FOUR_BAR.replace('CLOSING', connect + '<connect active="false" body1="crank"/>'))
    s.checks.true('not active' in s.said, 'told', s.said)
    data = s.imports(MJCF_FOUR_BAR.replace('CLOSING', '<joint joint1="C" joint2="O" polycoef="0.2 -3 0 0 0"/>').replace(
        'joint name="O"', 'joint name="O" ref="0.1"'))
    found = s.table(s.mech9k, re.sub('(coordinate=1, .*)coefficients=[^ ]*', r'\1coefficients=0.1, 0.5', data))
    s.checks.near(found['q2'], 0.2 - 3 * (found['q1'] - 0.1), ROUND_OFF, 'an equality of joints')
    s.imports(MJCF_FOUR_BAR.replace('CLOSING', '<joint joint1="C" joint2="O" polycoef="0 1 1 0 0"/>'))
    s.checks.true("joint 'C' and joint 'O', which is not linear" in s.said, 'a square is told', s.said)
    s.imports(MJCF_FOUR_BAR.replace('CLOSING', '<weld body1="rocker"/>'))
    s.checks.true("not taken over: joint 'C', since fixed joints make both its links one rigid body" in s.said, 'a weld holds a joint', s.said)
    # a ball in a chain that does not move in a plane stays a ball
    spatial = MJCF_FOUR_BAR.replace('<joint name="C"/>', '<joint name="C" axis="0.1 0 1"/><joint name="D" axis="1 0 0"/><joint '
                                    'name="E" axis="0 1 0"/>')
    data = s.imports(spatial.replace('CLOSING', connect))
    s.checks.true("'spherical'" in data and data.count('&pair') == 6, 'a ball in space stays a ball')
    s.table(s.mech9k, data)


def check_includes(s):
    """A model in several files is that of one file; files that are missing, or that include each other, are told with their places."""
    expected = s.imports(MJCF, program=s.mech9d)
    inner = MJCF[MJCF.index('        <frame pos'):MJCF.index('        </frame>')] + '</frame>'
    defaults = MJCF[MJCF.index('  <default>'):MJCF.index('  <worldbody>')]
    outer = MJCF.replace(inner[:-len('</frame>')] + '        </frame>', '<include file="parts/hand.xml"></include>').replace(
        defaults, '<include file="parts/defaults.xml"/>\n')
    os.makedirs(os.path.join(s.folder, 'parts'), exist_ok=True)
    s.write('parts/hand.xml', f'<mujocoinclude>\n{inner}</mujocoinclude>')
    # names of files are relative to the model, in included files too
    s.write('parts/defaults.xml', '<mujoco><include file="parts/empty.xml"/><include file="parts/more.xml"/></mujoco>')
    s.write('parts/more.xml', f'<mujoco>{defaults}</mujoco>')
    s.write('parts/empty.xml', '<mujoco/>')
    s.checks.equal(s.imports(outer, program=s.mech9d), expected, 'three files are one')
    s.checks.true("parts/hand.xml:4: not taken over: the armature of joint 'wrist'" in s.said, 'a note in an included file', s.said)
    s.write('parts/hand.xml', f'<mujocoinclude>{inner}</mujocoinclude>'.replace('mass="0.9"', 'mass="heavy"'))
    s.refuses('a wrong number in an included file', DATA, "parts/hand.xml:4:13: 'mass': 'heavy' is not a number", outer)
    s.write('parts/hand.xml', f'<mujocoinclude>{inner}')
    s.refuses('an included file that is cut', DATA, 'parts/hand.xml:13:9: this is not well-formed XML: no element found', outer)
    os.remove(os.path.join(s.folder, 'parts/hand.xml'))
    place = f'robot.xml:{outer[:outer.index("<include file=" + chr(34) + "parts/hand")].count(chr(10)) + 1}'
    s.refuses('a missing file', FILE, 'parts/hand.xml: cannot be read: there is no such file', outer)
    s.refuses('a missing file at its place', FILE, place, outer)
    s.write('parts/hand.xml', f'<mujocoinclude>{inner}</mujocoinclude>')
    s.write('parts/empty.xml', '<mujoco>\n<include file="parts/../parts/defaults.xml"/></mujoco>')
    s.refuses('a circle', DATA, "parts/empty.xml:2:1: 'parts/../parts/defaults.xml' includes itself", outer)
    s.refuses('a file that includes itself', DATA, "robot.xml:1:9: 'robot.xml' includes itself", '<mujoco><include file="robot.xml"/></mujoco>')
    s.write('parts/empty.xml', '<mujoco><include file="parts/more.xml"/></mujoco>')
    s.refuses('a file twice', DATA, "parts/empty.xml:1:9: 'parts/more.xml' is included a second time", outer)
    s.refuses('no name', DATA, "robot.xml:1:9: <include> needs 'file'", '<mujoco><include/></mujoco>')
    s.refuses('an empty name', DATA, 'robot.xml:1:9: <include> names no file', '<mujoco><include file=""/></mujoco>')
    s.refuses('a line end in a name', FILE, 'robot.xml:1:9:  : cannot be read', '<mujoco><include file="&#10;"/></mujoco>')
    s.refuses('a folder', DATA, "'parts' is not a file that can be included", '<mujoco><include file="parts"/></mujoco>')
    s.write('parts/empty.xml', '<mujoco>' + 200 * '<body>' + '<include file="parts/deep.xml"/>' + 200 * '</body>' + '</mujoco>')
    s.write('parts/deep.xml', '<mujoco>' + 200 * '<body>' + 200 * '</body>' + '</mujoco>')
    s.refuses('deep in two files', DATA, 'parts/deep.xml:1:303: elements are nested more than 250 deep', '<mujoco><include file="parts/empty.xml"/></mujoco>')
    s.write('parts/empty.xml', '<mujoco/>')
    done = run(s.mech9k, '--import', 'robot.xml', '--out', 'parts/hand.xml', folder=s.folder)
    s.checks.equal(done.returncode, DATA, 'robot.xml is still the last one')
    s.write('robot.xml', outer)
    done = run(s.mech9k, '--import', 'robot.xml', '--out', 'parts/hand.xml', folder=s.folder)
    s.checks.true(done.returncode == USAGE and "would overwrite 'parts/hand.xml'" in done.stderr, 'over an included file', done.stderr)
    elsewhere = os.path.join(s.folder, 'parts')
    done = run(s.mech9d, '--import', '../robot.xml', folder=elsewhere)
    s.checks.equal((done.returncode, done.stdout), (DONE, expected), 'from another folder')


def check_refusals(s):
    """Models that are not known, each with its place."""
    for why, code, says, robot in (
            ('a model without joints', DATA, 'robot.xml: the robot has no joints that move', '<mujoco/>'),
            ('a copied body', DATA, 'robot.xml:1:20: <replicate> is not followed', '<mujoco><worldbody><replicate/></worldbody></mujoco>'),
            ('an unknown class', DATA, "no class 'light'", MJCF.replace('childclass="heavy"', 'childclass="light"')),
            ('an unknown body', DATA, "no body 'rod'", MJCF_FOUR_BAR.replace('CLOSING', '<connect body1="rod" anchor="0 0 0"/>')),
            ('global coordinates', DATA, "coordinate='global'", MJCF.replace('<compiler', '<compiler coordinate="global"')),
            ('wrong Euler angles', DATA, "'eulerseq' must be", MJCF.replace('zYx', 'zy')),
            ('an unknown joint of MJCF', DATA, "unknown type 'slip' of a joint; the types are hinge, slide, ball and free", MJCF.replace('type="slide"', 'type="slip"')),
            ('a shape without size', DATA, "'size' must hold", MJCF.replace(' size="0.07"', '')),
            ('no orientation', DATA, 'no direction', MJCF.replace('quat="0.8 0.1 -0.3 0.5"', 'quat="0 0 0 0"'))):
        s.refuses(why, code, says, robot)


if __name__ == '__main__':
    test_imports([check_mjcf, check_includes, check_mjcf_loops, check_refusals],
                 [MJCF, MJCF_FOUR_BAR.replace('CLOSING', '<connect body1="coupler" body2="rocker" anchor="0.5 0 0"/>')])
