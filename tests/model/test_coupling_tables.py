"""Couplings by tables, with and without ends: the law of a cam and of a gear that is not round in closed form, energy, the force of a
cam on its follower, a place of rest and its frequency, refusals.

Compares the program with itself in part: the follower of a cam as the independent coordinate gives the same motion.
"""
import numpy as np
import pytest

from coupling_files import NEAR, TIGHT, TWO_WHEELS, output, table


def test_tables_with_ends(checks, mech9k, mech9d, tmp_path):
    """Tables over a slide end with their points, where the motion stops with its time."""
    path = tmp_path / 'law.dat'
    x = np.linspace(-0.2, 0.5, 71)
    np.savetxt(path, np.column_stack([x, 0.3 * np.sin(4 * x)]), fmt='%.17g')
    slides = f"""&structure cq={{cq}} /
&pair coordinate=1, links=1,2, kind='prismatic', axis=1,0,0 /
&pair coordinate=2, links=1,3, kind='prismatic', axis=0,1,0 /
&coupling kind='table', coordinates=1,2, file='{path}' /
&body link=2, mass=2 /
&body link=3, mass=1 /
&time end={{end}}, intervals=20 /
&output reactions=.true. /
"""
    drive = "&drive coordinate=1, kind='polynomial', coefficients=-0.2,0.7 /\n"
    found = table(mech9k, slides.format(cq=1, end=1) + drive)
    q = found['q1']
    # at the ends the spline has the derivatives of the polynomial through six points at steps of h = 0.01, which miss those of
    # the wave by parts of its sixth derivative, 0.3 4^6: h^5/6 of the first one, 2e-8, and about h^4/2 of the second one, 6e-6
    checks.near(found['q2'], 0.3 * np.sin(4 * q), 1e-11, 'a table over a slide')
    checks.near(found['dq2'], 1.2 * np.cos(4 * q) * 0.7, 5e-8, 'its rate')
    checks.near(found['ddq2'], -4.8 * np.sin(4 * q) * 0.49, 1e-5, 'its acceleration')
    done = output(mech9k, slides.format(cq=1, end=1.2) + drive)
    words = ('coordinate 1 comes to an end of the table of coupling 1', 'from -0.2 to 0.5 m', ':4:1')
    checks.true(done.returncode == 6 and all(word in done.stderr for word in words), 'the drive leaves the table',
                f'{done.returncode}: {done.stderr}')
    # free: energy is kept until the slide comes to the end
    start = '&initial coordinate=1, position=0, velocity=0.5 /\n' + TIGHT
    found = table(mech9d, slides.format(cq=1, end=0.5) + start)
    checks.near(found['E.total'], found['E.total'][0], NEAR, 'energy on a table over a slide')
    done = output(mech9d, slides.format(cq=1, end=9) + start)
    checks.true(done.returncode == 6 and all(word in done.stderr for word in words), 'the motion leaves the table',
                f'{done.returncode}: {done.stderr}')


def test_table_over_a_part_of_a_turn(checks, mech9k, tmp_path):
    """A wheel, in degrees."""
    path = tmp_path / 'part.dat'
    x = np.linspace(-30, 60, 91)
    np.savetxt(path, np.column_stack([x, 20 * np.sin(np.radians(x))]), fmt='%.17g')
    wheels = TWO_WHEELS.format(unit='deg', second='revolute', axis='0,0,1', words=f"kind='table', file='{path}'", first=-30, other=-10)
    found = table(mech9k, wheels.replace('-30,2,0.5', '-30,90'))
    checks.near(found['q2'], 20 * np.sin(np.radians(found['q1'])), 1e-9, 'a table over a part of a turn, in degrees')
    done = output(mech9k, wheels.replace('-30,2,0.5', '-30,95'))
    checks.true(done.returncode == 6 and 'from -30 to 60 deg' in done.stderr, 'it does not repeat', f'{done.returncode}: {done.stderr}')


# One turn; tables of couplings over it.
TURNED = np.linspace(0, 2 * np.pi, 361)
# A quintic spline over steps of h misses sin by about h^6/1000 = 3e-14 (O(h^6) with a small constant), its slopes and curvatures by
# h^5 and h^4 times as small constants: 1e-12 and 1e-10.
NEAR_TABLE = {'q2': 1e-12, 'dq2': 1e-10, 'ddq2': 1e-8}


@pytest.fixture
def write(tmp_path):
    """A function that writes a table of two columns and gives its path."""
    def write(name, x, y):
        np.savetxt(tmp_path / name, np.column_stack([x, y]), fmt='%.17g')
        return tmp_path / name
    return write


@pytest.fixture
def cam(write):
    """The path of a cam's table with a harmonic law."""
    return write('cam.dat', TURNED, 0.01 * (1 - np.cos(TURNED)))


# a cam and its sprung follower
FOLLOWER = """&structure cq=1 /
&pair coordinate=1, links=1,2, kind='revolute', axis=0,0,1 /
&pair coordinate=2, links=1,3, kind='prismatic', axis=0,1,0, point=0,0.1,0 /
&coupling kind='table', coordinates=1,2, file='{cam}' /
&initial coordinate=1, position=0.4, velocity=5 /
&body link=2, mass=1, inertia=0,0,0.05,0,0,0 /
&body link=3, mass=0.5 /
&load kind='coordinate', coordinate=2, stiffness=40, rest=-0.01 /
&gravity acceleration=0,-9.81,0 /
&time end=5, intervals=100 /
&output reactions=.true. /
"""


