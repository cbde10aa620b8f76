"""Forces of drives and in pairs: against equations of balance in absolute coordinates (dense_forces), against forms by hand, and by
what must not change them.
"""
import os
import re

import numpy as np
import pytest

from data_file import parse, write
from force_files import COMPONENTS, compare, example, forces_of, revolute, rotated, rotation, with_links, with_masses, wrenches
from mech9_cases import TREE, read_table, run, text_of

EXAMPLES = [('andrews', None), ('bricard', None), ('double_pendulum', None), ('flyball_governor', None), ('heavy_top', None),
            ('n_four_bar', 'n_four_bar_2.nml'), ('n_four_bar', 'n_four_bar_40.nml'), ('pendulum', None),
            ('pendulum_four_bar', None), ('slider_crank_sundials', 'slider_crank.nml')]
WITHOUT_BODIES = ('fig1', 'slider_crank', 'watt_parallel_motion', 'peaucellier', 'jansen_leg', 'whitworth', 'class_three_group', 'bennett',
                  'sarrus', 'double_hooke', 'rsur', 'palletising_arm')
IN_A_PLANE = ('fig1', 'slider_crank', 'peaucellier', 'jansen_leg', 'whitworth', 'class_three_group', 'palletising_arm')


@pytest.fixture
def rng():
    return np.random.default_rng(5)


@pytest.mark.parametrize('name, file', EXAMPLES, ids=[file or name for name, file in EXAMPLES])
def test_examples_with_bodies(checks, mech9d, name, file):
    compare(checks, mech9d, example(name, file), name, intervals=2)


@pytest.mark.parametrize('name', WITHOUT_BODIES)
def test_examples_with_bodies_of_their_own(checks, mech9k, rng, name):
    compare(checks, mech9k, with_masses(rng, example(name)), name, intervals=3)


def test_platform(checks, mech9k, rng):
    platform = parse(text_of(os.path.join(TREE, 'tests', 'reference', 'stewart_gough_by_hand.nml')))
    compare(checks, mech9k, with_masses(rng, platform), 'stewart_gough', intervals=3)


@pytest.mark.parametrize('name', IN_A_PLANE)
def test_flat_examples(checks, mech9k, rng, name):
    compare(checks, mech9k, with_masses(rng, example(name), flat=True), f'{name}, flat', intervals=2)


@pytest.mark.parametrize('load', [
    pytest.param({'kind': ['force'], 'link': [3], 'force': [0.0, 0.0, 2.0]}, id='force'),
    pytest.param({'kind': ['torque'], 'link': [3], 'torque': [1.5, 0.0, 0.0]}, id='torque'),
    pytest.param({'kind': ['force'], 'link': [3], 'position': [0.1, 0.2, 0.3], 'force': [2.0, 1.0, 0.0]}, id='place of a force')])
def test_flat_but_for_one_load(checks, mech9k, rng, load):
    compare(checks, mech9k, with_masses(rng, example('fig1'), flat=True) + [('load', load)], 'fig1, flat but for one load', intervals=1)


@pytest.mark.parametrize('group, changes', [
    pytest.param('body', {'inertia': [0.3, 0.4, 0.5, 0.02, 0.1, 0.0]}, id='product of inertia'),
    pytest.param('body', {'centre': [0.1, 0.2, 0.15]}, id='centre'),
    pytest.param('gravity', {'acceleration': [1.0, -9.0, 2.0]}, id='gravity')])
def test_flat_but_for_one_number(checks, mech9k, rng, group, changes):
    flat = with_masses(rng, example('fig1'), flat=True)
    number = next(i for i, (other, _) in enumerate(flat) if other == group)
    groups = flat[:number] + [(group, {**flat[number][1], **changes})] + flat[number + 1:]
    compare(checks, mech9k, groups, 'fig1, flat but for one number', intervals=1)


def test_flat_but_for_the_height_of_one_pair(checks, mech9k, rng):
    """The same pairs at different heights."""
    raised = [(group, {**items, 'point': [*items['point'][:2], 0.2], 'moving_point': [*items.get('moving_point', items['point'])[:2], 0.2]}
               if group == 'pair' and items['coordinate'] == [2] and 'point' in items else items)
              for group, items in with_masses(rng, example('fig1'), flat=True)]
    compare(checks, mech9k, raised, 'fig1, flat but for the height of one pair', intervals=1)


# Components that equilibrium does not determine, told beforehand by hand.
BODY = "&body link=2, mass=1, centre=0.1,0.2,0.3 /\n&gravity acceleration=1,-9.81,2 /\n"


