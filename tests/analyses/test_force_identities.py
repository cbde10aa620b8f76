"""Forces in pairs and of drives do not depend on how the data file numbers and places a mechanism, balance every link, and do the work
that the energy shows: on random mechanisms, determined and overconstrained, with driven and free coordinates.

Compares the program with itself in part: forces in other numbers, places and independent coordinates; all else is held against
equations of balance in absolute coordinates, closed forms and the energy.
"""
import numpy as np
import pytest

import families
from data_file import parse, write
from force_files import compare, family_groups, forces_of, revolute, rotated, rotation, with_coordinates, with_links, wrenches

DETERMINED = {'seven revolutes': families.seven('RRRRRRR'), 'seven pairs of all kinds': families.seven('RRPRHRR'),
              'two spatial loops': families.two_spatial_loops(1), 'a rod between ball joints': families.rssr,
              'three cylindrical joints': families.rccc}
OVERCONSTRAINED = {'Bennett': families.bennett, 'Sarrus': families.sarrus, 'Bricard, of a line': families.bricard_of_a_line,
                   'Bricard, of a plane': families.bricard_of_a_plane, 'spherical': families.spherical(1),
                   'cranks too many': families.parallel_cranks(3), 'a platform in a plane': families.platform,
                   'a six-bar': families.four_bar(1)}
# Positions differ by round-off over the conditioning of the chains, up to some thousands, and forces by a power of it more.
SAME = 1e-8


def member(mech9k, family, rng):
    """A mechanism of a family that moves on from its home, and is not near a singular position there."""
    for _ in range(50):
        groups = family_groups(family, rng)
        try:
            _, report, _ = forces_of(mech9k, write(groups))
        except RuntimeError:
            continue
        if report['least_conditioning'] > 0.03:
            return groups
    raise RuntimeError('no member of the family moves')


FAMILIES = {**DETERMINED, **OVERCONSTRAINED}


def generator(seed, name, number=0):
    """Each mechanism has a generator of its own, so that its test can be run alone."""
    return np.random.default_rng((seed, list(FAMILIES).index(name), number))


@pytest.mark.parametrize('number', [1, 2])
@pytest.mark.parametrize('name', FAMILIES)
def test_forces_against_dense_equations(checks, mech9k, name, number):
    """Sums over each link, dependent coordinates, wrenches of least norm, drives, and which components are unique."""
    compare(checks, mech9k, member(mech9k, FAMILIES[name], generator(11, name, number)), f'{name} {number}')


def same_forces(checks, one, other, pairs, why):
    """`pairs` are the numbers of the second table's pairs in the order of the first, `signs` of reversed ones."""
    for row in range(len(one['t'])):
        first = wrenches(one, row, len(pairs))
        second = wrenches(other, row, len(pairs))[np.array(pairs) - 1]
        largest = np.abs(first).max()
        checks.true(np.abs(first - second).max() <= SAME * largest, f'{why}: forces in row {row}', np.abs(first - second).max() / largest)
    for name in (name for name in one if name.startswith('F')):
        drive = f'F{pairs[int(name[1:]) - 1]}'
        checks.true(np.abs(one[name] - other[drive]).max() <= SAME * np.abs(wrenches(one, 0, len(pairs))).max(), f'{why}: {name}',
                    (one[name], other[drive]))


@pytest.mark.parametrize('number', [1, 2])
@pytest.mark.parametrize('name', FAMILIES)
def test_forces_in_other_numbers(checks, mech9k, name, number):
    """Other numbers of links and coordinates change the spanning tree: other pairs close the chains."""
    rng = generator(12, name, number)
    groups = member(mech9k, FAMILIES[name], rng)
    links = next(items['links'][0] for group, items in groups if group == 'mechanism')
    count = next(items['coordinates'][0] for group, items in groups if group == 'mechanism')
    table, _, unique = forces_of(mech9k, write(groups))
    new_links = [1, *(int(k) + 2 for k in rng.permutation(links - 1))]
    new = [int(k) + 1 for k in rng.permutation(count)]
    other, _, flags = forces_of(mech9k, write(with_coordinates(with_links(groups, new_links), new)))
    same_forces(checks, table, other, new, f'{name} in other numbers')
    if unique is not None:
        checks.true((flags[np.array(new) - 1] == unique).all(), f'{name}: numbers do not change which components are unique')
    turn = rotation(rng)
    other, _, flags = forces_of(mech9k, write(rotated(groups, turn)))
    for k in range(count):
        for kind in 'fm':
            back = turn.T @ [other[f'R{k + 1}.{kind}{axis}'] for axis in 'xyz']
            for axis, values in zip('xyz', back):
                other[f'R{k + 1}.{kind}{axis}'] = values
    same_forces(checks, table, other, list(range(1, count + 1)), f'{name}, turned')
    if unique is not None:
        checks.true((flags == unique).all(), f'{name}: a rotation does not change which components are unique')


