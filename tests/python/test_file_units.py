"""The package with mechanisms whose files name units: names of units, arrays, numbers, positions, simulations, studies.

Compares the program with itself: one mechanism in SI and in other units; closed forms are formulas.
"""
import math

import numpy as np
import pytest

import data_file
import file_units
from four_bars import SPRUNG
from unit_runs import NAMED

FOUR_BAR = SPRUNG + """&load kind='force', link=3, position=0.1,0.2,0, force=1,2,0 /
&quantity name='reach', of='P.x', take='max' /
&quantity name='speed', of='dq4', take='rms' /
"""
DRIVE = "&drive coordinate=1, kind='polynomial', coefficients=0.4, 5 /\n"
START = '&initial coordinate=1, position=0.4, velocity=0.5 /\n'
SI = file_units.FileUnits()


def mechanism(mech9, text, units, folder):
    return mech9.read_text(data_file.write(file_units.in_units(data_file.parse(text), units, folder)))


def si(results, name):
    return results[name] * file_units.si_of(results.units[name].replace(' ', '_'))


def near(found, expected, tolerance=1e-10):
    found, expected = np.asarray(found), np.asarray(expected)
    assert found.shape == expected.shape
    assert np.max(np.abs(found - expected)) <= tolerance * max(np.max(np.abs(expected)), 1e-3)


@pytest.fixture(params=NAMED, ids=str)
def both(request, mech9, tmp_path):
    """The four-bar in SI and in other units, with these: driven, and free."""
    return {driven: [mechanism(mech9, FOUR_BAR + (DRIVE if driven else START), units, tmp_path) for units in (SI, request.param)]
            for driven in (True, False)}, request.param


def test_runs_and_names_of_units(both):
    pairs, units = both
    words = units.words
    for driven, (plain, other) in pairs.items():
        runs = [m.kinematics(end=0.4, intervals=8, reactions=True) if driven else
                m.dynamics(end=0.4, intervals=8, reactions=True, relative_tolerance=1e-12, absolute_tolerance=1e-13) for m in (plain, other)]
        assert runs[0].names == runs[1].names
        for name in runs[0].names:
            if name != 'closure':
                near(si(runs[1], name), si(runs[0], name), 1e-7)
        assert runs[1].units['q1'] == words['angle_unit'] and runs[1].units['dq1'] == words.get('rate_unit', words['angle_unit'] + '/s')
        assert runs[1].units['P.x'] == words['length_unit'] and runs[1].units['P.ax'] == words['length_unit'] + '/s^2'
        assert runs[1].units['R1.fx'] == words['force_unit'] and runs[1].units['R1.mz'] == f"{words['force_unit']} {words['length_unit']}"
        assert runs[1].quantity_units['reach'] == words['length_unit']
        near(runs[1].quantities['reach'] * units.L, runs[0].quantities['reach'])
        near(runs[1].quantities['speed'] * units.r, runs[0].quantities['speed'], 1e-8)


def test_numbers_by_names(both):
    pairs, units = both
    plain, other = pairs[True]
    near(other['pair(2).point(1)'], 0.3 / units.L)
    near(other['body(2).mass'], 2.5 / units.M)
    near(other['drive(1).coefficients(2)'], 5 / units.r)
    plain['pair(2).point(1)'], other['pair(2).point(1)'] = 0.28, 0.28 / units.L
    near(si(other.kinematics(end=0.4, intervals=4), 'P.y'), si(plain.kinematics(end=0.4, intervals=4), 'P.y'))
    changed = other.with_(**{'gravity.acceleration(2)': -1.62 / units.L})
    near(changed['gravity.acceleration(2)'], -1.62 / units.L)


def test_positions_rates_and_accelerations(both):
    pairs, units = both
    plain, other = pairs[True]
    q, dq, ddq = np.linspace(-1, 3, 7), np.linspace(2, 5, 7), np.linspace(-3, 1, 7)
    near(other.positions(q / units.a) * units.a, plain.positions(q))
    near(other.rates(q / units.a, dq / units.r) * units.r, plain.rates(q, dq))
    near(other.accelerations(q / units.a, dq / units.r, ddq / units.a) * units.a, plain.accelerations(q, dq, ddq), 1e-9)
    ends = [m.range() for m in (plain.with_(**{'pair(2).point(1)': 0.8}), other.with_(**{'pair(2).point(1)': 0.8 / units.L}))]
    near(ends[1]['lower'] * units.a, ends[0]['lower'], 1e-8)
    found = [m.assemblies(30) for m in (plain, other)]
    near(found[1]['q4'] * units.a, found[0]['q4'], 1e-9)


