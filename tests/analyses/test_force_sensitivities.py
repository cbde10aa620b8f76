"""Derivatives of forces by parameters: of a four-bar linkage against eighth-order differences of its equations of balance in extended
precision; of closed chains in space, joints, couplings, overconstrained chains and free motions against differences of whole runs;
identities of scaling and turning; gradients of quantities, HDF5, what has no derivative, and what is refused.

Compares the program with itself in part: differences of runs at other values of a parameter.
"""
import json
import os

import numpy as np
import pytest

import dynamic_derivatives as dynamic
import kinematic_derivatives as kinematic
from kinematic_derivatives import differences, four_bar_motion
from mech9_cases import read_table, run

EXACT = 1e-9         # the promise: of the largest derivative of each kind; round-off is near 1e-13 here
WEIGHTS = (4 / 5, -1 / 5, 4 / 105, -1 / 280)
FORCES = 'reactions=.true., drive_forces=.true.'

# the four-bar linkage of the derivatives of motions, with masses
FOUR_BAR = '\n'.join(line for line in kinematic.FOUR_BAR.splitlines() if not line.startswith('&output')) + """
&body link=2, mass=2, centre=0.15,0.02,0, inertia=0.015,0.015,0.02,0,0,0 /
&body link=3, mass=1, centre=0.4,0.1,0, inertia=0.03,0.03,0.05,0,0,0 /
&body link=4, mass=1.5, centre=0.4,-0.03,0, inertia=0.03,0.03,0.04,0,0,0 /
&gravity acceleration=0.5,-9.81,0 /
"""
MASSES = (('crank mass', 'body(1).mass', 2.0), ('centre', 'body(2).centre(1)', 0.4), ('inertia', 'body(3).inertia(3)', 0.04),
          ('sideways', 'gravity.acceleration(1)', 0.5))
PARAMETERS = tuple((name.replace(' ', '_'), target, value) for name, target, value in kinematic.FOUR_BAR_PARAMETERS[:8] + MASSES)


def bodies(links, across=True):
    """Bodies with all their numbers on links 2 and on, and gravity across no axis; perhaps without what acts across the x-y plane."""
    return ''.join(f'&body link={k}, mass={0.5 + 0.3 * k}, centre=0.1,0.2,{0.05 * k * across}, '
                   + f'inertia=0.1,0.2,0.25,0.01,{0.02 * across},{-0.03 * across} /\n'
                   for k in range(2, links + 1)) + f'&gravity acceleration=1,-9.81,{2 * across} /\n'


# pairs that are described from the other link, at different heights, with loads on coordinates
REVERSED = """&structure cq=1 /
&pair coordinate=1, links=2,1, kind='revolute', axis=0,0,1, point=0,0,0, moving_point=0.05,0.02,0.1 /
&pair coordinate=2, links=3,2, kind='revolute', axis=0,0,1, point=0.1,0.05,0.2, moving_point=0.3,0.1,0 /
&pair coordinate=3, links=3,4, kind='revolute', axis=0,0,1, point=1.1,0,0, moving_point=0,0,0 /
&pair coordinate=4, links=4,1, kind='prismatic', axis=1,0,0, zero=0,1,0, point=0.1,0.2,0.2, moving_point=0,0,0.1 /
&initial coordinate=4, position=-1.2 /
&drive coordinate=1, kind='polynomial', coefficients=0.4,2 /
&load kind='coordinate', coordinate=4, stiffness=30, rest=-0.5, damping=2 /
&load kind='coordinate', coordinate=2, stiffness=3, rest=-0.5, damping=2, force=1.4 /
&load kind='force', link=3, position=0.4,0.2,0, force=1,2,3, frame='link' /
&time end=1, intervals=3 /
""" + bodies(4)
REVERSED_PARAMETERS = (('base', 'pair(1).point(1)', 0.0), ('place', 'pair(1).moving_point(1)', 0.05), ('pin', 'pair(2).moving_point(1)', 0.3),
                       ('guide', 'pair(4).moving_point(2)', 0.0), ('along', 'pair(4).moving_point(1)', 0.0), ('rest', 'load(1).rest', -0.5),
                       ('push', 'load(2).force', 1.4), ('mass', 'body(2).mass', 1.4))
