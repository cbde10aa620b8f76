"""Positions of rest on rigid contacts without friction, their forces, vibrations and linearised equations, against closed forms."""
import re
from math import cos, hypot, pi, radians, sin, sqrt, tan

import numpy as np
import pytest

from mech9_cases import read_table, run

G = 9.81
BALL = """&structure cq=1,2,3,4,5,6 /
&pair coordinates=1,2,3,4,5,6, links=1,2, kind='free' /
&body link=2, mass=2, inertia=0.004,0.004,0.004,0,0,0 /
&point name='C', link=2, position=0,0,0 /
&gravity acceleration=0,0,-9.81 /
"""
# a box of 0.4 by 0.2 m in the plane of x and z, with points at its lower corners
BOX = """&structure cq=1,2,3 /
&pair coordinates=1,2,3, links=1,2, kind='planar', axis=0,-1,0, zero=1,0,0 /
&body link=2, mass=2, inertia=0.1,0.1,0.1,0,0,0 /
&point name='A', link=2, position=-0.2,0,-0.1 /
&point name='B', link=2, position=0.2,0,-0.1 /
&gravity acceleration=0,0,-9.81 /
"""
# positions are known to 1e-11 and better, forces and roots follow from them
FINE = 1e-10


def at(*positions):
    return ''.join(f'&initial coordinate={i}, position={q!r} /\n' for i, q in enumerate(positions, 1))


def circle(folder, radius, name='bowl.dat', points=720):
    """A file with a circle, whose smooth curve differs from it by less than 1e-12 of the radius."""
    turn = 2*pi*np.arange(points + 1)/points
    np.savetxt(folder/name, radius*np.column_stack([np.cos(turn), np.sin(turn)]), fmt='%.17g')
    return f"kind='path', file='{name}', axis=0,-1,0, zero=1,0,0"


def ask(mech9d, folder, data, *options, code=0):
    (folder/'rest.nml').write_text(data, encoding='utf-8')
    done = run(mech9d, 'rest.nml', *options, folder=folder)
    assert done.returncode == code, done.stderr
    return (read_table(done.stdout) if done.stdout else None), done.stderr


def roots(mech9d, folder, data):
    modes, _ = ask(mech9d, folder, data, '--modes')
    return modes['eigenvalue.re'] + 1j*modes['eigenvalue.im']


def test_a_ball_in_a_groove(checks, mech9d, tmp_path):
    """Two planes with the normals (1, 1)/sqrt 2 and (-1, sqrt 3)/2 touch it; both forces bear the weight."""
    rest, said = ask(mech9d, tmp_path, BALL + at(0.03, 0, 0.5, 0, 0, 0) + "&contact point='C', radius=0.1, normal=1,0,1 /\n"
                     "&contact point='C', radius=0.1, normal=-1,0,1.7320508075688772 /\n", '--equilibrium')
    normals = np.array([[sqrt(0.5), sqrt(0.5)], [-0.5, sqrt(0.75)]])
    place, forces = np.linalg.solve(normals, [0.1, 0.1]), np.linalg.solve(normals.T, [0, 2*G])
    checks.near([rest['q1'][0], rest['q3'][0]], place, FINE, 'it touches both planes')
    checks.near([rest['K1.fn'][0], rest['K2.fn'][0]], forces, FINE, 'both forces')
    checks.near([rest['K1.gap'][0], rest['K2.gap'][0], rest['K1.ft'][0]], [0, 0, 0], 1e-13, 'gaps and friction')
    checks.near([rest['stable'][0], rest['growth'][0]], [1, 0], 0.0, 'nothing grows')
    checks.true('contact 2 bears' in said, 'the contacts are named')


def test_a_ball_upon_balls(checks, mech9d, tmp_path):
    """Upon one ball it falls as a pendulum of the length R + r upside down, upon two across both, by their height."""
    one = roots(mech9d, tmp_path, BALL + at(0, 0, 0.3, 0, 0, 0) + "&contact point='C', radius=0.1, kind='sphere', other_radius=0.2 /\n")
    checks.near(sorted(one.real), [-sqrt(G/0.3)]*2 + [0]*3 + [sqrt(G/0.3)]*2, FINE, 'upon one')
    height = sqrt(0.2**2 - 0.15**2)
    spheres = ''.join(f"&contact point='C', radius=0.1, kind='sphere', origin={x},0,0, other_radius=0.1 /\n" for x in (-0.15, 0.15))
    two = roots(mech9d, tmp_path, BALL + at(0, 0.001, height + 0.0001, 0, 0, 0) + spheres)
    checks.near(sorted(two.real), [-sqrt(G/height)] + [0]*3 + [sqrt(G/height)], FINE, 'upon two')


