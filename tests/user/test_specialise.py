"""mech9-link --specialise: programs that are made for one mechanism. Their motions are held against closed forms and the general programs; what may
change, what is refused, and dead points, where the general code takes over.

Compares the program with itself in part: the made programs and the general ones.
"""
import os
import re

import numpy as np
import pytest

from jets import Jet, arccos, check_coordinate, cos, sin, sqrt
from mech9_cases import TREE, run, table_and_report, table_of, text_of

FOUR_BAR = os.path.join(TREE, 'bench', 'data', 'four_bar.nml')
SIX_BAR = os.path.join(TREE, 'bench', 'data', 'six_bar.nml')
# a crank slider whose guide is inclined, a rod on its slider, in a plane across y, in mm and degrees; a second chain drives an open arm
SLIDER = """&mechanism length_unit='mm', angle_unit='deg' /
&structure cq=1 /
&pair coordinate=1, links=1,2, kind='revolute', axis=0,-1,0, point=10,3,-20 /
&pair coordinate=2, links=2,3, kind='revolute', axis=0,1,0, point=80,0,0, moving_point=0,0,0 /
&pair coordinate=3, links=3,4, kind='revolute', axis=0,-1,0, point=250,0,0, moving_point=0,0,5 /
&pair coordinate=4, links=1,4, kind='prismatic', axis=3,0,1, point=0,3,15, zero=0,1,0 /
&pair coordinate=5, links=4,5, kind='revolute', axis=0,1,0, point=30,0,0, moving_point=0,0,0 /
&pair coordinate=6, links=5,6, kind='prismatic', axis=1,0,0, point=0,0,0, moving_point=0,0,0 /
&pair coordinate=7, links=1,6, kind='revolute', axis=0,-1,0, point=400,0,220, moving_point=0,0,0 /
&initial coordinate=4, position=300 /
&initial coordinate=6, position=250 /
&point name='P', link=5, position=100,0,20 /
&point name='Q', link=3, position=100,0,20 /
&drive coordinate=1, kind='harmonic', mean=30, amplitude=500, angular_frequency=90 /
&time start=0, end=10, intervals=400 /
"""
# a crank that cannot turn round: a dead point ends its motion
ROCKER = text_of(FOUR_BAR).replace('point=0.15,0,0', 'point=0.28,0,0').replace('coefficients=0,10', 'coefficients=0.9,1').replace(
    'intervals=10000', 'intervals=20').replace('end=0.6283185307179586', 'end=6')
PARAMETERS = text_of(FOUR_BAR).replace('intervals=10000', 'intervals=90') + """&parameter name='crank', sets='pair(2).point(1)', low=0.1, high=0.2, count=3 /
&parameter name='twice', formula='2*crank + 0.05', sets='pair(4).moving_point(1)' /
&study kind='grid' /
"""


def ladder(chains):
    """Four-bars one after the other, each driven by the rocker before it, of which all but the first have one form. A parameter moves the
    pins of the rockers that follow, in steps of four chains. The row of bearings lies across both axes."""
    slope = 0.8
    lines = [f"&mechanism links={2 + 2 * chains}, coordinates={1 + 3 * chains} /", '&structure cq=1 /',
             "&pair coordinate=1, links=1,2, kind='revolute', axis=0,0,1 /"]
    before = 2
    for i in range(chains):
        k, link = 2 + 3 * i, 3 + 2 * i
        place = 0.4 + 0.403 * i
        # the last chain has the first numbers of coordinates, so that these are not those of the steps
        number = [2 + 3 * (chains - 1 - i) + j for j in range(3)]
        pin, coupler, first = (0.15, 0.35, (1.0, 1.8 + slope, -0.8)) if i == 0 else (0.3, 0.41, (-1.8, 1.8 + slope, -1.8))
        lines += [f"&pair coordinate={number[0]}, links={before},{link}, kind='revolute', axis=0,0,1, point={pin},0,0, moving_point=0,0,0 /",
                  f"&pair coordinate={number[1]}, links=1,{link + 1}, kind='revolute', axis=0,0,1, moving_point=0,0,0, "
                  f'point={place * np.cos(slope):.15f},{place * np.sin(slope):.15f},0 /',
                  f"&pair coordinate={number[2]}, links={link + 1},{link}, kind='revolute', axis=0,0,1, point=0.3,0,0, moving_point={coupler},0,0 /"]
        lines += [f'&initial coordinate={number[j]}, position={first[j]} /' for j in range(3)]
        if i % 4 == 3:
            lines.append(f"&parameter name='pin{i}', {'value=0.3' if i == 3 else 'formula=' + chr(39) + 'pin3' + chr(39)}, "
                         f"sets='pair({k + 2}).point(1)' /")
        before = link + 1
    return '\n'.join(lines) + f"""
&drive coordinate=1, kind='polynomial', coefficients={slope},10 /
&time start=0, end=0.01, intervals=20 /
"""


