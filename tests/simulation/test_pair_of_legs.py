"""The pair of legs of bench/data: its freedoms by counting, and its fall against equations of its own in extended precision.

Its 36 revolute pairs close 6 chains. Four of them have parallel axes, and each repeats three equations. The positions of its steps stand
against extended precision in tests/kinematics/test_accuracy.py.

Compares the program with itself: the legs by other independent coordinates."""
import os
import re

import numpy as np
import pytest

import data_file
import pair_of_legs
from mech9_cases import REFERENCE, TREE, read_csv, run, table_and_report, table_of, text_of

STEP, FALL = (os.path.join(TREE, 'bench', 'data', f'legs_{kind}.nml') for kind in ('step', 'fall'))
FREEDOMS = 6 * 30 - 5 * 36 + 4 * 3


@pytest.mark.parametrize('kind, path', [('step', STEP), ('fall', FALL)])
def test_files(checks, kind, path):
    checks.equal(text_of(path), pair_of_legs.data_file(kind), f'{path} is what the script writes')


@pytest.mark.parametrize('path', [STEP, FALL], ids=['step', 'fall'])
def test_freedoms(checks, mech9k, mech9d, path, tmp_path):
    done = run(mech9k if path == STEP else mech9d, path, '--check', folder=tmp_path)
    checks.equal(done.returncode, 0, 'the legs can be assembled')
    checks.true(f'mobility by the rank: {FREEDOMS} = 36 coordinates - rank 24' in done.stdout, 'the count of freedoms', done.stdout)
    ranks = re.findall(r'equations, rank (\d+)', done.stdout)
    # two planar chains of a leg have three equations each, and the chain through its foot has six
    checks.equal(sum(map(int, ranks)), 2 * (3 + 3 + 6), 'the ranks of all blocks')


def test_straight_legs(checks, mech9k, mech9d, tmp_path):
    """With straight legs no servo moves a foot up or down; the way of the servos through this position is unique."""
    path = tmp_path / 'straight.nml'
    path.write_text(re.sub(r'mean=-?[\d.]+', 'mean=0', re.sub(r'position=-?[\d.]+', 'position=0', text_of(STEP))), encoding='utf-8')
    table, report = table_and_report(mech9k, path)
    checks.equal(report['exit_code'], 0, 'steps through straight legs')
    checks.true(report['largest_closure'] < 1e-15, 'all chains closed to round-off of 0.2 m', report['largest_closure'])
    path.write_text(re.sub(r'position=-?[\d.]+', 'position=0', text_of(FALL)), encoding='utf-8')
    table, report = table_and_report(mech9d, path)
    checks.true(report['largest_energy_change'] < 1e-12, 'the energy stays', report['largest_energy_change'])
    # the legs are mirror images of each other, and fall as such; motions from rest double their differences a few times
    for letter, sign in (('x', 1), ('y', -1), ('z', 1)):
        checks.near(table[f'right_toe.{letter}'], sign * table[f'left_toe.{letter}'], 1e-9, f'toes: {letter}')


def test_rounded_axes(checks, mech9k, tmp_path):
    """Models in single precision have axes that are nearly parallel: the message names the tolerance with which the legs move."""
    text = re.sub(r"(name='RO_crank'.*axis=-0.28,-0.96,)0", r'\g<1>2e-8', text_of(STEP))
    path = tmp_path / 'rounded.nml'
    path.write_text(text, encoding='utf-8')
    done = run(mech9k, path, '--check', folder=tmp_path)
    checks.true(done.returncode in (4, 5), 'an axis that is not parallel locks its chain', done.returncode)
    checks.true('the axis of pair 35 (RO_crank) is not parallel' in done.stderr, 'the axis', done.stderr)
    found = re.search('allow for their error with &mechanism (data_tolerance=1e-7)', done.stderr)
    if checks.true(found is not None, 'the remedy', done.stderr):
        done = run(mech9k, path, '--check', '--set', f'mechanism.{found.group(1)}', folder=tmp_path)
        checks.equal(done.returncode, 0, 'the remedy helps')
        checks.true(f'mobility by the rank: {FREEDOMS} ' in done.stdout, 'all freedoms', done.stdout)


@pytest.mark.parametrize('tolerance, limit', [(1e-6, 1e-5), (1e-10, 1e-9), (1e-13, 1e-12)])
def test_fall(checks, mech9d, tolerance, limit):
    reference = read_csv(os.path.join(REFERENCE, 'legs_fall.csv'))
    table, report = table_and_report(mech9d, FALL, '--set', f'solver.relative_tolerance={tolerance!r}', '--set',
                                     f'solver.absolute_tolerance={tolerance!r}', '--set', 'time.intervals=20')
    checks.near(table['t'], reference['t'], 1e-15, 'the times')
    for column in reference:
        # an integrator errs by some two hundred steps times the tolerance at most; toes are 0.3 m from the hip and move with up to 3 m/s
        checks.near(table[column], reference[column], limit, f'tolerance {tolerance:.0e}: {column}', scale=1.0)
    checks.true(report['largest_closure'] < 1e-14, 'closed to round-off', report['largest_closure'])
    # rates of the energy by coordinates are weights times lengths, 2 N m and less
    checks.true(report['largest_energy_change'] < max(1e-13, limit), 'the energy stays', report['largest_energy_change'])


@pytest.mark.parametrize('others', [{2: 3, 7: 8}, {1: 10, 6: 15}, {11: 17, 19: 28, 24: 33, 29: 30}])
def test_other_coordinates(checks, mech9d, tmp_path, others):
    """Other independent coordinates from the same start have the same motion."""
    options = ('--set', 'solver.relative_tolerance=1e-11', '--set', 'solver.absolute_tolerance=1e-11')
    table = table_of(mech9d, FALL, *options)
    groups = data_file.parse(text_of(FALL))
    independent = [others.get(k, k) for k in next(items['cq'] for group, items in groups if group == 'structure')]
    text = re.sub('cq=.*/', f'cq={",".join(map(str, independent))} /', re.sub('&initial.*/\n', '', text_of(FALL)))
    text += ''.join(f'&initial coordinate={k}, position={float(table[f"q{k}"][0])!r}'
                    f'{", velocity=0" if k in independent else ""} /\n' for k in range(1, 37))
    path = tmp_path / 'others.nml'
    path.write_text(text, encoding='utf-8')
    same = table_of(mech9d, path, *options)
    for column in (name for name in table if re.match(r'q\d|\w+_toe\.[xyz]$', name)):
        checks.near(same[column], table[column], 1e-8, f'{column} with {others}')


def test_reference(checks):
    """The reference tells its own errors: gaps of pairs, which nothing corrects, and the change of energy."""
    words = text_of(os.path.join(REFERENCE, 'legs_fall.csv')).splitlines()[-1]
    freedoms, gap, energy = re.fullmatch(r'# (\d+) freedoms, \d+ steps; at the end the largest gap is (\S+), the change of energy (\S+) J', words).groups()
    checks.equal(int(freedoms), FREEDOMS, 'freedoms by another count of equations')
    checks.true(float(gap) < 1e-15 and abs(float(energy)) < 1e-15, 'errors of the reference', words)
    checks.true(np.isfinite(float(energy)), 'a number', energy)
