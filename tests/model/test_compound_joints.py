"""Joints with several freedoms: spherical, universal, cylindrical, planar, free.

Compares the program with itself in part: each joint against the same joint as a chain of pairs with one freedom, over massless
links that the data file gives. These chains are formed here, from the definition of the joints. All else is closed forms, counts
and messages.
"""
import math
import os
import re

import numpy as np
import pytest

from mech9_cases import REFERENCE, TREE, run, table_and_report, table_of, text_of

DATA, STRUCTURE = 3, 4
CHAINS = {'spherical': ['Rx', 'Ry', 'Rz'], 'cylindrical': ['Rz', 'Tz'], 'planar': ['Tx', 'Ty', 'Rz'],
          'free': ['Tx', 'Ty', 'Tz', 'Rx', 'Ry', 'Rz']}
COMMON = """&gravity acceleration=0.4,-9.81,0.3 /
&body link=2, mass=1.1, centre=0.1,0.02,0, inertia=0.02,0.03,0.03,0,0,0 /
&body link=3, mass=0.7, centre=0.4,0.05,0.1, inertia=0.05,0.06,0.04,0.001,0.002,0 /
"""
# mechanisms as lists of lines; a line for a joint is a dictionary
RSUR = [dict(coordinate=1, links=(1, 2), kind='revolute', point='0,0,0', axis='0,0,1', zero='1,0,0'),
        dict(coordinates=(2, 3, 4), links=(2, 3), kind='spherical', point='0.3,0,0', moving_point='0,0,0'),
        dict(coordinates=(5, 6), links=(3, 4), kind='universal', point='1.0,0,0', axis='0,0,1', moving_axis='0,1,0',
             moving_point='0,0.6,0'),
        dict(coordinate=7, links=(1, 4), kind='revolute', point='1.0,0.4,0.1', axis='1,0,0.2', moving_point='0,0,0',
             moving_axis='1,0,0')]
RSCR = [dict(coordinate=1, links=(1, 2), kind='revolute', point='0,0,0', axis='0,0,1', zero='1,0,0'),
        dict(coordinates=(7, 4, 5), links=(2, 3), kind='spherical', point='0.3,0,0.05', axis='0,1,1', zero='1,0,0',
             moving_point='0.1,0.1,0', moving_axis='0,0,1', moving_zero='1,0.3,0'),
        dict(coordinates=(2, 3), links=(4, 3), kind='cylindrical', point='0,0,0', axis='1,0,0', zero='0,1,0', moving_point='0,0,0',
             moving_axis='0,0,1', moving_zero='1,0,0'),
        dict(coordinate=6, links=(1, 4), kind='revolute', point='1,0,0', axis='0.1,0,1', moving_point='0,0,0', moving_axis='0,0,1')]
SWASH = [dict(coordinate=1, links=(1, 2), kind='revolute', point='0,0,0', axis='0,0,1', zero='1,0,0'),
         dict(coordinates=(5, 2, 7), links=(2, 3), kind='planar', point='0,0,0.02', axis='0.3,0.1,1', zero='1,0,0.4',
              moving_point='0,0,-0.03', moving_axis='0,0,1'),
         dict(coordinates=(3, 4), links=(3, 4), kind='universal', point='0,0,0.01', axis='1,0,0', moving_axis='0.2,1,0',
              moving_point='0,0,0'),
         dict(coordinate=6, links=(1, 4), kind='prismatic', point='0.3,0.05,0', axis='0,0.1,1', moving_point='0,0,0.02')]
CLOSED = {'RSUR': RSUR, 'RSCR': RSCR, 'swash plate': SWASH}
DRIVE = "&drive coordinate=1, kind='harmonic', mean=0.2, amplitude=0.3, angular_frequency=4 /\n"


def group(name, items):
    words = []
    for key, value in items.items():
        if key in ('kind',):
            words.append(f"{key}='{value}'")
        elif isinstance(value, tuple):
            words.append(f'{key}=' + ','.join(str(v) for v in value))
        else:
            words.append(f'{key}={value}')
    return f'&{name} ' + ', '.join(words) + ' /\n'


