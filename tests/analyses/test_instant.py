"""The report of a run at one instant (&time at=): mass matrix, Jacobians of points and of dependent coordinates, and generalized forces by
kind. Against closed forms of a double pendulum and a crane, and by identities: kinetic energy is dq M dq/2, accelerations of the run
leave M ddq + bias zero, rates of points and coordinates are Jacobian times independent rates, positions near by have the Jacobian as
their differences, forces of all kinds have the sum zero, forces with a potential are its slopes, and drives need what columns tell.

Compares the program with itself in part: mech9k and mech9d, units, the order of cq.
"""
import json
import os
import re

import numpy as np
import pytest

from mech9_cases import TREE, read_table, run

G = 9.81
KINDS = ('gravity', 'loads', 'springs', 'dampers', 'motors', 'stops', 'contacts', 'friction', 'drives', 'inertia')

# two thin bars in the plane of x and y; springs, dampers and torques on both coordinates, a motor on the second
PENDULUM = """&mechanism {units} /
&structure cq={order} /
&pair coordinate=1, links=1,2, kind='revolute', axis=0,0,1, point=0,0,0 /
&pair coordinate=2, links=2,3, kind='revolute', axis=0,0,1, point={l1},0,0, moving_point=0,0,0 /
&initial coordinate=1, position={q1}, velocity={dq1} /
&initial coordinate=2, position={q2}, velocity={dq2} /
&body link=2, mass={m1}, centre={c1},0,0, inertia=0,0,{j1},0,0,0 /
&body link=3, mass={m2}, centre={c2},0,0, inertia=0,0,{j2},0,0,0 /
&gravity acceleration=0,-{g},0 /
&load kind='coordinate', coordinate=1, stiffness=3, rest=0, damping=0.4, force=1.5 /
&load kind='coordinate', coordinate=2, stiffness=2, damping=0.3 /
&load kind='torque', link=3, torque=0,0,0.7 /
&point name='tip', link=3, position={tip},0,0 /
&time at=0 /
"""
SI = dict(units='', order='1,2', l1=0.5, c1=0.3, c2=0.2, tip=0.4, m1=2, j1=0.03, m2=1.5, j2=0.02, g=G)