# joints with several freedoms in a closed chain
JOINTS = """&mechanism links=4, coordinates=7 /
&structure cq=1 /
&pair coordinate=1, links=1,2, kind='revolute', axis=0,0.2,1, point=0,0,0 /
&pair coordinates=2,3,4, links=2,3, kind='spherical', point=0.3,0,0.1, moving_point=0,0,0 /
{rest}
&drive coordinate=1, kind='polynomial', coefficients=0.4,2 /
&time end=0.6, intervals=3 /
""" + bodies(4)
UNIVERSAL = JOINTS.format(rest="""
&pair coordinates=5,6, links=4,3, kind='universal', axis=1,0.1,0, moving_axis=0,1,0.1, point=0,0,0.1, moving_point=0.9,0,0 /
&pair coordinate=7, links=1,4, kind='revolute', axis=0.3,0,1, point=0.8,0.5,0, moving_point=0.4,0,0 /
&initial coordinate=7, position=1 /""")
CYLINDRICAL = JOINTS.format(rest="""
&pair coordinate=5, links=3,4, kind='revolute', axis=0.2,0.1,1, point=0.9,0,0.1, moving_point=0.1,0,0 /
&pair coordinates=6,7, links=1,4, kind='cylindrical', axis=0.3,0,1, point=0.8,0.5,0, moving_point=0.4,0,0 /
&initial coordinate=6, position=1 /
&load kind='coordinate', coordinate=7, stiffness=30, rest=-0.5, damping=2 /""")
GEARED = '\n'.join(line for line in kinematic.GEARED.splitlines() if not line.startswith('&output')) + '\n' + bodies(5)
# parameters that hardly matter have derivatives of round-off, which nothing balances exactly
PLANETS = """&structure cq=2 /
&pair coordinate=1, links=1,2, kind='revolute', axis=0,0,1 /
&pair coordinate=2, links=2,3, kind='revolute', axis=0,0,1 /
&pair coordinate=3, links=2,4, kind='revolute', axis=0,0,1, point=0.36,0,0 /
&pair coordinate=4, links=2,5, kind='revolute', axis=0,0,1 /
&coupling kind='gear', coordinates=2,3, ratio=-1.25 /
&coupling kind='gear', coordinates=3,4, ratio=0.30769230769230769 /
&coupling kind='linear', coordinates=1,4, coefficients=1,1 /
&drive coordinate=2, kind='polynomial', coefficients=0,9 /
&load kind='coordinate', coordinate=4, stiffness=2, damping=0.7, force=1.5 /
&time end=1, intervals=3 /
""" + bodies(5)
# equilibrium leaves components open: a door on two hinges, and three parallel cranks
DOOR = """&mechanism links=2, coordinates=2 /
&structure cq=1 /
&pair coordinate=1, links=1,2, kind='revolute', axis=0,0,1 /
&pair coordinate=2, links=1,2, kind='revolute', axis=0,0,1, point=0,0,1, moving_point=0,0,1 /
&drive coordinate=1, kind='polynomial', coefficients=0,1 /
&time end=1, intervals=3 /
""" + bodies(2)
CRANKS = ('&mechanism links=5, coordinates=6 /\n&structure cq=1 /\n'
          + ''.join(f"&pair coordinate={2 * i + 1}, links=1,{i + 2}, kind='revolute', axis=0,0,1, point={i},0,0 /\n"
                    f"&pair coordinate={2 * i + 2}, links={i + 2},5, kind='revolute', axis=0,0,1, point={i},1,0 /\n" for i in range(3))
          + "&drive coordinate=1, kind='polynomial', coefficients=0.3,2 /\n"
          + ''.join(f'&initial coordinate={k}, position={0.3 * (-1) ** (k + 1)} /\n' for k in range(2, 7))
          + '&time end=0.5, intervals=2 /\n' + bodies(5))
# base and coupler of a parallelogram are its longest links, and equally long
PARALLELOGRAM = kinematic.PARALLELOGRAM_CHAIN + '&time end=0.5, intervals=2 /\n'


def kind_of(column):
    """Columns of one kind, as all forces in pairs, are judged by the largest one of them."""
    return f'R {column[-2]}' if column[0] == 'R' else column.split('.')[0].rstrip('0123456789')


