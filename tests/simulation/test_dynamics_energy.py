"""Energy over long runs: without dissipation it stays, with dampers and given forces it changes by their power."""
import os
import tempfile

import numpy as np
import pytest

import data_file
from mech9_cases import REFERENCE, TREE, read_table, run, table_and_report, text_of

# Seconds, and tolerances. The five-bar whirls through nearly singular positions of whichever coordinates it is described
# by, some twenty of them in 10 s, each over within milliseconds; its motion is chaotic: rounding decides how near to such a
# position a run comes, and single runs err by up to a thousand tolerances. So the median of runs with like tolerances counts.
CHAOTIC = {'dynamics_fivebar'}
LIKE = (0.8, 0.9, 1.0, 1.1, 1.2)
CONSERVATIVE = {'dynamics_fig1': (100.0, (1e-6, 1e-9)),
                'dynamics_open_chain': (100.0, (1e-6, 1e-9)),
                'dynamics_spatial_slider_crank': (100.0, (1e-6, 1e-9)),
                'dynamics_fivebar': (10.0, (1e-6, 1e-8, 1e-10))}


def groups_of(name):
    return data_file.parse(text_of(os.path.join(REFERENCE, name + '.nml')))


def run_of(mech9d, groups, *options):
    """Table and report of a run of a data file in groups."""
    with tempfile.TemporaryDirectory() as folder:
        path = os.path.join(folder, 'case.nml')
        with open(path, 'w', encoding='utf-8') as file:
            file.write(data_file.write(groups))
        return table_and_report(mech9d, path, *options)


@pytest.mark.parametrize('name, end, tolerance', [(name, end, tolerance) for name, (end, tolerances) in CONSERVATIVE.items()
                                                  for tolerance in tolerances])
def test_energy_without_dissipation(checks, mech9d, name, end, tolerance):
    """A long run of the reference mechanism without its damper: each step errs by at most the tolerance in the rates, whose
    squares the energy holds, and so by twice the tolerance in the energy. Such errors have either sign; their sum grows like
    the root of the number of steps, and stays below three standard deviations of a sum of random ones."""
    groups = groups_of(name)
    for group, items in groups:
        items.pop('damping', None)
        if group == 'time':
            items['end'], items['intervals'] = [end], [200]
    changes = []
    for like in LIKE if name in CHAOTIC else (1.0,):
        solver = {'relative_tolerance': [like * tolerance], 'absolute_tolerance': [like * tolerance]}
        found, report = run_of(mech9d, groups + [('solver', solver)])
        total = found['E.total']
        checks.true(np.max(np.abs(found['ddq1'])) > 0.5, f'{name}: it is accelerated')
        changes.append(np.max(np.abs(total - total[0])) / np.max(found['E.kinetic']) / np.sqrt(report['steps']))
    print(f'{name}: {np.median(changes) / tolerance:.2g} tolerances times the root of {report["steps"]} steps')
    checks.true(np.median(changes) <= 3 * 2 * tolerance, f'{name}: energy at the tolerance {tolerance:.0e}',
                f'it changed by {np.median(changes):.3e} of its largest value over the root of the number of steps')


# Generalized and spatial loads whose power can be told from the columns of the table. Link 4 of Fig. 1 is at the
# angle q6 to the frame, link 2 at q5.
POWERED = """
&load kind='force', link=5, position=1.0, 0.3, 0.0, force=2.0, -3.0, 1.0 /
&load kind='force', link=4, position=2.6, 0.0, 0.0, force=1.5, 2.5, 0.0, frame='link' /
&load kind='torque', link=2, torque=0.5, 0.4, 1.2 /
&load kind='torque', link=4, torque=0.3, 0.2, -0.8, frame='link' /
&load kind='coordinate', coordinate=7, stiffness=3.0, rest=1.0, damping=0.6, force=1.1 /
&point name='R', link=4, position=2.6, 0.0, 0.0 /
"""


def power_of_loads(found):
    """Power of what has no potential energy, load by load [W]."""
    to_p = np.array([found['P.x'], found['P.y'] + 1.5, found['P.z']])
    v_p = np.array([found['P.vx'], found['P.vy'], found['P.vz']])
    v_r = np.array([found['R.vx'], found['R.vy']])
    c, s = np.cos(found['q6']), np.sin(found['q6'])
    return {'damper of the spring': -0.8 * (np.sum(to_p * v_p, axis=0) / np.linalg.norm(to_p, axis=0)) ** 2,
            'fixed force': np.array([2.0, -3.0, 1.0]) @ v_p,
            'force that turns': (1.5 * c - 2.5 * s) * v_r[0] + (1.5 * s + 2.5 * c) * v_r[1],
            'fixed torque': 1.2 * found['dq5'],
            'torque that turns': -0.8 * found['dq6'],
            'coordinate': 1.1 * found['dq7'] - 0.6 * found['dq7'] ** 2}