# a four-bar with a mass on its coupler, a spring to the frame, and a slider that a helical gear moves: one closed planar chain and an open
# branch with two freedoms; and a spatial chain: two shafts with a universal joint, an arm with a ball joint
CASES = {
    'four-bar': """&structure cq=4,5,1 /
&pair coordinate=1, links=1,2, kind='revolute', axis=0,0,1 /
&pair coordinate=2, links=2,3, kind='revolute', axis=0,0,1, point=0.3,0,0, moving_point=0,0,0 /
&pair coordinate=3, links=4,3, kind='revolute', axis=0,0,1, point=0.7,0,0, moving_point=0.9,0,0 /
&pair coordinate=6, links=1,4, kind='revolute', axis=0,0,1, point=0.8,0,0, moving_point=0,0,0 /
&pair coordinate=4, links=3,5, kind='prismatic', axis=1,0.3,0, point=0.4,0.2,0, moving_point=0,0,0 /
&pair coordinate=5, links=5,6, kind='revolute', axis=0,0,1, point=0.1,0,0, moving_point=0,0.1,0 /
&initial coordinate=1, position=0.9, velocity=3 /
&initial coordinate=2, position=-0.4 /
&initial coordinate=6, position=1.2 /
&initial coordinate=4, position=0.2, velocity=-0.5 /
&initial coordinate=5, position=0.7, velocity=2 /
&body link=2, mass=1, centre=0.1,0.02,0, inertia=0,0,0.01,0,0,0 /
&body link=3, mass=2, centre=0.5,0.1,0, inertia=0,0,0.05,0,0,0 /
&body link=5, mass=0.5, centre=0.05,0,0, inertia=0,0,0.002,0,0,0 /
&body link=6, mass=0.7, centre=0.2,0.1,0, inertia=0,0,0.004,0,0,0 /
&gravity acceleration=1,-9.81,0 /
&load kind='spring', links=1,3, position=0.2,0.9,0, second_position=0.4,0.1,0, stiffness=80, free_length=0.5, damping=2 /
&load kind='coordinate', coordinate=6, stiffness=5, rest=0.2, damping=0.3, force=0.8 /
&load kind='coordinate', coordinate=4, stiffness=40, rest=0.1 /
&load kind='force', link=6, position=0.1,0,0, force=3,-2,0 /
&point name='P', link=6, position=0.3,0.2,0 /
&point name='R', link=4, position=0.4,0.1,0 /
&time at=0.3 /
""",
    'shafts': """&structure cq=1,7,5,6,8 /
&pair coordinate=1, links=1,2, kind='revolute', axis=0,0,1 /
&pair coordinates=2,3, links=2,3, kind='universal', axis=1,0,0, moving_axis=0,1,0 /
&pair coordinate=4, links=1,3, kind='revolute', axis=0.5,0,1 /
&pair coordinates=5,6,7, links=3,4, kind='spherical', point=0.3,0.1,0, moving_point=0,0,0 /
&pair coordinate=8, links=4,5, kind='helical', pitch=0.3, axis=0.2,1,0.1, point=0.2,0,0.1, moving_point=0,0.1,0 /
&initial coordinate=1, position=0.4, velocity=2 /
&initial coordinate=5, position=0.3, velocity=-1 /
&initial coordinate=6, position=-0.5, velocity=0.7 /
&initial coordinate=7, position=0.8, velocity=1.1 /
&initial coordinate=8, position=0.2, velocity=3 /
&body link=3, mass=3, centre=0.1,0,0.1, inertia=0.05,0.06,0.04,0.001,0,0.002 /
&body link=4, mass=2, centre=0.2,0.1,0.05, inertia=0.02,0.03,0.03,0.001,0,0.002 /
&body link=5, mass=1, centre=0,0.2,0.05, inertia=0.01,0.02,0.015,0,0.001,0 /
&gravity acceleration=0,1,-9.81 /
&load kind='spring', links=1,5, position=0.5,0.9,0, second_position=0.1,0.1,0.2, stiffness=30, free_length=0.4, damping=1 /
&load kind='coordinate', coordinate=4, stiffness=4, damping=0.2 /
&load kind='coordinate', coordinate=8, stiffness=1, damping=0.1 /
&load kind='torque', link=4, torque=0.3,0.2,-0.5 /
&point name='P', link=5, position=0.3,0.2,0.1 /
&point name='O', link=1, position=1,1,0 /
&time at=0 /
""",
}


@pytest.fixture
def report(checks, tmp_path, build):
    """A function: the report of a text, and the first row of its table."""
    def of(text, *options, program='mech9d'):
        path = os.path.join(tmp_path, 'a.nml')
        with open(path, 'w') as file:
            file.write(text)
        done = run(os.path.join(build.bin, program), path, '--quiet', '--table', '-', '--report', path + '.json', *options)
        if done.returncode != 0:
            raise RuntimeError(f'{text}{options} ended with {done.returncode}:\n{done.stderr}')
        with open(path + '.json', encoding='utf-8') as file:
            return json.load(file), {name: column[0] for name, column in read_table(done.stdout).items()}
    return of


def values(row, names, kind=''):
    return np.array([row[kind + name] for name in names])


def forces(found):
    return {kind: np.array(found['generalized_forces'][kind]) for kind in KINDS}


def driven(text, row, coordinates):
    """The text for mech9k, whose drives have the motion of a row at the time 0."""
    drives = ''.join(f"&drive coordinate={q[1:]}, kind='polynomial', coefficients={row[q]!r},{row['d' + q]!r},{row['dd' + q] / 2!r} /\n"
                     for q in coordinates)
    starts = ''.join(f"&initial coordinate={q[1:]}, position={row[q]!r} /\n" for q in row
                     if re.fullmatch(r'q\d+', q) and q not in coordinates)
    lines = [line for line in text.splitlines(keepends=True) if not line.startswith(('&initial', '&time'))]
    return ''.join(lines) + starts + drives + '&time at=0 /\n'


