"""Positions of equilibrium, vibrations about them, and their linearised equations of motion, against closed forms.

Pendulums, masses on springs, bars in slots, a bead on a rotating hoop, balanced beams; the same mechanism in other independent
coordinates and units (which compares the program with itself), and vibrations measured in motions.
"""
import os
import re

import numpy as np
import pytest

from mech9_cases import read_table, run, text_of

G = 9.81
USAGE, DATA, ASSEMBLY, SINGULAR, FILE = 2, 3, 5, 6, 8
GRAVITY = f'&gravity acceleration=0,{-G},0 /\n'
# Eigenvalues come from matrices exact to round-off; those of unbalanced problems lose some hundred units more.
EXACT = 1e-12


def mechanism(links, coordinates, independent, *groups):
    return (f'&mechanism links={links}, coordinates={coordinates} /\n&structure cq={",".join(map(str, independent))} /\n'
            + ''.join(group + '\n' for group in groups))


def pair(k, links, kind='revolute', point='0,0,0', axis='0,0,1', more=''):
    return f"&pair coordinate={k}, links={links}, kind='{kind}', point={point}, axis={axis}{more} /"


def body(link, mass, centre, inertia=0.0):
    about_each_axis = ','.join([repr(float(inertia))] * 3)
    return f'&body link={link}, mass={float(mass)!r}, centre={centre}, inertia={about_each_axis},0,0,0 /'


def initial(k, position):
    return f'&initial coordinate={k}, position={float(position)!r} /'


class Case:
    """Runs the program on data files in a folder of its own."""

    def __init__(self, program, folder):
        self.program, self.folder = program, folder

    def __call__(self, data, *options):
        with open(os.path.join(self.folder, 'case.nml'), 'w', encoding='utf-8') as file:
            file.write(data)
        return run(self.program, 'case.nml', '--quiet', *options, folder=self.folder)

    def table(self, data, *options):
        result = self(data, *options)
        if result.returncode != 0:
            raise RuntimeError(f'{options} fails: {result.stderr}')
        return read_table(result.stdout)

    def roots(self, data):
        """Eigenvalues of the modes, those with positive imaginary part and real ones."""
        table = self.table(data, '--modes')
        return table['eigenvalue.re'] + 1j * table['eigenvalue.im']


@pytest.fixture
def case(mech9d, tmp_path):
    return Case(mech9d, tmp_path)


def near_roots(checks, roots, expected, tolerance, why):
    """Eigenvalues against the right ones, both parts over the largest magnitude."""
    expected = np.asarray(expected, complex)
    if checks.equal(len(roots), len(expected), f'{why}: as many modes'):
        checks.near([roots.real, roots.imag], [expected.real, expected.imag], tolerance, why, scale=max(abs(expected)))


def pendulum(position=0.5, extra=''):
    return mechanism(2, 1, [1], pair(1, '1,2'), body(2, 2.0, '0,-0.5,0', 0.1), GRAVITY, initial(1, position), extra)


# its angular frequency: sqrt(m g a/I)
OMEGA = np.sqrt(2.0 * G * 0.5 / (0.1 + 2.0 * 0.25))


def test_modes_of_a_pendulum(checks, case):
    modes = case.table(pendulum(), '--modes')
    checks.near(modes['frequency'], [OMEGA / (2 * np.pi)], EXACT, 'a compound pendulum vibrates with sqrt(m g a/I)')
    checks.near([modes['eigenvalue.re'][0], modes['damping'][0]], [0, 0], 0.0, 'and without damping exactly so')
    checks.near(modes['q1.re'], [1], 0.0, 'its shape is 1')
    roots = case.roots(pendulum(3.1))
    checks.near(roots.real, [OMEGA, -OMEGA], EXACT, 'a growth and a decay are two modes')
    degrees = pendulum(30.0).replace('links=2,', "links=2, angle_unit='deg',", 1)
    near_roots(checks, case.roots(degrees), [1j * OMEGA], EXACT, 'degrees change nothing')


def test_top_of_a_pendulum(checks, case):
    up = case.table(pendulum(3.0), '--equilibrium')
    checks.near([up['q1'][0], up['growth'][0]], [np.pi, OMEGA], EXACT, 'near its top it stays there, and falls at that rate')
    checks.equal(up['stable'][0], 0.0, 'which is not stable')


@pytest.mark.parametrize('start', [np.pi / 2, 2.0, -2.5, 1.0, 0.0])
def test_pendulum_falls_to_its_rest(checks, case, start):
    down = case.table(pendulum(start), '--equilibrium')
    checks.near([down['q1'][0], down['stable'][0], down['growth'][0]], [0, 1, 0], EXACT, f'from {start:.2f} it falls to its rest')


def test_random_starts_of_a_pendulum(checks, case):
    both = case.table(pendulum(), '--equilibrium', '--starts', '20', '--table', '-', '--report', 'both.json')
    reached = re.findall(r'"starts": (\d+)', text_of(os.path.join(case.folder, 'both.json')))
    checks.equal(sum(map(int, reached)), 21, 'each start, and the initial position, leads to one of the equilibria')
    checks.near(both['q1'], [0, np.pi], EXACT, 'random starts find both equilibria, each once')
    checks.near(both['stable'], [1, 0], 0.0, 'and tell which is stable')