def check_unique(checks, program, groups, expected, why, **options):
    """`expected` are the components of each pair that are not unique."""
    pattern = compare(checks, program, groups, why, **options)
    if pattern is None:
        checks.left_out('the Python package h5py is not installed (Debian: python3-h5py)')
    else:
        checks.equal(pattern, expected, f'{why}: components that are not unique')


def test_door_on_two_hinges(checks, mech9k):
    """Hinges in one line: thrust is shared in a way that stiffness alone decides, moments across too, and so are all forces."""
    door = ('&mechanism links=2, coordinates=2 /\n&structure cq=1 /\n' + revolute(1, '1,2', '0,0,0') + revolute(2, '1,2', '0,0,1')
            + "&drive coordinate=1, kind='polynomial', coefficients=0,1 /\n" + BODY)
    check_unique(checks, mech9k, parse(door), ['fx fy fz mx my'] * 2, 'a door on two hinges')


def test_planar_four_bar_in_space(checks, mech9k):
    """All that is out of its plane is not unique."""
    bars = ('&mechanism links=4, coordinates=4 /\n&structure cq=1 /\n' + revolute(1, '1,2', '0,0,0') + revolute(2, '2,3', '0.3,0.1,0')
            + revolute(3, '3,4', '1.1,0.8,0') + revolute(4, '1,4', '1,0,0') + "&drive coordinate=1, kind='polynomial', coefficients=0,2 /\n")
    check_unique(checks, mech9k, parse(bars + BODY), ['fz mx my'] * 4, 'a four-bar')


def test_three_parallel_cranks(checks, mech9k):
    """A third crank that repeats the constraint of the others: forces along the rods too."""
    cranks = ('&mechanism links=5, coordinates=6 /\n&structure cq=1 /\n'
              + ''.join(revolute(2 * i + 1, f'1,{i + 2}', f'{i},0,0') + revolute(2 * i + 2, f'{i + 2},5', f'{i},1,0') for i in range(3))
              + "&drive coordinate=1, kind='polynomial', coefficients=0.3,2 /\n"
              + ''.join(f'&initial coordinate={k}, position={0.3 * (-1) ** (k + 1)} /\n' for k in range(2, 7)))
    # forces along the cranks, whose frames have x across them at the start; the frame of the coupler turns against them
    check_unique(checks, mech9k, parse(cranks + BODY), ['fy fz mx my', 'fx fy fz mx my'] * 3, 'three parallel cranks')


def test_open_chain_holds_nothing_in_reserve(checks, mech9d):
    check_unique(checks, mech9d, example('double_pendulum'), ['', ''], 'a double pendulum', intervals=1)


def test_pendulum_by_hand(checks, mech9d):
    g, length, mass, start = 9.81, 0.8, 3.0, 0.5
    pendulum = ('&mechanism links=2, coordinates=1 /\n&structure cq=1 /\n' + revolute(1, '1,2', '0,0,0')
                + f'&initial coordinate=1, position={start}, velocity=0 /\n&body link=2, mass={mass}, centre=0,{-length},0 /\n'
                + f'&gravity acceleration=0,{-g},0 /\n&time start=0, end=2, intervals=20 /\n&solver relative_tolerance=1e-12 /\n')
    table, _, _ = forces_of(mech9d, pendulum)
    pull = mass * g * (3 * np.cos(table['q1']) - 2 * np.cos(start))
    # the tension of a pendulum that was released at rest, along its rod; the tolerances of the integration allow 1e-9 of it
    checks.near(table['R1.fx'], -pull * np.sin(table['q1']), 1e-8, 'pendulum: the tension across', scale=pull.max())
    checks.near(table['R1.fy'], pull * np.cos(table['q1']), 1e-8, 'pendulum: the tension upwards', scale=pull.max())


def test_slider_crank_by_hand(checks, mech9k):
    """Without friction."""
    r, l, m, w = 0.1, 0.35, 2.5, 30.0
    crank = ('&mechanism links=4, coordinates=4 /\n&structure cq=1 /\n' + revolute(1, '1,2', '0,0,0') + revolute(2, '2,3', f'{r},0,0')
             + revolute(3, '3,4', f'{r + l},0,0') + f"&pair coordinate=4, links=1,4, kind='prismatic', point={r + l},0,0, axis=1,0,0 /\n"
             + f"&drive coordinate=1, kind='polynomial', coefficients=0.2,{w} /\n&body link=4, mass={m} /\n"
             + "&load kind='force', link=4, force=-400,0,0 /\n&time start=0, end=0.4, intervals=40 /\n")
    table, _, _ = forces_of(mech9k, crank)
    a = table['q1']
    sine = r / l * np.sin(a)
    cosine = np.sqrt(1 - sine ** 2)
    # x = r cos a + l cos b with l sin b = r sin a
    rate = -r * np.sin(a) - r * np.cos(a) * sine / cosine
    second = -r * np.cos(a) + r * np.sin(a) * sine / cosine - (r * np.cos(a)) ** 2 / l / cosine ** 3
    push = m * second * w ** 2 + 400
    side = push * sine / cosine
    scale = np.abs(push).max()
    checks.near(table['F1'], push * rate, 1e-11, 'slider-crank: the torque of the crank, by virtual work', scale=scale * r)
    checks.near(table['R3.fx'], push, 1e-11, 'slider-crank: the force along the cylinder', scale=scale)
    # the rod has no mass: its force is along it, and the wall takes the part across
    checks.near(table['R4.fy'], side, 1e-11, 'slider-crank: the force of the wall', scale=scale)
    checks.near(table['R1.fy'], -side, 1e-11, 'slider-crank: the force on the main bearing', scale=scale)