def test_double_pendulum(report, checks):
    """Closed forms of mass matrix, Jacobian and all forces, at several motions."""
    for q1, q2, dq1, dq2 in ((0.3, 0.7, 0, 0), (-1.2, 2.1, 3, -4), (2.5, -0.4, -1, 6)):
        found, row = report(PENDULUM.format(q1=q1, q2=q2, dq1=dq1, dq2=dq2, **SI))
        l1, c1, c2, m1, j1, m2, j2, tip = (SI[name] for name in ('l1', 'c1', 'c2', 'm1', 'j1', 'm2', 'j2', 'tip'))
        m22 = j2 + m2 * c2**2
        m12 = m22 + m2 * l1 * c2 * np.cos(q2)
        m11 = j1 + m1 * c1**2 + m22 + m2 * l1**2 + 2 * m2 * l1 * c2 * np.cos(q2)
        checks.near(found['mass_matrix'], [[m11, m12], [m12, m22]], 1e-14, 'mass matrix')
        checks.equal(found['mass_matrix_coordinates'], ['q1', 'q2'], 'its rows')
        checks.equal(found['mass_matrix_units'], [['kg m^2'] * 2] * 2, 'its units')
        h = m2 * l1 * c2 * np.sin(q2)
        q, dq, ddq = (values(row, ('q1', 'q2'), kind) for kind in ('', 'd', 'dd'))
        expected = dict.fromkeys(KINDS, np.zeros(2))
        expected['gravity'] = -G * np.array([m1 * c1 * np.cos(q1) + m2 * (l1 * np.cos(q1) + c2 * np.cos(q1 + q2)),
                                             m2 * c2 * np.cos(q1 + q2)])
        expected['loads'] = np.array([1.5 + 0.7, 0.7])
        expected['springs'] = -np.array([3, 2]) * q
        expected['dampers'] = -np.array([0.4, 0.3]) * dq
        expected['inertia'] = -(np.array([[m11, m12], [m12, m22]]) @ ddq + h * np.array([-2 * dq1 * dq2 - dq2**2, dq1**2]))
        for kind, force in forces(found).items():
            checks.near(force, expected[kind], 1e-13, kind, scale=20)
        checks.near(found['bias'], h * np.array([-2 * dq1 * dq2 - dq2**2, dq1**2])
                    - sum(expected[kind] for kind in KINDS if kind != 'inertia'), 1e-13, 'bias', scale=20)
        s1, s2, k1, k2 = np.sin(q1), np.sin(q1 + q2), np.cos(q1), np.cos(q1 + q2)
        checks.near(found['point_jacobians']['tip'], [[-l1 * s1 - tip * s2, -tip * s2], [l1 * k1 + tip * k2, tip * k2], [0, 0]], 1e-15,
                    'Jacobian of the tip')
        checks.equal((found['dependent_coordinates'], found['dependent_jacobian']), ([], []), 'no coordinate depends on others')


def test_units_and_order(report, checks):
    """In g, mm, kN, degrees and rpm, with cq in the other order: numbers in these units, turning coordinates per rad in masses and forces."""
    units = "length_unit='mm', angle_unit='deg', mass_unit='g', force_unit='kN', rate_unit='rpm'"
    deg, rpm = np.pi / 180, np.pi / 30
    plain, _ = report(PENDULUM.format(q1=0.4, q2=-0.9, dq1=2, dq2=5, **SI))
    text = PENDULUM.format(q1=0.4 / deg, q2=-0.9 / deg, dq1=2 / rpm, dq2=5 / rpm, units=units, order='2,1', l1=500, c1=300, c2=200, tip=400,
                           m1=2000, j1=3e7, m2=1500, j2=2e7, g=G * 1000)
    # torques of N m in kN mm are the same numbers
    found, row = report(text)
    checks.equal(found['mass_matrix_coordinates'], ['q2', 'q1'], 'rows in the order of cq')
    checks.equal(found['mass_matrix_units'], [['g mm^2'] * 2] * 2, 'units of the mass matrix')
    checks.equal(found['generalized_forces']['units'], ['kN mm'] * 2, 'units of forces')
    checks.near(np.array(found['mass_matrix']) / 1e9, np.array(plain['mass_matrix'])[::-1, ::-1], 1e-13, 'mass matrix')
    checks.near(found['bias'], plain['bias'][::-1], 1e-12, 'bias')
    for kind in KINDS:
        checks.near(found['generalized_forces'][kind], plain['generalized_forces'][kind][::-1], 1e-12, kind, scale=20)
    checks.near(np.array(found['point_jacobians']['tip']) / (1000 * deg), np.array(plain['point_jacobians']['tip'])[:, ::-1], 1e-13,
                'Jacobian in mm per degree')
    coefficients = {(c['p'], c['r']): c['value'] for c in found['coefficients']}
    checks.near([coefficients[1, 1], coefficients[1, 2]], [found['mass_matrix'][1][1], found['mass_matrix'][0][1]], 1e-14,
                'coefficients of motion in these units')


