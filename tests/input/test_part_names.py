"""Names of links and pairs: a file with names gives the bits of the same file with numbers, --set finds groups by names, and wrong names are
told with their place.

Compares the program with itself: names with numbers.
"""
import os
import re

import numpy as np
import pytest

from mech9_cases import run, table_of

DONE, DATA, STRUCTURE = 0, 3, 4

LINKS = {'2': 'crank', '3': 'coupler', '4': 'rocker', '1': 'base'}
PAIRS = {'1': 'A', '2': 'B', '3': 'C', '4': 'D'}
# <2> stands for link 2, [2] for pair 2
TEXT = """&mechanism title='four-bar' /
{names}&structure cq=[1] /
&pair coordinate=1, {A}links=<1>,<2>, kind='revolute', axis=0,0,1 /
&pair coordinate=2, {B}links=<2>,<3>, kind='revolute', axis=0,0,1, point=0.3,0,0, moving_point=0,0,0 /
&pair coordinate=3, {C}links=<3>,<4>, kind='revolute', axis=0,0,1, point=1,0,0, moving_point=0.8,0,0 /
&pair coordinate=4, {D}links=<1>,<4>, kind='revolute', axis=0,0,1, point=0.9,0,0, moving_point=0,0,0 /
&initial coordinate=[4], position=1.2 /
&point name='P', link=<3>, position=0.5,0.1,0 /
&body link=<3>, mass=2, centre=0.5,0,0, inertia=0,0,0.1,0,0,0 /
&body link=<2>, mass=1, inertia=0,0,0.1,0,0,0 /
&load kind='force', link=<3>, force=0,-3,0 /
&load kind='spring', links=<1>,<3>, second_position=0.2,0,0, stiffness=2 /
&load kind='coordinate', coordinate=[4], damping=0.3 /
&stop coordinate=[4], low=-9, high=9 /
&friction coordinate=[3], dynamic=0.1, radius=0.01 /
{contact}&quantity name='swing', of='{of}', take='range' /
&time end=0.2, intervals=8 /
&output reactions=.true., coordinates=[1],[4], reaction_pairs=[2],[4] /
"""
DRIVE = "&drive coordinate=[1], kind='polynomial', coefficients=0.4, 10 /\n&cam link=<2>, follower=<3>, guide=[3] /\n"
CONTACT = "&contact point='P', link=<1>, origin=0,-9,0, normal=0,1,0 /\n"
START = '&initial coordinate=[1], position=0.4, velocity=3 /\n'


def numbered(text, contact=''):
    text = text.replace('{contact}', contact)
    for number in LINKS:
        text = text.replace(f'<{number}>', number).replace(f'[{number}]', number)
    return text.format(names='', A='', B='', C='', D='', of='q4')


def named(text, contact=''):
    text = text.replace('{contact}', contact)
    for number, name in LINKS.items():
        text = text.replace(f'<{number}>', f"'{name}'")
    for number, name in PAIRS.items():
        text = text.replace(f'[{number}]', f"'{name}'")
    links = ''.join(f"&link number={number}, name='{name}' /\n" for number, name in LINKS.items())
    return text.format(names=links, of='D.q', **{name: f"name='{name}', " for name in PAIRS.values()})


def write(folder, text, name='case.nml'):
    path = os.path.join(folder, name)
    with open(path, 'w', encoding='utf-8') as file:
        file.write(text)
    return path


@pytest.mark.parametrize('motion', (DRIVE, START), ids=('driven', 'free'))
def test_names_give_the_bits_of_numbers(checks, build, motion, tmp_path):
    program = build.program('mech9k' if motion is DRIVE else 'mech9d')
    text = TEXT + motion.replace('&cam', '!&cam')
    without_friction = text.replace('&friction', '!&friction')
    for given, contact in ((text, ''), (without_friction, CONTACT)):
        tables = [table_of(program, write(tmp_path, form(given, contact), f'{form.__name__}.nml')) for form in (numbered, named)]
        checks.true(list(tables[0]) == list(tables[1]), 'columns stay numbered')
        checks.true(all(np.array_equal(tables[0][column], tables[1][column]) for column in tables[0]), 'names give the bits of numbers')
    said = [run(program, os.path.join(tmp_path, f'{form.__name__}.nml'), '--table', os.devnull).stderr for form in (numbered, named)]
    checks.true('swing' in said[0] and 'swing' in said[1], 'a quantity of a column by its name')