def test_a_ball_in_a_bowl(checks, mech9d, tmp_path):
    """Without friction it does not roll: sqrt(g/(R - r)). A bowl on a spring moves with it."""
    bowl = circle(tmp_path, 0.5) + ", side='inside'"
    still = roots(mech9d, tmp_path, BALL + at(0.05, 0, -0.3, 0, 0, 0) + f"&contact point='C', radius=0.1, {bowl} /\n")
    checks.near(sorted(still.imag), [0]*4 + [sqrt(G/0.4)], 1e-9, 'a bowl at rest')
    ask(mech9d, tmp_path, (tmp_path/'rest.nml').read_text(), '--modes', '--mode', '5', '--animate', 'film.html')
    poses = re.search(r'poses: (\[.*?\]),?\s*\]', (tmp_path/'film.html').read_text(), re.S)[1]
    places = np.array([[float(number) for number in row.strip('[], \n').split(',')[:21]] for row in poses.split('],')])
    x, z, top = places[:, 14] - (places[:, 14].max() + places[:, 14].min())/2, places[:, 16], places[0, 2]
    checks.near(np.hypot(x, z - top), [top - z.min()]*len(x), 1e-3, 'in a film, whose numbers are whole, the ball stays in the bowl',
                scale=top - z.min())
    checks.true(np.ptp(x) > 0.1*(top - z.min()), 'where it swings')
    cart = BALL.replace('cq=1,2,3,4,5,6', 'cq=1,2,3,4') + at(0.05, -0.3, 0, 0.02)
    cart = cart.replace("&pair coordinates=1,2,3,4,5,6, links=1,2, kind='free' /", """&pair coordinates=1,2,3, links=1,2, kind='planar', axis=0,-1,0, zero=1,0,0 /
&pair coordinate=4, links=1,3, kind='prismatic', axis=1,0,0 /
&body link=3, mass=5 /
&load kind='coordinate', coordinate=4, stiffness=300 /""")
    found = roots(mech9d, tmp_path, cart + f"&contact point='C', link=3, radius=0.1, {bowl} /\n")
    # (M + m) x'' + m l a'' + k x = 0 and x'' + l a'' + g a = 0
    mass, stiffness = np.array([[7, 0.8], [1, 0.4]]), np.array([[300, 0], [0, G]])
    checks.near(sorted(found.imag), [0, *sorted(np.sqrt(np.linalg.eigvals(np.linalg.solve(mass, stiffness))))], 1e-9, 'a bowl on a spring')
    checks.near(found.real, [0]*3, 1e-12, 'none grows')


def test_a_box_on_an_incline(checks, mech9d, tmp_path):
    """Two corners touch. A spring along the incline holds it: one vibration with sqrt(k/m) is left."""
    slope = radians(25)
    up = np.array([cos(slope), sin(slope)])
    normal = f'normal={-sin(slope)!r},0,{cos(slope)!r}'
    contacts = f"&contact point='A', {normal} /\n&contact point='B', {normal} /\n"
    anchor = 2*up + 0.1*np.array([-sin(slope), cos(slope)])
    spring = f"&load kind='spring', position={anchor[0]!r},0,{anchor[1]!r}, links=1,2, stiffness=150, free_length=1 /\n"
    data = BOX + at(0.5, 0.5, 0.3) + contacts + spring
    rest, _ = ask(mech9d, tmp_path, data, '--equilibrium')
    stretch = 2*G*sin(slope)/150
    checks.near([rest['q1'][0], rest['q2'][0], rest['q3'][0]], [*(anchor - (1 + stretch)*up), slope], FINE, 'it lies on the incline')
    checks.near([rest['K1.fn'][0], rest['K2.fn'][0]], [G*cos(slope)]*2, FINE, 'each corner bears half')
    found = roots(mech9d, tmp_path, data)
    checks.near([found.real, found.imag], [[0], [sqrt(75)]], FINE, 'the vibration along it')
    h5py = pytest.importorskip('h5py')
    ask(mech9d, tmp_path, data, '--linear', 'linear.h5')
    with h5py.File(tmp_path/'linear.h5') as file:
        a, c = file['state_space/A'][()], file['state_space/C'][()]
        rows = {name.decode(): c[i] for i, name in enumerate(file['state_space/output'][()])}
        m = file['second_order/M'][()]
    checks.near(a, [[0, 1], [-75, 0]], FINE, 'its state: the first coordinate')
    checks.near(m, [[2/cos(slope)**2]], FINE, 'its inertia, for motions along the incline')
    checks.near([rows['q2'], rows['dq2'], rows['q3']], [[tan(slope), 0], [0, tan(slope)], [0, 0]], FINE, 'other coordinates follow it')