@pytest.mark.parametrize('name', CASES)
def test_identities(report, checks, name):
    text = CASES[name]
    found, row = report(text)
    independent, dependent = found['jacobian_coordinates'], found['dependent_coordinates']
    checks.equal(independent, [f'q{k}' for k in re.search('cq=([0-9,]+)', text)[1].split(',')], 'columns in the order of cq')
    checks.equal(found['mass_matrix_coordinates'], independent, 'all of them are free')
    m, bias = np.array(found['mass_matrix']), np.array(found['bias'])
    q, dq, ddq = (values(row, independent, kind) for kind in ('', 'd', 'dd'))
    checks.near(m, m.T, 0, 'the mass matrix is symmetric')
    checks.near(dq @ m @ dq / 2, row['E.kinetic'], 1e-13, 'kinetic energy')
    checks.near(m @ ddq + bias, 0, 1e-12 * np.abs(bias).max(), 'M ddq + bias')
    coefficients = {(f"q{c['p']}", f"q{c['r']}"): c['value'] for c in found['coefficients']}
    for i, p in enumerate(independent):
        for k, r in enumerate(independent):
            checks.near(m[i, k], coefficients[min((p, r), (r, p))], 1e-12, f'a({p},{r})', scale=np.abs(m).max())
    jacobian = np.array(found['dependent_jacobian'])
    checks.near(jacobian @ dq, values(row, dependent, 'd'), 1e-12, 'rates of dependent coordinates', scale=np.abs(dq).max())
    points = {point: np.array(rows) for point, rows in found['point_jacobians'].items()}
    for point, rows in points.items():
        checks.near(rows @ dq, [row[f'{point}.v{x}'] for x in 'xyz'], 1e-12, f'velocity of {point}', scale=np.abs(dq).max())
    found_forces = forces(found)
    total = sum(found_forces.values())
    checks.near(total, 0, 1e-12 * max(np.abs(force).max() for force in found_forces.values()), 'all forces together')
    checks.equal([kind for kind in KINDS if np.any(found_forces[kind] != 0)], ['gravity', 'loads', 'springs', 'dampers', 'inertia'],
                 'kinds that act')
    checks.near(sum(dq @ force for force in found_forces.values()), 0, 1e-12 * max(abs(dq @ force) for force in found_forces.values()),
                'their powers together')

    # other positions: differences of fourth order, h so that truncation and round-off are both about 1e-11
    h = 1e-3

    def near_by(k, step):
        start = text
        for i, name_of in enumerate(independent):
            start = re.sub(rf'(&initial coordinate={name_of[1:]}, position=)[^,]*', rf'\g<1>{float(q[i] + (step if i == k else 0))!r}', start)
        return report(start, '--set', 'time.at=0.0')
    for k in range(len(independent)):
        sides = {step: near_by(k, step * h) for step in (-2, -1, 1, 2)}

        def slope(of):
            a, b, c, d = (of(*sides[step]) for step in (-2, -1, 1, 2))
            return (a - 8 * b + 8 * c - d) / (12 * h)
        checks.near(slope(lambda _, there: values(there, dependent)), jacobian[:, k], 1e-10, f'dependent coordinates by {independent[k]}')
        for point, rows in points.items():
            checks.near(slope(lambda _, there, p=point: np.array([there[f'{p}.{x}'] for x in 'xyz'])), rows[:, k], 1e-10,
                        f'{point} by {independent[k]}', scale=1)
        checks.near(-slope(lambda _, there: there['E.potential']), (found_forces['gravity'] + found_forces['springs'])[k], 1e-10,
                    f'gravity and springs are slopes of the potential by {independent[k]}', scale=np.abs(found_forces['gravity']).max())
    over_time = report(text.replace('&time at=0.3 /', '&time end=0.01, intervals=1 /').replace('&time at=0 /', '&time end=0.01, intervals=1 /'))[0]
    checks.true('mass_matrix' not in over_time, 'a run over time has no mass matrix in its report')