# those with one independent coordinate
OF_ONE_FREEDOM = [name for name, family in FAMILIES.items() if len(family(np.random.default_rng(0), 1)[2]) == 1]


@pytest.mark.parametrize('name', OF_ONE_FREEDOM)
def test_forces_by_other_coordinates(checks, mech9k, mech9d, name):
    """A mechanism that is released has the same forces whichever coordinate is independent."""
    groups = [(group, items) for group, items in member(mech9k, FAMILIES[name], generator(13, name)) if group != 'drive']
    cq = next(items['cq'] for group, items in groups if group == 'structure')
    groups = [(group, items) for group, items in groups if group not in ('structure', 'time')]
    groups.append(('time', {'start': [0], 'intervals': [0]}))
    count = next(items['coordinates'][0] for group, items in groups if group == 'mechanism')
    start = [('structure', {'cq': cq}), ('initial', {'coordinate': cq, 'position': [0.0], 'velocity': [0.8]})]
    table, _, _ = forces_of(mech9d, write(groups + start))
    for k in range(2, count + 1):
        if abs(table[f'dq{k}'][0]) < 0.1:
            continue
        start = [('structure', {'cq': [k]}), ('initial', {'coordinate': [k], 'position': [0.0], 'velocity': [float(table[f'dq{k}'][0])]})]
        other, _, _ = forces_of(mech9d, write(groups + start))
        same_forces(checks, table, other, list(range(1, count + 1)), f'{name}: by coordinate {k}')


@pytest.mark.parametrize('centre', ['0,0.2,0.5', '0.1,0.2,0.5'])
def test_reversed_slides(checks, mech9k, centre):
    """A slide whose moving link is the nearer one to link 1: its wrench is about a point that does not move with the farther link."""
    text = ("&mechanism links=3, coordinates=2 /\n&structure cq=1,2 /\n&pair coordinate=1, links=1,2, kind='revolute', axis=1,0,0 /\n"
            "&pair coordinate=2, links=3,2, kind='prismatic', dh=0,0.4,0.3,0 /\n"
            "&drive coordinate=1, kind='polynomial', coefficients=0.3,2,0.5 /\n&drive coordinate=2, kind='polynomial', coefficients=0.1,1,-3 /\n"
            f'&body link=2, mass=1, centre=0,0.1,0.2 /\n&body link=3, mass=2, centre={centre}, inertia=0.1,0.2,0.3,0,0,0 /\n'
            '&gravity acceleration=0,-9.81,2 /\n&time start=0, end=0.5, intervals=2 /\n')
    compare(checks, mech9k, parse(text), f'a slide run through against its direction, mass at {centre}', intervals=2)


# --- sums ------------------------------------------------------------------------------------------------------------

def test_shaft_in_two_bearings(checks, mech9k):
    """A shaft in two bearings with a pulley between: only sums are determined, and these are the weight and the inertia."""
    mass, spin, off = 3.0, 20.0, 0.01
    text = ('&mechanism links=2, coordinates=2 /\n&structure cq=1 /\n' + revolute(1, '1,2', '0,0,0') + revolute(2, '1,2', '0,0,0.8')
            + f"&drive coordinate=1, kind='polynomial', coefficients=0,{spin} /\n&time end=0.3, intervals=6 /\n"
            + f'&body link=2, mass={mass}, centre={off},0,0.3 /\n&gravity acceleration=0,-9.81,-2 /\n')
    table, _, _ = forces_of(mech9k, text)
    angle = table['q1']
    force = mass * np.array([-off * spin**2 * np.cos(angle), -off * spin**2 * np.sin(angle) + 9.81, 2.0 + 0 * angle])
    place = np.array([off * np.cos(angle), off * np.sin(angle), 0.3 + 0 * angle])
    found = [np.array([table[f'R{k}.{c}{axis}'] for axis in 'xyz']) for c in 'fm' for k in (1, 2)]
    scale = np.abs(force).max()
    checks.near(found[0] + found[1], force, 1e-13, 'both bearings together carry the weight and the inertia', scale=scale)
    about = found[2] + found[3] + np.cross([0, 0, 0.8], found[1], axisb=0).T
    checks.near(about, np.cross(place, force, axis=0), 1e-13, 'and its moment', scale=scale)
    # of least norm: a drive is on pair 1
    checks.near(table['F1'], np.cross(place, force, axis=0)[2], 1e-13, 'the drive turns the shaft', scale=scale)