def test_a_box_against_a_stop(checks, mech9d, tmp_path):
    """On the incline a stop holds x: it bears m g tan, the corners m g/cos together."""
    slope = radians(25)
    normal = f'normal={-sin(slope)!r},0,{cos(slope)!r}'
    data = BOX + at(0.5, 0.5, 0.3) + f"&contact point='A', {normal} /\n&contact point='B', {normal} /\n&stop coordinate=1, low=0.1 /\n"
    rest, said = ask(mech9d, tmp_path, data, '--equilibrium')
    checks.near(rest['S1'][0], 2*G*tan(slope), FINE, 'the stop')
    checks.near(rest['K1.fn'][0] + rest['K2.fn'][0], 2*G/cos(slope), FINE, 'the corners')
    checks.true('stops and contacts hold all coordinates' in said, 'nothing is free')


def test_a_plank_on_a_ball(checks, mech9d, tmp_path):
    """A hinged plank leans on a fixed ball; its surface is that of the moving link."""
    data = f"""&structure cq=1 /
&pair coordinate=1, links=1,2, kind='revolute', axis=0,-1,0 /
&body link=2, mass=3, centre=0.8,0,0, inertia=0.1,0.1,0.1,0,0,0 /
&gravity acceleration=0,0,-9.81 /
&point name='O', link=1, position=0.5,0,0 /
&contact point='O', link=2, radius=0.1, normal=0,0,-1 /
&output reactions=.true. /
{at(1.0)}"""
    rest, said = ask(mech9d, tmp_path, data, '--equilibrium')
    angle, lever = np.arcsin(0.2), sqrt(0.25 - 0.01)
    force = 3*G*0.8*cos(angle)/lever
    checks.near([rest['q1'][0], rest['K1.fn'][0]], [angle, force], FINE, 'angle and force')
    checks.near([rest['R1.fx'][0], rest['R1.fz'][0]], [force*sin(angle), 3*G - force*cos(angle)], FINE, 'the hinge bears the rest')
    checks.true('contacts hold all coordinates' in said, 'nothing is free')


@pytest.mark.parametrize('x, y', [(0, 0), (0.05, -0.03)])
def test_a_table(checks, mech9d, tmp_path, x, y):
    """Four legs are one too many: the table shows the forces of least size, linear over the plane."""
    legs = [(0.4, 0.3), (-0.4, 0.3), (-0.4, -0.3), (0.4, -0.3)]
    data = BALL.replace('inertia=0.004,0.004,0.004', f'centre={x},{y},0, inertia=0.1,0.1,0.1') + at(0, 0, 1, 0.02, 0.01, 0)
    for i, (a, b) in enumerate(legs):
        data += f"&point name='L{i}', link=2, position={a},{b},-0.7 /\n&contact point='L{i}' /\n"
    rest, _ = ask(mech9d, tmp_path, data, '--equilibrium')
    checks.near([rest['q3'][0], rest['stable'][0]], [0.7, 1], FINE, 'it stands')
    checks.near([rest[f'K{i}.fn'][0] for i in (1, 2, 3, 4)], [2*G/4*(1 + x*a/0.16 + y*b/0.09) for a, b in legs], 1e-8, 'forces of the legs')
    checks.equal(len(roots(mech9d, tmp_path, data)), 3, 'it slides and turns')
    if x == 0:
        all_rests, _ = ask(mech9d, tmp_path, data, '--equilibrium', '--starts', '3')
        checks.near(abs(all_rests['q3']), [0.7]*4, FINE, 'from all random positions it falls, and stands on its legs or hangs on them')