@pytest.mark.parametrize('name', CASES)
def test_kinetic_energy_by_polarisation(report, checks, name):
    """The mass matrix from kinetic energies of unit rates and of their pairs, in one position."""
    text = CASES[name]
    found, row = report(text)
    independent, m = found['jacobian_coordinates'], np.array(found['mass_matrix'])

    def energy(rates):
        start = text
        for coordinate, rate in zip(independent, rates):
            start = re.sub(rf'(&initial coordinate={coordinate[1:]}, .*velocity=)[^ ]*', rf'\g<1>{float(rate)!r}', start)
        return report(start)[1]['E.kinetic']
    n = len(independent)
    unit = np.eye(n)
    single = [energy(unit[i]) for i in range(n)]
    for i in range(n):
        checks.near(2 * single[i], m[i, i], 1e-12, f'M({i},{i})')
        for k in range(i):
            checks.near(energy(unit[i] + unit[k]) - single[i] - single[k], m[i, k], 1e-12, f'M({i},{k})', scale=np.abs(m).max())


@pytest.mark.parametrize('name', CASES)
def test_driven_motions(report, checks, name):
    """The same motion driven, in mech9k and mech9d: the same numbers, drives that need nothing; other accelerations need what the columns
    of drives tell, M times the change."""
    text = CASES[name]
    found, row = report(text)
    independent = found['jacobian_coordinates']
    m = np.array(found['mass_matrix'])
    for program in ('mech9k', 'mech9d'):
        other, there = report(driven(text, row, independent), program=program)
        for key in ('jacobian_coordinates', 'dependent_coordinates', 'mass_matrix_coordinates'):
            checks.equal(other[key], found[key], key)
        for key in ('mass_matrix', 'bias', 'dependent_jacobian'):
            checks.near(other[key], found[key], 1e-11, f'{program}: {key}', scale=np.abs(found[key]).max())
        for kind in KINDS:
            checks.near(forces(other)[kind], forces(found)[kind], 1e-11, f'{program}: {kind}', scale=np.abs(found['bias']).max())
        changed = dict(row)
        for i, coordinate in enumerate(independent):
            changed['dd' + coordinate] += 1 + i
        other, there = report(driven(text, changed, independent), '--set', 'output.drive_forces=.true.', program=program)
        checks.near(forces(other)['drives'], m @ (1.0 + np.arange(len(m))), 1e-11, 'drives', scale=np.abs(found['bias']).max())
        checks.near(forces(other)['drives'], [there[f'F{q[1:]}'] for q in independent], 1e-11, 'drives as columns',
                    scale=np.abs(found['bias']).max())
        ddq = values(there, independent, 'dd')
        checks.near(m @ ddq + other['bias'], forces(other)['drives'], 1e-11, 'M ddq + bias are the forces of drives',
                    scale=np.abs(found['bias']).max())


