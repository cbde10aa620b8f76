"""Data files with units that &mechanism names, of groups that few files of the gallery have, and closed forms in these units.

Compares the program with itself in part: a file in SI and the same mechanism in other units; closed forms are formulas.
"""
import json
import math
import os
import re

import numpy as np
import pytest

import data_file
import file_units
from mech9_cases import read_table, run
from unit_runs import NAMED, SHORT, Units

@pytest.fixture
def units(checks, tmp_path):
    return Units(checks, tmp_path)


# motors, controllers, friction, compliant ends and contacts, springs, laws of time: groups that few files of the gallery have
FORCES = """
&mechanism links=4, coordinates=3 /
&structure cq=1,2,3 /
&pair coordinate=1, links=1,2, kind='revolute', axis=0,0,1 /
&pair coordinate=2, links=1,3, kind='prismatic', axis=1,0,0, point=0,0.5,0 /
&pair coordinate=3, links=3,4, kind='helical', axis=0,0,1, pitch=0.02 /
&initial coordinate=1, position=0.4, velocity=0.3 /
&initial coordinate=2, position=0.12, velocity=-0.2 /
&initial coordinate=3, position=-0.2, velocity=0.5 /
&point name='P', link=2, position=0.3,0.05,0 /
&body link=2, mass=2.0, centre=0.5,0,0.01, inertia=0.1,0.1,0.1,0,0,0 /
&body link=3, mass=3.0, centre=0,0.01,0, inertia=0.02,0.02,0.02,0,0,0 /
&body link=4, mass=1.0, centre=0.05,0.02,0, inertia=0.03,0.03,0.04,0.001,0,0 /
&gravity acceleration=0,-9.81,0 /
&load kind='coordinate', coordinate=1, stiffness=3.0, rest=0.7, damping=0.2, force=0.4 /
&load kind='coordinate', coordinate=2, stiffness=30.0, rest=0.02, damping=2.0, force=1.4 /
&load kind='spring', links=1,2, position=0.1,0.9,0, second_position=0.4,0,0, stiffness=50, free_length=0.3, damping=4 /
&load kind='force', link=3, position=0.01,0.02,0, force=3,4,5, law='harmonic', mean=1, amplitude=0.2, angular_frequency=7, phase=0.3 /
&load kind='torque', link=4, torque=0.1,0.2,0.3, frame='link' /
&motor coordinate=1, kind='dc', voltage=24, resistance=0.5, constant=0.05, inductance=0.01, gear_ratio=20 /
&motor coordinate=2, kind='pid', proportional=50, integral=8, derivative=5, limit=80, law='polynomial', coefficients=0.1,0.02,0.3 /
&motor coordinate=3, kind='pid', proportional=5, integral=0.8, derivative=0.5, setpoint=0.3 /
&friction coordinate=1, dynamic=0.2, radius=0.01, face_radius=0.015, preload=0.3, law='smooth', transition=0.1 /
&friction coordinate=2, dynamic=0.1, arm=0.05, preload=5, law='smooth', transition=0.01 /
&stop coordinate=1, low=0.45, stiffness=200, damping=3, exponent=1.5 /
&stop coordinate=2, high=0.11, stiffness=2e4, damping=30, exponent=1.5 /
&time end=0.2, intervals=8 /
&solver relative_tolerance=1e-13, absolute_tolerance=1e-15 /
"""

CONTACTS = """
&mechanism links=2, coordinates=3 /
&structure cq=1,2,3 /
&pair coordinates=1,2,3, links=1,2, kind='planar', axis=0,0,1 /
&initial coordinate=1, position=0, velocity=0.4 /
&initial coordinate=2, position=0.049, velocity=0 /
&initial coordinate=3, position=0.1, velocity=0 /
&body link=2, mass=2.0, centre=0,0,0, inertia=0.1,0.1,0.1,0,0,0 /
&point name='A', link=2, position=-0.1,0,0 /
&point name='B', link=2, position=0.1,0.001,0 /
&gravity acceleration=0,-9.81,0 /
&contact point='A', normal=0,1,0, radius=0.05, stiffness=1e6, damping=1e4, exponent=1.5 /
&contact point='B', kind='sphere', origin=0.12,-0.1,0, radius=0.05, other_radius=0.1, stiffness=1e5, damping=100 /
&time end=0.05, intervals=5 /
&solver relative_tolerance=1e-13, absolute_tolerance=1e-15 /
"""