@pytest.mark.parametrize('length', [1e-9, 1e9])
def test_pendulum_of_any_length(checks, case, length):
    far = mechanism(2, 1, [1], pair(1, '1,2'), body(2, 1e-30, f'{length!r},0,0'), GRAVITY, initial(1, 0.5))
    near_roots(checks, case.roots(far), [1j * np.sqrt(G / length)], EXACT, f'a pendulum of {length} m and 1e-30 kg')


def test_wound_pendulum(checks, case):
    """A torsion spring that knows whole turns: every angle that is found is a root of m g a sin q + k q."""
    stiffness = 1.0
    data = pendulum(0.5, f"&load kind='coordinate', coordinate=1, stiffness={stiffness} /")
    table = case.table(data, '--equilibrium', '--starts', '60')
    q = table['q1']
    checks.near(2.0 * G * 0.5 * np.sin(q) + stiffness * q, 0, 1e-12, 'a wound pendulum rests at roots of its torque', scale=G)
    checks.true(max(abs(q - 0.5)) > np.pi, 'one of them beyond half a turn from the start', str(q))
    checks.near(table['stable'], G * np.cos(q) + stiffness > 0, 0.0, 'and stays where the torque rises')


MASS, STIFFNESS = 2.0, 50.0


def mass_on_a_spring(damping):
    return mechanism(2, 1, [1], pair(1, '1,2', 'prismatic', axis='0,1,0'), body(2, MASS, '0,0,0'), GRAVITY, initial(1, 0.3),
                     f"&load kind='coordinate', coordinate=1, stiffness={STIFFNESS}, damping={damping} /")


@pytest.mark.parametrize('damping', [0.0, 3.0, 20.0, 30.0])
def test_damped_mass(checks, case, damping):
    data = mass_on_a_spring(damping)
    rest = case.table(data, '--equilibrium')
    checks.near(rest['q1'], [-MASS * G / STIFFNESS], EXACT, 'a mass on a spring sinks by m g/k')
    expected = np.roots([MASS, damping, STIFFNESS])
    expected = np.sort_complex(expected[expected.imag >= 0])
    roots = np.sort_complex(case.roots(data))
    checks.equal(len(roots), len(expected), f'damping {damping}: a pair of roots, or two real ones')
    # the double root of critical damping is known to the root of round-off
    checks.near(np.array([roots.real, roots.imag]), np.array([expected.real, expected.imag]),
                1e-7 if damping == 20.0 else EXACT, f'damping {damping}: the roots of m s^2 + c s + k', scale=5.0)


def test_part_of_the_critical_damping(checks, case):
    modes = case.table(mass_on_a_spring(4.0), '--modes')
    checks.near(modes['damping'], [4.0 / (2 * np.sqrt(MASS * STIFFNESS))], EXACT, 'damping is a part of the critical one')


def test_damper_without_a_spring(checks, case):
    free = case.roots(mechanism(2, 1, [1], pair(1, '1,2', 'prismatic', axis='1,0,0'), body(2, MASS, '0,0,0'), initial(1, 0.3),
                                "&load kind='coordinate', coordinate=1, damping=3 /"))
    checks.near(free.real, [0, -1.5], EXACT, 'without a spring one root is zero and the other -c/m')


def double_pendulum(q1=0.2, q2=-0.1):
    return mechanism(3, 2, [1, 2], pair(1, '1,2'), pair(2, '2,3', point='0,-1,0'), body(2, 1.0, '0,-1,0'), body(3, 1.0, '0,-2,0'),
                     GRAVITY, initial(1, q1), initial(2, q2))


def test_double_pendulum(checks, case):
    modes = case.table(double_pendulum(), '--modes')
    omega = np.sqrt(G * np.array([2 - np.sqrt(2), 2 + np.sqrt(2)]))
    checks.near(modes['eigenvalue.im'], omega, EXACT, 'equal double pendulum: sqrt((2 -+ sqrt 2) g/l)')
    # absolute angles are in the ratio 1 : +- sqrt 2, q2 is their difference
    checks.near(modes['q2.re'] / modes['q1.re'], [np.sqrt(2) - 1, -np.sqrt(2) - 1], EXACT, 'and its shapes')
    checks.near(np.maximum(abs(modes['q1.re']), abs(modes['q2.re'])), [1, 1], 0.0, 'whose largest numbers are 1')
    all_four = case.table(double_pendulum(), '--equilibrium', '--starts', '40')
    checks.equal(len(all_four['q1']), 4, 'a double pendulum has four equilibria')
    checks.near(np.sum(all_four['stable']), 1, 0.0, 'one of them is stable')
    # a small vibration in the first mode, released from rest, follows cos(omega t)
    small = 1e-4
    start = double_pendulum(small * modes['q1.re'][0], small * modes['q2.re'][0])
    motion = case.table(start + '&time end=5, intervals=100 /\n&solver relative_tolerance=1e-12, absolute_tolerance=1e-16 /\n')
    checks.near(motion['q2'] / small, modes['q2.re'][0] * np.cos(omega[0] * motion['t']), 1e-6, 'a motion vibrates like its mode')