def test_some_driven(report, checks):
    """Of a driven and free coordinates, the mass matrix has the free ones; the driven one has a force of its drive."""
    text = CASES['four-bar']
    whole, row = report(text)
    drive = f"&drive coordinate=1, kind='polynomial', coefficients={row['q1']!r},3,4 /\n&time at=0 /\n"
    text = re.sub('&initial coordinate=1.*\n|&time.*\n', '', text) + drive
    found, row = report(text, '--set', 'output.drive_forces=.true.')
    checks.equal(found['mass_matrix_coordinates'], ['q4', 'q5'], 'free coordinates')
    checks.equal(found['jacobian_coordinates'], ['q4', 'q5', 'q1'], 'independent coordinates')
    checks.near(found['mass_matrix'], np.array(whole['mass_matrix'])[:2, :2], 1e-12, 'the part of the whole matrix')
    checks.near(np.array(found['mass_matrix']) @ values(row, ('q4', 'q5'), 'dd') + found['bias'], 0, 1e-11, 'M ddq + bias')
    drives = found['generalized_forces']['drives']
    checks.equal(drives[:2], [0, 0], 'no drive of free coordinates')
    checks.near(drives[2], row['F1'], 1e-12, 'the force of the drive')
    checks.near(row['ddq1'], 8, 1e-14, 'its acceleration')


def test_motors_stops_and_frictions(report, checks):
    """Each in its kind, as its column."""
    text = """&structure cq=1,2 /
&pair coordinate=1, links=1,2, kind='prismatic', axis=1,0,0 /
&pair coordinate=2, links=2,3, kind='prismatic', axis=1,0,0 /
&initial coordinate=1, position=0.2, velocity=3 /
&initial coordinate=2, position=0.7, velocity=2 /
&body link=2, mass=2 /
&body link=3, mass=1 /
&gravity acceleration=0,-9.81,0 /
&friction coordinate=1, dynamic=0.3 /
&stop coordinate=2, high=0.6, stiffness=100, damping=2 /
&motor coordinate=2, kind='pid', proportional=50, derivative=5, law='polynomial', coefficients=0.1 /
&time at=0 /
"""
    found, row = report(text)
    acting = forces(found)
    checks.near(acting['friction'], [-0.3 * 3 * G, 0], 1e-13, 'friction under both weights')
    checks.near(acting['friction'][0], row['R1.friction'], 1e-15, 'as its column')
    checks.near(acting['stops'], [0, row['S1']], 1e-15, 'the stop')
    checks.true(row['S1'] < -9, 'the stop pushes')
    checks.near(acting['motors'], [0, 50 * (0.1 - 0.7) - 5 * 2], 1e-13, 'the motor')
    checks.near(np.array(found['mass_matrix']), [[3, 1], [1, 1]], 1e-15, 'masses')
    checks.equal(found['mass_matrix_units'], [['kg'] * 2] * 2, 'in kg')
    checks.near(sum(acting.values()), 0, 1e-12, 'all together')
    # driven, without and with forces among the columns; the friction belongs to both
    for options in ((), ('--set', 'output.drive_forces=.true.')):
        other, there = report(driven(text, row, ('q1', 'q2')), *options, program='mech9k')
        checks.equal([(c['p'], c['r']) for c in other['coefficients']], [(c['p'], c['r']) for c in found['coefficients']], 'the same a(p,r)')
        checks.near([c['value'] for c in other['coefficients']], [c['value'] for c in found['coefficients']], 1e-12, 'with the same values')
        checks.near(forces(other)['friction'], acting['friction'], 1e-12, 'friction of a driven motion')
        checks.near(forces(other)['drives'], [0, acting['motors'][1]], 1e-10, 'the drive works for the motor')


def test_a_rigid_stop_that_holds(report, checks):
    """At rest on a stop: its force is the weight."""
    found, row = report("""&structure cq=1 /
&pair coordinate=1, links=1,2, kind='prismatic', axis=0,1,0 /
&initial coordinate=1, position=0, velocity=0 /
&body link=2, mass=2 /
&gravity acceleration=0,-9.81,0 /
&stop coordinate=1, low=0 /
&time at=0 /
""")
    acting = forces(found)
    checks.near(acting['stops'], [2 * G], 1e-14, 'the stop carries the weight')
    checks.near(acting['gravity'], [-2 * G], 1e-14, 'the weight')
    checks.near(acting['inertia'], [0], 1e-14, 'it rests')
    checks.near(found['bias'], [0], 1e-14, 'the force of the stop is in the bias')