def by_hand(joint, links):
    """The chain of pairs of a joint, over links of the numbers given."""
    if 'coordinate' in joint:
        return group('pair', joint)
    ends = [joint['links'][0], *links, joint['links'][1]]
    frame = {key: joint[key] for key in ('point', 'axis', 'zero') if key in joint}
    moving = {key: joint[key] for key in ('moving_point', 'moving_axis', 'moving_zero') if key in joint}
    text = ''
    if joint['kind'] == 'universal':
        steps = [('revolute', {'point': joint['point'], 'axis': joint['axis'], 'moving_point': '0,0,0'}),
                 ('revolute', {'point': '0,0,0', 'axis': joint['moving_axis'], 'moving_point': joint['moving_point']})]
    else:
        # a constant frame before and after the turns and slides: pairs about z, x, y of links in line with the frame
        frame.setdefault('axis', '0,0,1')
        moving.setdefault('moving_axis', frame['axis'])
        z, x = frame_of(frame['axis'], frame.get('zero'))
        zero = moving.get('moving_zero') or (frame.get('zero') if moving['moving_axis'] == frame['axis'] else None)
        zm, xm = frame_of(moving['moving_axis'], zero)
        y = np.cross(z, x)
        inside = {'x': x, 'y': y, 'z': z}
        steps = []
        chain = CHAINS[joint['kind']]
        for i, step in enumerate(chain):
            items = {}
            items['point'] = frame['point'] if i == 0 else '0,0,0'
            direction = inside[step[1]] if i == 0 else np.eye(3)['xyz'.index(step[1])]
            # the zero direction is the next axis in the order x, y, z, on both sides
            after = 'xyz'[('xyz'.index(step[1]) + 1) % 3]
            near = inside[after] if i == 0 else np.eye(3)['xyz'.index(after)]
            items['axis'], items['zero'] = numbers(direction), numbers(near)
            ym = np.cross(zm, xm)
            last = i == len(chain) - 1
            outside = {'x': xm, 'y': ym, 'z': zm}
            items['moving_axis'] = numbers(outside[step[1]] if last else np.eye(3)['xyz'.index(step[1])])
            items['moving_zero'] = numbers(outside[after] if last else np.eye(3)['xyz'.index(after)])
            items['moving_point'] = moving['moving_point'] if last else '0,0,0'
            steps.append(('revolute' if step[0] == 'R' else 'prismatic', items))
    for i, (kind, items) in enumerate(steps):
        text += group('pair', dict(coordinate=joint['coordinates'][i], links=(ends[i], ends[i + 1]), kind=kind, **items))
    return text


def frame_of(axis, zero):
    """z and x of the frame that a data file gives."""
    z = np.array([float(word) for word in axis.split(',')])
    z /= np.linalg.norm(z)
    if zero is None:
        x = next(np.eye(3)[i] for i in range(3) if abs(z[i]) <= math.sqrt(0.5) * (1 + 1e-12))
    else:
        x = np.array([float(word) for word in zero.split(',')])
    x = x - (x @ z) * z
    return z, x / np.linalg.norm(x)


def numbers(vector):
    return ','.join(f'{float(v)!r}' for v in vector)


def both(mechanism, n_links):
    """The pairs as joints, and the same by hand."""
    joints, hand, next_link = '', '', n_links + 1
    for joint in mechanism:
        joints += group('pair', joint)
        own = len(joint.get('coordinates', (0,))) - 1
        hand += by_hand(joint, range(next_link, next_link + own))
        next_link += own
    return joints, hand


class Cases:
    def __init__(self, mech9k, mech9d, folder, checks):
        self.mech9k, self.mech9d, self.folder, self.checks = mech9k, mech9d, folder, checks

    def write(self, text, name='case.nml'):
        path = os.path.join(self.folder, name)
        with open(path, 'w', encoding='utf-8') as file:
            file.write(text)
        return path

    def table(self, program, text, *options):
        return table_of(program, self.write(text), *options)

    def same(self, one, other, tolerance, why):
        """Columns of the same names, but those of reactions, agree within parts of their largest values."""
        for name in one:
            if name.startswith('R') or name in ('closure', 'conditioning'):
                continue
            scale = max(1.0, float(np.max(np.abs(other[name]))))
            error = float(np.max(np.abs(one[name] - other[name])))
            self.checks.true(error <= tolerance * scale, f'{why}: {name} differs by {error:.3g}')