def written(folder, text, name='data.nml'):
    """A data file."""
    path = folder / name
    path.write_text(text, encoding='utf-8')
    return path


def made(build, folder, data, name='rig'):
    """Make the programs for a data file; gives the path of NAME_k."""
    done = run(build.program('mech9-link'), '--specialise', data, '-o', folder / name, folder=folder, timeout=600)
    assert done.returncode == 0, done.stderr
    assert f'{name}.f90 (' in done.stdout and f'{name}_k (with code for' in done.stdout, done.stdout
    return folder / f'{name}_k'


def compare(checks, table, other, name, tolerance=1e-11):
    """Two tables agree to round-off: of the closed positions 1e-15 over the least pivot, about 0.1, twice more for accelerations; largest of
    a kind of columns as the scale."""
    checks.equal(list(table), list(other), f'{name}: the same columns')
    for column in table:
        scale = max(np.max(np.abs(other[column])), 1.0)
        checks.near(table[column], other[column], tolerance, f'{name}: {column}', scale=scale)


@pytest.fixture(scope='module')
def four_bar(build, tmp_path_factory):
    folder = tmp_path_factory.mktemp('four_bar')
    return made(build, folder, FOUR_BAR)


def test_closed_form(checks, four_bar):
    """The rocker's angle and the coupler's by the law of cosines."""
    table = table_of(four_bar, FOUR_BAR, '--set', 'time.intervals=360')
    crank = Jet(10.0 * table['t'], 10.0, 0.0)
    x, y = 0.4 - 0.15 * cos(crank), -0.15 * sin(crank)
    diagonal = sqrt(x * x + y * y)
    check_coordinate(checks, table, 1, crank, 'four-bar')
    # the angle at the rocker's bearing between the diagonal to the crank's pin and the rocker
    inner = arccos((diagonal * diagonal + (0.3**2 - 0.35**2)) / (0.6 * diagonal))
    rocker_x, rocker_y = 0.3 * np.cos(table['q3']), 0.3 * np.sin(table['q3'])
    checks.near((rocker_x - (-0.4 + 0.15 * np.cos(10 * table['t'])))**2 + (rocker_y - 0.15 * np.sin(10 * table['t']))**2, 0.35**2, 1e-14,
                'the coupler keeps its length')
    along = (-rocker_x * x.value - rocker_y * y.value) / (0.3 * diagonal.value)
    checks.near(along, np.cos(inner.value), 1e-13, 'four-bar: angle at the bearing')


@pytest.mark.parametrize('name, text', (('four_bar', text_of(FOUR_BAR)), ('six_bar', text_of(SIX_BAR)), ('slider', SLIDER)),
                         ids=('four_bar', 'six_bar', 'slider'))
def test_as_the_general_program(checks, build, mech9k, four_bar, tmp_path, name, text):
    data = written(tmp_path, text.replace('intervals=10000', 'intervals=180'))
    program = four_bar if name == 'four_bar' else made(build, tmp_path, data)
    for options in ((), ('--set', 'output.derivatives=0'), ('--set', 'time.intervals=11')):
        table, report = table_and_report(program, data, *options)
        other, other_report = table_and_report(mech9k, data, *options)
        compare(checks, table, other, f'{name} {options}')
        for fact in ('steps', 'halvings'):
            checks.equal(report[fact], other_report[fact], f'{name} {options}: {fact}')