def test_forces_in_other_numbers_and_places(checks, mech9k):
    """Forces do not depend on the numbers of links nor on the rotation of the whole; test_force_identities changes more."""
    rng = np.random.default_rng(8)
    groups = with_masses(rng, example('fig1'))
    first, _, unique = forces_of(mech9k, write(groups), '--set', 'time.intervals=3')
    turn = rotation(rng)
    second, _, other = forces_of(mech9k, write(rotated(groups, turn)), '--set', 'time.intervals=3')
    third, _, _ = forces_of(mech9k, write(with_links(groups, (1, 5, 2, 6, 3, 4))), '--set', 'time.intervals=3')
    for row in range(4):
        one = wrenches(first, row, 7)
        largest = np.abs(one).max()
        two, three = wrenches(second, row, 7), wrenches(third, row, 7)
        back = np.concatenate([two[:, :3] @ turn, two[:, 3:] @ turn], axis=1)
        checks.true(np.abs(back - one).max() <= 1e-10 * largest, f'rotated forces in row {row}', np.abs(back - one).max() / largest)
        checks.true(np.abs(three - one).max() <= 1e-10 * largest, f'forces of renumbered links in row {row}', np.abs(three - one).max() / largest)
        for table in (second, third):
            checks.true(abs(table['F5'][row] - first['F5'][row]) <= 1e-10 * largest, f'the force of the drive in row {row}')
    if unique is not None:
        checks.true((unique == other).all(), 'rotation does not change which components are unique')


def test_work_over_a_turn(checks, mech9k):
    """A drive's work over a whole turn of a machine without friction is zero. Sums of evenly spaced values integrate a periodic
    function with the accuracy of its highest harmonics."""
    groups = [(group, items) for group, items in example('slider_crank')
              if group != 'output'] + [('body', {'link': [2], 'mass': [2.0], 'centre': [0.1, 0.02, 0]}),
                                       ('body', {'link': [3], 'mass': [1.0], 'centre': [0.4, 0.1, 0], 'inertia': [0.1, 0.1, 0.2, 0, 0, 0]}),
                                       ('body', {'link': [4], 'mass': [3.0]}), ('gravity', {'acceleration': [2.0, -9.81, 0]}),
                                       ('load', {'kind': ['coordinate'], 'coordinate': [4], 'stiffness': [50.0], 'rest': [1.0]}),
                                       ('load', {'kind': ['spring'], 'links': [1, 3], 'position': [0.2, 1.5, 0], 'second_position': [0.5, 0, 0],
                                                 'stiffness': [30.0], 'free_length': [0.4]})]
    table, _, _ = forces_of(mech9k, write(groups))
    torque = table['F1'][:-1]
    checks.true(abs(torque.sum()) <= 1e-11 * np.abs(torque).sum(), 'the work of a drive over a whole turn is zero', torque.sum())


def test_forces_by_other_coordinates(checks, mech9d):
    """The forces at the start of a free motion do not depend on which coordinate is independent."""
    found = []
    for k in (1, 2, 4):
        text = ('&mechanism links=4, coordinates=4 /\n' + revolute(1, '1,2', '0,0,0') + revolute(2, '2,3', '0.3,0.4,0')
                + revolute(3, '3,4', '1.1,0.8,0') + revolute(4, '1,4', '1,0,0') + f'&structure cq={k} /\n'
                + f'&initial coordinate={k}, position=0, velocity=0 /\n&body link=3, mass=2, centre=0.5,0.7,0.2, inertia=1,1,1,0,0,0 /\n'
                + '&gravity acceleration=1,-9.81,2 /\n&time start=0, end=1, intervals=1 /\n')
        table, _, _ = forces_of(mech9d, text)
        found.append(wrenches(table, 0, 4))
    for other in found[1:]:
        checks.true(np.abs(other - found[0]).max() <= 1e-11 * np.abs(found[0]).max(), 'forces do not depend on the independent coordinate',
                    np.abs(other - found[0]).max())


