"""Robots in SDF that are imported: places of links and axes that stand in named frames against numpy, a free model that falls, a closed
chain against a closed form, a screw; refusals; files that are cut or changed.

usage: imported_sdf.py MECH9K MECH9D
"""
import math
import os
import re
import sys
import tempfile

import numpy as np

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), '..', 'scripts'))
from imported import DATA, ROUND_OFF, Session, about, rpy
from mech9_cases import Checks

ARM = """<?xml version="1.0"?>
<sdf version="1.10">
  <world name="w">
    <gravity>0 0.3 -9.7</gravity>
    <model name="arm">
      <pose>0.5 -0.2 0.1 0.1 0.2 0.3</pose>
      <link name="base">
        <pose>0.1 0 0.2 0 0.3 0</pose>
        <inertial><mass>4</mass></inertial>
      </link>
      <frame name="mark" attached_to="base"><pose>0 0.3 0.1 0.5 0 0</pose></frame>
      <link name="upper">
        <pose relative_to="shoulder">0.05 0 0 0 0 0.4</pose>
        <inertial>
          <pose>0.1 0.02 0.3 0.3 -0.2 0.5</pose>
          <mass>2.5</mass>
          <inertia><ixx>0.05</ixx><iyy>0.06</iyy><izz>0.03</izz><ixy>0.002</ixy><ixz>-0.003</ixz><iyz>0.001</iyz></inertia>
        </inertial>
        <visual name="v"><geometry><box><size>1 1 1</size></box></geometry></visual>
      </link>
      <link name="hand">
        <pose degrees="true" relative_to="upper">0.2 0.1 0.6 10 20 30</pose>
        <inertial><mass>0.7</mass><inertia><ixx>0.002</ixx><iyy>0.003</iyy><izz>0.004</izz></inertia></inertial>
      </link>
      <joint name="hold" type="fixed"><parent>world</parent><child>base</child></joint>
      <joint name="shoulder" type="revolute">
        <pose relative_to="mark">0.02 0 0 0 0 0.7</pose>
        <parent>base</parent><child>upper</child>
        <axis><xyz expressed_in="__model__">1 2 2</xyz>
          <limit><lower>-1</lower><upper>1e16</upper></limit>
          <dynamics><damping>0.3</damping><spring_stiffness>5</spring_stiffness><spring_reference>0.1</spring_reference></dynamics></axis>
      </joint>
      <joint name="wrist" type="screw">
        <pose>0 0 0.1 0 0 0</pose>
        <parent>upper</parent><child>hand</child>
        <axis><xyz>0 0.6 0.8</xyz></axis><screw_thread_pitch>0.05</screw_thread_pitch>
      </joint>
    </model>
  </world>
</sdf>
"""
# Joints tell their frames in those of their children; the last one closes the chain.
FOUR_BAR = """<sdf version="1.9"><model name="four-bar">
  <link name="crank"/>
  <link name="coupler"><pose>0.2 0 0 0 0 0.9351</pose></link>
  <link name="rocker"><pose>0.6 0 0 0 0 1.7</pose></link>
  <joint name="O" type="revolute"><parent>world</parent><child>crank</child><axis><xyz>0 0 1</xyz></axis></joint>
  <joint name="A" type="revolute"><parent>crank</parent><child>coupler</child></joint>
  <joint name="C" type="continuous"><parent>world</parent><child>rocker</child></joint>
  <joint name="B" type="KIND"><pose relative_to="coupler">0.5 0 0 0 0 0</pose><parent>coupler</parent><child>rocker</child></joint>
</model></sdf>
"""


def drive(data, values):
    """The data file with drives that hold other values."""
    for k, value in enumerate(values, 1):
        data = re.sub(rf"(&drive coordinate={k}, kind='polynomial', coefficients=)\S+", rf'\g<1>{value}', data)
    return data