@pytest.fixture
def cases(checks, mech9k, mech9d, tmp_path):
    return Cases(mech9k, mech9d, tmp_path, checks)


@pytest.mark.parametrize('name, mechanism', CLOSED.items(), ids=CLOSED)
def test_closed_chains(cases, name, mechanism):
    """Closed chains, driven: equal to the chains by hand but for round-off in their frames; and the wrenches of joints."""
    rest = "&point name='P', link=3, position=0.5,0.1,0 /\n&output reactions=.true., drive_forces=.true. /\n" \
           '&time end=1.5, intervals=15 /\n' + COMMON
    joints, hand = both(mechanism, 4)
    head = '&structure cq=1 /\n' + DRIVE
    one = cases.table(cases.mech9k, head + joints + rest)
    other = cases.table(cases.mech9k, head + hand + rest)
    # round-off times the conditioning of the chains; accelerations are the largest numbers
    cases.same(one, other, 2e-11, name)
    for joint in mechanism:
        numbers_of_joint = joint.get('coordinates', (joint.get('coordinate'),))
        for part in ('fx', 'fy', 'fz', 'mx', 'my', 'mz'):
            wrench = other[f'R{numbers_of_joint[-1]}.{part}']
            error = float(np.max(np.abs(one[f'R{numbers_of_joint[0]}.{part}'] - wrench)))
            cases.checks.true(error <= 1e-9 * max(1.0, float(np.max(np.abs(wrench)))),
                              f'{name}: the wrench of the joint {numbers_of_joint} in {part} is that of its last pair')
        for k in numbers_of_joint[1:]:
            cases.checks.true(f'R{k}.fx' not in one, f'{name}: coordinate {k} has no wrench of its own')


def test_open_chains(cases):
    """Open chains in mech9d: a free body and a pendulum on a ball, against the chains by hand."""
    free = [dict(coordinates=(1, 2, 3, 4, 5, 6), links=(1, 2), kind='free', point='0.1,0.2,0.3', axis='0.1,0.2,1', zero='1,0.2,0',
                 moving_point='0.1,0,0.05'),
            dict(coordinates=(7, 8, 9), links=(2, 3), kind='spherical', point='0.5,0,0', moving_point='0,0.1,0')]
    joints, hand = both(free, 3)
    rest = '&structure cq=1,2,3,4,5,6,7,8,9 /\n' + COMMON + '&time end=0.5, intervals=5 /\n&solver relative_tolerance=1e-11, ' \
        'absolute_tolerance=1e-12 /\n' + ''.join(f'&initial coordinate={k}, position={0.05 * k:.2f}, velocity={0.3 * (k - 4):.1f} /\n'
                                                 for k in range(1, 10))
    one, other = cases.table(cases.mech9d, joints + rest), cases.table(cases.mech9d, hand + rest)
    # a hundred times the tolerance of the integration
    cases.same(one, other, 1e-9, 'a free body with a ball')
    spread = float(np.max(np.abs(one['E.total'] - one['E.total'][0])))
    cases.checks.true(spread <= 1e-8 * float(np.max(np.abs(one['E.kinetic']))), f'a free body with a ball: its energy keeps ({spread:.2g})')


