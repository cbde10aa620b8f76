"""Chains whose dimensions are not those of a mechanism that moves: no run ends with exit code 0 and open chains."""
import os
import re

import numpy as np
import pytest

from mech9_cases import TREE, read_table, run, text_of

DONE, DATA, STRUCTURE, SINGULAR = 0, 3, 4, 6
SIZE = np.hypot(2.0, 0.5)              # the largest distance of two pairs of one link: the bearings
SMALL = 1e-4                           # error of a dimension [m]

# the double Hooke's joint, overconstrained, of size 2.06 m
HOOKE = os.path.join(TREE, 'examples', 'double_hooke', 'double_hooke.nml')
WRONG = ('--set', f'pair(4).point=1,{0.5 - SMALL},0')


def closures(path):
    return read_table(text_of(path))['closure']


@pytest.fixture(params=['mech9k', 'mech9d'])
def program(request, build):
    return build.program(request.param)


@pytest.fixture
def data(program, mech9k, tmp_path):
    """The path of the data file for the program."""
    if program == mech9k:
        return HOOKE
    text = '\n'.join(line for line in text_of(HOOKE).splitlines() if not line.startswith(('&drive', '&output')))
    path = tmp_path / 'dynamic.nml'
    path.write_text(text + '\n&initial coordinate=1, position=0, velocity=6.283185307179586 /\n'
                    '&body link=4, mass=1, centre=0.5,0.25,0, inertia=0.01,0.01,0.01,0,0,0 /\n'
                    '&body link=2, mass=1, centre=0,0,0, inertia=0.01,0.01,0.01,0,0,0 /\n', encoding='utf-8')
    return path


def test_exact_dimensions(checks, program, data, tmp_path):
    table = tmp_path / 'open.dat'
    done = run(program, data, '--table', table, folder=tmp_path)
    checks.equal(done.returncode, DONE, 'exact dimensions move')
    # closed to some units of round-off in each of six steps
    checks.true(np.max(closures(table)) < 1e-13 * SIZE, 'exact dimensions close to round-off')


@pytest.mark.parametrize('more', [[], ['--check']], ids=['run', 'check'])
def test_wrong_dimension_locks_the_chain(checks, program, data, tmp_path, more):
    table = tmp_path / 'open.dat'
    done = run(program, data, *WRONG, '--table', table, *more, folder=tmp_path)
    checks.equal(done.returncode, STRUCTURE, f'a dimension that is {SMALL} m off locks the chain')
    checks.true('closed chain 1 does not move' in done.stderr and 'data_tolerance=1e-4' in done.stderr,
                'the chain and a remedy are named', done.stderr)
    checks.true(not os.path.exists(table), 'nothing is written')
    told = re.search(r'about (\S+) \(rad, or parts of the size\) from', done.stderr)
    # a mechanism that moves may be nearer than the exact one, by errors of other dimensions
    checks.true(told and 0.1 < float(told.group(1)) / (SMALL / SIZE) <= 1.0, 'how far it is from one that moves', done.stderr)


def test_wrong_dimension_that_is_allowed_for(checks, program, data, tmp_path):
    table = tmp_path / 'open.dat'
    done = run(program, data, *WRONG, '--set', 'mechanism.data_tolerance=1e-4', '--table', table, folder=tmp_path)
    checks.equal(done.returncode, DONE, f'the error is allowed for: {done.stderr}')
    gap = np.max(closures(table))
    checks.true(1e-7 < gap <= 1e-4 * SIZE, 'the closure column says by how much chains are open', str(gap))


def test_chain_that_opens_on_the_way(checks, program, data, tmp_path):
    """The error is allowed for near the start only: the rows up to there are kept."""
    table = tmp_path / 'open.dat'
    done = run(program, data, *WRONG, '--set', 'mechanism.data_tolerance=1e-6', '--table', table, folder=tmp_path)
    checks.equal(done.returncode, SINGULAR, f'chains that open on the way end the run: {done.stderr}')
    kept = closures(table)
    checks.true(0 < len(kept) < 121 and np.max(kept) <= 1e-6 * SIZE, 'rows are closed as far as is allowed')


def test_tolerance_that_is_no_error_of_dimensions(checks, mech9k, tmp_path):
    done = run(mech9k, HOOKE, '--set', 'mechanism.data_tolerance=0.01', folder=tmp_path)
    checks.equal(done.returncode, DATA, 'more than 1e-3 is not an error of dimensions')
    checks.true('data_tolerance is at most 1e-3' in done.stderr, 'and is told so', done.stderr)


def test_dimension_that_is_far_off(checks, mech9k, tmp_path):
    """A centimetre: no mechanism that moves is near."""
    done = run(mech9k, HOOKE, '--set', 'pair(6).point=1.5,0.51,0', folder=tmp_path)
    checks.equal(done.returncode, STRUCTURE, 'a bearing a centimetre off its place')
    checks.true('check the points and directions' in done.stderr, 'and no tolerance is advised', done.stderr)