def test_joints_have_names(checks, mech9d, tmp_path):
    text = """&mechanism /
&structure cq={cq} /
&pair coordinates=1,2,3,{name} links=1,2, kind='spherical' /
&pair coordinate=4, links=2,3, kind='revolute', axis=0,1,0, point=0.5,0,0 /
&initial coordinate={first}, position=0.3, velocity=1 /
&initial coordinate={third}, position=0.2 /
&initial coordinate={second}, position=0.1 /
&initial coordinate=4, position=0.1 /
&body link=2, mass=1, centre=0.2,0,0, inertia=0.1,0.2,0.2,0,0,0 /
&body link=3, mass=1, centre=0.2,0,0, inertia=0.1,0.2,0.2,0,0,0 /
&gravity acceleration=0,0,-9.81 /
&time end=0.1, intervals=5 /
&quantity name='last', of='{of}', take='end' /
"""
    plain = table_of(mech9d, write(tmp_path, text.format(cq='1,2,3,4', name='', first=1, second=2, third=3, of='ddq2'), 'numbers.nml'))
    path = write(tmp_path, text.format(cq="'J(1)','J(2)','J(3)',4", name=" name='J',", first="'J(1)'", second="'J(2)'", third="'J(3)'", of='J(2).ddq'))
    by_names = table_of(mech9d, path)
    checks.true(all(np.array_equal(plain[column], by_names[column]) for column in plain), 'coordinates of a joint by its name')
    done = run(mech9d, path, '--set', 'initial(1).coordinate=J')
    checks.true(done.returncode == DATA and "pair 'J' has 3 coordinates; write 'J(1)' for the first one" in done.stderr, f'a joint alone: {done.stderr}')


def test_set_finds_groups_by_their_names(checks, mech9k, tmp_path):
    path = write(tmp_path, named(TEXT + DRIVE).replace('&cam', '!&cam') + "&parameter name='rod', sets='pair(C).point(1)', value=1 /\n")
    for by_name, by_number in (('pair(B).point(1)=0.35', 'pair(2).point(1)=0.35'), ("pair('B').point(1)=0.35", 'pair(2).point(1)=0.35'),
                               ('body(coupler).mass=3', 'body(1).mass=3'), ('body(crank).mass=3', 'body(2).mass=3'),
                               ('drive(A).coefficients(2)=12', 'drive.coefficients(2)=12'), ('initial(D).position=1.1', 'initial.position=1.1'),
                               ('parameter(rod).value=1.1', 'parameter.value=1.1'), ('point(P).link=rocker', 'point.link=4'),
                               ('output.coordinates=A,D', 'output.coordinates=1,4'), ('quantity(swing).of=D.dq', 'quantity.of=dq4')):
        tables = [table_of(mech9k, path, '--set', setting) for setting in (by_name, by_number)]
        checks.true(list(tables[0]) == list(tables[1]) and all(np.array_equal(tables[0][column], tables[1][column]) for column in tables[0]), by_name)
    for setting, words in (('pair(E).point(1)=0.35', "there is no &pair of the name 'E'"), ('body(rocker).mass=3', "there is no &body of the name 'rocker'"),
                           ('load(coupler).force=0,0,0', ''), ('link(crank).number=9', 'names link 9 (crank)'),
                           ('pair(b).point(1)=0.35', "there is no &pair of the name 'b'")):
        done = run(mech9k, path, '--set', setting, '--quiet')
        checks.true((done.returncode in (DATA, STRUCTURE)) == bool(words) and words in done.stderr, f'{setting}: {done.stderr}')