def test_structural_data(cases):
    """The first and the second set of structural data count the user's links, and the first coordinate stands for a joint."""
    joints, _ = both(RSUR, 4)
    rest = DRIVE + "&point name='P', link=3, position=0.5,0.1,0 /\n&time end=0.3, intervals=3 /\n"
    plain = '&structure cq=1 /\n' + joints + rest
    expected = ['nrg = 1 2 3 4 1', 'nws = 0 1 2 5 7', 'rdw = 1 1 0 0 0', 'nrw = 0 0 0 0 1']
    matrix = '&mechanism links=4, coordinates=7 /\n&structure c=0,1,0,7, 1,0,2,0, 0,2,0,5, 7,0,5,0, cq=1 /\n'
    vectors = '&structure nrg=1,2,3,4,1, nws=0,1,2,5,7, rdw=1,1,0,0,0, nrw=0,0,0,0,1, cq=1 /\n'
    backward = '&structure nrg=1,4,3,2,1, nws=0,7,5,2,1, rdw=1,0,0,0,1, cq=1 /\n'
    reference = cases.table(cases.mech9k, plain)
    for why, text in (('pairs', plain), ('matrix', matrix + joints + rest), ('vectors', vectors + joints + rest)):
        done = run(cases.mech9k, cases.write(text), '--structure', '--quiet')
        cases.checks.equal(done.stdout.splitlines(), expected, f'{why}: the structural vectors')
        cases.same(cases.table(cases.mech9k, text), reference, 0.0, why)
    done = run(cases.mech9k, cases.write(backward + joints + rest), '--structure', '--quiet')
    cases.checks.equal(done.stdout.splitlines()[:3], ['nrg = 1 4 3 2 1', 'nws = 0 7 5 2 1', 'rdw = 1 0 0 0 1'],
                       'backward: the structural vectors are the given ones')
    # in another order of computation the guesses lead to another assembly, so that they are given
    guesses = ''.join(f"&initial coordinate={k}, position={float(reference[f'q{k}'][0])!r} /\n" for k in range(1, 8))
    cases.same(cases.table(cases.mech9k, backward + joints + rest + guesses), reference, 1e-11, 'backward')
    free = "&structure nrg=1,2, nws=0,1, rdw=1,1 /\n&pair coordinates=1,2,3, links=1,2, kind='spherical' /\n" \
           '&body link=2, mass=1, centre=0.3,0,0 /\n&time end=0.1, intervals=1 /\n'
    done = run(cases.mech9d, cases.write(free), '--structure', '--quiet')
    cases.checks.equal(done.stdout.splitlines(), ['nrg = 1 2', 'nws = 0 1', 'rdw = 1 1', 'nrw = 0 0'],
                       'a ball whose coordinates are all independent')


def test_links_of_joints_are_not_shown(cases):
    """No number of a link that belongs to a joint is shown: the mechanism has links 1 to 4."""
    joints, _ = both(RSUR, 4)
    text = '&structure cq=1 /\n' + joints + DRIVE + COMMON + '&output reactions=.true., poses=.true. /\n&time end=0.3, intervals=3 /\n'
    path = cases.write(text)
    for option in ('--check', '--plan'):
        done = run(cases.mech9k, path, option)
        cases.checks.true(done.returncode == 0 and '4 links, 7 coordinates, 1 closed chain' in done.stdout,
                          f'{option} counts the links of the user', done.stdout + done.stderr)
        cases.checks.true(not re.search(r'links? [1-9, ]*[5-9]', done.stdout), f'{option} shows no link of a joint', done.stdout)
    graph = os.path.join(cases.folder, 'graph.dot')
    run(cases.mech9k, path, '--graph', graph)
    edges = re.findall(r'(\d+) -- (\d+) \[.*label="\s*([^"\\]*)', text_of(graph))
    cases.checks.equal(sorted(edges), [('1', '2', 'q1 revolute'), ('1', '4', 'q7 revolute'), ('2', '3', 'q2, q3, q4 spherical'),
                                       ('3', '4', 'q5, q6 universal')], 'a joint is one edge of the graph')
    _, report = table_and_report(cases.mech9k, path)
    cases.checks.equal((report['links'], report['nrg'], report['nws']), (4, [1, 2, 3, 4, 1], [0, 1, 2, 5, 7]), 'the report')
    cases.checks.equal([one['pair'] for one in report['reactions']], [1, 2, 5, 7], 'the report: pairs with wrenches')
    try:
        import h5py
    except ImportError:
        cases.checks.left_out('h5py is not installed (Debian: python3-h5py)')
        return
    name = os.path.join(cases.folder, 'case.h5')
    done = run(cases.mech9k, path, '--hdf5', name, '--quiet')
    cases.checks.equal(done.returncode, 0, 'a run with HDF5')
    with h5py.File(name) as file:
        cases.checks.equal(list(file['link'][()]), [1, 2, 3, 4], 'HDF5: links')
        cases.checks.equal(file['structure/c'][()].tolist(), [[0, 1, 0, 7], [1, 0, 2, 0], [0, 2, 0, 5], [7, 0, 5, 0]], 'HDF5: C')
        kinds = [kind.decode() if isinstance(kind, bytes) else str(kind) for kind in file['coordinate_kind'][()]]
        cases.checks.equal(kinds, ['revolute'] + 3 * ['spherical'] + 2 * ['universal'] + ['revolute'], 'HDF5: kinds')
        cases.checks.equal(list(file['pair'][()]), [1, 2, 5, 7], 'HDF5: pairs with wrenches')


