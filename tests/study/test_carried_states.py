"""Studies that carry states on from run to run, and the sections of studies: bifurcation diagrams.

Compares the program with itself: a study and single runs that begin where the one before ended."""
from math import acos, sin, sqrt, tan

import h5py
import numpy as np
import pytest

from mech9_cases import read_table, run

# half of a two-bar truss: a spring of length 1 m whose foot is 0.8 m beside a slide, at first 0.6 m below its head; strongly damped
TRUSS = """&structure cq=1 /
&pair coordinate=1, links=1,2, kind='prismatic', axis=0,1,0 /
&initial coordinate=1, position=0.6, velocity=0 /
&body link=2, mass=1 /
&point name='P', link=2 /
&load kind='spring', links=2,1, second_position=0.8,0,0, stiffness=100, free_length=1 /
&load kind='coordinate', coordinate=1, damping=20 /
&load kind='coordinate', coordinate=1, force=0 /
&time end=20, intervals=1 /
&section period=1, transient=18, table='points.dat' /
&parameter name='force', sets='load(3).force', low=-6, high=6, count=25 /
&quantity name='height', of='q1', take='end' /
"""
# the angle at which the force of the truss is greatest
FOLD_ANGLE = acos(0.8**(1/3))
FOLD = 100*(sin(FOLD_ANGLE) - 0.8*tan(FOLD_ANGLE))

PENDULUM = """&structure cq=1 /
&pair coordinate=1, links=1,2, kind='revolute', axis=0,0,1 /
&initial coordinate=1, position=0.2, velocity=0 /
&body link=2, mass=1, centre=0,-1,0 /
&gravity acceleration=0,-1,0 /
&load kind='coordinate', coordinate=1, damping=0.5 /
&load kind='coordinate', coordinate=1, force=1, law='harmonic', amplitude=1, angular_frequency=0.6666666666666666, phase=1.5707963267948966 /
&section period=9.42477796076938, transient=565.4, table='points.dat' /
&time end=659.7344572538566, intervals=1 /
"""


@pytest.fixture(autouse=True)
def in_folder(monkeypatch, tmp_path):
    monkeypatch.chdir(tmp_path)


def study(program, folder, text, *words, code=0):
    """Standard error of a study that ends with a code."""
    path = folder / 'sweep.nml'
    path.write_text(text, encoding='utf-8')
    done = run(program, path, '--study', '--table', folder / 'study.dat', '--report', folder / 'study.json', *words)
    assert done.returncode == code, done.stderr
    return done.stderr


def table(path):
    return read_table(path.read_text())


@pytest.mark.parametrize('carry', ('forwards', 'backwards', 'both', 'none'))
def test_truss_snaps_at_its_folds(checks, mech9d, tmp_path, carry):
    """A truss stays on its branch up to the fold of the force, and comes back at the opposite force. Heights are equilibria."""
    checks.near(FOLD, 5.139077831551, 1e-12, 'the force at the fold')
    study(mech9d, tmp_path, TRUSS + f"&study kind='grid', carry='{carry}' /\n")
    rows = table(tmp_path / 'study.dat')
    forces = np.linspace(-6, 6, 25)
    expected = {'forwards': forces, 'backwards': forces[::-1], 'both': np.concatenate([forces, forces[::-1]]), 'none': forces}[carry]
    checks.near(rows['force'], expected, 1e-15, 'the forces in the order of the runs')
    height = 0.6
    for force, found in zip(expected, rows['height']):
        if carry == 'none':
            height = 0.6
        # the force pulls upwards
        if abs(force) > FOLD:
            height = np.sign(force)*abs(height)
        checks.true(np.sign(found) == np.sign(height), f'the branch at {force} N', found)
        length = sqrt(0.64 + found**2)
        # the slowest motions, near the folds, have come to rest but for this part
        checks.near(force, 100*found*(length - 1)/length, 1e-3, f'the equilibrium at {force} N')
        height = found
    points = table(tmp_path / 'points.dat')
    checks.equal(list(points['run']), [float(k + 1) for k in range(len(expected)) for _ in range(3)], 'three points of each run')
    checks.near(points['q1'][2::3], rows['height'], 1e-12, 'the last point is the end')
    checks.near(points['force'], np.repeat(expected, 3), 1e-15, 'with the parameter')


