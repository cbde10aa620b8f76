"""mech9-link --auto: AUTO-07p follows equations of motion of the library. Its folds, Hopf points, branch points and period doublings against
closed forms, eigenvalues in numpy, and published values; what it refuses. Programs of AUTO run where Debian's auto-07p is there."""
import json
import os
import re
import shutil

import numpy as np
import pytest

import branch_cases
from mech9_cases import TREE, run

AUTO = os.environ.get('AUTO_DIR', '/usr/lib/auto-07p')
SPRING = """&structure cq=1 /
&pair coordinate=1, links=1,2, kind='prismatic', axis=0,1,0 /
&initial coordinate=1, position=0.6 /
&body link=2, mass=1 /
&point name='P', link=2 /
&load kind='spring', links=1,2, position=0.8,0,0, stiffness=100, free_length=1 /
&load kind='force', link=2, force=0,-4,0 /
&parameter name='F', sets='load(2).force(2)', factors=-1, value=4 /
"""
FOLD = 5.139077831551
TRUSS = branch_cases.TRUSS + """&parameter name='a_load_with_a_long_name', sets='load(2).force(2)', factors=-1, value=0 /
&branch parameter='a_load_with_a_long_name', low=-8, high=8 /
&initial coordinate=1, position=0 /
"""
ZIEGLER = branch_cases.ZIEGLER % (0.1, 0.1) + """&parameter name='P', sets='load(3).force(1)', factors=-1, value=1 /
&parameter name='c', sets='load(1).damping', value=0.1, low=0, high=0.1 /
&branch parameter='P', low=0.5, high=2 /
&initial coordinate=1, position=0 /
&initial coordinate=2, position=0.02 /
"""
# the pendulum of Baker and Gollub, damping 1/2, frequency 2/3
DRIVEN = """&structure cq=1 /
&pair coordinate=1, links=1,2, kind='revolute', axis=0,0,1 /
&initial coordinate=1, position=0.2 /
&body link=2, mass=1, centre=0,-1,0 /
&gravity acceleration=0,-1,0 /
&load kind='coordinate', coordinate=1, damping=0.5 /
&load kind='coordinate', coordinate=1, force=1, law='harmonic', amplitude=1, angular_frequency=0.6666666666666666 /
&parameter name='g', sets='load(2).force', value=1.03 /
&branch parameter='g', low=0.9, high=1.07, of='periodic' /
"""
# in numpy a pair of multipliers of the sliders leaves the unit circle at the force TORUS (tests/simulation/test_periodic_branches.py)
SLIDERS = branch_cases.SLIDERS + """&initial coordinate=1, position=-1, velocity=-0.06 /
&initial coordinate=2, position=2, velocity=-1.5 /
&parameter name='f', sets='load(4).force', value=0.6 /
&branch parameter='f', low=0.4, high=0.7, of='periodic' /
"""
TORUS = 0.530989588
FOUR_BAR = '&structure cq=4 /\n' + branch_cases.FOUR_BAR + "&branch parameter='T' /\n"
# prints a column of the points of a kind
TELL = """
def tell(branch, kind, name):
    for point in branch(kind):
        print(kind, '%.12g' % point[name])

"""
DOUBLING = 1.066372862455   # by shooting with the monodromy matrix


def write(folder, text, name='data'):
    """A data file."""
    path = folder / f'{name}.nml'
    path.write_text(text, encoding='utf-8')
    return path


@pytest.fixture
def without_auto(monkeypatch, tmp_path):
    """AUTO is not found."""
    monkeypatch.setenv('AUTO_DIR', str(tmp_path))


def link(build, data, name, *more, code=0):
    """Call mech9-link --auto: standard output and standard error."""
    done = run(build.program('mech9-link'), '--auto', data, '-o', data.parent/name, *more, timeout=300)
    assert done.returncode == code, done.stdout + done.stderr
    return done.stdout, done.stderr


def follow(build, checks, folder, text, name, commands):
    """Link the equations, and run commands of AUTO; what they print, and standard error."""
    if not os.path.exists(os.path.join(AUTO, 'lib', 'main.o')):
        checks.left_out('AUTO-07p is not installed (Debian: auto-07p)')
    checks.equal(link(build, write(folder, text), name)[0].split('\n')[-2], f'{name}.exe', 'the last file is told')
    (folder / 'commands.auto').write_text(TELL + commands, encoding='utf-8')
    done = run('auto-07p', 'commands.auto', folder=folder, timeout=600)
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout, done.stderr


def told(printed, word):
    """The numbers of the lines that begin with a word."""
    return [float(number) for number in re.findall(rf'^{word} (\S+)$', printed, re.M)]


@pytest.mark.parametrize('text, name, unit', ((SPRING + "&branch parameter='F', low=-8, high=8 /\n", 'F', 1),
                                              (SPRING + "&branch parameter='F', low=-1000, high=1000 /\n", 'F/1e3', 1000),
                                              (TRUSS, 'a_load_with_a', 1)), ids=('spring', 'a wide range', 'closed chain'))