def test_platform_by_hand(cases):
    """The platform of the examples, written with joints, moves as the one by hand, whose massless links have numbers."""
    example = os.path.join(TREE, 'examples', 'stewart_gough', 'stewart_gough.nml')
    one, other = (table_of(cases.mech9k, path) for path in (example, os.path.join(REFERENCE, 'stewart_gough_by_hand.nml')))
    cases.checks.equal(list(one), list(other), 'the platform: the same columns')
    # round-off times the conditioning of the chains
    cases.same(one, other, 1e-12, 'the platform')


@pytest.mark.parametrize('beta', [0.1, 0.5, 1.2])
def test_shaft_with_a_universal_joint(cases, beta):
    """A universal joint between two shafts at the angle beta: tan(q2) = cos(beta) tan(q1), the law of Cardan and Hooke."""
    c, s = math.cos(beta), math.sin(beta)
    text = '&structure cq=1 /\n' + "&pair coordinate=1, links=1,2, kind='revolute', axis=1,0,0, zero=0,1,0 /\n" \
        f"&pair coordinate=4, links=1,3, kind='revolute', axis={c!r},{s!r},0, zero={-s!r},{c!r},0 /\n" \
        "&pair coordinates=2,3, links=2,3, kind='universal', axis=0,0,1, moving_axis={0!r},{1!r},0 /\n".format(-s, c) + \
        "&drive coordinate=1, kind='polynomial', coefficients=0.1, 1 /\n&time end=12, intervals=240 /\n"
    table = cases.table(cases.mech9k, text)
    q1 = table['q1']
    # the fork of the driving shaft is along z at q1 = 0, so that the law holds from there; both shafts turn on and on
    law = np.unwrap(np.arctan2(np.sin(q1) * c, np.cos(q1)))
    rate = c / (np.cos(q1) ** 2 + np.sin(q1) ** 2 * c * c)
    error = float(np.max(np.abs(table['q4'] - law)))
    cases.checks.true(error < 1e-13, f'a shaft with a universal joint at {beta}: its law ({error:.2g})')
    error = float(np.max(np.abs(table['dq4'] - rate)))
    cases.checks.true(error < 1e-12, f'a shaft with a universal joint at {beta}: its rate ({error:.2g})')


RSSR = [dict(coordinate=1, links=(1, 2), kind='revolute', point='0,0,0', axis='0,0,1', zero='1,0,0'),
        dict(coordinates=(2, 3, 4), links=(2, 3), kind='spherical', point='0.2,0,0', moving_point='0,0,0'),
        dict(coordinates=(5, 6, 7), links=(3, 4), kind='spherical', point='1.0,0,0', moving_point='0,0.6,0'),
        dict(coordinate=8, links=(1, 4), kind='revolute', point='1.0,0.2,0.1', axis='1,0,0.2', moving_point='0,0,0',
             moving_axis='1,0,0')]
ROD_DRIVEN = "&drive coordinate=1, kind='harmonic', mean=0.3, amplitude=0.2, angular_frequency=4 /\n&point name='P', link=3, " \
    'position=0.4,0,0 /\n&time end=1.5, intervals=15 /\n'