def test_the_code_is_used(checks, build, four_bar, tmp_path):
    """A fault that is put into the code shows in the results; the code alone needs nothing but Fortran."""
    text = text_of(f'{os.fspath(four_bar)[:-2]}.f90')
    right = re.search(r'^ *ddq\(2\) = .*$', text, re.M).group(0)
    faulty = written(tmp_path, text.replace(right, right.replace('= -', '= -2.0_wp*')), 'faulty.f90')
    done = run(build.program('mech9-link'), '-o', tmp_path / 'faulty', faulty, folder=tmp_path, timeout=600)
    checks.equal(done.returncode, 0, f'a program of the changed code: {done.stderr}')
    right, wrong = (table_of(program, FOUR_BAR, '--set', 'time.intervals=3600') for program in (four_bar, tmp_path / 'faulty_k'))
    # the general code takes over where the fault spoils the prediction
    checks.near(np.median(wrong['ddq2'] / right['ddq2']), 2.0, 1e-9, 'the fault shows')
    alone = written(tmp_path, text[:text.index('! The way from the programs')], 'alone.f90')
    done = run('gfortran', '-std=f2008', '-Wall', '-Wextra', '-Wno-unused-dummy-argument', '-Werror', '-c', alone, folder=tmp_path)
    checks.equal(done.returncode, 0, f'standard Fortran: {done.stderr}')


def test_chains_of_equal_form(checks, build, mech9k, tmp_path):
    """A hundred links: chains of equal form share their code, which is not long. They are small in lengths of the mechanism, and far from its
    base; a small fault in the code shows in each of them."""
    data = written(tmp_path, ladder(49))
    program = made(build, tmp_path, data)
    text = text_of(tmp_path / 'rig.f90')
    checks.true(len(text) <= 200000, 'at most 200 kB for 100 links', f'{len(text)}')
    checks.equal(len(re.findall('end subroutine form_', text)), 2, 'chains with and without a parameter share procedures')
    for setting in ((), ('--set', 'parameter(1).value=0.31')):
        # round-off over least pivots of 1e-2, once more for accelerations, which grows over 49 chains: 1e-12 was found
        compare(checks, table_of(program, data, *setting), table_of(mech9k, data, *setting), f'ladder {setting}', 1e-10)
    right = re.findall(r'^ *ddq\(k\(\d+\)\) = -.*$', text, re.M)
    faulty = text
    for line in right:
        faulty = faulty.replace(line, line.replace('= -', '= -1.001_wp*'))
    done = run(build.program('mech9-link'), '-o', tmp_path / 'faulty', written(tmp_path, faulty, 'faulty.f90'), folder=tmp_path, timeout=600)
    checks.equal(done.returncode, 0, f'a program of the changed code: {done.stderr}')
    right, wrong = (table_of(path, data) for path in (program, tmp_path / 'faulty_k'))
    for k in range(2, 146, 3):
        checks.true(np.max(np.abs(wrong[f'ddq{k}'] - right[f'ddq{k}'])) > 1e-4 * np.max(np.abs(right[f'ddq{k}'])), f'chain of {k}: the fault shows')


REFUSED = (('pair(3).point=0.41,0,0', '&pair 3 differs: there "point = 0.4, 0, 0", here "point = 0.41, 0, 0"'),
           ('drive.coefficients=0,11', '&drive 1 differs: there "coefficients = 0, 10", here "coefficients = 0, 11"'),
           ('initial(2).position=-1.8', '&initial 2 differs'))


@pytest.mark.parametrize('setting, words', REFUSED, ids=[setting for setting, _ in REFUSED])
def test_other_mechanisms_are_refused(checks, four_bar, setting, words):
    done = run(four_bar, FOUR_BAR, '--no-write', '--set', setting)
    checks.equal(done.returncode, 3, f'{setting}: exit code')
    checks.true(words in done.stderr and 'was made for the mechanism of four_bar.nml' in done.stderr, f'{setting}: names it', done.stderr)


