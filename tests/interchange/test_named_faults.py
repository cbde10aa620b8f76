"""Faults of robots that are imported are told by the names of the parts that have them, with their places."""
import pytest

from mech9_cases import run

URDF = '<robot><link name="w"/>\n<link name="a"/>\n{}<joint name="j" type="revolute"><parent link="w"/><child link="a"/>{}</joint></robot>'
SDF = ('<sdf version="1.9"><model name="m"><link name="a">{}</link>\n{}'
       '<joint name="j" type="revolute"><parent>world</parent><child>a</child><axis><xyz>0 0 1</xyz>{}</axis></joint></model></sdf>')
MJCF = '<mujoco><worldbody><body name="a"><inertial pos="0 0 0" mass="1" diaginertia="1 1 1"/>\n<joint name="j" {}/></body></worldbody></mujoco>'
BEGINS_ABOVE = "the range of joint 'j' begins above its end"

CASES = {
    'two links that no joint names': (URDF.format('<link name="w"/>\n', ''), "robot.xml:3:1: there are two links 'w'"),
    'two links that joints name': (URDF.format('<link name="a"/>\n', ''), "robot.xml:3:1: there are two links 'a'"),
    'a range of URDF': (URDF.format('', '<limit lower="2" upper="-1"/>'), 'robot.xml:3:1: ' + BEGINS_ABOVE),
    'a range of SDF': (SDF.format('', '', '<limit><lower>2</lower><upper>1</upper></limit>'), 'robot.xml:2:1: ' + BEGINS_ABOVE),
    'a range of MJCF': (MJCF.format('range="2 1"'), 'robot.xml:2:1: ' + BEGINS_ABOVE),
    'two frames': (SDF.format('<pose relative_to="f">0 0 0 0 0 0</pose>', '<frame name="f" attached_to="g"/><frame name="g" attached_to="f"/>', ''),
                   "the frame 'f' stands in itself, by way of 'g'\n"),
    'one frame': (SDF.format('<pose relative_to="f">0 0 0 0 0 0</pose>', '<frame name="f" attached_to="f"/>', ''), "the frame 'f' stands in itself\n"),
    'three frames': (SDF.format('<pose relative_to="e">0 0 0 0 0 0</pose>', '<frame name="e" attached_to="f"/><frame name="f" attached_to="g"/>'
                                '<frame name="g"><pose relative_to="h"/></frame><frame name="h" attached_to="f"/>', ''),
                     "the frame 'f' stands in itself, by way of 'g', by way of 'h'\n")}
TAKEN = "has the name of a link, joint, model or frame beside it"
CASES |= {
    'a frame named like a link before it': (SDF.format('', '<frame name="a"/>', ''), "robot.xml:2:1: the frame 'a' " + TAKEN),
    'a frame named like a joint behind it': (SDF.format('', '<frame name="j"/>', ''), "robot.xml:2:1: the frame 'j' " + TAKEN),
    'two frames of one name': (SDF.format('', '<frame name="f"/>\n<frame name="f"/>', ''), "robot.xml:3:1: the frame 'f' " + TAKEN),
    'a frame named like a model': (SDF.format('', '<frame name="b"/><model name="b"><link name="a"/></model>', ''), "robot.xml:2:1: the frame 'b' " + TAKEN),
    'a frame in a nested model': (SDF.format('', '<model name="b"><link name="a"/>\n<frame name="a"/></model>', ''),
                                  "robot.xml:3:1: the frame 'b::a' " + TAKEN)}
KEPT = {'a frame named like a link of another model': SDF.format('', '<frame name="c"/><model name="b"><link name="c"/></model>', ''),
        'a range of one number': URDF.format('', '<limit lower="1" upper="1"/>'), 'no limit above': SDF.format('', '', '<limit><lower>2</lower></limit>'),
        'a range that limits nothing': MJCF.format('range="2 1" limited="false"')}


@pytest.mark.parametrize('kind', CASES)
def test_the_part_is_named(checks, mech9k, tmp_path, kind):
    robot, says = CASES[kind]
    (tmp_path / 'robot.xml').write_text(robot, encoding='utf-8')
    done = run(mech9k, '--import', 'robot.xml', folder=tmp_path)
    checks.true(done.returncode == 3 and says in done.stderr and done.stdout == '', f'{kind}: {says}', f'{done.returncode}: {done.stderr}')


@pytest.mark.parametrize('kind', KEPT)
def test_what_is_right_is_imported(checks, mech9k, tmp_path, kind):
    (tmp_path / 'robot.xml').write_text(KEPT[kind], encoding='utf-8')
    done = run(mech9k, '--import', 'robot.xml', folder=tmp_path)
    checks.equal(done.returncode, 0, f'{kind}: {done.stderr}')
