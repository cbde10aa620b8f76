"""Derivatives by parameters through contacts of links: impacts, compliant contacts, sliding and sticking, lifting off, against closed
forms and independent integrations in complex numbers, whose derivatives are exact.

Compares the program with itself: derivatives of mechanisms with several coordinates against differences of runs; exponents and periodic
motions with a contact and with a stop at the same place."""
import cmath
import json

import pytest

from contact_derivative_cases import BILLIARD, FOOT, ROCKER, SKEW, against_complex, first_root, integrate
from event_derivative_cases import BOUNCING, COLUMNS, OSCILLATOR, TIGHT, against_differences, go, kinds

INCLINED = """&structure cq=1,2,3 /
&pair coordinate=1, links=1,2, kind='prismatic', axis=1,0,0 /
&pair coordinate=2, links=2,3, kind='prismatic', axis=0,0,1 /
&pair coordinate=3, links=1,4, kind='prismatic', axis=1,0,0 /
&body link=3, mass=2 /
&gravity acceleration=0,0,-9.81 /
&drive coordinate=3, kind='polynomial', coefficients=0,0.4 /
&point name='C', link=3, position=0.1,0,0.2 /
&contact point='C', link=4, radius=0.3, origin=0.2,0,-0.5, normal=-0.5,0,2, restitution=0.7 /
&initial coordinate=1, position=0.3, velocity=0.6 /
&initial coordinate=2, position=0.9, velocity=0.2 /
&parameter name='x', sets='initial(1).position' /
&parameter name='z', sets='initial(2).position' /
&parameter name='vx', sets='initial(1).velocity' /
&parameter name='g', sets='gravity(1).acceleration(3)' /
&parameter name='V', sets='drive(1).coefficients(2)' /
&parameter name='cx', sets='point(1).position(1)' /
&parameter name='cz', sets='point(1).position(3)' /
&parameter name='r', sets='contact(1).radius' /
&parameter name='ox', sets='contact(1).origin(1)' /
&parameter name='oz', sets='contact(1).origin(3)' /
&parameter name='nx', sets='contact(1).normal(1)' /
&parameter name='nz', sets='contact(1).normal(3)' /
&parameter name='e', sets='contact(1).restitution' /
&parameter name='m', sets='body(1).mass' /
"""
TWO_BALLS = """&structure cq=1,2,3,4 /
&pair coordinate=1, links=1,2, kind='prismatic', axis=1,0,0 /
&pair coordinate=2, links=2,3, kind='prismatic', axis=0,1,0 /
&pair coordinate=3, links=1,4, kind='prismatic', axis=1,0,0 /
&pair coordinate=4, links=4,5, kind='prismatic', axis=0,1,0 /
&body link=3, mass=2 /
&body link=5, mass=3 /
&point name='C', link=3, position=0,0,0 /
&contact point='C', link=5, kind='sphere', radius=0.3, other_radius=0.5, restitution=0.6 /
&initial coordinate=1, position=0, velocity=1 /
&initial coordinate=2, position=0.2, velocity=0.3 /
&initial coordinate=3, position=1.5, velocity=-0.5 /
&initial coordinate=4, position=0.5, velocity=0.1 /
&parameter name='x', sets='initial(1).position' /
&parameter name='y', sets='initial(4).position' /
&parameter name='v', sets='initial(3).velocity' /
&parameter name='m', sets='body(1).mass' /
&parameter name='M', sets='body(2).mass' /
&parameter name='r', sets='contact(1).radius' /
&parameter name='R', sets='contact(1).other_radius' /
&parameter name='e', sets='contact(1).restitution' /
"""
DROP = """&structure cq=1 /
&pair coordinate=1, links=1,2, kind='prismatic', axis=0,0,1 /
&body link=2, mass=2 /
&gravity acceleration=0,0,-9.81 /
&point name='C', link=2, position=0,0,0 /
&contact point='C', radius=0.1, stiffness=8000, damping=3000, exponent=1.5 /
&initial coordinate=1, position=0.5 /
&parameter name='h', sets='initial(1).position' /
&parameter name='m', sets='body(1).mass' /
&parameter name='r', sets='contact(1).radius' /
&parameter name='k', sets='contact(1).stiffness' /
&parameter name='c', sets='contact(1).damping' /
&parameter name='n', sets='contact(1).exponent' /
"""
HILL = """&structure cq=1,2 /
&pair coordinate=1, links=1,2, kind='prismatic', axis=1,0,0 /
&pair coordinate=2, links=2,3, kind='prismatic', axis=0,0,1 /
&body link=3, mass=2 /
&gravity acceleration=0,0,-9.81 /
&point name='C', link=3, position=0,0,0 /
&contact point='C', kind='sphere', radius=0.2, other_radius=0.8 /
&initial coordinate=1, position=0.2 /
&initial coordinate=2, position=1.1 /
&parameter name='x', sets='initial(1).position' /
&parameter name='z', sets='initial(2).position' /
&parameter name='r', sets='contact(1).radius' /
&parameter name='R', sets='contact(1).other_radius' /
&parameter name='g', sets='gravity(1).acceleration(3)' /
&parameter name='m', sets='body(1).mass' /
"""


