"""Robots in SDF that are imported: places of links and axes that stand in named frames against numpy, a free model that falls, a closed
chain against a closed form, a screw; refusals; files that are cut or changed.
"""
import math
import re

import numpy as np
import pytest

from imported import DATA, ROUND_OFF, about, rpy

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


# Two models in a model, one of them placed by a frame of its own; a joint from the frame of one to the link of the other.
NESTED = """<sdf version="1.11"><model name="whole">
  <pose>0.3 0.1 0 0 0.2 0</pose>
  <link name="base"/>
  <joint name="hold" type="fixed"><parent>world</parent><child>base</child></joint>
  <model name="left">
    <pose>0.2 -0.1 0.4 0.3 0.2 0.1</pose>
    <link name="rod"><pose>0.1 0.2 0.3 0 0 0.5</pose></link>
    <frame name="eye" attached_to="rod"><pose>0 0.4 0 0.1 0 0</pose></frame>
  </model>
  <model name="right" placement_frame="pin">
    <pose relative_to="left::rod">0.7 0 0.1 0 0.4 0</pose>
    <link name="bar"><pose relative_to="pin">0.3 0.2 0.1 0 0.3 0</pose></link>
    <frame name="pin"><pose>5 6 7 0.8 0.9 0.1</pose></frame>
  </model>
  <joint name="turn" type="revolute"><parent>base</parent><child>left</child><axis><xyz>0 1 0</xyz></axis></joint>
  <joint name="hinge" type="revolute">
    <parent>left::eye</parent><child>right::bar</child><axis><xyz expressed_in="left">0 0 1</xyz></axis>
  </joint>
</model></sdf>
"""
DEGREES = '<pose degrees="true" relative_to="upper">0.2 0.1 0.6 10 20 30</pose>'
QUATERNION = '<pose relative_to="upper" rotation_format="quat_xyzw">0.2 0.1 0.6 {} {} {} {}</pose>'


def drive(data, values):
    """The data file with drives that hold other values."""
    for k, value in enumerate(values, 1):
        data = re.sub(rf"(&drive coordinate={k}, kind='polynomial', coefficients=)\S+", rf'\g<1>{value}', data)
    return data


def test_arm_with_named_frames(session):
    data = session.imports(ARM)
    found = session.table(session.mech9k, drive(data, (0.4, -0.9)) + "&point name='U', link=2, position=0,0,0 /\n", '--set', 'time.intervals=1')
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
    session.checks.near([found[f'U.{c}'][0] for c in 'xyz'], model[1] + model[0] @ place, 10 * ROUND_OFF, 'place of the upper link', scale=1.0)
    # the screw turns about an axis of its own frame, 0.1 m above that of the hand, and advances by 0.05 m in a turn
    own = np.array([0, 0.6, 0.8])
    at = hand[1] + hand[0] @ ((0, 0, 0.1) + own * 0.05 * -0.9 / (2 * math.pi) - about(own, -0.9) @ (0, 0, 0.1))
    session.checks.near([found[f'hand.{c}'][0] for c in 'xyz'], model[1] + model[0] @ (joint[1] + r @ (at - joint[1])), 10 * ROUND_OFF,
                        'place of the hand', scale=1.0)
    for piece in ('acceleration=0, 0.3, -9.7 /', 'stiffness=5, rest=0.1, damping=0.3 /', 'mass = 2.5', 'joint shoulder, range -1 to 1e16'):
        session.checks.true(piece in data, piece, data)
    session.checks.true('<visual> of links' in session.said, 'shapes are told', session.said)


def test_a_quaternion_of_any_length(session):
    data = session.imports(ARM)
    expected = session.table(session.mech9k, drive(data, (0.4, -0.9)), '--set', 'time.intervals=1')
    w, (x, y, z) = quaternion(rpy(np.radians((10, 20, 30))))
    found = session.table(session.mech9k, drive(session.imports(ARM.replace(DEGREES, QUATERNION.format(3 * x, 3 * y, 3 * z, 3 * w))), (0.4, -0.9)),
                          '--set', 'time.intervals=1')
    for name in ('hand.x', 'hand.y', 'hand.z'):
        session.checks.near(found[name], expected[name], 10 * ROUND_OFF, f'{name} with a quaternion', scale=1.0)


MIMIC = '<mimic joint="shoulder"><multiplier>-2</multiplier><offset>0.3</offset><reference>0.1</reference></mimic>'


def test_a_joint_that_follows_another_one(session):
    data = session.imports(ARM.replace('0 0.6 0.8</xyz>', '0 0.6 0.8</xyz>' + MIMIC))
    found = session.table(session.mech9k, drive(data, ('0.1, 0.5',)))
    session.checks.near(found['q2'], -2 * (found['q1'] - 0.1) + 0.3, ROUND_OFF, 'a joint that follows another one')