def bar_in_slots(independent, start):
    """A bar whose ends slide along x and y (pairs 1 and 4); it turns by pair 2 against the first slider."""
    length = 1.2
    return mechanism(4, 4, [independent], pair(1, '1,2', 'prismatic', axis='1,0,0'), pair(2, '2,3'),
                     pair(3, '3,4', point=f'0,{length},0'),
                     pair(4, '1,4', 'prismatic', point=f'0,{length},0', axis='0,1,0'),
                     body(3, 3.0, f'0,{length / 2},0', 0.2), GRAVITY,
                     *[initial(k, value) for k, value in enumerate(start, 1)])


@pytest.mark.parametrize('independent', [1, 2, 3, 4])
def test_bar_in_slots(checks, case, independent):
    length = 1.2
    omega = np.sqrt(3.0 * G * length / 2 / (3.0 * length**2 / 4 + 0.2))
    # the bar hangs down: q2 = pi; the upper slider goes down from its place at q = 0, 1.2 above the origin
    angle = 2.5
    start = [length * np.sin(angle), angle, -angle, length * np.cos(angle) - length]
    rest = case.table(bar_in_slots(independent, start), '--equilibrium')
    checks.near([rest['q2'][0], rest['q4'][0]], [np.pi, -2 * length], 1e-10,
                f'a bar in two slots hangs down, also where q{independent} is at its dead point')
    # a flat minimum in q4 is known in q2 to the root of round-off if q4 is kept
    near_roots(checks, case.roots(bar_in_slots(independent, start)), [1j * omega], 1e-9, f'it vibrates the same by q{independent}')


def four_bar(independent, scale=1.0, q=(-0.2, 1.8, -0.1, 1.45)):
    """A four-bar with springs and dampers; lengths and gravity in another scale leave its eigenvalues as they are."""
    def point(x, y):
        return f'{float(x * scale)!r},{float(y * scale)!r},0'
    return mechanism(4, 4, [independent], pair(1, '1,2'), pair(2, '2,3', point=point(0.4, 0)),
                     pair(3, '3,4', point=point(1.4, 0), more=f', moving_point={point(2.0, 0.9)}'),
                     pair(4, '1,4', point=point(1.2, 0), more=f', moving_point={point(1.2, 0)}'),
                     body(2, 1.0, point(0.2, 0.05), 0.02 * scale**2), body(3, 2.0, point(0.9, 0.2), 0.1 * scale**2),
                     body(4, 1.5, point(1.6, 0.4), 0.06 * scale**2),
                     f'&gravity acceleration=0,{float(-G * scale)!r},0 /',
                     f"&load kind='spring', links=1,3, position={point(0.3, 1.8)}, second_position={point(1.0, 0.3)}, stiffness=30, "
                     f'free_length={float(0.5 * scale)!r}, damping=2 /',
                     f"&load kind='coordinate', coordinate=3, stiffness={float(4.0 * scale**2)!r}, rest=0.4, "
                     f"damping={float(0.3 * scale**2)!r} /",
                     f"&load kind='force', link=4, position={point(1.5, 0.6)}, "
                     f"force={float(4 * scale)!r},{float(2 * scale)!r},0, frame='link' /",
                     *[initial(k, value) for k, value in enumerate(q, 1)])


@pytest.fixture
def eigenvalues(checks, case):
    """Those of the four-bar by its first coordinate."""
    roots = case.roots(four_bar(1))
    checks.true(np.all(abs(roots) > 0.1), 'the four-bar vibrates')
    return roots


@pytest.mark.parametrize('independent', [2, 3, 4])
def test_four_bar_by_other_coordinates(checks, case, eigenvalues, independent):
    place = case.table(four_bar(1), '--equilibrium')
    start = [place[f'q{k}'][0] + (0.02 if k == independent else 0.0) for k in range(1, 5)]
    data = four_bar(independent, q=start)
    checks.near(case.table(data, '--equilibrium')['q1'], place['q1'], 1e-9, 'the rest does not depend on cq')
    near_roots(checks, case.roots(data), eigenvalues, 1e-9, 'nor do the eigenvalues')


@pytest.mark.parametrize('scale', [1e-3, 1e3])
def test_four_bar_of_any_size(checks, case, eigenvalues, scale):
    near_roots(checks, case.roots(four_bar(1, scale)), eigenvalues, 1e-9, f'eigenvalues do not depend on the size, {scale}')