def test_positions_with_and_without_contact(checks, mech9d, tmp_path):
    """A pendulum beside a wall hangs free, leans against it, or the wall holds it; a weight that falls past all surfaces has no rest."""
    pendulum = f"""&structure cq=1 /
&pair coordinate=1, links=1,2, kind='revolute', axis=0,-1,0 /
&body link=2, mass=1, centre=0,0,-1 /
&point name='P', link=2, position=0,0,-1 /
&gravity acceleration=0,0,-9.81 /
{at(0.5)}"""
    beside = pendulum + "&contact point='P', origin=-0.1,0,0, normal=1,0,0 /\n"
    free, _ = ask(mech9d, tmp_path, beside, '--equilibrium')
    ask(mech9d, tmp_path, beside, '--modes', '--mode', '1', '--animate', 'free.html')
    checks.near([free['q1'][0], free['K1.fn'][0], free['K1.gap'][0]], [0, 0, 0.1], FINE, 'free')
    wall = pendulum + "&contact point='P', origin=0.3,0,0, normal=1,0,0 /\n"
    held, _ = ask(mech9d, tmp_path, wall, '--equilibrium')
    checks.near([sin(held['q1'][0]), held['K1.fn'][0]], [0.3, G*tan(held['q1'][0])], FINE, 'held')
    left = pendulum + "&contact point='P', origin=-0.3,0,0, normal=1,0,0 /\n"
    three, _ = ask(mech9d, tmp_path, left, '--equilibrium', '--starts', '20')
    upright = np.arcsin(0.3)
    order = np.argsort(cos_of := np.cos(three['q1']))
    checks.near(cos_of[order], [-1, -cos(upright), 1], FINE, 'upright, above where it leans against the wall, and below')
    checks.near(three['K1.fn'][order], [0, G*tan(upright), 0], 1e-9, 'the wall')
    checks.near(three['stable'][order], [0, 1, 1], 0.0, 'which are stable')
    _, said = ask(mech9d, tmp_path, BALL + at(0, 0, 1, 0, 0, 0) + "&contact point='C', normal=0,0,-1, origin=0,0,2 /\n", '--equilibrium', code=5)
    checks.true('no position of equilibrium' in said, 'it falls')


ARM = """&structure cq=1,2 /
&pair coordinate=1, links=1,2, kind='revolute', axis=0,-1,0 /
&pair coordinate=2, links=2,3, kind='revolute', axis=0,-1,0, point=1,0,0, moving_point=0,0,0 /
&body link=2, mass=2, centre=0.5,0,0, inertia=0.1,0.1,0.1,0,0,0 /
&body link=3, mass=2, centre=0.5,0,0, inertia=0.1,0.1,0.1,0,0,0 /
&gravity acceleration=0,0,-9.81 /
&point name='T', link=3, position=1,0,0 /
&load kind='coordinate', coordinate=2, stiffness=30, damping=0.5 /
&contact point='T', origin=0,0,-0.5 /
"""


def reduced_arm(a):
    """Of the arm whose tip is at z = -0.5, by the first angle: second angle, force along the first one without the motor, force of the
    plane, and inertia, damping and stiffness along the plane."""
    c = np.arcsin(-0.5 - sin(a))
    c1 = -cos(a)/cos(c)
    c2 = (sin(a) + sin(c)*c1**2)/cos(c)
    b = c - a
    velocity = np.array([-sin(a) - sin(c)*c1/2, cos(a) + cos(c)*c1/2])
    inertia = 0.6 + 0.1*c1**2 + 2*velocity @ velocity
    stiffness = -3*G*sin(a) - G*sin(c)*c1**2 + G*cos(c)*c2 + 30*(c1 - 1)**2 + 30*b*c2
    return b, 3*G*cos(a) + G*cos(c)*c1 + 30*b*(c1 - 1), (G*cos(c) + 30*b)/cos(c), inertia, 0.5*(c1 - 1)**2, stiffness


def test_an_arm_on_the_floor(checks, mech9d, tmp_path):
    """Two links with a spring: the tip slides on the floor, and both angles move on curves. A controller holds the first one."""
    angle = -0.4
    for _ in range(30):
        _, force, _, _, _, stiffness = reduced_arm(angle)
        angle -= force/stiffness
    second, _, press, inertia, damping, stiffness = reduced_arm(angle)
    data = ARM + at(0.3, -1.0)
    rest, _ = ask(mech9d, tmp_path, data, '--equilibrium')
    checks.near([rest['q1'][0], rest['q2'][0], rest['K1.fn'][0]], [angle, second, press], FINE, 'rest')
    expected = np.roots([inertia, damping, stiffness])
    found = roots(mech9d, tmp_path, data)
    checks.near([found[0].real, found[0].imag], [expected[0].real, abs(expected[0].imag)], FINE, 'the vibration', scale=abs(expected[0]))
    _, torque, press, inertia, damping, stiffness = reduced_arm(-0.6)
    data = ARM + at(0.3, 0.8) + "&motor coordinate=1, kind='pid', proportional=200, integral=100, derivative=10, setpoint=-0.6 /\n"
    rest, _ = ask(mech9d, tmp_path, data, '--equilibrium')
    checks.near([rest['M1.torque'][0], rest['K1.fn'][0]], [torque, press], FINE, 'beside a controller')
    expected = np.roots([inertia, damping + 10, stiffness + 200, 100])
    found = roots(mech9d, tmp_path, data)
    checks.near([found[0].real, found[1].real, found[1].imag],
                [expected[2].real, expected[0].real, abs(expected[0].imag)], FINE, 'roots with the integral', scale=abs(expected[0]))


