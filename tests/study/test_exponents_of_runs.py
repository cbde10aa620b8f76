"""Lyapunov exponents of the runs of a study, over a parameter and over starts, against roots, and against an integration in numpy; what is
refused.

Compares the program with itself: a study by one thread and by two."""
import json

import h5py
import numpy as np
import pytest

from mech9_cases import read_table, run

SLIDER = """&structure cq=1 /
&pair coordinate=1, links=1,2, kind='prismatic', axis=1,0,0 /
&body link=2, mass=1 /
&initial coordinate=1, position=0.3, velocity=0.4 /
&load kind='coordinate', coordinate=1, stiffness=4, damping=5 /
&time end=60, intervals=3 /
&exponents transient=20 /
&parameter name='d', sets='load.damping', low=4.5, high=6, count=4 /
&study kind='grid', exponents=2 /
"""
# the driven pendulum of Baker and Gollub
PENDULUM = """&structure cq=1 /
&pair coordinate=1, links=1,2, kind='revolute', axis=0,0,1 /
&initial coordinate=1, position=0.2 /
&body link=2, mass=1, centre=0,-1,0 /
&gravity acceleration=0,-1,0 /
&load kind='coordinate', coordinate=1, damping=0.5 /
&load kind='coordinate', coordinate=1, force=1.5, law='harmonic', amplitude=1, angular_frequency=0.6666666666666666, phase=1.5707963267948966 /
&time end=2000, intervals=2 /
&exponents transient=100 /
&parameter name='angle', sets='initial.position', low=-1, high=1 /
&quantity name='last', of='dq1', take='end' /
&study kind='random', runs=6, exponents=1 /
"""


def study(program, folder, text, *words, code=0):
    """Standard error of a study that ends with a code."""
    path = folder / 'exponents.nml'
    path.write_text(text, encoding='utf-8')
    done = run(program, path, '--study', '--table', folder / 'study.dat', *words, folder=folder)
    assert done.returncode == code, done.stderr
    return done.stderr


def test_over_a_parameter(checks, mech9d, tmp_path):
    """A damped oscillator: the real roots of its equation, in the order of size, in table, HDF5 file and report."""
    said = study(mech9d, tmp_path, SLIDER, '--hdf5', tmp_path / 'study.h5', '--report', tmp_path / 'study.json')
    rows = read_table((tmp_path / 'study.dat').read_text())
    roots = np.array([sorted(np.roots([1, d, 4]).real, reverse=True) for d in rows['d']])
    # tolerance: steps of 1e-8
    checks.near(rows['L1'], roots[:, 0], 1e-7, 'the largest one', scale=1)
    checks.near(rows['L2'], roots[:, 1], 1e-7, 'the other one', scale=1)
    checks.true(all(0 <= rows[name].max() < 1e-7 for name in ('L1.error', 'L2.error')), 'their errors', rows)
    checks.true('L1: ' in said and '1/s' in said, 'they are told with their unit', said)
    with h5py.File(tmp_path / 'study.h5', 'r') as file:
        checks.equal(file['quantities/L2'][()].tolist(), rows['L2'].tolist(), 'the HDF5 file')
        checks.true(b'Lyapunov' in file['study/meanings'][0] and file['study/units'][0] == b'1/s', 'and its meanings')
    report = json.loads((tmp_path / 'study.json').read_text())
    checks.equal([one['name'] for one in report['quantities']], ['L1', 'L2', 'L1.error', 'L2.error'], 'the report')
    checks.equal(report['quantities'][1]['unit'], '1/s', 'its unit')


def test_over_starts(checks, mech9d, tmp_path):
    """The driven pendulum from several starts: all find the exponent of the same attractor; other quantities stay beside it, and threads
    change nothing."""
    said = study(mech9d, tmp_path, PENDULUM, '--threads', '2', '--plot', tmp_path / 'l.svg:angle:L1')
    rows = read_table((tmp_path / 'study.dat').read_text())
    mean, error = rows['L1'].mean(), np.hypot(rows['L1.error'].mean(), rows['L1'].std(ddof=1))
    checks.true(np.abs(rows['L1'] - mean).max() < 4 * error < 0.4 * mean, 'one exponent, within errors', rows['L1'])
    checks.true('L1: mean ' in said, 'the mean over the starts', said)
    checks.true(len(set(rows['last'])) == 6, 'the starts are different, and so are their ends', rows['last'])
    study(mech9d, tmp_path, PENDULUM, '--threads', '1')
    again = read_table((tmp_path / 'study.dat').read_text())
    checks.equal([again[name].tolist() for name in rows], [rows[name].tolist() for name in rows], 'the same by one thread')
    alone = run(mech9d, tmp_path / 'exponents.nml', '--exponents', '1', '--no-write', '--set', f"initial.position={rows['angle'][2]!r}",
                '--report', tmp_path / 'alone.json')
    checks.true(alone.returncode == 0, 'a start alone', alone.stderr)
    checks.equal(json.loads((tmp_path / 'alone.json').read_text())['exponents'], [rows['L1'][2]], 'has the same exponent')


def test_runs_that_have_none(checks, mech9d, tmp_path):
    """Runs fail whose exponents are minus infinity, where a stop holds the slider; the others go on."""
    text = SLIDER.replace("&parameter name='d', sets='load.damping', low=4.5, high=6, count=4 /",
                          "&parameter name='low', sets='stop.low', low=-1, high=0.1, count=2 /") + '&stop coordinate=1, low=0 /\n'
    said = study(mech9d, tmp_path, text.replace('transient=20', 'transient=0.001'))
    rows = read_table((tmp_path / 'study.dat').read_text())
    checks.equal(rows['exit_code'].tolist(), [0, 6], 'the second run fails')
    checks.true(np.isnan(rows['L1'][1]) and 'exponent 1 is minus infinity' in said, 'and the reason is told', said)


@pytest.mark.parametrize('changes, code, words', (
    ({'exponents=2': 'exponents=3'}, 2, 'there are 2 exponents'),
    ({"name='d'": "name='L2'"}, 3, "gives the study a column 'L2'"),
    ({'transient=20': 'transient=70'}, 3, 'the transient of the exponents ends after the motion'),
), ids=('many', 'name', 'transient'))
def test_refusals(checks, mech9d, tmp_path, changes, code, words):
    """Refusals before the first run."""
    text = SLIDER
    for old, new in changes.items():
        text = text.replace(old, new)
    said = study(mech9d, tmp_path, text, code=code)
    checks.true(words in said and not (tmp_path / 'study.dat').exists(), words, said)