def test_crank_at_its_limit(checks, case):
    """A torque on a crank that cannot turn round: it rests at its limit, where the crank is at its dead point."""
    data = mechanism(4, 4, [1], pair(1, '1,2'), pair(2, '2,3', point='0.7,0,0', more=', moving_point=0,0,0'),
                     pair(3, '3,4', point='0.9,0,0', more=', moving_point=0.4,0,0'), pair(4, '1,4', point='1.2,0,0',
                                                                                      more=', moving_point=0,0,0'),
                     body(2, 1.0, '0.3,0,0'), body(3, 1.0, '0.4,0,0'), initial(1, 0.7), initial(2, -1.0), initial(4, 2.0),
                     "&load kind='coordinate', coordinate=1, force=5 /")
    limit = np.arccos((1.2**2 + 0.7**2 - 1.3**2) / (2 * 1.2 * 0.7))
    rest = case.table(data, '--equilibrium')
    # the position is known to round-off in the other coordinates, q1 to the square of it
    checks.near([rest['q1'][0], rest['stable'][0]], [limit, 1], EXACT, 'a crank that is pushed rests at its limit')


def hoop(speed, start):
    """A bead on a hoop of radius 0.5 that turns about the vertical y: driven pair 1; pair 2 turns the bead about z of the hoop."""
    return mechanism(3, 2, [1, 2], pair(1, '1,2', axis='0,1,0'), pair(2, '2,3'), body(3, 0.7, '0,-0.5,0'), GRAVITY,
                     f"&drive coordinate=1, kind='polynomial', coefficients=0.3,{float(speed)!r} /", initial(2, start))


CRITICAL = np.sqrt(G / 0.5)


def test_bead_on_a_slow_hoop(checks, case):
    critical, slow = CRITICAL, 0.7 * CRITICAL
    near_roots(checks, case.roots(hoop(slow, 0.2)), [1j * np.sqrt(critical**2 - slow**2)], EXACT,
                'a bead on a hoop that turns slowly vibrates about the bottom, slower than at rest')


def test_bead_on_a_fast_hoop(checks, case):
    critical, fast = CRITICAL, 1.6 * CRITICAL
    angle = np.arccos((critical / fast)**2)
    up = case.table(hoop(fast, 0.8), '--equilibrium')
    checks.near([up['q2'][0], up['stable'][0]], [angle, 1], EXACT, 'on a fast hoop it rests beside the bottom')
    near_roots(checks, case.roots(hoop(fast, 0.8)), [1j * fast * np.sin(angle)], EXACT, 'and vibrates with Omega sin q')
    all_of_them = case.table(hoop(fast, 0.8), '--equilibrium', '--starts', '30')
    checks.near(all_of_them['q2'], [-angle, 0, angle, np.pi], 1e-11, 'four relative equilibria')
    checks.near(all_of_them['growth'], [0, np.sqrt(fast**2 - critical**2), 0, np.sqrt(fast**2 + critical**2)], 1e-11,
                'the bottom has become unstable')


def test_forces_at_rest(checks, case):
    speed = 1.6 * np.sqrt(G / 0.5)
    table = case.table(hoop(speed, 0.8) + '&output drive_forces=.true., reactions=.true. /\n', '--equilibrium')
    names = list(table)
    checks.equal(names[:4] + names[-2:], ['equilibrium', 'q1', 'q2', 'F1', 'stable', 'growth'], 'columns of forces stand after q')
    radius = 0.5 * np.sin(np.arccos(G / 0.5 / speed**2))
    checks.near([table['F1'][0], table['R2.fy'][0], np.hypot(table['R2.fx'][0], table['R2.fz'][0])],
                [0, 0.7 * G, 0.7 * speed**2 * radius], 1e-11, 'the hoop carries the weight and the centripetal force')


def slide_with(loads, start=0.0):
    """A mass on a slide without friction."""
    return mechanism(2, 1, [1], pair(1, '1,2', 'prismatic', axis='1,0,0'), initial(1, start), body(2, 1, '0,0,0'), *loads)


@pytest.mark.parametrize('loads, start, expected, why', [
    (["&load kind='coordinate', coordinate=1, stiffness=20, rest=-1, force=3 /"], 0.0, -0.85, 'a spring and a force in one load'),
    ([f"&load kind='coordinate', coordinate=1, force={force} /" for force in (0.1, 0.2, -0.3)], 0.0, 0.0, 'three forces'),
    (["&load kind='spring', links=1,2, position=-0.13,0,0, second_position=0.1,0,0, stiffness=1234.567, free_length=0.3333 /"], 0.2, 0.1033,
     'a spring of its free length')], ids=['in_one_load', 'three_forces', 'free_length'])
def test_forces_that_cancel(checks, case, loads, start, expected, why):
    """Forces that cancel each other, within one load or among several, leave round-off of their parts."""
    found = case.table(slide_with(loads, start), '--equilibrium')
    checks.near(found['q1'], [expected], EXACT, f'{why} that cancel: the position')


@pytest.mark.parametrize('damping, words', [
    (0.0, 'its lowest frequency is 1.59155 Hz'),
    (40.0, f'it does not oscillate: deviations shrink by the factor e within {1 / (20 - 300 ** 0.5):.4g} s')], ids=['free', 'damped'])