class Case:
    """A directory for files, the programs, and the checks."""

    def __init__(self, checks, directory, mech9k, mech9d):
        self.checks, self.directory, self.mech9k, self.mech9d = checks, directory, mech9k, mech9d

    def run(self, text, *options, program=None):
        path = os.path.join(self.directory, 'a.nml')
        with open(path, 'w', encoding='utf-8') as file:
            file.write(text)
        return run(program or self.mech9k, path, '--quiet', *options)

    def table(self, text, *options, program=None):
        """The columns of a run by name."""
        done = self.run(text, '--table', '-', *options, program=program)
        if done.returncode != 0:
            raise RuntimeError(f'{text}{options} ended with {done.returncode}:\n{done.stderr}')
        return {name: np.array(column) for name, column in read_table(done.stdout).items()}

    def sensitivities(self, text, parameters, program=None):
        return self.table(text + dynamic.declared(parameters) + f'&output sensitivities=.true., {FORCES} /\n', program=program)

    def compare(self, found, name, expected, tolerance, why):
        """Derivatives by one parameter against columns of expected ones."""
        kinds = {}
        for column in expected:
            kinds.setdefault(kind_of(column), []).append(column)
        for kind, columns in kinds.items():
            mine = np.array([found[f'd({column})/d({name})'] for column in columns])
            right = np.array([expected[column] for column in columns], dtype=float)
            largest = max(np.abs(right).max(), 1e-2)
            error = np.abs(mine - right).max()
            self.checks.true(error <= tolerance * largest, f'{why}: {kind} by {name}', f'error {error:.2e}, largest {largest:.2e}')

    def against_runs(self, text, parameters, why, tolerance=1e-8, part=2.0**-8, program=None):
        """Forces against differences of runs at other values of the parameters: they lose two digits and the conditioning of chains."""
        found = self.sensitivities(text, parameters, program)
        plain = text + dynamic.declared(parameters) + f'&output {FORCES} /\n'
        for number, (name, _, value) in enumerate(parameters, 1):
            step, expected = part * (1.0 if value == 0 else max(abs(value), 0.1)), {}
            for i, weight in enumerate(WEIGHTS, 1):
                above, below = (self.table(plain, '--set', f'parameter({number}).value={value + sign * i * step!r}', program=program)
                                for sign in (1, -1))
                for column in above:
                    if column[0] in 'FRC':
                        expected[column] = expected.get(column, 0) + weight * (above[column] - below[column]) / step
            self.compare(found, name, expected, tolerance, why)


@pytest.fixture
def case(checks, tmp_path, mech9k, mech9d):
    return Case(checks, tmp_path, mech9k, mech9d)


def solved(matrix, right):
    """Solutions of linear systems in extended precision: Gauss with pivots; the last dimension are the systems."""
    a = np.concatenate([matrix, right[:, None]], axis=1)
    n = len(a)
    for k in range(n):
        for s in range(a.shape[2]):
            pivot = k + int(np.argmax(np.abs(a[k:, k, s])))
            a[[k, pivot], :, s] = a[[pivot, k], :, s]
        a[k] = a[k] / a[k, k]
        for i in range(n):
            if i != k:
                a[i] = a[i] - a[i, k] * a[k]
    return a[:, n]