IMPACTS = """
&mechanism links=3, coordinates=2 /
&structure cq=1,2 /
&pair coordinate=1, links=1,2, kind='prismatic', axis=0,1,0 /
&pair coordinate=2, links=1,3, kind='revolute', axis=0,0,1, point=1,0,0 /
&initial coordinate=1, position=0.2 /
&initial coordinate=2, position=0.2 /
&body link=2, mass=0.7 /
&body link=3, mass=0.7, centre=0.1,0,0 /
&gravity acceleration=0,-9.81,0 /
&stop coordinate=1, low=0, restitution=0.6 /
&stop coordinate=2, low=0, restitution=0.5 /
&output reactions=.true. /
&time end=0.7, intervals=4 /
&solver relative_tolerance=1e-13, absolute_tolerance=1e-15 /
"""

DRIVES = """
&mechanism links=9, coordinates=8 /
&structure cq=1,2 /
&pair coordinate=1, links=1,2, kind='revolute', dh=0.3,0.2,0.1,0.4 /
&pair coordinate=2, links=2,3, kind='prismatic', dh=0.1,-0.3,0.2,0.1 /
&pair coordinate=3, links=1,4, kind='revolute', axis=0,0,1 /
&pair coordinate=4, links=1,5, kind='prismatic', axis=0,0,1 /
&pair coordinate=5, links=1,6, kind='prismatic', axis=0,0,1 /
&pair coordinate=6, links=1,7, kind='revolute', axis=0,0,1 /
&pair coordinate=7, links=1,8, kind='prismatic', axis=0,1,0 /
&pair coordinate=8, links=1,9, kind='revolute', axis=0,1,0 /
&coupling kind='gear', coordinates=1,3, ratio=-2, phase=0.3 /
&coupling kind='rack', coordinates=1,4, radius=0.02, phase=0.5 /
&coupling kind='screw', coordinates=1,5, pitch=0.005 /
&coupling kind='belt', coordinates=3,6, radii=0.1,0.2 /
&coupling kind='linear', coordinates=1,2,7, coefficients=0.5,3,1, constant=0.2 /
&coupling kind='table', coordinates=2,8, file='FOLDER/table.dat' /
&initial coordinate=7, position=0.1 /
&drive coordinate=1, kind='polynomial', coefficients=0.1,2,0.3,0.05 /
&drive coordinate=2, kind='harmonic', mean=0.1, amplitude=0.03, angular_frequency=3, phase=0.2 /
&body link=3, mass=1.5, centre=0.1,0.2,0.3, inertia=0.2,0.3,0.4,0.01,0,0 /
&body link=5, mass=1.5 /
&gravity acceleration=1,-9.81,2 /
&point name='P', link=3, position=0.3,0.05,0.2 /
&friction coordinate=1, dynamic=0.2, radius=0.01 /
&output reactions=.true., drive_forces=.true., sensitivities=SENSITIVITIES, poses=.true. /
&time end=2, intervals=9 /
"""
PARAMETERS = """
&parameter name='a', sets='pair(1).dh(1)' /
&parameter name='alpha', sets='pair(1).dh(2)' /
&parameter name='r', sets='coupling(2).radius' /
&parameter name='m', sets='body(1).mass' /
&parameter name='i', sets='body(1).inertia(4)' /
&parameter name='g', sets='gravity.acceleration(2)' /
&parameter name='w', sets='drive(1).coefficients(2)' /
&parameter name='e', sets='drive(1).coefficients(3)' /
&parameter name='o', sets='drive(2).angular_frequency' /
&parameter name='x', sets='point(1).position(1)' /
&quantity name='most', of='dq1', take='max' /
&quantity name='rate', of='dq3', take='rms' /
&quantity name='way', of='dq2', take='integral' /
&quantity name='torque', of='F1', take='peak' /
&quantity name='place', of='P.x', take='min' /
"""


