"""Gimbal lock: motions of ball joints through positions in which the angles of the data file are singular.

Integrals of motion, the same motion in another order of turns, a pendulum in one plane, Taylor's series at outputs in gimbal
lock. The run in its own angles, which a load of no consequence enforces, compares the program with itself.
"""
import json
import os

import numpy as np
import pytest

from mech9_cases import read_table, run, text_of

SINGULAR = 6
G, MASS, ARM, ACROSS, ALONG = 9.81, 1.0, 0.1, 0.002, 0.001      # a symmetric top: inertia about its centre
QUARTER = np.pi / 2
X, Y, Z = '1,0,0', '0,1,0', '0,0,1'
STEADY = "&load kind='coordinate', coordinate=1, force=1e-60 /\n"  # moves nothing, and keeps the angles as they are


def turn(axis, angle):
    """Rotations about a coordinate axis, for an array of angles."""
    axis = {X: 0, Y: 1, Z: 2}[axis]
    i, j = (axis + 1) % 3, (axis + 2) % 3
    r = np.zeros((len(angle), 3, 3))
    r[:, axis, axis] = 1.0
    r[:, i, i] = r[:, j, j] = np.cos(angle)
    r[:, j, i] = np.sin(angle)
    r[:, i, j] = -np.sin(angle)
    return r


def motion_of(table, axes):
    """Rotation and angular velocity from the coordinates of the table, in fixed axes."""
    r = np.broadcast_to(np.eye(3), (len(table['t']), 3, 3))
    omega = np.zeros((len(table['t']), 3))
    for k, axis in enumerate(axes, 1):
        column = {X: 0, Y: 1, Z: 2}[axis]
        omega = omega + r[:, :, column] * table[f'dq{k}'][:, None]
        r = r @ turn(axis, table[f'q{k}'])
    return r, omega


def integrals(table, axes):
    """Energy, angular momentum about the vertical, and spin: all constant, from the table's coordinates and rates."""
    r, omega = motion_of(table, axes)
    figure = r[:, :, 2]
    spin = np.sum(omega * figure, axis=1)
    across = ACROSS + MASS * ARM**2
    momentum = across * omega + (ALONG - across) * spin[:, None] * figure
    return 0.5 * np.sum(omega * momentum, axis=1) + MASS * G * ARM * figure[:, 2], momentum[:, 2], spin


def top(q, dq, axes=(X, Y, Z), end=2.0, intervals=200, extra='', tolerance=1e-9):
    """A heavy top on a ball joint in the origin. The point P is beside its axis."""
    pairs = ''.join(f"&pair coordinate={k}, links={k},{k + 1}, kind='revolute', axis={axis} /\n" for k, axis in enumerate(axes, 1))
    start = ''.join(f'&initial coordinate={k}, position={float(q[k - 1])!r}, velocity={float(dq[k - 1])!r} /\n' for k in (1, 2, 3))
    return (f"&mechanism title='Heavy top' /\n&structure cq=1,2,3 /\n&gravity acceleration=0,0,{-G} /\n{pairs}{start}{extra}"
            f'&body link=4, mass={MASS}, centre=0,0,{ARM}, inertia={ACROSS},{ACROSS},{ALONG},0,0,0 /\n'
            f"&point name='P', link=4, position=0.3,0.1,0.2 /\n&time end={end}, intervals={intervals} /\n"
            f'&solver relative_tolerance={tolerance}, absolute_tolerance={tolerance} /\n')


class Session:
    """The program in a folder of its own."""

    def __init__(self, folder, mech9d, checks):
        self.folder, self.mech9d, self.checks = folder, mech9d, checks

    def run(self, data, why, *options, code=0):
        with open(os.path.join(self.folder, 'run.nml'), 'w', encoding='utf-8') as file:
            file.write(data)
        done = run(self.mech9d, 'run.nml', '--table', 'run.dat', '--report', 'run.json', *options, folder=self.folder)
        self.checks.equal(done.returncode, code, f'{why}; stderr: {done.stderr}')
        if code:
            return done.stderr, None
        with open(os.path.join(self.folder, 'run.json'), encoding='utf-8') as report:
            return read_table(text_of(os.path.join(self.folder, 'run.dat'))), json.load(report)


@pytest.fixture
def session(checks, mech9d, tmp_path):
    return Session(tmp_path, mech9d, checks)


def check_same(checks, table, other, columns, tolerance, why):
    """Columns of two runs of one motion agree; values above 1 count in parts of themselves."""
    for column in columns:
        checks.near(table[column], other[column], tolerance, f'{why}: {column}', scale=1.0)