def four_bar_forces(values, t, upper):
    """Force of the drive and forces in the pairs of the four-bar linkage, by the balance of its links (Newton and Euler)."""
    values = list(values)
    crank, coupler, rocker, base = values[:4]
    mass, centre, inertia, sideways = values[8:]
    motion = four_bar_motion(values[:8] + [np.longdouble(0.2)], t, upper)
    q, w, e = motion[1:5], motion[5:9], motion[9:13]
    angle, spin, turn = [[x[0], x[0] + x[1], x[3]] for x in (q, w, e)]
    j = np.clongdouble(1j)

    def arm(link, place):
        return np.exp(j * angle[link]) * place

    def bend(link, place):
        return (j * turn[link] - spin[link]**2) * arm(link, place)

    number = np.longdouble
    starts = [np.clongdouble(complex(0.01, 0.02)), None, 1 + j * base]
    starts[1] = starts[0] + arm(0, crank)
    pulls = [0, bend(0, crank), 0]
    centres = [number(0.15) + j * number(0.02), centre + j * number(0.1), number(0.4) - j * number(0.03)]
    masses = [mass, number(1), number(1.5)]
    inertias = [number(0.02), number(0.05), inertia]
    gravity = sideways - j * number(9.81)
    # places of the next pair on each link: crank pin, coupler pin of the coupler and of the rocker
    ends = [arm(0, crank), arm(1, coupler), arm(2, rocker)]
    # unknowns: forces 1 to 4 (x, y), drive; rows: force x, y and moment about its first pair of each link
    matrix, right = np.zeros((9, 9, len(t)), number), np.zeros((9, len(t)), number)
    for link, (received, passed) in enumerate(((0, 1), (1, 2), (None, None))):
        force = masses[link] * (pulls[link] + bend(link, centres[link]) - gravity)
        reach = arm(link, centres[link])
        right[3 * link], right[3 * link + 1] = force.real, force.imag
        right[3 * link + 2] = inertias[link] * turn[link] + reach.real * force.imag - reach.imag * force.real
        signs = ((0, 1, 0), (1, -1, ends[0])) if link == 0 else ((1, 1, 0), (2, -1, ends[1])) if link == 1 else ((3, 1, 0), (2, 1, ends[2]))
        for pair, sign, lever in signs:
            lever = lever + 0 * t * j
            matrix[3 * link, 2 * pair] = sign
            matrix[3 * link + 1, 2 * pair + 1] = sign
            matrix[3 * link + 2, 2 * pair] = -sign * lever.imag
            matrix[3 * link + 2, 2 * pair + 1] = sign * lever.real
    matrix[2, 8] = 1
    return solved(matrix, right)


def test_four_bar_linkage_by_its_equations_of_balance(case):
    found = case.sensitivities(FOUR_BAR, PARAMETERS)
    t = found['t'].astype(np.longdouble)
    values = np.array([value for _, _, value in PARAMETERS], dtype=np.longdouble)
    names = [f'R{pair}.f{axis}' for pair in (1, 2, 3, 4) for axis in 'xy'] + ['F1']
    runs = [four_bar_forces(values, t, upper) for upper in (1, -1)]
    upper = (1, -1)[int(np.argmin([np.abs(rows[8] - found['F1']).max() for rows in runs]))]
    mine = np.array([found[name] for name in names])
    case.checks.near(four_bar_forces(values, t, upper), mine, 1e-11, 'the equations of balance are those of the run')
    for number, (name, _, _) in enumerate(PARAMETERS):
        expected = differences(lambda v: four_bar_forces(v, t, upper), values, number)
        case.compare(found, name, dict(zip(names, expected)), EXACT, 'four-bar linkage, equations of balance')
        across = [f'd(R{pair}.{c})/d({name})' for pair in (1, 2, 3, 4) for c in ('fz', 'mx', 'my')]
        case.checks.true(not any(found[column].any() for column in across), f'nothing acts across the plane, by {name}')
        case.checks.near(found[f'd(R1.mz)/d({name})'], found[f'd(F1)/d({name})'], 1e-11, f'the moment of the drive, by {name}', scale=1)


@pytest.mark.parametrize('why, text, parameters', (
    ('reversed pairs', REVERSED, REVERSED_PARAMETERS),
    ('ball and universal joint', UNIVERSAL, (
        ('place', 'pair(2).point(3)', 0.1), ('pin', 'pair(3).moving_point(1)', 0.9), ('tilt', 'pair(1).axis(2)', 0.2),
        ('cross', 'pair(3).moving_axis(3)', 0.1), ('mass', 'body(2).mass', 1.4))),
    ('cylindrical joint', CYLINDRICAL, (
        ('pin', 'pair(4).moving_point(1)', 0.4), ('tilt', 'pair(4).axis(1)', 0.3), ('rest', 'load.rest', -0.5))),
    ('gears', GEARED, (
        ('ratio', 'coupling.ratio', -1.5), ('phase', 'coupling.phase', 1.1), ('mass', 'body(2).mass', 1.4), ('length', 'pair(5).point(1)', 0.8))),
    ('a planetary gear', PLANETS, (
        ('mass', 'body(1).mass', 1.1), ('height', 'body(1).centre(3)', 0.1), ('push', 'load.force', 1.5),
        ('ratio', 'coupling(2).ratio', 0.30769230769230769)))),
    ids=('reversed pairs', 'ball and universal joint', 'cylindrical joint', 'gears', 'planetary gear'))