def test_cam_by_a_table(checks, mech9k, cam):
    """Several turns of the cam, from before its table to beyond it."""
    text = TWO_WHEELS.format(unit='rad', second='prismatic', axis='0,1,0', words=f"kind='table', file='{cam}'", first=-9, other=0)
    found = table(mech9k, text.replace('-9,2,0.5', '-9,20,0.5'), '--set', 'time.intervals=50')
    q, dq, ddq = found['q1'], found['dq1'], found['ddq1']
    true = {'q2': 0.01 * (1 - np.cos(q)), 'dq2': 0.01 * np.sin(q) * dq,
            'ddq2': 0.01 * (np.cos(q) * dq ** 2 + np.sin(q) * ddq)}
    for name, values in true.items():
        checks.near(found[name], values, NEAR_TABLE[name], f'cam by a table: {name}')


def test_gear_that_is_not_round(checks, mech9k, write):
    """A wheel that turns twice as far as the first one, unevenly, in degrees."""
    turn = TURNED
    wheel = write('wheel.dat', np.degrees(turn), np.degrees(2 * turn + 0.3 * np.sin(turn)))
    text = TWO_WHEELS.format(unit='deg', second='revolute', axis='0,0,1', words=f"kind='table', file='{wheel}'", first=700, other=1400)
    found = table(mech9k, text.replace('700,2,', '700,200,'), '--set', 'time.intervals=20')
    q = np.radians(found['q1'])
    checks.near(np.radians(found['q2']), 2 * q + 0.3 * np.sin(q), 1e-11, 'a gear that is not round')
    checks.near(np.radians(found['dq2']), (2 + 0.3 * np.cos(q)) * np.radians(found['dq1']), 1e-9, 'its rate')


def test_flywheel_with_a_cam(checks, mech9d, cam):
    """A flywheel drives a sprung follower with mass through the cam: energy, and the law of the follower."""
    text = FOLLOWER.format(cam=cam)
    found = table(mech9d, text + TIGHT)
    q, dq, ddq = found['q1'], found['dq1'], found['ddq1']
    energy = found['E.total']
    checks.near(energy, np.full_like(energy, energy[0]), NEAR, 'the energy of a cam and its follower stays')
    checks.true(np.ptp(q) > 2 * np.pi, 'the cam turns more than once', str(np.ptp(q)))
    checks.near(found['q2'], 0.01 * (1 - np.cos(q)), 1e-12, 'the follower keeps its law in dynamics')
    # Newton's law of the follower: its acceleration by closed form, the forces of spring and weight, and that of the cam
    rise = 0.01 * (np.cos(q) * dq ** 2 + np.sin(q) * ddq)
    checks.near(found['C1'], 0.5 * rise + 0.5 * 9.81 + 40 * (found['q2'] + 0.01), 1e-8, 'the force of the cam on its follower')
    other = table(mech9d, text.replace('cq=1', 'cq=2').replace(
        '&initial coordinate=1, position=0.4, velocity=5 /',
        f'&initial coordinate=2, position={float(0.01 * (1 - np.cos(0.4)))!r}, velocity={float(0.05 * np.sin(0.4))!r} /\n'
        '&initial coordinate=1, position=0.4 /') + TIGHT)
    checks.near(other['q1'], q, 1e-7, 'the follower as the independent coordinate: through its dead points')


def test_cam_held_by_a_torque(checks, mech9d, cam):
    """A torque holds the cam on its slope: V'' = S'' f + S'^2 k and M = J + m S'^2, with the force f of spring and weight."""
    text = FOLLOWER.format(cam=cam)
    rest = text.replace('velocity=5', 'velocity=0') + "&load kind='coordinate', coordinate=1, force=0.02 /\n"
    modes = table(mech9d, rest, '--modes')
    q = table(mech9d, rest, '--equilibrium')['q1'][0]
    slope, bend = 0.01 * np.sin(q), 0.01 * np.cos(q)
    force = 40 * (0.02 - 0.01 * np.cos(q)) + 0.5 * 9.81
    checks.near(slope * force, 0.02, 1e-12, 'the torque holds the cam')
    checks.near(modes['eigenvalue.im'][0] ** 2, (bend * force + 40 * slope ** 2) / (0.05 + 0.5 * slope ** 2), 1e-8,
                'the frequency of the cam about its place of rest')


@pytest.mark.parametrize('name, x, y, words', [
    ('jump.dat', TURNED, 0.1 * TURNED, 'would jump'), ('back.dat', -TURNED, TURNED, 'q1 must increase')], ids=['jump', 'back'])
def test_tables_that_are_refused(checks, mech9k, write, name, x, y, words):
    text = TWO_WHEELS.format(unit='rad', second='prismatic', axis='0,1,0', words=f"kind='table', file='{write(name, x, y)}'",
                             first=0, other=0)
    done = output(mech9k, text)
    checks.true(done.returncode == 3 and words in done.stderr, f'refused: {name}', f'{done.returncode}: {done.stderr}')


def test_table_that_does_not_exist(checks, mech9k):
    text = TWO_WHEELS.format(unit='rad', second='prismatic', axis='0,1,0', words="kind='table', file='missing.dat'", first=0, other=0)
    done = output(mech9k, text)
    checks.true(done.returncode == 8 and 'missing.dat' in done.stderr, 'refused: no file', f'{done.returncode}: {done.stderr}')
