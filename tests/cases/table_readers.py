"""Tables and files of comma-separated values as their readers see them: numpy, pandas and gnuplot.

usage: table_readers.py MECH9K

All must see the same numbers, to the last bit: 17 digits are enough for that.
"""
import os
import sys
import tempfile

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), '..', 'scripts'))
import numpy as np

from mech9_cases import REFERENCE, Checks, read_table, run, text_of

FIG1 = os.path.join(REFERENCE, 'kinematics_fig1.nml')


def test_numpy(checks, table, plain, commas):
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


def test_pandas(checks, table, plain, commas):
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


def test_gnuplot(checks, table, plain, commas, folder):
    if not checks.has('gnuplot', 'gnuplot-nox'):
        return
    for path, before in ((plain, ''), (commas, "set datafile separator ','\n")):
        script = os.path.join(folder, 'points.gp')
        with open(script, 'w', encoding='utf-8') as file:
            file.write(f"{before}set table 'points.txt'\nset key autotitle columnheader\nset format '%.17g'\n"
                       f"plot '{path}' using 't':'q3'\n")
        done = run('gnuplot', script, folder=folder)
        checks.equal(done.returncode, 0, f'gnuplot reads {os.path.basename(path)}: {done.stderr}')
        points = np.loadtxt(os.path.join(folder, 'points.txt'), usecols=(0, 1), comments='#')
        checks.true(np.array_equal(points[:, 0], table['t']), f'gnuplot: t in {os.path.basename(path)}')
        checks.true(np.array_equal(points[:, 1], table['q3']), f'gnuplot: q3 in {os.path.basename(path)}')


def main():
    program, checks = os.path.abspath(sys.argv[1]), Checks()
    with tempfile.TemporaryDirectory() as folder:
        plain, commas = os.path.join(folder, 'run.dat'), os.path.join(folder, 'run.csv')
        for path in (plain, commas):
            done = run(program, FIG1, '--table', path, folder=folder)
            checks.equal(done.returncode, 0, f'{os.path.basename(path)} is written; stderr: {done.stderr}')
        table = read_table(text_of(plain))
        test_numpy(checks, table, plain, commas)
        test_pandas(checks, table, plain, commas)
        test_gnuplot(checks, table, plain, commas, folder)
    checks.finish()


main()