@pytest.mark.parametrize('text', [FORCES, CONTACTS], ids=['forces', 'contacts'])
def test_forces_with_named_units(units, mech9d, text):
    path = os.path.join(units.folder, 'forces.nml')
    with open(path, 'w', encoding='utf-8') as file:
        file.write(text)
    units.named(mech9d, path)
    units.named(mech9d, path, *SHORT)


def test_drives_and_couplings_with_named_units(units, mech9k):
    path = os.path.join(units.folder, 'drives.nml')
    np.savetxt(os.path.join(units.folder, 'table.dat'), [[q, math.sin(3 * q)] for q in np.linspace(-0.3, 0.5, 20)])
    with open(path, 'w', encoding='utf-8') as file:
        file.write(DRIVES.replace('FOLDER/', '').replace('SENSITIVITIES', '.false.'))
    units.named(mech9k, path)


def in_si(values, unit):
    return np.array(values, dtype=float) * file_units.si_of(unit)


@pytest.mark.parametrize('named', NAMED, ids=str)
def test_derivatives_and_quantities_with_named_units(units, mech9k, named):
    """Derivatives per unit of the parameter in the file, quantities, and HDF5 data sets, each by its unit."""
    h5py = pytest.importorskip('h5py')
    np.savetxt(os.path.join(units.folder, 'table.dat'), [[q, math.sin(3 * q)] for q in np.linspace(-0.3, 0.5, 20)])
    text = DRIVES.replace('FOLDER/', '').replace('SENSITIVITIES', '.true.')
    text = '\n'.join(line for line in text.splitlines() if not line.startswith('&friction'))
    found = []
    for system in (None, named):
        groups = data_file.parse(text + PARAMETERS)
        for _, items in groups:
            if 'file' in items:
                items['file'] = [os.path.join(units.folder, 'table.dat')]
        if system:
            groups = file_units.in_units(groups, system, units.folder)
        names = {name: os.path.join(units.folder, f'run{len(found)}.{name}') for name in ('nml', 'dat', 'json', 'h5')}
        with open(names['nml'], 'w', encoding='utf-8') as file:
            file.write(data_file.write(groups))
        done = run(mech9k, names['nml'], '--table', names['dat'], '--report', names['json'], '--hdf5', names['h5'], folder=units.folder)
        if not units.checks.equal(done.returncode, 0, f'{system}: {done.stderr}'):
            return
        with open(names['dat'], encoding='utf-8') as file:
            content = file.read()
        heads = file_units.head_units(content)
        rows = {name: in_si(values, heads[name]) for name, values in read_table(content).items() if name != 'closure'}
        with open(names['json'], encoding='utf-8') as file:
            quantities = {q['name']: in_si(q['value'], q['unit']) for q in json.load(file)['quantities']}
        sets = {}
        with h5py.File(names['h5']) as file:
            for name in ('velocity', 'reaction_force', 'reaction_moment', 'origin', 'vertex', 'position'):
                sets[name] = in_si(file[name][:], file[name].attrs['units'].decode() if isinstance(file[name].attrs['units'], bytes)
                                   else file[name].attrs['units'])
        found.append((rows, quantities, sets))
    for plain, other, what in zip(found[0], found[1], ('column', 'quantity', 'data set')):
        for name, values in plain.items():
            # derivatives that are zero are so but for round-off of the largest ones
            largest = max(np.max(np.abs(values)), 1e-3)
            units.checks.near(other[name], values, 1e-9 if name.startswith('d(') else 1e-11, f'{named}: {what} {name}', scale=largest)