def check_arm(s):
    data = s.imports(ARM)
    found = s.table(s.mech9k, drive(data, (0.4, -0.9)) + "&point name='U', link=2, position=0,0,0 /\n", '--set', 'time.intervals=1')
    model = rpy((0.1, 0.2, 0.3)), np.array([0.5, -0.2, 0.1])
    base = rpy((0, 0.3, 0)), np.array([0.1, 0, 0.2])
    mark = base[0] @ rpy((0.5, 0, 0)), base[1] + base[0] @ (0, 0.3, 0.1)
    joint = mark[0] @ rpy((0, 0, 0.7)), mark[1] + mark[0] @ (0.02, 0, 0)
    upper = joint[0] @ rpy((0, 0, 0.4)), joint[1] + joint[0] @ (0.05, 0, 0)
    turns = np.radians((10, 20, 30))
    hand = upper[0] @ rpy(turns), upper[1] + upper[0] @ (0.2, 0.1, 0.6)
    axis = np.array([1, 2, 2]) / 3
    r = about(axis, 0.4)
    place = joint[1] + r @ (upper[1] - joint[1])
    s.checks.near([found[f'U.{c}'][0] for c in 'xyz'], model[1] + model[0] @ place, 10 * ROUND_OFF, 'place of the upper link', scale=1.0)
    # the screw turns about an axis of its own frame, 0.1 m above that of the hand, and advances by 0.05 m in a turn
    own = np.array([0, 0.6, 0.8])
    at = hand[1] + hand[0] @ ((0, 0, 0.1) + own * 0.05 * -0.9 / (2 * math.pi) - about(own, -0.9) @ (0, 0, 0.1))
    s.checks.near([found[f'hand.{c}'][0] for c in 'xyz'], model[1] + model[0] @ (joint[1] + r @ (at - joint[1])), 10 * ROUND_OFF,
                  'place of the hand', scale=1.0)
    for piece in ('acceleration=0, 0.3, -9.7 /', 'stiffness=5, rest=0.1, damping=0.3 /', 'mass = 2.5', 'joint shoulder, range -1 to 1e16'):
        s.checks.true(piece in data, piece, data)
    s.checks.true('<visual> of links' in s.said, 'shapes are told', s.said)


def check_free(s):
    """A model that nothing holds falls; a static one cannot move."""
    robot = '<sdf version="1.9"><model name="m"><pose>0 0 5 0 0 0</pose><link name="a"/>{}</model></sdf>'
    data = s.imports(robot.format(''), program=s.mech9d)
    found = s.table(s.mech9d, data)
    s.checks.near(found['a.z'], 5 - 4.9 * found['t']**2, 1e-8, 'a free model falls')
    s.refuses('a static model', 2, 'no joints that move', robot.format('<static>true</static>'))


def check_four_bar(s):
    """A joint to a link that has a parent closes the chain; a ball there only turns about the normal."""
    for kind in ('revolute', 'ball'):
        data = s.imports(FOUR_BAR.replace('KIND', kind))
        s.checks.equal(data.count("'revolute'"), 4, f'{kind}: four hinges')
        found = s.table(s.mech9k, drive(data, ('0.3, 6',)))
        end = about([0, 0, 1], 1.7).T @ (np.array([0.2 + 0.5 * math.cos(0.9351), 0.5 * math.sin(0.9351), 0]) - (0.6, 0, 0))
        angle = found['q2'] + 1.7
        x = 0.6 + np.cos(angle) * end[0] - np.sin(angle) * end[1] - 0.2 * np.cos(found['q1'])
        y = np.sin(angle) * end[0] + np.cos(angle) * end[1] - 0.2 * np.sin(found['q1'])
        s.checks.near(np.hypot(x, y) - 0.5, 0, ROUND_OFF, f'{kind}: the coupler keeps its length')


def check_refusals(s):
    for why, says, robot in (
            ('no model', 'there is no <model>', '<sdf version="1.9"/>'),
            ('a nested model', '<include> in a model is not followed', ARM.replace('<frame', '<include/><frame')),
            ('an unknown type', "joints of the type 'gearbox' are not known", ARM.replace('"screw"', '"gearbox"')),
            ('an unknown frame', "there is no frame 'mrk'", ARM.replace('relative_to="mark"', 'relative_to="mrk"')),
            ('frames in a circle', 'stands in itself', ARM.replace('attached_to="base"', 'attached_to="shoulder"')),
            ('an unknown parent', "there is no link 'arm'", ARM.replace('<parent>upper</parent>', '<parent>arm</parent>')),
            ('an unknown child', "there is no frame 'arm'", ARM.replace('<child>hand</child>', '<child>arm</child>')),
            ('five numbers', '<pose> must hold 6 numbers, not 5', ARM.replace('0 0 0.1 0 0 0', '0 0 0.1 0 0')),
            ('no pitch', 'needs <screw_thread_pitch>', ARM.replace('<screw_thread_pitch>0.05</screw_thread_pitch>', '')),
            ('no axis', 'the axis has no direction', ARM.replace('0 0.6 0.8', '0 0 0'))):
        s.refuses(why, DATA, says, robot)


def main():
    checks = Checks()
    with tempfile.TemporaryDirectory() as folder:
        s = Session(checks, folder, *sys.argv[1:3])
        if not s.without_expat():
            check_arm(s)
            check_free(s)
            check_four_bar(s)
            check_refusals(s)
            s.survives([ARM, FOUR_BAR.replace('KIND', 'ball')], 120)
    checks.finish()


if __name__ == '__main__':
    main()