@pytest.mark.parametrize('change, words, caret', (
    (("link='coupler'", "link='couple'"), "there is no link with the name 'couple'; did you mean 'coupler'?", "'couple'"),
    (("coordinate='D', position", "coordinate='d', position"), "there is no pair with the name 'd'", "'d'"),
    (("name='coupler' /", "name='crank' /"), "a second link has the name 'crank'; the first stands in line 2", "'crank'"),
    (("name='B'", "name='A'"), "a second pair has the name 'A'; the first stands in line 7", "'A'"),
    (("name='B'", "name='2'"), 'the name of a pair is of letters (a to z), digits and _, at most 40 of them, and begins with no digit', "'2'"),
    (("name='B'", "name='B.1'"), 'the name of a pair is of letters', "'B.1'"),
    (("name='B'", "name=''"), 'the name of a pair is of letters', "''"),
    (("name='B'", "name='" + 41 * 'x' + "'"), 'at most 40 of them', "'xxx"),
    (("number=4, name='rocker'", "number=2, name='rocker'"), 'a second &link for number 2', '2'),
    (("&link number=2, name", "&link number=5, name"), 'link 2 is not connected to link 1 (base)', '&structure'),
    (("name='rocker' /", "name='L2' /"), 'begin with L2; give another name', "'L2'"),
    (("name='B'", "name='R3'"), 'begin with R3; give another name', "'R3'"),
    (("links='base','crank'", "links='base',crank"), "'links' takes whole numbers, and crank is none", 'crank'),
    (("moving_point=0.8,0,0", "moving_point=9,0,0"), '', ''),
))
def test_wrong_names_are_told_with_their_place(checks, mech9k, tmp_path, change, words, caret):
    text = named(TEXT + DRIVE).replace('&cam', '!&cam')
    checks.true(change[0] in text, f'the change is one: {change[0]}')
    done = run(mech9k, write(tmp_path, text.replace(*change, 1)), '--check')
    if not caret:
        checks.true(done.returncode != DONE and '(D)' in done.stderr, f'names in a message: {done.stderr}')
        return
    checks.true(done.returncode in (DATA, STRUCTURE) and words in done.stderr, f'{words}: {done.stderr}')
    lines = done.stderr.splitlines()
    at = next(i for i, line in enumerate(lines) if words in line)
    checks.true(lines[at + 1][lines[at + 2].index('^'):].startswith(caret), f'the place of {words}: {done.stderr}')


def test_one_wrong_name_is_one_error(checks, mech9k, tmp_path):
    """A wrong link does not make the number of coordinates wrong, and a second group for a link takes no name away."""
    text = named(TEXT + DRIVE).replace('&cam', '!&cam')
    for change, words in ((("links='base','crank'", "links='base','crnk'"), 'there is no link with the name'),
                          (("&structure", "&link number=2, name='arm' /\n&structure"), 'a second &link for number 2')):
        done = run(mech9k, write(tmp_path, text.replace(*change, 1)), '--check')
        told = [line for line in done.stderr.splitlines() if line.startswith(str(tmp_path))]
        checks.true(done.returncode == DATA and len(told) == 1 and words in told[0], f'{change[1]}: one error', done.stderr)
    # the name of its own columns is allowed
    done = run(mech9k, write(tmp_path, text.replace("'rocker'", "'L4'").replace("'B'", "'R2'")), '--check')
    checks.equal(done.returncode, DONE, done.stderr)