def check_integrals(checks, table, limit, why, axes=(X, Y, Z)):
    for name, values in zip(('energy', 'momentum about the vertical', 'spin'), integrals(table, axes)):
        change = np.max(np.abs(values - values[0])) / max(1.0, abs(values[0]))
        checks.true(change <= limit, f'{why}: the {name} is constant', change)


POINT = [f'P.{order}{axis}' for order in ('', 'v', 'a') for axis in 'xyz']
ANGLES = [f'{order}{k}' for order in ('q', 'dq', 'ddq') for k in (1, 2, 3)]


@pytest.mark.parametrize('spin', [5.0, 0.1, 1e-3, 1e-6, 1e-9, 0.0])
def test_ways_past_the_lock(session, spin):
    """Near by, nearer, and through: first integrals, few steps, and the motion in another order of turns, which has no lock there."""
    checks = session.checks
    why = f'a top with {spin:g} rad/s'
    q, dq = np.array([0.1, 1.2, 0.0]), np.array([0.0, 3.0, spin])
    table, report = session.run(top(q, dq), why)
    if report is None or not checks.equal(len(table['t']), 201, f'{why}: all rows are there'):
        return
    checks.true(report['steps'] <= 600, f'{why}: few steps', report['steps'])
    checks.true(any(event['replaced'] == [1, 2, 3] for event in report['coordinate_changes']), f'{why}: the report tells of it')
    # 200 steps, each with an error of the tolerance of rates up to 20 a second in motions that part by e per 0.1 s at most
    check_integrals(checks, table, 1e-6, why)
    start = {f'{name}{k + 1}': values[[k]] for name, values in (('q', q), ('dq', dq)) for k in range(3)}
    start['t'] = np.zeros(1)
    r, omega = motion_of(start, (X, Y, Z))
    other, _ = session.run(top(*turned_start(r[0], omega[0]), axes=(X, Z, Y)), f'{why}, in another order')
    check_same(checks, table, other, POINT, 1e-5, f'{why}: in another order of turns')


def turned_start(r, omega):
    """Angles and rates of the turns about x, z' and y'' for a rotation and an angular velocity."""
    # r = Rx(a) Rz(b) Ry(c): the y axis of the body is (-sin b, cos a cos b, sin a cos b)
    q = np.array([np.arctan2(r[2, 1], r[1, 1]), np.arcsin(-r[0, 1]), np.arctan2(r[0, 2], r[0, 0])])
    second = turn(X, q[:1])[0][:, 2]
    return q, np.linalg.solve(np.column_stack(([1.0, 0.0, 0.0], second, r[:, 1])), omega)


@pytest.mark.parametrize('q, dq', [((0, 1.2, 0), (0.1, 3, 0)), ((0.3, 0.3, 0.2), (3, 8, 7)), ((0.1, 1.0, 0.0), (0, 0, 60))])
def test_against_own_angles(session, q, dq):
    """At a distance of 0.03 rad the angles of the data file can be integrated themselves."""
    checks = session.checks
    why = f'from {q}, {dq}'
    table, report = session.run(top(q, dq, end=1.0), why)
    own, steady = session.run(top(q, dq, end=1.0, extra=STEADY), f'{why}, in its own angles')
    checks.true(report['coordinate_changes'] != [] and steady['coordinate_changes'] == [], f'{why}: with and without other angles')
    for column in ANGLES:
        # 1e-9 over the square of the distance for rates, and over its cube for accelerations
        limit = {'q': 1e-7, 'dq': 1e-6, 'ddq': 1e-5}[column[:-1]]
        checks.near(table[column], own[column], limit, f'{why}: {column}', scale=10.0)


def test_through_the_lock_in_a_plane(session):
    """A pendulum that swings through the lock in one plane: the second angle goes on beyond 90 degrees, as that of one hinge does."""
    checks = session.checks
    table, report = session.run(top((0, 0.4, 0), (0, 1, 0)), 'a pendulum in a plane')
    data = (f"&mechanism /\n&structure cq=1 /\n&gravity acceleration=0,0,{-G} /\n&pair coordinate=1, links=1,2, "
            f"kind='revolute', axis={Y} /\n&initial coordinate=1, position=0.4, velocity=1 /\n&body link=2, mass={MASS}, "
            f'centre=0,0,{ARM}, inertia={ACROSS},{ACROSS},{ALONG},0,0,0 /\n&time end=2, intervals=200 /\n'
            '&solver relative_tolerance=1e-11, absolute_tolerance=1e-11 /\n')
    hinge, _ = session.run(data, 'the same on one hinge')
    checks.true(np.max(table['q2']) > 4.0 and len(report['coordinate_changes']) > 0, 'it swings beyond the lock', np.max(table['q2']))
    for order, limit in (('q', 1e-6), ('dq', 1e-5), ('ddq', 1e-4)):   # errors grow tenfold by the pendulum's rate with each order
        checks.near(table[f'{order}2'], hinge[f'{order}1'], limit, f'{order}2 is that of one hinge', scale=1.0)
        for k in (1, 3):
            checks.near(table[f'{order}{k}'], 0.0, 1e-9, f'{order}{k} stays zero', scale=1.0)