def test_rod_between_balls(cases):
    """A rod between two balls turns about itself: the program holds one angle, and the rest moves as it does with another one given."""
    joints, _ = both(RSSR, 4)
    rest = ROD_DRIVEN
    reference = None
    for more in ('', "&structure cq=1,2 /\n&drive coordinate=2, kind='polynomial', coefficients=0.7, 0.2 /\n"):
        text = (more or '&structure cq=1 /\n') + joints + rest
        done = run(cases.mech9k, cases.write(text), '--no-write')
        cases.checks.equal(done.returncode, 0, 'a rod between balls: moved')
        said = 'note: link 3 can turn by itself between the spherical joint of coordinates 2, 3, 4 and the spherical joint of ' \
            'coordinates 5, 6, 7; coordinate 5 is held at 0 rad'
        cases.checks.equal(said in done.stderr, not more, 'a rod between balls: the note')
        table = cases.table(cases.mech9k, text)
        if reference is None:
            reference = table
            cases.checks.true(float(np.max(np.abs(table['q5']))) <= 0.0, 'a rod between balls: the angle is held')
        for name in ('q8', 'dq8', 'ddq8', 'P.x', 'P.y', 'P.z', 'P.vx', 'P.az'):
            error = float(np.max(np.abs(table[name] - reference[name])))
            cases.checks.true(error < 1e-10, f'a rod between balls: {name} does not depend on its turn ({error:.2g})')


def test_held_angle_of_a_rod(cases):
    """It has no drive, and --check names the joints."""
    joints, _ = both(RSSR, 4)
    rest = ROD_DRIVEN
    forces = cases.table(cases.mech9k, '&structure cq=1 /\n' + joints + rest + '&output drive_forces=.true. /\n')
    cases.checks.equal([name for name in forces if name[0] == 'F'], ['F1'], 'a rod between balls: a held angle has no drive')
    done = run(cases.mech9k, cases.write('&structure cq=1 /\n' + joints + rest), '--check')
    cases.checks.true('idle: coordinates' in done.stdout and 'the spherical joint of coordinates 5, 6, 7) can move while links 2 and 4 '
                      'stand still' in done.stdout, 'a rod between balls: --check names the joints', done.stdout)


# without mass, slender, and with a moment of inertia about its line, which lets it turn freely
@pytest.mark.parametrize('rod', ['', '&body link=3, mass=1, centre=0.5,0,0, inertia=0,0.1,0.1,0,0,0 /\n',
                                 '&body link=3, mass=1, centre=0.5,0,0, inertia=0.02,0.1,0.1,0,0,0 /\n'],
                         ids=['without_mass', 'slender', 'thick'])
def test_free_rod_between_balls(cases, rod):
    joints, _ = both(RSSR, 4)
    bodies = '&body link=2, mass=1, centre=0.1,0,0, inertia=0.1,0.1,0.1,0,0,0 /\n' \
        '&body link=4, mass=1, centre=0,0.3,0, inertia=0.1,0.1,0.1,0,0,0 /\n&gravity acceleration=0,0,-9.81 /\n' \
        '&initial coordinate=1, position=0.3, velocity=1 /\n&time end=0.3, intervals=6 /\n' \
        '&solver relative_tolerance=1e-11, absolute_tolerance=1e-12 /\n'
    table = cases.table(cases.mech9d, '&structure cq=1 /\n' + joints + bodies + rod)
    spread = float(np.ptp(table['E.total']))
    cases.checks.true(spread < 1e-8, f'a rod between balls in mech9d: its energy keeps ({spread:.2g})')
    cases.checks.equal(float(np.max(np.abs(table['q5']))) > 0.0, '0.02' in rod, 'a rod between balls in mech9d: held or free')


@pytest.mark.parametrize('kind, joint, height, forces, moments', [
    ('spherical', "coordinates=2,3,4, kind='spherical', point=0,0,0.8", 0.8, (0, 1, 2), ()),
    ('cylindrical', "coordinates=2,3, kind='cylindrical', axis=0,0,1, point=0,0,0.8, moving_point=0,0,0.5", 0.5, (0, 1), (0, 1)),
    ('universal', "coordinates=2,3, kind='universal', axis=0,1,0, moving_axis=0,0,1, point=0,0,0.8", 0.8, (0, 1, 2), (0,))],
    ids=['spherical', 'cylindrical', 'universal'])