def test_words_on_the_return(checks, case, damping, words):
    """The way in which a mass returns: its frequency, or the slower of two rates beyond critical damping."""
    load = f"&load kind='coordinate', coordinate=1, stiffness=100, damping={damping} /"
    with open(os.path.join(case.folder, 'case.nml'), 'w', encoding='utf-8') as file:
        file.write(slide_with([load]))
    said = run(case.program, 'case.nml', '--equilibrium', folder=case.folder)
    checks.true(words in said.stdout + said.stderr, f'damping {damping}: how it returns', said.stdout + said.stderr)


def balanced_beam(start):
    """Mass 2 at 0.6 m on a beam, and a spring without free length from 0.8 m above the pivot to 0.5 m on the beam."""
    stiffness = 2.0 * G * 0.6 / (0.8 * 0.5)
    return mechanism(2, 1, [1], pair(1, '1,2'), body(2, 2.0, '0.6,0,0', 0.05), GRAVITY, initial(1, start),
                     f"&load kind='spring', links=1,2, position=0,0.8,0, second_position=0.5,0,0, stiffness={float(stiffness)!r} /")


@pytest.mark.parametrize('start', [0.0, 0.3, 1.1, -2.0])
def test_balanced_beam(checks, case, start):
    rest = case.table(balanced_beam(start), '--equilibrium')
    checks.near([rest['q1'][0], rest['stable'][0], rest['growth'][0]], [start, 1, 0], 1e-15, 'a balanced beam stays where it is')
    modes = case.table(balanced_beam(start), '--modes')
    checks.equal(len(modes['mode']), 1, 'it has one mode')
    checks.near([modes['frequency'][0], modes['damping'][0]], [0, 0], 0.0, 'of frequency zero')


def slides(stiffness, *masses):
    """Two slides in a row on springs, the second one of this stiffness, with 4 N on it."""
    return mechanism(3, 2, [1, 2], pair(1, '1,2', 'prismatic', axis='1,0,0'), pair(2, '2,3', 'prismatic', axis='1,0,0'),
                     initial(1, 0.1), initial(2, 0.0), "&load kind='coordinate', coordinate=1, stiffness=10 /",
                     f"&load kind='coordinate', coordinate=2, stiffness={stiffness}, force=4 /",
                     *[body(link, 1.0, '0,0,0') for link in masses])


@pytest.mark.parametrize('stiffness, stable', [(20, 1), (-20, 0)])
@pytest.mark.parametrize('masses', [(), (2,), (3,), (2, 3)], ids=['no_mass', 'first_mass', 'second_mass', 'both_masses'])
def test_statics(checks, case, masses, stiffness, stable):
    """Slides with springs of 10 N/m and 20 N/m (or -20 N/m) rest where 20 q2 = 4, with mass or without. Without the mass of some link
    there is no growth, and the stiffness alone tells whether the position is stable."""
    table = case.table(slides(stiffness, *masses), '--equilibrium')
    why = f'slides of {stiffness} N/m with masses on links {masses}'
    checks.near([table['q1'][0], table['q2'][0]], [0, 4 / stiffness], EXACT, f'{why}: the position', scale=1)
    checks.equal(table['stable'].tolist(), [stable], f'{why}: stable or not')
    checks.equal(bool(np.isnan(table['growth'][0])), masses != (2, 3), f'{why}: no growth without inertia')


@pytest.mark.parametrize('options', [('--modes',), ('--linear', 'l.h5')], ids=['modes', 'linear'])
def test_modes_need_inertia(checks, case, options):
    result = case(slides(20, 3), *options)
    checks.equal(result.returncode, DATA, f'{options} need inertia')
    checks.true('independent coordinate 2 has no inertia' in result.stderr, f'{options}: the coordinate is named', result.stderr)


@pytest.mark.parametrize('option', ['--equilibrium', '--modes'])
def test_gimbal_lock_is_refused(checks, case, option):
    """A ball joint of three hinges: the forces do not tell whether it rests, although it has inertia elsewhere."""
    ball = mechanism(4, 3, [1, 2, 3], *[pair(k, f'{k},{k + 1}', axis=axis) for k, axis in enumerate(('1,0,0', '0,1,0', '0,0,1'), 1)],
                     *[initial(k, np.pi / 2 if k == 2 else 0) for k in (1, 2, 3)], body(4, 1.0, '0,0,0', 1.0))
    result = case(ball, option)
    checks.equal(result.returncode, SINGULAR, f'{option}: no equilibrium is told in gimbal lock')
    checks.true('gimbal lock' in result.stderr and 'coordinates 1, 3 can move together' in result.stderr, f'{option}: it is named',
                result.stderr)


def test_cost_of_many_starts(checks, case):
    """A mass that rests everywhere: a row for nearly each start, at a cost that grows with their number. Twice as many starts take
    twice as long; when all equilibria were copied for each new one, it was more than four times."""
    anywhere = mechanism(2, 1, [1], pair(1, '1,2', 'prismatic', axis='1,0,0'), body(2, 1.0, '0,0,0'), initial(1, 0.0))
    seconds = []
    for n in (400, 800):
        before = os.times().children_user
        table = case.table(anywhere, '--equilibrium', '--starts', str(n), '--table', '-')
        seconds.append(os.times().children_user - before)
        checks.true(len(table['q1']) > 0.95 * n and np.all(np.diff(table['q1']) > 0), f'{n} starts: many rows, sorted')
    checks.true(seconds[1] < 3 * seconds[0] + 0.1, 'twice as many starts take twice as long', seconds)