def test_folds(checks, build, tmp_path, text, name, unit):
    """Both folds of the inclined spring; the name has the unit. A name of the files with other letters than words have."""
    printed, _ = follow(build, checks, tmp_path, text, 'snap-1.b', f"tell(run('snap-1.b'), 'LP', '{name}')\n")
    # tolerance: AUTO's 1e-8 for special points; its table has 11 digits
    checks.near(sorted(told(printed, 'LP')), [-FOLD/unit, FOLD/unit], 1e-8, 'folds', scale=1)


def ziegler(load, c):
    """The largest real part of the eigenvalues of the straight position."""
    turn = np.array([[1.0, 0.0], [1.0, 1.0]])   # absolute angles, in which the mass is simple
    mass, damping = turn.T @ np.array([[3.0, 1.0], [1.0, 1.0]]) @ turn, np.diag([c, 0.1])
    # the load turns with the second rod: its torque on the first one is -load q2
    stiffness = np.eye(2) + np.array([[0, load], [0, 0]])
    zero = np.zeros((2, 2))
    a = np.block([[zero, np.eye(2)], [-np.linalg.solve(mass, stiffness), -np.linalg.solve(mass, damping)]])
    return np.linalg.eigvals(a).real.max()


def hopf_point(c):
    """The load at which it vanishes, by bisection."""
    low, high = 1.0, 2.0
    while high - low > 1e-14:
        middle = (low + high)/2
        low, high = (low, middle) if ziegler(middle, c) > 1e-15 else (middle, high)
    return low


def test_hopf_points(checks, build, tmp_path):
    """Ziegler's pendulum: the Hopf point, its curve over the load and a damping, and the periodic motions that leave it."""
    printed, _ = follow(build, checks, tmp_path, ZIEGLER, 'flutter', """
a = run('flutter')
tell(a, 'HB', 'P/1e-1')
b = run(a('HB1'), ISW=2, ICP=[1, 2], ILP=0, NMX=20, NPR=5, UZSTOP={})
for point in b():
    print('curve %.12g' % point['P/1e-1'])
    print('damping %.12g' % point['c/1e-2'])
c = run(a('HB1'), IPS=2, ICP=[1, 11], NMX=20, NPR=20, DS=0.1)
print('period %.9g' % c()[-1]['PERIOD'])
print('load %.9g' % c()[-1]['P/1e-1'])
""")
    checks.near(told(printed, 'HB'), [10*hopf_point(0.1)], 2e-8, 'the Hopf point', scale=1)
    loads, dampings = told(printed, 'curve'), told(printed, 'damping')
    checks.true(len(loads) > 3 and abs(dampings[-1] - 10) > 1, 'the curve goes on', dampings)
    for load, damping in zip(loads, dampings):
        checks.near(ziegler(load/10, damping/100), 0, 1e-8, f'on the curve at {load}', scale=1)
    checks.true(told(printed, 'load')[0] > 14.72 and 10 < told(printed, 'period')[0] < 13, 'stable motions above the Hopf point', printed)


def test_own_period(checks, build, tmp_path):
    """A periodic motion that nothing drives: the collocation of AUTO against shooting."""
    text = (ZIEGLER.replace('position=0.02', 'position=0.5').replace('value=1 /', 'value=1.8 /').replace('high=2 /', "high=2, of='periodic' /")
            + '&periodic period=11 /\n&time end=11, intervals=10 /\n')
    printed, _ = follow(build, checks, tmp_path, text, 'cycle', "print('period %.12g' % run('cycle', NMX=2, NPR=1)()[0]['period'])\n")
    done = run(build.program('mech9d'), tmp_path/'data.nml', '--periodic', '--report', tmp_path/'report.json', '--no-write')
    assert done.returncode == 0, done.stderr
    period = json.loads((tmp_path/'report.json').read_text())['periodic']['period']
    # tolerance: 50 intervals of fourth order
    checks.near(told(printed, 'period'), [period], 1e-6, 'the period', scale=1)


def test_driven_motions(checks, build, tmp_path):
    """The driven pendulum: the doubling of its period."""
    printed, _ = follow(build, checks, tmp_path, DRIVEN, 'driven', """
tell(run('driven', SP=['PD1']), 'PD', 'g/1e-2')
""")
    # tolerance: the collocation of AUTO, 50 intervals of fourth order
    checks.near(told(printed, 'PD')[:1], [100*DOUBLING], 1e-6, 'the period doubling', scale=1)


def test_torus(checks, build, tmp_path):
    """A pair of multipliers leaves the unit circle."""
    printed, _ = follow(build, checks, tmp_path, SLIDERS, 'torus', "tell(run('torus', DS='-', SP=['TR1']), 'TR', 'f/1e-1')\n")
    checks.near(told(printed, 'TR'), [10*TORUS], 2e-8, 'the torus', scale=1)