SLIDER_CRANK = text_of(os.path.join(TREE, 'examples', 'slider_crank', 'slider_crank.nml'))


@pytest.fixture
def with_body(tmp_path):
    """The path of a slider-crank with mass."""
    path = tmp_path / 'case.nml'
    path.write_text(SLIDER_CRANK.replace('&output', '&body link=4, mass=1 /\n&output'), encoding='utf-8')
    return path


@pytest.mark.parametrize('option, picture', [('--sketch', 'drawn.svg'), ('--animate', 'film.svg'), ('--animate', 'film.html')])
@pytest.mark.parametrize('pairs, count', [((), 4), (('--set', 'output.reaction_pairs=1,4'), 2)], ids=['all', 'two'])
def test_arrows(checks, mech9k, tmp_path, with_body, pairs, count, option, picture):
    """Drawings and films with an arrow for each force."""
    done = run(mech9k, with_body, '--no-write', '--set', 'output.force_arrows=.true.', *pairs, option, picture, folder=tmp_path)
    if checks.true(done.returncode == 0, f'{picture} with arrows of forces', done.stderr):
        checks.equal(text_of(tmp_path / picture).count('class="force'), count, f'{picture} has an arrow for each pair')


def test_no_arrows_unless_asked_for(checks, mech9k, tmp_path, with_body):
    run(mech9k, with_body, '--no-write', '--sketch', 'without.svg', folder=tmp_path)
    checks.true('class="force' not in text_of(tmp_path / 'without.svg'), 'no arrows unless they are asked for')


@pytest.fixture
def ask(with_body, tmp_path):
    """A run with some settings and options, whose table goes to standard output."""
    def ask(program, *settings):
        arguments = [word for setting in settings for word in (('--set', setting) if '=' in setting else (setting,))]
        return run(program, with_body, '--table', '-', *arguments, folder=tmp_path)
    return ask


def test_columns_of_forces(checks, mech9k, ask):
    done = ask(mech9k, 'output.reaction_pairs=4,2', 'output.derivatives=0', 'output.coordinates=4')
    names = [line for line in done.stdout.splitlines() if not line.startswith('#')][0].split()
    checks.equal(names[1:2] + names[8:20], ['q4'] + [f'R{k}.{c}' for k in (2, 4) for c in COMPONENTS],
                 'pairs that are listed have columns, in ascending order, after those of points')
    checks.true('F1' not in names and names[-1] == 'closure', 'forces of drives have none unless they are asked for', names)
    full = read_table(ask(mech9k, 'output.reactions=.true.').stdout)
    part = read_table(done.stdout)
    checks.true(all(np.array_equal(full[f'R4.{c}'], part[f'R4.{c}']) for c in COMPONENTS),
                'forces do not depend on what else is recorded')


@pytest.mark.parametrize('settings, words', [
    pytest.param(['output.reaction_pairs=4,5'], 'there is no pair 5; they are 1 to 4', id='a pair that is not there'),
    pytest.param(['output.reaction_pairs=4', 'output.reactions=.false.'], 'contradicts reaction_pairs', id='pairs without reactions'),
    pytest.param(['output.reaction_pairs=4,4'], 'pair 4 is there already', id='a pair that is named twice')])
def test_requests_that_are_refused(checks, mech9k, ask, settings, words):
    done = ask(mech9k, *settings)
    checks.true(done.returncode == 3 and words in done.stderr, words, done.stderr)


def test_check_tells_components_that_are_not_unique(checks, mech9k, tmp_path, with_body):
    done = run(mech9k, with_body, '--check', '--set', 'output.reactions=.true.', folder=tmp_path)
    checks.true('does not determine these components' in done.stdout and '  pair 1: force along z, moment about x y; '
                'columns R1.fz R1.mx R1.my\n' in done.stdout and '  pair 4: force along y, moment about x z; columns R4.fz R4.mx R4.my\n'
                in done.stdout, '--check tells the components that are not unique', done.stdout)
    # the frame of the slide has its z along x of link 1: R4.fy is determined, though the component along its y is not
    checks.true('columns are along the axes of link 1' in done.stdout and 'R4.fy' not in done.stdout,
                '--check names the columns that are not unique', done.stdout)


def test_forces_of_nothing(checks, mech9k, with_body, ask):
    with_body.write_text(SLIDER_CRANK, encoding='utf-8')
    done = ask(mech9k, 'output.reactions=.true.')
    checks.true(done.returncode == 0 and 'no link has mass and no load acts' in done.stderr, 'forces of nothing are zero: it is said',
                done.stderr)
    table = read_table(done.stdout)
    checks.true(all(not table[f'R{k}.{c}'].any() for k in range(1, 5) for c in COMPONENTS), 'they are zero')