def test_wrenches_of_least_norm(cases, kind, joint, height, forces, moments):
    """A shaft that hangs in a hinge and in one joint more: of all wrenches that carry its weight, those of least norm are given, in
    which a joint counts once. The right ones come from the pseudoinverse of the six equations of equilibrium."""
    weight, centre = 1.5 * np.array([3.0, -5.0, -8.0]), np.array([0.1, 0.2, 0.3])
    body = '&body link=2, mass=1.5, centre=0.1,0.2,0.3 /\n&gravity acceleration=3,-5,-8 /\n&output reactions=.true. /\n'
    cross = np.array([[0, -1.0, 0], [1.0, 0, 0], [0, 0, 0]])     # e_z x, as a matrix
    text = "&structure cq=1 /\n&pair coordinate=1, links=1,2, kind='revolute', axis=0,0,1 /\n&pair " + joint + ', links=1,2 /\n' \
        "&drive coordinate=1, kind='polynomial', coefficients=0 /\n&time end=0.1, intervals=1 /\n" + body
    table = cases.table(cases.mech9k, text)
    # unknown: force and moment over the size in the hinge, where a drive holds the shaft, then those of the joint about its point
    size = 0.8
    a = np.zeros((6, 12))
    a[:3, :3] = a[:3, 6:9] = np.eye(3)
    a[3:, 3:6] = a[3:, 9:12] = np.eye(3)
    a[3:, 6:9] = height / size * cross
    known = [6 + k for k in range(3) if k not in forces] + [9 + k for k in range(3) if k not in moments]
    if kind == 'universal':
        # the first axis is y, the second z: the moment is along x
        assert known == [10, 11]
    free = [k for k in range(12) if k not in known]
    right = -np.concatenate([weight, np.cross(centre, weight) / size])
    solution = np.zeros(12)
    solution[free] = np.linalg.pinv(a[:, free]) @ right
    names = [f'R{k}.{part}' for k in (1, 2) for part in ('fx', 'fy', 'fz', 'mx', 'my', 'mz')]
    given = np.array([table[name][0] for name in names]) / np.tile([1, 1, 1, size, size, size], 2)
    error = float(np.max(np.abs(given - solution)))
    cases.checks.true(error < 1e-12 * np.max(np.abs(solution)), f'least norm with a {kind} joint: it counts once ({error:.2g})')