def test_energy_changes_by_the_power_of_loads(checks, mech9d):
    """Eighth-order differences of E.total over the rows against the power from rates in the same rows."""
    groups = groups_of('dynamics_fig1') + data_file.parse(POWERED)
    for group, items in groups:
        if group == 'time':
            items['end'], items['intervals'] = [1.0], [1000]
    tolerance = 1e-12
    found, _ = run_of(mech9d, groups + [('solver', {'relative_tolerance': [tolerance], 'absolute_tolerance': [tolerance]})])
    h = found['t'][1] - found['t'][0]
    total = found['E.total']
    n = len(total)
    weights = {1: 4 / 5, 2: -1 / 5, 3: 4 / 105, 4: -1 / 280}
    slope = sum(w * (total[4 + i:n - 4 + i] - total[4 - i:n - 4 - i]) for i, w in weights.items()) / h
    powers = {load: power[4:-4] for load, power in power_of_loads(found).items()}
    scale = np.max(np.abs(slope))
    for load, power in powers.items():
        checks.true(np.max(np.abs(power)) > 1e-3 * scale, f'{load}: it has power', np.max(np.abs(power)) / scale)
    # the integration's noise, 1e-12 of some 100 J, divided by h; truncation, h^8/630 of the ninth derivative, is
    # smaller while the motion changes over 20 ms and more
    checks.near(slope / scale, sum(powers.values()) / scale, 1e-7, 'dE/dt is the power of the loads')


@pytest.mark.parametrize('name, words', [
    ('pendulum', 'largest change of energy'),
    ('pendulum_four_bar', 'largest change of energy'),
    ('motor_crank', 'work of drives, motors and dampers up to'),
    ('bouncing_slider', 'work of loads, impacts and friction up to')])
def test_name_of_the_change(checks, mech9d, name, words):
    """Work is not called a change of energy, which would look like an error of the integration."""
    done = run(mech9d, os.path.join(TREE, 'examples', name, name + '.nml'), '--no-write')
    checks.equal(done.returncode, 0, name)
    checks.true(f'; {words} ' in done.stderr, f'{name}: {words}', done.stderr)


@pytest.mark.parametrize('law, words', [
    ('', 'largest change of energy'),
    (", law='polynomial', coefficients=1,0.5, over='q1'", 'work of loads, impacts and friction up to'),
    (", law='polynomial', coefficients=1,0.5", 'work of loads, impacts and friction up to')], ids=('plain', 'over a coordinate', 'over time'))
def test_name_of_the_change_by_a_spring(checks, mech9d, tmp_path, law, words):
    """A spring whose force follows a law of time, or of a coordinate that is not its length, has no potential energy."""
    data = tmp_path / 'spring.nml'
    data.write_text(f"""&structure cq=1 /
&pair coordinate=1, links=1,2, kind='revolute', axis=0,0,1 /
&body link=2, mass=1, centre=0.5,0,0, inertia=0,0,0.1,0,0,0 /
&initial coordinate=1, position=0.4 /
&load kind='spring', links=1,2, position=0,1,0, second_position=0.5,0,0, stiffness=5, free_length=0.2{law} /
&time end=1, intervals=10 /
""", encoding='utf-8')
    done = run(mech9d, data, '--no-write')
    checks.equal(done.returncode, 0, law)
    checks.true(f'; {words} ' in done.stderr, f'{law}: {words}', done.stderr)


def test_masses_of_link_1_have_no_energy(checks, mech9d, tmp_path):
    """Link 1 rests: a mass that is fixed to it changes no column of a pendulum, not even by a constant."""
    tables = []
    for mass in ('', '&body link=1, mass=5, centre=0.3,2,0, inertia=1,1,1,0,0,0 /\n'):
        data = tmp_path / 'pendulum.nml'
        data.write_text("""&structure cq=1 /
&pair coordinate=1, links=1,2, kind='revolute', axis=0,0,1 /
&initial coordinate=1, position=0.4 /
&body link=2, mass=1, centre=0.5,0,0, inertia=0,0,0.1,0,0,0 /
&gravity acceleration=0,-9.81,0 /
&time end=1, intervals=10 /
""" + mass, encoding='utf-8')
        done = run(mech9d, data, '--quiet', '--table', tmp_path / 'pendulum.dat')
        checks.equal(done.returncode, 0, mass)
        tables.append(read_table(text_of(tmp_path / 'pendulum.dat')))
    checks.true(np.abs(tables[0]['E.potential'][0] - 9.81 * 0.5 * np.sin(0.4)) < 1e-14, 'the energy of the pendulum is that of its height')
    for name, column in tables[0].items():
        checks.true((tables[1][name] == column).all(), f'{name}: no bit changes')