def test_two_masses_on_a_rail(checks, case):
    """Two masses on a rail, joined by a spring: one mode is the motion of both."""
    data = mechanism(3, 2, [1, 2], pair(1, '1,2', 'prismatic', axis='1,0,0'), pair(2, '2,3', 'prismatic', axis='1,0,0'),
                     body(2, 1.0, '0,0,0'), body(3, 3.0, '0,0,0'), initial(1, 0.3), initial(2, 0.4),
                     "&load kind='coordinate', coordinate=2, stiffness=12, rest=1, damping=0.5 /")
    rest = case.table(data, '--equilibrium')
    checks.near(rest['q2'], [1], EXACT, 'the spring relaxes')
    roots = case.roots(data)
    reduced = 0.75
    pair_of_roots = np.roots([reduced, 0.5, 12])
    near_roots(checks, roots, [0, pair_of_roots[0].real + 1j * abs(pair_of_roots[0].imag)], EXACT,
               'a double root zero is one mode, beside the vibration')


def test_linearised_four_bar(checks, case):
    data = four_bar(1) + "&point name='P', link=3, position=0.5,0.2,0 /\n"
    result = case(data, '--linear', 'linear.h5')
    checks.equal((result.returncode, result.stdout), (0, ''), '--linear writes a file and no table')
    try:
        import h5py
    except ImportError:
        checks.left_out('no h5py')
        return
    with h5py.File(os.path.join(case.folder, 'linear.h5')) as file:
        matrices = {name: file['state_space'][name][()] for name in 'ABCD'}
        second = {name: file['second_order'][name][()] for name in 'MCK'}
        outputs = [name.decode() for name in file['state_space/output'][()]]
    roots = case.roots(four_bar(1))
    found = np.linalg.eigvals(matrices['A'])
    checks.near(sorted(found.imag)[-1], roots[0].imag, 1e-9, 'the eigenvalues of A are those of the modes')
    accelerate = np.linalg.solve(second['M'], np.hstack([-second['K'], -second['C']]))
    checks.near(matrices['A'][1:], accelerate, 1e-12, 'A holds M^-1 K and M^-1 C')
    row = {name: matrices['C'][i] for i, name in enumerate(outputs)}
    checks.near([row['q1'], row['dq1'], row['ddq1']], [[1, 0], [0, 1], matrices['A'][1]], 1e-12, 'outputs of the free coordinate')
    checks.near([row['P.vx'][1], row['dq3'][1]], [row['P.x'][0], row['q3'][0]], 1e-12, 'rates follow like positions')
    checks.near([matrices['D'][outputs.index('P.ax')][0]], [row['P.x'][0] * matrices['B'][1, 0]], 1e-12, 'and accelerations')


def state_space(checks, case, data, why):
    """The matrices of --linear, with the names of the outputs; None without h5py."""
    try:
        import h5py
    except ImportError:
        checks.left_out('no h5py')
        return None
    checks.equal(case(data, '--linear', 'linear.h5').returncode, 0, f'{why}: --linear')
    with h5py.File(os.path.join(case.folder, 'linear.h5')) as file:
        found = {name: file['state_space'][name][()] for name in 'ABCD'}
        found['outputs'] = [name.decode() for name in file['state_space/output'][()]]
    return found


def test_linearised_motion_in_degrees(checks, case):
    """In degrees, inputs give degrees, and angles among the outputs count in them."""
    data = four_bar(1) + "&point name='P', link=3, position=0.5,0.2,0 /\n"
    degree = np.pi / 180
    in_degrees = data.replace('links=4,', "links=4, angle_unit='deg',", 1).replace('rest=0.4', f'rest={0.4 / degree!r}')
    in_degrees = re.sub(r'position=(-?[\d.]+) /', lambda found: f'position={float(found[1]) / degree!r} /', in_degrees)
    one, other = state_space(checks, case, data, 'radians'), state_space(checks, case, in_degrees, 'degrees')
    if one is None:
        return
    size = np.where([name.startswith('P.') for name in one['outputs']], 1.0, 1 / degree)[:, None]
    for name, expected in (('A', one['A']), ('B', one['B'] / degree), ('C', one['C'] * size * degree), ('D', one['D'] * size)):
        checks.near(other[name], expected, 1e-9, f'{name} in degrees', scale=np.abs(expected).max())