CRADLE = """&structure cq=1,2,3,4 /
&pair coordinate=1, links=1,2, kind='revolute', axis=0,-1,0, point=-0.05,0,0, moving_point=0,0,0 /
&pair coordinate=2, links=2,3, kind='revolute', axis=1,0,0, point=0,0,0, moving_point=0,0,0 /
&pair coordinate=3, links=1,4, kind='revolute', axis=0,-1,0, point=0.05,0,0, moving_point=0,0,0 /
&pair coordinate=4, links=4,5, kind='revolute', axis=1,0,0, point=0,0,0, moving_point=0,0,0 /
&body link=3, mass=1, centre=0,0,-0.5 /
&body link=5, mass=2, centre=0,0,-0.7 /
&gravity acceleration=0,0,-9.81 /
&point name='A', link=3, position=0,0,-0.5 /
&contact point='A', radius=0.12, kind='sphere', link=5, origin=0,0,-0.7, other_radius=0.15 /
"""


def slopes(f, x, h):
    """Derivatives of a function by the numbers of x, differences of sixth order."""
    return np.array([sum(w*(f(x + i*h*e) - f(x - i*h*e)) for i, w in ((1, 45), (2, -9), (3, 1)))/(60*h) for e in np.eye(len(x))])


def test_balls_that_lean_on_each_other(checks, mech9d, tmp_path):
    """Two pendulums in space, against a formulation with a multiplier: stationary V - f g, and its second derivatives along the contact."""
    def places(q):
        return np.array([[x + length*sin(a)*cos(b), length*sin(b), -length*cos(a)*cos(b)]
                         for x, length, a, b in ((-0.05, 0.5, q[0], q[1]), (0.05, 0.7, q[2], q[3]))])

    def energy(q):
        return G*(places(q)[0, 2] + 2*places(q)[1, 2])

    def gap(q):
        return np.linalg.norm(np.subtract(*places(q))) - 0.27

    def pulled(q, force):
        return slopes(lambda p: energy(p) - force*gap(p), q, 1e-3)

    q, force = np.array([-0.1, 0, 0.05, 0]), 1.0
    for _ in range(8):
        row = slopes(gap, q, 1e-3)
        stiffness = slopes(lambda p: pulled(p, force), q, 1e-2)
        step = np.linalg.solve(np.block([[stiffness, -row[:, None]], [row[None], np.zeros((1, 1))]]), [*pulled(q, force), gap(q)])
        q, force = q - step[:4], force - step[4]
    row, velocity = slopes(gap, q, 1e-3), slopes(places, q, 1e-3)
    inertia = np.einsum('ikx,k,jkx->ij', velocity, [1, 2], velocity)
    along = np.linalg.svd(row[None])[2][1:].T
    squares = np.linalg.eigvals(np.linalg.solve(along.T @ inertia @ along, along.T @ slopes(lambda p: pulled(p, force), q, 1e-2) @ along))
    data = CRADLE + at(-0.4, 0, 0.3, 0)
    rest, _ = ask(mech9d, tmp_path, data, '--equilibrium')
    checks.near([rest['q1'][0], rest['q3'][0], rest['K1.fn'][0]], [q[0], q[2], force], 1e-9, 'angles and force')
    checks.near(sorted(roots(mech9d, tmp_path, data).imag), np.sqrt(sorted(squares.real)), 1e-7, 'vibrations; differences twice')


def test_what_is_told_and_refused(checks, mech9d, tmp_path):
    """Friction counts as zero, and this is said; a drive that moves beside a closed contact is refused."""
    rub = BALL + at(0, 0, 1, 0, 0, 0) + "&contact point='C', radius=0.1, friction=0.2 /\n"
    checks.true('friction of contacts counts as 0' in ask(mech9d, tmp_path, rub, '--modes')[1], 'friction')
    drive = BALL.replace('cq=1,2,3,4,5,6', 'cq=1,2,3,4,5,6,7') + at(0, 0, 1, 0, 0, 0) + """&pair coordinate=7, links=1,3, kind='prismatic', axis=1,0,0 /
&drive coordinate=7, kind='polynomial', coefficients=0,1 /
&contact point='C', link=3, radius=0.1 /
"""
    checks.true('contact 1 bears at rest while the drive of coordinate 7 moves' in
                ask(mech9d, tmp_path, drive, '--equilibrium', code=3)[1], 'a moving drive')