def inclined(end, x, z, vx, g, V, cx, cz, r, ox, oz, nx, nz, e, m):
    """A ball that bounces on an inclined plane, which moves at a constant rate; m does not matter."""
    del m
    length = cmath.sqrt(nx * nx + nz * nz)
    nx, nz = nx / length, nz / length
    vz, t = 0.2, 0
    while True:
        gap = (x + cx - ox - V * t) * nx + (z + cz - oz) * nz - r
        rate = (vx - V) * nx + vz * nz
        s = first_root(g * nz / 2, rate, gap)
        last = s is None or (t + s).real >= end
        s = end - t if last else s
        x, z, vz, t = x + vx * s, z + vz * s + g * s * s / 2, vz + g * s, t + s
        if last:
            return x, vx, z, vz
        rate = (vx - V) * nx + vz * nz
        vx, vz = vx - (1 + e) * rate * nx, vz - (1 + e) * rate * nz


@pytest.mark.parametrize('end, impacts', [(1.0, 1), (1.5, 2), (2.2, 4)])
def test_a_ball_on_an_inclined_plane_that_moves(checks, mech9d, tmp_path, end, impacts):
    """By its start, gravity, the rate of the plane, the place of its centre on the link, its radius, the plane and the restitution."""
    at = {'x': 0.3, 'z': 0.9, 'vx': 0.6, 'g': -9.81, 'V': 0.4, 'cx': 0.1, 'cz': 0.2, 'r': 0.3, 'ox': 0.2, 'oz': -0.5, 'nx': -0.5, 'nz': 2,
          'e': 0.7, 'm': 2}
    # tolerance: that of the integration, 1e-12, times the slopes of the motion over several impacts
    report = against_complex(checks, mech9d, tmp_path, INCLINED, inclined, at, end, 2e-9)
    checks.equal([event['kind'] for event in report['events']], ['impact'] * impacts, 'impacts alone')


def two_balls(end, x, y, v, m, M, r, R, e):
    """Two balls that meet once, without gravity."""
    p, q, u, w = [x, 0.2], [1.5, y], [1, 0.3], [v, 0.1]
    d, c = [p[i] - q[i] for i in (0, 1)], [u[i] - w[i] for i in (0, 1)]
    t = first_root(c[0]**2 + c[1]**2, 2 * (d[0] * c[0] + d[1] * c[1]), d[0]**2 + d[1]**2 - (r + R)**2)
    n = [(d[i] + c[i] * t) / (r + R) for i in (0, 1)]
    push = -(1 + e) * (n[0] * c[0] + n[1] * c[1]) / (1 / m + 1 / M)
    values = []
    for place, rate, mass, sign, i in ((p, u, m, 1, 0), (p, u, m, 1, 1), (q, w, M, -1, 0), (q, w, M, -1, 1)):
        behind = rate[i] + sign * push * n[i] / mass
        values += [place[i] + rate[i] * t + behind * (end - t), behind]
    return values