def test_linearised_motion_on_a_hoop(checks, case):
    """Outputs beside a relative equilibrium: a bead on a turning hoop, whose place is known."""
    fast = 1.6 * np.sqrt(G / 0.5)
    space = state_space(checks, case, hoop(fast, 0.8) + "&point name='P', link=3, position=0,-0.5,0 /\n", 'a hoop')
    if space is None:
        return
    angle, h = np.arccos(G / 0.5 / fast**2), 1e-3

    def place(t, q, dq, ddq):
        """The bead at a time, for an angle q + dq t + ddq t^2/2."""
        now, turn = angle + q + dq * t + ddq * t**2 / 2, 0.3 + fast * t
        return 0.5 * np.array([np.sin(now) * np.cos(turn), -np.cos(now), -np.sin(now) * np.sin(turn)])

    def motion(*change):
        """Position, velocity and acceleration by differences of fourth order."""
        p = [place(k * h, *change) for k in (-2, -1, 0, 1, 2)]
        return np.array([p[2], (p[0] - 8 * p[1] + 8 * p[3] - p[4]) / (12 * h),
                         (-p[0] + 16 * p[1] - 30 * p[2] + 16 * p[3] - p[4]) / (12 * h**2)])

    by = [(motion(*change) - motion(*-change)) / 2e-3 for change in 1e-3 * np.eye(3)]
    for order, letter in enumerate(('', 'v', 'a')):
        rows = [space['outputs'].index(f'P.{letter}{axis}') for axis in 'xyz']
        for column in range(2):
            expected = by[column][order] + by[2][order] * space['A'][1, column]
            # differences of fourth order at 1e-3 err by 1e-6 of the sixth derivative in time, those by the angle by 1e-6
            checks.near(space['C'][rows, column], expected, 1e-5, f'P.{letter} on a turning hoop by state {column + 1}',
                        scale=np.abs(by[0][order]).max())
        checks.near(space['D'][rows, 0], by[2][order] * space['B'][1, 0], 1e-5, f'P.{letter} on a turning hoop by the input', scale=10.0)


def test_shares_of_the_energy(checks, case):
    """Two masses that a spring and a damper join: their shares of the energy are those of m |x|^2."""
    masses = (1.0, 3.0)
    data = mechanism(3, 2, [1, 2], pair(1, '1,2', 'prismatic', axis='1,0,0'), pair(2, '1,3', 'prismatic', point='0,1,0', axis='1,0,0'),
                     *(body(k + 2, mass, '0,0,0') for k, mass in enumerate(masses)), initial(1, 0.0), initial(2, 0.0),
                     "&load kind='coordinate', coordinate=1, stiffness=20, damping=4 /",
                     "&load kind='coordinate', coordinate=2, stiffness=5 /",
                     "&load kind='spring', links=2,3, position=0,0,0, second_position=3,1,0, stiffness=9, free_length=3.1, damping=0.5 /")
    try:
        import h5py
    except ImportError:
        checks.left_out('no h5py')
        return
    checks.equal(case(data, '--modes', '--hdf5', 'shares.h5').returncode, 0, 'two damped masses')
    with h5py.File(os.path.join(case.folder, 'shares.h5')) as file:
        shapes, shares = file['q_re'][()] + 1j * file['q_im'][()], file['kinetic_share'][()]
    energy = masses * abs(shapes)**2
    checks.true(np.max(abs(shapes.imag)) > 0.05, 'the masses move with different phases', str(shapes))
    checks.near(shares, energy / energy.sum(axis=1, keepdims=True), 1e-12, 'shares of the kinetic energy')


def test_files(checks, case):
    result = case(pendulum(), '--modes', '--hdf5', 'modes.h5', '--report', 'modes.json', '--table', 'modes.dat')
    checks.equal((result.returncode, result.stdout), (0, ''), 'results go to the files that are named')
    checks.near(read_table(text_of(os.path.join(case.folder, 'modes.dat')))['mode'], [1], 0.0, 'the table')
    checks.true('"eigenvalue"' in text_of(os.path.join(case.folder, 'modes.json')), 'the report tells the eigenvalues')
    result = case(pendulum(), '--modes', '--mode', '1', '--animate', 'mode.svg')
    checks.equal(result.returncode, 0, 'a mode is shown')
    checks.true('<svg' in text_of(os.path.join(case.folder, 'mode.svg')), 'as a moving picture')
    for words, says in (('--modes --mode 1 --animate mode.svg', 'the film of a mode has no arrows'),
                        ('--equilibrium --sketch rest.svg', 'a run draws the arrows, and --equilibrium makes none')):
        result = run(case.program, 'case.nml', *words.split(), '--set', 'output.force_arrows=.true.', folder=case.folder)
        checks.true(f'without effect: force_arrows; {says}' in result.stderr, words, result.stderr)
    result = case(pendulum(), '--equilibrium', '--starts', '5', '--hdf5', 'rest.h5')
    checks.equal(result.returncode, 0, 'equilibria are written as HDF5')
    try:
        import h5py
    except ImportError:
        checks.left_out('no h5py')
        return
    with h5py.File(os.path.join(case.folder, 'rest.h5')) as file:
        checks.near(file['q'][()], [[0], [np.pi]], EXACT, 'HDF5: q(equilibrium, coordinate)')
        checks.near(file['stable'][()], [1, 0], 0.0, 'HDF5: stable')
    data = four_bar(1) + '&output reactions=.true. /\n'
    result = case(data, '--equilibrium', '--hdf5', 'forces.h5', '--table', 'forces.dat', '--report', 'forces.json')
    checks.equal(result.returncode, 0, 'forces are written')
    table = read_table(text_of(os.path.join(case.folder, 'forces.dat')))
    with h5py.File(os.path.join(case.folder, 'forces.h5')) as file:
        for name, kind in (('reaction_force', 'f'), ('reaction_moment', 'm')):
            expected = [[[table[f'R{k}.{kind}{axis}'][0] for axis in 'xyz'] for k in (1, 2, 3, 4)]]
            checks.equal(file[name].shape, (1, 4, 3), f'HDF5: {name} (equilibrium, pair, axis), as in runs')
            checks.near(file[name][()], expected, 0.0, f'HDF5: {name} holds the columns')
            checks.equal([file[name].dims[i][0].name for i in range(3)], ['/equilibrium', '/pair', '/axis'], f'HDF5: scales of {name}')
        checks.equal([name for name in file if name.startswith('R')], [], 'HDF5: no data sets of single columns')
        checks.equal(int(np.sum(file['reaction_unique'][()] == 0)), 12, 'HDF5: a planar four-bar has 12 components that are not unique')
    checks.true('"unique"' in text_of(os.path.join(case.folder, 'forces.json')), 'the report tells the components that are unique')
    with h5py.File(os.path.join(case.folder, 'modes.h5')) as file:
        checks.near([file['kinetic_share'][0, 0], file['q_re'][0, 0]], [1, 1], EXACT, 'HDF5: shares of the energy, shapes')