def test_simulations(both):
    """Coordinates in units of the file; mass matrix, bias and state in SI."""
    pairs, units = both
    tight = {'relative_tolerance': 1e-12, 'absolute_tolerance': 1e-13}
    with pairs[False][0].simulation(**tight) as plain, pairs[False][1].simulation(**tight) as other:
        for t in (0.1, 0.2):
            plain.set('load(2).force(1)', 7.0)
            other.set('load(2).force(1)', 7.0 / units.F)
            plain.advance(t)
            other.advance(t)
            near(other.q * units.a, plain.q, 1e-8)
            near(other.dq * units.r, plain.dq, 1e-8)
            near(other.ddq * units.a, plain.ddq, 1e-7)
            near(other.mass_matrix(), plain.mass_matrix(), 1e-8)
            near(other.bias(), plain.bias(), 1e-7)
            near(other.state(), plain.state(), 1e-8)
    many = pairs[False][1].simulations(3, **tight)
    many.set('load(2).force(1)', np.array([0.0, 7.0, 9.0]) / units.F)
    many.advance(0.1)
    with pairs[False][0].simulation(**tight) as plain:
        plain.set('load(2).force(1)', 7.0)
        plain.advance(0.1)
        near(many.q[1] * units.a, plain.q, 1e-8)


def test_gradients_and_functions(both):
    pairs, units = both
    functions = [m.function(['pair(2).point(1)', 'drive(1).coefficients(2)'], ['reach', 'speed']) for m in pairs[True]]
    x, sizes, of = np.array([0.29, 4.0]), np.array([units.L, units.r]), np.array([units.L, units.r])
    near(functions[1](x / sizes) * of, functions[0](x), 1e-8)
    plain, other = functions[0].jacobian(x), functions[1].jacobian(x / sizes)
    near(other * of[:, None] / sizes, plain, 1e-6)


def test_studies(both):
    pytest.importorskip('xarray')
    pairs, units = both
    plain, other = pairs[True]
    lengths = np.array([0.26, 0.3, 0.33])
    found = [m.study(**{'pair(2).point(1)': lengths / size}) for m, size in ((plain, 1.0), (other, units.L))]
    near(found[1]['reach'].to_numpy() * units.L, found[0]['reach'].to_numpy(), 1e-9)
    assert found[1]['reach'].attrs['units'] == units.words['length_unit']


def test_rest(both):
    pairs, units = both
    plain, other = pairs[False]
    rest = [m.equilibrium() for m in (plain, other)]
    near(rest[1]['q4'] * units.a, rest[0]['q4'], 1e-8)
    modes = [m.modes() for m in (plain, other)]
    near(modes[1]['frequency'], modes[0]['frequency'], 1e-7)
    linear = [m.linear() for m in (plain, other)]
    near(linear[1].second_order.M, linear[0].second_order.M, 1e-7)
    near(linear[1].second_order.K, linear[0].second_order.K, 1e-6)


def test_crank_in_millimetres(mech9):
    """A crank of 80 mm at 3000 rpm: r w^2 in mm/s^2, the torque against the weight of 500 g in kN mm."""
    m = mech9.Mechanism()
    m.add('mechanism', length_unit='mm', angle_unit='deg', mass_unit='g', force_unit='kN', rate_unit='rpm')
    m.add('structure', cq=1).add('pair', coordinate=1, links=(1, 2), kind='revolute', axis=(0, 0, 1))
    m.add('point', name='P', link=2, position=(80, 0, 0)).add('body', link=2, mass=500, centre=(40, 0, 0))
    m.add('gravity', acceleration=(0, -9810, 0)).add('drive', coordinate=1, kind='polynomial', coefficients=(10, 3000))
    r = m.kinematics(end=0.01, intervals=5, drive_forces=True)
    angle, w = math.radians(10) + 100 * math.pi * r.t, 100 * math.pi
    near(r['P.ax'], -80 * w * w * np.cos(angle))
    near(r['F1'], 0.5 * 9.81 * 40 * np.cos(angle) / 1000)
    assert [r.units[name] for name in ('q1', 'dq1', 'P.ax', 'F1')] == ['deg', 'rpm', 'mm/s^2', 'kN mm']
    assert '80' in m.text() and 'length_unit' in m.text()