def test_two_balls_that_meet(checks, mech9d, tmp_path):
    """By places, rates, masses, radii and the restitution: both links move."""
    at = {'x': 0, 'y': 0.5, 'v': -0.5, 'm': 2, 'M': 3, 'r': 0.3, 'R': 0.5, 'e': 0.6}
    against_complex(checks, mech9d, tmp_path, TWO_BALLS, two_balls, at, 1.3, 1e-10, ('q1', 'dq1', 'q2', 'dq2', 'q3', 'dq3', 'q4', 'dq4'))


def drop(end, h, m, r, k, c, n):
    """A ball that falls on a compliant floor, and rebounds."""
    g = 9.81
    t = cmath.sqrt(2 * (h - r) / g)

    def rates(state):
        depth = r - state[0]
        force = depth**n * (k - c * state[1]) if complex(depth).real > 0 else 0
        return [state[1], force / m - g]

    state, left = integrate(rates, lambda s: r - s[0] + (1 if s[1].real < 0 else 0), [r, -g * t], end - t, 1e-5)
    return state[0] + state[1] * left - g * left**2 / 2, state[1] - g * left


@pytest.mark.parametrize('end', [0.3, 0.35])
def test_a_compliant_floor(checks, mech9d, tmp_path, end):
    """The force of Hunt and Crossley while it presses, and behind it: by the height, the mass, the radius and the numbers of the contact."""
    at = {'h': 0.5, 'm': 2, 'r': 0.1, 'k': 8000, 'c': 3000, 'n': 1.5}
    # tolerance: the power 1.5 limits the independent integration, whose steps are 1e-5 s
    report = against_complex(checks, mech9d, tmp_path, DROP, drop, at, end, 1e-7, ('q1', 'dq1'))
    checks.equal(report['events'][0]['kind'], 'close', 'it is met')


def hill(end, x, z, r, R, g, m):
    """A ball that falls on a sphere without rebound, slides down without friction and lifts off; m does not matter."""
    del m
    length = r + R
    turn = cmath.asin(x / length)
    t = cmath.sqrt(2 * (z - length * cmath.cos(turn)) / -g)
    state, left = integrate(lambda s: [s[1], -g / length * cmath.sin(s[0])], lambda s: -g * cmath.cos(s[0]) - length * s[1]**2,
                            [turn, -g * t * cmath.sin(turn) / length], end - t, 1e-4)
    angle, rate = state
    vx, vz = length * rate * cmath.cos(angle), -length * rate * cmath.sin(angle)
    return (length * cmath.sin(angle) + vx * left, vx, length * cmath.cos(angle) + vz * left + g * left**2 / 2, vz + g * left)


@pytest.mark.parametrize('end, found', [(0.4, ['impact', 'close']), (0.9, ['impact', 'close', 'lift'])])
def test_a_ball_that_slides_down_a_sphere(checks, mech9d, tmp_path, end, found):
    """A closed contact, from its impact to its lifting off, by the start, both radii and gravity."""
    at = {'x': 0.2, 'z': 1.1, 'r': 0.2, 'R': 0.8, 'g': -9.81, 'm': 2}
    # tolerance: that of the integration over an impact without rebound, behind which errors of rates grow
    report = against_complex(checks, mech9d, tmp_path, HILL, hill, at, end, 3e-8)
    checks.equal([event['kind'] for event in report['events']], found, 'the events of the case')


#: A cam that turns freely, and a follower with a roller, which a spring presses onto it.
CAM = """&structure cq=1,2 /
&pair coordinate=1, links=1,2, kind='revolute', axis=0,0,1 /
&pair coordinate=2, links=1,3, kind='prismatic', axis=0,1,0 /
&body link=2, mass=1, inertia=0,0,0.004,0,0,0 /
&body link=3, mass=0.3 /
&load kind='coordinate', coordinate=2, stiffness=400 /
&point name='T', link=3, position=0.01,0,0 /
&contact point='T', link=2, kind='path', file='cam.dat', radius=0.02 /
&initial coordinate=1, position=0, velocity=6 /
&initial coordinate=2, position=0.15 /
&parameter name='m', sets='body(2).mass' /
&parameter name='k', sets='load(1).stiffness' /
&parameter name='r', sets='contact(1).radius' /
&parameter name='px', sets='point(1).position(1)' /
&parameter name='w', sets='initial(1).velocity' /
&parameter name='ox', sets='contact(1).origin(1)' /
"""