def test_values_of_coordinates_have_names(checks, mech9k, mech9d, tmp_path):
    """The crank of a double rocker comes to a dead point: the message tells the value of the coordinate with its name."""
    text = named(TEXT + DRIVE).replace('&cam', '!&cam').replace('&output', '!&output')
    text = text.replace('point=0.9,0,0', 'point=1.9,0,0').replace('point=0.3,0,0', 'point=0.6,0,0')
    done = run(mech9k, write(tmp_path, text), '--table', os.devnull, '--set', 'time.end=2')
    checks.true(done.returncode == 6 and ' at q1 (A) = ' in done.stderr, 'the dead point is told', done.stderr)
    # without a drive, other independent coordinates take over there
    free = named(TEXT + START).replace('&output', '!&output').replace('&stop', '!&stop').replace('&friction', '!&friction')
    free = free.replace('point=0.9,0,0', 'point=1.9,0,0').replace('point=0.3,0,0', 'point=0.6,0,0')
    done = run(mech9d, write(tmp_path, free, 'free.nml'), '--table', os.devnull, '--set', 'time.end=2')
    checks.true(done.returncode == DONE and re.search(r'independent coordinates are now \d \([ABCD]\)', done.stderr), 'changes of coordinates', done.stderr)


SWING = """&mechanism title='swing' /
&structure cq=1 /
&pair coordinate=1, name='hip', links=1,2, kind='revolute', axis=0,0,1 /
&body link=2, mass=1, centre=0,1,0 /
&gravity acceleration=0,-9.81,0 /
&load kind='coordinate', coordinate='hip', stiffness=5 /
&parameter name='k', sets='load(1).stiffness', value=5, low=2, high=20 /
&initial coordinate='hip', position=0.1 /
&time end=2, intervals=4 /
"""


def heading_of(path):
    with open(path, encoding='utf-8') as file:
        return next(line for line in file if not line.startswith('#')).split()


def test_names_in_other_tables_and_plots(checks, mech9d, tmp_path):
    """Columns of sections, equilibria, modes and branches by the names of pairs, also in requests for plots, whose labels have them."""
    section = SWING + "&section column='hip.dq', value=0.1, table='section.dat' /\n"
    done = run(mech9d, write(tmp_path, section), '--quiet', '--names', '--table', 'run.dat', '--plot', 'run.svg:hip.q', '--plot', 'points.svg:section:hip.q',
               folder=tmp_path)
    checks.equal(done.returncode, DONE, done.stderr)
    checks.equal(heading_of(tmp_path / 'section.dat')[2:4], ['hip.q', 'hip.dq'], 'a section')
    path = write(tmp_path, SWING + "&branch parameter='k', of='equilibrium' /\n", 'branch.nml')
    done = run(mech9d, path, '--names', '--branch', 'k', '--table', 'branch.dat', '--plot', 'branch.svg:hip.q', folder=tmp_path)
    checks.true(done.returncode == DONE and ', q1 (hip) = 0' in done.stderr, 'words about branches', done.stderr)
    checks.equal(heading_of(tmp_path / 'branch.dat')[3], 'hip.q', 'branches')
    for option, names in (('--equilibrium', ['hip.q']), ('--modes', ['hip.q.re', 'hip.q.im'])):
        done = run(mech9d, write(tmp_path, SWING), option, '--names', '--table', 'rest.dat', folder=tmp_path)
        checks.true(done.returncode == DONE and set(names) <= set(heading_of(tmp_path / 'rest.dat')), option, done.stderr)
    for plot, label in (('run', 'ylabel'), ('points', 'ylabel'), ('branch', 'ylabel')):
        script = (tmp_path / f'{plot}.gp').read_text(encoding='utf-8')
        checks.true(f"set {label} 'hip.q [rad]'" in script, f'the label of {plot}', script[-800:])
    # the table of a run keeps its numbers without --names, and the label has the name
    done = run(mech9d, write(tmp_path, SWING), '--quiet', '--table', 'plain.dat', '--plot', 'plain.svg:hip.q', folder=tmp_path)
    script = (tmp_path / 'plain.gp').read_text(encoding='utf-8')
    checks.true(done.returncode == DONE and "'q1'" in script and "set ylabel 'hip.q [rad]'" in script, 'a plot of a table with numbers', script[-800:])