@pytest.mark.parametrize('q, dq', [((0.5, QUARTER, 0.1), (2, 1, 3)), ((0.5, -QUARTER, 0.1), (2, -3, 20)), ((0, QUARTER, 0), (0, 3, 0))])
def test_outputs_in_the_lock(session, q, dq):
    """A start in the lock itself: its rates and accelerations continue the motion after it, by Taylor's series."""
    checks = session.checks
    step = 2.5e-4
    table, report = session.run(top(q, dq, end=4 * step, intervals=4), f'a start in gimbal lock, {q}, {dq}')
    checks.near(table['q1'][0], q[0], 1e-14, 'the start is the given one')
    checks.equal(report['coordinate_changes'][0]['t'], 0.0, 'other angles from the start')
    for k in (1, 2, 3):
        value, rate, acceleration = (table[f'{order}{k}'] for order in ('q', 'dq', 'ddq'))
        # Hermite's formula: the value after a step follows from rates and accelerations, but for step**5/720 times the fifth
        # derivative, of some 80**5: 4e-12; an error of 1e-3 in an acceleration would be 5e-12
        three = value[1] - value[0] - step * (rate[0] + rate[1]) / 2 - step**2 * (acceleration[0] - acceleration[1]) / 12
        checks.true(abs(three) <= 1e-11, f'{q}, {dq}: coordinate {k} goes on as it begins', three)


def random_tops(count):
    """Data files of bodies on joints of three axes in any position, with the second pair the other way round."""
    random = np.random.default_rng(5)
    for trial in range(count):
        base = np.linalg.qr(random.normal(size=(3, 3)))[0]
        axes = [base[:, 0], base[:, 1], np.cos(trial) * base[:, 2] + np.sin(trial) * base[:, 0]]
        text = [','.join(repr(float(x)) for x in axis) for axis in axes]
        q, dq = random.normal(size=3), 6.0 * random.normal(size=3)
        data = top(q, dq, end=6.0, intervals=3000, tolerance=1e-10)
        for k, axis in enumerate((X, Y, Z)):
            data = data.replace(f"kind='revolute', axis={axis} /", f"kind='revolute', axis= {text[k]}, point=0.1,0.2,0.3 /")
        yield data.replace('links=2,3', 'links=3,2')


@pytest.mark.parametrize('data', random_tops(3), ids=range(3))
def test_random_turns(session, data):
    """A body that tumbles for many turns on a joint of any three perpendicular axes, with links the other way round: the angles
    give the position of the body at any time, are continuous, and their rates are their derivatives."""
    checks = session.checks
    why = 'random turns'
    table, report = session.run(data, why)
    replaced = [len(event['replaced']) > 0 for event in report['coordinate_changes']]
    checks.true(replaced.count(True) > 1 and replaced.count(False) > 1, f'{why}: it went forth and back', replaced)
    change = np.max(np.abs(table['E.total'] - table['E.total'][0]))
    checks.true(change <= 1e-6, f'{why}: energy', change)
    own, _ = session.run(data + STEADY, f'{why}, in its own angles')
    early = table['t'] <= 1.0
    for column in ('q1', 'q2', 'q3', 'P.x', 'P.vy', 'P.az'):
        checks.near(table[column][early], own[column][early], 1e-5, f'{why}: {column}', scale=10.0)
    for k in (1, 2, 3):
        step = np.diff(table[f'q{k}'])
        checks.true(np.max(np.abs(step)) < 3.5, f'{why}: q{k} does not jump by whole turns', np.max(np.abs(step)))
        rates, slow = table[f'dq{k}'], np.abs(table[f'ddq{k}']) < 1e3
        slow = slow[1:] & slow[:-1]
        # the trapezoidal rule errs by a twelfth of the cube of the step times the third derivative
        errors = np.abs(step - 0.002 * (rates[1:] + rates[:-1]) / 2)[slow]
        checks.true(np.max(errors) < 1e-3, f'{why}: dq{k} is the rate of q{k}', np.max(errors))
    print(f'{why}: {report["steps"]} steps, {len(report["coordinate_changes"])} changes, energy {change:.1e} J')