def test_torque_without_an_equilibrium(checks, case):
    heavy = pendulum(extra="&load kind='coordinate', coordinate=1, force=15 /")
    result = case(heavy, '--equilibrium', '--report', 'none.json')
    checks.equal(result.returncode, ASSEMBLY, 'a torque beyond m g a has no equilibrium')
    checks.true('on coordinate 1' in result.stderr, 'the forces that are left are told by coordinate', result.stderr)
    checks.true('"exit_code": 5' in text_of(os.path.join(case.folder, 'none.json')), 'and the report has the code')


def test_weight_on_a_slide_has_no_equilibrium(checks, case):
    slide = mechanism(2, 1, [1], pair(1, '1,2', 'prismatic', axis='0,1,0'), body(2, 2.0, '0,0,0'), GRAVITY, initial(1, 0.0))
    result = case(slide, '--modes')
    checks.equal(result.returncode, ASSEMBLY, 'a weight on a slide has none')
    checks.true('-19.62' in result.stderr, 'its weight is left', result.stderr)


@pytest.mark.parametrize('options', [('--equilibrium',), ('--equilibrium', '--starts', '5'), ('--modes',), ('--linear', 'l.h5')],
                         ids=' '.join)
def test_rest_where_branches_meet(checks, case, options):
    """A parallelogram in one line, pulled along it: it rests there, and two branches meet, with vibrations of their own."""
    flat = mechanism(4, 4, [1], pair(1, '1,2'), pair(2, '2,3', point='0.4,0,0', more=', moving_point=0,0,0'),
                     pair(3, '3,4', point='1,0,0', more=', moving_point=0.4,0,0'),
                     pair(4, '1,4', point='1,0,0', more=', moving_point=0,0,0'), body(2, 1.0, '0.2,0,0'),
                     f'&gravity acceleration={G},0,0 /', initial(1, 0))
    result = case(flat, *options)
    checks.equal(result.returncode, SINGULAR, f'{options}: where branches meet, there is no one linearised motion')
    checks.true('is in a singular position' in result.stderr, f'{options}: told', result.stderr)


@pytest.mark.parametrize('options, words', [(('--modes', '--equilibrium'), 'different tables'), (('--mode', '1'), 'give all three'),
                                            (('--modes', '--animate', 'a.svg'), '--mode K')])
def test_options_that_are_refused(checks, case, options, words):
    result = case(pendulum(), *options)
    checks.equal(result.returncode, USAGE, f'{options} is refused')
    checks.true(words in result.stderr, f'{options}: with its remedy', result.stderr)


@pytest.mark.parametrize('options', [
    ('--equilibrium', '--table', '/dev/full'), ('--modes', '--table', '/dev/full'), ('--linear', '/dev/full'),
    ('--equilibrium', '--hdf5', '/dev/full'), ('--modes', '--report', '/dev/full')], ids=' '.join)
def test_full_disk(checks, case, options):
    if checks.has_full_disk():
        result = case(pendulum(), *options)
        checks.equal(result.returncode, FILE, f'{options}: a full disk')
        checks.true('No space left on device' in result.stderr, f'{options}: a full disk is told', result.stderr)


def test_mode_that_is_not_there(checks, case):
    result = case(pendulum(), '--modes', '--mode', '7', '--animate', 'a.svg')
    checks.equal(result.returncode, USAGE, 'a mode that is not there is refused')