def test_chains_by_differences_of_runs(case, why, text, parameters):
    case.against_runs(text, parameters, why)


@pytest.mark.parametrize('why, text, parameters', (
    ('a door on two hinges', DOOR, (
        ('mass', 'body.mass', 1.1), ('aside', 'body.centre(1)', 0.1), ('apart', "'pair(2).point(3)','pair(2).moving_point(3)'", 1.0))),
    ('three parallel cranks', CRANKS, (
        ('mass', 'body(1).mass', 1.1), ('aside', 'body(4).centre(3)', 0.25), ('speed', 'drive.coefficients(2)', 2.0))),
    ('across a four-bar linkage', FOUR_BAR.replace('-9.81,0 /', '-9.81,2 /'), (
        ('crank', 'pair(2).point(1)', 0.3), ('base', 'pair(4).point(1)', 1.0), ('rocker', 'pair(3).moving_point(1)', 0.7)))),
    ids=('door on two hinges', 'three parallel cranks', 'across a four-bar linkage'))
def test_overconstrained_chains(case, why, text, parameters):
    """Components that equilibrium does not determine have the derivatives of the numbers that are recorded."""
    case.against_runs(text, parameters, why)


@pytest.mark.parametrize('across', (False, True))
def test_equally_long_links(case, across):
    """Two links are equally long, and the longest one decides how moments count beside forces: components that depend on it have no derivative."""
    parameters = (('coupler', 'pair(3).point(1)', 1.0), ('mass', 'body(2).mass', 1.4))
    quantities = "&quantity name='up', of='R1.fz', take='end' /\n&quantity name='side', of='R1.fx', take='end' /\n"
    text = PARALLELOGRAM + bodies(4, across)
    found = case.sensitivities(text, parameters)
    unknown = {column for column in found if np.isnan(found[column]).any()}
    case.checks.true(bool(unknown) == across, 'only what acts across the plane is not unique', f'{unknown}')
    case.checks.true(all(column.endswith('/d(coupler)') and column[3:column.index(')')] in
                         [f'{pair}.{c}' for pair in (1, 2, 3, 4) for c in ('fz', 'mx', 'my')] for column in unknown),
                     'components that equilibrium determines are known', f'{unknown}')
    if across:
        case.run(text + dynamic.declared(parameters) + quantities + f'&output gradients=.true., {FORCES} /\n', '--no-write', '--report',
                 os.path.join(case.directory, 'report.json'))
        with open(os.path.join(case.directory, 'report.json'), encoding='utf-8') as file:
            told = [[by['value'] for by in one['gradient']] for one in json.load(file)['quantities']]
        case.checks.equal([[value is None for value in row] for row in told], [[True, False], [False, False]],
                          'gradients that are not known')
        case.checks.near(told[1], [found[f'd(R1.fx)/d({name})'][-1] for name in ('coupler', 'mass')], 1e-12, 'and those that are')


@pytest.fixture
def forces(case):
    """The columns of forces of the four-bar linkage."""
    return [column for column in case.table(FOUR_BAR + f'&output {FORCES} /\n') if column[0] in 'FR']


def test_forces_are_in_proportion_to_all_masses(case, forces):
    parts = [f"'body({i}).{name}'" for i in (1, 2, 3) for name in ('mass', 'inertia(1)', 'inertia(2)', 'inertia(3)')]
    numbers = '2,0.015,0.015,0.02, 1,0.03,0.03,0.05, 1.5,0.03,0.03,0.04'
    found = case.table(FOUR_BAR + f"&parameter name='all', sets={','.join(parts)}, factors={numbers}, value=1 /\n"
                       + f'&output sensitivities=.true., {FORCES} /\n')
    case.compare(found, 'all', {column: found[column] for column in forces}, EXACT, 'forces are in proportion to all masses')