def test_a_second_axis_that_leads_is_told(session):
    session.imports(ARM.replace('0 0.6 0.8</xyz>', '0 0.6 0.8</xyz>' + MIMIC.replace('joint=', 'axis="axis2" joint=')))
    session.checks.equal(session.said.count("the coupling of joint 'wrist' with the second axis of joint 'shoulder'"), 1, 'a second axis is told')


def test_revolute2_is_a_universal_joint(session):
    cross = ARM.replace('"screw"', '"KIND"').replace('<screw_thread_pitch>0.05</screw_thread_pitch>',
                                                     '<axis2><xyz>1 0.2 0</xyz><limit><lower>0</lower></limit></axis2>')
    data = session.imports(cross.replace('KIND', 'universal'))
    session.checks.equal(session.imports(cross.replace('KIND', 'revolute2')), data, 'revolute2 is a universal joint')
    session.checks.equal(session.said.count("<limit> of <axis2> of joint 'wrist'"), 1, 'a limit that is not taken over is told')


def test_what_is_not_taken_over_is_told_once(session):
    geared = ARM.replace('</model>', """<joint name="gear" type="gearbox"><parent>upper</parent><child>hand</child>
        <gearbox_ratio>2</gearbox_ratio></joint></model>""").replace('<gravity>', '<light name="l"/><gravity>')
    session.imports(geared)
    session.checks.equal(session.said.count("robot.xml:38: not taken over: joint 'gear' of the type gearbox"), 1, 'a gearbox is told once')
    session.checks.equal(session.said.count('robot.xml:4: not taken over: <light> of worlds'), 1, 'a light is told once')


def quaternion(r):
    """Scalar part and vector of a rotation by less than half a turn."""
    w = math.sqrt(1 + np.trace(r)) / 2
    return w, np.array([r[2, 1] - r[1, 2], r[0, 2] - r[2, 0], r[1, 0] - r[0, 1]]) / (4 * w)


def test_models_in_a_model(session):
    """The same motion as that of frames and axes that numpy computes."""
    data = session.imports(NESTED)
    session.checks.true('! Link 2: left::rod' in data and '! Link 3: right::bar' in data, 'names of links in nested models', data)
    points = "&point name='L', link=2, position=0,0,0 /\n&point name='R', link=3, position=0,0,0 /\n"
    found = session.table(session.mech9k, drive(data, (0.4, -0.9)) + points, '--set', 'time.intervals=1')
    whole = rpy((0, 0.2, 0)), np.array([0.3, 0.1, 0])
    left = rpy((0.3, 0.2, 0.1)), np.array([0.2, -0.1, 0.4])
    rod = left[0] @ rpy((0, 0, 0.5)), left[1] + left[0] @ (0.1, 0.2, 0.3)
    pin = rod[0] @ rpy((0, 0.4, 0)), rod[1] + rod[0] @ (0.7, 0, 0.1)
    bar = pin[1] + pin[0] @ (0.3, 0.2, 0.1)
    # the frame of the first joint is that of the model left, about whose y axis it turns
    turn, hinge = about(left[0] @ (0, 1, 0), 0.4), left[0] @ (0, 0, 1)
    for name, place in (('L', rod[1]), ('R', bar)):
        session.checks.near([found[f'{name}.{c}'][0] for c in 'xyz'], whole[1] + whole[0] @ (left[1] + turn @ (place - left[1])),
                            10 * ROUND_OFF, f'place of {name}', scale=1.0)
    mark = session.table(session.mech9k, drive(data, (0.4, -0.9)) + "&point name='M', link=3, position=1,0,0 /\n", '--set', 'time.intervals=1')
    at = bar + about(hinge, -0.9) @ (pin[0] @ rpy((0, 0.3, 0)) @ (1, 0, 0))
    session.checks.near([mark[f'M.{c}'][0] for c in 'xyz'], whole[1] + whole[0] @ (left[1] + turn @ (at - left[1])), 10 * ROUND_OFF,
                        'a point of the bar', scale=1.0)


FREE = '<sdf version="1.9"><model name="m"><pose>0 0 5 0 0 0</pose><link name="a"/>{}</model></sdf>'


def test_a_model_that_nothing_holds_falls(session):
    data = session.imports(FREE.format(''), program=session.mech9d)
    found = session.table(session.mech9d, data)
    session.checks.near(found['a.z'], 5 - 4.9 * found['t']**2, 1e-8, 'a free model falls')


def test_a_static_model_cannot_move(session):
    session.refuses('a static model', DATA, 'no joints that move', FREE.format('<static>true</static>'))