def test_another_group_is_refused(checks, four_bar, tmp_path):
    data = written(tmp_path, text_of(FOUR_BAR) + '&body link=2, mass=1 /\n')
    done = run(four_bar, data, '--no-write')
    checks.equal(done.returncode, 3, 'exit code')


def test_what_may_change(checks, four_bar, mech9k, tmp_path):
    """Times, points, results and comments."""
    text = text_of(FOUR_BAR).replace('0.20,0.10,0', '0.1,0,0').replace('end=0.6', 'end=0.4').replace('intervals=10000', 'intervals=50')
    data = written(tmp_path, '! another comment\n' + text + "&output velocities='P', coordinates=2 /\n".replace("velocities='P', ", ''))
    compare(checks, table_of(four_bar, data), table_of(mech9k, data), 'other outputs')


def test_parameters(checks, build, mech9k, tmp_path):
    """Numbers that parameters and their formulas set may change; a study has the same rows."""
    data = written(tmp_path, PARAMETERS)
    program = made(build, tmp_path, data)
    for setting in ('crank=0.12', 'pair(2).point(1)=0.17', 'crank=0.15'):
        words = ('--set', setting if '(' in setting else f'parameter(1).value={setting[6:]}')
        compare(checks, table_of(program, data, *words), table_of(mech9k, data, *words), f'parameters: {setting}')
    done = run(program, data, '--no-write', '--set', 'pair(2).point(2)=0.01')
    checks.equal(done.returncode, 3, 'a number beside that of the parameter is refused')
    for name in ('made', 'general'):
        done = run(program if name == 'made' else mech9k, data, '--study', '--quiet', '--table', tmp_path / name, folder=tmp_path)
        checks.equal(done.returncode, 0, f'study: {done.stderr}')
    made_rows, general_rows = (re.sub(r'^#.*\n', '', text_of(tmp_path / name), flags=re.M).split() for name in ('made', 'general'))
    checks.equal(len(made_rows), len(general_rows), 'a study has the same rows')


def test_dead_point(checks, build, mech9k, tmp_path):
    """The motion ends at the same place with the same words."""
    data = written(tmp_path, ROCKER)
    program = made(build, tmp_path, data)
    ends = [run(way, data, '--no-write', folder=tmp_path) for way in (program, mech9k)]
    checks.equal([end.returncode for end in ends], [6, 6], 'both end at the dead point')
    # numbers of the last position may differ in their last digits
    said = [re.sub(r'(\d\.\d{8})\d*', r'\1', re.sub('.* to solve, .*\n', '', end.stderr)) for end in ends]
    said = [re.sub('largest closure .*', '', words) for words in said]
    checks.equal(*said, 'the same words')


def test_calls(checks, build, tmp_path):
    """Wrong calls, and files that it did not write."""
    link = build.program('mech9-link')
    for words, code, text in ((('--specialise',), 2, 'needs a data file'), (('--specialise', FOUR_BAR), 2, f'mech9-link --specialise {FOUR_BAR} -o rig'),
                              (('--specialise', 'nowhere.nml', '-o', 'rig'), 8, 'there is no file nowhere.nml'),
                              (('--specialise', FOUR_BAR, '--auto', FOUR_BAR, '-o', 'rig'), 2, 'give one of them')):
        done = run(link, *words, folder=tmp_path)
        checks.equal(done.returncode, code, f'{words}: exit code')
        checks.true(text in done.stderr, f'{words}: {text}', done.stderr)
    written(tmp_path, 'end\n', 'mine.f90')
    done = run(link, '--specialise', FOUR_BAR, '-o', tmp_path / 'mine', folder=tmp_path)
    checks.equal(done.returncode, 8, 'a file of its user stays')
    done = run(link, '--specialise', written(tmp_path, "&mechanism links=2 /\n"), '-o', 'bad', folder=tmp_path, timeout=600)
    checks.true(done.returncode in (3, 4) and not (tmp_path / 'bad_k').exists(), 'a data file with errors', done.stderr)