def test_forces_turn_with_the_mechanism(case, forces):
    # turned by a small angle about the origin: points of link 1, the drive and gravity
    turned = "'pair(1).point(1)','pair(1).point(2)','pair(4).point(2)','gravity.acceleration(1)','gravity.acceleration(2)','drive.mean'"
    found = case.table(FOUR_BAR + f"&parameter name='angle', sets={turned}, factors=-0.02,0.01,1,9.81,0.5,1, "
                       + f'terms=0.01,0.02,0,0.5,-9.81,0.3, value=0 /\n&output sensitivities=.true., {FORCES} /\n')
    expected = {}
    for column in forces:
        axis = column[-1]
        other = column[:-1] + {'x': 'y', 'y': 'x'}.get(axis, axis)
        expected[column] = {'x': -1, 'y': 1}.get(axis, 0) * found[other]
    case.compare(found, 'angle', expected, EXACT, 'forces turn with the mechanism')


def test_forces_are_in_proportion_to_all_lengths(case, forces):
    # all lengths and gravity by one factor, with moments of inertia by its square
    lengths = (('pair(1).point(1)', 0.01), ('pair(1).point(2)', 0.02), ('pair(2).point(1)', 0.3), ('pair(3).point(1)', 0.9),
               ('pair(3).moving_point(1)', 0.7), ('pair(4).point(1)', 1), ('body(1).centre(1)', 0.15), ('body(1).centre(2)', 0.02),
               ('body(2).centre(1)', 0.4), ('body(2).centre(2)', 0.1), ('body(3).centre(1)', 0.4), ('body(3).centre(2)', -0.03),
               ('gravity.acceleration(1)', 0.5), ('gravity.acceleration(2)', -9.81))
    squares = (('body(1).inertia(3)', 0.02), ('body(2).inertia(3)', 0.05), ('body(3).inertia(3)', 0.04))
    targets = ','.join(f"'{name}'" for name, _ in lengths + squares)
    factors = ','.join(repr(float(v)) for v in [value for _, value in lengths] + [2 * value for _, value in squares])
    terms = ','.join(repr(float(v)) for v in [0] * len(lengths) + [-value for _, value in squares])
    found = case.table(FOUR_BAR + f"&parameter name='size', sets={targets}, factors={factors}, terms={terms}, value=1 /\n"
                       + f'&output sensitivities=.true., {FORCES} /\n')
    case.compare(found, 'size', {column: (2 if column[0] == 'F' or column[-2] == 'm' else 1) * found[column] for column in forces}, EXACT,
                 'forces are in proportion to all lengths, and moments to their square')


def test_power_of_the_drive_is_the_change_of_energies(case):
    """The power of the drive is the change of the energies: so are their derivatives, here of F q' = dE/dt after an exact time integral."""
    text = FOUR_BAR + ''.join(f"&quantity name='{name}', of='{of}', take='{take}' /\n" for name, of, take in (
        ('drive', 'F1', 'at=0.7'), ('first', 'E.total', 'start'), ('last', 'E.total', 'end'))).replace("take='at=0.7'", "take='at', at=0.7")
    # a steady drive: its work is the integral of the force times the speed
    text = text.replace("kind='harmonic', mean=0.3, amplitude=1.4, angular_frequency=2, phase=0.2", "kind='polynomial', coefficients=0.3,1.5")
    text += "&quantity name='impulse', of='F1', take='integral' /\n"
    parameters = tuple(p for p in PARAMETERS if not p[1].startswith('drive')) + (('speed', 'drive.coefficients(2)', 1.5),)
    done = case.run(text + dynamic.declared(parameters) + f'&output gradients=.true., {FORCES} /\n', '--no-write', '--report',
                    os.path.join(case.directory, 'report.json'), program=case.mech9d)
    case.checks.equal(done.returncode, 0, f'gradients of forces and energies: {done.stderr}')
    with open(os.path.join(case.directory, 'report.json'), encoding='utf-8') as file:
        told = {one['name']: (one['value'], {by['parameter']: by['value'] for by in one['gradient']}) for one in json.load(file)['quantities']}
    impulse, work = told['impulse'], told['last'][0] - told['first'][0]
    case.checks.near(1.5 * impulse[0], work, 1e-9, 'the work of the drive is the change of the energy', scale=10)
    for name in [name for name, _, _ in parameters]:
        expected = told['last'][1][name] - told['first'][1][name]
        mine = 1.5 * impulse[1][name] + (impulse[0] if name == 'speed' else 0)
        case.checks.near(mine, expected, 1e-9, f'so are the derivatives by {name}', scale=max(1, abs(expected)))