@pytest.mark.parametrize('named', NAMED, ids=str)
def test_impulses_with_named_units(units, mech9d, named):
    """Impulses of stops in N s and N m s, and those of pairs."""
    found = []
    for system in (file_units.FileUnits(), named):
        path, report = (os.path.join(units.folder, name) for name in ('run.nml', 'run.json'))
        with open(path, 'w', encoding='utf-8') as file:
            file.write(data_file.write(file_units.in_units(data_file.parse(IMPACTS), system, units.folder)))
        done = run(mech9d, path, '--table', os.path.join(units.folder, 'run.dat'), '--report', report, folder=units.folder)
        units.checks.equal(done.returncode, 0, f'{system}: {done.stderr}')
        with open(report, encoding='utf-8') as file:
            events = json.load(file)['events']
        impacts = [event for event in events if event['kind'] == 'impact']
        units.checks.true(len(impacts) > 2, f'{system}: impacts', len(impacts))
        said = [float(words) for words in re.findall(r'is hit, impulse (\S+)', done.stderr)]
        units.checks.near(np.array(said[:5]), np.array([event['impulse'] for event in impacts[:5]]), 1e-3, f'{system}: impulses in words', scale=min(said))
        rest = run(mech9d, path, '--equilibrium', '--table', os.path.join(units.folder, 'run.dat'), folder=units.folder)
        # the stop of the slide bears its weight, and the arm hangs
        bears = [(float(number), unit) for number, unit in re.findall(r'bears (\S+) ([^;\n]+)', rest.stderr)]
        units.checks.near(np.array([x * file_units.si_of(unit.replace(' ', '_')) for x, unit in bears]), np.array([0.7 * 9.81]), 1e-4,
                          f'{system}: the force of a stop in words')
        of = {1: system.F, 2: system.F * system.L}
        found.append([[event['time'], event['number'], event['impulse'] * of[event['number']]] +
                      [x * system.F for pair in event['pairs'] for x in pair['force']] +
                      [x * system.F * system.L for pair in event['pairs'] for x in pair['moment']] for event in impacts])
    units.checks.near(np.array(found[1]), np.array(found[0]), 1e-9, f'{named}: times and impulses', scale=1.0)
    # the first impact of a mass that falls 0.2 m: m (1 + e) v
    first = next(event for event in found[1] if event[1] == 1)
    units.checks.near(first[2], 0.7 * 1.6 * math.sqrt(2 * 9.81 * 0.2), 1e-9, f'{named}: the impulse of a fall')


def table_of_text(units, program, text):
    path, table = (os.path.join(units.folder, name) for name in ('closed.nml', 'closed.dat'))
    with open(path, 'w', encoding='utf-8') as file:
        file.write(text)
    done = run(program, path, '--table', table, folder=units.folder)
    units.checks.equal(done.returncode, 0, done.stderr)
    with open(table, encoding='utf-8') as file:
        content = file.read()
    return read_table(content), file_units.head_units(content)


def test_free_fall_in_inches(units, mech9d):
    """Half g t^2 in inches, with g in in/s^2; the weight of a pound is 1 lbf, its fall has the energy weight times height."""
    g = 9.80665 / 0.0254
    rows, heads = table_of_text(units, mech9d, f"""
&mechanism length_unit='in', force_unit='lbf', mass_unit='lb' /
&structure cq=1 /
&pair coordinate=1, links=1,2, kind='prismatic', axis=0,1,0 /
&initial coordinate=1, position=0 /
&body link=2, mass=1 /
&gravity acceleration=0,-{g!r},0 /
&time end=0.5, intervals=5 /
""")
    t = rows['t']
    units.checks.near(rows['q1'], -0.5 * g * t ** 2, 1e-9, 'the fall', scale=np.max(g * t))
    units.checks.near(rows['ddq1'], -g + 0 * t, 1e-12, 'its acceleration', scale=g)
    units.checks.near(rows['E.kinetic'], 0.5 * g * t ** 2, 1e-8, 'a pound times its way, in lbf in', scale=np.max(g * t))
    units.checks.equal([heads[name] for name in ('q1', 'dq1', 'ddq1', 'E.kinetic')], ['in', 'in/s', 'in/s^2', 'lbf_in'], 'heads')