def test_kinematics_alone(report, checks):
    """Without masses and loads there are Jacobians only. At a dead point there are none, and the report says why."""
    text = """&mechanism angle_unit='deg' /
&structure cq=1 /
&pair coordinate=1, links=1,2, kind='revolute', axis=0,0,1 /
&pair coordinate=2, links=2,3, kind='revolute', axis=0,0,1, point=0.3,0,0, moving_point=0,0,0 /
&pair coordinate=3, links=3,4, kind='revolute', axis=0,0,1, point=1,0,0, moving_point=0,0,0 /
&pair coordinate=4, links=1,4, kind='prismatic', axis=1,0,0 /
&initial coordinate=4, position=1.2 /
&point name='B', link=4 /
&drive coordinate=1, kind='polynomial', coefficients=40, 1000 /
&time at=0.01 /
"""
    for derivatives in '012':
        found, row = report(text, '--set', f'output.derivatives={derivatives}', program='mech9k')
        angle = np.radians(50)
        slope = -0.3 * np.sin(angle) - 0.09 * np.sin(angle) * np.cos(angle) / np.sqrt(1 - 0.09 * np.sin(angle)**2)
        checks.near(found['point_jacobians']['B'], [[slope * np.pi / 180], [0], [0]], 1e-14, 'm per degree')
        checks.near(found['dependent_jacobian'][2], [slope * np.pi / 180], 1e-14, 'the slider by the crank')
        checks.true('mass_matrix' not in found and 'generalized_forces' not in found, 'no masses')
    # the chain is left out of the run, so that only the report comes upon its dead point
    dead = text.replace('cq=1', 'cq=4').replace('&initial coordinate=4, position=1.2 /', '&initial coordinate=1, position=1 /')
    dead = dead.replace("coordinate=1, kind='polynomial', coefficients=40, 1000", "coordinate=4, kind='polynomial', coefficients=1.3")
    found, row = report(re.sub('&point.*\n', '', dead), '--set', 'output.coordinates=4', program='mech9k')
    checks.true('point_jacobians' not in found and 'singular position' in found['jacobian_error'], 'a dead point', found)


def test_a_load_without_a_value(report, checks):
    """mech9k without forces among its columns runs where a spring has no direction; the report has Jacobians alone."""
    text = """&structure cq=1 /
&pair coordinate=1, links=1,2, kind='prismatic', axis=1,0,0 /
&body link=2, mass=1 /
&load kind='spring', links=1,2, stiffness=3, free_length=0.5 /
&drive coordinate=1, kind='polynomial', coefficients={start}, 1 /
&time at=0 /
"""
    found, row = report(text.format(start=0.7), program='mech9k')
    checks.near(found['generalized_forces']['springs'], [-0.6], 1e-14, 'with a value')
    found, row = report(text.format(start=0), program='mech9k')
    checks.equal((found['dependent_jacobian'], 'mass_matrix' in found, 'generalized_forces' in found), ([], False, False), 'without')


def test_points_on_held_rods_and_couplings(report, checks):
    """A rod whose turn the program holds is no column; couplings count."""
    found, row = report("""&structure cq=1,3 /
&pair coordinate=1, links=1,2, kind='revolute', axis=0,0,1 /
&pair coordinate=2, links=1,3, kind='revolute', axis=0,0,1, point=1,0,0, moving_point=0,0,0 /
&pair coordinate=3, links=3,4, kind='prismatic', axis=1,0,0 /
&coupling kind='linear', coordinates=1,2, coefficients=2,1 /
&initial coordinate=1, position=0.3, velocity=1 /
&initial coordinate=3, position=0.5, velocity=1 /
&body link=2, mass=0, inertia=0,0,0.5,0,0,0 /
&body link=4, mass=2 /
&point name='P', link=4 /
&time at=0 /
""")
    checks.near(found['dependent_jacobian'], [[-2, 0]], 1e-15, 'the gear')
    checks.near(found['mass_matrix'], [[0.5 + 4 * 2 * 0.25, 0], [0, 2]], 1e-14, 'masses through the gear')
    angle = -0.6
    checks.near(found['point_jacobians']['P'], [[np.sin(angle), np.cos(angle)], [-np.cos(angle), np.sin(angle)], [0, 0]], 1e-14, 'P')


