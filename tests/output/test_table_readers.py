"""Tables and files of comma-separated values as their readers see them: numpy, pandas and gnuplot.

All must see the same numbers, to the last bit: 17 digits are enough for that.
"""
import os

import numpy as np
import pytest

from mech9_cases import REFERENCE, read_table, run, text_of

FIG1 = os.path.join(REFERENCE, 'kinematics_fig1.nml')


@pytest.fixture(scope='module')
def tables(build, tmp_path_factory):
    """The table of a run and the two files that hold it."""
    folder = tmp_path_factory.mktemp('tables')
    plain, commas = os.path.join(folder, 'run.dat'), os.path.join(folder, 'run.csv')
    for path in (plain, commas):
        done = run(build.program('mech9k'), FIG1, '--table', path, folder=folder)
        assert done.returncode == 0, f'{os.path.basename(path)} is written; stderr: {done.stderr}'
    return read_table(text_of(plain)), plain, commas


def test_numpy(checks, tables):
    table, plain, commas = tables
    names = list(table)
    values = np.column_stack([table[name] for name in names])
    # names of points hold a dot, which numpy would take out
    found = np.genfromtxt(plain, names=True, skip_header=len(list(comments(plain))), deletechars='')
    checks.equal(list(found.dtype.names), names, 'numpy: the names of a table')
    checks.true(np.array_equal(np.loadtxt(plain, skiprows=1 + len(list(comments(plain)))), values), 'numpy: a table')
    checks.true(np.array_equal(np.loadtxt(commas, delimiter=',', skiprows=1), values), 'numpy: commas')
    found = np.genfromtxt(commas, delimiter=',', names=True, deletechars='')
    checks.equal(list(found.dtype.names), names, 'numpy: the names with commas')


def comments(path):
    with open(path, encoding='utf-8') as file:
        return [line for line in file if line.startswith('#')]


def test_pandas(checks, tables):
    table, plain, commas = tables
    try:
        import pandas
    except ImportError:
        checks.left_out('pandas is not installed (Debian: python3-pandas)')
        return
    for path, how in ((plain, {'comment': '#', 'sep': r'\s+'}), (commas, {})):
        # the quick conversion of pandas is wrong in the last bit
        found = pandas.read_csv(path, float_precision='round_trip', **how)
        checks.equal(list(found.columns), list(table), f'pandas: the names in {os.path.basename(path)}')
        for name in table:
            checks.true(np.array_equal(found[name].to_numpy(), table[name]), f'pandas: {name} in {os.path.basename(path)}')


def test_gnuplot(checks, tables, tmp_path):
    table, plain, commas = tables
    if not checks.has('gnuplot', 'gnuplot-nox'):
        return
    for path, before in ((plain, ''), (commas, "set datafile separator ','\n")):
        script = tmp_path / 'points.gp'
        script.write_text(f"{before}set table 'points.txt'\nset key autotitle columnheader\nset format '%.17g'\n"
                          f"plot '{path}' using 't':'q3'\n", encoding='utf-8')
        done = run('gnuplot', script, folder=tmp_path)
        checks.equal(done.returncode, 0, f'gnuplot reads {os.path.basename(path)}: {done.stderr}')
        points = np.loadtxt(tmp_path / 'points.txt', usecols=(0, 1), comments='#')
        checks.true(np.array_equal(points[:, 0], table['t']), f'gnuplot: t in {os.path.basename(path)}')
        checks.true(np.array_equal(points[:, 1], table['q3']), f'gnuplot: q3 in {os.path.basename(path)}')
