"""Studies and gradients of the gallery: the draw latch against its closed form and the propagation of errors, Jansen's leg over its grid, and
hard points that move together; the energy of SUNDIALS' slider-crank.
"""
import json
import os

import numpy as np
import pytest

from gallery_list import EXAMPLES
from mech9_cases import read_table, run


def gradients(program, folder, name, *options):
    """Values of the quantities of an example, and their derivatives by name."""
    report = os.path.join(folder, 'report.json')
    done = run(program, os.path.join(EXAMPLES, name, f'{name}.nml'), '--quiet', '--no-write', '--report', report,
               '--set', 'output.gradients=.true.', *options)
    if done.returncode != 0:
        raise RuntimeError(done.stderr)
    with open(report, encoding='utf-8') as file:
        told = json.load(file)['quantities']
    return ({one['name']: one['value'] for one in told},
            {one['name']: {by['parameter']: by['value'] for by in one['gradient']} for one in told})


def study(program, name):
    done = run(program, os.path.join(EXAMPLES, name, f'{name}.nml'), '--quiet', '--study', '--table', '-')
    if done.returncode != 0:
        raise RuntimeError(done.stderr)
    return read_table(done.stdout)


def test_draw_latch(checks, tmp_path, mech9k):
    """Its derivatives by closed form, and the scatter that they propagate."""
    values = np.array([0.018, 0.052, 0.003, 193.0], dtype=complex)
    deviations = np.array([5e-5, 1e-4, 5e-5, 0.5])

    def held(lever, bail, height, stop):
        angle = stop * np.pi / 180
        return lever * np.cos(angle) + np.sqrt(bail**2 - (lever * np.sin(angle) - height)**2)

    expected = np.array([held(*(values + 1e-30j * np.eye(4)[i])).imag / 1e-30 for i in range(4)])
    _, found = gradients(mech9k, tmp_path, 'draw_latch')
    mine = np.array([found['held'][name] for name in ('lever', 'bail', 'height', 'stop')])
    checks.near(mine, expected, 1e-12, 'the derivatives of the place of the hook')
    # lever and bail in line with the guide's end of the bail: (bail - lever)^2 = x^2 + height^2
    long = np.sqrt(0.034**2 - 0.003**2)
    least = np.array([found['least'][name] for name in ('lever', 'bail', 'height', 'stop')])
    checks.near(least, np.array([-0.034 / long, 0.034 / long, -0.003 / long, 0]), 1e-8, 'those at the dead centre')
    rows = study(mech9k, 'draw_latch')
    first_order = np.sqrt(((expected * deviations)**2).sum())
    # 2000 runs: standard error 1.6 per cent, less in a Latin hypercube
    checks.near(rows['held'].std() / first_order, 1.0, 0.03, 'the scatter is that of first order')
    checks.near(rows['held'].mean(), held(*values).real, 1e-4, 'the mean is the value of the mean dimensions')


def test_stride_of_jansens_leg_over_its_grid(checks, tmp_path, mech9k):
    values, _ = gradients(mech9k, tmp_path, 'jansen_stride')
    rows = study(mech9k, 'jansen_stride')
    checks.equal(len(rows['run']), 63, 'the grid')
    own = np.flatnonzero((np.abs(rows['crank'] - 15) < 1e-9) & (np.abs(rows['rod'] - 61.9) < 1e-9))
    for name in ('stride', 'height'):
        # the same leg, assembled from values that differ by round-off
        checks.near(rows[name][own], values[name], 1e-9, f'{name} of Jansen\'s own leg', scale=1.0)
    failed = rows['exit_code'] != 0
    checks.true(set(rows['exit_code'][failed]) == {6}, 'dead points', rows['exit_code'])
    checks.true(bool(np.isnan(rows['stride'][failed]).all()), 'legs that cannot turn have no stride')
    for crank in set(rows['crank']):
        of_crank = rows['crank'] == crank
        checks.true(bool((np.diff(failed[of_crank].astype(int)) >= 0).all()), f'crank {crank}: too long a rod jams')
        checks.true(bool((np.diff(rows['height'][of_crank & ~failed]) > 0).all()), f'crank {crank}: longer rods lift the foot higher')


@pytest.mark.parametrize('name', ('toe', 'camber'))
def test_a_suspension_that_is_higher_as_a_whole(checks, tmp_path, mech9k, name):
    """It is the same."""
    _, found = gradients(mech9k, tmp_path, 'wishbone_points')
    by = found[name]
    heights = [by[point] for point in ('lower_bushings', 'upper_bushings', 'lower_ball', 'upper_ball', 'rack', 'tie_rod')]
    checks.near(sum(heights) / max(map(abs, heights)), 0.0, 1e-9, f'{name}: a suspension that is higher as a whole is the same')


def test_the_rack_matters_most_to_toe(checks, tmp_path, mech9k):
    _, found = gradients(mech9k, tmp_path, 'wishbone_points')
    checks.true(abs(found['toe']['rack']) > 4 * abs(found['toe']['upper_bushings']), 'toe: the rack matters most')


def test_energy_of_the_slider_crank_of_sundials(checks, tmp_path, mech9d):
    """Published: G = 3.33662 at a tolerance of 1e-6, and derivatives by k and c with five digits."""
    values, found = gradients(mech9d, tmp_path, 'sundials_sensitivity')
    checks.true(abs(values['G'] - 3.3366157997761721) <= 2e-5, 'the integral of the energy', values['G'])
    for number, (name, published) in enumerate((('k', 0.33345), ('c', -0.36375)), 1):
        checks.true(abs(found['G'][name] - published) <= 1e-5, f'its derivative by {name} is the published one', found['G'][name])
        above, below = (gradients(mech9d, tmp_path, 'sundials_sensitivity', '--set', f'parameter({number}).value={value}')[0]['G']
                        for value in (1.001, 0.999))
        # central differences err by some 1e-7 of second order, and by tolerances of 1e-10 over steps of 1e-3
        checks.true(abs((above - below) / 0.002 - found['G'][name]) <= 1e-6, f'and that of runs beside by {name}', (above - below) / 0.002)