@pytest.mark.parametrize('kind', ('revolute', 'ball'))
def test_a_joint_to_a_link_that_has_a_parent_closes_the_chain(session, kind):
    """A ball there only turns about the normal."""
    data = session.imports(FOUR_BAR.replace('KIND', kind))
    session.checks.equal(data.count("'revolute'"), 4, f'{kind}: four hinges')
    found = session.table(session.mech9k, drive(data, ('0.3, 6',)))
    end = about([0, 0, 1], 1.7).T @ (np.array([0.2 + 0.5 * math.cos(0.9351), 0.5 * math.sin(0.9351), 0]) - (0.6, 0, 0))
    angle = found['q2'] + 1.7
    x = 0.6 + np.cos(angle) * end[0] - np.sin(angle) * end[1] - 0.2 * np.cos(found['q1'])
    y = np.sin(angle) * end[0] + np.cos(angle) * end[1] - 0.2 * np.sin(found['q1'])
    session.checks.near(np.hypot(x, y) - 0.5, 0, ROUND_OFF, f'{kind}: the coupler keeps its length')


REFUSED = (
    ('no model', 'there is no <model>', '<sdf version="1.9"/>'),
    ('an included model', '<include> in a model is not followed', ARM.replace('<frame', '<include/><frame')),
    ('an unknown type', "unknown type 'hinge' of a joint; the types are fixed, revolute,", ARM.replace('"screw"', '"hinge"')),
    ('an unknown form of rotations', "unknown rotation_format 'axis'", ARM.replace('degrees="true"', 'rotation_format="axis"')),
    ('six numbers of a quaternion', '<pose> must hold 7 numbers, not 6', ARM.replace('degrees="true"', 'rotation_format="quat_xyzw"')),
    ('no quaternion', 'the quaternion of <pose> is zero', ARM.replace(DEGREES, QUATERNION.format(0, 0, 0, 0))),
    ('degrees of a quaternion', 'has no degrees', ARM.replace(DEGREES, QUATERNION.format(0, 0, 0, 1).replace('<pose', '<pose degrees="1"'))),
    ('parallel axes', "robot.xml:33:7: the two axes of joint 'wrist' are parallel",
     ARM.replace('"screw"', '"revolute2"').replace('<screw_', '<axis2><xyz>0 -0.6 -0.8</xyz></axis2><screw_')),
    ('an unknown leader', "robot.xml:33:7: there is no joint 'sholder', which joint 'wrist' follows", ARM.replace(
        '0 0.6 0.8</xyz>', '0 0.6 0.8</xyz><mimic joint="sholder"><multiplier>1</multiplier></mimic>')),
    ('a factor of 0', "robot.xml:33:7: joint 'wrist' follows joint 'shoulder' with the factor 0", ARM.replace(
        '0 0.6 0.8</xyz>', '0 0.6 0.8</xyz><mimic joint="shoulder"><multiplier>0</multiplier></mimic>')),
    ('no multiplier', '<mimic> needs <multiplier>', ARM.replace('0 0.6 0.8</xyz>', '0 0.6 0.8</xyz><mimic joint="shoulder"/>')),
    ('a frame of the world', "the model stands in the frame 'mark' of the world",
     ARM.replace('<pose>0.5 -0.2', '<pose relative_to="mark">0.5 -0.2')),
    ('a nested frame in a circle', 'stands in itself', NESTED.replace('relative_to="left::rod"', 'relative_to="right::bar"')),
    ('an unknown link of a nested model', "there is no link 'left::rd', which joint 'hinge' names",
     NESTED.replace('<parent>left::eye', '<parent>left::rd')),
    ('an unknown frame', "there is no frame 'mrk'", ARM.replace('relative_to="mark"', 'relative_to="mrk"')),
    ('frames in a circle', 'stands in itself', ARM.replace('attached_to="base"', 'attached_to="shoulder"')),
    ('an unknown parent', "there is no link 'arm'", ARM.replace('<parent>upper</parent>', '<parent>arm</parent>')),
    ('an unknown child', "there is no frame 'arm'", ARM.replace('<child>hand</child>', '<child>arm</child>')),
    ('five numbers', '<pose> must hold 6 numbers, not 5', ARM.replace('0 0 0.1 0 0 0', '0 0 0.1 0 0')),
    ('no pitch', 'needs <screw_thread_pitch>', ARM.replace('<screw_thread_pitch>0.05</screw_thread_pitch>', '')),
    ('no axis', 'the axis has no direction', ARM.replace('0 0.6 0.8', '0 0 0')))


@pytest.mark.parametrize('why, says, robot', REFUSED, ids=[case[0] for case in REFUSED])
def test_refused(session, why, says, robot):
    session.refuses(why, DATA, says, robot)


def test_models_that_are_damaged(session):
    session.survives([ARM, NESTED, FOUR_BAR.replace('KIND', 'ball')])