def with_cam(folder, text):
    """Write the path of a smooth cam, and give the text of the data file."""
    turns = [cmath.rect(1, 2 * cmath.pi * i / 40) for i in range(40)] + [1]
    places = [z * (0.1 + 0.012 * (z * z).real + 0.015 * z.real) for z in turns]
    (folder / 'cam.dat').write_text(''.join(f'{complex(z).real!r} {complex(z).imag!r}\n' for z in places))
    return text.replace('contact point', "contact origin=0,0,0, point")


@pytest.mark.parametrize('case, text, columns, end, found', [
    ('impacts', ROCKER, ('q1', 'dq1', 'q4', 'dq4'), 0.7, ('impact', 1)),
    ('rest', ROCKER.replace('restitution=0.7', 'restitution=0.3'), ('q1', 'dq1', 'q4', 'dq4', 'ddq1', 'R4.fx', 'R1.fy'), 1.0, ('close', 1)),
    ('compliant', ROCKER.replace('restitution=0.7', 'stiffness=2e4, damping=50, exponent=1.5').replace(
        "&parameter name='e', sets='contact(1).restitution' /", "&parameter name='n', sets='contact(1).exponent' /"),
     ('q1', 'dq1', 'q4', 'dq4', 'R4.fx', 'E.potential'), 0.7, ('close', 1)),
    ('skew', SKEW, ('q1', 'dq1', 'q2', 'dq2', 'q3', 'dq3'), 0.6, ('impact', 1)),
    ('skew rest', SKEW.replace('restitution=0.3', 'restitution=0'), ('q1', 'dq1', 'q2', 'dq2', 'q3', 'dq3', 'R1.mz', 'R3.fx'), 0.6,
     ('close', 1)),
    ('cam', CAM, ('q1', 'dq1', 'q2', 'dq2'), 0.5, ('close', 1))], ids=['impacts', 'rest', 'compliant', 'skew', 'skew rest', 'cam'])
def test_several_coordinates(checks, mech9d, tmp_path, case, text, columns, end, found):
    """A rocker of a closed chain that bounces and rests on a ball, rigid and compliant; a double pendulum in space on a plane that swings;
    a cam with its follower."""
    output = COLUMNS
    if any(name[0] in 'RE' for name in columns):
        output = COLUMNS.replace(' /', ', energies=.true., drive_forces=.true., reactions=.true. /')
    if case == 'cam':
        text = with_cam(tmp_path, text)
    report = against_differences(checks, mech9d, tmp_path, text, columns, end, 6, output)
    checks.true(found in kinds(report), 'the event of the case', kinds(report))


def billiard(end, v, w, m, mu, g):
    """A ball that slides straight against its friction, and then rolls."""
    r, inertia = 0.2, 0.032
    slip = [v, 0.1 + r * w]
    size = cmath.sqrt(slip[0]**2 + slip[1]**2)
    at_rest = size / (-mu * g * (1 + m * r * r / inertia))
    t = end if at_rest.real > end else at_rest
    values = []
    for rate, part in ((v, slip[0] / size), (0.1, slip[1] / size)):
        after = rate + mu * g * t * part
        values += [rate * t + mu * g * t * t / 2 * part + after * (end - t), after]
    return values


@pytest.mark.parametrize('end, sticks', [(0.1, False), (0.3, True)])
def test_a_ball_that_slides_and_rolls(checks, mech9d, tmp_path, end, sticks):
    """Friction in space: by rates at the start, the mass, the coefficient and gravity."""
    at = {'v': 1, 'w': 1, 'm': 2, 'mu': 0.2, 'g': -9.81}
    # tolerance: the time of rest is that of dense output, by which the friction jumps
    report = against_complex(checks, mech9d, tmp_path, BILLIARD, billiard, at, end, 1e-7)
    checks.true((('stick', 1) in kinds(report)) == sticks, 'it rolls in the end', kinds(report))