@pytest.mark.parametrize('why, text, parameters', (
    ('a free four-bar', dynamic.FOUR_BAR, dynamic.FOUR_BAR_PARAMETERS[::3]),
    ('through changes of coordinates', dynamic.PENDULUM_FOUR_BAR, (('bar', 'pair(2).point(2)', -1.0), ('start', 'initial(2).position', -0.55))),
    ('a driven hoop', dynamic.TURNING, (('speed', 'drive.coefficients(2)', 7.1), ('centre', 'body.centre(2)', -0.5))),
    ('an open chain in space', dynamic.SPATIAL, dynamic.SPATIAL_PARAMETERS[::2])),
    ids=('four-bar', 'changes of coordinates', 'driven hoop', 'open chain in space'))
def test_free_motions(case, why, text, parameters):
    """Differences of runs know seven digits."""
    case.against_runs(text + dynamic.SOLVER, parameters, why, 1e-7, 2.0**-9, case.mech9d)


def test_hdf5_file_has_the_derivatives_of_the_table(case):
    try:
        import h5py
    except ImportError:
        case.checks.left_out('h5py is not installed (Debian: python3-h5py)')
        return
    path = os.path.join(case.directory, 'a.h5')
    found = case.table(GEARED + dynamic.declared((('mass', 'body(2).mass', 1.4), ('ratio', 'coupling.ratio', -1.5)))
                       + '&output sensitivities=.true., drive_forces=.true., reaction_pairs=2,5 /\n', '--hdf5', path)
    with h5py.File(path) as file:
        group = file['sensitivity']
        shapes = {name: group[name].shape for name in ('drive_force', 'reaction_force', 'reaction_moment', 'coupling_force')}
        case.checks.equal(shapes, {'drive_force': (9, 1, 2), 'reaction_force': (9, 2, 3, 2), 'reaction_moment': (9, 2, 3, 2),
                                   'coupling_force': (9, 1, 2)}, 'shapes of the derivatives of forces')
        for name in shapes:
            unit = file[name].attrs['units']
            case.checks.equal(group[name].attrs['units'], unit + type(unit)(' per unit of the parameter in the data file'), f'unit of {name}')
        case.checks.equal([scale[0].name for scale in group['reaction_force'].dims], ['/time', '/pair', '/axis', '/parameter'], 'their scales')
        for p, name in enumerate(('mass', 'ratio')):
            pairs = [('drive_force', (0,), 'F1'), ('coupling_force', (0,), 'C1')]
            pairs += [(f'reaction_{what}', (i, k), f'R{pair}.{what[0]}{axis}') for what in ('force', 'moment')
                      for i, pair in enumerate((2, 5)) for k, axis in enumerate('xyz')]
            for data, place, column in pairs:
                case.checks.true((group[data][(slice(None), *place, p)] == found[f'd({column})/d({name})']).all(), f'{data} of {column} by {name}')


def test_gears_that_share_their_force(case):
    """Two gears between the same shafts share their force as stiffness decides."""
    text = GEARED.replace('ratio=-1.5, phase=1.1 /', "ratio=-1.5, phase=1.1 /\n&coupling kind='gear', coordinates=1,2, ratio=-1.5, phase=1.1 /")
    text += "&parameter name='mass', sets='body(2).mass' /\n"
    done = case.run(text + f'&output sensitivities=.true., {FORCES} /\n', '--no-write')
    case.checks.equal(done.returncode, 3, 'forces of couplings that are not unique: the exit code')
    case.checks.true('equilibrium does not determine the force of coupling' in done.stderr, 'and the message', done.stderr)
    found = case.table(text + '&output sensitivities=.true., drive_forces=.true. /\n')
    alone = case.table(GEARED + "&parameter name='mass', sets='body(2).mass' /\n&output sensitivities=.true., drive_forces=.true. /\n")
    case.checks.near(found['d(F1)/d(mass)'], alone['d(F1)/d(mass)'], 1e-11, 'the force of the drive is determined')
