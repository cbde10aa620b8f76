"""Files with many names are read in a time that grows as their number does.

Four times the groups, or elements of a robot, may take eight times the processor time, beside half a second for the start of the program.
A search of each name among all others takes sixteen times, and one of each pair among all others sixty-four times. The larger files hold so
much that such a search shows: they take some tenths of a second in all.
"""
import resource

import pytest

from mech9_cases import run

ARM = """&mechanism title='arm', links=3, coordinates=2 /
&structure cq=1, 2 /
&pair coordinate=1, links=1,2, kind='revolute', axis=0,0,1, point=0,0,0, moving_point=0,0,0 /
&pair coordinate=2, links=2,3, kind='revolute', axis=0,0,1, point=1,0,0, moving_point=0,0,0 /
&drive coordinate=1, kind='polynomial', coefficients=0, 1 /
&drive coordinate=2, kind='polynomial', coefficients=0, 2 /
&time start=0, end=1, intervals=2 /
&point name='P', link=3, position=0.5,0,0 /
"""
MJCF = ('<mujoco><worldbody><body name="a"><joint name="A"/><inertial pos="0 0 0" mass="1" diaginertia="1 1 1"/>{}</body></worldbody></mujoco>',
        '<mujoco><worldbody><body name="a"><joint name="A"/>{}</body></worldbody></mujoco>')
SDF_LINK = ('<link name="l{0}"><pose relative_to="{1}">0 1 0 0 0 0</pose></link><joint name="j{0}" type="revolute"><parent>{2}</parent>'
            '<child>l{0}</child><axis><xyz>0 0 1</xyz></axis></joint>')


def repeated(form, n):
    return ''.join(form.format(i) for i in range(n))


def sdf(n):
    links = ''.join(SDF_LINK.format(i, f'l{i - 1}' if i else '__model__', f'l{i - 1}' if i else 'world') for i in range(n))
    return f'<sdf version="1.9"><model name="m">{links}</model></sdf>'


FILES = {
    'points': (2500, lambda n: ARM + repeated("&point name='R{0}', link=3, position=0.5,{0},0 /\n", n)),
    'quantities': (2500, lambda n: ARM + repeated("&quantity name='Q{0}', take='peak', of='P.x' /\n", n)),
    'points of one name': (2500, lambda n: ARM + repeated("&point name='R', link=3, position=0.5,{0},0 /\n", n)),
    'loads': (2500, lambda n: ARM + repeated("&load kind='coordinate', coordinate=1, stiffness={0}1 /\n", n)),
    'sites of MJCF': (2500, lambda n: MJCF[0].format(repeated('<site name="s{0}" pos="0 0 {0}"/>', n))),
    'sites of one name': (2500, lambda n: MJCF[0].format(repeated('<site name="s" pos="0 0 {0}"/>', n))),
    'shapes of MJCF': (10000, lambda n: MJCF[1].format(repeated('<geom size="0.1" pos="0 0 {0}"/>', n))),
    'links of SDF': (240, sdf)}
MOST, START = 8, 0.5


def seconds(program, folder, text):
    robot = text.startswith('<')
    path = folder / ('robot.xml' if robot else 'case.nml')
    path.write_text(text, encoding='utf-8')
    before = resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime
    done = run(program, *(('--import', path, '--out', folder / 'out.nml') if robot else (path, '--check')), folder=folder, timeout=60)
    return done, resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime - before


@pytest.mark.parametrize('kind', FILES)
def test_time_grows_with_the_number(checks, mech9k, tmp_path, kind):
    n, text = FILES[kind]
    small, short = seconds(mech9k, tmp_path, text(n))
    large, long = seconds(mech9k, tmp_path, text(4 * n))
    code = 3 if kind == 'points of one name' else 0
    checks.equal((small.returncode, large.returncode), (code, code), f'{kind}: both are read: {large.stderr[:500]}')
    checks.true(long < MOST * short + START, f'{kind}: the time grows almost in proportion', f'{short:.2f} s and {long:.2f} s')
