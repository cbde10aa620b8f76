"""Forces in the pairs of mechanisms with couplings: against Newton's law on the follower, and derivatives against their closed forms.

Loads and forces of couplings on one coordinate may cancel each other; what is left is their round-off, and no singular position.
"""
import math

from mech9_cases import run, table_of

MASS, STIFFNESS, REST = 0.2, 2000.0, -0.01
# a cam with its return spring, after docs/how-to/couplings.md; the follower slides along y
CAM = f"""
&mechanism angle_unit='deg' /
&structure cq=1 /
&pair coordinate=1, links=1,2, kind='revolute', axis=0,0,1 /
&pair coordinate=2, links=1,3, kind='prismatic', axis=0,1,0, point=0.008,0.04,0, moving_point=0,0,0 /
&coupling kind='table', coordinates=1,2, file='cam.dat' /
&drive coordinate=1, kind='polynomial', coefficients=0, 360 /
&body link=3, mass={MASS}, centre=0,0,0 /
&load kind='coordinate', coordinate=2, stiffness={STIFFNESS}, rest={REST} /
&time end=1, intervals=36 /
"""
# the forces are sums of some terms of the size of the spring's force, each with a round-off of 1e-16 of it
ROUND_OFF = 1e-14


def write(folder, text, more=''):
    with open(folder / 'cam.dat', 'w', encoding='utf-8') as file:
        for degree in range(361):
            file.write(f'{degree} {0.01 * (1 - math.cos(math.radians(degree)))!r}\n')
    path = folder / 'case.nml'
    path.write_text(text + more, encoding='utf-8')
    return path


def check_follower(checks, table, name):
    """The coupling carries the inertia of the follower and the spring; the guide passes on what moves the mass alone."""
    spring = STIFFNESS * (table['q2'] - REST)
    inertia = MASS * table['ddq2']
    size = abs(spring).max() + abs(inertia).max()
    checks.near(table['C1'], spring + inertia, ROUND_OFF, f'{name}: force of the coupling', scale=size)
    checks.near(table['R2.fy'], inertia, ROUND_OFF, f'{name}: force in the guide', scale=size)


def test_cam_with_return_spring_where_its_follower_has_no_acceleration(checks, mech9k, tmp_path):
    # with 36 intervals, rows stand where the acceleration passes zero, at 90 and 270 degrees
    table = table_of(mech9k, write(tmp_path, CAM, "&output reactions=.true. /\n"))
    checks.equal(len(table['t']), 37, 'all rows are there')
    checks.true(min(abs(table['ddq2'])) < 1e-6 * max(abs(table['ddq2'])), 'the acceleration passes zero in a row')
    check_follower(checks, table, 'cam')


def test_rack_that_never_accelerates(checks, mech9k, tmp_path):
    text = CAM.replace("kind='table', coordinates=1,2, file='cam.dat'", "kind='rack', coordinates=1,2, radius=0.0137")
    table = table_of(mech9k, write(tmp_path, text, "&output reactions=.true. /\n"))
    checks.equal(len(table['t']), 37, 'all rows are there')
    check_follower(checks, table, 'rack')


def test_two_couplings_that_cancel_each_other_on_one_coordinate(checks, mech9k, tmp_path):
    # the spring on the third slide acts through the second one, whose own mass is not accelerated
    text = f"""
&structure cq=1 /
&pair coordinate=1, links=1,2, kind='prismatic', axis=1,0,0 /
&pair coordinate=2, links=1,3, kind='prismatic', axis=0,1,0 /
&pair coordinate=3, links=1,4, kind='prismatic', axis=0,0,1 /
&coupling kind='gear', coordinates=1,2, ratio=0.7 /
&coupling kind='gear', coordinates=2,3, ratio=-1.3 /
&drive coordinate=1, kind='polynomial', coefficients=0.1, 0.37 /
&body link=3, mass=1 /
&body link=4, mass=1 /
&load kind='coordinate', coordinate=3, stiffness={STIFFNESS} /
&output reactions=.true. /
&time end=1, intervals=50 /
"""
    table = table_of(mech9k, write(tmp_path, text))
    force = STIFFNESS * table['q3']
    size = abs(force).max()
    checks.equal(len(table['t']), 51, 'all rows are there')
    checks.near(table['C2'], force, ROUND_OFF, 'the second coupling carries the spring', scale=size)
    checks.near(table['C1'], -1.3 * force, ROUND_OFF, 'the first one carries it by its ratio', scale=size)
    checks.near(table['R2.fy'], 0 * force, ROUND_OFF, 'the slide between requires nothing', scale=size)


def test_derivatives_of_the_forces_of_a_cam(checks, mech9k, tmp_path):
    more = """&parameter name='mass', sets='body(1).mass' /
&parameter name='stiffness', sets='load(1).stiffness' /
&output reactions=.true., sensitivities=.true. /
"""
    table = table_of(mech9k, write(tmp_path, CAM, more))
    checks.equal(len(table['t']), 37, 'all rows are there')
    lift = abs(table['q2'] - REST).max()
    checks.near(table['d(C1)/d(stiffness)'], table['q2'] - REST, ROUND_OFF, 'the spring is linear', scale=lift)
    # the numbers of dynamics are differentiated by differences, which lose two digits
    checks.near(table['d(C1)/d(mass)'], table['ddq2'], 1e-12, 'the inertia is linear', scale=STIFFNESS * lift / MASS)
    checks.near(table['d(R2.fy)/d(mass)'], table['ddq2'], 1e-12, 'the guide passes it on', scale=STIFFNESS * lift / MASS)
    checks.near(table['d(R2.fy)/d(stiffness)'], 0 * lift, ROUND_OFF, 'it passes on no part of the spring', scale=lift)


def test_a_position_that_is_singular_is_refused(checks, mech9k, tmp_path):
    # a slider-crank in its dead point, whose crank is dragged by a coupled slide
    text = """
&structure cq=4 /
&pair coordinate=1, links=1,2, kind='revolute', axis=0,0,1 /
&pair coordinate=2, links=2,3, kind='revolute', axis=0,0,1, point=0.1,0,0, moving_point=0,0,0 /
&pair coordinate=3, links=3,4, kind='revolute', axis=0,0,1, point=0.3,0,0, moving_point=0,0,0 /
&pair coordinate=4, links=1,4, kind='prismatic', axis=1,0,0 /
&pair coordinate=5, links=1,5, kind='prismatic', axis=0,1,0 /
&coupling kind='gear', coordinates=4,5, ratio=1 /
&initial coordinate=1, position=0.3 /
&initial coordinate=2, position=-0.4 /
&initial coordinate=3, position=0.1 /
&body link=3, mass=0.5, centre=0.15,0.1,0, inertia=0.01,0.01,0.01,0,0,0 /
&drive coordinate=4, kind='polynomial', coefficients=0.38, 0.02 /
&gravity acceleration=0,-9.81,0 /
&output reactions=.true. /
&time end=1, intervals=10 /
"""
    done = run(mech9k, write(tmp_path, text), '--no-write', folder=tmp_path)
    checks.equal(done.returncode, 6, 'the dead point is a singular position')