# --- energies --------------------------------------------------------------------------------------------------------

MIXED = """&structure cq=1,5,6 /
&pair coordinate=1, links=1,2, kind='revolute', axis=0,0,1 /
&pair coordinate=2, links=2,3, kind='revolute', point=0.3,0,0, axis=0,0,1 /
&pair coordinate=3, links=4,3, kind='revolute', point=0.7,0.7,0, axis=0,0,1 /
&pair coordinate=4, links=1,4, kind='revolute', point=0.9,0,0, axis=0,0,1 /
&pair coordinate=5, links=3,5, kind='revolute', point=0.5,0.4,0, axis={axis} /
&pair coordinate=6, links=5,6, kind='prismatic', point=0.5,0.2,0.1, axis=0.2,-1,0.3 /
&body link=2, mass=1, centre=0.1,0,0, inertia=0.02,0.02,0.02,0,0,0 /
&body link=3, mass=2, centre=0.5,0.3,0, inertia=0.1,0.1,0.1,0,0,0 /
&body link=5, mass=2, centre=0.5,0.1,0.2, inertia=0.1,0.2,0.15,0.01,-0.02,0.03 /
&body link=6, mass=0.7, centre=0.5,0.1,0.1, inertia=0.01,0.02,0.02,0,0,0 /
&gravity acceleration=0.5,-9.81,1 /
&drive coordinate=1, kind='harmonic', mean=0.2, amplitude=0.5, angular_frequency=4, phase=0.3 /
&load kind='coordinate', coordinate=6, stiffness=60, rest=-0.1, damping=0.8 /
&load kind='coordinate', coordinate=5, force=1.5, law='harmonic', mean=0.2, amplitude=1, angular_frequency=7 /
&load kind='coordinate', coordinate=3, damping=0.3 /
&load kind='force', link=6, position=0.5,0.1,0.1, force=2,1,-1, law='polynomial', coefficients=1,-0.7,0.2 /
&load kind='spring', links=1,5, position=1,1,0.3, second_position=0.5,0.1,0.2, stiffness=15, free_length=0.4, damping=0.6 /
&point name='A', link=6, position=0.5,0.1,0.1 /
&point name='B', link=5, position=0.5,0.1,0.2 /
&time start=0, end=1.2, intervals=240 /
&solver relative_tolerance=1e-12, absolute_tolerance=1e-13 /
"""
FREE = '&initial coordinate=5, position=0.4, velocity=0.1 /\n&initial coordinate=6, position=0.05, velocity=-0.2 /\n'
DRIVEN = ("&drive coordinate=5, kind='polynomial', coefficients=0.4,0.3,-0.5,0.2 /\n"
          "&drive coordinate=6, kind='harmonic', mean=0.05, amplitude=0.04, angular_frequency=9 /\n")


def power_of_loads(table):
    """Of all loads of MIXED but springs and gravity, whose energies the table has."""
    t = table['t']
    power = -0.8 * table['dq6']**2 - 0.3 * table['dq3']**2 + 1.5 * (0.2 + np.sin(7 * t)) * table['dq5']
    for axis, force in zip('xyz', (2, 1, -1)):
        power += force * (1 - 0.7 * t + 0.2 * t**2) * table[f'A.v{axis}']
    along = np.array([table[f'B.{axis}'] - place for axis, place in zip('xyz', (1, 1, 0.3))])
    rate = sum(along * [table[f'B.v{axis}'] for axis in 'xyz']) / np.linalg.norm(along, axis=0)
    return power - 0.6 * rate**2


def integrals(values, step):
    """Of evenly spaced values from the first on to every fourth one, by Boole's rule."""
    pieces = [values[i:len(values) - 4 + i:4] for i in range(4)] + [values[4::4]]
    return np.concatenate([[0], np.cumsum(sum(w * p for w, p in zip((7, 32, 12, 32, 7), pieces)) * 2 * step / 45)])


def check_work(checks, table, drives, why, loads=power_of_loads):
    """The energy changes by the work of drives and loads. The rule errs by (8/945) h^7 times sixth derivatives, which are some 1e6
    here: 1e-11 of the energy in all; the integration of the motion by some hundred tolerances of 1e-12."""
    power = loads(table) + sum(table[f'F{k}'] * table[f'dq{k}'] for k in drives)
    work = integrals(power, table['t'][1] - table['t'][0])
    energy = table['E.total'][::4] - table['E.total'][0]
    checks.near(energy, work, 1e-9, f'{why}: the energy changes by the work of drives and loads', scale=np.abs(table['E.total']).max())
    checks.true(np.abs(work).max() > 0.1, f'{why}: there is work', work)