def gallery():
    """(program, folder, data file) of the examples without user procedures."""
    with open(os.path.join(TREE, 'examples', 'list.txt'), encoding='utf-8') as file:
        for line in file:
            if not line.startswith('#') and line.strip():
                name, program, data, procedures = [field.strip() for field in line.split('|')][:4]
                if not procedures:
                    yield pytest.param(program, os.path.join(TREE, 'examples', name), data, id=name)


SIZES = {'rad': 1, 'deg': np.pi / 180, 'm': 1, 'mm': 1e-3, '1': 1, 'rad/s': 1, 'deg/s': np.pi / 180, 'rpm': np.pi / 30, 'm/s': 1, 'mm/s': 1e-3, '1/s': 1}


@pytest.mark.parametrize('program, folder, data', gallery())
def test_gallery(checks, build, tmp_path, program, folder, data):
    """The identities at the start of every example: curves, couplings, motors, contacts, stops and frictions among them."""
    path = os.path.join(tmp_path, 'report.json')
    with open(os.path.join(folder, data), encoding='utf-8') as file:
        start = re.search(r'&time[^/]*start *= *([-0-9.e]+)', file.read())
    done = run(os.path.join(build.bin, program), os.path.join(folder, data), '--quiet', '--table', '-', '--report', path,
               '--set', f'time.at={start[1] if start else 0}', folder=tmp_path)
    if done.returncode == 3 and re.search('target 2 is at|this time is not among', done.stderr):
        pytest.skip('it asks for other times')
    if not checks.equal(done.returncode, 0, done.stderr):
        return
    with open(path, encoding='utf-8') as file:
        found = json.load(file)
    row = {name: column[0] for name, column in read_table(done.stdout).items()}
    words = re.search('# units: *(.*)', done.stdout)[1]
    units = dict(zip(row, re.split(r'  +', words)))
    if not checks.true('jacobian_error' not in found, f"{found.get('jacobian_error')}"):
        return
    independent, dependent = found['jacobian_coordinates'], found['dependent_coordinates']
    if all('d' + q in row for q in independent):
        rates = np.array([row['d' + q] * SIZES[units['d' + q]] / SIZES[units[q]] for q in independent])
        shown = [i for i, q in enumerate(dependent) if 'd' + q in row]
        if shown:
            expected = np.array([row['d' + dependent[i]] * SIZES[units['d' + dependent[i]]] / SIZES[units[dependent[i]]] for i in shown])
            terms = np.array(found['dependent_jacobian'])[shown] * rates
            checks.near(terms.sum(axis=1), expected, 1e-12, 'rates', scale=max(1e-4, np.abs(terms).max()))
        for point, rows in found['point_jacobians'].items():
            if f'{point}.vx' not in row:
                continue
            terms = np.array(rows) * rates
            checks.near(terms.sum(axis=1), [row[f'{point}.v{x}'] for x in 'xyz'], 1e-12, f'velocity of {point}',
                        scale=max(1e-4, np.abs(terms).max()))
    checks.true(program == 'mech9k' or 'mass_matrix' in found, 'free motions have a mass matrix')
    if 'mass_matrix' in found:
        acting = forces(found)
        # inertia, where nothing acts, is the round-off of its terms: masses times accelerations, of the size of squares of rates
        known = [row['d' + q] * SIZES[units['d' + q]] / SIZES[units[q]] for q in independent if 'd' + q in row]
        sizes = [np.abs(found['bias']).max(), np.abs(found['mass_matrix']).max() * max(np.square(known), default=0.0)]
        round_off = 64 * np.finfo(float).eps * max(sizes)
        checks.near(sum(acting.values()), 0, max(round_off, 1e-10 * max(1e-9, *(np.abs(force).max() for force in acting.values()))),
                    'all forces together')
        checks.true(np.linalg.eigvalsh(np.array(found['mass_matrix'])).min() >= 0, 'kinetic energy is not negative')