def test_small_oscillation_in_tonnes(units, mech9d):
    """A spring of k kN/mm and a mass of m t: x = a cos(w t), w^2 = k/m in 1e6/s^2; a disc with stiffness per rad and degrees."""
    rows, heads = table_of_text(units, mech9d, """
&mechanism length_unit='mm', force_unit='kN', mass_unit='t', angle_unit='deg', rate_unit='rpm' /
&structure cq=1,2 /
&pair coordinate=1, links=1,2, kind='prismatic', axis=1,0,0 /
&pair coordinate=2, links=1,3, kind='revolute', axis=0,0,1 /
&body link=2, mass=2 /
&body link=3, mass=0, inertia=0,0,50,0,0,0 /
&initial coordinate=1, position=3, velocity=0 /
&initial coordinate=2, position=0, velocity=10 /
&load kind='coordinate', coordinate=1, stiffness=0.008 /
&load kind='coordinate', coordinate=2, stiffness=0.45 /
&time end=0.4, intervals=8 /
&solver relative_tolerance=1e-12, absolute_tolerance=1e-13 /
""")
    t = rows['t']
    w = math.sqrt(0.008e6 / 2e3)
    units.checks.near(rows['q1'], 3 * np.cos(w * t), 1e-9, 'the slide', scale=3.0)
    w = math.sqrt(0.45 / (50e3 * 1e-6))            # kN mm = N m; t mm^2 = 1e-3 kg m^2
    units.checks.near(rows['dq2'], 10 * np.cos(w * t), 1e-9, 'the disc in rpm', scale=10.0)
    units.checks.near(rows['q2'], 60 / w * np.sin(w * t), 1e-9, 'the disc in degrees', scale=10.0)
    units.checks.equal([heads[name] for name in ('q1', 'dq2', 'ddq2', 'E.total')], ['mm', 'rpm', 'deg/s^2', 'kN_mm'], 'heads')


def test_crank_in_rpm(units, mech9k):
    """A crank of r mm at n rpm: its angle 6 n t in degrees, its pin r w^2 in mm/s^2; the torque against gravity in N mm."""
    rows, heads = table_of_text(units, mech9k, """
&mechanism length_unit='mm', angle_unit='deg', mass_unit='g', rate_unit='rpm' /
&structure cq=1 /
&pair coordinate=1, links=1,2, kind='revolute', axis=0,0,1 /
&point name='P', link=2, position=80,0,0 /
&body link=2, mass=500, centre=40,0,0 /
&gravity acceleration=0,-9810,0 /
&drive coordinate=1, kind='polynomial', coefficients=10,3000 /
&output drive_forces=.true. /
&time end=0.01, intervals=5 /
""")
    t, w = rows['t'], 100 * math.pi
    angle = math.radians(10) + w * t
    units.checks.near(rows['q1'], np.degrees(angle), 1e-12, 'the angle', scale=200.0)
    units.checks.near(rows['dq1'], 3000 + 0 * t, 1e-12, 'the rate', scale=3000.0)
    units.checks.near(rows['P.ax'], -80 * w * w * np.cos(angle), 1e-11, 'the acceleration of the pin', scale=80 * w * w)
    units.checks.near(rows['F1'], 0.5 * 9.81 * 40 * np.cos(angle), 1e-9, 'the torque in N mm', scale=200.0)
    units.checks.equal([heads[name] for name in ('dq1', 'P.ax', 'F1')], ['rpm', 'mm/s^2', 'N_mm'], 'heads')