@pytest.mark.parametrize('axis', ['0,0,1', '0.3,1,0.2'])
def test_work_of_drives(checks, mech9k, mech9d, axis):
    """Of a mechanism whose coordinates are driven or free, in the plane and across it."""
    text = MIXED.format(axis=axis)
    check_work(checks, forces_of(mech9d, text + FREE)[0], [1], f'driven and free coordinates ({axis})')
    inverse, _, _ = forces_of(mech9d, text + DRIVEN)
    check_work(checks, inverse, [1, 5, 6], f'all driven ({axis})')
    table, _, _ = forces_of(mech9k, text + DRIVEN)
    checks.equal([list(table[f'F{k}']) for k in (1, 5, 6)], [list(inverse[f'F{k}']) for k in (1, 5, 6)],
                 f'both programs have the same forces of drives ({axis})')


# --- ball joints -----------------------------------------------------------------------------------------------------

BALL = """&structure cq=1,2,3{more} /
&pair coordinate=1, links=1,2, kind='revolute', axis=1,0,0 /
&pair coordinate=2, links=2,3, kind='revolute', axis=0,1,0 /
&pair coordinate=3, links=3,4, kind='revolute', axis=0,0,1 /
&body link=4, mass=2, centre=0.3,0.1,-0.2, inertia=0.2,0.3,0.25,0.02,-0.01,0.03 /
&gravity acceleration=0,-9.81,0 /
&point name='C', link=4, position=0.3,0.1,-0.2 /
&solver relative_tolerance=1e-12, absolute_tolerance=1e-13 /
"""
TURNS = {1: '0.3,0.8,0.4', 2: '0.2,-1.1,0.7', 3: '-0.4,0.9,1.3'}
HANGING = """&pair coordinate=4, links=4,5, kind='revolute', point=0.4,0.2,-0.3, axis=0.3,1,0.2 /
&body link=5, mass=1.2, centre=0.6,-0.1,-0.2, inertia=0.05,0.04,0.06,0,0,0 /
&initial coordinate=4, position=0.3, velocity=0.5 /
"""


def turns(driven):
    """Drives of some of the three turns, and starts of the others."""
    return ''.join(f"&drive coordinate={k}, kind='polynomial', coefficients={TURNS[k]} /\n" if k in driven else
                   f"&initial coordinate={k}, position={TURNS[k].split(',')[0]}, velocity={TURNS[k].split(',')[1]} /\n" for k in TURNS)


@pytest.mark.parametrize('more, hanging', [('', ''), (',4', HANGING)], ids=['alone', 'with_a_pendulum'])
@pytest.mark.parametrize('driven', [(1, 2, 3), (1,), (2,), (1, 3), ()], ids=['all', 'first', 'second', 'first_and_third', 'none'])
def test_ball_joints(checks, mech9d, driven, more, hanging):
    """Three turns whose axes meet, with massless links between: driven, in part driven, and free."""
    time = '&time start=0, end=0.8, intervals=240 /\n'
    text = BALL.format(more=more) + turns(driven) + hanging + time
    if not driven and not hanging:
        # nothing but the weight acts: its energy is constant
        table, _, _ = forces_of(mech9d, text)
        checks.near(table['E.total'], table['E.total'][0], 1e-10, 'a free ball joint keeps its energy')
    else:
        table, _, _ = forces_of(mech9d, text)
        if driven:
            check_work(checks, table, driven, f'turns {driven} driven{hanging and ", and a pendulum"}', lambda table: 0.0)
    if not hanging:
        force = np.array([table[f'R1.f{axis}'] for axis in 'xyz'])
        expected = 2.0 * np.array([table[f'C.a{axis}'] + (9.81 if axis == 'y' else 0) for axis in 'xyz'])
        checks.near(force, expected, 1e-12, f'turns {driven} driven: the joint carries weight and inertia', scale=np.abs(expected).max())
        for k in (2, 3):
            checks.near([table[f'R{k}.{c}'] for c in ('fx', 'fy', 'fz', 'mx', 'my', 'mz')],
                        [table[f'R1.{c}'] for c in ('fx', 'fy', 'fz', 'mx', 'my', 'mz')], 1e-12,
                        f'turns {driven} driven: links without mass pass the whole wrench on', scale=np.abs(expected).max())
    compare(checks, mech9d, parse(text.replace('intervals=240', 'intervals=2')), f'turns {driven} of a ball joint{hanging and " and a pendulum"}',
            intervals=2)
