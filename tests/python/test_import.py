"""Robots that the package imports: the same data file and messages as those of the programs, which other tests judge."""
import os

import pytest

from mech9_cases import TREE, run

LIFT = os.path.join(TREE, 'examples', 'hydraulic_lift', 'lift.urdf')
MJCF = '''<mujoco model="pendulum"><worldbody><body name="bob" pos="0 0 1"><joint name="turn" axis="0 1 0" damping="0.1"/>
<geom type="sphere" size="0.1" pos="0 0 -0.5" friction="1 0 0"/><site name="Spitze" pos="0 0 -1"/></body></worldbody>
<actuator><motor joint="turn"/></actuator></mujoco>'''
SDF = '''<sdf version="1.7"><model name="arm"><link name="boom"><inertial><mass>2</mass><pose>0.5 0 0 0 0 0</pose></inertial></link>
<joint name="hinge" type="revolute"><parent>world</parent><child>boom</child><axis><xyz>0 1 0</xyz></axis></joint></model></sdf>'''
URDF = '''<robot name="arm"><link name="base"/><link name="rod"><inertial><mass value="1"/><origin xyz="0.5 0 0"/>
<inertia ixx="0.1" iyy="0.1" izz="0.1" ixy="0" ixz="0" iyz="0"/></inertial></link>
<joint name="pin" type="continuous"><parent link="base"/><child link="rod"/><axis xyz="0 0 1"/></joint></robot>'''


@pytest.fixture(name='folder')
def folder_with_robots(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    for name, text in (('pendel_ü.xml', MJCF), ('arm.sdf', SDF), ('arm.urdf', URDF)):
        (tmp_path / name).write_text(text, encoding='utf-8')
    return tmp_path


@pytest.mark.parametrize('driven', [True, False])
@pytest.mark.parametrize('robot', [LIFT, 'pendel_ü.xml', 'arm.sdf', 'arm.urdf'], ids=os.path.basename)
def test_robots(build, mech9, folder, robot, driven):
    try:
        m = mech9.import_robot(robot, driven=driven)
    except mech9.Error as reason:
        assert 'expat' in str(reason)
        pytest.skip('this build imports no robots')
    program = 'mech9k' if driven else 'mech9d'
    done = run(build.program(program), '--import', robot)
    assert done.returncode == 0, done.stderr
    assert m.imported_text == done.stdout
    told = done.stderr.splitlines()
    assert list(m.import_messages) == told[:-1] + [told[-1].removeprefix(program + ': ')]
    assert m.text() == mech9.read_text(done.stdout).text()
    assert m.is_driven is driven
    assert m.check().redundant >= 0 and '<svg' in m._repr_html_()
    if not driven:
        assert len(m.dynamics(end=0.1, intervals=2).t) == 3


def test_loops(build, mech9, folder):
    with open(LIFT, encoding='utf-8') as file:
        text = file.read()
    start, end = text.index('<loop'), text.rindex('</loop>') + len('</loop>')
    (folder / 'tree.urdf').write_text(text[:start] + text[end:])
    (folder / 'loops.xml').write_text(f'<robot name="loops">{text[start:end]}</robot>')
    m = mech9.import_robot('tree.urdf', loops='loops.xml')
    done = run(build.program('mech9k'), '--import', 'tree.urdf', 'loops.xml')
    assert done.returncode == 0 and m.imported_text == done.stdout
    assert '1 closed chain' in m.import_messages[-1]


def test_refusals_are_those_of_the_programs(build, mech9, folder):
    (folder / 'cut.urdf').write_text(URDF[:200])
    (folder / 'other.xml').write_text('<html/>')
    (folder / 'still.urdf').write_text('<robot name="still"><link name="base"/></robot>')
    for name in ('cut.urdf', 'other.xml', 'still.urdf', 'missing.urdf', '.'):
        done = run(build.program('mech9k'), '--import', name)
        with pytest.raises(mech9.Error) as caught:
            mech9.import_robot(name)
        assert caught.value.code == done.returncode
        assert 'mech9k: ' + caught.value.message == done.stderr.rstrip('\n')
    with pytest.raises(mech9.UsageError):
        mech9.import_robot('a\0b')
    with pytest.raises(TypeError):
        mech9.import_robot(3.5)
    assert mech9.read_text('').import_messages == ()