BAD = [
    ('a coordinate twice in a joint', "&pair coordinates=2,3,3, links=2,3, kind='spherical' /", '2:23', 'coordinate 3 is named twice'),
    ('a coordinate of another pair', "&pair coordinates=2,1,4, links=2,3, kind='spherical' /", '2:21',
     'a second &pair for coordinate 1; the first stands in line 1'),
    ('too few coordinates', "&pair coordinates=2,3, links=2,3, kind='spherical' /", '2:7',
     "2 values for 'coordinates' where 3 are expected"),
    ('a negative coordinate', "&pair coordinates=2,-3, links=2,3, kind='cylindrical', axis=0,0,1 /", '2:21', "must be >=1"),
    ('coordinate for a joint', "&pair coordinate=2, links=2,3, kind='planar', axis=0,0,1 /", '2:7', 'does not belong to pairs of kind'),
    ('coordinates for a pair', "&pair coordinates=2,3, links=2,3, kind='revolute', axis=0,0,1 /", '2:7', 'does not belong'),
    ('no coordinates', "&pair links=2,3, kind='spherical' /", '2:1', "&pair needs 'coordinates'"),
    ('no moving_axis', "&pair coordinates=2,3, links=2,3, kind='universal', axis=0,0,1 /", '2:1', "&pair needs 'moving_axis'"),
    ('parallel axes', "&pair coordinates=2,3, links=2,3, kind='universal', axis=0,0,1, moving_axis=0,0,-2 /", '2:65',
     'the two axes of the universal joint of coordinates 2, 3 are parallel'),
    ('a zero axis', "&pair coordinates=2,3,4, links=2,3, kind='spherical', axis=0,0,0 /", '2:60',
     'the axis of the spherical joint of coordinates 2, 3, 4 is zero'),
    ('two vectors at once', "&pair coordinates=2,3,4, links=2,3, kind='spherical', axis=0,0,0, moving_axis=0,0,0 /", '2:79',
     'the moving_axis of the spherical joint of coordinates 2, 3, 4 is zero'),
    ('a link that no pair reaches', "&pair coordinates=2,3,4, links=3,4, kind='spherical' /", '2:34',
     'pair 2 names link 4; the links are 1 to 3'),
    ('a ball', "&pair coordinates=2,3,4, links=2,3, kind='ball' /", '2:42', "unknown pair kind 'ball'; did you mean 'spherical'?"),
    ('a hinge', "&pair coordinate=2, links=2,3, kind='hinge', axis=0,0,1 /", '2:37', "did you mean 'revolute'?"),
    ('a Hooke joint', "&pair coordinates=2,3, links=2,3, kind='Hooke', axis=0,0,1 /", '2:40', "did you mean 'universal'?"),
    ('a gimbal', "&pair coordinates=2,3,4, links=2,3, kind='gimbal' /", '2:42', "did you mean 'spherical'?"),
    ('no axis', "&pair coordinates=2,3, links=2,3, kind='cylindrical' /", '2:1', "&pair needs 'axis'"),
    ('a gap in the numbers', "&pair coordinates=2,4,5, links=2,3, kind='spherical' /", '2:23', 'there is no coordinate 5'),
    ('a body of a link of the joint', "&pair coordinates=2,3,4, links=2,3, kind='spherical' /\n&body link=4, mass=1 /", '3:12',
     'there is no link 4; they are 1 to 3'),
    ('a wrench of an inner coordinate', "&pair coordinates=2,3,4, links=2,3, kind='spherical' /\n&output reaction_pairs=3 /", '3:24',
     'name the first coordinate of its joint, 2'),
]


@pytest.mark.parametrize('lines, place, message', [pytest.param(*case, id=why) for why, *case in BAD])
def test_joints_that_are_refused(cases, lines, place, message):
    first = "&pair coordinate=1, links=1,2, kind='revolute', axis=0,0,1 /\n"
    done = run(cases.mech9d, cases.write(first + lines + '\n&structure cq=1,2,3,4 /\n'))
    cases.checks.true(done.returncode in (DATA, STRUCTURE) and f'case.nml:{place}: ' in done.stderr and message in done.stderr,
                      'the message and its place', done.stderr)


BAD_STRUCTURES = [
    ('an inner coordinate in C', '&structure c=0,1,0,7, 1,0,2,0, 0,2,0,6, 7,0,6,0, cq=1 /\n', '1:45',
     'a joint with several coordinates stands in C by the first of them'),
    ('an inner coordinate in nws', '&structure nrg=1,2,3,4,1, nws=0,1,3,5,7, rdw=1,1,0,0,0, cq=1 /\n', '1:35',
     'a joint with several coordinates stands in nws by the first of them'),
    ('rdw alone', '&structure nrg=1,2,3,4,1, nws=0,1,2,5,7, rdw=1,1,0,0,0 /\n', '1:50', 'give cq too'),
    ('cq against rdw', '&structure nrg=1,2,3,4,1, nws=0,1,2,5,7, rdw=1,1,1,0,0, cq=1,2 /\n', '1:50',
     'cq and rdw disagree about the spherical joint of coordinates 2, 3, 4')]


@pytest.mark.parametrize('structure, place, message', [pytest.param(*case, id=why) for why, *case in BAD_STRUCTURES])
def test_structures_that_are_refused(cases, structure, place, message):
    joints, _ = both(RSUR, 4)
    done = run(cases.mech9k, cases.write(structure + joints + DRIVE))
    cases.checks.true(done.returncode == STRUCTURE and f'case.nml:{place}: ' in done.stderr and message in done.stderr,
                      'the message and its place', done.stderr)