def chain(independent, start, rate):
    """Two bodies on ball joints, the second of which carries a four-bar that turns round, described by one of its coordinates."""
    groups = ['&mechanism /', '&gravity acceleration=0,0,-9.81 /', '&structure cq=' + ','.join(map(str, range(1, 7)))
              + f',{independent} /', f'&initial coordinate={independent}, position={float(start)!r}, velocity={float(rate)!r} /']
    pairs = [((k, k + 1), (X, Y, Z)[(k - 1) % 3], '0,0,0.5' if k == 4 else '0,0,0') for k in range(1, 7)]
    pairs += [((7, 8), X, '0,0,0.5'), ((8, 9), X, '0,0.1,0'), ((9, 10), X, '0,0,0.3'), ((7, 10), X, '0,0.3,0.5')]
    for k, (links, axis, point) in enumerate(pairs, 1):
        moving = '0,0,0.25' if k == 9 else '0,0,0'
        groups.append(f"&pair coordinate={k}, links={links[0]},{links[1]}, kind='revolute', axis={axis}, point={point}, "
                      f'moving_point={moving} /')
    groups += [f'&initial coordinate={k}, position={q}, velocity={dq} /'
               for k, q, dq in zip(range(1, 7), (0.3, 1.4, 0.2, 0.5, 0.4, 0.1), (1, 1, 0.5, 2, 5, 1))]
    groups += [f'&body link={link}, mass={mass}, centre=0,0,{centre}, inertia=0.02,0.02,0.01,0,0,0 /'
               for link, mass, centre in ((4, 1, 0.25), (7, 1, 0.25), (8, 0.3, 0), (9, 0.3, 0.1), (10, 0.3, 0.1))]
    groups += ["&point name='P', link=8, position=0.3,0.1,0.2 /", '&time end=3, intervals=300 /',
               '&solver relative_tolerance=1e-10, absolute_tolerance=1e-10 /']
    return '\n'.join(groups) + '\n'


def test_two_ball_joints_and_a_four_bar(session):
    """Two ball joints and a four-bar: angles of both are replaced, also while the four-bar gets another independent coordinate at its
    dead point. Its crank as this coordinate, and angles as they are, give the same motion."""
    checks = session.checks
    crank, report = session.run(chain(7, 2.0, 9.0), 'a chain with a four-bar')
    rocker, other = session.run(chain(10, crank['q10'][0], crank['dq10'][0]), 'the same by its rocker')
    own, _ = session.run(chain(7, 2.0, 9.0) + STEADY + STEADY.replace('coordinate=1', 'coordinate=4'), 'the same in its own angles')
    for events, why in ((report['coordinate_changes'], 'by the crank'), (other['coordinate_changes'], 'by the rocker')):
        checks.equal({k for event in events for k in event['replaced']}, set(range(1, 7)), f'{why}: both joints')
    both = [before for before, after in zip(other['coordinate_changes'], other['coordinate_changes'][1:])
            if before['replaced'] and before['independent'] != after['independent']]
    checks.true(both != [], 'the independent coordinate changes while angles are replaced', other['coordinate_changes'])
    early = crank['t'] <= 1.0
    for column in [f'q{k}' for k in range(1, 11)] + POINT:
        for table, why in ((rocker, 'by the rocker'), (own, 'in its own angles')):
            checks.near(table[column][early], crank[column][early], 1e-6, f'the same motion {why}: {column}', scale=10.0)
    for table, why in ((crank, 'by the crank'), (rocker, 'by the rocker')):
        change = np.max(np.abs(table['E.total'] - table['E.total'][0]))
        # some 1000 steps, each with an error of 1e-10 in rates up to 30 a second of bodies of 1 kg and 1 m
        checks.true(change <= 1e-6, f'energy {why}', change)


def test_start_in_the_lock_with_a_load(session):
    """Loads on the angles themselves keep them; then the message names the lock."""
    checks = session.checks
    message, _ = session.run(top((0, QUARTER, 0), (0, 3, 0), extra=STEADY), 'a start in the lock with a load', code=SINGULAR)
    checks.true('gimbal lock at t = 0 s' in message and 'coordinates 1, 3' in message, 'the message names it', message)


def test_way_into_the_lock_with_a_load(session):
    checks = session.checks
    # stopped soon, so that the test is short: as many steps as it would take anywhere else
    message, _ = session.run(top((0, 1.2, 0), (0, 3, 1e-6), extra=STEADY), 'a way into the lock with a load',
                             '--set', 'solver.maximum_steps=500', code=SINGULAR)
    checks.true('gimbal lock at t = 0.06624' in message and 'coordinates 1, 3' in message, 'the message names it', message)
    checks.true('stiff' not in message, 'and no stiffness', message)


def test_gimbals_with_inertia_have_no_lock(session):
    checks = session.checks
    gimbals = '&body link=2, mass=0, inertia=1e-4,1e-4,1e-4,0,0,0 /\n'
    table, report = session.run(top((0, 1.2, 0), (0, 3, 1e-6), extra=gimbals), 'gimbals with inertia')
    checks.equal(report['coordinate_changes'], [], 'they keep their angles')