@pytest.mark.parametrize('text, columns, end, found', [
    (FOOT, ('q1', 'dq1', 'q2', 'q3', 'dq3', 'R1.fz', 'R3.fx'), 1.0, ('slip', 1))], ids=['foot'])
def test_friction_in_contacts(checks, mech9d, tmp_path, text, columns, end, found):
    """A foot that slides, sticks and slides back."""
    output = COLUMNS.replace(' /', ', reactions=.true. /')
    report = against_differences(checks, mech9d, tmp_path, text, columns, end, 6, output)
    checks.true(found in kinds(report), 'the event of the case', kinds(report))


@pytest.mark.parametrize('text, stop, contact, words, found', ids=['exponents', 'lost', 'periodic'], argvalues=[
    (OSCILLATOR, '&stop coordinate=1, low=0, restitution=0.8 /', 'normal=1,0,0, restitution=0.8',
     ('&exponents transient=100 /\n', 300.0, '--exponents', '2'), lambda report: report['exponents'] + [report['divergence']]),
    (BOUNCING, '&stop coordinate=1, low=0, restitution=0.9 /', 'restitution=0.9',
     ('&exponents transient=1 /\n', 12.0, '--exponents', '2'), lambda report: report['exponents']),
    (OSCILLATOR, '&stop coordinate=1, low=0, restitution=0.8 /', 'normal=1,0,0, restitution=0.8',
     ('&periodic starts=3 /\n', 1.0, '--periodic'), lambda report: sum(report['periodic_motions'][0]['multipliers'], []))])
def test_a_contact_in_place_of_a_stop(checks, mech9d, tmp_path, text, stop, contact, words, found):
    """Exponents through impacts, those of minus infinity where a contact closes, and a periodic motion: as with a stop."""
    settings, end, *options = words
    plain = '\n'.join(line for line in text.splitlines() if 'parameter' not in line) + '\n'
    reports = []
    for case in (plain, plain.replace(stop, f"&point name='P', link=2, position=0,0,0 /\n&contact point='P', {contact} /")):
        go(mech9d, tmp_path, case + TIGHT + settings, *options, end=end)
        reports.append(found(json.loads((tmp_path / 'event.json').read_text())))
    if None in reports[0]:
        checks.equal(reports[1], reports[0], 'the same are lost')
    else:
        # tolerance: that of the integration, in which both differ by round-off alone
        checks.near(reports[1], reports[0], 1e-9, 'the same numbers', scale=1)


@pytest.mark.parametrize('change, code, words', [
    (("&parameter name='x'", "&contact point='C', link=4, radius=0.3, origin=0.2,0,-0.5, normal=-0.5,0,2 /\n&parameter name='x'"), 6,
     'contact 1 is hit together with another stop or contact'),
    (('position=0.9, velocity=0.2', 'position=-0.34076707807867545, velocity=-0.2'), 6, 'and parameters move it away or behind')], ids=['two', 'start'])
def test_refusals(checks, mech9d, tmp_path, change, code, words):
    """Two impacts at once, and a start on a contact."""
    text = INCLINED.replace(*change, 1)
    if code == 6:
        text = '\n'.join(line for line in text.splitlines() if "'e'" not in line) + '\n'
    _, _, told = go(mech9d, tmp_path, text + COLUMNS, code=code)
    checks.true(words in told, words, told)


def test_the_scale_of_a_path(checks, mech9d, tmp_path):
    """A parameter that sets the scale of a path is refused by its name."""
    text = with_cam(tmp_path, CAM).replace("file='cam.dat'", "file='cam.dat', scale=1") + "&parameter name='s', sets='contact(1).scale' /\n"
    _, _, told = go(mech9d, tmp_path, text + COLUMNS, code=3)
    checks.true("derivatives by the parameter 's' are not computed" in told, 'it is named', told)