def test_study_and_single_runs(checks, mech9d, tmp_path):
    """Each run begins where the one before ended."""
    (tmp_path / 'forces.dat').write_text('1\n-3\n5.5\n', encoding='utf-8')
    study(mech9d, tmp_path, TRUSS.replace('end=20', 'end=2').replace('transient=18', 'transient=0') +
          "&study kind='list', file='forces.dat', carry='forwards' /\n")
    points = table(tmp_path / 'points.dat')
    start = (0.6, 0.0)
    for number, force in enumerate((1, -3, 5.5), 1):
        single = tmp_path / 'single.nml'
        text = TRUSS.split('&parameter')[0].replace('end=20', 'end=2').replace('transient=18', 'transient=0')
        text = text.replace('position=0.6, velocity=0', f'position={start[0]!r}, velocity={start[1]!r}').replace('force=0', f'force={force}')
        single.write_text(text.replace("table='points.dat'", "table='single.dat'"))
        assert run(mech9d, single, '--table', tmp_path / 'run.dat').returncode == 0
        own, those = table(tmp_path / 'single.dat'), points['run'] == number
        for name in ('point', 't', 'q1', 'dq1', 'P.y', 'E.total'):
            # seventeen digits of a table give back a number
            checks.equal(list(points[name][those]), list(own[name]), f'{name} of run {number}')
        start = (float(own['q1'][-1]), float(own['dq1'][-1]))


def test_period_doubling(checks, mech9d, tmp_path):
    """The driven pendulum of Baker and Gollub has one point a period, and two beyond g = 1.066372862455."""
    (tmp_path / 'g.dat').write_text('0.95\n1.03\n1.064\n1.0672\n', encoding='utf-8')
    study(mech9d, tmp_path, PENDULUM + "&parameter name='g', sets='load(2).force' /\n&study kind='list', file='g.dat', carry='forwards' /\n")
    points = table(tmp_path / 'points.dat')
    for number, period in ((1, 1), (2, 1), (3, 1), (4, 2)):
        rates = points['dq1'][points['run'] == number]
        checks.true(len(rates) == 11, 'points behind the transient', rates)
        gaps = [float(np.max(np.abs(rates[k:] - rates[:-k]))) for k in (1, 2)]
        if period == 1:
            checks.true(gaps[0] < 1e-3, f'one point in run {number}', rates)
        else:
            checks.true(gaps[0] > 1e-2 > 10*gaps[1], f'two points in run {number}', rates)


def test_files_of_a_section(checks, mech9d, tmp_path):
    """HDF5, plots and the words of a study with a section; the same numbers with several threads."""
    text = TRUSS.replace('end=20', 'end=2').replace('transient=18', 'transient=0') + "&study kind='grid' /\n"
    said = study(mech9d, tmp_path, text, '--hdf5', tmp_path / 'study.h5', '--plot', 'cascade.svg:section:force:q1', '--plot', 'height',
                 '--threads', '2')
    checks.true('section: 75 points\ntable of the section: points.dat' in said and 'cascade.svg' in said, 'what is told', said)
    points = table(tmp_path / 'points.dat')
    with h5py.File(tmp_path / 'study.h5', 'r') as file:
        for name in ('run', 'force', 'point', 't', 'q1', 'P.y'):
            checks.equal(list(file['section/' + name][()]), list(points[name]), f'{name} in the HDF5 file')
    checks.true((tmp_path / 'cascade.svg').stat().st_size > 0, 'a picture')
    study(mech9d, tmp_path, text, '--threads', '1')
    again = table(tmp_path / 'points.dat')
    for name in points:
        checks.equal(list(again[name]), list(points[name]), f'{name} with one thread')


BAD = {
    'parts': ("carry='both'", {}, ('--part', '1/2'), 2, 'makes all its runs, one after the other'),
    'broken_period': ("carry='both'", {'end=20': 'end=20.5'}, (), 3, 'a whole number of periods'),
    'motor': ("carry='both'", {'&time': "&motor coordinate=1, kind='pid', proportional=1, integral=1, setpoint=0 /\n&time"}, (), 3, 'states of motors'),
    'drawn': ("carry='both'", {"kind='grid'": "kind='random', runs=3"}, (), 3, "'carry'"),
    'unknown': ("carry='up'", {}, (), 3, 'none forwards backwards both'),
    'continued': ("", {}, ('--continue', 'study.h5'), 2, 'no points of the section'),
    'column': ("", {'period=1': "column='Z.x'"}, (), 3, "column 'Z.x', which is not recorded"),
    'plot': ("", {}, ('--plot', 'a.svg:section:Z'), 2, 'Z'),
}


@pytest.mark.parametrize('name', BAD)
def test_bad_requests(checks, mech9d, tmp_path, name):
    carry, changes, words, code, said = BAD[name]
    text = TRUSS + f"&study kind='grid', {carry} /\n"
    for old, new in changes.items():
        text = text.replace(old, new)
    found = study(mech9d, tmp_path, text, *words, code=code)
    checks.true(said in found, said, found)