def test_chart(checks, build, tmp_path):
    """A four-bar by its rocker: at its dead point AUTO ends, and the reason is told once. Crank 0.5, coupler 0.7, rocker 0.6."""
    _, errors = follow(build, checks, tmp_path, FOUR_BAR, 'chart', "run('chart', DS='-')\n")
    # crank and coupler in line, 1.2, against the frame to (1, 0.1)
    frame = np.hypot(1, 0.1)
    dead = np.arctan2(0.1, 1) + np.pi - np.arccos((0.36 + frame**2 - 1.44)/(1.2*frame))
    last = (tmp_path/'fort.7').read_text().splitlines()[-1].split()   # branch, point, type, label, T, norm, tenths of q4, rate
    checks.near(float(last[6])/10, dead, 1e-4, 'the dead point', scale=1)
    checks.equal(errors.count('become singular in the independent coordinates'), 1, 'the reason')


# data file behind the spring, exit code, words of the message
WRONG = (('', 3, 'has no group &branch'), ("&branch parameter='F' /", 3, 'has no range'),
         ("&branch parameter='F', low=0, high=6 /\n&friction coordinate=1, dynamic=0.3, arm=1 /", 3, 'dry friction'),
         ("&branch parameter='F', low=0, high=6 /\n&stop coordinate=1, low=-1, restitution=0.5 /", 3, 'rigid stop'),
         ("&branch parameter='F', low=0, high=6 /\n&contact point='P', link=1, kind='plane', normal=0,1,0, origin=0,-2,0 /", 3, 'touch each other'),
         ("&branch parameter='F', low=0, high=6, of='position' /", 3, 'position'),
         ("&branch parameter='F', low=0, high=6, of='periodic' /", 3, 'period of its own'),
         ("&branch parameter='F', low=0, high=6, of='periodic' /\n&periodic period=2 /", 3, 'leads to a position of rest'),
         ("&branch parameter='F', low=0, high=6, of='periodic' /\n&periodic period=1.6 /\n&initial coordinate=1, velocity=2 /", 3, 'conserves energy'),
         ("&branch parameter='F', low=0, high=6 /\n" + '\n'.join(
             f"&load kind='force', link=2, force=0,1,0 /\n&parameter name='p{i}', sets='load({i}).force(1)', value=1 /" for i in range(3, 12)),
          3, 'room for 9 parameters'))


@pytest.mark.parametrize('groups, code, words', WRONG, ids=[words for _, _, words in WRONG])
@pytest.mark.usefixtures('without_auto')
def test_refusals(checks, build, tmp_path, groups, code, words):
    text = SPRING.replace(', position=0.6', '').replace('&initial coordinate=1 /', '&initial coordinate=1, position=0.6 /')
    if 'velocity' in groups:
        text = text.replace('position=0.6 /', 'position=0.6, velocity=2 /')
        groups = groups.replace('\n&initial coordinate=1, velocity=2 /', '')
    _, errors = link(build, write(tmp_path, text + groups), 'wrong', code=code)
    checks.true(words in errors, f'says {words}', errors)
    checks.true(errors.count('data.nml') <= 1, 'the place is told once', errors)
    checks.true(not os.path.exists(tmp_path/'wrong.f90'), 'nothing is written')


@pytest.mark.usefixtures('without_auto')
def test_no_inertia(checks, build, tmp_path):
    """Failures that every state has are told at once."""
    _, errors = link(build, write(tmp_path, SPRING.replace('&body link=2, mass=1 /', '') + "&branch parameter='F', low=0, high=6 /\n"), 'wrong', code=6)
    checks.true('without moving any mass' in errors, 'the reason', errors)


@pytest.mark.usefixtures('without_auto')
def test_files(checks, build, tmp_path):
    """Without AUTO the files are written all the same; others than its own are not replaced; a user procedure is linked in."""
    data = write(tmp_path, SPRING + "&branch parameter='F', low=0, high=6 /\n")
    said, errors = link(build, data, 'one', code=1)
    checks.true('one.f90, c.one' in said and 'AUTO-07p is not in' in errors, 'AUTO is missed', said + errors)
    link(build, data, 'one', code=1)
    (tmp_path/'c.two').write_text('NDIM=1\n')
    checks.true('did not write it' in link(build, data, 'two', code=8)[1], 'constants of the user stay')
    checks.true('letters, digits' in link(build, data, "it's", code=2)[1], 'a name with a quotation mark')
    shutil.copy(os.path.join(TREE, 'user_procs', 'air_drag', 'air_drag.f90'), tmp_path)
    said, _ = link(build, data, 'three', tmp_path/'air_drag.f90', code=1)
    checks.true('with your user_force' in said, 'the user procedure is told', said)
